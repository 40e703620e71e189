#!/usr/bin/env python3
"""scripts/check_skips.py on small results: what differs from the list is found and named."""

import pathlib
import subprocess
import sys
import tempfile
import unittest
import xml.sax.saxutils

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
sys.path.insert(0, str(ROOT / "scripts"))
import check_skips  # noqa: E402

SUITE = """\
Note: Google Test filter = Half/Planets.*
[ RUN      ] Half/Planets.Turn/earth
[       OK ] Half/Planets.Turn/earth (3 ms)
[ RUN      ] Half/Planets.Turn/mars
/a/planets_test.cpp:12: Skipped
no telescope
[  SKIPPED ] Half/Planets.Turn/mars (0 ms)
[ RUN      ] Half/Planets.Turn/venus
/a/planets_test.cpp:20: Failure
[  FAILED  ] Half/Planets.Turn/venus, where GetParam() = 4-byte object <02-00 00-00> (1 ms)
[  SKIPPED ] 1 test, listed below:
[  SKIPPED ] Half/Planets.Turn/mars
"""


def test_case(name, output, skipped=""):
    skipped = f'<skipped message="{skipped}"/>' if skipped else ""
    return (f'<testcase name="{name}" status="{"notrun" if skipped else "run"}">{skipped}'
            f"<system-out>{xml.sax.saxutils.escape(output)}</system-out></testcase>")


class CheckSkips(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.results = self.write("results.xml", "<testsuite>" + "".join([
            test_case("planet_test.Half/Planets", SUITE),
            test_case("double_test.Moon.Turns", "[       OK ] Moon.Turns (3 ms)\n"),
            test_case("Chart", "first\nskipped: no paper\n", "SKIP_RETURN_CODE=77"),
            test_case("Table", "done\n")]) + "</testsuite>")

    def write(self, name, text):
        (self.folder / name).write_text(text)
        return self.folder / name

    def differences(self, text, facts=(), given=(), is_part=False):
        return check_skips.compare(check_skips.read_results(self.results),
                                   check_skips.read_expected(self.write("list.txt", text)), set(given),
                                   lambda fact: fact in facts, is_part)

    def test_results(self):
        self.assertEqual(check_skips.read_results(self.results), {
            "Half/Planets.Turn/earth": None, "Half/Planets.Turn/mars": "no telescope", "Half/Planets.Turn/venus": None,
            "double_test.Moon.Turns": None, "Chart": "skipped: no paper", "Table": None})

    LIST = "# a comment\nalways: Half/*/mars\nno matplotlib: Chart\n"

    def test_a_list_that_holds(self):
        self.assertEqual(self.differences(self.LIST), [])
        self.assertEqual(self.differences(self.LIST + "matplotlib: Table\nno matplotlib, double: Table\n"), [])

    def test_a_skip_that_is_not_listed(self):
        self.assertEqual(self.differences("always: Half/*/mars\n"),
                         ["skipped, but not by the list: Chart: skipped: no paper"])
        # Its condition does not hold.
        self.assertEqual(self.differences(self.LIST, facts={"matplotlib"}),
                         ["skipped, but not by the list: Chart: skipped: no paper"])

    def test_a_listed_test_that_ran(self):
        self.assertEqual(self.differences(self.LIST + "no double: Half/Planets.*\n"), [
            "ran, but list.txt:4 has it skipped: Half/Planets.Turn/earth",
            "ran, but list.txt:4 has it skipped: Half/Planets.Turn/venus"])

    def test_a_listed_test_that_is_not_there(self):
        self.assertEqual(self.differences(self.LIST + "double: Gone\n"), ["list.txt:4: there is no test Gone"])
        self.assertEqual(self.differences(self.LIST + "double: Gone\n", is_part=True), [])

    def test_lines_of_full_runs(self):
        lines = self.LIST + "full, no double: Gone\n"
        self.assertEqual(self.differences(lines), [])
        self.assertEqual(self.differences(lines, given={"full"}), ["list.txt:4: there is no test Gone"])

    def test_lines_that_cannot_be_read(self):
        for line in ("Chart", "always:", "no such fact: Chart", "matplotlib no double: Chart"):
            with self.assertRaises(SystemExit, msg=line):
                self.differences(line + "\n")

    def run_program(self, text):
        return subprocess.run([sys.executable, ROOT / "scripts" / "check_skips.py", self.results, "--expected",
                               self.write("list.txt", text)], capture_output=True, text=True)

    def test_the_program(self):
        result = self.run_program("always: Half/*/mars\nalways: Chart\n")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(result.stdout, "4 cases ran, 2 were skipped:\n  Chart: skipped: no paper\n"
                         "  Half/Planets.Turn/mars: no telescope\n")
        result = self.run_program("always: Chart\n")
        self.assertEqual(result.returncode, 1)
        self.assertIn("skipped, but not by the list: Half/Planets.Turn/mars: no telescope", result.stdout)

    def test_the_committed_list_is_one(self):
        self.assertTrue(check_skips.read_expected(check_skips.EXPECTED))


if __name__ == "__main__":
    unittest.main()
