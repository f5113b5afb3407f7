"""Completes a fragment of a configuration, so that `fieldcast-bridge --check` can check it."""

import re

ADDRESSES = {"allen-bradley-df1": "N7:0", "s7-ppi": "VW0", "s7-freeport": "VW0", "omron-hostlink": "DM0", "mitsubishi-fx": "D0", "mitsubishi-mc": "D0", "mitsubishi-mc-serial": "D0", "dtc": "int16:0"}
LEVELS = ["bridge", "bus", "device", "channels"]


def whole(text, argument):
    """`argument`: the text after `fragment:`, which is empty, `bus`, `device` or `channels`, and a
    protocol if the text has none."""
    words = argument.split()
    level = words[0] if words else "bridge"
    if level not in LEVELS:
        raise ValueError(f"a fragment is of {', '.join(LEVELS)}, not of '{level}'")
    protocol = words[1] if len(words) > 1 else "modbus-rtu"
    if protocol.startswith("declared-"):
        text = text or "- { name: a, at: a, type: uint16 }\n"
    if level == "channels":
        text = "channels:\n" + _indented(text, 2)
    if level in ("channels", "device"):
        text = _item("devices", _with(text, {"name": "meter", "address": 1, "channels": _channels(protocol)}))
    if level in ("channels", "device", "bus"):
        text = _item("buses", _with(text, {"name": "line", "port": "{ serial: /tmp/line }", "protocol": protocol,
                                           "devices": "[ { name: meter, address: 1, channels: " + _channels(protocol) + " } ]"}))
    return _with(text, {"bridge": "fragment", "buses": "[ { name: line, port: { serial: /tmp/line }, protocol: modbus-rtu, devices: "
                        "[ { name: meter, address: 1, channels: " + _channels("modbus-rtu") + " } ] } ]"})


def whole_declaration(text):
    return _with(text, {"summary": "A fragment", "addresses": "{ from: 1, to: 99 }", "areas": "[ { name: state, record: true } ]",
                        "operations": "[ { name: read, read: state, command: 1, request: [ { is: address }, { is: command } ], "
                                      "answer: [ { is: address }, { is: command }, { name: a, is: value, bytes: 2 } ] } ]"})


def _channels(protocol):
    return f'[ {{ name: a, at: "{ADDRESSES.get(protocol, "holding:0")}", type: uint16 }} ]'


def _with(text, defaults):
    present = set(re.findall(r"^([\w-]+):", text, re.MULTILINE))
    return text + "".join(f"{key}: {value}\n" for key, value in defaults.items() if key not in present)


def _indented(text, columns):
    return "".join(" " * columns + line + "\n" if line else "\n" for line in text.splitlines())


def _item(key, text):
    lines = _indented(text, 4).splitlines()
    first = next(i for i, line in enumerate(lines) if line.strip() and not line.strip().startswith("#"))
    lines[first] = "  - " + lines[first][4:]
    return f"{key}:\n" + "\n".join(lines) + "\n"
