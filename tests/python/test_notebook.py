"""The viewer's widget in Chromium, in two cells of a page as a notebook is; the
picture at rest is that of its recipe."""
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

import snowglass as sg

HERE = pathlib.Path(__file__).resolve().parent
#: Where ./dev puts what drives the browser: beside the package of the build.
PLAYWRIGHT = pathlib.Path(sg.__file__).parents[2] / "web" / "node_modules" / \
    "playwright-core" / "index.mjs"


class Notebook(unittest.TestCase):
    def test_two_cells(self):
        node, chromium = shutil.which("node"), shutil.which("chromium")
        if not node or not chromium or not PLAYWRIGHT.exists():
            self.skipTest("node, chromium or playwright-core is missing")
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "head.nrrd")
            sg.Volume("phantom:head", dims=(64, 64, 56)).save(path)
            done = subprocess.run(
                [node, HERE / "notebook.mjs", PLAYWRIGHT, chromium,
                 sys.executable, HERE / "notebook_kernel.py", path, folder],
                env={**os.environ, "PYTHONPATH": os.path.dirname(
                    os.path.dirname(sg.__file__))}, timeout=400)
            self.assertEqual(done.returncode, 0)
            self.assertGreater(sg.Image.load(
                os.path.join(folder, "rest.png")).width, 300)
