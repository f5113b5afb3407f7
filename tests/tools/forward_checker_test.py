"""Tests the checker and the decoder of the campaign of fieldcast-forward: a fault in a stream must be reported."""

import unittest

from forward_checker import Checker, Window
from forward_faults import NODE, Fault, schedule
from forward_messages import Batch, Malformed, catalogue_channels, name_of

TIMES = [100, 200, 300, 400, 500]


def checked(*arrivals, windows=()):
    """Result of a channel with five samples in epoch 7; each arrival: (sequences, late)."""
    checker = Checker()
    checker.publish("a", 7, TIMES)
    for sequences, late in arrivals:
        checker.arrive("a", 7, sequences, [TIMES[sequence - 1] for sequence in sequences], late)
    return checker.result(windows)


class Streams(unittest.TestCase):
    def test_a_complete_stream_has_no_violation(self):
        result = checked(([1, 2, 3], False), ([4, 5], False))
        self.assertEqual((result.published, result.arrived, result.duplicates, result.violations()), (5, 5, 0, []))

    def test_a_missing_sample_is_reported(self):
        result = checked(([1, 2, 4, 5], False))
        self.assertEqual(result.missing, [("a", 7, 3)])
        self.assertEqual(result.violations(), [("missing", 1, [("a", 7, 3)])])

    def test_the_last_samples_and_a_whole_channel_may_be_missing(self):
        self.assertEqual(checked(([1, 2, 3], False)).missing, [("a", 7, 4), ("a", 7, 5)])
        self.assertEqual(len(checked().missing), 5)

    def test_a_doubled_sample_is_counted_and_removed(self):
        result = checked(([1, 2, 3], False), ([2, 3, 4, 5], False))
        self.assertEqual((result.arrived, result.duplicates, result.violations()), (5, 2, []))

    def test_late_samples_of_a_refilled_gap_may_follow_newer_late_ones(self):
        refill = Window(150, 250, "the forwarder did not run")
        for late, expected in ((True, ([], 1)), (False, ([("a", 7, 2)], 0))):
            checker = Checker()
            checker.publish("a", 7, [100, 200, 300, 400])
            for sequence in (1, 3, 4, 2):
                checker.arrive("a", 7, [sequence], [100 * sequence], late)
            result = checker.result([], [refill])
            self.assertEqual((result.reordered, result.refilled), expected)

    def test_a_reordered_sample_is_reported(self):
        result = checked(([1, 3, 2, 4, 5], False))
        self.assertEqual(result.reordered, [("a", 7, 2)])

    def test_late_samples_have_an_order_of_their_own(self):
        result = checked(([1, 4], False), ([2, 3], True), ([5], False))
        self.assertEqual((result.arrived, result.late, result.violations()), (5, 2, []))
        self.assertEqual(checked(([1, 4], False), ([3, 2], True), ([5], False)).reordered, [("a", 7, 2)])

    def test_epochs_ascend(self):
        checker = Checker()
        for epoch in (7, 8):
            checker.publish("a", epoch, TIMES[:1])
        for epoch in (8, 7):
            checker.arrive("a", epoch, [1], [100], False)
        self.assertEqual(checker.result([]).reordered, [("a", 7, 1)])

    def test_a_sample_that_was_not_published_is_reported(self):
        checker = Checker()
        checker.publish("a", 7, TIMES)
        checker.arrive("a", 7, [1, 2, 3, 4, 5, 6], [*TIMES, 600], False)
        checker.arrive("a", 8, [1], [100], False)
        checker.arrive("b", 7, [1], [100], False)
        self.assertEqual(checker.result([]).unknown, [("a", 7, 6), ("a", 8, 1), ("b", 7, 1)])

    def test_a_sample_with_another_time_is_reported_and_missing(self):
        checker = Checker()
        checker.publish("a", 7, TIMES)
        checker.arrive("a", 7, [1, 2, 3, 4, 5], [100, 200, 301, 400, 500], False)
        result = checker.result([])
        self.assertEqual((result.unknown, result.missing), ([("a", 7, 3)], [("a", 7, 3)]))

    def test_missing_samples_in_a_window_are_counted_apart(self):
        result = checked(([1, 5], False), windows=[Window(150, 300, "killed")])
        self.assertEqual((dict(result.excused), result.missing), ({"killed": 2}, [("a", 7, 4)]))

    def test_more_than_two_gaps_in_a_window_are_a_violation(self):
        whole = [Window(100, 500, "killed")]
        self.assertEqual(checked(([2, 4, 5], False), windows=whole).violations(), [])
        self.assertEqual(len(checked(([2, 4], False), windows=whole).scattered), 1)


def compared(stored, *arrivals, windows=()):
    """As checked(), with the sequences in the store of the bridge."""
    checker = Checker()
    checker.publish("a", 7, TIMES)
    checker.store("a", 7, [(sequence, TIMES[sequence - 1]) for sequence in stored])
    for sequences in arrivals:
        checker.arrive("a", 7, sequences, [TIMES[sequence - 1] for sequence in sequences], False)
    return checker.result(windows)


class Stores(unittest.TestCase):
    ALL = [1, 2, 3, 4, 5]

    def test_a_store_that_has_what_arrived_is_in_order(self):
        result = compared(self.ALL, self.ALL)
        self.assertEqual((result.stored, result.violations()), (5, []))

    def test_a_sample_that_arrived_must_be_stored_except_where_the_store_loses_samples(self):
        self.assertEqual(compared([1, 2, 4, 5], self.ALL).not_stored, [("a", 7, 3)])
        self.assertEqual(compared([1, 2, 4, 5], self.ALL, windows=[Window(300, 300, "killed")]).not_stored, [("a", 7, 3)])
        self.assertEqual(compared([1, 2, 4, 5], self.ALL, windows=[Window(300, 300, "killed", loses_stored=True)]).violations(), [])

    def test_a_stored_sample_must_arrive_although_the_window_excuses_others(self):
        window = Window(200, 400, "killed", unless_stored=True)
        result = compared([1, 3, 5], [1, 5], windows=[window])
        self.assertEqual((dict(result.excused), result.missing), ({"killed": 2}, [("a", 7, 3)]))

    def test_a_sample_is_stored_once_and_as_it_was_published(self):
        self.assertEqual(compared([1, 2, 2, 3, 4, 5], self.ALL).stored_wrong, [("a", 7, 2)])
        checker = Checker()
        checker.publish("a", 7, TIMES)
        checker.store("a", 7, [(1, 101), (6, 600)])
        checker.store("b", 7, [(1, 100)])
        checker.wrong_in_store("a", 7, 5)
        self.assertEqual(checker.result([]).stored_wrong, [("a", 7, 1), ("a", 7, 6), ("b", 7, 1), ("a", 7, 5)])


class Messages(unittest.TestCase):
    # Channels 1 and 3; one and two samples with the sequences 5, 7 and 8; two times.
    DATA = bytes.fromhex("0801 11 0700000000000000 19 0900000000000000"
                         "2204 01010101 2a02 0102 3203 0a0402 3a03 c80164 4203 000002 4a02 0403 7200"
                         .replace("7200", "720c 0000803f 00000040 00004040"))

    def test_a_batch_is_decoded(self):
        batch = Batch(self.DATA)
        self.assertEqual((batch.epoch, batch.catalogue, batch.channels), (7, 9, [(1, 1), (3, 2)]))
        self.assertEqual((batch.sequences, batch.times, batch.numbers()), ([5, 7, 8], [100, 100, 150], [1, 2, 3]))

    def test_a_cut_batch_and_another_schema_are_refused(self):
        for data in (self.DATA[:-1], self.DATA[:30], bytes.fromhex("0802"), b""):
            with self.assertRaises(Malformed):
                Batch(data)

    def test_names(self):
        self.assertEqual(name_of("press=2E1=20a"), "press.1 a")
        self.assertEqual(catalogue_channels(bytes.fromhex("0801 3203 0a0161 3206 0a0162 120163")), ["a", "b"])


class Faults(unittest.TestCase):
    def test_a_seed_gives_one_schedule(self):
        self.assertEqual(schedule(1, 600, 20, 3), schedule(1, 600, 20, 3))
        self.assertNotEqual(schedule(1, 600, 20, 3), schedule(2, 600, 20, 3))

    def test_two_nodes_are_never_down_together(self):
        for seed in range(50):
            down = sorted((fault.at, fault.end) for fault in schedule(seed, 600, 5, 3) if fault.kind == NODE)
            self.assertGreater(len(down), 2)
            for before, after in zip(down, down[1:]):
                self.assertGreaterEqual(after[0], before[1] + 10)

    def test_a_short_run_has_each_kind(self):
        for seed in range(50):
            faults = schedule(seed, 60, 3, 3)
            self.assertEqual({fault.kind for fault in faults}, {"node", "forwarder", "bridge", "cut"})
            self.assertTrue(all(isinstance(fault, Fault) and 0 < fault.at and fault.end < 50 for fault in faults), faults)


if __name__ == "__main__":
    unittest.main()
