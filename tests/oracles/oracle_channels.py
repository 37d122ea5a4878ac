"""Channels of OME-TIFF, ImageJ, OME-Zarr and NIfTI: what info says of them, and
slices and projections beside NumPy's own sums of light."""
import gzip
import re

import oracle
from oracle import np

tifffile, zarr, _ = oracle.need("tifffile", "zarr", "PIL")
from PIL import Image
oracle.need_modules()

random = np.random.default_rng(7)
SHAPE = (3, 9, 14, 11)  # c, z, y, x
CZYX = random.integers(0, 4000, SHAPE).astype(np.uint16)
CZYX[0, :, :4, :5] = 4095  # so that a flipped picture is another
LEVEL = 0.51 / 255
COLORS = [(0, 0, 1), (0, 1, 0), (1, 128 / 255, 0)]
WINDOWS = [(100, 3000), (0, 2000), (500, 4095)]


def light(values, windows, colors):
    """Values [c, ...] to the sum of their light, cut to white."""
    total = np.zeros(values.shape[1:] + (3,))
    for value, (low, high), color in zip(values, windows, colors):
        share = np.clip((value.astype(float) - low) / (high - low), 0, 1)
        total += share[..., None] * np.array(color)
    return np.minimum(total, 1)


def draw(verb, path, *options):
    """A picture in colours, on black."""
    oracle.checked += 1
    done = oracle.tool(verb, path, "-o", "out.png", "-y", "-q", "--no-labels",
                       "--background", "#000", *options)
    if done.returncode:
        oracle.fail(f"{verb} {path} {options}", done.stderr.strip())
        return np.zeros((1, 1, 3))
    return np.asarray(Image.open("out.png")) / 255


def expect_info(path, names, colors, windows, shown):
    says = oracle.told(path).get("channels", [])
    same = [c["name"] for c in says] == names
    same &= [c["shown"] for c in says] == shown
    for own, color, window in zip(says, colors, windows):
        same &= (own["color"] is None) == (color is None)
        same &= (own["window"] is None) == (window is None)
        if color is not None and own["color"] is not None:
            same &= np.allclose(own["color"], color, atol=1e-9)
        if window is not None and own["window"] is not None:
            same &= np.allclose(own["window"], window)
    if not same:
        oracle.fail(path, f"says {says}")


def expect_light(got, should, name, bound):
    if got.shape != should.shape or np.abs(got - should).max() > bound:
        oracle.fail(name, "differs by %g" % (
            np.abs(got - should).max() if got.shape == should.shape else -1))


def expect_pictures(path, windows, colors, name, listed):
    """A slice as Fiji's composite; a projection as that of its stacks."""
    spec = ",".join(f"{c}:#%02x%02x%02x:{w[0]}..{w[1]}" %
                    tuple(round(255 * v) for v in rgb)
                    for c, (w, rgb) in enumerate(zip(windows, colors)))
    for options in ((), ("--channel", spec)) if listed else ((),):
        got = draw("slice", path, "--axis", "z", "--at", "4", *options)
        pale = colors if options else [  # nobody asked for a blue that is dark
            (77 / 255, 77 / 255, 1) if tuple(c) == (0, 0, 1) else c for c in colors]
        expect_light(got, light(CZYX[:, 4], windows, pale), f"{name} slice", LEVEL)
        got = draw("render", path, "-m", "mip", "--size", "44x36", *options)
        one_by_one = spec if options else spec.replace("#0000ff", "#4d4dff")
        parts = [draw("render", path, "-m", "mip", "--size", "44x36",
                      "--channel", one) for one in one_by_one.split(",")]
        expect_light(got, np.minimum(sum(parts), 1), f"{name} projection",
                     3 * LEVEL)
        if not (got.max((0, 1)) > 0.3).all():
            oracle.fail(f"{name} projection", "shows next to nothing")


rgba = [int(255 * r) << 24 | round(255 * g) << 16 | round(255 * b) << 8 | 255
        for r, g, b in COLORS]
signed = [v - (1 << 32) if v >= 1 << 31 else v for v in rgba]
for order in "<>":
    tifffile.imwrite("o.ome.tif", CZYX, byteorder=order, metadata={
        "axes": "CZYX", "Channel": {"Name": ["DAPI", "GFP", "far red"],
                                    "Color": signed}})
    expect_info("o.ome.tif", ["DAPI", "GFP", "far red"], COLORS, [None] * 3,
                [True] * 3)
    tables = [(np.arange(256)[None] * np.array(c)[:, None]).round()
              .astype(np.uint8) for c in COLORS]
    tifffile.imwrite("ij.tif", CZYX.transpose(1, 0, 2, 3), imagej=True,
                     byteorder=">", metadata={
                         "axes": "ZCYX", "mode": "composite", "LUTs": tables,
                         "Ranges": tuple(float(v) for w in WINDOWS for v in w)})
    expect_info("ij.tif", [""] * 3, COLORS, WINDOWS, [True] * 3)
    expect_pictures("ij.tif", WINDOWS, COLORS, "ImageJ", True)
tifffile.imwrite("plain.tif", CZYX.transpose(1, 0, 2, 3), imagej=True)
expect_info("plain.tif", [""] * 3, [None] * 3, [None] * 3, [True] * 3)

group = zarr.open_group("o.ome.zarr", "w")
group.create_dataset("0", data=CZYX, chunks=(1, 4, 7, 11))
group.attrs["multiscales"] = [{
    "version": "0.4", "axes": [{"name": "c", "type": "channel"}] +
    [{"name": n, "type": "space"} for n in "zyx"],
    "datasets": [{"path": "0", "coordinateTransformations":
                  [{"type": "scale", "scale": [1, 1, 1, 1]}]}]}]


def omero(active=(True, True, True)):
    group.attrs["omero"] = {"channels": [
        {"label": n, "active": a,
         "color": "%02X%02X%02X" % tuple(round(255 * v) for v in c),
         "window": {"start": w[0], "end": w[1], "min": 0, "max": 65535}}
        for n, a, c, w in zip("abc", active, COLORS, WINDOWS)]}


omero()
expect_info("o.ome.zarr", ["a", "b", "c"], COLORS, WINDOWS, [True] * 3)
expect_pictures("o.ome.zarr", WINDOWS, COLORS, "omero", True)
omero((False, True, False))
expect_info("o.ome.zarr", ["a", "b", "c"], COLORS, WINDOWS,
            [False, True, False])
got = draw("slice", "o.ome.zarr", "--axis", "z", "--at", "4")
expect_light(got, light(CZYX[1:2, 4], WINDOWS[1:2], COLORS[1:2]),
             "one active", LEVEL)

# Colours of voxels stay what they are.
RGB = random.integers(0, 256, SHAPE[1:] + (3,)).astype(np.uint8)
tifffile.imwrite("rgb.tif", RGB, photometric="rgb")
PURE = [(1, 0, 0), (0, 1, 0), (0, 0, 1)]
expect_info("rgb.tif", ["red", "green", "blue"], PURE, [(0, 255)] * 3,
            [True] * 3)
expect_light(draw("slice", "rgb.tif", "--axis", "z", "--at", "4"),
             RGB[4] / 255, "TIFF in colour", LEVEL)
oracle.put("rgb.nii", oracle.nifti(RGB.transpose(2, 1, 0, 3), np.eye(4), 128))
oracle.patch("rgb.nii", 254, bytes(2))  # of no patient
got = draw("slice", "rgb.nii", "--axis", "z", "--at", "4")
expect_light(got[::-1], RGB[4] / 255, "NIfTI in colour", LEVEL)
for kind, packed in (("RGB-color", False), ("vector", True)):
    data = RGB.tobytes()
    file = oracle.nrrd("uint8", (3, 11, 14, 9),
                       f"kinds: {kind} domain domain domain\n",
                       gzip.compress(data) if packed else data)
    oracle.put("rgb.nrrd", file.replace(b"raw", b"gzip", 1) if packed else file)
    expect_info("rgb.nrrd", ["red", "green", "blue"], PURE, [(0, 255)] * 3,
                [True] * 3)
    got = draw("slice", "rgb.nrrd", "--axis", "z", "--at", "4")
    expect_light(got[::-1], RGB[4] / 255, f"NRRD in colour, {kind}", LEVEL)

np.save("rgb.npy", RGB)
vtk = "<VTKFile type='ImageData' version='1.0' byte_order='LittleEndian'><ImageData " \
    "WholeExtent='0 10 0 13 0 8' Origin='0 0 0' Spacing='1 1 1'><Piece Extent='0 10 " \
    "0 13 0 8'><PointData><DataArray type='UInt8' Name='v' NumberOfComponents='3' " \
    "format='ascii'>%s</DataArray></PointData></Piece></ImageData></VTKFile>"
oracle.put("rgb.vti", (vtk % " ".join(map(str, RGB.ravel()))).encode())
for name in ("rgb.npy", "rgb.vti"):
    expect_info(name, ["red", "green", "blue"], PURE, [(0, 255)] * 3, [True] * 3)
    got = draw("slice", name, "--axis", "z", "--at", "4")
    expect_light(got[::-1], RGB[4] / 255, f"bytes in threes, {name}", LEVEL)

# Directions of vectors: red |x|, green |y|, blue |z|, over the longest of the slice.
ARROWS = random.normal(0, 1, SHAPE[1:] + (3,)).astype(np.float32)
ARROWS /= np.maximum(1, np.linalg.norm(ARROWS, axis=-1))[..., None]
flat = ARROWS.tobytes()
oracle.put("arrows.nrrd", oracle.nrrd("float", (3, 11, 14, 9),
                                      "kinds: vector domain domain domain\n", flat))
parts = oracle.nifti(ARROWS.transpose(2, 1, 0, 3)[..., 0].copy(), np.eye(4), 16)[:352]
for name, intent, dims in (("v1.nii", 1007, (4, 11, 14, 9, 3, 1)),
                           ("warp.nii", 1006, (5, 11, 14, 9, 1, 3)),
                           ("fnirt.nii", 2006, (4, 11, 14, 9, 3, 1))):
    oracle.put(name, parts + ARROWS.transpose(3, 0, 1, 2).tobytes())
    oracle.patch(name, 40, np.array(dims, "<i2").tobytes())
    oracle.patch(name, 68, np.array(intent, "<i2").tobytes())
    oracle.patch(name, 254, bytes(2))  # of no patient
oracle.put("arrows.vtk", (
    "# vtk DataFile Version 3.0\nv\nBINARY\nDATASET STRUCTURED_POINTS\nDIMENSIONS 11 14 "
    "9\nORIGIN 0 0 0\nSPACING 1 1 1\nPOINT_DATA 1386\nVECTORS v float\n").encode() +
    ARROWS.astype(">f4").tobytes())
oracle.put("arrows.vti", (vtk.replace("UInt8", "Float32").replace(
    "<PointData>", "<PointData Vectors='v'>") % " ".join(
        map(repr, ARROWS.ravel().tolist()))).encode())
longest = np.linalg.norm(ARROWS[4], axis=-1).max()
for name in ("arrows.nrrd", "v1.nii", "warp.nii", "fnirt.nii", "arrows.vtk",
             "arrows.vti"):
    got = draw("slice", name, "--axis", "z", "--at", "4")[::-1]
    expect_light(got, np.minimum(np.abs(ARROWS[4]) / longest, 1),
                 f"directions, {name}", LEVEL)
    got = draw("slice", name, "--axis", "z", "--at", "4", "-c", "grey")[::-1]
    length = np.linalg.norm(ARROWS[4], axis=-1)
    expect_light(got, (length - length.min()) / (longest - length.min()),
                 f"lengths, {name}", LEVEL)

# On a white ground what is bright is clear, and what is dark is not: 20 voxels of
# opacity 0.6 over 1 / (1 - least / white) voxels (docs/looks.md).  A dark ground and a
# red one stay as they are.
PATCHES = {"purple": (150, 40, 90), "black": (0, 0, 0), "pale": (200, 210, 220)}
WHITE = 245 / 255 - 0.02


def field(ground):
    out = np.full((20, 32, 32, 3), ground, np.uint8)
    for n, color in enumerate(PATCHES.values()):
        out[:, 8:24, 3 + 9 * n:11 + 9 * n] = color
    return out


def expect_field(name, options):
    white, black = (draw("render", name, *options, "--size", "96", "--fit",
                         "volume", "--view", "+z", "--background", background)
                    for background in ("white", "black"))
    alpha = 1 - (white - black).mean(-1)
    straight = black / np.maximum(alpha, 1e-3)[..., None]
    for what, color in PATCHES.items():
        should = 1 - 0.4 ** (20 * (1 - min(color) / 255 / WHITE))
        there = (np.abs(straight - np.array(color) / 255).max(-1) < 0.02) & (
            alpha > 0.5)
        if there.sum() < 200 or abs(np.median(alpha[there]) - should) > 0.02:
            oracle.fail(f"{name} {options} {what}", "%d pixels of %s, not %g" % (
                there.sum(), np.median(alpha[there]), should))
    if (alpha < 0.01).mean() < 0.5:
        oracle.fail(f"{name} {options}", "the ground is seen")


for name, ground in (("bright", 245), ("dark", 10), ("red", (250, 0, 0))):
    tifffile.imwrite(f"{name}.tif", field(ground), photometric="rgb")
    said = oracle.tool("render", f"{name}.tif", "-o", "out.png", "-y").stderr
    ground = np.asarray(Image.open("out.png"))[0, 0].max()
    if (name == "bright") != ("white ground clear" in said) or \
            (name == "bright") != (ground == 255):
        oracle.fail(name, f"{ground}, {said}")
for options in ((), ("--method", "raycast"), ("--quality", "high"),
                ("--channel", "2,0,1")):
    expect_field("bright.tif", options)

# --- emitted light: maximum projections above the noise, added ------------------


def signal(values):
    """The range of a channel: mode and spread of its background, by NumPy."""
    v = values.ravel().astype(float)
    low, high = np.percentile(v, [0.1, 99.9])
    counts, edges = np.histogram(v, 256, (low, high))
    at = np.convolve(counts, np.ones(5), "same").argmax()
    mode = (edges[at] + edges[at + 1]) / 2
    spread = 1.4826 * np.median(mode - v[v <= mode])
    low = mode + 3 * spread if mode - low <= (high - low) / 4 else \
        np.percentile(v, 1)
    return low, np.percentile(v[v > low], 99.9)


def expect_projection(path, data, colors, name):
    """One pixel a voxel along z; the ranges are those that the tool prints."""
    oracle.checked += 1
    _, nz, ny, nx = data.shape
    zoom = np.sqrt(nx * nx + ny * ny + nz * nz) / min(nx, ny)
    done = oracle.tool("render", path, "-o", "out.png", "-y", "--no-labels", "-s",
                       f"{nx}x{ny}", "--fit", "volume", "--zoom", zoom)
    said = re.findall(r" (-?[\d.]+)\.\.([\d.]+)", done.stderr)
    windows = [tuple(map(float, each)) for each in said]
    if "mode mip" not in done.stderr or len(windows) != len(data):
        oracle.fail(name, done.stderr)
        return
    for window, each in zip(windows, data):
        if not np.allclose(window, signal(each), rtol=0.01, atol=1):
            oracle.fail(name, f"{window} is not {signal(each)}")
    got = np.asarray(Image.open("out.png").convert("RGB")) / 255
    expect_light(got, light(data.max(1), windows, colors), name, 1 / 255)


PALE = (0x4d / 255, 0x4d / 255, 1)
noise = random.normal(100, 10, (3, 12, 40, 50))
noise[0, 3:6, 20:24, 10:20] += 2500
noise[1, :, :30, :40] += np.linspace(0, 900, 40)
noise[2] = random.normal(900, 200, noise[2].shape)  # dense: the mode is the signal
noise = np.clip(noise, 0, 65535).astype(np.uint16)
AXES = {"axes": "CZYX", "PhysicalSizeX": 1, "PhysicalSizeY": 1, "PhysicalSizeZ": 1}
tifffile.imwrite("light.ome.tif", noise, metadata=AXES)
expect_projection("light.ome.tif", noise, [(1, 0, 0), (0, 1, 0), PALE], "light")
for words in ({"ContrastMethod": ["Fluorescence", "Fluorescence", "DIC"]},
              {"IlluminationType": ["Epifluorescence", "Epifluorescence",
                                    "Transmitted"]}):
    tifffile.imwrite("through.ome.tif", noise, metadata={**AXES, "Channel": words})
    expect_projection("through.ome.tif", noise[:2], [(1, 0, 1), (0, 1, 0)],
                      f"light beside {words}")

oracle.finish()
