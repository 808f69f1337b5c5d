"""tools/plot_benchmarks must write what a run says, and nothing where a run lacks something."""

import importlib.machinery
import importlib.util
import json
import pathlib
import sys
import tempfile
import unittest

sys.dont_write_bytecode = True
TOOL = pathlib.Path(__file__).resolve().parents[2] / "tools" / "plot_benchmarks"
loader = importlib.machinery.SourceFileLoader("plot_benchmarks", str(TOOL))
tool = importlib.util.module_from_spec(importlib.util.spec_from_loader("plot_benchmarks", loader))
loader.exec_module(tool)


def run_of(*rows):
    with tempfile.TemporaryDirectory() as folder:
        file = pathlib.Path(folder, "run.json")
        file.write_text(json.dumps({"context": {}, "benchmarks": rows}))
        python = pathlib.Path(folder, "python.json")
        python.write_text(json.dumps({"matrix_us": 1.5, "pose_us": 6.5}))
        return tool.Run(file, python)


def press(name, **counters):
    row = {"name": f"press/{name}/iterations:100", "tetrahedra": 411, "median_us": 1234.5, "mean_us": 99.94,
           "p99_us": 1.0, "iterations": 2.0, "unconverged": 0}
    return {**row, **counters}


class PlotBenchmarks(unittest.TestCase):
    def test_page_has_a_place_for_every_part(self):
        page = tool.PAGE.read_text()
        for name in tool.PARTS:
            self.assertEqual(page.count(f"<!-- {name} -->"), 1, name)
        self.assertEqual(page.count("<!-- end -->"), len(tool.PARTS))

    def test_times_have_three_digits(self):
        self.assertEqual([tool.micro(t) for t in (0.1234, 12.34, 99.94, 1234.5, 1234567.0)],
                         ["0.123", "12.3", "99.9", "1,230", "1,230,000"])

    def test_aims_are_judged_by_median_and_tail(self):
        self.assertEqual(tool.reached((60, 150), 60, 150)[1], "yes")
        self.assertEqual(tool.reached((60, 150), 60, 151)[1], "median")
        self.assertEqual(tool.reached((60, 150), 61, 150)[1], "no")
        self.assertEqual(tool.reached(None, 61, 150), ["", ""])

    def test_rows_are_those_of_the_run(self):
        text = tool.growth(run_of(press("S_16ms"), press("L_1ms", tetrahedra=5283)))
        self.assertIn("| S (`index`) | 411 | 16 ms | 1,230 | 99.9 | 1 | 2.0 | 0 |", text)
        self.assertIn("| L (`index-fine`) | 5,283 | 1 ms |", text)

    def test_growth_over_freedom_goes_by_the_number_of_pins(self):
        def row(name, freedom, median):
            return {"name": f"{name}/iterations:9", "degrees_of_freedom": freedom, "median_us": median, "p99_us": 100.0,
                    "iterations": 2.0}
        text = tool.freedom(run_of(row("matching_pins/rows:10/warm:1", 100, 50.0), row("matching_pins/rows:2/warm:1", 4, 8.0),
                                   row("matching_pins/rows:2/warm:0", 4, 9.0), row("matching_device/thimble", 3, 12.0),
                                   row("matching_device/plate", 6, 600.0)))
        self.assertEqual([line.split("|")[1].strip() for line in text.splitlines()[2:]],
                         ["3-RRS", "plate on six cranks (mechanism)", "2 x 2 pins", "10 x 10 pins"])
        self.assertIn("| 10 x 10 pins | 100 | 50 | 100 | 2.0 | 0.5 |", text)

    def test_force_aware_frames_are_judged_by_their_mesh(self):
        rows = [{"name": f"{name}/iterations:3", "median_us": 400.0, "p99_us": 900.0, "max_us": 950.0, "iterations": 9.0,
                 "frames": 500} for name in tool.FORCE_AWARE]
        text = tool.force_aware(run_of(*rows))
        self.assertIn("| S, plane, 3-RRS | 400 | 900 | 950 | 9 | 500 | 300 / 1,000 | no |", text)
        self.assertIn("| M, sphere, 3-RRS | 400 | 900 | 950 | 9 | 500 | 1,500 / 5,000 | yes |", text)

    def test_two_threads_are_judged_by_wall_time(self):
        times = {"alone_median_us": 600.0, "alone_p99_us": 2000.0, "alone_mean_us": 800.0, "alone_cpu_us": 790.0,
                 "wall_median_us": 300.0, "wall_p99_us": 1000.0, "wall_mean_us": 500.0, "both_cpu_us": 900.0}
        text = tool.threads(run_of(*({"name": f"{name}/iterations:9", **times} for name in tool.THREADS)))
        self.assertIn("| M, plane | 600 / 2,000 / 800 | 300 / 1,000 / 500 | **2.00**, **1.60** | 790, 900 | 300 / 600 "
                      "| median |", text)

    def test_doors_may_cost_a_twentieth_or_five_microseconds(self):
        text = tool.doors(run_of({"name": "door/S_sphere/iterations:9", "cpp_us": 128.0, "extra_us": 0.634}))
        self.assertIn("| C | 129 | +0.63 | 5 % or 5 us | yes |", text)
        self.assertIn("| Python, a (7,) pose | 134 | +6.50 | 5 % or 5 us | no |", text)

    def test_bodies_are_listed_by_how_they_stand_and_how_many_they_are(self):
        def row(kind, count, median):
            return {"name": f"world_bodies/{kind}/{count}/iterations:9", "points": 8.0, "median_us": median, "p99_us": 100.0,
                    "iterations": 2.0}
        rows = [row(kind, count, 10.0 * count) for kind in tool.BODIES for count in (1, 4)]
        text = tool.bodies(run_of(*rows))
        self.assertIn("| in a row, one island | 4 | 8 | 40 | 100 | 2.0 | 10 |", text)
        self.assertEqual(len(text.splitlines()), 2 + 2 * len(tool.BODIES))
        with self.assertRaisesRegex(SystemExit, "nothing of world_bodies/asleep/"):
            tool.bodies(run_of(*rows[:-2]))

    def test_refuses_what_is_missing_or_failed(self):
        with self.assertRaisesRegex(SystemExit, "step/S_plane is not in this run"):
            tool.steps(run_of(press("S_16ms")))
        with self.assertRaisesRegex(SystemExit, "press/S_16ms: another answer"):
            run_of(press("S_16ms", error_occurred=True, error_message="another answer"))


if __name__ == "__main__":
    unittest.main()
