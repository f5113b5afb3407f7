"""Tests the bridge with Modbus devices of other authors, libmodbus and pymodbus, over serial lines,
TCP and UDP at the same time.

usage: bridge_peers_test.py BIN_FOLDER LIBMODBUS_SERVER
"""

import contextlib
import json
import os
import subprocess
import sys
import tempfile
import time
import unittest

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "tools"))
from peers import DEADLINE, Cable, Program, free_port
from plant import claim_domain
from pymodbus_server import OBJECTS, SERVES_FILES

BIN = LIBMODBUS = ""
PYMODBUS = os.path.join(os.path.dirname(os.path.abspath(__file__)), "pymodbus_server.py")

CHANNELS = {  # name: (at, type, value in the servers' memory)
    "coil-3": ("coil:3", "bool", True),
    "coil-4": ("coil:4", "bool", False),
    "input-5": ("input:5", "bool", True),
    "register-7": ("holding:7", "uint16", 1007),
    "pair": ("holding:10", "uint32", (1010 << 16) + 1011),
    "swapped-pair": ("holding:12", "uint32, word-order: little-endian", (1013 << 16) + 1012),
    "far": ("holding:499", "uint16", 1499),
    "input-register-20": ("input-register:20", "int16", 2020),
    "setpoint": ("holding:40", "int16, access: read-write", 1040),
    "switch": ("coil:41", "bool, access: read-write", False),
    "bit": ("holding:60.3", "bool, access: read-write", bool(1060 >> 3 & 1)),
}
NOT_QUEUED = {"third-queued": ("fifo:1246:3", "uint16"), "half-queued": ("fifo:1246:2", "uint32"), "none-queued": ("fifo:7:1", "uint16")}
PYMODBUS_CHANNELS = {  # libmodbus has neither files nor objects
    **CHANNELS,
    **{f"object-{id}": (f"id:{id}", "string(244)", text) for id, text in OBJECTS.items()},
    "object-cut": ("id:1", "string(5)", "Model"),
    "object-empty": ("id:3", "string(8)", ""),
    **({
        "record": ("file:4:1", "uint16", 4001),
        "records": ("file:3:9", "uint32", (3009 << 16) + 3010),
        "queued": ("fifo:1246", "uint16", 2),
        "first-queued": ("fifo:1246:1", "uint16", 0x01B8),
        "both-queued": ("fifo:1246:1", "uint32", 0x01B81284),
        "empty-queue": ("fifo:7", "uint16", 0),
        **{name: (at, kind, None) for name, (at, kind) in NOT_QUEUED.items()},
        "last-record": ("file:65535:9999", "uint16", (65535 * 1000 + 9999) & 0xFFFF),
        "recipe": ("file:5:100", "float32, access: read-write", None),
        "recipe-bit": ("file:5:120.3", "bool, access: read-write", bool(5120 >> 3 & 1)),
    } if SERVES_FILES else {}),
}
WRITES = {"setpoint": -123, "switch": True, "bit": not CHANNELS["bit"][2]}
FILE_WRITES = {"recipe": 2.5, "recipe-bit": not PYMODBUS_CHANNELS["recipe-bit"][2]} if SERVES_FILES else {}


def channels_of(name):
    return PYMODBUS_CHANNELS if name.startswith("pymodbus") else CHANNELS


def writes_of(name):
    return {**WRITES, **FILE_WRITES} if name.startswith("pymodbus") else WRITES


class RecordingCable(Cable):
    """`sent` is what `left` sent."""

    def __enter__(self):
        self.sent = b""
        return super().__enter__()

    def _forward(self, data, master, other):
        if master == self.ends[0][0]:
            self.sent += data
        super()._forward(data, master, other)


def bus(name, port, protocol, unit, options=""):
    channels = "".join(f'          - {{ name: {channel}, at: "{at}", type: {kind} }}\n'
                       for channel, (at, kind, _) in channels_of(name).items())
    return (f"  - name: {name}\n    port: {{ {port} }}\n    protocol: {protocol}\n    defaults: {{ refresh: 500ms, timeout: 1s }}\n"
            f"    devices:\n      - name: device\n        address: {unit}\n{options}        channels:\n{channels}")


class BridgePeersTest(unittest.TestCase):
    def cli(self, *arguments):
        return subprocess.run([os.path.join(BIN, "fieldcast"), *arguments, "--config", self.file], capture_output=True, text=True, timeout=DEADLINE)

    def samples(self):
        done = self.cli("watch", "--json", "--once")
        return {(s["bus"], s["channel"]): s for s in map(json.loads, done.stdout.splitlines())}

    def expect_values(self, buses, expected_of):
        end = time.monotonic() + DEADLINE
        while True:
            samples = self.samples()
            wrong = {(b, c): samples.get((b, c)) for b in buses for c, value in expected_of(b).items()
                     if samples.get((b, c), {}).get("quality") != "GOOD" or samples[b, c]["value"] != value}
            if not wrong:
                return
            self.assertLess(time.monotonic(), end, f"never as expected: {wrong}")

    def test_every_value_and_every_kind_of_write(self):
        with contextlib.ExitStack() as stack:
            folder = stack.enter_context(tempfile.TemporaryDirectory(prefix="fieldcast-interop-"))
            domain, claim = claim_domain()
            stack.enter_context(claim)
            text = f"bridge: interop\ndds: {{ domain: {domain}, interfaces: [127.0.0.1] }}\nbuses:\n"
            buses = []
            for name, server, kind in (("libmodbus-rtu", [LIBMODBUS], "rtu"), ("pymodbus-rtu", [sys.executable, PYMODBUS], "rtu"),
                                       ("pymodbus-ascii", [sys.executable, PYMODBUS], "ascii")):
                cable = stack.enter_context(Cable())
                stack.enter_context(Program(*server, kind, cable.right, 115200, 7)).wait_ready()
                text += bus(name, f"serial: {cable.left}, baud: 115200, format: 8N1", f"modbus-{kind}", 7)
                buses.append(name)
            masked = stack.enter_context(RecordingCable())
            stack.enter_context(Program(LIBMODBUS, "rtu", masked.right, 115200, 7)).wait_ready()
            text += bus("libmodbus-masked", f"serial: {masked.left}, baud: 115200, format: 8N1", "modbus-rtu", 7,
                        "        options: { mask-write: true }\n")
            buses.append("libmodbus-masked")
            for name, server in (("libmodbus-tcp", [LIBMODBUS]), ("pymodbus-tcp", [sys.executable, PYMODBUS])):
                port = free_port()
                stack.enter_context(Program(*server, "tcp", port)).wait_ready()
                text += bus(name, f'tcp: "127.0.0.1:{port}"', "modbus-tcp", 1)
                buses.append(name)
            port = free_port()  # of TCP: a server of datagrams takes the same number
            stack.enter_context(Program(sys.executable, PYMODBUS, "udp", port)).wait_ready()
            text += bus("pymodbus-udp", f'udp: "127.0.0.1:{port}"', "modbus-tcp", 1)
            buses.append("pymodbus-udp")
            self.file = os.path.join(folder, "bridge.yaml")
            with open(self.file, "w", encoding="utf-8") as file:
                file.write(text)
            log = stack.enter_context(open(os.path.join(folder, "bridge.log"), "w+", encoding="utf-8"))
            bridge = subprocess.Popen([os.path.join(BIN, "fieldcast-bridge"), self.file], stdin=subprocess.DEVNULL, stdout=log, stderr=log)
            try:
                self.expect_values(buses, lambda name: {channel: value for channel, (_, _, value) in channels_of(name).items()
                                                        if value is not None})
                if SERVES_FILES:
                    samples = self.samples()
                    self.assertEqual({samples["pymodbus-tcp", name]["quality"] for name in NOT_QUEUED}, {"BAD_RANGE"})
                for name in buses:
                    for channel, value in writes_of(name).items():
                        done = self.cli("write", f"{name}/device/{channel}={json.dumps(value)}", "--verify", "--json")
                        self.assertEqual((done.returncode, json.loads(done.stdout)["state"]), (0, "verified"), done.stdout + done.stderr)
                self.expect_values(buses, writes_of)
                self.assertIn(bytes.fromhex("0716003C"), masked.sent, "the bit was not written by function 22")
                bridge.terminate()
                self.assertEqual(bridge.wait(DEADLINE), 0)
            except BaseException:
                log.seek(0)
                sys.stderr.write(log.read())
                raise
            finally:
                if bridge.poll() is None:
                    bridge.kill()
                    bridge.wait()


if __name__ == "__main__":
    LIBMODBUS, BIN = sys.argv.pop(), sys.argv.pop()
    unittest.main()
