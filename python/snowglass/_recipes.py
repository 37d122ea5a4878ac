"""Recipes: what a picture was made with, under the long option names of the
command line."""
from __future__ import annotations

import json
import os
import shlex
from typing import Any, Mapping, Optional

from . import _checks, _snowglass
from ._looks import Look, look_of
from ._options import DEFAULTS

#: Keys of the data, as options of Volume.
DATA = ("dims", "type", "endian", "spacing", "offset", "time", "channel",
        "component", "crop", "dataset", "series", "allow_gaps", "suv", "levels",
        "z_scale", "vertical", "mask", "labels", "label_table", "clip")
#: Keys of the look.
LOOK = ("preset", "colormap", "range", "opacity", "gradient_opacity", "scale")
#: Other names of some, as of matplotlib and PyVista, and what no recipe has.
ALSO = ("cmap", "clim", "colors")
#: All that make a look beside a Look.
LOOKS = (*LOOK, *ALSO, "window")
#: Options of Volume for arrays alone.
ARRAY = ("affine", "medical", "slope", "intercept", "copy", "frozen", "memory")
#: Those that an overlay has, too.
OVERLAY = ("preset", "colormap", "range", "opacity")
#: Keys of the file of a picture and of other verbs, which are left out.
OTHERS = ("output", "depth", "overwrite", "background", "bits", "frames", "fps",
          "verb", "version", "title", "annotate", "box")
#: What need not be said; some of it the command line has no words for.
USUAL = {"perspective": 0, "opacity_length": 0, **{name: DEFAULTS[name] for name in (
    "azimuth", "elevation", "roll", "zoom", "fit", "threads")}}
#: What Volume.slice takes, besides the look.
SLICE = ("axis", "at", "size", "kernel", "legend", "letters", "measure",
         "threads")


def _range_key(given: Any) -> Any:
    """A range of a Look as one of a recipe."""
    if isinstance(given, str) and "%" in given:
        return ["p" + word.strip().rstrip("%") for word in given.split(",")]
    return given if isinstance(given, str) else [float(end) for end in given]


def _range_look(given: Any) -> Any:
    if isinstance(given, list):
        if given and all(isinstance(word, str) for word in given):
            return ",".join(word[1:] + "%" for word in given)
        return tuple(given)
    return given


def _plain(value: Any) -> Any:
    """Numbers and lists that JSON knows."""
    if hasattr(value, "tolist"):  # numbers and arrays of NumPy
        value = value.tolist()
    if isinstance(value, (str, bool)) or value is None:
        return value
    if hasattr(value, "__len__"):
        return [_plain(each) for each in value]
    if hasattr(value, "__index__"):
        return value.__index__()
    return float(value) if hasattr(value, "__float__") else os.fspath(value)


def _plain_tree(recipe: Mapping[str, Any]) -> dict[str, Any]:
    return {name: _plain(value) for name, value in recipe.items()}


def _look_keys(look: Look) -> dict[str, Any]:
    if look.colors is not None:
        raise ValueError("a look with colors of its own is no recipe: name a "
                         "preset or a colormap")
    if look.range in ("robust", "slices", "least"):
        raise ValueError(f"a range {look.range!r} is no recipe: give (low, high)")
    keys = {name: getattr(look, name) for name in LOOK}
    if look.range == "auto":
        keys["range"] = None
    if keys["range"] is not None:
        keys["range"] = _range_key(keys["range"])
    return {name: value for name, value in keys.items()
            if value is not None and (name, value) != ("scale", "linear")}


def _overlay_keys(overlay: Any, look: Any) -> dict[str, Any]:
    """An overlay of a path, and its look, with their long names."""
    if overlay is None:
        return {}
    if not isinstance(overlay, (str, os.PathLike)):
        raise ValueError("the overlay is an array or a Volume, which no recipe "
                         "can name: write it by Volume.save, and give the path")
    keys = _look_keys(look_of(look))
    others = [name for name in keys if name not in OVERLAY]
    if others:
        raise ValueError(f"{', '.join(others)} of overlay_look: a recipe knows "
                         f"only {', '.join(OVERLAY)}")
    parts = [keys[name] if isinstance(keys[name], str) else
             ",".join(":".join(_word("", part) for part in _plain(each))
                      if hasattr(each, "__len__") and not isinstance(each, str)
                      else _word("", _plain(each)) for each in keys[name])
             for name in OVERLAY if name in keys]
    return {"overlay": os.fspath(overlay),
            **({"overlay_look": ",".join(parts)} if parts else {})}


def _overlay_look(text: str) -> Look:
    """The look of the option's text: what a part between commas is, its form
    says."""
    from . import presets
    known = {name.lower() for name in presets()}
    names: list[str] = []
    colors: list[str] = []
    ends: list[str] = []
    points: list[tuple[float, float]] = []
    for part in text.split(","):
        number = part[1:] if part[:1] == "p" else part
        if ":#" in part:
            colors.append(part)
        elif ":" in part:
            value, opacity = part.split(":")
            points.append((float(value), float(opacity)))
        elif part == "full" or number.strip("0123456789+-.e") == "":
            ends.append(part)
        else:
            names.append(part)
    if len(ends) % 2 and ends != ["full"]:
        raise ValueError("a recipe with one factor in overlay-look cannot be "
                         "drawn here; use the command line, or give points")
    preset = names.pop(0) if names and names[0].lower() in known else None
    low_high: Any = None if not ends else "full" if ends == ["full"] else \
        _range_look(ends) if ends[0][:1] == "p" else tuple(map(float, ends))
    return Look(preset=preset, colormap=",".join([*names, *colors]) or None,
                range=low_high, opacity=points or None)


def length_of_mm(unit: str) -> float:
    """A millimetre in the unit of a volume's world."""
    one = _snowglass.length_unit(unit or "mm")[0]
    if not one:
        raise ValueError(f"the volume's unit '{unit}' is not a length: use "
                         f"opacities per voxel")
    return _snowglass.length_unit("mm")[0] / one


def make(data: Optional[Mapping[str, Any]], unit: str, look: Look,
         options: Mapping[str, Any]) -> dict[str, Any]:
    """The recipe of a picture of a file's `data` (None: of an array), drawn
    with these options of Volume.render, or those of Volume.slice with a verb."""
    colors = _look_keys(look)
    if options.get("verb") == "slice":  # which has no opacities
        for name in ("opacity", "gradient_opacity"):
            colors.pop(name, None)
    options = dict(options)
    second = _overlay_keys(options.pop("overlay", None),
                           options.pop("overlay_look", None))
    if second and "labels" in (data or {}):
        raise ValueError("labels of the volume and an overlay are no recipe: "
                         "there labels are the overlay's")
    keys: dict[str, Any] = {**(data or {}), **colors, **second}
    for name, value in options.items():
        value = _plain(value)
        if value is None or name == "depth" or \
                value == USUAL.get(name):
            continue
        if name == "iso" and options.get("mode") != "iso":
            continue
        if name == "letters":
            name, value = "no_labels", not value
        elif name == "perspective":
            value = 30.0 if value is True else float(value)
        elif name == "size":
            value = [value, value] if not hasattr(value, "__len__") else value
        elif name == "opacity_length":
            if value != length_of_mm(unit):
                raise ValueError(f"opacity_length {value:g} is no recipe: it is "
                                 f"neither a voxel nor a millimetre")
            name, value = "opacity_unit", "mm"
        keys[name] = value
    return {name.replace("_", "-"): _plain(value)
            for name, value in keys.items() if value is not False}


def _of_window(window: Any) -> tuple[float, float]:
    """The range that a window's width and its centre are."""
    give = "(width, centre), the width above 0"
    try:
        width, centre = window
    except (TypeError, ValueError):
        raise _checks.fault("window", give, window) from None
    width, middle = _checks.number("window", width, give), \
        _checks.number("window", centre, give)
    if width <= 0:
        raise _checks.fault("window", give, window, ValueError)
    return middle - width / 2, middle + width / 2


def take_look(options: dict[str, Any]) -> dict[str, Any]:
    """Takes the keys of a look out of options."""
    given = {name: options.pop(name) for name in LOOKS if name in options}
    given = {name: value for name, value in given.items() if value is not None}
    window = given.pop("window", None)
    if window is None:
        return given
    if "range" in given or "clim" in given:
        raise TypeError("give range or window, not both")
    return {**given, "range": _of_window(window)}


def split(options: Mapping[str, Any]) -> tuple[
        dict[str, Any], Optional[Look], dict[str, Any]]:
    """Options of Volume, the look and options of Volume.render of the keys of a
    recipe, and of any options that have these names."""
    given = {name.replace("-", "_"): value for name, value in options.items()}
    data = {name: given.pop(name) for name in DATA + ARRAY if name in given}
    if "axes" in given:
        data["axes"] = given.pop("axes")
    colors = take_look(given)
    if "tf" in given:
        raise ValueError("a recipe with a file of a look (tf) cannot be drawn "
                         "here; use the command line")
    if given.get("overlay") and "labels" in data:
        raise ValueError("a recipe with an overlay and labels cannot be drawn "
                         "here; use the command line")
    if isinstance(given.get("overlay_look"), str):
        given["overlay_look"] = _overlay_look(given["overlay_look"])
    if isinstance(given.get("depth"), bool):
        data_depth = {"depth": given["depth"]}
    else:
        data_depth = {}
    if given.get("verb") == "slice":
        given.setdefault("axis", "axial")
    for name in OTHERS:
        given.pop(name, None)
    given.update(data_depth)
    if "range" in colors:
        colors["range"] = _range_look(colors["range"])
    if "no_labels" in given:
        given["letters"] = not given.pop("no_labels")
    if isinstance(given.get("size"), list):
        given["size"] = tuple(given["size"])
    return data, Look(**colors) if colors else None, given


def with_lengths(options: Mapping[str, Any], unit: str) -> dict[str, Any]:
    """Options of Volume.render of those of a recipe, for a world's unit."""
    given = dict(options)
    if given.pop("opacity_unit", None) == "mm":
        given["opacity_length"] = length_of_mm(unit)
    return given


def check_slice(options: Mapping[str, Any]) -> None:
    """That Volume.slice takes all of a recipe of a slice."""
    others = [name.replace("_", "-") for name in options if name not in SLICE]
    if others:
        raise ValueError(f"{', '.join(others)}: Volume.slice, which draws this "
                         f"recipe, knows only {', '.join(SLICE)}; remove the "
                         f"others, or axis and at")


def _word(key: str, value: Any) -> str:
    """A value as it stands on the command line."""
    if isinstance(value, str):
        return value
    if isinstance(value, float):
        return repr(value)[:-2] if value == int(value) and abs(value) < 1e15 \
            else repr(value)
    if not isinstance(value, list):
        return str(value)
    between = "x" if key in ("size", "dims", "spacing") else ","
    if key == "crop":
        return ",".join(f"{low}:{high or ''}" for low, high in value)
    pairs = ":" if key.endswith("opacity") else ","
    return between.join(pairs.join(_word("", part) for part in each)
                        if isinstance(each, list) else _word("", each)
                        for each in value)


def command(recipe: Mapping[str, Any]) -> str:
    """The command that makes the picture of a recipe; of an array, of the file that
    it would be saved as."""
    path = recipe.get("input", "VOLUME.nrrd")
    if path.startswith("-") and path != "-":
        path = os.path.join(".", path)  # no option
    words = ["snowglass", recipe.get("verb", "render"), path]
    for key, value in recipe.items():
        if key not in ("input", "verb"):
            words += ["--" + key] if value is True else \
                [f"--legend={value}"] if key == "legend" else \
                ["--config", json.dumps({key: value})] if key == "opacity-unit" else \
                ["--" + key, _word(key, value)]
    return shlex.join(words)
