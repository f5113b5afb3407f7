"""Tests that forged claims on a bus, on the topic fieldcast/Bridge, neither take it from a bridge nor delay one.

usage: forged_bridge.py BIN_DIR
"""

import contextlib
import json
import os
import subprocess
import sys
import time

from plant import Failure, Plant, modbus_line, wait_until

CONFIG = """bridge: honest""" + modbus_line(device="plc", defaults="refresh: 100ms") + """\
          - { name: level, at: "holding:0", type: uint16, access: read-write }
"""
CHANNEL = "line/plc/level"
SECONDS = 5           # duration of each attack on a running bridge
LONGEST_GAP = 2       # seconds between two samples, on a busy machine; without an attack some 0.1
MOST_LINES = 40       # in the log of the bridge for one attack of 50 claims
LEASE_SECONDS = 30    # until DDS removes a killed forger: 10 on an idle machine
# A bridge that starts while forged bridges only wait serves after 1 + 5 s on an idle machine; Plant waits 20 s.


@contextlib.contextmanager
def forger(bin_dir, domain, what):
    process = subprocess.Popen([os.path.join(bin_dir, "forge-claims"), str(domain), "line", what], stdin=subprocess.DEVNULL)
    try:
        yield
        if process.poll() is not None:
            raise AssertionError(f"forge-claims ended with {process.returncode}")
    finally:
        process.kill()
        process.wait()


def longest_gap(plant):
    """Returns the longest gap between samples of a station, in seconds."""
    watch = plant.start_cli("watch", CHANNEL, "--json", "--for", f"{SECONDS}s")
    last, gap, count = time.monotonic(), 0.0, 0
    for line in watch.stdout:
        if json.loads(line).get("quality") == "GOOD":
            now = time.monotonic()
            last, gap, count = now, max(gap, now - last), count + 1
    watch.wait()
    print(f"  {count} samples, the longest gap {gap:.2f} s")
    return gap if count else float("inf")


def shown_wrongly(plant, key):
    """Checks that `fieldcast status` names the forger as contesting the bus or as refused."""
    status = [line for line in plant.cli("status", "--json").json_lines() if line["topic"] == "BusStatus"]
    if [line.get(key) for line in status] == [[{"bridge": "forger", "host": "elsewhere"}]]:
        return []
    return [f"{key} is not the forger: {status}"]


def log_lines(plant):
    with open(os.path.join(plant.run, "fieldcast-bridge.log"), encoding="utf-8") as log:
        return log.readlines()


def attack_running(bin_dir, faults):
    with Plant(bin_dir, CONFIG) as plant:
        for what in ("both", "waiting", "serving"):
            print(f"claims of an older bridge, {what}, 10 a second for {SECONDS} s:")
            before = len(log_lines(plant))
            with forger(bin_dir, plant.domain, what):
                if (gap := longest_gap(plant)) > LONGEST_GAP:
                    faults.append(f"{what}: no sample for {gap:.1f} s")
                if what != "both":
                    faults.extend(shown_wrongly(plant, "contested_by" if what == "serving" else "waiting_bridges"))
                written = plant.cli("write", f"{CHANNEL}=7")
                if written.code != 0:
                    faults.append(f"{what}: a write fails: {written}")
            lines = len(log_lines(plant)) - before
            print(f"  {lines} lines in the log of the bridge")
            if lines > MOST_LINES:
                faults.append(f"{what}: {lines} lines in the log")
        wait_until(lambda: any("contested no longer" in line for line in log_lines(plant)), LEASE_SECONDS, "the bus is contested after the forger has ended")
        said = "".join(log_lines(plant))
        if "contested: bridge 'forger' on host elsewhere" not in said:
            faults.append("the log does not name the forger")


def attack_starting(bin_dir, faults):
    plant = Plant(bin_dir, CONFIG)
    with forger(bin_dir, plant.domain, "waiting"):
        began = time.monotonic()
        try:
            with plant:
                print(f"a bridge that starts among claims that wait serves after {time.monotonic() - began:.1f} s")
        except Failure as failure:
            faults.append(f"a bridge that starts among claims that wait: {failure}")


def main(bin_dir):
    faults = []
    attack_running(bin_dir, faults)
    attack_starting(bin_dir, faults)
    print("\n".join(faults) or "no harm")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
