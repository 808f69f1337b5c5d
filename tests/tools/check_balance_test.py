#!/usr/bin/env python3
"""tools/check_balance finds the program's presses in balance, and spoilt ones not.

    check_balance_test.py PROGRAM
"""

import pathlib
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
FINGER = ROOT / "fingers/index.toml"
LAYERED = ROOT / "fingers/index-layered.toml"  # several materials, dilatation over patches
PROGRAM = sys.argv.pop()


class CheckBalance(unittest.TestCase):
    def setUp(self):
        self.temporary = tempfile.TemporaryDirectory()
        self.folder = pathlib.Path(self.temporary.name)

    def tearDown(self):
        self.temporary.cleanup()

    def press(self, *options, finger=FINGER):
        subprocess.run([PROGRAM, "press", finger, "--export", self.folder, *options], check=True, capture_output=True)

    def status(self, *options, finger=FINGER):
        run = subprocess.run([sys.executable, ROOT / "tools/check_balance", finger, self.folder, *options],
                             capture_output=True, text=True)
        self.assertEqual(run.stderr, "")
        return run.returncode

    def test_presses_are_in_balance(self):
        for options in (["--to-mm", "3", "--steps", "4"], ["--to-mm", "1.5", "--steps", "2", "--edge"],
                        ["--to-mm", "1.5", "--steps", "2", "--sphere-mm", "6", "--angle-deg", "25"]):
            self.press(*options)
            self.assertEqual(self.status("--within", "1e-8"), 0, options)

    def test_no_force_is_no_balance(self):
        self.press("--to-mm", "1", "--steps", "1")
        for name, fields in (("contact.csv", (3, 4, 5)), ("nodes.csv", ())):
            file = self.folder / name
            header, *lines = file.read_text().splitlines()
            rows = [line.split(",") for line in lines]
            for row in rows:
                for k in fields:
                    row[k] = "0"
            file.write_text("\n".join([header, *(",".join(row) for row in rows)]) + "\n")
        self.assertEqual(self.status("--within", "1e9"), 1)

    def test_layers_are_in_balance(self):
        self.press("--to-mm", "2", "--steps", "2", finger=LAYERED)
        self.assertEqual(self.status("--within", "1e-8", finger=LAYERED), 0)
        # Over other patches they would not be.
        file = self.folder / "patches.csv"
        header, *lines = file.read_text().splitlines()
        alone = [f"{line.split(',')[0]},{k}" for k, line in enumerate(lines)]
        file.write_text("\n".join([header, *alone]) + "\n")
        self.assertEqual(self.status(finger=LAYERED), 1)

    def test_without_limits(self):
        self.press("--to-mm", "1.5", "--steps", "2", "--no-strain-limits")
        self.assertEqual(self.status("--no-strain-limits"), 0)
        self.assertEqual(self.status(), 1)

    def test_spoilt_contact_force_is_found(self):
        self.press("--to-mm", "1", "--steps", "1")
        file = self.folder / "contact.csv"
        header, *lines = file.read_text().splitlines()
        fields = max((line.split(",") for line in lines), key=lambda line: float(line[5]))
        at = lines.index(",".join(fields))
        fields[5] = str(float(fields[5]) * 1.0001)
        lines[at] = ",".join(fields)
        file.write_text("\n".join([header, *lines]) + "\n")
        self.assertEqual(self.status(), 1)

    def test_moved_node_is_found(self):
        self.press("--to-mm", "1", "--steps", "1")
        file = self.folder / "nodes.csv"
        lines = file.read_text().splitlines()
        # Any free node will do; those of the skin under load are lowest.
        lowest = min(range(1, len(lines)), key=lambda k: float(lines[k].split(",")[4]))
        fields = lines[lowest].split(",")
        fields[2] = str(float(fields[2]) + 1e-4)
        lines[lowest] = ",".join(fields)
        file.write_text("\n".join(lines) + "\n")
        self.assertEqual(self.status(), 1)


if __name__ == "__main__":
    unittest.main()
