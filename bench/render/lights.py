#!/usr/bin/env python3
"""What a light tree gains over a choice of lights by power: relMSE at equal time.

    python3 bench/render/lights.py [FILE.xml ...] [--lamps 2 8 32 128] [--methods pt gpt] [--spp 16] [--seeds 5]

Files, and courts of so many small lamps that are written here: which number of lights a tree pays from. The reference is
a long render of `pt` with another seed. For each method: seconds and relMSE of the tree over those of the choice by
power, medians over the seeds, and the inverse of their product, the gain.
"""

import argparse
import json
import math
import pathlib
import re
import statistics
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
import renders  # noqa: E402


def court(lamps):
    """A floor, two walls and two blocks under so many square lamps of 10 cm, spread by the golden ratio."""
    shapes = []
    for i in range(lamps):
        x, z = 8 * (2 * ((i * 0.618034 + 0.3) % 1) - 1), 8 * (2 * (i + 0.5) / lamps - 1)
        y, glow = 2.5 + 0.5 * math.sin(5 * i), 4000 / lamps * (1 + (i * 7) % 5)
        shapes.append(f'''<shape type="rectangle"><transform name="to_world"><scale value="0.05"/><rotate x="1" angle="90"/>
            <translate x="{x:.4f}" y="{y:.4f}" z="{z:.4f}"/></transform>
            <emitter type="area"><rgb name="radiance" value="{glow:.4f}, {0.7 * glow:.4f}, {0.4 * glow:.4f}"/></emitter></shape>''')
    for x, z, turn in ((-3, -3, 20), (2, 1, 50)):
        shapes.append(f'''<shape type="cube"><transform name="to_world"><scale y="0.7"/><rotate y="1" angle="{turn}"/>
            <translate x="{x}" y="0.7" z="{z}"/></transform></shape>''')
    for turn in ('<rotate x="1" angle="-90"/><scale value="10"/>', '<translate z="-10"/><scale x="10" y="5"/>',
                 '<translate z="-10"/><scale x="10" y="5"/><rotate y="1" angle="90"/>'):
        shapes.append(f'<shape type="rectangle"><transform name="to_world">{turn}</transform></shape>')
    return f'''<scene version="3.0.0"><default name="spp" value="16"/>
        <integrator type="path"><integer name="max_depth" value="6"/></integrator>
        <sensor type="perspective"><float name="fov" value="60"/><transform name="to_world">
        <lookat origin="7.5, 2, 8.5" target="-2, 0.8, -3" up="0, 1, 0"/></transform>
        <sampler type="independent"><integer name="sample_count" value="$spp"/></sampler>
        <film type="hdrfilm"><integer name="width" value="320"/><integer name="height" value="180"/>
        <rfilter type="box"/></film></sensor>{"".join(shapes)}</scene>'''


def render(arguments, scene, method, lights, spp, seed, image):
    stats = image.with_suffix(".json")
    subprocess.run([arguments.gradus, "render", scene, "--method", method, "--lights", lights, "--spp", str(spp),
                    "--seed", str(seed), "-o", image, "--stats", stats], check=True, capture_output=True)
    return json.loads(stats.read_text())["render_seconds"]


def relative_mse(arguments, image, reference):
    text = subprocess.run([arguments.gradus, "compare", image, reference], check=True, capture_output=True,
                          text=True).stdout
    return float(re.search(r"relMSE (\S+)", text).group(1))


def measure(arguments, scene, name, folder):
    reference = folder / "reference.exr"
    render(arguments, scene, "pt", "tree", arguments.reference_spp, 1000, reference)
    for method in arguments.methods:
        found = {lights: [] for lights in ("power", "tree")}
        for seed in range(1, arguments.seeds + 1):
            for lights, runs in found.items():
                image = folder / "image.exr"
                seconds = render(arguments, scene, method, lights, arguments.spp, seed, image)
                runs.append((seconds, relative_mse(arguments, image, reference)))
        power, tree = ([statistics.median(run[i] for run in found[lights]) for i in range(2)] for lights in found)
        seconds, error = tree[0] / power[0], tree[1] / power[1]
        print(f"{name:24} {method:4} seconds x {seconds:5.2f}  relMSE {power[1]:.5f} x {error:5.3f}  "
              f"gain {1 / (seconds * error):5.2f}", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("files", nargs="*", type=pathlib.Path)
    parser.add_argument("--lamps", nargs="*", type=int, default=[])
    parser.add_argument("--methods", nargs="+", default=["pt", "gpt"])
    parser.add_argument("--spp", type=renders.at_least(1), default=16)
    parser.add_argument("--reference-spp", type=renders.at_least(1), default=1024)
    parser.add_argument("--seeds", type=renders.at_least(1), default=5)
    parser.add_argument("--gradus", default=renders.ROOT / "build" / "gradus")
    arguments = parser.parse_args()
    if not arguments.files and not arguments.lamps:
        parser.error("nothing to measure: give files or --lamps")
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        for file in arguments.files:
            measure(arguments, file, file.stem, folder)
        for lamps in arguments.lamps:
            scene = folder / "court.xml"
            scene.write_text(court(lamps))
            measure(arguments, scene, f"court of {lamps} lamps", folder)


if __name__ == "__main__":
    main()
