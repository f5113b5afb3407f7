"""Tests `ports` of `engineers`: pyserial's rfc2217:// client, ser2net and a raw socket reach a simulated PLC, and a device that echoes,
through the bridge.

usage: rfc2217_engineer_test.py BIN_FOLDER
"""

import contextlib
import glob
import os
import pty
import random
import select
import socket
import subprocess
import sys
import tempfile
import threading
import tty
import unittest

import serial

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "tools"))
from host_link_session import run_session
from peers import DEADLINE, Program, free_port, settings_of
from plant import Plant, claim_domain, running_bridge, wait_until

BIN = ""
CONFIG = """
bridge: e2e
store: { path: {run}/plant.db, samples: [] }
program:
  engineers:
    listen: 127.0.0.1:{main}
    ports:
      - { device: P1, listen: 127.0.0.1:{telnet} }
      - { device: P1, listen: 127.0.0.1:{raw}, mode: raw }
buses:
  - name: line
    port: { serial: {run}/line, baud: 115200, format: 7E2, exclusive: false }
    protocol: omron-hostlink
    capture: { folder: {run}, only-sessions: true }
    devices:
      - { name: plc, number: P1, address: 0, channels: [ { name: level, at: DM100, type: uint16, refresh: 200ms } ] }
"""
ECHO = """bridge: echo
dds: { domain: {domain}, interfaces: [127.0.0.1] }
program: { engineers: { listen: 127.0.0.1:{main}, ports: [ { device: E1, listen: 127.0.0.1:{telnet} } ] } }
buses:
  - name: echo
    port: { serial: {line}, baud: 115200, format: 8N1, exclusive: false }
    protocol: omron-hostlink
    devices: [ { name: plc, number: E1, address: 0, channels: [ { name: level, at: DM100, type: uint16, refresh: 10s } ] } ]
"""


def rfc2217(port, **settings):
    return serial.serial_for_url(f"rfc2217://127.0.0.1:{port}", timeout=DEADLINE, **settings)


def connected(port):
    with contextlib.suppress(OSError):
        return socket.create_connection(("127.0.0.1", port), DEADLINE)


def read_line(lines):
    read = b""
    while not read.endswith(b"\r"):
        byte = lines.read(1)
        if not byte:
            raise EOFError(f"closed after {read}")
        read += byte
    return read


@contextlib.contextmanager
def spare_plc(folder, address=0):
    """A second simulated PLC; gives its line."""
    line, path = os.path.join(folder, "spare"), os.path.join(folder, "spare.yaml")
    with open(path, "w", encoding="utf-8") as file:
        file.write("bridge: spare\nbuses:\n  - name: spare\n    port: { serial: " + line + ", baud: 115200, format: 7E2 }\n"
                   "    protocol: omron-hostlink\n    devices: [ { name: plc, address: " + str(address) +
                   ", channels: [ { name: level, at: DM100, type: uint16 } ] } ]\n")
    with Program(os.path.join(BIN, "fieldcast-sim"), path):
        wait_until(lambda: os.path.exists(line), DEADLINE, "the line of the spare PLC is missing")
        yield line


def replay(file, line, *options):
    done = subprocess.run([os.path.join(BIN, "fieldcast"), "replay", file, line, *options], capture_output=True, text=True, timeout=6 * DEADLINE)
    return done.returncode, done.stdout + done.stderr


SEVEN_E_TWO = {"baudrate": 115200, "bytesize": 7, "parity": "E", "stopbits": 2}


class PlcTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.ports = {name: free_port() for name in ("main", "telnet", "raw")}
        config = CONFIG
        for name, port in cls.ports.items():
            config = config.replace("{" + name + "}", str(port))
        cls.plant = cls.enterClassContext(Plant(BIN, config))

    def ended(self, result):
        def row():
            done = self.plant.cli("audit", "--json")
            return done.code == 0 and [entry for entry in done.json_lines() if result in entry["result"]]
        return wait_until(row, DEADLINE, f"no row of the audit with '{result}'")[-1]

    def test_programs_by_rfc2217_and_the_audit_has_every_byte(self):
        with rfc2217(self.ports["telnet"], **SEVEN_E_TWO) as port:
            sent, received = run_session(self, port.write, lambda: port.read_until(b"\r"))
            self.assertTrue(port.cts and port.dsr and port.cd)
        row = self.ended("ended: the client disconnected")
        self.assertEqual((row["bytes_to_device"], row["bytes_from_device"], row["target"]), (sent, received, "line/plc"))
        self.assertIn("paired, RFC 2217", str(self.plant.cli("audit", "--json").out))

    def test_a_recorded_session_can_be_inspected_and_repeated(self):
        before = set(glob.glob(os.path.join(self.plant.run, "line-*.pcapng")))
        with rfc2217(self.ports["telnet"], **SEVEN_E_TWO) as port:
            run_session(self, port.write, lambda: port.read_until(b"\r"))
        self.ended("ended: the client disconnected")

        def explained():
            files = set(glob.glob(os.path.join(self.plant.run, "line-*.pcapng"))) - before
            return [done for done in [self.plant.cli("inspect", *files)] if "240 frames, 0 with a fault" in done.err] if files else []
        done = wait_until(explained, DEADLINE, "no file with 240 frames")[0]
        self.assertIn("programming session of 127.0.0.1:", done.out)
        file, = set(glob.glob(os.path.join(self.plant.run, "line-*.pcapng"))) - before
        with spare_plc(self.plant.run) as line:
            self.assertEqual(replay(file, line), (0, "120 requests, 0 with another response\n"))
        with spare_plc(self.plant.run, address=1) as line:  # another node does not respond
            code, said = replay(file, line, "--timeout", "20ms")
            self.assertEqual(code, 1)
            self.assertIn("120 requests, 120 with another response\n", said)
            self.assertIn("request 1: 40 30 30 57 44", said)
            self.assertIn("  received  nothing\n", said)

    def test_programs_by_raw_bytes(self):
        with socket.create_connection(("127.0.0.1", self.ports["raw"]), DEADLINE) as peer, peer.makefile("rb") as lines:
            run_session(self, peer.sendall, lambda: read_line(lines))
        self.ended("paired, raw bytes")

    def test_the_line_follows_the_software_and_has_its_own_settings_again(self):
        def becomes(*wanted):
            path = os.path.join(self.plant.run, "line")
            wait_until(lambda: settings_of(path) == wanted, DEADLINE, lambda: f"{wanted}, but {settings_of(path)}")
        becomes(115200, True)
        with rfc2217(self.ports["telnet"], baudrate=9600, bytesize=8, parity="N", stopbits=1) as port:
            becomes(9600, False)
            port.baudrate = 19200
            becomes(19200, False)
            port.dtr = port.rts = False
            port.send_break(0.01)
            port.reset_output_buffer()
            port.reset_input_buffer()
        becomes(115200, True)

    def test_programs_through_ser2net_as_the_client(self):
        outside, config = free_port(), os.path.join(self.plant.run, "ser2net.yaml")
        with open(config, "w", encoding="utf-8") as file:
            file.write(f"%YAML 1.1\n---\nconnection: &plc\n  accepter: tcp,127.0.0.1,{outside}\n"
                       f"  connector: telnet(rfc2217),tcp,127.0.0.1,{self.ports['telnet']}\n")
        with Program("ser2net", "-n", "-c", config):
            peer = wait_until(lambda: connected(outside), DEADLINE, "ser2net does not listen")
            with peer, peer.makefile("rb") as lines:
                run_session(self, peer.sendall, lambda: read_line(lines))
        self.ended("ended: the client disconnected")

    def test_a_second_user_is_refused(self):
        with rfc2217(self.ports["telnet"], **SEVEN_E_TWO):
            with socket.create_connection(("127.0.0.1", self.ports["telnet"]), DEADLINE) as peer, peer.makefile("rb") as all_bytes:
                self.assertIn(b"refused: ", all_bytes.read())


class Echo:
    """A pseudo-terminal whose device returns every byte."""

    def __enter__(self):
        self.master, self.slave = pty.openpty()
        tty.setraw(self.slave)
        os.set_blocking(self.master, False)
        self.path, self.over = os.ttyname(self.slave), threading.Event()
        self.thread = threading.Thread(target=self._run)
        self.thread.start()
        return self

    def _run(self):
        waiting = b""
        while not self.over.is_set():
            reads, writes = [self.master] if len(waiting) < 4096 else [], [self.master] if waiting else []
            readable, writable, _ = select.select(reads, writes, [], 0.1)
            with contextlib.suppress(BlockingIOError):
                if writable:
                    waiting = waiting[os.write(self.master, waiting):]
                if readable:
                    waiting += os.read(self.master, 4096)

    def __exit__(self, *_):
        self.over.set()
        self.thread.join()
        os.close(self.master)
        os.close(self.slave)


class EchoTest(unittest.TestCase):
    def test_two_mebibytes_in_both_directions_are_byte_exact(self):
        with contextlib.ExitStack() as stack:
            folder = stack.enter_context(tempfile.TemporaryDirectory(prefix="fieldcast-rfc2217-"))
            domain, claim = claim_domain()
            stack.enter_context(claim)
            device = stack.enter_context(Echo())
            config = ECHO.replace("{domain}", str(domain)).replace("{line}", device.path)
            ports = {name: free_port() for name in ("main", "telnet")}
            for name, port in ports.items():
                config = config.replace("{" + name + "}", str(port))
            path = os.path.join(folder, "echo.yaml")
            with open(path, "w", encoding="utf-8") as file:
                file.write(config)
            stack.enter_context(running_bridge(BIN, path, os.path.join(folder, "log")))

            def opened():
                with contextlib.suppress(OSError, serial.SerialException):
                    return rfc2217(ports["telnet"], baudrate=115200)
            port = stack.enter_context(wait_until(opened, DEADLINE, "the port never opened"))
            port.reset_input_buffer()
            data = random.Random(1).randbytes(2 << 20)
            writer = threading.Thread(target=lambda: [port.write(data[at:at + 4096]) for at in range(0, len(data), 4096)])
            writer.start()
            read = port.read(len(data))
            writer.join()
            self.assertEqual(len(read), len(data))
            self.assertTrue(read == data)


if __name__ == "__main__":
    BIN = sys.argv.pop(1)
    unittest.main()
