#!/usr/bin/env python3
"""Gradient-domain path tracing against path tracing: what a sample costs, what it gains, and what `auto` picks.

    python3 bench/render/gradient.py [SCENE ...] [--gradus build/gradus]

SCENE is a name in tests/references, whose reference (of another renderer) is the truth; default: all but those for
photons. cornell-box-256 and torus-soft-256 are those of ../shared where that is present. The methods take turns with
seeds of their own. Prints, as medians: seconds of a sample of gpt over one of pt (the reconstruction left out); relMSE
at equal samples, pt over gpt; at equal time, pt being given as many more samples as its are cheaper (its relMSE falls
by as much); and at equal time of the whole process, start, loading, reconstruction and writing counted in both. Then
what --method auto picked, in how many of the runs, the gain at equal time that it expected, and its regret: the relMSE
at equal time, pilot and reconstruction counted in, over that of the better of both (1: as good). Short renders have no
pilot, and it goes by a rule. Last, the geometric mean and the largest regret. Target: a cost of at most 2.2 on the
Cornell box, 5 times less error at equal time on scenes of diffuse light, at most 1.1 times the error at equal samples
on any, a regret of 1.1.
"""

import argparse
import json
import pathlib
import statistics
import sys
import tempfile
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
import renders  # noqa: E402


def render(arguments, scene, method, seed, samples, folder):
    """Seconds of rendering by sample of a pixel, the pilot counted in, relMSE, what auto chose, and the seconds of the
    whole process."""
    image = pathlib.Path(folder) / "image.exr"
    started = time.perf_counter()
    record = renders.render(arguments.gradus, scene, method, seed, image, samples=samples, layers=False)
    whole = time.perf_counter() - started
    choice = record.get("choice")
    seconds = record["render_seconds"] + (choice["pilot"]["seconds"] if choice else 0)
    return seconds / samples, renders.compare(arguments.gradus, image, scene.reference)["relative_mse"], choice, whole


def reconstruction_seconds(arguments, scene, method, folder):
    if method == "pt":
        return 0.0
    image = pathlib.Path(folder) / "layers.exr"
    renders.render(arguments.gradus, scene, method, 1, image, samples=arguments.spp)
    return renders.reconstruction_seconds(arguments.gradus, image)


def equal_process_time(pt, gpt, samples):
    """How many times less error gpt has where pt gets as many samples as fit into gpt's whole process. Each: (seconds
    by sample, relMSE, ..., seconds of the process), medians. None where less than one sample fits."""
    other_seconds = pt[-1] - pt[0] * samples  # of pt's process, beside rendering
    fitting = (gpt[-1] - other_seconds) / pt[0]
    return pt[1] * samples / fitting / gpt[1] if fitting >= 1 else None


def median_gain(choices):
    """Of the gains that runs of auto expected; None where none knew its own."""
    gains = [choice["gain"] for choice in choices if choice["gain"] is not None]
    return statistics.median(gains) if gains else None


def regret_of(pick, error, seconds, solving):
    """relMSE of auto at equal time over that of the better of pt and gpt. seconds: of a sample, without those in which
    the image is reconstructed, which are `solving` for gpt and for what auto picked."""
    return (error["auto"] * (seconds["auto"] + solving[pick])
            / min(error["pt"] * seconds["pt"], error["gpt"] * (seconds["gpt"] + solving["gpt"])))


def main():
    parser = argparse.ArgumentParser(description="gradient-domain path tracing against path tracing")
    parser.add_argument("scenes", nargs="*", metavar="SCENE",
                        help="names in tests/references (default: all but those for photons)")
    parser.add_argument("--gradus", type=pathlib.Path, default=renders.ROOT / "build" / "gradus")
    parser.add_argument("--spp", type=renders.at_least(1), default=64)
    parser.add_argument("--repeats", type=renders.at_least(1), default=5)
    parser.add_argument("--json", type=pathlib.Path, help="also write all figures to this file")
    arguments = parser.parse_args()
    names = arguments.scenes or [name for name in renders.usual_scenes() if name not in renders.SHARED_SCENES]
    scenes = renders.scenes_with_reference(names)
    results = []
    print(f"{'scene':<20} {'cost':>6} {'relMSE pt':>11} {'gpt':>11} {'equal samples':>14} {'equal time':>11}"
          f" {'of process':>11} {'auto':>9} {'expected':>9} {'regret':>7}")
    with tempfile.TemporaryDirectory() as folder:
        for scene in scenes:
            turns = {"pt": [], "gpt": [], "auto": []}
            for method in turns:  # kernels compiled
                render(arguments, scene, method, 0, 1, folder)
            for seed in range(1, arguments.repeats + 1):
                for method, measured in turns.items():
                    measured.append(render(arguments, scene, method, seed, arguments.spp, folder))
            cost, cost_auto = (statistics.median(m[0] / p[0] for m, p in zip(turns[method], turns["pt"]))
                               for method in ("gpt", "auto"))
            error = {method: statistics.median(turn[1] for turn in measured) for method, measured in turns.items()}
            gain = error["pt"] / error["gpt"]
            process = equal_process_time(*([statistics.median(turn[k] for turn in turns[method]) for k in (0, 1, 3)]
                                           for method in ("pt", "gpt")), arguments.spp)
            choices = [turn[2] for turn in turns["auto"]]
            pick = statistics.mode(choice["method"] for choice in choices)
            agreed = sum(choice["method"] == pick for choice in choices)
            expected = median_gain(choices)
            solving = {method: reconstruction_seconds(arguments, scene, method, folder) / arguments.spp
                       for method in {"gpt", pick}}
            pt_seconds = statistics.median(turn[0] for turn in turns["pt"])
            seconds = {"pt": pt_seconds, "gpt": cost * pt_seconds, "auto": cost_auto * pt_seconds}
            regret = regret_of(pick, error, seconds, solving)
            print(f"{scene.name:<20} {cost:6.2f} {error['pt']:11.3e} {error['gpt']:11.3e} {gain:14.2f}"
                  f" {gain / cost:11.2f} {'-' if process is None else f'{process:.2f}':>11}"
                  f" {pick:>5} {agreed}/{len(choices)}"
                  f" {'-' if expected is None else f'{expected:.2f}':>9} {regret:7.2f}", flush=True)
            results.append({"scene": scene.name, "cost": cost, "relmse": error, "equal_samples": gain,
                            "equal_time": gain / cost, "equal_process_time": process, "turns": turns,
                            "auto": {"pick": pick, "agreed": agreed, "expected": expected, "regret": regret}})
    regrets = [result["auto"]["regret"] for result in results]
    print(f"regret: geometric mean {statistics.geometric_mean(regrets):.3f}, largest {max(regrets):.2f}")
    if arguments.json:
        arguments.json.write_text(json.dumps(results, indent=2) + "\n")


if __name__ == "__main__":
    main()
