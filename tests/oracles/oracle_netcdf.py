"""NetCDF, classic and NetCDF-4, beside netCDF4."""
import sys

try:
    import netCDF4
    import numpy as np
except ImportError as missing:
    print("skip  ", missing)
    sys.exit(77)
import gzip
import json
import subprocess

import oracle

oracle.need_modules()

place = oracle.folder()
CLASSIC = ["i1", "i2", "i4", "f4", "f8"]
MORE = CLASSIC + ["u1", "u2", "u4", "i8", "u8"]
FORMATS = {"NETCDF3_CLASSIC": CLASSIC, "NETCDF3_64BIT_OFFSET": CLASSIC,
           "NETCDF3_64BIT_DATA": MORE, "NETCDF4": MORE,
           "NETCDF4_CLASSIC": CLASSIC}

for form, types in FORMATS.items():
    with netCDF4.Dataset("a.nc", "w", format=form) as file:
        for name, size in (("z", 7), ("y", 6), ("x", 5)):
            file.createDimension(name, size)
        for kind in types:
            v = file.createVariable(f"v{kind}", kind, ("z", "y", "x"),
                                    fill_value=False)
            v[:] = oracle.sample(kind)
        file.createVariable("text", "S1", ("z", "y", "x"))
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
        with netCDF4.Dataset("b.nc", "w", format=form) as file:
            file.createDimension("time", None)
            for name, size in (("z", 3), ("y", 5), ("x", 7)):
                file.createDimension(name, size)
            fixed = file.createVariable("fixed", "f4", ("z", "y", "x"))
            fixed[:] = oracle.sample("f4", (3, 5, 7))
            for kind in kinds:
                v = file.createVariable(f"v{kind}", kind,
                                        ("time", "z", "y", "x"),
                                        fill_value=False)
                v[:] = oracle.sample(kind, (4, 3, 5, 7))
                v = file.createVariable(f"w{kind}", kind,
                                        ("time", "y", "x"),
                                        fill_value=False) \
                    if len(kinds) > 1 else None
                if v:
                    v[:] = oracle.sample(kind, (4, 5, 7), 2)
        for kind in kinds:
            for time in oracle.few((0, 3), 2, len(kinds)):
                oracle.expect("b.nc", oracle.sample(kind, (4, 3, 5, 7))[time],
                              options=["--dataset", f"v{kind}", "--time",
                                       time], name=f"{form} {kinds} {kind}")
            if len(kinds) > 1:
                oracle.expect("b.nc", oracle.sample(kind, (4, 5, 7), 2)[3:],
                              options=["--dataset", f"w{kind}", "--time", 3],
                              name=f"{form} {kinds} {kind} without z")
        oracle.expect("b.nc", oracle.sample("f4", (3, 5, 7)),
                      options=["--dataset", "fixed"], name=form)

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
    for which, (t, names, attributes, at) in enumerate(STEPS):
        a = oracle.sample("f4", [LENGTHS[name] for name in names])
        with netCDF4.Dataset("t.nc", "w", format=form) as file:
            for name in names:
                file.createDimension(name, LENGTHS[name])
            c = file.createVariable(t, "f8", (t,))
            c[:] = np.arange(5)
            c.setncatts(attributes)
            file.createVariable("v", "f4", names, fill_value=False)[:] = a
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
with netCDF4.Dataset("t.nc", "w", format="NETCDF3_CLASSIC") as file:
    for name, size in LENGTHS.items():
        file.createDimension(name, size)
    file.createVariable("t", "f8", ("t",))[:] = np.arange(5)
    file["t"].units = "hours since 1900-01-01 00:00:00"
    file.createVariable("a", "f4", ("m", "t", "z", "y", "x"),
                        fill_value=False)[:] = a
    file.createVariable("v", "f4", ("z", "y", "x", "m"),
                        fill_value=False)[:] = v
oracle.expect("t.nc", a[2, 4], options=["--dataset", "a", "--time", 4,
                                        "--channel", 2], name="members")
oracle.expect("t.nc", oracle.magnitude(v), options=["--dataset", "v"],
              name="the magnitude")
for number, name in enumerate("xyz"):
    oracle.expect("t.nc", v[..., number],
                  options=["--dataset", "v", "--component", name])

# An axis that is called so counts components, wherever it stands.
for form in FORMATS:
    with netCDF4.Dataset("t.nc", "w", format=form) as file:
        for name, size in (("t", 5), ("component", 3), ("z", 6), ("y", 7),
                           ("x", 8)):
            file.createDimension(name, size)
        file.createVariable("a", "f4", ("component", "z", "y", "x"),
                            fill_value=False)[:] = a[:, 0]
        file.createVariable("b", "f4", ("t", "component", "z", "y", "x"),
                            fill_value=False)[:] = a.swapaxes(0, 1)
    oracle.expect("t.nc", a[2, 0], options=["--dataset", "a",
                                            "--component", "z"], name=form)
    oracle.expect("t.nc", oracle.magnitude(np.moveaxis(a[:, 3], 0, -1)),
                  options=["--dataset", "b", "--time", 3], name=form)

# WRF: a time without coordinates, but with a variable of dates along it.
for form in ("NETCDF4", "NETCDF3_64BIT_OFFSET"):
    with netCDF4.Dataset("t.nc", "w", format=form) as file:
        for name, size in (("Time", None), ("z", 6), ("y", 7), ("x", 8)):
            file.createDimension(name, size)
        for name, unit in (("ITIMESTEP", ""),
                           ("XTIME", "minutes since 2018-06-17")):
            file.createVariable(name, "f4", ("Time",)).units = unit
            file[name][:] = np.arange(5) * 360
        file.createVariable("w", "f4", ("Time", "z", "y", "x"))[:] = \
            oracle.sample("f4", (5, 6, 7, 8))
        file["w"].setncatts({"description": "z-wind component",
                             "units": "m s-1"})
    said = json.loads(oracle.run("t.nc", "--dataset", "w",
                                 "--time", "12h").stdout or "{}")
    for key, value in (("time", 2), ("time_value", 720),
                       ("time_unit", "minutes since 2018-06-17"),
                       ("long_name", "z-wind component"),
                       ("value_unit", "m s-1")):
        if said.get(key) != value:
            oracle.fail(f"WRF {form}", f"{key} is {said.get(key)}, not {value}")
# The printed command has the step's number, which stays when more are written.
again = subprocess.run([oracle.TOOL, "render", "t.nc", "--dataset", "w", "--time", "12h",
                        "-s", "9x9", "-o", "w.png", "-y", "-v"],
                       capture_output=True, text=True, check=True).stderr
if " --time 2 " not in again:
    oracle.fail("WRF", f"the command of a step at a time is {again}")

# Lines of a scan that have dates are no steps of time.
for form in FORMATS:
    a = oracle.sample("f4", (6, 7, 8))
    with netCDF4.Dataset("s.nc", "w", format=form) as file:
        for name in ("z", "y", "x"):
            file.createDimension(name, LENGTHS[name])
        file.createVariable("scanned", "f8", ("y",))[:] = np.arange(7) * 60.0
        file["scanned"].units = "seconds since 2020-01-01"
        file.createVariable("v", "f4", ("z", "y", "x"), fill_value=False)[:] = a
    oracle.expect("s.nc", a, options=["--dataset", "v"], name=f"{form} a scan")

# What grows downward: an ocean's depth, pressure, and a height from the top.
for form in FORMATS:
    for attributes, values, along in (
            ({"units": "m", "positive": "down"}, np.arange(4) * 5.0, -3),
            ({"units": "hPa"}, 1000 - np.arange(4) * 100.0, 3),
            ({"units": "hPa"}, 100 + np.arange(4) * 100.0, -3),
            ({"units": "m"}, np.arange(4) * 5.0, 3),
            ({"units": "m"}, 20 - np.arange(4) * 5.0, -3),
            ({"units": "degrees", "positive": "down"}, 1 + np.arange(4) * 2.0, -2)):
        a = oracle.sample("f4", (4, 5, 6))
        with netCDF4.Dataset("d.nc", "w", format=form) as file:
            for name, coordinates, own in (
                    ("z", values, attributes),
                    ("lat", np.arange(5) * 1.0, {"units": "degrees_north"}),
                    ("lon", np.arange(6) * 3.0, {"units": "degrees_east"})):
                file.createDimension(name, len(coordinates))
                file.createVariable(name, "f8", (name,))[:] = coordinates
                file[name].setncatts(own)
            file.createVariable("v", "f4", ("z", "lat", "lon"),
                                fill_value=False)[:] = a
        first = -1 if attributes["units"] == "degrees" else 0
        oracle.expect("d.nc", a, oracle.affine((3, 1, along), (0, 0, first)),
                      unit="degrees", name=f"{form} {attributes} {values}")

# Coordinates, packed and missing values; a gzip stream around them.
for form in FORMATS:
    packed = oracle.sample("i2", (2, 4, 5, 6))
    packed[0, 1, 2, 3] = packed[0, 0, 0, 0] = -999
    with netCDF4.Dataset("c.nc", "w", format=form) as file:
        file.createDimension("time", None)
        for name, values, unit in (
                ("lev", np.arange(4) * 2.0, "km"),
                ("lat", 9 - np.arange(5) * 0.5, "degrees_north"),
                ("lon", np.arange(6) * 3.0 + 1, "degrees_east")):
            file.createDimension(name, len(values))
            v = file.createVariable(name, "f8", (name,))
            v[:] = values
            v.units = unit
        v = file.createVariable("t", "i2", ("time", "lev", "lat", "lon"),
                                fill_value=-999)
        v.scale_factor = 0.5
        v.add_offset = 10.0
        v.set_auto_maskandscale(False)
        v[:] = packed
    values = packed * 0.5 + 10
    values[packed == -999] = np.nan
    oracle.expect("c.nc", values[0], oracle.affine((3, -0.5, 3), (1, 9, 0)),
                  dtype=np.float32, unit="degrees", name=f"{form} packed")
    with open("c.nc", "rb") as file, gzip.open("c.nc.gz", "wb") as to:
        to.write(file.read())
    oracle.expect("c.nc.gz", values[1],
                  oracle.affine((3, -0.5, 3), (1, 9, 0)), ["--time", 1],
                  dtype=np.float32, unit="degrees", name=f"{form} gzip")
with netCDF4.Dataset("c.nc", "w", format="NETCDF3_CLASSIC") as file:
    for name, size in (("z", 7), ("y", 6), ("x", 5)):
        file.createDimension(name, size)
    v = file.createVariable("v", "i1", ("z", "y", "x"), fill_value=False)
    v[:] = oracle.sample("i1")
    v.setncattr("_Unsigned", "true")
oracle.expect("c.nc", oracle.sample("i1").view("u1"), name="_Unsigned")
with open("c.nc", "rb") as file:
    whole = file.read()
for size in (3, 30, 100, len(whole) - 9):
    with open("d.nc", "wb") as file:
        file.write(whole[:size])
    oracle.refuse("d.nc", "truncated")

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
path = oracle.data("formats/minc/minc1_4d.mnc")
if path:
    oracle.refuse(path, "MINC")
oracle.finish()
