"""What holds for any scene (gi-p-invariants), and plates so large that their edges do not matter."""

import copy
import math
import random
from itertools import chain

import light
import matrix
from shapes import Scene, along, area_and_normal, polygon, random_points, rectangle

# Of the squares that stand in for infinite plates; the case knows the middle to about six over their square.
SIDES = (20, 40)
# The room that is changed: closed, in colours, with a corner that hides a part of it.
ROOM, SECOND_LAMP = "gi-p-lroom-colour", "floor-a"


def _plates(c, side):
    """Two black-backed squares at distance 1 that face each other."""
    corner = -side / 2
    low = rectangle([corner, corner, 0], [side, 0, 0], [0, side, 0])
    high = rectangle([corner, corner, 1], [0, side, 0], [side, 0, 0])
    return Scene([polygon("1", low, [c["rho1"]] * 3, [c["E1"]] * 3),
                  polygon("2", high, [c["rho2"]] * 3, [c["E2"]] * 3)])


def infinite_plates(program, case, table, quick):
    """Radiosity in the middle of two squares, taken to the limit of their side from two of them."""
    middles = [{"point": [0, 0, 0], "normal": [0, 0, 1]}, {"point": [0, 0, 1], "normal": [0, 0, -1]}]
    for method in ("reference",) if quick else ("reference", "hierarchical"):
        worst = total = 0.0
        for i, c in enumerate(case["cases"]):
            found = []
            for side in SIDES:
                scene, name = _plates(c, side), f"{case['id']}-{i}"
                if method == "reference":
                    answers, seconds = program.trace(scene, name, middles, 131072)
                    found.append([a["irradiance"][1] for a in answers])
                else:
                    lit, _, seconds = program.bake(scene, name)
                    found.append([lit.irradiance(m["point"], m["normal"])[1] for m in middles])
                total += seconds
            for k, (small, large) in enumerate(zip(*found), 1):
                limit_irradiance = (4 * large - small) / 3  # what is missing falls like the square of the side
                b = c[f"E{k}"] + c[f"rho{k}"] * limit_irradiance
                worst = max(worst, abs(b / c[f"B{k}"] - 1))
        table.add(case["id"], method, worst, limit=6 / SIDES[1] ** 2, seconds=total,
                  note=f"squares of sides {SIDES[0]} and {SIDES[1]} at distance 1, extrapolated; to 6 / {SIDES[1]}²")


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

    def halved(self):
        """The same with every rectangle in two, `name` and `name'`."""
        parts = []
        for s in self.surfaces:
            a, b, c, d = s["vertices"]
            e, f = along(a, b, 0.5), along(c, d, 0.5)
            parts += [{**s, "vertices": [a, e, f, d]}, {**s, "name": s["name"] + "'", "vertices": [e, b, c, f]}]
        return _Room(self.program, self.method, parts, self.samples)

    def _matrix(self, surfaces):
        case = {"id": "invariants", "surfaces": surfaces}
        factor, seconds = self.program.form_factors(case, "--method", "exact", "--tolerance", 1e-5)
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


def _scaled(value, factor):
    return value[0] * factor, value[1] * factor


def _balance(surfaces, areas, found):
    """What is taken up and what is sent out, a unit of the room's area: they are the same where it is closed."""
    area = sum(areas.values())
    shares = [(areas[s["name"]] * (1 - s["rho"][1]) / area, found[s["name"]]) for s in surfaces]
    taken = sum(w * h for w, (h, _) in shares), math.sqrt(sum((w * e) ** 2 for w, (_, e) in shares))
    return taken, (sum(areas[s["name"]] * s["emit"][1] for s in surfaces) / area, 0.0)


def _of_two_lamps(room, areas, whole):
    """(name, pairs that should be equal, their unit) from a second lamp, of exitance 1."""
    emit = {s["name"]: s["emit"][1] for s in room.surfaces}
    first = next(name for name in emit if emit[name] > 0)
    second = room.irradiance(_painted(emit=lambda n, e: 1.0 if n == SECOND_LAMP else 0.0))
    both = room.irradiance(_painted(emit=lambda n, e: 1.0 if n == SECOND_LAMP else e))
    yield "linear in E", [(both[n], (whole[n][0] + second[n][0], math.hypot(whole[n][1], second[n][1])))
                          for n in emit], None
    yield "reciprocal", [(_scaled(whole[SECOND_LAMP], areas[SECOND_LAMP] / emit[first]),
                          _scaled(second[first], areas[first]))], areas[first]


def _of_the_same_room(room, whole):
    """(name, pairs that should be equal, their unit) of the room in other words."""
    changes = {"a thousand times as large": _moved(lambda v: [1000 * x for x in v]),
               "turned and moved": _moved(_turned),
               "vertices from another on": lambda s: {**s, "vertices": s["vertices"][1:] + s["vertices"][:1]}}
    for name, change in changes.items():
        changed = room.irradiance(change)
        yield name, [(changed[n], whole[n]) for n in whole], None
    if room.method != "matrix":  # whose patches are the surfaces that it is given
        parts = room.halved().irradiance()
        halves = {n: (parts[n], parts[n + "'"]) for n in whole}
        yield "halved", [((0.5 * (a[0] + b[0]), 0.5 * math.hypot(a[1], b[1])), whole[n])
                         for n, (a, b) in halves.items()], None


def _invariants(room, areas):
    """(name, checks) for each property."""
    whole = room.irradiance()
    unit = sum(areas[n] * whole[n][0] for n in areas) / sum(areas.values())

    def checks(check, pairs, of=None):
        out = _Checks(of or unit)
        for found, exact in pairs:
            check(out, found, exact)
        return out

    yield "energy", checks(_Checks.equal, [_balance(room.surfaces, areas, whole)])
    for name, pairs, of in chain(_of_two_lamps(room, areas, whole), _of_the_same_room(room, whole)):
        yield name, checks(_Checks.equal, pairs, of)
    brighter = room.irradiance(_painted(rho=lambda n, r: min(0.9, r + 0.1)))
    yield "no darker for more reflectance", checks(_Checks.at_most, [(whole[n], brighter[n]) for n in whole])
    blocked = _blocked(room)
    yield "no brighter for a blocker", checks(_Checks.at_most, [(blocked[n], whole[n]) for n in whole])


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
        room = _Room(program, method, room_case["surfaces"], 256)
        for name, found in _invariants(room, areas):
            table.add(f"{case['id']}: {name}", method, found.error, seconds=room.seconds,
                      deviate=found.deviate if method == "reference" else None,
                      note=f"{room_case['id']}, of the room's mean irradiance")
            room.seconds = 0.0
