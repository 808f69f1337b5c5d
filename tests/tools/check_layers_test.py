"""tools/check_layers must find each kind of violation, and only those."""

import pathlib
import subprocess
import sys
import tempfile
import unittest

CHECK = pathlib.Path(__file__).resolve().parents[2] / "tools" / "check_layers"
TABLE = """# Architecture

| module | subject | may include (besides base) |
| --- | --- | --- |
| base | units | std, Eigen |
| geometry | poses | |
| device | what touches back | geometry |
| engine | the loop | all above |
| viewer | the page | engine, geometry |
| rendering.hpp (beside the modules) | the door | all but viewer |
| c_interface | the same from C | rendering.hpp, device |
| apps/softfinger | the command line | all |

```house
      | apps/softfinger |
        | c_interface |
| viewer | rendering.hpp |   who looks on
          | engine |
          | device |
         | geometry |
           | base |
```
"""


class CheckLayers(unittest.TestCase):
    def run_on(self, files, table=TABLE):
        """Output of the check on a tree that holds these files."""
        with tempfile.TemporaryDirectory() as folder:
            for path, text in {"docs/architecture.md": table, **files}.items():
                file = pathlib.Path(folder, path)
                file.parent.mkdir(parents=True, exist_ok=True)
                file.write_text(text)
            run = subprocess.run([sys.executable, CHECK, folder], capture_output=True, text=True)
            self.assertEqual(run.returncode, 1 if run.stdout else 0, run.stderr)
            return run.stdout

    def test_allowed_includes_pass(self):
        self.assertEqual("", self.run_on({
            "src/softfinger/device/device.hpp":
                '#include <vector>\n#include <Eigen/Core>\n#include "softfinger/geometry/pose.hpp"\n'
                '#include "softfinger/base/units.hpp"\n#include "softfinger/device/tilt.hpp"\n',
            "src/softfinger/device/device.cpp": "#include <fmt/core.h>\n",
            "src/softfinger/engine/loop.cpp": '#include "softfinger/device/device.hpp"\n',
            "src/softfinger/rendering.cpp": '#include "softfinger/engine/loop.hpp"\n',
            "apps/softfinger/main.cpp":
                '#include "commands.hpp"\n#include "softfinger/viewer/server.hpp"\n#include "softfinger/rendering.hpp"\n',
        }))

    def test_the_room_above_the_door_goes_through_it_and_owns_its_header(self):
        header = '#include "softfinger/rendering.hpp"\n#include "softfinger/softfinger.h"\n#include "softfinger/device/device.hpp"\n'
        device = {"src/softfinger/device/device.cpp": '#include "softfinger/geometry/pose.hpp"\n',
                  "src/softfinger/engine/loop.cpp": "\n"}
        self.assertEqual("", self.run_on({"src/softfinger/c_interface/step.cpp": header, **device}))
        output = self.run_on({"src/softfinger/viewer/page.cpp": '#include "softfinger/softfinger.h"\n'})
        self.assertIn("viewer/page.cpp:1: viewer may not include c_interface", output)
        output = self.run_on({"src/softfinger/engine/loop.cpp": '#include "softfinger/rendering.hpp"\n'})
        self.assertIn("engine may not include the public door", output)

    def test_include_against_the_order_is_named_with_its_line(self):
        output = self.run_on({"src/softfinger/geometry/pose.cpp": '\n#include "softfinger/device/device.hpp"\n'})
        self.assertIn("src/softfinger/geometry/pose.cpp:2: geometry may not include device", output)

    def test_what_stands_above_but_not_on_the_line(self):
        self.assertIn("viewer may not include device", self.run_on(
            {"src/softfinger/viewer/server.cpp": '#include "softfinger/device/device.hpp"\n'}))

    def test_door_may_not_include_the_viewer(self):
        self.assertIn("may not include viewer", self.run_on(
            {"src/softfinger/rendering.hpp": '#include "softfinger/viewer/server.hpp"\n'}))

    def test_no_module_goes_through_the_door(self):
        self.assertIn("may not include the public door", self.run_on(
            {"src/softfinger/engine/loop.cpp": '#include "softfinger/rendering.hpp"\n'}))

    def test_headers_of_a_modules_own_include_what_they_like(self):
        self.assertEqual("", self.run_on(
            {"src/softfinger/viewer/server/session.hpp": "#include <boost/beast/core.hpp>\n"}))

    def test_third_party_header_in_a_header(self):
        self.assertIn("third-party header <fmt/core.h>", self.run_on(
            {"src/softfinger/base/text.hpp": "#include <fmt/core.h>\n"}))

    def test_include_path_is_the_path_in_the_tree(self):
        self.assertIn('write "softfinger/<module>/pose.hpp"', self.run_on(
            {"src/softfinger/geometry/pose.cpp": '#include "pose.hpp"\n'}))

    def test_folder_without_a_line(self):
        self.assertIn("belongs to no line", self.run_on({"src/softfinger/utils/text.cpp": "int x;\n"}))

    def test_links_follow_the_same_table(self):
        self.assertIn("geometry may not link device", self.run_on(
            {"src/softfinger/geometry/CMakeLists.txt": "softfinger_module(geometry MODULES device LIBRARIES fmt::fmt)\n"}))

    def test_what_the_table_allows_somebody_needs(self):
        self.assertIn("architecture.md:7: device includes nothing of geometry; take it off the line", self.run_on(
            {"src/softfinger/device/device.cpp": '#include "softfinger/base/units.hpp"\n'}))

    def test_a_house_that_stands_otherwise_than_the_table_says(self):
        self.assertIn("device does not stand above geometry",
                      self.run_on({}, TABLE.replace("| device |\n         | geometry |", "| device | geometry |")))
        self.assertIn("viewer does not stand above engine", self.run_on({}, TABLE.replace("| engine |\n", "").replace(
            "| viewer | rendering.hpp |", "| engine |\n| viewer | rendering.hpp |")))

    def test_a_house_with_a_room_too_few_or_too_many(self):
        self.assertIn("viewer is missing from the house", self.run_on({}, TABLE.replace("| viewer | rendering", "| rendering")))
        self.assertIn("device stands twice", self.run_on({}, TABLE.replace("| engine |\n ", "| engine | device |\n ")))
        self.assertIn("cellar has no line", self.run_on({}, TABLE.replace("| base |\n`", "| base | cellar |\n`")))
        self.assertIn("no picture of the house", self.run_on({}, TABLE.replace("```house", "```")))


if __name__ == "__main__":
    unittest.main()
