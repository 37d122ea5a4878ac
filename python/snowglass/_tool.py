"""The command `snowglass` of a package for pip: becomes the program that the
package has in it."""
from __future__ import annotations

import os
import sys


def main() -> None:
    tool = os.path.join(os.path.dirname(os.path.abspath(__file__)), "bin",
                        "snowglass")
    try:
        os.execv(tool, ["snowglass", *sys.argv[1:]])
    except OSError as error:
        sys.exit(f"snowglass: {tool} cannot be started ({error.strerror}); "
                 "install the package again")
