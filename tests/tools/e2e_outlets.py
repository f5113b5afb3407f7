"""The contract of all outlets of fieldcast-forward, with a real server of each engine: a simulated plant, a
bridge, the forwarder, and a consumer that we did not write where there is one.

usage: e2e_outlets.py BIN_DIR SOURCE_DIR UNPACKED_DIR ENGINE [CLASS ..]

ENGINE is a file of tests/tools/outlets. Exit code 77: its server is not on this machine.
"""

import collections
import importlib
import re
import sys
import tempfile
import time
import unittest

import outlets
from forwarding import REJOIN, UNCOMMITTED, Forwarder, Reference
from nats import free_port
from plant import Plant, wait_until

BIN_DIR = ""
Engine = None
plant = None

LATE_AFTER = 1  # seconds, the least that the configuration allows
CUT = 3  # seconds: longer than LATE_AFTER and than the acknowledgement of most engines, so that samples become late

CONFIG = """
bridge: e2e
buses:
  - name: line
    port: { serial: {run}/line, baud: 115200, format: 8N1 }
    protocol: modbus-rtu
    defaults: { refresh: 200ms }
    devices:
      - name: press.1
        address: 1
        channels:
          - { name: temperature, at: "holding:100", type: float32, unit: °C }
          - { name: setpoint, at: "holding:200", type: int16, access: read-write }
          - { name: running, at: "coil:3", type: bool }
      - name: mill
        address: 2
        channels:
          - { name: level, at: "input-register:3", type: uint16 }
"""


def setUpModule():
    global plant
    plant = unittest.enterModuleContext(Plant(BIN_DIR, CONFIG))


def needs_no_third_run(sequences):
    """True if the numbers are two ascending runs that were interleaved: present samples, and late ones."""
    present = late = -1
    for sequence in sequences:
        if sequence > present:
            present = sequence
        elif sequence > late:
            late = sequence
        else:
            return False
    return True


class OutletCase(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="fieldcast-outlet-")
        self.addCleanup(folder.cleanup)
        self.folder = folder.name
        self.engine = Engine(self.folder, free_port())
        self.addCleanup(self.engine.stop)

    def forwarder(self, login="right"):
        text = (f"site: {outlets.SITE}\ndds: {{ domain: {plant.domain} }}\nqueue: {{ path: queue.db }}\ngather: {{ time: 200ms }}\n"
                f"payload: {{ format: json }}\nsend: {{ late-after: {LATE_AFTER}s }}\n{self.engine.section(login)}\n")
        forwarder = Forwarder(BIN_DIR, self.folder, text)
        self.addCleanup(forwarder.stop)
        return forwarder

    def explain(self, forwarder):
        log = getattr(self.engine, "log", str)
        return lambda: forwarder.log() + log()

    def wait_for_more(self, forwarder, count=8):
        """Waits until the engine has `count` further samples."""
        before = len(self.engine.samples())
        wait_until(lambda: len(self.engine.samples()) >= before + count, 30, self.explain(forwarder))

    def by_channel(self):
        """{path: [(epoch, sequence, value, quality)]}: what the engine has, after its rule for repeated samples."""
        found, seen = collections.defaultdict(list), set()
        for path, epoch, sequence, value, quality in self.engine.samples():
            is_new = (path, epoch, sequence) not in seen
            if self.engine.has_unique_samples:
                self.assertTrue(is_new, f"{path} {epoch} {sequence} is there twice")
            if is_new:
                found[path].append((epoch, sequence, value, quality))
            seen.add((path, epoch, sequence))
        return found


class Delivery(OutletCase):
    def setUp(self):
        super().setUp()
        self.reference = Reference(plant, self.folder)
        self.addCleanup(self.reference.stop)

    def test_cut(self):
        forwarder = self.forwarder()
        forwarder.start()
        time.sleep(1)  # samples are queued before there is a server
        self.engine.start()
        self.wait_for_more(forwarder)
        for _ in range(2):
            self.engine.stop()
            time.sleep(CUT)
            self.engine.start()
            self.wait_for_more(forwarder)
        self.compare(forwarder)
        self.assertRegex(forwarder.log(), r"\([1-9]\d* late\)")

    def test_slow(self):
        self.engine.start()
        forwarder = self.forwarder()
        forwarder.start()
        self.wait_for_more(forwarder)
        for _ in range(2):
            self.engine.pause()
            time.sleep(CUT + getattr(Engine, "acknowledgement", 0))
            self.engine.resume()
            self.wait_for_more(forwarder)
        self.compare(forwarder)

    def test_duplicate(self):
        self.engine.start()
        forwarder = self.forwarder()
        forwarder.start()
        self.wait_for_more(forwarder)
        # The server receives what was sent before the kill afterwards, and the same again.
        self.engine.pause()
        time.sleep(0.7)
        killed = time.time()
        forwarder.kill()
        self.engine.resume()
        forwarder.start()
        self.wait_for_more(forwarder)
        time.sleep(1)
        for _ in range(3):
            forwarder.kill()
            forwarder.start()
            time.sleep(0.5)
        restarted = time.time()
        self.wait_for_more(forwarder)
        self.compare(forwarder, (killed - UNCOMMITTED, restarted + REJOIN))

    def compare(self, forwarder, down=None):
        """Compares what the engine has with the reference. Samples may be missing that were acquired within `down`, when the forwarder
        did not run."""
        wanted = {f"line/{device}/{channel}": max(samples) for (device, channel), samples in self.reference.samples().items()}

        def complete():
            found = self.by_channel()
            return all(found[path] and max(item[1] for item in found[path]) >= last for path, last in wanted.items())
        wait_until(complete, 30, self.explain(forwarder))
        self.reference.stop()
        wait_until(lambda: self.is_empty(forwarder), 30, self.explain(forwarder))
        self.assertEqual(forwarder.stop(), 0, forwarder.log())
        found = self.by_channel()
        self.assertEqual(set(found), set(wanted))
        for (device, channel), samples in self.reference.samples().items():
            with self.subTest(channel=channel):
                self.compare_channel(samples, found[f"line/{device}/{channel}"], wanted[f"line/{device}/{channel}"], down)

    @staticmethod
    def is_empty(forwarder):
        """The forwarder has late samples only while the queue is long; at the end, at most what was gathered just now waits."""
        forwarder.process.send_signal(10)  # SIGUSR1: the state of the queue
        time.sleep(0.2)
        states = re.findall(r"(\d+) messages wait", forwarder.log())
        return bool(states) and int(states[-1]) <= 4

    def compare_channel(self, reference, found, last, down):
        self.assertEqual(len({epoch for epoch, *_ in found}), 1, "the bridge was not restarted")
        sequences = [sequence for _, sequence, *_ in found]
        self.assertGreater(len(sequences), 20)
        if getattr(self.engine, "keeps_order", True):
            self.assertTrue(needs_no_third_run(sequences), sequences)
        samples = {sequence: (value, quality) for _, sequence, value, quality in found}
        first = min(sequences)
        for sequence, expected in reference.items():
            if sequence in samples:
                value, quality = samples[sequence]
                self.assertEqual(quality, expected["quality"])
                self.assertEqual(float(value), float(expected["value"]))
            elif first <= sequence <= last:
                self.assertIsNotNone(down, f"{expected} is missing")
                self.assertTrue(down[0] < expected["acquired_at"] / 1e9 < down[1], f"{expected} is missing; not received within {down}")


class Faults(OutletCase):
    def test_refuse(self):
        self.engine.start()
        reason = self.engine.refuse_one()
        if reason is None:
            self.skipTest(f"{Engine.name} refuses no message of its own")
        forwarder = self.forwarder()
        forwarder.start()
        wait_until(lambda: reason in forwarder.log(), 30, self.explain(forwarder))
        self.wait_for_more(forwarder)
        self.assertEqual(forwarder.stop(), 0, forwarder.log())
        self.assertRegex(forwarder.log(), r"stopped: .* [1-9]\d* refused")

    def test_wrong_login(self):
        if not getattr(Engine, "has_login", True):
            self.skipTest(f"the server of this test has no login: {Engine.name}")
        self.engine.start()
        forwarder = self.forwarder("wrong")
        forwarder.start()
        wait_until(lambda: re.search("authori[sz]|authenticat|login|denied|not allowed", forwarder.log(), re.IGNORECASE), 30,
                   self.explain(forwarder))
        self.assertEqual(self.engine.samples(), [])
        self.engine.correct_login()
        self.wait_for_more(forwarder)
        self.assertEqual(forwarder.stop(), 0, forwarder.log())
        for secret in (outlets.RIGHT_PASSWORD, outlets.WRONG_PASSWORD):
            self.assertNotIn(secret, forwarder.log())


if __name__ == "__main__":
    BIN_DIR, outlets.UNPACKED = sys.argv[1], sys.argv[3]
    Engine = importlib.import_module("outlets." + sys.argv[4]).Engine
    if reason_of_skip := Engine.reason_to_skip():
        print(reason_of_skip)
        sys.exit(77)
    unittest.main(argv=[sys.argv[0], *sys.argv[5:]], verbosity=2)
