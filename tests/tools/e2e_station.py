"""Tests simulator, bridge and fieldcast-station: the server shows the plant, users log in, writes
work, and it shuts down in order.

usage: e2e_station.py BIN_DIR
"""

import base64
import http.client
import json
import os
import re
import signal
import socket
import ssl
import struct
import subprocess
import sys
import unittest

from plant import Plant, modbus_line, wait_until

BIN_DIR = ""
SECONDS = 30

CONFIG = """
bridge: e2e""" + modbus_line() + """\
          - { name: temperature, at: "holding:100", type: float32 }
          - { name: speed, at: "holding:7", type: int16, access: read-write }
"""


class Station:
    """The program with its own configuration; stopped on exit, with a check of the exit code."""

    def __init__(self, plant, name, text, *arguments, dds=None, joins=True):
        """`dds`: the section, if it is more than the domain. `joins`: false for a station without this section."""
        self.plant, self.name, self.arguments = plant, name, arguments
        self.text = (f"dds: {{ {dds or f'domain: {plant.domain}'} }}\n" if joins else "") + text

    def __enter__(self):
        self.path = os.path.join(self.plant.run, self.name + ".yaml")
        with open(self.path, "w", encoding="utf-8") as file:
            file.write(f"station: {self.name}\n{self.text}")
        self.log_path = os.path.join(self.plant.run, self.name + ".log")
        with open(self.log_path, "wb") as log:
            self.process = subprocess.Popen([os.path.join(BIN_DIR, "fieldcast-station"), "--config", self.path, *self.arguments],
                                            stdout=log, stderr=log)
        found = wait_until(lambda: re.search(r"served at (https?)://([\d.]+):(\d+)/", self.log()) or self.process.poll() is not None,
                           SECONDS, self.log)
        if found is True:
            raise AssertionError("the station ended: " + self.log())
        self.secure, self.port = found[1] == "https", int(found[3])
        self.origin = f"{found[1]}://127.0.0.1:{self.port}"
        return self

    def __exit__(self, kind, value, trace):
        self.process.send_signal(signal.SIGTERM)
        code = self.process.wait(SECONDS)
        if kind is None and code != 0:
            raise AssertionError(f"the station ended with {code}\n{self.log()}")

    def log(self):
        with open(self.log_path, encoding="utf-8", errors="replace") as file:
            return file.read()

    def connect(self):
        if not self.secure:
            return http.client.HTTPConnection("127.0.0.1", self.port, timeout=SECONDS)
        context = ssl.create_default_context(cafile=os.path.join(self.plant.run, "cert.pem"))
        return http.client.HTTPSConnection("127.0.0.1", self.port, timeout=SECONDS, context=context)


class Browser:
    """Keeps its cookie and sends requests as a page of the station does."""

    def __init__(self, station):
        self.station, self.cookie = station, ""

    def ask(self, method, path, body=None, **headers):
        connection = self.station.connect()
        given = {"Cookie": self.cookie} if self.cookie else {}
        if method != "GET":
            given["Origin"] = self.station.origin
        if body is not None:
            given["Content-Type"] = "application/json"
        connection.request(method, path, None if body is None else json.dumps(body), given | headers)
        response = connection.getresponse()
        text = response.read().decode()
        if cookie := response.getheader("set-cookie"):
            self.cookie = cookie.split(";")[0]
        connection.close()
        return response.status, text

    def get(self, path):
        status, text = self.ask("GET", path)
        assert status == 200, (path, status, text)
        return json.loads(text)

    def log_in(self, user, password):
        return self.ask("POST", "/api/login", {"user": user, "password": password})[0]


class Socket:
    """A WebSocket to /live: texts as objects, binary frames as lists of (id, value, quality)."""

    def __init__(self, browser):
        connection = browser.station.connect()
        connection.connect()
        self.socket = connection.sock
        key = base64.b64encode(os.urandom(16)).decode()
        cookie = f"Cookie: {browser.cookie}\r\n" if browser.cookie else ""
        self.socket.sendall((f"GET /live HTTP/1.1\r\nHost: 127.0.0.1:{browser.station.port}\r\nOrigin: {browser.station.origin}\r\n"
                             f"Connection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Key: {key}\r\n"
                             f"Sec-WebSocket-Protocol: fieldcast.1\r\n{cookie}\r\n").encode())
        self.received = b""
        head = b""
        while b"\r\n\r\n" not in head:
            head += self.exactly(1)
        self.status = int(head.split()[1])

    def exactly(self, count):
        while len(self.received) < count:
            piece = self.socket.recv(65536)
            if not piece:
                raise EOFError
            self.received += piece
        bytes, self.received = self.received[:count], self.received[count:]
        return bytes

    def send(self, message):
        text = json.dumps(message).encode()
        assert len(text) < 65536
        size = struct.pack("!B", 0x80 | len(text)) if len(text) < 126 else struct.pack("!BH", 0x80 | 126, len(text))
        self.socket.sendall(b"\x81" + size + bytes(4) + text)

    def next(self):
        while True:
            opcode, size = self.exactly(2)
            if size > 125:
                size = int.from_bytes(self.exactly(2 if size == 126 else 8), "big")
            payload = self.exactly(size)
            if opcode == 0x81:
                return json.loads(payload)
            if opcode == 0x82:
                kind, count, base = payload[0], *struct.unpack_from("<Id", payload, 4)
                assert kind == 1
                values = struct.unpack_from(f"<{count}d", payload, 16)
                ids = struct.unpack_from(f"<{count}I", payload, 16 + 8 * count)
                qualities = payload[16 + 16 * count:16 + 17 * count]
                return list(zip(ids, values, qualities))
            if opcode == 0x88:
                raise EOFError

    def until(self, condition):
        for _ in range(10_000):
            message = self.next()
            if condition(message):
                return message
        raise AssertionError("it never came")


def is_kind(kind):
    return lambda message: isinstance(message, dict) and message["kind"] == kind


class Stations(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.plant = Plant(BIN_DIR, CONFIG)
        cls.plant.__enter__()
        cls.addClassCleanup(lambda: cls.plant.__exit__(None, None, None))

    def live(self, browser):
        live = Socket(browser)
        self.addCleanup(live.socket.close)
        return live

    def fieldcast(self, *arguments):
        result = subprocess.run([os.path.join(BIN_DIR, "fieldcast"), *arguments], capture_output=True, text=True, timeout=SECONDS)
        self.assertEqual(result.returncode, 0, result.stderr)
        return result.stdout

    def add_user(self, store, name, role, password="correct-horse"):
        result = subprocess.run([os.path.join(BIN_DIR, "fieldcast"), "user", "add", name, "--role", role, "--store", store],
                                input=password + "\n", capture_output=True, text=True, timeout=SECONDS)
        self.assertEqual(result.returncode, 0, result.stderr)

    def test_values_and_a_write_go_through_without_a_store(self):
        with Station(self.plant, "open", "web: { local-role: operator }\n", "--listen", "127.0.0.1:0") as station:
            browser = Browser(station)
            self.assertEqual(browser.get("/api/me")["login"], "none")
            live = self.live(browser)
            self.assertEqual(live.status, 101)
            self.assertEqual(live.next()["kind"], "hello")
            live.send({"subscribe": "*"})
            ids = wait_until(lambda: {row[1]: row[0] for row in browser.get("/api/catalogue")["channels"]}, SECONDS, "no channel came")
            self.assertEqual(set(ids), {"line/press/temperature", "line/press/speed"})
            live.until(lambda message: isinstance(message, list) and any(quality == 0 for _, _, quality in message))
            live.send({"write": {"channel": "line/press/speed", "value": 123, "verify": True}, "id": 7})
            result = live.until(is_kind("result"))
            self.assertEqual((result["id"], result["state"]), (7, "verified"), result)
            live.until(lambda message: isinstance(message, list) and (ids["line/press/speed"], 123.0, 0) in message)

    def test_users_log_in_and_lose_what_they_lose(self):
        store = os.path.join(self.plant.run, "users.db")
        with Station(self.plant, "users", f"store: {{ path: {store} }}\n", "--listen", "127.0.0.1:0") as station:
            guest = Browser(station)
            wait_until(lambda: guest.get("/api/me")["login"] == "none", SECONDS, "without users nobody has to log in")
            before = self.live(guest)
            self.assertEqual(before.status, 101)
            self.add_user(store, "anna", "viewer")
            with self.assertRaises(EOFError):  # with users, a login is required
                before.until(lambda message: False)
            self.assertEqual(guest.get("/api/me")["login"], "required")
            self.assertEqual(guest.ask("GET", "/api/buses")[0], 401)
            self.assertEqual(self.live(guest).status, 401)
            anna = Browser(station)
            self.assertEqual(anna.log_in("anna", "wrong-password"), 401)
            self.assertEqual(anna.log_in("anna", "correct-horse"), 200)
            self.assertEqual(anna.get("/api/me")["user"], "anna")
            live = self.live(anna)
            self.assertEqual(live.next()["role"], "viewer")
            live.send({"write": {"channel": "line/press/speed", "value": 1, "verify": False}, "id": 1})
            self.assertEqual(live.until(is_kind("refused"))["id"], 1)
            self.assertEqual(guest.ask("POST", "/api/logout")[0], 401)
            self.assertEqual(anna.ask("POST", "/api/logout", Origin="http://evil.example")[0], 403)
            self.assertEqual(anna.ask("GET", "/api/me", Host="evil.example")[0], 421)
            self.fieldcast("user", "remove", "anna", "--store", store)
            with self.assertRaises(EOFError):
                live.until(lambda message: False)
            self.assertNotIn("correct-horse", station.log())

    def test_with_tls_it_is_all_the_same(self):
        run = self.plant.run
        certificate, key = os.path.join(run, "cert.pem"), os.path.join(run, "key.pem")
        subprocess.run(["openssl", "req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:prime256v1", "-nodes", "-days", "2",
                        "-subj", "/CN=station", "-addext", "subjectAltName=IP:127.0.0.1", "-keyout", key, "-out", certificate],
                       check=True, capture_output=True)
        store = os.path.join(run, "tls.db")
        text = f"store: {{ path: {store} }}\nweb: {{ certificate: {certificate}, key: {key}, local-role: none }}\n"
        with Station(self.plant, "tls", text, "--listen", "127.0.0.1:0") as station:
            self.assertTrue(station.secure)
            self.fieldcast("health", station.origin + "/healthz")
            bert = Browser(station)
            self.assertEqual(bert.log_in("bert", "correct-horse"), 401)
            self.add_user(store, "bert", "operator")
            self.assertEqual(wait_until(lambda: bert.log_in("bert", "correct-horse") == 200, SECONDS, "bert cannot log in"), True)
            self.assertTrue(bert.cookie.startswith("__Host-fieldcast="))
            live = self.live(bert)
            self.assertEqual(live.next()["user"], "bert")
            wall = Browser(station)
            self.assertEqual(wall.ask("POST", "/api/login", {"token": "x" * 43})[0], 401)
            token = self.fieldcast("token", "add", "wall", "--days", "1", "--store", store).split()[-1]
            self.assertEqual(wall.ask("POST", "/api/login", {"token": token})[0], 200)
            self.assertEqual((wall.get("/api/me")["login"], wall.get("/api/me")["role"]), ("token", "viewer"))
            screen = self.live(wall)
            self.assertEqual(screen.next()["user"], "wall")
            self.fieldcast("token", "remove", "wall", "--store", store)
            with self.assertRaises(EOFError):
                screen.until(lambda message: False)
            self.assertNotIn(token, station.log())
            station.process.send_signal(signal.SIGHUP)
            wait_until(lambda: "read from their files again" in station.log(), SECONDS, station.log)
            self.assertEqual(bert.get("/api/me")["role"], "operator")

    def test_faults_of_the_configuration_are_reported_with_their_place(self):
        for text, expected in [("web: { listen: 0.0.0.0:8090 }\n", "station.yaml:1:16: the page off the loopback without TLS"),
                               ("web:\n  lsten: 127.0.0.1:8090\n", "did you mean listen"),
                               ("web: { certificate: nothing.pem, key: nothing.pem }\n", "station.yaml:1:21:")]:
            path = os.path.join(self.plant.run, "station.yaml")
            with open(path, "w", encoding="utf-8") as file:
                file.write(text)
            result = subprocess.run([os.path.join(BIN_DIR, "fieldcast-station"), "--config", path], capture_output=True, text=True,
                                    timeout=SECONDS)
            self.assertEqual(result.returncode, 3, result.stderr)
            self.assertIn(expected, result.stderr)
        result = subprocess.run([os.path.join(BIN_DIR, "fieldcast-station"), "--listen", "0.0.0.0:0"], capture_output=True, text=True,
                                timeout=SECONDS)
        self.assertEqual(result.returncode, 3, result.stderr)
        self.assertIn("without TLS", result.stderr)

    def test_an_address_that_is_taken_is_an_error_in_words(self):
        with socket.socket() as taken:
            taken.bind(("127.0.0.1", 0))
            taken.listen()
            result = subprocess.run([os.path.join(BIN_DIR, "fieldcast-station"), "--domain", str(self.plant.domain), "--listen",
                                     f"127.0.0.1:{taken.getsockname()[1]}"], capture_output=True, text=True, timeout=SECONDS)
        self.assertEqual(result.returncode, 4, result.stderr)
        self.assertIn("Address already in use", result.stderr)


if __name__ == "__main__":
    BIN_DIR = sys.argv[1]
    unittest.main(argv=sys.argv[:1], verbosity=2)
