"""Holds the ways of ways.txt against the sources: each function exists in its file, is reached as the
list says, is short, and the counts keep their limits.

usage: ways_test.py SOURCE_DIR
"""

import os
import re
import sys
import unittest

SOURCE_DIR = ""
HERE = os.path.dirname(os.path.abspath(__file__))
MOST_LINES = 50  # of a function
# A comment, or the inner part of a text or a character.
NOT_CODE = re.compile(r"""//[^\n]*|/\*.*?\*/|(?<=")(?:\\.|[^"\\\n])*(?=")|(?<=')(?:\\.|[^'\\\n])(?=')""", re.DOTALL)


class Row:
    def __init__(self, line):
        reached, self.function, self.file = line.split()
        self.group, self.reached = reached.startswith("*"), reached.lstrip("*")
        self.name = self.function.partition("(")[0].split("::")[-1]


def read_ways(text):
    """{name of the way: (its limits as numbers, its rows)}"""
    ways = {}
    for line in (line.strip() for line in text.splitlines()):
        if line.startswith("way "):
            rows = []
            way = line.split()[1].rstrip(":")
        elif line.startswith("limits "):
            ways[way] = ([int(number) for number in re.findall(r"\d+", line)], rows)
        elif line and not line.startswith("#"):
            rows.append(Row(line))
    return ways


def end_of(code, begin, pair):
    """The place behind the bracket that closes the one at `begin`; `pair`: both as text."""
    depth = 0
    for bracket in re.compile("[" + re.escape(pair) + "]").finditer(code, begin):
        depth += 1 if bracket.group() == pair[0] else -1
        if depth == 0:
            return bracket.end()
    return len(code)


def definitions(name, code):
    """[(parameters, body)] of the functions of this name; the body of a pure virtual function is empty."""
    found = []
    for match in re.finditer(rf"\b{re.escape(name)}\(", code):
        behind = end_of(code, match.end() - 1, "()")
        tail = re.compile(r"(?:\s|const|noexcept|override|final)*(= 0;|\{)").match(code, behind)
        if tail:
            body = code[tail.end() - 1:end_of(code, tail.end() - 1, "{}")] if tail.group(1) == "{" else ""
            found.append((code[match.end():behind - 1], body))
    return found


def body_of(function, text):
    """The body of `Class::function(Parameter)` in the text of a file; None if the file does not define it."""
    code = NOT_CODE.sub("", text)
    path, _, parameter = function.rstrip(")").partition("(")
    scope, _, name = path.rpartition("::")
    found = definitions(path, code)
    for match in re.finditer(rf"\b(?:class|struct) (?:\w+::)*{scope.split('::')[-1]}\b[^;{{]*{{", code) if scope else []:
        found += definitions(name, code[match.end():end_of(code, match.end() - 1, "{}")])
    right = (body for parameters, body in found if not parameter or re.search(rf"\b{parameter}\b", parameters))
    return next(right, None)


def counts(rows):
    functions = {row.function: row for row in reversed(rows)}
    return [len(functions), sum(not row.group for row in functions.values()), len({row.file for row in rows}),
            sum(row.reached == "indirect" for row in rows), sum(row.reached == "hop" for row in rows)]


def faults(rows, read):
    """The rows that the sources contradict. `read(path)` returns the text of a file."""
    found, bodies = [], []
    for row in rows:
        body = body_of(row.function, read(row.file))
        if body is None:
            found.append(f"{row.file} does not define {row.function}")
            continue
        if row.reached == "call" and not any(re.search(rf"\b{row.name}(<[^;()]*>)?\(", above) for above in bodies):
            found.append(f"no function above {row.function} calls it")
        if body.count("\n") + 1 > MOST_LINES:
            found.append(f"{row.function} has {body.count(chr(10)) + 1} lines; at most {MOST_LINES} are allowed")
        bodies.append(body)
    return found


def read_source(path):
    with open(os.path.join(SOURCE_DIR, path), encoding="utf-8") as file:
        return file.read()


class Ways(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        with open(os.path.join(HERE, "ways.txt"), encoding="utf-8") as file:
            cls.ways = read_ways(file.read())

    def test_are_those_of_the_sources(self):
        for way, (_, rows) in self.ways.items():
            with self.subTest(way):
                self.assertEqual(faults(rows, read_source), [])

    def test_keep_their_limits(self):
        self.assertEqual(list(self.ways), ["command", "sample"])
        for way, (limits, rows) in self.ways.items():
            with self.subTest(way):
                told = "functions, without a group, files, indirect, hops"
                print(f"{way}: {counts(rows)} of {limits} ({told})")
                for most, count in zip(limits, counts(rows), strict=True):
                    self.assertLessEqual(count, most, told)


class Reader(unittest.TestCase):
    SOURCE = """
        struct Box { void put(int a) { if (a) { keep(a); } } int size() const; virtual void open() = 0; };
        int Box::size() const { return count("}"); }  // size() of size_of()
        void keep(Text text) { store(text); }
        void keep(int a) { log(a); }
    """

    def faults(self, *lines):
        return faults([Row(line + " box.cpp") for line in lines], lambda path: self.SOURCE)

    def test_finds_definitions_and_calls(self):
        self.assertEqual(self.faults("first Box::put", "call keep(int)", "indirect Box::open", "then Box::size"), [])

    def test_reports_a_function_that_does_not_exist_or_that_nothing_above_calls(self):
        self.assertEqual(self.faults("first Box::take"), ["box.cpp does not define Box::take"])
        self.assertEqual(self.faults("first keep(Float)"), ["box.cpp does not define keep(Float)"])
        self.assertEqual(self.faults("first keep(int)", "call Box::put"), ["no function above Box::put calls it"])

    def test_counts_a_function_once_and_each_jump(self):
        rows = [Row(line) for line in ("first A::a x.cpp", "*indirect B::b x.cpp", "hop A::a y.cpp", "call C::c y.cpp")]
        self.assertEqual(counts(rows), [3, 2, 2, 1, 1])


if __name__ == "__main__":
    SOURCE_DIR = sys.argv[1]
    unittest.main(argv=sys.argv[:1], verbosity=2)
