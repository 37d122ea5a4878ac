"""Turntables, and movies of slices."""
from __future__ import annotations

import operator
import os
import re
import struct
import tempfile
from typing import Any, Callable, Optional, Sequence

from . import _checks, _first, _snowglass
from ._images import Color
from ._looks import is_ranged
from ._overlays import overlaid
from ._warnings import warn

# As the command line does, in programs/movie/movie_encoder.c: 4:2:0 has even
# sides, so that an odd one gets a black line more, and levels of BT.709.
VIDEO = ["-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2,scale=out_color_matrix=bt709:"
         "out_range=tv:flags=accurate_rnd+full_chroma_int,format=yuv420p"]
TAGS = ["-colorspace", "bt709", "-color_primaries", "bt709", "-color_trc",
        "bt709", "-color_range", "tv"]
ENCODERS = {
    ".mp4": [*VIDEO, "-c:v", "libx264", "-preset", "veryfast", "-crf", "18",
             *TAGS, "-movflags", "+faststart", "-f", "mp4"],
    ".webm": [*VIDEO, "-c:v", "libvpx-vp9", "-crf", "24", "-b:v", "0",
              "-deadline", "realtime", "-cpu-used", "6", "-row-mt", "1", *TAGS,
              "-f", "webm"],
    ".gif": ["-vf", "split[a][b];[a]palettegen=stats_mode=single:"
             "reserve_transparent=0[p];[b][p]paletteuse=new=1:dither=bayer:"
             "bayer_scale=4", "-loop", "0", "-f", "gif"]}

RATE = "a number of frames a second above 0"
CANNOT_WRITE = 4  # of the statuses of the library


def turntable(volume: Any, path: str, look: Any, frames: int, fps: float,
              overwrite: bool, progress: Optional[Callable[[str, float], Any]],
              options: dict[str, Any]) -> None:
    frames, fps = _counts(frames, fps)
    start = float(options.pop("azimuth", 0))
    angles = [start + 360 * n / frames for n in range(frames)]
    mode = options["mode"] = _first.mode(volume, look, options)
    if mode == "sum" and not is_ranged(look):
        raise ValueError("mode sum: all frames of a movie need the same range; "
                         "give Look(range=(low, high))")
    drawn = volume._mixture(look, mode, options) or \
        volume._transfer(look, mode)
    options["overlay"] = overlaid(volume, options.get("overlay"),
                                  options.get("overlay_look"), progress)
    background = options.pop("background", "auto")

    def draw(n: int) -> Any:
        image = volume._picture(drawn, azimuth=angles[n], azimuths=angles,
                                quiet=True, **options)
        image._ranged = True  # the same colours in all frames
        if n == 0:  # the frame that suits all of them
            target, options["zoom"] = image._view
            options["fit"] = "volume"
            if target and options.get("position") is None:
                options["target"] = target
        return image

    write(path, frames, draw, "turntable", fps, overwrite, background, progress)


def write(path: str, frames: int, draw: Callable[[int], Any], what: str,
          fps: float, overwrite: bool, background: Color,
          progress: Optional[Callable[[str, float], Any]]) -> None:
    """So many pictures, to files by a pattern or to a movie."""
    frames, fps = _counts(frames, fps)
    suffix = os.path.splitext(path)[1].lower()
    numbered = re.search(r"%0?\d*d", path)
    if numbered:
        _check_pattern(path)
    _check_absent([path % n for n in range(frames)] if numbered else [path], overwrite)
    save: Any
    if numbered:
        save = _save_by(path, background)
    elif suffix in ENCODERS:
        save = _Encoder(path, suffix, fps, background)
    elif suffix == ".webp":
        save = _WebP(path, fps, background)
    else:
        raise ValueError(f"{path}: name a movie (.webp, {', '.join(ENCODERS)}) or "
                         f"files by a pattern such as turn_%04d.png")
    empty = True
    try:
        for n in range(frames):
            image = draw(n)
            empty = empty and bool(image.stats.get("empty"))
            save(n, image)
            if progress:
                progress(what, (n + 1) / frames)
    except BaseException:
        getattr(save, "abandon", lambda: None)()
        raise
    getattr(save, "finish", lambda: None)()
    if empty:
        warn("all frames are empty: no visible voxel is in view; volume.statistics "
             "has the range of values, opacity= sets which are visible")


def _check_absent(paths: Sequence[str], overwrite: bool) -> None:
    for path in () if overwrite else paths:
        if os.path.lexists(path):
            _snowglass.fail(CANNOT_WRITE, f"{path}: exists; give overwrite=True or "
                                          f"another name")


def _check_folder(path: str) -> None:
    if not os.path.isdir(os.path.dirname(path) or "."):
        _snowglass.fail(CANNOT_WRITE, f"{path}: there is no such folder; make it "
                                      f"first, or correct the name")


def _counts(frames: Any, fps: Any) -> tuple[int, float]:
    try:
        frames = operator.index(frames)
    except TypeError:
        raise _checks.fault("frames", "a whole number from 1", frames) from None
    if frames < 1:
        raise _checks.fault("frames", "a whole number from 1", frames, ValueError)
    rate = _checks.number("fps", fps, RATE)
    if rate <= 0:
        raise _checks.fault("fps", RATE, fps, ValueError)
    return frames, rate


def _check_pattern(path: str) -> None:
    try:
        path % 0
    except (TypeError, ValueError):
        raise ValueError(f"{path}: give a pattern with one number, such as "
                         f"turn_%04d.png, and %% for a percent sign") from None


def _save_by(pattern: str, background: Color) -> Callable[[int, Any], None]:
    def save(n: int, image: Any) -> None:
        image.save(pattern % n, background=background)
    return save


class _WebP:
    """An animated WebP, of the chunks of its frames, as the command line makes it
    (programs/movie/movie_webp.c); it is beside its place until it is whole."""

    def __init__(self, path: str, fps: float, background: Color) -> None:
        _check_folder(path)
        self.path, self.fps, self.background = path, fps, background
        self.partial = f"{path}.{os.getpid()}.part"
        self.file: Any = None

    def __call__(self, n: int, image: Any) -> None:
        if self.file is None:
            self.file = open(self.partial, "wb")
            alpha = 0x10 if image._color(self.background) is None else 0
            self.file.write(b"RIFF\0\0\0\0WEBP" + _chunk(
                b"VP8X", struct.pack("<I", 2 | alpha) + self._size(image)) +
                _chunk(b"ANIM", bytes(6)))
        with tempfile.TemporaryDirectory() as folder:
            frame = os.path.join(folder, "frame.webp")
            image.save(frame, background=self.background)
            with open(frame, "rb") as file:
                parts = file.read()[12:]
        if parts[:4] == b"VP8X":
            parts = parts[8 + int.from_bytes(parts[4:8], "little"):]
        begin, end = (int(each * 1000 / self.fps + 0.5) for each in (n, n + 1))
        head = bytes(6) + self._size(image) + _three(max(1, end - begin)) + b"\2"
        self.file.write(_chunk(b"ANMF", head + parts))

    @staticmethod
    def _size(image: Any) -> bytes:
        return _three(image.width - 1) + _three(image.height - 1)

    def finish(self) -> None:
        size = self.file.tell()
        self.file.seek(4)
        self.file.write(struct.pack("<I", size - 8))
        self.file.close()
        os.replace(self.partial, self.path)

    def abandon(self) -> None:
        if self.file is not None:
            self.file.close()
            os.remove(self.partial)


def _three(number: int) -> bytes:
    return min(number, 0xffffff).to_bytes(3, "little")


def _chunk(name: bytes, data: bytes) -> bytes:
    return name + struct.pack("<I", len(data)) + data


class _Encoder:
    """ffmpeg, which writes beside the place of the movie until it is whole."""

    def __init__(self, path: str, suffix: str, fps: float,
                 background: Color) -> None:
        import shutil
        self.program = shutil.which("ffmpeg")
        if not self.program:
            _snowglass.fail(CANNOT_WRITE, f"{path}: movies need the program ffmpeg; "
                                          f"install it, or write turn_%04d.png")
        _check_folder(path)
        self.path, self.suffix, self.fps = path, suffix, fps
        self.background = background
        root, ext = os.path.splitext(path)
        self.partial = f"{root}.{os.getpid()}.part{ext}"
        self.process: Any = None

    def __call__(self, n: int, image: Any) -> None:
        if self.process is None:
            import subprocess
            self.process = subprocess.Popen(
                [str(self.program), "-v", "error", "-y", "-f", "rawvideo",
                 "-pix_fmt", "rgb24", "-s", f"{image.width}x{image.height}",
                 "-framerate", f"{self.fps:.10g}", "-i", "-", "-an",
                 *ENCODERS[self.suffix], "file:" + self.partial],
                stdin=subprocess.PIPE, stderr=subprocess.PIPE)
        assert self.process.stdin
        try:
            picture, marks = image._drawn()
            self.process.stdin.write(picture._save(
                None, background=image._color(self.background), **marks))
        except BrokenPipeError:
            self.finish()

    def finish(self) -> None:
        if self.process is None:
            return
        _, text = self.process.communicate()
        if self.process.returncode:
            self._remove()
            said = " ".join(text.decode(errors="replace").split())
            _snowglass.fail(CANNOT_WRITE, f"{self.path}: ffmpeg failed: {said}")
        os.replace(self.partial, self.path)

    def abandon(self) -> None:
        if self.process:
            self.process.kill()
            self.process.wait()
        self._remove()

    def _remove(self) -> None:
        if os.path.exists(self.partial):
            os.remove(self.partial)
