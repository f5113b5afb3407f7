"""Runs the parts of the fault campaign in shares of the time, shows the progress, and writes a report.

usage: campaign.py --minutes N [--seed S] [--part NAME].. [--counts FILE] [--report FILE] [--grown DIR]
       [--bin DIR] [--fuzz-bin DIR] [--fuzz-fast-bin DIR]

Each part is a separate program. It prints a line that begins with FAIL or VIOLATION for each failed check, and its counts as one JSON
object in its last line. Counts are added to those in FILE, over all runs. Ctrl-C ends the current part and writes the report so far.
Exit code: 0 all checks passed, 1 a check failed, 2 wrong usage, 130 ended by Ctrl-C without a failed check.
"""

import argparse
import json
import os
import signal
import subprocess
import sys
import tempfile
import threading
import time

HERE = os.path.dirname(os.path.abspath(__file__))


class Part:
    """One row of the campaign: name, share of the time, and the commands of its processes for a number of seconds."""

    def __init__(self, name, share, what, commands, grace=30):
        """`grace`: seconds that it may run longer than its share."""
        self.name, self.share, self.what, self.commands, self.grace = name, share, what, commands, grace


def script(name):
    return [sys.executable, os.path.join(HERE, name)]


def virtual_commands(options, seconds, seed):
    cores = os.cpu_count() or 1
    program = os.path.join(options.bin, "virtual_campaign")
    first = (seed - 1) * 1_000_000 + 1  # other seeds for another run
    return [[program, "--seeds", f"{first}..{first + 999_999}", "--seconds", str(seconds), "--share", f"{core}/{cores}",
             "--transcripts", options.files] for core in range(cores)]


def fuzz_commands(options, seconds, seed):
    return [script("fuzz_campaign.py") + ["--seconds", str(seconds), "--seed", str(seed), "--bin", options.fuzz_bin,
                                          "--fast-bin", options.fuzz_fast_bin, "--artifacts", options.files]
            + (["--grown", options.grown] if options.grown else [])]


def system_commands(options, seconds, seed):
    return [script("system_campaign.py") + ["--seconds", str(seconds), "--seed", str(seed), "--bin", options.bin,
                                            "--shim", os.path.join(options.bin, "..", "lib", "libfault_shim.so")]]


def network_commands(options, seconds, seed):
    return [script("network_campaign.py") + ["--seconds", str(seconds), "--seed", str(seed), "--bin", options.bin]]


def history_commands(options, seconds, seed):
    return [script("history_campaign.py") + ["--seconds", str(seconds), "--seed", str(seed), "--bin", options.bin]]


def endurance_commands(options, seconds, seed):
    return [script("endurance_campaign.py") + ["--seconds", str(seconds), "--seed", str(seed), "--bin", options.bin,
                                               "--shim", os.path.join(options.bin, "..", "lib", "libfault_shim.so")]]


PARTS = [
    Part("virtual", 0.20, "days of plants with every protocol, in virtual time", virtual_commands),
    Part("fuzz", 0.20, "any bytes into whatever reads bytes or texts", fuzz_commands),
    Part("system", 0.20, "the bridge on a machine whose disk, clock, descriptors and memory fail", system_commands, grace=480),
    Part("history", 0.10, "every sample and command of a bridge that is killed, against what was on the wire", history_commands, grace=300),
    Part("network", 0.20, "bridges and stations of two vendors on a network that loses, doubles, reorders and partitions",
         network_commands, grace=300),
    Part("endurance", 0.10, "one plant for long: memory, descriptors and threads stay flat; 72 hours in virtual time", endurance_commands,
         grace=300),
]


class Run:
    """The running processes of one part; reads their output line by line."""

    def __init__(self, commands):
        self.failures, self.counts, self.codes = [], {}, []
        self.lock = threading.Lock()
        self.processes = [subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, errors="replace",
                                           start_new_session=True) for command in commands]
        self.last_error = [""] * len(commands)
        self.readers = []
        for index, process in enumerate(self.processes):
            self.readers.append(threading.Thread(target=self.read, args=(process,), daemon=True))
            self.readers.append(threading.Thread(target=self.read_progress, args=(index, process), daemon=True))
        for reader in self.readers:
            reader.start()

    def read(self, process):
        for text in process.stdout:
            with self.lock:
                if text.startswith(("FAIL", "VIOLATION")):
                    self.failures.append(text.strip())
                    print("\r\033[K" * sys.stderr.isatty() + text.strip(), file=sys.stderr, flush=True)
                elif text.startswith("{"):
                    add_counts(self.counts, json.loads(text))

    def read_progress(self, index, process):
        for text in process.stderr:
            self.last_error[index] = text.strip() or self.last_error[index]

    def end(self, how):
        for process in self.processes:
            if process.poll() is None:
                os.killpg(process.pid, how)

    def over(self):
        return all(process.poll() is not None for process in self.processes)

    def finish(self):
        for process in self.processes:
            process.wait()
        for reader in self.readers:
            reader.join(5)
        for index, process in enumerate(self.processes):
            if process.returncode not in (0, 1) or (process.returncode == 1 and not self.failures):
                self.failures.append(f"FAIL {os.path.basename(process.args[-1] if process.args[0] == sys.executable else process.args[0])}: "
                                     f"exit code {process.returncode}: {self.last_error[index]}")


def add_counts(into, more):
    for name, value in more.items():
        if isinstance(value, dict):
            add_counts(into.setdefault(name, {}), value)
        elif isinstance(value, (int, float)):
            into[name] = round(into.get(name, 0) + value, 1)


def show(text):
    print(("\r\033[K" if sys.stderr.isatty() else "") + text, end="" if sys.stderr.isatty() else "\n", file=sys.stderr, flush=True)


def run_part(part, options, seconds, stopped, left):
    """Runs a part; returns its counts and its failures."""
    began = time.monotonic()
    run = Run(part.commands(options, max(1, int(seconds)), options.seed))
    shown = -1000.0
    while not run.over():
        elapsed = time.monotonic() - began
        if stopped.is_set() or elapsed > seconds + part.grace:
            run.end(signal.SIGINT)
            deadline = time.monotonic() + 8
            while not run.over() and time.monotonic() < deadline:
                time.sleep(0.05)
            run.end(signal.SIGKILL)
            break
        if elapsed - shown >= (1 if sys.stderr.isatty() else 30):
            shown = elapsed
            rest = max(0, left - elapsed)
            show(f"{part.name}: {int(elapsed)} of {int(seconds)} s; {int(rest // 60)} min {int(rest % 60)} s left in all; "
                 f"{len(run.failures)} failures; {run.last_error[0][:80]}")
        time.sleep(0.1)
    run.finish()
    return run.counts, run.failures


def load_counts(path):
    if not path or not os.path.exists(path):
        return {}
    with open(path, encoding="utf-8") as file:
        return json.load(file)


def save_counts(path, counts):
    handle, temporary = tempfile.mkstemp(dir=os.path.dirname(os.path.abspath(path)))
    with os.fdopen(handle, "w", encoding="utf-8") as file:
        json.dump(counts, file, indent=1, sort_keys=True)
        file.write("\n")
    os.chmod(temporary, 0o644)
    os.replace(temporary, path)


def lines_of(counts, indent="  "):
    for name, value in sorted(counts.items()):
        if isinstance(value, dict):
            yield f"{indent}{name}:"
            yield from lines_of(value, indent + "  ")
        else:
            yield f"{indent}{name:<24}{value:>18,}"


def report_of(options, results, total, elapsed, interrupted):
    lines = [f"Fault campaign, seed {options.seed}, {elapsed / 60:.1f} minutes" + (", ended by hand" if interrupted else "")]
    for part, counts, failures in results:
        lines += ["", f"{part.name}: {part.what}: " + (f"{len(failures)} FAILURES" if failures else "all held"), *lines_of(counts),
                  *("  " + failure for failure in failures)]
    if options.counts:
        lines += ["", f"over all runs ({options.counts}):", *lines_of(total)]
    return "\n".join(lines) + "\n"


def parse():
    parser = argparse.ArgumentParser(prog="campaign")
    parser.add_argument("--minutes", type=float, required=True)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--part", action="append", choices=[part.name for part in PARTS])
    parser.add_argument("--counts")
    parser.add_argument("--report")
    parser.add_argument("--files", help="where transcripts and inputs that fail are written")
    parser.add_argument("--grown", help="where inputs that fuzzing found are kept for the next run")
    parser.add_argument("--bin", default="build/bin")
    parser.add_argument("--fuzz-bin", default="build-fuzz/bin")
    parser.add_argument("--fuzz-fast-bin", default="build-fuzz-fast/bin")
    options = parser.parse_args()
    if options.minutes <= 0 or options.seed < 1:
        parser.error("--minutes and --seed are greater than 0")
    return options


def main():
    options = parse()
    options.files = options.files or tempfile.mkdtemp(prefix="fieldcast-campaign-")
    os.makedirs(options.files, exist_ok=True)
    total = load_counts(options.counts)
    stopped = threading.Event()
    for name in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(name, lambda *_: stopped.set())
    parts = [part for part in PARTS if not options.part or part.name in options.part]
    whole = sum(part.share for part in parts)
    began = time.monotonic()
    end = began + options.minutes * 60
    results = []
    for part in parts:
        if stopped.is_set():
            break
        seconds = options.minutes * 60 * part.share / whole
        counts, failures = run_part(part, options, seconds, stopped, end - time.monotonic())
        results.append((part, counts, failures))
        if options.counts:
            add_counts(total, {part.name: counts})
            save_counts(options.counts, total)
    show("")
    report = report_of(options, results, total, time.monotonic() - began, stopped.is_set())
    print(report, end="")
    if options.report:
        with open(options.report, "w", encoding="utf-8") as file:
            file.write(report)
    failed = any(failures for _, _, failures in results)
    if failed:
        print(f"what failed is in {options.files}")
    elif not os.listdir(options.files):
        os.rmdir(options.files)
    return 1 if failed else 130 if stopped.is_set() else 0


if __name__ == "__main__":
    sys.exit(main())
