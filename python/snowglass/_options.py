"""Options of the command line as keyword arguments: their types, and what they
are where they are not given.

Made by `python3 scripts/manual build/table.json keywords` of the option table
(programs/options/option_table.c): do not edit; a test compares."""
from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any, Callable, Literal, Mapping, Sequence,     TypedDict

Path = str | os.PathLike[str]
Progress = Callable[[str, float], Any] | bool
if TYPE_CHECKING:
    import datetime
    from numpy import datetime64
    from numpy.typing import NDArray
    Time = int | str | datetime.date | datetime64
    Numbers = Sequence[float] | NDArray[Any]
    Points = Sequence[Numbers] | NDArray[Any]


class Colors(TypedDict, total=False):
    """Of a look."""
    preset: str | None
    colormap: Any | None
    opacity: Points | str | float | None
    gradient_opacity: Points | None
    window: Numbers | None
    range: str | Numbers | None
    scale: str | None
    cmap: Any | None
    clim: str | Numbers | None
    colors: Sequence[tuple[float, Numbers]] | None


class Shot(TypedDict, total=False):
    """Of a picture, but its mode and look."""
    size: int | Numbers | None
    depth: bool | None
    iso: float | None
    threshold: float | None
    encoding: Literal["auto", "crs", "bitmap", "rle"] | None
    method: Literal[
        "auto", "original", "footprint", "shear-warp", "raycast"] | None
    kernel: str | None
    shade: bool | str | None
    light: str | Numbers | None
    material: Numbers | None
    depth_darkening: float | None
    occlusion: float | None
    quality: Literal["draft", "normal", "high"] | None
    view: str | None
    azimuth: float | None
    elevation: float | None
    roll: float | None
    zoom: float | None
    fit: Literal["visible", "volume"] | None
    perspective: bool | float | None
    position: Numbers | None
    target: Numbers | None
    up: Numbers | None
    letters: bool | None
    legend: bool | str | None
    measure: str | None
    overlay: Any | None
    overlay_look: Any | None
    threads: int | None
    deterministic: bool | None
    isa: Literal[
        "auto", "scalar", "avx2", "avx512", "sse4", "neon", "wasm"] | None
    opacity_length: float | None
    progress: Progress | None


class Picture(Colors, Shot, total=False):
    """Of a picture."""
    mode: Literal["over", "mip", "minip", "mean", "sum", "iso"] | None


class Movie(Picture, total=False):
    """Of a turntable."""
    background: str | Numbers | None


class Data(TypedDict, total=False):
    """Of a volume: of files, then of arrays."""
    dims: Numbers | None
    type: Any | None
    spacing: float | Numbers | None
    endian: Literal["little", "big"] | None
    offset: int | None
    time: Time | None
    dataset: str | None
    channel: Any | None
    component: str | int | None
    crop: Points | None
    series: str | int | None
    allow_gaps: bool | None
    suv: Literal["bw", "lbm", "bsa", "none"] | None
    levels: int | None
    vertical: Literal["levels", "height"] | None
    z_scale: float | str | None
    mask: Path | None
    labels: str | int | None
    label_table: Path | None
    clip: Points | None
    affine: Any | None
    axes: str | None
    unit: str | None
    medical: bool | None
    slope: float | None
    intercept: float | None
    copy: bool | None
    frozen: bool | None
    memory: int | None


class Source(Data, total=False):
    """The same when it is opened."""
    progress: Progress | None


class Whole(Picture, Data, total=False):
    """Of a volume and its picture or slice."""
    axis: str | int | None
    at: int | str | None
    open: Mapping[str, Any] | None


#: Where nothing is given.
DEFAULTS: dict[str, Any] = {
    "azimuth": 0,
    "depth_darkening": 0,
    "deterministic": False,
    "elevation": 0,
    "encoding": "auto",
    "fit": "visible",
    "fps": 25,
    "frames": 120,
    "isa": "auto",
    "kernel": "auto",
    "letters": True,
    "method": "auto",
    "occlusion": 0,
    "quality": "normal",
    "roll": 0,
    "size": 512,
    "threads": 0,
    "threshold": 0,
    "zoom": 1,
}
