"""Tests the station's page with the real programs: a simulated plant, its bridge,
fieldcast-station with a store and users, and chromium.

usage: e2e_station.py BIN_DIR NODE NODE_MODULES [SCREENSHOTS]

Starts the programs, then e2e_station.mjs checks the page. SCREENSHOTS: a directory for the README's
pictures.
"""

import os
import shutil
import subprocess
import sys
import urllib.request

here = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(here, "..", ".."))
sys.path.insert(0, os.path.join(here, "..", "..", "..", "interop"))
from peers import free_port
from plant import STOP_SECONDS, Plant, wait_until

START_SECONDS = 20
SKIPPED = 77
USERS = {"anna": "operator", "vera": "viewer", "erik": "engineer"}
PASSWORD = "secret secret"

CONFIG = """
bridge: north
buses:
  - name: press-shop
    port: { serial: {run}/line, baud: 115200 }
    protocol: modbus-rtu
    defaults: { refresh: 500ms, mode: scheduled, timeout: 100ms, retries: 1 }
    devices:
      - name: press-1
        address: 1
        channels:
          - { name: running, at: "coil:0", access: read-write, refresh: 500ms }
          - { name: pressure, at: "holding:0", type: float32, unit: bar, refresh: 250ms }
          - { name: setpoint, at: "holding:20", type: uint16, unit: 1/min, access: read-write, write: { min: 0, max: 2000 }, limits: { high: 1500 } }
          - { name: counter, at: "holding:30", type: uint64 }
          - { name: program, at: "holding:40", type: string(8), description: of the lot in work }
      - name: press-2
        address: 2
        channels:
          - { name: pressure, at: "holding:0", type: float32, unit: bar }
          - { name: cycle-time, at: "holding:10", type: uint16, unit: ms }
          - { name: ram-position, at: "holding:12", type: int16, scale: 0.1, unit: mm }
          - { name: guard-closed, at: "input:0" }
      - name: oven
        address: 3
        channels:
          - { name: zone-1, at: "input-register:0", type: int16, scale: 0.1, unit: °C }
          - { name: zone-2, at: "input-register:1", type: int16, scale: 0.1, unit: °C }
          - { name: exhaust, at: "input-register:6", type: int16, scale: 0.1, unit: °C, refresh: 2s }
          - { name: heater, at: "coil:0", access: read-write }
          - { name: power, at: "input-register:10", type: float32, unit: kW }
  - name: utilities
    port: { serial: {run}/line-b, baud: 9600 }
    protocol: modbus-rtu
    defaults: { refresh: 1s, mode: scheduled, timeout: 200ms, retries: 1 }
    devices:
      - name: energy-meter
        address: 1
        channels:
          - { name: voltage-l1, at: "input-register:0", type: float32, unit: V }
          - { name: voltage-l2, at: "input-register:2", type: float32, unit: V }
          - { name: voltage-l3, at: "input-register:4", type: float32, unit: V }
          - { name: energy, at: "input-register:20", type: uint64, unit: Wh, refresh: 5s }
      - name: pump
        address: 2
        channels:
          - { name: speed, at: "holding:0", type: uint16, unit: 1/min }
          - { name: flow, at: "holding:2", type: float32, unit: m³/h }
          - { name: vibration, at: "holding:4", type: float32, unit: mm/s }
  - name: water
    port: { serial: {run}/line-c, baud: 19200 }
    protocol: modbus-rtu
    defaults: { refresh: 1s, mode: scheduled, timeout: 200ms, retries: 1 }
    devices:
      - name: tank
        address: 1
        channels:
          - { name: level, at: "holding:0", type: float32, unit: "%" }
          - { name: temperature, at: "holding:2", type: float32, unit: °C }
          - { name: inlet, at: "coil:0", access: read-write }
"""

STATION = """
station: e2e
dds: { domain: {domain}, interfaces: [127.0.0.1] }
web: { listen: "127.0.0.1:{port}" }
store: { path: {run}/station.db }
record: { patterns: ["*"] }
"""


class Station:
    def __init__(self, bin_dir, plant):
        self.address = f"http://127.0.0.1:{free_port()}"
        self.log = os.path.join(plant.run, "station.log")
        file = os.path.join(plant.run, "station.yaml")
        store = os.path.join(plant.run, "station.db")
        with open(file, "w", encoding="utf-8") as out:
            out.write(STATION.replace("{domain}", str(plant.domain)).replace("{port}", self.address.rsplit(":", 1)[1]).replace("{run}", plant.run))
        for name, role in USERS.items():
            subprocess.run([os.path.join(bin_dir, "fieldcast"), "user", "add", name, "--role", role, "--store", store],
                           input=PASSWORD + "\n", text=True, check=True, capture_output=True, timeout=60)
        with open(self.log, "w", encoding="utf-8") as log:
            self.process = subprocess.Popen([os.path.join(bin_dir, "fieldcast-station"), "--config", file], stdout=log, stderr=log)
        wait_until(self._answers, START_SECONDS, self.tail)

    def _answers(self):
        if self.process.poll() is not None:
            raise AssertionError(f"fieldcast-station ended by itself with {self.process.returncode}\n{self.tail()}")
        try:
            return urllib.request.urlopen(self.address + "/healthz", timeout=5).status == 200
        except OSError:
            return False

    def tail(self):
        with open(self.log, encoding="utf-8", errors="replace") as file:
            return "--- fieldcast-station:\n" + "".join(file.readlines()[-40:])

    def stop(self):
        if self.process.poll() is None:
            self.process.terminate()
        try:
            return self.process.wait(STOP_SECONDS)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
            return "killed"


def main(bin_dir, node, modules, *screenshots):
    if not shutil.which("chromium"):
        print("chromium is not installed: tools/install.sh test")
        return SKIPPED
    with Plant(bin_dir, CONFIG) as plant:
        station = Station(bin_dir, plant)
        try:
            script = os.path.join(here, "e2e_station.mjs")
            code = subprocess.run([node, script, station.address, modules, str(station.process.pid), *screenshots], timeout=240).returncode
        finally:
            ended = station.stop()
        if code != 0 or ended != 0:
            print(station.tail(), plant.log("fieldcast-bridge"), f"fieldcast-station ended with {ended}", sep="\n")
        return 0 if code == 0 and ended == 0 else 1


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
