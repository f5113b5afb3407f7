"""Tests `fieldcast capture` on a bridge with simulated devices of every family, and checks the
files with Wireshark (tshark).

usage: e2e_capture.py BIN_DIR SOURCE_DIR
"""

import contextlib
import json
import os
import re
import signal
import socket
import stat
import struct
import subprocess
import sys
import tempfile
import unittest

from plant import Plant, run_cli, wait_until

BIN_DIR, SOURCE_DIR, LUA = "", "", ""

# A capture queries every bridge of the machine, so each test uses its own bridge names.
BRIDGE, SHORT = f"capture-{os.getpid()}", f"short-{os.getpid()}"
SECONDS = "2500ms"  # length of a capture; longer than every refresh of the plant
# The bridge reports these faults if a busy machine delays a frame. Then the frames on the wire are
# broken and Wireshark reports faults correctly, so the capture is repeated.
HELD_UP = re.compile(r": (no response|incomplete response|checksum error|malformed response|response of another device or request|response too long)")
TRIALS = 8
MORE_BUSES = """
  - name: ascii
    port: { serial: {run}/ascii, baud: 19200, format: 7E1 }
    protocol: modbus-ascii
    defaults: { refresh: 500ms }
    devices: [ { name: mixer, address: 5, channels: [ { name: speed, at: "holding:7", type: uint16, access: read-write } ] } ]
    capture: { folder: {run}/wire, file-size: 100kB, files: 3 }
  - name: network
    port: { tcp: 127.0.0.1:PORT }
    protocol: modbus-tcp
    defaults: { refresh: 500ms }
    devices: [ { name: meter, address: 1, channels: [ { name: power, at: "holding:0", type: float32, unit: kW } ] } ]
"""
# Fields that the dissector of each bus must find.
FAMILIES = {
    "press-shop": ["mbrtu.unit_id", "modbus.regval_uint16", "modbus.request_frame"],
    "network": ["mbtcp.trans_id", "modbus.regval_uint16", "modbus.request_frame"],
    "ascii": ["fieldcast_modbus_ascii.unit", "fieldcast_modbus_ascii.lrc", "modbus.regval_uint16"],
    "assembly": ["fieldcast_omron_hostlink.header", "fieldcast_omron_hostlink.end_code", "fieldcast_omron_hostlink.data",
                 "fieldcast_omron_hostlink.sid", "fieldcast_omron_hostlink.command"],
    "lift": ["fieldcast_mitsubishi_fx.command", "fieldcast_mitsubishi_fx.address", "fieldcast_mitsubishi_fx.data"],
    "mixer": ["fieldcast_dtc.address", "fieldcast_dtc.command", "fieldcast_dtc.data", "fieldcast_dtc.codes"],
    "packing": ["fieldcast_s7_ppi.item", "fieldcast_s7_ppi.result", "fieldcast_s7_ppi.data", "fieldcast_s7_ppi.fcs"],
    "yard": ["fieldcast_s7_freeport.window", "fieldcast_frame.bytes", "mbrtu.unit_id"],
}

plant, captures = None, {}


class Demo(Plant):
    def _status(self):
        """Returns the status, with the bus that has no serial line."""
        result = self.cli("status", "--json")
        states = [line["state"] for line in result.json_lines() if line["topic"] == "BusStatus"] if result.code == 0 else []
        return states == ["running"] * (len(self._lines()) + 1)


def free_port():
    with socket.socket() as listener:
        listener.bind(("127.0.0.1", 0))
        return listener.getsockname()[1]


def plant_text():
    with open(os.path.join(SOURCE_DIR, "config/examples/demo.yaml"), encoding="utf-8") as file:
        text = re.sub(r"(?m)^dds:.*$", "", file.read()).replace("/tmp/fieldcast-demo", "{run}")
    text = re.sub(r"(?m)^bridge:.*$", f"bridge: {BRIDGE}", text)
    return text.rstrip() + MORE_BUSES.replace("PORT", str(free_port()))


def not_root():
    """Returns what runs a program as another user, if needed: tshark 4.0 loads Lua for root, 4.4 does not."""
    version = subprocess.run(["tshark", "--version"], capture_output=True, text=True).stdout
    if os.geteuid() != 0 or " 4.0." in version.splitlines()[0]:
        return []
    return ["setpriv", "--reuid=65534", "--regid=65534", "--clear-groups", "env", "HOME=/nonexistent"]


NOT_ROOT = not_root()


def tshark(path, *options):
    """Returns the output of tshark; the Lua file must run without a fault."""
    with open(path, "rb") as capture:  # which another user may not open
        ran = subprocess.run([*NOT_ROOT, "tshark", "-n", "-X", f"lua_script:{LUA}", "-o", "mbrtu.tcp.port:502", "-o", "mbrtu.crc_verification:TRUE",
                              "-r", "-", *options], stdin=capture, capture_output=True, text=True, timeout=60)
    faults = [line for line in ran.stderr.splitlines() if "Running as user" not in line]
    if ran.returncode != 0 or faults:
        raise AssertionError(f"tshark ended with {ran.returncode}: {faults}")
    return ran.stdout


def packets(path):
    rows = [json.loads(line) for line in tshark(path, "-T", "ek").splitlines() if line.startswith('{"timestamp"')]
    found = []
    for row in rows:
        fields = {}

        def collect(node):
            for key, value in node.items():
                if isinstance(value, dict):
                    collect(value)
                else:
                    fields.setdefault(key, []).extend(value if isinstance(value, list) else [value])

        collect(row["layers"])
        found.append(fields)
    return found


def named(fields, name):
    """Returns a field by the name of Wireshark's filter; ek output prefixes the protocol."""
    wanted = name.replace(".", "_")
    return [value for key, values in fields.items() if key == wanted or key.endswith("_" + wanted) for value in values]


def capture(bus, path, *options):
    return subprocess.Popen([os.path.join(BIN_DIR, "fieldcast"), "capture", bus, "--out", path, "--bridge", BRIDGE, *options],
                            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def setUpModule():
    global plant
    plant = Demo(BIN_DIR, plant_text())
    unittest.enterModuleContext(plant)
    os.mkdir(os.path.join(plant.run, "wire"))
    wanted = list(FAMILIES)
    for trial in range(TRIALS):
        wanted = [bus for bus, frames in captured(wanted, trial).items() if held_up(frames)]
        if not wanted:
            return
    raise AssertionError(f"{TRIALS} captures of {wanted} have broken frames: {[comments(captures[bus]) for bus in wanted]}")


def captured(buses, trial):
    """Captures buses, `ascii` during a write, without files of an earlier trial; tshark's results."""
    paths = {bus: os.path.join(plant.run, bus + ".pcapng") for bus in buses}
    if trial > 0:
        for path in paths.values():
            os.unlink(path)
    running = {bus: capture(bus, path, *([] if bus == "ascii" else ["--seconds", SECONDS])) for bus, path in paths.items()}
    for process in running.values():
        unittest.addModuleCleanup(ended, process)
    if "ascii" in running:
        size = lambda: os.path.exists(paths["ascii"]) and os.path.getsize(paths["ascii"])
        wait_until(size, 10, "the capture begins")
        write = plant.cli("write", "ascii/mixer/speed=4711", "--verify")
        if write.code != 0:
            raise AssertionError(str(write))
        written = size()
        wait_until(lambda: size() > written + 1000, 10, "frames come after the write")
        running["ascii"].send_signal(signal.SIGINT)
    for bus, process in running.items():
        out, err = process.communicate(timeout=30)
        if process.returncode != 0 or not re.fullmatch(rf"fieldcast capture: \d+ frames of {bus}\n", err):
            raise AssertionError(f"{bus}: {process.returncode} {out}{err}")
        captures[bus] = packets(paths[bus])
    return {bus: captures[bus] for bus in buses}


def aligned(data, size):
    return data + bytes(-len(data) % size)


LINKTYPE_RAW, LINKTYPE_UPPER_PDU = 101, 252


@contextlib.contextmanager
def pcapng(linktype, packets):
    def block(kind, inner):
        inner = aligned(inner, 4)
        return struct.pack("<II", kind, len(inner) + 12) + inner + struct.pack("<I", len(inner) + 12)

    with tempfile.NamedTemporaryFile(suffix=".pcapng") as file:
        file.write(block(0x0A0D0D0A, struct.pack("<IHHq", 0x1A2B3C4D, 1, 0, -1)) + block(1, struct.pack("<HHI", linktype, 0, 0)))
        for data in packets:
            file.write(block(6, struct.pack("<IIIII", 0, 0, 0, len(data), len(data)) + data))
        file.flush()
        yield file.name


def upper_pdu(dissector, frame):
    name = aligned(dissector.encode(), 4)
    ports = struct.pack(">HHIHHIHHI", 24, 4, 2, 25, 4, 502, 26, 4, 49152)
    return struct.pack(">HH", 12, len(name)) + name + ports + bytes(4) + frame


def comments(frames):
    return [comment for fields in frames for comment in named(fields, "frame.comment")]


def held_up(frames):
    return any(HELD_UP.search(comment) for comment in comments(frames))


def ended(process):
    with process:
        process.kill()


class Wireshark(unittest.TestCase):
    def test_every_family_has_its_fields_and_no_frame_is_at_fault(self):
        for bus, wanted in FAMILIES.items():
            with self.subTest(bus=bus):
                frames = captures[bus]
                self.assertGreater(len(frames), 4)
                for name in wanted:
                    self.assertTrue(any(named(fields, name) for fields in frames), f"no {name} in {frames[:4]}")
                for fields in frames:
                    for fault in ["_ws.malformed", "fault", "expert.severity"]:
                        # comment and chat levels
                        bad = [value for value in named(fields, fault) if value not in ("2097152", "1048576")]
                        self.assertFalse(bad, fields)

    def test_every_frame_of_modbus_rtu_is_decoded_and_responses_have_the_registers_that_were_asked_for(self):
        frames, asked, matched = captures["press-shop"], {}, 0
        self.assertTrue(all(named(fields, "mbrtu.crc16.status") == ["1"] for fields in frames))
        for number, fields in enumerate(frames, 1):
            self.assertNotIn("Unable to classify", json.dumps(fields))
            if words := named(fields, "modbus.word_cnt"):
                asked[str(number)] = int(words[0])
            requests = named(fields, "modbus.request_frame")
            if requests and requests[0] in asked:
                self.assertEqual(len(named(fields, "modbus.regval_uint16")), asked[requests[0]], fields)
                matched += 1
        # the capture may cut one exchange at each end
        self.assertGreaterEqual(matched, len(asked) - 2)
        self.assertGreater(matched, 10)

    def test_a_value_that_was_written_is_in_the_responses(self):
        self.assertIn("4711", [value for fields in captures["ascii"] for value in named(fields, "modbus.regval_uint16")])

    def test_comments_say_device_channels_and_outcome(self):
        said = comments(captures["press-shop"])
        self.assertTrue(any(re.match(r"press-1: read holding:0\.\.\d+ \(.*oil-temperature", comment) for comment in said), said[:9])
        self.assertTrue(any(re.search(r"items, \d+ samples$", comment) for comment in said), said[:9])
        written = comments(captures["ascii"])
        self.assertTrue(any("mixer: write holding:7 (speed; command of" in comment for comment in written), written)

    def test_microseconds_directions_and_the_name_of_the_bus(self):
        frames = captures["press-shop"]
        self.assertEqual({tuple(named(fields, "frame.interface_name")) for fields in frames}, {("press-shop",)})
        directions = {value for fields in frames for value in named(fields, "frame.packet_flags_direction")}
        self.assertEqual({int(value, 16) for value in directions}, {1, 2})
        self.assertTrue(any(int(fields["frame_frame_time_epoch"][0].rstrip("0").split(".")[1][3:6] or 0) for fields in frames))

    def test_samples_inside_rtps(self):
        def text(value):
            return struct.pack("<I", len(value) + 1) + value.encode() + b"\0"

        data = b""
        for name in ["press-shop", "press-1", "force"]:
            data = aligned(data, 4) + text(name)
        data = aligned(aligned(data, 4) + struct.pack("<I", 3), 8) + struct.pack("<d", 12.5)  # a double
        data = aligned(data + struct.pack("<IH", 0, 0), 8) + struct.pack("<qQ", 1_700_000_000_123_456_789, 42)
        serialized = b"\0\1\0\0" + data
        body = struct.pack("<HHIIIi", 0, 16, 0x07040000, 0x02240000, 0, 1) + serialized
        rtps = b"RTPS\2\3\1\17" + bytes(12) + struct.pack("<BBH", 0x15, 5, len(body)) + body
        udp = struct.pack(">HHHH", 50000, 51661, 8 + len(rtps), 0) + rtps
        ip = struct.pack(">BBHHHBBHII", 0x45, 0, 20 + len(udp), 0, 0, 64, 17, 0, 0x7F000001, 0x7F000001) + udp

        names = ["bus", "device", "channel", "value", "quality", "sequence", "acquired_at"]
        with pcapng(LINKTYPE_RAW, [ip]) as path:
            line = tshark(path, "-T", "fields", *[word for name in names for word in ("-e", "fieldcast_sample." + name)])
        self.assertEqual(line.split("\t")[:6], ["press-shop", "press-1", "force", "12.5", "0", "42"])
        self.assertIn("22:13:20.123456789", line)


class Compressed(unittest.TestCase):
    """Checks that the Lua file decompresses the vectors of the codec."""

    def packet(self, codes, length):
        codes = length.to_bytes(2, "big") + codes
        return upper_pdu("fieldcast-dtc", b"\1" + len(codes).to_bytes(2, "big") + codes)

    def setUp(self):
        with open(os.path.join(SOURCE_DIR, "tests/vectors/dtc.json"), encoding="utf-8") as file:
            self.vectors = [vector for vector in json.load(file) if "codes_hex" in vector]

    def test_every_vector_gives_its_original(self):
        wanted = [(bytes.fromhex(vector["codes_hex"]), bytes.fromhex(vector["original_hex"])) for vector in self.vectors if vector["kind"] == "ok"]
        with pcapng(LINKTYPE_UPPER_PDU, [self.packet(codes, len(original)) for codes, original in wanted]) as path:
            shown = tshark(path, "-x").split("\nDecompressed (")[1:]
        found = [bytes.fromhex("".join(re.findall(r"(?m)^[0-9a-f]{4}  ((?:[0-9a-f]{2} )+)", dump.split("\n\n")[0]))) for dump in shown]
        self.assertEqual(found, [original for _, original in wanted])
        self.assertTrue(any(len(original) > 2048 for _, original in wanted))  # a full dictionary

    def test_what_is_broken_is_a_fault_and_no_message(self):
        broken = [self.packet(bytes.fromhex(vector["codes_hex"]), vector["original_length"]) for vector in self.vectors if vector["kind"] != "ok"]
        codes, original = next((bytes.fromhex(vector["codes_hex"]), bytes.fromhex(vector["original_hex"])) for vector in self.vectors if vector["kind"] == "ok")
        broken += [self.packet(codes[:cut], len(original)) for cut in range(len(codes))]
        broken += [self.packet(codes, length) for length in [0, 1, len(original) - 1, len(original) + 1, 4097, 65535]] + [self.packet(codes + b"\0", len(original))]
        with pcapng(LINKTYPE_UPPER_PDU, broken) as path:
            faults = tshark(path, "-T", "fields", "-e", "fieldcast_dtc.fault").splitlines()
        self.assertEqual((len(faults), [at for at, fault in enumerate(faults) if not fault]), (len(broken), []))


    def test_a_check_is_shown_as_bytes_also_if_it_begins_with_zero(self):
        frame = bytes.fromhex("0000170100000071 0000004c441eb904407bb9b1931afe4800fc")
        with pcapng(LINKTYPE_UPPER_PDU, [upper_pdu("fieldcast-dtc", frame)]) as path:
            shown = tshark(path, "-T", "fields", "-e", "fieldcast_dtc.crc", "-e", "_ws.expert.message")
        self.assertEqual(shown, "00fc\t\n")


class Inspect(unittest.TestCase):
    def test_values_of_every_family_by_the_configuration(self):
        for bus in FAMILIES:
            with self.subTest(bus=bus):
                result = run_cli(BIN_DIR, "inspect", os.path.join(plant.run, bus + ".pcapng"), "--config", plant.file, "--json")
                frames = result.json_lines()
                self.assertEqual((result.code, len(frames)), (0, len(captures[bus])), str(result)[-2000:])
                found = {(value["device"], value["channel"]) for frame in frames for value in frame["values"]}
                # without the last frame: the capture may end before the response to it
                devices = {frame["comment"].split(":")[0] for frame in frames[:-1] if ": read" in frame["comment"]}
                self.assertEqual({device for device, _ in found}, devices)
        self.assertIn({"device": "mixer", "channel": "speed", "value": 4711, "unit": ""},
                      [value for frame in run_cli(BIN_DIR, "inspect", os.path.join(plant.run, "ascii.pcapng"), "--config", plant.file, "--json").json_lines()
                       for value in frame["values"]])

    def test_a_file_that_is_cut_shows_what_is_whole(self):
        with open(os.path.join(plant.run, "lift.pcapng"), "rb") as whole, tempfile.NamedTemporaryFile(suffix=".pcapng") as cut:
            cut.write(whole.read()[:-300])
            cut.flush()
            result = run_cli(BIN_DIR, "inspect", cut.name, "--config", plant.file)
        self.assertEqual(result.code, 1, str(result))
        self.assertIn("is cut in the middle of a block", result.err)
        self.assertIn("lift-1/floor = ", result.out)


class Capture(unittest.TestCase):
    def test_a_file_is_for_its_owner_only_and_never_written_over(self):
        path = os.path.join(plant.run, "lift.pcapng")
        self.assertEqual(stat.S_IMODE(os.stat(path).st_mode), 0o600)
        before = os.path.getsize(path)
        result = run_cli(BIN_DIR, "capture", "lift", "--out", path, "--bridge", BRIDGE, "--seconds", "1")
        self.assertEqual((result.code, os.path.getsize(path)), (9, before), str(result))
        self.assertIn("never overwrites", result.err)

    def test_who_asks_for_no_bus_gets_those_that_exist(self):
        path = os.path.join(plant.run, "none.pcapng")
        result = run_cli(BIN_DIR, "capture", "lifts", "--out", path, "--bridge", BRIDGE)
        self.assertEqual(result.code, 4, str(result))
        self.assertIn("lift", result.err)
        self.assertFalse(os.path.exists(path))

    def test_control_c_and_a_size_end_it_with_a_whole_file(self):
        path = os.path.join(plant.run, "interrupted.pcapng")
        process = capture("press-shop", path)
        wait_until(lambda: os.path.exists(path) and os.path.getsize(path) > 2000, 10, "frames come")
        process.send_signal(signal.SIGINT)
        _, err = process.communicate(timeout=10)
        self.assertEqual(process.returncode, 0, err)
        self.assertGreater(len(tshark(path)), 100)
        path = os.path.join(plant.run, "small.pcapng")
        process = capture("press-shop", path, "--size", "10kB")
        _, err = process.communicate(timeout=20)
        self.assertEqual(process.returncode, 0, err)
        self.assertLess(os.path.getsize(path), 10_000)

    def test_the_bridge_captures_by_itself(self):
        def found():
            return [name for name in os.listdir(os.path.join(plant.run, "wire")) if re.fullmatch(r"ascii-\d{8}T\d{6}Z\.pcapng", name)]

        names = wait_until(found, 20, lambda: plant.log("fieldcast-bridge"))
        path = os.path.join(plant.run, "wire", names[0])
        wait_until(lambda: os.path.getsize(path) > 1000, 10, "frames come")
        self.assertEqual(stat.S_IMODE(os.stat(path).st_mode), 0o600)
        self.assertGreater(len(tshark(path)), 100)


class End(unittest.TestCase):
    def test_a_capture_ends_whole_with_its_bridge(self):
        other = Plant(BIN_DIR, f"bridge: {SHORT}\nbuses:\n  - name: {SHORT}\n"
                               "    port: { serial: {run}/short, baud: 19200 }\n    protocol: modbus-rtu\n"
                               "    devices: [ { name: d, address: 1, channels: [ { name: a, at: \"holding:1\", type: int16, refresh: 100ms } ] } ]\n")
        with other, tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "short.pcapng")
            process = subprocess.Popen([os.path.join(BIN_DIR, "fieldcast"), "capture", SHORT, "--out", path], stderr=subprocess.PIPE, text=True)
            wait_until(lambda: os.path.exists(path) and os.path.getsize(path) > 1000, 10, "frames come")
            other.bridge.terminate()
            _, err = process.communicate(timeout=20)
            self.assertEqual(process.returncode, 0, err)
            self.assertIn("the bridge or the bus ended", err)
            self.assertGreater(len(tshark(path)), 100)


if __name__ == "__main__":
    BIN_DIR, SOURCE_DIR = sys.argv.pop(1), sys.argv.pop(1)
    LUA = os.path.join(SOURCE_DIR, "tools/wireshark/fieldcast.lua")
    unittest.main()
