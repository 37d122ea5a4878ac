"""`serve FOLDER`: what the list has beside what pydicom and Python find, what is opened
from it, and what stays closed: what a link leads to, what a page names, what is gone."""
import base64
import gzip
import io
import json
import os
import random
import shutil
import socket
import struct
import subprocess
import sys
import tempfile
import zlib

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from viewer_client import TOOL, Page, Server, check, finish, run_command, skip, write_channels
from volumes import each, nifti, npy, nrrd, placed

try:
    import pydicom
    from pydicom.dataset import Dataset, FileDataset, FileMetaDataset
    from pydicom.uid import CTImageStorage, ExplicitVRLittleEndian, ImplicitVRLittleEndian, generate_uid
except ImportError:
    skip("pydicom is missing")

TOP = tempfile.TemporaryDirectory()
ROOT = os.path.join(TOP.name, "study")
SECRET = os.path.join(TOP.name, "secret.nrrd")
DIMS = (12, 10, 8)
AGAIN = os.path.join(TOP.name, "again.png")
MARK = 77  # of the file outside


def voxel(x, y, z):
    return (40 * (x in (3, 8)) + 9 * x + 5 * y + 3 * z) % 250


def slices(folder, series, modality, day, number, count, side, syntax=ExplicitVRLittleEndian, text="",
           beside=None):
    """A series of axial slices, whose values are those of a ramp."""
    os.makedirs(os.path.join(ROOT, folder), exist_ok=True)
    for n in range(count):
        meta = FileMetaDataset()
        meta.MediaStorageSOPClassUID = CTImageStorage
        meta.MediaStorageSOPInstanceUID = generate_uid()
        meta.TransferSyntaxUID = syntax
        name = os.path.join(ROOT, folder, f"{modality}{number}_{n:03d}.dcm")
        data = FileDataset(name, {}, file_meta=meta, preamble=bytes(128))
        data.is_little_endian, data.is_implicit_VR = True, syntax == ImplicitVRLittleEndian
        data.SOPClassUID, data.SOPInstanceUID = CTImageStorage, meta.MediaStorageSOPInstanceUID
        data.StudyDate, data.Modality, data.SeriesNumber = day, modality, number
        data.SeriesDescription, data.PatientName = text, "Nobody^Secret"
        data.StudyInstanceUID, data.SeriesInstanceUID, data.InstanceNumber = "1.2.3", series, n + 1
        if beside:  # another series of the folder, as those of a PET and its CT are
            related = Dataset()
            related.StudyInstanceUID, related.SeriesInstanceUID = "1.2.3", beside
            data.add_new(0x00081250, "SQ", [related])
            data[0x00081250].is_undefined_length = n % 2 == 0
        data.Rows = data.Columns = side
        data.ImagePositionPatient, data.ImageOrientationPatient = [0, 0, 2 * n], [1, 0, 0, 0, 1, 0]
        data.PixelSpacing, data.SamplesPerPixel, data.PhotometricInterpretation = [1, 1], 1, "MONOCHROME2"
        data.BitsAllocated, data.BitsStored, data.HighBit, data.PixelRepresentation = 16, 16, 15, 0
        data.PixelData = struct.pack(f"<{side * side}H", *(
            (x * 7 + y * 3 + n) % 200 for y in range(side) for x in range(side)))
        data.save_as(name)


def in_root(*names):
    return os.path.join(ROOT, *names)


def make():
    slices("hospital", "1.2.3.4", "CT", "20240305", 2, 4, 16, text="Thorax", beside="1.2.3.9")
    slices("hospital", "1.2.3.9", "MR", "20231224", 5, 6, 24, ImplicitVRLittleEndian, text="T1 <b>axial</b>",
           beside="1.2.3.5")
    slices("hospital", "1.2.3.5", "PT", "", 7, 3, 8, beside="1.2.3.4")
    slices("hospital/deep", "1.2.3.7", "CT", "20200229", 1, 5, 12)
    nrrd(in_root("a.nrrd"), DIMS, each(DIMS, voxel), *placed((1, 1, 2), (0, 0, 0)))
    nrrd(SECRET, DIMS, each(DIMS, lambda *_: MARK), *placed((1, 1, 2), (0, 0, 0)))
    os.makedirs(in_root("sub"))
    nifti(in_root("sub", "b.nii"), DIMS, (2, 8), each(DIMS, voxel))
    npy(in_root("sub", "ü.npy"), "|u1", DIMS[::-1], each(DIMS, voxel))
    write_channels(in_root("cells.zarr"), True)
    with open(in_root("a.nrrd"), "rb") as whole, open(in_root("sub", "cut.nrrd"), "wb") as cut:
        cut.write(whole.read()[:-20])
    nifti(in_root("sub", "half.nii"), (64, 64, 64), (2, 8), random.Random(1).randbytes(1 << 18))
    with open(in_root("sub", "half.nii"), "rb") as whole, open(in_root("sub", "half.nii.gz"), "wb") as half:
        half.write(gzip.compress(whole.read())[:1 << 17])
    os.remove(in_root("sub", "half.nii"))
    for name in ("notes.txt", "table.json", ".hidden.nrrd"):
        with open(in_root(name), "w") as out:
            out.write('{"subject": 3}' if name.endswith("json") else "no volume")
    with open(in_root("sub", "warm.json"), "w") as out:
        json.dump({"input": "b.nii", "preset": "linear", "azimuth": 33}, out)
    with open(in_root("sub", "away.json"), "w") as out:
        json.dump({"input": "../../secret.nrrd", "azimuth": 33}, out)
    os.symlink(SECRET, in_root("out.nrrd"))
    os.symlink("..", in_root("sub", "up"))
    os.symlink(in_root("sub", "b.nii"), in_root("inside.nii"))
    os.mkfifo(in_root("pipe.nrrd"))


def listing(page, piece=None):
    """The whole list, once it is done, in its order; and the last word about it."""
    word = page.receive_text("folder")
    while not word["done"]:
        word = page.receive_text("folder")
    entries = []
    while len(entries) < word["count"]:
        page.question("folder", **{"from": len(entries)})
        got = page.receive_text("entries")
        if got["from"] != len(entries) or not 0 < len(got["entries"]) <= 100:
            check("a piece begins where it is to, and is small", False, got["from"])
        entries += got["entries"]
    return entries, word


def independent():
    """What a folder's DICOM files have, by pydicom: {(folder, UID): facts}."""
    found = {}
    for folder, _, names in os.walk(ROOT):
        for name in names:
            if not name.endswith(".dcm"):
                continue
            data = pydicom.dcmread(os.path.join(folder, name), stop_before_pixels=True)
            key = os.path.relpath(folder, ROOT), str(data.SeriesInstanceUID)
            day = str(data.StudyDate)
            facts = found.setdefault(key, [data.Modality, [data.Columns, data.Rows, 0], data.SeriesDescription,
                                           f"{day[:4]}-{day[4:6]}-{day[6:]}" if day else ""])
            facts[1][2] += 1
    return found


def lists_what_is_there(entries, word):
    volumes = [e for e in entries if e["kind"] == "volume"]
    series = {(e["name"], e["series"]): [e["modality"], e["dims"], e["description"], e["day"]]
              for e in volumes if e["format"] == "dicom"}
    wanted = independent()
    alone = ("hospital/deep", "1.2.3.7")  # the only one of its folder has no need of a UID
    wanted[alone[0], ""] = wanted.pop(alone)
    check("series are those of pydicom", series == wanted, f"{series} {wanted}")
    files = {e["name"]: (e["dims"], e["bytes"]) for e in volumes if e["format"] != "dicom"}
    half = files.pop("sub/half.nii.gz", None)
    want = {name: (list(DIMS), os.path.getsize(in_root(name)))
            for name in ("a.nrrd", "sub/b.nii", "sub/ü.npy", "inside.nii")}
    zarr = files.pop("cells.zarr", None)
    check("files have their size", files == want, f"{files} {want}")
    check("so has one whose end is missing", half == ([64, 64, 64], 1 << 17), half)
    check("a Zarr folder is one volume", zarr and zarr[0] == [30, 26, 22], zarr)
    faults = {e["name"]: e["text"] for e in entries if e["kind"] == "fault"}
    check("what cannot be opened is listed with why", set(faults) == {"out.nrrd", "sub/cut.nrrd"} and
          "leads out" in faults["out.nrrd"] and "truncated" in faults["sub/cut.nrrd"], faults)
    check("and without the folder's path", not any(TOP.name in text for text in faults.values()), faults)
    check("others are counted", word["others"] == 2, word)  # notes.txt, table.json
    check("recipes name their volumes", {(e["name"], e["text"]) for e in entries if e["kind"] == "recipe"} ==
          {("sub/warm.json", "b.nii"), ("sub/away.json", "secret.nrrd")}, entries)
    check("no patient is named", "Nobody" not in json.dumps(entries))


def index_of(entries, name, series=""):
    return next(i for i, e in enumerate(entries) if (e["name"], e["series"]) == (name, series))


def covers_are_slices(page, entries):
    from PIL import Image
    for name, series, path in (("a.nrrd", "", "a.nrrd"), ("hospital", "1.2.3.9", "hospital")):
        page.question("cover", entry=index_of(entries, name, series))
        got = page.receive_text("cover")["image"]
        shown = Image.open(io.BytesIO(base64.b64decode(got.partition(",")[2]))).convert("L")
        subprocess.run([TOOL, "slice", in_root(path), *(["--series", series] if series else []), "-s", "96x96",
                        "--no-labels", "-y", "-q", "-o", os.path.join(TOP.name, "slice.png")], check=True)
        made = Image.open(os.path.join(TOP.name, "slice.png")).convert("L")
        apart = [abs(a - b) for a, b in zip(shown.getdata(), made.getdata())]
        check(f"the picture of {name} is its middle slice", shown.size == made.size == (96, 96) and
              sum(apart) / len(apart) < 3 and max(made.getdata()) > 60, f"{shown.size} {sum(apart) / len(apart)}")
    page.question("cover", entry=index_of(entries, "sub/cut.nrrd"))
    check("a damaged file has no picture", page.receive_text("cover")["image"] is None)


def opened(page, **what):
    """The description of what is open then; None: it was refused, and `page.why` says why."""
    page.question("open", **what)
    info, page.why, page.state = None, "", {}
    while True:
        kind, message = page.hear()
        if kind == "closed":
            return None
        if kind != "text":
            page.say({"t": "ack", "n": 0})
        elif message["t"] == "info":
            info = message
        elif message["t"] == "state":
            page.state = message["keys"]
        elif message["t"] == "said":
            page.why = message["text"]
        elif message["t"] == "opened":
            return info if message["good"] else None


def opens_what_was_chosen(server, page, entries):
    page.set(1, size=[64, 48])
    info = opened(page, entry=index_of(entries, "hospital", "1.2.3.9"))
    check("a series opens", info and info["dims"] == [24, 24, 6] and info["name"] == "hospital", f"{info} {page.why}")
    shown = page.receive_picture(2)
    command = page.ask("command")["text"]
    check("its picture is that of its command", "--series 1.2.3.9" in command and run_command(command, out=AGAIN) == shown, command)
    check("and so is that of another page", Page(server).receive_text("info")["dims"] == [24, 24, 6])
    page.set(2, azimuth=50, title="kept by none")
    again = opened(page, name="sub/b.nii", series="")
    check("a file opens by its name, with a state of its own", again and again["dims"] == list(DIMS) and
          "title" not in page.state and not page.state["azimuth"], f"{again and again['dims']} {page.state}")
    check("each has a number", again and info and again["opened"] == info["opened"] + 1)
    warm = opened(page, entry=index_of(entries, "sub/warm.json"))
    check("a recipe opens its volume as it was", warm and warm["name"] == "b.nii" and
          page.state.get("azimuth") == 33 and page.state.get("preset") == "linear", page.state)
    shown, command = page.rest(9, size=[64, 48]), page.ask("command")["text"]
    check("and has a command", run_command(command, out=AGAIN) == shown, command)
    late = opened(page, entry=index_of(entries, "a.nrrd"), first=True)
    check("a page that comes back too late opens nothing", late is None and not page.why and
          page.ask("command")["text"] == command, page.why)


def is_open_still(page):
    """The volume with the ramp.  Pictures that came meanwhile are acknowledged."""
    value = page.ask("value", at=[3, 2, 1])["value"]
    for _ in range(2):
        page.say({"t": "ack", "n": 0})
    return value == voxel(3, 2, 1)


def stays_closed(page, entries):
    before = opened(page, entry=index_of(entries, "a.nrrd"))
    wrong = [{"entry": -1}, {"entry": len(entries)}, {"entry": 1 << 62}, {"entry": 1.5}, {"entry": "0"}, {"entry": None},
             {"entry": [0]}, {}, {"name": "../secret.nrrd"}, {"name": SECRET}, {"name": "/etc/passwd"},
             {"name": "sub/../a.nrrd"}, {"name": "./a.nrrd"}, {"name": "sub/up/a.nrrd"}, {"name": "out.nrrd"},
             {"name": "phantom:engine"}, {"name": ""}, {"name": ["a.nrrd"]}, {"name": "a.nrrd", "series": "1"},
             {"path": SECRET}, {"entry": index_of(entries, "out.nrrd")}, {"entry": index_of(entries, "sub/cut.nrrd")},
             {"entry": index_of(entries, "sub/away.json")}]
    bad = [what for what in wrong if opened(page, **what) is not None or not page.why]
    check("nothing else opens, and each time a line says why", before and not bad, bad)
    check("and what was open stays", is_open_still(page))
    for what, asked in (("folder", {"from": -1}), ("folder", {"from": "x"}), ("folder", {}), ("cover", {"entry": 1 << 40}),
                        ("cover", {"entry": -1}), ("cover", {}), ("folder", {"from": 1 << 62})):
        page.question(what, **asked)
    page.set(20, size=[65, 48])
    check("wrong questions about the list do no harm", page.receive_picture(2, 20) is not None)


def follows_what_changes(page, entries):
    """A file that is another one, or a link out, or gone, since it was listed."""
    check("a file that cannot be read to its end is refused", opened(page, name="sub/half.nii.gz", series="") is None and
          page.why, page.why)
    check("and the one before comes back", is_open_still(page))
    page.set(30, size=[60, 48])
    shown, page.replaced = None, None
    while not shown:
        kind, message = page.hear()
        if kind == "text" and message["t"] == "replaced":
            page.replaced = message
        elif kind == "picture":
            page.say({"t": "ack", "n": 0})
            shown = message[32:] if message[8] == 2 else None
    command = page.ask("command")["text"]
    check("and draws", run_command(command, out=AGAIN) == shown, command)
    check("and is not taken for another file", page.replaced is None, page.replaced)
    target = in_root("sub", "ü.npy")
    os.remove(target)
    check("a file that is gone is said to be", opened(page, name="sub/ü.npy", series="") is None and
          "not there" in page.why and TOP.name not in page.why, page.why)
    os.symlink(SECRET, target)
    check("a link that leads out has taken its place: closed", opened(page, name="sub/ü.npy", series="") is None and
          "leads out" in page.why, page.why)
    nrrd(in_root("a.nrrd"), (3, 3, 3), bytes(5))
    check("a file that was cut since is refused", opened(page, name="a.nrrd", series="") is None and page.why, page.why)
    check("and what was open stays whole", is_open_still(page))
    os.symlink(SECRET, in_root("hospital", "CT2_000x.dcm"))
    check("a link out among slices closes their folder", opened(page, entry=index_of(entries, "hospital", "1.2.3.4")) is None and
          "leads out" in page.why, page.why)
    os.remove(in_root("hospital", "CT2_000x.dcm"))
    slices("hospital", "1.2.3.1", "CT", "20240306", 1, 9, 20)
    slices("hospital", "1.2.3.5", "PT", "", 7, 3, 10)
    check("another series in the place of one that was listed is refused", opened(
        page, entry=index_of(entries, "hospital", "1.2.3.5")) is None and "other series" in page.why, page.why)
    info = opened(page, entry=index_of(entries, "hospital", "1.2.3.4"))
    check("a new series moves no other", info and info["dims"] == [16, 16, 4], f"{info and info['dims']} {page.why}")


def one_volume_opens_as_before():
    """A folder that is one volume has no list."""
    for name, dims in (("hospital/deep", [12, 12, 5]), ("cells.zarr", [30, 26, 22])):
        server = Server(in_root(name))
        page = Page(server)
        info = page.receive_text("info")
        page.question("folder", **{"from": 0})
        heard = page.receive_text("said")
        check(f"{name} opens as one volume", info["dims"] == dims and not info["opened"] and
              "nothing is known" in heard["text"], f"{info['dims']} {heard}")
        page.close()
        server.stop()


def many_are_listed():
    """Of thousands each comes, in pieces, and pictures go on."""
    folder = os.path.join(TOP.name, "many")
    os.makedirs(folder)
    tiny = (2, 2, 2)
    for n in range(1500):
        nrrd(os.path.join(folder, f"v{n}.nrrd"), tiny, bytes(8))
    server = Server(folder)
    page = Page(server)
    entries, word = listing(page)
    check("all of 1,500 are listed", len(entries) == 1500 and {e["name"] for e in entries} ==
          {f"v{n}.nrrd" for n in range(1500)}, len(entries))
    for n in range(200):
        page.question("cover", entry=n)
    got = {page.receive_text("cover")["entry"] for n in range(60)}
    check("covers that are asked together come", len(got) == 60, len(got))
    page.close()
    server.stop()


def refusals():
    for arguments, words in ((["--mask", "m.nrrd"], "of one volume"), (["--overlay", "m.nrrd"], "of one volume")):
        done = subprocess.run([TOOL, "serve", ROOT, *arguments], capture_output=True, text=True, timeout=60)
        check(f"{arguments[0]} needs one volume", done.returncode == 2 and words in done.stderr, done.stderr)
    done = subprocess.run([TOOL, "serve", in_root("sub", "up", "nothing")], capture_output=True, text=True, timeout=60)
    check("a folder that is not there is refused", done.returncode == 3, done.stderr)
    mpi = f"{TOOL}-mpi"
    if shutil.which("mpirun") and os.path.exists(mpi):
        done = subprocess.run(["mpirun", "--allow-run-as-root", "--oversubscribe", "-n", "2", mpi, "serve", ROOT],
                              capture_output=True, text=True, timeout=120)
        lines = [line for line in done.stderr.splitlines() if "snowglass" in line]
        check("many ranks refuse a list in one line", done.returncode and
              sum("several volumes" in line for line in lines) == 1, done.stderr)


make()
listed = Server(ROOT)
first = Page(listed)
all_entries, last = listing(first)
lists_what_is_there(all_entries, last)
first.question("histogram")
check("before a choice there is nothing", "choose a volume" in first.receive_text("said")["text"])
covers_are_slices(first, all_entries)
opens_what_was_chosen(listed, first, all_entries)
stays_closed(first, all_entries)
follows_what_changes(first, all_entries)
listed.stop()
one_volume_opens_as_before()
many_are_listed()
refusals()
finish()
