"""Runs bridges and stations on separate hosts, on a faulty and partitioned network, while all programs restart.

usage: network_campaign.py --bin DIR [--seconds S] [--seed N] [--scenario NAME]..

Scenarios: multicast, discovery-server, discovery-servers (two), and two without other faults. partition: a station is cut off for 12 s.
given-up: a bridge behind a discovery server is cut off, and stations are killed before and meanwhile. They never acknowledge results, nor
that the server has removed the bridge. A station that keeps running must get results again.

The hosts are two bridges with a bus each, a third bridge that waits for the bus of the first, a standby pair with a third bus, and a
plant behind the network. There are two stations of ours and one on Cyclone DDS. With discovery servers the third station is ours too,
because Cyclone does not support those of Fast DDS. 5 % of the frames are lost, 5 % doubled, 10 % delayed by up to 30 ms. Hosts are cut
off for 12 s; programs are killed and restarted in random order. Then the network is healthy again, and these checks must pass:
- every station has every channel, good and new;
- a sample that two stations have is the same in both, and sequences increase;
- every command had one result;
- no more writes reached the plant than there were commands, except commands sent while the pair was partitioned;
- the pair has one master, and the second member is ready;
- no bridge has more descriptors or threads than before.

Each failure is printed as a line that begins with FAIL, each scenario that cannot run here as SKIPPED; the last line is the counts.
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
from plant import Failure, report, wait_until  # noqa: E402
from watching_station import NEW, Station, cyclones, ours  # noqa: E402

DOMAIN = 7  # separate networks: any domain works
SOON = 60
PARTITION = 12  # seconds
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
PORTS = {"north": 1502, "south": 1503, "east": 1504}
WANTED = {f"{bus}/unit/{name}" for bus in PORTS for name in ["setpoint"] + [f"c{i}" for i in range(12)]}
PAIR = ("pair-1", "pair-2")  # a standby group
BRIDGES = {"bridge-1": "north", "bridge-2": "south", "bridge-3": "north", "pair-1": "east", "pair-2": "east"}
SERVERS = {"discovery-server": ["server-1"], "discovery-servers": ["server-1", "server-2"], "given-up": ["server-1"]}
SCENARIOS = ["multicast", "discovery-server", "discovery-servers"]
options = None


class Campaign:
    def __init__(self, scenario, seed):
        self.servers = SERVERS.get(scenario, [])
        self.random = random.Random(seed)
        self.counts = {"restarts": 0, "partitions": 0, "commands": {}, "sent_while_divided": 0, "samples_compared": 0}
        self.divided = False  # the pair was partitioned after the last command
        self.hosts = ["plant", *self.servers, *BRIDGES, "station-1", "station-2", "station-3"]
        self.programs = {}
        self.over = threading.Event()  # no more commands

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
                elif scenario == "given-up":
                    self.give_up()
                else:
                    self.trouble(time.monotonic() + seconds)
                self.wait_for_rest()
                self.check_pair()
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
        """Writes the configuration of one host; that of a station has all buses."""
        servers = [f'"{self.network.address(each)}:11811"' for each in self.servers]
        server = f", discovery-servers: [{', '.join(servers)}]" if servers else ""
        name = f"{{ name: {host}, standby: {{ group: pair, strength: {2 - PAIR.index(host)} }} }}" if host in PAIR else host
        text = (f"bridge: {name}\ndds: {{ domain: {DOMAIN}, interfaces: [{self.network.address(host)}], security: none{server} }}\nbuses:\n"
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
        for port in PORTS.values():  # the simulator listens only on its own host
            self.network.run("plant", ["socat", f"TCP-LISTEN:{port},bind={self.network.address('plant')},reuseaddr,fork", f"TCP:127.0.0.1:{port}"])

    def start_bridge(self, host):
        self.start(host, [self.program("fieldcast-bridge"), self.configuration(host, [BRIDGES[host]])])

    def start_server(self, host):
        self.start(host, ["fast-discovery-server", "-i", str(self.servers.index(host)), "-l", self.network.address(host), "-p", "11811"])

    def start_all(self):
        self.start_plant()
        for host in self.servers:
            self.start_server(host)
        for host in BRIDGES:
            self.start_bridge(host)
        self.stations = []
        for host in ("station-1", "station-2", "station-3"):
            if host == "station-3" and not self.servers:
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

    def give_up(self):
        living, killed = (WebStation(self, host) for host in ("station-1", "station-2"))
        living.wait_for_result("at first")
        killed.wait_for_result("at first")
        killed.process.kill()
        living.wait_for_result("after another station was killed")
        self.network.cut(["bridge-2"])
        time.sleep(PARTITION - 7)
        self.stations[1].process.kill()
        time.sleep(7)
        self.network.mend()
        self.stations[1].process.wait()
        self.stations[1].start()
        living.wait_for_result("from a bridge that returned")
        self.counts["sent_to_stations"] = living.sent + killed.sent
        living.process.kill()

    def used(self, host):
        """Returns descriptors and threads of a bridge; `ip netns exec` replaces itself by the bridge."""
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
                    divides = len(set(cut) & set(PAIR)) == 1
                    self.divided |= divides
                    self.network.cut(cut)
                    time.sleep(min(PARTITION, max(0.0, end - time.monotonic())))
                    self.network.mend()
                    if divides:
                        time.sleep(1)  # until one member has stepped back
                        self.divided = False
                else:
                    self.restart(self.random.choice([*BRIDGES, *BRIDGES, "station-1", "station-2", "station-3", *self.servers]))
                    time.sleep(self.random.uniform(0.5, 4))
        finally:
            self.network.mend()
            self.network.loss = self.network.doubled = self.network.delayed = 0.0
            if sys.exc_info()[0]:  # also after Ctrl-C
                self.over.set()
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
        elif host in self.servers:
            self.start_server(host)
        else:
            self.start_bridge(host)

    def command_until(self, end):
        """Sends writes one after the other; each must end with a known exit code."""
        configuration = self.configuration("station-1", PORTS)
        value = 0
        while time.monotonic() < end and not self.over.is_set():
            value += 1
            bus = self.random.choice(sorted(PORTS))
            divided = self.divided
            process = self.network.run("station-1", [self.program("fieldcast"), "write", f"{bus}/unit/setpoint={value}", "--timeout", "4",
                                                     "--json", "--config", configuration], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
            out, _ = process.communicate(timeout=SOON)
            self.counts["sent_while_divided"] += bus == "east" and (divided or self.divided)
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
        # Without faults a command succeeds.
        done = self.network.run("station-1", [self.program("fieldcast"), "write", *[f"{bus}/unit/setpoint=1" for bus in PORTS], "--config",
                                              self.path("station-1.yaml")], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        out, _ = done.communicate(timeout=SOON)
        if done.returncode != 0:
            raise Failure(f"a command in a network that is well: exit code {done.returncode}: {out}")
        self.programs["plant"].send_signal(signal.SIGUSR1)
        report = self.path("report.json")
        wait_until(lambda: os.path.exists(report) and os.path.getsize(report) > 0, 10, "no report of the plant")
        time.sleep(0.2)  # the file is not written in one step
        with open(report, encoding="utf-8") as file:
            writes = sum_of(json.load(file), "write_requests")
        sent = sum(commands.values()) + len(PORTS)
        least = commands.get("done", 0) + len(PORTS)
        # Two masters without contact may both run a command that reaches both (docs/redundancy.md).
        if not least <= writes <= sent + self.counts["sent_while_divided"] + self.counts.get("sent_to_stations", 0):
            raise Failure(f"{writes} writes reached the plant: {sent} commands, of which {least} were done")
        self.counts["writes"] = writes

    def members(self):
        """Returns the reports of the pair's members, as one station receives them."""
        process = self.network.run("station-1", [self.program("fieldcast"), "standby", "--json", "--config", self.path("station-1.yaml")],
                                   stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        out, _ = process.communicate(timeout=SOON)
        return [json.loads(text) for text in out.splitlines() if text.startswith("{")]

    def check_pair(self):
        """Checks that one member is master and that the second could take over."""
        def is_whole():
            self.seen = self.members()
            roles = sorted(member["role"] for member in self.seen)
            return roles == ["master", "waiting"] and not any(member["not_ready"] for member in self.seen)
        wait_until(is_whole, SOON, lambda: f"the pair is not whole: {self.seen}")

    def compare(self):
        """Checks that samples that two stations have are the same in both."""
        for station in self.stations:
            station.forget()
        time.sleep(NEW)
        for station in self.stations:
            # A station that reads samples one by one may receive both members of a pair for a moment: docs/redundancy.md.
            fell_back = [text for text in station.fell_back if station.parse is ours or not text.startswith(BRIDGES[PAIR[0]] + "/")]
            if fell_back:
                raise Failure(f"{station.host}: {fell_back[0]}")
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
            # A master has more of both than a waiting member, and the master may have changed.
            had = max(before[each] for each in (PAIR if host in PAIR else [host]))
            if descriptors > had[0] + 12 or threads > had[1] + 4:
                raise Failure(f"{host} had {had} descriptors and threads, now {descriptors} and {threads}")


class WebStation:
    """A fieldcast-station process of the test."""

    ADDRESS = "127.0.0.1:8090"  # on its own host

    def __init__(self, campaign, host):
        self.network, self.host, self.sent = campaign.network, host, 0
        servers = ", ".join(f'"{self.network.address(each)}:11811"' for each in campaign.servers)
        with open(campaign.path(host + "-web.yaml"), "w", encoding="utf-8") as file:
            file.write(f"station: {host}-web\nweb: {{ listen: {self.ADDRESS}, local-role: operator }}\n"
                       f"dds: {{ domain: {DOMAIN}, interfaces: [{self.network.address(host)}], security: none, discovery-servers: [{servers}] }}\n")
        self.process = self.network.run(host, [campaign.program("fieldcast-station"), "--config", file.name], stdin=subprocess.DEVNULL,
                                        stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)

    def get(self, path, *options):
        process = self.network.run(self.host, ["curl", "-sS", "-m", "5", "-H", f"Origin: http://{self.ADDRESS}", *options, f"http://{self.ADDRESS}{path}"],
                                   stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        out, _ = process.communicate(timeout=SOON)
        return json.loads(out) if out.startswith("{") else {}

    def wait_for_result(self, when):
        wait_until(self.has_result, SOON, f"{self.host}, which lives on, gets no result {when}")

    def has_result(self):
        """Returns True if a write is done within 5 s."""
        asked = self.get("/api/commands", "-H", "Content-Type: application/json", "-d", '{"channel": "south/unit/setpoint", "value": 7}')
        if "request_id" not in asked:
            return False
        self.sent += 1
        end = time.monotonic() + 5
        while time.monotonic() < end:
            if self.get(f"/api/commands/result?request_id={asked['request_id']}").get("state", "").lower() == "done":
                return True
            time.sleep(0.2)
        return False


def sum_of(tree, name):
    if isinstance(tree, dict):
        return sum(value if key == name else sum_of(value, name) for key, value in tree.items())
    return sum(sum_of(each, name) for each in tree) if isinstance(tree, list) else 0


def parse():
    parser = argparse.ArgumentParser()
    parser.add_argument("--bin", required=True)
    parser.add_argument("--seconds", type=float, default=60)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--scenario", action="append", choices=["multicast", *SERVERS, "partition"])
    return parser.parse_args()


def main():
    global options
    options = parse()
    options.bin = os.path.abspath(options.bin)
    scenarios = options.scenario or SCENARIOS
    counts, failed = {}, False
    try:
        for scenario in scenarios:
            if scenario in SERVERS and not shutil.which("fast-discovery-server"):
                print(f"SKIPPED {scenario}: fast-discovery-server is not installed (Debian: fastdds-tools)", flush=True)
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
    return report(counts, failed)


if __name__ == "__main__":
    sys.exit(main())
