"""The package for Python installed by pip from the sources and a build, without a network, finds its library, its guard
and the shipped files in itself. With Debian's pip, setuptools and wheel: `./dev test --all`.

    wheel_test.py BUILD_FOLDER SOURCE_FOLDER
"""

import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

BUILD, SOURCE = (pathlib.Path(argument).resolve() for argument in sys.argv[1:3])
TRY = """
import pathlib, softfinger
folder = pathlib.Path(softfinger.__file__).parent
curve = softfinger.press("index", to_mm=1, steps=1)
assert curve["normal_force_N"][0] > 0.1, curve
try:
    softfinger.Device("membran")
except softfinger.InputError as error:
    assert f"in {folder}/share/softfinger/devices, which has membrane" in str(error), error
else:
    raise AssertionError("found")
with softfinger.Rendering("sphere", open_device=True) as rendering:
    rendering.step([[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0.2], [0, 0, 0, 1]], 0.0)
"""


class Wheel(unittest.TestCase):
    def test_installs_without_a_network_and_works_alone(self):
        before = subprocess.run(["git", "status", "--short", "--ignored", "python"], cwd=SOURCE, capture_output=True).stdout
        with tempfile.TemporaryDirectory() as target:
            subprocess.run(["/usr/bin/python3", "-m", "pip", "install", "--quiet", "--no-index", "--no-build-isolation", "--no-deps",
                            "--root-user-action=ignore", "--target", target, SOURCE / "python"],
                           check=True, env=dict(os.environ, SOFTFINGER_BUILD=str(BUILD)))
            tags = next(pathlib.Path(target).glob("*.dist-info/WHEEL")).read_text()
            self.assertRegex(tags, r"Tag: py3-none-linux_\w+")
            self.assertTrue(os.access(pathlib.Path(target, "softfinger/softfinger-guard"), os.X_OK))
            subprocess.run(["/usr/bin/python3", "-c", TRY], check=True, cwd="/", env=dict(os.environ, PYTHONPATH=target))
        after = subprocess.run(["git", "status", "--short", "--ignored", "python"], cwd=SOURCE, capture_output=True).stdout
        self.assertEqual(before, after)


unittest.main(argv=sys.argv[:1])
