"""Tests `port: { rfc2217: HOST:PORT }` and `fieldcast read rfc2217:HOST:PORT` with the servers of pyserial and ser2net over a
pseudo-terminal of fieldcast-sim.

usage: rfc2217_peers_test.py BIN_FOLDER
"""

import contextlib
import json
import os
import socket
import subprocess
import sys
import tempfile
import unittest

import serial

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "tools"))
from host_link_session import run_session
from peers import DEADLINE, Program, free_port, settings_of
from plant import claim_domain, running_bridge, wait_until

BIN = ""
PYSERIAL = os.path.join(os.path.dirname(os.path.abspath(__file__)), "pyserial_rfc2217.py")
DEVICES = """    protocol: omron-hostlink
    devices: [ { name: plc, address: 0, channels: [ { name: level, at: DM100, type: uint16, refresh: 200ms } ] } ]
"""


def accepts(port):
    with contextlib.suppress(OSError), socket.create_connection(("127.0.0.1", port), 1):
        return True
    return False


class Rfc2217Test(unittest.TestCase):
    def setUp(self):
        self.stack = self.enterContext(contextlib.ExitStack())
        self.folder = self.stack.enter_context(tempfile.TemporaryDirectory(prefix="fieldcast-rfc2217-"))
        self.port = free_port()
        self.line = os.path.join(self.folder, "line")

    def file(self, name, text):
        path = os.path.join(self.folder, name)
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)
        return path

    def simulate(self, settings):
        plant = self.file("sim.yaml", f"bridge: sim\nbuses:\n  - name: line\n    port: {{ serial: {self.line}, {settings} }}\n{DEVICES}")
        self.stack.enter_context(Program(os.path.join(BIN, "fieldcast-sim"), plant))
        wait_until(lambda: os.path.exists(self.line), DEADLINE, "the simulated line is missing")

    def pyserial(self, *more):
        return self.stack.enter_context(Program(sys.executable, PYSERIAL, self.port, self.line, *more)).wait_ready()

    def ser2net(self):
        text = (f"%YAML 1.1\n---\nconnection: &line\n  accepter: telnet(rfc2217),tcp,127.0.0.1,{self.port}\n"
                f"  connector: serialdev,{self.line},9600n81,local\n")
        self.stack.enter_context(Program("ser2net", "-n", "-c", self.file("ser2net.yaml", text)))
        wait_until(lambda: accepts(self.port), DEADLINE, "ser2net does not listen")

    def read(self, *more):
        done = subprocess.run([os.path.join(BIN, "fieldcast"), "read", f"rfc2217:127.0.0.1:{self.port}", "--protocol", "omron-hostlink",
                               "--address", "0", *more, "DM100"], capture_output=True, text=True, timeout=DEADLINE)
        return done.returncode, done.stdout + done.stderr

    @contextlib.contextmanager
    def bridge(self, settings, program="", devices=DEVICES):
        """A bridge with a bus behind the server; gives a function that waits for good samples."""
        domain, claim = claim_domain()
        with claim:
            config = self.file("bridge.yaml", f"bridge: b\n{program}dds: {{ domain: {domain}, interfaces: [127.0.0.1] }}\nbuses:\n"
                               f"  - name: far\n    port: {{ rfc2217: 127.0.0.1:{self.port}, {settings} }}\n{devices}")
            log = os.path.join(self.folder, "bridge.log")
            with running_bridge(BIN, config, log):
                def good():
                    done = subprocess.run([os.path.join(BIN, "fieldcast"), "watch", "--once", "--json", "--config", config],
                                          capture_output=True, text=True, timeout=DEADLINE)
                    samples = [json.loads(line) for line in done.stdout.splitlines()]
                    return [s for s in samples if s["quality"] == "GOOD"]
                yield lambda: wait_until(good, DEADLINE, lambda: open(log, encoding="utf-8").read())

    def bridge_reads(self, settings):
        with self.bridge(settings) as samples:
            return samples()

    def engineer_sets_the_line(self):
        def becomes(baud):
            wait_until(lambda: settings_of(self.line)[0] == baud, DEADLINE, lambda: f"{baud}, but {settings_of(self.line)}")
        outside = free_port()
        program = (f"program: {{ engineers: {{ listen: 127.0.0.1:{free_port()}, "
                   f"ports: [ {{ device: P1, listen: 127.0.0.1:{outside} }} ] }} }}\n")
        with self.bridge("baud: 115200, format: 7E2", program, DEVICES.replace("name: plc,", "name: plc, number: P1,")) as samples:
            samples()
            with serial.serial_for_url(f"rfc2217://127.0.0.1:{outside}", timeout=DEADLINE, baudrate=9600) as port:
                becomes(9600)
                port.baudrate = 19200
                becomes(19200)
                run_session(self, port.write, lambda: port.read_until(b"\r"))
            becomes(115200)
            samples()

    def test_reads_by_pyserial_at_7e2(self):
        self.simulate("baud: 115200, format: 7E2")
        self.pyserial()
        code, said = self.read("--baud", "115200", "--format", "7E2")
        self.assertEqual(code, 0, said)
        self.assertIn("DM100", said)

    def test_the_bridge_reads_by_pyserial(self):
        self.simulate("baud: 115200, format: 7E2")
        self.pyserial()
        self.assertEqual(self.bridge_reads("baud: 115200, format: 7E2")[0]["channel"], "level")

    def test_an_engineer_sets_the_line_of_a_server_of_pyserial(self):
        self.simulate("baud: 115200, format: 7E2")
        self.pyserial()
        self.engineer_sets_the_line()

    def test_an_engineer_sets_the_line_of_ser2net(self):
        self.simulate("baud: 115200, format: 7E2")
        self.ser2net()
        self.engineer_sets_the_line()

    def test_a_rate_that_is_not_in_force_is_a_fault(self):
        self.simulate("baud: 9600, format: 7E2")
        self.pyserial(9600)
        code, said = self.read("--baud", "115200", "--format", "7E2")
        self.assertNotEqual(code, 0)
        self.assertIn("the server reports baud rate 9600, configured is 115200", said)

    def test_reads_by_ser2net(self):
        self.simulate("baud: 115200, format: 7E2")
        self.ser2net()
        code, said = self.read("--baud", "115200", "--format", "7E2")
        self.assertEqual(code, 0, said)
        self.assertIn("DM100", said)

    def test_the_bridge_reads_by_ser2net(self):
        self.simulate("baud: 115200, format: 8N1")
        self.ser2net()
        self.assertEqual(self.bridge_reads("baud: 115200, format: 8N1")[0]["channel"], "level")

    def test_a_server_without_the_option_is_a_fault(self):
        self.simulate("baud: 115200, format: 7E2")
        self.stack.enter_context(Program("socat", f"TCP-LISTEN:{self.port},bind=127.0.0.1,reuseaddr,fork", f"{self.line},raw,echo=0"))
        wait_until(lambda: accepts(self.port), DEADLINE, "socat does not listen")
        code, said = self.read("--baud", "115200", "--format", "7E2")
        self.assertNotEqual(code, 0)
        self.assertIn("the server has not agreed on COM-PORT-OPTION (RFC 2217) within 3s", said)


if __name__ == "__main__":
    BIN = sys.argv.pop(1)
    unittest.main()
