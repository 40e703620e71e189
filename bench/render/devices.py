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
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
import second_device  # noqa: E402

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
DEVICES = {"PoCL": "portable computing", "Intel": second_device.SELECTOR}


def render(arguments, environment, scene, device, spp, folder):
    path, _, size = scene.rpartition(":")
    file = pathlib.Path(folder) / "statistics.json"
    command = [arguments.gradus, "render", path, "--method", "pt", "-o", pathlib.Path(folder) / "image.exr", "--stats", file, "--quiet"]
    command += ["--size", size, "--spp", spp, "--device", device, "--max-depth", 13, "--rr-depth", 1_000_000]
    result = subprocess.run([str(part) for part in command], capture_output=True, text=True, env=environment)
    if result.returncode != 0:
        sys.exit(f"failed with exit code {result.returncode}: {' '.join(map(str, command))}\n{result.stderr}")
    return json.loads(file.read_text())


def kernel_seconds(record):
    return sum(stage["seconds"] for stage in record["stages"] if stage["name"] not in ("trace", "launch and wait"))


def main():
    parser = argparse.ArgumentParser(description="two OpenCL implementations side by side")
    parser.add_argument("scenes", nargs="+", metavar="SCENE.xml:WxH")
    parser.add_argument("--gradus", type=pathlib.Path, default=ROOT / "build" / "gradus")
    parser.add_argument("--spp", type=int, default=16)
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--json", type=pathlib.Path, help="also write all figures to this file")
    arguments = parser.parse_args()
    results = []
    with tempfile.TemporaryDirectory() as folder:
        environment = second_device.environment(folder)
        if environment is None:
            print(second_device.HOW_TO_GET, file=sys.stderr)
            print("skipped: no second OpenCL implementation")
            return
        for scene in arguments.scenes:
            rates, kernels = {name: [] for name in DEVICES}, {name: [] for name in DEVICES}
            for name, selector in DEVICES.items():
                render(arguments, environment, scene, selector, 1, folder)  # fills the kernel cache
            for _ in range(arguments.repeats):
                for name, selector in DEVICES.items():
                    record = render(arguments, environment, scene, selector, arguments.spp, folder)
                    rates[name].append(record["samples_per_second"])
                    kernels[name].append(kernel_seconds(record) / record["render_seconds"])
            pocl, intel = rates.values()
            ratio = statistics.median(b / a for a, b in zip(pocl, intel))
            print(f"{scene}\n  " + ", ".join(
                f"{name} {statistics.median(rates[name]) / 1e6:.2f} M samples/s (kernels "
                f"{100 * statistics.median(kernels[name]):.0f} % of the render)" for name in DEVICES)
                + f"; Intel / PoCL {ratio:.2f}", flush=True)
            results.append({"scene": scene, "samples_per_second": rates, "kernel_share": kernels,
                            "median_ratio": ratio})
    if arguments.json:
        arguments.json.write_text(json.dumps(results, indent=2) + "\n")


if __name__ == "__main__":
    main()
