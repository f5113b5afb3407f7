"""Tests that long operations show progress on a terminal, also on a narrow one, and that Ctrl-C
ends them immediately without partial files.

usage: e2e_progress.py BIN_DIR

Every program runs on its own pseudo-terminal. `Ended` measures the time from Ctrl-C to the end. It
is only printed; a hang is a failure, because a busy machine may delay any process.
"""

import contextlib
import os
import signal
import socket
import sqlite3
import subprocess
import sys
import tempfile
import termios
import threading
import time
import unittest

from plant import InAFolder
from terminal import Terminal

BIN_DIR = ""
CTRL_C = "\x03"
HANG_SECONDS = 8  # equal to Interrupt::kEndLimit: the program does not end by itself
NARROW = 20

LINE = """\
bridge: progress
buses:
  - name: {name}
    port: {{ serial: "{link}"{baud} }}
    protocol: {protocol}
    devices:
      - name: plc
        address: 3
        channels: [ {{ name: first, at: "{at}", type: uint16, refresh: 1s }} ]
"""


def program(name):
    return os.path.join(BIN_DIR, name)


class Commands(InAFolder):
    def start(self, *command, **keywords):
        process = subprocess.Popen(command, stdin=subprocess.DEVNULL, **keywords)
        self.addCleanup(process.wait)
        self.addCleanup(process.kill)
        return process

    def end_by_ctrl_c(self, terminal, code=130):
        began = time.monotonic()
        terminal.press(CTRL_C)
        self.assertEqual(terminal.wait_for_end(HANG_SECONDS), code, terminal.text())
        print(f"{self.id().split('.', 1)[1]}: ended {time.monotonic() - began:.3f} s after Ctrl-C", flush=True)

    def look(self, terminal, pattern):
        """Waits for the progress, which must fit on one line of any width."""
        terminal.wait_for(pattern)
        for _ in range(2):
            terminal.read(0.3)
            lines = [line for line in terminal.lines() if line]
            self.assertLessEqual(len(lines), 1, terminal.text())


class Password(Commands):
    def test_the_terminal_has_its_echo_again(self):
        with Terminal([program("fieldcast"), "user", "add", "anna", "--store", self.path("x.db")]) as terminal:
            terminal.wait_until(lambda text: "password:" in text and not terminal.modes_now()[3] & termios.ECHO, "a prompt without echo")
            self.end_by_ctrl_c(terminal, -signal.SIGINT)
            self.assertEqual(terminal.modes_now(), terminal.modes)


class Simulation(Commands):
    def test_a_simulation_shows_its_progress_and_ends(self):
        file = self.file("line.yaml", LINE.format(name="boiler-house", link="/tmp/none", baud="", protocol="modbus-rtu", at="holding:0"))
        for columns, pattern in ((80, r"^simulating boiler-house: \d+ %, .* left"), (NARROW, r"^(simu.*~: )?\d+ %")):
            with Terminal([program("fieldcast"), "plan", file, "--simulate", "8000h"], columns=columns) as terminal:
                self.look(terminal, pattern)
                self.end_by_ctrl_c(terminal)
                self.assertNotIn("%", terminal.text(), "the line is wiped")

    def test_nothing_is_said_where_nobody_looks(self):
        file = self.file("line.yaml", LINE.format(name="line", link="/tmp/none", baud="", protocol="modbus-rtu", at="holding:0"))
        process = self.start(program("fieldcast"), "plan", file, "--simulate", "8000h", stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        time.sleep(1)
        process.send_signal(signal.SIGTERM)
        out, err = process.communicate(timeout=HANG_SECONDS)
        self.assertEqual((process.returncode, out, err), (130, b"", b""))


class Bench(Commands):
    def test_a_bench_shows_its_progress_and_ends(self):
        with Terminal([program("list_bench"), "sustained"], columns=80) as terminal:
            terminal.wait_for(r"(?m)^sustained load: \d+ %, .* left")
            self.end_by_ctrl_c(terminal, -signal.SIGINT)


class History(Commands):
    # of one channel, listed under many names, so an export takes minutes
    ROWS, NAMES = 100_000, 1000

    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory(prefix="fieldcast-progress-")
        cls.addClassCleanup(folder.cleanup)
        path = os.path.join(folder.name, "store.db")
        subprocess.run([program("fieldcast"), "token", "add", "reader", "--days", "1", "--store", path], check=True, capture_output=True)
        with contextlib.closing(sqlite3.connect(path)) as store, store:
            counted = "with recursive i(n) as (select 1 union all select n + 1 from i where n < {})"
            store.execute(counted.format(cls.ROWS) + " insert into samples select 1, 1700000000000000000 + n * 1000000000, "
                          "n, 0, 0, 0, 3, null, n * 0.5, null from i")
            store.executescript("pragma foreign_keys = off; drop view if exists sample_history; drop table channels; "
                                "create view channels as " + counted.format(cls.NAMES) +
                                " select 1 as id, 'line' as bus, 'plc' as device, 'level-' || n as channel, 'm' as unit, 'float64' as type from i")
        cls.words = ["history", "line/plc/*", "--csv", "--store", path, "--from", "2023-11-01", "--to", "2023-11-26"]

    def test_an_export_ends_and_no_file_is_left(self):
        file = self.path("level.csv.gz")
        with Terminal([program("fieldcast"), *self.words, "--gzip", file], columns=60) as terminal:
            self.look(terminal, r"^history: \d+ %, .* left, \d+ lines")
            self.end_by_ctrl_c(terminal)
            self.assertNotIn("%", terminal.text())
        self.assertEqual(os.listdir(self.folder), [])

    def test_an_export_to_standard_output_ends_behind_a_whole_line(self):
        process = self.start(program("fieldcast"), *self.words, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        begin = process.stdout.read(10_000)
        process.send_signal(signal.SIGINT)
        rest, err = process.communicate(timeout=HANG_SECONDS)
        self.assertEqual((process.returncode, err), (130, b""))
        text = begin + rest
        self.assertTrue(text.endswith(b"\n"), text[-200:])
        self.assertLess(text.count(b"\n"), self.ROWS * self.NAMES)

    def test_an_export_whose_output_nobody_takes_ends(self):
        process = self.start(program("fieldcast"), *self.words, stdout=subprocess.PIPE)
        process.stdout.read(1)
        process.send_signal(signal.SIGINT)
        self.assertEqual(process.wait(HANG_SECONDS), 130)
        process.stdout.close()


class Import(Commands):
    ROWS = 100_000  # the import limit; takes some seconds

    def setUp(self):
        super().setUp()
        rows = "".join(f"{i % 9000},power-{i},U16\n" for i in range(self.ROWS))
        self.list = self.file("list.csv", "Address,Name,Type\n" + rows)

    def left_behind(self):
        return sorted(set(os.listdir(self.folder)) - {"list.csv"})

    def test_an_import_shows_its_progress_and_ends(self):
        with Terminal([program("fieldcast"), "import", self.list, "--out", self.path("new.yaml")], columns=NARROW) as terminal:
            terminal.wait_for(r"^(imp.*: )?\d+ %")
            os.kill(terminal.pid, signal.SIGSTOP)  # so that it cannot end before the signal
            terminal.press(CTRL_C)
            os.kill(terminal.pid, signal.SIGCONT)
            self.assertEqual(terminal.wait_for_end(HANG_SECONDS), 130, terminal.text())
            self.assertNotIn("%", terminal.text())
        self.assertEqual(self.left_behind(), [])

    def test_whenever_it_ends_the_files_are_whole_or_not_there(self):
        small = self.file("small.csv", "Address,Name,Type\n" + "".join(f"{i},power-{i},U16\n" for i in range(300)))
        command = [program("fieldcast"), "import", small, "--out", self.path("new.yaml"), "--port", "/dev/ttyUSB0"]
        began = time.monotonic()
        subprocess.run(command, check=True, capture_output=True)
        took = time.monotonic() - began
        with open(self.path("new.yaml"), encoding="utf-8") as file:
            whole = file.read()
        for step in range(12):
            if os.path.exists(self.path("new.yaml")):
                os.remove(self.path("new.yaml"))
            process = self.start(*command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            time.sleep(took * step / 10)
            process.send_signal(signal.SIGINT)
            # by the signal if it arrives before main
            self.assertIn(process.wait(HANG_SECONDS), (0, 130, -signal.SIGINT))
            self.assertEqual([name for name in self.left_behind() if name not in ("new.yaml", "small.csv")], [])
            if os.path.exists(self.path("new.yaml")):
                with open(self.path("new.yaml"), encoding="utf-8") as file:
                    self.assertEqual(file.read(), whole)


class Scan(Commands):
    def setUp(self):
        super().setUp()
        self.link = self.path("plc")
        config = self.file("line.yaml", LINE.format(name="line", link=self.link, baud="", protocol="omron-hostlink", at="DM0"))
        simulator = self.start(program("fieldcast-sim"), config, stdout=subprocess.PIPE, text=True)
        while "READY" not in simulator.stdout.readline():
            self.assertIsNone(simulator.poll())
        simulator.stdout.close()

    def test_an_omron_says_its_model(self):
        file, capture = self.path("found.yaml"), self.path("scan.pcapng")
        done = subprocess.run([program("fieldcast"), "scan", self.link, "--protocol", "omron-hostlink", "--baud", "9600", "--format", "7E2",
                               "--addresses", "3-4", "--timeout", "3s", "--out", file, "--capture", capture],
                              capture_output=True, text=True, timeout=60)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertIn("CS/CJ (model code 30), CS1H-CPU67H, 04.00", done.stdout)
        with open(file, encoding="utf-8") as written:
            self.assertIn("# it says: CS/CJ (model code 30)", written.read())
        seen = subprocess.run([program("fieldcast"), "inspect", capture], capture_output=True, text=True, timeout=60)
        self.assertEqual(seen.returncode, 0, seen.stdout + seen.stderr)
        for words in ("4D 4D", "asks who it is", "no response"):
            self.assertIn(words, seen.stdout)

    def test_a_scan_shows_its_progress_and_ends(self):
        file, capture = self.path("found.yaml"), self.path("scan.pcapng")
        command = [program("fieldcast"), "scan", self.link, "--addresses", "5-200", "--out", file, "--capture", capture]
        for columns, pattern in ((80, r"^scanning: \d+ %, .* left at most, 0 found; modbus"), (NARROW, r"^scanning: \d+ %|^\d+ %")):
            with Terminal(command, columns=columns) as terminal:
                self.look(terminal, pattern)
                self.end_by_ctrl_c(terminal)
            seen = subprocess.run([program("fieldcast"), "inspect", capture], capture_output=True, text=True, timeout=60)
            self.assertEqual(seen.returncode, 0, seen.stderr)
            os.remove(capture)
        self.assertFalse(os.path.exists(file))


class SlowBridge(threading.Thread):
    """Pairs the first engineer and then stops reading."""

    def __init__(self):
        super().__init__(daemon=True)
        self.server = socket.create_server(("127.0.0.1", 0))
        self.server.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
        self.port = self.server.getsockname()[1]
        self.connection = None
        self.start()

    def run(self):
        try:
            self.connection = self.server.accept()[0]
            text = b""
            while not text.endswith(b"FEFF"):
                text += self.connection.recv(100)
            self.connection.sendall(b"@@0000FEFF")
        except OSError:
            pass

    def close(self):
        for end in (self.connection, self.server):
            if end:
                end.close()


class Transfer(Commands):
    def setUp(self):
        super().setUp()
        self.bridge = SlowBridge()
        self.addCleanup(self.bridge.close)
        self.link = self.path("plc")
        self.command = [program("fieldcast-port"), "--server", f"127.0.0.1:{self.bridge.port}", "--device", "17", "--link", self.link,
                        "--heartbeat", "1min"]

    def software(self):
        descriptor = os.open(self.link, os.O_RDWR | os.O_NOCTTY | os.O_NONBLOCK)
        self.addCleanup(os.close, descriptor)
        subprocess.run(["stty", "raw", "-echo"], stdin=descriptor, check=True)
        return descriptor

    def fill(self, descriptor):
        """Writes until the pipe is full; the bytes wait in fieldcast-port."""
        sent, last = 0, time.monotonic()
        while time.monotonic() - last < 1:
            try:
                sent += os.write(descriptor, bytes(4096))
                last = time.monotonic()
            except BlockingIOError:
                time.sleep(0.005)
        return sent

    def test_it_ends_immediately_where_nothing_waits(self):
        with Terminal(self.command) as terminal:
            terminal.wait_for("17: paired")
            os.write(self.software(), b"a program")
            terminal.wait_for(r"17: 0.0 kB sent \(")
            self.end_by_ctrl_c(terminal, 0)
            self.assertIn("17: 9 bytes sent", terminal.text())
            self.assertNotIn("still wait", terminal.text())
        self.assertFalse(os.path.islink(self.link))

    def test_a_transfer_is_one_line_and_a_second_ctrl_c_drops_what_waits(self):
        with Terminal(self.command, columns=100) as terminal:
            terminal.wait_for("17: paired")
            sent = self.fill(self.software())
            terminal.wait_for(r"17: [\d.]+ kB sent \([\d.]+ kB/s\), 0.0 kB received \(0.0 kB/s\), [\d.]+ kB to go")
            self.assertEqual(sum("kB sent" in line for line in terminal.lines()), 1, "one line, drawn again")
            terminal.press(CTRL_C)
            terminal.wait_for("bytes still wait for the bridge")
            terminal.wait_for("the last bytes: 0 %")
            self.end_by_ctrl_c(terminal, 0)
            self.assertGreater(sent, 4096)
        self.assertFalse(os.path.islink(self.link))

    def test_lines_where_it_is_not_a_terminal(self):
        process = self.start(*self.command, "--json", stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        while '"paired"' not in (line := process.stdout.readline()):
            self.assertTrue(line, "it ended")
        os.write(self.software(), b"a program")
        self.assertRegex(process.stdout.readline(), '"baud"|"bytes_to_device":9')
        process.send_signal(signal.SIGTERM)
        out, err = process.communicate(timeout=HANG_SECONDS)
        self.assertEqual((process.returncode, err), (0, ""))
        self.assertNotIn("\x1b", out)


if __name__ == "__main__":
    BIN_DIR = os.path.abspath(sys.argv.pop(1))
    unittest.main(verbosity=2)
