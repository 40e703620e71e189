#!/usr/bin/env python3
"""Scenes are found by name, references that are made are known by what they were made from, and programs that measure
nothing fail."""

import contextlib
import dataclasses
import io
import json
import pathlib
import subprocess
import sys
import tempfile
import types
import unittest
from unittest import mock

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
sys.path[:0] = [str(ROOT / "bench" / "render"), str(ROOT / "bench" / "peers")]
import compare  # noqa: E402
import convergence  # noqa: E402
import crops  # noqa: E402
import filters  # noqa: E402
import gradient  # noqa: E402
import mitsuba_images  # noqa: E402
import photons  # noqa: E402
import profile  # noqa: E402
import random_noise  # noqa: E402
import random_scenes  # noqa: E402
import references  # noqa: E402
import renders  # noqa: E402
import replicates  # noqa: E402


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


class MadeInstead(unittest.TestCase):
    def test_is_told_where_another_was_asked_for(self):
        for variant, made, expected in (("gpt:guided", "l1", "l1"), ("gpt:guided:denoiser", "guided", None),
                                        ("gpt", "l1", None), ("pt:guided", "none", "none")):
            self.assertEqual(renders.made_instead(variant, {"reconstruction": {"name": made}}), expected, variant)

    def test_is_in_notes_of_curves_once_and_in_titles_of_crops(self):
        measurement = convergence.Measurement(None, renders.find_scene("holes-28"), ".")
        for seed in (1, 2):
            measurement.note_what_was_made("gpt:guided", ("samples", 2), {"reconstruction": {"name": "l1"}})
            measurement.note_what_was_made("gpt:guided", ("samples", 4), {"reconstruction": {"name": "guided"}})
        self.assertEqual(measurement.notes, ["holes-28: gpt:guided at 2 samples is l1"])
        row = {"instead": {"gpt:guided": "l1", "pt:guided": "none"}}
        self.assertEqual([crops.label(row, method) for method in crops.METHODS],
                         ["denoised", "pt guided (is their mean)", "gpt guided (is l1)"])


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


class ReconstructionSeconds(unittest.TestCase):
    """By a header of OpenEXR and a program that keeps how it was called."""

    def of(self, layers=(b"dx.R",), **attributes):
        def attribute(name, kind, value):
            return name + b"\0" + kind + b"\0" + len(value).to_bytes(4, "little") + value

        names = b"".join(name + b"\0" + bytes(16) for name in layers)
        header = b"v/1\1" + bytes(4) + attribute(b"channels", b"chlist", names + b"\0") + b"".join(
            attribute(b"gradus:" + name.encode(), b"string", value) for name, value in attributes.items())
        with tempfile.TemporaryDirectory() as folder:
            folder = pathlib.Path(folder)
            (folder / "image.exr").write_bytes(header + b"\0")
            program = folder / "gradus"
            program.write_text(f"#!/bin/sh\necho \"$@\" > {folder}/called\necho '{{\"seconds\": 3}}' > "
                               f"{folder}/image.solved.json\n")
            program.chmod(0o755)
            seconds = renders.reconstruction_seconds(program, folder / "image.exr")
            called = folder / "called"
            return seconds, called.read_text().split("--quiet")[1].split() if called.exists() else None

    def test_are_those_of_what_the_image_says_was_used(self):
        self.assertEqual(self.of(reconstruction=b"l1"), (3, ["--reconstruction", "l1"]))
        self.assertEqual(self.of([b"B", b"primal_even.R"], guide=b"denoiser", reconstruction=b"guided"),
                         (3, ["--reconstruction", "guided", "--guide", "denoiser"]))

    def test_are_none_where_nothing_was_reconstructed(self):
        self.assertEqual(self.of(reconstruction=b"none"), (0, None))

    def test_without_layers_are_an_error(self):
        with self.assertRaises(SystemExit):
            self.of([b"B", b"G", b"R"], reconstruction=b"l1")


class MitsubaImages(unittest.TestCase):
    def test_each_count_of_a_call_has_its_kernels_before_it_is_timed(self):
        rendered = []

        def render(_, scene, spp, seed, pixels):
            rendered.append((spp, seed))
            return mock.MagicMock(), 1.0

        mitsuba = mock.MagicMock(__version__="3")
        with tempfile.TemporaryDirectory() as folder, \
                mock.patch.object(mitsuba_images, "render", side_effect=render), \
                mock.patch.object(mitsuba_images.mitsuba_setup, "start_mitsuba", return_value=mitsuba), \
                mock.patch.object(mitsuba_images.mitsuba_setup, "load_scene_at_size"), \
                mock.patch.object(sys, "argv", ["", "scene.xml", folder, "--size", "2048x1024", "--spp", "1", "4", "6",
                                                "--seeds", "1", "2"]), contextlib.redirect_stdout(io.StringIO()):
            mitsuba_images.main()
        self.assertEqual(mitsuba_images.parts_of(6, 2048 * 1024), [4, 2])
        self.assertEqual(rendered, [(1, 0), (2, 0), (4, 0), (1, 1), (4, 1), (6, 1), (1, 2), (4, 2), (6, 2)])


class Filters(unittest.TestCase):
    def test_mitsuba_may_say_something_before_its_images(self):
        bench = filters.Bench(types.SimpleNamespace(size="8x8"), pathlib.Path("."))
        with mock.patch.object(renders, "run", return_value='a warning\n{"images": [{"image": "a.exr"}]}\n'):
            self.assertEqual(bench.by_mitsuba("scene.xml", "box", 4, [1]), ["a.exr"])


class Floor(unittest.TestCase):
    def test_counts_the_rays_of_the_stage_that_it_is_the_floor_of(self):
        kinds = {"extension": 5, "shadow": 3, "offset": 2, "edge": 7}
        self.assertEqual(profile.traced_rays({"rays": {kind: {"count": count} for kind, count in kinds.items()}}), 10)


class RandomScenes(unittest.TestCase):
    def code(self, *answers):
        """The exit code where processes of scenes answer so, and whether the temporary folder is left."""
        runs = [subprocess.CompletedProcess([], answer is None, json.dumps(answer), "") for answer in answers]
        with tempfile.TemporaryDirectory() as parent, mock.patch.object(random_scenes.subprocess, "run",
                                                                        side_effect=runs), \
                mock.patch.object(random_scenes, "find_python", return_value="python"), \
                mock.patch.object(tempfile, "tempdir", parent), \
                mock.patch.object(sys, "argv", ["random_scenes.py", "--scenes", str(len(answers))]), \
                contextlib.redirect_stdout(io.StringIO()):
            return random_scenes.main(), any(pathlib.Path(parent).iterdir())

    def test_agree_or_differ(self):
        self.assertEqual(self.code({"pt": ""}, {"pt": ""}, None), (0, False))
        self.assertEqual(self.code({"pt": ""}, {"pt": "block 1"}), (1, True))

    def test_fail_where_too_little_is_compared(self):
        self.assertEqual(self.code(None, None), (1, False))
        self.assertEqual(self.code({"pt": None}, {"pt": None}), (1, False))
        self.assertEqual(self.code({"pt": ""}, None), (1, False))


class RandomNoise(unittest.TestCase):
    def test_summary_counts_what_was_compared(self):
        records = [{"scene": 7, "found": {"box pt": [0.5, 0.25]}}, {"scene": 8, "found": {"box pt": [1.5, 0.75]}},
                   {"scene": 9, "found": {"box pt": None}}]
        printed = io.StringIO()
        with contextlib.redirect_stdout(printed):
            self.assertEqual(random_noise.print_summary(records), 2)
            self.assertEqual(random_noise.print_summary([]), 0)
        self.assertIn("box pt: median 1.00, worst 1.50 (scene 8), above 1 in 1 of 2", printed.getvalue())


class NothingToMeasure(unittest.TestCase):
    def run_bench(self, name, *arguments):
        return subprocess.run([sys.executable, ROOT / "bench" / "render" / name, *arguments], capture_output=True,
                              text=True)

    def test_is_an_error_in_words(self):
        for command in (["lights.py"], ["error_calibration.py", "--variants", "pt"],
                        ["instances.py", "--only", "bogus"], ["filters.py", "no-such-scene.xml"],
                        ["error_calibration.py", "cornell-box", "--spp", "1"], ["precision.py", "--repeats", "1"],
                        ["threads.py", "scene.xml:8x8", "--repeats", "0"], ["lights.py", "--lamps", "2", "--seeds", "0"],
                        *([name, "--repeats", "0"] for name in ("gradient.py", "startup.py", "holes.py")),
                        *([name, "--seeds", "0"] for name in ("filters.py", "convergence.py", "replicates.py"))):
            result = self.run_bench(*command)
            self.assertEqual(result.returncode, 2, command)
            self.assertIn("error: ", result.stderr)

    def test_without_a_reference_is_said(self):
        scene = f"{ROOT / 'scenes' / 'cornell-box.xml'}:16x16"
        for name in ("gradient.py", "precision.py", "replicates.py", "photons.py", "error_calibration.py"):
            # The program is not asked for anything before.
            result = self.run_bench(name, "cornell-box", scene, "--gradus", sys.executable)
            self.assertEqual(result.returncode, 1, name)
            self.assertIn("no reference of cornell-box 16x16", result.stderr)
            self.assertEqual(result.stdout, "")


class Tables(unittest.TestCase):
    def test_columns_of_long_names_stay_below_their_titles(self):
        printed = io.StringIO()
        with contextlib.redirect_stdout(printed):
            convergence.print_summary([{"scene": "box", "method": method, "slope": -1.0}
                                       for method in ("pt", "gpt:guided:denoiser")])
        title, *rows = printed.getvalue().strip().splitlines()
        for row in rows:
            self.assertEqual(row.index("-1.00") + 5, title.index("slope") + 5)

    def test_regret_counts_the_reconstruction_of_whatever_auto_picked(self):
        seconds = {"pt": 1.0, "gpt": 2.0, "auto": 2.0}
        error = {"pt": 1.0, "gpt": 0.25, "auto": 0.25}
        self.assertEqual(gradient.regret_of("gpt", error, seconds, {"gpt": 1.0}), 1)
        self.assertEqual(gradient.regret_of("gpm", error, seconds, {"gpt": 0.0, "gpm": 2.0}), 2)
        with mock.patch.object(renders, "render") as rendered, \
                mock.patch.object(renders, "reconstruction_seconds", return_value=3.0):
            arguments = types.SimpleNamespace(gradus="gradus", spp=4)
            self.assertEqual(gradient.reconstruction_seconds(arguments, None, "pt", "."), 0)
            self.assertEqual(gradient.reconstruction_seconds(arguments, None, "gpm", "."), 3)
            self.assertEqual([call.args[2] for call in rendered.call_args_list], ["gpm"])

    def test_the_gain_that_auto_expects_is_of_runs_that_know_it(self):
        self.assertEqual(gradient.median_gain([{"gain": None}, {"gain": 2}, {"gain": None}, {"gain": 4}]), 3)
        self.assertIsNone(gradient.median_gain([{"gain": None}]))


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

    def test_is_unknown_where_less_than_a_sample_fits(self):
        # The process of pt takes 0.292 s beside rendering, and that of gpt less in all; or no more.
        self.assertIsNone(gradient.equal_process_time([0.001, 0.5, 0.300], [0.003, 0.1, 0.284], 16))
        self.assertIsNone(gradient.equal_process_time([0.25, 0.5, 5.0], [0.5, 0.1, 1.0], 16))


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

    def test_are_of_the_same_depth_and_roulette_on_both_sides(self):
        ours, theirs = [], []

        def run(*command):
            command = [str(part) for part in command]
            said = tuple(command[command.index(option) + 1] for option in ("--max-depth", "--rr-depth"))
            if "render" in command:
                ours.append(said)
                pathlib.Path(command[command.index("--stats") + 1]).write_text(json.dumps(self.record(2, 3e6)))
                return ""
            if command[command.index("--integrator") + 1] == "ptracer":
                theirs.append(said)
            return json.dumps({"samples_per_second": {"median": 1e6}})

        arguments = types.SimpleNamespace(gradus="gradus", passes=4, turns=1)
        with mock.patch.object(renders, "run", side_effect=run):
            found = photons.measure_rates(arguments, ["gpm"], "python")
        self.assertEqual(theirs, [("13", str(renders.NO_ROULETTE)), ("30", "5")])
        self.assertEqual(list(dict.fromkeys(ours)), theirs)
        printed = io.StringIO()
        with contextlib.redirect_stdout(printed):
            photons.print_rates(found)
        for setting in found["settings"]:
            self.assertIn(f"{setting['name']}: Mitsuba 3's particle tracer, 1.00 M", printed.getvalue())
            self.assertEqual(setting["methods"]["gpm"]["over_ptracer"], 1.5)


class Compare(unittest.TestCase):
    def rate(self, record):
        def run(*command):
            pathlib.Path(command[command.index("--stats") + 1]).write_text(json.dumps(record))

        arguments = types.SimpleNamespace(gradus="gradus", max_depth=13, nthreads=0, device=None)
        with tempfile.TemporaryDirectory() as folder, mock.patch.object(renders, "run", side_effect=run):
            return compare.gradus_rate(arguments, "scene.xml", (64, 48), 2, folder)

    def test_counts_the_samples_of_the_image_and_not_those_of_the_filter_around_it(self):
        self.assertEqual(self.rate({"samples": 7072, "spp": 2, "render_seconds": 2.0}), 3072)
        with self.assertRaises(SystemExit):
            self.rate({"samples": 6144, "spp": 1.5, "render_seconds": 2.0})


class Replicates(unittest.TestCase):
    def measured(self, method):
        """What is printed, where comparing by an image's own variance gives 0.5 and by the reference's 0.25 of it."""
        def figures(gradus, image, reference):
            return {"relative_mse": 1.25, "reference_relative_mse": 0.5 if reference.variance == image else 0.25}

        printed = io.StringIO()
        arguments = types.SimpleNamespace(gradus="gradus", method=method, seeds=2)
        with contextlib.redirect_stdout(printed), mock.patch.object(renders, "render"), \
                mock.patch.object(renders, "compare", side_effect=figures) as compared:
            replicates.measure(arguments, renders.find_scene("holes-28"), 4, pathlib.Path("image.exr"))
        return printed.getvalue().split()[-1], compared.call_count

    def test_compare_by_the_image_s_own_variance_only_where_it_tells_it(self):
        self.assertEqual(self.measured("pt"), ("0.500", 6))
        self.assertEqual(self.measured("gpt"), ("-", 4))


if __name__ == "__main__":
    unittest.main()
