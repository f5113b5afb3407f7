"""Tests several connections to one controller: two buses with the same port, each with a connection and requests in flight of its own.

usage: connections_test.py BIN_FOLDER
"""

import contextlib
import json
import os
import socket
import subprocess
import sys
import tempfile
import threading
import unittest

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "tools"))
from peers import DEADLINE, Program, free_port
from plant import claim_domain

BIN = ""
ADDRESSES = {"s7-tcp": "DB1.DBW", "modbus-tcp": "holding:"}


class CountingRelay:
    """Carries TCP connections to a controller; `most` were open at the same time."""

    def __init__(self, server):
        self.server, self.open, self.most, self.lock = ("127.0.0.1", server), 0, 0, threading.Lock()
        self.listener = socket.create_server(("127.0.0.1", 0))
        self.port = self.listener.getsockname()[1]
        threading.Thread(target=self._serve, daemon=True).start()

    def _serve(self):
        with contextlib.suppress(OSError):
            while True:
                client = self.listener.accept()[0]
                with self.lock:
                    self.open += 1
                    self.most = max(self.most, self.open)
                server = socket.create_connection(self.server)
                threading.Thread(target=self._carry, args=(client, server, True), daemon=True).start()
                threading.Thread(target=self._carry, args=(server, client, False), daemon=True).start()

    def _carry(self, source, target, counted):
        with contextlib.suppress(OSError), source:
            while data := source.recv(65536):
                target.sendall(data)
        with contextlib.suppress(OSError):
            target.shutdown(socket.SHUT_RDWR)
        if counted:
            with self.lock:
                self.open -= 1


def bus(name, port, protocol, words, in_flight):
    channels = "".join(f'          - {{ name: w{word}, at: "{ADDRESSES[protocol]}{word}", type: uint16, access: read-write }}\n' for word in words)
    return (f'  - name: {name}\n    port: {{ tcp: "127.0.0.1:{port}" }}\n    protocol: {protocol}\n    in-flight: {in_flight}\n'
            f"    defaults: {{ refresh: 200ms }}\n    devices:\n      - name: plc\n        address: 1\n        channels:\n{channels}")


class ConnectionsTest(unittest.TestCase):
    def run_tool(self, *words):
        done = subprocess.run([os.path.join(BIN, "fieldcast"), *words, "--json", "--config", self.file], capture_output=True, text=True, timeout=DEADLINE)
        return [json.loads(line) for line in done.stdout.splitlines()]

    def check(self, protocol):
        with contextlib.ExitStack() as stack:
            folder = stack.enter_context(tempfile.TemporaryDirectory(prefix="fieldcast-connections-"))
            domain, claim = claim_domain()
            stack.enter_context(claim)
            device = free_port()
            words = range(0, 80, 2)
            plant = os.path.join(folder, "plant.yaml")
            with open(plant, "w", encoding="utf-8") as text:
                text.write("bridge: plant\nbuses:\n" + bus("plc", device, protocol, words, 1))
            stack.enter_context(Program(os.path.join(BIN, "fieldcast-sim"), plant)).wait_ready()
            relay = CountingRelay(device)
            stack.callback(relay.listener.close)
            self.file = os.path.join(folder, "bridge.yaml")
            with open(self.file, "w", encoding="utf-8") as text:
                text.write(f"bridge: connections\ndds: {{ domain: {domain}, interfaces: [127.0.0.1] }}\nbuses:\n"
                           + bus("one", relay.port, protocol, words[:20], 2) + bus("two", relay.port, protocol, words[20:], 2))
            stack.enter_context(Program(os.path.join(BIN, "fieldcast-bridge"), self.file))
            good = {(s["bus"], s["channel"]) for s in self.run_tool("watch", "--for", "5s") if s["quality"] == "GOOD"}
            self.assertEqual(good, {("one", f"w{word}") for word in words[:20]} | {("two", f"w{word}") for word in words[20:]})
            for target in ("one/plc/w0=7", "two/plc/w78=9"):
                self.assertEqual([result["state"] for result in self.run_tool("write", target, "--verify")], ["verified"])
            self.assertEqual(relay.most, 2)

    def test_s7(self):
        self.check("s7-tcp")

    def test_modbus(self):
        self.check("modbus-tcp")


if __name__ == "__main__":
    BIN = sys.argv.pop(1)
    unittest.main(verbosity=2)
