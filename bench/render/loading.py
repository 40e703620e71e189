#!/usr/bin/env python3
"""What comes before the first sample of scenes that are large: seconds of loading over those of a plain read of the
files and Embree's own build, or over the decoder's.

    python3 bench/render/loading.py [CASE ...] [--bench build/gradus-bench-render] [--triangles 10000000] [--texels 8192]

Cases: ply and serialized, a mesh of so many triangles with normals; small, 700 meshes of 2000 triangles; png, jpg and
exr, a texture of so many texels each way; textures, 24 of a quarter of that, over their decoding one after the other.
Pictures need the Mitsuba of bench/peers/install.py, which writes them; where it is missing they are left out. The
files lie in a temporary folder, which takes up to a gigabyte.
"""

import argparse
import array
import math
import pathlib
import shutil
import struct
import sys
import tempfile
import zlib

HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent / "peers")]
import mitsuba_setup  # noqa: E402
import renders  # noqa: E402
from pythons import find_python  # noqa: E402

SCENE = """<scene version="3.0.0">
<sensor type="perspective"><transform name="to_world"><lookat origin="0, 1, 1.5" target="0, 0, 0" up="0, 1, 0"/></transform></sensor>
<emitter type="constant"/>
%s
</scene>
"""
SMALL_MESHES, TEXTURES = 700, 24

WRITE_PICTURE = """
import sys, numpy, mitsuba
mitsuba.set_variant("scalar_rgb")
side, file = int(sys.argv[1]), sys.argv[2]
y, x = numpy.mgrid[0:side, 0:side].astype(numpy.float32) / side
noise = numpy.random.default_rng(1).random((side, side, 3), numpy.float32)
values = 0.4 + 0.3 * numpy.sin(40 * x * y)[..., None] + 0.05 * noise
if file.endswith(".exr"):
    mitsuba.Bitmap(values.astype(numpy.float16)).write(file)
else:
    mitsuba.Bitmap((255 * values).astype(numpy.uint8)).write(file)
"""


def hills(triangles):
    """Rows of columns of a field of hills: positions and normals of its vertices and its triangles."""
    side = round(math.sqrt(triangles / 2)) + 1
    positions, normals, corners = array.array("f"), array.array("f"), array.array("I")
    xs = [column / (side - 1) - 0.5 for column in range(side)]
    waves = [(math.sin(40 * x), math.cos(40 * x)) for x in xs]
    for row in range(side):
        z = row / (side - 1) - 0.5
        c, s = math.cos(31 * z), math.sin(31 * z)
        for x, (sine, cosine) in zip(xs, waves):
            slope_x, slope_z = 2 * cosine * c, -1.55 * sine * s
            length = math.sqrt(1 + slope_x * slope_x + slope_z * slope_z)
            positions.extend((x, 0.05 * sine * c, z))
            normals.extend((-slope_x / length, 1 / length, -slope_z / length))
        if row + 1 < side:
            first = row * side
            for a in range(first, first + side - 1):
                corners.extend((a, a + side, a + 1, a + 1, a + side, a + side + 1))
    return positions, normals, corners


def write_ply(path, positions, normals, corners):
    vertices, faces = len(positions) // 3, len(corners) // 3
    with open(path, "wb") as out:
        out.write(("ply\nformat binary_little_endian 1.0\nelement vertex %d\n%selement face %d\n"
                   "property list uchar int vertex_indices\nend_header\n"
                   % (vertices, "".join(f"property float {name}\n" for name in ("x", "y", "z", "nx", "ny", "nz")),
                      faces)).encode())
        rows = array.array("f", bytes(8 * len(positions)))
        for c in range(3):
            rows[c::6], rows[3 + c::6] = positions[c::3], normals[c::3]
        out.write(rows.tobytes())
        for first in range(0, len(corners), 3 << 16):
            part = corners[first:first + (3 << 16)]
            out.write(b"".join(struct.pack("<B3I", 3, *part[i:i + 3]) for i in range(0, len(part), 3)))


def write_serialized(path, positions, normals, corners):
    """Mitsuba's version 4: single precision, with normals."""
    packer = zlib.compressobj(6)
    data = struct.pack("<HH", 0x041C, 4)
    parts = [struct.pack("<I", 0x1000 | 0x0001), b"\0", struct.pack("<QQ", len(positions) // 3, len(corners) // 3),
             positions.tobytes(), normals.tobytes(), corners.tobytes()]
    data += b"".join(packer.compress(part) for part in parts) + packer.flush()
    path.write_bytes(data + struct.pack("<Q", 0) + struct.pack("<I", 1))


def shape(kind, file):
    return f'<shape type="{kind}"><string name="filename" value="{file}"/></shape>'


def make(case, folder, arguments):
    """The scene's file; None where it cannot be made."""
    if case in ("ply", "serialized"):
        (write_ply if case == "ply" else write_serialized)(folder / f"hills.{case}", *hills(arguments.triangles))
        inside = shape(case, f"hills.{case}")
    elif case == "small":
        mesh = hills(2000)
        for i in range(SMALL_MESHES):
            write_ply(folder / f"{i}.ply", *mesh)
        inside = "\n".join(shape("ply", f"{i}.ply") for i in range(SMALL_MESHES))
    else:
        python = find_python(["mitsuba", "numpy"], mitsuba_setup.PYTHON_VARIABLE)
        if not python:
            return None
        are_many = case == "textures"
        files = [f"{i}.jpg" for i in range(TEXTURES)] if are_many else [f"a.{case}"]
        renders.run(python, "-c", WRITE_PICTURE, arguments.texels // (4 if are_many else 1), folder / files[0])
        for file in files[1:]:
            shutil.copy(folder / files[0], folder / file)
        inside = "\n".join(f'<shape type="rectangle"><bsdf type="diffuse"><texture type="bitmap" name="reflectance">'
                           f'<string name="filename" value="{file}"/></texture></bsdf></shape>' for file in files)
    scene = folder / f"{case}.xml"
    scene.write_text(SCENE % inside)
    return scene


CASES = ["ply", "serialized", "small", "png", "jpg", "exr", "textures"]


def main():
    parser = argparse.ArgumentParser(description="loading of large scenes")
    parser.add_argument("cases", nargs="*", metavar="CASE", help=f"of {', '.join(CASES)} (all)")
    parser.add_argument("--bench", type=pathlib.Path, default=renders.ROOT / "build" / "gradus-bench-render")
    parser.add_argument("--triangles", type=int, default=10_000_000)
    parser.add_argument("--texels", type=int, default=8192, help="each way")
    parser.add_argument("--repeats", type=renders.at_least(1), default=3)
    parser.add_argument("--folder", type=pathlib.Path, help="where the files are made (a temporary one)")
    parser.add_argument("--json", type=pathlib.Path, help="also write all figures to this file")
    arguments = parser.parse_args()
    for case in arguments.cases:
        if case not in CASES:
            parser.error(f"no case {case}; there are {', '.join(CASES)}")
    with tempfile.TemporaryDirectory(dir=arguments.folder) as root:
        scenes = []
        for case in arguments.cases or CASES:
            folder = pathlib.Path(root) / case
            folder.mkdir()
            scene = make(case, folder, arguments)
            scenes += [f"{scene}:16x16"] if scene else []
            if not scene:
                print(f"{case}: left out, as there is no Mitsuba to write it (bench/peers/install.py)")
        if scenes:
            print(renders.run(arguments.bench, *scenes, "--parts", "loading", "--repeats", arguments.repeats,
                              *(["--json", arguments.json] if arguments.json else [])), end="")


if __name__ == "__main__":
    main()
