#!/usr/bin/env python3
"""Denoises images by Open Image Denoise, guided by albedo and normal, and prints the seconds of each as a JSON list.

    PYTHON-WITH-DENOISER bench/peers/denoise.py IN.exr OUT.exr [IN.exr OUT.exr ...]

The inputs are gradus's, with --aov; the guides are taken as they are, noisy where what is seen is, or with
--clean-features are denoised first, which is not timed. Quality is the highest. The time is that of the filter on
images in memory, the median of three; starting the device, reading and writing are left out.
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
    parser.add_argument("--clean-features", action="store_true", help="denoise albedo and normal first")
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

    def denoised(kind, feature):
        output = numpy.empty_like(feature)
        with pyoidn.Device() as device:
            device.commit()
            with pyoidn.Filter(device, pyoidn.OIDN_FILTER_TYPE_RT) as single:
                single.set_image(kind, feature, pyoidn.OIDN_FORMAT_FLOAT3)
                single.set_image("output", output, pyoidn.OIDN_FORMAT_FLOAT3)
                single.commit()
                single.execute()
        return output

    seconds = []
    for source, target in zip(arguments.files[::2], arguments.files[1::2]):
        channels = OpenEXR.File(source, separate_channels=True).channels()
        color = planes(channels, ["R", "G", "B"])
        albedo = planes(channels, ["albedo.R", "albedo.G", "albedo.B"])
        normal = planes(channels, ["normal.X", "normal.Y", "normal.Z"])
        if arguments.clean_features:
            albedo, normal = denoised("albedo", albedo), denoised("normal", normal)
        turns = []
        for _ in range(4):  # the first sets the filter up for this size
            started = time.perf_counter()
            result = pyoidn.denoise(color, albedo=albedo, normal=normal, hdr=True,
                                    clean_aux=arguments.clean_features)
            turns.append(time.perf_counter() - started)
        seconds.append(statistics.median(turns[1:]))
        header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
        OpenEXR.File(header, {"RGB": result}).write(target)
    print(json.dumps(seconds))


if __name__ == "__main__":
    main()
