"""Plain MQTT (mosquitto), with mosquitto_sub as the consumer.

mosquitto passes a message to the present subscribers only. The forwarder therefore reaches it by socat, which starts after the consumer
has connected again.
"""

import json
import os
import shutil
import signal
import subprocess

import mosquitto
import outlets
from nats import free_port
from plant import wait_until

PASSWORD = "password"


class Engine:
    name = "mqtt"
    has_unique_samples = False  # QoS 1: at least once
    TOPICS = ("fieldcast/#", "fieldcast-late/#")

    @staticmethod
    def reason_to_skip():
        return mosquitto.reason_to_skip() or (None if shutil.which("socat") else "no socat here; tools/install.sh test installs it")

    def __init__(self, folder, port):
        self.folder, self.port = folder, port
        self.broker = mosquitto.Broker(folder, free_port(), users={"north": outlets.RIGHT_PASSWORD, "reader": "reader"})
        self.server = self.broker  # for tools/bench/forward_bench.py
        self.consumer = self.gate = None

    def start(self):
        before = self._connections()
        self.broker.start()
        if self.consumer is None:
            self.consumer = mosquitto.Consumer(self.broker, self.TOPICS, ("-u", "reader", "-P", "reader"))
        wait_until(lambda: self._connections() > before, 20, self.log)
        self.gate = subprocess.Popen(["socat", f"TCP-LISTEN:{self.port},bind=127.0.0.1,reuseaddr,fork", f"TCP:127.0.0.1:{self.broker.port}"],
                                     stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, stdin=subprocess.DEVNULL, start_new_session=True)

    def _connections(self):
        """How often the consumer has subscribed."""
        if not os.path.exists(self.broker.log_file):
            return 0
        with open(self.broker.log_file, encoding="utf-8", errors="replace") as file:
            return file.read().count("Sending SUBACK to consumer")

    def stop(self):
        if self.gate is not None:
            os.killpg(self.gate.pid, signal.SIGKILL)
            self.gate.wait()
            self.gate = None
        self.broker.kill()

    def close(self):
        if self.consumer is not None:
            self.consumer.stop()
        self.stop()

    def pause(self):
        self.broker.pause()

    def resume(self):
        self.broker.resume()

    def section(self, login="right"):
        outlets.secret_file(self.folder, outlets.RIGHT_PASSWORD if login == "right" else outlets.WRONG_PASSWORD, PASSWORD)
        return f"""{self.name}:
  servers: [mqtt://127.0.0.1:{self.port}]
  user: north
  password-file: {PASSWORD}
  acknowledgement: 1s
"""

    def correct_login(self):
        outlets.secret_file(self.folder, outlets.RIGHT_PASSWORD, PASSWORD)

    def samples(self):
        if self.consumer is None:
            return []
        found = []
        for message in self.consumer.received():
            levels = message.topic.split("/")
            sample = json.loads(message.payload)
            found.append(("/".join(levels[2:]), sample["epoch"], sample["sequence"], sample["value"], sample["quality"]))
        return found

    def log(self):
        return self.broker.log()

    def refuse_one(self):
        """The catalogues are larger than this limit of the server."""
        self.stop()
        self.broker.set_limit(400)
        self.start()
        return "limits the size of a packet"
