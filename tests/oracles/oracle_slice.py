"""The verb slice beside slices of NumPy arrays: each axis and direction, the
place and the number of a slice, spacing, sizes, kernels, values that are
missing, looks, labels and oblique grids.
"""
import json
import os
import struct
import warnings

import oracle
from oracle import np

PATIENT = ("sagittal", "coronal", "axial")


def check(name, good):
    oracle.checked += 1
    if not good:
        oracle.fail(name, "is something else")


def run(path, *options, out="out.npy"):
    if os.path.exists(out):
        os.remove(out)
    return oracle.tool("slice", path, "-o", out, *options)


def values(path, *options):
    """The picture in data units, or None after a failure."""
    done = run(path, *options)
    if done.returncode:
        oracle.fail(f"{path} {options}", done.stderr.strip())
        return np.full((1, 1), np.nan)
    return np.load("out.npy")


def nifti(name, voxels, matrix, code=512):
    return oracle.put(name, oracle.nifti(voxels, matrix, code))


def plane(voxels, axis, index, medical=True):
    """Of voxels [x, y, z] along right, front and head: row 0 is the top.  The
    patient's left is at the right of the picture, or the front at the left of
    it; without a patient x is at the right, or y, and y or z is up."""
    flat = np.take(voxels, index, axis).T[::-1]
    return flat[:, ::-1] if medical else flat


def tent(pixels, pitch, voxels, step):
    """Weights [pixel, voxel] of a row of pixels about the middle of voxels."""
    places = (np.arange(pixels) + 0.5 - pixels / 2) * pitch / step
    places = places + (voxels - 1) / 2
    reach = max(1.0, pitch / step)
    weights = 1 - np.abs(places[:, None] - np.arange(voxels)[None]) / reach
    weights = np.maximum(weights, 0)
    weights[(places < -0.5) | (places > voxels - 0.5)] = 0
    return weights


def scaled(flat, steps, width, height, least=0.5):
    """The reference: the whole slice in a picture of that size.  A pixel has no
    value where less than this share of the weight is of voxels with one."""
    rows, columns = flat.shape
    pitch = max(columns * steps[0] / width, rows * steps[1] / height)
    across = tent(width, pitch, columns, steps[0])
    down = tent(height, pitch, rows, steps[1])
    known = np.isfinite(flat)
    share = down @ known @ across.T
    whole = np.outer(down.sum(1), across.sum(1))
    with np.errstate(invalid="ignore", divide="ignore"):
        made = down @ np.where(known, flat, 0) @ across.T / share
    made[~(share >= least * whole) | (whole == 0)] = np.nan
    return made


def is_scaled(got, flat, steps, width, height):
    """Within 0.01, and within rounding of what has a value."""
    more = scaled(flat, steps, width, height, 0.5 - 1e-6)
    less = scaled(flat, steps, width, height, 0.5 + 1e-6)
    if got.shape != more.shape:
        return False
    known = np.isfinite(got)
    return (np.isfinite(more) >= known).all() and \
        (np.isfinite(less) <= known).all() and \
        (np.abs(got - more)[known] <= 0.01).all() and known.any()


def near(a, b, tolerance):
    return (a.shape == b.shape and np.array_equal(np.isnan(a), np.isnan(b)) and
            np.nanmax(np.abs(a - b), initial=0) <= tolerance)


random = np.random.default_rng(3)
VOXELS = random.integers(0, 4000, (12, 14, 10)).astype(np.uint16)
SPACING = (1.5, 1.5, 1.5)
MATRIX = np.diag([*SPACING, 1.0])
MATRIX[:3, 3] = [-20, 31, 7]

# Every numbering of the grid gives the slices of the patient; numbers of slices
# count in the grid, positions in the world.
for order, signs in oracle.few(oracle.TURNS, 5):
    new, matrix = oracle.turned(VOXELS, MATRIX, order, signs)
    path = nifti("turned.nii", new, matrix)
    for world, name in enumerate(PATIENT):
        grid = order.index(world)
        index = VOXELS.shape[world] // 3
        number = index if signs[grid] > 0 else VOXELS.shape[world] - 1 - index
        wanted = plane(VOXELS, world, index)
        told = f"{name} of axes {order} {signs}"
        check(told, np.array_equal(
            values(path, "--axis", name, "--at", str(number)), wanted))
        check(f"{told} by its grid axis", np.array_equal(
            values(path, "--axis", "xyz"[grid], "--at", str(number)), wanted))
        at = MATRIX[world, 3] + 1.5 * index + 0.7
        check(f"{told} by its position", np.array_equal(
            values(path, "--axis", name, "--at", f"{at}mm"), wanted))

# The default is the middle axial slice.
path = nifti("a.nii", VOXELS, MATRIX)
check("the default", np.array_equal(values(path), plane(VOXELS, 2, 5)))

# Without a patient, x is at the right and y or z up.
np.save("a.npy", VOXELS.transpose())
for world, name in enumerate(PATIENT):
    wanted = plane(VOXELS, world, 4, medical=False)
    for called in (name, "xyz"[world]):
        check(f"{called} of an array", np.array_equal(
            values("a.npy", "--axis", called, "--at", "4"), wanted))

# Row 0 of an image is the top, and its slice 0 in front, as in Fiji.
try:
    import tifffile
    tifffile.imwrite("a.tif", VOXELS.transpose())
    check("an image", np.array_equal(values("a.tif", "--at", "4"),
                                     VOXELS[:, :, 4].T))
except ImportError as missing:
    print("skip   an image:", missing)

# Pixels are as large as the smaller spacing; sizes scale to fit.
matrix = np.diag([0.75, 1.0, 2.5, 1.0])
path = nifti("spaced.nii", VOXELS, matrix)
for world, name in enumerate(PATIENT):
    flat = plane(VOXELS, world, 3).astype(float)
    steps = [np.diag(matrix)[i] for i in range(3) if i != world]
    rows, columns = flat.shape
    own = (round(columns * steps[0] / min(steps)),
           round(rows * steps[1] / min(steps)))
    got = values(path, "--axis", name, "--at", "3")
    pitch = min(steps)
    weights = (tent(own[1], pitch, rows, steps[1]),
               tent(own[0], pitch, columns, steps[0]))
    check(f"{name}: its own size", got.shape == own[::-1])
    # The reference has a pixel of its own for the size that it is given.
    made = weights[0] @ flat @ weights[1].T
    made /= np.outer(weights[0].sum(1), weights[1].sum(1))
    check(f"{name}: linear between voxels", near(got, made, 0.01))
    for width, height in ((50, 40), (40, 64), (7, 5), (3, 9)):
        got = values(path, "--axis", name, "--at", "3", "-s",
                     f"{width}x{height}")
        check(f"{name} of {width}x{height}",
              is_scaled(got, flat, steps, width, height))
    got = values(path, "--axis", name, "--at", "3", "-s", "61", "--kernel",
                 "box")
    check(f"{name}: nearest voxels are values", set(
        got[np.isfinite(got)].tolist()) <= set(flat.ravel().tolist()))

# What has no value has none in the picture.
holes = VOXELS.astype(np.float32)
holes[random.random(holes.shape) < 0.3] = np.nan
holes[4, 5, 6] = np.inf
path = nifti("holes.nii", holes, matrix, 16)
flat = plane(np.where(np.isfinite(holes), holes, np.nan), 2, 6)
got = values(path, "--at", "6")
# The own size of this slice is 12 by 19 pixels: a pixel is 0.75 mm.
check("holes", is_scaled(got, flat.astype(float), (0.75, 1.0), 12, 19))
got = values(path, "--at", "6", "-s", "100x90")
check("holes, enlarged",
      is_scaled(got, flat.astype(float), (0.75, 1.0), 100, 90))

# A slab is the maximum, mean or minimum of the slices within half of its
# thickness, of those that there are.
FOLDED = {"max": np.nanmax, "mean": np.nanmean, "min": np.nanmin}
real = np.where(np.isfinite(holes), holes, np.nan).astype(float)
for path, whole in ((nifti("a.nii", VOXELS, MATRIX), VOXELS.astype(float)),
                    (nifti("full.nii", holes, MATRIX, 16), real)):
    for world, name in enumerate(PATIENT):
        for kind, fold in FOLDED.items():
            for index, thickness, half in ((5, "7.6mm", 2), (1, "6mm", 2),
                                           (4, "5.9mm", 1), (3, "5", 2),
                                           (2, "1mm", 0), (6, "1e9mm", 99)):
                part = np.take(whole, range(max(0, index - half), min(
                    whole.shape[world], index + half + 1)), world)
                with warnings.catch_warnings():
                    warnings.simplefilter("ignore")  # all NaN
                    flat = fold(part, world, keepdims=True)
                told = f"{name} {index} of {path}, {thickness}:{kind}"
                check(told, near(values(
                    path, "--axis", name, "--at", str(index), "--slab",
                    f"{thickness}:{kind}"), plane(flat, world, 0), 0.0005))
check("a slab is a maximum", np.array_equal(
    values("a.nii", "--slab", "3mm", "--at", "5"),
    values("a.nii", "--slab", "3mm:max", "--at", "5")))
oracle.tool("slice", "-", "-o", "out.npy", "-y", "-q", "--at", "4", "--slab",
            "3mm:min", input=oracle.got("a.nii"), text=False)
check("a slab of a pipe", np.array_equal(
    np.load("out.npy"), plane(VOXELS[:, :, 3:6].min(2, keepdims=True), 2, 0)))
oracle.tool("slice", "a.nii", "-o", "s_%d.npy", "-y", "-q", "--at", "2:5",
            "--slab", "3mm:mean")
check("slabs of a series", all(near(np.load(f"s_{n}.npy"), plane(
    VOXELS[:, :, n + 1:n + 4].mean(2, keepdims=True), 2, 0), 0.0005)
    for n in range(3)))
for more in (["-o", "s_%d.npy", "--at", "0:3"], ["-o", "s.png", "--grid", "2x1"]):
    done = oracle.tool("slice", "a.nii", "-y", "--slab", "3", *more)
    check(f"the slab of {more[-1]} is told", "; maximum of 3 slices" in done.stderr)
for wrong in ("3s", "0mm", "-3mm", "3mm:sum", "nan", "mm", ""):
    done = run("a.nii", "--slab", wrong)
    check(f"no slab of {wrong!r}", done.returncode == 2 and
          "--slab" in done.stderr)

# A grid that no axis of the world follows: its own slice, seen the nearest way.
oblique = MATRIX.copy()
oblique[:3, :3] = oracle.rotation(20, -15, 10) @ MATRIX[:3, :3]
for order, signs in oracle.few(oracle.TURNS, 9, 2):
    new, matrix = oracle.turned(VOXELS, oblique, order, signs)
    path = nifti("oblique.nii", new, matrix)
    for world, name in enumerate(PATIENT):
        grid = order.index(world)
        number = 4 if signs[grid] > 0 else VOXELS.shape[world] - 5
        got = values(path, "--axis", name, "--at", str(number))
        check(f"{name} of an oblique grid {order} {signs}",
              np.array_equal(got, plane(VOXELS, world, 4)))
done = run("oblique.nii", "--axis", "axial")
check("a note on it", "degrees off axial" in done.stderr)

# Slices that are shifted against each other (a tilted gantry).
tilted = np.diag([1.0, 1.0, 2.0, 1.0])
tilted[1, 2] = 0.6
path = nifti("tilted.nii", VOXELS, tilted)
for index in (0, 9):
    check(f"slice {index} of a tilted gantry", np.array_equal(
        values(path, "--at", str(index)), plane(VOXELS, 2, index)))
    # All of it is read, and not just a slice.
    oracle.tool("slice", "-", "-o", "out.npy", "-y", "-q", "--at", index,
                input=oracle.got(path), text=False)
    check(f"slice {index} of a pipe", np.array_equal(
        np.load("out.npy"), plane(VOXELS, 2, index)))
got = values(path, "--axis", "coronal", "--at", "3", "--kernel", "box")
check("a coronal one is as high as its slanted columns",
      got.shape == (round(10 * np.hypot(0.6, 2)), 12) and
      set(got.ravel()) == set(plane(VOXELS, 1, 3).ravel().astype(float)))

# Colours: opaque, whatever the opacity.
path = nifti("b.nii", (VOXELS.astype(np.int32) - 1500).astype(np.int16),
             MATRIX, 4)
flat = plane(VOXELS, 2, 5).astype(float) - 1500
native = flat


def same_picture(name, options, pixels, tolerance):
    """A PNG of 16 bits is that of the float pixels of the reference."""
    done = run(path, "--bits", "16", "--no-labels", *options, out="out.png")
    np.save("wanted.npy", pixels.astype(np.float32))
    other = oracle.tool("compare", "out.png", "wanted.npy", "--tolerance",
                        tolerance)
    oracle.checked += 1
    if done.returncode or other.returncode:
        oracle.fail(name, done.stderr + other.stdout + other.stderr)


def same_colors(name, options, grey, alpha=None):
    alpha = np.ones_like(grey) if alpha is None else alpha
    same_picture(name, ("--background", "none", *options),
                 np.stack([grey * alpha] * 3 + [alpha], -1), 0.00002)


def ramp(low, high):
    return np.clip((flat - low) / (high - low), 0, 1)


same_colors("a window", ("-w", "400,40"), ramp(-160, 240))
same_colors("a range", ("--range", "-1000,2000"), ramp(-1000, 2000))
same_colors("all values", ("--range", "full"), ramp(flat.min(), flat.max()))
with np.errstate(invalid="ignore"):
    logarithm = np.clip(np.log10(np.maximum(flat, 1e-9) / 10) / 2, 0, 1)
same_colors("a logarithm", ("--scale", "log", "--range", "10,1000"), logarithm,
            (flat > 0).astype(float))
look = {"colors": [[0, 0.2, 0.2, 0.2], [500, 0.2, 0.2, 0.2],
                   [500, 0.6, 0.6, 0.6], [900, 0.6, 0.6, 0.6],
                   [900, 1, 1, 1], [1000, 1, 1, 1]],
        "opacity": [[0, 0], [1000, 0.5]]}
oracle.put("labels.csv", "value,r,g,b,a\n" + "".join(
           f"{value},{r},{g},{b},{value / 2000}\n"
           for value, r, g, b in look["colors"]))
steps = np.where(flat < 500, 0.2, np.where(flat < 900, 0.6, 1.0))
same_colors("labels", ("--tf", "labels.csv"), steps)
big = np.kron(steps, np.ones((4, 4)))
same_colors("labels, enlarged, have no values in between",
            ("--tf", "labels.csv", "-s", "48x56"), big)

# A window leaves out the fewest values at an end, at most three or 0.01 %, if it
# shrinks four times, and at most 1 % if it shrinks a thousand times.
noise = random.normal(100, 20, 128 * 128)
for name, low, high in (("a hot pixel", [], [1e6]), ("none", [], []),
                        ("three of them", [], [1e6, 9e5, 8e5]),
                        ("two of two kinds", [], [1e6, 3e3]),
                        ("a cold and a hot one", [-1e6], [1e6]),
                        ("1 % of them", [], 1e6 + np.arange(163))):
    found = np.sort(np.concatenate([low, noise[:16384 - len(low) - len(high)],
                                     high])).astype(np.float32)
    order = random.permutation(16384)
    path, flat = "hot.npy", found[order].reshape(128, 128)[::-1].astype(float)
    np.save(path, found[order].reshape(1, 128, 128))
    low, high = found[len(low)], found[len(found) - 1 - len(high)]
    same_colors(name, (), ramp(float(low), float(high)))
for name, high in (("four of them", [400] * 4), ("2 %", [1e6] * 330),
                   ("a bright one", [600])):
    found = np.concatenate([noise[:16384 - len(high)], high])
    path, flat = "hot.npy", found.reshape(128, 128)[::-1].astype(np.float32)
    np.save(path, found.reshape(1, 128, 128).astype(np.float32))
    same_colors(f"not {name}", (), ramp(flat.min(), flat.max()))

# An overlay: labels half, or as asked, over the grey slice, by their nearest
# voxels; values in their colours, with opacities linear between the points.
path, flat = "b.nii", native
grey = ramp(-1500, 2500)
cells = np.zeros(VOXELS.shape, np.uint8)
cells[2:7, 3:9, 4:8] = 1
cells[7:10, 5:12, 2:7] = 2
INKS = np.array([[0, 0, 0], [1, 0, 0], [0, 0.2, 1]])


def nrrd(name, voxels, more=""):
    """On the grid of b.nii, with x the other way."""
    kind = {"u1": "uint8", "f4": "float"}[voxels.dtype.str[1:]]
    oracle.put(name, oracle.nrrd(
        kind, (12, 14, 10),
        "space: RAS\nspace directions: (-1.5,0,0) (0,1.5,0) (0,0,1.5)\n"
        f"space origin: ({-20 + 11 * 1.5},31,7)\n{more}",
        voxels[::-1].tobytes(order="F")))


def overlaid(name, options, inks, share):
    made = share * inks + (1 - share) * grey[..., None]
    same_picture(name, ("--range", "-1500,2500", "--overlay", *options),
                 np.concatenate([made, np.ones(grey.shape + (1,))], -1),
                 0.00005)


nrrd("cells.nrrd", cells, "".join(
    f"Segment{n}_LabelValue:={n + 1}\nSegment{n}_Color:={r} {g} {b}\n"
    for n, (r, g, b) in enumerate(INKS[1:])))
flat = plane(cells, 2, 5)
seen = (flat > 0)[..., None]
overlaid("labels over a slice", ("cells.nrrd",), INKS[flat], 0.5 * seen)
overlaid("one of them", ("cells.nrrd", "--labels", "2"), INKS[flat],
         0.5 * (flat == 2)[..., None])
overlaid("as opaque as is asked",
         ("cells.nrrd", "--overlay-look", "1:0.25,2:1"), INKS[flat],
         np.array([0, 0.25, 1])[flat][..., None])
both, once = 1 + cells % 2, grey
nrrd("both.nrrd", both, "Segment0_LabelValue:=1\nSegment0_Color:=1 0 0\n"
     "Segment1_LabelValue:=2\nSegment1_Color:=0 0.2 1\n")
grey = np.kron(grey, np.ones((4, 4)))
overlaid("enlarged, labels do not mix",
         ("both.nrrd", "--overlay-look", "1:1,2:1", "-s", "48x56"),
         INKS[np.kron(plane(both, 2, 5), np.ones((4, 4), int))], 1.0)
grey = once
dose = (random.random(VOXELS.shape) * 40).astype(np.float32)
nrrd("dose.nrrd", dose)
flat = plane(dose, 2, 5).astype(float)[..., None]
overlaid("values over a slice",
         ("dose.nrrd", "--overlay-look", "red,10,30,10:0,30:0.8"),
         np.clip((flat - 10) / 20, 0, 1) * [1, 0, 0],
         np.clip((flat - 10) / 20, 0, 1) * 0.8)
# Lines around labels: inside each, a pixel wide in small pictures.
path, flat = "b.nii", plane(cells, 2, 5)
edge = np.zeros(flat.shape, bool)
for axis, step in ((0, 1), (0, -1), (1, 1), (1, -1)):
    edge |= (np.roll(flat, step, axis) != flat)
overlaid("outlines", ("cells.nrrd", "--overlay-look", "outline"), INKS[flat],
         1.0 * (edge & (flat > 0))[..., None])
overlaid("translucent ones", ("cells.nrrd", "--overlay-look", "outline,0.4"),
         INKS[flat], 0.4 * (edge & (flat > 0))[..., None])

done = run(path, "--overlay", "cells.nrrd")
oracle.checked += 1
if done.returncode != 2 or "without --overlay" not in done.stderr:
    oracle.fail("numbers with an overlay", "are not refused")

# Values are those after slope and intercept.
oracle.patch("b.nii", 112, struct.pack("<ff", 2.5, -1000))
check("a slope", np.array_equal(values("b.nii", "--at", "5"),
                                (2.5 * native - 1000).astype(np.float32)))

# A crop counts from its own first voxel.
check("a crop", np.array_equal(
    values("a.nii", "--at", "1", "--crop", "2:9,3:11,4:8"),
    plane(VOXELS[2:9, 3:11, 4:8], 2, 1)))

# A series has a picture for each slice, in the order that is asked.
for asked, wanted in (("", range(10)), ("2:8:3", (2, 5)), ("-3:", (7, 8, 9)),
                      ("8:2", range(8, 2, -1)), ("::-4", (9, 5, 1)),
                      ("10mm:19mm:4.5mm", (2, 5))):
    for name in os.listdir("."):
        if name.startswith("s_") or name.startswith(".s_"):
            os.remove(name)
    run("a.nii", *(("--at=" + asked,) if asked else ()), out="s_%02d.npy")
    got = [np.load(f"s_{n:02d}.npy") for n in range(len(wanted))]
    check(f"a series {asked}", not os.path.exists(f"s_{len(wanted):02d}.npy") and
          all(np.array_equal(one, plane(VOXELS, 2, n))
              for one, n in zip(got, wanted)))
for asked in ("5:5", "3:4:0", "a:b", "1:2:3:4", "40:50"):
    done = run("a.nii", "--at", asked, out="t_%02d.npy")
    check(f"{asked} is refused", done.returncode == 2 and "--at" in done.stderr)

# A grid: its slices lie in the middle of equal parts of those that show
# something, with two pixels between them, and one window.
thick = np.zeros((12, 14, 40), np.uint16)
thick[:, :, 8:32] = random.integers(500, 4000, (12, 14, 24))
thick[3, 3, 5] = 4000  # not 1 %
nifti("thick.nii", thick, MATRIX)
run("thick.nii", "--grid", "3x2", "--stats", "g.json",
    "--no-labels", "--bits", "16", out="out.png")
indices = json.loads(oracle.got("g.json"))["slice"]["indices"]
check("a grid's slices", indices == [int(8 + (n + 0.5) * 4) for n in range(6)])
path = "thick.nii"
sheet = np.zeros((2 * 14 + 2, 3 * 12 + 4, 4))
for n, index in enumerate(indices):
    y, x = n // 3 * 16, n % 3 * 14
    sheet[y:y + 14, x:x + 12] = (plane(thick, 2, index) / 4000)[..., None]
    sheet[y:y + 14, x:x + 12, 3] = 1
same_picture("a grid", ("--grid", "3x2", "--background", "none"), sheet,
             0.00002)
run("a.nii", "--grid", "4x1", "--at", "2:6", "--axis", "y")
got = np.load("out.npy")
check("a grid of numbers", got.shape == (10, 4 * 12 + 6) and all(
    np.array_equal(got[:, 14 * n:14 * n + 12], plane(VOXELS, 1, 2 + n))
    for n in range(4)) and np.isnan(got[:, 12:14]).all())

# Three slices through a point at one scale: where it lies in voxels, and in the
# picture, by the affine alone (as nibabel applies it).
point = np.array([-20 + 1.5 * 4.3, 31 + 1.5 * 9.2, 7 + 1.5 * 6.1])
for order, signs in oracle.few(oracle.TURNS, 6, 1):
    new, matrix = oracle.turned(VOXELS, MATRIX, order, signs)
    nifti("turned.nii", new, matrix)
    # Glued, so that a point before zero is no option.
    run("turned.nii", "--ortho", "--at=" + ",".join(map(str, point)))
    got = np.load("out.npy")
    wanted = np.full((14, 12 + 2 + 12 + 2 + 14), np.nan)
    wanted[:, :12] = plane(VOXELS, 2, 6)
    wanted[2:12, 14:26] = plane(VOXELS, 1, 9)
    wanted[2:12, 28:] = plane(VOXELS, 0, 4)
    check(f"three slices {order} {signs}",
          np.array_equal(got, wanted, equal_nan=True))
run("a.nii", "--ortho", "--at=" + ",".join(map(str, point)), "-s", "840x280",
    "--no-labels", out="out.png")
try:
    from PIL import Image
    pixels = np.asarray(Image.open("out.png").convert("RGB")).astype(int)
    green = pixels[..., 1] - pixels[..., 0] > 100
    rows, columns = np.nonzero(green[:, :230])
    pitch = max((12 + 12 + 14) * 1.5 / 836, 14 * 1.5 / 280)
    left = (840 - int(38 * 1.5 / pitch + 1e-6) - 4) // 2
    at = (left + (11.5 - 4.3) * 1.5 / pitch, (13.5 - 9.2) * 1.5 / pitch)
    check("lines through the point", abs(np.median(columns) - at[0]) < 1 or
          abs(np.median(rows) - at[1]) < 1)
    check("one upright", abs(np.bincount(columns).argmax() - at[0]) < 1)
    check("one level", abs(np.bincount(rows).argmax() - at[1]) < 1)
except ImportError as missing:
    print("skip   lines through a point:", missing)
for at in ("1,2", "1,2,x", "900,0,0"):
    done = run("a.nii", "--ortho", "--at", at)
    check(f"a point {at} is refused", done.returncode == 2)

# A picture of colours in 3D keeps them.
try:
    import tifffile
    inks = np.zeros((32, 48, 3), np.uint8)
    inks[:], inks[8:24, 12:36] = (200, 90, 30), (10, 200, 250)
    for count in (1, 2):
        tifffile.imwrite("rgb.tif", np.stack([inks] * count), photometric="rgb")
        oracle.tool("render", "rgb.tif", "-o", "rgb.npy", "-y", "-q", "-s",
                    "96x64", "--fit", "volume", "--zoom", "0.5")
        check(f"a picture of colours in 3D, {count} deep", np.abs(
            np.load("rgb.npy")[32, 48] * 255 - [10, 200, 250, 255]).max() < 2)
except ImportError as missing:
    print("skip   a picture of colours in 3D:", missing)

# The figures say which slice it was.
run("a.nii", "--axis", "coronal", "--at", "3", "--stats", "s.json")
told = json.loads(oracle.got("s.json"))
check("figures", told["slice"] == {"axis": "coronal", "index": 3,
                                   "position": 35.5, "unit": "mm"} and
      told["volume"]["dims"] == [12, 14, 10])
oracle.finish()
