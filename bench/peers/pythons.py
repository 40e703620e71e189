"""Finds the Python that has what a bench needs."""

import os
import pathlib
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent


def bench_python(build=ROOT / "build"):
    """The Python of the virtual environment that install.py makes."""
    return pathlib.Path(build) / "bench" / "python" / "bin" / "python"


def has_modules(python, modules):
    try:
        probe = subprocess.run([python, "-c", f"import {', '.join(modules)}"], capture_output=True, timeout=120)
    except (OSError, subprocess.TimeoutExpired):
        return False
    return probe.returncode == 0


def find_python(modules, variable, named=None, others=()):
    """The named Python, else that of the environment variable; only where neither is given, the first of install.py's,
    this one and others that has the modules. None where there is none."""
    given = named or os.environ.get(variable)
    for python in [given] if given else [str(bench_python()), sys.executable, *others]:
        if has_modules(python, modules):
            return python
    return None
