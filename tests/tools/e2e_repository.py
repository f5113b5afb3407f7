"""Tests that apt installs the packages from the repository that tools/repository.sh makes, with the
commands of docs/operating.md: from a folder, as on a USB stick, and from a web server on the
loopback. A private root (private_root.py) protects this machine; it has no network.

usage: e2e_repository.py PACKAGES_DIR SOURCE_DIR

Exit code 77: this machine cannot create a private root; the first line has the reason.
"""

import glob
import os
import shutil
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "docs"))
from document import parse
from plant import wait_until
from private_root import PrivateRoot, Unavailable

PACKAGES_DIR = SOURCE_DIR = ""
DOCUMENT = "docs/operating.md"
STICK = "/media/usb/fieldcast"  # the repository in the document
SECONDS = 30


def commands(place):
    """Returns the document's blocks for `place`, in order."""
    with open(os.path.join(SOURCE_DIR, DOCUMENT), encoding="utf-8") as file:
        return [block.text for block in parse(DOCUMENT, file.read()) if block.markers.get("in the installed system") == place]


class Repository(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.mkdtemp(prefix="fieldcast-repository-")
        cls.addClassCleanup(shutil.rmtree, folder)
        cls.suite = subprocess.run(["sed", "-n", "s/^VERSION_CODENAME=//p", "/etc/os-release"], capture_output=True, text=True).stdout.strip()
        environment = {**os.environ, "GNUPGHOME": os.path.join(folder, "keys")}
        os.mkdir(environment["GNUPGHOME"], mode=0o700)
        cls.addClassCleanup(subprocess.run, ["gpgconf", "--kill", "all"], env=environment)
        script = os.path.join(SOURCE_DIR, "tools/repository.sh")
        made = os.path.join(folder, "repository")
        packages = sorted(glob.glob(f"{PACKAGES_DIR}/*.deb"))
        # The second run uses the key of the first and keeps its packages.
        for part in packages[:2], packages[2:]:
            done = subprocess.run([script, made, *part], capture_output=True, text=True, env=environment)
            assert done.returncode == 0, done.stderr
        assert f"{len(packages)} packages" in done.stdout, done.stdout
        cls.root = PrivateRoot()
        cls.root.__enter__()
        cls.addClassCleanup(cls.root.close)
        with open(cls.root.path("/tmp/repository.tar"), "wb") as file:
            subprocess.run(["tar", "-c", "-C", made, "."], stdout=file, check=True)
        cls.root.run("mkdir", "-p", STICK)
        cls.root.run("tar", "-x", "-f", "/tmp/repository.tar", "-C", STICK)
        # The private root has no network, so that its other sources cannot be read.
        cls.root.run("sh", "-c", "rm -rf /etc/apt/sources.list /etc/apt/sources.list.d/* /var/lib/apt/lists/*")

    def shell(self, text, check=True):
        return self.root.run("bash", "-euo", "pipefail", "-c", text, check=check)

    def installed(self):
        return self.root.run("dpkg-query", "-W", "-f", "${db:Status-Status}", "fieldcast", check=False).stdout == "installed"

    def remove(self):
        self.root.run("dpkg", "-P", "fieldcast")
        self.assertFalse(self.installed())

    def test_apt_installs_from_a_stick(self):
        self.addCleanup(self.remove)
        for text in commands("from a repository"):
            self.shell(text.replace("bookworm", self.suite))
        self.assertTrue(self.installed())
        self.assertIn(f"file:{STICK} {self.suite}/main", self.root.run("apt-cache", "policy", "fieldcast").stdout)

    def test_apt_installs_from_a_web_server(self):
        self.addCleanup(self.remove)
        server = self.root.start("sh", "-c", f"cd {STICK} && exec python3 -m http.server --bind 127.0.0.1 8099",
                                 stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self.addCleanup(server.wait)
        self.addCleanup(server.kill)
        wait_until(lambda: self.shell(": </dev/tcp/127.0.0.1/8099", check=False).returncode == 0, SECONDS, "the server does not listen")
        for text in commands("from a repository"):
            self.shell(text.replace("bookworm", self.suite).replace(f"file:{STICK}", "http://127.0.0.1:8099"))
        self.assertTrue(self.installed())
        self.assertIn(f"http://127.0.0.1:8099 {self.suite}/main", self.root.run("apt-cache", "policy", "fieldcast").stdout)

    def test_apt_refuses_a_repository_that_was_changed(self):
        sources, *_ = commands("from a repository")
        changed = "/media/usb/changed"
        self.root.run("cp", "-r", STICK, changed)
        sources = sources.replace("bookworm", self.suite).replace(f"file:{STICK}", f"file:{changed}")
        release, packages = f"{changed}/dists/{self.suite}/InRelease", f"{changed}/dists/{self.suite}/main/binary-*/Packages"
        self.shell(sources)
        for change, words in [(f"sed -i 's/^Label: .*/Label: Other/' {release}", "BADSIG"),
                              (f"cp {STICK}/dists/{self.suite}/InRelease {release}; rm {packages}.gz; sed -i 's/^Version: .*/Version: 9/' {packages}", "Hash Sum mismatch")]:
            self.shell(change + "; rm -rf /var/lib/apt/lists/*")
            done = self.root.run("apt-get", "update", check=False)
            self.assertIn(words, done.stdout + done.stderr)
            self.assertNotEqual(self.shell("apt-get install -y fieldcast", check=False).returncode, 0)
        self.assertFalse(self.installed())


if __name__ == "__main__":
    PACKAGES_DIR, SOURCE_DIR = map(os.path.abspath, sys.argv[1:3])
    try:
        PrivateRoot()
    except Unavailable as reason:
        print(f"no root of its own on this machine: {reason}")
        sys.exit(77)
    unittest.main(argv=sys.argv[:1] + sys.argv[3:], verbosity=2)
