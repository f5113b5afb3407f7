"""Checks that a source still contains a log line that a document quotes.

In a document, WORDS IN CAPITALS and numbers stand for values. The line is split there; it is valid
if the literals of the sources contain every piece. The subject before the first colon (`press-shop:
`) is not part of a literal.
"""

import difflib
import functools
import os
import re

FOLDERS = ["bridge", "config", "core", "tools/cli", "tools/sim", "tools/program-port"]
LITERAL = re.compile(r'"((?:[^"\\\n]|\\.)*)"')
# Placeholders for values: CAPITALS, and numbers with their unit.
VALUE = re.compile(r"\b[A-Z][A-Z0-9_/]*\b|[-+]?\d[\d.,:]*\s?(?:ms|us|s|min|h|d|%|MB|GB|kB|B)?\b|\b\d\w+\b")
SUBJECT = re.compile(r"^[\w./-]+: ")


@functools.lru_cache(maxsize=None)
def _files(source_dir):
    """Returns the joined literals of each source file, one per line."""
    found = {}
    for folder in FOLDERS:
        for path, _, names in os.walk(os.path.join(source_dir, folder)):
            for name in (name for name in names if name.endswith((".cpp", ".hpp"))):
                with open(os.path.join(path, name), encoding="utf-8") as file:
                    text = re.sub(r'"\s*\n\s*"', "", file.read())
                found[os.path.join(path, name)] = "\n".join(LITERAL.findall(text))
    return found


def pieces(line):
    words = [piece.strip(" ()'\",;:?") for piece in VALUE.split(line)]
    return [piece for piece in words if re.search(r"[a-z]{2}", piece)]


def known(source_dir, line):
    """Returns whether a file has each piece, or each part between colons and commas, because some
    code puts `the port is closed: ` before another reason."""
    def said(piece):
        return any(piece in text for text in _files(source_dir).values())

    return any(bool(fixed) and all(said(piece) or all(map(said, re.split(r"[:,;] ", piece))) for piece in fixed)
               for fixed in (pieces(line), pieces(SUBJECT.sub("", line))))


def nearest(source_dir, line):
    literals = [literal for text in _files(source_dir).values() for literal in text.splitlines() if len(literal) > 8]
    return difflib.get_close_matches(line, literals, 1, 0.1)
