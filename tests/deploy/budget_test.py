# SPDX-FileCopyrightText: 2026 The CoSLAM authors
# SPDX-License-Identifier: Apache-2.0
"""tests/benchmark/budget.py with a stand-in for a benchmark program: ratios below and above their ceilings."""

import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

SCRIPT = pathlib.Path(__file__).resolve().parents[1] / "benchmark" / "budget.py"
# Prints one ratio of the file `values` after the other.
STAND_IN = """#!/bin/sh
cd "$(dirname "$0")"
printf '{"benchmarks": [{"name": "BM_A/min_time:1", "ratio": %s}]}' "$(head -n 1 values)"
sed -i 1d values
"""


class Budget(unittest.TestCase):
    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.tree = pathlib.Path(folder.name)
        (self.tree / "program").write_text(STAND_IN)
        (self.tree / "program").chmod(0o755)

    def run_it(self, values: str, counter: str = "ratio") -> tuple[int, str]:
        (self.tree / "values").write_text(values)
        budget = {"ratios": [{"what": "A over B", "program": "program", "benchmark": "BM_A", "counter": counter, "ceiling": 2}]}
        (self.tree / "budget.json").write_text(json.dumps(budget))
        command = [sys.executable, str(SCRIPT), "--bin", str(self.tree), "--budget", str(self.tree / "budget.json")]
        run = subprocess.run(command, capture_output=True, text=True, check=False)
        return run.returncode, run.stdout + run.stderr

    def test_below(self) -> None:
        code, output = self.run_it("1.5\n9\n")
        self.assertEqual((code, output.split()[:4]), (0, ["fine", "1.5", "of", "2"]))

    def test_above_counts_only_twice(self) -> None:
        self.assertEqual(self.run_it("3\n1.5\n")[0], 0)
        code, output = self.run_it("3\n2.5\n")
        self.assertEqual((code, output.split()[:4]), (1, ["HIGH", "2.5", "of", "2"]))

    def test_what_is_not_measured_is_an_error(self) -> None:
        code, output = self.run_it("1\n", "bytes")
        self.assertEqual(code, 1)
        self.assertIn("measures no 'bytes' of 'BM_A'", output)

    def test_the_budget_is_well_formed(self) -> None:
        for ratio in json.loads(SCRIPT.with_name("budget.json").read_text())["ratios"]:
            self.assertEqual(set(ratio), {"what", "program", "benchmark", "counter", "ceiling"})


if __name__ == "__main__":
    unittest.main()
