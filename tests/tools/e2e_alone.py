"""Tests the programs without a plant: missing peers, bad files, plans and frames.

usage: e2e_alone.py BIN_DIR
"""

import os
import subprocess
import sys
import tempfile
import unittest

from plant import claim_domain, run_cli

BIN_DIR = ""

PLAN = """
bridge: plan
buses:
  - name: line
    port: { serial: /dev/ttyUSB0, baud: 9600, format: 8E1 }
    protocol: modbus-rtu
    devices:
      - name: meter
        address: 1
        channels:
          - { name: a, at: "holding:0", type: uint16, refresh: REFRESH }
          - { name: b, at: "holding:4000", type: uint16, refresh: REFRESH }
"""


class File:
    def __init__(self, text):
        self.text = text

    def __enter__(self):
        self.folder = tempfile.TemporaryDirectory(prefix="fieldcast-e2e-")
        path = os.path.join(self.folder.name, "plant.yaml")
        with open(path, "w", encoding="utf-8") as file:
            file.write(self.text)
        return path

    def __exit__(self, *_):
        self.folder.cleanup()


class NobodyThere(unittest.TestCase):
    def setUp(self):
        self.domain, claim = claim_domain()
        self.addCleanup(claim.close)

    def test_each_command_says_what_to_look_at(self):
        for arguments in [("watch", "--once"), ("write", "a/b/c=1"), ("acquire", "a/b"), ("status",)]:
            with self.subTest(arguments=arguments):
                result = run_cli(BIN_DIR, *arguments, "--domain", str(self.domain))
                self.assertEqual(result.code, 3, str(result))
                self.assertIn(f"no bridge found in DDS domain {self.domain} on 127.0.0.1", result.err)

    def test_an_interface_that_does_not_exist_is_named(self):
        result = run_cli(BIN_DIR, "status", "--domain", str(self.domain), "--interface", "192.0.2.1")
        self.assertNotEqual(result.code, 0, str(result))
        self.assertIn("192.0.2.1", result.err)


class BadFiles(unittest.TestCase):
    def test_check_names_every_fault_with_its_place(self):
        with File(PLAN.replace("REFRESH", "1s").replace("address: 1", "adress: 1").replace("holding:4000", "holdin:4000")) as path:
            process = subprocess.run([os.path.join(BIN_DIR, "fieldcast-bridge"), path, "--check"], capture_output=True, text=True, timeout=30)
            self.assertEqual(process.returncode, 3, process.stderr)
            text = process.stdout + process.stderr
            self.assertRegex(text, r"plant\.yaml:9:\d+: .*adress")
            self.assertRegex(text, r"plant\.yaml:12:\d+: .*holdin")

    def test_check_accepts_a_good_file(self):
        with File(PLAN.replace("REFRESH", "1s")) as path:
            process = subprocess.run([os.path.join(BIN_DIR, "fieldcast-bridge"), path, "--check"], capture_output=True, text=True, timeout=30)
            self.assertEqual(process.returncode, 0, process.stdout + process.stderr)

    def test_the_command_line_reports_the_same_faults(self):
        with File(PLAN.replace("REFRESH", "soon")) as path:
            for arguments in [("plan", path), ("watch", "--once", "--config", path)]:
                result = run_cli(BIN_DIR, *arguments)
                self.assertEqual(result.code, 2, str(result))
                self.assertRegex(result.err, r"plant\.yaml:11:\d+: ")


class Plan(unittest.TestCase):
    def test_a_feasible_plan_keeps_every_refresh(self):
        with File(PLAN.replace("REFRESH", "1s")) as path:
            result = run_cli(BIN_DIR, "plan", path, "--json")
            self.assertEqual(result.code, 0, str(result))
            bus = result.json_lines()[0]
            self.assertEqual((bus["bus"], bus["feasible"]), ("line", True))
            self.assertTrue(0 < bus["load"] < 1, bus)
            self.assertEqual(len(bus["channels"]), 2)
            for channel in bus["channels"]:
                self.assertLessEqual(channel["worst_gap"], channel["refresh"])

    def test_an_infeasible_plan_is_found_and_says_what_would_help(self):
        with File(PLAN.replace("REFRESH", "20ms")) as path:  # two reads at 9600 baud take longer
            result = run_cli(BIN_DIR, "plan", path, "--json")
            self.assertEqual(result.code, 1, str(result))
            bus = result.json_lines()[0]
            self.assertFalse(bus["feasible"])
            self.assertTrue(bus["advice"], bus)
            people = run_cli(BIN_DIR, "plan", path)
            self.assertEqual(people.code, 1, str(people))
            self.assertIn("line/meter/a", people.out)


class Inspect(unittest.TestCase):
    def test_a_frame_is_explained_from_arguments_and_standard_input(self):
        frame = "2A0400100003B7D5"  # stepfunc/rodbus, rodbus/src/serial/frame.rs
        for result in [run_cli(BIN_DIR, "inspect", "modbus-rtu", frame), run_cli(BIN_DIR, "inspect", "modbus-rtu", stdin=frame)]:
            self.assertEqual(result.code, 0, str(result))
            self.assertIn("no fault", result.out)
        self.assertEqual(run_cli(BIN_DIR, "inspect", "modbus-rtu", frame[:-1] + "6").code, 1)
        self.assertEqual(run_cli(BIN_DIR, "inspect", "modbus-rtx", frame).code, 2)


if __name__ == "__main__":
    BIN_DIR = sys.argv[1]
    unittest.main(argv=sys.argv[:1], verbosity=2)
