#!/usr/bin/env python3
"""Where the time goes: seconds by stage for each scene and method, and what Embree alone would take.

    python3 bench/render/profile.py [SCENE ...] [--method pt gpt] [--spp 64]

The floor is the number of rays of the render times the seconds of a ray when Embree alone traces the rays of a path
tracing of that scene again (gradus-bench-render --parts floor); rays of other kinds, such as gradients take, count as
if they were those. Those through the edges of lights do not count: they are traced in a stage of their own. Draw it with
bench/report --draw-only.
"""

import argparse
import json
import os
import pathlib
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
import renders  # noqa: E402

SCENES = ["cornell-box", "door-ajar", "materials", "plates", "torus-rough-glass"]


def rays_per_second(arguments, scene, folder):
    """Of Embree alone; None for a scene file that takes parameters, which the replay cannot be given."""
    if scene.parameters:
        return None
    record = pathlib.Path(folder) / "floor.json"
    renders.run(arguments.bench, f"{scene.file}:{scene.width}x{scene.height}", "--parts", "floor", "--spp",
                arguments.spp, "--repeats", arguments.repeats, "--json", record)
    as_the_file_says = json.loads(record.read_text())["floor"][0]
    return as_the_file_says["replay_mrays_per_second"]["median"] * 1e6


def traced_rays(record):
    """Those of the stage `trace`; edges of lights have another."""
    return sum(kind["count"] for name, kind in record["rays"].items() if name != "edge")


def main():
    parser = argparse.ArgumentParser(description="seconds by stage")
    parser.add_argument("scenes", nargs="*", metavar="SCENE", default=SCENES,
                        help=f"of {', '.join(renders.scene_names())}, or SCENE.xml:WxH")
    parser.add_argument("--method", nargs="+", default=["pt", "gpt"], help="as gradus render takes it (pt gpt)")
    parser.add_argument("--gradus", type=pathlib.Path, default=renders.ROOT / "build" / "gradus")
    parser.add_argument("--bench", type=pathlib.Path, default=renders.ROOT / "build" / "gradus-bench-render")
    parser.add_argument("--spp", type=renders.at_least(1), default=64)
    parser.add_argument("--repeats", type=renders.at_least(1), default=5)
    parser.add_argument("--json", type=pathlib.Path, default=renders.ROOT / "build" / "bench" / "profile.json")
    arguments = parser.parse_args()
    results = {"machine": renders.machine(), "command": ["bench/render/profile.py", *sys.argv[1:]], "profiles": []}
    for scene in map(renders.find_scene, arguments.scenes):
        with tempfile.TemporaryDirectory() as folder:
            image = pathlib.Path(folder) / "image.exr"
            rate = rays_per_second(arguments, scene, folder)
            for method in arguments.method:
                renders.render(arguments.gradus, scene, method, 0, image, samples=1)  # fills the kernel cache
                turns = [renders.render(arguments.gradus, scene, method, seed, image, samples=arguments.spp)
                         for seed in range(1, arguments.repeats + 1)]
                turns.sort(key=lambda record: record["render_seconds"])
                record = turns[len(turns) // 2]
                rays = traced_rays(record)
                profile = {"scene": scene.name, "method": method, "spp": record["spp"],
                           "render_seconds": record["render_seconds"],
                           "reconstruction_seconds": renders.reconstruction_seconds(arguments.gradus, image),
                           "embree_seconds": rays / rate if rate else None, "rays": rays, "stages": record["stages"]}
                results["profiles"].append(profile)
                results["machine"]["device"] = record["device"]
                floor = f", Embree alone {100 * rays / rate / record['render_seconds']:.0f} %" if rate else ""
                largest = sorted(record["stages"], key=lambda stage: -stage["seconds"])[:4]
                print(f"{scene.name:<20} {method:<6} " + ", ".join(
                    f"{stage['name']} {100 * stage['share']:.0f} %" for stage in largest) + floor, flush=True)
    results["machine"]["load_after"] = os.getloadavg()[0]
    arguments.json.parent.mkdir(parents=True, exist_ok=True)
    arguments.json.write_text(json.dumps(results, indent=1) + "\n")


if __name__ == "__main__":
    main()
