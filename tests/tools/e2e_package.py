"""Tests that an installed tree is relocatable: the components in a private root, and the Debian
packages of the same build. Builds nothing.

usage: e2e_package.py BUILD_DIR SOURCE_DIR PACKAGES_DIR
"""

import fnmatch
import glob
import gzip
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "docs"))
from links import dead_links, links

BUILD_DIR = SOURCE_DIR = PACKAGES_DIR = ""
LIBRARY = "libfieldcast-station1"
COMPONENTS = ["fieldcast", "fieldcast-dev", "fieldcast-forward", "fieldcast-sim", LIBRARY]
PROGRAMS = ["fieldcast", "fieldcast-bridge", "fieldcast-forward", "fieldcast-port", "fieldcast-sim", "fieldcast-station"]
# All but fieldcast-forward; fieldcast-station with its page is 2.1 MB of it. GCC 14 of Debian 13 makes larger programs than GCC 12.
MAX_PACKAGES_BYTES = 8_000_000 if glob.glob("/usr/lib/*/libfastdds.so.3.*") else 7_500_000
MAX_FORWARD_BYTES = 1_700_000  # eight engines, with DDS and the configuration of its own

def run(*command, **options):
    result = subprocess.run(command, capture_output=True, text=True, timeout=280, **options)
    if result.returncode:
        raise AssertionError(f"{' '.join(command)}: exit code {result.returncode}\n{result.stdout}{result.stderr}")
    return result.stdout


def environment(root):
    """Returns an environment without paths to the tree or to another installation."""
    return {"PATH": f"{root}/bin:/usr/bin:/bin", "HOME": root, "LC_ALL": "C.UTF-8"}


def documents(root):
    """Returns (directory of the documents below an installed root, paths of its texts)."""
    folder = f"{root}/share/doc/fieldcast"
    return folder, sorted(os.path.relpath(path, folder) for path in glob.glob(f"{folder}/**/*.md", recursive=True))


class Installed(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp(prefix="fieldcast-install-")
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        cls.root = os.path.join(cls.folder, "root")
        for component in COMPONENTS:
            run("cmake", "--install", BUILD_DIR, "--component", component, "--prefix", cls.root, "--strip")

    def test_each_program_prints_its_usage_and_has_its_page(self):
        for program in PROGRAMS:
            self.assertIn("--help", run(f"{self.root}/bin/{program}", "--help", env=environment(self.root)))
            self.assertRegex(run(f"{self.root}/bin/{program}", "--version", env=environment(self.root)), rf"^{program} \d+\.\d+\.\d+\n$")
            with gzip.open(f"{self.root}/share/man/man1/{program}.1.gz", "rt", encoding="utf-8") as file:
                page = file.read()
            options = set(re.findall(r"^  .*?(--[a-z][\w-]*)", run(f"{self.root}/bin/{program}", "--help"), re.MULTILINE))
            self.assertEqual([option for option in options if option.replace("-", "\\-") not in page], [])
            for section in ["NAME", "SYNOPSIS", "DESCRIPTION", "OPTIONS", '"EXIT STATUS"', "FILES", '"SEE ALSO"']:
                self.assertIn(f"\n.SH {section}\n", page)

    @unittest.skipUnless(shutil.which("man"), "no man here")
    def test_man_formats_each_page_without_a_warning(self):
        for program in PROGRAMS:
            page = f"{self.root}/share/man/man1/{program}.1.gz"
            done = subprocess.run(["man", "--warnings", "-l", "-Tutf8", page], capture_output=True, text=True, check=True,
                                  env={**environment(self.root), "MANROFFSEQ": "", "MANWIDTH": "80"})
            self.assertEqual(done.stderr, "", program)
            self.assertIn(f'"{program} - ', run("lexgrog", page, env=environment(self.root)))

    def test_the_examples_are_accepted_with_the_installed_device_templates(self):
        examples = f"{self.root}/share/fieldcast/examples"
        for example in ["minimal.yaml", "complete.yaml"]:
            self.assertIn(" channel", run(f"{self.root}/bin/fieldcast-bridge", "--check", f"{examples}/{example}",
                                          env=environment(self.root), cwd="/"))
        shutil.move(f"{self.root}/share/fieldcast/devices", f"{self.folder}/devices")
        self.addCleanup(shutil.move, f"{self.folder}/devices", f"{self.root}/share/fieldcast/devices")
        result = subprocess.run([f"{self.root}/bin/fieldcast-bridge", "--check", f"{examples}/complete.yaml"],
                                capture_output=True, text=True, env=environment(self.root), timeout=60)
        self.assertEqual(result.returncode, 3, "found templates that are not installed: " + result.stdout)

    def test_a_dead_link_of_a_document_is_found(self):
        folder = os.path.join(self.folder, "texts")
        os.mkdir(folder)
        for name, text in [("a.md", "[b](b.md) [c](b.md#c) [d](d.md) [e](b.md#e) [f](../root/lib)"), ("b.md", "# c\n")]:
            with open(os.path.join(folder, name), "w", encoding="utf-8") as file:
                file.write(text)
        self.assertEqual([dead.split(": ")[1] for dead in dead_links(folder, "a.md")], ["d.md", "b.md#e", "../root/lib"])

    def test_pkg_config_names_the_same_library(self):
        flags = run("pkg-config", "--cflags", "--libs", "fieldcast-station",
                    env={**environment(self.root), "PKG_CONFIG_PATH": glob.glob(f"{self.root}/lib/**/pkgconfig", recursive=True)[0]})
        self.assertIn(" -lfieldcast-station ", flags)
        include = next(flag[2:] for flag in flags.split() if flag.startswith("-I"))
        self.assertTrue(os.path.samefile(include, f"{self.root}/include"), flags)

    def test_completion_offers_subcommands_and_options(self):
        def complete(*words):
            script = f'''source {self.root}/share/bash-completion/completions/fieldcast
                         COMP_WORDS=({" ".join(words)}) COMP_CWORD={len(words) - 1}; _fieldcast {words[0]}; echo "${{COMPREPLY[@]}}"'''
            return run("bash", "-c", script, env=environment(self.root)).split()
        self.assertEqual(complete("fieldcast", "wat"), ["watch"])
        self.assertIn("--json", complete("fieldcast", "watch", "--js"))
        self.assertEqual(complete("fieldcast-bridge", "--ch"), ["--check"])
        self.assertEqual(complete("fieldcast", "scan", "--protocol", "omr"), ["omron-fins", "omron-hostlink"])
        self.assertEqual(complete("fieldcast", "inspect", "modbus-r"), ["modbus-rtu"])

    def test_the_units_are_such_that_systemd_understands(self):
        if not shutil.which("systemd-analyze"):
            self.skipTest("no systemd-analyze here")
        for name, installed in [("fieldcast-bridge@plant", "fieldcast-bridge@"), ("fieldcast-station", "fieldcast-station"), ("fieldcast-forward", "fieldcast-forward")]:
            unit = os.path.join(self.folder, f"{name}.service")
            with open(f"{self.root}/lib/systemd/system/{installed}.service", encoding="utf-8") as template:
                text = re.sub(r"(?m)^(Exec\w+=)(?=fieldcast)", rf"\1{self.root}/bin/", template.read())
            with open(unit, "w", encoding="utf-8") as file:
                file.write(text)
            result = subprocess.run(["systemd-analyze", "verify", "--man=no", unit], capture_output=True, text=True, timeout=60)
            complaints = [line for line in result.stderr.splitlines() if "fieldcast" in line]
            self.assertEqual(complaints, [], result.stderr)

    def test_the_service_may_open_serial_ports_also_those_that_are_plugged_in_after_its_start(self):
        with open(f"{self.root}/lib/systemd/system/fieldcast-bridge@.service", encoding="utf-8") as file:
            unit = re.findall(r"(?m)^(\w+)=(.*)$", file.read())
        permitted = [value.split()[0] for key, value in unit if key == "DeviceAllow"]
        for kind in ["ttyUSB", "ttyACM", "ttyS", "ttyAMA", "ttymxc", "ttySC"]:
            self.assertTrue(any(fnmatch.fnmatchcase(f"char-{kind}", each) for each in permitted), kind)
        # The kernel lists these kinds in /proc/devices when the module is loaded, and systemd reads it when the service starts.
        for module in ["usbserial", "cdc_acm"]:
            for dependency in ["After", "Wants"]:
                self.assertIn(f"modprobe@{module}.service", " ".join(value for key, value in unit if key == dependency))


class Packages(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp(prefix="fieldcast-packages-")
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        found = {os.path.basename(path).split("_")[0]: path for path in glob.glob(f"{PACKAGES_DIR}/*.deb")}
        assert sorted(found) == COMPONENTS, found
        cls.packages = [found[name] for name in sorted(found)]

    def test_they_are_small(self):
        forward = os.path.getsize(self.packages[COMPONENTS.index("fieldcast-forward")])
        self.assertLess(forward, MAX_FORWARD_BYTES)
        self.assertLess(sum(map(os.path.getsize, self.packages)) - forward, MAX_PACKAGES_BYTES)

    def test_the_programs_run_from_what_is_in_them(self):
        root = os.path.join(self.folder, "root")
        for package in self.packages:
            run("dpkg-deb", "-x", package, root)
        usr = f"{root}/usr"
        self.assertIn("channels", run(f"{usr}/bin/fieldcast-bridge", "--check", f"{usr}/share/fieldcast/examples/complete.yaml",
                                      env=environment(usr), cwd="/"))
        for file in ["lib/systemd/system/fieldcast-bridge@.service", "lib/systemd/system/fieldcast-station.service", "lib/systemd/system/fieldcast-forward.service", "lib/udev/rules.d/70-fieldcast.rules",
                     "share/fieldcast/profiles/fieldcast-station.xml", "share/fieldcast/idl/fieldcast.idl"]:
            self.assertTrue(os.path.exists(f"{usr}/{file}"), file)

    def test_every_link_of_the_documents_leads_to_a_file_of_the_same_package(self):
        root = os.path.join(self.folder, "documents")
        run("dpkg-deb", "-x", self.packages[0], root)
        folder, paths = documents(f"{root}/usr")
        self.assertGreater(sum(len(links(folder, path)) for path in paths), 200, paths)
        self.assertEqual([dead for path in paths for dead in dead_links(folder, path)], [])

    def test_no_library_is_missing_among_what_they_depend_on(self):
        depends = run("dpkg-deb", "-f", self.packages[0], "Depends")
        for library in ["libc6", "libfast(rtps|dds)", "libyaml-0-2", "adduser"]:
            self.assertRegex(depends, library)

    @unittest.skipUnless(shutil.which("lintian"), "no lintian here")
    def test_lintian_finds_no_error_and_no_warning(self):
        result = subprocess.run(["lintian", "--fail-on", "error,warning", "--allow-root", *self.packages],
                                capture_output=True, text=True, timeout=120)
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
        self.assertEqual(re.findall(r"^I: .* hardening-.*", result.stdout, re.MULTILINE), [])

    def test_the_library_exports_only_the_public_interface(self):
        root = os.path.join(self.folder, "library")
        run("dpkg-deb", "-R", self.packages[COMPONENTS.index(LIBRARY)], root)
        with open(f"{root}/DEBIAN/symbols", encoding="utf-8") as file:
            name, *listed = [line.split()[0] for line in file.read().splitlines() if not line.startswith("*")]
        library, = glob.glob(f"{root}/usr/lib/**/{name}", recursive=True)
        exported = re.findall(r"^\S+ [^A ] (\S+)$", run("nm", "-D", "--defined-only", "--with-symbol-versions", library), re.MULTILINE)
        self.assertEqual(sorted(symbol for symbol in listed if not symbol.startswith(("FIELDCAST_1@", "CODEABI_1.0@"))),
                         sorted(symbol.replace("@@", "@") for symbol in exported))
        self.assertGreater(len(exported), 30)
        foreign = [symbol for symbol in exported if "9fieldcast3api2v1" not in symbol]
        self.assertEqual([symbol for symbol in foreign if not symbol.endswith("@@CODEABI_1.0")], [])  # bridge/dds/library replaces these

        # A symbol that has disappeared stops the packaging.
        with open(f"{SOURCE_DIR}/tools/packaging/debian/symbols", encoding="utf-8") as file:
            text = file.read()
        with open(f"{self.folder}/symbols", "w", encoding="utf-8") as file:
            file.write(text + " gone@FIELDCAST_1 0.1.0\n")
        os.makedirs(f"{self.folder}/debian", exist_ok=True)
        with open(f"{self.folder}/debian/control", "w", encoding="utf-8") as file:  # which version 1.22 reads
            file.write(f"Source: fieldcast\n\nPackage: {LIBRARY}\nArchitecture: any\n")
        for symbols, code in [(f"{SOURCE_DIR}/tools/packaging/debian/symbols", 0), (f"{self.folder}/symbols", 1)]:
            done = subprocess.run(["dpkg-gensymbols", "-c2", f"-p{LIBRARY}", "-v0.1.0+1", f"-P{root}", f"-I{symbols}", "-O/dev/null"],
                                  capture_output=True, text=True, cwd=self.folder)
            self.assertEqual(done.returncode, code, done.stdout + done.stderr)


if __name__ == "__main__":
    BUILD_DIR, SOURCE_DIR, PACKAGES_DIR = map(os.path.abspath, sys.argv[1:4])
    unittest.main(argv=sys.argv[:1], verbosity=2)
