"""A second volume in the picture of a first."""
from __future__ import annotations

import dataclasses
import os
from typing import Any, Callable, Mapping, Optional, Union

from . import _arrays, _colormaps, _snowglass
from ._looks import Look, look_of

Told = Optional[Callable[[str, float], Any]]  #: of progress


@dataclasses.dataclass
class Overlay:
    """On the grid of the first, with a look; `path` and `given` are for
    recipes."""
    volume: _snowglass.Volume
    transfer: _snowglass.Transfer
    path: Optional[str]
    given: Look


@dataclasses.dataclass
class Lines:
    """An overlay of slices: `layers` as the core has them, and whether only its
    borders are drawn."""
    layers: tuple[tuple[_snowglass.Volume, _snowglass.Transfer, bool, float], ...]
    outline: bool


def over_slices(base: Any, overlay: Any, look: Union[Look, str, None],
                outline: bool) -> Lines:
    laid = overlaid(base, overlay, look)
    if laid is None:
        if outline:
            raise TypeError("outline is of an overlay: give one")
        return Lines((), False)
    return Lines(((laid.volume, laid.transfer, False,
                   float(laid.given.opacity is not None)),), bool(outline))


def _columns(info: Mapping[str, Any]) -> list[float]:
    return [part for row in info["matrix"] for part in row]


def _opened(base: Any, overlay: Any, told: Told) -> _snowglass.Volume:
    """In the context of the first; an array lies on the grid of that."""
    kind = _snowglass.Volume
    if isinstance(overlay, (str, os.PathLike)):
        return _snowglass.open(kind, os.fsencode(overlay), {"each_time": True},
                               None, 0, told, base)
    info = base._info
    if isinstance(overlay, _snowglass.Volume):
        import numpy
        own = overlay._info
        order = getattr(overlay, "_order", (0, 1, 2))
        own_voxels: Any = numpy.asarray(memoryview(overlay))  # type: ignore[arg-type]
        voxels: Any = own_voxels.transpose([order.index(n) for n in range(3)])
        return _snowglass.wrap(kind, voxels, (0, 1, 2), _columns(own),
                               own["slope"], own["intercept"], own["medical"],
                               own["unit"], base, False)
    voxels = _arrays.like(overlay, base.shape, base._order)
    return _snowglass.wrap(kind, voxels, (0, 1, 2), _columns(info), 1.0, 0.0,
                           info["medical"], info["unit"], base, False)


def _look(volume: _snowglass.Volume, look: Look) -> _snowglass.Transfer:
    fields, *others = look._arguments()
    return volume._look({**fields, "overlay": True}, *others)


def overlaid(base: Any, overlay: Any, look: Union[Look, str, None],
             told: Told = None) -> Optional[Overlay]:
    if overlay is None:
        if look is not None:
            raise TypeError("overlay_look is the look of an overlay: give one")
        return None
    if isinstance(overlay, Overlay):  # of the frames of a movie
        return overlay
    volume = _opened(base, overlay, told)
    # Names and colours of labels stay with the volume that was opened.
    known = overlay if isinstance(overlay, _snowglass.Volume) else volume
    given = look_of(_colormaps.resolved(known, look))
    transfer = _look(known, given)
    volume._regrid(base, transfer.labelled, told)
    if base._planes:
        volume = _snowglass.clipped(_snowglass.Volume, volume, base._planes)
    volume._freeze()
    path = os.fspath(overlay) if isinstance(overlay, (str, os.PathLike)) else None
    return Overlay(volume, transfer, path, given)
