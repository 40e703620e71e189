"""A second OpenCL implementation beside PoCL, where it can be had: a GPU's, or Intel's for the CPU.

A GPU's driver that is installed is seen as it is. Intel's comes from the packages intel-opencl-rt and
intel-cmplr-lib-rt in a Python virtual environment: GRADUS_SECOND_ICD names that environment, or a folder with an .icd
file of any other implementation.
"""

import json
import os
import pathlib
import subprocess

VENDORS = pathlib.Path("/etc/OpenCL/vendors")

HOW_TO_GET = """There is no second OpenCL implementation. To get Intel's CPU runtime:
    python3 -m venv opencl-venv && opencl-venv/bin/pip install intel-opencl-rt intel-cmplr-lib-rt
    export GRADUS_SECOND_ICD=opencl-venv"""


def environment(folder):
    """The environment in which programs see both implementations, or None. `folder` is for files made on the way."""
    named = os.environ.get("GRADUS_SECOND_ICD")
    if not named or not pathlib.Path(named).is_dir():
        return dict(os.environ) if len(list(VENDORS.glob("*.icd"))) > 1 else None
    source, folder = pathlib.Path(named).resolve(), pathlib.Path(folder)
    vendors, libraries = folder / "vendors", folder / "libraries"
    vendors.mkdir(parents=True)
    libraries.mkdir()
    for icd in VENDORS.glob("*.icd"):
        (vendors / icd.name).write_text(icd.read_text())
    runtime = source / "lib" / "libintelocl.so"
    found = {**os.environ, "OCL_ICD_VENDORS": str(vendors)}
    if runtime.exists():
        (vendors / "second.icd").write_text(f"{runtime}\n")
        # All of its libraries but its OpenCL loader, which would hide the system's.
        for library in runtime.parent.iterdir():
            if library.is_file() and not library.name.startswith("libOpenCL"):
                (libraries / library.name).symlink_to(library)
        paths = [str(libraries)] + ([os.environ["LD_LIBRARY_PATH"]] if os.environ.get("LD_LIBRARY_PATH") else [])
        found["LD_LIBRARY_PATH"] = ":".join(paths)
        return found
    icds = list(source.glob("*.icd"))
    for icd in icds:
        (vendors / icd.name).write_text(icd.read_text())
    return found if icds else None


def selector(gradus, environment):
    """What --device takes for it: its platform's name; None where `gradus devices` does not see it."""
    listed = json.loads(subprocess.run([gradus, "devices", "--json"], env=environment, check=True, capture_output=True,
                                       text=True).stdout)
    return next((device["platform"] for device in listed if "Portable Computing" not in device["platform"]), None)
