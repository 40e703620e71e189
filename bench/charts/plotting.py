"""matplotlib for the charts: how it is found, what methods look like, how figures are saved for pages light and dark.

Charts are drawn in black and light grey on white. for_page() turns these three colours into the page's own, so the same
SVG is readable on both backgrounds; the other colours, of Okabe and Ito's palette, are told apart by colour-blind
readers and on both. Markers differ, too.
"""

import os
import pathlib
import re
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "peers"))
from pythons import find_python  # noqa: E402

PYTHON_VARIABLE = "GRADUS_CHART_PYTHON"
OTHER_PYTHONS = ["/usr/bin/python3"]  # Debian's package is for Debian's Python

INK, PAPER, GRID = "#000000", "#ffffff", "#dddddd"
BLUE, SKY, GREEN, ORANGE, VERMILLION, PURPLE, YELLOW, GREY = (
    "#0072B2", "#56B4E9", "#009E73", "#E69F00", "#D55E00", "#CC79A7", "#F0E442", "#999999")

# colour, marker, line
METHODS = {
    "pt": (INK, "o", "-"),
    "gpt": (VERMILLION, "D", "-"),
    "gpt:guided": (ORANGE, "d", "-"),
    "pt:guided": (GREY, "o", "-"),
    "auto": (PURPLE, "s", "-"),
    "sppm": (SKY, "P", "-"),
    "gpm": (ORANGE, "X", "-"),
    "denoised": (BLUE, "^", "--"),
    "mitsuba": (GREEN, "v", ":"),
}
BROWN = "#7F5F3F"
OTHERS = [(GREY, "*", "-"), (YELLOW, "p", "-"), (BROWN, "h", "--"), (SKY, "<", "-."), (GREEN, ">", "-"),
          (PURPLE, "H", "--"), (VERMILLION, "8", "-."), (BLUE, "p", ":")]
METHOD_TEXTS = {
    "pt": "pt, path tracing",
    "gpt": "gpt, gradient-domain path tracing",
    "gpt:guided": "gpt, guided by a filter",
    "pt:guided": "pt, guided by a filter",
    "sppm": "sppm, progressive photon mapping",
    "gpm": "gpm, gradient-domain photon density estimation",
    "denoised": "pt, denoised (Open Image Denoise)",
    "mitsuba": "Mitsuba 3, path tracing",
}


def method_styles(methods):
    """Colour, marker and line of each, the known ones always the same and in their order."""
    known = [name for name in METHODS if name in methods]
    unknown = sorted(set(methods) - set(METHODS))
    return {**{name: METHODS[name] for name in known},
            **{name: OTHERS[i % len(OTHERS)] for i, name in enumerate(unknown)}}


def find_chart_python():
    return find_python(["matplotlib"], PYTHON_VARIABLE, others=OTHER_PYTHONS)


def pyplot():
    """matplotlib.pyplot, set up; None where it is missing. The Python that has it may not be the one that runs this:
    then the whole program starts again with that one."""
    try:
        import matplotlib
    except ImportError:
        python = None if "GRADUS_CHART_AGAIN" in os.environ else find_chart_python()
        if python:
            os.environ["GRADUS_CHART_AGAIN"] = "1"
            sys.stdout.flush()
            os.execv(python, [python, *sys.argv])
        print("skipped: no matplotlib (python3 bench/peers/install.py gets it)")
        return None
    matplotlib.use("Agg")
    matplotlib.rcParams["svg.hashsalt"] = "gradus"  # equal figures give equal files
    from matplotlib import pyplot as found

    return found


def save(figure, path):
    """path.svg and path.png."""
    path.parent.mkdir(parents=True, exist_ok=True)
    for suffix in (".svg", ".png"):
        figure.savefig(path.with_suffix(suffix), dpi=130, metadata={"Date": None} if suffix == ".svg" else None)
        print(f"wrote {path.with_suffix(suffix)}")


def for_page(svg):
    """The SVG's element alone, its black, white and grid in the page's colours (CSS variables ink, paper, grid). Text
    has no colour of its own where it is black: the page fills it."""
    element = svg[svg.index("<svg"):]
    for colour, name in ((INK, "ink"), (PAPER, "paper"), (GRID, "grid")):
        element = re.sub(f"{colour}\\b", f"var(--{name})", element)
    return element


def grid(axes):
    axes.grid(True, which="major", color=GRID, linewidth=0.6)
    axes.set_axisbelow(True)


def frame(figure, title, handles, labels, foot, columns):
    """Title and legend over the axes, small print under them, and the axes laid out between."""
    inches = figure.get_size_inches()[1]
    legend_rows = -(-len(labels) // columns)
    figure.text(0.5, 1 - 0.1 / inches, title, fontsize=11.5, ha="center", va="top")
    figure.legend(handles, labels, loc="upper center", bbox_to_anchor=(0.5, 1 - 0.3 / inches), ncol=columns, fontsize=8,
                  frameon=False)
    figure.text(0.5, 0.08 / inches, foot, ha="center", fontsize=6.5)
    figure.tight_layout(rect=(0, (0.12 + 0.12 * len(foot.splitlines())) / inches, 1,
                              1 - (0.42 + 0.17 * legend_rows) / inches))


def machine_line(results):
    """What a chart was measured on, in a line under it."""
    machine = results["machine"]
    device = (machine.get("device") or {}).get("name", "no device")
    return (f"{machine['processor']}, {machine['processors']} processors; {device}; load {machine['load_before']:.1f} "
            f"to {machine.get('load_after', machine['load_before']):.1f}; {machine['date']}, {machine['commit']}")
