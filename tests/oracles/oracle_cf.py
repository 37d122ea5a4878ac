"""One data set in NetCDF-3, NetCDF-4, HDF5 and Zarr 2 and 3: its values are those
that netCDF4 reads, and all five have one place and one picture."""
import base64
import json
import os
import struct

import oracle
from oracle import np

h5py, netCDF4, zarr = oracle.need("h5py", "netCDF4", "zarr")
oracle.need_modules()
ZYX = ("lev", "lat", "lon")
PLACES = {"lev": (np.arange(5) * 2.0, {"units": "degrees"}),
          "lat": (9 - np.arange(6) * 0.5, {"units": "degrees_north"}),
          "lon": (np.array([350., 355, 0, 5, 10, 15, 20]),
                  {"units": "degrees_east"})}
MATRIX = oracle.affine((5, -0.5, 2), (350, 9, 0))


def plain(value):
    """As JSON has it."""
    return value.tolist() if isinstance(value, (np.ndarray, np.generic)) else value


def netcdf(form):
    def write(path, arrays, fill=False):
        with netCDF4.Dataset(path, "w", format=form) as file:
            for name, (values, axes, attributes) in arrays.items():
                for axis, size in zip(axes, values.shape):
                    if axis not in file.dimensions:
                        file.createDimension(axis, size)
                own = dict(attributes)
                v = file.createVariable(name, values.dtype, axes,
                                        fill_value=own.pop("_FillValue", fill))
                v.set_auto_maskandscale(False)
                v.setncatts(own)
                v[:] = values
    return write


def hdf5(path, arrays):
    with h5py.File(path, "w") as file:
        for name, (values, axes, attributes) in arrays.items():
            file[name] = values
            file[name].attrs.update(attributes)
            if axes == (name,):
                file[name].make_scale(name)
        for name, (_, axes, _) in arrays.items():
            for n, axis in enumerate(axes if len(axes) > 1 else ()):
                if axis in file:
                    file[name].dims[n].attach_scale(file[axis])


def zarr_2(path, arrays, fill=None):
    oracle.empty_folder(path)
    group = zarr.open_group(path, "w")
    for name, (values, axes, attributes) in arrays.items():
        a = group.create_dataset(name, data=values, chunks=values.shape,
                                 compressor=None, fill_value=fill)
        if axes:
            a.attrs["_ARRAY_DIMENSIONS"] = list(axes)
        a.attrs.update({key: plain(v) for key, v in attributes.items()})


def zarr_3(path, arrays, fill=0):
    oracle.empty_folder(path)
    oracle.put(f"{path}/zarr.json",
               '{"zarr_format": 3, "node_type": "group"}')
    for name, (values, axes, attributes) in arrays.items():
        file = f"{path}/{name}/c/" + "/".join("0" * values.ndim)
        os.makedirs(os.path.dirname(file))
        oracle.put(file, values.tobytes())
        oracle.put(f"{path}/{name}/zarr.json", json.dumps(dict(
            zarr_format=3, node_type="array", shape=values.shape,
            data_type=values.dtype.name, fill_value=fill, dimension_names=axes,
            attributes={key: plain(v) for key, v in attributes.items()},
            chunk_grid=dict(name="regular",
                            configuration=dict(chunk_shape=values.shape)),
            chunk_key_encoding=dict(name="default"),
            codecs=[dict(name="bytes", configuration=dict(endian="little"))])))


FORMS = {"a3.nc": netcdf("NETCDF3_CLASSIC"), "a4.nc": netcdf("NETCDF4"),
         "a.h5": hdf5, "a2.zarr": zarr_2, "a3.zarr": zarr_3}


def read(path, name="v"):
    with netCDF4.Dataset(path) as file:
        return np.ma.filled(file[name][:].astype("f8"), np.nan)


def arrays(values, attributes, places=True):
    own = {axis: (at, (axis,), says) for axis, (at, says) in PLACES.items()}
    return {**(own if places else {}), "v": (values, ZYX, attributes)}


short = (np.arange(210) * 300 - 30000).astype("i2").reshape(5, 6, 7)
single = oracle.sample("f4", (5, 6, 7))
whole = short.astype("i4")
short.ravel()[[3, 5, 8, 20]] = -999, -998, -997, -32767
single.ravel()[[3, 5]] = 1e20, -999.9
i2, f4 = np.int16, np.float32
CASES = [
    ("packed", short, {"_FillValue": i2(-999), "scale_factor": 0.01,
                       "add_offset": 273.15}),
    ("several", short, {"_FillValue": i2(-999), "units": "K",
                        "missing_value": np.array([-998, -997], "i2")}),
    ("unsigned", short, {"_Unsigned": "true", "_FillValue": i2(-999),
                         "valid_range": np.array([0, -100], "i2"),
                         "scale_factor": f4(0.5)}),
    ("limits", short, {"valid_min": i2(-20000), "valid_max": i2(20000),
                       "scale_factor": -2.0, "_FillValue": i2(-32767)}),
    ("doubles", single, {"missing_value": -999.9, "_FillValue": f4(1e20),
                         "valid_max": 50.0}),
    ("integers", whole, {"missing_value": np.int32(-999), "add_offset": 1.0}),
    ("NaN", single, {"_FillValue": f4(np.nan), "standard_name": "speed"})]
for number, (name, values, attributes) in enumerate(oracle.few(CASES, 2)):
    pictures = []
    for path, write in FORMS.items():
        write(path, arrays(values, attributes))
        right = read("a4.nc") if path != "a3.nc" else read(path)
        if name == "doubles":  # netCDF4 takes no double for a float's value
            right[values == f4(-999.9)] = np.nan
        kind = "f8" if name == "integers" else "f4"
        oracle.expect(path, right, MATRIX, ["--dataset", "v"], kind, "degrees",
                      f"{name} {path}")
        if number < 2:
            oracle.tool("render", path, "--dataset", "v", "-s", "60x60", "-y",
                        "-q", "-o", "a.png", check=True)
            pictures.append(oracle.got("a.png"))
    if len(set(pictures)) > 1:
        oracle.fail(name, "the formats have different pictures")

# What a type cannot hold is ignored, with a note; 64 bits are compared as such.
for path, write in FORMS.items():
    write(path, arrays(short, {"missing_value": 1e20, "scale_factor": 2.0}))
    oracle.says(path, path, "missing_value is ignored", "--dataset", "v")
    oracle.expect(path, np.where(short == -32767, np.nan, short * 2.0)
                  if path.endswith("3.nc") else short * 2.0, MATRIX,
                  ["--dataset", "v"], "f4" if path == "a3.nc" else "i2",
                  name=f"{path} too large")
    if path == "a3.nc":
        continue
    long = whole.astype("i8") + 2**62
    write(path, arrays(long, {"_FillValue": long[2, 2, 2],
                              "add_offset": -2.0**62}))
    right = np.where(long == long[2, 2, 2], np.nan,
                     long.astype("f8") - 2.0**62)
    oracle.expect(path, right, MATRIX, ["--dataset", "v"], "f8",
                  name=f"{path} 64 bits")

zarr_2("b.zarr", {"v": (short, ZYX, {"valid_min": 32767, "add_offset": 1.0})})
oracle.says("all missing", "b.zarr", "all voxels are missing")
oracle.says("a box", "b.zarr", None, "--crop", "0:2,:,:")

# NetCDF's own fill value, where its library has set it: not of bytes, not if the
# variable is not filled, not in HDF5 and Zarr.  Integers without it stay so.
for kind, fill in netCDF4.default_fillvals.items():
    if kind not in ("S1", "c") and (kind != "i8" or not oracle.SHORT):
        a = oracle.sample(kind, (5, 6, 7)).clip(0, 100)
        blank = np.array(fill).astype(kind)
        for at in (None, (2, 3, 4)):
            if at:
                a[at] = blank
            for path in ("a3.nc", "a4.nc"):
                if path == "a3.nc" and kind not in ("i1", "i2", "i4", "f4",
                                                    "f8"):
                    continue
                FORMS[path](path, arrays(a, {}, False), None)
                lost = at and kind[1] != "1"
                right = np.where(a == blank, np.nan, a) if lost else a
                wide = {"2": "f4", "4": "f8", "8": "f8"}.get(kind[1])
                oracle.expect(path, right, None, (),
                              wide if lost and kind[0] != "f" else kind,
                              name=f"{path} {kind} {at}")
a = np.where(short > 0, -32767, short).astype("i2")
for path, write in FORMS.items():
    if path != "a3.nc":
        write(path, arrays(a, {}, False))
        oracle.expect(path, a, name=f"{path} is not filled")

# Zarr 2's fill value: of xarray's arrays, not 0 of integers, not of plain ones.
for values, axes, fill, lost in ((short, ZYX, -999, True),
                                 (short, (), -999, False),
                                 (np.abs(short) % 9, ZYX, 0, False),
                                 (single, ZYX, 0.0, False),
                                 (single, ZYX, float(single[1, 2, 3]), True)):
    zarr_2("b.zarr", {"v": (values, axes, {})}, fill)
    right = np.where(values == values.dtype.type(fill), np.nan, values)
    oracle.expect("b.zarr", right if lost else values, None, (),
                  "f4" if lost else values.dtype, name=f"fill value {fill}")
zarr_3("b.zarr", {"v": (short, ZYX, {})}, -999)
oracle.expect("b.zarr", short, name="fill value of Zarr 3")
text = base64.b64encode(struct.pack("<d", 1e20)).decode() # by xarray
zarr_3("b.zarr", {"v": (single, ZYX, {"_FillValue": text})})
oracle.expect("b.zarr", np.where(single == f4(1e20), np.nan, single),
              dtype="f4", name="base64")
# Python writes numbers that JSON lacks.
zarr_2("b.zarr", {"v": (short, ZYX, {"missing_value": np.array(np.nan),
                                     "scale_factor": 0.5})})
oracle.expect("b.zarr", short * 0.5, None, (), "i2", name="NaN in JSON")

# Coordinates may be packed; time has a calendar, and any axis may be uneven.
PLACES["lat"] = (np.arange(6).astype("i2"),
                 {"scale_factor": -0.5, "add_offset": 9.0, "units": "degrees"})
for path, write in FORMS.items():
    write(path, arrays(single, {}))
    oracle.expect(path, np.where(np.isnan(single), 0, single), MATRIX,
                  ["--dataset", "v"], "f4", name=f"{path} packed coordinates")
    write(path, {**arrays(single, {}), "v": (np.stack([single, short.astype("f4")]),
                                             ("time", *ZYX), {}),
                 "time": (np.array([0, 36]).astype("i4"), ("time",),
                          {"units": "hours since 2000-01-01",
                           "calendar": "noleap", "standard_name": "time"})})
    oracle.expect(path, short.astype("f4"), MATRIX,
                  ["--dataset", "v", "--time", 1], name=f"{path} time")
    oracle.tells(path, ["--dataset", "v", "--time", 1], time_value=36,
                 time_unit="hours since 2000-01-01", calendar="noleap")
oracle.finish()
