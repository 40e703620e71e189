#!/usr/bin/env python3
"""Measures Mitsuba 3's path tracer, or its particle tracer, on a scene: samples per second, as JSON on stdout.

    PYTHON-WITH-MITSUBA bench/peers/mitsuba_rate.py SCENE.xml --size 512x512 --spp 64 [--integrator ptracer]

Russian roulette is off unless --rr-depth says from which depth on. Loading and compiling are left out: a render of
another seed comes first. A time ends when the image has been computed (evaluated and synchronised), not when it has been
asked for. A sample is one path of a pixel. Of the particle tracer it is one light path, as many of which are traced in
all; it connects each of their vertices to the camera.
"""

import argparse
import json
import pathlib
import statistics
import sys
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
import mitsuba_setup  # noqa: E402

RR_DEPTH_OFF = 1_000_000


def parse_size(text):
    width, height = (int(part) for part in text.lower().split("x"))
    return width, height


def measure(mitsuba, arguments):
    import drjit

    if arguments.nthreads:
        drjit.set_thread_count(arguments.nthreads)
    width, height = arguments.size
    scene = mitsuba_setup.load_scene_at_size(mitsuba, arguments.scene, width, height, spp=arguments.spp)
    about = {"type": arguments.integrator, "max_depth": arguments.max_depth, "rr_depth": arguments.rr_depth}
    integrator = mitsuba.load_dict(about)

    def render(seed):
        started = time.perf_counter()
        image = mitsuba.render(scene, integrator=integrator, spp=arguments.spp, seed=seed)
        drjit.eval(image)
        drjit.sync_thread()
        return time.perf_counter() - started

    render(1_000_000)
    samples = width * height * arguments.spp
    rates = [samples / render(seed) for seed in range(arguments.repeats)]
    return {
        "scene": str(arguments.scene),
        "integrator": arguments.integrator,
        "width": width,
        "height": height,
        "spp": arguments.spp,
        "max_depth": arguments.max_depth,
        "rr_depth": arguments.rr_depth,
        "repeats": arguments.repeats,
        "samples_per_second": {
            "median": statistics.median(rates),
            "min": min(rates),
            "max": max(rates),
        },
        "version": mitsuba.__version__,
        "variant": arguments.variant,
        "threads": drjit.thread_count(),
    }


def main():
    parser = argparse.ArgumentParser(description="measures Mitsuba 3: samples per second, as JSON")
    parser.add_argument("scene", type=pathlib.Path)
    parser.add_argument("--size", type=parse_size, default=(512, 512), metavar="WxH")
    parser.add_argument("--spp", type=int, default=64)
    parser.add_argument("--max-depth", type=int, default=13)
    parser.add_argument("--rr-depth", type=int, default=RR_DEPTH_OFF, help="of Russian roulette (none)")
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--integrator", choices=["path", "ptracer"], default="path")
    parser.add_argument("--nthreads", type=int, default=0, help="processor threads; 0: all")
    mitsuba_setup.add_mitsuba_options(parser)
    arguments = parser.parse_args()
    print(json.dumps(measure(mitsuba_setup.start_mitsuba(arguments), arguments)))


if __name__ == "__main__":
    main()
