"""Tries the shared memory of the installed Fast DDS: readers are killed while they join and read,
then a new one must find the writer.

usage: shared_memory_trial.py BIN_DIR [READERS]

Not part of the tests, because Fieldcast disables shared memory (see bridge/dds/README.md). Run it
again with another Fast DDS: ctest -C trial. It runs over UDP first, which must pass. Exit code 0:
shared memory passed, 1: it failed. Files left in /dev/shm are counted and removed.
"""

import os
import random
import subprocess
import sys
import threading
import time

from plant import claim_domain, shared_memory

READERS = 14  # at the same time
ROUNDS = 6
SEED = 1
LONGEST_LIFE_SECONDS = 1.5  # of a reader that is killed
GOOD_SECONDS = 2            # for a new reader, which takes up to one over UDP
NEW_READER_SECONDS = 10     # timeout of a new reader


class Trial:
    def __init__(self, bin_dir, transport, domain):
        self.transport, self.program, self.arguments = transport, os.path.join(bin_dir, "shared-memory-trial"), [str(domain), transport]
        self.chance = random.Random(SEED)
        self.before = shared_memory()
        self.writer = None

    def start(self, role, **options):
        return subprocess.Popen([self.program, role, *self.arguments], **options)

    def say(self, text):
        print(f"{self.transport}: {text}", flush=True)

    def writer_share(self):
        """Returns the CPU use of the writer; one that waits for a dead reader uses a whole core."""
        def seconds():
            with open(f"/proc/{self.writer.pid}/stat", encoding="ascii") as stat:
                fields = stat.read().rpartition(")")[2].split()
            return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")
        before, began = seconds(), time.monotonic()
        time.sleep(1)
        return (seconds() - before) / (time.monotonic() - began)

    def kill_one(self, life):
        reader = self.start("read", stdout=subprocess.DEVNULL)
        time.sleep(life)
        reader.kill()
        reader.wait()

    def kill_together(self, readers):
        threads = [threading.Thread(target=self.kill_one, args=(self.chance.uniform(0.02, LONGEST_LIFE_SECONDS),)) for _ in range(readers)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()

    def look(self):
        """Returns the seconds until a new reader has a sample, None if it has none."""
        began = time.monotonic()
        reader = self.start("look", stdout=subprocess.PIPE, text=True)
        timer = threading.Timer(NEW_READER_SECONDS, reader.kill)
        timer.start()
        line = reader.stdout.readline()
        took = time.monotonic() - began
        timer.cancel()
        try:
            reader.wait(NEW_READER_SECONDS)
        except subprocess.TimeoutExpired:
            self.say(f"the new reader did not leave within {NEW_READER_SECONDS} s")
            reader.kill()
            reader.wait()
        reader.stdout.close()
        return took if line == "sample\n" else None

    def run(self, readers):
        """Returns whether a new reader always found the writer in time."""
        passed = True
        self.writer = self.start("write")
        try:
            for number in range(ROUNDS + 1):
                if number > 0:
                    self.kill_together(readers)
                took = self.look()
                self.say(f"{number * readers} readers killed; {len(shared_memory() - self.before)} in /dev/shm; writer {self.writer_share():.2f} core; "
                         + (f"a new reader: no sample within {NEW_READER_SECONDS} s" if took is None else f"a new reader: a sample after {took:.2f} s"))
                if took is None:
                    return False
                passed &= took <= GOOD_SECONDS
            return passed
        finally:
            self.writer.kill()
            self.writer.wait()
            left = shared_memory() - self.before
            for name in left:
                os.unlink(os.path.join("/dev/shm", name))
            self.say(f"{len(left)} left in /dev/shm, removed")


def main(bin_dir, readers):
    domain, claim = claim_domain()
    with claim:
        if not Trial(bin_dir, "udp", domain).run(readers):
            sys.exit("the trial itself is broken: it failed over UDP")
        passed = Trial(bin_dir, "memory", domain).run(readers)
    print("shared memory passed" if passed else "shared memory did not pass")
    return 0 if passed else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1], int(sys.argv[2]) if len(sys.argv) > 2 else READERS))
