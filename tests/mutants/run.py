#!/usr/bin/env python3
"""Plants the defects of mutants.txt one after the other and says which the tests find.

    python3 tests/mutants/run.py [--check] [--only TEXT] [--tree FOLDER]

--check   only looks whether each defect can still be planted: its text occurs once in its file. Takes no build.
--only    those whose description or file has this text
--tree    plants them in this checkout, which has a folder `build`, instead of a copy in build/mutants (made and built on
          the first run, brought up to date on later ones); the files are put back

A test that cannot fail proves nothing: each defect stands for a class that some test claims to find. Exit code: 0 if all
were found, 1 if one survived, 2 if one cannot be planted or built.
"""

import argparse
import dataclasses
import os
import pathlib
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
LIST = pathlib.Path(__file__).resolve().parent / "mutants.txt"
LONGEST_TEST = 1200  # seconds; a test that hangs has found its defect, too
NOT_COPIED = {".git", ".cache"}  # and what presets build, gigabytes of it


@dataclasses.dataclass
class Mutant:
    line: int
    name: str
    file: str = ""
    text: str = ""
    becomes: str = ""
    program: str = ""
    filter: str = ""


def read_list():
    mutants = []
    for number, line in enumerate(LIST.read_text().splitlines(), 1):
        if line.startswith("mutant: "):
            mutants.append(Mutant(number, line.removeprefix("mutant: ")))
        elif line.startswith("file: "):
            mutants[-1].file = line.removeprefix("file: ").strip()
        elif line.startswith("-"):
            mutants[-1].text = line[1:]
        elif line.startswith("+"):
            mutants[-1].becomes = line[1:]
        elif line.startswith("test: "):
            mutants[-1].program, mutants[-1].filter = line.removeprefix("test: ").split(maxsplit=1)
        elif line and not line.startswith("#"):
            sys.exit(f"{LIST}:{number}: what is this line?")
    return mutants


def problem(mutant, tree):
    """Why it cannot be planted, or nothing."""
    path = tree / mutant.file
    if not (mutant.file and mutant.text and mutant.becomes and mutant.program):
        return "is not complete"
    if not path.exists():
        return f"{mutant.file}: no such file"
    count = path.read_text().count(mutant.text)
    return None if count == 1 else f"its text occurs {count} times in {mutant.file}"


def built(tree, targets):
    return subprocess.run(["cmake", "--build", tree / "build", "--parallel", str(os.cpu_count()), "--target", *targets],
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)


def make_copy(mutants):
    tree = ROOT / "build" / "mutants"
    tree.mkdir(parents=True, exist_ok=True)
    for entry in ROOT.iterdir():
        if entry.name not in NOT_COPIED and not entry.name.startswith("build"):
            # Only what changed is copied, so that only that is built anew.
            subprocess.run(["cp", "--archive", "--update", entry, tree], check=True)
    subprocess.run(["cmake", "-S", tree, "-B", tree / "build", "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release"], check=True,
                   stdout=subprocess.DEVNULL)
    result = built(tree, sorted({mutant.program for mutant in mutants}))
    if result.returncode != 0:
        sys.exit(result.stdout[-4000:])
    return tree


def find_program(tree, name):
    return next(path for path in (tree / "build" / "tests").rglob(name) if path.is_file() and os.access(path, os.X_OK))


def test(tree, mutant, environment):
    """Whether the tests pass, and whether any ran."""
    try:
        result = subprocess.run([find_program(tree, mutant.program), f"--gtest_filter={mutant.filter}"], text=True,
                                stdout=subprocess.PIPE, stderr=subprocess.STDOUT, env=environment, cwd=tree / "build",
                                timeout=LONGEST_TEST)
    except subprocess.TimeoutExpired:
        return False, True
    return result.returncode == 0, "[  PASSED  ] 0 tests" not in result.stdout or "FAILED" in result.stdout


def outcome(tree, mutant, environment):
    path = tree / mutant.file
    before = path.read_text()
    try:
        path.write_text(before.replace(mutant.text, mutant.becomes))
        result = built(tree, [mutant.program])
        if result.returncode != 0:
            print(result.stdout[-2000:])
            return "CANNOT BE BUILT"
        passes, ran = test(tree, mutant, environment)
        return "NO SUCH TEST" if not ran else "SURVIVED" if passes else "found"
    finally:
        path.write_text(before)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--check", action="store_true")
    parser.add_argument("--only", default="")
    parser.add_argument("--tree", type=pathlib.Path)
    arguments = parser.parse_args()
    mutants = [mutant for mutant in read_list() if arguments.only in mutant.name or arguments.only in mutant.file]
    problems = [f"{LIST}:{m.line}: '{m.name}' {why}" for m in mutants if (why := problem(m, arguments.tree or ROOT))]
    if problems or not mutants:
        print("\n".join(problems or ["no such mutant"]), file=sys.stderr)
        return 2
    if arguments.check:
        print(f"{len(mutants)} mutants can be planted")
        return 0
    tree = arguments.tree.resolve() if arguments.tree else make_copy(mutants)
    # Kernels of defects shall not stay in anybody's cache.
    environment = {**os.environ, "GRADUS_CACHE_DIR": str(tree / "build" / "mutant-cache")}
    found = {}
    for mutant in mutants:
        started = time.perf_counter()
        found[mutant.name] = outcome(tree, mutant, environment)
        print(f"{found[mutant.name]:<16} {time.perf_counter() - started:4.0f} s  {mutant.name}  ({mutant.program}"
              f" {mutant.filter})", flush=True)
    if arguments.tree:
        built(tree, sorted({mutant.program for mutant in mutants}))
    survived = [name for name, what in found.items() if what == "SURVIVED"]
    broken = [name for name, what in found.items() if what not in ("found", "SURVIVED")]
    print(f"{len(mutants) - len(survived) - len(broken)} of {len(mutants)} mutants found")
    return 2 if broken else 1 if survived else 0


if __name__ == "__main__":
    sys.exit(main())
