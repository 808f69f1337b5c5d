"""The package's annotations hold, and nothing in it is untyped.

    types_test.py SOURCE_FOLDER
"""

import pathlib
import subprocess
import sys
import tempfile
import unittest

PACKAGE = pathlib.Path(sys.argv[1]) / "python" / "softfinger"


class Types(unittest.TestCase):
    def test_strictly(self):
        self.assertTrue((PACKAGE / "py.typed").exists())
        with tempfile.TemporaryDirectory() as cache:
            run = subprocess.run([sys.executable, "-m", "mypy", "--strict", f"--cache-dir={cache}", PACKAGE],
                                 capture_output=True, text=True, check=False)
        self.assertEqual(run.returncode, 0, run.stdout + run.stderr)
        self.assertRegex(run.stdout, r"no issues found in [1-9]\d* source files")


unittest.main(argv=sys.argv[:1])
