#!/usr/bin/env python3
"""Writes docs/stability.md from what tests recorded with tests/support/stability.h, or checks it against that.

    tests/stability/stability_table.py [--check] [--run [FILTER]] PROGRAM...

PROGRAM is a test program that records rows. ctest has each test write its results as XML to the folder
stability-results/NAME-OF-PROGRAM of the build, which is found from --results; results older than their program do not
count. So after ctest a call writes the page. --run first runs those tests anew that the page names, or those of a
GoogleTest filter, for a test that is new.

Where a row has an entry in power.txt (power.py), its numbers stand beside those that a planted defect makes.

--check writes nothing. The page must have the same rows, texts and names of tests, but for tests whose names begin with
`Full` and that have not run: ./check leaves them out. Each number must agree with the fresh one: they differ by less
than a factor of 3, or by less than a hundredth of the limit. Numbers depend on the platform; the tests themselves hold
fresh ones against their limits.
"""

import argparse
import pathlib
import re
import subprocess
import sys
import xml.etree.ElementTree

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
PAGE = ROOT / "docs" / "stability.md"
AREAS = ["Path tracing", "Half-vector copy", "Reconnection", "Gradients", "Photons", "Gradients of photons", "Reconstruction", "Numbers"]
FACTOR = 3
SHARE_OF_LIMIT = 0.01
FIELDS = ("area", "failure", "provoked_by", "contract")
POWER = pathlib.Path(__file__).resolve().parent / "power.txt"

INTRODUCTION = """\
# Stability

Where methods fail in theory, the case that provokes it, and how Gradus fares. Each row is written by the test that it
names, beside the number that it measures: this page is made by `tests/stability/stability_table.py` and checked by
ctest (`Stability.PageIsWhatTestsRecord`). Do not edit it.

A number is printed with its limit, the largest that passes. It is the worst of all cases of the test. Numbers depend on
the platform (these: PoCL, CPU): the check allows them to differ by a factor of 3 or by a hundredth of the limit.

"Bias at most" compares gradient-domain path tracing with path tracing of other seeds. With G an image or its
differences, R the path tracer's and D their differences, and A and B independent halves, the sum over pixels of
(G_A - D R_A)(G_B - D R_B) estimates the squared bias. The number is the root of that estimate plus four standard errors,
relative to the root mean square of D R: what bias the test cannot exclude. Besides, the estimate must be within four
standard errors of 0.

"Offset paths off by at most" is how far offset paths may carry too much to the right and downwards and too little back,
as a wrong Jacobian has them do: twice the mean product of G - D R with the sums of both pixels, of other seeds and
without what the camera sees of lights, over the mean square of those sums, without its sign, and four standard errors.
Besides, it must be within 9.4 standard errors of 0 (eight seeds), and so must the like number for offset paths that
carry too much both ways.

"Planted" is what both find, noise apart, where offset paths do carry a tenth too much to the right and downwards and a
tenth too little back (`tests/stability/power.py` plants it in the kernels; `power.txt` has what it found). A number
whose limit is over a third of that is marked blunt: it tells of graver defects only. A row whose other number is not
blunt sees this one; three see it with neither, where shifts carry little, or the differences' noise is large.

"Bias of the mean at most": the difference of the means of images of several seeds to what they should be, and four
standard errors, relatively.

"Share of the differences that is lost or added at most": of the differences of gradient-domain photon mapping less those
of the same image's primal, the mean product with the differences of independent primal images over the mean square of
those, and four standard errors; besides, their squared bias must be within four standard errors of 0.

Not here, because there is no such method yet: chains of Metropolis.
"""


class Measure:
    def __init__(self, fields, prefix):
        self.quantity = fields[prefix + "quantity"]
        self.number, self.limit = float(fields[prefix + "number"]), float(fields[prefix + "limit"])
        found = fields.get(prefix + "found")
        self.found = None if found is None else float(found)

    def share_of_limit(self):
        return self.number / self.limit if self.limit != 0 else self.number

    def text(self, planted):
        text = f"{self.quantity}: **{number_text(self.number)}**, limit {number_text(self.limit)}"
        if planted is not None:
            text += f", planted {number_text(planted)}" + (" (blunt)" if 3 * self.limit > planted else "")
        return text


class Row:
    def __init__(self, fields, test):
        self.area, self.failure, self.provoked_by, self.contract = (fields[f] for f in FIELDS)
        self.measures = [Measure(fields, prefix) for prefix in ("", "also_") if prefix + "quantity" in fields]
        self.test = test
        self.cases = 1
        self.planted = [None] * len(self.measures)

    def key(self):
        measures = tuple((measure.quantity, measure.limit) for measure in self.measures)
        return self.test, self.area, self.failure, self.provoked_by, self.contract, measures

    def power_key(self):
        return self.test, self.provoked_by

    def share_of_limit(self):
        return max(measure.share_of_limit() for measure in self.measures)

    def line(self):
        measured = "; ".join(measure.text(planted) for measure, planted in zip(self.measures, self.planted))
        test = f"`{self.test}`" + (f", worst of {self.cases}" if self.cases > 1 else "")
        cells = [self.failure, self.provoked_by, self.contract, measured, test]
        return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"


def read_power():
    """What the planted defect makes of the numbers of rows, by test and what provokes it."""
    power = {}
    for line in POWER.read_text().splitlines() if POWER.exists() else []:
        if line and not line.startswith("#"):
            numbers, test, provoked_by = line.split(" | ", 2)
            power[test, provoked_by] = [float(number) for number in numbers.split()]
    return power


def is_full(test):
    """Whether ./check leaves out a test "program: Suite.Case"."""
    return ": Full" in test


def add_power(rows):
    """Gives rows what the planted defect makes of them; returns what is missing or too much, as lines of text."""
    power, problems = read_power(), []
    for row in rows:
        if all(measure.found is None for measure in row.measures):
            continue
        if row.power_key() in power:
            row.planted = power.pop(row.power_key())
        else:
            problems.append(f"{row.test}: not in power.txt: tests/stability/power.py measures it ({row.provoked_by})")
    return problems + [f"{test}: in power.txt, but not recorded ({provoked_by})" for test, provoked_by in power
                       if not is_full(test)]


def number_text(value):
    return f"{value:.2g}"


def plain_name(case):
    """Suite.Test, without what names the parameters."""
    return f"{case.get('classname').split('/')[-1]}.{case.get('name').split('/')[0]}"


def rows_of_case(program, case):
    by_row = {}
    for item in case.iter("property"):
        parts = item.get("name").split(".")
        if parts[0] == "stability":
            by_row.setdefault(int(parts[1]), {})[parts[2]] = item.get("value")
    return [Row(fields, f"{program}: {plain_name(case)}") for _, fields in sorted(by_row.items())]


def read_results(folder, program):
    """The newest result of each test of a program; failed ones end the run."""
    newest = {}
    built = program.stat().st_mtime
    for file in folder.rglob("*.xml"):
        written = file.stat().st_mtime
        if written < built:
            continue
        for case in xml.etree.ElementTree.parse(file).getroot().iter("testcase"):
            name = (case.get("classname"), case.get("name"))
            if case.get("result") == "completed" and (name not in newest or newest[name][0] < written):
                newest[name] = written, case
    failed = [".".join(name) for name, (_, case) in newest.items() if case.find("failure") is not None]
    if failed:
        sys.exit(f"stability_table.py: {program.name}: failed: {', '.join(sorted(failed))}")
    return [row for name in sorted(newest) for row in rows_of_case(program.name, newest[name][1])]


def merge(rows):
    """One row for all cases of a test that record the same texts: the one nearest to its limit."""
    merged = {}
    for row in rows:
        if row.area not in AREAS:
            sys.exit(f"stability_table.py: {row.test}: unknown area '{row.area}'")
        kept = merged.get(row.key())
        if kept is None:
            merged[row.key()] = row
            continue
        cases = kept.cases + 1
        if row.share_of_limit() > kept.share_of_limit():
            merged[row.key()] = kept = row
        kept.cases = cases
    return list(merged.values())


def page_of(rows):
    text = INTRODUCTION
    for area in AREAS:
        lines = [row.line() for row in rows if row.area == area]
        if lines:
            text += f"\n## {area}\n\n| what goes wrong | provoked by | what Gradus does | measured | test |\n"
            text += "|---|---|---|---|---|\n" + "\n".join(lines) + "\n"
    return text


TEST_OF_LINE = re.compile(r"`(\w+: [\w.]+)`")
NUMBER = re.compile(r"\*\*([^*]+)\*\*, limit")


def agree(a, b, limit):
    slack = SHARE_OF_LIMIT * limit
    return a <= FACTOR * b + slack and b <= FACTOR * a + slack


def differences(page, fresh, rows):
    """What of the page is not as recorded, as lines of text."""
    found = []
    recorded = {row.test for row in rows}
    said_lines = [line for line in page.splitlines()
                  if not any(is_full(test) and test not in recorded for test in TEST_OF_LINE.findall(line))]
    without_numbers = [NUMBER.sub("limit", line) for line in said_lines]
    fresh_without = [NUMBER.sub("limit", line) for line in fresh.splitlines()]
    found += [f"not recorded by a test: {line}" for line in without_numbers if line not in fresh_without]
    found += [f"missing: {line}" for line in fresh_without if line not in without_numbers]
    if not found and without_numbers != fresh_without:
        found.append("the order of the rows")
    numbers = {NUMBER.sub("limit", line): NUMBER.findall(line) for line in said_lines}
    for row in rows:
        for said, measure in zip(numbers.get(NUMBER.sub("limit", row.line()), []), row.measures):
            if not agree(float(said), measure.number, measure.limit):
                found.append(f"{row.test}: {measure.quantity}: the page says {said}, measured {measure.number:.3g}")
    return found


def filter_of(tests):
    """Suites and cases by their plain names, without further instantiations (Full/...) of those that ./check runs."""
    further = [f"Full*/{test}*" for test in tests if not test.startswith("Full")]
    return ":".join(f"{test}*:*/{test}*" for test in tests) + ("-" + ":".join(further) if further else "")


def run(programs, results, wanted):
    """Runs the tests of a filter, or those that the page names."""
    named = re.findall(r"`(\w+): ([\w.]+)`", PAGE.read_text()) if PAGE.exists() else []
    for program in programs:
        tests = wanted or filter_of(sorted({test for name, test in named if name == program.name}))
        if tests:
            output = results / program.name / "run.xml"
            subprocess.run([program, f"--gtest_filter={tests}", f"--gtest_output=xml:{output}", "--gtest_brief=1"],
                           stdout=sys.stderr)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("programs", metavar="PROGRAM", nargs="+", type=pathlib.Path)
    parser.add_argument("--results", type=pathlib.Path, help="default: ../../stability-results beside the first program")
    parser.add_argument("--run", metavar="FILTER", nargs="?", const="", help="run tests first")
    parser.add_argument("--check", action="store_true")
    arguments = parser.parse_args()
    programs = [program.resolve() for program in arguments.programs]
    results = arguments.results or programs[0].parent.parent.parent / "stability-results"
    if arguments.run is not None:
        run(programs, results, arguments.run)
    rows = merge([row for program in programs for row in read_results(results / program.name, program)])
    problems = add_power(rows)
    fresh = page_of(rows)
    if not arguments.check:
        print("\n".join(problems))
        PAGE.write_text(fresh)
        print(f"{len(rows)} rows")
        return
    found = problems + differences(PAGE.read_text() if PAGE.exists() else "", fresh, rows)
    if found:
        print("\n".join(found))
        sys.exit("docs/stability.md is not what the tests record. If they are right, write it anew: "
                 "cmake --build build --target stability-page")


if __name__ == "__main__":
    main()
