"""Tests the station programs of the documents as a reader would: saved and compiled outside the
tree with the installed library. Checks their output for a simulated plant: catalogue, values
with quality and age, last values for a late joiner, missed deadlines, and the result of a
write.

usage: stations_test.py BIN_DIR BUILD_DIR SOURCE_DIR
"""

import glob
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "tools"))
from comparison import general  # noqa: E402
from document import parse  # noqa: E402
from plant import Plant, modbus_line, wait_until  # noqa: E402

BIN_DIR, BUILD_DIR, SOURCE_DIR = "", "", ""
DOCUMENTS = ["README.md", "docs/stations.md"]
COMPILED = "with a compiler"  # argument of the marker `in the installed system`
SECONDS = 30  # far above any normal duration, so that only a fault reaches it
AGE = r", \d+ ms old"

PLANT = """
bridge: stations
buses:
  - name: line
    port: { serial: {run}/line, baud: 115200, format: 8N1 }
    protocol: modbus-rtu
    defaults: { timeout: 50ms }
    devices:
      - name: meter
        address: 1
        allow: [raw-read, raw-write]
        channels:
          - { name: voltage, at: "holding:0", type: float32, unit: V, refresh: 200ms }
          - { name: setpoint, at: "holding:10", type: float32, refresh: 200ms, access: read-write }
          - { name: serial-number, at: "holding:20", type: uint16, refresh: 10s }
"""


def run(*command, **options):
    result = subprocess.run(command, capture_output=True, text=True, timeout=280, **options)
    if result.returncode:
        raise AssertionError(f"{' '.join(command)}: exit code {result.returncode}\n{result.stdout}{result.stderr}")
    return result.stdout


class Station:
    """A running program of the documents with its output lines."""

    def __init__(self, program, domain, environment):
        # stdbuf: a program that writes to a pipe would buffer its lines.
        self.process = subprocess.Popen(["stdbuf", "-oL", program, str(domain)], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                                        text=True, env=environment)
        self.lines = []
        self.thread = threading.Thread(target=self._read)
        self.thread.start()

    def _read(self):
        for line in self.process.stdout:
            self.lines.append(line.rstrip("\n"))

    def says(self, pattern, after=0):
        """Waits for a line that matches `pattern`, from the line number `after` on; returns it."""
        def found():
            return next((line for line in self.lines[after:] if re.fullmatch(pattern, line)), None)
        return wait_until(found, SECONDS, lambda: f"never said '{pattern}':\n" + "\n".join(self.lines[-40:]))

    def keeps(self, channel):
        """Waits for two seconds in which no deadline of the channel (one second) is missed."""
        begin, after = time.monotonic(), len(self.lines)

        def kept():
            nonlocal begin, after
            if f"late: {channel}" in self.lines[after:]:
                begin, after = time.monotonic(), len(self.lines)
            return time.monotonic() - begin > 2 and any(line.startswith(channel + " ") for line in self.lines[after:])
        wait_until(kept, SECONDS, lambda: f"{channel} is late again and again:\n" + "\n".join(self.lines[-40:]))

    def __enter__(self):
        return self

    def __exit__(self, kind, *_):
        self.process.stdin.close()  # the Enter that ends it
        try:
            code = self.process.wait(SECONDS)
        except subprocess.TimeoutExpired:
            self.process.kill()
            code = f"killed: still there {SECONDS} s after its end was asked for"
            self.process.wait()
        self.thread.join()
        self.process.stdout.close()
        if kind is None and code != 0:
            raise AssertionError(f"the station ended with {code}\n" + "\n".join(self.lines[-40:]))


class Paused:
    def __init__(self, process):
        self.process = process

    def __enter__(self):
        self.process.send_signal(signal.SIGSTOP)

    def __exit__(self, *_):
        self.process.send_signal(signal.SIGCONT)


class Stations(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp(prefix="fieldcast-stations-")
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        root = os.path.join(cls.folder, "root")
        for component in ["libfieldcast-station1", "fieldcast-dev"]:
            run("cmake", "--install", BUILD_DIR, "--component", component, "--prefix", root)
        pkgconfig, = glob.glob(f"{root}/lib/**/pkgconfig", recursive=True)
        cls.environment = {"PATH": "/usr/bin:/bin", "HOME": cls.folder, "LC_ALL": "C.UTF-8", "CMAKE_PREFIX_PATH": root,
                           "PKG_CONFIG_PATH": pkgconfig, "LD_LIBRARY_PATH": os.path.dirname(pkgconfig)}
        for document in DOCUMENTS:
            cls.follow(document)
        cls.plant = Plant(BIN_DIR, PLANT)
        cls.plant.__enter__()
        cls.addClassCleanup(cls.plant.__exit__, None, None, None)

    @classmethod
    def follow(cls, document):
        """Saves the document's files and runs its commands for a machine with a compiler."""
        folder = os.path.join(cls.folder, "work")
        with open(os.path.join(SOURCE_DIR, document), encoding="utf-8") as file:
            for block in parse(document, file.read()):
                if "file" in block.markers and block.language != "sh":
                    path = os.path.join(folder, block.markers["file"])
                    os.makedirs(os.path.dirname(path), exist_ok=True)
                    with open(path, "w", encoding="utf-8") as saved:
                        saved.write(block.text)
                elif COMPILED in block.markers.get("in the installed system", ""):
                    run("bash", "-euo", "pipefail", "-c", block.text, cwd=folder, env=cls.environment)
                for exported in re.findall(r"^export (\w+)='(.*)'$", block.text, re.MULTILINE):
                    cls.environment[exported[0]] = exported[1]

    def start(self, program):
        return Station(os.path.join(self.folder, "work", program), self.plant.domain, self.environment)

    def check_station(self, program):
        with self.start(program) as station:
            station.says("found line/meter/voltage: float32 V at holding:0")
            station.says("found line/meter/serial-number: uint16  at holding:20")
            station.says("line/meter/voltage .* GOOD" + AGE)
            station.says("write: verified")
            station.says("line/meter/setpoint 42 GOOD" + AGE)
            self.assertFalse([line for line in station.lines if line.startswith("line/meter/serial-number")],
                             "a channel of 10 s is none for a station that asks for 1 s")
            station.keeps("line/meter/voltage")
            with Paused(self.plant.bridge):
                station.says("late: line/meter/voltage")
            station.says("line/meter/voltage .* GOOD" + AGE, after=len(station.lines))
            with Paused(self.plant.sim):
                station.says("line/meter/voltage .* BAD_NO_ANSWER" + AGE)
                station.says("line/meter/setpoint 42 BAD_NO_ANSWER" + AGE)
                station.says("late: line/meter/setpoint", after=len(station.lines))
            station.says("line/meter/setpoint 42 GOOD" + AGE, after=len(station.lines))
            return station.lines

    def shown(self):
        """The outputs that the document shows, as lists of lines, in order."""
        with open(os.path.join(SOURCE_DIR, "docs/stations.md"), encoding="utf-8") as file:
            return [block.text.splitlines() for block in parse("docs/stations.md", file.read()) if "picture" in block.markers]

    def test_the_station_in_cpp_says_what_the_document_shows(self):
        said = {general(line) for line in self.check_station("build/station")}
        of_station, _ = self.shown()
        self.assertEqual({general(line) for line in of_station} - said, set())

    def test_the_station_for_engineers_says_what_the_document_shows(self):
        _, of_engineer = self.shown()
        with self.start("engineer") as station:
            for line in of_engineer:
                station.says(re.escape(line))

    def test_the_station_in_c(self):
        self.check_station("station-c")

    def test_the_station_of_pkg_config_comes_late_and_gets_last_values(self):
        with self.start("build/station"):
            pass  # leaves 42 in the setpoint
        with Paused(self.plant.sim), self.start("station") as station:
            station.says("found line/meter/setpoint: float32  at holding:10")
            old = station.says("line/meter/setpoint 42 BAD_NO_ANSWER" + AGE)
            self.assertGreater(int(old.split()[-3]), 0)
            station.says("write: (rejected|failed|expired): .*")

    def test_the_example_that_is_installed_is_the_one_that_is_shown(self):
        shown = {}
        for document in DOCUMENTS:
            with open(os.path.join(SOURCE_DIR, document), encoding="utf-8") as file:
                shown.update({os.path.basename(block.markers["file"]): block.text for block in parse(document, file.read())
                              if "file" in block.markers})
        for name in ["station.cpp", "engineer.cpp", "station.c", "CMakeLists.txt"]:
            with open(os.path.join(SOURCE_DIR, "tools/packaging/example", name), encoding="utf-8") as file:
                self.assertEqual(shown[name], file.read(), name)
        self.assertLessEqual(len(shown["station.cpp"].splitlines()), 25)


if __name__ == "__main__":
    BIN_DIR, BUILD_DIR, SOURCE_DIR = map(os.path.abspath, sys.argv[1:4])
    unittest.main(argv=sys.argv[:1], verbosity=2)
