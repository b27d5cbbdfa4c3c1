"""What holds for any scene (gi-p-invariants), and plates so large that their edges do not matter."""

import copy
import math
import random

import light
import matrix
from shapes import Scene, area_and_normal, polygon, random_points, rectangle

# Two plates of this side at distance 1: their middles are at infinity's value to six over its square.
SIDE = 20
# The room that is changed: closed, in colours, with a corner that hides a part of it.
ROOM = "gi-p-lroom-colour"


def infinite_plates(program, case, table, quick):
    """Radiosity in the middle of two squares, against that of two infinite plates."""
    limit = 6 / SIDE ** 2
    half = SIDE / 2
    low = rectangle([-half, -half, 0], [SIDE, 0, 0], [0, SIDE, 0])
    high = rectangle([-half, -half, 1], [0, SIDE, 0], [SIDE, 0, 0])
    middles = [{"point": [0, 0, 0], "normal": [0, 0, 1]}, {"point": [0, 0, 1], "normal": [0, 0, -1]}]
    worst, spent = {"reference": 0.0, "hierarchical": 0.0}, {"reference": 0.0, "hierarchical": 0.0}
    for i, c in enumerate(case["cases"]):
        plates = Scene([polygon("1", low, [c["rho1"]] * 3, [c["E1"]] * 3),
                        polygon("2", high, [c["rho2"]] * 3, [c["E2"]] * 3)])
        name, found = f"{case['id']}-{i}", {}
        answers, seconds = program.trace(plates, name, middles, 16384)
        found["reference"], spent["reference"] = [a["irradiance"][1] for a in answers], spent["reference"] + seconds
        if not quick:
            lit, _, seconds = program.bake(plates, name)
            found["hierarchical"] = [lit.irradiance(m["point"], m["normal"])[1] for m in middles]
            spent["hierarchical"] += seconds
        for method, irradiances in found.items():
            for k, h in enumerate(irradiances, 1):
                b = c[f"E{k}"] + c[f"rho{k}"] * h
                worst[method] = max(worst[method], abs(b / c[f"B{k}"] - 1))
    for method in worst:
        if spent[method] > 0:
            table.add(case["id"], method, worst[method], limit=limit, seconds=spent[method],
                      note=f"squares of side {SIDE} at distance 1; to six over its square, as the case says")


class _Room:
    """An L-shaped room and what light does in it by one method: mean irradiance by surface, one channel."""

    def __init__(self, program, method, surfaces, samples):
        self.program, self.method, self.surfaces, self.samples = program, method, surfaces, samples
        self.seconds = 0.0

    def irradiance(self, change=lambda surface: surface, extra=()):
        """{name: (mean, standard error)} of the room with every surface changed, and others added."""
        surfaces = [change(copy.deepcopy(s)) for s in self.surfaces] + list(extra)
        solve = {"matrix": self._matrix, "reference": self._traced, "hierarchical": self._baked}[self.method]
        return solve(surfaces)

    def _matrix(self, surfaces):
        case = {"id": "invariants", "surfaces": surfaces}
        factor, seconds = self.program.form_factors(case, "--method", "exact", "--tolerance", 1e-6)
        self.seconds += seconds
        names = [s["name"] for s in surfaces]
        b = matrix.radiosities(names, factor, {s["name"]: s["emit"][1] for s in surfaces},
                               {s["name"]: s["rho"][1] for s in surfaces})
        return {a: (sum(factor.get((a, n), 0) * b[n] for n in names), 0.0) for a in names}

    def _traced(self, surfaces):
        scene = light.scene_of({"surfaces": surfaces})
        chance, each = random.Random(1), 256
        points = [p for s in scene.surfaces for p in random_points(s, each, chance)]
        answers, seconds = self.program.trace(scene, "invariants", points, self.samples)
        self.seconds += seconds
        return {s.name: light.mean_and_spread([p["irradiance"][1] for p in answers[i * each:(i + 1) * each]])
                for i, s in enumerate(scene.surfaces)}

    def _baked(self, surfaces):
        scene = light.scene_of({"surfaces": surfaces})
        lit, _, seconds = self.program.bake(scene, "invariants")
        self.seconds += seconds
        return {s.name: (lit.mean_irradiance(i)[1], 0.0) for i, s in enumerate(scene.surfaces)}


def _painted(**changes):
    """A change of exitance or reflectance: functions of the surface's name and the old value."""
    def change(surface):
        for key, value in changes.items():
            surface[key] = [value(surface["name"], x) for x in surface[key]]
        return surface
    return change


def _moved(place):
    def change(surface):
        surface["vertices"] = [place(v) for v in surface["vertices"]]
        return surface
    return change


def _turned(v):
    """A turn about an oblique axis (three, four, five; five, twelve, thirteen) and a shift."""
    x, y, z = 0.6 * v[0] - 0.8 * v[1], 0.8 * v[0] + 0.6 * v[1], v[2]
    return [x + 7, (5 * y - 12 * z) / 13 - 2, (12 * y + 5 * z) / 13 + 4]


def _halved(surfaces):
    """Every rectangle in two, `name` and `name'`."""
    out = []
    for s in surfaces:
        a, b, c, d = s["vertices"]
        e, f = [(p + q) / 2 for p, q in zip(a, b)], [(p + q) / 2 for p, q in zip(c, d)]
        out += [{**s, "vertices": [a, e, f, d]}, {**s, "name": s["name"] + "'", "vertices": [e, b, c, f]}]
    return out


class _Checks:
    """Differences, of the mean irradiance of the room and in standard errors."""

    def __init__(self, unit):
        self.unit, self.error, self.deviate = unit, 0.0, 0.0

    def equal(self, found, exact):
        off, spread = found[0] - exact[0], math.hypot(found[1], exact[1])
        self.error = max(self.error, abs(off) / self.unit)
        if spread > 0:
            self.deviate = max(self.deviate, light.deviate(found[0], exact[0], spread))

    def at_most(self, small, large):
        if small[0] > large[0]:
            self.equal(small, large)


def _invariants(room, areas):
    """(name, checks) for each property."""
    surfaces, names = room.surfaces, [s["name"] for s in room.surfaces]
    whole = room.irradiance()
    unit = sum(areas[n] * whole[n][0] for n in names) / sum(areas.values())

    def checks(pairs, unit=unit, below=False):
        out = _Checks(unit)
        for found, exact in pairs:
            (out.at_most if below else out.equal)(found, exact)
        return out

    rho, emit = ({s["name"]: s[key][1] for s in surfaces} for key in ("rho", "emit"))
    taken = [(areas[n] * (1 - rho[n]), whole[n]) for n in names]
    sent, area = sum(areas[n] * emit[n] for n in names), sum(areas.values())
    yield "energy", checks([((sum(w * h for w, (h, _) in taken) / area,
                              math.sqrt(sum((w * e) ** 2 for w, (_, e) in taken)) / area), (sent / area, 0.0))])
    other = "floor-a"
    more = room.irradiance(_painted(emit=lambda n, e: 1.0 if n == other else 0.0))
    both = room.irradiance(_painted(emit=lambda n, e: 1.0 if n == other else e))
    yield "linear in E", checks([(both[n], (whole[n][0] + more[n][0], math.hypot(whole[n][1], more[n][1])))
                                 for n in names])
    lamp = next(n for n in names if emit[n] > 0)
    yield "reciprocal", checks([((areas[other] * whole[other][0] / emit[lamp], areas[other] * whole[other][1] / emit[lamp]),
                                 (areas[lamp] * more[lamp][0], areas[lamp] * more[lamp][1]))], unit=areas[lamp])
    for name, change in (("a thousand times as large", _moved(lambda v: [1000 * x for x in v])),
                         ("turned and moved", _moved(_turned)),
                         ("vertices from another on", lambda s: {**s, "vertices": s["vertices"][1:] + s["vertices"][:1]})):
        changed = room.irradiance(change)
        yield name, checks([(changed[n], whole[n]) for n in names])
    if room.method != "matrix":  # whose patches are what is given
        room.surfaces = _halved(surfaces)
        parts = room.irradiance()
        room.surfaces = surfaces
        yield "halved", checks([((0.5 * (parts[n][0] + parts[n + "'"][0]), 0.5 * math.hypot(parts[n][1], parts[n + "'"][1])),
                                 whole[n]) for n in names])
    brighter = room.irradiance(_painted(rho=lambda n, r: min(0.9, r + 0.1)))
    yield "no darker for more reflectance", checks([(whole[n], brighter[n]) for n in names], below=True)
    yield "no brighter for a blocker", checks([(hidden, whole[n]) for n, hidden in _blocked(room).items() if n in whole],
                                              below=True)


def _blocked(room):
    """With a black sheet of no thickness across a part of the room."""
    sheet = [[0.2, 1.5, 0.5], [0.8, 1.5, 0.5], [0.8, 1.5, 2.5], [0.2, 1.5, 2.5]]
    paint = {"rho": [0, 0, 0], "emit": [0, 0, 0]}
    return room.irradiance(extra=[{"name": "sheet", "vertices": sheet, **paint},
                                  {"name": "back", "vertices": sheet[::-1], **paint}])


def invariants(program, case, room_case, table, quick):
    """A row a property and method."""
    areas = {s["name"]: area_and_normal(s["vertices"])[0] for s in room_case["surfaces"]}
    for method in ("matrix", "reference") if quick else ("matrix", "reference", "hierarchical"):
        room = _Room(program, method, room_case["surfaces"], 256 if quick else 1024)
        for name, found in _invariants(room, areas):
            table.add(f"{case['id']}: {name}", method, found.error, seconds=room.seconds,
                      deviate=found.deviate if method == "reference" else None,
                      note=f"{room_case['id']}, of the room's mean irradiance")
            room.seconds = 0.0
