"""Zarr beside zarr and numcodecs; version 3, which Debian's zarr does not
write, is put together here from numcodecs' coders."""
import itertools
import json
import os
import shutil
import struct

import oracle
from oracle import np

numcodecs, zarr = oracle.need("numcodecs", "zarr")
from numcodecs import (LZ4, Blosc, BZ2, Delta, FixedScaleOffset, GZip,
                       Shuffle, Zlib, Zstd)
oracle.need_modules()

if not all(oracle.library(name) for name in ("blosc", "zstd", "lz4")):
    oracle.skip("this build lacks blosc, zstd or lz4")
TYPES = ["i1", "u1", "<i2", ">i2", "<u2", ">u2", "<i4", ">u4", "<i8", ">u8",
         "<f2", ">f2", "<f4", ">f4", "<f8", ">f8", "?"]
SIZE = (7, 8, 9)  # of chunks, of which 13 x 14 x 15 has two along each axis


def save(path, a, **way):
    shutil.rmtree(path, ignore_errors=True)
    kept = zarr.open(path, "w", shape=a.shape, dtype=a.dtype, **way)
    kept[...] = a
    return kept


def attributes(path, values):
    oracle.put(os.path.join(path, ".zattrs"), json.dumps(values))


# Files are nested, or not, though the metadata say the other or nothing.
nested = oracle.sample("<u2", (13, 14, 15))
for separator, told in itertools.product("./", "./"):
    save("n.zarr", nested, chunks=(7, 8, 9), dimension_separator=separator)
    meta = json.loads(oracle.got("n.zarr/.zarray"))
    meta["dimension_separator"] = told
    if told == ".":
        del meta["dimension_separator"]
    oracle.put("n.zarr/.zarray", json.dumps(meta))
    oracle.expect("n.zarr", nested, name=f"{separator} told as {told}")
    oracle.says("nested", "n.zarr", "between their numbers"
                if separator != told else None)

# Types, each in both byte orders.
for kind in TYPES:
    a = oracle.sample(kind)
    save("a.zarr", a, chunks=(3, 4, 5))
    oracle.expect("a.zarr", oracle.wide(a), name=f"type {kind}")

# Packers, orders, separators, chunks that go beyond the edge and a crop of
# them (oracle.expect takes one of each).
a = oracle.sample("<u2", (13, 14, 15))
smooth = np.add.outer(np.add.outer(np.arange(13), np.arange(14) * 3),
                      np.arange(15) * 7).astype("<u2")
packers = [None, Zlib(1), GZip(5), Zstd(3), LZ4()] + [
    Blosc(name, 5, shuffle) for name, shuffle in itertools.product(
        numcodecs.blosc.list_compressors(),
        (Blosc.NOSHUFFLE, Blosc.SHUFFLE, Blosc.BITSHUFFLE))]
for i, packer in enumerate(packers):
    for b in oracle.few((a, smooth), 2, i % 3):
        save("b.zarr", b, chunks=SIZE, compressor=packer,
             order="CF"[i % 2], dimension_separator="./"[i // 2 % 2])
        oracle.expect("b.zarr", b, name=f"{packer}")
for order, separator in itertools.product("CF", "./"):
    for chunks in oracle.few(((13, 14, 15), (1, 14, 15), (6, 5, 4),
                              (20, 1, 30)), 3, "CF".index(order)):
        save("b.zarr", a, chunks=chunks, order=order,
             dimension_separator=separator)
        oracle.expect("b.zarr", a, name=f"{order} {separator} {chunks}")

# Filters.
for kind in ("i1", "<i2", ">u4", "<i8"):
    d = oracle.sample(kind, (13, 14, 15))
    for way in ([Delta(kind)], [Shuffle(np.dtype(kind).itemsize)],
                [Delta(kind), Shuffle(2)]):
        save("c.zarr", d, chunks=SIZE, filters=way, compressor=Zstd())
        oracle.expect("c.zarr", oracle.wide(d), name=f"filters {way}")
save("c.zarr", a.astype("f8"), filters=[FixedScaleOffset(0, 1, "f8", "i2")])
oracle.refuse("c.zarr", "fixedscaleoffset")
save("c.zarr", a.astype("f4"), filters=[Delta("f4")])
oracle.refuse("c.zarr", "delta")
save("c.zarr", a, compressor=BZ2())
oracle.refuse("c.zarr", "bz2")

# Chunks that were never written.
fills = [("<i2", -7), ("<u8", 2**64 - 1), ("<i8", -2**63), ("<f4", np.nan),
         (">f8", np.inf), ("<f4", -np.inf), ("?", True), ("<f2", 1.5),
         ("<f8", None), ("u1", 255), ("<f8", 0.1)]
for kind, fill in fills:
    shutil.rmtree("d.zarr", ignore_errors=True)
    part = zarr.open("d.zarr", "w", shape=(9, 10, 11), dtype=kind,
                     chunks=(4, 4, 4), fill_value=fill)
    part[3:6, 3:4, 7:] = 1
    values = part[()]
    if fill is None: # any values at all: ours are 0
        values = np.zeros((9, 10, 11), kind)
        for name in os.listdir("d.zarr"):
            if not name.startswith("."):
                k, j, i = (4 * int(n) for n in name.split("."))
                box = np.s_[k:k + 4, j:j + 4, i:i + 4]
                values[box] = part[box]
    oracle.expect("d.zarr", oracle.wide(values), name=f"fill {kind} {fill}")

# Axes: one to five, and more of size 1.
t = oracle.sample("u2", (3, 2, 5, 6, 7))
save("e.zarr", t, chunks=(1, 1, 3, 4, 5))
for time, channel in itertools.product(range(3), range(2)):
    oracle.expect("e.zarr", t[time, channel],
                  options=["--time", time, "--channel", channel])
oracle.refuse("e.zarr", "channel", ["--channel", 2], 2)
oracle.refuse("e.zarr", "time step", ["--time", 3], 2)
save("f.zarr", t[:, 0], chunks=(2, 3, 4, 5))
oracle.expect("f.zarr", t[2, 0], options=["--time", 2])
save("f.zarr", t[0, 0, 0])
oracle.expect("f.zarr", t[0, 0, :1])
save("f.zarr", t[0, 0, 0, 0])
oracle.expect("f.zarr", t[:1, 0, 0, :1])
save("f.zarr", t[None, None])
oracle.expect("f.zarr", t[1, 1], options=["--time", 1, "--channel", 1],
              name="seven axes")
save("f.zarr", np.stack([t, t]))
oracle.refuse("f.zarr", "no option selects")
attributes("e.zarr", {"_ARRAY_DIMENSIONS": ["x", "time", "c", "y", "z"]})
oracle.expect("e.zarr", t[:, 1, 4].transpose(2, 1, 0),
              options=["--time", 1, "--channel", 4], name="names of axes")

# Groups: the only volume is taken, several are listed.
def begin(path):
    shutil.rmtree(path, ignore_errors=True)
    return zarr.open_group(path, "w")


group = begin("g.zarr")
group.create_dataset("deep/in/it", data=a)
group.create_dataset("line", data=np.arange(10))
oracle.expect("g.zarr", a, name="only array")
oracle.expect("g.zarr:/deep/in/it", a, name="path in a group")
oracle.expect("g.zarr/deep", a, name="a group in a group")
oracle.expect("g.zarr/deep/in/it/.zarray", a, name="its description")
group.create_dataset("b", data=t[0, 0])
oracle.refuse("g.zarr", "b (5, 6, 7), deep/in/it (13, 14, 15)", status=2)
oracle.expect("g.zarr", t[0, 0], options=["--dataset", "b"])
oracle.refuse("g.zarr", "has no array", ["--dataset", "none"], 2)
oracle.refuse("g.zarr", "not a path within", ["--dataset", "b/../b"], 2)
oracle.refuse("g.zarr", "--dims", ["--dims", "1x1x1"], 2)
oracle.refuse("g.zarr", "--series", ["--series", "1"], 2)
begin("h.zarr")
oracle.refuse("h.zarr", "contains none")
os.remove("g.zarr/.zgroup")
oracle.expect("g.zarr", t[0, 0], options=["--dataset", "b"],
              name="a group that nothing describes")


# Images of OME-Zarr: axes, levels, transformations, units.
def image(path, axes, levels, **more):
    group = begin(path)
    sets = []
    for i, (values, steps) in enumerate(levels):
        group.create_dataset(f"s{i}", data=values, chunks=(4,) * values.ndim)
        sets.append({"path": f"s{i}", "coordinateTransformations": steps})
    group.attrs["multiscales"] = [{"version": "0.4", "axes": axes,
                                   "datasets": sets, **more}]


def scale(*values):
    return {"type": "scale", "scale": values}


def shift(*values):
    return {"type": "translation", "translation": values}


AXES = [{"name": "t", "type": "time", "unit": "second"},
        {"name": "c", "type": "channel"}] + [
            {"name": name, "type": "space", "unit": unit}
            for name, unit in zip("zyx", ("nanometer", "micrometer",
                                          "micrometer"))]
half = t[..., ::2, ::2]
image("i.zarr", AXES, [
    (t, [scale(1, 1, 500, 0.25, 0.25)]),
    (half, [scale(1, 1, 500, 0.5, 0.5), shift(0, 0, 0, 0.125, 0.125)])],
      coordinateTransformations=[scale(5, 1, 2, 1, 1)])
fine = oracle.image((0.25, 0.25, 1))
coarse = oracle.image((0.5, 0.5, 1), (0.125, 0.125, 0))
oracle.expect("i.zarr", t[1, 1], fine, ["--time", 1, "--channel", 1],
              unit="um")
for name in ("s1", "1", "/s1"):
    oracle.expect("i.zarr", half[0, 0], coarse, ["--dataset", name], unit="um")
oracle.expect("i.zarr:/s1", half[0, 0], coarse, unit="um")
oracle.expect("i.zarr/s1", half[0, 0], coarse, unit="um")
oracle.expect("i.zarr/s1/", half[0, 0], coarse, unit="um")
os.chdir("i.zarr/s1")
oracle.expect(".", half[0, 0], coarse, unit="um", name="the folder itself")
os.chdir("..")
oracle.expect("s1", half[0, 0], coarse, unit="um", name="from its group")
os.chdir("..")
os.makedirs("gone")
shutil.move("i.zarr/s0", "gone")
oracle.expect("i.zarr", half[0, 0], coarse, unit="um", name="a finer is gone")
oracle.refuse("i.zarr", "level 0 (s0) is missing", ["--dataset", "0"], 2)
oracle.refuse("i.zarr", "s1 (3, 2, 5, 3, 4)", ["--dataset", "s0"], 2)
shutil.move("i.zarr/s1", "gone")
oracle.refuse("i.zarr", "none of the 2 levels")

# Axes in another order, and with names of their own.
image("j.zarr", [{"name": n, "type": "space"} for n in "xyz"],
      [(a, [scale(1, 2, 3), shift(4, 5, 6), scale(2, 2, 2)])])
oracle.expect("j.zarr", a.T, oracle.image((2, 4, 6), (8, 10, 12)), unit="")
image("j.zarr", [{"name": n, "type": "space"} for n in ("down", "in", "out")],
      [(a, [scale(1, 2, 3)])])
oracle.expect("j.zarr", a, oracle.image((3, 2, 1)))
image("j.zarr", [{"name": "y", "type": "space"}, {"name": "x"}],
      [(a[0], [scale(0.5, 0.25)])])
oracle.expect("j.zarr", a[:1], oracle.image((0.25, 0.5, 0.25)))

# Older versions: no transformations, axes as texts or none.
for axes in (list("tczyx"), None):
    image("k.zarr", axes, [(t, []), (half, [])])
    if axes is None:
        attrs = json.loads(oracle.got("k.zarr/.zattrs"))
        del attrs["multiscales"][0]["axes"]
        attributes("k.zarr", attrs)
    oracle.expect("k.zarr", t[2, 1], oracle.image(),
                  ["--time", 2, "--channel", 1])
    oracle.expect("k.zarr", half[0, 0],
                  oracle.image((7 / 4, 2, 1), (3 / 8, 0.5, 0)),
                  options=["--dataset", "1"])

# Images in a group, as converters put them, and labels below an image.
group = begin("l.zarr")
image("l.zarr/0", AXES[2:], [(a, [scale(1, 2, 3)])])
group.create_group("OME")
oracle.expect("l.zarr", a, oracle.image((3, 2, 0.001)), unit="um",
              name="converted image")
image("l.zarr/0/labels/cells", AXES[2:], [(a, [scale(4, 4, 4)])])
oracle.expect("l.zarr", a, oracle.image((4, 4, 0.004)), name="labels",
              options=["--dataset", "0/labels/cells"])
image("l.zarr/1", AXES[2:], [(a, [scale(1, 1, 1)])])
oracle.refuse("l.zarr", "0, 1", status=2)

# What is wrong with an image.
for wrong, part in ((scale(1, 2), "not 3 numbers"),
                    (scale(1, 0, 2), "other than 0"),
                    (shift(1, "a", 2), "translation")):
    image("m.zarr", AXES[2:], [(a, [wrong])])
    oracle.refuse("m.zarr", part)
image("m.zarr", AXES, [(a, [])])
oracle.refuse("m.zarr", "has 3 axes, but its image 5")
attributes("m.zarr", {"multiscales": [{"datasets": [{"path": "../g.zarr/b"}]}]})
oracle.refuse("m.zarr", "invalid path")


# --- version 3 ---------------------------------------------------------------

def crc32c(data):
    total = 0xFFFFFFFF
    for byte in data:
        total ^= byte
        for _ in range(8):
            total = total >> 1 ^ (0x82F63B78 if total & 1 else 0)
    return struct.pack("<I", total ^ 0xFFFFFFFF)


CODECS = {"gzip": GZip(3).encode, "zstd": Zstd(3).encode,
          "blosc": Blosc("zstd", 5, Blosc.BITSHUFFLE).encode,
          "crc32c": lambda data: bytes(data) + crc32c(data)}


def encode(chunk, codecs):
    """The bytes of a chunk, after the codecs that need only its bytes."""
    endian = "<"
    for codec in codecs:
        told = codec.get("configuration", {})
        if codec["name"] == "transpose":
            chunk = chunk.transpose(told["order"])
        elif codec["name"] == "bytes":
            endian = "><"[told.get("endian", "little") == "little"]
            chunk = np.ascontiguousarray(
                chunk, chunk.dtype.newbyteorder(endian)).tobytes()
        else:
            chunk = bytes(CODECS[codec["name"]](chunk))
    return chunk


def pieces(a, size, fill=0):
    """Chunks by their numbers, those at the edge filled up."""
    counts = [-(-n // s) for n, s in zip(a.shape, size)]
    for at in itertools.product(*map(range, counts)):
        box = tuple(slice(k * s, (k + 1) * s) for k, s in zip(at, size))
        whole = np.full(size, fill, a.dtype)
        part = a[box]
        whole[tuple(map(slice, part.shape))] = part
        yield at, whole


def shard(values, size, codecs, start, summed, leave):
    """The bytes of a shard: chunks, and an index of them."""
    index, body = [], b""
    count = len(list(pieces(values, size)))
    length = 16 * count + 4 * summed
    for i, (_, chunk) in enumerate(pieces(values, size)):
        data = encode(chunk, codecs)
        at = (2**64 - 1, 2**64 - 1) if i in leave else \
            (len(body) + start * length, len(data))
        body += b"" if i in leave else data
        index += [struct.pack("<QQ", *at)]
    index = b"".join(index)
    index += crc32c(index) if summed else b""
    return index + body if start else body + index


def save3(path, a, size, steps, keys=None, inner=None, start=False,
          summed=True, leave=(), **more):
    oracle.empty_folder(path)
    keys = keys or {"name": "default"}
    wide_name = {"b1": "bool"}.get(a.dtype.str[1:], a.dtype.name)
    told = steps
    if inner:
        told = [{"name": "sharding_indexed", "configuration": {
            "chunk_shape": inner, "codecs": steps,
            "index_location": "start" if start else "end",
            "index_codecs": [{"name": "bytes", "configuration":
                              {"endian": "little"}}] +
            [{"name": "crc32c"}] * summed}}]
    meta = {"zarr_format": 3, "node_type": "array", "shape": a.shape,
            "data_type": wide_name, "fill_value": 0, "codecs": told,
            "chunk_grid": {"name": "regular",
                           "configuration": {"chunk_shape": size}},
            "chunk_key_encoding": keys, "attributes": {}, **more}
    oracle.put(f"{path}/zarr.json", json.dumps(meta))
    usual = "/" if keys["name"] == "default" else "."
    separator = keys.get("configuration", {}).get("separator", usual)
    for at, chunk in pieces(a, size):
        front = ["c"] if keys["name"] == "default" else []
        name = f"{path}/" + separator.join(front + [str(k) for k in at])
        os.makedirs(os.path.dirname(name), exist_ok=True)
        oracle.put(name, shard(chunk, inner, steps, start, summed, leave)
                       if inner else encode(chunk, steps))


def codecs(*names, endian="little", order=None):
    return ([{"name": "transpose", "configuration": {"order": order}}]
            if order else []) + \
        [{"name": "bytes", "configuration": {"endian": endian}}] + \
        [{"name": name, "configuration": {}} for name in names]


for kind in TYPES:
    b = oracle.sample(kind).astype(np.dtype(kind).newbyteorder("="))
    for endian in oracle.few(("little", "big"), 2, TYPES.index(kind)):
        save3("n.zarr", b, (3, 4, 5), codecs(endian=endian))
        oracle.expect("n.zarr", oracle.wide(b), name=f"3 {kind} {endian}")
for names in ([], ["gzip"], ["zstd"], ["blosc"], ["crc32c"],
              ["zstd", "crc32c"], ["crc32c", "gzip", "crc32c"]):
    save3("n.zarr", a, SIZE, codecs(*names))
    oracle.expect("n.zarr", a, name=f"3 {names}")
for order in itertools.permutations(range(3)):
    save3("n.zarr", a, SIZE, codecs("zstd", order=order))
    oracle.expect("n.zarr", a, name=f"3 transposed {order}")
for name, separator in itertools.product(("default", "v2"), "./"):
    save3("n.zarr", a, SIZE, codecs(), {
        "name": name, "configuration": {"separator": separator}})
    oracle.expect("n.zarr", a, name=f"3 keys {name} {separator}")
    save3("n.zarr", a, SIZE, codecs(), {"name": name})
    oracle.expect("n.zarr", a, name=f"3 keys {name}")
for start, summed, names in itertools.product(
        (False, True), (False, True), ([], ["zstd", "crc32c"], ["blosc"])):
    save3("n.zarr", a, (6, 4, 8), codecs(*names), inner=(3, 2, 4), start=start,
          summed=summed)
    oracle.expect("n.zarr", a, name=f"3 shards {start} {summed} {names}")
save3("n.zarr", a, (26, 28, 30), codecs("gzip", order=(1, 2, 0)),
      inner=(2, 7, 5), leave=(0, 1, 5), fill_value=9)
left = a.copy()
for i, (at, _) in enumerate(pieces(np.zeros((26, 28, 30)), (2, 7, 5))):
    if i in (0, 1, 5):
        left[tuple(slice(k * s, k * s + s)
                   for k, s in zip(at, (2, 7, 5)))] = 9
oracle.expect("n.zarr", left, name="3 shards with chunks left out")
save3("n.zarr", a, SIZE, codecs(), dimension_names=["x", "y", "z"])
oracle.expect("n.zarr", a.T, name="3 names of axes")
for kind, fill, value in (("f4", "0x7f800000", np.inf), ("f4", "NaN", np.nan),
                          ("f8", "0x3ff8000000000000", 1.5),
                          ("f2", "0x3e00", 1.5), ("u8", 2**64 - 1, 2**64 - 1)):
    b = np.full((4, 5, 6), value, kind)
    b[..., 3:] = 1
    save3("n.zarr", b, (4, 5, 3), codecs(), fill_value=fill)
    os.remove("n.zarr/c/0/0/0")
    oracle.expect("n.zarr", oracle.wide(b), name=f"3 fill {fill}")
shutil.rmtree("o.zarr", ignore_errors=True)
for i, b in enumerate((a, a[:, ::2, ::2])):
    save3(f"o.zarr/{i}", np.ascontiguousarray(b), (4, 4, 4), codecs("zstd"))
sets = [{"path": str(i),
         "coordinateTransformations": [scale(1000, i + 1, i + 1)]}
        for i in range(2)]
oracle.put("o.zarr/zarr.json", json.dumps({
    "zarr_format": 3, "node_type": "group", "attributes": {"ome": {
        "version": "0.5",
        "multiscales": [{"axes": AXES[2:], "datasets": sets}]}}}))
oracle.expect("o.zarr", a, oracle.image((1, 1, 1)), unit="um")
oracle.expect("o.zarr/1", a[:, ::2, ::2], oracle.image((2, 2, 1)))

# Refused.
save3("p.zarr", a, SIZE, codecs("gzip", "zstd"))
oracle.refuse("p.zarr", "compressed twice")
for changed, part in (({"data_type": "complex64"}, "complex64"),
                      ({"data_type": "r24"}, "r24"),
                      ({"chunk_grid": {"name": "rectangular"}}, "regular chunk grid"),
                      ({"shape": []}, "0 axes"), ({"shape": [0, 1, 2]}, "empty"),
                      ({"shape": [1e15, 1e15, 1e15]}, "too large for any array"),
                      ({"node_type": "tree"}, "node_type"),
                      ({"fill_value": 1e9}, "fill_value"),
                      ({"codecs": []}, "no codec"),
                      ({"chunk_key_encoding": "mine"}, "mine")):
    save3("p.zarr", a, SIZE, codecs(), **changed)
    oracle.refuse("p.zarr", part)
save("p.zarr", a, chunks=SIZE, compressor=None)
meta = json.loads(oracle.got("p.zarr/.zarray"))
for changed, part in (({"dtype": "<c8"}, "<c8"), ({"dtype": "<U4"}, "<U4"),
                      ({"dtype": [["a", "<i4"]]}, "several in one"),
                      ({"order": "A"}, "order"), ({"chunks": [1, 2]}, "chunk"),
                      ({"chunks": [0, 1, 1]}, "chunk"),
                      ({"shape": [2**40] * 3}, "too large for any array"),
                      ({"shape": [4000] * 3, "chunks": [1, 1, 1]}, "chunks"),
                      ({"shape": [4000] * 3, "chunks": [100] * 3},
                       "most of it is missing"),
                      ({"compressor": {"id": "lzma"}}, "lzma"),
                      ({"dimension_separator": "-"}, "separator"),
                      ({"zarr_format": 1}, "version 1")):
    oracle.put("p.zarr/.zarray", json.dumps({**meta, **changed}))
    oracle.refuse("p.zarr", part)
for text in ("", "[1]", "{" * 9, '{"a":' * 5000):
    oracle.put("p.zarr/.zarray", text)
    oracle.refuse("p.zarr", "not valid JSON")

# Chunks that are cut, too long, of another size, or another array's.
for i, packer in enumerate(packers):
    save("q.zarr", smooth, chunks=(13, 14, 15), compressor=packer)
    whole = oracle.got("q.zarr/0.0.0")
    for size in oracle.few((0, 1, 3, 12, 20, len(whole) // 2,
                            len(whole) - 1), 4, i):
        oracle.put("q.zarr/0.0.0", whole[:size])
        oracle.refuse("q.zarr", "0.0.0: ")
    save("q.zarr", smooth[:7], chunks=(7, 14, 15), compressor=packer)
    shutil.copy("q.zarr/0.0.0", "other")
    save("q.zarr", smooth, chunks=(13, 14, 15), compressor=packer)
    shutil.copy("other", "q.zarr/0.0.0")
    oracle.refuse("q.zarr", "0.0.0: ")
save3("q.zarr", a, (13, 14, 15), codecs("crc32c"))
oracle.patch("q.zarr/c/0/0/0", 100, b"no")
oracle.refuse("q.zarr", "checksum")
save3("q.zarr", a, (14, 14, 16), codecs(), inner=(7, 7, 8))
oracle.patch("q.zarr/c/0/0/0", -30, b"no")
oracle.refuse("q.zarr", "index of its shard")
save3("q.zarr", a, (14, 14, 16), codecs(), inner=(7, 7, 8), summed=False)
oracle.patch("q.zarr/c/0/0/0", -30, b"no")
oracle.refuse("q.zarr", "its index names bytes")
save("q.zarr", a, chunks=(13, 14, 15))
os.remove("q.zarr/0.0.0")
os.symlink("0.0.0", "q.zarr/0.0.0")
oracle.refuse("q.zarr", "cannot be opened")
os.remove("q.zarr/0.0.0")
os.mkdir("q.zarr/0.0.0")
oracle.refuse("q.zarr", "not a regular file")
os.rmdir("q.zarr/0.0.0")
os.mkfifo("q.zarr/0.0.0")
oracle.refuse("q.zarr", "not a regular file")

# ERA5 as xarray writes it: several variables, packed, in time steps and levels,
# chunked along either, their metadata also in one file.
LEVELS = np.array([1000, 850, 500, 200])
COORDINATES = {
    "time": (np.arange(4) * 6, {"units": "hours since 2020-01-01"}),
    "level": (LEVELS, {"units": "millibars", "long_name": "pressure_level"}),
    "latitude": (np.linspace(50, -50, 11), {"units": "degrees_north"}),
    "longitude": (np.arange(20) * 18.0, {"units": "degrees_east"})}
winds = {}
for chunks, whole in (((1, 4, 11, 20), True), ((4, 1, 6, 7), False)):
    group = zarr.open_group("era.zarr", "w")
    for name, (at, says) in COORDINATES.items():
        group.create_dataset(name, data=at).attrs.update(
            says, _ARRAY_DIMENSIONS=[name])
    for seed, name in enumerate("uv"):
        winds[name] = a = oracle.sample("<i2", (4, 4, 11, 20), seed)
        a[:, :, 0, :3] = -32767
        group.create_dataset(name, data=a, chunks=chunks,
                             fill_value=-32767).attrs.update(
            _ARRAY_DIMENSIONS=[*COORDINATES], scale_factor=0.001, add_offset=5.0,
            units="m s**-1")
    if whole:
        zarr.consolidate_metadata("era.zarr")
    oracle.refuse("era.zarr", "holds 2 volumes; choose one", status=2)
    for name, time in itertools.product("uv", (0, 3)):
        options = ["--dataset", name, "--time", time]
        found, place = oracle.voxels_of("era.zarr", options)
        stored = winds[name][time].astype("f8")
        wanted = np.where(stored == -32767, np.nan, stored * 0.001 + 5)
        heights = -(place[2, 2] * np.arange(len(found)) + place[2, 3])
        at = [np.abs(heights - level).argmin() for level in LEVELS]
        if not np.allclose(found[at], wanted, rtol=0, atol=1e-12, equal_nan=True):
            oracle.fail("era.zarr", f"{chunks} {options}: other values")
        oracle.tells("era.zarr", options, time_value=6.0 * time, times=4,
                     axis_units=["degrees", "degrees", "millibars"])
# What says where others lie does not hide the field.
group = zarr.open_group("nemo.zarr", "w")
for name, axes, says in (("tos", "yx", {"coordinates": "nav_lat nav_lon"}),
                         ("nav_lon", "yx", {"bounds": "bounds_lon"}),
                         ("bounds_lon", "yxn", {})):
    group.create_dataset(name, data=oracle.sample("f4", [{"y": 7, "x": 8, "n": 4}[n]
                                                         for n in axes])).attrs.update(
        _ARRAY_DIMENSIONS=[*axes], **says)
oracle.expect("nemo.zarr", oracle.sample("f4", (7, 8))[None])
found, _ = oracle.voxels_of("era.zarr", ["--component", "u,v", "--time", 3])
speed = np.hypot(*(np.where(part[3] == -32767, np.nan, part[3] * 0.001 + 5)
                   for part in (winds["u"].astype("f8"), winds["v"])))
at = [np.abs(heights - level).argmin() for level in LEVELS]
# Lengths of lines of the file, where each stands at a node of its own.
if not np.allclose(found[at], speed, rtol=1e-6, equal_nan=True):
    oracle.fail("era.zarr", "other speeds")

# Real ones.
for name in ("mni152.ome.zarr", "mni152_axial.ome.zarr"):
    path = oracle.data(f"formats/zarr/{name}")
    if not path:
        continue
    levels = json.loads(oracle.got(f"{path}/.zattrs"))[
        "multiscales"][0]["datasets"]
    there = [level for level in levels
             if os.path.exists(f"{path}/{level['path']}/.zarray")]
    for i, level in enumerate(there):
        steps = level["coordinateTransformations"]
        matrix = oracle.image(steps[0]["scale"], steps[1]["translation"])
        values = zarr.open(f"{path}/{level['path']}", "r")[()].T
        ways = [(path, ["--dataset", level["path"]]),
                (f"{path}/{level['path']}", ())] + [(path, ())] * (i == 0)
        for called, options in oracle.few(ways, 2, i):
            oracle.expect(called, values, matrix, options)
oracle.finish()
