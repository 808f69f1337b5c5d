"""Every test that docs/hazards.md and docs/safety.md name is there, and no row of hazards.md is without one.

    hazards_test.py PROGRAM SOURCE_FOLDER
"""

import re
import sys
import unittest

import documents

ROOT = documents.root_of(sys.argv[2])
NAMED = re.compile(r"`([A-Z]\w+)\.(\w+|\*)`")
WRITTEN = re.compile(r"\bTEST(?:_[FP])?\(\s*(\w+),\s*(\w+)\)")


def tests():
    """Suite: names of its tests, of all that `./dev test` compiles."""
    found = {}
    for file in sorted((ROOT / "tests").rglob("*.cpp")):
        for suite, name in WRITTEN.findall(file.read_text(encoding="utf-8")):
            found.setdefault(suite, set()).add(name)
    return found


def rows(page):
    """Cells of the rows of all tables, without their heads."""
    for line in page.read_text(encoding="utf-8").splitlines():
        cells = [cell.strip() for cell in line.strip().strip("|").split("|")]
        if line.startswith("|") and cells[0] != "hazard" and not set(cells[0]) <= set("-: "):
            yield cells


class Hazards(unittest.TestCase):
    def test_every_row_names_a_test(self):
        found = list(rows(ROOT / "docs" / "hazards.md"))
        self.assertGreater(len(found), 30)
        for cells in found:
            self.assertEqual(len(cells), 6, cells[0])
            self.assertTrue(all(cells), cells[0])
            self.assertRegex(cells[5], NAMED, cells[0])

    def test_every_test_that_is_named_is_there(self):
        known = tests()
        named = 0
        for name in ("hazards.md", "safety.md"):
            for suite, test in NAMED.findall((ROOT / "docs" / name).read_text(encoding="utf-8")):
                named += 1
                self.assertIn(suite, known, f"docs/{name}")
                self.assertTrue(test == "*" or test in known[suite], f"docs/{name}: {suite}.{test}")
        self.assertGreater(named, 100)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
