#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The CoSLAM authors
# SPDX-License-Identifier: Apache-2.0
"""Runs clang-tidy over C++ files and remembers which were clean.

    deploy/tidy_files.py --build DIR [--clang-tidy PROGRAM] [--jobs N] [--seconds N] [--again] FILE...

DIR holds compile_commands.json; a file that is not in there is left out. A file is not checked again while nothing that
decides is different: the program, .clang-tidy, how the file is compiled, and the content of all that it includes.
`--again` checks it all the same. Each file's complaints are printed in one piece. After `--seconds` what is left is left
out, and named. Exit code 0: all clean; 1: not; 2: wrong usage. deploy/lint.sh calls this.
"""

import argparse
import concurrent.futures
import hashlib
import json
import math
import pathlib
import shlex
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent


class Checker:
    """Threads may share one: what it keeps is only added to."""

    def __init__(self, build: pathlib.Path, program: str, again: bool, seconds: float = math.inf) -> None:
        self.until = time.monotonic() + seconds
        self.late: list[str] = []  # for which no time was left
        self.build = build
        self.program = program
        self.again = again
        self.known_clean = build / "tidy-clean"  # a file for each source, with the key it was clean with
        self.known_clean.mkdir(parents=True, exist_ok=True)
        self.hashes: dict[str, str] = {}
        version = subprocess.run([program, "--version"], capture_output=True, text=True, check=True).stdout
        self.common = version + "".join(self.hash_of(str(ROOT / name)) for name in (".clang-tidy", "tests/.clang-tidy"))
        entries = json.loads((build / "compile_commands.json").read_text())
        self.entries = {str(pathlib.Path(entry["directory"], entry["file"])): entry for entry in entries}

    def hash_of(self, file: str) -> str:
        if file not in self.hashes:
            path = pathlib.Path(file)
            self.hashes[file] = hashlib.sha256(path.read_bytes()).hexdigest() if path.is_file() else "none"
        return self.hashes[file]

    def includes_of(self, entry: dict) -> list[str] | None:
        """All files that the compiler reads for a source, that one included; None when it cannot say."""
        command = entry.get("arguments") or shlex.split(entry["command"])
        if pathlib.Path(command[0]).name == "ccache":
            command = command[1:]
        kept, skip = [], False
        for word in command:
            if not skip and word not in {"-c", "-MD", "-MMD", "-o", "-MF", "-MT", "-MQ"}:
                kept.append(word)
            skip = not skip and word in {"-o", "-MF", "-MT", "-MQ"}
        run = subprocess.run([*kept, "-M"], cwd=entry["directory"], capture_output=True, text=True, check=False)
        if run.returncode != 0:
            return None
        names = shlex.split(run.stdout.partition(":")[2].replace("\\\n", " "))
        return [str(pathlib.Path(entry["directory"], name)) for name in names]

    def key_of(self, entry: dict) -> str | None:
        includes = self.includes_of(entry)
        if includes is None:
            return None
        parts = [self.common, json.dumps(entry, sort_keys=True), *(f"{name} {self.hash_of(name)}" for name in includes)]
        return hashlib.sha256("\n".join(parts).encode()).hexdigest()

    def check(self, file: str) -> tuple[str, bool]:
        """What to print of a file, and whether it may stay as it is."""
        entry = self.entries.get(str(ROOT / file))
        if entry is None:
            return f"  not built, left out: {file}", True
        key = self.key_of(entry)
        note = self.known_clean / file.replace("/", "__")
        if not self.again and key is not None and note.is_file() and note.read_text() == key:
            return f"  clean before: {file}", True
        start = time.monotonic()
        command = [self.program, "--quiet", "-p", str(self.build), str(ROOT / file)]
        left = None if math.isinf(self.until) else max(0.0, self.until - start)
        try:
            run = subprocess.run(command, capture_output=True, text=True, check=False, timeout=left)
        except subprocess.TimeoutExpired:
            self.late.append(file)
            return f"  out of time: {file}", True
        if run.returncode == 0:
            if key is not None:
                note.write_text(key)
            return f"  clean: {file} ({time.monotonic() - start:.0f} s)", True
        note.unlink(missing_ok=True)
        report = run.stdout.strip() or f"clang-tidy itself failed on {file}:\n{run.stderr.strip()}"
        return report.replace(f"{ROOT}/", ""), False


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", type=pathlib.Path, required=True)
    parser.add_argument("--clang-tidy", default="clang-tidy")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--seconds", type=float, default=math.inf)
    parser.add_argument("--again", action="store_true")
    parser.add_argument("files", nargs="*")
    arguments = parser.parse_args()

    checker = Checker(arguments.build.resolve(), arguments.clang_tidy, arguments.again, arguments.seconds)
    bad = []
    with concurrent.futures.ThreadPoolExecutor(max(1, arguments.jobs)) as pool:
        for file, (text, clean) in zip(arguments.files, pool.map(checker.check, arguments.files)):
            print(text, flush=True)
            if not clean:
                bad.append(file)
    if checker.late:
        print(f"left out, because time ran out: {' '.join(sorted(checker.late))}")
    if bad:
        print(f"clang-tidy found something in {len(bad)} of {len(arguments.files)} files: {' '.join(bad)}")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
