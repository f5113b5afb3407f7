"""Runs the whole product in real time while parts of it fail, and writes a page and a report of it.

usage: soak.py --bin DIR --hours H [--seed S] [--lines 32] [--folder DIR] [--nats PROGRAM]

Two bridges of a standby group at the lines of a simulated plant, a station with a store, two more stations, a forwarder with a JetStream
server, and two callers that write. Devices respond late, twice, in part or not at all. Every 20 to 90 s a fault is drawn from the seed: a
program is killed or stopped for some seconds. FOLDER/soak.html is written again each minute; FOLDER/report.md at the end.

These must hold, each minute:
- programs that are not part of a fault run, and the bridge that is master is one of two;
- every channel has a new sample at a station, or its device has a fault of its own;
- memory, descriptors and threads of each program stay within the limits of GROWTH above those at the end of the first ten minutes.
At the end, history_check.py compares the samples and commands of four of the lines with their captures.
"""

import argparse
import contextlib
import glob
import html
import json
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [HERE, os.path.join(HERE, "..", "tools")]
import history_check  # noqa: E402
import nats  # noqa: E402
from history_campaign import MILL, PRESS, Caller  # noqa: E402
from plant import Failure, claim_domain, report, run_cli, wait_until  # noqa: E402

LINE = """  - name: {name}
    port: {{ tcp: "127.0.0.1:{port}" }}
    protocol: modbus-tcp
    defaults: {{ refresh: 500ms, timeout: 250ms }}
{capture}    devices:
{devices}"""
FAULTS = """buses:
  "*":
    devices:
      "*":
        delay: { base: 2ms, spread: 3ms }
        loss: 0.001
        late: { probability: 0.001, by: 400ms }
        doubled: { probability: 0.001, after: 5ms }
"""
CAPTURED = 4  # lines
MINUTE, WARM = 60, 10  # seconds, minutes
GROWTH = {"memory": 24e6, "descriptors": 40, "threads": 12}
SILENT = 30.0  # seconds
PAIR = ["bridge-a", "bridge-b"]


class Programs:
    """The programs of the soak, by name; each writes its log into the folder."""

    def __init__(self, folder):
        self.folder, self.commands, self.running, self.restarts = folder, {}, {}, {}

    def start(self, name, *command):
        self.commands[name] = command = command or self.commands[name]
        with open(os.path.join(self.folder, name + ".log"), "a", encoding="utf-8") as log:
            out = open(os.path.join(self.folder, name + ".jsonl"), "a", encoding="utf-8") if "watch" in command else log
            self.running[name] = subprocess.Popen(command, stdout=out, stderr=log, stdin=subprocess.DEVNULL, cwd=self.folder,
                                                  start_new_session=True)

    def kill(self, name):
        self.running[name].kill()
        self.running[name].wait()
        self.restarts[name] = self.restarts.get(name, 0) + 1

    def used(self, name):
        pid = self.running[name].pid
        with open(f"/proc/{pid}/statm", encoding="utf-8") as file:
            memory = int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE")
        return {"memory": memory, "descriptors": len(os.listdir(f"/proc/{pid}/fd")), "threads": len(os.listdir(f"/proc/{pid}/task"))}

    def end(self):
        for name, process in reversed(self.running.items()):
            if process.poll() is None:
                process.send_signal(signal.SIGCONT)
                process.terminate()
                try:
                    process.wait(30)
                except subprocess.TimeoutExpired:
                    process.kill()
                    process.wait()
                    yield f"{name} did not end within 30 s of SIGTERM"


class Soak:
    def __init__(self, options, folder):
        self.options, self.folder, self.random = options, folder, random.Random(options.seed)
        self.domain, self.claim = claim_domain()
        self.programs, self.rows, self.faults, self.failures = Programs(folder), [], [], []
        self.base, self.run, self.bin_dir, self.over = {}, folder, options.bin, threading.Event()
        self.file = self.path("bridge-a.yaml")  # of the commands of Caller

    def path(self, name):
        return os.path.join(self.folder, name)

    def write(self, name, text):
        with open(self.path(name), "w", encoding="utf-8") as file:
            file.write(text)
        return self.path(name)

    def bridge_text(self, name, ports):
        os.makedirs(self.path("wire-" + name), exist_ok=True)
        standby = f", standby: {{ group: pair, strength: {2 - PAIR.index(name)} }}" if name in PAIR else ""
        lines = []
        for number, port in enumerate(ports):
            seen = number < CAPTURED
            capture = f"    capture: {{ folder: {self.path('wire-' + name)}, file-size: 100MB, files: 1000 }}\n" if seen and name in PAIR else ""
            lines.append(LINE.format(name=f"{'seen' if seen else 'line'}-{number}", port=port, capture=capture, devices=MILL + PRESS))
        return f"bridge: {{ name: {name}{standby} }}\ndds: {{ domain: {self.domain} }}\nbuses:\n" + "".join(lines)

    def start(self):
        program = {name: os.path.join(self.bin_dir, name) for name in ("fieldcast", "fieldcast-sim", "fieldcast-bridge", "fieldcast-station",
                                                                       "fieldcast-forward")}
        ports = [nats.free_port() for _ in range(self.options.lines)]
        plant = self.write("plant.yaml", self.bridge_text("plant", ports))
        self.programs.start("plant", program["fieldcast-sim"], plant, "--faults", self.write("faults.yaml", FAULTS), "--seed", str(self.options.seed))
        for name in PAIR:
            self.programs.start(name, program["fieldcast-bridge"], self.write(name + ".yaml", self.bridge_text(name, ports)))
        self.web = nats.free_port()
        self.programs.start("station", program["fieldcast-station"], "--config", self.write(
            "station.yaml", f"station: soak\nweb: {{ listen: 127.0.0.1:{self.web}, local-role: viewer }}\ndds: {{ domain: {self.domain} }}\n"
                            "store: { path: station.db }\nrecord: { patterns: [\"*\"] }\n"))
        for number in (1, 2):
            self.programs.start(f"watch-{number}", program["fieldcast"], "watch", "seen-*", "--json", "--config", self.file)
        if self.options.nats:
            os.makedirs(self.path("nats"), exist_ok=True)
            self.server = nats.NatsServer(self.path("nats"), program=self.options.nats).start()
            self.programs.running["nats"] = self.server.process
            self.programs.start("forward", program["fieldcast-forward"], "--config", self.write(
                "forward.yaml", f"site: soak\ndds: {{ domain: {self.domain} }}\nqueue: {{ path: forward.db }}\n"
                                f"jetstream: {{ servers: [nats://127.0.0.1:{self.server.port}], streams: {{ create: true, keep: 1h }} }}\n"))
        wait_until(lambda: len(self.states()) == self.options.lines, 60, "the lines do not run")
        written = [f"seen-{number}/{device}/setpoint" for number in range(min(CAPTURED, self.options.lines)) for device in ("mill", "press")]
        self.callers = [Caller(self, written, number, self.options.seed, self.path(f"commands-{number}.jsonl"), self.over) for number in (1, 2)]
        for caller in self.callers:
            caller.start()

    def cli(self, command, *arguments, seconds=60):
        return run_cli(self.bin_dir, command, *arguments, "--config", self.file, seconds=seconds)

    def states(self):
        rows = [json.loads(text) for text in self.cli("status", "--json").out.splitlines() if text.startswith("{")]
        return {row["bus"]: row for row in rows if row.get("topic") == "BusStatus" and row["state"] == "running"}

    def fault(self):
        name = self.random.choice([*PAIR, *PAIR, "station", *(["forward", "nats"] if self.options.nats else [])])
        seconds = self.random.uniform(0.5, 5)
        kind = self.random.choice(["killed", "killed", "stopped"])
        self.faults.append(f"{time.strftime('%T')} {name} {kind} for {seconds:.1f} s")
        if kind == "stopped":
            self.programs.running[name].send_signal(signal.SIGSTOP)
            time.sleep(seconds)
            self.programs.running[name].send_signal(signal.SIGCONT)
            return
        self.programs.kill(name)
        time.sleep(seconds)
        if name == "nats":
            self.programs.running[name] = self.server.start().process
        else:
            self.programs.start(name)

    def measure(self, minute):
        row = {"minute": minute, "faults": len(self.faults)}
        for name, process in self.programs.running.items():
            if process.poll() is not None:
                self.failures.append(f"minute {minute}: {name} ended by itself with {process.returncode}")
                self.programs.start(name)
                continue
            used = self.programs.used(name)
            row[name] = used
            if minute == WARM:
                self.base[name] = used
            elif minute > WARM:
                for what, most in GROWTH.items():
                    # A standby has no ports, and may be the master later.
                    base = max(self.base[each][what] for each in (PAIR if name in PAIR else [name]))
                    if used[what] > base + most:
                        self.failures.append(f"minute {minute}: {name} has {used[what]} {what}, {base} after {WARM} minutes")
        row["disk"] = sum(os.path.getsize(os.path.join(folder, file)) for folder, _, files in os.walk(self.folder) for file in files
                          if not file.endswith((".jsonl", ".pcapng")))
        row.update(self.latency())
        states = self.states()
        if len(states) != self.options.lines:
            self.failures.append(f"minute {minute}: {len(states)} of {self.options.lines} lines run")
        rows = [json.loads(text) for text in self.cli("watch", "--once", "--json", "--for", "10s").out.splitlines()]
        new = {f"{each['bus']}/{each['device']}/{each['channel']}" for each in rows if time.time_ns() - each["acquired_at"] < 15e9}
        row["channels"] = len(new)
        if len(new) < 8 * self.options.lines - 8:  # one device may be offline for a moment
            self.failures.append(f"minute {minute}: {len(new)} of {8 * self.options.lines} channels have a new sample")
        self.rows.append(row)
        self.write_page()

    def latency(self):
        """Returns the time from the acquisition of samples to their line at a station: each is read as soon as it is written."""
        process = subprocess.Popen([os.path.join(self.bin_dir, "fieldcast"), "watch", "seen-*", "--json", "--for", "5s", "--config", self.file],
                                   stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        began, late = time.time_ns(), []
        for text in process.stdout:
            sample = json.loads(text)
            if sample.get("acquired_at", 0) > began + 1e9:  # those before are the state at the start
                late.append((time.time_ns() - sample["acquired_at"]) / 1e6)
        process.wait()
        late.sort()
        return {"samples": len(late), **{f"p{share}": round(late[min(len(late) - 1, len(late) * share // 100)], 2) for share in (50, 99) if late}}

    def run_for(self, seconds):
        start = time.monotonic()
        next_fault = start + self.random.uniform(20, 90)
        minute = 1
        while (now := time.monotonic()) < start + seconds:
            if now >= start + minute * MINUTE:
                self.measure(minute)
                minute = int((time.monotonic() - start) / MINUTE) + 1
            elif now >= next_fault:
                self.fault()
                next_fault = time.monotonic() + self.random.uniform(20, 90)
            else:
                time.sleep(0.2)

    def finish(self):
        self.over.set()
        for caller in getattr(self, "callers", []):
            caller.join()
        self.failures += list(self.programs.end())
        self.claim.close()

    def check(self):
        captures = sorted(glob.glob(self.path("wire-*/*.pcapng")))
        found, counts = history_check.check(self.file, [self.path(f"watch-{number}.jsonl") for number in (1, 2)],
                                            glob.glob(self.path("commands-*.jsonl")), captures, SILENT)
        self.failures += found
        return counts

    def table(self):
        names = sorted({name for row in self.rows for name in row if isinstance(row[name], dict)})
        yield ["minute", "faults", "channels", "p50 ms", "p99 ms", "disk MB", *(f"{name} MB" for name in names)]
        for row in self.rows:
            yield [row["minute"], row["faults"], row["channels"], row.get("p50", "-"), row.get("p99", "-"), f"{row['disk'] / 1e6:.1f}",
                   *(f"{row[name]['memory'] / 1e6:.1f}" if name in row else "-" for name in names)]

    def write_page(self):
        cells = ["<tr>" + "".join(f"<td>{html.escape(str(each))}</td>" for each in row) + "</tr>" for row in self.table()]
        said = "".join(f"<li>{html.escape(each)}</li>" for each in self.failures) or "<li>none</li>"
        self.write("soak.html", "<!doctype html><meta charset=utf-8><meta http-equiv=refresh content=30><title>Soak</title>"
                                "<style>body{font-family:sans-serif}td{padding:0 .7em;text-align:right}</style>"
                                f"<h1>Soak, seed {self.options.seed}</h1><h2>Broken rules</h2><ul>{said}</ul><table>{''.join(cells)}</table>")

    def write_report(self, counts):
        rows = list(self.table())
        lines = [f"# Soak of {len(self.rows)} minutes, {self.options.lines} lines, seed {self.options.seed}", "", json.dumps(counts), "",
                 "Broken rules: " + ("none" if not self.failures else ""), *(f"- {each}" for each in self.failures), "", "Faults:",
                 *(f"- {each}" for each in self.faults), "", "| " + " | ".join(rows[0]) + " |", "|" + " --- |" * len(rows[0]),
                 *("| " + " | ".join(map(str, row)) + " |" for row in rows[1:])]
        self.write("report.md", "\n".join(lines) + "\n")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--bin", required=True)
    parser.add_argument("--hours", type=float, required=True)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--lines", type=int, default=32)
    parser.add_argument("--folder")
    parser.add_argument("--nats", default=nats.PROGRAM or "")
    options = parser.parse_args()
    options.bin = os.path.abspath(options.bin)
    folder = os.path.abspath(options.folder or tempfile.mkdtemp(prefix="fieldcast-soak-"))
    os.makedirs(folder, exist_ok=True)
    print(f"page: {folder}/soak.html", flush=True)
    soak, counts = Soak(options, folder), {}
    try:
        soak.start()
        soak.run_for(options.hours * 3600)
    except KeyboardInterrupt:
        pass
    except Failure as failure:
        soak.failures.append(str(failure))
    finally:
        soak.finish()
    with contextlib.suppress(KeyboardInterrupt):
        counts = {**soak.check(), "minutes": len(soak.rows), "faults": len(soak.faults), "broken": len(soak.failures)}
    soak.write_page()
    soak.write_report(counts)
    for failure in soak.failures[:50]:
        print(f"FAIL {failure}")
    if not options.folder and not soak.failures:
        shutil.rmtree(folder)
    return report(counts, bool(soak.failures))


if __name__ == "__main__":
    sys.exit(main())
