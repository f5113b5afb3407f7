"""Tests the format of commit messages that tools/hooks/commit-msg enforces.

usage: commit_message_test.py SOURCE_DIR
"""

import os
import subprocess
import sys
import tempfile
import unittest

SOURCE_DIR = ""
BODY = "\n\nA device that reports busy responds a moment later, so that a refusal\nfor 60 s hides values that are available.\n"


def faults(message):
    """Returns what the hook prints about `message`, empty if it accepts it."""
    with tempfile.NamedTemporaryFile("w", suffix=".txt") as file:
        file.write(message)
        file.flush()
        hook = subprocess.run([os.path.join(SOURCE_DIR, "tools/hooks/commit-msg"), file.name], capture_output=True, text=True)
    assert (hook.returncode == 0) == (hook.stderr == ""), hook
    return hook.stderr


class CommitMessage(unittest.TestCase):
    def test_a_subject_with_an_area_and_a_body_is_accepted(self):
        self.assertEqual(faults("bus: retry a busy device" + BODY), "")
        self.assertEqual(faults("bus, core/plan: retry a busy device" + BODY), "")
        self.assertEqual(faults("dds: GAP messages reach the library as heartbeats" + BODY), "")

    def test_comments_and_the_diff_of_a_verbose_commit_do_not_count(self):
        self.assertEqual(faults("bus: retry a busy device" + BODY + "# " + "x" * 90 + "\n"), "")
        self.assertEqual(faults("bus: retry a busy device" + BODY + "# ------------------------ >8 ------------------------\n" + "y" * 90), "")

    def test_a_long_subject_is_refused(self):
        self.assertEqual(faults("bus: " + "x" * 67 + BODY), "")
        self.assertIn("has 73 characters", faults("bus: " + "x" * 68 + BODY))

    def test_a_subject_without_an_area_or_with_a_full_stop_is_refused(self):
        self.assertIn("area: what changes", faults("Retry a busy device" + BODY))
        self.assertIn("full stop", faults("bus: retry a busy device." + BODY))

    def test_a_missing_body_or_empty_line_is_refused(self):
        self.assertIn("body is missing", faults("bus: retry a busy device\n"))
        self.assertIn("line 2 must be empty", faults("bus: retry a busy device\nA device that reports busy.\n"))
        self.assertIn("empty", faults("# only a comment\n"))

    def test_a_long_line_of_the_body_is_refused_but_a_link_is_not(self):
        self.assertIn("has 80 characters", faults("bus: retry a busy device\n\n" + "w" * 80 + "\n"))
        self.assertEqual(faults("bus: retry a busy device\n\nhttps://example.org/" + "w" * 80 + "\n"), "")

    def test_what_git_writes_itself_is_accepted(self):
        self.assertEqual(faults("Merge branch 'x'\n"), "")
        self.assertEqual(faults("fixup! bus: retry a busy device\n"), "")


if __name__ == "__main__":
    SOURCE_DIR = sys.argv[1]
    unittest.main(argv=sys.argv[:1], verbosity=2)
