#!/usr/bin/env python3
"""Photon methods on scenes that path tracing finds hard: error against time, rates, pictures at equal time.

    python3 bench/render/photons.py [SCENE ...] [--seconds 2 8 32] [--seeds 3] [--parts curves rates scaling pictures]

SCENE is a name in tests/references; default: those whose light comes through smooth glass or from polished metal. The
methods are pt, sppm and gpm, or --method; what the program has not got is skipped with a note. All are given the same
times, so that no count of one must be weighed against that of another, and take turns.

curves: relMSE over seconds, as render/convergence.py measures them.
rates: on the Cornell box, light paths a second over all of the rendering and over the stages of light paths alone, over
those of Mitsuba 3's particle tracer; seconds a pass, as it comes and, with Russian roulette, over what the survey's code
takes for passes of a million stored photons, scaled to this machine by a path sample of Mitsuba 3 (0.45 us where that
code was measured). Twice, with the same depth and roulette for both renderers: depth 13 without roulette, where both
trace the same paths; and depth 30 with roulette from 5 on, where ours is played from a light path's first vertex on, as
our methods do wherever there is any, and Mitsuba's from the fifth, so that ours are shorter.
scaling: on the Cornell box, seconds a pass over its photons and over its gather points, two decades of each, and the
slopes of line fits.
pictures: one scene, all methods at the longest time, with maps of the error.
"""

import argparse
import dataclasses
import json
import os
import pathlib
import statistics
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
PEERS = HERE.parent / "peers"
sys.path[:0] = [str(HERE), str(PEERS), str(HERE.parent / "charts")]
import convergence  # noqa: E402
import curves  # noqa: E402
import mitsuba_setup  # noqa: E402
import plotting  # noqa: E402
import renders  # noqa: E402
from pythons import find_python  # noqa: E402

PICTURE_SCENE = "torus-smooth-glass-soft"
METHODS = ["pt", "sppm", "gpm"]
PARTS = ["curves", "rates", "scaling", "pictures"]

# The survey's code, Cornell box of ../shared at 256x256, passes of 1 M stored photons, two cores: seconds a pass; and
# Mitsuba 3's path tracer on that machine and scene, microseconds a sample.
SURVEY_SECONDS = {"sppm": 0.9, "gpm": 1.6}
SURVEY_MICROSECONDS = 0.45
SURVEY_PHOTONS = 1_000_000

# What a rate is taken with, on both sides.
NO_ROULETTE = {"name": "depth 13, no roulette", "max_depth": 13, "rr_depth": renders.NO_ROULETTE}
ROULETTE = {"name": "depth 30, roulette from 5", "max_depth": 30, "rr_depth": 5}


def measure_curves(arguments, scene, methods):
    with tempfile.TemporaryDirectory() as folder:
        measurement = convergence.Measurement(arguments, scene, folder)
        measurement.warm_up(methods, False)
        measurement.measure(methods, [("seconds", seconds) for seconds in arguments.seconds], False)
    return measurement.points, measurement.notes


def mitsuba_rate(python, scene, integrator, spp, setting):
    """Samples, or light paths, a second: the median of five."""
    command = [python, PEERS / "mitsuba_rate.py", scene.file, "--size", f"{scene.width}x{scene.height}", "--spp", spp,
               "--integrator", integrator, "--max-depth", setting["max_depth"], "--rr-depth", setting["rr_depth"]]
    record = json.loads(renders.run(*command).strip().splitlines()[-1])
    return record["samples_per_second"]["median"]


def rates_of(record):
    """What one render's statistics say of its light paths."""
    light_seconds = sum(stage["seconds"] for stage in record["stages"] if stage["name"].startswith("light paths"))
    return {"light_paths_per_second": record["light_paths"] / record["render_seconds"],
            "light_paths_per_second_of_their_stages":
                record["light_paths"] / light_seconds if light_seconds > 0 else None,
            "photons_a_pass": record["photons"] / record["spp"],
            "seconds_a_pass": record["render_seconds"] / record["spp"]}


def median_of(turns):
    """The medians of like dictionaries, key by key; None where any is."""
    return {key: None if any(turn[key] is None for turn in turns) else statistics.median(turn[key] for turn in turns)
            for key in turns[0]}


def own_rates(arguments, scene, method, setting):
    """Of passes of a million photons."""
    scene = dataclasses.replace(scene, max_depth=setting["max_depth"])
    roulette = ["--rr-depth", setting["rr_depth"]]
    with tempfile.TemporaryDirectory() as folder:
        image = pathlib.Path(folder) / "image.exr"
        first = renders.render(arguments.gradus, scene, method, 0, image, samples=1, options=roulette)
        paths = ["--photons", round(SURVEY_PHOTONS * first["light_paths"] / first["photons"])]
        return median_of([rates_of(renders.render(arguments.gradus, scene, method, seed, image,
                                                  samples=arguments.passes, options=[*paths, *roulette]))
                          for seed in range(1, arguments.turns + 1)])


def measure_rates(arguments, methods, python):
    scene = renders.shared_scene("cornell-box-256")
    if not scene.file.exists():
        scene = renders.Scene("cornell-box", renders.ROOT / "scenes" / "cornell-box.xml", 256, 256)
    found = {"scene": scene.name, "settings": []}
    if python:
        found["mitsuba_microseconds_a_sample"] = 1e6 / mitsuba_rate(python, scene, "path", 64, NO_ROULETTE)
        scale = found["mitsuba_microseconds_a_sample"] / SURVEY_MICROSECONDS
    for setting in (NO_ROULETTE, ROULETTE):
        of_setting = {**setting, "methods": {}}
        if python:
            of_setting["ptracer_light_paths_per_second"] = mitsuba_rate(python, scene, "ptracer", 16, setting)
        for method in [method for method in methods if method in SURVEY_SECONDS]:
            own = own_rates(arguments, scene, method, setting)
            if python:
                own["over_ptracer"] = own["light_paths_per_second"] / of_setting["ptracer_light_paths_per_second"]
                if setting is ROULETTE:
                    own["over_survey"] = SURVEY_SECONDS[method] * scale / own["seconds_a_pass"]
            of_setting["methods"][method] = own
        found["settings"].append(of_setting)
    return found


def print_rates(rates):
    if "mitsuba_microseconds_a_sample" in rates:
        print(f"\n{rates['scene']}: Mitsuba 3 takes {rates['mitsuba_microseconds_a_sample']:.2f} us a path sample")
    for setting in rates["settings"]:
        ptracer = setting.get("ptracer_light_paths_per_second")
        print(f"{setting['name']}" + (f": Mitsuba 3's particle tracer, {ptracer / 1e6:.2f} M light paths a second"
                                      if ptracer else ""))
        for method, own in setting["methods"].items():
            alone = own["light_paths_per_second_of_their_stages"]
            print(f"  {method}: {own['light_paths_per_second'] / 1e6:.2f} M light paths a second"
                  + (f", {alone / 1e6:.2f} M by their stages alone" if alone else "")
                  + f"; {own['photons_a_pass']:.3g} photons and {own['seconds_a_pass']:.3f} s a pass"
                  + (f"; {own['over_ptracer']:.2f} times ptracer's rate" if "over_ptracer" in own else "")
                  + (f"; {own['over_survey']:.1f} times the survey's passes" if "over_survey" in own else ""))


# Light paths a pass, and the edge of the image in pixels: two decades of each. The other is held at the number named.
SCALING_PATHS, PATHS_HELD = [20_000, 60_000, 200_000, 600_000, 2_000_000], 1_000_000
SCALING_EDGES, EDGE_HELD = [64, 112, 208, 368, 640], 256
SCALING_PASSES = 2


def line_fit(points):
    """Seconds = start + slope * number, by least squares of relative deviations: (start, slope, the largest relative
    deviation)."""
    weights = [1 / seconds**2 for _, seconds in points]
    total = sum(weights)
    mean = [sum(w * point[k] for w, point in zip(weights, points)) / total for k in (0, 1)]
    slope = (sum(w * (x - mean[0]) * (y - mean[1]) for w, (x, y) in zip(weights, points))
             / sum(w * (x - mean[0])**2 for w, (x, _) in zip(weights, points)))
    start = mean[1] - slope * mean[0]
    return start, slope, max(abs(start + slope * x - y) / y for x, y in points)


def measure_scaling(arguments, methods):
    """Seconds a pass against photons, and against gather points, whose radius stays the same share of the scene."""
    found = {"scene": "cornell-box", "passes": SCALING_PASSES, "methods": {}}
    file = renders.ROOT / "scenes" / "cornell-box.xml"

    def seconds(method, edge, paths, image):
        """And what the pass had: photons and gather points."""
        scene = renders.Scene("cornell-box", file, edge, edge)
        turns = [renders.render(arguments.gradus, scene, method, seed, image, samples=SCALING_PASSES, layers=False,
                                options=["--photons", paths, "--radius", "0.6%"])
                 for seed in range(1, arguments.turns + 1)]
        return {"seconds": statistics.median(turn["render_seconds"] / turn["spp"] for turn in turns),
                "photons": turns[0]["photons"] / turns[0]["spp"],
                "gather_points": turns[0]["gathering"]["gather_points"] / turns[0]["spp"]}

    with tempfile.TemporaryDirectory() as folder:
        image = pathlib.Path(folder) / "image.exr"
        for method in [method for method in methods if method in SURVEY_SECONDS]:
            own = {"photons": [seconds(method, EDGE_HELD, paths, image) for paths in SCALING_PATHS],
                   "gather_points": [seconds(method, edge, PATHS_HELD, image) for edge in SCALING_EDGES]}
            for name in ("photons", "gather_points"):
                start, slope, worst = line_fit([(point[name], point["seconds"]) for point in own[name]])
                own[f"{name}_fit"] = {"start": start, "slope": slope, "largest_deviation": worst}
                print(f"{method}: a pass takes {start * 1e3:.1f} ms + {slope * 1e9:.1f} ns a {name[:-1].replace('_', ' ')}"
                      f", within {worst:.0%} from {own[name][0][name]:.3g} to {own[name][-1][name]:.3g}", flush=True)
            found["methods"][method] = own
    return found


def draw_pictures(arguments, pyplot, scene, methods):
    """Each method's image over the map of its error. Returns what the page says of them."""
    seconds = max(arguments.seconds)
    figures = {}
    height = scene.height / scene.width
    with tempfile.TemporaryDirectory() as folder:
        figure, grid = pyplot.subplots(2, len(methods), squeeze=False,
                                       figsize=(3.2 * len(methods), 2 * 3.2 * height + 0.9))
        for (above, below), method in zip(grid.T, methods):
            image = pathlib.Path(folder) / f"{method}.exr"
            record = renders.render(arguments.gradus, scene, method, 1, image, seconds=seconds, png=True)
            error = image.with_suffix(".error.png")
            found = renders.compare(arguments.gradus, image, scene.reference, "--error-image", error)
            figures[method] = {"relmse": found["relative_mse"], "spp": record["spp"],
                               "seconds": record["render_seconds"],
                               "reference_error": found["reference_relative_mse"]}
            above.imshow(pyplot.imread(image.with_suffix(".png")), interpolation="nearest")
            above.set_title(f"{method}, {record['render_seconds']:.1f} s", fontsize=9)
            below.imshow(pyplot.imread(error), interpolation="nearest")
            below.set_title(f"relMSE {found['relative_mse']:.2g}", fontsize=9)
            above.set_axis_off()
            below.set_axis_off()
        figure.suptitle(f"{scene.name}; the reference's own relMSE is {found['reference_relative_mse']:.1g}",
                        fontsize=9)
        figure.tight_layout(pad=0.4)
        arguments.picture.parent.mkdir(parents=True, exist_ok=True)
        figure.savefig(arguments.picture, dpi=110)
    caption = (f"{scene.name}, {seconds:g} s of rendering for each: "
               + ", ".join(f"{method} relMSE {own['relmse']:.2g}" for method, own in figures.items())
               + ". Below: errors, red too bright, blue too dark, full colour at 100 %.")
    return {"scene": scene.name, "caption": caption, "methods": figures}


def main():
    parser = argparse.ArgumentParser(description="photon methods: error against time, rates, pictures at equal time")
    parser.add_argument("scenes", nargs="*", metavar="SCENE",
                        help=f"names in tests/references ({' '.join(renders.PHOTON_SCENES)})")
    parser.add_argument("--quick", action="store_true", help="one scene, short times, one seed, unless given")
    parser.add_argument("--method", nargs="+", default=METHODS, help=f"as gradus render takes it ({' '.join(METHODS)})")
    parser.add_argument("--parts", nargs="+", choices=PARTS, default=PARTS)
    parser.add_argument("--seconds", type=float, nargs="+", help="times of rendering (2 8 32; quick: 2 8)")
    parser.add_argument("--seeds", type=renders.at_least(1), help="seeds of each (3; quick: 1)")
    parser.add_argument("--passes", type=renders.at_least(1), default=8,
                        help="passes of a render whose rate is taken (8)")
    parser.add_argument("--turns", type=renders.at_least(1), default=5,
                        help="renders of which a rate is the median (5)")
    parser.add_argument("--gradus", type=pathlib.Path, default=renders.ROOT / "build" / "gradus")
    parser.add_argument("--json", type=pathlib.Path, default=renders.ROOT / "build" / "bench" / "photons.json")
    arguments = parser.parse_args()
    arguments.seconds = arguments.seconds or ([2, 8] if arguments.quick else [2, 8, 32])
    arguments.seeds = arguments.seeds or (1 if arguments.quick else 3)
    arguments.picture = arguments.json.with_name("photon-pictures.png")
    if not arguments.gradus.exists():
        sys.exit(f"{arguments.gradus}: no such program; build it, or name it with --gradus")
    names = arguments.scenes or ([PICTURE_SCENE] if arguments.quick else renders.PHOTON_SCENES)
    scenes = renders.scenes_with_reference(names)
    # Before anything is measured: this may start the program again with another Python.
    pyplot = plotting.pyplot() if "pictures" in arguments.parts else None

    known = renders.known_methods(arguments.gradus)
    methods = [method for method in arguments.method if method in known]
    notes = [f"{method}: skipped, the program has no such method" for method in arguments.method if method not in known]
    python = find_python(["mitsuba"], mitsuba_setup.PYTHON_VARIABLE) if "rates" in arguments.parts else None
    if "rates" in arguments.parts and not python:
        notes.append("Mitsuba's rates: skipped, Mitsuba 3 is missing (see bench/peers/README.md)")
    for note in notes:
        print(note, flush=True)
    if not methods:
        sys.exit("none of these methods")

    results = {"machine": renders.machine(), "command": ["bench/render/photons.py", *sys.argv[1:]],
               "seeds": arguments.seeds, "notes": notes, "scenes": [], "points": []}
    arguments.json.parent.mkdir(parents=True, exist_ok=True)

    def write():
        results["machine"]["load_after"] = os.getloadavg()[0]
        arguments.json.write_text(json.dumps(results, indent=1) + "\n")

    for scene in scenes if "curves" in arguments.parts else []:
        points, measured_notes = measure_curves(arguments, scene, methods)
        results["points"] += points
        results["notes"] += measured_notes
        own_error = results["points"][-1]["reference_error"]
        results["scenes"].append({"name": scene.name, "width": scene.width, "height": scene.height,
                                  "reference": scene.reference.renderer, "reference_spp": scene.reference.spp,
                                  "reference_error": own_error})
        write()
        print(f"{scene.name}: the reference's own relMSE {own_error:.2g}", flush=True)
    if results["points"]:
        convergence.print_summary(curves.summaries(results["points"]))
    if "rates" in arguments.parts:
        results["rates"] = measure_rates(arguments, methods, python)
        print_rates(results["rates"])
        write()
    if "scaling" in arguments.parts:
        results["scaling"] = measure_scaling(arguments, methods)
        write()
    if pyplot:
        scene = next((scene for scene in scenes if scene.name == PICTURE_SCENE), scenes[0])
        results["pictures"] = draw_pictures(arguments, pyplot, scene, methods)
        print(results["pictures"]["caption"])
    write()
    print(f"\nJSON in {arguments.json}")


if __name__ == "__main__":
    main()
