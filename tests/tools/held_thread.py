"""Stops a thread, to simulate a driver that hangs."""

import ctypes
import errno
import os
import unittest

from plant import wait_until

LIMIT = 60  # limit of the wait for the thread, in seconds


class HeldThread:
    """Holds a thread with ptrace(2). If the process ends meanwhile, look() reaps the thread."""

    ATTACH, DETACH, WALL = 16, 17, 0x40000000

    def __init__(self, process, name):
        self.libc = ctypes.CDLL(None, use_errno=True)
        self.thread = wait_until(lambda: self.find(process, name), LIMIT, f"no thread {name}")

    @staticmethod
    def find(process, name):
        for task in os.listdir(f"/proc/{process}/task"):
            try:
                with open(f"/proc/{process}/task/{task}/comm", encoding="utf-8") as file:
                    if file.read().strip() == name:
                        return int(task)
            except (FileNotFoundError, ProcessLookupError):  # it has just ended
                pass
        return None

    def _ptrace(self, request):
        if self.libc.ptrace(ctypes.c_long(request), ctypes.c_long(self.thread), None, None) != 0:
            raise OSError(ctypes.get_errno(), os.strerror(ctypes.get_errno()))

    def look(self):
        """Reaps the thread: a traced thread that has ended remains until its tracer waits for it.
        """
        try:
            os.waitpid(self.thread, self.WALL | os.WNOHANG)
        except ChildProcessError:
            pass

    def __enter__(self):
        try:
            self._ptrace(self.ATTACH)
        except OSError as error:
            raise unittest.SkipTest(f"ptrace: {error}") from error
        os.waitpid(self.thread, self.WALL)
        return self

    def __exit__(self, *_):
        try:
            self._ptrace(self.DETACH)
        except OSError as error:
            if error.errno != errno.ESRCH:
                raise
            self.look()
