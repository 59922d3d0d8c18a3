# SPDX-FileCopyrightText: 2026 The CoSLAM authors
# SPDX-License-Identifier: Apache-2.0
"""Hosts on one machine: network namespaces, joined by a hub of ours that loses, delays, reorders and holds datagrams.

The first host is 10.77.0.1, the next 10.77.0.2 and so on. Needs the right to make network namespaces and TAP devices.
"""

import ctypes
import fcntl
import heapq
import multiprocessing
import os
import random
import select
import socket
import struct
import subprocess
import time

TUNSETIFF, IFF_TAP, IFF_NO_PI = 0x400454CA, 0x0002, 0x1000
LONGEST_FRAME = 2048


class Unavailable(Exception):
    """This machine or user cannot have such hosts; the text says why."""


class Link:
    """What happens to datagrams of one host, on their way up and down alike."""

    def __init__(self, loss=0.0, delay_ms=0.0, jitter_ms=0.0, kbit_s=0.0, up=True, down=True):
        self.loss, self.delay_s, self.jitter_s = loss, delay_ms / 1e3, jitter_ms / 1e3
        self.bytes_s = kbit_s * 125
        self.up, self.down = up, down


def enter(namespace_fd):
    if ctypes.CDLL(None, use_errno=True).setns(namespace_fd, 0x40000000) != 0:
        raise Unavailable("cannot enter a network namespace: " + os.strerror(ctypes.get_errno()))


def open_tap(namespace):
    here = os.open("/proc/self/ns/net", os.O_RDONLY)
    there = os.open("/run/netns/" + namespace, os.O_RDONLY)
    try:
        enter(there)
        tap = os.open("/dev/net/tun", os.O_RDWR | os.O_NONBLOCK)
        fcntl.ioctl(tap, TUNSETIFF, struct.pack("16sH22x", b"w0", IFF_TAP | IFF_NO_PI))
        return tap
    finally:
        enter(here)
        os.close(here)
        os.close(there)


class Hub:
    """Forwards Ethernet frames between TAP devices by the last octet of their address."""

    QUEUE_BYTES = 64000  # that wait for a slow link; more are lost
    MOST_RECORDED = 2000  # datagrams

    def __init__(self, taps, seed):
        self.taps, self.random = taps, random.Random(seed)
        self.recorded = []
        self.links = [Link() for _ in taps]
        self.free_at = {(i, way): 0.0 for i in range(len(taps)) for way in ("up", "down")}
        self.waiting, self.count = [], 0

    def take(self, source, frame, now):
        if len(self.recorded) < self.MOST_RECORDED and frame[12:14] == b"\x08\x00" and frame[23] == socket.IPPROTO_UDP:
            self.recorded.append(frame[14 + 4 * (frame[14] & 15) + 8:])
        self.carry(source, "up", frame, now)

    def carry(self, host, way, frame, now):
        """Over the link of one host. Only when it comes out does it take room on the next: one that waits on its way up,
        as a question for an address that goes to all, must not close the way down of the others until then."""
        link = self.links[host]
        if not getattr(link, way) or self.random.random() < link.loss:
            return
        at = now
        if link.bytes_s > 0:
            start = max(now, self.free_at[host, way])
            if (start - now) * link.bytes_s > self.QUEUE_BYTES:
                return
            at = self.free_at[host, way] = start + len(frame) / link.bytes_s
        at += max(0.0, link.delay_s + self.random.uniform(-link.jitter_s, link.jitter_s))
        self.count += 1
        heapq.heappush(self.waiting, (at, self.count, way, host, frame))

    def targets(self, source, frame):
        hosts = [frame[5] - 1] if frame[0] == 2 else range(len(self.taps))
        return [host for host in hosts if host != source and 0 <= host < len(self.taps)]

    def deliver(self, now):
        while self.waiting and self.waiting[0][0] <= now:
            at, _, way, host, frame = heapq.heappop(self.waiting)
            if way == "up":
                for target in self.targets(host, frame):
                    self.carry(target, "down", frame, at)
                continue
            try:
                os.write(self.taps[host], frame)
            except OSError:
                pass  # as a full queue of a network card

    def run(self, orders):
        by_fd = {tap: i for i, tap in enumerate(self.taps)}
        while True:
            now = time.monotonic()
            self.deliver(now)
            wait = min(0.2, max(0.0, self.waiting[0][0] - now)) if self.waiting else 0.2
            for fd in select.select([*self.taps, orders], [], [], wait)[0]:
                if fd is orders:
                    order = orders.recv()
                    if order is None:
                        return
                    if order == "recorded":
                        orders.send(self.recorded)
                        continue
                    host, link = order
                    self.links[host] = link
                    continue
                try:
                    while True:
                        self.take(by_fd[fd], os.read(fd, LONGEST_FRAME), time.monotonic())
                except BlockingIOError:
                    pass


def ip(*words):
    done = subprocess.run(["ip", *words], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise Unavailable("ip " + " ".join(words) + ": " + done.stderr.strip())


def set_address(name, last):
    ip("-n", name, "addr", "add", f"10.77.0.{last}/24", "dev", "w0")
    ip("-n", name, "route", "add", "239.0.0.0/8", "dev", "w0")


class Hosts:
    """So many hosts, for a `with` block."""

    def __init__(self, count, seed=1):
        self.names = [f"coslam-{os.getpid()}-{i}" for i in range(count)]
        self.seed = seed

    def __enter__(self):
        try:
            self.begin()
        except (OSError, Unavailable) as error:
            self.end()
            raise Unavailable(str(error)) from error
        return self

    def __exit__(self, *_):
        self.orders.send(None)
        self.hub.join(5)
        self.end()

    def begin(self):
        taps = []
        for i, name in enumerate(self.names):
            ip("netns", "add", name)
            taps.append(open_tap(name))
            ip("-n", name, "link", "set", "lo", "up")
            ip("-n", name, "link", "set", "w0", "address", f"02:00:00:00:00:{i + 1:02x}")
            ip("-n", name, "link", "set", "w0", "txqueuelen", "10000", "up")
            set_address(name, i + 1)
        self.orders, theirs = multiprocessing.Pipe()
        self.hub = multiprocessing.get_context("fork").Process(target=Hub(taps, self.seed).run, args=(theirs,), daemon=True)
        self.hub.start()
        for tap in taps:
            os.close(tap)

    def end(self):
        for name in self.names:
            subprocess.run(["ip", "netns", "del", name], capture_output=True, check=False)

    def set_link(self, host, link):
        self.orders.send((host, link))

    def change_address(self, host):
        """As a new lease of an access point does: the old address is gone, the new one is 100 higher."""
        ip("-n", self.names[host], "addr", "flush", "dev", "w0")
        set_address(self.names[host], 100 + host + 1)

    def recorded(self):
        """The first datagrams that were sent, without the heads of Ethernet, IP and UDP."""
        self.orders.send("recorded")
        return self.orders.recv()

    def start(self, host, command, **popen):
        # A session of its own: faketime stays between an agent and its parent.
        return subprocess.Popen(["ip", "netns", "exec", self.names[host], *command], start_new_session=True, **popen)
