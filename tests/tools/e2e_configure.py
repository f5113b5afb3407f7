"""Tests bridge and fieldcast-station: an engineer reads, checks and changes the configuration of a
running bridge; a bad one returns by itself; nobody else may.

usage: e2e_configure.py BIN_DIR
"""

import base64
import hashlib
import json
import os
import subprocess
import sys
import tempfile
import threading
import time
import unittest

import e2e_station
from e2e_station import Browser, Station
from plant import Plant, modbus_line, wait_until

BIN_DIR = ""
SECONDS = 30
PASSWORD = "correct-horse"
SECRET = "hidden-pass-4711"

CONFIG = """# the comment of an administrator
bridge: e2e
configure: { allow: true }
store: { path: {run}/plant.db }""" + modbus_line() + """\
          - { name: temperature, at: "holding:100", type: float32 }
          - { name: speed, at: "holding:7", type: int16, access: read-write }
"""
ENGINEER = "web: { local-role: engineer }\n"

ROUTES = [("GET", "/api/configuration?bridge=e2e"), ("GET", "/api/configuration/schema"), ("GET", "/api/configuration/templates"),
          ("GET", "/api/configuration/versions?bridge=e2e"), ("GET", "/api/configuration/version?bridge=e2e&version=0"),
          ("POST", "/api/configuration/check"), ("POST", "/api/configuration/deploy"), ("POST", "/api/configuration/confirm"),
          ("POST", "/api/configuration/rollback"), ("POST", "/api/configuration/import"), ("POST", "/api/configuration/probe"),
          ("POST", "/api/configuration/scan")]


def version_of(text):
    return hashlib.sha256(text.encode()).hexdigest()[:16]


class Configure(unittest.TestCase):
    def setUp(self):
        self.plant = self.enterContext(Plant(BIN_DIR, CONFIG))
        self.station = self.enterContext(Station(self.plant, "desk", ENGINEER, "--listen", "127.0.0.1:0"))
        self.browser = Browser(self.station)

    def post(self, operation, **body):
        status, text = self.browser.ask("POST", f"/api/configuration/{operation}", {"bridge": "e2e"} | body)
        return status, json.loads(text)

    def read(self):
        return self.browser.get("/api/configuration?bridge=e2e")

    def file(self):
        with open(self.plant.file, encoding="utf-8") as file:
            return file.read()

    def deploy(self, text, why="a test"):
        return self.post("deploy", base=self.read()["version"], text=text, why=why)

    def versions(self):
        return self.browser.get("/api/configuration/versions?bridge=e2e")

    def channels(self):
        return {row["channel"]: row["quality"] for row in self.browser.get("/api/channels")}

    def test_an_engineer_reads_checks_deploys_and_goes_back(self):
        before = self.read()
        self.assertEqual((before["bridge"], before["path"], before["text"]), ("e2e", self.plant.file, self.file()))
        self.assertEqual((before["version"], before["watch"]), (version_of(self.file()), None))
        lines = before["text"].splitlines()
        kept = {lines[row["line"] - 1].split(":")[0] for row in before["protected"]}
        self.assertEqual(kept, {"bridge", "configure", "store", "dds"})

        status, check = self.post("check", text=before["text"].replace("int16", "int17").replace("address: 1", "adress: 1"))
        self.assertEqual(status, 200)
        self.assertEqual([fault["line"] for fault in check["faults"] if "adress" in fault["message"] or "int17" in fault["message"]],
                         [1 + next(i for i, line in enumerate(lines) if word in line) for word in ("address: 1", "int16")], check)
        self.assertEqual((check["draft"], check["today"][0]["bus"], check["today"][0]["feasible"]), ([], "line", True))

        check = self.post("check", text=before["text"].replace("refresh: 200ms", "refresh: 5ms"))[1]
        self.assertEqual(check["faults"], [])
        self.assertFalse(check["draft"][0]["feasible"])
        self.assertGreater(check["draft"][0]["load"], check["today"][0]["load"])
        self.assertTrue(check["draft"][0]["remedies"])
        self.assertEqual(check["draft"][0]["worst"][0]["refresh_ms"], 5)

        for wrong, status in ((("int16", "int17"), 400), (("configure: { allow: true }", ""), 403), (("/plant.db", "/other.db"), 403),
                              (("address: 1", "address: 1\n        channels-file: /etc/passwd"), 400)):
            self.assertEqual(self.deploy(before["text"].replace(*wrong))[0], status, wrong)
        self.assertEqual(self.file(), before["text"])

        more = before["text"].replace("          - { name: speed", '          # one more\n          - { name: level, at: "input-register:3", type: uint16 }\n'
                                      "          - { name: speed")
        status, deployed = self.deploy(more, "a level")
        self.assertEqual((status, deployed.get("version")), (200, version_of(more)), deployed)
        self.assertEqual(self.file(), more)
        wait_until(lambda: self.channels().get("line/press/level") == "GOOD", SECONDS, self.channels)
        self.assertEqual(self.read()["watch"]["state"], "watching")

        # a second engineer still has the old text
        status, conflict = self.post("deploy", base=before["version"], text=before["text"] + "# mine\n", why="mine")
        self.assertEqual((status, conflict["version"], conflict["text"]), (409, version_of(more), more))
        self.assertEqual(self.post("confirm", version=before["version"])[0], 409)
        self.assertEqual(self.post("confirm", version=deployed["version"])[0], 200)
        self.assertIsNone(self.read()["watch"])
        rows = self.versions()
        self.assertEqual([(row["version"], row["why"]) for row in rows], [(version_of(more), "a level"), (before["version"], "found in the file")])
        self.assertTrue(rows[0]["state"].startswith("confirmed by local"), rows)
        self.assertEqual(self.browser.get(f"/api/configuration/version?bridge=e2e&version={before['version']}")["text"], before["text"])
        self.assertEqual(self.browser.ask("GET", "/api/configuration/version?bridge=e2e&version=../plant")[0], 404)

        self.assertEqual(self.post("rollback", version=before["version"], why="too much")[0], 200)
        self.assertEqual(self.file(), before["text"])
        wait_until(lambda: "line/press/level" not in self.channels(), SECONDS, self.channels)
        audit = lambda: self.plant.cli("audit", "--store", os.path.join(self.plant.run, "plant.db")).out  # written later
        for word in ("deploy", "confirm"):
            wait_until(lambda w=word: f"configuration: {w}" in audit(), SECONDS, audit)

    def test_channels_that_turn_bad_bring_the_old_file_back(self):
        wait_until(lambda: set(self.channels().values()) == {"GOOD"}, SECONDS, self.channels)
        before = self.file()
        status, deployed = self.deploy(before.replace("address: 1", "address: 9"))
        self.assertEqual(status, 200, deployed)
        wait_until(lambda: "GOOD" not in self.channels().values(), SECONDS, self.channels)
        wait_until(lambda: self.file() == before, 60, "the old file did not return")
        wait_until(lambda: set(self.channels().values()) == {"GOOD"}, SECONDS, self.channels)
        row = next(row for row in self.versions() if row["version"] == deployed["version"])
        self.assertIn("rolled back by the bridge", row["state"])
        self.assertIn("line/press/temperature BAD_NO_ANSWER", row["state"])

    def test_a_killed_bridge_leaves_a_whole_file(self):
        texts = [self.file(), self.file() + "# second\n"]
        for delay in (0.0, 0.005, 0.02, 0.05, 0.3):
            wanted = texts[1] if self.file() == texts[0] else texts[0]
            base = self.read()["version"]
            caller = threading.Thread(target=lambda: self.post("deploy", base=base, text=wanted, why="a kill"))
            caller.start()
            time.sleep(delay)
            self.plant.kill_bridge()
            self.assertIn(self.file(), texts)
            caller.join()
            watch = wait_until(lambda: self.browser.ask("GET", "/api/configuration?bridge=e2e")[0] == 200, SECONDS, "no reply") and self.read()["watch"]
            if watch:
                self.assertEqual((watch["version"], self.file()), (version_of(wanted), wanted))
                self.assertEqual(self.post("confirm", version=watch["version"])[0], 200)

    def test_only_an_engineer_may(self):
        store = os.path.join(self.plant.run, "users.db")
        with Station(self.plant, "users", f"store: {{ path: {store} }}\n", "--listen", "127.0.0.1:0") as station:
            for role in ("viewer", "operator"):
                subprocess.run([os.path.join(BIN_DIR, "fieldcast"), "user", "add", role, "--role", role, "--store", store],
                               input=f"{PASSWORD}\n{PASSWORD}\n", text=True, check=True, capture_output=True)
            guest = Browser(station)
            wait_until(lambda: guest.get("/api/me")["login"] == "required", SECONDS, "no login is required")
            for role, expected in (("", 401), ("viewer", 403), ("operator", 403)):
                browser = Browser(station)
                if role:
                    self.assertEqual(browser.log_in(role, PASSWORD), 200)
                for method, path in ROUTES:
                    body = None if method == "GET" else {"bridge": "e2e", "text": "", "base": "", "why": "x", "version": "", "bus": "", "device": "", "protocol": "", "first": "", "last": ""}
                    self.assertEqual(browser.ask(method, path, body)[0], expected, (role, path))
                self.assertEqual(browser.ask("POST", "/api/configuration/check", {"bridge": "e2e", "text": "x" * 100_000})[0], 413)

    def test_what_a_configuration_is_made_of(self):
        schema = self.browser.get("/api/configuration/schema")
        self.assertIn("configure", schema["$defs"]["bridge"]["properties"])
        meter = next(row for row in self.browser.get("/api/configuration/templates") if row["name"] == "eastron-sdm630")
        self.assertEqual((meter["maker"], meter["protocol"]), ("Eastron", "modbus-rtu, modbus-ascii, modbus-tcp"))
        self.assertIn("channels:", meter["text"])
        table = "name,address,type,unit\nvoltage,40001,float32,V\nbroken,abc,float32,V\n"
        status, found = self.post("import", name="meter.csv", content_base64=base64.b64encode(table.encode()).decode())
        self.assertEqual(status, 200, found)
        self.assertIn("voltage", found["text"])
        self.assertEqual([row["to"].split("/")[-1] for row in found["moved"]], ["voltage"], found)
        self.assertIn("broken", found["refusals"][0]["where"])
        self.assertEqual(self.post("import", name="meter.csv", content_base64="*")[0], 400)
        # longer than other requests may be
        status, check = self.post("check", text=self.file() + "# " + "x" * 300_000 + "\n")
        self.assertEqual((status, check["faults"]), (200, []))


METER = """      - name: meter
        address: 7
        channels:
          - { name: energy, at: "holding:300", type: float32, unit: kWh }
          - { name: level, at: "input-register:3", type: uint16 }
"""


class NewDevice(unittest.TestCase):
    """The simulator has the meter, and the bridge has not."""

    def setUp(self):
        self.plant = self.enterContext(Plant(BIN_DIR, CONFIG.replace("refresh: 200ms", "refresh: 500ms, timeout: 100ms") + METER))
        self.station = self.enterContext(Station(self.plant, "desk", ENGINEER, "--listen", "127.0.0.1:0"))
        self.browser = Browser(self.station)
        read = self.browser.get("/api/configuration?bridge=e2e")
        self.text = read["text"].replace(METER, "")
        status, deployed = self.post("deploy", base=read["version"], text=self.text, why="without the meter")
        self.assertEqual(status, 200, deployed)
        wait_until(lambda: [row["channel"] for row in self.browser.get("/api/channels")] == ["line/press/speed", "line/press/temperature"], SECONDS,
                   lambda: self.browser.get("/api/channels"))
        wait_until(lambda: self.post("confirm", version=deployed["version"])[0] == 200, SECONDS, "the version is not confirmed")
        wait_until(lambda: {row["quality"] for row in self.browser.get("/api/channels")} == {"GOOD"}, SECONDS, lambda: self.browser.get("/api/channels"))
        self.draft = self.text.replace("\ndds:", METER + "\ndds:")

    def post(self, operation, **body):
        status, text = self.browser.ask("POST", f"/api/configuration/{operation}", {"bridge": "e2e"} | body)
        return status, json.loads(text)

    def misses(self):
        return self.browser.get("/api/buses")[0]["deadline_misses"]

    def test_first_values_of_a_new_device_cost_no_refresh_and_save_nothing(self):
        before = self.misses()
        for _ in range(5):
            status, found = self.post("probe", bus="line", device="meter", text=self.draft)
            self.assertEqual(status, 200, found)
            self.assertEqual([(row["channel"], row["quality"], row["unit"], row["error"]) for row in found["values"]],
                             [("energy", "GOOD", "kWh", ""), ("level", "GOOD", "", "")])
            self.assertTrue(all(isinstance(row["value"], (int, float)) for row in found["values"]), found)
        silent = self.post("probe", bus="line", device="meter", text=self.draft.replace("address: 7", "address: 9"))[1]
        self.assertEqual({(row["quality"], row["cause"]) for row in silent["values"]}, {("BAD_NO_ANSWER", "NO_ANSWER")}, silent)
        taken = self.post("probe", bus="line", device="meter", text=self.draft.replace("address: 7", "address: 1"))[1]
        self.assertIn("exists already", json.dumps(taken))  # the loader's fault
        time.sleep(2)  # bus reports are sent each second
        self.assertEqual(self.misses(), before)
        self.assertEqual(self.browser.get("/api/configuration?bridge=e2e")["text"], self.text)
        status, wrong = self.post("probe", bus="line", device="meter", text=self.draft.replace("float32, unit", "float33, unit"))
        self.assertEqual((status, len(wrong["faults"])), (400, 1), wrong)
        self.assertEqual(self.post("probe", bus="line", device="other", text=self.draft)[0], 404)
        audit = lambda: self.plant.cli("audit", "--store", os.path.join(self.plant.run, "plant.db")).out
        wait_until(lambda: "of meter on line" in audit(), SECONDS, audit)


    def test_a_scan_finds_the_device_that_is_not_configured(self):
        before, found, part = self.misses(), [], {"next": 1}
        while part["next"] is not None:
            status, part = self.post("scan", bus="line", protocol="modbus-rtu", first=str(part["next"]), last="20")
            self.assertEqual((status, part["error"]), (200, ""), part)
            found += part["found"]
        self.assertEqual([(row["address"], row["responded"], row["identity"], row["templates"]) for row in found],
                         [("7", True, "Fieldcast, simulated device, 1.0", [])], found)
        time.sleep(2)
        self.assertEqual(self.misses(), before)
        self.assertEqual(self.post("scan", bus="line", protocol="dtc", first="1", last="2")[0], 400)


class OtherBridges(unittest.TestCase):
    def test_a_bridge_without_the_key_refuses_and_says_how(self):
        with Plant(BIN_DIR, CONFIG.replace("configure: { allow: true }", f"# password: {SECRET}")) as plant, \
                Station(plant, "desk", ENGINEER, "--listen", "127.0.0.1:0") as station:
            for method, path, body in (("GET", "/api/configuration?bridge=e2e", None),
                                       ("POST", "/api/configuration/deploy", {"bridge": "e2e", "base": "", "text": "", "why": "x"})):
                status, text = Browser(station).ask(method, path, body)
                self.assertEqual(status, 403, text)
                self.assertIn("configure: { allow: true }", text)
                self.assertNotIn(SECRET, text)

    def test_no_reply_contains_a_password(self):
        config = CONFIG.replace("# the comment", f"# password: {SECRET}\n# postgresql://anna:{SECRET}@db.plant/plant\n# the comment")
        with Plant(BIN_DIR, config) as plant, Station(plant, "desk", ENGINEER, "--listen", "127.0.0.1:0") as station:
            browser = Browser(station)
            read = browser.get("/api/configuration?bridge=e2e")
            self.assertNotIn(SECRET, json.dumps(read))
            draft = read["text"] + "# more\n"
            deploy = {"bridge": "e2e", "base": read["version"], "text": draft, "why": "x"}
            replies = [browser.ask("POST", "/api/configuration/check", {"bridge": "e2e", "text": draft}),
                       browser.ask("POST", "/api/configuration/deploy", deploy),
                       browser.ask("POST", "/api/configuration/deploy", deploy),
                       browser.ask("GET", "/api/configuration/versions?bridge=e2e"),
                       browser.ask("GET", f"/api/configuration/version?bridge=e2e&version={read['version']}")]
            self.assertEqual([status for status, _ in replies], [200, 200, 409, 200, 200], replies)
            for _, text in replies:
                self.assertNotIn(SECRET, text)
            with open(plant.file, encoding="utf-8") as file:
                self.assertEqual(file.read().count(SECRET), 2)  # the deployment kept them

    def test_with_security_only_an_identity_of_an_engineer_may(self):
        with tempfile.TemporaryDirectory(prefix="fieldcast-secure-") as folder:
            authority = os.path.join(folder, "plant")
            for words in (["init", authority], ["add", "bridge", "e2e", "--authority", authority], ["add", "engineer", "desk", "--authority", authority],
                          ["add", "plant", "mes", "--authority", authority]):
                subprocess.run([os.path.join(BIN_DIR, "fieldcast"), "secure", *words], check=True, capture_output=True, timeout=SECONDS)
            member = lambda name: os.path.join(authority, "members", name)
            with Plant(BIN_DIR, CONFIG, dds=f", security: {member('e2e')}", joins=["--security", member("mes")]) as plant:
                with Station(plant, "desk", ENGINEER, "--listen", "127.0.0.1:0", "--security", member("desk")) as station:
                    browser = Browser(station)
                    read = browser.get("/api/configuration?bridge=e2e")
                    deploy = {"bridge": "e2e", "base": read["version"], "text": read["text"] + "# more\n", "why": "x"}
                    self.assertEqual(browser.ask("POST", "/api/configuration/deploy", deploy)[0], 200)
                    self.assertEqual(browser.get("/api/configuration/versions?bridge=e2e")[0]["who"], "local (engineer desk)")
                with Station(plant, "mes", ENGINEER, "--listen", "127.0.0.1:0", "--security", member("mes")) as station:
                    status, text = Browser(station).ask("GET", "/api/configuration?bridge=e2e")
                    self.assertEqual(status, 403, text)
                    self.assertIn("fieldcast secure add engineer", text)


if __name__ == "__main__":
    BIN_DIR = e2e_station.BIN_DIR = sys.argv.pop(1)
    unittest.main(verbosity=2)
