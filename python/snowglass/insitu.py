"""Pictures of a running simulation, over the communicator of mpi4py.

    from mpi4py import MPI
    from snowglass import insitu

    movie = insitu.Movie(MPI.COMM_WORLD, dims=(nx, ny, nz), output="rho_%04d.png",
                         colormap="viridis", range=(0, 1), size=(800, 600))
    movie.brick(rho, first=(0, 0, z0))       # this rank's part, [z, y, x]
    for step in range(steps):
        advance(rho)
        movie.step(step)
"""
from __future__ import annotations

import json
import math
import operator
import weakref
from typing import Any, Mapping, Optional, Sequence

try:
    from . import _insitu
except ImportError as missing:
    raise ImportError(f"pictures in situ for Python need a Snowglass with MPI "
                      f"(Debian: install python3-snowglass-mpi): {missing}"
                      ) from missing


def _three(name: str, given: Any, kind: Any) -> tuple[Any, Any, Any]:
    """Three numbers along x, y, z."""
    try:
        if isinstance(given, (str, bytes)):
            raise TypeError
        x, y, z = map(kind, given)
    except (TypeError, ValueError):
        what = "whole numbers" if kind is operator.index else "numbers"
        raise TypeError(f"{name}: give three {what}, along x, y, z, not "
                        f"{given!r}") from None
    for number in (x, y, z):
        if kind is operator.index and not -2 ** 63 <= number < 2 ** 63:
            raise ValueError(f"{name}: {number} is out of range; give numbers of "
                             f"64 bits")
        if kind is float and not math.isfinite(number):
            raise ValueError(f"{name}: {number} is not a finite number")
    return x, y, z


def _whole(name: str, given: Any, least: int = 0, bits: int = 31) -> int:
    try:
        number = operator.index(given)
    except TypeError:
        raise TypeError(f"{name}: must be a whole number, not {given!r}") from None
    if not least <= number < 2 ** bits:
        raise ValueError(f"{name}: {number} is out of range; give {least} to "
                         f"{2 ** bits - 1}")
    return number


def _sides(halo: Any) -> tuple[tuple[int, ...], tuple[int, ...]]:
    """Layers before and behind along x, y, z: of one number for all sides, or of
    three along the axes, each a number or a pair."""
    try:
        axes = [halo] * 3 if isinstance(halo, (str, bytes)) else list(halo)
    except TypeError:
        axes = [halo] * 3
    pairs = [tuple(axis) if isinstance(axis, (tuple, list)) else (axis, axis)
             for axis in axes]
    if [len(pair) for pair in pairs] != [2, 2, 2]:
        raise TypeError(f"halo: give a whole number, or three along x, y, z, each a "
                        f"number or a pair (before, behind), not {halo!r}")
    low, high = (tuple(_whole("halo", pair[side]) for pair in pairs)
                 for side in range(2))
    return low, high


class Movie:
    """A movie of one field of a simulation, whose ranks each hold a part.

    comm      of mpi4py; the MPI must be the one that Snowglass was built with
    dims      voxels of the whole grid along x, y, z
    origin, spacing   its place in the world
    recipe    keys of a recipe (`Image.recipe`, or a file that the command line
              has saved), and keywords the same: output, size, view, preset,
              colormap, range, opacity, mode, legend, title, annotate, ...

    Arguments are alike on all ranks.  `close` ends the movie, on all ranks and
    before MPI ends; so does leaving it as a context.
    """

    def __init__(self, comm: Any, dims: Sequence[int], *,
                 origin: Sequence[float] = (0, 0, 0),
                 spacing: Sequence[float] = (1, 1, 1),
                 recipe: Optional[Mapping[str, Any]] = None,
                 **keys: Any) -> None:
        given = {**(recipe or {}), **{name.replace("_", "-"): value
                                      for name, value in keys.items()}}
        given.pop("input", None)
        self._arrays: dict[int, Any] = {}
        if not hasattr(comm, "py2f"):
            raise TypeError(f"comm: give a communicator of mpi4py, such as "
                            f"MPI.COMM_WORLD, not {type(comm).__name__}")
        self._held: list[Any] = [_insitu.new(comm.py2f())]
        # At the latest before MPI ends, which is after Python's own functions.
        weakref.finalize(self, self._held.clear)
        _insitu.grid(self._movie, _three("dims", dims, operator.index),
                     _three("origin", origin, float),
                     _three("spacing", spacing, float))
        output = given.get("output")
        _insitu.recipe(self._movie, json.dumps(given, allow_nan=False),
                       output if isinstance(output, str) else None)

    @property
    def _movie(self) -> Any:
        if not self._held:
            raise ValueError("the movie is closed")
        return self._held[0]

    def brick(self, array: Any, first: Sequence[int] = (0, 0, 0), *,
              halo: Any = 0, cells: Any = 1, id: int = 0) -> None:
        """This rank's part of the field: an array [z, y, x] whose voxel at
        (0, 0, 0) is `first` (x, y, z) of the grid.  It is used in place, in
        whatever order its axes lie, and read by each `step`.

        halo   layers of other ranks' voxels around it that the array has too and
               that are up to date; `first` is behind them. One number for all
               sides, or three along x, y, z, each a number or a pair of the layers
               before and behind
        cells  voxels of the grid that one value of the array is wide, on a coarser
               level of refinement: a number, or three along x, y, z; `first` and the
               grid count voxels of the finest level, halo counts values
        id     a number for each part of a rank that has several

        What the library refuses here the next `step` raises too, so that all
        ranks know of it. Later steps draw the brick that was corrected.
        """
        import numpy
        voxels = numpy.asarray(array)
        (low, high), id = _sides(halo), _whole("id", id)
        wide = _three("cells", (cells,) * 3 if isinstance(cells, int) else cells,
                      operator.index)
        around = [a + b for a, b in zip(low, high)][::-1]
        if voxels.ndim != 3 or any(side <= halo for side, halo
                                   in zip(voxels.shape, around)):
            raise ValueError(f"a brick must be an array of three dimensions with "
                             f"voxels within its halo, not {voxels.shape}")
        if any(step % voxels.itemsize or step <= 0 for step in voxels.strides):
            raise ValueError("a brick's steps in memory must be whole values, and "
                             "rise; copy the array")
        if voxels.dtype.kind not in "iuf" or voxels.dtype.itemsize > 8 or \
                voxels.dtype == numpy.float16:
            raise TypeError(f"a brick of {voxels.dtype}: must be of integers, "
                            f"float32 or float64; convert it")
        if not voxels.dtype.isnative:
            raise ValueError("a brick must have this machine's order of bytes")
        inner = voxels[low[2]:, low[1]:, low[0]:]
        count = [(side - halo) * width for side, halo, width
                 in zip(voxels.shape[::-1], around[::-1], wide)]
        strides = [step // voxels.itemsize for step in voxels.strides[::-1]]
        _insitu.brick(self._movie, id, _three("first", first, operator.index),
                      tuple(count), wide, low, high, voxels.dtype.name, inner.ctypes.data,
                      tuple(strides))
        self._arrays[id] = voxels  # as long as it is read

    def step(self, number: int, time: float = float("nan"),
             unit: str = "") -> None:
        """Draws the fields as they are and writes a picture; collective.  With
        annotate="time" it shows the physical time, or else the number."""
        try:
            seconds = float(time)
        except (TypeError, ValueError, OverflowError):
            raise TypeError(f"time: must be a number, not {time!r}") from None
        if math.isinf(seconds):
            raise ValueError("time: must be finite, or NaN for none")
        _insitu.step(self._movie, _whole("number", number, -2 ** 63, 63),
                     seconds, unit)

    def close(self) -> None:
        """Ends the movie; collective."""
        self._held.clear()
        self._arrays.clear()

    def __enter__(self) -> "Movie":
        return self

    def __exit__(self, *_: Any) -> None:
        self.close()
