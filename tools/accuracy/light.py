"""Rooms of polygons with known light, by the path tracer and by the hierarchical solver."""

import math
import random

from shapes import Scene, polygon, random_points
from table import normal_deviate

# What the blocks cover of it counts as dark there; a bake fills it from beside, where nobody looks.
COVERED = {("gi-p-cornell-rgb", "floor")}
# Rooms that the quick half bakes.
QUICK = {"gi-p-furnace-cube", "gi-p-black-lroom", "gi-p-hetero-lroom"}
# Scenes and lamps are in single precision.
ROUNDING = 1e-6


def scene_of(case):
    return Scene([polygon(s["name"], s["vertices"], s["rho"], s["emit"]) for s in case["surfaces"]])


def expected_means(case):
    """Mean irradiance and its standard error by surface, where the case knows it."""
    out = {}
    for e in case.get("expect", []):
        surface = next((s for s in case["surfaces"] if s["name"] == e.get("surface")), None)
        if surface is None:
            continue
        if e["quantity"] == "mean_irradiance":
            out[e["surface"]] = e["value"], e.get("std_err", [0, 0, 0])
        elif e["quantity"] == "uniform_radiosity" and min(surface["rho"]) > 0:
            out[e["surface"]] = [(b - m) / r for b, m, r in zip(e["value"], surface["emit"], surface["rho"])], [0, 0, 0]
    return out


def expected_points(case):
    return [e for e in case.get("expect", []) if "point" in e and e["quantity"] == "irradiance"]


def deviate(found, exact, error):
    """In standard errors, rounding forgiven."""
    off = max(0.0, abs(found - exact) - ROUNDING * abs(exact))
    return off / error if error > 0 else (math.inf if off > 0 else 0.0)


def mean_and_spread(values):
    """The mean and its standard error, from values that are independent of each other."""
    mean = math.fsum(values) / len(values)
    return mean, math.sqrt(math.fsum((v - mean) ** 2 for v in values) / (len(values) - 1) / len(values))


def room_mean(scene, means):
    """Mean irradiance over those surfaces of which it is known."""
    areas = {s.name: s.area() for s in scene.surfaces}
    whole = sum(areas[name] for name in means)
    return [sum(areas[name] * means[name][0][k] for name in means) / whole for k in range(3)]


def root_mean_square(errors):
    return math.sqrt(math.fsum(e * e for e in errors) / len(errors)) if errors else 0.0


def radiance_reaches(published, case_id):
    """A cell of what Radiance reaches at the case's points."""
    case = next((r for r in published if r["id"] == case_id), None)
    if case is None:
        return ""
    name, fine = next((key, value) for key, value in case.items() if key.startswith("fine"))
    seconds = next(value for key, value in fine.items() if key.startswith("seconds"))
    return f"Radiance {name}: rms {fine['rms_rel']:.1e} at points, {seconds:.0f} s"


def _relative(found, exact):
    return [(f - e) / e for f, e in zip(found, exact) if e > 0]


def hierarchical(program, case, published, table):
    """Means over surfaces, of the room's mean; and relative errors at points, interpolated. The worst and its .gold."""
    scene, means, points = scene_of(case), expected_means(case), expected_points(case)
    lit, gold, seconds = program.bake(scene, case["id"])
    unit = room_mean(scene, means)
    worst, where = 0.0, ""
    for i, surface in enumerate(scene.surfaces):
        if surface.name not in means or (case["id"], surface.name) in COVERED:
            continue
        for found, exact, whole in zip(lit.mean_irradiance(i), means[surface.name][0], unit):
            error = abs(found - exact) / whole if whole > 0 else abs(found)
            if error > worst:
                worst, where = error, surface.name
    note = f"a surface's mean, of the room's; worst at {where}"
    if points:
        errors = [r for e in points for r in _relative(lit.irradiance(e["point"], e["normal"]), e["value"])]
        note += f"; rms {root_mean_square(errors):.1e} at {len(points)} points"
    table.add(case["id"], "hierarchical", worst, seconds=seconds, note=note,
              published=radiance_reaches(published, case["id"]) if points else "")
    return worst, gold


def reference(program, case, published, table, quick):
    """The same by path tracing: deviates, of means over surfaces from places spread by chance, and at points."""
    scene, means, given = scene_of(case), expected_means(case), expected_points(case)
    chance, count = random.Random(1), 256 if quick else 400
    points = [p for s in scene.surfaces if s.name in means for p in random_points(s, count, chance)]
    answers, seconds = program.trace(scene, case["id"], points + given, 64 if quick else 1024)
    worst = error = 0.0
    for i, (value, own) in enumerate(means[s.name] for s in scene.surfaces if s.name in means):
        for k in range(3):
            mean, spread = mean_and_spread([p["irradiance"][k] for p in answers[i * count:(i + 1) * count]])
            worst = max(worst, deviate(mean, value[k], math.hypot(spread, own[k])))
            error = max(error, abs(mean / value[k] - 1) if value[k] > 0 else 0)
    at_points = []
    for e, p in zip(given, answers[len(points):]):
        at_points += _relative(p["irradiance"], e["value"])
        for k in range(3):
            spread = math.hypot(p["standard_error"][k], e.get("std_err", [0, 0, 0])[k])
            worst = max(worst, normal_deviate(deviate(p["irradiance"][k], e["value"][k], spread)))
    note = "relative: " + "; ".join(text for text in (
        "worst of the surfaces' means" if means else "",
        f"rms {root_mean_square(at_points):.1e} at {len(given)} points" if given else "") if text)
    table.add(case["id"], "reference", error if means else max(map(abs, at_points)), deviate=worst, seconds=seconds,
              note=note, published=radiance_reaches(published, case["id"]) if given else "")
