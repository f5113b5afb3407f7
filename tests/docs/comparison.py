"""Compares a program's output with a document. Numbers, instants and column widths may differ; a
line `...` matches any lines, `...` at the end of a line the rest of it."""

import re

NUMBER = re.compile(r"[-+]?\d+(?:[.,:]\d+)*(?:e[-+]?\d+)?")


def general(line):
    line = re.sub(r"\d{4}-\d\d-\d\d[T ]\d\d:\d\d:\d\d(?:\.\d+)?Z?", "INSTANT", line)
    return re.sub(r"\s+", " ", NUMBER.sub("0", line)).strip()


def _same(shown, said):
    if shown.endswith("...") and shown != "...":
        return said.startswith(shown[:-3].rstrip())
    return shown == said


def difference(shown, said, ordered=True):
    """Returns the first line that only one of document and program has, or None."""
    want = [general(line) for line in shown.splitlines() if line.strip()]
    have = [general(line) for line in said.splitlines() if line.strip()]
    if not ordered:
        want, have = sorted(want), sorted(have)
    at, anywhere = 0, False
    for line in want:
        if line == "...":
            anywhere = True
            continue
        while at < len(have) and anywhere and not _same(line, have[at]):
            at += 1
        if at == len(have):
            return f"not said: {line}"
        if not _same(line, have[at]):
            return f"shown: {line}\n said: {have[at]}"
        at, anywhere = at + 1, False
    return None if at == len(have) or anywhere else f"not shown: {have[at]}"
