"""Tests fieldcast-sim with the masters mbpoll and pymodbus.

usage: sim_peers_test.py FIELDCAST_SIM
"""

import json
import os
import shutil
import signal
import socket
import sys
import tempfile
import time
import unittest
import unittest.mock

from pymodbus.client import ModbusSerialClient
try:  # version 3.0 of Debian 12
    from pymodbus.transaction import ModbusAsciiFramer, ModbusRtuFramer
    from pymodbus.file_message import FileRecord, ReadFifoQueueRequest, ReadFifoQueueResponse, ReadFileRecordRequest, WriteFileRecordRequest
    from pymodbus.mei_message import ReadDeviceInformationRequest
    UNIT_1, WRITTEN = {"unit": 1}, {"write_registers": [7]}
    OLD = True
except ImportError:  # version 3.8 of Debian 13
    from pymodbus.framer import FramerType
    ModbusAsciiFramer, ModbusRtuFramer = FramerType.ASCII, FramerType.RTU
    UNIT_1, WRITTEN = {"slave": 1}, {"values": [7]}
    OLD = False

from peers import DEADLINE, Mbpoll, Program, free_port

SIM = ""

PLANT = """
bridge: plant
buses:
  - name: shop
    port: { serial: FOLDER/shop, baud: 115200, format: 8N1 }
    protocol: modbus-rtu
    devices:
      - name: press-1
        address: 1
        channels:
          - { name: level, at: "holding:100", type: uint16 }
          - { name: limit, at: "holding:101", type: uint16, write: { min: 10, max: 20 }, access: read-write }
          - { name: lot, at: "holding:110", type: string(9) }
          - { name: run, at: "coil:3", type: bool, access: read-write }
          - { name: queued, at: "fifo:1246:2", type: uint16, limits: { low: 4740, high: 4741 } }
      - { name: press-2, address: 2, channels: [ { name: flow, at: "input-register:7", type: uint16 } ] }
  - name: mill
    port: { serial: FOLDER/mill, baud: 115200, format: 8N1 }
    protocol: modbus-ascii
    devices:
      - { name: drive, address: 3, channels: [ { name: speed, at: "holding:0", type: uint16 } ] }
  - name: hall
    port: { tcp: "127.0.0.1:PORT" }
    protocol: modbus-tcp
    devices:
      - { name: plc, address: 1, channels: [ { name: level, at: "holding:0", type: uint16 } ] }
"""


class SimulatorTest(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp(prefix="fieldcast-sim-")
        self.addCleanup(shutil.rmtree, self.folder)
        self.port = free_port()
        self.plant = self.file("plant.yaml", PLANT.replace("FOLDER", self.folder).replace("PORT", str(self.port)))
        self.report_file = self.path("report.json")

    def path(self, name):
        return os.path.join(self.folder, name)

    def file(self, name, text):
        with open(self.path(name), "w", encoding="utf-8") as out:
            out.write(text)
        return self.path(name)

    def start(self, *options):
        program = Program(SIM, self.plant, "--report", self.report_file, *options)
        self.addCleanup(program.__exit__)
        return program

    def report(self, bus, device):
        with open(self.report_file, encoding="utf-8") as file:
            buses = {bus["name"]: bus for bus in json.load(file)["buses"]}
        return next(entry for entry in buses[bus]["devices"] if entry["name"] == device)

    def eventually(self, condition, what):
        end = time.monotonic() + DEADLINE
        while not condition():
            self.assertLess(time.monotonic(), end, what)
            time.sleep(0.01)

    def test_mbpoll_reads_and_writes_over_the_terminal(self):
        sim = self.start().wait_ready()
        press, other = Mbpoll(self.path("shop")), Mbpoll(self.path("shop"), unit=2)
        self.assertTrue(all(10 <= value <= 20 for value in press.read("holding", 101, 1)))
        self.assertEqual(press.read("holding", 110, 2), [0x4C4F, 0x542D])  # "LOT-"
        self.assertIs(press.write("holding", 100, 4711), True)
        self.assertEqual(press.read("holding", 100, 1), [4711])  # a written channel keeps its value
        self.assertIs(press.write("coil", 3, 1), True)
        self.assertEqual(press.read("coil", 2, 3), [0, 1, 0])
        self.assertIs(press.write("holding", 200, 1, 2, 3), True)
        self.assertEqual(press.read("holding", 199, 5), [0, 1, 2, 3, 0])
        self.assertEqual(len(press.read("holding", 0, 125)), 125)
        self.assertEqual(len(other.read("input-register", 7, 1)), 1)
        self.assertEqual(sim.stop(), 0)
        counted = self.report("shop", "press-1")
        self.assertEqual(counted["writes"], {"coil:3": 1, "holding:100": 1, "holding:200": 1, "holding:201": 1, "holding:202": 1})
        self.assertEqual(counted["write_requests"], 3)
        self.assertEqual(counted["bad_frames"], 0)

    def test_mbpoll_reads_and_writes_over_tcp(self):
        self.start().wait_ready()
        master = Mbpoll("127.0.0.1", port=self.port)
        self.assertEqual(len(master.read("holding", 0, 1)), 1)
        self.assertIs(master.write("holding", 0, 99), True)
        self.assertEqual(master.read("holding", 0, 2), [99, 0])

    def rtu_master(self):
        master = ModbusSerialClient(self.path("shop"), framer=ModbusRtuFramer, baudrate=115200, parity="N", timeout=DEADLINE)
        self.assertTrue(master.connect())
        self.addCleanup(master.close)
        return master

    def test_pymodbus_masks_and_swaps_registers(self):
        self.start().wait_ready()
        master = self.rtu_master()
        self.assertFalse(master.write_register(4, 0x12, slave=1).isError())
        self.assertFalse(master.mask_write_register(address=4, and_mask=0xF2, or_mask=0x25, **UNIT_1).isError())
        self.assertEqual(master.read_holding_registers(4, count=1, slave=1).registers, [0x17])
        both = master.readwrite_registers(read_address=3, read_count=3, write_address=5, **WRITTEN, **UNIT_1)
        self.assertEqual(both.registers, [0, 0x17, 7])
        self.assertEqual(master.read_holding_registers(65535, count=2, slave=1).exception_code, 2)

    @unittest.skipUnless(OLD, "later versions have other classes for records")
    def test_pymodbus_reads_and_writes_records(self):
        self.start().wait_ready()
        master = self.rtu_master()

        def read(*groups):
            records = [FileRecord(file_number=file, record_number=first, record_length=count) for file, first, count in groups]
            return master.execute(ReadFileRecordRequest(records, unit=1))

        written = [FileRecord(file_number=4, record_number=1, record_data=b"\x0d\xfe\x00\x20"),
                   FileRecord(file_number=3, record_number=9, record_data=b"\x33\xcd")]
        self.assertEqual(master.execute(WriteFileRecordRequest(written, unit=1)).records, written)
        groups = [group.record_data for group in read((4, 0, 3), (3, 9, 2)).records]
        self.assertEqual(groups, [b"\x00\x00\x0d\xfe\x00\x20", b"\x33\xcd\x00\x00"])
        self.assertEqual(read((4, 9999, 2)).exception_code, 2)

    @unittest.skipUnless(OLD, "later versions have other classes for queues")
    def test_pymodbus_reads_a_queue(self):
        self.start().wait_ready()
        master = self.rtu_master()
        read = []
        with unittest.mock.patch.object(ReadFifoQueueResponse, "decode", lambda response, data: read.append(data)):
            self.assertFalse(master.execute(ReadFifoQueueRequest(1246, unit=1)).isError())
        # Its own decoder takes the count for bytes.
        self.assertIn(read, [[bytes.fromhex("0006 0002 0000 1284")], [bytes.fromhex("0006 0002 0000 1285")]])

    @unittest.skipUnless(OLD, "later versions have other calls")
    def test_pymodbus_reads_the_identification(self):
        self.start().wait_ready()
        master = self.rtu_master()
        objects = {0: b"Fieldcast", 1: b"simulated device", 2: b"1.0"}
        self.assertEqual(master.execute(ReadDeviceInformationRequest(1, 0, unit=1)).information, objects)
        self.assertEqual(master.execute(ReadDeviceInformationRequest(4, 1, unit=1)).information, {1: objects[1]})
        self.assertEqual(master.execute(ReadDeviceInformationRequest(4, 3, unit=1)).exception_code, 2)

    def test_pymodbus_reads_and_writes_ascii(self):
        self.start().wait_ready()
        master = ModbusSerialClient(self.path("mill"), framer=ModbusAsciiFramer, baudrate=115200, parity="N", timeout=DEADLINE)
        self.assertTrue(master.connect())
        self.addCleanup(master.close)
        self.assertFalse(master.write_registers(5, [1, 2, 0xABCD], slave=3).isError())
        self.assertEqual(master.read_holding_registers(4, count=5, slave=3).registers, [0, 1, 2, 0xABCD, 0])

    def test_faults_refuse_and_silence(self):
        faults = self.file("faults.yaml", """
buses:
  shop:
    devices:
      press-1: { exceptions: [ { area: holding, from: 107, to: 109, code: 2 } ] }
      press-2: { silence: always }
""")
        self.start("--faults", faults).wait_ready()
        master = Mbpoll(self.path("shop"))
        self.assertIn("Illegal data address", master.read("holding", 105, 4))
        self.assertEqual(len(master.read("holding", 105, 2)), 2)
        silent = Mbpoll(self.path("shop"), unit=2, timeout=0.2)
        self.assertIn("timed out", silent.read("input-register", 7, 1))

    def test_an_unplugged_port_comes_back(self):
        faults = self.file("faults.yaml", "buses: { shop: { unplug: { at: 0s, for: 1s } } }")
        self.start("--faults", faults).wait_ready()
        self.assertFalse(os.path.lexists(self.path("shop")))
        self.assertTrue(os.path.lexists(self.path("mill")))
        self.eventually(lambda: os.path.lexists(self.path("shop")), "the port did not come back")
        self.assertEqual(len(Mbpoll(self.path("shop")).read("holding", 100, 1)), 1)

    def test_an_unplugged_tcp_device_comes_back(self):
        faults = self.file("faults.yaml", "buses: { hall: { unplug: { at: 0s, for: 1s } } }")
        self.start("--faults", faults).wait_ready()
        master = Mbpoll("127.0.0.1", port=self.port)
        self.assertIn("Connection refused", master.read("holding", 0, 1))
        self.eventually(lambda: isinstance(master.read("holding", 0, 1), list), "the listener did not come back")

    def test_a_stream_beyond_repair_is_closed(self):
        self.start().wait_ready()
        with socket.create_connection(("127.0.0.1", self.port), DEADLINE) as stream:
            stream.sendall(bytes.fromhex("0007CAFE00062A0300000001"))
            self.assertEqual(stream.recv(100), b"")

    def test_links_go_with_the_simulator(self):
        for end in (signal.SIGTERM, signal.SIGINT):
            sim = self.start().wait_ready()
            self.assertTrue(os.path.islink(self.path("shop")))
            sim.signal(end)
            self.assertEqual(sim.wait(), 0)
            self.assertFalse(os.path.lexists(self.path("shop")))

    def test_links_of_a_killed_simulator_are_taken_over(self):
        sim = self.start().wait_ready()
        sim.signal(signal.SIGKILL)
        sim.wait()
        self.assertTrue(os.path.islink(self.path("shop")))
        self.start().wait_ready()
        self.assertEqual(len(Mbpoll(self.path("shop")).read("holding", 100, 1)), 1)

    def test_a_file_in_the_way_is_left_alone(self):
        self.file("mill", "precious")
        sim = self.start()
        self.assertEqual(sim.wait(), 4)
        self.assertIn("was not made by Fieldcast", sim.errors)
        with open(self.path("mill"), encoding="utf-8") as file:
            self.assertEqual(file.read(), "precious")
        self.assertFalse(os.path.lexists(self.path("shop")), "the ports opened before it are closed again")

    def test_a_signal_asks_for_the_report(self):
        sim = self.start().wait_ready()
        self.assertFalse(os.path.exists(self.report_file))
        Mbpoll(self.path("shop")).read("holding", 100, 1)
        sim.signal(signal.SIGUSR1)
        self.eventually(lambda: os.path.exists(self.report_file), "no report")
        self.assertEqual(self.report("shop", "press-1")["requests_by_function"], {"03": 1})

    def test_bad_files_are_refused_with_their_place(self):
        faults = self.file("faults.yaml", "buses:\n  shop:\n    noize: 1\n")
        sim = self.start("--faults", faults)
        self.assertEqual(sim.wait(), 3)
        self.assertIn("faults.yaml:3:5: unknown key 'noize'", sim.errors)

    def test_ends_by_itself(self):
        sim = self.start("--seconds", "0.2", "--quiet")
        self.assertEqual(sim.wait(), 0)
        self.assertEqual(sim.said, "")


if __name__ == "__main__":
    SIM = sys.argv.pop(1)
    unittest.main()
