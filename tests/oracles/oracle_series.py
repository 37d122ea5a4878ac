"""Files that name others, as simulations write them: series of VTK, VisIt, XDMF
and openPMD, and parts of one grid, each beside an analytic field."""
import oracle
from oracle import np, put

h5py, vtk = oracle.need("h5py", "vtk")
from vtk.util.numpy_support import numpy_to_vtk
oracle.need_modules()

N, STEP, ORIGIN = (12, 10, 8), (0.5, 1, 2), (-3, 1, 5)
WHOLE = (0, 11, 0, 9, 0, 7)
BOX = ["--crop", "1:9,2:6,3:7"]


def field(x, y, z):
    return 2 * x - 3 * y + 0.5 * z + 1


def at(axis):
    return ORIGIN[axis] + STEP[axis] * np.arange(N[axis])


def values(time=0, axes=(at(0), at(1), at(2))):
    return (field(axes[0][None, None, :], axes[1][None, :, None],
                  axes[2][:, None, None]) + 100 * time).astype("f4")


def check(path, options=(), time=0, wanted=(8, 10, 12), name=None):
    for box in ((), BOX):
        voxels, matrix = oracle.voxels_of(path, [*options, *box])
        if voxels is None:
            return
        if not box and voxels.shape != wanted:
            oracle.fail(name or path, f"shape {voxels.shape}, not {wanted}")
        if box and voxels.shape != (4, 4, 8):
            oracle.fail(name or path, f"box of shape {voxels.shape}")
        wrong = np.abs(voxels - 100 * time -
                       field(*oracle.world(voxels, matrix))).max()
        if not wrong < 1e-4:
            oracle.fail(name or path, f"differs from the field by {wrong}")


def image(extent, time=0):
    grid = vtk.vtkImageData()
    grid.SetOrigin(*ORIGIN)
    grid.SetSpacing(*STEP)
    grid.SetExtent(*extent)
    a = values(time)[extent[4]:extent[5] + 1, extent[2]:extent[3] + 1,
                     extent[0]:extent[1] + 1]
    array = numpy_to_vtk(a.ravel(), deep=1)
    array.SetName("rho")
    grid.GetPointData().SetScalars(array)
    moment = vtk.vtkDoubleArray()
    moment.SetName("TimeValue")
    moment.InsertNextValue(0.25 + time)
    grid.GetFieldData().AddArray(moment)
    return grid


def write_image(path, grid):
    writer = vtk.vtkXMLImageDataWriter()
    writer.SetFileName(path)
    writer.SetInputData(grid)
    assert writer.Write()


def words(numbers):
    return " ".join(map(str, numbers))


# --- VTK ---------------------------------------------------------------------
for t in range(4):
    write_image(f"p_{t}.vti", image(WHOLE, t))
oracle.tells("p_1.vti", (), time_value=1.25, quantity="rho")
put("s.pvd", '<?xml version="1.0"?><VTKFile type="Collection"><Collection>' +
    "".join(f'<DataSet timestep="{t / 4}" part="0" file="p_{t}.vti"/>'
            for t in range(4)) + "</Collection></VTKFile>")
check("s.pvd")
check("s.pvd", ["--time", 2], 2)
check("s.pvd", ["--time", -1], 3)
check("s.pvd", ["--time", "last"], 3)
check("s.pvd", ["--time", "0.5"], 2)
oracle.tells("s.pvd", ["--time", 3], times=4, time=3, time_value=0.75,
             format="pvd")
oracle.refuse("s.pvd", "there is no time step 4", ["--time", 4], 2)
LEFT, RIGHT = (0, 6, 0, 9, 0, 7), (6, 11, 0, 9, 0, 7)
write_image("q_0.vti", image(LEFT))
write_image("q_1.vti", image(RIGHT))
put("q.pvti", f'''<?xml version="1.0"?><VTKFile type="PImageData">
<PImageData WholeExtent="{words(WHOLE)}" Origin="{words(ORIGIN)}"
Spacing="{words(STEP)}"><PPointData Scalars="rho"/>
<Piece Extent="{words(LEFT)}" Source="q_0.vti"/>
<Piece Extent="{words(RIGHT)}" Source="q_1.vti"/></PImageData></VTKFile>''')
check("q.pvti")


def blocks(path, *extents, others=()):
    parts = vtk.vtkMultiBlockDataSet()
    for i, extent in enumerate(extents):
        parts.SetBlock(i, image(extent))
    for other in others:
        parts.SetBlock(parts.GetNumberOfBlocks(), other)
    writer = vtk.vtkXMLMultiBlockDataWriter()
    writer.SetFileName(path)
    writer.SetInputData(parts)
    assert writer.Write()


blocks("m.vtm", LEFT, RIGHT)
check("m.vtm")
sphere = vtk.vtkSphereSource()
sphere.Update()
blocks("o.vtm", WHOLE, others=[sphere.GetOutput()])
check("o.vtm")
oracle.says("o.vtm", "o.vtm", "1 of 2 files are surfaces")
blocks("g.vtm", (0, 3, 0, 9, 0, 7), (6, 11, 0, 9, 0, 7))
voxels, matrix = oracle.voxels_of("g.vtm")
if np.isnan(voxels).sum() != 2 * 10 * 8 or not np.isnan(voxels[0, 0, 4:6]).all():
    oracle.fail("g.vtm", "the gap is not missing")
put("u.pvd", '<VTKFile type="Collection"><Collection>'
    '<DataSet timestep="0" file="q.pvti"/><DataSet timestep="1" file="m.vtm"/>'
    '</Collection></VTKFile>')
check("u.pvd", ["--time", 0])
check("u.pvd", ["--time", 1])
put("loop.pvd", '<VTKFile type="Collection"><Collection>'
    '<DataSet timestep="0" file="loop.pvd"/></Collection></VTKFile>')
oracle.refuse("loop.pvd", "names a file that names others")
put("none.pvd", '<VTKFile type="Collection"/>')
oracle.refuse("none.pvd", "names no files")
for kind, part in (("PRectilinearGrid", "pieces of a rectilinear grid"),
                   ("vtkOverlappingAMR", "names no files"),
                   ("vtkNonOverlappingAMR", "blocks do not overlap"),
                   ("UnstructuredGrid", "an unstructured grid"),
                   ("PolyData", "surfaces")):
    put("a.vth", f'<VTKFile type="{kind}"/>')
    oracle.refuse("a.vth", part)

# --- VisIt -------------------------------------------------------------------
put("l.visit", "!NBLOCKS 2\n!TIME 0.5\n# a remark\nq_0.vti\nq_1.vti\n")
check("l.visit")
oracle.tells("l.visit", (), time_value=0.5, times=1)
put("s.visit", "p_0.vti\np_1.vti\n")
check("s.visit", ["--time", 1], 1)
put("b.visit", "!NBLOCKS 2\np_0.vti\n")
oracle.refuse("b.visit", "no multiple of its 2 blocks")
HEAD = ("DATA_SIZE: 12 10 8\nDATA_FORMAT: FLOAT\nVARIABLE: rho\n"
        "BRICK_ORIGIN: -3 1 5\nBRICK_SIZE: 6 10 16\n")
for centre in ("zonal", "nodal"):
    for order, kind in (("LITTLE", "<f4"), ("BIG", ">f4")):
        axes = [ORIGIN[i] + ((np.arange(N[i]) + 0.5) * n / N[i]
                             if centre == "zonal" else
                             np.arange(N[i]) * n / (N[i] - 1))
                for i, n in enumerate((6, 10, 16))]
        brick = values(0, axes)
        put("b.raw", b"head" + brick.astype(kind).tobytes())
        put("b.bov", f"TIME: 1.5\nDATA_FILE: b.raw\n{HEAD}DATA_ENDIAN: {order}"
            f"\nCENTERING: {centre}\nBYTE_OFFSET: 4\n")
        check("b.bov", name=f"bov {centre} {order}")
oracle.tells("b.bov", (), time_value=1.5, quantity="rho")
number = 0
for z in (0, 4):
    for y in (0, 5):
        for x in (0, 4, 8):
            brick[z:z + 4, y:y + 5, x:x + 4].tofile(f"b_{number:03d}.raw")
            number += 1
put("c.bov", f"DATA_FILE: b_%03d.raw\nDATA_BRICKLETS: 4 5 4\n{HEAD}"
    "DATA_ENDIAN: LITTLE\nCENTERING: nodal\n")
check("c.bov")
put("c.bov", "# a remark\nDATA_FILE: b_%03d.raw # of each\n"
    f"DATA_BRICKLETS: 4 5 4\n{HEAD.replace('FLOAT', 'FLOATS')}CENTERING: nodal\n")
check("c.bov")
put("c.bov", "DATA_FILE: b.raw\n")
oracle.refuse("c.bov", "lacks DATA_FILE or DATA_SIZE")

# --- XDMF --------------------------------------------------------------------
Z = np.array([0, 1, 3, 7, 15, 31, 32, 33.])
with h5py.File("x.h5", "w") as file:
    for t in range(3):
        file[f"step{t}/rho"] = values(t)
        file[f"step{t}/cell"] = np.full((7, 9, 11), t, "f4")
    file["v"] = np.stack([values(), 0 * values(), 0 * values()], -1)
    file["uneven"] = values(0, (at(0), at(1), Z))
    file["z"] = Z
GRID = ('<Topology TopologyType="3DCoRectMesh" Dimensions="8 10 12"/>'
        '<Geometry GeometryType="ORIGIN_DXDYDZ"><DataItem Format="XML">5 1 -3'
        '</DataItem><DataItem Format="XML">2 1 0.5</DataItem></Geometry>')
START = '<?xml version="1.0"?><!DOCTYPE Xdmf SYSTEM "Xdmf.dtd" []><Xdmf><Domain>'
END = "</Domain></Xdmf>"


def grid(attribute, inside=GRID):
    return f'<Grid GridType="Uniform">{inside}{attribute}</Grid>'


def item(name, what, centre="Node", more='Format="HDF"'):
    return (f'<Attribute Name="{name}" Center="{centre}"><DataItem {more}>'
            f"{what}</DataItem></Attribute>")


put("x.xmf", START + '<Grid GridType="Collection" CollectionType="Temporal">' +
    "".join(grid(f'<Time Value="{t / 4}"/>' +
                 item("rho", f"x.h5:/step{t}/rho") +
                 item("cell", f" x.h5:/step{t}/cell\n", "Cell"))
            for t in range(3)) + "</Grid>" + END)
check("x.xmf")
check("x.xmf", ["--time", 2], 2)
check("x.xmf", ["--time", "last"], 2)
oracle.tells("x.xmf", ["--time", 1], times=3, time_value=0.25, quantity="rho")
oracle.tells("x.xmf", ["--time", 1, "--dataset", "cell"], dims=[11, 9, 7],
             max=1)
oracle.refuse("x.xmf", "the file has rho, cell", ["--dataset", "no"], 2)
put("v.xmf", START + grid(item("v", "x.h5:/v")) + END)
check("v.xmf", ["--component", "x"])
# A path without a slash; boxes of arrays of three to five axes; vectors that are
# joined of several arrays.
random = np.random.default_rng(7)
with h5py.File("y.h5", "w") as file:
    whole = [random.random((8, 10, 12)) for _ in range(3)]
    for name, part in zip("abc", whole):
        file[name] = part
    file["four"] = np.stack(whole)
    five = file["five"] = random.random((2, 3, 7, 9, 4))
    file["box"] = np.pad(whole[1], ((1, 2), (3, 0), (0, 5)))
    file["edges"] = np.add.outer(4.0 * np.arange(8), np.arange(5))
    blocks_of = file["blocks"] = random.random((2, 8, 5, 5, 4))


def slab(what, *rows):
    return (f'<DataItem ItemType="HyperSlab"><DataItem Format="XML">'
            f'{" ".join(words(row) for row in rows)}</DataItem><DataItem '
            f'Format="HDF">y.h5:{what}</DataItem></DataItem>')


def values_are(wanted, *options):
    oracle.checked += 1
    found, _ = oracle.voxels_of("y.xmf", options)
    if found is None or not np.array_equal(found, wanted):
        oracle.fail("y.xmf", f"other values, {options}")


def hold(*items):
    put("y.xmf", START + grid("".join(
        f'<Attribute Name="v{n}" Center="Node">{each}</Attribute>'
        for n, each in enumerate(items))) + END)


ONE = (1,) * 5
SIZE = (8, 10, 12)
hold('<DataItem Format="HDF">\n y.h5:a\n</DataItem>',
     slab("/four", (2, 0, 0, 0), ONE[:4], (1, *SIZE)),
     slab("box", (1, 3, 0), ONE[:3], SIZE))
values_are(whole[0])
values_are(whole[2], "--dataset", "v1")
values_are(whole[1], "--dataset", "v2")
values_are(whole[1][2:5, 1:9, 4:], "--dataset", "v2", "--crop", "4:,1:9,2:5")
hold('<DataItem ItemType="Function" Function=" join($0, $1, $2)">' +
     "".join(f'<DataItem Format="HDF">y.h5:/{name}</DataItem>' for name in "abc") +
     "</DataItem>")
values_are(oracle.magnitude(np.stack(whole, -1)))
for name, part in zip("xyz", whole):
    values_are(part, "--component", name)
for bad, part in ((slab("/four", (0,) * 4, ONE[:4], (2, *SIZE)), "not one box"),
                  (slab("/a", (0,) * 3, (1, 1, 2), SIZE), "not one box"),
                  (slab("/a", (0, 0, 4), ONE[:3], SIZE), "does not lie in y.h5"),
                  (slab("/a", (0, 0), ONE[:2]), "three numbers for each")):
    hold(bad)
    oracle.refuse("y.xmf", part)

# Athena++: a grid for each block, in a collection in space, which is the default;
# edges of cells and values by boxes of arrays; four cells are no components.
def block(n, edges):
    corner = (4 * (n & 1), 5 * (n >> 1 & 1), 5 * (n >> 2))
    numbers = "".join('<DataItem Format="XML">' + words(range(at, at + size + 1)) +
                      "</DataItem>" for at, size in zip(corner, (4, 5, 5)))
    if edges:
        numbers = slab("/edges", (n & 1, 0), (1, 1), (1, 5)) + \
            numbers[numbers.index("</DataItem>") + 11:]
    return ('<Grid><Topology TopologyType="3DRectMesh" NumberOfElements="6 6 5"/>'
            f'<Geometry GeometryType="VXVYVZ">{numbers}</Geometry><Attribute '
            'Name="rho" Center="Cell">' +
            slab("/blocks", (1, n, 0, 0, 0), ONE, (1, 1, 5, 5, 4)) +
            "</Attribute></Grid>")


joined = np.zeros((10, 10, 8))
for n in range(8):
    joined[5 * (n >> 2):, 5 * (n >> 1 & 1):, 4 * (n & 1):][:5, :5, :4] = blocks_of[1, n]
PARTS = "".join(block(n, n > 3) for n in range(8))
for outside in ('<Grid GridType="Collection">{}</Grid>',
                '<Grid GridType="Collection" CollectionType="Spatial"><Time Value="3"/>{}'
                "</Grid>", '<Grid GridType="Collection" CollectionType="Temporal">'
                '<Grid GridType="Collection" CollectionType="Spatial"><Time Value="2"/>{0}'
                '</Grid><Grid GridType="Collection" CollectionType="Spatial">'
                '<Time Value="3"/>{0}</Grid></Grid>'):
    put("y.xmf", START + outside.format(PARTS) + END)
    values_are(joined)
    values_are(joined[3:8, 1:9, 2:6], "--crop", "2:6,1:9,3:8", "--time", -1)
    oracle.tells("y.xmf", ["--time", -1], time_value=3.0 if "Value" in outside else None,
                 times=2 if "Temporal" in outside else 1)

# Times as text and in HDF5; those that are none; a grid's own beside a list.
with h5py.File("times.h5", "w") as file:
    file["list"] = (0.25, 0.5, 0.75)
    file["even"] = (0.25, 0.25, 3)
    file["two"] = (0.25, 0.5)
NOTE = "its list of times has none"
for kind, form, numbers, own, times in (
        ("List", "XML", "0.25 0.5 0.75", {}, (0.25, 0.5, 0.75)),
        ("HyperSlab", "XML", "0.25 0.25 3", {}, (0.25, 0.5, 0.75)),
        ("List", "XML", "0.25", {}, (0.25, None, None)),
        ("List", "HDF", "times.h5:/list", {}, (0.25, 0.5, 0.75)),
        ("HyperSlab", "HDF", "times.h5:/even", {}, (0.25, 0.5, 0.75)),
        ("List", "HDF", "times.h5:/two", {}, (None,) * 3),
        ("List", "HDF", "times.h5:/no", {}, (None,) * 3),
        ("List", "Binary", "times.bin", {}, (None,) * 3),
        ("List", "XML", "nan inf 5", {}, (None, None, 5)),
        ("HyperSlab", "XML", "1 0.5 9", {1: 7}, (1, 7, 2)),
        ("List", "XML", "1 3 9", {1: 7, 2: "inf"}, (1, 7, None))):
    put("t.xmf", START + '<Grid GridType="Collection" '
        f'CollectionType="Temporal"><Time TimeType="{kind}"><DataItem '
        f'Format="{form}" Dimensions="3">{numbers}</DataItem></Time>' +
        "".join(grid((f'<Time Value="{own[t]}"/>' if t in own else "") +
                     item("rho", f"x.h5:/step{t}/rho"))
                for t in range(3)) + "</Grid>" + END)
    check("t.xmf", ["--time", 2], 2)
    for t in range(3):
        oracle.tells("t.xmf", ["--time", t], time_value=times[t])
        if ((NOTE in oracle.run("t.xmf", "--time", t).stderr) !=
                (times[t] is None and t not in own)):
            oracle.fail("t.xmf", f"the note on the time of step {t}")
values().tofile("x.bin")
put("r.xmf", START + grid(item("r", "x.bin", more='Format="Binary" '
                         'NumberType="Float" Precision="4" '
                         'Endian="Little"')) + END)
check("r.xmf")
# Short is 16 bits, and bytes that follow cause a note.
(100 * values()).astype("i2").tofile("short.bin")
for kind in "Short", "UShort":
    put("s.xmf", START + grid(item("r", "short.bin", more='Format="Binary" '
                                    f'NumberType="{kind}"')) + END)
    oracle.tells("s.xmf", type="u" * (kind[0] == "U") + "int16",
         sum=float((100 * values()).astype("u2" if kind[0] == "U" else
                                            "i2").sum(dtype="f8")))
with open("short.bin", "ab") as file:
    file.write(b"more")
for more in False, True: # of another attribute
    put("s.xmf", START + grid("".join(
        item(name, "short.bin", more='Format="Binary" NumberType="Short"')
        for name in "rs"[:1 + more])) + END)
    if ("4 bytes after the data" in oracle.run("s.xmf").stderr) == more:
        oracle.fail("s.xmf", f"the note on its last bytes, {more}")
put("n.xmf", START + grid(item("n", "x.h5:/uneven"), '''<Topology
TopologyType="3DRectMesh" Dimensions="8 10 12"/><Geometry GeometryType="VXVYVZ">
<DataItem Format="XML">%s</DataItem><DataItem Format="XML">%s</DataItem>
<DataItem Format="HDF">x.h5:/z</DataItem></Geometry>''' %
                           (words(at(0)), words(at(1)))) + END)
check("n.xmf", wanted=(34, 10, 12))
put("w.xmf", START + grid(item("w", "x.h5:/z")) + END)
oracle.refuse("w.xmf", "not the size of its grid")
put("e.xmf", '<!DOCTYPE Xdmf [<!ENTITY a "x">]><Xdmf/>')
oracle.refuse("e.xmf", "declares entities")

# --- HDF5: names with numbers, openPMD ---------------------------------------
with h5py.File("o.h5", "w") as file:
    for step in (0, 100, 200, 1000):
        group = file.create_group(f"data/{step}")
        group.attrs.update(time=step * 0.5, timeUnitSI=1e-15, dt=0.5)
        record = group.create_group("fields/E")
        record.attrs["axisLabels"] = ["z", "y", "x"] # of variable length
        record.attrs.update(gridSpacing=STEP[::-1],
                            gridGlobalOffset=[5., 1., -3.], gridUnitSI=1.,
                            unitDimension=[1., 1, -3, -1, 0, 0, 0])
        v = record.create_dataset("x", data=values(step / 100))
        v.attrs.update(unitSI=1., position=[0., 0, 0])
        file[f"step_{step:04d}/rho"] = values(step)
NAME = "o.h5:/data/%T/fields/E/x"
check(NAME)
check(NAME, ["--time", -1], 10)
check("o.h5", ["--dataset", "/data/%T/fields/E/x", "--time", 2], 2)
oracle.tells(NAME, ["--time", 2], times=4, time=2, time_unit="s",
             quantity="E x", value_unit="V/m")
oracle.tells("o.h5:/step_%04d/rho", ["--time", 3], times=4, time_value=1000,
             time_unit="step")
oracle.refuse("o.h5", "no data set has such a name",
              ["--dataset", "/data/%06T/x"], 2)
for version in ("earliest", "latest"):
    with h5py.File("a.h5", "w", libver=version, userblock_size=512) as file:
        v = file.create_dataset("g/rho", data=values())
        for i in range(5):
            v.attrs[f"x{i}"] = "v" * i * 20
        v.attrs["units"], v.attrs["long_name"] = "kg/m\u00b3", "density"
        v.parent.attrs["time"] = 0.125
    oracle.tells("a.h5", (), value_unit="kg/m\u00b3", long_name="density",
                 time_value=0.125)
oracle.finish()
