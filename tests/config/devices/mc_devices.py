"""Simulates Mitsubishi PLCs behind one MC protocol port, 3E frame in binary code. Unlisted devices hold 0."""

import contextlib
import socketserver
import struct
import threading

CODES = {0x90: "M", 0x91: "SM", 0xA8: "D", 0xA9: "SD"}
BITS = ("M", "SM")
HEADER = "<HBBHBH"  # subheader, network, station, module, unit, length


class McDevices:
    """Serves {(station, device, number): word or bit} on 127.0.0.1:`port` inside `with`."""

    def __init__(self, memory):
        devices = self
        self.memory = memory

        class Connection(socketserver.StreamRequestHandler):
            def handle(self):
                # the bridge may end while it waits for a response
                with contextlib.suppress(ConnectionError):
                    while header := self.rfile.read(struct.calcsize(HEADER)):
                        _, network, station, module, unit, length = struct.unpack(HEADER, header)
                        data = struct.pack("<H", 0) + devices.answer(station, self.rfile.read(length)[2:])
                        self.wfile.write(struct.pack(HEADER, 0x00D0, network, station, module, unit, len(data)) + data)

        class Server(socketserver.ThreadingTCPServer):
            allow_reuse_address = daemon_threads = True

        self._server = Server(("127.0.0.1", 0), Connection)
        self.port = self._server.server_address[1]

    def answer(self, station, request):
        command, subcommand = struct.unpack("<HH", request[:4])
        if command == 0x0403:
            words = request[4]
            return b"".join(self.word(station, *self.device(request[6 + 4 * i:])) for i in range(words))
        assert command == 0x0401, request.hex()
        name, first = self.device(request[4:])
        count, = struct.unpack("<H", request[8:10])
        if subcommand == 0:
            return b"".join(self.word(station, name, first + i * (16 if name in BITS else 1)) for i in range(count))
        bits = [self.memory.get((station, name, first + i), 0) for i in range(count)] + [0]
        return bytes(bits[i] << 4 | bits[i + 1] for i in range(0, count, 2))

    @staticmethod
    def device(field):
        return CODES[field[3]], int.from_bytes(field[:3], "little")

    def word(self, station, name, number):
        """Of bits, the 16 from `number` on, the first one in the lowest bit."""
        if name not in BITS:
            return struct.pack("<H", self.memory.get((station, name, number), 0))
        return struct.pack("<H", sum(self.memory.get((station, name, number + i), 0) << i for i in range(16)))

    def __enter__(self):
        threading.Thread(target=self._server.serve_forever, args=(0.05,), daemon=True).start()
        return self

    def __exit__(self, *_):
        self._server.shutdown()
        self._server.server_close()
