#!/usr/bin/env python3
"""Draws the screen of `fieldcast watch` as an SVG: the picture of README.md, from the plant of tools/demo.sh.

usage: tools/screen.py BIN_DIR docs/images/watch.svg [SECONDS]

Runs the demo in a terminal of its own, takes the last whole screen, ends the demo as Ctrl-C does.
"""

import fcntl
import os
import pty
import re
import select
import struct
import sys
import termios
import time
from xml.sax.saxutils import escape

ROWS, COLUMNS = 22, 100
CHARACTER, LINE = 7.8, 17  # pixels
STYLES = {"1": "font-weight='bold'", "2": "fill='#8b949e'", "31": "fill='#ff7b72'", "32": "fill='#7ee787'", "33": "fill='#f2cc60'"}


def record(command, seconds):
    """What the command writes to a terminal within so many seconds after its first screen."""
    pid, terminal = pty.fork()
    if pid == 0:
        os.environ["TERM"] = "xterm"
        os.execvp(command[0], command)
    fcntl.ioctl(terminal, termios.TIOCSWINSZ, struct.pack("HHHH", ROWS, COLUMNS, 0, 0))
    said, end = b"", time.monotonic() + 60
    begun = False
    while time.monotonic() < end:
        if select.select([terminal], [], [], 0.1)[0]:
            said += os.read(terminal, 65536)
        if not begun and b"\x1b[H" in said:
            begun, end = True, time.monotonic() + seconds
    os.write(terminal, b"\x03")
    try:
        while os.read(terminal, 65536):
            pass
    except OSError:  # the terminal is closed: the demo has ended
        pass
    os.waitpid(pid, 0)
    return said.decode("utf-8", "replace")


def last_screen(said):
    """The lines of the last screen that was drawn to its end."""
    screens = [text.split("\x1b[J")[0] for text in said.split("\x1b[H") if "\x1b[J" in text]
    return screens[-1].replace("\x1b[K", "").replace("\r", "").rstrip("\n").split("\n")


def spans(line):
    """[(style, text)] of a line with SGR sequences."""
    found, style = [], ""
    for code, text in re.findall(r"(?:\x1b\[(\d*)m)?([^\x1b]*)", line):
        style = STYLES.get(code, "") if code else style
        if text:
            found.append((style, text))
    return found


def svg(lines):
    width, height = int(COLUMNS * CHARACTER + 24), int(len(lines) * LINE + 24)
    out = [f"<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 {width} {height}' width='{width}' height='{height}'>",
           f"<rect width='{width}' height='{height}' rx='6' fill='#0d1117'/>",
           "<g font-family='DejaVu Sans Mono, Menlo, Consolas, monospace' font-size='13' fill='#e6edf3'>"]
    for number, line in enumerate(lines):
        column, y = 0, 12 + LINE * number + 12
        for style, text in spans(line):
            for word in re.finditer(r"\S+(?: \S+)*", text):
                x = 12 + (column + word.start()) * CHARACTER
                length = len(word.group()) * CHARACTER
                out.append(f"<text x='{x:.1f}' y='{y}' textLength='{length:.1f}' {style}>{escape(word.group())}</text>")
            column += len(text)
    return "\n".join([*out, "</g>", "</svg>", ""])


if __name__ == "__main__":
    bin_dir, target = os.path.abspath(sys.argv[1]), sys.argv[2]
    demo = os.path.join(os.path.dirname(os.path.abspath(__file__)), "demo.sh")
    picture = svg(last_screen(record([demo, "--bin", bin_dir], float(sys.argv[3]) if len(sys.argv) > 3 else 8)))
    with open(target, "w", encoding="utf-8") as file:
        file.write(picture)
