"""`fieldcast read` at a meter on an optical head, which is asked at 300 baud and responds at 9600.

usage: optical_head_test.py FIELDCAST

The cable has the properties of a line: what one end sends at another rate than that of the other
end arrives as noise. The readout is the published one of an ITRON EM214 (smartmeter-obis).
"""

import functools
import json
import operator
import os
import select
import subprocess
import sys
import termios
import threading
import unittest

from peers import DEADLINE, SerialCable

FIELDCAST = ""
READOUT = b"F.F(00000000)\r\n0.0.0(1240007670003202)\r\n1.7.0(00.49*kW)\r\n1.8.1(022108.7*kWh)\r\n31.7.0(+000.8*A)\r\n!\r\n\x03"
BLOCK = b"\x02" + READOUT + bytes([functools.reduce(operator.xor, READOUT)])
SPEEDS = {b"0": termios.B300, b"4": termios.B4800, b"5": termios.B9600}


class Meter(threading.Thread):
    """Names the rate `code`, and responds at the rate that the acknowledgement repeats, unless `stays`."""

    def __init__(self, path, code, stays):
        super().__init__()
        self.stays = stays
        self.line, self.code, self.acknowledged = os.open(path, os.O_RDWR | os.O_NOCTTY), code, []
        self.wake, self.waker = os.pipe()
        self.set_speed(termios.B300)

    def set_speed(self, speed):
        settings = termios.tcgetattr(self.line)
        settings[0] |= termios.INPCK
        settings[4] = settings[5] = speed
        termios.tcsetattr(self.line, termios.TCSANOW, settings)

    def hear(self, length):
        heard = b""
        while len(heard) < length:
            if self.wake in select.select([self.line, self.wake], [], [])[0]:
                return None
            heard += os.read(self.line, length - len(heard))
        return heard

    def run(self):
        while (asked := self.hear(5)) is not None:
            if asked != b"/?!\r\n":
                continue
            os.write(self.line, b"/ITR" + self.code + b"EM214\r\n")
            acknowledged = self.hear(6)
            if acknowledged is None:
                return
            self.acknowledged.append(acknowledged)
            self.set_speed(termios.B300 if self.stays else SPEEDS[acknowledged[2:3]])
            os.write(self.line, BLOCK)
            if self.wake in select.select([self.wake], [], [], len(BLOCK) * 10 / 4800)[0]:  # until it has left
                return
            self.set_speed(termios.B300)

    def stop(self):
        os.write(self.waker, b"x")
        self.join()
        for fd in (self.line, self.wake, self.waker):
            os.close(fd)


class OpticalHead(unittest.TestCase):
    def run_at(self, code, stays, command, *words):
        with SerialCable() as cable:
            meter = Meter(cable.right, code, stays)
            meter.start()
            try:
                done = subprocess.run([FIELDCAST, command, cable.left, "--protocol", "iec62056-21-optical", "--baud", "300", "--format", "7E1",
                                       "--timeout", "1500ms", "--json", *words], capture_output=True, text=True, timeout=DEADLINE)
            finally:
                meter.stop()
        return done, meter.acknowledged

    def read(self, code, stays=False):
        return self.run_at(code, stays, "read", "--retries", "0", "energy-import-1", "current-1", "serial")

    def test_the_readout_comes_at_the_rate_that_the_meter_names(self):
        for code in (b"5", b"4"):
            with self.subTest(code=code):
                done, acknowledged = self.read(code)
                self.assertEqual(done.returncode, 0, done.stderr)
                values = {line["address"]: line["values"] for line in map(json.loads, done.stdout.splitlines())}
                self.assertEqual(values, {"energy-import-1": [22108.7], "current-1": [0.8], "serial": ["1240007670003202"]})
                self.assertEqual(set(acknowledged), {b"\x060" + code + b"0\r\n"})

    def test_a_scan_finds_the_meter(self):
        done, acknowledged = self.run_at(b"5", False, "scan", "--addresses", "1")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(json.loads(done.stdout)["address"], 1)
        self.assertEqual(set(acknowledged), {b"\x06050\r\n"})

    def test_a_meter_that_stays_at_its_rate_sends_noise(self):
        done, acknowledged = self.read(b"5", stays=True)
        self.assertEqual(set(acknowledged), {b"\x06050\r\n"})
        self.assertNotEqual(done.returncode, 0)
        self.assertNotIn("22108", done.stdout)


if __name__ == "__main__":
    FIELDCAST = sys.argv.pop(1)
    unittest.main()
