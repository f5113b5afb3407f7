"""Tests what a client of the gateway sees while the bridges of a standby group take over from each other.

usage: e2e_gateway_standby.py BIN_DIR

Both members run on this host and have the same gateway address, so only the master can listen there. The device counts its reads, and a client
that got a smaller count than before has got a stored response of an earlier master.
"""

import contextlib
import os
import socket
import struct
import subprocess
import sys
import threading
import time
import unittest

from plant import InAFolder, claim_domain, run_cli, wait_until

BIN_DIR = sys.argv.pop(1) if len(sys.argv) > 1 and not sys.argv[1].startswith("-") else "build/bin"
SECONDS = 30
NO_PATH, NO_RESPONSE, BUSY = 0x0A, 0x0B, 0x06

BRIDGE = """
bridge: {{ name: {name}, standby: {{ group: g, strength: {strength} }} }}
dds: {{ domain: {domain}, interfaces: [127.0.0.1] }}
buses:
  - name: one
    port: {{ tcp: "127.0.0.1:{device}" }}
    protocol: modbus-tcp
    gateway: {{ listen: "127.0.0.1:{gateway}", access: write, max-age: 100ms }}
    devices:
      - name: plc
        address: 1
        allow: [raw-write]
        channels:
          - {{ name: count, at: "holding:0", type: uint16, refresh: 100ms }}
"""


class Device:
    """A Modbus TCP device. Each read of its registers returns a greater value; writes are counted by value."""

    def __init__(self):
        self.listener = socket.create_server(("127.0.0.1", 0))
        self.port = self.listener.getsockname()[1]
        self.lock, self.count, self.writes = threading.Lock(), 0, {}
        threading.Thread(target=self._accept, daemon=True).start()

    def _accept(self):
        with contextlib.suppress(OSError):
            while True:
                connection, _ = self.listener.accept()
                connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
                threading.Thread(target=self._serve, args=(connection,), daemon=True).start()

    def _serve(self, connection):
        with contextlib.suppress(OSError), connection:
            data = b""
            while received := connection.recv(1024):
                data += received
                while len(data) >= 6 and len(data) >= 6 + int.from_bytes(data[4:6], "big"):
                    end = 6 + int.from_bytes(data[4:6], "big")
                    response = self._respond(data[7:end])
                    connection.sendall(data[:4] + struct.pack(">HB", len(response) + 1, data[6]) + response)
                    data = data[end:]

    def _respond(self, pdu):
        with self.lock:
            if pdu[0] == 6:
                value = int.from_bytes(pdu[3:5], "big")
                self.writes[value] = self.writes.get(value, 0) + 1
                return pdu
            self.count += 1
            values = struct.pack(">H", self.count) * int.from_bytes(pdu[3:5], "big")
            return pdu[:1] + bytes([len(values)]) + values


class Client:
    """A client of the gateway that connects again when it is disconnected. Keeps what it saw."""

    def __init__(self, port):
        self.port, self.socket, self.transaction = port, None, 0
        self.codes, self.refused, self.lost = {}, 0, 0

    def request(self, pdu):
        """Returns the PDU of the response; empty without a connection, or if it ended."""
        self.transaction = (self.transaction + 1) & 0xFFFF
        try:
            if self.socket is None:
                self.socket = socket.create_connection(("127.0.0.1", self.port), SECONDS)
        except ConnectionRefusedError:
            self.refused += 1
            return b""
        try:
            self.socket.sendall(struct.pack(">HHHB", self.transaction, 0, len(pdu) + 1, 1) + pdu)
            response = self._frame()
        except ConnectionError:
            response = b""
        if not response:
            self.close()
            self.lost += 1
            return b""
        assert response[:2] == self.transaction.to_bytes(2, "big"), response.hex()
        if response[7] & 0x80:
            self.codes[response[8]] = self.codes.get(response[8], 0) + 1
        return response[7:]

    def _frame(self):
        data = b""
        while len(data) < 6 or len(data) < 6 + int.from_bytes(data[4:6], "big"):
            received = self.socket.recv(300)
            if not received:
                return b""
            data += received
        return data

    def read(self):
        """Returns the count of the device, or None."""
        response = self.request(bytes.fromhex("0300070001"))
        return int.from_bytes(response[2:4], "big") if response[:1] == b"\x03" else None

    def write(self, value):
        return self.request(bytes.fromhex("060028") + value.to_bytes(2, "big"))[:1] == b"\x06"

    def close(self):
        if self.socket is not None:
            self.socket.close()
            self.socket = None


class GatewayStandby(InAFolder):
    def setUp(self):
        super().setUp()
        self.domain, claim = claim_domain()
        self.addCleanup(claim.__exit__, None, None, None)
        self.device = Device()
        self.addCleanup(self.device.listener.close)
        with socket.create_server(("127.0.0.1", 0)) as free:
            self.port = free.getsockname()[1]
        for name, strength in (("a", 2), ("b", 1)):
            self.file(f"{name}.yaml", BRIDGE.format(name=name, strength=strength, domain=self.domain, device=self.device.port, gateway=self.port))
        self.client = Client(self.port)
        self.addCleanup(self.client.close)

    def bridge(self, name):
        with open(self.path(f"{name}.log"), "a", encoding="utf-8") as log:
            process = subprocess.Popen([os.path.join(BIN_DIR, "fieldcast-bridge"), self.path(f"{name}.yaml")], stdin=subprocess.DEVNULL,
                                       stdout=log, stderr=subprocess.STDOUT)
        self.addCleanup(process.wait)
        self.addCleanup(process.kill)
        return process

    def log(self, name):
        with open(self.path(f"{name}.log"), encoding="utf-8") as file:
            return file.read()

    def says(self, name, text, times=1):
        wait_until(lambda: self.log(name).count(text) >= times, SECONDS, lambda: f"{name} does not say '{text}'\n{self.log('a')}\n{self.log('b')}")

    def start_both(self):
        processes = {"a": self.bridge("a")}
        self.says("a", "is master of group g")
        processes["b"] = self.bridge("b")
        self.says("b", "stands by in group g")
        wait_until(lambda: self.client.read() is not None, SECONDS, "the gateway of the master does not serve")
        return processes

    def during(self, take_over):
        """Reads and writes while `take_over` runs. Returns the seconds without a response."""
        over = threading.Thread(target=take_over)
        over.start()
        last, gap, value, newest, served = time.monotonic(), 0.0, 1000, 0, 0
        done = {}
        while over.is_alive() or served < 20:
            count = self.client.read()
            if count is not None:
                now = time.monotonic()
                gap, last, served = max(gap, now - last), now, served + 1 if not over.is_alive() else 0
                self.assertGreaterEqual(count, newest, "a value of before the last one")
                newest = count
            value += 1
            done[value] = self.client.write(value)
            self.assertLess(time.monotonic() - last, SECONDS, lambda: self.log("a") + self.log("b"))
            time.sleep(0.005)
        over.join()
        with self.device.lock:
            writes = dict(self.device.writes)
        for value, written in done.items():
            self.assertLessEqual(writes.get(value, 0), 1, f"{value} was written twice")
            self.assertTrue(not written or writes.get(value) == 1, f"{value} was confirmed and not written")
        return gap

    def test_a_waiting_member_refuses_connections(self):
        self.bridge("a")
        self.says("a", "is master of group g")
        wait_until(lambda: self.client.read() is not None, SECONDS, "the gateway of the master does not serve")
        with socket.create_server(("127.0.0.1", 0)) as free:
            other = free.getsockname()[1]
        self.file("b.yaml", BRIDGE.format(name="b", strength=1, domain=self.domain, device=self.device.port, gateway=other))
        self.bridge("b")
        self.says("b", "stands by in group g")
        waiting = Client(other)
        self.assertIsNone(waiting.read())
        self.assertEqual(waiting.refused, 1)

    def test_the_clients_of_a_killed_master_reach_its_successor(self):
        processes = self.start_both()
        gap = self.during(lambda: (processes["a"].kill(), processes["a"].wait(), self.says("b", "has taken over in group g")))
        print(f"killed: {gap:.2f} s without a response, {self.client.lost} connections lost, {self.client.refused} refused, {self.client.codes}")
        self.assertEqual(self.client.codes, {})
        self.assertGreaterEqual(self.client.lost, 1)
        self.assertLess(gap, 3)

    def test_the_clients_of_a_master_that_hands_over_reach_its_successor(self):
        self.start_both()

        def take_over():
            done = run_cli(BIN_DIR, "standby", "take", "b", "--domain", str(self.domain))
            self.assertEqual(done.code, 0, done)

        gap = self.during(take_over)
        self.says("a", "stands by in group g", 2)
        print(f"handed over: {gap:.2f} s without a response, {self.client.lost} connections lost, {self.client.refused} refused, {self.client.codes}")
        self.assertLessEqual(set(self.client.codes), {NO_PATH}, "a request of the last moment")
        self.assertLess(gap, 3)
        self.assertIsNotNone(self.client.read())
        self.assertNotIn("cannot listen", self.log("b"))


if __name__ == "__main__":
    unittest.main()
