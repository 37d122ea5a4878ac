"""report.py TOOL DATA: files whose every text is a made-up name, written by the packages that
others write theirs with.  No name, path or folder is in what it prints; tags and
lengths are those that pydicom, nibabel, tifffile, h5py and netCDF4 list."""
import json
import os
import re

import oracle
from oracle import np

pydicom, nibabel, tifffile, h5py, netCDF4, zarr = oracle.need(
    "pydicom", "nibabel", "tifffile", "h5py", "netCDF4", "zarr")
from pydicom.dataset import Dataset, FileMetaDataset
from pydicom.sequence import Sequence
from pydicom.uid import ExplicitVRBigEndian, ExplicitVRLittleEndian, \
    ImplicitVRLittleEndian

NAMES = ["zaphod", "beeblebrox", "Quzzle", "ADENOIDH", "19520311", "76543218"]
ALL = "Zaphod^Beeblebrox Quzzle ADENOIDH 19520311 76543218"
folder = "Clinic of Dr Quzzle/zaphod beeblebrox 19520311"
os.makedirs(folder)


def path(name):
    return f"{folder}/quzzle.{name}"


def report(file, *options):
    """The lines of a report; none of them, and no message, has a name."""
    oracle.checked += 1
    done = oracle.tool("report", file, *options)
    if done.returncode:
        oracle.fail(file, done.stderr)
    for name in NAMES + ["clinic"]:
        if name.lower() in (done.stdout + done.stderr).lower():
            oracle.fail(file, f"{name} is in the report: " + next(
                line for line in (done.stdout + done.stderr).split("\n")
                if name.lower() in line.lower()))
    return done.stdout.split("\n")


def has(lines, *wanted):
    for line in wanted:
        oracle.checked += 1
        if not any(re.fullmatch(line, found.strip()) for found in lines):
            oracle.fail(line, "is not in the report:\n" + "\n".join(lines)[-3000:])


# --- DICOM --------------------------------------------------------------------

# What each representation may hold; numbers hold numbers.
TEXTS = {"AE": "ZAPHOD", "AS": "042Y", "CS": "ADENOIDH", "DA": "19520311",
         "DT": "19520311", "LO": ALL, "LT": ALL, "PN": ALL, "SH": "Quzzle",
         "ST": ALL, "TM": "101112", "UC": ALL, "UT": ALL, "UR": "http://quzzle",
         "UI": "1.2.76543218.19520311", "DS": "19520311", "IS": "76543218",
         "UN": b"Quzzle", "OB": b"Quzzle", "OW": b"Quzzle"}


def named(syntax, modality="CT"):
    """A slice with every element of text that the dictionary has, half of them
    within a sequence, and a private one."""
    whole, inner = Dataset(), Dataset()
    for n, (tag, row) in enumerate(sorted(pydicom.datadict.DicomDictionary.items())):
        kind = row[0]
        if tag >> 16 in (0, 2, 0x7fe0) or tag >> 16 >= 0xfffa or kind not in TEXTS:
            continue
        # Those that say where and how large the picture is, which it must have.
        if tag >> 16 == 0x28 or tag in (0x00080005, 0x00080016):
            continue
        if kind in ("DS", "IS") and tag >> 16 in (0x18, 0x20, 0x54, 0x3004, 0x62):
            continue
        (inner if n % 2 and tag >> 16 != 8 else whole).add_new(tag, kind, TEXTS[kind])
    whole.add_new(0x00291010, "LO", ALL)
    whole.add_new(0x00290010, "LO", "QUZZLE INC")
    whole.RequestAttributesSequence = Sequence([inner, inner])
    whole.PatientName, whole.Modality = ALL, modality
    whole.SOPClassUID = "1.2.840.10008.5.1.4.1.1.2"
    whole.Rows, whole.Columns, whole.SamplesPerPixel = 4, 6, 1
    whole.PhotometricInterpretation = "MONOCHROME2"
    whole.BitsAllocated = whole.BitsStored = 16
    whole.HighBit, whole.PixelRepresentation = 15, 1
    whole.PixelSpacing = [0.5, 0.75]
    whole.ImagePositionPatient, whole.SliceThickness = [0, 0, 4], 2
    whole.ImageOrientationPatient = [1, 0, 0, 0, 1, 0]
    whole.PixelData = np.arange(24, dtype="u2").tobytes()
    whole["PixelData"].VR = "OW"
    meta = FileMetaDataset()
    meta.TransferSyntaxUID = syntax
    meta.MediaStorageSOPClassUID = whole.SOPClassUID
    meta.MediaStorageSOPInstanceUID = "1.2.76543218.19520311"
    whole.file_meta = meta
    whole.is_little_endian = syntax != ExplicitVRBigEndian
    whole.is_implicit_VR = syntax == ImplicitVRLittleEndian
    return whole


for syntax in (ExplicitVRLittleEndian, ImplicitVRLittleEndian, ExplicitVRBigEndian):
    file = path("dcm")
    whole = named(syntax)
    whole.save_as(file, write_like_original=False)
    lines = report(file)
    read = pydicom.dcmread(file)
    kinds = not whole.is_implicit_VR
    for element in read:
        if element.VR == "SQ" or element.tag.group == 2:
            continue
        size = read.get_item(element.tag).length if hasattr(
            read.get_item(element.tag), "length") else None
        size = r"\d+" if size is None else size
        has(lines, rf"\({element.tag.group:04x},{element.tag.elem:04x}\) "
                   rf"{element.VR if kinds and element.VR != 'UN' else '..'} {size}( .*)?")
    has(lines, r"\(0002,0010\) UI \d+ TransferSyntaxUID = " + syntax,
        r"\(0028,0010\) .. 2 Rows = 4", r"\(0028,0011\) .. 2 Columns = 6",
        r"\(0028,0030\) .. 8 PixelSpacing = 0\.5\\0\.75",
        r"\(0008,0060\) .. 2 Modality = CT", r"\(7fe0,0010\) .. 48 PixelData")
    if kinds:
        has(lines, r"\(0040,0275\) SQ \d+", "2 items")
        has(lines, *[rf"\({e.tag.group:04x},{e.tag.elem:04x}\) "
                     rf"{e.VR if e.VR != 'UN' else '..'} \d+( .*)?"
                     for e in read.RequestAttributesSequence[0]])
    has(lines, r'.*"format": "dicom".*"dims": \[6, 4, 1\].*')

# Technical elements that hold names: their values are not written.
file = path("names.dcm")
whole = named(ExplicitVRLittleEndian, modality="ADENOIDH")
for key in ("ImageType", "PatientPosition", "PhotometricInterpretation", "Units",
            "RescaleType"):
    setattr(whole, key, "ADENOIDH")
whole.add_new(0x00281050, "LO", ALL)
whole.save_as(file, write_like_original=False)
has(report(file), r"\(0008,0060\) CS 8 Modality = text of 8 bytes")

# A folder, and one that the library refuses, whose message names files.
for n in range(3):
    whole = named(ExplicitVRLittleEndian)
    whole.ImagePositionPatient = [0, 0, 2 * n]
    whole.SeriesInstanceUID, whole.FrameOfReferenceUID = "1.2.3", "1.2.4"
    os.makedirs(folder + "/quzzle", exist_ok=True)
    whole.save_as(f"{folder}/quzzle/beeblebrox{n}", write_like_original=False)
has(report(folder + "/quzzle"), "folder of 3 files and 0 folders, .*",
    r".*\"dims\": \[6, 4, 3\].*")
whole.save_as(f"{folder}/quzzle/zaphod", write_like_original=False)
has(report(folder + "/quzzle"), "(warning|error 3): .*")

# --- NIfTI --------------------------------------------------------------------

for kind, order in ((nibabel.Nifti1Image, "<"), (nibabel.Nifti2Image, ">")):
    header = kind.header_class(endianness=order)
    header.set_data_dtype("i2")
    image = kind(np.arange(60).reshape(3, 4, 5).astype(order + "i2"),
                 np.diag([2, 3, 4, 1]), header)
    for key in ("descrip", "aux_file", "intent_name") + (
            ("db_name", "data_type") if kind is nibabel.Nifti1Image else ()):
        image.header[key] = ALL[:10]
    image.header.extensions.append(
        nibabel.nifti1.Nifti1Extension("comment", ALL.encode()))
    image.to_filename(path("nii.gz"))
    lines = report(path("nii.gz"))
    read = nibabel.load(path("nii.gz")).header
    for key in ("dim", "datatype", "bitpix", "pixdim", "sform_code", "srow_x", "srow_z",
                "xyzt_units"):
        values = [f"{float(v):.9g}" for v in np.atleast_1d(read[key])]
        has(lines, rf"{key} +" + " ".join(map(re.escape, values)))
    has(lines, f"vox_offset +{nibabel.load(path('nii.gz')).dataobj.offset}",
        "descrip +10 of 80 bytes", r"extension: code 6, \d+ bytes",
        r'.*"dims": \[3, 4, 5\], "type": "int16".*')

# --- NRRD and MetaImage -------------------------------------------------------

oracle.put(path("nrrd"), f"NRRD0004\n# {ALL}\ncontent: {ALL}\ntype: short\n"
           "dimension: 3\nsizes: 2 2 2\nspace: right-anterior-superior\n"
           f"space directions: (1,0,0) (0,1,0) (0,0,2)\nencoding: raw\n"
           f"endian: little\nPatientName:={ALL}\n{ALL}:=4\n\n" + "\0" * 16)
has(report(path("nrrd")), "type: short", "sizes: 2 2 2",
    r"space directions: \(1,0,0\) \(0,1,0\) \(0,0,2\)",
    f"key of 11 bytes, value of {len(ALL)} bytes",
    f"key of 7 bytes, value of {len(ALL)} bytes", "header of [0-9]+ bytes")
oracle.put(path("mha"), f"ObjectType = Image\nNDims = 3\nName = {ALL}\n"
           "DimSize = 2 2 2\nElementType = MET_UCHAR\nElementSpacing = 1 1 3\n"
           f"PatientName = {ALL}\nElementDataFile = LOCAL\n" + "\1" * 8)
has(report(path("mha")), "DimSize = 2 2 2", "ElementSpacing = 1 1 3",
    f"key of 4 bytes, value of {len(ALL)} bytes", "ElementDataFile = LOCAL")
oracle.put(path("mhd"), "ObjectType = Image\nNDims = 3\nDimSize = 2 2 2\n"
           "ElementType = MET_UCHAR\nElementDataFile = zaphod.raw\n")
has(report(path("mhd")), "ElementDataFile = text of 10 bytes", "error 3: .*")

# --- TIFF ---------------------------------------------------------------------

for large, order in ((False, "<"), (True, ">")):
    tifffile.imwrite(path("ome.tif"), np.zeros((2, 3, 20, 30), "u2"), bigtiff=large,
                     byteorder=order, ome=True, software=ALL, datetime=None,
                     metadata={"axes": "CZYX", "Name": ALL, "PhysicalSizeX": 0.25,
                               "PhysicalSizeXUnit": "µm",
                               "Channel": {"Name": ["zaphod", "Quzzle"]}},
                     extratags=[(315, "s", 0, ALL, True), (65000, "s", 0, ALL, True)])
    lines = report(path("ome.tif"))
    with tifffile.TiffFile(path("ome.tif")) as read:
        for tag in read.pages[0].tags:
            has(lines, rf"{tag.code} type {int(tag.dtype)} count {tag.count}( .*)?")
        has(lines, f"{len(read.pages)} directories")
    has(lines, "256 type . count 1 ImageWidth = 30", 'SizeC 2', 'PhysicalSizeX 0.25',
        r'.*"channel_count": 2.*')

# --- HDF5, NetCDF -------------------------------------------------------------

for library in ("earliest", "latest"):
    with h5py.File(path("h5"), "w", libver=library) as file:
        group = file.create_group("zaphod/beeblebrox")
        file.attrs["Quzzle"] = ALL
        data = group.create_dataset("quzzle", data=np.zeros((4, 5, 6), "f4"),
                                    chunks=(2, 5, 6), compression="gzip", shuffle=True)
        data.attrs["units"] = ALL
        data.attrs["scale_factor"] = 0.5
        data.attrs["id"] = 76543218
        data.attrs["ADENOIDH"] = [1, 2, 3]
        for n in range(20): # more than fit beside one another
            group.create_dataset(f"zaphod{n}", data=np.zeros(n + 1, "i2"))
    lines = report(path("h5"))
    has(lines, r"1 shape, \d+ bytes: shape 4 5 6", r"3 type, \d+ bytes: float of 4 bytes",
        r"8 layout, \d+ bytes: layout chunked 2 5 6 4", r"11 filters, \d+ bytes: filters 2 1",
        r"12 attribute, \d+ bytes: scale_factor float of 8 bytes scalar = 0\.5",
        r"12 attribute, \d+ bytes: \(name of 8 bytes\) integer of 8 bytes shape 3",
        r"12 attribute, \d+ bytes: units .*", "24 objects in .*",
        *[rf"1 shape, \d+ bytes: shape {n + 1}" for n in range(20)])

for form in ("NETCDF3_CLASSIC", "NETCDF3_64BIT_OFFSET", "NETCDF3_64BIT_DATA", "NETCDF4"):
    with netCDF4.Dataset(path("nc"), "w", format=form) as file:
        file.quzzle, file.number = ALL, np.int32(76543218)
        for name, size in (("time", None), ("z", 3), ("zaphod", 4), ("x", 5)):
            file.createDimension(name, size)
        one = file.createVariable("beeblebrox", "f4", ("time", "z", "zaphod", "x"))
        one.units, one.scale_factor, one.long_name = "K", 0.25, ALL
        one[:] = np.zeros((1, 3, 4, 5))
    lines = report(path("nc"))
    if form == "NETCDF4":
        has(lines, r"1 shape, \d+ bytes: shape 1 3 4 5")
    else:
        has(lines, "dimension 1 z 3", r"dimension 2 \(name of 6 bytes\) 4",
            r"variable \(name of 10 bytes\) dimensions 0 1 2 3",
            "attribute units type 2 count 1 = K",
            r"attribute scale_factor type 6 count 1 = 0\.25",
            f"attribute long_name type 2 count {len(ALL)} = text of {len(ALL)} bytes")

# --- Zarr ---------------------------------------------------------------------

store = zarr.open_group(folder + "/zaphod.zarr", "w")
store.attrs.update({"quzzle": ALL, "patient": {"id": 76543218, "name": ALL},
                    "id": 76543218,
                    "multiscales": [{"version": "0.4", "name": ALL,
                                     "axes": [{"name": n, "type": "space"}
                                              for n in "zyx"],
                                     "datasets": [{"path": "beeblebrox"}]}]})
store.create_dataset("beeblebrox", data=np.zeros((4, 5, 6), "u2"), chunks=(2, 5, 6))
store["beeblebrox"].attrs.update({"ADENOIDH": ALL, "long_name": ALL})
lines = report(folder + "/zaphod.zarr")
has(lines, r'\.zarray .*"chunks": \[2, 5, 6\].*"shape": \[4, 5, 6\].*',
    r'\.zattrs .*"multiscales".*"axes".*')

# --- damage -------------------------------------------------------------------

# A report is wanted of files that are damaged.
for name in ("dcm", "nrrd", "mha", "ome.tif", "h5", "nc"):
    for n in range(2 if oracle.SHORT else 20):
        whole = bytearray(oracle.got(path(name)))
        for _ in range(oracle.chance.choice((1, 8, 64))):
            whole[oracle.chance.randrange(min(len(whole), 3000))] = \
                oracle.chance.choice((0, 1, 0x7f, 0xff, oracle.chance.randrange(256)))
        oracle.put(path("damaged"), bytes(whole[:oracle.chance.choice((-1, 900, 90))]))
        report(path("damaged"))

# --- what the library refuses, and where the report goes ------------------------

for name, content in (("txt", ALL * 9), ("empty", ""), ("dat", bytes(range(256)) * 9),
                      ("nii", b"\x5c\x01\0\0" + ALL.encode() * 30),
                      ("tif", b"II*\0\x08\0\0\0\xff\xff" + ALL.encode() * 90),
                      ("cut.nc", b"CDF\1\0\0\0\0\0\0\0\x0a\0\0\0\2\0\0\0\6zaphod")):
    oracle.put(path(name), content)
    has(report(path(name)), "error 3: .*")
report(path("h5") + ":/zaphod/beeblebrox/quzzle")
report(path("h5"), "--dataset", "zaphod/none")
shown = report(path("nrrd"), "-o", "kept.txt")
oracle.checked += 1
if oracle.got("kept.txt").decode() != "\n".join(shown):
    oracle.fail("-o", "the file is not what was shown")
has(report(path("nrrd"), "-y", "-o", "kept.txt"), "structure")
has(report("phantom:head", "--dims", "8x8x8"), "a phantom, which has no file",
    r'.*"dims": \[8, 8, 8\].*')
has(report("phantom:quzzle"), "error [0-9]: .*")
done = oracle.tool("report", "absent.nii")
oracle.checked += 1
if done.returncode != 3 or "absent.nii" not in done.stderr:
    oracle.fail("an absent file", done.stderr)
oracle.finish()
