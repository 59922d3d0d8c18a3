# SPDX-FileCopyrightText: 2026 The CoSLAM authors
# SPDX-License-Identifier: Apache-2.0
"""Runs the commands of a section, with a rule for each kind of command."""

import csv
import json
import os
import pathlib
import re
import shlex
import shutil
import subprocess
import urllib.request
from collections.abc import Callable

import yaml

import documents
from documents import SOURCE, Block
from exceptions import BOARDS, CALIBRATION, CHECKED, EXAMPLES, FILM, OF_OTHERS, PROGRAMS, STAYING
from product import Failure, Product, expect, positional, value_of
from programs import Domain, Program

SUMMARY = r"^agent +images +tracked +ms/frame +kB/s up +kB/s down +path$"
STATUS = r"^agent +state +pose +group +images +tracked "
VIEW = r"view: (http://127\.0\.0\.1:\d+/)(\S*)"


def comparable(line: str) -> list[str]:
    """The first words of a line, without what differs from run to run: numbers, names, judgements, the time of day."""
    line = re.sub(r"^\d\d:\d\d:\d\d\.\d+ ", "", line.strip())
    line = re.sub(r"\b[0-9a-f]{16}\b|\b\d[\d.:]*(?<!:)", "#", line)
    line = re.sub(r"\b(left|right|anna|ben|carl)\b", "NAME", line)
    return line.split()[:4]


def remove(path: pathlib.Path) -> None:
    if path.is_dir():
        shutil.rmtree(path)
    else:
        path.unlink(missing_ok=True)


class Section:
    """A section's commands and the folder in which they run. What is in `beforehand` was not made by the document."""

    def __init__(self, product: Product, folder: pathlib.Path, beforehand: set[str]) -> None:
        self.product = product
        self.folder = folder
        self.fleet, self.nodes, self.here = self.domains = Domain(), Domain(), Domain()
        self.environment = {**os.environ, "PATH": f"{product.bin}:{os.environ['PATH']}"}
        self.live: dict[str, Program] = {}
        self.key = ""  # that of the server at work
        self.printed = ""  # by all commands up to now
        self.beforehand = beforehand

    # What a line runs with.

    def adapted(self, words: list[str]) -> list[str]:
        """All that the test changes of a line: where a camera, another host or a free port would be needed, domains
        that other tests may use, what would take long, numbers that depend on what was seen."""
        program, command = words[0], words[1] if words[0] == "coslam" else ""
        words = list(words)
        prints_config = "--print-config" in words
        for i, word in enumerate(words):
            before = words[i - 1] if i else ""
            if before == "--domain":
                words[i] = str(self.nodes if program == "coslam-bridge" else self.fleet)
            elif before == "--from":
                words[i] = str(self.fleet)
            elif before == "--peer":
                words[i] = "127.0.0.1"
            elif before == "--source" and re.match(r"v4l2:|ros2:", word):
                words[i] = BOARDS if command == "calibrate" else FILM
            elif before == "--calibration" and word.startswith("ros2:"):
                words[i] = CALIBRATION
            elif before == "--times":
                words[i] = "2"
            elif before == "--view":
                words[i] = "0"
            elif word == "--view" and program == "coslam":
                words[i] = "--view=0"
            elif word.startswith("/etc/coslam/"):
                words[i] = word.removeprefix("/etc/coslam/")
            elif word.startswith("sim:"):
                known = re.search(rf"\b{word[4:]}\b", self.product.help("coslam", "render"))
                expect(known, f"there is no scene {word}")
                words[i] = "courtyard.yaml"
            elif before == "point":
                words[i] = self.some_point(words[i - 2])
            elif before == "track":
                words[i] = self.some_track(words[i - 2], word)
        if program == "coslam-agent" and "--config" in words and not prints_config and "--source" not in words:
            words += ["--id", "ben", "--source", FILM, "--calibration", CALIBRATION]
            words += ["--set", "wire.interfaces=127.0.0.1", "--set", "wire.peers=127.0.0.1"]
        if command == "view":
            words += ["--port", "0"]
        if command == "run":
            words += ["--domain", str(self.here)]
        listens = command in ("status", "doctor") or program == f"{EXAMPLES}listen"
        if (program in STAYING and not prints_config) or listens:
            words += [] if "--loopback" in words else ["--loopback"]
            has_domain = "--domain" in words
            words += [] if has_domain else ["--domain", str(self.fleet)]
        if program == "coslam-agent" and self.key and not prints_config:
            words += ["--set", f"wire.key_file={self.key}"]
        return words

    def some_point(self, result: str) -> str:
        with (self.folder / result / "points.csv").open(encoding="utf-8") as file:
            return next(csv.DictReader(file))["id"]

    def some_track(self, result: str, named: str) -> str:
        camera = named.partition("/")[0]
        with (self.folder / result / "events.csv").open(encoding="utf-8") as file:
            rows = csv.DictReader(file)
            return next(f"{camera}/{row['track']}" for row in rows if row["camera"] == camera and row["track"])

    # Running.

    def start(self, words: list[str]) -> Program:
        return Program([self.product.path(words[0]), *words[1:]], self.folder, self.environment)

    def finished(self, program: Program, code: int | None = 0) -> str:
        """What it printed when it has ended with this exit code; None: any."""
        ended = program.exit_code()
        self.printed += program.text
        expect(code is None or ended == code, f"{program.name}: its exit code is {ended}, not {code}", program.text)
        return program.text

    def ran(self, words: list[str], code: int | None = 0) -> str:
        return self.finished(self.start(words), code)

    def said(self, program: Program, pattern: str, times: int = 1) -> re.Match[str]:
        found = program.says(pattern, times)
        expect(found, f"{program.name}: does not say {pattern}", program.text)
        assert found
        return found

    def interrupted(self, program: Program) -> str:
        ended = program.interrupt()
        self.printed += program.text
        expect(ended == 0, f"{program.name}: its exit code after Ctrl-C is {ended}", program.text)
        return program.text

    def end_run(self) -> None:
        """Ends what is live, with a result where there is a server: without an agent there is none."""
        if "coslam-server" in self.live and not any(name.startswith("coslam-agent") for name in self.live):
            self.supposed("coslam-agent")
        self.end_live()

    def end_live(self) -> None:
        """Ctrl-C for all that stays, the agents first, as they see their server go otherwise."""
        wrong = []
        for name in sorted(self.live):  # coslam-agent, -bridge, -server
            try:
                self.interrupted(self.live[name])
            except Failure as failure:
                wrong.append(str(failure))
        self.live.clear()
        self.key = ""
        expect(not wrong, "\n".join(wrong))

    def close(self) -> None:
        """Leaves nothing running, whatever went wrong."""
        for program in self.live.values():
            program.process.kill()
            program.exit_code()
        for domain in self.domains:
            domain.close()

    def exist(self, *names: str) -> None:
        for name in names:
            expect((self.folder / name).exists(), f"there is no {name} afterwards")

    def page_answers(self, address: str) -> None:
        with urllib.request.urlopen(address + "healthz", timeout=20) as answer:
            expect(answer.status == 200, f"{address} does not answer")

    # A rule for each kind of command.

    def run_or_replay(self, words: list[str]) -> None:
        program = self.start(words)
        if any(word.startswith("--view") for word in words):
            self.page_answers(self.said(program, VIEW)[1])
        text = self.finished(program)
        out = value_of(words, "--out", "result")
        expect(re.search(SUMMARY, text, re.MULTILINE), "the table of the summary is missing", text)
        for agent in ["left", "right"]:
            line = rf"^{agent} +\d+ +\d+\.\d% .* (good|fair|poor)$"
            expect(re.search(line, text, re.MULTILINE), f"no line for {agent}", text)
            self.exist(f"{out}/trajectory/{agent}.tum", f"{out}/live/{agent}.tum")
        expect(f"\nresult: {out}\n" in text, "it does not say where the result is", text)
        self.exist(f"{out}/map.ply", f"{out}/dynamic.csv", f"{out}/report.json", f"{out}/events.csv")
        if record := value_of(words, "--record"):
            self.exist(record)
        if count := value_of(words, "--fleets"):
            expect(re.search(rf"^left-{count} ", text, re.MULTILINE), f"no fleet {count}", text)

    def eval(self, words: list[str]) -> None:
        text = self.ran(words)
        truth = "truth:" in (self.folder / words[3]).read_text(encoding="utf-8")
        table = r"^ +agent +tracked % +ATE m " if truth else r"^ +left +[0-9.]+ % of its images tracked$"
        expect(re.search(table, text, re.MULTILINE), "the table is missing", text)
        expect(("joint ATE" if truth else "no absolute error") in text, "it tells no error, or one without truth", text)
        self.exist(f"{words[2]}/eval.json", f"{words[2]}/top_view.png")

    def export(self, words: list[str]) -> None:
        text = self.ran(words)
        written = [line for line in text.splitlines() if re.fullmatch(r"[\w./-]+", line)]
        expect(written, "it does not name what it wrote", text)
        self.exist(*written)
        to = positional(words[3:], ["--undistort"])[0]
        expected = {"ply": ["map.ply"], "mcap": ["run.mcap"], "colmap": ["cameras.txt", "images.txt", "points3D.txt"]}
        inside = "sparse/" if "--undistort" in words else ""
        self.exist(*(f"{to}/{inside}{name}" for name in expected[value_of(words, "--format")]))

    def explain(self, words: list[str]) -> None:
        text = self.ran(words)
        expect(re.search(r"^ +\d+\.\d+ s  [A-Z].*\.$", text, re.MULTILINE), "no sentence with its time", text)
        if at := value_of(words, "--at"):
            told = (f"At {float(at):.3f} s ", "The run ended at ")  # the recording of the tests is short
            expect(text.startswith(told), "it does not tell what was at that time", text)

    def view(self, words: list[str]) -> None:
        program = self.start(words)
        self.page_answers(self.said(program, VIEW)[1])
        self.interrupted(program)

    def calibrate(self, words: list[str]) -> None:
        text = self.ran(words)
        expect("RMS reprojection error" in text, "it does not say how exact it is", text)
        self.calibration(["coslam", "calibration", value_of(words, "--out")])

    def calibration(self, words: list[str]) -> None:
        text = self.ran(words)
        for what in ["pixels", "focal lengths", "lens", "field of view", "distortion"]:
            expect(what in text, f"it does not tell the {what}", text)

    def doctor(self, words: list[str]) -> None:
        text = self.ran(words, None)
        verdict = re.fullmatch(r"(\d+) faults?, (\d+) warnings?\b.*", text.splitlines()[-1]) if text else None
        expect(verdict or text.endswith("All is fine.\n"), "it does not end with its verdict", text)
        marks = re.findall(r"^(ok|warn|FAIL) ", text, re.MULTILINE)
        expect(len(marks) == len(text.splitlines()) - 1, "a line has no mark", text)
        if verdict:
            counted = marks.count("FAIL") == int(verdict[1]) and marks.count("warn") == int(verdict[2])
            expect(counted, "the verdict counts others", text)
        subjects = []
        if "--source" in words or "--config" in words:
            subjects += ["source", "images", "picture", "tracking"]
        if "--calibration" in words:
            subjects += ["calibration"]
        if "--out" in words:
            subjects += ["disk"]
        if "coslam-server" in self.live:
            subjects += ["map server"]
        for subject in subjects:
            expect(re.search(rf"^\w+ +{subject} ", text, re.MULTILINE), f"it says nothing of the {subject}", text)
        # There may be no server, and a machine under load may be too slow.
        expected = ("tracking ",) if self.live else ("tracking ", "peer ")
        for fault in re.findall(r"^FAIL +(.*)", text, re.MULTILINE):
            expect(fault.startswith(expected), f"it finds {fault}", text)

    def status(self, words: list[str]) -> None:
        if "coslam-server" not in self.live:
            self.supposed("coslam-server")
            self.supposed("coslam-agent")
        if "--watch" in words:
            program = self.start(words)
            self.said(program, STATUS, 2)
            program.interrupt()
            text = program.text
        else:
            text = self.ran(words)
        expect(re.search(r"^map server [0-9a-f]{16}: running, ", text, re.MULTILINE), "no map server", text)
        expect(re.search(STATUS, text, re.MULTILINE), "no table", text)
        for agent in (name.split()[1] for name in self.live if " " in name):
            expect(re.search(rf"^{agent} +[a-z]+ +[a-z]+ ", text, re.MULTILINE), f"no line for {agent}", text)

    def example(self, words: list[str]) -> None:
        """A program of docs/examples: one that reads a result, or one that listens."""
        if not words[0].endswith("/listen"):
            self.ran(words)
            return
        if "coslam-server" not in self.live:
            self.supposed("coslam-server")
            self.supposed("coslam-agent")
        program = self.start(self.adapted(words))
        self.said(program, r"^left +in map \d+ at ")
        self.interrupted(program)

    def fleet_init(self, words: list[str]) -> None:
        self.ran(words)
        folder = words[3]
        self.exist(f"{folder}/fleet.key", f"{folder}/server/server.yaml")
        self.product.printed_config("coslam-server", ["--config", f"{folder}/server/server.yaml"], self.folder)
        for agent in value_of(words, "--agents").split(","):
            file = f"{folder}/agents/{agent}/agent.yaml"
            self.product.printed_config("coslam-agent", ["--config", file], self.folder)

    def print_config(self, words: list[str]) -> str:
        text = self.ran(words)
        expect(isinstance(yaml.safe_load(text), dict), "it prints no configuration", text)
        (self.folder / "printed.yaml").write_text(text, encoding="utf-8")
        again = self.product.printed_config(words[0], ["--config", "printed.yaml"], self.folder)
        expect(again == text, "what it prints says something else when it is loaded", again)
        return text

    def supposed(self, program: str) -> None:
        """What a document supposes to be at work already."""
        server, agent = "--out fleet", f"--id left --source {FILM} --calibration {CALIBRATION}"
        self.stay(self.adapted([program, *(agent if program == "coslam-agent" else server).split()]))

    def stay(self, words: list[str]) -> None:
        """A server, agent or bridge: until it says that it is at work."""
        name = words[0] if words[0] != "coslam-agent" else f"{words[0]} {value_of(words, '--id')}"
        if name == "coslam-server":
            self.end_live()
        elif name in self.live:
            self.interrupted(self.live.pop(name))
        if words[0] == "coslam-agent" and "coslam-server" not in self.live:
            self.supposed("coslam-server")
        program = self.live[name] = self.start(words)
        if name == "coslam-server":
            if "--view" in words:
                self.page_answers(self.said(program, VIEW)[1])
            self.said(program, r"map server in DDS domain \d+ at ")
            self.said(program, r"an agent joins with: coslam-agent ")
            self.key = next((word.partition("=")[2] for word in words if word.startswith("wire.key_file=")), "")
            key = "with the fleet's key" if self.key else "without a key"
            expect(key in program.text, f"the server does not say that it runs {key}", program.text)
        elif name == "coslam-bridge":
            self.said(program, r"from DDS domain \d+ to ROS 2 in domain \d+")
        else:
            self.said(program, r"info: playing ")
            self.said(self.live["coslam-server"], rf"agent {value_of(words, '--id')} joined")
            self.said(program, r"has a pose in the map")
        self.printed += program.text

    # A line.

    def command(self, words: list[str]) -> str:
        """Runs it, or checks what can be checked. What was done."""
        into = ""
        if ">" in words:
            words, into = words[: words.index(">")], words[words.index(">") + 1]
        program = words[0].removeprefix("build/bin/")
        words = [program, *words[1:]]
        if program in OF_OTHERS:
            if program == "systemctl":
                expect((SOURCE / f"deploy/systemd/{words[-1]}.service").exists(), f"there is no service {words[-1]}")
            return f"of others: {OF_OTHERS[program]}"
        if re.fullmatch(r"deploy/(check_layers|check_words|count_numbers)\.py", program) or words == ["deploy/test-field.sh", "--list"]:
            expect(self.ran(words) or program.endswith(".py"), "it prints nothing")
            return "run"
        if program in CHECKED:
            self.product.check_words(program, words[1:])
            preset = value_of(words, "--preset")
            presets = json.loads((SOURCE / "CMakePresets.json").read_text(encoding="utf-8"))["configurePresets"]
            expect(not preset or preset in (p["name"] for p in presets), f"there is no preset {preset}")
            known = self.ran([program, "--list"]) if "--only" in words else ""
            for name in value_of(words, "--only").split(","):
                expect(name in known, f"{program} --list does not name {name}", known)
            return f"checked: {CHECKED[program]}"
        if program.startswith(EXAMPLES):
            self.example(words)
            return "run"
        expect(program in PROGRAMS, f"no rule of tests/docs knows what to do with '{' '.join(words)}'")
        self.product.check_words(program, words[1:])
        for option in ["--out", "--record"]:
            made = value_of(words, option, "result" if option == "--out" and words[1] in ("run", "replay") else "")
            if made in self.beforehand and words[1] != "doctor":  # makes way for the document's own
                remove(self.folder / made)
                self.beforehand.remove(made)
        if words[1] in ("export", "view", "explain", "eval"):
            self.end_run()
        words = self.adapted(words)
        if "--print-config" in words:
            text = self.print_config(words)
            if into:
                (self.folder / into).write_text(text, encoding="utf-8")
            return "run"
        expect(not into, "no rule of tests/docs knows what comes into the file")
        if program in STAYING:
            self.stay(words)
            return "run"
        rules: dict[str, Callable[[list[str]], None]] = {
            "run": self.run_or_replay, "replay": self.run_or_replay, "eval": self.eval, "export": self.export,
            "explain": self.explain, "view": self.view, "calibrate": self.calibrate, "calibration": self.calibration,
            "doctor": self.doctor, "status": self.status, "fleet": self.fleet_init}
        expect(words[1] in rules, f"no rule of tests/docs knows coslam {words[1]}")
        rules[words[1]](words)
        return "run"

    def line(self, line: str) -> str:
        command, comment = documents.without_comment(line)
        if command.startswith("head -c 32 /dev/urandom"):  # makes a key
            subprocess.run(["bash", "-c", command], cwd=self.folder, check=True)
            file = command.split()[-1]
            text = self.ran(["coslam", "doctor", "--loopback", "--domain", str(self.fleet), "--key", file], None)
            expect(re.search(r"^ok +key file ", text, re.MULTILINE), f"{file} is not fit", text)
            return "run"
        before = len(self.printed)
        done = [self.command(shlex.split(part)) for part in command.split(" && ")]
        for quoted in re.findall(r"prints `([^`]*)`", comment):
            pattern = re.sub(r"\d+", r"\\d+", re.escape(quoted))
            expect(re.search(pattern, self.printed[before:]), f"it does not print {quoted}", self.printed[-3000:])
        if done == ["run"]:
            for name in re.findall(r"(?<![\w/.-])(\w+/[\w./]+\w)", comment):
                if name.split("/")[0] in command.split():
                    self.exist(name)
        return "; ".join(done)

    def shown(self, block: Block) -> None:
        """What a document shows was printed, in kind."""
        printed = self.printed.splitlines()
        for head in [line for line in block.lines if re.match(r"agent +(images|state) ", line)]:
            expect(head in printed, f"the table has another head than {head}", self.printed[-3000:])
        alike = [comparable(line) for line in printed]
        for line in block.lines:
            expect(comparable(line) in alike, f"nothing printed this: {line}", self.printed[-3000:])

    def load_yaml(self, block: Block) -> str:
        value = yaml.safe_load(block.text)
        file = self.folder / "block.yaml"
        file.write_text(block.text, encoding="utf-8")
        if "fx" in value:
            self.calibration(["coslam", "calibration", file.name])
            return "a calibration, loaded"
        if isinstance(value.get("agents"), list) and isinstance(value["agents"][0], dict):
            self.make_files_of(value)
            text = self.ran(["coslam", "run", file.name, "--agents", "nobody"], 2)
            said = re.fullmatch(r"coslam: the sequence \S+ has no agent 'nobody', its agents are .*\n", text)
            expect(said, "it does not load", text)
            return "a sequence, loaded"
        loaded = []
        for program in STAYING:
            if not set(value) <= set(yaml.safe_load(self.product.printed_config(program, [], self.folder))):
                continue
            said = yaml.safe_load(self.product.printed_config(program, ["--config", file.name], self.folder))
            expect(holds(said, value), f"{program} --print-config does not say the same")
            loaded.append(program)
        expect(loaded, "no program has these keys")
        return f"a configuration, loaded by {', '.join(loaded)}"

    def make_files_of(self, sequence: dict) -> None:
        """Those that a sequence names and that are not among the inputs."""
        def make(name: str, of: str) -> None:
            if name and not (self.folder / name).exists():
                (shutil.copytree if (self.folder / of).is_dir() else shutil.copy)(self.folder / of, self.folder / name)

        for agent in sequence["agents"]:
            make(agent["source"], "right" if not pathlib.Path(agent["source"]).suffix else "left.mp4")
            make(agent.get("calibration", ""), CALIBRATION)
            make(agent.get("truth", ""), "left.tum")
            make(agent.get("mask", ""), "right/1000.png")
        for key, text in {"truth_points": "t_s,id,x,y,z\n", "overlap": "t_s,agent_a,agent_b,share\n"}.items():
            if key in sequence:
                (self.folder / sequence[key]).write_text(text, encoding="utf-8")
        if "masks" in sequence:
            (self.folder / sequence["masks"]).mkdir()


def holds(said: object, value: object) -> bool:
    """Whether all of `value` is in `said`."""
    if isinstance(value, dict):
        return isinstance(said, dict) and all(key in said and holds(said[key], value[key]) for key in value)
    return said == value
