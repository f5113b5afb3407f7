"""The engines of the contract test (e2e_outlets.py): one file and one class `Engine` for each, named after
its section of the configuration of fieldcast-forward.

    name: str                 the section, for example "jetstream"
    has_unique_samples: bool  the engine removes repeated samples by itself
    has_login: bool           if it is not there, True
    keeps_order: bool         samples() returns the samples in the order of their arrival; if it is not there, True
    acknowledgement: int      seconds, if the outlet waits longer than 2 s for the server
    reason_to_skip()          static; None, or why the test cannot run on this machine
    __init__(folder, port)    writes its files to the folder; does not start
    start(), stop()           stop() kills the server; what it has acknowledged is kept
    pause(), resume()         the server neither reads nor responds
    section(login)            the section as YAML; login "right" or "wrong"
    correct_login()           makes a wrong login right, while the forwarder runs
    samples()                 [(path, epoch, sequence, value, quality)] of all that a consumer can read so far; path is
                              "bus/device/channel"
    refuse_one()              makes the engine refuse some messages every time; returns a text that the log must
                              contain then, or None if the engine cannot
"""

import os
import shutil
import signal
import subprocess

from plant import Failure

SITE = "north"
RIGHT_PASSWORD, WRONG_PASSWORD = "correct-horse", "wrong-battery"
UNPACKED = ""  # the directory of tools/install.sh ci; set by the test


def program(name, package, path):
    """The path of a program: installed, or unpacked by tools/install.sh. None if it is missing."""
    installed = shutil.which(name, path=os.environ.get("PATH", "") + ":/usr/sbin")
    unpacked = os.path.join(UNPACKED, package, path)
    return installed or (unpacked if os.path.exists(unpacked) else None)


def secret_file(folder, text, name="password"):
    """Writes a file that only its owner can read; returns its path."""
    path = os.path.join(folder, name)
    with open(os.open(path, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o600), "w", encoding="utf-8") as file:
        file.write(text + "\n")
    return path


class ServerProcess:
    """One server that a test starts, kills and stops temporarily."""

    def __init__(self, log):
        self.log_file, self.process = log, None

    def start(self, *command, **options):
        with open(self.log_file, "a", encoding="utf-8") as log:
            self.process = subprocess.Popen(command, stdout=log, stderr=log, stdin=subprocess.DEVNULL, **options)

    def check(self):
        if self.process.poll() is not None:
            raise Failure(f"{self.process.args[0]} ended with {self.process.returncode}\n{self.log()}")

    def kill(self):
        if self.process is not None and self.process.poll() is None:
            self.process.send_signal(signal.SIGKILL)
        if self.process is not None:
            self.process.wait()

    def pause(self):
        self.process.send_signal(signal.SIGSTOP)

    def resume(self):
        self.process.send_signal(signal.SIGCONT)

    def log(self):
        with open(self.log_file, encoding="utf-8", errors="replace") as file:
            return "--- server:\n" + "".join(file.readlines()[-20:])
