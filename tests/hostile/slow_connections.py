"""Tests that 150 slow connections from one address do not block the station. Each kind is kept open, while a client at another
address and a logged-in user at the same address must get a response within a second.

usage: slow_connections.py BIN_DIR
"""

import ssl
import sys
import time

from hostile_station import HostileStation, Socket

COUNT = 150
ROUNDS = 5
MOST_SECONDS = 1.0
UPGRADE = ("Connection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n"
           "Sec-WebSocket-Protocol: fieldcast.1\r\n")


def kinds(trial):
    body = "Content-Type: application/json\r\nContent-Length: 60000\r\n"
    return {
        "no byte": b"",
        "half a header": b"GET /healthz HTTP/1.1\r\nHost: 127",
        "half a body": (trial.head("POST /api/login", body, origin=True) + "{").encode(),
        "a request and then no byte": trial.head().encode(),
        "a WebSocket that sends no byte": trial.head("GET /live", UPGRADE, origin=True).encode(),
        "requests whose responses are not read": trial.head("GET /api/openapi.yaml").encode() * 100,
    }


def secure(connection):
    context = ssl.create_default_context()
    context.check_hostname, context.verify_mode = False, ssl.CERT_NONE
    return context.wrap_socket(connection)


def request_from(trial, source):
    connection = trial.connect(source)
    if trial.tls:
        connection = secure(connection)
    with connection:
        connection.sendall(trial.head(more="Connection: close\r\n").encode())
        response = connection.recv(4096)
    assert response.startswith(b"HTTP/1.1 200 "), response[:100]


def ask_logged_in(anna):
    assert anna.get("/api/me")["user"] == "anna"
    live = Socket(anna)
    with live.socket:
        assert live.status == 101, live.status


def slowest(action):
    most = 0
    for _ in range(ROUNDS):
        began = time.monotonic()
        action()
        most = max(most, time.monotonic() - began)
    return most


def attack(trial, anna, name, bytes):
    slow = []
    try:
        for _ in range(COUNT):
            connection = trial.connect(receive_buffer=4096)
            slow.append(connection)
            try:
                connection.sendall(bytes)
            except OSError:  # the station has closed it already, as expected
                pass
        other = slowest(lambda: request_from(trial, "127.0.0.2"))
        logged_in = slowest(lambda: ask_logged_in(anna))
    finally:
        for connection in slow:
            connection.close()
    print(f"{name}: {COUNT} connections, {'TLS' if trial.tls else 'HTTP'}; another address {other * 1000:.0f} ms, "
          f"logged in {logged_in * 1000:.0f} ms, station {trial.memory_mb():.0f} MB", flush=True)
    return [f"{name}: {who} got its response after {seconds:.1f} s; at most {MOST_SECONDS:.0f} s"
            for who, seconds in (("another address", other), ("a logged-in user", logged_in)) if seconds > MOST_SECONDS]


def run(bin_dir, tls):
    faults = []
    with HostileStation(bin_dir, tls) as trial:
        anna = trial.log_in()
        chosen = {"no byte": b"", "half a TLS record": b"\x16\x03\x01\x02\x00\x01"} if tls else kinds(trial)
        for name, bytes in chosen.items():
            try:
                faults += attack(trial, anna, name, bytes)
            except (OSError, AssertionError, EOFError) as error:
                faults.append(f"{name}: no response: {error!r}")
    return faults


if __name__ == "__main__":
    found = run(sys.argv[1], False) + run(sys.argv[1], True)
    for fault in found:
        print("HARM:", fault)
    sys.exit(1 if found else 0)
