#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The CoSLAM authors
# SPDX-License-Identifier: Apache-2.0
"""Counts the instructions that the tracker takes for a frame, by its portable kernels and by those of the vector unit.

    instructions.py --images FOLDER [--bin DIR] [--frames N] [--symbols] [--ceiling RATIO]

--bin: where coslam_benchmark_frames is, built for amd64 or arm64 (default: build-arm64/bin). A count is the difference of
two runs, of 10 and of 10 + N frames (default: 40), and the same on every machine: of arm64 in QEMU, of amd64 by callgrind,
since QEMU 7.2 gets AVX2 wrong. --symbols also says which functions take most (arm64). Exit code 1 where vector over portable
is above the ceiling, or the tracks differ. Needs gcc and Debian's packages qemu-user (the static one loads no plugins) or
valgrind; QEMU names the folder of QEMU's programs, if it is another.
"""

import argparse
import os
import pathlib
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
FIRST = 10


def is_amd64(program: pathlib.Path) -> bool:
    return program.read_bytes()[18:20] == b"\x3e\x00"


def run(command: list, log: str) -> tuple[list[list[str]], str]:
    """The words of the log's lines, and what the program says about its tracks."""
    done = subprocess.run([str(word) for word in command], stdout=subprocess.PIPE, text=True, check=True)
    return [line.split() for line in pathlib.Path(log).read_text().splitlines()], done.stdout.strip()


def count(program: pathlib.Path, plugin: str, *arguments: str) -> tuple[dict[str, int], str]:
    """Instructions by symbol, those of all under `instructions`, and what the program says."""
    with tempfile.NamedTemporaryFile("r") as log:
        if is_amd64(program):
            lines, said = run(["valgrind", "--tool=callgrind", "--callgrind-out-file=/dev/null", f"--log-file={log.name}",
                               program, *arguments], log.name)
            return {"instructions": next(int(words[3]) for words in lines if words[1:3] == ["Collected", ":"])}, said
        cache = pathlib.Path(os.environ.get("XDG_CACHE_HOME", pathlib.Path.home() / ".cache"))
        emulator = pathlib.Path(os.environ["QEMU"]) / "qemu-aarch64" if "QEMU" in os.environ else "qemu-aarch64"
        lines, said = run([emulator, "-L", os.environ.get("COSLAM_SYSROOT", cache / "coslam-arm64"), "-plugin",
                           f"{plugin},symbols=on", "-d", "plugin", "-D", log.name, program, *arguments], log.name)
    return {name: int(number) for number, name in lines}, said


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--images", required=True)
    parser.add_argument("--bin", type=pathlib.Path, default=HERE.parents[1] / "build-arm64" / "bin")
    parser.add_argument("--frames", type=int, default=40)
    parser.add_argument("--symbols", action="store_true")
    parser.add_argument("--ceiling", type=float)
    arguments = parser.parse_args()
    program = arguments.bin / "coslam_benchmark_frames"
    with tempfile.TemporaryDirectory() as folder:
        plugin = f"{folder}/count_instructions.so"
        subprocess.run(["gcc", "-O2", "-shared", "-fPIC", "-o", plugin, HERE / "count_instructions.c"], check=True)
        totals, said = {}, {}
        for kernels in ("portable", "vector"):
            few, _ = count(program, plugin, kernels, str(FIRST), arguments.images)
            many, said[kernels] = count(program, plugin, kernels, str(FIRST + arguments.frames), arguments.images)
            a_frame = {name: (many[name] - few.get(name, 0)) / arguments.frames for name in many}
            totals[kernels] = a_frame.pop("instructions")
            print(f"{kernels:8} {totals[kernels] / 1e6:8.2f} million instructions a frame; {said[kernels]}", flush=True)
            if arguments.symbols:
                for name in sorted(a_frame, key=a_frame.get, reverse=True)[:16]:
                    print(f"    {a_frame[name] / 1e6:8.3f} {name}")
    ratio = totals["vector"] / totals["portable"]
    print(f"vector over portable: {ratio:.3f}")
    same = said["vector"] == said["portable"]
    if not same:
        print("the tracks differ")
    return 0 if same and (arguments.ceiling is None or ratio <= arguments.ceiling) else 1


if __name__ == "__main__":
    sys.exit(main())
