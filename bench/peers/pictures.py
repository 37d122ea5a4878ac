"""bench/peers/pictures.py - pictures of the programs: read, compared, shown.

A picture is (width, height, bytes of red, green, blue from the top row).  Only
Python's own library is used: PNG is zlib and check sums, and names are set in a
font of 5 x 7 dots.
"""
import math
import struct
import zlib

# Columns of 5, lowest bit on top: the usual dot-matrix shapes.
FONT = {
    " ": "0000000000", "-": "0808080808", ".": "0060600000",
    "0": "3e5149453e", "1": "00427f4000", "2": "4261514946",
    "3": "2141454b31", "4": "1814127f10", "5": "2745454539",
    "6": "3c4a494930", "7": "0171090503", "8": "3649494936",
    "9": "064949291e", "A": "7e1111117e", "B": "7f49494936",
    "C": "3e41414122", "D": "7f4141221c", "E": "7f49494941",
    "F": "7f09090901", "G": "3e4149497a", "H": "7f0808087f",
    "I": "00417f4100", "J": "2040413f01", "K": "7f08142241",
    "L": "7f40404040", "M": "7f020c027f", "N": "7f0408107f",
    "O": "3e4141413e", "P": "7f09090906", "Q": "3e4151215e",
    "R": "7f09192946", "S": "4649494931", "T": "01017f0101",
    "U": "3f4040403f", "V": "1f2040201f", "W": "3f4038403f",
    "X": "6314081463", "Y": "0708700807", "Z": "6151494543",
}
DOT = 2      # pixels of a dot
BAND = 22    # rows of a name's band above its picture
COLUMNS = 3  # pictures beside each other on a sheet


def read_ppm(path):
    with open(path, "rb") as file:
        magic, size, most = (file.readline() for _ in range(3))
        pixels = file.read()
    width, height = map(int, size.split())
    if ((magic, most) != (b"P6\n", b"255\n") or
            len(pixels) != 3 * width * height):
        raise ValueError(f"{path}: not the PPM that the workers write")
    return width, height, pixels


def write_png(path, picture):
    width, height, pixels = picture

    def chunk(name, data):
        return (struct.pack(">I", len(data)) + name + data +
                struct.pack(">I", zlib.crc32(name + data)))

    rows = b"".join(b"\0" + pixels[3 * width * y:3 * width * (y + 1)]
                    for y in range(height))
    with open(path, "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n" +
                   chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2,
                                              0, 0, 0)) +
                   chunk(b"IDAT", zlib.compress(rows, 6)) + chunk(b"IEND", b""))


def greys(picture):
    """Red plus green plus blue of every pixel."""
    pixels = picture[2]
    return [r + g + b for r, g, b in
            zip(pixels[0::3], pixels[1::3], pixels[2::3])]


def decibels(squares, count):
    """Of the sum of squares over that many greys; None for equal pictures,
    since JSON has no infinity."""
    return (10 * math.log10((3 * 255) ** 2 * count / squares) if squares > 0
            else None)


def psnr(a, b):
    """Of the grey pictures (the mean of red, green, blue), peak 255, in dB: as
    they are, and with `a` scaled to the brightness of `b`, by the factor of
    least squares."""
    if a[:2] != b[:2]:
        raise ValueError("pictures of two sizes")
    a, b = greys(a), greys(b)
    aa, ab, bb = (sum(x * y for x, y in zip(*pair))
                  for pair in ((a, a), (a, b), (b, b)))
    return (decibels(aa - 2 * ab + bb, len(a)),
            decibels(bb - ab * ab / aa if aa else bb, len(a)))


def letters(text, width):
    """A band of BAND rows with the text, white on dark grey."""
    rows = [bytearray(b"\x20" * 3 * width) for _ in range(BAND)]
    for place, letter in enumerate(text.upper()):
        columns = bytes.fromhex(FONT.get(letter, FONT["-"]))
        for dot in range(5 * 7):
            x, y = dot % 5, dot // 5
            if not columns[x] >> y & 1:
                continue
            left = 8 + DOT * (6 * place + x)
            for row in range(4 + DOT * y, 4 + DOT * (y + 1)):
                if left + DOT <= width:
                    rows[row][3 * left:3 * (left + DOT)] = b"\xff" * 3 * DOT
    return rows


def sheet(named):
    """One picture of all (name, picture), each under its name."""
    width, height, _ = named[0][1]
    columns = min(COLUMNS, len(named))
    rows = []
    for first in range(0, len(named), columns):
        line = named[first:first + columns]
        blank = bytes(3 * width * (columns - len(line)))
        bands = [letters(name, width) for name, _ in line]
        rows += [b"".join(band[y] for band in bands) + blank
                 for y in range(BAND)]
        rows += [b"".join(picture[2][3 * width * y:3 * width * (y + 1)]
                          for _, picture in line) + blank
                 for y in range(height)]
    return width * columns, len(rows), b"".join(rows)
