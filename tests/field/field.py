#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The CoSLAM authors
# SPDX-License-Identifier: Apache-2.0
"""Runs agents and their server on hosts of their own and breaks links, clocks and processes between them.

    field.py --bin DIR --sequence FILE [--untriggered FILE] [--out DIR] [--only FAULT]... [--list]

Prints a table against the same run without a fault: joint ATE in metres and as a ratio, percent of an agent's images with a
pose in the server's map (of the worst agent), frame time, and what was lost where. Exit code 0: ran; 1: a program failed; 77: this machine cannot have such hosts.
"""

import argparse
import glob
import json
import os
import pathlib
import pickle
import re
import shutil
import signal
import subprocess
import sys
import time

import yaml

sys.dont_write_bytecode = True
from hosts import Hosts, Link, Unavailable  # noqa: E402

SKIPPED = 77
CRASHES = "the same without a key"  # what a key is for
DISK_FULL = "the server's disk full for 6 s"
UNTRIGGERED = "cameras not triggered together: the first, 29.3 Hz, 9.8 Hz"
# What counts on from the start of the machine is never set.
TIME_OF_DAY = ("env", "FAKETIME_DONT_FAKE_MONOTONIC=1", "DONT_FAKE_MONOTONIC=1")
# As the file `clock` of the run says.
FOLLOWS_A_CLOCK = (*TIME_OF_DAY, "FAKETIME_TIMESTAMP_FILE=OUT/clock", "FAKETIME_NO_CACHE=1",
                   "LD_PRELOAD=" + ":".join(glob.glob("/usr/lib/*/faketime/libfaketimeMT.so.1")))


def udp_ports(process):
    """That are open in the network namespace of a process."""
    lines = pathlib.Path(f"/proc/{process}/net/udp").read_text(encoding="ascii").splitlines()[1:]
    return {int(line.split()[1].split(":")[1], 16) for line in lines}


def read_sequence(file):
    """Rate and agents of a sequence."""
    sequence = yaml.safe_load(pathlib.Path(file).read_text(encoding="utf-8"))
    return sequence["rate_hz"], sequence["agents"]


class Run:
    """One run of all programs; faults act on it."""

    def __init__(self, hosts, arguments, out, sets=()):
        self.hosts, self.arguments, self.out, self.sets = hosts, arguments, pathlib.Path(out), list(sets)
        self.rate, self.agents = read_sequence(arguments.sequence)
        self.folder = pathlib.Path(arguments.sequence).resolve().parent
        self.out.mkdir(parents=True, exist_ok=True)
        self.result, self.map_file = self.out / "result", self.out / "kept.map"
        self.cpu_s, self.clients, self.attacker = {}, [], None
        self.keeps_map, self.disk_mib, self.pace, self.thinned = False, 0, 1.0, {}
        self.clock_rate = {}
        self.make_key()

    def program(self, name):
        return str(pathlib.Path(self.arguments.bin).resolve() / name)

    def log(self, name):
        return open(self.out / (name + ".log"), "a", encoding="utf-8")

    def settings(self, prefix):
        words = []
        for s in self.sets:
            if s.startswith((prefix, "wire.")):
                words += ["--set", s.replace("KEY", str(self.out / "fleet.key"))]
        return words

    def make_key(self):
        key = self.out / "fleet.key"
        key.write_bytes(os.urandom(32))
        key.chmod(0o600)

    def attack(self):
        """100,000 datagrams on every port that the programs have open, made of what they sent so far."""
        (self.out / "recorded").write_bytes(pickle.dumps(self.hosts.recorded()))
        targets = [f"10.77.0.{host + 1}:{port}" for host, p in enumerate([self.server, *self.clients])
                   for port in sorted(udp_ports(p.pid))]
        self.attacker = self.hosts.start(
            len(self.agents) + 1, ["python3", str(pathlib.Path(__file__).parent / "attack.py"), "--targets", ",".join(targets),
                          "--recorded", str(self.out / "recorded"), "--sent", str(self.out / "sent"),
                          "--rate", "2000", "--count", "100000"])

    def attack_in_words(self):
        """How many datagrams were sent, in which time; empty without an attack."""
        if self.attacker is None:
            return ""
        sent, seconds = (self.out / "sent").read_text(encoding="ascii").split()
        return f" ({int(sent):,} sent in {seconds} s)"

    def mount_disk(self):
        """A disk of its own for the result and the map, so small that it can be filled."""
        disk = self.out / "disk"
        disk.mkdir(exist_ok=True)
        subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={self.disk_mib}m", "tmpfs", disk], check=True)
        self.result, self.map_file = disk / "result", disk / "kept.map"

    def fill_disk(self):
        filled = os.open(self.out / "disk" / "filled", os.O_WRONLY | os.O_CREAT)
        try:
            while True:
                os.write(filled, bytes(4096))
        except OSError:
            os.close(filled)  # full

    def empty_disk(self):
        (self.out / "disk" / "filled").unlink()

    def unmount_disk(self):
        """What was on it stays with the run."""
        disk = self.out / "disk"
        if os.path.ismount(disk):
            shutil.copytree(disk, self.out / "of_disk", dirs_exist_ok=True, symlinks=True)
            subprocess.run(["umount", disk], check=False)
            self.result = self.out / "of_disk" / "result"

    def sample_cpu(self):
        for p in [self.server, *self.clients]:
            try:
                fields = pathlib.Path(f"/proc/{p.pid}/stat").read_text(encoding="ascii").rsplit(")", 1)[1].split()
                self.cpu_s[p.pid] = (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")
            except OSError:
                pass

    def start_server(self):
        names = ",".join(a["name"] for a in self.agents)
        command = [self.program("coslam-server"), "--domain", "3", "--out", str(self.result),
                   "--report-progress", "--set", "agents=" + names]
        if self.keeps_map:
            command += ["--map", str(self.map_file)]
        command += self.settings("server.")
        return self.hosts.start(0, command, stdout=self.log("server"), stderr=subprocess.STDOUT)

    def thin(self, every, sequence=None, fast=0.0):
        """Only each so manieth image of these agents, at its own time; of this sequence or as rendered in another.
        fast: so much more than one second passes on their clocks in a second."""
        file = sequence or self.arguments.sequence
        rate, agents = read_sequence(file)
        folder = pathlib.Path(file).resolve().parent
        for i, step in every.items():
            a = agents[i]
            images = sorted((folder / a["source"]).iterdir())[::step]
            listed = self.out / (a["name"] + ".csv")
            listed.write_text("".join(f"{n * step / rate * (1 + fast):.9f},{image}\n" for n, image in enumerate(images)),
                              encoding="utf-8")
            self.thinned[i] = (listed, rate / step)
            self.clock_rate[i] = 1 + fast

    def set_clock(self, offset):
        """Of the agents that follow it, from now on."""
        (self.out / "clock").write_text(offset, encoding="ascii")

    def start_agent(self, i, wrap=()):
        a = self.agents[i]
        source, rate = self.thinned.get(i, (self.folder / a["source"], self.rate))
        wrap = [word.replace("OUT", str(self.out.resolve())) for word in wrap]
        command = [*wrap, self.program("coslam-agent"), "--domain", "3", "--id", a["name"],
                   "--source", str(source), "--calibration", str(self.folder / a["calibration"]),
                   "--rate", str(self.pace * self.clock_rate.get(i, 1)), "--fps", str(rate), "--set", "wire.peers=10.77.0.1"]
        if "start_s" in a:
            command += ["--start", str(a["start_s"])]
        if "duration_s" in a:
            command += ["--duration", str(a["duration_s"])]
        command += self.settings("agent.")
        return self.hosts.start(i + 1, command, stdout=self.log(a["name"]), stderr=subprocess.STDOUT)

    def said(self, name, text):
        return text in (self.out / (name + ".log")).read_text(encoding="utf-8")

    def wait_for(self, name, text, seconds):
        end = time.monotonic() + seconds
        while not self.said(name, text):
            if time.monotonic() > end:
                raise RuntimeError(f"{name} did not say '{text}' within {seconds} s: see {self.out}")
            time.sleep(0.02)

    def link(self, agent, link):
        self.hosts.set_link(agent + 1, link)

    def play(self, at_start, timeline, wraps):
        """at_start(run) before agents start; timeline: (seconds after the start, action(run)) in order."""
        if self.disk_mib:
            self.mount_disk()
        self.server = self.start_server()
        self.wait_for("server", "ready", 20)
        at_start(self)
        self.clients = [self.start_agent(i, wraps.get(i, ())) for i in range(len(self.agents))]
        self.wait_for("server", "started", 30)
        begin = time.monotonic()
        for at_s, action in timeline:
            time.sleep(max(0.0, begin + at_s - time.monotonic()))
            if all(c.poll() is not None for c in self.clients):
                break  # a short scene
            action(self)
        end = begin + 300
        while any(c.poll() is None for c in self.clients):
            self.sample_cpu()
            self.check_crashes()
            if time.monotonic() > end:
                raise RuntimeError("the agents did not end within 300 s")
            time.sleep(0.1)
        self.check_crashes()
        self.server.wait(300)

    def check_crashes(self):
        crashes = (-signal.SIGABRT, -signal.SIGSEGV, -signal.SIGBUS)
        names = ["the server", *("agent " + a["name"] for a in self.agents)]
        crashed = [name for name, p in zip(names, [self.server, *self.clients]) if p.poll() in crashes]
        if crashed:
            raise RuntimeError(", ".join(crashed) + " crashed")

    def stop(self):
        if self.attacker is not None and self.attacker.poll() is None:
            self.attacker.terminate()
            self.attacker.wait()
        for p in [self.server, *self.clients]:
            if p.poll() is None:
                os.killpg(p.pid, signal.SIGKILL)
                p.wait()
        self.unmount_disk()

    def measure(self):
        """Joint ATE in metres, None without truth, and the report."""
        report = json.loads((self.result / "latest" / "report.json").read_text(encoding="utf-8"))
        done = subprocess.run([self.program("coslam"), "eval", str(self.result), self.arguments.sequence, "--json"],
                              capture_output=True, text=True, check=False)
        return (json.loads(done.stdout).get("ate_m") if done.returncode == 0 else None), report


def nothing(_):
    pass


def slower(run):
    run.pace = 0.33


def all_links(link):
    return lambda run: [run.link(i, link) for i in range(len(run.agents))]


def send(agent, number):
    return lambda run: run.clients[agent].send_signal(number)


def restart(agent):
    def action(run):
        run.clients[agent].send_signal(signal.SIGKILL)
        run.clients[agent].wait()
        run.clients[agent] = run.start_agent(agent)
    return action


def restart_server(run):
    """As its service would, half a second after it was killed."""
    run.server.send_signal(signal.SIGKILL)
    run.server.wait()
    time.sleep(0.5)
    run.server = run.start_server()


def slowed(which, share, from_s, to_s, period_s=0.04):
    """That share of a core for the server (-1) or an agent, by stopping it for the rest of each period."""
    def signalled(number):
        return lambda run: (run.server if which < 0 else run.clients[which]).send_signal(number)
    timeline = []
    for i in range(int((to_s - from_s) / period_s)):
        begin = from_s + i * period_s
        timeline += [(begin, signalled(signal.SIGCONT)), (begin + share * period_s, signalled(signal.SIGSTOP))]
    return [*timeline, (to_s, signalled(signal.SIGCONT))]


def stop_for(which, seconds):
    """SIGSTOP and SIGCONT of the server (-1) or an agent, as a pair for a timeline."""
    process = lambda run: run.server if which < 0 else run.clients[which]
    return (lambda run: process(run).send_signal(signal.SIGSTOP)), (lambda run: process(run).send_signal(signal.SIGCONT)), seconds


def timeline_of_stop(at_s, which, seconds):
    begin, end, _ = stop_for(which, seconds)
    return [(at_s, begin), (at_s + seconds, end)]


def faults():
    """name -> (links at the start, timeline, wraps of agents, settings)."""
    out = {"none": (nothing, [], {}, [])}
    for percent in (1, 5, 10, 20):
        out[f"loss {percent} %"] = (all_links(Link(loss=percent / 100)), [], {}, [])
    out["delay 50 +- 20 ms"] = (all_links(Link(delay_ms=50, jitter_ms=20)), [], {}, [])
    out["delay 200 +- 100 ms"] = (all_links(Link(delay_ms=200, jitter_ms=100)), [], {}, [])
    out["256 kbit/s"] = (all_links(Link(kbit_s=256)), [], {}, [])
    cut, whole = Link(up=False, down=False), Link()
    out["partition 30 s, at a third of the pace"] = (
        slower, [(10, lambda r: r.link(1, cut)), (40, lambda r: r.link(1, whole))], {}, [])
    out["partition"] = (nothing, [(4, lambda r: r.link(1, cut)), (9, lambda r: r.link(1, whole))], {}, [])
    out["one-way partition"] = (nothing, [(4, lambda r: r.link(1, Link(up=False))), (9, lambda r: r.link(1, whole))], {}, [])
    out["an agent's address changes"] = (nothing, [(6, lambda r: r.hosts.change_address(2))], {}, [])
    out["the server's address changes"] = (nothing, [(6, lambda r: r.hosts.change_address(0))], {}, [])
    out["agent killed 3 times"] = (nothing, [(3, restart(1)), (6, restart(1)), (9, restart(1))], {}, [])
    out["agent stopped 2 s"] = (nothing, timeline_of_stop(5, 1, 2), {}, [])
    out["server stopped 2 s"] = (nothing, timeline_of_stop(5, -1, 2), {}, [])
    out["server killed"] = (nothing, [(8, restart_server)], {}, [])
    out["server killed 3 times"] = (nothing, [(t, restart_server) for t in (6, 10, 14)], {}, [])
    out["agent at a quarter of a core"] = (nothing, slowed(1, 0.25, 2, 18), {}, [])
    out["key"] = (nothing, [], {}, ["wire.key_file=KEY"])
    out["server at a tenth of a core"] = (nothing, slowed(-1, 0.1, 1, 18, 0.1), {}, [])
    out["cameras at 30, 15 and 10 Hz"] = (lambda run: run.thin({1: 2, 2: 3}), [], {}, [])
    # At another rate they drift past each other by a whole period and more.
    out[UNTRIGGERED] = (lambda run: run.thin({1: 1, 2: 3}, run.arguments.untriggered), [], {}, [])
    out["agent killed 20 times, at a third of the pace"] = (
        slower, [(4 + 2.6 * i, restart(1)) for i in range(20)], {}, [])
    out["server killed every 6 s"] = (nothing, [(5 + 6 * i, restart_server) for i in range(10)], {}, [])
    out[DISK_FULL] = (nothing, [(6, lambda run: run.fill_disk()), (12, lambda run: run.empty_disk())], {}, [])
    out["clock set ahead by 5 s in the run"] = (
        lambda run: run.set_clock("+0"), [(8, lambda run: run.set_clock("+5s"))], {1: FOLLOWS_A_CLOCK}, [])
    # The attack takes 50 s.
    out["key, at a third of the pace"] = (slower, [], {}, ["wire.key_file=KEY"])
    out["the same, 2,000 hostile datagrams a second"] = (slower, [(2, lambda r: r.attack())], {}, ["wire.key_file=KEY"])
    out[CRASHES] = (slower, [(2, lambda r: r.attack())], {}, [])
    for off in ("+0.3s", "+5s", "-5s", "+1h"):
        out[f"clock {off}"] = (nothing, [], {1: (*TIME_OF_DAY, "faketime", "-f", off)}, [])
    out["clock 500 ppm fast"] = (lambda run: run.thin({1: 1}, fast=500e-6), [], {}, [])
    return out


def tracked_percent(result, images):
    """With a pose in the server's map, of all images, of the agent that fared worst."""
    return min(100 * sum(not line.startswith("#") for line in open(result / "trajectory" / f"{name}.tum", encoding="ascii")) / count
               for name, count in images.items())


def row(name, ate, report, base, cpu_s, tracked):
    agents = report["agents"].values()
    cells = [name, "-" if ate is None else f"{ate:.4f}", f"{ate / base:.2f}" if ate and base else "-",
             f"{tracked:.1f}", str(report["server"]["maps"]),
             f"{max(a.get('ms_per_frame', 0) for a in agents):.1f}",
             f"{max(a['kb_per_s_up'] for a in agents):.0f} / {max(a['kb_per_s_down'] for a in agents):.0f}",
             str(report["late_frames"]), str(report["frame_sets_left_out"]), f"{cpu_s:.0f}"]
    return "| " + " | ".join(cells) + " |"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", required=True, help="folder of the programs")
    parser.add_argument("--sequence", required=True, help="sequence.yaml of a rendered scene")
    parser.add_argument("--untriggered", help="sequence.yaml of the same scene at 29.3 Hz, for cameras of their own time")
    parser.add_argument("--out", default="field", help="folder for results and logs")
    parser.add_argument("--only", action="append", help="a fault of --list; may be repeated")
    parser.add_argument("--list", action="store_true", help="only print the names of the faults")
    arguments = parser.parse_args()
    known = faults()
    if arguments.list:
        print("\n".join(known))
        return 0
    chosen = ["none"] + [f for f in (arguments.only or known) if f != "none"]
    if not arguments.untriggered:
        chosen = [f for f in chosen if f != UNTRIGGERED]
    base, images, failed = None, {}, 0
    print("| fault | ATE m | ratio | tracked % | maps | agent ms | kB/s up / down | late | left out | CPU s |\n|---|---|---|---|---|---|---|---|---|---|", flush=True)
    count = len(read_sequence(arguments.sequence)[1]) + 2  # the server's, and that of an attacker
    for name in chosen:
        at_start, timeline, wraps, sets = known[name]
        out = pathlib.Path(arguments.out) / re.sub(r"[^a-z0-9+-]+", "_", name)
        try:
            with Hosts(count) as hosts:
                run = Run(hosts, arguments, out, sets)
                run.keeps_map = name.startswith("server killed") or name == DISK_FULL
                run.disk_mib = 40 if name == DISK_FULL else 0
                (out / "kept.map").unlink(missing_ok=True)
                try:
                    run.play(at_start, timeline, wraps)
                finally:
                    run.stop()
            ate, report = run.measure()
        except Unavailable as error:
            print("skipped: this machine cannot have hosts of its own: " + str(error))
            return SKIPPED
        except (RuntimeError, subprocess.TimeoutExpired, OSError, KeyError) as error:
            expected = name == CRASHES and "crashed" in str(error)
            print(f"| {name}{run.attack_in_words()} | {'as it must be' if expected else 'failed'}: {error} |", flush=True)
            failed |= not expected
            continue
        if name == "none":
            base, images = ate, {agent: a["frames"] for agent, a in report["agents"].items()}
        tracked = tracked_percent(run.result / "latest", images)
        name += run.attack_in_words()
        if run.attacker is not None:
            name += " refused: " + ", ".join(f"{n:,} {reason}" for reason, n in report["rejected"].items())
        print(row(name, ate, report, base, sum(run.cpu_s.values()), tracked), flush=True)
    return int(failed)


if __name__ == "__main__":
    os.environ.setdefault("LC_ALL", "C")
    sys.exit(main())
