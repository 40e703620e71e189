#!/usr/bin/env python3
"""Random scenes, rendered by Gradus and by Mitsuba 3: a search for combinations that no test thought of.

    python3 bench/peers/random_scenes.py [--scenes 20] [--first 0] [--method pt gpt] [--keep FOLDER]

Scene N is made from the number N alone: shapes (some of them instances), BSDFs of every kind that both renderers have
with textures, blends, masks and maps, emitters of every kind, a sensor, a depth. Means over blocks of the image and
over all of it are compared, by the spread over seeds of both renderers. A difference beyond 5 standard errors is looked
at again with fresh seeds and four times the samples, and counts where it is there again. Exits with 1 where one does,
and the scene is kept in the folder, whose files both renderers read; and where no scene was compared, or more than a
third had no answer.

Left out is what Mitsuba is known to do in another way (docs/scene-format.md): axes of rotation that are no unit
vectors, blends with smooth parts or rough glass, masks within blends and maps, checkerboards as numbers, short paths
through masks, lights without an area behind them, textured lamps other than rectangles and those that are flipped,
closed lamps that shine inwards (a little of its light gets out). Nor are there environments beside instances, which end
the process of its scalar variants.
"""

import argparse
import json
import pathlib
import random
import shutil
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent
sys.path.insert(0, str(HERE))
import mitsuba_setup  # noqa: E402
from pythons import find_python  # noqa: E402

WIDTH, HEIGHT, BLOCK = 24, 18, 6
SEEDS, SPP = 8, 128
SUSPECTED, CONFIRMED = 5, 4.5  # standard errors
FLIP = '<boolean name="flip_normals" value="true"/>'
LEAST_DIFFERENCE = 0.003  # of the brighter mean: less is what float and its limits may make
MOST_WITHOUT_ANSWER = 1 / 3  # of the scenes, lest nothing is compared and nothing said: some end Mitsuba's process
PHOTON_METHODS = {"sppm", "gpm"}
RADIUS_BIAS = 0.05  # the same of photons, which radii of some pixels spread over the edges of blocks


class Maker:
    """The text of one scene."""

    def __init__(self, number, folder, mitsuba):
        self.random, self.folder, self.mitsuba = random.Random(number), pathlib.Path(folder), mitsuba
        self.files = 0
        self.has_mask = self.random.random() < 0.3
        self.has_maps = self.random.random() < 0.4
        self.has_textures = self.random.random() < 0.6
        self.has_instances = self.random.random() < 0.3
        self.kinds = self.random.sample(sorted(KINDS), 3)

    def number(self, low, high):
        return round(self.random.uniform(low, high), 3)

    def color(self, low=0.05, high=0.9):
        return f"{self.number(low, high)}, {self.number(low, high)}, {self.number(low, high)}"

    def bitmap(self, suffix, width, height, low, high):
        """The path of a picture of random texels."""
        import numpy

        texels = numpy.array([[[self.random.uniform(low, high) for _ in range(3)] for _ in range(width)]
                              for _ in range(height)], dtype=numpy.float32)
        path = self.folder / f"picture-{self.files}.{suffix}"
        self.files += 1
        bitmap = self.mitsuba.Bitmap(texels)
        if suffix != "exr":
            bitmap = bitmap.convert(self.mitsuba.Bitmap.PixelFormat.RGB, self.mitsuba.Struct.Type.UInt8, True)
        bitmap.write(str(path))
        return path

    def texture(self, name, low, high, raw=False):
        if not raw and self.random.random() < 0.5:
            return (f'<texture type="checkerboard" name="{name}"><rgb name="color0" value="{self.color(low, high)}"/>'
                    f'<rgb name="color1" value="{self.color(low, high)}"/>{self.to_uv()}</texture>')
        path = self.bitmap("png", self.random.randint(1, 6), self.random.randint(1, 6), low, high)
        return (f'<texture type="bitmap" name="{name}"><string name="filename" value="{path.name}"/>'
                f'<string name="filter_type" value="{self.random.choice(["bilinear", "nearest"])}"/>'
                f'<string name="wrap_mode" value="{self.random.choice(["repeat", "mirror", "clamp"])}"/>'
                f'<boolean name="raw" value="{"true" if raw else "false"}"/>{self.to_uv()}</texture>')

    def to_uv(self):
        if self.random.random() < 0.5:
            return ""
        return (f'<transform name="to_uv"><scale x="{self.number(0.5, 3)}" y="{self.number(0.5, 3)}"/>'
                f'<translate x="{self.number(-1, 1)}" y="{self.number(-1, 1)}"/></transform>')

    def reflectance(self, name="reflectance"):
        if self.has_textures and self.random.random() < 0.5:
            return self.texture(name, 0.05, 0.9)
        return f'<rgb name="{name}" value="{self.color()}"/>'

    def scalar(self, name, low, high):
        if self.has_textures and self.random.random() < 0.3:
            return self.texture(name, low, high, raw=True)
        return f'<float name="{name}" value="{self.number(low, high)}"/>'

    def bsdf(self, depth=0):
        """Inside `depth` others."""
        wrapper = self.random.random()
        if depth < 2 and wrapper < 0.35:
            if self.has_mask and depth == 0 and wrapper < 0.12:
                return f'<bsdf type="mask">{self.scalar("opacity", 0.2, 0.9)}{self.bsdf(depth + 1)}</bsdf>'
            if self.has_maps and wrapper < 0.2:
                path = self.bitmap("exr", 4, 4, 0.3, 0.7)
                picture = f'<string name="filename" value="{path.name}"/><boolean name="raw" value="true"/>'
                if self.random.random() < 0.5:
                    return (f'<bsdf type="bumpmap"><texture type="bitmap" name="arbitrary">{picture}</texture>'
                            f'<float name="scale" value="{self.number(0.05, 0.3)}"/>{self.bsdf(2)}</bsdf>')
                return (f'<bsdf type="normalmap"><texture type="bitmap" name="normalmap">{picture}</texture>'
                        f'{self.bsdf(2)}</bsdf>')
            if wrapper < 0.28:
                return (f'<bsdf type="blendbsdf">{self.scalar("weight", 0.1, 0.9)}{self.one_of(BLENDED)}'
                        f'{self.one_of(BLENDED)}</bsdf>')
            if depth == 0:
                back = self.one_of(OPAQUE) if wrapper < 0.32 else ""
                return f'<bsdf type="twosided">{self.one_of(OPAQUE)}{back}</bsdf>'
        return self.one_of(KINDS)

    def one_of(self, kinds):
        return KINDS[self.random.choice([kind for kind in self.kinds if kind in kinds] or ["diffuse"])](self)

    def rotation(self):
        axis = [self.random.gauss(0, 1) for _ in range(3)]
        length = sum(value * value for value in axis) ** 0.5
        x, y, z = (value / length for value in axis)
        return f'<rotate x="{x:.9f}" y="{y:.9f}" z="{z:.9f}" angle="{self.number(0, 360)}"/>'

    def transform(self, scales=True, uniform=False):
        size = self.number(0.4, 1)
        scale = (f'<scale x="{size}" y="{size if uniform else self.number(0.4, 1)}" '
                 f'z="{size if uniform else self.number(0.4, 1)}"/>') if scales else ""
        return (f'<transform name="to_world">{scale}'
                f'{self.rotation()}<translate x="{self.number(-1.5, 1.5)}" y="{self.number(-1.2, 1.2)}" '
                f'z="{self.number(-1, 1)}"/>'
                '</transform>')

    def shape_kind(self):
        return self.random.choice(["rectangle", "cube", "sphere", "sphere", "disk", "cylinder"])

    def shape(self, inside, kind=None, may_flip=True):
        kind = kind or self.shape_kind()
        if kind == "sphere":
            place = self.transform(uniform=True)
            flip = FLIP if may_flip and self.random.random() < 0.2 else ""
            radius = self.number(0.3, 0.8)
            return f'<shape type="sphere"><float name="radius" value="{radius}"/>{place}{flip}{inside}</shape>'
        if kind == "cylinder":
            return (f'<shape type="cylinder"><float name="radius" value="{self.number(0.1, 0.5)}"/>'
                    f'<point name="p0" x="0" y="0" z="-0.5"/><point name="p1" x="0" y="0" z="{self.number(0, 1)}"/>'
                    f'{self.transform(scales=False)}{inside}</shape>')
        flip = FLIP if may_flip and self.random.random() < 0.3 else ""
        return f'<shape type="{kind}">{self.transform()}{flip}{inside}</shape>'

    def radiance(self, low, high, may_vary):
        if may_vary and self.has_textures and self.random.random() < 0.3:
            path = self.bitmap("exr", 4, 3, low, high)
            return (f'<texture type="bitmap" name="radiance"><string name="filename" value="{path.name}"/>'
                    '<boolean name="raw" value="true"/></texture>')
        return f'<rgb name="radiance" value="{self.color(low, high)}"/>'

    def toward_middle(self):
        return (f'<transform name="to_world"><lookat origin="{self.number(-2, 2)}, {self.number(2, 3)}, '
                f'{self.number(-2, 2)}" target="{self.number(-1, 1)}, 0, 0" up="0, 0.1, 1"/></transform>')

    def emitter(self):
        kinds = ["area", "area", "area"] + ([] if self.has_instances else ["constant", "envmap"])
        if not self.has_mask:
            kinds += ["point", "spot", "directional", "projector"]
        kind = self.random.choice(kinds)
        if kind == "area":
            shape = self.shape_kind()
            inside = (f'<bsdf type="diffuse"><rgb name="reflectance" value="{self.color()}"/></bsdf>'
                      f'<emitter type="area">{self.radiance(2, 12, shape == "rectangle")}</emitter>')
            return self.shape(inside, shape, shape in ("rectangle", "disk") and 'name="radiance"><string' not in inside)
        if kind == "constant":
            return f'<emitter type="constant">{self.plain("radiance", 0.2, 1)}</emitter>'
        if kind == "envmap":
            path = self.bitmap("exr", self.random.randint(4, 9), self.random.randint(3, 6), 0, 2)
            return (f'<emitter type="envmap"><string name="filename" value="{path.name}"/>'
                    f'<float name="scale" value="{self.number(0.2, 1)}"/><transform name="to_world">'
                    f'{self.rotation()}</transform></emitter>')
        if kind == "point":
            return (f'<emitter type="point"><point name="position" x="{self.number(-2, 2)}" y="{self.number(1, 3)}" '
                    f'z="{self.number(-2, 2)}"/>{self.plain("intensity", 3, 12)}</emitter>')
        if kind == "directional":
            return (f'<emitter type="directional"><vector name="direction" x="{self.number(-1, 1)}" y="-1" '
                    f'z="{self.number(-1, 1)}"/>{self.plain("irradiance", 0.5, 3)}</emitter>')
        if kind == "spot":
            cutoff = self.number(20, 50)
            picture = self.texture("texture", 0.2, 0.9) if self.has_textures and self.random.random() < 0.4 else ""
            return (f'<emitter type="spot">{self.toward_middle()}{self.plain("intensity", 5, 20)}{picture}'
                    f'<float name="cutoff_angle" value="{cutoff}"/>'
                    f'<float name="beam_width" value="{round(cutoff * self.number(0.2, 0.9), 3)}"/></emitter>')
        path = self.bitmap("exr", self.random.randint(2, 6), self.random.randint(2, 6), 1, 8)
        return (f'<emitter type="projector">{self.toward_middle()}<texture type="bitmap" name="irradiance">'
                f'<string name="filename" value="{path.name}"/><boolean name="raw" value="true"/></texture>'
                f'<float name="fov" value="{self.number(30, 80)}"/></emitter>')

    def plain(self, name, low, high):
        return f'<rgb name="{name}" value="{self.color(low, high)}"/>'

    def sensor(self):
        kind = self.random.choice(["perspective", "perspective", "thinlens", "orthographic"])
        target = f"{self.number(-0.3, 0.3)}, {self.number(-0.3, 0.3)}, 0"
        scale = '<scale x="2.5" y="2.5"/>' if kind == "orthographic" else ""
        more = {"perspective": f'<float name="fov" value="{self.number(30, 70)}"/>'
                               f'<float name="principal_point_offset_x" value="{self.number(-0.1, 0.1)}"/>',
                "thinlens": f'<float name="fov" value="{self.number(30, 70)}"/><float name="aperture_radius" '
                            f'value="{self.number(0.02, 0.2)}"/><float name="focus_distance" '
                            f'value="{self.number(2, 6)}"/>',
                "orthographic": ""}[kind]
        return (f'<sensor type="{kind}">{more}<float name="near_clip" value="0.1"/><transform name="to_world">{scale}'
                f'<lookat origin="{self.number(-1, 1)}, {self.number(-0.5, 1.5)}, 5" target="{target}" up="0, 1, 0"/>'
                f'</transform><film type="hdrfilm"><integer name="width" value="{WIDTH}"/>'
                f'<integer name="height" value="{HEIGHT}"/><rfilter type="box"/></film></sensor>')

    def text(self):
        parts = [self.sensor()]
        # Mitsuba's path tracer counts holes of masks as edges of a path.
        max_depth = 32 if self.has_mask else self.random.randint(2, 7)
        parts.append(f'<integrator type="path"><integer name="max_depth" value="{max_depth}"/>'
                     f'<integer name="rr_depth" value="{self.random.choice([3, 1000])}"/>'
                     f'<boolean name="hide_emitters" value="{self.random.choice(["true", "false", "false"])}"/>'
                     '</integrator>')
        wall = f'<bsdf type="twosided">{self.one_of(OPAQUE)}</bsdf>'
        parts.append('<shape type="rectangle"><transform name="to_world"><scale x="4" y="4"/>'
                     f'<rotate x="1" angle="-90"/><translate y="-1.3"/></transform>{wall}</shape>')
        if self.random.random() < 0.5:
            parts.append('<shape type="rectangle"><transform name="to_world"><scale x="4" y="4"/>'
                         f'<translate z="-2"/></transform>{self.bsdf()}</shape>')
        if self.has_instances:
            inside = "".join(self.shape(self.bsdf()) for _ in range(self.random.randint(1, 2)))
            parts.append(f'<shape type="shapegroup" id="group">{inside}</shape>')
            for _ in range(self.random.randint(1, 3)):
                parts.append(f'<shape type="instance"><ref id="group"/>{self.transform(uniform=True)}</shape>')
        for _ in range(self.random.randint(1, 5)):
            parts.append(self.shape(self.bsdf()))
        emitters = [self.emitter() for _ in range(self.random.randint(1, 3))]
        around = [e for e in emitters if 'type="constant"' in e or 'type="envmap"' in e]
        for more in around[1:]:  # there is one environment at most
            emitters.remove(more)
        return '<scene version="3.0.0">\n' + "\n".join(parts + emitters) + "\n</scene>\n"


def rough(kind):
    def text(maker):
        distribution = maker.random.choice(["ggx", "beckmann"])
        if kind != "roughplastic" and maker.random.random() < 0.3:
            alpha = maker.scalar("alpha_u", 0.15, 0.6) + maker.scalar("alpha_v", 0.15, 0.6)
        else:
            alpha = f'<float name="alpha" value="{maker.number(0.1, 0.6)}"/>' if kind == "roughplastic" else \
                maker.scalar("alpha", 0.1, 0.6)
        metal = maker.random.choice(["Au", "Cu", "Al", "none"])
        more = {"roughconductor": f'<string name="material" value="{metal}"/>',
                "roughdielectric": f'<float name="int_ior" value="{maker.number(1.2, 2)}"/>',
                "roughplastic": maker.reflectance("diffuse_reflectance") +
                                f'<boolean name="nonlinear" value="{maker.random.choice(["true", "false"])}"/>'}[kind]
        return f'<bsdf type="{kind}"><string name="distribution" value="{distribution}"/>{alpha}{more}</bsdf>'

    return text


def principled(maker):
    inside = "".join(f'<float name="{name}" value="{maker.number(0, 1)}"/>'
                     for name in ("metallic", "specular", "spec_tint", "sheen", "sheen_tint", "clearcoat",
                                  "clearcoat_gloss", "flatness", "anisotropic") if maker.random.random() < 0.5)
    if maker.random.random() < 0.3:
        inside += f'<float name="spec_trans" value="{maker.number(0.1, 1)}"/>'
    return (f'<bsdf type="principled">{maker.reflectance("base_color")}{maker.scalar("roughness", 0.3, 0.9)}'
            f'{inside}</bsdf>')


def principledthin(maker):
    return (f'<bsdf type="principledthin">{maker.reflectance("base_color")}{maker.scalar("roughness", 0.3, 0.9)}'
            f'<float name="spec_trans" value="{maker.number(0, 1)}"/><float name="diff_trans" '
            f'value="{maker.number(0, 2)}"/></bsdf>')


def refraction(maker):
    return f'<float name="int_ior" value="{maker.number(1.1, 2)}"/>'


KINDS = {
    "diffuse": lambda maker: f'<bsdf type="diffuse">{maker.reflectance()}</bsdf>',
    "conductor": lambda maker: f'<bsdf type="conductor"><string name="material" value="none"/>'
                               f'{maker.plain("specular_reflectance", 0.2, 0.9)}</bsdf>',
    "dielectric": lambda maker: f'<bsdf type="dielectric">{refraction(maker)}</bsdf>',
    "thindielectric": lambda maker: f'<bsdf type="thindielectric">{refraction(maker)}</bsdf>',
    "plastic": lambda maker: f'<bsdf type="plastic">{maker.reflectance("diffuse_reflectance")}'
                             '<boolean name="nonlinear" '
                             f'value="{maker.random.choice(["true", "false"])}"/></bsdf>',
    "roughconductor": rough("roughconductor"),
    "roughdielectric": rough("roughdielectric"),
    "roughplastic": rough("roughplastic"),
    "principled": principled,
    "principledthin": principledthin,
}
OPAQUE = {"diffuse", "conductor", "plastic", "roughconductor", "roughplastic"}
BLENDED = {"diffuse", "roughconductor", "roughplastic", "principledthin"}


def blocks(numpy, image):
    """Means over blocks, and over all, by channel."""
    parts = image.reshape(HEIGHT // BLOCK, BLOCK, WIDTH // BLOCK, BLOCK, 3).mean(axis=(1, 3)).reshape(-1)
    return numpy.concatenate([parts, image.mean(axis=(0, 1))])


def images_by_mitsuba(mitsuba, numpy, path, spp, seeds):
    """Image after image, one of each seed."""
    scene = mitsuba.load_file(str(path))
    for seed in seeds:
        yield numpy.array(mitsuba.render(scene, spp=spp, seed=seed))[:, :, :3]


def images_by_gradus(mitsuba, numpy, arguments, path, method, spp, seeds):
    """The same of ours."""
    image = path.parent / "image.exr"
    for seed in seeds:
        command = [arguments.gradus, "render", str(path), "--method", method, "--spp", str(spp), "--seed", str(seed),
                   "-o", str(image), "--quiet"]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if done.returncode != 0:
            raise RuntimeError(f"gradus ended with {done.returncode}: {done.stderr.strip()[-500:]}")
        yield numpy.array(mitsuba.Bitmap(str(image)))[:, :, :3]


def means(numpy, images):
    """By image, blocks()."""
    return numpy.stack([blocks(numpy, image) for image in images]).astype(float)


def deviations(numpy, ours, theirs):
    """By block: in standard errors, and relative to the brighter one."""
    a, b = ours.mean(axis=0), theirs.mean(axis=0)
    variance = (ours.var(axis=0, ddof=1) + theirs.var(axis=0, ddof=1)) / SEEDS
    # A block that few samples of many reach has no spread to go by.
    error = numpy.sqrt(variance) + 1e-4 * numpy.maximum(numpy.abs(a), numpy.abs(b)) + 1e-7
    return (a - b) / error, (a - b) / numpy.maximum(numpy.maximum(numpy.abs(a), numpy.abs(b)), 1e-6)


def has_paths_of_photons_alone(scene):
    """Whether lights of no extent may be seen through smooth surfaces, where Mitsuba's paths do not find them."""
    def has(tag, kinds):
        return any(f'<{tag} type="{kind}"' in scene for kind in kinds)
    return (has("emitter", ("point", "spot", "directional", "projector")) and
            has("bsdf", ("conductor", "dielectric", "thindielectric", "plastic")))


def differs(mitsuba, numpy, arguments, path, method):
    """What of the image differs, in words; empty where nothing does."""
    def compared(spp, our_seed, their_seed):
        ours = images_by_gradus(mitsuba, numpy, arguments, path, method, spp, range(our_seed, our_seed + SEEDS))
        theirs = images_by_mitsuba(mitsuba, numpy, path, spp, range(their_seed, their_seed + SEEDS))
        return deviations(numpy, means(numpy, ours), means(numpy, theirs))

    first, _ = compared(SPP, 1, 1000)
    suspects = numpy.abs(first) > SUSPECTED
    if not suspects.any():
        return ""
    again, relative = compared(4 * SPP, 101, 2000)
    least = RADIUS_BIAS if method in PHOTON_METHODS else LEAST_DIFFERENCE
    worst = numpy.where(suspects & (again * first > 0) & (numpy.abs(relative) > least), numpy.abs(again), 0)
    if worst.max() < CONFIRMED:
        return ""
    at = int(worst.argmax())
    return (f"block {at // 3} channel {at % 3}: {first[at]:+.1f} and {again[at]:+.1f} standard errors, "
            f"{100 * relative[at]:+.2f} %; of the whole {again[-1]:+.1f}, {100 * relative[-1]:+.2f} %")


def made_scene(arguments, number, folder):
    """Mitsuba and numpy, which only its Python needs to have, and the text of the scene; its files are in the folder."""
    mitsuba = mitsuba_setup.start_mitsuba(arguments)
    import numpy

    mitsuba.set_log_level(mitsuba.LogLevel.Error)
    folder.mkdir(parents=True, exist_ok=True)
    return mitsuba, numpy, Maker(number, folder, mitsuba).text()


def compare_scene(arguments, number, folder):
    """What differs of scene `number`, in words, by method; None of one that cannot be compared there."""
    mitsuba, numpy, text = made_scene(arguments, number, folder)
    path = folder / "scene.xml"
    path.write_text(text, encoding="utf-8")
    found = {}
    for method in arguments.method:
        try:
            found[method] = (None if method in PHOTON_METHODS and has_paths_of_photons_alone(text) else
                             differs(mitsuba, numpy, arguments, path, method))
        except RuntimeError as error:
            found[method] = str(error)
    return found


def add_scene_options(parser, scenes):
    """Those of which scenes are rendered by what."""
    parser.add_argument("--scenes", type=int, default=scenes)
    parser.add_argument("--first", type=int, default=0, help="number of the first scene")
    parser.add_argument("--method", nargs="+", default=["pt"])
    parser.add_argument("--gradus", default=str(ROOT / "build" / "gradus"))
    parser.add_argument("--json", help="write what was found to this file")
    parser.add_argument("--one", help=argparse.SUPPRESS)  # the first scene alone, in this folder, as JSON
    mitsuba_setup.add_mitsuba_options(parser)
    parser.set_defaults(variant="scalar_rgb")


def python_for_answers(arguments, compare):
    """A Python that has Mitsuba. None where this process is to answer for one scene, which it has done then, or where
    there is none, which is said."""
    if arguments.one:
        print(json.dumps(compare(arguments, arguments.first, pathlib.Path(arguments.one))))
        return None
    python = find_python(["mitsuba"], mitsuba_setup.PYTHON_VARIABLE)
    if not python:
        print(f"skipped: {mitsuba_setup.HOW_TO_GET}")
    return python


def answers(script, python, arguments, folder_of, options=()):
    """Scene after scene, its number and what the script says of it alone, in a process each: some scenes end Mitsuba's.
    Those without an answer are named and left out."""
    for number in range(arguments.first, arguments.first + arguments.scenes):
        command = [python, script, "--one", str(folder_of(number)), "--first", str(number), "--gradus",
                   arguments.gradus, "--variant", arguments.variant, "--method", *arguments.method, *options]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if done.returncode == 0:
            yield number, json.loads(done.stdout.strip().splitlines()[-1])
        else:
            print(f"scene {number}: no answer: {done.stderr.strip()[-200:] or done.returncode}", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    add_scene_options(parser, 20)
    parser.add_argument("--keep", help="folder of the scenes (default: a temporary one)")
    arguments = parser.parse_args()
    python = python_for_answers(arguments, compare_scene)
    if not python:
        return 0
    folder = pathlib.Path(arguments.keep or tempfile.mkdtemp(prefix="gradus-scenes-"))
    records, differing, compared = [], 0, 0
    for number, found in answers(__file__, python, arguments, lambda number: folder / str(number)):
        records.append({"scene": number, "found": found})
        differing += any(found.values())
        compared += any(difference is not None for difference in found.values())
        for method, difference in found.items():
            outcome = "left out: photons alone find some of its light" if difference is None else difference or "agrees"
            print(f"scene {number}: {method}: {outcome}", flush=True)
    print(f"{differing} of {compared} scenes differ")
    if arguments.json:
        pathlib.Path(arguments.json).write_text(json.dumps(records, indent=1), encoding="utf-8")
    if differing or arguments.keep:
        print(f"they are in {folder}")
    else:
        shutil.rmtree(folder)
    without_answer = arguments.scenes - len(records)
    if compared == 0 or without_answer > MOST_WITHOUT_ANSWER * arguments.scenes:
        print(f"too little was compared: {compared} of {arguments.scenes} scenes, {without_answer} without an answer")
        return 1
    return 1 if differing else 0


if __name__ == "__main__":
    sys.exit(main())
