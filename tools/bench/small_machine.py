#!/usr/bin/env python3
"""Measures memory and processor of a bridge at 300, 3 000 and 16 000 channels once a second, in a cgroup with a memory limit, while a
station receives every sample.

usage: tools/bench/small_machine.py BIN_DIR [SECONDS [CHANNELS:MEGABYTES ...]]

SECONDS: 30. Default of the rest: 300:64 3000:128 16000:256. Prints a line for each. Needs root, for a cgroup below /sys/fs/cgroup
(version 1 or 2). Use stripped programs as in the packages, because the cgroup also counts their pages.
"""

import os
import subprocess
import sys
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "tests", "tools"))
import plant  # noqa: E402
from progress import Progress  # noqa: E402
from security_cost import processor_seconds  # noqa: E402

plant.START_SECONDS = 120  # 16 000 channels on a busy machine
CHANNELS_OF_A_BUS = 1000  # at 115200 baud, a third of the wire
WARM_UP_SECONDS = 15


class MemoryLimit:
    """A cgroup with a memory limit. The kernel ends a process in it that needs more."""

    def __init__(self, megabytes):
        first = os.path.isdir("/sys/fs/cgroup/memory")
        self.names = ("memory.limit_in_bytes", "memory.max_usage_in_bytes") if first else ("memory.max", "memory.peak")
        self.folder = f"/sys/fs/cgroup/{'memory/' if first else ''}fieldcast-{os.getpid()}"
        os.mkdir(self.folder)
        with open(os.path.join(self.folder, self.names[0]), "w", encoding="ascii") as file:
            file.write(str(megabytes << 20))

    def __enter__(self):
        return self

    def __exit__(self, *_):
        os.rmdir(self.folder)

    def peak(self):
        with open(os.path.join(self.folder, self.names[1]), encoding="ascii") as file:
            return int(file.read()) / 2**20


class LimitedPlant(plant.Plant):
    def __init__(self, bin_dir, config, limit):
        super().__init__(bin_dir, config)
        self.limit = limit

    def _start(self, name):
        if name != "fieldcast-bridge":
            return super()._start(name)
        enter = f'echo $$ >"{self.limit.folder}/cgroup.procs" && exec "$0" "$1"'
        with open(os.path.join(self.run, name + ".log"), "w", encoding="utf-8") as log:
            return subprocess.Popen(["sh", "-c", enter, os.path.join(self.bin_dir, name), self.file],
                                    stdout=log, stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL)


def config(channels):
    text, number = "bridge: bench\nbuses:\n", 0
    while channels > 0:
        of_bus, number = min(channels, CHANNELS_OF_A_BUS), number + 1
        text += f"""  - name: bus-{number}
    port: {{ serial: {{run}}/bus-{number}, baud: 115200, format: 8N1 }}
    protocol: modbus-rtu
    defaults: {{ refresh: 1s }}
    devices:
      - name: device
        address: 1
        channels:
"""
        text += "".join(f'          - {{ name: c{i}, at: "holding:{i}", type: uint16 }}\n' for i in range(of_bus))
        channels -= of_bus
    return text


def resident(pid):
    """Returns VmHWM and RssAnon in MB."""
    with open(f"/proc/{pid}/status", encoding="utf-8") as file:
        fields = dict(line.split(":", 1) for line in file)
    return [int(fields[name].split()[0]) / 1024 for name in ("VmHWM", "RssAnon")]


def measure(bin_dir, seconds, channels, megabytes):
    with MemoryLimit(megabytes) as limit, LimitedPlant(bin_dir, config(channels), limit) as running:
        station = subprocess.Popen([os.path.join(bin_dir, "fieldcast"), "watch", "--json", "--domain", str(running.domain)],
                                   stdout=subprocess.PIPE)
        try:
            pid, begun, first, counted, good = running.bridge.pid, time.monotonic(), None, 0, 0
            with Progress(f"{channels} channels", WARM_UP_SECONDS + seconds) as progress:
                for line in station.stdout:
                    progress.show()
                    since = time.monotonic() - begun
                    if first is None and since > WARM_UP_SECONDS:
                        first, counted, good, started = processor_seconds(pid), 0, 0, since
                    counted += 1
                    good += b'"GOOD"' in line
                    if first is not None and since > started + seconds:
                        break
            spent = (processor_seconds(pid) - first) / (since - started)
            highest, own = resident(pid)
            with open(f"/proc/{station.pid}/status", encoding="utf-8") as file:
                station_mb = next(int(line.split()[1]) / 1024 for line in file if line.startswith("VmHWM"))
        finally:
            station.kill()
            station.communicate()
        print(f"{channels:6} channels, limit {megabytes:4} MB: {spent:.3f} cores, {counted / (since - started):.0f} samples a second, {good / counted:.3f} GOOD; "
              f"cgroup at most {limit.peak():.0f} MB, resident at most {highest:.0f} MB, heap and stacks {own:.0f} MB; station at most {station_mb:.0f} MB", flush=True)


def main():
    bin_dir, seconds = sys.argv[1], float(sys.argv[2]) if len(sys.argv) > 2 else 30
    for row in sys.argv[3:] or ["300:64", "3000:128", "16000:256"]:
        measure(bin_dir, seconds, *map(int, row.split(":")))


if __name__ == "__main__":
    main()
