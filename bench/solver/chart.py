#!/usr/bin/env python3
"""Draws error against time from the JSON of gradus-bench-solver, as SVG and PNG.

    python3 bench/solver/chart.py build/bench/solver.json [--output build/bench/solver]

Above, L2: relative difference to the solution by a discrete cosine transform in double precision. Below, L1: how far
the objective is above the least that any point of the same size reached (that point itself is not drawn). Needs
matplotlib (bench/peers/install.py gets it); without it, says so and draws nothing.
"""

import argparse
import json
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "charts"))
import plotting  # noqa: E402

STYLES = {
    "jacobi": (plotting.GREY, "o"),
    "cg": (plotting.SKY, "s"),
    "pcg": (plotting.GREEN, "^"),
    "multigrid": (plotting.VERMILLION, "D"),
    "FFTW DCT, float": (plotting.INK, "*"),
    "default": (plotting.VERMILLION, "D"),
    "reweightings of 50 cg": (plotting.BLUE, "s"),
    "default, as it stops": (plotting.INK, "*"),
}


def seconds(points):
    return [point["seconds"]["median"] for point in points]


def draw_curve(axes, curve, points, values):
    color, marker = STYLES[curve["method"]]
    line = "none" if len(points) == 1 else "-"
    axes.loglog(seconds(points), values, linestyle=line, marker=marker, color=color, label=curve["method"],
                markersize=9 if marker == "*" else 4, linewidth=1.2)


def draw_l2(axes, curves):
    for curve in curves:
        draw_curve(axes, curve, curve["points"], [point["error"] for point in curve["points"]])
    axes.set_ylabel("relative error (no unit)")


def draw_l1(axes, curves):
    least = min(point["objective"] for curve in curves for point in curve["points"])
    for curve in curves:
        points = [point for point in curve["points"] if point["objective"] > least]
        if points:
            draw_curve(axes, curve, points, [point["objective"] / least - 1 for point in points])
    axes.set_ylabel("objective over the least found, minus 1")


def draw(pyplot, results):
    charts = results["curves"]
    figure, grid = pyplot.subplots(2, len(charts), figsize=(4.4 * len(charts), 7.4), squeeze=False)
    for column, chart in enumerate(charts):
        for row, (norm, draw_norm) in enumerate((("l2", draw_l2), ("l1", draw_l1))):
            axes = grid[row][column]
            draw_norm(axes, chart[norm])
            axes.set_title(f"{norm.upper()}, {chart['size']} RGB ({chart['pixels'] / 1e6:.2f} Mpixel)", fontsize=10)
            axes.set_xlabel("wall time (s)")
            plotting.grid(axes)
            axes.legend(fontsize=7)
    figure.text(0.5, 0.005, f"{results['device']} ({results['platform']}), {results['threads']} threads; alpha "
                f"{results['alpha']}; medians of {results['repeats']} turns; one synthetic image, seed 1; "
                "gradus-bench-solver --parts curves", ha="center", fontsize=7)
    figure.tight_layout(rect=(0, 0.02, 1, 1))
    return figure


def main():
    parser = argparse.ArgumentParser(description="the solver's chart from its JSON")
    parser.add_argument("json", type=pathlib.Path)
    parser.add_argument("--output", type=pathlib.Path, help="path without suffix (default: that of the JSON)")
    arguments = parser.parse_args()
    results = json.loads(arguments.json.read_text())
    if not results.get("curves"):
        sys.exit(f"{arguments.json}: holds no curves; run gradus-bench-solver with the part curves")
    pyplot = plotting.pyplot()
    if pyplot:
        plotting.save(draw(pyplot, results), arguments.output or arguments.json.with_suffix(""))


if __name__ == "__main__":
    main()
