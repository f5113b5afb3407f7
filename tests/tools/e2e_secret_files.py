"""Tests every option and key that names a secret file: a file that others can read or change is
refused with a remedy and without its content. A file that is not a configuration is not quoted
either.

usage: e2e_secret_files.py BIN_DIR
"""

import itertools
import os
import resource
import select
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time
import unittest

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "interop"))
from peers import free_port

BIN_DIR = ""
SECONDS = 20
OPEN_MODES = [0o644, 0o604, 0o606, 0o660]

BUSES = """
buses:
  - name: line
    port: { serial: /tmp/none, baud: 9600, format: 8N1 }
    protocol: modbus-rtu
    devices: [ { name: plc, number: P1, address: 1, channels: [ { name: a, at: "holding:1", type: int16 } ] } ]
"""

folder = None
numbers = itertools.count()  # of members


def setUpModule():
    global folder
    folder = tempfile.mkdtemp(prefix="fieldcast-secret-files-")
    subprocess.run(["openssl", "req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:prime256v1", "-nodes", "-days", "2",
                    "-subj", "/CN=17", "-keyout", path("key"), "-out", path("cert.pem")], check=True, capture_output=True, timeout=60)
    write("password", "a password of somebody\n")
    write("secrets", "17 a secret of the module 17\n")
    run("fieldcast", "secure", "init", path("plant"))
    run("fieldcast", "secure", "add", "bridge", "line", "--authority", path("plant"))
    write("engineers.yaml", "bridge: b\nprogram: { engineers: { listen: 127.0.0.1:4950, certificate: cert.pem, key: key } }\n" + BUSES)
    write("modules.yaml", "bridge: b\nprogram: { engineers: { listen: 127.0.0.1:4950 }, modules: { listen: 127.0.0.1:4951, "
          "certificate: cert.pem, key: key } }\n" + BUSES)
    write("secrets.yaml", "bridge: b\nprogram: { engineers: { listen: 127.0.0.1:4950 }, modules: { listen: 127.0.0.1:4951, "
          "secrets: secrets } }\n" + BUSES)
    write("dds.yaml", "bridge: line\nprogram: { engineers: { listen: 127.0.0.1:4950 } }\ndds: { security: plant/members/line }\n" + BUSES)
    write("web.yaml", "web: { listen: 127.0.0.1:8090, certificate: cert.pem, key: key }\n")


def tearDownModule():
    shutil.rmtree(folder)


def path(name):
    return os.path.join(folder, name)


def write(name, text, mode=0o600):
    with open(path(name), "w", encoding="latin-1") as file:
        file.write(text)
    os.chmod(path(name), mode)
    return path(name)


def run(program, *arguments):
    try:
        ended = subprocess.run([os.path.join(BIN_DIR, program), *arguments], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                               stderr=subprocess.STDOUT, text=True, timeout=SECONDS)
    except subprocess.TimeoutExpired as late:
        raise AssertionError(f"{program} {arguments}: {late.output}") from late
    return ended.returncode, ended.stdout


# The secret files, each with the command that uses it.
PORT = ["fieldcast-port", "--server", "127.0.0.1:1", "--device", "P1"]
MODULE = ["fieldcast", "module", "--server", "127.0.0.1:1", "--number", "17", "--line", "/tmp/none"]


def table():
    link = ["--link", path("port")]
    return {
        "fieldcast user add --password-file": ("password", ["fieldcast", "user", "add", "anna", "--store", path("users.db"),
                                                            "--password-file", path("password")]),
        "fieldcast-port --password-file": ("password", [*PORT, *link, "--user", "anna", "--password-file", path("password")]),
        "fieldcast-port --key": ("key", [*PORT, *link, "--tls", "--certificate", path("cert.pem"), "--key", path("key")]),
        "fieldcast module --key": ("key", [*MODULE, "--certificate", path("cert.pem"), "--key", path("key")]),
        "fieldcast module --secret-file": ("password", [*MODULE, "--secret-file", path("password")]),
        "engineers: key": ("key", ["fieldcast-bridge", "--check", path("engineers.yaml")]),
        "modules: key": ("key", ["fieldcast-bridge", "--check", path("modules.yaml")]),
        "modules: secrets": ("secrets", ["fieldcast-bridge", "--check", path("secrets.yaml")]),
        "dds: security": ("plant/members/line/identity.key", ["fieldcast-bridge", "--check", path("dds.yaml")]),
        "web: key": ("key", ["fieldcast-station", "--check", "--config", path("web.yaml")]),
        "fieldcast --security": ("plant/members/line/identity.key",
                                 ["fieldcast", "status", "--security", path("plant/members/line")]),
        "fieldcast secure --authority": ("plant/identity-ca.key", ["fieldcast", "secure", "add", "plant", f"mes-{next(numbers)}",
                                                                   "--authority", path("plant")]),
    }


class SecretFiles(unittest.TestCase):
    def test_one_that_others_may_read_or_change_is_refused_with_the_remedy(self):
        for name, (file, command) in table().items():
            with open(path(file), encoding="utf-8") as content:
                hidden = [line for line in content.read().splitlines() if "-----" not in line]
            for mode in OPEN_MODES if name.startswith("fieldcast-port --pass") else OPEN_MODES[:1]:
                with self.subTest(name=name, mode=oct(mode)):
                    os.chmod(path(file), mode)
                    code, said = run(*command)
                    self.assertNotEqual(code, 0, said)
                    self.assertIn("chmod 600 " + path(file), said)
                    for line in hidden:
                        self.assertNotIn(line, said)
            os.chmod(path(file), 0o600)

    def test_one_that_is_closed_is_taken(self):
        for name in ["fieldcast user add --password-file", "engineers: key", "modules: key", "modules: secrets", "dds: security", "web: key",
                     "fieldcast secure --authority"]:
            with self.subTest(name=name):
                code, said = run(*table()[name][1])
                self.assertEqual(code, 0, said)


class Strangers(unittest.TestCase):
    """Passes files that are not configurations to every option that expects one."""

    def test_nothing_of_them_is_shown(self):
        large = write("large", "hidden\n")
        os.truncate(large, 2_000_000_000)  # sparse
        strangers = [write("shadow", "root:$6$hidden:19000:0:99999:7:::\n"), write("password-of-all", "hidden\n"),
                     write("key.pem", "-----BEGIN PRIVATE KEY-----\nhidden\n-----END PRIVATE KEY-----\n"),
                     write("environment", "PASSWORD=hidden\n"), write("binary", "\x7fELF\0\1hidden\xff"), write("tag", "!hidden {hidden"), large]
        commands = {
            "fieldcast-bridge --check": lambda file: ["fieldcast-bridge", "--check", file],
            "fieldcast-bridge": lambda file: ["fieldcast-bridge", file],
            "fieldcast-sim": lambda file: ["fieldcast-sim", file],
            "fieldcast-sim --faults": lambda file: ["fieldcast-sim", path("engineers.yaml"), "--faults", file],
            "fieldcast-station --check": lambda file: ["fieldcast-station", "--check", "--config", file],
            "fieldcast plan": lambda file: ["fieldcast", "plan", file],
            "fieldcast user list": lambda file: ["fieldcast", "user", "list", "--config", file],
            "fieldcast audit": lambda file: ["fieldcast", "audit", "--config", file],
            "fieldcast doctor": lambda file: ["fieldcast", "doctor", file],
            "fieldcast-port --ca": lambda file: [*PORT, "--link", path("port"), "--ca", file],
        }
        for name, command in commands.items():
            for stranger in strangers:
                with self.subTest(name=name, file=os.path.basename(stranger)):
                    code, said = run(*command(stranger))
                    self.assertNotEqual(code, 0, said)
                    self.assertNotIn("hidden", said)
                    if name.startswith("fieldcast-bridge") and stranger != large:
                        self.assertTrue(said.startswith(stranger + ":1:1: this is no Fieldcast configuration"), said)


class Running:
    """A program that may dump core until the test kills it."""

    def __init__(self, *command, environment=None):
        self.process = subprocess.Popen([os.path.join(BIN_DIR, command[0]), *command[1:]], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                                        stderr=subprocess.STDOUT, cwd=folder, env={**os.environ, **(environment or {})},
                                        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CORE, (resource.RLIM_INFINITY,) * 2))
        self.said = ""

    def until(self, text):
        ends = time.monotonic() + SECONDS
        while text not in self.said:
            if not select.select([self.process.stdout], [], [], max(0, ends - time.monotonic()))[0]:
                raise AssertionError(f"no '{text}' in {self.said}")
            part = os.read(self.process.stdout.fileno(), 65536).decode()
            if not part:
                raise AssertionError(f"ended without '{text}': {self.said}")
            self.said += part

    def core_limit(self):
        with open(f"/proc/{self.process.pid}/limits", encoding="utf-8") as limits:
            return next(line.split()[4:6] for line in limits if line.startswith("Max core file size"))

    def leaves_a_core(self):
        """Kills the program with SIGSEGV; returns whether it dumped core."""
        os.kill(self.process.pid, signal.SIGSEGV)
        status = os.waitpid(self.process.pid, 0)[1]
        self.process.returncode = -1
        self.process.stdin.close()
        self.process.stdout.close()
        if not os.WIFSIGNALED(status) or os.WTERMSIG(status) != signal.SIGSEGV:
            raise AssertionError(f"status {status}: {self.said}")
        return os.WCOREDUMP(status)


class Faults(unittest.TestCase):
    def test_a_program_that_is_killed_leaves_no_core_and_its_log_has_no_secret(self):
        listener = socket.create_server(("127.0.0.1", 0))  # accepts but sends nothing
        modules = free_port()
        config = write("running.yaml", f"bridge: b\ndds: {{ domain: 87 }}\nprogram: {{ modules: {{ listen: 127.0.0.1:{modules}, "
                       "secrets: secrets } }\n" + BUSES.replace("number: P1, ", ""))
        bridge = Running("fieldcast-bridge", config)
        bridge.until("running:")
        module = socket.create_connection(("127.0.0.1", modules), SECONDS)
        module.recv(100)
        module.sendall(b"17 guess\r\n")
        self.assertIn(b"does not know its secret", module.recv(100))
        bridge.until("does not know its secret")
        port = Running("fieldcast-port", "--server", f"127.0.0.1:{listener.getsockname()[1]}", "--device", "P1", "--link", path("port"),
                       "--user", "anna", "--password-file", path("password"))
        port.until("asking for device")
        command = Running("fieldcast", "user", "add", "bob", "--store", path("users.db"))
        ends = time.monotonic() + SECONDS
        while command.core_limit() != ["0", "0"] and time.monotonic() < ends:
            time.sleep(0.01)
        for program in (bridge, port, command):
            with self.subTest(program=program.process.args[0]):
                self.assertEqual(program.core_limit(), ["0", "0"])
                self.assertFalse(program.leaves_a_core())
                for secret in ("a secret of the module 17", "a password of somebody"):
                    self.assertNotIn(secret, program.said)
        module.close()
        listener.close()

    def test_who_looks_for_a_fault_may_have_a_core(self):
        listener = socket.create_server(("127.0.0.1", 0))
        port = Running("fieldcast-port", "--server", f"127.0.0.1:{listener.getsockname()[1]}", "--device", "P1", "--link", path("port"),
                       environment={"FIELDCAST_CORE_DUMPS": "1"})
        port.until("asking for device")
        self.assertNotEqual(port.core_limit(), ["0", "0"])
        port.process.kill()
        port.process.communicate()
        listener.close()


if __name__ == "__main__":
    BIN_DIR = os.path.abspath(sys.argv.pop(1))
    unittest.main(verbosity=1)
