"""Tests stations on Cyclone DDS, compiled from our IDL, with the real bridge: channels, kinds of
values, deadlines, commands.

usage: cyclone_test.py BIN_DIR
"""

import os
import subprocess
import sys
import threading
import unittest

from plant import Plant, wait_until

BIN_DIR = ""
SECONDS = 30  # far above any normal duration, so that only a fault reaches it

# The loopback has no multicast by default; Cyclone uses it if configured.
LOOPBACK = ('<CycloneDDS><Domain><General><Interfaces><NetworkInterface name="lo" multicast="true"/></Interfaces></General>'
            "</Domain></CycloneDDS>")

KINDS = [  # (type, the union's member in a sample, registers)
    ("bool", "boolean", 1), ("int16", "int64", 1), ("uint16", "uint64", 1), ("int32", "int64", 2), ("uint32", "uint64", 2),
    ("int64", "int64", 4), ("uint64", "uint64", 4), ("float32", "double", 2), ("float64", "double", 4), ("string(12)", "string", 6)]
QUICK, SLOW = "500ms", "2s"  # refresh of the first half of each kind, and of the second


def channels_of(bus, of_each_kind):
    """Returns (path, kind of value, refresh, line of the configuration) for each channel of a bus.
    """
    address, bit = 0, 0
    for kind, member, registers in KINDS:
        for i in range(of_each_kind):
            name = f"{kind.partition('(')[0]}-{i}"
            refresh = QUICK if 2 * i < of_each_kind else SLOW
            at = f"coil:{bit}" if kind == "bool" else f"holding:{address}"
            bit, address = bit + (kind == "bool"), address + (registers if kind != "bool" else 0)
            yield f"{bus}/device/{name}", member, refresh, f'{{ name: {name}, at: "{at}", type: {kind}, refresh: {refresh} }}'


CHANNELS = [*channels_of("one", 4), *channels_of("two", 2)]
SETPOINT = "two/device/setpoint"


def bus_text(name, more=""):
    lines = "".join(f"          - {line}\n" for path, _, _, line in CHANNELS if path.startswith(name + "/"))
    return (f"  - name: {name}\n    port: {{ serial: {{run}}/{name}, baud: 115200, format: 8N1 }}\n    protocol: modbus-rtu\n"
            f"    devices:\n      - name: device\n        address: 1\n        channels:\n{lines}{more}")


CONFIG = "bridge: cyclone\nbuses:\n" + bus_text("one") + bus_text(
    "two", '          - { name: setpoint, at: "holding:900", type: int16, access: read-write, refresh: 500ms, write: { min: -100, max: 1000 }, limits: { high: 900, priority: critical } }\n')


class Watch:
    def __init__(self, plant, *deadline_ms):
        self.entries, self.samples, self.gone, self.strange = {}, {}, set(), []
        self.process = subprocess.Popen([os.path.join(BIN_DIR, "cyclone-watch"), str(plant.domain), *map(str, deadline_ms)],
                                        stdout=subprocess.PIPE, text=True, env=environment())
        self.thread = threading.Thread(target=self._read)
        self.thread.start()

    def _read(self):
        for line in self.process.stdout:
            word, *fields = line.rstrip("\n").split("\t")
            if word == "channel" and len(fields) == 7:
                self.entries["/".join(fields[:3])] = dict(zip(("type", "unit", "at", "refresh"), fields[3:]))
            elif word == "sample" and len(fields) == 8:
                self.samples["/".join(fields[:3])] = dict(zip(("kind", "value", "quality", "acquired_at", "sequence"), fields[3:]))
            elif word == "gone" and len(fields) == 3:
                self.gone.add("/".join(fields))
            else:
                self.strange.append(line)

    def good(self):
        return {path for path, sample in list(self.samples.items()) if sample["quality"] == "GOOD"}

    def __enter__(self):
        return self

    def __exit__(self, kind, *_):
        self.process.terminate()
        try:
            code = self.process.wait(SECONDS)
        except subprocess.TimeoutExpired:
            self.process.kill()
            code = f"killed: still there {SECONDS} s after SIGTERM"
            self.process.wait()
        self.thread.join()
        self.process.stdout.close()
        if kind is None and (code != 0 or self.strange):
            raise AssertionError(f"cyclone-watch ended with {code}, and said {self.strange}")


def join(plant, way, every):
    """Runs cyclone-join until it has the requested channels; returns all its counts."""
    process = subprocess.Popen([os.path.join(BIN_DIR, "cyclone-join"), str(plant.domain), way], stdout=subprocess.PIPE, text=True, env=environment())
    counts = {}

    def read():
        for line in process.stdout:
            counts.update(zip(("samples", "missing", "with_value", "listed", "missing_blocks"), map(int, line.split())))

    reader = threading.Thread(target=read)
    reader.start()
    try:
        wait_until(lambda: counts.get("with_value") == counts.get("listed") == every, SECONDS, lambda: f"{every} channels: {counts}")
    finally:
        process.terminate()
        process.wait(SECONDS)
        reader.join()
        process.stdout.close()
    return counts


def refuses_nothing(plant):
    """The guard of the bridge refused no datagram of Cyclone DDS."""
    lines = [line for line in plant.cli("status", "--json").json_lines() if line["topic"] == "BusStatus"]
    refused = {cause: count for line in lines for cause, count in line["causes"].items() if cause.startswith("DATAGRAM_")}
    if not lines or refused:
        raise AssertionError(f"{len(lines)} buses; refused datagrams: {refused}")


def environment():
    return {**os.environ, "CYCLONEDDS_URI": LOOPBACK}


def write(plant, path, value, *more):
    return subprocess.run([os.path.join(BIN_DIR, "cyclone-write"), str(plant.domain), *path.split("/"), str(value), *more],
                          capture_output=True, text=True, timeout=SECONDS, env=environment())


class CycloneStations(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.plant = Plant(BIN_DIR, CONFIG)
        cls.plant.__enter__()
        cls.addClassCleanup(cls.plant.__exit__, None, None, None)
        cls.addClassCleanup(refuses_nothing, cls.plant)

    def test_every_channel_arrives_with_its_kind_of_value(self):
        every = {path for path, *_ in CHANNELS} | {SETPOINT}
        with Watch(self.plant) as watch:
            wait_until(lambda: watch.good() == every and set(watch.entries) == every, SECONDS,
                       lambda: f"{len(watch.entries)} entries of {len(every)}; not GOOD: {every - watch.good()}; beyond: {watch.good() - every}")
            for path, member, refresh, _ in CHANNELS:
                self.assertEqual(watch.samples[path]["kind"], member, path)
                self.assertEqual(int(watch.entries[path]["refresh"]), 500_000_000 if refresh == QUICK else 2_000_000_000, path)
            self.assertEqual(watch.entries[SETPOINT]["at"], "holding:900")
            before = {path: int(sample["sequence"]) for path, sample in watch.samples.items()}
            wait_until(lambda: all(int(watch.samples[path]["sequence"]) > first for path, first in before.items()), SECONDS,
                       lambda: f"no second sample: {[path for path, first in before.items() if int(watch.samples[path]['sequence']) <= first]}")
            agrees = self.plant.cli("watch", "--json", "--once").json_lines()
            self.assertEqual({"/".join((s["bus"], s["device"], s["channel"])) for s in agrees}, every)
            self.assertEqual(watch.gone, set())

    def test_a_late_joiner_gets_every_last_value_by_blocks_and_one_by_one(self):
        for way in ("by-blocks", "one-by-one"):
            with self.subTest(way):
                counts = join(self.plant, way, len(CHANNELS) + 1)
                self.assertGreaterEqual(counts["samples"], len(CHANNELS) + 1)
                self.assertEqual(counts["missing_blocks"], 0)

    def test_a_deadline_matches_just_the_channels_that_promise_it(self):
        quick = {path for path, _, refresh, _ in CHANNELS if refresh == QUICK} | {SETPOINT}
        with Watch(self.plant, 1000) as demanding, Watch(self.plant) as content:
            wait_until(lambda: demanding.good() == quick and len(content.good()) == len(CHANNELS) + 1, SECONDS,
                       lambda: f"{len(content.good())} in all; missing {quick - demanding.good()}, beyond {demanding.good() - quick}")
            # When one reader has every channel twice, the second one had time to receive it.
            before = {path: int(sample["sequence"]) for path, sample in content.samples.items()}
            wait_until(lambda: all(int(content.samples[path]["sequence"]) > first for path, first in before.items()), SECONDS, "no second samples")
            self.assertEqual(set(demanding.samples), quick)

    def test_a_command_is_done_and_its_value_comes_back(self):
        with Watch(self.plant) as watch:
            wait_until(lambda: SETPOINT in watch.good(), SECONDS, "no sample of the setpoint")
            for value, more, state in ((-42, (), "DONE"), (777, ("verify",), "VERIFIED")):
                done = write(self.plant, SETPOINT, value, *more)
                self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
                self.assertEqual(done.stdout.split("\t")[:4], ["result", "1", state, "NONE"])
                wait_until(lambda v=value: watch.samples[SETPOINT]["value"] == str(v), SECONDS, lambda: str(watch.samples[SETPOINT]))

    def test_a_refused_command_gives_its_reason(self):
        # The fastest results, each for a station that has just joined: every one must arrive.
        for path, value, cause in [(SETPOINT, 1001, "RANGE"), ("one/device/int16-0", 1, "READ_ONLY")] * 4:
            done = write(self.plant, path, value)
            self.assertEqual(done.returncode, 1, done.stdout + done.stderr)
            fields = done.stdout.strip().split("\t")
            self.assertEqual(fields[:4], ["result", "1", "REJECTED", cause])
            self.assertGreater(len(fields[4]), 5)

    def test_an_alarm_is_acknowledged(self):
        self.assertEqual(write(self.plant, SETPOINT, 950).returncode, 0)
        panel = subprocess.run([os.path.join(BIN_DIR, "cyclone-alarm"), str(self.plant.domain), *SETPOINT.split("/"), "anna", "on my way"],
                               capture_output=True, text=True, timeout=2 * SECONDS, env=environment())
        self.assertEqual(panel.stdout, "result\tDONE\tNONE\t\nalarm\t3\t2\t1\t950\tanna\ton my way\n", panel.stderr)
        self.assertEqual(panel.returncode, 0)
        self.assertIn("anna: on my way", self.plant.cli("alarms").out)
        self.assertEqual(write(self.plant, SETPOINT, 5).returncode, 0)

    def test_thousands_of_results_leave_nothing_behind(self):
        asked = subprocess.run([os.path.join(BIN_DIR, "cyclone-results"), str(self.plant.domain), *SETPOINT.split("/"), "4000"],
                               capture_output=True, text=True, timeout=3 * SECONDS, env=environment())
        self.assertEqual((asked.stdout, asked.stderr, asked.returncode), ("results\t4000\tleft\t0\n", "", 0))


class BridgeThatLeaves(unittest.TestCase):
    def test_every_channel_is_seen_to_go(self):
        with Plant(BIN_DIR, CONFIG) as plant, Watch(plant) as watch:
            wait_until(lambda: len(watch.good()) == len(CHANNELS) + 1, SECONDS, lambda: f"{len(watch.good())} channels")
            plant.bridge.terminate()
            wait_until(lambda: watch.gone == set(watch.samples), SECONDS, lambda: f"{len(watch.gone)} gone of {len(watch.samples)}")


class BridgeThatIsKilled(unittest.TestCase):
    def test_commands_of_its_first_life_are_not_executed_in_its_second(self):
        with Plant(BIN_DIR, CONFIG) as plant:
            results, count = [], 20
            plants = subprocess.Popen([os.path.join(BIN_DIR, "cyclone-replay"), str(plant.domain), *SETPOINT.split("/"), str(count)],
                                      stdout=subprocess.PIPE, text=True, env=environment())
            reader = threading.Thread(target=lambda: results.extend(line.split("\t")[1:4] for line in plants.stdout))
            reader.start()
            try:
                wait_until(lambda: len(results) >= count, SECONDS, lambda: f"{results}")
                self.assertEqual({state for _, state, _ in results}, {"DONE"})
                plant.bridge.kill()
                plant.bridge.wait()
                plant.bridge = plant._start("fieldcast-bridge")
                wait_until(lambda: len(results) >= 2 * count, SECONDS, lambda: f"{results[count:]}")
                self.assertEqual(sorted(results[count:]), sorted([str(i + 1), "REJECTED", "EXPIRED"] for i in range(count)))
            finally:
                plants.terminate()
                plants.wait()
                reader.join()
                plants.stdout.close()


if __name__ == "__main__":
    BIN_DIR = sys.argv.pop()
    unittest.main()
