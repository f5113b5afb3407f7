"""Tests calculated channels with the real programs: values, qualities and times, over one bus and over two, in the CLI, the catalogue and a
station with a store.

usage: e2e_calculate.py BIN_DIR
"""

import signal
import sys
import unittest

import e2e_station
from e2e_station import Browser, Station
from plant import Plant, modbus_line, run_cli, wait_until

BIN_DIR = ""
SECONDS = 30

METER = """          - { name: voltage, at: "holding:0", type: uint16, unit: V, access: read-write }
          - { name: current, at: "holding:1", type: uint16, unit: A, access: read-write }
"""
CONFIG = """
bridge: e2e
store: { path: {run}/bridge.db }""" + modbus_line(device="meter") + METER + """
          - { name: power, calculate: voltage * current, unit: W, limits: { high: 5000 } }
          - { name: ratio, calculate: voltage / current }
          - { name: running, calculate: power > 100, type: bool }
          - { name: total, calculate: "power + {second/meter/power}", unit: W }
          - { name: doubled, calculate: "2 * {second/meter/seldom}" }
  - name: second
    port: { serial: {run}/second, baud: 115200 }
    protocol: modbus-rtu
    defaults: { refresh: 200ms }
    devices:
      - name: meter
        address: 1
        channels:
""" + METER + """
          - { name: power, calculate: voltage * current, unit: W }
          - { name: seldom, at: "holding:2", type: uint16, acquire: on-interest }
"""


class Calculated(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        e2e_station.BIN_DIR = BIN_DIR
        cls.plant = Plant(BIN_DIR, CONFIG)
        cls.plant.__enter__()
        cls.addClassCleanup(lambda: cls.plant.__exit__(None, None, None))

    def write(self, bus, voltage, current):
        for channel, value in (("voltage", voltage), ("current", current)):
            result = self.plant.cli("write", f"{bus}/meter/{channel}={value}", "--verify")
            self.assertEqual(result.code, 0, str(result))

    def last(self, path):
        result = self.plant.cli("watch", path, "--json", "--once")
        lines = [line for line in result.json_lines() if "value" in line]
        return lines[-1] if lines else None

    def wait_for(self, path, **wanted):
        def fits():
            sample = self.last(path)
            return sample if sample and all(sample[key] == value for key, value in wanted.items()) else None
        return wait_until(fits, SECONDS, lambda: f"{path} is {self.last(path)}, not {wanted}")

    def test_values_follow_the_inputs_over_two_buses(self):
        self.write("line", 230, 4)
        self.write("second", 100, 1)
        self.wait_for("line/meter/power", value=920, quality="GOOD")
        self.wait_for("line/meter/running", value=True, quality="GOOD")
        self.wait_for("line/meter/total", value=1020, quality="GOOD")
        self.write("second", 100, 2)
        self.wait_for("line/meter/total", value=1120, quality="GOOD")

    def test_a_division_by_zero_is_bad_and_keeps_the_last_value(self):
        self.write("line", 230, 2)
        self.wait_for("line/meter/ratio", value=115, quality="GOOD")
        self.write("line", 230, 0)
        sample = self.wait_for("line/meter/ratio", quality="BAD_RANGE", device_code=2)
        self.assertEqual(sample["value"], 115)
        self.wait_for("line/meter/power", value=0, quality="GOOD")

    def test_a_command_for_a_calculated_channel_is_refused(self):
        for command, target in (("write", "line/meter/power=1"), ("acquire", "line/meter/power")):
            result = self.plant.cli(command, target)
            self.assertNotEqual(result.code, 0)
            self.assertIn("calculated by the bridge", result.out + result.err)

    def test_a_silent_device_makes_it_bad_until_it_responds(self):
        self.write("line", 230, 3)
        self.wait_for("line/meter/power", value=690, quality="GOOD")
        self.plant.sim.send_signal(signal.SIGSTOP)
        try:
            sample = self.wait_for("line/meter/power", quality="BAD_NO_ANSWER")
            self.assertEqual(sample["value"], 690)
            self.wait_for("line/meter/running", quality="BAD_NO_ANSWER")
            self.wait_for("line/meter/total", quality="BAD_NO_ANSWER")
        finally:
            self.plant.sim.send_signal(signal.SIGCONT)
        self.wait_for("line/meter/total", quality="GOOD")
        self.assertGreater(self.wait_for("line/meter/power", quality="GOOD")["sequence"], sample["sequence"])

    def test_a_station_shows_stores_and_alarms_it_like_any_other(self):
        text = f"store: {{ path: {self.plant.run}/station.db }}\nrecord: {{ patterns: [\"*\"] }}\n"
        with Station(self.plant, "calculating", text, "--listen", "127.0.0.1:0") as station:
            browser = Browser(station)
            self.write("line", 230, 30)

            def power():
                rows = browser.get("/api/channels?pattern=line/meter/power")
                return rows and rows[0].get("value") == 6900 and rows[0]
            row = wait_until(power, SECONDS, lambda: str(browser.get("/api/channels?pattern=line/meter/power")))
            self.assertEqual((row["quality"], row["unit"], row["access"]), ("GOOD", "W", "read-only"))
            self.assertIn("= voltage * current", browser.ask("GET", "/api/catalogue")[1])
            wait_until(lambda: any(alarm["channel"] == "power" for alarm in browser.get("/api/alarms")["alarms"]), SECONDS,
                       lambda: browser.ask("GET", "/api/alarms")[1])

            def stored():
                return browser.get("/api/history?channel=line/meter/power&from=5min")["series"][0].get("last")
            wait_until(lambda: 6900 in (stored() or []), SECONDS, lambda: str(browser.get("/api/history?channel=line/meter/power&from=5min"))[:500])

    def test_interest_in_it_reads_inputs_that_are_read_on_interest(self):
        self.wait_for("line/meter/doubled", quality="NOT_YET_READ")
        self.assertEqual(self.last("second/meter/seldom")["quality"], "NOT_YET_READ")
        interested = self.plant.start_cli("watch", "line/meter/doubled", "--refresh", "200ms", "--json", "--for", f"{SECONDS}s")
        try:
            self.wait_for("line/meter/doubled", quality="GOOD")
        finally:
            interested.kill()
            interested.wait()
        self.wait_for("second/meter/seldom", quality="UNCERTAIN")  # the interest has expired

    def test_the_plan_needs_no_wire_for_it(self):
        result = run_cli(BIN_DIR, "plan", self.plant.file)
        self.assertEqual(result.code, 0, str(result))
        self.assertIn("5 channels are calculated by the bridge; they need no wire", result.out)

    def test_z_a_reload_changes_an_expression_and_leaves_the_other_bus_alone(self):
        self.write("line", 10, 3)
        self.write("second", 5, 2)
        self.wait_for("line/meter/total", value=40, quality="GOOD")
        with open(self.plant.file, encoding="utf-8") as file:
            text = file.read()
        with open(self.plant.file, "w", encoding="utf-8") as file:
            file.write(text.replace("power + {second", "power - {second"))
        self.plant.bridge.send_signal(signal.SIGHUP)
        self.wait_for("line/meter/total", value=20, quality="GOOD")
        self.assertIn("1 bus stopped (line), 1 started (line), 1 untouched", self.plant.log("fieldcast-bridge"))


if __name__ == "__main__":
    BIN_DIR = sys.argv[1]
    unittest.main(argv=sys.argv[:1] + sys.argv[2:], verbosity=2)
