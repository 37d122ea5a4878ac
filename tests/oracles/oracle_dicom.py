"""DICOM beside pydicom, and series of every kind made with it.

Its codecs are seldom installed: packed files are compared with the same image
that is not packed.
"""
import glob
import gzip
import io
import json
import os
import shutil
import subprocess
import tarfile

import oracle
from oracle import np
import dicom_sets
from dicom_sets import (RAS, ExplicitVRBigEndian, ExplicitVRLittleEndian,
                        ImplicitVRLittleEndian, blank, fill, holds, packed,
                        pydicom, run_lengths, write)
from pydicom.pixel_data_handlers.util import apply_color_lut, convert_color_space
from pydicom.uid import JPEG2000Lossless, JPEGBaseline8Bit

try:
    from PIL import Image
except ImportError:
    Image = None

# Without GDCM what is packed by JPEG's kinds is refused, and nothing else.
GDCM = oracle.library("gdcm")
UNBUILT = "this build cannot read compressed DICOM images"

AXIAL = (1, 0, 0, 0, 1, 0)

# --- the reference ------------------------------------------------------------


def opened(path):
    data = oracle.got(path)
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
    bits = 8 * pixels.dtype.itemsize
    own = {"Rows": pixels.shape[-2], "Columns": pixels.shape[-1],
           "BitsAllocated": bits, "BitsStored": bits,
           "PixelRepresentation": int(pixels.dtype.kind == "i"),
           "PixelSpacing": [0.75, 0.5], "SliceThickness": 9}
    if pixels.ndim == 3:
        own["NumberOfFrames"] = len(pixels)
    if position is not None:
        own["ImagePositionPatient"] = [float(p) for p in position]
        own["ImageOrientationPatient"] = [float(o) for o in orientation]
    data = blank(SeriesInstanceUID=series, **{**own, **tags})
    data.HighBit = tags.get("HighBit", data.BitsStored - 1)
    return fill(data, pixels)


def series(folder, slices, positions, names=None, **tags):
    """A folder of slices; per-slice tags are lists as long as they are."""
    oracle.empty_folder(folder)
    add(folder, slices, positions, names, **tags)


def add(folder, slices, positions, names=None, **tags):
    for i, (pixels, position) in enumerate(zip(slices, positions)):
        own = {k: v[i] if isinstance(v, Each) else v for k, v in tags.items()}
        name = names[i] if names else f"{tags.get('series', 's')}_{i}.dcm"
        write(f"{folder}/{name}", image(pixels, position, **own))


class Each(list):
    """One for each slice."""


def grid(step, origin):
    return dicom_sets.grid(np.eye(3), step, origin)


def closed(path, part):
    """Only info opens it without --allow-gaps."""
    oracle.checked += 1
    done = oracle.tool("convert", path, "-o", "closed.nrrd")
    if done.returncode != 3 or part not in done.stderr:
        oracle.fail(path, f"exit {done.returncode}, {done.stderr!r} lacks "
                    f"{part!r}")


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
oracle.put("mixed/notes.txt", "not a slice")
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
        oracle.put("lacking/" + name, bytes(size))
        oracle.says(f"a short file {name} beside slices", "lacking",
                    f"1 file beside the images ({name}) cannot be read or is too "
                    "short to be DICOM; slices of the volume may be missing")
    os.remove("lacking/" + name)
oracle.put("lacking/VERSION.txt", b"1")
oracle.expect("lacking", small, wanted, name="a text beside it")
for name in ("s10", "s9", ".s1"):
    os.makedirs(f"above/{name}")
oracle.refuse("above", "has no slices itself, only folders such as s9; name one "
              "of them")
shutil.copytree("mixed", "above/s9", dirs_exist_ok=True)
oracle.expect("above/s9", small, wanted, name="a folder in a folder")
# A disk: its index, and two levels of folders with half of the slices each.
os.mkdir("disk")
write("disk/DICOMDIR", directory)
for z, position in enumerate(rising):
    os.makedirs(f"disk/A/S{z % 2}", exist_ok=True)
    write(f"disk/A/S{z % 2}/IM{z}", image(small[z], position))
for path, first in (("above", "s9"), ("disk", "A")): # which info lists
    done = oracle.tool("convert", "-y", path, "-o", "below.nrrd")
    oracle.expect("below.nrrd", small, wanted, name=f"the folders below {path}")
    if f"those of the folders below it, such as {first}" not in done.stderr:
        oracle.fail(path, done.stderr)
os.mkdir("empty")
oracle.refuse("empty", "names no slices")
first = f"mixed/{names[0]}"
oracle.packed(first, first + ".gz")
os.remove(first)
oracle.expect("mixed", small, wanted, name="one of them packed by gzip")
oracle.expect(f"mixed/{names[4]}", small, wanted, name="one slice of them")
oracle.says("one slice of them", f"mixed/{names[4]}",
            "one of 9 slices of a series")
alone = oracle.got(f"mixed/{names[4]}")
oracle.checked += 1
done = oracle.tool("info", "--json", "-", input=alone, text=False)
if json.loads(done.stdout)["dims"] != [5, 6, 1]:
    oracle.fail("a slice on standard input", done.stdout)
for path in glob.glob("mixed/IM*[0-9]"):
    whole = oracle.got(path)
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
series("oblique", small,
       [np.add((1, 2, 3), i * 1.5 * normal) for i in range(9)],
       orientation=(*oblique[0], *oblique[1]))
oracle.expect("oblique", small,
              dicom_sets.grid(oblique, (0.5, 0.75, 1.5), (1, 2, 3)),
              name="oblique")

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
oracle.says("uneven", "uneven", "resampled to 10, one every 2 mm")
jitter = [0, 2.5, 5.1, 7.5, 10]
series("nearly", small[:5], [(0, 0, z) for z in jitter])
oracle.expect("nearly", small[:5], grid((0.5, 0.75, 2.5), (0, 0, 0)),
              name="nearly even")
oracle.says("nearly", "nearly", "their mean distance, 2.5 mm")
for left_out, what in (
        ([4], "1 of its slices is missing between s_3.dcm and s_4.dcm"),
        ([3, 4], "2 of its slices are missing between s_2.dcm and s_3.dcm")):
    kept = [i for i in range(9) if i not in left_out]
    series("gap", small[kept], [rising[i] for i in kept])
    closed("gap", what)
    holed = small.astype("f4")
    holed[left_out] = np.nan
    for options in ([], ["--allow-gaps"]):
        oracle.expect("gap", holed, wanted, options,
                      name=f"missing slices {left_out} {options}")
oracle.says("a slice whose others are not all there", "gap/s_1.dcm",
            "used alone")
series("beside", small, [(30 * (i == 4), 0, i) for i in range(9)])
oracle.refuse("beside", "are not aligned")
series("beside", small[:4], [(3 * (i == 2), 0, z)
                             for i, z in enumerate((0, 1, 1, 2))])
oracle.refuse("beside", "beside one another in a plane")
series("printed", small, rising,
       orientation=Each([AXIAL] * 8 + [(1 - 1e-6, *AXIAL[1:])]))
oracle.expect("printed", small, wanted, name="directions that were rounded")
series("far", small[:4], [(0, 0, z) for z in (0, 0.01, 5, 50)])
oracle.refuse("far", "too unevenly")
series("same", small[:3], [(0, 0, z) for z in (0, 1, 2)])
shutil.copy("same/s_1.dcm", "same/again.dcm")
oracle.expect("same", small[:3], grid((0.5, 0.75, 1), (0, 0, 0)),
              name="a file twice")
oracle.says("a file twice", "same",
            "1 file with the same image as another file")
add("same", small[5:6], [(0, 0, 1)], ["other.dcm"])
oracle.refuse("same", "2 images at the position of")
# One UID for all, as of a program that removes names; two slices are alike.
alike = small.copy()
alike[3] = alike[4]
series("same", alike, rising, SOPInstanceUID="1.2.7")
shutil.copy("same/s_2.dcm", "same/again.dcm")
oracle.expect("same", alike, wanted, name="one UID for all")
oracle.says("one UID for all", "same", "8 files have the SOP instance UID of")
oracle.expect("same/s_2.dcm", alike, wanted, name="one of those")
series("same", alike[3:5], rising[3:4] * 2, SOPInstanceUID="1.2.7",
       AcquisitionTime=Each(["1200", "1201"]))
oracle.tells("same", times=2)
# A series UID for each.
for count, other in ((5, {}), (5, {"StudyInstanceUID": Each("1.2 1.2 1.2 1.2 "
                                                           "1.3".split())})):
    series("lone", small[:count], rising[:count], series=Each(
        f"1.2.{z}" for z in range(count)), **{"StudyInstanceUID": "1.2", **other})
    if other:
        oracle.tells("lone", dims=[5, 6, 1])
    else:
        oracle.expect("lone", small[:count], wanted, name="a series for each")
        oracle.says("a series for each", "lone", "a series UID of its own")
oracle.expect("lone", small[2:3], grid((0.5, 0.75, 9), rising[2]),
              ["--series", "1.2.2"])
series("lone", small[:3], rising[:1] * 3, InstanceNumber=Each([1, 2, 3]))
oracle.says("images that only numbers distinguish", "lone",
            "all its 3 images lie at one position")

# --- several series, times ----------------------------------------------------

series("two", small[:5], rising[:5], series="1.2.30", SeriesNumber=2)
add("two", small[5:], rising[5:8], series="1.2.4", SeriesNumber=1)
# a scout of the first series, which lies across it
add("two", small[8:], rising[:1], ["scout"], series="1.2.30", SeriesNumber=2,
    InstanceNumber=9, orientation=(1, 0, 0, 0, 0, -1))
oracle.expect("two", small[:5], wanted, name="the largest series")
oracle.says("two series", "two", "0: CT 5x6, 3 images; 1: CT 5x6, 5 images "
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
for tag in ("EchoTime", "TriggerTime"):
    series("beats", beats.reshape(12, 6, 5), rising[:4] * 3,
           **{tag: Each([200] * 4 + [100] * 4 + [300] * 4)})
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
oracle.says("a dose", "dose.dcm", None)

# --- PET and doses ------------------------------------------------------------

PET = {"Modality": "PT", "SOPClassUID": "1.2.840.10008.5.1.4.1.1.128",
       "Units": "BQML", "DecayCorrection": "START", "PatientWeight": 70,
       "PatientSize": 1.75, "PatientSex": "M", "RescaleIntercept": 0,
       "CorrectedImage": ["DECY", "ATTN", "SCAT"], "SeriesDate": "20240105",
       "SeriesTime": "101500", "AcquisitionDate": "20240105",
       "AcquisitionTime": Each(["101500", "101800", "102100"]),
       "RescaleSlope": Each([0.5, 0.25, 0.75])}
DRUG = {"RadiopharmaceuticalStartTime": "091500", "RadionuclideHalfLife": 6586.2,
        "RadionuclideTotalDose": 3.5e8}
ACTIVITY = np.arange(300, 390, dtype="i2").reshape(3, 6, 5)
SCALED = (ACTIVITY * np.array([0.5, 0.25, 0.75])[:, None, None]).astype("f4")


def pet(private=(), **changed):
    """A folder of a whole body with a bed for each slice."""
    drug = {k: changed.pop(k, v) for k, v in {
        **DRUG, "RadiopharmaceuticalStartDateTime": None}.items()}
    tags = {k: v for k, v in {**PET, **changed}.items() if v is not None}
    series("pet", ACTIVITY, rising[:3], RadiopharmaceuticalInformationSequence=[
        holds(**{k: v for k, v in drug.items() if v is not None})], **tags)
    for path in glob.glob("pet/*") if private else ():
        data = opened(path)
        block = data.private_block(private[0], private[1], create=True)
        block.add_new(private[2], "DT" if private[0] == 9 else "DS", private[3])
        write(path, data)


def pet_is(name, factor, options=("--suv", "bw"), unit="SUVbw", voxels=SCALED,
           note=None, path="pet"):
    """The data values are those of the file times a factor; the voxels stay."""
    found = oracle.told(path, *options)
    if not found:
        return
    oracle.same_figures(name, found, oracle.figures(voxels.astype("f8") * factor))
    if found.get("value_unit", "") != unit:
        oracle.fail(name, f"unit {found.get('value_unit')!r}, not {unit!r}")
    oracle.says(name, path, note, *options)


# Seconds from injection to what slices are corrected to, counted by hand.
MIDNIGHT = {"SeriesTime": "235500", "AcquisitionDate": None,
            "AcquisitionTime": Each(["235500", "000100", "000700"]),
            "RadiopharmaceuticalStartTime": "225500"}
LATER = {"SeriesTime": "143000"}
for name, seconds, tags in (
        ("START", 3600, {}),
        ("a series before its slices", 3000, {"SeriesTime": "100500"}),
        ("a series made later", 3600, {"SeriesTime": "112030"}),
        ("a series made a week later", 3600, {"SeriesDate": "20240112"}),
        ("the first bed in the last file", 3600, {
            **LATER, "AcquisitionTime": Each(["102100", "101800", "101500"])}),
        ("no series time", 3600, {"SeriesTime": None}),
        ("no acquisition times", 3600, {"AcquisitionTime": None}),
        ("no dates", 3600, {"SeriesDate": None, "AcquisitionDate": None}),
        ("no dates but of the dose", 3600, {
            "SeriesDate": None, "AcquisitionDate": None,
            "RadiopharmaceuticalStartDateTime": "20010101091500"}),
        ("an injection before midnight", 1800, {
            "SeriesDate": "20240106", "SeriesTime": "001500",
            "AcquisitionDate": "20240106", "AcquisitionTime": "001500",
            "RadiopharmaceuticalStartTime": "234500"}),
        ("beds across midnight", 3600, MIDNIGHT),
        ("the same, made later", 3600, {
            **MIDNIGHT, "SeriesDate": "20240106", "SeriesTime": "003000"}),
        ("a leap day", 43200, {
            "SeriesDate": "20240301", "SeriesTime": "001500",
            "AcquisitionDate": "20240301",
            "RadiopharmaceuticalStartDateTime": "20240229121500"}),
        ("a date and time", 3600 * 18, {
            "RadiopharmaceuticalStartDateTime": "20240104161500"}),
        ("nearly 12 half lives", 79020, {
            "RadiopharmaceuticalStartDateTime": "20240104121800"}),
        ("a zone and a fraction", 3600 * 18 - 0.25, {
            "TimezoneOffsetFromUTC": "-0500",
            "RadiopharmaceuticalStartDateTime": "20240104221500.250000+0100"}),
        ("a zone of one alone", 3599.5, {
            "RadiopharmaceuticalStartDateTime": "20240105091500.5+0100"}),
        ("an empty date and time", 3600, {"RadiopharmaceuticalStartDateTime": ""}),
        ("a fraction", 3599.25, {
            "RadiopharmaceuticalStartTime": "091500.750000"}),
        ("forms of before 1993", 3600, {
            "SeriesDate": "2024.01.05", "SeriesTime": "10:15:00",
            "AcquisitionDate": None, "AcquisitionTime": None}),
        ("minutes alone", 3600, {"RadiopharmaceuticalStartTime": "0915"}),
        ("ADMIN", 0, {"DecayCorrection": "ADMIN"}),
        ("GE", 2700, {**LATER, "private": (
            9, "GEMS_PETD_01", 0x0d, "20240105100000.00")}),
        ("another maker", 3600, {**LATER, "private": (
            9, "ACME 1.1", 0x0d, "20240105100000.00")})):
    pet(**tags)
    pet_is(name, 70000 / (3.5e8 * 2 ** (-seconds / 6586.2)))
pet_is("one slice of them", 70000 / (3.5e8 * 2 ** (-3600 / 6586.2)),
       path="pet/s_1.dcm", note="is one of 3 slices")
write("frames.dcm", image(
    ACTIVITY, rising[0], SpacingBetweenSlices=2, SharedFunctionalGroupsSequence=[
        holds(RadiopharmaceuticalInformationSequence=[holds(**DRUG)])],
    **{**PET, "RescaleSlope": 0.5, "AcquisitionTime": "101500"}))
pet_is("frames of one file", 70000 / (3.5e8 * 2 ** (-3600 / 6586.2)),
       path="frames.dcm", voxels=ACTIVITY * 0.5)
PHILIPS = (0x7053, "Philips PET Private Group")
FACTOR = 70000 / (3.5e8 * 2 ** (-3600 / 6586.2))
for name, factor, tags in (
        ("GML", 1, {"Units": "GML", "PatientWeight": None}),
        ("SUV of Philips", 0.125, {"Units": "CNTS", "PatientWeight": 0,
                                   "private": (*PHILIPS, 0, 0.125)}),
        ("counts of Philips", 3 * FACTOR, {
            "Units": "CNTS", "private": (*PHILIPS, 9, 3)})):
    pet(**tags)
    pet_is(name, factor)
LEAN = 1.1 * 70 - 128 * (70 / 175) ** 2, 1.07 * 70 - 148 * (70 / 175) ** 2
for name, kind, ratio, tags in (
        ("lean, male", "lbm", LEAN[0] / 70, {}),
        ("lean, female", "lbm", LEAN[1] / 70, {"PatientSex": "F"}),
        ("surface", "bsa", 71.84 * 70 ** 0.425 * 175 ** 0.725 / 70000, {})):
    pet(**tags)
    pet_is(name, FACTOR * ratio, ("--suv", kind), "SUV" + kind)
pet(Units="GML", SUVType="LBM")
pet_is("SUV by lean mass", 1, ("--suv", "lbm"), "SUVlbm")
for name, lacks, kind, tags in (
        ("no weight", "PatientWeight (0010,1030)", "bw", {"PatientWeight": None}),
        ("a weight of 0", "PatientWeight (0010,1030)", "bw", {"PatientWeight": 0}),
        ("no dose", "RadionuclideTotalDose", "bw", {"RadionuclideTotalDose": None}),
        ("no half life", "RadionuclideHalfLife", "bw", {"RadionuclideHalfLife": 0}),
        ("no corrections", "ATTN in CorrectedImage", "bw", {"CorrectedImage": None}),
        ("no DECY", "DECY in CorrectedImage", "bw", {"CorrectedImage": ["ATTN", "XDECY"]}),
        ("decayed", "DecayCorrection (0054,1102)", "bw", {"DecayCorrection": "NONE"}),
        ("no drug", "RadiopharmaceuticalStartTime", "bw", {
            "RadiopharmaceuticalStartTime": None}),
        ("over 12 half lives", "0 to 12 half lives before", "bw", {
            "RadiopharmaceuticalStartDateTime": "20240104121738"}),
        ("after the scan", "0 to 12 half lives before", "bw", {
            "RadiopharmaceuticalStartDateTime": "20240105101501"}),
        ("no time", "SeriesTime (0008,0031)", "bw", {
            "SeriesTime": None, "AcquisitionTime": None}),
        ("a weight of another world", "numbers that a body", "bw", {
            "PatientWeight": "1e300"}),
        ("a projection", "SeriesType", "bw", {
            "SeriesType": ["WHOLE BODY", "REPROJECTION"]}),
        ("no height", "PatientSize (0010,1020)", "lbm", {"PatientSize": None}),
        ("another sex", "PatientSex (0010,0040)", "lbm", {"PatientSex": "O"})):
    pet(**tags)
    pet_is(name, 1, ("--suv", kind), "Bq/ml",
           note=f"its values stay as stored, in Bq/ml: SUV{kind} needs")
    oracle.says(name, "pet", lacks, "--suv", kind)
pet(Units="CNTS")
pet_is("counts", 1, unit="counts", note="Units (0054,1001)")
pet(Units="PROPCPS")
pet_is("rates", 1, unit="", note="its values stay as stored: SUVbw needs Units")
pet(Modality="NM")
pet_is("no PET", 1, unit="", note="--suv: the volume is no PET")
pet()
pet_is("as stored", 1, ["--suv", "none"], "Bq/ml")
pet_is("as stored unasked", 1, [], "Bq/ml")
# Pictures are of SUV, and files of numbers as stored, unless it is asked.
for words, factor in (([], 1), (["--suv", "bw"], FACTOR)):
    oracle.tool("slice", "pet", "-o", "cut.npy", "-y", "--at", 0, "--axis", "z",
                *words)
    oracle.checked += 1
    if not np.isclose(np.load("cut.npy").max(), SCALED[0].max() * factor):
        oracle.fail("a slice of PET", np.load("cut.npy").max())
oracle.checked += 1
done = oracle.tool("pet", "-o", "pet.png", "-y", "-s", "40x40", "-m", "mip",
                   "--range", "full")
if f"{SCALED.max() * FACTOR:.4g}"[:4] not in done.stderr:
    oracle.fail("a picture of PET", done.stderr)

# Over a CT they are seen from 2.5 SUV on, doses of 5 % of their most on, and
# where the user says so otherwise; a slice has a pixel for each voxel there.
GRID = [(0, 0, 2 * z) for z in range(3)]
uptake = np.random.default_rng(7).uniform(0, 12, (3, 20, 20))
stored = np.round(uptake / FACTOR / 4).astype("i2")
stored[:, 0, 1] = 0  # white over white is not seen
uptake = stored * (4 * FACTOR)
flat = np.full((3, 20, 20), 40, "i2")
flat[:, :, :10] = -80
flat[:, 0, 0], flat[:, 0, 1] = -200, 200
series("ct", flat, GRID, RescaleIntercept=0, RescaleSlope=1, RescaleType="HU",
       PixelSpacing=[1, 1])
one = {**PET, "AcquisitionTime": "101500", "RescaleSlope": 4, "PixelSpacing": [1, 1]}
series("up", stored, GRID, RadiopharmaceuticalInformationSequence=[holds(**DRUG)],
       **one)
series("down", stored, GRID, RadiopharmaceuticalInformationSequence=[holds(**DRUG)],
       **{**one, "PatientWeight": 0})
dose = image(stored.astype("u4"), GRID[0], Modality="RTDOSE", PixelSpacing=[1, 1],
             SOPClassUID="1.2.840.10008.5.1.4.1.1.481.2", DoseUnits="GY",
             GridFrameOffsetVector=[0, 2, 4], DoseGridScaling=0.001)
write("gy.dcm", dose)
for name, words, line, seen in (
        ("up", [], "hot 0..7; opacity 0 at 2.5,", uptake >= 2.5),
        ("up", ["--overlay-look", "viridis"], "viridis 0..7;", uptake >= 2.5),
        ("up", ["--suv", "none"], "overlay up: hot ", None),
        ("up", ["--overlay-look", "hot,4,9"], "hot 4..9;", None),
        ("down", [], "SUVbw needs PatientWeight", None),
        ("gy.dcm", [], "turbo 0..", stored >= 0.05 * stored.max())):
    cut = [oracle.tool("slice", "ct", "--axis", "z", "--at", 1, "-s", "20x20",
                       "--no-labels", "-y", "-o", f"cut{len(more)}.png", *more)
           for more in ([], ["--overlay", name, *words])][1]
    oracle.checked += 1
    if cut.returncode or line not in cut.stderr:
        oracle.fail(f"{name} over a CT {words}", cut.stderr)
    if seen is None or not Image:
        continue
    bare, both = [np.array(Image.open(f"cut{n}.png").convert("RGB"), int)
                  for n in (0, 2 + len(words))]
    colored = (bare != both).any(axis=2)
    if (colored != seen[1]).any():
        oracle.fail(f"{name} over a CT", f"{colored.sum()} of {seen[1].sum()} pixels")

oracle.checked += 1
done = oracle.tool("gy.dcm", "-o", "gy.png", "-s", "40x40")
if "turbo 0.." not in done.stderr or "from 5% of the most on" not in done.stderr:
    oracle.fail("a dose alone", done.stderr)

# Doses: their unit, and frames by their offsets or their places along z.
for name, unit, tags, step in (
        ("grays", "Gy", {}, 2), ("no unit", "", {"DoseUnits": "RELATIVE"}, 2),
        ("places", "Gy", {"GridFrameOffsetVector": [7, 9, 11],
                          "ImagePositionPatient": [0, 0, 7]}, 2),
        ("places downwards", "Gy", {"GridFrameOffsetVector": [7, 5, 3],
                                    "ImagePositionPatient": [0, 0, 7],
                                    "ImageOrientationPatient": [-1, 0, 0, 0, 1, 0]}, 2)):
    for tag, value in tags.items():
        setattr(dose, tag, value)
    write("gy.dcm", dose)
    turn = np.array(dose.ImageOrientationPatient, float).reshape(2, 3)
    oracle.expect("gy.dcm", stored * 0.001, dicom_sets.grid(
        turn, (1, 1, step), dose.ImagePositionPatient), dtype="u4", name=name)
    oracle.checked += 1
    if oracle.told("gy.dcm").get("value_unit", "") != unit:
        oracle.fail(name, f"not {unit}")
    dose.DoseUnits = "GY"

# What older programs leave: bytes behind the pixels, 0 frames; tables and maps.
table = holds(LUTDescriptor=[2, 0, 16], ModalityLUTType="US",
              LUTData=np.array([0, 9], "u2").tobytes())
table["LUTData"].VR, table["LUTDescriptor"].VR = "OW", "US"
real = holds(RealWorldValueSlope=0.5, RealWorldValueIntercept=0.0)
for name, said, tags in (
        ("more bytes", None, {}), ("0 frames", "claims 0 frames", {"NumberOfFrames": 0}),
        ("a table", "is not applied", {"ModalityLUTSequence": [table]}),
        ("a map", "is not applied", {"RealWorldValueMappingSequence": [real]}),
        ("a map beside a rescale", None,
         {"RealWorldValueMappingSequence": [real], "RescaleSlope": 1,
          "RescaleIntercept": 8})):
    data = image(unsigned[0], rising[0], **tags)
    if name == "more bytes":
        data.PixelData += bytes(34)
    write("old.dcm", data)
    oracle.expect("old.dcm", unsigned[:1] + 1.0 * tags.get("RescaleIntercept", 0),
                  grid((0.5, 0.75, 9), rising[0]), dtype="u2", name=name)
    oracle.says(name, "old.dcm", said)

# What GDCM packs, each way that has a code for the type.
gdcmconv = shutil.which("gdcmconv")
for kind in ("u1", "u2", "i2") if gdcmconv else ():
    voxels = oracle.sample(kind, (5, 20, 30)) // 16
    series("raw", voxels, rising[:5], BitsStored=16 if "2" in kind else 8)
    for way in ("--jpeg", "--jpegls", "--j2k", "--rle", "--implicit",
                "--explicit", "--deflated"):
        oracle.empty_folder("packed")
        for path in glob.glob("raw/*"):
            subprocess.run([gdcmconv, way, path,
                            path.replace("raw", "packed")], check=True)
        if GDCM or way not in ("--jpeg", "--jpegls", "--j2k"):
            oracle.expect("packed", voxels, wanted, name=f"{kind} {way}")
        else:
            oracle.refuse("packed", UNBUILT)

# JPEG 2000 that calls its bits unsigned while the header gives them a sign: a real
# one, as pydicom reads it, and ours, which has 16 bits for 12 stored ones.
try:
    from PIL import Image
except ImportError:
    Image = None
codec = pydicom.data.get_testdata_file("J2K_pixelrep_mismatch.dcm", download=False)
mended = {codec: opened(codec).pixel_array} if codec and GDCM and Image else {}
if GDCM and Image:
    mended["signs.dcm"] = np.arange(-2048, 2048, 2, "i2").reshape(32, 64)
    stream = io.BytesIO()
    Image.fromarray(mended["signs.dcm"].view("u2") & 4095).save(
        stream, "JPEG2000", irreversible=False, no_jp2=True)
    write("signs.dcm", packed(image(mended["signs.dcm"], BitsStored=12),
                              [stream.getvalue()], JPEG2000Lossless))
for path, wanted_values in mended.items():
    if not np.array_equal(oracle.voxels_of(path)[0][0], wanted_values):
        oracle.fail(path, "its bits lack their sign")

# --- several frames -----------------------------------------------------------


def groups(position, slope, intercept):
    return holds(
        PlanePositionSequence=[
            holds(ImagePositionPatient=list(map(float, position)))],
        PixelValueTransformationSequence=[holds(
            RescaleSlope=slope, RescaleIntercept=intercept, RescaleType="US")])


shared = holds(
    PlaneOrientationSequence=[
        holds(ImageOrientationPatient=list(map(float, AXIAL)))],
    PixelMeasuresSequence=[holds(PixelSpacing=[0.75, 0.5], SliceThickness=9)])
for syntax in (ExplicitVRLittleEndian, ExplicitVRBigEndian,
               ImplicitVRLittleEndian):
    many = image(small[shuffled], syntax=syntax,
                 SOPClassUID="1.2.840.10008.5.1.4.1.1.2.1",
                 SharedFunctionalGroupsSequence=[shared],
                 PerFrameFunctionalGroupsSequence=[
                     groups(rising[i], 2, -5) for i in shuffled])
    del many.PixelSpacing
    write("many.dcm", many)
    oracle.expect("many.dcm", small * 2.0 - 5, wanted, dtype="i2", unit="mm",
                  name=f"frames with places {syntax}")
NM = "1.2.840.10008.5.1.4.1.1.20"
write("nm.dcm", image(small, (3, -4, -7), SOPClassUID=NM,
                      SliceVector=list(range(9, 0, -1))))
oracle.expect("nm.dcm", small[::-1], grid((0.5, 0.75, 1), (3, -4, -7)),
              name="numbers of slices")
oracle.says("numbers of slices", "nm.dcm",
            "distance of the slices is missing; 1 mm")
for step in (2.5, -2.5):
    detector = holds(ImagePositionPatient=[3.0, -4, -7],
                     ImageOrientationPatient=list(map(float, AXIAL)))
    write("nm.dcm", image(small, SOPClassUID=NM, SpacingBetweenSlices=step,
                          DetectorInformationSequence=[detector]))
    there = small if step > 0 else small[::-1]
    low = min(-7, -7 + 8 * step)
    oracle.expect("nm.dcm", there, grid((0.5, 0.75, 2.5), (3, -4, low)),
                  name=f"nuclear medicine, {step}")
write("cine.dcm", image(small, SpacingBetweenSlices=2))
oracle.expect("cine.dcm", small, np.diag([0.5, -0.75, -2, 1]),
              name="frames 2 mm apart without a place")
write("cine.dcm", image(small))
oracle.expect("cine.dcm", small, np.diag([0.5, -0.75, -1, 1]),
              name="frames without a place")
oracle.says("cine", "cine.dcm", "distance of the slices is missing; 1 mm")

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


def expect_ybr(samples, name):
    """Y, Cb, Cr of a pixel are red, green, blue."""
    want = convert_color_space(samples, "YBR_FULL", "RGB")
    for channel in range(3):
        oracle.expect("ybr.dcm", want[None, ..., channel],
                      grid((0.5, 0.75, 9), (0, 0, 0)), ["--channel", channel],
                      name=f"{name} {channel}")


expect_ybr(colour, "YBR_FULL")
plain = rgb.PixelData
write("ybr.dcm", packed(rgb, [b"\xff\xd8" + bytes(40)], JPEGBaseline8Bit))
if GDCM:
    oracle.refuse("ybr.dcm", "do not begin like those")
write("ybr.dcm", run_lengths(rgb, [colour]))
expect_ybr(colour, "YBR_FULL in run lengths")
rgb.file_meta.TransferSyntaxUID = ExplicitVRLittleEndian
rgb.PixelData = plain
rgb["PixelData"].is_undefined_length = False
rgb.PhotometricInterpretation = "YBR_FULL_422"
rgb.PlanarConfiguration = 0
# Two pixels are Y, Y, Cb, Cr; some that say so have three values of each.
pairs = colour[:, :4].reshape(6, 2, 6)[..., [0, 3, 1, 2]]
spread = pairs[..., [0, 2, 3, 1, 2, 3]].reshape(6, 4, 3)
rgb.Columns = 4
for data, whole in ((pairs, spread), (colour[:, :4], colour[:, :4])):
    rgb.PixelData = data.tobytes()
    write("ybr.dcm", rgb)
    expect_ybr(whole, f"YBR_FULL_422 {data.size}")
rgb.PixelData = pairs.tobytes()[:-2]
write("ybr.dcm", rgb)
oracle.refuse("ybr.dcm", "have 46 bytes, not the 48")
rows = image(oracle.sample("u2", (5, 6)), (0, 0, 0))
want = rows.pixel_array
rows.PixelData += bytes(12)
write("rows.dcm", rows)
oracle.expect("rows.dcm", want[None], grid((0.5, 0.75, 9), (0, 0, 0)),
              name="a row more than the header says")
oracle.says("a row more", "rows.dcm", "have 12 bytes more than its rows")

# JPEG's own brightness and hue, as Pillow packs and unpacks them.
if GDCM and Image:
    smooth = np.linspace(0, 255, 16 * 16 * 3).reshape(16, 16, 3).astype("u1")
    for halved, kind in ((0, "YBR_FULL"), (1, "YBR_FULL_422")):
        stream = io.BytesIO()
        Image.fromarray(smooth).save(stream, "JPEG", subsampling=halved)
        photo = Image.open(stream)
        photo.draft("YCbCr", photo.size)
        rgb.Rows = rgb.Columns = 16
        rgb.PhotometricInterpretation = kind
        write("ybr.dcm", packed(rgb, [stream.getvalue()], JPEGBaseline8Bit))
        expect_ybr(np.asarray(photo), f"{kind} in JPEG")


def palette(first=0, count=256, bits=16, words=True, **tags):
    """Of numbers of colours, and these as red, green, blue of 0 to 255."""
    numbers = oracle.sample(tags.pop("dtype", "u1"), (7, 5))
    data = image(numbers, (0, 0, 0), PhotometricInterpretation="PALETTE COLOR",
                 **tags)
    kind = "u2" if bits == 16 else "u1"
    tables = [oracle.sample(kind, (count,), seed) for seed in (2, 3, 4)]
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
    colours = np.stack([table[at] for table in tables])
    if bits == 16:
        theirs = apply_color_lut(data.pixel_array, data)
        assert order == ">" or (np.moveaxis(theirs, -1, 0) == colours).all()
        colours = np.floor(colours / 257 + 0.5)
    return data, colours[:, None]


def expect_palette(colours, name):
    for channel in range(3):
        oracle.expect("palette.dcm", colours[channel], grid((0.5, 0.75, 9), (0, 0, 0)),
                      ["--channel", channel], dtype="u1", unit="mm",
                      name=f"{name} {channel}")


for what in ({}, {"bits": 8}, {"bits": 8, "words": False},
             {"bits": 8, "words": False, "count": 7, "first": 100},
             {"first": 30, "count": 101}, {"dtype": "u2", "count": 65536},
             {"dtype": "i2", "first": -900, "count": 2000},
             {"syntax": ExplicitVRBigEndian, "dtype": "u2"},
             {"syntax": ExplicitVRBigEndian, "bits": 8, "words": False}):
    data, colours = palette(**what)
    write("palette.dcm", data)
    expect_palette(colours, f"palette {what}")
data, colours = palette()
data.RescaleSlope, data.RescaleIntercept = 2, -5  # of no meaning here
write("palette.dcm", data)
expect_palette(colours, "palette with a slope")

# 2 entries, lines of 2 and 5, the first two segments once more, and a line of 3.
for bits, kind in ((16, "u2"), (8, "u1")):
    data, _ = palette(count=16, bits=bits, words=bits == 16)
    far = 60000 if bits == 16 else 250
    for name, low in (("Red", 3), ("Green", 77), ("Blue", 150)):
        again = (0, 0) if bits == 16 else (0, 0, 0, 0)
        parts = [0, 2, low, far - low, 1, 2, low + 99, 1, 5, far, 2, 2, *again, 0, 3, 1, 2, low]
        setattr(data, f"Segmented{name}PaletteColorLookupTableData",
                np.array(parts + [0] * (len(parts) % 2), kind).tobytes())
        data[f"Segmented{name}PaletteColorLookupTableData"].VR = "OW"
        delattr(data, f"{name}PaletteColorLookupTableData")
    write("palette.dcm", data)
    theirs = np.moveaxis(apply_color_lut(data.pixel_array, data), -1, 0)[:, None]
    expect_palette(np.floor(theirs / (257 if bits == 16 else 1) + 0.5), f"segments of {bits} bits")
    for length in range(4):  # the first segment, cut
        data.SegmentedGreenPaletteColorLookupTableData = b"\0\0\2\0\1\0"[:2 * length]
        write("palette.dcm", data)
        oracle.refuse("palette.dcm", "of which some are missing")
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
                            b"\0\0\1\0\2\0")), "of which some are missing")):
    data, _ = palette()
    change(data)
    write("palette.dcm", data)
    oracle.refuse("palette.dcm", what)
bit = image(oracle.sample("u1", (8, 8)), BitsAllocated=1, BitsStored=1)
bit.PixelData = bytes(8)
write("bit.dcm", bit)
oracle.refuse("bit.dcm", "pixels of 1 bits are not supported")
write("odd.dcm", image(small[0], rising[0], PixelSpacing=[0, 0.5]))
oracle.expect("odd.dcm", small[:1], grid((1, 1, 9), rising[0]),
              name="a spacing of 0")
oracle.says("a spacing of 0", "odd.dcm", "1 mm is used")
oracle.refuse("odd.dcm", "a file of the format dicom, whose header has sizes",
              ["--dims", "5x6x1"], 2)
oracle.refuse("odd.dcm", "--dataset x", ["--dataset", "x"], 2)
whole = oracle.got("odd.dcm")
os.mkdir("cut")
for size in oracle.few(range(0, len(whole), 7), 5):
    done = oracle.run(oracle.put("cut/a.dcm", whole[:size]))
    oracle.checked += 1
    if done.returncode != 3 or done.stderr.count("\n") != 1:
        oracle.fail(f"cut at {size}", f"{done.returncode} {done.stderr}")
series("broken", small, rising)
whole = oracle.got("broken/s_4.dcm")
for size in (len(whole) - 10, 300):
    oracle.put("broken/s_4.dcm", whole[:size])
    closed("broken", "s_4.dcm: is truncated or damaged")
    holed = small[:9].astype("f4")
    holed[4] = np.nan
    oracle.expect("broken", holed, wanted, ["--allow-gaps"],
                  name=f"a slice cut to {size} bytes")
    oracle.says("a slice beside one that is cut", "broken/s_0.dcm",
                "1 file beside it cannot be read (s_4.dcm); slices of the "
                "volume may be missing")
series("packed", small, rising)
for i in range(9):
    data = opened(f"packed/s_{i}.dcm")
    write(f"packed/s_{i}.dcm", run_lengths(data, [small[i]]))
oracle.expect("packed", small, wanted, ["--allow-gaps"],
              name="run lengths, whole with gaps allowed")
os.truncate("packed/s_4.dcm", os.path.getsize("packed/s_4.dcm") - 20)
closed("packed", "packed/s_4.dcm: ")
for options in ([], ["--allow-gaps"]):
    oracle.expect("packed", holed, wanted, options,
                  name=f"run lengths that are cut {options}")
oracle.says("run lengths that are cut", "packed", "s_4.dcm is cut",
            "--allow-gaps")
oracle.put("broken/s_3.dcm", whole[:300])
oracle.says("a slice beside two that are cut", "broken/s_0.dcm",
            "2 files beside it cannot be read")
oracle.put("plain.raw", bytes(60))
oracle.refuse("plain.raw", "files of the format raw have no series",
              ["--series", "1", "--dims", "3x4x5", "--type", "uint8"], 2)

# --- privacy ------------------------------------------------------------------

series("private", small, rising, SpecificCharacterSet="ISO_IR 100",
       PatientName="Hiddén^Person")
oracle.checked += 1
done = [oracle.tool(*words, text=False) for words in (
    ["info", "private"], ["info", "--json", "private"],
    ["private", "-o", "p.png", "-v", "--stats", "p.json", "--save-config",
     "c.json"], ["info", "private/s_1.dcm"])]
for text in [one.stdout + one.stderr for one in done] + [
        oracle.got(name) for name in ("p.png", "p.json", "c.json")]:
    for word in (b"Hidd", b"Person", b"Quitzkow"):
        if word in text:
            oracle.fail("a name is told", text)
oracle.tells("private", ["--patient"], patient="Hiddén^Person")

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
        found = oracle.told(path)
        expected = expected or found
        for key in ("dims", "type", "min", "max", "sum", "wsum", "finite",
                    "matrix"):
            if found.get(key) != expected[key]:
                oracle.fail(name, f"{key} {found.get(key)}, "
                            f"not {expected[key]}")


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
        data = scale = opened(path)
        pixels = data.pixel_array
        if "SharedFunctionalGroupsSequence" in data:
            scale = data.SharedFunctionalGroupsSequence[0].get(
                "PixelValueTransformationSequence", [data])[0]
            pixels = pixels[::-1]  # along the normal, which is down
        oracle.same_figures(name, oracle.told(path), oracle.figures(
            values(scale, np.atleast_3d(pixels))))
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
# PET opens as a projection on white, from 0 on; thin slabs of scans, and few thick
# slices, as one from their face.
dose = np.random.default_rng(2).integers(0, 900, (6, 9, 8)).astype("u2")
top = np.percentile(dose, 99.9, method="inverted_cdf")
FACE = "view inferior; mode mip for a slab "
for modality, step, words in (("PT", 2, f"grey_r 0..{top}"), ("NM", 2, ""),
                              ("MR", 0.1, FACE), ("CT", 0.1, FACE),
                              ("NM", 0.1, ""), ("MR", 2, ""),  # below 3 pixels
                              ("MR", 2.3, FACE), ("CT", 2.3, FACE), ("NM", 2.3, "")):
    oracle.checked += 1
    folder = f"looks_{modality}_{step}"
    series(folder, dose, [(0, 0, step * n) for n in range(6)], Modality=modality)
    said = oracle.tool("render", folder, "-o", "look.png", "-y", "-s", "60").stderr
    if ("mode mip" in said and words in said) != bool(words):
        oracle.fail(f"a picture of {modality}", said)
pet()  # nuclear medicine shows 0 to 7 of SUV
oracle.checked += 1
said = oracle.tool("render", "pet", "-o", "look.png", "-y", "-s", "60").stderr
if "grey_r 0..7;" not in said:
    oracle.fail("a picture of SUV", said)
oracle.finish()
