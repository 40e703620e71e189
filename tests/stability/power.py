#!/usr/bin/env python3
"""Plants the defect that tests/mutants/mutants.txt calls DEFECT, of 10 %, and writes to power.txt what those rows of
docs/stability.md find that tell a bias: a number that finds less than three times its limit is blunt.

    python3 tests/stability/power.py [--check] [--tree FOLDER]

--check   writes nothing: exit code 1 where power.txt says something else, by more than stability_table.py allows
--tree    plants it in this checkout, which has a folder `build`, instead of a copy in build/mutants; the file is put back

Kernels of all rows are compiled for it, which takes minutes: ./check --full does.
"""

import argparse
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import xml.etree.ElementTree

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
sys.path.insert(0, str(ROOT / "tests" / "mutants"))
import run as mutants  # noqa: E402
import stability_table  # noqa: E402

DEFECT = "offset paths carry a tenth too much to the right and downwards, and a tenth too little back"
PROGRAM = "gradient_test"
HEAD = """\
# What rows of docs/stability.md find where, by tests/mutants/mutants.txt, "{defect}":
# bias, how far offset paths are off | test | what provokes it. Written by power.py.
"""


def tests_of_rows():
    """Those that record a bias, by the page."""
    page = stability_table.PAGE.read_text()
    return sorted({name for line in page.splitlines() if "bias at most: **" in line
                   for name in re.findall(rf"`{PROGRAM}: ([\w.]+)`", line)})


def rows_found(tree):
    """The rows that record what they find. Their tests fail, as they should."""
    with tempfile.TemporaryDirectory() as folder:
        output = pathlib.Path(folder) / "planted.xml"
        environment = dict(os.environ, GRADUS_CACHE_DIR=str(tree / "build" / "program-cache"))
        subprocess.run([mutants.find_program(tree, PROGRAM), f"--gtest_output=xml:{output}", "--gtest_brief=1",
                        "--gtest_filter=" + ":".join(f"*{test}*" for test in tests_of_rows())],
                       stdout=subprocess.DEVNULL, env=environment)
        return rows_of(output)


def rows_of(output):
    cases = xml.etree.ElementTree.parse(output).getroot().iter("testcase")
    rows = [row for case in cases for row in stability_table.rows_of_case(PROGRAM, case)]
    return [row for row in rows if any(measure.found is not None for measure in row.measures)]


def measure(arguments):
    defect = next(mutant for mutant in mutants.read_list() if mutant.name == DEFECT)
    tree = arguments.tree.resolve() if arguments.tree else mutants.make_copy([defect])
    problem = mutants.problem(defect, tree)
    if problem:
        sys.exit(f"power.py: the defect {problem}")
    path = tree / defect.file
    before = path.read_text()
    try:
        path.write_text(before.replace(defect.text, defect.becomes))
        result = mutants.built(tree, [PROGRAM])
        if result.returncode != 0:
            sys.exit(result.stdout[-2000:])
        return rows_found(tree)
    finally:
        path.write_text(before)


def write(rows):
    lines = {f"{' '.join(stability_table.number_text(measure.found) for measure in row.measures)} | {row.test} | "
             f"{row.provoked_by}\n" for row in rows}
    ordered = sorted(lines, key=lambda line: line.split(" | ", 1)[1])
    stability_table.POWER.write_text(HEAD.format(defect=DEFECT) + "".join(ordered))


def differences(rows):
    power = stability_table.read_power()
    for row in rows:
        said = power.get(row.power_key())
        if said is None:
            yield f"{row.test}: not in power.txt ({row.provoked_by})"
            continue
        for number, found in zip(said, row.measures):
            if not stability_table.agree(number, found.found, found.limit):
                yield f"{row.test}: {found.quantity}: power.txt says {number}, found {found.found:.3g}"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--check", action="store_true")
    parser.add_argument("--tree", type=pathlib.Path)
    arguments = parser.parse_args()
    rows = measure(arguments)
    if not arguments.check:
        write(rows)
        print(f"{len(rows)} rows")
        return
    found = list(differences(rows))
    if found:
        print("\n".join(found))
        sys.exit("tests/stability/power.txt is not what rows find: tests/stability/power.py writes it anew")


if __name__ == "__main__":
    main()
