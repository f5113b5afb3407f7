"""Tests the demo plant end to end: for every family, values are GOOD, a write is verified, and an
address without a channel is read in the PLC's notation.

usage: e2e_families.py BIN_DIR SOURCE_DIR
"""

import os
import re
import sys
import unittest

from plant import Plant, wait_until

BIN_DIR, SOURCE_DIR = "", ""

# A channel to write, its value, and an address without a channel.
WRITES = {
    "s7-ppi": ("packing/packer/seal-setpoint=150.5", "packing/packer", "VW300"),
    "omron-hostlink": ("assembly/robot/speed=55", "assembly/robot", "DM900"),
    "omron-hostlink, fins": ("assembly/press-fit/force-limit=12.5", "assembly/press-fit", "DM900"),
    "mitsubishi-fx": ("lift/lift-1/target=7", "lift/lift-1", "D700"),
    "dtc": ("mixer/mixer-1/speed=120", "mixer/mixer-1", "int16:900"),
    "s7-freeport": ("yard/gate/open=true", "yard/gate", "window:2"),
    "instrument": ("yard/gauge/outputs=9", "yard/gauge", "unit"),
    "modbus-rtu": ("yard/fan/frequency=32.5", "yard/fan", "holding:900"),
}
BITS = ["packing/packer/running=true", "assembly/press-fit/clamp=true", "lift/lift-1/light=true", "mixer/mixer-1/valve=true"]

ON_DEMAND = {"serial-number"}  # of the energy meter: read on demand only

plant = None


def setUpModule():
    global plant
    with open(os.path.join(SOURCE_DIR, "config/examples/demo.yaml"), encoding="utf-8") as file:
        text = re.sub(r"(?m)^dds:.*$", "", file.read()).replace("/tmp/fieldcast-demo", "{run}").replace("[raw-read]", "[raw-read, raw-write]")
    plant = Plant(BIN_DIR, text)
    plant.__enter__()


def tearDownModule():
    plant.__exit__(None, None, None)


class Families(unittest.TestCase):
    def test_every_channel_is_good(self):
        def samples():
            result = plant.cli("watch", "--json", "--once")
            self.assertEqual(result.code, 0, str(result))
            return result.json_lines()

        def bad():
            return [sample for sample in samples() if sample["quality"] != "GOOD" and sample["channel"] not in ON_DEMAND]

        wait_until(lambda: not bad(), 30, lambda: f"every channel GOOD; {bad()}")
        self.assertEqual(len({sample["bus"] for sample in samples()}), 7)

    def test_writes_are_verified(self):
        for family, (assignment, _, _) in WRITES.items():
            with self.subTest(family=family):
                result = plant.cli("write", assignment, "--verify", "--json")
                self.assertEqual(result.code, 0, str(result))
                self.assertEqual([line["state"] for line in result.json_lines()], ["verified"], str(result))
        for assignment in BITS:
            with self.subTest(assignment=assignment):
                result = plant.cli("write", assignment, "--verify", "--json")
                self.assertEqual([line["state"] for line in result.json_lines()], ["verified"], str(result))

    def test_a_write_without_verification_is_done(self):
        result = plant.cli("write", "packing/packer/seal-setpoint=151", "--json")
        self.assertEqual([line["state"] for line in result.json_lines()], ["done"], str(result))

    def test_addresses_are_read_in_the_notation_of_the_plc(self):
        for family, (_, device, address) in WRITES.items():
            with self.subTest(family=family):
                result = plant.cli("acquire", device, "--at", address, "--json")
                self.assertEqual(result.code, 0, str(result))
                lines = result.json_lines()
                self.assertEqual([line["state"] for line in lines], ["done"], str(result))
                self.assertEqual(len(lines[0]["values"]), 1, str(result))

    def test_a_write_to_an_address_has_the_type_that_the_address_implies(self):
        for device, address, value, type_name in [("mixer/mixer-1", "float32:900", "21", "float32"), ("mixer/mixer-1", "float64:900", "21.5", "float64"),
                                                  ("mixer/mixer-1", "int32:900", "99999", "int32"), ("mixer/mixer-1", "int16:901", "-1", "int16"),
                                                  ("lift/lift-1", "C200", "-70000", "int32")]:
            with self.subTest(address=address):
                result = plant.cli("write", device, "--at", address, value, "--verify", "--json")
                self.assertEqual(result.code, 0, str(result))
                self.assertEqual([line["state"] for line in result.json_lines()], ["verified"], str(result))
                result = plant.cli("acquire", device, "--at", address, "--type", type_name, "--json")
                self.assertEqual(result.json_lines()[0]["values"], [float(value)], str(result))
                result = plant.cli("acquire", device, "--at", address, "--json")
                self.assertEqual(result.json_lines()[0]["values"], [float(value)], str(result))

    def test_a_type_that_the_channels_do_not_state_is_asked_for(self):
        result = plant.cli("write", "assembly/robot", "--at", "T5", "100")
        self.assertEqual(result.code, 2, str(result))
        self.assertIn("say --type", result.err)


if __name__ == "__main__":
    BIN_DIR, SOURCE_DIR = sys.argv[1], sys.argv[2]
    unittest.main(argv=sys.argv[:1], verbosity=2)
