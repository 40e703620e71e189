#!/usr/bin/env python3
"""Gradient-domain path tracing against path tracing: what a sample costs, and what it gains.

    python3 bench/render/gradient.py [SCENE ...] [--gradus build/gradus]

SCENE is a name in tests/references, whose reference (of another renderer) is the truth; default: all. Both methods
take turns with seeds of their own. Prints, as medians: seconds of a sample of gpt over one of pt (the reconstruction
left out); relMSE at equal samples, pt over gpt; and at equal time, pt being given as many more samples as its are
cheaper (its relMSE falls by as much). Target: a cost of at most 2.2 on the Cornell box, 5 times less error at equal
time on scenes of diffuse light, at most 1.1 times the error at equal samples on any.
"""

import argparse
import json
import pathlib
import statistics
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
import renders  # noqa: E402


def render(arguments, scene, method, seed, samples, folder):
    """Seconds of rendering by sample of a pixel, and relMSE."""
    image = pathlib.Path(folder) / "image.exr"
    record = renders.render(arguments.gradus, scene, method, seed, image, samples=samples)
    figures = renders.compare(arguments.gradus, image, scene.reference)
    return record["render_seconds"] / samples, figures["relative_mse"]


def main():
    parser = argparse.ArgumentParser(description="gradient-domain path tracing against path tracing")
    parser.add_argument("scenes", nargs="*", metavar="SCENE",
                        help="names in tests/references (default: all)")
    parser.add_argument("--gradus", type=pathlib.Path, default=renders.ROOT / "build" / "gradus")
    parser.add_argument("--spp", type=int, default=64)
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--json", type=pathlib.Path, help="also write all figures to this file")
    arguments = parser.parse_args()
    names = arguments.scenes or sorted(path.stem for path in renders.REFERENCES.glob("*.json"))
    results = []
    print(f"{'scene':<20} {'cost':>6} {'relMSE pt':>11} {'gpt':>11} {'equal samples':>14} {'equal time':>11}")
    with tempfile.TemporaryDirectory() as folder:
        for name in names:
            scene = renders.find_scene(name)
            turns = {"pt": [], "gpt": []}
            for method in turns:  # kernels compiled
                render(arguments, scene, method, 0, 1, folder)
            for seed in range(1, arguments.repeats + 1):
                for method, measured in turns.items():
                    measured.append(render(arguments, scene, method, seed, arguments.spp, folder))
            cost = statistics.median(g[0] / p[0] for g, p in zip(turns["gpt"], turns["pt"]))
            error = {method: statistics.median(turn[1] for turn in measured) for method, measured in turns.items()}
            gain = error["pt"] / error["gpt"]
            print(f"{name:<20} {cost:6.2f} {error['pt']:11.3e} {error['gpt']:11.3e} {gain:14.2f} {gain / cost:11.2f}",
                  flush=True)
            results.append({"scene": name, "cost": cost, "relmse": error, "equal_samples": gain,
                            "equal_time": gain / cost, "turns": turns})
    if arguments.json:
        arguments.json.write_text(json.dumps(results, indent=2) + "\n")


if __name__ == "__main__":
    main()
