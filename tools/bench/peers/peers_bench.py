#!/usr/bin/env python3
"""Compares the processor time of the bridge with that of a peer, mqmgateway with mosquitto, on the same simulated serial lines.

usage: tools/bench/peers/peers_bench.py BIN_DIR PEERS [--pairs 4] [--seconds 20] [--lines 16] [--registers 300] [--block 10]
                                        [--silence 3.5c] [--before PROGRAM] [--without-peer]

PEERS is the folder of get.sh. Each pair runs the bridge and the peer one after the other, in alternating order. Both read the same registers
in the same blocks as fast as the line of 19 200 baud allows, and publish each value after each read; a subscriber in another process counts
the values that arrive. The figure is the processor time of the bridge, and of the peer with its broker, for 1 000 such values. The requests
for 1 000 values show that both read the same blocks. --before measures a second program of the bridge in each pair, for example one without
a change. Needs bench_station in BIN_DIR. Exit code 77: the peer is missing.
"""

import argparse
import json
import os
import statistics
import subprocess
import sys
import tempfile
import time

sys.path.append(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "..", "tests", "tools"))
from mosquitto import PROGRAMS, Broker, reason_to_skip  # noqa: E402
from nats import free_port  # noqa: E402
from peers_plant import bridge_config, peer_config, scattered  # noqa: E402
from plant import claim_domain, wait_until  # noqa: E402

SETTLE_S = 15  # the bridge measures its devices first
START_S = 20


class Program:
    def __init__(self, folder, name, words):
        self.path = os.path.join(folder, name + ".log")
        with open(self.path, "wb") as log:
            self.process = subprocess.Popen(["setpriv", "--pdeathsig", "TERM", "--", *words], stdin=subprocess.DEVNULL, stdout=log,
                                            stderr=subprocess.STDOUT)

    def tail(self):
        with open(self.path, "rb") as file:
            file.seek(max(0, os.path.getsize(self.path) - 300))
            return file.read().decode(errors="replace")

    def stop(self):
        self.process.terminate()
        self.process.wait(20)


def cpu_seconds(processes):
    ticks = 0
    for process in processes:
        with open(f"/proc/{process.pid}/stat", encoding="ascii") as file:
            fields = file.read().rpartition(")")[2].split()
        ticks += int(fields[11]) + int(fields[12])
    return ticks / os.sysconf("SC_CLK_TCK")


class Plant:
    """The simulated lines, for one run of one program."""

    def __init__(self, options, folder):
        self.options, self.folder, self.report = options, folder, os.path.join(folder, "report.json")
        self.domain, self.claim = claim_domain()
        self.units = scattered(options.registers, options.block)
        self.config = self.file("bridge.yaml", bridge_config(folder, options.lines, self.units, options.silence, self.domain))
        self.programs = [self.start("sim", options.bin_dir + "/fieldcast-sim", self.config, "--report", self.report)]
        wait_until(lambda: "READY" in self.programs[0].tail(), START_S, self.programs[0].tail)

    def file(self, name, text):
        path = os.path.join(self.folder, name)
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)
        return path

    def start(self, name, *words):
        return Program(self.folder, name, words)

    def bridge(self, program):
        """(measured processes, function that returns the samples that have arrived)"""
        station = self.start("station", self.options.bin_dir + "/bench_station", str(self.domain), "by-blocks")
        bridge = self.start("bridge", program, self.config)
        self.programs += [station, bridge]
        return [bridge.process], lambda: int(station.tail().split("\n")[-2].split()[0])

    def peer(self):
        port = free_port()
        broker = Broker(self.folder, port)
        broker.text = broker.text.replace("log_type all", "log_type error")
        broker.set_limit(None)
        broker.start()
        subscriber = self.start("subscriber", PROGRAMS["mosquitto_sub"], "-h", "127.0.0.1", "-p", str(port), "-t", "#", "-F", "x")
        gateway = self.start("peer", self.options.peers + "/build/modmqttd/modmqttd",
                             "--config=" + self.file("peer.yaml", peer_config(self.folder, self.options.lines, self.units, port)))
        self.programs += [subscriber, gateway, broker]
        return [gateway.process, broker.process], lambda: os.path.getsize(subscriber.path) // len("x\n")

    def stop(self):
        for program in reversed(self.programs):
            program.kill() if isinstance(program, Broker) else program.stop()
        self.claim.close()
        with open(self.report, encoding="utf-8") as file:
            return sum(device["requests"] for bus in json.load(file)["buses"] for device in bus["devices"])


def measure(options, who):
    """{"cost": processor seconds for 1 000 samples, "samples": of a second, "all": of the whole run, "requests": of the whole run}"""
    with tempfile.TemporaryDirectory(prefix="fieldcast-peers-") as folder:
        plant = Plant(options, folder)
        processes, arrived = plant.peer() if who == "peer" else plant.bridge(who)
        time.sleep(SETTLE_S)
        begun, before, samples = time.monotonic(), cpu_seconds(processes), arrived()
        time.sleep(options.seconds)
        spent, samples = cpu_seconds(processes) - before, arrived() - samples
        seconds, everything = time.monotonic() - begun, arrived()
        requests = plant.stop()
    return {"cost": 1000 * spent / samples, "samples": samples / seconds, "requests": 1000 * requests / everything}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("bin_dir")
    parser.add_argument("peers")
    parser.add_argument("--pairs", type=int, default=4)
    parser.add_argument("--seconds", type=float, default=20)
    parser.add_argument("--lines", type=int, default=16)
    parser.add_argument("--registers", type=int, default=300)
    parser.add_argument("--block", type=int, default=10, help="mean registers of a request")
    parser.add_argument("--silence", default="3.5c")
    parser.add_argument("--before")
    parser.add_argument("--without-peer", action="store_true")
    options = parser.parse_args()
    programs = {"bridge": options.bin_dir + "/fieldcast-bridge"}
    if options.before:
        programs["before"] = options.before
    if not options.without_peer:
        missing = reason_to_skip() or (None if os.path.exists(options.peers + "/build/modmqttd/modmqttd") else
                                       f"no mqmgateway in {options.peers}: tools/bench/peers/get.sh {options.peers}")
        if missing:
            print("skipped:", missing)
            sys.exit(77)
        programs["peer"] = "peer"
    names, rows = list(programs), []
    for number in range(options.pairs):
        row = {name: measure(options, programs[name]) for name in (names if number % 2 == 0 else reversed(names))}
        rows.append(row)
        print(f"{number + 1}: " + "; ".join(
            f"{name} {row[name]['cost']:.5f} s for 1 000 samples, {row[name]['samples']:.0f} samples a second, "
            f"{row[name]['requests']:.1f} requests for 1 000" for name in names), flush=True)
    for other in names[1:]:
        for what in ("cost", "samples"):
            ratios = [row["bridge"][what] / row[other][what] for row in rows]
            print(f"{what} of the bridge / {other}: median {statistics.median(ratios):.3f}, {min(ratios):.3f} to {max(ratios):.3f}")


if __name__ == "__main__":
    main()
