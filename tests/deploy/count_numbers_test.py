# SPDX-FileCopyrightText: 2026 The CoSLAM authors
# SPDX-License-Identifier: Apache-2.0
"""deploy/count_numbers.py on small trees: what counts as a number, what the table has to say of each."""

import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

SCRIPT = pathlib.Path(__file__).resolve().parents[2] / "deploy" / "count_numbers.py"
LICENCE = "// SPDX-FileCopyrightText: 2026 The CoSLAM authors\n// SPDX-License-Identifier: Apache-2.0\n"
SOURCE = "server/estimator/room/a.cpp"
HEADER = "server/estimator/room/a.h"
CONFIG = """struct StageConfig {
  double near_m = 0.25;  // with a key
  int most = 7;          // without
  double twice_m = 2 * kBase_m;
};

template <class V>
void describe(V& v, StageConfig& c) {
  v.field("near_m", c.near_m, {0.01, 99}, "how near");
  v.field("twice_m", c.twice_m, {0.01, 99}, "twice as far");
}
"""


class Tree:
    """Some files of an estimator."""

    def __init__(self, files: dict[str, str]) -> None:
        self.folder = tempfile.TemporaryDirectory()
        self.root = pathlib.Path(self.folder.name)
        for name, text in files.items():
            path = self.root / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(LICENCE + text)

    def run(self, *options: str) -> tuple[int, str]:
        command = [sys.executable, SCRIPT, "--root", self.root, *options]
        run = subprocess.run(command, capture_output=True, text=True, check=False)
        return run.returncode, run.stdout + run.stderr

    def numbers(self) -> list[str]:
        """What was found, as `form name = value`."""
        return re.findall(r"^[^:\n]+:\d+: ((?:key|field|constant|literal) .* = .*) \(\S+\)$", self.run("--list")[1], re.MULTILINE)

    @property
    def table(self) -> pathlib.Path:
        return self.root / "docs/lab/numbers.csv"


class CountNumbers(unittest.TestCase):
    def numbers_in(self, text: str, name: str = SOURCE) -> list[str]:
        return Tree({name: text}).numbers()

    def test_constants(self) -> None:
        self.assertEqual(
            self.numbers_in("constexpr double kFar_m = 3.5;  // no 17\n"
                            "constexpr int kTwo = 2, kSeven = 7;\n"
                            "constexpr double kTwice_m = 2 * kFar_m;\n"
                            "constexpr std::string_view kName = \"99\";\n"
                            "void judge() {\n  constexpr double kNear = 0.5;\n}\n"
                            "class Grid {\n  static constexpr int kCells = 16;\n};\n"),
            ["constant kFar_m = 3.5", "constant kTwo = 2", "constant kSeven = 7", "constant judge.kNear = 0.5",
             "constant Grid.kCells = 16"])

    def test_literals(self) -> None:
        self.assertEqual(
            self.numbers_in("double judge(double x) {\n"
                            "  const std::array<int, 64> cells = fill(\"18\");\n"
                            "  if (x > 0.35 || x * 0.5 < 12) return x << 16;\n"
                            "  return 2.0 * x + 1e-9;  // 0.77\n"
                            "}\n"
                            "int solve(int most = 40);\n"),
            ["literal judge: 0.35 = 0.35", "literal judge: 1e-9 = 1e-9", "literal solve: 40 = 40"])

    def test_configurations(self) -> None:
        self.assertEqual(self.numbers_in(CONFIG, HEADER),
                         ["key StageConfig.near_m = 0.25", "field StageConfig.most = 7",
                          "key StageConfig.twice_m = 2 * kBase_m"])

    def test_each_number_needs_a_row_that_says_what_it_is(self) -> None:
        tree = Tree({HEADER: CONFIG, SOURCE: "constexpr int kSeven = 7;\n"})
        tree.table.parent.mkdir(parents=True)
        code, text = tree.run()
        self.assertEqual(code, 1)
        self.assertIn(f"{SOURCE}:3: kSeven = 7 has no row in docs/lab/numbers.csv", text)
        code, text = tree.run("--write")
        self.assertEqual(code, 1)
        self.assertIn(f"{SOURCE}:3: kSeven = 7 is of the kind ? in docs/lab/numbers.csv", text)
        tree.table.write_text(tree.table.read_text().replace(",?,?,", ",tuned,how far,"))
        code, text = tree.run()
        self.assertEqual((code, text.count("has no row")), (0, 0), text)
        self.assertIn("3 tuned numbers, 2 keys, 4 numbers, 0 to be put right", text)

    def test_a_row_follows_its_number(self) -> None:
        tree = Tree({SOURCE: "constexpr int kSeven = 7;\n"})
        tree.table.parent.mkdir(parents=True)
        tree.run("--write")
        tree.table.write_text(tree.table.read_text().replace(",?,?,", ",structural,days of a week,"))
        self.assertEqual(tree.run()[0], 0)
        (tree.root / SOURCE).write_text("constexpr int kSeven = 8;\n")
        self.assertIn("kSeven = 8 is 7 in its row", tree.run()[1])
        self.assertEqual(tree.run("--write")[0], 0)
        self.assertIn("8,,constant,structural,days of a week,", tree.table.read_text())
        (tree.root / SOURCE).write_text("constexpr int kEight = 8;\n")
        self.assertIn("kSeven of docs/lab/numbers.csv is not there", tree.run()[1])

    def test_no_files_are_no_success(self) -> None:
        self.assertEqual(Tree({"agent/a.cpp": "int x = 17;\n"}).run()[0], 1)


if __name__ == "__main__":
    unittest.main()
