"""Holds the table "To add something" of docs/architecture.md against the tree: the files that name an example of each kind are
those that the table lists, and no more of them than the limit.

usage: adding_test.py SOURCE_DIR
"""

import collections
import os
import re
import sys
import unittest

SOURCE_DIR = ""
ROOTS = ("bridge", "config", "core", "docs", "idl", "tests", "tools")
# Data made by tests, and pages that list everything that changed.
OUTSIDE = re.compile(r"^tests/(fuzz/corpus|campaign)/|^docs/architecture\.md$|^tests/docs/adding_test\.py$")

# `names`: what a file contains that had to be touched. `most`: files, without those of `uses`: users of the example, which
# something new of its kind does not have yet.
Example = collections.namedtuple("Example", "names most uses")
EXAMPLES = {
    "a topic": Example(
        r"\bProgramSession\b|kProgramSessionTopic|ProgramSessionPubSubType|ProgramSessionReport|program_session", 10,
        ["bridge/bridge_wiring.cpp", "bridge/client/", "bridge/program/", "tests/bridge/bridge_test.cpp", "tests/bridge/client/", "tests/bridge/program/", "tests/tools/", "tools/"]),
    "a subcommand": Example(
        r'\bmodule_command\b|command/module\.cpp|fieldcast module\b|"fieldcast", "module"', 5, ["bridge/program/", "tests/bridge/program/"]),
    "a key of the configuration": Example(r"\blow[-_]latency\b", 15, ["docs/troubleshooting.md", "tools/cli/doctor/"]),
    "a port": Example(
        # The port of RFC 2217 is made of the same parts.
        r"\bTcpPortSpec\b|\bStreamPort\b|stream_port", 14,
        ["bridge/port/rfc2217_port.hpp", "bridge/port/tcp_opening.hpp", "tests/bridge/bus/", "tests/bus/", "tests/core/model/", "tests/schedule/", "tests/tools/", "tools/cli/", "tools/sim/check/"]),
    "a protocol in C++": Example(
        r"\bmitsubishi_fx\b|\bfx_device\b|\bFxDevice\b", 17, []),
    "a family of records in the store": Example(
        r"\bAlarmLifeTable\b|alarm_life_table", 6, ["bridge/buses/", "tests/bridge/bridge_alarms_test.cpp", "tools/"]),
}
# Each has a test and a page, which lie where those of its folder are.
EVERYWHERE = ["docs/", "tests/"]


def read(path):
    with open(os.path.join(SOURCE_DIR, path), encoding="utf-8", errors="replace") as file:
        return file.read()


def rows(text):
    """{what is added: the paths of its row} of the table in this document."""
    table = text.split("## To add something")[1].split("\n## ")[0]
    cells = [[cell.strip() for cell in line.split("|")[1:3]] for line in table.splitlines() if line.startswith("| ")]
    return {name.split(",")[0]: re.findall(r"`([\w.+-]+/[\w./+-]+)`", files) for name, files in cells[2:]}


def tree():
    for root in ROOTS:
        for folder, folders, names in os.walk(os.path.join(SOURCE_DIR, root)):
            folders[:] = [one for one in folders if one not in ("node_modules", "__pycache__")]
            for name in names:
                path = os.path.relpath(os.path.join(folder, name), SOURCE_DIR)
                if not OUTSIDE.search(path):
                    yield path


def is_below(path, places):
    return any(path == place or path.startswith(place.rstrip("/") + "/") for place in places)


def faults(files, example, places):
    """Faults of the files that name an example; `places`: the paths of its row."""
    touched = [path for path in files if not is_below(path, example.uses)]
    found = [f"{path} names it and is not in the row" for path in touched if not is_below(path, places + EVERYWHERE)]
    found += [f"no file of {use} names it any more" for use in example.uses if not any(is_below(path, [use]) for path in files)]
    if len(touched) > example.most:
        found.append(f"{len(touched)} files instead of {example.most}: {' '.join(touched)}")
    return found


class Adding(unittest.TestCase):
    def test_each_path_of_the_table_exists(self):
        for name, paths in rows(read("docs/architecture.md")).items():
            for path in (path for path in paths if "NAME" not in path):
                with self.subTest(name):
                    self.assertTrue(os.path.exists(os.path.join(SOURCE_DIR, path)), path)

    def test_the_files_of_each_example_are_those_of_its_row(self):
        texts = {path: read(path) for path in tree()}
        table = rows(read("docs/architecture.md"))
        for name, example in EXAMPLES.items():
            with self.subTest(name):
                files = sorted(path for path, text in texts.items() if re.search(example.names, text))
                self.assertEqual(faults(files, example, table[name]), [])

    def test_planted_faults_are_found(self):
        example = Example("", 2, ["tools/user/"])
        files = ["idl/a.idl", "tools/user/b.cpp"]
        self.assertEqual(faults(files, example, ["idl"]), [])
        self.assertEqual(faults(files, example, ["bridge"]), ["idl/a.idl names it and is not in the row"])
        self.assertEqual(faults(files[:1], example, ["idl"]), ["no file of tools/user/ names it any more"])
        self.assertEqual(len(faults([*files, "idl/c.idl", "idl/d.idl"], example, ["idl"])), 1)


if __name__ == "__main__":
    SOURCE_DIR = sys.argv[1]
    unittest.main(argv=sys.argv[:1], verbosity=2)
