"""Simulates Modbus TCP devices behind one port. Unlisted registers hold 0."""

import contextlib
import json
import re
import socketserver
import struct
import threading

from mc_devices import BITS as MC_BITS

BITS, REGISTERS = (1, 2), (3, 4)


def read_examples(path):
    """Returns {name: [(function or device, first, items, {channel: value})]}; see the file's head."""
    with open(path, encoding="utf-8") as file:
        lines = file.read().replace("\\\n", " ").splitlines()
    found = {}
    for line in filter(lambda line: line and not line.startswith("#"), lines):
        if match := re.fullmatch(r"\[([\w-]+)\]", line):
            rows = found.setdefault(match[1], [])
            continue
        function, address, words, values = re.fullmatch(r"(\d|[A-Z]+) ([\dA-Fx+-]+): ([\dA-F ]+) -> (.+)", line).groups()
        first = sum(int(number, 0) for number in re.findall(r"[+-]?(?:0x[\dA-F]+|\d+)", address))
        function = int(function) if function.isdigit() else function
        if function in BITS + MC_BITS:
            items = [int(bit) for bit in words.replace(" ", "")]
        else:
            items = [int(word, 16) for word in words.split()]
        pairs = (pair.split("=") for pair in values.split())
        rows.append((function, first, items, {name: json.loads(value) for name, value in pairs}))
    return found


class Devices:
    """Serves {(unit, function, address): word or bit} on 127.0.0.1:`port` inside `with`."""

    def __init__(self, memory):
        devices = self
        self.memory, self.asked = memory, set()  # asked: (unit, function, first, count)

        class Connection(socketserver.StreamRequestHandler):
            def handle(self):
                # the bridge may end while it waits for a response
                with contextlib.suppress(ConnectionError):
                    while header := self.rfile.read(7):
                        transaction, _, length, unit = struct.unpack(">HHHB", header)
                        answer = devices.answer(unit, self.rfile.read(length - 1))
                        self.wfile.write(struct.pack(">HHHB", transaction, 0, len(answer) + 1, unit) + answer)

        class Server(socketserver.ThreadingTCPServer):
            allow_reuse_address = daemon_threads = True

        self._server = Server(("127.0.0.1", 0), Connection)
        self.port = self._server.server_address[1]

    def answer(self, unit, request):
        function = request[0]
        if function not in BITS + REGISTERS:
            return bytes([function | 0x80, 1])  # all registers are read-only
        first, count = struct.unpack(">HH", request[1:5])
        self.asked.add((unit, function, first, count))
        values = [self.memory.get((unit, function, first + i), 0) for i in range(count)]
        if function in BITS:
            data = sum(bit << i for i, bit in enumerate(values)).to_bytes((count + 7) // 8, "little")
        else:
            data = struct.pack(f">{count}H", *values)
        return bytes([function, len(data)]) + data

    def __enter__(self):
        threading.Thread(target=self._server.serve_forever, args=(0.05,), daemon=True).start()
        return self

    def __exit__(self, *_):
        self._server.shutdown()
        self._server.server_close()
