"""docs/figures.md and the program that writes it.

usage: figures_test.py SOURCE_DIR
"""

import pathlib
import sys
import unittest

SOURCE = pathlib.Path(sys.argv.pop())
sys.path.insert(0, str(SOURCE / "tools/bench"))
import figures  # noqa: E402

DOCUMENT = """Text.
<!-- figures: a_bench 1 -->
old
<!-- end -->
<!-- figures: a_bench 16 -->
kept
<!-- end -->
"""


class Figures(unittest.TestCase):
    def test_a_pattern_chooses_commands(self):
        self.assertEqual(figures.commands_of(DOCUMENT), ["a_bench 1", "a_bench 16"])
        self.assertEqual(figures.commands_of(DOCUMENT, "16"), ["a_bench 16"])
        self.assertEqual(figures.commands_of(DOCUMENT, "other"), [])

    def test_only_the_place_of_the_command_is_replaced(self):
        text = figures.block("a_bench 1", "10 %\r100 %\nratio 0.98\n", 2.4, "machine")
        self.assertEqual(figures.replaced(DOCUMENT, "a_bench 1", text), """Text.
<!-- figures: a_bench 1 -->
machine; 2 s.

<!-- picture -->
```text
$ a_bench 1
100 %
ratio 0.98
```
<!-- end -->
<!-- figures: a_bench 16 -->
kept
<!-- end -->
""")

    def test_output_cannot_end_its_block(self):
        self.assertEqual(figures.block("b", "```\n", 0, "m").count("```"), 2)

    def test_each_command_of_the_document_is_a_bench_of_the_tree(self):
        commands = figures.commands_of((SOURCE / "docs/figures.md").read_text(encoding="utf-8"))
        self.assertGreater(len(commands), 40)
        for command in commands:
            script = next((word for word in command.split() if word.endswith(".py")), None)
            self.assertTrue((SOURCE / (script or f"tools/bench/{command.split()[0]}.cpp")).exists(), command)


if __name__ == "__main__":
    unittest.main()
