"""Form factors: pairs, matrices of rooms, and View3D's own files."""

import json

from matrix import script_factors

# The inner body is part of the family's name, not of the case.
INCOMPLETE = {"vf-p-concentric-spheres-self-1", "vf-p-coax-cyl-outer-self-1"}
# Broken where they come from (the collection's README).
BROKEN = {"pinney-g4", "pinney-tri"}
# View3D's tolerances of which its published errors are quoted: its default and its finest.
PUBLISHED = ("0.0001", "1e-06")
EMISSIVITY = 0.9
# The quick half takes item buffers of one room, in which something stands in the way, and leaves these files out.
QUICK_HEMICUBE = "vf-p-mat-facet8"
SLOW = {"gunter1", "gunter2", "test"}
# View3D's files of one L-shaped room; its surfaces are in this order, ceiling and floor one each.
L_ROOM = [["y0"], ["x3"], ["y1"], ["x1"], ["y3"], ["x0"], ["ceil-a", "ceil-b"], ["floor-a", "floor-b"]]
L_ROOM_FILES = ("pinney", "pinney-bean-test-4", "pinney-bean-test-4-f3a", "test4", "test4a")
PRINTS = {"test": "test-expected-output.txt", **{name: "viewht-test-viewfactors.txt" for name in L_ROOM_FILES}}
# Files of which the first two surfaces are a pair of view_factors.json.
OF_PAIRS = {"ParallelPlanes": "vf-p-par-equal-1", "square-obstruction": "vf-p-obs-parallel-1"}


def _view3d(errors):
    """A cell of what View3D reaches, from {tolerance: error}."""
    return "View3D 4.0: " + ", ".join(f"{errors[eps]:.1e} at {eps}" for eps in PUBLISHED)


def pairs(program, folder, published, table):
    """Every pair of view_factors.json by the exact method; errors relative."""
    answers, seconds = program.json("formfactors", folder / "view_factors.json")
    values = {p["id"]: p for p in answers["pairs"]}
    theirs = {c["id"]: c for c in published["cases"]}
    groups = {"pairs with nothing between": [], "pairs with occluders": []}
    for case in json.loads((folder / "view_factors.json").read_text())["cases"]:
        if case["id"] in INCOMPLETE:
            table.skip(case["id"], "the case does not name its inner body")
        else:
            groups[list(groups)[bool(case["occluders"])]].append(case)
    for name, cases in groups.items():
        worst, within, others = 0, 0, {eps: 0 for eps in PUBLISHED}
        for case in cases:
            answer, exact = values[case["id"]], case["value"]
            error, unit = abs(answer["value"] - exact), exact if exact > 0 else 1
            worst = max(worst, error / unit)
            within += error <= answer["error_bound"] + 1e-15
            for eps in PUBLISHED if case["id"] in theirs else ():
                others[eps] = max(others[eps], abs(theirs[case["id"]][eps][1]) / unit)
        table.add(name, "pairs", worst, seconds=seconds, published=_view3d(others),
                  note=f"worst relative of {len(cases)}; {within} within the bound that is told")
        seconds = None


def matrices(program, folder, published, table, quick):
    """Rooms of view_factor_matrices.json by every method; errors of the matrix's largest value."""
    methods = [("exact", []), ("rays", ["--rays", 64]), ("hemicube", ["--resolution", 128])]
    if not quick:
        methods += [("cubic-tetrahedron", ["--resolution", 128]), ("single-plane", ["--resolution", 128])]
    theirs = {m["id"]: m for m in published["matrices"]}
    for case in json.loads((folder / "view_factor_matrices.json").read_text())["cases"]:
        names, largest = [s["name"] for s in case["surfaces"]], max(map(max, case["F"]))
        for method, options in methods:
            if quick and method == "hemicube" and case["id"] != QUICK_HEMICUBE:
                continue
            found, seconds = program.form_factors(case, "--method", method, *options)
            worst = max(abs(found.get((a, b), 0) - case["F"][i][j]) for i, a in enumerate(names)
                        for j, b in enumerate(names))
            quoted = method == "exact" and case["id"] in theirs
            table.add(case["id"], method, worst / largest, seconds=seconds,
                      published=_view3d({eps: theirs[case["id"]][eps][0] / largest for eps in PUBLISHED})
                      if quoted else "")


def _printed_matrix(file):
    """Factors as View3D prints them: a headline, areas, then a row a surface."""
    rows = [[float(x) for x in line.split()] for line in file.read_text().splitlines()[1:] if line.strip()]
    return rows[1:1 + len(rows[0])]


def _dense(answers):
    """The matrix of an answer of one model, whose surfaces have names of their own."""
    at = {name: i for i, name in enumerate(answers["cases"][0]["surfaces"])}
    factors = [[0.0] * len(at) for _ in at]
    for p in answers["pairs"]:
        factors[at[p["from"]]][at[p["to"]]] = p["value"]
    return factors


def _merged(case, groups):
    """A case's matrix with surfaces put together."""
    at = {s["name"]: i for i, s in enumerate(case["surfaces"])}
    area = [s["area"] for s in case["surfaces"]]
    out = []
    for group in groups:
        rows, whole = [at[name] for name in group], sum(area[at[name]] for name in group)
        out.append([sum(area[i] * case["F"][i][at[j]] for i in rows for j in other) / whole for other in groups])
    return out


def _difference(found, exact):
    """The largest, of the largest value."""
    return max(abs(a - b) for row, other in zip(found, exact) for a, b in zip(row, other)) / max(map(max, exact))


def _print_beside(factors, file):
    """A cell of how far View3D's printed script-F lies from ours, absolute."""
    grey = script_factors(factors, [1 - EMISSIVITY] * len(factors))
    worst = max(abs(a - b) for row, other in zip(grey, _printed_matrix(file)) for a, b in zip(row, other))
    return f"View3D prints script-F {worst:.1e} from ours"


def _by_closure(answers, table, name, seconds, published):
    """Where nothing else is known: what leaves a surface arrives somewhere. Rays count what leaves the model."""
    model = answers["cases"][0]
    sampled = any(model["environment"] + model["back"]) or any(p["method"] == "rays" for p in answers["pairs"])
    table.add(name, "rays" if sampled else "exact", model["closure"]["off"], seconds=seconds, published=published,
              note="closure: rows with their surroundings less one")


def view3d_files(program, folder, table, quick):
    """View3D's own input files: against the same room or pair among the cases, or by closure."""
    rooms = {c["id"]: c for c in json.loads((folder / "view_factor_matrices.json").read_text())["cases"]}
    of_pairs = {c["id"]: c["value"] for c in json.loads((folder / "view_factors.json").read_text())["cases"]}
    singles = {room: [[s["name"]] for s in rooms[room]["surfaces"]] for room in rooms}
    known = {"cube": ("vf-p-mat-cube", [["z0"], ["x0"], ["y0"], ["z1"], ["x1"], ["y1"]]),
             "facet": ("vf-p-mat-facet8", singles["vf-p-mat-facet8"]),
             **{name: ("vf-p-mat-lroom", L_ROOM) for name in L_ROOM_FILES}}
    for file in sorted((folder / "view3d/inputs").glob("*.vs3")):
        name = f"view3d {file.stem}"
        if file.stem in BROKEN:
            table.skip(name, "the file is broken where it comes from")
            continue
        if quick and file.stem in SLOW:
            continue
        answers, seconds = program.json("formfactors", file)
        printed = PRINTS.get(file.stem)
        factors = _dense(answers) if printed or file.stem in known or file.stem in OF_PAIRS else None
        published = _print_beside(factors, folder / "view3d/expected" / printed) if printed else ""
        if file.stem in known:
            room, groups = known[file.stem]
            table.add(name, "exact", _difference(factors, _merged(rooms[room], groups)), seconds=seconds,
                      note=f"against {room}", published=published)
        elif file.stem in OF_PAIRS:
            pair = OF_PAIRS[file.stem]
            table.add(name, "exact", abs(factors[0][1] / of_pairs[pair] - 1), seconds=seconds, note=f"against {pair}")
        else:
            _by_closure(answers, table, name, seconds, published)
