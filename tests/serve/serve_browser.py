"""The viewer's page in Chromium, and the command that it copies."""
import array
import http.server
import json
import os
import shutil
import subprocess
import sys
import tarfile
import threading
import urllib.parse

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from viewer_client import (DATA, SHORT, TOOL, Server, check, finish, run_command, skip,
                           write_channels)
from volumes import dated, each, nrrd, placed

HERE = os.path.dirname(os.path.abspath(__file__))
WEB = os.path.abspath(sys.argv[3])
PLAYWRIGHT, AXE = (os.path.join(WEB, "node_modules", *path) for path in (
    ("playwright-core", "index.mjs"), ("axe-core", "axe.min.js")))


def find(*names):
    return next(filter(None, map(shutil.which, names)), None)


node, chromium = find("node", "nodejs"), find("chromium", "chromium-browser")
if not node:
    skip("there is no node")
if not chromium:
    skip("there is no chromium")
if not os.path.exists(PLAYWRIGHT) or not os.path.exists(AXE):
    skip("there is no playwright-core or axe-core: ./dev test installs them where npm is")

shots = os.path.join(WEB, "pictures")
os.makedirs(shots, exist_ok=True)


PICTURE, SLICE = ("command.txt", "rest.png"), ("slice.txt", "slice.png")
plans = []  # parts of the page's test, each with a viewer and what it copies


def plan(what, *volume, words=(), copies=()):
    server = Server(*volume)
    plans.append((what, server, [server.url, *words], copies))


def drive():
    """Runs the page; its lines are this test's."""
    parts = [",".join([what, *words]) for what, _, words, _ in plans]
    done = subprocess.run([node, os.path.join(HERE, "web", "viewer.mjs"), PLAYWRIGHT,
                           chromium, shots, *parts], timeout=3600)
    check("the page", done.returncode == 0, done.returncode)
    for what, server, _, copies in plans:
        for command, picture in copies:
            same_bytes(f"{what}_{command}", f"{what}_{picture}")
        if server:
            code, said = server.stop()
            check(f"{what} ends in order", code == 0, f"{code} {said}")


def same_bytes(command, picture):
    with open(os.path.join(shots, command)) as text, \
            open(os.path.join(shots, picture), "rb") as shown:
        check(f"{picture} has the bytes of the copied command", run_command(
            text.read(), out=os.path.join(shots, "again" + os.path.splitext(picture)[1])) == shown.read())


def points(name, opacities):
    """A file of a transfer function."""
    path = os.path.join(shots, name)
    with open(path, "w") as out:
        json.dump({"snowglass-tf": 1, "values": "data", "opacities": opacities}, out)
    return path


def head(name, *dims):
    """The phantom in a file, and its voxels."""
    path = os.path.join(shots, name)
    subprocess.run([TOOL, "convert", "phantom:head", "--dims", "x".join(map(str, dims)),
                    "-o", path, "-y", "-q"], check=True)
    with open(path, "rb") as file:
        return path, *file.read().split(b"\n\n", 1)


def overlaid():
    """A head; its bright voxels as labels, left and right; values on half the grid."""
    base, header, voxels = head("base.nrrd", 48, 40, 36)
    dose, seg = head("dose.nrrd", 24, 20, 18)[0], os.path.join(shots, "seg.nrrd")
    with open(seg, "wb") as out:
        out.write(header + b"\nSegment0_LabelValue:=1\nSegment0_Name:=left"
                  b"\nSegment1_LabelValue:=2\nSegment1_Name:=right\n\n" +
                  bytes((1 + (i % 48 >= 24)) * (value > 60)
                        for i, value in enumerate(voxels)))
    for what, *volume in (("overlay", base, "--overlay", seg),
                          ("fused", base, "--overlay", dose), ("labels", seg)):
        plan(what, *volume, copies=(PICTURE, SLICE))


def mixed():
    """Balls of three channels, with names and colours; and of ten."""
    told, ten = (os.path.join(shots, name) for name in ("told.zarr", "ten.zarr"))
    for place, count in (told, 3), (ten, 10):
        shutil.rmtree(place, ignore_errors=True)
        write_channels(place, True, count)
    plain = os.path.join(shots, "plain.zarr")
    shutil.copytree(told, plain, dirs_exist_ok=True)
    with open(f"{plain}/.zattrs") as file:
        about = json.load(file)
    for each in about["omero"]["channels"][1:]:
        each["active"] = False
    with open(f"{plain}/.zattrs", "w") as out:
        json.dump(about, out)
    plan("plain", plain, copies=(PICTURE, SLICE))
    two = points("two.json", [[0, 0], [900, 1]])
    plan("channels", told, copies=(PICTURE, SLICE))
    plan("begun", told, "--component", "1")
    plan("begun", told, "--tf", two)
    plan("many", ten, "--tf", two, copies=(PICTURE, SLICE))


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
    plan("embed", *HEAD, "--embed", origins[0], words=origins)


def filmed():
    """A radiologist's way, with fingers in a narrow window, on DICOM slices of a
    chest."""
    packed = os.path.join(DATA, "dicom", "ct_abdomen_20of275.tar.gz")
    if not os.path.exists(packed):
        print("skip   the film: there is no", packed)
        return
    place = os.path.join(shots, "film")
    shutil.rmtree(place, ignore_errors=True)
    with tarfile.open(packed) as scan:
        scan.extractall(place)
    plan("film", os.path.join(place, "ct_abdomen"), "-m", "over",
         copies=(PICTURE, SLICE))


def everyday():
    """A CT of four steps, and a viewer that is started again."""
    voxels = head("base.nrrd", 48, 40, 36)[2]
    name = os.path.join(shots, "steps.nrrd")
    nrrd(name, (48, 40, 36, 4), array.array("h", (
        8 * value - 1000 + 60 * step * (value > 0)
        for step in range(4) for value in voxels)).tobytes(),
         "space: right-anterior-superior",
         "space directions: (4,0,0) (0,4,0) (0,0,4) none",
         "kinds: domain domain domain time", kind="int16")
    plan("steps", name)
    plans.append(("restarted", None, [TOOL], ()))
    files = [head(f"asked{i}.nrrd", 48 - 8 * i, 40, 36)[0] for i in range(4)]
    plans.append(("asked", None, [TOOL, *files], ()))


def measured():
    """Uneven voxels in a patient's world, of values that say where they are."""
    name = os.path.join(shots, "measured.nrrd")
    nrrd(name, (40, 30, 20), each((40, 30, 20), lambda x, y, z: x + 10 * y + z, "h"),
         *placed((1, 2, 4), (10, -20, 30)), kind="int16")
    plan("measures", name, "--opacity", "-1:1,400:1", copies=[PICTURE])
    plan("layouts", name, "--opacity", "-1:1,400:1", copies=[PICTURE, SLICE])


def chosen():
    """Volumes in a folder."""
    place = os.path.join(shots, "volumes")
    shutil.rmtree(place, ignore_errors=True)
    os.makedirs(f"{place}/deep")
    voxels = head("base.nrrd", 48, 40, 36)[2]
    for name in ("v1", "v2", "v10", "deep/<b>v3"):
        nrrd(f"{place}/{name}.nrrd", (48, 40, 36), voxels)
    nrrd(f"{place}/cut.nrrd", (48, 40, 36), voxels[:999])
    with open(f"{place}/warm.json", "w") as out:
        json.dump({"input": "v2.nrrd", "azimuth": 33, "mask": "v2.nrrd", "labels": "60-255"}, out)
    plan("folder", place)
    again = os.path.join(shots, "volumes_again")
    shutil.copytree(place, again, dirs_exist_ok=True)
    plans.append(("reopened", None, [TOOL, again], ()))


def moving():
    """Six steps with dates."""
    name = os.path.join(shots, "dated.nc")
    dated(name, 6)
    plan("movies", name, copies=[("movie.txt", "movie.webp")])


HEAD = "phantom:head", "--dims", "64x64x64"  # a page waits for each picture of it
if SHORT:
    plan("short", *HEAD, copies=[PICTURE])
else:
    plan("long", *HEAD, copies=[PICTURE])
    plan("more", *HEAD, copies=[SLICE])
    embedded()
    everyday()
    plan("points", *HEAD, "--tf", points("points.json", [[i, i / 300] for i in range(300)]))
    plan("mask", head("head.nrrd", 64, 64, 64)[0], "--mask",
         os.path.join(shots, "head.nrrd"), "--labels", "60-255")
    plan("recipes", *HEAD)
    plan("transfer", *HEAD)
    measured()
    chosen()
    moving()
    overlaid()
    mixed()
    filmed()
drive()
finish()
