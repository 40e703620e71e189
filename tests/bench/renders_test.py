#!/usr/bin/env python3
"""Scenes are found by name, and references that are made are known by what they were made from."""

import dataclasses
import pathlib
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
sys.path.insert(0, str(ROOT / "bench" / "render"))
import gradient  # noqa: E402
import photons  # noqa: E402
import references  # noqa: E402
import renders  # noqa: E402


class FindScene(unittest.TestCase):
    def test_every_name_has_its_files(self):
        names = renders.scene_names()
        self.assertIn("holes-28", names)
        for name in names:
            scene = renders.find_scene(name)
            self.assertTrue(scene.file.exists(), name)
            if scene.reference:
                self.assertTrue(scene.reference.image.exists(), name)
                self.assertTrue(scene.reference.variance.exists(), name)

    def test_a_file_and_a_size(self):
        scene = renders.find_scene(f"{ROOT / 'scenes' / 'holes.xml'}:64x48")
        self.assertEqual((scene.width, scene.height), (64, 48))
        self.assertIsNone(scene.reference)

    def test_anything_else_is_an_error(self):
        for text in ("nonsense", "none.xml:64x48", f"{ROOT / 'scenes' / 'holes.xml'}:64", "", ":64x48"):
            with self.assertRaises(SystemExit, msg=text):
                renders.find_scene(text)


class KnownMethods(unittest.TestCase):
    def of(self, line):
        with tempfile.TemporaryDirectory() as folder:
            program = pathlib.Path(folder) / "gradus"
            program.write_text(f"#!/bin/sh\necho '{line}'\n")
            program.chmod(0o755)
            return renders.known_methods(program)

    def test_are_those_of_the_help(self):
        self.assertEqual(self.of("  --method TEXT:{pt,gpt,auto}=gpt"), ["pt", "gpt", "auto"])
        self.assertEqual(self.of("  -m,--method TEXT:{sppm} ..."), ["sppm"])

    def test_a_help_without_them_is_an_error(self):
        with self.assertRaises(SystemExit):
            self.of("  --seed UINT")


class ReferenceKey(unittest.TestCase):
    def test_changes_with_what_changes_the_image(self):
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "scene.xml"
            file.write_text("<scene/>")
            scene = renders.Scene("a scene", file, 64, 48)
            keys = {references.key(scene, 16), references.key(scene, 32),
                    references.key(dataclasses.replace(scene, width=65), 16),
                    references.key(dataclasses.replace(scene, max_depth=3), 16),
                    references.key(dataclasses.replace(scene, parameters={"density": 7}), 16)}
            (pathlib.Path(folder) / "mesh.ply").write_text("ply")
            keys.add(references.key(scene, 16))
            file.write_text("<scene></scene>")
            keys.add(references.key(scene, 16))
            self.assertEqual(len(keys), 7)
            self.assertEqual(references.key(scene, 16), references.key(scene, 16))


class ProcessTime(unittest.TestCase):
    def test_counts_what_both_need_beside_rendering(self):
        # 64 samples of pt: 6.4 s of rendering, 1 s beside. Into gpt's 13.8 s go 128, and half of the error.
        self.assertAlmostEqual(gradient.equal_process_time([0.1, 1.0, 7.4], [0.2, 0.5, 13.8], 64), 1.0)


class PhotonRates(unittest.TestCase):
    def record(self, seconds, light_paths):
        return {"render_seconds": seconds, "spp": 4, "light_paths": light_paths, "photons": 8e6,
                "stages": [{"name": "light paths, trace", "seconds": 0.5},
                           {"name": "light paths, scatter", "seconds": 0.5}, {"name": "gather", "seconds": 3.0}]}

    def test_are_those_of_one_render(self):
        found = photons.rates_of(self.record(2, 3e6))
        self.assertEqual(found, {"light_paths_per_second": 1.5e6, "light_paths_per_second_of_their_stages": 3e6,
                                 "photons_a_pass": 2e6, "seconds_a_pass": 0.5})

    def test_median(self):
        turns = [photons.rates_of(self.record(seconds, 3e6)) for seconds in (1, 2, 8)]
        self.assertEqual(photons.median_of(turns)["seconds_a_pass"], 0.5)
        self.assertIsNone(photons.median_of(turns + [{**turns[0], "seconds_a_pass": None}])["seconds_a_pass"])


if __name__ == "__main__":
    unittest.main()
