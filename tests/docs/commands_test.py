# SPDX-FileCopyrightText: 2026 The CoSLAM authors
# SPDX-License-Identifier: Apache-2.0
"""Runs the commands of documents as they stand there, and compares in kind what they print and write.

    commands_test.py --bin DIR --inputs DIR --prepare DOCS_INPUTS    makes what the commands read, by that program
    commands_test.py --bin DIR --inputs DIR DOCUMENT...              runs the commands of these documents
    ... --examples DIR                                               where the programs of docs/examples lie

A document has a work folder with these files, in which its commands run in their order. Servers, agents and bridges
stay until another one takes their place, a command reads the result, or the section of the second level ends. Every
line of a block without a language is a command, unless exceptions.py says what the block is: one without a rule fails.
What cannot be run stands there too, with its reason; what a line runs with in place of its own words is in
Section.adapted(). YAML blocks are loaded by the program that they are for. Commands within the text are looked up in
the programs' --help.
"""

import argparse
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable

import documents
from documents import SOURCE, Block
from exceptions import CALIBRATION, FILM, NOT_COMMANDS, NOT_RUN, SHOWN
from product import Failure, Product, expect
from programs import Domain
from section import Section


Note = Callable[[str, str, str], None]  # hears of place, line and what was done


def what_it_is(block: Block) -> str:
    """When it holds no commands."""
    for (document, begin), what in NOT_COMMANDS.items():
        if document == block.document and block.lines[0].strip().startswith(begin):
            return what
    return ""


def do_block(section: Section, block: Block, note: Note) -> None:
    """Each of its lines."""
    place, first = f"{block.document}:{block.line}", block.lines[0].strip()
    if block.language == "yaml":
        attempt(note, place, "YAML", lambda: section.load_yaml(block))
    elif block.language == "python":
        attempt(note, place, "Python", lambda: "compiled" if compile(block.text, place, "exec") else "")
    elif block.language:
        what = NOT_RUN.get(block.language, "")
        note(place, block.language, f"not run: {what}" if what else "FAIL: no rule of tests/docs knows this language")
    elif what := what_it_is(block):
        note(place, first[:40], f"no command: {what}")
    elif any(block.lines[0].startswith(begin) for begin in SHOWN):
        attempt(note, place, first[:40], lambda: section.shown(block) or "shown, compared")
    else:
        for place, line in block.places():
            attempt(note, place, documents.without_comment(line)[0], lambda line=line: section.line(line))


def attempt(note: Note, place: str, line: str, action: Callable[[], str]) -> None:
    try:
        note(place, line, action())
    except Failure as failure:
        note(place, line, f"FAIL: {failure}")
    except Exception as error:  # pylint: disable=broad-except
        note(place, line, f"FAIL: {type(error).__name__}: {error}")


def check_text(product: Product, document: str, note: Note) -> None:
    """Commands within the text, with their placeholders: subcommands and options exist."""
    for number, code in documents.commands_in_text(document):
        def check(code: str = code) -> str:
            program, *words = re.sub(r"[\[\]]", " ", code.removeprefix("build/bin/")).split()
            if "/" in program:
                expect((SOURCE / program).exists(), f"there is no {program}")
            if any(word.startswith("-") for word in words) or program == "coslam":
                alternatives = words[1].split("|") if words[0] == "map" else [""]
                for alternative in alternatives:
                    some = [words[0], alternative, *words[2:]] if alternative else words
                    product.check_words(program, [word for word in some if not word.startswith("|")])
            return "in text: checked"

        attempt(note, f"{document}:{number}", code, check)


def check_tables(work: pathlib.Path, document: str, note: Note) -> None:
    """A table with the head "file in `FOLDER`" names files that a command of the document has made."""
    folder = ""
    for number, line in documents.text_lines(document):
        if head := re.match(r"\| file in `(\w+)`", line):
            folder = head[1]
        elif folder and (name := re.match(r"\| `([\w./]+)` \|", line)):
            file = f"{folder}/{name[1]}"
            what = "in a table: exists" if (work / file).exists() else "FAIL: it was not made"
            note(f"{document}:{number}", file, what)
        elif not line.startswith("|"):
            folder = ""


def do_document(product: Product, inputs: pathlib.Path, work: pathlib.Path, document: str, note: Note) -> None:
    all_blocks = documents.blocks(document)
    check_text(product, document, note)
    folder, beforehand = work / document.replace("/", "-"), {"result", "courtyard.rec"}
    shutil.copytree(inputs, folder)
    for name in dict.fromkeys(block.section for block in all_blocks):
        section = Section(product, folder, beforehand)
        try:
            for block in all_blocks:
                if block.section == name:
                    do_block(section, block, note)
            try:
                section.end_run()
            except Failure as failure:
                note(document, f"the end of '{name}'", f"FAIL: {failure}")
        finally:
            section.close()
    check_tables(folder, document, note)


def prepare(product: Product, inputs: pathlib.Path, program: pathlib.Path) -> None:
    """The inputs that the documents name: README.md's sequence of a small scene, with truth and metres; a run and a
    recording of it; the examples of configurations."""
    shutil.rmtree(inputs, ignore_errors=True)
    inputs.mkdir(parents=True)
    subprocess.run([program.resolve(), inputs], check=True)
    sequence = next(b for b in documents.blocks("README.md") if b.language == "yaml").text
    for name in ["left", "right"]:
        sequence = sequence.replace(f"{name}.yaml}}", f"{name}.yaml, truth: {name}.tum}}")
    (inputs / "courtyard.yaml").write_text(sequence + "scale: {baseline_m: 0.4}\n", encoding="utf-8")
    shutil.copy(inputs / "left.yaml", inputs / "anna.yaml")
    shutil.copy(SOURCE / "deploy/config/server.yaml", inputs)
    agent = (SOURCE / "deploy/config/agent.yaml").read_text(encoding="utf-8")
    for key, value in {"source": FILM, "calibration": CALIBRATION}.items():
        agent = re.sub(rf"^{key}: .*", f"{key}: {value}", agent, flags=re.MULTILINE)
    (inputs / "agent.yaml").write_text(agent, encoding="utf-8")
    domain = Domain()
    run = f"coslam run courtyard.yaml --out result --record courtyard.rec --domain {domain}".split()
    subprocess.run([product.path(run[0]), *run[1:]], cwd=inputs, check=True)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", type=pathlib.Path, required=True)
    parser.add_argument("--inputs", type=pathlib.Path, required=True)
    parser.add_argument("--prepare", type=pathlib.Path)
    parser.add_argument("--examples", type=pathlib.Path)
    parser.add_argument("documents", nargs="*")
    arguments = parser.parse_args()
    product = Product(arguments.bin.resolve(), arguments.examples and arguments.examples.resolve())
    if arguments.prepare:
        prepare(product, arguments.inputs, arguments.prepare)
        return 0
    outcomes: list[str] = []

    def note(place: str, line: str, what: str) -> None:
        outcomes.append(what)
        print(f"{place}: {line}: {what}", flush=True)

    with tempfile.TemporaryDirectory(prefix="coslam-docs-", dir=arguments.inputs.parent) as work:
        for document in arguments.documents:
            start = time.monotonic()
            do_document(product, arguments.inputs, pathlib.Path(work), document, note)
            print(f"{document} took {time.monotonic() - start:.0f} s")
    kinds = [outcome.split(":")[0] for outcome in outcomes]
    print(", ".join(f"{kinds.count(kind)} {kind}" for kind in sorted(set(kinds))))
    return 1 if "FAIL" in kinds else 0


if __name__ == "__main__":
    sys.exit(main())
