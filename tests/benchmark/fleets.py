#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The CoSLAM authors
# SPDX-License-Identifier: Apache-2.0
"""What the map server costs by the number of cameras: a recording, played by so many fleets of its agents at once.

    fleets.py --bin DIR --recording FILE [--out DIR] [--stages N] FLEETS...

Prints a table, writes DIR/fleets.json. `cameras` is how many a frame set has in the mean, since fleets come and go one after
the other; the exponent is that of a power of it, fitted to the logarithms. Milliseconds are of the machine as it is: the ratios count.
"""

import argparse
import json
import math
import pathlib
import subprocess


def exponent(rows, of):
    """The slope of log(of) by log(cameras)."""
    points = [(math.log(r["cameras"]), math.log(of(r))) for r in rows if of(r) > 0]
    if len(points) < 2:
        return float("nan")
    x, y = (sum(p[i] for p in points) / len(points) for i in (0, 1))
    return sum((a - x) * (b - y) for a, b in points) / sum((a - x) ** 2 for a, _ in points)


def run(arguments, fleets):
    out = pathlib.Path(arguments.out) / f"fleets-{fleets}"
    command = [f"{arguments.bin}/coslam", "replay", arguments.recording, "--fleets", str(fleets), "--out", str(out), "--force",
               "--set", "server.bundle_adjustment.at_end=nothing"]
    with open(f"{out}.log", "w") as log:
        subprocess.run(command, stdout=log, stderr=subprocess.STDOUT, check=True)
    report = json.loads((out / "report.json").read_text())
    sets, ms = report["frame_sets"], report["server"]["ms"]

    def per_set(stage):
        return ms[stage]["mean"] * ms[stage]["count"] / sets if stage in ms else 0

    beside = ("bundle", "bundle_outline")
    return {"fleets": fleets, "cameras": report["frames"] / sets, "sets": sets, "set_ms": per_set("frame_set"),
            "set_p99_ms": ms["frame_set"]["p99"], "beside_ms": sum(map(per_set, beside)), "maps": report["server"]["maps"],
            "peak_mib": report["server"]["peak_memory_mib"],
            "stages": {s: per_set(s) for s in ms if s not in (*beside, "frame_set", "finish", "close_loops_offline")}}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", required=True)
    parser.add_argument("--recording", required=True)
    parser.add_argument("--out", default="fleets")
    parser.add_argument("--stages", type=int, default=10, help="so many of the dearest are shown")
    parser.add_argument("fleets", nargs="+", type=int)
    arguments = parser.parse_args()
    pathlib.Path(arguments.out).mkdir(parents=True, exist_ok=True)
    rows = []
    print("cameras  ms a set    p99  beside  maps  peak MiB", flush=True)
    for fleets in sorted(set(arguments.fleets)):
        rows.append(r := run(arguments, fleets))
        print(f"{r['cameras']:7.1f} {r['set_ms']:9.2f} {r['set_p99_ms']:6.1f} {r['beside_ms']:7.2f} {r['maps']:5d} {r['peak_mib']:9.0f}",
              flush=True)
    exponents = {"ms a set": exponent(rows, lambda r: r["set_ms"]), "beside": exponent(rows, lambda r: r["beside_ms"]),
                 "peak MiB": exponent(rows, lambda r: r["peak_mib"])}
    print("exponent: " + ", ".join(f"{name} {e:.2f}" for name, e in exponents.items()))
    dearest = sorted(rows[-1]["stages"].items(), key=lambda s: -s[1])[:arguments.stages]
    for stage, _ in dearest:
        by_fleets = " ".join(f"{r['stages'].get(stage, 0):8.2f}" for r in rows)
        print(f"{stage:12s} {by_fleets}   exponent {exponent(rows, lambda r: r['stages'].get(stage, 0)):.2f}")
    (pathlib.Path(arguments.out) / "fleets.json").write_text(json.dumps({"runs": rows, "exponents": exponents}, indent=1))


if __name__ == "__main__":
    main()
