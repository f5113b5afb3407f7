"""A fieldcast-station for a trial: no bridge, a store with the user anna, read access for everybody. Stopped on exit."""

import os
import shutil
import socket
import subprocess
import sys
import tempfile

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "tools"))
import e2e_station  # noqa: E402
from e2e_station import Socket  # noqa: E402,F401
from plant import claim_domain, wait_until  # noqa: E402

PASSWORD = "correct-horse"


class HostileStation:
    def __init__(self, bin_dir, tls=False):
        self.bin_dir, self.tls = bin_dir, tls
        e2e_station.BIN_DIR = bin_dir

    def __enter__(self):
        self.domain, self._claim = claim_domain()
        self.run = tempfile.mkdtemp(prefix="fieldcast-hostile-")
        store = os.path.join(self.run, "station.db")
        text = f"store: {{ path: {store} }}\nweb:\n  local-role: viewer\n"
        if self.tls:
            files = [os.path.join(self.run, name) for name in ("cert.pem", "key.pem")]
            subprocess.run(["openssl", "req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:prime256v1", "-nodes", "-days", "2",
                            "-subj", "/CN=station", "-addext", "subjectAltName=IP:127.0.0.1", "-keyout", files[1], "-out", files[0]],
                           check=True, capture_output=True)
            text += f"  certificate: {files[0]}\n  key: {files[1]}\n"
        self.station = e2e_station.Station(self, "hostile", text, "--listen", "127.0.0.1:0")
        self.station.__enter__()
        self.port = self.station.port
        subprocess.run([os.path.join(self.bin_dir, "fieldcast"), "user", "add", "anna", "--role", "operator", "--store", store],
                       input=PASSWORD + "\n", check=True, capture_output=True, text=True)
        return self

    def __exit__(self, kind, value, trace):
        self.station.__exit__(kind, value, trace)
        self._claim.close()
        shutil.rmtree(self.run, ignore_errors=True)

    def log_in(self):
        anna = e2e_station.Browser(self.station)
        wait_until(lambda: anna.log_in("anna", PASSWORD) == 200, 20, "anna cannot log in")
        return anna

    def head(self, request="GET /healthz", more="", origin=False):
        """Returns the header of a request without a body, with its empty line."""
        origin = f"Origin: {self.station.origin}\r\n" if origin else ""
        return f"{request} HTTP/1.1\r\nHost: 127.0.0.1:{self.port}\r\n{origin}{more}\r\n"

    def connect(self, source="127.0.0.1", seconds=5, receive_buffer=0):
        connection = socket.socket()
        connection.settimeout(seconds)
        if receive_buffer:
            connection.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, receive_buffer)
        connection.bind((source, 0))
        connection.connect(("127.0.0.1", self.port))
        return connection

    def memory_mb(self):
        with open(f"/proc/{self.station.process.pid}/status", encoding="ascii") as file:
            return next(int(line.split()[1]) for line in file if line.startswith("VmRSS")) / 1024
