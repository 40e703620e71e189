#!/usr/bin/env python3
"""What pixel filters leave of the noise, in Gradus and in Mitsuba 3.

    python3 bench/render/filters.py [SCENE ...] [--filters box tent gaussian mitchell lanczos] [--spp 16] [--seeds 3]
                                    [--size 96x72] [--methods pt gpt] [--reference-spp 8192] [--gradus build/gradus]

SCENE is a file whose film takes the parameter `rfilter`, as those of scenes/ do. For each and for each filter: relMSE of
the methods, and of Mitsuba 3's path tracer where it is installed (`bench/peers/install.py`), the mean of the seeds, over
that with a box. The reference is an image by the other renderer, or where that is missing by `pt` with another seed.
Target: at most Mitsuba's for `pt`.
"""

import argparse
import json
import pathlib
import statistics
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
import renders  # noqa: E402

sys.path.insert(0, str(renders.ROOT / "bench" / "peers"))
import mitsuba_setup  # noqa: E402
from pythons import find_python  # noqa: E402

OWN_SCENES = ["cornell-box", "materials", "textures", "lanterns"]
REFERENCE_SEED = 1000


class Bench:
    def __init__(self, arguments, folder):
        self.arguments, self.folder = arguments, folder
        self.python = find_python(["mitsuba"], mitsuba_setup.PYTHON_VARIABLE)

    def by_mitsuba(self, scene, pixel_filter, spp, seeds):
        """Its images."""
        printed = renders.run(self.python, renders.ROOT / "bench" / "peers" / "mitsuba_images.py", scene, self.folder,
                              "--size", self.arguments.size, "--spp", spp, "--seeds", *seeds,
                              "-D", f"rfilter={pixel_filter}")
        # Mitsuba may print warnings before the JSON, which is its last line.
        return [image["image"] for image in json.loads(printed.strip().splitlines()[-1])["images"]]

    def by_gradus(self, scene, pixel_filter, method, spp, seeds):
        images = []
        for seed in seeds:
            images.append(self.folder / f"{method}-{spp}-{seed}.exr")
            renders.run(self.arguments.gradus, "render", scene, "-o", images[-1], "--quiet", "--method", method, "--spp",
                        spp, "--seed", seed, "--size", self.arguments.size, "-D", f"rfilter={pixel_filter}")
        return images

    def reference(self, scene, pixel_filter):
        spp, seeds = self.arguments.reference_spp, [REFERENCE_SEED]
        if self.python:
            return self.by_mitsuba(scene, pixel_filter, spp, seeds)[0]
        return self.by_gradus(scene, pixel_filter, "pt", spp, seeds)[0]

    def error(self, images, reference):
        errors = []
        for image in images:
            record = self.folder / "compared.json"
            renders.run(self.arguments.gradus, "compare", image, reference, "--json", record)
            errors.append(json.loads(record.read_text())["images"][0]["relative_mse"])
        return statistics.mean(errors)

    def measure(self, scene, pixel_filter):
        """relMSE by renderer."""
        reference = self.reference(scene, pixel_filter)
        seeds = range(1, self.arguments.seeds + 1)
        errors = {method: self.error(self.by_gradus(scene, pixel_filter, method, self.arguments.spp, seeds), reference)
                  for method in self.arguments.methods}
        if self.python:
            errors["mitsuba"] = self.error(self.by_mitsuba(scene, pixel_filter, self.arguments.spp, seeds), reference)
        return errors


def main():
    parser = argparse.ArgumentParser(description="the noise that pixel filters leave")
    parser.add_argument("scenes", nargs="*", type=pathlib.Path, metavar="SCENE",
                        default=[renders.ROOT / "scenes" / f"{name}.xml" for name in OWN_SCENES])
    parser.add_argument("--filters", nargs="+", default=["box", "tent", "gaussian", "mitchell", "lanczos"])
    parser.add_argument("--methods", nargs="+", default=["pt", "gpt"])
    parser.add_argument("--spp", type=renders.at_least(1), default=16)
    parser.add_argument("--seeds", type=renders.at_least(1), default=3)
    parser.add_argument("--size", default="96x72", metavar="WxH")
    parser.add_argument("--reference-spp", type=renders.at_least(1), default=8192)
    parser.add_argument("--gradus", type=pathlib.Path, default=renders.ROOT / "build" / "gradus")
    arguments = parser.parse_args()
    for scene in arguments.scenes:
        if not scene.exists():
            parser.error(f"{scene}: no such scene")
    with tempfile.TemporaryDirectory() as folder:
        bench = Bench(arguments, pathlib.Path(folder))
        for scene in arguments.scenes:
            box = None
            for pixel_filter in arguments.filters:
                errors = bench.measure(scene, pixel_filter)
                box = errors if box is None and pixel_filter == "box" else box
                print(f"{scene.stem:<20} {pixel_filter:<9}" + "".join(
                    f"  {name} {error:.3e}" + (f" ({error / box[name]:.2f})" if box else "")
                    for name, error in errors.items()), flush=True)


if __name__ == "__main__":
    main()
