#!/usr/bin/env python3
"""Measures the cost of DDS Security: processor seconds of bridge and station for 1 000 samples, without and with each protection.

usage: tools/bench/security_cost.py BIN_DIR [SECONDS]      (default 10 s each; prints a line for each)
"""

import os
import re
import shutil
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "tests", "tools"))
from plant import Plant, modbus_line  # noqa: E402
from progress import Progress  # noqa: E402

CHANNELS = 200
CONFIG = """
bridge: bench""" + modbus_line(device="device") + "".join(f'          - {{ name: c{i}, at: "holding:{i}", type: uint16 }}\n' for i in range(CHANNELS))


def processor_seconds(pid):
    with open(f"/proc/{pid}/stat", encoding="utf-8") as file:
        fields = file.read().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def measure(bin_dir, protection, seconds, folder):
    def fieldcast(*arguments):
        subprocess.run([os.path.join(bin_dir, "fieldcast"), *arguments], check=True, capture_output=True)

    dds, joins = "", []
    if protection != "none":
        authority = os.path.join(folder, protection)
        fieldcast("secure", "init", authority, "--protect", protection)
        fieldcast("secure", "add", "bridge", "bench", "--authority", authority)
        fieldcast("secure", "add", "station", "wall", "--authority", authority)
        dds, joins = f", security: {authority}/members/bench", ["--security", f"{authority}/members/wall"]
    with Plant(bin_dir, CONFIG, dds=dds, joins=joins) as plant:
        station = subprocess.Popen([os.path.join(bin_dir, "fieldcast"), "watch", "--json", "--domain", str(plant.domain), *joins],
                                   stdout=subprocess.PIPE)
        try:
            pids = plant.bridge.pid, station.pid
            first, counted, begun = None, 0, None
            with Progress(f"protection {protection}", seconds) as progress:
                for line in station.stdout:
                    progress.show()
                    counted += bool(re.search(rb'"quality": ?"GOOD"', line))
                    if first is None and counted > 2 * CHANNELS:  # bridge and station have joined
                        first, counted, begun = [processor_seconds(pid) for pid in pids], 0, time.monotonic()
                    if begun is not None and time.monotonic() - begun > seconds:
                        break
            spent = [(processor_seconds(pid) - before) * 1000 / counted for pid, before in zip(pids, first)]
        finally:
            station.kill()
            station.communicate()
    print(f"{protection:8} bridge {spent[0]:.4f} s   station {spent[1]:.4f} s   for 1 000 samples, of {counted}", flush=True)


def main():
    bin_dir, seconds = sys.argv[1], float(sys.argv[2]) if len(sys.argv) > 2 else 10
    folder = tempfile.mkdtemp(prefix="fieldcast-security-")
    try:
        for protection in ("none", "sign", "encrypt"):
            measure(bin_dir, protection, seconds, folder)
    finally:
        shutil.rmtree(folder, ignore_errors=True)


if __name__ == "__main__":
    main()
