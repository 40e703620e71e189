#!/usr/bin/env python3
"""Two OpenCL implementations side by side: samples per second of the same render.

    GRADUS_SECOND_ICD=... python3 bench/render/devices.py SCENE.xml:WxH [...]

The devices take turns. Prints `skipped` and exits with 0 where there is no second implementation; how to get one is in
second_device.py.
"""

import argparse
import json
import pathlib
import statistics
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
import renders  # noqa: E402
import two_devices  # noqa: E402


def render(arguments, environment, scene, device, spp, folder):
    path, _, size = scene.rpartition(":")
    image, record = pathlib.Path(folder) / "image.exr", pathlib.Path(folder) / "statistics.json"
    renders.run(arguments.gradus, "render", path, "--method", "pt", "-o", image, "--stats", record, "--quiet", "--size",
                size, "--spp", spp, "--device", device, "--max-depth", 13, "--rr-depth", renders.NO_ROULETTE,
                environment=environment)
    return json.loads(record.read_text())


def kernel_share(record):
    """Of the render's time, that of all kernels."""
    seconds = sum(stage["seconds"] for stage in record["stages"] if stage["name"] not in ("trace", "launch and wait"))
    return seconds / record["render_seconds"]


def main():
    parser = argparse.ArgumentParser(description="two OpenCL implementations side by side")
    parser.add_argument("scenes", nargs="+", metavar="SCENE.xml:WxH")
    parser.add_argument("--gradus", type=pathlib.Path, default=renders.ROOT / "build" / "gradus")
    parser.add_argument("--spp", type=renders.at_least(1), default=16)
    parser.add_argument("--repeats", type=renders.at_least(1), default=5)
    parser.add_argument("--json", type=pathlib.Path, help="also write all figures to this file")
    arguments = parser.parse_args()
    results = []
    with two_devices.two_devices(arguments.gradus) as (folder, environment, devices):
        for scene in arguments.scenes:
            # The first turn fills the kernel caches.
            two_devices.take_turns(devices, 1,
                                   lambda device: render(arguments, environment, scene, device, 1, folder))
            turns = two_devices.take_turns(devices, arguments.repeats, lambda device: render(
                arguments, environment, scene, device, arguments.spp, folder))
            rates = two_devices.by_device(turns, lambda record: record["samples_per_second"])
            kernels = two_devices.by_device(turns, kernel_share)
            ratio = statistics.median(two_devices.ratios(rates))
            print(f"{scene}\n  " + ", ".join(
                f"{name} {statistics.median(rates[name]) / 1e6:.2f} M samples/s (kernels "
                f"{100 * statistics.median(kernels[name]):.0f} % of the render)" for name in rates)
                + f"; the second over the first {ratio:.2f}", flush=True)
            results.append({"scene": scene, "samples_per_second": rates, "kernel_share": kernels,
                            "median_ratio": ratio})
    if arguments.json:
        arguments.json.write_text(json.dumps(results, indent=2) + "\n")


if __name__ == "__main__":
    main()
