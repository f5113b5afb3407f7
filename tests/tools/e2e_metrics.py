"""Tests that the metrics match the bridge's reports, in both formats, also after a reload.

usage: e2e_metrics.py BIN_DIR SOURCE_DIR UNPACKED_DIR

promtool (package prometheus, installed or in UNPACKED_DIR) and Prometheus' own parser
(python3-prometheus-client) also check the text; `tools/install.sh ci` provides both.
"""

import json
import os
import re
import shutil
import signal
import socket
import subprocess
import sys
import unittest
import urllib.error
import urllib.request

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "interop"))

from peers import free_port
from plant import Plant, modbus_line, run_cli, wait_until

try:
    from prometheus_client.openmetrics.parser import text_string_to_metric_families
except ImportError:
    text_string_to_metric_families = None

BIN_DIR = SOURCE_DIR = UNPACKED_DIR = ""
SECONDS = 30
OPEN_METRICS = "application/openmetrics-text; version=1.0.0"

CONFIG = """
bridge: e2e
store: { path: {run}/plant.db }
metrics: { listen: 127.0.0.1:{port} }""" + modbus_line() + """\
          - { name: temperature, at: "holding:100", type: float32 }
          - { name: level, at: "input-register:3", type: uint16 }
      - { name: mill, address: 2, channels: [ { name: speed, at: "holding:7", type: int16 } ] }
"""


port = free_port()
plant = None


def setUpModule():
    global plant
    plant = unittest.enterModuleContext(Plant(BIN_DIR, CONFIG.replace("{port}", str(port))))


def scrape(accept=OPEN_METRICS, at=None):
    request = urllib.request.Request(f"http://127.0.0.1:{at or port}/metrics", headers={"Accept": accept})
    with urllib.request.urlopen(request, timeout=SECONDS) as response:
        return response.read().decode(), response.headers["Content-Type"]


def serves(at=None):
    try:
        return scrape(at=at)
    except OSError:
        return None


NAME = r"[a-z_]+"
LABELS = r'(?:\{(' + NAME + r'="(?:[^"\\\n]|\\["\\n])*"(?:,' + NAME + r'="(?:[^"\\\n]|\\["\\n])*")*)\})?'
SAMPLE = re.compile(rf"({NAME}){LABELS} (\S+)")


def series(text, total="_total"):
    """Returns {(name, labels): value}; AssertionError with the rule that a line violates."""
    lines = text.split("\n")
    assert lines[-2:] == ["# EOF", ""], "the last line is # EOF"
    found, kinds, family = {}, {}, None
    for line in lines[:-2]:
        if line.startswith("# "):
            _, keyword, name, rest = line.split(" ", 3)
            if keyword == "HELP":
                assert name not in kinds, f"{name} is described twice"
                family, kinds[name] = name, None
            assert name == family, f"{line!r} stands among those of {family}"
            if keyword == "TYPE":
                assert rest in ("counter", "gauge"), line
                kinds[name] = rest
            if keyword == "UNIT":
                assert name.endswith("_" + rest), f"{name} does not end in its unit {rest}"
            continue
        match = SAMPLE.fullmatch(line)
        assert match, f"{line!r} is no sample"
        name, labels, value = match.groups()
        assert name == family + (total if kinds[family] == "counter" else ""), f"{line!r} stands among those of {family}"
        assert (name, labels) not in found, f"{line!r} stands there twice"
        found[name, labels] = float(value)
        assert kinds[family] != "counter" or found[name, labels] >= 0, line
    return found


def value(name, labels='bus="line"', at=None):
    return series(scrape(at=at)[0]).get((name, labels))


class Text(unittest.TestCase):
    def test_follows_the_rules_of_open_metrics(self):
        text, kind = scrape()
        self.assertIn("application/openmetrics-text", kind)
        self.assertGreater(len(series(text)), 60)
        if text_string_to_metric_families:
            self.assertGreater(len(list(text_string_to_metric_families(text))), 30)

    def test_each_name_stands_in_the_documents(self):
        with open(os.path.join(SOURCE_DIR, "docs/operating.md"), encoding="utf-8") as file:
            listed = set(re.findall(r"^\| `(fieldcast_\w+)` \|", file.read(), re.MULTILINE))
        served = {name for name, _ in series(scrape()[0])}
        self.assertGreater(len(served), 30)
        self.assertEqual(served - listed, set())

    def test_the_older_format_pleases_promtool(self):
        text, kind = scrape(accept="text/plain")
        self.assertIn("version=0.0.4", kind)
        self.assertNotIn("EOF", text)
        promtool = shutil.which("promtool", path=os.environ["PATH"] + f":{UNPACKED_DIR}/prometheus/usr/bin")
        if not promtool:
            self.skipTest("no promtool here; tools/install.sh ci brings it")
        done = subprocess.run([promtool, "check", "metrics"], input=text, capture_output=True, text=True, timeout=SECONDS)
        self.assertEqual((done.returncode, done.stdout + done.stderr), (0, ""))

    def test_a_break_of_the_rules_is_found(self):
        good = "# HELP a_seconds x\n# TYPE a_seconds gauge\n# UNIT a_seconds seconds\na_seconds 1\n# EOF\n"
        self.assertEqual(series(good), {("a_seconds", None): 1})
        for bad in (good.replace("# EOF\n", ""), good.replace("a_seconds 1", "b_seconds 1"), good.replace("UNIT a_seconds seconds", "UNIT a_seconds bytes"),
                    good.replace("gauge", "counter"), good.replace("a_seconds 1\n", "a_seconds 1\na_seconds 2\n"),
                    good.replace("a_seconds 1", 'a_seconds{a="b"c"} 1')):
            with self.assertRaises(AssertionError, msg=bad):
                series(bad)


class Dashboard(unittest.TestCase):
    def test_shows_metrics_that_there_are(self):
        with open(os.path.join(SOURCE_DIR, "bridge/metrics/metrics_text.cpp"), encoding="utf-8") as file:
            known = set(re.findall(r'"(fieldcast_\w+)"', file.read()))
        with open(os.path.join(SOURCE_DIR, "config/grafana/metrics.json"), encoding="utf-8") as file:
            dashboard = json.load(file)
        text = " ".join(target["expr"] for panel in dashboard["panels"] for target in panel["targets"])
        shown = {name.removesuffix("_total") for name in re.findall(r"fieldcast_\w+", text)}
        self.assertGreater(len(shown), 10)
        self.assertLessEqual(shown, known)


class Figures(unittest.TestCase):
    def test_are_those_of_the_status(self):
        wait_until(lambda: value("fieldcast_device_state", 'bus="line",device="press",state="online"') == 1, SECONDS, "press is not online")
        figures = series(scrape()[0])
        status = {(line["topic"], line.get("device")): line for line in plant.cli("status", "--json").json_lines()}
        bus, press = status["BusStatus", None], status["DeviceStatus", "press"]
        self.assertLessEqual(figures["fieldcast_bus_samples_total", 'bus="line"'], bus["samples"])
        self.assertLessEqual(figures["fieldcast_device_exchanges_total", 'bus="line",device="press"'], press["exchanges"])
        self.assertEqual(figures["fieldcast_bus_state", 'bus="line",state="running"'], 1)
        self.assertGreater(figures["fieldcast_bus_sent_bytes_total", 'bus="line"'], 0)
        self.assertGreater(figures["fieldcast_dds_sample_writers", 'bus="line"'], 0)
        self.assertIn(("fieldcast_store_samples_total", None), figures)
        self.assertIn(("fieldcast_device_state", 'bus="line",device="mill",state="online"'), figures)

    def test_grow(self):
        before = value("fieldcast_bus_samples_total")
        wait_until(lambda: value("fieldcast_bus_samples_total") > before, SECONDS, f"the samples stay {before}")


class Health(unittest.TestCase):
    def test_a_bridge_is_healthy_while_it_runs(self):
        healthy = run_cli(BIN_DIR, "health", f"http://127.0.0.1:{port}/healthz")
        self.assertEqual(healthy.code, 0, str(healthy))

    def test_is_bad_without_a_bridge_and_for_another_path(self):
        for url, words in ((f"http://127.0.0.1:{free_port()}/healthz", "connect timeout"), (f"http://127.0.0.1:{port}/health", "404|there are GET")):
            bad = run_cli(BIN_DIR, "health", url, "--timeout", "1")
            self.assertEqual(bad.code, 1, str(bad))
            self.assertRegex(bad.err, words)


class Clients(unittest.TestCase):
    def test_other_paths_and_methods_are_refused(self):
        for path, method, code in (("/", "GET", 404), ("/metrics", "POST", 405)):
            request = urllib.request.Request(f"http://127.0.0.1:{port}{path}", method=method, data=b"x" if method == "POST" else None)
            with self.assertRaises(urllib.error.HTTPError) as refused:
                urllib.request.urlopen(request, timeout=SECONDS)
            self.assertEqual(refused.exception.code, code)
            refused.exception.close()

    def test_those_that_say_nothing_or_never_read_stop_nobody(self):
        clients = [socket.create_connection(("127.0.0.1", port)) for _ in range(20)]
        for client in clients[::2]:
            # does not read the responses
            client.sendall(b"GET /metrics HTTP/1.1\r\nHost: h\r\n\r\n" * 50)
        before = value("fieldcast_bus_samples_total")
        wait_until(lambda: value("fieldcast_bus_samples_total") > before, SECONDS, "the bus stands still")
        for client in clients:
            client.close()


class Reload(unittest.TestCase):
    def reload(self, old, new):
        with open(plant.file, encoding="utf-8") as file:
            text = file.read()
        self.assertIn(old, text)
        with open(plant.file, "w", encoding="utf-8") as file:
            file.write(text.replace(old, new))
        plant.bridge.send_signal(signal.SIGHUP)

    def test_moves_the_server_and_leaves_the_buses_alone(self):
        exchanges, other = value("fieldcast_bus_exchanges_total"), free_port()
        here, there = f"127.0.0.1:{port}", f"127.0.0.1:{other}"
        with socket.create_server(("127.0.0.1", other)) as taken:
            self.reload(here, there)
            said = f"cannot listen at {there}: Address already in use: they are not served, the buses run"
            wait_until(lambda: said in plant.log("fieldcast-bridge"), SECONDS, lambda: plant.log("fieldcast-bridge"))
            self.assertIsNone(serves())
            taken.close()
        wait_until(lambda: serves(other), SECONDS, lambda: plant.log("fieldcast-bridge"))
        self.assertGreaterEqual(value("fieldcast_bus_exchanges_total", at=other), exchanges, "the bus did not start anew")
        self.reload(there, here)
        wait_until(serves, SECONDS, lambda: plant.log("fieldcast-bridge"))
        self.assertIsNone(serves(other))


if __name__ == "__main__":
    BIN_DIR, SOURCE_DIR, UNPACKED_DIR = sys.argv[1:4]
    unittest.main(argv=sys.argv[:1], verbosity=2)
