#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The CoSLAM authors
# SPDX-License-Identifier: Apache-2.0
"""How accurate the product is: each sequence run several times from slightly different starts, in one table.

    accuracy.py --bin DIR [--data DIR] [--only NAME,...] [--runs N] [--jobs N] [--set key=value ...]
                [--out FILE.json] [--markdown FILE.md] [--compare OTHER.json] [--list]

A single run says little, as the luck of its first images decides much. So run i begins i % 5 steps later and follows
another number of tracks; of simulated scenes only the number of tracks differs. Each run is `coslam run --inline`, in a
temporary folder that goes away. A line a sequence is printed as soon as its runs are done:

    final    joint ATE in metres after the whole adjustment: geometric mean, and the worst run in brackets
    live     the same of the poses as the agents had them at the time
    tracked  percent of an agent's images with a pose in the common map: the worst agent of the worst run
    maps     in how many runs there was one map in the end (of twins: two, as is right)
    scale    geometric mean of how far the size is off, in percent, where the map is in metres
    ms       of the server a frame set, of an agent an image, means; of the machine as it is

Of zed_lab_shelf, whose truth is another tracker's, `final` is the error of the relative pose of its two cameras. A run that
fails is named with its error, and in no mean. --compare takes what --out wrote before, and tells ratios of geometric
means, new to old, over the runs that went well both times. Exit code 0: all ran; 1: a run failed.
"""

import argparse
import concurrent.futures
import dataclasses
import decimal
import json
import math
import pathlib
import re
import statistics
import subprocess
import sys
import tempfile
import threading
import time

STARTS = 5
TRACKS = (298, 300, 302, 304, 306, 308, 310, 296, 294, 292)  # as many as the default, but for 3 %
MOST_RUNS = 2 * len(TRACKS)  # more would be the same once more
SIMULATED = "sim:"
RENDERING = threading.Lock()


@dataclasses.dataclass(frozen=True)
class Sequence:
    name: str  # of the file without .yaml, in the folder of the data; or sim:NAME
    step_s: str = "0"  # by which starts differ
    orb_slam3: str = "-"  # ATE m, one camera, where it was measured
    maps: int = 1  # that there are in truth
    final: str = "ate_m"  # what is told of the final poses
    live: str = "live_ate_m"  # and of those at the time


SEQUENCES = [
    *(Sequence(f"kitti_raw_0005/{n}", "0.1", "0.076 to 0.115") for n in ("single", "pair", "near", "follow")),
    *(Sequence(f"kitti_06/{n}", "0.1", "0.026 to 0.059") for n in ("single", "follow", "stereo", "stereo_rig")),
    Sequence("euroc_mh05/follow", "0.15", "0.040"),
    *(Sequence(f"euroc_mh05/{n}", "0.15") for n in ("follow_half", "three", "single")),
    Sequence("sevenscenes_redkitchen/pair", "0.1667", "0.052"),
    *(Sequence(f"sevenscenes_redkitchen/{n}", "0.1667") for n in ("apart", "four")),
    Sequence("tum_fr1_rpy/single", "0.1333", "0.032 to 0.043"),
    Sequence("dmvio_room/single", "0.2"),
    Sequence("zed_lab_shelf/stereo", "0.1", final="relative_pose_m", live="none"),
    *(Sequence(SIMULATED + n, maps=2 if n == "twins" else 1) for n in (
        "room", "wall", "walking-man", "stopping-man", "sitting-man", "courtyard", "tag", "twins", "atrium", "street", "swarm")),
]


def begin_of(sequence, i):
    """By how many seconds run i begins later, and how many tracks it follows."""
    return i % STARTS * decimal.Decimal(sequence.step_s), TRACKS[i % len(TRACKS)] + i // len(TRACKS)


def later_truth(file, later_s):
    """Truth is in played time, which counts from where a source is begun."""
    lines = []
    for line in file.read_text(encoding="ascii").splitlines():
        if line.strip() and not line.startswith("#"):
            t_s, pose = line.split(maxsplit=1)
            if decimal.Decimal(t_s) >= later_s:
                lines.append(f"{decimal.Decimal(t_s) - later_s} {pose}\n")
    return "".join(lines)


def later_agent(text, source_folder, folder, later_s):
    """`{name: ..., source: ...}` of an agent with absolute paths and a later start."""
    agent = dict(field.split(": ", 1) for field in text.strip("{} ").split(", "))
    for key in ("source", "calibration"):
        agent[key] = json.dumps(str(source_folder / agent[key]))
    agent["start_s"] = decimal.Decimal(agent.get("start_s", "0")) + later_s
    if "truth" in agent:
        shifted = folder / (agent["name"] + ".tum")
        shifted.write_text(later_truth(source_folder / agent["truth"], later_s), encoding="ascii")
        agent["truth"] = json.dumps(str(shifted))
    return "{" + ", ".join(f"{key}: {value}" for key, value in agent.items()) + "}"


def begun_later(file, folder, later_s):
    """A copy of a sequence in a folder, all agents begun so much later. What is told by frame number or played time (masks,
    moving points, overlap) would be wrong and is left out."""
    lines = []
    for line in file.read_text(encoding="utf-8").splitlines():
        if re.match(r"#|(masks|truth_points|overlap):", line):
            continue
        agent = re.match(r"( *- )(\{name: .*\})$", line)
        lines.append(agent[1] + later_agent(agent[2], file.parent, folder, later_s) if agent else line)
    copy = folder / "sequence.yaml"
    copy.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return copy


def call(command, limit_s):
    """Standard output of a program; RuntimeError with what it said last when it failed."""
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, timeout=limit_s, check=False)
    if done.returncode != 0:
        said = (done.stderr.strip() or done.stdout.strip() or "said nothing").splitlines()[-1]
        raise RuntimeError(f"coslam {command[1]} ended with {done.returncode}: {said}")
    return done.stdout


def figures(sequence, report, evaluation):
    def tracked(a):
        return 100 * (a["poses"] + (a["poses_apart"] if sequence.maps > 1 else 0)) / max(1, a["frames"])

    scale = evaluation["scale"]
    out = {"ate_m": evaluation["ate_m"], "live_ate_m": evaluation["live"]["ate_m"],
           "relative_pose_m": (evaluation["relative_pose"] or {}).get("translation_m"), "scale": scale,
           "scale_off_percent": 100 * abs(scale - 1) if scale and report["server"]["scale_known"] else None,
           "tracked_percent": min(map(tracked, evaluation["agents"].values())), "maps": len(report["maps"]),
           "server_ms": report["server"]["ms"]["frame_set"]["mean"],
           "agent_ms": statistics.mean(a["ms"]["frame"]["mean"] for a in report["agents"].values()), "version": report["version"]}
    if out[sequence.final] is None:
        out["error"] = f"no error against the truth: {evaluation['problem'] or 'no poses of two cameras together'}"
    return out


def render(coslam, scene, limit_s):
    """Runs of a new scene would each render it, in their own time. This does so, and ends as there is no such agent."""
    with RENDERING:
        subprocess.run([coslam, "run", scene, "--agents", "nobody"], capture_output=True, timeout=limit_s, check=False)


def run(arguments, sequence, i):
    """Run i of a sequence: how it began, and its figures or the error with which it failed."""
    later_s, tracks = begin_of(sequence, i)
    out = {"run": i, "later_s": float(later_s), "max_tracks": tracks}
    try:
        with tempfile.TemporaryDirectory(prefix="coslam-accuracy-") as temporary:
            folder, coslam = pathlib.Path(temporary), pathlib.Path(arguments.bin) / "coslam"
            played = sequence.name
            if played.startswith(SIMULATED):
                render(coslam, played, arguments.limit_s)
            else:
                played = (pathlib.Path(arguments.data) / (played + ".yaml")).resolve()
            if later_s > 0:
                played = begun_later(played, folder, later_s)
            sets = ["--set", f"agent.tracker.max_tracks={tracks}", *(word for s in arguments.set for word in ("--set", s))]
            begin = time.monotonic()
            call([coslam, "run", played, "--inline", "--out", folder / "result", *sets], arguments.limit_s)
            out["wall_s"] = time.monotonic() - begin
            evaluation = json.loads(call([coslam, "eval", folder / "result", played, "--json"], arguments.limit_s))
            report = json.loads((folder / "result" / "report.json").read_text(encoding="utf-8"))
            out.update(figures(sequence, report, evaluation))
    except subprocess.TimeoutExpired:
        out["error"] = f"not done within {arguments.limit_s:g} s"
    except Exception as error:  # whatever it is, the other runs go on
        out["error"] = f"{type(error).__name__}: {error}"
    return out


def geometric_mean(values):
    known = [max(v, 1e-9) for v in values if v is not None]
    return math.exp(statistics.fmean(map(math.log, known))) if known else None


def summary(sequence, runs):
    good = [r for r in runs if "error" not in r]

    def of(measure, key):
        known = [r[key] for r in good if r.get(key) is not None]
        return measure(known) if known else None

    return {"runs": len(runs), "failed": len(runs) - len(good), "final_m": of(geometric_mean, sequence.final),
            "final_worst_m": of(max, sequence.final), "live_m": of(geometric_mean, sequence.live),
            "live_worst_m": of(max, sequence.live), "tracked_percent": of(min, "tracked_percent"),
            "right_maps": sum(r["maps"] == sequence.maps for r in good),
            "more_maps": sum(r["maps"] > sequence.maps for r in good),
            "scale_off_percent": of(geometric_mean, "scale_off_percent"), "server_ms": of(statistics.fmean, "server_ms"),
            "agent_ms": of(statistics.fmean, "agent_ms"), "wall_s": of(statistics.fmean, "wall_s")}


def number(value, decimals):
    return "-" if value is None else f"{value:.{decimals}f}"


def mean_and_worst(s, key):
    mean, worst = s[key + "_m"], s[key + "_worst_m"]
    return "-" if mean is None else " ".join([number(mean, 4), f"({number(worst, 4)})"])


def maps_of(s):
    return f"{s['right_maps']} of {s['runs']}"


COLUMNS = "{:28s} {:>17s} {:>17s} {:>8s} {:>8s} {:>8s} {:>7s} {:>6s} {:>7s}".format
HEAD = COLUMNS("sequence", "final m", "live m", "tracked", "maps", "scale %", "server", "agent", "wall s")


def line(sequence, s):
    text = COLUMNS(sequence.name, mean_and_worst(s, "final"), mean_and_worst(s, "live"), number(s["tracked_percent"], 1),
                   maps_of(s), number(s["scale_off_percent"], 2), number(s["server_ms"], 1), number(s["agent_ms"], 1),
                   number(s["wall_s"], 0))
    return text + (f"  {s['failed']} of {s['runs']} FAILED" if s["failed"] else "")


def markdown(results):
    rows = ["| sequence | final, mean (worst) | live, mean (worst) | tracked % | one map in | ORB-SLAM3, one camera |",
            "|---|---|---|---|---|---|"]
    for sequence, runs in results:
        s = summary(sequence, runs)
        name = sequence.name + (", relative pose" if sequence.final != "ate_m" else "")
        name += f" ({s['failed']} of {s['runs']} runs failed)" if s["failed"] else ""
        cells = [name, mean_and_worst(s, "final"), mean_and_worst(s, "live"), number(s["tracked_percent"], 1),
                 maps_of(s) + (" in two" if sequence.maps > 1 else ""), sequence.orb_slam3]
        rows.append("| " + " | ".join(cells) + " |")
    return "\n".join(rows) + "\n"


def as_json(arguments, results):
    return json.dumps({"set": arguments.set, "sequences": {
        sequence.name: {"summary": summary(sequence, runs), "runs": runs} for sequence, runs in results}}, indent=1)


def compare(results, file):
    """Prints ratios of geometric means to those of a file, over the runs that began alike and went well both times."""
    before = json.loads(pathlib.Path(file).read_text(encoding="utf-8"))["sequences"]
    text = "{:28s} {:>8s} {:>8s} {:>10s} {:>10s} {:>5s}".format
    rows = []
    print(f"\nratios to {file}\n" + text("sequence", "final", "live", "server ms", "agent ms", "runs"))
    for sequence, runs in results:
        old = {(r["later_s"], r["max_tracks"]): r for r in before.get(sequence.name, {"runs": []})["runs"] if "error" not in r}
        both = [(r, old.get((r["later_s"], r["max_tracks"]))) for r in runs if "error" not in r]
        both = [(new, old) for new, old in both if old]
        rows.append([geometric_mean(new[key] / old[key] for new, old in both if new.get(key) and old.get(key))
                     for key in (sequence.final, sequence.live, "server_ms", "agent_ms")])
        print(text(sequence.name, *(number(r, 3) for r in rows[-1]), str(len(both))))
    print(text("all", *(number(geometric_mean(r), 3) for r in zip(*rows)), ""))


def measure(arguments, chosen):
    """All runs, so many at once; the lines come in the order of the table."""
    results = []
    pool = concurrent.futures.ThreadPoolExecutor(arguments.jobs)
    try:
        waiting = [(s, [pool.submit(run, arguments, s, i) for i in range(arguments.runs)]) for s in chosen]
        print(HEAD, flush=True)
        for sequence, futures in waiting:
            runs = [f.result() for f in futures]
            results.append((sequence, runs))
            print(line(sequence, summary(sequence, runs)), flush=True)
            for r in runs:
                if "error" in r:
                    print(f"    run {r['run']}, {r['later_s']:g} s later, {r['max_tracks']} tracks: {r['error']}", flush=True)
            if arguments.out:  # hours may follow
                pathlib.Path(arguments.out).write_text(as_json(arguments, results), encoding="utf-8")
    finally:
        pool.shutdown(cancel_futures=True)
    return results


def named(sequence, word):
    """By its name or its folder's."""
    return sequence.name == word or sequence.name.startswith(word + "/")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", default="build/bin", help="folder of the programs")
    parser.add_argument("--data", default="../shared/data", help="folder of the recorded sequences")
    parser.add_argument("--only", help="names of --list, or their folders, with commas between")
    parser.add_argument("--runs", type=int, default=10, choices=range(1, MOST_RUNS + 1), metavar="N",
                        help="of each sequence; at most 20")
    parser.add_argument("--jobs", type=int, default=2, help="runs at once")
    parser.add_argument("--limit-s", type=float, default=3600, help="a run that takes longer has failed")
    parser.add_argument("--set", nargs="+", action="extend", default=[], metavar="key=value", help="for coslam run")
    parser.add_argument("--out", help="JSON of all runs, written anew after each sequence")
    parser.add_argument("--markdown", help="the table")
    parser.add_argument("--compare", metavar="OTHER.json", help="what --out wrote before")
    parser.add_argument("--list", action="store_true", help="only print the sequences")
    arguments = parser.parse_args()
    words = arguments.only.split(",") if arguments.only else []
    for word in words:
        if not any(named(s, word) for s in SEQUENCES):
            parser.error(f"--only: there is no '{word}'; see --list")
    chosen = [s for s in SEQUENCES if not words or any(named(s, word) for word in words)]
    if arguments.list:
        for s in chosen:
            print(f"{s.name:28s} starts {s.step_s:>6s} s apart; ORB-SLAM3 {s.orb_slam3}")
        return 0
    if not (pathlib.Path(arguments.bin) / "coslam").exists():
        parser.error(f"--bin: there is no coslam in {arguments.bin}")
    if arguments.compare and not pathlib.Path(arguments.compare).exists():
        parser.error(f"--compare: there is no {arguments.compare}")
    results = measure(arguments, chosen)
    table = markdown(results)
    print("\n" + table, end="")
    if arguments.markdown:
        pathlib.Path(arguments.markdown).write_text(table, encoding="utf-8")
    if arguments.compare:
        compare(results, arguments.compare)
    return int(any("error" in r for _, runs in results for r in runs))


if __name__ == "__main__":
    sys.exit(main())
