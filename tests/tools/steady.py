"""Tests that measure real time, on a machine that stands still now and then: an overbooked host stops all of it for a moment.

What is measured in such a moment is the machine. A test that fails, and in whose time the machine stood still, is run again; one that
fails on a steady machine fails.
"""

import threading
import time
import unittest

TRIES = 4
STILL_SECONDS = 0.15  # what a scheduler takes from a thread that wants to run, on a machine that is merely busy, is less
TICK_SECONDS = 0.01


class Stillness:
    """Notes, in a thread of its own, when the machine stood still."""

    def __init__(self):
        self.moments = []  # (its end, how long)
        threading.Thread(target=self._tick, daemon=True).start()

    def _tick(self):
        last = time.monotonic()
        while True:
            time.sleep(TICK_SECONDS)
            now = time.monotonic()
            if now - last > STILL_SECONDS:
                self.moments.append((now, now - last))
            last = now

    def longest_since(self, moment):
        """Seconds; 0: the machine was steady since then."""
        return max((seconds for end, seconds in list(self.moments) if end >= moment), default=0)


def steadily(measure, excuses, stillness=None, now=time.monotonic):
    """What measure() returns; when it raises one of `excuses` and the machine stood still meanwhile, that of another try."""
    stillness = stillness or Stillness()
    for left in range(TRIES - 1, -1, -1):
        began = now()
        try:
            return measure()
        except excuses as error:
            still = stillness.longest_since(began)
            if not still or not left:
                raise
            print(f"the machine stood still for {still:.2f} s, once more: {str(error).splitlines()[0][:200]}", flush=True)


class OnASteadyMachine:
    """Put before unittest.TestCase: each of its tests is run again, with its setUp, as steadily() does."""

    stillness = None

    def run(self, result=None):
        result = result if result is not None else self.defaultTestResult()

        class Failed(Exception):
            pass

        last = None

        def attempt():
            nonlocal last
            last = unittest.TestResult()
            super(OnASteadyMachine, self).run(last)
            if not last.wasSuccessful():
                told = (last.failures + last.errors)[0][1].splitlines()[1:]  # behind "Traceback .."
                raise Failed(next(line for line in told if line and not line.startswith(" ")))

        result.startTest(self)
        try:
            steadily(attempt, Failed, self.stillness)
            for _, reason in last.skipped:
                result.addSkip(self, reason)
            if not last.skipped:
                result.addSuccess(self)
        except Failed:
            result.failures += last.failures
            result.errors += last.errors
        finally:
            result.stopTest(self)
        return result
