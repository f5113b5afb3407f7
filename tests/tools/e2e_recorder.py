"""Tests a fieldcast-station that records two bridges: its record equals the stores of the bridges,
without duplicates and in order, also after restarts. Also tests the record over HTTP, and
tokens.

usage: e2e_recorder.py BIN_DIR
"""

import json
import os
import signal
import subprocess
import sys
import time
import unittest
import urllib.error
import urllib.request

import e2e_station
from e2e_station import Station
from plant import Plant, modbus_line, run_cli, wait_until

BIN_DIR = ""
SECONDS = 30

CONFIG = """
bridge: {bus}-bridge
store: { path: {run}/bridge.db }""" + modbus_line("{bus}", defaults="refresh: 100ms") + """\
          - { name: temperature, at: "holding:100", type: float32, unit: °C }
          - { name: speed, at: "holding:7", type: int16, access: read-write, limits: { low: 32000 } }
          - { name: order, at: "holding:20", type: string(8) }
"""

STATION = """
web: { local-role: operator }
store: { path: {run}/recorded.db }
record: { patterns: ["*"] }
"""

first = second = None


class SecondPlant(Plant):
    def __init__(self, bin_dir, config, other):
        super().__init__(bin_dir, config)
        self._claim.close()
        self.domain, self._claim = other.domain, other._claim

    def _status(self):
        result = self.cli("status", "--json")
        buses = [line for line in result.json_lines() if line["topic"] == "BusStatus"] if result.code == 0 else []
        return {bus["bus"] for bus in buses if bus["state"] == "running"} == {"east", "west"}


def setUpModule():
    global first, second
    e2e_station.BIN_DIR = BIN_DIR
    first = Plant(BIN_DIR, CONFIG.replace("{bus}", "east"))
    first.__enter__()
    second = SecondPlant(BIN_DIR, CONFIG.replace("{bus}", "west"), first)
    second.__enter__()


def tearDownModule():
    second.__exit__(None, None, None)
    first.__exit__(None, None, None)


def recorder():
    return Station(first, "recorder", STATION.replace("{run}", first.run), "--listen", "127.0.0.1:0")


def history(store, pattern):
    result = run_cli(BIN_DIR, "history", pattern, "--json", "--store", store)
    return result.json_lines() if result.code == 0 else []


def recorded(pattern):
    return history(os.path.join(first.run, "recorded.db"), pattern)


def key(sample):
    return sample["acquired_at"], sample["sequence"], sample["quality"]


def get(station, path, **headers):
    request = urllib.request.Request(station.origin + path, headers=headers)
    with urllib.request.urlopen(request, timeout=SECONDS) as response:
        return json.loads(response.read())


class Recorder(unittest.TestCase):
    def same_as_published(self, bus):
        """Compares the station's samples with the bridge's store; returns their number."""
        total = 0
        for channel in ("temperature", "speed", "order"):
            path = f"{bus}/press/{channel}"
            here = recorded(path)
            keys = [key(sample) for sample in here]
            self.assertEqual(len(keys), len(set(keys)), f"{path}: a sample is there twice")
            times = [sample["published_at"] for sample in here]
            self.assertEqual(times, sorted(times))
            there = history(os.path.join((first if bus == "east" else second).run, "bridge.db"), path)
            wanted = [key(sample) for sample in there]
            self.assertIn(keys[0], wanted)
            self.assertIn(keys[-1], wanted)
            wanted = wanted[wanted.index(keys[0]):wanted.index(keys[-1]) + 1]
            self.assertEqual(keys, wanted, path)
            values = {key(sample): sample["value"] for sample in there}
            self.assertTrue(all(values[key(sample)] == sample["value"] for sample in here))
            total += len(keys)
        return total

    def test_1_everything_of_two_bridges_is_recorded_once_and_in_order(self):
        with recorder() as station:
            wait_until(lambda: len(recorded("west/press/order")) > 30 and len(recorded("east/press/speed")) > 30, SECONDS, station.log)
        time.sleep(0.5)  # the stores of the bridges write every 250 ms
        counts = [self.same_as_published(bus) for bus in ("east", "west")]
        print(f"recorded and compared: {counts} samples")
        text = run_cli(BIN_DIR, "history", "east/press/temperature", "--store", os.path.join(first.run, "recorded.db")).out
        self.assertIn("°C", text)

    def test_2_a_bridge_and_a_station_that_restart_repeat_nothing(self):
        with recorder() as station:
            before = len(recorded("east/press/speed"))
            wait_until(lambda: len(recorded("east/press/speed")) > before + 10, SECONDS, station.log)
            first.bridge.send_signal(signal.SIGTERM)
            self.assertEqual(first.bridge.wait(SECONDS), 0)
            first.bridge = first._start("fieldcast-bridge")
            before = len(recorded("east/press/speed"))
            wait_until(lambda: len(recorded("east/press/speed")) > before + 20, SECONDS, station.log)
        for bus in ("east", "west"):
            for channel in ("temperature", "speed", "order"):
                here = recorded(f"{bus}/press/{channel}")
                keys = [key(sample) for sample in here]
                self.assertEqual(len(keys), len(set(keys)))
                times = [sample["published_at"] for sample in here]
                self.assertEqual(times, sorted(times))
        # The sequence numbers of the bridge restart, and the history continues.
        sequences = [sample["sequence"] for sample in recorded("east/press/speed")]
        self.assertTrue(any(later < earlier for earlier, later in zip(sequences, sequences[1:])))

    def test_3_an_alarm_is_recorded_with_the_user_actions(self):
        with recorder() as station:
            wait_until(lambda: [a for a in get(station, "/api/alarms")["alarms"] if a["bus"] == "east" and a["active"]], SECONDS, station.log)
            body = {"alarms": [{"bus": "east", "device": "press", "channel": "speed", "limit": "low"}], "note": "seen"}
            request = urllib.request.Request(station.origin + "/api/alarms/acknowledge", json.dumps(body).encode(),
                                             {"Content-Type": "application/json", "Origin": station.origin})
            with urllib.request.urlopen(request, timeout=SECONDS) as response:
                answer = json.loads(response.read())
            wait_until(lambda: get(station, f"/api/commands/result?request_id={answer['request_id']}")["state"] == "done", SECONDS, station.log)

            def events():
                found = {event["event"]: event for event in get(station, "/api/alarms?from=1h")["events"]}
                return found if {"raised", "acknowledged"} <= set(found) else None
            found = wait_until(events, SECONDS, lambda: str(get(station, "/api/alarms?from=1h")))
            self.assertEqual(found["acknowledged"]["note"], "seen")
            self.assertEqual(found["raised"]["limit"], "low")

    def test_4_history_plan_export_and_metrics_come_over_http(self):
        with recorder() as station:
            series = get(station, "/api/history?channel=east/press/speed&channel=west/press/order&from=1h")["series"]
            self.assertTrue(series[0]["t"])
            self.assertEqual(series[1]["type"], "string")
            plan = wait_until(lambda: [p for p in get(station, "/api/plan") if p["bus"] == "east"], SECONDS, station.log)[0]
            self.assertIn("speed", [name for group in plan["groups"] for point in group["points"] for name in point["channels"]])
            with urllib.request.urlopen(station.origin + "/metrics", timeout=SECONDS) as response:
                self.assertIn("fieldcast_station_recorded_samples_total", response.read().decode())
            with urllib.request.urlopen(station.origin + "/api/export?pattern=east&from=1h", timeout=SECONDS) as response:
                lines = response.read().decode().splitlines()
            self.assertEqual(lines[0], "published_at,acquired_at,bus,device,channel,value,unit,quality")
            self.assertGreater(len(lines), 90)

    def test_5_a_token_lets_in_until_it_is_removed(self):
        store = os.path.join(first.run, "recorded.db")
        token = run_cli(BIN_DIR, "token", "add", "wall", "--days", "1", "--store", store).out.strip()
        subprocess.run([os.path.join(BIN_DIR, "fieldcast"), "user", "add", "anna", "--store", store], input="a long password\n", text=True,
                       check=True, capture_output=True)
        text = STATION.replace("{run}", first.run).replace("web: { local-role: operator }", "")
        with Station(first, "recorder", text, "--listen", "127.0.0.1:0") as station:
            def log_in(secret):
                request = urllib.request.Request(station.origin + "/api/login", json.dumps({"token": secret}).encode(),
                                                 {"Content-Type": "application/json", "Origin": station.origin})
                with urllib.request.urlopen(request, timeout=SECONDS) as response:
                    return response.headers["set-cookie"].split(";")[0], json.loads(response.read())
            with self.assertRaises(urllib.error.HTTPError) as refused:
                log_in("fct_" + 43 * "A")
            self.assertEqual(refused.exception.code, 401)
            cookie, answer = log_in(token)
            self.assertEqual((answer["user"], answer["role"]), ("wall", "viewer"))
            self.assertEqual(get(station, "/api/me", Cookie=cookie)["login"], "token")
            self.assertEqual(run_cli(BIN_DIR, "token", "remove", "wall", "--store", store).code, 0)
            wait_until(lambda: get(station, "/api/me", Cookie=cookie)["login"] == "required", SECONDS, "the login goes on")
            self.assertNotIn("fct_", station.log())


if __name__ == "__main__":
    BIN_DIR = os.path.abspath(sys.argv[1])
    unittest.main(argv=sys.argv[:1], verbosity=2)
