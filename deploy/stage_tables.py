#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The CoSLAM authors
# SPDX-License-Identifier: Apache-2.0
"""Keeps the tables of docs/stages as the program prints them: what each stage reads and writes, and its settings.

    coslam-server --stages | deploy/stage_tables.py --write     puts each stage's row into its page, all into README.md
    coslam-server --stages | deploy/stage_tables.py --check     names the pages that differ

Reads a Markdown table with the columns stage, reads, writes, settings. Exit code 0: done, or none differs; 1: some
differ, or a stage has no page, or a page no stage; 2: wrong usage or no such table.
"""

import argparse
import pathlib
import re
import sys

COLUMNS = ["stage", "reads", "writes", "settings"]
INDEX = "README.md"


class BadTable(Exception):
    """What was read is not the table, or a page has no place for it."""


def cells(row: str) -> list[str]:
    """Those of a row; a bar within one is escaped."""
    return [cell.strip() for cell in re.split(r"(?<!\\)\|", row.strip().removeprefix("|").removesuffix("|"))]


def table(head: list[str], rows: list[list[str]]) -> str:
    lines = ["|" + "|".join(f" {cell} " if cell else " " for cell in row) + "|" for row in [head, *rows]]
    return "\n".join([lines[0], "|" + "---|" * len(head), *lines[1:]])


def read_stages(text: str) -> dict[str, list[str]]:
    """The row of each stage without its name, in the order of the table."""
    lines = [line for line in text.splitlines() if line.strip()]
    if len(lines) < 3 or cells(lines[0]) != COLUMNS:
        raise BadTable(f"this is no table of stages: its head is not | {' | '.join(COLUMNS)} |")
    stages: dict[str, list[str]] = {}
    for line in lines[2:]:
        name, *row = cells(line)
        name = name.strip("`")
        if len(row) != len(COLUMNS) - 1:
            raise BadTable(f"the row of {name} has {len(row) + 1} cells, not {len(COLUMNS)}")
        if not re.fullmatch(r"\w+", name) or name in stages:
            raise BadTable(f"'{name}' is no name of a stage, or stands twice")
        stages[name] = row
    return stages


def replaced(text: str, begin: str, end: str, block: str) -> str:
    """The text with another block between its two marks."""
    found = re.search(f"{re.escape(begin)}\n(.*?){re.escape(end)}\n", text, re.DOTALL)
    if not found:
        raise BadTable(f"it lacks the lines {begin} and {end}")
    return text[: found.start(1)] + block + "\n" + text[found.end(1):]


def pages(stages: dict[str, list[str]], folder: pathlib.Path) -> dict[pathlib.Path, str]:
    """What each page has to be."""
    wanted: dict[pathlib.Path, str] = {}

    def put(page: pathlib.Path, begin: str, end: str, block: str) -> None:
        try:
            wanted[page] = replaced(page.read_text(encoding="utf-8"), begin, end, block)
        except BadTable as bad:
            raise BadTable(f"{page.name}: {bad}") from bad

    for name, row in stages.items():
        page = folder / f"{name}.md"
        if page.exists():
            put(page, f"<!-- stage table: {name} -->", "<!-- end of stage table -->", table(COLUMNS[1:], [row]))
    rows = [[f"[{name}]({name}.md)" if folder / f"{name}.md" in wanted else name, *row] for name, row in stages.items()]
    put(folder / INDEX, "<!-- stages -->", "<!-- end of stages -->", table(COLUMNS, rows))
    return wanted


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    what = parser.add_mutually_exclusive_group(required=True)
    what.add_argument("--write", action="store_true", help="bring the pages up to date")
    what.add_argument("--check", action="store_true", help="name the pages that differ, exit code 1 if any")
    parser.add_argument("--docs", type=pathlib.Path, metavar="DIR", help="the folder of the pages",
                        default=pathlib.Path(__file__).resolve().parents[1] / "docs" / "stages")
    options = parser.parse_args()
    try:
        stages = read_stages(sys.stdin.read())
        wanted = pages(stages, options.docs)
    except (BadTable, OSError) as bad:
        print(f"stage_tables.py: {bad}", file=sys.stderr)
        return 2
    complaints = [f"{name}.md: the stage {name} has no page" for name in stages if options.docs / f"{name}.md" not in wanted]
    complaints += [f"{page.name}: there is no such stage" for page in sorted(options.docs.glob("*.md")) if page not in wanted]
    for page, text in wanted.items():
        if text == page.read_text(encoding="utf-8"):
            continue
        if options.write:
            page.write_text(text, encoding="utf-8")
            print(f"{page.name}: written")
        else:
            complaints.append(f"{page.name}: its table is not what the program prints (deploy/stage_tables.py --write)")
    for complaint in complaints:
        print(complaint)
    return 1 if complaints else 0


if __name__ == "__main__":
    sys.exit(main())
