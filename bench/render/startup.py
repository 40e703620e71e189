#!/usr/bin/env python3
"""From the command line to the first image: our Cornell box at 128x128 with one sample a pixel.

    python3 bench/render/startup.py [--gradus build/gradus]

Warm: the process's wall time with kernels in the cache, median of five (target: under a second). Cold: an empty cache;
what compiling took in all, and each kernel that took more than two seconds.
"""

import argparse
import json
import os
import pathlib
import statistics
import sys
import tempfile
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
import renders  # noqa: E402

SLOW = 2.0  # seconds


def render(arguments, scene, folder, cache):
    """Wall seconds and the statistics of one process."""
    image, record = pathlib.Path(folder) / "image.exr", pathlib.Path(folder) / "statistics.json"
    command = [arguments.gradus, "render", scene, "--method", "pt", "-o", image, "--stats", record, "--quiet"]
    command += ["--size", "128x128", "--spp", 1, *(["--device", arguments.device] if arguments.device else [])]
    # Without a folder of PoCL's, as users start it: each process then has one of its own.
    environment = {name: value for name, value in os.environ.items() if name != "POCL_CACHE_DIR"}
    environment["GRADUS_CACHE_DIR"] = cache
    started = time.perf_counter()
    renders.run(*command, environment=environment)
    return time.perf_counter() - started, json.loads(record.read_text())


def measure(arguments, scene):
    with tempfile.TemporaryDirectory() as folder:
        cache = str(pathlib.Path(folder) / "cache")
        pathlib.Path(cache).mkdir()
        cold, record = render(arguments, scene, folder, cache)
        warm = [render(arguments, scene, folder, cache)[0] for _ in range(arguments.repeats)]
    # Kernels are compiled while they are built and at their first launch: the preparation holds both.
    kernels = record["compile_seconds"]["kernels"]
    slow = {name: seconds for name, seconds in kernels.items() if seconds > SLOW}
    return {"scene": str(scene), "warm_seconds": statistics.median(warm), "warm_turns": warm, "cold_seconds": cold,
            "cold_prepare_seconds": record["prepare_seconds"],
            "cold_compile_seconds": record["compile_seconds"]["total"], "kernels": kernels, "slow_kernels": slow}


def main():
    parser = argparse.ArgumentParser(description="time to the first image, warm and cold")
    parser.add_argument("scenes", nargs="*", type=pathlib.Path, default=[renders.ROOT / "scenes" / "cornell-box.xml"])
    parser.add_argument("--gradus", type=pathlib.Path, default=renders.ROOT / "build" / "gradus")
    parser.add_argument("--device", help="OpenCL device of gradus")
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--json", type=pathlib.Path, help="also write all figures to this file")
    arguments = parser.parse_args()
    results = []
    for scene in arguments.scenes:
        record = measure(arguments, scene)
        results.append(record)
        print(f"{scene.name} 128x128 1 spp\n  warm cache: {record['warm_seconds']:.2f} s (target under 1 s)\n"
              f"  empty cache: {record['cold_seconds']:.2f} s, of these compiling "
              f"{record['cold_compile_seconds']:.2f} s ({len(record['kernels'])} kernels, summed over threads), "
              f"prepared after {record['cold_prepare_seconds']:.2f} s")
        slowest = max(record["kernels"].items(), key=lambda item: item[1])
        print(f"  slowest kernel: {slowest[0]}, {slowest[1]:.2f} s")
        for name, seconds in record["slow_kernels"].items():
            print(f"  over {SLOW:.0f} s: {name}, {seconds:.2f} s")
        if not record["slow_kernels"]:
            print(f"  no kernel takes more than {SLOW:.0f} s", flush=True)
    if arguments.json:
        arguments.json.write_text(json.dumps(results, indent=2) + "\n")


if __name__ == "__main__":
    main()
