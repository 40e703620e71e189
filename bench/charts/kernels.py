"""Kernels and the functions that they call: throughput against error by precision, from the JSON of
gradus-bench-kernels."""

import math

import plotting

STYLES = {"double": (plotting.INK, "o"), "float": (plotting.BLUE, "s"), "relaxed": (plotting.VERMILLION, "D")}
COLUMNS = 5
LEAST = 1e-8  # errors under it, and double's own, are drawn at it


def functions_of(results):
    """{function: {build: (items per second, error inside the domain, error at its edges)}}, an error being the largest
    over all results of the function that 99.9 % of the cases keep; empty where the file holds none."""
    accuracy = results.get("accuracy") or {} if isinstance(results, dict) else {}
    functions = {}
    for rate in accuracy.get("rates", []):
        for build, items in rate["items_per_second"].items():
            errors = [entry for entry in accuracy["errors"]
                      if entry["function"] == rate["function"] and entry["build"] == build]
            inside, edge = (max((entry["relative_99.9"] for entry in errors if entry["is_edge"] == at_edge), default=0)
                            for at_edge in (False, True))
            functions.setdefault(rate["function"], {})[build] = (items, max(inside, LEAST), max(edge, LEAST))
    return functions


def kernels_of(results):
    """{kernel: its entry of the longest queue}; empty where the file holds none. Kernels of one name have their file
    beside it."""
    longest = {}
    for entry in results.get("throughput") or [] if isinstance(results, dict) else []:
        place = entry["kernel"], entry.get("file", "")
        if place not in longest or entry["queue"] > longest[place]["queue"]:
            longest[place] = entry
    names = [name for name, _ in longest]
    return {name if names.count(name) == 1 else f"{name} ({file.removeprefix('kernels/')})": entry
            for (name, file), entry in longest.items()}


def foot(results, text):
    return f"{results['device']} ({results['platform']}), medians of {results['repeats']} runs; {text}"


def gains(ratios):
    ratios = sorted(ratios)
    return f"{ratios[len(ratios) // 2]:.2g} times as fast as float (median; {ratios[0]:.2g} to {ratios[-1]:.2g})"


def draw_functions(pyplot, results):
    """A panel for each function: a point for each build, with a hollow one for the edges of its domain."""
    functions = functions_of(results)
    columns = min(COLUMNS, len(functions))
    rows = math.ceil(len(functions) / columns)
    figure, grid = pyplot.subplots(rows, columns, figsize=(max(2.5 * columns, 7), 2.1 * rows + 0.8), squeeze=False,
                                   sharey=True)
    panels = [axes for row in grid for axes in row]
    most = max(edge for points in functions.values() for _, _, edge in points.values())
    for axes, (function, points) in zip(panels, functions.items()):
        for build, (rate, inside, edge) in points.items():
            colour, marker = STYLES[build]
            axes.plot([rate / 1e6], [inside], color=colour, marker=marker, markersize=5.5, linestyle="none")
            if build != "double":
                axes.plot([rate / 1e6], [edge], color=colour, marker=marker, markersize=5.5, linestyle="none",
                          markerfacecolor="none")
        axes.set_yscale("log")
        axes.set_ylim(LEAST / 2, max(1e-3, 3 * most))
        axes.set_xlim(0, 1.15 * max(rate for rate, _, _ in points.values()) / 1e6)
        axes.set_title(function, fontsize=8.5)
        axes.set_xlabel("million items a second", fontsize=7)
        axes.tick_params(labelsize=7)
        plotting.grid(axes)
    for axes in panels[len(functions):]:
        axes.set_visible(False)
    for row in grid:
        row[0].set_ylabel("relative error (99.9 %)", fontsize=7)
    used = [build for build in STYLES if any(build in points for points in functions.values())]
    handles = [pyplot.Line2D([], [], color=STYLES[build][0], marker=STYLES[build][1], linestyle="none")
               for build in used]
    handles.append(pyplot.Line2D([], [], color=plotting.GREY, marker="s", markerfacecolor="none", linestyle="none"))
    ratios = [points["relaxed"][0] / points["float"][0] for points in functions.values()
              if "relaxed" in points and "float" in points]
    plotting.frame(figure, f"Relaxed arithmetic: {gains(ratios)}" if ratios else "Functions: throughput against error",
                   handles, [*used, "at the edges of the domain"],
                   foot(results, f"errors are relative to the double build, directions and warps absolute; what is "
                        f"under {LEAST:g} is drawn there, as is double"), 4)
    return figure


def draw_throughput(pyplot, results):
    """A row for each kernel: its speed in relaxed and in double arithmetic over float, and its bytes over a triad's."""
    kernels = kernels_of(results)
    figure, (speed, bandwidth) = pyplot.subplots(1, 2, figsize=(10, 0.2 * len(kernels) + 1.9), sharey=True,
                                                 gridspec_kw={"width_ratios": [3, 2]})
    ratios = []
    for place, entry in enumerate(kernels.values()):
        for build in ("relaxed", "double"):
            if build in entry["items_per_second"]:
                ratio = entry["items_per_second"][build] / entry["items_per_second"]["float"]
                speed.plot([ratio], [place], color=STYLES[build][0], marker=STYLES[build][1], markersize=5,
                           linestyle="none")
                if build == "relaxed":
                    ratios.append(ratio)
        if entry.get("bandwidth_over_triad") is not None:
            bandwidth.barh(place, entry["bandwidth_over_triad"], height=0.6, color=plotting.BLUE)
    speed.axvline(1, color=plotting.BLUE, linewidth=1.2)
    speed.set_xlim(left=0)
    speed.set_xlabel("items a second over those of float", fontsize=8)
    bandwidth.set_xlabel("bytes a second over those of a triad, float", fontsize=8)
    speed.set_yticks(range(len(kernels)), list(kernels), fontsize=7)
    speed.set_ylim(len(kernels) - 0.4, -0.6)
    for axes in (speed, bandwidth):
        axes.tick_params(axis="x", labelsize=7.5)
        plotting.grid(axes)
    handles = [pyplot.Line2D([], [], color=STYLES[build][0], marker=STYLES[build][1], linestyle="none")
               for build in ("relaxed", "double")]
    handles.append(pyplot.Line2D([], [], color=plotting.BLUE, linewidth=1.2))
    plotting.frame(figure, f"Relaxed kernels: {gains(ratios)}" if ratios else "Kernels in other arithmetic", handles,
                   ["relaxed", "double", "float = 1"],
                   foot(results, "the longest queue measured; no bar: bytes not known"), 3)
    return figure
