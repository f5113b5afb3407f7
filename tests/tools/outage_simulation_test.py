"""Tests the simulation of the time after an outage against cases that can be computed by hand.

usage: outage_simulation_test.py SOURCE_DIR
"""

import os
import sys
import unittest

sys.path.insert(0, os.path.join(sys.argv[1], "tools", "bench"))
from outage_simulation import connected_at, options_of, quantile, simulate  # noqa: E402


def simulated(*words):
    return simulate(options_of(words))


class Simulation(unittest.TestCase):
    def test_a_thin_uplink_is_filled(self):
        """40 of 100 kB/s are for live samples; 5000 * (50 * 6.6 + 10 * 8) bytes wait."""
        done, _, _, connects = simulated("--sites", "1", "--samples", "5000", "--outage", "60", "--uplink", "100")
        self.assertAlmostEqual(done[0] - connects[0], 5000 * ((50 + connects[0]) * 6.6 + 10 * 8) / 60_000, delta=2)

    def test_live_samples_wait_for_the_target_of_the_window_at_most(self):
        _, delays, _, _ = simulated("--sites", "1", "--samples", "5000", "--outage", "60", "--uplink", "100", "--late-after", "0")
        self.assertLess(max(delays), 1000 * (0.25 + 16 / 100 + 0.1))

    def test_first_they_wait_for_the_live_ones_of_the_outage(self):
        """10 s of 40 kB/s, on a line of 100 kB/s."""
        _, delays, _, _ = simulated("--sites", "1", "--samples", "5000", "--outage", "60", "--uplink", "100")
        self.assertAlmostEqual(max(delays), 4050, delta=100)

    def test_without_the_window_they_wait_for_the_late_ones(self):
        _, delays, _, _ = simulated("--sites", "1", "--samples", "5000", "--outage", "60", "--uplink", "100", "--late-window", "0")
        self.assertGreater(quantile(delays, 0.5), 5000)

    def test_a_centre_that_is_too_slow_gets_a_queue(self):
        """Ten sites need 0.23 of 0.1 cores."""
        _, _, queue, _ = simulated("--sites", "10", "--samples", "100000", "--outage", "1", "--uplink", "2000", "--cores", "0.1")
        self.assertGreater(queue, 0.5)

    def test_connections_wait_for_the_centre(self):
        class Draw:
            @staticmethod
            def uniform(_, high):
                return high
        self.assertAlmostEqual(max(connected_at(10, 10, Draw)), 2.5)
        self.assertEqual(max(connected_at(100, 10, Draw)), float("inf"), "all attempts wait longer than their limit")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
