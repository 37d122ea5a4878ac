"""Siemens mosaics beside nibabel, and beside dcm2niix where that is installed:
sheets of our own, and the real ones that nibabel's tests have."""
import glob
import gzip
import os
import shutil
import struct
import subprocess
import warnings

import oracle
from oracle import np
import dicom_sets
from dicom_sets import RAS, blank, fill, write

warnings.simplefilter("ignore") # nibabel says that its reader is experimental
nibabel, wrappers = oracle.need("nibabel", "nibabel.nicom.dicomwrappers")
DCM2NIIX = shutil.which("dcm2niix")


def csa(version=2, **tags):
    """A CSA header: texts by their names, each in an item."""
    body = b""
    # in the first version lengths count the first tag's items too
    for name, values in {"Echo": ["1"], **tags}.items():
        kind = b"US" if name.startswith("Number") else \
            b"SH" if name.endswith("Text") else b"FD"
        body += struct.pack("<64si4siii", name.encode(), len(values), kind, 4,
                            len(values), 77)
        for value in values:
            text = f"{value}\0".encode()
            sizes = (len(text), len(text)) if version == 2 else \
                (len(text) + 1, 0)
            body += struct.pack("<4i", *sizes, 77, 0)
            body += text + b"\0" * (-len(text) % 4)
    begin = b"SV10\4\3\2\1" if version == 2 else b""
    return begin + struct.pack("<II", 1 + len(tags), 77) + body


def sheet(slices, side):
    """Slices as tiles of a frame, row by row."""
    count, rows, columns = slices.shape
    out = np.zeros((side * rows, side * columns), slices.dtype)
    for k, one in enumerate(slices):
        y, x = k // side * rows, k % side * columns
        out[y:y + rows, x:x + columns] = one
    return out


def mosaic(pixels, number=None, header=None, syntax=None, **tags):
    data = blank(**({"syntax": syntax} if syntax else {}), **{
        "Rows": pixels.shape[0], "Columns": pixels.shape[1],
        "BitsAllocated": 16, "BitsStored": 16, "HighBit": 15,
        "PixelRepresentation": 0, "Modality": "MR", "Manufacturer": "SIEMENS",
        "ImageType": ["ORIGINAL", "PRIMARY", "M", "ND", "MOSAIC"],
        "SeriesInstanceUID": "1.2.3", "PixelSpacing": [1.5, 2],
        "ImagePositionPatient": [-50, -60, 7], "SpacingBetweenSlices": 2.5,
        "ImageOrientationPatient": [1, 0, 0, 0, 0.8, 0.6],
        "SeriesInstanceUID": "1.2.3", **tags})
    if number is not None:
        data.private_block(0x19, "SIEMENS MR HEADER", create=True).add_new(
            0x0a, "US", number)
    if header:
        data.private_block(0x29, "SIEMENS CSA HEADER", create=True).add_new(
            0x10, "OB", header + b"\0" * (len(header) % 2))
    return fill(data, pixels[None] if syntax else pixels)


UP, DOWN = ["0", "-0.6", "0.8"], ["0", "0.6", "-0.8"]


def theirs(path):
    """What nibabel makes of it: voxels (z, y, x) and our matrix, whose slices
    follow row x column."""
    read = wrappers.wrapper_from_file(path)
    values = read.get_data().transpose(2, 0, 1)
    matrix = RAS @ read.affine[:, [1, 0, 2, 3]]
    row, column = read.image_orient_patient.T
    if np.dot(read.slice_normal, np.cross(row, column)) < 0:
        matrix[:3, 3] += matrix[:3, 2] * (len(values) - 1)
        matrix[:3, 2] *= -1
        values = values[::-1]
    return values, matrix


def beside_dcm2niix(folder):
    """Its voxels lie where ours do, in all time steps."""
    oracle.empty_folder("nii")
    subprocess.run([DCM2NIIX, "-b", "n", "-o", "nii", folder], check=True,
                   stdout=subprocess.DEVNULL)
    image = nibabel.load(glob.glob("nii/*.nii")[0])
    steps = np.asarray(image.dataobj).reshape(*image.shape[:3], -1)
    for time in range(steps.shape[3]):
        values, matrix = oracle.voxels_of(folder, ["--time", time])
        near = np.linalg.inv(image.affine) @ np.vstack([matrix, [0, 0, 0, 1]])
        z, y, x = np.indices(values.shape)
        at = np.einsum("ij,j...->i...", near,
                       np.stack([x, y, z, np.ones_like(x)]))[:3]
        whole = np.rint(at).astype(int)
        oracle.checked += 1
        if np.abs(at - whole).max() > 1e-2 or \
                not np.array_equal(steps[..., time][tuple(whole)], values):
            oracle.fail(folder, f"time {time} differs from dcm2niix")


voxels = oracle.sample("u2", (2, 7, 4, 6)) % 4096
with_number = {"NumberOfImagesInMosaic": ["7"],
               "AcquisitionMatrixText": ["4p*6"]} # which nibabel asks for
for name, number, header, tags in (
        ("up", 7, csa(SliceNormalVector=UP, **with_number), {}),
        ("down", 7, csa(SliceNormalVector=DOWN, **with_number), {}),
        ("csa alone", None, csa(SliceNormalVector=DOWN, **with_number), {}),
        ("no word in the type", 7, csa(SliceNormalVector=UP, **with_number),
         {"ImageType": ["ORIGINAL", "PRIMARY"]}),
        ("run lengths", 7, csa(SliceNormalVector=UP, **with_number),
         {"syntax": dicom_sets.RLELossless})):
    oracle.empty_folder("series")
    for time in range(2):
        write(f"series/{time}.dcm", mosaic(
            sheet(voxels[time], 3), number, header, InstanceNumber=time + 1,
            **tags))
    for time in range(2):
        found = theirs(f"series/{time}.dcm")
        oracle.expect("series", *found, ["--time", time], unit="mm",
                      name=f"{name} {time}")
    if DCM2NIIX and "ImageType" not in tags:
        beside_dcm2niix("series")
up = found[1]
oracle.expect("series/1.dcm", voxels[1], up, name="one file")

# --- what is not said ---------------------------------------------------------

flat = sheet(voxels[0], 3)
write("one.dcm", mosaic(flat, None, csa(1, SliceNormalVector=UP, **with_number)))
oracle.expect("one.dcm", voxels[0], up, name="the first version")
oracle.says("a normal", "one.dcm", None)
write("one.dcm", mosaic(flat, 7))
oracle.expect("one.dcm", voxels[0], up, name="no normal")
oracle.says("no normal", "one.dcm", "in which direction its slices follow")
lacking = mosaic(flat, 7, csa(SliceNormalVector=UP, SpacingBetweenSlices=["2.5"]))
del lacking.SpacingBetweenSlices
write("one.dcm", lacking)
oracle.expect("one.dcm", voxels[0], up, name="the CSA's distance")
for number, pixels, said in (
        (None, flat, "without the number of its slices"),
        (0, flat, "without the number of its slices"),
        (40000, flat, "mosaic of 200x200 tiles, but its 18x12 pixels"),
        (7, flat[:, :-1], "mosaic of 3x3 tiles, but its 17x12 pixels")):
    write("one.dcm", mosaic(pixels, number))
    oracle.refuse("one.dcm", said)
write("one.dcm", mosaic(flat, 1))
oracle.tells("one.dcm", dims=[18, 12, 1])

# --- real ones ----------------------------------------------------------------

real = glob.glob(os.path.join(os.path.dirname(wrappers.__file__), "tests", "data",
                              "siemens_dwi_*.dcm.gz"))
oracle.empty_folder("real")
for path in sorted(real):
    oracle.put("real/" + os.path.basename(path)[:-3],
               gzip.decompress(oracle.got(path)))
for time, path in enumerate(sorted(glob.glob("real/*"))):
    oracle.expect("real", *theirs(path), ["--time", time], name=path)
if DCM2NIIX and real:
    beside_dcm2niix("real")
oracle.finish()
