"""Tests that a bridge with 10 000 channels stops within 2 s, while a station receives all of them.

Usage: stop_of_many.py BIN_DIR. Prints the number of received channels and the duration of the stop.
"""

import os
import subprocess
import sys
import time

import plant

BUSES, DEVICES, CHANNELS = 10, 10, 100
STOP_SECONDS = 2.0
START_SECONDS = 60


def config():
    text = "bridge: many\nbuses:\n"
    for bus in range(BUSES):
        text += f"  - name: bus-{bus}\n    port: {{ serial: {{run}}/bus-{bus}, baud: 115200 }}\n    protocol: modbus-rtu\n"
        text += "    defaults: { refresh: 10s }\n    devices:\n"
        for device in range(DEVICES):
            text += f"      - name: device-{device}\n        address: {device + 1}\n        channels:\n"
            for channel in range(CHANNELS):
                text += f'          - {{ name: c{channel}, at: "holding:{channel}", type: uint16 }}\n'
    return text


def received(path):
    """Returns the channels with a good value in the output of a watch."""
    with open(path, encoding="utf-8") as file:
        return len({line[: line.index('"value"')] for line in file if '"value"' in line and '"GOOD"' in line})


def run(bin_dir):
    with plant.Plant(bin_dir, config()) as many:
        lines = os.path.join(many.run, "samples.jsonl")
        with open(lines, "w", encoding="utf-8") as out:
            station = subprocess.Popen([os.path.join(bin_dir, "fieldcast"), "watch", "--json", "--config", many.file],
                                       stdin=subprocess.DEVNULL, stdout=out, stderr=subprocess.PIPE, text=True)
            try:
                plant.wait_until(lambda: received(lines) >= BUSES * DEVICES * CHANNELS, START_SECONDS,
                                 lambda: f"the station has good values of {received(lines)} channels")
                begun = time.monotonic()
                many.bridge.terminate()
                many.bridge.wait(plant.STOP_SECONDS)
                lasted = time.monotonic() - begun
            finally:
                station.terminate()
                said = station.communicate()[1]
        print(said.strip())  # removed channels are no longer GOOD
        print(f"channels with a good value: {received(lines)}; the stop lasted {lasted:.2f} s, at most {STOP_SECONDS} s are allowed")
        if lasted > STOP_SECONDS:
            raise plant.Failure("the stop lasted too long")


if __name__ == "__main__":
    try:
        run(sys.argv[1])
    except plant.Failure as failure:
        sys.exit(f"stop_of_many: {failure}")
