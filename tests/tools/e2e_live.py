"""Tests that actions on a page of fieldcast-station reach the plant with the name of the user, and
that losses of the plant are shown immediately.

usage: e2e_live.py BIN_DIR
"""

import os
import signal
import sys
import unittest

import e2e_station
from e2e_station import SECONDS, Browser, Socket, Station, is_kind
from plant import Plant, modbus_line, run_cli, wait_until

GOOD, UNCERTAIN = 0, 1
PASSWORD = "correct-horse"

CONFIG = """
bridge: e2e
store: { path: {run}/bridge.db, samples: [] }""" + modbus_line() + """\
          - { name: speed, at: "holding:7", type: int16, access: read-write, limits: { high: 100 } }
"""


class Live(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.plant = Plant(e2e_station.BIN_DIR, CONFIG)
        cls.plant.__enter__()
        cls.addClassCleanup(lambda: cls.plant.__exit__(None, None, None))

    def setUp(self):
        self.store = os.path.join(self.plant.run, self.id().split(".")[-1] + ".db")
        self.station = Station(self.plant, "wall", f"store: {{ path: {self.store} }}\n", "--listen", "127.0.0.1:0")
        self.station.__enter__()
        self.addCleanup(lambda: self.station.__exit__(None, None, None))
        added = run_cli(e2e_station.BIN_DIR, "user", "add", "anna", "--role", "operator", "--store", self.store, stdin=PASSWORD + "\n")
        self.assertEqual(added.code, 0, str(added))
        self.anna = Browser(self.station)
        wait_until(lambda: self.anna.log_in("anna", PASSWORD) == 200, SECONDS, "anna cannot log in")
        wait_until(lambda: self.anna.get("/api/catalogue")["channels"], SECONDS, "no channel came")
        self.live = Socket(self.anna)
        self.addCleanup(self.live.socket.close)
        self.live.send({"subscribe": "*"})

    def audit_of(self, store, target):
        """Returns the audit rows of this target; a batch may not be in the file yet."""
        def lines():
            return [line for line in run_cli(e2e_station.BIN_DIR, "audit", "--store", store).out.splitlines() if target in line]
        return wait_until(lines, SECONDS, f"nothing of {target} in {store}")

    def write(self, value, number):
        self.live.send({"write": {"channel": "line/press/speed", "value": value, "verify": True}, "id": number})
        result = self.live.until(lambda message: is_kind("result")(message) and message.get("id") == number)
        self.assertEqual(result["state"], "verified", result)

    def until_quality(self, wanted):
        return self.live.until(lambda message: isinstance(message, list) and any(quality == wanted for _, _, quality in message))[0]

    def test_a_write_is_audited_under_its_person_by_bridge_and_station(self):
        self.write(42, 7)
        by_bridge = self.audit_of(os.path.join(self.plant.run, "bridge.db"), "line/press/speed")
        self.assertRegex(by_bridge[-1], r"wall:\d+:\d+/anna  write 42")
        by_station = self.audit_of(self.store, "line/press/speed")
        self.assertRegex(by_station[-1], r"anna from 127\.0\.0\.1  write 42 line/press/speed  verified")

    def test_an_alarm_is_acknowledged_under_its_person(self):
        self.write(150, 1)
        alarm = self.live.until(lambda message: is_kind("alarm")(message) and message["state"] == "unacknowledged")
        key = {name: alarm[name] for name in ("bus", "device", "channel", "limit")}
        status, text = self.anna.ask("POST", "/api/alarms/acknowledge", {"alarms": [key], "note": "the fan is ordered"})
        self.assertEqual(status, 202, text)
        alarm = self.live.until(lambda message: is_kind("alarm")(message) and message["state"] == "acknowledged")
        self.assertEqual((alarm["acknowledged_by"], alarm["note"]), ("anna", "the fan is ordered"))
        self.write(20, 2)
        self.live.until(lambda message: is_kind("alarm")(message) and message["state"] == "clear")

    def test_when_the_bridge_dies_its_values_are_uncertain_and_come_back_under_their_ids(self):
        before = self.until_quality(GOOD)
        self.plant.bridge.send_signal(signal.SIGKILL)
        self.plant.bridge.wait()
        lost = self.until_quality(UNCERTAIN)
        self.assertEqual(lost[:2], before[:2], "the last value stays")
        self.plant.bridge = self.plant._start("fieldcast-bridge")
        self.assertEqual(self.until_quality(GOOD)[0], before[0])


if __name__ == "__main__":
    e2e_station.BIN_DIR = sys.argv[1]
    unittest.main(argv=sys.argv[:1], verbosity=2)
