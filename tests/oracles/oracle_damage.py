"""Damaged codes inside TIFF and DICOM: the file is refused, or has the voxels
of the whole one.  Memory that was never written shows by two fillings of the
allocator.  What is whole is read, in each way to code it."""
import io
import os
import struct
import subprocess
import sys

try:
    import numpy as np
    import pydicom
    import tifffile
    from PIL import Image, features
    from pydicom.encaps import encapsulate, generate_pixel_data_frame
except ImportError as missing:
    print("skip  ", missing)
    sys.exit(77)
import oracle

oracle.need_modules()
CORPUS = os.path.join(os.path.dirname(os.path.abspath(__file__)),
                      "../../fuzz/corpus/dicom")
FILL = "MALLOC_PERTURB_"
JPEG = "1.2.840.10008.1.2.4."
IN_BLOCKS = "middle", "to the end marker"
y, x = np.mgrid[:60, :72]
picture = ((x * 3 + y * 2) % 251).astype("u1")


def told(data, fills=("1", "254")):
    """The exit status and what `info` says of the voxels, which does not depend
    on the filling."""
    with open("damaged", "wb") as file:
        file.write(data)
    found = []
    for fill in fills:
        os.environ[FILL] = fill
        done = oracle.run("damaged")
        found.append((done.returncode, done.stdout))
        if done.returncode:
            break
    del os.environ[FILL]
    return found[0] if found[0] == found[-1] else ("changes", found)


def damage(code):
    """A code that ends early, also before its end marker; zeros up to its end,
    up to that marker, and within."""
    size = len(code)
    for part in 0.55, 0.75, 0.9:
        keep = int(size * part)
        yield f"{part} of it", code[:keep]
        yield f"{part} and the end", code[:keep] + code[-2:]
        yield f"zeros from {part} on", code[:keep] + bytes(size - keep)
        yield (f"zeros from {part} to the end marker",
               code[:keep] + bytes(size - keep - 2) + code[-2:])
    keep = size * 2 // 3
    yield "0 in the middle", code[:keep] + bytes(24) + code[keep + 24:]


def compare(name, code, wrap, zeros=("middle",)):
    """`wrap` makes a file of the code.  Some zeros may be codes too."""
    whole = told(wrap(code))
    oracle.checked += 1
    if whole[0] != 0:
        return oracle.fail(name, f"is whole, but {whole}")
    stride = 5 if oracle.SHORT else 2
    for how, cut in list(damage(code))[len(name) % stride::stride]:
        oracle.checked += 1
        status, text = told(wrap(cut))
        if not (status == 3 or (status, text) == whole or
                (status == 0 and any(word in how for word in zeros))):
            oracle.fail(f"{name}: {how}", f"exit {status}")


# --- TIFF ---------------------------------------------------------------------
def tiff_with(whole):
    """Puts a shorter code in place of that of a strip at the file's end."""
    page = tifffile.TiffFile(io.BytesIO(whole)).pages[0]
    at, count, tag = page.dataoffsets[0], page.databytecounts[0], page.tags[279]

    def wrap(code):
        data = bytearray(whole[:at] + code + whole[at + len(code):])
        struct.pack_into("<I" if tag.dtype == 4 else "<H", data,
                         tag.valueoffset, len(code))
        return bytes(data)
    return whole[at:at + count], wrap


if oracle.library("libtiff"):
    for kind in ("jpeg", "group3", "group4", "packbits", "tiff_lzw",
                 "tiff_adobe_deflate"):
        made = io.BytesIO()
        image = Image.fromarray(picture)
        if kind.startswith("group"):
            image = image.convert("1")
        image.save(made, "TIFF", compression=kind)
        compare(kind, *tiff_with(made.getvalue()))
        # codes of more rows than the page has are whole too
        data = bytearray(made.getvalue())
        tag = tifffile.TiffFile(io.BytesIO(data)).pages[0].tags[257]
        struct.pack_into("<I" if tag.dtype == 4 else "<H", data,
                         tag.valueoffset, 50)
        oracle.checked += 1
        if told(data)[0] != 0:
            oracle.fail(kind, "of fewer rows than there are codes for")
    # pictures are read by the same decoders
    made = io.BytesIO()
    Image.fromarray(np.stack([picture] * 3, -1)).save(
        made, "TIFF", compression="tiff_adobe_deflate")
    code, wrap = tiff_with(made.getvalue())
    for name, data in ("whole", code), *oracle.few(damage(code), 5):
        with open("picture.tif", "wb") as file:
            file.write(wrap(data))
        oracle.checked += 1
        done = subprocess.run([oracle.TOOL, "compare", *["picture.tif"] * 2],
                              capture_output=True)
        if done.returncode != (0 if name == "whole" else 3):
            oracle.fail(f"picture: {name}", done)
    # Group 4 ends silently after any row: none may be missing
    blank = Image.new("1", (72, 60), 1)
    for rows in 1, 30, 59:
        part = io.BytesIO()
        blank.crop((0, 0, 72, rows)).save(part, "TIFF", compression="group4")
        made = io.BytesIO()
        blank.save(made, "TIFF", compression="group4")
        code, wrap = tiff_with(made.getvalue())
        short, _ = tiff_with(part.getvalue())
        oracle.checked += 1
        if told(wrap(code))[0] != 0 or told(wrap(short))[0] != 3:
            oracle.fail("group4", f"of {rows} rows: {told(wrap(short))}")

    # the last page at the end of the file, which is cut where a link should be
    for big in False, True:
        made = io.BytesIO()
        tifffile.imwrite(made, np.stack([picture] * 3), bigtiff=big,
                         metadata=None, photometric="minisblack")
        data = bytearray(made.getvalue())
        head, entry, link = (8, 20, 8) if big else (2, 12, 4)
        sizes = []
        for page in tifffile.TiffFile(io.BytesIO(data)).pages:
            (count,) = struct.unpack_from("<Q" if big else "<H", data,
                                          page.offset)
            sizes.append((page.offset, head + count * entry))
        (before, used), (last, size) = sizes[1:]
        struct.pack_into("<Q" if big else "<I", data, before + used, len(data))
        data += data[last:last + size + link]
        oracle.checked += 1 + link
        if told(data)[0] != 0:
            oracle.fail("moved page", told(data))
        for cut in range(1, link + 1):
            if told(data[:-cut])[0] != 3:
                oracle.fail("cut page", f"by {cut} of {link} bytes")


# --- DICOM --------------------------------------------------------------------
def dicom_with(syntax, values, bits=8):
    """Values are those of the image, of which only the shape counts."""
    data = pydicom.Dataset()
    data.file_meta = pydicom.dataset.FileMetaDataset()
    data.file_meta.TransferSyntaxUID = syntax
    data.file_meta.MediaStorageSOPClassUID = "1.2.840.10008.5.1.4.1.1.7"
    data.file_meta.MediaStorageSOPInstanceUID = "1.2.3"
    data.is_little_endian, data.is_implicit_VR = True, False
    data.Rows, data.Columns = values.shape[:2]
    data.SamplesPerPixel = 3 if values.ndim == 3 else 1
    data.PhotometricInterpretation = "RGB" if values.ndim == 3 else "MONOCHROME2"
    if values.ndim == 3:
        data.PlanarConfiguration = 0
    data.BitsAllocated = 8 * values.itemsize
    data.BitsStored, data.HighBit = bits, bits - 1
    data.PixelRepresentation = 0
    return frames_of(data, [b""], 0)


def frames_of(data, codes, number):
    """Puts another code in place of that of one frame."""
    def wrap(code):
        made = io.BytesIO()
        data.PixelData = encapsulate([
            c + bytes(len(c) % 2) for c in
            [*codes[:number], code, *codes[number + 1:]]])
        data["PixelData"].VR = "OB"
        data["PixelData"].is_undefined_length = True
        data.save_as(made, write_like_original=False)
        return made.getvalue()
    return wrap


def sequential_12():
    """16 x 24 values of 12 bits in blocks of one value each, with a restart: the
    code of a length is itself in 4 bits, that of the end of a block is 0."""
    rng = np.random.default_rng(1)
    segments = [(0xc1, struct.pack(">BHHBBBB", 12, 16, 24, 1, 1, 0x11, 0)),
                (0xdb, bytes([0]) + bytes([1] * 64)),
                (0xc4, bytes([0, 0, 0, 0, 12] + [0] * 12) + bytes(range(12))),
                (0xc4, bytes([16, 1] + [0] * 15) + bytes([0])),
                (0xdd, struct.pack(">H", 3)),
                (0xda, bytes([1, 1, 0, 0, 63, 0]))]
    code = b"\xff\xd8" + b"".join(
        b"\xff" + struct.pack(">BH", marker, len(body) + 2) + body
        for marker, body in segments)
    for half in range(2):
        bits = ""
        for length in rng.integers(0, 12, 3):
            bits += f"{length:04b}" + "".join(
                str(bit) for bit in rng.integers(0, 2, length)) + "0"
        bits += "1" * (-len(bits) % 8)
        packed = bytes(int(bits[i:i + 8], 2) for i in range(0, len(bits), 8))
        code += packed.replace(b"\xff", b"\xff\0") + (b"" if half else b"\xff\xd0")
    return code + b"\xff\xd9"


def jpeg(values, **how):
    made = io.BytesIO()
    Image.fromarray(values).save(made, **how)
    return made.getvalue()


if not oracle.library("gdcm"):
    oracle.finish()
for how in {}, {"quality": 20, "optimize": True}:
    compare(f"JPEG {how}", jpeg(picture, format="JPEG", **how),
            dicom_with(JPEG + "50", picture))
wide = np.zeros((16, 24), "u2")
compare("JPEG of 12 bits", sequential_12(), dicom_with(JPEG + "51", wide, 12))
# A frame of an odd number of bytes is padded, which is no damage.
for values in picture, picture[:59, :71], (picture * 200.).astype("u2"), np.stack(
        [picture, picture.T[:60, :60].repeat(2, 1)[:, :72], 255 - picture], -1):
    ways = [dict(progression=order, **way) for order in
            ("LRCP", "RLCP", "RPCL", "PCRL", "CPRL") for way in
            ({}, {"quality_layers": [40, 10, 1]}, {"num_resolutions": 1},
             {"tile_size": (32, 40), "irreversible": True},
             {"precinct_size": (32, 32), "codeblock_size": (16, 8),
              "quality_layers": [20, 4], "irreversible": True})]
    for number, how in enumerate(ways if features.check("jpg_2000") else []):
        code = jpeg(values, format="JPEG2000", no_jp2=True, **how)
        wrap = dicom_with(JPEG + "90", values, 8 * values.itemsize)
        if number % 5 == len(values.shape) - 1:
            compare(f"JPEG 2000 {how}", code, wrap, IN_BLOCKS)
        elif not oracle.SHORT:
            oracle.checked += 1
            if told(wrap(code), "1")[0]:
                oracle.fail(f"JPEG 2000 {how}", "is whole, but refused")
for name in ("jpeg_little", "jpeg_rgb", "jpeg_frames", "jpeg_lossy",
             "jpegls_bytes", "jpegls_little", "jpegls_frames", "j2k_little",
             "j2k_rgb", "rle_bytes", "rle_little", "rle_frames"):
    data = pydicom.dcmread(os.path.join(CORPUS, name))
    count = int(data.get("NumberOfFrames", 1))
    codes = list(generate_pixel_data_frame(data.PixelData, count))
    # without the byte that makes its length even
    codes = [c[:-1] if c[-2:] == b"\xd9\0" else c for c in codes]
    compare(name, codes[count // 2], frames_of(data, codes, count // 2),
            IN_BLOCKS if "j2k" in name else ("middle",))
oracle.finish()
