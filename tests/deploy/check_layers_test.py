# SPDX-FileCopyrightText: 2026 The CoSLAM authors
# SPDX-License-Identifier: Apache-2.0
"""deploy/check_layers.py on small trees: each rule is broken once and the breach is named with its line."""

import pathlib
import subprocess
import sys
import tempfile
import unittest

SCRIPT = pathlib.Path(__file__).resolve().parents[2] / "deploy" / "check_layers.py"


def check(files: dict[str, str]) -> tuple[int, list[str]]:
    """The exit code and the breaches of a tree of files; one include line each, below a first line of comment."""
    with tempfile.TemporaryDirectory() as folder:
        for name, text in files.items():
            path = pathlib.Path(folder) / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(f"// comment\n{text}\n")
        run = subprocess.run([sys.executable, SCRIPT, "--root", folder], capture_output=True, text=True, check=False)
        return run.returncode, run.stdout.splitlines()[:-1]


class CheckLayers(unittest.TestCase):
    def assert_breach(self, path: str, text: str, rule: str, **others: str) -> None:
        code, lines = check({path: text, **{name.replace("__", "/") + ".h": body for name, body in others.items()}})
        self.assertEqual(code, 1, lines)
        self.assertEqual(len(lines), 1, lines)
        self.assertTrue(lines[0].startswith(f"{path}:2: {rule}: "), lines[0])

    def assert_clean(self, path: str, text: str) -> None:
        self.assertEqual(check({path: text}), (0, []))

    def test_core_is_pure(self) -> None:
        self.assert_breach("server/estimator/map/a.h", "#include <thread>", "threads")
        self.assert_breach("server/estimator/motion/a.cpp", "#include <chrono>", "clock")
        self.assert_breach("common/model/a.h", "#include <yaml-cpp/yaml.h>", "pure")
        self.assert_breach("agent/pose/a.h", '#include "common/base/metrics.h"', "clock")
        self.assert_breach("agent/track/a.cpp", "#include <opencv2/highgui.hpp>", "window")
        self.assert_breach("common/base/a.h", "#include <Eigen/Core>", "pure")

    def test_libraries_stay_in_their_folders(self) -> None:
        self.assert_breach("server/fleet/link/a.cpp", "#include <fastdds/dds/domain/DomainParticipant.hpp>", "DDS")
        self.assert_breach("server/fleet/link/a.cpp", '#include "framePubSubTypes.h"', "DDS")
        self.assert_breach("server/keep/observe/a.cpp", "#include <opencv2/core.hpp>", "OpenCV")
        self.assert_breach("agent/pose/a.cpp", "#include <opencv2/core.hpp>", "OpenCV")
        self.assert_breach("server/estimator/motion/a.cpp", "#include <ceres/ceres.h>", "solver")
        self.assert_breach("server/estimator/map/a.cpp", "#include <cholmod.h>", "solver")
        self.assert_clean("common/wire/a.cpp", "#include <fastdds/dds/domain/DomainParticipant.hpp>")
        self.assert_clean("server/estimator/solve/a.cpp", "#include <ceres/ceres.h>")
        self.assert_clean("agent/track/a.cpp", "#include <opencv2/core.hpp>")
        self.assert_clean("agent/a.cpp", "#include <opencv2/features2d.hpp>")

    def test_made_headers_are_dds(self) -> None:
        code, lines = check({"server/fleet/link/a.cpp": '#include "contract.h"', "idl/contract.idl": ""})
        self.assertEqual((code, len(lines)), (1, 1), lines)

    def test_order_of_the_folders(self) -> None:
        self.assert_breach("common/geometry/a.h", '#include "common/model/b.h"', "layer")
        self.assert_breach("agent/link/a.h", '#include "server/fleet/link/b.h"', "layer")
        self.assert_breach("server/app/a.cpp", '#include "agent/b.h"', "layer")
        self.assert_breach("common/dataset/a.h", '#include "tests/support/b.h"', "layer")
        self.assert_breach("server/estimator/map/a.h", '#include "common/flow/queue.h"', "layer")
        self.assert_clean("deploy/coslam/a.cpp", '#include "agent/agent.h"\n#include "server/app/server.h"')
        self.assert_breach("server/app/a.cpp", '#include "deploy/simulation/b.h"', "layer")
        self.assert_breach("deploy/simulation/a.h", '#include "server/estimator/map/b.h"', "layer")
        self.assert_clean("deploy/coslam/a.cpp", '#include "deploy/simulation/b.h"')
        self.assert_breach("docs/examples/a.cpp", '#include "common/dataset/b.h"', "layer")
        self.assert_clean("docs/examples/a.cpp", '#include "common/wire/loop.h"\n#include "idl/coslam.h"')
        self.assert_clean("agent/link/a.cpp", '#include "common/wire/reader.h"\n#include "common/flow/queue.h"')

    def test_core_folders_form_no_ring(self) -> None:
        code, lines = check({
            "agent/pose/a.h": '#include "agent/track/b.h"',
            "agent/track/b.h": '#include "agent/pose/c.h"',
        })
        self.assertEqual(code, 1)
        self.assertEqual(lines, ["agent/pose/a.h:2: cycle: agent/pose -> agent/track -> agent/pose"])

    def test_form_of_the_lines(self) -> None:
        self.assert_breach("common/model/a.h", '#include "b.h"', "form", common__model__b="")
        self.assert_breach("common/model/a.h", '#include "../base/b.h"', "form", common__base__b="")
        self.assert_breach("common/model/a.h", "#include <common/base/b.h>", "form", common__base__b="")
        self.assert_breach("common/model/a.h", "#include HEADER", "form")

    def test_folder_without_an_entry(self) -> None:
        code, lines = check({"agent/extra/a.h": ""})
        self.assertEqual(code, 1)
        self.assertTrue(lines[0].startswith("agent/extra/a.h:1: folder: "), lines)


if __name__ == "__main__":
    unittest.main()
