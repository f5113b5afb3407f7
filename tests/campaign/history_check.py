"""Checks a recorded history of a plant: what stations received and what became of commands, against what was on the wire.

usage: history_check.py --config PLANT.yaml --samples FILE.. --commands FILE.. --capture FILE.. [--silent SECONDS] [--restarts N]

Independent of the code under test: Wireshark (tshark) reads the captures; this file reads the configuration, the frames and the values. It
compares register channels on Modbus RTU and TCP without bits, exponents and tables of values; others count as `not_compared`.

--samples: lines of `fieldcast watch --json`, a file for each station. --commands: a JSON line for each command: `channel`, `value`,
`invoked_at`, `returned_at` (nanoseconds since 1970, of the caller), and `results`, the JSON lines of `fieldcast write --json`. Each written
value must occur once for its channel. --capture: what `capture:` of the bridges wrote.

Rules:
- good-is-true: a GOOD value was in a response of its device, at most 0.25 s from its `acquired_at`;
- increasing: `acquired_at` and sequence of a channel increase at a station. The sequence begins again at most `--restarts` times (default 0,
  which holds for standby groups), as a bridge that restarts counts anew;
- not-silent: between two samples of a channel, at most `--silent` seconds (default 10) pass, unless the last one was not GOOD;
- one-result: each command has exactly one result, or none if its caller was killed (`results` is null);
- done-was-written: a command that is done was written between its invocation and its return, and at no other time. So of two commands, the
  one that returned before the other was invoked was written first;
- written-again: a write is repeated only after the device showed another value;
- not-written: a command that was rejected or expired is not on the wire.

Prints a line that begins with FAIL for each violation, and the counts as one JSON line. Exit code 1 if a rule was broken.
"""

import argparse
import bisect
import collections
import itertools
import json
import re
import struct
import subprocess
import sys

import yaml

NEAR = 250_000_000  # nanoseconds
FIELDS = ["frame.time_epoch", "frame.interface_name", "frame.packet_flags", "exported_pdu.exported_pdu"]
READS, WRITE_ONE, WRITE_MANY = {3: "holding", 4: "input-register"}, 6, 16
LATE = 5_000_000_000  # nanoseconds, within which a device may respond to an earlier request
FORMATS = {"uint16": ">H", "int16": ">h", "uint32": ">I", "int32": ">i", "float32": ">f", "uint64": ">Q", "int64": ">q", "float64": ">d"}

Channel = collections.namedtuple("Channel", "bus protocol unit area register format scale")
Write = collections.namedtuple("Write", "at value")
Frame = collections.namedtuple("Frame", "at bus is_request unit sequence pdu")


def channels_of(text):
    """Returns {bus/device/channel: Channel} of a configuration, and the names of those that are not compared."""
    found, others = {}, set()
    for bus in yaml.safe_load(text)["buses"]:
        for device in bus["devices"]:
            for channel in device["channels"]:
                name = f"{bus['name']}/{device['name']}/{channel['name']}"
                place = re.fullmatch(r"(holding|input-register):(\d+)", str(channel["at"]))
                plain = not {"exponent-from", "values", "offset", "order", "word-order", "bits"} & set(channel)
                if place and plain and channel["type"] in FORMATS and bus["protocol"] in ("modbus-rtu", "modbus-tcp"):
                    found[name] = Channel(bus["name"], bus["protocol"], int(device["address"]), place[1], int(place[2]), FORMATS[channel["type"]],
                                          float(channel.get("scale", 1)))
                else:
                    others.add(name)
    return found, others


class WireLog:
    """What was read and written, by channel: [(nanoseconds, value)] in order of time."""

    def __init__(self, channels):
        self.read, self.written = collections.defaultdict(list), collections.defaultdict(list)
        self.by_device, self.heard = collections.defaultdict(list), collections.defaultdict(list)
        self.protocols = {channel.bus: channel.protocol for channel in channels.values()}
        for name, channel in channels.items():
            self.by_device[channel.bus, channel.unit].append((name, channel))

    def add_capture(self, file):
        columns = [word for field in FIELDS for word in ("-e", field)]
        done = subprocess.run(["tshark", "-r", file, "-T", "fields", "-E", "separator=;", *columns], capture_output=True, text=True, check=False)
        if done.returncode != 0 and "cut short" not in done.stderr:  # of a killed bridge
            raise SystemExit(f"{file}: {done.stderr.strip()}")
        self.add_rows(row.split(";") for row in done.stdout.splitlines())

    def add_rows(self, rows):
        """Adds the rows of one capture."""
        pending = collections.defaultdict(list)  # of a device: requests without a response
        heard = {}
        for frame in itertools.chain.from_iterable(frames_of(row, self.protocols.get(row[1])) for row in joined(rows)):
            heard[frame.bus] = (min(frame.at, heard.get(frame.bus, (frame.at,))[0]), frame.at)
            if frame.is_request:
                self._request(pending[frame.bus, frame.unit], frame)
            else:
                self._response(pending[frame.bus, frame.unit], frame)
        for bus, (first, last) in heard.items():
            self.heard[bus].append((first, last))

    def _request(self, pending, frame):
        pending[:] = [each for each in pending if frame.at - each.at < LATE] + [frame]
        code, first = frame.pdu[0], int.from_bytes(frame.pdu[1:3], "big")
        if code == WRITE_ONE:
            self._values(self.written, frame, "holding", first, frame.pdu[3:5])
        elif code == WRITE_MANY:
            self._values(self.written, frame, "holding", first, frame.pdu[6:])

    def _response(self, pending, frame):
        # A late response may be that of any pending request of its length: the values count for each.
        code = frame.pdu[0]
        fits = [each for each in pending if each.pdu[0] == code and each.sequence == frame.sequence
                and (code not in READS or 2 * int.from_bytes(each.pdu[3:5], "big") == len(frame.pdu) - 2)]
        for request in fits:
            if code in READS:
                self._values(self.read, frame, READS[code], int.from_bytes(request.pdu[1:3], "big"), frame.pdu[2:])
        if fits:
            pending.remove(fits[-1])

    def _values(self, log, frame, area, first, data):
        for name, channel in self.by_device[frame.bus, frame.unit]:
            begin, size = 2 * (channel.register - first), struct.calcsize(channel.format)
            if channel.area == area and 0 <= begin and begin + size <= len(data):
                log[name].append(Write(frame.at, struct.unpack_from(channel.format, data, begin)[0] * channel.scale))

    def sort(self):
        for log in (self.read, self.written):
            for entries in log.values():
                entries.sort()

    def covers(self, bus, begin, end):
        """Returns whether one capture has this time; a killed bridge loses its last frames."""
        return any(first <= begin and end <= last for first, last in self.heard[bus])


def joined(rows):
    """Yields the rows; one that was received has what was received before it since the last request, as a response may come in pieces."""
    before = {}
    for time, bus, flags, text in rows:
        text = text.replace(":", "")
        yield time, bus, flags, text
        is_request = bool(flags) and int(flags, 16) & 3 == 2
        if before.get(bus) and not is_request:
            yield time, bus, flags, before[bus] + text
        before[bus] = "" if is_request else before.get(bus, "") + text


def frames_of(row, protocol):
    """Yields the Modbus frames in a row of FIELDS; foreign characters may precede or follow them."""
    time, bus, flags, text = row
    data = bytes.fromhex(text)
    seconds, _, fraction = time.partition(".")
    at, is_request = int(seconds) * 10**9 + int(fraction.ljust(9, "0")[:9]), bool(flags) and int(flags, 16) & 3 == 2
    if protocol == "modbus-tcp":
        while len(data) > 7:
            end = 6 + int.from_bytes(data[4:6], "big")
            yield Frame(at, bus, is_request, data[6], int.from_bytes(data[:2], "big"), data[7:end])
            data = data[max(end, 7):]
    elif protocol == "modbus-rtu":
        begin = 0
        while begin < len(data):
            end = end_of_frame(data, begin, is_request)
            if end:
                yield Frame(at, bus, is_request, data[begin], 0, data[begin + 1:end - 2])
            begin = end or begin + 1


def end_of_frame(data, begin, is_request):
    """Returns the end of the frame that begins here, by the length of its function and its check; 0 if none does."""
    rest = data[begin:]
    if len(rest) < 5:
        return 0
    if rest[1] in READS:
        length = 8 if is_request else 5 + rest[2]
    elif rest[1] == WRITE_MANY and is_request:
        length = 9 + (rest[6] if len(rest) > 6 else 0)
    else:
        length = 8 if rest[1] in (WRITE_ONE, WRITE_MANY) else 5  # of an exception
    return begin + length if length <= len(rest) and crc(rest[:length]) == 0 else 0


def crc(data):
    """Returns 0 for a frame with its check (MODBUS over Serial Line 1.02, 6.2.2)."""
    register = 0xFFFF
    for byte in data:
        register ^= byte
        for _ in range(8):
            register = register >> 1 ^ (0xA001 if register & 1 else 0)
    return register


def same(one, other):
    return one == other or abs(one - other) <= 1e-9 * max(abs(one), abs(other))


class Checker:
    def __init__(self, channels, wire, silent=10.0, restarts=0):
        self.channels, self.wire, self.silent, self.restarts = channels, wire, silent * 1e9, restarts
        self.failures, self.counts = [], collections.Counter()

    def fail(self, rule, text):
        self.failures.append(f"{rule}: {text}")

    def check_samples(self, station, samples):
        last, restarts = {}, collections.Counter()
        for sample in samples:
            if "event" in sample:  # `fieldcast watch` was too slow, or the bridge was killed
                self.counts[sample["event"]] += 1
                continue
            name = f"{sample['bus']}/{sample['device']}/{sample['channel']}"
            at, sequence, good = int(sample["acquired_at"]), int(sample["sequence"]), sample["quality"] == "GOOD"
            before = last.get(name)
            self.counts["samples"] += 1
            if before:
                restarted = sequence <= before[0]
                restarts[name] += restarted
                # A sample that is not GOOD repeats the time of the last value, and has none before the first one.
                if restarts[name] > self.restarts or (good and at <= before[1] and (before[2] or at < before[1])):
                    self.fail("increasing", f"{station}: {name}: {sequence}, acquired at {at}, after {before[0]}, {before[1]}")
                if before[2] and good and at - before[1] > self.silent:
                    self.fail("not-silent", f"{station}: {name}: {(at - before[1]) / 1e9:.1f} s without a sample, while GOOD")
            last[name] = (sequence, max(at, before[1] if before else 0), good)
            if good:
                self._check_value(station, name, at, sample["value"])
        return last

    def _check_value(self, station, name, at, value):
        if name not in self.channels:
            self.counts["not_compared"] += 1
            return
        if not self.wire.covers(self.channels[name].bus, at - 1000, at - 1000):  # captures have microseconds
            self.counts["not_captured"] += 1
            return
        reads = self.wire.read[name]
        first = bisect.bisect_left(reads, (at - NEAR,))
        near = [read.value for read in reads[first:bisect.bisect_right(reads, (at + NEAR, float("inf")))]]
        self.counts["values_compared"] += 1
        if not any(same(float(value), each) for each in near):
            self.fail("good-is-true", f"{station}: {name}: {value} at {at} is GOOD; the wire had {near[:5]}")

    def check_commands(self, commands):
        for command in commands:
            name, value, results = command["channel"], float(command["value"]), command["results"]
            self.counts["commands"] += 1
            if results is not None and len(results) != 1:
                self.fail("one-result", f"{name} = {value}: {len(results)} results")
            if not self.wire.covers(self.channels[name].bus, command["invoked_at"], command["returned_at"]):
                self.counts["commands_not_captured"] += 1
                continue
            writes = [write for write in self.wire.written[name] if same(write.value, value)]
            state = results[0]["state"] if results else "unknown"
            self.counts["commands_" + state.replace(" ", "_")] += 1
            if state == "done":
                inside = [write for write in writes if command["invoked_at"] <= write.at + 1000 and write.at <= command["returned_at"]]
                if not writes or len(writes) != len(inside):
                    self.fail("done-was-written", f"{name} = {value}: {len(writes)} times on the wire, {len(inside)} of them in its time")
            elif state in ("rejected", "expired") and writes:
                self.fail("not-written", f"{name} = {value} is {state}, and was written at {writes[0].at}")
            for first, second in itertools.pairwise(writes):
                if not any(first.at < read.at < second.at and not same(read.value, value) for read in self.wire.read[name]):
                    self.fail("written-again", f"{name} = {value}: at {first.at} and {second.at}, and the device did not show another value")


def lines_of(name):
    with open(name, encoding="utf-8") as file:
        for text in file:
            try:
                yield json.loads(text)
            except ValueError:  # the last line of a killed program
                continue


def check(config, samples, commands, captures, silent=10.0, restarts=0):
    """Returns (violations, counts)."""
    with open(config, encoding="utf-8") as file:
        channels, _ = channels_of(file.read())
    wire = WireLog(channels)
    for name in captures:
        wire.add_capture(name)
    wire.sort()
    checker = Checker(channels, wire, silent, restarts)
    for name in samples:
        checker.check_samples(name, lines_of(name))
    checker.check_commands([command for name in commands for command in lines_of(name)])
    counts = {**checker.counts, "reads": sum(map(len, wire.read.values())), "writes": sum(map(len, wire.written.values()))}
    return checker.failures, counts


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--config", required=True)
    parser.add_argument("--samples", nargs="*", default=[])
    parser.add_argument("--commands", nargs="*", default=[])
    parser.add_argument("--capture", nargs="*", default=[])
    parser.add_argument("--silent", type=float, default=10.0)
    parser.add_argument("--restarts", type=int, default=0)
    options = parser.parse_args()
    failures, counts = check(options.config, options.samples, options.commands, options.capture, options.silent, options.restarts)
    for failure in failures:
        print(f"FAIL {failure}")
    print(json.dumps(counts))
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
