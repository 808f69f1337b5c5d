"""The example that drives a device by one's own tracker: it follows, and retracts where the tracker falls silent.

    own_tracker_test.py EXAMPLE SOURCE_FOLDER
"""

import pathlib
import subprocess
import sys
import time
import unittest

EXAMPLE, ROOT = sys.argv[1], pathlib.Path(sys.argv[2])


def pose(seconds, height_mm):
    return f"{seconds:.3f} 0 0 {height_mm:.4f} 1 0 0 0\n"


class OwnTracker(unittest.TestCase):
    def setUp(self):
        self.program = subprocess.Popen(
            [sys.executable, "-u", EXAMPLE, ROOT / "scenes/plane.toml", ROOT / "devices/thimble-3rrs.toml"], text=True,
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        self.addCleanup(self.end)

    def end(self):
        self.program.kill()
        self.program.communicate()

    def test_it_follows_and_retracts_in_silence(self):
        for i in range(1400):
            self.program.stdin.write(pose(1e-3 * i, max(5.8, 9.5 - 4e-3 * i)))
        self.program.stdin.flush()
        rows = [self.program.stdout.readline().split() for _ in range(1400)]
        self.assertEqual(rows[-1][2], "rendering")
        self.assertGreater(float(rows[-1][3]), 0.05)
        self.assertEqual(len(rows[-1]), 5 + 3)
        self.assertNotEqual(rows[0][5:], rows[-1][5:])
        # Nothing comes any more.
        until = time.monotonic() + 30
        while time.monotonic() < until and (silent := self.program.stdout.readline().split())[2] != "retracting":
            pass
        self.assertEqual(silent[2], "retracting")

    def test_what_is_no_pose_is_told(self):
        _, said = self.program.communicate("0.0 1 2 3 1 0 0\n")
        self.assertEqual(self.program.returncode, 1)
        self.assertNotIn("Traceback", said)


unittest.main(argv=sys.argv[:1])
