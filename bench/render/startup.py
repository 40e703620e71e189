#!/usr/bin/env python3
"""From the command line to the first image, of one sample a pixel: with an empty cache and with kernels in it.

    python3 bench/render/startup.py [SCENE.xml:WxH ...] [--method pt gpt] [--gradus build/gradus]

Without scenes: the Cornell box, scenes/materials.xml, and balls of twelve kinds of surfaces under the same kinds of
lights, a scene that is made here. Seconds are those of the whole process, the median of --repeats with kernels in the
cache (target: half a second) and of --cold with an empty one; compiling is summed over the processes that compile.
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

KINDS = ["diffuse", "conductor", "dielectric", "roughconductor:ggx", "roughconductor:beckmann", "roughdielectric:ggx",
         "plastic", "roughplastic", "principled", "phong", "ward", "roughdiffuse"]


def scene_of_kinds():
    """The text of a scene with a ball of each of the KINDS on a floor, and lights of the kinds of materials.xml."""
    balls = ""
    for i, kind in enumerate(KINDS):
        plugin, _, distribution = kind.partition(":")
        inside = f'<string name="distribution" value="{distribution}"/>' if distribution else ""
        balls += (f'<shape type="sphere"><point name="center" x="{1.2 * (i % 4) - 1.8}" y="0.5" '
                  f'z="{1.2 * (i // 4) - 1.2}"/><float name="radius" value="0.5"/>'
                  f'<bsdf type="{plugin}">{inside}</bsdf></shape>\n')
    return f"""<scene version="3.0.0">
<integrator type="path"><integer name="max_depth" value="12"/></integrator>
<sensor type="perspective">
    <float name="fov" value="40"/>
    <transform name="to_world"><lookat origin="0, 4, 8" target="0, 0.4, 0" up="0, 1, 0"/></transform>
</sensor>
{balls}
<shape type="rectangle">
    <transform name="to_world"><scale value="5"/><rotate x="1" angle="-90"/></transform>
    <bsdf type="diffuse"/>
</shape>
<shape type="rectangle">
    <transform name="to_world"><rotate x="1" angle="90"/><translate y="5"/></transform>
    <emitter type="area"><rgb name="radiance" value="10"/></emitter>
</shape>
<shape type="sphere">
    <point name="center" x="3" y="3" z="0"/><float name="radius" value="0.2"/>
    <emitter type="area"><rgb name="radiance" value="30"/></emitter>
</shape>
<emitter type="point"><point name="position" x="-3" y="3" z="2"/><rgb name="intensity" value="5"/></emitter>
<emitter type="directional">
    <vector name="direction" x="0.2" y="-1" z="-0.3"/><rgb name="irradiance" value="0.5"/>
</emitter>
<emitter type="constant"><rgb name="radiance" value="0.3"/></emitter>
</scene>
"""


def render(arguments, scene, method, folder, cache):
    """Wall seconds and the statistics of one process."""
    image, record = pathlib.Path(folder) / "image.exr", pathlib.Path(folder) / "statistics.json"
    command = [arguments.gradus, "render", scene.file, "--method", method, "-o", image, "--stats", record, "--quiet"]
    command += ["--size", f"{scene.width}x{scene.height}", "--spp", 1]
    command += ["--device", arguments.device] if arguments.device else []
    # Without a folder of PoCL's, as users start it: each process then has one of its own.
    environment = {name: value for name, value in os.environ.items() if name != "POCL_CACHE_DIR"}
    environment["GRADUS_CACHE_DIR"] = str(cache)
    started = time.perf_counter()
    renders.run(*command, environment=environment)
    return time.perf_counter() - started, json.loads(record.read_text())


def measure(arguments, scene, method):
    cold = []
    with tempfile.TemporaryDirectory() as folder:
        for turn in range(arguments.cold):
            cache = pathlib.Path(folder) / f"cache-{turn}"
            cache.mkdir()
            seconds, record = render(arguments, scene, method, folder, cache)
            cold.append(seconds)
        warm = [render(arguments, scene, method, folder, cache)[0] for _ in range(arguments.repeats)]
    return {"scene": scene.name, "method": method, "cold_seconds": statistics.median(cold), "cold_turns": cold,
            "warm_seconds": statistics.median(warm), "warm_turns": warm,
            "cold_compile_seconds": record["compile_seconds"]["total"],
            "kernels": record["compile_seconds"]["kernels"]}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenes", nargs="*", metavar="SCENE.xml:WxH")
    parser.add_argument("--method", nargs="+", default=["pt", "gpt"])
    parser.add_argument("--gradus", type=pathlib.Path, default=renders.ROOT / "build" / "gradus")
    parser.add_argument("--device", help="OpenCL device of gradus")
    parser.add_argument("--repeats", type=renders.at_least(1), default=5, help="starts with kernels in the cache")
    parser.add_argument("--cold", type=renders.at_least(1), default=1, metavar="N", help="starts with an empty one")
    parser.add_argument("--json", type=pathlib.Path, help="also write all figures to this file")
    arguments = parser.parse_args()
    results = []
    with tempfile.TemporaryDirectory() as folder:
        kinds = pathlib.Path(folder) / "twelve-kinds.xml"
        kinds.write_text(scene_of_kinds())
        scenes = renders.ROOT / "scenes"
        jobs = arguments.scenes or [f"{scenes}/cornell-box.xml:128x128", f"{scenes}/materials.xml:64x64",
                                    f"{kinds}:64x64"]
        print(f"{'scene':<24} {'method':<6} {'empty cache':>11} {'compiling':>10} {'kernels':>8} {'slowest':>8} "
              f"{'warm':>6}")
        for scene in map(renders.find_scene, jobs):
            for method in arguments.method:
                record = measure(arguments, scene, method)
                results.append(record)
                print(f"{record['scene']:<24} {method:<6} {record['cold_seconds']:>9.2f} s "
                      f"{record['cold_compile_seconds']:>8.2f} s {len(record['kernels']):>8} "
                      f"{max(record['kernels'].values()):>6.2f} s {record['warm_seconds']:>4.2f} s", flush=True)
    if arguments.json:
        arguments.json.write_text(json.dumps(results, indent=2) + "\n")


if __name__ == "__main__":
    main()
