"""Runs the examples of docs/container.md in containers of an image of the packages, with runc. The
containers share a network namespace that has only a loopback. The examples are the files of the
page: try/compose.yaml, plant/compose.yaml with plant/station.yaml and plant/.env. The manifest
press-shop.yaml is only compared with them.

usage: e2e_container.py PACKAGES_DIR SOURCE_DIR BIN_DIR

The image uses the libraries of the last `tools/image.sh`, or downloads them if there are none:
before the tests, because these have a network of their own. Exit code 77: this machine cannot run
containers or cannot download the libraries; the first line has the reason.
"""

import contextlib
import glob
import json
import os
import pwd
import re
import shutil
import signal
import subprocess
import sys
import tarfile
import tempfile
import time
import unittest
import urllib.request

import yaml

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "docs"))

import networks
from document import parse
from held_thread import HeldThread
from plant import wait_until

PACKAGES_DIR = SOURCE_DIR = BIN_DIR = ""
SECONDS = 30  # limit of each wait
STOP_SECONDS = 5  # promised time from SIGTERM to the end
MOST_BYTES = 120_000_000  # of the image without compression
USER_ID, DIALOUT_ID = 10001, 20

folder = image_path = bundle = None
first_run = ""  # output of tools/image.sh


def run(*command, **options):
    done = subprocess.run(command, capture_output=True, text=True, timeout=options.pop("timeout", 300), stdin=subprocess.DEVNULL, **options)
    if done.returncode:
        raise AssertionError(f"{' '.join(command)}: exit code {done.returncode}\n{done.stdout}{done.stderr}")
    return done.stdout


def read(path):
    with open(path, encoding="utf-8") as file:
        return file.read()


def make_image(output, *options):
    return run(f"{SOURCE_DIR}/tools/image.sh", "--packages", PACKAGES_DIR, *options, output)


def setUpModule():
    global folder, image_path, bundle, first_run
    folder = tempfile.mkdtemp(prefix="fieldcast-container-")
    os.chmod(folder, 0o755)
    unittest.addModuleCleanup(shutil.rmtree, folder)
    image_path = os.path.join(folder, "image.tar")
    first_run = make_image(image_path, "--offline")
    layout, bundle = os.path.join(folder, "layout"), os.path.join(folder, "bundle")
    with tarfile.open(image_path) as archive:
        archive.extractall(layout)
    version = json.loads(read(f"{layout}/index.json"))["manifests"][0]["annotations"]["org.opencontainers.image.ref.name"]
    run("umoci", "unpack", "--image", f"{layout}:{version}", bundle)
    for block in parse("docs/container.md", read(f"{SOURCE_DIR}/docs/container.md")):
        if name := block.markers.get("file"):
            path = os.path.join(folder, name)
            os.makedirs(os.path.dirname(path), exist_ok=True)
            with open(path, "w", encoding="utf-8") as file:
                file.write(block.text)


def group_number(name):
    found = re.search(rf"^{name}:x:(\d+):", read(f"{bundle}/rootfs/etc/group"), re.MULTILINE)
    return int(found[1]) if found else int(name)


class Container:
    """One service of a compose file. Fields that this class does not translate are a failure."""

    TRANSLATED = {"image", "command", "network_mode", "read_only", "cap_drop", "security_opt", "devices", "group_add", "volumes", "restart",
                  "healthcheck", "environment", "depends_on"}

    def __init__(self, example, name, devices):
        self.example, self.name, self.devices = example, name, devices
        self.service = example.services[name]
        unknown = set(self.service) - self.TRANSLATED
        assert not unknown, f"{name}: not translated: {unknown}"
        assert re.fullmatch(r"fieldcast:[\d.]+", self.service["image"]), self.service["image"]
        assert self.service["network_mode"] in ("host", "none") or self.service["network_mode"].startswith("service:")
        self.id = f"{os.path.basename(folder)}-{example.name}-{name}"
        self.folder = os.path.join(folder, "run", self.id)
        os.makedirs(self.folder, exist_ok=True)
        self.log_path = os.path.join(self.folder, "log")
        self.process = None

    def config(self):
        """Returns the configuration of the runtime: that of the image, changed by the service."""
        service = self.service
        config = json.loads(read(f"{bundle}/config.json"))
        process = config["process"]
        process["terminal"] = False
        process["args"] = service.get("command", process["args"])
        process["env"] += [f"{key}={self.example.resolved(value)}" for key, value in service.get("environment", {}).items()]
        process["user"]["additionalGids"] = [group_number(group) for group in service.get("group_add", [])]
        if service.get("cap_drop") == ["ALL"]:
            process["capabilities"] = {}
        process["noNewPrivileges"] = "no-new-privileges:true" in service.get("security_opt", [])
        config["root"] = {"path": f"{bundle}/rootfs", "readonly": service.get("read_only", False)}
        # A file system of the cgroups is not needed, and some machines cannot mount it.
        config["mounts"] = [mount for mount in config["mounts"] if mount["destination"] not in ("/sys/fs/cgroup", "/var/lib/fieldcast")]
        config["mounts"] += [self.mount(volume) for volume in service.get("volumes", [])]
        # A pseudo-terminal works only in its own file system, so it is mounted and not created.
        for device in service.get("devices", []):
            outside, inside = device.split(":")
            config["mounts"].append({"destination": inside, "type": "bind", "source": self.devices[outside], "options": ["bind", "rw"]})
        config["linux"]["namespaces"] = [space for space in config["linux"]["namespaces"] if space["type"] != "network"]
        return config

    def mount(self, volume):
        source, destination, *options = volume.split(":")
        if source.startswith("."):
            source = os.path.normpath(os.path.join(self.example.folder, source))
            assert os.path.isfile(source), source
        else:
            # As an engine does, a new volume gets the owner of the directory in the image.
            inside = os.stat(f"{bundle}/rootfs{destination}")
            source = os.path.join(folder, "volumes", source)
            if not os.path.isdir(source):
                os.makedirs(source)
                os.chown(source, inside.st_uid, inside.st_gid)
                os.chmod(source, inside.st_mode & 0o777)
        return {"destination": destination, "type": "bind", "source": source, "options": ["bind", "ro" if "ro" in options else "rw"]}

    def start(self):
        with open(os.path.join(self.folder, "config.json"), "w", encoding="utf-8") as file:
            json.dump(self.config(), file)
        with open(self.log_path, "ab") as log:
            self.process = subprocess.Popen(["runc", "run", "--bundle", self.folder, self.id], stdin=subprocess.DEVNULL, stdout=log, stderr=log)
        wait_until(lambda: self.state() == "running" or self.process.poll() is not None, SECONDS, self.log)
        assert self.process.poll() is None, self.log()
        return self

    def state(self):
        done = subprocess.run(["runc", "state", self.id], capture_output=True, text=True)
        return json.loads(done.stdout)["status"] if done.returncode == 0 else ""

    def pid(self):
        return json.loads(run("runc", "state", self.id))["pid"]

    def execute(self, *command):
        return subprocess.run(["runc", "exec", self.id, *command], capture_output=True, text=True, timeout=SECONDS, stdin=subprocess.DEVNULL)

    def health(self):
        kind, *command = self.service["healthcheck"]["test"]
        assert kind == "CMD"
        return self.execute(*command)

    def stop(self, sent="TERM"):
        """Returns the exit code and the seconds until the container ended."""
        begin = time.monotonic()
        run("runc", "kill", self.id, sent)
        code = self.process.wait(SECONDS)
        return code, time.monotonic() - begin

    def close(self):
        if self.process and self.process.poll() is None:
            subprocess.run(["runc", "kill", self.id, "KILL"], capture_output=True)
            self.process.wait(SECONDS)
        subprocess.run(["runc", "delete", "--force", self.id], capture_output=True)

    def log(self):
        return read(self.log_path)


class Example:
    def __init__(self, name):
        self.name, self.folder = name, os.path.join(folder, name)
        self.compose = yaml.safe_load(read(f"{self.folder}/compose.yaml"))
        self.services = self.compose["services"]
        env = os.path.join(self.folder, ".env")
        self.variables = dict(line.split("=", 1) for line in read(env).splitlines()) if os.path.exists(env) else {}

    def resolved(self, text):
        return re.sub(r"\$\{(\w+)\}", lambda match: self.variables[match[1]], text)


class Database:
    """PostgreSQL of this machine with the settings of the service, instead of its image."""

    def __init__(self, example):
        service = example.services["database"]
        environment = {key: example.resolved(value) for key, value in service["environment"].items()}
        self.owner = pwd.getpwnam("postgres")
        self.programs = sorted(glob.glob("/usr/lib/postgresql/*/bin"))[-1]
        self.folder = tempfile.mkdtemp(prefix="database-", dir=folder)
        os.chown(self.folder, self.owner.pw_uid, self.owner.pw_gid)
        password = os.path.join(self.folder, "password")
        with open(password, "w", encoding="utf-8") as file:
            file.write(environment["POSTGRES_PASSWORD"])
        os.chown(password, self.owner.pw_uid, self.owner.pw_gid)
        run(f"{self.programs}/initdb", "-D", f"{self.folder}/data", "-U", environment["POSTGRES_USER"], f"--pwfile={password}", "--auth=scram-sha-256",
            "--auth-local=trust", "--no-sync", "-E", "UTF8", "--locale=C", **self.as_owner())
        program, *arguments = service["command"]
        with open(f"{self.folder}/log", "wb") as log:
            self.process = subprocess.Popen([f"{self.programs}/{program}", "-D", f"{self.folder}/data", "-k", self.folder, "-c", "fsync=off", *arguments],
                                            stdin=subprocess.DEVNULL, stdout=log, stderr=log, **self.as_owner())
        self.user, self.name = environment["POSTGRES_USER"], environment["POSTGRES_DB"]
        wait_until(lambda: self.create(), SECONDS, lambda: read(f"{self.folder}/log"))

    def as_owner(self):
        return {"user": self.owner.pw_uid, "group": self.owner.pw_gid, "extra_groups": [], "cwd": self.folder}

    def create(self):
        return subprocess.run([f"{self.programs}/createdb", "-h", self.folder, "-U", self.user, self.name], capture_output=True).returncode == 0

    def number(self, sql):
        return int(run(f"{self.programs}/psql", "-h", self.folder, "-U", self.user, "-d", self.name, "-Atc", sql))

    def close(self):
        self.process.send_signal(signal.SIGINT)
        self.process.wait(SECONDS)


def status_of(pid):
    return dict(re.findall(r"^(\w+):\s+(.*)$", read(f"/proc/{pid}/status"), re.MULTILINE))


class Image(unittest.TestCase):
    def test_is_small_and_made_a_second_time_it_is_the_same(self):
        second = os.path.join(folder, "second.tar")
        said = make_image(second, "--offline")
        print(first_run.strip(), file=sys.stderr)
        self.assertEqual(said.split()[-1], first_run.split()[-1])
        with open(second, "rb") as again, open(image_path, "rb") as first:
            self.assertEqual(again.read(), first.read())
        os.remove(second)
        size = sum(os.lstat(os.path.join(path, name)).st_size for path, _, names in os.walk(f"{bundle}/rootfs") for name in names)
        self.assertLess(size, MOST_BYTES)

    def test_has_only_the_programs_of_fieldcast(self):
        self.assertEqual(sorted(os.listdir(f"{bundle}/rootfs/usr/bin")),
                         ["fieldcast", "fieldcast-bridge", "fieldcast-port", "fieldcast-sim", "fieldcast-station"])
        self.assertEqual(os.listdir(f"{bundle}/rootfs/usr/sbin"), [])
        privileged = [os.path.join(path, name) for path, _, names in os.walk(f"{bundle}/rootfs") for name in names
                      if os.lstat(os.path.join(path, name)).st_mode & 0o6000]
        self.assertEqual(privileged, [])

    def test_names_its_packages_with_their_licences(self):
        packages = os.listdir(f"{bundle}/rootfs/var/lib/dpkg/status.d")
        self.assertLess({"fieldcast", "fieldcast-sim", "libc6", "libssl3"} if "libssl3" in packages else {"fieldcast", "libc6"}, set(packages))
        # Packages of one source share a directory by a link.
        for name in packages:
            self.assertTrue(os.path.lexists(f"{bundle}/rootfs/usr/share/doc/{name}"), name)

    def test_the_manifest_of_kubernetes_gives_no_rights(self):
        with open(os.path.join(folder, "press-shop.yaml"), encoding="utf-8") as file:
            pod = yaml.safe_load(file)["spec"]["template"]["spec"]
        [container] = pod["containers"]
        self.assertEqual((pod["securityContext"]["runAsUser"], pod["securityContext"]["fsGroup"], pod["securityContext"]["supplementalGroups"]),
                         (USER_ID, USER_ID, [DIALOUT_ID]))
        self.assertEqual(container["securityContext"],
                         {"allowPrivilegeEscalation": False, "readOnlyRootFilesystem": True, "capabilities": {"drop": ["ALL"]}})
        self.assertEqual(container["livenessProbe"]["exec"]["command"], Example("plant").services["bridge"]["healthcheck"]["test"][1:])
        self.assertEqual({mount["mountPath"] for mount in container["volumeMounts"]}, {"/etc/fieldcast", "/var/lib/fieldcast"})


class Running(unittest.TestCase):
    def started(self, example, name, devices=None):
        container = Container(example, name, devices or {})
        self.addCleanup(container.close)
        return container.start()

    def check_rights(self, container):
        status = status_of(container.pid())
        self.assertEqual(set(status["Uid"].split()), {str(USER_ID)})
        self.assertEqual(int(status["CapEff"], 16) | int(status["CapBnd"], 16), 0)
        self.assertEqual(status["NoNewPrivs"], "1")
        for place in ("/etc/fieldcast", "/tmp", "/"):
            refused = container.execute("fieldcast", "secure", "init", f"{place}/authority")
            self.assertNotEqual(refused.returncode, 0, place)
            self.assertRegex(refused.stdout + refused.stderr, "Read-only file system|Permission denied")
        self.assertIn("Read-only file system", container.execute("fieldcast", "secure", "init", "/tmp/authority").stderr)

    def check_stop(self, container):
        code, seconds = container.stop()
        print(f"{container.name}: SIGTERM ends it in {seconds:.2f} s", file=sys.stderr)
        self.assertEqual(code, 0, container.log())
        self.assertLess(seconds, STOP_SECONDS)


class Try(Running):
    def test_the_simulator_and_the_bridge(self):
        example = Example("try")
        simulator, bridge = self.started(example, "simulator"), self.started(example, "bridge")
        begin = time.monotonic()

        def values():
            done = bridge.execute("fieldcast", "watch", "--once", "--json")
            return [json.loads(line) for line in done.stdout.splitlines()] if done.returncode == 0 else []
        wait_until(lambda: {row["channel"] for row in values() if row.get("quality") == "GOOD"} == {"voltage", "setpoint"}, SECONDS, bridge.log)
        print(f"try: every value GOOD {time.monotonic() - begin:.2f} s after the start", file=sys.stderr)
        written = bridge.execute("fieldcast", "write", "line/meter/setpoint=21.5", "--verify")
        self.assertEqual(written.returncode, 0, written.stdout + written.stderr)
        for container in (simulator, bridge):
            self.check_rights(container)
        # The root is read-only and there is no volume for data in this example.
        self.assertNotEqual(bridge.execute("fieldcast", "secure", "init", "/var/lib/fieldcast/authority").returncode, 0)

        self.assertEqual(bridge.health().returncode, 0)
        os.kill(bridge.pid(), signal.SIGSTOP)
        stalled = bridge.health()
        os.kill(bridge.pid(), signal.SIGCONT)
        self.assertEqual(stalled.returncode, 1, stalled.stderr)
        wait_until(lambda: bridge.health().returncode == 0, SECONDS, "not healthy again")
        with HeldThread(bridge.pid(), "line"):
            hanging = wait_until(lambda: (found := bridge.health()).returncode != 0 and found, SECONDS, "a bus that hangs is healthy")
        self.assertEqual(hanging.returncode, 1)
        self.assertIn("503", hanging.stderr)
        wait_until(lambda: bridge.health().returncode == 0, SECONDS, "not healthy again")
        self.check_stop(bridge)
        _, *check = example.services["bridge"]["healthcheck"]["test"]
        gone = simulator.execute(*check)
        self.assertEqual(gone.returncode, 1, gone.stderr)
        self.check_stop(simulator)


class Plant(Running):
    def simulate(self, example):
        """Starts a plant at a pseudo-terminal with the group of serial devices; returns the device."""
        config = read(f"{example.folder}/bridge.yaml")
        link = os.path.join(folder, "ttyUSB0")
        self.assertIn("/dev/ttyUSB0", config)
        path = os.path.join(folder, "simulated.yaml")
        with open(path, "w", encoding="utf-8") as file:
            file.write(config.replace("/dev/ttyUSB0", link))
        simulator = subprocess.Popen([f"{BIN_DIR}/fieldcast-sim", path], stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL)
        self.addCleanup(simulator.wait, SECONDS)
        self.addCleanup(simulator.terminate)
        wait_until(lambda: os.path.exists(link), SECONDS, "no simulated line")
        device = os.path.realpath(link)
        os.chown(device, 0, DIALOUT_ID)
        os.chmod(device, 0o660)
        return device

    def test_bridge_station_and_database(self):
        example = Example("plant")
        device = self.simulate(example)
        station = self.started(example, "station")
        wait_until(lambda: station.health().returncode == 0, SECONDS, station.log)  # without its database
        database = Database(example)
        self.addCleanup(database.close)
        begin = time.monotonic()
        bridge = self.started(example, "bridge", {"/dev/ttyUSB0": device})

        def request(path):
            with urllib.request.urlopen(f"http://127.0.0.1:8090{path}", timeout=SECONDS) as response:
                return json.load(response)

        def good():
            try:
                found = request("/api/channels")
            except OSError:
                return False
            return any(channel.get("quality") == "GOOD" for channel in found)
        wait_until(good, SECONDS, lambda: bridge.log() + station.log())
        print(f"plant: a GOOD value at the station {time.monotonic() - begin:.2f} s after the start of the bridge", file=sys.stderr)
        wait_until(lambda: bridge.health().returncode == 0 and station.health().returncode == 0, SECONDS, "not healthy")
        for container in (bridge, station):
            self.check_rights(container)
            status = status_of(container.pid())
            print(f"{container.name}: {status['VmRSS']} resident", file=sys.stderr)
        self.assertIn(str(DIALOUT_ID), status_of(bridge.pid())["Groups"].split())
        self.assertRegex(bridge.log(), r"info press-shop: running: 1 bus")

        def recorded():
            return database.number("select count(*) from sample_history where bus = 'line' and quality = 'GOOD'")

        def stored():
            done = bridge.execute("fieldcast", "history", "line/meter/power", "--json", "--config", "/etc/fieldcast/bridge.yaml")
            return [json.loads(line)["published_at"] for line in done.stdout.splitlines()] if done.returncode == 0 else []
        wait_until(lambda: recorded() >= 3 and len(stored()) >= 3, SECONDS, "nothing is stored")
        oldest, before = stored()[0], recorded()

        # As after a failure of the host's process: the new bridge has the same number in its namespace.
        bridge.stop("KILL")
        bridge.close()
        begin = time.monotonic()
        bridge.start()
        wait_until(lambda: recorded() > before + 2, SECONDS, station.log)
        print(f"plant: recorded again {time.monotonic() - begin:.2f} s after the restart", file=sys.stderr)
        self.assertEqual(stored()[0], oldest, "the store was lost")

        for container in (bridge, station):
            self.check_stop(container)
            container.close()
        before = recorded()
        self.assertGreater(before, 5)
        station.start()
        bridge.start()
        wait_until(lambda: recorded() > before, SECONDS, station.log)
        self.assertEqual(stored()[0], oldest, "the store was lost")
        for container in (bridge, station):
            self.check_stop(container)

    def test_a_bridge_outside_of_the_group_reports_the_port(self):
        example = Example("plant")
        device = self.simulate(example)
        del example.services["bridge"]["group_add"]
        bridge = self.started(example, "bridge", {"/dev/ttyUSB0": device})
        wait_until(lambda: "the port is closed: /dev/ttyUSB0: permission denied" in bridge.log(), SECONDS, bridge.log)
        self.assertEqual(bridge.health().returncode, 0)  # a restart would not help


def download_libraries():
    with tempfile.TemporaryDirectory() as scratch:
        with contextlib.suppress(AssertionError):
            make_image(f"{scratch}/image.tar", "--offline")
            return
        try:
            make_image(f"{scratch}/image.tar")
        except AssertionError as error:
            if "mmdebstrap failed" not in str(error):
                raise
            print(f"mmdebstrap cannot download the libraries here: {error}")
            sys.exit(77)


def missing():
    for program in ("runc", "umoci", "mmdebstrap"):
        if not shutil.which(program):
            return f"{program} is missing; `tools/install.sh ci` installs it"
    return "" if glob.glob("/usr/lib/postgresql/*/bin/initdb") else "PostgreSQL is missing"


if __name__ == "__main__":
    PACKAGES_DIR, SOURCE_DIR, BIN_DIR = map(os.path.abspath, sys.argv[1:4])
    if reason := missing():
        print(reason)
        sys.exit(77)
    if networks.PRIVATE not in os.environ:
        download_libraries()
    networks.enter()
    unittest.main(argv=sys.argv[:1], verbosity=2)
