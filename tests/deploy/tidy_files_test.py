# SPDX-FileCopyrightText: 2026 The CoSLAM authors
# SPDX-License-Identifier: Apache-2.0
"""deploy/tidy_files.py in a small tree with a stand-in for clang-tidy: what is checked, what is known to be clean."""

import json
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

SCRIPT = pathlib.Path(__file__).resolve().parents[2] / "deploy" / "tidy_files.py"
# Complains of files that hold the word BAD, and takes a minute for SLOW; counts how often it was asked.
STAND_IN = """#!/bin/sh
[ "$1" != --version ] || { echo "stand-in $(cat "$(dirname "$0")/version")"; exit 0; }
for file; do :; done
echo "$file" >> "$(dirname "$0")/asked"
! grep -q SLOW "$file" || exec sleep 60
! grep -n BAD "$file"
"""


class TidyFiles(unittest.TestCase):
    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.tree = pathlib.Path(folder.name).resolve()
        (self.tree / "deploy").mkdir()
        shutil.copy(SCRIPT, self.tree / "deploy")
        self.write("tidy", STAND_IN).chmod(0o755)
        self.write("version", "14")
        self.write(".clang-tidy", "Checks: all\n")
        self.write("common/a.h", "int a();\n")
        self.write("common/a.cpp", '#include "common/a.h"\nint a() { return 1; }\n')
        self.write("common/b.cpp", "int b() { return 1; }\n")
        self.compile_commands("-DX=1")

    def write(self, name: str, text: str) -> pathlib.Path:
        path = self.tree / name
        path.parent.mkdir(exist_ok=True)
        path.write_text(text)
        return path

    def compile_commands(self, flag: str) -> None:
        entries = [
            {
                "directory": str(self.tree),
                "command": f"/usr/bin/ccache c++ {flag} -I{self.tree} -o {name}.o -c {self.tree}/common/{name}.cpp",
                "file": f"{self.tree}/common/{name}.cpp",
            }
            for name in ("a", "b")
        ]
        self.write("build/compile_commands.json", json.dumps(entries))

    def run_it(self, *options: str) -> tuple[int, list[str], str]:
        """Exit code, files that clang-tidy was asked of, output."""
        self.write("asked", "")
        command = [sys.executable, str(self.tree / "deploy/tidy_files.py"), "--build", str(self.tree / "build"),
                   "--clang-tidy", str(self.tree / "tidy"), *options, "common/a.cpp", "common/b.cpp"]
        run = subprocess.run(command, capture_output=True, text=True, check=False)
        asked = (self.tree / "asked").read_text().splitlines()
        return run.returncode, sorted(str(pathlib.Path(file).relative_to(self.tree)) for file in asked), run.stdout + run.stderr

    BOTH = ["common/a.cpp", "common/b.cpp"]

    def assert_asked(self, files: list[str]) -> None:
        code, asked, output = self.run_it()
        self.assertEqual((code, asked), (0, files), output)

    def test_clean_files_are_checked_once(self) -> None:
        self.assert_asked(self.BOTH)
        self.assert_asked([])
        code, asked, output = self.run_it("--again")
        self.assertEqual((code, asked), (0, self.BOTH), output)

    def test_whatever_decides_counts(self) -> None:
        self.assert_asked(self.BOTH)
        self.write("common/a.h", "int a();  // NOLINT\n")
        self.assert_asked(["common/a.cpp"])
        self.write("common/b.cpp", "int b() { return 2; }\n")
        self.assert_asked(["common/b.cpp"])
        self.write(".clang-tidy", "Checks: more\n")
        self.assert_asked(self.BOTH)
        self.compile_commands("-DX=2")
        self.assert_asked(self.BOTH)
        self.write("version", "15")
        self.assert_asked(self.BOTH)
        self.assert_asked([])

    def test_a_complaint_is_printed_and_stays(self) -> None:
        self.assert_asked(self.BOTH)
        self.write("common/b.cpp", "int b() { return 1; }  // BAD\n")
        for _ in range(2):
            code, asked, output = self.run_it()
            self.assertEqual((code, asked), (1, ["common/b.cpp"]), output)
            self.assertIn("1:int b()", output)
            self.assertIn("clang-tidy found something in 1 of 2 files: common/b.cpp", output)
        self.write("common/b.cpp", "int b() { return 1; }\n")
        self.assert_asked(["common/b.cpp"])

    def test_what_does_not_compile_is_never_known_to_be_clean(self) -> None:
        self.write("common/a.cpp", '#include "common/nowhere.h"\n')
        self.assert_asked(self.BOTH)
        self.assert_asked(["common/a.cpp"])

    def test_what_takes_too_long_is_left_out_and_named(self) -> None:
        self.write("common/b.cpp", "int b() { return 1; }  // SLOW\n")
        code, asked, output = self.run_it("--seconds", "2")
        self.assertEqual((code, asked), (0, self.BOTH), output)
        self.assertIn("left out, because time ran out: common/b.cpp", output)

    def test_what_is_not_built_is_left_out(self) -> None:
        self.write("build/compile_commands.json", "[]")
        code, asked, output = self.run_it()
        self.assertEqual((code, asked), (0, []))
        self.assertIn("not built, left out: common/a.cpp", output)


if __name__ == "__main__":
    unittest.main()
