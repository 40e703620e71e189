"""Renders of scenes that have a reference in tests/references, made by another renderer: their time and their error."""

import json
import pathlib
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
REFERENCES = ROOT / "tests" / "references"


def names():
    """All scenes that have one."""
    return sorted(path.stem for path in REFERENCES.glob("*.json"))


def run(*command):
    result = subprocess.run([str(part) for part in command], capture_output=True, text=True)
    if result.returncode != 0:
        sys.exit(f"failed with exit code {result.returncode}: {' '.join(map(str, command))}\n{result.stderr}")
    return result.stdout


def render(gradus, name, samples, folder, *options):
    """Renders as the reference was, with `options` of `gradus render`. Seconds of a sample a pixel, and relMSE."""
    about = json.loads((REFERENCES / f"{name}.json").read_text())
    image, record = pathlib.Path(folder) / "image.exr", pathlib.Path(folder) / "image.json"
    definitions = [part for key, value in about["parameters"].items() for part in ("-D", f"{key}={value}")]
    run(gradus, "render", ROOT / about["scene"], *definitions, *options, "--size",
        f"{about['width']}x{about['height']}", "--max-depth", about["max_depth"], "-D", "rfilter=box", "--spp", samples,
        "-o", image, "--stats", record, "--quiet")
    compared = pathlib.Path(folder) / "compared.json"
    run(gradus, "compare", image, REFERENCES / f"{name}-mean.exr", "--json", compared)
    seconds = json.loads(record.read_text())["render_seconds"]
    return seconds / samples, json.loads(compared.read_text())["images"][0]["relative_mse"]
