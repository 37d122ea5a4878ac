"""Files of climate models by netCDF4, and what the tool shows of them."""
import subprocess
import sys

import netCDF4
import numpy as np

TOOL = sys.argv[1]
failures = 0


def check(what, right, told=""):
    global failures
    failures += not right
    print(f"{'ok  ' if right else 'FAIL'} {what}" + (f": {told}" if not right else ""))


def run(*words):
    done = subprocess.run([TOOL, *map(str, words)], capture_output=True, text=True,
                          check=False)
    return done.returncode, done.stdout + done.stderr


def look_of(*words):
    """The colours of the line that tells of a look, and whether it is not shaded."""
    told = run(*words, "-s", "40", "-y")[1]
    line = next((x for x in told.splitlines() if "opacity 0 at" in x), told)
    words = line.split(": ")[-1].split("; ")
    return next((w.split()[-2] for w in words if ".." in w), line), "not shaded" in line


def write(path, name, values, axes, kind="f4", scale=None, **attributes):
    """`axes`: of each dimension its name, coordinates and attributes."""
    with netCDF4.Dataset(path, "w") as f:
        for (axis, where, says), size in zip(axes, values.shape):
            f.createDimension(axis, size)
            f.createVariable(axis, "f8", (axis,))[:] = where
            f[axis].setncatts(says)
        v = f.createVariable(name, kind, [axis for axis, *_ in axes], fill_value=-999)
        if scale:
            v.scale_factor = scale
        v.setncatts(attributes)
        v[:] = values


def axis(name, step, count, units, **says):
    return name, step * np.arange(count), {"units": units, **says}


# Waves of five voxels are no noise, as one of their values in seven would be.
TIME = axis("time", 6, 3, "hours since 2000-01-01")
GRID = (axis("z", 3, 100, "km", axis="Z"), axis("y", 3, 120, "km"),
        axis("x", 3, 120, "km"))
t, z, y, x = np.ogrid[:3, :100, :120, :120]
CLOUD = (np.exp(-((x - 60.) ** 2 + (y - 60.) ** 2 + (z - 50.) ** 2) / 2000) *
         (1 + 0.4 * np.sin(2 * np.pi * 3 * x / 14)) * (1 + 0.1 * t))
write("cloud.nc", "q", CLOUD, (TIME, *GRID), units="kg kg-1")
one = look_of("render", "cloud.nc", "--time", 1, "-o", "p.png")
check("a field is a veil in colours", one == ("viridis", True), one)
for steps in "1", "0:3":
    found = look_of("movie", "cloud.nc", "--time", steps, "-o", "m%d.png")
    check(f"a movie of steps {steps} has the look of one", found == one, found)

sys.exit(failures > 0)
