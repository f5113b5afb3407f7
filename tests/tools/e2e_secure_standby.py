"""Two bridges of a standby group with DDS Security: a takeover, and certificates that are renewed without a gap.

usage: e2e_secure_standby.py BIN_DIR
"""

import os
import shutil
import signal
import socket
import subprocess
import tempfile
import threading
import time
import unittest

from e2e_standby import BIN_DIR, SECONDS, Watch, serve_device
from plant import claim_domain, run_cli, wait_until

CONFIG = """
bridge: {{ name: {name}, standby: {{ group: g, strength: {strength} }} }}
dds: {{ domain: {domain}, interfaces: [127.0.0.1], security: {folder} }}
buses:
  - name: one
    port: {{ tcp: "127.0.0.1:{port}" }}
    protocol: modbus-tcp
    devices:
      - name: plc
        address: 1
        channels:
          - {{ name: count, at: "holding:0", type: uint16, refresh: 50ms }}
"""


class SecureStandby(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp(prefix="fieldcast-secure-standby-")
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)
        self.domain, claim = claim_domain()
        self.addCleanup(claim.close)
        device = socket.create_server(("127.0.0.1", 0))
        self.addCleanup(device.close)

        def serve():
            try:
                serve_device(device)
            except OSError:
                pass  # it is closed

        threading.Thread(target=serve, daemon=True).start()
        self.authority = os.path.join(self.folder, "plant")
        self.secure("init", self.authority)
        for member in (["bridge", "a"], ["bridge", "b"], ["plant", "mes"]):
            self.secure("add", *member, "--authority", self.authority)
        for name, strength in (("a", 2), ("b", 1)):
            with open(self.path(name, "yaml"), "w", encoding="utf-8") as file:
                file.write(CONFIG.format(name=name, strength=strength, domain=self.domain, folder=self.member(name), port=device.getsockname()[1]))
        self.a = self.bridge("a")
        self.says("a", "is master of group g")
        self.b = self.bridge("b")
        self.says("b", "stands by in group g")
        self.watch = Watch(self.start("fieldcast", "watch", "--json", "--for", "120", "--domain", str(self.domain), "--security",
                                      self.member("mes"), stdout=subprocess.PIPE, text=True))
        self.addCleanup(self.watch.end)
        self.watch.goes_on()
        self.is_ready("b")
        self.watch.gap()

    def secure(self, *arguments):
        done = run_cli(BIN_DIR, "secure", *arguments)
        self.assertEqual(done.code, 0, str(done))

    def member(self, name):
        return os.path.join(self.authority, "members", name)

    def path(self, name, ending):
        return os.path.join(self.folder, f"{name}.{ending}")

    def start(self, program, *arguments, **options):
        process = subprocess.Popen([os.path.join(BIN_DIR, program), *arguments], stdin=subprocess.DEVNULL, **options)
        self.addCleanup(process.wait)
        self.addCleanup(process.kill)
        return process

    def bridge(self, name):
        with open(self.path(name, "log"), "a", encoding="utf-8") as log:
            return self.start("fieldcast-bridge", self.path(name, "yaml"), stdout=log, stderr=subprocess.STDOUT)

    def log(self, name):
        with open(self.path(name, "log"), encoding="utf-8") as file:
            return file.read()

    def says(self, name, text, times=1):
        wait_until(lambda: self.log(name).count(text) >= times, SECONDS,
                   lambda: f"{name} does not say '{text}'\n" + "\n".join(self.log(each) for each in "ab" if os.path.exists(self.path(each, "log"))))

    def is_ready(self, name):
        """It stands by, and has all that it needs."""
        def ready():
            told = run_cli(BIN_DIR, "standby", "--json", "--domain", str(self.domain), "--security", self.member("mes"))
            return any(each["bridge"] == name and each["role"] == "waiting" and not each["not_ready"] for each in told.json_lines())
        wait_until(ready, SECONDS, lambda: f"{name} is not ready\n{self.log('a')}\n{self.log('b')}")

    def test_a_killed_master_is_replaced(self):
        self.a.kill()
        self.says("b", "has taken over in group g")
        self.watch.goes_on()
        print(f"kill -9 with DDS Security: longest gap of a channel of 50 ms: {self.watch.gap() * 1000:.0f} ms")
        self.assertEqual(self.watch.faults, [])

    def test_certificates_are_renewed_without_a_gap(self):
        for name, process in (("a", self.a), ("b", self.b)):
            other = "b" if name == "a" else "a"
            self.secure("renew", name, "--authority", self.authority)
            self.says(name, "has a renewed certificate")
            process.send_signal(signal.SIGHUP)
            self.says(other, "the master has handed over")
            self.says(name, "stands by in group g", 2)
            self.watch.goes_on()
            gap = self.watch.gap()
            print(f"certificate of {name} renewed: longest gap of a channel of 50 ms: {gap * 1000:.0f} ms")
            self.assertLess(gap, 0.5)
            self.is_ready(name)
            self.watch.gap()
        self.assertEqual(self.watch.faults, [])


if __name__ == "__main__":
    unittest.main()
