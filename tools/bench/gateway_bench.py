#!/usr/bin/env python3
"""Measures the gateway of a bus: eight Modbus TCP clients, ten requests a second each, on a simulated line of 19 200 baud.

usage: tools/bench/gateway_bench.py BIN_DIR [--seconds 60] [--refresh 1s] [--max-age 0ms] [--count 20] [--channels 20]

The clients are libmodbus, pymodbus and mbpoll, in turn. Four devices have --channels registers at every second address. Prints how many
requests were done, busy and wrong, the 50th and 99th percentile of their time, the mean use of the wire, and the missed refreshes. Needs
python3-pymodbus, libmodbus and mbpoll.
"""

import argparse
import json
import os
import subprocess
import sys
import threading
import time

TESTS = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "tests")
sys.path[:0] = [os.path.join(TESTS, "tools"), os.path.join(TESTS, "interop")]
from peers import LibmodbusClient, PymodbusClient, free_port  # noqa: E402
from plant import Plant, wait_until  # noqa: E402

FIRST = 3000  # of the registers that the clients write and read


def plant_text(options, port):
    text = f"""
bridge: gateway-bench
buses:
  - name: line
    port: {{ serial: {{run}}/line, baud: 19200, format: 8E1 }}
    protocol: modbus-rtu
    gateway: {{ listen: 127.0.0.1:{port}, access: write, max-age: {options.max_age} }}
    defaults: {{ refresh: {options.refresh}, allow: [raw-write] }}
    devices:
"""
    for unit in range(1, 5):
        text += f"      - name: unit-{unit}\n        address: {unit}\n        channels:\n"
        for number in range(options.channels):
            text += f'          - {{ name: r{number}, at: "holding:{100 + 2 * number}", type: uint16 }}\n'
    return text


class Asker:
    """A client that sends ten requests a second; it omits those that are late."""

    def __init__(self, kind, port, number, options):
        self.client = kind(port, number % 4 + 1)
        self.first, self.options = FIRST + 200 * number, options
        self.times, self.busy, self.wrong = [], 0, []
        self.expected = [(number * 1000 + n) % 65536 for n in range(options.count)]
        wait_until(lambda: self.client.write("holding", self.first, *self.expected) is True, 10, "the write is refused")
        self.thread = threading.Thread(target=self.run)

    def run(self):
        end = time.monotonic() + self.options.seconds
        due = time.monotonic()
        while due < end:
            time.sleep(max(0, due - time.monotonic()))
            begun = time.monotonic()
            values = self.client.read("holding", self.first, self.options.count)
            self.times.append(time.monotonic() - begun)
            if values != self.expected:
                if isinstance(values, list):
                    self.wrong.append(values)
                else:
                    self.busy += 1
            due = max(due + 0.1, time.monotonic())


def bus_status(plant):
    return next(line for line in plant.cli("status", "--json").json_lines() if line["topic"] == "BusStatus")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("bin_dir")
    parser.add_argument("--seconds", type=int, default=60)
    parser.add_argument("--refresh", default="1s")
    parser.add_argument("--max-age", default="0ms")
    parser.add_argument("--count", type=int, default=20)
    parser.add_argument("--channels", type=int, default=20)
    options = parser.parse_args()
    port = free_port()
    with Plant(options.bin_dir, plant_text(options, port)) as plant:
        time.sleep(5)  # the bridge measures its devices
        askers = [Asker([LibmodbusClient, PymodbusClient][number % 2], port, number, options) for number in range(6)]
        before = bus_status(plant)
        polls = [
            subprocess.Popen(["mbpoll", "-m", "tcp", "-p", str(port), "-a", str(unit), "-0", "-q", "-o", "5", "-l", "100", "-t", "4", "-r", "4000",
                              "-c", str(options.count), "127.0.0.1"], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
            for unit in (1, 2)
        ]
        for asker in askers:
            asker.thread.start()
        used = []
        while any(asker.thread.is_alive() for asker in askers):
            time.sleep(2)
            used.append(bus_status(plant)["utilisation"])
        for poll in polls:
            poll.terminate()
        polled = "".join(poll.communicate()[0] for poll in polls)
        after = bus_status(plant)
    times = sorted(t for asker in askers for t in asker.times)
    print(json.dumps({
        "requests": len(times),
        "busy": sum(asker.busy for asker in askers),
        "wrong": sum(len(asker.wrong) for asker in askers),
        "mbpoll_polls": polled.count("[4000]:"),
        "mbpoll_failed": polled.count("failed"),
        "median_ms": round(1000 * times[len(times) // 2], 1),
        "p99_ms": round(1000 * times[len(times) * 99 // 100], 1),
        "wire": round(sum(used[1:-1]) / max(1, len(used[1:-1])), 3),
        "planned_load": round(after["planned_load"], 3),
        "missed_refreshes": after["deadline_misses"] - before["deadline_misses"],
    }))


if __name__ == "__main__":
    main()
