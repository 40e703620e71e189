#!/usr/bin/env python3
"""Renders the references of the project's own scenes with Mitsuba 3: NAME-mean.exr, NAME-variance.exr, NAME.json.

The mean is over independent batches (seeds); the variance is that of the mean image, the sample variance over the
batches divided by their number. Both are 32-bit float RGB, box filter, nothing clamped. The variance is rounded to
eight bits after the leading one, so that it compresses. Russian roulette is off; max_depth is the scene's own.

    PYTHON-WITH-MITSUBA tests/references/make.py [--output FOLDER] [--scale 0.1] [NAME...]
"""

import argparse
import json
import pathlib
import sys
import time

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent
sys.path.insert(0, str(ROOT / "bench" / "peers"))
import mitsuba_setup  # noqa: E402

WIDTH = 128
SMALL_WIDTH = 64  # of those that are not as high
MAX_DEPTH = 12
RR_DEPTH = 1000  # beyond max_depth: off
BATCHES = 64
LARGEST_RENDER = 1 << 23  # samples in one call, which bounds its memory

# name: (scene file, height, parameters, samples a pixel in all)
REFERENCES = {
    "cornell-box": ("cornell-box.xml", 128, {}, 16384),
    "torus-rough-glass": ("torus-rough-glass.xml", 96, {}, 16384),
    "plates": ("plates.xml", 96, {}, 49152),
    "holes-7": ("holes.xml", 96, {"density": 7}, 16384),
    "holes-14": ("holes.xml", 96, {"density": 14}, 16384),
    "holes-28": ("holes.xml", 96, {"density": 28}, 16384),
    "door-ajar": ("door-ajar.xml", 96, {}, 24576),
    "materials": ("materials.xml", 96, {}, 32768),
    "textures": ("textures.xml", 96, {}, 16384),
    "cornell-box-glossy": ("cornell-box-glossy.xml", 128, {}, 8192),
    # Light that path tracing finds by chance alone: with lamps of the same power, but larger.
    "metal-ring-soft": ("metal-ring.xml", 96, {"lamp": 0.24, "glow": 75}, 16384),
    "torus-smooth-glass-soft": ("torus-smooth-glass.xml", 96, {"lamp": 0.6, "glow": 41.6667}, 16384),
    "slab-and-ball-soft": ("slab-and-ball.xml", 96, {"lamp": 0.24, "glow": 56.25}, 16384),
    "lamp-in-egg-soft": ("lamp-in-egg.xml", 96, {"lamp": 0.1, "glow": 15}, 12288),
    "metal-ring": ("metal-ring.xml", 96, {}, 65536),
    "sundial": ("sundial.xml", 96, {}, 16384),
    "lanterns": ("lanterns.xml", 96, {}, 16384),
    "pool": ("pool.xml", 48, {}, 131072),
    # Small ones, of filters: the outermost pixels see less than theirs.
    "cornell-box-gaussian": ("cornell-box.xml", 64, {"rfilter": "gaussian"}, 16384),
    "cornell-box-tent": ("cornell-box.xml", 64, {"rfilter": "tent"}, 16384),
    # Small ones, of plugins.
    "thin-lens": ("../tests/scenes/thin-lens.xml", 48, {}, 16384),
    "orthographic": ("../tests/scenes/orthographic.xml", 48, {}, 16384),
    "relief": ("../tests/scenes/relief.xml", 48, {}, 16384),
    "clipped": ("../tests/scenes/clipped.xml", 48, {}, 16384),
    "clipped-mitchell": ("../tests/scenes/clipped.xml", 48, {"rfilter": "mitchell"}, 65536),
    "lamps": ("../tests/scenes/lamps.xml", 48, {}, 16384),
    "brushed": ("../tests/scenes/brushed.xml", 48, {}, 16384),
    "instances": ("../tests/scenes/instances.xml", 48, {}, 16384),
    "plastics": ("plastics.xml", 48, {}, 32768),
}

# Parameters for Mitsuba alone. Its path tracer finds no point or directional light through a null surface, since light
# samples end there: the sphere of nothing is out of the way, below the floor.
FOR_MITSUBA = {"materials": {"nothing": -50}}


def render_batch(mitsuba, scene, spp, first_seed, pixels):
    """The mean over spp samples a pixel, in float64, and the next unused seed. Splits spp to bound memory."""
    import numpy

    total, done, seed = 0.0, 0, first_seed
    while done < spp:
        part = min(spp - done, max(1, LARGEST_RENDER // pixels))
        total = total + part * numpy.array(mitsuba.render(scene, spp=part, seed=seed), dtype=numpy.float64)
        done, seed = done + part, seed + 1
    return total / spp, seed


def block_means(image, size=16):
    height, width, channels = image.shape
    return image.reshape(height // size, size, width // size, size, channels).mean(axis=(1, 3))


def round_mantissa(values, bits):
    """float32 values to the nearest with that many bits after the leading one."""
    import numpy

    raw = values.astype(numpy.float32).view(numpy.uint32).astype(numpy.uint64)
    dropped = 23 - bits
    raw = (raw + (1 << (dropped - 1))) >> dropped << dropped
    return raw.astype(numpy.uint32).view(numpy.float32)


def halves_error(first, second):
    """What two independent halves say of their mean: its relMSE, and the root mean square relative error of its means of
    16 x 16 pixels."""
    import numpy

    mean = (first + second) / 2
    relmse = ((first - second) ** 2 / 4 / (mean**2 + 0.001)).mean()
    blocks = block_means(mean)
    lit = blocks > 0
    relative = (block_means(first) - block_means(second))[lit] / 2 / blocks[lit]
    return float(relmse), float(numpy.sqrt((relative**2).mean()))


def make_reference(mitsuba, name, arguments):
    import numpy

    file, height, parameters, spp = REFERENCES[name]
    spp_of_batch = max(1, round(spp * arguments.scale / BATCHES))
    parameters = dict(parameters)
    width = SMALL_WIDTH if height <= SMALL_WIDTH else WIDTH
    scene = mitsuba_setup.load_scene(
        mitsuba,
        ROOT / "scenes" / file,
        **{"resx": width, "resy": height, "max_depth": MAX_DEPTH, "rr_depth": RR_DEPTH, "rfilter": "box", **parameters,
           **FOR_MITSUBA.get(name, {})},
    )
    started, seed = time.time(), arguments.seed
    mean = squares = blocks = block_squares = 0.0
    halves = [0.0, 0.0]
    for batch in range(BATCHES):
        image, seed = render_batch(mitsuba, scene, spp_of_batch, seed, width * height)
        if not numpy.isfinite(image).all():
            raise RuntimeError(f"{name}: batch {batch} holds a value that is not finite")
        halves[batch * 2 // BATCHES] += image / (BATCHES // 2)
        # Welford's update: no cancellation where the variance is far below the mean.
        difference = image - mean
        mean = mean + difference / (batch + 1)
        squares = squares + difference * (image - mean)
        block_difference = block_means(image) - blocks
        blocks = blocks + block_difference / (batch + 1)
        block_squares = block_squares + block_difference * (block_means(image) - blocks)
    variance = squares / (BATCHES - 1) / BATCHES
    lit = blocks > 0  # a block of shadow alone has no relative error
    block_error = numpy.sqrt(block_squares / (BATCHES - 1) / BATCHES)[lit] / blocks[lit]

    halves_relmse, halves_blocks = halves_error(*halves)
    arguments.output.mkdir(parents=True, exist_ok=True)
    mitsuba.Bitmap(mean.astype(numpy.float32)).write(str(arguments.output / f"{name}-mean.exr"))
    mitsuba.Bitmap(round_mantissa(variance, 8)).write(str(arguments.output / f"{name}-variance.exr"))
    if arguments.png:
        mitsuba.util.write_bitmap(str(arguments.output / f"{name}.png"), mean.astype(numpy.float32))
    record = {
        "scene": (pathlib.PurePath("scenes") / file).as_posix().replace("scenes/../", ""),
        "parameters": parameters,
        "width": width,
        "height": height,
        "filter": parameters.get("rfilter", "box"),
        "max_depth": MAX_DEPTH,
        "rr_depth": RR_DEPTH,
        "spp": spp_of_batch * BATCHES,
        "batches": BATCHES,
        "first_seed": arguments.seed,
        "mean": [float(f"{value:.6g}") for value in mean.mean(axis=(0, 1))],
        "relmse_of_mean": float(f"{(variance / (mean**2 + 0.001)).mean():.3g}"),
        "block_relative_error_median": float(f"{numpy.median(block_error):.3g}"),
        "block_relative_error_max": float(f"{block_error.max():.3g}"),
        "halves_relmse": float(f"{halves_relmse:.3g}"),
        "halves_block_relative_error": float(f"{halves_blocks:.3g}"),
        "renderer": f"mitsuba {mitsuba.__version__} {arguments.variant}",
    }
    (arguments.output / f"{name}.json").write_text(json.dumps(record, indent=2) + "\n")
    print(
        f"{name}: {record['spp']} spp, relMSE {record['relmse_of_mean']:.2g}, block error median "
        f"{record['block_relative_error_median']:.2%} max {record['block_relative_error_max']:.2%}, "
        f"{time.time() - started:.0f} s",
        flush=True,
    )


def main():
    parser = argparse.ArgumentParser(description="renders the references of the project's own scenes with Mitsuba 3")
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"of {', '.join(REFERENCES)} (default: all)")
    parser.add_argument("--output", type=pathlib.Path, default=HERE, help="folder (default: the one of this script)")
    parser.add_argument("--scale", type=float, default=1, help="factor on the samples, for a quick look")
    parser.add_argument("--seed", type=int, default=1, help="first seed; a render takes one seed or more each")
    parser.add_argument("--png", action="store_true", help="also write a tone-mapped picture to look at")
    mitsuba_setup.add_mitsuba_options(parser)
    arguments = parser.parse_args()
    unknown = [name for name in arguments.names if name not in REFERENCES]
    if unknown:
        parser.error(f"no such reference: {', '.join(unknown)}")
    mitsuba = mitsuba_setup.start_mitsuba(arguments)
    for name in arguments.names or REFERENCES:
        make_reference(mitsuba, name, arguments)


if __name__ == "__main__":
    main()
