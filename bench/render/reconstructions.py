#!/usr/bin/env python3
"""Errors of `gpt` by reconstruction, at equal sample counts: relMSE of each over that of the first.

    python3 bench/render/reconstructions.py [SCENE ...] [--spp 4 16 64] [--seeds 3] [--reconstructions l1 l2 weighted]

SCENE is one that convergence.py finds a reference for; the default are eight of these. Each figure is the median over
the seeds; a ratio is the median of the seeds' ratios.
"""

import argparse
import pathlib
import statistics
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))
import renders  # noqa: E402


def errors(arguments, scene, samples, seed, folder):
    """By reconstruction, (relMSE, seconds of rendering and reconstructing)."""
    found = {}
    for name in arguments.reconstructions:
        image = folder / f"{name}.exr"
        record = renders.render(arguments.gradus, scene, arguments.method, seed, image, samples=samples, layers=False,
                                options=["--reconstruction", name])
        figures = renders.compare(arguments.gradus, image, scene.reference)
        found[name] = figures["relative_mse"], record["wall_seconds"] - record["prepare_seconds"]
    return found


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenes", nargs="*", default=renders.RECONSTRUCTION_SCENES)
    parser.add_argument("--spp", nargs="+", type=int, default=[4, 16, 64])
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--method", default="gpt")
    parser.add_argument("--reconstructions", nargs="+", default=["l1", "l2", "weighted"])
    parser.add_argument("--gradus", default=renders.ROOT / "build" / "gradus")
    arguments = parser.parse_args()
    first, *others = arguments.reconstructions
    print(f"{'scene':18} {'spp':>4}  {'relMSE ' + first:>12}  " + "  ".join(f"{o + '/' + first:>14}" for o in others))
    with tempfile.TemporaryDirectory() as folder:
        for scene in renders.scenes_with_reference(arguments.scenes):
            for samples in arguments.spp:
                runs = [errors(arguments, scene, samples, seed, pathlib.Path(folder))
                        for seed in range(1, arguments.seeds + 1)]
                error = statistics.median(run[first][0] for run in runs)
                ratios = [statistics.median(run[other][0] / run[first][0] for run in runs) for other in others]
                print(f"{scene.name:18} {samples:4}  {error:12.6f}  " + "  ".join(f"{r:14.3f}" for r in ratios),
                      flush=True)


if __name__ == "__main__":
    main()
