"""clients/unity, compiled against a stub of UnityEngine, against a real softfinger and the shared library.

    unity_test.py PROGRAM LIBRARY_FOLDER SOURCE_FOLDER
"""

import pathlib
import sys
import unittest

import mono

PROGRAM, LIBRARY = (str(pathlib.Path(argument).resolve()) for argument in sys.argv[1:3])
ROOT = pathlib.Path(sys.argv[3]).resolve()
HERE, UNITY = ROOT / "tests/csharp", ROOT / "clients/unity"
PLANE, CYLINDER = ROOT / "scenes/plane.toml", ROOT / "scenes/cylinder.toml"
#: The device that loads fastest.
PLATE = ROOT / "devices/plate-2dof.toml"
#: On both fingers of a scene that two of them touch.
PLATES = [word for finger in ("index", "thumb") for word in ("--device", f"{finger}={ROOT / 'devices/plate-2dof.toml'}")]
test = None


def setUpModule():
    global test
    test = mono.Compiled(UNITY / "Runtime", UNITY / "Samples~", UNITY / "Tests", HERE / "unity", HERE / "Check.cs")
    unittest.addModuleCleanup(test.close)


class Unity(unittest.TestCase):
    def passes(self, *arguments):
        status, out, error = test.run(*arguments, library=LIBRARY)
        self.assertEqual(status, 0, out[-2000:] + error)

    def test_frames_are_those_of_the_library(self):
        self.passes("frames", "-")

    def test_the_sample_shows_what_a_script_touches(self):
        with mono.softfinger(PROGRAM, CYLINDER, "--device", PLATE, "--repeat") as address:
            self.passes("show", address)

    def test_the_sample_shows_what_is_soft_as_it_deforms(self):
        with mono.softfinger(PROGRAM, ROOT / "scenes/sponge.toml", *PLATES) as address:
            self.passes("soft", address)

    def test_what_happens_to_objects_comes_as_events(self):
        with mono.softfinger(PROGRAM, ROOT / "scenes/button.toml", "--device", PLATE, "--repeat") as address:
            self.passes("events", address)

    def test_a_finger_follows_a_transform(self):
        with mono.softfinger(PROGRAM, PLANE, "--device", PLATE, "--tracker", "page") as address:
            self.passes("move", address)

    def test_a_finger_follows_a_hand(self):
        with mono.softfinger(PROGRAM, PLANE, "--device", PLATE, "--tracker", "webxr") as address:
            self.passes("hand", address)

    def test_where_nobody_answers_one_line_says_so(self):
        self.passes("nobody", "http://127.0.0.1:1")

    def test_a_finger_in_this_process(self):
        self.passes("library", PLANE, PLATE)

    def test_objects_that_the_host_moves(self):
        self.passes("objects", PLANE, PLATE)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
