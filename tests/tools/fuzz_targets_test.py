#!/usr/bin/env python3
"""Every fuzz target is listed by ./dev fuzz, has seeds, and stands in the table of docs/robustness.md."""

import pathlib
import re
import subprocess
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
TARGETS = sorted(path.name.removesuffix("_fuzz.cpp") for path in (ROOT / "fuzz").glob("*_fuzz.cpp"))


class FuzzTargets(unittest.TestCase):
    def test_a_name_that_is_none_lists_them(self):
        run = subprocess.run([ROOT / "dev", "fuzz", "nonsense"], capture_output=True, text=True, check=False)
        self.assertEqual(run.returncode, 2)
        self.assertEqual(run.stderr, f"dev: fuzz: no target nonsense; there are {' '.join(TARGETS)}\n")

    def test_each_has_seeds(self):
        self.assertEqual(sorted(path.name for path in (ROOT / "fuzz/seeds").iterdir() if any(path.iterdir())), TARGETS)

    def test_the_page_says_what_each_reads(self):
        section = (ROOT / "docs/robustness.md").read_text().split("\n## Any file\n")[1]
        table = section.split("| target | reads | inputs")[1].split("\n\n")[0]
        self.assertEqual(re.findall(r"^\| (\w+) \|", table, re.MULTILINE), TARGETS)


if __name__ == "__main__":
    unittest.main()
