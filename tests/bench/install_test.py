#!/usr/bin/env python3
"""bench/peers/install.py without a network: what is there is left alone, what is not is said and is no error."""

import contextlib
import io
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest
from unittest import mock

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
sys.path.insert(0, str(ROOT / "bench" / "peers"))
import install  # noqa: E402
import mitsuba_setup  # noqa: E402
import pythons  # noqa: E402

VARIABLES = [variable for _, _, _, variable, _ in install.PARTS]
MODULES = [module for _, modules, *_ in install.PARTS for module in modules]


class Install(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.build = pathlib.Path(folder.name)
        clean = {name: value for name, value in os.environ.items() if name not in [*VARIABLES, "DRJIT_LIBLLVM_PATH"]}
        patch = mock.patch.dict(os.environ, {**clean, "PIP_NO_INDEX": "1"}, clear=True)
        patch.start()
        self.addCleanup(patch.stop)
        # Neither this Python nor the build folder of the project has any of it.
        patch = mock.patch.object(install, "find_python", return_value=None)
        patch.start()
        self.addCleanup(patch.stop)

    def install(self, llvm=None):
        printed = io.StringIO()
        with contextlib.redirect_stdout(printed), mock.patch.object(mitsuba_setup, "find_llvm", return_value=llvm):
            return install.install(self.build), printed.getvalue()

    def make_environment_with(self, modules):
        python = pythons.bench_python(self.build)
        subprocess.run([sys.executable, "-m", "venv", "--without-pip", python.parent.parent], check=True)
        packages = subprocess.run([python, "-c", "import site; print(site.getsitepackages()[0])"], check=True, text=True,
                                  capture_output=True).stdout.strip()
        for module in modules:
            (pathlib.Path(packages) / f"{module}.py").write_text("")
        return python

    def test_without_a_network_each_part_is_skipped_with_its_reason(self):
        skipped, _ = self.install()
        self.assertEqual(len(skipped), len(install.PARTS))
        for line, (title, *_) in zip(skipped, install.PARTS):
            self.assertRegex(line, f"^skipped: {title}: .+")
        self.assertFalse(set(VARIABLES) & set(os.environ))

    def test_what_is_there_is_left_alone_and_named(self):
        python = self.make_environment_with(MODULES)
        with mock.patch.object(install, "attempt", side_effect=AssertionError("nothing is to be done")):
            skipped, printed = self.install(llvm="/a/libLLVM.so.19")
        self.assertEqual((skipped, printed), ([], ""))
        self.assertEqual({os.environ[variable] for variable in VARIABLES}, {str(python)})
        self.assertEqual(os.environ["DRJIT_LIBLLVM_PATH"], "/a/libLLVM.so.19")

    def test_a_python_that_is_named_stays(self):
        for variable in VARIABLES:
            os.environ[variable] = "/named"
        with mock.patch.object(install, "attempt", side_effect=AssertionError("nothing is to be done")):
            self.assertEqual(self.install(), ([], ""))
        self.assertEqual({os.environ[variable] for variable in VARIABLES}, {"/named"})

    def test_mitsuba_without_llvm_is_skipped(self):
        self.make_environment_with(MODULES)
        with mock.patch.object(install, "attempt", return_value="no network"):
            self.assertEqual(self.install()[0], ["skipped: Mitsuba 3: no libllvm19: no network"])


class Programs(unittest.TestCase):
    def test_none_of_them_is_an_error_that_names_it(self):
        for program in (["report", "--quick"], ["run"]):
            with tempfile.TemporaryDirectory() as folder:
                command = [sys.executable, ROOT / "bench" / program[0], *program[1:], "--no-install", "--no-build",
                           "--build", folder]
                result = subprocess.run(command, capture_output=True, text=True)
            self.assertNotEqual(result.returncode, 0)
            self.assertIn(f"{folder}/gradus: no such program", result.stderr)


class FindPython(unittest.TestCase):
    def find(self, modules, **options):
        return pythons.find_python(modules, "GRADUS_SOME_PYTHON", **options)

    def test_what_is_given_alone_counts(self):
        with mock.patch.dict(os.environ, {"GRADUS_SOME_PYTHON": "/none"}):
            self.assertIsNone(self.find(["json"]))
            self.assertEqual(self.find(["json"], named=sys.executable), sys.executable)

    def test_else_the_first_that_has_the_modules(self):
        with mock.patch.object(pythons, "bench_python", return_value="/none"):
            self.assertEqual(self.find(["json"], others=["/none either"]), sys.executable)
            self.assertIsNone(self.find(["no_such_module"]))
        with mock.patch.object(pythons, "bench_python", return_value="/usr/bin/env"):
            with mock.patch.object(pythons, "has_modules", side_effect=lambda python, _: python != sys.executable):
                self.assertEqual(self.find(["json"]), "/usr/bin/env")


if __name__ == "__main__":
    unittest.main()
