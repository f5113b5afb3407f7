"""Finds places of C++ sources where a small change makes a mutant, with clang's syntax tree."""

import collections
import re

from clang.cindex import CursorKind, Index

# A mutant replaces the bytes from `start` to `end` by `text`, in which {} is the number of the mutant.
Point = collections.namedtuple("Point", "file start end line rule text")

PAIRS = "< <=,> >=,== !=,+ -,* /,&& ||,<< >>,& |,+= -=,*= /="
OPERATORS = {"%": "*", **{a: b for pair in PAIRS.split(",") for a, b in (pair.split(), pair.split()[::-1])}}
COMMENT = re.compile(rb"//[^\n]*|/\*.*?\*/", re.DOTALL)
# The compiler evaluates these, and the mutant would never run.
CONSTANT = {CursorKind.STATIC_ASSERT, CursorKind.ENUM_CONSTANT_DECL, CursorKind.TEMPLATE_NON_TYPE_PARAMETER, CursorKind.CASE_STMT}
TWO_SIDES = {CursorKind.BINARY_OPERATOR, CursorKind.COMPOUND_ASSIGNMENT_OPERATOR}
STATEMENTS = {*TWO_SIDES, CursorKind.CALL_EXPR, CursorKind.UNARY_OPERATOR, CursorKind.UNEXPOSED_EXPR}


class Finder:
    """Collects the points of all files below `root`; a header counts once, however many sources include it."""

    def __init__(self, root):
        self.root, self.points, self.texts = root + "/", {}, {}

    def read(self, sources, arguments):
        """Reads sources that can be compiled together."""
        together = "".join(f'#include "{source}"\n' for source in sources)
        unit = Index.create().parse("together.cpp", arguments, unsaved_files=[("together.cpp", together)])
        for cursor in unit.cursor.get_children():
            if cursor.location.file is not None and cursor.location.file.name.startswith(self.root):
                self._walk(cursor, is_body=False)

    def _walk(self, cursor, is_body):
        """`is_body`: within a function, where code runs."""
        if cursor.kind in CONSTANT:
            children = list(cursor.get_children())
            if cursor.kind == CursorKind.CASE_STMT and children:
                self._walk(children[-1], is_body)
            return
        if cursor.kind == CursorKind.VAR_DECL and (not is_body or re.search(rb"constexpr|static", self._head(cursor))):
            return
        if is_body:
            self._consider(cursor)
        body = is_body or cursor.kind == CursorKind.COMPOUND_STMT
        for child in cursor.get_children():
            self._walk(child, body)

    def _text(self, name):
        if name not in self.texts:
            with open(name, "rb") as file:
                self.texts[name] = file.read()
        return self.texts[name]

    def _place(self, cursor):
        """Returns (file, start, end); None for text that a macro makes."""
        start, end = cursor.extent.start, cursor.extent.end
        if start.file is None or end.file is None or start.file.name != end.file.name or start.offset >= end.offset:
            return None
        return (start.file.name, start.offset, end.offset) if start.file.name.startswith(self.root) else None

    def _head(self, cursor):
        place = self._place(cursor)
        return self._text(place[0])[max(0, place[1] - 12):place[1] + 24] if place else b""

    def _add(self, place, rule, text):
        name, start, end = place
        line = self._text(name).count(b"\n", 0, start) + 1
        if not re.search(rb"assert\(|\breserve\(", self._text(name).split(b"\n")[line - 1]):  # neither changes a result
            self.points.setdefault((name, start, end, rule), Point(name, start, end, line, rule, text))

    def _consider(self, cursor):
        place = self._place(cursor)
        if place is None:
            return
        whole = self._text(place[0])
        text = whole[place[1]:place[2]]
        if cursor.kind == CursorKind.INTEGER_LITERAL and re.fullmatch(rb"(0x)?[0-9a-fA-F']+[uUlL]*", text):
            if whole[place[2]:place[2] + 1] == b">" and re.search(rb"[<,] ?$", whole[place[1] - 2:place[1]]):
                return  # an argument of a template, which the compiler evaluates
            self._add(place, "constant", b"(fc_mutant({}) ? %s + 1 : %s)" % (text, text))
        elif cursor.kind == CursorKind.CXX_BOOL_LITERAL_EXPR and text in (b"true", b"false"):
            self._add(place, "constant", b"(fc_mutant({}) != %s)" % text)
        elif cursor.kind in TWO_SIDES:
            self._operator(place, list(cursor.get_children()))
        elif cursor.kind == CursorKind.CALL_EXPR and cursor.spelling.startswith("operator"):
            self._operator(place, list(cursor.get_arguments()))
        elif cursor.kind == CursorKind.IF_STMT:
            self._condition(cursor)
        elif cursor.kind == CursorKind.COMPOUND_STMT:
            for child in cursor.get_children():
                self._statement(child)

    def _operator(self, place, sides):
        places = [self._place(side) for side in sides]
        if len(places) != 2 or None in places or len({place[0], places[0][0], places[1][0]}) != 1:
            return
        text = self._text(place[0])
        left, right = text[places[0][1]:places[0][2]], text[places[1][1]:places[1][2]]
        sign = COMMENT.sub(b"", text[places[0][2]:places[1][1]]).strip().decode("ascii", "replace")
        if sign in OPERATORS and (place[1], place[2]) == (places[0][1], places[1][2]):
            other = OPERATORS[sign].encode()
            # One line more than before would shift the lines of the compiler's messages.
            changed = COMMENT.sub(b"", b"%s %s %s" % (left, other, right)).replace(b"\n", b" ")
            self._add(place, f"{sign} to {other.decode()}", b"(fc_mutant({}) ? (%s) : (%s))" % (changed, text[place[1]:place[2]]))

    def _condition(self, cursor):
        first = next(cursor.get_children(), None)
        place = self._place(first) if first else None
        if place is None or first.kind in (CursorKind.DECL_STMT, CursorKind.VAR_DECL):
            return
        text = self._text(place[0])
        if re.search(rb"\bif \($", text[max(0, place[1] - 8):place[1]]) and text[place[2]:place[2] + 1] == b")":
            self._add(place, "condition negated", b"fc_mutant({}) != static_cast<bool>(%s)" % text[place[1]:place[2]])

    def _statement(self, cursor):
        place = self._place(cursor)
        if place is None or cursor.kind not in STATEMENTS:
            return
        text = self._text(place[0])
        if text[place[2]:place[2] + 1] == b";":
            self._add((place[0], place[1], place[2] + 1), "statement removed", b"if (!fc_mutant({})) { %s; }" % text[place[1]:place[2]])
