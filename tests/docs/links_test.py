# SPDX-FileCopyrightText: 2026 The CoSLAM authors
# SPDX-License-Identifier: Apache-2.0
"""The documents' links lead to files and headings that exist, and each page is found from README.md."""

import re
import unittest

import documents
from documents import SOURCE


class Links(unittest.TestCase):
    def test_lead_to_what_exists(self) -> None:
        for document in documents.documents(below=True):
            for number, target in documents.links(document):
                with self.subTest(f"{document}:{number}: {target}"):
                    name, _, anchor = target.partition("#")
                    file = (SOURCE / document).parent / name if name else SOURCE / document
                    self.assertTrue(file.exists(), "there is no such file")
                    if anchor:
                        page = str(file.resolve().relative_to(SOURCE))
                        self.assertIn(anchor, documents.anchors(page), "the page has no such heading")

    def test_each_page_is_two_clicks_away(self) -> None:
        reached = {"README.md"}
        for _ in range(2):
            for page in list(reached):
                for _, target in documents.links(page):
                    file = ((SOURCE / page).parent / target.partition("#")[0]).resolve()
                    if file.suffix == ".md" and file.is_relative_to(SOURCE):
                        reached.add(str(file.relative_to(SOURCE)))
        self.assertEqual(set(documents.documents()) - reached, set())

    def test_the_site_has_each_page(self) -> None:
        named = re.findall(r"([\w./-]+\.md)$", (SOURCE / "mkdocs.yml").read_text(encoding="utf-8"), re.MULTILINE)
        pages = {page.removeprefix("docs/") for page in documents.documents(below=True) if page.startswith("docs/")}
        self.assertEqual(set(named), pages | {"index.md"})  # index.md: README.md, see deploy/mkdocs_links.py
        self.assertEqual(len(named), len(set(named)))


if __name__ == "__main__":
    unittest.main()
