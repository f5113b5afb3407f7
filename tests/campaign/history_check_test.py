"""Tests that the checker of histories finds each broken rule, and nothing in a history that keeps them."""

import struct
import unittest

from history_check import Checker, WireLog, channels_of, crc

CONFIG = """
buses:
  - name: line
    protocol: modbus-rtu
    devices:
      - name: mill
        address: 1
        channels:
          - { name: power, at: "holding:10", type: int32 }
          - { name: speed, at: "holding:12", type: uint16, scale: 0.1 }
          - { name: running, at: "coil:1", type: bool }
"""
CHANNELS, OTHERS = channels_of(CONFIG)
POWER = "line/mill/power"
SECOND = 10**9
START = 1_000 * SECOND


def framed(pdu):
    body = bytes([1]) + pdu
    return body + struct.pack("<H", crc(body))


def row(at, is_request, data):
    return [f"{at // SECOND}.{at % SECOND:09}", "line", "0x00000002" if is_request else "0x00000001", data.hex()]


def read(at, power, speed=0, before=b"", truncated=0):
    """Returns the rows of a request at `at` and its response 10 ms later."""
    response = framed(struct.pack(">BBiH", 3, 6, power, speed))
    return [row(at, True, framed(struct.pack(">BHH", 3, 10, 3))), row(at + SECOND // 100, False, before + response[:len(response) - truncated])]


def write(at, power):
    return [row(at, True, framed(struct.pack(">BHHBi", 16, 10, 2, 4, power))), row(at + SECOND // 100, False, framed(struct.pack(">BHH", 16, 10, 2)))]


def sample(at, value, sequence, quality="GOOD", channel="power"):
    return {"bus": "line", "device": "mill", "channel": channel, "value": value, "quality": quality, "acquired_at": at + SECOND // 100 if at else 0,
            "sequence": sequence}


# So that the capture has the time of the commands.
AROUND = [*read(START - SECOND, 1), *read(START + 5 * SECOND, 2)]



def around(rows):
    return [*AROUND[:2], *rows, *AROUND[2:]]


def command(value, invoked, returned, *states):
    return {"channel": POWER, "value": value, "invoked_at": invoked, "returned_at": returned, "results": [{"state": state} for state in states]}


def broken(rows, samples=(), commands=(), **limits):
    """Returns the names of the broken rules, and the counts."""
    wire = WireLog(CHANNELS)
    wire.add_rows(rows)
    wire.sort()
    checker = Checker(CHANNELS, wire, **limits)
    checker.check_samples("station", samples)
    checker.check_commands(commands)
    return [failure.partition(":")[0] for failure in checker.failures], checker.counts


class Samples(unittest.TestCase):
    ROWS = [*read(START, 7, 15), *read(START + SECOND // 2, 8, 16), *read(START + SECOND, 9, 17)]

    def test_a_history_that_keeps_the_rules(self):
        samples = [sample(START, 7, 1), sample(START, 1.5, 1, channel="speed"), sample(START + SECOND // 2, 8, 2)]
        found, counts = broken(self.ROWS, samples)
        self.assertEqual((found, counts["values_compared"]), ([], 3))

    def test_a_good_value_that_no_device_gave(self):
        self.assertEqual(broken(self.ROWS, [sample(START, 8, 1)])[0], ["good-is-true"])

    def test_a_value_that_is_not_good_is_not_compared(self):
        self.assertEqual(broken(self.ROWS, [sample(START, 8, 1, "BAD_TIMEOUT")])[0], [])

    def test_an_old_value_with_a_new_time(self):
        self.assertEqual(broken(self.ROWS, [sample(START + SECOND // 2, 7, 1)])[0], ["good-is-true"])

    def test_a_broken_response_is_no_proof(self):
        self.assertEqual(broken([*read(START, 7, truncated=1), *read(START + SECOND // 2, 8)], [sample(START, 7, 1)])[0], ["good-is-true"])

    def test_a_response_behind_foreign_characters_is(self):
        self.assertEqual(broken([*read(START, 7, before=b"\x01\x93\x00"), *read(START + SECOND // 2, 8)], [sample(START, 7, 1)])[0], [])

    def test_a_response_in_two_pieces_is(self):
        whole = read(START, 7)
        half = len(whole[1][3]) // 4 * 2
        pieces = [whole[0], [*whole[1][:3], whole[1][3][:half]], [*whole[1][:3], whole[1][3][half:]]]
        self.assertEqual(broken([*pieces, *read(START + SECOND // 2, 8)], [sample(START, 7, 1)])[0], [])

    def test_frames_that_a_killed_bridge_lost(self):
        found, counts = broken(self.ROWS, [sample(START + 2 * SECOND, 10, 1)])
        self.assertEqual((found, counts["not_captured"]), ([], 1))

    def test_a_sequence_that_falls_back(self):
        samples = [sample(START, 7, 2), sample(START + SECOND // 2, 8, 1)]
        self.assertEqual(broken(self.ROWS, samples)[0], ["increasing"])
        self.assertEqual(broken(self.ROWS, samples, restarts=1)[0], [])

    def test_a_time_that_falls_back(self):
        self.assertEqual(broken(self.ROWS, [sample(START + SECOND // 2, 8, 1), sample(START, 7, 2)])[0], ["increasing"])

    def test_a_sample_twice(self):
        self.assertEqual(broken(self.ROWS, [sample(START, 7, 1), sample(START, 7, 1)])[0], ["increasing"])

    def test_a_channel_that_is_silent_while_good(self):
        rows = [*self.ROWS, *read(START + 20 * SECOND, 10), *read(START + 21 * SECOND, 11)]
        good, bad = sample(START, 7, 1), sample(START + SECOND // 2, 8, 2, "BAD_TIMEOUT")
        self.assertEqual(broken(rows, [good, sample(START + 20 * SECOND, 10, 2)])[0], ["not-silent"])
        self.assertEqual(broken(rows, [good, bad, sample(START + 20 * SECOND, 10, 3)])[0], [])

    def test_other_types_are_counted(self):
        found, counts = broken(self.ROWS, [sample(START, True, 1, channel="running")])
        self.assertEqual((found, counts["not_compared"], OTHERS), ([], 1, {"line/mill/running"}))


class Commands(unittest.TestCase):
    LATER = START + SECOND

    def test_commands_that_keep_the_rules(self):
        rows = [*write(START, 100), *read(START + SECOND // 2, 100), *write(self.LATER, 200)]
        commands = [command(100, START - 1, START + SECOND // 5, "done"), command(200, self.LATER - 1, self.LATER + SECOND, "done"),
                    command(300, START, self.LATER, "expired")]
        self.assertEqual(broken(around(rows), commands=commands)[0], [])

    def test_no_result_and_two(self):
        self.assertEqual(broken([], commands=[command(100, START, self.LATER), command(200, START, self.LATER, "expired", "expired")])[0],
                         ["one-result", "one-result"])

    def test_a_caller_that_was_killed_has_none(self):
        self.assertEqual(broken(around(write(START, 100)), commands=[{**command(100, START, self.LATER), "results": None}])[0], [])

    def test_done_but_never_written(self):
        self.assertEqual(broken(AROUND, commands=[command(100, START, self.LATER, "done")])[0], ["done-was-written"])

    def test_done_before_it_was_written(self):
        self.assertEqual(broken(around(write(self.LATER, 100)), commands=[command(100, START, START + 10, "done")])[0], ["done-was-written"])

    def test_expired_or_rejected_but_written(self):
        for state in ("expired", "rejected"):
            self.assertEqual(broken(around(write(START + 5, 100)), commands=[command(100, START, self.LATER, state)])[0], ["not-written"])

    def test_a_write_that_is_repeated_blindly(self):
        commands = [command(100, START - 1, self.LATER, "done")]
        again = write(START + SECOND // 2, 100)
        self.assertEqual(broken(around([*write(START, 100), *again]), commands=commands)[0], ["written-again"])
        self.assertEqual(broken(around([*write(START, 100), *read(START + SECOND // 4, 99), *again]), commands=commands)[0], [])

    def test_a_command_beyond_the_capture_is_counted(self):
        found, counts = broken(read(START, 1), commands=[command(100, START, self.LATER, "done")])
        self.assertEqual((found, counts["commands_not_captured"]), ([], 1))

    def test_a_command_that_overtook_an_earlier_one(self):
        rows = [*write(START + 10, 200), *write(self.LATER, 100)]
        commands = [command(100, START - 20, START - 10, "done"), command(200, START, START + SECOND // 2, "done")]
        self.assertEqual(broken(around(rows), commands=commands)[0], ["done-was-written"])


if __name__ == "__main__":
    unittest.main()
