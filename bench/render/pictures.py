#!/usr/bin/env python3
"""Pictures of path tracing and gradient-domain path tracing at equal time, beside a reference, with maps of the error.

    python3 bench/render/pictures.py [--scene door-ajar] [--spp 16] [--output build/bench/pictures.png]

gpt renders with --spp samples; pt renders as many as take the same time, the reconstruction counted. The reference is
path tracing with --reference-spp samples at the size of the picture, made once and kept in build/bench/cache. Error
maps are those of `gradus compare --error-image`: red too bright, blue too dark, white equal. Needs matplotlib
(bench/peers/install.py gets it); without it, says so and draws nothing.
"""

import argparse
import json
import os
import pathlib
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent / "charts")]
import plotting  # noqa: E402
import references  # noqa: E402
import renders  # noqa: E402

SCENES = {"cornell-box": (256, 256), "door-ajar": (320, 240)}  # and their size in pixels


def equal_time(arguments, scene, folder):
    """Renders both: {method: {"image", "samples", "seconds", "relmse"}}, with PNGs of image and error beside."""
    def rendered(method, seed, samples):
        image = folder / f"{scene.name}-{method}.exr"
        record = renders.render(arguments.gradus, scene, method, seed, image, samples=samples, png=True)
        return image, record["render_seconds"] + renders.reconstruction_seconds(arguments.gradus, image)

    for method in ("pt", "gpt"):
        rendered(method, 0, 2)  # fills the kernel cache
    gpt, gpt_seconds = rendered("gpt", 1, arguments.spp)
    _, pilot_seconds = rendered("pt", 2, 4 * arguments.spp)
    pt_samples = max(1, round(4 * arguments.spp * gpt_seconds / pilot_seconds))
    pt, pt_seconds = rendered("pt", 1, pt_samples)
    found = {}
    for method, image, samples, seconds in (("pt", pt, pt_samples, pt_seconds),
                                            ("gpt", gpt, arguments.spp, gpt_seconds)):
        figures = renders.compare(arguments.gradus, image, scene.reference, "--error-image",
                                  image.with_suffix(".error.png"))
        found[method] = {"image": image, "samples": samples, "seconds": seconds, "relmse": figures["relative_mse"],
                         "reference_error": figures["reference_relative_mse"]}
    return found


def gain(found):
    ratio = found["pt"]["relmse"] / found["gpt"]["relmse"]
    return f"{ratio:.1f} times less error" if ratio >= 1 else f"{1 / ratio:.1f} times more error"


def draw(pyplot, measured):
    """A row for each scene: both images, the reference, both maps of the error."""
    heights = [scene.height / scene.width for scene, _ in measured]
    inches = 2.4 * sum(heights) + 0.5 * len(measured) + 0.35
    figure, grid = pyplot.subplots(len(measured), 5, figsize=(12.4, inches), squeeze=False,
                                   gridspec_kw={"height_ratios": heights})
    for (scene, found), row in zip(measured, grid):
        pt, gpt = found["pt"], found["gpt"]
        shown = [(pt["image"].with_suffix(".png"), f"{scene.name}: pt, {pt['samples']} samples"),
                 (gpt["image"].with_suffix(".png"), f"gpt, {gpt['samples']} samples"),
                 (scene.reference.image.with_suffix(".png"), f"reference (relMSE {pt['reference_error']:.1g})"),
                 (pt["image"].with_suffix(".error.png"), f"error of pt: relMSE {pt['relmse']:.2g}"),
                 (gpt["image"].with_suffix(".error.png"), f"of gpt: {gpt['relmse']:.2g}, {gain(found)}")]
        for axes, (file, title) in zip(row, shown):
            axes.imshow(pyplot.imread(file), interpolation="nearest")
            axes.set_title(title, fontsize=9)
            axes.set_axis_off()
    figure.text(0.5, 0.08 / inches, "pt and gpt take the same time, reconstruction counted; errors: red too bright, "
                "blue too dark, full colour at 100 %", ha="center", fontsize=8)
    figure.tight_layout(pad=0.4, rect=(0, 0.25 / inches, 1, 1))
    return figure


def main():
    parser = argparse.ArgumentParser(description="pictures at equal time")
    parser.add_argument("--scene", nargs="+", choices=SCENES, default=list(SCENES), help="the rows (default: all)")
    parser.add_argument("--gradus", type=pathlib.Path, default=renders.ROOT / "build" / "gradus")
    parser.add_argument("--spp", type=renders.at_least(1), default=16, help="samples a pixel of gpt (16)")
    parser.add_argument("--reference-spp", type=renders.at_least(1), default=8192)
    parser.add_argument("--cache", type=pathlib.Path, default=renders.ROOT / "build" / "bench" / "cache")
    parser.add_argument("--output", type=pathlib.Path, default=renders.ROOT / "build" / "bench" / "pictures.png",
                        help="the picture; a JSON of the figures is written beside it")
    arguments = parser.parse_args()
    pyplot = plotting.pyplot()
    if not pyplot:
        return
    machine = renders.machine()
    measured = []
    with tempfile.TemporaryDirectory() as folder:
        for name in arguments.scene:
            width, height = SCENES[name]
            scene = renders.Scene(name, renders.ROOT / "scenes" / f"{name}.xml", width, height)
            scene = references.with_reference(arguments.gradus, scene, arguments.reference_spp, arguments.cache)
            measured.append((scene, equal_time(arguments, scene, pathlib.Path(folder))))
            for method, own in measured[-1][1].items():
                print(f"{name}, {method}: {own['samples']} samples, {own['seconds']:.2f} s, relMSE {own['relmse']:.2e}",
                      flush=True)
        figure = draw(pyplot, measured)
        arguments.output.parent.mkdir(parents=True, exist_ok=True)
        figure.savefig(arguments.output, dpi=110)
    machine["load_after"] = os.getloadavg()[0]
    figures = {scene.name: {method: {key: value for key, value in own.items() if key != "image"}
                            for method, own in found.items()} for scene, found in measured}
    caption = ("Path tracing and gradient-domain path tracing, the same time for both, reconstruction counted: "
               + "; ".join(f"{scene.name}, gpt {gain(found)}" for scene, found in measured) + ".")
    arguments.output.with_suffix(".json").write_text(json.dumps(
        {"machine": machine, "command": ["bench/render/pictures.py", *sys.argv[1:]], "caption": caption,
         "scenes": figures}, indent=1) + "\n")
    print(f"wrote {arguments.output}")


if __name__ == "__main__":
    main()
