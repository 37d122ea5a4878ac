"""Warnings of the package, which name the line that called it."""
from __future__ import annotations

import sys
import warnings

from . import _snowglass

PACKAGE = __name__.partition(".")[0]


def warn(text: str) -> None:
    """The core calls this too."""
    level, frame = 1, sys._getframe()
    while frame.f_back and \
            frame.f_globals.get("__name__", "").partition(".")[0] == PACKAGE:
        level, frame = level + 1, frame.f_back
    warnings.warn(text, _snowglass.SnowglassWarning, stacklevel=level)
