"""A bridge whose clock is 20 s behind, by fault_shim.c: `fieldcast doctor`, `fieldcast status` and a station show the offset.

usage: e2e_clock.py BIN_DIR SHIM
"""

import json
import os
import re
import subprocess
import sys
import unittest
import urllib.request

import e2e_station
from e2e_station import CONFIG, Station
from plant import Plant, wait_until

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "campaign"))
from fault_shim import FaultShim  # noqa: E402

SECONDS = 30
BEHIND_S = 20
NEAR_S = 3  # what a busy machine may add on the way


class ShiftedPlant(Plant):
    """Only the bridge has the other clock."""

    def _start(self, name):
        if name != "fieldcast-bridge":
            return super()._start(name)
        self.shim = FaultShim(SHIM, self.run, self.run)
        self.shim.clock_offset_ns = -BEHIND_S * 1_000_000_000
        with open(os.path.join(self.run, name + ".log"), "w", encoding="utf-8") as log:
            return subprocess.Popen([os.path.join(self.bin_dir, name), self.file], stdout=log, stderr=subprocess.STDOUT,
                                    stdin=subprocess.DEVNULL, env=self.shim.environment())


class Clock(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.plant = cls.enterClassContext(ShiftedPlant(BIN_DIR, CONFIG))

    def near(self, seconds):
        self.assertGreaterEqual(seconds, BEHIND_S - 0.5)
        self.assertLess(seconds, BEHIND_S + NEAR_S)

    def doctor(self):
        """What it finds about the clock of the bridge."""
        result = subprocess.run([os.path.join(BIN_DIR, "fieldcast"), "doctor", self.plant.file, "--json"], capture_output=True, text=True, timeout=SECONDS)
        return [line for line in map(json.loads, result.stdout.splitlines()) if line["check"] == "clock" and line["where"] == "bridge e2e"]

    def test_1_the_doctor_names_both_clocks_and_what_to_do(self):
        [row] = self.doctor()
        self.assertEqual(row["severity"], "advice")
        said = re.fullmatch(r"this machine's clock is ([\d.]+) s ahead of the clock of bridge e2e: ages of samples are too large, and a command may run "
                            r"after its lifespan; synchronize both with NTP \(here ([\d:TZ.-]+), there ([\d:TZ.-]+)\)", row["what"])
        self.assertTrue(said, row["what"])
        self.near(float(said[1]))
        self.assertIn("timedatectl set-ntp true on both machines", row["remedy"])

    def test_2_status_says_it_in_json(self):
        lines = self.plant.cli("status", "--json", "--for", "4s").json_lines()
        known = [line["clock_ahead"] for line in lines if "clock_ahead" in line]
        self.assertTrue(known, lines)
        self.near(known[-1] / 1e9)

    def test_3_a_station_says_it_to_pages_and_in_its_metrics(self):
        def get(path):
            with urllib.request.urlopen(station.origin + path, timeout=SECONDS) as response:
                return response.read().decode()

        with Station(self.plant, "page", "web: { local-role: viewer }\n", "--listen", "127.0.0.1:0") as station:
            wait_until(lambda: "clock_ahead_ms" in get("/api/buses"), SECONDS, lambda: get("/api/buses"))
            self.near(json.loads(get("/api/buses"))[0]["clock_ahead_ms"] / 1e3)
            found = re.search(r"^fieldcast_station_largest_clock_offset_seconds ([\d.]+)$", get("/metrics"), re.M)
            self.assertTrue(found, get("/metrics"))
            self.near(float(found[1]))

    def test_4_clocks_that_agree_are_no_advice(self):
        self.plant.shim.clock_offset_ns = 0
        [row] = self.doctor()
        self.assertEqual(row["severity"], "ok")
        self.assertRegex(row["what"], r"^this machine's clock and that of bridge e2e differ by 0\.\d{3} s$")


if __name__ == "__main__":
    SHIM = os.path.abspath(sys.argv.pop())
    BIN_DIR = e2e_station.BIN_DIR = sys.argv.pop()
    unittest.main()
