"""The page without a server in Chromium: a phantom, dropped files, a page that
`snowglass export` made, and one that a server sends so that it may share memory."""
import base64
import functools
import http.server
import json
import os
import shlex
import shutil
import struct
import subprocess
import sys
import threading
import zlib

TOOL, OUT, TOP = map(os.path.abspath, sys.argv[1:4])
HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, HERE)
from checks import check, end, find, skip  # noqa: E402
from dicom_slice import dicom  # noqa: E402

PLAYWRIGHT = os.path.join(os.path.dirname(TOOL), "web", "node_modules",
                          "playwright-core", "index.mjs")
PAGE = os.path.join(TOP, "build-web", "viewer.html")


node, chromium = find("node", "nodejs"), find("chromium", "chromium-browser")
if not node or not chromium or not os.path.exists(PLAYWRIGHT):
    skip("node, chromium or playwright-core is missing")
if not os.path.exists(PAGE):
    skip("there is no page: ./dev web builds it")
shutil.rmtree(OUT, ignore_errors=True)
os.makedirs(OUT)


def tool(*words):
    return subprocess.run([TOOL, *words], cwd=OUT, capture_output=True,
                          text=True)


def watch(*pages, damaged):
    """Looks at pages, each with its volumes, and runs their commands where those are;
    on the first one the damaged file is dropped too."""
    done = subprocess.run(
        [node, os.path.join(HERE, "page.mjs"), PLAYWRIGHT, chromium, OUT,
         json.dumps([{"url": url, "volumes": volumes, "damaged": damaged if i == 0 else None}
                     for i, (url, *volumes) in enumerate(pages)])],
        timeout=500)
    check("the pages", done.returncode == 0, done.returncode)
    for name in (volume[0] for _, *volumes in pages for volume in volumes):
        with open(os.path.join(OUT, f"{name}.txt")) as file:
            words = shlex.split(file.read())
        words[words.index("--output") + 1] = "again.png"
        if name in ("made", "shared"): # of a patient: without the file's name
            check(f"{name}: no file is named", "head.nrrd" not in words and "volume" in words,
                  words)
            words[words.index("volume")] = "head.nrrd"
        tool(*words[1:], "-y", "-q")
        with open(os.path.join(OUT, "again.png"), "rb") as a, \
                open(os.path.join(OUT, f"{name}-rest.png"), "rb") as b:
            check(f"{name}: the picture at rest is the command's",
                  a.read() == b.read())


head = tool("phantom", "head", "--dims", "64x64x48", "-o", "head.nrrd")
assert head.returncode == 0, head.stderr
tool("convert", "head.nrrd", "-o", "head.raw")
with open(os.path.join(OUT, "apart.nhdr"), "w") as file:
    file.write("NRRD0004\ntype: uint8\ndimension: 3\nsizes: 64 64 48\n"
               "spacings: 4 4 4.7\nencoding: raw\ndata file: head.raw\n")
os.makedirs(os.path.join(OUT, "series"))
for z in range(11):  # the order is not that of the names
    with open(os.path.join(OUT, "series", f"{7 * z % 11}.dcm"), "wb") as file:
        file.write(dicom(z))
other = os.path.join(OUT, "other.nrrd")  # whose title is not the page's
shutil.copy(os.path.join(OUT, "head.nrrd"), other)

with open(os.path.join(OUT, "damaged.nrrd"), "wb") as file:
    file.write(b"NRRD0004\ntype: uint8\ndimension: 3\nsizes: 9 9 9\nencoding: raw\n\nabc")
with open(os.path.join(OUT, "head.raw"), "rb") as file:
    voxels = file.read()


def vti(name, words, grid, array, appended=""):
    """One of VTK's image data of 64x64x48 values."""
    with open(os.path.join(OUT, name), "wb") as file:
        file.write(f'<?xml version="1.0"?>\n<VTKFile type="ImageData" version="1.0" {words}>\n'
                   f'<ImageData {grid}>\n{array}\n</Piece></ImageData>'.encode() +
                   (appended or b"") + b"</VTKFile>\n")
    return os.path.join(OUT, name)


def packed_vti():
    """Cells of 16 bits, big ends first, in blocks of zlib behind the text; another array lies
    before them."""
    wide = b"".join(struct.pack(">h", 9 * value - 700) for value in voxels)
    pieces = [wide[at:at + 40000] for at in range(0, len(wide), 40000)]
    blocks = [zlib.compress(piece) for piece in pieces]
    head = struct.pack(f">{3 + len(blocks)}Q", len(blocks), 40000, len(pieces[-1]) % 40000,
                       *map(len, blocks))
    extent = "3 67 0 64 -2 46"
    return vti("packed.vti", 'byte_order="BigEndian" header_type="UInt64" '
               'compressor="vtkZLibDataCompressor"',
               f'WholeExtent="{extent}" Origin="5 6 7" Spacing="1 1.5 2" '
               'Direction="0 1 0 -1 0 0 0 0 1"',
               f'<Piece Extent="{extent}"><CellData Scalars="b &amp; c">'
               '<DataArray type="Float32" Name="a" format="appended" offset="0"/>'
               '<DataArray type="Int16" Name="b &amp; c" format="appended" offset="12"/></CellData>',
               b'\n<AppendedData encoding="raw">\n   _' + bytes(12) + head + b"".join(blocks) +
               b"\n</AppendedData>")


def plain_vti():
    """Points in the element, in base64."""
    extent = "0 63 0 63 0 47"
    text = base64.b64encode(struct.pack("<I", len(voxels)) + voxels).decode()
    return vti("plain.vti", 'byte_order="LittleEndian"', f'WholeExtent="{extent}" Spacing="1 1 1.2"',
               f'<Piece Extent="{extent}"><PointData><DataArray type="UInt8" Name="a" '
               f'format="binary">\n{text}\n</DataArray></PointData>')


with open(os.path.join(OUT, "points.json"), "w") as file:
    file.write('{"snowglass-tf": 1, "values": "data", "opacities": '
               '[[20, 0], [90, 0.2], [200, 0.9]]}')
made = tool("export", "made.html", "head.nrrd", "--tf", "points.json",
            "--azimuth", "30", "--legend")
check("a page is made", made.returncode == 0, made.stderr)


class Isolating(http.server.SimpleHTTPRequestHandler):
    """Sends what a browser asks of pages that share memory."""
    def end_headers(self):
        self.send_header("Cross-Origin-Opener-Policy", "same-origin")
        self.send_header("Cross-Origin-Embedder-Policy", "require-corp")
        super().end_headers()

    def log_message(self, *words):
        pass


with http.server.ThreadingHTTPServer(
        ("127.0.0.1", 0), functools.partial(Isolating, directory=OUT)) as server:
    threading.Thread(target=server.serve_forever, daemon=True).start()
    watch(("file://" + PAGE, ["phantom"],
           ["apart", os.path.join(OUT, "apart.nhdr"), os.path.join(OUT, "head.raw")],
           ["folder", os.path.join(OUT, "series")],
           ["packed", packed_vti()], ["plain", plain_vti()],
           ["raw", os.path.join(OUT, "head.raw")],
           ["dropped", os.path.join(OUT, "head.nrrd")]),
          ("file://" + os.path.join(OUT, "made.html"), ["made"]),
          (f"http://127.0.0.1:{server.server_port}/made.html", ["shared"],
           ["shared-dropped", other]), damaged=os.path.join(OUT, "damaged.nrrd"))
    server.shutdown()
again = tool("export", "made.html", "head.nrrd")
check("a page is not replaced", again.returncode == 4 and
      "made.html: exists" in again.stderr, again)
large = tool("export", "large.html", "phantom:engine", "--dims",
             "1200x1200x1200")
check("what is too large is refused with what to do",
      large.returncode == 5 and "1648 MiB" in large.stderr and
      "at most 1024" in large.stderr and "--crop" in large.stderr and
      not os.path.exists(os.path.join(OUT, "large.html")), large)
end()
