#!/usr/bin/env python3
"""Prints the tests that a run of ctest skipped, and holds them against a committed list.

    scripts/check_skips.py RESULTS.xml [--expected tests/expected_skips.txt] [--fact full] [--part]

RESULTS.xml is what ctest wrote with --output-junit and --test-output-size-passed, without which the cases of a suite are
cut off. Exits with 1 where the list and the run differ: a test was skipped that the list does not name, or a test ran
that it names, or there is no such test.

--fact adds to what holds of this run; --part is for a run of some tests only, where those of a line may be absent.

A line of the list is CONDITION: PATTERN. The pattern is a test of ctest or a case of GoogleTest, with * for anything.
The condition is `always`, or FACT or `no FACT`, several with commas: where all hold, each test of the pattern is to be
skipped, else none. A line with a fact that only --fact can give says nothing of runs without. The facts are those of
FACTS below.
"""

import argparse
import fnmatch
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import xml.etree.ElementTree

ROOT = pathlib.Path(__file__).resolve().parent.parent
EXPECTED = ROOT / "tests" / "expected_skips.txt"
CASE = re.compile(r"^\[ +(OK|FAILED|SKIPPED) +\] ([^\s,]+).* \(\d+ ms\)$")


def has_matplotlib():
    """As bench/charts/plotting.py looks for it."""
    sys.path.insert(0, str(ROOT / "bench" / "charts"))
    import plotting

    return plotting.find_chart_python() is not None


def has_second_opencl():
    """As the tests look for it."""
    sys.path.insert(0, str(ROOT / "bench" / "render"))
    import second_device

    with tempfile.TemporaryDirectory() as folder:
        return second_device.environment(folder) is not None


def devices():
    """What is said of the OpenCL devices; the tests take the first."""
    program = ROOT / "build" / "gradus"
    return subprocess.run([program, "devices"], capture_output=True, text=True, check=True).stdout


def has_double():
    return re.search(r"^ +double +(\w+)", devices(), re.MULTILINE).group(1) == "yes"


def has_pocl_3_1():
    return re.search(r"PoCL.*driver 3\.1", devices()) is not None


def has_oclgrind():
    """Or could have: it is to be installed where there is a package."""
    return shutil.which("oclgrind") is not None or (
        shutil.which("apt-cache") is not None
        and subprocess.run(["apt-cache", "show", "oclgrind"], capture_output=True).returncode == 0
    )


FACTS = {
    "shared-scenes": lambda: (ROOT.parent / "shared" / "scenes").is_dir(),
    "shared-references": lambda: all((ROOT.parent / "shared" / name).is_dir() for name in ("scenes", "references")),
    "matplotlib": has_matplotlib,
    "second-opencl": has_second_opencl,
    "double": has_double,
    "pocl-3.1": has_pocl_3_1,
    "oclgrind": has_oclgrind,
}
GIVEN_FACTS = {"full"}  # by --fact alone


def fail(message):
    sys.exit(f"check_skips.py: {message}")


class Line:
    """A line of the list."""

    def __init__(self, text, place):
        condition, separator, self.pattern = text.partition(":")
        self.pattern, self.text, self.place = self.pattern.strip(), text, place
        if not separator or not self.pattern:
            fail(f"{place}: no CONDITION: PATTERN")
        self.terms = []  # (fact, whether it must hold)
        for term in condition.split(","):
            negated = re.fullmatch(r"no +(\S+)", term.strip())
            fact = negated.group(1) if negated else term.strip()
            if fact == "always":
                continue
            if fact not in FACTS and fact not in GIVEN_FACTS:
                fail(f"{place}: unknown fact '{fact}', not among {', '.join(sorted(set(FACTS) | GIVEN_FACTS))}")
            self.terms.append((fact, not negated))

    def concerns(self, given):
        """Whether a run with these given facts has the tests of the line."""
        return all((fact in given) == wanted for fact, wanted in self.terms if fact in GIVEN_FACTS)

    def holds(self, given, measured):
        return all((fact in given if fact in GIVEN_FACTS else measured(fact)) == wanted for fact, wanted in self.terms)


def read_expected(path):
    lines = []
    for number, text in enumerate(path.read_text().splitlines(), 1):
        text = text.split("#")[0].strip()
        if text:
            lines.append(Line(text, f"{path.name}:{number}"))
    return lines


def cases_of(output):
    """(name, None or why it was skipped) of each case that a program of GoogleTest printed."""
    cases, reason = [], []
    for line in output.splitlines():
        match = CASE.match(line)
        if match:
            why = " ".join(part for part in reason if not re.search(r":\d+: Skipped$", part)).strip()
            cases.append((match.group(2), (why or "no reason given") if match.group(1) == "SKIPPED" else None))
        reason = [] if line.startswith("[") else [*reason, line]
    return cases


def read_results(path):
    """{name: None or why it was skipped}: cases for programs of GoogleTest, tests of ctest for others."""
    results = {}
    for test in xml.etree.ElementTree.parse(path).getroot().iter("testcase"):
        name, output = test.get("name"), test.findtext("system-out") or ""
        cases = cases_of(output)
        if cases:
            # A program of several builds has its name before that of the case.
            results.update({name if name.endswith(case) else case: why for case, why in cases})
        elif test.find("skipped") is not None or test.get("status") in ("notrun", "disabled"):
            said = [line.strip() for line in output.splitlines() if "skipped" in line.lower()]
            results[name] = said[0] if said else test.find("skipped").get("message")
        else:
            results[name] = None
    return results


def compare(results, lines, given, measured, is_part):
    """What differs, as lines of text."""
    differences, named = [], set()
    for line in lines:
        if not line.concerns(given):
            continue
        matches = [name for name in results if fnmatch.fnmatchcase(name, line.pattern)]
        if not matches and not is_part:
            differences.append(f"{line.place}: there is no test {line.pattern}")
        if line.holds(given, measured):
            named.update(matches)
            differences += [f"ran, but {line.place} has it skipped: {name}" for name in matches if results[name] is None]
    differences += [f"skipped, but not by the list: {name}: {why}" for name, why in results.items()
                    if why is not None and name not in named]
    return differences


def main():
    parser = argparse.ArgumentParser(description="holds the skipped tests of a run against the committed list")
    parser.add_argument("results", type=pathlib.Path)
    parser.add_argument("--expected", type=pathlib.Path, default=EXPECTED)
    parser.add_argument("--fact", action="append", default=[], choices=sorted(GIVEN_FACTS), help="holds of this run")
    parser.add_argument("--part", action="store_true", help="some tests only: those of a line may be absent")
    arguments = parser.parse_args()
    results = read_results(arguments.results)
    if not results:
        fail(f"{arguments.results}: no tests")
    known = {}

    def measured(fact):
        if fact not in known:
            known[fact] = FACTS[fact]()
        return known[fact]

    differences = compare(results, read_expected(arguments.expected), set(arguments.fact), measured, arguments.part)
    skipped = {name: why for name, why in results.items() if why is not None}
    print(f"{len(results) - len(skipped)} cases ran, {len(skipped)} were skipped" + (":" if skipped else "."))
    for name, why in sorted(skipped.items()):
        print(f"  {name}: {why}")
    if differences:
        print("\n".join(differences))
        fail(f"what was skipped is not what {arguments.expected.name} says")


if __name__ == "__main__":
    main()
