"""clients/csharp over the shared library: the bits of C and of the command line.

    library_test.py PROGRAM LIBRARY_FOLDER STEPS_IN_C SOURCE_FOLDER
"""

import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

import mono

PROGRAM, LIBRARY, STEPS = (str(pathlib.Path(argument).resolve()) for argument in sys.argv[1:4])
ROOT = pathlib.Path(sys.argv[4]).resolve()
HERE, PLANE, FINGER = ROOT / "tests/csharp", ROOT / "scenes/plane.toml", ROOT / "fingers/index.toml"
# The plate is the one that loads fastest.
THIMBLE, MEMBRANE, PLATE = ROOT / "devices/thimble-3rrs.toml", ROOT / "devices/membrane.toml", ROOT / "devices/plate-2dof.toml"
test = None


def setUpModule():
    global test
    test = mono.Compiled(ROOT / "clients/csharp/src", HERE / "Check.cs", HERE / "LibraryTest.cs")
    unittest.addModuleCleanup(test.close)


def printed(*command):
    return subprocess.run([*map(str, command)], capture_output=True, text=True, check=True).stdout


class Library(unittest.TestCase):
    maxDiff = 2000

    def passes(self, *arguments, library=LIBRARY):
        status, out, error = test.run(*arguments, library=library)
        self.assertEqual(status, 0, out[-2000:] + error)
        return out

    def test_steps_are_those_of_c(self):
        ours, theirs = self.passes("steps", PLANE, PLATE).splitlines(), printed(STEPS, PLANE, PLATE).splitlines()
        self.assertGreater(len(theirs), 300)
        self.assertEqual(ours[1:], theirs[1:])
        # A struct of C may have grown at its end since: its size says that this is one from before.
        our_sizes, their_sizes = ([int(size) for size in lines[0].split()[1:]] for lines in (ours, theirs))
        self.assertEqual(len(our_sizes), 12)
        self.assertTrue(all(a <= b for a, b in zip(our_sizes, their_sizes, strict=True)), (our_sizes, their_sizes))

    def test_all_fingers_of_a_scene_hold_what_moves(self):
        self.passes("several", ROOT / "scenes/cup.toml")

    def test_presses_are_those_of_the_command_line(self):
        ours = self.passes("press", FINGER)
        flags = (["--steps", "3", "--to-mm", "1"],
                 ["--steps", "3", "--to-mm", "0.7", "--sphere-mm", "6", "--at-mm", "1,-2", "--no-friction", "--angle-deg", "20"],
                 ["--steps", "3", "--to-mm", "0.5", "--edge", "--edge-radius-mm", "2", "--no-strain-limits"],
                 ["--steps", "2", "--to-mm", "0.5", "--speed-mm-per-s", "10", "--hold-ms", "50", "--unload"])
        self.assertEqual(ours, "".join(printed(PROGRAM, "press", FINGER, *of, "--json") for of in flags))

    def test_an_evaluation_is_that_of_the_command_line(self):
        ours = json.loads(self.passes("evaluate", PLANE, MEMBRANE))
        theirs = json.loads(printed(PROGRAM, "evaluate", PLANE, "--device", MEMBRANE, "--duration-s", "1.2", "--json"))
        self.assertGreater(len(theirs["frames"]), 20)
        for report in (ours, theirs):
            without_clocks(report)
        self.assertEqual(ours, theirs)

    def test_a_run_is_that_of_the_command_line(self):
        with tempfile.TemporaryDirectory() as folder:
            theirs = json.loads(printed(PROGRAM, "run", PLANE, "--device", PLATE, "--headless", "--as-fast-as-possible",
                                        "--duration-s", "1.2", "--record", f"{folder}/theirs.sqlite", "--json"))
            ours = json.loads(self.passes("run", PLANE, PLATE, folder))
        self.assertEqual(ours["steps"], 1200)
        for report in (ours, theirs):
            without_clocks(report)
            del report["recording"]
        self.assertEqual(ours, theirs)

    def test_a_device_is_that_of_the_command_line(self):
        self.assertEqual(json.loads(self.passes("device", THIMBLE)), json.loads(printed(PROGRAM, "device", "show", THIMBLE, "--json")))

    def test_a_rendering_stops_records_and_leaves_no_garbage(self):
        with tempfile.TemporaryDirectory() as folder:
            self.passes("rendering", PLANE, PLATE, folder)

    def test_what_is_wrong_is_refused_in_one_line(self):
        self.passes("refuse", PLANE, PLATE)

    def test_a_library_that_is_not_there(self):
        self.passes("without", PLANE, library="/nowhere")


def without_clocks(report):
    """What a processor took is another time each run."""
    for key in [key for key in report if key.endswith("_ms")]:
        del report[key]
    for value in report.values():
        for inner in value if isinstance(value, list) else [value]:
            if isinstance(inner, dict):
                without_clocks(inner)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
