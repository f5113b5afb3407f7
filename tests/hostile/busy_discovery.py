"""Tests that stations and bridges that start on a busy machine discover each other in time (LONGEST_SECONDS).

usage: busy_discovery.py BIN_DIR [--runs N] [--seed N] [--busy N] [--trace FOLDER]

In each run a station joins a bridge, or a bridge starts again (after SIGTERM or SIGKILL) and a station that is in the domain must find it. Busy
processes compete for the processor. In most runs one side is stopped by SIGSTOP for 0.1 to 2 s at a random moment of the discovery; that time does
not count. Both directions must match: the station matches the bridge's reader of commands and its writer of results, and receives a bus status.
The time of a station begins when it is in the domain, that of a bridge with its process.
With --trace (as root, on Linux) the datagrams of each run that lasts too long are written to the folder.
"""

import argparse
import collections
import os
import random
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import threading
import time

from plant import claim_domain

LONGEST_SECONDS = {"station": 3, "bridge ended": 4, "bridge killed": 4}  # a bridge waits 1 s for others before it serves
GIVEN_UP_SECONDS = 25
LATEST_STOP_SECONDS = {"station": 0.6, "bridge ended": 1.6, "bridge killed": 1.6}  # after the start
EVENTS = {"reader", "writer", "heard"}
CONFIG = """bridge: busy
dds: {{ domain: {domain}, interfaces: [127.0.0.1] }}
buses:
  - name: one
    port: {{ tcp: "127.0.0.1:1" }}
    protocol: modbus-tcp
    devices:
      - name: plc
        address: 1
        channels:
          - {{ name: level, at: "holding:0", type: uint16, refresh: 1s }}
"""


class Capture:
    """Records the newest datagrams to the domain's ports on the loopback, with their times."""

    MOST = 200_000

    def __init__(self, domain):
        self.ports = range(7400 + 250 * domain, 7400 + 250 * domain + 250)
        self.datagrams = collections.deque(maxlen=self.MOST)
        self.socket = socket.socket(socket.AF_PACKET, socket.SOCK_RAW, socket.htons(0x0800))
        self.socket.bind(("lo", 0x0800))
        self.socket.setsockopt(socket.SOL_SOCKET, 33, 64 << 20)  # SO_RCVBUFFORCE
        threading.Thread(target=self._receive, daemon=True).start()

    def _receive(self):
        while True:
            frame, address = self.socket.recvfrom(65536)
            if address[2] == socket.PACKET_OUTGOING or frame[23] != 17:  # each frame is received twice; UDP
                continue
            source, target = struct.unpack_from("!HH", frame, 14 + (frame[14] & 15) * 4)
            if target in self.ports:
                self.datagrams.append((time.monotonic(), source, target, frame[14 + (frame[14] & 15) * 4 + 8:]))

    def since(self, begin):
        return [one for one in list(self.datagrams) if one[0] >= begin]


KINDS = {0x06: "ACKNACK", 0x07: "HEARTBEAT", 0x08: "GAP", 0x09: "INFO_TS", 0x0e: "INFO_DST", 0x15: "DATA", 0x16: "DATA_FRAG"}


def describe(message):
    """Describes an RTPS message in one line: its sender, and its submessages with endpoints and numbers."""
    words, at = [message[8:20].hex()], 20
    while at + 4 <= len(message):
        kind, flags, length = message[at], message[at + 1], struct.unpack_from("<H", message, at + 2)[0]
        body = message[at + 4:]
        text = KINDS.get(kind, hex(kind))
        if kind == 0x0e:
            text += " " + body[:12].hex()
        elif kind == 0x15:
            text += f" {body[4:8].hex()}<-{body[8:12].hex()} {struct.unpack_from('<iI', body, 12)[1]}"
        elif kind == 0x07:
            first, last = struct.unpack_from("<iI", body, 8)[1], struct.unpack_from("<iI", body, 16)[1]
            text += f" {body[:4].hex()}<-{body[4:8].hex()} {first}..{last} count {struct.unpack_from('<I', body, 24)[0]} flags {flags:x}"
        elif kind == 0x06:
            base, bits = struct.unpack_from("<iII", body, 8)[1:]
            text += f" {body[:4].hex()}->{body[4:8].hex()} base {base} bits {bits} {body[20:20 + (bits + 31) // 32 * 4].hex()} flags {flags:x}"
        elif kind == 0x08:
            text += f" {body[:4].hex()}<-{body[4:8].hex()} {struct.unpack_from('<iI', body, 8)[1]}.."
        if kind != 0x09:
            words.append(text)
        if length == 0:
            break
        at += 4 + length
    return " | ".join(words)


class Station:
    def __init__(self, bin_dir, domain):
        self.events = collections.defaultdict(dict)  # of each participant: the time of each event
        self.joined = None
        self.process = subprocess.Popen([os.path.join(bin_dir, "discovery-probe"), str(domain)], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        self.reader = threading.Thread(target=self._read, daemon=True)
        self.reader.start()

    def _read(self):
        for line in self.process.stdout:
            event, participant, at = line.split()
            if event == "joined":
                self.joined = float(at)
            else:
                self.events[participant].setdefault(event, float(at))

    def wait(self, known, deadline):
        """Returns the time of complete discovery of a bridge that is not `known`; None after the deadline."""
        while time.monotonic() < deadline:
            for participant, events in list(self.events.items()):
                if participant not in known and EVENTS <= set(events):
                    return max(events.values())
            time.sleep(0.01)
        return None

    def end(self):
        self.process.stdin.close()
        try:
            self.process.wait(10)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
        self.reader.join()
        self.process.stdout.close()


class Trial:
    def __init__(self, bin_dir, folder, domain, options):
        self.bin_dir, self.domain, self.options = bin_dir, domain, options
        self.chance = random.Random(options.seed)
        self.config = os.path.join(folder, "busy.yaml")
        self.log = open(os.path.join(folder, "bridge.log"), "w", encoding="utf-8")
        with open(self.config, "w", encoding="utf-8") as file:
            file.write(CONFIG.format(domain=domain))
        self.capture = Capture(domain) if options.trace else None
        self.busy = [subprocess.Popen([sys.executable, "-c", "while True: pass"]) for _ in range(options.busy)]
        self.bridge = None
        self.watcher = None

    def start_bridge(self):
        self.bridge = subprocess.Popen([os.path.join(self.bin_dir, "fieldcast-bridge"), self.config], stdin=subprocess.DEVNULL, stdout=self.log,
                                       stderr=self.log)

    def stop(self, process, begin, latest):
        """Suspends the process once for a while; returns the times of stop and continuation."""
        moment, seconds = begin + self.chance.uniform(0, latest), self.chance.uniform(0.1, 2)
        time.sleep(max(0, moment - time.monotonic()))
        stopped = time.monotonic()
        process.send_signal(signal.SIGSTOP)
        time.sleep(seconds)
        process.send_signal(signal.SIGCONT)
        return stopped, time.monotonic()

    def run(self, number):
        """Runs once; returns (kind, seconds without the suspension, True if both directions matched)."""
        kind = self.chance.choice(["station", "station", "bridge ended", "bridge killed"])
        victim = self.chance.choice([None, "newcomer", "other", "other"])
        if kind == "station":
            begin = time.monotonic()
            station, known = Station(self.bin_dir, self.domain), set()
            newcomer, other = station.process, self.bridge
        else:
            station, known = self.watcher, set(self.watcher.events)
            (self.bridge.terminate if kind == "bridge ended" else self.bridge.kill)()
            self.bridge.wait()
            begin = time.monotonic()
            self.start_bridge()
            newcomer, other = self.bridge, station.process
        try:
            stopped = continued = begin
            if victim:
                stopped, continued = self.stop(newcomer if victim == "newcomer" else other, begin, LATEST_STOP_SECONDS[kind])
            end = station.wait(known, begin + GIVEN_UP_SECONDS)
            since = station.joined or begin if kind == "station" else begin
            until = end or time.monotonic()
            seconds = until - since - max(0, min(continued, until) - max(stopped, since))
            events = {participant[:-8]: {event: f"{at - since:.2f}" for event, at in found.items()}
                      for participant, found in station.events.items() if participant not in known}
            remark = f"{kind}, {victim or 'nobody'} stopped {stopped - since:.2f}..{continued - since:.2f} s, matched {events}"
            print(f"{number}: {seconds:.2f} s{'' if end else ', NOT COMPLETE'}: {remark}", flush=True)
            if self.capture and (not end or seconds > LONGEST_SECONDS[kind]):
                self.write_trace(number, remark, begin, since)
        finally:
            if kind == "station":
                station.end()
        return kind, seconds, end is not None

    def write_trace(self, number, remark, begin, since):
        with open(os.path.join(self.options.trace, f"run-{number}.txt"), "w", encoding="utf-8") as file:
            file.write(f"{remark}\n")
            for when, source, target, message in self.capture.since(begin - 0.2):
                file.write(f"{when - since:9.4f} {source} -> {target} {describe(message)}\n")

    def all(self):
        self.start_bridge()
        self.watcher = Station(self.bin_dir, self.domain)
        if not self.watcher.wait(set(), time.monotonic() + GIVEN_UP_SECONDS):
            sys.exit("the first station found no bridge")
        return [self.run(number) for number in range(self.options.runs)]

    def end(self):
        for process in [self.bridge, *self.busy]:
            if process and process.poll() is None:
                process.send_signal(signal.SIGCONT)
                process.kill()
                process.wait()
        if self.watcher:
            self.watcher.end()
        self.log.close()


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("bin_dir")
    parser.add_argument("--runs", type=int, default=8)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--busy", type=int, default=4)
    parser.add_argument("--trace")
    options = parser.parse_args()
    domain, claim = claim_domain()
    with claim, tempfile.TemporaryDirectory(prefix="fieldcast-busy-") as folder:
        trial = Trial(options.bin_dir, folder, domain, options)
        try:
            results = trial.all()
        finally:
            trial.end()
    late = [kind for kind, seconds, is_complete in results if not is_complete or seconds > LONGEST_SECONDS[kind]]
    for kind, longest in LONGEST_SECONDS.items():
        times = sorted(seconds for one, seconds, _ in results if one == kind)
        if times:
            print(f"{kind}: {len(times)} runs, median {times[len(times) // 2]:.2f} s, 9 of 10 within {times[(len(times) - 1) * 9 // 10]:.2f} s, "
                  f"longest {times[-1]:.2f} s of {longest} s")
    sys.exit(f"{len(late)} of {len(results)} runs lasted too long" if late else 0)


main()
