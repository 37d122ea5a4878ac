"""Legacy VTK files and VTI beside VTK, whose writers and readers are used."""
import re

import oracle
from oracle import np

vtk, = oracle.need("vtk")
from vtk.util.numpy_support import numpy_to_vtk, vtk_to_numpy

TYPES = ["i1", "u1", "i2", "u2", "i4", "u4", "i8", "u8", "f4", "f8"]
TURN = np.array([[0, -1, 0], [0.6, 0, -0.8], [0.8, 0, 0.6]])


def image(shape=(7, 6, 5), turned=True, extent=(0, 0, 0)):
    grid = vtk.vtkImageData()
    z, y, x = shape
    e = extent
    grid.SetExtent(e[0], e[0] + x - 1, e[1], e[1] + y - 1, e[2],
                   e[2] + z - 1)
    grid.SetSpacing(0.5, 1.25, 2)
    grid.SetOrigin(3, -4, 5.5)
    if turned:
        grid.SetDirectionMatrix(*TURN.ravel())
    return grid


def add(grid, name, values, cells=False, scalars=False):
    shape = values.shape if values.ndim == 3 else values.shape[:3]
    flat = values.reshape(np.prod(shape), -1)
    array = numpy_to_vtk(np.ascontiguousarray(
        flat if flat.shape[1] > 1 else flat.ravel()), deep=True)
    array.SetName(name)
    where = grid.GetCellData() if cells else grid.GetPointData()
    if scalars:
        where.SetScalars(array)
    else:
        where.AddArray(array)


def matrix_of(grid, cells=False):
    m = grid.GetIndexToPhysicalMatrix()
    matrix = np.array([[m.GetElement(i, j) for j in range(4)]
                       for i in range(4)])
    e = grid.GetExtent()
    first = np.array([e[0], e[2], e[4]]) + (0.5 if cells else 0)
    matrix[:3, 3] += matrix[:3, :3] @ first
    return matrix


def write_vti(grid, path, mode, compressor, header, big):
    writer = vtk.vtkXMLImageDataWriter()
    writer.SetInputData(grid)
    writer.SetFileName(path)
    if mode == "ascii":
        writer.SetDataModeToAscii()
    elif mode == "binary":
        writer.SetDataModeToBinary()
    else:
        writer.SetDataModeToAppended()
        writer.SetEncodeAppendedData(mode == "appended base64")
    if compressor:
        writer.SetCompressor(vtk.vtkLZ4DataCompressor() if compressor == "lz4"
                             else vtk.vtkZLibDataCompressor())
        writer.SetBlockSize(4096)
    else:
        writer.SetCompressor(None)
    if header == 64:
        writer.SetHeaderTypeToUInt64()
    else:
        writer.SetHeaderTypeToUInt32()
    if big:
        writer.SetByteOrderToBigEndian()
    assert writer.Write()


# Every way that VTK's writer knows, with arrays before and behind.
b = oracle.sample("f4", (20, 21, 22))
for mode in ("ascii", "binary", "appended raw", "appended base64"):
    for packed in (False, True):
        for header in (32, 64):
            for big in (False, True):
                grid = image(b.shape, extent=(-2, 3, 10))
                add(grid, "before", oracle.sample("u1", b.shape))
                add(grid, "wanted", b, scalars=True)
                add(grid, "behind", oracle.sample("i2", b.shape))
                write_vti(grid, "a.vti", mode, packed, header, big)
                said = f"{mode} packed {packed} header {header} big {big}"
                oracle.expect("a.vti", b, matrix_of(grid), name=said)
                if oracle.SHORT and packed != big: # each other one
                    continue
                oracle.expect("a.vti", oracle.sample("i2", b.shape),
                              matrix_of(grid), ["--dataset", "behind"],
                              name=said + " behind")
        oracle.expect(oracle.packed("a.vti", "b.vti.gz"), b, matrix_of(grid),
                      name=said + " gzip")
oracle.refuse("a.vti", "before, wanted, behind", ["--dataset", "none"], 2)

MODES = ("ascii", "binary", "appended raw")
for n, kind in enumerate(TYPES):
    a = oracle.sample(kind)
    for mode in oracle.few(MODES, 3, n):
        grid = image()
        add(grid, "a", a, scalars=True)
        write_vti(grid, "a.vti", mode, True, 32, False)
        oracle.expect("a.vti", a, matrix_of(grid), name=f"{kind} {mode}")

if oracle.library("lz4"):
    for mode in MODES[1:]:
        grid = image(b.shape)
        add(grid, "before", oracle.sample("u1", b.shape))
        add(grid, "wanted", np.round(b), scalars=True)
        write_vti(grid, "a.vti", mode, "lz4", 32, False)
        oracle.expect("a.vti", np.round(b), matrix_of(grid), name=f"{mode} lz4")

# Several pieces in one file, whose texts VTK writes and whose whole it reads.
for cells in (False, True):
    for mode in oracle.few(("ascii", "binary", "lz4"), 3, cells):
        whole = oracle.sample("f4")
        body, more = "", 0 if cells else 1
        for z in ((0, 2), (2, 7 - more)):
            for y in ((0, 4), (4, 6 - more)):
                part = whole[z[0]:z[1] + more, y[0]:y[1] + more]
                grid = image(extent=(2, 0, 0))
                grid.SetExtent(2, 7 - more, *y, *z)
                add(grid, "a", part, cells, True)
                writer = vtk.vtkXMLImageDataWriter()
                writer.SetInputData(grid)
                writer.SetWriteToOutputString(True)
                writer.SetDataMode(0 if mode == "ascii" else 1)
                writer.SetCompressor(vtk.vtkLZ4DataCompressor()
                                     if mode == "lz4" else None)
                assert writer.Write()
                text = writer.GetOutputString()
                first, last = text.index("<Piece"), text.rindex("</Piece>") + 8
                body += text[first:last] + "\n"
        grid.SetExtent(2, 7 - more, 0, 6 - more, 0, 7 - more)
        extent = " ".join(map(str, grid.GetExtent()))
        head = re.sub('WholeExtent="[^"]*"', f'WholeExtent="{extent}"',
                      text[:first])
        oracle.put("p.vti", head + body + text[last:])
        reader = vtk.vtkXMLImageDataReader()
        reader.SetFileName("p.vti")
        reader.Update()
        data = reader.GetOutput()
        data = data.GetCellData() if cells else data.GetPointData()
        values = vtk_to_numpy(data.GetArray("a")).reshape(whole.shape)
        oracle.expect("p.vti", values, matrix_of(grid, cells),
                      name=f"pieces {mode} cells {cells}")

# Vectors by channel; values of cells.
a = oracle.sample("f8", (7, 6, 5, 3))
c = oracle.sample("u2", (6, 5, 4))
for mode in MODES:
    grid = image()
    add(grid, "v", a)
    add(grid, "c", c, cells=True)
    write_vti(grid, "a.vti", mode, True, 64, False)
    for channel in range(3):
        oracle.expect("a.vti", a[..., channel], matrix_of(grid),
                      ["--channel", channel])
    oracle.expect("a.vti", oracle.magnitude(a), matrix_of(grid),
                  name=f"{mode} magnitude")
    oracle.expect("a.vti", c, matrix_of(grid, True), ["--dataset", "c"])
    grid = image()
    add(grid, "c", c, cells=True)
    write_vti(grid, "a.vti", mode, True, 64, False)
    oracle.expect("a.vti", c, matrix_of(grid, True))

# Values of several channels in MetaImage, by VTK's copy of MetaIO; the places are
# LPS.  Kinds of NRRD with several values are in test_nrrd.c.
for kind, name in (("u1", "MET_UCHAR"), ("i2", "MET_SHORT_ARRAY"),
                   ("f4", "MET_FLOAT")):
    values = oracle.sample(kind, (7, 6, 5, 3))
    oracle.put("m.raw", values.tobytes())
    oracle.put("m.mhd", f"NDims = 3\nDimSize = 5 6 7\nElementType = {name}\n"
               "ElementNumberOfChannels = 3\nElementSpacing = 1 2 3\n"
               "Offset = 4 5 6\nElementDataFile = m.raw\n")
    if name.endswith("_ARRAY"): # which VTK lacks
        read = values
    else:
        reader = vtk.vtkMetaImageReader()
        reader.SetFileName("m.mhd")
        reader.Update()
        read = vtk_to_numpy(reader.GetOutput().GetPointData().GetScalars())
        read = read.reshape(values.shape)
    for channel in range(3):
        oracle.expect("m.mhd", read[..., channel],
                      np.diag([-1, -1, 1, 1]) @
                      oracle.affine((1, 2, 3), (4, 5, 6)),
                      ["--channel", channel], name=f"MetaImage {kind}")

# Legacy files.
for version in (42, 51):
    for binary in (False, True):
        for kind in oracle.few(TYPES, 4, version // 51 + 2 * binary):
            a = oracle.sample(kind)
            grid = image(turned=False)
            add(grid, "the_array", a, scalars=True)
            add(grid, "v", oracle.sample("f4", (7, 6, 5, 3)))
            add(grid, "c", c, cells=True)
            writer = vtk.vtkStructuredPointsWriter()
            writer.SetInputData(grid)
            writer.SetFileName("a.vtk")
            writer.SetFileVersion(version)
            if binary:
                writer.SetFileTypeToBinary()
            assert writer.Write()
            said = f"legacy {version} binary {binary} {kind}"
            # Text has six digits: what VTK reads back counts.
            reader = vtk.vtkStructuredPointsReader()
            reader.SetFileName("a.vtk")
            reader.ReadAllScalarsOn()
            reader.ReadAllVectorsOn()
            reader.ReadAllFieldsOn()
            reader.Update()
            points = reader.GetOutput().GetPointData()
            v = vtk_to_numpy(points.GetArray("v")).reshape(7, 6, 5, 3)
            a = vtk_to_numpy(points.GetArray("the_array")).reshape(7, 6, 5)
            oracle.expect("a.vtk", a, matrix_of(grid), name=said + " default")
            options = ["--dataset", "the_array"]
            oracle.expect("a.vtk", a, matrix_of(grid), options, name=said)
            for channel in range(3):
                oracle.expect("a.vtk", v[..., channel], matrix_of(grid),
                              ["--dataset", "v", "--channel", channel],
                              name=said + " vectors")
            oracle.expect("a.vtk", c, matrix_of(grid, True),
                          ["--dataset", "c"], name=said + " cells")

for relative in oracle.few(("formats/vtk/ironProt.vtk", "sim/isabel_30.vti",
                            "sim/hydrogen.vti", "classic/engine.vti",
                            "classic/bonsai.vti", "classic/aneurism.vti"), 2):
    reader = vtk.vtkStructuredPointsReader() if relative.endswith("vtk") else \
        vtk.vtkXMLImageDataReader()
    path = oracle.data(relative)
    if path:
        reader.SetFileName(path)
        reader.Update()
        grid = reader.GetOutput()
        values = vtk_to_numpy(grid.GetPointData().GetScalars())
        oracle.expect(path, values.reshape(grid.GetDimensions()[::-1]),
                      matrix_of(grid))
oracle.finish()
