#!/usr/bin/env python3
"""Measures fieldcast-forward: samples that a NATS server has acknowledged, processor time, and bytes on the connection.

usage: tools/bench/forward_bench.py BIN_DIR [--engine jetstream] [--buses 20] [--channels 1000] [--seconds 20] [--outage 0] [--payload "compress: zstd"]
                                    [--gather 1s] [--round-trip 0] [--rate 0]

bench_bridge publishes a 32-bit number of each channel once a second, without wires, in devices of 100 channels. The server is nats-server with file storage on
127.0.0.1. Bytes are those that TCP has sent (`ss`), with subjects, headers and message ids. With --outage, the server stops for this number of
seconds before the measurement, which then also contains the backlog. With --round-trip (ms) or --rate (kB/s), the connection is a line with this
delay and bandwidth, and the outage is a cut of the line. The delay of live samples is that from the youngest sample of a message to a
subscriber at the server; it contains the time for which a batch is gathered. --engine is a file of tests/tools/outlets, which also starts
the server of that engine.
"""

import argparse
import glob
import importlib
import os
import re
import signal
import subprocess
import sys
import tempfile
import threading
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "tests", "tools"))
import outlets  # noqa: E402
from delayed_line import DelayedLine  # noqa: E402
from nats import NatsClient, NatsServer, free_port  # noqa: E402
from plant import Failure, claim_domain, wait_until  # noqa: E402

TICKS = os.sysconf("SC_CLK_TCK")


def run_seconds(pid):
    with open(f"/proc/{pid}/stat", encoding="ascii") as file:
        fields = file.read().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / TICKS


def run_seconds_of_all(pid):
    """Of a server with its child processes."""
    total = run_seconds(pid)
    for path in glob.glob("/proc/[0-9]*/stat"):
        try:
            with open(path, encoding="ascii", errors="replace") as file:
                if int(file.read().rpartition(")")[2].split()[1]) == pid:
                    total += run_seconds(path.split("/")[2])
        except OSError:
            pass  # it has ended
    return total


class EngineServer:
    """The server of another engine than JetStream, as NatsServer."""

    def __init__(self, name, folder):
        outlets.UNPACKED = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "build", "unpacked")
        self.port = free_port()
        self.engine = importlib.import_module("outlets." + name).Engine(folder, self.port)
        self.kill = self.engine.stop

    def start(self):
        self.engine.start()
        return self

    @property
    def process(self):
        return self.engine.server.process

    def section(self):
        return self.engine.section()


def sent_bytes(port):
    """Bytes that the forwarder has sent on its present connection."""
    text = subprocess.run(["ss", "-tinH", "dst", f"127.0.0.1:{port}"], capture_output=True, text=True, check=True).stdout
    return sum(int(number) for number in re.findall(r"bytes_sent:(\d+)", text))


def varints(data):
    number = shift = 0
    for byte in data:
        number |= (byte & 127) << shift
        shift += 7
        if byte < 128:
            yield number
            number = shift = 0


def youngest(payload):
    """The last time of acquisition in a SampleBatch (field 7: the first time, then differences), in seconds."""
    at = 0
    while at < len(payload):
        field, kind = payload[at] >> 3, payload[at] & 7
        at += 1
        if kind == 1:
            at += 8
            continue
        length = shift = 0
        while True:
            byte = payload[at]
            at += 1
            length |= (byte & 127) << shift
            shift += 7
            if byte < 128:
                break
        if kind == 0:
            continue
        if field == 7:
            return sum((number >> 1) ^ -(number & 1) for number in varints(payload[at:at + length])) / 1e9
        at += length
    return None


class LiveDelay:
    """Receives the live messages at the server, on a thread of its own."""

    def __init__(self, port):
        self.delays, self.client = [], NatsClient(port, 3600)
        self.client.subscribe("fieldcast.>")
        threading.Thread(target=self._run, daemon=True).start()

    def _run(self):
        try:
            while True:
                at = youngest(self.client.receive().data)
                self.delays.append((at, time.time() - at))
        except (OSError, Failure, ValueError):
            pass

    def text(self, since):
        """Of samples that were acquired after `since`."""
        delays = sorted(delay for at, delay in list(self.delays) if at >= since)
        if not delays:
            return "no live message"
        return ", ".join(f"{name} {1000 * delays[min(len(delays) - 1, int(part * len(delays)))]:.0f} ms"
                         for name, part in [("p50", 0.5), ("p99", 0.99), ("most", 1.0)])


class Forwarder:
    def __init__(self, options, folder, domain, port, section=None):
        section = section or f"jetstream: {{ servers: [nats://127.0.0.1:{port}], streams: {{ create: true }} }}\n"
        self.log, self.port = os.path.join(folder, "forward.log"), port
        config = os.path.join(folder, "forward.yaml")
        with open(config, "w", encoding="utf-8") as file:
            file.write(f"site: north\ndds: {{ domain: {domain} }}\nqueue: {{ path: queue.db }}\ngather: {{ time: {options.gather} }}\n"
                       f"payload: {{ {options.payload} }}\n{section}")
        with open(self.log, "w", encoding="utf-8") as log:
            self.process = subprocess.Popen([os.path.join(options.bin_dir, "fieldcast-forward"), "--config", config], stdout=log, stderr=log)
        wait_until(lambda: "forwards domain" in self.text(), 20, self.text)

    def status(self):
        """(waiting messages, acknowledged samples, acknowledged messages)"""
        found = re.search(r"(\d+) messages wait .*?(\d+) samples .*?in (\d+) messages", self.state())
        return tuple(int(number) for number in found.groups())

    def state(self):
        lines = self.lines()
        self.process.send_signal(signal.SIGUSR1)
        wait_until(lambda: len(self.lines()) > len(lines), 20, "no state in the log")
        return self.lines()[-1]

    def text(self):
        with open(self.log, encoding="utf-8") as file:
            return file.read()

    def lines(self):
        return [line for line in self.text().splitlines() if "messages wait" in line]


def measure(options, forwarder, server, bridge, line):
    rate = options.buses * options.channels
    wait_until(lambda: forwarder.status()[1] > rate, 120, lambda: str(forwarder.status()))
    time.sleep(3)
    live = LiveDelay(server.port) if options.engine == "jetstream" and "json" not in options.payload and "zstd" not in options.payload and (line or not options.outage) else None
    quiet = time.time()
    if live:
        time.sleep(10)
        print("delay of live samples without a backlog: " + live.text(quiet))
    if options.outage:
        cut, repair = (line.cut, line.join) if line else (server.kill, server.start)
        cut()
        time.sleep(2)  # until what was in flight has a result
        before = forwarder.status()
        time.sleep(options.outage - 2)
        waiting = forwarder.status()[0]
        repair()
        wait_until(lambda: "not connected" not in forwarder.state(), 60, forwarder.state)
        began, connected = time.monotonic(), time.time()
        wait_until(lambda: forwarder.status()[1] - before[1] >= rate * (options.outage - 3), 600, lambda: str(forwarder.status()))
        seconds = time.monotonic() - began
        print(f"outage of {options.outage} s: the backlog of {waiting} messages was sent in {seconds:.1f} s, with new samples; "
              f"{(forwarder.status()[1] - before[1]) / seconds:.0f} samples a second, "
              f"{(options.outage + seconds) / seconds:.0f} times real time")
        if live:
            print("delay of live samples after it: " + live.text(connected))
    before, processor, wire, began = forwarder.status(), run_seconds(forwarder.process.pid), sent_bytes(forwarder.port), time.monotonic()
    others = run_seconds(bridge.pid), run_seconds_of_all(server.process.pid)
    time.sleep(options.seconds)
    after, seconds = forwarder.status(), time.monotonic() - began
    samples = after[1] - before[1]
    print(f"published {rate} samples a second; acknowledged {samples / seconds:.0f} a second in {(after[2] - before[2]) / seconds:.0f} messages, "
          f"{after[0]} wait; {1000 * (run_seconds(forwarder.process.pid) - processor) / samples:.4f} s of processor for 1 000 samples; "
          f"{(sent_bytes(forwarder.port) - wire) / samples:.2f} bytes a sample "
          f"(bridge {(run_seconds(bridge.pid) - others[0]) / seconds:.2f}, server {(run_seconds_of_all(server.process.pid) - others[1]) / seconds:.2f} cores)")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("bin_dir")
    for name, default in [("buses", 20), ("channels", 1000), ("seconds", 20), ("outage", 0), ("round-trip", 0), ("rate", 0)]:
        parser.add_argument("--" + name, type=int, default=default)
    parser.add_argument("--engine", default="jetstream")
    parser.add_argument("--payload", default="format: protobuf")
    parser.add_argument("--gather", default="1s")
    options = parser.parse_args()
    domain, claim = claim_domain()
    with claim, tempfile.TemporaryDirectory(prefix="fieldcast-forward-bench-") as folder:
        server = (NatsServer(folder) if options.engine == "jetstream" else EngineServer(options.engine, folder)).start()
        line = DelayedLine(server.port, options.round_trip / 1000, options.rate * 1000) if options.round_trip or options.rate else None
        bridge = subprocess.Popen([os.path.join(options.bin_dir, "bench_bridge"), str(domain), str(options.buses), str(options.channels), "real"],
                                  stdout=subprocess.DEVNULL)
        section = None if options.engine == "jetstream" else server.section()
        forwarder = Forwarder(options, folder, domain, line.port if line else server.port, section)
        try:
            measure(options, forwarder, server, bridge, line)
        finally:
            for process in (forwarder.process, bridge):
                process.send_signal(signal.SIGTERM)
                process.wait(20)
            server.kill()
            if line:
                line.close()


if __name__ == "__main__":
    main()
