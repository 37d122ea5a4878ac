"""One asymmetric volume, its axes permuted and turned around in all 48 ways,
in every format that can say so, gives the same voxels in the same places of the
world and the same picture; so it does in an oblique place.
"""
import os
import struct

import oracle
from oracle import np

# The footprint method, whose pictures do not depend on how the grid is numbered.
LOOK = ["-q", "-s", "48x48", "--method", "footprint", "--azimuth", "25",
        "--elevation", "20", "--view", "+y", "--range", "0,3000", "--preset",
        "linear", "--no-labels"]
TOLERANCE = "1/255"
# One in five of most formats, which are read by the same code; the formats together
# have all.  All of these two, the second of which turns quaternions into directions,
# but in the short tier and under sanitizers.
FEW = oracle.SHORT or oracle.SANITIZED
WHOLE = ("nrrd RAS", "nifti qform")


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
    matrix = straight()
    matrix[:3, :3] = oracle.rotation(20, -35, 50) @ matrix[:3, :3]
    return matrix


def lines(m, columns=4):
    return [" ".join(repr(float(v)) for v in m[:3, j]) for j in range(columns)]


def raw(voxels):
    return voxels.tobytes(order="F")


def nrrd(space, flip):
    def write(voxels, matrix):
        m = np.diag([*flip, 1]) @ matrix
        vectors = ["(" + ",".join(line.split()) + ")" for line in lines(m)]
        return "a.nrrd", oracle.nrrd(
            "uint16", voxels.shape,
            f"space: {space}\nspace directions: {' '.join(vectors[:3])}\n"
            f"space origin: {vectors[3]}\n", raw(voxels))
    return write


def nifti(voxels, matrix):
    return "a.nii", oracle.nifti(voxels, matrix)


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


def where(voxels, matrix):
    """Value to place in the world, of all voxels [x, y, z] but 0."""
    places = np.argwhere(voxels)
    values = voxels[tuple(places.T)]
    order = np.argsort(values)
    return values[order], (places @ matrix[:3, :3].T + matrix[:3, 3])[order]


def check(name, path, values, places, drawn):
    voxels, matrix = oracle.voxels_of(path)
    if voxels is None:
        return
    found = where(voxels.transpose(), matrix)
    if not np.array_equal(found[0], values):
        return oracle.fail(name, "other values")
    gap = np.abs(found[1] - places).max()
    if gap > 1e-4:
        return oracle.fail(name, f"voxels are {gap} mm from their places")
    if not drawn:
        return
    oracle.tool("render", path, "-y", "-o", "b.png", *LOOK, check=True)
    done = oracle.tool("compare", "a.png", "b.png", "--tolerance", TOLERANCE)
    if done.returncode:
        oracle.fail(name, done.stdout.replace("\n", "; ") + done.stderr)


def sweep(kind, matrix):
    voxels = base()
    values, places = where(voxels, matrix)
    name, data = FORMATS[0][1](voxels, matrix)
    oracle.tool("render", oracle.put(name, data), "-y", "-o", "a.png", *LOOK)
    for n, (format_name, write, drawn) in enumerate(FORMATS):
        whole = oracle.RELEASE or not FEW and format_name in WHOLE and kind == "straight"
        step = 1 if whole else 15 if oracle.SANITIZED else 5
        for order, signs in oracle.TURNS[n % step::step]:
            name, data = write(*oracle.turned(voxels, matrix, order, signs))
            check(f"{format_name} {kind} {order} {signs}",
                  oracle.put(name, data), values, places, drawn)


sweep("straight", straight())
sweep("oblique", oblique())
oracle.finish()
