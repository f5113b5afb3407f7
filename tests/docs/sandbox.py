"""Provides a sandbox for the commands of a document: its own directory, DDS domain, TCP ports and
PATH, on the loopback.

Public names in a document are replaced in commands and restored in outputs: `/tmp/x` is in the
directory, `domain: 0` is the sandbox's domain, `127.0.0.1:9464` a free port. All processes are
ended by process id.
"""

import os
import re
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "tools"))
from plant import claim_domain  # noqa: E402

COMMAND_SECONDS = 60
READY_SECONDS = 20
STOP_SECONDS = 10
TURN_SECONDS = 60
# Output of a program that runs until it is stopped, once it is ready.
READY = {"fieldcast-sim": "READY", "fieldcast-bridge": "running: ", "fieldcast-port": "paired", "fieldcast": ""}
DDS_COMMANDS = ["watch", "write", "acquire", "status", "sessions", "alarms"]

# `fieldcast watch` joins the domain 0 by default; this wrapper selects the domain of the sandbox.
IN_DOMAIN = """#!/bin/bash
case " {commands} " in *" $1 "*) case " $* " in *" --config "*|*" --domain "*|*" --store "*|*" --help "*) ;; *) set -- "$@" --domain {domain} ;; esac ;; esac
exec {program} "$@"
"""
# Returns only processes that the sandbox has started.
PIDOF = """#!/bin/bash
cat "{folder}/pids/$1" 2>/dev/null
"""


class Sandbox:
    def __init__(self, bin_dir, source_dir):
        self.bin_dir, self.source_dir = os.path.abspath(bin_dir), os.path.abspath(source_dir)
        self.folder = tempfile.mkdtemp(prefix="fieldcast-docs-")
        self.domain, self._claim = claim_domain()
        self.ports, self.running, self._turn = {}, [], None
        for name in ["work", "shims", "pids", "home", "tmp"]:
            os.mkdir(os.path.join(self.folder, name))
        self.work = os.path.join(self.folder, "work")
        self._shim("fieldcast", IN_DOMAIN.format(commands=" ".join(DDS_COMMANDS), domain=self.domain, program=f"{self.bin_dir}/fieldcast"))
        self._shim("pidof", PIDOF.format(folder=self.folder))

    def close(self):
        try:
            return self.stop()
        finally:
            self._claim.close()
            if self._turn:
                self._turn.close()
            shutil.rmtree(self.folder, ignore_errors=True)

    def wait_for_turn(self):
        """Waits for the lock of sandboxes: `fieldcast capture` queries every bridge of the
        machine."""
        self._turn, end = socket.socket(socket.AF_UNIX), time.monotonic() + TURN_SECONDS
        while True:
            try:
                return self._turn.bind("\0fieldcast-docs-turn")
            except OSError:
                if time.monotonic() > end:
                    raise RuntimeError(f"another document that captures runs on this machine since {TURN_SECONDS} s") from None
                time.sleep(0.1)

    def _shim(self, name, text):
        path = os.path.join(self.folder, "shims", name)
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)
        os.chmod(path, 0o755)

    def inside(self, text):
        text = re.sub(r"/tmp/", f"{self.folder}/tmp/", text)
        text = re.sub(r"\bdomain: \d+", f"domain: {self.domain}", text)
        text = re.sub(r"--domain \d+", f"--domain {self.domain}", text)
        return re.sub(r"\b127\.0\.0\.1:(\d{2,5})\b", lambda match: f"127.0.0.1:{self._port(match.group(1))}", text)

    def outside(self, text):
        text = text.replace(f"{self.folder}/tmp/", "/tmp/").replace(f"{self.work}/", "")
        for port, own in self.ports.items():
            text = text.replace(f"127.0.0.1:{own}", f"127.0.0.1:{port}")
        return re.sub(r"\x1b\[[0-9;?]*[a-zA-Z]", "", text)

    def _port(self, port):
        if port not in self.ports:
            self.ports[port] = free_port(set(self.ports.values()))
        return self.ports[port]

    def write(self, name, text):
        path = os.path.join(self.work, name)
        os.makedirs(os.path.dirname(path), exist_ok=True)
        text = self.inside(text)
        if re.search(r"^bridge:", text, re.MULTILINE) and not re.search(r"^dds:", text, re.MULTILINE):
            text = text.rstrip("\n") + f"\ndds: {{ domain: {self.domain}, interfaces: [127.0.0.1] }}\n"
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)

    def run(self, script):
        try:
            done = subprocess.run(["bash", "-euo", "pipefail", "-c", self.inside(script)], cwd=self.work, env=self._environment(),
                                  stdout=subprocess.PIPE, stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL, timeout=COMMAND_SECONDS)
            return done.returncode, self.outside(done.stdout.decode("utf-8", "replace"))
        except subprocess.TimeoutExpired as late:
            said = self.outside((late.stdout or b"").decode("utf-8", "replace"))
            return f"none within {COMMAND_SECONDS} s; if it runs until stopped, mark it so", said

    def start(self, command, ready=None):
        """Starts a command and waits until it is ready; RuntimeError with the reason if it fails.
        """
        program = command.split()[0]
        if ready is None and program not in READY:
            raise RuntimeError(f"when is {program} at work? Write <!-- runs until stopped: WORDS THAT IT SAYS THEN -->")
        started = Running(["bash", "-c", "exec " + self.inside(command)], program, self.work, self._environment(),
                          os.path.join(self.folder, f"{len(os.listdir(self.folder))}.log"))
        self.running.append(started)
        with open(os.path.join(self.folder, "pids", program), "w", encoding="utf-8") as file:
            file.write(f"{started.process.pid}\n")
        words, end = ready or READY[program], time.monotonic() + READY_SECONDS
        while not (said := started.said()) or words not in said:
            if started.process.poll() is not None:
                raise RuntimeError(f"{program} ended by itself with {started.process.returncode}:\n{self.outside(said)}")
            if time.monotonic() > end:
                raise RuntimeError(f"{program} does not say '{words}' within {READY_SECONDS} s:\n{self.outside(said)}")
            time.sleep(0.02)
        return started

    def stop(self):
        """Ends the commands, newest first, as Ctrl-C does. Returns the faults of their ends."""
        faults = []
        while self.running:
            started = self.running.pop()
            code = started.end()
            if code not in (0, 130):
                faults.append(f"{started.program} ended with {code}:\n{self.outside(started.said())}")
        return faults

    def _environment(self):
        path = f"{self.folder}/shims:{self.bin_dir}:{os.environ.get('PATH', '/usr/bin:/bin')}"
        kept = {name: value for name, value in os.environ.items() if name in ("ASAN_OPTIONS", "TSAN_OPTIONS")}
        return {**kept, "PATH": path, "HOME": f"{self.folder}/home", "TMPDIR": f"{self.folder}/tmp", "LC_ALL": "C.UTF-8",
                "COLUMNS": "120", "NO_COLOR": "1", "SOURCE": self.source_dir}


class Running:
    def __init__(self, command, program, folder, environment, log):
        self.program, self.log = program, log
        with open(log, "wb") as file:
            self.process = subprocess.Popen(command, cwd=folder, env=environment, stdin=subprocess.DEVNULL, stdout=file,
                                            stderr=subprocess.STDOUT)

    def said(self):
        with open(self.log, encoding="utf-8", errors="replace") as file:
            return file.read()

    def end(self):
        if self.process.poll() is None:
            self.process.send_signal(signal.SIGINT)
        try:
            return self.process.wait(STOP_SECONDS)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
            return f"killed: still there {STOP_SECONDS} s after Ctrl-C"


def free_port(taken):
    """Returns a port below the kernel's ephemeral range, so that no other connection gets it."""
    for attempt in range(1000):
        port = 20000 + (os.getpid() * 7 + attempt) % 12000
        with socket.socket() as probe:
            try:
                probe.bind(("127.0.0.1", port))
            except OSError:
                continue
        if port not in taken:
            return port
    raise AssertionError("every port is taken")
