"""Kafka: the mock cluster of librdkafka (kafka_mock.c), since Debian has no broker; the consumer is kcat.

The cluster is in memory, so a cut closes its connections but keeps the process. It has no login.
"""

import json
import os
import shutil
import signal
import subprocess

import outlets


class Engine:
    name = "kafka"
    has_unique_samples = False  # a message that is sent after a restart of the forwarder is stored again, with the same id
    has_login = False

    @staticmethod
    def reason_to_skip():
        return None if shutil.which("kcat") else "no kcat here; tools/install.sh test brings it"

    def __init__(self, folder, port):
        del port  # the mock cluster chooses one
        self.folder = folder
        self.process = subprocess.Popen([os.path.join(outlets.BIN_DIR, "kafka-mock")], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                                        stderr=subprocess.DEVNULL, text=True)
        self.address = self.process.stdout.readline().strip()
        self.port = int(self.address.rpartition(":")[2])
        self.command("down")

    @property
    def server(self):
        return self

    def command(self, word):
        self.process.stdin.write(word + "\n")
        self.process.stdin.flush()
        self.process.stdout.readline()

    def start(self):
        self.command("up")

    def stop(self):
        self.command("down")

    def close(self):
        self.process.stdin.close()
        self.process.stdout.close()
        self.process.kill()
        self.process.wait()

    def pause(self):
        self.process.send_signal(signal.SIGSTOP)

    def resume(self):
        self.process.send_signal(signal.SIGCONT)

    def section(self, login="right"):
        del login
        return f"kafka:\n  servers: [kafka://{self.address}]\n  acknowledgement: 2s\n"

    def correct_login(self):
        raise NotImplementedError

    def samples(self):
        found = []
        for topic in ("fieldcast", "fieldcast-late"):
            done = subprocess.run(["kcat", "-C", "-b", self.address, "-t", topic, "-o", "beginning", "-e", "-q", "-f", "%h\t%s\n"],
                                  capture_output=True, text=True, timeout=30)
            for line in done.stdout.splitlines():
                headers, _, body = line.partition("\t")
                assert "id=" + outlets.SITE + "/line/" in headers, headers
                batch = json.loads(body)
                found += [("/".join((batch["bus"], batch["device"], sample["channel"])), batch["epoch"], sample["sequence"], sample["value"],
                           sample["quality"]) for sample in batch["samples"]]
        return found

    def refuse_one(self):
        self.command("refuse")
        return "Message size too large"
