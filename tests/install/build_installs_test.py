"""What `./dev build` builds is all that `cmake --install` takes.

    build_installs_test.py BUILD_FOLDER SOURCE_FOLDER
"""

import pathlib
import re
import subprocess
import sys
import unittest

BUILD, SOURCE = (pathlib.Path(argument).resolve() for argument in sys.argv[1:3])
BUILT = re.compile(r'file\(INSTALL DESTINATION \S+ TYPE (?:EXECUTABLE|\w+_LIBRARY) [^)]*?FILES ((?:"[^"]+"\s*)+)')


def installed():
    """Programs and libraries that the install scripts copy from the build folder."""
    files = set()
    for script in BUILD.rglob("cmake_install.cmake"):
        for names in BUILT.findall(script.read_text(encoding="utf-8")):
            files.update(pathlib.Path(name) for name in re.findall(r'"([^"]+)"', names))
    return {file.relative_to(BUILD) for file in files if file.is_relative_to(BUILD)}


def made_by(target):
    """What a target made of other targets alone builds."""
    lines = subprocess.run(
        ["ninja", "-C", BUILD, "-t", "query", target], check=True, capture_output=True, text=True
    ).stdout.partition("  outputs:")[0].splitlines()
    return {pathlib.Path(line.strip().lstrip("| ")) for line in lines[2:]}


class BuildInstalls(unittest.TestCase):
    def test_the_target_makes_all_that_is_installed(self):
        files = installed()
        self.assertGreater(len(files), 10)
        self.assertIn(pathlib.Path("softfinger"), files)
        self.assertEqual(files - made_by("to_install"), set())

    def test_dev_builds_that_target_and_the_demo_the_program(self):
        functions = dict(re.findall(r"^(run_\w+)\(\) \{\n(.*?)^\}", (SOURCE / "dev").read_text(), re.M | re.S))
        self.assertRegex(functions["run_build"], r"(?m)^  compile release to_install$")
        self.assertRegex(functions["run_demo"], r"(?m)^  compile release softfinger >&2$")


unittest.main(argv=sys.argv[:1])
