"""The blocks of docs/python.md run, one after the other; one that needs what is
not there says so in its first line.  So does the program that it names."""
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest
import warnings

DOCUMENT = pathlib.Path(__file__).resolve().parents[2] / "docs" / "python.md"


class Documents(unittest.TestCase):
    def test_blocks_run(self):
        blocks = re.findall(r"```python\n(.*?)```",
                            DOCUMENT.read_text(encoding="utf-8"), re.S)
        self.assertGreater(len(blocks), 5)
        known, here = {}, os.getcwd()
        with tempfile.TemporaryDirectory() as folder:
            os.chdir(folder)
            try:
                for block in blocks:
                    self.run_block(block, known)
            finally:
                os.chdir(here)

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

    @unittest.skipIf(os.environ.get("SNOW_SANITIZED"), "memory is not its own")
    def test_overhead_is_measured(self):
        program = pathlib.Path(__file__).with_name("overhead.py")
        ended = subprocess.run([sys.executable, "-B", program, "--once"],
                               capture_output=True, text=True)
        self.assertEqual(ended.returncode, 0, ended.stdout + ended.stderr)
        self.assertEqual(ended.stdout.count("at most"), 4, ended.stdout)


if __name__ == "__main__":
    unittest.main()
