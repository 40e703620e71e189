"""Renders by the program and their errors, for the benches that weigh one method against another.

A scene is a name in tests/references, whose reference another renderer made; the Cornell box or the soft torus of
`../shared`, where that folder is present; or SCENE.xml:WxH, which has no reference (references.py makes one).
"""

import argparse
import dataclasses
import json
import os
import pathlib
import re
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
REFERENCES = ROOT / "tests" / "references"
SHARED = ROOT.parent / "shared"
# Of ../shared, name: scene file, width, height, max depth, reference.
SHARED_SCENES = {"cornell-box-256": ("cornell-box/scene.xml", 256, 256, 30, "cornell-box"),
                 "torus-soft-256": ("torus/scene-soft.xml", 256, 192, 30, "torus-soft")}
# Light that paths from the camera find by chance alone, so that their errors are those of another kind of scene.
PHOTON_SCENES = ["metal-ring", "metal-ring-soft", "torus-smooth-glass-soft", "slab-and-ball-soft", "lamp-in-egg-soft",
                 "cornell-box-glossy", "pool"]
NO_ROULETTE = 1_000_000  # a depth at which no path begins with Russian roulette


@dataclasses.dataclass(frozen=True)
class Reference:
    """An image that errors are measured against; `variance`: of its mean by pixel, an image or one with that layer."""

    image: pathlib.Path
    variance: pathlib.Path
    spp: int
    renderer: str


@dataclasses.dataclass(frozen=True)
class Scene:
    name: str
    file: pathlib.Path
    width: int
    height: int
    max_depth: int | None = None  # None: as the file says
    parameters: dict = dataclasses.field(default_factory=dict)
    reference: Reference | None = None


def run(*command, environment=None):
    """The command's standard output. Ends the program where the command fails, with what it said."""
    result = subprocess.run([str(part) for part in command], capture_output=True, text=True, env=environment)
    if result.returncode != 0:
        sys.exit(f"failed with exit code {result.returncode}: {' '.join(map(str, command))}\n{result.stderr}")
    return result.stdout


def default_jobs():
    """SCENE.xml:WxH of the scenes whose speed is measured: those by others where they are beside the checkout, else our
    own."""
    shared = SHARED / "scenes"
    if (shared / "cornell-box" / "scene.xml").exists() and (shared / "torus" / "scene.xml").exists():
        return [f"{shared}/cornell-box/scene.xml:512x512", f"{shared}/torus/scene.xml:512x384"]
    return [f"{ROOT}/scenes/cornell-box.xml:512x512", f"{ROOT}/scenes/torus-rough-glass.xml:512x384"]


def scene_names():
    """The scenes with a reference of another renderer."""
    return (sorted(path.stem for path in REFERENCES.glob("*.json"))
            + [name for name, (file, *_) in SHARED_SCENES.items() if (SHARED / "scenes" / file).exists()])


def usual_scenes():
    """Those of them that a bench of path tracing and gradients measures unless it is told which."""
    return [name for name in scene_names() if name not in PHOTON_SCENES]


def shared_scene(name):
    file, width, height, max_depth, image = SHARED_SCENES[name]
    mean = SHARED / "references" / f"{image}-mean.exr"
    reference = None
    if mean.exists():
        reference = Reference(mean, mean.with_name(f"{image}-variance.exr"), 32768, "mitsuba 3.9")
    return Scene(name, SHARED / "scenes" / file, width, height, max_depth, {}, reference)


def find_scene(text):
    """The scene of that name, or SCENE.xml:WxH. Ends the program where there is none."""
    record = REFERENCES / f"{text}.json"
    if record.exists():
        about = json.loads(record.read_text())
        reference = Reference(REFERENCES / f"{text}-mean.exr", REFERENCES / f"{text}-variance.exr", about["spp"],
                              about["renderer"])
        return Scene(text, ROOT / about["scene"], about["width"], about["height"], about["max_depth"],
                     about["parameters"], reference)
    if text in scene_names():
        return shared_scene(text)
    path, _, size = text.rpartition(":")
    width, _, height = size.partition("x")
    if not path or not width.isdigit() or not height.isdigit():
        sys.exit(f"'{text}' is neither SCENE.xml:WxH nor one of {', '.join(scene_names())}")
    if not pathlib.Path(path).exists():
        sys.exit(f"{path}: no such scene")
    return Scene(f"{pathlib.Path(path).stem} {size}", pathlib.Path(path).resolve(), int(width), int(height))


def scenes_with_reference(names):
    """find_scene() of each. Ends the program where one has no reference of another renderer to measure against."""
    scenes = [find_scene(name) for name in names]
    without = [scene.name for scene in scenes if not scene.reference]
    if without:
        sys.exit(f"no reference of {', '.join(without)}: errors are measured for {', '.join(scene_names())}")
    return scenes


def at_least(least):
    """For argparse: the type of a whole number that is no less."""
    def number(text):
        value = int(text)
        if value < least:
            raise argparse.ArgumentTypeError(f"{text} is less than {least}")
        return value
    return number


def box_filter(scene):
    """References are made with the box filter: the options that say so, where the scene has that parameter."""
    return ["-D", "rfilter=box"] if "$rfilter" in scene.file.read_text() else []


def render(gradus, scene, method, seed, output, samples=None, seconds=None, aov=False, variance=True, png=False,
           layers=True, options=()):
    """Renders so many samples a pixel, or so long, to `output` (.exr) and returns the statistics. layers: the image of
    `gpt` has those that it was reconstructed from. aov: with the layers albedo, normal, depth and, unless
    `variance` is False, variance, for which samples are drawn otherwise; png: a picture beside it, tone-mapped; options:
    more of `gradus render`."""
    record = pathlib.Path(output).with_suffix(".json")
    command = [gradus, "render", scene.file, "-o", output, "--stats", record, "--quiet", "--method", method]
    command += [*(["--layers"] if layers else []), "--seed", seed, "--size", f"{scene.width}x{scene.height}"]
    command += box_filter(scene)
    for name, value in scene.parameters.items():
        command += ["-D", f"{name}={value}"]
    if scene.max_depth is not None:
        command += ["--max-depth", scene.max_depth]
    command += ["--spp", samples] if samples is not None else ["--time", seconds]
    command += [*(["--aov"] if aov else []), *(["--no-variance"] if aov and not variance else [])]
    run(*command, *(["--png"] if png else []), *options)
    return json.loads(record.read_text())


def compare(gradus, image, reference, *options):
    """The figures of `gradus compare`: those of the image, and `reference_relative_mse`."""
    record = pathlib.Path(image).with_suffix(".compared.json")
    run(gradus, "compare", image, reference.image, "--variance", reference.variance, "--reference-spp", reference.spp,
        "--json", record, *options)
    compared = json.loads(record.read_text())
    return {**compared["images"][0], "reference_relative_mse": compared["reference_relative_mse"]}


def split_variant(text):
    """METHOD, METHOD:RECONSTRUCTION or METHOD:guided:GUIDE as the method and the options that say the rest."""
    method, *more = text.split(":")
    options = ["--reconstruction", "--guide"]
    if len(more) > len(options):
        sys.exit(f"'{text}' is not METHOD, METHOD:RECONSTRUCTION or METHOD:guided:GUIDE")
    return method, [word for pair in zip(options, more) for word in pair]


def made_instead(variant, record):
    """The reconstruction that the statistics tell where it is not the one that the variant says, as with few samples;
    else None."""
    asked, made = variant.split(":")[1:2], record["reconstruction"]["name"]
    return made if asked and made != asked[0] else None


def known_methods(gradus):
    """The methods that this program has, as its help lists them."""
    listed = re.search(r"--method\s+TEXT:\{([^}]*)\}", run(gradus, "render", "--help"))
    if not listed:
        sys.exit(f"{gradus}: its help lists no methods")
    return listed.group(1).split(",")


def read_header(image):
    with open(image, "rb") as file:
        return file.read(1 << 16)


def reconstruction_of(image):
    """The options by which `solve` does what the render of an OpenEXR file did, as its header says; none where nothing
    was reconstructed. What was asked for may differ: with few samples it is another."""
    header, options = read_header(image), []
    for key in ("reconstruction", "guide"):
        # A name, its type, the length of its value, the value.
        found = re.search(rb"gradus:%s\0string\0(....)" % key.encode(), header, re.DOTALL)
        text = found and header[found.end():found.end() + int.from_bytes(found.group(1), "little")].decode()
        if text and text != "none":
            options += [f"--{key}", text]
    return options


def has_layers(image):
    """Whether an OpenEXR file has what it was reconstructed from: differences, or halves of the samples."""
    header = read_header(image)
    return b"\0dx.R\0" in header or b"\0primal_even.R\0" in header


def reconstruction_seconds(gradus, image):
    """Seconds in which the image is reconstructed as its render did, all kernels compiled; 0 where it was not. Ends the
    program where the image lacks the layers for it.

    A render reconstructs once, after the time that its statistics call render_seconds, and loads kernels meanwhile;
    here the third of three is timed."""
    options = reconstruction_of(image)
    if not options:
        return 0.0
    if not has_layers(image):
        sys.exit(f"{image}: it was reconstructed, and has no layers to time that by")
    record, output = pathlib.Path(image).with_suffix(".solved.json"), pathlib.Path(image).with_suffix(".solved.exr")
    run(gradus, "solve", image, "-o", output, "--stats", record, "--repeats", 3, "--quiet", *options)
    return json.loads(record.read_text())["seconds"]


def machine():
    """What a figure was measured on."""
    model = "unknown processor"
    try:
        lines = pathlib.Path("/proc/cpuinfo").read_text().splitlines()
        model = next((line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")), model)
    except OSError:
        pass
    commit = subprocess.run(["git", "-C", str(ROOT), "describe", "--always", "--dirty"], capture_output=True,
                            text=True)
    return {"processor": model, "processors": os.cpu_count(), "load_before": os.getloadavg()[0],
            "date": time.strftime("%Y-%m-%d"), "commit": commit.stdout.strip() or "unknown"}
