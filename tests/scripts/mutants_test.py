#!/usr/bin/env python3
"""tests/mutants/run.py plants its defects in a copy of the sources, without what any preset has built."""

import pathlib
import subprocess
import sys
import tempfile
import unittest
from unittest import mock

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "mutants"))
import run  # noqa: E402


class Copy(unittest.TestCase):
    def test_sources_are_copied_and_builds_are_not(self):
        with tempfile.TemporaryDirectory() as name:
            root = pathlib.Path(name)
            for folder in ("driver", "bench", "build", "build-asan", "build-dev", "build-fuzz", ".git", ".cache"):
                (root / folder).mkdir()
            (root / "CMakeLists.txt").touch()
            done = subprocess.CompletedProcess([], 0, "", "")
            with mock.patch.object(run, "ROOT", root), \
                    mock.patch.object(run.subprocess, "run", return_value=done) as called:
                run.make_copy([])
        copied = {call.args[0][-2].name for call in called.call_args_list if call.args[0][0] == "cp"}
        self.assertEqual(copied, {"driver", "bench", "CMakeLists.txt"})


if __name__ == "__main__":
    unittest.main()
