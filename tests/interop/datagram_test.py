"""Reads and writes pymodbus over UDP through a network that loses, doubles and reorders datagrams.

Each register has the value of its address, so that a response taken for another request shows.

usage: datagram_test.py BIN_FOLDER
"""

import contextlib
import heapq
import itertools
import json
import os
import random
import select
import socket
import subprocess
import sys
import tempfile
import threading
import time
import unittest

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "tools"))
from peers import DEADLINE, Program, free_port
from plant import claim_domain

BIN = ""
PYMODBUS = os.path.join(os.path.dirname(os.path.abspath(__file__)), "pymodbus_server.py")
REGISTERS = range(0, 400, 17)  # each in a request of its own


class Network:
    """Carries datagrams between one master and a device; `bad` of them are lost, doubled or late."""

    def __init__(self, device, bad):
        self.device, self.bad, self.chance = ("127.0.0.1", device), bad, random.Random(5)
        self.counts = {"lost": 0, "doubled": 0, "late": 0, "carried": 0}
        self.near = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.near.bind(("127.0.0.1", 0))
        self.port = self.near.getsockname()[1]

    def __enter__(self):
        self.far = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.far.bind(("127.0.0.1", 0))
        self.over = threading.Event()
        self.thread = threading.Thread(target=self._carry)
        self.thread.start()
        return self

    def __exit__(self, *_):
        self.over.set()
        self.thread.join()
        self.near.close()
        self.far.close()

    def _delays(self):
        self.counts["carried"] += 1
        if self.chance.random() >= self.bad:
            return [0]
        fate = self.chance.choice(("lost", "doubled", "late"))
        self.counts[fate] += 1
        return {"lost": [], "doubled": [0, 0.003], "late": [0.03 + self.chance.random() * 0.4]}[fate]

    def _carry(self):
        waiting, number, master = [], itertools.count(), None
        while not self.over.is_set():
            left = max(0, waiting[0][0] - time.monotonic()) if waiting else 0.1
            for ready in select.select([self.near, self.far], [], [], min(left, 0.1))[0]:
                data, sender = ready.recvfrom(4096)
                out, to = (self.far, self.device) if ready is self.near else (self.near, master)
                if ready is self.near:
                    master = sender
                for delay in self._delays():
                    heapq.heappush(waiting, (time.monotonic() + delay, next(number), out, to, data))
            while waiting and waiting[0][0] <= time.monotonic():
                _, _, out, to, data = heapq.heappop(waiting)
                if to:
                    out.sendto(data, to)


class DatagramTest(unittest.TestCase):
    def run_bus(self, in_flight, bad):
        with contextlib.ExitStack() as stack:
            folder = stack.enter_context(tempfile.TemporaryDirectory(prefix="fieldcast-datagrams-"))
            domain, claim = claim_domain()
            stack.enter_context(claim)
            device = free_port()
            stack.enter_context(Program(sys.executable, PYMODBUS, "udp", device)).wait_ready()
            network = stack.enter_context(Network(device, bad))
            file = os.path.join(folder, "bridge.yaml")
            with open(file, "w", encoding="utf-8") as text:
                text.write(f"bridge: datagrams\ndds: {{ domain: {domain}, interfaces: [127.0.0.1] }}\nbuses:\n  - name: hall\n"
                           f'    port: {{ udp: "127.0.0.1:{network.port}" }}\n    protocol: modbus-tcp\n    in-flight: {in_flight}\n'
                           "    defaults: { refresh: 200ms, timeout: 100ms, retries: 2 }\n    devices:\n      - name: device\n        address: 1\n"
                           "        max-gap: 0\n        channels:\n")
                for register in REGISTERS:
                    text.write(f'          - {{ name: r{register}, at: "holding:{register}", type: uint16 }}\n')
                text.write('          - { name: setpoint, at: "holding:450", type: uint16, access: write-only }\n')
            log = stack.enter_context(open(os.path.join(folder, "bridge.log"), "w+", encoding="utf-8"))
            bridge = subprocess.Popen([os.path.join(BIN, "fieldcast-bridge"), file], stdin=subprocess.DEVNULL, stdout=log, stderr=log)
            try:
                watch = subprocess.run([os.path.join(BIN, "fieldcast"), "watch", "--json", "--for", "8s", "--config", file],
                                       capture_output=True, text=True, timeout=DEADLINE)
                states = []
                for value in range(20):
                    done = subprocess.run([os.path.join(BIN, "fieldcast"), "write", f"hall/device/setpoint={value}", "--json", "--config", file],
                                          capture_output=True, text=True, timeout=DEADLINE)
                    states.append(json.loads(done.stdout.splitlines()[-1])["state"] if done.stdout else done.stderr)
            finally:
                bridge.terminate()
                bridge.wait(DEADLINE)
            log.seek(0)
            return [json.loads(line) for line in watch.stdout.splitlines()], states, network.counts, log.read()

    def check(self, in_flight, bad):
        samples, states, counts, log = self.run_bus(in_flight, bad)
        good = [s for s in samples if s["quality"] == "GOOD"]
        wrong = [s for s in good if s["value"] != 1000 + int(s["channel"][1:])]
        self.assertEqual(wrong, [], log)
        self.assertEqual({s["channel"] for s in good}, {f"r{r}" for r in REGISTERS}, log)
        self.assertGreater(len(good), 8 * 5 * len(REGISTERS) / 4, f"{counts} {log}")
        self.assertGreater(states.count("done"), 10, f"{states} {log}")
        self.assertGreater(min(counts["lost"], counts["doubled"], counts["late"]), 10)

    def test_one_request_in_flight(self):
        self.check(1, 0.06)

    def test_several_requests_in_flight(self):
        self.check(4, 0.06)


if __name__ == "__main__":
    BIN = sys.argv.pop(1)
    unittest.main()
