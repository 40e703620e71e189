#!/usr/bin/env python3
"""Kernels in double and in relaxed arithmetic against kernels in float: what they cost, and what error they save.

    python3 bench/render/precision.py [SCENE ...] [--gradus build/gradus]

SCENE is a name in tests/references, whose reference (of another renderer) is the truth; default: three of them. The
arithmetics take turns with the same seeds, so that their random numbers are the same. Prints relMSE in float, the mean
over seeds of what double (relaxed) has more, with its standard error, both in percent of float's; and samples per
second over float's, the median over seeds. Target: no difference beyond three standard errors or a percent.
"""

import argparse
import json
import math
import pathlib
import statistics
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
import renders  # noqa: E402

METHODS, PRECISIONS = ("pt", "gpt"), ("single", "double", "relaxed")


def measure(arguments, scene, method, folder):
    """By precision the (seconds of a sample, relMSE) of each seed."""
    image = pathlib.Path(folder) / "image.exr"

    def render(precision, seed, samples):
        record = renders.render(arguments.gradus, scene, method, seed, image, samples=samples,
                                options=("--precision", precision))
        return (record["render_seconds"] / samples,
                renders.compare(arguments.gradus, image, scene.reference)["relative_mse"])

    turns = {precision: [] for precision in PRECISIONS}
    for precision in PRECISIONS:  # kernels compiled
        render(precision, 0, 1)
    for seed in range(1, arguments.repeats + 1):
        for precision, measured in turns.items():
            measured.append(render(precision, seed, arguments.spp))
    return turns


def main():
    parser = argparse.ArgumentParser(description="kernels in double and relaxed arithmetic against float")
    parser.add_argument("scenes", nargs="*", metavar="SCENE", default=["cornell-box", "materials", "torus-rough-glass"],
                        help="names in tests/references")
    parser.add_argument("--gradus", type=pathlib.Path, default=renders.ROOT / "build" / "gradus")
    parser.add_argument("--spp", type=renders.at_least(1), default=64)
    parser.add_argument("--repeats", type=renders.at_least(2), default=5,
                        help="seeds, at least 2: a standard error needs them")
    parser.add_argument("--json", type=pathlib.Path, help="also write all figures to this file")
    arguments = parser.parse_args()
    scenes = renders.scenes_with_reference(arguments.scenes)
    results = []
    print(f"{'scene':<20} {'method':<6} {'relMSE single':>13} {'':<8} {'difference':>22} {'speed':>6}")
    with tempfile.TemporaryDirectory() as folder:
        for scene in scenes:
            for method in METHODS:
                turns = measure(arguments, scene, method, folder)
                single = turns["single"]
                error = statistics.mean(turn[1] for turn in single)
                for precision in PRECISIONS[1:]:
                    excess = [100 * (other[1] - one[1]) / error for other, one in zip(turns[precision], single)]
                    mean = statistics.mean(excess)
                    deviation = statistics.stdev(excess) / math.sqrt(len(excess))
                    speed = statistics.median(one[0] / other[0] for other, one in zip(turns[precision], single))
                    print(f"{scene.name:<20} {method:<6} {error:13.3e} {precision:<8} {mean:+9.3f} "
                          f"+- {deviation:.3f} % {speed:6.2f}", flush=True)
                    results.append({"scene": scene.name, "method": method, "precision": precision,
                                    "relmse_single": error, "difference_percent": mean,
                                    "standard_error_percent": deviation, "speed_ratio": speed, "turns": turns})
    if arguments.json:
        arguments.json.write_text(json.dumps(results, indent=2) + "\n")


if __name__ == "__main__":
    main()
