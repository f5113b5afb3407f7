"""Tests the tables of documents: addresses that a configuration may use, those that `--check`
refuses, and the error codes of devices.

    <!-- addresses: PROTOCOL, OPTION: VALUE, .. -->          address, type, write (yes or no)
    <!-- refused addresses: PROTOCOL, OPTION: VALUE, .. -->  address, type, said (part of the message)
    <!-- codes: FOLDER of core/protocol -->                  code, text: exactly those in the source

A comment names the kind of the table after it; the columns on the right are required. A cell may
name several types. An address without a type is one bit.
"""

import os
import re

PORTS = {"mitsubishi-mc": "{ tcp: 127.0.0.1:5007 }", "omron-fins": "{ tcp: 127.0.0.1:9600 }", "modbus-tcp": "{ tcp: 127.0.0.1:502 }",
         "s7-tcp": "{ tcp: 127.0.0.1:102 }"}
DEVICE_CODE = re.compile(r'DeviceCode\{(0x[0-9A-Fa-f]+|\d+),\s*"([^"]*)"[,}]')


def rows(block):
    lines = [[cell.strip() for cell in line.strip().strip("|").split("|")] for line in block.text.splitlines()]
    return [dict(zip(lines[0], cells)) for cells in lines[2:]]


def codes_of(cell):
    return re.findall(r"`([^`]+)`", cell)


class Configuration:
    def __init__(self, argument):
        protocol, _, options = argument.partition(",")
        port = PORTS.get(protocol.strip(), "{ serial: /tmp/line }")
        self.lines = ["bridge: table", "buses:", "  - name: line", f"    port: {port}", f"    protocol: {protocol.strip()}",
                      "    devices:", "      - name: device", "        address: 1"]
        if options:
            self.lines.append(f"        options: {{ {options.strip()} }}")
        self.lines.append("        channels:")
        self.rows = {}  # of the channel on each line

    def add(self, row, address, type_name, access):
        type_text = f", type: {type_name}" if type_name else ""
        access_text = ", access: read-write" if access else ""
        self.lines.append(f'          - {{ name: c{len(self.rows)}, at: "{address}"{type_text}{access_text} }}')
        self.rows[len(self.lines)] = row

    def text(self):
        return "\n".join(self.lines) + "\n"


def channels(row):
    for address in codes_of(row["address"]):
        for type_name in codes_of(row["type"]) or [None]:
            yield address, type_name


def check_addresses(block, sandbox):
    """Checks that `write` is right for each channel. Returns the number of channels."""
    good, bad = Configuration(block.markers["addresses"]), Configuration(block.markers["addresses"])
    for row in rows(block):
        writable = row.get("write", "").split(",")[0].split(" ")[0]
        if "write" in row and writable not in ("yes", "no"):
            raise block.fault(f"{row['address']}: 'write' begins with yes or no")
        for address, type_name in channels(row):
            good.add(row, address, type_name, writable == "yes")
            if writable == "no":
                bad.add(row, address, type_name, True)
    code, said = _check(sandbox, f"table-{block.line}.yaml", good)
    if code != 0:
        raise block.fault(f"a table of addresses is not accepted:\n{said}")
    if bad.rows:
        refuse(block, sandbox, bad, lambda row: ["cannot be written"])
    return len(good.rows) + len(bad.rows)


def check_refused(block, sandbox):
    bad = Configuration(block.markers["refused addresses"])
    for row in rows(block):
        for address, type_name in channels(row):
            bad.add(row, address, type_name, False)
    refuse(block, sandbox, bad, lambda row: codes_of(row["said"]))
    return len(bad.rows)


def refuse(block, sandbox, configuration, words_of):
    name = f"refused-{block.line}.yaml"
    _, said = _check(sandbox, name, configuration)
    for line, row in configuration.rows.items():
        faults = [text for text in said.splitlines() if text.startswith(f"{name}:{line}:")]
        for words in words_of(row):
            if not any(words in text for text in faults):
                raise block.fault(f"{row['address']} is not refused with '{words}': {faults}")


def _check(sandbox, name, configuration):
    sandbox.write(name, configuration.text())
    return sandbox.run(f"fieldcast-bridge --check {name}")


def check_codes(block, sandbox):
    folder = os.path.join(sandbox.source_dir, "core", "protocol", block.markers["codes"])
    known = {}
    for name in sorted(os.listdir(folder)):
        with open(os.path.join(folder, name), encoding="utf-8") as file:
            known.update({int(code, 0): text for code, text in DEVICE_CODE.findall(file.read())})
    shown = {int(codes_of(row["code"])[0], 16): codes_of(row["text"])[0] for row in rows(block)}
    for code in known.keys() | shown.keys():
        if known.get(code) != shown.get(code):
            raise block.fault(f"code {code:02X}: shown as {shown.get(code)}, the source has {known.get(code)}")
    return len(shown)


CHECKS = {"addresses": check_addresses, "refused addresses": check_refused, "codes": check_codes}
