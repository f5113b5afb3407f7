"""Tests requests that a proxy and a station could read differently, or that are too long, malformed or from another site. Each is refused,
the connection is closed if the end of the request is uncertain, and a second request hidden in a body is never served.

usage: http_requests.py BIN_DIR
"""

import sys

from hostile_station import HostileStation

HIDDEN = "GET /api/openapi.yaml HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n"
CLOSED, OPEN = True, False


def rows(trial):
    """Returns rows of (description, bytes, status of the refusal, True if the connection is closed)."""
    def post(more, body=""):
        return trial.head("POST /api/login", "Content-Type: application/json\r\n" + more, origin=True) + body

    chunks = "0\r\n\r\n"
    get = trial.head()
    for coding in ("gzip", "identity", "gzip, chunked", "chunked, chunked", "chunked;q=1", "xchunked"):
        yield f"Transfer-Encoding: {coding}", post(f"Transfer-Encoding: {coding}\r\n", chunks + HIDDEN), 501, CLOSED
    for name, more in {
            "two equal lengths": "Content-Length: 1\r\nContent-Length: 1\r\n",
            "two lengths": "Content-Length: 1\r\nContent-Length: 60\r\n",
            "a list of lengths": "Content-Length: 1, 1\r\n",
            "a signed length": "Content-Length: +1\r\n",
            "a negative length": "Content-Length: -1\r\n",
            "a hexadecimal length": "Content-Length: 0x1\r\n",
            "a length of 30 digits": f"Content-Length: {'9' * 30}\r\n",
            "chunks and a length": "Transfer-Encoding: chunked\r\nContent-Length: 5\r\n",
            "a length and chunks": "Content-Length: 5\r\nTransfer-Encoding: chunked\r\n",
            "chunks twice": "Transfer-Encoding: chunked\r\nTransfer-Encoding: chunked\r\n",
            "a space before the colon": "Transfer-Encoding : chunked\r\n",
    }.items():
        yield name, post(more, chunks + HIDDEN), 400, CLOSED
    yield "a chunk size that is not a number", post("Transfer-Encoding: chunked\r\n", "zz\r\n" + HIDDEN), 400, CLOSED
    yield "a chunk size of 17 digits", post("Transfer-Encoding: chunked\r\n", "1" + "0" * 16 + "\r\n" + HIDDEN), 400, CLOSED
    yield "a header field behind the chunks", post("Transfer-Encoding: chunked\r\n", "0\r\nCookie: fieldcast=1\r\n\r\n" + HIDDEN), 400, CLOSED
    yield "chunks of HTTP/1.0", post("Transfer-Encoding: chunked\r\n", chunks).replace("HTTP/1.1", "HTTP/1.0"), 400, CLOSED
    for name, line in {"a folded line": "A: b\r\n c: d\r\n", "a line that begins with a space": " A: b\r\n", "no colon": "A\r\n",
                       "no name": ": b\r\n", "a line end without CR": "A: b\n", "a CR inside a line": "A: b\rC: d\r\n",
                       "a NUL": "A: b\0c\r\n", "two hosts": "Host: evil.example\r\n"}.items():
        yield name, trial.head(more=line), 400, OPEN if name == "two hosts" else CLOSED
    yield "no host", "GET /healthz HTTP/1.1\r\n\r\n", 400, OPEN
    yield "the name of another host", get.replace("127.0.0.1", "evil.example"), 421, OPEN
    yield "a version that does not exist", get.replace("HTTP/1.1", "HTTP/9.9"), 400, CLOSED
    yield "no HTTP", "\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03", 400, CLOSED
    yield "a header of 9 000 bytes", trial.head(more=f"A: {'a' * 9000}\r\n"), 431, CLOSED
    yield "a path of 20 000 bytes", trial.head(f"GET /{'a' * 20_000}"), 431, CLOSED
    yield "a body of 65 537 bytes", post("Content-Length: 65537\r\n"), 413, CLOSED
    yield "a body that is not JSON", trial.head("POST /api/login", "Content-Length: 2\r\n", origin=True) + "{}", 415, OPEN
    yield "a request of another site", post("Content-Length: 2\r\n", "{}").replace("Origin: http", "Origin: https"), 403, OPEN
    yield "a method that does not exist", trial.head("TRACE /healthz"), 405, OPEN
    yield "a method in small letters", trial.head("get /healthz"), 405, OPEN
    yield "a path that does not exist", trial.head("GET /../../etc/passwd"), 404, OPEN


def response(trial, bytes):
    """Returns all data until the connection is closed or silent, and True if it was closed."""
    with trial.connect(seconds=2) as connection:
        received = b""
        try:
            connection.sendall(bytes.encode("latin-1"))
            while piece := connection.recv(65536):
                received += piece
                # One response with its body: a station that keeps the connection sends no more.
                head, end, body = received.partition(b"\r\n\r\n")
                if end and b"connection: keep-alive" in head and f"content-length: {len(body)}".encode() in head:
                    return received, False
        except TimeoutError:
            return received, False
        except ConnectionResetError:
            pass
    return received, True


def run(bin_dir):
    faults, count = [], 0
    with HostileStation(bin_dir) as trial:
        before = trial.memory_mb()
        for name, bytes, status, closed in rows(trial):
            count += 1
            received, was_closed = response(trial, bytes)
            found = received.split(b" ", 2)[1].decode() if received.startswith(b"HTTP/1.1 ") else repr(received[:40])
            if found != str(status) or received.count(b"HTTP/1.1 ") != 1:
                faults.append(f"{name}: expected one response with status {status}, got {received.count(b'HTTP/1.1 ')}, the first with {found}")
            if was_closed != closed:
                faults.append(f"{name}: the connection was {'closed' if was_closed else 'kept open'}")
        for request, status in (("GET /healthz", "200"), ("HEAD /healthz", "200"), ("OPTIONS /healthz", "204")):
            received, _ = response(trial, trial.head(request, "Connection: close\r\n"))
            if not received.startswith(f"HTTP/1.1 {status} ".encode()):
                faults.append(f"{request} afterwards: {received[:40]!r}")
        print(f"{count} hostile requests; station {before:.0f} MB before, {trial.memory_mb():.0f} MB after", flush=True)
    return faults


if __name__ == "__main__":
    found = run(sys.argv[1])
    for fault in found:
        print("HARM:", fault)
    sys.exit(1 if found else 0)
