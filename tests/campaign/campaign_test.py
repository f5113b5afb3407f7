"""Tests the driver of the fault campaign with small parts.

usage: campaign_test.py
"""

import io
import json
import os
import signal
import subprocess
import sys
import tempfile
import textwrap
import time
import unittest
from contextlib import redirect_stderr, redirect_stdout

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import campaign  # noqa: E402


def part(name, code, share=0.5):
    """A part whose program is `code`; `seconds` and `seed` are its arguments."""
    return campaign.Part(name, share, "a part of the test",
                         lambda options, seconds, seed: [[sys.executable, "-u", "-c", textwrap.dedent(code), str(seconds), str(seed)]])


HOLDS = part("holds", "import json, sys; print(json.dumps({'runs': 1, 'deep': {'a': int(sys.argv[2])}}))")
FAILS = part("fails", "print('FAIL it does not hold'); print('{\"runs\": 1}'); raise SystemExit(1)")
BREAKS = part("breaks", "raise SystemExit('a bad day')")


def run(parts, *words):
    """Returns exit code and report of a campaign of `parts`."""
    before, argv = campaign.PARTS, sys.argv
    campaign.PARTS, sys.argv = parts, ["campaign", "--minutes", "0.05", *words]
    out = io.StringIO()
    try:
        with redirect_stdout(out), redirect_stderr(io.StringIO()):
            code = campaign.main()
    finally:
        campaign.PARTS, sys.argv = before, argv
    return code, out.getvalue()


class Driver(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.counts = os.path.join(self.folder.name, "counts.json")

    def tearDown(self):
        self.folder.cleanup()

    def test_counts_are_added_over_runs(self):
        for _ in range(2):
            code, report = run([HOLDS], "--counts", self.counts, "--seed", "3")
            self.assertEqual(code, 0, report)
        with open(self.counts, encoding="utf-8") as file:
            self.assertEqual(json.load(file), {"holds": {"runs": 2, "deep": {"a": 6}}})
        self.assertIn("all held", report)

    def test_what_fails_is_in_the_report_and_in_the_exit_code(self):
        code, report = run([HOLDS, FAILS, BREAKS], "--files", self.folder.name)
        self.assertEqual(code, 1)
        self.assertIn("FAIL it does not hold", report)
        self.assertIn("a bad day", report)
        self.assertIn("holds: a part of the test: all held", report)

    def test_one_part_can_be_chosen(self):
        code, report = run([HOLDS, FAILS], "--part", "holds")
        self.assertEqual(code, 0)
        self.assertNotIn("fails", report)

    def test_a_part_that_does_not_end_is_ended(self):
        endless = part("endless", "import time; time.sleep(600)")
        endless.grace = 0.2
        began = time.monotonic()
        run([endless], "--files", self.folder.name)
        self.assertLess(time.monotonic() - began, 30)

    def test_an_interrupt_ends_it_immediately_with_the_report_so_far(self):
        program = os.path.join(os.path.dirname(os.path.abspath(__file__)), "campaign.py")
        slow = os.path.join(self.folder.name, "virtual_campaign")
        with open(slow, "w", encoding="utf-8") as file:
            file.write("#!/bin/sh\ntrap 'echo \"{\\\"days\\\": 7}\"; exit 0' INT\necho ready >&2\nwhile :; do sleep 0.1; done\n")
        os.chmod(slow, 0o755)
        process = subprocess.Popen([sys.executable, program, "--minutes", "5", "--part", "virtual", "--bin", self.folder.name],
                                   stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.assertIn("virtual: 0 of 300 s", process.stderr.readline())
        process.send_signal(signal.SIGINT)
        out, _ = process.communicate(timeout=20)
        self.assertEqual(process.returncode, 130, out)
        self.assertIn("ended by hand", out)


if __name__ == "__main__":
    unittest.main()
