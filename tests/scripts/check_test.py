#!/usr/bin/env python3
"""./check with programs that only say how they were called: what fails it, and the summary of --full; ./demo and
scripts/fuzz.sh alike."""

import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent

# Stands for all programs. ctest writes the results of two tests, of which B is skipped.
STUB = f"""#!/bin/sh
case "$1" in *check_skips.py) exec '{sys.executable}' "$@" ;; esac
call="$(basename "$0") $*"
echo "[$call]"
case "$call" in
ctest*)
    echo '<testsuite><testcase name="A" status="run"/><testcase name="B" status="notrun"><skipped message="no B"/>
        </testcase></testsuite>' >"$2/check.xml" ;;
*devices.py*) echo "skipped: no second OpenCL implementation" ;;
*convergence.py*) echo "mitsuba: skipped, no Mitsuba" ;;
esac
case "$call" in $FAILS) exit 8 ;; esac
"""


MKTEMP = f"""#!/bin/sh
case mktemp in $FAILS) exit 8 ;; esac
exec '{shutil.which("mktemp")}' "$@"
"""


def write_program(path, text):
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text)
    path.chmod(0o755)


class Check(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        for name in ("scripts", "programs", "tests", "build", "build-asan"):
            (self.folder / name).mkdir()
        for name in ("check", "scripts/check_skips.py"):
            shutil.copy(ROOT / name, self.folder / name)
        for name in ("demo", "scripts/build.sh", "scripts/fuzz.sh", "scripts/install_dependencies.sh", *(
                f"programs/{program}" for program in ("cmake", "ctest", "python3"))):
            write_program(self.folder / name, STUB)
        write_program(self.folder / "programs" / "mktemp", MKTEMP)

    def check(self, *arguments, expected="always: B\n", fails="nothing"):
        (self.folder / "tests" / "expected_skips.txt").write_text(expected)
        path = f"{self.folder / 'programs'}:{os.environ['PATH']}"
        return subprocess.run([self.folder / "check", *arguments], capture_output=True, text=True,
                              env={**os.environ, "PATH": path, "FAILS": fails})

    def test_passes_and_prints_what_was_skipped(self):
        result = self.check()
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
        self.assertIn("[install_dependencies.sh ]", result.stdout)
        self.assertIn("--label-exclude ^full$]", result.stdout)
        self.assertTrue(result.stdout.endswith("1 cases ran, 1 were skipped:\n  B: no B\n"), result.stdout)

    def test_fails_with_any_part(self):
        for fails in ("install*", "build.sh*", "demo*", "ctest*"):
            self.assertNotEqual(self.check(fails=fails).returncode, 0, fails)
        self.assertNotEqual(self.check(expected="").returncode, 0)
        self.assertNotEqual(self.check(expected="always: B\nalways: A\n").returncode, 0)
        self.assertEqual(self.check("--unknown").returncode, 2)

    def test_installs_nothing_where_it_is_told(self):
        self.assertEqual(self.check("--no-install", fails="install*").returncode, 0)

    def summary(self, **options):
        result = self.check("--full", expected="full: B\nno full: B\n", **options)
        lines = result.stdout.split("== Summary\n")[1].splitlines()
        return result.returncode, dict(line.split("s  ", 1)[1].split(": ", 1) for line in lines)

    def test_full_runs_all_and_says_what_it_skipped(self):
        code, summary = self.summary()
        self.assertEqual(code, 0)
        self.assertEqual(summary, {
            "all tests, slow ones too": "SKIPPED: 1 were skipped",
            "tests under the sanitizers": "SKIPPED: 1 were skipped",
            "tests under the sanitizers that open a device": "SKIPPED: 1 were skipped",
            "planted defects": "passed",
            "what rows of the stability page would see": "passed",
            "readers of files, fuzzed for a minute each": "passed",
            "the demo with empty caches": "passed",
            "a second OpenCL implementation": "SKIPPED: no second OpenCL implementation",
            "Mitsuba 3": "passed",
            "random scenes beside Mitsuba 3": "passed",
            "error against time, with rivals": "SKIPPED: no Mitsuba"})
        self.assertEqual(list(self.folder.glob("build/empty-caches*")), [])

    def test_full_goes_on_after_a_failure(self):
        for fails, part in (("cmake --build*", "tests under the sanitizers"), ("*compare.py*", "Mitsuba 3"),
                            ("fuzz.sh*", "readers of files, fuzzed for a minute each"), ("*run.py*", "planted defects"),
                            ("mktemp*", "the demo with empty caches"),
                            ("ctest*Stability*", "tests under the sanitizers that open a device")):
            code, summary = self.summary(fails=fails)
            self.assertEqual(code, 1)
            self.assertEqual([title for title, outcome in summary.items() if outcome == "FAILED"], [part])


class Usage(unittest.TestCase):
    """Of scripts that begin with their usage: nothing is started, for no program is in the path but these."""

    def run_script(self, folder, name, *arguments):
        for program in ("bash", "sed", "dirname"):
            if not (folder / program).exists():
                (folder / program).symlink_to(shutil.which(program))
        return subprocess.run([shutil.which("bash"), ROOT / "scripts" / name, *arguments], capture_output=True,
                              text=True, env={"PATH": str(folder)}, cwd=folder)

    def test_is_told_and_unknown_words_are_refused(self):
        with tempfile.TemporaryDirectory() as name:
            for script, unknown in (("build.sh", "--target"), ("fuzz.sh", "png"), ("install_dependencies.sh", "bench")):
                told = self.run_script(pathlib.Path(name), script, "--help")
                self.assertEqual((told.returncode, told.stderr), (0, ""), script)
                self.assertIn(f"\n  scripts/{script} [", told.stdout)
                self.assertNotIn("set -euo", told.stdout)
                refused = self.run_script(pathlib.Path(name), script, unknown)
                self.assertEqual((refused.returncode, refused.stdout), (2, ""), script)
                self.assertEqual(refused.stderr, told.stdout)

    def test_packages_are_listed_in_any_order_of_the_words(self):
        with tempfile.TemporaryDirectory() as name:
            one, other = (self.run_script(pathlib.Path(name), "install_dependencies.sh", *words).stdout
                          for words in (("--bench", "--list"), ("--list", "--bench")))
            self.assertIn("python3-venv", one)
            self.assertEqual(one, other)


class Scripts(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        for name in ("demo", "scripts/fuzz.sh"):
            (self.folder / name).parent.mkdir(exist_ok=True)
            shutil.copy(ROOT / name, self.folder / name)
        for program in ("scripts/build.sh", "programs/cmake", "programs/clang++"):
            write_program(self.folder / program, "#!/bin/sh\n")

    def run_script(self, *command, **environment):
        path = f"{self.folder / 'programs'}:{os.environ['PATH']}"
        clean = {name: value for name, value in os.environ.items() if name != "GRADUS_CACHE_DIR"}
        return subprocess.run([self.folder / command[0], *command[1:]], capture_output=True, text=True,
                              env={**clean, "PATH": path, **environment})

    def test_the_demo_keeps_programs_where_it_is_told(self):
        write_program(self.folder / "build" / "gradus", '#!/bin/sh\necho "cache: $GRADUS_CACHE_DIR."\n')
        for given, expected in (({}, self.folder / "build" / "program-cache"), ({"GRADUS_CACHE_DIR": ""}, ""),
                                ({"GRADUS_CACHE_DIR": "off"}, "off")):
            result = self.run_script("demo", "--no-install", **given)
            self.assertEqual(result.returncode, 0, result.stderr)
            self.assertIn(f"cache: {expected}.", result.stdout)

    def test_fuzzing_names_what_broke_this_run(self):
        written = "echo artifact_prefix=build-fuzz/png-\\; Test unit written to build-fuzz/png-"
        (self.folder / "build-fuzz").mkdir()
        (self.folder / "build-fuzz" / "png-crash-before").touch()
        for says, expected in ((f"{written}slow-unit-1; {written}crash-2", "build-fuzz/png-crash-2"),
                               (f"{written}crash-2; {written}slow-unit-1", "build-fuzz/png-crash-2"),
                               (f"{written}slow-unit-1", "no input of its own"), ("echo", "no input of its own")):
            write_program(self.folder / "build-fuzz/tests/fuzz/fuzz_png", f"#!/bin/sh\n{says}\nexit 1\n")
            result = self.run_script("scripts/fuzz.sh", "1", "png")
            self.assertEqual(result.returncode, 1, result.stderr)
            self.assertTrue(any(line.startswith(f"png: broken by {expected}") for line in result.stdout.splitlines()),
                            result.stdout)


if __name__ == "__main__":
    unittest.main()
