#!/usr/bin/env python3
"""Random scenes, rendered by Gradus and by Mitsuba 3 with as many samples: whose image has less noise?

    python3 bench/peers/random_noise.py [--scenes 40] [--first 0] [--method pt gpt] [--spp 16] [--filter box gaussian]

Scenes are those of random_scenes.py. The noise is the variance of a pixel over seeds, relative to its squared
brightness, on average over the pixels: no reference is needed, and none can be wrong. A few pixels may have most of it;
`without outliers` leaves out the noisiest 3 % of each image. Ratios below 1 are less noise than Mitsuba's. Scenes that
have no noise, or no light in Mitsuba, are left out.
"""

import argparse
import json
import pathlib
import statistics
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))
from random_scenes import (add_scene_options, answers, images_by_gradus, images_by_mitsuba, made_scene,  # noqa: E402
                           python_for_answers)

SEEDS = 6
OUTLIERS = 0.03  # of the pixels
DARK = 0.1  # of the mean brightness: what is darker counts little more, as in relMSE
LEAST_NOISE = 1e-7  # less is rounding


def relative_variances(numpy, images):
    """By pixel, sorted."""
    mean = images.mean(axis=0)
    squared_brightness = mean.mean(axis=-1) ** 2 + (DARK * mean.mean()) ** 2
    return numpy.sort((images.var(axis=0, ddof=1).mean(axis=-1) / squared_brightness).reshape(-1))


def noise_of(numpy, images):
    """The mean, and that without outliers; None without light or noise."""
    images = numpy.stack(list(images)).astype(float)
    if not images.mean() > 0:
        return None
    variances = relative_variances(numpy, images)
    least = variances[:int(len(variances) * (1 - OUTLIERS))].mean()
    return (variances.mean(), least) if least > LEAST_NOISE else None


def compare_scene(arguments, number, folder):
    """By filter and method, the noise over Mitsuba's, with and without outliers."""
    mitsuba, numpy, text = made_scene(arguments, number, folder)
    found = {}
    for pixel_filter in arguments.filter:
        path = folder / f"{pixel_filter}.xml"
        path.write_text(text.replace('<rfilter type="box"/>', f'<rfilter type="{pixel_filter}"/>'), encoding="utf-8")
        theirs = noise_of(numpy, images_by_mitsuba(mitsuba, numpy, path, arguments.spp, range(SEEDS)))
        for method in arguments.method:
            ours = noise_of(numpy, images_by_gradus(mitsuba, numpy, arguments, path, method, arguments.spp,
                                                    range(1, SEEDS + 1)))
            found[f"{pixel_filter} {method}"] = [our / their for our, their in zip(ours, theirs)] \
                if ours and theirs else None
    return found


def print_scene(number, found):
    print(f"scene {number}: " + "; ".join(
        f"{name} {ratios[0]:.2f}, without outliers {ratios[1]:.2f}" if ratios else f"{name} has no noise to compare"
        for name, ratios in found.items()), flush=True)


def print_summary(records):
    """Of all scenes; returns how many ratios there are."""
    compared = 0
    for name in records[0]["found"] if records else ():
        of_scenes = [(record["found"][name], record["scene"]) for record in records if record["found"][name]]
        compared += len(of_scenes)
        for at, which in ((0, ""), (1, ", without outliers")) if of_scenes else ():
            ratios = [(ratio[at], scene) for ratio, scene in of_scenes]
            worst, scene = max(ratios)
            print(f"{name}{which}: median {statistics.median(ratio for ratio, _ in ratios):.2f}, worst {worst:.2f} "
                  f"(scene {scene}), above 1 in {sum(ratio > 1 for ratio, _ in ratios)} of {len(ratios)}")
    return compared


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    add_scene_options(parser, 40)
    parser.add_argument("--filter", nargs="+", default=["box", "gaussian"])
    parser.add_argument("--spp", type=int, default=16)
    arguments = parser.parse_args()
    python = python_for_answers(arguments, compare_scene)
    if not python:
        return 0
    records = []
    with tempfile.TemporaryDirectory(prefix="gradus-noise-") as folder:
        for number, found in answers(__file__, python, arguments, lambda number: pathlib.Path(folder) / str(number),
                                     ["--spp", str(arguments.spp), "--filter", *arguments.filter]):
            records.append({"scene": number, "found": found})
            print_scene(number, found)
    compared = print_summary(records)
    if arguments.json:
        pathlib.Path(arguments.json).write_text(json.dumps(records, indent=1), encoding="utf-8")
    if compared == 0:
        print("nothing was compared")
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
