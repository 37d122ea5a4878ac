"""NIfTI and the volumes of FreeSurfer, as nibabel writes and reads them: types,
scales, matrices, windows."""
import bz2
import gzip
import itertools
import struct

import oracle
from oracle import np

nibabel, = oracle.need("nibabel")


def theirs(path, **options):
    """The volume is what nibabel reads: stored values and matrix in mm."""
    image = nibabel.load(path)
    voxels = np.asarray(image.dataobj.get_unscaled())
    steps = voxels.reshape(*voxels.shape[:3], -1)
    slope, intercept = image.dataobj.slope, image.dataobj.inter
    factor = {"meter": 1000, "micron": 1e-3}.get(
        image.header.get_xyzt_units()[0], 1)
    matrix = np.diag([factor, factor, factor, 1]) @ image.affine
    for time in range(steps.shape[3]):
        stored = steps[..., time].T
        values = stored if (slope, intercept) == (1, 0) else \
            stored * float(slope) + float(intercept)
        oracle.expect(path, values, matrix, ["--time", time],
                      dtype=stored.dtype.newbyteorder("="), **options)


kinds = {1: nibabel.Nifti1Image, 2: nibabel.Nifti2Image}
turn = np.linalg.qr(np.random.default_rng(4).standard_normal((3, 3)))[0]
turn[:, 0] *= np.linalg.det(turn) # qform turns, but does not mirror
for n, (version, order, (unit, form)) in enumerate(itertools.product(
        kinds, "<>", (("mm", "s"), ("meter", "q"), ("micron", "q")))):
    kind = ("i1", "u1", "i2", "u2", "i4", "f4", "f8")[n % 7]
    shape = (5, 6, 7) if n % 3 else (5, 6, 7, 3)
    voxels = oracle.sample(kind, shape).astype(order + kind)
    header = kinds[version].header_class(endianness=order)
    header.set_data_dtype(voxels.dtype)
    header.set_xyzt_units(unit, "sec")
    matrix = oracle.affine((1, 2, 3), (-4, 5, 6), turn)
    image = kinds[version](voxels, matrix, header)
    image.set_sform(matrix, 1 if form == "s" else 0)
    image.set_qform(matrix, 1 if form == "q" else 0)
    if kind[0] != "f":
        image.header.set_slope_inter(0.5 * n + 1, -n)
    image.header["cal_min"], image.header["cal_max"] = -3, 40 + n
    nibabel.save(image, path := f"{n}.nii.gz" if n % 2 else f"{n}.nii")
    theirs(path)
    oracle.tells(path, window=[-3, 40 + n])

# Complex numbers are vectors of two.
for kind in ("c8", "c16"):
    voxels = oracle.sample("f4", (5, 6, 7)) + 1j * oracle.sample("f4", (5, 6, 7), 2)
    nibabel.save(nibabel.Nifti1Image(voxels.astype(kind), np.diag([1, 2, 3, 1])),
                 "complex.nii")
    stored = np.asarray(nibabel.load("complex.nii").dataobj).T
    for number, values in enumerate((stored.real, stored.imag)):
        oracle.expect("complex.nii", values, np.diag([1, 2, 3, 1]),
                      ["--component", number], name=f"{kind} {number}")
    # numpy's abs is a bit off with AVX-512.
    parts = np.stack((stored.real, stored.imag), -1)
    oracle.expect("complex.nii", oracle.magnitude(parts), np.diag([1, 2, 3, 1]),
                  name=f"magnitude of {kind}")
    oracle.says(kind, "complex.nii", "the magnitude of the 2 components is used")

# --- headers that other programs leave ----------------------------------------

nibabel.save(nibabel.Nifti1Image(oracle.sample("i2", (5, 6, 7)),
                                 np.diag([1, 2, 3, 1])), "plain.nii")
for name, at, content, said in (
        ("bits", 72, struct.pack("<h", 8), "claims 8 bits per voxel"),
        ("nobits", 72, bytes(2), None),
        ("axes", 40, struct.pack("<8h", 5, 5, 6, 7, 1, 1, 9, 9), None),
        ("noslope", 112, struct.pack("<ff", float("nan"), 7), None)):
    oracle.put(f"{name}.nii", oracle.got("plain.nii"))
    theirs(oracle.patch(f"{name}.nii", at, content))
    oracle.says(name, f"{name}.nii", said)
# Vectors and colours of FSL lie where time is, others behind it.
parts = oracle.sample("f4", (5, 6, 7, 3))
for intent, key, options in ((2003, "channel", 1), (2003, "component", 1),
                             (1007, "component", 2)):
    if key == "channel":  # bytes are colours, floats the directions of dtifit
        given = (parts * 255).astype("u1")
    else:
        given = parts
    for shape in ((5, 6, 7, 3), (5, 6, 7, 1, 3)):
        image = nibabel.Nifti1Image(given.reshape(shape), np.diag([1, 2, 3, 1]))
        image.header["intent_code"] = intent
        nibabel.save(image, "parts.nii")
        oracle.expect("parts.nii", given[..., options].T, np.diag([1, 2, 3, 1]),
                      [f"--{key}", options],
                      name=f"intent {intent} {key} {shape}")
once = gzip.compress(oracle.got("plain.nii"))
halves = [gzip.compress(half) for half in (oracle.got("plain.nii")[:200],
                                           oracle.got("plain.nii")[200:])]
theirs(oracle.put("members.nii.gz", b"".join(halves)))
theirs(oracle.put("plain.nii.bz2", packed := bz2.compress(oracle.got("plain.nii"))))
oracle.refuse(oracle.put("cut.nii.bz2", packed[:-9]), "truncated")
oracle.refuse(oracle.put("twice.nii.gz", gzip.compress(once)),
              "is compressed with gzip twice")

# --- FreeSurfer ------------------------------------------------------------
matrix = np.diag([1.5, 2, 2.5, 1])
matrix[:3, :3] = oracle.rotation(20, -70, 130) @ matrix[:3, :3]
matrix[:3, 3] = -12, 34, 5.5


def frames(path, name):
    image = nibabel.load(path)
    values = np.asarray(image.dataobj)
    values = values.astype(values.dtype.newbyteorder("="))
    for frame in range(values.shape[3] if values.ndim == 4 else 1):
        one = values[..., frame] if values.ndim == 4 else values
        oracle.expect(path, one.T, image.affine, ["--time", frame],
                      unit="mm", name=f"{name} frame {frame}")


for kind in ("u1", "i2", "i4", "f4"):
    for shape in ((5, 6, 7), (4, 3, 2, 3), (50, 1, 1)):
        nibabel.save(nibabel.MGHImage(oracle.sample(kind, shape), matrix),
                     "a.mgz")
        frames("a.mgz", f"{kind} of {shape}")
whole = gzip.decompress(oracle.got("a.mgz"))
for name, content in (
        ("without a footer", whole[:284 + 200]),
        ("with tags", whole + b"\0\0\0\3" + bytes(7) + b"\x10mri_convert -it ")):
    frames(oracle.put("b.mgh", content), name)

# Where there is no place, nibabel has y and z the other way round than
# FreeSurfer, whose y goes down and z to the front.
oracle.put("b.mgh", whole[:28] + b"\0\0" + whole[30:])
turn = nibabel.load("b.mgh").affine @ np.diag([1, -1, -1, 1])
turn[1:3, 3] = -nibabel.load("b.mgh").affine[1:3, 3]
oracle.expect("b.mgh", oracle.sample("f4", (50, 1, 1)).T, turn)
oracle.says("no place", "b.mgh", "no valid place")
oracle.refuse_cut("b.mgh", (0, 100, 284, 300), "cut.mgh")

# --- overlays: labels, counts and statistics ------------------------------------

at = np.indices((40, 40, 40)) - 20.0
far = np.sqrt((at ** 2).sum(0))


def overlaid(name, voxels, intent, wanted):
    image = nibabel.Nifti1Image(voxels, np.eye(4))
    image.header["intent_code"] = intent
    nibabel.save(image, "over.nii")
    done = oracle.tool("render", "body.nii", "--overlay", "over.nii", "-y", "-s",
                       "32", "-o", "over.png")
    said = done.stderr.partition("overlay over.nii: ")[2].partition("\n")[0]
    oracle.checked += 1
    if done.returncode or not said.startswith(wanted):
        oracle.fail(name, f"exit {done.returncode}, {said!r}, not {wanted!r}")
    return said


nibabel.save(nibabel.Nifti1Image((far < 18).astype("i2") * 100, np.eye(4)),
             "body.nii")
NORMAL = np.random.default_rng(7).standard_normal(far.shape)
BUMPS = 3 * np.sin(at[0] / 3) * np.sin(at[1] / 4)
spots = np.zeros(far.shape, "u1")
spots[5:35:3, 5:35:3, 20] = np.arange(100).reshape(10, 10) % 20 + 1
for name, voxels, intent, wanted in (
        ("a voxel", (far < 1).astype("u1"), 0, "labels 0..1"),
        ("a voxel of floats", (far < 1).astype("f4"), 0, "labels 0..1"),
        ("five values", (NORMAL > 2) * np.uint8(at[0] % 4 + 1), 0, "labels 0..4"),
        ("specks of 20", spots, 0, "labels 0..20"),
        ("counts", np.clip(BUMPS * 3, 0, None).astype("u1"), 0, "hot"),
        ("noise", (NORMAL * 9).clip(0, 40).astype("u1"), 0, "hot"),
        ("regions", np.repeat(np.arange(0, 40, 2), 2).astype("u1")[:, None, None] *
         np.ones((1, 40, 40), "u1"), 0, "labels 0..38"),
        ("a statistic", (far < 9) * np.uint8(3), 5, "hot"),
        ("an estimate", (far < 9) * np.uint8(3), 1001, "hot"),
        ("labels by intent", np.clip(BUMPS * 3, 0, None).astype("u1"), 1002,
         "labels")):
    overlaid(name, voxels, intent, wanted)
# Both signs: the percentile of numpy, within a bin of the 2049 that are counted.
values = np.where(far < 17, NORMAL + BUMPS, 0).astype("f4")
for intent, voxels in ((0, values), (5, values), (4, values ** 2)):
    wanted = "seismic" if voxels.min() < 0 else "hot"
    said = overlaid(f"intent {intent}", voxels, intent, wanted)
    start = float(said.partition("; opacity")[2].split(" 0 at ")[-1].split(",")[0])
    other = np.abs(voxels[voxels != 0])
    oracle.checked += 1
    if abs(start - np.percentile(other, 95)) > 2.1 * other.max() / 2049 or \
            "from percentile 95 of" not in said:
        oracle.fail(f"intent {intent}", f"{said!r}: not from "
                    f"{np.percentile(other, 95)} on")

# --- fields without a patient ---------------------------------------------------


def line(path, *options, verb="render"):
    done = oracle.tool(verb, path, "-y", "-s", "64", "-o", "said.png", *options)
    return done.stderr.strip().splitlines()[-1]


wave = np.exp(0.6 * (BUMPS / 3 + np.sin(at[2] / 5)))
for name, voxels, wanted in (
        ("a field", wave, "view oblique"), ("in double", wave * 1.5, "view oblique"),
        ("24 levels", wave[:24], "view oblique"), ("5 levels", wave[:5], "view +z"),
        ("bytes", (wave * 9).astype("u1"), "view +z")):
    if voxels.dtype == float and name != "in double":
        voxels = voxels.astype("f4")
    np.save("field.npy", voxels)
    said = line("field.npy")
    oracle.checked += 1
    if wanted not in said:
        oracle.fail(name, f"{said!r}, not {wanted!r}")
# At least the upper half of the voxels can be seen.
np.save("field.npy", wave.astype("f4"))
start = float(line("field.npy").partition("opacity 0 at ")[2].split(",")[0])
oracle.checked += 1
if not np.percentile(wave, 15) < start <= np.median(wave) * 1.001:
    oracle.fail("a field", f"is shown from {start} on, not {np.median(wave)}")
# The camera is where angles put it.
oracle.tool("render", "field.npy", "-y", "-q", "-s", "64", "-o", "turned.png",
            "--view", "front", "--azimuth", "30", "--elevation", "25")
oracle.checked += 1
if oracle.tool("compare", "said.png", "turned.png", "--tolerance",
               "1/255").returncode:
    oracle.fail("oblique", "is not 30 degrees to the right of the front and 25 up")

# --- CT: its floor, and air -----------------------------------------------------

body = np.where(far < 18, 40 + 900 * (far < 6), -1000).astype("i2")
body[(far < 14) & (far > 9)] = -850
body[:, :3] = -3024
for name, voxels, options, verb, wanted in (
        ("padding", body, ("-m", "mip"), "render", "-1024..940"),
        ("padding in a slice", body, (), "slice", "-1024..940"),
        ("air", body, ("-m", "minip"), "render", "-1000..-500"),
        ("a range", body, ("-m", "minip", "--range", "-900,0"), "render", "-900..0"),
        ("MR", body + np.int16(3024), ("-m", "minip"), "render", "0..3964")):
    nibabel.save(nibabel.Nifti1Image(voxels, np.eye(4)), "ct.nii")
    said = line("ct.nii", *options, verb=verb)
    oracle.checked += 1
    if wanted not in said:
        oracle.fail(name, f"{said!r}, not {wanted!r}")
oracle.finish()
