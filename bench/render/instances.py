#!/usr/bin/env python3
"""Memory and time of scenes with many instances: a million of a small group, a large mesh twice, and a field of trees
small enough to be copies as well.

    python3 bench/render/instances.py [--program build/gradus] [--folder FOLDER] [--scale 1]

Prints for each scene, as instances and as copies where these fit, the largest memory of the process, the seconds that
the samples took, and those of the phases before them. The difference of `quarter`, of 250,000 instances, to `million`
tells what an instance takes.
"""

import argparse
import json
import math
import pathlib
import random
import struct
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent

HEAD = """<scene version="3.0.0">
<integrator type="path"><integer name="max_depth" value="6"/></integrator>
<sensor type="perspective">
  <transform name="to_world"><lookat origin="%s" target="0 0 0" up="0 1 0"/></transform>
  <float name="fov" value="45"/>
  <film type="hdrfilm"><integer name="width" value="320"/><integer name="height" value="180"/></film>
</sensor>
<emitter type="constant"><rgb name="radiance" value="0.8 0.9 1"/></emitter>
<emitter type="directional"><vector name="direction" x="-0.4" y="-1" z="0.3"/><rgb name="irradiance" value="2 2 1.8"/></emitter>
<shape type="rectangle"><transform name="to_world"><scale value="%g"/><rotate x="1" angle="-90"/></transform></shape>
"""


def write_ply(path, positions, triangles):
    with open(path, "wb") as out:
        out.write(
            (
                "ply\nformat binary_little_endian 1.0\nelement vertex %d\nproperty float x\nproperty float y\n"
                "property float z\nelement face %d\nproperty list uchar int vertex_indices\nend_header\n"
                % (len(positions), len(triangles))
            ).encode()
        )
        out.write(b"".join(struct.pack("<3f", *p) for p in positions))
        out.write(b"".join(struct.pack("<B3i", 3, *t) for t in triangles))


def write_hills(path, side):
    """2 (side - 1)^2 triangles, row by row, for they are many."""
    with open(path, "wb") as out:
        faces = 2 * (side - 1) ** 2
        out.write(
            (
                "ply\nformat binary_little_endian 1.0\nelement vertex %d\nproperty float x\nproperty float y\n"
                "property float z\nelement face %d\nproperty list uchar int vertex_indices\nend_header\n"
                % (side * side, faces)
            ).encode()
        )
        for row in range(side):
            z = row / (side - 1) - 0.5
            values = []
            for column in range(side):
                x = column / (side - 1) - 0.5
                values += (x, 0.1 + 0.05 * math.sin(40 * x) * math.cos(31 * z) + 0.003 * math.sin(900 * x * z), z)
            out.write(struct.pack("<%df" % len(values), *values))
        for row in range(side - 1):
            parts = []
            for column in range(side - 1):
                a = row * side + column
                parts.append(struct.pack("<B3iB3i", 3, a, a + side, a + 1, 3, a + 1, a + side, a + side + 1))
            out.write(b"".join(parts))


def tree(levels, seed):
    """A trunk of cones with leaves about it: 10 triangles, and 60 a level."""
    chance = random.Random(seed)
    positions, triangles = [], []

    def spike(base, top, width):
        first = len(positions)
        positions.append(top)
        for i in range(5):
            angle = 2 * math.pi * i / 5
            positions.append((base[0] + width * math.cos(angle), base[1], base[2] + width * math.sin(angle)))
        for i in range(5):
            triangles.append((first, first + 1 + (i + 1) % 5, first + 1 + i))

    spike((0, 0, 0), (0, 1, 0), 0.08)
    spike((0, 0.3, 0), (0, 1.1, 0), 0.2)
    for level in range(levels):
        height = 0.25 + 0.8 * level / max(levels, 1)
        for i in range(12):
            angle, reach = chance.uniform(0, 2 * math.pi), (1.1 - height) * chance.uniform(0.2, 0.5)
            at = (reach * math.cos(angle), height + chance.uniform(-0.1, 0.1), reach * math.sin(angle))
            spike(at, (at[0] * 1.3, at[1] + 0.12, at[2] * 1.3), 0.03)
    return positions, triangles


def instances(count, chance):
    """On a square of `side`, each turned, stretched, and every other one mirrored."""
    side = math.sqrt(count)
    for i in range(count):
        angle, size = chance.uniform(0, 2 * math.pi), chance.uniform(0.6, 1.3)
        cosine, sine = size * math.cos(angle), size * math.sin(angle)
        mirror = -1 if i % 2 else 1
        yield (
            '<shape type="instance"><ref id="tree"/><transform name="to_world"><matrix value="'
            "%.5g 0 %.5g %.6g 0 %.5g 0 0 %.5g 0 %.5g %.6g 0 0 0 1"
            '"/></transform></shape>\n'
            % (
                mirror * cosine, sine, chance.uniform(-0.5, 0.5) * side,
                size * chance.uniform(0.8, 1.6),
                -mirror * sine, cosine, chance.uniform(-0.5, 0.5) * side,
            )
        )  # fmt: skip


def write_field(folder, name, count, levels):
    path = folder / f"{name}.xml"
    write_ply(folder / f"{name}.ply", *tree(levels, 1))
    side = math.sqrt(count)
    with open(path, "w") as out:
        out.write(HEAD % ("0 %g %g" % (0.06 * side + 1.5, 0.4 * side + 2), side))
        out.write(
            f'<shape type="shapegroup" id="tree"><shape type="ply"><string name="filename" value="{name}.ply"/>'
            '<boolean name="face_normals" value="true"/><bsdf type="twosided"><bsdf type="diffuse"/></bsdf></shape></shape>\n'
        )
        out.writelines(instances(count, random.Random(2)))
        out.write("</scene>\n")
    return path


def write_twice(folder, name, side):
    path = folder / f"{name}.xml"
    write_hills(folder / f"{name}.ply", side)
    with open(path, "w") as out:
        out.write(HEAD % ("0 0.9 1.6", 3))
        out.write(
            f'<shape type="shapegroup" id="hills"><shape type="ply"><string name="filename" value="{name}.ply"/>'
            '<boolean name="face_normals" value="true"/></shape></shape>\n'
        )
        for x, mirror in ((-0.55, 1), (0.55, -1)):
            out.write(
                f'<shape type="instance"><ref id="hills"/><transform name="to_world"><scale x="{mirror}"/>'
                f'<translate x="{x}"/></transform></shape>\n'
            )
        out.write("</scene>\n")
    return path


def run(program, folder, path, choice, spp):
    """The statistics of a render; None where it fails."""
    statistics = folder / "statistics.json"
    command = [program, "render", path, "-o", folder / "out.exr", "--method", "pt", "--spp", spp, "--quiet"]
    command += ["--instances", choice, "--stats", statistics, "--limits", 10]
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True)
    if done.returncode != 0:
        print(f"{path.stem:9}{choice:>8}  {done.stderr.strip()[:200]}")
        return None
    return json.loads(statistics.read_text())


def measure(arguments, folder):
    scaled = lambda count: max(2, int(count * arguments.scale))  # noqa: E731
    made = {
        "field": lambda: (write_field(folder, "field", scaled(4000), 4), ["copies", "kept"]),
        "quarter": lambda: (write_field(folder, "quarter", scaled(250_000), 0), ["kept"]),
        "million": lambda: (write_field(folder, "million", scaled(1_000_000), 0), ["kept"]),
        "twice": lambda: (write_twice(folder, "twice", scaled(2237)), ["copies", "kept"]),
    }
    phases = ["parse", "build", "meshes", "tables", "tree"]
    print(f"{'scene':9}{'as':>8}{'memory':>11}{'render':>9}" + "".join(f"{phase:>8}" for phase in phases))
    for name in arguments.only:
        path, choices = made[name]()
        for choice in choices:
            statistics = run(arguments.program, folder, path, choice, arguments.spp)
            if statistics is None:
                continue
            memory, spent = statistics["memory"]["peak_host_bytes"], statistics["phase_seconds"]
            line = f"{name:9}{choice:>8}{memory / 2**20:7.0f} MiB{statistics['render_seconds']:9.2f}"
            print(line + "".join(f"{spent.get(phase, 0):8.2f}" for phase in phases), flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default=ROOT / "build" / "gradus")
    parser.add_argument("--folder", type=pathlib.Path, help="where the scenes go and stay")
    parser.add_argument("--scale", type=float, default=1, help="of all counts")
    names = ["field", "quarter", "million", "twice"]
    parser.add_argument("--only", nargs="*", choices=names, default=names)
    parser.add_argument("--spp", type=int, default=16)
    arguments = parser.parse_args()
    if arguments.folder:
        arguments.folder.mkdir(parents=True, exist_ok=True)
        measure(arguments, arguments.folder)
    else:
        with tempfile.TemporaryDirectory(prefix="gradus-instances-") as folder:
            measure(arguments, pathlib.Path(folder))
    return 0


if __name__ == "__main__":
    sys.exit(main())
