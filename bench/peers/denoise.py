#!/usr/bin/env python3
"""Denoises images by Open Image Denoise, guided by albedo and normal, and prints the seconds of each as a JSON list.

    PYTHON-WITH-DENOISER bench/peers/denoise.py IN.exr OUT.exr [IN.exr OUT.exr ...]

The inputs are gradus's, with --aov; the guides are taken as they are, noisy where the first hits are. Quality is the
highest. The time is that of the filter on images in memory, the median of three; starting the device, reading and
writing are left out.
"""

import argparse
import json
import pathlib
import statistics
import sys
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
import denoiser_setup  # noqa: E402


def main():
    parser = argparse.ArgumentParser(description="denoises images by Open Image Denoise")
    parser.add_argument("files", nargs="+", metavar="IN OUT")
    arguments = parser.parse_args()
    if len(arguments.files) % 2:
        parser.error("files come in pairs: one to read, one to write")
    try:
        import numpy
        import OpenEXR
        import pyoidn
    except ImportError:
        sys.exit(denoiser_setup.HOW_TO_GET)

    def planes(channels, names):
        missing = [name for name in names if name not in channels]
        if missing:
            sys.exit(f"no channel {missing[0]}: render with --aov")
        return numpy.ascontiguousarray(numpy.stack([channels[name].pixels for name in names], axis=-1), numpy.float32)

    seconds = []
    for source, target in zip(arguments.files[::2], arguments.files[1::2]):
        channels = OpenEXR.File(source, separate_channels=True).channels()
        color = planes(channels, ["R", "G", "B"])
        albedo = planes(channels, ["albedo.R", "albedo.G", "albedo.B"])
        normal = planes(channels, ["normal.X", "normal.Y", "normal.Z"])
        turns = []
        for _ in range(4):  # the first sets the filter up for this size
            started = time.perf_counter()
            result = pyoidn.denoise(color, albedo=albedo, normal=normal, hdr=True)
            turns.append(time.perf_counter() - started)
        seconds.append(statistics.median(turns[1:]))
        header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
        OpenEXR.File(header, {"RGB": result}).write(target)
    print(json.dumps(seconds))


if __name__ == "__main__":
    main()
