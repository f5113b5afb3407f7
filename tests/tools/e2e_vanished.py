"""A peer of a programming session vanishes without a word: its machine is cut off, or its process stands still. The session ends within
its limit, the line is the bus's again, and the list of sessions and the audit say so.

usage: e2e_vanished.py BIN_DIR

Needs root, for networks of its own.
"""

import json
import os
import signal
import subprocess
import sys
import tempfile
import time
import unittest

import networks
from plant import Plant, wait_until

BIN_DIR = ""
DEADLINE = 30  # seconds, for what takes well under one
HEARTBEAT = 1  # seconds
# Three missed heartbeats and half of one; then the report, and what a busy machine adds.
CLIENT_LIMIT = 3.5 * HEARTBEAT + 4
# The keep-alive of TCP: 10 s without a byte, three probes each 3 s; the bridge looks each second; and as above.
DEVICE_LIMIT = 10 + 3 * 3 + 1 + 4
# The client misses the bridge after three heartbeats of its own period, 5 s.
BRIDGE_LIMIT = 3.5 * 5 + 4
PORT = 4950

CONFIG = """
bridge: e2e
store: { path: {run}/plant.db, samples: [] }
program: { engineers: { listen: "0.0.0.0:4950", certificate: {keys}/cert.pem, key: {keys}/key.pem, heartbeat: 1s } }
buses:
  - name: line
    port: { serial: {run}/line, baud: 115200, format: 7E2, exclusive: false }
    protocol: omron-hostlink
    devices:
      - { name: plc, number: P1, address: 0, channels: [ { name: cycle, at: DM100, type: uint16, refresh: 200ms } ] }
  - name: far
    port: { tcp: "{far}:4001" }
    protocol: omron-hostlink
    devices:
      - { name: plc, number: P2, address: 0, channels: [ { name: cycle, at: DM100, type: uint16, refresh: 200ms } ] }
"""

# A serial-to-network module with a PLC whose words are all 0: one connection after the other.
MODULE = """
import functools, operator, socket, sys
listener = socket.create_server((sys.argv[1], 4001))
while True:
    connection = listener.accept()[0]
    while request := connection.recv(4096):
        answer = b"@00RD00" + b"0000" * int(request[9:13])
        connection.sendall(answer + b"%02X*\\r" % functools.reduce(operator.xor, answer))
"""


class OneLine(Plant):
    """A plant that is there once its serial bus runs."""

    def _status(self):
        result = self.cli("status", "--json")
        return result.code == 0 and any(line.get("state") == "running" and line["bus"] == "line" for line in result.json_lines())


class Vanished(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.engineer, cls.module = networks.Wire("engineer"), networks.Wire("module")
        folder = tempfile.TemporaryDirectory(prefix="fieldcast-e2e-keys-")
        cls.addClassCleanup(folder.cleanup)
        cls.keys = folder.name
        subprocess.run(["openssl", "req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:prime256v1", "-nodes", "-days", "2",
                        "-subj", "/CN=bridge", "-addext", f"subjectAltName=IP:{cls.engineer.near_address}",
                        "-keyout", f"{cls.keys}/key.pem", "-out", f"{cls.keys}/cert.pem"], check=True, capture_output=True, timeout=60)
        module = cls.module.far.start(sys.executable, "-c", MODULE, cls.module.far_address)
        cls.addClassCleanup(lambda: (module.kill(), module.wait()))
        cls.plant = OneLine(BIN_DIR, CONFIG.replace("{keys}", cls.keys).replace("{far}", cls.module.far_address))
        cls.plant.__enter__()
        cls.addClassCleanup(lambda: cls.plant.__exit__(None, None, None))
        with open(os.open(f"{cls.keys}/password", os.O_WRONLY | os.O_CREAT, 0o600), "w", encoding="utf-8") as file:
            file.write("correct horse\n")
        subprocess.run([os.path.join(BIN_DIR, "fieldcast"), "user", "add", "ann", "--role", "programmer", "--config", cls.plant.file],
                       input="correct horse\n", text=True, check=True, capture_output=True, timeout=60)

    def pair(self, number):
        """fieldcast-port on the engineer's machine, once it is paired."""
        port = self.engineer.far.start(
            os.path.join(BIN_DIR, "fieldcast-port"), "--server", f"{self.engineer.near_address}:{PORT}", "--device", number, "--json",
            "--link", os.path.join(self.plant.run, number), "--ca", f"{self.keys}/cert.pem", "--user", "ann", "--password-file", f"{self.keys}/password",
            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.addCleanup(lambda: (port.kill(), port.communicate()))
        states = []
        for line in port.stdout:  # ends with the process
            states.append(json.loads(line).get("state"))
            if states[-1] == "paired":
                return port
        self.fail(f"{states}: {port.communicate(timeout=DEADLINE)[1]}")

    def session(self, bus):
        shown = self.plant.cli("sessions", "--json").json_lines()
        return next((session["state"] for session in shown if session["bus"] == bus), None)

    def bus_state(self, bus):
        shown = self.plant.cli("status", "--json").json_lines()
        return next(line["state"] for line in shown if line["topic"] == "BusStatus" and line["bus"] == bus)

    def ends(self, bus, vanish, limit, reason):
        """After vanish() the session is closed within the limit, the line is the bus's, and the audit has the reason."""
        wait_until(lambda: self.session(bus) == "open", DEADLINE, "the session is not in the list")
        self.assertEqual(self.bus_state(bus), "leased")
        vanish()
        began = time.monotonic()
        wait_until(lambda: self.session(bus) == "closed", limit, lambda: f"the session is {self.session(bus)}")
        took = time.monotonic() - began
        wait_until(lambda: self.bus_state(bus) != "leased", DEADLINE, "the line is not the bus's again")

        def audited():
            rows = self.plant.cli("audit", "--json").json_lines()
            return [row["result"] for row in rows if row["what"] == "program" and row["target"] == bus + "/plc" and reason in row["result"]]
        found = wait_until(audited, DEADLINE, lambda: f"no row with '{reason}': " + self.plant.cli("audit").out)
        print(f"  {self.id().rsplit('.', 1)[-1]}: after {took:.1f} s: {found[-1]}")

    def reads_again(self):
        shown = self.plant.cli("watch", "line/plc/cycle", "--json", "--once").json_lines()
        return shown and shown[-1]["quality"] == "GOOD" and time.time() - shown[-1]["acquired_at"] / 1e9 < 1

    def test_an_engineer_whose_machine_is_cut_off_loses_the_device(self):
        port = self.pair("P1")
        self.addCleanup(lambda: self.engineer.cut(False))
        self.ends("line", self.engineer.cut, CLIENT_LIMIT, "3 heartbeats of the client are missing")
        wait_until(self.reads_again, DEADLINE, "the bus does not read")
        self.assertNotEqual(port.wait(BRIDGE_LIMIT), 0, "fieldcast-port ends by itself, too")

    def test_an_engineer_whose_program_stands_still_loses_the_device(self):
        port = self.pair("P1")
        self.ends("line", lambda: port.send_signal(signal.SIGSTOP), CLIENT_LIMIT, "3 heartbeats of the client are missing")
        wait_until(self.reads_again, DEADLINE, "the bus does not read")
        port.send_signal(signal.SIGCONT)
        self.assertNotEqual(port.wait(DEADLINE), 0)

    def module_vanishes(self):
        # At its end: what this machine's own filter drops, its kernel takes for congestion, and does not count.
        self.module.far.run("nft", "-f", "-", stdin="""
            table netdev vanished {
              chain in { type filter hook ingress device "from-module" priority 0; policy drop; }
            }""")

    def test_a_module_that_is_cut_off_ends_the_session(self):
        port = self.pair("P2")
        # As behind a router: this machine does not notice by itself that nobody is at the address any more.
        link = subprocess.run(self.module.far.around("cat", "/sys/class/net/from-module/address"), check=True, capture_output=True, text=True)
        networks.system("ip", "neigh", "replace", self.module.far_address, "lladdr", link.stdout.strip(), "dev", self.module.device, "nud", "permanent")
        self.ends("far", self.module_vanishes, DEVICE_LIMIT, "the device is lost: it no longer responds")
        self.assertNotEqual(port.wait(DEADLINE), 0)


if __name__ == "__main__":
    BIN_DIR = sys.argv[1]
    networks.enter()
    unittest.main(argv=sys.argv[:1] + sys.argv[2:], verbosity=2)
