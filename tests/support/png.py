"""Pictures of 8 bits in PNG, as tests in Python read them."""
import struct
import zlib


def paeth(a, b, c):
    p = a + b - c
    pa, pb, pc = abs(p - a), abs(p - b), abs(p - c)
    return a if pa <= pb and pa <= pc else b if pb <= pc else c


def levels(data):
    """Width, height and red, green and blue of a PNG of 8 bits, grey or not."""
    at, packed = 8, b""
    while at < len(data):
        length, kind = struct.unpack(">I4s", data[at:at + 8])
        if kind == b"IHDR":
            width, height, bits, form = struct.unpack(
                ">IIBB", data[at + 8:at + 18])
        if kind == b"IDAT":
            packed += data[at + 8:at + 8 + length]
        at += length + 12
    assert bits == 8 and form in (0, 2), (bits, form)
    step = 3 if form else 1
    bytes_, row, lines = zlib.decompress(packed), step * width, []
    before = bytes(row)
    for y in range(height):
        how, *line = bytes_[y * (row + 1):(y + 1) * (row + 1)]
        for x in range(row if how else 0):
            left = line[x - step] if x >= step else 0
            corner = before[x - step] if x >= step else 0
            add = (0, left, before[x], (left + before[x]) // 2,
                   paeth(left, before[x], corner))[how]
            line[x] = line[x] + add & 255
        before = bytes(line)
        lines.append(before)
    all_ = b"".join(lines)
    return width, height, [all_[i % step::step] for i in range(3)]
