#!/usr/bin/env python3
"""Writes the tables of docs/scene-format.md, which are what `gradus plugins` prints.

    scripts/scene_format.py [--check] [--program build/gradus] [--page docs/scene-format.md]

--check writes nothing and fails where the page differs."""
import argparse
import difflib
import pathlib
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
BEGIN = "<!-- what `gradus plugins` prints; scripts/scene_format.py writes it -->\n"
END = "<!-- the end of what it prints -->\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--check", action="store_true")
    parser.add_argument("--program", default=ROOT / "build" / "gradus")
    parser.add_argument("--page", type=pathlib.Path, default=ROOT / "docs" / "scene-format.md")
    arguments = parser.parse_args()
    tables = subprocess.run([arguments.program, "plugins"], check=True, capture_output=True, text=True).stdout
    page = arguments.page.read_text(encoding="utf-8")
    before, begin, rest = page.partition(BEGIN)
    _, end, after = rest.partition(END)
    if not begin or not end:
        sys.exit(f"{arguments.page} lacks the lines that the tables stand between:\n{BEGIN}{END}")
    expected = f"{before}{begin}\n{tables}\n{end}{after}"
    if not arguments.check:
        arguments.page.write_text(expected, encoding="utf-8")
    elif page != expected:
        difference = difflib.unified_diff(page.splitlines(), expected.splitlines(), "page", "program", n=0, lineterm="")
        sys.exit("\n".join(list(difference)[:20]) + "\ndocs/scene-format.md is not what plugins declare; mend it by\n"
                 f"    scripts/scene_format.py --program {arguments.program}")


if __name__ == "__main__":
    main()
