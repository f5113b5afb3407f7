"""Runs every command of documents as a reader would, block by block, and compares the outputs with
those shown.

usage: run.py BIN_DIR SOURCE_DIR DOCUMENT..
           runs in a sandbox; DOCUMENT is a path from SOURCE_DIR
       run.py --installed ROOT [--systemd] [--packages DIR] SOURCE_DIR DOCUMENT..
           runs the blocks marked `in the installed system` as root, chrooted to ROOT;
           those `with systemd` need --systemd, those `with packages` need their directory

tests/docs/README.md lists the markers. The last line counts the blocks that ran and those that did
not.
"""

import argparse
import os
import re
import shutil
import subprocess
import sys
import time

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import log_lines  # noqa: E402
from comparison import difference  # noqa: E402
from document import Fault, STOP, inline_commands, is_configuration, parse, unused_files  # noqa: E402
from fragment import whole, whole_declaration  # noqa: E402
from sandbox import Sandbox  # noqa: E402
from steady import steadily  # noqa: E402
from tables import CHECKS  # noqa: E402

PROGRAMS = ["fieldcast", "fieldcast-bridge", "fieldcast-sim", "fieldcast-port", "fieldcast-station", "fieldcast-forward"]
MATCH_SECONDS = 10  # limit until a program prints what the document shows, or ends as expected
INSTALLED, SOURCE_TREE = "in the installed system", "in the source tree"
NOWHERE = ("with hardware", "with a compiler", "with a login", "with a container engine", "from a repository")


class Runner:
    def __init__(self, sandbox, path):
        self.sandbox, self.path = sandbox, path
        with open(os.path.join(sandbox.source_dir, path), encoding="utf-8") as file:
            self.text = file.read()
        self.unchecked = []  # configurations that are written but not checked yet
        self.last = None  # function that returns the output of the last `sh` block
        self.count = {"ran": 0, "only in the installed system": 0, "only in the source tree": 0, "files": 0, "outputs compared": 0, "log lines found in the sources": 0,
                      "rows of tables checked": 0,
                      "inline commands checked against --help": 0}
        self.helps = {}

    def run(self):
        blocks = parse(self.path, self.text)
        for block in unused_files(blocks):
            raise block.fault(f"nothing in the document uses {block.markers['file']}: use it in a command, or write "
                              "<!-- tried by: TEST --> beside it")
        if any(command.startswith("fieldcast capture ") for block in blocks if block.language == "sh" for command in block.commands()):
            self.sandbox.wait_for_turn()
        for block in blocks:
            if block.language == STOP:
                self.stop(block)
            elif block.language == "sh":
                self.check_configurations()
                self.shell(block)
            elif block.language == "table":
                marker = next(iter(block.markers))
                self.count["rows of tables checked"] += CHECKS[marker](block, self.sandbox)
            elif "output" in block.markers:
                self.output(block)
            elif "log" in block.markers:
                self.log(block)
            elif "fragment" in block.markers:
                self.fragment(block)
            elif "file" in block.markers:
                self.file(block)
        self.check_configurations()
        for place, command in inline_commands(self.path, self.text, PROGRAMS):
            self.check_options(command, lambda words, where=place: Fault(f"{where}: {words}"))
            self.count["inline commands checked against --help"] += 1
        if faults := self.sandbox.stop():
            raise Fault(f"{self.path}: at the end: " + "\n".join(faults))

    def stop(self, block):
        if faults := self.sandbox.stop():
            raise block.fault("\n".join(faults))

    def file(self, block):
        self.sandbox.write(block.markers["file"], block.text)
        self.count["files"] += 1
        if test := block.markers.get("tried by"):
            self.check_that_it_is_tried(block, test)
        if is_configuration(block):
            self.unchecked.append((block, block.markers["file"]))

    def check_that_it_is_tried(self, block, test):
        path, name = os.path.join(self.sandbox.source_dir, test), block.markers["file"]
        if not os.path.exists(path):
            raise block.fault(f"tried by: there is no {test}")
        with open(path, encoding="utf-8") as file:
            if name not in file.read():
                raise block.fault(f"tried by: {test} does not name {name}")

    def fragment(self, block):
        try:
            if block.markers["fragment"] == "declaration":
                self.sandbox.write(f"protocols/declared-{block.line}.yaml", whole_declaration(block.text))
                text = whole("", f"channels declared-{block.line}")
            else:
                text = whole(block.text, block.markers["fragment"])
        except ValueError as error:
            raise block.fault(str(error)) from error
        name = f"fragment-{block.line}.yaml"
        self.sandbox.write(name, text)
        self.count["files"] += 1
        self.unchecked.append((block, name))
        if "refused" in block.markers:
            self.check_configurations()

    def check_configurations(self):
        for block, name in self.unchecked:
            code, said = self.sandbox.run(f"fieldcast-bridge --check {name}")
            self.last = lambda words=said: words
            if "refused" in block.markers:
                if code != 3 or block.markers["refused"] not in said:
                    raise block.fault(f"not refused with '{block.markers['refused']}': exit code {code}\n{said}")
            elif code != 0:
                raise block.fault(f"fieldcast-bridge --check {name}: exit code {code}\n{said}")
        self.unchecked = []

    def shell(self, block):
        if INSTALLED in block.markers or SOURCE_TREE in block.markers:
            return self.only_parsed(block)
        if "runs until stopped" in block.markers:
            return self.start(block)
        script = "\n".join(block.commands())
        wanted = block.markers.get("exit code") or "0"
        end = time.monotonic() + (MATCH_SECONDS if "after a while" in block.markers else 0)
        code, said = self.sandbox.run(script)
        while str(code) not in wanted.split(" or ") and time.monotonic() < end:
            time.sleep(0.2)
            code, said = self.sandbox.run(script)
        if str(code) not in wanted.split(" or "):
            raise block.fault(f"exit code {code} instead of {wanted} of\n{script}\n--- it said:\n{said}")
        self.count["ran"] += len(block.commands())
        first = [said]
        self.last = lambda: first.pop() if first else self.sandbox.run(script)[1]

    def start(self, block):
        commands = block.commands()
        if len(commands) != 1:
            raise block.fault("a block that runs until stopped has one command")
        try:
            started = self.sandbox.start(commands[0], block.markers["runs until stopped"] or None)
        except RuntimeError as error:
            raise block.fault(str(error)) from error
        self.count["ran"] += 1
        self.last = lambda: self.sandbox.outside(started.said())

    def only_parsed(self, block):
        done = subprocess.run(["bash", "-n", "-c", block.text], capture_output=True, text=True)
        if done.returncode:
            raise block.fault(f"bash cannot read it: {done.stderr}")
        for command in block.commands():
            for part in re.split(r"[|;]|&&", command):
                self.check_options(part.removeprefix("sudo ").strip(), block.fault)
                if SOURCE_TREE in block.markers and "/" in (part.split() or [""])[0]:
                    script = part.split()[0]
                    if not os.access(os.path.join(self.sandbox.source_dir, script), os.X_OK):
                        raise block.fault(f"there is no program {script} in the source tree")
        self.count["only " + (INSTALLED if INSTALLED in block.markers else SOURCE_TREE)] += len(block.commands())
        self.last = None

    def output(self, block):
        self.check_configurations()
        if self.last is None:
            raise block.fault("an output stands behind the `sh` block that says it")
        end = time.monotonic() + MATCH_SECONDS
        ordered = block.markers["output"] != "in any order"
        while fault := difference(block.text, said := self.last(), ordered):
            if time.monotonic() > end:
                raise block.fault(f"the output differs\n{fault}\n--- all that was said:\n{said}")
            time.sleep(0.1)
        self.count["outputs compared"] += 1

    def log(self, block):
        for number, line in enumerate(block.text.splitlines()):
            if line.strip() and not log_lines.known(self.sandbox.source_dir, line):
                raise Fault(f"{self.path}:{block.line + number}: no source says '{line.strip()}'; the nearest: "
                            f"{log_lines.nearest(self.sandbox.source_dir, line)}")
            self.count["log lines found in the sources"] += bool(line.strip())

    def check_options(self, command, fault):
        """Checks the subcommand and each option of our programs with --help."""
        words = command.split()
        if not words or words[0] not in PROGRAMS:
            return
        subcommand = [words[0]] + ([words[1]] if words[0] == "fieldcast" and len(words) > 1 and not words[1].startswith("-") else [])
        if subcommand in (["fieldcast", "user"], ["fieldcast", "token"]) and len(words) > 2:
            subcommand.append(words[2])
        key = " ".join(subcommand)
        if key not in self.helps:
            self.helps[key] = self.sandbox.run(key + " --help")
        code, said = self.helps[key]
        if code != 0:
            raise fault(f"there is no '{key}': {said}")
        for option in re.findall(r"(?<!\S)(--?[a-z][\w-]*)", command):
            if not re.search(rf"(?<![\w-]){option}(?![\w-])", said):
                raise fault(f"{key} has no option {option}")


def run_installed(root, with_systemd, packages, source_dir, documents):
    """Runs each marked block as root in ROOT, in order, in a directory with the document's files.
    Returns the numbers of blocks that ran and that did not."""
    ran = left = 0
    for path in documents:
        with open(os.path.join(source_dir, path), encoding="utf-8") as file:
            blocks = parse(path, file.read())
        folder = os.path.join(root, "tmp", "fieldcast-documents")
        os.makedirs(folder, exist_ok=True)
        for name in os.listdir(packages) if packages else []:
            if name.endswith(".deb"):
                shutil.copy(os.path.join(packages, name), folder)
        for block in blocks:
            if "file" in block.markers and block.language != "sh":
                target = os.path.join(folder, block.markers["file"])
                os.makedirs(os.path.dirname(target), exist_ok=True)
                with open(target, "w", encoding="utf-8") as file:
                    file.write(block.text)
            if INSTALLED in block.markers:
                needs = block.markers[INSTALLED]
                if needs in NOWHERE or "systemd" in needs and not with_systemd or "packages" in needs and not packages:
                    left += len(block.commands())
                    print(f"{path}:{block.line}: not run: {needs}")
                    continue
                shell = ["bash", "-euo", "pipefail", "-c", f"cd /tmp/fieldcast-documents\n{block.text}"]
                done = subprocess.run((["chroot", root] if root != "/" else []) + shell, stdout=subprocess.PIPE,
                                      stderr=subprocess.STDOUT, text=True, timeout=300)
                if done.returncode:
                    raise block.fault(f"exit code {done.returncode}\n{done.stdout}")
                ran += len(block.commands())
        shutil.rmtree(folder)
    print(f"in the installed system: {ran} commands ran, {left} did not")


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("--installed", metavar="ROOT")
    parser.add_argument("--systemd", action="store_true")
    parser.add_argument("--packages", metavar="DIR")
    parser.add_argument("arguments", nargs="+")
    given = parser.parse_args()
    try:
        if given.installed:
            return run_installed(given.installed, given.systemd, given.packages, given.arguments[0], given.arguments[1:])
        bin_dir, source_dir, *documents = given.arguments
        def run(path):
            sandbox = Sandbox(bin_dir, source_dir)
            try:
                runner = Runner(sandbox, path)
                runner.run()
                return runner
            finally:
                sandbox.close()

        for path in documents:
            begin = time.monotonic()
            # Documents show the output of a healthy bridge; that of a stalled one differs.
            runner = steadily(lambda path=path: run(path), Fault)
            counts = ", ".join(f"{number} {what}" for what, number in runner.count.items() if number)
            print(f"{path}: {counts or 'no command'}; {time.monotonic() - begin:.1f} s")
    except Fault as fault:
        sys.exit(str(fault))


if __name__ == "__main__":
    main()
