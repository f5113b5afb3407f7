"""Runs the real bridge with a simulated plant while the machine fails: disk, clock, descriptors, memory, the process itself.

usage: system_campaign.py --bin DIR --shim LIBRARY [--seconds S] [--seed N] [--scenario NAME].. [--quick]

Each scenario is a row of SCENARIOS. All run once; with --seconds they are repeated with other random choices until the time has passed.
--quick runs the short ones once. Each failure is printed as a line that begins with FAIL, each scenario that cannot run here as SKIPPED;
the last line is the counts as JSON.

In every scenario the bridge must continue to publish: the longest time between two good samples of a channel has a limit.
"""

import argparse
import contextlib
import errno
import json
import os
import random
import resource
import signal
import sqlite3
import subprocess
import sys
import tempfile
import threading
import time
import traceback
import urllib.error
import urllib.request

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [HERE, os.path.join(HERE, "..", "tools")]
import store_kills  # noqa: E402
from fault_shim import FaultShim  # noqa: E402
from plant import Failure, Plant, modbus_line, report, wait_until  # noqa: E402

SOON = 30  # seconds
LONGEST_GAP = 3.0  # seconds between two good samples, on a machine with other load
COMMAND_WITHIN = 12  # seconds

CONFIG = """
bridge: campaign
store: { path: {run}/store/plant.db }
metrics: { listen: 127.0.0.1:{port} }""" + modbus_line() + """\
          - { name: temperature, at: "holding:100", type: float32 }
          - { name: setpoint, at: "holding:200", type: int16, access: read-write }
  - name: hall
    port: { serial: {run}/hall, baud: 19200, format: 8E1 }
    protocol: modbus-rtu
    defaults: { refresh: 500ms }
    devices:
      - { name: mill, address: 2, channels: [ { name: speed, at: "holding:7", type: int16 } ] }
"""
CHANNELS = 3
options = None


class Skipped(Exception):
    pass


class ShimmedPlant(Plant):
    """A plant whose bridge runs under the shim, with a station that always watches it."""

    def __init__(self, below="store"):
        self.port = 21000 + os.getpid() % 9000
        super().__init__(options.bin, CONFIG.replace("{port}", str(self.port)))
        self.below, self.shim, self.watching = below, None, None

    def _start(self, name):
        if name != "fieldcast-bridge":
            return super()._start(name)
        self.store = os.path.join(self.run, "store")
        os.makedirs(self.store, exist_ok=True)
        self.shim = self.shim or FaultShim(options.shim, self.run, self.store)
        with open(os.path.join(self.run, name + ".log"), "a", encoding="utf-8") as log:
            return subprocess.Popen([os.path.join(self.bin_dir, name), self.file], stdout=log, stderr=subprocess.STDOUT,
                                    stdin=subprocess.DEVNULL, env=self.shim.environment())

    def __enter__(self):
        super().__enter__()
        try:
            self.watching = Watching(self)
            wait_until(lambda: self.watching.channels() == CHANNELS, SOON, "the station sees no values")
            self.watching.begin()
        except BaseException:
            super().__exit__(*sys.exc_info())
            raise
        return self

    def __exit__(self, *what):
        if self.watching:
            self.watching.end()
        return super().__exit__(*what)

    def log_text(self):
        with open(os.path.join(self.run, "fieldcast-bridge.log"), encoding="utf-8", errors="replace") as file:
            return file.read()

    def says(self, *words, seconds=SOON):
        wait_until(lambda: all(word in self.log_text() for word in words), seconds,
                   lambda: f"the log does not say {words}\n{self.log('fieldcast-bridge')}")

    def metric(self, name, timeout=5):
        with urllib.request.urlopen(f"http://127.0.0.1:{self.port}/metrics", timeout=timeout) as response:
            for text in response.read().decode().splitlines():
                if text.startswith((name + " ", name + "{", name + "_total")):
                    return float(text.rsplit(" ", 1)[1])
        return None

    def stored(self):
        return int(self.metric("fieldcast_store_samples") or 0)

    def write(self, value):
        """Returns the exit code of a write, and its output."""
        began = time.monotonic()
        result = self.cli("write", f"line/press/setpoint={value}", "--verify", seconds=60)
        if time.monotonic() - began > COMMAND_WITHIN:
            raise Failure(f"the command took {time.monotonic() - began:.1f} s: {result}")
        return result

    def must_write(self, value):
        result = self.write(value)
        if result.code != 0:
            raise Failure(f"a write failed: {result}")

    def restart_bridge(self):
        self.bridge = self._start("fieldcast-bridge")
        wait_until(lambda: self._status() or self._ended(self.bridge), SOON, lambda: "no bus runs\n" + self.log("fieldcast-bridge"))


class Watching:
    """A station that records the last good sample of each channel and the longest gap."""

    def __init__(self, plant):
        self.process = subprocess.Popen([os.path.join(plant.bin_dir, "fieldcast"), "watch", "--json", "--config", plant.file],
                                        stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        self.lock, self.good, self.longest, self.count = threading.Lock(), {}, 0.0, 0
        self.reader = threading.Thread(target=self.read, daemon=True)
        self.reader.start()

    def read(self):
        for text in self.process.stdout:
            try:
                sample = json.loads(text)
            except ValueError:
                continue
            if sample.get("quality") != "GOOD":
                continue
            now, name = time.monotonic(), (sample["bus"], sample["device"], sample["channel"])
            with self.lock:
                self.longest = max(self.longest, now - self.good.get(name, now))
                self.good[name] = now
                self.count += 1

    def channels(self):
        with self.lock:
            return len(self.good)

    def begin(self):
        with self.lock:
            self.longest = 0.0
            self.good = {name: time.monotonic() for name in self.good}

    def check(self, limit=LONGEST_GAP):
        now = time.monotonic()
        with self.lock:
            longest = max([self.longest] + [now - at for at in self.good.values()])
        if longest > limit:
            raise Failure(f"a channel had no good value for {longest:.1f} s; {limit} s are allowed")
        return longest

    def end(self):
        self.process.send_signal(signal.SIGINT)
        self.process.wait(10)


def await_stored(plant, more=20):
    before = plant.stored()
    wait_until(lambda: plant.stored() >= before + more, SOON, lambda: f"nothing is stored\n{plant.log('fieldcast-bridge')}")


def check_store(path, at_least):
    """Checks that the file is valid and contains all reported samples; returns their number."""
    with contextlib.closing(sqlite3.connect(path)) as database:
        if (said := database.execute("pragma integrity_check").fetchone()[0]) != "ok":
            raise Failure(f"the store is not whole: {said}")
        there = database.execute("select count(*) from sample_history").fetchone()[0]
    if there < at_least:
        raise Failure(f"{at_least} samples were reported as stored, {there} are there")
    return there


# Each scenario returns its counts.


def disk_that_fails(number, words, seconds=4):
    """Every write fails with this error for a while; then the disk works again."""
    with ShimmedPlant() as plant:
        await_stored(plant)
        plant.watching.begin()
        plant.shim.error = number
        plant.says(words)
        code = plant.write(1)
        if code.code == 0:
            raise Failure("a write was done although it could not be noted in the store")
        if "store" not in code.out + code.err:
            raise Failure(f"the refusal does not name the store: {code}")
        if plant.cli("acquire", "line/press/setpoint").code != 0:
            raise Failure("a read needs no store")
        time.sleep(seconds)
        dropped, waiting = plant.metric("fieldcast_store_dropped_samples"), plant.metric("fieldcast_store_waiting_samples")
        if dropped:
            raise Failure(f"{dropped} samples were dropped although the queue holds 200 000")
        longest = plant.watching.check()
        plant.shim.error = 0
        plant.says("samples are stored again")
        wait_until(lambda: plant.metric("fieldcast_store_waiting_samples") < 100, SOON, "what waited is not stored")
        plant.must_write(2)
        stored = plant.stored()
        check_store(os.path.join(plant.store, "plant.db"), stored)
    return {"longest_gap": longest, "waited": int(waiting or 0)}


def disk_full(seed):
    return disk_that_fails(errno.ENOSPC, "full")


def disk_read_only(seed):
    return disk_that_fails(errno.EROFS, "store")


def disk_broken(seed):
    return disk_that_fails(errno.EIO, "I/O error")


def disk_really_full(seed):
    """The store is on a small file system that a second program fills."""
    with tempfile.TemporaryDirectory() as scratch:
        if subprocess.run(["mount", "-t", "tmpfs", "-o", "size=3m", "campaign", scratch], capture_output=True).returncode != 0:
            raise Skipped("a file system cannot be mounted here (root alone may)")
        try:
            return really_full(scratch)
        finally:
            subprocess.run(["umount", "-l", scratch], check=True)


def really_full(scratch):
    class OnTmpfs(ShimmedPlant):
        def _start(self, name):
            self.config_file()
            return super()._start(name)

        def config_file(self):
            with open(self.file, encoding="utf-8") as file:
                text = file.read()
            with open(self.file, "w", encoding="utf-8") as file:
                file.write(text.replace(f"{self.run}/store/plant.db", scratch + "/plant.db"))
    with OnTmpfs() as plant:
        await_stored(plant)
        with open(os.path.join(scratch, "ballast"), "wb", buffering=0) as ballast, contextlib.suppress(OSError):
            while True:
                ballast.write(bytes(4096))
        plant.watching.begin()
        plant.says("full")
        time.sleep(2)
        longest = plant.watching.check()
        with contextlib.suppress(OSError):
            os.remove(os.path.join(scratch, "ballast"))
        plant.says("samples are stored again")
        plant.must_write(3)
        check_store(os.path.join(scratch, "plant.db"), plant.stored())
    return {"longest_gap": longest}


def disk_slow(seed):
    """Each operation on the store lasts a fifth of a second."""
    with ShimmedPlant() as plant:
        await_stored(plant)
        plant.shim.delay_us = 200_000
        plant.watching.begin()
        time.sleep(6)
        longest = plant.watching.check()
        result = plant.write(4)
        if result.code not in (0, 5):
            raise Failure(f"neither done nor refused: {result}")
        plant.shim.delay_us = 0
        await_stored(plant)
        check_store(os.path.join(plant.store, "plant.db"), plant.stored())
    return {"longest_gap": longest}


def clock_steps(seed):
    """The wall clock steps forward and back, by seconds and by days."""
    chance = random.Random(seed)
    with ShimmedPlant() as plant:
        await_stored(plant)
        plant.watching.begin()
        for step in chance.sample([3600, -3600, 5, -5, 86400 * 400, -86400 * 30, 0], 5) + [0]:
            plant.shim.clock_offset_ns = step * 1_000_000_000
            before = plant.metric("fieldcast_bus_samples")
            wait_until(lambda: plant.metric("fieldcast_bus_samples") != before, SOON, f"no samples after a step of {step} s")
            # The command line uses the true clock: the bridge may refuse its commands as expired.
            result = plant.write(5)
            if result.code not in (0, 5, 7):
                raise Failure(f"after a step of {step} s: {result}")
            time.sleep(0.5)
        longest = plant.watching.check()
        plant.must_write(6)
        check_store(os.path.join(plant.store, "plant.db"), 1)
    return {"longest_gap": longest, "steps": 6}


def descriptors_exhausted(seed):
    """All descriptors are in use: connected clients continue, new ones wait or are refused."""
    with ShimmedPlant() as plant:
        await_stored(plant)
        plant.must_write(6)  # opens the store's table of commands
        pid = plant.bridge.pid
        before = resource.prlimit(pid, resource.RLIMIT_NOFILE)
        used = max(int(name) for name in os.listdir(f"/proc/{pid}/fd")) + 1
        resource.prlimit(pid, resource.RLIMIT_NOFILE, (used, before[1]))
        plant.watching.begin()
        refused = 0
        for _ in range(10):
            try:
                plant.metric("fieldcast_store_samples", timeout=1)
            except (OSError, urllib.error.URLError):
                refused += 1
        plant.must_write(7)
        time.sleep(2)
        longest = plant.watching.check()
        resource.prlimit(pid, resource.RLIMIT_NOFILE, before)
        wait_until(lambda: scrapes(plant), SOON, "no metrics after descriptors are there again")
        await_stored(plant)
    return {"longest_gap": longest, "turned_away": refused}


def scrapes(plant):
    try:
        return plant.metric("fieldcast_store_samples") is not None
    except (OSError, urllib.error.URLError):
        return False


def memory_limited(seed):
    """The address space is almost exhausted while stations join: the bridge continues, or ends with a message and restarts."""
    more = random.Random(seed).choice([0, 64, 256, 1024, 8192]) * 1024
    with ShimmedPlant() as plant:
        await_stored(plant)
        pid = plant.bridge.pid
        with open(f"/proc/{pid}/statm", encoding="utf-8") as file:
            pages = int(file.read().split()[0])
        before = resource.prlimit(pid, resource.RLIMIT_AS)
        resource.prlimit(pid, resource.RLIMIT_AS, (pages * os.sysconf("SC_PAGE_SIZE") + more, before[1]))
        plant.watching.begin()
        stored = plant.stored() if scrapes(plant) else 0
        for value in range(5):
            if plant.bridge.poll() is None:
                plant.cli("watch", "--once")
                plant.write(value)
        ended = plant.bridge.poll()
        if ended is None:
            longest = plant.watching.check()
            resource.prlimit(pid, resource.RLIMIT_AS, before)
            plant.must_write(8)
            return {"longest_gap": longest, "ended": 0}
        if "memory" not in plant.log_text() and "bad_alloc" not in plant.log_text():
            raise Failure(f"it ended with {ended} and does not say why\n{plant.log('fieldcast-bridge')}")
        check_store(os.path.join(plant.store, "plant.db"), stored)
        plant.restart_bridge()
        plant.must_write(8)
    return {"ended": 1}


def stop_and_go(seed):
    """The process is paused for a while, as on a suspended machine."""
    chance = random.Random(seed)
    with ShimmedPlant() as plant:
        await_stored(plant)
        for seconds in (chance.uniform(0.1, 1), chance.uniform(2, 9)):
            plant.bridge.send_signal(signal.SIGSTOP)
            command = plant.start_cli("write", "line/press/setpoint=9", "--timeout", "3")
            time.sleep(seconds)
            plant.bridge.send_signal(signal.SIGCONT)
            code = command.wait(SOON)
            command.stdout.close()
            if code not in (0, 3, 7, 8) or (code != 0 and seconds < 1):  # 3: no bridge was found meanwhile
                raise Failure(f"a command at a bridge that stood still for {seconds:.1f} s: exit code {code}")
            plant.watching.begin()
            plant.must_write(10)
            time.sleep(1)
            longest = plant.watching.check()
    return {"longest_gap": longest, "stops": 2}


def killed_at_a_write(seed):
    """The bridge is killed at a random operation on its store and restarted; all reported data must be stored."""
    chance = random.Random(seed)
    kills = 0
    plant = ShimmedPlant()
    with plant:
        for _ in range(3):
            await_stored(plant, 5)
            stored = 0
            plant.shim.kill_how = chance.randrange(3)
            plant.shim.kill_at = plant.shim.operations + chance.randrange(1, 60)
            deadline = time.monotonic() + SOON
            while plant.bridge.poll() is None:
                with contextlib.suppress(OSError, urllib.error.URLError, TypeError):
                    stored = max(stored, plant.stored())
                if time.monotonic() > deadline:
                    raise Failure("it was not killed")
            kills += 1
            plant.shim.kill_at = 0
            # The store contains samples of earlier runs too: the counter restarts with each run.
            check_store(os.path.join(plant.store, "plant.db"), stored)
            plant.restart_bridge()
            plant.must_write(11)
    return {"kills": kills}


def killed_at_every_instant(seed):
    return store_kills.killed_at_every_instant(options)


SCENARIOS = {  # name: (function, True if it is short)
    "disk-full": (disk_full, True),
    "disk-really-full": (disk_really_full, False),
    "disk-read-only": (disk_read_only, False),
    "disk-broken": (disk_broken, False),
    "disk-slow": (disk_slow, False),
    "clock-steps": (clock_steps, False),
    "descriptors-exhausted": (descriptors_exhausted, False),
    "memory-limited": (memory_limited, False),
    "stop-and-go": (stop_and_go, False),
    "killed-at-a-write": (killed_at_a_write, False),
    "killed-at-every-instant": (killed_at_every_instant, True),
}


def parse():
    parser = argparse.ArgumentParser()
    parser.add_argument("--bin", required=True)
    parser.add_argument("--shim", required=True)
    parser.add_argument("--seconds", type=float, default=0)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--scenario", action="append", choices=SCENARIOS)
    parser.add_argument("--quick", action="store_true")
    return parser.parse_args()


def main():
    global options
    options = parse()
    options.bin, options.shim = os.path.abspath(options.bin), os.path.abspath(options.shim)
    chosen = options.scenario or [name for name, (_, short) in SCENARIOS.items() if short or not options.quick]
    end = time.monotonic() + options.seconds
    counts, failed, longest = {}, False, 0.0
    try:
        for run in range(10_000):
            for name in chosen:
                if run > 0 and time.monotonic() > end:
                    raise KeyboardInterrupt
                print(f"{name}, run {run + 1}", file=sys.stderr, flush=True)
                row = counts.setdefault(name, {"runs": 0})
                try:
                    result = SCENARIOS[name][0](options.seed * 1000 + run)
                    longest = max(longest, result.pop("longest_gap", 0))
                    row["runs"] += 1
                    for key, value in result.items():
                        row[key] = row.get(key, 0) + value
                except Skipped as reason:
                    print(f"SKIPPED {name}: {reason}", flush=True)
                except (Failure, AssertionError, OSError, subprocess.TimeoutExpired) as failure:
                    failed = True
                    print(f"FAIL {name}, seed {options.seed * 1000 + run}: {str(failure).splitlines()[0]}", flush=True)
                    print(failure if isinstance(failure, Failure) else traceback.format_exc(), file=sys.stderr, flush=True)
            if time.monotonic() > end:
                break
    except KeyboardInterrupt:
        pass
    return report(counts, failed)


if __name__ == "__main__":
    sys.exit(main())
