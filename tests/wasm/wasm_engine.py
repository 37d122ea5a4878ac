"""The engine of the page without a server makes the pictures of the tool, bit for
bit, and refuses by name what it has not."""
import functools
import json
import os
import shlex
import shutil
import struct
import subprocess
import sys
import zlib

TOOL, OUT, TOP = map(os.path.abspath, sys.argv[1:4])
HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, HERE)
from checks import check, end, skip  # noqa: E402
from dicom_slice import dicom  # noqa: E402
from png import levels  # noqa: E402

ENGINE = os.path.join(TOP, "build-web", "engine.wasm")
QUALITIES = "draft", "normal", "high"
RAW, PNG = 4, 2


@functools.lru_cache(maxsize=None)  # with threads it is the same command
def of_tool(command, quality):
    words = shlex.split(command)
    words[0] = TOOL
    out = words[words.index("--output") + 1] = os.path.join(OUT, "tool.png")
    words[words.index("--quality") + 1] = quality
    subprocess.run([*words, "-y", "-q", "--threads", "1"], check=True, cwd=OUT)
    with open(out, "rb") as file:
        return file.read()


def compare(name):
    with open(os.path.join(OUT, f"{name}.json")) as file:
        said = json.load(file)
    if not said.get("command"):
        check(name, False, said)
        return
    for level, quality in enumerate(QUALITIES):
        with open(os.path.join(OUT, f"{name}-{level}.bin"), "rb") as file:
            frame = file.read()
        png = of_tool(said["command"], quality)
        kind, pixels = frame[9], frame[32:]
        if kind == PNG:
            check(f"{name}, {quality}: the same file", pixels == png)
            continue
        width, height, rgb = levels(png)
        same = kind == RAW and len(pixels) == 4 * width * height and all(
            pixels[i::4] == rgb[i] for i in range(3))
        check(f"{name}, {quality}: the same levels "
              f"(crc32 {zlib.crc32(pixels):08x})", same and len(set(rgb[0])) > 9)


def refused(name, *words):
    with open(os.path.join(OUT, f"{name}.json")) as file:
        said = json.load(file)
    line = " ".join(said["said"])
    check(f"{name} is refused by name", not said["opened"] and
          all(word in line for word in words), said)


node = shutil.which("node") or shutil.which("nodejs")
if not node:
    skip("there is no node")
if not os.path.exists(ENGINE):
    skip("there is no engine: ./dev web builds it")
shutil.rmtree(OUT, ignore_errors=True)
os.makedirs(OUT)


def make(name, *words):
    subprocess.run([TOOL, *words, "-o", os.path.join(OUT, name), "-q"],
                   check=True)
    return name


def write(name, data):
    with open(os.path.join(OUT, name), "wb") as file:
        file.write(data)
    return name


LARGE = 900, 900, 907  # of 2 bytes; a page keeps 1,400 MiB


def write_large():
    """A box in nothing, which has no room on the disk."""
    with open(os.path.join(OUT, "large.nrrd"), "wb") as file:
        head = "NRRD0004\ntype: int16\ndimension: 3\nsizes: %d %d %d\n" \
            "endian: little\nencoding: raw\n\n" % LARGE
        file.write(head.encode())
        file.truncate(len(head) + 2 * LARGE[0] * LARGE[1] * LARGE[2])
        for z in range(700, 800):
            for y in range(440, 460):
                file.seek(len(head) + 2 * ((z * LARGE[1] + y) * LARGE[0] + 400))
                file.write(struct.pack("<100h", *(20 + x + (y + z) % 50
                                                  for x in range(100))))
    return "large.nrrd"


make("head.nrrd", "phantom", "head", "--dims", "64x64x48")
os.makedirs(os.path.join(OUT, "slices"))
stack = ["points.json", *(make(
    f"slices/{z}.png", "slice", os.path.join(OUT, "head.nrrd"), "--axis", "z",
    "--at", str(20 + z), "--no-labels") for z in range(6))]
write("points.json", json.dumps({
    "snowglass-tf": 1, "values": "data",
    "opacities": [[20, 0], [90, 0.2], [200, 0.9]]}).encode())
# The order is not that of the names.
os.makedirs(os.path.join(OUT, "series"))
series = [write(f"series/{7 * z % 11}.dcm", dicom(z)) for z in range(11)]
os.makedirs(os.path.join(OUT, "packed.zarr", "0"))
packed = [write("packed.zarr/.zarray", json.dumps({
    "zarr_format": 2, "shape": [4, 4, 4], "chunks": [4, 4, 4], "dtype": "|u1",
    "compressor": {"id": "zstd", "level": 1}, "fill_value": 0, "order": "C",
    "filters": None}).encode()), write("packed.zarr/0.0.0", bytes(40))]
volumes = [
    ("engine", "phantom:engine", None, {"size": [240, 200], "azimuth": 30,
                                        "elevation": 25}),
    ("head", "head.nii.gz", make(
        "head.nii.gz", "convert", os.path.join(OUT, "head.nrrd"), "--as",
        "int16"), {"size": [160, 180], "preset": "ct-bone", "perspective": 30,
                   "range": [30, 200], "azimuth": -40, "legend": True}),
    ("smoke", "smoke.nrrd", make(
        "smoke.nrrd", "convert", "phantom:turbulence", "--as", "float32",
        "--crop", "0:64,0:64,0:64"), {"size": [200, 160], "mode": "mip",
                                      "colormap": "viridis", "azimuth": 20,
                                      "elevation": 10}),
    ("surface", "head.nrrd", "head.nrrd", {
        "size": [160, 160], "mode": "iso", "iso": 60}),
    ("far", "head.nrrd", "head.nrrd", {
        "size": [130, 101], "zoom": 0.2, "roll": -50, "mode": "mean"}),
    ("series", "series", series, {"size": [120, 90], "azimuth": 20,
                                  "elevation": 20}),
    ("slabs", "slabs.nrrd", make("slabs.nrrd", "phantom", "head", "--dims",
                                 "192x192x160"), {
        "size": [120, 100], "azimuth": 30, "memory": "9M"}),
    ("stack", "slices", stack, {"size": [100, 100], "tf": "points.json"}),
]
strangers = [
    ("damaged", write("damaged.nrrd", b"NRRD0004\ntype: uint8\ndimension: 3\n"
                      b"sizes: 9 9 9\nencoding: raw\n\nabc"),
     ("damaged.nrrd", "3 bytes left", "729")),
    ("hdf5", write("a.h5", b"\x89HDF\r\n\x1a\n" + bytes(2000)),
     ("a.h5", "lacks HDF5")),
    ("tiff", write("a.tif", b"II*\0\x08\0\0\0" + bytes(300)),
     ("a.tif", "lacks TIFF")),
    ("jpeg", write("a.jpg", b"\xff\xd8\xff\xe0\0\x10JFIF\0" + bytes(300)),
     ("a.jpg", "lacks", "JPEG")),
    ("vti", write("a.vti", b'<?xml version="1.0"?>\n<VTKFile type="ImageData" '
                  b'version="1.0"><ImageData WholeExtent="0 1 0 1 0 1"/></VTKFile>'),
     ("a.vti", "lacks", "XML")),
    ("dicom", write("a.dcm", dicom(0, "1.2.840.10008.1.2.4.70")),
     ("a.dcm", "compressed DICOM", "1.2.840.10008.1.2.4.70")),
    ("zarr", ["packed.zarr", *packed], ("packed.zarr", "not compressed by zstd", "copy it again")),
    ("refinement", write("a.vth", b'<?xml version="1.0"?>\n<VTKFile '
                         b'type="vtkOverlappingAMR" version="1.1"/>'),
     ("a.vth", "levels of refinement")),
    ("unknown", write("a.dat", bytes(5000)), ("a.dat",)),
]
jobs = [{"name": name, "path": path, "recipe": recipe, "files":
         file if isinstance(file, list) else [file] if file else []}
        for name, path, file, recipe in volumes]
THREADS = 3
jobs += [{**job, "name": f"{job['name']}-threads", "threads": THREADS}
         for job in jobs]
# Where threads share it, a file of Node is read whole before.
for job in jobs:
    job["kept"] = job["name"] == "slabs"
jobs += [{"name": "whole", "path": "slabs.nrrd", "files": ["slabs.nrrd"],
          "kept": True, "recipe": {"size": [120, 100]}},
         {"name": "once", "path": "series", "files": series, "kept": True,
          "recipe": {"size": [120, 90]}},
         {"name": "large", "path": "large.nrrd", "files": [write_large()],
          "kept": True, "first": True, "recipe": {
              "size": [120, 100], "range": [20, 200], "mode": "mip"}}]
jobs += [{**jobs[3], "name": "narrow", "threads": THREADS, "narrow": True},
         {**jobs[3], "name": "turned", "turn": {"azimuth": 40}}]
jobs += [{"name": name, "path": given[0] if isinstance(given, list) else given,
          "files": given[1:] if isinstance(given, list) else [given], "recipe": {}}
         for name, given, _ in strangers]
subprocess.run([node, os.path.join(HERE, "engine.cjs"),
                os.path.join(TOP, "wasm", "page", "worker.js"), ENGINE, OUT,
                json.dumps(jobs)], check=True, timeout=500)
for volume in volumes:
    compare(volume[0])
    compare(f"{volume[0]}-threads")
compare("narrow")


def took(name):
    """The processor's milliseconds of each thread."""
    with open(os.path.join(OUT, f"{name}.json")) as file:
        return json.load(file)["took"]


first, *others = took("engine-threads")
check("other threads draw too", len(others) == THREADS - 1 and
      sum(others) > 0.04 * first, (first, others))
check("without room to share it is one thread", len(took("narrow")) == 1)


def read_of(name):
    """Of a file: the longest read and all of them, as shares of it."""
    with open(os.path.join(OUT, f"{name}.json")) as file:
        said = json.load(file)
    size = os.path.getsize(os.path.join(OUT, said["path"]))
    return said, said["reads"]["most"] / size, said["reads"]["all"] / size


said, most, all_of_it = read_of("whole")
check("what fits is read once", 0.99 < all_of_it < 1.05, all_of_it)
with open(os.path.join(OUT, "once.json")) as file:
    reads = json.load(file)["reads"]
check("each file of a series is read once", reads["count"] == len(series) and reads["all"] == sum(
    os.path.getsize(os.path.join(OUT, name)) for name in series), reads)
said, most, all_of_it = read_of("slabs")
check("what does not stays in its file, which is read for each picture",
      most < 0.2 and all_of_it > 3, (most, all_of_it))
said, most, all_of_it = read_of("large")
check("a file larger than the page's memory is drawn, in pieces of 1 MiB",
      said["levels"] == [0] and said["reads"]["most"] <= 1 << 20 and
      all_of_it >= 1, (said, most, all_of_it))
with open(os.path.join(OUT, "large-0.bin"), "rb") as file:
    check("and there is something to see", len(set(file.read()[32::4])) > 9)
os.remove(os.path.join(OUT, "large.nrrd"))
with open(os.path.join(OUT, "turned.json")) as file:
    levels_ = json.load(file)["levels"]
check("a turn does not wait for the picture at rest", levels_ == [0, 1, 0, 1, 2],
      levels_)
compare("turned")
for name, _, words in strangers:
    refused(name, *words)
end()
