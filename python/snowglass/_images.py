"""Pictures."""
from __future__ import annotations

import os
import re
from typing import TYPE_CHECKING, Any, Iterator, Mapping, NamedTuple, \
    Optional, Sequence, Union

from . import _arrays, _checks, _recipes, _snowglass
from ._progress import Progress, progress_of

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
    _background: Optional[Sequence[float]] = None  # what "auto" is
    _values: bool = False                          # modes mean and sum
    _domain: Optional[tuple[float, float]] = None  # of colours of values
    _ranged: bool = False                          # whether it was asked for
    _view: tuple[Any, float] = (None, 1)           # target and zoom, as fitted

    def __new__(cls, *_: Any, **__: Any) -> "Image":
        raise TypeError("make an Image by Volume.render or Image.load")

    @staticmethod
    def load(path: Path) -> "Image":
        """Reads PNG, WebP, JPEG, NPY, PFM, EXR or TIFF."""
        return _snowglass.load_image(Image, os.fsencode(path))

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
        there is none: pictures of files and turntables, and looks with colours
        of their own."""
        if self._made is None:
            raise ValueError("only a picture by Volume.render or Volume.slice "
                             "has a recipe")
        return _recipes.make(*self._made)

    @property
    def command(self) -> str:
        """The command that makes the same picture, NAME.png unless -o is added.
        Of an array it draws VOLUME.nrrd, which `volume.save` writes.  Raises
        ValueError where there is none, as `recipe` does."""
        return _recipes.command(self.recipe)

    def save(self, path: Path, *, background: Color = "auto", bits: int = 0,
             overwrite: bool = True, title: Optional[str] = None,
             progress: Progress = None) -> "Image":
        """Writes .png, .webp, .jpg, .npy, .pfm, .exr or .tif, whole or not at
        all, over a file of that name unless overwrite=False.  PNG, WebP and JPEG show letters and bars; the others hold the
        pixels as they are.

        background    what PNG, WebP and JPEG are laid on: "auto" (dark; of
                      projections the lowest value's), "black", "white", "#rrggbb", three
                      numbers 0 to 1; None: transparent
        bits          8 or 16 a channel of PNG
        title         a line of text at the upper left
        """
        name = os.fsencode(path)
        picture, marks = self, dict[str, Any]()
        if _checks.text("title", title, "a line of text") is not None:
            marks["title"] = title
        if _snowglass.format_bits(name) > 0:
            picture, drawn = self._drawn()
            marks = {**drawn, **marks}
        elif background == "auto":
            background = None
        depth = self.depth if name.lower().endswith(b".exr") else None
        picture._save(name, background=self._color(background), bits=bits,
                      overwrite=overwrite, depth=depth,
                      progress=progress_of(progress), **marks)
        return self

    def _color(self, background: Color) -> Optional[Sequence[float]]:
        return self._background if background == "auto" \
            else color_of(background)

    def _drawn(self) -> tuple["Image", dict[str, Any]]:
        """What files of levels show, values in colours, and its annotations."""
        marks, picture = dict(self._annotations), self
        range = self._domain
        if self._values:
            low, high = self._domain if self._ranged and self._domain else \
                (float("nan"), float("nan"))
            picture, low, high = self._paint(Image, low, high)
            range = (low, high) if low or high else range
        return picture, {**marks, "range": range} if range else marks

    def png(self, background: Color = "auto") -> bytes:
        """The bytes of a PNG file."""
        import tempfile
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "image.png")
            self.save(path, background=background)
            with open(path, "rb") as file:
                return file.read()

    def _repr_png_(self) -> bytes:
        return self.png()

    def world_to_pixel(self, points: Any) -> "numpy.typing.NDArray[Any]":
        """Where points of the world, of shape (..., 3), are in the picture: x to the
        right, y down (the middle of the first pixel is at 0.5, 0.5), and the depth, as
        `depth` has it.  The world is that of `Volume.affine`.  NaN: behind the eye."""
        return self._places_of("points", points, False)

    def pixel_to_world(self, pixels: Any) -> "numpy.typing.NDArray[Any]":
        """The way back: the points of the world, of shape (..., 3), that are seen at
        pixels x, y with a depth.  NaN where a depth is NaN."""
        return self._places_of("pixels", pixels, True)

    def _places_of(self, name: str, given: Any, back: bool
                   ) -> "numpy.typing.NDArray[Any]":
        import numpy
        try:
            places = numpy.ascontiguousarray(given, numpy.float64)
        except (TypeError, ValueError):
            places = numpy.empty(0)
        if places.shape[-1] != 3:  # of a number it is 1
            raise _checks.fault(name, "three numbers each, in an array of shape "
                                "(..., 3)", given, ValueError)
        found = numpy.frombuffer(self._places(places, back))
        return found.reshape(places.shape).copy()

    def show(self) -> None:
        """Shows it in the program of this machine for PNG files; in a notebook a
        picture shows itself."""
        import tempfile
        import webbrowser
        with tempfile.NamedTemporaryFile(suffix=".png", delete=False) as file:
            file.write(self.png())
        if not webbrowser.open("file://" + file.name):
            raise OSError(f"no program of this machine shows pictures; this one is "
                          f"{file.name}, and save() writes it elsewhere")

    def to_rgb(self, background: Color = "auto") -> "numpy.typing.NDArray[Any]":
        """uint8 of shape (height, width, 3), on a background (None: black),
        with neither letters nor bars."""
        import numpy
        picture = self._drawn()[0]
        data = picture._save(None, background=self._color(background))
        return numpy.frombuffer(data or b"", numpy.uint8).reshape(
            self.height, self.width, 3)

    def to_pil(self, background: Color = "auto") -> Any:
        """A picture of the library Pillow."""
        import io
        import PIL.Image  # type: ignore[import]
        return PIL.Image.open(io.BytesIO(self.png(background)))

    def __array__(self, dtype: Any = None, copy: Any = None) -> "numpy.typing.NDArray[Any]":
        import numpy
        array: Any = numpy.frombuffer(self, "f4")  # type: ignore[call-overload]
        array = array.reshape(self.shape)
        return _arrays.converted(array, dtype, copy)

    def __dlpack__(self, **options: Any) -> Any:
        """The same for other libraries: torch.from_dlpack(image)."""
        import numpy
        return numpy.asarray(self).__dlpack__(**options)

    def __dlpack_device__(self) -> tuple[int, int]:
        return _arrays.PROCESSOR

    def __iter__(self) -> Iterator["Image"]:
        """rgba, depth = volume.render(depth=True)"""
        if self.depth is None:
            raise TypeError("the picture has no depths: render it with "
                            "depth=True; its rows are those of "
                            "numpy.asarray(image)")
        return iter((self, self.depth))

    def __reduce__(self) -> Any:
        raise TypeError("an Image cannot be pickled or copied: give numpy.array(image), or "
                        "its recipe")

    def _is_opaque(self) -> bool:
        import numpy
        return len(self.shape) == 3 and \
            bool((numpy.asarray(self)[..., -1] >= 1).all())

    def __repr__(self) -> str:
        height, width = self.shape[:2]
        kind = {2: "grey", 4: "colour"}.get(self.shape[-1], "values") \
            if len(self.shape) == 3 else "values"
        return f"<snowglass.Image {width}x{height} {kind}>"


def _as_in(path: Path, image: Image) -> Image:
    """What a file of the same kind would show of a picture, on its background
    and with its letters; the picture itself beside files that keep the pixels."""
    expected = Image.load(path)
    suffix = os.path.splitext(os.fsencode(path))[1]
    if _snowglass.format_bits(os.fsencode(path)) <= 0 or not expected._is_opaque():
        return image
    import tempfile
    with tempfile.TemporaryDirectory() as folder:
        shown = os.path.join(os.fsencode(folder), b"image" + suffix)
        image.save(os.fsdecode(shown))
        return Image.load(os.fsdecode(shown))


def compare(a: Union[Image, Path], b: Union[Image, Path]) -> Difference:
    """How two pictures, or files of pictures, differ.  Beside a PNG, WebP or JPEG
    without transparent pixels a picture counts as it would be saved: on its
    background, and with its letters.

    Raises snowglass.Error when their sizes differ.
    """
    for name, each in (("a", a), ("b", b)):
        if not isinstance(each, (Image, str, os.PathLike)):
            raise _checks.fault(name, "an Image or the path of a picture", each)
    if isinstance(a, Image) and not isinstance(b, Image):
        a = _as_in(b, a)
    elif isinstance(b, Image) and not isinstance(a, Image):
        b = _as_in(a, b)
    pictures = [each if isinstance(each, Image) else Image.load(each)
                for each in (a, b)]
    return Difference(*_snowglass.compare(*pictures))


# Those that the command line knows.
NAMED = {"black": "000000", "white": "ffffff", "grey": "808080",
         "gray": "808080", "silver": "c0c0c0", "red": "ff0000",
         "green": "008000", "blue": "0000ff", "navy": "000080",
         "yellow": "ffff00", "magenta": "ff00ff", "cyan": "00ffff",
         "orange": "ffa500"}


def color_of(given: Color) -> Optional[Sequence[float]]:
    """Red, green, blue 0 to 1; None for "none"."""
    if given is None or given == "none":
        return None
    if not isinstance(given, str):
        give = "a colour's name, '#rrggbb', or three numbers 0 to 1"
        if not hasattr(given, "__iter__"):
            raise _checks.fault("background", give, given)
        return tuple(_checks.number("background", part, give) for part in given)
    digits = NAMED.get(given.lower(), "")
    if given.startswith("#"):
        digits = given[1:]
    if len(digits) == 3:
        digits = "".join(2 * digit for digit in digits)
    if re.fullmatch("[0-9a-fA-F]{6}", digits):
        return tuple(int(digits[n:n + 2], 16) / 255 for n in (0, 2, 4))
    raise ValueError(f"'{given}' is no colour: give {', '.join(NAMED)}, #rgb, "
                     f"#rrggbb or three numbers 0 to 1")
