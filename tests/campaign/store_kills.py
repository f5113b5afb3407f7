"""Kills the writer of a store before, during and after each of its operations, for the system campaign."""

import os
import shutil
import signal
import subprocess
import tempfile

from fault_shim import FaultShim
from plant import Failure


class Writing:
    """A store writer's work until it is killed. `made`: the store exists already; else the writer makes it first."""

    def __init__(self, options, scratch, what, number, report, made, step):
        """`report`: first word of its report lines. `step`: --quick uses one of so many kill instants."""
        self.options, self.what, self.number, self.report, self.made, self.step = options, what, number, report, made, step
        self.folder = os.path.join(scratch, f"{what}-{made}")
        self.template = os.path.join(self.folder, "template.db")
        os.makedirs(self.folder)
        if made:
            self.run(FaultShim(self.options.shim, self.folder, "/nowhere"), self.template, "check", "0", "0")

    def run(self, shim, path, *words):
        return subprocess.run([os.path.join(self.options.bin, "store_writer"), path, *words], capture_output=True, text=True, timeout=60,
                              env=shim.environment())

    def write(self, kill, how):
        """Runs the writer and kills it before, during or after this operation. Returns its shim, the store's path and the ended process."""
        folder = os.path.join(self.folder, "store")
        shutil.rmtree(folder, ignore_errors=True)
        os.makedirs(folder)
        path = os.path.join(folder, "store.db")
        if self.made:
            shutil.copyfile(self.template, path)
        shim = FaultShim(self.options.shim, self.folder, path)
        shim.kill_at, shim.kill_how = kill, how
        return shim, path, self.run(shim, path, self.what, str(self.number))

    def instants(self):
        """Returns the kill instants: before, during and after each operation of a complete run."""
        operations = self.write(0, 0)[0].operations
        every = [(kill, how) for kill in range(1, operations + 1) for how in range(3)]
        return every[::self.step] if self.options.quick else every

    def kill(self, kill, how):
        """Returns True if the writer was killed. Raises Failure if the store lacks reported data."""
        shim, path, killed = self.write(kill, how)
        shim.clear()
        told = [row.split()[1] for row in killed.stdout.splitlines() if row.startswith(self.report + " ")][-1:] or ["0"]
        checked = self.run(shim, path, "check", *(["0", *told] if self.what == "commands" else [*told, "0"]))
        if checked.returncode != 0:
            raise Failure(f"killed at operation {kill} of {self.what}, {('before', 'within', 'after')[how]} it: "
                          f"{checked.stdout}{checked.stderr}")
        return killed.returncode == -signal.SIGKILL


def killed_at_every_instant(options):
    """Kills a store's writer before, during and after each of its operations: all reported data must be stored."""
    counts = {"instants": 0, "kills": 0}
    with tempfile.TemporaryDirectory() as scratch:
        for writing in (Writing(options, scratch, "commands", 8, "taken", True, 5), Writing(options, scratch, "samples", 3, "stored", True, 5),
                        Writing(options, scratch, "commands", 1, "taken", False, 60)):
            for kill, how in writing.instants():
                counts["instants"] += 1
                counts["kills"] += writing.kill(kill, how)
    # The number of operations depends on the timing of batches, so a second run may have fewer.
    if counts["kills"] < 0.8 * counts["instants"]:
        raise Failure(f"of {counts['instants']} instants only {counts['kills']} were reached")
    return counts
