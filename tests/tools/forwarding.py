"""A forwarder, and the reader to which tests compare what it has forwarded."""

import collections
import contextlib
import json
import os
import signal
import subprocess

from plant import wait_until

UNCOMMITTED = 1.5  # seconds before a kill in which a sample may be gathered, but not queued
REJOIN = 8  # seconds until a restarted forwarder receives samples again


class Forwarder:
    """`text` is its whole configuration."""

    def __init__(self, bin_dir, folder, text):
        self.bin_dir, self.folder, self.process, self.environment = bin_dir, folder, None, None
        self.file = os.path.join(folder, "forward.yaml")
        with open(self.file, "w", encoding="utf-8") as file:
            file.write(text)

    def start(self):
        with open(os.path.join(self.folder, "forward.log"), "a", encoding="utf-8") as log:
            self.process = subprocess.Popen([os.path.join(self.bin_dir, "fieldcast-forward"), "--config", self.file],
                                            stdout=log, stderr=log, stdin=subprocess.DEVNULL, env=self.environment)

    def kill(self):
        self.process.send_signal(signal.SIGKILL)
        self.process.wait()

    def stop(self):
        """Ends it in order; returns its exit code."""
        if self.process is not None and self.process.poll() is None:
            self.process.send_signal(signal.SIGTERM)
            try:
                return self.process.wait(15)
            except subprocess.TimeoutExpired:
                self.kill()
        return None if self.process is None else self.process.returncode

    def log(self):
        with open(os.path.join(self.folder, "forward.log"), encoding="utf-8") as file:
            return file.read()


class Reference:
    """What `fieldcast watch` receives meanwhile: another reader of the same samples."""

    def __init__(self, plant, folder):
        self.path = os.path.join(folder, "watch.jsonl")
        with open(self.path, "w", encoding="utf-8") as file:
            self.process = subprocess.Popen([os.path.join(plant.bin_dir, "fieldcast"), "watch", "--json", "--config", plant.file],
                                            stdout=file, stderr=subprocess.DEVNULL, stdin=subprocess.DEVNULL)
        wait_until(lambda: os.path.getsize(self.path) > 0, 20, "fieldcast watch shows nothing")

    def stop(self):
        if self.process.poll() is None:
            self.process.send_signal(signal.SIGTERM)
        self.process.wait(15)

    def samples(self):
        """{(device, channel): {sequence: sample}}"""
        found = collections.defaultdict(dict)
        with open(self.path, encoding="utf-8") as file:
            for line in file.read().splitlines():
                with contextlib.suppress(json.JSONDecodeError):  # the last line may be cut
                    sample = json.loads(line)
                    if "sequence" in sample:
                        found[sample["device"], sample["channel"]][sample["sequence"]] = sample
        return found
