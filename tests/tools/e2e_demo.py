"""Tests tools/demo.sh: values arrive, and no process or file remains, however the demo ends.

usage: e2e_demo.py BIN_DIR SOURCE_DIR
"""

import json
import os
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest
import urllib.request

from plant import claim_domain, shared_memory

BIN_DIR, SOURCE_DIR = "", ""


class Demo(unittest.TestCase):
    def demo(self, *arguments):
        return subprocess.Popen([os.path.join(SOURCE_DIR, "tools", "demo.sh"), "--bin", BIN_DIR, "--domain", str(self.domain), *arguments],
                                stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True,
                                env={**os.environ, "TMPDIR": self.folder.name})

    def setUp(self):
        self.folder = tempfile.TemporaryDirectory(prefix="fieldcast-e2e-")
        self.addCleanup(self.folder.cleanup)
        self.domain, claim = claim_domain()
        self.addCleanup(claim.close)

    def nothing_is_left(self):
        self.assertEqual(os.listdir(self.folder.name), [], "the demo left files")
        running = [pid for pid in os.listdir("/proc") if pid.isdigit() and self.folder.name.encode() in command_line(pid)]
        self.assertEqual(running, [], "the demo left processes")

    def test_values_flow_and_nothing_is_left(self):
        before = shared_memory()
        process = self.demo("--seconds", "5")
        out, err = process.communicate(timeout=120)
        self.assertEqual(process.returncode, 0, out + err)
        self.assertRegex(out, r"[1-9]\d* samples of 1\d\d channels, [1-9]\d* of them GOOD")
        self.nothing_is_left()
        self.assertEqual({name for name in shared_memory() - before if of_domain(name, self.domain)}, set())

    def interrupt(self, process):
        os.killpg(process.pid, signal.SIGINT)  # as a terminal does
        process.communicate(timeout=30)
        self.nothing_is_left()

    def until_interrupted(self, *arguments):
        process = self.demo(*arguments)
        limit = threading.Timer(60, lambda: os.killpg(process.pid, signal.SIGTERM))
        limit.start()
        self.addCleanup(limit.cancel)
        return process

    def test_the_page_shows_values_until_control_c(self):
        process = self.until_interrupted()
        line = process.stdout.readline()
        self.assertRegex(line, r"^The page of the plant: http://127\.0\.0\.1:\d+/$")
        address = line.split()[-1]
        with urllib.request.urlopen(address + "api/me", timeout=10) as answer:
            self.assertEqual(json.load(answer)["role"], "engineer")
        good = 0
        while good < 50 and process.poll() is None:
            time.sleep(0.2)
            with urllib.request.urlopen(address + "api/channels", timeout=10) as answer:
                good = sum(channel["quality"] == "GOOD" for channel in json.load(answer))
        self.assertGreaterEqual(good, 50, "the page shows no values")
        self.interrupt(process)

    def test_without_a_page_control_c_leaves_nothing(self):
        process = self.until_interrupted("--no-page")
        self.assertTrue(process.stdout.readline(), "no sample came")
        self.interrupt(process)


def command_line(pid):
    try:
        with open(f"/proc/{pid}/cmdline", "rb") as file:
            return file.read()
    except OSError:
        return b""


def of_domain(name, domain):
    """Fast DDS names the segments of its ports by port number: 7400 + 250 * domain and up."""
    digits = "".join(c if c.isdigit() else " " for c in name).split()
    return any(7400 + 250 * domain <= int(number) < 7400 + 250 * (domain + 1) for number in digits if len(number) <= 5)


if __name__ == "__main__":
    BIN_DIR, SOURCE_DIR = sys.argv[1], sys.argv[2]
    unittest.main(argv=sys.argv[:1], verbosity=2)
