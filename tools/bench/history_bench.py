#!/usr/bin/env python3
"""Measures how fieldcast-station fetches an hour of missing samples from the store of a bridge: time, processor time, missed refreshes.

usage: tools/bench/history_bench.py BIN_DIR [--channels 1000] [--minutes 60]

A simulated bus of 115 200 baud with channels of 1 s. The store of the bridge is filled before its start with one sample a second of each
channel; the record of the station has only the first of them. The processor time of the bridge and its missed refreshes are counted during
the back-fill, and for the same time after it.
"""

import argparse
import contextlib
import os
import re
import sqlite3
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
        store.execute("insert into bus_epochs values('line', ?)", (begin - SECOND,))
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


def report(name, before, after):
    seconds = after[0] - before[0]
    print(f"{name}: {seconds:.1f} s, bridge {(after[1] - before[1]) / seconds:.3f} cores, {after[2] - before[2]} missed refreshes, "
          f"{(after[3] - before[3]) / seconds:.0f} samples a second", flush=True)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("bin_dir")
    parser.add_argument("--channels", type=int, default=1000)
    parser.add_argument("--minutes", type=int, default=60)
    options = parser.parse_args()
    e2e_station.BIN_DIR = options.bin_dir
    config = CONFIG + "".join(f"          - {{ name: c{i}, at: \"holding:{i + 1}\", type: uint16 }}\n" for i in range(options.channels))
    with Plant(options.bin_dir, config) as plant:
        bridge_store, recorded = os.path.join(plant.run, "bridge.db"), os.path.join(plant.run, "recorded.db")
        with e2e_station.Station(plant, "first", RECORD.replace("{run}", plant.run).replace("{backfill}", "0s"), "--listen", "127.0.0.1:0") as station:
            wait_until(lambda: os.path.exists(recorded) and count(recorded) >= options.channels, 60, station.log)
        seconds = 60 * options.minutes
        for path in (bridge_store, recorded):
            with contextlib.closing(sqlite3.connect(path, timeout=60)) as store:
                begin = store.execute("select min(published_at) from samples").fetchone()[0]
                if path == recorded:  # only the first sample of the hour
                    store.execute("delete from samples")
                    store.commit()
            fill(path, options.channels, seconds, begin - SECOND, 1 if path == bridge_store else seconds)
        print(f"{seconds * options.channels} samples were missed", flush=True)
        time.sleep(15)  # the bridge has stored what waited meanwhile
        bridge = Bridge(plant)
        before = bridge.look()
        with e2e_station.Station(plant, "second", RECORD.replace("{run}", plant.run).replace("{backfill}", "1d"), "--listen", "127.0.0.1:0") as station:
            wait_until(lambda: "back-filled" in station.log(), 3600, station.log)
            after = bridge.look()
            report("back-fill", before, after)
            print(re.search("back-filled.*", station.log())[0], flush=True)
            station_seconds = run_seconds(station.process.pid)
            print(f"station {station_seconds:.1f} s of processor time", flush=True)
            time.sleep(min(120, after[0] - before[0]))
            report("afterwards", after, bridge.look())
            print(f"{count(recorded)} samples recorded, {count(bridge_store)} in the store of the bridge", flush=True)


if __name__ == "__main__":
    main()
