"""Prints the coverage of each folder from a file in lcov's format, as tools/coverage.sh makes it.

usage: coverage.py FILE [--missing] [--least-lines PERCENT --least-branches PERCENT FOLDER]

A branch has two outcomes and each counts. Lines of a header that several programs include count once, as executed if any of them executes
it. --missing: also prints FILE:LINE of what was not executed. With --least-..., the exit code is 1 if FOLDER is below.
"""

import argparse
import collections
import os
import sys

ROOT = os.path.realpath(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", ".."))


class Coverage:
    def __init__(self):
        self.lines = {}  # (file, line): executions
        self.branches = {}  # (file, line, block, outcome): times taken

    def read(self, rows):
        file = ""
        for row in rows:
            kind, _, rest = row.strip().partition(":")
            if kind == "SF":
                file = os.path.relpath(os.path.realpath(rest), ROOT)
            elif kind == "DA":
                line, count = rest.split(",")[:2]
                add(self.lines, (file, int(line)), int(count))
            elif kind == "BRDA":
                line, block, outcome, count = rest.split(",")
                add(self.branches, (file, int(line), block, outcome), 0 if count == "-" else int(count))
        return self

    def by_folder(self, depth=2):
        """Returns {folder: [lines, executed lines, branches, taken branches]}, with the sum of each top folder."""
        folders = collections.defaultdict(lambda: [0, 0, 0, 0])
        for first, counts in ((0, self.lines), (2, self.branches)):
            for key, count in counts.items():
                parts = os.path.dirname(key[0]).split("/")
                for folder in {parts[0], "/".join(parts[:depth])}:
                    folders[folder][first] += 1
                    folders[folder][first + 1] += count > 0
        return dict(sorted(folders.items()))

    def missing(self):
        places = {(file, line): "line" for (file, line), count in self.lines.items() if count == 0}
        for (file, line, _, _), count in self.branches.items():
            if count == 0:
                places.setdefault((file, line), "branch")
        return sorted(places.items())


def add(counts, key, count):
    counts[key] = counts.get(key, 0) + count


def percent(part, whole):
    return 100 * part / whole if whole else 100.0


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("file")
    parser.add_argument("folder", nargs="?")
    parser.add_argument("--missing", action="store_true")
    parser.add_argument("--least-lines", type=float, default=0)
    parser.add_argument("--least-branches", type=float, default=0)
    options = parser.parse_args()
    with open(options.file, encoding="utf-8") as file:
        coverage = Coverage().read(file)
    folders = coverage.by_folder()
    print(f"{'folder':28}{'lines':>8}{'executed':>10}{'branches':>10}{'taken':>8}")
    for folder, (lines, executed, branches, taken) in folders.items():
        print(f"{folder:28}{lines:8}{percent(executed, lines):8.1f} %{branches:10}{percent(taken, branches):6.1f} %")
    if options.missing:
        for (file, line), kind in coverage.missing():
            print(f"{file}:{line}: {kind}")
    lines, executed, branches, taken = folders.get(options.folder, (0, 0, 0, 0))
    return 1 if percent(executed, lines) < options.least_lines or percent(taken, branches) < options.least_branches else 0


if __name__ == "__main__":
    sys.exit(main())
