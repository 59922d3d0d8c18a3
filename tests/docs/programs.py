# SPDX-FileCopyrightText: 2026 The CoSLAM authors
# SPDX-License-Identifier: Apache-2.0
"""Runs programs: to their end, or beside the test until it has seen enough. They die with the test."""

import ctypes
import os
import pathlib
import re
import signal
import socket
import subprocess
import threading
import time

LIBC = ctypes.CDLL(None)
LONGEST_S = 60  # A program that is right never takes it, not on a machine under load either.


class Domain:
    """A DDS domain that no other test on this machine uses while this object lives (tests/support/test_domain.h)."""

    def __init__(self) -> None:
        for i in range(90):
            self.number = 10 + (os.getpid() + i) % 90
            self.lock = socket.socket(socket.AF_INET, socket.SOCK_STREAM)
            try:
                self.lock.bind(("127.0.0.1", 7000 + self.number))
                return
            except OSError:
                self.lock.close()
        raise RuntimeError("all test domains are in use")

    def close(self) -> None:
        self.lock.close()

    def __str__(self) -> str:
        return str(self.number)


def die_with_the_test() -> None:
    LIBC.prctl(1, signal.SIGKILL)  # PR_SET_PDEATHSIG


class Program:
    """One that runs. What it prints and says, standard output and error in one, is `text`."""

    def __init__(self, words: list[str], folder: pathlib.Path, environment: dict[str, str]) -> None:
        self.name = " ".join([pathlib.Path(words[0]).name, *words[1:]])
        self.text = ""
        self.news = threading.Condition()
        self.ended = False
        self.process = subprocess.Popen(words, cwd=folder, env=environment, text=True, errors="replace",
                                        stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                                        preexec_fn=die_with_the_test)
        self.reader = threading.Thread(target=self.read, daemon=True)
        self.reader.start()

    def read(self) -> None:
        assert self.process.stdout is not None
        for line in self.process.stdout:
            with self.news:
                self.text += line
                self.news.notify_all()
        with self.news:
            self.ended = True
            self.news.notify_all()

    def says(self, pattern: str, times: int = 1) -> re.Match[str] | None:
        """Waits until it has said this so many times: the last of them. None: it ended, or took too long."""
        end = time.monotonic() + LONGEST_S
        with self.news:
            while True:
                found = list(re.finditer(pattern, self.text, re.MULTILINE))
                if len(found) >= times:
                    return found[times - 1]
                if self.ended or time.monotonic() > end:
                    return None
                self.news.wait(end - time.monotonic())

    def interrupt(self) -> int:
        """Ctrl-C. Its exit code."""
        self.process.send_signal(signal.SIGINT)
        return self.exit_code()

    def exit_code(self) -> int:
        """When it has ended; what takes too long is killed."""
        try:
            code = self.process.wait(LONGEST_S)
        except subprocess.TimeoutExpired:
            self.process.kill()
            code = self.process.wait()
        self.reader.join()
        return code
