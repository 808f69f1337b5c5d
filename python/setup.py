"""The wheel: the package, with the shared library, its guard and the shipped files of a build beside it.

CMake builds those before (`./dev build`); SOFTFINGER_BUILD names its folder where that is not build/.
"""

import os
import pathlib
import re
import shutil

from setuptools import setup
from setuptools.command.build_py import build_py
from wheel.bdist_wheel import bdist_wheel

ROOT = pathlib.Path(__file__).resolve().parent.parent
BUILD = pathlib.Path(os.environ.get("SOFTFINGER_BUILD", ROOT / "build")).resolve()
WORK = BUILD / "wheel"  # nothing is left among the sources


class BuildWithLibrary(build_py):
    def run(self) -> None:
        super().run()
        package = pathlib.Path(self.build_lib, "softfinger")
        for name in ("libsoftfinger.so.0", "softfinger-guard"):
            if not (BUILD / name).exists():
                raise SystemExit(f"{BUILD / name}: not there; build it first: ./dev build")
            shutil.copy2(BUILD / name, package)
        if (BUILD / "softfinger-pagmo.so").exists():  # searches of studies
            shutil.copy2(BUILD / "softfinger-pagmo.so", package)
        for folder in ("devices", "fingers", "objects", "scenes", "studies"):
            shutil.copytree(ROOT / folder, package / "share/softfinger" / folder, dirs_exist_ok=True)


class OfThisMachine(bdist_wheel):
    """Any Python 3, for the library is called by ctypes; but this machine's processor and system."""

    def finalize_options(self) -> None:
        super().finalize_options()
        self.root_is_pure = False

    def get_tag(self) -> tuple[str, str, str]:
        return "py3", "none", super().get_tag()[2]


shutil.rmtree(WORK / "build", ignore_errors=True)  # else modules that are gone would come along
WORK.mkdir(parents=True, exist_ok=True)
setup(
    version=re.search(r"project\(softfinger VERSION ([\d.]+)", (ROOT / "CMakeLists.txt").read_text())[1],
    cmdclass={"build_py": BuildWithLibrary, "bdist_wheel": OfThisMachine},
    options={"build": {"build_base": str(WORK / "build")}, "egg_info": {"egg_base": str(WORK)}},
)
