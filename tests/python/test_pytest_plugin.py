"""The fixture for tests of pictures, by pytest itself."""
import os
import subprocess
import sys
import tempfile
import unittest

TEST = """
import pytest
import snowglass as sg

def test_picture(snowglass_compare):
    image = sg.Volume("phantom:head", dims=(32, 32, 32)).render(size=48,
                                                                azimuth={0})
    snowglass_compare(image, "head.png")
    snowglass_compare(image, "deeper/folder/head.png")
    with pytest.raises(TypeError, match="image: give a snowglass.Image, not an array"):
        snowglass_compare(image.to_rgb(), "head.png")
"""


class Plugin(unittest.TestCase):
    def setUp(self):
        try:
            import pytest  # noqa: F401
        except ImportError:
            self.skipTest("pytest is not installed")

    def run_test(self, folder, azimuth, *words):
        with open(os.path.join(folder, "test_it.py"), "w",
                  encoding="utf-8") as file:
            file.write(TEST.format(azimuth))
        done = subprocess.run(
            [sys.executable, "-m", "pytest", "-q", "-p",
             "snowglass.pytest_plugin", "-p", "no:cacheprovider", *words,
             folder], check=False, stdout=subprocess.PIPE, text=True,
            stderr=subprocess.STDOUT, cwd=folder)
        return done.returncode, done.stdout

    def test_baselines(self):
        with tempfile.TemporaryDirectory() as folder:
            code, text = self.run_test(folder, 0)
            self.assertEqual(code, 1)
            self.assertIn("there is no such picture", text)
            self.assertEqual(self.run_test(folder, 0, "--snowglass-update")[0],
                             0)
            self.assertEqual(self.run_test(folder, 0)[0], 0)
            code, text = self.run_test(folder, 30)
            self.assertEqual(code, 1)
            self.assertIn("the limit is", text)
            self.assertTrue(os.path.exists(
                os.path.join(folder, "baseline", "head.failed.png")))
