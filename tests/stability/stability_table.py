#!/usr/bin/env python3
"""Writes docs/stability.md from what tests recorded with tests/support/stability.h, or checks it against that.

    tests/stability/stability_table.py [--check] [--run [FILTER]] PROGRAM...

PROGRAM is a test program that records rows. ctest has each test write its results as XML to the folder
stability-results/NAME-OF-PROGRAM of the build, which is found from --results; results older than their program do not
count. So after ctest a call writes the page. --run first runs those tests anew that the page names, or those of a
GoogleTest filter, for a test that is new.

--check writes nothing. The page must have the same rows, texts and names of tests, and each number must agree with the
fresh one: they differ by less than a factor of 3, or by less than a hundredth of the limit. Numbers depend on the
platform; the tests themselves hold fresh ones against their limits.
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
FIELDS = ("area", "failure", "provoked_by", "contract", "quantity", "number", "limit")

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

"Bias of the mean at most": the difference of the means of images of several seeds to what they should be, and four
standard errors, relatively.

"Share of the differences that is lost or added at most": of the differences of gradient-domain photon mapping less those
of the same image's primal, the mean product with the differences of independent primal images over the mean square of
those, and four standard errors; besides, their squared bias must be within four standard errors of 0.

Not here, because there is no such method yet: chains of Metropolis. Textures are not read yet either; edges between
materials stand for theirs.
"""


class Row:
    def __init__(self, fields, test):
        self.area, self.failure, self.provoked_by, self.contract, self.quantity = (fields[f] for f in FIELDS[:5])
        self.number, self.limit = float(fields["number"]), float(fields["limit"])
        self.test = test
        self.cases = 1

    def key(self):
        return self.test, self.area, self.failure, self.provoked_by, self.contract, self.quantity, self.limit

    def share_of_limit(self):
        return self.number / self.limit if self.limit != 0 else self.number

    def line(self):
        measured = f"{self.quantity}: **{number_text(self.number)}**, limit {number_text(self.limit)}"
        test = f"`{self.test}`" + (f", worst of {self.cases}" if self.cases > 1 else "")
        cells = [self.failure, self.provoked_by, self.contract, measured, test]
        return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"


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


NUMBER = re.compile(r"\*\*([^*]+)\*\*, limit")


def agree(a, b, limit):
    slack = SHARE_OF_LIMIT * limit
    return a <= FACTOR * b + slack and b <= FACTOR * a + slack


def differences(page, fresh, rows):
    """What of the page is not as recorded, as lines of text."""
    found = []
    without_numbers = [NUMBER.sub("limit", line) for line in page.splitlines()]
    fresh_without = [NUMBER.sub("limit", line) for line in fresh.splitlines()]
    found += [f"not recorded by a test: {line}" for line in without_numbers if line not in fresh_without]
    found += [f"missing: {line}" for line in fresh_without if line not in without_numbers]
    if not found and without_numbers != fresh_without:
        found.append("the order of the rows")
    numbers = {NUMBER.sub("limit", line): NUMBER.search(line) for line in page.splitlines()}
    for row in rows:
        match = numbers.get(NUMBER.sub("limit", row.line()))
        if match and not agree(float(match.group(1)), row.number, row.limit):
            found.append(f"{row.test}: {row.quantity}: the page says {match.group(1)}, measured {row.number:.3g}")
    return found


def run(programs, results, wanted):
    """Runs the tests of a filter, or those that the page names."""
    named = re.findall(r"`(\w+): ([\w.]+)`", PAGE.read_text()) if PAGE.exists() else []
    for program in programs:
        tests = wanted or ":".join(f"*{test}*" for name, test in named if name == program.name)
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
    fresh = page_of(rows)
    if not arguments.check:
        PAGE.write_text(fresh)
        print(f"{len(rows)} rows")
        return
    found = differences(PAGE.read_text() if PAGE.exists() else "", fresh, rows)
    if found:
        print("\n".join(found))
        sys.exit("docs/stability.md is not what the tests record. If they are right, write it anew: "
                 "cmake --build build --target stability-page")


if __name__ == "__main__":
    main()
