"""The notebooks of examples run from their first cell to their last, draw, and are stored without what they gave.

    notebooks_test.py SOURCE_FOLDER
"""

import json
import pathlib
import sys
import unittest

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

ROOT = pathlib.Path(sys.argv[1])


class Notebooks(unittest.TestCase):
    def test_each(self):
        notebooks = sorted((ROOT / "examples/notebooks").glob("*.ipynb"))
        self.assertGreaterEqual(len(notebooks), 4)
        for notebook in notebooks:
            with self.subTest(notebook.name):
                self.run_through(json.loads(notebook.read_text(encoding="utf-8")))

    def run_through(self, notebook):
        self.assertEqual(notebook["nbformat"], 4)
        names = {}
        for cell in notebook["cells"]:
            if cell["cell_type"] == "code":
                self.assertEqual((cell["outputs"], cell["execution_count"]), ([], None))
                exec(compile("".join(cell["source"]), "cell", "exec"), names)  # pylint: disable=exec-used
        drawn = [axes for number in plt.get_fignums() for axes in plt.figure(number).axes if axes.has_data()]
        self.assertGreater(len(drawn), 0)
        plt.close("all")


unittest.main(argv=sys.argv[:1])
