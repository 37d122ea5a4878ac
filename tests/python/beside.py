"""What the tests of the package share: a folder, and the command line beside it.

    cd tests/python && SNOWGLASS=../../build/snowglass PYTHONPATH=../../build/python \\
        python3 -m unittest -v test_tool
"""
import importlib.util
import json
import os
import shlex
import subprocess
import sys
import tempfile
import unittest
import warnings

import numpy

import snowglass as sg

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)),
                                "..", "support"))
# Other processes begin in the folders of tests.
if "PYTHONPATH" in os.environ:
    os.environ["PYTHONPATH"] = os.pathsep.join(map(
        os.path.abspath, os.environ["PYTHONPATH"].split(os.pathsep)))
TOOL = os.path.abspath(os.environ.get("SNOWGLASS", "snowglass"))
TIER = os.environ.get("SNOW_TIER", "short")
PICTURES = {"short": 60, "long": 120, "release": 10000}[TIER]
# A sanitizer keeps what is freed, and takes its time.
plain = unittest.skipIf(os.environ.get("SNOW_SANITIZED"), "of plain builds")
# Under valgrind a row of a picture takes longer than these wait.
quick = unittest.skipIf(os.environ.get("SNOW_SANITIZED") == "valgrind",
                        "of quicker machines")


def needs(*names):
    """Of a test: skipped where a module is missing."""
    missing = [name for name in names if not importlib.util.find_spec(name)]
    return unittest.skipIf(missing, f"missing: {missing}")


def resident():
    with open("/proc/self/statm", encoding="ascii") as file:
        return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE")


class InFolder(unittest.TestCase):
    """A test in a folder of its own; warnings are errors, if it is strict."""
    strict = True

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.addCleanup(os.chdir, os.getcwd())
        os.chdir(folder.name)
        if self.strict:
            caught = warnings.catch_warnings()
            caught.__enter__()
            self.addCleanup(caught.__exit__, None, None, None)
            warnings.simplefilter("error")

    def tool(self, *words):
        subprocess.run([TOOL, *words, "-y", "-q"], check=True,
                       stderr=subprocess.DEVNULL)

    def bytes_of(self, path):
        with open(path, "rb") as file:
            return file.read()

    def same_bytes(self, *paths):
        self.assertEqual(*map(self.bytes_of, paths))

    def same_picture(self, one, other):
        self.assertEqual(sg.compare(one, other).largest, 0)

    def same(self, images, *words, suffix=".png", **saving):
        """The tool makes the same file of a picture, or of each of several."""
        self.tool(*words, "-o", "tool" + suffix)
        for image in images if isinstance(images, list) else [images]:
            image.save("ours" + suffix, **saving)
            self.same_bytes("tool" + suffix, "ours" + suffix)

    def same_floats(self, image, *words):
        self.tool(*words, "-o", "tool.npy")
        expected = numpy.load("tool.npy")
        if expected.ndim == 3 and expected.shape[-1] != image.shape[-1]:
            expected = expected[..., [0, 3]]  # grey, written wide
        numpy.testing.assert_array_equal(numpy.asarray(image), expected)

    def same_frames(self, make, *words, frames=2):
        """The tool makes the same frames."""
        self.tool(*words, "--frames", str(frames), "-o", "tool_%d.png")
        make("ours_%d.png", frames=frames, overwrite=True)
        for n in range(frames):
            self.same_bytes(f"tool_{n}.png", f"ours_{n}.png")

    def round_trip(self, image, volume=None):
        """A recipe makes the picture again, and so does the command."""
        recipe = json.loads(json.dumps(image.recipe))
        again = sg.render(**recipe) if volume is None else \
            sg.render(volume, **recipe)
        self.assertEqual(again.checksum, image.checksum)
        self.assertEqual(again.recipe, image.recipe)
        if volume is None:
            words = shlex.split(image.command)
            self.assertEqual(words[0], "snowglass")
            drawn = words[1] == "slice" or "legend" in recipe  # not in floats
            (self.same if drawn else self.same_floats)(image, *words[1:])
