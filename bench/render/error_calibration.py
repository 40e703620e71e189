#!/usr/bin/env python3
"""How right the layer `error` and the estimated relMSE are, against references of another renderer.

    python3 bench/render/error_calibration.py [SCENE ...] [--spp 16 64 256] [--seeds 5] [--variants gpt:l1 pt:mean ...]

SCENE is a name in tests/references or of ../shared, where that has its reference; the default are six of them. A variant
is METHOD:RECONSTRUCTION; mean is that of pt. Printed are, as medians over the seeds, the shares of values that are wrong
by at most once and twice the layer (of normal errors 0.68 and 0.95), the variance of the reference added to its square;
and the estimated relMSE over the true one, which is that against the reference less the reference's own.
"""

import argparse
import pathlib
import statistics
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
import renders  # noqa: E402

SCENES = ["cornell-box", "door-ajar", "materials", "plates", "textures", "sundial"]
VARIANTS = ["pt:mean", "gpt:l1", "gpt:l2", "gpt:weighted", "gpt:guided", "pt:guided"]


def calibration(arguments, scene, method, reconstruction, samples, seed, image):
    """Shares within once and twice the layer; estimated relMSE over the true one; the true one."""
    options = ["--error"] + ([] if reconstruction == "mean" else ["--reconstruction", reconstruction])
    renders.render(arguments.gradus, scene, method, seed, image, samples=samples, layers=False, options=options)
    compared = renders.compare(arguments.gradus, image, scene.reference)
    layer = compared["error_layer"]
    true = compared["relative_mse"] - compared["reference_relative_mse"]
    return layer["within"], layer["within_twice"], layer["relative_mse"] / true, true


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenes", nargs="*", default=SCENES)
    parser.add_argument("--spp", nargs="+", type=renders.at_least(2), default=[16, 64, 256])
    parser.add_argument("--seeds", type=renders.at_least(1), default=5)
    parser.add_argument("--variants", nargs="+", default=VARIANTS)
    parser.add_argument("--gradus", default=renders.ROOT / "build" / "gradus")
    arguments = parser.parse_args()
    variants = [variant.split(":") for variant in arguments.variants]
    if any(len(variant) != 2 for variant in variants):
        parser.error("a variant is METHOD:RECONSTRUCTION")
    scenes = renders.scenes_with_reference(arguments.scenes)
    print(f"{'scene':24} {'spp':>4} {'variant':14} {'within':>6} {'twice':>6} {'estimated/true':>14} {'relMSE':>8}")
    with tempfile.TemporaryDirectory() as folder:
        image = pathlib.Path(folder) / "image.exr"
        for scene in scenes:
            for samples in arguments.spp:
                for variant in variants:
                    method, reconstruction = variant
                    runs = [calibration(arguments, scene, method, reconstruction, samples, seed, image)
                            for seed in range(1, arguments.seeds + 1)]
                    within, twice, ratio, true = (statistics.median(run[i] for run in runs) for i in range(4))
                    print(f"{scene.name:24} {samples:4} {':'.join(variant):14} {within:6.3f} {twice:6.3f} {ratio:14.2f} "
                          f"{true:8.5f}", flush=True)


if __name__ == "__main__":
    main()
