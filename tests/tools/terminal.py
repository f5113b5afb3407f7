"""Runs a program on a pseudo-terminal and shows its screen, emulated by pyte.

    with Terminal(["fieldcast", "watch"], columns=80, rows=24) as terminal:
        terminal.wait_for("GOOD")
        terminal.press("/")
"""

import fcntl
import os
import pty
import re
import select
import signal
import struct
import termios
import time

import pyte

UP, DOWN, RIGHT, LEFT = "\x1bOA", "\x1bOB", "\x1bOC", "\x1bOD"
ESCAPE, ENTER, F1, F6 = "\x1b", "\r", "\x1bOP", "\x1b[17~"
WAIT_SECONDS = 20


class Screen(pyte.Screen):
    """Adds what xterm supports and pyte does not: scrolling a region, repeating a character."""

    def scroll_up(self, count=1):
        self._at_margin(lambda margins: margins.bottom, self.index, count)

    def scroll_down(self, count=1):
        self._at_margin(lambda margins: margins.top, self.reverse_index, count)

    def _at_margin(self, margin, step, count):
        row = self.cursor.y
        self.cursor.y = margin(self.margins or pyte.screens.Margins(0, self.lines - 1))
        for _ in range(count or 1):
            step()
        self.cursor.y = row

    def repeat(self, count=1):
        self.draw(self.buffer[self.cursor.y][self.cursor.x - 1].data * (count or 1))


class Stream(pyte.ByteStream):
    csi = {**pyte.ByteStream.csi, "S": "scroll_up", "T": "scroll_down", "b": "repeat"}
    events = pyte.ByteStream.events | {"scroll_up", "scroll_down", "repeat"}


class Terminal:
    def __init__(self, command, columns=80, rows=24, **environment):
        self.command = command
        self.environment = {**os.environ, "TERM": "xterm-256color", "LANG": "C.UTF-8", **environment}
        for name in [name for name, value in self.environment.items() if value is None]:
            del self.environment[name]
        self.said = b""
        self.screen = Screen(columns, rows)
        self.stream = Stream(self.screen)
        self.code = None

    def __enter__(self):
        status_in, self.status_out = os.pipe()[::-1]
        self.leader, self.master = pty.fork()
        if self.leader == 0:
            self._lead(status_in)
        os.close(status_in)
        self.modes = termios.tcgetattr(self.master)
        self.pid = int(os.read(self.status_out, 16))
        return self

    def _lead(self, status):
        """Leads the session like a shell; otherwise no process could continue after Ctrl-Z."""
        try:
            self._set_size(0)
            signal.signal(signal.SIGTTOU, signal.SIG_IGN)
            pid = os.fork()
            if pid == 0:
                os.setpgid(0, 0)
                os.tcsetpgrp(0, os.getpid())
                signal.signal(signal.SIGTTOU, signal.SIG_DFL)
                os.write(status, f"{os.getpid():<16}".encode())
                os.execvpe(self.command[0], self.command, self.environment)
            code = os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1])
            os.tcsetpgrp(0, os.getpid())
            os.write(status, str(code).encode())
            os.read(0, 1)  # keeps the terminal until the test has checked it
        finally:
            os._exit(1)

    def __exit__(self, *_):
        if self.code is None:
            os.kill(self.pid, signal.SIGKILL)
        os.kill(self.leader, signal.SIGKILL)
        os.waitpid(self.leader, 0)
        os.close(self.master)
        os.close(self.status_out)

    def _set_size(self, descriptor):
        fcntl.ioctl(descriptor, termios.TIOCSWINSZ, struct.pack("HHHH", self.screen.lines, self.screen.columns, 0, 0))

    def read(self, seconds=0.05):
        """Reads the program's output for so many seconds; returns False if it has ended."""
        end = time.monotonic() + seconds
        while (left := end - time.monotonic()) > 0:
            if not select.select([self.master], [], [], left)[0]:
                break
            if not self._take():
                return False
        return True

    def _take(self):
        try:
            text = os.read(self.master, 65536)
        except OSError:  # the other end is closed
            return False
        self.said += text
        self.stream.feed(text)
        return True

    def read_once(self, seconds):
        """Reads the next output as soon as it arrives. fed_seconds: the time to show it."""
        select.select([self.master], [], [], seconds)
        began = time.monotonic()
        while select.select([self.master], [], [], 0)[0] and self._take():
            pass
        self.fed_seconds = time.monotonic() - began

    def text(self):
        return "\n".join(line.rstrip() for line in self.screen.display)

    def lines(self):
        return [line.rstrip() for line in self.screen.display]

    def wait_for(self, pattern, seconds=WAIT_SECONDS):
        """Waits until the screen matches; returns its text."""
        return self.wait_until(lambda text: re.search(pattern, text), pattern, seconds)

    def wait_until(self, condition, what, seconds=WAIT_SECONDS):
        end = time.monotonic() + seconds
        while not condition(self.text()):
            if time.monotonic() > end:
                raise AssertionError(f"not within {seconds} s: {what}\n{self.text()}")
            if not self.read():
                raise AssertionError(f"it ended; not seen: {what}\n{self.text()}")
        return self.text()

    def press(self, *keys):
        for key in keys:
            os.write(self.master, key.encode())

    def click(self, row, column):
        self.press(f"\x1b[<0;{column + 1};{row + 1}M", f"\x1b[<0;{column + 1};{row + 1}m")

    def resize(self, columns, rows):
        self.screen.resize(rows, columns)
        self._set_size(self.master)

    def modes_now(self):
        return termios.tcgetattr(self.master)

    def is_stopped(self):
        with open(f"/proc/{self.pid}/stat", encoding="utf-8") as file:
            return file.read().rsplit(")", 1)[1].split()[0] == "T"

    def ignores(self, number):
        with open(f"/proc/{self.pid}/status", encoding="utf-8") as file:
            ignored = int(re.search(r"SigIgn:\s*(\w+)", file.read()).group(1), 16)
        return bool(ignored >> (number - 1) & 1)

    def cursor_is_hidden(self):
        return self.screen.cursor.hidden

    def wait_for_end(self, seconds=WAIT_SECONDS):
        """Waits for the end and returns the exit code; negative for a signal."""
        end = time.monotonic() + seconds
        while not select.select([self.status_out], [], [], 0)[0]:
            self.read()
            if time.monotonic() > end:
                raise AssertionError(f"it does not end\n{self.text()}")
        self.code = int(os.read(self.status_out, 16))
        while select.select([self.master], [], [], 0)[0] and self.read(0.01):
            pass
        return self.code
