#!/usr/bin/env python3
"""Measures fieldcast-forward: samples that a NATS server has acknowledged, processor time, and bytes on the connection.

usage: tools/bench/forward_bench.py BIN_DIR [--buses 20] [--channels 1000] [--seconds 20] [--outage 0] [--payload "compress: zstd"]
                                    [--gather 1s]

bench_bridge publishes a 32-bit number of each channel once a second, without wires, in devices of 100 channels. The server is nats-server with file storage on
127.0.0.1. Bytes are those that TCP has sent (`ss`), with subjects, headers and message ids. With --outage, the server stops for this number of
seconds before the measurement, which then also contains the backlog.
"""

import argparse
import os
import re
import signal
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "tests", "tools"))
from nats import NatsServer  # noqa: E402
from plant import claim_domain, wait_until  # noqa: E402

TICKS = os.sysconf("SC_CLK_TCK")


def run_seconds(pid):
    with open(f"/proc/{pid}/stat", encoding="ascii") as file:
        fields = file.read().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / TICKS


def sent_bytes(port):
    """Bytes that the forwarder has sent on its present connection."""
    text = subprocess.run(["ss", "-tinH", "dst", f"127.0.0.1:{port}"], capture_output=True, text=True, check=True).stdout
    return sum(int(number) for number in re.findall(r"bytes_sent:(\d+)", text))


class Forwarder:
    def __init__(self, options, folder, domain, port):
        self.log = os.path.join(folder, "forward.log")
        config = os.path.join(folder, "forward.yaml")
        with open(config, "w", encoding="utf-8") as file:
            file.write(f"site: north\ndds: {{ domain: {domain} }}\nqueue: {{ path: queue.db }}\ngather: {{ time: {options.gather} }}\n"
                       f"payload: {{ {options.payload} }}\n"
                       f"jetstream: {{ servers: [nats://127.0.0.1:{port}], streams: {{ create: true }} }}\n")
        with open(self.log, "w", encoding="utf-8") as log:
            self.process = subprocess.Popen([os.path.join(options.bin_dir, "fieldcast-forward"), "--config", config], stdout=log, stderr=log)
        wait_until(lambda: "forwards domain" in self.text(), 20, self.text)

    def status(self):
        """(waiting messages, acknowledged samples, acknowledged messages)"""
        lines = self.lines()
        self.process.send_signal(signal.SIGUSR1)
        wait_until(lambda: len(self.lines()) > len(lines), 20, "no state in the log")
        found = re.search(r"(\d+) messages wait .*?(\d+) samples in (\d+) messages", self.lines()[-1])
        return tuple(int(number) for number in found.groups())

    def text(self):
        with open(self.log, encoding="utf-8") as file:
            return file.read()

    def lines(self):
        return [line for line in self.text().splitlines() if "messages wait" in line]


def measure(options, forwarder, server, bridge):
    rate = options.buses * options.channels
    wait_until(lambda: forwarder.status()[1] > rate, 120, lambda: str(forwarder.status()))
    time.sleep(3)
    if options.outage:
        server.kill()
        time.sleep(options.outage)
        server.start()
        began = time.monotonic()
        before = forwarder.status()
        wait_until(lambda: forwarder.status()[0] < 2 * options.buses * options.channels / 100, 600, lambda: str(forwarder.status()))
        seconds = time.monotonic() - began
        print(f"outage of {options.outage} s: the backlog of {before[0]} messages was sent in {seconds:.1f} s, with new samples; "
              f"{(forwarder.status()[1] - before[1]) / seconds:.0f} samples a second")
    before, processor, wire, began = forwarder.status(), run_seconds(forwarder.process.pid), sent_bytes(server.port), time.monotonic()
    others = run_seconds(bridge.pid), run_seconds(server.process.pid)
    time.sleep(options.seconds)
    after, seconds = forwarder.status(), time.monotonic() - began
    samples = after[1] - before[1]
    print(f"published {rate} samples a second; acknowledged {samples / seconds:.0f} a second in {(after[2] - before[2]) / seconds:.0f} messages, "
          f"{after[0]} wait; {1000 * (run_seconds(forwarder.process.pid) - processor) / samples:.4f} s of processor for 1 000 samples; "
          f"{(sent_bytes(server.port) - wire) / samples:.2f} bytes a sample "
          f"(bridge {(run_seconds(bridge.pid) - others[0]) / seconds:.2f}, nats-server {(run_seconds(server.process.pid) - others[1]) / seconds:.2f} cores)")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("bin_dir")
    for name, default in [("buses", 20), ("channels", 1000), ("seconds", 20), ("outage", 0)]:
        parser.add_argument("--" + name, type=int, default=default)
    parser.add_argument("--payload", default="format: protobuf")
    parser.add_argument("--gather", default="1s")
    options = parser.parse_args()
    domain, claim = claim_domain()
    with claim, tempfile.TemporaryDirectory(prefix="fieldcast-forward-bench-") as folder:
        server = NatsServer(folder).start()
        bridge = subprocess.Popen([os.path.join(options.bin_dir, "bench_bridge"), str(domain), str(options.buses), str(options.channels), "real"],
                                  stdout=subprocess.DEVNULL)
        forwarder = Forwarder(options, folder, domain, server.port)
        try:
            measure(options, forwarder, server, bridge)
        finally:
            for process in (forwarder.process, bridge):
                process.send_signal(signal.SIGTERM)
                process.wait(20)
            server.kill()


if __name__ == "__main__":
    main()
