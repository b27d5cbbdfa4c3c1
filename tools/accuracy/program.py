"""Runs goldthread, and the few things that every group of cases asks of it."""

import json
import subprocess
import time
from pathlib import Path

from gltf import Glb, write_scene


class Program:
    """The program under test; its files go to the folder `out`."""

    def __init__(self, path, out):
        self.path, self.out = str(Path(path).resolve()), out

    def run(self, *arguments):
        """Seconds that the program took; ends everything when it fails."""
        begin = time.monotonic()
        done = subprocess.run([self.path, *map(str, arguments)], capture_output=True, text=True)
        if done.returncode != 0:
            raise SystemExit(f"goldthread {' '.join(map(str, arguments))}: {done.stderr.strip()}")
        return time.monotonic() - begin

    def json(self, *arguments):
        """What it writes with --json, and the seconds."""
        file = self.out / "answer.json"
        seconds = self.run(*arguments, "--json", file, "--quiet")
        return json.loads(file.read_text()), seconds

    def form_factors(self, case, *options):
        """Of one case, given as an object: {(from, to): F} of a model, {id: pair} of pairs; and the seconds."""
        file = self.out / "model.json"
        file.write_text(json.dumps(case))
        answers, seconds = self.json("formfactors", file, *options)
        if "surfaces" in case:
            return {(p["from"], p["to"]): p["value"] for p in answers["pairs"]}, seconds
        return {p["id"]: p for p in answers["pairs"]}, seconds

    def bake(self, scene, name, *options):
        """The lit scene of the hierarchical solver, its .gold file, and the seconds."""
        file = self.out / f"{name}.gltf"
        write_scene(scene, file)
        lit, gold = file.with_suffix(".glb"), file.with_suffix(".gold")
        seconds = self.run("bake", file, "-o", lit, "-o", gold, "--quiet", *options)
        return Glb(lit), gold, seconds

    def gather(self, scene, name, points, *options):
        """The lit scene of the hierarchical solver, its light at each {point, normal}, and the seconds."""
        file, asked, told = self.out / f"{name}.gltf", self.out / "points.json", self.out / "answer.json"
        write_scene(scene, file)
        asked.write_text(json.dumps([{"point": p["point"], "normal": p["normal"]} for p in points]))
        lit = file.with_suffix(".glb")
        seconds = self.run("bake", file, "-o", lit, "--points", asked, "--json", told, "--quiet", *options)
        return Glb(lit), [p["irradiance"] for p in json.loads(told.read_text())["points"]], seconds

    def trace(self, scene, name, points, samples, *options):
        """The path tracer's {irradiance, standard_error} at each {point, normal}, and the seconds."""
        file, asked = self.out / f"{name}.gltf", self.out / "points.json"
        write_scene(scene, file)
        asked.write_text(json.dumps([{"point": p["point"], "normal": p["normal"]} for p in points]))
        answer, seconds = self.json("reference", file, "--points", asked, "--samples", samples, *options)
        return answer["points"], seconds
