"""Error against time for each scene, from the JSON of bench/render/convergence.py."""

import math
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "render"))
import curves  # noqa: E402
import plotting  # noqa: E402

COLUMNS = 3


def times(ratio, at_least=False):
    """A ratio in words: less or more time."""
    if ratio >= 1:
        return f"{'over ' if at_least else ''}{ratio:.2g} times less"
    return f"{1 / ratio:.2g} times more"


def range_of(ratios):
    least, largest = min(ratios), max(ratios)
    text = f"{least:.2g}"
    return text if f"{largest:.2g}" == text else f"{text} to {largest:.2g}"


def headline(summaries, method="gpt"):
    """What the chart says, in a sentence."""
    times_of_pt = {entry["scene"]: entry["time"] for entry in summaries
                   if entry["method"] == method and entry.get("time")}
    if not times_of_pt:
        return "Error against time"
    faster = [time for time in times_of_pt.values() if time["ratio"] > 1]
    slower = [1 / time["ratio"] for time in times_of_pt.values() if time["ratio"] <= 1]
    count = len(times_of_pt)
    scenes = next(iter(times_of_pt)) if count == 1 else f"{len(faster) or count} of {count} scenes"
    if not faster:
        return f"{method} needs {range_of(slower)} times more time than pt to the same error on {scenes}"
    bound = "at least " if any(time["at_least"] for time in faster) else ""
    text = f"{method} needs {bound}{range_of([time['ratio'] for time in faster])} times less time than pt to the same "
    text += f"error on {scenes}"
    if slower:
        text += f", {range_of(slower)} times more on the other" + ("s" if len(slower) > 1 else "")
    return text


def scene_title(scene, summaries, method="gpt"):
    entry = next((entry for entry in summaries if entry["scene"] == scene and entry["method"] == method), None)
    if not entry or not entry.get("time"):
        return scene
    time = entry["time"]
    return f"{scene}: {method} {times(time['ratio'], time['at_least'])} time"


def draw_scene(axes, methods, styles, floor, lowest):
    for method, (colour, marker, dashes) in styles.items():
        curve = methods.get(method)
        if not curve:
            continue
        x = [entry["seconds"]["median"] for entry in curve]
        y = [entry["error"]["median"] for entry in curve]
        below = [entry["error"]["median"] - entry["error"]["least"] for entry in curve]
        above = [entry["error"]["largest"] - entry["error"]["median"] for entry in curve]
        axes.errorbar(x, y, yerr=[below, above], color=colour, marker=marker, linestyle=dashes, markersize=4.5,
                      linewidth=1.3, elinewidth=0.8, capsize=1.5, label=method)
    axes.set_xscale("log")
    axes.set_yscale("log")
    if floor > 0 and floor > 0.3 * lowest:
        axes.axhline(floor, color=plotting.GREY, linewidth=0.9, linestyle=(0, (1, 2)))
        axes.annotate("error of the reference", (0.02, floor), xycoords=("axes fraction", "data"), fontsize=6.5,
                      color=plotting.GREY, xytext=(0, 2), textcoords="offset points")
    plotting.grid(axes)


def draw(pyplot, results, metric="relmse", method="gpt"):
    """The figure: a panel for each scene. metric: relmse or trimmed; method: the one that the titles are about."""
    by_scene = curves.curves(results["points"], metric)
    summaries = curves.summaries(results["points"], metric)
    floors = {scene["name"]: scene["reference_error"] for scene in results["scenes"]}
    styles = plotting.method_styles({point["method"] for point in results["points"]})
    columns = min(COLUMNS, len(by_scene))
    rows = math.ceil(len(by_scene) / columns)
    width = max(4.1 * columns, 7)
    height = (3.1 if columns > 1 else 4) * rows + 1
    figure, grid = pyplot.subplots(rows, columns, figsize=(width, height), squeeze=False)
    panels = [axes for row in grid for axes in row]
    for axes, (scene, methods) in zip(panels, by_scene.items()):
        lowest = min(entry["error"]["least"] for curve in methods.values() for entry in curve)
        draw_scene(axes, methods, styles, floors.get(scene, 0), lowest)
        axes.set_title(scene_title(scene, summaries, method), fontsize=9.5)
        axes.set_xlabel("seconds (rendering and reconstruction or denoising)", fontsize=7.5)
        axes.set_ylabel("relMSE" if metric == "relmse" else "relMSE, worst 0.1 % left out", fontsize=8)
        axes.tick_params(labelsize=7.5)
    for axes in panels[len(by_scene):]:
        axes.set_visible(False)
    handles = [pyplot.Line2D([], [], color=colour, marker=marker, linestyle=dashes, markersize=5)
               for colour, marker, dashes in styles.values()]
    plotting.frame(figure, headline(summaries, method), handles, [plotting.METHOD_TEXTS.get(name, name) for name in styles],
                   f"{plotting.machine_line(results)}\nmedian, least and largest of {results['seeds']} seeds; start, "
                   "loading and compiling left out", len(styles) if width > 10 else 2)
    return figure
