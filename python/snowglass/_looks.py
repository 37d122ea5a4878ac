"""How data values become colours and opacities."""
from __future__ import annotations

import dataclasses
import math
from typing import Any, Optional, Sequence, Tuple, Union

from . import _checks

Range = Union[str, Tuple[float, float]]

#: Opacities by name, along the range; _r: falling.
OPACITIES = ("linear", "linear_r", "sigmoid", "sigmoid_r")


@dataclasses.dataclass(frozen=True)
class Look:
    """A look, before there is a volume; what is not given is chosen from the
    volume's histogram.

    preset        a name of `snowglass.presets()`
    colormap      a name of `snowglass.colormaps()`, reversed by _r; "reversed": those
                  of the look the other way round; or colours at data values,
                  "60:#000000,255:#ff8800"; where Matplotlib is installed also one
                  of its maps, by name or itself; replaces the colours
                  (`cmap` is another name for it)
    range         (low, high): the data values over which colours and opacities
                  are spread; "full": from the smallest to the largest;
                  "1%,99%": percentiles; "robust": the window that the file
                  names, or all values but a few far off; "slices": the same as
                  for slices, up to 1 %; "least": the same as "robust", but of
                  CT air, -1000 to -500, as for mode minip; None: chosen
                  (`clim` is another name)
    opacity       [(value, opacity), ...], opacities 0 to 1 at data values; they
                  replace those of a preset; "linear" or "sigmoid", along the range,
                  falling with _r; or a number 0 to 1, a factor of those that are
                  chosen
    colors        [(value, (red, green, blue)), ...], 0 to 1
    gradient_opacity  [(magnitude, factor), ...]: factors 0 to 1 of opacities by
                  the magnitude of the gradient, in data units per unit of length
    scale         "log": points are joined by logarithms of values; 0 and below is
                  transparent; "symlog": linear around 0 and logarithmic beyond,
                  on both sides, "symlog:5" from 5 on; "linear" else
    """
    preset: Optional[str] = None
    colormap: Any = None
    range: Optional[Range] = None
    opacity: Union[Sequence[Tuple[float, float]], str, float, None] = None
    colors: Optional[Sequence[Tuple[float, Sequence[float]]]] = None
    gradient_opacity: Optional[Sequence[Tuple[float, float]]] = None
    scale: str = "linear"
    cmap: dataclasses.InitVar[Any] = None
    clim: dataclasses.InitVar[Optional[Range]] = None

    def __post_init__(self, cmap: Any, clim: Optional[Range]) -> None:
        for name, other, value in (("colormap", "cmap", cmap),
                                   ("range", "clim", clim)):
            if value is None:
                continue
            if getattr(self, name) is not None:
                raise TypeError(f"give {name} or {other}, not both")
            object.__setattr__(self, name, value)
        _checks.text("preset", self.preset, "a name of snowglass.presets()")
        if not callable(self.colormap):
            _checks.text("colormap", self.colormap, "a name of "
                         "snowglass.colormaps(), or a map of Matplotlib")
        _parse_range(self.range)
        object.__setattr__(self, "colors", _colors(self.colors))
        object.__setattr__(self, "opacity", _opacity(self.opacity))
        object.__setattr__(self, "gradient_opacity", _points(
            "gradient_opacity", self.gradient_opacity))
        _parse_scale(self.scale)

    def _arguments(self) -> tuple[Any, ...]:
        """Those of the core's `_look`."""
        kind, low, high = _parse_range(self.range)
        colors: Any = None
        if self.colors is not None:
            colors = [(value, *color) for value, color in self.colors]
        fields = {"preset": self.preset, "colormap": self.colormap,
                  "low": low, "high": high, **_parse_scale(self.scale)}
        return fields, kind, colors, self.opacity, self.gradient_opacity


def _opacity(given: Any) -> Any:
    """Points, a name, or a factor."""
    if isinstance(given, str):
        if given in OPACITIES:
            return given
        raise _checks.fault("opacity", f"points (value, opacity), a factor 0 to 1, or "
                            f"one of {', '.join(OPACITIES)}", given, ValueError)
    is_list = hasattr(given, "__iter__") and bool(getattr(given, "ndim", 1))
    if given is None or is_list:
        return _points("opacity", given)
    factor = _checks.number("opacity", given, "points (value, opacity), a name or "
                                              "a factor 0 to 1")
    if not 0 <= factor <= 1:
        raise _checks.fault("opacity", "a factor 0 to 1", given, ValueError)
    return factor


def _points(name: str, given: Any) -> Optional[Tuple[Any, ...]]:
    """Any iterable, which may be one that is read only once.  Elsewhere there are
    names of ramps, and lists of opacities alone."""
    if given is None:
        return None
    give = f"points (value, {name}), such as [(100, 0), (700, 0.8)]"
    points = tuple(given) if hasattr(given, "__iter__") else (given,)
    shown = given if isinstance(given, str) or len(points) < 2 else points
    try:
        for value, part in points:
            _checks.number(name, value), _checks.number(name, part)
    except (TypeError, ValueError):
        raise _checks.fault(name, give, shown) from None
    return points


def _colors(given: Any) -> Optional[Tuple[Any, ...]]:
    give = "points (value, (red, green, blue)) of numbers 0 to 1, such as " \
           "[(0, (0, 0, 1)), (700, (1, 1, 0))]"
    if given is None:
        return None
    if not hasattr(given, "__iter__"):
        raise _checks.fault("colors", give, given)
    points = tuple(given)
    try:
        made = tuple((_checks.number("colors", value),
                      tuple(_checks.number("colors", part) for part in color))
                     for value, color in points)
    except (TypeError, ValueError):
        raise _checks.fault("colors", give, list(points)) from None
    if any(len(color) != 3 for _, color in made):
        raise _checks.fault("colors", give, list(points), ValueError)
    return made


def _parse_scale(scale: Any) -> dict[str, Any]:
    """The core's names of a scale."""
    give = "'linear', 'log', 'symlog', or 'symlog:X' with a number X above 0"
    if not isinstance(scale, str):
        raise _checks.fault("scale", give, scale)
    word, _, number = scale.lower().partition(":")
    beyond = -1.0 if word == "symlog" else 0.0
    try:
        beyond = float(number) if ":" in scale else beyond
    except ValueError:
        raise _checks.fault("scale", give, scale, ValueError) from None
    if word not in ("linear", "log", "symlog") or ":" in scale and not (
            word == "symlog" and 0 < beyond < math.inf):
        raise _checks.fault("scale", give, scale, ValueError)
    return {"log": word == "log", "symlog": beyond}


def look_of(look: Union[Look, str, None]) -> Look:
    """A look; a string is the name of a preset or a colour map."""
    if look is None:
        return Look()
    if isinstance(look, Look):
        return look
    if isinstance(look, str):
        from . import _colormaps, presets
        return Look(colormap=look) if plain(look) not in map(plain, presets()) and (
            _colormaps.is_own(look) or _colormaps.other(look)) else \
            Look(preset=look)
    raise TypeError(f"a look must be a snowglass.Look or the name of a preset, "
                    f"not {type(look).__name__}")


def plain(name: str) -> str:
    """What counts of a name."""
    return name.lower().replace("-", "").replace("_", "")


def shows_window(mode: str, transfer: Any) -> bool:
    """Means have the unit of the values, so that the window of their file suits
    them."""
    return mode == "mean" and "the file's own window" in transfer.description


def is_ranged(look: Any) -> bool:
    """Whether a look names the range that it is spread over."""
    return isinstance(look, Look) and look.range not in (None, "auto")


def colors_are_open(look: Look) -> bool:
    """Whether a look says nothing of colours but what the data do."""
    return not (look.preset or look.colormap or look.colors or
                look.scale != "linear" or is_ranged(look))


def _parse_range(given: Optional[Range]) -> tuple[str, float, float]:
    if given is None:
        return "auto", 0.0, 0.0
    kind = "values"
    ends: Any = given
    if isinstance(given, str):
        if given in ("auto", "full", "robust", "slices", "least",
                     "signal"):
            return given, 0.0, 0.0
        words = [word.strip() for word in given.split(",")]
        if all(word.endswith("%") for word in words):
            kind = "percentiles"
        ends = [word.rstrip("%") for word in words]
    try:
        low, high = (float(end) for end in ends)
    except (TypeError, ValueError) as error:
        raise _checks.fault("range", "(low, high), 'full', 'robust' or '1%,99%'",
                            given, type(error)) from None
    return kind, low, high
