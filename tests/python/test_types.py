"""What editors and mypy are told: the options of the command line, as they are."""
import inspect
import os
import re
import subprocess
import sys
import unittest

import snowglass as sg
from beside import needs, plain
from snowglass import _options

HERE = os.path.dirname(os.path.abspath(__file__))
SOURCES = os.path.join(HERE, "..", "..")
TABLE = os.path.join(os.path.dirname(os.path.abspath(
    os.environ.get("SNOWGLASS", "."))), "table.json")


def checked(*paths, folder="."):
    """(file, line) of what mypy finds.  Its old versions know keywords of a table
    as a test only."""
    from mypy.version import __version__ as version
    old = tuple(map(int, version.split(".")[:2])) < (1, 7)
    flags = ["--enable-incomplete-feature=Unpack"] if old else []
    said = subprocess.run(
        [sys.executable, "-m", "mypy", "--strict", "--no-warn-return-any", *flags, *paths],
        cwd=folder, capture_output=True, text=True).stdout
    return [(os.path.basename(name), int(line)) for name, line in
            re.findall(r"(?m)^([^:\n]+):(\d+): error", said)], said


@plain
class Types(unittest.TestCase):
    @needs("mypy", "pytest")
    def test_wrong_names_and_values_are_found_and_no_others(self):
        path = os.path.join(HERE, "wrong_names.py")
        with open(path, encoding="utf-8") as file:
            wrong = {n for n, line in enumerate(file, 1) if line.endswith("# wrong\n")}
        package = os.path.dirname(os.path.dirname(os.path.abspath(sg.__file__)))
        found, said = checked("snowglass", path, folder=package)
        self.assertEqual({name for name, _ in found}, {"wrong_names.py"}, said)
        self.assertEqual({line for _, line in found}, wrong, said)

    @unittest.skipUnless(os.path.exists(TABLE), "the build has no table of options")
    def test_the_module_is_made_of_the_table_as_it_is(self):
        made = subprocess.run(
            [sys.executable, "-B", os.path.join(SOURCES, "scripts", "manual"), TABLE,
             "keywords"], check=True, capture_output=True, text=True).stdout
        with open(os.path.join(SOURCES, "python", "snowglass", "_options.py"),
                  encoding="utf-8") as file:
            self.assertEqual(file.read(), made, "make it anew, as its head says")

    def test_help_names_them_all(self):
        names = inspect.signature(sg.Volume.render).parameters
        self.assertLessEqual(set(_options.Picture.__annotations__), set(names))
        self.assertEqual(names["size"].default, 512)
        turn = inspect.signature(sg.Volume.turntable).parameters
        self.assertEqual((turn["frames"].default, turn["fps"].default), (120, 25))
        self.assertEqual(inspect.signature(sg.Volume.project).parameters["fit"].default,
                         "volume")
        with self.assertRaisesRegex(TypeError, "no option 'qualty'; take one of"):
            sg.Volume("phantom:head", dims=(8, 8, 8)).render(qualty="high")


if __name__ == "__main__":
    unittest.main()
