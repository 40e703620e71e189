"""Starts Mitsuba 3 for the scripts that use it: those of this folder and tests/references/make.py."""

import glob
import os
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
PYTHON_VARIABLE = "GRADUS_MITSUBA_PYTHON"

HOW_TO_GET = """Mitsuba 3 is not at hand for this Python. To get it into the build folder:
    python3 bench/peers/install.py
Or name a Python that has it in GRADUS_MITSUBA_PYTHON or with --python; its llvm variants need LLVM 19 or later."""


def find_llvm(own=ROOT / "build" / "bench" / "llvm"):
    """The path of the newest libLLVM of version 19 or later, or None. Older ones fail on machines with AVX-512. The
    folder is where install.py unpacks Debian's."""
    candidates = []
    for pattern in (f"{own}/usr/lib/*/libLLVM*.so*", "/usr/lib/*/libLLVM*.so*", "/usr/lib/llvm-*/lib/libLLVM*.so*",
                    "/usr/local/lib/libLLVM*.so*"):
        for path in glob.glob(pattern):
            version = re.search(r"libLLVM(?:-|\.so\.)(\d+)", os.path.basename(path))
            if version and int(version.group(1)) >= 19:
                candidates.append((int(version.group(1)), path))
    return max(candidates)[1] if candidates else None


def add_mitsuba_options(parser):
    """The options that start_mitsuba() takes."""
    parser.add_argument("--variant", default="llvm_ad_rgb")
    parser.add_argument("--llvm", help="path of libLLVM (default: DRJIT_LIBLLVM_PATH, then the newest found)")


def start_mitsuba(arguments):
    """Imports Mitsuba and sets its variant. Ends the program where Mitsuba is missing, and says how to get it."""
    llvm = arguments.llvm or os.environ.get("DRJIT_LIBLLVM_PATH") or find_llvm()
    if llvm:
        os.environ["DRJIT_LIBLLVM_PATH"] = str(llvm)
    try:
        import mitsuba

        mitsuba.set_variant(arguments.variant)
    except ImportError:
        sys.exit(HOW_TO_GET)
    return mitsuba


def load_scene(mitsuba, path, **parameters):
    """Loads a scene file with parameters, each given as $name in the file; names that it lacks are left out.

    Mitsuba 3.9 reads files of version 0.6, but for the spelling lookAt: such a file is given to it as a string, with
    that one tag respelt. It must then not name any file beside it."""
    text = pathlib.Path(path).read_text(encoding="utf-8")
    known = set(re.findall(r'<default\s+name="([^"]+)"', text))
    given = {name: str(value) for name, value in parameters.items() if name in known}
    if "<lookAt" in text:
        if 'name="filename"' in text:
            raise ValueError(f"{path}: uses lookAt and names other files; Mitsuba 3 cannot be given both")
        return mitsuba.load_string(text.replace("<lookAt", "<lookat"), **given)
    return mitsuba.load_file(str(path), **given)


def load_scene_at_size(mitsuba, path, width, height, **parameters):
    """load_scene() with a film of that size, whether or not the file has the parameters resx and resy."""
    scene = load_scene(mitsuba, path, resx=width, resy=height, **parameters)
    sensor = scene.sensors()[0]
    if tuple(sensor.film().size()) != (width, height):
        # update() resizes the film's buffers and the projection.
        film = mitsuba.traverse(sensor)
        film["film.size"] = [width, height]
        film.update()
    if tuple(sensor.film().crop_size()) != (width, height):
        raise ValueError(f"{path}: cannot be rendered at {width}x{height}")
    return scene
