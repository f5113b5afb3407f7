"""Tests a machine with a full disk, without multicast, or with unwritable files. The bridge
reports the fault, loses no stored data, and its buses continue.

usage: e2e_machine.py BIN_DIR

Runs in its own mounts, network and processes (unshare), so that it can remove resources. Exit code
77: not root.
"""

import contextlib
import json
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import unittest

import networks
import plant
from plant import Plant, modbus_line, run_cli, wait_until

BIN_DIR = ""
SECONDS = 60

CONFIG = """
bridge: e2e""" + modbus_line(defaults="refresh: 100ms") + "\n".join(f'          - {{ name: c{i}, at: "holding:{i}", type: uint16, access: read-write }}' for i in range(60)) + "\n"


def system(*command):
    subprocess.run(command, check=True, capture_output=True)


class OtherPlant(Plant):
    """Its bridge runs inside `around`, or with a small `disk`, also for its log (`log_on_disk`)."""

    def __init__(self, config, around=(), disk=None, log_on_disk=False):
        super().__init__(BIN_DIR, config)
        self.around, self.disk, self.log_on_disk = around, disk, log_on_disk

    def log(self, name):
        if name == "fieldcast-bridge" and self.disk and self.log_on_disk:
            return self.said()
        return super().log(name)

    def _start(self, name):
        if name != "fieldcast-bridge":
            return super()._start(name)
        if self.disk:
            os.mkdir(f"{self.run}/disk")
            system("mount", "-t", "tmpfs", "-o", f"size={self.disk},nr_inodes=100", "small", f"{self.run}/disk")
        with open(self.log_path, "w", encoding="utf-8") as log:
            return subprocess.Popen([*self.around, os.path.join(self.bin_dir, name), self.file], stdout=log, stderr=subprocess.STDOUT,
                                    stdin=subprocess.DEVNULL)

    @property
    def log_path(self):
        return os.path.join(self.run, "disk/log" if self.log_on_disk else "fieldcast-bridge.log")

    def _stop_all(self):
        codes = super()._stop_all()
        if self.log_on_disk:
            shutil.copy(self.log_path, os.path.join(self.run, "fieldcast-bridge.log"))
        if self.disk:
            system("umount", f"{self.run}/disk")
        self.disk = None
        return codes

    def grow(self, size):
        system("mount", "-o", f"remount,size={size}", f"{self.run}/disk")

    def said(self):
        with open(self.log_path, encoding="utf-8", errors="replace") as file:
            return file.read()

    def await_words(self, words):
        wait_until(lambda: words in self.said(), SECONDS, lambda: f"no '{words}' in\n{self.said()}")

    def samples(self):
        status = self.cli("status", "--json").json_lines()
        return next(line["samples"] for line in status if line["topic"] == "BusStatus")

    def await_more_samples(self):
        before = self.samples()
        wait_until(lambda: self.samples() > before + 60, SECONDS, lambda: f"the bus stands\n{self.said()}")


class FullDisk(unittest.TestCase):
    def test_of_the_store_is_said_and_no_sample_is_lost(self):
        config = CONFIG + "store: { path: {run}/disk/plant.db }\n"
        with OtherPlant(config, disk="300k") as here:
            here.await_words("plant.db: database or disk is full")
            here.await_more_samples()
            here.grow("100m")
            here.await_words("samples are stored again: ")
            self.assertNotIn("were not stored", here.said())
            self.assertEqual(here.said().count("disk is full"), 1, here.said())
            numbers = [sample["sequence"] for sample in here.cli("history", "line/press/c7", "--json").json_lines()]
            self.assertEqual(numbers, list(range(numbers[0], numbers[0] + len(numbers))), "a sample is missing")

    def test_of_the_log_stops_nothing_and_the_log_goes_on(self):
        with OtherPlant(CONFIG, disk="256k", log_on_disk=True) as here:
            filler = f"{here.run}/disk/filler"
            with open(filler, "wb", buffering=0) as file, contextlib.suppress(OSError):
                while file.write(bytes(4096)):
                    pass
            here.bridge.send_signal(signal.SIGUSR1)
            here.await_more_samples()
            here.bridge.send_signal(signal.SIGUSR1)
            os.remove(filler)
            here.bridge.send_signal(signal.SIGHUP)
            here.await_words("reloaded")
            here.bridge.send_signal(signal.SIGTERM)
            self.assertEqual(here.bridge.wait(SECONDS), 0)
            here.await_words("stopped")


    def test_of_the_queue_of_a_forwarder_is_named_at_its_start(self):
        with tempfile.TemporaryDirectory() as run, contextlib.ExitStack() as mounted:
            system("mount", "-t", "tmpfs", "-o", "size=16k", "small", run)
            mounted.callback(system, "umount", run)
            file = os.path.join(run, "forward.yaml")
            with open(file, "w", encoding="utf-8") as out:
                out.write("site: north\nqueue: { path: forward.db }\njetstream: { servers: [nats://127.0.0.1:4] }\n")
            with open(os.path.join(run, "filler"), "wb", buffering=0) as filler, contextlib.suppress(OSError):
                while filler.write(bytes(4096)):
                    pass
            done = subprocess.run([os.path.join(BIN_DIR, "fieldcast-forward"), "--config", file], capture_output=True, text=True, timeout=SECONDS)
            self.assertEqual(done.returncode, 4, done.stderr)
            self.assertIn("free 1 MB on the disk of the queue", done.stderr)
            self.assertNotIn("only one fieldcast-forward", done.stderr)


class ReadOnlyRoot(unittest.TestCase):
    AROUND = ["unshare", "--mount", "sh", "-c",
              'mount -o remount,bind,ro / && { ! mountpoint -q /tmp || mount -o remount,bind,ro /tmp; } && exec "$@"', "sh"]

    def test_is_enough_without_a_store(self):
        with OtherPlant(CONFIG, around=self.AROUND) as here:
            here.await_more_samples()
            self.assertEqual(here.cli("write", "line/press/c1=5", "--verify").code, 0)
            self.assertNotIn("error", here.said())

    def test_of_a_store_is_said_and_the_buses_run(self):
        with OtherPlant(CONFIG + "store: { path: {run}/plant.db }\n", around=self.AROUND) as here:
            here.await_words("plant.db: cannot be opened for writing (Read-only file system)")
            here.await_more_samples()
            refused = here.cli("write", "line/press/c1=5", "--json")
            self.assertEqual(refused.code, 5, str(refused))
            self.assertIn("the store is away", json.loads(refused.out.splitlines()[-1])["reason"])


class NoMulticast(unittest.TestCase):
    """Joining a multicast group fails, as in a kernel or network without multicast."""

    def setUp(self):
        self.addCleanup(system, "sysctl", "-w", "net.ipv4.igmp_max_memberships=20")
        system("sysctl", "-w", "net.ipv4.igmp_max_memberships=0")

    def test_is_said_by_the_bridge_the_command_line_and_the_doctor(self):
        words = "no multicast on 127.0.0.1"
        before, plant.START_SECONDS = plant.START_SECONDS, 0.5  # it cannot be discovered
        self.addCleanup(setattr, plant, "START_SECONDS", before)
        with self.assertRaises(plant.Failure) as failure, OtherPlant(CONFIG):
            pass
        self.assertIn(words, str(failure.exception))
        self.assertIn("discovery-server: HOST:PORT", str(failure.exception))
        watch = run_cli(BIN_DIR, "watch", "--once")
        self.assertEqual(watch.code, 3, str(watch))
        self.assertIn(words, watch.err)
        with tempfile.NamedTemporaryFile("w", suffix=".yaml", encoding="utf-8") as file:
            file.write(CONFIG.replace("{run}", "/tmp"))
            file.flush()
            doctor = run_cli(BIN_DIR, "doctor", file.name)
        self.assertIn("lo has no multicast, and no discovery server is named", doctor.out)


def main():
    global BIN_DIR
    networks.enter("take things away from a process", own_run=False)
    BIN_DIR = sys.argv[1]
    unittest.main(argv=sys.argv[:1] + sys.argv[2:], verbosity=2)


if __name__ == "__main__":
    main()
