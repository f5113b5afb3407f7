"""Tests two bridges of a standby group with DDS Security: a takeover, and certificate renewal
without a gap.

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

from e2e_standby import BIN_DIR, BRIDGE, SECONDS, Watch, serve_device
from plant import claim_domain, run_cli, wait_until
from steady import OnASteadyMachine

PAUSE = 14  # seconds; a silent participant is removed after 10
CONFIG = BRIDGE % ("domain: {domain}, interfaces: [127.0.0.1], security: {folder}", "127.0.0.1")


class SecureStandby(OnASteadyMachine, unittest.TestCase):
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
                pass

        threading.Thread(target=serve, daemon=True).start()
        self.authority = os.path.join(self.folder, "plant")
        self.secure("init", self.authority)
        for member in (["bridge", "a"], ["bridge", "b"], ["plant", "mes"]):
            self.secure("add", *member, "--authority", self.authority)
        for name, strength in (("a", 2), ("b", 1)):
            with open(self.path(name, "yaml"), "w", encoding="utf-8") as file:
                file.write(CONFIG.format(name=name, strength=strength, domain=self.domain, folder=self.member(name), port=device.getsockname()[1]))
        self.bridges = {}
        for name in "ab":
            self.bridges[name] = self.bridge(name)
            self.says(name, "stands by in group g")
        self.watch = Watch(self.start("fieldcast", "watch", "--json", "--for", "120", "--domain", str(self.domain), "--security",
                                      self.member("mes"), stdout=subprocess.PIPE, text=True))
        self.addCleanup(self.watch.end)
        self.watch.goes_on()
        # On a busy machine both may become master before they discover each other.
        self.master, self.other = self.roles()
        self.watch.faults.clear()
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

    def says_more(self, name, text, action):
        """Waits until `text` is logged once more than before `action`."""
        before = self.log(name).count(text)
        action()
        self.says(name, text, before + 1)

    def roles(self):
        """Returns the master and the complete standby bridge."""
        def whole():
            told = run_cli(BIN_DIR, "standby", "--json", "--domain", str(self.domain), "--security", self.member("mes")).json_lines()
            masters = [each["bridge"] for each in told if each["role"] == "master"]
            ready = [each["bridge"] for each in told if each["role"] == "waiting" and not each["not_ready"]]
            return masters + ready if len(masters) == len(ready) == 1 else None
        return wait_until(whole, SECONDS, lambda: f"the group is not whole\n{self.log('a')}\n{self.log('b')}")

    def test_a_killed_master_is_replaced(self):
        self.says_more(self.other, "has taken over in group g", self.bridges[self.master].kill)
        self.watch.goes_on()
        print(f"kill -9 with DDS Security: longest gap of a channel of 50 ms: {self.watch.gap() * 1000:.0f} ms")
        self.assertEqual(self.watch.faults, [])

    def test_a_suspended_master_comes_back_as_a_standby(self):
        master = self.bridges[self.master]
        stood_by = self.log(self.master).count("stands by in group g")
        self.says_more(self.other, "has taken over in group g", lambda: master.send_signal(signal.SIGSTOP))
        time.sleep(PAUSE)
        master.send_signal(signal.SIGCONT)
        self.says(self.master, "stands by in group g", stood_by + 1)
        self.assertEqual(self.roles(), [self.other, self.master])
        self.watch.goes_on()
        self.assertEqual(self.watch.faults, [])

    def test_certificates_are_renewed_without_a_gap(self):
        for _ in range(2):
            name, other = self.master, self.other
            self.says_more(name, "has a renewed certificate", lambda: self.secure("renew", name, "--authority", self.authority))
            stood_by = self.log(name).count("stands by in group g")
            self.says_more(other, "the master has handed over", lambda: self.bridges[name].send_signal(signal.SIGHUP))
            self.says(name, "stands by in group g", stood_by + 1)
            self.watch.goes_on()
            gap = self.watch.gap()
            print(f"certificate of {name} renewed: longest gap of a channel of 50 ms: {gap * 1000:.0f} ms")
            self.assertLess(gap, 0.5)
            self.master, self.other = self.roles()
            self.assertEqual((self.master, self.other), (other, name), self.log("a") + self.log("b"))
            self.watch.gap()
        self.assertEqual(self.watch.faults, [])


if __name__ == "__main__":
    unittest.main()
