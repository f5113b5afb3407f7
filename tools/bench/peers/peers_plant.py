"""The same lines of scattered registers as configurations of the bridge and of mqmgateway."""

import random

MOST_JOINED = 13  # registers of a gap that is cheaper to read than a second request
MOST_IN_REQUEST = 125


def scattered(registers, mean, seed=7):
    """{unit: addresses} of two units: `mean` registers close together, then a gap that no read should include."""
    numbers = random.Random(seed)
    units = {}
    for unit in (1, 2):
        address, units[unit] = numbers.randrange(50), []
        for _ in range(registers // 2):
            units[unit].append(address)
            address += 30 + numbers.randrange(100) if numbers.randrange(mean) == 0 else 1 + numbers.randrange(4)
    return units


def blocks(addresses):
    """[first, last] of each request."""
    found = []
    for address in addresses:
        if found and address - found[-1][1] <= MOST_JOINED and address - found[-1][0] < MOST_IN_REQUEST:
            found[-1][1] = address
        else:
            found.append([address, address])
    return found


def bridge_config(folder, lines, units, silence, domain):
    text = f"bridge: peers\ndds: {{ domain: {domain}, interfaces: [127.0.0.1] }}\nbuses:\n"
    for line in range(1, lines + 1):
        text += (f"  - name: line{line}\n    port: {{ serial: {folder}/line{line}, baud: 19200, format: 8E1 }}\n    protocol: modbus-rtu\n"
                 f"    defaults: {{ refresh: 2s, mode: intensive, silence: {silence} }}\n    devices:\n")
        for unit, addresses in units.items():
            text += f"      - name: unit-{unit}\n        address: {unit}\n        channels:\n"
            for address in addresses:
                text += f'          - {{ name: r{address}, at: "holding:{address}", type: uint16 }}\n'
    return text


def peer_config(folder, lines, units, port):
    text = "modmqttd: { log_level: error }\nmodbus:\n  networks:\n"
    for line in range(1, lines + 1):
        text += (f"    - name: line{line}\n      device: {folder}/line{line}\n      baud: 19200\n      parity: E\n      data_bit: 8\n      stop_bit: 1\n"
                 "      response_timeout: 500ms\n      response_data_timeout: 500ms\n      slaves:\n")
        for unit, addresses in units.items():
            text += f"        - address: {unit}\n          poll_groups:\n"
            for first, last in blocks(addresses):  # mqmgateway counts registers from 1
                text += f"            - {{ register: {first + 1}, register_type: holding, count: {last - first + 1} }}\n"
    text += (f"mqtt:\n  client_id: peer\n  refresh: 100ms\n  publish_mode: every_poll\n  broker: {{ host: 127.0.0.1, port: {port} }}\n"
             "  objects:\n")
    for line in range(1, lines + 1):
        for unit, addresses in units.items():
            for address in addresses:
                text += (f"    - topic: line{line}/unit-{unit}/r{address}\n      retain: false\n"
                         f"      state: {{ register: line{line}.{unit}.{address + 1}, register_type: holding }}\n")
    return text
