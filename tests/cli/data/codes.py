"""codes.py TOOL PAGE: runs each command of the first table of a page about simulations
in the working folder, on a file laid out as the code of its row lays it out.  What the
tool tells of the input must be what was written; a row without a file, and a file
without a row, are failures.  Run by cli_codes.sh."""
import json
import os
import re
import shlex
import subprocess
import sys

import h5py
import netCDF4
import numpy as np
import zarr

TOOL, PAGE = sys.argv[1:3]
NX, NY, NZ = 12, 10, 8


def hill(nz=NZ, ny=NY, nx=NX, low=0., high=1.):
    """A hill on [low, high]^3, between 0 and 1, x last."""
    z, y, x = np.meshgrid(*(low + (np.arange(n) + .5) / n * (high - low)
                            for n in (nz, ny, nx)), indexing="ij")
    return np.exp(-((x - .5) ** 2 + (y - .4) ** 2 + (z - .6) ** 2) / .05)


FIELD = hill()


def span(a, dims=None):
    """What `info` must tell: sizes along x, y, z, the least and the most."""
    return list(dims or a.shape[::-1]), float(np.nanmin(a)), float(np.nanmax(a))


def text(path, *lines):
    os.makedirs(os.path.dirname(path) or ".", exist_ok=True)
    with open(path, "w") as file:
        file.write("\n".join(lines) + "\n")


# --- levels ---


def amrex():
    """Two levels, the finer one in the middle, of two components."""
    coarse, fine = hill(16, 16, 16), hill(16, 16, 16, .25, .75)
    text("plt00000/Header", "HyperCLaw-V1.1", "2", "density", "Temp", "3", "0.5", "1",
         "0 0 0", "1 1 1", "2", "((0,0,0) (15,15,15) (0,0,0)) ((0,0,0) (31,31,31) (0,0,0))",
         "0 0", "0.0625 0.0625 0.0625", "0.03125 0.03125 0.03125", "0", "0",
         *(line for level, ends in ((0, "0 1"), (1, "0.25 0.75"))
           for line in (f"{level} 1 0.5", "0", *[ends] * 3, f"Level_{level}/Cell")))
    for level, a in enumerate((coarse, fine)):
        box = f"(({level * 8},{level * 8},{level * 8}) ({15 + level * 8}," \
              f"{15 + level * 8},{15 + level * 8}) (0,0,0))"
        both = np.stack([a, a + 300])
        text(f"plt00000/Level_{level}/Cell_H", "1", "1", "2", "0", "(1 0", box, ")", "1",
             "FabOnDisk: Cell_D_00000 0", "",
             *(line for ends in (both.min((1, 2, 3)), both.max((1, 2, 3)))
               for line in ("1,2", "".join("%.17e," % end for end in ends), "")))
        with open(f"plt00000/Level_{level}/Cell_D_00000", "wb") as file:
            file.write(f"FAB ((8, (64 11 52 0 1 12 0 1023)),(8, (8 7 6 5 4 3 2 1))){box} 2\n"
                       .encode() + both.astype("<f8").tobytes())
    outside = coarse.copy()
    outside[4:12, 4:12, 4:12] = np.nan
    return [32] * 3, float(min(fine.min(), np.nanmin(outside))), float(fine.max())


def places(n):
    """Of n^3 blocks, x fastest."""
    return np.array([at[::-1] for at in np.ndindex(n, n, n)])


def blocks():
    return np.stack([np.exp(-(sum((c - m) ** 2 for c, m in zip(np.meshgrid(*(
        (p[i] + (np.arange(8) + .5) / 8) / 2 for i in (2, 1, 0)), indexing="ij"),
        (.6, .4, .5)))) / .05) for p in places(2)])


def flash():
    """A parent and its eight leaves."""
    leaves, ends = blocks(), np.stack([places(2), places(2) + 1], -1) / 2
    with h5py.File("run_hdf5_plt_cnt_0000", "w") as f:
        f["dens"] = np.concatenate([np.full((1, 8, 8, 8), 9.), leaves])
        f["bounding box"] = np.concatenate([[[[0, 1]] * 3], ends])
        f["refine level"] = np.array([1] + [2] * 8, "i4")
        f["node type"] = np.array([2] + [1] * 8, "i4")
        f["unknown names"] = np.array([[b"dens"]])
    return span(leaves, (16, 16, 16))


def athena():
    with h5py.File("blast.prim.00000.athdf", "w") as f:
        f.attrs.update(NumMeshBlocks=8, MeshBlockSize=[8] * 3, RootGridSize=[16] * 3,
                       Time=.1, Coordinates=np.bytes_("cartesian"), NumVariables=[2],
                       DatasetNames=np.array(["prim"], "S5"), MaxLevel=0,
                       VariableNames=np.array(["rho", "press"], "S5"))
        f["prim"] = np.stack([blocks(), 2 * blocks()]).astype("f4")
        f["LogicalLocations"], f["Levels"] = places(2), np.zeros(8, "i4")
        for i in range(3):
            f[f"x{i + 1}f"] = np.stack([np.linspace(p, p + .5, 9)
                                        for p in places(2)[:, i] / 2]).astype("f4")
    return span(2 * blocks().astype("f4"), (16, 16, 16))


def vtkhdf():
    coarse, fine = hill(), hill(2 * NZ, 2 * NY, 2 * NX)[4:12, 4:12, 4:12]
    with h5py.File("amr.vtkhdf", "w") as f:
        g = f.create_group("VTKHDF")
        g.attrs.update(Version=[2, 0], Type=np.bytes_("OverlappingAMR"),
                       GridDescription=np.bytes_("XYZ"), Origin=[0., 0, 0])
        for level, (a, box) in enumerate((
                (coarse, [0, NX - 1, 0, NY - 1, 0, NZ - 1]), (fine, [4, 11] * 3))):
            one = g.create_group(f"Level{level}")
            one.attrs["Spacing"] = [.1 / (level + 1)] * 3
            one["AMRBox"], one["CellData/rho"] = np.array([box], "i4"), a.ravel()
    coarse = coarse.copy()
    coarse[2:6, 2:6, 2:6] = np.nan
    return ([2 * NX, 2 * NY, 2 * NZ], float(min(np.nanmin(coarse), fine.min())),
            float(max(np.nanmax(coarse), fine.max())))


# --- air and sea ---


def netcdf(path, axes, name, a, more=(), **attributes):
    """Variables of one dimension for the axes (name, values, unit), one for the field,
    and `more` of two dimensions."""
    with netCDF4.Dataset(path, "w") as f:
        for axis, values, unit in axes:
            f.createDimension(axis, len(values))
            if unit:
                v = f.createVariable(axis, "f8", (axis,))
                v[:], v.units = values, unit
        for two, values in more:
            f.createVariable(two, "f8", [axis for axis, *_ in axes[-2:]])[:] = values
        kind = "i2" if "scale_factor" in attributes else "f4"
        v = f.createVariable(name, kind, [axis for axis, *_ in axes], fill_value=(
            -30000 if kind == "i2" else None))
        v.setncatts(attributes)
        v[:] = a
    return a


LAT, LON = 40 - np.arange(NY) * .25, 5 + np.arange(NX) * .25
TWO = np.meshgrid(LON, LAT)
HPA = [200, 300, 400, 500, 600, 700, 800, 900]
DAYS = "days since 2020-01-01"


def wrf():
    with netCDF4.Dataset("wrfout_d01_2005-08-28_00:00:00", "w") as f:
        for name, size in (("Time", 1), ("DateStrLen", 19), ("west_east", NX),
                           ("south_north", NY), ("bottom_top", NZ)):
            f.createDimension(name, size)
        f.setncatts({"TITLE": " OUTPUT FROM WRF V4.1 MODEL", "DX": 3000., "DY": 3000.})
        times = f.createVariable("Times", "S1", ("Time", "DateStrLen"))
        times[0] = np.array(list("2005-08-28_00:00:00"), "S1")
        for name, a in zip(("XLONG", "XLAT"), TWO):
            f.createVariable(name, "f4", ("Time", "south_north", "west_east"))[0] = a
        v = f.createVariable("QVAPOR", "f4",
                             ("Time", "bottom_top", "south_north", "west_east"))
        v.setncatts({"MemoryOrder": "XYZ", "units": "kg kg-1", "stagger": "",
                     "coordinates": "XLONG XLAT XTIME"})
        v[0] = FIELD
    return span(FIELD.astype("f4"))


def era5():
    netcdf("era5.nc", (("valid_time", [0, 6], "hours since 2020-01-01"),
                       ("pressure_level", HPA, "hPa"), ("latitude", LAT, "degrees_north"),
                       ("longitude", LON, "degrees_east")), "t",
           np.stack([FIELD, FIELD + 1]) + 250, units="K", standard_name="air_temperature")
    return span((FIELD + 251).astype("f4"))


def era5_zarr():
    group = zarr.open_group("era5.zarr", "w")
    for name, values, unit in (("time", [0, 6], "hours since 2020-01-01"),
                               ("level", HPA, "hPa"), ("latitude", LAT, "degrees_north"),
                               ("longitude", LON, "degrees_east")):
        group[name] = np.array(values, "f8")
        group[name].attrs.update(_ARRAY_DIMENSIONS=[name], units=unit)
    for n, name in enumerate(("u", "temperature")):
        a = np.stack([FIELD, FIELD + 1]).astype("f4") + 250 * n
        v = group.create_dataset(name, data=a, chunks=(1, NZ, NY, NX))
        v.attrs.update(_ARRAY_DIMENSIONS=["time", "level", "latitude", "longitude"])
    zarr.consolidate_metadata("era5.zarr")
    return span(FIELD.astype("f4") + 250)


def nemo():
    axes = (("time_counter", [15], DAYS), ("deptht", np.arange(NZ) * 10. + 5, "m"),
            ("y", LAT, ""), ("x", LON, ""))
    netcdf("ORCA025_grid_T.nc", axes, "thetao", 20 * FIELD[None],
           zip(("nav_lon", "nav_lat"), TWO), units="degC",
           coordinates="time_counter deptht nav_lat nav_lon")
    return span((20 * FIELD).astype("f4"))


def roms():
    axes = (("ocean_time", [0], "seconds since 2020-01-01"),
            ("s_rho", -1 + (np.arange(NZ) + .5) / NZ, "1"), ("eta_rho", LAT, ""),
            ("xi_rho", LON, ""))
    netcdf("ocean_his_0001.nc", axes, "temp", 20 * FIELD[None],
           zip(("lon_rho", "lat_rho"), TWO), units="Celsius",
           coordinates="lon_rho lat_rho s_rho ocean_time")
    return span((20 * FIELD).astype("f4"))


def pop():
    axes = (("time", [15], DAYS), ("z_t", np.arange(NZ) * 1000. + 500, "centimeters"),
            ("nlat", LAT, ""), ("nlon", LON, ""))
    netcdf("pop.h.0001-01.nc", axes, "TEMP", 20 * FIELD[None],
           zip(("TLONG", "TLAT"), TWO), units="degC", coordinates="TLONG TLAT z_t time")
    return span((20 * FIELD).astype("f4"))


def hycom():
    """Packed, on even levels; land is missing."""
    sea = np.ma.masked_less(FIELD, .01)
    netcdf("hycom.nc", (("time", [0], "hours since 2000-01-01"),
                        ("depth", np.arange(NZ) * 10., "m"),
                        ("lat", LAT[::-1], "degrees_north"),
                        ("lon", LON, "degrees_east")), "water_u", sea[None],
           units="m/s", scale_factor=.001, add_offset=0.)
    return span(np.round(sea.filled(np.nan), 3))


# --- plasma ---


def openpmd(path, step, name, records, **attributes):
    os.makedirs(os.path.dirname(path) or ".", exist_ok=True)
    with h5py.File(path, "w") as f:
        f.attrs.update(openPMD=np.bytes_("1.1.0"), basePath=np.bytes_("/data/%T/"),
                       meshesPath=np.bytes_("fields/"))
        one = f.create_group(f"data/{step}")
        one.attrs.update(time=1e-14 * step, dt=1e-14, timeUnitSI=1.)
        for key, a in records.items():
            f[f"data/{step}/fields/{name}{key}"] = a
        about = f[f"data/{step}/fields/{name}"]
        about.attrs.update(gridUnitSI=1., dataOrder=np.bytes_("C"),
                           unitDimension=[1., 1, -3, -1, 0, 0, 0], timeOffset=0.,
                           **attributes)
        for key in records:
            f[f"data/{step}/fields/{name}{key}"].attrs.update(unitSI=1.)


def picongpu():
    for step in 0, 100:
        openpmd(f"simData_{step:06d}.h5", step, "E",
                {f"/{axis}": FIELD.astype("f4") * (n + 1)
                 for n, axis in enumerate("xyz")}, geometry=np.bytes_("cartesian"),
                axisLabels=np.array(["z", "y", "x"], "S1"), gridSpacing=[1e-7] * 3,
                gridGlobalOffset=[0.] * 3)
    return span(FIELD.astype("f4"))


def theta_mode():
    """Three records: of mode 0, of the cosine and the sine of mode 1."""
    r, z = np.arange(20)[:, None] + .5, np.arange(40)[None, :]
    one = np.exp(-(r / 6) ** 2 - ((z - 20) / 6) ** 2)
    openpmd("diags/hdf5/data00000100.h5", 100, "rho", {"": np.stack([one, 0 * one, 0 * one])},
            geometry=np.bytes_("thetaMode"), geometryParameters=np.bytes_("m=2;imag=+"),
            axisLabels=np.array(["r", "z"], "S1"), gridSpacing=[1e-6, 1e-6],
            gridGlobalOffset=[0., 0.], position=[.5, 0.])
    nearest = np.interp(np.hypot(.5, .5), r[:, 0], one[:, 20])
    return [40, 40, 40], 0., float(nearest)


# --- VTK, and others ---


def numbers(a):
    return " ".join(map("{:.9g}".format, a.ravel()))


def vti(path, a, first=0, kind="PointData"):
    """Points, or cells, `first` of them before the first one along x."""
    last = [side - (kind == "PointData") for side in a.shape[::-1]]
    extent = f"{first} {first + last[0]} 0 {last[1]} 0 {last[2]}"
    text(path, f'<VTKFile type="ImageData"><ImageData WholeExtent="{extent}" '
         f'Origin="0 0 0" Spacing="1 1 1"><Piece Extent="{extent}"><{kind}>',
         f'<DataArray type="Float32" Name="p" format="ascii">{numbers(a)}</DataArray>',
         f"</{kind}></Piece></ImageData></VTKFile>")


def pvd():
    for step in 0, 1:
        vti(f"run/run_{step}.vti", FIELD + step)
    text("run.pvd", '<VTKFile type="Collection"><Collection>', *(
        f'<DataSet timestep="{step / 2}" file="run/run_{step}.vti"/>' for step in (0, 1)),
        "</Collection></VTKFile>")
    return span((FIELD + 1).astype("f4"))


def vtm():
    vti("blocks/0.vti", FIELD[:, :, :6], 0, "CellData")
    vti("blocks/1.vti", FIELD[:, :, 6:], 6, "CellData")
    text("blocks.vtm", '<VTKFile type="vtkMultiBlockDataSet"><vtkMultiBlockDataSet>', *(
        f'<DataSet index="{n}" file="blocks/{n}.vti"/>' for n in (0, 1)),
        "</vtkMultiBlockDataSet></VTKFile>")
    return span(FIELD.astype("f4"))


def vth():
    vti("levels/0.vti", FIELD, 0, "CellData")
    text("levels.vth", '<VTKFile type="vtkOverlappingAMR" version="1.1">',
         '<vtkOverlappingAMR origin="0 0 0" grid_description="XYZ">',
         f'<Block level="0" spacing="1 1 1"><DataSet index="0" amr_box="0 {NX - 1} 0 '
         f'{NY - 1} 0 {NZ - 1}" file="levels/0.vti"/></Block>',
         "</vtkOverlappingAMR></VTKFile>")
    return span(FIELD.astype("f4"))


def openfoam():
    """What vtkResampleToImage makes of cells: values, and which points are valid."""
    mask = (FIELD > .001).astype("u1")
    sides = f"0 {NX - 1} 0 {NY - 1} 0 {NZ - 1}"
    text("openfoam.vti", f'<VTKFile type="ImageData"><ImageData WholeExtent="{sides}" '
         f'Origin="0 0 0" Spacing="1 1 1"><Piece Extent="{sides}"><PointData>',
         '<DataArray type="UInt8" Name="vtkValidPointMask" format="ascii">',
         numbers(mask), '</DataArray><DataArray type="Float32" Name="p" format="ascii">',
         numbers(FIELD), "</DataArray></PointData></Piece></ImageData></VTKFile>")
    return span(FIELD.astype("f4"))


def xdmf():
    item = '<DataItem Format="%s" Dimensions="%s">%s</DataItem>'
    with h5py.File("out.h5", "w") as f:
        f["rho"] = FIELD
    sides = f"{NZ} {NY} {NX}"
    text("out.xmf", "<Xdmf><Domain><Grid><Topology TopologyType=\"3DCoRectMesh\" "
         f'Dimensions="{sides}"/><Geometry GeometryType="ORIGIN_DXDYDZ">',
         item % ("XML", 3, "0 0 0") + item % ("XML", 3, "1 1 1"), "</Geometry>",
         '<Attribute Name="rho">' + item % ("HDF", sides, "out.h5:/rho"),
         "</Attribute></Grid></Domain></Xdmf>")
    return span(FIELD)


def own_hdf5():
    with h5py.File("run.h5", "w") as f:
        f["step_0000/rho"] = FIELD
    return span(FIELD)


def fortran():
    """A record of an unformatted file has its bytes before and behind it."""
    size = np.uint32(FIELD.nbytes).tobytes()
    with open("rho.dat", "wb") as file:
        file.write(size + FIELD.tobytes() + size)
    return span(FIELD)


def bov():
    FIELD.tofile("rho.raw")
    text("rho.bov", "TIME: 0.5", "DATA_FILE: rho.raw", f"DATA_SIZE: {NX} {NY} {NZ}",
         "DATA_FORMAT: DOUBLE", "VARIABLE: rho", "DATA_ENDIAN: LITTLE")
    return span(FIELD)


# --- chemistry ---


def lines(values, each):
    return [" ".join("%.12E" % v for v in values[i:i + each])
            for i in range(0, len(values), each)]


def cube():
    """Bohr, x slowest."""
    text("density.cube", "density", "of one atom", "1 0 0 0", f"{NX} 0.5 0 0",
         f"{NY} 0 0.5 0", f"{NZ} 0 0 0.5", "1 1.0 3.0 2.0 2.5",
         *lines(FIELD.T.ravel(), 6))
    return span(FIELD)


def vasp():
    """Charges times the volume of the cell, of 6 x 5 x 4 angstrom; x fastest."""
    text("CHGCAR", "one atom", "1.0", "6 0 0", "0 5 0", "0 0 4", "H", "1", "Direct",
         "0.5 0.4 0.6", "", f"{NX} {NY} {NZ}", *lines(FIELD.ravel() * 120, 5))
    return span(FIELD, (NX + 1, NY + 1, NZ + 1))


CODES = {"density.cube": cube, "CHGCAR": vasp, "plt00000": amrex, "run_hdf5_plt_cnt_0000": flash,
         "blast.prim.00000.athdf": athena, "amr.vtkhdf": vtkhdf,
         "wrfout_d01_2005-08-28_00:00:00": wrf, "era5.nc": era5, "era5.zarr": era5_zarr,
         "ORCA025_grid_T.nc": nemo, "ocean_his_0001.nc": roms, "pop.h.0001-01.nc": pop,
         "hycom.nc": hycom, "simData_%T.h5:/data/%T/fields/E/x": picongpu,
         "diags/hdf5/data%T.h5:/data/%T/fields/rho": theta_mode, "run.pvd": pvd,
         "blocks.vtm": vtm, "levels.vth": vth, "openfoam.vti": openfoam, "out.xmf": xdmf,
         "run.h5:/step_0000/rho": own_hdf5, "rho.dat": fortran, "rho.bov": bov}


def commands():
    """Of the table, by the file that they open."""
    for line in open(PAGE):
        if line.startswith("| "):
            for command in re.findall(r"`(snowglass render [^`]*)`", line):
                yield command
        elif line.startswith("## "):
            return


def run(words):
    return subprocess.run([TOOL, *words], capture_output=True, text=True)


def check(command):
    """Returns what is wrong, or None."""
    words = shlex.split(command)[1:]
    dims, low, high = CODES.pop(words[1])()
    out = words.index("-o")
    drawn = run(words)
    if drawn.returncode or not os.path.getsize(words[out + 1]):
        return drawn.stderr
    told = run(["info", "--json", *words[1:out], *words[out + 2:]])
    got = json.loads(told.stdout) if told.returncode == 0 else {}
    if got.get("dims") != dims:
        return f"has {got.get('dims')} voxels, not {dims}: {told.stderr}"
    near = 1e-6 * max(abs(low), abs(high))
    if abs(got["min"] - low) > near or abs(got["max"] - high) > near:
        return f"{got['min']} to {got['max']}, not {low} to {high}"
    return None


ran = failed = 0
for command in commands():
    ran += 1
    try:
        wrong = check(command)
    except KeyError as name:
        wrong = f"there is no file for it: {name}"
    if wrong:
        failed += 1
        print(f"FAILED {command}: {wrong}")
for name in CODES:
    failed += 1
    print(f"FAILED {name}: no row of {PAGE} opens it")
print(f"{ran} commands, {failed} failed")
sys.exit(failed > 0 or ran < 15)
