"""Tests a bridge with DDS Security and stations on Cyclone DDS with identities of the same
authority: channels, commands, and refused stations.

usage: secure_test.py BIN_DIR

Fast DDS 2.9 must not start a handshake with Cyclone DDS (eProsima/Fast-DDS #3802). The names of
both decide who starts, and `fieldcast secure add` chooses them accordingly. Each participant here
has a different GUID, so that the test does not pass by chance.

Fast DDS 3 exchanges nothing with a member on Cyclone DDS 0.10: it waits for the member's secured
announcement (DCPSParticipantsSecure), and Cyclone DDS has its writer but never writes it. The tests
expect that, so that they fail when a new version of either library changes it.
"""

import glob
import os
import shutil
import subprocess
import sys
import tempfile
import time
import unittest

import cyclone_test
from cyclone_test import SECONDS, Watch, write
from plant import Plant, wait_until

BIN_DIR = ""
CHANNELS, COMMANDS = 135, 50

CONFIG = "bridge: line-7\nbuses:\n" + "".join(f"""  - name: {bus}
    port: {{ serial: {{run}}/{bus}, baud: 115200, format: 8N1 }}
    protocol: modbus-rtu
    defaults: {{ refresh: 1s }}
    devices:
      - name: device
        address: 1
        channels:
""" + "".join(f'          - {{ name: c{i}, at: "holding:{i}", type: int16, access: read-write }}\n' for i in range(count))
    for bus, count in (("press-1", 100), ("mill-1", CHANNELS - 100)))

# Debian installs the plugins next to the library, outside the loader's search path.
PLUGINS = os.path.dirname(next(iter(glob.glob("/usr/lib/*/libddsc0debian/libdds_security_auth.so")), "/nowhere/x"))


def cyclone_uri(folder):
    def library(name, short):
        return (f'<Library path="{PLUGINS}/libdds_security_{short}.so" initFunction="init_{name}" finalizeFunction="finalize_{name}"/>')

    def file(name):
        return f"file:{folder}/{name}"
    return ('<CycloneDDS><Domain><General><Interfaces><NetworkInterface name="lo" multicast="true"/></Interfaces></General><Security>'
            f'<Authentication>{library("authentication", "auth")}<IdentityCA>{file("identity-ca.pem")}</IdentityCA>'
            f'<IdentityCertificate>{file("identity.pem")}</IdentityCertificate><PrivateKey>{file("identity.key")}</PrivateKey>'
            f'<CRL>{file("revoked.pem")}</CRL></Authentication>'
            f'<AccessControl>{library("access_control", "ac")}<PermissionsCA>{file("permissions-ca.pem")}</PermissionsCA>'
            f'<Governance>{file("governance.p7s")}</Governance><Permissions>{file("permissions.p7s")}</Permissions></AccessControl>'
            f'<Cryptographic>{library("crypto", "crypto")}</Cryptographic></Security></Domain></CycloneDDS>')


def waits_for_announcement(folder):
    """Returns true if the programs in `folder` are built with Fast DDS 3."""
    with open(os.path.join(folder, "fieldcast-bridge"), "rb") as program:
        return b"libfastdds.so.3" in program.read()


def expect_nothing(watch):
    """The authenticated member gets nothing in ten times the time that a first sample needs."""
    time.sleep(5)
    if watch.samples or watch.entries:
        raise AssertionError(f"Fast DDS 3 and Cyclone DDS exchange {len(watch.samples)} samples: correct docs/platforms.md")


@unittest.skipIf(not PLUGINS.startswith("/usr"), "Cyclone DDS has no security plugins here")
class SecuredCyclone(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp(prefix="fieldcast-secure-")
        cls.addClassCleanup(shutil.rmtree, cls.folder, ignore_errors=True)
        cls.authority = os.path.join(cls.folder, "plant")
        cls.secure("init", cls.authority)
        for member in (["bridge", "line-7"], ["station-readonly", "wall"], ["plant", "mes"], ["plant", "scada"]):
            cls.secure("add", *member, "--authority", cls.authority)
        cls.plant = Plant(BIN_DIR, CONFIG, dds=f", security: {cls.member('line-7')}", joins=["--security", cls.member("mes")])
        cls.plant.__enter__()
        cls.addClassCleanup(cls.plant.__exit__, None, None, None)
        # Waits for a bridge that it cannot discover, longer than all other tests take.
        cls.outsider = subprocess.Popen([os.path.join(BIN_DIR, "cyclone-write"), str(cls.plant.domain), "press-1", "device", "c9", "666"],
                                        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=cyclone_test.environment())
        cls.addClassCleanup(cls.outsider.communicate)
        cls.addClassCleanup(cls.outsider.terminate)

    @classmethod
    def secure(cls, *arguments):
        subprocess.run([os.path.join(BIN_DIR, "fieldcast"), "secure", *arguments], check=True, capture_output=True, timeout=30)

    @classmethod
    def member(cls, name):
        return os.path.join(cls.authority, "members", name)

    def join_as(self, name):
        """Sets the identity of all programs started from here on."""
        cyclone_test.LOOPBACK = cyclone_uri(self.member(name)) if name else cyclone_test.PLAIN

    def test_a_member_gets_every_channel_and_every_result(self):
        self.join_as("wall")
        with Watch(self.plant) as watch:
            if waits_for_announcement(BIN_DIR):
                return expect_nothing(watch)
            wait_until(lambda: len(watch.good()) == CHANNELS, SECONDS, lambda: f"{len(watch.good())} channels of {CHANNELS}")
            self.join_as("mes")
            for i in range(3):  # each is a participant with its own handshake
                done = write(self.plant, "press-1/device/c7", 100 + i, "verify")
                self.assertEqual(done.stdout.split("\t")[:3], ["result", "1", "VERIFIED"], done.stdout + done.stderr)
            wait_until(lambda: watch.samples["press-1/device/c7"]["value"] == "102", SECONDS, "the last value")
            results = subprocess.run([os.path.join(BIN_DIR, "cyclone-results"), str(self.plant.domain), "mill-1", "device", "c1", str(COMMANDS), "at-once"],
                                     capture_output=True, text=True, timeout=SECONDS, env=cyclone_test.environment())
            self.assertEqual((results.stdout.split("\t")[:2], results.returncode), (["results", str(COMMANDS)], 0), results.stderr)

    def test_then_a_readonly_station_and_one_without_identity_may_not_command(self):
        self.join_as("wall")  # refused by its own library
        self.assertNotEqual(write(self.plant, "press-1/device/c9", 666).returncode, 0)
        self.join_as(None)  # refused by the bridge's library
        with Watch(self.plant) as watch:
            time.sleep(1)  # three times as long as a member needs for its first command
            self.assertEqual((watch.samples, watch.entries), ({}, {}))
        seen = self.plant.cli("watch", "press-1/device/c9", "--once", "--json").json_lines()
        self.assertEqual(len(seen), 1)
        self.assertNotEqual(seen[0]["value"], 666)


if __name__ == "__main__":
    BIN_DIR = cyclone_test.BIN_DIR = sys.argv.pop()
    cyclone_test.PLAIN = cyclone_test.LOOPBACK
    unittest.main()
