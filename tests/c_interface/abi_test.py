"""Programs that were built against an older softfinger.h still run: abidiff compares what it declares with the stored
baseline. Functions may be added. Where a struct grows, which may be at its end alone since its size comes first, the
baseline is written anew and its difference looked at; refusal_test.cpp and rendering_test.cpp try the older size.

    abi_test.py COMPILER HEADER BASELINE [--write]

--write: what is declared now becomes the baseline.
"""

import pathlib
import platform
import re
import subprocess
import sys
import tempfile
import unittest

COMPILER, HEADER, BASELINE = sys.argv[1:4]


def library_of(header, folder):
    """A library with debug information that has a variable of the type of each function."""
    declared = re.findall(r"^SF_API [^(]*?\b(sf_\w+)\(", header, re.MULTILINE)
    source = pathlib.Path(folder, "declared.c")
    library = source.with_suffix(".so")
    pathlib.Path(folder, "softfinger.h").write_text(header, encoding="utf-8")
    source.write_text('#include "softfinger.h"\n' + "".join(f"__typeof__({name}) *{name}_is;\n" for name in declared))
    # Relative names: the folder does not matter.
    subprocess.run([COMPILER, "-std=gnu99", "-g", "-shared", "-fPIC", "-o", library.name, source.name], cwd=folder, check=True)
    return library


def compared(header, folder):
    run = subprocess.run(["abidiff", "--no-added-syms", BASELINE, library_of(header, folder)], capture_output=True, text=True)
    return run.returncode, run.stdout + run.stderr


def write_baseline():
    with tempfile.TemporaryDirectory() as folder:
        library = library_of(pathlib.Path(HEADER).read_text(encoding="utf-8"), folder)
        subprocess.run(["abidw", "--no-show-locs", "--no-comp-dir-path", "--no-corpus-path", "--out-file", BASELINE, library], check=True)


@unittest.skipUnless(platform.machine() == "x86_64", "the baseline is of x86-64")
class Abi(unittest.TestCase):
    def setUp(self):
        self.header = pathlib.Path(HEADER).read_text(encoding="utf-8")
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name

    def test_older_programs_still_run(self):
        status, said = compared(self.header, self.folder)
        self.assertEqual(status, 0, said)

    def test_what_would_break_them_is_noticed(self):
        spoilt = {
            "a member in the middle": self.header.replace("  double position_m[3];", "  double time_s;\n  double position_m[3];"),
            "a narrower member": self.header.replace("  int64_t tick; ", "  int32_t tick; "),
            "another argument": self.header.replace("sf_rendering_stop(sf_rendering *rendering)", "sf_rendering_stop(sf_rendering *rendering, int how)"),
            "a function that is gone": self.header.replace("SF_API uint32_t sf_version(void);", ""),
        }
        for how, header in spoilt.items():
            self.assertNotEqual(header, self.header, how)
            self.assertNotEqual(compared(header, self.folder)[0], 0, how)

    def test_functions_may_be_added(self):
        grown = self.header.replace("SF_API uint32_t sf_version(void);", "SF_API uint32_t sf_version(void);\nSF_API void sf_more(void);")
        self.assertNotEqual(grown, self.header)
        status, said = compared(grown, self.folder)
        self.assertEqual(status, 0, said)


if "--write" in sys.argv:
    write_baseline()
else:
    unittest.main(argv=sys.argv[:1])
