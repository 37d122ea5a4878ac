"""Colour maps of Matplotlib and opacities by name, as lists that the library
knows: colours and opacities at data values, which are known with a volume."""
from __future__ import annotations

import dataclasses
import math
from typing import Any, Callable, Optional, Sequence

from . import _snowglass
from ._looks import Look, look_of, plain

MOST = 32      # points of a list of colours (SNOW_COLORMAP_POINTS_MAX)
ENTRIES = 256  # of a map that is fitted
RAMP = 33      # points of an opacity by name
RGB = Sequence[float]


def is_own(name: str) -> bool:
    """Whether the library has a map, or it is a list of colours."""
    known = {plain(each) for each in _snowglass.names("colormaps")}
    same = plain(name)
    return ":#" in name or same in known or \
        same[-1:] == "r" and same[:-1] in known or same in ("gray", "grayr", "reversed")


def other(given: Any) -> Any:
    """A map of Matplotlib, by its name or itself; None: one of the library, or none
    at all, of which the library tells."""
    if callable(given):
        return given
    if given is None or is_own(given):
        return None
    try:
        from matplotlib import colormaps  # type: ignore[import]
    except ImportError:
        return None
    return colormaps.get(given) if given in colormaps else None


def _fitted(colors: Sequence[RGB]) -> list[int]:
    """Entries between which the others are nearly on lines: the farthest one is
    added until there are enough."""
    def distance(at: int, low: int, high: int) -> float:
        share = (at - low) / (high - low)
        return max(abs(a + share * (b - a) - c) for a, b, c in
                   zip(colors[low], colors[high], colors[at]))
    taken = [0, len(colors) - 1]
    while len(taken) < MOST:
        far, at = max(((distance(n, low, high), n)
                       for low, high in zip(taken, taken[1:])
                       for n in range(low + 1, high)), default=(0.0, 0))
        if far < 0.5 / 255:
            break
        taken = sorted([*taken, at])
    return taken


def _list(made: Any, place: Callable[[float], float]) -> str:
    """A map as the library's list of colours at data values."""
    entries = [tuple(map(float, made(n / (ENTRIES - 1)))) for n in range(ENTRIES)]
    return ",".join(
        f"{place(n / (ENTRIES - 1))!r}:#" +
        "".join(f"{round(255 * min(max(part, 0), 1)):02x}" for part in entries[n][:3])
        for n in _fitted([each[:3] for each in entries]))


def _placed(ramp: Any) -> Callable[[float], float]:
    """Where a share of the range of a look lies, on its scale: grey is the share."""
    low, high = ramp.domain

    def place(share: float) -> float:
        a, b = low, high
        for _ in range(80):
            middle = a + (b - a) / 2
            if ramp.evaluate(middle)[0] < share:
                a = middle
            else:
                b = middle
        return low if share <= 0 else high if share >= 1 else b
    return place


def _opacity(name: str, share: float) -> float:
    """As PyVista has it: sigmoid from -10 to 10."""
    share = 1 - share if name.endswith("_r") else share
    return share if name.startswith("linear") else \
        1 / (1 + math.exp(10 - 20 * share))


def resolved(volume: Any, look: Any, chosen: Optional[Look] = None) -> Any:
    """A look of lists that the library knows in place of what it does not;
    `chosen`: the same with the range of a mode."""
    if not isinstance(look, (Look, str, type(None))):
        return look  # a transfer function, or several
    given = look_of(look)
    made, opacity = other(given.colormap), given.opacity
    named = isinstance(opacity, (str, float))
    if made is None and not named:
        return look
    bare = dataclasses.replace(chosen or given, **(
        {"opacity": None} if named else {}), **({"colormap": None} if made else {}))
    grey = dataclasses.replace(bare, colormap="grey")
    place = _placed(volume._look(*grey._arguments()))
    if isinstance(opacity, float):
        usual = volume._look(*bare._arguments()).points[0]
        opacity = [(value, part * opacity) for value, part in usual]
    elif isinstance(opacity, str):
        count = 2 if opacity.startswith("linear") else RAMP
        shares = [n / (count - 1) for n in range(count)]
        opacity = [(place(share), _opacity(opacity, share)) for share in shares]
    return dataclasses.replace(
        given, opacity=opacity,
        colormap=_list(made, place) if made else given.colormap)
