"""Holds the boundaries of the folders: faces, arrows, no cycle, sizes (boundaries.py).

usage: boundaries_test.py SOURCE_DIR
"""

import os
import re
import sys
import unittest

import boundaries

SOURCE_DIR = ""


class Rules(unittest.TestCase):
    """Each rule finds a planted fault."""

    FILES = {
        "core/low/a.hpp": "",
        "core/low/hidden.hpp": "",
        "core/high/b.cpp": '#include "core/low/a.hpp"\n#include <vector>\n',
    }
    READMES = {"core/low": "# low\n\nFace: `a.hpp`.\nMay use: nothing.\n", "core/high": "# high\n\nFace: nothing.\nMay use: `core/low`.\n"}

    def test_a_tree_without_fault_has_none(self):
        self.assertEqual(boundaries.boundary_faults(self.FILES, self.READMES), [])

    def test_a_header_that_is_not_in_the_face_is_found(self):
        files = dict(self.FILES, **{"core/high/c.cpp": '#include "core/low/hidden.hpp"\n'})
        self.assertEqual(len(boundaries.boundary_faults(files, self.READMES)), 1)

    def test_a_new_arrow_is_found(self):
        files = dict(self.FILES, **{"core/other/x.hpp": "", "core/low/c.cpp": '#include "core/other/x.hpp"\n'})
        readmes = dict(self.READMES, **{"core/other": "Face: `x.hpp`.\nMay use: nothing.\n"})
        self.assertIn("core/other is used", boundaries.boundary_faults(files, readmes)[0])

    def test_a_name_that_nothing_needs_is_found(self):
        readmes = dict(self.READMES, **{"core/low": "Face: `a.hpp`, `hidden.hpp`.\nMay use: nothing.\n"})
        self.assertIn("no include needs", boundaries.boundary_faults(self.FILES, readmes)[0])

    def test_a_folder_without_readme_is_found(self):
        self.assertIn("has no README.md", boundaries.boundary_faults(self.FILES, {"core/low": self.READMES["core/low"]})[0])

    def test_a_cycle_is_found(self):
        self.assertEqual(boundaries.cycle_of({"a": {"b"}, "b": {"c"}, "c": set()}), [])
        self.assertEqual(boundaries.cycle_of({"a": {"b"}, "b": {"c"}, "c": {"b"}}), ["b", "c", "b"])

    def test_a_long_file_and_a_large_folder_are_found(self):
        self.assertEqual(len(boundaries.size_faults({"core/a/b.cpp": "x\n" * 501})), 1)
        large = {f"core/{folder}/{name}.cpp": "" for folder in "abcde" for name in range(26)}
        self.assertEqual(len(boundaries.size_faults(large)), 1)

    def test_a_name_that_no_source_declares_is_found(self):
        document = "## The way of a sample\n\n`Reader::take` and `Gone`, not `word`.\n\n## Threads\n`Other`\n"
        self.assertEqual(boundaries.unknown_names(document, {"a.hpp": "class Reader { void take(); };"}), ["Gone"])
        self.assertEqual(boundaries.unknown_names(document, {"a.hpp": "class Reader {}; class Gone {};"}), ["Reader::take"])

    def test_a_wrapped_line_is_read_whole(self):
        names = [f"a_long_name_of_a_header_{number}.hpp" for number in range(12)]
        text = boundaries.wrapped(boundaries.FACE, names) + "\n" + boundaries.wrapped(boundaries.USES, ["core/base"])
        self.assertEqual(boundaries.names_after(boundaries.FACE, text), names)
        self.assertEqual(boundaries.names_after(boundaries.USES, text), ["core/base"])


class Tree(unittest.TestCase):
    """The tree keeps the rules."""

    def test_the_tree_has_no_fault(self):
        self.assertEqual(boundaries.all_faults(SOURCE_DIR), [])

    def test_the_picture_of_the_architecture_names_every_folder(self):
        with open(os.path.join(SOURCE_DIR, "docs", "architecture.md"), encoding="utf-8") as file:
            named = set(re.findall(r"`((?:core|config|bridge|tools)(?:/[a-z0-9_/-]+)?)`", file.read()))
        folders = set(boundaries.wanted(boundaries.read_tree(SOURCE_DIR)))
        self.assertEqual(sorted(folders - named), [], "folders that docs/architecture.md does not name")

    def test_the_ways_of_the_architecture_name_what_exists(self):
        with open(os.path.join(SOURCE_DIR, "docs", "architecture.md"), encoding="utf-8") as file:
            document = file.read()
        self.assertGreater(document.count("## The way of "), 2)
        self.assertEqual(boundaries.unknown_names(document, boundaries.read_tree(SOURCE_DIR)), [])


if __name__ == "__main__":
    SOURCE_DIR = sys.argv[1]
    unittest.main(argv=sys.argv[:1], verbosity=2)
