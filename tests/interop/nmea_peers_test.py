"""NMEA 0183 with pynmea2: the bridge reads sentences that pynmea2 wrote, and pynmea2 reads those of the simulator.

usage: nmea_peers_test.py BIN_FOLDER
"""

import contextlib
import json
import os
import subprocess
import sys
import tempfile
import threading
import unittest

import pynmea2
import serial

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "tools"))
from peers import DEADLINE, Cable, Program
from plant import claim_domain, running_bridge, wait_until

BIN = ""
CONFIGURATION = """
bridge: mast
dds: {{ domain: {domain} }}
buses:
  - name: mast
    port: {{ serial: {port}, baud: 4800, format: 8N1 }}
    protocol: nmea-0183
    devices:
      - name: gps
        address: 1
        channels:
          - {{ name: latitude, at: latitude, type: float64, refresh: 3s }}
          - {{ name: side, at: north-south, type: string(1), refresh: 3s }}
          - {{ name: altitude, at: altitude, type: float64, unit: m, refresh: 3s }}
          - {{ name: satellites, at: satellites, type: uint8, refresh: 3s }}
          - {{ name: course, at: course, type: float64, refresh: 3s }}
          - {{ name: magnetic, at: course-magnetic, type: float64, refresh: 3s }}
          - {{ name: wind, at: wind-speed, type: float64, refresh: 3s }}
"""
SENTENCES = [
    pynmea2.GGA("GN", "GGA", ("184353.07", "1929.045", "S", "02410.506", "E", "1", "04", "2.6", "100.00", "M", "-33.9", "M", "", "0000")),
    pynmea2.RMC("GP", "RMC", ("225446", "A", "4916.45", "N", "12311.12", "W", "000.5", "054.7", "191194", "020.3", "E")),
    pynmea2.VTG("GP", "VTG", ("054.7", "T", "", "M", "005.5", "N", "010.2", "K", "A")),
    pynmea2.MWV("WI", "MWV", ("320.5", "R", "15.0", "M", "A")),
]


class NmeaTest(unittest.TestCase):
    def write_configuration(self, folder, port, domain=0):
        path = os.path.join(folder, "mast.yaml")
        with open(path, "w", encoding="utf-8") as file:
            file.write(CONFIGURATION.format(port=port, domain=domain))
        return path

    def test_the_bridge_reads_sentences_of_pynmea2(self):
        with contextlib.ExitStack() as stack:
            folder = stack.enter_context(tempfile.TemporaryDirectory(prefix="fieldcast-nmea-"))
            domain, claim = claim_domain()
            stack.enter_context(claim)
            cable = stack.enter_context(Cable())
            file = self.write_configuration(folder, cable.left, domain)
            ended = threading.Event()

            def send():
                with serial.Serial(cable.right, 4800) as port:
                    while not ended.wait(0.2):
                        port.write(b"".join(str(sentence).encode() + b"\r\n" for sentence in SENTENCES))

            sender = threading.Thread(target=send)
            sender.start()
            stack.callback(sender.join)
            stack.callback(ended.set)
            expected = {"latitude": 1929.045, "side": "S", "altitude": 100.0, "satellites": 4, "course": 54.7, "magnetic": "BAD_RANGE",
                        "wind": 15.0}
            seen = {}

            def as_expected():
                watched = subprocess.run([os.path.join(BIN, "fieldcast"), "watch", "--json", "--once", "--config", file],
                                         capture_output=True, text=True, timeout=DEADLINE)
                for sample in map(json.loads, watched.stdout.splitlines()):
                    seen[sample["channel"]] = sample["value"] if sample["quality"] == "GOOD" else sample["quality"]
                return seen == expected

            with running_bridge(BIN, file, os.path.join(folder, "bridge.log")):
                wait_until(as_expected, DEADLINE, lambda: str(seen))

    def test_pynmea2_reads_sentences_of_the_simulator(self):
        with contextlib.ExitStack() as stack:
            folder = stack.enter_context(tempfile.TemporaryDirectory(prefix="fieldcast-nmea-"))
            line = os.path.join(folder, "line")
            stack.enter_context(Program(os.path.join(BIN, "fieldcast-sim"), self.write_configuration(folder, line))).wait_ready()
            with serial.Serial(line, 4800, timeout=DEADLINE) as port:
                port.readline()  # its beginning may be missing
                sentences = [pynmea2.parse(port.readline().decode(), check=True) for _ in range(6)]
            self.assertEqual({sentence.sentence_type for sentence in sentences}, {"GGA", "VTG", "MWV"})
            for sentence in sentences:
                if sentence.sentence_type == "GGA":
                    self.assertGreaterEqual(float(sentence.lat), 0)
                    self.assertGreaterEqual(int(sentence.num_sats), 0)


if __name__ == "__main__":
    BIN = sys.argv.pop()
    unittest.main()
