"""DICOM segmentations beside NumPy, made with pydicom: frames of bits, of
fractions and of numbers become one volume of labels.
"""
import os
import time

import oracle
from oracle import np
from dicom_sets import (CT, ExplicitVRBigEndian, ExplicitVRLittleEndian,
                        ImplicitVRLittleEndian, RLELossless, blank, fill, grid,
                        holds, packed, write)
from pydicom.uid import DeflatedExplicitVRLittleEndian

SEG, LABELMAP = (f"1.2.840.10008.5.1.4.1.1.66.{n}" for n in (4, 7))
AXIAL = np.eye(3)

# --- files of our own ---------------------------------------------------------


def scaled_lab(red, green, blue):
    """CIELAB of the profile connection space in 16 bits, from sRGB of 0 to 1,
    by the chromaticities of its primaries and Bradford's adaptation to D50."""
    x, y = np.array([[0.64, 0.3, 0.15], [0.33, 0.6, 0.06]])
    primaries = np.stack([x / y, np.ones(3), (1 - x - y) / y])
    d65 = np.array([0.3127 / 0.329, 1, 0.3583 / 0.329])
    d50 = np.array([0.9642, 1, 0.8249])
    primaries *= np.linalg.solve(primaries, d65)
    cones = np.array([[0.8951, 0.2664, -0.1614], [-0.7502, 1.7135, 0.0367],
                      [0.0389, -0.0685, 1.0296]])
    adapt = np.linalg.inv(cones) @ np.diag(
        (cones @ d50) / (cones @ d65)) @ cones
    rgb = np.array([red, green, blue], float)
    linear = np.where(rgb > 0.04045, ((rgb + 0.055) / 1.055) ** 2.4,
                      rgb / 12.92)
    t = adapt @ primaries @ linear / d50
    f = np.where(t > (6 / 29) ** 3, np.cbrt(t), t * 841 / 108 + 4 / 29)
    lab = np.array([116 * f[1] - 16, 500 * (f[0] - f[1]),
                    200 * (f[1] - f[2])])
    return [int(round(v)) for v in (lab[0] * 655.35, *(lab[1:] + 128) * 257)]


SEGMENTS = {1: ("Liver", (0.8, 0.4, 0.3)), 2: ("Left kidney", (0.2, 0.7, 0.9)),
            5: ("Größe", (0.95, 0.9, 0.1))}


def described(segments):
    return [holds(SegmentNumber=n, SegmentLabel=name,
                  RecommendedDisplayCIELabValue=scaled_lab(*color))
            for n, (name, color) in segments.items()]


def frame_groups(position, number):
    own = {"PlanePositionSequence": [
        holds(ImagePositionPatient=[float(f"{p:.9g}") for p in position])]}
    if number is not None:
        own["SegmentIdentificationSequence"] = [
            holds(ReferencedSegmentNumber=number)]
    return holds(**own)


def segmentation(frames, kind="BINARY", turn=AXIAL, spacing=(0.5, 0.75, 2.5),
                 segments=None, depth=True, **tags):
    """Frames are (position, number of the segment, pixels (y, x))."""
    pixels = np.stack([f[2] for f in frames])
    bits = 1 if kind == "BINARY" else 8 * pixels.dtype.itemsize
    measures = {"PixelSpacing": [spacing[1], spacing[0]], "SliceThickness": 7}
    if depth:
        measures["SpacingBetweenSlices"] = spacing[2]
    data = blank(**{
        "SOPClassUID": LABELMAP if kind == "LABELMAP" else SEG,
        "SpecificCharacterSet": "ISO_IR 192", "SeriesInstanceUID": "1.2.9",
        "SeriesDescription": "Organs", "Modality": "SEG",
        "SegmentationType": kind, "NumberOfFrames": len(pixels),
        "Rows": pixels.shape[1], "Columns": pixels.shape[2],
        "PixelRepresentation": 0, "BitsAllocated": bits, "BitsStored": bits,
        "HighBit": bits - 1,
        "SegmentSequence": described(segments or SEGMENTS),
        "SharedFunctionalGroupsSequence": [holds(
            PixelMeasuresSequence=[holds(**measures)],
            PlaneOrientationSequence=[holds(ImageOrientationPatient=[
                float(f"{v:.9g}") for v in (*turn[0], *turn[1])])])],
        "PerFrameFunctionalGroupsSequence": [
            frame_groups(f[0], f[1]) for f in frames], **tags})
    if kind == "FRACTIONAL":
        data.MaximumFractionalValue = 200
    return fill(data, pixels)


def masks(shape, numbers, seed=1):
    """Of each segment where it is, apart: (z, y, x) of no segment and those."""
    random = np.random.default_rng(seed)
    return random.choice([0, 0, *numbers], shape)


def cut(labels, turn, spacing, origin, numbers=None):
    """A frame for each slice of each segment that has any voxel there."""
    normal = np.cross(turn[0], turn[1])
    return [(np.array(origin) + z * spacing[2] * normal, n, labels[z] == n)
            for n in numbers or np.unique(labels[labels > 0])
            for z in range(len(labels)) if (labels[z] == n).any()]


# --- one volume of labels -----------------------------------------------------

spacing, origin = (0.5, 0.75, 2.5), (3.0, -4, 7)
wanted = grid(AXIAL, spacing, origin)
numbers = (1, 2, 5)
labels = masks((7, 5, 9), numbers).astype("u1")  # 45 bits a frame
frames = cut(labels, AXIAL, spacing, origin)
for syntax in (ExplicitVRLittleEndian, ImplicitVRLittleEndian,
               ExplicitVRBigEndian, DeflatedExplicitVRLittleEndian):
    write("plain.dcm", segmentation(frames, syntax=syntax))
    oracle.expect("plain.dcm", labels, wanted, unit="mm", name=f"{syntax}")
swapped = segmentation(frames, syntax=ExplicitVRBigEndian)
pairs = np.frombuffer(swapped.PixelData, "u2").byteswap().tobytes()
swapped.PixelData = pairs
swapped["PixelData"].VR = "OW"
write("swapped.dcm", swapped)
oracle.expect("swapped.dcm", labels, wanted, name="bits in big endian words")
write("plain.dcm", segmentation(frames))
oracle.says("nothing to remark", "plain.dcm", None)
shuffled = [frames[i] for i in np.random.default_rng(4).permutation(len(frames))]
write("mixed.dcm", segmentation(shuffled))
oracle.expect("mixed.dcm", labels, wanted, name="frames in any order")
turn = np.linalg.qr(np.random.default_rng(3).standard_normal((3, 3)))[0]
write("oblique.dcm", segmentation(cut(labels, turn, spacing, origin),
                                  turn=turn))
oracle.expect("oblique.dcm", labels, grid(turn, spacing, origin),
              name="oblique")
write("down.dcm", segmentation(
    cut(labels, AXIAL, (0.5, 0.75, -2.5), origin)))
oracle.expect("down.dcm", labels[::-1],
              grid(AXIAL, spacing, (3, -4, 7 - 6 * 2.5)),
              name="frames along the reverse of their normal")
write("one.dcm", segmentation(cut(labels[:1], AXIAL, spacing, origin)))
oracle.expect("one.dcm", labels[:1], wanted, name="a slice")
write("lone.dcm", segmentation(cut(labels[:1], AXIAL, spacing, origin)[:1]))
oracle.expect("lone.dcm", labels[:1] * (labels[:1] == 1), wanted,
              name="one frame")
with open("lone.dcm", "rb") as file, open("cut.dcm", "wb") as to:
    to.write(file.read()[:600])
oracle.says("one frame beside a file that is cut", "lone.dcm", None)
os.remove("cut.dcm")
wide = masks((9, 150, 200), numbers).astype("u1")
write("wide.dcm", segmentation(cut(wide, AXIAL, spacing, origin),
                               syntax=DeflatedExplicitVRLittleEndian))
oracle.expect("wide.dcm", wide, wanted, name="a hundred thousand bytes deflated")
high = np.where(labels == 5, 300, labels).astype("u2")
write("high.dcm", segmentation(cut(high, AXIAL, spacing, origin)))
oracle.expect("high.dcm", high, wanted, name="numbers above 255")

# --- empty and uneven slices --------------------------------------------------

tall = np.zeros((40, 5, 9), "u1")
tall[3:9], tall[20], tall[33:35] = labels[:6], labels[6], labels[1:3]
frames = cut(tall, AXIAL, spacing, origin)
for depth in (True, False):
    write("empty.dcm", segmentation(frames, depth=depth))
    oracle.expect("empty.dcm", tall[3:35], grid(
        AXIAL, spacing, (3, -4, 7 + 3 * 2.5)), name=f"empty slices {depth}")
oracle.says("empty slices", "empty.dcm", None)
write("even.dcm", segmentation(cut(tall[[3, 33]].repeat([1, 1], 0), AXIAL,
                                   (0.5, 0.75, 25), origin)))
far = np.zeros((11, 5, 9), "u1")
far[0], far[10] = tall[3], tall[33]
oracle.expect("even.dcm", far, wanted, name="two slices far apart")
heights = [0, 2, 3.1, 4.2, 6.2, 7.5]
write("uneven.dcm", segmentation(
    [((3, -4, 7 + h), n, labels[z] == n) for n in numbers
     for z, h in enumerate(heights)], depth=False))
steps = int(np.ceil(7.5 / 1.1 - 1e-3))
nearest = [int(np.argmin(np.abs(np.array(heights) - i * 7.5 / steps)))
           for i in range(steps + 1)]
oracle.expect("uneven.dcm", labels[nearest],
              grid(AXIAL, (0.5, 0.75, 7.5 / steps), origin), name="uneven")
oracle.says("uneven", "uneven.dcm", "its 6 slices lie 1.1 to 2 mm apart; of 8")
# Heights of two segments, mm between slices as they are told, the slices that
# are made of which places, "-" of none, and how far apart they are.
for heights, depth, slices, gap in (
        ((0, 1, 2, 1, 2, 3), 0, "0123", 1),
        ((0, 2, 4, 2, 4, 6), 2, "0123", 2),
        ((0, 2, 4, 2, 4, 6), 1, "0-1-2-3", 1),  # the file says so
        ((0, 2, 4, 2, 4, 6), 1.7, "0123", 2),  # that cannot be
        ((0, 1, 2, 5, 6, 9), 0, "012--34--5", 1),
        ((0, 3, 5, 0, 3, 5), 1, "0--1-2", 1),
        ((0, 0, 0, 7, 7, 7), 1, "0------1", 1),
        ((0, 0, 0, 7, 7, 7), 0, "01", 7),
        ((0, 1, 2.5, 3.5, 4.5, 5.5), 0, "0122345", 5.5 / 6),  # the nearest
        ((0, 1, 2.5, 3.5, 10.5, 11.5), 0, "01223-----445", 11.5 / 12)):
    made = [((3, -4, h), 1 + i // 3, labels[i % 3] > 0)
            for i, h in enumerate(heights)]
    # Several frames of a segment at one place are not allowed.
    made = [f for i, f in enumerate(made)
            if not any(f[:2] == g[:2] for g in made[:i])]
    write("slices.dcm", segmentation(made, spacing=(0.5, 0.75, depth),
                                     depth=depth > 0))
    places = [np.max([n * m for (_, _, z), n, m in made if z == at], 0)
              for at in sorted(set(heights))]
    stack = np.stack([np.zeros((5, 9)) if c == "-" else places[int(c)]
                              for c in slices]).astype("u1")
    oracle.expect("slices.dcm", stack,
                  grid(AXIAL, (0.5, 0.75, gap), (3, -4, heights[0])),
                  name=f"slices {heights} {depth}")

# --- other types --------------------------------------------------------------

overlaid = [((3, -4, 7 + 2.5 * z), n, masks((5, 9), [9], 10 * n + z) > 0)
            for n in (5, 1, 2) for z in range(3)]
write("overlap.dcm", segmentation(overlaid))
most = np.max([np.stack([n * m for _, n, m in overlaid[i:i + 3]])
               for i in (0, 3, 6)], 0).astype("u1")
oracle.expect("overlap.dcm", most, wanted, name="overlap")
oracle.says("overlap", "overlap.dcm", "some of its segments overlap")
whole = cut(labels, AXIAL, spacing, origin)
eights = segmentation(whole, BitsAllocated=8, BitsStored=8, HighBit=7)
eights.PixelData = np.stack([255 * f[2].astype("u1")
                             for f in whole]).tobytes() + b"\0"
write("eights.dcm", eights)
oracle.expect("eights.dcm", labels, wanted, name="bytes in place of bits")
random = np.random.default_rng(8)
shares = random.integers(0, 201, (3, 5, 9)).astype("u1")
shares[0, 0, :3] = 99, 100, 101
for syntax in (ExplicitVRLittleEndian, RLELossless):
    write("shares.dcm", segmentation(
        [((3, -4, 7 + 2.5 * z), 2, s) for z, s in enumerate(shares)],
        "FRACTIONAL", syntax=syntax))
    oracle.expect("shares.dcm", (2 * (shares >= 100)).astype("u1"), wanted,
                  name=f"fractions {syntax}")
oracle.says("fractions", "shares.dcm", "at least one half")
for map_type in ("u1", "u2"):
    for syntax in (ExplicitVRLittleEndian, RLELossless, ExplicitVRBigEndian):
        numbered = labels.astype(map_type) * (1 if map_type == "u1" else 200)
        write("map.dcm", segmentation(
            [((3, -4, 7 + 2.5 * z), None, s) for z, s in enumerate(numbered)],
            "LABELMAP", syntax=syntax))
        oracle.expect("map.dcm", numbered, wanted,
                      name=f"label map {map_type} {syntax}")

# --- names, colours, masks ----------------------------------------------------

told = oracle.told("plain.dcm")
found = {label["value"]: (label["name"], label["color"], label["opacity"])
         for label in told["labels"]}
for number, (name, color) in SEGMENTS.items():
    got = found.get(number, ("", [9, 9, 9], 0))
    if got[0] != name or got[2] != 1 or np.abs(
            np.subtract(got[1], color)).max() > 1e-3:
        oracle.fail(f"segment {number}", f"{got}, not {name} {color}")
if told["modality"] != "SEG" or found[0][2] != 0:
    oracle.fail("modality, background", f"{told['modality']}, {found[0]}")
long = "ab" + "肝" * 30
write("long.dcm", segmentation(cut(labels, AXIAL, spacing, origin),
                               segments={1: (long, (1, 1, 1))}))
names = [label["name"] for label in oracle.told("long.dcm")["labels"]]
if names[1] != long[:len(names[1])] or len(names[1]) < 15:
    oracle.fail("a long name", names)
grey = oracle.sample("u2", labels.shape)
vectors = ["(%r,%r,%r)" % tuple(map(float, wanted[:3, i])) for i in range(4)]
oracle.put("grey.nrrd", oracle.nrrd(
           "uint16", (9, 5, 7), "space: RAS\nspace directions: "
           f"{' '.join(vectors[:3])}\nspace origin: {vectors[3]}\n",
           grey.astype("<u2").tobytes()))
oracle.expect("grey.nrrd", np.where(labels == 2, grey.astype("f4"),
                                    np.nan).astype("f4"), wanted,
              ["--mask", "mixed.dcm", "--labels", 2], name="a mask")

# --- beside images ------------------------------------------------------------

os.mkdir("both")
for z in range(4):
    ct = segmentation([((3, -4, 7 + 2.5 * z), 1, grey[z])], "FRACTIONAL")
    for name in ("SegmentSequence", "SegmentationType", "NumberOfFrames",
                 "PerFrameFunctionalGroupsSequence"):
        delattr(ct, name)
    ct.SOPClassUID = ct.file_meta.MediaStorageSOPClassUID = CT
    ct.Modality, ct.SeriesInstanceUID = "CT", "1.2.8"
    ct.SeriesDescription = "Thorax 1.0 B70f"
    ct.ImagePositionPatient = [3, -4, 7 + 2.5 * z]
    ct.ImageOrientationPatient = [1, 0, 0, 0, 1, 0]
    ct.PixelSpacing = [0.75, 0.5]
    write(f"both/{z}.dcm", ct)
for i in range(2):
    write(f"both/seg{i}.dcm", segmentation(cut(
        np.roll(labels, i), AXIAL, spacing, origin)))
oracle.expect("both", grey[:4], wanted, name="a CT with its segmentations")
oracle.says("a CT with its segmentations", "both",
            'the input has 3 series of images: 0: CT 9x5, 4 images "Thorax 1.0 B70f" '
            '(taken); 1: SEG 9x5, 21 images "Organs"; 2: SEG 9x5, 21 images "Organs"')
oracle.expect("both/seg0.dcm", labels, wanted, name="a segmentation beside")

# --- what is refused ----------------------------------------------------------


def spoilt(part, change, **tags):
    data = segmentation(cut(labels, AXIAL, spacing, origin), **tags)
    change(data)
    write("spoilt.dcm", data)
    oracle.refuse("spoilt.dcm", part)


def without(*names):
    def change(data):
        for name in names:
            delattr(data, name)
    return change


def moved(index, *position):
    """The frame lies elsewhere."""
    def change(data):
        data.PerFrameFunctionalGroupsSequence[index].PlanePositionSequence[
            0].ImagePositionPatient = list(position)
    return change


spoilt("claims 21 frames of 9x500 pixels, which its",
       lambda d: setattr(d, "Rows", 500))
spoilt("claims 22 frames", lambda d: setattr(d, "NumberOfFrames", 22))


def one_bit_more(data):
    data.Rows, data.Columns, data.NumberOfFrames = 961, 1, 1


spoilt("claims 1 frame of 1x961 pixels", one_bit_more)
spoilt("whose frames have no positions",
       without("PerFrameFunctionalGroupsSequence",
               "SharedFunctionalGroupsSequence"))
spoilt("whose frames have no positions",
       without("PerFrameFunctionalGroupsSequence"))
spoilt("frame 4 of its segmentation names no segment", lambda d: delattr(
    d.PerFrameFunctionalGroupsSequence[4], "SegmentIdentificationSequence"))
spoilt("only 20 of 21 frames have positions on one grid", lambda d: delattr(
    d.PerFrameFunctionalGroupsSequence[4], "PlanePositionSequence"))
spoilt("frames 0 and 1 of its segmentation have the same place and segment",
       moved(1, 3, -4, 7))
spoilt("beside one another in a plane", moved(1, 30, -4, 7))
spoilt("an unknown type", lambda d: setattr(d, "SegmentationType", "OTHER"))
spoilt("an unknown type", without("SegmentationType"))
spoilt("1 values of 1 bits per pixel",
       lambda d: setattr(d, "SegmentationType", "LABELMAP"))
spoilt("has no integer pixels", without("PixelData"))
spoilt("its single bits are compressed", lambda d: packed(d, [bytes(64)] * 21))
spoilt("too unevenly", lambda d: [
    moved(i, 3, -4, [0, 0.3, 5000][i % 3])(d) for i in range(21)], depth=False)

# --- a large one --------------------------------------------------------------

if not oracle.SHORT:
    side, count = 512, 100
    y, x = np.mgrid[:side, :side]
    big = np.zeros((count, side, side), "u1")
    for n in range(1, 6):
        for z in range(count):
            big[z][(x - 80 * n) ** 2 + (y - 250) ** 2 < 30 * (z + 1)] = n
    write("big.dcm", segmentation(cut(big, AXIAL, (1, 1, 1), (0, 0, 0)),
                                  spacing=(1, 1, 1)))
    begun = time.monotonic()
    done = oracle.tool("convert", "-q", "-y", "big.dcm", "-o", "big.npy")
    oracle.checked += 1
    took = time.monotonic() - begun
    if done.returncode or not np.array_equal(np.load("big.npy"), big):
        oracle.fail("512 x 512 x 100 of 5 segments", "is not what was written")
    print(f"512 x 512 x 100 of 5 segments: {took:.1f} s")
oracle.finish()
