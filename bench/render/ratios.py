#!/usr/bin/env python3
"""Tables of what convergence.py measured: the error of each method over that of one of them.

    python3 bench/render/ratios.py [--over pt] [--at time|samples] [--metric relmse] [--json FILE]

At equal samples, the errors at a count are compared; at equal time, the error of the other is that of its curve at the
time of the point, a power law between its own points. Where its curve does not reach, there is a dash. Below stand the
geometric mean and the largest of each column. The reference's own error is taken off relMSE: it is in the error of each
method, and is most of it where little is left.
"""

import argparse
import json
import math
import pathlib
import statistics
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))
import curves  # noqa: E402
import renders  # noqa: E402


def ratios(methods, over, at):
    """By sample count and method: error over that of the method `over`; None where that has no error to compare."""
    line = curves.line(methods[over])
    of_samples = {entry["spp"]: entry["error"]["median"] for entry in methods[over]}
    found = {}
    for method, entries in methods.items():
        for entry in entries:
            other = (curves.error_at(line, entry["seconds"]["median"]) if at == "time"
                     else of_samples.get(entry["spp"]))
            found.setdefault(entry["spp"], {})[method] = entry["error"]["median"] / other if other else None
    return found


def without_reference_error(points):
    """With what they have more error than the reference has itself, which of single seeds may be less than nothing;
    without those of a method and a count where that is the median."""
    groups = {}
    for point in points:
        more = {**point, "relmse": point["relmse"] - point["reference_error"]}
        groups.setdefault((point["scene"], point["method"], point["budget"]), []).append(more)
    return [point for group in groups.values() for point in group
            if statistics.median(seed["relmse"] for seed in group) > 0]


def row(name, spp, values):
    return f"{name:20} {spp:>5}  " + "  ".join(f"{'-' if v is None else format(v, '.2f'):>12}" for v in values)


def main():
    parser = argparse.ArgumentParser(description="tables of ratios of errors")
    parser.add_argument("--over", default="pt", help="the method that the others are compared with (pt)")
    parser.add_argument("--at", choices=["time", "samples"], default="time", help="equal time (default) or samples")
    parser.add_argument("--metric", choices=["relmse", "trimmed"], default="relmse")
    parser.add_argument("--json", type=pathlib.Path, default=renders.ROOT / "build" / "bench" / "convergence.json")
    arguments = parser.parse_args()
    if not arguments.json.exists():
        sys.exit(f"{arguments.json} is not there: run bench/render/convergence.py")
    points = json.loads(arguments.json.read_text())["points"]
    if arguments.metric == "relmse":
        points = without_reference_error(points)
    by_scene = curves.curves(points, arguments.metric)
    names = [name for name in dict.fromkeys(point["method"] for point in points) if name != arguments.over]
    print(f"{arguments.metric} over that of {arguments.over}, at equal {arguments.at}")
    print(f"{'scene':20} {'spp':>5}  " + "  ".join(f"{name.replace('guided', 'g'):>12}" for name in names))
    columns = {name: [] for name in names}
    for scene, methods in by_scene.items():
        if arguments.over not in methods:
            print(f"{scene}: not measured with {arguments.over}")
            continue
        for spp, found in sorted(ratios(methods, arguments.over, arguments.at).items()):
            if not any(name in found for name in names):
                continue
            print(row(scene, f"{spp:.0f}", [found.get(name) for name in names]))
            for name in names:
                if found.get(name):
                    columns[name].append(found[name])
    for what, of in (("geometric mean", lambda all: math.exp(statistics.fmean(map(math.log, all)))), ("largest", max)):
        print(row(what, "", [of(columns[name]) if columns[name] else None for name in names]))


if __name__ == "__main__":
    main()
