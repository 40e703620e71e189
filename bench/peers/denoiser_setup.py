"""Open Image Denoise for the scripts that use it, from the Python packages pyoidn and OpenEXR."""

import pathlib
import subprocess

PYTHON_VARIABLE = "GRADUS_DENOISER_PYTHON"
MODULES = ["pyoidn", "OpenEXR"]

HOW_TO_GET = """Open Image Denoise is not at hand for this Python. To get it into the build folder:
    python3 bench/peers/install.py
Or run this script with a Python that has pyoidn and OpenEXR, or name it in GRADUS_DENOISER_PYTHON."""


def library_of(python):
    """The file of the denoiser that this Python's package has."""
    script = "import pathlib, pyoidn; print(pathlib.Path(pyoidn.__file__).parent / 'oidn' / 'lib')"
    folder = subprocess.run([python, "-c", script], capture_output=True, text=True, check=True).stdout.strip()
    return pathlib.Path(folder) / "libOpenImageDenoise.so.2"
