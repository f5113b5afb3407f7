"""Tests fieldcast-forward with a real NATS server: a simulated plant, a bridge, the forwarder, and a
consumer of another kind. The server and the forwarder are killed while samples arrive.

usage: e2e_forward.py BIN_DIR SOURCE_DIR UNPACKED_DIR [CLASS ..]
"""

import collections
import contextlib
import errno
import json
import os
import re
import subprocess
import sys
import tempfile
import time
import unittest
import urllib.request

import forwarding
import nats
from forwarding import REJOIN, UNCOMMITTED
from plant import Failure, Plant, wait_until

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "campaign"))
from fault_shim import FaultShim  # noqa: E402

BIN_DIR = SOURCE_DIR = NATS_SERVER = ""
GATHER = 0.2  # seconds
# Late samples have an order of their own. On a busy machine a server may be away for more than the standard of 10 s.
IN_ORDER = "send: { late-after: 1h }"

CONFIG = """
bridge: e2e
buses:
  - name: line
    port: { serial: {run}/line, baud: 115200, format: 8N1 }
    protocol: modbus-rtu
    defaults: { refresh: 200ms }
    devices:
      - name: press.1
        address: 1
        channels:
          - { name: temperature, at: "holding:100", type: float32, unit: °C }
          - { name: setpoint, at: "holding:200", type: int16, access: read-write, limits: { high: 100 } }
          - { name: running, at: "coil:3", type: bool }
      - name: mill
        address: 2
        channels:
          - { name: level, at: "input-register:3", type: uint16 }
"""

plant = None


def setUpModule():
    global plant
    plant = unittest.enterModuleContext(Plant(BIN_DIR, CONFIG))


class NatsForwarder(forwarding.Forwarder):
    def __init__(self, folder, more, payload="format: json", replicas=1, dds=None):
        """`dds`: the section, if it is more than the domain."""
        super().__init__(BIN_DIR, folder,
                         f"site: north\ndds: {{ {dds or f'domain: {plant.domain}'} }}\nqueue: {{ path: queue.db }}\n"
                         f"gather: {{ time: {int(GATHER * 1000)}ms }}\npayload: {{ {payload} }}\njetstream:\n  acknowledgement: 1s\n"
                         f"  streams: {{ create: true, replicas: {replicas} }}\n{more}\n")


class ForwardCase(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="fieldcast-forward-")
        self.addCleanup(folder.cleanup)
        self.folder = folder.name

    def server(self, more=""):
        server = nats.NatsServer(self.folder, more, NATS_SERVER)
        self.addCleanup(server.kill)
        return server

    def forwarder(self, more, payload="format: json", replicas=1):
        forwarder = NatsForwarder(self.folder, more, payload, replicas)
        self.addCleanup(forwarder.stop)
        return forwarder

    def stored(self, server, stream="FIELDCAST"):
        with nats.NatsClient(server.port, 3) as client:
            return client.stored(stream)

    def wait_for_messages(self, server, forwarder, count=1):
        def found():
            try:
                return len(self.stored(server)) >= count
            except (AssertionError, OSError):
                return False  # the stream does not exist yet, or has no leader
        wait_until(found, 25, lambda: forwarder.log() + server.log())


def deduplicated(messages):
    """The decoded messages, the first of each id."""
    seen = {}
    for message in messages:
        seen.setdefault(message.headers["Nats-Msg-Id"], json.loads(message.data))
    return list(seen.values())


def by_channel(messages):
    """{(device, channel): [(epoch, sample)]} in the order of the stream."""
    found = collections.defaultdict(list)
    for message in messages:
        for sample in message["samples"]:
            found[message["device"], sample["channel"]].append((message["epoch"], sample))
    return found


class Kills(ForwardCase):
    def setUp(self):
        super().setUp()
        self.reference = forwarding.Reference(plant, self.folder)
        self.addCleanup(self.reference.stop)

    def test_every_sample_arrives_once_and_in_order(self):
        server = self.server()
        forwarder = self.forwarder(f"  servers: [nats://127.0.0.1:{server.port}]\n" + IN_ORDER)
        forwarder.start()
        time.sleep(1)  # samples are queued before there is a server
        server.start()
        self.wait_for_messages(server, forwarder)
        time.sleep(1)
        server.kill()
        time.sleep(1)
        server.start()
        time.sleep(1.5)
        killed = time.time()
        forwarder.kill()
        forwarder.start()
        restarted = time.time()
        time.sleep(2)
        server.kill()
        server.start()
        time.sleep(1.5)
        self.compare(forwarder, server, (killed - UNCOMMITTED, restarted + REJOIN))

    def test_of_a_cluster_each_node_may_be_killed(self):
        nodes = nats.cluster(self.folder, 3, NATS_SERVER)
        for node in nodes:
            self.addCleanup(node.kill)
            node.start()
        forwarder = self.forwarder("  servers: [" + ", ".join(f"nats://127.0.0.1:{node.port}" for node in nodes) + "]\n" + IN_ORDER, replicas=3)
        forwarder.start()
        self.wait_for_messages(nodes[0], forwarder)
        for node in nodes:
            node.kill()
            time.sleep(1.5)
            node.start()
            # The next one is killed when this one has joined again.
            count = len(self.stored_in_time(nodes[0], forwarder))
            wait_until(lambda: len(self.stored_in_time(nodes[0], forwarder)) > count, 20, lambda: forwarder.log())
        self.compare(forwarder, nodes[1], None)

    def stored_in_time(self, server, forwarder):
        """The stored messages, as soon as the stream has a leader."""
        found = []

        def has_leader():
            try:
                found[:] = self.stored(server)
                return True
            except (AssertionError, OSError):
                return False
        wait_until(has_leader, 20, lambda: forwarder.log() + server.log())
        return found

    def compare(self, forwarder, server, down):
        """Ends the forwarder and compares the stream with the reference. Samples may be missing that were acquired within `down`, when the
        forwarder did not run."""
        last = {channel: max(samples) for channel, samples in self.reference.samples().items()}

        def complete():
            found = by_channel(deduplicated(self.stored_in_time(server, forwarder)))
            return all(found[channel] and found[channel][-1][1]["sequence"] >= sequence for channel, sequence in last.items())
        wait_until(complete, 20, lambda: forwarder.log() + server.log())
        self.reference.stop()
        self.assertEqual(forwarder.stop(), 0, forwarder.log())
        reference, found = self.reference.samples(), by_channel(deduplicated(self.stored(server)))
        self.assertEqual(set(found), set(last))
        for channel, pairs in found.items():
            with self.subTest(channel=channel):
                self.compare_channel(reference[channel], last[channel], pairs, down)

    def compare_channel(self, reference, last, pairs, down):
        self.assertEqual(len({epoch for epoch, _ in pairs}), 1, "the bridge was not restarted")
        sequences = [sample["sequence"] for _, sample in pairs]
        self.assertEqual(sequences, sorted(set(sequences)), "in order, each once")
        self.assertGreater(len(sequences), 20)
        samples = {sample["sequence"]: sample for _, sample in pairs}
        for sequence, expected in reference.items():
            if sequence in samples:
                for key in ("value", "quality", "acquired_at"):
                    self.assertEqual(samples[sequence][key], expected[key])
            elif sequences[0] <= sequence <= last:
                self.assertIsNotNone(down, f"{expected} is missing")
                self.assertTrue(down[0] < expected["acquired_at"] / 1e9 < down[1], f"{expected} is missing; not received within {down}")
        gaps = sum(after != before + 1 for before, after in zip(sequences, sequences[1:]))
        # One gap before and one after the last value, which a restarted forwarder receives.
        self.assertLessEqual(gaps, 2 if down else 0)


class Disk(ForwardCase):
    """Faults of the disk, by a preloaded library. Late samples are in order among themselves."""

    def setUp(self):
        super().setUp()
        self.reference = forwarding.Reference(plant, self.folder)
        self.addCleanup(self.reference.stop)
        self.shim = FaultShim(os.path.join(BIN_DIR, "..", "lib", "libfault_shim.so"), self.folder, os.path.join(self.folder, "queue.db"))
        self.nats = self.server()
        self.fc = self.forwarder(f"  servers: [nats://127.0.0.1:{self.nats.port}]")
        self.fc.environment = self.shim.environment()

    def arrived(self):
        """{channel: {sequence}}; fails if a sample arrived twice or a subject is not in order."""
        messages = self.stored(self.nats)
        for prefix in ("fieldcast.", "fieldcast-late."):
            part = [message for message in messages if message.subject.startswith(prefix)]
            for channel, samples in by_channel(deduplicated(part)).items():
                numbers = [sample["sequence"] for _, sample in samples]
                self.assertEqual(numbers, sorted(set(numbers)), channel)
        found = by_channel(deduplicated(messages))
        numbers = {channel: [sample["sequence"] for _, sample in samples] for channel, samples in found.items()}
        for channel, each in numbers.items():
            self.assertEqual(len(each), len(set(each)), f"{channel} has a sample twice")
        return {channel: set(each) for channel, each in numbers.items()}

    def missing(self):
        """Samples that the reference has received and the stream does not have, after the first one of each channel; by time."""
        reference, found = self.reference.samples(), self.arrived()
        return sorted(sample["acquired_at"] / 1e9 for channel, samples in reference.items() for number, sample in samples.items()
                      if number > min(found[channel]) and number not in found[channel])

    def settle(self):
        """Ends the reference, and waits until everything that it has is in the stream."""
        self.reference.stop()
        last = {channel: max(samples) for channel, samples in self.reference.samples().items()}
        wait_until(lambda: all(max(self.arrived().get(channel, {0})) >= number for channel, number in last.items()), 30,
                   lambda: self.fc.log()[-4000:])
        self.assertEqual(self.fc.stop(), 0, self.fc.log()[-4000:])

    def test_on_a_full_disk_samples_wait_in_memory(self):
        self.nats.start()
        self.fc.start()
        self.wait_for_messages(self.nats, self.fc, 4)
        self.shim.error = errno.ENOSPC
        time.sleep(4)
        self.assertRegex(self.fc.log(), "error queue.*full.*wait in memory")
        self.shim.clear()
        self.settle()
        self.assertEqual(self.missing(), [])

    def test_killed_at_a_write_it_loses_only_what_was_not_stored(self):
        self.nats.start()
        self.fc.start()
        self.wait_for_messages(self.nats, self.fc, 4)
        down = []
        for how in (0, 1, 2):
            self.shim.kill_how, self.shim.kill_at = how, self.shim.operations + 7
            self.fc.process.wait(15)
            killed = time.time()
            self.shim.clear()
            self.fc.start()
            down.append((killed - UNCOMMITTED, time.time() + REJOIN))
            time.sleep(REJOIN)
        self.settle()
        self.assertEqual([at for at in self.missing() if not any(begin < at < end for begin, end in down)], [])

    def test_a_corrupt_end_of_the_log_loses_only_its_last_transactions(self):
        self.fc.start()
        time.sleep(6)  # without a server, the queue grows
        self.fc.kill()
        killed = time.time()
        log = os.path.join(self.folder, "queue.db-wal")
        with open(log, "r+b") as file:
            size = file.seek(0, os.SEEK_END)
            file.seek(size - 9000)
            file.write(os.urandom(6000))
            file.truncate()
        self.nats.start()
        self.fc.start()
        self.wait_for_messages(self.nats, self.fc, 2)
        time.sleep(REJOIN)
        self.settle()
        lost = [at for at in self.missing() if at < killed - UNCOMMITTED - 3]
        self.assertEqual(lost, [], "three seconds are more than 9000 bytes of the log")
        self.assertGreater(min(map(len, self.arrived().values())), 20)


class Bridge(ForwardCase):
    def test_a_killed_bridge_begins_an_epoch_and_nothing_is_repeated(self):
        server = self.server().start()
        forwarder = self.forwarder(f"  servers: [nats://127.0.0.1:{server.port}]")
        forwarder.start()
        self.wait_for_messages(server, forwarder, 4)
        plant.kill_bridge()

        def samples():
            return by_channel(deduplicated(self.stored(server)))["mill", "level"]

        def later():
            return len({epoch for epoch, _ in samples()}) == 2 and samples()[-1][1]["sequence"] > 10
        wait_until(later, 25, lambda: forwarder.log() + plant.log("fieldcast-bridge"))
        self.assertEqual(forwarder.stop(), 0, forwarder.log())
        epochs = collections.defaultdict(list)
        for epoch, sample in samples():
            epochs[int(epoch, 16)].append(sample["sequence"])
        self.assertEqual(list(epochs), sorted(epochs), "the epochs follow each other")
        for sequences in epochs.values():
            self.assertEqual(sequences, sorted(set(sequences)), "in order, each once")


class Contents(ForwardCase):
    def test_names_catalogue_and_alarms_are_json(self):
        server = self.server().start()
        forwarder = self.forwarder(f"  servers: [nats://127.0.0.1:{server.port}]")
        forwarder.start()
        self.wait_for_messages(server, forwarder, 4)
        messages = self.stored(server)
        self.assertEqual({message.subject for message in messages}, {"fieldcast.north.line.press=2E1", "fieldcast.north.line.mill"})
        press = next(json.loads(message.data) for message in messages if message.subject.endswith("1"))
        self.assertEqual((press["schema"], press["site"], press["bus"], press["device"]), (1, "north", "line", "press.1"))
        with nats.NatsClient(server.port) as client:
            entry = json.loads(client.last("KV_fieldcast-catalogue", "$KV.fieldcast-catalogue.north.line.press=2E1." + press["catalogue"]))
        self.assertEqual({channel["channel"]: channel["unit"] for channel in entry["channels"]},
                         {"temperature": "°C", "setpoint": "", "running": ""})

        def alarms():
            found = [json.loads(message.data) for message in self.stored(server, "FIELDCAST_ALARMS")]
            return [(alarm["device"], alarm["channel"], alarm["limit"], alarm["active"]) for alarm in found]
        self.assertEqual(plant.cli("write", "line/press.1/setpoint=101").code, 0)
        wait_until(lambda: ("press.1", "setpoint", "high", True) in alarms(), 20, lambda: str(alarms()))
        audit = [json.loads(message.data) for message in self.stored(server, "FIELDCAST_AUDIT")]
        self.assertEqual((audit[-1]["what"], audit[-1]["target"], audit[-1]["result"]), ("write 101", "line/press.1/setpoint", "done"), audit)
        self.assertEqual(plant.cli("write", "line/press.1/setpoint=1").code, 0)
        wait_until(lambda: alarms()[-1:] == [("press.1", "setpoint", "high", False)], 20, lambda: str(alarms()))
        before, audits = len(alarms()), len(self.stored(server, "FIELDCAST_AUDIT"))
        self.assertEqual(forwarder.stop(), 0)
        forwarder.start()
        count = len(self.stored(server))
        self.wait_for_messages(server, forwarder, count + 4)
        self.assertEqual(len(alarms()), before, "a restarted forwarder does not repeat alarms")
        self.assertEqual(len(self.stored(server, "FIELDCAST_AUDIT")), audits, "nor the audit")
        self.assertEqual(forwarder.stop(), 0)

    def test_after_an_outage_old_samples_are_late(self):
        server = self.server().start()
        forwarder = self.forwarder(f"  servers: [nats://127.0.0.1:{server.port}]\nsend: {{ late-after: 1s }}")
        reference = forwarding.Reference(plant, self.folder)
        self.addCleanup(reference.stop)
        forwarder.start()
        self.wait_for_messages(server, forwarder, 4)
        server.kill()
        time.sleep(5)
        server.start()
        wait_until(lambda: any(message.subject.startswith("fieldcast-late.north.line.") for message in self.stored(server)), 20, forwarder.log)
        time.sleep(2)
        reference.stop()
        newest = {channel: max(samples) for channel, samples in reference.samples().items()}

        def all_arrived():
            arrived = by_channel(deduplicated(self.stored(server)))
            return all(number in {sample["sequence"] for _, sample in arrived[channel]} for channel, number in newest.items())

        wait_until(all_arrived, 20, forwarder.log)
        self.assertEqual(forwarder.stop(), 0)
        messages = self.stored(server)
        late = [message for message in messages if message.subject.startswith("fieldcast-late.")]
        self.assertEqual({message.subject for message in late}, {"fieldcast-late.north.line.press=2E1", "fieldcast-late.north.line.mill"})
        self.assertGreater(max(len(json.loads(message.data)["samples"]) for message in late), 10, "waiting records are merged")
        live = [message for message in messages if message.subject.startswith("fieldcast.")]
        arrived = by_channel(deduplicated(messages))
        for part in (late, live):
            for samples in by_channel(deduplicated(part)).values():
                numbers = [(epoch, sample["sequence"]) for epoch, sample in samples]
                self.assertEqual(numbers, sorted(set(numbers)), "each subject is in order")
        for channel, samples in reference.samples().items():
            numbers = collections.Counter(sample["sequence"] for _, sample in arrived[channel])
            self.assertEqual(max(numbers.values()), 1)
            first = min(numbers)
            self.assertEqual([number for number in samples if number > first and number not in numbers], [], channel)

    def test_the_state_of_the_site_is_published_and_served(self):
        server = self.server().start()
        port = nats.free_port()
        forwarder = self.forwarder(f"  servers: [nats://127.0.0.1:{server.port}]\nmetrics: {{ listen: 127.0.0.1:{port} }}")
        forwarder.start()
        self.wait_for_messages(server, forwarder, 4)

        def metrics():
            with urllib.request.urlopen(f"http://127.0.0.1:{port}/metrics", timeout=5) as response:
                return response.read().decode()
        self.assertIn('fieldcast_forward_connected{site="north"} 1\n', metrics())
        wait_until(lambda: int(re.search(r"forward_samples_total\S* (\d+)", metrics())[1]) > 0, 10, metrics)

        def state():
            with contextlib.suppress(Failure), nats.NatsClient(server.port) as client:
                return json.loads(client.last("KV_fieldcast-sites", "$KV.fieldcast-sites.north"))
        wait_until(state, 25, forwarder.log)
        self.assertEqual((state()["schema"], state()["site"], state()["devices"]), (1, "north", 2))
        self.assertLess(abs(state()["at"] / 1e9 - time.time()), 30)

    def test_the_centre_writes_a_channel_once(self):
        server = self.server().start()
        forwarder = self.forwarder(f"  servers: [nats://127.0.0.1:{server.port}]\ncommands:\n  allow:\n"
                                   "    - { user: anna, channels: [\"line/*/setpoint\"] }")
        forwarder.start()
        self.wait_for_messages(server, forwarder, 4)

        def request(user, **members):
            with nats.NatsClient(server.port) as client:
                return client.request(f"fieldcast-command.north.{user}",
                                      {"channel": "line/press.1/setpoint", "expires_at": time.time_ns() + 5_000_000_000, **members})
        first = request("anna", id="1", value=42, verify=True)
        self.assertEqual((first["state"], first["values"]), ("verified", [42]), first)
        self.assertEqual(request("anna", id="1", value=43), first, "a repeated request is not run")
        self.assertIn("no right", request("ben", id="1", value=43)["reason"])
        self.assertIn("no right", request("anna", id="2", value=43, channel="line/press.1/running")["reason"])
        self.assertEqual(request("anna", id="3", value=43, expires_at=time.time_ns() - 1)["state"], "expired")
        self.assertEqual(forwarder.stop(), 0)
        with self.assertRaisesRegex(Failure, "nothing serves"):
            request("anna", id="1", value=43)
        forwarder.start()
        wait_until(lambda: forwarder.log().count("connected to") == 2, 20, forwarder.log)
        self.assertEqual(request("anna", id="1", value=43), first, "also after a restart")
        watched = plant.cli("watch", "line/press.1/setpoint", "--once", "--json").json_lines()
        self.assertEqual([sample["value"] for sample in watched if "value" in sample][-1:], [42])

    def test_protobuf_is_that_of_the_schema(self):
        server = self.server().start()
        forwarder = self.forwarder(f"  servers: [nats://127.0.0.1:{server.port}]", "format: protobuf")
        forwarder.start()
        self.wait_for_messages(server, forwarder, 4)
        self.assertEqual(forwarder.stop(), 0)
        folder = os.path.join(SOURCE_DIR, "tools", "forward", "payload")
        for message in self.stored(server):
            text = subprocess.run(["protoc", f"--proto_path={folder}", "--decode=fieldcast.forward.v1.SampleBatch", "forward.proto"],
                                  input=message.data, capture_output=True, check=True).stdout.decode()
            self.assertIn("schema: 1\n", text)
            self.assertFalse(re.search(r"^\d+:", text, re.MULTILINE), "a field that the schema does not name")
            columns = collections.Counter(re.findall(r"^(\w+):", text, re.MULTILINE))
            values = sum(columns[name] for name in ("booleans", "integers", "naturals", "reals", "singles", "texts"))
            self.assertEqual(values, columns["sequences"])
            self.assertEqual(columns["acquired_at"], columns["sequences"])


class Security(ForwardCase):
    def certificates(self):
        nats.make_certificates(self.folder)
        with open(os.path.join(self.folder, "password"), "w", encoding="utf-8") as file:
            file.write("correct horse\n")
        os.chmod(os.path.join(self.folder, "password"), 0o600)

    def messages_of_server(self):
        folder = os.path.join(self.folder, "jetstream")
        return sum(os.path.getsize(os.path.join(path, name)) for path, _, names in os.walk(folder) if "FIELDCAST/msgs" in path for name in names)

    def tls_server(self, name):
        return self.server(nats.tls_lines(self.folder, name) + 'authorization { user: north, password: "correct horse" }').start()

    def test_a_server_with_the_certificate_of_another_name_is_refused(self):
        self.certificates()
        server = self.tls_server("other")
        forwarder = self.forwarder(f"  servers: [tls://127.0.0.1:{server.port}]\n  authority: ca.pem\n  certificate: client.pem\n  key: client.key")
        forwarder.start()
        wait_until(lambda: "cannot connect" in forwarder.log(), 20, lambda: forwarder.log() + server.log())
        self.assertEqual(forwarder.stop(), 0, forwarder.log())
        self.assertNotIn("connected to", forwarder.log())

    def test_tls_with_a_client_certificate_and_a_password(self):
        self.certificates()
        server = self.tls_server("server")
        address = f"  servers: [tls://127.0.0.1:{server.port}]\n  certificate: client.pem\n  key: client.key\n"
        wrong = self.forwarder(address + "  authority: foreign.pem\n  user: north\n  password-file: password")
        wrong.start()
        wait_until(lambda: "cannot connect" in wrong.log(), 20, lambda: wrong.log() + server.log())
        self.assertEqual(wrong.stop(), 0, wrong.log())
        self.assertNotIn("connected to", wrong.log())
        right = self.forwarder(address + "  authority: ca.pem\n  user: north\n  password-file: password")
        right.start()
        wait_until(lambda: self.messages_of_server() > 1000, 25, lambda: right.log() + server.log())
        self.assertEqual(right.stop(), 0, right.log())
        self.assertNotIn("horse", right.log())

    def test_a_wrong_password_is_reported_and_tried_again(self):
        with open(os.path.join(self.folder, "password"), "w", encoding="utf-8") as file:
            file.write("wrong secret\n")
        os.chmod(os.path.join(self.folder, "password"), 0o600)
        server = self.server('authorization { user: north, password: "correct horse" }').start()
        forwarder = self.forwarder(f"  servers: [nats://127.0.0.1:{server.port}]\n  user: north\n  password-file: password")
        forwarder.start()
        wait_until(lambda: "uthorization" in forwarder.log(), 20, lambda: forwarder.log() + server.log())
        with open(os.path.join(self.folder, "password"), "w", encoding="utf-8") as file:
            file.write("correct horse\n")
        wait_until(lambda: self.messages_of_server() > 1000, 25, lambda: forwarder.log() + server.log())
        self.assertEqual(forwarder.stop(), 0, forwarder.log())
        self.assertNotIn("secret", forwarder.log())
        self.assertNotIn("horse", forwarder.log())


class Refusals(ForwardCase):
    def test_a_missing_stream_is_reported_with_what_to_do(self):
        server = self.server().start()
        forwarder = self.forwarder(f"  servers: [nats://127.0.0.1:{server.port}]")
        with open(forwarder.file, encoding="utf-8") as file:
            text = file.read()
        with open(forwarder.file, "w", encoding="utf-8") as file:
            file.write(text.replace("create: true", "create: false"))
        forwarder.start()
        wait_until(lambda: "create: true" in forwarder.log(), 20, lambda: forwarder.log() + server.log())
        self.assertEqual(forwarder.stop(), 0, forwarder.log())

    def test_a_message_that_is_too_large_is_removed_and_the_rest_is_sent(self):
        server = self.server().start()
        with nats.NatsClient(server.port) as client:
            client.request("$JS.API.STREAM.CREATE.FIELDCAST", {"name": "FIELDCAST", "subjects": ["fieldcast.>"], "storage": "file", "max_msg_size": 400})
        forwarder = self.forwarder(f"  servers: [nats://127.0.0.1:{server.port}]")
        forwarder.start()
        wait_until(lambda: "exceeds max_msg_size" in forwarder.log(), 20, lambda: forwarder.log() + server.log())
        self.wait_for_messages(server, forwarder, 4)
        self.assertEqual({message.subject for message in self.stored(server)}, {"fieldcast.north.line.mill"}, "press.1 has more channels")
        self.assertEqual(forwarder.stop(), 0, forwarder.log())

    def test_faults_of_the_configuration_have_their_place(self):
        file = os.path.join(self.folder, "bad.yaml")
        with open(file, "w", encoding="utf-8") as text:
            text.write("site: north\nqueue: { path: q.db, size: 1GB }\njetstream: { servers: [nats://10.0.0.1:4222] }\n")
        done = subprocess.run([os.path.join(BIN_DIR, "fieldcast-forward"), "--config", file, "--check"], capture_output=True, text=True, timeout=20)
        self.assertEqual(done.returncode, 3, done.stderr)
        self.assertIn("bad.yaml:2:", done.stderr)
        self.assertIn("bad.yaml:3:", done.stderr)


if __name__ == "__main__":
    BIN_DIR, SOURCE_DIR = sys.argv[1], sys.argv[2]
    NATS_SERVER = nats.PROGRAM or os.path.join(sys.argv[3], "nats-server", "usr", "sbin", "nats-server")
    if not os.path.exists(NATS_SERVER):
        print("no nats-server here; tools/install.sh test brings it")
        sys.exit(77)
    unittest.main(argv=[sys.argv[0], *sys.argv[4:]], verbosity=2)
