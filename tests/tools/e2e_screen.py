"""Tests the screens of `fieldcast watch` and `fieldcast status` on a pseudo-terminal, with a
bridge and simulated devices.

usage: e2e_screen.py BIN_DIR
"""

import os
import signal
import sys
import unittest

from plant import Plant
from terminal import DOWN, ENTER, ESCAPE, F1, F6, Terminal

BIN_DIR = ""

CONFIG = """
bridge: line-7
buses:
  - name: press-shop
    port: { serial: {run}/line-1, baud: 38400, format: 8E1 }
    protocol: modbus-rtu
    devices:
      - name: press-1
        address: 1
        channels:
          - { name: pressure, at: "holding:0", type: float32, unit: bar, refresh: 500ms, description: Oil of the main cylinder }
          - { name: setpoint, at: "holding:10", type: float32, access: read-write, unit: "°C" }
          - { name: mode, at: "holding:30", type: uint16, access: read-write }
      - name: press-2
        address: 2
        channels:
          - { name: count, at: "holding:0", type: uint16, refresh: 300ms }
  - name: packing
    port: { serial: {run}/line-2, baud: 9600 }
    protocol: modbus-rtu
    devices:
      - name: scale
        address: 5
        channels: [ { name: weight, at: "holding:0", type: int32, unit: g } ]
"""

RESTORED = b"\x1b[?1049l"  # leaves the alternate screen


def setUpModule():
    global plant
    plant = unittest.enterModuleContext(Plant(BIN_DIR, CONFIG))


class Screen(unittest.TestCase):
    def start(self, command, *arguments, columns=80, rows=24, **environment):
        terminal = Terminal([os.path.join(BIN_DIR, "fieldcast"), command, *arguments, "--config", plant.file], columns, rows, **environment)
        terminal.__enter__()
        self.addCleanup(terminal.__exit__)
        return terminal

    def watch(self, *arguments, **options):
        terminal = self.start("watch", *arguments, **options)
        terminal.wait_for("5 of 5 GOOD")
        return terminal

    def ends(self, terminal, code):
        """Checks that the terminal is restored, however the program ended."""
        self.assertEqual(terminal.wait_for_end(), code)
        self.assertIn(RESTORED, terminal.said)
        self.assertGreater(terminal.said.rfind(b"1000l"), terminal.said.rfind(b"1000h"), "the mouse stays on")
        self.assertFalse(terminal.cursor_is_hidden())
        self.assertEqual(terminal.modes_now(), terminal.modes)

    def test_filter_sort_help_and_quit(self):
        terminal = self.watch()
        terminal.press("/", "press-2")
        terminal.wait_until(lambda text: "count" in text and "weight" not in text, "only press-2")
        terminal.press(ESCAPE)
        terminal.wait_for("weight")
        terminal.press("t", F6)
        terminal.wait_for("sort: name")
        rows = [line.split()[0] for line in terminal.lines()[3:8]]
        self.assertEqual(rows, sorted(rows))
        terminal.press(F1)
        terminal.wait_for("write a value to the selected channel")
        terminal.press(ESCAPE)
        terminal.wait_for("F1 help")
        terminal.click(2, 2)
        terminal.wait_for("sort: name, inverted")
        terminal.press("q")
        self.ends(terminal, 0)

    def test_a_write_is_confirmed_and_its_result_shown(self):
        terminal = self.watch()
        terminal.press("t", "/", "mode", ENTER, "w")
        terminal.wait_for(r"Write press-shop/press-1/mode(.|\n)*value now +\d+ ")
        terminal.press("4711", ENTER)
        terminal.wait_for(r"value now +\d+ (.|\n)*new value +4711(.|\n)*y: write it")
        terminal.press("v")
        terminal.wait_for(r"press-1/mode = 4711: verified \(read back 4711\)")
        terminal.press("w")
        terminal.wait_for("new value")
        terminal.press("70000", ENTER)
        terminal.wait_for("y: write it")
        terminal.press("y")
        terminal.wait_for(r"press-1/mode = 70000: rejected.*RANGE")
        terminal.press("w")
        terminal.wait_for("new value")
        terminal.press("1", ENTER)
        terminal.wait_for("y: write it")
        terminal.press("n")
        terminal.wait_for("nothing was written")
        terminal.press("q")
        self.ends(terminal, 0)
        self.assertIn(" 4711 ", plant.cli("acquire", "press-shop/press-1/mode").out + " ")

    def test_the_trend_runs_and_the_details_explain(self):
        terminal = self.start("watch", "press-shop/press-2", columns=100)
        terminal.wait_for("1 of 1 GOOD")
        terminal.press("t")
        terminal.wait_for(r"\[[▁▂▃▄▅▆▇█]{3,}\].*last \d+ values")
        terminal.press("q")
        self.ends(terminal, 0)

    def test_every_size_is_shown(self):
        terminal = self.watch(columns=120, rows=40)
        for columns, rows in [(20, 12), (20, 4), (10, 2), (1, 1), (300, 60), (80, 24)]:
            terminal.resize(columns, rows)
            terminal.wait_until(lambda text: text.strip(), f"something at {columns} x {rows}")
        terminal.wait_for(r"(?m)^channel +value unit +quality +age +refresh$")
        terminal.resize(20, 8)
        terminal.wait_for(r"(?m)^channel +value q$")
        terminal.wait_for(r"(?m)^  \w+ +\S+ G$")
        os.kill(terminal.pid, signal.SIGTERM)
        self.ends(terminal, 0)

    def test_control_c_and_control_z_give_the_terminal_back(self):
        terminal = self.watch()
        terminal.press("\x1a")
        terminal.wait_until(lambda _: terminal.is_stopped(), "it is stopped")
        terminal.wait_until(lambda _: RESTORED in terminal.said, "the first screen is back")
        self.assertEqual(terminal.modes_now(), terminal.modes)
        os.kill(terminal.pid, signal.SIGCONT)
        terminal.screen.reset()
        terminal.wait_for("of 5 GOOD")
        terminal.press("\x03")
        self.ends(terminal, 0)

    def test_control_z_is_not_lost_while_the_screen_is_drawn(self):
        terminal = self.watch(columns=300, rows=60)
        for _ in range(300):
            terminal.press("\x0c")  # draws the whole screen again
            self.assertFalse(terminal.ignores(signal.SIGTSTP))
            terminal.read(0.002)
        terminal.press("q")
        self.ends(terminal, 0)

    def test_a_crash_gives_the_terminal_back(self):
        terminal = self.watch()
        os.kill(terminal.pid, signal.SIGSEGV)
        self.ends(terminal, -signal.SIGSEGV)

    def test_without_colours_and_without_a_cursor(self):
        terminal = self.watch(NO_COLOR="1")
        terminal.press("q")
        self.ends(terminal, 0)
        self.assertNotRegex(terminal.said, rb"\x1b\[[0-9;]*3[0-7][;m]", "colours")
        for arguments, term in [(["--for", "3s"], "dumb"), (["--plain", "--for", "3s"], "xterm")]:
            terminal = self.start("watch", *arguments, TERM=term)
            self.assertEqual(terminal.wait_for_end(), 0)
            self.assertRegex(terminal.said, rb"press-shop/press-2/count  \d+  GOOD")
            self.assertNotIn(b"\x1b", terminal.said)
        terminal = self.start("watch", TERM="no-such-terminal", LANG="C")
        terminal.wait_for("5 of 5 GOOD")
        terminal.press("q")
        self.ends(terminal, 0)

    def test_status_lists_bad_ones_and_explains(self):
        terminal = self.start("status")
        terminal.wait_for(r"3/3 online +2 of 2 buses running")
        terminal.press(DOWN)
        terminal.wait_for(r"responds in \d+\.\d+ ms, spread")
        terminal.press("/", "scale")
        terminal.wait_until(lambda text: "press-1" not in text and "scale" in text, "only the scale")
        terminal.resize(20, 10)
        terminal.wait_for(r"(?m)^ scale +online$")
        terminal.press(ENTER, "q")
        self.ends(terminal, 0)
        terminal = self.start("status", "--plain")
        self.assertEqual(terminal.wait_for_end(), 0)
        self.assertNotIn(RESTORED, terminal.said)
        self.assertIn(b"of the last second", terminal.said)

    def test_no_bridge_is_said_on_the_screen(self):
        terminal = Terminal([os.path.join(BIN_DIR, "fieldcast"), "watch", "--domain", "7", "--interface", "127.0.0.1"])
        with terminal:
            terminal.wait_for("waiting for a bridge in DDS domain 7")
            terminal.press("q")
            self.assertEqual(terminal.wait_for_end(), 3)


if __name__ == "__main__":
    BIN_DIR = os.path.abspath(sys.argv.pop(1))
    unittest.main(verbosity=2)
