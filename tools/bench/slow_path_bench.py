#!/usr/bin/env python3
"""Measures programming over a slow path that loses packets, compared with a bare TCP connection on the same path.

usage: tools/bench/slow_path_bench.py BIN_DIR [--delay MS] [--loss PERCENT] [--exchanges N]

The engineer and the plant are two network namespaces. This program carries the packets between them, each way half of --delay later
(default 300), and loses --loss percent of them (default 1). Host Link requests write and read 20 words of a simulated PLC on a line of
115200 7E2, by three ways in turn: a bare TCP connection to such a line, and the port of RFC 2217 with pyserial. Prints the rate of each, and its ratio to
that of the bare connection, which is the most that request and response allow on this path. Needs root, iproute2 and
python3-serial.
"""

import argparse
import contextlib
import ctypes
import fcntl
import heapq
import os
import random
import select
import socket
import struct
import subprocess
import sys
import tempfile
import threading
import time

import serial

TESTS = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "tests")
sys.path[:0] = [os.path.join(TESTS, "tools"), os.path.join(TESTS, "interop")]
from peers import DEADLINE, Program  # noqa: E402
from plant import claim_domain, wait_until  # noqa: E402
from rfc2217_bench import rate  # noqa: E402

TUNSETIFF, IFF_TUN, IFF_NO_PI = 0x400454CA, 0x0001, 0x1000
PLANT_HOST, BARE_PORT, MAIN_PORT, LINE_PORT = "10.98.0.2", 4000, 4001, 4002
PLANT = """bridge: bench
dds: {{ domain: {domain}, interfaces: [127.0.0.1] }}
program:
  engineers:
    listen: 127.0.0.1:{main}
    ports:
      - {{ device: P1, listen: "{host}:{port}", from: [10.98.0.0/24], security: none }}
buses:
{buses}"""
BUS = """  - name: {name}
    port: {{ serial: {line}, baud: 115200, format: 7E2, exclusive: false }}
    protocol: omron-hostlink
    devices: [ {{ name: plc, number: {number}, address: 0, channels: [ {{ name: level, at: DM100, type: uint16, refresh: 10s }} ] }} ]
"""


def ip(*words):
    subprocess.run(["ip", *words], check=True)


def enter(name):
    """The calling thread joins the network namespace."""
    with open(f"/run/netns/{name}", "rb") as space:
        if ctypes.CDLL(None, use_errno=True).setns(space.fileno(), 0) != 0:
            raise OSError(ctypes.get_errno(), f"setns {name}")


class SlowPath:
    """Two namespaces, self.spaces, whose packets arrive late or not at all."""

    def __init__(self, delay, loss):
        self.one_way, self.loss, self.random = delay / 2, loss, random.Random(1)
        self.spaces = [f"fc{os.getpid() % 100000}{end}" for end in "ep"]
        self.carried = self.lost = 0

    def __enter__(self):
        self.ends = [self._end(name, f"10.98.0.{number}") for number, name in enumerate(self.spaces, 1)]
        self.wake, self.over = os.pipe()
        self.thread = threading.Thread(target=self._carry, daemon=True)
        self.thread.start()
        return self

    def __exit__(self, *_):
        os.write(self.over, b"x")
        self.thread.join()
        for end in (*self.ends, self.wake, self.over):
            os.close(end)
        for name in self.spaces:
            ip("netns", "delete", name)

    def _end(self, name, address):
        ip("netns", "add", name)
        ip("-n", name, "link", "set", "lo", "up")
        made = []

        def open_end():
            enter(name)
            end = os.open("/dev/net/tun", os.O_RDWR)
            fcntl.ioctl(end, TUNSETIFF, struct.pack("16sH22x", b"path", IFF_TUN | IFF_NO_PI))
            made.append(end)

        thread = threading.Thread(target=open_end)
        thread.start()
        thread.join()
        ip("-n", name, "address", "add", address + "/24", "dev", "path")
        ip("-n", name, "link", "set", "path", "up")
        return made[0]

    def _carry(self):
        packets = []  # (due, number, end, bytes)
        while True:
            now = time.monotonic()
            while packets and packets[0][0] <= now:
                _, _, end, packet = heapq.heappop(packets)
                os.write(end, packet)
            left = packets[0][0] - now if packets else None
            for ready in select.select([*self.ends, self.wake], [], [], left)[0]:
                if ready == self.wake:
                    return
                packet = os.read(ready, 65536)
                self.carried += 1
                if self.random.random() < self.loss:
                    self.lost += 1
                    continue
                heapq.heappush(packets, (time.monotonic() + self.one_way, self.carried, self.ends[1 - self.ends.index(ready)], packet))


def relay(space, line):
    """A bare serial-to-network server: each connection is the line."""
    enter(space)
    with socket.create_server((PLANT_HOST, BARE_PORT)) as server:
        while True:
            client, _ = server.accept()
            client.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            with client, serial.Serial(line, baudrate=115200, stopbits=2, timeout=0) as port:
                while True:
                    ready = select.select([client, port], [], [])[0]
                    if port in ready:
                        client.sendall(port.read(4096))
                    if client in ready:
                        data = client.recv(4096)
                        if not data:
                            break
                        port.write(data)


def opened(url, **more):
    with contextlib.suppress(OSError, serial.SerialException):
        return serial.serial_for_url(url, timeout=DEADLINE, **more)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("bin_dir")
    parser.add_argument("--delay", type=float, default=300, help="added to the round trip, milliseconds")
    parser.add_argument("--loss", type=float, default=1, help="percent of the packets, each way")
    parser.add_argument("--exchanges", type=int, default=100)
    options = parser.parse_args()
    rates = {"bare TCP": [], "RFC 2217": []}
    with contextlib.ExitStack() as stack:
        path = stack.enter_context(SlowPath(options.delay / 1000, options.loss / 100))
        engineer, plant = path.spaces
        folder = stack.enter_context(tempfile.TemporaryDirectory(prefix="fieldcast-bench-"))
        # The bridge has the first of the two lines; the second is for the bare connection.
        line, bare_line, config, lines = (os.path.join(folder, name) for name in ("line", "bare", "bench.yaml", "lines.yaml"))
        domain, claim = claim_domain()
        stack.enter_context(claim)
        buses = [BUS.format(name=name, number=number, line=where) for name, number, where in (("line", "P1", line), ("bare", "P2", bare_line))]
        for file, shown in ((config, buses[:1]), (lines, buses)):
            with open(file, "w", encoding="utf-8") as text:
                text.write(PLANT.format(domain=domain, main=MAIN_PORT, host=PLANT_HOST, port=LINE_PORT, buses="".join(shown)))
        run = lambda space, program, *words: stack.enter_context(Program("ip", "netns", "exec", space, os.path.join(options.bin_dir, program), *words))
        run(plant, "fieldcast-sim", lines)
        wait_until(lambda: os.path.exists(bare_line), DEADLINE, "the simulated line is missing")
        run(plant, "fieldcast-bridge", config)
        threading.Thread(target=relay, args=(plant, bare_line), daemon=True).start()
        enter(engineer)
        for _ in range(2):
            with wait_until(lambda: opened(f"socket://{PLANT_HOST}:{BARE_PORT}"), DEADLINE, "no bare connection") as port:
                rates["bare TCP"].append(rate(port, options.exchanges))
            with wait_until(lambda: opened(f"rfc2217://{PLANT_HOST}:{LINE_PORT}", baudrate=115200, bytesize=7, parity="E", stopbits=2), DEADLINE,
                            "no port") as port:
                rates["RFC 2217"].append(rate(port, options.exchanges))
        print(f"{path.carried} packets, {path.lost} of them lost")
    bare = sum(rates["bare TCP"])
    for name, each in rates.items():
        if each:
            print(f"{name:16} {sum(each) / len(each):7.3f} exchanges/s, {sum(each) / bare:6.3f} of bare TCP   {' '.join(f'{one:.3f}' for one in each)}")


if __name__ == "__main__":
    main()
