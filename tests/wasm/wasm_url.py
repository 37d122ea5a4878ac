"""The page without a server opens volumes on servers: stores that zarr wrote, by a server
that answers as those of the world do, with a log of what was asked for; and a page of
`snowglass export` can reach none."""
import http.server
import json
import os
import re
import shlex
import shutil
import struct
import subprocess
import sys
import threading
import time
import urllib.parse

TOOL, OUT, TOP = map(os.path.abspath, sys.argv[1:4])
HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(TOP, "tests", "support"))
from checks import check, end, find, skip  # noqa: E402
from png import levels  # noqa: E402

PLAYWRIGHT = os.path.join(os.path.dirname(TOOL), "web", "node_modules", "playwright-core",
                          "index.mjs")
PAGE = os.path.join(TOP, "build-web", "viewer.html")
ENGINE = os.path.join(TOP, "build-web", "engine.wasm")
STORES = os.path.join(OUT, "stores")


node, chromium = find("node", "nodejs"), find("chromium", "chromium-browser")
if not node:
    skip("there is no node")
if not os.path.exists(PAGE):
    skip("there is no page: ./dev web builds it")
try:
    import numcodecs
    import numpy as np
    import zarr
except ImportError as error:
    skip(error)
shutil.rmtree(OUT, ignore_errors=True)
os.makedirs(STORES)


def tool(*words):
    return subprocess.run([TOOL, *words], cwd=STORES, capture_output=True, text=True)


# --- stores -------------------------------------------------------------------

assert tool("phantom", "head", "--dims", "64x64x48", "-o", "head.nrrd").returncode == 0
assert tool("convert", "head.nrrd", "-o", "head.nii.gz").returncode == 0
assert tool("convert", "head.nrrd", "-o", "head.raw").returncode == 0
head = np.fromfile(os.path.join(STORES, "head.raw"), "u1").reshape(48, 64, 64)


def put(name, values):
    path = os.path.join(STORES, name)
    os.makedirs(os.path.dirname(path), exist_ok=True)
    with open(path, "w") as file:
        json.dump(values, file)


def write(name, values, packer, chunks=(20, 30, 40), **more):
    kept = zarr.open(os.path.join(STORES, name), "w", shape=values.shape, dtype=values.dtype,
                     chunks=chunks, compressor=packer, fill_value=0, **more)
    kept[...] = values


def image(name, levels):
    """An image of OME-Zarr with levels that lie there."""
    scales = [{"type": "scale", "scale": [1.2 * f, f, f]} for f in (1, 2, 4)]
    put(f"{name}/.zgroup", {"zarr_format": 2})
    put(f"{name}/.zattrs", {"multiscales": [{
        "version": "0.4", "axes": [{"name": n, "type": "space", "unit": "micrometer"}
                                   for n in "zyx"],
        "datasets": [{"path": path, "coordinateTransformations": [scale]}
                     for path, scale in zip(levels, scales)]}]})


LZ4 = numcodecs.Blosc("lz4", 5, numcodecs.Blosc.SHUFFLE)
# Of the finest level, of 1 GiB, no chunk is there: who asks for one is seen.
image("cells.zarr", ["0", "1", "2"])
zarr.open(os.path.join(STORES, "cells.zarr/0"), "w", shape=(1024, 1024, 1024), dtype="u1",
          chunks=(128, 128, 128), compressor=LZ4, dimension_separator="/")
write("cells.zarr/1", head.astype("<u2") * 11, LZ4, dimension_separator="/")
write("cells.zarr/2", head[::2, ::2, ::2].astype("<u2") * 11, LZ4, dimension_separator="/")
write("holes.zarr", head, numcodecs.Zstd(3), order="F")
os.remove(os.path.join(STORES, "holes.zarr/1.1.1"))
image("deep folder/my cells #1.zarr", ["a b", "c"])
for part, values in (("a b", head), ("c", head[::2, ::2, ::2])):
    write(f"deep folder/my cells #1.zarr/{part}", values,
          numcodecs.Blosc("zstd", 5, numcodecs.Blosc.BITSHUFFLE))
for packer in ("blosclz", "zlib", "lz4hc"):
    write(f"{packer}.zarr", head, numcodecs.Blosc(packer, 5))
write("lz4.zarr", head, numcodecs.LZ4())
for name in ("group.zarr", "nameless.zarr"):
    put(f"{name}/.zgroup", {"zarr_format": 2})
    write(f"{name}/deep/it", head, LZ4)
    put(f"{name}/deep/.zgroup", {"zarr_format": 2})
zarr.consolidate_metadata(os.path.join(STORES, "group.zarr"))
vast = zarr.open(os.path.join(STORES, "vast.zarr"), "w", shape=(2048, 1024, 1024), dtype="u1",
                 chunks=(64, 64, 64), fill_value=0, compressor=None)
vast[:64, :64, :64] = 1
put("series.zarr/.zgroup", {"zarr_format": 2})
put("series.zarr/.zattrs", {"bioformats2raw.layout": 3})
image("series.zarr/0", ["0"])
write("series.zarr/0/0", head, LZ4)

# Eight times of noise in one shard, whose index is at its end, as version 3 has them.
noise = np.random.default_rng(1).integers(0, 99, (8, 48, 64, 64), "u1")
noise[:, 12:36, 16:48, 16:48] += 100
body, index = b"", b""
for values in noise:
    packed = bytes(numcodecs.Zstd(1).encode(values.tobytes()))
    index += struct.pack("<QQ", len(body), len(packed))
    body += packed
put("shard.zarr/zarr.json", {
    "zarr_format": 3, "node_type": "array", "shape": noise.shape, "data_type": "uint8",
    "fill_value": 0, "attributes": {}, "dimension_names": list("tzyx"),
    "chunk_grid": {"name": "regular", "configuration": {"chunk_shape": noise.shape}},
    "chunk_key_encoding": {"name": "default"},
    "codecs": [{"name": "sharding_indexed", "configuration": {
        "chunk_shape": [1, 48, 64, 64], "index_location": "end",
        "codecs": [{"name": "bytes"}, {"name": "zstd", "configuration": {"level": 1}}],
        "index_codecs": [{"name": "bytes", "configuration": {"endian": "little"}}]}}]})
os.makedirs(os.path.join(STORES, "shard.zarr/c/0/0/0"))
with open(os.path.join(STORES, "shard.zarr/c/0/0/0/0"), "wb") as file:
    file.write(body + index)
SHARD = len(body + index)

# --- a server -------------------------------------------------------------------

asked = []  # (way, name, status, bytes, Range, Cookie)


class Server(http.server.BaseHTTPRequestHandler):
    """/WAY/NAME: the way says how it answers."""

    def do_GET(self):
        path, _, query = self.path[1:].partition("?")
        way, _, name = urllib.parse.unquote(path).partition("/")
        file = PAGE if name == "viewer.html" else os.path.join(STORES, name)
        if name == "made.html":
            file = os.path.join(OUT, name)
        there, chunk = os.path.isfile(file), not name.rpartition("/")[2].startswith((".z", "zarr."))
        status, body = 200, b""
        if way == "signed" and query != "token=a%2Fb+c&x=1":
            status, there = 403, False
        elif way == "broken" and name.endswith(".zarr/0.1.0"):
            status, there = 500, False
        elif way == "closed" and chunk:
            status, there = 403, False
        elif not there:
            status = 403 if way == "bucket" else 404
        if there:
            with open(file, "rb") as file:
                body = file.read()
        elif way == "spa":
            status, body = 200, b"\n<!DOCTYPE html><html><body>app</body></html>"
        if way == "slow":
            time.sleep(0.04)
        given = self.headers.get("Range") if there and way != "whole" else None
        total = len(body)
        if given:
            first, last = map(int, given[6:].split("-"))
            status, body = 206, body[first:last + 1]
        asked.append((way, name, status, len(body), given, self.headers.get("Cookie")))
        self.send_response(status)
        if way not in ("plain", "page") and not (way == "quiet" and not there):
            self.send_header("Access-Control-Allow-Origin", "*")
            self.send_header("Access-Control-Expose-Headers", "Content-Range")
        if way in ("page", "plain"):
            self.send_header("Cross-Origin-Opener-Policy", "same-origin")
            self.send_header("Cross-Origin-Embedder-Policy", "require-corp")
        if given:
            self.send_header("Content-Range", f"bytes {first}-{first + len(body) - 1}/{total}")
        self.send_header("Set-Cookie", "secret=1; Path=/")
        self.send_header("Content-Length", str(len(body)))
        self.end_headers()
        self.wfile.write(body)

    def do_OPTIONS(self):
        self.send_response(204 if "/whole/" not in self.path else 405)
        self.send_header("Access-Control-Allow-Origin", "*")
        self.send_header("Access-Control-Allow-Headers", "Range")
        self.end_headers()

    def do_POST(self):
        asked.append(("post", self.path, 200, 0, None, None))
        self.send_response(204)
        self.end_headers()

    def log_message(self, *words):
        pass


server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Server)
threading.Thread(target=server.serve_forever, daemon=True).start()
HOST = f"http://127.0.0.1:{server.server_port}"
FAR = f"http://localhost:{server.server_port}"  # of another origin than HOST
made = tool("export", "../made.html", "head.nrrd")
check("a page is made", made.returncode == 0, made.stderr)

# name, address below FAR
SHOWN = [
    ("lz4", "cors/cells.zarr"), ("zstd", "cors/holes.zarr/"),
    ("shard", "cors/shard.zarr/zarr.json"),
    ("level", "cors/deep%20folder/my%20cells%20%231.zarr/a%20b"),
    ("signed", "signed/head.nii.gz?token=a%2Fb+c&x=1"), ("file", "cors/head.nrrd#part"),
    ("group", "cors/group.zarr"), ("series", "cors/series.zarr"), ("quiet", "quiet/blosclz.zarr"),
    ("bucket", "bucket/zlib.zarr"), ("whole", "whole/shard.zarr"), ("lz4hc", "cors/lz4hc.zarr"),
    ("plainlz4", "cors/lz4.zarr/.zarray")]
# name, address, what is said
REFUSED = [
    ("broken", f"{FAR}/broken/holes.zarr", r"/broken/holes\.zarr/0\.1\.0 was answered by 500 "
     r"\(Internal Server Error\); try again"),
    ("closed", f"{FAR}/closed/holes.zarr", r"/closed/holes\.zarr/0\.0\.0 was answered by 403 .*"
     "hides its list"),
    ("nocors", f"{FAR}/plain/holes.zarr", r"plain/holes\.zarr/\S+ got no answer .*CORS"),
    ("spa", f"{FAR}/spa/holes.zarr", r"spa/holes\.zarr/\S+ is a page of HTML .*404 for what is"),
    ("nothing", f"{FAR}/cors/nothing.zarr", r"cors/nothing\.zarr has no zarr\.json, .*address"),
    ("hidden", f"{FAR}/bucket/nothing.zarr", r"bucket/nothing\.zarr/\S+ was answered by 403"),
    ("nofile", f"{FAR}/cors/nothing.nrrd", r"cors/nothing\.nrrd was answered by 404"),
    ("nameless", f"{FAR}/cors/nameless.zarr", r"cors/nameless\.zarr is a group, .*name an array"),
    ("nobody", "http://127.0.0.1:9/a.zarr", r"127\.0\.0\.1:9/a\.zarr/\S+ got no answer"),
    ("page", f"{FAR}/spa/cells.nrrd", r"spa/cells\.nrrd is a page of HTML"),
    ("vast", f"{FAR}/cors/vast.zarr", r"vast\.zarr: has 2048 MiB of voxels, and a page .*coarser"),
    ("ftp", "ftp://example.org/a.zarr", "begins with https:// or http://"),
    ("local", "file:///etc/passwd", "begins with https:// or http://"),
    ("script", "javascript:alert(1)", "begins with https:// or http://"),
    ("empty", " ", "There is no address"),
    ("s3", "s3://bucket/a.zarr", r"https://bucket\.s3\.amazonaws\.com/a\.zarr"),
    ("password", "https://me:secret@example.org/a.zarr", "signed, or public")]


def requests(way, store=""):
    return [each for each in asked if each[0] == way and each[1].startswith(store)]


def of_command(command, name, folder="."):
    """The picture that a command makes."""
    words = shlex.split(command)
    words[words.index("--output") + 1] = os.path.join(OUT, "again.png")
    run = subprocess.run([TOOL, *words[1:], "-y", "-q"], cwd=os.path.join(STORES, folder),
                         capture_output=True, text=True)
    check(f"{name}: the command draws", run.returncode == 0, (words, run.stderr))
    if run.returncode:
        return b""
    with open(os.path.join(OUT, "again.png"), "rb") as file:
        return file.read()


# --- the engine, in Node -----------------------------------------------------------

begin = time.time()
subprocess.run([node, os.path.join(HERE, "engine.cjs"),
                os.path.join(TOP, "wasm", "page", "worker.js"), ENGINE, OUT, json.dumps(
                    [{"name": name, "address": f"{FAR}/{address}",
                      "recipe": {"size": [120, 90], "azimuth": 20}} for name, address in SHOWN] +
                    [{"name": name, "address": address, "recipe": {}}
                     for name, address, _ in REFUSED])], check=True, timeout=500)
print(f"       {time.time() - begin:.1f} s in Node")
told = {}
for name in [each[0] for each in SHOWN + REFUSED]:
    with open(os.path.join(OUT, f"{name}.json")) as file:
        told[name] = json.load(file)
for name, _ in SHOWN:
    if not told[name].get("command"):
        check(f"{name} is shown", False, told[name])
        continue
    png = of_command(told[name]["command"], name, "deep folder" if name == "level" else ".")
    with open(os.path.join(OUT, f"{name}-2.bin"), "rb") as file:
        frame = file.read()
    same = frame[32:] == png
    if png and not same and frame[9] == 4:  # levels
        width, height, rgb = levels(png)
        same = len(frame) - 32 == 4 * width * height and all(
            frame[32 + i::4] == rgb[i] for i in range(3)) and len(set(rgb[0])) > 9
    check(f"{name}: the picture at rest is the command's", same, told[name])
for name, _, says in REFUSED:
    line = told[name]["said"][-1] if told[name]["said"] else ""
    check(f"{name} is refused, and why is said", not told[name]["opened"] and
          re.search(says, line) and len(line) < 500, told[name])
    print("      ", line)

cells = [each[1] for each in requests("cors", "cells.zarr")]
check("no chunk of another level is fetched", cells and not any(
    re.match(r"cells\.zarr/[02]/\d", name) for name in cells), cells)
check("the level is said, and in the command", "level 1 of 3 (1) is shown" in
      "".join(told["lz4"]["said"]) and "--dataset 1" in told["lz4"]["command"], told["lz4"])
check("holes are filled and counted", "1 of 18 chunks are not stored" in
      "".join(told["zstd"]["said"]), told["zstd"])
names = [(each[0], each[1], each[4]) for each in asked if each[0] in ("signed", "bucket", "quiet") or
         each[0] == "cors" and each[1].split("/")[0] in ("cells.zarr", "shard.zarr", "group.zarr")]
check("nothing is fetched twice", len(names) == len(set(names)),
      [each for each in names if names.count(each) > 1])
shards = requests("cors", "shard.zarr/c")
check("of a shard the parts that are needed", shards and all(each[2] == 206 for each in shards) and
      sum(each[3] for each in shards) < 0.8 * SHARD, shards)
check("a query is part of each request", requests("signed") and all(
    each[2] in (200, 206) for each in requests("signed")), requests("signed"))
check("a secret of an address is in no line", "secret" not in str(told) and
      "token" not in "".join(told["signed"]["said"]), told["signed"])

# --- the page, in Chromium -----------------------------------------------------------

if not chromium or not os.path.exists(PLAYWRIGHT):
    end()
    skip("chromium or playwright-core is missing")
asked.clear()
TYPED = ("nocors", "broken", "ftp")
PAGES = [
    {"url": f"file://{PAGE}", "cases": [
        {"name": "slow", "address": f"{FAR}/slow/lz4hc.zarr"},
        {"name": "shard", "address": f"{FAR}/cors/shard.zarr", "time": 5}] + [
        {"name": name, "address": address, "says": says} for name, address, says in REFUSED
        if name in TYPED]},
    {"url": f"{HOST}/page/viewer.html?url=/plain/holes.zarr",
     "cases": [{"name": "own"}, {"name": "moved", "address": f"{HOST}/plain/group.zarr"}]},
    {"url": f"{HOST}/page/viewer.html?url=ftp%3A%2F%2Fx%2Fy", "cases": [{"name": "bad", "says": "begins with https"}]},
    {"url": f"{HOST}/page/made.html?url={FAR}/cors/cells.zarr", "cases": []}]
begin = time.time()
done = subprocess.run([node, os.path.join(HERE, "url.mjs"), PLAYWRIGHT, chromium, OUT,
                       json.dumps(PAGES)], timeout=500)
print(f"       {time.time() - begin:.1f} s in the browser")
check("the pages", done.returncode == 0, done.returncode)
with open(os.path.join(OUT, "results.json")) as file:
    results = json.load(file)
for name in ("slow", "shard", "shard-time", "own", "moved"):
    with open(os.path.join(OUT, f"{name}.txt")) as file:
        png = of_command(file.read(), name)
    with open(os.path.join(OUT, f"{name}-rest.png"), "rb") as file:
        check(f"{name}: the picture at rest is the command's, in the page", file.read() == png)
lines = {name: "\n".join(each["said"]) for name, each in results.items() if "said" in each}
check("progress is shown", "Reading lz4hc.zarr: " in lines["slow"] and " MB" in lines["slow"],
      lines["slow"])
for name in TYPED:
    check(f"{name} is refused, and what was shown stays",
          results[name]["shown"] == "shard.zarr", results[name])
check("another time fetches its parts, none twice", sum(
    each[3] for each in requests("cors", "shard.zarr/c")) < SHARD, requests("cors"))
check("no cookie goes to another origin", not any(
    each[5] for each in asked if each[0] not in ("plain", "page")), asked)
check("the page's address names what is shown",
      results["moved"]["search"] == "?" + urllib.parse.urlencode(
          {"url": f"{HOST}/plain/group.zarr"}), results["moved"])
bad = results["bad"]
check("an address that cannot be opened is refused in one line",
      any("begins with https:// or http://" in line for line in bad["said"]) and
      bad["shown"] == "phantom:engine", bad)

# --- a page of snowglass export ------------------------------------------------------

exported = results["exported"]
check("an exported page reaches no server", not exported["fetched"] and
      not exported["byWorker"] and set(exported["violated"]) == {"connect-src"}, exported)
check("the server heard nothing of it", not any("told" in each[1] for each in asked), asked)
check("it has no field, and takes no address", not exported["field"] and
      exported["shown"] == "volume", exported)
server.shutdown()
end()
