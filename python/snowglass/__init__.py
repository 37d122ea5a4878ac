"""Volumes to pictures, on plain CPUs.

    import snowglass as sg

    sg.render("head.nii.gz").save("head.png")

    volume = sg.Volume(array, spacing=(0.7, 0.7, 1.25))     # NumPy, not copied
    look = sg.Look(preset="ct-bone")
    picture = volume.render(look, view="anterior", azimuth=30, size=(800, 600))

A Volume is a grid of samples with its place in the world, a Look says how
values become colours and opacities, an Image is a picture.  All of them are
exactly what the command line tool `snowglass` has.
"""
from __future__ import annotations

from typing import Any

from ._images import Difference, Image, compare
from ._looks import Look
from ._volumes import Step, Volume, open, render, series
from ._snowglass import Error, FileError, FileExistsError, FileNotFoundError, \
    PermissionError, SnowglassWarning
from . import _snowglass

__version__: str = _snowglass.version()
__all__ = ["Difference", "Error", "FileError", "Image", "Look", "SnowglassWarning",
           "Step", "Viewer", "Volume", "colormaps", "compare", "open", "phantoms",
           "presets", "render", "series", "views"]


def __getattr__(name: str) -> Any:
    """What is imported only when it is used."""
    if name == "Viewer":
        from .viewer import Viewer
        return Viewer
    raise AttributeError(f"module 'snowglass' has no attribute '{name}'")


def presets() -> list[str]:
    """The names of looks that `Look(preset=...)` knows."""
    return _snowglass.names("presets")


def colormaps() -> list[str]:
    """The names of colour maps that `Look(colormap=...)` knows."""
    return _snowglass.names("colormaps")


def phantoms() -> list[str]:
    """The built-in test volumes, opened as "phantom:NAME"."""
    return _snowglass.names("phantoms")


def views() -> list[str]:
    """The sides that `view=` knows."""
    return _snowglass.names("views")
