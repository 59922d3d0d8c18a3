#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The CoSLAM authors
# SPDX-License-Identifier: Apache-2.0
"""Which part of the lines of some folders was run, by what gcov tells of a build with --coverage.

    deploy/coverage.py --build DIR --floors FILE [--gcov PROGRAM] [--jobs N]

FILE names the folders, each with the least percentage. A line counts as run when any program ran it; what no program was
built with does not count. Prints each folder's figure and its files that lack most. Exit code 0: no figure is below its
floor; 1: one is. deploy/coverage.sh calls this.
"""

import argparse
import concurrent.futures
import json
import pathlib
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
MOST_FILES = 5  # that are named for a folder

Lines = dict[tuple[str, int], bool]  # file and line number: whether it was run


def lines_of(gcov: str, note: pathlib.Path, folders: list[str]) -> Lines:
    """Of one object, by its note file."""
    run = subprocess.run([gcov, "--json-format", "--stdout", note.name], cwd=note.parent, capture_output=True, check=True)
    lines: Lines = {}
    for text in run.stdout.splitlines():
        tree = json.loads(text)
        for file in tree["files"]:
            path = pathlib.Path(tree["current_working_directory"], file["file"])
            if not path.is_relative_to(ROOT):
                continue
            name = str(path.relative_to(ROOT))
            if not any(name.startswith(f"{folder}/") for folder in folders):
                continue
            for line in file["lines"]:
                key = name, line["line_number"]
                lines[key] = lines.get(key, False) or line["count"] > 0
    return lines


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", type=pathlib.Path, required=True)
    parser.add_argument("--floors", type=pathlib.Path, required=True)
    parser.add_argument("--gcov", default="gcov")
    parser.add_argument("--jobs", type=int, default=2)
    arguments = parser.parse_args()

    floors: dict[str, float] = json.loads(arguments.floors.read_text())
    notes = sorted(arguments.build.resolve().rglob("*.gcno"))
    all_lines: Lines = {}
    with concurrent.futures.ThreadPoolExecutor(max(1, arguments.jobs)) as pool:
        for lines in pool.map(lambda note: lines_of(arguments.gcov, note, list(floors)), notes):
            for key, ran in lines.items():
                all_lines[key] = all_lines.get(key, False) or ran
    low = False
    for folder, floor in floors.items():
        files: dict[str, list[bool]] = {}
        for (name, _), ran in all_lines.items():
            if name.startswith(f"{folder}/"):
                files.setdefault(name, []).append(ran)
        ran, total = (sum(count(lines) for lines in files.values()) for count in (sum, len))
        percent = 100 * ran / total if total else 0.0
        low |= percent < floor
        print(f"{'LOW ' if percent < floor else 'fine'}  {percent:5.1f} % of {total} lines (floor {floor:g}): {folder}")
        lacking = sorted(files.items(), key=lambda file: sum(file[1]) - len(file[1]))
        for name, lines in lacking[:MOST_FILES]:
            if not all(lines):
                print(f"          {len(lines) - sum(lines)} of {len(lines)} lines not run: {name}")
    return 1 if low else 0


if __name__ == "__main__":
    sys.exit(main())
