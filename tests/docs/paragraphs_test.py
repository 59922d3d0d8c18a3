# SPDX-FileCopyrightText: 2026 The CoSLAM authors
# SPDX-License-Identifier: Apache-2.0
"""No paragraph, list item or table cell of the documents is longer than 80 words; docs/lab holds measurements and is free."""

import re
import unittest

import documents

LIMIT = 80
HEADING_LIMITS = {"docs/architecture.md": 120, "docs/tour.md": 120}  # words of text under each heading, tables left out
ITEM = re.compile(r"\s*([-*+]|\d+[.)]) +")


def words(text: str) -> int:
    """As a reader counts: a link by its text, an image by none."""
    text = re.sub(r"<!--.*?-->", "", text)
    text = re.sub(r"!\[[^\]]*\]\([^)]*\)", "", text)
    text = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", text)
    return sum(1 for word in text.split() if re.search(r"\w", word))


def cells(line: str) -> list[str]:
    """Those of a row of a table; a bar within code is escaped, as GitHub has it."""
    return re.split(r"(?<!\\)\|", line.strip().strip("|"))


def units(document: str) -> list[tuple[int, str, str]]:
    """Each paragraph, list item, table cell and heading: line, kind, text."""
    found: list[tuple[int, str, str]] = []
    open_unit = before = 0
    for number, line in documents.text_lines(document):
        if number != before + 1 or not line.strip():
            open_unit = 0
        before = number
        if not line.strip():
            continue
        if line.startswith("#"):
            found.append((number, "heading", line.lstrip("# ")))
            open_unit = 0
        elif line.lstrip().startswith("|"):
            found.extend((number, "table cell", cell) for cell in cells(line))
            open_unit = 0
        elif item := ITEM.match(line):
            found.append((number, "list item", line[item.end():]))
            open_unit = 1
        elif open_unit:
            place, kind, text = found[-1]
            found[-1] = (place, kind, f"{text} {line.strip()}")
        else:
            found.append((number, "paragraph", line.strip()))
            open_unit = 1
    return found


def pages() -> list[str]:
    return [page for page in documents.documents(below=True) if not page.startswith("docs/lab/")]


class Paragraphs(unittest.TestCase):
    def test_are_short(self) -> None:
        for page in pages():
            for number, kind, text in units(page):
                count = words(text)
                with self.subTest(f"{page}:{number}: a {kind} of {count} words"):
                    self.assertLessEqual(count, LIMIT, text[:60])

    def test_few_words_stand_under_a_heading(self) -> None:
        for page, limit in HEADING_LIMITS.items():
            number, heading, count = 0, "", 0
            for place, kind, text in [*units(page), (0, "heading", "")]:
                if kind == "heading":
                    with self.subTest(f"{page}:{number}: {count} words under '{heading}'"):
                        self.assertLessEqual(count, limit)
                    number, heading, count = place, text, 0
                elif kind != "table cell":
                    count += words(text)


class Units(unittest.TestCase):
    """The reading itself."""

    def test_a_link_counts_by_its_text(self) -> None:
        self.assertEqual(words("see [the two words](a/b.md#c-d) of `x = 1` ![no](i.png)"), 7)

    def test_cells(self) -> None:
        self.assertEqual([cell.strip() for cell in cells("| a | `b \\| c` |")], ["a", "`b \\| c`"])


if __name__ == "__main__":
    unittest.main()
