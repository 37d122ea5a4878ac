"""python/snowglass/_options.py: the options of the command line as keyword
arguments of Python, with their types and defaults, which editors and mypy see."""
from table import literals

NUMBERS = "Numbers"
POINTS = "Points"

# The types of what each reader of options stands for.
TYPES = {
    "flag": "bool", "text": "str", "choice": "str", "kernel": "str",
    "real": "float", "strength": "float", "integer": "int", "count": "int",
    "preset": "str", "colormap": "Any", "view": "str", "type": "Any",
    "scale": "str", "points": f"{POINTS} | str | float",
    "gradient_points": POINTS, "window": NUMBERS, "fov": "bool | float",
    "range": "str | Numbers", "place": NUMBERS,
    "light": f"str | {NUMBERS}", "material": NUMBERS, "legend": "bool | str",
    "measure": "str",
    "size": "int | Numbers", "dims": NUMBERS,
    "spacing": f"float | {NUMBERS}", "time": "Time", "component": "str | int",
    "channels": "Any", "crop": POINTS,
    "labels": "str | int", "clip": POINTS, "z_scale": "float | str",
}
# Where Python differs: its name, or None, and its type.
OTHERWISE = {
    "no-labels": ("letters", "bool"), "depth": ("depth", "bool"),
    "shade": ("shade", "bool | str"), "overlay": ("overlay", "Any"),
    "overlay-look": ("overlay_look", "Any"), "mask": ("mask", "Path"),
    "label-table": ("label_table", "Path"), "tf": (None, ""),
    "title": (None, ""), "annotate": (None, ""), "box": (None, ""),
    "as": (None, ""), "series": ("series", "str | int"),
}
LOOK = ("preset", "colormap", "points", "gradient_points", "window", "range",
        "scale")
SETTINGS = ("mode", "sparse", "kernel", "look", "quality", "camera", "labels")
RUN = ("threads", "deterministic", "isa")

HEAD = '''"""Options of the command line as keyword arguments: their types, and what they
are where they are not given.

Made by `python3 scripts/manual build/table.json keywords` of the option table
(programs/options/option_table.c): do not edit; a test compares."""
from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any, Callable, Literal, Mapping, Sequence, \
    TypedDict

Path = str | os.PathLike[str]
Progress = Callable[[str, float], Any] | bool
if TYPE_CHECKING:
    import datetime
    from numpy import datetime64
    from numpy.typing import NDArray
    Time = int | str | datetime.date | datetime64
    Numbers = Sequence[float] | NDArray[Any]
    Points = Sequence[Numbers] | NDArray[Any]
'''
# What no option of the command line is.
LOOK_MORE = [("cmap", "Any"), ("clim", "str | Numbers"),
             ("colors", "Sequence[tuple[float, Numbers]]")]
SHOT_MORE = [("opacity_length", "float"), ("progress", "Progress")]
ARRAY = [("affine", "Any"), ("axes", "str"), ("unit", "str"),
         ("medical", "bool"), ("slope", "float"), ("intercept", "float"),
         ("copy", "bool"), ("frozen", "bool"), ("memory", "int")]
FILE = [("background", "str | Numbers")]
SLICE = [("axis", "str | int"), ("at", "int | str"), ("open", "Mapping[str, Any]")]


def keyword(option):
    """(name, type) of an option, or None."""
    name, kind = OTHERWISE.get(option["name"], (
        option["name"].replace("-", "_"), TYPES.get(option["reader"])))
    if option["name"] == "perspective":
        kind = TYPES["fov"]
    if option["reader"] == "choice" and option["name"] not in OTHERWISE:
        words = literals(option["argument"], "[|]")
        kind = f"Literal[{', '.join(repr(word) for word in words)}]" \
            .replace("'", '"')
    return (name, kind) if name else None


def kept(options, test):
    return [each for each in map(keyword, filter(test, options)) if each]


def declared(name, bases, text, rows):
    """A class, of which any key may be left out or None."""
    lines = ["", "", f"class {name}({bases}, total=False):", f'    """{text}"""']
    for key, kind in rows:
        line = f"    {key}: {kind} | None"
        if len(line) > 80:
            words = kind[len("Literal["):-1]
            line = f"    {key}: Literal[\n        {words}] | None"
        lines.append(line)
    return lines


def usual(option):
    value = option["default"]
    if isinstance(value, (int, float)) and not isinstance(value, bool) and \
            value < min(option["low"], 0):
        value = option["low"]  # not given
    if isinstance(value, float) and value == int(value):
        value = int(value)
    return value if option["name"] != "no-labels" else True


def keywords(table):
    options = table["options"]
    drawn = [each for each in options if "render" in each["verbs"]]
    look = kept(drawn, lambda o: o["topic"] == "look" and o["reader"] in LOOK)
    shot = kept(drawn, lambda o: o["name"] == "size" or o["name"] in RUN or
                o["name"] in ("depth", "overlay", "overlay-look") or
                o["topic"] in SETTINGS and o["reader"] not in LOOK and
                o["name"] != "mode")
    mode = kept(drawn, lambda o: o["name"] == "mode")
    data = kept(drawn, lambda o: o["topic"] == "data" and
                not o["name"].startswith("overlay"))
    shown = {name for name, _ in shot} | {"frames", "fps"}
    shown.discard("shade")  # which is chosen, as the mode is
    defaults = {}
    for option in options:
        made = keyword(option)
        if made and made[0] in shown and usual(option) is not None:
            defaults.setdefault(made[0], usual(option))
    lines = HEAD.rstrip("\n").split("\n")
    lines += declared("Colors", "TypedDict", "Of a look.", look + LOOK_MORE)
    lines += declared("Shot", "TypedDict", "Of a picture, but its mode and look.",
                      shot + SHOT_MORE)
    lines += declared("Picture", "Colors, Shot", "Of a picture.", mode)
    lines += declared("Movie", "Picture", "Of a turntable.", FILE)
    lines += declared("Data", "TypedDict",
                      "Of a volume: of files, then of arrays.", data + ARRAY)
    lines += declared("Source", "Data", "The same when it is opened.",
                      [("progress", "Progress")])
    lines += declared("Whole", "Picture, Data",
                      "Of a volume and its picture or slice.", SLICE)
    lines += ["", "", "#: Where nothing is given.", "DEFAULTS: dict[str, Any] = {"]
    lines += [f"    {name!r}: {value!r},".replace("'", '"')
              for name, value in sorted(defaults.items())]
    return lines + ["}"]
