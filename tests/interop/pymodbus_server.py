"""A Modbus device based on pymodbus, as an independent peer of the bridge.

usage: pymodbus_server.py rtu PATH [BAUD [UNIT]]     8N1; default 115200 baud, unit 1
       pymodbus_server.py ascii PATH [BAUD [UNIT]]
       pymodbus_server.py tcp PORT [UNIT]            127.0.0.1
       pymodbus_server.py udp PORT [UNIT]            127.0.0.1, the frames of TCP as datagrams
       pymodbus_server.py tls PORT [UNIT]            127.0.0.1, with --certificate, --key and --ca; clients need a certificate
       --registers FILE     JSON of {"first holding register": [values]}; all others are refused

Prints READY when it serves, ends with SIGTERM. Memory, all areas 0..499, equal to
libmodbus_server.cpp:
  coil n = (n % 3 == 0), input n = (n % 2 == 1), holding n = 1000 + n, input-register n = 2000 + n
Only here: the objects of OBJECTS unless a FILE is given, and with SERVES_FILES record n of file f = 1000 f + n, and QUEUES.
"""

import asyncio
import json
import signal
import ssl
import struct
import sys

from pymodbus.device import ModbusControlBlock
from pymodbus.datastore import ModbusSequentialDataBlock, ModbusServerContext, ModbusSlaveContext, ModbusSparseDataBlock

try:  # version 3.0 of Debian 12
    from pymodbus.server.async_io import ModbusSerialServer, ModbusTcpServer, ModbusTlsServer, ModbusUdpServer
    from pymodbus.transaction import ModbusAsciiFramer, ModbusRtuFramer, ModbusSocketFramer
except ImportError:  # version 3.8 of Debian 13
    from pymodbus.framer import FramerType
    from pymodbus.server import ModbusSerialServer, ModbusTcpServer, ModbusTlsServer, ModbusUdpServer
    ModbusAsciiFramer, ModbusRtuFramer, ModbusSocketFramer = FramerType.ASCII, FramerType.RTU, FramerType.SOCKET
    OLD = False
else:
    OLD = True
FIRST = 0 if OLD else 1  # place of address 0 in a block
SERVES_FILES = OLD  # later versions have other classes for records
QUEUES = {1246: [0x01B8, 0x1284], 7: []}  # by pointer; of 9 they are too many
OBJECTS = {0: "Maker", 1: "Model 7", 2: "V1.2", 5: "Seven", 128: "S-42", 200: "x" * 244}

ITEMS = range(500)
REGISTERS = None  # holding registers of a file
FILES = {"--certificate": None, "--key": None, "--ca": None}  # of TLS


def memory(unit):
    registers = {address + FIRST: value for address, value in REGISTERS.items()} if REGISTERS else None
    device = ModbusSlaveContext(
        co=ModbusSequentialDataBlock(FIRST, [n % 3 == 0 for n in ITEMS]),
        di=ModbusSequentialDataBlock(FIRST, [n % 2 == 1 for n in ITEMS]),
        hr=ModbusSparseDataBlock(registers) if registers else ModbusSequentialDataBlock(FIRST, [1000 + n for n in ITEMS]),
        ir=ModbusSequentialDataBlock(FIRST, [2000 + n for n in ITEMS]),
        **({"zero_mode": True} if OLD else {}),
    )
    return ModbusServerContext(slaves={unit: device}, single=False)


def serve_files():
    """Gives the records of pymodbus a memory: it decodes requests and encodes writes, but has no store."""
    from pymodbus.file_message import FileRecord, ReadFileRecordRequest, ReadFileRecordResponse, WriteFileRecordRequest, WriteFileRecordResponse
    from pymodbus.pdu import ModbusExceptions

    written = {}

    def register(file, record):
        return written.get((file, record), struct.pack(">H", (1000 * file + record) & 0xFFFF))

    def refused(request):
        groups = [(group.record_number, group.record_length) for group in request.records]
        return any(first + count > 10000 for first, count in groups)

    def read(self, _):
        if refused(self):
            return self.doException(ModbusExceptions.IllegalAddress)
        return ReadFileRecordResponse([FileRecord(record_data=b"".join(register(group.file_number, group.record_number + i)
                                                                       for i in range(group.record_length))) for group in self.records])

    def write(self, _):
        if refused(self):
            return self.doException(ModbusExceptions.IllegalAddress)
        for group in self.records:
            for i in range(group.record_length):
                written[group.file_number, group.record_number + i] = group.record_data[2 * i:2 * i + 2]
        return WriteFileRecordResponse(self.records)

    def encode(self):
        """Version 3.0 exchanges length and reference type of a group, and counts registers as bytes."""
        groups = b"".join(struct.pack(">BB", group.response_length, 6) + group.record_data for group in self.records)
        return struct.pack("B", len(groups)) + groups

    from pymodbus.file_message import ReadFifoQueueRequest, ReadFifoQueueResponse

    def read_queue(self, _):
        if self.address == 9:
            return self.doException(ModbusExceptions.IllegalValue)
        if self.address not in QUEUES:
            return self.doException(ModbusExceptions.IllegalAddress)
        return ReadFifoQueueResponse(QUEUES[self.address])

    def encode_queue(self):
        """Version 3.0 counts bytes in place of registers."""
        return struct.pack(f">HH{len(self.values)}H", 2 + 2 * len(self.values), len(self.values), *self.values)

    ReadFifoQueueRequest.execute, ReadFifoQueueResponse.encode = read_queue, encode_queue
    ReadFileRecordRequest.execute, WriteFileRecordRequest.execute, ReadFileRecordResponse.encode = read, write, encode


def tls_context():
    context = ssl.create_default_context(ssl.Purpose.CLIENT_AUTH, cafile=FILES["--ca"])
    context.load_cert_chain(FILES["--certificate"], FILES["--key"])
    context.verify_mode = ssl.CERT_REQUIRED
    return context


async def serve(kind, place, numbers):
    if kind == "tls":
        # The framer of TLS leaves the header out; the standard keeps it.
        server = ModbusTlsServer(memory(*(numbers or [1])), framer=ModbusSocketFramer, address=("127.0.0.1", int(place)), sslctx=tls_context(),
                                 **({"allow_reuse_address": True} if OLD else {}))
    elif kind == "tcp":
        server = ModbusTcpServer(memory(*(numbers or [1])), framer=ModbusSocketFramer, address=("127.0.0.1", int(place)),
                                 **({"allow_reuse_address": True} if OLD else {}))
    elif kind == "udp":
        server = ModbusUdpServer(memory(*(numbers or [1])), framer=ModbusSocketFramer, address=("127.0.0.1", int(place)))
    else:
        framer = ModbusRtuFramer if kind == "rtu" else ModbusAsciiFramer
        baud, unit = numbers + [115200, 1][len(numbers):]
        server = ModbusSerialServer(memory(unit), framer=framer, port=place, baudrate=baud, bytesize=8, parity="N", stopbits=1,
                                    ignore_missing_slaves=True, timeout=1)
    if OLD and kind not in ("rtu", "ascii"):
        running = asyncio.ensure_future(server.serve_forever())
        await server.serving
    elif OLD:
        await server.start()
        if server.transport is None:
            sys.exit(f"pymodbus_server.py: {place} does not open")
        running = asyncio.ensure_future(server.serve_forever())
    else:
        await server.serve_forever(background=True)  # fails if the place does not open
        running = server.serving
    stop = asyncio.Event()
    for name in (signal.SIGTERM, signal.SIGINT):
        asyncio.get_running_loop().add_signal_handler(name, stop.set)
    print("READY", flush=True)
    await stop.wait()
    running.cancel()


def registers_of(path):
    with open(path, encoding="utf-8") as file:
        return {int(first) + i: value for first, values in json.load(file).items() for i, value in enumerate(values)}


def main():
    global REGISTERS
    for option in FILES:
        if option in sys.argv:
            at = sys.argv.index(option)
            FILES[option] = sys.argv[at + 1]
            del sys.argv[at:at + 2]
    if "--registers" in sys.argv:
        at = sys.argv.index("--registers")
        REGISTERS = registers_of(sys.argv[at + 1])
        del sys.argv[at:at + 2]
    if len(sys.argv) < 3 or sys.argv[1] not in ("rtu", "ascii", "tcp", "udp", "tls"):
        sys.exit(__doc__)
    if not REGISTERS:
        ModbusControlBlock().Identity.update(OBJECTS)
    if SERVES_FILES:
        serve_files()
    asyncio.run(serve(sys.argv[1], sys.argv[2], [int(n) for n in sys.argv[3:]]))


if __name__ == "__main__":
    main()
