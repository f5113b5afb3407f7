"""Tests the gateway of a bus with clients and a device of other authors: mbpoll, libmodbus and
pymodbus in front, a libmodbus device on a line of 19 200 baud behind.

usage: gateway_peers_test.py BIN_FOLDER LIBMODBUS_SERVER
"""

import contextlib
import os
import socket
import sys
import threading
import time
import unittest

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "tools"))
from peers import DEADLINE, LibmodbusClient, Mbpoll, Program, PymodbusClient, SerialCable, free_port
from plant import InAFolder, claim_domain, run_cli, running_bridge, wait_until

BIN = LIBMODBUS = ""
UNIT = 7
CONFIG = """
bridge: gateway
dds: {{ domain: {domain}, interfaces: [127.0.0.1] }}
store: {{ path: {folder}/store.db }}
buses:
  - name: line
    port: {{ serial: {line}, baud: 19200, format: 8N1 }}
    protocol: modbus-rtu
    gateway: {{ listen: 127.0.0.1:{port}, access: write, idle: 2s, connections: 12, max-age: {max_age} }}
    defaults: {{ refresh: 1s, timeout: 500ms }}
    devices:
      - name: device
        address: {unit}
        allow: [raw-write]
        channels:
          - {{ name: first, at: "holding:7", type: uint16 }}
          - {{ name: second, at: "input-register:20", type: uint16 }}
      - {{ name: absent, address: 9, allow: [raw-write] }}
"""
EXPECTED = {  # memory of the device
    "coil": lambda n: int(n % 3 == 0),
    "input": lambda n: n % 2,
    "holding": lambda n: 1000 + n,
    "input-register": lambda n: 2000 + n,
}

OTHER = """
bridge: gateway
dds: {{ domain: {domain}, interfaces: [127.0.0.1] }}
buses:
  - name: line
    port: {{ serial: {folder}/line, baud: 9600, format: 7E2 }}
    protocol: omron-hostlink
    gateway:
      listen: 127.0.0.1:{port}
      access: write
      verify: true
      units: {{ 1: plc }}
      map:
        plc:
          - {{ registers: 0, at: DM100, count: 50 }}
          - {{ registers: 100, at: DM200, type: float32, count: 4 }}
          - {{ bits: 0, at: CIO10.00, count: 32 }}
    defaults: {{ refresh: 1s, timeout: 500ms }}
    devices:
      - name: plc
        address: 0
        allow: [raw-write]
        channels:
          - {{ name: pressure, at: DM100, type: uint16, access: read-write }}
          - {{ name: level, at: DM202, type: float32, access: read-write }}
          - {{ name: pump, at: CIO11.03, type: bool, access: read-write }}
"""


class GatewayPeersTest(InAFolder):
    @contextlib.contextmanager
    def gateway(self, max_age="0ms", in_flight=False):
        with contextlib.ExitStack() as stack:
            domain, claim = claim_domain()
            stack.enter_context(claim)
            cable = stack.enter_context(SerialCable())
            port, device = free_port(), free_port()
            server = ("tcp", device) if in_flight else ("rtu", cable.right, 19200, UNIT)
            stack.enter_context(Program(LIBMODBUS, *server)).wait_ready()
            text = CONFIG.format(domain=domain, folder=self.folder, line=cable.left, port=port, unit=UNIT, max_age=max_age)
            if in_flight:
                text = text.replace(f"serial: {cable.left}, baud: 19200, format: 8N1 }}", f'tcp: "127.0.0.1:{device}" }}\n    in-flight: 4')
                text = text.replace("modbus-rtu", "modbus-tcp")
            self.config = self.file("bridge.yaml", text)
            stack.enter_context(running_bridge(BIN, self.config, self.path("log")))
            self.wait_connected(port)
            yield port

    def wait_connected(self, port, unit=UNIT, expected=(1000,)):
        end = time.monotonic() + DEADLINE
        while True:
            with contextlib.suppress(OSError, AssertionError):
                client = LibmodbusClient(port, unit)
                values = client.read("holding", 0, 1)
                client.close()
                if values == list(expected):
                    return
            self.assertLess(time.monotonic(), end, "the gateway does not serve")
            time.sleep(0.05)

    def raw(self, port, request):
        """Returns the response to the bytes of one request."""
        with socket.create_connection(("127.0.0.1", port), DEADLINE) as client:
            client.sendall(bytes.fromhex(request))
            return client.recv(300).hex(" ")

    def test_every_client_reads_and_writes_what_the_device_has(self):
        with self.gateway() as port:
            clients = [Mbpoll("127.0.0.1", port=port, unit=UNIT), LibmodbusClient(port, UNIT), PymodbusClient(port, UNIT)]
            for client in clients:
                for area, value in EXPECTED.items():
                    for first, count in ((0, 1), (3, 9), (380, 120)):
                        self.assertEqual(client.read(area, first, count), [value(n) for n in range(first, first + count)], (client, area))
            for number, client in enumerate(clients):
                first = 100 + 10 * number
                self.assertIs(client.write("holding", first, 7, 8, 9 + number), True)
                self.assertIs(client.write("coil", first, 1, 0, 1), True)
                for reader in clients:
                    self.assertEqual(reader.read("holding", first, 3), [7, 8, 9 + number])
                    self.assertEqual(reader.read("coil", first, 3), [1, 0, 1])
            for client in clients[1:]:
                client.close()
            audit = run_cli(BIN, "audit", "--config", self.config)
            self.assertIn("gateway 127.0.0.1:", audit.out, audit)
            self.assertIn("line/device at holding:100", audit.out, audit)

    def test_masks_and_reads_behind_writes_reach_the_device(self):
        with self.gateway("1s") as port:
            client = PymodbusClient(port, UNIT)
            self.assertIs(client.write("holding", 4, 0x12), True)
            self.assertFalse(client.mask(4, 0xF2, 0x25).isError())
            self.assertEqual(client.read("holding", 4, 1), [0x17], "the example of the standard")
            self.assertEqual(client.swap(3, 3, 5, 0xFF, 0x0ACD).registers, [1003, 0x17, 0xFF])
            self.assertEqual(client.read("holding", 6, 1), [0x0ACD])
            self.assertEqual(client.mask(500, 0xF2, 0x25).exception_code, 2)
            self.assertEqual(client.swap(500, 1, 5, 1).exception_code, 2, "it is written before it is read")
            self.assertEqual(client.read("holding", 5, 1), [1])
            client.close()
            self.assertEqual(self.raw(port, "00 07 00 00 00 08 07 16 00 04 FF F0 12 34"), "00 07 00 00 00 08 07 16 00 04 ff f0 12 34")

    def test_a_plc_of_another_protocol_is_a_modbus_unit(self):
        with contextlib.ExitStack() as stack:
            domain, claim = claim_domain()
            stack.enter_context(claim)
            port = free_port()
            config = self.file("bridge.yaml", OTHER.format(domain=domain, folder=self.folder, port=port))
            stack.enter_context(Program(os.path.join(BIN, "fieldcast-sim"), config))
            wait_until(lambda: os.path.exists(self.path("line")), DEADLINE, "the simulated line did not appear")
            stack.enter_context(running_bridge(BIN, config, self.path("log")))
            for channel, value in (("pressure", 700), ("level", 1.5), ("pump", "true")):
                written = run_cli(BIN, "write", f"line/plc/{channel}={value}", "--config", config)
                self.assertEqual(written.code, 0, written)
            self.wait_connected(port, 1, [700])
            for client in (Mbpoll("127.0.0.1", port=port, unit=1), LibmodbusClient(port, 1), PymodbusClient(port, 1)):
                self.assertEqual(client.read("holding", 0, 1), [700])
                self.assertEqual(client.read("input-register", 102, 2), [0x3FC0, 0], "1.5, high word first")
                self.assertEqual(client.read("coil", 19, 1), [1])
                self.assertIs(client.write("holding", 40, 11, 12, 13), True)
                self.assertEqual(client.read("holding", 40, 3), [11, 12, 13])
                self.assertIs(client.write("coil", 2, 1), True)
                self.assertEqual(client.read("input", 2, 1), [1])
            for request, response in (
                ("00 01 00 00 00 06 01 03 00 32 00 01", "00 01 00 00 00 03 01 83 02"),  # in no row
                ("00 02 00 00 00 06 01 03 00 65 00 01", "00 02 00 00 00 03 01 83 02"),  # half a number
                ("00 03 00 00 00 08 01 16 00 04 00 F2 00 25", "00 03 00 00 00 03 01 96 01"),  # no mask
                ("00 04 00 00 00 0D 01 17 00 28 00 02 00 29 00 01 02 00 FF", "00 04 00 00 00 07 01 17 04 00 0b 00 ff"),
            ):
                self.assertEqual(self.raw(port, request), response)

    def test_exceptions_are_those_of_the_book(self):
        with self.gateway() as port:
            for request, response in (
                ("00 01 00 00 00 06 07 03 00 07 00 01", "00 01 00 00 00 05 07 03 02 03 ef"),
                ("00 02 00 00 00 06 07 03 01 F4 00 01", "00 02 00 00 00 03 07 83 02"),  # of the device: 500 is missing
                ("00 03 00 00 00 06 07 03 00 00 00 7E", "00 03 00 00 00 03 07 83 03"),
                ("00 04 00 00 00 02 07 07", "00 04 00 00 00 03 07 87 01"),
                ("00 05 00 00 00 06 08 03 00 07 00 01", "00 05 00 00 00 03 08 83 0a"),  # no such unit
                ("00 06 00 00 00 06 09 03 00 07 00 01", "00 06 00 00 00 03 09 83 0b"),  # no response
            ):
                self.assertEqual(self.raw(port, request), response)

    def test_broken_and_hostile_clients_are_bounded(self):
        with self.gateway() as port, contextlib.ExitStack() as stack:
            with socket.create_connection(("127.0.0.1", port), DEADLINE) as client:
                client.sendall(b"GET / HTTP/1.1\r\n\r\n")
                self.assertEqual(client.recv(100), b"", "it is disconnected")
            silent = [stack.enter_context(socket.create_connection(("127.0.0.1", port), DEADLINE)) for _ in range(30)]
            for client in silent:
                with contextlib.suppress(OSError):
                    client.sendall(bytes.fromhex("00 01 00 00"))  # never completed
            good = LibmodbusClient(port, UNIT)  # displaces a silent one
            self.assertEqual(good.read("holding", 3, 1), [1003])
            for client in silent:  # the others after `idle`
                with contextlib.suppress(ConnectionResetError):
                    self.assertEqual(client.recv(1), b"")
            flood = stack.enter_context(socket.create_connection(("127.0.0.1", port), DEADLINE))
            flood.setblocking(False)
            with contextlib.suppress(BlockingIOError, ConnectionError):
                for _ in range(20000):
                    flood.send(bytes.fromhex("00 01 00 00 00 06 07 03 00 00 00 7D"))
            again = PymodbusClient(port, UNIT)
            self.assertEqual(again.read("holding", 3, 1), [1003])
            again.close()
            good.close()

    def test_many_clients_see_one_line(self):
        self.see_one_device(max_age="200ms")

    def test_many_clients_share_the_requests_in_flight(self):
        self.see_one_device(in_flight=True)

    def see_one_device(self, **options):
        with self.gateway(**options) as port:
            kinds = [LibmodbusClient, PymodbusClient] * 4
            wrong = []

            def ask(kind, number):
                client = kind(port, UNIT)
                for turn in range(20):
                    first = number * 10 + turn
                    values = client.read("holding", first, 8)
                    if values != [1000 + n for n in range(first, first + 8)]:
                        wrong.append((kind, first, values))
                client.close()

            threads = [threading.Thread(target=ask, args=(kind, number)) for number, kind in enumerate(kinds)]
            for thread in threads:
                thread.start()
            for thread in threads:
                thread.join()
            self.assertEqual(wrong, [])


if __name__ == "__main__":
    LIBMODBUS, BIN = sys.argv.pop(), sys.argv.pop()
    unittest.main()
