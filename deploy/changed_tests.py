#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The CoSLAM authors
# SPDX-License-Identifier: Apache-2.0
"""Prints the test programs that a change concerns, those that lie closest to it first.

    deploy/changed_tests.py --build DIR --label LABEL FILE...
    deploy/changed_tests.py --build DIR --label LABEL --all

DIR is configured for Ninja, and need not be built. A program is concerned when a source of its own or of its libraries
is one of FILE... (relative to the root) or includes one, over however many steps. First come programs that have a changed
file of their own or test the folder of one; among these, and among the others, those of few sources. `--all`: whatever changed.
"""

import argparse
import functools
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
UNITY = re.compile(r"/Unity/unity_\d+_cxx\.cxx$")  # what CMake writes to compile the files of a folder together
INCLUDE = re.compile(r'^\s*#\s*include\s+"([^"]+)"', re.MULTILINE)


def ask(build: pathlib.Path, tool: str, target: str) -> list[str]:
    run = subprocess.run(["ninja", "-C", str(build), "-t", tool, target], capture_output=True, text=True, check=True)
    return run.stdout.splitlines()


def programs(build: pathlib.Path, target: str) -> set[str]:
    """What a target of no file of its own stands for."""
    found: set[str] = set()
    for line in ask(build, "query", target):
        name = line.strip()
        if line == "  outputs:":
            break
        if name.startswith("test/"):
            found.add(name)
        elif name.endswith(f"/{target}"):  # the same target in the folder that made it
            found |= programs(build, name)
    return found


@functools.cache
def includes(file: str) -> tuple[str, ...]:
    path = ROOT / file
    return tuple(INCLUDE.findall(path.read_text(errors="replace"))) if path.is_file() else ()


def reads(sources: list[str]) -> set[str]:
    """The sources and all of ours that they include."""
    found, left = set(sources), list(sources)
    while left:
        new = [file for file in includes(left.pop()) if file not in found]
        found.update(new)
        left += new
    return found


def sources_among(build: pathlib.Path, parts: list[str]) -> list[str]:
    """Sources of the tree, relative to the root, among what a program is made of."""
    files: list[str] = []
    for part in parts:
        files += INCLUDE.findall((build / part).read_text()) if UNITY.search(part) else [part]
    return [file.removeprefix(f"{ROOT}/") for file in files if file.startswith(f"{ROOT}/") and file.endswith(".cpp")]


def mirrors(source: str, file: str) -> bool:
    """Whether a source of tests/ lies in the folder that tests the file's."""
    return pathlib.PurePath(source).parent == pathlib.PurePath("tests", file).parent


def concerned(build: pathlib.Path, label: str, changed: set[str], everything: bool) -> list[str]:
    found = []
    for program in programs(build, f"{label}_tests"):
        parts = ask(build, "inputs", program)
        if not any("libgtest" in part for part in parts):
            continue  # what a test starts
        sources = sources_among(build, parts)
        if not everything and not reads(sources) & changed:
            continue
        own = [source for source in sources if source.startswith("tests/") and not source.startswith("tests/support/")]
        close = any(source in changed or mirrors(source, file) for source in own for file in changed)
        found.append((not close, len(sources), program))
    return [program for _, _, program in sorted(found)]


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", type=pathlib.Path, required=True)
    parser.add_argument("--label", required=True)
    parser.add_argument("--all", action="store_true")
    parser.add_argument("files", nargs="*")
    arguments = parser.parse_args()
    changed = set(arguments.files)
    for file in arguments.files:
        if file.endswith(".idl"):  # by what is made of it
            changed |= {file.replace(".idl", end) for end in (".h", "PubSubTypes.h")}
    for program in concerned(arguments.build, arguments.label, changed, arguments.all):
        print(program)
    return 0


if __name__ == "__main__":
    sys.exit(main())
