"""Slices of DICOM, as tests in Python make them."""
import struct

PLAIN = "1.2.840.10008.1.2.1"  # explicit, little endian
CT = "1.2.840.10008.5.1.4.1.1.2"


def element(group, number, kind, value):
    """Of a file: group and number, kind, length, value of even length."""
    if isinstance(value, str):
        value = value.encode()
        value += (b"\0" if kind == "UI" else b" ") * (len(value) % 2)
    elif isinstance(value, int):
        value = struct.pack("<H", value)
    length = (struct.pack("<HI", 0, len(value)) if kind == "OW" else
              struct.pack("<H", len(value)))
    return struct.pack("<HH", group, number) + kind.encode() + length + value


def damaged_pixels():
    """Of a packed image: two fragments, the first of which is empty."""
    return struct.pack("<HH2sHI", 0x7FE0, 0x10, b"OW", 0, 0xFFFFFFFF) + \
        struct.pack("<HHI", 0xFFFE, 0xE000, 0) + \
        struct.pack("<HHI", 0xFFFE, 0xE000, 8) + bytes(8) + \
        struct.pack("<HHI", 0xFFFE, 0xE0DD, 0)


def dicom_slice(z, voxels, height, spacing=1, intercept=None, syntax=PLAIN, about=None):
    """Slice z of a CT: a file of square voxels, 16 bits, at that height in mm.
    Of another syntax than the plain one the pixels are damaged.  What else it is
    about: (group, number) -> (kind, value)."""
    side = int(len(voxels) ** 0.5)
    meta = element(2, 0x10, "UI", syntax)
    meta = element(2, 0, "UL", struct.pack("<I", len(meta))) + meta
    said = {
        (8, 0x16): ("UI", CT), (8, 0x18): ("UI", f"1.2.3.{z + 1}"),
        (8, 0x60): ("CS", "CT"), (0x10, 0x10): ("PN", "Doe^Jane"),
        (0x20, 0x0E): ("UI", "1.2.3"), (0x20, 0x13): ("IS", str(z + 1)),
        (0x20, 0x32): ("DS", f"0\\0\\{height}"),
        (0x20, 0x37): ("DS", "1\\0\\0\\0\\1\\0"),
        (0x28, 2): ("US", 1), (0x28, 4): ("CS", "MONOCHROME2"),
        (0x28, 0x10): ("US", side), (0x28, 0x11): ("US", side),
        (0x28, 0x30): ("DS", f"{spacing}\\{spacing}"),
        (0x28, 0x100): ("US", 16), (0x28, 0x101): ("US", 16),
        (0x28, 0x102): ("US", 15), (0x28, 0x103): ("US", 0), **(about or {})}
    if intercept is not None:
        said |= {(0x28, 0x1052): ("DS", intercept), (0x28, 0x1053): ("DS", "1")}
    pixels = damaged_pixels() if syntax != PLAIN else \
        element(0x7FE0, 0x10, "OW", struct.pack(f"<{side * side}H", *voxels))
    return bytes(128) + b"DICM" + meta + b"".join(
        element(*tag, *said[tag]) for tag in sorted(said)) + pixels
