#!/usr/bin/env python3
"""Crops of guided images beside those of the denoiser and the reference, at equal time: what is kept of edges, textures,
contact shadows, highlights and thin lines.

    python3 bench/render/crops.py [--scene cornell-box ...] [--spp 16] [--seed 1] [--output build/bench/crops.png]

gpt renders with --spp samples and is guided by our filter; pt guided by it, and pt denoised by Open Image Denoise with
clean features, get as many samples as take the same time, reconstruction and denoising counted (those of features left
out, as in convergence.py). References are those of another renderer in tests/references. Prints relMSE by crop, as
`gradus compare` defines it for images; writes it as JSON beside the picture. Takes OpenEXR, numpy, matplotlib and pyoidn
(bench/peers/install.py gets them); without them, says so and draws nothing.
"""

import argparse
import json
import os
import pathlib
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent / "charts"), str(HERE.parent / "peers")]
import denoiser_setup  # noqa: E402
import renders  # noqa: E402
from pythons import find_python  # noqa: E402

MODULES = [*denoiser_setup.MODULES, "numpy", "matplotlib"]
EPSILON = 1e-3  # of relMSE, as in runtime/film/metrics.h
WIDTH, HEIGHT = 32, 24
CROPS = {  # by scene: (what it shows, left, top), in pixels of the reference
    "cornell-box": [("edges", 20, 40), ("contact shadow", 84, 98)],
    "door-ajar": [("thin lines", 74, 8), ("contact", 0, 48)],
    "textures": [("textures", 56, 26), ("highlight and shadow", 50, 58)],
    "plates": [("highlights", 24, 34), ("glossy highlights", 64, 34)],
    "sundial": [("thin rod", 32, 40), ("caustic and shadow", 40, 64)],
    "materials": [("small shapes", 4, 48), ("mirrors", 64, 24)],
}
AGAIN = "GRADUS_CROPS_AGAIN"
METHODS = ["denoised", "pt:guided", "gpt:guided"]


def planes(path):
    import numpy
    import OpenEXR
    channels = OpenEXR.File(str(path), separate_channels=True).channels()
    return numpy.stack([channels[name].pixels for name in "RGB"], axis=-1).astype(numpy.float64)


def relative_mse(image, reference):
    return float(((image - reference) ** 2 / (reference ** 2 + EPSILON)).mean())


class Renderer:
    def __init__(self, arguments, scene, folder):
        self.arguments, self.scene, self.folder = arguments, scene, pathlib.Path(folder)

    def render(self, name, samples, seed):
        """The image, its seconds, and what was reconstructed instead of what the name says, or None."""
        output = self.folder / f"{name.replace(':', '-')}.exr"
        method, options = renders.split_variant("pt" if name == "denoised" else name)
        record = renders.render(self.arguments.gradus, self.scene, method, seed, output, samples=samples,
                                aov=name == "denoised", variance=False, options=options)
        seconds = record["render_seconds"]
        if name == "denoised":
            made = output.with_suffix(".denoised.exr")
            seconds += json.loads(renders.run(sys.executable, HERE.parent / "peers" / "denoise.py",
                                              "--clean-features", output, made).splitlines()[-1])[0]
            return made, seconds, None
        return (output, seconds + renders.reconstruction_seconds(self.arguments.gradus, output),
                renders.made_instead(name, record))

    def all_methods(self):
        """By method: image, samples, seconds, what was made instead or None; all of the time of gpt's."""
        found, spp = {}, self.arguments.spp
        for name in METHODS:
            self.render(name, 4, 0)  # fills the kernel cache
        image, budget, instead = self.render("gpt:guided", spp, self.arguments.seed)
        found["gpt:guided"] = (planes(image), spp, budget, instead)
        for name in METHODS[:-1]:
            samples = spp
            for _ in range(2):  # what more samples take, from what so many took
                _, seconds, _ = self.render(name, samples, 0)
                samples = max(2, round(samples * budget / seconds))
            image, seconds, instead = self.render(name, samples, self.arguments.seed)
            found[name] = (planes(image), samples, seconds, instead)
        return found


def shown(values):
    """sRGB, exposure 1."""
    import numpy
    linear = numpy.clip(values, 0, 1)
    return numpy.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)


def measure(arguments):
    rows = []
    for name in arguments.scene:
        scene = renders.find_scene(name)
        reference = planes(scene.reference.image)
        with tempfile.TemporaryDirectory() as folder:
            found = Renderer(arguments, scene, folder).all_methods()
        for what, left, top in CROPS[name]:
            cut = (slice(top, top + HEIGHT), slice(left, left + WIDTH))
            errors = {method: relative_mse(found[method][0][cut], reference[cut]) for method in METHODS}
            rows.append({"scene": name, "crop": what, "place": [left, top], "relmse": errors,
                         "samples": {method: found[method][1] for method in METHODS},
                         "seconds": {method: found[method][2] for method in METHODS},
                         "instead": {method: found[method][3] for method in METHODS if found[method][3]},
                         "pictures": [found[method][0][cut] for method in METHODS] + [reference[cut]]})
            print(f"{name:14} {what:22} " + "  ".join(
                f"{label(rows[-1], method)} {errors[method]:.2e} ({found[method][1]} spp)" for method in METHODS),
                flush=True)
    return rows


def label(row, method):
    """The method, and what was reconstructed instead, as from few samples."""
    instead = row["instead"].get(method)
    return method.replace(":", " ") + (f" (is {'their mean' if instead == 'none' else instead})" if instead else "")


ROW_INCHES, TITLE_INCHES = 2.75, 0.45  # the latter of two lines over a picture


def draw(pyplot, rows):
    height = ROW_INCHES * len(rows)
    figure, grid = pyplot.subplots(len(rows), len(METHODS) + 1, squeeze=False, figsize=(12, height))
    figure.subplots_adjust(left=0.005, right=0.995, wspace=0.02, bottom=0.05 / height, top=1 - TITLE_INCHES / height,
                           hspace=TITLE_INCHES / (ROW_INCHES - TITLE_INCHES))
    for row, axes in zip(rows, grid):
        titles = [f"{label(row, method)}, {row['samples'][method]} samples: {row['relmse'][method]:.2g}"
                  for method in METHODS] + ["reference"]
        titles[0] = f"{row['scene']}, {row['crop']}\n{titles[0]}"
        for place, picture, title in zip(axes, row["pictures"], titles):
            place.imshow(shown(picture), interpolation="nearest")
            place.set_title(title, fontsize=8)
            place.set_axis_off()
    return figure


def main():
    parser = argparse.ArgumentParser(description="crops at equal time")
    parser.add_argument("--scene", nargs="+", choices=CROPS, default=list(CROPS), help="the scenes (default: all)")
    parser.add_argument("--gradus", type=pathlib.Path, default=renders.ROOT / "build" / "gradus")
    parser.add_argument("--spp", type=renders.at_least(1), default=16, help="samples a pixel of gpt (16)")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--output", type=pathlib.Path, default=renders.ROOT / "build" / "bench" / "crops.png",
                        help="the picture; a JSON of the figures is written beside it")
    arguments = parser.parse_args()
    python = find_python(MODULES, denoiser_setup.PYTHON_VARIABLE)
    if not python:
        print(f"skipped: no {', '.join(MODULES)}; {denoiser_setup.HOW_TO_GET}")
        return
    if AGAIN not in os.environ:  # in that Python
        os.execve(python, [python, __file__, *sys.argv[1:]], {**os.environ, AGAIN: "1"})
    machine = renders.machine()
    rows = measure(arguments)
    import matplotlib
    matplotlib.use("Agg")
    from matplotlib import pyplot
    arguments.output.parent.mkdir(parents=True, exist_ok=True)
    draw(pyplot, rows).savefig(arguments.output, dpi=110)
    for row in rows:
        del row["pictures"]
    machine["load_after"] = os.getloadavg()[0]
    caption = (f"Crops at the time that gpt takes for {arguments.spp} samples a pixel: path tracing denoised by Open Image "
               "Denoise, path tracing and gradient-domain path tracing guided by our own filter, the reference. relMSE "
               "of the crop beside the samples.")
    arguments.output.with_suffix(".json").write_text(json.dumps(
        {"machine": machine, "command": ["bench/render/crops.py", *sys.argv[1:]], "caption": caption, "crops": rows},
        indent=1) + "\n")
    print(f"wrote {arguments.output}")


if __name__ == "__main__":
    main()
