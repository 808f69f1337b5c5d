"""What libsoftfinger.so shows is what softfinger.h declares, and nothing else.

    exports_test.py LIBRARY HEADER
"""

import pathlib
import re
import subprocess
import sys
import unittest

LIBRARY, HEADER = sys.argv[1:3]


def read(*command):
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout


class Exports(unittest.TestCase):
    def test_only_what_the_header_declares(self):
        shown = {line.split()[-1] for line in read("nm", "-D", "--defined-only", LIBRARY).splitlines()}
        header = pathlib.Path(HEADER).read_text(encoding="utf-8")
        declared = set(re.findall(r"^SF_API [^(]*?\b(sf_\w+)\(", header, re.MULTILINE))
        self.assertGreater(len(declared), 20)
        self.assertEqual(shown, declared)

    def test_it_has_a_version(self):
        self.assertIn("Library soname: [libsoftfinger.so.0]", read("readelf", "--dynamic", LIBRARY))


unittest.main(argv=sys.argv[:1])
