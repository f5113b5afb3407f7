"""Tests that samples which a forwarder missed are fetched from the common store of a standby group, although the bridge that published them
has died meanwhile: two bridges, PostgreSQL, a NATS server and fieldcast-forward.

usage: e2e_history_standby.py BIN_DIR SOURCE_DIR UNPACKED_DIR
"""

import contextlib
import json
import os
import shutil
import socket
import subprocess
import sys
import tempfile
import threading
import time
import unittest

import nats
import outlets
from e2e_standby import BIN_DIR, BRIDGE, SECONDS, serve_device
from forwarding import Forwarder
from outlets.postgresql import Engine
from plant import claim_domain, wait_until

DOWN = 4  # seconds
FETCHED = 60  # seconds
CONFIG = BRIDGE % ("domain: {domain}, interfaces: [127.0.0.1]", "127.0.0.1")
NATS_SERVER = ""


class HistoryStandby(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp(prefix="fieldcast-history-standby-")
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)
        self.engine = Engine(self.subfolder("database"), nats.free_port())
        self.addCleanup(self.engine.stop)
        self.engine.start()
        self.domain, claim = claim_domain()
        self.addCleanup(claim.close)
        device = socket.create_server(("127.0.0.1", 0))
        self.addCleanup(device.close)
        threading.Thread(target=self.serve, args=(device,), daemon=True).start()
        self.bridges = {}
        for name, strength in (("a", 2), ("b", 1)):
            with open(self.path(name, "yaml"), "w", encoding="utf-8") as file:
                file.write(CONFIG.format(name=name, strength=strength, domain=self.domain, port=device.getsockname()[1]))
                file.write(f'store: {{ url: "postgresql://north:{outlets.RIGHT_PASSWORD}@127.0.0.1:{self.engine.port}/fieldcast" }}\n')
            self.bridges[name] = self.bridge(name)
            wait_until(lambda name=name: "group g" in self.log(name), SECONDS, lambda name=name: self.log(name))
        self.server = nats.NatsServer(self.subfolder("nats"), "", NATS_SERVER).start()
        self.addCleanup(self.server.kill)
        self.forwarder = Forwarder(BIN_DIR, self.subfolder("forwarder"),
                                   f"site: north\ndds: {{ domain: {self.domain} }}\nqueue: {{ path: queue.db }}\ngather: {{ time: 200ms }}\n"
                                   f"payload: {{ format: json }}\njetstream: {{ servers: [nats://127.0.0.1:{self.server.port}], streams: {{ create: true }} }}\n")
        self.addCleanup(self.forwarder.stop)

    @staticmethod
    def serve(device):
        with contextlib.suppress(OSError):
            serve_device(device)

    def subfolder(self, name):
        path = os.path.join(self.folder, name)
        os.mkdir(path)
        os.chmod(self.folder, 0o711)
        return path

    def path(self, name, ending):
        return os.path.join(self.folder, f"{name}.{ending}")

    def bridge(self, name):
        with open(self.path(name, "log"), "a", encoding="utf-8") as log:
            process = subprocess.Popen([os.path.join(BIN_DIR, "fieldcast-bridge"), self.path(name, "yaml")], stdin=subprocess.DEVNULL,
                                       stdout=log, stderr=subprocess.STDOUT)
        self.addCleanup(process.wait)
        self.addCleanup(process.kill)
        return process

    def log(self, name):
        with open(self.path(name, "log"), encoding="utf-8") as file:
            return file.read()

    def sequences(self):
        """Of the stream, in its order. Each message once."""
        try:
            with nats.NatsClient(self.server.port, 3) as client:
                messages = client.stored("FIELDCAST")
        except (AssertionError, OSError):
            return []  # there is no stream yet
        once = {message.headers["Nats-Msg-Id"]: message for message in messages}
        return [sample["sequence"] for message in once.values() for sample in json.loads(message.data)["samples"]]

    def stored(self):
        return [int(line) for line in self.engine.psql("select sequence from samples order by published_at, sequence").stdout.split()]

    def missing(self):
        """Samples of the store, up to the last one in the stream, that are not in the stream."""
        found = set(self.sequences())
        return [number for number in self.stored() if min(found) < number < max(found) and number not in found]

    def master(self):
        """The last bridge whose log says so. On a busy machine both may be master for a moment."""
        said = {name: max(self.log(name).rfind("is master of group g"), self.log(name).rfind("has taken over in group g")) for name in "ab"}
        back = {name: self.log(name).rfind("stands by in group g") for name in "ab"}
        masters = [name for name in "ab" if said[name] > back[name]]
        return masters[0] if len(masters) == 1 else None

    def test_samples_of_a_bridge_that_has_died_are_fetched_from_its_successor(self):
        self.forwarder.start()
        wait_until(lambda: len(self.sequences()) > 20, SECONDS, self.forwarder.log)
        master = wait_until(self.master, SECONDS, lambda: self.log("a") + self.log("b"))
        self.forwarder.kill()
        last = max(self.sequences())
        time.sleep(DOWN)
        self.bridges[master].kill()
        self.bridges[master].wait()
        other = "b" if master == "a" else "a"
        wait_until(lambda: "has taken over in group g" in self.log(other), SECONDS, lambda: self.log(other))
        time.sleep(DOWN)
        self.forwarder.start()
        wait_until(lambda: max(self.sequences()) > last, SECONDS, self.forwarder.log)
        time.sleep(1)
        wait_until(lambda: not self.missing(), FETCHED, lambda: str(self.missing()[:20]) + self.forwarder.log())
        self.assertEqual(self.forwarder.stop(), 0, self.forwarder.log())
        self.assertIn("missing samples were fetched", self.forwarder.log())
        found = self.sequences()
        self.assertEqual(len(found), len(set(found)), "each once")
        fetched = [number for number in found if last < number < max(self.stored())]
        self.assertGreater(len(fetched), 2 * DOWN * 10, "samples of both bridges")


if __name__ == "__main__":
    NATS_SERVER = nats.PROGRAM or os.path.join(sys.argv[2], "nats-server", "usr", "sbin", "nats-server")
    reason = Engine.reason_to_skip() or (None if os.path.exists(NATS_SERVER) else "no nats-server here; tools/install.sh test brings it")
    if reason:
        print(reason)
        sys.exit(77)
    unittest.main(argv=sys.argv[:1] + sys.argv[3:], verbosity=2)
