"""Every flag of every command stands in docs/command-line.md, in the synopsis of its command, and no other.

    flags_test.py PROGRAM SOURCE_FOLDER
"""

import re
import sys
import unittest

import documents

PROGRAM, ROOT = sys.argv[1], documents.root_of(sys.argv[2])
PAGE = ROOT / "docs" / "command-line.md"
FLAG = re.compile(r"--[a-z][\w-]*")


def synopses():
    """{command: flags} of the lines of code that begin with its name, and those that go on under them."""
    found, command = {}, None
    text = PAGE.read_text(encoding="utf-8")
    leaves = sorted(documents.leaf_commands(PROGRAM), key=len, reverse=True)
    for line in text.splitlines():
        if not line.startswith("    "):
            command = None
            continue
        if line.startswith("    softfinger "):
            words = tuple(line.split()[1:3])
            command = next((leaf for leaf in leaves if words[: len(leaf)] == leaf), None)
            if command is not None and command in found:
                raise AssertionError(f"{PAGE}: {' '.join(command)} has two synopses")
        if command is not None:
            found.setdefault(command, set()).update(FLAG.findall(line))
    return found


class Flags(unittest.TestCase):
    def test_every_synopsis_has_the_flags_of_its_command(self):
        found = synopses()
        leaves = documents.leaf_commands(PROGRAM)
        self.assertGreater(len(leaves), 15)
        for leaf in leaves:
            with self.subTest(" ".join(leaf)):
                self.assertIn(leaf, found, "has no synopsis")
                self.assertEqual(documents.flags(PROGRAM, leaf), found[leaf])

    def test_every_choice_of_a_flag_is_named(self):
        text = PAGE.read_text(encoding="utf-8")
        code = documents.SPAN.findall(text) + re.findall(r"^ {4}.*", text, re.M)
        named = set(re.findall(r"[\w-]+", " ".join(code)))
        flags_with_choices = 0
        for leaf in documents.leaf_commands(PROGRAM):
            for flag, choices in documents.choices(PROGRAM, leaf).items():
                flags_with_choices += 1
                self.assertEqual(choices - named, set(), f"{leaf} {flag}")
        self.assertGreater(flags_with_choices, 0)

    def test_every_flag_named_on_any_page_exists(self):
        known = {"--version", "--help"}
        for leaf in documents.leaf_commands(PROGRAM):
            known |= documents.flags(PROGRAM, leaf)
        named = 0
        for page in documents.pages(ROOT):
            for number, line in enumerate(page.read_text(encoding="utf-8").splitlines(), 1):
                for span in documents.SPAN.findall(line):
                    # Of other programs: named with them.
                    if not re.match(r"--|softfinger |build/softfinger ", span):
                        continue
                    for flag in FLAG.findall(span):
                        named += 1
                        self.assertIn(flag, known, f"{page.name}:{number}")
        self.assertGreater(named, 80)

    def test_flags_of_a_command_are_explained(self):
        """Of `run`, each in the table."""
        rows = re.findall(r"^\| (`--.*?) \|", documents.section(PAGE, "run"), re.M)
        self.assertEqual(set(FLAG.findall(" ".join(rows))), documents.flags(PROGRAM, ("run",)))


unittest.main(argv=sys.argv[:1])
