"""Throughput against error of each kernel by precision, from the JSON of gradus-bench-kernels.

Entries have kernel, precision, items_per_second and an error relative to the double build: p999_relative_error or
max_relative_error. Of several queue sizes the largest is drawn.
"""

import math

import plotting

STYLES = {"double": (plotting.INK, "o"), "float": (plotting.BLUE, "s"), "relaxed": (plotting.VERMILLION, "D")}
COLUMNS = 4
LEAST = 1e-9  # errors under it, and double's own, are drawn at it


def entries_of(results):
    """The list of entries, wherever the file has it; empty where it holds none."""
    lists = [results] if isinstance(results, list) else list(results.values())
    for found in lists:
        if isinstance(found, list) and found and isinstance(found[0], dict) and "items_per_second" in found[0]:
            return found
    return []


def number(value):
    """A figure, or the median of its spread."""
    return value["median"] if isinstance(value, dict) else value


def error_of(entry):
    for name in ("p999_relative_error", "max_relative_error"):
        if entry.get(name) is not None:
            return max(number(entry[name]), LEAST)
    return LEAST


def by_kernel(entries):
    """{kernel: {precision: (items per second, error)}}, of the largest queue."""
    largest = {}
    for entry in entries:
        key = entry["kernel"], entry["precision"]
        if key not in largest or entry.get("queue_size", 0) >= largest[key].get("queue_size", 0):
            largest[key] = entry
    kernels = {}
    for (kernel, precision), entry in largest.items():
        kernels.setdefault(kernel, {})[precision] = (number(entry["items_per_second"]), error_of(entry))
    return kernels


def headline(kernels):
    gains = [points["relaxed"][0] / points["float"][0] for points in kernels.values()
             if "relaxed" in points and "float" in points]
    if not gains:
        return "Kernels: throughput against error"
    return (f"Relaxed arithmetic makes a kernel {min(gains):.2g} to {max(gains):.2g} times as fast as float "
            f"(median {sorted(gains)[len(gains) // 2]:.2g})")


def draw(pyplot, results):
    kernels = by_kernel(entries_of(results))
    columns = min(COLUMNS, len(kernels))
    rows = math.ceil(len(kernels) / columns)
    figure, grid = pyplot.subplots(rows, columns, figsize=(max(2.7 * columns, 7), 2.2 * rows + 0.8), squeeze=False,
                                   sharey=True)
    panels = [axes for row in grid for axes in row]
    for axes, (kernel, points) in zip(panels, sorted(kernels.items())):
        for precision, (rate, error) in points.items():
            colour, marker = STYLES.get(precision, (plotting.GREEN, "^"))
            axes.plot([rate / 1e6], [error], color=colour, marker=marker, markersize=6, linestyle="none")
        axes.set_xscale("log")
        axes.set_yscale("log")
        axes.set_ylim(LEAST / 2, max(1e-3, 3 * max(error for points in kernels.values()
                                                   for _, error in points.values())))
        rates = [rate / 1e6 for rate, _ in points.values()]
        axes.set_xlim(min(rates) / 2, max(rates) * 2)
        axes.xaxis.set_major_locator(pyplot.matplotlib.ticker.LogLocator(subs=(1, 2, 5)))
        axes.xaxis.set_major_formatter(pyplot.matplotlib.ticker.FormatStrFormatter("%g"))
        axes.xaxis.set_minor_formatter(pyplot.matplotlib.ticker.NullFormatter())
        axes.set_title(kernel, fontsize=8.5)
        axes.set_xlabel("million items a second", fontsize=7)
        axes.tick_params(labelsize=7)
        plotting.grid(axes)
    for axes in panels[len(kernels):]:
        axes.set_visible(False)
    used = [precision for precision in STYLES if any(precision in points for points in kernels.values())]
    handles = [pyplot.Line2D([], [], color=STYLES[precision][0], marker=STYLES[precision][1], linestyle="none")
               for precision in used]
    for row in grid:
        row[0].set_ylabel("error relative to double\n(99.9th percentile)", fontsize=7)
    plotting.frame(figure, headline(kernels), handles, used, f"double has no error by definition; errors under "
                   f"{LEAST:g} are drawn there, too; largest queue measured", len(used))
    return figure
