"""Tests bridges and stations over several networks: discovery servers that stop and restart, and
several sites in one station.

usage: e2e_sites.py BIN_DIR

Runs in its own network (unshare) without multicast. Exit code 77: a requirement is missing; the
output names it.
"""

import contextlib
import json
import os
import re
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time
import unittest

import networks
from networks import system
from plant import Plant, Result, claim_domain, modbus_line, run_cli, wait_until

BIN_DIR = ""
DOCUMENT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../docs/many-sites.md")
SERVER = "fast-discovery-server"    # from the package fastdds-tools
CHANNELS = 20
FOUND_SECONDS = 15  # until a station has every channel

CONFIG = """
bridge: {name}""" + modbus_line() + "\n".join(f'          - {{ name: c{i}, at: "holding:{i}", type: uint16, access: read-write }}' for i in range(CHANNELS)) + "\n"


def free_udp_port():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as one:
        one.bind(("127.0.0.1", 0))
        return one.getsockname()[1]


class Servers:
    """Two discovery servers that can be stopped and restarted."""

    def __init__(self, test):
        self.ports = [free_udp_port(), free_udp_port()]
        self.processes = [None, None]
        test.addCleanup(self.stop, 0)
        test.addCleanup(self.stop, 1)

    @property
    def key(self):
        return f', discovery-servers: ["127.0.0.1:{self.ports[0]}", "127.0.0.1:{self.ports[1]}"]'

    def start(self, identity):
        self.processes[identity] = subprocess.Popen([SERVER, "-i", str(identity), "-l", "127.0.0.1", "-p", str(self.ports[identity])],
                                                    stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, stdin=subprocess.DEVNULL)

    def stop(self, identity):
        if self.processes[identity] is not None:
            self.processes[identity].kill()  # like a power failure
            self.processes[identity].wait()
        self.processes[identity] = None


class Watch:
    def __init__(self, file):
        self.samples = 0
        self.process = subprocess.Popen([os.path.join(BIN_DIR, "fieldcast"), "watch", "--json", "--config", file], stdout=subprocess.PIPE,
                                        stderr=subprocess.DEVNULL, text=True)
        self.thread = threading.Thread(target=self._read, daemon=True)
        self.thread.start()

    def _read(self):
        for _ in self.process.stdout:
            self.samples += 1

    def await_more(self, seconds=FOUND_SECONDS):
        before = self.samples
        wait_until(lambda: self.samples >= before + 3 * CHANNELS, seconds, "no more samples")

    def close(self):
        self.process.send_signal(signal.SIGTERM)
        self.process.wait(10)
        self.thread.join()


class Page:
    def __init__(self, test, file):
        self.process = subprocess.Popen([os.path.join(BIN_DIR, "fieldcast-station"), "--config", file, "--listen", "127.0.0.1:0"],
                                        stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        test.addCleanup(self.process.wait)
        test.addCleanup(self.process.kill)
        self.address = ""
        for text in self.process.stdout:
            if "http://" in text:
                self.address = text[text.index("http://"):].split()[0].rstrip("/,")
                break
        threading.Thread(target=self.process.stdout.read, daemon=True).start()

    def get(self, path):
        return json.loads(subprocess.run(["curl", "-sS", self.address + path], check=True, capture_output=True, text=True).stdout)


class DiscoveryServers(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        system("sysctl", "-w", "net.ipv4.igmp_max_memberships=0")

    @classmethod
    def tearDownClass(cls):
        system("sysctl", "-w", "net.ipv4.igmp_max_memberships=20")

    def setUp(self):
        if shutil.which(SERVER) is None:
            self.skipTest(f"{SERVER} is missing: tools/install.sh test")

    def assert_new_station_finds_all(self, plant, when):
        began = time.monotonic()

        def found():
            seen = plant.cli("watch", "--once", "--json")
            return seen.code == 0 and len({line["channel"] for line in seen.json_lines()}) == CHANNELS
        wait_until(found, FOUND_SECONDS, lambda: f"a new station does not find all {when}")
        print(f"{when}: a new station has every channel after {time.monotonic() - began:.1f} s", flush=True)

    def test_a_server_that_restarts_immediately_is_joined_again(self):
        servers = Servers(self)
        servers.start(0)
        key = f', discovery-server: "127.0.0.1:{servers.ports[0]}"'
        with Plant(BIN_DIR, CONFIG.replace("{name}", "served"), dds=key) as plant:
            # a new server reaches the message numbers of the old one only after as many stations
            for number in range(5):
                self.assert_new_station_finds_all(plant, f"as station {number + 1}")
            servers.stop(0)
            servers.start(0)
            self.assert_new_station_finds_all(plant, "with the server anew")

    def test_a_bridge_that_dies_with_its_server_is_removed_when_that_is_back(self):
        servers = Servers(self)
        servers.start(0)
        key = f', discovery-server: "127.0.0.1:{servers.ports[0]}"'
        with Plant(BIN_DIR, CONFIG.replace("{name}", "served"), dds=key) as plant:
            file = os.path.join(plant.run, "station.yaml")
            with open(file, "w", encoding="utf-8") as out:
                out.write(f"station: page\ndds: {{ domain: {plant.domain}{key} }}\n")
            page = Page(self, file)
            wait_until(lambda: len(page.get("/api/bridges")) == 1 and len(page.get("/api/channels")) == CHANNELS, FOUND_SECONDS, "not found")
            plant.bridge.kill()
            plant.bridge.wait()
            plant.bridge = None
            servers.stop(0)
            servers.start(0)
            wait_until(lambda: not any(channel["quality"] == "GOOD" for channel in page.get("/api/channels")), FOUND_SECONDS, "values of nobody are good")
            wait_until(lambda: not page.get("/api/bridges") + page.get("/api/buses") + page.get("/api/channels"), 40,
                       lambda: f"there is still {page.get('/api/bridges')}")

    def test_one_of_two_may_be_away_and_both_may_restart(self):
        servers = Servers(self)
        servers.start(0)
        servers.start(1)
        with Plant(BIN_DIR, CONFIG.replace("{name}", "served"), dds=servers.key) as plant, contextlib.closing(Watch(plant.file)) as watch:
            self.assert_new_station_finds_all(plant, "with both servers")
            watch.await_more()
            servers.stop(0)
            self.assert_new_station_finds_all(plant, "without the first")
            servers.start(0)
            time.sleep(1)
            servers.stop(1)
            self.assert_new_station_finds_all(plant, "with the first anew, without the second")
            servers.stop(0)
            until = time.monotonic() + 12  # longer than the lease of a participant, 10 s
            while time.monotonic() < until:
                watch.await_more(5)
            self.assertEqual(plant.cli("write", "line/press/c1=5", "--json").code, 3, "found without a server")
            servers.start(0)
            servers.start(1)
            self.assert_new_station_finds_all(plant, "with both anew")
            watch.await_more()
            self.assertEqual(plant.cli("write", "line/press/c1=5", "--verify").code, 0)

    def test_that_do_not_respond_are_said_in_words_and_nothing_hangs(self):
        servers = Servers(self)
        domain, claim = claim_domain()
        self.addCleanup(claim.close)
        file = f"/tmp/fieldcast-unserved-{os.getpid()}.yaml"
        self.addCleanup(os.remove, file)
        with open(file, "w", encoding="utf-8") as out:
            out.write(CONFIG.replace("{name}", "unserved").replace("{run}", "/nowhere"))
            out.write(f"dds: {{ domain: {domain}{servers.key} }}\n")
        began = time.monotonic()
        watch = run_cli(BIN_DIR, "watch", "--once", "--config", file)
        self.assertEqual(watch.code, 3, str(watch))
        self.assertIn(f"no response of the discovery server 127.0.0.1:{servers.ports[0]} (fast-discovery-server -i 0), "
                      f"127.0.0.1:{servers.ports[1]} (fast-discovery-server -i 1)", watch.err)
        self.assertLess(time.monotonic() - began, 15)
        bridge = subprocess.Popen([os.path.join(BIN_DIR, "fieldcast-bridge"), file], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        self.addCleanup(bridge.kill)
        said = []
        threading.Thread(target=lambda: said.extend(bridge.stdout), daemon=True).start()
        wait_until(lambda: any("no response of the discovery server" in text for text in said), 15, lambda: "".join(said))
        bridge.send_signal(signal.SIGTERM)
        self.assertEqual(bridge.wait(10), 0)


class OwnServers(unittest.TestCase):
    """A discovery server on an address of this machine."""

    OWN = "10.77.0.3"

    def test_at_an_address_that_dds_is_not_to_use_is_refused_in_words(self):
        system("ip", "address", "add", self.OWN + "/32", "dev", "lo")
        self.addCleanup(system, "ip", "address", "del", self.OWN + "/32", "dev", "lo")
        folder = tempfile.mkdtemp(prefix="fieldcast-own-server-")
        self.addCleanup(shutil.rmtree, folder)
        domain, claim = claim_domain()
        self.addCleanup(claim.close)
        files = {}
        for name, text in [("bridge", CONFIG.replace("{name}", "served").replace("{run}", folder)), ("station", "station: page\n")]:
            files[name] = os.path.join(folder, name + ".yaml")
            with open(files[name], "w", encoding="utf-8") as out:
                out.write(text + f'dds: {{ domain: {domain}, discovery-server: "{self.OWN}:11811" }}\n')
        for program in (["fieldcast-bridge", files["bridge"]], ["fieldcast-bridge", files["bridge"], "--check"],
                        ["fieldcast-station", "--config", files["station"], "--listen", "127.0.0.1:0"],
                        ["fieldcast-station", "--config", files["station"], "--check"],
                        ["fieldcast", "watch", "--once", "--config", files["bridge"]]):
            with self.subTest(program=program):
                ended = subprocess.run([os.path.join(BIN_DIR, program[0]), *program[1:]], stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                                       text=True, timeout=30, check=False)
                self.assertEqual(ended.returncode, 2 if program[0] == "fieldcast" else 3, ended.stdout)
                self.assertIn(f"discovery server {self.OWN}:11811: {self.OWN} is an address of this machine", ended.stdout)
                self.assertIn(f"name {self.OWN} in interfaces", ended.stdout)


class SitesOfAStation(unittest.TestCase):
    """Two plants with the same names: one in a partition of its domain, one in another domain."""

    def test_buses_with_one_name_are_distinguished_and_commands_go_to_their_site(self):
        with Plant(BIN_DIR, CONFIG.replace("{name}", "bridge"), dds=", partition: north") as north, \
                Plant(BIN_DIR, CONFIG.replace("{name}", "bridge")) as south:
            file = os.path.join(north.run, "station.yaml")
            with open(file, "w", encoding="utf-8") as out:
                out.write(f"station: both\nweb: {{ local-role: operator }}\nsites:\n"
                          f"  - {{ name: north, dds: {{ domain: {north.domain}, partition: north }} }}\n"
                          f"  - {{ name: south, dds: {{ domain: {south.domain} }} }}\n")

            def both(*arguments):
                return run_cli(BIN_DIR, *arguments, "--config", file)
            seen = both("watch", "--once", "--json")
            self.assertEqual({line["bus"] for line in seen.json_lines()}, {"north:line", "south:line"}, str(seen))
            self.assertEqual(len({(line["bus"], line["channel"]) for line in seen.json_lines()}), 2 * CHANNELS)
            for plant, site, value in [(north, "north", 17), (south, "south", 29)]:
                written = both("write", f"{site}:line/press/c3={value}", "--verify")
                self.assertEqual(written.code, 0, str(written))
            self.assertEqual([self.value(plant) for plant in (north, south)], [17, 29])
            status = [line for line in both("status", "--json").json_lines() if line["topic"] == "BusStatus"]
            self.assertEqual({line["bus"] for line in status}, {"north:line", "south:line"})
            self.assertEqual(both("watch", "south:*", "--once", "--json").json_lines()[0]["bus"], "south:line")
            self.nobody_in_the_south(north, file)
            nowhere = both("write", "line/press/c3=1")
            self.assertNotEqual(nowhere.code, 0, str(nowhere))
            self.page(file)

    def nobody_in_the_south(self, north, file):
        domain, claim = claim_domain()
        self.addCleanup(claim.close)
        lonely = os.path.join(north.run, "lonely.yaml")
        with open(file, encoding="utf-8") as made, open(lonely, "w", encoding="utf-8") as out:
            out.write(re.sub(r"(name: south, dds: \{ domain: )\d+", rf"\g<1>{domain}", made.read()))
        seen = run_cli(BIN_DIR, "watch", "--once", "--json", "--config", lonely)
        self.assertEqual({line["bus"] for line in seen.json_lines()}, {"north:line"}, str(seen))
        self.assertIn("no bridge found in site south", seen.err)
        written = run_cli(BIN_DIR, "write", "south:line/press/c3=1", "--config", lonely)
        self.assertEqual(written.code, 5, str(written))
        self.assertIn("no bridge found in site south", written.err)
        self.assertIn("no bridge found in site south", run_cli(BIN_DIR, "status", "--config", lonely).err)

    def value(self, plant):
        def read():
            lines = plant.cli("watch", "line/press/c3", "--once", "--json").json_lines()
            return lines[-1]["value"] if lines else None
        wait_until(lambda: read() in (17, 29), 5, "the value that was written")
        return read()

    def page(self, file):
        station = Page(self, file)
        get = station.get
        wait_until(lambda: len(get("/api/channels")) == 2 * CHANNELS, FOUND_SECONDS, lambda: str(get("/api/channels"))[:500])
        self.assertEqual({channel["channel"].split("/")[0] for channel in get("/api/channels")}, {"north:line", "south:line"})
        self.assertEqual(len(get("/api/channels?pattern=south:line")), CHANNELS)
        wait_until(lambda: {bridge["bridge"] for bridge in get("/api/bridges")} == {"north:bridge", "south:bridge"}, FOUND_SECONDS,
                   lambda: str(get("/api/bridges")))
        station.process.send_signal(signal.SIGTERM)
        self.assertEqual(station.process.wait(10), 0)


class Inside(Plant):
    """A plant whose bridge runs on another machine."""

    def __init__(self, machine, *arguments, **options):
        super().__init__(*arguments, **options)
        self.machine = machine

    def _start(self, name):
        with open(os.path.join(self.run, name + ".log"), "w", encoding="utf-8") as log:
            return self.machine.start(os.path.join(self.bin_dir, name), self.file, stdout=log, stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL)

    def cli(self, command, *arguments, **options):
        done = subprocess.run(self.machine.around(os.path.join(self.bin_dir, "fieldcast"), command, *arguments, "--config", self.file),
                              capture_output=True, text=True, timeout=60)
        return Result(done)


class Tunnel(unittest.TestCase):
    """A bridge behind a firewall with one open port. DDS uses an OpenVPN tunnel with TLS."""

    PORT = 1194
    INSIDE, OUTSIDE = "10.88.0.1", "10.88.0.2"

    @classmethod
    def setUpClass(cls):
        for program, package in [("nft", "nftables"), ("openvpn", "openvpn"), (SERVER, "fastdds-tools")]:
            if shutil.which(program) is None:
                raise unittest.SkipTest(f"{program} of {package} is missing: tools/install.sh test")
        cls.firewall = networks.Firewall(cls.PORT)
        cls.folder = tempfile.mkdtemp(prefix="fieldcast-tunnel-")
        for authority in ("ca", "stranger-ca"):
            cls.openssl("req", "-x509", "-newkey", "rsa:2048", "-nodes", "-days", "2", "-subj", f"/CN={authority}",
                        "-keyout", f"{authority}.key", "-out", f"{authority}.pem")
        for name, authority in [("inside", "ca"), ("outside", "ca"), ("stranger", "stranger-ca")]:
            cls.openssl("req", "-newkey", "rsa:2048", "-nodes", "-subj", f"/CN={name}", "-keyout", f"{name}.key", "-out", f"{name}.csr")
            cls.openssl("x509", "-req", "-days", "2", "-in", f"{name}.csr", "-CA", f"{authority}.pem", "-CAkey", f"{authority}.key",
                        "-CAcreateserial", "-out", f"{name}.pem")

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.folder)

    @classmethod
    def openssl(cls, *arguments):
        subprocess.run(["openssl", *arguments], check=True, capture_output=True, cwd=cls.folder)

    def vpn(self, machine, name, own):
        """Starts OpenVPN with this file of docs/many-sites.md and the certificate `own`."""
        with open(DOCUMENT, encoding="utf-8") as file:
            shown = re.search(rf"<!-- file: {name} -->.*?```text\n(.*?)```", file.read(), re.DOTALL).group(1)
        for word, here in [("gateway.example", self.firewall.inside.far_address), (name.replace(".conf", ""), own)]:
            shown = re.sub(rf"\b{re.escape(word)}(?=[ .])(?!.* name)", here, shown)
        with open(os.path.join(self.folder, name), "w", encoding="utf-8") as file:
            file.write(shown)
        process = machine.start("openvpn", "--cd", self.folder, "--config", name, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self.addCleanup(process.wait)
        self.addCleanup(process.terminate)

    def answers(self):
        with socket.socket() as probe:
            probe.settimeout(1)
            try:
                probe.connect((self.INSIDE, 9))
            except ConnectionRefusedError:  # no listener there, but the host is reachable
                return True
            except OSError:
                return False
        return True

    def client(self, own):
        self.vpn(networks.HERE, "outside.conf", own)

    def server(self):
        self.vpn(self.firewall.inner, "inside.conf", "inside")

    def test_dds_goes_through_one_tcp_port_with_tls_and_comes_back_after_a_cut(self):
        self.server()
        self.client("outside")
        wait_until(self.answers, FOUND_SECONDS, "no tunnel")
        served = self.firewall.inner.start(SERVER, "-i", "0", "-l", self.INSIDE, "-p", "11811", stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self.addCleanup(served.wait)
        self.addCleanup(served.kill)
        keys = f", discovery-server: '{self.INSIDE}:11811', security: none"
        with Inside(self.firewall.inner, BIN_DIR, CONFIG.replace("{name}", "inside"), dds=keys, interfaces=self.INSIDE) as plant:
            file = os.path.join(plant.run, "outside.yaml")
            with open(file, "w", encoding="utf-8") as out:
                out.write(f"station: outside\ndds: {{ domain: {plant.domain}, interfaces: [{self.OUTSIDE}]{keys} }}\n")

            def finds_all():
                seen = run_cli(BIN_DIR, "watch", "--once", "--json", "--config", file)
                return seen.code == 0 and len({line["channel"] for line in seen.json_lines()}) == CHANNELS
            began = time.monotonic()
            wait_until(finds_all, FOUND_SECONDS, "not every channel is found")
            print(f"through the tunnel: every channel after {time.monotonic() - began:.1f} s", flush=True)
            written = run_cli(BIN_DIR, "write", "line/press/c3=17", "--verify", "--config", file)
            self.assertEqual(written.code, 0, str(written))
            with contextlib.closing(Watch(file)) as watch:
                watch.await_more()
                self.firewall.outside.cut()
                time.sleep(12)  # longer than the lease of a participant, 10 s
                self.firewall.outside.cut(False)
                began = time.monotonic()
                watch.await_more(30)
                print(f"after a cut of 12 s: samples come again after {time.monotonic() - began:.1f} s", flush=True)

    def test_lets_nobody_in_without_a_certificate_of_its_authority(self):
        self.server()
        self.client("stranger")
        time.sleep(3)
        self.assertFalse(self.answers())


def main():
    global BIN_DIR
    networks.enter()
    BIN_DIR = sys.argv[1]
    unittest.main(argv=sys.argv[:1] + sys.argv[2:], verbosity=2)


if __name__ == "__main__":
    main()
