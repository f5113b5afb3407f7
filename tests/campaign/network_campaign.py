"""Bridges and stations on hosts of their own, on a network that loses, doubles, reorders and partitions, while everything restarts.

usage: network_campaign.py --bin DIR [--seconds S] [--seed N] [--scenario multicast | discovery-server | partition]..

partition: a station is cut off for 12 s, and nothing else happens.

The others:

Two bridges with a bus each, a third one that waits for the bus of the first, a plant behind the network, two stations of ours, and one
on Cyclone DDS (with `discovery-server` a third one of ours: Cyclone does not know Fast DDS's servers). 5 % of the frames are lost, 5 % doubled, 10 % delayed
by up to 30 ms; hosts are cut off for 12 s; programs are killed and started again in random order. Then the network is well again, and
must come to rest: every station has every channel, good and new; whatever sample two stations both have is the same in both; every
command had one result, and no more writes reached the plant than there were commands; no bridge holds more descriptors or threads
than before.

What does not hold is a line that begins with FAIL, what cannot be tried here one that begins with SKIPPED; the last line is the counts.
"""

import argparse
import contextlib
import json
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [HERE, os.path.join(HERE, "..", "tools")]
from lossy_network import LossyNetwork, NotPermitted  # noqa: E402
from plant import Failure, wait_until  # noqa: E402

DOMAIN = 7  # networks of their own: any will do
SOON = 60
PARTITION = 12  # seconds
NEW = 5  # seconds within which each channel must have come at the end
COMMAND_CODES = {0: "done", 3: "no bridge", 5: "rejected", 6: "failed", 7: "expired", 8: "no result"}

BUS = """  - name: {bus}
    port: {{ tcp: "{plant}:{port}" }}
    protocol: modbus-tcp
    defaults: {{ refresh: 300ms, timeout: 1s }}
    devices:
      - name: unit
        address: 1
        channels:
          - {{ name: setpoint, at: "holding:200", type: uint16, access: read-write }}
{channels}"""
CHANNELS = "".join(f"          - {{ name: c{i}, at: \"holding:{2 * i}\", type: uint16 }}\n" for i in range(12))
PORTS = {"north": 1502, "south": 1503}
WANTED = {f"{bus}/unit/{name}" for bus in PORTS for name in ["setpoint"] + [f"c{i}" for i in range(12)]}
BRIDGES = {"bridge-1": "north", "bridge-2": "south", "bridge-3": "north"}
options = None


class Station:
    """A program that prints samples; the latest of each channel are kept."""

    KEPT = 400

    def __init__(self, network, host, command, parse, environment=None):
        self.network, self.host, self.command, self.parse = network, host, command, parse
        self.environment, self.lock, self.latest, self.kept = environment, threading.Lock(), {}, {}
        self.start()

    def start(self):
        self.process = self.network.run(self.host, self.command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True, env=self.environment)
        threading.Thread(target=self.read, args=(self.process,), daemon=True).start()

    def read(self, process):
        for text in process.stdout:
            sample = self.parse(text)
            if sample is None:
                continue
            channel, sequence, acquired, value, quality = sample
            with self.lock:
                self.latest[channel] = (time.monotonic(), quality)
                kept = self.kept.setdefault(channel, {})
                kept[(sequence, acquired)] = (value, quality)
                if len(kept) > self.KEPT:
                    kept.pop(next(iter(kept)))

    def fresh(self):
        now = time.monotonic()
        with self.lock:
            return {channel for channel, (at, quality) in self.latest.items() if quality == "GOOD" and now - at < NEW}

    def samples(self):
        with self.lock:
            return {channel: dict(kept) for channel, kept in self.kept.items()}

    def forget(self):
        with self.lock:
            self.latest.clear()
            self.kept.clear()


def ours(text):
    try:
        sample = json.loads(text)
        return ("/".join((sample["bus"], sample["device"], sample["channel"])), int(sample["sequence"]), int(sample["acquired_at"]),
                float(sample["value"]), sample["quality"])
    except (ValueError, KeyError, TypeError):
        return None


def cyclones(text):
    word, *fields = text.rstrip("\n").split("\t")
    if word != "sample" or len(fields) != 8:
        return None
    return "/".join(fields[:3]), int(fields[7]), int(fields[6]), float(fields[4]), fields[5]


class Campaign:
    def __init__(self, scenario, seed):
        self.server = scenario == "discovery-server"
        self.random = random.Random(seed)
        self.counts = {"restarts": 0, "partitions": 0, "commands": {}, "samples_compared": 0}
        self.hosts = ["plant", "server", *BRIDGES, "station-1", "station-2", "station-3"]
        self.programs = {}

    def run(self, scenario, seconds, seed):
        self.folder = tempfile.mkdtemp(prefix="fieldcast-network-")
        try:
            with LossyNetwork(self.hosts, seed) as self.network:
                self.start_all()
                self.wait_for_rest()
                before = {name: self.used(name) for name in BRIDGES}
                if scenario == "partition":
                    self.network.cut(["station-1"])
                    time.sleep(PARTITION)
                    self.network.mend()
                else:
                    self.trouble(time.monotonic() + seconds)
                self.wait_for_rest()
                self.compare()
                self.check_commands()
                self.check_used(before)
                self.counts.update({"frames_" + name: count for name, count in self.network.counts.items()})
        except Failure:
            for name in [*BRIDGES, "plant"]:
                with contextlib.suppress(OSError), open(self.path(name + ".log"), encoding="utf-8", errors="replace") as file:
                    print(f"--- {name}\n" + "".join(file.readlines()[-15:]), file=sys.stderr)
            raise
        finally:
            shutil.rmtree(self.folder, ignore_errors=True)
        return self.counts

    def path(self, name):
        return os.path.join(self.folder, name)

    def configuration(self, host, buses):
        """The file of one host; of a station that of all buses."""
        server = f", discovery-server: \"{self.network.address('server')}:11811\"" if self.server else ""
        text = (f"bridge: {host}\ndds: {{ domain: {DOMAIN}, interfaces: [{self.network.address(host)}], security: none{server} }}\nbuses:\n"
                + "".join(BUS.format(bus=bus, plant=self.network.address("plant"), port=PORTS[bus], channels=CHANNELS) for bus in buses))
        with open(self.path(host + ".yaml"), "w", encoding="utf-8") as file:
            file.write(text)
        return self.path(host + ".yaml")

    def program(self, name):
        return os.path.join(options.bin, name)

    def start(self, host, command):
        with open(self.path(host + ".log"), "a", encoding="utf-8") as log:
            self.programs[host] = self.network.run(host, command, stdout=log, stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL)

    def start_plant(self):
        self.start("plant", [self.program("fieldcast-sim"), "--report", self.path("report.json"), self.configuration("plant", PORTS)])
        for port in PORTS.values():  # the simulator listens on its own machine
            self.network.run("plant", ["socat", f"TCP-LISTEN:{port},bind={self.network.address('plant')},reuseaddr,fork", f"TCP:127.0.0.1:{port}"])

    def start_bridge(self, host):
        self.start(host, [self.program("fieldcast-bridge"), self.configuration(host, [BRIDGES[host]])])

    def start_server(self):
        self.start("server", ["fast-discovery-server", "-i", "0", "-l", self.network.address("server"), "-p", "11811"])

    def start_all(self):
        self.start_plant()
        if self.server:
            self.start_server()
        for host in BRIDGES:
            self.start_bridge(host)
        self.stations = []
        for host in ("station-1", "station-2", "station-3"):
            if host == "station-3" and not self.server:
                uri = (f'<CycloneDDS><Domain><General><Interfaces><NetworkInterface address="{self.network.address(host)}"/>'
                       "</Interfaces></General></Domain></CycloneDDS>")
                self.stations.append(Station(self.network, host, [self.program("cyclone-watch"), str(DOMAIN)], cyclones,
                                             {**os.environ, "CYCLONEDDS_URI": uri}))
            else:
                self.stations.append(Station(self.network, host, [self.program("fieldcast"), "watch", "--json", "--config",
                                                                  self.configuration(host, PORTS)], ours))

    def wait_for_rest(self):
        def lacking():
            return {station.host: sorted(WANTED - station.fresh()) for station in self.stations if not WANTED <= station.fresh()}
        wait_until(lambda: not lacking(), SOON, lambda: f"values are lacking: {str(lacking())[:600]}")

    def used(self, host):
        """Descriptors and threads of a bridge: below `ip netns exec`, which becomes it."""
        pid = self.programs[host].pid
        return len(os.listdir(f"/proc/{pid}/fd")), len(os.listdir(f"/proc/{pid}/task"))

    def trouble(self, end):
        self.network.loss, self.network.doubled, self.network.delayed = 0.05, 0.05, 0.10
        commander = threading.Thread(target=self.command_until, args=(end,))
        commander.start()
        try:
            while time.monotonic() < end:
                if self.random.random() < 0.3:
                    self.counts["partitions"] += 1
                    cut = self.random.sample(self.hosts, self.random.randrange(1, 4))
                    self.note(f"cut off: {', '.join(cut)}")
                    self.network.cut(cut)
                    time.sleep(min(PARTITION, max(0.0, end - time.monotonic())))
                    self.network.mend()
                else:
                    self.restart(self.random.choice([*BRIDGES, *BRIDGES, "station-1", "station-2", "station-3"] + ["server"] * self.server))
                    time.sleep(self.random.uniform(0.5, 4))
        finally:
            self.network.mend()
            self.network.loss = self.network.doubled = self.network.delayed = 0.0
            commander.join()

    def note(self, text):
        print(f"{time.strftime('%T')} {text}", file=sys.stderr, flush=True)

    def restart(self, host):
        self.counts["restarts"] += 1
        self.note(f"restart of {host}")
        station = next((each for each in self.stations if each.host == host), None)
        process = station.process if station else self.programs[host]
        process.send_signal(self.random.choice([signal.SIGKILL, signal.SIGTERM]))
        with contextlib.suppress(subprocess.TimeoutExpired):
            process.wait(12)
        if process.poll() is None:
            raise Failure(f"{host} does not end within 12 s of SIGTERM")
        if station:
            station.start()
        elif host == "server":
            self.start_server()
        else:
            self.start_bridge(host)

    def command_until(self, end):
        """Writes one after the other; each ends with one exit code."""
        configuration = self.configuration("station-1", PORTS)
        value = 0
        while time.monotonic() < end:
            value += 1
            bus = self.random.choice(sorted(PORTS))
            process = self.network.run("station-1", [self.program("fieldcast"), "write", f"{bus}/unit/setpoint={value}", "--timeout", "4",
                                                     "--json", "--config", configuration], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
            out, _ = process.communicate(timeout=SOON)
            code = COMMAND_CODES.get(process.returncode, f"exit code {process.returncode}")
            self.counts["commands"][code] = self.counts["commands"].get(code, 0) + 1
            results = [text for text in out.splitlines() if text.startswith("{")]
            if len(results) > 1:
                self.counts["commands"]["twice"] = self.counts["commands"].get("twice", 0) + 1

    def check_commands(self):
        commands = self.counts["commands"]
        strange = set(commands) - set(COMMAND_CODES.values())
        if strange:
            raise Failure(f"commands ended as {commands}")
        # Without faults a command is done.
        done = self.network.run("station-1", [self.program("fieldcast"), "write", "north/unit/setpoint=1", "south/unit/setpoint=1", "--config",
                                              self.path("station-1.yaml")], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        out, _ = done.communicate(timeout=SOON)
        if done.returncode != 0:
            raise Failure(f"a command in a network that is well: exit code {done.returncode}: {out}")
        self.programs["plant"].send_signal(signal.SIGUSR1)
        report = self.path("report.json")
        wait_until(lambda: os.path.exists(report) and os.path.getsize(report) > 0, 10, "no report of the plant")
        time.sleep(0.2)  # it is written at once, but not in one step
        with open(report, encoding="utf-8") as file:
            writes = sum_of(json.load(file), "write_requests")
        sent = sum(commands.values()) + 2
        least = commands.get("done", 0) + 2
        if not least <= writes <= sent:
            raise Failure(f"{writes} writes reached the plant: {sent} commands, of which {least} were done")
        self.counts["writes"] = writes

    def compare(self):
        """What two stations both have is the same in both."""
        for station in self.stations:
            station.forget()
        time.sleep(NEW)
        first, *others = [station.samples() for station in self.stations]
        for channel in WANTED:
            for number, other in enumerate(others):
                both = set(first.get(channel, {})) & set(other.get(channel, {}))
                if not both:
                    raise Failure(f"{channel}: no sample is common to stations 1 and {number + 2}")
                for key in both:
                    if first[channel][key] != other[channel][key]:
                        raise Failure(f"{channel} {key}: station 1 has {first[channel][key]}, station {number + 2} {other[channel][key]}")
                self.counts["samples_compared"] += len(both)

    def check_used(self, before):
        for host in BRIDGES:
            descriptors, threads = self.used(host)
            if descriptors > before[host][0] + 12 or threads > before[host][1] + 4:
                raise Failure(f"{host} had {before[host]} descriptors and threads, now {descriptors} and {threads}")


def sum_of(tree, name):
    if isinstance(tree, dict):
        return sum(value if key == name else sum_of(value, name) for key, value in tree.items())
    return sum(sum_of(each, name) for each in tree) if isinstance(tree, list) else 0


def parse():
    parser = argparse.ArgumentParser()
    parser.add_argument("--bin", required=True)
    parser.add_argument("--seconds", type=float, default=60)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--scenario", action="append", choices=["multicast", "discovery-server", "partition"])
    return parser.parse_args()


def main():
    global options
    options = parse()
    options.bin = os.path.abspath(options.bin)
    scenarios = options.scenario or ["multicast", "discovery-server"]
    counts, failed = {}, False
    try:
        for scenario in scenarios:
            if scenario == "discovery-server" and not shutil.which("fast-discovery-server"):
                print("SKIPPED discovery-server: fast-discovery-server is not installed (Debian: fastdds-tools)", flush=True)
                continue
            print(scenario, file=sys.stderr, flush=True)
            try:
                counts[scenario] = Campaign(scenario, options.seed).run(scenario, options.seconds / len(scenarios), options.seed)
            except NotPermitted as reason:
                print(f"SKIPPED {scenario}: networks cannot be made here: {reason}", flush=True)
            except (Failure, subprocess.TimeoutExpired, OSError) as failure:
                failed = True
                print(f"FAIL {scenario}, seed {options.seed}: {str(failure)[:700]}", flush=True)
    except KeyboardInterrupt:
        pass
    print(json.dumps(counts))
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
