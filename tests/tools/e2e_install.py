"""Tests the Debian packages on a machine with systemd: installation, service, upgrade while it
runs, and removal. All of it happens in a private root (private_root.py), so this machine is not
changed.

usage: e2e_install.py PACKAGES_DIR SOURCE_DIR UNPACKED_DIR

UNPACKED_DIR has the package udev (tools/install.sh ci) if it is not installed. Exit code 77: this
machine cannot create a private root; the first line has the reason.
"""

import glob
import json
import os
import pwd
import re
import subprocess
import sys
import time
import unittest

from held_thread import HeldThread
from plant import wait_until
from private_root import PrivateRoot, Unavailable

PACKAGES = ["fieldcast", "fieldcast-sim", "fieldcast-dev", "fieldcast-forward", "libfieldcast-station1"]
PACKAGES_DIR = SOURCE_DIR = UNPACKED_DIR = ""
HERE = os.path.dirname(os.path.abspath(__file__))
SECONDS = 60  # limit of each wait
FIRST_VALUE_SECONDS = 60  # promised time from installation to the first value
UNIT = "fieldcast-bridge@demo"
BUS = "press-shop"
EXPOSURE = 3.0  # upper limit of systemd-analyze security
SIMULATOR = "/run/fieldcast-sim"  # the service has its own /tmp

root = before = None
first_value_seconds = None


def read(path):
    with open(path, encoding="utf-8") as file:
        return file.read()


def package(name):
    return glob.glob(f"{PACKAGES_DIR}/{name}_*.deb")[0]


def copied(path):
    inside = "/tmp/" + os.path.basename(path)
    with open(path, "rb") as source, open(root.path(inside), "wb") as target:
        target.write(source.read())
    return inside


def newer(name, version):
    folder = f"/tmp/{name}-{version}"
    root.run("dpkg-deb", "-R", "/tmp/" + os.path.basename(package(name)), folder)
    root.run("sed", "-i", f"s/^Version:.*/Version: {version}/", f"{folder}/DEBIAN/control")
    root.run("dpkg-deb", "-Zgzip", "-z1", "-b", folder, f"{folder}.deb")
    return f"{folder}.deb"


def properties(*names):
    said = root.run("systemctl", "show", UNIT, *(f"--property={name}" for name in names)).stdout
    return dict(line.split("=", 1) for line in said.splitlines())


def main_pid():
    return properties("MainPID")["MainPID"]


def outside_pid(inside_pid):
    """Returns the process id on this machine for a process id of the root."""
    for folder in glob.glob("/proc/[0-9]*/status"):
        try:
            text = read(folder)
        except (FileNotFoundError, ProcessLookupError):
            continue
        numbers = re.search(r"^NSpid:\s+(.*)$", text, re.MULTILINE).group(1).split()
        if len(numbers) == 2 and numbers[1] == inside_pid and "\nName:\tfieldcast-brid" in "\n" + text:
            return int(numbers[0])
    return None


def journal(since=None):
    """Returns the service's entries as dictionaries of journald's fields."""
    arguments = [f"--after-cursor={since}"] if since else []
    said = root.run("journalctl", "-u", UNIT, "-o", "json", "--no-pager", *arguments).stdout
    return [json.loads(line) for line in said.splitlines()]


def now_in_journal():
    return journal()[-1]["__CURSOR"]


def messages(since=None):
    return [entry["MESSAGE"] for entry in journal(since)]


def await_message(words, since=None):
    return wait_until(lambda: [line for line in messages(since) if words in line], SECONDS,
                      lambda: f"no '{words}' in\n" + "\n".join(messages(since)))[0]


def samples(*arguments):
    said = root.run("fieldcast", "watch", "--json", *arguments, check=False).stdout  # domain 0 on the loopback, as in demo.yaml
    return [sample for line in said.splitlines() if "quality" in (sample := json.loads(line))]


def good_sample():
    return [sample for sample in samples(BUS, "--once") if sample["quality"] == "GOOD"]


def stored():
    said = root.run("runuser", "-u", "fieldcast", "--", "fieldcast", "history", f"{BUS}/conveyor/speed", "--json", "--store",
                    "/var/lib/fieldcast/demo.db", check=False).stdout
    return len(said.splitlines())


def state():
    said = root.run("fieldcast", "status", check=False).stdout
    return "no value\n" + "\n".join(messages()[-40:]) + "\n" + said + root.run("ps", "-ef").stdout


def this_machine():
    """Returns what must not change; parallel tests create namespaces (/run/netns)."""
    mounts = [line for line in read("/proc/self/mounts").splitlines() if " /run/netns" not in line]
    return mounts, sorted(user.pw_name for user in pwd.getpwall()), sorted(os.listdir("/etc"))


def setUpModule():
    global root, first_value_seconds, before
    before = this_machine()
    root = PrivateRoot()
    root.__enter__()
    unittest.addModuleCleanup(close_root)
    packages = [copied(package(name)) for name in PACKAGES]

    began = time.monotonic()
    root.run("dpkg", "-i", *packages)
    root.run("sh", "-c", "test $(stat -c %U /var/lib/fieldcast) = fieldcast")
    root.run("sh", "-c", f"sed s,/tmp/fieldcast-demo,{SIMULATOR}, /usr/share/fieldcast/examples/demo.yaml >/etc/fieldcast/demo.yaml")
    with open(root.path("/etc/fieldcast/demo.yaml"), "a", encoding="utf-8") as file:
        file.write("\nstore: { path: /var/lib/fieldcast/demo.db }\nmetrics: { listen: 127.0.0.1:9464 }\n")
    root.run("install", "-d", "-o", "fieldcast", SIMULATOR)
    root.run("systemd-run", "--unit=simulator", "--uid=fieldcast", "fieldcast-sim", "/etc/fieldcast/demo.yaml")
    root.run("systemctl", "enable", "--now", UNIT)
    wait_until(good_sample, SECONDS, state)
    first_value_seconds = time.monotonic() - began
    root.run("rm", "-f", "/var/lib/man-db/auto-update")  # the man page index is built only once
    print(f"from the packages to the first value: {first_value_seconds:.1f} s", file=sys.stderr)


def close_root():
    """Checks that nothing remains; the root's cgroup can only be removed without processes."""
    root.close()
    if before != (after := this_machine()):
        raise AssertionError(f"left behind: {before} {after}")


class Documents(unittest.TestCase):
    """Runs the commands of the documents in the installed system."""

    def test_commands_for_the_installed_system_run(self):
        documents = [path for pattern in ("*.md", "docs/*.md", "tools/*/README.md") for path in glob.glob(pattern, root_dir=SOURCE_DIR)
                     if "<!-- in the installed system" in read(os.path.join(SOURCE_DIR, path))]
        with open(root.path("/tmp/source.tar"), "wb") as file:
            subprocess.run(["tar", "-c", "-C", SOURCE_DIR, "tests/docs", "tests/tools", *documents], stdout=file, check=True)
        root.run("mkdir", "/tmp/source", "/tmp/packages")
        root.run("tar", "-x", "-f", "/tmp/source.tar", "-C", "/tmp/source")
        # apt must not use an archive
        root.run("sh", "-c", "cp /tmp/*.deb /tmp/packages && rm -rf /var/lib/apt/lists/*")
        said = root.run("python3", "/tmp/source/tests/docs/run.py", "--installed", "/", "--systemd", "--packages", "/tmp/packages", "/tmp/source",
                        *documents).stdout
        print(said, file=sys.stderr)
        ran = int(re.search(r"in the installed system: (\d+) commands ran", said).group(1))
        self.assertGreater(ran, 5)
        # from docs/operating.md
        root.run("systemctl", "disable", "--now", "fieldcast-bridge@press-shop", check=False)


class Installed(unittest.TestCase):
    def test_the_first_value_comes_within_a_minute(self):
        self.assertLess(first_value_seconds, FIRST_VALUE_SECONDS)

    def test_the_bridge_runs_as_its_user_and_may_open_serial_lines(self):
        shown = properties("User", "ActiveState", "StatusText", "Type")
        self.assertEqual((shown["User"], shown["ActiveState"], shown["Type"]), ("fieldcast", "active", "notify"))
        self.assertTrue(shown["StatusText"])
        status = read(root.path(f"/proc/{main_pid()}/status"))
        user, group = (root.run("id", flag, "fieldcast").stdout.strip() for flag in ("-u", "-g"))
        self.assertIn(f"\nUid:\t{user}\t{user}\t{user}\t{user}\n", status)
        self.assertIn("dialout", root.run("id", "-Gn", "fieldcast").stdout.split())
        self.assertIn(f"\nGid:\t{group}\t", status)
        self.assertIn("\nCapEff:\t0000000000000000\n", status)

    def test_the_store_and_the_metrics_work_in_the_sandbox_of_the_service(self):
        wait_until(stored, SECONDS, state)
        self.assertEqual(root.run("stat", "-c", "%U %a", "/var/lib/fieldcast/demo.db").stdout, "fieldcast 600\n")
        said = root.run("python3", "-c", "import urllib.request as r; print(r.urlopen('http://127.0.0.1:9464/metrics').read().decode())").stdout
        self.assertIn(f'fieldcast_bus_state{{bus="{BUS}",state="running"}} 1', said)

    def test_systemd_finds_little_exposed(self):
        said = root.run("systemd-analyze", "security", "--no-pager", UNIT, check=False).stdout
        exposure = float(re.search(r"Overall exposure level for \S+: ([\d.]+)", said).group(1))
        self.assertLess(exposure, EXPOSURE, said)

    def test_lines_of_the_journal_have_their_priority(self):
        running = next(entry for entry in journal() if ", DDS domain" in entry["MESSAGE"] and "running" in entry["MESSAGE"])
        self.assertEqual(running["PRIORITY"], "6")
        self.assertNotRegex(running["MESSAGE"], r"^<\d>|^\d{4}-")
        self.assertEqual(running["_SYSTEMD_UNIT"], UNIT + ".service")

    def test_a_reload_takes_the_file_and_leaves_a_bad_one(self):
        before_reload, pid = now_in_journal(), main_pid()
        text = read(root.path("/etc/fieldcast/demo.yaml"))
        self.addCleanup(root.write, "/etc/fieldcast/demo.yaml", text)
        root.write("/etc/fieldcast/demo.yaml", text + "\nnonsense: true\n")
        self.assertNotEqual(root.run("systemctl", "reload", UNIT, check=False).returncode, 0)
        await_message("not reloaded: the old configuration goes on running", before_reload)
        self.assertTrue([line for line in messages(before_reload) if "nonsense" in line])
        self.assertIn("the last reload was refused", root.run("systemctl", "status", "--no-pager", UNIT).stdout)
        root.write("/etc/fieldcast/demo.yaml", text.replace("- { name: jam,", "- { name: jam-of-today,"))
        root.run("systemctl", "reload", UNIT)
        wait_until(lambda: samples(f"{BUS}/conveyor/jam-of-today", "--once"), SECONDS, lambda: "\n".join(messages(before_reload)))
        self.assertEqual(main_pid(), pid)

    def test_a_missing_library_is_named(self):
        library = root.run("sh", "-c", "ls /usr/lib/$(uname -m)-linux-gnu/libyaml-0.so.2").stdout.strip()
        self.addCleanup(root.run, "mv", library + ".away", library)
        root.run("mv", library, library + ".away")
        done = root.run("fieldcast-bridge", "--check", "/etc/fieldcast/demo.yaml", check=False)
        self.assertEqual(done.returncode, 127)
        self.assertIn(f"error while loading shared libraries: {os.path.basename(library)}: cannot open shared object file", done.stderr)

    def test_it_starts_with_the_machine(self):
        self.assertEqual(root.run("systemctl", "is-enabled", UNIT).stdout.strip(), "enabled")


class MonitoringStation(unittest.TestCase):
    def test_its_service_shows_the_plant_in_its_sandbox(self):
        root.write("/etc/fieldcast/station.yaml", "station: hall\nstore: { path: /var/lib/fieldcast/station.db }\nrecord: {}\n")
        root.run("systemctl", "enable", "--now", "fieldcast-station")
        self.addCleanup(root.run, "systemctl", "disable", "--now", "fieldcast-station")
        script = ("import json, urllib.request as r; "
                  "print(sum(c['quality'] == 'GOOD' for c in json.load(r.urlopen('http://127.0.0.1:8090/api/channels'))))")
        wait_until(lambda: int(root.run("python3", "-c", script).stdout) > 0, SECONDS, state)
        self.assertEqual(root.run("stat", "-c", "%U %a", "/var/lib/fieldcast/station.db").stdout, "fieldcast 600\n")
        shown = root.run("systemctl", "show", "fieldcast-station", "--property=StatusText", "--property=User").stdout
        self.assertIn("StatusText=served at http://127.0.0.1:8090/", shown)
        self.assertIn("User=fieldcast", shown)
        root.run("systemctl", "reload", "fieldcast-station")
        said = root.run("systemd-analyze", "security", "--no-pager", "fieldcast-station", check=False).stdout
        self.assertLess(float(re.search(r"Overall exposure level for \S+: ([\d.]+)", said).group(1)), EXPOSURE, said)


class Deployment(unittest.TestCase):
    """The command of docs/station.md: the file of the bridge moves to where its service may write."""

    FILE = "/etc/fieldcast/demo.yaml"
    MOVED = "/var/lib/fieldcast/deploy/demo.yaml"

    def ask(self, method, path, body=None):
        script = ("import json, sys, urllib.request as r, urllib.error\n"
                  "base = 'http://127.0.0.1:8090'\n"
                  "q = r.Request(base + sys.argv[2], sys.argv[3].encode() or None, {'Content-Type': 'application/json', 'Origin': base}, method=sys.argv[1])\n"
                  "try: print(200, r.urlopen(q, timeout=20).read().decode())\n"
                  "except urllib.error.HTTPError as error: print(error.code, error.read().decode())\n")
        done = root.run("python3", "-c", script, method, path, json.dumps(body) if body else "", check=False)
        status, _, text = done.stdout.partition(" ")
        return (int(status), json.loads(text)) if done.returncode == 0 else (0, done.stderr)

    def deploy(self, text):
        status, present = self.ask("GET", "/api/configuration?bridge=demo")
        self.assertEqual(status, 200, present)
        return self.ask("POST", "/api/configuration/deploy", {"bridge": "demo", "base": present["version"], "text": text, "why": "a test"})

    def test_an_engineer_deploys_only_to_a_file_that_was_moved(self):
        text = read(root.path(self.FILE))
        allowed = text + "configure: { allow: true }\n"
        root.write(self.FILE, allowed)
        root.write("/etc/fieldcast/station.yaml", "station: hall\nweb: { local-role: engineer }\n")
        root.run("systemctl", "restart", UNIT, "fieldcast-station")
        # the last one runs first; a link must not be followed out of the root
        self.addCleanup(root.run, "systemctl", "restart", UNIT)
        self.addCleanup(root.write, self.FILE, text)
        self.addCleanup(root.run, "rm", "-rf", self.FILE, os.path.dirname(self.MOVED), "/etc/fieldcast/station.yaml")
        self.addCleanup(root.run, "systemctl", "stop", "fieldcast-station")
        wait_until(lambda: self.ask("GET", "/api/configuration?bridge=demo")[0] == 200, SECONDS, state)
        wanted = allowed.replace("- { name: jam,", "- { name: jam-of-the-day,")
        status, refusal = self.deploy(wanted)
        self.assertEqual((status, read(root.path(self.FILE))), (500, allowed), refusal)
        self.assertIn("docs/station.md", refusal["hint"])

        root.run("install", "-d", "-o", "fieldcast", "-g", "fieldcast", "-m", "0750", os.path.dirname(self.MOVED))
        root.run("install", "-o", "fieldcast", "-g", "fieldcast", "-m", "0640", self.FILE, self.MOVED)
        root.run("ln", "-sf", self.MOVED, self.FILE)
        root.run("systemctl", "restart", UNIT)
        wait_until(lambda: self.ask("GET", "/api/configuration?bridge=demo")[0] == 200, SECONDS, state)
        status, deployed = self.deploy(wanted)
        self.assertEqual(status, 200, deployed)
        self.assertEqual(read(root.path(self.MOVED)), wanted)
        self.assertEqual(root.run("stat", "-c", "%U %a", self.MOVED).stdout, "fieldcast 640\n")
        self.assertEqual(root.run("readlink", self.FILE).stdout.strip(), self.MOVED)
        wait_until(lambda: samples(f"{BUS}/conveyor/jam-of-the-day", "--once"), SECONDS, state)


class Adapter(unittest.TestCase):
    """Tests the udev rules with udevadm on a simulated /sys with an adapter."""

    @classmethod
    def setUpClass(cls):
        if not os.path.exists(root.path("/usr/bin/udevadm")):
            if not os.path.isdir(f"{UNPACKED_DIR}/udev"):
                raise unittest.SkipTest("no udev here; tools/install.sh ci brings it")
            with open(root.path("/tmp/udev.tar"), "wb") as file:
                subprocess.run(["tar", "-c", "-C", f"{UNPACKED_DIR}/udev", "."], stdout=file, check=True)
            root.run("tar", "-x", "-f", "/tmp/udev.tar", "-C", "/", "--keep-directory-symlink")
        cls.tree = copied(os.path.join(HERE, "usb_serial_tree.sh"))

    def plugged(self, driver, serial):
        """Returns (content of /dev/fieldcast, latency timer, output of udev)."""
        said = root.run("unshare", "--mount", "sh", "-euc", f'''
            sh {self.tree} {driver} "{serial}"
            rm -rf /dev/fieldcast /dev/ttyUSB0
            mknod -m 600 /dev/ttyUSB0 c 188 0
            export SYSTEMD_DEVICE_VERIFY_SYSFS=0
            udevadm test --action=bind /sys/bus/usb-serial/devices/ttyUSB0 2>&1
            udevadm test --action=add /sys/class/tty/ttyUSB0 2>&1
            echo "links: $(cd /dev/fieldcast && for link in *; do echo "$link=$(readlink "$link")"; done)"
            echo "timer: $(cat /sys/bus/usb-serial/devices/ttyUSB0/latency_timer)"
            stat -c "owner: %G %a" /dev/ttyUSB0''').stdout
        found = dict(re.findall(r"^(links|timer|owner): (.*)$", said, re.MULTILINE))
        self.assertNotIn("70-fieldcast.rules:0", said)
        self.assertEqual(re.findall(r"70-fieldcast\.rules:\d+ (?:Unknown|Invalid|Failed).*", said), [])
        return found

    def test_of_ftdi_is_quick_and_named_after_its_serial_number(self):
        self.assertEqual(self.plugged("ftdi_sio", "A50285BI"),
                         {"links": "A50285BI-00=../ttyUSB0", "timer": "1", "owner": "dialout 660"})

    def test_without_a_serial_number_is_named_after_its_socket(self):
        self.assertEqual(self.plugged("ch341-uart", ""),
                         {"links": "pci-0000:00:14.0-usb-0:2:1.0=../ttyUSB0", "timer": "9", "owner": "dialout 660"})


class Stuck(unittest.TestCase):
    """If the thread of a bus hangs, systemd restarts the bridge and the journal names the bus."""

    def test_is_a_restart_with_the_name_of_the_bus(self):
        # The packaged limit is 30 s; the mechanism is the same.
        root.run("mkdir", "-p", f"/run/systemd/system/{UNIT}.service.d")
        root.write(f"/run/systemd/system/{UNIT}.service.d/quick.conf", "[Service]\nWatchdogSec=3\nRestartSec=100ms\n")
        root.run("systemctl", "daemon-reload")
        root.run("systemctl", "restart", UNIT)
        before_stuck, pid = now_in_journal(), main_pid()
        with HeldThread(outside_pid(pid), BUS) as held:
            wait_until(lambda: held.look() or main_pid() not in (pid, "0"), SECONDS, lambda: "\n".join(messages(before_stuck)))
        entry = next(entry for entry in journal(before_stuck) if "the bus stands" in entry["MESSAGE"])
        self.assertTrue(entry["MESSAGE"].startswith(BUS + ": "), entry)
        self.assertEqual(entry["PRIORITY"], "3")
        self.assertTrue([line for line in messages(before_stuck) if "Watchdog timeout" in line], messages(before_stuck))
        wait_until(lambda: properties("ActiveState")["ActiveState"] == "active", SECONDS, lambda: "\n".join(messages()))
        wait_until(good_sample, SECONDS, state)


class UpgradedAndRemoved(unittest.TestCase):
    """Follows the order of a plant's life; must be the last class of this file."""

    def test_1_an_upgrade_restarts_the_bridge_and_values_go_on(self):
        cursor, pid = now_in_journal(), main_pid()
        watched = root.path("/tmp/watched")
        with open(watched, "w", encoding="utf-8") as file:
            watch = root.start("fieldcast", "watch", "--json", f"{BUS}/conveyor/speed", "--config", "/etc/fieldcast/demo.yaml", stdout=file)
        self.addCleanup(watch.wait)
        self.addCleanup(root.run, "pkill", "-x", "fieldcast")  # inside the root

        def times():
            with open(watched, encoding="utf-8") as file:
                lines = [json.loads(line) for line in file if line.endswith("\n")]
            return [sample["acquired_at"] for sample in lines if sample.get("quality") == "GOOD"]
        before_upgrade = wait_until(times, SECONDS, "no value before the upgrade")[-1]
        stored_before = wait_until(stored, SECONDS, state)
        said = root.run("dpkg", "-i", newer("fieldcast", "0.1.0+upgrade1"))
        self.assertIn(f"{UNIT}.service is restarted with the new version", said.stdout)
        self.assertNotEqual(main_pid(), pid)
        await_message("running: ", cursor)
        self.assertIn("stopped", "\n".join(messages(cursor)))
        self.assertEqual([line for line in messages(cursor) if "code=dumped" in line or "code=killed" in line or "Failed" in line], [])
        restarted = time.time_ns()
        found = wait_until(lambda: (now := times())[-1] > restarted and now, SECONDS, lambda: state())
        gap = max(b - a for a, b in zip(found, found[1:])) / 1e9
        print(f"an upgrade over a running bridge: {gap:.1f} s without a value", file=sys.stderr)
        self.assertGreater(found[-1], before_upgrade)
        wait_until(lambda: stored() > stored_before, SECONDS, state)

    def test_2_a_downgrade_restarts_the_bridge_and_keeps_configuration_and_store(self):
        root.run("sh", "-c", f"mkdir -p /etc/systemd/system/{UNIT}.service.d && "
                             f"printf '[Service]\nTimeoutStopSec=14\n' >/etc/systemd/system/{UNIT}.service.d/stop.conf")

        def files():
            return root.run("sh", "-c", f"cat /etc/fieldcast/demo.yaml /etc/systemd/system/{UNIT}.service.d/stop.conf; "
                                        "stat -c '%U %G %a %n' /etc/fieldcast/* /var/lib/fieldcast/demo.db").stdout
        files_before, stored_before, pid = files(), stored(), main_pid()
        self.assertGreater(stored_before, 0)
        said = root.run("dpkg", "-i", "/tmp/" + os.path.basename(package("fieldcast")))
        self.assertIn("downgrading fieldcast (0.1.0+upgrade1)", (said.stdout + said.stderr).replace("from 0.1.0+upgrade1", "(0.1.0+upgrade1)"))
        self.assertIn(f"{UNIT}.service is restarted with the new version", said.stdout)
        self.assertNotEqual(main_pid(), pid)
        self.assertEqual(files(), files_before)
        self.assertEqual(properties("TimeoutStopUSec")["TimeoutStopUSec"], "14s")
        wait_until(lambda: stored() > stored_before, SECONDS, state)

    def test_3_a_configuration_that_the_new_version_refuses_keeps_the_old_one_running(self):
        text = read(root.path("/etc/fieldcast/demo.yaml"))
        self.addCleanup(root.write, "/etc/fieldcast/demo.yaml", text)
        root.write("/etc/fieldcast/demo.yaml", text + "\nkey-of-before: true\n")
        pid = main_pid()
        said = root.run("dpkg", "-i", newer("fieldcast", "0.1.0+upgrade2"))
        self.assertIn(f"{UNIT}.service is not restarted and goes on with the old version", said.stderr)
        self.assertIn("unknown key 'key-of-before'", said.stderr)
        self.assertEqual(main_pid(), pid)
        self.assertTrue(wait_until(good_sample, SECONDS, state))

    def test_4_a_stop_is_in_order_and_soon(self):
        began = time.monotonic()
        root.run("systemctl", "stop", UNIT)
        self.assertLess(time.monotonic() - began, 15)
        self.assertEqual(properties("Result", "ActiveState"), {"Result": "success", "ActiveState": "inactive"})

    def test_5_a_removal_ends_it_and_keeps_what_is_the_users(self):
        root.run("systemctl", "start", UNIT)
        files = root.run("dpkg", "-L", *PACKAGES).stdout.split("\n")
        ours = [file for file in files if "fieldcast" in file]
        self.assertGreater(len(ours), 50)
        root.run("dpkg", "-r", *PACKAGES)
        self.assertEqual(properties("ActiveState")["ActiveState"], "inactive")
        self.assertEqual([file for file in ours if os.path.isfile(root.path(file))], [])
        self.assertTrue(os.path.exists(root.path("/etc/fieldcast/demo.yaml")))
        root.run("dpkg", "-P", *PACKAGES)
        self.assertTrue(os.path.exists(root.path("/etc/fieldcast/demo.yaml")))
        self.assertTrue(os.path.exists(root.path("/var/lib/fieldcast/demo.db")))
        self.assertEqual(glob.glob(root.path("/etc/systemd/system/*/fieldcast*")), [])
        self.assertEqual([file for file in ours if os.path.exists(root.path(file)) and file != "/etc/fieldcast"], [])
        self.assertEqual(root.run("dpkg", "-l", "fieldcast", check=False).returncode, 1)

    def test_6_a_purge_without_files_of_the_user_leaves_no_folder(self):
        root.run("dpkg", "-i", *("/tmp/" + os.path.basename(package(name)) for name in PACKAGES))
        root.run("sh", "-c", "rm -rf /etc/fieldcast/* /var/lib/fieldcast")
        root.run("dpkg", "-P", *PACKAGES)
        self.assertEqual([folder for folder in ("/etc/fieldcast", "/var/lib/fieldcast", "/usr/share/fieldcast")
                          if os.path.exists(root.path(folder))], [])


if __name__ == "__main__":
    PACKAGES_DIR, SOURCE_DIR, UNPACKED_DIR = map(os.path.abspath, sys.argv[1:4])
    try:
        PrivateRoot()
    except Unavailable as reason:
        print(f"no root of its own on this machine: {reason}")
        sys.exit(77)
    unittest.main(argv=sys.argv[:1] + sys.argv[4:], verbosity=2)
