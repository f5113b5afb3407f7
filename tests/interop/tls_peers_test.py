"""Tests Modbus TCP inside TLS (MODBUS/TCP Security) with servers of other authors: pymodbus, and socat before libmodbus.

usage: tls_peers_test.py BIN_FOLDER LIBMODBUS_SERVER
"""

import contextlib
import json
import os
import socket
import ssl
import subprocess
import sys
import threading
import time
import unittest

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "tools"))
from peers import DEADLINE, Program, free_port
from plant import InAFolder, claim_domain, run_cli, running_bridge, wait_until

BIN = LIBMODBUS = ""
PYMODBUS = os.path.join(os.path.dirname(os.path.abspath(__file__)), "pymodbus_server.py")

CONFIG = """
bridge: secured
dds: {{ domain: {domain}, interfaces: [127.0.0.1] }}
buses:
  - name: pymodbus
    port: {{ tls: "127.0.0.1:{pymodbus}", authority: ca.pem, certificate: bridge.pem, key: bridge.key }}
    protocol: modbus-tcp
    in-flight: 4
    defaults: &defaults {{ refresh: 200ms, timeout: 1s }}
    devices: &devices
      - name: device
        address: 1
        channels:
          - {{ name: register, at: "holding:7", type: uint16 }}
          - {{ name: far, at: "holding:400", type: uint16 }}
          - {{ name: input, at: "input-register:20", type: uint16 }}
          - {{ name: setpoint, at: "holding:40", type: int16, access: read-write }}
  - name: socat
    port: {{ tls: "localhost:{socat}", authority: ca.pem, certificate: bridge.pem, key: bridge.key, server-name: plc-7 }}
    protocol: modbus-tcp
    defaults: *defaults
    devices: *devices
"""
VALUES = {"register": 1007, "far": 1400, "input": 2020}


class TlsPeersTest(InAFolder):
    def setUp(self):
        super().setUp()
        for authority in ("ca", "other"):
            self.openssl(f"req -x509 -newkey rsa:2048 -nodes -days 2 -subj /CN={authority} -addext basicConstraints=critical,CA:TRUE "
                         "-addext keyUsage=critical,keyCertSign "
                         f"-keyout {authority}.key -out {authority}.pem")
        for name, subject in (("bridge", "DNS:bridge"), ("address", "IP:127.0.0.1"), ("name", "DNS:plc-7")):
            self.issue(name, "ca", subject)
        self.issue("stranger", "other", "IP:127.0.0.1")

    def openssl(self, command):
        subprocess.run(["openssl", *command.split()], cwd=self.folder, check=True, capture_output=True, timeout=DEADLINE)

    def issue(self, name, authority, subject):
        self.openssl(f"req -x509 -newkey rsa:2048 -nodes -days 2 -subj /CN={name} -addext subjectAltName={subject} "
                     "-addext basicConstraints=critical,CA:FALSE -addext keyUsage=critical,digitalSignature,keyEncipherment "  # as RFC 5280 asks
                     f"-CA {authority}.pem -CAkey {authority}.key -keyout {name}.key -out {name}.pem")

    def pymodbus(self, port, name, authority="ca"):
        return Program(sys.executable, PYMODBUS, "tls", port, "--certificate", self.path(f"{name}.pem"), "--key", self.path(f"{name}.key"),
                       "--ca", self.path(f"{authority}.pem"))

    @contextlib.contextmanager
    def socat(self, port, options):
        """A server that ends TLS and speaks plain Modbus TCP with libmodbus behind it."""
        plain = free_port()
        with Program(LIBMODBUS, "tcp", plain).wait_ready():
            ends = subprocess.Popen(["socat", f"OPENSSL-LISTEN:{port},reuseaddr,fork,cert={self.path('name.pem')},key={self.path('name.key')},"
                                     f"cafile={self.path('ca.pem')},verify=1,{options}", f"TCP:127.0.0.1:{plain}"],
                                    stdin=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            try:
                yield
            finally:
                ends.kill()
                ends.wait()

    def samples(self, bus):
        done = run_cli(BIN, "watch", "--json", "--once", "--config", self.config)
        return {s["channel"]: s for s in map(json.loads, done.out.splitlines()) if s["bus"] == bus}

    def wait_for(self, bus, values):
        def read():
            samples = self.samples(bus)
            return all(samples.get(name, {}).get("quality") == "GOOD" and samples[name]["value"] == value for name, value in values.items())
        wait_until(read, DEADLINE, lambda: f"{bus}: {self.samples(bus)}, {self.log()}")

    def log(self):
        with open(self.path("log"), encoding="utf-8") as file:
            return file.read()

    def test_the_bridge_reads_writes_and_connects_again(self):
        with contextlib.ExitStack() as stack:
            domain, claim = claim_domain()
            stack.enter_context(claim)
            first, second = free_port(), free_port()
            self.config = self.file("bridge.yaml", CONFIG.format(domain=domain, pymodbus=first, socat=second))
            server = stack.enter_context(self.pymodbus(first, "address")).wait_ready()
            # The suite of a device without ephemeral keys.
            stack.enter_context(self.socat(second, "openssl-min-proto-version=TLS1.2,openssl-max-proto-version=TLS1.2,ciphers=AES128-SHA256"))
            stack.enter_context(running_bridge(BIN, self.config, self.path("log")))
            for bus in ("pymodbus", "socat"):
                self.wait_for(bus, VALUES)
                written = run_cli(BIN, "write", f"{bus}/device/setpoint=-123", "--verify", "--json", "--config", self.config)
                self.assertEqual((written.code, json.loads(written.out)["state"]), (0, "verified"), written)
                self.wait_for(bus, {"setpoint": -123})
            server.stop()
            with self.pymodbus(first, "stranger").wait_ready():
                wait_until(lambda: "is refused: " in self.log(), DEADLINE, self.log)
            stack.enter_context(self.pymodbus(first, "address")).wait_ready()
            self.wait_for("pymodbus", VALUES)
            self.assertNotIn("PRIVATE", self.log())

    def read(self, port, *options, place="127.0.0.1", authority="ca", certificate="bridge"):
        return run_cli(BIN, "read", f"tls:{place}:{port}", "--ca", self.path(f"{authority}.pem"), "--certificate", self.path(f"{certificate}.pem"),
                       "--key", self.path(f"{certificate}.key"), *options, "holding:7")

    def test_a_value_is_read_without_a_bridge(self):
        port = free_port()
        with self.pymodbus(port, "address").wait_ready():
            done = self.read(port)
            self.assertEqual(done.code, 0, done)
            self.assertIn("1007", done.out)

    def test_each_refusal_has_its_reason(self):
        port = free_port()
        with self.pymodbus(port, "address").wait_ready():
            for options, reason in (
                ({"authority": "other"}, "the certificate of the server for '127.0.0.1' is refused: "),
                ({"certificate": "stranger"}, "it may refuse the certificate of this client"),  # asyncio drops the alert
                ({"place": "localhost"}, "for 'localhost' is refused: hostname mismatch"),
            ):
                done = self.read(port, **options)
                self.assertNotEqual(done.code, 0, done)
                self.assertIn(reason, done.err, done)
            done = self.read(port, "--server-name", "plc-7")
            self.assertIn("for 'plc-7' is refused: hostname mismatch", done.err, done)

    def test_a_server_that_sends_garbage_inside_tls_is_no_device(self):
        context = ssl.create_default_context(ssl.Purpose.CLIENT_AUTH)
        context.load_cert_chain(self.path("address.pem"), self.path("address.key"))
        with socket.create_server(("127.0.0.1", 0)) as listener:
            def serve():
                with contextlib.suppress(OSError):
                    while True:
                        peer = context.wrap_socket(listener.accept()[0], server_side=True)
                        with contextlib.suppress(OSError):
                            peer.recv(300)
                            peer.sendall(os.urandom(1_000_000))
                        peer.close()

            thread = threading.Thread(target=serve)
            thread.start()
            begun = time.monotonic()
            done = self.read(listener.getsockname()[1])
            self.assertNotEqual(done.code, 0, done)
            self.assertLess(time.monotonic() - begun, DEADLINE)
            listener.shutdown(socket.SHUT_RDWR)
            thread.join(DEADLINE)


if __name__ == "__main__":
    LIBMODBUS, BIN = sys.argv.pop(), sys.argv.pop()
    unittest.main()
