"""Tests programming of a simulated PLC through the bridge, over TLS and with a user of a real
store. Users without the right are refused and slowed down; the audit has a row for each
attempt.

usage: e2e_program.py BIN_DIR
"""

import fcntl
import json
import os
import re
import select
import socket
import struct
import subprocess
import sys
import tempfile
import termios
import time
import tty
import unittest

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "interop"))
from peers import free_port
from plant import Failure, Plant, wait_until

BIN_DIR = ""
DEADLINE = 30         # seconds, for operations that take well under one
FAILURE, USAGE, REFUSED, NO_BRIDGE = 1, 2, 3, 5  # exit codes of fieldcast-port
TCGETS2 = 0x802C542A  # supports any baud rate; struct termios2: c_cflag at 8, c_ospeed at 40

# Listens on every address, so the bridge requires a login.
CONFIG = """
bridge: e2e
store: { path: {run}/plant.db, samples: [] }
program: { engineers: { listen: "0.0.0.0:{port}", certificate: {keys}/cert.pem, key: {keys}/key.pem } }
buses:
  - name: line
    port: { serial: {run}/line, baud: 115200, format: 7E2, exclusive: false }
    protocol: omron-hostlink
    devices:
      - { name: plc, number: P1, address: 0, channels: [ { name: cycle, at: DM100, type: uint16, refresh: 200ms } ] }
"""

PASSWORDS = {"ann": "correct horse", "bob": "battery staple", "vic": "only looking"}
ROLES = {"ann": "programmer", "bob": "programmer", "vic": "viewer"}

plant = keys = port = None


def setUpModule():
    global plant, keys, port
    keys = tempfile.TemporaryDirectory(prefix="fieldcast-e2e-keys-")
    certificate, key = (os.path.join(keys.name, name) for name in ("cert.pem", "key.pem"))
    subprocess.run(["openssl", "req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:prime256v1", "-nodes", "-days", "2",
                    "-subj", "/CN=bridge", "-addext", "subjectAltName=IP:127.0.0.1", "-keyout", key, "-out", certificate],
                   check=True, capture_output=True, timeout=60)
    port = free_port()
    plant = unittest.enterModuleContext(Plant(BIN_DIR, CONFIG.replace("{port}", str(port)).replace("{keys}", keys.name)))
    for name, password in PASSWORDS.items():
        subprocess.run([os.path.join(BIN_DIR, "fieldcast"), "user", "add", name, "--role", ROLES[name], "--config", plant.file],
                       input=password + "\n", text=True, check=True, capture_output=True, timeout=60)


def tearDownModule():
    keys.cleanup()


def login(user=None, password=None):
    """Returns the options of the bridge and of a login."""
    options = ["--server", f"127.0.0.1:{port}", "--ca", os.path.join(keys.name, "cert.pem")]
    if user is None:
        return options
    path = os.path.join(keys.name, "password-" + user)
    with open(os.open(path, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o600), "w", encoding="utf-8") as file:
        file.write(password + "\n")
    return options + ["--user", user, "--password-file", path]


def command(link, user=None, password=None, more=()):
    return [os.path.join(BIN_DIR, "fieldcast-port"), "--device", "P1", "--link", link, "--json", *more, *login(user, password)]


def run_list(*options):
    return subprocess.run([os.path.join(BIN_DIR, "fieldcast-port"), "list", *options], capture_output=True, text=True, timeout=DEADLINE)


def refused(user=None, password=None):
    """Returns the message of fieldcast-port for a login that must fail; Failure if it pairs."""
    ended = subprocess.run(command(os.path.join(plant.run, "refused"), user, password), capture_output=True, text=True, timeout=DEADLINE)
    if ended.returncode != REFUSED:
        raise Failure(f"exit code {ended.returncode}: {ended.stdout}{ended.stderr}")
    return ended.stderr


def audit():
    result = plant.cli("audit", "--json")
    return result.json_lines() if result.code == 0 else []


def row(what, result, who=""):
    def found():
        return next((entry for entry in reversed(audit())
                     if entry["what"] == what and result in entry["result"] and entry["who"].startswith(who)), None)
    return wait_until(found, DEADLINE, lambda: f"a row '{what}' of '{who}' with '{result}' in {audit()}")


class Paired:
    """A paired fieldcast-port, with its virtual port opened as programming software does."""

    def __init__(self, user, *more):
        self.link = os.path.join(plant.run, "plc")
        self.process = subprocess.Popen(command(self.link, user, PASSWORDS[user], more), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)

    def __enter__(self):
        states = []
        for line in self.process.stdout:  # ends with the process
            states.append(json.loads(line).get("state"))
            if states[-1] == "paired":
                self.line = os.open(self.link, os.O_RDWR | os.O_NOCTTY)
                tty.setraw(self.line)
                return self
        raise Failure(f"not paired, but {states}: {self.process.communicate(timeout=DEADLINE)[1]}")

    def ask(self, instruction):
        os.write(self.line, instruction)
        answer = b""
        deadline = time.monotonic() + DEADLINE
        while not answer.endswith(b"\r"):
            if not select.select([self.line], [], [], max(0, deadline - time.monotonic()))[0]:
                raise Failure(f"no response to {instruction}, but {answer}")
            answer += os.read(self.line, 4096)
        return answer

    def __exit__(self, *_):
        os.close(self.line)
        self.process.terminate()
        self.rest = self.process.communicate(timeout=DEADLINE)[0]


def line_settings():
    """The line is a pseudo-terminal: it ignores data bits and "parity on"."""
    line = os.open(os.path.join(plant.run, "line"), os.O_RDWR | os.O_NOCTTY | os.O_NONBLOCK)
    try:
        settings = fcntl.ioctl(line, TCGETS2, bytes(44))
    finally:
        os.close(line)
    flags, baud = struct.unpack_from("I", settings, 8)[0], struct.unpack_from("I", settings, 40)[0]
    return baud, bool(flags & termios.CSTOPB), bool(flags & termios.PARODD)


def host_link(text):
    check = 0
    for character in text.encode():
        check ^= character
    return f"{text}{check:02X}*\r".encode()


class Programming(unittest.TestCase):
    def test_a_programmer_reaches_the_plc_and_the_audit_has_every_byte(self):
        instruction = host_link("@00RD01000003")
        before = len(audit())
        with Paired("ann") as session:
            answer = session.ask(instruction)
            self.assertRegex(answer, rb"\A@00RD00[0-9A-F]{12}[0-9A-F]{2}\*\r\Z")  # end code 00, three words
            self.assertEqual(host_link(answer[:-4].decode()), answer)
        self.assertEqual(session.process.returncode, 0, session.rest)
        ended = row("program", "ended: stopped by the engineer")
        self.assertRegex(ended["who"], r"\Aann \(127\.0\.0\.1:\d+\)\Z")
        self.assertEqual(ended["target"], "line/plc")
        self.assertEqual((ended["bytes_to_device"], ended["bytes_from_device"]), (len(instruction), len(answer)))
        self.assertLess(abs(time.time() - ended["at"] / 1e9), 600)
        rows = [(entry["what"], entry["who"].split()[0], entry["result"].split(",")[0]) for entry in audit()[before:]]
        for expected in (("login", "ann", "done"), ("program", "ann", "paired"), ("program", "ann", "ended: stopped by the engineer")):
            self.assertIn(expected, rows)
        shown = plant.cli("audit")
        self.assertRegex(shown.out, rf"Z  ann \(127\.0\.0\.1:\d+\)  program line/plc  {len(instruction)} bytes to the device, "
                                    rf"{len(answer)} from it  ended: stopped by the engineer")

    def test_nobody_else_gets_the_list(self):
        for options, message in [(login(), "a login of a user with the role programmer is needed"),
                                 (login("vic", PASSWORDS["vic"]), "the login of vic is refused")]:
            listed = run_list(*options, "--json")
            self.assertEqual((listed.returncode, listed.stdout), (REFUSED, ""))
            self.assertIn(f"127.0.0.1:{port}: {message}", listed.stderr)
        row("program", "login refused: the list of devices was requested without a login")

    def test_the_message_names_a_bridge_that_is_too_old_or_not_there(self):
        """An earlier bridge replies to the request as to a device number that it does not accept."""
        for reply, code, message in [(b"@@0001FEFF", REFUSED, "the bridge does not list its devices: update it"),
                                     (b"HTTP/1.1 400 Bad Request", FAILURE, "the peer is not a Fieldcast bridge"),
                                     (b"", NO_BRIDGE, "the bridge disconnected: ")]:
            with self.subTest(message), socket.create_server(("127.0.0.1", 0)) as server:
                place = "127.0.0.1:%d" % server.getsockname()[1]
                with subprocess.Popen([os.path.join(BIN_DIR, "fieldcast-port"), "list", "--server", place], stdout=subprocess.PIPE,
                                      stderr=subprocess.PIPE, text=True) as process:
                    server.settimeout(DEADLINE)
                    with server.accept()[0] as peer:
                        self.assertEqual(peer.recv(100), b"@@LS:FEFF")
                        peer.sendall(reply)
                    out, said = process.communicate(timeout=DEADLINE)
                self.assertEqual((process.returncode, out), (code, ""))
                self.assertIn(f"fieldcast-port: {place}: {message}", said)
        listed = run_list("--server", place)
        self.assertEqual(listed.returncode, NO_BRIDGE)
        self.assertIn("Connection refused", listed.stderr)

    def test_the_list_has_each_device_and_who_uses_it(self):
        def listed():  # the session of an earlier test may still end
            done = run_list(*login("ann", PASSWORDS["ann"]), "--json")
            self.assertEqual(done.returncode, 0, done.stderr)
            return [json.loads(line) for line in done.stdout.splitlines()]
        free = [{"number": "P1", "bus": "line", "device": "plc", "state": "free", "who": ""}]
        wait_until(lambda: listed() == free, DEADLINE, lambda: f"{free}, but {listed()}")
        with Paired("ann"):
            shown = run_list(*login("ann", PASSWORDS["ann"]))
            self.assertRegex(shown.stdout, r"\AP1  line/plc  in use by ann \(127\.0\.0\.1:\d+\)\n\Z")
        row("program", "1 device listed", who="ann (127.0.0.1:")
        row("program", "ended: the client disconnects after the list of devices", who="ann (127.0.0.1:")

    def test_the_list_needs_only_the_bridge(self):
        for options, message in [((), "--server is required"), (("--server", "here"), "--server 'here' names no host and port")]:
            listed = run_list(*options)
            self.assertEqual(listed.returncode, USAGE)
            self.assertIn(message, listed.stderr)
        paired = subprocess.run([os.path.join(BIN_DIR, "fieldcast-port"), "--server", "127.0.0.1:1"], capture_output=True, text=True, timeout=DEADLINE)
        self.assertEqual(paired.returncode, USAGE)
        self.assertIn("--device is required", paired.stderr)

    def test_the_line_takes_the_settings_of_the_software_and_has_its_own_again_afterwards(self):
        def becomes(*wanted):
            wait_until(lambda: line_settings() == wanted, DEADLINE, lambda: f"{wanted}, but {line_settings()}")
        becomes(115200, True, False)
        with Paired("ann", "--line", "7O1") as session:
            becomes(115200, False, True)
            settings = termios.tcgetattr(session.line)
            settings[4] = settings[5] = termios.B9600
            termios.tcsetattr(session.line, termios.TCSANOW, settings)
            becomes(9600, False, True)
        becomes(115200, True, False)

    def test_a_wrong_password_is_refused_and_audited(self):
        said = refused("ann", "wrong horse")
        self.assertIn("the login of ann is refused: a wrong password", said)
        row("login", "refused: wrong user or password", who="ann from 127.0.0.1")
        entry = row("program", "login refused: user ann: wrong user or password")
        self.assertRegex(entry["who"], r"\A127\.0\.0\.1:\d+\Z")
        self.assertEqual((entry["bytes_to_device"], entry["bytes_from_device"]), (0, 0))
        self.assertNotIn("wrong horse", str(audit()))

    def test_a_viewer_is_refused_and_audited(self):
        self.assertIn("another role than programmer", refused("vic", PASSWORDS["vic"]))
        row("program", "login refused: user vic: the role viewer may not program")

    def test_nobody_comes_without_a_login(self):
        self.assertIn("a login of a user with the role programmer is needed", refused())
        row("program", "device P1 was asked for without a login")

    # Wrong passwords delay the next attempt (1 s, 2 s, 4 s, …), so one is eventually too early.
    def test_guessing_is_slowed_down_and_the_right_password_has_to_wait_too(self):
        def too_soon():
            refused("bob", "a guess")
            return next((entry for entry in audit() if re.search(r"bob: too many wrong passwords, try again in \d+s", entry["result"])), None)
        wait_until(too_soon, DEADLINE, lambda: f"no guess was too soon: {audit()}")

        def let_in():
            try:
                with Paired("bob"):
                    return True
            except Failure:
                return False
        wait_until(let_in, DEADLINE, "the right password never came through again")
        done = row("login", "done", who="bob ")["at"]
        wrong = [entry["at"] for entry in audit() if entry["who"] == "bob from 127.0.0.1" and entry["result"] == "refused: wrong user or password"]
        self.assertGreaterEqual(len(wrong), 3)
        # a delay of a second; rows are written slightly later
        self.assertGreater(done - wrong[-1], 0.9e9)


if __name__ == "__main__":
    BIN_DIR = sys.argv[1]
    unittest.main(argv=sys.argv[:1], verbosity=2)
