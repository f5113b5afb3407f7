"""Simulates an RS-485 line with masters on pseudo-terminals and one Modbus RTU device. The bytes
of each reach all others at the pace of the line. Overlapping frames are garbled, and counted if
they are from two masters.

    with MultiDrop(folder, masters=2) as line:
        line.paths                    ports for the masters
        line.counts()                 frames per master, garbled, shortest silence between masters
"""

import heapq
import os
import select
import struct
import threading
import time
import tty

CHARACTER = 11 / 19200  # seconds, at 19200 8E1
ANSWER_AFTER = 0.003
CHUNK = 4  # characters that an adapter delivers together
DEVICE = -1


def crc(frame):
    value = 0xFFFF
    for byte in frame:
        value ^= byte
        for _ in range(8):
            value = value >> 1 ^ 0xA001 if value & 1 else value >> 1
    return struct.pack("<H", value)


class Transmission:
    def __init__(self, sender, master, data, start):
        self.master = master  # that sends, or is addressed
        self.sender, self.data, self.start = sender, bytearray(data), start
        self.end = start + len(data) * CHARACTER
        self.passed, self.garbled = 0, False


class MultiDrop:
    def __init__(self, folder, masters=2):
        self.paths, self._ends, self._slaves = [], [], []
        for index in range(masters):
            end, slave = os.openpty()
            tty.setraw(end)
            tty.setraw(slave)
            os.set_blocking(end, False)
            path = os.path.join(folder, f"master-{index}")
            os.symlink(os.ttyname(slave), path)
            self.paths.append(path)
            self._ends.append(end)
            # kept open: reading fails if no process has the terminal open
            self._slaves.append(slave)
        self._lock = threading.Lock()
        self._frames, self._garbled, self._last_master, self._silent_since = [0] * masters, 0, None, 0.0
        self._last_frame, self._shortest_turn = [0.0] * masters, None
        self._on_wire, self._agenda, self._stop, self._serial = [], [], False, 0
        self._thread = threading.Thread(target=self._run, daemon=True)

    def __enter__(self):
        self._thread.start()
        return self

    def __exit__(self, *_):
        self._stop = True
        self._thread.join()
        for descriptor in self._ends + self._slaves:
            os.close(descriptor)

    def counts(self):
        with self._lock:
            return {"frames": list(self._frames), "garbled": self._garbled, "shortest turn": self._shortest_turn,
                    "last frame": list(self._last_frame)}

    def _run(self):
        while not self._stop:
            wait = 0.02 if not self._agenda else max(0.0, min(0.02, self._agenda[0][0] - time.monotonic()))
            ready, _, _ = select.select(self._ends, [], [], wait)
            with self._lock:
                now = time.monotonic()
                for end in ready:
                    try:
                        data = os.read(end, 4096)
                    except OSError:
                        continue
                    self._transmit(self._ends.index(end), data, now)
                while self._agenda and self._agenda[0][0] <= now:
                    _, _, action, argument = heapq.heappop(self._agenda)
                    action(argument)

    def _at(self, instant, action, argument):
        self._serial += 1
        heapq.heappush(self._agenda, (instant, self._serial, action, argument))

    def _transmit(self, sender, data, now, master=None):
        own = [each for each in self._on_wire if each.sender == sender]
        start = max([now] + [each.end for each in own])
        made = Transmission(sender, sender if master is None else master, data, start)
        for other in self._on_wire:
            if other.sender == sender or other.end <= made.start or made.end <= other.start:
                continue
            # A device that responds late on a busy machine is not a fault of the masters.
            if made.master != other.master:
                self._garbled += 1
            made.garbled = other.garbled = True
        if sender != DEVICE:
            if self._last_master not in (None, sender):
                silence = 0.0 if self._on_wire else start - self._silent_since
                self._shortest_turn = min(silence, self._shortest_turn or silence)
            self._last_master = sender
            self._frames[sender] += 1
            self._last_frame[sender] = start
        self._on_wire.append(made)
        self._at(start + min(CHUNK, len(data)) * CHARACTER, self._pass, made)

    def _pass(self, one):
        part = bytes(one.data[one.passed:one.passed + CHUNK])
        if one.garbled:
            part = bytes(byte ^ 0x5A for byte in part)
        one.passed += CHUNK
        for index, end in enumerate(self._ends):
            if index != one.sender:
                try:
                    os.write(end, part)
                except BlockingIOError:
                    pass
        if one.passed < len(one.data):
            self._at(one.start + min(one.passed + CHUNK, len(one.data)) * CHARACTER, self._pass, one)
            return
        self._on_wire.remove(one)
        self._silent_since = one.end
        if one.sender != DEVICE and not one.garbled:
            self._at(one.end + ANSWER_AFTER, self._answer, (one.sender, bytes(one.data)))

    def _answer(self, asked):
        master, request = asked
        if len(request) != 8 or request[0] != 1 or request[1] != 3 or crc(request[:6]) != request[6:]:
            return
        count = struct.unpack(">H", request[4:6])[0]
        body = bytes([1, 3, 2 * count]) + b"\x00\x2a" * count
        self._transmit(DEVICE, body + crc(body), time.monotonic(), master)
