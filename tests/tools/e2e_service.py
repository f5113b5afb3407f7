"""Tests fieldcast-bridge as a service: its messages to the service manager, and the priorities of
its log lines. The test provides the notify socket and the journal's stream.

usage: e2e_service.py BIN_DIR
"""

import os
import signal
import socket
import subprocess
import sys
import tempfile
import time
import unittest

from held_thread import HeldThread
from plant import claim_domain, wait_until

BIN_DIR = ""
LIMIT = 60

CONFIG = """
bridge: served
dds: { domain: DOMAIN, interfaces: [127.0.0.1] }
buses:
  - name: line
    port: { serial: RUN/none }
    protocol: modbus-rtu
    devices:
      - name: meter
        address: 1
        channels:
          - { name: a, at: "holding:0", type: uint16 }
"""


class Service(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="fieldcast-service-")
        self.addCleanup(folder.cleanup)
        domain, claim = claim_domain()
        self.addCleanup(claim.close)
        self.file = os.path.join(folder.name, "plant.yaml")
        with open(self.file, "w", encoding="utf-8") as file:
            file.write(CONFIG.replace("DOMAIN", str(domain)).replace("RUN", folder.name))
        self.manager = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
        self.addCleanup(self.manager.close)
        self.manager.bind(os.path.join(folder.name, "notify"))
        self.journal_path = os.path.join(folder.name, "journal")
        self.journal = open(self.journal_path, "w", encoding="utf-8")
        self.addCleanup(self.journal.close)
        self.told = ""

    def start(self):
        stream = os.fstat(self.journal.fileno())
        environment = {**os.environ, "NOTIFY_SOCKET": self.manager.getsockname(), "WATCHDOG_USEC": "600000",
                       "JOURNAL_STREAM": f"{stream.st_dev}:{stream.st_ino}"}
        self.bridge = subprocess.Popen([os.path.join(BIN_DIR, "fieldcast-bridge"), self.file], env=environment, stderr=self.journal)
        self.addCleanup(self.end)

    def end(self):
        if self.bridge.poll() is None:
            self.bridge.kill()
        self.bridge.wait()

    def await_line(self, line):
        """Reads messages until one has this line; earlier ones are in self.told."""
        end = time.monotonic() + LIMIT
        while True:
            message = self.receive()
            self.told += message + "\n"
            if line in message.splitlines():
                return
            self.assertLess(time.monotonic(), end, f"no {line}; told: {self.told}\n{self.log()}")

    def receive(self):
        self.manager.settimeout(LIMIT)
        try:
            return self.manager.recv(4096).decode()
        except TimeoutError:
            self.fail(f"nothing for {LIMIT} s; told: {self.told}\n{self.log()}")

    def log(self):
        with open(self.journal_path, encoding="utf-8") as file:
            return file.read()

    def test_it_is_ready_fed_reloaded_and_stopped(self):
        self.start()
        self.await_line("READY=1")
        self.assertNotIn("WATCHDOG", self.told, "fed before it was ready")
        self.await_line("WATCHDOG=1")
        self.await_line("WATCHDOG=1")
        self.bridge.send_signal(signal.SIGHUP)
        self.await_line("RELOADING=1")
        self.await_line("READY=1")
        self.await_line("WATCHDOG=1")
        self.assertEqual(self.told.count("STATUS=1 bus, DDS domain "), 2, "at the start and after the reload")
        self.bridge.send_signal(signal.SIGTERM)
        self.await_line("STOPPING=1")
        self.assertEqual(self.bridge.wait(LIMIT), 0)
        lines = self.log().splitlines()
        self.assertIn("<6>served: running: 1 bus, ", "\n".join(lines))
        self.assertTrue(any(line.startswith("<4>line: ") or line.startswith("<3>line: ") for line in lines), lines)
        self.assertEqual([line for line in lines if line[:1] != "<" or line[2:3] != ">"], [])

    def test_a_bus_that_stands_is_named_and_the_watchdog_is_not_fed(self):
        self.start()
        self.await_line("WATCHDOG=1")
        with HeldThread(self.bridge.pid, "line"):
            while "STATUS=line: the bus stands" not in self.told:
                self.told += self.receive() + "\n"
            self.manager.settimeout(1)
            with self.assertRaises(TimeoutError):
                self.manager.recv(4096)
        self.await_line("WATCHDOG=1")
        for line in ["<3>line: the bus stands", "<4>line: the bus turns again"]:
            wait_until(lambda said=line: said in self.log(), LIMIT, lambda said=line: f"no '{said}' in\n{self.log()}")

    def test_a_refused_reload_is_in_the_status_until_one_is_taken(self):
        self.start()
        self.await_line("READY=1")
        with open(self.file, encoding="utf-8") as file:
            good = file.read()
        for text, refused in [(good + "nonsense: true\n", True), (good, False)]:
            with open(self.file, "w", encoding="utf-8") as file:
                file.write(text)
            self.told = ""
            self.bridge.send_signal(signal.SIGHUP)
            self.await_line("RELOADING=1")
            self.await_line("READY=1")
            self.assertEqual("; the last reload was refused, the log says why" in self.told, refused, self.told)
            self.assertIn("STATUS=1 bus, DDS domain ", self.told)

    def test_a_configuration_with_faults_is_never_ready(self):
        with open(self.file, "a", encoding="utf-8") as file:
            file.write("nonsense: true\n")
        self.start()
        self.assertEqual(self.bridge.wait(LIMIT), 3)
        self.manager.settimeout(0.01)
        with self.assertRaises(TimeoutError):
            self.manager.recv(4096)


if __name__ == "__main__":
    BIN_DIR = sys.argv[1]
    unittest.main(argv=sys.argv[:1], verbosity=2)
