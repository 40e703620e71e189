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
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
sys.path.insert(0, str(ROOT / "bench" / "render"))
import second_device  # noqa: E402

DEVICES = {"PoCL": "portable computing", "Intel": second_device.SELECTOR}
TURNS = 3


def measure(arguments, environment, device, folder):
    file = pathlib.Path(folder) / "kernels.json"
    command = [arguments.bench, "--parts", "throughput", "--queue-bits", "10,14" if arguments.quick else "10,14,18",
               "--device", device, "--repeats", arguments.repeats, "--no-vectoriser", "--json", file]
    command += ["--quick"] if arguments.quick else []
    result = subprocess.run([str(part) for part in command], capture_output=True, text=True, env=environment)
    if result.returncode != 0:
        sys.exit(f"failed with exit code {result.returncode}: {' '.join(map(str, command))}\n{result.stderr}")
    return {(row["kernel"], row["queue"]): row for row in json.loads(file.read_text())["throughput"]}


def main():
    parser = argparse.ArgumentParser(description="each kernel on two OpenCL implementations")
    parser.add_argument("--bench", type=pathlib.Path, default=ROOT / "build" / "gradus-bench-kernels")
    parser.add_argument("--repeats", type=int, default=5, help="runs of each build in a turn")
    parser.add_argument("--quick", action="store_true", help="two kinds, no large queue, one turn")
    parser.add_argument("--json", type=pathlib.Path, help="also write all figures to this file")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        environment = second_device.environment(folder)
        if environment is None:
            print(second_device.HOW_TO_GET, file=sys.stderr)
            print("skipped: no second OpenCL implementation")
            return
        turns = [{name: measure(arguments, environment, selector, folder) for name, selector in DEVICES.items()}
                 for _ in range(1 if arguments.quick else TURNS)]
    results = []
    print(f"{'kernel':<34} {'queue':>8} {'PoCL M items/s':>15} {'Intel':>10} {'Intel / PoCL':>13}")
    for key in turns[0]["PoCL"]:
        if key not in turns[0]["Intel"]:
            continue
        rates = {name: [turn[name][key]["items_per_second"]["float"] for turn in turns] for name in DEVICES}
        ratios = [intel / pocl for pocl, intel in zip(*rates.values())]
        print(f"{key[0]:<34} {key[1]:>8} {statistics.median(rates['PoCL']) / 1e6:>15.2f} "
              f"{statistics.median(rates['Intel']) / 1e6:>10.2f} {statistics.median(ratios):>13.2f}", flush=True)
        results.append({"kernel": key[0], "queue": key[1], "items_per_second": rates, "ratio": {
            "median": statistics.median(ratios), "least": min(ratios), "largest": max(ratios)}})
    if arguments.json:
        arguments.json.write_text(json.dumps(results, indent=2) + "\n")


if __name__ == "__main__":
    main()
