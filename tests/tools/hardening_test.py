"""Checks with readelf that programs and libraries are built with the hardening that Debian requires.

usage: hardening_test.py FILE..

Each rule is also tested with a program that violates all of them.
"""

import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

FILES = []
# First instruction of a function that may be the target of an indirect branch.
LANDING = {
    "Advanced Micro Devices X86-64": [bytes.fromhex("f30f1efa")],  # endbr64
    "AArch64": [bytes.fromhex("5f2403d5"), bytes.fromhex("3f2303d5")],  # bti c, paciasp
}


def readelf(path, *options):
    return subprocess.run(["readelf", "-W", *options, path], check=True, capture_output=True, text=True, env={**os.environ, "LC_ALL": "C"}).stdout


def functions(path):
    """Returns the addresses of main and of each exported function."""
    symbols = readelf(path, "--dyn-syms", "--syms")
    rows = re.findall(r"^ +\d+: ([0-9a-f]+) +\d+ FUNC +(\w+) +DEFAULT +\d+ (\S+)", symbols, re.MULTILINE)
    shared = "library" if ".so" in os.path.basename(path) else "program"
    return {int(address, 16) for address, binding, name in rows if name == "main" or shared == "library" and binding == "GLOBAL" and "@" in name}


def code_at(path, address):
    for offset, virtual, size in re.findall(r"^  LOAD +0x(\w+) 0x(\w+) 0x\w+ 0x(\w+)", readelf(path, "-l"), re.MULTILINE):
        if int(virtual, 16) <= address < int(virtual, 16) + int(size, 16):
            with open(path, "rb") as file:
                file.seek(int(offset, 16) + address - int(virtual, 16))
                return file.read(4)
    return b""


def faults(path):
    """Returns the names of the missing parts of the hardening."""
    header, segments, dynamic, symbols = (readelf(path, option) for option in ("-h", "-l", "-d", "--dyn-syms"))
    found = []
    if not re.search(r"Type: +DYN", header):
        found.append("position-independent code")
    if "GNU_RELRO" not in segments:
        found.append("read-only relocations")
    if not re.search(r"BIND_NOW|Flags:.* NOW", dynamic):
        found.append("immediate binding")
    if not re.search(r"GNU_STACK +\S+ +\S+ +\S+ +\S+ +\S+ +RW  ", segments):
        found.append("no execution on the stack")
    if "__stack_chk_fail" not in symbols:
        found.append("stack protector")
    if not re.search(r" UND __\w+_chk\b", symbols):
        found.append("fortified functions")
    if re.search(r"TEXTREL|RPATH|RUNPATH", dynamic):
        found.append("no relocations of code, no path of libraries")
    landing = LANDING.get(re.search(r"Machine: +(.*)", header).group(1).strip())
    begins = functions(path)
    if not begins or landing and any(code_at(path, address) not in landing for address in begins):
        found.append("protection of branches")
    return found


class Hardening(unittest.TestCase):
    def test_each_program_has_all_of_it(self):
        self.assertGreater(len(FILES), 5)
        self.assertEqual({os.path.basename(path): found for path in FILES if (found := faults(path))}, {})

    def test_a_program_without_it_is_found(self):
        compiler = shutil.which("cc")
        self.assertTrue(compiler)
        with tempfile.TemporaryDirectory(prefix="fieldcast-hardening-") as folder:
            program = os.path.join(folder, "bare")
            bare = ["-fno-pie", "-no-pie", "-fno-stack-protector", "-fcf-protection=none", "-Wl,-z,norelro,-z,lazy,-z,execstack,-rpath,/tmp"]
            if os.uname().machine != "x86_64":
                bare.remove("-fcf-protection=none")
            subprocess.run([compiler, "-x", "c", *bare, "-o", program, "-"], input="int main(void) { return 0; }", check=True, text=True)
            self.assertEqual(len(faults(program)), 8 if os.uname().machine in ("x86_64", "aarch64") else 7, faults(program))


if __name__ == "__main__":
    FILES = sys.argv[1:]
    unittest.main(argv=sys.argv[:1], verbosity=2)
