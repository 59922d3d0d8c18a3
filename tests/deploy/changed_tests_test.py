# SPDX-FileCopyrightText: 2026 The CoSLAM authors
# SPDX-License-Identifier: Apache-2.0
"""deploy/changed_tests.py in a small tree with a stand-in for ninja: which programs a change concerns, in which order."""

import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

SCRIPT = pathlib.Path(__file__).resolve().parents[2] / "deploy" / "changed_tests.py"
# Answers `ninja -C DIR -t TOOL TARGET` with the file TOOL/TARGET of the tree.
STAND_IN = """#!/bin/sh
cat "$(dirname "$0")/answers/$4/$5"
"""


class ChangedTests(unittest.TestCase):
    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.tree = pathlib.Path(folder.name).resolve()
        (self.tree / "deploy").mkdir()
        shutil.copy(SCRIPT, self.tree / "deploy")
        self.write("ninja", STAND_IN).chmod(0o755)
        self.write("common/a/a.h", '#include <string>\n#include "common/b/b.h"\n')
        self.write("common/a/a.cpp", '#include "common/a/a.h"\n')
        self.write("common/b/b.h", "")
        self.write("common/c/c.cpp", '#include "idl/words.h"\n')
        self.write("tests/common/a/a_test.cpp", '#include "common/a/a.h"\n#include "tests/support/all.h"\n')
        self.write("tests/common/b/b_test.cpp", '#include "common/b/b.h"\n')
        self.write("tests/common/c/c_test.cpp", "")
        self.write("tests/support/all.h", "")
        self.write("answers/query/unit_tests", "unit_tests:\n  input: phony\n    tests/common/a/unit_tests\n  outputs:\n")
        self.write("answers/query/tests/common/a/unit_tests",
                   "tests/common/a/unit_tests:\n  input: phony\n    test/a_test\n    test/b_test\n    test/c_test\n"
                   "    test/child\n  outputs:\n    unit_tests\n")
        self.inputs("a_test", "tests/common/a/a_test.cpp", "common/a/a.cpp", "libgtest_main.a")
        self.inputs("b_test", "tests/common/b/b_test.cpp", "common/a/a.cpp", "common/c/c.cpp", "libgtest_main.a")
        self.inputs("c_test", "tests/common/c/c_test.cpp", "common/c/c.cpp", "libgtest_main.a")
        self.inputs("child", "common/a/a.cpp")

    def write(self, name: str, text: str) -> pathlib.Path:
        path = self.tree / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
        return path

    def inputs(self, program: str, *files: str) -> None:
        self.write(f"answers/inputs/test/{program}", "".join(f"{self.tree}/{file}\n" for file in files))

    def concerned(self, *changed: str) -> list[str]:
        command = [sys.executable, str(self.tree / "deploy/changed_tests.py"), "--build", "build", "--label", "unit", *changed]
        environment = {**os.environ, "PATH": f"{self.tree}:{os.environ['PATH']}"}
        run = subprocess.run(command, capture_output=True, text=True, check=True, env=environment)
        return run.stdout.split()

    def test_nothing_changed(self) -> None:
        self.assertEqual(self.concerned(), [])
        self.assertEqual(self.concerned("README.md", "common/d/d.h"), [])

    def test_all_of_a_label(self) -> None:
        self.assertEqual(self.concerned("--all"), ["test/a_test", "test/c_test", "test/b_test"])

    def test_a_source_concerns_all_that_link_it_its_own_test_first(self) -> None:
        self.assertEqual(self.concerned("common/a/a.cpp"), ["test/a_test", "test/b_test"])
        self.assertEqual(self.concerned("common/c/c.cpp"), ["test/c_test", "test/b_test"])

    def test_a_header_concerns_all_that_include_it_over_others(self) -> None:
        self.assertEqual(self.concerned("common/b/b.h"), ["test/b_test", "test/a_test"])

    def test_a_test_concerns_itself(self) -> None:
        self.assertEqual(self.concerned("tests/common/b/b_test.cpp"), ["test/b_test"])
        self.assertEqual(self.concerned("tests/support/all.h"), ["test/a_test"])

    def test_files_that_are_compiled_together_count_one_by_one(self) -> None:
        unity = "build/CMakeFiles/c_test.dir/Unity/unity_0_cxx.cxx"
        self.write(unity, "".join(f'#include "{self.tree}/{file}"\n' for file in ("tests/common/c/c_test.cpp", "common/c/c.cpp")))
        self.inputs("c_test", unity, "libgtest_main.a")
        self.assertEqual(self.concerned("common/c/c.cpp"), ["test/c_test", "test/b_test"])
        self.assertEqual(self.concerned("tests/common/c/c_test.cpp"), ["test/c_test"])

    def test_the_wire_contract_concerns_those_that_include_what_is_made_of_it(self) -> None:
        self.assertEqual(self.concerned("idl/words.idl"), ["test/c_test", "test/b_test"])


if __name__ == "__main__":
    unittest.main()
