"""Repeats real-time tests if the machine was stalled, for example on an overbooked host.

A test that fails while the machine was stalled is repeated; one that fails on a steady machine
fails.
"""

import threading
import time
import unittest

TRIES = 4
STILL_SECONDS = 0.15  # longer than a scheduler delays a ready thread on a busy machine
TICK_SECONDS = 0.01


class Stillness:
    """Records, in its own thread, when the machine was stalled."""

    def __init__(self):
        self.moments = []  # (end, duration)
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
        """Returns the longest stall since `moment` in seconds; 0 if the machine was steady."""
        return max((seconds for end, seconds in list(self.moments) if end >= moment), default=0)


def steadily(measure, excuses, stillness=None, now=time.monotonic):
    """Returns measure(); repeats it if it raises one of `excuses` during a stall."""
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
    """Base class before unittest.TestCase: repeats each test with its setUp as steadily() does."""

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
                told = (last.failures + last.errors)[0][1].splitlines()[1:]
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
