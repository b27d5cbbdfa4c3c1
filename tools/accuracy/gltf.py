"""Scenes as glTF, and what a bake has left in them."""

import base64
import json
import math
import struct

from shapes import area_and_normal, nearest_in_triangle


class _Buffer:
    """Accessors over one buffer."""

    def __init__(self):
        self.data, self.views, self.accessors = b"", [], []

    def add(self, values, kind, component, code):
        flat = [x for v in values for x in v]
        chunk = struct.pack(f"<{len(flat)}{code}", *flat)
        self.views.append({"buffer": 0, "byteOffset": len(self.data), "byteLength": len(chunk)})
        self.data += chunk
        count = len(flat) if kind == "SCALAR" else len(values)
        accessor = {"bufferView": len(self.views) - 1, "componentType": component, "count": count, "type": kind}
        if kind == "VEC3":
            accessor["min"] = [min(v[k] for v in values) for k in range(3)]
            accessor["max"] = [max(v[k] for v in values) for k in range(3)]
        self.accessors.append(accessor)
        return len(self.accessors) - 1


def _material(surface):
    """Exitance over pi is the emitted luminance, whose colour glTF keeps within 0..1."""
    luminance = [m / math.pi for m in surface.exitance]
    strength = max(1.0, *luminance)
    return {"pbrMetallicRoughness": {"baseColorFactor": [*surface.reflectance, 1], "metallicFactor": 0},
            "emissiveFactor": [x / strength for x in luminance],
            "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": strength}}}


def _lights(lights):
    """KHR_lights_punctual has one intensity a light, and a colour."""
    for light in lights:
        strength = max(light["intensity"])
        yield {"type": "point", "intensity": strength, "color": [x / strength for x in light["intensity"]]}


def write_scene(scene, file):
    """One mesh a surface, in their order, one-sided; then a node a light."""
    buffer, meshes, nodes = _Buffer(), [], []
    for i, surface in enumerate(scene.surfaces):
        primitive = {"attributes": {"POSITION": buffer.add(surface.positions, "VEC3", 5126, "f")},
                     "indices": buffer.add(surface.triangles, "SCALAR", 5125, "I"), "material": i}
        meshes.append({"name": surface.name, "primitives": [primitive]})
        nodes.append({"mesh": i})
    extensions = ["KHR_materials_emissive_strength"]
    document = {
        "asset": {"version": "2.0"}, "extensionsUsed": extensions, "bufferViews": buffer.views,
        "accessors": buffer.accessors, "materials": [_material(s) for s in scene.surfaces], "meshes": meshes,
        "nodes": nodes, "scene": 0}
    if scene.lights:
        extensions.append("KHR_lights_punctual")
        document["extensions"] = {"KHR_lights_punctual": {"lights": list(_lights(scene.lights))}}
        nodes += [{"translation": light["position"], "extensions": {"KHR_lights_punctual": {"light": i}}}
                  for i, light in enumerate(scene.lights)]
    uri = "data:application/octet-stream;base64," + base64.b64encode(buffer.data).decode()
    document["buffers"] = [{"uri": uri, "byteLength": len(buffer.data)}]
    document["scenes"] = [{"nodes": list(range(len(nodes)))}]
    file.write_text(json.dumps(document))


class Glb:
    """A lit scene."""

    def __init__(self, file):
        data = file.read_bytes()
        length = struct.unpack_from("<I", data, 12)[0]
        self.json = json.loads(data[20:20 + length])
        self.binary = data[28 + length:]
        self._read = {}

    def _accessor(self, index):
        a = self.json["accessors"][index]
        view = self.json["bufferViews"][a["bufferView"]]
        size = {"SCALAR": 1, "VEC3": 3}[a["type"]]
        letter, width = {5121: ("B", 1), 5123: ("H", 2), 5125: ("I", 4), 5126: ("f", 4)}[a["componentType"]]
        stride = view.get("byteStride", size * width)
        start = view.get("byteOffset", 0) + a.get("byteOffset", 0)
        return [struct.unpack_from(f"<{size}{letter}", self.binary, start + i * stride) for i in range(a["count"])]

    def _triangles(self, mesh):
        """(corners, irradiance at each of them, box) of a mesh, read once."""
        if mesh not in self._read:
            self._read[mesh] = list(self._read_triangles(mesh))
        return self._read[mesh]

    def _read_triangles(self, mesh):
        for primitive in self.json["meshes"][mesh]["primitives"]:
            positions = self._accessor(primitive["attributes"]["POSITION"])
            light = self._accessor(primitive["attributes"]["_IRRADIANCE"])
            indices = [i[0] for i in self._accessor(primitive["indices"])]
            for t in range(0, len(indices), 3):
                corners = indices[t:t + 3]
                if len(set(corners)) == 3:
                    places = [positions[c] for c in corners]
                    box = [(min(axis), max(axis)) for axis in zip(*places)]
                    yield places, [light[c] for c in corners], box

    def mean_irradiance(self, mesh):
        """Over the surface, by area."""
        total, weight = [0.0, 0.0, 0.0], 0.0
        for corners, light, _ in self._triangles(mesh):
            size = area_and_normal(corners)[0]
            weight += size
            total = [t + size / 3 * sum(e[k] for e in light) for k, t in enumerate(total)]
        return [x / weight for x in total]

    def irradiance(self, point, normal, meshes=None):
        """Interpolated in the triangle that faces that way and holds the point, or in the nearest such."""
        least, found = math.inf, None
        for mesh in range(len(self.json["meshes"])) if meshes is None else meshes:
            for corners, light, box in self._triangles(mesh):
                if sum(max(low - x, x - high, 0.0) ** 2 for x, (low, high) in zip(point, box)) >= least:
                    continue
                weights, distance = nearest_in_triangle(corners, point, normal)
                if distance < least:
                    least, found = distance, [sum(w * e[k] for w, e in zip(weights, light)) for k in range(3)]
        return found
