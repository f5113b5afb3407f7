#!/usr/bin/env python3
"""Runs the benches of docs/figures.md and writes what they print into it.

usage: tools/bench/figures.py [--list] [PATTERN]

The document has a place for each bench, between `<!-- figures: COMMAND -->` and `<!-- end -->`. This program runs each COMMAND that contains
PATTERN (all, in about 75 minutes, without it) and replaces the text of its place by the date, the machine, the versions, the duration and
the bench's standard output. Other places stay as they are; so does the place of a bench that failed. Nothing else should run on the machine.
--list: prints the commands and runs none.

Needs build/bin with tests and benches: tools/build.sh -DFIELDCAST_TESTS=ON -DFIELDCAST_BENCHES=ON. Exit code 1: a bench ended with an error,
or took more than 30 minutes; 2: no command contains PATTERN.
"""

import datetime
import os
import pathlib
import re
import subprocess
import sys
import time

PLACE = re.compile(r"(<!-- figures: ([^\n]+) -->\n).*?(<!-- end -->)", re.DOTALL)
LONGEST_S = 1800


def commands_of(document, pattern=""):
    return [command for _, command, _ in PLACE.findall(document) if pattern in command]


def replaced(document, command, text):
    """The document with `text` in the place of `command`."""
    return PLACE.sub(lambda place: f"{place[1]}{text.rstrip()}\n{place[3]}" if place[2] == command else place[0], document)


def block(command, output, seconds, machine):
    """The generated text: what a bench printed, with the machine above it. Only the last state of a line that it rewrote stays."""
    lines = [line.rsplit("\r", 1)[-1].rstrip() for line in output.replace("```", "'''").split("\n")]
    return "\n".join([f"{machine}; {seconds:.0f} s.", "", "<!-- picture -->", "```text", f"$ {command}", *lines]).rstrip() + "\n```\n"


def machine():
    """Date, processor, release, version of Fast DDS, and the load before the bench."""
    release = dict(line.rstrip().split("=", 1) for line in open("/etc/os-release", encoding="utf-8") if "=" in line)
    model = re.search(r"model name\s*: (.+)", pathlib.Path("/proc/cpuinfo").read_text(encoding="utf-8"))
    package = "dpkg-query", "-W", "-f", "${Package} ${Version}\n", "libfastdds3.1", "libfastdds2.14", "libfastrtps2.9"
    library = subprocess.run(package, capture_output=True, text=True, check=False).stdout.splitlines() or ["Fast DDS of the build"]
    return (f"{datetime.date.today()}: {os.cpu_count()} cores of {model[1] if model else os.uname().machine}, "
            f"{release['PRETTY_NAME'].strip(chr(34))}, {library[0]}, load {os.getloadavg()[0]:.1f} before")


def run(command):
    """(standard output, seconds), or None after an error, which it prints."""
    bin_folder = os.path.abspath("build/bin")
    environment = dict(os.environ, PATH=f"{bin_folder}:{os.environ['PATH']}", PYTHONDONTWRITEBYTECODE="1", PYTHONPATH="tests/tools")
    began = time.monotonic()
    bench = subprocess.run(["timeout", "--kill-after=30", str(LONGEST_S), "bash", "-c", command], stdin=subprocess.DEVNULL,
                           stdout=subprocess.PIPE, env=environment, text=True, check=False)
    if bench.returncode != 0:
        print(f"{bench.stdout}figures.py: {command} ended with {bench.returncode}; its figures stay", file=sys.stderr)
        return None
    return bench.stdout, time.monotonic() - began


def main(words):
    if "-h" in words or "--help" in words:
        sys.exit(__doc__)
    os.chdir(pathlib.Path(__file__).resolve().parents[2])
    path = pathlib.Path("docs/figures.md")
    pattern = next((word for word in words if word != "--list"), "")
    commands = commands_of(path.read_text(encoding="utf-8"), pattern)
    if "--list" in words:
        print(*commands, sep="\n")
        return 0
    if not commands:
        print(f"figures.py: no command of {path} contains '{pattern}'; --list prints them", file=sys.stderr)
        return 2
    if not os.path.exists("build/bin/wire_bench"):
        print("figures.py: build/bin has no benches: tools/build.sh -DFIELDCAST_TESTS=ON -DFIELDCAST_BENCHES=ON", file=sys.stderr)
        return 1
    failed = 0
    for number, command in enumerate(commands, 1):
        print(f"{number} of {len(commands)}: {command}", flush=True)
        before = machine()
        printed = run(command)
        failed += printed is None
        if printed:  # written after each, so that an interrupted run keeps what it measured
            document = path.read_text(encoding="utf-8")
            path.write_text(replaced(document, command, block(command, *printed, before)), encoding="utf-8")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
