# SPDX-FileCopyrightText: 2026 The CoSLAM authors
# SPDX-License-Identifier: Apache-2.0
"""The programs as they describe themselves, and what a failure is."""

import pathlib
import re
import subprocess

import yaml

from documents import SOURCE
from exceptions import EXAMPLES, PROGRAMS, STAYING


class Failure(Exception):
    """What is wrong with a line, with what was printed."""

    def __init__(self, what: str, printed: str = "") -> None:
        super().__init__(what + "".join("\n    | " + line for line in printed.splitlines()[-40:]))


def expect(condition: object, what: str, printed: str = "") -> None:
    if not condition:
        raise Failure(what, printed)


def value_of(words: list[str], option: str, otherwise: str = "") -> str:
    """The word after an option."""
    for word, after in zip(words, [*words[1:], ""]):
        if word == option:
            return after
        if word.startswith(option + "="):
            return word.partition("=")[2]
    return otherwise


def positional(words: list[str], flags: list[str]) -> list[str]:
    """The words that are no options, nor belong to one; `flags` are options without a value."""
    options = [word for word in words if word.startswith("-") and word not in flags]
    return [w for w, before in zip(words, ["", *words]) if not w.startswith("-") and before not in options]


class Product:
    """The programs and what they say of themselves."""

    def __init__(self, binaries: pathlib.Path, examples: pathlib.Path | None = None) -> None:
        self.bin = binaries
        self.examples = examples
        self.helps: dict[tuple[str, ...], str] = {}

    def path(self, name: str) -> str:
        if name.startswith(EXAMPLES):
            expect(self.examples, f"without --examples there is no {name}")
            return f"{self.examples}/{name.removeprefix(EXAMPLES)}"
        return str(SOURCE / name if "/" in name else self.bin / name)

    def run(self, words: list[str], folder: pathlib.Path) -> subprocess.CompletedProcess[str]:
        words = [self.path(words[0]), *words[1:]]
        return subprocess.run(words, cwd=folder, capture_output=True, text=True, check=False)

    def subcommands(self, *words: str) -> set[str]:
        """Those that --help lists."""
        return set(re.findall(r"^  ([a-z]\S*) ", self.help(*words).partition("Subcommands:")[2], re.MULTILINE))

    def help(self, *words: str) -> str:
        """What --help prints; the words of a program and its subcommands."""
        if words not in self.helps:
            run = self.run([*words, "--help"], SOURCE)
            expect(run.returncode == 0, f"{' '.join(words)} --help fails", run.stderr)
            self.helps[words] = run.stdout
        return self.helps[words]

    def printed_config(self, program: str, words: list[str], folder: pathlib.Path) -> str:
        run = self.run([program, *words, "--print-config"], folder)
        expect(run.returncode == 0 and not run.stderr, f"{program} {' '.join(words)} --print-config fails", run.stderr)
        return run.stdout

    def check_words(self, program: str, words: list[str]) -> None:
        """Its subcommand exists, each option stands in --help, each key of --set in --print-config."""
        of = [program]
        if program == "coslam":
            while subcommands := self.subcommands(*of):
                if words[0].startswith("-"):
                    break
                expect(words[0] in subcommands, f"{' '.join(of)} has no subcommand {words[0]}")
                of.append(words[0])
                words = words[1:]
        elif not (SOURCE / program).exists() and program not in PROGRAMS:
            raise Failure(f"there is no {program}")
        for word in words:
            if option := re.match(r"-[\w-]+", word):
                known = re.search(rf"(?<![\w-]){re.escape(option[0])}(?![\w-])", self.help(*of))
                expect(known, f"{' '.join(of)} --help does not tell the option {option[0]}")
        for word, after in zip(words, words[1:]):
            if word == "--set" and re.fullmatch(r"[\w.]+=\S+", after) and after != "key=value":
                self.check_key(program, after)

    def check_key(self, program: str, setting: str) -> None:
        owner = program
        if program not in STAYING:
            owner = {"server": "coslam-server", "agent": "coslam-agent"}[setting.partition(".")[0]]
        value = yaml.safe_load(self.printed_config(owner, ["--set", setting], SOURCE))
        for part in setting.partition("=")[0].split("."):
            expect(isinstance(value, dict) and part in value, f"{owner} --print-config has no key {setting}")
            value = value[part]
