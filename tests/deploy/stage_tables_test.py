# SPDX-FileCopyrightText: 2026 The CoSLAM authors
# SPDX-License-Identifier: Apache-2.0
"""deploy/stage_tables.py in a small folder of pages: what it writes, what it finds to differ, what it refuses."""

import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

SOURCE = pathlib.Path(__file__).resolve().parents[2]
SCRIPT = SOURCE / "deploy" / "stage_tables.py"
HEAD = "| stage | reads | writes | settings |\n|---|---|---|---|\n"
TABLE = HEAD + "| cull | `FrameSet` | `PointEdit` | `CullConfig` |\n| fuse | `a \\| b` |  | none |\n"
PAGE = "# {0}\n\nBefore.\n\n<!-- stage table: {0} -->\n| reads | writes | settings |\n|---|---|---|\n<!-- end of stage table -->\n\nAfter.\n"
INDEX = "# All\n\n<!-- stages -->\n" + HEAD + "<!-- end of stages -->\n\nAfter.\n"


class StageTables(unittest.TestCase):
    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.docs = pathlib.Path(folder.name)
        for name in ("cull", "fuse"):
            (self.docs / f"{name}.md").write_text(PAGE.format(name))
        (self.docs / "README.md").write_text(INDEX)

    def run_it(self, option: str, table: str = TABLE) -> tuple[int, str]:
        run = subprocess.run([sys.executable, str(SCRIPT), option, "--docs", str(self.docs)], input=table,
                             capture_output=True, text=True, check=False)
        return run.returncode, run.stdout + run.stderr

    def text(self, name: str) -> str:
        return (self.docs / f"{name}.md").read_text()

    def test_each_page_gets_its_row_and_the_index_all(self) -> None:
        self.assertEqual(self.run_it("--write")[0], 0)
        self.assertEqual(self.text("cull"), PAGE.format("cull").replace(
            "|---|---|---|\n", "|---|---|---|\n| `FrameSet` | `PointEdit` | `CullConfig` |\n"))
        self.assertIn("|---|---|---|\n| `a \\| b` | | none |\n<!-- end", self.text("fuse"))
        self.assertIn(HEAD + "| [cull](cull.md) | `FrameSet` | `PointEdit` | `CullConfig` |\n| [fuse](fuse.md) |",
                      self.text("README"))
        self.assertEqual(self.run_it("--write"), (0, ""))

    def test_pages_that_differ_are_named_and_stay(self) -> None:
        code, output = self.run_it("--check")
        self.assertEqual((code, [line.split(":")[0] for line in output.splitlines()]),
                         (1, ["cull.md", "fuse.md", "README.md"]))
        self.assertEqual(self.text("cull"), PAGE.format("cull"))
        self.run_it("--write")
        self.assertEqual(self.run_it("--check"), (0, ""))
        code, output = self.run_it("--check", TABLE.replace("CullConfig", "none"))
        self.assertEqual((code, [line.split(":")[0] for line in output.splitlines()]), (1, ["cull.md", "README.md"]))

    def test_stages_and_pages_are_the_same(self) -> None:
        code, output = self.run_it("--write", TABLE + "| scale | | | |\n")
        self.assertEqual(code, 1)
        self.assertIn("scale.md: the stage scale has no page", output)
        code, output = self.run_it("--write", HEAD + "| cull | | | |\n")
        self.assertEqual(code, 1)
        self.assertIn("fuse.md: there is no such stage", output)

    def test_what_is_no_table_changes_nothing(self) -> None:
        for table in ("", "cull\n", HEAD, TABLE + "| map_intra | one |\n", TABLE + "| cull | | | |\n"):
            code, output = self.run_it("--write", table)
            self.assertEqual(code, 2, output)
            self.assertEqual(self.text("cull"), PAGE.format("cull"))

    def test_a_page_without_a_place_for_it_is_named(self) -> None:
        (self.docs / "fuse.md").write_text("# fuse\n")
        code, output = self.run_it("--write")
        self.assertEqual(code, 2)
        self.assertIn("fuse.md: it lacks the lines", output)

    def test_the_pages_of_the_tree_have_a_place_for_it(self) -> None:
        folder = SOURCE / "docs" / "stages"
        names = [page.stem for page in folder.glob("*.md") if page.stem != "README"]
        for name in names:
            text = (folder / f"{name}.md").read_text()
            self.assertTrue(re.search(f"<!-- stage table: {name} -->\n(\\|.*\n)+<!-- end of stage table -->\n", text), name)
        self.docs = folder
        code, output = self.run_it("--check", HEAD + "".join(f"| {name} | x | x | x |\n" for name in names))
        self.assertEqual((code, len(output.splitlines())), (1, len(names) + 1), output)


if __name__ == "__main__":
    unittest.main()
