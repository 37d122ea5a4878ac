"""Tests of pictures with pytest: the fixture `snowglass_compare`.

In conftest.py:

    pytest_plugins = ["snowglass.pytest_plugin"]

In a test:

    def test_head(snowglass_compare):
        image = snowglass.render("head.nii.gz")
        snowglass_compare(image, "head.png", tolerance=2 / 255)

Pictures are compared with those in the folder `baseline` beside the test;
`tolerance` is the largest difference of a channel, 0 to 1, that passes.
`pytest --snowglass-update` writes them anew: look at them before you commit.
A picture that differs is kept beside the baseline as NAME.failed.png.
"""
from __future__ import annotations

import os
from typing import Any, Callable

import pytest

from . import _checks
from ._images import Image, compare


def pytest_addoption(parser: Any) -> None:
    parser.addoption("--snowglass-update", action="store_true",
                     help="write the pictures that tests compare with")


@pytest.fixture
def snowglass_compare(request: Any) -> Callable[..., None]:
    """Fails unless a picture is that of a file, but for a tolerance."""
    folder = os.path.join(os.path.dirname(str(request.path)), "baseline")

    def check(image: Image, name: str, tolerance: float = 2 / 255) -> None:
        if not isinstance(image, Image):
            raise _checks.fault("image", "a snowglass.Image", image)
        baseline = os.path.join(folder, name)
        if request.config.getoption("--snowglass-update"):
            os.makedirs(os.path.dirname(baseline), exist_ok=True)
            image.save(baseline)
            return
        if not os.path.exists(baseline):
            pytest.fail(f"{baseline}: there is no such picture; write it by "
                        f"pytest --snowglass-update", pytrace=False)
        root, suffix = os.path.splitext(baseline)
        failed = f"{root}.failed{suffix}"
        image.save(failed)
        expected = Image.load(baseline)
        if expected.shape[:2] != image.shape[:2]:
            pytest.fail(f"{name}: the picture has {image.width}x{image.height} "
                        f"pixels, not {expected.width}x{expected.height}; see "
                        f"{failed}", pytrace=False)
        found = compare(Image.load(failed), expected)
        if found.largest > tolerance:
            pytest.fail(f"{name}: differs by {found.largest:.4g} at "
                        f"({found.x}, {found.y}), PSNR {found.psnr:.1f} dB; "
                        f"the limit is {tolerance:.4g}; see {failed}",
                        pytrace=False)
        os.remove(failed)

    return check
