"""Tests a fieldcast-station that reads two sites from NATS JetStream: two plants, each with its
bridge and its forwarder, a real server, and a station that joins no DDS domain.

usage: e2e_stream.py BIN_DIR
"""

import ctypes
import json
import os
import re
import signal
import subprocess
import sys
import tempfile
import time
import unittest

import e2e_station
import nats
from e2e_station import Browser, Station
from plant import Plant, claim_domain, run_cli, wait_until

BIN_DIR = ""
SECONDS = 30
OUTAGE = 8
SILENT = 30  # seconds until the station reports a silent site

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
          - { name: setpoint, at: "holding:200", type: int16, access: read-write, limits: { high: 32000 } }
          - { name: running, at: "coil:3", type: bool }
"""
CHANNELS = ("temperature", "setpoint", "running")


class Folder:
    """The folder of a station."""

    def __init__(self, run):
        self.run = run


class OtherDomain(Folder):
    """The folder and the domain of a station."""

    def __init__(self, run):
        super().__init__(run)
        self.domain, self.claim = claim_domain()


class Site:
    def __init__(self, name, port, payload, more=""):
        self.name = name
        self.plant = unittest.enterModuleContext(Plant(BIN_DIR, CONFIG))
        self.file = os.path.join(self.plant.run, "forward.yaml")
        with open(self.file, "w", encoding="utf-8") as file:
            file.write(f"""site: {name}
dds: {{ domain: {self.plant.domain} }}
queue: {{ path: queue.db }}
gather: {{ time: 200ms }}
send: {{ late-after: 2s }}
payload: {{ {payload} }}
jetstream:
  servers: [nats://127.0.0.1:{port}]
  acknowledgement: 1s
  streams: {{ create: true }}
{more}""")
        self.process = None
        self.start()
        unittest.addModuleCleanup(self.stop)

    def start(self):
        with open(os.path.join(self.plant.run, "fieldcast-forward.log"), "a", encoding="utf-8") as log:
            self.process = subprocess.Popen([os.path.join(BIN_DIR, "fieldcast-forward"), "--config", self.file],
                                            stdout=log, stderr=log, stdin=subprocess.DEVNULL)

    def stop(self):
        if self.process is not None and self.process.poll() is None:
            self.process.send_signal(signal.SIGTERM)
            self.process.wait(15)


server = other = north = south = None


def setUpModule():
    global server, other, north, south
    if nats.PROGRAM is None:
        raise unittest.SkipTest("nats-server is not installed (Debian: nats-server)")
    e2e_station.BIN_DIR = BIN_DIR
    folder = unittest.enterModuleContext(tempfile.TemporaryDirectory(prefix="fieldcast-stream-"))
    server = nats.NatsServer(folder).start()
    unittest.addModuleCleanup(server.kill)
    other = OtherDomain(folder)
    unittest.addModuleCleanup(other.claim.close)
    north = Site("north", server.port, "format: protobuf",
                 'commands: { allow: [{ user: local, channels: ["line/*/setpoint", "line/*/temperature"] }] }\n')
    south = Site("south", server.port, "compress: zstd")


def station(more=""):
    return Station(other, "centre", f"""
stream: {{ servers: [nats://127.0.0.1:{server.port}]{more} }}
web: {{ local-role: operator }}
store: {{ path: {other.run}/centre.db }}
record: {{ }}
""", "--listen", "127.0.0.1:0", joins=False)


def history(site, channel):
    result = run_cli(BIN_DIR, "history", f"{site}:line/press.1/{channel}", "--json", "--store", os.path.join(other.run, "centre.db"))
    return result.json_lines() if result.code == 0 else []


def recorded(site, channel):
    return [row["sequence"] for row in history(site, channel)]


def numbers(data):
    """The varints of a packed field."""
    found, number, shift = [], 0, 0
    for byte in data:
        number |= (byte & 0x7F) << shift
        shift += 7
        if byte < 0x80:
            found.append(number)
            number = shift = 0
    return found


def fields_of(data):
    """{field: bytes} of the packed fields of a SampleBatch."""
    at = 0

    def varint():
        nonlocal at
        end = at
        while data[end] >= 0x80:
            end += 1
        number, at = numbers(data[at:end + 1])[0], end + 1
        return number

    found = {}
    while at < len(data):
        field, kind = divmod(varint(), 8)
        if kind == 0:
            varint()
            continue
        length = 8 if kind == 1 else varint()
        found[field] = data[at:at + length]
        at += length
    return found


def content_of(data):
    if not data.startswith(b"\x28\xb5\x2f\xfd"):
        return data
    zstd = ctypes.CDLL("libzstd.so.1")
    zstd.ZSTD_decompress.restype = zstd.ZSTD_compressBound.restype = ctypes.c_size_t
    buffer = ctypes.create_string_buffer(1 << 20)
    size = zstd.ZSTD_decompress(buffer, ctypes.c_size_t(len(buffer)), data, ctypes.c_size_t(len(data)))
    return buffer.raw[:size]


def published(site):
    """The sequences of each channel in the stream, by an own decoder of tools/forward/payload/forward.proto."""
    found = {}
    for message in stored():
        content = content_of(message.data) if b"rest" not in message.data else b""
        if message.subject.split(".")[1:] != [site, "line", "press=2E1"] or not content.startswith(b"\x08\x01"):
            continue
        fields = fields_of(content)
        runs, counts, sequence, channel, at, item = numbers(fields[4]), numbers(fields.get(5, b"")), 0, 0, 0, 0
        sequences = numbers(fields[6])
        for skipped, some in zip(runs[::2], runs[1::2]):
            channel += skipped
            for _ in range(some):
                for _ in range(counts[at] if counts else 1):
                    sequence += (sequences[item] >> 1) ^ -(sequences[item] & 1)
                    item += 1
                    found.setdefault(channel, set()).add(sequence)
                at += 1
                channel += 1
    return list(found.values())


def metric(web, name):
    status, text = web.ask("GET", "/metrics")
    assert status == 200, text
    found = re.search(rf"^fieldcast_station_{re.escape(name)} (\S+)$", text, re.MULTILINE)
    return float(found[1]) if found else None


def present(web, site):
    return {each["channel"]: each for each in web.get(f"/api/channels?pattern={site}:*")}


def all_good(web, site):
    found = present(web, site)
    return found if len(found) == len(CHANNELS) and all(each["quality"] == "GOOD" for each in found.values()) else None


def site_state(web, name):
    return next((each for each in web.get("/api/sites")["sites"] if each["site"] == name), None)


class Stream(unittest.TestCase):
    def assert_complete(self):
        """The store has each sample that is in the stream now once, in order."""
        for site in ("north", "south"):
            wanted = published(site)
            self.assertEqual(len(wanted), len(CHANNELS))

            def is_complete(site=site, wanted=wanted):
                here = [recorded(site, channel) for channel in CHANNELS]
                # The channels have the order of the catalogue in the stream, which is not that of the configuration.
                return all(any(found <= set(rows) for rows in here) for found in wanted)
            wait_until(is_complete, SECONDS, lambda site=site, wanted=wanted:
                       f"{site}: missing " + str([sorted(found - set(rows))[:9] for found, rows in zip(wanted, [recorded(site, c) for c in CHANNELS])]))
            for channel in CHANNELS:
                sequences = recorded(site, channel)
                self.assertEqual(len(sequences), len(set(sequences)), f"{site} {channel}: a sample is there twice")
                # A bad sample has no time of its own.
                good = [row["sequence"] for row in history(site, channel) if row["quality"] == "GOOD"]
                self.assertEqual(good, sorted(good), f"{site} {channel}")

    def test_1_values_of_both_sites(self):
        with station() as running:
            web = Browser(running)
            for site in (north, south):
                found = wait_until(lambda site=site: all_good(web, site.name), SECONDS, running.log)
                value = found[f"{site.name}:line/press.1/temperature"]
                self.assertLess(time.time() - value["acquired_ms"] / 1e3, 5)
            state = wait_until(lambda: (found := site_state(web, "north")) and found.get("clock_ahead_ms") is not None and found,
                               SECONDS, running.log)
            self.assertTrue(state["connected"])
            self.assertLess(abs(state["clock_ahead_ms"]), 2000)
            wait_until(lambda: web.get("/api/sites")["stream"] == {"connected": True, "reason": "", "commands": False}, SECONDS, running.log)
            self.assertEqual(metric(web, 'site_connected{site="south"}'), 1)
            self.assertGreater(metric(web, "stream_recorded_samples_total"), 0)
            status, text = web.ask("POST", "/api/commands", {"channel": "north:line/press.1/setpoint", "value": 3})
            self.assertEqual(status, 409, text)
            self.assertIn("read from the stream", text)

    def test_2_alarms(self):
        with station() as running:
            web = Browser(running)
            self.assertEqual(north.plant.cli("write", "line/press.1/setpoint=32001").code, 0)
            alarms = wait_until(lambda: [each for each in web.get("/api/alarms")["alarms"] if each["active"]], SECONDS, running.log)
            self.assertEqual([(each["bus"], each["channel"], each["limit"]) for each in alarms], [("north:line", "setpoint", "high")])
            status, text = web.ask("POST", "/api/alarms/acknowledge", {"alarms": [
                {name: alarms[0][name] for name in ("bus", "device", "channel", "limit")}]})
            self.assertEqual(status, 409, text)
            self.assertEqual(north.plant.cli("write", "line/press.1/setpoint=7").code, 0)
            events = wait_until(lambda: len(found := web.get("/api/alarms?limit=10")["events"]) >= 2 and found, SECONDS, running.log)
            self.assertEqual({each["event"] for each in events}, {"raised", "cleared"})

    def test_2_commands_reach_a_site_that_allows_them(self):
        with station(", commands: true") as running:
            web = Browser(running)
            wait_until(lambda: all_good(web, "north") and all_good(web, "south") and site_state(web, "north") and site_state(web, "south"),
                       SECONDS, running.log)
            self.assertTrue(web.get("/api/sites")["stream"]["commands"])

            def ended(path, body):
                status, text = web.ask("POST", path, body)
                self.assertEqual(status, 202, text)
                of = json.loads(text)["request_id"]
                return wait_until(lambda: (found := web.get(f"/api/commands/result?request_id={of}")) and found["state"] != "pending" and found,
                                  SECONDS, running.log)

            def write(channel, value):
                return ended("/api/commands", {"channel": channel, "value": value, "verify": True})
            done = write("north:line/press.1/setpoint", 321)
            self.assertEqual((done["state"], done["value"]), ("verified", 321), done)
            wait_until(lambda: present(web, "north")["north:line/press.1/setpoint"]["value"] == 321, SECONDS, running.log)
            refused = write("north:line/press.1/running", True)
            self.assertEqual((refused["state"], refused["reason"]),
                             ("rejected", "user 'local' has no right to write line/press.1/running at this site"))
            refused = write("north:line/press.1/temperature", 1)
            self.assertEqual((refused["state"], refused["cause"]), ("rejected", "READ_ONLY"), refused)
            self.assertEqual(write("south:line/press.1/setpoint", 1)["state"], "not-sent")

            def audit():
                with nats.NatsClient(server.port) as client:
                    return [content_of(message.data) for message in client.stored("FIELDCAST_AUDIT")]
            wait_until(lambda: any(b"/local" in entry and b"write 321" in entry for entry in audit()), SECONDS, lambda: str(audit()))

            # An alarm of the site is acknowledged.
            write("north:line/press.1/setpoint", 32001)
            alarm = wait_until(lambda: [each for each in web.get("/api/alarms")["alarms"] if each["active"]], SECONDS, running.log)[0]
            key = {name: alarm[name] for name in ("bus", "device", "channel", "limit")}
            done = ended("/api/alarms/acknowledge", {"alarms": [key], "note": "seen at the centre"})
            self.assertEqual(done["state"], "done", done)
            found = wait_until(lambda: [each for each in web.get("/api/alarms")["alarms"] if each["state"] == "acknowledged"], SECONDS, running.log)[0]
            self.assertEqual((found["acknowledged_by"], found["note"]), ("local", "seen at the centre"))
            status, text = web.ask("POST", "/api/alarms/maintenance", {"bus": "north:line", "device": "press.1", "minutes": 5})
            self.assertEqual(status, 409, text)
            write("north:line/press.1/setpoint", 7)

            # A forwarder that does not respond: the command was sent, and its result is unknown.
            north.process.send_signal(signal.SIGSTOP)
            try:
                self.assertEqual(write("north:line/press.1/setpoint", 8)["state"], "no-answer")
            finally:
                north.process.send_signal(signal.SIGCONT)
            time.sleep(2)
            self.assertEqual(north.plant.cli("watch", "line/press.1/setpoint", "--once", "--json").json_lines()[-1].get("value"), 7,
                             "a command that has expired meanwhile is not run")

    def test_3_an_outage_of_the_server_leaves_no_gap(self):
        with station() as running:
            web = Browser(running)
            wait_until(lambda: all_good(web, "north") and all_good(web, "south"), SECONDS, running.log)
            wait_until(lambda: web.get("/api/sites")["stream"]["connected"], SECONDS, running.log)
            began = time.time()
            server.kill()
            self.addCleanup(lambda: server.process.poll() is None or server.start())
            reason = wait_until(lambda: (stream := web.get("/api/sites")["stream"]) and not stream["connected"] and stream["reason"], SECONDS, running.log)
            self.assertIn("disconnected", reason)
            self.assertEqual(metric(web, "stream_connected"), 0)
            time.sleep(OUTAGE)
            server.start()
            back = time.time()
            wait_until(lambda: web.get("/api/sites")["stream"]["connected"], SECONDS, running.log)
            wait_until(lambda: all((found := all_good(web, site)) and
                                   all(each["acquired_ms"] / 1e3 > back for each in found.values()) for site in ("north", "south")),
                       SECONDS, running.log)
            self.assert_complete()
            inside = [row for row in history("north", "temperature") if began < row["acquired_at"] / 1e9 < back]
            self.assertGreater(len(inside), OUTAGE * 4)
            late = [message for message in stored() if message.subject.startswith("fieldcast-late.")]
            self.assertTrue(late, "nothing was sent late")
            found = web.get(f"/api/history?channel=north:line/press.1/temperature&from={int(began * 1000)}&to={int(back * 1000)}")["series"][0]["late"]
            self.assertTrue(any(each["from_ms"] < back * 1000 and each["to_ms"] > began * 1000 and each["samples"] > 0 and
                                each["received_ms"] > back * 1000 - 500 for each in found), f"{found} {began} {back}")

    def test_4_messages_that_cannot_be_decoded_are_skipped(self):
        with station() as running:
            web = Browser(running)
            wait_until(lambda: all_good(web, "north"), SECONDS, running.log)
            before = metric(web, "stream_refused_messages_total")
            with nats.NatsClient(server.port) as client:
                client.publish("fieldcast.north.line.press=2E1", b"poison")
                client.publish("fieldcast.north.line.press=2E1", b"\x08\x02rest")
                client.publish("fieldcast-late.north.line.press=2E1", b"\x28\xb5\x2f\xfdrest")
                client.publish("fieldcast.poison", b"\x08\x01")
                client.publish("fieldcast.void.line.press", b"\x08\x01\x19\x01\x02\x03\x04\x05\x06\x07\x08")
            wait_until(lambda: metric(web, "stream_refused_messages_total") == before + 5, SECONDS, running.log)
            self.assertEqual(site_state(web, "north")["refused_messages"], 3)
            log = running.log()
            for text in ("fieldcast.north.line.press=2E1: a message of 6 bytes is skipped: the content is neither protobuf nor JSON",
                         "the version of the message is not supported", "the zstd frame is damaged",
                         "fieldcast.poison: a message of 2 bytes is skipped: the subject does not name"):
                self.assertIn(text, log)
            now = time.time()
            wait_until(lambda: all_good(web, "north") and all(each["acquired_ms"] / 1e3 > now for each in present(web, "north").values()),
                       SECONDS, running.log)

    def test_5_a_restarted_station_continues_where_its_store_ended(self):
        with station() as running:
            wait_until(lambda: all_good(Browser(running), "north"), SECONDS, running.log)
        time.sleep(4)
        with station() as running:
            wait_until(lambda: all_good(Browser(running), "north"), SECONDS, running.log)
            self.assert_complete()
            running.process.kill()
            running.process.wait()
            time.sleep(2)
            with station() as again:
                self.assert_complete()
            running.process = again.process  # for its exit code

    def test_6_a_silent_site_is_visible(self):
        with station() as running:
            web = Browser(running)
            wait_until(lambda: all_good(web, "south") and site_state(web, "south")["connected"], SECONDS, running.log)
            south.stop()
            wait_until(lambda: not site_state(web, "south")["connected"], SILENT + 15, running.log)
            self.assertEqual(metric(web, 'site_connected{site="south"}'), 0)
            self.assertTrue(site_state(web, "north")["connected"])
            wait_until(lambda: {each["quality"] for each in present(web, "south").values()} == {"UNCERTAIN"}, 10, running.log)
            south.start()
            wait_until(lambda: all_good(web, "south") and site_state(web, "south")["connected"], SECONDS, running.log)

    def test_7_messages_in_json_are_read(self):
        with open(south.file, encoding="utf-8") as file:
            text = file.read()
        south.stop()
        with open(south.file, "w", encoding="utf-8") as file:
            file.write(text.replace("payload: { compress: zstd }", "payload: { format: json, compress: zstd }"))
        south.start()
        now = time.time()
        with station() as running:
            web = Browser(running)
            found = wait_until(lambda: (found := all_good(web, "south")) and all(each["acquired_ms"] / 1e3 > now for each in found.values()) and found,
                               SECONDS, running.log)
            self.assertEqual(found["south:line/press.1/temperature"]["type"], "float32")
            self.assertEqual(metric(web, "stream_refused_messages_total"), 0)
            wait_until(lambda: history("south", "temperature")[-1]["acquired_at"] / 1e9 > now, SECONDS, running.log)

    def test_8_a_site_with_the_name_of_a_site_in_dds_is_refused(self):
        text = f"sites: [{{ name: north, dds: {{ domain: {other.domain} }} }}]\nstream: {{ servers: [nats://127.0.0.1:{server.port}] }}\n"
        with Station(other, "both", text, "--listen", "127.0.0.1:0", joins=False) as running:
            web = Browser(running)
            fault = "a site of this station in DDS has the same name; rename one of the two"
            wait_until(lambda: all_good(web, "south") and fault in running.log(), SECONDS, running.log)
            self.assertIsNone(site_state(web, "north"))
            self.assertEqual(present(web, "north"), {})

    def test_9_tls_with_a_client_certificate(self):
        folder = os.path.join(other.run, "tls")
        os.mkdir(folder)
        nats.make_certificates(folder)
        secured = nats.NatsServer(folder, nats.tls_lines(folder, "server")).start()
        self.addCleanup(secured.kill)

        def reason_of(authority, more):
            text = f"stream: {{ servers: [tls://127.0.0.1:{secured.port}], authority: {authority}{more} }}\n"
            with Station(Folder(folder), "tls", text, "--listen", "127.0.0.1:0", joins=False) as running:
                web = Browser(running)
                return wait_until(lambda: (found := web.get("/api/sites")["stream"]) and found["reason"] not in ("", "not connected yet") and found["reason"],
                                  SECONDS, running.log)
        client = ", certificate: client.pem, key: client.key"
        self.assertIn("cannot connect", reason_of("foreign.pem", client))
        self.assertIn("cannot connect", reason_of("ca.pem", ""))
        # Connected, it finds that the server has no streams.
        self.assertIn("fieldcast-sites cannot be read: it does not exist", reason_of("ca.pem", client))


def stored():
    with nats.NatsClient(server.port) as client:
        return client.stored("FIELDCAST")


if __name__ == "__main__":
    BIN_DIR = sys.argv.pop(1)
    unittest.main(verbosity=2)
