"""Grids with uneven coordinates, written by netCDF4, h5py and VTK: every voxel of
the even grid has the value of an analytic field at its place in the world."""
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
Y = np.array([-4, -3.9, -3.5, -2, 0, 1, 1.5, 1.75, 2])
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


def check(path, options=(), wanted=None, tolerance=2e-4, name=None):
    """The voxels have the field's values where the matrix says they are."""
    name = name or path
    values, matrix = oracle.voxels_of(path, options)
    if values is None:
        return
    if wanted is not None and values.shape != wanted:
        oracle.fail(name, f"shape {values.shape}, not {wanted}")
    error = np.abs(values - field(*oracle.world(values, matrix))).max()
    if not error < tolerance:
        oracle.fail(name, f"differs from the field by {error}")


for form in ("NETCDF3_CLASSIC", "NETCDF4"):
    for x, y, z in ((X, Y, Z), (X, Y[::-1], Z[::-1]),
                    (np.arange(12.), Y, Z)):
        file, v = netcdf("a.nc", {"z": (z, "m"), "y": (y, "m"), "x": (x, "m")},
                         form=form)
        with file:
            v[:] = on_grid(x, y, z)
        check("a.nc", wanted=(32, 61, 21 if x is X else 12), name=form)
        check("a.nc", ["--crop", "2:9,1:40,5:20"], (15, 39, 7), name=form)
oracle.says("uneven levels", "a.nc", "are not evenly spaced")

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
        matrix, affine((2, 2, 10 / 11), (0, -8, 0))[:3]):
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
            check("a.vtr", name=f"{mode} packed {packed} cells {cells}")
            check("a.vtr", ["--crop", "2:9,1:8,5:12"], (7, 7, 7))
    for kind in ("ASCII", "Binary"):
        writer = vtk.vtkRectilinearGridWriter()
        writer.SetFileName("a.vtk")
        writer.SetInputData(rectilinear(cells))
        getattr(writer, "SetFileTypeTo" + kind)()
        assert writer.Write()
        check("a.vtk", name=f"legacy {kind} cells {cells}")
check(oracle.packed("a.vtr", "b.vtr.gz"))
oracle.refuse(oracle.put("b.vtk", oracle.got("a.vtk").replace(
    b"Y_COORDINATES 9", b"Y_COORDINATES 8")), "not valid in this place")
oracle.finish()
