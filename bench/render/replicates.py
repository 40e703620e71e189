#!/usr/bin/env python3
"""What variances of path tracing cost and how right they are.

    python3 bench/render/replicates.py [SCENE ...] [--spp 16 64 256] [--seeds 5] [--method pt] [--gradus build/gradus]

SCENE is a name in tests/references. For each and for each number of samples: relMSE of images that tell their variance
over that of images that do not, whose samples are one sequence; and relMSE as the layer `variance` tells it over the
true one, which is a figure of `pt` and `sppm` alone: of others it is not the variance of R, G and B. The reference's own
error is taken off. Target: told over true within 5 % of 1, and where fireflies decide within their noise.
"""

import argparse
import dataclasses
import pathlib
import statistics
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
import renders  # noqa: E402

TELL_THEMSELVES = ["pt", "sppm"]


def main():
    parser = argparse.ArgumentParser(description="the price and the accuracy of variances")
    parser.add_argument("scenes", nargs="*", metavar="SCENE", default=["cornell-box", "materials", "textures", "sundial"])
    parser.add_argument("--spp", type=renders.at_least(1), nargs="+", default=[16, 64, 256])
    parser.add_argument("--seeds", type=renders.at_least(1), default=5)
    parser.add_argument("--method", default="pt")
    parser.add_argument("--gradus", type=pathlib.Path, default=renders.ROOT / "build" / "gradus")
    arguments = parser.parse_args()
    scenes = renders.scenes_with_reference(arguments.scenes)
    print(f"{'scene':<20} {'spp':>5} {'relMSE':>10} {'with variance':>14} {'ratio':>6} {'told over true':>15}")
    with tempfile.TemporaryDirectory() as folder:
        for scene in scenes:
            for samples in arguments.spp:
                measure(arguments, scene, samples, pathlib.Path(folder) / "image.exr")


def measure(arguments, scene, samples, image):
    plain, replicates, told = [], [], []
    for seed in range(1, arguments.seeds + 1):
        for errors, aov in ((plain, False), (replicates, True)):
            renders.render(arguments.gradus, scene, arguments.method, seed, image, samples=samples, aov=aov,
                           layers=False)
            figures = renders.compare(arguments.gradus, image, scene.reference)
            errors.append(figures["relative_mse"] - figures["reference_relative_mse"])
        if arguments.method in TELL_THEMSELVES:
            # The image's variance in place of the reference's, over the same values of the reference.
            own = dataclasses.replace(scene.reference, variance=image)
            told.append(renders.compare(arguments.gradus, image, own)["reference_relative_mse"])
    ratio = f"{statistics.mean(told) / statistics.mean(replicates):.3f}" if told else "-"
    print(f"{scene.name:<20} {samples:>5} {statistics.mean(plain):>10.3e} {statistics.mean(replicates):>14.3e} "
          f"{statistics.mean(replicates) / statistics.mean(plain):>6.2f} "
          f"{ratio:>15}", flush=True)


if __name__ == "__main__":
    main()
