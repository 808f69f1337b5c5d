"""The same exploration by the command line, C++, C, Python and C#: every bit of every step and device tick is the same. Each
records; what is compared is what the recordings hold, with the hash of the whole state, and all but the clocks.

    same_bits_test.py PROGRAM SOURCE_FOLDER LIBRARY_FOLDER EXPLORE_IN_CPP EXPLORE_IN_C [--without-csharp]
"""

import contextlib
import pathlib
import sqlite3
import struct
import subprocess
import sys
import tempfile
import unittest

import numpy as np
import softfinger as sf

PROGRAM, ROOT, LIBRARY, CPP, C = (pathlib.Path(argument).resolve() for argument in sys.argv[1:6])
WITH_CSHARP = "--without-csharp" not in sys.argv
sys.path.insert(0, str(ROOT / "tests/csharp"))
import mono  # pylint: disable=wrong-import-position

PLANE = ROOT / "scenes/plane.toml"
#: The one that loads fastest.
DEVICE = ROOT / "devices/plate-2dof.toml"
CLOCKS = {"cpu_s", "wall_s", "latency_s"}


def motion():
    """Rows of time, s, x, y, z, mm, and quaternion, as text that all read alike: down, tipping and dragged, then up again."""
    rows = []
    for i in range(701):
        down = min(i, 500) / 500 - max(i - 500, 0) / 200
        half = 0.03 + 0.02 * down
        rows.append([f"{i / 1000:.3f}", f"{2 * down:.6f}", f"{-down:.6f}", f"{8.5 - 2.2 * down:.6f}",
                     repr(float(np.cos(half))), "0.0", repr(float(np.sin(half))), "0.0"])
    return rows


def table(recording, name, order):
    with contextlib.closing(sqlite3.connect(recording)) as database:
        rows = database.execute(f"SELECT * FROM {name} ORDER BY {order}")
        names = [column[0] for column in rows.description]
        kept = [i for i, column in enumerate(names) if column not in CLOCKS]
        return [[names[i] for i in kept]] + [[row[i] for i in kept] for row in rows]


class SameBits(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.text = motion()
        self.si = [[float(row[0]), *(float(x) * 1e-3 for x in row[1:4]), *map(float, row[4:])] for row in self.text]

    def test_every_door(self):
        csv, binary = self.folder / "motion.csv", self.folder / "motion.bin"
        csv.write_text("\n".join(["time_s,x_mm,y_mm,z_mm,qw,qx,qy,qz", *map(",".join, self.text)]) + "\n")
        binary.write_bytes(b"".join(struct.pack("<8d", *row) for row in self.si))
        recordings = {}

        def ours(name):
            recordings[name] = self.folder / f"{name}.sqlite"
            return recordings[name]

        subprocess.run([PROGRAM, "run", PLANE, "--device", DEVICE, "--headless", "--as-fast-as-possible", "--tracker", f"csv:{csv}",
                        "--record", ours("command line")], check=True, stdout=subprocess.DEVNULL)
        for name, program in (("C++", CPP), ("C", C)):
            subprocess.run([program, PLANE, DEVICE, binary, ours(name)], check=True)
        with sf.Rendering(PLANE, device=DEVICE, record=ours("Python")) as rendering:
            for time, *pose in self.si:
                rendering.step(np.array(pose), time)
        if WITH_CSHARP:
            with contextlib.closing(mono.Compiled(ROOT / "clients/csharp/src", ROOT / "tests/doors/Explore.cs")) as program:
                status, _, error = program.run(PLANE, DEVICE, binary, ours("C#"), library=LIBRARY)
            self.assertEqual(status, 0, error)

        for name, order in (("steps", "step"), ("ticks", "tick")):
            expected = table(recordings["command line"], name, order)
            self.assertGreater(len(expected), 20)
            self.assertGreater(len(expected[0]), 10)
            for door, recording in recordings.items():
                found = table(recording, name, order)
                self.assertEqual(found[0], expected[0], door)
                self.assertEqual(len(found), len(expected), f"{name} by {door}")
                for row, (a, b) in enumerate(zip(found, expected)):
                    self.assertEqual(a, b, f"{name}, row {row}, by {door}")
        forces = np.array([row[table(recordings["C"], "steps", "step")[0].index("normal_force_N")]
                           for row in table(recordings["C"], "steps", "step")[1:]])
        self.assertGreater(forces.max(), 0.1)
        self.assertEqual(len(recordings), 5 if WITH_CSHARP else 4)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
