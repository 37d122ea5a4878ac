"""HDF5 beside h5py."""
import os
import struct
import zlib

import oracle
from oracle import np

h5py, = oracle.need("h5py")
oracle.need_modules()

TYPES = ["i1", "u1", "<i2", ">i2", "<u2", "<i4", ">u4", "<i8", ">u8", "<f2",
         "<f4", ">f4", "<f8", ">f8", "?"]
with h5py.File("a.h5", "w") as file:
    for kind in TYPES:
        file[f"types/{kind}"] = oracle.sample(kind)
for kind in TYPES:
    a = oracle.wide(oracle.sample(kind))
    oracle.expect("a.h5", a, options=["--dataset", f"/types/{kind}"])
    oracle.expect(f"a.h5:/types/{kind}", a)
oracle.refuse("a.h5", "/types/i1 (5x6x7)", status=2)
oracle.refuse("a.h5", "no such data set", ["--dataset", "none"], 2)

# Storage: chunks, filters, a user's block, gzip around it, other versions.
a = oracle.sample("<f4", (20, 30, 40))
ways = [dict(chunks=(7, 8, 9)), dict(compression="gzip", chunks=True),
        dict(compression="gzip", shuffle=True, fletcher32=True),
        dict(compression="lzf", chunks=True), dict(compression="lzf", shuffle=True),
        dict(fletcher32=True), dict(scaleoffset=0), {}]
if h5py.h5z.filter_avail(h5py.h5z.FILTER_SZIP):
    ways.append(dict(compression="szip", chunks=(5, 6, 8)))
for way in ways:
    for version in ("earliest", "latest"):
        v = a if "scaleoffset" not in way else \
            oracle.sample("<i1", a.shape).astype("<i2")
        with h5py.File("b.h5", "w", libver=version) as file:
            file.create_dataset("only", data=v, **way)
            file["line"] = np.arange(10)
        oracle.expect("b.h5", v, name=f"{way} {version}")
with h5py.File("b.h5", "w") as file:
    file["only"] = a
oracle.packed("b.h5", "b.h5.gz")
oracle.expect("b.h5.gz", a)
with h5py.File("c.h5", "w", userblock_size=1024) as file:
    file["only"] = a
oracle.expect("c.h5", a, name="user's block")
with h5py.File("d.h5", "w") as file:
    part = file.create_dataset("only", (20, 30, 40), "<i2", chunks=(5, 5, 5),
                               fillvalue=-7)
    part[4:9, 3:4, 20:] = 3
    half = part[()]
oracle.expect("d.h5", half, name="chunks never written")

# Times and channels, two axes.
t = oracle.sample("u2", (3, 2, 5, 6, 7))
with h5py.File("e.h5", "w") as file:
    file["t"] = t[:, 0]
    file["tc"] = t
    file["flat"] = t[0, 0, 0]
for time in range(3):
    oracle.expect("e.h5:/t", t[time, 0], options=["--time", time])
    for channel in range(2):
        oracle.expect("e.h5:/tc", t[time, channel],
                      options=["--time", time, "--channel", channel])
oracle.expect("e.h5:/flat", t[0, 0, :1])

# A last axis of 2 to 4 holds components; more are an axis of space.
for kind in ("<f4", "<f8", "<u2"):
    for count in (2, 3, 4):
        v = oracle.sample(kind, (6, 7, 8, count))
        with h5py.File("v.h5", "w") as file:
            file["v"] = v
        vector = count < 4 and kind != "<u2"
        oracle.expect("v.h5", oracle.magnitude(v) if vector else v[..., 0],
                      name=f"{kind} {count} by default")
        if kind != "<u2":
            oracle.expect("v.h5", oracle.magnitude(v),
                          options=["--component", "magnitude"],
                          name=f"{kind} {count} magnitude")
        for number in range(count):
            for option in (("--component", "xyzw"[number]),
                           ("--component", number), ("--channel", number)):
                oracle.expect("v.h5", v[..., number], options=option,
                              name=f"{kind} {count} {option}")
        oracle.refuse("v.h5", f"component {count} does not exist",
                      ["--component", count], 2)
v = oracle.sample("<u2", (6, 7, 8, 3))
with h5py.File("v.h5", "w") as file:
    file["v"] = v
oracle.expect("v.h5", oracle.magnitude(v.astype("f4")),
              options=["--component", "magnitude"])
t = oracle.sample("<f4", (5, 6, 7, 8, 3))
five = oracle.sample("<f4", (6, 7, 8, 5))
colours = oracle.sample("u1", (7, 8, 3))
with h5py.File("v.h5", "w") as file:
    file["t"] = t
    file["five"] = five
    file["one"] = five[..., :1]
    file["colours"] = colours
    file["thin"] = colours
    file["colours"].attrs["CLASS"] = np.bytes_("IMAGE")
    file["colours"].attrs["IMAGE_SUBCLASS"] = np.bytes_("IMAGE_TRUECOLOR")
    file["colours"].attrs["INTERLACE_MODE"] = np.bytes_("INTERLACE_PIXEL")
for time in (0, 4):
    oracle.expect("v.h5:/t", t[time, ..., 1],
                  options=["--time", time, "--component", "y"])
oracle.expect("v.h5:/t", oracle.magnitude(t[2]), options=["--time", 2])
oracle.expect("v.h5:/five", five[3], options=["--time", 3])
oracle.expect("v.h5:/one", five[..., 0])
oracle.expect("v.h5:/colours", colours[None, ..., 2],
              options=["--component", "z"])
oracle.expect("v.h5:/thin", colours)
oracle.refuse("v.h5:/thin", "have one value", ["--component", "magnitude"], 2)
oracle.refuse("v.h5:/t", "not a component", ["--component", "radius"], 2)
oracle.refuse("v.h5:/t", "which name the same",
              ["--component", "x", "--channel", 1], 2)

# Labels of axes say which counts components, and which is time.
with h5py.File("v.h5", "w") as file:
    for name, labels in (("a", ("component", "z", "y", "x")),
                         ("b", ("time", "z", "y", "x")),
                         ("c", ("z", "y", "x", "t"))):
        v = file.create_dataset(name, data=t[:, 0])
        for axis, label in zip(v.dims, labels):
            axis.label = label
    for name, label, count in (("f", "Vector", 9), ("g", "components", 10)):
        file[name] = oracle.sample("<f4", (count, 7, 6))
        file[name].dims[0].label = label
    file["e"] = t[0]
    file["e"].dims[3].label = "x"
    # A scale says what an axis is; a label beside it says less.
    file["component"] = np.arange(5.)
    file["component"].make_scale("component")
    file["h"] = t[:, 0]
    file["h"].dims[0].attach_scale(file["component"])
    file["h"].dims[0].label = "part"
oracle.expect("v.h5:/a", t[4, 0], options=["--component", 4])
oracle.expect("v.h5:/h", t[4, 0], options=["--component", 4])
oracle.refuse("v.h5:/a", "the file has 1", ["--time", 1], 2)
oracle.expect("v.h5:/b", t[2, 0], options=["--time", 2])
oracle.expect("v.h5:/c", t[:, 0, ..., 1], options=["--time", 1])
oracle.expect("v.h5:/f", oracle.sample("<f4", (9, 7, 6))[None, 8],
              options=["--component", 8])
oracle.expect("v.h5:/g", oracle.sample("<f4", (10, 7, 6)))
oracle.expect("v.h5:/e", t[0, 5], options=["--time", 5])

# openPMD: labels, spacing and offset follow the order of the indices.
m = oracle.sample("<f4", (4, 5, 6))
with h5py.File("p.h5", "w") as file:
    for order in "CF":
        mesh = file.create_group(order)
        labels = ("z", "y", "x") if order == "C" else ("x", "y", "z")
        mesh.attrs["axisLabels"] = np.array(labels, "S1")
        mesh.attrs["dataOrder"] = np.bytes_(order)
        step = {"x": 1.5, "y": 2.0, "z": 3.0}
        mesh.attrs["gridSpacing"] = [step[name] for name in labels]
        mesh.attrs["gridGlobalOffset"] = [10 * step[name] for name in labels]
        mesh.attrs["gridUnitSI"] = 1.0 if order == "C" else 1e-3
        mesh["rho"] = m
        mesh["rho"].attrs["position"] = [0.5 if name == "x" else 0
                                         for name in labels]
for order, unit in (("C", 1), ("F", 1e-3)):
    oracle.expect(f"p.h5:/{order}/rho", m, oracle.affine(
        unit * np.array((1.5, 2, 3)), unit * np.array((15.75, 20, 30))),
                  unit="m")

# Components of one value; names and units of records.
with h5py.File("p.h5", "a") as file:
    for name, group in (("C/B/x", True), ("C/B/y", False)):
        file[name] = m if not group else h5py.Empty("f4")
        if group:
            del file[name]
            file.create_group(name).attrs.update(value=3., shape=m.shape)
        file[name].attrs.update(unitSI=0.5, position=[0., 0, 0])
    file["C/B"].attrs.update(file["C"].attrs)
    file["C/B"].attrs["unitDimension"] = [0., 1, -2, -1, 0, 0, 0]
oracle.expect("p.h5:/C/B/x", np.full(m.shape, 1.5), oracle.affine(
    (1.5, 2, 3), (15, 20, 30)), dtype=np.float64, unit="m")
oracle.tells("p.h5:/C/B/x", quantity="B x", value_unit="T")
oracle.tells("p.h5:/C/B/y", quantity="B y", value_unit="T")

# Texts that are not UTF-8, and cut ones, hold whole letters.
with h5py.File("l.h5", "w") as file:
    file["t"] = m
    file["t"].attrs.update(units=np.bytes_(b"\xb0C"), long_name="\u00b5" * 99)
found = oracle.told("l.h5")
told = found.get("value_unit"), {*found.get("long_name", "")}
if told != ("?C", {"\u00b5"}):
    oracle.fail("l.h5", f"told {told}")

# Modes around an axis: FBPIC's layout, that of z before r, femm's.
SIDE, LONG = 30, 25


def wave(x, y, z):
    """cos 2a and others, smooth at the axis, and vectors of them."""
    r2 = x * x + y * y
    fall = np.exp(-r2 / 300 - (z - 30)**2 / 900)
    return [(x * x - y * y) * fall, 2 * x * y * fall, x * fall, y * fall,
            (5 + r2 / 10) * fall]


def modes(path, labels=("r", "z"), order="C", kind="f8", position=(.5, 0.),
          sides=(SIDE, LONG), records=5, step=100):
    dr, dz = 0.5, 2.
    place = dict(zip("rz", position))
    r = ((np.arange(sides[0]) + place["r"]) * dr)[:, None]
    z = ((np.arange(sides[1]) + place["z"]) * dz + 7)[None]
    c2, _, c1, _, c0 = (r**0 * v for v in wave(r, 0 * r, z))
    none = 0 * c0
    # A vector with x = c0, y = 0: r = c0 cos a, t = -c0 sin a.
    fields = {"rho": [c0, c1, 2 * c1, 3 * c2, -c2], "B/r": [none, c0, none],
              "B/t": [none, none, -c0], "B/z": [c0, c1, none], "A/r": [c1]}
    with h5py.File(path, "w") as file:
        base = file.create_group(f"data/{step}")
        base.attrs.update(time=2. + step, timeUnitSI=0.5)
        for name in ("rho", "B/r", "B/t", "B/z", "A/r", "A/t", "A/z"):
            name, path = name, f"data/{step}/fields/{name}"
            whole = np.array((fields.get(name, [none]) + 5 * [none])[:records])
            flip = (labels[0] == "z") != (order == "F")
            if flip:
                whole = whole.transpose(0, 2, 1)
            if name == "A/t":
                file.create_group(path).attrs.update(value=0., shape=whole.shape)
            else:
                file[path] = whole.astype(kind)
            file[path].attrs["unitSI"] = 2.
            file[path].attrs["position"] = [place[c] for c in labels] + \
                [0.] * (records == 1)
            mesh = file[path] if name == "rho" else file[path].parent
            mesh.attrs.update(
                geometry=np.bytes_("thetaMode"), dataOrder=np.bytes_(order),
                geometryParameters=np.bytes_("m=1;imag=+"), gridUnitSI=1e-2,
                axisLabels=np.array(labels, "S1"), timeOffset=0.,
                gridSpacing=[{"r": dr, "z": dz}[c] for c in labels],
                gridGlobalOffset=[{"r": 0, "z": 7.}[c] for c in labels],
                unitDimension=[0., 1, -2, -1, 0, 0, 0])


def round_about(path, what, wanted, options=(), each=(1, 1), sides=(SIDE, LONG),
                position=.5):
    """Values are the formula's, but for 1 % of their range, and 0 outside."""
    voxels, matrix = oracle.voxels_of(f"{path}:{what}", options)
    if voxels is None:
        return
    n = int((2 * (sides[0] - 1 + position)) // each[0]) + 1
    shape = ((sides[1] - 1) // each[1] + 1, n, n)
    dr = 0.5e-2 * each[0]
    if voxels.shape != shape or not np.allclose(matrix, np.array((
            (dr, 0, 0, -dr * (n - 1) / 2), (0, dr, 0, -dr * (n - 1) / 2),
            (0, 0, 2e-2 * each[1], 7e-2)))):
        oracle.fail(what, f"{options}: shape {voxels.shape}, matrix {matrix}")
        return
    x, y, z = (100 * v for v in oracle.world(voxels, matrix))
    right = 2 * wanted(*wave(x, y, z))
    r = np.hypot(x, y)
    last = (sides[0] - 1 + position) * 0.5
    right[r > last + 1e-6] = 0
    near = np.abs(voxels - right)[r > 4 * 0.5].max() / np.ptp(right)
    whole = np.abs(voxels - right).max() / np.ptp(right)
    if near > 0.01 or whole > 0.03:
        oracle.fail(what, f"{options}: differs by {near:.2%}, {whole:.2%}")
    part, _ = oracle.voxels_of(f"{path}:{what}", [*options, "--crop", "9:21,3:,4:9"])
    if not np.array_equal(part, voxels[4:9, 3:, 9:21]):
        oracle.fail(what, "a box has other values than the whole")


density = lambda c2, s2, c1, s1, c0: c0 + c1 + 2 * s1 + 3 * c2 - s2
for way in (dict(), dict(labels=("z", "r")), dict(order="F"), dict(kind="f4"),
            dict(labels=("z", "r"), order="F"), dict(position=(0., 0.))):
    modes("r.h5", **way)
    at = way.get("position", (.5, 0))[0]
    round_about("r.h5", "/data/100/fields/rho", density, position=at)
    if "kind" in way:
        continue
    for component, part in (("x", lambda c2, s2, c1, s1, c0: c0),
                            ("z", lambda c2, s2, c1, s1, c0: c0 + c1)):
        round_about("r.h5", "/data/100/fields/B", part,
                    ["--component", component], position=at)
    nothing, _ = oracle.voxels_of("r.h5:/data/100/fields/B/y")
    if np.abs(nothing).max() > 1e-12:
        oracle.fail("B/y", "is not 0")
round_about("r.h5", "/data/100/fields/B/x", lambda c2, s2, c1, s1, c0: c0,
            position=0)
oracle.tells("r.h5:/data/100/fields/B", components=3, magnitude=True,
             quantity="B", value_unit="T", time_value=51., unit="m")
oracle.tells("r.h5:/data/100/fields/B", ["--component", "y"], quantity="B y")
modes("r.h5", records=1)
round_about("r.h5", "/data/100/fields/A/x",
            lambda c2, s2, c1, s1, c0: c1)
modes("r.h5", sides=(300, 4100), records=1, kind="f4")
wide = "note: 1 record of 300 x 4100 nodes on r and z is shown on x, y and z, " \
    "300 x 300 x 2050 of them: one in 2 along r and in 2 along z"
oracle.says("coarse", "r.h5:/data/100/fields/rho", wide,
            "--crop", "145:154,150:152,5:9")
voxels, matrix = oracle.voxels_of("r.h5:/data/100/fields/rho",
                                  ["--crop", "145:154,150:152,5:9"])
x, y, z = (100 * v for v in oracle.world(voxels, matrix))
if np.abs(voxels - 2 * wave(x, y, z)[4]).max() > 0.05:
    oracle.fail("coarse", "is not the field")
for step in (0, 50, 400):
    modes(f"step{step}.h5", step=step)
    oracle.tells("step%T.h5:/data/%T/fields/B", ["--time", "last"],
                 quantity="B", time_value=1. + step / 2)
with h5py.File("r.h5", "a") as file:
    del file["data/100/fields/B/t"]
    file["data/100/fields/rho"].attrs["axisLabels"] = np.array(["x", "z"], "S1")
oracle.refuse("r.h5:/data/100/fields/B/x", "lacks the component t")
oracle.refuse("r.h5:/data/100/fields/rho", "other axisLabels than r and z")

with h5py.File("r.h5", "w") as file:
    file.attrs["openPMD"] = "1.1.0"
    file["data/100/particles/e/position/x"] = np.zeros(9)
oracle.refuse("r.h5", "openPMD file without meshes")

# Image data of VTKHDF, at points and cells, one and several steps.
turn = np.array(((0, -1, 0), (1, 0, 0), (0, 0, 1.)))
with h5py.File("w.h5", "w") as file:
    root = file.create_group("VTKHDF")
    root.attrs["Type"] = np.bytes_("ImageData")
    root.attrs["WholeExtent"] = (2, 7, 0, 4, 0, 3)
    root.attrs["Origin"] = (10., 20, 30)
    root.attrs["Spacing"] = (0.5, 1, 2)
    root.attrs["Direction"] = turn.ravel()
    root["PointData/rho"] = m
    root["CellData/rho"] = m[1:, 1:, 1:]
    root["PointData/all"] = np.stack((m, 2 * m))
    root["Steps/Values"] = (0.25, 0.75)
    root["PointData/thin"] = oracle.sample("<f4", (2, 6, 5, 4))
    root["PointData/tensor"] = oracle.sample("<f4", (2, 4, 5, 6, 9))
    root["PointData/still"] = oracle.sample("<f4", (4, 5, 6, 3))
matrix = np.eye(4)
matrix[:3, :3] = turn * (0.5, 1, 2)
matrix[:3, 3] = (10, 21, 30)
for name, values, options in (
        ("rho", m, ()), ("all", 2 * m, ("--time", "0.6")),
        ("thin", oracle.sample("<f4", (2, 6, 5, 4))[1], ("--time", 1)),
        ("tensor", oracle.sample("<f4", (2, 4, 5, 6, 9))[1, ..., 8],
         ("--time", 1, "--component", 8)),
        ("still", oracle.sample("<f4", (4, 5, 6, 3))[..., 2],
         ("--component", 2))):
    oracle.expect(f"w.h5:/VTKHDF/PointData/{name}", values, matrix, options)
matrix[:3, 3] += matrix[:3, :3] @ (0.5, 0.5, 0.5)
oracle.expect("w.h5:/VTKHDF/CellData/rho", m[1:, 1:, 1:], matrix)

# Attributes that give a place.
with h5py.File("f.h5", "w") as file:
    for name, values in (("element_size_um", (2, 1, 0.5)),
                         ("resolution", (40, 4, 4.5)),
                         ("voxel_size", (3, 2, 1)), ("spacing", (1, 2, 4))):
        file[name] = a
        file[name].attrs[name] = values
    file["resolution"].attrs["offset"] = (100, 20, 3)
    file["zero"] = a
    file["zero"].attrs["spacing"] = (0, 1, 1)
    # fiji/HDF5_Vibez#10: of a picture two; others have one for each axis.
    file["plane"], file["steps"] = a[0], [a, a]
    file["plane"].attrs["element_size_um"] = (1, 0.5)
    file["steps"].attrs["element_size_um"] = (9, 2, 1, 0.5)
for name, place, unit in (
        ("element_size_um", oracle.affine((0.5, 1, 2)), "um"),
        ("resolution", oracle.affine((4.5, 4, 40), (3, 20, 100)), "nm"),
        ("voxel_size", oracle.affine((1, 2, 3)), ""),
        ("spacing", oracle.affine((4, 2, 1)), "")):
    oracle.expect(f"f.h5:/{name}", a, place, unit=unit)
oracle.expect("f.h5:/zero", a)
oracle.expect("f.h5:/plane", a[:1], oracle.affine((0.5, 1, 0.5)), unit="um")
oracle.expect("f.h5:/steps", a, oracle.affine((0.5, 1, 2)), unit="um")

# Dimension scales, packed and missing values.
packed = oracle.sample("<i2", (4, 5, 6))
packed[1, 2, 3] = packed[0, 0, 0] = -999
with h5py.File("g.h5", "w") as file:
    v = file.create_dataset("v", data=packed)
    v.attrs["scale_factor"] = 0.5
    v.attrs["add_offset"] = 10.0
    v.attrs["_FillValue"] = np.int16(-999)
    for i, (name, values) in enumerate((("z", np.arange(4) * 2.0),
                                        ("y", 9 - np.arange(5) * 0.5),
                                        ("x", np.arange(6) * 3.0 + 1))):
        s = file.create_dataset(name, data=values)
        s.attrs["units"] = np.bytes_("km" if name != "z" else "kilometers")
        s.make_scale(name)
        v.dims[i].attach_scale(s)
values = packed * 0.5 + 10
values[packed == -999] = np.nan
oracle.expect("g.h5", values, oracle.affine((3, -0.5, 2), (1, 9, 0)),
              dtype=np.float32, unit="km")

# More than eight attributes are in dense storage, one block of it or several;
# labels of axes name the coordinates.
a = oracle.sample("i2", (4, 5, 6))
for count, length in ((0, 9), (7, 9), (30, 9), (60, 300)):
    for first in (False, True):
        with h5py.File("p.h5", "w", libver="latest") as file:
            file["v"] = a
            texts = [(f"more{i}", "x" * length) for i in range(count)]
            says = [("_Unsigned", "true"), ("units", "K"), ("add_offset", 1.0)]
            for name, text in says + texts if first else texts + says:
                file["v"].attrs[name] = text
        oracle.expect("p.h5", a.view("u2") + 1.0, dtype="u2",
                      name=f"{count} attributes")
        oracle.tells("p.h5", value_unit="K")
with h5py.File("p.h5", "w") as file:
    file["g/v"] = a
    for axis, step in ((0, 2), (2, 3)):
        file["g/v"].dims[axis].label = "yx"[axis // 2]
        file["g"]["yx"[axis // 2]] = 7 + np.arange(a.shape[axis]) * step
        file["g"]["yx"[axis // 2]].attrs["units"] = "mm"
oracle.expect("p.h5", a, oracle.affine((3, 3, 2), (7, 0, 7)), unit="mm",
              name="labels")

# Axes of one entry, which ilastik and others add.
for shape in ((4, 5, 6, 1), (1, 4, 5, 6, 1), (4, 5, 6, 1, 1), (1, 1, 4, 5, 6),
              (1, 4, 1, 5, 6)):
    with h5py.File("o.h5", "w") as file:
        file["only"] = oracle.sample("u1", shape)
        file["names"] = np.zeros((3, 2))
    if shape != (1, 4, 1, 5, 6):
        oracle.expect("o.h5", oracle.sample("u1", shape).reshape(4, 5, 6),
                      name=f"{shape}")

# VTK's file says which of its arrays is active.
with h5py.File("v.h5", "w") as file:
    group = file.create_group("VTKHDF")
    group.attrs["Type"] = np.bytes_("ImageData")
    group.attrs["WholeExtent"] = [0, 5, 0, 4, 0, 3]
    group.attrs["Spacing"] = [1.0, 2, 3]
    for name in "abc":
        file[f"VTKHDF/PointData/{name}"] = oracle.sample("f4", (4, 5, 6),
                                                         ord(name))
    file["VTKHDF/PointData"].attrs["Scalars"] = np.bytes_("b")
oracle.expect("v.h5", oracle.sample("f4", (4, 5, 6), ord("b")),
              oracle.affine((1, 2, 3)), name="the active array")
oracle.says("the active array", "v.h5", "/VTKHDF/PointData/b is taken")
with h5py.File("v.h5", "a") as file:
    file["VTKHDF/PointData"].attrs["Scalars"] = np.bytes_("d")
oracle.refuse("v.h5", "holds 3 volumes", status=2)

# Imaris fills up chunks, and writes numbers as letters.
a = oracle.sample("u2", (4, 5, 16))
letters = lambda text: np.array([c.encode() for c in str(text)], "S1")
with h5py.File("i.ims", "w") as file:
    channel = file.create_group("DataSet/ResolutionLevel 0/TimePoint 0/Channel 0")
    channel["Data"] = np.pad(a, ((0, 4), (0, 3), (0, 0)))
    image = file.create_group("DataSetInfo/Image")
    image.attrs["Unit"] = letters("um")
    for n, size in enumerate((16, 5, 4)):
        channel.attrs["ImageSize" + "XYZ"[n]] = letters(size)
        image.attrs[f"ExtMin{n}"] = letters(10.5)
        image.attrs[f"ExtMax{n}"] = letters(10.5 + size * (n + 0.25))
oracle.expect("i.ims", a, oracle.affine((0.25, 1.25, 2.25),
                                        (10.625, 11.125, 11.625)), unit="um")

# Channels and times of microscopes are data sets of their own: of light, with names and
# colours; BigDataViewer stores 16 bits without a sign as if they had one.
a = oracle.sample("u2", (2, 3, 4, 6, 5))  # t, c, z, y, x
with h5py.File("c.ims", "w") as file, h5py.File("bdv.h5", "w") as viewer:
    for t, c in np.ndindex(2, 3):
        for level in range(2):
            group = file.create_group(f"DataSet/ResolutionLevel {level}/TimePoint {t}/"
                                      f"Channel {c}")
            group["Data"] = a[t, c, ::level + 1, ::level + 1]
            viewer[f"t{t:05d}/s{c:02d}/{level}/cells"] = \
                a[t, c, ::level + 1, ::level + 1].astype("i2")
    for c, (name, color) in enumerate((("DAPI", "0.000 0.000 1.000"),
                                       ("GFP", "0.000 1.000 0.000"),
                                       ("far red", "1.000 0.500 0.000"))):
        group = file.create_group(f"DataSetInfo/Channel {c}")
        group.attrs["Name"], group.attrs["Color"] = letters(name), letters(color)
for name in ("c.ims", "bdv.h5"):
    oracle.expect(name, a[0, 0])
    oracle.expect(name, a[1, 2], options=("--time", 1, "--channel", 2))
    oracle.refuse(name, "channel 3 does not exist", ("--channel", 3), 2)
    oracle.checked += 1
    said = oracle.tool("render", name, "-o", "light.png", "-y", "-s", "40").stderr
    if "mode mip" not in said or "channels 0" not in said:
        oracle.fail(f"{name} is not of light", said)
oracle.says("setups", "bdv.h5", "s00 to s02 are taken for channels")
oracle.checked += 1
said = [(c["name"], c["color"]) for c in oracle.told("c.ims")["channels"]]
if said != [("DAPI", [0, 0, 1]), ("GFP", [0, 1, 0]), ("far red", [1, 0.5, 0])]:
    oracle.fail("c.ims", said)

# Refused: other files' voxels, filters that are not there, cut files.
with h5py.File("h.h5", "w") as file:
    layout = h5py.VirtualLayout((20, 30, 40), "<f4")
    layout[:] = h5py.VirtualSource("b.h5", "only", (20, 30, 40))
    file.create_virtual_dataset("virtual", layout)
    file.create_dataset("outside", (2, 2, 2), "u1",
                        external=[("/etc/passwd", 0, 8)])
    file["link"] = h5py.ExternalLink("b.h5", "/only")
    file["text"] = np.full((2, 2, 2), b"abc")
    file["pairs"] = np.zeros((2, 2, 2), [("a", "i4"), ("b", "f4")])
    file["six"] = np.zeros((2,) * 6)
for name in ("virtual", "outside"):
    oracle.refuse(f"h.h5:/{name}", "in other files")
oracle.refuse("h.h5:/link", "no such data set", status=2)
for name in ("text", "pairs", "six"):
    oracle.refuse(f"h.h5:/{name}", "not a numeric array")
size = os.path.getsize("b.h5")
oracle.refuse_cut("b.h5", (20, 600, size // 2, size - 1),
                  "get or write it again")
with h5py.File("k.h5", "w") as file:
    file.create_dataset("only", data=a, compression="lzf")
with open("k.h5", "rb") as file:
    whole = file.read()
with open("k.h5", "wb") as file:
    file.write(whole.replace(struct.pack("<H", 32000),
                             struct.pack("<H", 32015), 1))
oracle.refuse("k.h5", "filter 32015 (Zstandard)")

# A chunk that unpacks to too few bytes: libhdf5 would copy what lies behind it.
# One that unpacks to more is cut, as some NetCDF files need it.
SHUFFLED = dict(compression="gzip", shuffle=True)
KINDS = [(dict(compression="gzip"), zlib.compress, 0),
         (dict(compression="gzip"), bytes, 1),
         (dict(compression="gzip"), lambda data: zlib.compress(data)[:-5], 0),
         (dict(shuffle=True), bytes, 0), (SHUFFLED, zlib.compress, 0),
         (SHUFFLED, zlib.compress, 1), (dict(fletcher32=True), bytes, 1),
         (dict(fletcher32=True), bytes, 0), ({}, bytes, 0),
         (dict(compression="lzf"), bytes, 0), (dict(scaleoffset=0), bytes, 0)]


def write_chunk(path, size, way, stored, mask):
    with h5py.File(path, "w") as file:
        made = file.create_dataset("only", (size,) * 3, "<i2",
                                   chunks=(size,) * 3, **way)
        made.id.write_direct_chunk((0, 0, 0), stored, filter_mask=mask)


# Without filters all chunks are taken for equally long: the file ends too soon.
for way, pack, mask in KINDS:
    for count in oracle.few((1, 2, 3, 5, 100, 200, 1000, 4096), 3, len(way)):
        write_chunk("l.h5", 16, way, pack(bytes(i % 31 for i in range(count))),
                    mask)
        if way or count < 4096:
            oracle.refuse("l.h5", "its chunk at 0,0,0" if way else "l.h5: ")
write_chunk("l.h5", 16, SHUFFLED, b"x" * 123, 0)  # h5py writes none of 0 bytes
with open("l.h5", "rb") as file:
    whole = file.read()
key = struct.pack("<II", 123, 0)  # of the chunk in its B-tree: size, mask
oracle.put("l.h5", whole.replace(key, bytes(8), 1))
oracle.refuse("l.h5", "its chunk at 0,0,0 has no bytes")
for way in (dict(compression="gzip"), SHUFFLED):
    long = np.concatenate([oracle.sample("<i2", (16,) * 3).ravel(),
                           np.arange(50, dtype="<i2")])
    stored = long.tobytes()
    if way is SHUFFLED:
        stored = long.view("u1").reshape(-1, 2).T.tobytes()
    write_chunk("m.h5", 16, way, zlib.compress(stored), 0)
    oracle.expect("m.h5", long[:4096].reshape((16,) * 3), name=f"more {way}")
with h5py.File("j.h5", "w") as file:
    file.create_dataset("huge", (10**6, 10**6, 10**5), "f8",
                        chunks=(8, 8, 8))
oracle.refuse("j.h5", "cannot hold")

path = oracle.data("formats/hdf5/example-femm-3d.h5")
if path:
    with h5py.File(path) as file:
        for name in "xyz":
            mesh = file["data/1/meshes/B"]
            dx, dy, dz = mesh.attrs["gridSpacing"]
            matrix = np.zeros((4, 4))
            matrix[2, 0], matrix[1, 1], matrix[0, 2] = dz, dy, dx
            matrix[:3, 3] = mesh.attrs["gridGlobalOffset"]
            matrix[3, 3] = 1
            oracle.expect(path, mesh[name][()], matrix,
                          ["--dataset", f"data/1/meshes/B/{name}"], unit="m")
path = oracle.data("formats/minc/small.mnc")
if path:
    oracle.refuse(path, "MINC")
oracle.finish()
