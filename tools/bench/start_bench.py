#!/usr/bin/env python3
"""Measures the start, the memory and the stop of a bridge with many channels, beside a bridge with one channel on each of the same buses.

usage: tools/bench/start_bench.py BIN_DIR [--runs 3] [--buses 64] [--channels 1000] [--refresh 60s]

CHANNELS is the number on a bus, ten devices each. The start is the time from the start of the process until every port is open. Memory is
the difference of the resident memory of both bridges a minute after the start, for one channel. Needs the simulator in BIN_DIR.
"""

import argparse
import os
import re
import subprocess
import sys
import tempfile
import time

sys.path.append(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "tests", "tools"))
from plant import claim_domain, wait_until  # noqa: E402

START_S, STOP_S, SETTLE_S, DEVICES = 60, 20, 60, 10


def config(folder, domain, options, channels):
    text = f"bridge: many\ndds: {{ domain: {domain}, interfaces: [127.0.0.1] }}\nbuses:\n"
    for bus in range(options.buses):
        text += f"  - name: bus-{bus}\n    port: {{ serial: {folder}/bus-{bus}, baud: 115200 }}\n    protocol: modbus-rtu\n"
        text += f"    defaults: {{ refresh: {options.refresh} }}\n    devices:\n"
        for device in range(min(DEVICES, channels)):
            text += f"      - name: device-{device}\n        address: {device + 1}\n        channels:\n"
            for channel in range(max(1, channels // DEVICES)):
                text += f'          - {{ name: c{channel}, at: "holding:{channel}", type: uint16 }}\n'
    path = os.path.join(folder, f"plant-{channels}.yaml")
    with open(path, "w", encoding="utf-8") as file:
        file.write(text)
    return path


def memory(process):
    with open(f"/proc/{process.pid}/status", encoding="ascii") as file:
        return 1024 * int(re.search(r"VmRSS:\s+(\d+)", file.read())[1])


def start(bin_dir, folder, name, path):
    """(process, path of its log)"""
    log = os.path.join(folder, name + ".log")
    with open(log, "wb") as file:
        return subprocess.Popen([os.path.join(bin_dir, name), path], stdin=subprocess.DEVNULL, stdout=file, stderr=subprocess.STDOUT), log


def open_ports(log):
    with open(log, "rb") as file:
        return file.read().count(b"the port is open")


def measure(options, channels, settle):
    """{"start": s, "stop": s, "memory": bytes after `settle` s}"""
    with tempfile.TemporaryDirectory(prefix="fieldcast-start-") as folder:
        domain, claim = claim_domain()
        path = config(folder, domain, options, channels)
        lines = [os.path.join(folder, f"bus-{bus}") for bus in range(options.buses)]
        plant, _ = start(options.bin_dir, folder, "fieldcast-sim", path)
        try:
            wait_until(lambda: all(map(os.path.exists, lines)), START_S, "the simulated lines")
            time.sleep(1)  # the simulator reads a large configuration, too
            begun = time.monotonic()
            bridge, log = start(options.bin_dir, folder, "fieldcast-bridge", path)
            try:
                wait_until(lambda: open_ports(log) >= options.buses, START_S, lambda: f"{open_ports(log)} of {options.buses} ports")
                started = time.monotonic() - begun
                time.sleep(settle)
                used, begun = memory(bridge), time.monotonic()
                bridge.terminate()
                bridge.wait(STOP_S)
                return {"start": started, "stop": time.monotonic() - begun, "memory": used}
            finally:
                bridge.kill()
                bridge.wait()
        finally:
            plant.terminate()
            plant.wait(STOP_S)
            claim.close()


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("bin_dir")
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--buses", type=int, default=64)
    parser.add_argument("--channels", type=int, default=1000)
    parser.add_argument("--refresh", default="60s")
    options = parser.parse_args()
    few = measure(options, 1, SETTLE_S)
    runs = [measure(options, options.channels, SETTLE_S if number == 0 else 1) for number in range(options.runs)]
    each = (runs[0]["memory"] - few["memory"]) / (options.buses * (options.channels - 1))
    print(f"{options.buses * options.channels} channels on {options.buses} buses")
    for what, goal in ("start", 2), ("stop", 2):
        print(f"  {what}, s: " + ", ".join(f"{run[what]:.2f}" for run in runs) + f"; goal {goal}")
    print(f"  memory: {runs[0]['memory'] / 1e6:.1f} MB, with one channel on a bus {few['memory'] / 1e6:.1f} MB: "
          f"{each:.0f} bytes for one channel more; goal 1000")


if __name__ == "__main__":
    main()
