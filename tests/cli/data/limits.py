"""limits.py TOOL CORPUS: memory and time of the tool for each file of the
corpora and for small files that ask for much.

A reader takes at most 64 MB and three times the decoded size of what is shown,
as `info` prints it, beyond what the tool takes for a file of one voxel; and time
that grows with the bytes read, for which two seconds are ample here.
"""
import json
import os
import subprocess
import sys
import tempfile

TOOL, CORPUS = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2])
BYTES = {"int8": 1, "uint8": 1, "int16": 2, "uint16": 2, "int32": 4,
         "uint32": 4, "float32": 4}
MOST_BYTES, MOST_SECONDS = 64 << 20, 2
wrong = checked = 0


def measure(path):
    """(exit status, report or None, bytes at most, processor seconds)"""
    with tempfile.TemporaryFile() as out:
        made = subprocess.Popen([TOOL, "info", "--json", "-q", path], stdout=out,
                                stderr=subprocess.DEVNULL,
                                stdin=subprocess.DEVNULL)
        _, status, used = os.wait4(made.pid, 0)
        made.returncode = os.waitstatus_to_exitcode(status)
        out.seek(0)
        text = out.read()
    report = json.loads(text) if made.returncode == 0 and text else None
    return (made.returncode, report, 1024 * used.ru_maxrss,
            used.ru_utime + used.ru_stime)


def decoded(report):
    if not isinstance(report, dict) or "dims" not in report:
        return 0
    x, y, z = report["dims"]
    return x * y * z * BYTES.get(report["type"], 8) * \
        max(1, report.get("components", 1))


def check(path, least, statuses=(0, 2, 3)):
    global wrong, checked
    checked += 1
    status, report, most, seconds = measure(path)
    limit = least + MOST_BYTES + 3 * decoded(report)
    faults = [f"ends with {status}"] if status not in statuses else []
    if most > limit:
        faults.append(f"takes {most} bytes, not {limit}")
    if seconds > MOST_SECONDS:
        faults.append(f"takes {seconds:.1f} s of the processor")
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


with tempfile.TemporaryDirectory() as folder:
    os.chdir(folder)
    put("one.nrrd", b"NRRD0001\ntype: uint8\ndimension: 3\nsizes: 1 1 1\n"
        b"encoding: raw\n\n\1")
    base = measure("one.nrrd")[2]
    for root, _, names in os.walk(CORPUS):
        for name in sorted(names):
            check(os.path.join(root, name), base)
    for path, statuses in demanding():
        check(os.path.abspath(path), base, statuses)
print(f"{checked} files, {wrong} wrong")
sys.exit(wrong > 0)
