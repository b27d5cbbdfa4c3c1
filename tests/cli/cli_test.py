"""The command line's contract: exit codes, one-line errors, quiet, progress, interruption. Argument: the program."""

import base64
import json
import math
import os
import signal
import struct
import subprocess
import sys
import tempfile
import time
import unittest
import zlib
from pathlib import Path

PROGRAM = sys.argv.pop(1) if len(sys.argv) > 1 else "build/release/bin/goldthread"
PROGRAM = str(Path(PROGRAM).resolve())


def data_uri(data, kind="application/octet-stream"):
    return f"data:{kind};base64," + base64.b64encode(data).decode()


def floor_document():
    """A triangle of metres that faces +Y, with a metre of room about the origin, as glTF."""
    return {"asset": {"version": "2.0"},
            "buffers": [{"byteLength": 36, "uri": data_uri(struct.pack("<9f", -9, 0, 9, 9, 0, 9, 0, 0, -9))}],
            "bufferViews": [{"buffer": 0, "byteLength": 36}],
            "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3",
                           "min": [-9, 0, -9], "max": [9, 0, 9]}],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
            "nodes": [{"mesh": 0}], "scenes": [{"nodes": [0]}], "scene": 0}


def grey_png(size, grey):
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    rows = b"".join(b"\0" + bytes([grey] * size) for _ in range(size))
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", size, size, 8, 0, 0, 0, 0))
            + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))


class CliTest(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)

    def run_it(self, *arguments):
        return subprocess.run([PROGRAM, *arguments], cwd=self.folder.name, capture_output=True, text=True, timeout=300)

    def path(self, name):
        return Path(self.folder.name) / name

    def assert_fails(self, code, words, *arguments):
        done = self.run_it(*arguments)
        self.assertEqual(done.returncode, code, (arguments, done.stderr))
        errors = [line for line in done.stderr.splitlines() if line.startswith("goldthread: ")]
        self.assertEqual(len(errors), 1, done.stderr)
        for word in words:
            self.assertIn(word, errors[0])

    def test_help_and_version(self):
        self.assertIn("Examples:", self.run_it("--help").stdout)
        for verb in ("make", "info", "bake", "reference", "compare", "formfactors"):
            done = self.run_it(verb, "--help")
            self.assertEqual(done.returncode, 0)
            self.assertIn("--help", done.stdout)
        self.assertRegex(self.run_it("--version").stdout, r"^goldthread \d+\.\d+\.\d+\n$")

    def test_wrong_usage_is_2(self):
        self.assert_fails(2, ["--help"])
        self.assert_fails(2, ["verb", "polish"], "polish", "x.glb")
        self.assert_fails(2, ["teapot", "cornell-box"], "make", "teapot")
        self.assert_fails(2, ["x.txt", ".glb"], "make", "furnace", "-o", "x.txt")
        self.assert_fails(2, ["--triangles"], "make", "car", "--triangles", "many")
        self.assert_fails(2, ["-o"], "bake", "x.glb")
        self.assert_fails(2, ["--points", "--json"], "bake", "x.glb", "-o", "y.glb", "--points", "places.json")
        self.assert_fails(2, ["--points", "--json"], "bake", "x.glb", "-o", "y.glb", "--json", "light.json")
        self.assert_fails(2, ["--quality"], "bake", "x.glb", "-o", "y.glb", "--quality", "best")
        self.assert_fails(2, ["--error"], "bake", "x.glb", "-o", "y.glb", "--error", "little")
        self.assert_fails(2, ["--error", "--quality"], "bake", "x.glb", "-o", "y.glb", "--error", "2%", "--quality", "high")
        self.assert_fails(2, ["--max-memory"], "bake", "x.glb", "-o", "y.glb", "--max-memory", "2X")
        self.assert_fails(2, ["--max-memory"], "bake", "x.glb", "-o", "y.glb", "--max-memory", "-1")
        self.assert_fails(2, ["--sky"], "bake", "x.glb", "-o", "y.glb", "--sky", "1,2")
        self.assert_fails(2, ["--sky"], "bake", "x.glb", "-o", "y.glb", "--sky", "nan")
        bake = ["bake", "x.glb", "-o", "y.glb"]
        self.assert_fails(2, ["--page-size", "--output lightmap"], *bake, "--page-size", "512")
        self.assert_fails(2, ["--map-files", "--output lightmap"], *bake, "--map-files", "maps.exr")
        self.assert_fails(2, ["--page-size"], *bake, "--output", "lightmap", "--page-size", "3")
        self.assert_fails(2, ["--padding"], *bake, "--output", "lightmap", "--padding", "many")
        self.assert_fails(2, [".exr, .hdr or .png"], *bake, "--output", "lightmap", "--map-files", "maps.jpg")
        self.assert_fails(2, [".png rgbm"], *bake, "--output", "lightmap", "--map-files", "maps.exr",
                          "--map-encoding", "rgbm")
        self.assert_fails(2, ["--map-files"], *bake, "--output", "lightmap", "--map-encoding", "half")
        for wrong, *options in [["--place", "--place", "1,2"], ["--place", "--place", "1", "--date", "2026-01-02", "--time", "12:00"],
                                ["--date", "--place", "1,2", "--date", "2026-1", "--time", "12:00"],
                                ["--time", "--place", "1,2", "--date", "2026-01-02", "--time", "25:00"],
                                ["--sky-model", "--place", "1,2", "--date", "2026-01-02", "--time", "12:00"],
                                ["--environment", "--environment-scale", "2"],
                                ["--sky-model", "--ground-reflectance", "0.2"],
                                ["--ies", "--ies-scale", "2"], ["--ies", "--ies", "lamp="]]:
            self.assert_fails(2, [wrong], *bake, *options)
        self.assert_fails(2, ["--time-limit"], "bake", "x.glb", "-o", "y.glb", "--time-limit", "0")
        self.assert_fails(2, ["--picture-size"], "bake", "x.glb", "-o", "y.png", "--picture-size", "960x")
        self.assert_fails(2, ["--sun"], "bake", "x.glb", "-o", "y.glb", "--sun-azimuth", "10")

    def test_wrong_usage_of_reference_is_2(self):
        self.assert_fails(2, ["--points"], "reference", "x.glb")
        self.assert_fails(2, ["--points"], "reference", "x.glb", "--points", "0")
        self.assert_fails(2, ["--points"], "reference", "x.glb", "--points", "-3")
        self.assert_fails(2, ["--vertices"], "reference", "x.glb", "--points", "3", "--vertices")
        self.assert_fails(2, ["--target-error"], "reference", "x.glb", "--points", "3", "--target-error", "few")
        self.assert_fails(2, ["--target-error"], "reference", "x.glb", "--points", "3", "--target-error", "-1%")
        self.assert_fails(2, ["--samples"], "reference", "x.glb", "--points", "3", "--samples", "0")
        self.assert_fails(2, ["--texels", "256x128"], "reference", "x.glb", "--texels", "big")
        self.assert_fails(2, ["--uv"], "reference", "x.glb", "--texels", "8", "--uv", "2")
        self.assert_fails(2, ["--uv", "--texels"], "reference", "x.glb", "--vertices", "--uv", "1")
        self.assert_fails(2, ["x.jpg", ".png"], "reference", "x.glb", "-o", "x.jpg")

    def test_bad_input_is_3(self):
        self.path("empty.glb").write_bytes(b"")
        self.path("cut.ply").write_text("ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\n")
        self.path("really.obj").write_bytes(b"Kaydara FBX Binary  \0")
        for verb in (["info"], ["bake", "-o", "y.glb"], ["reference", "--points", "1"]):
            self.assert_fails(3, ["nope.glb"], *verb, "nope.glb")
            self.assert_fails(3, ["empty.glb"], *verb, "empty.glb")
            self.assert_fails(3, ["cut.ply", "cut off"], *verb, "cut.ply")
            self.assert_fails(3, ["really.obj", ".fbx"], *verb, "really.obj")
        self.assertFalse(self.path("y.glb").exists())

    def test_light_profiles(self):
        floor = floor_document()
        floor["extensionsUsed"] = ["KHR_lights_punctual"]
        floor["extensions"] = {"KHR_lights_punctual": {"lights": [{"type": "spot", "spot": {}, "name": "lamp"}]}}
        floor["nodes"].append({"translation": [0, 2, 0], "rotation": [-0.5 ** 0.5, 0, 0, 0.5 ** 0.5],
                               "extensions": {"KHR_lights_punctual": {"light": 0}}})
        floor["scenes"][0]["nodes"].append(1)
        self.path("floor.gltf").write_text(json.dumps(floor))
        head = "IESNA:LM-63-2002\nTILT=NONE\n1 -1 1 2 1 1 2 0 0 0\n1 1 0\n0 90\n0\n"
        self.path("lamp.ies").write_text(head + "500 500\n")
        self.path("cut.ies").write_text(head + "500\n")
        self.path("places.json").write_text('[{"point": [0, 0, 0], "normal": [0, 1, 0]}]')
        for verb in (["bake"], ["reference", "--samples", "64"]):
            points = ["floor.gltf", "--points", "places.json", "--json", "light.json"]
            self.assert_fails(3, ["cut.ies: line 7", "candela"], *verb, *points, "--ies", "cut.ies")
            self.assert_fails(2, ["'bulb'", "lamp"], *verb, *points, "--ies", "bulb=lamp.ies")
            done = self.run_it(*verb, *points, "--ies", "lamp=lamp.ies", "--ies-scale", "2", "--report", "r.json")
            self.assertEqual(done.returncode, 0, done.stderr)
            light = json.loads(self.path("light.json").read_text())["points"][0]["irradiance"]
            self.assertAlmostEqual(light[1], 2 * 500 / 2 ** 2, delta=0.1)
            self.assertIn("lamp.ies", self.path("r.json").read_text())

    def test_surroundings_of_gltf(self):
        # A white face above: irradiance pi F, of a square at its half side's distance F = 4 atan(1/sqrt 2)/(pi sqrt 2).
        # A white face ahead (-Z), on a floor: half the walls' share, F = (1 - that) / 4.
        above = 4 / math.sqrt(2) * math.atan(1 / math.sqrt(2))
        self.path("places.json").write_text('[{"point": [0, 0, 0], "normal": [0, 1, 0]}]')
        for white, exact in ((2, above), (5, (math.pi - above) / 4), (3, 0)):
            floor = floor_document()
            floor["images"] = [{"uri": data_uri(grey_png(16, 255 if i == white else 0), "image/png")} for i in range(6)]
            floor["extensionsUsed"] = ["EXT_lights_image_based"]
            floor["extensions"] = {"EXT_lights_image_based": {"lights": [
                {"intensity": 100, "specularImages": [list(range(6))], "specularImageSize": 16}]}}
            floor["scenes"][0]["extensions"] = {"EXT_lights_image_based": {"light": 0}}
            self.path("floor.gltf").write_text(json.dumps(floor))
            for verb in (["bake"], ["reference", "--samples", "16384"]):
                done = self.run_it(*verb, "floor.gltf", "--points", "places.json", "--json", "light.json")
                self.assertEqual(done.returncode, 0, done.stderr)
                light = json.loads(self.path("light.json").read_text())["points"][0]["irradiance"]
                self.assertAlmostEqual(light[1], 100 * exact, delta=0.01 * 100 * exact + 1e-3)

    def test_nothing_to_bake_is_4(self):
        self.path("dark.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
        self.assert_fails(4, ["dark.obj", "--sky"], "bake", "dark.obj", "-o", "y.glb")

    def test_cannot_write_is_6(self):
        self.assert_fails(6, ["gone/x.glb"], "make", "furnace", "-o", "gone/x.glb")
        self.run_it("make", "furnace")
        self.assert_fails(6, ["gone/x.glb"], "bake", "furnace.glb", "-o", "gone/x.glb")
        if os.path.exists("/dev/full"):
            self.assert_fails(6, ["/dev/full"], "info", "furnace.glb", "--json", "/dev/full")

    def test_make_and_info(self):
        done = self.run_it("make", "sphere", "--triangles", "2000", "-o", "ball.glb")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("2000 triangles", done.stdout)
        self.assertEqual(self.run_it("info", "ball.glb", "--json", "ball.json").returncode, 0)
        facts = json.loads(self.path("ball.json").read_text())
        self.assertEqual(facts["triangles"], 2000)
        self.assertEqual(facts["shells"], {"count": 1, "closed": 1})
        self.assertEqual(facts["problems"]["inside_out_shells"], 0)  # a room, for the camera is in it
        self.assertAlmostEqual(facts["reflectance"]["mean"], 0.5, places=5)
        self.assertIn("2000", self.run_it("info", "ball.glb").stdout)
        quiet = self.run_it("make", "furnace", "--quiet")
        self.assertEqual((quiet.stdout, quiet.stderr), ("", ""))
        self.assertTrue(self.path("furnace.glb").exists())

    def test_bake(self):
        self.run_it("make", "cornell-box")
        done = self.run_it("bake", "cornell-box.glb", "-o", "lit.glb", "-o", "lit.png", "--quality", "draft",
                           "--report", "r.json", "--picture-size", "64x48", "--threads", "1")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("wrote lit.glb", done.stdout)
        self.assertIn("solve", done.stderr)  # plain progress lines
        self.assertNotIn("\r", done.stderr)
        self.assertEqual(self.path("lit.glb").read_bytes()[:4], b"glTF")
        self.assertEqual(self.path("lit.png").read_bytes()[1:4], b"PNG")
        self.assertGreater(json.loads(self.path("r.json").read_text())["power_lm"]["emitted"], 0)
        quiet = self.run_it("bake", "cornell-box.glb", "-o", "lit.glb", "--quality", "draft", "--quiet")
        self.assertEqual((quiet.returncode, quiet.stdout, quiet.stderr), (0, "", ""))

    def test_bake_light_maps(self):
        self.run_it("make", "cornell-box")
        done = self.run_it("bake", "cornell-box.glb", "-o", "lit.glb", "-o", "lit.gold", "--quality", "draft", "--output",
                           "lightmap", "--page-size", "128", "--map-files", "box.hdr", "--report", "r.json")
        self.assertEqual(done.returncode, 0, done.stderr)
        for name in ("lit.glb", "lit.gold", "box-0.hdr", "box.json"):
            self.assertIn(f"wrote {name}", done.stdout)
        self.assertEqual(self.path("box-0.hdr").read_bytes()[:10], b"#?RADIANCE")
        self.assertEqual([p["file"] for p in json.loads(self.path("box.json").read_text())["pages"]], ["box-0.hdr"])
        self.assertGreater(json.loads(self.path("r.json").read_text())["atlas"]["covered_texels"], 128 * 128 // 3)
        alone = self.run_it("bake", "cornell-box.glb", "--quality", "draft", "--output", "lightmap", "--page-size", "64",
                            "--map-files", "alone.exr")
        self.assertEqual(alone.returncode, 0, alone.stderr)
        self.assertTrue(self.path("alone-0.exr").exists())
        texels = self.run_it("compare", "lit.gold", "--reference", "--texels", "--points", "200", "--samples", "64")
        self.assertEqual(texels.returncode, 0, texels.stderr)
        self.assertIn("RMSE", texels.stdout)
        self.assert_fails(2, ["--light-maps"], "compare", "a.png", "b.png", "--light-maps")

    def test_bake_tells_the_light_at_points(self):
        self.run_it("make", "furnace")
        self.path("places.json").write_text('[{"point": [0.25, -0.5, 0.125], "normal": [0, 1, 0]},'
                                            ' {"point": [-0.5, 0.125, 0.25], "normal": [1, 0, 0]}]')
        done = self.run_it("bake", "furnace.glb", "--points", "places.json", "--json", "-", "--quality", "draft")
        self.assertEqual(done.returncode, 0, done.stderr)
        points = json.loads(done.stdout)["points"]
        self.assertEqual([p["point"] for p in points], [[0.25, -0.5, 0.125], [-0.5, 0.125, 0.25]])
        for point in points:
            for channel in point["irradiance"]:
                self.assertAlmostEqual(channel, 2, delta=0.02)
        self.path("places.json").write_text('[{"point": [9, 9, 9], "normal": [0, 1, 0]}]')
        self.assert_fails(3, ["places.json", "point 0"], "bake", "furnace.glb", "--points", "places.json",
                          "--json", "light.json")
        self.assertFalse(self.path("light.json").exists())

    def test_compare(self):
        self.run_it("make", "furnace")
        self.run_it("bake", "furnace.glb", "-o", "a.gold", "--quality", "draft")
        done = self.run_it("compare", "a.gold", "--reference", "--points", "50", "--samples", "256", "--json", "c.json",
                           "-o", "d.png", "--picture-size", "16x12")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("RMSE", done.stdout)
        figures = json.loads(self.path("c.json").read_text())
        for name in ("points", "relative_rmse", "bias", "median_relative_error", "p99_relative_error",
                     "reference_noise"):
            self.assertIn(name, figures)
        self.assertEqual(sorted(set(figures["worst"]) & {"position", "relative_error"}), ["position", "relative_error"])
        self.assertEqual(self.path("d.png").read_bytes()[1:4], b"PNG")
        printed = self.run_it("compare", "a.gold", "a.gold", "--json", "-")
        self.assertEqual(json.loads(printed.stdout)["relative_rmse"], 0)
        self.assert_fails(2, ["--samples", "--reference"], "compare", "a.gold", "a.gold", "--samples", "5")
        self.assert_fails(3, ["nope.gold"], "compare", "nope.gold", "a.gold")

    SQUARES = {"surfaces": [{"name": "floor", "vertices": [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]},
                            {"name": "lid", "vertices": [[0, 1, 1], [1, 1, 1], [1, 0, 1], [0, 0, 1]]}]}

    def test_formfactors(self):
        pair = {"id": "p", "from": {"type": "polygon", **self.SQUARES["surfaces"][0]},
                "to": {"type": "polygon", **self.SQUARES["surfaces"][1]}}
        self.path("cases.json").write_text(json.dumps({"cases": [pair, {"id": "m", **self.SQUARES}]}))
        done = self.run_it("formfactors", "cases.json", "--json", "f.json", "--text", "f.txt")
        self.assertEqual(done.returncode, 0, done.stderr)
        facts = json.loads(self.path("f.json").read_text())
        exact = 0.199824895698387383  # Howell C-11
        self.assertEqual([p["id"] for p in facts["pairs"]], ["p", "m", "m"])
        for answer in facts["pairs"]:
            self.assertAlmostEqual(answer["value"], exact, delta=answer["error_bound"] + 1e-14)
            self.assertEqual(answer["method"], "contour")
        self.assertEqual(len(facts["row_sums"]), 2)
        self.assertAlmostEqual(facts["row_sums"][0], exact, places=12)
        self.assertAlmostEqual(facts["cases"][0]["environment"][0], 1 - exact, delta=0.05)
        self.assertEqual(len(self.path("f.txt").read_text().splitlines()), 3)
        self.assertIn("floor", done.stdout)
        self.assert_fails(2, ["--npz", "--case"], "formfactors", "cases.json", "--npz", "f.npz")
        self.assert_fails(2, ["nosuch"], "formfactors", "cases.json", "--case", "nosuch")
        self.assertEqual(self.run_it("formfactors", "cases.json", "--case", "m", "--npz", "f.npz").returncode, 0)
        self.assertEqual(self.path("f.npz").read_bytes()[:2], b"PK")

    def test_formfactors_of_curved_shapes_past_occluders(self):
        disk = {"type": "disk", "centre": [0, 0, 0], "normal": [0, 0, 1], "radius": 1}
        other = {"type": "disk", "centre": [0, 0, 1], "normal": [0, 0, -1], "radius": 1}
        half = {"vertices": [[-9, 0, 0.5], [9, 0, 0.5], [9, 9, 0.5], [-9, 9, 0.5]]}
        self.path("discs.json").write_text(json.dumps({"from": disk, "to": other, "occluders": [half]}))
        done = self.run_it("formfactors", "discs.json", "--tolerance", "1e-3", "--json", "f.json")
        self.assertEqual((done.returncode, "warning" in done.stderr), (0, False), done.stderr)
        self.assertRegex(done.stdout, r"± \S+ rays, standard error \S+")
        answer = json.loads(self.path("f.json").read_text())["pairs"][0]
        self.assertEqual(answer["method"], "rays")
        half_of_all = (3 - 5 ** 0.5) / 4  # Howell C-41, and reflection
        self.assertAlmostEqual(answer["value"], half_of_all, delta=4 * answer["standard_error"])
        self.assertLessEqual(answer["error_bound"], 1e-3 * answer["value"])
        hard = self.run_it("formfactors", "discs.json", "--tolerance", "1e-9")
        self.assertIn("more than the tolerance 1.0e-09", hard.stderr)

    def test_formfactors_of_view3d_masks(self):
        corners = [(x, y, z) for z in (0, 1) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))]
        corners += [(.4, .4, 0), (.6, .4, 0), (.6, .6, 0), (.4, .6, 0)]
        text = "F 3\n" + "".join("V %d %g %g %g\n" % (i + 1, *c) for i, c in enumerate(corners))
        text += "S 1 1 2 3 4 0 0 .9 bottom\nS 2 8 7 6 5 0 0 .9 top\n"
        self.path("mask.vs3").write_text(text + "M 3 12 11 10 9 1 0 .9 rug\nEnd\n")
        self.path("null.vs3").write_text(text + "N 3 12 11 10 9 1 0 .9 hole\nEnd\n")
        values = {}
        for name in ("mask", "null"):
            self.assertEqual(self.run_it("formfactors", name + ".vs3", "--json", "f.json").returncode, 0)
            for pair in json.loads(self.path("f.json").read_text())["pairs"]:
                values[name, pair["from"], pair["to"]] = pair["value"]
        self.assertEqual(len(values), 6)
        whole = 0.199824895698387383  # Howell C-11
        self.assertEqual(values["mask", "rug", "bottom"], 1)
        self.assertAlmostEqual(values["mask", "bottom", "rug"], 0.04, places=12)
        seen = values["mask", "bottom", "top"]
        self.assertTrue(0.8 * whole < seen < 0.96 * whole)  # what lies in the middle sees more than the mean
        self.assertAlmostEqual(values["null", "bottom", "top"], seen / 0.96, places=12)
        self.assertAlmostEqual(values["null", "top", "bottom"], seen, places=12)
        self.assertIn("item buffers", self.run_it("formfactors", "mask.vs3", "--method", "hemicube", "--resolution",
                                                  "16").stderr)

    def test_formfactors_name_what_is_wrong(self):
        self.path("bent.json").write_text(
            '{"surfaces":[{"vertices":[[0,0,0],[1,0,0],[1,1,0.4],[0,1,0]]}]}')
        self.assert_fails(3, ["bent.json", "surface 1", "planar"], "formfactors", "bent.json")
        self.path("mask.vs3").write_text("F 3\nV 1 0 0 0\nM 1 1 1 1 1 0 0 1\n")
        self.assert_fails(3, ["mask.vs3", "line 3"], "formfactors", "mask.vs3")
        self.path("x.txt").write_text("?")
        self.assert_fails(2, ["x.txt", ".vs3"], "formfactors", "x.txt")
        self.assert_fails(2, ["--method"], "formfactors", "bent.json", "--method", "guess")
        self.path("ok.json").write_text(json.dumps(self.SQUARES))
        self.assert_fails(6, ["gone/f.json"], "formfactors", "ok.json", "--json", "gone/f.json")
        self.assertFalse(self.path("f.json").exists())

    def test_reference(self):
        self.run_it("make", "furnace")
        done = self.run_it("reference", "furnace.glb", "--points", "20", "--samples", "256", "--json", "p.json",
                           "--report", "r.json")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("20 points", done.stdout)
        self.assertIn("wrote p.json", done.stdout)
        points = json.loads(self.path("p.json").read_text())
        mean = sum(point["irradiance"][0] for point in points["points"]) / 20
        self.assertAlmostEqual(mean, 2, delta=0.05)
        self.assertNotIn("points", json.loads(self.path("r.json").read_text()))
        printed = self.run_it("reference", "furnace.glb", "--resume", "p.json", "--samples", "512", "--json", "-",
                              "--quiet")
        self.assertEqual(json.loads(printed.stdout)["samples"], {"least": 512, "most": 512})
        quiet = self.run_it("reference", "furnace.glb", "-o", "p.png", "--picture-size", "32x24", "--quiet",
                            "--target-error", "20%", "--sun", "1000")
        self.assertEqual((quiet.returncode, quiet.stdout, quiet.stderr), (0, "", ""))
        self.assertEqual(self.path("p.png").read_bytes()[1:4], b"PNG")
        self.path("off.json").write_text('[{"point": [0, 0, 0], "normal": [0, 1, 0]}]')
        self.assert_fails(3, ["off.json", "point 0", "0.5 m"], "reference", "furnace.glb", "--points", "off.json")

    def test_reference_texels(self):
        self.path("floor.obj").write_text("v 0 0 0\nv 0 0 1\nv 1 0 1\nv 1 0 0\nvt 0 0\nvt 0 1\nvt 1 1\nvt 1 0\n"
                                          "f 1/1 2/2 3/3 4/4\n")
        done = self.run_it("reference", "floor.obj", "--texels", "4x2", "--uv", "0", "--sky", "10000lux",
                           "--samples", "256", "-o", "map.exr", "--json", "map.json")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("1 light map of 4 x 2 texels", done.stdout)
        self.assertEqual(self.path("map.exr").read_bytes()[:4], b"\x76\x2f\x31\x01")
        points = json.loads(self.path("map.json").read_text())["points"]
        self.assertEqual(sorted(point["texel"] for point in points), [[x, y] for x in range(4) for y in range(2)])
        for point in points:
            self.assertAlmostEqual(point["irradiance"][1], 10000, delta=4 * point["standard_error"][1] + 0.1)
        self.assert_fails(3, ["floor.obj", "TEXCOORD_1"], "reference", "floor.obj", "--texels", "4", "--uv", "1",
                          "--sky", "1")

    def test_interrupted_reference_writes_what_there_is_and_is_130(self):
        self.run_it("make", "office")
        run = subprocess.Popen([PROGRAM, "reference", "office.glb", "--vertices", "--samples", "1000000000", "--json",
                                "p.json"], cwd=self.folder.name, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        time.sleep(2)
        run.send_signal(signal.SIGINT)
        begin = time.monotonic()
        run.communicate(timeout=60)
        self.assertLess(time.monotonic() - begin, 5)  # a second, and what a busy machine adds
        self.assertEqual(run.returncode, 130)
        self.assertEqual(json.loads(self.path("p.json").read_text())["stopped_by"], "cancelled")

    def test_sun_stands_alone_before_the_scene(self):
        self.run_it("make", "cornell-box")
        done = self.run_it("bake", "--quality", "draft", "-o", "lit.glb", "--sun", "cornell-box.glb")
        self.assertEqual(done.returncode, 0, done.stderr)

    def test_reference_and_bake_know_the_same_sky(self):
        self.path("ground.obj").write_text("v -1 0 -1\nv -1 0 1\nv 1 0 1\nv 1 0 -1\nf 1 2 3\nf 1 3 4\n")
        sky = ["--sky-model", "preetham", "--place", "59.33,18.07", "--date", "2026-06-21", "--time", "13:00",
               "--time-zone", "2", "--sun", "--ground-reflectance", "0.2"]
        done = self.run_it("bake", "ground.obj", "-o", "s.gold", "--quality", "draft", *sky)
        self.assertEqual(done.returncode, 0, done.stderr)
        done = self.run_it("compare", "s.gold", "--reference", "--points", "200", "--samples", "256", "--json", "c.json")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertLess(abs(json.loads(self.path("c.json").read_text())["bias"]), 0.005)
        done = self.run_it("reference", "ground.obj", "--points", "100", "--samples", "64", "--json", "r.json", *sky)
        self.assertEqual(done.returncode, 0, done.stderr)

    def test_interrupted_bake_writes_what_there_is_and_is_130(self):
        self.run_it("make", "office")
        bake = subprocess.Popen([PROGRAM, "bake", "office.glb", "-o", "lit.glb", "--quality", "final"],
                                cwd=self.folder.name, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        time.sleep(2)
        if bake.poll() is not None:
            self.skipTest("too fast to be interrupted")
        bake.send_signal(signal.SIGINT)
        bake.communicate(timeout=60)
        self.assertEqual(bake.returncode, 130)
        self.assertEqual(self.path("lit.glb").read_bytes()[:4], b"glTF")


if __name__ == "__main__":
    unittest.main()
