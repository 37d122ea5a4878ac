"""Grids with uneven coordinates, written by netCDF4, h5py and VTK: every voxel of
the even grid has the value of an analytic field at its place in the world or,
where it is the nearest to a line of the file, the value of that."""
import oracle
from oracle import np, affine

h5py, netCDF4, vtk = oracle.need("h5py", "netCDF4", "vtk")
from vtk.util.numpy_support import numpy_to_vtk
oracle.need_modules()


def field(x, y, z):
    """Linear, so that interpolation is exact."""
    return 2 * x - 3 * y + 0.5 * z + 1


def on_grid(x, y, z):
    return field(x[None, None, :], y[None, :, None], z[:, None, None])


X = np.cumsum(np.linspace(1, 3, 12))
Y = np.array([-4, -3.9, -3.5, -2, 0, 1, 1.5, 1.7, 2])
Z = np.array([0, 1, 3, 7, 15, 31.])


def netcdf(path, axes, kind="f4", form="NETCDF4", **how):
    """Coordinates by name, with their units; gives the variable on them."""
    file = netCDF4.Dataset(path, "w", format=form)
    for name, (at, unit) in axes.items():
        file.createDimension(name, len(at))
        v = file.createVariable(name, "f8", (name,))
        v[:] = at
        if unit:
            v.units = unit
    return file, file.createVariable("t", kind, tuple(axes), **how)


def nearest(at, lines):
    """Places along an axis; of the voxel nearest to a line that of the line."""
    nodes = np.unique(at.round(9))
    moved = dict(zip(nodes, nodes))
    for line in lines:
        node = nodes[np.abs(nodes - line).argmin()]
        if abs(node - line) <= np.diff(nodes).max(initial=0) * 0.501:
            moved[node] = line
    return np.vectorize(moved.get)(at.round(9))


def check(path, options=(), wanted=None, tolerance=2e-4, name=None,
          axes=(X, Y, Z)):
    """The voxels have the field's values where the matrix says they are."""
    name = name or path
    values, matrix = oracle.voxels_of(path, options)
    if values is None:
        return
    if wanted is not None and values.shape != wanted:
        oracle.fail(name, f"shape {values.shape}, not {wanted}")
    places = map(nearest, oracle.world(values, matrix), axes)
    error = np.abs(values - field(*places)).max()
    if not error < tolerance:
        oracle.fail(name, f"differs from the field by {error}")


for form in ("NETCDF3_CLASSIC", "NETCDF4"):
    for x, y, z in ((X, Y, Z), (X, Y[::-1], Z[::-1]),
                    (np.arange(12.), Y, Z)):
        file, v = netcdf("a.nc", {"z": (z, "m"), "y": (y, "m"), "x": (x, "m")},
                         form=form)
        with file:
            v[:] = on_grid(x, y, z)
        check("a.nc", wanted=(32, 61, 21 if x is X else 12), name=form,
              axes=(x, y, z))
        check("a.nc", ["--crop", "2:9,1:40,5:20"], (15, 39, 7), name=form,
              axes=(x, y, z))
steps = np.abs(np.diff(Z))
oracle.says("uneven levels, with their unit", "a.nc", "along z are not evenly spaced "
            f"(steps of {steps.min():g} to {steps.max():g} m); their {Z.size} voxels")
oracle.says("all lengths have it", "a.nc", " m apart, each at the nearest, at most ")


def levels(path, at, values, kind="f4", name="depth", **says):
    """A file with values along one axis."""
    with netCDF4.Dataset(path, "w") as file:
        for axis, places in (("x", np.arange(4.)), ("y", np.arange(5.)),
                             (name, at)):
            file.createDimension(axis, len(places))
            file.createVariable(axis, "f8", (axis,))[:] = places
        v = file.createVariable("v", kind, (name, "y", "x"),
                                fill_value=says.pop("_FillValue", None))
        v.setncatts(says)
        v.set_auto_scale(False)
        v[:] = values


# An ocean's levels are too many for the smallest step: peaks stay, and a box has
# the values of the whole.
OCEAN = np.concatenate([np.arange(0, 13, 2), np.arange(15, 51, 5),
                        np.arange(60, 101, 10), [125, 150, 200, 300, 500, 1000, 3000, 5000.]])
for turn in (1, -1):
    a = oracle.sample("f4", (1, 5, 4)) * np.exp(-OCEAN / 9)[:, None, None].astype("f4")
    a[2, 1, 1], a[9, 2, 2] = 999, -999
    levels("o.nc", OCEAN[::turn], a[::turn])
    oracle.says("an ocean", "o.nc", "fall together")
    oracle.says("without units", "o.nc", "(steps of 2 to 2000); their")
    values, matrix = oracle.voxels_of("o.nc")
    if (values.min(), values.max()) != (-999, 999) or len(values) != 8 * len(OCEAN):
        oracle.fail("an ocean", f"{values.shape} {values.min()} {values.max()}")
    for first in (0, 3, 218):
        part, _ = oracle.voxels_of("o.nc", ["--crop", f":,:,{first}:{first + 5}"])
        if not np.array_equal(part, values[first:first + 5]):
            oracle.fail("an ocean", f"the box from {first} differs")
for at, kind, says, wanted in (
        ([0, 10, 20, 30, 50, 75, 100, 125, 150, 200.], "i1", {"_FillValue": -100}, {1, 58}),
        ([0, 1, 3, 6, 10.], "f4", {"flag_values": [1., 58.]}, {1, 58}),
        ([0, 2, 4, 6, 8, 10, 500.], "u2", {}, {1, 58})):
    levels("o.nc", at, np.where(np.arange(len(at)) < 4, 1, 58)[:, None, None],
           kind, **says)
    values, _ = oracle.voxels_of("o.nc")
    if set(np.unique(values)) != wanted:
        oracle.fail("codes", f"{kind} {says} {np.unique(values)}")
levels("o.nc", [0, 1, 3.], np.array([0, 4, 8])[:, None, None], "i2",
       scale_factor=0.5)
oracle.tells("o.nc", sum=180.0)  # 0, 2, 3 and 4 in twenty columns

# Gaussian latitudes and longitudes of float32 are even, other steps are not.
for at, even in ((np.degrees(np.arcsin(np.polynomial.legendre.leggauss(64)[0])), True),
                 ((np.arange(3600) * 0.001 + 356).astype("f4"), True),
                 (np.arange(40) + 0.001 * np.arange(40) ** 2, False)):
    levels("o.nc", at, np.arange(len(at))[:, None, None], name="lat")
    values, matrix = oracle.voxels_of("o.nc")
    fitted = np.polyfit(np.arange(len(at)), at, 1)
    if even and (len(values) != len(at) or
                 not np.allclose(matrix[2, 2:], fitted, rtol=1e-9)) or \
            not even and len(values) == len(at):
        oracle.fail("nearly even", f"{at[:3]} {values.shape} {matrix[2]}")
    oracle.says("nearly even", "o.nc",
                "depart from even ones" if even else "not evenly spaced")

# Packed integers with missing values, which end half-way to their neighbours.
file, v = netcdf("a.nc", {"z": (Z, ""), "y": (Y, ""), "x": (X, "")}, "i2",
                 fill_value=-999)
with file:
    v.scale_factor, v.add_offset = 0.01, 5
    a = on_grid(X, Y, Z)
    v[:] = np.ma.masked_where(np.indices(a.shape)[0] == 2, a)
values, matrix = oracle.voxels_of("a.nc")
at = oracle.world(values, matrix)
missing = np.isnan(values)
if set(np.unique(at[2][missing])) != {2, 3, 4}:
    oracle.fail("missing", f"levels {np.unique(at[2][missing])}")
whole = ~missing & ((at[2] <= 1) | (at[2] >= 7))
at = [*map(nearest, at, (X, Y, Z))]
if np.abs(values - field(*at))[whole].max() > 0.0051:
    oracle.fail("packed", "differs from the field")

# Integers of 64 bits; an axis in another unit has the height of its levels.
with h5py.File("a.h5", "w") as file:
    scale = file.create_dataset("lev", data=Z)
    scale.make_scale("lev")
    v = file.create_dataset("rho", data=(on_grid(X, Y, Z) * 1000).astype("i8"))
    v.dims[0].attach_scale(scale)
values, matrix = oracle.voxels_of("a.h5")
if values.dtype != np.float64 or values.shape != (32, 9, 12):
    oracle.fail("int64", f"{values.dtype} {values.shape}")
file, v = netcdf("a.nc", {
    "lev": (np.array([1000, 900, 700, 400, 100, 1.]), "hPa"),
    "lat": (np.arange(8) * 2. - 8, "degrees_north"),
    "lon": (np.arange(10) * 2., "degrees_east")})
with file:
    v[:] = 0
values, matrix = oracle.voxels_of("a.nc")
if values.shape != (12, 8, 10) or not np.allclose(
        matrix, affine((2, 2, 999 / 11), (0, -8, -1000))[:3]):
    oracle.fail("units", f"{values.shape} {matrix}")


def rectilinear(cells):
    grid = vtk.vtkRectilinearGrid()
    grid.SetDimensions(len(X), len(Y), len(Z))
    grid.SetXCoordinates(numpy_to_vtk(X, deep=1))
    grid.SetYCoordinates(numpy_to_vtk(Y, deep=1))
    grid.SetZCoordinates(numpy_to_vtk(Z, deep=1))
    axes = [(at[1:] + at[:-1]) / 2 if cells else at for at in (X, Y, Z)]
    values = numpy_to_vtk(on_grid(*axes).astype("f4").ravel(), deep=1)
    values.SetName("rho")
    (grid.GetCellData() if cells else grid.GetPointData()).SetScalars(values)
    return grid


for cells in (False, True):
    axes = [(at[1:] + at[:-1]) / 2 if cells else at for at in (X, Y, Z)]
    for mode in ("Ascii", "Binary", "Appended"):
        for packed in oracle.few((False, True), 2, len(mode) + cells):
            writer = vtk.vtkXMLRectilinearGridWriter()
            writer.SetFileName("a.vtr")
            writer.SetInputData(rectilinear(cells))
            getattr(writer, "SetDataModeTo" + mode)()
            if not packed:
                writer.SetCompressorTypeToNone()
            writer.SetEncodeAppendedData(not packed)
            assert writer.Write()
            check("a.vtr", name=f"{mode} packed {packed} cells {cells}", axes=axes)
            check("a.vtr", ["--crop", "2:9,1:8,5:12"], (7, 7, 7), axes=axes)
    for kind in ("ASCII", "Binary"):
        writer = vtk.vtkRectilinearGridWriter()
        writer.SetFileName("a.vtk")
        writer.SetInputData(rectilinear(cells))
        getattr(writer, "SetFileTypeTo" + kind)()
        assert writer.Write()
        check("a.vtk", name=f"legacy {kind} cells {cells}", axes=axes)
check(oracle.packed("a.vtr", "b.vtr.gz"), axes=axes)
oracle.refuse(oracle.put("b.vtk", oracle.got("a.vtk").replace(
    b"Y_COORDINATES 9", b"Y_COORDINATES 8")), "not valid in this place")
oracle.finish()
