"""References for scenes that have none: path tracing with far more samples, made once and kept.

Such a reference shows how errors fall. It does not show that they fall to what is right: a mistake that the program
makes everywhere is in the reference, too. Its seed is far from those that are measured.
"""

import dataclasses
import hashlib
import json

import renders

SEED = 1 << 30


def key(scene, samples):
    """Changes with whatever changes the image; files of the scene's folder are taken by name, size and date."""
    hashed = hashlib.sha256(scene.file.read_bytes())
    for path in sorted(scene.file.parent.rglob("*")):
        if path.is_file():
            hashed.update(f"{path.name} {path.stat().st_size} {path.stat().st_mtime}".encode())
    about = [scene.width, scene.height, scene.max_depth, sorted(scene.parameters.items()), samples]
    hashed.update(json.dumps(about).encode())
    return hashed.hexdigest()[:16]


def with_reference(gradus, scene, samples, cache):
    """The scene with its reference, which is made where it is neither given nor kept in the folder `cache`, with a
    picture of it as PNG and its statistics."""
    if scene.reference:
        return scene
    cache.mkdir(parents=True, exist_ok=True)
    kept = cache / f"{scene.file.stem}-{key(scene, samples)}.exr"
    if not kept.exists():
        print(f"{scene.name}: making a reference of {samples} samples a pixel, kept as {kept}", flush=True)
        # Under another name first: an interrupted render leaves an image of fewer samples.
        unfinished = kept.with_suffix(".unfinished.exr")
        renders.render(gradus, scene, "pt", SEED, unfinished, samples=samples, aov=True, png=True)
        unfinished.with_suffix(".png").rename(kept.with_suffix(".png"))
        unfinished.with_suffix(".json").rename(kept.with_suffix(".json"))
        unfinished.rename(kept)
    return dataclasses.replace(scene, reference=renders.Reference(kept, kept, samples, "gradus pt"))
