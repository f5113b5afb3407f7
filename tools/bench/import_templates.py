#!/usr/bin/env python3
"""Imports each file of a directory as a device template, and counts the results of files and values.

usage: import_templates.py FOLDER [BIN_DIR]

For wb-mqtt-serial: its directory templates/, or the one that its build makes from the Jinja files. Keeps no output.
"""

import collections
import json
import os
import re
import subprocess
import sys
import tempfile

from progress import Progress

SHOWN = 12  # reasons of each kind


def kind_of(words):
    """Removes numbers and quoted names from the words, to group equal reasons."""
    return re.sub(r"'[^']*'", "'..'", re.sub(r"\b(0x[\dA-Fa-f]+|\d+)\b", "N", words))[:90]


def import_file(program, path, folder):
    """Returns (exit code, [row of each value])."""
    done = subprocess.run([program, "import", path, "--template", "--json", "--force", "--out", folder + "/"], capture_output=True,
                          text=True, timeout=120)
    return done.returncode, [json.loads(line) for line in done.stdout.splitlines()], done.stderr


def main(source, bin_dir="build/bin"):
    program = os.path.join(bin_dir, "fieldcast")
    files, values, reasons, changes = (collections.Counter() for _ in range(4))
    with tempfile.TemporaryDirectory() as folder:
        names = sorted(os.listdir(source))
        with Progress("importing", None, len(names)) as progress:
            for number, name in enumerate(names):
                progress.show(number)
                code, rows, said = import_file(program, os.path.join(source, name), folder)
                fates = collections.Counter(row["fate"] for row in rows)
                values += fates
                taken = fates["moved"] + fates["changed"]
                files["whole" if code == 0 else "in part" if code == 1 and taken else "refused"] += 1
                if code > 1:
                    reasons[kind_of(said.splitlines()[-1])] += 1
                reasons.update(kind_of(row["why"]) for row in rows if row["fate"] == "refused")
                changes.update(kind_of(re.sub(r"where .*?, and", "where .., and", change)) for row in rows if row["fate"] == "changed"
                               for change in row["why"].split("; "))
    print(f"files: {sum(files.values())}: " + ", ".join(f"{count} {fate}" for fate, count in files.most_common()))
    print(f"values: {sum(values.values())}: " + ", ".join(f"{count} {fate}" for fate, count in values.most_common()))
    for title, counts in [("not moved:", reasons), ("moved with a change:", changes)]:
        print(title)
        for words, count in counts.most_common(SHOWN):
            print(f"{count:7}  {words}")


if __name__ == "__main__":
    main(*sys.argv[1:])
