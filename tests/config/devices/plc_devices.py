"""Simulates one PLC of each family behind a TCP port of its own. Registers and bits without a value are 0.

A memory is {(area, number): word or bit}, with the areas and numbers that the manuals of the family use.
"""

import contextlib
import functools
import operator
import re
import socketserver
import struct
import threading


class Plc:
    """Serves `memory` on 127.0.0.1:`port` inside `with`. `serve(memory, read, write)` processes one request; read(n) returns n bytes."""

    def __init__(self, memory, serve):
        class Connection(socketserver.StreamRequestHandler):
            def handle(self):
                # The bridge may close the connection at any byte.
                with contextlib.suppress(ConnectionError, EOFError):
                    while True:
                        serve(memory, self.read, self.wfile.write)

            def read(self, count):
                data = self.rfile.read(count)
                if len(data) < count:
                    raise EOFError
                return data

        class Server(socketserver.ThreadingTCPServer):
            allow_reuse_address = daemon_threads = True

        self._server = Server(("127.0.0.1", 0), Connection)
        self.port = self._server.server_address[1]

    def __enter__(self):
        threading.Thread(target=self._server.serve_forever, args=(0.05,), daemon=True).start()
        return self

    def __exit__(self, *_):
        self._server.shutdown()
        self._server.server_close()


def words(memory, area, first, count, order=">"):
    return struct.pack(f"{order}{count}H", *(memory.get((area, first + i), 0) for i in range(count)))


def until(read, end):
    """Returns the bytes up to and including the byte `end`."""
    data = b""
    while not data.endswith(end):
        data += read(1)
    return data


def xor(data):
    return b"%02X" % functools.reduce(operator.xor, data)


def crc16(data, start):
    crc = start
    for byte in data:
        crc ^= byte
        for _ in range(8):
            crc = crc >> 1 ^ (0xA001 if crc & 1 else 0)
    return struct.pack("<H", crc)


def s7_tcp(memory, read, write):
    """A word of V at byte n is the key ("V", n); V memory is data block 1."""
    request = read(struct.unpack(">2xH", read(4))[0] - 4)
    if request[1] == 0xE0:  # connection request: confirmed with the same parameters
        tpdu = bytes([request[0], 0xD0]) + request[4:6] + b"\0\1\0" + request[7:]
        return write(struct.pack(">BBH", 3, 0, 4 + len(tpdu)) + tpdu)
    reference, parameters = request[7:9], request[13:]
    data = b""
    if parameters[0] == 0xF0:  # communication setup: the PDU of the request is granted
        parameters = parameters[:8]
    else:
        assert parameters[0] == 4, request.hex()
        for i in range(parameters[1]):
            kind, count, block, area, address = struct.unpack(">3xBHHB3s", parameters[2 + 12 * i:14 + 12 * i])
            assert (kind, block, area) == (2, 1, 0x84), request.hex()
            first = int.from_bytes(address, "big") // 8
            values = bytes(memory.get(("V", n & ~1), 0) >> 8 * (n % 2 == 0) & 0xFF for n in range(first, first + count))
            data += b"\0" * (len(data) % 2) + struct.pack(">BBH", 0xFF, 4, 8 * count) + values
        parameters = parameters[:2]
    head = b"\x02\xF0\x80\x32\3\0\0" + reference + struct.pack(">HHH", len(parameters), len(data), 0)
    return write(struct.pack(">BBH", 3, 0, 4 + len(head + parameters + data)) + head + parameters + data)


def allen_bradley_df1(memory, read, write):
    """Full duplex, CRC. Words of the status file."""
    kind = read(2)
    if kind != b"\x10\x02":
        return None  # an acknowledgement
    message = b""
    while (byte := read(1)) != b"\x10" or (byte := read(1)) == b"\x10":
        message += byte
    assert byte == b"\x03" and read(2) == crc16(message + b"\x03", 0), message.hex()
    to, sender, command, _, number, function, size, file, file_type, element, sub_element = struct.unpack("<BBBBHBBBBBB", message)
    assert (command, function, file, file_type, sub_element) == (0x0F, 0xA2, 2, 0x84, 0), message.hex()
    response = struct.pack("<BBBBH", sender, to, 0x4F, 0, number) + words(memory, "S", element, size // 2, "<")
    return write(b"\x10\x06\x10\x02" + response.replace(b"\x10", b"\x10\x10") + b"\x10\x03" + crc16(response + b"\x03", 0))


def omron_fins(memory, read, write):
    length, command = struct.unpack(">4xII", read(12))
    request = read(length - 4)[4:]
    if command == 0:
        return write(struct.pack(">4sIIIII", b"FINS", 16, 1, 0, 239, 1))
    if request[10:12] == b"\1\1":
        area, first, _, count = struct.unpack(">BHBH", request[12:18])
        assert area == 0xB3, request.hex()
        data = words(memory, "A", first, count)
    else:
        assert request[10:12] == b"\1\4", request.hex()
        items = [request[i:i + 4] for i in range(12, len(request), 4)]
        assert {item[0] for item in items} == {0xB3}, request.hex()
        data = b"".join(b"\xB3" + words(memory, "A", int.from_bytes(item[1:3], "big"), 1) for item in items)
    response = b"\xC0\0\2" + request[6:9] + request[3:6] + request[9:12] + b"\0\0" + data
    return write(struct.pack(">4sIII", b"FINS", 8 + len(response), 2, 0) + response)


def omron_hostlink(memory, read, write):
    """C-mode, responses of one frame."""
    request = until(read, b"*\r")
    assert request[3:5] == b"RJ" and request[-4:-2] == xor(request[:-4]), request
    response = request[:5] + b"00" + words(memory, "A", int(request[5:9]), int(request[9:13])).hex().upper().encode()
    return write(response + xor(response) + b"*\r")


def delta(memory, request):
    """The response to a Modbus request without address; addresses of 4.3 of the Operation Manual."""
    function, first, count = struct.unpack(">BHH", request)
    if function == 3:
        data = words(memory, "D", first - 0x1000, count)
    else:
        assert function == 1, request.hex()
        data = sum(memory.get(("M", first - 0x0800 + i), 0) << i for i in range(count)).to_bytes((count + 7) // 8, "little")
    return bytes([function, len(data)]) + data


def delta_dvp_rtu(memory, read, write):
    request = read(8)
    assert request[6:] == crc16(request[:6], 0xFFFF), request.hex()
    response = request[:1] + delta(memory, request[1:6])
    return write(response + crc16(response, 0xFFFF))


def delta_dvp_ascii(memory, read, write):
    request = bytes.fromhex(until(read, b"\r\n")[1:-2].decode())
    assert sum(request) % 256 == 0, request.hex()
    response = request[:1] + delta(memory, request[1:6])
    return write(b":" + (response + bytes([-sum(response) % 256])).hex().upper().encode() + b"\r\n")


def panasonic_mewtocol(memory, read, write):
    request = until(read, b"\r")
    assert request[-3:-1] == xor(request[:-3]), request
    area, begin, digits = ("DT", 7, 5) if request[4:7] == b"RDD" else ("WR", 8, 4)
    assert request[4:begin] in (b"RDD", b"RCCR"), request
    first, last = int(request[begin:begin + digits]), int(request[begin + digits:begin + 2 * digits])
    response = request[:3] + b"$" + request[4:6] + words(memory, area, first, last - first + 1, "<").hex().upper().encode()
    return write(response + xor(response) + b"\r")


def fatek_facon(memory, read, write):
    request = until(read, b"\x03")
    assert request[-3:-1] == b"%02X" % (sum(request[:-3]) & 0xFF), request
    command, count, area, first = request[3:5], int(request[5:7], 16), chr(request[7]), int(request[8:-3])
    if command == b"44":
        data = "".join(str(memory.get((area, first + i), 0)) for i in range(count)).encode()
    else:
        assert command == b"46", request
        data = words(memory, area, first, count).hex().upper().encode()
    response = request[:5] + b"0" + data
    return write(response + b"%02X\x03" % (sum(response) & 0xFF))


def keyence_kv(memory, read, write):
    """Upper link. Commands, ranges and errors of PROTOCOL_SPEC.md in plc-comm-hostlink-python. A relay is the key (area, channel, place)."""
    command, device, *rest = until(read, b"\r")[:-1].decode("ascii").split(" ")
    area, digits, suffix = re.fullmatch(r"(DM|EM|FM|ZF|TM|CM|VM|Z|T[CS]|C[CS]|MR|LR|CR|R|VB|B|W)([0-9A-F]+)(?:\.([UD]))?", device).groups()
    number = int(digits, 16 if area in ("W", "B", "VB") else 10)
    count, values = int(rest[0]), [int(value) for value in rest[1:]]
    if area in ("R", "MR", "LR", "CR"):
        first = divmod(number, 100)
        keys = [(area, first[0] + (first[1] + i) // 16, (first[1] + i) % 16) for i in range(count)]
        last, wrong = {"R": 1999, "MR": 3999, "LR": 999, "CR": 79}[area], first[1] > 15
        wrong = wrong or keys[-1][1] > last
    else:
        last = {"DM": 65534, "EM": 65534, "FM": 32767, "ZF": 524287, "W": 0x7FFF, "TM": 511, "Z": 12, "CM": 7599, "VM": 589823,
                "TC": 3999, "TS": 3999, "CC": 3999, "CS": 3999, "B": 0x7FFF, "VB": 0xF9FF}[area]
        keys, wrong = [(area, number + i) for i in range(count)], number + count - 1 > last
    expected = {"TC": "D", "TS": "D", "CC": "D", "CS": "D"}.get(area, None if area in ("R", "MR", "LR", "CR", "B", "VB") else "U")
    if suffix != expected or command not in ("RDS", "WRS") or (command == "WRS" and len(values) != count):
        return write(b"E1\r\n")
    if wrong:
        return write(b"E0\r\n")
    if command == "WRS":
        memory.update(zip(keys, values))
        return write(b"OK\r\n")
    return write(" ".join(str(memory.get(key, 0)) for key in keys).encode() + b"\r\n")


# Those of the templates; Keyence KV has none.
PLCS = {
    "s7-tcp": s7_tcp,
    "allen-bradley-df1": allen_bradley_df1,
    "omron-fins": omron_fins,
    "omron-hostlink": omron_hostlink,
    "delta-dvp-rtu": delta_dvp_rtu,
    "delta-dvp-ascii": delta_dvp_ascii,
    "panasonic-mewtocol": panasonic_mewtocol,
    "fatek-facon": fatek_facon,
}
