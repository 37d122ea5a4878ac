"""What the oracle_*.py share: the tool's figures of a file beside those that
an independent reader's voxels and matrix have.

An oracle is run as `python3 oracle_NAME.py TOOL DATA`; it exits with 77 when
the independent reader is not installed.
"""
import json
import os
import subprocess
import sys
import tempfile

import numpy as np

TOOL, DATA = os.path.abspath(sys.argv[1]), sys.argv[2]
checked = wrong = 0
usual = np.eye(4)  # the matrix of a file that says nothing of it
SHORT = os.environ.get("SNOW_TIER", "short") == "short" # docs/testing.md


def few(things, stride, start=0):
    """All of them; in the short tier one of `stride`, from number `start` on."""
    things = list(things)
    return things[start % stride::stride] if SHORT else things


def skip(why):
    print("skip  ", why)
    sys.exit(77)


def library(name):
    """The version of an optional library of the tool's, or None."""
    told = subprocess.run([TOOL, "doctor", "--json"], capture_output=True)
    return json.loads(told.stdout)["libraries"].get(name)


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


def run(path, *options):
    return subprocess.run([TOOL, "info", "--json", path, *map(str, options)],
                          capture_output=True, text=True)


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


def magnitude(voxels):
    """The length of vectors along the last axis, rounded after each one."""
    total = np.abs(voxels[..., 0])
    for i in range(1, voxels.shape[-1]):
        total = np.hypot(total.astype("f8"), voxels[..., i].astype("f8"))
        total = total.astype(voxels.dtype.newbyteorder("="))
    return total


def near(a, b, scale):
    return abs(a - b) <= 1e-12 * scale + 1e-300


def expect(path, voxels, matrix=None, options=(), dtype=None, unit=None,
           name=None):
    """The file is these voxels (z, y, x), of this type, in this place; and so
    is a box of it, when nothing else was wrong (in the short tier: of each third
    file)."""
    global checked
    checked += 1
    before = wrong
    matrix = usual if matrix is None else np.asarray(matrix, float)
    if "--crop" not in options:
        expect(path, voxels, matrix, [*options, "--crop", ":,:,:"], dtype,
               unit, name)
        if wrong == before and (checked % 3 == 0 or not SHORT):
            expect_box(path, voxels, matrix, options, dtype, unit, name)
        return
    name = name or " ".join([os.path.basename(path), *map(str, options)])
    done = run(path, *options)
    if done.returncode:
        return fail(name, done.stderr.strip())
    told, wanted = json.loads(done.stdout), figures(voxels)
    dims = list(voxels.shape[::-1])
    if told["dims"] != dims:
        return fail(name, f"dims {told['dims']}, not {dims}")
    dtype = np.dtype(dtype or voxels.dtype).name
    if told["type"] != dtype:
        fail(name, f"type {told['type']}, not {dtype}")
    for key in ("min", "max", "sum", "wsum", "finite"):
        if not near(told[key], wanted[key], wanted["scale"]):
            fail(name, f"{key} {told[key]}, not {wanted[key]}")
    if not np.allclose(told["matrix"], matrix, rtol=1e-6, atol=1e-7):
        fail(name, f"matrix\n{np.array(told['matrix'])}, not\n{matrix}")
    if unit is not None and told["unit"] != unit:
        fail(name, f"unit {told['unit']!r}, not {unit!r}")


def expect_box(path, voxels, matrix, options, dtype, unit, name):
    """A box in the middle of the file, where it was."""
    first = [size // 3 for size in voxels.shape[::-1]]
    end = [max(size - size // 4, low + 1)
           for size, low in zip(voxels.shape[::-1], first)]
    box = ",".join(f"{low}:{high}" for low, high in zip(first, end))
    (x, y, z), (i, j, k) = first, end
    moved = matrix.copy()
    moved[:3, 3] += matrix[:3, :3] @ first
    expect(path, voxels[z:k, y:j, x:i], moved, [*options, "--crop", box],
           dtype, unit, f"{name or os.path.basename(path)} box {box}")


def refuse(path, part, options=(), status=3):
    """The file is refused with a message that contains `part`."""
    global checked
    checked += 1
    done = run(path, *options)
    if done.returncode != status or part not in done.stderr:
        fail(os.path.basename(path), f"exit {done.returncode}, not {status}; "
             f"{done.stderr.strip()!r} lacks {part!r}")


def voxels_of(path, options=()):
    """The voxels that are stored (z, y, x), and the upper rows of the matrix;
    None where the tool fails.  A box has those of the whole."""
    global checked
    checked += 1
    done = run(path, *options)
    made = subprocess.run([TOOL, "convert", "-q", "-y", path, "-o", "out.npy",
                           *map(str, options)], capture_output=True, text=True)
    if done.returncode or made.returncode:
        fail(path, done.stderr.strip() or made.stderr.strip())
        return None, None
    found = json.loads(done.stdout)
    values = np.load("out.npy")
    if list(values.shape[::-1]) != found["dims"]:
        fail(path, f"dims {found['dims']}, but the file has {values.shape}")
    return values, np.array(found["matrix"])[:3]


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


def folder():
    place = tempfile.TemporaryDirectory()
    os.chdir(place.name)
    return place


def finish():
    print(f"{checked} checks, {wrong} wrong")
    sys.exit(1 if wrong or not checked else 0)
