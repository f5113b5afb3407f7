"""Progress line of a Python bench on standard error, shown only on a terminal. tools/progress is the C++ version.

    with Progress("measuring", 30) as progress:       duration in seconds
        while working():
            progress.show()

    wait("settling", 15)
"""

import os
import shutil
import sys
import time

STEP_SECONDS = 0.25


class Progress:
    def __init__(self, what, seconds, parts=None):
        """`parts`: total for the argument of show(); without it, the progress follows the clock."""
        self.what, self.seconds, self.parts = what, seconds, parts
        self.began = self.next = time.monotonic()
        self.seen = sys.stderr.isatty()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        if self.seen:
            print("\r\x1b[K", end="", file=sys.stderr, flush=True)

    def show(self, done=None):
        now = time.monotonic()
        if not self.seen or now < self.next:
            return
        self.next = now + STEP_SECONDS
        elapsed = now - self.began
        share = min(1, elapsed / self.seconds) if done is None else done / self.parts
        left = f", {elapsed / share - elapsed:.0f}s left" if share > 0 and elapsed > 0.5 else ""
        columns = os.get_terminal_size(sys.stderr.fileno()).columns or shutil.get_terminal_size().columns
        how_far = f"{100 * share:.0f} %{left}"
        line = f"{self.what}: {how_far}"
        print("\r\x1b[K" + (line if len(line) < columns else how_far)[:columns - 1], end="", file=sys.stderr, flush=True)


def wait(what, seconds):
    with Progress(what, seconds) as progress:
        end = time.monotonic() + seconds
        while (left := end - time.monotonic()) > 0:
            progress.show()
            time.sleep(min(left, STEP_SECONDS) if progress.seen else left)
