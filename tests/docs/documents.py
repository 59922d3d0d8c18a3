# SPDX-FileCopyrightText: 2026 The CoSLAM authors
# SPDX-License-Identifier: Apache-2.0
"""What README.md and docs/ hold: fenced blocks, headings, links, commands within text."""

import dataclasses
import pathlib
import re

SOURCE = pathlib.Path(__file__).resolve().parents[2]
FENCE = re.compile(r"\s*```(\w*)")


@dataclasses.dataclass
class Block:
    """A fenced block. `section` is its heading of the second level, `line` that of its first line."""

    document: str
    line: int
    language: str
    section: str
    lines: list[str]

    @property
    def text(self) -> str:
        return "".join(line + "\n" for line in self.lines)

    def places(self) -> list[tuple[str, str]]:
        """Each line with its place, those that are empty left out."""
        return [(f"{self.document}:{self.line + i}", line) for i, line in enumerate(self.lines) if line.strip()]


def documents(below: bool = False) -> list[str]:
    """README.md and the pages of docs/; with those of its folders too."""
    pages = SOURCE.glob("docs/**/*.md" if below else "docs/*.md")
    return ["README.md", *sorted(str(page.relative_to(SOURCE)) for page in pages)]


def lines_of(document: str) -> list[str]:
    return (SOURCE / document).read_text(encoding="utf-8").splitlines()


def blocks(document: str) -> list[Block]:
    found: list[Block] = []
    section, inside = "", False
    for number, line in enumerate(lines_of(document), 1):
        if fence := FENCE.match(line):
            inside = not inside
            if inside:
                found.append(Block(document, number + 1, fence[1], section, []))
        elif inside:
            found[-1].lines.append(line)
        elif line.startswith("## "):
            section = line[3:]
    if inside:
        raise ValueError(f"{document}: a fenced block does not end")
    return found


def text_lines(document: str) -> list[tuple[int, str]]:
    """The lines outside fenced blocks."""
    found, inside = [], False
    for number, line in enumerate(lines_of(document), 1):
        if FENCE.match(line):
            inside = not inside
        elif not inside:
            found.append((number, line))
    return found


def anchors(document: str) -> set[str]:
    """Those that GitHub makes of the headings."""
    found: set[str] = set()
    for _, line in text_lines(document):
        if heading := re.match(r"#+ +(.*)", line):
            words = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading[1]).replace("`", "").strip().lower()
            anchor = re.sub(r"[^\w\- ]", "", words).replace(" ", "-")
            again = sum(1 for a in found if re.fullmatch(re.escape(anchor) + r"(-\d+)?", a))
            found.add(f"{anchor}-{again}" if anchor in found else anchor)
    return found


def links(document: str) -> list[tuple[int, str]]:
    """Where the links and images lead to, without those to other sites."""
    found = []
    for number, line in text_lines(document):
        for target in re.findall(r"\]\(([^)\s]+)\)", re.sub(r"`[^`]*`", "", line)):
            if not re.match(r"[a-z]+:", target):
                found.append((number, target))
    return found


def commands_in_text(document: str) -> list[tuple[int, str]]:
    """The pieces of code in the text that begin with the name of a program or script of ours."""
    found = []
    for number, line in text_lines(document):
        for code in re.findall(r"`([^`]+)`", line):
            if re.match(r"(build/bin/)?coslam(-\w+)? [a-z-]|(deploy|tests)/\S+\.(sh|py)( |$)", code):
                found.append((number, code.replace("\\|", "|")))
    return found


def without_comment(line: str) -> tuple[str, str]:
    """The command and what is said of it."""
    command, _, comment = line.partition(" # ")
    return command.strip(), comment.strip()
