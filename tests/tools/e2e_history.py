"""Tests that samples which were published while a program did not run are fetched from the store of
the bridge: fieldcast-forward with a real NATS server, and fieldcast-station.

usage: e2e_history.py BIN_DIR SOURCE_DIR UNPACKED_DIR [CLASS ..]
"""

import collections
import contextlib
import os
import signal
import sqlite3
import subprocess
import sys
import time
import unittest

import e2e_forward
import e2e_station
import nats
import networks
from e2e_forward import NatsForwarder, by_channel, deduplicated
from e2e_station import Station
from plant import Plant, wait_until

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "campaign"))
from fault_shim import FaultShim  # noqa: E402

BIN_DIR = NATS_SERVER = ""
SECONDS = 60
DOWN = 5  # seconds

CONFIG = """
bridge: e2e
{store}
buses:
  - name: line
    port: { serial: {run}/line, baud: 115200, format: 8N1 }
    protocol: modbus-rtu
    defaults: { refresh: 200ms }
    devices:
      - name: press
        address: 1
        channels:
          - { name: temperature, at: "holding:100", type: float32 }
          - { name: order, at: "holding:20", type: string(8) }
      - name: mill
        address: 2
        channels:
          - { name: level, at: "input-register:3", type: uint16 }
"""
STORE = "store: { path: {run}/bridge.db }"


def bridge_store(plant):
    """{(device, channel): {(epoch, sequence): row}} of the bridge's store."""
    found = collections.defaultdict(dict)
    with contextlib.closing(sqlite3.connect(f"file:{plant.run}/bridge.db?mode=ro", uri=True)) as connection:
        epochs = [row[0] for row in connection.execute("select epoch from bus_epochs where bus = 'line' order by epoch")]
        rows = connection.execute("select c.device, c.channel, published_at, sequence, acquired_at, quality from samples s join channels c "
                                  "on c.id = s.channel order by published_at, sequence")
        for device, channel, published_at, sequence, acquired_at, quality in rows:
            epoch = max((epoch for epoch in epochs if epoch <= published_at), default=0)
            found[device, channel][epoch, sequence] = (acquired_at, quality)
    return found


class HistoryCase(unittest.TestCase):
    """A bridge with a store, a NATS server and a forwarder."""

    def setUp(self):
        self.plant = self.enterContext(self.new_plant())
        e2e_forward.plant, e2e_forward.BIN_DIR = self.plant, BIN_DIR
        self.server = nats.NatsServer(self.plant.run, "", NATS_SERVER).start()
        self.addCleanup(self.server.kill)
        self.forwarder = NatsForwarder(self.plant.run, f"  servers: [nats://127.0.0.1:{self.server.port}]", dds=self.dds())
        self.addCleanup(self.forwarder.stop)

    def new_plant(self):
        return Plant(BIN_DIR, CONFIG.replace("{store}", STORE))

    def dds(self):
        return None

    def stream(self):
        """{(device, channel): [(epoch, sequence)]} of the stream."""
        try:
            with nats.NatsClient(self.server.port, 3) as client:
                messages = client.stored("FIELDCAST")
        except (AssertionError, OSError):
            return {}
        found = by_channel(deduplicated(messages))
        return {name: [(int(epoch, 16), sample["sequence"]) for epoch, sample in samples] for name, samples in found.items()}

    def missing(self):
        """Samples of the store, up to the last one in the stream, that are not in the stream."""
        found, missing = self.stream(), []
        for name, rows in bridge_store(self.plant).items():
            numbers = found.get(name)
            if not numbers:
                return ["nothing of " + str(name)]
            missing += [(name, number) for number in rows if min(numbers) < number < max(numbers) and number not in set(numbers)]
        return missing

    def compare(self):
        time.sleep(1)
        wait_until(lambda: not self.missing(), SECONDS, lambda: str(self.missing()[:20]) + self.forwarder.log())
        self.assertEqual(self.forwarder.stop(), 0, self.forwarder.log())
        for name, numbers in self.stream().items():
            self.assertEqual(len(numbers), len(set(numbers)), f"{name}: each once")

    def start(self):
        self.forwarder.start()
        wait_until(lambda: len(self.stream()) == 3, SECONDS, self.forwarder.log)


class Forward(HistoryCase):
    def test_samples_of_the_time_without_a_forwarder_arrive_once(self):
        self.start()
        for _ in range(2):
            self.forwarder.kill()
            time.sleep(DOWN)
            self.forwarder.start()
            time.sleep(3)
        self.compare()
        self.assertIn("missing samples were fetched", self.forwarder.log())

    def test_a_forwarder_that_is_killed_while_it_fetches_repeats_nothing(self):
        self.start()
        self.forwarder.kill()
        time.sleep(2 * DOWN)
        self.forwarder.start()
        for wait in (6, 1, 2):
            time.sleep(wait)
            self.forwarder.kill()
            self.forwarder.start()
        self.compare()

    def test_a_bridge_that_was_restarted_meanwhile(self):
        self.start()
        self.forwarder.kill()
        time.sleep(1)
        self.plant.kill_bridge()
        time.sleep(3)
        self.forwarder.start()
        time.sleep(2)
        self.compare()
        self.assertEqual(len({epoch for numbers in self.stream().values() for epoch, _ in numbers}), 2)

    def test_a_stopped_process_fetches_what_it_missed(self):
        self.start()
        self.forwarder.process.send_signal(signal.SIGSTOP)
        time.sleep(2 * DOWN)
        self.forwarder.process.send_signal(signal.SIGCONT)
        time.sleep(2)
        self.compare()


class Clock(HistoryCase):
    """The wall clock of the forwarder is set while it sends. The clocks of the bridge and of the server are not changed."""

    STEP = 2 * 3600  # seconds

    def setUp(self):
        super().setUp()
        self.shim = FaultShim(os.path.join(BIN_DIR, "..", "lib", "libfault_shim.so"), self.plant.run, os.path.join(self.plant.run, "none"))
        self.forwarder.environment = self.shim.environment()

    def step(self, seconds):
        self.shim.clock_offset_ns = seconds * 1_000_000_000

    def test_steps_while_it_sends_lose_nothing_and_keep_the_order(self):
        self.start()
        for offset in (self.STEP, -self.STEP, 0):
            before = self.count()
            self.step(offset)
            wait_until(lambda: self.count() > before + 30, SECONDS, self.forwarder.log)
        self.compare()
        self.assertEqual(self.missing(), [])
        with nats.NatsClient(self.server.port, 3) as client:
            messages = client.stored("FIELDCAST")
        for prefix in ("fieldcast.", "fieldcast-late."):
            of_subject = [message for message in messages if message.subject.startswith(prefix)]
            for name, samples in by_channel(deduplicated(of_subject)).items():
                numbers = [sample["sequence"] for _, sample in samples]
                self.assertEqual(numbers, sorted(numbers), f"{prefix} {name}: in order")
        log = self.forwarder.log()
        self.assertRegex(log, "clock.* was set forward by 2h")
        self.assertRegex(log, "clock.* was set back by 4h")
        self.assertNotIn("missing samples were fetched", log)

    def test_a_step_back_during_an_outage_loses_nothing(self):
        self.start()
        self.server.kill()
        time.sleep(2)
        self.step(-self.STEP)
        time.sleep(2)
        self.server.start()
        self.compare()

    def test_a_forwarder_whose_clock_is_behind_fetches_what_it_missed(self):
        self.start()
        self.forwarder.kill()
        self.step(-self.STEP)
        time.sleep(DOWN)
        self.forwarder.start()
        time.sleep(2)
        self.compare()
        self.assertIn("missing samples were fetched", self.forwarder.log())

    def count(self):
        return sum(map(len, self.stream().values()))


RECORD = """
store: { path: {run}/recorded.db }
record: { patterns: ["*"] }
"""


def stored_rows(path):
    """{(device, channel): [(acquired_at, sequence, quality, value)]} in the order of publication, without those that the station itself makes."""
    found = collections.defaultdict(list)
    with contextlib.closing(sqlite3.connect(f"file:{path}?mode=ro", uri=True)) as connection:
        for device, channel, *row in connection.execute(
                "select c.device, c.channel, acquired_at, sequence, quality, coalesce(integer_value, real_value, text_value) "
                "from samples s join channels c on c.id = s.channel where c.channel not like '$%' order by published_at, sequence"):
            found[device, channel].append(tuple(row))
    return found


class RecordCase(unittest.TestCase):
    """A station that records the samples of `plant`."""

    plant = None

    def dds(self):
        return None

    @property
    def recorded(self):
        return os.path.join(self.plant.run, "recorded.db")

    def station(self, name="recorder"):
        return Station(self.plant, name, RECORD.replace("{run}", self.plant.run), "--listen", "127.0.0.1:0", dds=self.dds())

    def wait_for_samples(self, station, count):
        def recorded():
            rows = stored_rows(self.recorded) if os.path.exists(self.recorded) else {}
            return len(rows) == 3 and all(len(each) >= count for each in rows.values())
        wait_until(recorded, SECONDS, station.log)

    def difference(self):
        """Rows of the bridge's store within the recorded time that are not recorded, and rows that are recorded twice."""
        there, here, wrong = stored_rows(os.path.join(self.plant.run, "bridge.db")), stored_rows(self.recorded), []
        for name, rows in here.items():
            if rows[0] not in there[name] or rows[-1] not in there[name]:
                return [f"{name}: the ends are not stored yet"]
            wanted = there[name][there[name].index(rows[0]):there[name].index(rows[-1]) + 1]
            # A killed bridge loses the last 250 ms of its store, which the station may have received.
            counted = collections.Counter(rows)
            missing, repeated = [row for row in wanted if row not in counted], [row for row in rows if counted[row] > 1]
            if missing or repeated:
                wrong.append((name, missing, repeated))
        return wrong

    def compare_record(self, station):
        time.sleep(1)
        wait_until(lambda: not self.difference(), SECONDS, lambda: str(self.difference())[:2000] + station.log())
        wait_until(lambda: "back-filled" in station.log(), SECONDS, station.log)


class Record(RecordCase):
    def setUp(self):
        self.plant = self.enterContext(Plant(BIN_DIR, CONFIG.replace("{store}", STORE)))

    def test_a_killed_station_fetches_what_it_missed(self):
        station = self.station().__enter__()
        self.addCleanup(station.process.kill)
        self.wait_for_samples(station, 10)
        station.process.kill()
        station.process.wait()
        time.sleep(DOWN)
        with self.station("restarted") as restarted:
            self.compare_record(restarted)

    def test_a_stopped_station_fetches_what_it_missed(self):
        with self.station() as station:
            self.wait_for_samples(station, 10)
            station.process.send_signal(signal.SIGSTOP)
            time.sleep(3 * DOWN)
            station.process.send_signal(signal.SIGCONT)
            time.sleep(2)
            self.compare_record(station)

    def test_a_bridge_that_was_restarted_meanwhile(self):
        with self.station() as station:
            self.wait_for_samples(station, 10)
            station.process.send_signal(signal.SIGSTOP)
            time.sleep(DOWN)
            self.plant.kill_bridge()
            time.sleep(DOWN)
            station.process.send_signal(signal.SIGCONT)
            time.sleep(2)
            self.compare_record(station)


class FarBridge(Plant):
    """The bridge runs on the machine at the far end of a wire."""

    def __init__(self, wire):
        self.wire = wire
        for machine, device in ((wire.near, wire.device), (wire.far, "from-plant")):
            machine.run("ip", "route", "add", "224.0.0.0/4", "dev", device)
        super().__init__(BIN_DIR, CONFIG.replace("{store}", STORE), ", security: none", interfaces=wire.near_address)

    def _start(self, name):
        if name != "fieldcast-bridge":
            return super()._start(name)
        far = os.path.join(self.run, "far.yaml")
        with open(self.file, encoding="utf-8") as near, open(far, "w", encoding="utf-8") as file:
            file.write(near.read().replace(self.wire.near_address, self.wire.far_address))
        with open(os.path.join(self.run, name + ".log"), "w", encoding="utf-8") as log:
            return self.wire.far.start(os.path.join(BIN_DIR, name), far, stdout=log, stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL)


class Cut(HistoryCase, RecordCase):
    """The wire between the machine of the bridge and this one is cut, by nft, for longer than DDS repairs or remembers a participant."""

    SECONDS = 45
    wire = None

    def setUp(self):
        if Cut.wire is None:
            Cut.wire = networks.Wire("plant")
        super().setUp()

    def new_plant(self):
        return FarBridge(self.wire)

    def dds(self):
        return f"domain: {self.plant.domain}, interfaces: [{self.wire.near_address}], security: none"

    def test_a_forwarder_and_a_station_that_were_cut_off_fetch_what_they_missed(self):
        self.start()
        with self.station() as station:
            self.wait_for_samples(station, 10)
            self.wire.cut()
            time.sleep(self.SECONDS)
            last = {name: max(numbers) for name, numbers in self.stream().items()}
            self.wire.cut(False)
            wait_until(lambda: all(max(numbers) > last[name] for name, numbers in self.stream().items()), SECONDS, self.forwarder.log)
            self.compare()
            self.compare_record(station)
        self.assertIn("missing samples were fetched", self.forwarder.log())
        for name, numbers in self.stream().items():
            during = [number for epoch, number in numbers if number > last[name][1]]
            self.assertGreater(len(during), self.SECONDS, f"{name}: samples of the time of the cut")


class WithoutStore(unittest.TestCase):
    def test_a_bridge_without_a_store_refuses_and_the_forwarder_goes_on(self):
        plant = self.enterContext(Plant(BIN_DIR, CONFIG.replace("{store}", "")))
        e2e_forward.plant, e2e_forward.BIN_DIR = plant, BIN_DIR
        server = nats.NatsServer(plant.run, "", NATS_SERVER).start()
        self.addCleanup(server.kill)
        forwarder = NatsForwarder(plant.run, f"  servers: [nats://127.0.0.1:{server.port}]")
        self.addCleanup(forwarder.stop)
        forwarder.start()

        def has_samples():
            try:
                with nats.NatsClient(server.port, 3) as client:
                    return len(client.stored("FIELDCAST")) >= 4
            except (AssertionError, OSError):
                return False  # the stream does not exist yet
        wait_until(has_samples, SECONDS, forwarder.log)
        forwarder.kill()
        time.sleep(1)  # five samples
        forwarder.start()
        wait_until(lambda: "this bridge has no store" in forwarder.log(), SECONDS, forwarder.log)
        self.assertEqual(forwarder.stop(), 0, forwarder.log())


if __name__ == "__main__":
    BIN_DIR = e2e_station.BIN_DIR = sys.argv[1]
    NATS_SERVER = nats.PROGRAM or os.path.join(sys.argv[3], "nats-server", "usr", "sbin", "nats-server")
    if not os.path.exists(NATS_SERVER):
        print("no nats-server here; tools/install.sh test brings it")
        sys.exit(77)
    if any(name.startswith("Cut") for name in sys.argv[4:]):
        networks.enter()
    unittest.main(argv=sys.argv[:1] + sys.argv[4:], verbosity=2)
