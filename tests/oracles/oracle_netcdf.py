"""NetCDF, classic and NetCDF-4, beside netCDF4."""
import gzip
import json
import os

import oracle
from oracle import np

netCDF4, = oracle.need("netCDF4")
oracle.need_modules()

CLASSIC = ["i1", "i2", "i4", "f4", "f8"]
MORE = CLASSIC + ["u1", "u2", "u4", "i8", "u8"]
FORMATS = {"NETCDF3_CLASSIC": CLASSIC, "NETCDF3_64BIT_OFFSET": CLASSIC,
           "NETCDF3_64BIT_DATA": MORE, "NETCDF4": MORE,
           "NETCDF4_CLASSIC": CLASSIC}
ZYX = ("z", "y", "x")


def write(path, form, sizes, *variables):
    """A file with axes of these sizes and variables: name, type, axes, values
    as they are stored, and attributes where there are any."""
    with netCDF4.Dataset(path, "w", format=form) as file:
        for name, size in sizes.items():
            file.createDimension(name, size)
        for name, kind, axes, values, *attributes in variables:
            own = dict(*attributes)
            v = file.createVariable(name, kind, axes,
                                    fill_value=own.pop("_FillValue", False))
            v.setncatts(own)
            v.set_auto_maskandscale(False)
            if values is not None:
                v[:] = values


def axis(name, values, **attributes):
    """A coordinate variable."""
    return name, "f8", (name,), values, attributes


for form, types in FORMATS.items():
    write("a.nc", form, {"z": 7, "y": 6, "x": 5},
          *((f"v{kind}", kind, ZYX, oracle.sample(kind)) for kind in types),
          ("text", "S1", ZYX, None))
    for kind in types:
        oracle.expect("a.nc", oracle.sample(kind),
                      options=["--dataset", f"v{kind}"],
                      name=f"{form} {kind}")
    oracle.refuse("a.nc", "vi1", status=2)
    oracle.refuse("a.nc", "not a numeric array", ["--dataset", "text"])
    oracle.refuse("a.nc", "there is no such", ["--dataset", "w"], 2)

# Records: one variable of odd bytes, then several, and a fixed one.
for form in FORMATS:
    for kinds in (["i1"], ["i2"], ["i1", "i2", "f8"]):
        variables = [("fixed", "f4", ZYX, oracle.sample("f4", (3, 5, 7)))]
        for kind in kinds:
            variables.append((f"v{kind}", kind, ("time", *ZYX),
                              oracle.sample(kind, (4, 3, 5, 7))))
            if len(kinds) > 1:
                variables.append((f"w{kind}", kind, ("time", "y", "x"),
                                  oracle.sample(kind, (4, 5, 7), 2)))
        write("b.nc", form, {"time": None, "z": 3, "y": 5, "x": 7}, *variables)
        for name, _, axes, values in variables[1:]:
            times = oracle.few((0, 3), 2, len(kinds)) if "z" in axes else [3]
            for time in times:
                part = values[time] if "z" in axes else values[time:]
                oracle.expect("b.nc", part, None, ["--dataset", name, "--time", time],
                              name=f"{form} {kinds} {name}")
        oracle.expect("b.nc", variables[0][3], options=["--dataset", "fixed"],
                      name=form)

# Time is what says so, wherever it stands: by unit, axis, standard name or
# name.  Others are not: a height, an axis "Z", pictures of two axes.
SINCE = {"units": "days since 2000-01-01"}
STEPS = (
    ("t", ("t", "y", "x"), SINCE, 0),
    ("t", ("y", "t", "x"), SINCE, 1),
    ("t", ("y", "x", "t"), {"axis": "T"}, 2),
    ("t", ("z", "t", "y", "x"), {"standard_name": "time"}, 1),
    ("t", ("t", "z", "y", "x"), SINCE, 0),
    ("Time", ("z", "y", "x", "Time"), {}, 3),
    ("t", ("t", "y", "x"), {"units": "s"}, 0),
    ("t", ("y", "t", "x"), {"units": "s"}, None),
    ("t", ("t", "y", "x"), {"units": "m"}, None),
    ("t", ("t", "y", "x"), {"units": "days", "axis": "Z"}, None),
    ("t", ("t", "x"), SINCE, None))
LENGTHS = {"t": 5, "Time": 5, "z": 6, "y": 7, "x": 8, "m": 3}
for form in FORMATS:
    for t, names, attributes, at in STEPS:
        a = oracle.sample("f4", [LENGTHS[name] for name in names])
        write("t.nc", form, {name: LENGTHS[name] for name in names},
              axis(t, np.arange(5), **attributes), ("v", "f4", names, a))
        for time in (0, 4) if at is not None else ():
            part = a.take(time, axis=at)
            oracle.expect("t.nc", part[(None,) * (3 - part.ndim)],
                          options=["--dataset", "v", "--time", time],
                          name=f"{form} {names} {attributes} {time}")
        if at is None:
            oracle.expect("t.nc", a[(None,) * (3 - a.ndim)],
                          options=["--dataset", "v"],
                          name=f"{form} {names} {attributes}")
            oracle.refuse("t.nc", "the file has 1",
                          ["--dataset", "v", "--time", 1], 2)

# Members of an ensemble are channels; the last axis may be components.
a = oracle.sample("f4", (3, 5, 6, 7, 8))
v = oracle.sample("f4", (6, 7, 8, 3))
write("t.nc", "NETCDF3_CLASSIC", LENGTHS,
      axis("t", np.arange(5), units="hours since 1900-01-01 00:00:00"),
      ("a", "f4", ("m", "t", *ZYX), a), ("v", "f4", (*ZYX, "m"), v))
oracle.expect("t.nc", a[2, 4], options=["--dataset", "a", "--time", 4,
                                        "--channel", 2], name="members")
oracle.expect("t.nc", oracle.magnitude(v), options=["--dataset", "v"],
              name="the magnitude")
for number, name in enumerate("xyz"):
    oracle.expect("t.nc", v[..., number],
                  options=["--dataset", "v", "--component", name])

# An axis that is called so counts components, wherever it stands.
for form in FORMATS:
    write("t.nc", form, {"t": 5, "component": 3, "z": 6, "y": 7, "x": 8},
          ("a", "f4", ("component", *ZYX), a[:, 0]),
          ("b", "f4", ("t", "component", *ZYX), a.swapaxes(0, 1)))
    oracle.expect("t.nc", a[2, 0], options=["--dataset", "a",
                                            "--component", "z"], name=form)
    oracle.expect("t.nc", oracle.magnitude(np.moveaxis(a[:, 3], 0, -1)),
                  options=["--dataset", "b", "--time", 3], name=form)

# Components that are variables of their own: missing where any is.
parts = [oracle.sample(kind, (2, 6, 7, 8), n) for n, kind in
         enumerate(("f4", "f4", "f8"))]
parts[1][0, 1, 2, 3] = np.nan
lengths = oracle.magnitude(np.stack([part.astype("f4") for part in parts], -1))
for form in ("NETCDF3_CLASSIC", "NETCDF4"):
    write("t.nc", form, {"time": 2, "z": 6, "y": 7, "x": 8},
          *((name, part.dtype.str[1:], ("time", *ZYX), part)
            for name, part in zip("uvw", parts)),
          ("flat", "f4", ("y", "x"), parts[0][0, 0]))
    for time in (0, 1):
        options = ["--component", "u,v,w", "--time", time]
        found, _ = oracle.voxels_of("t.nc", options)
        oracle.checked += 1
        if found is None or not np.allclose(found, lengths[time], rtol=1e-6,
                                            equal_nan=True):
            oracle.fail(form, f"{options}: other lengths")
        oracle.tells("t.nc", options, components=3, magnitude=True, quantity="u,v,w")
    for options, part in ((["u,v,no"], "no such"), (["u,,v"], "with commas"),
                          (["u,flat"], "different sizes"), (["no,v"], "no such")):
        oracle.refuse("t.nc", part, ["--component", *options], 2)

# WRF: a time without coordinates, but with a variable of dates along it.
for form in ("NETCDF4", "NETCDF3_64BIT_OFFSET"):
    write("t.nc", form, {"Time": None, "z": 6, "y": 7, "x": 8},
          *((name, "f4", ("Time",), np.arange(5) * 360, {"units": unit})
            for name, unit in (("ITIMESTEP", ""),
                               ("XTIME", "minutes since 2018-06-17"))),
          ("w", "f4", ("Time", *ZYX), oracle.sample("f4", (5, 6, 7, 8)),
           {"description": "z-wind component", "units": "m s-1"}))
    oracle.tells("t.nc", ["--dataset", "w", "--time", "12h"], time=2,
                 time_value=720, time_unit="minutes since 2018-06-17",
                 long_name="z-wind component", value_unit="m s-1")
# The printed command has the step's number, which stays when more are written.
again = oracle.tool("render", "t.nc", "--dataset", "w", "--time", "12h", "-s",
                    "9x9", "-o", "w.png", "-y", "-v", check=True).stderr
if " --time 2 " not in again:
    oracle.fail("WRF", f"the command of a step at a time is {again}")

# The grid of WRF: what lies between mass points, levels by their heights, dates.
def wrf(path, form, times, steps, hill=900.0, **attributes):
    """A run of 5 x 4 x 6 mass points over a hill; its arrays."""
    a = {"T": ("bottom_top", "south_north", "west_east"),
         "U": ("bottom_top", "south_north", "west_east_stag"),
         "V": ("bottom_top", "south_north_stag", "west_east"),
         "W": ("bottom_top_stag", "south_north", "west_east"),
         "PH": ("bottom_top_stag", "south_north", "west_east"),
         "PHB": ("bottom_top_stag", "south_north", "west_east"),
         "TSLB": ("soil_layers_stag", "south_north", "west_east")}
    sizes = {"Time": None, "west_east": 6, "south_north": 4, "bottom_top": 5,
             "west_east_stag": 7, "south_north_stag": 5, "bottom_top_stag": 6,
             "soil_layers_stag": 3, "DateStrLen": 19}
    values = {name: oracle.sample("f4", (steps, *(sizes[d] for d in axes)), n)
              for n, (name, axes) in enumerate(a.items())}
    ground = hill * np.array([0, .2, 1, .5, 0, 0]) + np.zeros((4, 6))
    levels = np.array([0, 100, 300, 700, 1500, 3000.0])
    values["PHB"] = np.arange(steps)[:, None, None, None] + np.float32(9.81 * (ground + levels[:, None, None]
                                       * (1 - ground / 6000)) + np.zeros((steps, 6, 4, 6)))
    values["PH"] = np.float32(values["PH"] % 50 + 90 * levels[:, None, None] / 3000)
    with netCDF4.Dataset(path, "w", format=form) as file:
        file.setncatts({"TITLE": " OUTPUT FROM WRF V4.2 MODEL", **attributes})
        file.DX, file.DY = np.float32(3000), np.float32(2000)
        for name, size in sizes.items():
            file.createDimension(name, size)
        file.createVariable("Times", "S1", ("Time", "DateStrLen"))[:] = \
            np.array([list(t) for t in times], "S1")
        for name, size in (("XLAT", 1), ("XLONG", 1)):
            file.createVariable(name, "f4", ("Time", *a["T"][1:]))[:] = np.ones((steps, 4, 6))
        for name, axes in a.items():
            v = file.createVariable(name, "f4", ("Time", *axes))
            v[:] = values[name]
            v.coordinates = "XLONG XLAT XTIME"
    return values


def heights(v, step):
    """Those of the mass points, and of the ground and the top."""
    h = (v["PH"][step].astype("f8") + v["PHB"][step]) / 9.81
    return (h[1:] + h[:-1]) / 2, h[0], h[-1]


HOURS = [f"2005-08-28_{hour:02d}:00:00" for hour in range(5)]
for form in ("NETCDF4", "NETCDF3_64BIT_OFFSET"):
    v = wrf("w.nc", form, HOURS[:2], 2, SIMULATION_START_DATE="2005-08-27_12:00:00")
    mass = {"T": v["T"], "U": (v["U"][..., 1:] + v["U"][..., :-1]) / 2,
            "V": (v["V"][:, :, 1:] + v["V"][:, :, :-1]) / 2,
            "W": (v["W"][:, 1:] + v["W"][:, :-1]) / 2}
    for name, values in mass.items():
        for step in (0, 1):
            options = ["--dataset", name, "--time", step]
            told = oracle.told("w.nc", *options)
            found, _ = oracle.voxels_of("w.nc", options)
            matrix = told["matrix"]
            mean = heights(v, step)[0].mean((1, 2))
            base = v["PHB"][0].astype("f8").mean((1, 2)) / 9.81
            first = matrix[2][3]
            if abs(first - (base[0] + base[1]) / 2) > 6:
                oracle.fail(form, f"{options}: from {first}")
            nodes = np.clip(np.rint((mean - first) / matrix[2][2]), 0,
                            told["dims"][2] - 1).astype(int)
            if not np.allclose(found[nodes], values[step], rtol=1e-5, atol=1e-4) or \
                    len(set(nodes)) < 5:
                oracle.fail(form, f"{options}: other values at {nodes}")
            if not np.allclose([matrix[0][0], matrix[1][1], matrix[2][3]],
                               [3000, 2000, first], rtol=1e-5) or told["unit"] != "m":
                oracle.fail(form, f"{options}: placed by {matrix}")
            if (told["time_value"], told["time_unit"]) != \
                    (720 + 60 * step, "minutes since 2005-08-27 12:00:00"):
                oracle.fail(form, f"{options}: at {told['time_value']} {told['time_unit']}")
            # Columns at even heights: nothing below the ground.
            options += ["--vertical", "height"]
            found, _ = oracle.voxels_of("w.nc", options)
            matrix = oracle.told("w.nc", *options)["matrix"]
            z = matrix[2][3] + matrix[2][2] * np.arange(len(found))
            at, ground, top = heights(v, step)
            right = np.full(found.shape, np.nan)
            for y, x in np.ndindex(4, 6):
                inside = (z >= ground[y, x]) & (z <= top[y, x])
                right[inside, y, x] = np.interp(z[inside], at[:, y, x], values[step][:, y, x])
            oracle.checked += 1
            if not np.allclose(found, right, rtol=1e-4, atol=1e-3, equal_nan=True) or \
                    not np.isnan(found[0, 0, 2]) or z[-1] < 2000:
                oracle.fail(form, f"{options}: other columns")
            part, _ = oracle.voxels_of("w.nc", [*options, "--crop", "1:4,2:4,3:9"])
            if not np.array_equal(part, found[3:9, 2:4, 1:4], equal_nan=True):
                oracle.fail(form, f"{options}: another box")
    oracle.says("T", "w.nc", "+ 300 K", "--dataset", "T")
    oracle.says("levels", "w.nc", "--vertical height shows", "--dataset", "U")
    oracle.expect("w.nc", v["TSLB"][0], oracle.affine((3000, 2000, 3000), (0, 0, 0)),
                  ["--dataset", "TSLB"], unit="m")
    oracle.refuse("w.nc", "holds 7 volumes", status=2)
    oracle.refuse("w.nc", "--vertical", ["--vertical", "depth"], 2)
    # Several files of several steps are one series.
    for first in (0, 2):
        wrf(f"wrfout_d01_2005-08-28_{first:02d}:00:00", form, HOURS[first:first + 2], 2,
            SIMULATION_START_DATE=HOURS[0])
    for options, minutes in ((0, 0), (1, 60), (2, 120), (-1, 180), ("2.4h", 120)):
        oracle.tells("wrfout_d01_*", ["--dataset", "T", "--time", options],
                     time_value=minutes)
    oracle.refuse("wrfout_d01_*", "for 4 steps", ["--dataset", "T", "--time", "4"], 2)
    made = oracle.tool("movie", "wrfout_d01_*", "--dataset", "W", "-s", "16x12", "--time",
                       "1:4", "-o", form + "%d.png", "-y")
    if made.returncode or sum(
            name.startswith(form) and name.endswith(".png") for name in os.listdir(".")) != 3:
        oracle.fail(form, f"no movie of three steps: {made.stderr}")
    for wrong in ("2005-13-28_00:00:00", "2005-08-28 00:00:00", "2005-08-28_00:00:0x"):
        wrf("x.nc", form, [wrong], 1)
        oracle.says(wrong, "x.nc", "is no date", "--dataset", "T")

# What says where others lie is no volume, and does not hide the field; places
# by two axes are counted in voxels (NEMO, ROMS, POP).
for form in ("NETCDF4", "NETCDF3_CLASSIC"):
    field = oracle.sample("f4", (1, 33, 36))
    sizes = {"time_counter": None, "deptht": 4, "y": 33, "x": 36, "nvertex": 4}
    bounds = [(name, "f4", ("y", "x", "nvertex"), oracle.sample("f4", (33, 36, 4)))
              for name in ("bounds_lon", "bounds_lat")]
    places = [(name, "f4", ("y", "x"), oracle.sample("f4", (33, 36)),
               {"bounds": f"bounds_{name[4:]}"}) for name in ("nav_lat", "nav_lon")]
    tos = ("tos", "f4", ("time_counter", "y", "x"), field, {"coordinates": "nav_lat nav_lon"})
    write("n.nc", form, sizes, *bounds, *places, tos)
    oracle.expect("n.nc", field, name=f"{form} a field beside bounds")
    oracle.says(form, "n.nc", "(nav_lat nav_lon) are curvilinear")
    oracle.says(form, "n.nc", None, "--dataset", "nav_lon")
    oracle.expect("n.nc", bounds[0][3], options=["--dataset", "bounds_lon"])
    write("n.nc", form, sizes, *places, tos,
          *((name, "f4", ("time_counter", "deptht", "y", "x"),
             oracle.sample("f4", (1, 4, 33, 36)), {"coordinates": "deptht e3t nav_lat"})
            for name in ("e3t", "so")), axis("deptht", [1, 2, 4, 8], units="m", positive="down"))
    oracle.tells("n.nc", quantity="so", axis_units=["", "", "m"])
    write("n.nc", form, sizes, *bounds[1:], places[0])
    oracle.tells("n.nc", quantity="nav_lat")

# Lines of a scan that have dates are no steps of time.
for form in FORMATS:
    a = oracle.sample("f4", (6, 7, 8))
    write("s.nc", form, {"z": 6, "y": 7, "x": 8},
          ("scanned", "f8", ("y",), np.arange(7) * 60.0,
           {"units": "seconds since 2020-01-01"}), ("v", "f4", ZYX, a))
    oracle.expect("s.nc", a, options=["--dataset", "v"], name=f"{form} a scan")

# What grows downward: an ocean's depth, pressure, and a height from the top.
a = oracle.sample("f4", (4, 5, 6))
for form in FORMATS:
    for attributes, values, along in (
            ({"units": "m", "positive": "down"}, np.arange(4) * 5.0, -5),
            ({"units": "hPa"}, 1000 - np.arange(4) * 100.0, 100),
            ({"units": "hPa"}, 100 + np.arange(4) * 100.0, -100),
            ({"units": "m"}, np.arange(4) * 5.0, 5),
            ({"units": "m"}, 20 - np.arange(4) * 5.0, -5),
            ({"units": "degrees", "positive": "down"}, 1 + np.arange(4) * 2.0, -2)):
        write("d.nc", form, {"z": 4, "lat": 5, "lon": 6},
              axis("z", values, **attributes),
              axis("lat", np.arange(5), units="degrees_north"),
              axis("lon", np.arange(6) * 3, units="degrees_east"),
              ("v", "f4", ("z", "lat", "lon"), a))
        down = -1 if len(attributes) > 1 or attributes["units"] == "hPa" else 1
        oracle.expect("d.nc", a, oracle.affine((3, 1, along), (0, 0, down * values[0])),
                      unit="degrees", name=f"{form} {attributes} {values}")
        oracle.tells("d.nc", spacing=[3, 1, abs(along)],
                     axis_units=["degrees", "degrees", attributes["units"]])


def slice_at(at, *options):
    """The number of the slice, and where it is."""
    done = oracle.tool("slice", "d.nc", "--axis", "z", "--at", at, "-o", "s.png",
                       "-y", "--stats", "s.json", *options)
    found = {} if done.returncode else json.loads(oracle.got("s.json"))["slice"]
    return done.stderr if done.returncode else \
        (found["index"], round(found["position"], 6), found["unit"])


# Each axis has its unit: levels are found by it, and higher in pictures.
for unit, levels, places in (
        ("hPa", (1000, 900, 800, 700), {"900hPa": (1, 900, "hPa"), "70000Pa": (3, 700, "hPa")}),
        ("millibars", (1, 2, 3, 4), {"3hPa": (2, 3, "millibars"), "2": (2, 3, "millibars")}),
        ("km", (0, 1, 2, 3), {"2000m": (2, 2, "km"), "3km": (3, 3, "km")})):
    write("d.nc", "NETCDF4", {"z": 4, "lat": 7, "lon": 6},
          axis("z", levels, units=unit),
          axis("lat", np.arange(7), units="degrees_north"),
          axis("lon", np.arange(6) * 3, units="degrees_east"),
          ("v", "f4", ("z", "lat", "lon"), oracle.sample("f4", (4, 7, 6))))
    for place, wanted in places.items():
        oracle.checked += 1
        if slice_at(place) != wanted:
            oracle.fail(place, f"is {slice_at(place)}, not {wanted}")
for options, height in (((), 6 / 3), (("--z-scale", "auto"), 6 / 3),
                        (("--z-scale", 100), 300 / 111.195),
                        (("--z-scale", 40), 120 / 111.195)):
    oracle.tells("d.nc", options, spacing=[3, 1, 1],
                 axis_units=["degrees", "degrees", "km"])
    # A box that is all opaque, of 6 voxels and 4: 18 wide.
    oracle.tool("render", "d.nc", "-o", "d.npy", "-y", "-s", "400x400", "--view",
                "front", "--preset", "linear", "--range=0,1", "--opacity=-1e9:1,1e9:1",
                "--fit", "volume", "--shade", "none", *options, check=True)
    seen = np.load("d.npy")[..., 3] > 0.3
    high, wide = (np.count_nonzero(seen.any(i)) for i in (1, 0))
    oracle.checked += 1
    if not 0.85 < wide / 18 * height * 4 / 3 / high < 1.15:
        oracle.fail("z-scale", f"{options}: {high} of {wide}, not {height}")
    # What is written has the coordinates, whatever the picture's height.
    oracle.tool("convert", "d.nc", "-o", "d.nrrd", "-y", *options, check=True)
    oracle.tells("d.nrrd", (), spacing=[3, 1, 1])
write("d.nc", "NETCDF4", {"z": 4, "y": 7, "x": 6},
      ("v", "f4", ("z", "y", "x"), oracle.sample("f4", (4, 7, 6))))
if slice_at("2mm") != (2, 2, "") or slice_at("2", "--z-scale", 5) != (2, 2, ""):
    oracle.fail("no unit", f"{slice_at('2mm')} {slice_at('2', '--z-scale', 5)}")
oracle.refuse("d.nc", "out of range", ["--z-scale", "-3"], 2)

# Coordinates, packed and missing values; a gzip stream around them.
packed = oracle.sample("i2", (2, 4, 5, 6))
packed[0, 1, 2, 3] = packed[0, 0, 0, 0] = -999
values = packed * 0.5 + 10
values[packed == -999] = np.nan
matrix = oracle.affine((3, -0.5, 2), (1, 9, 0))
for form in FORMATS:
    write("c.nc", form, {"time": None, "lev": 4, "lat": 5, "lon": 6},
          axis("lev", np.arange(4) * 2, units="km"),
          axis("lat", 9 - np.arange(5) * 0.5, units="degrees_north"),
          axis("lon", np.arange(6) * 3 + 1, units="degrees_east"),
          ("t", "i2", ("time", "lev", "lat", "lon"), packed,
           {"_FillValue": -999, "scale_factor": 0.5, "add_offset": 10.0}))
    oracle.expect("c.nc", values[0], matrix, dtype=np.float32, unit="degrees",
                  name=f"{form} packed")
    oracle.expect(oracle.packed("c.nc", "c.nc.gz"), values[1], matrix,
                  ["--time", 1], dtype=np.float32, unit="degrees",
                  name=f"{form} gzip")
write("c.nc", "NETCDF3_CLASSIC", {"z": 7, "y": 6, "x": 5},
      ("v", "i1", ZYX, oracle.sample("i1"), {"_Unsigned": "true"}))
oracle.expect("c.nc", oracle.sample("i1").view("u1"), name="_Unsigned")
oracle.refuse_cut("c.nc", (3, 30, 100, os.path.getsize("c.nc") - 9),
                  "truncated")

path = oracle.data("formats/netcdf/tos_O1_2001-2002.nc.gz")
if path:
    with gzip.open(path) as file:
        data = netCDF4.Dataset("tos", memory=file.read())
    tos = data["tos"][:].filled(np.nan)
    for time in (0, 23):
        oracle.expect(path, tos[time:time + 1],
                      oracle.affine((2, 1, 2), (1, -79.5, 0)),
                      ["--time", time], unit="degrees")
    oracle.refuse(path, "the file has 24", ["--time", 24], 2)
# Files of one day each, which count from a date of their own.
UNITS = ("minutes since 2001-02-26 00:00:00", "minutes since 2001-02-27 00:00:00",
         "minutes since 2001-02-28", "hours since 2001-02-28 06:00:00")
for n, unit in enumerate(UNITS):
    with netCDF4.Dataset(f"day{n}.nc", "w") as file:
        for name, size in ("time", 1), ("z", 4), ("y", 5), ("x", 6):
            file.createDimension(name, size)
        file.createVariable("time", "f8", ("time",))[:] = 30
        file["time"].units = unit
        v = file.createVariable("rho", "f4", ("time", *ZYX))
        v[:] = np.full((1, 4, 5, 6), n, "f4")
for n, date in enumerate(("2001-02-26", "2001-02-27T01:00", "2001-02-28 03:00",
                          "2001-03-02")):
    oracle.expect("day*.nc", np.full((4, 5, 6), n, "f4"), options=["--time", date])
LOOK = ["-q", "-y", "-s", "160x120", "--range", "0,9", "--opacity", "0:0,9:0.5",
        "-c", "grey", "--shade", "none", "--annotate", "time", "-o"]
days = [f"day{n}.nc" for n in range(4)]
oracle.tool("movie", *days, *LOOK, "movie_%d.png")
for n, day in enumerate(days):
    oracle.tool("render", day, *LOOK, "day.png")
    done = oracle.tool("compare", "day.png", f"movie_{n}.png")
    if done.returncode:
        oracle.fail(f"the date of frame {n}", done.stdout + done.stderr)
# MINC is recognised by its variables, not by a version that old files lack.
for beside, attributes in (("image-max", {}), ("rootvariable", {}),
                           ("w", {"varid": "MINC standard variable"})):
    write("m.mnc", "NETCDF3_CLASSIC", {"zspace": 4, "yspace": 5, "xspace": 6},
          (beside, "f8", ("zspace",), np.ones(4)),
          ("image", "i2", ("zspace", "yspace", "xspace"),
           oracle.sample("i2", (4, 5, 6)), attributes))
    oracle.refuse("m.mnc", "MINC")
write("m.nc", "NETCDF3_CLASSIC", {"z": 7, "y": 6, "x": 5},
      ("image", "f4", ZYX, oracle.sample("f4")))
oracle.expect("m.nc", oracle.sample("f4"), name="an image that is no MINC")

path = oracle.data("formats/minc/minc1_4d.mnc")
if path:
    oracle.refuse(path, "MINC")
oracle.finish()
