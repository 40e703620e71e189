#!/usr/bin/env python3
"""Tables of what convergence.py measured: the error of each method over that of one of them.

    python3 bench/render/ratios.py [--over pt ...] [--at time|samples] [--metric relmse] [--json FILE]

At equal samples, the errors at a count are compared; at equal time, the error of the other is that of its curve at the
time of the point, a power law between its own points. Where its curve does not reach, there is a dash. A row is a
budget, samples a pixel or seconds; below stand the geometric mean and the largest of each column. Of several methods to
compare with, the first that was measured counts. The reference's own error is taken off relMSE: it is in the error of each
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
    """By budget and method: error over that of the method `over`; None where that has no error to compare."""
    line = curves.line(methods[over])
    of_samples = {entry["spp"]: entry["error"]["median"] for entry in methods[over]}
    found = {}
    for method, entries in methods.items():
        for entry in entries:
            other = (curves.error_at(line, entry["seconds"]["median"]) if at == "time"
                     else of_samples.get(entry["spp"]))
            found.setdefault(entry["budget"], {})[method] = entry["error"]["median"] / other if other else None
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


def order_of(budget):
    number, unit = budget.split()
    return unit, float(number)


def row(name, budget, values, widths):
    cells = (f"{'-' if value is None else f'{value:.2f}':>{width}}" for value, width in zip(values, widths))
    return f"{name:20} {budget:>12}  " + "  ".join(cells)


def main():
    parser = argparse.ArgumentParser(description="tables of ratios of errors")
    parser.add_argument("--over", nargs="+", default=["pt"], metavar="METHOD",
                        help="the method that the others are compared with: the first of these that was measured (pt)")
    parser.add_argument("--at", choices=["time", "samples"], default="time", help="equal time (default) or samples")
    parser.add_argument("--metric", choices=["relmse", "trimmed"], default="relmse")
    parser.add_argument("--json", type=pathlib.Path, default=renders.ROOT / "build" / "bench" / "convergence.json")
    arguments = parser.parse_args()
    if not arguments.json.exists():
        sys.exit(f"{arguments.json} is not there: run bench/render/convergence.py")
    points = json.loads(arguments.json.read_text())["points"]
    measured = list(dict.fromkeys(point["method"] for point in points))
    over = next((method for method in arguments.over if method in measured), None)
    if over is None:
        parser.error(f"--over {' '.join(arguments.over)}: not in {arguments.json}, which has {', '.join(measured)}")
    if arguments.metric == "relmse":
        points = without_reference_error(points)
    by_scene = curves.curves(points, arguments.metric)
    names = [name for name in measured if name != over]
    widths = [max(12, len(name)) for name in names]
    print(f"{arguments.metric} over that of {over}, at equal {arguments.at}")
    print(f"{'scene':20} {'budget':>12}  " + "  ".join(f"{name:>{width}}" for name, width in zip(names, widths)))
    columns = {name: [] for name in names}
    for scene, methods in by_scene.items():
        if over not in methods:
            print(f"{scene}: not measured with {over}")
            continue
        of_budgets = ratios(methods, over, arguments.at)
        for budget in sorted(of_budgets, key=order_of):
            found = of_budgets[budget]
            if not any(name in found for name in names):
                continue
            print(row(scene, budget, [found.get(name) for name in names], widths))
            for name in names:
                if found.get(name):
                    columns[name].append(found[name])
    for what, of in (("geometric mean", lambda all: math.exp(statistics.fmean(map(math.log, all)))), ("largest", max)):
        print(row(what, "", [of(columns[name]) if columns[name] else None for name in names], widths))


if __name__ == "__main__":
    main()
