"""A station of the network campaign: a program that prints samples, with the latest ones of each channel."""

import json
import subprocess
import threading
import time

NEW = 5  # seconds within which each channel must have a sample at the end


class Station:
    """Runs a program that prints samples, and stores the latest of each channel."""

    KEPT = 400

    def __init__(self, network, host, command, parse, environment=None):
        self.network, self.host, self.command, self.parse = network, host, command, parse
        self.environment, self.lock, self.latest, self.kept = environment, threading.Lock(), {}, {}
        self.fell_back, self.highest = [], {}
        self.start()

    def start(self):
        self.process = self.network.run(self.host, self.command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True,
                                        env=self.environment)
        threading.Thread(target=self.read, args=(self.process,), daemon=True).start()

    def read(self, process):
        for text in process.stdout:
            sample = self.parse(text)
            if sample is None:
                continue
            channel, sequence, acquired, value, quality = sample
            with self.lock:
                self.latest[channel] = (time.monotonic(), quality)
                if sequence < self.highest.get(channel, 0):
                    self.fell_back.append(f"{channel}: sequence {sequence} after {self.highest[channel]}")
                self.highest[channel] = sequence
                kept = self.kept.setdefault(channel, {})
                kept[(sequence, acquired)] = (value, quality)
                if len(kept) > self.KEPT:
                    kept.pop(next(iter(kept)))

    def fresh(self):
        now = time.monotonic()
        with self.lock:
            return {channel for channel, (at, quality) in self.latest.items() if quality == "GOOD" and now - at < NEW}

    def samples(self):
        with self.lock:
            return {channel: dict(kept) for channel, kept in self.kept.items()}

    def forget(self):
        with self.lock:
            self.latest.clear()
            self.kept.clear()
            self.fell_back.clear()
            self.highest.clear()


def ours(text):
    try:
        sample = json.loads(text)
        return ("/".join((sample["bus"], sample["device"], sample["channel"])), int(sample["sequence"]), int(sample["acquired_at"]),
                float(sample["value"]), sample["quality"])
    except (ValueError, KeyError, TypeError):
        return None


def cyclones(text):
    word, *fields = text.rstrip("\n").split("\t")
    if word != "sample" or len(fields) != 8:
        return None
    return "/".join(fields[:3]), int(fields[7]), int(fields[6]), float(fields[4]), fields[5]
