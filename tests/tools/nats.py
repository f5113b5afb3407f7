"""A NATS server for tests, and a consumer that speaks the text protocol of NATS over a socket. Both use
127.0.0.1 only.

https://docs.nats.io/reference/reference-protocols/nats-protocol, .../nats_api_reference
"""

import base64
import contextlib
import json
import os
import shutil
import signal
import socket
import subprocess
import time

from plant import Failure, wait_until

SECONDS = 20
PROGRAM = shutil.which("nats-server", path=os.environ.get("PATH", "") + ":/usr/sbin")


_next_port = 20000 + os.getpid() * 7 % 10000


def free_port():
    """Returns a port that this process has not got before. It is below the ports that the kernel assigns to connections, so that a killed
    server gets its port again."""
    global _next_port
    while True:
        _next_port = 20000 + (_next_port - 20000 + 1) % 10000
        with contextlib.suppress(OSError), socket.socket() as one:
            one.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            one.bind(("127.0.0.1", _next_port))
            return _next_port


class NatsServer:
    """`folder` keeps the streams over a restart. `more`: further lines of its configuration."""

    def __init__(self, folder, more="", program=PROGRAM, port=None):
        self.port = port or free_port()
        self.folder, self.process, self.program = folder, None, program
        self.config = os.path.join(folder, "nats.conf")
        with open(self.config, "w", encoding="utf-8") as file:
            file.write(f'listen: "127.0.0.1:{self.port}"\njetstream {{ store_dir: "{folder}/jetstream" }}\n{more}\n')

    def start(self):
        with open(os.path.join(self.folder, "nats.log"), "a", encoding="utf-8") as log:
            self.process = subprocess.Popen([self.program, "-c", self.config], stdout=log, stderr=log, stdin=subprocess.DEVNULL,
                                            start_new_session=True)
        wait_until(self._listens, SECONDS, self.log)
        return self

    def _listens(self):
        if self.process.poll() is not None:
            raise Failure(f"nats-server ended with {self.process.returncode}\n{self.log()}")
        try:
            socket.create_connection(("127.0.0.1", self.port), 1).close()
            return True
        except OSError:
            return False

    def kill(self):
        if self.process is not None and self.process.poll() is None:
            self.process.send_signal(signal.SIGKILL)
        if self.process is not None:
            self.process.wait()

    def log(self):
        with open(os.path.join(self.folder, "nats.log"), encoding="utf-8") as file:
            return "--- nats-server:\n" + "".join(file.readlines()[-20:])


def cluster(folder, size, program=PROGRAM):
    """Servers of one cluster, each with its own folder; not started. Clients use only the addresses of their configuration."""
    ports = [free_port() for _ in range(size)]
    routes = ", ".join(f'"nats-route://127.0.0.1:{port}"' for port in ports)
    servers = []
    for number, port in enumerate(ports):
        path = os.path.join(folder, f"node-{number}")
        os.mkdir(path)
        servers.append(NatsServer(path, f"""server_name: node-{number}
cluster {{ name: test, listen: "127.0.0.1:{port}", no_advertise: true, routes: [{routes}] }}""", program))
    return servers


def make_certificates(folder):
    """Makes ca, foreign (authorities), server, client, and other (a server with another name), each as NAME.pem and NAME.key."""
    def openssl(*arguments):
        subprocess.run(["openssl", *arguments], check=True, capture_output=True, cwd=folder)
    for name in ("ca", "foreign"):
        openssl("req", "-x509", "-newkey", "rsa:2048", "-nodes", "-days", "2", "-subj", f"/CN={name}", "-keyout", f"{name}.key", "-out", f"{name}.pem")
    for name, subject in (("server", "IP:127.0.0.1"), ("client", "DNS:client"), ("other", "DNS:other.example")):
        openssl("req", "-newkey", "rsa:2048", "-nodes", "-subj", f"/CN={name}", "-keyout", f"{name}.key", "-out", f"{name}.csr")
        with open(os.path.join(folder, "names"), "w", encoding="utf-8") as file:
            file.write(f"subjectAltName={subject}\n")
        openssl("x509", "-req", "-in", f"{name}.csr", "-CA", "ca.pem", "-CAkey", "ca.key", "-CAcreateserial", "-days", "2",
                "-extfile", "names", "-out", f"{name}.pem")
    os.chmod(os.path.join(folder, "client.key"), 0o600)


def tls_lines(folder, name):
    """Lines for NatsServer: TLS with this certificate of make_certificates(), for clients with a certificate of its authority."""
    return f'tls {{ cert_file: "{folder}/{name}.pem", key_file: "{folder}/{name}.key", ca_file: "{folder}/ca.pem", verify: true }}\n'


class Message:
    def __init__(self, subject, reply, headers, data):
        self.subject, self.reply, self.headers, self.data = subject, reply, headers, data


class NatsClient:
    """One connection. The caller receives one message after the other."""

    def __init__(self, port, seconds=SECONDS, tls=None):
        """`tls`: an ssl.SSLContext."""
        self.socket = socket.create_connection(("127.0.0.1", port), seconds)
        self.file = self.socket.makefile("rb", 0 if tls else -1)
        self._line()  # INFO
        if tls:
            self.socket = tls.wrap_socket(self.socket)
            self.file = self.socket.makefile("rb")
        self.send(b'CONNECT {"verbose":false,"pedantic":false,"headers":true,"no_responders":true,"lang":"python","version":"1"}\r\n')
        self.subscriptions = 0

    def close(self):
        self.file.close()
        self.socket.close()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def send(self, data):
        self.socket.sendall(data)

    def _line(self):
        line = self.file.readline()
        if not line.endswith(b"\r\n"):
            raise Failure("the NATS server closed the connection")
        return line[:-2].decode()

    def subscribe(self, subject):
        self.subscriptions += 1
        self.send(f"SUB {subject} {self.subscriptions}\r\n".encode())

    def publish(self, subject, data=b"", reply=""):
        self.send(f"PUB {subject} {reply} {len(data)}\r\n".encode() + data + b"\r\n")

    def receive(self):
        while True:
            line = self._line()
            words = line.split(" ")
            if words[0] == "PING":
                self.send(b"PONG\r\n")
            elif words[0] == "-ERR":
                raise Failure(line)
            elif words[0] in ("MSG", "HMSG"):
                sizes = 1 if words[0] == "MSG" else 2
                reply = words[3] if len(words) == 4 + sizes else ""
                total = int(words[-1])
                body = self.file.read(total + 2)[:-2]
                head = int(words[-2]) if sizes == 2 else 0
                return Message(words[1], reply, headers_of(body[:head]), body[head:])

    def request(self, subject, value=None):
        """Returns the JSON response; a fault of the server is a Failure."""
        inbox = f"_INBOX.{os.getpid()}.{time.monotonic_ns()}"
        self.subscribe(inbox)
        self.publish(subject, b"" if value is None else json.dumps(value).encode(), inbox)
        response = json.loads(self.receive().data or b'{"error":"nothing serves this subject"}')
        if "error" in response:
            raise Failure(f"{subject}: {response['error']}")
        return response

    def stored(self, stream):
        """All messages of a stream, in its order, by a consumer of its own."""
        inbox = f"_INBOX.{os.getpid()}.{time.monotonic_ns()}"
        made = self.request(f"$JS.API.CONSUMER.CREATE.{stream}", {"stream_name": stream, "config": {
            "deliver_subject": inbox, "deliver_policy": "all", "ack_policy": "none", "replay_policy": "instant"}})
        self.subscribe(inbox)  # the consumer delivers from now on
        return [self.receive() for _ in range(made["num_pending"])]

    def pages(self, stream, size=500):
        """Yields the messages of a stream in its order, `size` at a time: for streams that do not fit in the server's buffer of a client."""
        # By default the server removes a consumer that asks for nothing for 5 s, as one on a busy machine may.
        made = self.request(f"$JS.API.CONSUMER.CREATE.{stream}", {"stream_name": stream, "config": {
            "deliver_policy": "all", "ack_policy": "none", "replay_policy": "instant", "inactive_threshold": 600_000_000_000}})
        inbox = f"_INBOX.{os.getpid()}.{time.monotonic_ns()}"
        self.subscribe(inbox)
        left = made["num_pending"]
        while left > 0:
            count = min(left, size)
            self.publish(f"$JS.API.CONSUMER.MSG.NEXT.{stream}.{made['name']}", json.dumps({"batch": count}).encode(), inbox)
            for _ in range(count):
                message = self.receive()
                if not message.reply:
                    raise Failure(f"{stream}: the server sent a status instead of a message: {message.headers}")
                yield message
            left -= count

    def last(self, stream, subject):
        """The data of the last message of a subject."""
        found = self.request(f"$JS.API.STREAM.MSG.GET.{stream}", {"last_by_subj": subject})
        return base64.b64decode(found["message"]["data"])


def headers_of(text):
    lines = text.decode().split("\r\n")[1:]
    return dict(line.split(": ", 1) if ": " in line else line.split(":", 1) for line in lines if ":" in line)
