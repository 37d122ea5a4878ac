"""DICOM beside pydicom, and series of every kind made with it.

Its codecs are seldom installed: packed files are compared with the same image
that is not packed.
"""
import sys

try:
    import numpy as np
    import pydicom
    from pydicom.dataset import Dataset, FileMetaDataset
    from pydicom.encaps import encapsulate
    from pydicom.pixel_data_handlers.rle_handler import rle_encode_frame
    from pydicom.sequence import Sequence
    from pydicom.uid import (ExplicitVRBigEndian, ExplicitVRLittleEndian,
                             ImplicitVRLittleEndian, JPEGBaseline8Bit,
                             RLELossless, generate_uid)
except ImportError as missing:
    print("skip  ", missing)
    sys.exit(77)
import glob
import gzip
import io
import json
import os
import shutil
import subprocess
import tarfile

import oracle

oracle.need_modules()

# Without GDCM what is packed by JPEG's kinds is refused, and nothing else.
GDCM = oracle.library("gdcm")
UNBUILT = "this build cannot read compressed DICOM images"

place = oracle.folder()
CT = "1.2.840.10008.5.1.4.1.1.2"
AXIAL = (1, 0, 0, 0, 1, 0)
RAS = np.diag([-1.0, -1, 1, 1])

# --- the reference ------------------------------------------------------------


def opened(path):
    with open(path, "rb") as file:
        data = file.read()
    if data[:2] == b"\x1f\x8b":
        data = gzip.decompress(data)
    return pydicom.dcmread(io.BytesIO(data), force=True)


def values(data, pixels):
    """Data values of one slice, NaN where it is padding."""
    v = pixels.astype(float)
    out = v * float(data.get("RescaleSlope", 1)) + \
        float(data.get("RescaleIntercept", 0))
    if "PixelPaddingValue" in data:
        ends = sorted([data.PixelPaddingValue,
                       data.get("PixelPaddingRangeLimit",
                                data.PixelPaddingValue)])
        out[(v >= ends[0]) & (v <= ends[1])] = np.nan
    return out


def volume(datas):
    """Voxels (z, y, x) and matrix of slices with a file each."""
    row = np.array(datas[0].ImageOrientationPatient[:3], float)
    column = np.array(datas[0].ImageOrientationPatient[3:], float)
    normal = np.cross(row, column)
    datas = sorted(datas, key=lambda d: np.dot(
        normal, np.array(d.ImagePositionPatient, float)))
    places = [np.array(d.ImagePositionPatient, float) for d in datas]
    down, across = map(float, datas[0].PixelSpacing)
    lps = np.eye(4)
    lps[:3, 0] = row * across
    lps[:3, 1] = column * down
    lps[:3, 2] = (places[-1] - places[0]) / (len(places) - 1)
    lps[:3, 3] = places[0]
    return np.stack([values(d, d.pixel_array) for d in datas]), RAS @ lps


# --- files of our own ---------------------------------------------------------


def image(pixels, position=None, orientation=AXIAL, series="1.2.3", **tags):
    """A data set of one file; pixels of shape (y, x) or (frame, y, x)."""
    data = Dataset()
    data.file_meta = FileMetaDataset()
    data.file_meta.MediaStorageSOPClassUID = tags.pop("SOPClassUID", CT)
    data.SOPClassUID = data.file_meta.MediaStorageSOPClassUID
    data.SOPInstanceUID = tags.pop("SOPInstanceUID", generate_uid())
    data.file_meta.MediaStorageSOPInstanceUID = data.SOPInstanceUID
    syntax = tags.pop("syntax", ExplicitVRLittleEndian)
    data.file_meta.TransferSyntaxUID = syntax
    data.is_little_endian = syntax != ExplicitVRBigEndian
    data.is_implicit_VR = syntax == ImplicitVRLittleEndian
    data.SeriesInstanceUID = series
    data.Modality = "CT"
    data.PatientName = "Hidden^Person"
    data.PatientID = "HID-Quitzkow"
    data.Rows, data.Columns = pixels.shape[-2:]
    if pixels.ndim == 3:
        data.NumberOfFrames = len(pixels)
    data.SamplesPerPixel = 1
    data.PhotometricInterpretation = "MONOCHROME2"
    data.BitsAllocated = data.BitsStored = 8 * pixels.dtype.itemsize
    data.PixelRepresentation = int(pixels.dtype.kind == "i")
    data.PixelSpacing = [0.75, 0.5]
    data.SliceThickness = 9
    if position is not None:
        data.ImagePositionPatient = [float(p) for p in position]
        data.ImageOrientationPatient = [float(o) for o in orientation]
    for name, value in tags.items():
        setattr(data, name, value)
    data.HighBit = tags.get("HighBit", data.BitsStored - 1)
    order = "<" if data.is_little_endian else ">"
    data.PixelData = pixels.astype(pixels.dtype.newbyteorder(order)).tobytes()
    data["PixelData"].VR = "OW" if data.BitsAllocated > 8 else "OB"
    if len(data.PixelData) % 2:
        data.PixelData += b"\0"
    return data


def write(path, data):
    data.save_as(path, write_like_original=False)


def series(folder, slices, positions, names=None, **tags):
    """A folder of slices; per-slice tags are lists as long as they are."""
    shutil.rmtree(folder, ignore_errors=True)
    os.mkdir(folder)
    add(folder, slices, positions, names, **tags)


def add(folder, slices, positions, names=None, **tags):
    for i, (pixels, position) in enumerate(zip(slices, positions)):
        own = {k: v[i] if isinstance(v, Each) else v for k, v in tags.items()}
        name = names[i] if names else f"{tags.get('series', 's')}_{i}.dcm"
        write(f"{folder}/{name}", image(pixels, position, **own))


class Each(list):
    """One for each slice."""


def grid(step, origin, column2=None):
    lps = np.eye(4)
    lps[:3, :3] = np.diag(step)
    if column2 is not None:
        lps[:3, 2] = column2
    lps[:3, 3] = origin
    return RAS @ lps


def told(path, *options):
    done = oracle.run(path, *options)
    return done.returncode, done.stdout, done.stderr


def says(name, path, part, *options):
    """The remarks contain a part."""
    oracle.checked += 1
    status, _, errors = told(path, *options)
    if status or part not in errors:
        oracle.fail(name, f"exit {status}, {errors!r} lacks {part!r}")


def closed(path, part):
    """Only info opens it without --allow-gaps."""
    oracle.checked += 1
    done = subprocess.run([oracle.TOOL, "convert", path, "-o", "closed.nrrd"],
                          capture_output=True, text=True)
    if done.returncode != 3 or part not in done.stderr:
        oracle.fail(path, f"exit {done.returncode}, {done.stderr!r} lacks "
                    f"{part!r}")


def silent(name, path):
    """There are no remarks."""
    oracle.checked += 1
    status, _, errors = told(path)
    if status or errors:
        oracle.fail(name, f"exit {status}, {errors!r}")


small = oracle.sample("i2", (9, 6, 5))
rising = [(3, -4, 2.5 * i - 7) for i in range(9)]
wanted = grid((0.5, 0.75, 2.5), rising[0])

# --- order, names and forms of files ------------------------------------------

for syntax in (ExplicitVRLittleEndian, ImplicitVRLittleEndian,
               ExplicitVRBigEndian):
    for kind in ("u1", "i1", "u2", "i2"):
        voxels = oracle.sample(kind, (9, 6, 5))
        series("plain", voxels, rising, syntax=syntax)
        oracle.expect("plain", voxels, wanted, unit="mm",
                      name=f"{kind} {syntax}")
shuffled = np.random.default_rng(5).permutation(9)
names = [f"IM{n}" for n in np.random.default_rng(6).permutation(900)[:9]]
series("mixed", small[shuffled], [rising[i] for i in shuffled], names,
       InstanceNumber=Each(int(n) for n in range(9)))
oracle.expect("mixed", small, wanted, unit="mm", name="names in any order")
oracle.expect("mixed/IM*", small, wanted, name="a pattern")
with open("mixed/notes.txt", "w") as file:
    file.write("not a slice")
directory = image(small[0], SOPClassUID="1.2.840.10008.1.3.10")
for name in ("Rows", "Columns", "PixelData"):
    delattr(directory, name)
write("mixed/DICOMDIR", directory)
os.mkdir("mixed/below")
oracle.expect("mixed", small, wanted, name="other files beside it")
oracle.refuse("mixed/DICOMDIR", "without an image")
# One that was to be a slice.
shutil.copytree("mixed", "lacking")
cut = image(small[0])
for name in ("Rows", "Columns", "PixelData"):
    delattr(cut, name)
write("lacking/IMcut", cut)
closed("lacking", "lacking/IMcut: is truncated or damaged: it claims to be")
for size in (0, 50, 131):
    os.rename("lacking/IMcut" if not size else "lacking/cut.dcm",
              "lacking/cut.dcm")
    os.truncate("lacking/cut.dcm", size)
    closed("lacking", "lacking/cut.dcm: is named like DICOM but is")
os.remove("lacking/cut.dcm")
legacy = "1.2.840.10008.5.1.4.1.1.2.2"
for name, sop, refused in (("CT", legacy, True),
                           ("dose", "1.2.840.10008.5.1.4.1.1.481.2", False),
                           ("report", "1.2.840.10008.5.1.4.1.1.88.11", False)):
    cut.SOPClassUID = sop
    write("lacking/" + name, cut)
    if refused:
        closed("lacking", f"lacking/{name}: is truncated or damaged: it claims")
    else:
        oracle.expect("lacking", small, wanted, name=f"a {name} beside it")
    os.remove("lacking/" + name)
for name in ("IM77", "1.2.840.77"):
    for size in (0, 131):
        with open("lacking/" + name, "wb") as file:
            file.write(bytes(size))
        says(f"a short file {name} beside slices", "lacking",
             f"1 file beside the images ({name}) cannot be read or is too "
             "short to be DICOM; slices of the volume may be missing")
    os.remove("lacking/" + name)
with open("lacking/VERSION.txt", "wb") as file:
    file.write(b"1")
oracle.expect("lacking", small, wanted, name="a text beside it")
for name in ("s10", "s9", ".s1"):
    os.makedirs(f"above/{name}")
oracle.refuse("above", "has no slices itself, only folders such as s9; name one "
              "of them")
shutil.copytree("mixed", "above/s9", dirs_exist_ok=True)
oracle.expect("above/s9", small, wanted, name="a folder in a folder")
os.mkdir("empty")
oracle.refuse("empty", "names no slices")
first = f"mixed/{names[0]}"
with open(first, "rb") as file, gzip.open(first + ".gz", "wb") as to:
    to.write(file.read())
os.remove(first)
oracle.expect("mixed", small, wanted, name="one of them packed by gzip")
oracle.expect(f"mixed/{names[4]}", small, wanted, name="one slice of them")
says("one slice of them", f"mixed/{names[4]}", "one of 9 slices of a series")
with open(f"mixed/{names[4]}", "rb") as file:
    alone = file.read()
oracle.checked += 1
done = subprocess.run([oracle.TOOL, "info", "--json", "-"], input=alone,
                      capture_output=True)
if json.loads(done.stdout)["dims"] != [5, 6, 1]:
    oracle.fail("a slice on standard input", done.stdout)
for path in glob.glob("mixed/IM*[0-9]"):
    with open(path, "rb") as file:
        whole = file.read()
    with open(path, "wb") as file:
        meta = 132 + 12 + whole[140] + 256 * whole[141]
        file.write(whole[meta:])
oracle.expect("mixed", small, wanted, name="without the mark at byte 128")
series("falling", small[::-1], rising[::-1])
oracle.expect("falling", small, wanted, name="files from the last place")
# Rows that run to the patient's right: the normal is down.
series("turned", small, rising, orientation=(-1, 0, 0, 0, 1, 0))
oracle.expect("turned", small[::-1],
              grid((-0.5, 0.75, -2.5), rising[-1]), name="the normal is down")
oblique = np.linalg.qr(np.random.default_rng(3).standard_normal((3, 3)))[0]
normal = np.cross(oblique[0], oblique[1])
lps = np.eye(4)
lps[:3, :3] = np.stack([0.5 * oblique[0], 0.75 * oblique[1], 1.5 * normal], 1)
lps[:3, 3] = (1, 2, 3)
series("oblique", small, [lps[:3, 3] + i * 1.5 * normal for i in range(9)],
       orientation=tuple(oblique[0]) + tuple(oblique[1]))
oracle.expect("oblique", small, RAS @ lps, name="oblique")

# --- gaps and tilt ------------------------------------------------------------

angle = np.radians(20)
series("tilt", small, [(3, -4, 2.5 * i) for i in range(9)],
       orientation=(1, 0, 0, 0, np.cos(angle), np.sin(angle)))
lps = np.eye(4)
lps[:3, 0] = (0.5, 0, 0)
lps[:3, 1] = (0, 0.75 * np.cos(angle), 0.75 * np.sin(angle))
lps[:3, 2] = (0, 0, 2.5)
lps[:3, 3] = (3, -4, 0)
oracle.expect("tilt", small, RAS @ lps, name="a tilted gantry is a shear")
uneven = [0, 2, 4, 6, 10, 14, 18]
series("uneven", small[:7], [(0, 0, z) for z in uneven])
made = [small[0], small[1], small[2], small[3]]
for i in range(3, 6):
    made += [(small[i].astype(float) + small[i + 1]) / 2, small[i + 1]]
oracle.expect("uneven", np.array(made, "f4"), grid((0.5, 0.75, 2), (0, 0, 0)),
              name="gaps of 2 and 4 mm")
says("uneven", "uneven", "resampled to 10, one every 2 mm")
jitter = [0, 2.5, 5.1, 7.5, 10]
series("nearly", small[:5], [(0, 0, z) for z in jitter])
oracle.expect("nearly", small[:5], grid((0.5, 0.75, 2.5), (0, 0, 0)),
              name="nearly even")
says("nearly", "nearly", "their mean distance, 2.5 mm")
series("gap", small[:8], [r for i, r in enumerate(rising) if i != 4])
closed("gap", "1 of its slices is missing between s_3.dcm and s_4.dcm")
holed = np.insert(small[:8].astype("f4"), 4, np.nan, axis=0)
for options in ([], ["--allow-gaps"]):
    oracle.expect("gap", holed, wanted, options,
                  name=f"a missing slice {options}")
says("a slice whose others are not all there", "gap/s_1.dcm", "used alone")
series("beside", small, [(30 * (i == 4), 0, i) for i in range(9)])
oracle.refuse("beside", "are not aligned")
series("far", small[:4], [(0, 0, z) for z in (0, 0.01, 5, 50)])
oracle.refuse("far", "too unevenly")
series("same", small[:3], [(0, 0, z) for z in (0, 1, 2)])
shutil.copy("same/s_1.dcm", "same/again.dcm")
oracle.expect("same", small[:3], grid((0.5, 0.75, 1), (0, 0, 0)),
              name="a file twice")
says("a file twice", "same", "1 file with the same image as another file")
add("same", small[5:6], [(0, 0, 1)], ["other.dcm"])
oracle.refuse("same", "2 images at the position of")

# --- several series, times ----------------------------------------------------

series("two", small[:5], rising[:5], series="1.2.30", SeriesNumber=2)
add("two", small[5:], rising[5:8], series="1.2.4", SeriesNumber=1)
# a scout of the first series, which lies across it
add("two", small[8:], rising[:1], ["scout"], series="1.2.30", SeriesNumber=2,
    InstanceNumber=9, orientation=(1, 0, 0, 0, 0, -1))
oracle.expect("two", small[:5], wanted, name="the largest series")
says("two series", "two", "0: CT 5x6, 3 images; 1: CT 5x6, 5 images "
     "(taken); 2: CT 5x6, 1 image")
oracle.expect("two", small[5:8], grid((0.5, 0.75, 2.5), rising[5]),
              ["--series", "0"])
oracle.expect("two", small[5:8], grid((0.5, 0.75, 2.5), rising[5]),
              ["--series", "1.2.4"])
oracle.expect("two", small[:5], wanted, ["--series", "1.2.30"])
oracle.expect("two/1.2.30_3.dcm", small[:5], wanted, name="a slice of two")
oracle.refuse("two", "there is no such series", ["--series", "3"], 2)
oracle.refuse("two", "there is no such series", ["--series", "1.2"], 2)
beats = oracle.sample("u2", (3, 4, 6, 5))
series("beats", beats.reshape(12, 6, 5), rising[:4] * 3,
       TriggerTime=Each([200] * 4 + [100] * 4 + [300] * 4))
for time, index in enumerate((1, 0, 2)):
    oracle.expect("beats", beats[index], wanted, ["--time", time])
oracle.refuse("beats", "3", ["--time", "3"], 2)
names = sorted(glob.glob("beats/*"), key=lambda n: int(n.split("_")[1][:-4]))
oracle.expect(names[9], beats[2], wanted, name="a slice of a time")
series("cardiac", beats[:, 0], rising[:1] * 3, TriggerTime=Each([3, 1, 2]))
oracle.expect("cardiac", beats[1:2, 0], grid((0.5, 0.75, 9), rising[0]),
              name="times of one slice")
oracle.expect("cardiac/s_2.dcm", beats[2:, 0],
              grid((0.5, 0.75, 9), rising[0]), name="one of one place")

# --- values -------------------------------------------------------------------

slopes, intercepts = Each([2, 0.5, 1.25]), Each([-10, 3, 7])
unsigned = oracle.sample("u2", (3, 6, 5))
series("scaled", unsigned, rising[:3], RescaleSlope=slopes,
       RescaleIntercept=intercepts)
scaled = np.stack([(s * u.astype(float) + i).astype("f4")
                   for s, u, i in zip(slopes, unsigned, intercepts)])
oracle.expect("scaled", scaled, wanted, name="a scale for each slice")
series("one", unsigned, rising[:3], RescaleSlope=1, RescaleIntercept=-1000)
oracle.expect("one", unsigned - 1000.0, wanted, dtype="u2", name="one scale")
series("zero", unsigned, rising[:3], RescaleSlope=0, RescaleIntercept=0)
oracle.expect("zero", unsigned, wanted, name="a slope of 0")
series("dark", unsigned % 4096, rising[:3], BitsStored=12,
       PhotometricInterpretation="MONOCHROME1")
oracle.expect("dark", 4095.0 - unsigned % 4096, wanted, dtype="u2",
              name="MONOCHROME1")
series("hu", unsigned, rising[:3], RescaleSlope=1, RescaleIntercept=-1000,
       PhotometricInterpretation="MONOCHROME1")
oracle.expect("hu", unsigned - 1000.0, wanted, dtype="u2",
              name="MONOCHROME1 with a rescale")
sparse = small[:3].copy()
sparse[:, 1:3] = -2000
sparse[1, 4, 2] = -1999
holes = np.where(sparse == -2000, np.nan, sparse.astype("f4"))
series("padded", sparse, rising[:3], PixelPaddingValue=Each([-2000] * 3))
oracle.expect("padded", holes.astype("f4"), wanted, name="padding")
series("range", sparse, rising[:3], PixelPaddingValue=-1999,
       PixelPaddingRangeLimit=-2000)
holes[1, 4, 2] = np.nan
oracle.expect("range", holes.astype("f4"), wanted, name="a range of padding")
# 12 bits with a sign, in the middle of the word, other bits set around them.
twelve = oracle.sample("i2", (3, 6, 5)) >> 4
noise = oracle.sample("u2", (3, 6, 5), 9)
words = ((twelve.astype("u2") & 0xfff) << 2) | (noise & 0xc003)
series("twelve", words.view("i2"), rising[:3], BitsStored=12, HighBit=13)
oracle.expect("twelve", twelve, wanted, name="12 of 16 bits, signed")
long = oracle.sample("u4", (4, 6, 5))
dose = image(long, (1, 2, 3), SOPClassUID="1.2.840.10008.5.1.4.1.1.481.2",
             GridFrameOffsetVector=[0, 2, 4, 6], DoseGridScaling=0.25)
write("dose.dcm", dose)
oracle.expect("dose.dcm", long * 0.25, grid((0.5, 0.75, 2), (1, 2, 3)),
              dtype="u4", name="a dose")
silent("a dose", "dose.dcm")

# What GDCM packs, each way that has a code for the type.
gdcmconv = shutil.which("gdcmconv")
for kind in ("u1", "u2", "i2") if gdcmconv else ():
    voxels = oracle.sample(kind, (5, 20, 30)) // 16
    series("raw", voxels, rising[:5], BitsStored=16 if "2" in kind else 8)
    for way in ("--jpeg", "--jpegls", "--j2k", "--rle", "--implicit",
                "--explicit", "--deflated"):
        shutil.rmtree("packed", ignore_errors=True)
        os.mkdir("packed")
        for path in glob.glob("raw/*"):
            subprocess.run([gdcmconv, way, path,
                            path.replace("raw", "packed")], check=True)
        if GDCM or way not in ("--jpeg", "--jpegls", "--j2k"):
            oracle.expect("packed", voxels, wanted, name=f"{kind} {way}")
        else:
            oracle.refuse("packed", UNBUILT)

# --- several frames -----------------------------------------------------------


def groups(position, slope, intercept):
    item, where, scale = Dataset(), Dataset(), Dataset()
    where.ImagePositionPatient = list(map(float, position))
    scale.RescaleSlope, scale.RescaleIntercept = slope, intercept
    scale.RescaleType = "US"
    item.PlanePositionSequence = Sequence([where])
    item.PixelValueTransformationSequence = Sequence([scale])
    return item


shared, plane, measures = Dataset(), Dataset(), Dataset()
plane.ImageOrientationPatient = list(map(float, AXIAL))
measures.PixelSpacing, measures.SliceThickness = [0.75, 0.5], 9
shared.PlaneOrientationSequence = Sequence([plane])
shared.PixelMeasuresSequence = Sequence([measures])
for syntax in (ExplicitVRLittleEndian, ExplicitVRBigEndian,
               ImplicitVRLittleEndian):
    many = image(small[shuffled], syntax=syntax,
                 SOPClassUID="1.2.840.10008.5.1.4.1.1.2.1",
                 SharedFunctionalGroupsSequence=Sequence([shared]),
                 PerFrameFunctionalGroupsSequence=Sequence(
                     [groups(rising[i], 2, -5) for i in shuffled]))
    del many.PixelSpacing
    write("many.dcm", many)
    oracle.expect("many.dcm", small * 2.0 - 5, wanted, dtype="i2", unit="mm",
                  name=f"frames with places {syntax}")
NM = "1.2.840.10008.5.1.4.1.1.20"
write("nm.dcm", image(small, (3, -4, -7), SOPClassUID=NM,
                      SliceVector=list(range(9, 0, -1))))
oracle.expect("nm.dcm", small[::-1], grid((0.5, 0.75, 1), (3, -4, -7)),
              name="numbers of slices")
says("numbers of slices", "nm.dcm", "distance of the slices is missing; 1 mm")
for step in (2.5, -2.5):
    detector = Dataset()
    detector.ImagePositionPatient = [3.0, -4, -7]
    detector.ImageOrientationPatient = list(map(float, AXIAL))
    write("nm.dcm", image(small, SOPClassUID=NM, SpacingBetweenSlices=step,
                          DetectorInformationSequence=Sequence([detector])))
    there = small if step > 0 else small[::-1]
    low = min(-7, -7 + 8 * step)
    oracle.expect("nm.dcm", there, grid((0.5, 0.75, 2.5), (3, -4, low)),
                  name=f"nuclear medicine, {step}")
write("cine.dcm", image(small))
oracle.expect("cine.dcm", small, np.diag([0.5, -0.75, -1, 1]),
              name="frames without a place")
says("cine", "cine.dcm", "distance of the slices is missing; 1 mm")

# --- colours, and what is refused ---------------------------------------------

colour = oracle.sample("u1", (6, 5, 3))
rgb = image(colour[..., 0].repeat(3, 1), (0, 0, 0), Columns=5,
            SamplesPerPixel=3, PhotometricInterpretation="RGB",
            PlanarConfiguration=0)
for planar in (0, 1):
    rgb.PlanarConfiguration = planar
    rgb.PixelData = (np.moveaxis(colour, 2, 0) if planar else colour).tobytes()
    write("rgb.dcm", rgb)
    for channel in range(3):
        oracle.expect("rgb.dcm", colour[None, ..., channel],
                      grid((0.5, 0.75, 9), (0, 0, 0)), ["--channel", channel],
                      name=f"RGB {planar}")
oracle.refuse("rgb.dcm", "channel 3 does not exist", ["--channel", 3], 2)
rgb.PhotometricInterpretation = "YBR_FULL"
write("ybr.dcm", rgb)
oracle.expect("ybr.dcm", colour[None, ..., 0], grid((0.5, 0.75, 9), (0, 0, 0)),
              name="brightness of YBR_FULL")
says("YBR_FULL", "ybr.dcm", "channel 0 is the brightness")
rgb.file_meta.TransferSyntaxUID = JPEGBaseline8Bit
plain, rgb.PixelData = rgb.PixelData, encapsulate([b"\xff\xd8" + bytes(40)])
rgb["PixelData"].is_undefined_length = True
write("ybr.dcm", rgb)
if GDCM:
    oracle.refuse("ybr.dcm", "colours are YBR_FULL, compressed in transfer syntax")
rgb.file_meta.TransferSyntaxUID = RLELossless
rgb.PixelData = encapsulate([rle_encode_frame(colour)])
rgb["PixelData"].is_undefined_length = True
write("ybr.dcm", rgb)
oracle.expect("ybr.dcm", colour[None, ..., 0], grid((0.5, 0.75, 9), (0, 0, 0)),
              name="brightness of YBR_FULL in run lengths")
rgb.file_meta.TransferSyntaxUID = ExplicitVRLittleEndian
rgb.PixelData = plain
rgb["PixelData"].is_undefined_length = False
rgb.PhotometricInterpretation = "YBR_FULL_422"
write("ybr.dcm", rgb)
oracle.refuse("ybr.dcm", "colours are YBR_FULL_422 with 3 values")


def palette(first=0, count=256, bits=16, words=True, **tags):
    """Of numbers of colours, and the brightness of these."""
    numbers = oracle.sample(tags.pop("dtype", "u1"), (7, 5))
    data = image(numbers, (0, 0, 0), PhotometricInterpretation="PALETTE COLOR",
                 **tags)
    kind = "u2" if bits == 16 else "u1"
    tables = [oracle.sample(kind, (count,)) for _ in range(3)]
    order = ">" if tags.get("syntax") == ExplicitVRBigEndian else "<"
    for table, name in zip(tables, ("Red", "Green", "Blue")):
        descriptor = f"{name}PaletteColorLookupTableDescriptor"
        setattr(data, descriptor, [count % 65536, first, bits])
        data[descriptor].VR = "SS" if first < 0 else "US"
        if words:
            raw = table.astype(order + "u2").tobytes()
        else:  # two bytes a word
            raw = table.tobytes() + b"\0" * (count % 2)
            raw = np.frombuffer(raw, "<u2").astype(order + "u2").tobytes()
        setattr(data, f"{name}PaletteColorLookupTableData", raw)
        data[f"{name}PaletteColorLookupTableData"].VR = "OW"
    at = np.clip(numbers.astype(int) - first, 0, count - 1)
    most = 65535 if bits == 16 else 255
    light = sum(w * t[at].astype(float) / most
                for w, t in zip((0.299, 0.587, 0.114), tables))
    return data, np.floor(light * 255 + 0.5)[None]


for what in ({}, {"bits": 8}, {"bits": 8, "words": False},
             {"bits": 8, "words": False, "count": 7, "first": 100},
             {"first": 30, "count": 101}, {"dtype": "u2", "count": 65536},
             {"dtype": "i2", "first": -900, "count": 2000},
             {"syntax": ExplicitVRBigEndian, "dtype": "u2"},
             {"syntax": ExplicitVRBigEndian, "bits": 8, "words": False}):
    data, light = palette(**what)
    write("palette.dcm", data)
    oracle.expect("palette.dcm", light, grid((0.5, 0.75, 9), (0, 0, 0)),
                  dtype="u1", unit="mm", name=f"palette {what}")
says("palette", "palette.dcm", "their brightness is used")
data, light = palette()
data.RescaleSlope, data.RescaleIntercept = 2, -5  # of no meaning here
write("palette.dcm", data)
oracle.expect("palette.dcm", light, grid((0.5, 0.75, 9), (0, 0, 0)),
              dtype="u1", name="palette with a slope")
for change, what in (
        (lambda d: setattr(d, "GreenPaletteColorLookupTableDescriptor",
                           [255, 0, 16]), "tables differ in length"),
        (lambda d: setattr(d, "BluePaletteColorLookupTableDescriptor",
                           [256, 0, 12]), "other than 8 or 16 bits"),
        (lambda d: delattr(d, "RedPaletteColorLookupTableDescriptor"),
         "the palette is missing"),
        (lambda d: setattr(d, "BluePaletteColorLookupTableData", b"12"),
         "of which some are missing"),
        (lambda d: (delattr(d, "RedPaletteColorLookupTableData"),
                    setattr(d, "SegmentedRedPaletteColorLookupTableData",
                            b"\0\0\1\0\2\0")), "stored in segments")):
    data, _ = palette()
    change(data)
    write("palette.dcm", data)
    oracle.refuse("palette.dcm", what)
bit = image(oracle.sample("u1", (8, 8)), BitsAllocated=1, BitsStored=1)
write("bit.dcm", bit)
oracle.refuse("bit.dcm", "pixels of 1 bits are not supported")
write("odd.dcm", image(small[0], rising[0], PixelSpacing=[0, 0.5]))
oracle.expect("odd.dcm", small[:1], grid((1, 1, 9), rising[0]),
              name="a spacing of 0")
says("a spacing of 0", "odd.dcm", "1 mm is used")
oracle.refuse("odd.dcm", "a file of the format dicom, whose header has sizes",
              ["--dims", "5x6x1"], 2)
oracle.refuse("odd.dcm", "--dataset x", ["--dataset", "x"], 2)
with open("odd.dcm", "rb") as file:
    whole = file.read()
os.mkdir("cut")
for size in oracle.few(range(0, len(whole), 7), 5):
    with open("cut/a.dcm", "wb") as file:
        file.write(whole[:size])
    done = oracle.run("cut/a.dcm")
    oracle.checked += 1
    if done.returncode != 3 or done.stderr.count("\n") != 1:
        oracle.fail(f"cut at {size}", f"{done.returncode} {done.stderr}")
series("broken", small, rising)
with open("broken/s_4.dcm", "rb") as file:
    whole = file.read()
for size in (len(whole) - 10, 300):
    with open("broken/s_4.dcm", "wb") as file:
        file.write(whole[:size])
    closed("broken", "s_4.dcm: is truncated or damaged")
    holed = small[:9].astype("f4")
    holed[4] = np.nan
    oracle.expect("broken", holed, wanted, ["--allow-gaps"],
                  name=f"a slice cut to {size} bytes")
    says("a slice beside one that is cut", "broken/s_0.dcm",
         "1 file beside it cannot be read (s_4.dcm); slices of the volume may be missing")
series("packed", small, rising)
for i in range(9):
    data = opened(f"packed/s_{i}.dcm")
    data.file_meta.TransferSyntaxUID = RLELossless
    data.PixelData = encapsulate([rle_encode_frame(small[i])])
    data["PixelData"].is_undefined_length = True
    write(f"packed/s_{i}.dcm", data)
oracle.expect("packed", small, wanted, ["--allow-gaps"],
              name="run lengths, whole with gaps allowed")
os.truncate("packed/s_4.dcm", os.path.getsize("packed/s_4.dcm") - 20)
closed("packed", "packed/s_4.dcm: ")
for options in ([], ["--allow-gaps"]):
    oracle.expect("packed", holed, wanted, options,
                  name=f"run lengths that are cut {options}")
says("run lengths that are cut", "packed", "s_4.dcm is cut", "--allow-gaps")
with open("broken/s_3.dcm", "wb") as file:
    file.write(whole[:300])
says("a slice beside two that are cut", "broken/s_0.dcm",
     "2 files beside it cannot be read")
with open("plain.raw", "wb") as file:
    file.write(bytes(60))
oracle.refuse("plain.raw", "files of the format raw have no series",
              ["--series", "1", "--dims", "3x4x5", "--type", "uint8"], 2)

# --- privacy ------------------------------------------------------------------

series("private", small, rising, SpecificCharacterSet="ISO_IR 100",
       PatientName="Hiddén^Person")
oracle.checked += 1
texts = [subprocess.run([oracle.TOOL, *words], capture_output=True)
         for words in (["info", "private"], ["info", "--json", "private"],
                       ["private", "-o", "p.png", "-v", "--stats", "p.json",
                        "--save-config", "c.json"],
                       ["info", "private/s_1.dcm"])]
made = [open(p, "rb").read() for p in ("p.png", "p.json", "c.json")]
for text in [t.stdout + t.stderr for t in texts] + made:
    for word in (b"Hidd", b"Person", b"Quitzkow"):
        if word in text:
            oracle.fail("a name is told", text)
status, text, _ = told("private", "--patient")
if status or json.loads(text).get("patient") != "Hiddén^Person":
    oracle.fail("--patient", text)

# --- real ones ----------------------------------------------------------------


def same_as_plain(names, plain):
    """Packed forms of an image have the figures of the plain one."""
    expected = None
    for name in [plain, *names]:
        path = oracle.data(f"dicom/syntax/{name}")
        if not path:
            return
        if not GDCM and opened(path).file_meta.TransferSyntaxUID.startswith(
                "1.2.840.10008.1.2.4"):
            oracle.refuse(path, UNBUILT)
            continue
        oracle.checked += 1
        status, text, errors = told(path)
        if status:
            oracle.fail(name, errors)
            continue
        got = json.loads(text)
        expected = expected or got
        for key in ("dims", "type", "min", "max", "sum", "wsum", "finite",
                    "matrix"):
            if got[key] != expected[key]:
                oracle.fail(name, f"{key} {got[key]}, not {expected[key]}")


same_as_plain(["693_J2KR.dcm"], "693_UNCR.dcm.gz")
same_as_plain([f"CT0012.{n}" for n in (
    "fragmented_no_bot_jpeg_lossless.57.dcm",
    "fragmented_no_bot_jpeg_lossless.70.dcm",
    "not_fragmented_bot_jpeg_ls.80.dcm", "not_fragmented_bot_rle.dcm")],
    "CT0012.explicit_little_endian.dcm.gz")
same_as_plain([f"CT1_UNC.{n}" for n in (
    "explicit_big_endian.dcm.gz", "implicit_little_endian.dcm.gz",
    "fragmented_bot_jpeg_ls.80.dcm")], "CT1_UNC.explicit_little_endian.dcm.gz")
same_as_plain([f"MR_small_{n}.dcm" for n in (
    "bigendian", "implicit", "RLE", "jp2klossless", "jpeg_ls_lossless")],
    "MR_small.dcm")
same_as_plain([f"emri_small_{n}.dcm" for n in (
    "RLE", "big_endian", "jpeg_2k_lossless", "jpeg_ls_lossless")],
    "emri_small.dcm")
for name in ("CT_small.dcm", "MR_small.dcm", "CT1_UNC.explicit_big_endian."
             "dcm.gz", "693_UNCR.dcm.gz", "emri_small.dcm", "image_dfl.dcm",
             "CT0012.explicit_little_endian.dcm.gz"):
    path = oracle.data(f"dicom/syntax/{name}")
    if path:
        data = opened(path)
        pixels = data.pixel_array
        oracle.checked += 1
        _, text, _ = told(path)
        got = json.loads(text)
        scale = data
        if "SharedFunctionalGroupsSequence" in data:
            scale = data.SharedFunctionalGroupsSequence[0].get(
                "PixelValueTransformationSequence", [data])[0]
            pixels = pixels[::-1]  # along the normal, which is down
        want = oracle.figures(values(scale if scale is not data else data,
                                     np.atleast_3d(pixels)))
        for key in ("finite", "min", "max", "sum", "wsum"):
            if not oracle.near(got[key], want[key], want["scale"]):
                oracle.fail(name, f"{key} {got[key]}, not {want[key]}")
path = oracle.data("dicom/syntax/MR_truncated.dcm")
if path:
    oracle.refuse(path, "8192 bytes, of which 8130 exist")
for name, dtype in (("ct_abdomen_20of275", "u2"), ("mr_fse_brain_19", "f4")):
    path = oracle.data(f"dicom/{name}.tar.gz")
    if path:
        with tarfile.open(path) as archive:
            archive.extractall(name)
        (folder,) = glob.glob(f"{name}/*/")
        voxels, matrix = volume([opened(p) for p in glob.glob(f"{folder}/*")])
        oracle.expect(folder, voxels, matrix, dtype=dtype, unit="mm")
oracle.finish()
