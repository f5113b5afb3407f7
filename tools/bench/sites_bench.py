#!/usr/bin/env python3
"""Measures the cost of a joining station: simulator and bridge on one machine, the station on a second one, a wire between them.

usage: tools/bench/sites_bench.py BIN_DIR [--buses 1,8,32,64] [--server] [--max-rate 2MB/s] [--tcp] [--seconds 30]

Each bus has 1 000 channels with a refresh of 10 s. Prints a line for each number of buses: seconds until the station has a value of
every channel, bytes on the wire in this time and their maximum within a second, memory of both programs, bytes a second afterwards.
--server: uses a discovery server instead of multicast; --tcp: uses one TCP connection. Needs root to create networks.
"""

import argparse
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "tests", "tools"))
import networks  # noqa: E402
from progress import Progress, wait  # noqa: E402

CHANNELS = 1000  # of each bus
PORT = 5100


def memory(pid):
    """Returns the resident memory of the process in MB."""
    with open(f"/proc/{pid}/status", encoding="utf-8") as file:
        return int(re.search(r"VmRSS:\s+(\d+)", file.read()).group(1)) / 1024


def processor_seconds(pid):
    with open(f"/proc/{pid}/stat", encoding="utf-8") as file:
        fields = file.read().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


class Rates:
    """Samples the bytes sent at this end of a wire every 50 ms."""

    def __init__(self, wire):
        self.wire, self.seen, self.stopped = wire, [], False
        self.thread = threading.Thread(target=self._look, daemon=True)
        self.thread.start()

    def _look(self):
        while not self.stopped:
            self.seen.append((time.monotonic(), self.wire.bytes()[0]))
            time.sleep(0.05)

    def stop(self):
        self.stopped = True
        self.thread.join()

    def most(self, seconds):
        """Returns bytes a second in the busiest span of this length."""
        most, first = 0, 0
        for now, total in self.seen:
            while now - self.seen[first][0] > seconds:
                first += 1
            most = max(most, (total - self.seen[first][1]) / seconds)
        return most


class Station:
    """Runs `fieldcast watch --json` on the second machine and records the channels with a value."""

    def __init__(self, machine, bin_dir, file):
        self.channels = set()
        self.process = machine.start(os.path.join(bin_dir, "fieldcast"), "watch", "--json", "--config", file, stdout=subprocess.PIPE,
                                     stderr=subprocess.DEVNULL, text=True)
        threading.Thread(target=self._read, daemon=True).start()

    def _read(self):
        for text in self.process.stdout:
            sample = json.loads(text)
            self.channels.add((sample["bus"], sample["channel"]))


def write_files(folder, options, buses, wire):
    security = ", security: none"
    server = f", discovery-servers: ['{wire.near_address}:11811']" if options.server else ""
    rate = f", max-rate: {options.max_rate}" if options.max_rate else ""
    near, far = f"domain: 1, interfaces: [{wire.near_address}]", f"domain: 1, interfaces: [{wire.far_address}]"
    near_tcp = far_tcp = ""
    if options.tcp:
        near, far = "domain: 1", "domain: 1"
        near_tcp, far_tcp = f", tcp: {{ listen: {PORT} }}", f", tcp: {{ connect: ['{wire.near_address}:{PORT}'] }}"
    with open(f"{folder}/plant.yaml", "w", encoding="utf-8") as file:
        file.write(f"bridge: bench\ndds: {{ {near}{near_tcp}{server}{rate}{security} }}\nbuses:\n")
        for bus in range(buses):
            file.write(f"  - name: line-{bus}\n    port: {{ tcp: '127.0.0.1:{20000 + bus}' }}\n    protocol: modbus-tcp\n"
                       "    defaults: { refresh: 10s }\n    devices:\n      - name: device\n        address: 1\n        channels:\n")
            for i in range(CHANNELS):
                file.write(f"          - {{ name: channel-{i}, at: 'holding:{i}', type: uint16 }}\n")
    with open(f"{folder}/station.yaml", "w", encoding="utf-8") as file:
        file.write(f"station: bench\ndds: {{ {far}{far_tcp}{server}{security} }}\n")


def measure(options, buses, wire):
    folder = tempfile.mkdtemp(prefix="fieldcast-bench-")
    processes = []

    def start(name, *arguments, machine=networks.HERE):
        with open(f"{folder}/{os.path.basename(name)}.log", "w", encoding="utf-8") as log:
            processes.append(machine.start(name, *arguments, stdout=log, stderr=subprocess.STDOUT))
        return processes[-1]
    try:
        write_files(folder, options, buses, wire)
        if options.server:
            start("fast-discovery-server", "-i", "0", "-l", wire.near_address, "-p", "11811")
        start(f"{options.bin}/fieldcast-sim", f"{folder}/plant.yaml")
        bridge = start(f"{options.bin}/fieldcast-bridge", f"{folder}/plant.yaml")
        wait(f"{buses} buses: every channel is read", 15)
        alone = memory(bridge.pid)
        began, before, spent, rates = time.monotonic(), wire.bytes(), processor_seconds(bridge.pid), Rates(wire)
        station = Station(wire.far, options.bin, f"{folder}/station.yaml")
        processes.append(station.process)
        with Progress(f"{buses} buses: the station joins", options.seconds, buses * CHANNELS) as progress:
            while len(station.channels) < buses * CHANNELS and time.monotonic() - began < options.seconds:
                progress.show(len(station.channels))
                time.sleep(0.02)
        took, after = time.monotonic() - began, wire.bytes()
        spent = processor_seconds(bridge.pid) - spent
        missing = buses * CHANNELS - len(station.channels)
        wait("it falls quiet", 5)
        rates.stop()
        quiet = wire.bytes()
        wait("measuring", 10)
        steady = (wire.bytes()[0] - quiet[0]) / 10
        print(f"{buses:3} buses  {'every value after ' + format(took, '.2f') + ' s' if missing == 0 else str(missing) + ' values missing'}"
              f"  {(after[0] - before[0]) / 1e6:6.2f} MB to the station, {(after[1] - before[1]) / 1e6:5.2f} MB back"
              f"  at most {rates.most(1) / 1e6:5.2f} MB in 1 s, {rates.most(0.1) / 1e6:5.2f} MB/s in 0.1 s  bridge {alone:.0f} -> {memory(bridge.pid):.0f} MB"
              f" and {spent:.2f} s of processor  station {memory(station.process.pid):.0f} MB  then {steady / 1e3:.1f} kB/s", flush=True)
        return missing == 0
    finally:
        for process in reversed(processes):
            process.send_signal(signal.SIGTERM)
        for process in processes:
            try:
                process.wait(10)
            except subprocess.TimeoutExpired:
                process.kill()
        shutil.rmtree(folder)


def main():
    networks.enter()
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("bin")
    parser.add_argument("--buses", default="1,8,32,64")
    parser.add_argument("--server", action="store_true")
    parser.add_argument("--tcp", action="store_true")
    parser.add_argument("--max-rate", default="")
    parser.add_argument("--seconds", type=float, default=30)
    options = parser.parse_args()
    wire = networks.Wire("far")
    everything = [measure(options, int(buses), wire) for buses in options.buses.split(",")]
    sys.exit(0 if all(everything) else 1)


if __name__ == "__main__":
    main()
