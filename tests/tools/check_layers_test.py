"""The layer check finds what it should, in small trees made for it."""

import sys
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent
sys.path.insert(0, str(ROOT / "tools"))
import check_layers  # noqa: E402


class CheckLayersTest(unittest.TestCase):
    def problems(self, files):
        with tempfile.TemporaryDirectory() as folder:
            for name, text in files.items():
                path = Path(folder) / name
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_text(text)
            return check_layers.check(Path(folder))

    def test_this_repository_is_sound(self):
        self.assertEqual(check_layers.check(ROOT), [])

    def test_allowed_includes(self):
        self.assertEqual(self.problems({
            "src/math/vec.h": "", "src/scene/scene.h": '#include "math/vec.h"\n#include "goldthread/error.h"',
            "include/goldthread/error.h": "", "include/goldthread/bake.h": '#include "goldthread/error.h"',
            "src/session/bake.cpp": '#include "scene/scene.h"\n#include "goldthread/bake.h"',
            "apps/cli/main.cpp": '#include "values.h"\n#include "goldthread/bake.h"', "apps/cli/values.h": "",
        }), [])

    def assert_one(self, files, text):
        found = self.problems(files)
        self.assertEqual(len(found), 1, found)
        self.assertIn(text, found[0])

    def test_forbidden_arrow(self):
        self.assert_one({"src/scene/scene.h": "", "src/cluster/tree.cpp": '#include "scene/scene.h"'},
                        "cluster may not include scene")

    def test_apps_see_public_headers_only(self):
        self.assert_one({"src/scene/scene.h": "", "apps/cli/main.cpp": '#include "scene/scene.h"'},
                        "apps may not include scene")

    def test_public_headers_see_public_headers_only(self):
        self.assert_one({"src/math/vec.h": "", "include/goldthread/bake.h": '#include "math/vec.h"'},
                        "public may not include math")

    def test_unknown_room(self):
        self.assert_one({"src/attic/box.h": ""}, "in no room")

    def test_unknown_header(self):
        self.assert_one({"src/math/vec.h": '#include "math/gone.h"'}, "no header of ours")

    def test_circle(self):
        self.assert_one({"src/math/a.h": '#include "math/b.h"', "src/math/b.h": '#include "math/a.h"'}, "circle")

    def test_comments_do_not_count(self):
        self.assertEqual(self.problems({"src/scene/scene.h": "", "src/cluster/tree.cpp": '// #include "scene/scene.h"'}),
                         [])


if __name__ == "__main__":
    unittest.main()
