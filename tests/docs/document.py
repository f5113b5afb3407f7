"""Parses a Markdown document into the blocks that a reader would type, save or compare:
`parse(path, text)`.

The kind of a block follows from its language and the HTML comments on the lines before it
(README.md lists them). A block without a kind is a Fault with its place and its fix.
"""

import re
from dataclasses import dataclass, field

FILE_LANGUAGES = {"yaml", "yml", "csv", "cpp", "c", "cmake", "ini", "xml", "json", "idl", "python", "text"}
MARKERS = {
    "file": FILE_LANGUAGES,
    "tried by": FILE_LANGUAGES,
    "fragment": {"yaml", "yml"},
    "refused": {"yaml", "yml"},
    "runs until stopped": {"sh"},
    "exit code": {"sh"},
    "after a while": {"sh"},
    "in the installed system": {"sh"},
    "in the source tree": {"sh"},
    "output": {"text", "json"},
    "log": {"text"},
    "database": {"sql"},
    "picture": {"text"},
    "addresses": {"table"},
    "refused addresses": {"table"},
    "codes": {"table"},
}
# A block needs one of these; an `sh` block needs none.
KINDS = {"file", "fragment", "output", "log", "database", "picture"}
STOP = "stop"  # <!-- stop --> without a block: stops what runs until stopped

FENCE = re.compile(r"^(\s*)```+\s*([\w+-]*)\s*$")
COMMENT = re.compile(r"<!--\s*(.*?)\s*-->")


class Fault(Exception):
    """A fault of a document: `file:line: what is wrong, and the fix`."""


@dataclass
class Block:
    path: str
    line: int  # of its first line of text
    language: str
    text: str
    markers: dict = field(default_factory=dict)  # name -> argument after the colon, or ""

    def fault(self, words):
        return Fault(f"{self.path}:{self.line}: {words}")

    def commands(self):
        """Returns the lines of an `sh` block without comments, with continued lines joined."""
        joined = re.sub(r"\s*\\\n\s*", " ", self.text)
        return [line.strip() for line in joined.splitlines() if line.strip() and not line.strip().startswith("#")]


def marker_of(words):
    """Returns (name, argument) of a comment that is a marker, else None."""
    for name in [*MARKERS, STOP]:
        match = re.fullmatch(rf"{name}(?:[:,]\s*(.*))?", words)
        if match:
            return name, match.group(1) or ""
    return None


def parse(path, text):
    """Returns the blocks in order; a lone <!-- stop --> has the language "stop"."""
    blocks, markers, lines, number = [], {}, text.splitlines(), 0
    in_list = False
    while number < len(lines):
        line = lines[number]
        number += 1
        if fence := FENCE.match(line):
            block, number = _fenced(path, lines, number, fence, markers)
            blocks.append(block)
            markers = {}
        elif line.lstrip().startswith("<!--"):
            for words in COMMENT.findall(line):
                if (found := marker_of(words)) and found[0] == STOP:
                    blocks.append(Block(path, number, STOP, "", {}))
                elif found:
                    markers[found[0]] = found[1]
        elif line.startswith("|") and any("table" in MARKERS[marker] for marker in markers):
            begin = number
            while number < len(lines) and lines[number].startswith("|"):
                number += 1
            blocks.append(Block(path, begin, "table", "\n".join(lines[begin - 1:number]), markers))
            markers = {}
        elif line.strip():
            if markers:
                raise Fault(f"{path}:{number}: a marker ({', '.join(markers)}) stands on the lines right before its block")
            in_list = bool(re.match(r"\s*([-*]|\d+\.)\s", line)) or in_list and line.startswith(" ")
            if line.startswith("    ") and not in_list and not lines[number - 2].strip():
                raise Fault(f"{path}:{number}: an indented block: put it between ```sh (or another language) and ```")
    return blocks


def _fenced(path, lines, number, fence, markers):
    indent, language = fence.group(1), fence.group(2)
    begin = number
    while number < len(lines) and not lines[number].strip().startswith("```"):
        number += 1
    if number == len(lines):
        raise Fault(f"{path}:{begin}: the block has no end")
    text = "".join(line.removeprefix(indent) + "\n" for line in lines[begin:number])
    block = Block(path, begin + 1, language, text, markers)
    _check_kind(block)
    return block, number + 1


def _check_kind(block):
    for marker in block.markers:
        if block.language not in MARKERS[marker]:
            raise block.fault(f"a block of '{block.language}' cannot be marked <!-- {marker} -->")
    if not block.language:
        raise block.fault("a block without a language; write ```sh for commands, ```text for a picture or an output")
    if block.language != "sh" and not KINDS & set(block.markers):
        kinds = [kind for kind in MARKERS if kind in KINDS and block.language in MARKERS[kind]]
        if not kinds:
            raise block.fault(f"blocks of '{block.language}' are unknown; known are sh, {', '.join(sorted(FILE_LANGUAGES))}")
        ways = " or ".join(f"<!-- {kind}: NAME -->" if kind == "file" else f"<!-- {kind} -->" for kind in kinds)
        raise block.fault(f"this block of '{block.language}' is never tried; write {ways} on the line before it")


def unused_files(blocks):
    """Returns the blocks with a file that no command, file or fragment of the document names."""
    found = []
    for block in blocks:
        name = block.markers.get("file")
        if not name or "tried by" in block.markers or is_configuration(block):
            continue
        stem = name.split("/")[-1].split(".")[0]
        others = [other.text + " ".join(other.markers.values()) for other in blocks if other is not block]
        if not any(re.search(rf"\b{re.escape(stem)}\b", text) for text in others):
            found.append(block)
    return found


def is_configuration(block):
    """Returns whether it is a bridge configuration, which `fieldcast-bridge --check` can check."""
    return block.language in ("yaml", "yml") and bool(re.search(r"^bridge:", block.text, re.MULTILINE))


def inline_commands(path, text, programs):
    """Returns (place, command) for each `program ...` in the running text."""
    found, fenced = [], False
    for number, line in enumerate(text.splitlines(), 1):
        if line.lstrip().startswith("```"):
            fenced = not fenced
        if not fenced:
            for code in re.findall(r"`([^`]+)`", line):
                if code.split()[0] in programs and len(code.split()) > 1:
                    found.append((f"{path}:{number}", code))
    return found
