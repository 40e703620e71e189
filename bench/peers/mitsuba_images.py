#!/usr/bin/env python3
"""Images by Mitsuba 3's path tracer and the seconds of each, as JSON on stdout: {"version", "images": [{"spp", "seed",
"seconds", "image"}]}.

    PYTHON-WITH-MITSUBA bench/peers/mitsuba_images.py SCENE.xml FOLDER --size 128x128 --spp 4 16 --seeds 1 2

Depth and Russian roulette are the file's unless given. Loading and compiling are left out of the seconds: for each
count of a call a render of another seed comes first, as Mitsuba compiles other kernels for many samples than for few. A
time ends when the image has been computed, not when it has been asked for.
"""

import argparse
import json
import pathlib
import sys
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
import mitsuba_setup  # noqa: E402

LARGEST_RENDER = 1 << 23  # samples in one call, which bounds its memory


def parts_of(spp, pixels):
    """The samples of each call."""
    largest = max(1, LARGEST_RENDER // pixels)
    return [min(largest, spp - done) for done in range(0, spp, largest)]


def render(mitsuba, scene, spp, seed, pixels):
    """The image and its seconds. Many samples are taken in calls of seeds of their own."""
    import drjit

    started = time.perf_counter()
    total = 0
    for number, part in enumerate(parts_of(spp, pixels)):
        image = mitsuba.render(scene, spp=part, seed=seed * 100_000 + number)
        total = total + image * (part / spp)
        drjit.eval(total)
    drjit.sync_thread()
    return total, time.perf_counter() - started


def main():
    parser = argparse.ArgumentParser(description="images by Mitsuba 3's path tracer and their seconds")
    parser.add_argument("scene", type=pathlib.Path)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--size", required=True, metavar="WxH")
    parser.add_argument("--spp", type=int, nargs="+", required=True)
    parser.add_argument("--seeds", type=int, nargs="+", required=True)
    parser.add_argument("--max-depth", type=int)
    parser.add_argument("-D", dest="parameters", action="append", default=[], metavar="NAME=VALUE")
    mitsuba_setup.add_mitsuba_options(parser)
    arguments = parser.parse_args()
    mitsuba = mitsuba_setup.start_mitsuba(arguments)
    width, height = (int(part) for part in arguments.size.split("x"))
    parameters = dict(text.split("=", 1) for text in arguments.parameters)
    if arguments.max_depth is not None:
        parameters["max_depth"] = arguments.max_depth
    scene = mitsuba_setup.load_scene_at_size(mitsuba, arguments.scene, width, height, **parameters)
    for part in sorted({part for spp in arguments.spp for part in parts_of(spp, width * height)}):
        render(mitsuba, scene, part, 0, width * height)
    arguments.folder.mkdir(parents=True, exist_ok=True)
    records = []
    for seed in arguments.seeds:
        for spp in arguments.spp:
            image, seconds = render(mitsuba, scene, spp, seed, width * height)
            path = arguments.folder / f"mitsuba-{spp}-{seed}.exr"
            bitmap = mitsuba.Bitmap(image).convert(mitsuba.Bitmap.PixelFormat.RGB, mitsuba.Struct.Type.Float32, False)
            bitmap.write(str(path))
            records.append({"spp": spp, "seed": seed, "seconds": seconds, "image": str(path)})
    print(json.dumps({"version": mitsuba.__version__, "images": records}))


if __name__ == "__main__":
    main()
