#!/usr/bin/env python3
"""Gates of tools/validate and tools/experiments fail where there is no force, area, row or frame to compare."""

import importlib.machinery
import importlib.util
import json
import pathlib
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
sys.dont_write_bytecode = True


def tool(name):
    loader = importlib.machinery.SourceFileLoader(name, str(ROOT / "tools" / name))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader(name, loader))
    loader.exec_module(module)
    return module


validate, experiments = tool("validate"), tool("experiments")


def rows(force):
    """A press every 0.1 mm to 1.6 mm whose force and area are `force` times what is usual."""
    depths = [0.1 * k for k in range(1, 17)]
    return [{"indentation_mm": d, "normal_force_N": force * validate.pawluk_howe(d),
             "contact_area_mm2": force * 100 * validate.pawluk_howe(d) ** 0.5, "volume_ratio": 0.99} for d in depths]


class NothingToCompare(unittest.TestCase):
    def program(self, answer):
        """A program that says `answer` whatever it is asked."""
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        file = pathlib.Path(folder.name) / "softfinger"
        file.write_text(f"#!{sys.executable}\nprint({json.dumps(answer)!r})\n")
        file.chmod(0o755)
        return file

    def refused(self, gate, *arguments):
        with self.assertRaises(validate.NothingToCompare):
            gate(*arguments)

    def test_a_press_without_force_is_none(self):
        for answer, fails in ((rows(1.0), False), (rows(0.0), True), ([], True)):
            program = validate.Program(self.program(answer).parent)
            if fails:
                self.refused(program.press, "S", 1.6, 16)
            else:
                self.assertEqual(program.press("S", 1.6, 16), answer)

    def test_gates_of_presses(self):
        for gate in (validate.fingers, validate.convergence):
            for lacking in "SMLR":
                presses = {size: rows(0.0 if size == lacking else 1.0) for size in ("S", "M", "L", "R", "layered")}
                self.refused(gate, presses, validate.Checks())
                presses[lacking] = rows(1.0)[:2]
                self.refused(gate, presses, validate.Checks())
        presses = {size: rows(1.0) for size in ("S", "M", "L", "R", "layered")}
        checks = validate.Checks()
        validate.fingers(presses, checks)
        self.assertGreater(len(checks.rows), 10)

    def test_gates_of_the_library(self):
        flight = {"time_step_ms": 1.0, "converged": True, "momentum": 1.0, "momentum_drift": 0.0,
                  "largest_energy_gain": -1.0, "energy_J": [1.0] * 300}
        validate.free_flight({"free_flight": [flight]}, validate.Checks())
        for spoilt in ({"momentum": 0.0}, {"energy_J": [0.0] * 300}, {"energy_J": []}):
            self.refused(validate.free_flight, {"free_flight": [flight | spoilt]}, validate.Checks())
        self.refused(validate.elastic, {"patch": []}, validate.Checks())
        self.refused(validate.elastic, {"patch": 4 * [{"free_nodes": 0, "error_mm": 0.0}]}, validate.Checks())
        press = {"cells": 8, "grading": 1.4, "rows": 20 * [{"indentation_mm": 1.0, "force_N": 0.0, "radius_mm": 0.0}]}
        self.refused(validate.hertz, {"hertz": 4 * [press]}, validate.Checks())

    def test_what_is_not_a_number_is_not_compared(self):
        for values in ([], [0.0], [1.0, float("nan")], [float("inf")], [1.0, -1.0]):
            self.refused(validate.compared, values, "force")
        self.assertEqual(validate.compared(iter([1.0, 2.0]), "force", 2), [1.0, 2.0])

    def test_an_evaluation_without_force_ends_the_experiments(self):
        for force, fails in ((0.5, False), (0.0, True)):
            program = self.program({"frames": [{"virtual_force_N": 0.0}, {"virtual_force_N": force}]})
            if fails:
                with self.assertRaises(SystemExit):
                    experiments.evaluate(program, "scene.toml")
            else:
                self.assertEqual(len(experiments.evaluate(program, "scene.toml")["frames"]), 2)
        with self.assertRaises(SystemExit):
            experiments.evaluate(self.program({"frames": []}), "scene.toml")


if __name__ == "__main__":
    unittest.main()
