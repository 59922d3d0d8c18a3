# SPDX-FileCopyrightText: 2026 The CoSLAM authors
# SPDX-License-Identifier: Apache-2.0
"""deploy/check_words.py on small trees: which comments lack a subject, which names are pronouns, what a breach is."""

import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

SCRIPT = pathlib.Path(__file__).resolve().parents[2] / "deploy" / "check_words.py"
LICENCE = "// SPDX-FileCopyrightText: 2026 The CoSLAM authors\n// SPDX-License-Identifier: Apache-2.0\n#pragma once\n\n"


def check(files: dict[str, str], script: pathlib.Path = SCRIPT) -> tuple[int, list[str], str]:
    """Exit code, the listed places as `rule: words`, and the whole output."""
    with tempfile.TemporaryDirectory() as folder:
        for name, text in files.items():
            path = pathlib.Path(folder) / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text)
        command = [sys.executable, script, "--root", folder, "--list"]
        run = subprocess.run(command, capture_output=True, text=True, check=False)
        places = re.findall(r"^[^:\n]+\.(?:h|cpp):\d+: ((?:subject|pronoun): .*)$", run.stdout, re.MULTILINE)
        return run.returncode, places, run.stdout + run.stderr


class CheckWords(unittest.TestCase):
    def places_in(self, text: str, name: str = "agent/a.h") -> list[str]:
        return check({name: text})[1]

    def comments_hit(self, *comments: str) -> list[str]:
        """Those of the comments that lack a subject, each above a declaration in a header."""
        blocks = [f"// {comment}\nint f{i}();\n\n" for i, comment in enumerate(comments)]
        places = self.places_in(LICENCE + "".join(blocks))
        self.assertTrue(all(place.startswith("subject: ") for place in places), places)
        return [place.removeprefix("subject: ") for place in places]

    def test_comments_without_a_subject(self) -> None:
        bare = ["Of the newest.", "The same, later.", "What an agent sends.", "Its name.", "Now.", "All but the first.",
                "All of them.", "How it is done.", "How many there are.", "Those that are lost.", "One that is lost.",
                "As decode() gives it.", "By name.", "each", "Not while busy.", "Where it lies."]
        self.assertEqual(self.comments_hit(*bare), bare)

    def test_comments_with_a_subject(self) -> None:
        self.assertEqual(self.comments_hit(
            "Name of the agent.", "Whether the camera is lost.", "How many frames wait.", "All agents that take part.",
            "Each camera has one.", "One agent's images.", "One-way delay.", "Removes it.", "The newest image.", "",
            "NOLINTNEXTLINE(some-check): why"), [])

    def test_which_comments_count(self) -> None:
        text = LICENCE + ("int x = 0;   // of the first\n"
                          "int yy = 0;  // centre of the image,\n"
                          "             // of which there is one\n"
                          "const char* url = \"https://of.it\";\n"
                          "// A block whose second line begins\n"
                          "// of itself.\n"
                          "int z = 0;\n"
                          "// Of nothing: no declaration follows.\n"
                          "\n"
                          "int w = 0;\n")
        self.assertEqual(self.places_in(text), ["subject: of the first"])
        self.assertEqual(self.places_in(text, "agent/a.cpp"), [], "only headers are read")
        self.assertEqual(self.places_in(text, "tests/a.h"), [], "tests are left out")

    def test_names(self) -> None:
        text = ("int own = 1;\n"
                "void f(MapId of, const Map& as, std::vector<int>* told);\n"
                "struct S { std::array<int, 3> gone{}; bool told_ = false; };\n"
                "std::string said() const;\n"
                "for (const auto& there : all) g(there);\n"
                "int number = 0, some = 1;\n"
                "for (const auto& [id, which] : all) g(which, id);\n")
        expected = [f"pronoun: {name}" for name in (
            "own", "of", "as", "told", "gone", "told", "said", "there", "some", "which")]
        self.assertEqual(self.places_in(text, "agent/a.cpp"), expected)

    def test_uses_and_other_names(self) -> None:
        self.assertEqual(self.places_in("return own;\nx.of(3);\ny = {.told = true};\ng(own, sizeof there);\n"
                                        "int own_body = 0;\n// int own;\ns = \"int own;\";\nif (a > own) b = c & of;\n",
                                        "agent/a.cpp"), [])

    def test_a_figure_above_its_maximum_is_a_breach(self) -> None:
        plain = LICENCE + "// Name of the agent.\nint f();\n" * 40
        self.assertEqual(check({"agent/a.h": plain})[0], 0)
        code, _, output = check({"agent/a.h": plain + "// Of it.\nint g();\n" * 40})
        self.assertEqual(code, 1, output)
        self.assertIn("agent:1: subject: 50.0, and ", output)
        code, _, output = check({"server/fleet/a.cpp": "int own = 0;\n"})
        self.assertEqual(code, 1, output)
        self.assertIn("server/fleet:1: pronoun: 1000.0, and ", output)
        code, _, output = check({"server/new/a.h": "int f();  // of it\n"})
        self.assertEqual(code, 1, "a folder that is not in the table allows nothing: " + output)

    def test_a_figure_far_below_its_maximum_is_told(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            script = pathlib.Path(folder) / "check_words.py"  # with a larger maximum for one folder
            text, changed = re.subn(r'"agent": \([\d.]+, ', '"agent": (25.0, ', SCRIPT.read_text())
            self.assertEqual(changed, 1)
            script.write_text(text)
            code, _, output = check({"agent/a.h": LICENCE + "// Name of the agent.\nint f();\n"}, script)
        self.assertEqual(code, 0, output)
        self.assertIn("agent: subject: 0.0: the maximum, 25.0, can be lowered", output)

    def test_an_empty_tree_is_no_success(self) -> None:
        self.assertEqual(check({})[0], 1)


if __name__ == "__main__":
    unittest.main()
