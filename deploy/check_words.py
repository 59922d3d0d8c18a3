#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The CoSLAM authors
# SPDX-License-Identifier: Apache-2.0
"""Measures the words of the C++ files, so that they become plainer with time and never darker.

    deploy/check_words.py [--root DIR] [--list]

Two figures per folder, over agent, common, deploy and the wings of server:
  subject   header comments that begin without a subject ("Of the newest.", "The same, later."), in percent; such a
            comment cannot be read alone, in a tooltip or a search hit
  pronoun   variables, parameters, fields and functions named by a pronoun, preposition or participle ("of", "own"), per
            1000 lines; such a name cannot be searched for and does not say what it holds
MOST holds the largest figures that are allowed: whoever brings one down lowers it there. --list names the places.
Prints `file:1: rule: what is wrong` for each breach. Exit code 0: none; 1: some; 2: wrong usage.
"""

import argparse
import pathlib
import re
import sys

# For each folder the most percent of comments without a subject and the most pronouns per 1000 lines.
MOST = {
    "agent": (1.0, 1.0),
    "common": (1.0, 1.0),
    "deploy": (1.0, 1.0),
    "server/app": (1.0, 1.0),
    "server/estimator": (1.0, 1.0),
    "server/fleet": (1.0, 1.0),
    "server/keep": (1.0, 1.0),
    "server/show": (1.0, 1.0),
}
SLACK = 1.0  # a figure that is further below its maximum than this is told

# First words that leave out the subject or refer to another comment.
BEGINNING = re.compile(
    r"(its?|those|same|of|what|who|whose|whom|which|that|nothing|not|now|only|as|by|from|where|they|them|this|these|"
    r"such|so|also|another|else|then|there|here|the (same|ones?|others?))\b(?!-)"
    # "All agents that ..." names a subject, "All that ..." does not.
    r"|(one|all|some|most|none|both|each)\b(?= *(?:[,.:;(]|$|(?:that|of|who|which|in|on|at|with|after|before|is|are|was|"
    r"has|have|by|and|or|but|to|from|for|it|they)\b))"
    # "How many frames ..." is followed by its noun, "How it ..." is not.
    r"|how\b(?! (?:many|much) (?!(?:of|it|they|is|are|was|at|to|there|the|a|an)\b)\w)",
    re.IGNORECASE,
)
PRONOUNS = (
    r"(of|own|gone|as|here|kept|then|there|mine|ours|said|it|its|by|since|told|went|from_there|who|whom|which|what|"
    r"where|some|others|with|without)_?"
)
# Behind its type, behind the comma in `int number = 0, of = 1`, or in a structured binding.
PRONOUN = re.compile(
    r"(?:(?:(?<!\w)(?!(?:return|else|throw|case|new|delete|not|sizeof)\b)\w+|(?<=\S)>)[&*]*\s+"
    rf"|,\s+(?={PRONOUNS}(?: = |;|\{{))|\bauto&{{0,2}} \[(?:\w+, )*)"
    rf"{PRONOUNS}(?=\s*[;,=(){{\[\]:])"
)
NO_CODE = re.compile(r"""R"(\w*)\(.*?\)\1"|"(?:\\.|[^"\\\n])*"|'(?:\\.|[^'\\\n])+'|//[^\n]*|/\*.*?\*/""", re.DOTALL)


def comments_of(lines: list[str]):
    """(line number, text) of each comment that stands above a line of code or at its end."""
    block: list[str] = []
    trailing_at = -1  # column of the comment at the end of the line before
    for number, line in enumerate(lines, start=1):
        alone = re.match(r"\s*//[/!]?\s?(.*)", line)
        if alone:
            if line.index("//") != trailing_at:
                block.append(alone[1])
            continue
        if block and line.strip() and not line.startswith("#"):
            yield number - len(block), " ".join(block)
        block = []
        code = NO_CODE.sub(lambda m: m[0] if m[0].startswith("//") else "_" * len(m[0]), line)
        trailing_at = code.find("//")
        if trailing_at >= 0:
            yield number, line[trailing_at + 2 :].lstrip("/!< ")


def is_counted(comment: str) -> bool:
    return comment != "" and not re.match(r"(SPDX-|NOLINT|clang-format|namespace\b|\W*$)", comment)


def pronouns_of(text: str):
    """(line number, name) of each declaration of a name from the list."""
    code = NO_CODE.sub(lambda m: re.sub(r"[^\n]", " ", m[0]) if m[0].startswith("/") else '""', text)
    for match in PRONOUN.finditer(code):
        yield code.count("\n", 0, match.start(2)) + 1, match[2]


def folder_of(path: str) -> str:
    return "/".join(path.split("/")[: 2 if path.startswith("server/") else 1])


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--root", type=pathlib.Path, default=pathlib.Path(__file__).resolve().parent.parent)
    parser.add_argument("--list", action="store_true", help="name the places")
    options = parser.parse_args()
    root = options.root.resolve()

    files = sorted(
        path
        for top in {folder.split("/")[0] for folder in MOST} if (root / top).is_dir()
        for path in (root / top).rglob("*") if path.suffix in {".h", ".cpp"} and path.is_file()
    )
    if not files:
        print(f"check_words.py: no C++ files under {root}", file=sys.stderr)
        return 1

    counts = {folder: {"lines": 0, "comments": 0, "subject": 0, "pronoun": 0} for folder in MOST}
    for file in files:
        path, text = str(file.relative_to(root)), file.read_text(errors="replace")
        count = counts.setdefault(folder_of(path), {"lines": 0, "comments": 0, "subject": 0, "pronoun": 0})
        count["lines"] += text.count("\n")
        places = [(number, "pronoun", name) for number, name in pronouns_of(text)]
        if file.suffix == ".h":
            comments = [(number, comment) for number, comment in comments_of(text.splitlines()) if is_counted(comment)]
            count["comments"] += len(comments)
            places += [(number, "subject", comment) for number, comment in comments if BEGINNING.match(comment)]
        for number, rule, words in places:
            count[rule] += 1
            if options.list:
                print(f"{path}:{number}: {rule}: {words}")

    found = 0
    print("folder             lines  comments  without subject  pronouns per 1000 lines")
    for folder, count in sorted(counts.items()):
        figures = (100 * count["subject"] / max(count["comments"], 1), 1000 * count["pronoun"] / max(count["lines"], 1))
        print(f"{folder:17} {count['lines']:6} {count['comments']:9} {figures[0]:14.1f} % {figures[1]:24.1f}")
        for rule, figure, most in zip(("subject", "pronoun"), figures, MOST.get(folder, (0.0, 0.0))):
            if round(figure, 1) > most:
                print(f"{folder}:1: {rule}: {figure:.1f}, and {most} is the most: --list names the places")
                found += 1
            elif count["lines"] and figure < most - SLACK:
                print(f"{folder}: {rule}: {figure:.1f}: the maximum, {most}, can be lowered in MOST")
    print(f"check_words.py: {len(files)} files, {found} figures above their maximum")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
