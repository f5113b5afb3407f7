#!/usr/bin/env python3
"""Measures a fieldcast-station that reads many sites from a stream: the time until it shows all channels, processor, memory, and age of values.

usage: tools/bench/centre_bench.py BIN_DIR [--sites 1000] [--devices 4] [--channels 50] [--seconds 30] [--record] [--round-trip MS]

bench_sites publishes the messages of all forwarders: each device sends a message with a new value of each of its --channels once a second. The
server is nats-server with file storage on 127.0.0.1. The station starts when samples of all devices are in the stream. The age of a value is the
time from its acquisition to a response of the station, of one channel of a site, read every 50 ms: at least until the next message of the
device arrives it grows, so the smallest age of a second is the delay. --record: the station keeps all samples.
--round-trip: of the line between server and station, in milliseconds.
"""

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "tests", "tools"))
import e2e_station  # noqa: E402
from delayed_line import DelayedLine  # noqa: E402
from e2e_station import Browser, Station  # noqa: E402
from forward_sites import memory_of  # noqa: E402
from nats import NatsServer  # noqa: E402
from plant import Failure, claim_domain, wait_until  # noqa: E402

TICKS = os.sysconf("SC_CLK_TCK")
JOIN_SECONDS = 300


def run_seconds(process):
    with open(f"/proc/{process.pid}/stat", encoding="ascii") as file:
        fields = file.read().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / TICKS


def metric(browser, name):
    for line in browser.ask("GET", "/metrics")[1].splitlines():
        if line.startswith(name + " "):
            return float(line.split()[1])
    raise Failure(f"{name} is missing in the metrics")


class Folder:
    def __init__(self, run):
        self.run = run
        self.domain, self.claim = claim_domain()


def delays(browser, seconds):
    """The smallest age of a value in each second."""
    found, end = [], time.monotonic() + seconds
    while time.monotonic() < end:
        least, turn = float("inf"), time.monotonic() + 1
        while time.monotonic() < turn:
            channel = json.loads(browser.ask("GET", "/api/channels?pattern=site-7:line/unit-1/channel-3")[1])[0]
            least = min(least, time.time() * 1000 - channel["acquired_ms"])
            time.sleep(0.05)
        found.append(least)
    return sorted(found)


def measure(options, folder, server, sites, port):
    more = f"store: {{ path: {folder.run}/centre.db }}\nrecord: {{}}\n" if options.record else ""
    total = options.sites * options.devices * options.channels
    text = f"stream: {{ servers: [nats://127.0.0.1:{port}] }}\nweb: {{ local-role: viewer }}\n{more}"
    begin = time.monotonic()
    with Station(folder, "centre", text, "--listen", "127.0.0.1:0") as station:
        browser = Browser(station)
        wait_until(lambda: metric(browser, "fieldcast_station_channels") >= total, JOIN_SECONDS, station.log)
        print(f"{total} channels of {options.sites} sites: all known {time.monotonic() - begin:.1f} s after the start of the station, "
              f"{run_seconds(station.process):.1f} s of processor, {memory_of(station.process) / 1e6:.0f} MB")
        time.sleep(5)
        samples, used, server_used, start = (metric(browser, "fieldcast_station_samples_total"), run_seconds(station.process),
                                             run_seconds(server.process), time.monotonic())
        ages = delays(browser, options.seconds)
        taken = time.monotonic() - start
        rate = (metric(browser, "fieldcast_station_samples_total") - samples) / taken
        print(f"{rate:.0f} samples a second: station {(run_seconds(station.process) - used) / taken:.2f} cores, "
              f"{1000 * (run_seconds(station.process) - used) / taken / max(rate, 1):.4f} s for 1 000 samples, "
              f"{memory_of(station.process) / 1e6:.0f} MB; nats-server {(run_seconds(server.process) - server_used) / taken:.2f} cores; "
              f"delay of a value: median {ages[len(ages) // 2]:.0f} ms, longest {ages[-1]:.0f} ms")
        if sites.poll() is not None:
            raise Failure("the messages ended before the measurement")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("bin")
    for name, default in [("sites", 1000), ("devices", 4), ("channels", 50), ("seconds", 30)]:
        parser.add_argument("--" + name, type=int, default=default)
    parser.add_argument("--record", action="store_true")
    parser.add_argument("--round-trip", type=float, default=0)
    options = parser.parse_args()
    e2e_station.BIN_DIR = options.bin
    with tempfile.TemporaryDirectory(prefix="fieldcast-centre-") as run:
        folder = Folder(run)
        server = NatsServer(run).start()
        arguments = [str(number) for number in (options.sites, options.devices, options.channels, options.seconds + JOIN_SECONDS)]
        sites = subprocess.Popen([os.path.join(options.bin, "bench_sites"), f"nats://127.0.0.1:{server.port}", *arguments],
                                 stdout=subprocess.PIPE, text=True)
        try:
            if sites.stdout.readline() != "catalogues\n":
                raise Failure("bench_sites ended")
            time.sleep(3)
            line = DelayedLine(server.port, options.round_trip / 1000) if options.round_trip else None
            measure(options, folder, server, sites, line.port if line else server.port)
        finally:
            sites.kill()
            sites.wait()
            server.kill()
            folder.claim.close()


if __name__ == "__main__":
    main()
