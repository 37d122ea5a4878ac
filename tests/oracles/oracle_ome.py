"""OME-TIFF: the planes that TiffData names, in one file and in many, beside
tifffile where it reads them, else beside the array that was written."""
import os
import shutil

import oracle
from oracle import np

tifffile, = oracle.need("tifffile")
oracle.need_modules()
oracle.usual = oracle.image()
random = np.random.default_rng(3)
ROOT = ('<?xml version="1.0" encoding="UTF-8"?><OME xmlns="http://www.'
        'openmicroscopy.org/Schemas/OME/2016-06"%s>%s</OME>')


def image(shape, planes, order="XYZCT", name="A", samples=1):
    """The XML of an image (t, c, z, y, x)."""
    t, c, z, y, x = shape
    channel = f'<Channel ID="c" SamplesPerPixel="{samples}"/>'
    return (f'<Image ID="Image:{name}" Name="{name}"><Pixels ID="p" Type="uint16" '
            f'DimensionOrder="{order}" SizeX="{x}" SizeY="{y}" SizeZ="{z}" '
            f'SizeC="{c}" SizeT="{t}">{channel * (c // samples)}'
            f'{planes}</Pixels></Image>')


def plane(t, c, z, ifd=None, count=None, file=None, uuid=None):
    """A TiffData; a first index that is None is left to its default."""
    first = "".join(f' First{k}="{v}"' for k, v in zip("TCZ", (t, c, z))
                    if v is not None)
    first += "" if ifd is None else f' IFD="{ifd}"'
    first += "" if count is None else f' PlaneCount="{count}"'
    name = f' FileName="{file}"' if file else ""
    inner = f"<UUID{name}>\n urn:uuid:{uuid} </UUID>" if file else ""
    return f"<TiffData{first}>{inner}</TiffData>"


def put(path, pages, text, photometric="minisblack"):
    if isinstance(text, str):
        text = text.encode()
    tifffile.imwrite(path, pages, photometric=photometric, metadata=None,
                     description=text)


def expect_all(path, a, name, options=()):
    """Each channel and step of an array (t, c, z, y, x)."""
    for t, c in np.ndindex(a.shape[:2]):
        oracle.expect(path, a[t, c], options=[*options, "--time", t,
                                              "--channel", c], name=name)


def in_one_file():
    """Pages in any order, and the defaults of the specification."""
    a = oracle.sample("u2", (2, 2, 4, 5, 3))
    for order in ("XYZCT", "XYCTZ"):
        pages = random.permutation(16)
        text = "".join(plane(t, c, z, pages[(t * 2 + c) * 4 + z])
                       for t, c, z in np.ndindex(2, 2, 4))
        shuffled = np.empty((16, 5, 3), "u2")
        shuffled[pages] = a.reshape(16, 5, 3)
        put("a.ome.tif", shuffled, ROOT % ("", image(a.shape, text, order)))
        expect_all("a.ome.tif", a, f"planes of {order}")
        axes = tifffile.TiffFile("a.ome.tif").series[0].get_axes(False)
        seen = tifffile.imread("a.ome.tif").transpose(
            [axes.index(k) for k in "TCZYX"])
        if not np.array_equal(seen, a):
            oracle.fail(order, "tifffile sees another array")
    b = a[:1, :1]
    for text, pages in ((plane(None, None, None), b[0, 0]),
                        (plane(None, None, None, 0, 4), b[0, 0]),
                        (plane(0, None, 2, 0, 2) + plane(0, 0, None, 2, 2),
                         np.roll(b[0, 0], 2, 0)),
                        ("", b[0, 0])):
        put("b.ome.tif", pages, ROOT % ("", image(b.shape, text)))
        oracle.expect("b.ome.tif", b[0, 0], name=f"defaults {text}")
    # A page of another kind that nothing names.
    with tifffile.TiffWriter("c.ome.tif") as file:
        text = "".join(plane(0, 0, z, z + 1) for z in range(4))
        file.write(np.zeros((9, 9, 3), "u1"), photometric="rgb", metadata=None,
                   description=(ROOT % ("", image(b.shape, text))).encode())
        for page in b[0, 0]:
            file.write(page, photometric="minisblack", metadata=None)
    oracle.expect("c.ome.tif", b[0, 0], name="from page 1")
    colours = oracle.sample("u1", (4, 5, 3, 3))
    text = "".join(plane(0, 0, z, 3 - z) for z in range(4))
    put("d.ome.tif", colours[::-1],
        ROOT % ("", image((1, 3, 4, 5, 3), text, samples=3)), "rgb")
    oracle.expect("d.ome.tif", colours[..., 2], options=["--channel", 2])
    # XML with letters of Latin-1, a prefix, and XML that is none.
    text = ROOT % ("", image(b.shape, plane(0, 0, 0, 0, 4), name="\xb5"))
    put("e.ome.tif", b[0, 0], text.encode("latin-1"))
    oracle.expect("e.ome.tif", b[0, 0], name="Latin-1")
    put("f.ome.tif", b[0, 0], (ROOT % ("", image(b.shape, plane(0, 0, 0))))
        [:-9])
    oracle.says("damaged XML", "f.ome.tif", "OME-XML is not used")


def several_images():
    a, b = (oracle.sample("u2", (1, 1, z, 5, 3), z) for z in (4, 6))
    text = image(a.shape, plane(None, None, None, 0, 4)) + \
        image(b.shape, plane(None, None, None, 4, 6), name="two")
    put("g.ome.tif", np.concatenate([a[0, 0], b[0, 0]]), ROOT % ("", text))
    for option, wanted in ((("--dataset", "0"), a), (("--dataset", "two"), b),
                           (("--series", "1"), b)):
        oracle.expect("g.ome.tif", wanted[0, 0], options=option)
    oracle.says("images", "g.ome.tif", '0 "A", 1 "two"')
    oracle.refuse("g.ome.tif", "no such image", ["--dataset", "2"], 2)


def images_of_files():
    """Each image in a file of its own, and one without pages."""
    a, b = oracle.sample("u2", (2, 1, 1, 3, 4, 5), 4)
    text = image(a.shape, plane(0, 0, 0, 0, 3, "k1.tif", 1)) + \
        image(a.shape, "", name="none") + \
        image(a.shape, plane(0, 0, 0, 0, 3, "k2.tif", 2), name="B")
    oracle.put("k.companion.ome", ROOT % ("", text))
    for i, c in ((1, a), (2, b)):
        put(f"k{i}.tif", c[0, 0], ROOT % (f' UUID="urn:uuid:{i}"', '<BinaryOnly '
            'MetadataFile="k.companion.ome" UUID="urn:uuid:9"/>'))
        oracle.expect(f"k{i}.tif", c[0, 0], name=f"the image in file {i}")
    oracle.says("the other image", "k2.tif", "image 2 is taken")
    oracle.expect("k.companion.ome", a[0, 0])
    oracle.expect("k1.tif", b[0, 0], options=["--dataset", "B"])
    oracle.refuse("k.companion.ome", "none of the pages", ["--dataset", "none"])
    os.rename("k2.tif", "k3.tif")
    oracle.expect("k3.tif", a[0, 0], name="a file that was renamed")


def write_set(a, names, companion=None):
    """A file for each (t, z): where XML is in the first, or in another file."""
    text = "".join(
        plane(t, c, z, c, 1, name, i) for i, (name, (t, z)) in
        enumerate(zip(names, np.ndindex(a.shape[0], a.shape[2])))
        for c in range(a.shape[1]))
    whole = ROOT % (' UUID="urn:uuid:%s"', image(a.shape, text))
    if companion:
        oracle.put(companion, whole % 99)
    for i, (name, (t, z)) in enumerate(
            zip(names, np.ndindex(a.shape[0], a.shape[2]))):
        only = ROOT % (f' UUID="urn:uuid:{i}"', '<BinaryOnly MetadataFile="%s" '
                       'UUID="urn:uuid:99"/>' % (companion or names[0]))
        put(name, a[t, :, z], only if i or companion else whole % 0)


def in_many_files():
    a = oracle.sample("u2", (2, 2, 3, 5, 4))
    names = [f"set_{i}.ome.tif" for i in (3, 0, 5, 1, 2, 4)]
    os.mkdir("set")
    os.chdir("set")
    write_set(a, names)
    for name in (names[0], names[4]):
        expect_all(name, a, f"a set by {name}")
    oracle.expect(".", a[0, 0], name="its folder")
    os.rename(names[2], "other.tif")
    expect_all(names[3], a, "a file that was renamed")
    oracle.says("a renamed file", names[0], "other names")
    put("other.tif", a[0, :, 2], "no UUID")
    os.rename("other.tif", names[2])
    expect_all(names[0], a, "a file without a UUID")
    put(names[2], a[0, :, 2], ROOT % (' UUID="urn:uuid:77"', ""))
    oracle.says("another UUID", names[0], "another UUID")
    os.remove(names[5])
    oracle.expect(names[0], a[0, 1], options=["--channel", 1], name="a step "
                  "that is whole")
    oracle.says("what is missing", names[0], "time step 1, channel 0, slice 2;")
    gap = a[1, 1].astype("f4")
    gap[2] = np.nan
    oracle.expect(names[0], gap, options=["--channel", 1, "--time", 1,
                                          "--allow-gaps"], name="a gap")
    oracle.says("info", names[0], "other verbs need --allow-gaps", "--time", 1)
    done = oracle.tool("convert", names[0], "-o", "a.npy", "--time", 1)
    if done.returncode != 3 or "--allow-gaps" not in done.stderr:
        oracle.fail("convert", done.stderr)
    os.chdir("..")
    shutil.rmtree("set")
    os.mkdir("set")
    os.chdir("set")
    write_set(a, names, "run.companion.ome")
    for name in ("run.companion.ome", names[1]):
        expect_all(name, a, f"a companion by {name}")
    oracle.expect(".", a[0, 0], name="its folder")
    os.remove("run.companion.ome")
    oracle.refuse(names[0], "run.companion.ome")
    os.chdir("..")


def imagej():
    """Stacks of ImageJ with fewer pages than their description says."""
    a = oracle.sample("u2", (5, 4, 3))
    with tifffile.TiffWriter("h.tif") as file:
        for page in a[:4]:
            file.write(page, photometric="minisblack", metadata=None,
                       description="ImageJ=1.53t\nimages=5\nslices=5\n")
    with tifffile.TiffWriter("i.tif") as file:
        file.write(a[0], photometric="minisblack", metadata=None, rowsperstrip=4,
                   description="ImageJ=1.53t\nimages=5\nslices=5\n")
    with tifffile.TiffFile("i.tif") as file:
        end = file.pages[0].dataoffsets[0] + file.pages[0].databytecounts[0]
    oracle.put("i.tif", oracle.got("i.tif")[:end] + a[1:4].tobytes())
    gap = a.astype("f4")
    gap[4] = np.nan
    for path in ("h.tif", "i.tif"):
        oracle.says(path, path, "slice 4")
        oracle.expect(path, gap, options=["--allow-gaps"])
        if oracle.tool("convert", path, "-o", "a.npy").returncode != 3:
            oracle.fail(path, "is taken for whole")


in_one_file()
several_images()
images_of_files()
in_many_files()
imagej()
oracle.finish()
