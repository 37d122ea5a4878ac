"""Several channels in one picture, as the command line mixes them
(programs/options/channels.c and programs/picture/channels.c)."""
from __future__ import annotations

import dataclasses
import math
import os
import re
import stat
from typing import Any, Callable, Mapping, NamedTuple, Optional, Sequence, \
    Union

from . import _snowglass
from ._looks import Look, Range, _parse_range, _parse_scale, is_ranged
from ._warnings import warn

#: The most that are shown together.
MOST = 8
#: Colours where nothing names some: those of napari.
USUAL = {1: ("grey",), 2: ("magenta", "green"), 3: ("red", "green", "blue")}
MORE = ("cyan", "yellow", "magenta", "red", "green", "blue", "grey", "hot")
#: Of colours that are 0 or 1, by 4 red + 2 green + blue.
NAMED = ("", "blue", "green", "cyan", "red", "magenta", "yellow", "grey")
#: The least brightness in mode over, where what is dim is transparent.
DIM = 0.5
#: Opacities of voxels that are colours, over the range.
OWN = ((0.0, 0.0), (0.04, 0.0), (0.15, 0.25), (1.0, 0.3))
#: The same of a picture: of one slice, or a few large ones.
SOLID = ((0.0, 1.0), (0.04, 1.0), (0.15, 1.0), (1.0, 1.0))
#: The same on a white ground, where the darkest is as opaque.
ON_WHITE = ((0.0, 0.6), (0.04, 0.6), (0.15, 0.6), (1.0, 0.6))
NONE_SAID: Mapping[str, Any] = {"name": "", "color": None, "window": None,
                                "shown": False, "own": False, "light": False}

#: Of vectors, as of diffusion: red is |x|, green |y|, blue |z|.
DIRECTIONS: Sequence[Mapping[str, Any]] = [
    {**NONE_SAID, "name": f"|{name}|", "color": color} for name, color in (
        ("x", (1, 0, 0)), ("y", (0, 1, 0)), ("z", (0, 0, 1)))]

Said = Sequence[Mapping[str, Any]]  #: info["channels"]


def _is_picture(dims: Sequence[int]) -> bool:
    """One slice, or up to five of 16 times as many rows and columns."""
    least, *others = sorted(dims)
    return least <= 5 and others[0] >= (16 * least if least > 1 else 2)


class Pick(NamedTuple):
    """A channel, and how it is shown."""
    which: Union[int, str]          #: its number, or its name
    color: Optional[str] = None     #: #rrggbb, or a colour map
    range: Optional[Range] = None   #: as of a Look
    opacity: float = 1              #: a factor


def _refuse(text: str, why: str) -> ValueError:
    return ValueError(f"channel is no list of channels: '{text}' {why}")


def _rgb(color: str) -> Optional[tuple[float, float, float]]:
    """Of a colour; None of a map of several."""
    if re.fullmatch("#[0-9a-fA-F]{6}", color):
        red, green, blue = (int(color[n:n + 2], 16) / 255 for n in (1, 3, 5))
        return red, green, blue
    return _snowglass.colormap_color(color)


def _number(text: str) -> Optional[float]:
    try:
        return None if "_" in text else float(text)
    except ValueError:
        return None


def _range(text: str) -> Range:
    low, _, high = text.partition("..")
    percent = low[:1] == "p" and high[:1] == "p"
    ends = [_number(end[1:] if percent else end) for end in (low, high)]
    if ends[0] is None or ends[1] is None or not ends[0] < ends[1]:
        raise _refuse(text, "is no range, such as 100..2000 or p1..p99")
    return f"{ends[0]!r}%,{ends[1]!r}%" if percent else (ends[0], ends[1])


def _pick(which: Any, words: Sequence[str]) -> Pick:
    if isinstance(which, str):
        which = which.strip()
        if not which:
            raise _refuse(which, "names no channel: give a number or a name")
        if re.fullmatch("[+-]?[0-9]+", which):
            which = int(which)
    else:
        which = which.__index__()
    if not isinstance(which, str) and which < 0:
        raise _refuse(str(which), "is below 0")
    pick = Pick(which)
    for word in (each.strip() for each in words):
        opacity = _number(word)
        if ".." in word:
            pick = pick._replace(range=_range(word))
        elif opacity is not None:
            if not 0 <= opacity <= 1:
                raise _refuse(word, "is no opacity from 0 to 1")
            pick = pick._replace(opacity=opacity)
        else:
            _rgb(word)
            pick = pick._replace(color=word)
    return pick


def parse(given: Any) -> list[Pick]:
    """Of "0:magenta,GFP:green", {0: "magenta", "GFP": "green:20..200"}, or a list
    of numbers, names, and texts of one channel."""
    if isinstance(given, str):
        given = given.split(",")
    if isinstance(given, Mapping):
        picks = [_pick(which, how.split(":") if how else ())
                 for which, how in given.items()]
    else:
        picks = []
        for each in given:
            name, *words = each.split(":") if isinstance(each, str) else [each]
            picks.append(_pick(name, words))
    if not picks:
        raise _refuse("", "names no channel: give a number or a name")
    if len(picks) > MOST:
        raise ValueError(f"channel has too many channels: up to {MOST} are "
                         f"shown together")
    return picks


def _word(end: float) -> str:
    return repr(end)[:-2] if end == int(end) and abs(end) < 1e15 else repr(end)


def text(picks: Sequence[Pick], numbers: Sequence[int]) -> str:
    """The list as the command line reads it."""
    words = []
    for pick, number in zip(picks, numbers):
        name = str(pick.which)
        word = str(number) if re.search("[:,]", name) else name
        word += f":{pick.color}" if pick.color else ""
        if isinstance(pick.range, str):
            low, high = pick.range.replace("%", "").split(",")
            word += f":p{_word(float(low))}..p{_word(float(high))}"
        elif pick.range:
            word += ":" + "..".join(map(_word, pick.range))
        words.append(word + (f":{_word(pick.opacity)}" if pick.opacity < 1
                             else ""))
    return ",".join(words)


def is_plain(picks: Sequence[Pick]) -> bool:
    """One channel, of which nothing else is said."""
    return len(picks) == 1 and picks[0] == Pick(picks[0].which)


def find(picks: Sequence[Pick], info: Mapping[str, Any]) -> list[int]:
    """The number of each: names are found in any case."""
    names = [each["name"].lower() for each in info["channels"]]
    count, found = info["channel_count"], []
    for pick in picks:
        which = pick.which
        if isinstance(which, str):
            if which.lower() not in names:
                there = ", ".join(f"{n} {name}".rstrip() for n, name in enumerate(
                    each["name"] for each in info["channels"]))
                raise ValueError(
                    f"channel: there is no channel '{which}'; the file has "
                    f"{there if count > 1 else 'no channels'}")
            which = names.index(which.lower())
        elif which >= count:
            raise ValueError(f"channel {which} does not exist; the voxels have "
                             f"{count}, counted from 0")
        found.append(which)
    return found


def of_file(info: Mapping[str, Any]) -> list[int]:
    """All that a file shows; none where that is its first one as it is."""
    shown = [n for n, each in enumerate(info["channels"]) if each["shown"]]
    return [] if shown == [0] else shown


def light_of(info: Mapping[str, Any], fields: Mapping[str, Any]
             ) -> Optional[Mapping[str, Any]]:
    """What is said of the channel that is open, if it is of emitted light."""
    given = fields.get("component") or fields.get("channel") or 0
    rows = info["channels"]
    number = int(given) if str(given).isdigit() else len(rows)
    return rows[number] if number < len(rows) and rows[number]["light"] else None


def is_read_once(path: Any) -> bool:
    """A pipe or a device, of which no second channel can be read."""
    if os.fspath(path) in ("-", b"-"):
        return True
    try:
        mode = os.stat(path).st_mode
    except OSError:
        return False
    return not (stat.S_ISREG(mode) or stat.S_ISDIR(mode))


#: More are no stains but a spectrum, or times.
MOST_STAINS = 16
#: What blue that nobody asked for is: it is too dark to be seen.
PALE_BLUE = "#4d4dff"

READ_ONCE = "each is read in turn, and this input can be read once"


@dataclasses.dataclass
class Mixture:
    """What is drawn together, the first in front of nothing."""
    volumes: Sequence[_snowglass.Volume]
    transfers: Sequence[_snowglass.Transfer]
    names: Sequence[str]
    colors: Sequence[str]
    numbers: Sequence[int]
    shares: Sequence[float]
    white: float = 0  #: the brightness of a ground that is clear

    def layers(self) -> tuple[tuple[_snowglass.Volume, _snowglass.Transfer,
                                    bool, float], ...]:
        """Those behind the first, for the core."""
        return tuple((volume, transfer, True, share) for volume, transfer, share
                     in zip(self.volumes[1:], self.transfers[1:],
                            self.shares[1:]))

    def bars(self, mode: str) -> tuple[tuple[_snowglass.Transfer, str, float,
                                             float], ...]:
        """Of a legend: the lowest first."""
        none = (math.nan, math.nan)
        rows = list(zip(self.transfers, self.names))
        return tuple((transfer, name, *(none if mode == "over" else
                                        transfer.domain))
                     for transfer, name in rows[::-1])

    def describe(self) -> str:
        rows = []
        for number, name, color, transfer in zip(self.numbers, self.names,
                                                 self.colors, self.transfers):
            low, high = transfer.domain
            words = [str(number)] if name == f"channel {number}" else [str(number), name]
            rows.append(" ".join([*words, color, f"{low:g}..{high:g}"]))
        return f"channel{'s'[len(rows) < 2:]} " + ", ".join(rows) + (
            f"; white ground clear (the border is brighter than {self.white:.2g})"
            if self.white else "")


class Channels:
    """Of a Volume whose pictures mix some.  `first` is the number of the
    Volume's own; `open` opens another one in its context."""

    def __init__(self, picks: Sequence[Pick], numbers: Sequence[int],
                 said: Said, *, count: int, first: int, listed: bool,
                 open: Callable[[Any, int], _snowglass.Volume],
                 why: Optional[str] = None, directions: bool = False) -> None:
        self.picks, self.numbers, self.said = picks, numbers, said
        self.count, self.first, self.listed = count, first, listed
        self.why, self._open, self.directions = why, open, directions
        self._opened: dict[int, _snowglass.Volume] = {}
        self._white: Optional[float] = None  #: of a ground, once it is known

    @property
    def light(self) -> bool:
        """Whether all are of emitted light, since the file says so or colours are
        given."""
        rows = [self._said(n) for n in range(len(self.picks))]
        if any(row["own"] for row in rows):
            return False
        if any(row["light"] for row in self.said):
            return all(row["light"] for row in rows)
        return any(pick.color for pick in self.picks) and \
            1 < self.count <= MOST_STAINS

    def volumes(self, base: Any) -> list[Any]:
        """One for each pick, of which the first may be the Volume itself."""
        base._info  # ValueError where it is closed
        found = []
        for n, number in enumerate(self.numbers):
            if n == 0 and number == self.first:
                found.append(base)
                continue
            if n not in self._opened:
                self._opened[n] = self._open(base, number)
            found.append(self._opened[n])
        return found

    def mapped(self, base: Any, change: Callable[[Any], _snowglass.Volume]
               ) -> "Channels":
        """Those of a Volume that is made of another, as by a mask."""
        made = Channels(self.picks, self.numbers, self.said, count=self.count,
                        first=self.first, listed=self.listed, open=self._open,
                        why=self.why, directions=self.directions)
        made._opened = {n: change(volume) for n, volume in
                        enumerate(self.volumes(base)) if volume is not base}
        return made

    def close(self) -> None:
        while self._opened:
            self._opened.popitem()[1]._close()

    def _hindrance(self, look: Look, mode: str, settings: Mapping[str, Any]
                   ) -> Optional[str]:
        """Why several cannot be drawn."""
        if self.why:
            return self.why
        if mode == "slice":
            return None
        if mode not in ("over", "mip", "minip"):
            return "several need mode over, mip or minip"
        if settings.get("method") in ("original", "footprint"):
            return "several need method shear-warp or raycast"
        if settings.get("kernel") in ("gauss", "box"):
            return "several need kernel tent or bspline"
        if settings.get("depth") or settings.get("depth_darkening") or \
                settings.get("occlusion"):
            return "depths and what is made of them are of one volume"
        return None

    def mixture(self, base: Any, look: Look, mode: str,
                settings: Mapping[str, Any],
                change: Callable[[Any], Any] = lambda volume: volume
                ) -> Optional[Mixture]:
        """With their looks, each changed, as to a slice of it; None, with a
        warning: the Volume is drawn alone."""
        if self.directions and mode != "slice":
            return None
        why = self._hindrance(look, mode, settings)
        colored = look.preset is not None or look.colors is not None
        if self.listed and colored:
            raise ValueError("channel: a list has colours of its own; give a look "
                             "without preset and colors, or one channel")
        if self.listed and why:
            raise ValueError(f"channel: {why}; give one channel, such as "
                             f"channel={self.numbers[0]}")
        if why or (not self.listed and (colored or look.colormap)):
            if not self.directions:
                self.warn(why)
            return None
        drawn = [change(volume) for volume in self.volumes(base)]
        colors = [self._color(n, look, mode) for n in range(len(drawn))]
        white = self._ground(drawn, look, mode)
        if self.directions:
            look = self._as_bright(change(base), look)
        return Mixture(
            drawn, [self._transfer(volume, n, color, look, mode, white) for
                    n, (volume, color) in enumerate(zip(drawn, colors))],
            [self._said(n)["name"] or f"channel {self.numbers[n]}"
             for n in range(len(drawn))], colors, self.numbers,
            [pick.opacity for pick in self.picks], white)

    @staticmethod
    def _as_bright(lengths: Any, look: Look) -> Look:
        """With one range for all, up to the end of that of the lengths."""
        if is_ranged(look):
            return look
        high = lengths._look({"preset": "linear"}, "slices", None, None,
                             None).domain[1]
        return dataclasses.replace(look, range=(0, high if high > 0 else 1))

    def _ground(self, drawn: Sequence[Any], look: Look, mode: str) -> float:
        """Where white begins that colours of voxels lie on; 0: they do not."""
        said = {number: (volume, self._said(n)) for n, (number, volume) in
                enumerate(zip(self.numbers, drawn))}
        if sorted(self.numbers) != [0, 1, 2] or mode != "over" or \
                look.opacity is not None or \
                not all(each["own"] for _, each in said.values()) or \
                _is_picture(drawn[0]._info["dims"]):
            return 0
        if self._white is None:
            (red, _), (green, _), (blue, _) = (said[n] for n in range(3))
            self._white = red._ground(green, blue,
                                      [said[n][1]["window"] for n in range(3)])
        return self._white

    def warn(self, why: Optional[str]) -> None:
        warn_of_one(self.first, self.count, why)

    def _said(self, n: int) -> Mapping[str, Any]:
        number = self.numbers[n]
        return self.said[number] if number < len(self.said) else NONE_SAID

    def _color(self, n: int, look: Look, mode: str) -> str:
        """Its own, that of the look, of the file, or a usual one."""
        given, said = self.picks[n].color or look.colormap, self._said(n)
        if given is not None:
            return given
        color = self._usual_color(n, said)
        pale = color == "blue" and mode in ("mip", "slice") and self.light
        return PALE_BLUE if pale else color

    def _usual_color(self, n: int, said: Mapping[str, Any]) -> str:
        if said["color"] is None:
            return USUAL.get(len(self.picks), MORE)[n]
        levels = [math.floor(255 * part + 0.5) for part in said["color"]]
        at = sum((level == 255) << bit for level, bit in zip(levels, (2, 1, 0)))
        return NAMED[at] if at and set(levels) <= {0, 255} else \
            "#%02x%02x%02x" % tuple(level & 255 for level in levels)

    def _transfer(self, volume: _snowglass.Volume, n: int, color: str,
                  look: Look, mode: str, white: float) -> _snowglass.Transfer:
        flat, said, pick = mode != "over", self._said(n), self.picks[n]
        kind, low, high = _parse_range(
            pick.range or (look.range if is_ranged(look) else said["window"]) or
            ("signal" if mode in ("mip", "slice") and self.light else
             ("slices" if mode == "slice" else "robust") if flat else None))
        fields: dict[str, Any] = {"low": low, "high": high,
                                  **_parse_scale(look.scale)}
        rgb, colors, opacities = _rgb(color), None, None
        if rgb is None:
            fields["colormap"] = color
            fields["preset"] = "linear" if flat else None
        else:
            dim = 0.0 if flat or said["own"] else DIM
            colors = [(0, *(dim * part for part in rgb)), (1, *rgb)]
            fields["domain"] = "range"
            opacities = ((0, 0), (1, 1)) if flat else \
                (SOLID if _is_picture(volume._info["dims"]) else
                 ON_WHITE if white else OWN) if said["own"] else None
            fields["white"] = white
        made = volume._look(fields, kind, colors, opacities,
                            look.gradient_opacity)
        if kind in ("auto", "robust", "slices", "signal") and made.domain[0] == 0 and \
                "one value only" in volume._look({}, "auto", None, None,
                                                 None).description:
            # nothing to see, as in the command line
            low = made.domain[1]
            made = volume._look({**fields, "low": low, "high": low + max(1.0, low)},
                                "values", colors, opacities, look.gradient_opacity)
        return made._faded(volume, pick.opacity, look.opacity) \
            if pick.opacity < 1 or look.opacity is not None else made


def warn_of_one(first: int, count: int, why: Optional[str]) -> None:
    warn(f"channel {first} of {count} (counted from 0) is used; "
         f"channel=N of Volume selects another{'; ' + why if why else ''}")


def picked(path: Any, fields: dict[str, Any]
           ) -> tuple[list[Pick], list[int]]:
    """The channels that a name or list gives, and their numbers, of which the
    first is opened."""
    given = fields.get("channel")
    if given is None or hasattr(given, "__index__"):
        return [], []
    picks = parse(given)
    if fields.get("component") is not None:
        raise TypeError("give channel or component, not both")
    if is_read_once(path):
        raise ValueError(f"channel: {READ_ONCE}; give its number")
    fields["channel"] = None
    numbers = find(picks, _snowglass.inspect(os.fsencode(path), fields))
    fields["channel"] = numbers[0]
    return picks, numbers


def of_volume(volume: Any, path: Any, fields: Mapping[str, Any], clip: Any,
              picks: Sequence[Pick], numbers: Sequence[int]
              ) -> Optional[Channels]:
    """Those that pictures mix: of the list, or all that the file shows."""
    info, listed = volume._info, bool(picks)
    if is_plain(picks) or not listed and (
            fields.get("channel") is not None or
            fields.get("component") is not None):
        return None
    directions = not listed and info["directions"] and \
        fields.get("labels") is None and not is_read_once(path)
    if not listed and fields.get("labels") is None:
        numbers = (0, 1, 2) if directions else of_file(info)
        picks = [Pick(number) for number in numbers]
    if not picks:
        if info["channel_count"] > 1:
            warn_of_one(0, info["channel_count"], None)
        return None

    def open(base: Any, number: int) -> _snowglass.Volume:
        own: Mapping[str, Any] = {"component": f"|{number}|"} if directions else \
            {"channel": number}
        return _snowglass.open(_snowglass.Volume, os.fsencode(path),
                               {**fields, **own}, clip, 0, None, base)

    if directions:
        return Channels(picks, (0, 1, 2), DIRECTIONS, count=3, first=-1,
                        listed=False, open=open, directions=True)
    return Channels(
        picks, numbers, info["channels"], count=info["channel_count"],
        first=fields.get("channel") or 0, listed=listed, open=open,
        why=READ_ONCE if is_read_once(path) else None)


def of_arrays(base: Any, arrays: Sequence[Any], colors: Optional[Sequence[Any]],
              names: Optional[Sequence[str]],
              windows: Optional[Sequence[Any]]) -> Channels:
    """Of arrays on the grid of the first, C contiguous as that lies in memory."""
    count = len(arrays)
    for what, given in (("colors", colors), ("names", names),
                        ("windows", windows)):
        if given is not None and len(given) != count:
            raise ValueError(f"{len(given)} {what} for {count} channels: give "
                             f"one for each")
    if count > MOST:
        raise ValueError(f"{count} channels: up to {MOST} are shown together")
    picks = [Pick(n, colors[n] if colors else None) for n in range(count)]
    for pick in picks:
        if pick.color is not None:
            _rgb(pick.color)
    said = [{**NONE_SAID, "shown": True, "name": names[n] if names else "",
             "window": windows[n] if windows else None,
             "color": _rgb(pick.color) if pick.color else None}
            for n, pick in enumerate(picks)]

    def wrap(base: Any, n: int) -> _snowglass.Volume:
        info = base._info
        made = _snowglass.wrap(
            _snowglass.Volume, arrays[n], (0, 1, 2),
            [part for row in info["matrix"] for part in row], info["slope"],
            info["intercept"], info["medical"], info["unit"], base, False)
        if base._frozen:
            made._freeze()
        return made

    return Channels(picks, range(count), said, count=count, first=0, listed=True,
                    open=wrap)
