"""The path tracer with a hundred million paths: is anything left but chance?

Both answers hold for the polyhedra, too. A closed room of one exitance and one reflectance is a furnace whatever its
shape. Of two bodies in each other, alike in their facets, the inner sees nothing but the outer, and the mean over each
depends on the ratio of their areas alone, to the fourth power of the facets' size (the product of two deviations of the
second). Receivers are spread by chance, so that their spread holds both what paths and what places leave open."""

import math
import random

from curved import exact_irradiance, scene_of
from light import mean_and_spread
from shapes import random_points

PATHS, RECEIVERS = 100_000_000, 256
# Standard errors. Each of three means is tried once.
LARGEST = 3
# Of a sphere of about 1e5 triangles.
FINE = 160


def long_run(program, cases, table, paths=PATHS):
    """Rows for the emitting sphere and the concentric ones, `paths` each in all."""
    for case in (c for c in cases if c["id"] in ("gi-p-sphere-emitting", "gi-p-concentric-spheres-1")):
        scene = scene_of(case, FINE)
        exact = exact_irradiance(case, scene)
        chance, each = random.Random(1), RECEIVERS // len(scene.surfaces)
        points = [p for s in scene.surfaces for p in random_points(s, each, chance)]
        answers, seconds = program.trace(scene, f"long-{case['id']}", points, math.ceil(paths / RECEIVERS))
        for i, surface in enumerate(scene.surfaces):
            mean, error = mean_and_spread([p["irradiance"][1] for p in answers[i * each:(i + 1) * each]])
            truth = exact[surface.name][1]
            deviate = abs(mean - truth) / error
            note = (f"sphere {surface.name}, {sum(len(s.triangles) for s in scene.surfaces)} triangles: {mean:.9f} ± "
                    f"{error:.1e}, exact {truth:.9f}")
            table.add(case["id"], "reference", abs(mean / truth - 1), deviate=deviate, largest=LARGEST,
                      seconds=seconds if i == 0 else None, note=note)
