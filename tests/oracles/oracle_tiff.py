"""TIFF, PNG and JPEG stacks beside tifffile and Pillow."""
import os
import shutil
import subprocess
import tarfile

import oracle
from oracle import np

tifffile, = oracle.need("tifffile")
oracle.need_modules()

oracle.usual = oracle.image()
TYPES = ["u1", "i1", "u2", "i2", "u4", "i4", "u8", "i8", "f4", "f8", "f2"]
tiffcp = shutil.which("tiffcp")


# GDAL puts a mask and smaller copies behind an image.
a = oracle.sample("u1")
with tifffile.TiffWriter("mask.tif") as file:
    for kind, page in ((0, a[0]), (4, a[0] > 9), (1, a[0, ::2, ::2]),
                       (5, a[0, ::2, ::2] > 9)):
        file.write(page, photometric="minisblack", subfiletype=kind,
                   metadata=None)
oracle.expect("mask.tif", a[:1], name="a mask of an image")

for kind in TYPES:
    a = oracle.sample(kind)
    for order in "<>":
        for big in oracle.few((False, True), 2,
                              TYPES.index(kind) + "<>".index(order)):
            tifffile.imwrite("a.tif", a, byteorder=order, bigtiff=big,
                             photometric="minisblack")
            oracle.expect("a.tif", oracle.wide(a), name=f"{kind} {order} {big}")
    tifffile.imwrite("a.tif", a, photometric="minisblack", rowsperstrip=2)
    oracle.expect("a.tif", oracle.wide(a), name=f"{kind} strips")
    if kind != "f2":
        tifffile.imwrite("a.tif", a, photometric="minisblack", tile=(16, 16))
        oracle.expect("a.tif", oracle.wide(a), name=f"{kind} tiles")

a = oracle.sample("u2", (9, 50, 70))
tifffile.imwrite("a.tif", a, photometric="minisblack", rowsperstrip=7)
oracle.expect(oracle.packed("a.tif", "b.tif.gz"), a)
for options in (["-c", "lzw"], ["-c", "lzw:2"], ["-c", "zip:2"],
                ["-c", "packbits"], ["-t", "-w", "32", "-l", "16"],
                ["-t", "-w", "32", "-l", "16", "-c", "zip"], ["-B"],
                ["-f", "lsb2msb"], ["-8"]):
    if tiffcp:
        subprocess.run([tiffcp, *options, "a.tif", "c.tif"], check=True)
        oracle.expect("c.tif", a, name=" ".join(options))

# Bits, colours beside one another and in planes.
bits = oracle.sample("?", (5, 13, 21))
tifffile.imwrite("d.tif", bits, photometric="minisblack")
oracle.expect("d.tif", bits.astype("u1"), name="bits")
rgb = oracle.sample("u1", (6, 12, 20, 3))
for planar in ("contig", "separate"):
    b = rgb if planar == "contig" else np.moveaxis(rgb, 3, 1)
    tifffile.imwrite("e.tif", b, photometric="rgb", planarconfig=planar)
    for channel in range(3):
        oracle.expect("e.tif", rgb[..., channel],
                      options=["--channel", channel], name=planar)
oracle.refuse("e.tif", "channel 3 does not exist", ["--channel", 3], 2)

# ImageJ: (t, z, c, y, x), a unit and a spacing.
h = oracle.sample("u2", (2, 4, 3, 6, 5))
for contiguous in (None, True):
    tifffile.imwrite("f.tif", h, imagej=True, resolution=(4, 2),
                     metadata={"spacing": 1.5, "unit": "um",
                               "axes": "TZCYX"}, contiguous=contiguous)
    for t in range(2):
        for c in range(3):
            oracle.expect("f.tif", h[t, :, c],
                          oracle.image((0.25, 0.5, 1.5)),
                          ["--time", t, "--channel", c], unit="um")
# Pixels per inch or cm, where they are not those of screens and printers.
flat = oracle.sample("u2", (4, 6, 5))
for unit, x, y, spacing in (("CENTIMETER", 1000, 500, (0.01, 0.02, 0.01)),
                            ("INCH", 2540, 2540, (0.01, 0.01, 0.01)),
                            ("INCH", 254, 254, (0.1, 0.1, 0.1)),
                            ("INCH", 300, 300, None),
                            ("INCH", 72, 72, None),
                            ("CENTIMETER", 118.11, 118.11, None),
                            ("CENTIMETER", 28.35, 28.35, None),
                            ("INCH", 1, 1, None),
                            ("CENTIMETER", 1, 1, (10, 10, 10)),
                            ("CENTIMETER", 0.9, 0.9, None),
                            ("INCH", 1e-7, 1e-7, None),
                            ("CENTIMETER", 2e7, 2e7, None),
                            ("INCH", 1000, 72, None),
                            ("INCH", 72, 1000, None),
                            ("NONE", 1000, 1000, None)):
    tifffile.imwrite("f.tif", flat, photometric="minisblack", metadata=None,
                     resolution=(x, y), resolutionunit=unit)
    oracle.expect("f.tif", flat, spacing and oracle.image(spacing),
                  unit="mm" if spacing else "", name=f"{x} per {unit}")
# Slices that were called times or channels.
many = oracle.sample("u2", (9, 6, 5))
for axes in ("TYX", "CYX", "ZYX"):
    tifffile.imwrite("m.tif", many, imagej=True, metadata={"axes": axes})
    oracle.expect("m.tif", many, name=f"ImageJ {axes}")
# One page and the others behind it, as ImageJ writes more than 4 GB.
with tifffile.TiffWriter("g.tif", imagej=True) as writer:
    writer.write(h[0, :, 0], contiguous=True, metadata={"axes": "ZYX"})
whole = oracle.got("g.tif")
with tifffile.TiffFile("g.tif") as file:
    second = file.pages[0].offset
order = ">" if whole[:2] == b"MM" else "<"
entries = int(np.frombuffer(whole, order + "u2", 1, second)[0])
oracle.patch("g.tif", second + 2 + 12 * entries, bytes(4))  # the next page
oracle.expect("g.tif", h[0, :, 0], name="ImageJ, one page")

# The shape of tifffile: with names of axes and without, one page or all.
five = oracle.sample("u2", (2, 3, 4, 6, 5))
for truncate in (False, True):
    for axes in ("TCZYX", "CTZYX", "ZTCYX", "QCZYX"):
        tifffile.imwrite("s.tif", five, photometric="minisblack",
                         truncate=truncate, metadata={"axes": axes})
        order = ["TCZ".find(k) for k in axes[:3].replace("Q", "T")]
        seen = tifffile.imread("s.tif").transpose(
            [order.index(k) for k in range(3)] + [3, 4])
        for t in range(seen.shape[0]):
            oracle.expect("s.tif", seen[t, 1], name=f"{axes} {truncate}",
                          options=["--time", t, "--channel", 1])
    for a in (five[:, 0], five[0], five):
        tifffile.imwrite("s.tif", a, photometric="minisblack",
                         truncate=truncate)
        steps = tifffile.imread("s.tif").reshape(-1, 4, 6, 5)
        oracle.expect("s.tif", steps[1], options=["--time", 1],
                      name=f"{a.shape} {truncate}")
        oracle.says(a.shape, "s.tif", f"{len(steps)} time steps of 4 slices")
many = oracle.sample("u1", (2, 4, 6, 5, 3))
tifffile.imwrite("s.tif", many, photometric="rgb")
oracle.expect("s.tif", many[1, ..., 2],
              options=["--time", 1, "--channel", 2], name="colours")
tifffile.imwrite("s.tif", many[0, ..., 0], photometric="minisblack",
                 description="shape=(4, 6, 5)", metadata=None)
oracle.expect("s.tif", many[0, ..., 0], name="shape=")
tifffile.imwrite("s.tif", many, photometric="minisblack",
                 metadata={"axes": "TZYXC"})
oracle.refuse("s.tif", "no slices")
with tifffile.TiffWriter("s.tif") as writer:
    writer.write(five[0, 0], photometric="minisblack")
    writer.write(five[0, 1], photometric="minisblack")
oracle.expect("s.tif", tifffile.imread("s.tif", series=0), name="two arrays")
oracle.says("two arrays", "s.tif", "4 pages beyond")



def pages_of(path, values, bits, **tags):
    """Pages whose samples are packed from the high bit on, by hand: tifffile
    leaves packed samples to another package."""
    out = bytearray(b"II*\0\0\0\0\0")
    link = 4
    for page in values:
        strip = b""
        for row in page.reshape(len(page), -1):
            shifts = np.arange(bits)[::-1]
            strip += np.packbits(row.astype("i8")[:, None] >> shifts & 1).tobytes()
        strip += bytes(len(strip) % 2)
        out[link:link + 4] = len(out + strip).to_bytes(4, "little")
        y, x = page.shape[:2]
        samples = page.shape[2] if page.ndim > 2 else 1
        entries = {256: x, 257: y, 258: bits, 259: 1, 262: 1, 273: len(out),
                   277: samples, 278: y, 279: len(strip), 339: 1}
        for tag, value in tags.items():
            entries[int(tag[1:])] = value
        out += strip + len(entries).to_bytes(2, "little")
        for tag, value in entries.items():
            kind = 3 if tag in (258, 259, 262, 277, 339) else 4
            if tag == 258 and samples > 1:  # a place that has them
                value = 8
            out += b"".join(v.to_bytes(n, "little") for v, n in (
                (tag, 2), (kind, 2), (1, 4), (value, 4)))
        link = len(out)
        out += bytes(4)
    oracle.put(path, bytes(out))


# Samples of other sizes than bytes; 0 that is white; signs.
for depth in (1, 2, 3, 4, 6, 10, 12, 14, 20, 31):
    kind = np.dtype("u1" if depth < 8 else "u2" if depth < 16 else "u4")
    a = (oracle.sample(kind, (3, 5, 7)) >> (8 * kind.itemsize - depth))
    pages_of("v.tif", a, depth)
    oracle.expect("v.tif", a, name=f"{depth} bits")
    pages_of("v.tif", a, depth, t262=0)
    oracle.expect("v.tif", (2 ** depth - 1 - a).astype(kind),
                  name=f"{depth} bits, 0 white")
    if depth == 12:
        twos = a.astype("i4") - 4096 * (a > 2047)
        pages_of("v.tif", a, depth, t339=2)
        oracle.expect("v.tif", twos.astype("i2"), name="12 bits, signed")
for kind in ("u1", "u2", "u4", "i1", "i2", "f4"):
    a = oracle.sample(kind)
    top = {"u": 2 ** (8 * a.itemsize) - 1, "i": -1}.get(kind[0])
    tifffile.imwrite("v.tif", a, photometric="miniswhite", metadata=None)
    oracle.expect("v.tif", a if top is None else (top - a.astype("i8"))
                  .astype(kind), name=f"{kind}, 0 white")
    oracle.says(kind, "v.tif", "0 is white")
a = oracle.sample("u2")
text = "ImageJ=1.53t\nimages=7\nslices=7\n"
tifffile.imwrite("v.tif", a, photometric="miniswhite", metadata=None,
                 description=text)
oracle.expect("v.tif", a, name="ImageJ, 0 white")

# ImageJ's calibration of values (ij.measure.Calibration).
for line, values in (("cf=0\nc0=-32768.0\nc1=1.0\nvunit=Gray Value\n",
                      a - 32768.0),
                     ("cf=0\nc0=-1024\nc1=0.5\nvunit=HU\n", a * .5 - 1024),
                     ("cf=20\nc0=1\nc1=2\n", a), ("c0=1\nc1=2\n", a),
                     ("cf=1\nc0=1\nc1=2\nc2=1\n", a)):
    tifffile.imwrite("v.tif", a, photometric="minisblack", metadata=None,
                     description=text + line)
    oracle.expect("v.tif", values, name=line, dtype="u2")
    oracle.says(line, "v.tif", "no straight" if "cf=1\n" in line else None)

# GDAL's missing values, also one that the type does not have.
for kind, missing in (("u1", "255"), ("i2", "-9999"), ("u2", "-9999"),
                      ("f4", "-3.4028234e+38"), ("f4", "nan")):
    a = oracle.sample(kind)
    wanted = a
    if (kind, missing) not in (("u2", "-9999"), ("f4", "nan")):
        a[:, :2] = float(missing)
        wanted = np.where(a == a[0, 0, 0], np.nan, a).astype("f4")
    tifffile.imwrite("v.tif", a, photometric="minisblack", metadata=None,
                     extratags=[(42113, 2, 0, missing, True)])
    oracle.expect("v.tif", wanted, name=f"nodata {missing} of {kind}")

# OME: every order of channels, slices and times.
for axes in ("TZCYX", "TCZYX", "CTZYX", "ZTCYX", "CZTYX", "ZCTYX"):
    turned = np.transpose(h, ["TZC".index(a) for a in axes[:3]] + [3, 4])
    tifffile.imwrite("h.ome.tif", turned, photometric="minisblack",
                     metadata={"axes": axes, "PhysicalSizeX": 0.5,
                               "PhysicalSizeY": 0.5, "PhysicalSizeZ": 2000,
                               "PhysicalSizeZUnit": "nm"})
    for t in range(2):
        for c in oracle.few(range(3), 2, t):
            oracle.expect("h.ome.tif", h[t, :, c],
                          oracle.image((0.5, 0.5, 2)),
                          ["--time", t, "--channel", c], unit="um",
                          name=f"OME {axes} {t} {c}")

# Lengths in several units: of OME, and of ImageJ (unit, yunit, zunit).
for y, z in (("mm", "nm"), ("\u00b5m", "\u212b")):
    ny, nz = {"mm": 1e-3, "nm": 1e3, "\u00b5m": 1, "\u212b": 1e4}[y], \
        {"nm": 1e3, "\u212b": 1e4}[z]
    tifffile.imwrite("u.ome.tif", h[0, :, 0], photometric="minisblack",
                     metadata={"axes": "ZYX", "PhysicalSizeX": 0.5,
                               "PhysicalSizeY": 0.5 * ny, "PhysicalSizeYUnit": y,
                               "PhysicalSizeZ": 2 * nz, "PhysicalSizeZUnit": z})
    oracle.expect("u.ome.tif", h[0, :, 0], oracle.image((0.5, 0.5, 2)), unit="um",
                  name=f"OME in um, {y}, {z}")
tifffile.imwrite("u.tif", h[0, :, 0], imagej=True, resolution=(2, 2),
                 metadata={"axes": "ZYX", "spacing": 2000, "unit": "micron",
                           "zunit": "nm"})
oracle.expect("u.tif", h[0, :, 0], oracle.image((0.5, 0.5, 2)), unit="um",
              name="ImageJ in um and nm")

# Folders and patterns.
os.mkdir("stack")
a = oracle.sample("u2", (12, 8, 9))
for z, page in enumerate(a):
    tifffile.imwrite(f"stack/s{z + 5}.tif", page, photometric="minisblack")
oracle.put("stack/notes.txt", "not a slice")
oracle.expect("stack", a)
oracle.expect("stack/", a, name="with a slash")
oracle.expect("stack/s*.tif", a, name="pattern")
oracle.expect("stack/s%d.tif", a, name="number")
oracle.expect("stack/s?.tif", a[:5], name="one letter")
os.rename("stack/s8.tif", "s8.tif")
oracle.refuse("stack", "missing")
os.rename("s8.tif", "stack/s8.tif")
tifffile.imwrite("stack/s17.tif", a[0, 1:], photometric="minisblack")
oracle.refuse("stack", "must be alike")
os.remove("stack/s17.tif")
tifffile.imwrite("i.tif", a, photometric="minisblack")
shutil.copy("i.tif", "stack/s17.tif")
oracle.refuse("stack", "must be alike")
oracle.refuse("none*.tif", "no file matches")
os.mkdir("empty")
oracle.refuse("empty", "no slices")

# Which names are slices: those that differ in a number.
for names, more, said in (
        ("s_%03d.tif", ("MAX_stack.tif",), "left out: MAX_stack.tif"),
        ("s_%03d.tif", ("mask.tif", "s_flat.tif"), "left out: mask.tif, s_fl"),
        ("s_%d_512x512.tif", (), None), ("s_%d_c0.tif", (), None),
        ("2020-01-02_%d.tif", (), None),
        ("s_%03d.tif", ("view_1.tif",), 3), ("s_%03d.tif", ("s_9_old.tif",), 3),
        ("s_%03d.tif", ("s_002 (1).tif",), 3),
        ("s_%d.tif", [f"t_{z}.tif" for z in range(5, 10)], 3),
        ("z_%d_c0.tif", ("z_0_c1.tif",), 3), ("z_%d_c0.tif", ("z_7_c0.tif",), 3)):
    oracle.empty_folder("names")
    for z in range(5):
        tifffile.imwrite("names/" + names % z, a[z], photometric="minisblack")
    for name in more:
        tifffile.imwrite(f"names/{name}", a[9], photometric="minisblack")
    if said == 3:
        oracle.refuse("names", more[0])
        continue
    oracle.expect("names", a[:5], name=f"{names} beside {more}")
    oracle.says(names, "names", said)

# Pages that are to be turned stay, as in tifffile.
tifffile.imwrite("turned.tif", a[0], photometric="minisblack",
                 extratags=[(274, "H", 1, 6, True)])
oracle.expect("turned.tif", a[:1], name="a page to be turned")
oracle.says("a page to be turned", "turned.tif", "(Orientation 6)")

# Pages that differ, files that are cut.
with tifffile.TiffWriter("j.tif") as writer:
    writer.write(a[0])
    writer.write(a[0, 1:])
oracle.refuse("j.tif", "must be alike")
oracle.refuse_cut("i.tif", (9, 100, os.path.getsize("i.tif") // 2),
                  "truncated")



def pages(folder, values, name="{}.png", **how):
    """A picture for each slice, as Pillow writes it."""
    oracle.empty_folder(folder)
    for z, page in enumerate(values):
        Image.fromarray(page).save(f"{folder}/{name.format(z)}", **how)


def compare_png():
    pages("png", a, "p_{:03}.png")
    oracle.expect("png", a, name="PNG of 16 bits")
    colours = oracle.sample("u1", (4, 12, 20, 4))
    pages("rgba", colours)
    for channel in range(4):
        oracle.expect("rgba", colours[..., channel],
                      options=["--channel", channel])
    pages("bits", bits)
    oracle.expect("bits", bits.astype("u1"))
    Image.fromarray(colours[0, ..., 0]).quantize(16).save("p.png")
    oracle.expect("p.png", np.array(Image.open("p.png"))[None], name="palette")
    shutil.copy("png/p_003.png", "stack/s20.png")
    os.remove("stack/s17.tif")
    oracle.refuse("stack", "one kind")


def compare_jpeg():
    """Grey and colours, sampled alike or not, of sizes that no block divides:
    what Pillow reads of what it wrote."""
    y, x = np.mgrid[:53, :75]
    grey = [(100 + 60 * np.sin(x / 9 + z) + y).astype("u1") for z in range(5)]
    colours = [np.stack([page, page[::-1], 255 - page], -1) for page in grey]
    for values, how in (
            (grey, {}), (grey, {"progressive": True}), (colours, {}),
            (colours, {"subsampling": 0}), (colours, {"subsampling": 1}),
            (colours, {"progressive": True, "quality": 60})):
        pages("jpeg", values, "p_{}.jpg", **how)
        read = np.stack([np.asarray(Image.open(f"jpeg/p_{z}.jpg"))
                         for z in range(5)])
        if values is grey:
            oracle.expect("jpeg", read, name=f"JPEG {how}")
            continue
        for channel in range(3):
            oracle.expect("jpeg/p_%d.jpg", read[..., channel],
                          options=["--channel", channel],
                          name=f"JPEG {how} channel {channel}")
    shutil.copy("stack/s20.png", "jpeg/p_9.png")
    oracle.expect("jpeg", a[3:4], name="previews beside PNG")


try:
    from PIL import Image
    compare_png()
    if oracle.library("libjpeg"):
        compare_jpeg()
except ImportError:
    print("no Pillow: PNG and JPEG are not compared")

for relative, step, unit in (
        ("formats/tiff/mini-t1-head.tif", (1e6 / 666666,) * 2 + (1.5,), "mm"),
        ("microscopy/Bead_Image1_crop.tif", (1e6 / 44460534,) * 2 + (0.125,),
         "um")):
    path = oracle.data(relative)
    if path:
        oracle.expect(path, tifffile.imread(path), oracle.image(step),
                      unit=unit)
for relative in ("microscopy/hemisphere_l_211tif.tar.gz",
                 "classic/cthead-8bit_99tif.tar.gz"):
    path = oracle.data(relative)
    if path:
        with tarfile.open(path) as archive:
            archive.extractall("real")
        name = os.listdir("real")[0]
        names = sorted(os.listdir(f"real/{name}"))
        voxels = np.stack([tifffile.imread(f"real/{name}/{n}")
                           for n in names])
        with tifffile.TiffFile(f"real/{name}/{names[0]}") as file:
            tags = file.pages[0].tags
            step = [1, 1, 1]
            for i, tag in enumerate(("XResolution", "YResolution")):
                if file.is_imagej and tag in tags:
                    step[i] = tags[tag].value[1] / tags[tag].value[0]
            step[2] = step[0]  # nothing tells the distance of the files
        oracle.expect(f"real/{name}", voxels, oracle.image(step))
        shutil.rmtree("real")
oracle.finish()
