#!/usr/bin/env python3
"""What gradus-bench-render refuses before it measures, and how it says so.

    python3 tests/bench/programs_test.py build/gradus-bench-render
"""

import pathlib
import subprocess
import sys
import tempfile
import unittest

SCENES = pathlib.Path(__file__).resolve().parent.parent.parent / "scenes"
PROGRAM = None


class Render(unittest.TestCase):
    def refusal(self, *arguments):
        result = subprocess.run([PROGRAM, *arguments], capture_output=True, text=True, timeout=60)
        self.assertGreater(result.returncode, 0, arguments)
        self.assertEqual(result.stdout, "", arguments)
        return result.stderr

    def test_samples(self):
        for samples in ("0", "-3"):
            self.assertIn("--spp", self.refusal(f"{SCENES}/cornell-box.xml:8x8", "--spp", samples))

    def test_sizes_before_the_first_scene_is_measured(self):
        good, bad = f"{SCENES}/cornell-box.xml:8x8", f"{SCENES}/cornell-box.xml:"
        for size in ("32x32junk", "-1x4", "0x4", "4"):
            self.assertIn("is not SCENE.xml:WxH", self.refusal(good, bad + size))

    def test_a_file_for_the_figures_that_cannot_be_written(self):
        with tempfile.TemporaryDirectory() as folder:
            old, new = pathlib.Path(folder) / "old.json", pathlib.Path(folder) / "new.json"
            old.write_text("figures")
            self.assertIn("cannot write", self.refusal("none.xml:8x8", "--json", f"{folder}/none/new.json"))
            for file in (old, new):
                self.assertNotIn("cannot write", self.refusal("none.xml:", "--json", file))
            self.assertEqual(old.read_text(), "figures")
            self.assertFalse(new.exists())

    def test_light_paths_where_no_ray_of_one_could_be_timed(self):
        ball = """<scene version="3.0.0"><integrator type="path"><integer name="max_depth" value="1"/></integrator>
                  <sensor type="perspective"/><shape type="sphere"/></scene>"""
        with tempfile.TemporaryDirectory() as folder:
            dark = pathlib.Path(folder) / "dark.xml"
            dark.write_text(ball)
            self.assertIn("no light path has a ray", self.refusal(f"{dark}:8x8", "--parts", "light-paths"))

    def test_files_named_by_parameters_are_not_there(self):
        self.assertIn("there is no file", self.refusal(f"{SCENES}/holes.xml:8x8", "--parts", "loading"))


if __name__ == "__main__":
    PROGRAM = pathlib.Path(sys.argv.pop(1))
    if not PROGRAM.exists():
        print(f"skipped: {PROGRAM} was not built")
        sys.exit(77)
    unittest.main()
