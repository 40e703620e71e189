#!/usr/bin/env python3
"""Gradus against Mitsuba 3 on the same scene, size, samples and depth: the ratio of their samples per second.

    python3 bench/peers/compare.py [SCENE.xml:WxH ...] [--python PYTHON-WITH-MITSUBA] [--gradus build/gradus]

The two renderers take turns (A B A B), so that a machine that slows down slows both; each pair gives a ratio and the
median counts. Russian roulette is off in both. Loading and compiling are left out in both: Mitsuba renders once before
it is measured, and gradus once before the first pair, into its kernel cache. Where Mitsuba is missing this says how to
get it, prints "skipped" and exits with 0; a renderer that fails makes it exit with 1.
"""

import argparse
import json
import pathlib
import statistics
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent / "render")]
import mitsuba_setup  # noqa: E402
import renders  # noqa: E402
from pythons import find_python  # noqa: E402


def parse_job(text):
    path, separator, size = text.rpartition(":")
    if not separator:
        return pathlib.Path(text), (512, 512)
    width, height = (int(part) for part in size.lower().split("x"))
    return pathlib.Path(path), (width, height)


def gradus_rate(arguments, scene, size, spp, folder):
    """Samples per second of one render by gradus, from the statistics that it writes."""
    image, file = pathlib.Path(folder) / "image.exr", pathlib.Path(folder) / "statistics.json"
    command = [arguments.gradus, "render", scene, "--method", "pt", "-o", image, "--stats", file, "--quiet"]
    command += ["--size", f"{size[0]}x{size[1]}", "--spp", spp, "--max-depth", arguments.max_depth]
    command += ["--rr-depth", renders.NO_ROULETTE, "--nthreads", arguments.nthreads]
    renders.run(*command, *(["--device", arguments.device] if arguments.device else []))
    record = json.loads(file.read_text())
    if record["spp"] != spp:
        sys.exit(f"{scene}: gradus took {record['spp']} samples a pixel, not {spp}")
    # Those of the image: `samples` counts what a pixel filter takes around it, too, and Mitsuba's count does not.
    return size[0] * size[1] * spp / record["render_seconds"]


def mitsuba_record(arguments, python, scene, size):
    command = [python, HERE / "mitsuba_rate.py", scene, "--size", f"{size[0]}x{size[1]}", "--spp", arguments.spp]
    command += ["--max-depth", arguments.max_depth, "--repeats", 1, "--nthreads", arguments.nthreads]
    # Mitsuba may print warnings before the JSON, which is its last line.
    return json.loads(renders.run(*command).strip().splitlines()[-1])


def compare(arguments, python, scene, size, folder):
    gradus_rate(arguments, scene, size, 1, folder)  # fills the kernel cache
    pairs = []
    for number in range(arguments.pairs):
        ours = gradus_rate(arguments, scene, size, arguments.spp, folder)
        record = mitsuba_record(arguments, python, scene, size)
        theirs = record["samples_per_second"]["median"]
        pairs.append({"gradus": ours, "mitsuba": theirs, "ratio": ours / theirs})
        if not arguments.json:
            rates = f"gradus {ours / 1e6:.2f} M samples/s, mitsuba {theirs / 1e6:.2f} M samples/s"
            print(f"  pair {number + 1}: {rates}, ratio {ours / theirs:.2f}", flush=True)
    return {
        "scene": str(scene),
        "width": size[0],
        "height": size[1],
        "spp": arguments.spp,
        "max_depth": arguments.max_depth,
        "pairs": pairs,
        "median_ratio": statistics.median(pair["ratio"] for pair in pairs),
        "mitsuba_version": record["version"],
        "mitsuba_threads": record["threads"],
    }


def main():
    parser = argparse.ArgumentParser(description="gradus against Mitsuba 3: ratio of samples per second")
    parser.add_argument("jobs", nargs="*", type=parse_job, metavar="SCENE.xml:WxH", help="default: two known scenes")
    parser.add_argument("--gradus", type=pathlib.Path, default=renders.ROOT / "build" / "gradus")
    parser.add_argument("--python", help="a Python that has Mitsuba (default: GRADUS_MITSUBA_PYTHON, then this one)")
    parser.add_argument("--spp", type=renders.at_least(1), default=64)
    parser.add_argument("--max-depth", type=int, default=13)
    parser.add_argument("--pairs", type=renders.at_least(1), default=5)
    parser.add_argument("--nthreads", type=int, default=0, help="processor threads of both; 0: all")
    parser.add_argument("--device", help="OpenCL device of gradus")
    parser.add_argument("--json", action="store_true", help="print JSON only")
    arguments = parser.parse_args()

    python = find_python(["mitsuba"], mitsuba_setup.PYTHON_VARIABLE, arguments.python)
    if python is None:
        print(mitsuba_setup.HOW_TO_GET, file=sys.stderr)
        print(json.dumps({"skipped": "Mitsuba 3 is missing"}) if arguments.json else "skipped: Mitsuba 3 is missing")
        return
    if not arguments.gradus.exists():
        sys.exit(f"{arguments.gradus}: no such program; build it, or name it with --gradus")

    results = []
    with tempfile.TemporaryDirectory() as folder:
        for scene, size in arguments.jobs or map(parse_job, renders.default_jobs()):
            if not arguments.json:
                depth = f"max depth {arguments.max_depth}, no Russian roulette"
                print(f"{scene} at {size[0]}x{size[1]}, {arguments.spp} spp, {depth}", flush=True)
            results.append(compare(arguments, python, scene, size, folder))
            if not arguments.json:
                print(f"  median ratio gradus / mitsuba: {results[-1]['median_ratio']:.2f}", flush=True)
    if arguments.json:
        print(json.dumps(results, indent=2))


if __name__ == "__main__":
    main()
