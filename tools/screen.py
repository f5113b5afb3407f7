#!/usr/bin/env python3
"""Draws the screen of `fieldcast watch` with the plant of tools/demo.sh as an SVG, for README.md.

usage: tools/screen.py BIN_DIR docs/images/watch.svg [SECONDS]

Runs the demo in a pseudo-terminal, records the last complete screen and ends the demo with Ctrl-C.
"""

import os
import re
import sys
import time
from xml.sax.saxutils import escape

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "tests", "tools"))
from terminal import Terminal  # noqa: E402

ROWS, COLUMNS = 22, 100
CHARACTER, LINE = 7.8, 17  # pixels
INVERSE = "class='inverse'"
COLOURS = {"red": "#ff7b72", "green": "#7ee787", "brown": "#f2cc60"}


def record(command, seconds):
    """Returns the lines of the screen this many seconds after the first values: a list of (style, text) for each."""
    with Terminal(command, COLUMNS, ROWS) as terminal:
        terminal.wait_for("[1-9][0-9]* of [1-9][0-9]* GOOD", 60)
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            terminal.read(0.2)
        lines = [spans(terminal.screen.buffer[row]) for row in range(ROWS)]
        terminal.press("\x03")
        terminal.wait_for_end()
        return lines


def spans(row):
    """Returns a row of cells as a list of (style, text)."""
    found = []
    for column in range(COLUMNS):
        cell = row[column]
        style = "font-weight='bold' " if cell.bold else ""
        style += f"fill='{COLOURS[cell.fg]}' " if cell.fg in COLOURS else ""
        style += INVERSE if cell.reverse else ""
        if found and found[-1][0] == style:
            found[-1] = (style, found[-1][1] + cell.data)
        else:
            found.append((style, cell.data))
    return found


def svg(lines):
    width, height = int(COLUMNS * CHARACTER + 24), int(len(lines) * LINE + 24)
    out = [f"<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 {width} {height}' width='{width}' height='{height}'>",
           f"<rect width='{width}' height='{height}' rx='6' fill='#0d1117'/>",
           "<g font-family='DejaVu Sans Mono, Menlo, Consolas, monospace' font-size='13' fill='#e6edf3'>"]
    for number, line in enumerate(lines):
        column, y = 0, 12 + LINE * number + 12
        for style, text in line:
            if INVERSE in style:
                out.append(f"<rect x='{12 + column * CHARACTER:.1f}' y='{y - 13}' width='{len(text) * CHARACTER:.1f}' height='{LINE}' fill='#30363d'/>")
            for word in re.finditer(r"\S+(?: \S+)*", text):
                x = 12 + (column + word.start()) * CHARACTER
                length = len(word.group()) * CHARACTER
                out.append(f"<text x='{x:.1f}' y='{y}' textLength='{length:.1f}' {style}>{escape(word.group())}</text>")
            column += len(text)
    return "\n".join([*out, "</g>", "</svg>", ""])


if __name__ == "__main__":
    bin_dir, target = os.path.abspath(sys.argv[1]), sys.argv[2]
    demo = os.path.join(os.path.dirname(os.path.abspath(__file__)), "demo.sh")
    picture = svg(record([demo, "--no-page", "--bin", bin_dir], float(sys.argv[3]) if len(sys.argv) > 3 else 8))
    with open(target, "w", encoding="utf-8") as file:
        file.write(picture)
