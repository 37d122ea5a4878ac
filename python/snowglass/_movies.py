"""Turntables."""
from __future__ import annotations

import os
import re
from typing import Any, Callable, Optional

from ._images import Color, color_of

ENCODERS = {".mp4": ["-c:v", "libx264", "-pix_fmt", "yuv420p", "-crf", "18"],
            ".webm": ["-c:v", "libvpx-vp9", "-pix_fmt", "yuv420p", "-crf", "24",
                      "-b:v", "0"],
            ".gif": ["-filter_complex",
                     "split[a][b];[a]palettegen[p];[b][p]paletteuse"]}


def turntable(volume: Any, path: str, look: Any, frames: int, fps: float,
              progress: Optional[Callable[[str, float], Any]],
              options: dict[str, Any]) -> None:
    if frames < 1:
        raise ValueError(f"{frames} frames: give at least 1")
    start = float(options.pop("azimuth", 0))
    angles = [start + 360 * n / frames for n in range(frames)]
    transfer = volume._transfer(look, options.get("mode") or "over")
    background = options.pop("background", None)
    suffix = os.path.splitext(path)[1].lower()
    if re.search(r"%0?\d*d", path):
        save = _save_by(path, background)
    elif suffix in ENCODERS:
        save = _Encoder(path, suffix, fps, background)
    else:
        raise ValueError(f"{path}: name a movie ({', '.join(ENCODERS)}) or "
                         f"files by a pattern such as turn_%04d.png")
    try:
        for n, angle in enumerate(angles):
            save(n, volume.render(transfer, azimuth=angle, _azimuths=angles,
                                  **options))
            if progress:
                progress("turntable", (n + 1) / frames)
    except BaseException:
        getattr(save, "abandon", lambda: None)()
        raise
    getattr(save, "finish", lambda: None)()


def _save_by(pattern: str, background: Color) -> Callable[[int, Any], None]:
    def save(n: int, image: Any) -> None:
        image.save(pattern % n, background=background)
    return save


class _Encoder:
    """ffmpeg, which writes beside the place of the movie until it is whole."""

    def __init__(self, path: str, suffix: str, fps: float,
                 background: Color) -> None:
        import shutil
        self.program = shutil.which("ffmpeg")
        if not self.program:
            raise RuntimeError(f"{path}: movies need the program ffmpeg; "
                               f"install it, or write turn_%04d.png")
        self.path, self.suffix, self.fps = path, suffix, fps
        self.background = color_of(background) or (0.0, 0.0, 0.0)
        root, ext = os.path.splitext(path)
        self.partial = f"{root}.{os.getpid()}.part{ext}"
        self.process: Any = None

    def __call__(self, n: int, image: Any) -> None:
        if self.process is None:
            import subprocess
            self.process = subprocess.Popen(
                [str(self.program), "-v", "error", "-y", "-f", "rawvideo",
                 "-pix_fmt", "rgb24", "-s", f"{image.width}x{image.height}",
                 "-r", f"{self.fps:g}", "-i", "-", *ENCODERS[self.suffix],
                 self.partial],
                stdin=subprocess.PIPE, stderr=subprocess.PIPE)
        assert self.process.stdin
        try:
            self.process.stdin.write(image._to_rgb8(self.background))
        except BrokenPipeError:
            self.finish()

    def finish(self) -> None:
        if self.process is None:
            return
        _, text = self.process.communicate()
        if self.process.returncode:
            self._remove()
            raise RuntimeError(f"{self.path}: ffmpeg failed: "
                               f"{text.decode(errors='replace').strip()}")
        os.replace(self.partial, self.path)

    def abandon(self) -> None:
        if self.process:
            self.process.kill()
            self.process.wait()
        self._remove()

    def _remove(self) -> None:
        if os.path.exists(self.partial):
            os.remove(self.partial)
