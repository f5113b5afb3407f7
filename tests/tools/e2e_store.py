"""Tests simulator, bridge and command line with a store: samples, commands, devices and alarms are
stored and shown; users are added and removed.

usage: e2e_store.py BIN_DIR
"""

import csv
import os
import subprocess
import sys
import unittest

from plant import Plant, modbus_line, run_cli, wait_until

BIN_DIR = ""

CONFIG = """
bridge: e2e
store: { path: {run}/plant.db, samples: ["line/press/t*", line/press/setpoint] }""" + modbus_line() + """\
          - { name: temperature, at: "holding:100", type: float32, unit: °C }
          - { name: setpoint, at: "holding:200", type: int16, access: read-write, limits: { high: 100, hysteresis: 10 } }
          - { name: level, at: "input-register:3", type: uint16 }
"""

plant = None


def setUpModule():
    global plant
    plant = unittest.enterModuleContext(Plant(BIN_DIR, CONFIG))


def lines(command, *arguments):
    result = plant.cli(command, *arguments, "--json")
    return result.json_lines() if result.code == 0 else []


class Store(unittest.TestCase):
    def test_samples_become_history_in_their_order(self):
        samples = wait_until(lambda: len(found := lines("history", "line/press/temperature")) >= 5 and found, 30, "no history")
        self.assertEqual({(s["bus"], s["device"], s["channel"]) for s in samples}, {("line", "press", "temperature")})
        self.assertEqual([s["sequence"] for s in samples], sorted({s["sequence"] for s in samples}))
        for sample in samples:
            self.assertGreaterEqual(sample["published_at"], sample["acquired_at"])
        # On a busy machine a late sample may have another quality.
        good = [s for s in samples if s["quality"] == "GOOD"]
        self.assertGreater(len(good), 0, samples)
        self.assertIsInstance(good[-1]["value"], float)

    def test_only_what_the_patterns_name_is_stored(self):
        wait_until(lambda: lines("history", "line/press/temperature"), 30, "no history")
        result = plant.cli("history", "line/press/level")
        self.assertEqual(result.code, 4, str(result))
        self.assertIn("the store knows no channel line/press/level", result.err)

    def test_history_is_csv_too(self):
        wait_until(lambda: lines("history", "line/press/temperature"), 30, "no history")
        result = plant.cli("history", "line/press/temperature", "--csv", "--from", "10min")
        self.assertEqual(result.code, 0, str(result))
        rows = list(csv.DictReader(result.out.splitlines()))
        self.assertEqual(rows[-1]["channel"], "temperature")
        self.assertEqual(rows[-1]["unit"], "°C")
        float(rows[-1]["value"])

    def test_history_by_the_second_counts_all_samples(self):
        wait_until(lambda: len(lines("history", "line/press/temperature")) >= 10, 30, "no history")
        seconds = lines("history", "line/press/temperature", "--every", "1s")
        self.assertGreaterEqual(sum(s["count"] + s["bad"] for s in seconds), 10)
        self.assertTrue(all(s["time"] % 1_000_000_000 == 0 for s in seconds))
        result = plant.cli("history", "line/press/temperature", "--points", "10", "--local")
        self.assertEqual(result.code, 0, str(result))
        self.assertIn("line/press/temperature (°C)", result.out)

    def test_a_time_without_samples_says_so(self):
        wait_until(lambda: lines("history", "line/press/temperature"), 30, "no history")
        result = plant.cli("history", "line", "--from", "2001-01-01", "--to", "2001-01-02")
        self.assertEqual(result.code, 4, str(result))
        self.assertIn("nothing was stored", result.err)
        self.assertEqual(plant.cli("history", "line", "--from", "yesterday").code, 2)

    def test_devices_are_known_with_their_state(self):
        def online():
            return [d for d in lines("devices") if (d["bus"], d["device"], d["state"]) == ("line", "press", "online")]
        device = wait_until(online, 30, lambda: str(lines("devices")))[0]
        self.assertEqual(device["protocol"], "modbus-rtu")
        self.assertIn("115200 8N1", device["address"])
        self.assertIn("line/press", plant.cli("devices").out)

    def test_every_command_is_in_the_audit(self):
        self.assertEqual(plant.cli("write", "line/press/setpoint=42", "--verify").code, 0)
        self.assertEqual(plant.cli("write", "line/press", "--at", "holding:1", "5").code, 5)

        def entries():
            found = {(entry["what"], entry["target"]): entry for entry in lines("audit")}
            wanted = [("write 42", "line/press/setpoint"), ("write 5", "line/press at holding:1")]
            return [found[key] for key in wanted] if all(key in found for key in wanted) else None
        done, refused = wait_until(entries, 30, lambda: str(lines("audit")))
        self.assertEqual(done["result"], "verified")
        self.assertTrue(refused["result"].startswith("rejected: "), refused)
        self.assertTrue(done["who"])

    def test_an_alarm_is_raised_kept_and_cleared(self):
        def now():
            return [(a["channel"], a["limit"], a["state"]) for a in lines("alarms")]
        # From here on the alarm is clear, whatever the initial value of the device.
        self.assertEqual(plant.cli("write", "line/press/setpoint=90").code, 0)
        wait_until(lambda: ("setpoint", "high", "active") not in now(), 30, lambda: str(now()))
        self.assertEqual(plant.cli("write", "line/press/setpoint=101").code, 0)
        wait_until(lambda: ("setpoint", "high", "active") in now(), 30, lambda: str(now()))
        self.assertIn("line/press/setpoint", plant.cli("alarms").out)
        self.assertEqual(plant.cli("write", "line/press/setpoint=95").code, 0)  # within the hysteresis
        self.assertEqual(plant.cli("acquire", "line/press/setpoint").code, 0)
        self.assertIn(("setpoint", "high", "active"), now())
        self.assertEqual(plant.cli("write", "line/press/setpoint=90").code, 0)
        wait_until(lambda: ("setpoint", "high", "clear") in now(), 30, lambda: str(now()))
        self.assertIn("no alarm is active", plant.cli("alarms").out)

        def kept():
            return [(a["state"], a["value"]) for a in lines("alarms", "--from", "1h") if "state" in a]
        wait_until(lambda: kept()[-2:] == [("active", 101.0), ("clear", 90.0)], 30, lambda: str(kept()))

    def test_users_acknowledge_shelve_and_maintain(self):
        def alarm():
            return next((a for a in lines("alarms") if a["limit"] == "high"), {})

        def becomes(wanted):
            wait_until(lambda: wanted(alarm()), 30, lambda: str(alarm()))
        self.assertEqual(plant.cli("write", "line/press/setpoint=101").code, 0)
        becomes(lambda a: a.get("stage") == "unacknowledged")
        self.assertEqual(alarm()["priority"], "medium")
        acknowledged = plant.cli("alarms", "ack", "line/press", "--limit", "high", "--note", "on my way")
        self.assertEqual((acknowledged.code, acknowledged.out), (0, "line/press/setpoint high: done\n"))
        becomes(lambda a: a.get("stage") == "acknowledged")
        me = alarm()["acknowledged_by"]
        self.assertTrue(me)
        self.assertIn(f"{me}: on my way", plant.cli("alarms").out)
        self.assertEqual(plant.cli("alarms", "ack", "line").code, 4, "there is none to acknowledge")
        self.assertEqual(plant.cli("alarms", "shelve", "line/press/setpoint", "--for", "30min").code, 0)
        becomes(lambda a: a.get("shelved_by") == me)
        self.assertIn("shelved, ", plant.cli("alarms").out)
        self.assertEqual(plant.cli("alarms", "shelve", "line", "--for", "25h").code, 5, "too long")
        self.assertEqual(plant.cli("alarms", "unshelve", "line/press").code, 0)
        becomes(lambda a: "shelved_by" not in a and a["stage"] == "unacknowledged")
        self.assertEqual(plant.cli("alarms", "maintenance", "line/press", "--for", "2h", "--note", "oil").code, 0)
        becomes(lambda a: a.get("suppressed_note") == "oil")
        self.assertEqual(plant.cli("alarms", "maintenance", "line/mill", "--for", "2h").code, 5, "no such device")
        self.assertEqual(plant.cli("alarms", "maintenance", "line/press", "--end").code, 0)
        becomes(lambda a: "suppressed_by" not in a)
        self.assertEqual(plant.cli("write", "line/press/setpoint=90").code, 0)
        becomes(lambda a: a["stage"] == "returned")
        self.assertIn("returned", plant.cli("alarms").out)
        self.assertEqual(plant.cli("alarms", "ack", "*").code, 0)
        becomes(lambda a: a["stage"] == "clear")

        def events():
            return [a["event"] for a in lines("alarms", "--from", "1h") if "state" not in a]
        wait_until(lambda: events() == ["acknowledged", "shelved", "unshelved", "maintenance", "maintenance ended",
                                        "acknowledged"], 30, lambda: str(events()))
        self.assertIn(f"maintenance by {me} until ", plant.cli("alarms", "--from", "1h").out)
        audit = [(entry["what"], entry["target"]) for entry in lines("audit")]
        self.assertIn(("acknowledge high: on my way", "line/press/setpoint"), audit)
        self.assertIn(("maintenance for 2h: oil", "line/press"), audit)


class Users(unittest.TestCase):
    def add(self, name, password, *arguments):
        return subprocess.run([os.path.join(BIN_DIR, "fieldcast"), "user", "add", name, *arguments, "--config", plant.file],
                              input=password, capture_output=True, text=True, timeout=60)

    def names(self):
        return {user["user"]: user["role"] for user in lines_of("user", "list", "--json")}

    def test_are_added_listed_and_removed(self):
        self.assertEqual(self.add("ann", "correct horse\n", "--role", "programmer").returncode, 0)
        self.assertEqual(self.names()["ann"], "programmer")
        again = self.add("ann", "another one\n")
        self.assertEqual(again.returncode, 5, again.stderr)
        self.assertEqual(plant.cli("user", "remove", "ann").code, 0)
        self.assertEqual(plant.cli("user", "remove", "ann").code, 4)
        self.assertNotIn("ann", self.names())
        audit = [(entry["what"], entry["target"], entry["result"]) for entry in lines("audit")]
        self.assertIn(("user add", "ann", "programmer"), audit)
        self.assertIn(("user remove", "ann", "done"), audit)

    def test_bad_names_passwords_and_roles_are_refused(self):
        for name, password, arguments in [("two words", "correct horse\n", ()), ("bob", "short\n", ()), ("bob", "", ()),
                                          ("bob", "correct horse\n", ("--role", "root"))]:
            with self.subTest(name=name, password=password, arguments=arguments):
                result = self.add(name, password, *arguments)
                self.assertEqual(result.returncode, 2, result.stderr)
                self.assertTrue(result.stderr)
                self.assertNotIn("bob", self.names())

    def test_no_secret_is_taken_as_an_argument(self):
        self.assertEqual(self.add("eve", "", "--password", "correct horse").returncode, 2)

    def test_a_password_comes_from_a_file(self):
        path = os.path.join(plant.run, "secret")
        with open(path, "w", encoding="utf-8") as file:
            file.write("correct horse\n")
        os.chmod(path, 0o600)
        self.assertEqual(self.add("cid", "", "--password-file", path, "--role", "operator").returncode, 0)
        self.assertEqual(self.names()["cid"], "operator")


def lines_of(*arguments):
    result = plant.cli(*arguments)
    return result.json_lines() if result.code == 0 else []


class Without(unittest.TestCase):
    def test_a_store_the_reason_is_given(self):
        for arguments in (("history", "a/b/c"), ("devices",), ("audit",), ("user", "list")):
            with self.subTest(arguments=arguments):
                result = run_cli(BIN_DIR, *arguments)
                self.assertEqual(result.code, 2, str(result))
                self.assertIn("which store?", result.err)
                missing = run_cli(BIN_DIR, *arguments, "--store", "/nonexistent/plant.db")
                self.assertEqual(missing.code, 9, str(missing))
                self.assertIn("there is no such file", missing.err)


if __name__ == "__main__":
    BIN_DIR = sys.argv[1]
    unittest.main(argv=sys.argv[:1], verbosity=2)
