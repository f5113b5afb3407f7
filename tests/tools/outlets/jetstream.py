"""NATS JetStream (nats-server), with a consumer that speaks the text protocol of NATS."""

import json
import os
import signal

import nats
import outlets

PASSWORD = "password"


class Engine:
    name = "jetstream"
    has_unique_samples = False  # after a kill, a sample may be stored again in a message of another id

    @staticmethod
    def reason_to_skip():
        return None if Engine.program() else "no nats-server here; tools/install.sh test brings it"

    @staticmethod
    def program():
        return outlets.program("nats-server", "nats-server", "usr/sbin/nats-server")

    def __init__(self, folder, port):
        self.folder = folder
        self.server = nats.NatsServer(folder, f"""
authorization {{ users: [ {{ user: north, password: "{outlets.RIGHT_PASSWORD}" }}, {{ user: reader, password: reader }} ] }}
no_auth_user: reader""", self.program(), port)

    def start(self):
        self.server.start()

    def stop(self):
        self.server.kill()

    def pause(self):
        self.server.process.send_signal(signal.SIGSTOP)

    def resume(self):
        self.server.process.send_signal(signal.SIGCONT)

    def section(self, login="right"):
        outlets.secret_file(self.folder, outlets.RIGHT_PASSWORD if login == "right" else outlets.WRONG_PASSWORD, PASSWORD)
        return f"""jetstream:
  servers: [nats://127.0.0.1:{self.server.port}]
  user: north
  password-file: {PASSWORD}
  acknowledgement: 1s
  streams: {{ create: true }}
"""

    def correct_login(self):
        outlets.secret_file(self.folder, outlets.RIGHT_PASSWORD, PASSWORD)

    def samples(self):
        try:
            with nats.NatsClient(self.server.port, 3) as client:
                messages = client.stored("FIELDCAST")
        except AssertionError:
            return []  # the stream does not exist yet
        found = []
        for message in messages:
            batch = json.loads(message.data)
            found += [("/".join((batch["bus"], batch["device"], sample["channel"])), batch["epoch"], sample["sequence"], sample["value"],
                       sample["quality"]) for sample in batch["samples"]]
        return found

    def refuse_one(self):
        with nats.NatsClient(self.server.port) as client:
            client.request("$JS.API.STREAM.CREATE.FIELDCAST", {
                "name": "FIELDCAST", "subjects": ["fieldcast.>", "fieldcast-late.>"], "storage": "file", "max_msg_size": 400})
        return "exceeds max_msg_size"

    def log(self):
        return self.server.log() if os.path.exists(os.path.join(self.folder, "nats.log")) else ""
