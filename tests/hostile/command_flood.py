"""Tests a requester with a command each millisecond against a second requester with one each 100 ms.

Usage: command_flood.py BIN_DIR. Prints the results of each, alone and together, and the memory of the bridge. Fails if a command of the
second requester is refused or does not run, or if the memory of the bridge grows by more than MOST_GROWTH_MB.
"""

import json
import os
import subprocess
import sys
import time

import plant

CONFIG = """
bridge: flood""" + plant.modbus_line(device="unit", port="baud: 19200", defaults="refresh: 1s") + """\
          - { name: level, at: "holding:0", type: uint16 }
          - { name: flow, at: "holding:100", type: uint16 }
"""
SECONDS = 10
FLOOD_SECONDS = 20
MOST_GROWTH_MB = 60


def resident_mb(pid):
    with open(f"/proc/{pid}/status", encoding="ascii") as file:
        return next(int(line.split()[1]) for line in file if line.startswith("VmRSS")) / 1024


def requester(bin_dir, domain, pace_us, seconds, channel):
    return subprocess.Popen([os.path.join(bin_dir, "command_requester"), str(domain), str(pace_us), str(seconds), "line", "unit", channel],
                            stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, text=True)


def result_of(process):
    out = process.communicate(timeout=120)[0]
    if process.returncode != 0:
        raise plant.Failure(f"a requester ended with {process.returncode}")
    return json.loads(out)


def run(bin_dir):
    with plant.Plant(bin_dir, CONFIG) as bus:
        alone = result_of(requester(bin_dir, bus.domain, 100_000, SECONDS, "flow"))
        before = resident_mb(bus.bridge.pid)
        flood = requester(bin_dir, bus.domain, 1000, FLOOD_SECONDS, "level")
        second = requester(bin_dir, bus.domain, 100_000, SECONDS, "flow")
        most = before
        while flood.poll() is None:
            most = max(most, resident_mb(bus.bridge.pid))
            time.sleep(0.2)
        flooded, beside = result_of(flood), result_of(second)
    print(f"alone:            {alone}")
    print(f"the flood:        {flooded}")
    print(f"beside the flood: {beside}")
    print(f"memory of the bridge: {before:.0f} MB before, at most {most:.0f} MB")
    if beside["done"] != beside["sent"]:
        raise plant.Failure("commands of the second requester did not run")
    if most - before > MOST_GROWTH_MB:
        raise plant.Failure(f"the bridge grew by {most - before:.0f} MB")


if __name__ == "__main__":
    plant.run_alone("command_flood", run)
