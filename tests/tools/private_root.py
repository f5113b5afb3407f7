"""Creates a private root for a test: the files of this machine with all writes in memory. It has
its own processes, mounts, network (loopback only), host name, and systemd as first process.

    with PrivateRoot() as root:
        root.run("dpkg", "-i", "/tmp/x.deb")

Needs root, overlayfs, cgroup2 and the package systemd; Unavailable names what is missing. At the
end everything is removed.
"""

import ctypes
import os
import shutil
import signal
import subprocess
import tempfile
import time

START_SECONDS = 30
RUN_SECONDS = 120
SYSTEMD = "/lib/systemd/systemd"


class Unavailable(Exception):
    """The reason why this machine cannot create a private root."""


def _die_with_parent():
    ctypes.CDLL(None).prctl(1, signal.SIGKILL)  # PR_SET_PDEATHSIG


def _cgroup2():
    with open("/proc/self/mounts", encoding="utf-8") as file:
        for line in file:
            _, folder, kind, *_ = line.split()
            if kind == "cgroup2":
                return folder
    raise Unavailable("no cgroup2 is mounted")


class PrivateRoot:
    def __init__(self):
        if os.geteuid() != 0:
            raise Unavailable("only root can make one")
        if not os.path.exists(SYSTEMD):
            raise Unavailable("the package systemd is not installed")
        with open("/proc/filesystems", encoding="utf-8") as file:
            if "overlay" not in file.read().split():
                raise Unavailable("the kernel has no overlayfs")
        self.pid = self._unshare = None
        self._parent_cgroup = _cgroup2()

    def __enter__(self):
        self._folder = tempfile.mkdtemp(prefix="fieldcast-root-")
        self._cgroup = os.path.join(self._parent_cgroup, os.path.basename(self._folder))
        self._log = open(os.path.join(self._folder, "log"), "w+", encoding="utf-8")
        try:
            os.mkdir(self._cgroup)
            os.mkdir(os.path.join(self._folder, "base"))
            self._start()
        except BaseException:
            self.close()
            raise
        return self

    def __exit__(self, *_):
        self.close()

    def _start(self):
        script = os.path.join(os.path.dirname(os.path.abspath(__file__)), "private_root.sh")
        inside = [script, os.path.join(self._folder, "base"), SYSTEMD, "--unit=private-root.target", "--log-target=journal", "--show-status=no"]
        join = 'echo $$ >"$0/cgroup.procs" && exec unshare --mount --pid --fork --net --uts --ipc --cgroup --kill-child -- "$@"'
        self._unshare = subprocess.Popen(["sh", "-c", join, self._cgroup, *inside], stdin=subprocess.DEVNULL, stdout=self._log,
                                         stderr=subprocess.STDOUT, preexec_fn=_die_with_parent)
        end = time.monotonic() + START_SECONDS
        while self._state() not in ("running", "degraded"):
            if self._unshare.poll() is not None:
                raise Unavailable("it did not start: " + self._said())
            if time.monotonic() > end:
                raise Unavailable(f"systemd did not start within {START_SECONDS} s: {self._state()} {self._said()}")
            time.sleep(0.05)

    def _said(self):
        self._log.seek(0)
        return self._log.read().strip()

    def _state(self):
        if self.pid is None:
            with open(f"/proc/{self._unshare.pid}/task/{self._unshare.pid}/children", encoding="utf-8") as file:
                children = file.read().split()
            if not children:
                return ""
            with open(f"/proc/{children[0]}/comm", encoding="utf-8") as file:
                if file.read().strip() != "systemd":
                    return ""
            self.pid = int(children[0])
        return self.run("systemctl", "is-system-running", check=False).stdout.strip()

    def path(self, inside):
        """Returns the path of a file of the root as seen from outside."""
        return f"/proc/{self.pid}/root{inside}"

    def write(self, inside, text):
        with open(self.path(inside), "w", encoding="utf-8") as file:
            file.write(text)

    def _entered(self, command):
        # its own root: the root of its mounts is that of this machine if this is a chroot
        return ["nsenter", "--all", "--target", str(self.pid), "--root", f"--wd=/proc/{self.pid}/root", "env", "-i", "PATH=/usr/sbin:/usr/bin:/sbin:/bin", "HOME=/root",
                "LC_ALL=C.UTF-8", "DEBIAN_FRONTEND=noninteractive", *command]

    def run(self, *command, check=True, seconds=RUN_SECONDS):
        done = subprocess.run(self._entered(command), capture_output=True, text=True, timeout=seconds, stdin=subprocess.DEVNULL)
        if check and done.returncode:
            raise AssertionError(f"{' '.join(command)}: exit code {done.returncode}\n{done.stdout}{done.stderr}")
        return done

    def start(self, *command, **options):
        """Starts a program in the background; it ends at the latest with the root."""
        return subprocess.Popen(self._entered(command), text=True, stdin=subprocess.DEVNULL, preexec_fn=_die_with_parent, **options)

    def close(self):
        if self._unshare:
            self._unshare.kill()
            self._unshare.wait()
        self._log.close()
        end = time.monotonic() + 10
        while os.path.isdir(self._cgroup):
            # From the innermost; processes that were just killed may still be counted.
            for folder, _, _ in os.walk(self._cgroup, topdown=False):
                try:
                    os.rmdir(folder)
                except OSError:
                    if time.monotonic() > end:
                        raise
            time.sleep(0.02)
        shutil.rmtree(self._folder)
