"""What the oracle_*.py share: the tool's figures of a file beside those that
an independent reader's voxels and matrix have, and files of all kinds.

An oracle is run as `python3 oracle_NAME.py TOOL DATA`, in an empty folder; it
exits with 77 when the independent reader is not installed.
"""
import gzip
import importlib
import itertools
import json
import os
import random
import re
import shutil
import struct
import subprocess
import sys
import tempfile


def skip(why):
    print("skip  ", why)
    sys.exit(77)


def need(*names):
    """Modules of Python; the oracle is skipped where one is not installed."""
    try:
        return [importlib.import_module(name) for name in names]
    except ImportError as missing:
        return skip(missing)


np, = need("numpy")
TOOL, DATA = map(os.path.abspath, sys.argv[1:3])
checked = wrong = files = 0
usual = np.eye(4)  # the matrix of a file that says nothing of it
TIER = os.environ.get("SNOW_TIER", "short") # docs/testing.md
SHORT, RELEASE = TIER == "short", TIER == "release"
place = tempfile.TemporaryDirectory()
os.chdir(place.name)


SANITIZED = "SNOW_SANITIZED" in os.environ
chance = random.Random(int(os.environ.get("SNOW_SEED", "1")))


def few(things, stride, start=0):
    """All of them; in the short tier one of `stride`, from number `start` on; under
    sanitizers, where the tool takes ten times as long to start, a third of these."""
    things = list(things)
    if SANITIZED:
        stride *= 3
        start = chance.randrange(min(stride, len(things)) or 1)
    return things[start % stride::stride] if SHORT else things


def by_chance():
    """Whether a file that is sound is looked at: under sanitizers a third, by chance;
    all of those that are damaged."""
    return not SANITIZED or chance.random() < 1 / 3


def doctor(key):
    """What the tool's build has: libraries, picture_outputs."""
    return json.loads(tool("doctor", "--json").stdout)[key]


def library(name):
    """The version of an optional library of the tool's, or None."""
    return doctor("libraries").get(name)


def need_modules():
    """Readers of modules are found by /proc/self/maps (src/base/module.c)."""
    if not os.access("/proc/self/maps", os.R_OK):
        skip("there is no /proc, and modules are not loaded without")


def fail(name, what):
    global wrong
    wrong += 1
    print(f"FAILED {name}: {what}")


def data(relative):
    """The path of a file of the real data, or None."""
    path = os.path.join(DATA, relative)
    return path if os.path.exists(path) else None


def tool(*arguments, **how):
    """The tool's end, and what it said."""
    return subprocess.run([TOOL, *map(str, arguments)], capture_output=True,
                          **{"text": True, **how})


def run(path, *options):
    return tool("info", "--json", path, *options)


def told(path, *options):
    """What info tells as JSON; nothing where the tool fails."""
    global checked
    checked += 1
    done = run(path, *options)
    if done.returncode:
        fail(path, done.stderr.strip())
    return {} if done.returncode else json.loads(done.stdout)


def tells(path, options=(), **wanted):
    """Info tells these values."""
    found = told(path, *options)
    for key, value in wanted.items():
        if found.get(key) != value:
            fail(path, f"{key} {found.get(key)!r}, not {value!r}")


def says(name, path, part, *options):
    """The remarks contain a part, or there are none where that is None."""
    global checked
    checked += 1
    done = run(path, *options)
    if done.returncode or (part not in done.stderr if part else done.stderr):
        fail(name, f"exit {done.returncode}, {done.stderr!r}, not {part!r}")


# --- files --------------------------------------------------------------------


def put(path, content):
    """Writes bytes or text."""
    with open(path, "wb") as file:
        file.write(content.encode() if isinstance(content, str) else content)
    return path


def got(path):
    with open(path, "rb") as file:
        return file.read()


def patch(path, at, content):
    """Replaces bytes from that one on, which counts from the end if below 0."""
    whole = bytearray(got(path))
    at %= len(whole)
    whole[at:at + len(content)] = content
    return put(path, bytes(whole))


def packed(path, to):
    """Writes a file packed by gzip."""
    return put(to, gzip.compress(got(path)))


def empty_folder(path):
    shutil.rmtree(path, ignore_errors=True)
    os.makedirs(path)


# --- volumes ------------------------------------------------------------------


def figures(voxels):
    """Those of `info`, in its order of summation but for rounding."""
    values = voxels.astype(np.float64).ravel()
    finite = np.isfinite(values)
    weights = (np.arange(values.size) % 1009 + 1)[finite]
    values = values[finite]
    return {"finite": int(values.size), "min": values.min(),
            "max": values.max(), "sum": values.sum(),
            "wsum": (values * weights).sum(),
            "scale": np.abs(values).sum() * 1009}


def wide(voxels):
    """As the tool keeps them: in the machine's order, halves as float32 and
    truth as 0 and 1."""
    kind = {"f2": "f4", "b1": "u1"}.get(voxels.dtype.str[1:])
    return voxels.astype(kind or voxels.dtype.newbyteorder("="))


def magnitude(voxels):
    """The length of vectors along the last axis, rounded after each one."""
    total = np.abs(voxels[..., 0])
    for i in range(1, voxels.shape[-1]):
        total = np.hypot(total.astype("f8"), voxels[..., i].astype("f8"))
        total = total.astype(voxels.dtype.newbyteorder("="))
    return total


def same_figures(name, found, wanted):
    for key in ("min", "max", "sum", "wsum", "finite"):
        if abs(found[key] - wanted[key]) > 1e-12 * wanted["scale"] + 1e-300:
            fail(name, f"{key} {found[key]}, not {wanted[key]}")


def expect(path, voxels, matrix=None, options=(), dtype=None, unit=None,
           name=None):
    """The file is these voxels (z, y, x), of this type, in this place.  So is the
    whole of each third file as a box, and a box of the others (in the short tier: of
    each third; in the release tier: of all)."""
    global files
    if not by_chance():
        return
    matrix = usual if matrix is None else np.asarray(matrix, float)
    name = name or " ".join([os.path.basename(path), *map(str, options)])
    more = figures(voxels), matrix, dtype or voxels.dtype, unit
    if not expect_one(path, name, options, voxels, *more):
        return
    files += 1
    if files % 3 == 1:
        expect_one(path, name, [*options, "--crop", ":,:,:"], voxels, *more)
    if files % 3 == 0 or files % 3 == 2 and not SHORT or RELEASE:
        expect_box(path, name, options, voxels, *more[1:])


def expect_one(path, name, options, voxels, wanted, matrix, dtype, unit):
    global checked
    checked += 1
    before = wrong
    done = run(path, *options)
    if done.returncode:
        return fail(name, done.stderr.strip())
    found, dims = json.loads(done.stdout), list(voxels.shape[::-1])
    if found["dims"] != dims:
        return fail(name, f"dims {found['dims']}, not {dims}")
    if found["type"] != np.dtype(dtype).name:
        fail(name, f"type {found['type']}, not {np.dtype(dtype).name}")
    same_figures(name, found, wanted)
    if not np.allclose(found["matrix"], matrix, rtol=1e-6, atol=1e-7):
        fail(name, f"matrix\n{np.array(found['matrix'])}, not\n{matrix}")
    if unit is not None and found["unit"] != unit:
        fail(name, f"unit {found['unit']!r}, not {unit!r}")
    return wrong == before


def expect_box(path, name, options, voxels, matrix, dtype, unit):
    """A box in the middle of the file, where it was."""
    first = [size // 3 for size in voxels.shape[::-1]]
    end = [max(size - size // 4, low + 1)
           for size, low in zip(voxels.shape[::-1], first)]
    box = ",".join(f"{low}:{high}" for low, high in zip(first, end))
    (x, y, z), (i, j, k) = first, end
    moved = matrix.copy()
    moved[:3, 3] += matrix[:3, :3] @ first
    part = voxels[z:k, y:j, x:i]
    expect_one(path, f"{name} box {box}", [*options, "--crop", box], part,
               figures(part), moved, dtype, unit)


def refuse(path, part, options=(), status=3):
    """The file is refused with a message that contains `part`."""
    global checked
    checked += 1
    done = run(path, *options)
    if done.returncode != status or part not in done.stderr:
        fail(os.path.basename(path), f"exit {done.returncode}, not {status}; "
             f"{done.stderr.strip()!r} lacks {part!r}")


def refuse_cut(path, sizes, part):
    """So is a copy of the file, cut to each of these sizes."""
    whole = got(path)
    for size in sizes:
        refuse(put("cut" + os.path.splitext(path)[1], whole[:size]), part)


def voxels_of(path, options=()):
    """The voxels that are stored (z, y, x), and the upper rows of the matrix;
    None where the tool fails.  A box has those of the whole."""
    found = told(path, *options)
    made = tool("convert", "-q", "-y", path, "-o", "out.npy", *options)
    if not found or made.returncode:
        if found:
            fail(path, made.stderr.strip())
        return None, None
    values = np.load("out.npy")
    if list(values.shape[::-1]) != found["dims"]:
        fail(path, f"dims {found['dims']}, but the file has {values.shape}")
    return values, np.array(found["matrix"])[:3]


def converted(path, options=()):
    """As voxels_of, of a large volume whose axes have one unit: both are of one NRRD,
    since info looks at all voxels again, to tell how sparse they are."""
    global checked
    checked += 1
    made = tool("convert", "-q", "-y", path, "-o", "out.nrrd", *options)
    if made.returncode:
        fail(path, made.stderr.strip())
        return None, None
    text, _, voxels = got("out.nrrd").partition(b"\n\n")
    says = dict(line.split(": ", 1) for line in text.decode().splitlines()[1:]
                if ": " in line)
    numbers = lambda key: np.array(re.findall(r"[^ (),]+", says[key]), float)
    names = {"float": "f4", "double": "f8"}
    values = np.frombuffer(voxels, names.get(says["type"], says["type"]))
    matrix = [*numbers("space directions"), *numbers("space origin")]
    return (values.reshape(numbers("sizes").astype(int)[::-1]),
            np.reshape(matrix, (4, 3)).T)


def world(values, matrix):
    """Where each voxel lies: x, y and z."""
    z, y, x = np.indices(values.shape)
    return [matrix[i, 0] * x + matrix[i, 1] * y + matrix[i, 2] * z +
            matrix[i, 3] for i in range(3)]


def affine(step, origin=(0, 0, 0), direction=None):
    matrix = np.eye(4)
    turn = np.eye(3) if direction is None else np.asarray(direction, float)
    matrix[:3, :3] = turn @ np.diag(step)
    matrix[:3, 3] = origin
    return matrix


def image(step=(1, 1, 1), origin=(0, 0, 0)):
    """The place of an image, whose row 0 is the top and slice 0 in front."""
    return np.diag([1, -1, -1, 1]) @ affine(step, origin)


def sample(dtype, shape=(7, 6, 5), seed=1):
    """Random values over the whole range of the type."""
    random = np.random.default_rng(seed)
    dtype = np.dtype(dtype)
    if dtype.kind == "b":
        return random.integers(0, 2, shape).astype(bool)
    if dtype.kind in "iu":
        limits = np.iinfo(dtype)
        values = random.integers(limits.min, limits.max, shape,
                                 dtype=np.dtype(dtype.newbyteorder("=")),
                                 endpoint=True)
        return values.astype(dtype)
    return (random.standard_normal(shape) * 100).astype(dtype)


# --- one volume in all directions ---------------------------------------------

TURNS = list(itertools.product(itertools.permutations(range(3)),
                               itertools.product((1, -1), repeat=3)))


def turned(voxels, matrix, order, signs):
    """The same voxels [x, y, z] with new axis j the old order[j], backwards
    where signs[j] is -1; and the matrix that puts them where they were."""
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


def rotation(*degrees):
    """About x, then y, then z."""
    a, b, c = np.radians(degrees)
    return (np.array([[1, 0, 0], [0, np.cos(a), -np.sin(a)],
                      [0, np.sin(a), np.cos(a)]]) @
            np.array([[np.cos(b), 0, np.sin(b)], [0, 1, 0],
                      [-np.sin(b), 0, np.cos(b)]]) @
            np.array([[np.cos(c), -np.sin(c), 0], [np.sin(c), np.cos(c), 0],
                      [0, 0, 1]]))


def nifti(voxels, matrix, code=512):
    """The bytes of a file with an sform, in mm, of voxels [x, y, z]; code 512:
    uint16, 16: float32, 4: int16, 128: colours [x, y, z, 3]."""
    header = bytearray(352)
    bits = 24 if code == 128 else 8 * voxels.itemsize
    struct.pack_into("<i", header, 0, 348)
    struct.pack_into("<8h", header, 40, 3, *voxels.shape[:3], 1, 1, 1, 1)
    struct.pack_into("<hh", header, 70, code, bits)
    spacing = np.linalg.norm(matrix[:3, :3], axis=0)
    struct.pack_into("<8f", header, 76, 1, *spacing, 1, 1, 1, 1)
    struct.pack_into("<fff", header, 108, 352, 1, 0)
    header[123] = 2
    struct.pack_into("<hh", header, 252, 0, 1)
    struct.pack_into("<12f", header, 280, *matrix[:3].ravel())
    header[344:348] = b"n+1\0"
    if code == 128:
        voxels = np.moveaxis(voxels, 3, 0)
    return bytes(header) + voxels.tobytes(order="F")


def nrrd(kind, shape, fields, data):
    """The bytes of a little-endian file; shape as in its header."""
    return (f"NRRD0004\ntype: {kind}\ndimension: {len(shape)}\nsizes: "
            f"{' '.join(map(str, shape))}\nendian: little\n{fields}"
            "encoding: raw\n\n").encode() + data


def finish():
    print(f"{checked} checks, {wrong} wrong")
    sys.exit(1 if wrong or not checked else 0)
