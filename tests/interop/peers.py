"""Shared by the interop tests: programs that print READY, a null-modem cable, and mbpoll."""

import contextlib
import ctypes
import ctypes.util
import fcntl
import itertools
import os
import re
import select
import socket
import struct
import subprocess
import termios
import threading
import time
import tty

DEADLINE = 30  # seconds; far above any normal duration, so that only a fault reaches it


class Program:
    def __init__(self, *command):
        self.command = [str(word) for word in command]
        self.process = subprocess.Popen(self.command, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        self.said = ""

    def wait_ready(self):
        end = time.monotonic() + DEADLINE
        while "READY" not in self.said:
            left = end - time.monotonic()
            if left <= 0 or not select.select([self.process.stdout], [], [], left)[0]:
                raise AssertionError(f"{self.command} did not say READY in {DEADLINE} s")
            data = os.read(self.process.stdout.fileno(), 4096)
            if not data:
                raise AssertionError(f"{self.command} ended: {self.process.stderr.read().decode()}")
            self.said += data.decode()
        return self

    def signal(self, number):
        self.process.send_signal(number)

    def stop(self):
        self.process.terminate()
        return self.wait()

    def wait(self):
        try:
            code = self.process.wait(DEADLINE)
        except subprocess.TimeoutExpired:
            self.process.kill()
            raise AssertionError(f"{self.command} did not end in {DEADLINE} s")
        finally:
            self.errors = self.process.stderr.read().decode()
            self.process.stdout.close()
            self.process.stderr.close()
        return code

    def __enter__(self):
        return self

    def __exit__(self, *_):
        if self.process.poll() is None:
            self.process.kill()
            self.process.wait()
        for pipe in (self.process.stdout, self.process.stderr):
            pipe.close()


class Cable:
    """Two terminals joined by a thread: bytes written to one are read from the other."""

    def __enter__(self):
        self.ends = [os.openpty(), os.openpty()]
        for master, slave in self.ends:
            tty.setraw(slave)
            os.set_blocking(master, False)
        self.left, self.right = (os.ttyname(slave) for _, slave in self.ends)
        self.wake, self.waker = os.pipe()
        self.thread = threading.Thread(target=self._pump)
        self.thread.start()
        return self

    def _pump(self):
        masters = [master for master, _ in self.ends]
        while True:
            readable = select.select(masters + [self.wake], [], [])[0]
            if self.wake in readable:
                return
            for master in readable:
                self._forward(os.read(master, 4096), master, masters[1 - masters.index(master)])

    def _forward(self, data, _, other):
        os.write(other, data)

    def __exit__(self, *_):
        os.write(self.waker, b"x")
        self.thread.join()
        for fd in [self.wake, self.waker] + [fd for end in self.ends for fd in end]:
            os.close(fd)


TCGETS2 = 0x802C542A  # Linux: struct termios2, with the speed in baud


class SerialCable(Cable):
    """A cable with the properties of a serial line: characters take their time, and arrive only
    with the same speed, parity and data bits; otherwise noise arrives. `asked` is what `left`
    sent.

    A pseudo-terminal drops PARENB, but keeps INPCK, which Fieldcast and libmodbus set with a parity.
    """

    def __enter__(self):
        self.asked = []
        return super().__enter__()

    @staticmethod
    def _settings(end):
        fields = struct.unpack("=4IB19s2I", fcntl.ioctl(end, TCGETS2, bytes(44)))
        checks, flags, baud = fields[0], fields[2], fields[7]
        return baud, checks & termios.INPCK, flags & (termios.CSIZE | termios.PARODD)

    def _forward(self, data, master, other):
        if master == self.ends[0][0]:
            self.asked.append(data)
        settings = self._settings(master)
        time.sleep(len(data) * 11 / settings[0])
        if self._settings(other) != settings:
            data = bytes(byte ^ 0x6B for byte in data)
        with contextlib.suppress(BlockingIOError):
            os.write(other, data)


_asked = itertools.count()


def settings_of(path):
    """Returns baud rate and whether there are two stop bits. A pseudo-terminal ignores data bits and parity."""
    line = os.open(path, os.O_RDWR | os.O_NOCTTY | os.O_NONBLOCK)
    try:
        settings = fcntl.ioctl(line, TCGETS2, bytes(44))
    finally:
        os.close(line)
    return struct.unpack_from("I", settings, 40)[0], bool(struct.unpack_from("I", settings, 8)[0] & termios.CSTOPB)


def free_port():
    """Returns an unused port below the kernel's ephemeral range."""
    for _ in range(12000):
        port = 20000 + (os.getpid() * 7 + next(_asked)) % 12000
        with socket.socket() as probe:
            try:
                probe.bind(("127.0.0.1", port))
                return port
            except OSError:
                continue
    raise OSError("every port from 20000 to 31999 is taken")


TABLES = {"coil": "0", "input": "1", "input-register": "3", "holding": "4"}


class Mbpoll:
    """An independent master. place: a serial path (8N1), or 127.0.0.1 with a port."""

    def __init__(self, place, port=None, baud=115200, unit=1, timeout=5):
        self.place = place
        self.link = ["-m", "tcp", "-p", str(port)] if port else ["-m", "rtu", "-b", str(baud), "-d", "8", "-P", "none", "-s", "1"]
        self.unit, self.timeout = unit, timeout

    def _run(self, area, first, *more):
        command = ["mbpoll", *self.link, "-a", str(self.unit), "-0", "-1", "-q", "-o", str(self.timeout), "-t", TABLES[area], "-r", str(first)]
        done = subprocess.run(command + [str(word) for word in more], stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                              timeout=DEADLINE, text=True)
        return done.stdout

    def read(self, area, first, count):
        """Returns the values, or the text of the failure."""
        text = self._run(area, first, "-c", count, self.place)
        values = [int(value) for value in re.findall(r"^\[\d+\]:\s+(-?\d+)", text, re.M)]
        return values if len(values) == count else text

    def write(self, area, first, *values):
        """Returns True, or the text of the failure."""
        text = self._run(area, first, self.place, *values)
        return True if f"Written {len(values)} references" in text else text


class LibmodbusClient:
    """A client by libmodbus, which this process loads. Modbus TCP at 127.0.0.1."""

    def __init__(self, port, unit, timeout=5):
        self.library = ctypes.CDLL(ctypes.util.find_library("modbus"), use_errno=True)
        self.library.modbus_new_tcp.restype = self.library.modbus_strerror.restype = ctypes.c_void_p
        self.context = ctypes.c_void_p(self.library.modbus_new_tcp(b"127.0.0.1", port))
        self.library.modbus_set_slave(self.context, unit)
        self.library.modbus_set_response_timeout(self.context, timeout, 0)
        if self.library.modbus_connect(self.context) != 0:
            raise AssertionError(f"libmodbus does not connect to port {port}")

    def _done(self, result, values):
        if result >= 0:
            return values
        return ctypes.string_at(self.library.modbus_strerror(ctypes.get_errno())).decode()

    def read(self, area, first, count):
        """Returns the values, or the text of the failure."""
        bits = area in ("coil", "input")
        function = {"coil": "bits", "input": "input_bits", "holding": "registers", "input-register": "input_registers"}[area]
        values = ((ctypes.c_uint8 if bits else ctypes.c_uint16) * count)()
        result = getattr(self.library, f"modbus_read_{function}")(self.context, first, count, values)
        return self._done(result, list(values))

    def write(self, area, first, *values):
        """Returns True, or the text of the failure."""
        bits = area == "coil"
        items = ((ctypes.c_uint8 if bits else ctypes.c_uint16) * len(values))(*values)
        function = self.library.modbus_write_bits if bits else self.library.modbus_write_registers
        return self._done(function(self.context, first, len(values), items), True)

    def close(self):
        self.library.modbus_close(self.context)
        self.library.modbus_free(self.context)


class PymodbusClient:
    """A client by pymodbus. Modbus TCP at 127.0.0.1."""

    def __init__(self, port, unit, timeout=5):
        import pymodbus
        from pymodbus.client import ModbusTcpClient

        self.unit = unit
        self.other = {"unit" if pymodbus.__version__.startswith("3.0") else "slave": unit}  # of functions 22 and 23
        self.client = ModbusTcpClient("127.0.0.1", port=port, timeout=timeout, retries=0)
        if not self.client.connect():
            raise AssertionError(f"pymodbus does not connect to port {port}")

    def read(self, area, first, count):
        """Returns the values, or the text of the failure."""
        name = {"coil": "coils", "input": "discrete_inputs", "holding": "holding_registers", "input-register": "input_registers"}[area]
        response = getattr(self.client, f"read_{name}")(first, count=count, slave=self.unit)
        if response.isError():
            return str(response)
        return [int(bit) for bit in response.bits[:count]] if area in ("coil", "input") else response.registers

    def write(self, area, first, *values):
        """Returns True, or the text of the failure."""
        if area == "coil":
            response = self.client.write_coils(first, [bool(value) for value in values], slave=self.unit)
        else:
            response = self.client.write_registers(first, list(values), slave=self.unit)
        return str(response) if response.isError() else True

    def mask(self, address, keep, change):
        return self.client.mask_write_register(address=address, and_mask=keep, or_mask=change, **self.other)

    def swap(self, first, count, written, *values):
        named = {"values": list(values)} if "slave" in self.other else {"write_registers": list(values)}
        return self.client.readwrite_registers(read_address=first, read_count=count, write_address=written, **named, **self.other)

    def close(self):
        self.client.close()
