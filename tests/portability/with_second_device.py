#!/usr/bin/env python3
"""Runs a test program where it sees a second OpenCL implementation beside the default one.

    GRADUS_SECOND_ICD=... python3 tests/portability/with_second_device.py PROGRAM [ARGUMENT ...]

Exits with 77, for skipped, where there is none; bench/render/second_device.py says how to get one.
"""

import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
sys.path.insert(0, str(ROOT / "bench" / "render"))
import second_device  # noqa: E402

SKIPPED = 77


def main():
    with tempfile.TemporaryDirectory() as folder:
        environment = second_device.environment(folder)
        if environment is None:
            print(f"skipped. {second_device.HOW_TO_GET}")
            sys.exit(SKIPPED)
        sys.exit(subprocess.run(sys.argv[1:], env=environment).returncode)


if __name__ == "__main__":
    main()
