"""Compares the lists in documents with the program (metrics, causes, exit codes, alerts) and
checks every link.

usage: reference_test.py SOURCE_DIR DOCUMENT..
"""

import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
from xml.etree import ElementTree

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from document import parse
from links import anchors, dead_links

SOURCE_DIR, DOCUMENTS = "", []


def read(path):
    with open(os.path.join(SOURCE_DIR, path), encoding="utf-8") as file:
        return file.read()


def first_cells(text):
    cells = [row.split("|")[1].strip(" `") for row in text.splitlines() if row.startswith("| ")]
    return [cell for cell in cells[1:] if set(cell) != {"-"}]


def section(path, heading):
    text = read(path)
    match = re.search(rf"^(#+) {re.escape(heading)}$", text, re.MULTILINE)
    rest = text[match.end():]
    end = re.search(rf"^#{{1,{len(match.group(1))}}} ", rest, re.MULTILINE)
    return rest[:end.start()] if end else rest


class Metrics(unittest.TestCase):
    def test_are_those_of_the_source(self):
        source = re.findall(r'"(fieldcast_\w+)", Kind::k(\w+)', read("bridge/metrics/metrics_text.cpp"))
        served = {name + ("_total" if kind == "Counter" else "") for name, kind in source}
        self.assertGreater(len(served), 30)
        listed = first_cells(section("docs/operating.md", "Every metric"))
        self.assertEqual(len(listed), len(set(listed)), "one is listed twice")
        self.assertEqual(set(listed) ^ served, set())

    def test_of_alerts_are_served(self):
        listed = set(first_cells(section("docs/operating.md", "Every metric")))
        rules = read("config/grafana/alerts.yml")
        used = set(re.findall(r"fieldcast_\w+", rules))
        self.assertGreater(len(used), 5)
        self.assertEqual(used - listed, set())
        self.assertEqual(re.findall(r"alert: (\w+)", rules), first_cells(section("docs/operating.md", "Alerts worth having")))

    def test_of_prometheus_its_own_tool_takes_both_files(self):
        promtool = shutil.which("promtool", path=os.environ["PATH"] + f":{SOURCE_DIR}/build/unpacked/prometheus/usr/bin")
        if not promtool:
            self.skipTest("no promtool here; tools/install.sh ci brings it")
        block, = [one for one in parse("operating", read("docs/operating.md")) if one.markers.get("file") == "prometheus.yml"]
        with tempfile.NamedTemporaryFile("w", suffix=".yml") as file:
            file.write(block.text)
            file.flush()
            for arguments in (["rules", os.path.join(SOURCE_DIR, "config/grafana/alerts.yml")], ["config", "--syntax-only", file.name]):
                done = subprocess.run([promtool, "check", *arguments], capture_output=True, text=True)
                self.assertEqual(done.returncode, 0, done.stdout + done.stderr)


class Causes(unittest.TestCase):
    def test_stand_beside_their_quality(self):
        rows = re.findall(r'\{"([A-Z_]+)", "[^"]*",\s*Quality::k(\w+)\}', read("core/base/cause.cpp"))
        self.assertGreater(len(rows), 25)
        page = section("docs/qualities.md", "The table")
        lines = {row.split("|")[1].strip(" `"): row for row in page.splitlines() if row.startswith("| `")}
        names = dict(re.findall(r"case Quality::k(\w+): return idl::Quality::([A-Z_]+);", read("bridge/dds/topics/conversion_enums.cpp")))
        for cause, quality in rows:
            name = names[quality]
            if cause != "NONE" and f"`{cause}`" not in lines[name]:
                self.assertIn(f"`{cause}`", page.split("Six more causes")[1], f"{cause} is {name}")

    def test_every_quality_of_the_idl_is_explained(self):
        members = re.search(r"enum Quality \{(.*?)\}", read("idl/fieldcast.idl"), re.DOTALL).group(1)
        self.assertEqual([name.strip() for name in members.split(",")], first_cells(section("docs/qualities.md", "The table")))


class ExitCodes(unittest.TestCase):
    def test_are_those_of_the_sources(self):
        page = section("docs/operating.md", "Exit codes")
        tables = [re.findall(r"^\| (\d+) \|", table, re.MULTILINE) for table in page.split("`fieldcast`:")]
        for header, listed in zip(["bridge/base/exit_code.hpp", "tools/cli/text/output.hpp"], tables):
            self.assertEqual(re.findall(r"\bk\w+ = (\d+)", read(header)), listed, header)


class Commands(unittest.TestCase):
    def test_each_has_one_row_and_is_shown_on_a_page(self):
        rows, pages = [], ""
        for path, _, names in os.walk(os.path.join(SOURCE_DIR, "tools/cli/command")):
            for name in names:
                text = read(os.path.relpath(os.path.join(path, name), SOURCE_DIR))
                rows += re.findall(r'\bcommand_row\(\s*"([\w-]+)"', text)
        registered = re.findall(r"(\w+)_command\(\)", read("tools/cli/command/registry.cpp").split("std::array")[1])
        self.assertGreater(len(rows), 20)
        self.assertEqual(sorted(rows), sorted(name.replace("_", "-") for name in registered))
        for path, _, names in os.walk(os.path.join(SOURCE_DIR, "docs")):
            for name in names:
                pages += read(os.path.relpath(os.path.join(path, name), SOURCE_DIR)) if name.endswith(".md") else ""
        self.assertEqual([name for name in rows if f"fieldcast {name}" not in pages], [])


class Picture(unittest.TestCase):
    def test_shows_the_columns_of_watch(self):
        table = re.search(r"TextTable table\((.*?)\);", read("tools/cli/view/station_view.cpp").split(" watch_lines(")[1], re.DOTALL).group(1)
        heads = re.findall(r'"(\w+)"', table)
        self.assertEqual(len(heads), 7)
        rows = {}
        for text in ElementTree.fromstring(read("docs/images/watch.svg")).iter("{http://www.w3.org/2000/svg}text"):
            rows.setdefault(text.get("y"), []).append((float(text.get("x")), text.text))
        # In the picture, heads separated by one space are one text.
        words = [" ".join(text for _, text in sorted(row)).split() for row in rows.values()]
        self.assertIn(heads, words, "tools/screen.py draws it again")


class Stations(unittest.TestCase):
    def test_every_topic_is_listed(self):
        topics = set(re.findall(r'"(fieldcast/\w+)"', read("bridge/dds/topics/topics.hpp")))
        self.assertGreater(len(topics), 10)
        listed = section("docs/stations.md", "Topics")
        self.assertEqual(set(re.findall(r"`(fieldcast/\w+)`", listed)), topics)

    def test_the_qos_of_a_topic_is_that_of_its_profile(self):
        # A test in C++ compares the profiles with the topics of the bridge.
        space = "{http://www.eprosima.com/XMLSchemas/fastRTPS_Profiles}"
        root = ElementTree.fromstring(read("bridge/dds/profiles/fieldcast-station.xml"))
        profiles = {each.get("profile_name"): each for kind in ("data_reader", "data_writer") for each in root.iter(space + kind)}
        texts = [row.split("|")[1:4:2] for row in section("docs/stations.md", "Topics").splitlines() if row.startswith("| `")]
        texts += [line.split(": ", 1) for line in re.findall(r"// ---- (fieldcast/.*: reliable.*)", read("idl/fieldcast.idl"))]
        compared = set()
        for names, qos in texts:
            for name in re.findall(r"fieldcast/\w+", names):
                if name not in profiles or "as `Command`" in qos:
                    continue  # between bridges, or the QoS of another row
                kinds = {each.tag.removeprefix(space): each.find(space + "kind").text
                         for each in profiles[name].iter() if each.find(space + "kind") is not None}
                self.assertIn(kinds["reliability"].lower() + ", " + kinds["durability"].lower().replace("_", "-"), qos, name)
                for history in re.findall(r"keep (?:all|last \d+)", qos):
                    self.assertEqual(history.split()[1].upper(), kinds["historyQos"].split("_")[1], name)
                    if kinds["durability"] == "TRANSIENT_LOCAL":
                        depth = profiles[name].find(f"{space}topic/{space}historyQos/{space}depth").text
                        self.assertEqual(history, f"keep last {depth}", name)
                compared.add(name)
        self.assertEqual(compared | {"fieldcast/AlarmAction"}, set(profiles))

    def test_every_quality_and_every_state_of_a_command_is_explained(self):
        for name, heading in [("Quality", "Quality"), ("CommandState", "Commands and their results")]:
            members = re.search(rf"enum {name} \{{(.*?)\}}", read("idl/fieldcast.idl"), re.DOTALL).group(1)
            self.assertEqual([member.strip() for member in members.split(",")], first_cells(section("docs/stations.md", heading)))


class Protocols(unittest.TestCase):
    def test_each_has_a_page_with_every_form_of_its_addresses(self):
        index, found = read("docs/protocols.md"), 0
        for path, _, names in os.walk(os.path.join(SOURCE_DIR, "core", "protocol")):
            for name in (name for name in names if name.endswith(".cpp")):
                text = read(os.path.relpath(os.path.join(path, name), SOURCE_DIR))
                examples = re.findall(r'"([^"]+)"', " ".join(re.findall(r"Addresses\[\] = \{(.*?)\};", text, re.DOTALL)))
                for protocol in re.findall(r'\.name = "([\w-]+)",\s*\.summary', text):
                    found += 1
                    row = next((line for line in index.splitlines() if line.startswith("|") and f"`{protocol}`" in line), None)
                    self.assertIsNotNone(row, f"{protocol} is missing in docs/protocols.md")
                    page = read(os.path.join("docs", re.search(r"\((protocols/.*?\.md)\)", row).group(1)))
                    words = re.findall(r"`([^`]+)`", re.sub(r"```.*?```", "", page, flags=re.DOTALL))
                    forms = {self.form(at) for at in words}
                    with self.subTest(protocol):
                        self.assertEqual({self.form(at) for at in examples} - forms, set())
        self.assertGreaterEqual(found, 8)

    @staticmethod
    def form(at):
        """Returns the address without numbers and base: "VW100" and "VW7" are equal."""
        return re.sub(r"\d+", "0", re.sub(r"0[xX][0-9A-Fa-f]+", "0", at))


class Devices(unittest.TestCase):
    def test_are_those_of_the_folder(self):
        listed = re.findall(r"^\| (.+?) \| \[`([\w-]+)`\]\(\.\./config/devices/([\w-]+)\.yaml\) \| (\w+) \| (\d+) \| (.+?) \|$",
                            section("docs/devices.md", "The list"), re.MULTILINE)
        folder = {name.removesuffix(".yaml") for name in os.listdir(os.path.join(SOURCE_DIR, "config", "devices"))}
        self.assertEqual(sorted(row[1] for row in listed), sorted(folder - {"press", "energy-meter", "drive"}))
        for device, template, file, protocol, channels, source in listed:
            with self.subTest(template):
                text = read(f"config/devices/{file}.yaml")
                head = re.sub(r"\s*\n#\s+", " ", text)
                self.assertEqual((template, int(channels)), (file, len(re.findall(r"^  - ", text, re.MULTILINE))))
                self.assertIn(f"Device:   {device}", head)
                self.assertIn(f"Source:   {source}", head)
                self.assertIn(protocol.lower(), re.search(r"^protocols: (.+)$", text, re.MULTILINE)[1])

    def test_of_a_head_every_line_is_explained(self):
        keys = re.findall(r"^# (\w+): ", read("config/devices/pzem-016.yaml"), re.MULTILINE)
        self.assertEqual(first_cells(section("docs/devices.md", "Another device")), keys)


class ProgramPort(unittest.TestCase):
    def test_its_exit_codes_are_those_that_it_documents(self):
        said = re.sub(r'"\s*"', "", read("tools/program-port/connection.cpp"))
        said = re.search(r"Exit codes: (.*?)\.", said, re.DOTALL).group(1)
        self.assertEqual(re.findall(r"\b(\d) ", said), first_cells(section("docs/programming.md", "Refusals")))


class Links(unittest.TestCase):
    def test_lead_somewhere(self):
        self.assertEqual([dead for path in DOCUMENTS for dead in dead_links(SOURCE_DIR, path)], [])

    def test_a_dead_one_is_found(self):
        self.assertEqual(anchors(read("docs/qualities.md")) & {"the-table", "no-such"}, {"the-table"})


if __name__ == "__main__":
    SOURCE_DIR, DOCUMENTS = sys.argv[1], sys.argv[2:]
    unittest.main(argv=sys.argv[:1], verbosity=2)
