#!/usr/bin/env python3
"""bench/report --draw-only on small JSON files: the page is there, whole, and says what they hold."""

import base64
import html
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
sys.path.insert(0, str(ROOT / "bench" / "charts"))
import convergence as chart  # noqa: E402
import kernels as kernels_chart  # noqa: E402
import plotting  # noqa: E402
from pythons import bench_python, find_python  # noqa: E402
import stages as stages_chart  # noqa: E402

MACHINE = {"processor": "a processor", "processors": 2, "load_before": 0.1, "date": "2026-01-01", "commit": "abc",
           "device": {"name": "a device"}}


def convergence():
    factors = {"pt": (1, -1), "gpt": (0.2, -1), "denoised": (0.1, -0.5), "a_new_method": (2, -1)}
    points = [{"scene": scene, "method": method, "budget": f"{spp} samples", "spp": spp, "seed": seed,
               "seconds": spp / 10, "relmse": factor * (spp / 10) ** exponent * (1 + 0.1 * seed),
               "trimmed": factor / spp, "reference_error": 1e-4}
              for scene in ("box <1>", "torus") for method, (factor, exponent) in factors.items()
              for spp in (4, 16, 64) for seed in (1, 2)]
    return {"machine": MACHINE, "command": ["convergence.py", "--quick"], "seeds": 2, "notes": ["mitsuba: skipped"],
            "scenes": [{"name": name, "width": 8, "height": 8, "reference": "another renderer", "reference_spp": 4096,
                        "reference_error": 1e-4} for name in ("box <1>", "torus")],
            "points": points}


def profile():
    def stages(*seconds):
        return [{"name": name, "seconds": value} for name, value in zip(("camera", "trace", "what is new"), seconds)]

    own = {"scene": "torus", "spp": 16, "embree_seconds": 1.0}
    return {"machine": MACHINE, "command": ["profile.py"], "profiles": [
        {**own, "method": "pt", "render_seconds": 4.0, "reconstruction_seconds": 0.0, "stages": stages(1, 2, 1)},
        {**own, "method": "gpt", "render_seconds": 8.0, "reconstruction_seconds": 2.0, "stages": stages(2, 3, 2)}]}


def kernels():
    def error(build, edge, value):
        return {"function": "diffuse", "build": build, "is_edge": edge, "relative_99.9": value}

    def launch(queue, **rates):
        return {"kernel": "shade", "queue": queue, "items_per_second": rates, "bandwidth_over_triad": 0.4}

    return {"device": "a device", "platform": "a platform", "repeats": 3,
            "throughput": [launch(64, float=9e9, relaxed=1e9), launch(1024, float=4e6, relaxed=6e6, double=1e6)],
            "accuracy": {"rates": [{"function": "diffuse",
                                    "items_per_second": {"float": 4e6, "relaxed": 5e6, "double": 1e6}}],
                         "errors": [error("float", False, 1e-7), error("float", True, 1e-5),
                                    error("relaxed", False, 3e-7), error("relaxed", True, 0.0)]}}


def floor(*ratios):
    return {"floor": [{"job": "torus 8x8 4 spp", "ratio": {"median": ratio, "least": ratio / 2, "largest": 2 * ratio},
                       "target": 1.5} for ratio in ratios]}


def holes():
    return {"machine": MACHINE, "command": ["holes.py", "--spp", "4"], "spp": 4,
            "holes": [{"holes": 7, "alpha": 0.5, "gain": 5.375, "paper": 15}]}


def photons():
    own = convergence()
    for point in own["points"]:
        point["method"] = {"gpt": "gpm", "denoised": "sppm"}.get(point["method"], point["method"])
    return {**own, "command": ["photons.py"], "notes": ["gbdpt: skipped"], "rates": {"settings": [
        {"name": "depth 30, roulette from 5", "methods": {"gpm": {
            "light_paths_per_second": 2.5e6, "over_ptracer": 1.6, "seconds_a_pass": 0.25, "over_survey": 6.4}}},
        {"name": "depth 13, no roulette",
         "methods": {"sppm": {"light_paths_per_second": 2e6, "seconds_a_pass": 0.125}}}]}}


def chains():
    points = [{"passes": passes, "throughput": 1 / passes, "reconstruction": 0.25 / passes,
               "throughput_differences": 4 / passes, "gradients": 2 / passes} for passes in (1, 4)]
    return {"chains": [{"job": "box 8x8 4 spp, depth 12", "points": points, "failed_shifts": 0.125}]}


def crops():
    return {"machine": MACHINE, "command": ["crops.py"], "caption": "Crops <of> a box.", "crops": [
        {"scene": "box", "crop": "edges", "place": [0, 0], "relmse": {"denoised": 0.25, "gpt:guided": 0.5},
         "samples": {"denoised": 32, "gpt:guided": 16}, "seconds": {"denoised": 1, "gpt:guided": 1}}]}


PNG = base64.b64decode("iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAAAAAA6fptVAAAACklEQVR4nGNgAAAAAgABSK+kcQAAAABJRU5ErkJggg==")


class Styles(unittest.TestCase):
    def test_tell_methods_apart_that_are_unknown(self):
        names = [*plotting.METHODS, *(f"gpt:weighted:{number}" for number in range(8))]
        styles = plotting.method_styles(names)
        self.assertEqual(list(styles), names)
        self.assertEqual(len(set(styles.values())), len(names))


class Headline(unittest.TestCase):
    def of(self, *ratios, at_least=False):
        return chart.headline([{"scene": f"scene {number}", "method": "gpt",
                                "time": {"ratio": ratio, "at_least": at_least}}
                               for number, ratio in enumerate(ratios)] + [{"scene": "scene 0", "method": "pt"}])

    def test_says_what_the_ratios_say(self):
        self.assertEqual(self.of(4), "gpt needs 4 times less time than pt to the same error on scene 0")
        self.assertEqual(self.of(4, 2, at_least=True),
                         "gpt needs at least 2 to 4 times less time than pt to the same error on 2 of 2 scenes")
        self.assertEqual(self.of(4, 0.5, 0.25), "gpt needs 4 times less time than pt to the same error on 1 of 3 "
                         "scenes, 2 to 4 times more on the others")
        self.assertEqual(self.of(0.5), "gpt needs 2 times more time than pt to the same error on scene 0")
        self.assertEqual(self.of(), "Error against time")


class DrawOnly(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def write(self, name, content):
        (self.folder / name).write_text(json.dumps(content))

    def draw(self):
        command = [sys.executable, ROOT / "bench" / "report", "--draw-only", "--folder", self.folder]
        result = subprocess.run([str(part) for part in command], capture_output=True, text=True)
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
        if "skipped: no matplotlib" in result.stdout:
            print("skipped: no matplotlib")
            self.skipTest("no matplotlib")
        return result.stdout, (self.folder / "report" / "index.html").read_text()

    def test_everything(self):
        self.write("convergence.json", convergence())
        self.write("photons.json", photons())
        self.write("chains.json", chains())
        self.write("profile.json", profile())
        self.write("kernels.json", kernels())
        self.write("floor.json", floor(1.25, 1.5))
        self.write("gradient-floor.json", floor(3))
        self.write("holes.json", holes())
        self.write("crops.json", crops())
        (self.folder / "crops.png").write_bytes(PNG)
        _, page = self.draw()
        for name in ("convergence", "convergence-trimmed", "photons", "chains", "stages", "functions", "kernels"):
            self.assertTrue((self.folder / "report" / f"{name}.png").exists(), name)
        self.assertEqual(page.count("<svg"), 7)
        self.assertEqual(page.count("<svg"), page.count("</svg>"))
        for svg in re.findall(r"<svg.*?</svg>", page, re.DOTALL):
            xml.etree.ElementTree.fromstring(svg)
            self.assertIn("var(--ink)", svg)
            self.assertNotRegex(svg, "#000000|#ffffff")
        self.assertIn("prefers-color-scheme: dark", page)
        self.assertIn("box &lt;1&gt;", page)
        self.assertIn("mitsuba: skipped", page)
        self.assertIn("gbdpt: skipped", page)
        self.assertIn(html.escape("box 8x8 4 spp, after 4 passes: error of the reconstruction 0.25 of the "
                                  "throughput's, of the gradients 0.50 of its differences'; 12% of the shifts fail."),
                      page)
        self.assertIn("<td>gpm</td><td>depth 30, roulette from 5</td><td>2.5e+06</td><td>1.60</td><td>0.25</td>"
                      "<td>6.40</td>", page)
        self.assertIn("<td>sppm</td><td>depth 13, no roulette</td><td>2e+06</td><td></td><td>0.125</td><td></td>", page)
        self.assertIn("a processor, 2 processors; a device", page)
        self.assertIn("<td>gpt</td><td>-1.00</td><td>5.00</td>", page)
        self.assertIn("<td>torus 8x8 4 spp</td><td>pt</td><td>1.25</td><td>0.62 to 2.50</td><td>1.5</td>", page)
        self.assertIn("<td>torus 8x8 4 spp</td><td>gpt</td><td>3.00</td><td>1.50 to 6.00</td><td>1.5</td>", page)
        self.assertIn("<td>edges</td><td>2.50e-01</td><td>5.00e-01</td><td>32</td><td>16</td>", page)
        self.assertIn("Crops &lt;of&gt; a box.", page)
        self.assertIn("<td>7</td><td>5.38</td><td>0.5</td><td>15</td>", page)
        self.assertIn("<td>holes.py --spp 4</td>", page)
        self.assertNotIn("box <1>", page)
        self.assertEqual(re.findall(r'(?:src|href)="(?!data:|#)', page), [], "the page names another file")

    def test_what_is_missing_is_named(self):
        self.write("profile.json", profile())
        for name in ("solver.json", "pictures.json"):
            (self.folder / name).write_text("{")
        self.write("kernels.json", {"specialisation": [{"job": "of an older version"}]})
        printed, page = self.draw()
        self.assertIn("left out: convergence.json is not there", printed)
        self.assertIn("Left out: solver.json is no JSON", page)
        self.assertIn("Left out: pictures.json is no JSON", page)
        self.assertIn("<td>profile.py</td>", page)
        self.assertIn("kernels.json holds nothing", page)
        self.assertEqual(page.count("<svg"), 1)

    def test_takes_the_python_of_the_build_folder_that_is_named(self):
        # This Python may have it, and needs no other then.
        without = self.folder / "without"
        without.mkdir()
        (without / "matplotlib.py").write_text("raise ImportError\n")
        python = bench_python(self.folder / "other")
        python.parent.mkdir(parents=True)
        python.write_text('#!/bin/sh\n[ "$1" = -c ] || echo "drawn by the other"\n')
        python.chmod(0o755)
        command = [sys.executable, ROOT / "bench" / "report", "--draw-only", "--build", "other", "--folder", "."]
        environment = {name: value for name, value in os.environ.items() if name != plotting.PYTHON_VARIABLE}
        environment["PYTHONPATH"] = str(without)
        result = subprocess.run(command, capture_output=True, text=True, cwd=self.folder, env=environment)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("drawn by the other", result.stdout)

    def test_a_folder_that_is_not_there_is_an_error(self):
        command = [sys.executable, ROOT / "bench" / "report", "--draw-only", "--folder", self.folder / "none"]
        result = subprocess.run([str(part) for part in command], capture_output=True, text=True)
        self.assertNotEqual(result.returncode, 0)
        self.assertIn("no such folder", result.stdout + result.stderr)


TITLES_OF_CROPS = """
import sys
sys.path.insert(0, sys.argv[1])
import matplotlib
matplotlib.use("Agg")
from matplotlib import pyplot
import numpy
import crops
row = {"scene": "box", "crop": "edges", "instead": {}, **{key: dict.fromkeys(crops.METHODS, 1)
                                                          for key in ("samples", "relmse")},
       "pictures": [numpy.zeros((crops.HEIGHT, crops.WIDTH, 3))] * (len(crops.METHODS) + 1)}
for count in (1, 4):
    figure = crops.draw(pyplot, [row] * count)
    renderer = figure.canvas.get_renderer()
    figure.draw(renderer)
    limit = figure.bbox.y1
    for axes in figure.axes[::len(crops.METHODS) + 1]:
        assert axes.title.get_window_extent(renderer).y1 <= limit, "a title lies over what is above"
        limit = axes.get_window_extent(renderer).y0
"""


class Crops(unittest.TestCase):
    def test_titles_lie_between_the_pictures(self):
        python = find_python(["matplotlib", "numpy"], plotting.PYTHON_VARIABLE, others=plotting.OTHER_PYTHONS)
        if not python:
            self.skipTest("no matplotlib")
        result = subprocess.run([python, "-c", TITLES_OF_CROPS, ROOT / "bench" / "render"], capture_output=True,
                                text=True)
        self.assertEqual(result.returncode, 0, result.stderr)


class Kernels(unittest.TestCase):
    def test_of_one_name_are_apart(self):
        rows = [{"kernel": name, "file": f"kernels/{file}", "queue": queue}
                for name, file in (("advance", "stages/advance.cl"), ("advance", "solver/conjugate_gradient.cl"),
                                   ("shift", "stages/shift.cl")) for queue in (64, 1024)]
        found = kernels_chart.kernels_of({"throughput": rows})
        self.assertEqual(list(found),
                         ["advance (stages/advance.cl)", "advance (solver/conjugate_gradient.cl)", "shift"])
        self.assertTrue(all(entry["queue"] == 1024 for entry in found.values()))


class PartsOfStages(unittest.TestCase):
    """Each stage that a photon method has of its own is counted to a part of the chart. Their names: kernels/stages."""

    def test_no_stage_of_photons_or_walks_is_other(self):
        expected = {"light paths": ["light paths, emit", "light paths, scatter diffuse", "light paths, photons gather"],
                    "walks": ["walk aim", "walk follow", "walk partition"],
                    "shifts": ["photon_shift", "photon_reconnect diffuse", "photon_arrive", "shift diffuse"],
                    "photons": ["photon_pairs list", "photon_evaluate diffuse", "pair_sum", "pair_difference_sum",
                                "gather_add", "gather_bin", "travel", "photon_order begin"],
                    "film": ["gradient_gather", "gradient_combine", "accumulate", "frame", "gradient_frame"]}
        for part, names in expected.items():
            for name in names:
                self.assertEqual(stages_chart.part_of(name), part, name)
                self.assertIn(part, stages_chart.COLOURS)
        kernels = [file.stem for file in (ROOT / "kernels" / "stages").glob("*.cl")]
        of_photons = [name for name in kernels if re.match("photon_|pair_|gather|walk_", name)]
        self.assertGreater(len(of_photons), 12)
        for name in of_photons:
            self.assertNotEqual(stages_chart.part_of(name.replace("walk_", "walk ")), "other", name)


if __name__ == "__main__":
    program = unittest.main(exit=False)
    if not program.result.wasSuccessful():
        sys.exit(1)
    # What was skipped shall not hide what fails.
    sys.exit(77 if program.result.skipped else 0)
