"""Finds the Python that has what a peer needs."""

import os
import subprocess
import sys


def find_python(modules, variable, named=None):
    """The named Python, that of the environment variable, or this one; None where it lacks one of the modules."""
    python = named or os.environ.get(variable) or sys.executable
    try:
        probe = subprocess.run([python, "-c", f"import {', '.join(modules)}"], capture_output=True, timeout=120)
    except (OSError, subprocess.TimeoutExpired):
        return None
    return python if probe.returncode == 0 else None
