"""Polygons and smooth shapes: areas, tessellations, places to measure at."""

import math
from dataclasses import dataclass, field

# Nodes and weights of Gauss and Legendre's rule on 0..1, twelve nodes; from the symmetric half on -1..1.
_GAUSS_12 = ((0.1252334085114689, 0.2491470458134028), (0.3678314989981802, 0.2334925365383548),
             (0.5873179542866175, 0.2031674267230659), (0.7699026741943047, 0.1600783285433462),
             (0.9041172563704749, 0.1069393259953184), (0.9815606342467193, 0.0471753363865118))
GAUSS = [(0.5 + 0.5 * sign * x, 0.5 * w) for x, w in _GAUSS_12 for sign in (-1, 1)]


@dataclass
class Surface:
    """One mesh of one material; lit and seen from its front. Exitance in lm/m²."""
    name: str
    positions: list
    triangles: list
    reflectance: list
    exitance: list

    def area(self):
        return sum(area_and_normal([self.positions[k] for k in t])[0] for t in self.triangles)


@dataclass
class Scene:
    """Surfaces, and point lights as {position, intensity}, candela by channel."""
    surfaces: list
    lights: list = field(default_factory=list)


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def cross(a, b):
    return [a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3] for k in range(3)]


def minus(a, b):
    return [x - y for x, y in zip(a, b)]


def along(a, b, t):
    """The point that lies the share t of the way from a to b."""
    return [x + t * (y - x) for x, y in zip(a, b)]


def area_and_normal(vertices):
    """Of a planar polygon, seen counter-clockwise."""
    total = [0.0, 0.0, 0.0]
    for i in range(1, len(vertices) - 1):
        part = cross(minus(vertices[i], vertices[0]), minus(vertices[i + 1], vertices[0]))
        total = [t + 0.5 * p for t, p in zip(total, part)]
    size = math.sqrt(dot(total, total))
    return size, [x / size for x in total] if size > 0 else total


def polygon(name, vertices, reflectance=(0, 0, 0), exitance=(0, 0, 0)):
    """A convex polygon as a fan."""
    fan = [(0, i, i + 1) for i in range(1, len(vertices) - 1)]
    return Surface(name, [list(v) for v in vertices], fan, list(reflectance), list(exitance))


def rectangle(origin, u, v):
    """The vertices of a rectangle that faces u × v."""
    return [list(origin), [o + a for o, a in zip(origin, u)],
            [o + a + b for o, a, b in zip(origin, u, v)], [o + b for o, b in zip(origin, v)]]


def frame_around(outer, inner):
    """A rectangle less a smaller one in its plane, parallel to it and of the same order of vertices."""
    return [[outer[i], outer[(i + 1) % 4], inner[(i + 1) % 4], inner[i]] for i in range(4)]


def _zone(from_angle, to_angle, rings, segments):
    """A zone of the unit sphere between two polar angles, seen from outside: positions and triangles."""
    positions, rows = [], []
    for i in range(rings + 1):
        angle = from_angle + (to_angle - from_angle) * i / rings
        radius, height = math.sin(angle), math.cos(angle)
        begin, count = len(positions), 1 if radius < 1e-12 else segments
        for s in range(count):
            turn = 2 * math.pi * s / segments
            positions.append([radius * math.cos(turn), radius * math.sin(turn), height])
        rows.append([begin + s % count for s in range(segments + 1)])
    triangles = []
    for upper, lower in zip(rows, rows[1:]):
        for s in range(segments):
            quad = (upper[s], lower[s], lower[s + 1], upper[s + 1])
            triangles += [t for t in ((quad[0], quad[1], quad[2]), (quad[0], quad[2], quad[3])) if len(set(t)) == 3]
    return positions, triangles


def _placed(positions, axis, centre, radius):
    """The unit shape around +z, turned to an axis, scaled and moved."""
    length = math.sqrt(dot(axis, axis))
    w = [x / length for x in axis]
    helper = [1.0, 0.0, 0.0] if abs(w[0]) < 0.9 else [0.0, 1.0, 0.0]
    u = minus(helper, [dot(helper, w) * x for x in w])
    size = math.sqrt(dot(u, u))
    u = [x / size for x in u]
    v = cross(w, u)
    return [[c + radius * (p[0] * a + p[1] * b + p[2] * d) for c, a, b, d in zip(centre, u, v, w)] for p in positions]


def _zones_of(primitive):
    """The differently painted parts of a sphere or cap, and the polar angles between which they lie."""
    if primitive["type"] == "spherical_cap":
        return [(primitive, (0, math.radians(primitive["half_angle_deg"])))]
    spans = {"z>0": (0, math.pi / 2), "z<0": (math.pi / 2, math.pi), "": (0, math.pi)}
    return [(zone, spans[zone.get("where", "")]) for zone in primitive.get("zones", [primitive])]


def tessellate(index, primitive, rings):
    """The surfaces of a case's primitive; `rings` from pole to pole of a whole sphere, twice as many around."""
    segments, axis = 2 * rings, primitive.get("axis", primitive.get("normal", [0, 0, 1]))
    if primitive["type"] == "disk":
        rim = [[math.cos(math.pi * s / rings), math.sin(math.pi * s / rings), 0] for s in range(segments)]
        fan = [(segments, s, (s + 1) % segments) for s in range(segments)]
        parts = [(primitive, rim + [[0, 0, 0]], fan)]
    else:
        parts = [(zone, *_zone(*angles, round(rings * (angles[1] - angles[0]) / math.pi), segments))
                 for zone, angles in _zones_of(primitive)]
    surfaces = []
    for paint, positions, triangles in parts:
        if primitive.get("side") == "inside":
            triangles = [(a, c, b) for a, b, c in triangles]
        name = f"{index} {paint.get('where', '')}".strip()
        placed = _placed(positions, axis, primitive["centre"], primitive["radius"])
        surfaces.append(Surface(name, placed, triangles, paint["rho"], paint["emit"]))
    return surfaces


def nearest_in_triangle(corners, point, facing):
    """Weights of a place in a triangle close to the point, and its squared distance; infinite where it faces away."""
    normal = cross(minus(corners[1], corners[0]), minus(corners[2], corners[0]))
    square = dot(normal, normal)
    if square <= 0 or dot(normal, facing) <= 0:
        return [1.0, 0.0, 0.0], math.inf
    weights = [max(0.0, dot(cross(minus(corners[(k + 2) % 3], corners[(k + 1) % 3]),
                                  minus(point, corners[(k + 1) % 3])), normal) / square) for k in range(3)]
    weights = [w / sum(weights) for w in weights]
    place = [sum(w * c[k] for w, c in zip(weights, corners)) for k in range(3)]
    return weights, dot(minus(place, point), minus(place, point))


def nearest_place(surfaces, point, facing):
    """The place on the surfaces' fronts that is nearest to a point."""
    least, found = math.inf, None
    for surface in surfaces:
        for triangle in surface.triangles:
            corners = [surface.positions[k] for k in triangle]
            weights, distance = nearest_in_triangle(corners, point, facing)
            if distance < least:
                least, found = distance, [sum(w * c[k] for w, c in zip(weights, corners)) for k in range(3)]
    return found


def random_points(surface, count, chance):
    """Receivers spread evenly by area, by chance."""
    corners = [[surface.positions[k] for k in t] for t in surface.triangles]
    sized = [area_and_normal(c) for c in corners]
    for i in chance.choices(range(len(corners)), [size for size, _ in sized], k=count):
        root, share = math.sqrt(chance.random()), chance.random()
        a, b, c = corners[i]
        yield {"point": along(a, along(b, c, share), root), "normal": sized[i][1]}


def gauss_points(vertices):
    """Receivers of a rectangle whose `weight` makes smooth irradiance integrate to its mean."""
    normal = area_and_normal(vertices)[1]
    for x, wx in GAUSS:
        for y, wy in GAUSS:
            low, high = along(vertices[0], vertices[1], x), along(vertices[3], vertices[2], x)
            yield {"point": along(low, high, y), "normal": normal, "weight": wx * wy}
