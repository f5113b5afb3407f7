"""Tests `fieldcast scan`, `read` and `poke` on a serial line with devices of other authors.

usage: scan_peers_test.py FIELDCAST LIBMODBUS_SERVER [--whole]     --whole: also the scans that take
minutes
"""

import contextlib
import json
import os
import sys
import subprocess
import threading
import time
import unittest

from peers import Mbpoll, Program, SerialCable

FIELDCAST = LIBMODBUS = ""
WHOLE = False
PYMODBUS = os.path.join(os.path.dirname(os.path.abspath(__file__)), "pymodbus_server.py")
HARMLESS = {1, 2, 3, 4, 0x2B}


def run(*words, limit=60):
    done = subprocess.run([FIELDCAST, *(str(word) for word in words)], capture_output=True, text=True, timeout=limit)
    return done.returncode, done.stdout, done.stderr


class ScanTest(unittest.TestCase):
    def scan(self, server, baud, unit, *words, limit=60):
        with SerialCable() as cable, Program(*server, "rtu", cable.right, baud, unit) as device:
            device.wait_ready()
            began = time.monotonic()
            code, out, err = run("scan", cable.left, "--json", *words, limit=limit)
            seconds = time.monotonic() - began
            asked = b"".join(cable.asked)
            self.assertEqual(code, 0, err)
            self.assertTrue(asked)
            functions = {frame[1] for frame in cable.asked if len(frame) >= 4}
            self.assertLessEqual(functions, HARMLESS, "a scan asks what writes")
            device.stop()
        found = [json.loads(line) for line in out.splitlines()]
        self.assertEqual([(each["baud"], each["format"], each["address"]) for each in found], [(baud, "8N1", unit)], out)
        return seconds

    def test_finds_pymodbus_at_unknown_settings(self):
        self.scan([sys.executable, PYMODBUS], 9600, 17, "--addresses", "16-18", "--timeout", "150ms")

    def test_finds_libmodbus_at_unknown_settings(self):
        # For half a second, libmodbus treats data as the response of the unit polled before.
        self.scan([LIBMODBUS], 9600, 17, "--addresses", "16-18", "--timeout", "600ms")

    def test_known_settings_units_1_to_32(self):
        if not WHOLE:
            self.skipTest("takes half a minute: --whole")
        print(f"known settings, units 1-32: {self.scan([sys.executable, PYMODBUS], 9600, 32, '--baud', 9600, '--format', '8N1'):.1f} s")

    def test_the_last_of_the_usual_settings(self):
        if not WHOLE:
            self.skipTest("takes minutes: --whole")
        print(f"unknown settings, the last that is tried, units 1-32: {self.scan([sys.executable, PYMODBUS], 2400, 32, limit=400):.1f} s")

    def test_reads_and_pokes_what_mbpoll_sees(self):
        with SerialCable() as cable, Program(sys.executable, PYMODBUS, "rtu", cable.right, 19200, 3) as device:
            device.wait_ready()
            line = (cable.left, "--baud", 19200, "--format", "8N1", "--address", 3)
            code, out, err = run("read", *line, "holding:100", "--count", 3, "--json")
            self.assertEqual(code, 0, err)
            for value in (1100, 1101, 1102):
                self.assertIn(str(value), out)
            code, out, err = run("poke", *line, "holding:7=4711", "--verify")
            self.assertEqual(code, 0, out + err)
            mbpoll = Mbpoll(cable.left, baud=19200, unit=3)
            self.assertEqual(mbpoll.read("holding", 6, 3), [1006, 4711, 1008])
            self.assertIs(mbpoll.write("holding", 8, 12), True)
            code, out, err = run("read", *line, "holding:8", "--json")
            self.assertIn("12", out, err)

    def test_a_line_that_is_flooded_is_reported(self):
        with SerialCable() as cable:
            stop = threading.Event()
            end = os.open(cable.right, os.O_RDWR | os.O_NOCTTY | os.O_NONBLOCK)

            def flood():
                while not stop.wait(0.01):
                    with contextlib.suppress(BlockingIOError):
                        os.write(end, b"\x55\xaa" * 8)

            flooding = threading.Thread(target=flood)
            flooding.start()
            try:
                code, out, err = run("scan", cable.left, "--baud", 9600, "--addresses", "1-8", "--timeout", "150ms")
            finally:
                stop.set()
                flooding.join()
                os.close(end)
            self.assertNotEqual(code, 0)
            self.assertEqual(out, "")
            self.assertIn("bytes arrived that are not a response", err)
            self.assertIn("another master may speak there", err)


if __name__ == "__main__":
    WHOLE = "--whole" in sys.argv
    if WHOLE:
        sys.argv.remove("--whole")
    FIELDCAST, LIBMODBUS = sys.argv.pop(1), sys.argv.pop(1)
    unittest.main()
