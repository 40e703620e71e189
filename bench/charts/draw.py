#!/usr/bin/env python3
"""Draws the report from the JSON of the benches alone: charts as SVG and PNG, and the page that holds them.

    python3 bench/charts/draw.py build/bench [--output build/bench/report]

What is not there is left out, with a note. Needs matplotlib (bench/peers/install.py gets it); without it the page has its
tables only.
"""

import argparse
import json
import pathlib
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent / "render"), str(HERE.parent / "solver")]
import chart as solver_chart  # noqa: E402
import chains  # noqa: E402
import convergence  # noqa: E402
import curves  # noqa: E402
import kernels  # noqa: E402
import page  # noqa: E402
import plotting  # noqa: E402
import scaling  # noqa: E402
import stages  # noqa: E402


class Report:
    """Reads what there is in a folder and gathers the sections of the page."""

    def __init__(self, folder, output, pyplot):
        self.folder, self.output, self.pyplot = folder, output, pyplot
        self.sections, self.found, self.missing = [], [], []

    def read(self, name):
        path = self.folder / name
        if not path.exists():
            self.missing.append(f"{name} is not there")
            return None
        try:
            self.found.append(json.loads(path.read_text()))
        except json.JSONDecodeError as error:
            self.missing.append(f"{name} is no JSON: {error}")
            return None
        return self.found[-1]

    def figure(self, name, draw, *arguments, **options):
        """The chart as HTML; empty without matplotlib."""
        if not self.pyplot:
            return ""
        figure = draw(self.pyplot, *arguments, **options)
        plotting.save(figure, self.output / name)
        self.pyplot.close(figure)
        return page.chart(plotting.for_page((self.output / name).with_suffix(".svg").read_text()))

    def add(self, heading, content):
        self.sections.append((heading, content))


def ratio(found, at):
    """Two cells: the ratio, and the error or the seconds at which it is; empty where it was not found."""
    if not found:
        return "", ""
    return f"{'over ' if found.get('at_least') else ''}{found['ratio']:.2f}", f"{found[at]:.2g}"


def summary_rows(results, metric):
    rows = []
    for entry in curves.summaries(results["points"], metric):
        slope = "" if entry["slope"] is None else f"{entry['slope']:.2f}"
        rows.append([entry["scene"], entry["method"], slope, *ratio(entry.get("time"), "error"),
                     *ratio(entry.get("equal_time"), "seconds"), entry.get("against_denoised", "")])
    return rows


def number(value):
    """A cell; empty where there is none."""
    return "" if value is None else f"{value:.2f}"


SUMMARY_HEADS = ["scene", "method", "slope", "time of pt / its own", "to relMSE", "relMSE of pt / its own", "at s",
                 "error against pt denoised"]


def point_rows(results):
    rows = []
    for scene, methods in curves.curves(results["points"]).items():
        trimmed = curves.curves(results["points"], "trimmed")[scene]
        for method, curve in methods.items():
            for entry, other in zip(curve, trimmed[method]):
                error = entry["error"]
                rows.append([scene, method, f"{entry['spp']:g}", f"{entry['seconds']['median']:.3g}",
                             f"{error['median']:.3g}", f"{error['least']:.3g} to {error['largest']:.3g}",
                             f"{other['error']['median']:.3g}"])
    return rows


def add_convergence(report):
    results = report.read("convergence.json")
    if not results:
        return
    content = report.figure("convergence", convergence.draw, results)
    content += page.text("Slope: exponent of time in the error, by least squares; points within four times the "
                         "reference's own error are left out. Time: to the least error that both methods reach. "
                         "Between measured points a curve is a power law; nothing is extrapolated.")
    content += page.table(SUMMARY_HEADS, summary_rows(results, "relmse"))
    content += page.folded("The same with the worst 0.1 % of the pixels left out",
                           report.figure("convergence-trimmed", convergence.draw, results, metric="trimmed")
                           + page.table(SUMMARY_HEADS, summary_rows(results, "trimmed")))
    content += page.folded("All points", page.table(
        ["scene", "method", "samples a pixel", "seconds", "relMSE", "least to largest", "trimmed"],
        point_rows(results)))
    content += page.folded("References", page.table(
        ["scene", "size", "reference by", "samples a pixel", "its own relMSE"],
        [[scene["name"], f"{scene['width']}x{scene['height']}", scene["reference"], scene["reference_spp"],
          f"{scene['reference_error']:.2g}"] for scene in results["scenes"]]))
    for note in results["notes"]:
        content += page.text(note)
    report.add("Error against time", content)


def add_pictures(report):
    path = report.folder / "pictures.png"
    about = report.read("pictures.json")
    if about and path.exists():
        report.add("The same time", page.picture(path, about["caption"]))


def add_crops(report):
    path = report.folder / "crops.png"
    about = report.read("crops.json")
    if about and about.get("crops") and path.exists():
        methods = list(about["crops"][0]["relmse"])
        rows = [[row["scene"], row["crop"], *(f"{row['relmse'][method]:.2e}" for method in methods),
                 *(row["samples"][method] for method in methods)] for row in about["crops"]]
        report.add("What is kept", page.picture(path, about["caption"]) + page.folded("As a table", page.table(
            ["scene", "crop", *(f"relMSE {method}" for method in methods), *(f"samples {method}" for method in methods)],
            rows)))


def add_photons(report):
    results = report.read("photons.json")
    if not results:
        return
    methods = {point["method"] for point in results["points"]}
    about = next((method for method in ("gpm", "sppm") if method in methods), "pt")
    content = page.text("Scenes whose light comes through smooth glass or from polished metal, which paths from the "
                        "camera find by chance alone. A method's bias by its radius counts as error.")
    if results["points"]:
        content += report.figure("photons", convergence.draw, results, method=about)
        content += page.table(SUMMARY_HEADS, summary_rows(results, "relmse"))
    picture = report.folder / "photon-pictures.png"
    if results.get("pictures") and picture.exists():
        content += page.picture(picture, results["pictures"]["caption"])
    rates = results.get("rates", {})
    if rates.get("settings"):
        content += page.text("Rates of both renderers with the same depth and roulette; where roulette is played, ours "
                             "is from a light path's first vertex on, so that our light paths are shorter.")
        content += page.table(["method", "paths of both", "light paths a second", "over Mitsuba 3's particle tracer",
                               "seconds a pass", "the survey's code / its own"],
                              [[name, setting["name"], f"{own['light_paths_per_second']:.3g}",
                                number(own.get("over_ptracer")), f"{own['seconds_a_pass']:.3g}",
                                number(own.get("over_survey"))]
                               for setting in rates["settings"] for name, own in setting["methods"].items()])
    if results.get("scaling"):
        content += report.figure("photon-scaling", scaling.draw, results)
    for note in results["notes"]:
        content += page.text(note)
    report.add("Photons", content)


def add_chains(report):
    results = report.read("chains.json")
    if not results or not results.get("chains"):
        return
    content = page.text("Shifts of chains alone: no light counts but that of photons which come from a specular or glossy "
                        "surface, as in figure 4 of Hua et al. 2017. Errors are root mean squares relative to that of the "
                        "truth, against two halves of a long render whose own noise is taken out.")
    content += report.figure("chains", chains.draw, results)
    report.add("Chains", content + page.text(chains.caption(results)))


def add_stages(report):
    results = report.read("profile.json")
    if results and results["profiles"]:
        rows = [[scene, method] + [f"{parts[part]:.3f}" for part in stages.COLOURS]
                for scene, method, parts in stages.bars(results["profiles"])]
        report.add("Where the time of a sample goes", report.figure("stages", stages.draw, results)
                   + page.folded("As a table", page.table(["scene", "method", *stages.COLOURS], rows)))


def add_floors(report):
    rows = []
    for name, method in (("floor.json", "pt"), ("gradient-floor.json", "gpt")):
        for entry in (report.read(name) or {}).get("floor", []):
            others = entry.get("other_replays", {})
            rows.append([entry["job"], method, f"{entry['ratio']['median']:.2f}",
                         f"{entry['ratio']['least']:.2f} to {entry['ratio']['largest']:.2f}", entry["target"]]
                        + [f"{others[kind]['ratio']['median']:.2f}" if kind in others else "" for kind in
                           ("packets", "single")])
    if rows:
        report.add("Rendering against its floor", page.text(
            "Seconds of a render over those in which Embree alone traces the same rays again: in the packets of the "
            "render, which are beams in scenes of few primitives; in packets that are no beams; and one by one, as "
            "Embree is mostly called.") + page.table(
                ["job", "method", "render / Embree alone", "least to largest", "target", "over packets",
                 "over single rays"], rows))


def add_holes(report):
    results = report.read("holes.json")
    if results:
        rows = [[entry["holes"], f"{entry['gain']:.2f}", f"{entry['alpha']:g}", entry["paper"]]
                for entry in results["holes"]]
        report.add("Gradients behind more and more occluders", page.text(
            "The experiment of Kettunen et al. 2015, supplement, figure 3, on a scene of our own, at "
            f"{results['spp']} samples a pixel: L2 reconstruction with the alpha that is best.") + page.table(
                ["holes along a side", "squared error of pt / of gpt", "alpha", "in the paper"], rows))


def add_kernels(report):
    results = report.read("kernels.json")
    if not results:
        return
    if kernels.functions_of(results):
        report.add("Functions of kernels: throughput against error",
                   report.figure("functions", kernels.draw_functions, results))
    if kernels.kernels_of(results):
        report.add("Kernels: throughput", report.figure("kernels", kernels.draw_throughput, results))
    if not kernels.functions_of(results) and not kernels.kernels_of(results):
        report.missing.append("kernels.json holds nothing of gradus-bench-kernels")


def add_solver(report):
    results = report.read("solver.json")
    if results and results.get("curves"):
        report.add("The solver: error against time", report.figure("solver", solver_chart.draw, results))


def add_log(report):
    path = report.folder / "run.log"
    if path.exists():
        report.add("All other measurements", page.folded("What bench/run printed", page.preformatted(path.read_text())))


def add_conditions(report):
    """Machine and commands of each file that tells them, and what is missing."""
    rows = [[" ".join(results["command"]), plotting.machine_line(results)] for results in report.found
            if "machine" in results]
    content = page.table(["command", "machine"], rows) if rows else ""
    content += "".join(page.text(f"Left out: {missing}.") for missing in report.missing)
    content += page.text("Measured by bench/report; drawn again from the JSON files by bench/report --draw-only.")
    report.add("How it was measured", content)


def main():
    parser = argparse.ArgumentParser(description="draws the report from the JSON of the benches")
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--output", type=pathlib.Path, help="folder of the page (default: FOLDER/report)")
    arguments = parser.parse_args()
    if not arguments.folder.is_dir():
        sys.exit(f"{arguments.folder}: no such folder")
    output = arguments.output or arguments.folder / "report"
    output.mkdir(parents=True, exist_ok=True)
    report = Report(arguments.folder, output, plotting.pyplot())
    for add in (add_convergence, add_pictures, add_crops, add_photons, add_chains, add_holes, add_stages, add_floors, add_kernels, add_solver,
                add_log, add_conditions):
        add(report)
    for missing in report.missing:
        print(f"left out: {missing}")
    (output / "index.html").write_text(page.page("Gradus: speed against accuracy", report.sections))
    print(f"wrote {output / 'index.html'}")


if __name__ == "__main__":
    main()
