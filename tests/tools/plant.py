"""Runs a simulated plant with its bridge for end-to-end tests: the real programs, in their own DDS
domain and directory.

    with Plant(bin_dir, CONFIG) as plant:
        plant.cli("watch", "--json", "--once")

CONFIG is the YAML of a plant; {run} is replaced by the directory. This process starts all programs
and ends them by process id. Remaining processes or links are a failure on exit.
"""

import contextlib
import json
import os
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time
import unittest

START_SECONDS = 20  # limit until the simulated lines and the bridge's first status exist
STOP_SECONDS = 10
CLI_SECONDS = 60


class Failure(AssertionError):
    pass


def wait_until(condition, seconds, reason):
    """Returns the first true condition(); Failure with the reason after the limit."""
    deadline = time.monotonic() + seconds
    while True:
        if result := condition():
            return result
        if time.monotonic() > deadline:
            raise Failure(f"not within {seconds} s: {reason() if callable(reason) else reason}")
        time.sleep(0.02)


def modbus_line(bus="line", device="press", port="baud: 115200, format: 8N1", defaults="refresh: 200ms"):
    """Returns the start of `buses:`, a Modbus RTU line with one device; its channels must follow."""
    return f"""
buses:
  - name: {bus}
    port: {{ serial: {{run}}/line, {port} }}
    protocol: modbus-rtu
    defaults: {{ {defaults} }}
    devices:
      - name: {device}
        address: 1
        channels:
"""


def shared_memory():
    return {name for name in os.listdir("/dev/shm") if "fastrtps" in name or "fastdds" in name}


def claim_domain():
    """Claims a DDS domain that no other test on this machine uses while the result lives: (domain
    number, claim).

    The claim is the highest port of the domain's range (7400 + 250 * domain ..), which no
    participant below the 120th uses. Above domain 100 the kernel assigns these ports. A domain with
    an unclaimed participant, for example of a killed test, is skipped.
    """
    for attempt in range(90):
        domain = 10 + (os.getpid() + attempt) % 90
        claim = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        try:
            claim.bind(("127.0.0.1", 7400 + 250 * domain + 249))
            if not udp_ports() & set(range(7400 + 250 * domain, 7400 + 250 * domain + 249)):
                return domain, claim
        except OSError:
            pass
        claim.close()
    raise Failure("every DDS domain from 10 to 99 is claimed by a test, or in use")


def udp_ports():
    found = set()
    for table in ("/proc/net/udp", "/proc/net/udp6"):
        if os.path.exists(table):
            with open(table, encoding="ascii") as file:
                found |= {int(line.split()[1].rpartition(":")[2], 16) for line in file.readlines()[1:]}
    return found


class Result:
    def __init__(self, process):
        self.code, self.out, self.err = process.returncode, process.stdout, process.stderr

    def json_lines(self):
        return [json.loads(line) for line in self.out.splitlines()]

    def __str__(self):
        return f"exit code {self.code}\n--- stdout\n{self.out}\n--- stderr\n{self.err}"


def run_cli(bin_dir, *arguments, seconds=CLI_SECONDS, stdin=""):
    process = subprocess.run([os.path.join(bin_dir, "fieldcast"), *arguments], capture_output=True, text=True, timeout=seconds, input=stdin)
    return Result(process)


@contextlib.contextmanager
def running_bridge(bin_dir, config, log):
    """Runs a bridge; SIGTERM must end it with code 0. Shows its output on a failure."""
    with open(log, "w+", encoding="utf-8") as said:
        bridge = subprocess.Popen([os.path.join(bin_dir, "fieldcast-bridge"), config], stdin=subprocess.DEVNULL, stdout=said, stderr=said)
        try:
            yield
            bridge.terminate()
            code = bridge.wait(STOP_SECONDS)
            if code != 0:
                raise Failure(f"the bridge ended with {code}")
        except BaseException:
            said.seek(0)
            sys.stderr.write(said.read())
            raise
        finally:
            if bridge.poll() is None:
                bridge.kill()
                bridge.wait()


def report(counts, failed):
    """Prints the counts of a campaign and returns its exit code."""
    print(json.dumps(counts))
    return 1 if failed else 0


def run_alone(name, run):
    """Runs a script's run(BIN_DIR); a Failure ends the process with its text."""
    try:
        run(sys.argv[1])
    except Failure as failure:
        sys.exit(f"{name}: {failure}")


class InAFolder(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="fieldcast-test-")
        self.addCleanup(folder.cleanup)
        self.folder = folder.name

    def path(self, name):
        return os.path.join(self.folder, name)

    def file(self, name, text):
        with open(self.path(name), "w", encoding="utf-8") as file:
            file.write(text)
        return self.path(name)


class Plant:
    def __init__(self, bin_dir, config, dds="", joins=(), interfaces="127.0.0.1"):
        """`dds`: more keys, each after a comma. `joins`: more options of every command."""
        self.interfaces = interfaces
        self.bin_dir, self.config, self.dds, self.joins = bin_dir, config, dds, joins
        self.domain, self._claim = claim_domain()
        self.run = self.sim = self.bridge = None

    def __enter__(self):
        self.run = tempfile.mkdtemp(prefix="fieldcast-e2e-")
        self.file = os.path.join(self.run, "plant.yaml")
        with open(self.file, "w", encoding="utf-8") as file:
            file.write(self.config.replace("{run}", self.run))
            file.write(f"\ndds: {{ domain: {self.domain}, interfaces: [{self.interfaces}]{self.dds} }}\n")
        try:
            self.sim = self._start("fieldcast-sim")
            for path in self._lines():
                wait_until(lambda p=path: os.path.exists(p) or self._ended(self.sim), START_SECONDS, lambda: f"{path} is not there\n" + self.log("fieldcast-sim"))
            self.bridge = self._start("fieldcast-bridge")
            wait_until(lambda: self._status() or self._ended(self.bridge), START_SECONDS, lambda: "no bus runs\n" + self.log("fieldcast-bridge"))
        except BaseException:
            self._stop_all()
            self._claim.close()
            shutil.rmtree(self.run, ignore_errors=True)
            raise
        return self

    def __exit__(self, kind, value, trace):
        codes = self._stop_all()
        self._claim.close()
        logs = self.log("fieldcast-sim") + self.log("fieldcast-bridge")
        left = [path for path in self._lines() if os.path.lexists(path)]
        shutil.rmtree(self.run, ignore_errors=True)
        if kind is not None:
            return
        if any(code != 0 for code in codes.values()):
            raise Failure(f"the programs ended with {codes}\n{logs}")
        if left:
            raise Failure(f"the simulator left {left}")

    def cli(self, command, *arguments, seconds=CLI_SECONDS):
        return run_cli(self.bin_dir, command, *arguments, "--config", self.file, *self.joins, seconds=seconds)

    def log(self, name):
        with open(os.path.join(self.run, name + ".log"), encoding="utf-8", errors="replace") as file:
            return f"--- {name}:\n" + "".join(file.readlines()[-40:])

    def start_cli(self, command, *arguments, **options):
        """Starts a command that must end by itself, so that no wait for it is endless."""
        return subprocess.Popen([os.path.join(self.bin_dir, "fieldcast"), command, *arguments, "--config", self.file],
                                stdout=subprocess.PIPE, text=True, **options)

    def kill_bridge(self):
        """Kills the bridge and starts it again."""
        self.bridge.kill()
        self.bridge.wait()
        self.bridge = self._start("fieldcast-bridge")
        wait_until(lambda: self._status() or self._ended(self.bridge), START_SECONDS, lambda: "no bus runs\n" + self.log("fieldcast-bridge"))

    def _lines(self):
        words = self.config.replace("{run}", self.run).replace(",", " ").replace("}", " ").split()
        return [words[i + 1] for i, word in enumerate(words) if word == "serial:"]

    def _start(self, name):
        with open(os.path.join(self.run, name + ".log"), "w", encoding="utf-8") as log:
            return subprocess.Popen([os.path.join(self.bin_dir, name), self.file], stdout=log, stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL)

    def _ended(self, process):
        if process.poll() is not None:
            name = os.path.basename(process.args[0])
            raise Failure(f"{name} ended by itself with {process.returncode}\n{self.log(name)}")
        return False

    def _status(self):
        result = self.cli("status", "--json")
        buses = [line for line in result.json_lines() if line["topic"] == "BusStatus"] if result.code == 0 else []
        return len(buses) == len(self._lines()) and all(bus["state"] == "running" for bus in buses)

    def _stop_all(self):
        codes = {}
        # the bridge first: the loss of the plant is another test
        for process in (self.bridge, self.sim):
            if process is None:
                continue
            if process.poll() is None:
                process.send_signal(signal.SIGTERM)
            try:
                codes[os.path.basename(process.args[0])] = process.wait(STOP_SECONDS)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()
                codes[os.path.basename(process.args[0])] = f"killed: still there {STOP_SECONDS} s after SIGTERM"
        return codes
