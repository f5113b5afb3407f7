"""Tests devices and masters of other authors with each other: the bridge can only support what
works between them.

usage: servers_test.py LIBMODBUS_SERVER
"""

import os
import sys
import unittest

from peers import Cable, Mbpoll, Program, free_port

LIBMODBUS = ""
PYMODBUS = os.path.join(os.path.dirname(os.path.abspath(__file__)), "pymodbus_server.py")


class ServersTest(unittest.TestCase):
    def check(self, master):
        self.assertEqual(master.read("holding", 100, 10), [1000 + n for n in range(100, 110)])
        self.assertEqual(master.read("input-register", 499, 1), [2499])
        self.assertEqual(master.read("coil", 0, 7), [1, 0, 0, 1, 0, 0, 1])
        self.assertEqual(master.read("input", 0, 4), [0, 1, 0, 1])
        self.assertIs(master.write("holding", 5, 4711, 8), True)
        self.assertEqual(master.read("holding", 4, 4), [1004, 4711, 8, 1007])
        self.assertIn("Illegal data address", master.read("holding", 499, 2))

    def serve_serial(self, *command):
        with Cable() as cable, Program(*command, "rtu", cable.right, 115200, 7) as server:
            server.wait_ready()
            self.check(Mbpoll(cable.left, unit=7))
            self.assertEqual(server.stop(), 0)

    def serve_tcp(self, *command):
        port = free_port()
        with Program(*command, "tcp", port) as server:
            server.wait_ready()
            self.check(Mbpoll("127.0.0.1", port=port))
            self.assertEqual(server.stop(), 0)

    def test_libmodbus_on_a_serial_line(self):
        self.serve_serial(LIBMODBUS)

    def test_libmodbus_over_tcp(self):
        self.serve_tcp(LIBMODBUS)

    def test_pymodbus_on_a_serial_line(self):
        self.serve_serial(sys.executable, PYMODBUS)

    def test_pymodbus_over_tcp(self):
        self.serve_tcp(sys.executable, PYMODBUS)


if __name__ == "__main__":
    LIBMODBUS = sys.argv.pop(1)
    unittest.main()
