#!/usr/bin/env python3
"""Every exact case through every method that applies, as one table (README.md, "How right it is").

usage: accuracy.py [--quick] [--program P] [--cases FOLDER] [--out FOLDER]

Cases are read from FOLDER (view_factors.json, view_factor_matrices.json, gi_scenes.json). The table goes to
OUT/table.md and to standard output; OUT/worst-*.png show where the worst rooms are wrong. Exit code 1 when a figure is
beyond its limit. --quick leaves out what takes minutes, and pictures."""

import argparse
import base64
import json
import math
import random
import struct
import subprocess
import sys
import time
from pathlib import Path

# Largest error that a method may show, and of what: of the largest value of the matrix for form factors (single
# plane: less what it cannot see), of the mean over the room for light. Rays and item buffers sample.
LIMITS = {
    "pairs": 1e-5, "exact": 1e-4, "rays": 0.03, "hemicube": 0.01, "cubic-tetrahedron": 0.01, "single-plane": 0.15,
    "matrix": 1e-4, "hierarchical": 0.025, "reference": 1.0,  # the last in units of four standard errors
}
# The inner body is part of the family's name, not of the case.
INCOMPLETE = {"vf-p-concentric-spheres-self-1", "vf-p-coax-cyl-outer-self-1"}
# What the blocks cover of it counts as dark there; a bake fills it from beside, where nobody looks.
COVERED = {("gi-p-cornell-rgb", "floor")}
REFLECTANCE_CLAMP = 0.95


class Table:
    def __init__(self):
        self.rows = []

    def add(self, case, method, error, seconds, note=""):
        limit = LIMITS.get(method)
        bad = error is not None and limit is not None and not error <= limit
        self.rows.append((case, method, error, limit, seconds, note, bad))

    def text(self):
        lines = ["| case | method | error | limit | seconds | |", "| --- | --- | ---: | ---: | ---: | --- |"]
        for case, method, error, limit, seconds, note, bad in self.rows:
            lines.append("| {} | {} | {} | {} | {} | {} |".format(
                case, method, "–" if error is None else f"{error:.2e}", "–" if limit is None else f"{limit:.0e}",
                "–" if seconds is None else f"{seconds:.2f}", ("**beyond its limit** " if bad else "") + note))
        return "\n".join(lines) + "\n"

    def failures(self):
        return [row for row in self.rows if row[-1]]


class Program:
    def __init__(self, path, out):
        self.path, self.out = str(Path(path).resolve()), out

    def run(self, *arguments):
        begin = time.monotonic()
        done = subprocess.run([self.path, *map(str, arguments)], capture_output=True, text=True)
        if done.returncode != 0:
            raise SystemExit(f"goldthread {' '.join(map(str, arguments))}: {done.stderr.strip()}")
        return time.monotonic() - begin

    def json(self, *arguments):
        file = self.out / "answer.json"
        seconds = self.run(*arguments, "--json", file, "--quiet")
        return json.loads(file.read_text()), seconds


def load(folder, name):
    return json.loads((folder / name).read_text())["cases"]


def form_factor_pairs(program, cases, table):
    answers, seconds = program.json("formfactors", cases / "view_factors.json")
    values = {p["id"]: p for p in answers["pairs"]}
    open_worst, blocked_worst, within = 0, 0, 0
    counted = 0
    for case in load(cases, "view_factors.json"):
        if case["id"] in INCOMPLETE:
            table.add(case["id"], "–", None, None, "the case does not name its inner body")
            continue
        answer, exact = values[case["id"]], case["value"]
        error = abs(answer["value"] - exact)
        relative = error / exact if exact > 0 else error
        counted += 1
        within += error <= answer["error_bound"] + 1e-15
        if case["occluders"]:
            blocked_worst = max(blocked_worst, relative)
        else:
            open_worst = max(open_worst, relative)
    note = f"worst relative; {within} of {counted} within the bound that is told"
    table.add("pairs with nothing between", "pairs", open_worst, seconds, note)
    table.add("pairs with occluders", "pairs", blocked_worst, None, note)


def form_factor_matrices(program, cases, table, quick):
    file = cases / "view_factor_matrices.json"
    methods = [("exact", []), ("rays", ["--rays", 64]), ("hemicube", ["--resolution", 128])]
    if not quick:
        methods += [("cubic-tetrahedron", ["--resolution", 128]), ("single-plane", ["--resolution", 128])]
    for case in load(file.parent, file.name):
        names = [s["name"] for s in case["surfaces"]]
        largest = max(map(max, case["F"]))
        for method, options in methods:
            answers, seconds = program.json("formfactors", file, "--case", case["id"], "--method", method, *options)
            found = {(p["from"], p["to"]): p["value"] for p in answers["pairs"]}
            worst = max(abs(found.get((a, b), 0) - case["F"][i][j]) for i, a in enumerate(names)
                        for j, b in enumerate(names))
            table.add(case["id"], method, worst / largest, seconds)


def area_and_normal(vertices):
    total = [0, 0, 0]
    for i in range(1, len(vertices) - 1):
        a = [vertices[i][k] - vertices[0][k] for k in range(3)]
        b = [vertices[i + 1][k] - vertices[0][k] for k in range(3)]
        for k in range(3):
            total[k] += 0.5 * (a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3])
    size = math.sqrt(sum(x * x for x in total))
    return size, [x / size for x in total]


def write_scene(case, file):
    """The case's surfaces as glTF: one mesh each, one-sided; exitance over pi is the emitted luminance."""
    data, views, accessors, meshes, materials, nodes = b"", [], [], [], [], []
    for surface in case["surfaces"]:
        positions = surface["vertices"]
        indices = [k for i in range(1, len(positions) - 1) for k in (0, i, i + 1)]
        for values, kind, component, fmt in ((positions, "VEC3", 5126, "f"), (indices, "SCALAR", 5125, "I")):
            flat = [x for v in values for x in v] if kind == "VEC3" else values
            chunk = struct.pack(f"<{len(flat)}{fmt}", *flat)
            views.append({"buffer": 0, "byteOffset": len(data), "byteLength": len(chunk)})
            accessor = {"bufferView": len(views) - 1, "componentType": component, "count": len(values), "type": kind}
            if kind == "VEC3":
                accessor["min"] = [min(v[k] for v in positions) for k in range(3)]
                accessor["max"] = [max(v[k] for v in positions) for k in range(3)]
            accessors.append(accessor)
            data += chunk
        emitted = [m / math.pi for m in surface["emit"]]
        strength = max(1.0, *emitted)
        materials.append({
            "pbrMetallicRoughness": {"baseColorFactor": [*surface["rho"], 1], "metallicFactor": 0},
            "emissiveFactor": [e / strength for e in emitted],
            "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": strength}}})
        meshes.append({"name": surface["name"], "primitives": [
            {"attributes": {"POSITION": len(accessors) - 2}, "indices": len(accessors) - 1,
             "material": len(materials) - 1}]})
        nodes.append({"mesh": len(meshes) - 1})
    uri = "data:application/octet-stream;base64," + base64.b64encode(data).decode()
    file.write_text(json.dumps({
        "asset": {"version": "2.0"}, "extensionsUsed": ["KHR_materials_emissive_strength"],
        "buffers": [{"uri": uri, "byteLength": len(data)}], "bufferViews": views, "accessors": accessors,
        "materials": materials, "meshes": meshes, "nodes": nodes, "scenes": [{"nodes": list(range(len(nodes)))}],
        "scene": 0}))


class Glb:
    def __init__(self, file):
        data = file.read_bytes()
        length = struct.unpack_from("<I", data, 12)[0]
        self.json = json.loads(data[20:20 + length])
        self.binary = data[28 + length:]

    def accessor(self, index):
        a = self.json["accessors"][index]
        view = self.json["bufferViews"][a["bufferView"]]
        size = {"SCALAR": 1, "VEC3": 3}[a["type"]]
        letter, width = {5121: ("B", 1), 5123: ("H", 2), 5125: ("I", 4), 5126: ("f", 4)}[a["componentType"]]
        stride = view.get("byteStride", size * width)
        start = view.get("byteOffset", 0) + a.get("byteOffset", 0)
        return [struct.unpack_from(f"<{size}{letter}", self.binary, start + i * stride) for i in range(a["count"])]

    def mean_irradiance(self, mesh):
        total, weight = [0, 0, 0], 0
        for primitive in self.json["meshes"][mesh]["primitives"]:
            positions = self.accessor(primitive["attributes"]["POSITION"])
            light = self.accessor(primitive["attributes"]["_IRRADIANCE"])
            indices = [i[0] for i in self.accessor(primitive["indices"])]
            for t in range(0, len(indices), 3):
                corners = indices[t:t + 3]
                size = area_and_normal([positions[c] for c in corners])[0] if len(set(corners)) == 3 else 0
                weight += size
                for k in range(3):
                    total[k] += size / 3 * sum(light[c][k] for c in corners)
        return [x / weight for x in total]


def expected_means(case):
    """Mean irradiance by surface, where the case knows it."""
    out = {}
    for e in case.get("expect", []):
        if "surface" not in e:
            continue
        surface = next(s for s in case["surfaces"] if s["name"] == e["surface"])
        if e["quantity"] == "mean_irradiance":
            out[e["surface"]] = e["value"], e.get("std_err", [0, 0, 0])
        elif e["quantity"] == "uniform_radiosity" and min(surface["rho"]) > 0:
            out[e["surface"]] = [(b - m) / r for b, m, r in zip(e["value"], surface["emit"], surface["rho"])], [0, 0, 0]
    return out


def room_mean(case, means):
    areas = {s["name"]: area_and_normal(s["vertices"])[0] for s in case["surfaces"]}
    whole = sum(areas[name] for name in means)
    return [sum(areas[name] * means[name][0][k] for name in means) / whole for k in range(3)]


def hierarchical(program, case, means, table, pictures):
    scene = program.out / f"{case['id']}.gltf"
    write_scene(case, scene)
    lit, gold = scene.with_suffix(".glb"), scene.with_suffix(".gold")
    seconds = program.run("bake", scene, "-o", lit, "-o", gold, "--quiet")
    glb, room = Glb(lit), room_mean(case, means)
    worst, where = 0, ""
    for i, surface in enumerate(case["surfaces"]):
        if surface["name"] not in means or (case["id"], surface["name"]) in COVERED:
            continue
        found, (exact, _) = glb.mean_irradiance(i), means[surface["name"]]
        for k in range(3):
            error = abs(found[k] - exact[k]) / room[k] if room[k] > 0 else abs(found[k])
            if error > worst:
                worst, where = error, surface["name"]
    table.add(case["id"], "hierarchical", worst, seconds, f"a surface's mean, of the room's; worst at {where}")
    pictures.append((worst, gold))


def points_on(surface, count, chance):
    """Evenly by area: a triangle of the fan, then a point in it."""
    v = surface["vertices"]
    fan = [(v[0], v[i], v[i + 1]) for i in range(1, len(v) - 1)]
    sizes = [area_and_normal(list(t))[0] for t in fan]
    normal = area_and_normal(v)[1]
    for _ in range(count):
        a, b, c = chance.choices(fan, sizes)[0]
        root, share = math.sqrt(chance.random()), chance.random()
        u, w = root * (1 - share), root * share
        yield {"point": [(1 - u - w) * a[k] + u * b[k] + w * c[k] for k in range(3)], "normal": normal}


def traced(program, scene, points, samples):
    file = program.out / "points.json"
    file.write_text(json.dumps(points))
    answer, seconds = program.json("reference", scene, "--points", file, "--samples", samples)
    return answer["points"], seconds


def reference(program, case, means, table, quick):
    scene = program.out / f"{case['id']}.gltf"
    write_scene(case, scene)
    chance, count = random.Random(1), 256 if quick else 400
    points, exact = [], []
    for surface in case["surfaces"]:
        if surface["name"] in means:
            points += points_on(surface, count, chance)
    given = [e for e in case.get("expect", []) if "point" in e and e["quantity"] == "irradiance"]
    points += [{"point": e["point"], "normal": e["normal"]} for e in given]
    if not points:
        return
    answers, seconds = traced(program, scene, points, 64 if quick else 4096)
    at, worst = 0, 0
    for surface in case["surfaces"]:
        if surface["name"] not in means:
            continue
        value, error = means[surface["name"]]
        some = answers[at:at + count]
        at += count
        for k in range(3):
            values = [p["irradiance"][k] for p in some]
            mean = sum(values) / count
            # Over the surface and along the paths both: points are chosen by chance, too.
            spread = math.sqrt(sum((v - mean) ** 2 for v in values) / (count - 1) / count + error[k] ** 2)
            worst = max(worst, abs(mean - value[k]) / (4 * spread + 1e-6 * abs(value[k]) + 1e-30))
    for e, p in zip(given, answers[at:]):
        for k in range(3):
            spread = math.hypot(p["standard_error"][k], e.get("std_err", [0, 0, 0])[k])
            worst = max(worst, abs(p["irradiance"][k] - e["value"][k]) /
                        (4 * spread + 1e-6 * abs(e["value"][k]) + 1e-30))
    table.add(case["id"], "reference", worst, seconds, "in units of four standard errors")


def matrix(program, case, table):
    """One patch a surface: F from formfactors, B = E + rho F B by Gauss-Seidel."""
    file = program.out / "model.json"
    file.write_text(json.dumps({"id": case["id"], "surfaces": case["surfaces"]}))
    answers, seconds = program.json("formfactors", file, "--method", "exact", "--tolerance", 1e-6)
    names = [s["name"] for s in case["surfaces"]]
    factor = {(p["from"], p["to"]): p["value"] for p in answers["pairs"]}
    worst = 0
    for k in range(3):
        b = {s["name"]: s["emit"][k] for s in case["surfaces"]}
        for _ in range(2000):
            for s in case["surfaces"]:
                b[s["name"]] = s["emit"][k] + s["rho"][k] * sum(factor.get((s["name"], n), 0) * b[n] for n in names)
        for e in case["expect"]:
            if e["quantity"] == "patch_radiosity" or e["quantity"] == "uniform_radiosity":
                worst = max(worst, abs(b[e["surface"]] / e["value"][k] - 1))
    table.add(case["id"], "matrix", worst, seconds, "relative")


def light(program, cases, table, quick):
    pictures = []
    for case in load(cases, "gi_scenes.json"):
        if not case.get("surfaces"):
            continue
        if "groups" in case:
            table.add(case["id"], "–", None, None, "heat, not light: grey bodies by temperature")
            continue
        if case["kind"] == "exact-discrete" or (case["kind"] == "exact" and "furnace" in case["id"]):
            matrix(program, case, table)
        if case["kind"] == "exact-discrete":
            continue
        if max(max(s["rho"]) for s in case["surfaces"]) > REFLECTANCE_CLAMP:
            table.add(case["id"], "–", None, None, "reflects more than 0.95, which is clamped")
            continue
        means = expected_means(case)
        reference(program, case, means, table, quick)
        if means and not (quick and case["kind"] == "converged"):
            hierarchical(program, case, means, table, pictures)
    if quick:
        return
    for worst, gold in sorted(pictures, reverse=True)[:3]:
        program.run("compare", gold, "--reference", "--samples", 1024, "-o", gold.parent / f"worst-{gold.stem}.png",
                    "--full-scale", 0.05, "--quiet")


def main():
    here = Path(__file__).resolve().parent.parent
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--program", default=here / "build/release/bin/goldthread")
    parser.add_argument("--cases", type=Path, default=here.parent / "shared/accuracy")
    parser.add_argument("--out", type=Path, default=here / "out/accuracy")
    options = parser.parse_args()
    if not (options.cases / "view_factors.json").exists():
        print(f"no cases in {options.cases}: nothing is measured")
        return 77  # skipped
    options.out.mkdir(parents=True, exist_ok=True)
    program, table = Program(options.program, options.out), Table()
    form_factor_pairs(program, options.cases, table)
    form_factor_matrices(program, options.cases, table, options.quick)
    light(program, options.cases, table, options.quick)
    (options.out / "table.md").write_text(table.text())
    print(table.text())
    for case, method, error, limit, *_ in table.failures():
        print(f"{case} by {method}: {error:.2e} is more than {limit:.0e}", file=sys.stderr)
    return 1 if table.failures() else 0


if __name__ == "__main__":
    sys.exit(main())
