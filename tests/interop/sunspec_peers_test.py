"""SunSpec models in a device made of pymodbus: `fieldcast scan` finds them, and the bridge reads right values with the file that it writes.

usage: sunspec_peers_test.py BIN_FOLDER
"""

import contextlib
import json
import os
import subprocess
import sys
import tempfile
import time
import unittest

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "tools"))
from peers import DEADLINE, Program, SerialCable, free_port
from plant import claim_domain, running_bridge, wait_until

BIN = ""
PYMODBUS = os.path.join(os.path.dirname(os.path.abspath(__file__)), "pymodbus_server.py")
MARKER = [0x5375, 0x6E53]
NONE_SIGNED, NONE_UNSIGNED = 0x8000, 0xFFFF


def exponent(number):
    return number & 0xFFFF


def text(string, registers):
    data = string.encode().ljust(2 * registers, b"\0")
    return [data[i] << 8 | data[i + 1] for i in range(0, len(data), 2)]


def common():
    return [1, 66] + text("Maker", 16) + text("Model 7", 16) + text("", 8) + text("1.2", 8) + text("S-42", 16) + [1, 0x8000]


def inverter():
    """Model 103, by the offsets of its definition."""
    model = [103, 50] + [0] * 50
    model[2:7] = [1234, 411, 412, NONE_UNSIGNED, exponent(-2)]
    model[10:14] = [2301, 2302, 2303, exponent(-1)]
    model[14:16] = [(-5000) & 0xFFFF, exponent(1)]
    model[16:18] = [50012, exponent(-3)]
    model[18:20] = [77, NONE_SIGNED]  # an exponent that is not implemented
    model[24:27] = [0x0012, 0xD687, exponent(0)]
    model[33:38] = [415, NONE_SIGNED, NONE_SIGNED, NONE_SIGNED, exponent(-1)]
    model[38] = 4
    return model


def meter():
    """Model 203, by the offsets of its definition."""
    model = [203, 105] + [0] * 105
    model[2:7] = [(-250) & 0xFFFF, 0, 0, 0, exponent(-1)]
    model[46:48], model[54] = [0, 10000], exponent(3)
    return model


class Device(contextlib.ExitStack):
    """A pymodbus device with these holding registers: {first: values}."""

    def __init__(self, registers, *place):
        super().__init__()
        self.registers, self.place = registers, place

    def __enter__(self):
        super().__enter__()
        folder = self.enter_context(tempfile.TemporaryDirectory(prefix="fieldcast-sunspec-"))
        path = os.path.join(folder, "registers.json")
        with open(path, "w", encoding="utf-8") as file:
            json.dump(self.registers, file)
        self.enter_context(Program(sys.executable, PYMODBUS, *self.place, "--registers", path)).wait_ready()
        return self


def scan(*words):
    began = time.monotonic()
    done = subprocess.run([os.path.join(BIN, "fieldcast"), "scan", *(str(word) for word in words)], capture_output=True, text=True,
                          timeout=DEADLINE)
    return done, time.monotonic() - began


class SunSpecTest(unittest.TestCase):
    def scanned(self, registers):
        """The JSON of the one device that a scan finds."""
        port = free_port()
        with Device(registers, "tcp", port):
            done, _ = scan(f"127.0.0.1:{port}", "--addresses", 1, "--json")
        self.assertEqual(done.returncode, 0, done.stderr)
        return json.loads(done.stdout)

    def test_models_at_each_base(self):
        for base in (40000, 50000, 0):
            found = self.scanned({base: MARKER + common() + inverter() + meter() + [0xFFFF, 0]})["sunspec"]
            self.assertEqual({key: value for key, value in found.items() if key != "models"},
                             {"base": base, "manufacturer": "Maker", "model": "Model 7", "version": "1.2", "serial_number": "S-42",
                              "incomplete": ""})
            self.assertEqual(found["models"], [{"number": 1, "at": base + 2, "length": 66}, {"number": 103, "at": base + 70, "length": 50},
                                               {"number": 203, "at": base + 122, "length": 105}])

    def test_a_device_without_models_has_none(self):
        self.assertNotIn("sunspec", self.scanned({0: [1, 2, 3], 40000: [0x5375, 0, 0]}))

    def test_models_without_end_and_lengths_beyond_the_registers(self):
        found = self.scanned({0: MARKER + [103, 0] * 1000})["sunspec"]
        self.assertEqual((len(found["models"]), found["incomplete"]), (64, "there are more than 64 models"))
        found = self.scanned({0: MARKER + common() + [103, 65535]})["sunspec"]
        self.assertEqual(len(found["models"]), 1)
        self.assertIn("a length of 65535 registers", found["incomplete"])
        found = self.scanned({0: MARKER + common()})["sunspec"]  # no end
        self.assertIn("the header at holding:70 cannot be read", found["incomplete"])

    def test_the_bridge_reads_right_values_with_the_file_of_the_scan(self):
        with contextlib.ExitStack() as stack:
            folder = stack.enter_context(tempfile.TemporaryDirectory(prefix="fieldcast-sunspec-"))
            domain, claim = claim_domain()
            stack.enter_context(claim)
            cable = stack.enter_context(SerialCable())
            stack.enter_context(Device({40000: MARKER + common() + inverter() + meter() + [0xFFFF, 0]}, "rtu", cable.right, 19200, 3))
            file = os.path.join(folder, "scan.yaml")
            done, _ = scan(cable.left, "--baud", 19200, "--format", "8N1", "--addresses", 3, "--out", file)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertIn("Maker, Model 7, 1.2, serial number S-42", done.stdout)
            self.assertIn("SunSpec models from holding:40000 on: 1 (common), 103 (inverter, three phases), 203 (meter, ", done.stdout)
            with open(file, encoding="utf-8") as written:
                configuration = written.read()
            with open(file, "w", encoding="utf-8") as changed:
                changed.write(configuration.replace("domain: 0", f"domain: {domain}"))
            expected = {"inverter-ac-current": 12.34, "inverter-ac-current-l2": 4.12, "inverter-ac-current-l3": "BAD_RANGE",
                        "inverter-ac-voltage-l1": 230.1, "inverter-ac-power": -50000.0, "inverter-frequency": 50.012,
                        "inverter-apparent-power": "BAD_RANGE", "inverter-energy": 1234567.0, "inverter-cabinet-temperature": 41.5,
                        "inverter-heatsink-temperature": "BAD_RANGE", "inverter-state": 4,
                        "meter-current": -25.0, "meter-energy-import": 10000000.0}
            seen = {}

            def as_expected():
                watched = subprocess.run([os.path.join(BIN, "fieldcast"), "watch", "--json", "--once", "--config", file],
                                         capture_output=True, text=True, timeout=DEADLINE)
                for sample in map(json.loads, watched.stdout.splitlines()):
                    seen[sample["channel"]] = sample["value"] if sample["quality"] == "GOOD" else sample["quality"]
                return {name: seen.get(name) for name in expected} == expected

            with running_bridge(BIN, file, os.path.join(folder, "bridge.log")):
                wait_until(as_expected, DEADLINE, lambda: str({name: seen.get(name) for name in expected}))


if __name__ == "__main__":
    BIN = sys.argv.pop()
    unittest.main()
