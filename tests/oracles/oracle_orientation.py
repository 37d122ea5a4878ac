"""One asymmetric volume, its axes permuted and turned around in all 48 ways,
in every format that can say so, gives the same voxels in the same places of the
world and the same picture; so it does in an oblique place.
"""
import itertools
import json
import os
import struct
import subprocess
import sys

try:
    import numpy as np
except ImportError as missing:
    print("skip  ", missing)
    sys.exit(77)

import oracle

place = oracle.folder()
# The footprint method, whose pictures do not depend on how the grid is numbered.
LOOK = ["-q", "-s", "48x48", "--method", "footprint", "--azimuth", "25", "--elevation", "20", "--view",
        "+y", "--range", "0,3000", "--preset", "linear", "--no-labels"]
TOLERANCE = "1/255"
# Under sanitizers one in five: all are read by the same code.
TURNS = list(itertools.product(itertools.permutations(range(3)),
                               itertools.product((1, -1), repeat=3)))
SHORT = os.environ.get("SNOW_TIER", "short") == "short"
TURNS = TURNS[::5 if SHORT or "SNOW_SANITIZED" in os.environ else 1]


def base():
    """Voxels [x, y, z] of a letter F with a ramp, each value but 0 once."""
    voxels = np.arange(1000, 1000 + 12 * 14 * 10).reshape(12, 14, 10)
    shape = np.zeros(voxels.shape, bool)
    shape[1:4, 1:13, 1:6] = True
    shape[4:11, 10:13, 1:8] = True
    shape[4:8, 5:8, 1:6] = True
    return np.where(shape, voxels, 0).astype(np.uint16)


def straight():
    matrix = np.diag([1.5, 1.25, 2.0, 1.0])
    matrix[:3, 3] = [-20, 31, 7]
    return matrix


def oblique():
    a, b, c = np.radians([20, -35, 50])
    x = np.array([[1, 0, 0], [0, np.cos(a), -np.sin(a)],
                  [0, np.sin(a), np.cos(a)]])
    y = np.array([[np.cos(b), 0, np.sin(b)], [0, 1, 0],
                  [-np.sin(b), 0, np.cos(b)]])
    z = np.array([[np.cos(c), -np.sin(c), 0], [np.sin(c), np.cos(c), 0],
                  [0, 0, 1]])
    matrix = straight()
    matrix[:3, :3] = x @ y @ z @ matrix[:3, :3]
    return matrix


def turned(voxels, matrix, order, signs):
    """The same voxels with new axis j the old order[j], backwards where
    signs[j] is -1; and the matrix that puts them where they were."""
    out = np.eye(4)
    new = voxels.transpose(order)
    out[:3, 3] = matrix[:3, 3]
    for j in range(3):
        column = matrix[:3, order[j]]
        if signs[j] < 0:
            new = np.flip(new, j)
            out[:3, 3] += column * (new.shape[j] - 1)
        out[:3, j] = column * signs[j]
    return new, out


def lines(m, columns=4):
    return [" ".join(repr(float(v)) for v in m[:3, j]) for j in range(columns)]


def raw(voxels):
    return voxels.tobytes(order="F")


def nrrd(space, flip):
    def write(voxels, matrix):
        m = np.diag([*flip, 1]) @ matrix
        vectors = ["(" + ",".join(line.split()) + ")" for line in lines(m)]
        header = (f"NRRD0004\ntype: uint16\ndimension: 3\nspace: {space}\n"
                  f"sizes: {' '.join(map(str, voxels.shape))}\n"
                  f"space directions: {' '.join(vectors[:3])}\n"
                  f"space origin: {vectors[3]}\n"
                  "endian: little\nencoding: raw\n\n")
        return "a.nrrd", header.encode() + raw(voxels)
    return write


def nifti(voxels, matrix):
    header = bytearray(352)
    struct.pack_into("<i", header, 0, 348)
    struct.pack_into("<8h", header, 40, 3, *voxels.shape, 1, 1, 1, 1)
    struct.pack_into("<hh", header, 70, 512, 16)
    spacing = np.linalg.norm(matrix[:3, :3], axis=0)
    struct.pack_into("<8f", header, 76, 1, *spacing, 1, 1, 1, 1)
    struct.pack_into("<fff", header, 108, 352, 1, 0)
    header[123] = 2  # millimetres
    struct.pack_into("<hh", header, 252, 0, 1)
    struct.pack_into("<12f", header, 280, *matrix[:3].ravel())
    header[344:348] = b"n+1\0"
    return "a.nii", bytes(header) + raw(voxels)


def quaternion(r):
    """Of a rotation, with a real part that is not negative."""
    values, vectors = np.linalg.eigh(np.array([
        [r[0, 0] + r[1, 1] + r[2, 2], r[2, 1] - r[1, 2], r[0, 2] - r[2, 0],
         r[1, 0] - r[0, 1]],
        [0, r[0, 0] - r[1, 1] - r[2, 2], r[1, 0] + r[0, 1],
         r[2, 0] + r[0, 2]],
        [0, 0, r[1, 1] - r[0, 0] - r[2, 2], r[2, 1] + r[1, 2]],
        [0, 0, 0, r[2, 2] - r[0, 0] - r[1, 1]]]), UPLO="U")
    q = vectors[:, np.argmax(values)]
    return q if q[0] >= 0 else -q


def nifti_qform(voxels, matrix):
    name, data = nifti(voxels, matrix)
    header = bytearray(data[:352])
    rotation = matrix[:3, :3] / np.linalg.norm(matrix[:3, :3], axis=0)
    if np.linalg.det(rotation) < 0:
        rotation[:, 2] *= -1
        struct.pack_into("<f", header, 76, -1)
    struct.pack_into("<hh", header, 252, 1, 0)
    struct.pack_into("<6f", header, 256, *quaternion(rotation)[1:],
                     *matrix[:3, 3])
    return name, bytes(header) + data[352:]


def metaimage(voxels, matrix):
    m = np.diag([-1, -1, 1, 1]) @ matrix
    spacing = np.linalg.norm(m[:3, :3], axis=0)
    unit = m.copy()
    unit[:3, :3] /= spacing
    header = ("ObjectType = Image\nNDims = 3\nBinaryData = True\n"
              "BinaryDataByteOrderMSB = False\nCompressedData = False\n"
              f"TransformMatrix = {' '.join(lines(unit, 3))}\n"
              f"Offset = {lines(m)[3]}\n"
              f"ElementSpacing = {' '.join(map(repr, map(float, spacing)))}\n"
              f"DimSize = {' '.join(map(str, voxels.shape))}\n"
              "ElementType = MET_USHORT\nElementDataFile = LOCAL\n")
    return "a.mha", header.encode() + raw(voxels)


def vti(voxels, matrix):
    spacing = np.linalg.norm(matrix[:3, :3], axis=0)
    direction = (matrix[:3, :3] / spacing).ravel()
    numbers = [" ".join(repr(float(v)) for v in vector)
               for vector in (matrix[:3, 3], spacing, direction)]
    x, y, z = (n - 1 for n in voxels.shape)
    values = " ".join(map(str, voxels.ravel(order="F")))
    return "a.vti", (
        '<?xml version="1.0"?>\n<VTKFile type="ImageData" version="1.0" '
        f'byte_order="LittleEndian"><ImageData WholeExtent="0 {x} 0 {y} 0 {z}"'
        f' Origin="{numbers[0]}" Spacing="{numbers[1]}" '
        f'Direction="{numbers[2]}"><Piece Extent="0 {x} 0 {y} 0 {z}">'
        '<PointData Scalars="a"><DataArray type="UInt16" Name="a" '
        f'format="ascii">{values}</DataArray></PointData></Piece></ImageData>'
        "</VTKFile>").encode()


# Name, writer, and whether pictures are made of all 48: what is read alike is
# drawn alike.
FORMATS = [
    ("nrrd RAS", nrrd("right-anterior-superior", [1, 1, 1]), True),
    ("nrrd LPS", nrrd("left-posterior-superior", [-1, -1, 1]), False),
    ("nrrd LAS", nrrd("left-anterior-superior", [-1, 1, 1]), False),
    ("nifti sform", nifti, True),
    ("nifti qform", nifti_qform, False),
    ("metaimage", metaimage, True),
    ("vti", vti, True),
]


def tool(*arguments):
    done = subprocess.run([oracle.TOOL, *arguments], capture_output=True,
                          text=True)
    return done.returncode, done.stdout, done.stderr.strip()


def where(path):
    """Value to place in the world, of all but 0, and the file's matrix."""
    code, told, error = tool("info", "-q", "--json", path)
    if code:
        return error
    matrix = np.array(json.loads(told)["matrix"])
    code, _, error = tool("convert", "-q", "-y", path, "-o", "b.npy")
    if code:
        return error
    voxels = np.load("b.npy").transpose()
    places = np.argwhere(voxels)
    values = voxels[tuple(places.T)]
    order = np.argsort(values)
    return values[order], (places @ matrix[:3, :3].T + matrix[:3, 3])[order]


def check(name, path, values, places, drawn):
    found = where(path)
    if isinstance(found, str):
        return oracle.fail(name, found)
    if not np.array_equal(found[0], values):
        return oracle.fail(name, "other values")
    gap = np.abs(found[1] - places).max()
    if gap > 1e-4:
        return oracle.fail(name, f"voxels are {gap} mm from their places")
    if not drawn:
        return None
    code, _, error = tool("render", path, "-y", "-o", "b.png", *LOOK)
    if code:
        return oracle.fail(name, error)
    code, told, error = tool("compare", "a.png", "b.png", "--tolerance",
                             TOLERANCE)
    return oracle.fail(name, told.replace("\n", "; ") + error) if code else None


def sweep(kind, matrix):
    voxels = base()
    places = np.argwhere(voxels)
    values = voxels[tuple(places.T)]
    places = places @ matrix[:3, :3].T + matrix[:3, 3]
    name, data = FORMATS[0][1](voxels, matrix)
    open(name, "wb").write(data)
    tool("render", name, "-y", "-o", "a.png", *LOOK)
    for format_name, write, drawn in FORMATS:
        for order, signs in TURNS:
            name, data = write(*turned(voxels, matrix, order, signs))
            open(name, "wb").write(data)
            oracle.checked += 1
            check(f"{format_name} {kind} {order} {signs}", name, values, places,
                  drawn)


sweep("straight", straight())
sweep("oblique", oblique())
oracle.finish()
