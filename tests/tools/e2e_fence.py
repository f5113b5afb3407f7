"""Tests two real bridges that are connected by a serial line only. They are in two DDS domains, as
in a network partition, so each acts as if it was alone.

usage: e2e_fence.py BIN_DIR
       FIELDCAST_FENCE_SECONDS: duration of the partition; default 5
"""

import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest

from multi_drop import MultiDrop
from plant import claim_domain, wait_until

BIN_DIR = ""
SECONDS = float(os.environ.get("FIELDCAST_FENCE_SECONDS", "5"))
START = 30
LISTEN = 0.320  # FenceTimes::listen of this configuration

CONFIG = """
bridge: {name}
dds: {{ domain: {domain} }}
buses:
  - name: line
    port: {{ serial: {path}, baud: 19200, format: 8E1, fence: listen }}
    protocol: modbus-rtu
    defaults: {{ refresh: 200ms, timeout: 100ms }}
    devices:
      - name: meter
        address: 1
        channels:
          - {{ name: a, at: "holding:0", type: uint16 }}
          - {{ name: b, at: "holding:4000", type: uint16, mode: on-demand }}
"""


class Fence(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp(prefix="fieldcast-e2e-")
        self.addCleanup(shutil.rmtree, self.folder, True)
        self.line = MultiDrop(self.folder)
        self.line.__enter__()
        self.addCleanup(lambda: self.line.__exit__(None, None, None))
        self.started = 0

    def start(self, index):
        self.started += 1
        name = f"bridge-{self.started}"
        domain, claim = claim_domain()
        self.addCleanup(claim.close)
        path = os.path.join(self.folder, name + ".yaml")
        with open(path, "w", encoding="utf-8") as file:
            file.write(CONFIG.format(name=name, domain=domain, path=self.line.paths[index]))
        log = open(os.path.join(self.folder, name + ".log"), "w+", encoding="utf-8")
        process = subprocess.Popen([os.path.join(BIN_DIR, "fieldcast-bridge"), path], stdout=log, stderr=subprocess.STDOUT)
        self.addCleanup(log.close)
        self.addCleanup(self.end, process)
        process.log = log.name
        return process

    def end(self, process):
        if process.poll() is None:
            process.kill()
            process.wait()

    def log_of(self, process):
        with open(process.log, encoding="utf-8") as file:
            return file.read()

    def frames(self, index):
        return self.line.counts()["frames"][index]

    def expect_no_garbled_frame(self):
        counts = self.line.counts()
        self.assertEqual(counts["garbled"], 0, counts)
        if counts["shortest turn"] is not None:
            self.assertGreater(counts["shortest turn"], LISTEN - 0.030, counts)

    def test_under_a_partition_no_frame_is_garbled_and_after_a_kill_the_other_goes_on(self):
        first = self.start(0)
        wait_until(lambda: self.frames(0) > 5, START, lambda: self.log_of(first))
        second = self.start(1)
        wait_until(lambda: "another master speaks on the wire" in self.log_of(second), START, lambda: self.log_of(second))
        self.assertIn("fence: listening: nothing is sent before the wire was silent for 320ms", self.log_of(second))
        before = self.frames(0)
        time.sleep(SECONDS)
        self.assertEqual(self.frames(1), 0, self.log_of(second))
        self.assertGreater(self.frames(0) - before, 8 * SECONDS, "the one that sends is heard at least each 100 ms")
        self.expect_no_garbled_frame()
        first.kill()
        first.wait()
        died = self.line.counts()["last frame"][0]
        wait_until(lambda: self.frames(1) > 5, START, lambda: self.log_of(second))
        silence = self.line.counts()["shortest turn"]
        print(f"partition of {SECONDS:g} s: {self.frames(0)} requests of the first bridge, 0 of the second, "
              f"{self.line.counts()['garbled']} garbled; taken over {silence:.3f} s after the last frame", flush=True)
        self.assertLess(silence, 1.5, f"died at {died}")
        wait_until(lambda: "this bridge sends again" in self.log_of(second), START, lambda: self.log_of(second))
        # The bridge is suspended while another takes over; it must not send into its frames.
        third = self.start(0)
        wait_until(lambda: "another master speaks on the wire" in self.log_of(third), START, lambda: self.log_of(third))
        taken = self.frames(0)
        second.send_signal(signal.SIGSTOP)
        wait_until(lambda: self.frames(0) > taken + 5, START, lambda: self.log_of(third))
        sent = self.frames(1)
        second.send_signal(signal.SIGCONT)
        wait_until(lambda: self.log_of(second).count("another master speaks on the wire") == 2, START, lambda: self.log_of(second))
        time.sleep(0.5)
        # Bytes that it wrote to its port before the suspension may still be sent.
        self.assertLessEqual(self.frames(1), sent + 1)
        self.expect_no_garbled_frame()


class Check(unittest.TestCase):
    def check(self, port, standby=", standby: { group: g }"):
        with tempfile.NamedTemporaryFile("w", suffix=".yaml") as file:
            file.write("bridge: { name: a" + standby + " }\nbuses:\n  - { name: line, port: { " + port + " }, protocol: modbus-rtu, devices: "
                       "[{ name: m, address: 1, channels: [{ name: c, at: 'holding:1', type: int16 }] }] }\n")
            file.flush()
            return subprocess.run([os.path.join(BIN_DIR, "fieldcast-bridge"), "--check", file.name], capture_output=True, text=True)

    def test_says_which_fence_each_bus_of_a_group_has_and_warns_where_there_is_none(self):
        for port, words in [("serial: /dev/ttyS9, fence: listen", "line: fence: listening"),
                            ("serial: /dev/ttyS9, fence: lock", "line: fence: the lock of /dev/ttyS9"),
                            ("tcp: '10.0.0.7:4001', baud: 9600, fence: one-client", "line: fence: one client")]:
            with self.subTest(port):
                checked = self.check(port)
                self.assertEqual(checked.returncode, 0, checked.stderr)
                self.assertIn(words, checked.stdout)
                self.assertNotIn("fence", checked.stderr)
        for port in ["serial: /dev/ttyS9", "serial: /dev/ttyS9, fence: none", "tcp: '10.0.0.7:4001', baud: 9600"]:
            with self.subTest(port):
                checked = self.check(port)
                self.assertEqual(checked.returncode, 0, checked.stderr)
                self.assertIn("warning: line: fence: none: two bridges that do not hear of each other", checked.stderr)
                self.assertNotIn("fence", self.check(port, "").stderr, "it stands alone")


if __name__ == "__main__":
    BIN_DIR = sys.argv.pop(1)
    unittest.main(verbosity=2)
