# SPDX-FileCopyrightText: 2026 The CoSLAM authors
# SPDX-License-Identifier: Apache-2.0
"""deploy/coverage.py in a small tree with a stand-in for gcov: figures, and floors."""

import json
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

SCRIPT = pathlib.Path(__file__).resolve().parents[2] / "deploy" / "coverage.py"


class Coverage(unittest.TestCase):
    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.tree = pathlib.Path(folder.name).resolve()
        (self.tree / "deploy").mkdir()
        shutil.copy(SCRIPT, self.tree / "deploy")
        self.gcov = self.tree / "gcov"
        self.gcov.write_text('#!/bin/sh\ncat "$3"\n')  # a note file holds the answer
        self.gcov.chmod(0o755)

    def note(self, name: str, counts: dict[str, dict[int, int]]) -> None:
        path = self.tree / "build" / f"{name}.gcno"
        path.parent.mkdir(parents=True, exist_ok=True)
        files = [
            {"file": file, "lines": [{"line_number": line, "count": count} for line, count in lines.items()]}
            for file, lines in counts.items()
        ]
        path.write_text(json.dumps({"current_working_directory": str(self.tree), "files": files}))

    def run_it(self, floors: dict[str, float]) -> tuple[int, str]:
        (self.tree / "floors.json").write_text(json.dumps(floors))
        command = [sys.executable, str(self.tree / "deploy/coverage.py"), "--build", str(self.tree / "build"),
                   "--floors", str(self.tree / "floors.json"), "--gcov", str(self.gcov)]
        run = subprocess.run(command, capture_output=True, text=True, check=False)
        return run.returncode, run.stdout + run.stderr

    def test_a_line_counts_once_and_whoever_ran_it(self) -> None:
        self.note("one", {"common/a.h": {1: 0, 2: 3}, "/usr/include/vector": {1: 0}, "tests/t.cpp": {1: 0}})
        self.note("two", {f"{self.tree}/common/a.h": {1: 1, 2: 0, 3: 0, 4: 0}, "agent/b.cpp": {1: 1}})
        code, output = self.run_it({"common": 50, "agent": 100})
        self.assertEqual(code, 0, output)
        self.assertIn(" 50.0 % of 4 lines (floor 50): common", output)
        self.assertIn("100.0 % of 1 lines (floor 100): agent", output)
        self.assertIn("2 of 4 lines not run: common/a.h", output)

    def test_below_its_floor(self) -> None:
        self.note("one", {"common/a.h": {1: 0, 2: 3}})
        code, output = self.run_it({"common": 50.5})
        self.assertEqual(code, 1, output)
        self.assertIn("LOW ", output)

    def test_a_folder_that_nothing_was_built_of_has_no_lines(self) -> None:
        self.note("one", {"common/a.h": {1: 1}})
        code, output = self.run_it({"server": 1})
        self.assertEqual(code, 1, output)


if __name__ == "__main__":
    unittest.main()
