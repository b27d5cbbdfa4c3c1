"""Smooth shapes with exact light (kind exact-curved): tessellated ever finer, the error has to fall like h²."""

import math
import random

from light import mean_and_spread
from shapes import Scene, nearest_place, random_points, tessellate

# Rings from pole to pole of a sphere: h, h/2, h/4.
RINGS = (12, 24, 48)


def largest_error(rings):
    """Facets lie within the ball by half the square of half a ring's angle, of the radius; of irradiance four times."""
    return 4 * 0.5 * (math.pi / rings) ** 2


def scene_of(case, rings):
    surfaces = [s for i, p in enumerate(case["primitives"]) for s in tessellate(i, p, rings)]
    return Scene(surfaces, case.get("lights", []))


def exact_irradiance(case, scene):
    """Uniform irradiance by surface; empty where the case only knows it at points."""
    exact = {}
    for surface in scene.surfaces:
        index, _, where = surface.name.partition(" ")
        for e in case["expect"]:
            if "point" in e or e.get("primitive", int(index)) != int(index) or e.get("where", where) != where:
                continue
            value = [math.pi * v for v in e["value"]] if e["quantity"] == "uniform_radiance" else e["value"]
            if e["quantity"] != "uniform_irradiance":
                value = [(b - m) / r for b, m, r in zip(value, surface.exitance, surface.reflectance)]
            exact[surface.name] = value
    return exact


def _traced(program, case, scene, exact, name, quick):
    """Irradiance as (found, exact, standard error) in each place that the case knows, by path tracing."""
    chance, count = random.Random(1), 64 if quick else 256
    given = [e for e in case["expect"] if "point" in e]
    places = [{**e, "point": nearest_place(scene.surfaces, e["point"], e["normal"])} for e in given]
    points = [p for s in scene.surfaces if s.name in exact for p in random_points(s, count, chance)]
    samples = 1024 if quick else 2048
    answers, seconds = program.trace(scene, name, points, samples) if points else ([], 0)
    # A place stands for itself alone, where the others are averaged.
    alone, more = program.trace(scene, name, places, 16 * samples) if places else ([], 0)
    out = []
    for i, surface in enumerate(s for s in scene.surfaces if s.name in exact):
        mean, spread = mean_and_spread([p["irradiance"][1] for p in answers[i * count:(i + 1) * count]])
        out.append((mean, exact[surface.name][1], spread))
    out += [(p["irradiance"][1], e["value"][1], p["standard_error"][1]) for e, p in zip(given, alone)]
    return out, seconds + more


def _baked(program, case, scene, exact, name, _):
    """The same by the hierarchical solver, which knows no standard error."""
    lit, _, seconds = program.bake(scene, name)
    out = [(lit.mean_irradiance(i)[1], exact[s.name][1], 0) for i, s in enumerate(scene.surfaces) if s.name in exact]
    out += [(lit.irradiance(e["point"], e["normal"])[1], e["value"][1], 0) for e in case["expect"] if "point" in e]
    return out, seconds


def _fall(errors, noises):
    """How the errors came down: the order of convergence, as far as they stand out of chance."""
    told = [e for e, noise in zip(errors, noises) if e > 4 * noise]
    text = "h, h/2, …: " + ", ".join(f"{e:.1e}" for e in errors)
    if max(noises) == 0:
        return text
    if len(told) < 2 or told != errors[:len(told)]:
        return text + f", all chance: ± {max(noises):.1e}"
    return text + f"; order {math.log2(told[0] / told[-1]) / (len(told) - 1):.1f} over the first {len(told)}"


def curved(program, case, table, quick):
    """A row a method: the error of the finest, and how it came down."""
    for method, measure, steps in (("reference", _traced, RINGS), ("hierarchical", _baked, RINGS[:2])):
        if quick and method == "hierarchical":
            continue
        errors, noises, total = [], [], 0.0
        for rings in steps[:2] if quick else steps:
            scene, name = scene_of(case, rings), f"{case['id']}-{rings}"
            found, seconds = measure(program, case, scene, exact_irradiance(case, scene), name, quick)
            total += seconds
            errors.append(max(abs(value / exact - 1) for value, exact, _ in found))
            noises.append(max(error / exact for _, exact, error in found))
        limit = largest_error(rings) if method == "reference" else None
        table.add(case["id"], method, errors[-1], seconds=total, note=_fall(errors, noises), limit=limit)
