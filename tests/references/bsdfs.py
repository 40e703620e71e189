#!/usr/bin/env python3
"""Writes bsdfs.txt: what Mitsuba 3's BSDFs are for some pairs of directions, to hold ours against.

A line `bsdf XML` begins a material; each line after it is wi, wo and f |cos wo| of radiance, nine numbers. Of smooth
materials, whose lobes no pair meets, it is the lobe's weight times its probability. Directions are unit vectors in the
local frame.

    PYTHON-WITH-MITSUBA tests/references/bsdfs.py
"""

import argparse
import math
import pathlib
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent.parent / "bench" / "peers"))
import mitsuba_setup  # noqa: E402


def number(name, value):
    return f'<float name="{name}" value="{value}"/>'


def color(name, *value):
    return f'<rgb name="{name}" value="{", ".join(map(str, value))}"/>'


RED = color("diffuse_reflectance", 0.7, 0.3, 0.1)
BASE = color("base_color", 0.8, 0.4, 0.15)
NONLINEAR = '<boolean name="nonlinear" value="true"/>'
GGX = '<string name="distribution" value="ggx"/>'
ALL = "".join(number(name, value) for name, value in (
    ("roughness", 0.45), ("metallic", 0.3), ("specular", 0.7), ("spec_tint", 0.4), ("sheen", 0.5), ("sheen_tint", 0.6),
    ("flatness", 0.35), ("clearcoat", 0.8), ("clearcoat_gloss", 0.3), ("anisotropic", 0.6)))

# type, what is inside, whether both sides matter
MATERIALS = [
    ("plastic", "", False),
    ("plastic", RED + NONLINEAR + number("int_ior", 1.9), False),
    ("roughplastic", "", False),
    ("roughplastic", RED + GGX + number("alpha", 0.2), False),
    ("roughplastic", RED + NONLINEAR + number("alpha", 0.4) + number("int_ior", 1.8), False),
    ("roughplastic", RED + GGX + NONLINEAR + number("alpha", 0.05) + color("specular_reflectance", 0.2, 0.5, 0.9), False),
    ("thindielectric", color("specular_transmittance", 0.5, 0.75, 1), True),
    ("principled", "", False),
    ("principled", BASE + number("roughness", 0.3), False),
    ("principled", BASE + number("metallic", 1) + number("roughness", 0.5), False),
    ("principled", BASE + number("flatness", 1) + number("sheen", 1), False),
    ("principled", BASE + number("clearcoat", 1) + number("clearcoat_gloss", 0.2), False),
    ("principled", BASE + ALL, False),
    ("principled", BASE + number("spec_trans", 1) + number("eta", 1.33) + number("roughness", 0.6), True),
    ("principled", BASE + ALL + number("spec_trans", 0.6), True),
    ("principledthin", BASE, True),
    ("principledthin", BASE + number("spec_trans", 0.7) + number("diff_trans", 1.2) + number("eta", 1.4), True),
    ("principledthin", BASE + "".join(number(*pair) for pair in (
        ("roughness", 0.6), ("anisotropic", 0.5), ("spec_trans", 0.4), ("spec_tint", 0.7), ("sheen", 0.6),
        ("sheen_tint", 0.3), ("flatness", 0.5), ("diff_trans", 0.8))), True),
]


def unit(angle, azimuth):
    theta, phi = math.radians(angle), math.radians(azimuth)
    return (math.sin(theta) * math.cos(phi), math.sin(theta) * math.sin(phi), math.cos(theta))


def pairs(both_sides):
    """Directions from near the pole to near the horizon, in the plane of incidence and out of it."""
    for angle in (8, 35, 62, 80) + ((118, 155) if both_sides else ()):
        for other, turn in ((5, 20), (30, 175), (50, 180), (58, 230), (70, 90), (79, 184)):
            yield unit(angle, 33), unit(other, 33 + turn)
            if both_sides:
                yield unit(angle, 33), unit(180 - other, 33 + turn)


def main():
    parser = argparse.ArgumentParser(description="writes bsdfs.txt")
    parser.add_argument("--output", type=pathlib.Path, default=HERE / "bsdfs.txt")
    mitsuba_setup.add_mitsuba_options(parser)
    arguments = parser.parse_args()
    mitsuba = mitsuba_setup.start_mitsuba(arguments)
    lines = [f"# by bsdfs.py with Mitsuba {mitsuba.__version__}"]
    for kind, inside, both_sides in MATERIALS:
        bsdf = mitsuba.load_string(f'<bsdf version="3.0.0" type="{kind}">{inside}</bsdf>')
        lines.append(f'bsdf <bsdf type="{kind}">{inside}</bsdf>')
        for wi, wo in pairs(both_sides):
            interaction = mitsuba.SurfaceInteraction3f()
            interaction.wi = wi
            context = mitsuba.BSDFContext()
            if kind == "thindielectric":
                reflects = wi[2] * wo[2] > 0
                sample, weight = bsdf.sample(context, interaction, 0 if reflects else 1, [0.5, 0.5])
                wo = [float(sample.wo[axis].numpy()[0]) for axis in range(3)]
                value = weight * sample.pdf
            else:
                value = bsdf.eval(context, interaction, wo)
            value = [float(value[channel].numpy()[0]) for channel in range(3)]
            lines.append(" ".join(f"{x:.7g}" for x in (*wi, *wo, *value)))
    arguments.output.write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
