#!/usr/bin/env python3
"""Guided reconstructions over path tracing denoised by Open Image Denoise: ratios of relMSE.

    python3 bench/render/guided.py [SCENE ...] [--spp 16 64 256] [--seeds 3] [--variants gpt:filter pt:denoiser ...]

SCENE is one that convergence.py finds a reference for; the default are eight of these. A variant is METHOD:GUIDE. The
rival has clean features, and as many samples as pt takes in the seconds that the variant rendered and reconstructed
for; the rival's denoising is not counted. Then the same at equal samples. Each figure is the median over the seeds.
Open Image Denoise is that of the Python package pyoidn (bench/peers).
"""

import argparse
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
PEERS = HERE.parent / "peers"
sys.path[:0] = [str(HERE), str(PEERS)]
import denoiser_setup  # noqa: E402
import renders  # noqa: E402
from pythons import find_python  # noqa: E402

VARIANTS = ["gpt:filter", "gpt:denoiser", "pt:filter", "pt:denoiser"]


def denoiser_library(python):
    """The file of the denoiser that the Python package has."""
    script = "import pathlib, pyoidn; print(pathlib.Path(pyoidn.__file__).parent / 'oidn' / 'lib')"
    folder = pathlib.Path(subprocess.run([python, "-c", script], capture_output=True, text=True, check=True)
                          .stdout.strip())
    return folder / "libOpenImageDenoise.so.2"


def error(arguments, scene, image):
    return renders.compare(arguments.gradus, image, scene.reference)["relative_mse"]


def seconds_of(record):
    return record["wall_seconds"] - record["prepare_seconds"] - record["compile_seconds"]["total"]


def rival(arguments, scene, python, seed, folder, **length):
    """relMSE of denoised path tracing."""
    noisy, image = folder / "noisy.exr", folder / "denoised.exr"
    renders.render(arguments.gradus, scene, "pt", seed + 1000, noisy, aov=True, layers=False, **length)
    renders.run(python, PEERS / "denoise.py", "--clean-features", noisy, image)
    return error(arguments, scene, image)


def ratios(arguments, scene, python, samples, seed, folder):
    """By variant, error over the rival's at equal time and at equal samples; and the latter's error."""
    equal_samples = rival(arguments, scene, python, seed, folder, samples=samples)
    found = {}
    for variant in arguments.variants:
        method, guide = variant.split(":")
        image = folder / "guided.exr"
        record = renders.render(arguments.gradus, scene, method, seed, image, samples=samples, layers=False,
                                options=["--reconstruction", "guided", "--guide", guide])
        of_variant = error(arguments, scene, image)
        equal_time = rival(arguments, scene, python, seed, folder, seconds=seconds_of(record))
        found[variant] = of_variant / equal_time, of_variant / equal_samples
    return found, equal_samples


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenes", nargs="*", default=renders.RECONSTRUCTION_SCENES)
    parser.add_argument("--spp", nargs="+", type=int, default=[16, 64, 256])
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--variants", nargs="+", default=VARIANTS)
    parser.add_argument("--gradus", default=renders.ROOT / "build" / "gradus")
    arguments = parser.parse_args()
    python = find_python(denoiser_setup.MODULES, denoiser_setup.PYTHON_VARIABLE)
    if not python:
        sys.exit(denoiser_setup.HOW_TO_GET)
    os.environ.setdefault("GRADUS_DENOISER", str(denoiser_library(python)))
    print("relMSE over that of denoised pt, at equal time / equal samples")
    print(f"{'scene':16} {'spp':>4} {'pt denoised':>11}  " + "  ".join(f"{name:>13}" for name in arguments.variants))
    with tempfile.TemporaryDirectory() as folder:
        for scene in renders.scenes_with_reference(arguments.scenes):
            for samples in arguments.spp:
                runs = [ratios(arguments, scene, python, samples, seed, pathlib.Path(folder))
                        for seed in range(1, arguments.seeds + 1)]
                columns = []
                for variant in arguments.variants:
                    time, count = (statistics.median(found[variant][i] for found, _ in runs) for i in (0, 1))
                    columns.append(f"{time:6.2f}/{count:6.2f}")
                print(f"{scene.name:16} {samples:4} {statistics.median(e for _, e in runs):11.5f}  "
                      + "  ".join(columns), flush=True)


if __name__ == "__main__":
    main()
