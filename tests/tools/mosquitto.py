"""An MQTT server (mosquitto) and a consumer (mosquitto_sub) for tests, both on 127.0.0.1 only."""

import os
import shutil
import signal
import socket
import subprocess

from plant import Failure, wait_until

SECONDS = 20
PATH = os.environ.get("PATH", "") + ":/usr/sbin"
PROGRAMS = {name: shutil.which(name, path=PATH) for name in ("mosquitto", "mosquitto_sub", "mosquitto_pub", "mosquitto_passwd")}


def reason_to_skip():
    missing = [name for name, path in PROGRAMS.items() if path is None]
    return f"no {', '.join(missing)} here; tools/install.sh test installs mosquitto and mosquitto-clients" if missing else None


class Broker:
    """`listener`: lines of the listener, for example for TLS; `more`: lines before it."""

    def __init__(self, folder, port, more="", listener="", users=None):
        """`users`: {name: password}; without it, no login is needed."""
        self.folder, self.port, self.process = folder, port, None
        self.log_file = os.path.join(folder, "mosquitto.log")
        self.passwords = os.path.join(folder, "passwords")
        access = "allow_anonymous true"
        if users is not None:
            access = f"allow_anonymous false\npassword_file {self.passwords}"
            with open(self.passwords, "w", encoding="utf-8") as file:
                file.writelines(f"{name}:{password}\n" for name, password in users.items())
            subprocess.run([PROGRAMS["mosquitto_passwd"], "-U", self.passwords], check=True)
        self.config = os.path.join(folder, "mosquitto.conf")
        # Started as root, mosquitto would change to another user, which cannot write to the folder.
        self.text = (f"user root\npersistence false\nmax_queued_messages 0\nmax_inflight_messages 0\nlog_dest stderr\nlog_type all\n{more}\n"
                     f"listener {port} 127.0.0.1\n{access}\n{listener}\n")
        self.set_limit(None)

    def set_limit(self, size):
        """Bytes of a packet, from the next start on."""
        with open(self.config, "w", encoding="utf-8") as file:
            file.write((f"max_packet_size {size}\n" if size else "") + self.text)

    def start(self):
        with open(self.log_file, "a", encoding="utf-8") as log:
            self.process = subprocess.Popen([PROGRAMS["mosquitto"], "-c", self.config], stdout=log, stderr=log, stdin=subprocess.DEVNULL)
        wait_until(self._listens, SECONDS, self.log)
        return self

    def _listens(self):
        if self.process.poll() is not None:
            raise Failure(f"mosquitto ended with {self.process.returncode}\n{self.log()}")
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

    def pause(self):
        self.process.send_signal(signal.SIGSTOP)

    def resume(self):
        self.process.send_signal(signal.SIGCONT)

    def log(self):
        if not os.path.exists(self.log_file):
            return ""
        with open(self.log_file, encoding="utf-8", errors="replace") as file:
            return "--- mosquitto:\n" + "".join(file.readlines()[-100:])

    def publish(self, topic, payload=b"", *options):
        subprocess.run([PROGRAMS["mosquitto_pub"], "-p", str(self.port), "-h", "127.0.0.1", "-t", topic, "-s", *options], input=payload, check=True,
                       timeout=SECONDS)


class Message:
    def __init__(self, line):
        self.topic, self.qos, self.retained, payload = line.rsplit("|", 3)
        self.payload = bytes.fromhex(payload)


class Consumer:
    """mosquitto_sub, with all messages that it has received."""

    def __init__(self, broker, topics=("#",), options=(), name="consumer"):
        self.path = os.path.join(broker.folder, name + ".txt")
        self.messages, self._read = [], 0
        with open(self.path, "w", encoding="utf-8") as file:
            self.process = subprocess.Popen([PROGRAMS["mosquitto_sub"], "-h", "127.0.0.1", "-p", str(broker.port), "-i", name, "-q", "1",
                                             "-k", "5", "-F", "%t|%q|%r|%x", *options, *(part for topic in topics for part in ("-t", topic))],
                                            stdout=file, stderr=subprocess.DEVNULL, stdin=subprocess.DEVNULL)

    def received(self):
        with open(self.path, "rb") as file:
            file.seek(self._read)
            text = file.read()
        complete = text[:text.rfind(b"\n") + 1]
        self._read += len(complete)
        self.messages += [Message(line) for line in complete.decode().splitlines()]
        return self.messages

    def stop(self):
        if self.process.poll() is None:
            self.process.terminate()
        self.process.wait()
