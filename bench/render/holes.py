#!/usr/bin/env python3
"""The experiment with holes (Kettunen et al. 2015, supplement, figure 3): the more occluders, the less gradients help.

    python3 bench/render/holes.py [--gradus build/gradus]

A wall with 7, 14 and 28 holes along each side lights a room. Prints, at equal base samples, the mean squared error of
path tracing over that of gradient-domain path tracing with the L2 reconstruction and the alpha that is best for it, as
in the paper, beside the paper's 15, 5 and 3, whose scene is another one. Medians over seeds; the error is against the
references of tests/references, made by another renderer.
"""

import argparse
import json
import os
import pathlib
import statistics
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
import renders  # noqa: E402

PAPER = {7: 15, 14: 5, 28: 3}
ALPHAS = (0.02, 0.05, 0.1, 0.2, 0.5, 1.0)


def squared_error(gradus, image, scene):
    """Up to a factor that is the same for all images of a scene: PSNR is against the reference's peak."""
    return 10 ** (-renders.compare(gradus, image, scene.reference)["psnr"] / 10)


def main():
    parser = argparse.ArgumentParser(description="the gain of gradients against the density of occluders")
    parser.add_argument("--gradus", type=pathlib.Path, default=renders.ROOT / "build" / "gradus")
    parser.add_argument("--spp", type=renders.at_least(1), default=64)
    parser.add_argument("--repeats", type=renders.at_least(1), default=3)
    parser.add_argument("--json", type=pathlib.Path, help="also write all figures to this file")
    arguments = parser.parse_args()
    results = {"machine": renders.machine(), "command": ["bench/render/holes.py", *sys.argv[1:]], "spp": arguments.spp,
               "holes": []}
    print(f"{'holes':>5} {'best alpha':>10} {'gain in MSE':>11} {'paper':>5}")
    with tempfile.TemporaryDirectory() as folder:
        plain, layers, solved = (pathlib.Path(folder) / name for name in ("plain.exr", "layers.exr", "solved.exr"))
        for holes, paper in PAPER.items():
            scene = renders.find_scene(f"holes-{holes}")
            gains = {alpha: [] for alpha in ALPHAS}
            for seed in range(1, arguments.repeats + 1):
                renders.render(arguments.gradus, scene, "pt", seed, plain, samples=arguments.spp)
                record = renders.render(arguments.gradus, scene, "gpt", seed, layers, samples=arguments.spp)
                error = squared_error(arguments.gradus, plain, scene)
                for alpha, found in gains.items():
                    renders.run(arguments.gradus, "solve", layers, "-o", solved, "--norm", "L2", "--alpha", alpha,
                                "--quiet")
                    found.append(error / squared_error(arguments.gradus, solved, scene))
            best = max(ALPHAS, key=lambda alpha: statistics.median(gains[alpha]))
            gain = statistics.median(gains[best])
            results["machine"]["device"] = record["device"]
            print(f"{holes:5} {best:10g} {gain:11.2f} {paper:5}", flush=True)
            results["holes"].append({"holes": holes, "alpha": best, "gain": gain, "paper": paper, "gains": gains})
    results["machine"]["load_after"] = os.getloadavg()[0]
    if arguments.json:
        arguments.json.write_text(json.dumps(results, indent=2) + "\n")


if __name__ == "__main__":
    main()
