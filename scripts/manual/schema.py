"""The JSON schema (draft 7) of recipes: the keys are those long options that the
library takes, their texts the help, their types those that each reader of
options stands for."""
import json
import re
import sys

from table import option_words


def string(**more):
    return {"type": "string", **more}


def number(**more):
    return {"type": "number", **more}


def integer(**more):
    return {"type": "integer", **more}


def array(items, least, most=None):
    return {"type": "array", "minItems": least, "maxItems": most or least,
            "items": items}


def any_of(*schemas):
    return {"anyOf": list(schemas)}


def enum(*words):
    return {"enum": list(words)}


def share():
    return number(minimum=0, maximum=1)


def side():
    return integer(minimum=1, maximum=32768)


POINTS = array(array([number(), share()], 2), 1, 256)

# What a recipe has for an option's text; numbers get the row's limits.
TYPES = {
    "flag": {"type": "boolean"},
    "text": string(),
    "component": any_of(enum("x", "y", "z", "w", "magnitude"),
                        string(pattern="^[0-9]+$"), string(pattern=".,.")),
    "channels": any_of(integer(minimum=0), string()),
    "labels": string(),
    "preset": string(),
    "colormap": string(),
    "view": string(),
    "type": string(),
    "choice": string(),
    "real": number(),
    "strength": number(),
    "z_scale": number(),
    "kernel": any_of(string(pattern="^(auto|tent|gauss|bspline|box)(:[2-9])?$")),
    "legend": any_of({"type": "boolean"}, string()),
    "measure": string(pattern="^ *(line|angle|ellipse) "),
    "annotate": any_of(enum("step", "time"), string(pattern="^time=")),
    "material": array([share(), share(), share(), number(minimum=0, maximum=1000)],
                      4),
    "scale": any_of(enum("linear", "log", "symlog"),
                    string(pattern="^symlog:[0-9.eE+-]+$")),
    "fov": number(),
    "integer": integer(),
    "time": any_of(integer(), string()),
    "count": integer(minimum=0),
    "size": any_of(side(), array(side(), 2)),
    "window": array(number(), 2),
    "dims": array(integer(minimum=1), 3),
    "spacing": array(number(exclusiveMinimum=0), 3),
    "place": array(number(), 3),
    "crop": array(array(integer(minimum=0), 2), 3),
    "clip": array(array(number(), 4), 1, 6),
    "range": any_of({"const": "full"}, array(number(), 2),
                    array(string(pattern="^p[0-9.]+$"), 2)),
    "points": POINTS,
    "gradient_points": POINTS,
    "overlay_look": string(),
    "light": any_of(enum("key", "head"), array(number(), 2)),
    "color": any_of({"const": "none"}, string(pattern="^#[0-9a-fA-F]{6}$"),
                    array(share(), 3)),
}

# Keys that are no options, or mean something else there.
OTHERS = {
    "input": any_of(string(), {"type": "array", "items": string()}) | {
        "description": "volume file, or phantom:NAME; of a movie a list"},
    "opacity-unit": enum("voxel", "mm") | {
        "description": "length over which an opacity applies: the smallest voxel "
                       "spacing or one millimetre (default voxel)"},
    "verb": string(description="the verb that wrote the file"),
    "limit-seconds": number(
        minimum=0, maximum=1e9,
        description="of simulations: the most that a step takes in the mean"),
    "limit-bytes": integer(
        minimum=0, description="of simulations: the most that a rank holds"),
    "reread": {"type": "boolean", "description": "of simulations: read the file "
                                                 "again when it changes"},
    "sync": {"type": "boolean", "description": "of simulations: a step waits until "
                                               "its picture is on the disk"},
    "version": string(description="the version that wrote the file"),
}


def property_of(table, option):
    """The schema of a key."""
    if option["reader"] not in TYPES:
        sys.exit(f"manual: --{option['name']} has a reader that the schema does not "
                 "know; add it to scripts/manual/schema.py")
    made = dict(TYPES[option["reader"]])
    words = option_words(table, option)
    if made.get("type") == "string" and words:
        if all(word.isdigit() for word in words):
            made["type"] = "integer"
            words = [int(word) for word in words]
        made["enum"] = words
    elif made.get("type") in ("number", "integer") and \
            (option["low"] or option["high"]):
        # A field of view of 0 is a parallel projection.
        made["minimum"] = 0.0 if option["reader"] == "fov" else option["low"]
        made["maximum"] = option["high"]
    made["description"] = option["text"]
    return made


def schema(table):
    properties = dict(OTHERS)
    for option in table["options"]:
        if option["key"] and option["name"] not in properties:
            properties[option["name"]] = property_of(table, option)
    text = json.dumps({"$schema": "http://json-schema.org/draft-07/schema#",
                       "title": "a recipe of Snowglass", "type": "object",
                       "properties": properties, "additionalProperties": False},
                      indent=2, ensure_ascii=False)
    return [re.sub(r'(?m)(^ *"\w+": [\d.]+e-)0', r"\1", text)]
