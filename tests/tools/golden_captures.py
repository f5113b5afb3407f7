"""Makes the 24 golden captures, whose explanation must be the same on every processor: the frames of
tests/vectors as traces, the captures of the fuzzer's corpus, new captures of the demo's plant,
and ten minutes of the engine in virtual time.

usage: golden_captures.py BIN_DIR SOURCE_DIR FOLDER

FOLDER/show.sh writes the explanations with the programs of any processor: show.sh BIN_DIR OUT_DIR.
Both are absolute.
"""

import json
import os
import re
import shutil
import sys

from plant import Plant, run_cli

# Vectors by protocol: file, framing of its vectors or empty for all.
TRACES = {
    "modbus-rtu": ("modbus", "rtu"), "modbus-ascii": ("modbus", "ascii"), "modbus-tcp": ("modbus", "tcp"),
    "omron-hostlink": ("hostlink", ""), "omron-hostlink.fins": ("fins", ""), "omron-hostlink.tunnel": ("tunnel", ""),
    "mitsubishi-fx": ("fx", ""), "s7-ppi": ("ppi", ""), "s7-freeport": ("freeport", ""), "dtc": ("dtc", ""),
}
CORPUS = ["mixer", "other-order", "packing", "yard"]
BUSES = ["press-shop", "utilities", "packing", "assembly", "lift", "mixer", "yard"]
PLANS = {"plan-1": "--seed 1", "plan-2": "--seed 2", "plan-faults": "--seed 3 --faults faults.yaml"}
COUNT = 24
FAULTS = """buses: { press-shop: { noise: 1e-6, devices: { press-2: { delay: { base: 5ms, spread: 2ms }, loss: 0.01, garble: 0.02 } } } }\n"""


def frames(vector):
    """Returns (mark, hexadecimal bytes) of each frame."""
    steps = vector.get("exchange") or [{"dir": ">", "hex": vector.get("request_hex", "")},
                                       {"dir": "<", "hex": vector.get("response_hex", "")}]
    sent = {">", "M>S", "H>P", "PC>PLC"}
    return [(">>" if step["dir"] in sent else "<<", step["hex"]) for step in steps if step.get("hex")]


def write_trace(source, path, name, framing):
    with open(f"{source}/tests/vectors/{name}.json", encoding="utf-8") as file:
        vectors = [vector for vector in json.load(file) if not framing or vector.get("framing") == framing]
    with open(path, "w", encoding="utf-8") as out:
        for vector in vectors:
            out.writelines(f"{name} {mark} {frame}\n" for mark, frame in frames(vector))


def plant_text(source):
    with open(f"{source}/config/examples/demo.yaml", encoding="utf-8") as file:
        text = re.sub(r"(?m)^dds:.*$", "", file.read()).replace("/tmp/fieldcast-demo", "{run}")
    return re.sub(r"(?m)^bridge:.*$", f"bridge: golden-{os.getpid()}", text)


def record(bin_dir, source, folder):
    with Plant(bin_dir, plant_text(source)):
        for bus in BUSES:
            result = run_cli(bin_dir, "capture", bus, "--out", f"{folder}/demo-{bus}.pcapng", "--for", "4s")
            if result.code != 0:
                raise SystemExit(f"capture of {bus}: {result.err}")


def main():
    bin_dir, source, folder = map(os.path.abspath, sys.argv[1:4])
    os.makedirs(folder)
    lines = ["#!/bin/sh", "set -e", 'bin=$1 out=$2', 'cd "$(dirname "$0")"', 'mkdir -p "$out"']

    def show(name, arguments):
        lines.append(f'"$bin/fieldcast" {arguments} >>"$out/{name}" || echo "exit code $?" >>"$out/{name}"')

    for name, (file, framing) in TRACES.items():
        write_trace(source, f"{folder}/{name}.trace", file, framing)
        for option in ["--fields", "--json"]:
            show(name, f"inspect {name.split('.')[0]} {option} <{name}.trace 2>&1")
    shutil.copy(f"{source}/config/examples/demo.yaml", folder)
    record(bin_dir, source, folder)
    captures = [f"demo-{bus}" for bus in BUSES]
    for name in CORPUS:
        shutil.copy(f"{source}/tests/fuzz/corpus/capture/{name}.pcapng", folder)
    for name in CORPUS + captures:
        for option in ["--fields", "--json"]:
            show(name, f"inspect {name}.pcapng --config demo.yaml {option} 2>&1")
    with open(f"{folder}/faults.yaml", "w", encoding="utf-8") as file:
        file.write(FAULTS)
    for name, options in PLANS.items():
        show(name, f"plan demo.yaml --simulate 10min --json {options}")
    assert len(TRACES) + len(CORPUS) + len(captures) + len(PLANS) == COUNT
    with open(f"{folder}/show.sh", "w", encoding="utf-8") as file:
        file.write("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
