"""A page and a route of the station, and a metric of a bridge, are few files each: the table "To add something" of docs/architecture.md.

usage: additions_test.py SOURCE_DIR
"""

import os
import re
import sys
import unittest

MOST_FILES = 4
FOLDERS = ("bridge", "tools", "docs", "tests/bridge", "tests/tools/station")
ENDINGS = (".cpp", ".hpp", ".ts", ".css", ".yaml", ".md", ".mjs", ".py")


def read(path):
    with open(os.path.join(SOURCE_DIR, path), encoding="utf-8") as file:
        return file.read()


def tree():
    """{path: text} of the files that an addition may touch."""
    found = {}
    for root in FOLDERS:
        for folder, _, names in os.walk(os.path.join(SOURCE_DIR, root)):
            for name in names:
                if name.endswith(ENDINGS):
                    path = os.path.relpath(os.path.join(folder, name), SOURCE_DIR).replace(os.sep, "/")
                    found[path] = read(path)
    return found


def files_with(pattern, files):
    return sorted(path for path, text in files.items() if re.search(pattern, text, re.MULTILINE))


class Additions(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.files = tree()

    def test_a_page_is_its_own_file_its_style_and_one_row(self):
        page = "tools/station/page/"
        names = re.findall(r"\{ name: '(\w+)', module: ", read(page + "src/pages.ts"))
        self.assertGreater(len(names), 8)
        for name in names:
            own = {path for path in self.files if re.fullmatch(rf"{page}(src/\w+|styles)/{name}\.(ts|css)", path)}
            # Links to a page are no part of it.
            naming = files_with(rf"pages/{name}['.]|styles/{name}\.css|'{name}\.title': |name: '{name}'", self.files)
            touched = own | set(naming)
            self.assertIn(page + "src/pages.ts", touched)
            self.assertLess(len(touched), MOST_FILES, f"{name}, with its test: {sorted(touched)}")

    def test_a_route_is_its_handler_its_row_its_description_and_its_test(self):
        rows = re.findall(r'\{Method::\w+, "([\w/.]+)", Access::\w+, (\w+)', read("tools/station/api/api_routes.hpp"))
        self.assertGreater(len(rows), 15)
        program = {path: text for path, text in self.files.items() if path.startswith("tools/station/") and "/page/" not in path
                   and not path.endswith(".md")}
        for path, handler in rows:
            touched = files_with(rf"\b{handler}\b|\"{re.escape(path)}\"|^  {re.escape(path)}:$", program)
            self.assertLess(len(touched), MOST_FILES, f"{path}, with its test: {touched}")
            self.assertEqual(len(files_with(rf"\bvoid {handler}\(", program)), 1, handler)

    def test_a_metric_is_its_row_its_line_in_the_manual_and_its_test(self):
        names = set(re.findall(r'"(fieldcast_\w+)", Kind::', read("bridge/metrics/metrics_text.cpp")))
        self.assertGreater(len(names), 30)
        named = {path: {word.removesuffix("_total") for word in re.findall(r"\bfieldcast_\w+", text)}
                 for path, text in self.files.items() if not path.startswith("tests/")}
        for name in names:
            touched = sorted(path for path, words in named.items() if name in words)
            self.assertIn("bridge/metrics/metrics_text.cpp", touched)
            self.assertLess(len(touched), MOST_FILES, f"{name}, with its test: {touched}")


if __name__ == "__main__":
    SOURCE_DIR = sys.argv[1]
    unittest.main(argv=sys.argv[:1], verbosity=2)
