#!/usr/bin/env python3
"""Measures how fieldcast-station fetches an hour of missing samples from the store of a bridge: time, processor time, missed refreshes.

usage: tools/bench/history_bench.py BIN_DIR [--channels 1000] [--minutes 60] [--rounds 1]

A simulated bus of 115 200 baud with channels of 1 s. The store of the bridge is filled before its start with one sample a second of each
channel; the record of the station has only the first of them. A round measures the bridge for the same time with a station that fetches
the missing samples and with one that does not, in alternating order, because other programs of the machine also delay a bus.
"""

import argparse
import contextlib
import os
import re
import sqlite3
import statistics
import sys
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "tests", "tools"))
import e2e_station  # noqa: E402
from plant import Plant, wait_until  # noqa: E402

TICKS = os.sysconf("SC_CLK_TCK")
SECOND = 1_000_000_000
CONFIG = """
bridge: bench
store: { path: {run}/bridge.db }
buses:
  - name: line
    port: { serial: {run}/line, baud: 115200, format: 8N1 }
    protocol: modbus-rtu
    defaults: { refresh: 1s }
    devices:
      - name: press
        address: 1
        channels:
"""
RECORD = """
store: { path: {run}/recorded.db }
record: { patterns: ["*"], backfill: {backfill} }
"""


def run_seconds(pid):
    with open(f"/proc/{pid}/stat", encoding="ascii") as file:
        fields = file.read().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / TICKS


def fill(path, channels, seconds, end, every):
    """Adds one good sample a second to a store with its tables, for the time before `end`; only those of `every` seconds."""
    with contextlib.closing(sqlite3.connect(path)) as store:
        store.executemany("insert into channels(bus, device, channel, unit, type) values('line', 'press', ?, '', 'uint16') on conflict do nothing",
                          [(f"c{i}",) for i in range(channels)])
        ids = [row[0] for row in store.execute("select id from channels where bus = 'line' order by id")]
        begin = end - seconds * SECOND
        store.execute("insert into bus_epochs values('line', ?) on conflict do nothing", (begin - SECOND,))
        for each in ids:
            store.executemany("insert into samples values(?, ?, ?, ?, 0, 0, 2, ?, null, null)",
                              ((each, at, i + 1, at, i % 65536) for i in range(0, seconds, every) for at in (begin + i * SECOND,)))
        store.commit()


def count(path):
    with contextlib.closing(sqlite3.connect(f"file:{path}?mode=ro", uri=True)) as store:
        return store.execute("select count(*) from samples").fetchone()[0]


class Bridge:
    def __init__(self, plant):
        self.plant = plant
        self.pid = plant.bridge.pid

    def look(self):
        status = next(line for line in self.plant.cli("status", "--json").json_lines() if line["topic"] == "BusStatus")
        return time.monotonic(), run_seconds(self.pid), status["deadline_misses"], status["samples"]


def missed(name, before, after):
    """Prints what the bridge did; returns its missed refreshes a second."""
    seconds = after[0] - before[0]
    print(f"{name:10}: {seconds:6.1f} s, bridge {(after[1] - before[1]) / seconds:.3f} cores, {after[2] - before[2]} missed refreshes, "
          f"{(after[3] - before[3]) / seconds:.0f} samples a second", flush=True)
    return (after[2] - before[2]) / seconds


class Bench:
    def __init__(self, plant, options):
        self.plant, self.channels, self.seconds = plant, options.channels, 60 * options.minutes
        self.bridge_store, self.recorded = os.path.join(plant.run, "bridge.db"), os.path.join(plant.run, "recorded.db")
        self.bridge = Bridge(plant)
        self.starts = 0

    def station(self, longest):
        self.starts += 1
        text = RECORD.replace("{run}", self.plant.run).replace("{backfill}", longest)
        return e2e_station.Station(self.plant, f"station-{self.starts}", text, "--listen", "127.0.0.1:0")

    def prepare(self):
        """Fills the store of the bridge with what was missed."""
        with self.station("0s") as station:
            wait_until(lambda: os.path.exists(self.recorded) and count(self.recorded) >= self.channels, 60, station.log)
        with contextlib.closing(sqlite3.connect(self.bridge_store, timeout=60)) as store:
            self.end = store.execute("select min(published_at) from samples").fetchone()[0] - SECOND
        fill(self.bridge_store, self.channels, self.seconds, self.end, 1)
        print(f"{self.seconds * self.channels} samples were missed", flush=True)
        time.sleep(15)  # the bridge has stored what waited meanwhile

    def forget(self):
        """The record has only the first sample of each channel."""
        with contextlib.closing(sqlite3.connect(self.recorded, timeout=60)) as store:
            store.execute("delete from samples")
            store.commit()
        fill(self.recorded, self.channels, self.seconds, self.end, self.seconds)

    def with_back_fill(self):
        self.forget()
        before = self.bridge.look()
        with self.station("1d") as station:
            wait_until(lambda: "back-filled" in station.log(), 3600, station.log)
            after = self.bridge.look()
            print(re.search("back-filled.*", station.log())[0], flush=True)
        self.longest = after[0] - before[0]
        return missed("back-fill", before, after)

    def without(self):
        before = self.bridge.look()
        with self.station("0s"):
            time.sleep(self.longest)
            return missed("without", before, self.bridge.look())

    def round(self, number):
        first = self.with_back_fill() if number % 2 == 0 else self.without()
        second = self.without() if number % 2 == 0 else self.with_back_fill()
        return (first, second) if number % 2 == 0 else (second, first)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("bin_dir")
    for name, default in [("channels", 1000), ("minutes", 60), ("rounds", 1)]:
        parser.add_argument("--" + name, type=int, default=default)
    options = parser.parse_args()
    e2e_station.BIN_DIR = options.bin_dir
    config = CONFIG + "".join(f"          - {{ name: c{i}, at: \"holding:{i + 1}\", type: uint16 }}\n" for i in range(options.channels))
    with Plant(options.bin_dir, config) as plant:
        bench = Bench(plant, options)
        bench.prepare()
        pairs = [bench.round(number) for number in range(options.rounds)]
        differences = [with_it - without for with_it, without in pairs]
        print(f"missed refreshes a second, with and without the back-fill: {', '.join(f'{a:.1f} and {b:.1f}' for a, b in pairs)}; "
              f"median of the differences {statistics.median(differences):+.1f}")


if __name__ == "__main__":
    main()
