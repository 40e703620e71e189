#!/usr/bin/env python3
"""Each kernel on two OpenCL implementations: items per second of its float build on the second over the first.

    GRADUS_SECOND_ICD=... python3 bench/kernels/devices.py [--quick]

The devices take turns, a process each. Prints `skipped` and exits with 0 where there is no second implementation; how
to get one is in bench/render/second_device.py.
"""

import argparse
import json
import pathlib
import statistics
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "render"))
import curves  # noqa: E402
import renders  # noqa: E402
import two_devices  # noqa: E402

TURNS = 3


def measure(arguments, environment, device, folder):
    """{(kernel, queue, file): what was measured}."""
    record = pathlib.Path(folder) / "kernels.json"
    command = [arguments.bench, "--parts", "throughput", "--queue-bits", "10,14" if arguments.quick else "10,14,18",
               "--device", device, "--repeats", arguments.repeats, "--no-vectoriser", "--json", record]
    renders.run(*command, *(["--quick"] if arguments.quick else []), environment=environment)
    return {(row["kernel"], row["queue"], row["file"]): row for row in json.loads(record.read_text())["throughput"]}


def main():
    parser = argparse.ArgumentParser(description="each kernel on two OpenCL implementations")
    parser.add_argument("--bench", type=pathlib.Path, default=renders.ROOT / "build" / "gradus-bench-kernels")
    parser.add_argument("--gradus", type=pathlib.Path, default=renders.ROOT / "build" / "gradus")
    parser.add_argument("--repeats", type=renders.at_least(1), default=5, help="runs of each build in a turn")
    parser.add_argument("--quick", action="store_true", help="two kinds, no large queue, one turn")
    parser.add_argument("--json", type=pathlib.Path, help="also write all figures to this file")
    arguments = parser.parse_args()
    with two_devices.two_devices(arguments.gradus) as (folder, environment, devices):
        turns = two_devices.take_turns(devices, 1 if arguments.quick else TURNS,
                                       lambda device: measure(arguments, environment, device, folder))
    first, second = devices
    results = []
    print(f"{'kernel':<34} {'queue':>8} {first + ' M items/s':>15} {second[:12]:>12} {'over ' + first:>13}")
    for key in turns[0][first]:
        if key not in turns[0][second]:
            continue
        rates = two_devices.by_device(turns, lambda rows: rows[key]["items_per_second"]["float"])
        ratio = curves.spread(two_devices.ratios(rates))
        print(f"{key[0]:<34} {key[1]:>8} {statistics.median(rates[first]) / 1e6:>15.2f} "
              f"{statistics.median(rates[second]) / 1e6:>12.2f} {ratio['median']:>13.2f}", flush=True)
        results.append({"kernel": key[0], "file": key[2], "queue": key[1], "items_per_second": rates, "ratio": ratio})
    if arguments.json:
        arguments.json.write_text(json.dumps(results, indent=2) + "\n")


if __name__ == "__main__":
    main()
