"""MRC maps beside mrcfile, which is numpy's view of the same bytes."""
import warnings

import oracle
from oracle import np

mrcfile, = oracle.need("mrcfile")

warnings.simplefilter("ignore")


def cell_axes(header):
    """Columns: steps along the cell's axes X, Y, Z, in angstrom."""
    lengths = [float(header.cella[n]) for n in "xyz"]
    alpha, beta, gamma = (np.radians(float(header.cellb[n]))
                          for n in ("alpha", "beta", "gamma"))
    x = np.array([1, 0, 0])
    y = np.array([np.cos(gamma), np.sin(gamma), 0])
    z0 = np.cos(beta)
    z1 = (np.cos(alpha) - np.cos(beta) * np.cos(gamma)) / np.sin(gamma)
    z = np.array([z0, z1, np.sqrt(1 - z0 * z0 - z1 * z1)])
    counts = [int(header.mx), int(header.my), int(header.mz)]
    return np.stack([x, y, z], axis=1) * lengths / counts


def matrix_of(header):
    order = [int(header.mapc) - 1, int(header.mapr) - 1, int(header.maps) - 1]
    matrix = np.eye(4)
    matrix[:3, :3] = cell_axes(header)[:, order]
    start = [int(header.nxstart), int(header.nystart), int(header.nzstart)]
    origin = np.array([float(header.origin[n]) for n in "xyz"])
    matrix[:3, 3] = origin if origin.any() else matrix[:3, :3] @ start
    return matrix


for relative in ("formats/mrc/EMD-3001.map", "formats/mrc/EMD-3197.map",
                 "formats/mrc/emd_3197.map.gz"):
    path = oracle.data(relative)
    if path:
        with mrcfile.open(path, permissive=True) as file:
            oracle.expect(path, file.data, matrix_of(file.header),
                          unit="angstrom")

for kind in ("i1", "i2", "f4", "u2", "f2"):
    a = oracle.sample(kind)
    with mrcfile.new("a.mrc", overwrite=True) as file:
        file.set_data(a)
        file.set_volume()
        file.voxel_size = (1.5, 2, 2.5)
        file.header.origin = (10, -20, 30)
        matrix = matrix_of(file.header)
    oracle.expect("a.mrc", oracle.wide(a), matrix, unit="angstrom", name=kind)

# Other orders of axes, slanted cells, starts, an extended header, big endian.
for order in [(2, 1, 3), (3, 2, 1), (2, 3, 1)]:
    a = oracle.sample("f4")
    with mrcfile.new("b.mrc", overwrite=True) as file:
        file.set_data(a)
        file.set_volume()
        file.voxel_size = (1.5, 2, 2.5)
        file.header.mapc, file.header.mapr, file.header.maps = order
        file.header.cellb = (80, 95, 110)
        file.header.nxstart, file.header.nystart = -3, 7
        file.set_extended_header(np.zeros(100, "V1"))
        matrix = matrix_of(file.header)
    oracle.expect("b.mrc", a, matrix, name=str(order))
whole = oracle.got("b.mrc")


def swapped(first, end=None):
    return np.frombuffer(whole[first:end], "<u4").astype(">u4").tobytes()


oracle.put("c.mrc", swapped(0, 208) + whole[208:212] + b"\x11\x11\0\0" +
           whole[216:1124] + swapped(1124))
oracle.expect("c.mrc", a, matrix, name="big endian")

# A stack of volumes; a cell without sense; bytes by IMOD.
stack = oracle.sample("i2", (3, 4, 5, 6))
with mrcfile.new("d.mrc", overwrite=True) as file:
    file.set_data(stack)
    file.voxel_size = 2
for time in range(3):
    oracle.expect("d.mrc", stack[time], oracle.affine((2, 2, 2)),
                  ["--time", time])
for value in (0, np.nan):
    with mrcfile.new("e.mrc", overwrite=True) as file:
        file.set_data(stack[0])
        file.header.cella = (value, value, value)
    oracle.expect("e.mrc", stack[0], unit="", name=f"cell of {value}")

# Headers that mrcfile, which looks at no axes, opens with a warning: those in no
# order, and those without a number of intervals, where it divides by 0.
for name, at, words, turn in (
        ("no order", 64, [1, 1, 2], 1), ("axes unset", 64, [0, 0, 99], 1),
        ("from the top", 64, [1, -2, 3], -1), ("no intervals", 28, [0] * 3, 1)):
    with mrcfile.new("h.mrc", overwrite=True) as file:
        file.set_data(stack[0])
        file.set_volume()
        file.voxel_size = (2, 3, 4)
    oracle.patch("h.mrc", at, np.array(words, "<i4").tobytes())
    with mrcfile.open("h.mrc", permissive=True) as file:
        matrix = oracle.affine((2, 3 * turn, 4), (0, 12 if turn < 0 else 0, 0))
        oracle.expect("h.mrc", file.data, matrix, name=name)
a = oracle.sample("i1")
with mrcfile.new("f.mrc", overwrite=True) as file:
    file.set_data(a)
    file.set_volume()
    file.voxel_size = 1
oracle.patch("f.mrc", 152, np.array([1146047817, 0], "<i4").tobytes())
oracle.expect("f.mrc", a.view("u1"), name="IMOD, unsigned")
oracle.patch("f.mrc", 156, b"\1\0\0\0")
oracle.expect("f.mrc", a, name="IMOD, signed")
with mrcfile.new("g.mrc", overwrite=True) as file:
    file.set_data(np.zeros((2, 2, 2), np.complex64))
oracle.refuse("g.mrc", "mode 4")
oracle.finish()
