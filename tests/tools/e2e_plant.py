"""Tests simulator, bridge and command line together: values, commands, and refusals with their
reasons.

usage: e2e_plant.py BIN_DIR
"""

import json
import signal
import subprocess
import sys
import time
import unittest

from plant import Plant, wait_until

BIN_DIR = ""

CONFIG = """
bridge: e2e
buses:
  - name: fast
    port: { serial: {run}/fast, baud: 115200, format: 8N1 }
    protocol: modbus-rtu
    defaults: { refresh: 500ms, timeout: 1s }
    devices:
      - name: press
        address: 1
        allow: [raw-read, raw-write]
        channels:
          - { name: temperature, at: "holding:100", type: float32, unit: °C, refresh: 200ms }
          - { name: level, at: "input-register:3", type: uint16 }
          - { name: setpoint, at: "holding:200", type: int16, access: read-write, write: { min: -100, max: 1000 } }
          - { name: speed, at: "holding:210", type: uint16, scale: 0.1, unit: rpm, access: read-write }
          - { name: energy, at: "holding:220", type: uint64, access: read-write }
          - { name: power, at: "holding:230", type: int16, exponent-from: "holding:232", unit: W, limits: { low: 900, high: 1100 } }
          - { name: current, at: "holding:231", type: uint16, exponent-from: "holding:232", unit: A }
          - { name: running, at: "coil:3", type: bool, access: read-write }
          - { name: article, at: "holding:310", type: uint16, acquire: on-interest }
          - { name: batch, at: "holding:320", type: uint16, acquire: on-interest }
          - { name: label, at: "holding:300", type: string(8), access: read-write }
  - name: slow
    port: { serial: {run}/slow, baud: 9600, format: 8E1 }
    protocol: modbus-ascii
    defaults: { timeout: 1s }
    devices:
      - name: meter
        address: 7
        channels:
          - { name: voltage, at: "holding:0", type: float32, unit: V }
          - { name: counts, at: "holding:10", type: int32 }
"""
CHANNELS = {"fast/press/" + name for name in ("temperature", "level", "setpoint", "speed", "energy", "power", "current", "running", "article", "batch", "label")}
CHANNELS |= {"slow/meter/voltage", "slow/meter/counts"}
# read only while a station is interested
WANTED, NEVER_WANTED = "fast/press/article", "fast/press/batch"

plant = None


def setUpModule():
    global plant
    plant = unittest.enterModuleContext(Plant(BIN_DIR, CONFIG))


def path_of(sample):
    return "/".join((sample["bus"], sample["device"], sample["channel"]))


class Watch(unittest.TestCase):
    def once(self, *arguments):
        result = plant.cli("watch", "--json", "--once", *arguments)
        self.assertEqual(result.code, 0, str(result))
        return {path_of(sample): sample for sample in result.json_lines()}

    def test_every_channel_is_there_with_its_kind_of_value(self):
        samples = self.once()
        self.assertEqual(set(samples), CHANNELS)
        self.assertIsNone(samples.pop(NEVER_WANTED)["value"])
        samples.pop(WANTED)  # from another test
        self.assertIsInstance(samples["fast/press/running"]["value"], bool)
        for name, low, high in (("power", 900, 1100), ("current", 0, 100)):  # with the exponent -1 of the simulator
            value = samples["fast/press/" + name]["value"]
            self.assertIsInstance(value, float)
            self.assertTrue(low <= value <= high, value)
            self.assertAlmostEqual(value * 10, round(value * 10), places=9)
        self.assertIsInstance(samples["fast/press/level"]["value"], int)
        self.assertIsInstance(samples["fast/press/temperature"]["value"], float)
        self.assertIsInstance(samples["fast/press/label"]["value"], str)
        for sample in samples.values():
            self.assertLess(abs(time.time_ns() - sample["acquired_at"]), 30e9)
            self.assertGreater(sample["sequence"], 0)

    def test_every_channel_is_good(self):
        expected = {**dict.fromkeys(CHANNELS - {WANTED}, "GOOD"), NEVER_WANTED: "NOT_YET_READ"}

        def qualities():
            return {path: sample["quality"] for path, sample in self.once().items() if path != WANTED}
        # On a busy machine the bus may miss a refresh and report it.
        wait_until(lambda: qualities() == expected, 30, lambda: str(qualities()))

    def test_a_pattern_selects(self):
        self.assertEqual(set(self.once("slow")), {"slow/meter/voltage", "slow/meter/counts"})
        self.assertEqual(set(self.once("*/press/s*")), {"fast/press/setpoint", "fast/press/speed"})

    def test_a_pattern_of_nothing_says_so(self):
        result = plant.cli("watch", "nowhere", "--once")
        self.assertEqual(result.code, 4, str(result))
        self.assertIn("none of its channels matches nowhere/*/*", result.err)

    def stream(self, *arguments, **options):
        """A watch that prints JSON lines for at most a minute."""
        process = plant.start_cli("watch", *arguments, "--json", "--for", "60s", **options)
        self.addCleanup(process.communicate)
        self.addCleanup(process.terminate)
        return process

    def test_samples_keep_coming_in_their_order(self):
        stream = self.stream("fast/press/temperature").stdout
        samples = []
        while sum(sample["quality"] == "GOOD" for sample in samples) < 10:
            samples.append(json.loads(stream.readline()))
        sequences = [sample["sequence"] for sample in samples]
        self.assertEqual(sequences, sorted(set(sequences)))

    def test_an_interest_is_granted_while_it_lasts(self):
        stream = self.stream(WANTED, "--refresh", "200ms").stdout
        good = 0
        while good < 5:
            good += json.loads(stream.readline())["quality"] == "GOOD"

    def test_an_interest_in_what_is_read_anyway_or_for_nothing_says_so(self):
        process = plant.start_cli("watch", "fast/press/temperature", "--refresh", "1ms", "--json", "--for", "3s", stderr=subprocess.PIPE)
        self.assertIn("changes nothing for 1 of 1 channels: 1 are read anyway", process.communicate(timeout=30)[1])
        process = plant.start_cli("watch", "nowhere", "--refresh", "200ms", "--json", "--for", "3s", stderr=subprocess.PIPE)
        self.assertIn("the interest in nowhere/*/* meets nothing", process.communicate(timeout=30)[1])

    def test_a_closed_output_ends_it(self):
        process = plant.start_cli("watch", "--json", "--for", "60s", stderr=subprocess.DEVNULL)
        self.addCleanup(process.wait)
        self.addCleanup(process.terminate)
        self.assertTrue(process.stdout.readline())
        process.stdout.close()
        self.assertEqual(process.wait(timeout=20), 9)

    def test_the_channels_of_a_killed_bridge_are_gone(self):
        stream = self.stream("fast/press/level", stderr=subprocess.DEVNULL).stdout
        self.assertEqual(json.loads(stream.readline())["channel"], "level")
        plant.bridge.kill()
        plant.bridge.wait()
        self.addCleanup(plant.kill_bridge)  # starts it again
        event = next(line for line in map(json.loads, stream) if "event" in line)
        self.assertEqual(event, {"event": "no_bridge", "bus": "fast", "device": "press", "channel": "level"})

    def test_control_c_ends_it_immediately(self):
        process = self.stream(stderr=subprocess.PIPE)
        self.assertTrue(process.stdout.readline())
        process.send_signal(signal.SIGINT)
        _, err = process.communicate(timeout=20)
        self.assertEqual(process.returncode, 130, err)
        self.assertIn("of them GOOD", err)

    def test_control_c_ends_the_status_of_a_time(self):
        process = plant.start_cli("status", "--json", "--for", "60s", stderr=subprocess.PIPE)
        self.addCleanup(process.wait)
        self.addCleanup(process.terminate)
        self.assertTrue(process.stdout.readline())
        process.send_signal(signal.SIGINT)
        _, err = process.communicate(timeout=20)
        self.assertEqual(process.returncode, 130, err)


class Write(unittest.TestCase):
    def write(self, *arguments):
        return plant.cli("write", *arguments, "--json")

    def acquired(self, channel):
        result = plant.cli("acquire", channel, "--json")
        self.assertEqual(result.code, 0, str(result))
        return result.json_lines()[0]["values"]

    def test_a_verified_write_is_what_the_device_then_holds(self):
        for channel, text, value in [("setpoint", "-42", -42), ("speed", "12.5", 12.5), ("energy", "18446744073709551615", 2**64 - 1),
                                     ("running", "true", True), ("running", "off", False), ("label", "line 7", "line 7")]:
            with self.subTest(channel=channel, text=text):
                result = self.write(f"fast/press/{channel}={text}", "--verify")
                self.assertEqual(result.code, 0, str(result))
                line = result.json_lines()[0]
                self.assertEqual((line["state"], line["cause"]), ("verified", "NONE"))
                self.assertEqual(self.acquired(f"fast/press/{channel}"), [value])

    def test_a_written_value_is_published(self):
        self.assertEqual(self.write("fast/press/setpoint=77").code, 0)

        def seen():
            samples = plant.cli("watch", "fast/press/setpoint", "--json", "--once").json_lines()
            return [(sample["value"], sample["quality"]) for sample in samples] == [(77, "GOOD")]
        wait_until(seen, 10, "the value written was never published")

    def test_several_assignments_each_have_their_result(self):
        result = self.write("fast/press/setpoint=5", "fast/press/running=1")
        self.assertEqual(result.code, 0, str(result))
        self.assertEqual({line["target"]: line["state"] for line in result.json_lines()}, {"setpoint": "done", "running": "done"})

    def test_refusals_give_reason_and_exit_code(self):
        for assignment, cause in [("fast/press/temperature=5", "READ_ONLY"), ("fast/press/setpoint=1001", "RANGE"),
                                  ("fast/press/setpoint=70000", "RANGE"), ("fast/press/setpoint=warm", "WRONG_TYPE"),
                                  ("fast/press/setpoint=1.5", "WRONG_TYPE"), ("fast/press/running=maybe", "WRONG_TYPE"),
                                  ("fast/press/setpint=5", "UNKNOWN_CHANNEL"), ("fast/pres/setpoint=5", "UNKNOWN_CHANNEL"),
                                  ("fst/press/setpoint=5", "UNKNOWN_CHANNEL")]:
            with self.subTest(assignment=assignment):
                result = self.write(assignment)
                self.assertEqual(result.code, 5, str(result))
                line = result.json_lines()[0]
                self.assertEqual((line["state"], line["cause"]), ("rejected", cause))
                self.assertTrue(line["reason"], "a refusal without a reason")

    def test_one_refused_assignment_holds_back_the_others(self):
        self.assertEqual(self.write("fast/press/setpoint=11").code, 0)
        result = self.write("fast/press/setpoint=12", "fast/press/nothing=1")
        self.assertEqual(result.code, 5, str(result))
        self.assertEqual(self.acquired("fast/press/setpoint"), [11])

    def test_an_unknown_channel_is_refused_with_what_was_meant(self):
        result = plant.cli("write", "fast/press/setpint=5")
        self.assertEqual(result.code, 5, str(result))
        self.assertIn("did you mean setpoint?", result.err)

    def test_addresses_of_a_device_that_allows_it(self):
        result = self.write("fast/press", "--at", "holding:400", "--type", "int16", "-1", "2", "3")
        self.assertEqual(result.code, 0, str(result))
        result = plant.cli("acquire", "fast/press", "--at", "holding:400", "--count", "3", "--type", "int16", "--json")
        self.assertEqual(result.code, 0, str(result))
        self.assertEqual(result.json_lines()[0]["values"], [-1, 2, 3])

    def test_addresses_of_a_device_that_does_not(self):
        result = self.write("slow/meter", "--at", "holding:5", "1")
        self.assertEqual((result.code, result.json_lines()[0]["cause"]), (5, "RAW_NOT_ALLOWED"), str(result))


class Acquire(unittest.TestCase):
    def test_a_device_is_read_channel_by_channel(self):
        result = plant.cli("acquire", "slow/meter", "--json")
        self.assertEqual(result.code, 0, str(result))
        self.assertEqual({line["target"] for line in result.json_lines()}, {"voltage", "counts"})
        for line in result.json_lines():
            self.assertEqual((line["state"], len(line["values"])), ("done", 1))

    def test_refusals_give_reason_and_exit_code(self):
        for arguments, cause in [(("fast/press/nothing",), "UNKNOWN_CHANNEL"), (("fast/press", "--at", "holdin:1"), "BAD_ADDRESS"),
                                 (("slow/meter", "--at", "holding:1"), "RAW_NOT_ALLOWED")]:
            with self.subTest(arguments=arguments):
                result = plant.cli("acquire", *arguments, "--json")
                self.assertEqual(result.code, 5, str(result))
                self.assertEqual(result.json_lines()[0]["cause"], cause)
                self.assertTrue(result.json_lines()[0]["reason"])


class Status(unittest.TestCase):
    def test_every_bus_and_device_is_there(self):
        def statuses():
            result = plant.cli("status", "--json")
            self.assertEqual(result.code, 0, str(result))
            lines = result.json_lines()
            return ({line["bus"]: line for line in lines if line["topic"] == "BusStatus"},
                    {line["bus"] + "/" + line["device"]: line for line in lines if line["topic"] == "DeviceStatus"})

        # On a busy machine a device with a late response is degraded until its next response.
        wait_until(lambda: {device["state"] for device in statuses()[1].values()} == {"online"}, 30, lambda: str(statuses()[1]))
        buses, devices = statuses()
        self.assertEqual(set(buses), {"fast", "slow"})
        self.assertEqual(set(devices), {"fast/press", "slow/meter"})
        for bus in buses.values():
            self.assertEqual(bus["state"], "running")
            self.assertGreater(bus["samples"], 0)
            self.assertTrue(0 <= bus["utilisation"] <= 1, bus)
        for device in devices.values():
            self.assertGreater(device["answer_time"], 0)

    def test_users_get_a_table(self):
        result = plant.cli("status")
        self.assertEqual(result.code, 0, str(result))
        self.assertIn("fast/press", result.out)
        self.assertIn("online", result.out)


class RawOnly(unittest.TestCase):
    """A bridge without channels: the catalogue is empty, but commands to addresses work."""

    CONFIG = """
bridge: raw
buses:
  - name: line
    port: { serial: {run}/line, baud: 115200, format: 8N1 }
    protocol: modbus-rtu
    devices:
      - { name: meter, address: 1, allow: [raw-read, raw-write] }
"""

    def test_addresses_are_read_and_written(self):
        with Plant(BIN_DIR, self.CONFIG) as raw:
            result = raw.cli("write", "line/meter", "--at", "coil:16", "true", "--json")
            self.assertEqual((result.code, result.json_lines()[0]["state"]), (0, "done"), str(result))
            result = raw.cli("acquire", "line/meter", "--at", "coil:16", "--json")
            self.assertEqual((result.code, result.json_lines()[0]["values"]), (0, [True]), str(result))
            result = raw.cli("acquire", "line/meter/speed")
            self.assertEqual(result.code, 5, str(result))
            self.assertIn("device 'meter' has no channels; --at ADDRESS", result.err)
            result = raw.cli("acquire", "line/metre", "--at", "coil:16")
            self.assertEqual(result.code, 5, str(result))
            self.assertIn("bus 'line' has no device 'metre'", result.err)
            result = raw.cli("acquire", "lime/meter", "--at", "coil:16")
            self.assertEqual(result.code, 5, str(result))
            self.assertIn("did you mean line?", result.err)


if __name__ == "__main__":
    BIN_DIR = sys.argv[1]
    unittest.main(argv=sys.argv[:1], verbosity=2)
