"""Tests that the tool for documents finds planted faults, and that every document has its test.

usage: tool_test.py SOURCE_DIR DOCUMENT..
"""

import os
import sys
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import log_lines
import tables
from comparison import difference
from document import Fault, inline_commands, parse, unused_files
from fragment import whole

SOURCE_DIR, DOCUMENTS = "", []


def blocks(text):
    return parse("a.md", text)


class Parsing(unittest.TestCase):
    def test_commands_are_lines_without_comments(self):
        block, = blocks("text\n\n```sh\n# first\na --b \\\n  c\n\nz\n```\n")
        self.assertEqual((block.line, block.commands()), (4, ["a --b c", "z"]))

    def test_markers_belong_to_the_next_block(self):
        first, stop, second = blocks("<!-- runs until stopped: READY -->\n```sh\na\n```\n<!-- stop -->\n"
                                     "<!-- file: b/c.yaml -->\n<!-- refused: no -->\n```yaml\nz: 1\n```\n")
        self.assertEqual(first.markers, {"runs until stopped": "READY"})
        self.assertEqual((stop.language, stop.line), ("stop", 5))
        self.assertEqual(second.markers, {"file": "b/c.yaml", "refused": "no"})

    def test_a_marker_may_have_an_argument_behind_a_comma(self):
        block, = blocks("<!-- in the installed system, with systemd -->\n```sh\nsystemctl\n```\n")
        self.assertEqual(block.markers, {"in the installed system": "with systemd"})

    def test_blocks_in_lists_lose_their_indent(self):
        block, = blocks("1. one\n\n   ```sh\n   a\n     b\n   ```\n")
        self.assertEqual(block.text, "a\n  b\n")

    def test_a_block_that_nothing_tries_is_a_fault_that_says_where(self):
        for text, words in [("x\n\n```yaml\na: 1\n```\n", "a.md:4: this block of 'yaml' is never tried"),
                            ("```\na\n```\n", "a.md:2: a block without a language"),
                            ("```rust\na\n```\n", "a.md:2: blocks of 'rust' are unknown"),
                            ("<!-- output -->\n```sh\na\n```\n", "cannot be marked"),
                            ("<!-- output -->\ntext\n", "a.md:2: a marker"),
                            ("```sh\na\n", "has no end"),
                            ("text\n\n    command\n", "a.md:3: an indented block")]:
            with self.assertRaises(Fault, msg=text) as fault:
                blocks(text)
            self.assertIn(words, str(fault.exception))

    def test_a_marked_table_is_a_block_and_its_rows_have_columns(self):
        table, = blocks("<!-- addresses: dtc, threshold: 0 -->\n| address | type |\n| --- | --- |\n| `bit:7` | |\n\n| a | table |\n")
        self.assertEqual((table.language, table.line, table.markers), ("table", 2, {"addresses": "dtc, threshold: 0"}))
        self.assertEqual(tables.rows(table), [{"address": "`bit:7`", "type": ""}])
        configuration = tables.Configuration(table.markers["addresses"])
        for address, type_name in tables.channels(tables.rows(table)[0]):
            configuration.add({}, address, type_name, True)
        self.assertIn('at: "bit:7", access: read-write }', configuration.text())
        self.assertIn("options: { threshold: 0 }", configuration.text())

    def test_a_file_that_nothing_uses_is_found(self):
        text = "<!-- file: a.csv -->\n```csv\nx\n```\n<!-- file: b.csv -->\n```csv\nx\n```\n```sh\ncat b.csv\n```\n"
        self.assertEqual([block.markers["file"] for block in unused_files(blocks(text))], ["a.csv"])
        self.assertEqual(unused_files(blocks(text.replace("a.csv -->", "a.csv -->\n<!-- tried by: x.py -->"))), [])

    def test_commands_in_the_text_are_found(self):
        text = "Say `fieldcast plan --json` or `fieldcast`.\n```sh\n`fieldcast no`\n```\n"
        self.assertEqual(inline_commands("a.md", text, ["fieldcast"]), [("a.md:1", "fieldcast plan --json")])


class Comparing(unittest.TestCase):
    def test_numbers_instants_and_widths_may_differ(self):
        self.assertIsNone(difference("a   1.5 GOOD\n", "a -17 GOOD\n"))
        self.assertIsNone(difference("at 2026-11-22T10:00:00.123Z\n", "at 2027-01-01T00:00:00Z\n"))
        self.assertIsNone(difference("a\n...\nz\n", "a\nb\nc\nz\n"))
        self.assertIsNone(difference("a\nb ...\n...\n", "a\nb c\nz\n"))

    def test_the_order_may_differ_where_the_document_says_so(self):
        self.assertIsNotNone(difference("b\na\n", "a\nb\n"))
        self.assertIsNone(difference("b\na\n", "a\nb\n", ordered=False))

    def test_words_may_not(self):
        self.assertIn("shown: a 0 GOOD", difference("a 1 GOOD\n", "a 1 UNCERTAIN\n"))
        self.assertIn("not said: b", difference("a\nb\n", "a\n"))
        self.assertIn("not shown: b", difference("a\n", "a\nb\n"))
        self.assertIn("not said: z", difference("a\n...\nz\n", "a\nb\n"))


class Fragments(unittest.TestCase):
    def test_are_made_whole_and_keep_their_line_numbers(self):
        self.assertEqual(whole("store: { path: a.db }\n", "").splitlines()[0], "store: { path: a.db }")
        text = whole("- { name: a, at: VW0, type: int16 }\n", "channels s7-ppi")
        self.assertIn("protocol: s7-ppi\n", text)
        self.assertIn("      - channels:\n          - { name: a, at: VW0, type: int16 }\n        name: meter\n", text)
        with self.assertRaises(ValueError):
            whole("a: 1\n", "plant")


class LogLines(unittest.TestCase):
    def test_a_line_is_known_by_what_a_source_says(self):
        self.assertTrue(log_lines.known(SOURCE_DIR, "press-shop: not served here: OTHER serves a bus of this name in DDS domain 7, where names of buses are unique. This bridge takes it "))
        self.assertFalse(log_lines.known(SOURCE_DIR, "the moon is made of cheese"))
        self.assertFalse(log_lines.known(SOURCE_DIR, "17 %"))


class Documents(unittest.TestCase):
    def test_each_has_its_test(self):
        folder = os.path.join(SOURCE_DIR, "docs")
        found = {os.path.relpath(os.path.join(path, name), SOURCE_DIR)
                 for path, _, names in os.walk(folder) for name in names if name.endswith(".md")}
        self.assertEqual(found - set(DOCUMENTS), set(), "add a row to tests/docs/CMakeLists.txt")


if __name__ == "__main__":
    SOURCE_DIR, DOCUMENTS = sys.argv[1], sys.argv[2:]
    unittest.main(argv=sys.argv[:1], verbosity=2)
