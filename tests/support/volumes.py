"""Files of volumes, as tests in Python make them.  Voxels are bytes, x the fastest."""
import array
import itertools
import struct


def each(dims, value, code="B"):
    """The bytes of a function of x, y, z, of an array's type."""
    return array.array(code, (value(*reversed(at)) for at in itertools.product(
        *map(range, reversed(dims))))).tobytes()


def placed(steps, origin):
    """Fields of an NRRD file: where its voxels are, in mm."""
    return ("space: RAS", "space directions: (%g,0,0) (0,%g,0) (0,0,%g)" % steps,
            "space origin: (%g,%g,%g)" % origin)


def labels(*names):
    """Fields of an NRRD file: its values are labels of these numbers, or (number,
    name)."""
    for n, name in enumerate(names):
        number, *words = name if isinstance(name, tuple) else (name,)
        yield f"Segment{n}_LabelValue:={number}"
        for word in words:
            yield f"Segment{n}_Name:={word}"


def nrrd(name, dims, voxels, *fields, kind="uint8"):
    lines = ["NRRD0004", f"type: {kind}", f"dimension: {len(dims)}",
             "sizes: " + " ".join(map(str, dims)), "endian: little",
             "encoding: raw", *fields, "", ""]
    with open(name, "wb") as file:
        file.write("\n".join(lines).encode("utf-8", "surrogateescape") + voxels)


def npy(name, kind, shape, voxels):
    """The shape is of z, y, x; so is NumPy's."""
    text = "{'descr': '%s', 'fortran_order': False, 'shape': %s, }" % (kind, shape)
    with open(name, "wb") as file:
        file.write(b"\x93NUMPY\x01\x00" + struct.pack("<H", 118) +
                   text.ljust(117).encode() + b"\n" + voxels)


def nifti(name, dims, kind, voxels, intent=0, sform=None):
    """A type by its code and bits; a matrix of 12 numbers."""
    head = bytearray(352)
    struct.pack_into("<i", head, 0, 348)
    struct.pack_into("<8h", head, 40, len(dims), *dims, *[1] * (7 - len(dims)))
    struct.pack_into("<3h", head, 68, intent, *kind)
    struct.pack_into("<8f", head, 76, *[1] * 8)
    struct.pack_into("<f", head, 108, 352)
    if sform:
        struct.pack_into("<h", head, 254, 1)
        struct.pack_into("<12f", head, 280, *sform)
    head[344:348] = b"n+1\0"
    with open(name, "wb") as file:
        file.write(bytes(head) + voxels)


def tiff(name, nx, ny, pages, text, resolution=None):
    """Pages of bytes, the first with a description; pixels of a unit."""
    out = bytearray(b"II*\0" + bytes(4)) + text + b"\0" * (2 - len(text) % 2)
    link = 4
    for n, page in enumerate(pages):
        data = len(out)
        out += page
        ratio = len(out)
        out += struct.pack("<II", resolution or 1, 1)
        struct.pack_into("<I", out, link, len(out))
        tags = [(256, 3, 1, nx), (257, 3, 1, ny), (258, 3, 1, 8), (259, 3, 1, 1),
                (262, 3, 1, 1), (270, 2, len(text) + 1, 8), (273, 4, 1, data),
                (277, 3, 1, 1), (278, 3, 1, ny), (279, 4, 1, nx * ny),
                (282, 5, 1, ratio), (283, 5, 1, ratio), (296, 3, 1, 1)]
        tags = [tag for tag in tags if (n == 0 or tag[0] != 270) and
                (resolution or tag[0] < 282)]
        out += struct.pack("<H", len(tags))
        out += b"".join(struct.pack("<HHII", *tag) for tag in tags)
        link = len(out)
        out += bytes(4)
    with open(name, "wb") as file:
        file.write(out)


def ome_tiff(name, dims, pages, words="", times=1):
    """Pages of the channels of each slice of each time step; the words are those of
    OME about channels."""
    nx, ny, nz = dims
    tiff(name, nx, ny, pages, (
        '<OME xmlns="http://www.openmicroscopy.org/Schemas/OME/2016-06"><Image>'
        f'<Pixels DimensionOrder="XYCZT" SizeX="{nx}" SizeY="{ny}" '
        f'SizeC="{len(pages) // (nz * times)}" SizeZ="{nz}" SizeT="{times}" '
        'Type="uint8" PhysicalSizeX="0.5" PhysicalSizeY="0.5" PhysicalSizeZ="1">'
        f'{words}</Pixels></Image></OME>').encode())


def channel_words(*channels):
    """Of OME: each channel's name, and its colour as a number of 32 bits."""
    return "".join(
        f'<Channel ID="Channel:0:{n}" Name="{name}"' +
        "".join(f' Color="{color}"' for color in colors) + "/>"
        for n, (name, *colors) in enumerate(channels))


def netcdf(name, dims, values, unit):
    """NetCDF-3 of short values over time, z, y and x; its times are 0, 6, 12 ..."""
    def text(word):
        data = word.encode()
        return struct.pack(">i", len(data)) + data + b"\0" * (-len(data) % 4)
    axes = list(zip("tzyx", dims[::-1]))
    head = b"CDF\1" + struct.pack(">iii", 0, 10, 4) + b"".join(
        text(axis) + struct.pack(">i", count) for axis, count in axes) + struct.pack(">ii", 0, 0)
    units = struct.pack(">ii", 12, 1) + text("units") + struct.pack(">i", 2) + text(unit)
    times, data = struct.pack(f">{dims[3]}d", *(6 * t for t in range(dims[3]))), array.array("h", values)
    data.byteswap()

    def variables(first):
        return struct.pack(">ii", 11, 2) + text("t") + struct.pack(">ii", 1, 0) + units + struct.pack(
            ">iii", 6, len(times), first) + text("v") + struct.pack(">iiiii", 4, 0, 1, 2, 3) + struct.pack(
            ">iiiii", 0, 0, 3, 2 * len(data), first + len(times))
    with open(name, "wb") as out:
        out.write(head + variables(len(head + variables(0))) + times + data.tobytes())


def dated(name, count):
    """A ball that grows brighter, in steps of six hours from the year 2000 on."""
    netcdf(name, (20, 16, 12, count), (
        max(0, 400 - 9 * ((x - 9) ** 2 + (y - 8) ** 2 + (z - 6) ** 2)) * (1 + t)
        for t in range(count) for z in range(12) for y in range(16) for x in range(20)),
           "hours since 2000-01-01 00:00:00")
