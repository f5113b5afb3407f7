"""Records the history of a plant while its bridge is killed and its devices fail, and checks it (history_check.py has the rules).

usage: history_campaign.py --bin DIR [--seconds S] [--seed N] [--folder DIR]

Two serial lines have devices that respond late, twice, in part or not at all, on a noisy wire. Two stations watch. Two callers write, each a
value that never occurs again; some commands have a life span of milliseconds. The bridge is killed and restarted at random; --folder keeps
the files. Each violation is printed as a line that begins with FAIL; the last line is the counts.
"""

import argparse
import collections
import glob
import itertools
import json
import os
import random
import subprocess
import sys
import tempfile
import threading
import time

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [HERE, os.path.join(HERE, "..", "tools")]
import history_check  # noqa: E402
from plant import Failure, Plant, report  # noqa: E402

CHANNELS = """          - { name: temperature, at: "holding:100", type: float32 }
          - { name: speed, at: "holding:104", type: int16 }
          - { name: power, at: "input-register:7", type: int32, scale: 0.1 }
          - { name: setpoint, at: "holding:200", type: int32, access: read-write }
"""
LINE = """  - name: {name}
    port: {{ serial: {{run}}/{name}, baud: {baud}, format: 8E1 }}
    protocol: modbus-rtu
    defaults: {{ refresh: {refresh}, timeout: 200ms }}
    capture: {{ folder: {{run}}/wire, file-size: 10MB, files: 100 }}
    devices:
"""
MILL, PRESS = (f"      - name: {name}\n        address: {address}\n        channels:\n{CHANNELS}" for name, address in (("mill", 1), ("press", 2)))
CONFIG = ("bridge: history\nbuses:\n" + LINE.format(name="north", baud=38400, refresh="300ms") + MILL + PRESS
          + LINE.format(name="south", baud=19200, refresh="500ms") + MILL)
FAULTS = """
buses:
  "*":
    noise: 1e-6
    devices:
      "*":
        delay: { base: 2ms, spread: 3ms }
        loss: 0.01
        late: { probability: 0.01, by: 300ms }
        doubled: { probability: 0.01, after: 5ms }
        garble: 0.01
        truncate: 0.01
        stray: 0.01
"""
WRITTEN = ["north/mill/setpoint", "north/press/setpoint", "south/mill/setpoint"]
SILENT = 25.0  # seconds: a restart, and a device that was given up for a while


class FaultyPlant(Plant):
    def __init__(self, bin_dir, seed):
        super().__init__(bin_dir, CONFIG)
        self.seed = seed

    def _start(self, name):
        os.makedirs(os.path.join(self.run, "wire"), exist_ok=True)
        arguments = [os.path.join(self.bin_dir, name), self.file]
        if name == "fieldcast-sim":
            faults = os.path.join(self.run, "faults.yaml")
            with open(faults, "w", encoding="utf-8") as file:
                file.write(FAULTS)
            arguments += ["--faults", faults, "--seed", str(self.seed)]
        with open(os.path.join(self.run, name + ".log"), "a", encoding="utf-8") as log:
            return subprocess.Popen(arguments, stdout=log, stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL)


class Caller(threading.Thread):
    """Writes one value after the other to `channels`, and records what became of each."""

    def __init__(self, plant, channels, number, seed, file, over):
        super().__init__()
        self.plant, self.channels, self.random, self.over = plant, channels, random.Random(f"{seed}-{number}"), over
        self.file, self.values = file, itertools.count(1_000_000 * (number + 1))

    def run(self):
        with open(self.file, "w", encoding="utf-8") as file:
            while not self.over.is_set():
                file.write(json.dumps(self._write()) + "\n")

    def _write(self):
        channel, value = self.random.choice(self.channels), next(self.values)
        span = self.random.choice(["5s", "5s", "2s", "20ms", "1ms"])
        invoked = time.time_ns()
        result = self.plant.cli("write", f"{channel}={value}", "--timeout", span, "--json")
        rows = [json.loads(text) for text in result.out.splitlines() if text.startswith("{")]
        return {"channel": channel, "value": value, "invoked_at": invoked, "returned_at": time.time_ns(), "results": rows or None,
                "exit_code": result.code}


def watch(plant, name):
    with open(name, "w", encoding="utf-8") as file:
        return subprocess.Popen([os.path.join(plant.bin_dir, "fieldcast"), "watch", "--json", "--config", plant.file], stdout=file,
                                stderr=subprocess.DEVNULL, stdin=subprocess.DEVNULL)


def run(options, folder):
    draw, counts = random.Random(options.seed), collections.Counter()
    stations, calls = ([os.path.join(folder, f"{kind}-{number}.jsonl") for number in (1, 2)] for kind in ("samples", "commands"))
    over = threading.Event()
    with FaultyPlant(options.bin, options.seed) as plant:
        watching = [watch(plant, name) for name in stations]
        callers = [Caller(plant, WRITTEN, number, options.seed, name, over) for number, name in enumerate(calls)]
        try:
            for caller in callers:
                caller.start()
            end = time.monotonic() + options.seconds
            while time.monotonic() < end:
                time.sleep(draw.uniform(3, 12))
                plant.kill_bridge()
                counts["kills"] += 1
        finally:
            over.set()
            for caller in callers:
                caller.join()
            for process in watching:
                process.terminate()
                process.wait()
        plant.bridge.terminate()
        plant.bridge.wait()
        captures = sorted(glob.glob(os.path.join(plant.run, "wire", "*.pcapng")))
        failures, found = history_check.check(plant.file, stations, calls, captures, SILENT, counts["kills"])
        if failures and options.folder:
            for name in [*captures, plant.file]:
                os.link(name, os.path.join(folder, os.path.basename(name)))
    return failures, {**counts, **found}


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--bin", required=True)
    parser.add_argument("--seconds", type=float, default=60)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--folder")
    options = parser.parse_args()
    try:
        with tempfile.TemporaryDirectory(prefix="fieldcast-history-") as folder:
            os.makedirs(options.folder or folder, exist_ok=True)
            failures, counts = run(options, options.folder or folder)
    except Failure as failure:
        failures, counts = [str(failure)], {}
    for failure in failures[:50]:
        print(f"FAIL {failure}")
    return report({**counts, "violations": len(failures)}, bool(failures))


if __name__ == "__main__":
    sys.exit(main())
