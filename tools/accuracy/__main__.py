"""Every exact case through every method that applies, as one table (README.md, "How right it is").

usage: python3 tools/accuracy [--quick | --long] [--program P] [--cases FOLDER] [--out FOLDER]

The table goes to OUT/table.md and to standard output; OUT/worst-*.png show where the worst rooms are wrong. Exit code 1
when a figure is beyond its limit, 77 when there are no cases. --quick leaves out what takes minutes, and pictures;
--long measures the path tracer alone, with a hundred million paths a scene."""

import argparse
import json
import sys
from pathlib import Path

import form_factors
import light
import matrix
from cie import cie
from curved import curved
from long_run import long_run
from program import Program
from properties import ROOM, infinite_plates, invariants
from shapes import area_and_normal
from table import Table

REFLECTANCE_CLAMP = 0.95
PICTURES = 3


def load(folder, name):
    return json.loads((folder / name).read_text())


def polygonal_room(program, case, published, table, quick):
    """A room of polygons through matrix, path tracer and hierarchical solver; how wrong the last is, and its .gold."""
    if "groups" in case:
        areas = {s["name"]: area_and_normal(s["vertices"])[0] for s in case["surfaces"]}
        matrix.heat(program, case, areas, table)
        return None
    if case["kind"] == "exact-discrete" or (case["kind"] == "exact" and "furnace" in case["id"]):
        matrix.rooms(program, case, table)
    if case["kind"] == "exact-discrete":
        return None
    if max(max(s["rho"]) for s in case["surfaces"]) > REFLECTANCE_CLAMP:
        table.skip(case["id"], f"light reflects no more than {REFLECTANCE_CLAMP} in the program")
        return None
    light.reference(program, case, published, table, quick)
    if not light.expected_means(case) or (quick and case["id"] not in light.QUICK):
        return None
    return light.hierarchical(program, case, published, table)


def scenes(program, folder, table, quick):
    """All of gi_scenes.json, and pictures of the worst."""
    published, solved = load(folder, "results_radiance.json"), []
    cases = load(folder, "gi_scenes.json")["cases"]
    for case in cases:
        if case["kind"] == "exact-curved":
            curved(program, case, table, quick)
        elif case["kind"] == "exact-limit":
            infinite_plates(program, case, table, quick)
        elif case["kind"] == "property":
            invariants(program, case, next(c for c in cases if c["id"] == ROOM), table, quick)
        else:
            solved.append(polygonal_room(program, case, published, table, quick))
    for _, gold in [] if quick else sorted(filter(None, solved), reverse=True)[:PICTURES]:
        program.run("compare", gold, "--reference", "--samples", 256, "-o", gold.parent / f"worst-{gold.stem}.png",
                    "--full-scale", 0.05, "--quiet")


def measure(program, folder, table, quick):
    view3d = load(folder, "view3d/results_view3d_public.json")
    form_factors.pairs(program, folder, view3d, table)
    form_factors.matrices(program, folder, view3d, table, quick)
    form_factors.view3d_files(program, folder, table, quick)
    scenes(program, folder, table, quick)
    cie(program, load(folder, "cie171.json")["cases"], load(folder, "results_radiance_cie.json"), table,
        quick)


def arguments():
    here = Path(__file__).resolve().parent.parent.parent
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    extent = parser.add_mutually_exclusive_group()
    extent.add_argument("--quick", action="store_true")
    extent.add_argument("--long", action="store_true")
    parser.add_argument("--program", default=here / "build/release/bin/goldthread")
    parser.add_argument("--cases", type=Path, default=here.parent / "shared/accuracy")
    parser.add_argument("--out", type=Path, default=here / "out/accuracy")
    return parser.parse_args()


def main():
    options = arguments()
    if not (options.cases / "view_factors.json").exists():
        print(f"no cases in {options.cases}: nothing is measured")
        return 77
    options.out.mkdir(parents=True, exist_ok=True)
    program, table = Program(options.program, options.out), Table()
    if options.long:
        long_run(program, load(options.cases, "gi_scenes.json")["cases"], table)
    else:
        measure(program, options.cases, table, options.quick)
    (options.out / ("table-long.md" if options.long else "table.md")).write_text(table.text())
    print(table.text())
    for row in table.failures():
        print(f"beyond its limit: {row.text()}", file=sys.stderr)
    return 1 if table.failures() else 0


if __name__ == "__main__":
    sys.exit(main())
