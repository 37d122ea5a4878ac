"""Pictures beside what Pillow, tifffile and ffmpeg read of them."""
import sys

try:
    import numpy as np
    import tifffile
    from PIL import Image, features
except ImportError:
    sys.exit(77)
import json
import shutil
import subprocess

import oracle

place = oracle.folder()
doctor = json.loads(subprocess.run([oracle.TOOL, "doctor", "--json"],
                                   capture_output=True, check=True).stdout)
outputs = doctor["picture_outputs"]


def render(path, *options, verb="render"):
    subprocess.run([oracle.TOOL, verb, "-q", "phantom:head", "--dims",
                    "48x44x40", "-s", "150x131", "-o", path, *options],
                   check=True)


def same(name, a, b):
    oracle.checked += 1
    if a.shape != b.shape or not (a == b).all():
        oracle.fail(name, f"{a.shape} and {b.shape} differ")


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
    for back in ([], ["--background", "navy"]):
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
    for back in ([], ["--background", "navy"]):
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
oracle.finish()
