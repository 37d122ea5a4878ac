"""limits.py TOOL CORPUS: memory and time of the tool for each file of the
corpora and for small files that ask for much.  Of what libraries underneath say
by themselves nothing is printed, nor of damaged files of the formats that they
read.

A reader takes at most 64 MB and three times the decoded size of what is shown,
as `info` prints it, beyond what the tool takes for a file of one voxel; and time
that grows with the bytes read, for which two seconds are ample here.  What a
picture needs beyond `--memory` is refused before it is allocated.
"""
import json
import os
import subprocess
import sys
import tempfile
import zlib

TOOL, CORPUS = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2])
BYTES = {"int8": 1, "uint8": 1, "int16": 2, "uint16": 2, "int32": 4,
         "uint32": 4, "float32": 4}
MOST_BYTES, MOST_SECONDS = 64 << 20, 2
wrong = checked = 0


def measure(*words):
    """(exit status, report or None, bytes at most, processor seconds, the first
    line that is not ours)"""
    with tempfile.TemporaryFile() as out, tempfile.TemporaryFile() as said:
        made = subprocess.Popen([TOOL, *words], stdout=out, stderr=said,
                                stdin=subprocess.DEVNULL)
        _, status, used = os.wait4(made.pid, 0)
        made.returncode = os.waitstatus_to_exitcode(status)
        out.seek(0)
        text = out.read()
        said.seek(0)
        other = [line for line in said if not line.startswith(b"snowglass: ")]
    report = json.loads(text) if made.returncode == 0 and text else None
    return (made.returncode, report, 1024 * used.ru_maxrss,
            used.ru_utime + used.ru_stime, (other + [b""])[0])


def decoded(report):
    if not isinstance(report, dict) or "dims" not in report:
        return 0
    x, y, z = report["dims"]
    return x * y * z * BYTES.get(report["type"], 8) * \
        max(1, report.get("components", 1))


def check(path, least, statuses=(0, 2, 3)):
    global wrong, checked
    checked += 1
    status, report, most, seconds, other = measure("info", "--json", path)
    limit = least + MOST_BYTES + 3 * decoded(report)
    faults = [f"ends with {status}"] if status not in statuses else []
    if most > limit:
        faults.append(f"takes {most} bytes, not {limit}")
    if seconds > MOST_SECONDS:
        faults.append(f"takes {seconds:.1f} s of the processor")
    if other:
        faults.append(f"lets a library print {other}")
    if faults:
        wrong += 1
        print(f"FAILED {os.path.relpath(path, CORPUS)}: {'; '.join(faults)}")


def put(path, content, size=0, middle=b"", times=0, end=b""):
    """Content, `times` the middle, the end, and zeros up to the size.  It is
    written in parts: what this program holds counts for its children."""
    with open(path, "wb") as file:
        file.write(content)
        for _ in range(times):
            file.write(middle)
        file.write(end)
        file.truncate(max(size, file.tell()))
    return path


def xml(kind, inner, end="</VTKFile>"):
    return (f'<?xml version="1.0"?><VTKFile type="{kind}" version="0.1" '
            f'byte_order="LittleEndian">{inner}{end}').encode()


def demanding():
    """Files that ask for much: (path, statuses)."""
    steps = " ".join(["0", "1e-9"] + [str(i) for i in range(1, 9)])
    array = '<DataArray type="Float64" format="ascii">%s</DataArray>'
    yield put("narrow.vtr", xml("RectilinearGrid", f"""
<RectilinearGrid WholeExtent="0 9 0 9 0 9"><Piece Extent="0 9 0 9 0 9">
<Coordinates>{(array % steps) * 3}</Coordinates><PointData>
<DataArray type="UInt8" Name="a" format="ascii">{"1 2 " * 500}</DataArray>
</PointData></Piece></RectilinearGrid>""")), (0,)
    for name, kind in ("comment.vti", "ImageData"), ("comment.pvd", "Collection"):
        yield put(name, xml(kind, "<!--", ""), 0, b"x" * 1024, 48 << 10,
                  b"--></VTKFile>"), (3,)
    yield put("hole.jpg", b"\xff\xd8\xff\xfe\0\2", 1 << 40), (3,)
    piece = b'<Piece Extent="0 1 0 1 0 1" Source="p.vti"/>'
    put("p.vti", xml("ImageData", """<ImageData WholeExtent="0 1 0 1 0 1"
Origin="0 0 0" Spacing="1 1 1"><Piece Extent="0 1 0 1 0 1"><PointData>
<DataArray type="UInt8" Name="a" format="ascii">1 2 3 4 5 6 7 8</DataArray>
</PointData></Piece></ImageData>"""))
    yield put("pieces.pvti", xml("PImageData", """<PImageData
WholeExtent="0 1 0 1 0 1" GhostLevel="0" Origin="0 0 0" Spacing="1 1 1">
<PPointData><PDataArray type="UInt8" Name="a"/></PPointData>""", ""), 0, piece,
              200000, b"</PImageData></VTKFile>"), (0, 3)


SIDE, LIMIT = 640, 40 << 20  # voxels along each axis, bytes


def zeros(count):
    """What zlib makes of as many bytes of zero."""
    pack = zlib.compressobj(1)
    parts = [pack.compress(bytes(1 << 16)) for _ in range(count >> 16)]
    return b"".join(parts + [pack.compress(bytes(count & 0xffff)), pack.flush()])


def zarr(name, side):
    """A volume of which one chunk has all voxels, or more than it."""
    os.mkdir(name)
    with open(f"{name}/.zarray", "w", encoding="ascii") as file:
        json.dump({"zarr_format": 2, "shape": [side] * 3, "chunks": [SIDE] * 3,
                   "dtype": "|u1", "compressor": {"id": "zlib", "level": 1},
                   "fill_value": 0, "order": "C", "filters": None}, file)
    put(f"{name}/0.0.0", zeros(SIDE ** 3))
    return name


def png(width, height):
    def part(kind, content):
        return len(content).to_bytes(4, "big") + kind + content + \
            zlib.crc32(kind + content).to_bytes(4, "big")
    sizes = width.to_bytes(4, "big") + height.to_bytes(4, "big")
    return (b"\x89PNG\r\n\x1a\n" + part(b"IHDR", sizes + b"\x08\0\0\0\0") +
            part(b"IDAT", zeros((width + 1) * height)) + part(b"IEND", b""))


HDF5 = f"""import h5py
data = h5py.File("one.h5", "w").create_dataset(
    "d", [{SIDE}] * 3, "u1", chunks=({SIDE},) * 3, compression="lzf")
data[0] = 1
"""


def larger_than_memory():
    """Files of a few MB whose voxels are over the limit: (path, exit status);
    7 says that nothing is seen, 5 that memory is short."""
    head = (f"NRRD0001\ntype: uint8\ndimension: 3\nsizes: {SIDE} {SIDE} {SIDE}\n"
            "encoding: raw\n\n").encode()
    yield put("slabs.nrrd", head, len(head) + SIDE ** 3), 7
    yield zarr("one.zarr", SIDE), 5
    yield zarr("large.zarr", 64), 5
    yield put("wide.png", png(20000, 12000)), 5
    # By another process: what this one holds counts for its children.
    if subprocess.run([sys.executable, "-c", HDF5], check=False,
                      stderr=subprocess.DEVNULL).returncode == 0:
        yield "one.h5", 5


def check_memory(path, expected, least):
    global wrong, checked
    checked += 1
    status, _, most, *_ = measure("render", path, "-o", "o.png", "-y", "-s",
                               "64x64", "--memory", str(LIMIT))
    if status != expected or most > least + LIMIT:
        wrong += 1
        print(f"FAILED {path}: --memory {LIMIT}: ends with {status}, "
              f"takes {most} bytes")


def damaged():
    """Files that end early, and that have zeros in them."""
    for kind in ("dicom", "hdf5", "jpeg", "png", "tiff"):
        for name in sorted(os.listdir(os.path.join(CORPUS, kind))):
            with open(os.path.join(CORPUS, kind, name), "rb") as file:
                content = file.read()
            size = len(content)
            put("short", content[:size * 3 // 4])
            yield "short"
            for at in (size // 3, size * 2 // 3):
                yield put("zeros", content[:at] + bytes(4) + content[at + 4:])


with tempfile.TemporaryDirectory() as folder:
    os.chdir(folder)
    put("one.nrrd", b"NRRD0001\ntype: uint8\ndimension: 3\nsizes: 1 1 1\n"
        b"encoding: raw\n\n\1")
    base = measure("info", "--json", "one.nrrd")[2]
    for root, _, names in os.walk(CORPUS):
        for name in sorted(names):
            check(os.path.join(root, name), base)
    for path in damaged():
        check(os.path.abspath(path), base)
    for path, statuses in demanding():
        check(os.path.abspath(path), base, statuses)
    for path, status in larger_than_memory():
        check_memory(path, status, base)
print(f"{checked} files, {wrong} wrong")
sys.exit(wrong > 0)
