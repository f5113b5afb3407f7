"""Tests `fieldcast scan` with the simulated controllers of networks: the link that works is found, and its configuration is valid.

usage: scan_controllers_test.py FIELDCAST FIELDCAST_SIM
"""

import json
import os
import shutil
import subprocess
import sys
import tempfile
import unittest

from peers import Program, free_port

FIELDCAST = SIM = ""
LOGO = {"cpu": "s7-200", "tsap": "02.00", "local-tsap": "03.00"}

# Protocol, address, options, and the beginning of what the controller says of itself.
CONTROLLERS = [
    ("s7-tcp", 1, {}, "CPU 1511-1 PN, 6ES7 511-1AK02-0AB0, V2.9.4, PDU 960 bytes"),
    ("s7-tcp", 2, {}, "CPU 1511-1 PN"),
    ("s7-tcp", 0, LOGO, "CPU 1511-1 PN"),
    ("mitsubishi-mc", 0, {}, "Q03UDECPU"),
    ("mitsubishi-mc", 0, {"code": "ascii"}, "Q03UDECPU"),
    ("omron-fins", 0, {}, "CS1H-CPU67H, 04.00"),
]
CHANNEL = {"s7-tcp": "MW0", "mitsubishi-mc": "D0", "omron-fins": "DM0"}


def bus(number, port, controller):
    protocol, address, options, _ = controller
    written = ", ".join(f'{name}: "{value}"' for name, value in options.items())
    return f"""
  - name: bus-{number}
    port: {{ tcp: "127.0.0.1:{port}" }}
    protocol: {protocol}
    devices:
      - name: plc
        address: {address}
        options: {{ {written} }}
        channels: [ {{ name: level, at: {CHANNEL[protocol]}, type: int16 }} ]"""


def run(*words):
    return subprocess.run([FIELDCAST, *words], capture_output=True, text=True, timeout=60)


class ScanControllers(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp(prefix="fieldcast-scan-")
        self.addCleanup(shutil.rmtree, self.folder)
        self.ports = [free_port() for _ in CONTROLLERS]
        plant = os.path.join(self.folder, "plant.yaml")
        with open(plant, "w", encoding="utf-8") as file:
            file.write("bridge: plant\nbuses:" + "".join(map(bus, range(len(CONTROLLERS)), self.ports, CONTROLLERS)) + "\n")
        program = Program(SIM, plant)
        self.addCleanup(program.__exit__)
        program.wait_ready()

    def test_the_link_of_each_controller_is_found(self):
        for number, (controller, port) in enumerate(zip(CONTROLLERS, self.ports)):
            protocol, address, options, identity = controller
            with self.subTest(controller=controller):
                out = os.path.join(self.folder, f"found-{number}.yaml")
                scan = run("scan", f"127.0.0.1:{port}", "--protocol", protocol, "--json", "--out", out)
                self.assertEqual(scan.returncode, 0, scan.stderr)
                found = [json.loads(line) for line in scan.stdout.splitlines()]
                self.assertEqual([(each["address"], each.get("options", {}), each["answer"]) for each in found], [(address, options, "value")])
                self.assertTrue(found[0]["identity"].startswith(identity), found[0]["identity"])
                plan = run("plan", out)
                self.assertEqual(plan.returncode, 0, plan.stderr)

    def test_what_was_tried_is_listed_if_nothing_responds(self):
        scan = run("scan", f"127.0.0.1:{self.ports[-1]}", "--protocol", "s7-tcp")
        self.assertEqual(scan.returncode, 4, scan.stdout + scan.stderr)
        self.assertEqual(scan.stderr.count("  tried: s7-tcp"), 9, scan.stderr)

    def test_ports_that_a_scan_cannot_search_are_named(self):
        for form in ("tls:", "rfc2217:"):
            scan = run("scan", form + "127.0.0.1:802")
            self.assertEqual(scan.returncode, 2, scan.stderr)
            self.assertIn(f"'fieldcast read' accepts {form}HOST:PORT", scan.stderr)


if __name__ == "__main__":
    FIELDCAST, SIM = sys.argv[1:]
    unittest.main(argv=sys.argv[:1], verbosity=2)
