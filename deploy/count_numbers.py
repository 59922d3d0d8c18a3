#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The CoSLAM authors
# SPDX-License-Identifier: Apache-2.0
"""Counts the numbers that decide what the estimator does, so that they become fewer with time and never more unseen.

    deploy/count_numbers.py [--root DIR] [--list] [--write]

Reads server/estimator and common/geometry, where its solvers lie. A number has one of four forms:
  key        a field of a configuration that describe() gives a key to
  field      a field of a configuration without a key
  constant   a constexpr with a number of its own
  literal    a number in an expression or a default argument, but for whole numbers up to 12 and one half; what a
             key may be set to, shifts and sizes of types are left out
A constant or a field that is computed from another name is no number of its own.
docs/lab/numbers.csv has a row for each: its value, its unit, its kind, what it is and what happens without it. Kinds:
  tuned       another value would do, better or worse
  structural  the size of a type, a unit, a quantile, an epsilon, a format's limit, a bound of memory or work that
              no result comes near
  switch      on or off, or one of a few words
  given       what the user knows of the world: a baseline, the side of a tag
  derived     the default of a key that is computed from another name; so named by itself
--list prints the numbers found. --write adds rows for new numbers, with ? for what nobody said of them yet, takes out
rows of numbers that are gone, and brings values up to date.
Prints `file:line: what is wrong` for each number that has no row, or another value, and says when there are more of
them than MOST_TUNED and MOST_KEYS allow. Exit code 0: all is right; 1: it is not.
"""

import argparse
import csv
import dataclasses
import pathlib
import re
import sys

FOLDERS = ("server/estimator", "common/geometry")
TABLE = "docs/lab/numbers.csv"
COLUMNS = ("name", "file", "value", "unit", "form", "kind", "what", "without")
# The most tuned numbers and keys that are allowed: whoever brings a figure down lowers it here.
MOST_TUNED, MOST_KEYS = 273, 77
KINDS = ("tuned", "structural", "switch", "given", "derived")
LICENCE = "# SPDX-FileCopyrightText: 2026 The CoSLAM authors\n# SPDX-License-Identifier: Apache-2.0\n"
UNITS = {"px": "px", "m": "m", "rad": "rad", "deg": "deg", "s": "s", "ns": "ns", "percent": "%"}

NO_CODE = re.compile(r"""R"(\w*)\(.*?\)\1"|"(?:\\.|[^"\\\n])*"|'(?:\\.|[^'\\\n])+'|//[^\n]*|/\*.*?\*/""", re.DOTALL)
NUMBER = r"\d+(?:\.\d*)?(?:[eE][-+]?\d+)?[fFuUlLzZ]*"
LITERAL = re.compile(rf"(?<![\w.])({NUMBER})(?![\w.])")
CONSTANT = re.compile(r"(?<!if )\bconstexpr\s+((?:\w+::)*\w+)(?:<[^;=()]*>)?\s+(k[A-Z]\w*\s*(?:=|\{)[^;]*);")
STRUCT = re.compile(r"^(?:struct|class) (\w+)[^;{]*\{", re.MULTILINE)
FIELD = re.compile(r"^ {2}((?:\w+::)*\w+)(?:<[^;]*>)? (\w+)(?:\s*=\s*([^;]+?))?;", re.MULTILINE)
DESCRIBED = re.compile(r"\bfield\(\s*_+,\s*c((?:\.\w+(?:<\w+>\(\))?)+)")
HEAD = re.compile(r"^ {0,2}(?![\s}#/])(?!(?:return|if|for|while|namespace|switch|using|const auto)\b).*?([\w~]+)\(")
NO_NUMBERS = {"string_view", "char", "bool", "WhyText"}


@dataclasses.dataclass(frozen=True)
class Number:
    name: str
    file: str
    value: str
    form: str
    line: int

    @property
    def key(self) -> tuple[str, str]:
        return self.name, self.file


def code_of(text: str) -> str:
    """The text without comments, and with strings as underscores, at the same places."""
    text = re.sub(r"(?<=\d)'(?=\d)", "", text)
    return NO_CODE.sub(lambda m: re.sub(r"[^\n]", "_" if m[0][0] in "\"'R" else " ", m[0]), text)


def line_of(text: str, at: int) -> int:
    return text.count("\n", 0, at) + 1


def parts_of(values: str) -> list[str]:
    """Splits at commas that stand in no brackets."""
    parts, depth = [""], 0
    for c in values:
        depth += {"(": 1, "{": 1, "<": 0, ")": -1, "}": -1}.get(c, 0)
        if c == "," and depth == 0:
            parts.append("")
        else:
            parts[-1] += c
    return [" ".join(part.split()) for part in parts]


def value_of(part: str) -> str:
    """The value in "name = value" or "name{value}"."""
    name, equals, value = part.partition("=")
    return value.strip() if equals else part.partition("{")[2].removesuffix("}")


def has_number(value: str) -> bool:
    """Tells whether a value is a number of its own, not one that is computed from other names."""
    names = re.findall(r"(?<![\w.])[A-Za-z_]\w*", re.sub(NUMBER, "0", re.sub(r"std::(sqrt|numbers::pi)", "", value)))
    return not names and re.search(r"\d", value) is not None


def scopes_of(code: str) -> list[str]:
    """For each line the function or struct that it is in."""
    out, scope = [], "file"
    for line in code.split("\n"):
        struct, head = STRUCT.match(line), HEAD.match(line)
        if line.startswith("}"):
            out.append(scope)
            scope = "file"
            continue
        if struct:
            scope = struct[1]
        elif head and (not line.startswith("  ") or line.rstrip().endswith("{") or scope == "file"):
            scope = head[1]
        out.append(scope)
    return out


def class_at(code: str, at: int) -> str:
    """The class or struct that a place at the depth of its members is in."""
    names = [m[1] for m in STRUCT.finditer(code, 0, at)]
    return names[-1] if names else "file"


def constants_of(path: str, code: str, scopes: list[str]):
    for match in CONSTANT.finditer(code):
        if match[1].split("::")[-1] in NO_NUMBERS:
            continue
        line = line_of(code, match.start())
        before = code[: match.start()].split("\n")[-1]
        of_class = "static" in before and before.startswith("  ") and not before.startswith("   ")
        scope = (class_at(code, match.start()) if of_class else scopes[line - 1]) + "." if before.startswith(" ") else ""
        for part in parts_of(match[2]):
            if has_number(value_of(part)):
                yield Number(scope + re.split(r"[ ={]", part)[0], path, value_of(part), "constant", line)


def fields_of(code: str):
    """(struct, field, type, value, place) of each field of a configuration."""
    for struct in STRUCT.finditer(code):
        if not struct[1].endswith("Config"):
            continue
        end = code.index("\n}", struct.start()) if not code[struct.end() :].startswith("}") else struct.end()
        for field in FIELD.finditer(code, struct.end(), end):
            yield struct[1], field[2], field[1].split("::")[-1], field[3], field.start(2)


def keys_of(codes: dict[str, str], types: dict[tuple[str, str], str]) -> set[tuple[str, str]]:
    """(struct, field) of each field that has a key."""
    keys = set()
    for code in codes.values():
        for function in re.finditer(r"\bvoid describe\(V& v, (\w+)& c\) \{(.*?)\n\}", code, re.DOTALL):
            for field in DESCRIBED.finditer(function[2]):
                struct, name = function[1], ""
                for step in field[1].split(".")[1:]:
                    of = re.match(r"of<(\w+)>", step)
                    struct = of[1] if of else types.get((struct, name), struct) if name else struct
                    name = "" if of else step
                keys.add((struct, name))
    return keys


def literals_of(path: str, code: str, scopes: list[str]):
    def counted(m: re.Match) -> bool:
        return any(has_number(value_of(part)) for part in parts_of(m[2]))

    code = CONSTANT.sub(lambda m: re.sub(r"[^\n]", " ", m[0]) if counted(m) else m[0], code)
    code = re.sub(r"\bfield\((?:[^()]|\([^()]*\))*\)", lambda m: re.sub(r"[^\n]", " ", m[0]), code)
    code = re.sub(r"<<=? \d+U?|>>=? \d+U?|\w+<(?:\w|::|, |\s)*>|\w+\[\d+\]|0x[0-9A-F]+U?L*",
                  lambda m: re.sub(r"[^\n]", " ", m[0]), code)
    for _, _, _, value, place in fields_of(code):
        if value and has_number(value):
            end = code.index(";", place)
            code = code[:place] + re.sub(r"[^\n]", " ", code[place:end]) + code[end:]
    seen = set()
    for match in LITERAL.finditer(code):
        line = line_of(code, match.start())
        value = match[1].rstrip("fFuUlLzZ")
        number = float(value)
        small = number == 0.5 or (number == int(number) and number <= 12)
        if small or code.split("\n")[line - 1].startswith("#"):
            continue
        name = f"{scopes[line - 1]}: {value}"
        if name not in seen:
            seen.add(name)
            yield Number(name, path, value, "literal", line)


def numbers_of(root: pathlib.Path) -> list[Number]:
    files = sorted(p for f in FOLDERS for p in (root / f).rglob("*") if p.suffix in {".h", ".cpp"})
    codes = {str(p.relative_to(root)): code_of(p.read_text()) for p in files}
    fields = [(path, *field) for path, code in codes.items() for field in fields_of(code)]
    keys = keys_of(codes, {(struct, name): type_ for _, struct, name, type_, _, _ in fields})
    out = []
    for path, code in codes.items():
        scopes = scopes_of(code)
        for file, struct, name, type_, value, place in fields:
            has_key = (struct, name) in keys
            own = value and (has_number(value) or re.match("true|false|_", value))
            if file == path and (has_key or own):
                form = "key" if has_key else "field"
                text = "" if value is None or value.startswith("_") else value
                out.append(Number(f"{struct}.{name}", path, text, form, line_of(code, place)))
        out += constants_of(path, code, scopes)
        out += literals_of(path, code, scopes)
    names = {}
    for i, n in enumerate(out):  # two of one name in a function
        names[n.key] = names.get(n.key, 0) + 1
        if names[n.key] > 1:
            out[i] = dataclasses.replace(n, name=f"{n.name} ({names[n.key]})")
    return out


def table_of(path: pathlib.Path) -> dict[tuple[str, str], dict[str, str]]:
    if not path.is_file():
        return {}
    with path.open(newline="") as file:
        rows = csv.DictReader(line for line in file if not line.startswith("#"))
        return {(row["name"], row["file"]): row for row in rows}


def unit_of(name: str) -> str:
    last = re.sub(r"[.: (].*$", "", name.split(".")[-1]).rsplit("_", 1)
    return UNITS.get(last[-1], "") if len(last) > 1 else ""


def is_derived(value: str) -> bool:
    return bool(re.search("[A-Za-z]{2}", value)) and not re.match("true|false|1e", value)


def write(path: pathlib.Path, numbers: list[Number], table) -> None:
    with path.open("w", newline="") as file:
        file.write(LICENCE)
        rows = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        rows.writeheader()
        for n in numbers:
            new = {"unit": unit_of(n.name), "kind": "?", "what": "?", "without": ""}
            if is_derived(n.value):
                new |= {"kind": "derived"}
            rows.writerow({**new, **table.get(n.key, {}), "name": n.name, "file": n.file, "value": n.value, "form": n.form})


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--root", type=pathlib.Path, default=pathlib.Path(__file__).resolve().parent.parent)
    parser.add_argument("--list", action="store_true", help="print the numbers found")
    parser.add_argument("--write", action="store_true", help="bring the table up to date")
    options = parser.parse_args()
    numbers = numbers_of(options.root)
    if not numbers:
        print(f"count_numbers.py: no numbers under {options.root}", file=sys.stderr)
        return 1
    path = options.root / TABLE
    if options.write:
        write(path, numbers, table_of(path))
    table = table_of(path)

    found = 0
    counts: dict[tuple[str, str], int] = {}
    for n in numbers:
        row = table.get(n.key)
        kind = row["kind"] if row else "?"
        counts[n.form, kind] = counts.get((n.form, kind), 0) + 1
        if options.list:
            print(f"{n.file}:{n.line}: {n.form} {n.name} = {n.value} ({kind})")
        wrong = ("has no row" if row is None else f"is {row['value']} in its row" if row["value"] != n.value
                 else f"is of the kind {kind}" if kind not in KINDS else "")
        if wrong:
            print(f"{n.file}:{n.line}: {n.name} = {n.value} {wrong} in {TABLE}")
            found += 1
    for name, file in sorted(table.keys() - {n.key for n in numbers}):
        print(f"{file}:1: {name} of {TABLE} is not there")
        found += 1

    forms = ("key", "field", "constant", "literal")
    print("form      " + "".join(f"{kind:>12}" for kind in KINDS))
    for form in forms:
        print(f"{form:10}" + "".join(f"{counts.get((form, kind), 0):12}" for kind in KINDS))
    tuned = sum(counts.get((form, "tuned"), 0) for form in forms)
    keys = sum(count for (form, _), count in counts.items() if form == "key")
    for figure, most, words in ((tuned, MOST_TUNED, "tuned numbers"), (keys, MOST_KEYS, "keys")):
        if figure > most:
            print(f"{TABLE}:1: {figure} {words}, and {most} are the most that are allowed")
            found += 1
    print(f"count_numbers.py: {tuned} tuned numbers, {keys} keys, {len(numbers)} numbers, {found} to be put right")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
