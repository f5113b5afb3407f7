"""Tests the repetition of tests when the machine was stalled."""

import contextlib
import io
import unittest

from steady import OnASteadyMachine, TRIES, Stillness


class Machine:
    def __init__(self, seconds):
        self.seconds = seconds

    def longest_since(self, _):
        return self.seconds


def outcome(fails, still, reason=None):
    """Returns (successful, runs, skipped) of a test that fails the first `fails` times."""
    runs = []

    class Case(OnASteadyMachine, unittest.TestCase):
        stillness = Machine(still)

        def setUp(self):
            runs.append(None)
            if reason:
                self.skipTest(reason)

        def test(self):
            self.assertGreater(len(runs), fails)

    result = unittest.TestResult()
    with contextlib.redirect_stdout(io.StringIO()):
        Case("test").run(result)
    assert result.testsRun == 1
    return result.wasSuccessful(), len(runs), len(result.skipped)


class Steady(unittest.TestCase):
    def test_a_test_that_passes_runs_once(self):
        self.assertEqual(outcome(fails=0, still=0.3), (True, 1, 0))

    def test_a_failure_on_a_steady_machine_is_one(self):
        self.assertEqual(outcome(fails=1, still=0), (False, 1, 0))

    def test_a_failure_while_the_machine_stood_still_is_tried_again(self):
        self.assertEqual(outcome(fails=2, still=0.3), (True, 3, 0))

    def test_not_for_ever(self):
        self.assertEqual(outcome(fails=100, still=0.3), (False, TRIES, 0))

    def test_a_skipped_test_is_skipped(self):
        self.assertEqual(outcome(fails=0, still=0, reason="no network"), (True, 1, 1))

    def test_moments_before_the_test_do_not_count(self):
        stillness = Stillness()
        stillness.moments = [(10.0, 0.5), (20.0, 0.2)]
        self.assertEqual([stillness.longest_since(at) for at in (5, 15, 25)], [0.5, 0.2, 0])


if __name__ == "__main__":
    unittest.main()
