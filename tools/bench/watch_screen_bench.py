#!/usr/bin/env python3
"""Measures the cost of the screen of `fieldcast watch` and its response time to keys.

usage: tools/bench/watch_screen_bench.py BIN_DIR [--channels 10000] [--seconds 10] [--columns 80] [--rows 24]

A bridge without wires publishes the channels of 10 buses once a second. Bridge and watch are separate processes on the loopback in a
separate DDS domain; watch has a pseudo-terminal. Keys move to the end of the list and back; the response time is from the key to the
last byte of the frame that shows its effect.
"""

import argparse
import glob
import os
import re
import signal
import subprocess
import sys
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "tests", "tools"))
from plant import claim_domain  # noqa: E402
from progress import Progress  # noqa: E402
from terminal import Terminal  # noqa: E402

BUSES = 10
HOME, END = "\x1bOH", "\x1bOF"


def run_seconds(pid):
    """Returns the run time of all threads in seconds, measured in nanoseconds."""
    total = 0
    for path in glob.glob(f"/proc/{pid}/task/*/schedstat"):
        with open(path, encoding="utf-8") as file:
            total += int(file.read().split()[0])
    return total / 1e9


def share(terminal, seconds):
    """Returns the share of one core over this many seconds."""
    before, began = run_seconds(terminal.pid), time.monotonic()
    with Progress("measuring", seconds) as progress:
        while time.monotonic() - began < seconds:
            terminal.read(0.2)
            progress.show()
    return (run_seconds(terminal.pid) - before) / (time.monotonic() - began)


def answer_ms(terminal, key, shows):
    """Returns the time from a key to the frame that shows its effect."""
    began = time.monotonic()
    terminal.press(key)
    while True:
        terminal.read_once(2)
        came = time.monotonic()
        if shows(terminal.text()):
            return 1e3 * (came - began - terminal.fed_seconds)


def figure(what, value, unit, goal):
    print(f"{what:<58} {value:12.4g} {unit:<10} goal < {goal:g}: ratio {value / goal:.2f}{'' if value < goal else '  NOT REACHED'}", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("bin_dir")
    for name, default in [("channels", 10_000), ("seconds", 10), ("columns", 80), ("rows", 24)]:
        parser.add_argument("--" + name, type=int, default=default)
    options = parser.parse_args()
    domain, claim = claim_domain()
    bridge = subprocess.Popen([os.path.join(options.bin_dir, "bench_bridge"), str(domain), str(BUSES), str(options.channels // BUSES)],
                              stdout=subprocess.DEVNULL)
    try:
        watch = [os.path.join(options.bin_dir, "fieldcast"), "watch", "--domain", str(domain)]
        with Terminal(watch, options.columns, options.rows) as terminal:
            terminal.wait_for(f"{options.channels} of {options.channels} GOOD", 60)
            terminal.read(3)
            figure(f"processor of watch, {options.channels} channels each second", share(terminal, options.seconds), "of a core", 0.3)
            print("the screen says:", re.search(r"\d+ samples/s", terminal.text()).group())
            times = []
            for i in range(60):
                end = i % 2 == 0
                times.append(answer_ms(terminal, END if end else HOME, lambda text, end=end: ("rows 1-" not in text) == end))
                terminal.read(0.05 + 0.007 * (i % 9))
            times.sort()
            figure("from a key to the frame, median of 60", times[len(times) // 2], "ms", 50)
            figure("the longest of 60", times[-1], "ms", 50)
            terminal.press("t", "/", "channel-99", "\r")
            terminal.wait_for("filter: channel-99")
            figure("processor with a filter, not grouped", share(terminal, options.seconds), "of a core", 0.3)
            terminal.press("q")
            terminal.wait_for_end()
            lost = [line for line in terminal.said.decode(errors="replace").splitlines() if "too slow" in line]
            print("lost:", lost or "nothing")
    finally:
        bridge.send_signal(signal.SIGTERM)
        bridge.wait(10)
        claim.close()


if __name__ == "__main__":
    main()
