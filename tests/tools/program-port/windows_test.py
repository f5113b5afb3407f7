"""Tests fieldcast-port.exe under Wine: a simulated PLC is programmed through a COM port, which is a pseudo-terminal here.

usage: windows_test.py BIN_FOLDER WINDOWS_FOLDER

WINDOWS_FOLDER is build-windows, with bin/fieldcast-port.exe and packages/*-setup.exe (tools/windows.sh). All traffic is on 127.0.0.1; Wine has a prefix of its own.
"""

import contextlib
import fcntl
import glob
import json
import os
import pty
import re
import select
import socket
import subprocess
import sys
import tempfile
import termios
import time
import tty
import unittest

import serial

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [os.path.join(HERE, ".."), os.path.join(HERE, "..", "..", "interop")]
from host_link_session import host_link, run_session
from peers import DEADLINE, free_port
from plant import Failure, Plant, wait_until

BIN, PROGRAM, SETUP = "", "", ""
WINE = "/usr/lib/wine"  # Debian's wine64 has no program in /usr/bin
STOPPED, FAILURE, USAGE, REFUSED, NO_PORT, NO_BRIDGE, DEVICE_LOST = range(7)
PASSWORDS = {"ann": "correct horse", "bob": "battery staple"}

LINES = """
buses:
  - name: line
    port: { serial: {run}/line, baud: 115200, format: 7E2, exclusive: false }
    protocol: omron-hostlink
    devices:
      - { name: plc, number: P1, address: 0, channels: [ { name: level, at: DM100, type: uint16, refresh: 200ms } ] }
"""
OPEN = """
bridge: e2e
store: { path: {run}/plant.db, samples: [] }
program: { engineers: { listen: 127.0.0.1:{main}, ports: [ { device: P1, listen: 127.0.0.1:{telnet} } ] } }
""" + LINES
SECURE = """
bridge: e2e
store: { path: {run}/plant.db, samples: [] }
program: { engineers: { listen: 127.0.0.1:{main}, certificate: {keys}/cert.pem, key: {keys}/key.pem, login: always } }
""" + LINES


def windows_path(path):
    return "Z:" + path.replace("/", "\\")


class Wine:
    """A prefix of Wine whose COM5 is a pseudo-terminal. `software` is the descriptor at the end of the programming software."""

    def __enter__(self):
        self.folder = tempfile.TemporaryDirectory(prefix="fieldcast-wine-")
        self.environment = {**os.environ, "WINEPREFIX": os.path.join(self.folder.name, "prefix"), "WINEDEBUG": "-all"}
        self.software, self.line = pty.openpty()
        tty.setraw(self.line)
        try:
            self.run("wineboot", "--init")
            self.run("reg", "add", r"HKLM\Software\Wine\Ports", "/v", "COM5", "/d", os.ttyname(self.line), "/f")
            self.stop()  # the next start makes the port
        except BaseException:
            self.__exit__()
            raise
        return self

    def __exit__(self, *_):
        self.stop()
        for end in (self.software, self.line):
            os.close(end)
        self.folder.cleanup()

    def stop(self):
        subprocess.run([os.path.join(WINE, "wineserver"), "-k", "-w"], env=self.environment, timeout=DEADLINE, check=False)

    def command(self, *words):
        return [os.path.join(WINE, "wine64"), *words]

    def run(self, *words):
        """Into files: the processes of Wine's system inherit them and stay open longer than the command."""
        with tempfile.TemporaryFile("w+", encoding="utf-8") as out, tempfile.TemporaryFile("w+", encoding="utf-8") as err:
            done = subprocess.run(self.command(*words), env=self.environment, stdin=subprocess.DEVNULL, stdout=out, stderr=err, timeout=120,
                                  check=False)
            for file in (out, err):
                file.seek(0)
            return subprocess.CompletedProcess(words, done.returncode, out.read(), err.read())

    def port(self, *words):
        return self.run(PROGRAM, *words)

    def ask(self, request):
        """Sends a request as the programming software and returns the response with its CR."""
        os.write(self.software, request)
        return self.read_line()

    def read_line(self):
        response, end = b"", time.monotonic() + DEADLINE
        while not response.endswith(b"\r"):
            if not select.select([self.software], [], [], max(0, end - time.monotonic()))[0]:
                raise Failure(f"no response, but {response}")
            response += os.read(self.software, 4096)
        return response


class Session:
    """A running fieldcast-port.exe in a console of its own."""

    def __init__(self, *options):
        self.options = options

    def __enter__(self):
        self.console, terminal = pty.openpty()
        self.output = tempfile.TemporaryFile()
        self.process = subprocess.Popen(
            wine.command(PROGRAM, "connect", *self.options), env=wine.environment, stdin=terminal, stdout=self.output, stderr=self.output,
            start_new_session=True, preexec_fn=lambda: fcntl.ioctl(0, termios.TIOCSCTTY, 0))
        os.close(terminal)
        return self

    def said(self):
        self.output.seek(0)
        return self.output.read().decode()

    def wait_for(self, text, times=1):
        def found():
            if self.said().count(text) >= times:
                return True
            if self.process.poll() is not None:
                raise Failure(f"ended with {self.process.returncode}: {self.said()}")
            return False
        wait_until(found, DEADLINE, lambda: f"'{text}' {times} times in {self.said()}")

    def press_ctrl_c(self):
        os.write(self.console, b"\x03")

    def code(self):
        return self.process.wait(DEADLINE)

    def __exit__(self, *_):
        if self.process.poll() is None:
            self.process.kill()
            self.process.wait()
        os.close(self.console)
        self.output.close()


def setUpModule():
    global wine
    wine = unittest.enterModuleContext(Wine())


class OnePlant(unittest.TestCase):
    CONFIG, NAMES = "", ()

    @classmethod
    def setUpClass(cls):
        cls.ports = {name: free_port() for name in cls.NAMES}
        config = cls.CONFIG
        for name, port in cls.ports.items():
            config = config.replace("{" + name + "}", str(port))
        cls.plant = cls.enterClassContext(Plant(BIN, config))

    def options(self, *more):
        return ["--server", f"127.0.0.1:{self.ports['main']}", "--device", "P1", "--port", "COM5", "--line", "7E2", *more]

    def rows(self, result):
        done = self.plant.cli("audit", "--json")
        return [row for row in done.json_lines() if result in row["result"]] if done.code == 0 else []

    def row(self, result, **values):
        """Waits for a row of the audit with this result and these values."""
        def found():
            return [row for row in self.rows(result) if all(row[key] == value for key, value in values.items())]
        return wait_until(found, DEADLINE, lambda: f"no row with '{result}' and {values} in {self.rows('')}")[-1]


class Programming(OnePlant):
    CONFIG, NAMES = OPEN, ("main", "telnet")

    def test_programs_byte_exact_and_as_by_rfc2217(self):
        with Session(*self.options("--baud", "115200")) as session:
            session.wait_for("paired")
            by_port = run_session(self, lambda command: os.write(wine.software, command), wine.read_line)
            session.press_ctrl_c()
            self.assertEqual(session.code(), STOPPED, session.said())
            self.assertIn(f"{by_port[0]} bytes sent", session.said())
            self.assertIn(f"{by_port[1]} received", session.said())
        self.row("ended: stopped by the engineer", bytes_to_device=by_port[0], bytes_from_device=by_port[1])
        self.assertIn("line set to 115200 7E2", self.plant.log("fieldcast-bridge"))
        with serial.serial_for_url(f"rfc2217://127.0.0.1:{self.ports['telnet']}", timeout=DEADLINE, baudrate=115200, bytesize=7, parity="E",
                                   stopbits=2) as port:
            by_rfc2217 = run_session(self, port.write, lambda: port.read_until(b"\r"))
        self.assertEqual(by_port, by_rfc2217)
        self.row("ended: the client disconnected", bytes_to_device=by_port[0], bytes_from_device=by_port[1])

    def test_every_byte_value_arrives(self):
        """The simulated PLC responds to valid requests alone, so the bytes are in front of one."""
        with Session(*self.options("--json")) as session:
            session.wait_for("paired")
            data = bytes(value for value in range(256) if value not in b"@\r")
            request = host_link("@00RD01000001")
            response = wine.ask(data * 4 + request)
            self.assertRegex(response, rb"@00RD00[0-9A-F]{4}[0-9A-F]{2}\*\r")
            session.press_ctrl_c()
            self.assertEqual(session.code(), STOPPED, session.said())
            last = [json.loads(line) for line in session.said().splitlines() if "bytes_to_device" in line][-1]
            self.assertEqual(last["bytes_to_device"], len(data) * 4 + len(request))

    def test_a_second_engineer_is_refused(self):
        with Session(*self.options()) as session:
            session.wait_for("paired")
            with socket.create_connection(("127.0.0.1", self.ports["telnet"]), DEADLINE) as peer, peer.makefile("rb") as all_bytes:
                self.assertIn(b"refused: ", all_bytes.read())
            session.press_ctrl_c()
            self.assertEqual(session.code(), STOPPED, session.said())
        with serial.serial_for_url(f"rfc2217://127.0.0.1:{self.ports['telnet']}", timeout=DEADLINE):
            done = wine.port("connect", *self.options())
        self.assertEqual(done.returncode, REFUSED, done.stdout)
        self.assertIn("the device is in use by another engineer", done.stderr)

    def test_refusals_have_their_exit_codes(self):
        server = ["--server", f"127.0.0.1:{self.ports['main']}"]
        for code, text, options in [
                (REFUSED, "the device is not online", [*server, "--device", "P9", "--port", "COM5"]),
                (NO_PORT, "COM77: there is no such COM port; this computer has ", [*server, "--device", "P1", "--port", "COM77"]),
                (NO_PORT, "'LPT1' is not a COM port", [*server, "--device", "P1", "--port", "LPT1"]),
                (NO_BRIDGE, f"127.0.0.1:{(closed := free_port())}: ", ["--server", f"127.0.0.1:{closed}", "--device", "P1", "--port", "COM5"]),
                (USAGE, "--line '7X3'", [*server, "--device", "P1", "--port", "COM5", "--line", "7X3"]),
                (USAGE, "--port is required", [*server, "--device", "P1"])]:
            with self.subTest(text):
                done = wine.port("connect", *options)
                self.assertEqual(done.returncode, code, done.stdout + done.stderr)
                self.assertIn(text, done.stderr)

    def test_lists_the_ports(self):
        listed = [json.loads(line)["port"] for line in wine.port("list", "--json").stdout.splitlines()]
        self.assertIn("COM5", listed)
        self.assertRegex(wine.port("list").stdout, r"(?m)^COM5  \\Device\\")

    def test_lists_the_devices_of_the_bridge(self):
        server = ["--server", f"127.0.0.1:{self.ports['main']}"]
        device = {"number": "P1", "bus": "line", "device": "plc", "state": "free", "who": ""}

        def listed():  # the session of an earlier test may still end
            done = wine.port("list", *server, "--json")
            self.assertEqual(done.returncode, STOPPED, done.stderr)
            return [json.loads(line) for line in done.stdout.splitlines()] == [device]
        wait_until(listed, DEADLINE, "P1 is not free")
        with Session(*self.options()) as session:
            session.wait_for("paired")
            self.assertRegex(wine.port("list", *server).stdout, r"(?m)^P1  line/plc  in use\r?$")
            session.press_ctrl_c()
            self.assertEqual(session.code(), STOPPED, session.said())
        done = wine.port("list", "--server", f"127.0.0.1:{free_port()}")
        self.assertEqual(done.returncode, NO_BRIDGE, done.stdout)


class Losses(OnePlant):
    CONFIG, NAMES = OPEN, ("main", "telnet")

    def restart_bridge(self):
        self.plant.bridge.terminate()
        self.assertEqual(self.plant.bridge.wait(DEADLINE), 0)
        self.plant.bridge = self.plant._start("fieldcast-bridge")
        wait_until(self.plant._status, DEADLINE, "no bus runs")

    def test_without_reconnect_the_loss_ends_it(self):
        with Session(*self.options()) as session:
            session.wait_for("paired")
            self.restart_bridge()
            self.assertEqual(session.code(), DEVICE_LOST, session.said())

    def test_with_reconnect_the_port_stays_and_the_log_has_every_state(self):
        log = os.path.join(wine.folder.name, "session.log")
        with Session(*self.options("--reconnect", "--log", windows_path(log))) as session:
            session.wait_for("paired")
            run_session(self, lambda command: os.write(wine.software, command), wine.read_line)
            self.restart_bridge()
            session.wait_for("connects again in 1s")
            session.wait_for("paired", times=2)
            run_session(self, lambda command: os.write(wine.software, command), wine.read_line)
            session.press_ctrl_c()
            self.assertEqual(session.code(), STOPPED, session.said())
        with open(log, encoding="utf-8") as file:
            lines = file.read().splitlines()
        self.assertTrue(all(re.match(r"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d\.\d{3}Z  P1: ", line) for line in lines), lines)
        self.assertEqual([sum(state in line for line in lines) for state in ("paired", "connects again", "stopped")], [2, 1 + lines_of_retry(lines), 1])


    def test_a_device_that_was_not_in_use_is_paired_when_the_software_sends(self):
        with Session(*self.options("--reconnect")) as session:
            session.wait_for("paired")
            time.sleep(11)  # the software is silent for longer than 10 s
            self.restart_bridge()
            session.wait_for("connects again when the software sends")
            os.write(wine.software, host_link("@00RD01000001"))
            session.wait_for("paired", times=2)
            run_session(self, lambda command: os.write(wine.software, command), wine.read_line)
            session.press_ctrl_c()
            self.assertEqual(session.code(), STOPPED, session.said())


def lines_of_retry(lines):
    """The bridge may need longer than the first pause."""
    return sum("connects again" in line for line in lines) - 1


class Security(OnePlant):
    CONFIG, NAMES = SECURE, ("main",)

    @classmethod
    def setUpClass(cls):
        cls.keys = cls.enterClassContext(tempfile.TemporaryDirectory(prefix="fieldcast-wine-keys-"))
        subprocess.run(["openssl", "req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:prime256v1", "-nodes", "-days", "2", "-subj",
                        "/CN=bridge", "-addext", "subjectAltName=IP:127.0.0.1", "-keyout", cls.file("key.pem"), "-out", cls.file("cert.pem")],
                       check=True, capture_output=True, timeout=60)
        cls.CONFIG = cls.CONFIG.replace("{keys}", cls.keys)
        super().setUpClass()
        for name, password in PASSWORDS.items():
            subprocess.run([os.path.join(BIN, "fieldcast"), "user", "add", name, "--role", "programmer", "--config", cls.plant.file],
                           input=password + "\n", text=True, check=True, capture_output=True, timeout=60)

    @classmethod
    def file(cls, name):
        return os.path.join(cls.keys, name)

    def login(self, user, password, mode=0o600):
        path = self.file(f"password-{user}")
        with contextlib.suppress(FileNotFoundError):
            os.remove(path)
        with open(os.open(path, os.O_WRONLY | os.O_CREAT, mode), "w", encoding="utf-8") as file:
            file.write(password + "\r\n")
        return ["--user", user, "--password-file", windows_path(path)]

    def trusted(self, *more):
        return self.options("--ca", windows_path(self.file("cert.pem")), *more)

    def test_programs_by_tls_with_a_password(self):
        with Session(*self.trusted(*self.login("ann", PASSWORDS["ann"]))) as session:
            session.wait_for("paired")
            run_session(self, lambda command: os.write(wine.software, command), wine.read_line)
            session.press_ctrl_c()
            self.assertEqual(session.code(), STOPPED, session.said())
        self.assertTrue(self.row("ended: stopped by the engineer")["who"].startswith("ann"))

    def test_a_wrong_password_is_refused_also_with_reconnect(self):
        done = wine.port("connect", *self.trusted(*self.login("bob", "wrong")), "--reconnect")
        self.assertEqual(done.returncode, REFUSED, done.stdout)
        self.assertIn("the login of bob is refused: a wrong password", done.stderr)

    def test_lists_the_devices_to_a_programmer_alone(self):
        trusted = ["--server", f"127.0.0.1:{self.ports['main']}", "--ca", windows_path(self.file("cert.pem"))]
        listed = wine.port("list", *trusted, *self.login("ann", PASSWORDS["ann"]))
        self.assertEqual(listed.returncode, STOPPED, listed.stderr)
        self.assertRegex(listed.stdout, "^P1  line/plc  ")
        refused = wine.port("list", *trusted)
        self.assertEqual((refused.returncode, refused.stdout), (REFUSED, ""))
        self.assertIn("a login of a user with the role programmer is needed", refused.stderr)

    def test_a_bridge_that_is_not_trusted_gets_no_password(self):
        done = wine.port("connect", *self.options("--tls", *self.login("ann", PASSWORDS["ann"])))
        self.assertEqual(done.returncode, NO_BRIDGE, done.stdout)
        self.assertIn("certificate verify failed", done.stderr)

    def test_a_password_that_others_may_read_is_not_used(self):
        done = wine.port("connect", *self.trusted(*self.login("ann", PASSWORDS["ann"], 0o644)))
        self.assertEqual(done.returncode, USAGE, done.stdout)
        self.assertIn("others may read or change it; in a command prompt: icacls", done.stderr)


class Service(OnePlant):
    CONFIG, NAMES = OPEN, ("main", "telnet")

    def test_programs_as_a_service_and_stops_cleanly(self):
        log = os.path.join(wine.folder.name, "service.log")
        command = ["connect", *self.options("--log", windows_path(log), "--reconnect")]
        # Wine ends its services with the last other program.
        self.enterContext(subprocess.Popen(wine.command("cmd"), env=wine.environment, stdin=subprocess.PIPE, stdout=subprocess.DEVNULL,
                                           stderr=subprocess.DEVNULL))
        installed = wine.port("service", "install", "plc", "--", *command)
        self.assertEqual(installed.returncode, STOPPED, installed.stderr)

        def paired():
            with contextlib.suppress(FileNotFoundError), open(log, encoding="utf-8") as file:
                return "paired" in file.read()
        try:
            started = wine.run("net", "start", "plc")
            self.assertEqual(started.returncode, 0, started.stdout)
            wait_until(paired, DEADLINE, "the service did not pair")
            run_session(self, lambda request: os.write(wine.software, request), wine.read_line)
            wine.run("net", "stop", "plc")
            self.row("ended: stopped by the engineer")
        finally:
            removed = wine.port("service", "remove", "plc")
        self.assertEqual(removed.returncode, STOPPED, removed.stderr)
        with open(log, encoding="utf-8") as file:
            self.assertIn("P1: stopped", file.read())

    def test_a_service_needs_a_log_and_whole_paths(self):
        for text, more in [("a service needs --log FILE", []), ("a service needs the whole path", ["--log", "session.log"])]:
            done = wine.port("service", "install", "plc", "--", "connect", *self.options(*more))
            self.assertEqual(done.returncode, USAGE, done.stdout)
            self.assertIn(text, done.stderr)
        self.assertEqual(wine.port("service", "remove", "plc").returncode, FAILURE)


class Installer(unittest.TestCase):
    def test_installs_and_removes_every_file(self):
        folder = os.path.join(wine.environment["WINEPREFIX"], "drive_c", "Program Files", "Fieldcast")
        entry = r"HKLM\Software\Microsoft\Windows\CurrentVersion\Uninstall\FieldcastPort"
        self.assertEqual(wine.run(SETUP, "/S").returncode, 0)
        self.assertEqual(sorted(os.listdir(folder)), ["fieldcast-port.exe", "license.txt", "notices.txt", "uninstall.exe"])
        self.assertIn("fieldcast-port ", wine.run(os.path.join(folder, "fieldcast-port.exe"), "--version").stdout)
        self.assertEqual(wine.run("reg", "query", entry, "/v", "DisplayName", "/reg:64").returncode, 0)
        wine.run(os.path.join(folder, "uninstall.exe"), "/S")  # continues in a copy of itself
        wait_until(lambda: not os.path.exists(folder), DEADLINE, lambda: f"{os.listdir(folder)} is left")
        self.assertNotEqual(wine.run("reg", "query", entry, "/v", "DisplayName", "/reg:64").returncode, 0)


if __name__ == "__main__":
    BIN, windows_folder = sys.argv[1:3]
    PROGRAM = os.path.join(windows_folder, "bin", "fieldcast-port.exe")
    SETUP, = glob.glob(os.path.join(windows_folder, "packages", "*-setup.exe"))
    unittest.main(argv=sys.argv[:1] + sys.argv[3:])
