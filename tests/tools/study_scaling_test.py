#!/usr/bin/env python3
"""The model of tools/study_scaling: what it fits, and what it says of many ranks."""

import importlib.machinery
import importlib.util
import pathlib
import sys
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.dont_write_bytecode = True


def tool(name):
    loader = importlib.machinery.SourceFileLoader(name, str(ROOT / "tools" / name))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader(name, loader))
    loader.exec_module(module)
    return module


scaling = tool("study_scaling")


class Fit(unittest.TestCase):
    def test_finds_what_turns_are_made_of(self):
        for beside, each in ((0.0, 0.0), (0.002, 0.0), (0.001, 0.00005)):
            weak = {ranks: scaling.EACH * (scaling.TASK_S + beside + each * ranks) for ranks in scaling.RANKS}
            found = scaling.fitted(weak)
            self.assertAlmostEqual(found[0], beside, 9)
            self.assertAlmostEqual(found[1], each, 9)

    def test_is_never_below_nothing(self):
        weak = {ranks: scaling.EACH * scaling.TASK_S * (1 - 0.001 * ranks) for ranks in scaling.RANKS}
        self.assertEqual(scaling.fitted(weak)[1], 0.0)


class Growth(unittest.TestCase):
    model = scaling.Model(0.5, 1.0, 0.01, 0.0001)

    def test_one_rank_takes_all_one_after_the_other(self):
        self.assertAlmostEqual(self.model.seconds(40, 2, 1), 80 * 0.51 + 2 * 1.0)
        self.assertAlmostEqual(self.model.speedup(40, 2, 1), 1.0)

    def test_a_batch_takes_whole_turns(self):
        self.assertAlmostEqual(self.model.seconds(40, 64, 1000), 3 * 0.51 + 3 * 1.0)
        self.assertAlmostEqual(self.model.seconds(40, 64, 1280), 2 * 0.51 + 2 * 1.0)

    def test_a_rank_runs_no_more_virtual_sides_than_there_are_people(self):
        self.assertAlmostEqual(self.model.seconds(4000, 64, 1000), 256 * 0.51 + 64 * 1.0)

    def test_no_more_ranks_work_than_there_are_evaluations(self):
        self.assertEqual(self.model.seconds(40, 64, 2560), self.model.seconds(40, 64, 100000))

    def test_growth_ends_where_the_first_rank_is_busy(self):
        most = self.model.most_ranks()
        self.assertEqual(most, 5100)
        speedup = lambda ranks: self.model.speedup(10 ** 6, 10, ranks)  # noqa: E731
        self.assertGreater(speedup(most), 1.9 * speedup(most // 2))
        self.assertLess(speedup(4 * most), 1.01 * speedup(most))

    def test_half_is_gained_up_to_so_many_ranks(self):
        for designs in (40, 4096):
            ranks = self.model.useful_ranks(designs, 64)
            self.assertGreater(ranks, 1)
            self.assertGreaterEqual(self.model.speedup(designs, 64, ranks), 0.5 * ranks)
            self.assertLess(self.model.speedup(designs, 64, 2 * ranks), ranks)

    def test_never_faster_than_its_ranks(self):
        for ranks in (1, 3, 64, 1000, 99999):
            for designs, people in ((1, 1), (64, 1), (40, 64), (10 ** 6, 4)):
                self.assertLessEqual(self.model.speedup(designs, people, ranks), 1.000001 * min(ranks, designs * people))


if __name__ == "__main__":
    unittest.main()
