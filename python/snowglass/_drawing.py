"""The picture of a viewer's state, which is a recipe: of volume and look only
that is made anew which a recipe changes."""
from __future__ import annotations

import json
import math
from dataclasses import replace
from typing import Any, Callable, Mapping, Optional, Sequence

from . import _colormaps, _first, _recipes, _snowglass, _times
from ._images import Image
from ._looks import Look, is_ranged, look_of, shows_window
from ._volumes import Volume

Keys = Mapping[str, Any]

#: What a page may change, as the viewer in the browser has it: no key names a
#: file.
SETTABLE = frozenset("""
size background mode iso threshold preset colormap scale opacity
gradient-opacity range window opacity-unit shade light material
depth-darkening occlusion view azimuth elevation roll zoom perspective fit
position target up no-labels legend crop channel component labels clip
time""".split())
#: What a volume is made of, besides its clip planes.
DATA = ("crop", "channel", "component", "labels", "time")
#: Sides of a turn that a picture is framed for, as the viewer has them.
TURN = (0, 45, 90, 135)
BINS, STRIP, POINTS_MOST, SIDE_LEAST = 256, 64, 256, 64


def _key(recipe: Keys, names: Sequence[str]) -> str:
    return json.dumps([recipe.get(name) for name in names])


def _ends(crop: Sequence[Sequence[int]], dims: Sequence[int]
          ) -> list[tuple[int, int]]:
    """The voxels of a crop; 0 as an end is the last voxel's."""
    ends = [(low, high or size) for (low, high), size in zip(crop, dims)]
    for (low, high), size, name in zip(ends, dims, "xyz"):
        if not 0 <= low < high <= size:
            raise ValueError(f"crop {low}:{high} along {name}: give voxels "
                             f"within 0:{size}")
    return ends


def cropped(volume: Volume, crop: Sequence[Sequence[int]]) -> Volume:
    """A part of an array as a volume."""
    import numpy
    if volume._mixed is not None:
        raise ValueError("crop: the volume has several arrays as channels: crop "
                         "them")
    info = volume.info
    array = numpy.asarray(volume)
    ends = _ends(crop, info["dims"])
    matrix = numpy.array(info["matrix"])
    matrix[:, 3] += matrix[:, :3] @ [low for low, _ in ends]
    part = array[tuple(slice(*ends["xyz".index(axis)])
                       for axis in volume.axes)]
    if not part.flags.f_contiguous:
        part = numpy.ascontiguousarray(part)
    return Volume(part, affine=matrix, axes=volume.axes,
                  **{name: info[name] for name in
                     ("slope", "intercept", "medical", "unit")})


def part(volume: Volume, data: Keys) -> Volume:
    """What of a volume a recipe draws."""
    data = {name: value for name, value in data.items() if value is not None}
    if "time" in data:
        data["time"] = _times.plain(data["time"])
    known = volume._source or {}
    strange = [name for name in data if name not in (*DATA, "clip") and
               _recipes._plain(known.get(name)) != _recipes._plain(data[name])]
    if strange:
        raise ValueError(f"{', '.join(strange)}: the volume is open: give "
                         f"these to Volume, or the path in its place")
    if not data:
        return volume
    drawing = Drawing(volume, None)
    drawing.open(data)
    return drawing.volume


class Drawing:
    """Draws recipes of one volume; used by one thread."""

    def __init__(self, volume: Volume, look: Optional[Look]) -> None:
        self.first = self.whole = self.volume = volume
        self.look = look  # where no recipe can have it: colours of its own
        self.transfer: Any = None
        self.volume_is_new = self.look_is_new = True
        self._data = self._clip = self._style = ""
        self.mode = "over"

    # --- the parts of a recipe ---

    def apply(self, recipe: Keys) -> None:
        """Makes the volume and the transfer function of a recipe."""
        self.open(recipe)
        chosen = self._look_of(recipe)
        mode = _first.mode(self.volume, chosen, {
            name.replace("-", "_"): value for name, value in recipe.items()})
        style = repr((chosen, mode))
        self.mode = mode
        if style != self._style:
            self.transfer = self.volume._transfer(chosen, mode)
            self._style, self.look_is_new = style, True

    def open(self, recipe: Keys) -> None:
        """Makes the volume."""
        data, clip = _key(recipe, DATA), _key(recipe, ["clip"])
        if data != (self._data or _key({}, DATA)):
            self.whole = self._open(recipe)
        if data != self._data or clip != self._clip:
            planes = recipe.get("clip")
            self.volume = self._clipped(planes) if planes else self.whole
            if self.volume is not self.first:  # its pictures know of it
                self.volume._source = self.source(recipe)
            self._style, self.volume_is_new = "", True
        self._data, self._clip = data, clip

    def _open(self, recipe: Keys) -> Volume:
        given = {name: recipe[name] for name in DATA
                 if recipe.get(name) is not None}
        source = self.first._source
        if source is not None:
            if "crop" in given:
                given["crop"] = self._crop_of_file(given["crop"])
            return Volume(source["input"], memory=self.first._memory, **{
                name: value for name, value in {**source, **given}.items()
                if name != "input"})
        others = [name for name in given if name != "crop"]
        if others:
            raise ValueError(f"{others[0]}: the volume is an array, which has "
                             f"none")
        return cropped(self.first, given["crop"]) if given else self.first

    def source(self, recipe: Keys) -> dict[str, Any]:
        """Keys that open the volume of a recipe from the file, if there is one;
        its own planes and the recipe's cut together."""
        own = self.first._source or {}
        made = {**own, **{name: recipe[name] for name in DATA
                          if recipe.get(name) is not None}}
        if own and recipe.get("crop"):
            made["crop"] = self._crop_of_file(recipe["crop"])
        planes = [_recipes._plain(plane) for keys in (own, recipe)
                  for plane in keys.get("clip") or ()]
        if planes:
            made["clip"] = [plane for n, plane in enumerate(planes)
                            if plane not in planes[:n]]
        return made

    def _crop_of_file(self, crop: Sequence[Sequence[int]]
                      ) -> list[list[int]]:
        """Of a crop of the volume, which may be a part of its file."""
        part = (self.first._source or {}).get("crop") or ((0, 0),) * 3
        return [[first + low, first + high] for (first, _), (low, high) in
                zip(part, _ends(crop, self.first.info["dims"]))]

    def _clipped(self, planes: Sequence[Sequence[float]]) -> Volume:
        made = _snowglass.clipped(Volume, self.whole, planes)
        made._planes = planes
        made._axes, made._order = self.whole._axes, self.whole._order
        made._one = self.whole._one
        if self.whole._mixed is not None:
            made._mixed = self.whole._mixed.mapped(
                self.whole, lambda each: _snowglass.clipped(
                    _snowglass.Volume, each, planes))
        return made

    def _look_of(self, recipe: Keys) -> Look:
        _, chosen, _ = _recipes.split(recipe)
        if self.look is not None and (chosen is None or chosen.preset is None):
            chosen = chosen or Look()
            return replace(self.look, **{
                name: getattr(chosen, name) for name in _recipes.LOOK
                if getattr(chosen, name) not in (None, False)})
        return look_of(chosen)

    def _options(self, recipe: Keys) -> dict[str, Any]:
        _, _, options = _recipes.split(recipe)
        return _recipes.with_lengths(options, self.volume.info["unit"])

    # --- pictures ---

    def render(self, recipe: Keys, quality: str, shrink: int = 0,
               progress: Optional[Callable[[str, float], Any]] = None) -> Image:
        options = self._options(recipe)
        options["size"] = [_shrunk(side, shrink) for side in options["size"]]
        options.setdefault("mode", self.mode)
        image = self.volume._picture(self.transfer, quality=quality, quiet=True,
                                     progress=progress, **options)
        image._ranged = is_ranged(self._look_of(recipe)) or shows_window(
            str(options.get("mode")), self.transfer)
        return image

    def thumbnail(self, recipe: Keys, preset: str, side: int,
                  progress: Callable[[str, float], Any], colormap: Optional[str] = None,
                  mode: str = "over") -> Image:
        """With a preset in place of the look, or with none, and other colours; by a
        volume of its own, so that the encoding of the picture stays."""
        options: dict[str, Any] = {
            **self._options(recipe), "size": side, "mode": mode,
            "letters": False, "legend": False,
            "quality": "draft"}
        look = Look(preset=preset) if preset else self.look or Look()
        if colormap:
            look = Look(preset=preset or None, colormap=colormap)
        return self._twin()._picture(look, progress=progress, quiet=True, **options)

    def _twin(self) -> Volume:
        import numpy
        info = self.volume._info
        made = _snowglass.wrap(
            Volume, numpy.asarray(memoryview(self.volume)).transpose(  # type: ignore[arg-type]
                [self.volume._order.index(n) for n in range(3)]), (0, 1, 2),
            [part for row in info["matrix"] for part in row], info["slope"],
            info["intercept"], info["medical"], info["unit"], self.volume)
        made._freeze()
        return made

    def fit(self, recipe: Keys) -> dict[str, Any]:
        """Keys that frame what the look shows, from the sides of a turn."""
        options = self._options({**recipe, "zoom": 1, "fit": "visible"})
        if options.get("position") is not None:
            return {}
        options.pop("target", None)
        start = float(options.get("azimuth", 0))
        image = self.volume._picture(
            self.transfer, quality="draft", quiet=True,
            azimuths=[start + side for side in TURN], **options)
        target, zoom = image._view
        target = target or self.middle()[0]
        return {"zoom": float(f"{zoom:.5g}"), "fit": "volume",
                "target": [float(f"{each:.5g}") for each in target]}

    def middle(self) -> tuple[list[float], float]:
        """The middle of the volume, and from there to its farthest corner."""
        info = self.volume.info
        dims, rows = info["dims"], info["matrix"][:3]
        middle = [row[3] + sum(row[k] * (dims[k] - 1) / 2 for k in range(3))
                  for row in rows]
        corners = [[row[0] * dims[0] + a * row[1] * dims[1] +
                    b * row[2] * dims[2] for row in rows]
                   for a in (1, -1) for b in (1, -1)]
        return middle, max(math.hypot(*each) for each in corners) / 2

    # --- messages to pages ---

    def info(self) -> dict[str, Any]:
        info, known = self.volume.info, self.volume.statistics
        source = self.first._source
        middle, radius = self.middle()
        names, views = _snowglass.names, self.volume._views()
        usual = views.pop("")
        return {
            "t": "info", "medical": info["medical"], "type": info["type"],
            "name": source["input"].rpartition("/")[2] if source else "array",
            "dims": info["dims"], "spacing": self.volume.spacing,
            "axes": info["axes"],
            "unit": info["unit"], "times": info["times"],
            "min": _number(known["min"]), "max": _number(known["max"]),
            "middle": middle, "radius": radius, "matrix": info["matrix"][:3],
            "view": next(name for name, each in views.items()
                         if each == usual),
            "views": views, "tf": self.look is not None,
            "presets": [list(pair) for pair in zip(
                names("presets"), names("preset_descriptions"))],
            "colormaps": names("colormaps"), "fov": 30}

    def look_message(self, recipe: Keys) -> dict[str, Any]:
        low, high = self.transfer.domain
        opacity, gradient = self.transfer.points
        strip = ["#" + "".join(
            f"{round(255 * min(max(part, 0), 1)):02x}" for part in
            self.transfer.evaluate(low + (high - low) * n / (STRIP - 1))[:3])
            for n in range(STRIP)]
        return {"t": "look", "low": low, "high": high, "count": len(opacity),
                "opacity": opacity[:POINTS_MOST],
                "gradient": gradient[:POINTS_MOST], "strip": strip,
                "text": self.transfer.description, "shaded":
                    recipe.get("shade", "none" if self.transfer.unshaded
                               else "phong") == "phong"}

    def histogram(self) -> dict[str, Any]:
        counts, edges = self.volume.histogram(BINS)
        return {"t": "histogram", "lo": edges[0], "hi": edges[-1],
                "counts": counts.tolist()}

    def recipe(self, recipe: Keys) -> dict[str, Any]:
        """The whole one of the picture at rest."""
        source = self.source(recipe)
        data = {name: source[name] for name in ("crop", "clip")
                if name in source}
        if self.look is not None and "preset" not in recipe:
            source.update(_recipes._look_keys(self._look_of(recipe)))
        if self.volume._mixed is not None:  # of which one is drawn
            source["channel"] = self.volume._mixed.first
        whole = {**{name.replace("_", "-"): value
                    for name, value in source.items()}, **recipe, **data,
                 "quality": "high"}
        return _recipes._plain_tree(whole)


def _number(value: float) -> Optional[float]:
    return value if math.isfinite(value) else None


def _shrunk(side: int, shrink: int) -> int:
    return max(side >> shrink, min(side, SIDE_LEAST))


def begin(volume: Volume, look: Any, options: Mapping[str, Any]
          ) -> tuple[Drawing, dict[str, Any]]:
    """The drawing, and the recipe that a page begins with."""
    chosen = look_of(_colormaps.resolved(volume, look))
    unsayable = chosen if chosen.colors is not None or \
        chosen.range in ("robust", "slices", "least") else None
    mixed = volume._mixed
    if mixed is not None:
        if volume._source is None:
            raise ValueError("a viewer shows one volume: give one of the arrays, "
                             "not channels of several")
        mixed.warn("a viewer shows one")
    options = dict(options)
    options.setdefault("size", (640, 480))
    made = _recipes.make(None, volume.info["unit"],
                         Look() if unsayable else chosen, options)
    strange = [name for name in made if name not in SETTABLE]
    if strange:
        raise TypeError(f"{strange[0]}: a viewer has none; it sets quality and "
                        f"threads itself")
    drawing = Drawing(volume, unsayable)
    if mixed is not None:
        made["channel"] = mixed.first
        made.setdefault("mode", _first.mode(volume, chosen, options))
        drawing._data = _key(made, DATA)  # it is open
    return drawing, made

