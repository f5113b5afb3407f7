"""Runs every libFuzzer program over its corpus for a share of the time, and counts what each executed.

usage: fuzz_campaign.py --seconds S [--seed N] --bin DIR [--fast-bin DIR] [--target NAME].. [--artifacts DIR] [--grown DIR] [--jobs N]

DIR of --bin has the programs with sanitizers. DIR of --fast-bin has those of small decoders without sanitizers, which execute ten
times as many inputs and are counted separately. They are guided by the branches of an input, not by the count of each branch. Every
program gets the same time. A failing input is stored in the folder of artifacts, and a line that begins with FAIL names it. With --grown
new inputs are stored in that folder, and the next run begins with them. The last line is the counts as JSON.
"""

import argparse
import glob
import json
import os
import re
import signal
import subprocess
import sys
import tempfile
import threading
import time

CORPUS = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "fuzz", "corpus")
EXECUTED = re.compile(r"stat::number_of_executed_units:\s*(\d+)")
# Largest useful input in bytes, of a frame or of a program's messages; longer inputs only cost time. Others: libFuzzer's default.
LONGEST = {"dtc": 600, "lzw": 300, "mitsubishi_fx": 600, "mitsubishi_mc": 600, "mitsubishi_mc_ascii": 600, "modbus": 600, "modbus_rtu_declared": 600, "omron_fins": 600, "omron_fins_tcp": 600, "omron_fins_udp": 600, "omron_hostlink": 600, "mitsubishi_mc_serial": 600, "mitsubishi_mc_format_2": 600, "mitsubishi_mc_format_3": 600, "mitsubishi_mc_format_5": 600, "mitsubishi_mc_1c": 600, "allen_bradley_df1": 600, "allen_bradley_df1_half": 600,
           "program": 600, "s7_freeport": 600, "s7_ppi": 600, "s7_tcp": 600, "telnet": 600, "line_engineer": 600, "instrument": 600, "adam_4000": 600, "dlt645_2007": 600, "mt_sics": 600, "iec62056_21": 1200, "iec62056_21_optical": 1200, "m_bus": 600, "m_bus_secondary": 600,
           "delta_dvp_ascii": 600, "delta_dvp_rtu": 600, "fatek_facon": 600, "keyence_kv": 600, "nmea_0183": 600, "panasonic_mewtocol": 600, "scale_stream": 200, "address": 120}
# Shortens allocation stacks, which are needed only for a failed input: replay it without these options.
SANITIZER = "malloc_context_size=0:quarantine_size_mb=16"
PULSE = re.compile(r"^#(\d+)\s")


def parse():
    parser = argparse.ArgumentParser()
    parser.add_argument("--seconds", type=float, required=True)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--bin", required=True)
    parser.add_argument("--fast-bin")
    parser.add_argument("--target", action="append")
    parser.add_argument("--artifacts", default=".")
    parser.add_argument("--grown")
    parser.add_argument("--jobs", type=int, default=len(os.sched_getaffinity(0)))
    return parser.parse_args()


class Fuzzer:
    """One running fuzz program."""

    def __init__(self, options, program, seconds, scratch):
        self.name, self.program, self.executed = os.path.basename(program)[len("fuzz_"):], program, 0
        self.fast = bool(options.fast_bin) and os.path.dirname(program) == options.fast_bin.rstrip("/")
        name = self.name
        grown = os.path.join(options.grown or scratch, name)  # found inputs are stored here, not in the tree
        os.makedirs(grown, exist_ok=True)
        command = [program, f"-max_total_time={max(1, int(seconds))}", "-print_final_stats=1",
                   f"-seed={options.seed}", "-timeout=25", "-rss_limit_mb=2048", f"-max_len={LONGEST.get(name, 0)}",
                   f"-use_counters={0 if self.fast else 1}", f"-artifact_prefix={options.artifacts}/{name}-", grown, os.path.join(CORPUS, name)]
        self.process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, errors="replace",
                                        env={"ASAN_OPTIONS": SANITIZER, **os.environ})
        self.tail = []
        self.reader = threading.Thread(target=self.read, daemon=True)
        self.reader.start()

    def read(self):
        for text in self.process.stderr:
            if found := EXECUTED.search(text) or PULSE.search(text):
                self.executed = max(self.executed, int(found.group(1)))
            self.tail = (self.tail + [text.rstrip()])[-40:]

    def finish(self, stopped):
        self.process.wait()
        self.reader.join(5)
        if self.process.returncode == 0 or stopped:
            return None
        said = next((text for text in self.tail if "ERROR" in text or "SUMMARY" in text or "runtime error" in text), "no word")
        kept = next((text.split("written to ")[-1] for text in self.tail if "Test unit written to" in text), "no input kept")
        return f"FAIL {self.program}: exit code {self.process.returncode}: {said.strip()}; {kept}"


def main():
    options = parse()
    programs = [path for folder in (options.bin, options.fast_bin) if folder for path in sorted(glob.glob(os.path.join(folder, "fuzz_*")))
                if not options.target or os.path.basename(path)[len("fuzz_"):] in options.target]
    if not programs:
        print(f"FAIL no fuzz targets in {options.bin}")
        return 1
    stopped = threading.Event()
    for name in (signal.SIGINT, signal.SIGTERM):
        signal.signal(name, lambda *_: stopped.set())
    os.makedirs(options.artifacts, exist_ok=True)
    end = time.monotonic() + options.seconds
    waiting, running, executed, fast, failed = programs, [], {}, {}, False
    with tempfile.TemporaryDirectory() as scratch:
        while (waiting or running) and not (stopped.is_set() and not running):
            while waiting and len(running) < options.jobs and not stopped.is_set():
                left = end - time.monotonic()
                running.append(Fuzzer(options, waiting[0], left * options.jobs / max(len(waiting), options.jobs), scratch))
                waiting.pop(0)
            if stopped.is_set():
                for fuzzer in running:
                    fuzzer.process.send_signal(signal.SIGINT)
            for fuzzer in [each for each in running if stopped.is_set() or each.process.poll() is not None]:
                running.remove(fuzzer)
                fault = fuzzer.finish(stopped.is_set())
                (fast if fuzzer.fast else executed)[fuzzer.name] = fuzzer.executed
                print(f"{fuzzer.name}: {fuzzer.executed:,} executions, {len(waiting) + len(running)} programs to go", file=sys.stderr, flush=True)
                if fault:
                    failed = True
                    print(fault, flush=True)
            time.sleep(0.05)
    counts = {"executions": executed, "all_executions": sum(executed.values()) + sum(fast.values())}
    if fast:
        counts["executions_without_sanitizers"] = fast
    print(json.dumps(counts))
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
