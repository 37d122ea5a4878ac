"""schema.py TOOL SCHEMA: the schema of recipes takes what the tool takes, and
refuses what it refuses."""
import json
import struct
import subprocess
import sys

import jsonschema

TOOL, SCHEMA = sys.argv[1:]
schema = json.load(open(SCHEMA))
jsonschema.Draft7Validator.check_schema(schema)
validator = jsonschema.Draft7Validator(schema)
BASE = {"input": "phantom:shells", "output": "out.png", "overwrite": True,
        "dims": [12, 12, 12], "size": [8, 8]}

# Four components a voxel; a phantom has none.
VECTORS = {"input": "vectors.npy", "dims": None}


def write_vectors():
    head = "{'descr': '<f4', 'fortran_order': False, 'shape': (5, 5, 5, 4), }"
    head += " " * (117 - len(head)) + "\n"
    with open("vectors.npy", "wb") as file:
        file.write(b"\x93NUMPY\x01\x00" + struct.pack("<H", len(head)))
        file.write(head.encode() + struct.pack("<500f", *range(500)))


# Recipes over BASE, of which both say the same.  What the schema cannot say
# (an order of numbers, options that exclude one another) is not here.
CASES = [
    {}, {"unknown": 1}, {"size": 8}, {"size": [64]}, {"size": [0, 4]}, {"size": "8x8"},
    {"size": [8.5, 8]}, {"background": "none"}, {"background": "#10ff00"},
    {"background": "#10"}, {"background": [0, 0.5, 1]},
    {"background": [0, 0.5, 1.5]}, {"bits": 16}, {"bits": 12}, {"bits": "8"},
    {"mode": "mip"}, {"mode": "max"}, {"threshold": 255}, {"threshold": 256},
    {"threshold": "3"}, {"encoding": "rle"}, {"encoding": 1},
    {"kernel": "tent"}, {"kernel": "gauss:9", "method": "footprint"},
    {"kernel": "gauss:10"}, {"kernel": "tent:2.5"}, {"preset": "ct-bone"},
    {"preset": "nope"}, {"colormap": "viridis"}, {"colormap": "nope"},
    {"scale": 1}, {"scale": "log"}, {"scale": "symlog"}, {"scale": "symlog:2"},
    {"scale": "ln"}, {"scale": "symlog:"}, {"reread": True}, {"reread": 1}, {"limit-seconds": 0.5},
    {"sync": True}, {"sync": 2},
    {"limit-bytes": -1}, {"title": "t"},
    {"title": 3}, {"legend": "q (K)"}, {"legend": 3}, {"annotate": "time"},
    {"annotate": "date"}, {"annotate": "time=%.2f"}, {"box": "axes"},
    {"box": True},
    {"opacity": [[0, 0], [200, 1]]}, {"opacity": [[0, 2]]},
    {"opacity": []}, {"opacity": [[0]]}, {"gradient-opacity": [[0, 0], [9, 1]]},
    {"range": [0, 9]}, {"range": ["p1", "p99"]}, {"range": "full"},
    {"range": "auto"}, {"range": [0]}, {"range": ["p1", 3]},
    {"window": 100}, {"window": [100, 50]}, {"window": [100]},
    {"verb": "render"}, {"version": "0.1.0"},
    {"version": True}, {"fps": 1000}, {"fps": 0}, {"allow-gaps": False},
    {"suv": "lbm"}, {"suv": "weight"}, {"vertical": "height"},
    {"vertical": "depth"},
    {"input": ["phantom:shells"]}, {"input": 3}, {"opacity-unit": "mm"},
    {"opacity-unit": "cm"}, {"shade": "none"}, {"light": "head"},
    {"light": [30, 40]}, {"light": "left"}, {"material": [1, 0, 0, 1000]},
    {"material": [1.01, 0, 0, 1]}, {"material": [1, 0, 0]}, {"depth-darkening": 0.5}, {"occlusion": 2},
    {"quality": "high"}, {"quality": "best"}, {"view": "iso"},
    {"view": "inside"}, {"azimuth": -400.5}, {"azimuth": "30"}, {"zoom": 1e-6},
    {"zoom": 0}, {"perspective": 0}, {"perspective": 120},
    {"perspective": 121}, {"fit": "volume"}, {"fit": "all"},
    {"position": [0, 0, 90]}, {"position": [0, 0]}, {"up": [0, 1, 0]},
    {"no-labels": True}, {"no-labels": "yes"}, {"legend": False},
    {"threads": 1}, {"threads": 0}, {"threads": 4097}, {"deterministic": True},
    {"isa": "scalar"}, {"isa": "sse"}, {"crop": [[0, 8], [2, 0], [0, 4]]},
    {"crop": [[0, 8], [2, 0]]}, {"clip": [[1, 0, 0, 4]]}, {"clip": [[1, 0, 0]]},
    {"clip": []}, {"spacing": [1, 2, 0.5]}, {"spacing": [0, 1, 1]},
    {"dims": [4, 4, 0]}, {"time": 0}, {**VECTORS, "time": -1}, {"channel": 0},
    {"mask": 3}, {"frames": 0}, {"stats": "a.json"}, {"output": 3},
    *({**VECTORS, "component": name}
      for name in ("x", "y", "w", "0", "2", "magnitude", "radius", "xy", "",
                   "-1", 2))]


def tool_takes(recipe):
    with open("recipe.json", "w") as file:
        json.dump(recipe, file)
    done = subprocess.run([TOOL, "render", "--config", "recipe.json", "-q"],
                          capture_output=True, text=True)
    return done.returncode in (0, 7), done.stderr.strip()


def main():
    wrong = 0
    taken = 0
    write_vectors()
    for case in CASES:
        recipe = {key: value for key, value in {**BASE, **case}.items()
                  if value is not None}
        tool, said = tool_takes(recipe)
        mine = validator.is_valid(recipe)
        taken += tool
        if tool != mine:
            wrong += 1
            print(f"{json.dumps(case)}: the schema says {mine}, the tool {tool}"
                  f" ({said})")
    print(f"{len(CASES)} recipes, {taken} taken, {wrong} differ")
    return 1 if wrong or taken < 20 else 0


sys.exit(main())
