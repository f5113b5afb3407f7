"""Sends hostile datagrams to the ports of a bridge and of a station, while the station receives values.

Usage: rtps_attacks.py BIN_DIR. Prints the sent datagrams, the longest time without a value of a channel before and during the attack,
the memory of the bridge, and its refusals. Fails if a value is late or not good, if the bridge ends or grows by more than MOST_GROWTH_MB, or
if `status` or the metrics do not show the refusals by cause.
"""

import json
import os
import re
import socket
import subprocess
import sys
import threading
import time
import urllib.request

import plant
from command_flood import resident_mb

CONFIG = """
bridge: attacked
metrics: { listen: 127.0.0.1:{port} }""" + plant.modbus_line(device="unit", port="baud: 115200", defaults="refresh: 500ms") + """\
          - { name: level, at: "holding:0", type: uint16 }
          - { name: flow, at: "holding:100", type: uint16 }
  - name: second
    port: { serial: {run}/second, baud: 115200 }
    protocol: modbus-rtu
    devices: [ { name: unit, address: 1, channels: [ { name: speed, at: "holding:0", type: uint16, refresh: 500ms } ] } ]
"""
CHANNELS = {"level", "flow", "speed"}
QUIET_SECONDS, ATTACK_SECONDS = 5, 15
LATE_SECONDS = 3.0  # six refreshes; other programs load the machine
MOST_GROWTH_MB = 60
CAUSES = {"SUBMESSAGE", "ORDER", "SEQUENCE_NUMBER", "BITMAP", "FRAGMENT", "SAMPLE_SIZE", "PARAMETER_LIST", "PARAMETER", "ENCAPSULATION",
          "SERVICE"}


class Gaps:
    """Records the longest gap between two samples of a channel in two phases, and samples that are not good."""

    def __init__(self, watch):
        self.longest, self.last, self.bad, self.lock = 0.0, {}, [], threading.Lock()
        self.thread = threading.Thread(target=self.read, args=(watch,))
        self.thread.start()

    def read(self, watch):
        for text in watch.stdout:
            sample, now = json.loads(text), time.monotonic()
            if "channel" not in sample:
                continue
            with self.lock:
                if sample["quality"] != "GOOD":
                    self.bad.append(text)
                if sample["channel"] in self.last:
                    self.longest = max(self.longest, now - self.last[sample["channel"]])
                self.last[sample["channel"]] = now

    def end_phase(self):
        """Returns the longest gap of this phase; a present gap counts up to now."""
        with self.lock:
            longest = max([self.longest, *(time.monotonic() - at for at in self.last.values())])
            self.longest = 0.0
            return longest


def free_port():
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        return one.getsockname()[1]


def in_metrics(port):
    with urllib.request.urlopen(f"http://127.0.0.1:{port}/metrics", timeout=10) as response:
        text = response.read().decode()
    return {cause: int(count) for cause, count in re.findall(r'fieldcast_dds_refused_datagrams_total\{cause="(\w+)"\} (\d+)', text)}


def in_status(bus):
    """Returns the numbers of datagrams that the bridge refused, by cause; only its first bus shows them."""
    lines = [line for line in bus.cli("status", "--json").json_lines() if line["topic"] == "BusStatus"]
    shown = {line["bus"]: {cause[len("DATAGRAM_"):]: count for cause, count in line["causes"].items() if cause.startswith("DATAGRAM_")}
             for line in lines}
    if shown.get("second"):
        raise plant.Failure(f"the second bus shows {shown['second']}")
    return shown.get("line", {})


def run(bin_dir):
    port = free_port()
    with plant.Plant(bin_dir, CONFIG.replace("{port}", str(port))) as bus:
        watch = bus.start_cli("watch", "--json", "--for", f"{QUIET_SECONDS + ATTACK_SECONDS + 30}s")
        gaps = Gaps(watch)
        try:
            plant.wait_until(lambda: set(gaps.last) == CHANNELS, 20, lambda: f"only {set(gaps.last)} arrived")
            gaps.end_phase()
            time.sleep(QUIET_SECONDS)
            quiet, before = gaps.end_phase(), resident_mb(bus.bridge.pid)
            attacker = subprocess.Popen([os.path.join(bin_dir, "rtps-attacker"), str(bus.domain), str(ATTACK_SECONDS), "1"],
                                        stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, text=True)
            most = before
            while attacker.poll() is None:
                if bus.bridge.poll() is not None:
                    attacker.kill()
                    raise plant.Failure(f"the bridge ended with {bus.bridge.returncode}\n{bus.log('fieldcast-bridge')}")
                most = max(most, resident_mb(bus.bridge.pid))
                time.sleep(0.2)
            sent, attacked = int(attacker.communicate()[0]), gaps.end_phase()
            metrics = in_metrics(port)
            plant.wait_until(lambda: set(in_status(bus)) >= CAUSES, 20, lambda: f"status shows {in_status(bus)}")
            shown = in_status(bus)
        finally:
            watch.terminate()
            watch.wait()
            gaps.thread.join()
            watch.stdout.close()
    print(f"sent: {sent} datagrams in {ATTACK_SECONDS} s; refused by the bridge: {sum(metrics.values())}, {metrics}")
    print(f"longest time without a value: {quiet:.2f} s before, {attacked:.2f} s during the attack")
    print(f"memory of the bridge: {before:.0f} MB before, at most {most:.0f} MB")
    if attacked > LATE_SECONDS:
        raise plant.Failure(f"a value came after {attacked:.2f} s")
    if gaps.bad:
        raise plant.Failure(f"values that are not good: {gaps.bad[:3]}")
    if most - before > MOST_GROWTH_MB:
        raise plant.Failure(f"the bridge grew by {most - before:.0f} MB")
    if missing := CAUSES - set(metrics):
        raise plant.Failure(f"the metrics do not show {missing}")
    if any(shown[cause] < count for cause, count in metrics.items() if cause in shown) or set(metrics) - set(shown):
        raise plant.Failure(f"status shows {shown}, the metrics showed {metrics}")


if __name__ == "__main__":
    plant.run_alone("rtps_attacks", run)
