#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The CoSLAM authors
# SPDX-License-Identifier: Apache-2.0
"""deploy/Dockerfile does what deploy/check-packages.sh tries: it installs packages that exist, and starts what the units start."""

import json
import pathlib
import re
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
TEXT = (ROOT / "deploy/Dockerfile").read_text()


def stages() -> dict[str, list[str]]:
    """The instructions of each stage, by its name."""
    found: dict[str, list[str]] = {}
    name = ""
    for line in re.sub(r"\\\n\s*", "", TEXT).splitlines():
        if match := re.fullmatch(r"FROM (\S+) AS (\S+)", line):
            name = match[2]
            found[name] = [line]
        elif name and line and not line.startswith("#"):
            found[name].append(line)
    return found


class Dockerfile(unittest.TestCase):
    def test_each_stage_is_of_a_release_that_is_named(self) -> None:
        self.assertEqual(set(stages()), {"packages", "agent", "server"})
        self.assertIn("ARG RELEASE=bookworm", TEXT)
        for instructions in stages().values():
            self.assertTrue(instructions[0].startswith("FROM debian:${RELEASE}-slim AS "), instructions[0])

    def test_packages_are_those_that_are_made(self) -> None:
        made = set(re.findall(r"coslam_package\(\w+ (\S+)", (ROOT / "deploy/install/Packages.cmake").read_text()))
        self.assertIn("RUN deploy/package.sh", stages()["packages"])
        for name in ("agent", "server"):
            copied = re.findall(r"/coslam/build/packages/(\S+)_\*\.deb", "\n".join(stages()[name]))
            self.assertIn(f"coslam-{name}", copied)
            self.assertLessEqual(set(copied), made)

    def test_lists_of_packages_are_not_kept(self) -> None:
        for name in ("agent", "server"):
            runs = [line for line in stages()[name] if line.startswith("RUN ")]
            self.assertEqual(len(runs), 1)
            self.assertRegex(runs[0], r"apt-get update && apt-get install --yes --no-install-recommends .*rm -rf .*/var/lib/apt/lists")

    def test_the_server_is_started_as_its_unit_does(self) -> None:
        unit = (ROOT / "deploy/systemd/coslam-server.service").read_text()
        start = re.search(r"^ExecStart=(.*)$", unit, re.MULTILINE)
        assert start is not None
        expected = start[1].replace("%E", "/etc").replace("%S", "/var/lib").split()
        entry = next(line for line in stages()["server"] if line.startswith("ENTRYPOINT "))
        self.assertEqual(json.loads(entry.removeprefix("ENTRYPOINT ")), expected)
        self.assertIn("STOPSIGNAL SIGINT", stages()["server"])
        self.assertIn("KillSignal=SIGINT", unit)

    def test_nobody_is_root(self) -> None:
        for name in ("agent", "server"):
            self.assertIn("USER coslam", stages()[name])


if __name__ == "__main__":
    unittest.main()
