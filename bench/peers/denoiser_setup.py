"""Open Image Denoise for the scripts that use it, from the Python packages pyoidn and OpenEXR."""

PYTHON_VARIABLE = "GRADUS_DENOISER_PYTHON"
MODULES = ["pyoidn", "OpenEXR"]

HOW_TO_GET = """Open Image Denoise is not at hand for this Python. To get it, in a virtual environment:
    python3 -m venv denoiser-venv && denoiser-venv/bin/pip install pyoidn OpenEXR
Then run this script with that Python, or name it in GRADUS_DENOISER_PYTHON."""
