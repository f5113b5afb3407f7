"""Simulated sites for trials of fieldcast-forward: each has its own DDS domain, bench_bridge, which publishes every channel once a second
records what it publishes and may store it as a bridge does, and a forwarder. The nodes of JetStream run on this machine too."""

import bisect
import contextlib
import os
import re
import signal
import sqlite3
import subprocess
import time

from delayed_line import DelayedLine
from plant import claim_domain, wait_until

START_SECONDS = 60  # many sites start together on few cores
STOP_SECONDS = 30


class Uplink:
    """The connections of a site to all nodes: lines that can be delayed and cut, or the nodes themselves."""

    def __init__(self, nodes, round_trip=None):
        """`round_trip` in seconds; None: without a line, so that it cannot be cut."""
        self.lines = [] if round_trip is None else [DelayedLine(node.port, round_trip) for node in nodes]
        self.ports = [end.port for end in self.lines or nodes]

    def cut(self):
        for line in self.lines:
            line.cut()

    def join(self):
        for line in self.lines:
            line.join()

    def close(self):
        for line in self.lines:
            line.close()


class Site:
    """`more`: further lines of forward.yaml. `has_store`: the bridge stores its samples and serves them."""

    def __init__(self, bin_dir, folder, name, channels, uplink, more="", replicas=1, has_store=False):
        self.bin_dir, self.name, self.channels, self.uplink = bin_dir, name, channels, uplink
        self.folder = os.path.join(folder, name)
        os.mkdir(self.folder)
        self.domain, self._claim = claim_domain()
        self.bridge = self.forwarder = None
        self.has_store = has_store
        self.memory = 0  # bytes, the most of any process of the forwarder
        servers = ", ".join(f"nats://127.0.0.1:{port}" for port in uplink.ports)
        with open(self.path("forward.yaml"), "w", encoding="utf-8") as file:
            file.write(f"site: {name}\ndds: {{ domain: {self.domain} }}\nqueue: {{ path: queue.db }}\n"
                       f"jetstream: {{ servers: [{servers}], streams: {{ create: true, replicas: {replicas} }} }}\n{more}\n")

    def path(self, name):
        return os.path.join(self.folder, name)

    def start_forwarder(self):
        self.forwarder = self._start("forward.log", "fieldcast-forward", "--config", self.path("forward.yaml"))

    def start_bridge(self):
        store = ["--store", self.path("bridge.db")] if self.has_store else []
        self.bridge = self._start("bridge.log", "bench_bridge", str(self.domain), "1", str(self.channels), "real", "--record", self.path("record"), *store)

    def _start(self, log, program, *arguments):
        with open(self.path(log), "a", encoding="utf-8") as file:
            return subprocess.Popen([os.path.join(self.bin_dir, program), *arguments], stdout=file, stderr=file, stdin=subprocess.DEVNULL,
                                    start_new_session=True)  # Ctrl-C reaches only the program that runs the sites

    def kill_forwarder(self):
        self.measure()
        self.forwarder.kill()
        self.forwarder.wait()

    def kill_bridge(self):
        self.bridge.kill()
        self.bridge.wait()

    def measure(self):
        """Reads the memory of the forwarder, and lets it write the state of its queue to the log."""
        if self.forwarder is None or self.forwarder.poll() is not None:
            return
        with open(f"/proc/{self.forwarder.pid}/status", encoding="ascii") as file:
            found = re.search(r"VmHWM:\s+(\d+) kB", file.read())
        self.memory = max(self.memory, 1024 * int(found[1]) if found else 0)
        if "forwards domain" in self.log():  # before this, the signal would end it
            self.forwarder.send_signal(signal.SIGUSR1)

    def log(self):
        with open(self.path("forward.log"), encoding="utf-8", errors="replace") as file:
            return file.read()

    def backlogs(self):
        """The numbers of waiting messages in the log, in order."""
        return [int(number) for number in re.findall(r"(\d+) messages wait", self.log())]

    def wait_until_connected(self):
        wait_until(lambda: self._ended() or "connected to" in self.log(), START_SECONDS, self.log)

    def is_empty(self):
        """Reads the state of the queue. Two empty readings a second apart show that the batches in memory are sent too."""
        self._ended()
        before = len(self.backlogs())
        self.measure()
        wait_until(lambda: self._ended() or len(self.backlogs()) > before, 20, self.log)
        return self.backlogs()[-1] == 0

    def open_gaps(self):
        """The number of gaps that the forwarder has not filled or given up yet. Reads the state of the queue."""
        self.is_empty()
        return int(re.findall(r"(\d+) gaps open", self.log())[-1])

    def _ended(self):
        if self.forwarder.poll() is not None:
            raise AssertionError(f"{self.name}: the forwarder ended by itself with {self.forwarder.returncode}\n{self.log()[-3000:]}")
        return False

    def stop_bridge(self):
        self._stop(self.bridge)

    def close(self):
        for process in (self.bridge, self.forwarder):
            self._stop(process)
        self.uplink.close()
        self._claim.close()

    @staticmethod
    def _stop(process):
        if process is None or process.poll() is not None:
            return
        process.terminate()
        try:
            process.wait(STOP_SECONDS)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()

    def published(self):
        """{(channel number, epoch): times in ns by sequence}, from the record of bench_bridge. Channels of a block share one list."""
        return published(self.path("record"))

    def stored(self):
        """Yields (channel number, epoch, [(sequence, time of acquisition, value)]) of the store of the bridge."""
        with contextlib.closing(sqlite3.connect(f"file:{self.path('bridge.db')}?mode=ro", uri=True)) as store:
            epochs = [row[0] for row in store.execute("select epoch from bus_epochs order by epoch")]
            for number, name in store.execute("select id, channel from channels").fetchall():
                rows = [[] for _ in epochs]
                for published_at, *row in store.execute("select published_at, sequence, acquired_at, real_value from samples where channel = ? "
                                                        "order by published_at, sequence", (number,)):
                    rows[bisect.bisect_right(epochs, published_at) - 1].append(tuple(row))
                for epoch, each in zip(epochs, rows):
                    yield int(name.rpartition("-")[2]), epoch, each


def published(path):
    found, blocks, epoch = {}, {}, 0
    with open(path, encoding="ascii") as file:
        for line in file:
            words = line.split()
            if not line.endswith("\n"):
                break  # cut by a kill
            if words[0] == "epoch":
                epoch, blocks = int(words[2]), {}
                continue
            first, count, sequence, at = map(int, words)
            if first not in blocks:
                blocks[first] = []
                found.update({(channel, epoch): blocks[first] for channel in range(first, first + count)})
            if len(blocks[first]) != sequence - 1:
                raise AssertionError(f"{path}: sequence {sequence} follows {len(blocks[first])}")
            blocks[first].append(at)
    return found


def memory_of(process):
    """The most memory of a running process so far, in bytes."""
    with open(f"/proc/{process.pid}/status", encoding="ascii") as file:
        return 1024 * int(re.search(r"VmHWM:\s+(\d+) kB", file.read())[1])


def folder_bytes(folder):
    return sum(os.path.getsize(os.path.join(path, name)) for path, _, names in os.walk(folder) for name in names)

