#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The CoSLAM authors
# SPDX-License-Identifier: Apache-2.0
"""Checks by their #include lines that the folders keep to the layers of docs/architecture.md.

    deploy/check_layers.py [--root DIR]

Prints `file:line: rule: what is wrong` for each breach. Exit code 0: none; 1: some; 2: wrong usage.
"""

import argparse
import pathlib
import re
import sys

# Which folders a folder may include, besides itself: an entry stands for the folder and all below it. The entries of
# MAINS stand only for the files that lie in them, so that a new folder needs an entry of its own.
BASE = ["common/base"]
GEOMETRY = [*BASE, "common/geometry"]
MODEL = [*GEOMETRY, "common/model"]
FILES = [*MODEL, "common/config", "common/dataset"]
AGENT_CORE = ["agent/track", "agent/pose", "agent/correct"]
# The server's five wings, each with what is below it; in the estimator, each room with what is below it.
ROOMS = "server/estimator"
SERVER_MAP = [f"{ROOMS}/map", f"{ROOMS}/pipeline", f"{ROOMS}/reports"]
SERVER_ASSOCIATE = [*SERVER_MAP, f"{ROOMS}/solve", f"{ROOMS}/covisibility", f"{ROOMS}/associate"]
SERVER_CORE = [*SERVER_ASSOCIATE,
               *(f"{ROOMS}/{room}" for room in ("pose", "adjust", "motion", "places", "create", "correct", "past"))]
FLEET = ["server/fleet/link", "server/fleet/sync"]
KEEP = ["server/keep/store", "server/keep/observe", "server/keep/explain", "server/keep"]
MAY_INCLUDE = {
    "common/base": [],
    "common/geometry": BASE,
    "common/model": GEOMETRY,
    "common/config": MODEL,
    "common/flow": BASE,
    "common/ros": GEOMETRY,
    "common/compression": BASE,
    "common/mcap": [*BASE, "common/compression"],
    "common/video": BASE,
    "common/video/ffmpeg": [*BASE, "common/video", "common/image"],
    "common/image": [*BASE, "common/video"],
    "common/recording": [*MODEL, "common/config", "common/ros", "common/compression", "common/mcap"],
    "common/wire": [*MODEL, "common/flow", "idl"],
    "common/dataset": [*FILES, "common/ros", "common/recording"],
    "agent/capture": [*FILES, "common/ros", "common/recording", "common/flow", "common/wire", "common/video", "common/image",
                      "agent/track"],
    "agent/track": [*MODEL, "common/image", "common/video", *AGENT_CORE],
    "agent/gpu": [*MODEL, "agent/track"],
    "agent/pose": [*MODEL, *AGENT_CORE],
    "agent/correct": [*MODEL, *AGENT_CORE],
    "agent/link": [*MODEL, *AGENT_CORE, "common/flow", "common/wire"],
    "agent": ["common", "agent"],
    "server/estimator/map": MODEL,
    "server/estimator/pipeline": [*MODEL, *SERVER_MAP],
    "server/estimator/solve": MODEL,
    "server/estimator/reports": MODEL,
    "server/estimator/covisibility": [*MODEL, *SERVER_MAP, f"{ROOMS}/solve"],
    "server/estimator/associate": [*MODEL, *SERVER_ASSOCIATE],
    "server/estimator/pose": [*MODEL, *SERVER_ASSOCIATE],
    "server/estimator/adjust": [*MODEL, *SERVER_ASSOCIATE],
    "server/estimator/motion": [*MODEL, *SERVER_ASSOCIATE],
    "server/estimator/correct": [*MODEL, *SERVER_ASSOCIATE],
    "server/estimator/places": [*MODEL, *SERVER_ASSOCIATE, f"{ROOMS}/pose"],
    "server/estimator/create": [*MODEL, *SERVER_ASSOCIATE, f"{ROOMS}/pose", f"{ROOMS}/adjust", f"{ROOMS}/motion"],
    "server/estimator/past": [*MODEL, *SERVER_ASSOCIATE, f"{ROOMS}/adjust"],
    "server/estimator": [*MODEL, "common/config", "common/flow", *SERVER_CORE],
    "server/fleet/sync": [*MODEL, "server/estimator/map"],
    "server/fleet/link": [*MODEL, *SERVER_CORE, "common/flow", "common/wire"],
    "server/fleet/record": [*MODEL, "common/flow", "common/wire", "server/fleet/link"],
    "server/keep/store": [*MODEL, "common/flow", "server/estimator/map"],
    "server/keep/explain": [*FILES, "server/estimator/map"],
    "server/keep/observe": [*FILES, *SERVER_CORE, "server/estimator"],
    "server/keep": [*FILES, "common/flow", *SERVER_CORE, "server/estimator", *FLEET, *KEEP],
    "server/show/publish": [*MODEL, "common/ros", *SERVER_CORE, "server/estimator", *KEEP],
    "server/show/web": [*FILES, "common/flow", "server/show/publish", "server/keep/explain"],
    "server/show/bridge": [*MODEL, "common/config", "common/flow", "common/ros", "common/wire"],
    "server/show": [*FILES, "common/flow", "common/mcap", *SERVER_CORE, "server/estimator", *FLEET, *KEEP, "server/show"],
    "server/app": ["common", "server"],
    "deploy/simulation": [*FILES, "common/image"],
    "deploy": ["common", "agent", "server", "deploy"],  # `coslam run --inline` holds both sides in one process
    "tests": ["common", "agent", "server", "deploy", "tests", "idl"],
    "docs/examples": [*MODEL, "common/flow", "common/wire", "idl"],  # what libcoslam-dev installs
    "idl": [],
}
MAINS = ["agent", "server/estimator", "server/keep", "server/show"]

# The pure core: no middleware, threads, clocks or windows. It includes the standard library, Eigen and what LIBRARIES
# grants; everything else is a breach.
CORE = ["common/base", "common/geometry", "common/model", "common/ros", *AGENT_CORE, *SERVER_CORE]
IMPURE = {
    "threads": "thread mutex shared_mutex condition_variable atomic future semaphore latch barrier stop_token pthread.h".split(),
    "clock": "chrono ctime time.h sys/time.h sys/timeb.h".split(),
}
# Our own headers that hold a clock: fine outside the core.
IMPURE_OWN = {"clock": ["common/base/log.h", "common/base/metrics.h"]}

# Libraries that live in few folders: the headers that tell them, and where they may be.
LIBRARIES = {
    "DDS": (r"(fastdds|fastrtps|fastcdr|dds)/|.*(PubSubTypes|TypeObject|TypeObjectSupport|CdrAux)\.(h|hpp)$", ["common/wire", "tests/common/wire"]),
    "OpenCV": (r"opencv2?/", ["agent/capture", "agent/track", "agent/gpu", "agent", "common/dataset", "common/image", "deploy/simulation", "deploy/coslam", "tests", "server/estimator/solve"]),
    "FFmpeg": (r"lib(av|sw)[a-z]+/", ["common/video/ffmpeg", "tests"]),
    "GStreamer": (r"gst/", ["common/video/gstreamer"]),
    "image files": (r"(png|jpeglib)\.h$", ["common/image"]),
    "OpenCL": (r"CL/", ["agent/gpu"]),
    "cryptography": (r"openssl/", ["common/wire"]),
    "serialisation": (r"cereal/", ["server/estimator/map"]),
    "web": (r"boost/(asio|beast)", ["server/show/web", "tests/server/show/web", "tests/system"]),
    "containers": (r"boost/container/", ["common/base"]),
    "database": (r"(sqlite3\.h|SQLiteCpp/)", ["server/keep/store", "tests/server/keep/store", "common/recording", "tests/common/recording"]),
    "solver": (r"ceres/|suitesparse/|(cholmod|amd|camd|colamd|ccolamd|umfpack|klu|SuiteSparse).*\.h(pp)?$",
               ["server/estimator/solve", "tests/server/estimator/solve", "tests/support", "tests/benchmark"]),
    "ray caster": (r"embree\d?/", ["deploy/simulation"]),
    "window": (r"opencv2?/highgui|gtk/|Qt|GL/|GLFW/|X11/", []),
}
# The library patterns whose folders are these alone, not those below them.
EXACT = {("OpenCV", "agent")}

# (file, header): why. The only breaches that are accepted.
EXCEPTIONS = {
    ("common/base/metrics.h", "chrono"): "stage times are measured with a clock; the core does not include it",
    ("server/fleet/link/admission.cpp", "idl/coslam.h"): "bounds of the wire contract",
    ("common/base/time.h", "chrono"): "durations only",
    ("server/estimator/pipeline/pipeline.h", "common/base/metrics.h"): "the one place where stages are timed",
    ("server/show/publish/json.cpp", "common/dataset/report_parts.h"): "an account of images has one form in files and messages",
    ("common/base/log.h", "chrono"): "one log line a second; the core does not include it",
    ("common/base/log.cpp", "atomic"): "every thread logs",
    ("common/base/log.cpp", "mutex"): "the same",
    ("common/base/log.cpp", "spdlog/spdlog.h"): "the one place that knows the logging library",
    ("common/base/log.cpp", "spdlog/sinks/stdout_color_sinks.h"): "the same",
    ("common/base/log.cpp", "spdlog/pattern_formatter.h"): "the same",
    ("common/base/log.cpp", "nlohmann/json.hpp"): "escapes what a line of JSON says",
    ("common/base/metrics.cpp", "sys/resource.h"): "peak memory of the process",
    ("common/base/text.cpp", "ctime"): "a date as text; reads no clock",
    ("agent/track/lanes_avx2.h", "immintrin.h"): "the vector unit's own instructions",
    ("agent/track/lanes_neon.h", "arm_neon.h"): "the same",
}

TOP = ["common", "agent", "server", "deploy", "tests", "docs", "idl"]
INCLUDE = re.compile(r'\s*#\s*include\s*(?:<([^>]+)>|"([^"]+)"|(\S.*))')


def inside(path: str, folder: str) -> bool:
    return path == folder or path.startswith(folder + "/")


def entry(folder: str) -> str | None:
    """The name in MAY_INCLUDE that holds for a folder, or None."""
    names = (name for name in MAY_INCLUDE if folder == name or (name not in MAINS and inside(folder, name)))
    return max(names, key=len, default=None)


def library_of(root: pathlib.Path, header: str) -> str | None:
    """The name in LIBRARIES of a header; those that are made from idl/ are DDS, a window of OpenCV is a window."""
    stem = pathlib.PurePath(header).stem
    if (root / "idl" / f"{stem}.idl").exists():
        return "DDS"
    return next((name for name in reversed(LIBRARIES) if re.match(LIBRARIES[name][0], header)), None)


def granted(library: str, folder: str) -> bool:
    return any(
        folder == place if (library, place) in EXACT else inside(folder, place) for place in LIBRARIES[library][1]
    )


def breach_of_own(folder: str, header: str) -> tuple[str, str] | None:
    """A header of this project, named from the top."""
    target = header.rpartition("/")[0]
    here, there = entry(folder), entry(target) or target
    core = any(inside(folder, name) for name in CORE)
    for rule, headers in IMPURE_OWN.items():
        if core and here != "common/base" and header in headers:
            return rule, f"{here} is pure: it takes times as arguments, no {header}"
    if here == there or any(inside(there, name) for name in MAY_INCLUDE[here]):
        return None
    return "layer", f"{here} may not include {there} ({header})"


def breach_of_foreign(root: pathlib.Path, folder: str, header: str) -> tuple[str, str] | None:
    """A header of the standard library, the system or another library."""
    library = library_of(root, header)
    if library is not None:
        if granted(library, folder):
            return None
        return library, f"{folder} may not include <{header}>, only {', '.join(LIBRARIES[library][1]) or 'no folder'} may"
    if not any(inside(folder, name) for name in CORE):
        return None
    for rule, headers in IMPURE.items():
        if header in headers:
            return rule, f"{entry(folder)} is pure: no <{header}>"
    standard = "/" not in header and not header.endswith((".h", ".hpp"))
    if standard or (re.match(r"(unsupported/)?Eigen/", header) and not inside(folder, "common/base")):
        return None
    return "pure", f"{entry(folder)} includes the standard library and Eigen, not <{header}>"


def includes_of(root: pathlib.Path, path: str):
    """(line number, header, in quotes) for each include line; the header of an include by macro starts with a blank."""
    for number, line in enumerate((root / path).read_text(errors="replace").splitlines(), start=1):
        match = INCLUDE.match(line)
        if match:
            yield number, match[1] or match[2] or " " + match[3], match[2] is not None


def breach_of(root: pathlib.Path, path: str, header: str, quoted: bool) -> tuple[str, str] | None:
    """(rule, what is wrong) with one include line, or None."""
    folder = path.rpartition("/")[0]
    if (path, header) in EXCEPTIONS:
        return None
    if header.startswith(" "):
        return "form", f"an include by macro cannot be checked:{header}"
    if header.startswith(".") or (quoted and (root / folder / header).exists()):
        return "form", f'name the header from the top of the tree, not "{header}"'
    if header.split("/")[0] in TOP and (quoted or (root / header).exists()):
        return breach_of_own(folder, header) if quoted else ("form", f'write "{header}" in quotes')
    return breach_of_foreign(root, folder, header)


def cycle_in(edges: dict) -> list[str]:
    """Folders that include each other in a ring, the first one repeated at the end; empty when there is none."""
    done: set[str] = set()

    def walk(folder: str, trail: list[str]) -> list[str]:
        if folder in trail:
            return [*trail[trail.index(folder):], folder]
        if folder in done:
            return []
        for following in sorted(there for here, there in edges if here == folder):
            ring = walk(following, [*trail, folder])
            if ring:
                return ring
        done.add(folder)
        return []

    return next(filter(None, (walk(here, []) for here in sorted({here for here, _ in edges}))), [])


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--root", type=pathlib.Path, default=pathlib.Path(__file__).resolve().parent.parent)
    root = parser.parse_args().root.resolve()

    files = sorted(
        str(path.relative_to(root))
        for top in TOP if (root / top).is_dir()
        for path in (root / top).rglob("*") if path.suffix in {".h", ".hpp", ".cpp"} and path.is_file()
    )
    if not files:
        print(f"check_layers.py: no C++ files under {root}", file=sys.stderr)
        return 1

    found = 0
    core_edges: dict[tuple[str, str], str] = {}  # which core folder includes which, and where
    for path in files:
        here = entry(path.rpartition("/")[0])
        if here is None:
            print(f"{path}:1: folder: {path.rpartition('/')[0]} is no folder of the architecture: MAY_INCLUDE lacks it")
            found += 1
            continue
        for number, header, quoted in includes_of(root, path):
            breach = breach_of(root, path, header, quoted)
            if breach:
                print(f"{path}:{number}: {breach[0]}: {breach[1]}")
                found += 1
            there = entry(header.rpartition("/")[0]) if quoted else None
            if here in CORE and there in CORE and here != there:
                core_edges.setdefault((here, there), f"{path}:{number}")
    ring = cycle_in(core_edges)
    if ring:
        print(f"{core_edges[ring[0], ring[1]]}: cycle: {' -> '.join(ring)}")
        found += 1
    print(f"check_layers.py: {len(files)} files, {found} breaches of the layers")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
