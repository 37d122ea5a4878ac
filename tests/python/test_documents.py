"""The blocks of docs/python.md run, one after the other; one that needs what is
not there says so in its first line.  So does the program that it names, and so do the
examples in the modules' own texts, with stand-ins for what they name."""
import ast
import os
import pathlib
import re
import subprocess
import sys
import unittest
import warnings

import numpy

import snowglass as sg
from beside import InFolder

DOCUMENT = pathlib.Path(__file__).resolve().parents[2] / "docs" / "python.md"


class Documents(InFolder):
    strict = False

    def test_blocks_run(self):
        blocks = re.findall(r"```python\n(.*?)```",
                            DOCUMENT.read_text(encoding="utf-8"), re.S)
        self.assertGreater(len(blocks), 5)
        known = {}
        for block in blocks:
            self.run_block(block, known)

    def test_the_answer_about_figures_is_right(self):
        """The figure is what is seen of the picture, and names its density."""
        try:
            import PIL.Image  # type: ignore[import]
        except ImportError:
            self.skipTest("there is no Pillow")
        text = DOCUMENT.with_name("questions.md").read_text(encoding="utf-8")
        block, = re.findall(r"```python\n(.*?)```", text, re.S)
        exec(compile(block, "questions.md", "exec"), {})
        with PIL.Image.open("head.png") as one, PIL.Image.open("figure.png") as other:
            whole, figure, densities = numpy.asarray(one), numpy.asarray(other), other.info["dpi"]
        seen = whole[..., -1] > 0
        rows, columns = (numpy.flatnonzero(seen.any(axis)) for axis in (1, 0))
        self.assertLess(max(figure.shape[:2]), len(whole))
        numpy.testing.assert_array_equal(figure, whole[rows[0]:rows[-1] + 1,
                                                       columns[0]:columns[-1] + 1])
        for density in densities:
            self.assertAlmostEqual(density, 300, delta=0.1)

    def run_block(self, block, known):
        needs = re.match(r"# needs (\w+).*\n", block)
        if needs and needs.group(1) == "files":
            compile(block, "python.md", "exec")
            return
        if needs:
            try:
                __import__(needs.group(1))
            except ImportError:
                return
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            exec(compile(block, "python.md", "exec"), known)

    def test_examples_of_modules_run(self):
        package = pathlib.Path(sg.__file__).resolve().parent
        array = numpy.zeros((24, 28, 32), numpy.int16)
        array[6:18, 8:20, 10:22] = 700
        ran = {}
        for path in (package / f"{name}.py" for name in (
                "__init__", "viewer", "insitu", "pytest_plugin")):
            tree = ast.parse(path.read_text(encoding="utf-8"))
            text = ast.get_docstring(tree, clean=False)
            example = "\n".join(line[4:] for line in (text or "").splitlines()
                                if line.startswith("    "))
            code = compile(example, path.name, "exec")
            if path.stem not in ("__init__", "viewer"):  # others need MPI or pytest
                continue
            ran[path.stem] = {"array": array, "snowglass": sg,
                              "volume": sg.Volume(array)}
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                sg.Volume(array).save("head.nii.gz")
                exec(code, ran[path.stem])
        self.assertEqual(ran["__init__"]["picture"].shape[:2], (600, 800))
        self.assertIsInstance(ran["viewer"]["viewer"], sg.Viewer)
        ran["viewer"]["viewer"].close()

    def test_the_example_draws(self):
        program = DOCUMENT.parents[1] / "examples" / "picture.py"
        subprocess.run([sys.executable, "-B", program, "blob.png"], check=True)
        pixels = numpy.asarray(sg.Image.load("blob.png"))
        self.assertEqual(pixels.shape[:2], (512, 512))
        self.assertGreater(numpy.ptp(pixels[200:300, 200:300, 1]), 0.05)

    @unittest.skipIf(os.environ.get("SNOW_SANITIZED"), "memory is not its own")
    def test_overhead_is_measured(self):
        program = pathlib.Path(__file__).with_name("overhead.py")
        ended = subprocess.run([sys.executable, "-B", program, "--once"],
                               capture_output=True, text=True)
        self.assertEqual(ended.returncode, 0, ended.stdout + ended.stderr)
        self.assertEqual(ended.stdout.count("at most"), 4, ended.stdout)
