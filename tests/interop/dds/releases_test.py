"""Tests programs of two builds with each other, for example those of Fast DDS 2.9.1 on Debian 12
and of 3.1.2 on Debian 13: values, commands, the station's page, Cyclone DDS, DDS Security, standby.

usage: releases_test.py PROGRAMS PROGRAMS

PROGRAMS is a folder, or ROOT:FOLDER for a folder in a second Debian (tools/in_root.sh). Programs of
ROOT run there with the processes, network, /tmp and /dev of this machine; that needs root. Exit
code 77: programs are missing here.
"""

import os
import shutil
import stat
import subprocess
import sys
import tempfile
import unittest

NAMES = ("fieldcast", "fieldcast-bridge", "fieldcast-sim", "fieldcast-station", "cyclone-watch", "cyclone-write", "cyclone-results")
WRAPPER = """#!/bin/sh
exec unshare --mount --propagation private sh -c '
  root=$1; shift
  mount --bind /tmp "$root/tmp" && mount --rbind /dev "$root/dev" && mount -t proc proc "$root/proc" &&
  exec chroot "$root" "$@"' sh '{root}' '{program}' "$@"
"""


SOURCES = {}  # folder of the programs themselves, by the folder of those that enter another Debian


def programs(text, made):
    """Returns the folder of the programs; for a second Debian a new folder in `made` with programs that enter it."""
    root, colon, folder = text.rpartition(":")
    missing = [name for name in NAMES if not os.access(f"{root}{folder}/{name}", os.X_OK)]
    if missing or (colon and os.geteuid() != 0):
        print(f"skipped: {text} has no {missing[0]}" if missing else f"skipped: only root may enter {root}")
        sys.exit(77)
    if not colon:
        return os.path.abspath(folder)
    SOURCES[os.path.join(made, os.path.basename(root))] = f"{root}{folder}"
    entries = os.path.join(made, os.path.basename(root))
    os.mkdir(entries)
    for name in NAMES:
        path = os.path.join(entries, name)
        with open(path, "w", encoding="utf-8") as file:
            file.write(WRAPPER.format(root=os.path.abspath(root), program=f"{folder}/{name}"))
        os.chmod(path, os.stat(path).st_mode | stat.S_IXUSR)
    return entries


MADE = tempfile.mkdtemp(prefix="fieldcast-releases-")
unittest.addModuleCleanup(shutil.rmtree, MADE, ignore_errors=True)
FOLDERS = [programs(sys.argv.pop(1), MADE) for _ in range(2)]
sys.argv.insert(1, FOLDERS[0])  # e2e_standby reads it

import cyclone_test  # noqa: E402
import e2e_secure_standby  # noqa: E402
import e2e_station  # noqa: E402
import secure_test  # noqa: E402
from plant import Plant, run_cli, wait_until  # noqa: E402

SECONDS = 30  # far above any normal duration, so that only a fault reaches it
CHANNELS, COMMANDS = secure_test.CHANNELS, secure_test.COMMANDS


class Exchange:
    """A bridge of one build, and stations of the other. `bridge`, `station`: folders; `secured`."""

    @classmethod
    def setUpClass(cls):
        cls.joins, dds = [], ""
        if cls.secured:
            cls.authority = os.path.join(tempfile.mkdtemp(dir=MADE), "plant")
            for arguments in (["init", cls.authority], ["add", "bridge", "line-7", "--authority", cls.authority],
                              ["add", "plant", "mes", "--authority", cls.authority]):
                done = run_cli(cls.station, "secure", *arguments)
                if done.code != 0:
                    raise AssertionError(str(done))
            dds = f", security: {cls.member('line-7')}"
            cls.joins = ["--security", cls.member("mes")]
        cls.plant = Plant(cls.bridge, secure_test.CONFIG, dds=dds, joins=cls.joins)
        cls.plant.__enter__()
        cls.addClassCleanup(cls.plant.__exit__, None, None, None)
        cls.addClassCleanup(cyclone_test.refuses_nothing, cls.plant)

    @classmethod
    def member(cls, name):
        return os.path.join(cls.authority, "members", name)

    def cli(self, command, *arguments):
        return run_cli(self.station, command, *arguments, "--config", self.plant.file, *self.joins)

    def good(self):
        done = self.cli("watch", "--once", "--json")
        return {f"{line['bus']}/{line['device']}/{line['channel']}": line for line in done.json_lines() if line["quality"] == "GOOD"}

    def test_every_channel_arrives_and_continues(self):
        before = {}
        wait_until(lambda: before.update(self.good()) or len(before) == CHANNELS, SECONDS, lambda: f"{len(before)} channels of {CHANNELS}")
        done = self.cli("watch", "--json", "--for", "4s")
        later = {f"{line['bus']}/{line['device']}/{line['channel']}": line["sequence"] for line in done.json_lines()}
        self.assertEqual(set(later), set(before), str(done)[-500:])
        stopped = [path for path, line in before.items() if later[path] <= line["sequence"]]
        self.assertEqual(stopped, [])

    def test_each_command_gets_its_result_and_its_value(self):
        wanted = {f"press-1/device/c{i}": 1000 + i for i in range(COMMANDS)}
        done = self.cli("write", *(f"{path}={value}" for path, value in wanted.items()), "--verify", "--json")
        results = done.json_lines()
        self.assertEqual([line["state"] for line in results], ["verified"] * COMMANDS, str(done))
        wait_until(lambda: wanted.items() <= {path: line["value"] for path, line in self.good().items()}.items(), SECONDS, "the values written")
        refused = self.cli("write", "press-1/device/c0=70000", "--json")
        self.assertEqual((refused.code, [line["state"] for line in refused.json_lines()]), (5, ["rejected"]), str(refused))

    def test_the_state_of_buses_and_devices_arrives(self):
        lines = self.cli("status", "--json").json_lines()
        self.assertEqual(sorted(line["bus"] for line in lines if line["topic"] == "BusStatus"), ["mill-1", "press-1"])
        self.assertEqual(sum(line["topic"] == "DeviceStatus" for line in lines), 2)

    def test_the_page_shows_every_channel(self):
        e2e_station.BIN_DIR = self.station
        text = "web: { local-role: operator }\n"
        security = ["--security", self.member("mes")] if self.secured else []
        with e2e_station.Station(self.plant, "page", text, "--listen", "127.0.0.1:0", *security) as page:
            browser = e2e_station.Browser(page)

            def good():
                return sum(channel["quality"] == "GOOD" for channel in browser.get("/api/channels"))
            wait_until(lambda: good() == CHANNELS, SECONDS, lambda: f"{good()} channels of {CHANNELS}\n{page.log()}")

    def test_stations_on_cyclone_of_the_other_release(self):
        cyclone_test.BIN_DIR = self.station
        cyclone_test.LOOPBACK = secure_test.cyclone_uri(self.member("mes")) if self.secured else secure_test.PLAIN
        with cyclone_test.Watch(self.plant) as watch:
            if self.secured and secure_test.waits_for_announcement(SOURCES.get(self.bridge, self.bridge)):
                return secure_test.expect_nothing(watch)
            wait_until(lambda: len(watch.good()) == CHANNELS, SECONDS, lambda: f"{len(watch.good())} channels of {CHANNELS}")
            done = cyclone_test.write(self.plant, "mill-1/device/c7", 321, "verify")
            self.assertEqual(done.stdout.split("\t")[:3], ["result", "1", "VERIFIED"], done.stdout + done.stderr)
            wait_until(lambda: watch.samples["mill-1/device/c7"]["value"] == "321", SECONDS, "the value written")
        done = subprocess.run([os.path.join(self.station, "cyclone-results"), str(self.plant.domain), "mill-1", "device", "c1", str(COMMANDS), "at-once"],
                              capture_output=True, text=True, timeout=SECONDS, env=cyclone_test.environment())
        self.assertEqual((done.stdout.split("\t")[:2], done.returncode), (["results", str(COMMANDS)], 0), done.stderr)


class StandbyAcross(e2e_secure_standby.SecureStandby):
    """The members of one secured standby group are of different builds; `bridges_of`: by name."""

    def start(self, program, *arguments, **options):
        folder = self.folders.get(os.path.basename(arguments[0]).partition(".")[0], FOLDERS[0])
        process = subprocess.Popen([os.path.join(folder, program), *arguments], stdin=subprocess.DEVNULL, **options)
        self.addCleanup(process.wait)
        self.addCleanup(process.kill)
        return process


def load_tests(loader, _tests, _pattern):
    suite = unittest.TestSuite()
    for way, (bridge, station) in {"FirstBridge": FOLDERS, "SecondBridge": FOLDERS[::-1]}.items():
        made = {f"{way}Plain": ((Exchange, unittest.TestCase), {"bridge": bridge, "station": station, "secured": False}),
                f"{way}Secured": ((Exchange, unittest.TestCase), {"bridge": bridge, "station": station, "secured": True}),
                f"{way}StandsBy": ((StandbyAcross,), {"folders": {"a": station, "b": bridge}})}
        for name, (bases, values) in made.items():
            suite.addTests(loader.loadTestsFromTestCase(type(name, bases, values)))
    return suite


if __name__ == "__main__":
    secure_test.PLAIN = cyclone_test.LOOPBACK
    unittest.main(argv=[sys.argv[0], *sys.argv[1:]])
