"""A Modbus device based on pymodbus, as an independent peer of the bridge.

usage: pymodbus_server.py rtu PATH [BAUD [UNIT]]     8N1; default 115200 baud, unit 1
       pymodbus_server.py ascii PATH [BAUD [UNIT]]
       pymodbus_server.py tcp PORT [UNIT]            127.0.0.1
       pymodbus_server.py udp PORT [UNIT]            127.0.0.1, the frames of TCP as datagrams
       --registers FILE     JSON of {"first holding register": [values]}; all others are refused

Prints READY when it serves, ends with SIGTERM. Memory, all areas 0..499, equal to
libmodbus_server.cpp:
  coil n = (n % 3 == 0), input n = (n % 2 == 1), holding n = 1000 + n, input-register n = 2000 + n
"""

import asyncio
import json
import signal
import sys

from pymodbus.datastore import ModbusSequentialDataBlock, ModbusServerContext, ModbusSlaveContext, ModbusSparseDataBlock

try:  # version 3.0 of Debian 12
    from pymodbus.server.async_io import ModbusSerialServer, ModbusTcpServer, ModbusUdpServer
    from pymodbus.transaction import ModbusAsciiFramer, ModbusRtuFramer, ModbusSocketFramer
except ImportError:  # version 3.8 of Debian 13
    from pymodbus.framer import FramerType
    from pymodbus.server import ModbusSerialServer, ModbusTcpServer, ModbusUdpServer
    ModbusAsciiFramer, ModbusRtuFramer, ModbusSocketFramer = FramerType.ASCII, FramerType.RTU, FramerType.SOCKET
    OLD = False
else:
    OLD = True
FIRST = 0 if OLD else 1  # place of address 0 in a block

ITEMS = range(500)
REGISTERS = None  # holding registers of a file


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


async def serve(kind, place, numbers):
    if kind == "tcp":
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
    if "--registers" in sys.argv:
        at = sys.argv.index("--registers")
        REGISTERS = registers_of(sys.argv[at + 1])
        del sys.argv[at:at + 2]
    if len(sys.argv) < 3 or sys.argv[1] not in ("rtu", "ascii", "tcp", "udp"):
        sys.exit(__doc__)
    asyncio.run(serve(sys.argv[1], sys.argv[2], [int(n) for n in sys.argv[3:]]))


if __name__ == "__main__":
    main()
