"""Pictures beside what Pillow, tifffile and ffmpeg read of them."""
import itertools
import shutil
import struct
import subprocess
import zlib

import oracle
from oracle import np

tifffile, _ = oracle.need("tifffile", "PIL")
from PIL import Image, features

outputs = oracle.doctor("picture_outputs")


def render(path, *options, verb="render"):
    oracle.tool(verb, "-q", "phantom:head", "--dims", "48x44x40", "-s",
                "150x131", "-o", path, *options, check=True)


def same(name, a, b):
    oracle.checked += 1
    if a.shape != b.shape or not (a == b).all():
        oracle.fail(name, f"{a.shape} and {b.shape} differ")


def read_exr(path):
    """Channels of float32 by name, from the format's description: one part of
    scan lines, ZIP blocks of 16 lines, predicted and interleaved bytes."""
    data = oracle.got(path)
    assert struct.unpack_from("<II", data) == (20000630, 2)
    at, header = 8, {}
    while data[at]:
        name, kind = data[at:].split(b"\0", 2)[:2]
        at += len(name) + len(kind) + 2
        size, = struct.unpack_from("<I", data, at)
        header[name.decode()] = data[at + 4:at + 4 + size]
        at += 4 + size
    assert header["compression"] == b"\3" and header["lineOrder"] == b"\0"
    rest, names = header["channels"], []
    while rest[0]:
        name, rest = rest.split(b"\0", 1)
        assert struct.unpack_from("<iIii", rest) == (2, 1, 1, 1)  # float
        names.append(name.decode())
        rest = rest[16:]
    assert names == sorted(names)
    x0, y0, x1, y1 = struct.unpack("<4i", header["dataWindow"])
    width, height = x1 - x0 + 1, y1 - y0 + 1
    planes = np.empty((len(names), height, width), "<f4")
    blocks = struct.unpack_from(f"<{-(-height // 16)}Q", data, at + 1)
    for begin in blocks:
        y, size = struct.unpack_from("<iI", data, begin)
        y -= y0
        lines = min(16, height - y)
        packed = data[begin + 8:begin + 8 + size]
        if size < lines * width * len(names) * 4:
            raw = np.frombuffer(zlib.decompress(packed), "u1").astype(int)
            raw[1:] -= 128
            raw = (np.cumsum(raw) % 256).astype("u1")
            half = (len(raw) + 1) // 2
            packed = np.empty_like(raw)
            packed[0::2], packed[1::2] = raw[:half], raw[half:]
        block = np.frombuffer(packed, "<f4").reshape(lines, len(names), width)
        planes[:, y:y + lines] = block.transpose(1, 0, 2)
    return dict(zip(names, planes))


def rgba(channels):
    return np.stack([channels[n] for n in "RGBA"], -1)


if ".exr" in outputs:
    for options in ([], ["-c", "hot", "--perspective"],
                    ["-m", "iso", "--iso", "120"]):
        render("d.npy", "-y", "--depth", "z.npy", *options)
        floats, depth = np.load("d.npy"), np.load("z.npy")
        if not np.isnan(depth).any() or np.isnan(depth).all():
            oracle.fail("depth", "has no border")
        render("d.exr", "-y", "--depth", "./d.exr", *options)
        got = read_exr("d.exr")
        same(f"Z beside RGBA {options}", rgba(got), floats)
        same(f"Z {options}", np.nan_to_num(got["Z"], nan=-1e9),
             np.nan_to_num(depth, nan=-1e9))
        if sorted(got) != list("ABGRZ"):
            oracle.fail("channels", sorted(got))
        render("d.exr", "-y", "--depth", "z.exr", *options)
        same("no Z unasked", np.array(sorted(read_exr("d.exr"))),
             np.array(list("ABGR")))
        same("depth alone", np.array(sorted(read_exr("z.exr"))),
             np.array(["Y"]))

for look in ([], ["-c", "inferno"], ["--perspective", "-c", "hot"]):
    render("a.npy", "-y", *look)
    floats = np.load("a.npy")
    if ".tif" in outputs:
        render("a.tif", "-y", *look)
        same(f"TIFF {look}", tifffile.imread("a.tif"), floats)
    if ".exr" in outputs and shutil.which("ffmpeg"):
        render("a.exr", "-y", *look)
        raw = subprocess.run(["ffmpeg", "-v", "error", "-i", "a.exr",
                              "-pix_fmt", "gbrapf32le", "-f", "rawvideo", "-"],
                             capture_output=True, check=True).stdout
        planes = np.frombuffer(raw, "<f4").reshape(4, 131, 150)
        same(f"EXR {look}", np.stack([planes[i] for i in (2, 0, 1, 3)], -1),
             floats)
    for back in (["--background", "none"], [], ["--background", "navy"]):
        if ".webp" not in outputs or not features.check("webp"):
            continue
        render("a.png", "-y", *look, *back)
        render("a.webp", "-y", *look, *back)
        mode = "RGB" if back else "RGBA"
        same(f"WebP {look} {back}",
             np.array(Image.open("a.webp").convert(mode)),
             np.array(Image.open("a.png").convert(mode)))

if ".webp" in outputs and features.check("webp_anim"):
    turn = ["--frames", "7", "--fps", "24", "-c", "hot", "--legend"]
    for back in (["--background", "none"], [], ["--background", "navy"]):
        render("t.webp", *turn, *back, "-y", verb="turntable")
        render("t_%d.png", *turn, *back, "-y", verb="turntable")
        movie = Image.open("t.webp")
        if movie.n_frames != 7 or movie.info.get("loop") != 0:
            oracle.fail("animation", f"{movie.n_frames} frames")
        whole = 0
        for n in range(7):
            movie.seek(n)
            movie.load()
            whole += movie.info["duration"]
            a = np.array(movie.convert("RGBA"))
            b = np.array(Image.open(f"t_{n}.png").convert("RGBA"))
            b[b[..., 3] == 0] = 0
            a[a[..., 3] == 0] = 0
            same(f"frame {n} {back}", a, b)
        if whole != 292:  # 7 / 24 s
            oracle.fail("animation", f"{whole} ms")
# A projection without a background: over its lowest colour it is the picture,
# and the lowest value is clear.
ball = np.indices((20, 22, 24)) - np.array([9.5, 10.5, 11.5])[:, None, None, None]
ball = np.maximum(0, 200 - 25 * np.sqrt((ball ** 2).sum(0))).astype("u1")
for mode, (colors, low) in itertools.product(
        ("mip", "minip", "mean", "sum"),
        (("grey", (0, 0, 0)), ("grey_r", (255, 255, 255)), ("viridis", (68, 1, 84)))):
    look = ("-m", mode, "-c", colors, "--azimuth", "30", "--elevation", "20",
            "--no-labels", "-s", "90x80", "-y")
    np.save("ball.npy", 255 - ball if mode == "minip" else ball)
    for name, back in (("clear.png", "none"), ("solid.png", "#%02x%02x%02x" % low)):
        oracle.tool("render", "-q", "ball.npy", "-o", name, "--background",
                    back, *look, check=True)
    clear = Image.open("clear.png").convert("RGBA")
    laid = Image.new("RGBA", clear.size, low)
    laid.alpha_composite(clear)
    solid = np.asarray(Image.open("solid.png").convert("RGB")).astype(int)
    apart = np.abs(np.asarray(laid.convert("RGB")) - solid).max()
    alpha = np.asarray(clear)[..., 3]
    oracle.checked += 1
    if apart > 1 or (alpha[np.abs(solid - low).max(-1) == 0] > 8).any():
        oracle.fail(f"a clear {mode} in {colors}", f"is off by {apart}, or opaque")
    if mode in ("mip", "mean") and not 0.05 < (alpha > 100).mean() < 0.9:
        oracle.fail(f"a clear {mode} in {colors}", "shows no ball, or a box")
oracle.finish()
