#!/usr/bin/env python3
"""Measures request and response of programming software through a port of RFC 2217, compared with the line itself in the same run.

usage: tools/bench/rfc2217_bench.py BIN_DIR [--exchanges 300]

A simulated PLC is on a line of 115200 7E2. Host Link requests write and read 20 words, as a download and an upload: first at the line
directly, then by pyserial's rfc2217:// client through the bridge, alternating four times. Prints both rates and their ratio. Needs
python3-serial.
"""

import argparse
import contextlib
import os
import sys
import tempfile
import time

import serial

TESTS = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "tests")
sys.path[:0] = [os.path.join(TESTS, "tools"), os.path.join(TESTS, "interop")]
from host_link_session import host_link  # noqa: E402
from peers import DEADLINE, Program, free_port  # noqa: E402
from plant import claim_domain, running_bridge, wait_until  # noqa: E402

PLANT = """bridge: bench
dds: {{ domain: {domain}, interfaces: [127.0.0.1] }}
program: {{ engineers: {{ listen: 127.0.0.1:{main}, ports: [ {{ device: P1, listen: 127.0.0.1:{port} }} ] }} }}
buses:
  - name: line
    port: {{ serial: {line}, baud: 115200, format: 7E2, exclusive: false }}
    protocol: omron-hostlink
    devices: [ {{ name: plc, number: P1, address: 0, channels: [ {{ name: level, at: DM100, type: uint16, refresh: 10s }} ] }} ]
"""


def rate(port, exchanges):
    """Returns exchanges a second."""
    words = "".join(f"{number:04X}" for number in range(20))
    began = time.monotonic()
    for number in range(exchanges // 2):
        address = 1000 + 20 * (number % 60)
        for request, expected in ((f"@00WD{address}{words}", host_link("@00WD00")), (f"@00RD{address}0020", host_link("@00RD00" + words))):
            port.write(host_link(request))
            response = port.read_until(b"\r")
            if response != expected:
                raise SystemExit(f"rfc2217_bench: {request}: {response}")
    return exchanges / (time.monotonic() - began)


def opened(port):
    with contextlib.suppress(OSError, serial.SerialException):
        return serial.serial_for_url(f"rfc2217://127.0.0.1:{port}", baudrate=115200, bytesize=7, parity="E", stopbits=2, timeout=DEADLINE)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("bin_dir")
    parser.add_argument("--exchanges", type=int, default=300)
    options = parser.parse_args()
    direct, through = [], []
    with contextlib.ExitStack() as stack:
        folder = stack.enter_context(tempfile.TemporaryDirectory(prefix="fieldcast-bench-"))
        line, config, port = os.path.join(folder, "line"), os.path.join(folder, "bench.yaml"), free_port()
        domain, claim = claim_domain()
        stack.enter_context(claim)
        with open(config, "w", encoding="utf-8") as file:
            file.write(PLANT.format(domain=domain, line=line, main=free_port(), port=port))
        stack.enter_context(Program(os.path.join(options.bin_dir, "fieldcast-sim"), config))
        wait_until(lambda: os.path.exists(line), DEADLINE, "the simulated line is missing")
        for _ in range(4):
            with serial.Serial(line, baudrate=115200, stopbits=2, timeout=DEADLINE) as direct_port:  # a pseudo-terminal is 8N
                direct.append(rate(direct_port, options.exchanges))
            with running_bridge(options.bin_dir, config, os.path.join(folder, "log")), wait_until(lambda: opened(port), DEADLINE, "no port") as far:
                through.append(rate(far, options.exchanges))
    for name, rates in (("directly at the line", direct), ("through the bridge by RFC 2217", through)):
        print(f"{name:40} {sum(rates) / len(rates):8.2f} exchanges/s   {' '.join(f'{each:.2f}' for each in rates)}")
    print(f"{'rate compared with the line':40} {sum(through) / sum(direct):8.4f}               >= 0.99")


if __name__ == "__main__":
    main()
