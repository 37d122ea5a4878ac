"""A DICOM slice that a test makes."""
import struct


def element(group, number, kind, value):
    """Of a DICOM file, little endian."""
    if isinstance(value, str):
        value = value.encode() + b" "[:len(value) % 2]
    elif isinstance(value, int):
        value = struct.pack("<H", value)
    long_ = kind == "OW"
    return struct.pack("<HH", group, number) + kind.encode() + struct.pack(
        "<HI" if long_ else "<H", *([0] if long_ else []), len(value)) + value


PLAIN = "1.2.840.10008.1.2.1"


def dicom(z, syntax=PLAIN):
    """A slice of a ball, of 11 slices; of other syntaxes its pixels are damaged."""
    side = 24
    pixels = struct.pack(f"<{side * side}H", *(
        max(0, 1000 - 8 * ((x - 12) ** 2 + (y - 11) ** 2 + 4 * (z - 5) ** 2))
        for y in range(side) for x in range(side)))
    data = element(0x7FE0, 0x10, "OW", pixels)
    if syntax != PLAIN:  # in fragments, the first of which is empty
        item = struct.pack("<HHI", 0xFFFE, 0xE000, 0)
        data = struct.pack("<HH2sHI", 0x7FE0, 0x10, b"OW", 0, 0xFFFFFFFF) + item + \
            struct.pack("<HHI", 0xFFFE, 0xE000, 8) + bytes(8) + \
            struct.pack("<HHI", 0xFFFE, 0xE0DD, 0)
    meta = element(2, 0x10, "UI", syntax + "\0" * (len(syntax) % 2))
    meta = element(2, 0, "UL", struct.pack("<I", len(meta))) + meta
    return bytes(128) + b"DICM" + meta + b"".join([
        element(8, 0x16, "UI", "1.2.840.10008.5.1.4.1.1.2\0"),
        element(8, 0x18, "UI", f"1.2.3.{z + 10}"), element(8, 0x60, "CS", "CT"),
        element(0x10, 0x10, "PN", "Doe^Jane"), element(0x20, 0x0E, "UI", "1.2.3\0"),
        element(0x20, 0x13, "IS", str(z + 1)),
        element(0x20, 0x32, "DS", f"0\\0\\{2 * z}"),
        element(0x20, 0x37, "DS", "1\\0\\0\\0\\1\\0"),
        element(0x28, 2, "US", 1), element(0x28, 4, "CS", "MONOCHROME2"),
        element(0x28, 0x10, "US", side), element(0x28, 0x11, "US", side),
        element(0x28, 0x30, "DS", "1\\1"), element(0x28, 0x100, "US", 16),
        element(0x28, 0x101, "US", 16), element(0x28, 0x102, "US", 15),
        element(0x28, 0x103, "US", 0), data])
