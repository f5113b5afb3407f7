"""Tests the device templates of Fieldcast: each names its source, loads, runs with the simulator,
and reads correct values.

usage: templates_test.py BIN_DIR SOURCE_DIR

examples.txt has the meaning of registers, written from the sources that the templates name.
"""

import contextlib
import json
import os
import re
import subprocess
import sys
import tempfile
import unittest

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [HERE, os.path.join(HERE, "..", "..", "tools")]
from mc_devices import McDevices
from modbus_devices import Devices, read_examples
from plc_devices import PLCS, Plc
from plant import claim_domain, running_bridge, wait_until

BIN_DIR, SOURCE_DIR = "", ""
KEYS = ["Device", "Source", "Checked", "Line", "Words", "Reading", "Traps"]
SECONDS = 30
ETHERNET = ["modbus-tcp", "mitsubishi-mc", "omron-fins", "s7-tcp"]


class Template:
    def __init__(self, path):
        self.name = os.path.basename(path)[:-len(".yaml")]
        with open(path, encoding="utf-8") as file:
            self.text = file.read()
        self.ours = "Our own map" in self.text  # an example to copy, not a real device
        self.protocols = re.search(r"^protocols: \[(.+)\]$", self.text, re.MULTILINE)[1].split(", ")
        entries = re.split(r"^  - ", self.text.partition("\nchannels:\n")[2], flags=re.MULTILINE)[1:]
        self.channels = {re.search(r"name: ([\w.-]+)", entry)[1]: entry for entry in entries}

    def header(self):
        lines = [line[2:] for line in self.text.splitlines()[1:] if line.startswith("# ")]
        found = {}
        for line in lines:
            if match := re.match(r"(\w+): +(.+)", line):
                key = match[1]
                found[key] = match[2]
            else:
                found[key] += " " + line.strip()
        return found

    def scheduled(self):
        return {name for name, entry in self.channels.items() if "mode: on-demand" not in entry}


def templates():
    folder = os.path.join(SOURCE_DIR, "config", "devices")
    names = sorted(file.removesuffix(".yaml") for file in os.listdir(folder))
    return [Template(os.path.join(folder, name + ".yaml")) for name in names]


def examples():
    return read_examples(os.path.join(HERE, "examples.txt"))


def each_on_each_protocol():
    """Returns {bus: (template, protocol)}."""
    return {f"{template.name}-{protocol}": (template, protocol) for template in templates() for protocol in template.protocols}


def bus(name, template, port, protocol):
    return (f"  - name: {name}\n    port: {{ {port} }}\n    protocol: {protocol}\n"
            f"    devices: [ {{ name: device, address: 1, template: {template} }} ]\n")


def run(program, *arguments):
    return subprocess.run([os.path.join(BIN_DIR, program), *arguments], capture_output=True, text=True, timeout=2 * SECONDS)


class InAFolder(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="fieldcast-templates-")
        self.addCleanup(folder.cleanup)
        self.folder = folder.name
        os.symlink(os.path.join(SOURCE_DIR, "config", "devices"), os.path.join(self.folder, "devices"))

    def file(self, name, text):
        path = os.path.join(self.folder, name)
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)
        return path

    def lines(self, known):
        """Returns a configuration with a bus for each {name: (template, protocol)} of `known`."""
        text = "bridge: templates\nbuses:\n"
        for number, (name, (template, protocol)) in enumerate(known.items()):
            port = f"tcp: 127.0.0.1:{20000 + number}" if protocol in ETHERNET else f"serial: {self.folder}/{name}"
            if protocol == "modbus-rtu":  # the slowest usual line; other serial protocols have their default
                port += ", baud: 9600, format: 8N1"
            text += bus(name, template.name, port, protocol)
        return self.file("lines.yaml", text)


class Headers(unittest.TestCase):
    def test_of_every_device_say_the_same_things(self):
        for template in templates():
            with self.subTest(template=template.name):
                if not template.ours:
                    header = template.header()
                    self.assertEqual(list(header), KEYS)
                    self.assertEqual([key for key, text in header.items() if not text.strip()], [])

    def test_only_setpoints_and_relays_can_be_written(self):
        """docs/devices.md promises this."""
        bought = [template for template in templates() if not template.ours]
        written = {template.name for template in bought if re.search("access: (read-write|write-only)", template.text)}
        self.assertEqual(written, {"delta-dtb", "omron-e5cc", "siemens-rdf302", "waveshare-relay-8"})

    def test_of_no_template_has_a_line_above_140_columns(self):
        for template in templates():
            with self.subTest(template=template.name):
                self.assertEqual([line for line in template.text.splitlines() if len(line) > 140], [])


class Examples(unittest.TestCase):
    def test_are_there_for_every_device(self):
        self.assertEqual({template.name for template in templates() if not template.ours} ^ examples().keys(), set())


class Loading(InAFolder):
    def test_every_template_passes_the_check_on_each_of_its_protocols(self):
        known = each_on_each_protocol()
        done = run("fieldcast-bridge", "--check", self.lines(known))
        self.assertEqual((done.returncode, done.stderr), (0, ""), done.stdout)
        lines = done.stdout.splitlines()
        self.assertEqual(len(lines), 1 + len(known), done.stdout)
        for line, (name, (template, _)) in zip(lines[1:], known.items()):
            channels = len(template.channels)
            self.assertRegex(line, rf"^  {name}: .* {channels} channels?$")


class Simulation(InAFolder):
    def test_every_channel_is_read_in_time_from_a_simulated_device(self):
        """If blocks bridge no gaps, the device has only the registers that the template names."""
        known = each_on_each_protocol()
        strict = [name for name, (template, _) in known.items() if "max-gap: 0" in template.text]
        self.assertGreater(len(strict), 10)
        faults = "buses:\n" + "".join(f"  {name}: {{ devices: {{ device: {{ only-configured: true }} }} }}\n" for name in strict)
        done = run("fieldcast", "plan", self.lines(known), "--simulate", "2min", "--json",
                   "--faults", self.file("faults.yaml", faults))
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        buses = {bus["bus"]: bus for bus in map(json.loads, done.stdout.splitlines()) if "simulated" in bus}
        self.assertEqual(buses.keys() ^ known.keys(), set())
        for name, bus in buses.items():
            with self.subTest(bus=name):
                self.assertEqual((bus["missed"], bus["failures"]), (0, {}))
                read = {channel["channel"] for channel in bus["channels"] if channel["refreshes"] > 0}
                self.assertEqual(known[name][0].scheduled() - read, set())


class Values(InAFolder):
    def test_are_what_the_sources_say(self):
        """Uses one port for all devices of Modbus and Mitsubishi, and one for each PLC; registers without an example hold 0."""
        known = [template for template in templates() if not template.ours]
        memory, expected, channels = {}, {}, set()
        shared_ports = ["modbus-tcp", "mitsubishi-mc"]
        buses = {}
        domain, claim = claim_domain()
        self.addCleanup(claim.close)
        with contextlib.ExitStack() as stack:
            plcs = {}
            for unit, template in enumerate(known, 1):
                rows = examples()[template.name]
                for function, first, items, _ in rows:
                    memory.update({(unit, function, first + i): item for i, item in enumerate(items)})
                ours = {(area, first + i * (2 if area == "V" else 1)): item for area, first, items, _ in rows for i, item in enumerate(items)}
                shared = [protocol for protocol in shared_ports if protocol in template.protocols]
                for protocol in shared or template.protocols:
                    name = template.name if shared else f"{template.name}-{protocol}"
                    if not shared:
                        self.assertNotIn(protocol, plcs, "a second template; the device of a PLC has one address")
                        plcs[protocol] = stack.enter_context(Plc(ours, PLCS[protocol]))
                    buses[protocol] = (buses.get(protocol, "") +
                                       f"      - {{ name: {name}, address: {unit if shared else 1}, template: {template.name}, pause: 0ms }}\n")
                    channels.update((name, channel) for channel in template.channels)
                    expected.update({(name, channel): value for row in rows for channel, value in row[3].items()})
            self.assertEqual(plcs.keys() ^ PLCS.keys(), set())
            self.assertEqual(expected.keys() - channels, set(), "of an example")
            self.copy_on_schedule(known)
            plcs["modbus-tcp"], plcs["mitsubishi-mc"] = stack.enter_context(Devices(memory)), stack.enter_context(McDevices(memory))
            text = f"bridge: templates\ndds: {{ domain: {domain}, interfaces: [127.0.0.1] }}\nbuses:\n"
            for protocol, devices in buses.items():
                text += (f"  - name: {protocol}\n    port: {{ tcp: 127.0.0.1:{plcs[protocol].port} }}\n    protocol: {protocol}\n"
                         f"    devices:\n{devices}")
            config = self.file("values.yaml", text)
            with running_bridge(BIN_DIR, config, os.path.join(self.folder, "bridge.log")):
                wait_until(lambda: not self.wrong(config, expected, channels), SECONDS,
                           lambda: f"as the sources say: {self.wrong(config, expected, channels)}")

    def copy_on_schedule(self, known):
        """Copies the templates to the configuration's directory, with a refresh in place of `mode: on-demand`."""
        os.unlink(os.path.join(self.folder, "devices"))
        os.mkdir(os.path.join(self.folder, "devices"))
        for template in known:
            text, on_demand = re.subn("mode: on-demand", "refresh: 1min", template.text)
            self.file(f"devices/{template.name}.yaml", text)
            self.assertEqual(on_demand, len(template.channels.keys() - template.scheduled()))

    @staticmethod
    def wrong(config, expected, channels):
        """Returns {(device, channel): sample} of wrong samples; null means BAD_RANGE."""
        done = run("fieldcast", "watch", "--json", "--once", "--config", config)
        samples = {(s["device"], s["channel"]): s for s in map(json.loads, done.stdout.splitlines())}

        def right(key):
            sample = samples.get(key)
            if sample is not None and key in expected and expected[key] is None:
                return (sample["quality"], sample["value"], sample["device_code"]) == ("BAD_RANGE", None, 1)
            if sample is None or sample["quality"] != "GOOD":
                return False
            wanted, value = expected.get(key), sample["value"]
            if wanted is None or isinstance(wanted, (bool, str)):
                return wanted in (None, value)
            return abs(value - wanted) <= 1e-6 * max(1, abs(wanted))

        return {key: samples.get(key) for key in channels if not right(key)}


if __name__ == "__main__":
    BIN_DIR, SOURCE_DIR = sys.argv[1:3]
    unittest.main(argv=sys.argv[:1], verbosity=2)
