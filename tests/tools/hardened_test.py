"""The programs as they are built: what the linker and the compiler were asked for is in them."""

import re
import subprocess
import sys
import unittest

PROGRAMS = sys.argv[1:]


def read(*options_and_file):
    return subprocess.run(["readelf", "--wide", *options_and_file], capture_output=True, text=True, check=True).stdout


class Hardened(unittest.TestCase):
    def setUp(self):
        self.assertTrue(PROGRAMS)

    def test_code_is_nowhere_known_beforehand(self):
        for program in PROGRAMS:
            self.assertRegex(read("--file-header", program), r"Type:\s+DYN", program)

    def test_tables_of_functions_cannot_be_written(self):
        for program in PROGRAMS:
            self.assertIn("GNU_RELRO", read("--program-headers", program), program)
            self.assertRegex(read("--dynamic", program), r"BIND_NOW|FLAGS_1.*NOW", program)

    def test_no_memory_is_both_written_and_run(self):
        for program in PROGRAMS:
            for line in read("--program-headers", program).splitlines():
                if re.match(r"\s+(LOAD|GNU_STACK)\s", line):
                    self.assertNotIn("RWE", line, program)

    def test_stacks_and_copies_are_looked_after(self):
        for program in PROGRAMS:
            symbols = read("--dyn-syms", program)
            self.assertIn("__stack_chk_fail", symbols, program)
            self.assertRegex(symbols, r"__(memcpy|read|poll|recv|realpath|snprintf|vsnprintf)_chk", program)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
