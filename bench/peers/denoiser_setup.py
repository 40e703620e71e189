"""Open Image Denoise for the scripts that use it, from the Python packages pyoidn and OpenEXR."""

PYTHON_VARIABLE = "GRADUS_DENOISER_PYTHON"
MODULES = ["pyoidn", "OpenEXR"]

HOW_TO_GET = """Open Image Denoise is not at hand for this Python. To get it into the build folder:
    python3 bench/peers/install.py
Or run this script with a Python that has pyoidn and OpenEXR, or name it in GRADUS_DENOISER_PYTHON."""
