"""CIE 171:2006: test cases for lighting software, with the exact values of the collection (cie171.json)."""

import math

from light import deviate, root_mean_square
from shapes import Scene, area_and_normal, cross, frame_around, gauss_points, polygon, rectangle
from table import LIMITS, normal_deviate, stated_tolerance

# A point source that shines by the cosine is a square so small that nothing at metres can tell.
SOURCE_SIDE = 1e-3
SKY_LUX = 10000
# The ground is a square of this side in the place of an infinite one, which makes a percent near the horizon.
GROUND_REFLECTANCE, GROUND_SIZE = 0.3, 2000.0
# Of the CIE's sixteen skies the even one.
UNIFORM = "5"
# Of cases that take long to bake: the uniform one, both overcast ones and a clear one.
FEWER_SKIES = {"5.9": (UNIFORM, "1", "12", "16")}
REFLECTANCES_QUICK = (0.5,)


def _along_axis(vector):
    """The case's z, up, is glTF's y."""
    return [vector[0], vector[2], -vector[1]]


def _upright(scene):
    """The scene as glTF has it, for the sky's sake."""
    for surface in scene.surfaces:
        surface.positions = [_along_axis(p) for p in surface.positions]
    return scene


def _source_square(case):
    """5.2: from the source's flux, the square and its exitance."""
    x, y, z = case["light"]["position"]
    half = SOURCE_SIDE / 2
    square = rectangle([x - half, y + half, z], [SOURCE_SIDE, 0, 0], [0, -SOURCE_SIDE, 0])
    return square, case["light"]["flux_lm"] / SOURCE_SIDE ** 2


def _room(size):
    """The inner faces of a box from the origin."""
    x, y, z = size
    return {"floor": rectangle([0, 0, 0], [x, 0, 0], [0, y, 0]),
            "ceiling": rectangle([0, 0, z], [0, y, 0], [x, 0, 0]),
            "wall-x0": rectangle([0, 0, 0], [0, y, 0], [0, 0, z]),
            "wall-x1": rectangle([x, 0, 0], [0, 0, z], [0, y, 0]),
            "wall-y0": rectangle([0, 0, 0], [0, 0, z], [x, 0, 0]),
            "wall-y1": rectangle([0, y, 0], [x, 0, 0], [0, 0, z])}


def _box_faces(low, high):
    """The outer faces of a box."""
    faces = _room([b - a for a, b in zip(low, high)])
    return [[[p + o for p, o in zip(v, low)] for v in reversed(face)] for face in faces.values()]


def _with_opening(name, face, opening):
    """A rectangle less one within it: what is left in up to four pieces, none where nothing is left."""
    corners = [min(opening, key=lambda v: math.dist(v, corner)) for corner in face]
    pieces = frame_around(face, corners)
    return [polygon(f"{name}-{i}", p) for i, p in enumerate(pieces) if area_and_normal(p)[0] > 1e-12]


def _facing(name, vertices, receiver):
    """A black polygon, turned so that it faces as the receiver does."""
    normal = area_and_normal(vertices)[1]
    seen = sum(a * b for a, b in zip(normal, receiver["normal"])) > 0
    return polygon(name, vertices if seen else vertices[::-1])


def radiance_reaches(published, case):
    """A cell of what Radiance reaches on a section, with the source as a light and as a surface that glows."""
    section = case["cie_section"] + (f"-{case['id'][-1]}" if "scenario" in case["id"] else "")
    found = [f"{name.removeprefix(section).strip()}: rms {value['rms_rel']:.1e}" for name, value in published.items()
             if name.split(" ")[0] == section]
    return "Radiance " + ", ".join(found) if found else ""


def _report(case, method, found, exact, table, *, errors=None, seconds=None, note="", held=True):
    """One row: worst relative error over receivers; where it is dark, of their mean. `held` to the case's tolerance.

    What the lit mesh says between its vertices is told and not held: a preset bounds its error over all surfaces,
    and these places lie where light bends most."""
    mean = sum(exact) / len(exact)
    relative = [abs(f - e) / (e if e > 0 else mean) for f, e in zip(found, exact)]
    worst_deviate = None
    if errors is not None:
        worst_deviate = max(normal_deviate(deviate(f, e, s)) for f, e, s in zip(found, exact, errors))
    limit = stated_tolerance(case)
    if method in LIMITS and method != "hierarchical":
        limit = min(limit, LIMITS[method])
    text = f"worst of {len(found)}; rms {root_mean_square(relative):.1e}"
    table.add(case["id"], method, max(relative), limit=limit if held else None, deviate=worst_deviate, seconds=seconds,
              note=text + (f"; {note}" if note else ""))


def _factors(program, case, receivers, target, table, occluders=(), scale=1.0, exact=None):
    """Configuration factors from the receivers to polygons, of weights."""
    cases = [{"id": f"{i} {j}", "occluders": [{"vertices": v} for v in occluders],
              "from": {"type": "point", "position": r["point"], "normal": r["normal"]},
              "to": {"type": "polygon", "vertices": vertices}}
             for i, r in enumerate(receivers) for j, (vertices, _) in enumerate(target(r))]
    answers, seconds = program.form_factors({"cases": cases})
    found = [scale * sum(weight * answers[f"{i} {j}"]["value"] for j, (_, weight) in enumerate(target(r)))
             for i, r in enumerate(receivers)]
    _report(case, "pairs", found, exact, table, seconds=seconds, note="configuration factors")


def _light(program, case, scene, receivers, exact, table, quick, *options, to_world=lambda v: v, note="",
           stands_in=False):
    """The path tracer and the hierarchical solver at receivers that lie on surfaces of the scene.

    Where the scene only stands in for the case, the path tracer's own errors do not say how far it may be off."""
    points = [{"point": to_world(r["point"]), "normal": to_world(r["normal"])} for r in receivers]
    answers, seconds = program.trace(scene, case["id"], points, 65536, *options)
    _report(case, "reference", [a["irradiance"][1] for a in answers], exact, table,
            errors=None if stands_in else [a["standard_error"][1] for a in answers], seconds=seconds, note=note)
    if not quick:
        lit, light, seconds = program.gather(scene, case["id"], points, *options)
        _report(case, "hierarchical", [e[1] for e in light], exact, table, seconds=seconds, note=note)
        found = [lit.irradiance(p["point"], p["normal"])[1] for p in points]
        _report(case, "vertices", found, exact, table, note=note, held=False)


def source(program, case, table, quick):
    """5.2 and 5.3: a source, receivers in the dark."""
    receivers, exact = case["receivers"], [r["illuminance"] for r in case["receivers"]]
    if case["light"]["type"] == "point":
        lamp, exitance = _source_square(case)
        walls = [polygon("floor", rectangle([-2, -2, 0], [4, 0, 0], [0, 4, 0]))]
    else:
        lamp, exitance = case["light"]["vertices"], case["light"]["exitance"]
        walls = _black_room(case)
    _factors(program, case, receivers, lambda r: [(lamp, exitance)], table, exact=exact)
    scene = Scene(walls + [polygon("lamp", lamp, exitance=[exitance] * 3)])
    _light(program, case, scene, receivers, exact, table, quick)


def _black_room(case):
    """The case's surfaces; the ceiling around its lamp, which lies in it."""
    out = []
    for name, vertices in case["surfaces"]:
        out += _with_opening(name, vertices, case["light"]["vertices"]) if name == "ceiling" else [
            polygon(name, vertices)]
    return out


def flux(program, case, table, quick):
    """5.4: what a lamp sends out arrives on floor and walls, by Gauss's rule or by the solver's own means."""
    if "surfaces" in case:
        lamp, exitance = case["light"]["vertices"], case["light"]["exitance"]
        scene = Scene(_black_room(case) + [polygon("lamp", lamp, exitance=[exitance] * 3)])
        faces = {name: v for name, v in case["surfaces"] if name != "ceiling"}
    else:
        faces, intensity = _room([4, 4, 4]), case["light"]["flux"] / (4 * math.pi)
        scene = Scene([polygon(n, v) for n, v in faces.items()],
                      [{"position": [1.5, 2.25, 1.75], "intensity": [intensity] * 3}])
    areas = {name: area_and_normal(v)[0] for name, v in faces.items()}
    points = [p for v in faces.values() for p in gauss_points(v)]
    answers, seconds = program.trace(scene, case["id"], points, 256 if quick else 4096)
    weights = [areas[name] * p["weight"] for name, v in faces.items() for p in gauss_points(v)]
    total = math.fsum(w * a["irradiance"][1] for w, a in zip(weights, answers))
    error = math.sqrt(math.fsum((w * a["standard_error"][1]) ** 2 for w, a in zip(weights, answers)))
    exact, limit = case["expected_total_flux"], stated_tolerance(case)
    table.add(case["id"], "reference", abs(total / exact - 1), limit=limit, seconds=seconds,
              deviate=deviate(total, exact, error) if error > 1e-6 * exact else None, note="flux received")
    if not quick:
        lit, _, seconds = program.bake(scene, case["id"])
        total = sum(areas[s.name] * lit.mean_irradiance(i)[1] for i, s in enumerate(scene.surfaces) if s.name in areas)
        table.add(case["id"], "hierarchical", abs(total / exact - 1), limit=limit, seconds=seconds,
                  note="flux received")


def reflector(program, case, table, quick):
    """5.6 and 5.7: a reflecting surface, modelled as one that shines, and black receivers."""
    key = next(k for k in case["receivers"][0] if k.endswith("_percent"))
    shining = case["surfaces"][0][1]
    faces = []
    if "obstruction" in case:
        faces = _box_faces(case["obstruction"]["min"], case["obstruction"]["max"])
    exact = [r[key] for r in case["receivers"]]
    _factors(program, case, case["receivers"], lambda r: [(shining, 100)], table, occluders=faces, exact=exact)
    # Vertical and horizontal receivers one after the other: the one's back would hide the shine from the other.
    for axis, word in ((1, "vertical"), (2, "horizontal")):
        receivers = [r for r in case["receivers"] if abs(r["normal"][axis]) == 1]
        height = receivers[0]["point"][2]
        size = [4, 4, 3]
        wall = rectangle([0, 0, 0], [0, 0, size[2]], [size[0], 0, 0]) if axis == 1 else rectangle(
            [0, 0, height], [size[0], 0, 0], [0, 2.5, 0] if height == 0 else [0, size[1], 0])
        scene = Scene([polygon("S2", shining, exitance=[100] * 3), _facing("receivers", wall, receivers[0])]
                      + [polygon(f"box-{i}", f) for i, f in enumerate(faces)])
        _light(program, case, scene, receivers, [r[key] for r in receivers], table, quick, note=word)


def _places_in_cube(case):
    """The four places that the case names, on every face."""
    places = {"centre": (0, 0), "half": (0.5, 0), "edge-mid": (0.95, 0), "corner": (0.95, 0.95)}
    for _, vertices in case["surfaces"]:
        normal = area_and_normal(vertices)[1]
        middle = [(x + y) / 2 for x, y in zip(vertices[0], vertices[2])]
        u = [(y - x) / 2 for x, y in zip(vertices[0], vertices[1])]
        v = cross(normal, u)
        for name, (s, t) in places.items():
            yield {"point": [m + s * p + t * q for m, p, q in zip(middle, u, v)], "normal": normal, "name": name}


def interreflection(program, case, table, quick):
    """5.8: indirect light of a cube, total less what the same method finds in the black one."""
    lamp = {"position": case["light"]["position"], "intensity": [case["light"]["intensity"]] * 3}
    points = list(_places_in_cube(case))
    black, *others = [r for r in case["receivers"] if not quick or r["rho"] in (0, *REFLECTANCES_QUICK)]
    for method in ("reference",) if quick else ("reference", "hierarchical"):
        def light(receiver):
            scene = Scene([polygon(n, v, [receiver["rho"]] * 3) for n, v in case["surfaces"]], [lamp])
            return _cube_light(program, case, scene, points, method)

        direct, spent = light(black)
        rows, of_total = [], 0.0
        for receiver in others:
            total, seconds = light(receiver)
            spent += seconds
            exact = {**receiver["indirect_at_points"], "mean": receiver["mean_indirect_illuminance"]}
            alone = {**case["direct_at_points"], "mean": case["receivers"][0]["mean_total_illuminance"]}
            doubt = {**receiver["indirect_at_points_error_estimate"], "mean": 0}
            names = [*(p["name"] for p in points), "mean"]
            rows += [(t[0] - d[0], exact[name], math.hypot(t[1], doubt[name]))
                     for name, t, d in zip(names, total, direct)]
            of_total = max([of_total] + [abs(t[0] / (exact[name] + alone[name]) - 1) for name, t in zip(names, total)])
        found, truth, errors = zip(*rows)
        _report(case, method, found, truth, table, errors=errors if method == "reference" else None, seconds=spent,
                note=f"indirect, at 4 places of each face and over the room, reflectances: {len(others)}; of direct "
                     f"and indirect together {of_total:.1e}")


def _cube_light(program, case, scene, points, method):
    """(irradiance, standard error) at the points, and last the mean over the room; and the seconds."""
    if method == "hierarchical":
        lit, light, seconds = program.gather(scene, case["id"], points)
        out = [(e[1], 0) for e in light]
        return out + [(sum(lit.mean_irradiance(i)[1] for i in range(6)) / 6, 0)], seconds
    answers, seconds = program.trace(scene, case["id"], points, 16384)
    inner = [p for s in scene.surfaces for p in gauss_points(s.positions)]
    spread, more = program.trace(scene, case["id"], inner, 256)
    mean = math.fsum(p["weight"] / 6 * a["irradiance"][1] for p, a in zip(inner, spread))
    error = math.sqrt(math.fsum((p["weight"] / 6 * a["standard_error"][1]) ** 2 for p, a in zip(inner, spread)))
    return [(a["irradiance"][1], a["standard_error"][1]) for a in answers] + [(mean, error)], seconds + more


def _sky_and_ground(opening, receiver):
    """What a receiver sees of the sky and of the ground through an upright opening: above it, and below."""
    height = receiver["point"][2]
    low, high = min(v[2] for v in opening), max(v[2] for v in opening)
    parts = []
    for begin, end, weight in ((max(low, height), high, 100), (low, min(high, height), 100 * GROUND_REFLECTANCE)):
        if end > begin:
            parts.append(([[v[0], v[1], end if v[2] == high else begin] for v in opening], weight))
    return parts


def _sky_options(kind, facade):
    """Of CIE sky `kind`, with the sun 60 degrees up where the case has it: +y is north, -y south."""
    sky = ["--sky", f"{SKY_LUX}lux"]
    if kind == UNIFORM:
        return sky
    azimuth = "180" if facade else "0"
    return [*sky, "--sky-model", f"cie{kind}", "--sun", "0", "--sun-elevation", "60", "--sun-azimuth", azimuth]


def daylight(program, case, table, quick):
    """5.9 and 5.11 under the sixteen skies of the CIE, in percent of what each gives the open ground."""
    receivers, facade = case["receivers"], case["cie_section"] == "5.11"
    faces, opening = _room(case["room"]), case["opening"]
    # The opening as one that shines inwards.
    inwards = opening if area_and_normal(opening)[1][1 if facade else 2] * (1 if facade else -1) > 0 else opening[::-1]

    def exact(kind):
        values = case["values_percent_of_Ehz"][kind]["computed"]
        return [values[r["name"]] for r in receivers]

    _factors(program, case, receivers, lambda r: _sky_and_ground(inwards, r) if facade else [(inwards, 100)], table,
             exact=exact(UNIFORM))
    open_face = "wall-y0" if facade else "ceiling"
    surfaces = []
    for name, face in faces.items():
        surfaces += _with_opening(name, face, opening) if name == open_face else [polygon(name, face)]
    if facade:
        half = GROUND_SIZE / 2
        ground = rectangle([-half, -half, 0], [GROUND_SIZE, 0, 0], [0, half, 0])
        surfaces.append(polygon("ground", ground, exitance=[GROUND_REFLECTANCE * SKY_LUX] * 3))
    scene = _upright(Scene(surfaces))
    for kind in [UNIFORM] if quick else FEWER_SKIES.get(case["cie_section"], case["values_percent_of_Ehz"]):
        _light(program, case, scene, receivers, [e * SKY_LUX / 100 for e in exact(kind)], table,
               quick, *_sky_options(kind, facade), to_world=_along_axis, stands_in=facade,
               note="sky type 5, the uniform one" if kind == UNIFORM else f"sky type {kind}")


GROUPS = {"5.2": source, "5.3": source, "5.4": flux, "5.6": reflector, "5.7": reflector, "5.8": interreflection,
          "5.9": daylight, "5.11": daylight}


def cie(program, cases, published, table, quick):
    """All sections; beside the first row of each, what Radiance reaches."""
    for case in cases:
        first = len(table.rows)
        GROUPS[case["cie_section"]](program, case, table, quick)
        table.rows[first].published = radiance_reaches(published, case)
