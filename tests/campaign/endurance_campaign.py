"""Runs a plant with a store, a station and a command each second; memory, descriptors and threads must not grow.

usage: endurance_campaign.py --bin DIR --shim LIBRARY [--seconds S] [--seed N]

Measures the bridge every second. The greatest memory of the second and the last third of the time may exceed that of the previous third
by 2 MB, and descriptors and threads may differ by 4. Then runs 72 hours of every protocol in virtual time. Each failure is printed as a
line that begins with FAIL; the last line is the counts.
"""

import json
import os
import subprocess
import sys
import time

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [HERE, os.path.join(HERE, "..", "tools")]
import system_campaign  # noqa: E402
from plant import Failure, report  # noqa: E402

MEMORY_MAY_GROW = 2 * 1024 * 1024  # bytes, from one third to the next
OTHERS_MAY_GROW = 4
VIRTUAL_HOURS = 72


def look(pid):
    with open(f"/proc/{pid}/statm", encoding="utf-8") as file:
        resident = int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE")
    return resident, len(os.listdir(f"/proc/{pid}/fd")), len(os.listdir(f"/proc/{pid}/task"))


def flat(looks):
    """Returns what grew, or None, and the greatest values of each third."""
    third = len(looks) // 3
    most = [tuple(max(column) for column in zip(*looks[i * third:(i + 1) * third])) for i in range(3)]
    for before, after in zip(most, most[1:]):
        if after[0] > before[0] + MEMORY_MAY_GROW:
            return f"memory grew from {before[0]} to {after[0]} bytes", most
        for name, index in (("descriptors", 1), ("threads", 2)):
            if after[index] > before[index] + OTHERS_MAY_GROW:
                return f"{name} grew from {before[index]} to {after[index]}", most
    return None, most


def run(seconds):
    looks, commands, failed = [], 0, 0
    with system_campaign.ShimmedPlant() as plant:
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            looks.append(look(plant.bridge.pid))
            commands += 1
            failed += plant.cli("write", f"line/press/setpoint={commands % 1000}").code != 0
            print(f"{len(looks)} looks, {looks[-1][0] // 1024} KiB", file=sys.stderr, flush=True)
            time.sleep(max(0.0, min(1.0, end - time.monotonic())))
        good = plant.watching.count
        stored = plant.stored()
        longest = plant.watching.check()
    grew, most = flat(looks) if len(looks) >= 9 else (None, [])
    counts = {"looks": len(looks), "commands": commands, "good_values": good, "stored": stored}
    for number, (resident, descriptors, threads) in enumerate(most, 1):
        print(f"third {number}: {resident // 1024} KiB, {descriptors} descriptors, {threads} threads; longest gap {longest:.2f} s",
              file=sys.stderr, flush=True)
    if most:
        counts["greatest"] = {"KiB_of_last_third": most[-1][0] // 1024, "KiB_of_first_third": most[0][0] // 1024,
                              "descriptors": most[-1][1], "threads": most[-1][2]}
    if grew or failed:
        raise Failure(grew or f"{failed} of {commands} commands failed")
    return counts


def virtual():
    done = subprocess.run([os.path.join(system_campaign.options.bin, "virtual_campaign"), "--seeds", "1..1", "--hours", str(VIRTUAL_HOURS),
                           "--transcripts", os.environ.get("TMPDIR", "/tmp")], capture_output=True, text=True)
    if done.returncode != 0:
        raise Failure(done.stdout.splitlines()[0] if done.stdout else done.stderr)
    return json.loads(done.stdout.splitlines()[-1])["bus_hours"]


def main():
    system_campaign.options = system_campaign.parse()
    system_campaign.options.bin = os.path.abspath(system_campaign.options.bin)
    system_campaign.options.shim = os.path.abspath(system_campaign.options.shim)
    failed, counts = False, {}
    for part in (lambda: counts.update(run(system_campaign.options.seconds)), lambda: counts.update(virtual_bus_hours=virtual())):
        try:
            part()
        except (Failure, OSError, subprocess.TimeoutExpired) as failure:
            failed = True
            print(f"FAIL {str(failure)[:500]}", flush=True)
        except KeyboardInterrupt:
            break
    return report(counts, failed)


if __name__ == "__main__":
    sys.exit(main())
