#!/usr/bin/env python3
"""Gets what the benches take beside our own programs: matplotlib, Mitsuba 3 and Open Image Denoise, as Python packages
in a virtual environment of the build folder, and the LLVM that Mitsuba needs, from Debian's package, beside it.

    python3 bench/peers/install.py [BUILD]

What is there already is left as it is. What cannot be had is said, and is no error: its charts and rows are skipped.
Nothing outside the build folder changes. bench/report and bench/run call this first.
"""

import argparse
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent / "charts")]
import denoiser_setup  # noqa: E402
import mitsuba_setup  # noqa: E402
import plotting  # noqa: E402
from pythons import ROOT, bench_python, find_python, has_modules  # noqa: E402

# title, modules to import, packages that bring them, variable that names another Python, other Pythons to ask
PARTS = [
    ("charts", ["matplotlib"], ["matplotlib"], plotting.PYTHON_VARIABLE, plotting.OTHER_PYTHONS),
    ("Mitsuba 3", ["mitsuba"], ["mitsuba"], mitsuba_setup.PYTHON_VARIABLE, []),
    ("Open Image Denoise", denoiser_setup.MODULES, ["pyoidn", "OpenEXR"], denoiser_setup.PYTHON_VARIABLE, []),
]
LLVM_PACKAGE = "libllvm19"


def attempt(command, **options):
    """None, or why the command failed: the last line that it printed."""
    try:
        result = subprocess.run([str(part) for part in command], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                                stderr=subprocess.STDOUT, text=True, **options)
    except OSError as error:
        return str(error)
    lines = result.stdout.strip().splitlines()
    return None if result.returncode == 0 else (lines[-1] if lines else f"{command[0]} exits with {result.returncode}")


def make_environment(python):
    if python.exists() and attempt([python, "-m", "pip", "--version"]) is None:
        return None
    shutil.rmtree(python.parent.parent, ignore_errors=True)  # half of one, of an earlier run
    return attempt([sys.executable, "-m", "venv", python.parent.parent])


def install_llvm(build):
    """None, or why there is no LLVM that Mitsuba can take."""
    folder = build / "bench" / "llvm"
    if os.environ.get("DRJIT_LIBLLVM_PATH") or mitsuba_setup.find_llvm(folder):
        return None
    print(f"getting {LLVM_PACKAGE}", flush=True)
    with tempfile.TemporaryDirectory() as downloads:
        failed = attempt(["apt-get", "download", LLVM_PACKAGE], cwd=downloads)
        packages = list(pathlib.Path(downloads).glob("*.deb"))
        if failed or not packages:
            return f"no {LLVM_PACKAGE}: {failed or 'nothing came'}"
        return attempt(["dpkg-deb", "--extract", packages[0], folder])


def install(build):
    """Gets what is missing, and names in the environment what is in another build folder than build/. Returns what
    could not be had, as lines of text."""
    build = build.absolute()
    python, skipped = bench_python(build), []
    for title, modules, packages, variable, others in PARTS:
        if os.environ.get(variable):
            continue  # its owner's matter
        if not has_modules(python, modules) and not find_python(modules, variable, others=others):
            print(f"getting {', '.join(packages)}", flush=True)
            # Without a network it gives up in seconds.
            failed = make_environment(python) or attempt([python, "-m", "pip", "install", "--quiet", "--retries", 1,
                                                          "--timeout", 15, "--disable-pip-version-check", *packages])
            if failed:
                skipped.append(f"skipped: {title}: {failed}")
                continue
        if has_modules(python, modules):
            os.environ[variable] = str(python)
        if title == "Mitsuba 3":
            failed = install_llvm(build)
            if failed:
                skipped.append(f"skipped: {title}: {failed}")
            elif mitsuba_setup.find_llvm(build / "bench" / "llvm"):
                os.environ.setdefault("DRJIT_LIBLLVM_PATH", mitsuba_setup.find_llvm(build / "bench" / "llvm"))
    return skipped


def prepare(build, programs, with_install=True, with_build=True):
    """What bench/report and bench/run do before they measure: Debian's packages, our own programs, the rivals. Ends
    the program where one of ours is missing."""
    if with_install:
        subprocess.run([ROOT / "scripts" / "install_dependencies.sh", "--bench"], stdin=subprocess.DEVNULL)
    if with_build:
        command = ([ROOT / "scripts" / "build.sh", *programs] if build.resolve() == ROOT / "build" else
                   ["cmake", "--build", build, "--parallel", str(os.cpu_count()), "--target", *programs])
        if subprocess.run(command, stdin=subprocess.DEVNULL).returncode != 0:
            sys.exit("the programs could not be built")
    for name in programs:
        if not (build / name).exists():
            sys.exit(f"{build / name}: no such program; leave out --no-build")
    for line in install(build) if with_install else []:
        print(line, flush=True)


def main():
    parser = argparse.ArgumentParser(description="gets what the benches take beside our own programs")
    parser.add_argument("build", nargs="?", type=pathlib.Path, default=ROOT / "build", help="the build folder")
    print("\n".join(install(parser.parse_args().build)) or "All that the benches take is there.")


if __name__ == "__main__":
    main()
