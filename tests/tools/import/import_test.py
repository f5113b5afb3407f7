"""Tests `fieldcast import` end to end: lists of real devices in the format of each program, read
from devices with these registers; and user errors.

usage: import_test.py BIN_DIR SOURCE_DIR

The lists in lists/ were written for this test. lists/values.txt has the registers of the devices
and every expected value.
"""

import json
import os
import re
import shutil
import subprocess
import sys
import unittest
import zipfile

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [os.path.join(HERE, "..", "..", "config", "devices"), os.path.join(HERE, "..")]
from modbus_devices import Devices, read_examples
from plant import InAFolder, claim_domain, running_bridge, wait_until

BIN_DIR, SOURCE_DIR = "", ""
LISTS = os.path.join(HERE, "lists")
MAKERS = os.path.join(LISTS, "makers")
SECONDS = 30


def run(program, *arguments, **keywords):
    return subprocess.run([os.path.join(BIN_DIR, program), *arguments], capture_output=True, text=True, timeout=2 * SECONDS,
                          **keywords)


class Imports(InAFolder):
    def fault(self, *arguments, code=2):
        done = run("fieldcast", "import", *arguments)
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        return done.stderr

    LIST = "Address,Name,Type\n0,power,U16\n1,wrong,complex\n"


def excel(path, table):
    """Writes a minimal workbook with shared texts. The second row of the sheet is empty."""
    texts = sorted({cell for row in table for cell in row if not re.fullmatch(r"[\d.]*", cell)})

    def cell(column, row, text):
        at = f'r="{chr(65 + column)}{row}"'
        if text in texts:
            return f'<c {at} t="s"><v>{texts.index(text)}</v></c>'
        return f"<c {at}><v>{text}</v></c>" if text else ""

    def line(index, cells):
        number = index + 1 if index == 0 else index + 2
        return f'<row r="{number}">' + "".join(cell(i, number, text) for i, text in enumerate(cells)) + "</row>"

    sheet = "".join(line(index, cells) for index, cells in enumerate(table))
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as book:
        book.writestr("xl/worksheets/sheet1.xml", f'<?xml version="1.0"?><worksheet><sheetData>{sheet}</sheetData></worksheet>')
        book.writestr("xl/sharedStrings.xml", "<sst>" + "".join(f"<si><t>{text}</t></si>" for text in texts) + "</sst>")


class RealDevices(Imports):
    def lists(self, port):
        files = []
        for name in sorted(os.listdir(LISTS)):
            if name in ("values.txt", "makers"):
                continue
            shutil.copy(os.path.join(LISTS, name), self.path(name))
            files.append(self.path(name))
            with open(self.path(name), "rb") as file:
                data = file.read()
            for old, new in [(b"127.0.0.1:502", b"127.0.0.1:%d"), (b"port: 502", b"port: %d"), (b'"port": 502', b'"port": %d')]:
                data = data.replace(old, new % port)
            with open(self.path(name), "wb") as file:
                file.write(data)
        with open(os.path.join(LISTS, "neuron-gx.csv"), encoding="utf-8") as file:
            excel(self.path("neuron-gx.xlsx"), [line.split(",") for line in file.read().splitlines()])
        files[files.index(self.path("neuron-gx.csv"))] = self.path("neuron-gx.xlsx")
        return files

    def test_of_every_format_are_imported_and_read_right(self):
        values = read_examples(os.path.join(LISTS, "values.txt"))
        memory = {}
        with Devices(memory) as devices:
            config = self.path("all.yaml")
            done = run("fieldcast", "import", *self.lists(devices.port), "--port", f"127.0.0.1:{devices.port}",
                       "--refresh", "500ms", "--out", config, "--json")
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
            rows = [json.loads(line) for line in done.stdout.splitlines()]
            self.assertLess({"scale": 0.001, "word_order": "big-endian", "access": "read-only"}.items(),
                            next(row for row in rows if row["name"] == "Wirkleistung gesamt").items())
            self.assertEqual([row for row in rows if row["fate"] == "refused"], [])
            # the script has no values of its own
            self.assertEqual(len({row["file"] for row in rows}), 13)
            channels = {tuple(row["channel"].split("/")[1:]) for row in rows}
            with open(config, encoding="utf-8") as file:
                text = file.read()
            units = {name: int(unit) for name, unit in re.findall(r"- name: (\S+)\n +address: (\d+)", text)}
            self.assertEqual(units.keys() ^ values.keys(), set())
            expected = {}
            for device, examples in values.items():
                for function, first, items, meant in examples:
                    memory.update({(units[device], function, first + i): item for i, item in enumerate(items)})
                    expected.update({(device, channel): value for channel, value in meant.items()})
            self.assertEqual(expected.keys(), channels)
            domain, claim = claim_domain()
            self.addCleanup(claim.close)
            self.file("all.yaml", text.replace("domain: 0", f"domain: {domain}"))
            self.read_all(config, expected)

    def read_all(self, config, expected):
        with running_bridge(BIN_DIR, config, self.path("bridge.log")):
            wait_until(lambda: not self.wrong(config, expected), SECONDS, lambda: f"right: {self.wrong(config, expected)}")

    @staticmethod
    def wrong(config, expected):
        """Returns {(device, channel): (sample, expected)} for each wrong or not GOOD sample."""
        done = run("fieldcast", "watch", "--json", "--once", "--config", config)
        samples = {(s["device"], s["channel"]): s for s in map(json.loads, done.stdout.splitlines())}

        def right(key, wanted):
            sample = samples.get(key)
            if sample is None or sample["quality"] != "GOOD":
                return False
            if isinstance(wanted, (bool, str)):
                return wanted == sample["value"]
            return abs(sample["value"] - wanted) <= 1e-6 * max(1, abs(wanted))

        return {key: (samples.get(key), wanted) for key, wanted in expected.items() if not right(key, wanted)}


class MakersTables(Imports):
    """Rows of seven makers; see makers/README.md and makers/expected.txt."""

    @staticmethod
    def expected():
        """Returns {list: (options, rows)}."""
        lists, rows = {}, None
        with open(os.path.join(MAKERS, "expected.txt"), encoding="utf-8") as file:
            for line in filter(None, map(str.strip, file)):
                if line.startswith("["):
                    name, options = line[1:].split("]")
                    rows = lists[name] = (options.split(), [])
                elif not line.startswith("#"):
                    rows[1].append(MakersTables.row_of(line.split(" | ")))
        return lists

    @staticmethod
    def row_of(cells):
        if cells[1] == "-":
            return cells[0], "refused"
        area, number = cells[1].split(":")
        return cells[0], f"{area}:{int(number, 0)}", cells[2], float(cells[3]), cells[4]

    def test_become_the_addresses_types_scales_and_access_of_their_documents(self):
        lists = self.expected()
        self.assertEqual(sorted(lists), sorted(name[:-4] for name in os.listdir(MAKERS) if name.endswith(".csv")))
        for name, (options, expected) in lists.items():
            with self.subTest(list=name):
                done = run("fieldcast", "import", os.path.join(MAKERS, name + ".csv"), "--json", *options)
                rows = [json.loads(line) for line in done.stdout.splitlines()]
                self.assertEqual([(row["name"], "refused") if row["fate"] == "refused" else
                                  (row["name"], row["at"], row["type"], row["scale"], row["access"]) for row in rows],
                                 expected, done.stderr)
                orders = {row["word_order"] for row in rows if row["type"] in ("int32", "uint32") and row["fate"] != "refused"}
                self.assertLessEqual(orders, {"little-endian" if "little-endian" in options else "big-endian"})
                self.assertTrue(all(row["why"] for row in rows if row["fate"] == "refused"))


class Output(Imports):
    def test_passes_the_check_of_the_bridge_in_every_form(self):
        files = [os.path.join(LISTS, name) for name in os.listdir(LISTS) if name.endswith((".json", ".csv"))]
        for arguments, checked in [(["--out", self.path("one.yaml")], "one.yaml"), (["--out", self.path("lists/")], "lists/bridge.yaml"),
                                   (["--template", "--out", self.path("devices/")], "uses.yaml")]:
            with self.subTest(form=checked):
                self.assertEqual(run("fieldcast", "import", *files, *arguments).returncode, 0)
                if checked == "uses.yaml":
                    names = sorted(name.removesuffix(".yaml") for name in os.listdir(self.path("devices")))
                    self.assertIn("sdm120", names)
                    self.file("uses.yaml", "bridge: b\nbuses:\n  - name: b\n    port: { tcp: 127.0.0.1:502 }\n    protocol: modbus-tcp\n"
                              "    devices:\n" + "".join(f"      - {{ name: {name}, address: {i}, template: {name} }}\n"
                                                         for i, name in enumerate(names, 1)))
                done = run("fieldcast-bridge", "--check", self.path(checked))
                self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def test_is_never_written_over_or_half(self):
        made, out = self.file("list.csv", self.LIST), self.path("out.yaml")
        beside = self.file("out.yaml.new", "mine")
        self.assertIn("cannot be moved", run("fieldcast", "import", made, "--out", out).stdout)
        with open(out, encoding="utf-8") as file:
            before = file.read()
        self.assertIn("is there already; it is not written over (--force does)", self.fault(made, "--out", out, "--bridge", "x"))
        with open(out, encoding="utf-8") as file:
            self.assertEqual(file.read(), before)
        self.assertEqual(run("fieldcast", "import", made, "--out", out, "--bridge", "x", "--force").returncode, 1)
        with open(out, encoding="utf-8") as file:
            self.assertIn("bridge: x\n", file.read())
        with open(beside, encoding="utf-8") as file:
            self.assertEqual(file.read(), "mine")
        self.assertEqual(sorted(os.listdir(os.path.dirname(out))), ["list.csv", "out.yaml", "out.yaml.new"])
        # The second of two files exists, so neither is written.
        os.mkdir(self.path("folder"))
        self.file("folder/bus-1-list.csv", "mine")
        self.assertIn("bus-1-list.csv is there already", self.fault(made, "--out", self.path("folder/")))
        self.assertEqual(os.listdir(self.path("folder")), ["bus-1-list.csv"])
        self.assertIn("cannot make", self.fault(made, "--out", "/proc/nothing.yaml"))

    def test_of_several_templates_needs_a_folder(self):
        files = [self.file(name, self.LIST) for name in ["a.csv", "b.csv"]]
        self.assertIn("2 templates; --out needs a folder", self.fault(*files, "--template", "--out", self.path("one.yaml")))


class Words(Imports):
    def test_are_clear_for_what_is_not_a_list(self):
        with open(self.path("huge"), "wb") as file:
            file.truncate(1 << 30)  # 1 GiB, sparse
        with open(self.path("random"), "wb") as file:
            file.write(bytes(range(256)) * 20)
        for path, words in [(self.path("huge"), "1024 MiB; lists of at most 16 MiB are read"), (self.folder, "a folder; name the files"),
                            (self.path("none.csv"), "No such file"), ("/dev/zero", "no regular file"), (self.path("random"), "binary"),
                            (self.file("empty", ""), "the file is empty"), (self.file("prose", "It rains.\n"), "of no format"),
                            (self.file("half.json", '{"device_type":"a","device":{"channels":['), "no JSON from here on"),
                            (os.path.join(BIN_DIR, "..", "CMakeCache.txt"), "of no format")]:
            with self.subTest(path=path):
                code = 1 if path.endswith("half.json") else 2
                done = run("fieldcast", "import", path)
                self.assertEqual(done.returncode, code, done.stderr)
                self.assertIn(words, done.stdout + done.stderr)

    def test_are_clear_for_a_workbook_that_unpacks_to_too_much_or_is_damaged(self):
        excel(self.path("bomb.xlsx"), [["x" * 30000] * 200] * 10)  # 2000 cells refer to one text
        self.assertIn("more than 32 MiB of text", self.fault(self.path("bomb.xlsx")))
        with zipfile.ZipFile(self.path("half.xlsx"), "w") as book:
            book.writestr("xl/worksheets/sheet1.xml", "<worksheet><sheetData/></worksheet>")
            book.writestr("xl/sharedStrings.xml", "<sst><si><t>cut")
        self.assertIn("part xl/sharedStrings.xml is damaged", self.fault(self.path("half.xlsx")))

    def test_name_what_an_option_may_be(self):
        made = self.file("list.csv", self.LIST)
        self.assertIn("allowed: kepware,", self.fault(made, "--from", "excel"))
        self.assertIn("'ttyUSB0' is no port; allowed: a path", self.fault(made, "--port", "ttyUSB0"))
        self.assertIn("allowed: big-endian, little-endian", self.fault(made, "--word-order", "CDAB"))
        self.assertIn("protocol 'modbus' is unknown", self.fault(made, "--protocol", "modbus"))
        self.assertIn("baud", self.fault(made, "--baud", "115000"))

    def test_report_a_template_that_does_not_fit_its_device(self):
        """The import cannot detect a register that the device lacks; the bridge reports it."""
        made = self.file("list.csv", "Address,Name,Type\n70000,far,U16\n65535,wide,U32\n0,good,U16\n")
        done = run("fieldcast", "import", made, "--template", "--out", self.path("devices/"))
        self.assertEqual(done.returncode, 1)
        self.assertIn("not moved: '70000' is no address from 0 to 65535", done.stdout)
        self.assertIn("reaches beyond the area holding", done.stdout)
        with open(self.path("devices/list.yaml"), encoding="utf-8") as file:
            self.assertEqual(re.findall("name: (\\w+)", file.read()), ["good"])


if __name__ == "__main__":
    BIN_DIR, SOURCE_DIR = sys.argv[1:3]
    unittest.main(argv=sys.argv[:1], verbosity=2)
