#!/usr/bin/env python3
"""Error against time: methods x scenes x budgets x seeds, with rivals where they are there.

    python3 bench/render/convergence.py [SCENE ...] [--method pt gpt gpt:weighted pt:guided gpt:guided:denoiser]
                                        [--spp 4 16 64] [--seconds 1 4] [--seeds 5]
    python3 bench/render/convergence.py --quick       # two scenes, few samples, two seeds

SCENE is a name in tests/references, whose reference another renderer made; cornell-box-256 or torus-soft-256, of
../shared where that is present; or SCENE.xml:WxH, for which a reference is made once by path tracing with
--reference-spp samples and kept in build/bench/cache. Default: all that have a reference but those for photons, which
render/photons.py measures. A budget is a sample count
(--spp) or a time (--seconds).

A method may say its reconstruction and guide. pt and `denoised` are measured at four times the largest sample count,
too, so that their curves reach the times of those that sample gradients. ratios.py makes tables of what was measured.

Rivals: `denoised`, our path tracing (with albedo and normal, denoised before) through Open Image Denoise, whose time
counts, that of denoising albedo and normal left out; `mitsuba`, Mitsuba 3's path tracer. Where they are missing they are skipped with a note; how to get them is in
bench/peers/README.md.

Seconds are those of rendering and of reconstructing or denoising. Left out in all: start, loading, compiling, writing.
The methods take turns, so that a busy machine slows all alike. relMSE and its trimmed form are as `gradus compare`
defines them; the reference's own error stands beside them, and errors near it say nothing of a method.
"""

import argparse
import json
import os
import pathlib
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
PEERS = HERE.parent / "peers"
sys.path[:0] = [str(HERE), str(PEERS)]
import curves  # noqa: E402
import denoiser_setup  # noqa: E402
import mitsuba_setup  # noqa: E402
import references  # noqa: E402
import renders  # noqa: E402
from pythons import find_python  # noqa: E402

QUICK_SCENES = ["cornell-box", "door-ajar"]
QUICK_SPP, FULL_SPP = [4, 16, 64], [4, 16, 64, 256, 1024]


class Measurement:
    """The points of one scene, in the order in which they are measured."""

    def __init__(self, arguments, scene, folder):
        self.arguments, self.scene, self.folder = arguments, scene, pathlib.Path(folder)
        self.points = []
        self.notes = []
        self.to_denoise = []  # (image with its guides, statistics, budget, seed)
        self.device = None

    def add(self, method, budget, spp, seed, seconds, image, **more):
        figures = renders.compare(self.arguments.gradus, image, self.scene.reference)
        if figures["non_finite"]:
            print(f"{self.scene.name}, {method}: {figures['non_finite']} values are not finite", flush=True)
        self.points.append({"scene": self.scene.name, "method": method, "budget": budget, "spp": spp, "seed": seed,
                            "seconds": seconds, "relmse": figures["relative_mse"],
                            "trimmed": figures["trimmed_relative_mse"], "mean_ratio": figures["mean_ratio"],
                            "non_finite": figures["non_finite"],
                            "reference_error": figures["reference_relative_mse"], "load": os.getloadavg()[0], **more})

    def render(self, variant, budget, seed, aov=False):
        name = variant.replace(":", "-")
        image = self.folder / f"{name}{'-aov' if aov else ''}-{seed}-{budget[0]}-{budget[1]}.exr"
        method, options = renders.split_variant(variant)
        record = renders.render(self.arguments.gradus, self.scene, method, seed, image, aov=aov, variance=False,
                                 options=options, **dict([budget]))
        self.device = record["device"]
        return image, record

    def note_what_was_made(self, method, budget, record):
        made = renders.made_instead(method, record)
        note = f"{self.scene.name}: {method} at {budget[1]} {budget[0]} is {'their mean' if made == 'none' else made}"
        if made and note not in self.notes:
            self.notes.append(note)

    def warm_up(self, methods, denoised):
        """Fills the kernel caches."""
        for method in methods:
            image, _ = self.render(method, ("samples", 4), 0)
            renders.reconstruction_seconds(self.arguments.gradus, image)
        if denoised:
            self.render("pt", ("samples", 1), 0, aov=True)

    def measure(self, methods, budgets, denoised):
        reconstruction = {}
        longer = [("samples", 4 * max(number for unit, number in budgets if unit == "samples"))
                  ] if budgets[0][0] == "samples" else []
        for seed in range(1, self.arguments.seeds + 1):
            for budget in budgets + longer:
                for method in methods:
                    if budget in longer and method != "pt":
                        continue
                    image, record = self.render(method, budget, seed)
                    self.note_what_was_made(method, budget, record)
                    if (method, budget) not in reconstruction:
                        reconstruction[method, budget] = renders.reconstruction_seconds(self.arguments.gradus, image)
                    self.add(method, f"{budget[1]} {budget[0]}", record["spp"], seed,
                             record["render_seconds"] + reconstruction[method, budget], image,
                             render_seconds=record["render_seconds"],
                             reconstruction_seconds=reconstruction[method, budget])
                    image.unlink()
                if denoised:
                    self.to_denoise.append((*self.render("pt", budget, seed, aov=True), budget, seed))

    def denoise(self, python):
        files = []
        for image, *_ in self.to_denoise:
            files += [image, image.with_suffix(".denoised.exr")]
        seconds = json.loads(
            renders.run(python, PEERS / "denoise.py", "--clean-features", *files).splitlines()[-1])
        for (image, record, budget, seed), denoising, target in zip(self.to_denoise, seconds, files[1::2]):
            self.add("denoised", f"{budget[1]} {budget[0]}", record["spp"], seed,
                     record["render_seconds"] + denoising, target, render_seconds=record["render_seconds"],
                     denoising_seconds=denoising)

    def mitsuba(self, python, samples):
        command = [python, PEERS / "mitsuba_images.py", self.scene.file, self.folder]
        command += ["--size", f"{self.scene.width}x{self.scene.height}", "--spp", *samples]
        command += ["--seeds", *range(1, self.arguments.seeds + 1), *renders.box_filter(self.scene)]
        for name, value in self.scene.parameters.items():
            command += ["-D", f"{name}={value}"]
        if self.scene.max_depth is not None:
            command += ["--max-depth", self.scene.max_depth]
        record = json.loads(renders.run(*command).splitlines()[-1])
        for made in record["images"]:
            self.add("mitsuba", f"{made['spp']} samples", made["spp"], made["seed"], made["seconds"], made["image"])


def find_rivals(arguments, samples):
    """(Python for denoising or None, Python for Mitsuba or None, notes on what is left out and why)."""
    if arguments.no_rivals:
        return None, None, ["rivals left out by --no-rivals"]
    notes = []
    denoiser = find_python(denoiser_setup.MODULES, denoiser_setup.PYTHON_VARIABLE)
    if not denoiser:
        notes.append(f"denoised: skipped, Open Image Denoise is missing ({denoiser_setup.PYTHON_VARIABLE}; see "
                     "bench/peers/README.md)")
    mitsuba = find_python(["mitsuba"], mitsuba_setup.PYTHON_VARIABLE)
    if not mitsuba:
        notes.append(f"mitsuba: skipped, Mitsuba 3 is missing ({mitsuba_setup.PYTHON_VARIABLE}; see "
                     "bench/peers/README.md)")
    elif not samples:
        notes.append("mitsuba: skipped, it takes sample counts and no times")
        mitsuba = None
    return denoiser, mitsuba, notes


def print_summary(summaries):
    width = max(9, *(len(entry["method"]) for entry in summaries), 0)
    print(f"\n{'scene':<20} {'method':<{width}} {'slope':>6} {'time of pt':>11} {'at relMSE':>10} {'error of pt':>12} "
          f"{'at s':>7}  error against denoised")
    for entry in summaries:
        slope = "" if entry["slope"] is None else f"{entry['slope']:.2f}"
        time, equal = entry.get("time"), entry.get("equal_time")
        at_least = ">" if time and time["at_least"] else ""
        print(f"{entry['scene']:<20} {entry['method']:<{width}} {slope:>6} "
              + (f"{at_least}{time['ratio']:.2f} x".rjust(11) + f" {time['error']:10.2g}" if time else " " * 22)
              + (f" {equal['ratio']:10.2f} x {equal['seconds']:7.2g}" if equal else " " * 21)
              + f"  {entry.get('against_denoised', '')}")


def main():
    parser = argparse.ArgumentParser(description="error against time")
    parser.add_argument("scenes", nargs="*", metavar="SCENE", help=f"of {', '.join(renders.scene_names())}, or "
                        "SCENE.xml:WxH (default: all of the former but those for photons)")
    parser.add_argument("--quick", action="store_true", help="few scenes, samples and seeds unless given")
    parser.add_argument("--gradus", type=pathlib.Path, default=renders.ROOT / "build" / "gradus")
    parser.add_argument("--method", nargs="+", default=["pt", "gpt"], metavar="METHOD[:RECONSTRUCTION[:GUIDE]]",
                        help="as gradus render takes them (pt gpt)")
    parser.add_argument("--spp", type=renders.at_least(1), nargs="*",
                        help=f"samples a pixel ({FULL_SPP}; quick: {QUICK_SPP})")
    parser.add_argument("--seconds", type=float, nargs="*", default=[], help="times of rendering")
    parser.add_argument("--seeds", type=renders.at_least(1), help="seeds of each (5; quick: 2)")
    parser.add_argument("--reference-spp", type=renders.at_least(1), default=16384,
                        help="of references that are made (16384)")
    parser.add_argument("--no-rivals", action="store_true", help="leave Mitsuba and the denoiser out")
    parser.add_argument("--cache", type=pathlib.Path, default=renders.ROOT / "build" / "bench" / "cache")
    parser.add_argument("--json", type=pathlib.Path, default=renders.ROOT / "build" / "bench" / "convergence.json")
    arguments = parser.parse_args()
    quick = arguments.quick
    if not arguments.gradus.exists():
        sys.exit(f"{arguments.gradus}: no such program; build it, or name it with --gradus")
    if arguments.spp is None:
        arguments.spp = [] if arguments.seconds else QUICK_SPP if quick else FULL_SPP
    arguments.seeds = arguments.seeds or (2 if quick else 5)
    scenes = [renders.find_scene(name)
              for name in arguments.scenes or (QUICK_SCENES if quick else renders.usual_scenes())]
    budgets = [("samples", spp) for spp in arguments.spp] + [("seconds", time) for time in arguments.seconds]
    if not budgets:
        parser.error("no budget: give --spp or --seconds")
    denoiser, mitsuba, notes = find_rivals(arguments, arguments.spp)
    for note in notes:
        print(note, flush=True)
    if denoiser:
        os.environ.setdefault("GRADUS_DENOISER", str(denoiser_setup.library_of(denoiser)))

    results = {"machine": renders.machine(), "command": ["bench/render/convergence.py", *sys.argv[1:]],
               "seeds": arguments.seeds, "notes": notes, "scenes": [], "points": []}
    arguments.json.parent.mkdir(parents=True, exist_ok=True)
    for scene in scenes:
        scene = references.with_reference(arguments.gradus, scene, arguments.reference_spp, arguments.cache)
        with tempfile.TemporaryDirectory() as folder:
            measurement = Measurement(arguments, scene, folder)
            measurement.warm_up(arguments.method, denoiser)
            measurement.measure(arguments.method, budgets, denoiser)
            if denoiser:
                measurement.denoise(denoiser)
            if mitsuba:
                measurement.mitsuba(mitsuba, arguments.spp)
        results["machine"]["device"] = measurement.device
        results["points"] += measurement.points
        for note in measurement.notes:
            print(note, flush=True)
        results["notes"] += measurement.notes
        own_error = measurement.points[0]["reference_error"]
        results["scenes"].append({"name": scene.name, "file": os.path.relpath(scene.file, renders.ROOT),
                                  "parameters": scene.parameters, "width": scene.width, "height": scene.height,
                                  "max_depth": scene.max_depth, "reference": scene.reference.renderer,
                                  "reference_spp": scene.reference.spp,
                                  "reference_error": own_error})
        results["machine"]["load_after"] = os.getloadavg()[0]
        arguments.json.write_text(json.dumps(results, indent=1) + "\n")  # what there is, should the next one fail
        print(f"{scene.name}: {len(measurement.points)} images, reference by {scene.reference.renderer}, "
              f"{scene.reference.spp} samples, its own relMSE {own_error:.2g}", flush=True)
    print_summary(curves.summaries(results["points"]))
    print(f"\nJSON in {arguments.json}")


if __name__ == "__main__":
    main()
