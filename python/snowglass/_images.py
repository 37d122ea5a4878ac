"""Pictures."""
from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any, Mapping, NamedTuple, Optional, \
    Sequence, Union

from . import _recipes, _snowglass

if TYPE_CHECKING:
    import numpy.typing

Path = Union[str, "os.PathLike[str]"]
Color = Union[str, Sequence[float], None]


class Difference(NamedTuple):
    """How two pictures differ, over four premultiplied channels 0 to 1."""
    largest: float  #: largest absolute difference; 0 when equal
    mean: float     #: mean absolute difference
    psnr: float     #: dB for a peak of 1; infinite when equal
    ssim: float     #: of the luma over black; 1 when equal
    x: int          #: a pixel of the largest difference
    y: int


class Image(_snowglass.Image):
    """A picture, as `Volume.render` makes it.

    `numpy.asarray(image)` is its float32 array of shape (height, width, 4), or
    (height, width, 2) where all colours are grey: premultiplied, linear, alpha
    last, row 0 on top.  It is not a copy, and stays valid as long as it is
    used.  Depths have the shape (height, width).
    """
    #: What the picture took: method, seconds, share of empty voxels.
    stats: Mapping[str, Any] = {}
    #: World distance from the target's plane to where opacity passes 1/2, NaN
    #: elsewhere; None unless `depth=True` was asked for.
    depth: Optional["Image"] = None
    _annotations: Mapping[str, Any] = {}
    _made: Any = None

    def __new__(cls, *_: Any, **__: Any) -> "Image":
        raise TypeError("make an Image by Volume.render or Image.load")

    @staticmethod
    def load(path: Path) -> "Image":
        """Reads PNG, WebP, NPY, PFM, EXR or TIFF."""
        return _snowglass.load_image(Image, os.fspath(path))

    @property
    def width(self) -> int:
        return self.shape[1]

    @property
    def height(self) -> int:
        return self.shape[0]

    @property
    def recipe(self) -> dict[str, Any]:
        """What it was made with, as the command line's `--config` reads it;
        `snowglass.render(**recipe)` gives the same bits.  Of an array, without
        "input": `snowglass.render(volume, **recipe)`.  Raises ValueError where
        there is none: pictures of files, slices and turntables, and looks with
        colours of their own."""
        if self._made is None:
            raise ValueError("only a picture by Volume.render has a recipe")
        return _recipes.make(*self._made)

    @property
    def command(self) -> str:
        """The command that makes the same picture, NAME.png unless -o is added.
        Raises ValueError where there is none, as for a volume that is an
        array."""
        return _recipes.command(self.recipe)

    def save(self, path: Path, *, background: Color = None, bits: int = 0,
             overwrite: bool = True, title: Optional[str] = None) -> "Image":
        """Writes .png, .webp, .npy, .pfm, .exr or .tif, whole or not at all.

        background    "black", "white", "#rrggbb" or three numbers 0 to 1 that
                      PNG and WebP are laid on; None: transparent
        bits          8 or 16 a channel of PNG
        title         a line of text at the upper left
        """
        marks = dict(self._annotations)
        if title is not None:
            marks["title"] = title
        self._save(os.fspath(path), background=color_of(background), bits=bits,
                   overwrite=overwrite, depth=self.depth
                   if os.fspath(path).endswith(".exr") else None, **marks)
        return self

    def png(self, background: Color = None) -> bytes:
        """The bytes of a PNG file."""
        import tempfile
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "image.png")
            self.save(path, background=background)
            with open(path, "rb") as file:
                return file.read()

    def _repr_png_(self) -> bytes:
        return self.png("black")

    def to_rgb(self, background: Color = "black") -> "numpy.typing.NDArray[Any]":
        """uint8 of shape (height, width, 3), on a background."""
        import numpy
        data = self._to_rgb8(color_of(background) or (0.0, 0.0, 0.0))
        return numpy.frombuffer(data, numpy.uint8).reshape(
            self.height, self.width, 3)

    def to_pil(self, background: Color = None) -> Any:
        """A picture of the library Pillow."""
        import io
        import PIL.Image  # type: ignore[import]
        return PIL.Image.open(io.BytesIO(self.png(background)))

    def __array__(self, dtype: Any = None, copy: Any = None) -> "numpy.typing.NDArray[Any]":
        import numpy
        array: Any = numpy.frombuffer(self, "f4")  # type: ignore[call-overload]
        array = array.reshape(self.shape)
        if dtype is not None and array.dtype != dtype:
            return array.astype(dtype)
        return array.copy() if copy else array

    def __repr__(self) -> str:
        height, width = self.shape[:2]
        kind = {2: "grey", 4: "colour"}.get(self.shape[-1], "values") \
            if len(self.shape) == 3 else "values"
        return f"<snowglass.Image {width}x{height} {kind}>"


def compare(a: Union[Image, Path], b: Union[Image, Path]) -> Difference:
    """How two pictures, or files of pictures, differ.

    Raises snowglass.Error when their sizes differ.
    """
    pictures = [each if isinstance(each, Image) else Image.load(each)
                for each in (a, b)]
    return Difference(*_snowglass.compare(*pictures))


NAMED = {"black": (0.0, 0.0, 0.0), "white": (1.0, 1.0, 1.0),
         "grey": (0.5, 0.5, 0.5), "gray": (0.5, 0.5, 0.5)}


def color_of(given: Color) -> Optional[Sequence[float]]:
    """Red, green, blue 0 to 1; None for "none"."""
    if given is None or given == "none":
        return None
    if not isinstance(given, str):
        return tuple(float(part) for part in given)
    if given in NAMED:
        return NAMED[given]
    digits = given[1:]
    if given.startswith("#") and len(digits) == 6:
        try:
            return tuple(int(digits[n:n + 2], 16) / 255 for n in (0, 2, 4))
        except ValueError:
            pass
    raise ValueError(f"'{given}' is no colour: give black, white, grey, "
                     f"#rrggbb or three numbers 0 to 1")
