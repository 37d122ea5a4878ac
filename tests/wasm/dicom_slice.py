"""Slices of a ball in DICOM, for tests of the page without a server."""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)),
                                "..", "support"))
from dicom import PLAIN, dicom_slice  # noqa: E402

SIDE = 24


def dicom(z, syntax=PLAIN):
    """One of 11; of other syntaxes its pixels are damaged."""
    ball = [max(0, 1000 - 8 * ((x - 12) ** 2 + (y - 11) ** 2 + 4 * (z - 5) ** 2))
            for y in range(SIDE) for x in range(SIDE)]
    return dicom_slice(z, ball, height=2 * z, syntax=syntax)
