# SPDX-FileCopyrightText: 2026 The CoSLAM authors
# SPDX-License-Identifier: Apache-2.0
"""What is not run as it stands in the documents, by name and with its reason."""

# Blocks without a language that are no commands, by the document and the words that they begin with.
NOT_COMMANDS = {
    ("README.md", "camera ─▶ capture"): "a diagram",
    ("README.md", "idl/"): "the folders",
    ("docs/tour.md", "AGENT"): "a diagram",
    ("docs/architecture.md", "camera ─▶ agent/capture"): "a diagram",
    ("docs/live.md", '{"t_s"'): "the form of a message",
    ("docs/examples/README.md", "object"): "printed of a simulated man who walks; the test deploy.install prints another's",
}
# Blocks that show what was printed, by what they begin with: the commands before them printed the head of a table as it
# stands there, and lines with the same first words as the others.
SHOWN = ["agent ", "map server ", "server info: ", "left "]
# Languages whose blocks are code.
NOT_RUN = {"cpp": "docs/examples has it as a program, which is built and run"}

# Scripts that are not run: they exist, and each option stands in their --help.
CHECKED = {
    "deploy/benchmark.sh": "builds, and measures what shares the machine with other tests",
    "deploy/build.sh": "the test is part of what it builds",
    "deploy/coverage.sh": "builds everything anew",
    "deploy/demo.sh": "installs packages and builds",
    "deploy/lint.sh": "looks at the whole tree, and takes long",
    "deploy/package.sh": "builds everything anew",
    "deploy/test-field.sh": "makes network namespaces; with --list it is run",
    "deploy/test-changed.sh": "builds with sanitizers",
    "deploy/test-systems.sh": "takes hours",
    "deploy/test.sh": "runs this test",
    "tests/benchmark/accuracy.py": "takes hours, and recordings that are not here",
    "tests/benchmark/instructions.py": "takes minutes in an emulator that is not installed for tests",
}
# Programs of others.
OF_OTHERS = {
    "MicroXRCEAgent": "PX4's own agent is not installed",
    "apt": "installs; deploy/package.sh --check does so in a fresh Debian",
    "cd": "leads to the packages, which are not made here",
    "cmake": "installs, and builds the examples; the test deploy.install does so",
    "cp": "copies what the package installs",
    "curl": "asks a server at work; tests/server/show/web does so",
    "ctest": "runs this test",
    "ros2": "ROS is not installed",
    "rviz2": "ROS is not installed",
    "systemctl": "starts services; only that the unit exists is checked",
}
PROGRAMS = ["coslam", "coslam-server", "coslam-agent", "coslam-bridge"]
STAYING = PROGRAMS[1:]
EXAMPLES = "examples/build/"  # where docs/examples/README.md builds its programs
# In place of a camera at work.
FILM, CALIBRATION, BOARDS = "camera.mp4", "left.yaml", "chessboard"
