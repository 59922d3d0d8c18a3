#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The CoSLAM authors
# SPDX-License-Identifier: Apache-2.0
"""Has ROS 1's own rosbag write bags of every compression, and our reader read them.

    ros1_bag.py PROGRAM     PROGRAM is recorded_images

Needs Debian's python3-rosbag and python3-sensor-msgs. Exit code 0: all is as it was written; 77: these are not there.
"""

import pathlib
import subprocess
import sys
import tempfile

try:
    import genpy
    import rosbag
    from sensor_msgs.msg import Image
    from std_msgs.msg import String
except ImportError as error:
    print(f"skipped: {error} (packages python3-rosbag, python3-sensor-msgs)")
    sys.exit(77)

START_S, PERIOD_NS, DELAY_NS, BEFORE_NS = 1_700_000_000, 50_000_000, 2_000_000, 100_000_000


def write(file: pathlib.Path, compression: str) -> None:
    with rosbag.Bag(str(file), "w", compression=compression, chunk_threshold=20_000) as bag:
        for i in range(10):
            image = Image(width=64, height=48, encoding="mono8", step=72, data=bytes([20 * i]) * (72 * 48))
            image.header.stamp = genpy.Time(START_S, i * PERIOD_NS)
            noted = genpy.Time(START_S, i * PERIOD_NS + DELAY_NS)
            bag.write("/words", String("not an image"), noted)
            bag.write("/left/image_raw", image, noted)


def main() -> int:
    # Times count from 0.1 s before the recording, whose first message was noted DELAY_NS after the first image.
    expected = "".join(f"{BEFORE_NS - DELAY_NS + i * PERIOD_NS} 64x48 {20 * i}\n" for i in range(10))
    with tempfile.TemporaryDirectory() as folder:
        for compression in ("none", "bz2", "lz4"):
            file = pathlib.Path(folder) / f"{compression}.bag"
            write(file, compression)
            for source in (f"bag:{file}#/left/image_raw", str(file)):
                got = subprocess.run([sys.argv[1], source], capture_output=True, text=True, check=False)
                if got.stdout != expected:
                    print(f"{source}: expected\n{expected}read\n{got.stdout}{got.stderr}")
                    return 1
    print("bags of rosbag: read as they were written")
    return 0


if __name__ == "__main__":
    sys.exit(main())
