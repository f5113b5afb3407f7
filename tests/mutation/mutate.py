"""Counts how many small changes of core the unit tests notice.

usage: mutate.py [--mutants N] [--seed S] [--minutes M] [--under core/PART] [--jobs J] [--folder DIR]

All mutants are compiled into one tree, DIR/tree, and FIELDCAST_MUTANT=K switches mutant K on: an operator, a constant, a condition or a
removed statement. A mutant that does not compile does not count. Each program runs those of its tests that evaluate the mutant (all of
them if it is only one), until one fails; the mutant is then killed, also by a crash or by ten times the usual time. Survivors are printed
with place and rule; the last line is one JSON object. --minutes ends the run early: the order is random, so that the share of the mutants
that ran stays an estimate. A second run continues where the first ended, unless a program was built again: outcomes are in DIR/outcomes.
"""

import argparse
import collections
import concurrent.futures
import json
import os
import random
import re
import subprocess
import sys
import time

from points import Finder

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.realpath(os.path.join(HERE, "..", ".."))
TESTS = {name: "*" for name in ["core_test", "lzw_test", "program_test", "telnet_test", "dispatch_test", "plan_test", "schedule_test", "bus_test",
                                "bus_run_test", "protocol_test", "declared_test", "transcript_test", "config_test", "late_test"]}
# Of these, only the tests that last for about a second at most: nearly every change of core/bus would run all of them.
TESTS.update({"simulation_test": "-Simulation.*:*Storm*:Gateway.*", "shared_wire_test": "NotSentTest.*"})
Run = collections.namedtuple("Run", "program filter seconds")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--folder", default="build-mutants")
    parser.add_argument("--mutants", type=int, default=2000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--minutes", type=float, default=float("inf"))
    parser.add_argument("--under", default="core")
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    options = parser.parse_args()
    folder = os.path.realpath(options.folder)
    tree = os.path.join(folder, "tree")
    files = {os.fsdecode(name) for name in output("git", "ls-files", "-z").split(b"\0") if name}
    points = choose(find_points(files, options.under), options.mutants, options.seed)
    mutants = build(tree, folder, files, dict(enumerate(points, 1)), options.jobs)
    name = os.path.join(folder, "outcomes")
    outcomes = read_outcomes(name, max(os.path.getmtime(os.path.join(folder, "build", "bin", test)) for test in TESTS))
    runs = measure(folder)
    end = time.monotonic() + 60 * options.minutes
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool, open(name, "a", encoding="ascii") as file:
        def judge(number):
            if time.monotonic() < end:
                outcomes[number] = outcome(number, runs[number])
                print(number, outcomes[number], file=file, flush=True)
        list(pool.map(judge, sorted(mutants.keys() - outcomes.keys())))
    report(mutants, outcomes, options)


def read_outcomes(name, built):
    """Returns the outcomes of an earlier run by number of the mutant; removes those that are older than the programs."""
    if not os.path.exists(name) or os.path.getmtime(name) < built:
        open(name, "w").close()
    with open(name, encoding="ascii") as file:
        return {int(number): said.strip() for number, _, said in (line.partition(" ") for line in file)}


def output(*command):
    return subprocess.run(command, cwd=ROOT, stdout=subprocess.PIPE, check=True).stdout


def find_points(files, under):
    folders = collections.defaultdict(list)
    for name in sorted(files):
        if name.startswith(under) and name.endswith(".cpp"):
            folders[os.path.dirname(name)].append(os.path.join(ROOT, name))
    finder = Finder(os.path.join(ROOT, under))
    for sources in folders.values():
        finder.read(sources, ["-std=c++20", "-I", ROOT, "-w"])
    print(f"{len(finder.points)} places of mutants in {under}", flush=True)
    return sorted(finder.points.values())


def choose(points, count, seed):
    """Returns at most `count` points, of which none overlaps a second one."""
    chosen, taken = [], collections.defaultdict(list)
    for point in random.Random(seed).sample(points, len(points)):
        if len(chosen) < count and all(point.end <= start or end <= point.start for start, end in taken[point.file]):
            taken[point.file].append((point.start, point.end))
            chosen.append(point)
    return chosen


def write_tree(tree, files, mutants):
    """Copies the sources with the mutants; writes a file only if it changes, so that only this is compiled again."""
    changes = collections.defaultdict(list)
    for number, point in mutants.items():
        changes[os.path.relpath(point.file, ROOT)].append((point.start, point.end, point.text.replace(b"{}", b"%d" % number, 1)))
    for name in files:
        with open(os.path.join(ROOT, name), "rb") as file:
            text = file.read()
        for start, end, new in sorted(changes[name], reverse=True):
            text = text[:start] + new + text[end:]
        target = os.path.join(tree, name)
        os.makedirs(os.path.dirname(target), exist_ok=True)
        if not os.path.exists(target) or open(target, "rb").read() != text:
            with open(target, "wb") as file:
                file.write(text)
            os.chmod(target, os.stat(os.path.join(ROOT, name)).st_mode)


def build(tree, folder, files, mutants, jobs):
    """Builds the tests; drops what does not compile, until all of it does. Returns the mutants that are left."""
    built = os.path.join(folder, "build")
    flags = f"-w -Wno-narrowing -ferror-limit=0 -include {os.path.join(tree, os.path.relpath(HERE, ROOT), 'mutant.hpp')}"
    while True:
        write_tree(tree, files, mutants)
        output("cmake", "-S", tree, "-B", built, "-G", "Ninja", "-DFIELDCAST_BENCHES=OFF", "-DFIELDCAST_UNITY=ON", "-DFIELDCAST_PCH=OFF",
               "-DCMAKE_BUILD_TYPE=Debug", "-DCMAKE_CXX_COMPILER=clang++-19", "-DCMAKE_C_COMPILER=clang-19", f"-DCMAKE_CXX_FLAGS_DEBUG=-O1 {flags}")
        done = subprocess.run(["ninja", "-C", built, "-j", str(jobs), "-k", "0", *TESTS], stdout=subprocess.PIPE, text=True, check=False)
        if done.returncode == 0:
            return mutants
        places = {(os.path.relpath(os.path.join(built, name), tree), int(line))
                  for name, line in re.findall(r"(\S+?):(\d+):\d+:\s+(?:error|note|required)", done.stdout)}
        bad = {number for number, point in mutants.items()
               for line in range(point.text.count(b"\n") + 1) if (os.path.relpath(point.file, ROOT), point.line + line) in places}
        if not bad:
            sys.exit("the tree with mutants cannot be built:\n" + done.stdout[-3000:])
        mutants = {number: point for number, point in mutants.items() if number not in bad}
        print(f"{len(bad)} mutants do not compile", flush=True)


def measure(folder):
    """Runs the tests without a mutant; returns the runs that evaluate each mutant."""
    runs = collections.defaultdict(list)
    for test in TESTS:
        program, marks = os.path.join(folder, "build", "bin", test), os.path.join(folder, test + ".reached")
        open(marks, "w").close()
        began = time.monotonic()
        subprocess.run([program, "--gtest_brief=1", f"--gtest_filter={TESTS[test]}"], env={**os.environ, "FIELDCAST_REACHED": marks}, check=True)
        whole = time.monotonic() - began
        reaching = collections.defaultdict(dict)
        for line in open(marks, encoding="ascii"):
            name, milliseconds, *numbers = line.split()
            for number in numbers:
                reaching[int(number)][name] = int(milliseconds) / 1000
        for number, tests in reaching.items():
            names = ":".join(tests)
            # 128 KiB is the longest argument. "*" includes what runs before the first test.
            some = len(names) < 100000 and "*" not in tests
            runs[number].append(Run(program, names if some else TESTS[test], sum(tests.values()) if some else whole))
            # The first test that needs a static value computes it; other tests may compare it.
            if some and len(tests) == 1:
                runs[number].append(Run(program, TESTS[test], whole))
    return runs


def outcome(number, runs):
    for run in sorted(runs, key=lambda each: each.seconds):
        try:
            done = subprocess.run([run.program, "--gtest_brief=1", "--gtest_fail_fast", f"--gtest_filter={run.filter}"],
                                  stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, timeout=10 + 10 * run.seconds, check=False,
                                  env={**os.environ, "FIELDCAST_MUTANT": str(number)})
        except subprocess.TimeoutExpired:
            return "too slow"
        if done.returncode != 0:
            return "killed"
    return "survived" if runs else "not reached"


def report(mutants, outcomes, options):
    parts = collections.defaultdict(list)
    for number in sorted(outcomes, key=lambda each: mutants[each]):
        point, killed = mutants[number], outcomes[number] in ("killed", "too slow")
        name = os.path.relpath(point.file, ROOT)
        parts["/".join(name.split("/")[:2])].append(killed)
        if not killed:
            print(f"{name}:{point.line}: {outcomes[number]}: {point.rule} (mutant {number})")
    for part, killed in sorted(parts.items()):
        print(f"{part:24}{sum(killed):5} of {len(killed):5} killed, {100 * sum(killed) / len(killed):5.1f} %")
    count = collections.Counter(outcomes.values())
    killed = count["killed"] + count["too slow"]
    print(json.dumps({"seed": options.seed, "compiled": len(mutants), "ran": len(outcomes), "killed": killed,
                      "too_slow": count["too slow"], "not_reached": count["not reached"],
                      "share": round(killed / max(1, len(outcomes)), 3)}))


if __name__ == "__main__":
    main()
