#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The CoSLAM authors
# SPDX-License-Identifier: Apache-2.0
"""Measures the ratios of budget.json and compares each with its ceiling.

    budget.py --bin DIR [--budget FILE]

DIR holds the benchmark programs. Both sides of a ratio are measured in one run, in turn. One that is too high is measured
once more, and the lower counts. Exit code 0: all below; 1: not. deploy/benchmark.sh calls this.
"""

import argparse
import json
import pathlib
import subprocess
import sys


def measure(folder: pathlib.Path, ratio: dict) -> float:
    name = ratio["benchmark"]
    command = [str(folder / ratio["program"]), f"--benchmark_filter=^{name}(/min_time.*)?$", "--benchmark_format=json",
               "--benchmark_min_time=0.5"]
    run = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True, check=True)
    results = json.loads(run.stdout)["benchmarks"]
    if len(results) != 1 or ratio["counter"] not in results[0]:
        sys.exit(f"{ratio['program']} measures no '{ratio['counter']}' of '{name}'")
    return float(results[0][ratio["counter"]])


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", type=pathlib.Path, required=True)
    parser.add_argument("--budget", type=pathlib.Path, default=pathlib.Path(__file__).with_name("budget.json"))
    arguments = parser.parse_args()
    high = 0
    for ratio in json.loads(arguments.budget.read_text())["ratios"]:
        value = measure(arguments.bin, ratio)
        if value > ratio["ceiling"]:
            value = min(value, measure(arguments.bin, ratio))
        high += value > ratio["ceiling"]
        print(f"{'HIGH' if value > ratio['ceiling'] else 'fine'}  {value:8.3g} of {ratio['ceiling']:<6g} {ratio['what']}", flush=True)
    return 1 if high else 0


if __name__ == "__main__":
    sys.exit(main())
