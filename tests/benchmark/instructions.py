#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The CoSLAM authors
# SPDX-License-Identifier: Apache-2.0
"""Counts the instructions that the tracker takes for a frame, by its portable kernels and by those of the vector unit.

    instructions.py --images FOLDER [--bin DIR] [--frames N] [--symbols] [--ceiling RATIO]

--bin: where coslam_benchmark_frames is, built for amd64 or arm64 (default: build-arm64/bin). A count is the difference of
two runs in QEMU, of 10 and of 10 + N frames (default: 40), and the same on every machine. --symbols also says which
functions take most. Exit code 1 where vector over portable is above the ceiling, or the tracks differ. Needs gcc and Debian's
package qemu-user (the static one loads no plugins); QEMU names its programs' folder, if it is another.
"""

import argparse
import os
import pathlib
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
FIRST = 10


def architecture_of(program: pathlib.Path) -> str:
    machine = program.read_bytes()[18:20]
    return {b"\x3e\x00": "x86_64", b"\xb7\x00": "aarch64"}[machine]


def emulator(program: pathlib.Path) -> list[str]:
    name = "qemu-" + architecture_of(program)
    command = [str(pathlib.Path(os.environ["QEMU"]) / name) if "QEMU" in os.environ else name]
    if name == "qemu-aarch64":
        cache = pathlib.Path(os.environ.get("XDG_CACHE_HOME", pathlib.Path.home() / ".cache"))
        command += ["-L", os.environ.get("COSLAM_SYSROOT", str(cache / "coslam-arm64"))]
    return command


def count(program: pathlib.Path, plugin: str, kernels: str, frames: int, images: str) -> tuple[dict[str, int], str]:
    """Instructions by symbol, and what the program says about its tracks."""
    with tempfile.NamedTemporaryFile("r") as log:
        run = subprocess.run([*emulator(program), "-plugin", f"{plugin},symbols=on", "-d", "plugin", "-D", log.name,
                              program, kernels, str(frames), images], stdout=subprocess.PIPE, text=True, check=True)
        lines = [line.split() for line in log.read().splitlines()]
    return {name: int(number) for number, name in lines}, run.stdout.strip()


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
            few, _ = count(program, plugin, kernels, FIRST, arguments.images)
            many, said[kernels] = count(program, plugin, kernels, FIRST + arguments.frames, arguments.images)
            a_frame = {name: (many[name] - few.get(name, 0)) / arguments.frames for name in many}
            totals[kernels] = a_frame.pop("instructions")
            print(f"{architecture_of(program)} {kernels:8} {totals[kernels] / 1e6:8.2f} million instructions a frame; {said[kernels]}", flush=True)
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
