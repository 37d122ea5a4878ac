"""The viewer's page in Chromium, and the command that it copies."""
import array
import http.server
import json
import os
import shlex
import shutil
import subprocess
import sys
import tarfile
import threading
import urllib.parse
import time

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from viewer_client import (DATA, SHORT, TOOL, Server, check, finish, skip,
                           write_channels)

HERE = os.path.dirname(os.path.abspath(__file__))
WEB = os.path.abspath(sys.argv[3])
PLAYWRIGHT = os.path.join(WEB, "node_modules", "playwright-core", "index.mjs")


def find(*names):
    return next(filter(None, map(shutil.which, names)), None)


node, chromium = find("node", "nodejs"), find("chromium", "chromium-browser")
if not node:
    skip("there is no node")
if not chromium:
    skip("there is no chromium")
if not os.path.exists(PLAYWRIGHT):
    skip("there is no playwright-core: ./dev test installs it where npm is")

shots = os.path.join(WEB, "pictures")
os.makedirs(shots, exist_ok=True)


def drive(*words):
    """Runs the page; its lines are this test's."""
    done = subprocess.run([node, os.path.join(HERE, "web", "viewer.mjs"),
                           PLAYWRIGHT, chromium, *words], timeout=3600)
    check("the page", done.returncode == 0, done.returncode)


def same_bytes(command="command.txt", picture="rest.png"):
    words = shlex.split(open(os.path.join(shots, command)).read())
    words[0] = TOOL
    out = words[words.index("--output") + 1] = os.path.join(shots, "again.png")
    subprocess.run([*words, "-y", "-q"], check=True)
    check(f"{picture} has the bytes of the copied command",
          open(out, "rb").read() ==
          open(os.path.join(shots, picture), "rb").read())


def watch(what, *volume):
    server = Server(*volume)
    drive(server.url, shots, what)
    same_bytes()
    if what != "short":
        same_bytes("slice.txt", "slice.png")
    code, said = server.stop()
    check("it ends in order", code == 0, f"{code} {said}")


def many_points():
    points = os.path.join(shots, "points.json")
    with open(points, "w") as out:
        json.dump({"snowglass-tf": 1, "values": "data", "opacities": [
            [i, i / 300] for i in range(300)]}, out)
    server = Server("phantom:head", "--tf", points)
    drive(server.url, shots, "points")
    server.stop()


def masked():
    server = Server("phantom:head", "--mask", "phantom:head", "--labels", "60-255")
    drive(server.url, shots, "mask")
    server.stop()


def opened():
    server = Server("phantom:head")
    drive(server.url, shots, "recipes")
    server.stop()


def overlaid():
    """A head; its bright voxels as labels, left and right; values on half the grid."""
    base, seg, dose = (os.path.join(shots, name) for name in
                       ("base.nrrd", "seg.nrrd", "dose.nrrd"))
    subprocess.run([TOOL, "convert", "phantom:head", "--dims", "48x40x36", "-o", base,
                    "-y", "-q"], check=True)
    head, voxels = open(base, "rb").read().split(b"\n\n", 1)
    subprocess.run([TOOL, "convert", "phantom:head", "--dims", "24x20x18", "-o", dose,
                    "-y", "-q"], check=True)
    with open(seg, "wb") as out:
        out.write(head + b"\nSegment0_LabelValue:=1\nSegment0_Name:=left"
                  b"\nSegment1_LabelValue:=2\nSegment1_Name:=right\n\n" +
                  bytes((1 + (i % 48 >= 24)) * (value > 60)
                        for i, value in enumerate(voxels)))
    for what, *volume in (("overlay", base, "--overlay", seg), ("fused", base, "--overlay", dose),
                          ("labels", seg)):
        server = Server(*volume)
        drive(server.url, shots, what)
        same_bytes()
        same_bytes("slice.txt", "slice.png")
        server.stop()


def mixed():
    """Balls of three channels, with names and colours."""
    place = os.path.join(shots, "told.zarr")
    shutil.rmtree(place, ignore_errors=True)
    write_channels(place, True)
    server = Server(place)
    drive(server.url, shots, "channels")
    same_bytes()
    same_bytes("slice.txt", "slice.png")
    server.stop()
    points = os.path.join(shots, "points.json")
    with open(points, "w") as out:
        json.dump({"snowglass-tf": 1, "values": "data",
                   "opacities": [[0, 0], [900, 1]]}, out)
    for options in ("--component", "1"), ("--tf", points):
        server = Server(place, *options)
        drive(server.url, shots, "begun")
        server.stop()
    ten = os.path.join(shots, "ten.zarr")
    shutil.rmtree(ten, ignore_errors=True)
    write_channels(ten, True, 10)
    server = Server(ten, "--tf", points)
    drive(server.url, shots, "many")
    same_bytes()
    same_bytes("slice.txt", "slice.png")
    server.stop()


class Around(http.server.BaseHTTPRequestHandler):
    """A page with nothing but the viewer in a frame, which stands behind its ?."""

    def do_GET(self):
        shown = urllib.parse.unquote(self.path.partition("?")[2])
        body = f'<iframe src="{shown}" width=900 height=600></iframe>'.encode()
        self.send_response(200)
        self.send_header("content-type", "text/html")
        self.end_headers()
        self.wfile.write(body)

    def log_message(self, *said):
        pass


def embedded():
    """In a frame of one page, and not of another."""
    pages = [http.server.ThreadingHTTPServer(("127.0.0.1", 0), Around)
             for _ in range(2)]
    for page in pages:
        threading.Thread(target=page.serve_forever, daemon=True).start()
    origins = [f"http://127.0.0.1:{page.server_port}" for page in pages]
    server = Server("phantom:head", "--embed", origins[0])
    drive(server.url, shots, "embed", *origins)
    server.stop()


def filmed():
    """A radiologist's way, with a finger in a narrow window, with a mouse in a wide
    one, on DICOM slices of a chest."""
    packed = os.path.join(DATA, "dicom", "ct_abdomen_20of275.tar.gz")
    if not os.path.exists(packed):
        print("skip   the film: there is no", packed)
        return
    place = os.path.join(shots, "film")
    shutil.rmtree(place, ignore_errors=True)
    with tarfile.open(packed) as scan:
        scan.extractall(place)
    server = Server(os.path.join(place, "ct_abdomen"))
    drive(server.url, shots, "film")
    for name in ("film_narrow", "film_wide"):
        same_bytes(f"{name}_command.txt", f"{name}_rest.png")
        same_bytes(f"{name}_slice.txt", f"{name}_slice.png")
    server.stop()


def everyday():
    """A CT of four steps, and a viewer that is started again."""
    base = os.path.join(shots, "base.nrrd")
    subprocess.run([TOOL, "convert", "phantom:head", "--dims", "48x40x36", "-o", base,
                    "-y", "-q"], check=True)
    voxels = open(base, "rb").read().split(b"\n\n", 1)[1]
    name = os.path.join(shots, "steps.nrrd")
    with open(name, "wb") as out:
        out.write(b"NRRD0004\ntype: int16\ndimension: 4\nendian: little\n"
                  b"encoding: raw\nspace: right-anterior-superior\n"
                  b"space directions: (4,0,0) (0,4,0) (0,0,4) none\n"
                  b"kinds: domain domain domain time\n"
                  b"sizes: 48 40 36 4\n\n")
        out.write(array.array("h", (
            8 * value - 1000 + 60 * step * (value > 0)
            for step in range(4) for value in voxels)).tobytes())
    server = Server(name)
    drive(server.url, shots, "steps")
    server.stop()
    drive(TOOL, shots, "restarted")


watch("short" if SHORT else "long", "phantom:head")
if not SHORT:
    embedded()
    everyday()
    many_points()
    masked()
    opened()
    overlaid()
    mixed()
if not SHORT:
    filmed()
finish()
