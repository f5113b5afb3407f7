"""Tests that forged BusStatus and DeviceStatus messages change only their texts, which every output escapes.

usage: forged_status.py BIN_DIR [NODE NODE_MODULES BROWSER_MJS]

With the last three arguments and with chromium, the page is also checked.
"""

import json
import os
import re
import shutil
import subprocess
import sys
import urllib.request

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "interop"))
import e2e_station  # noqa: E402
from peers import free_port  # noqa: E402
from plant import Plant, modbus_line, wait_until  # noqa: E402

BUS = "line"
TEXTS = [
    b'"},"state":"stopped', b'","state":"stopped","x":"', b"<script>forged=1</script>", b"<img src=x onerror=forged=1>",
    b"x\n[error] forged line", b"\x1b[2Jforged\x07", "turned\u202edegrof".encode(), "\u2066isolated\u2029".encode(), b"bad \xff utf-8 \xc3",
    b"{{forged}}%s%n", b"__proto__", b"constructor", b"a\\",
    b"y" * 255,
]
# The IDL allows 32 bytes of a cause and 64 of a name; longer texts are cut.
CAUSES, DEVICES = ([text[:limit].decode("utf-8", "replace") for text in TEXTS] for limit in (32, 64))
CONFIG = """bridge: honest
metrics: { listen: 127.0.0.1:{port} }""" + modbus_line(device="plc", defaults="refresh: 100ms") + """\
          - { name: level, at: "holding:0", type: uint16 }
"""
# Controls except the end of a line, ends of paragraphs, and marks that change the writing direction.
UNPRINTABLE = re.compile("[\x00-\x09\x0b-\x1f\x7f-\x9f\u061c\u200b-\u200f\u2028-\u202e\u2060-\u206f\ufeff]")


class Outputs:
    """The checks of each output, and the faults found."""

    def __init__(self):
        self.faults = []

    def check(self, good, what):
        if not good:
            self.faults.append(what)

    def text(self, where, data):
        """Returns bytes as UTF-8; a control character in them is a fault."""
        try:
            text = data.decode()
        except UnicodeDecodeError as error:
            self.faults.append(f"{where}: {error}")
            return ""
        found = UNPRINTABLE.search(text)
        self.check(not found, f"{where}: {found and text[max(0, found.start() - 40):found.end() + 40]!r}")
        self.check(not re.search(r"^\[error\] forged", text, re.MULTILINE), f"{where}: a forged line")
        self.check("y" * 65 not in text, f"{where}: a text above its bound")
        return text

    def status(self, where, buses, devices):
        """Checks the objects of the bus and its devices: the honest facts, and the forged texts as names."""
        bus = next((bus for bus in buses if bus["bus"] == BUS), {})
        self.check(bus.get("state") == "running" and len(buses) == 1, f"{where}: the bus is {bus.get('state')}, of {len(buses)}")
        forged = {device["device"]: device for device in devices if device["device"] != "plc"}
        self.check(sorted(forged) == sorted(DEVICES), f"{where}: the devices are {sorted(forged)}")
        for device in forged.values():
            self.check(device["state"] == "online" and device["causes"] == dict.fromkeys(CAUSES, 7), f"{where}: {device}")
        honest = [device for device in devices if device["device"] == "plc"]
        # On a busy machine the real device may respond late, which is a fact and no forgery.
        self.check(len(honest) == 1 and honest[0]["state"] in ("online", "degraded"), f"{where}: {honest}")
        self.check(len(honest) == 1 and not set(honest[0]["causes"]) & set(CAUSES), f"{where}: {honest}")


def check_command_line(plant, outputs):
    for _ in range(5):  # honest and forged statuses of the bus alternate
        for arguments in ([], ["--plain"], ["--json"]):
            command = [os.path.join(plant.bin_dir, "fieldcast"), "status", *arguments, "--config", plant.file]
            shown = subprocess.run(command, capture_output=True, timeout=60)
            where = "fieldcast status " + " ".join(arguments)
            outputs.check(shown.returncode == 0, f"{where}: {shown}")
            text = outputs.text(where, shown.stdout + shown.stderr)
            if "--json" in arguments:
                lines = [json.loads(line) for line in text.splitlines()]
                outputs.status(where, *([line for line in lines if line["topic"] == topic] for topic in ("BusStatus", "DeviceStatus")))
            else:
                outputs.check(not re.search(r"\bstate +stopped", text), f"{where}: {text}")


def check_station(station, outputs):
    browser = e2e_station.Browser(station)
    live = e2e_station.Socket(browser)
    online = dict.fromkeys([*DEVICES, "plc"], "online")
    wait_until(lambda: {device["device"]: device["state"] for device in browser.get("/api/devices")} == online, 30,
               lambda: browser.ask("GET", "/api/devices"))
    for _ in range(10):
        buses, devices = (browser.ask("GET", path)[1] for path in ("/api/buses", "/api/devices"))
        outputs.text("/api", (buses + "\n" + devices).encode())
        outputs.status("/api", json.loads(buses), json.loads(devices))
    forged = live.until(lambda message: isinstance(message, dict) and message.get("kind") == "bus" and CAUSES[0] in message["causes"])
    outputs.check(forged["state"] == "running" and forged["causes"] == dict.fromkeys(CAUSES, 7), f"/live: {forged}")
    live.socket.close()


def check_page(station, outputs, node, modules, browser_mjs):
    if not shutil.which("chromium"):
        print("chromium is not installed: the page is not checked")
        return
    # The page may show unprintable characters in its own way, so only texts without them are compared.
    plain = [text for text in DEVICES if not UNPRINTABLE.search(text) and "\n" not in text]
    script = os.path.join(os.path.dirname(os.path.abspath(__file__)), "forged_status.mjs")
    looked = subprocess.run([node, script, station.origin, modules, browser_mjs, BUS, json.dumps(plain)], capture_output=True, text=True, timeout=120)
    outputs.check(looked.returncode == 0, "the page: " + looked.stdout + looked.stderr)


def main(bin_dir, *page):
    outputs = Outputs()
    e2e_station.BIN_DIR = bin_dir
    port = free_port()
    with Plant(bin_dir, CONFIG.replace("{port}", str(port))) as plant:
        forger = subprocess.Popen([os.path.join(bin_dir, "forge-status"), str(plant.domain), BUS, *TEXTS], stdin=subprocess.DEVNULL)
        try:
            with e2e_station.Station(plant, "station", "web: { local-role: viewer }\n", "--listen", "127.0.0.1:0") as station:
                check_station(station, outputs)
                check_command_line(plant, outputs)
                if page:
                    check_page(station, outputs, *page)
                metrics = urllib.request.urlopen(f"http://127.0.0.1:{port}/metrics", timeout=10).read()
                outputs.check(b"forged" not in outputs.text("metrics", metrics).encode(), "metrics: a forged text")
                outputs.text("the log of the station", open(station.log_path, "rb").read())
            if forger.poll() is not None:
                outputs.faults.append(f"forge-status ended with {forger.returncode}")
        finally:
            forger.kill()
            forger.wait()
        outputs.text("the log of the bridge", open(os.path.join(plant.run, "fieldcast-bridge.log"), "rb").read())
    print("\n".join(dict.fromkeys(outputs.faults)) or f"{len(TEXTS)} texts: no harm")
    return 1 if outputs.faults else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
