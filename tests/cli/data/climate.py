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


def picture(*words):
    """Colours that are not premultiplied, and opacities."""
    status, told = run(*words, "-o", "p.npy", "-y", "--background", "none",
                       "--no-labels")
    check("drawn: " + " ".join(map(str, words)), status == 0, told)
    pixels = np.load("p.npy")
    with np.errstate(invalid="ignore", divide="ignore"):
        return pixels[..., :3] / pixels[..., 3:], pixels[..., 3]


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

# Dates are those of cftime, and other units of length are understood.
for date, step in ("2000-01-01", 0), ("2000-01-01 05:00", 1), ("2000-01-02T00:00:00", 2):
    _, told = run("info", "cloud.nc", "--time", date)
    when = netCDF4.num2date(6 * step, "hours since 2000-01-01")
    check(f"{date} is step {step}", f"step {step})" in told and f": {when}" in told, told)
_, told = run("info", "cloud.nc", "--time", "2000-02-30")
check("a day that is none", "is not a date of the input" in told, told)
for at in "150km", "150000m":
    _, told = run("slice", "cloud.nc", "--axis", "z", "--at", at, "-o", "s.png", "-y")
    check(f"--at {at}", "50 of" in told, told)

# Names of variables keep their letters, and the last part of a path is enough.
parts = {name: np.float32(np.random.default_rng(n).normal(size=(6, 7, 8)))
         for n, name in enumerate("UVW")}
with netCDF4.Dataset("winds.nc", "w") as f:
    group = f.createGroup("run").createGroup("Fields")
    for name, size in zip("zyx", (6, 7, 8)):
        f.createDimension(name, size)
    for name, values in parts.items():
        group.createVariable(name, "f4", ("z", "y", "x"))[:] = values
for names in "/run/Fields/U,/run/Fields/V,/run/Fields/W", "U,V,W", "Fields/U,Fields/V,Fields/W":
    told = run("info", "winds.nc", "--component", names)[1]
    found = [float(word) for word in next(
        (x for x in told.splitlines() if x.startswith("values")), "").replace(",", "").split()
        if word[0].isdigit()]
    length = np.sqrt(sum(np.float64(values) ** 2 for values in parts.values()))
    check(f"--component {names}", len(found) > 1 and np.allclose(
        found[:2], [length.min(), length.max()], rtol=1e-5), told)
status, told = run("info", "winds.nc", "--component", "U")
check("a name of one letter keeps it", "component U:" in told and "component u:" not in told,
      told)
told = run("info", "winds.nc", "--dataset", "u")[1]
check("of another case is no name", "there is no such data set" in told, told)
with netCDF4.Dataset("winds.nc", "a") as f:
    f["run"].createVariable("U", "f4", ("z", "y", "x"))[:] = 0
told = run("info", "winds.nc", "--dataset", "U")[1]
check("two that end so are told", "is the end of 2 paths" in told, told)

# One slice: all that the file has is drawn, and nothing that is missing.
LAT, LON = axis("lat", 1, 60, "degrees_north"), axis("lon", 1, 80, "degrees_east")
y, x = np.mgrid[:60, :80]
SEA = np.ma.masked_where((x - 40) ** 2 + (y - 30) ** 2 < 200,
                         271.3 + 30 * np.sin(np.pi * y / 59) + 0.01 * x)
for kind, scale in ("f4", None), ("i2", 0.01):
    write("sea.nc", "tos", SEA, (LAT, LON), kind, scale, units="K")
    for words in (), ("-c", "turbo", "--range", "271,305"):
        opacity = picture("render", "sea.nc", "-s", "320x240", "--fit", "volume", *words)[1]
        inside = opacity[np.ix_(*(np.flatnonzero((opacity > 0.5).any(1 - i))
                                  for i in (0, 1)))]
        share = (inside > 0.99).mean()
        wanted = 1 - np.ma.getmaskarray(SEA).mean()
        check(f"{kind}: water is drawn, land is not", abs(share - wanted) < 0.02,
              f"{share}, not {wanted}")

# A map is not shaded, whatever options give: grey is the value itself.
write("ramp.nc", "v", np.broadcast_to(0.2 + 0.6 * np.arange(80) / 79, (60, 80)),
      (LAT, LON), units="K")
for words in (("--opacity", "0:1,1:1"), ("--opacity", "0:1,1:1", "--time", "0"),
              ("--preset", "linear", "--opacity", "0:1,1:1")):
    colours, opacity = picture("render", "ramp.nc", "-s", "320x240", "-c", "grey",
                               "--range", "0,1", *words)
    row = colours[120, opacity[120] > 0.99, 0]
    wanted = np.linspace(0.2, 0.8, len(row))
    apart = np.abs(row - wanted)[4:-4].max()
    check("colours of a map are those of the bar", apart < 0.02, apart)
colours, opacity = picture("render", "ramp.nc", "-s", "320x240", "-c", "grey", "--range",
                           "0,1", "--opacity", "0:1,1:1", "--shade", "phong")
row = colours[120, opacity[120] > 0.99, 0]
check("--shade phong shades it", np.abs(row - np.linspace(0.2, 0.8, len(row))).max() > 0.02)

sys.exit(failures > 0)
