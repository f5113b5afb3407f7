"""The comments, messages and documents avoid the words that CONTRIBUTING.md lists (language.py).

usage: language_test.py SOURCE_DIR
"""

import sys
import unittest

import language

SOURCE_DIR = ""


class Rules(unittest.TestCase):
    """Each rule finds a planted word, and only where it is prose."""

    def words(self, path, text):
        return [word for _, _, word, _ in language.places(path, text)]

    def test_a_word_in_a_comment_is_found(self):
        self.assertEqual(len(self.words("a.cpp", "int a;  // begins anew\n")), 1)
        self.assertEqual(self.words("a.cpp", "int anew;  // begins again\n"), [])

    def test_a_word_in_a_message_is_found(self):
        self.assertEqual(len(self.words("a.cpp", 'log("the device is gone");\n')), 1)

    def test_a_word_in_a_document_is_found_but_not_in_code(self):
        self.assertEqual(len(self.words("a.md", "The device answers.\n")), 1)
        self.assertEqual(self.words("a.md", "See `answer_time`.\n\n```text\nanswer\n```\n"), [])

    def test_a_script_and_a_configuration_have_comments(self):
        self.assertEqual(len(self.words("a.py", "x = 1  # told once\n")), 1)
        self.assertEqual(len(self.words("a.yaml", "x: 1  # told once\n")), 1)


class Tree(unittest.TestCase):
    def test_the_tree_has_none_but_the_right_uses(self):
        found = [place for place in language.all_places(SOURCE_DIR) if not language.is_right_use(*place)]
        self.assertEqual(found, [], "\n" + "\n".join(f"{path}:{number}: {prose}" for path, number, _, prose in found))


if __name__ == "__main__":
    SOURCE_DIR = sys.argv[1]
    unittest.main(argv=sys.argv[:1], verbosity=2)
