"""Tests programs with DDS Security that were suspended for longer than the lease of a participant:
a bridge joins the domain again, a station ends so that its service starts it again.

usage: e2e_suspended.py BIN_DIR
"""

import json
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest

import e2e_station
from e2e_station import Station
from plant import Plant, modbus_line, run_cli, wait_until

BIN_DIR = ""
CONFIG = "bridge: line-7" + modbus_line() + '          - { name: temperature, at: "holding:100", type: int16 }\n'
PAUSE = 14  # seconds; a silent participant is removed after 10
AGAIN = 20  # seconds until values arrive again


class Suspended(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp(prefix="fieldcast-suspended-")
        cls.addClassCleanup(shutil.rmtree, cls.folder, ignore_errors=True)
        authority = os.path.join(cls.folder, "plant")
        for words in (["init", authority], ["add", "bridge", "line-7", "--authority", authority], ["add", "station", "wall", "--authority", authority],
                      ["add", "plant", "mes", "--authority", authority]):
            done = run_cli(BIN_DIR, "secure", *words)
            assert done.code == 0, done
        cls.member = {name: os.path.join(authority, "members", name) for name in ("line-7", "wall", "mes")}
        cls.plant = Plant(BIN_DIR, CONFIG, dds=f", security: {cls.member['line-7']}", joins=["--security", cls.member["mes"]])
        cls.plant.__enter__()
        cls.addClassCleanup(cls.plant.__exit__, None, None, None)

    def suspend(self, process):
        process.send_signal(signal.SIGSTOP)
        self.addCleanup(process.send_signal, signal.SIGCONT)
        time.sleep(PAUSE)
        process.send_signal(signal.SIGCONT)

    def watch(self):
        """Starts a reader; returns the acquisition times of its GOOD values, in seconds."""
        process = subprocess.Popen([os.path.join(BIN_DIR, "fieldcast"), "watch", "--json", "--for", "120", "--domain", str(self.plant.domain),
                                    "--security", self.member["wall"]], stdout=subprocess.PIPE, text=True)
        self.addCleanup(process.wait)
        self.addCleanup(process.stdout.close)
        self.addCleanup(process.kill)
        times = []

        def read():
            for line in process.stdout:
                if json.loads(line).get("quality") == "GOOD":
                    times.append(time.monotonic())

        threading.Thread(target=read, daemon=True).start()
        wait_until(lambda: times, AGAIN, "no value")
        return times

    def test_a_bridge_is_heard_again_by_every_reader(self):
        readers = [self.watch() for _ in range(3)]
        self.suspend(self.plant.bridge)
        resumed = time.monotonic()
        log = lambda: self.plant.log("fieldcast-bridge")
        for times in readers:
            wait_until(lambda: times[-1] > resumed + 2, AGAIN, log)
        self.assertIn("reloading: the process was suspended", log())

    def test_a_station_ends_so_that_it_is_started_again(self):
        station = Station(self.plant, "wall", "web: { local-role: operator }\n", "--listen", "127.0.0.1:0", "--security", self.member["wall"])
        station.__enter__()
        self.addCleanup(station.process.wait)
        self.addCleanup(station.process.kill)
        self.suspend(station.process)
        self.assertEqual(station.process.wait(AGAIN), 1, station.log())
        self.assertIn("its service starts it again", station.log())


if __name__ == "__main__":
    BIN_DIR = e2e_station.BIN_DIR = sys.argv.pop()
    unittest.main()
