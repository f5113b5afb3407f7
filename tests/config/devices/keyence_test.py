"""Tests the declaration keyence-kv with a simulated PLC that shares no code with the bridge.

usage: keyence_test.py BIN_DIR
"""

import os
import subprocess
import sys
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from plc_devices import Plc, keyence_kv, until

BIN_DIR = ""


def fieldcast(command, plc, *arguments):
    return subprocess.run([os.path.join(BIN_DIR, "fieldcast"), command, f"127.0.0.1:{plc.port}", "--protocol", "keyence-kv", *arguments],
                          capture_output=True, text=True, timeout=30)


class Keyence(unittest.TestCase):
    def setUp(self):
        self.memory = {("DM", 100): 12, ("DM", 101): 65535, ("DM", 102): 345, ("W", 0xFF): 7, ("TC", 3): 4000000000, ("Z", 12): 5,
                       ("MR", 10, 15): 1, ("MR", 11, 1): 1, ("B", 0x1F): 1}
        self.plc = Plc(self.memory, keyence_kv)
        self.plc.__enter__()
        self.addCleanup(self.plc.__exit__)

    def test_words_and_relays_are_read(self):
        for address, options, values in [("DM100", ["--count", "3"], ["12", "65535", "345"]), ("DM101", ["--type", "int16"], ["-1"]),
                                         ("WFF", [], ["7"]), ("TC3", ["--type", "uint32"], ["4000000000"]), ("Z12", [], ["5"]),
                                         ("MR1015", ["--count", "3"], ["true", "false", "true"]), ("B1F", [], ["true"])]:
            with self.subTest(address=address):
                done = fieldcast("read", self.plc, address, *options)
                self.assertEqual((done.returncode, done.stderr), (0, ""), done.stdout)
                for value in values:
                    self.assertRegex(done.stdout, rf"(?m)(^|\s){value}\b")

    def test_words_and_relays_are_written_and_read_back(self):
        for assignment in ["DM7=65000", "W1FF=1", "MR1100=true", "LR99915=true"]:
            with self.subTest(assignment=assignment):
                done = fieldcast("poke", self.plc, assignment, "--verify")
                self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        written = {("DM", 7): 65000, ("W", 0x1FF): 1, ("MR", 11, 0): 1, ("LR", 999, 15): 1}
        self.assertEqual({key: self.memory.get(key) for key in written}, written)

    def test_a_refusal_is_an_error_of_the_device(self):
        with Plc({}, lambda _, read, write: write(b"E0\r\n" if until(read, b"\r") else b"")) as plc:
            done = fieldcast("read", plc, "DM0")
        self.assertNotEqual(done.returncode, 0)
        self.assertIn("device number out of range", done.stdout + done.stderr)


if __name__ == "__main__":
    BIN_DIR = sys.argv.pop(1)
    unittest.main()
