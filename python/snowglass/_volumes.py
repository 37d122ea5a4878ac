"""Volumes, and pictures of them."""
from __future__ import annotations

import dataclasses
import math
import operator
import os
import re
from typing import TYPE_CHECKING, Any, Iterator, Literal, Mapping, Optional, \
    Sequence, TypeVar, Union, Unpack

from . import _arrays, _channels, _checks, _colormaps, _first, _movies, _overlays, \
    _recipes, _snowglass, _times
from ._images import Color, Image, Path, color_of
from ._looks import Look, colors_are_open, is_ranged, look_of, shows_window
from ._options import DEFAULTS, Data, Movie, Picture, Shot, Source, Whole
from ._progress import Progress, progress_of
from ._signatures import takes
from ._warnings import warn

if TYPE_CHECKING:
    import numpy.typing


V = TypeVar("V", bound="Volume")


class Volume(_snowglass.Volume):
    """A regular grid of samples with its place in the world.

    `source` is one of

      - the path of a file (NIfTI, NRRD, MetaImage, DICOM folder, TIFF, HDF5,
        Zarr, NetCDF, VTK, MRC, NPY, raw, ...) or "phantom:NAME";
      - an array of three dimensions [z, y, x] (NumPy, DLPack, or whatever
        numpy.asarray takes), which is not copied where its memory has no gaps,
        in whatever order its axes lie, and must not change while it is drawn;
      - an image of nibabel, whose affine is heeded;
      - a DataArray of xarray with three dimensions, whose coordinates give the
        spacing as those of a NetCDF file do (the mean step, where they are
        uneven), and whose units stand over the legend.

    spacing     lengths of a voxel along x, y, z, or one number for all
    affine      4x4 matrix from indices x, y, z to the world, instead
    axes        what the array's dimensions are: "zyx", "xyz", ...
    unit        of lengths: "mm", "um", ...
    medical     whether the world is a patient's right, anterior, superior
    slope, intercept   data value = slope * stored value + intercept
    copy        True: the array is copied, and may change then; False: an array
                that cannot be used in place is refused; None: it is copied,
                with a warning, where it must be
    frozen      whether the array stays as it is: encodings are kept from
                picture to picture then.  True by default; give False for an
                array that changes between pictures.

    For files: memory (the most bytes that the library may hold), dims, type ("uint8", "int16", ...), endian, offset (raw data),
    time (the number of a step, from 0, or from -1 at the end; or its time, as a text, "0.3s" or
    "2005-08-28T06:00", a datetime or a numpy.datetime64, for the step that is nearest, with a
    warning where it has another time), channel (below), component ("x", "magnitude", a number from 0, or names, "u,v,w", whose magnitude is taken), crop
    ((x0, x1), (y0, y1), (z0, z1)), dataset, series, allow_gaps (a DICOM folder,
    an OME-TIFF or a stack of ImageJ in which slices are missing is opened), suv (unit of PET in DICOM: "bw", "lbm",
    "bsa", or "none", as stored), levels (of refinement that are read,
    the coarsest first), z_scale (a factor on the height, or "auto", as of --z-scale), vertical (of WRF: "levels" or "height"), mask (a path), labels ("1,4-7"),
    label_table (a path: names and colours), clip (planes (a, b, c, d): what lies where a x + b y + c z > d is cut away).

    channel   Pictures of a file whose channels are images of one thing show all
              of them, in its colours.  A number or a name: one, in grey.
              "0:magenta,GFP:green:20..200:0.5", {"GFP": "green", 0: "magenta"} or
              [0, "GFP"]: these; behind a channel stand, in any order, a colour, a
              range and an opacity.  Arrays, statistics, slice_values, project and
              save are those of one channel, the first.

    A Volume may be used by several threads; they take turns.  `with` closes it at
    the end.
    """
    _axes: str = "zyx"                       # of the array
    _order: tuple[int, ...] = (0, 1, 2)      # of its dimensions in memory

    @takes(Source)
    def __new__(cls, source: Any, **given: Unpack[Source]) -> "Volume":
        options: dict[str, Any] = dict(given)
        progress, memory = options.pop("progress", None), \
            options.pop("memory", None) or 0
        if isinstance(source, (str, bytes, os.PathLike)):
            return cls._open(os.fsdecode(source), memory, progress, options)
        if memory:
            raise TypeError("memory counts for files only: an array is in memory already; "
                            "save() it as .nrrd, and open that with memory=")
        _arrays.check_options(options)
        one = _arrays.wrap(source, **options)
        made = _snowglass.wrap(cls, one.array, one.order, one.matrix, one.slope,
                               one.intercept, one.medical, one.unit, None, True,
                               one.window, one.meaning)
        made._axes, made._order = one.axes, one.order
        made._frozen = one.frozen
        if one.frozen:
            made._freeze()
        path = _arrays.file_of(source)
        if path is not None and made._is_as(path):
            made._source = {"input": path}
        return made

    @takes(Source)
    def __init__(self, source: Any, **options: Unpack[Source]) -> None:
        """Opens a file, or wraps an array; `help(snowglass.Volume)` describes the
        options."""

    #: The file and how it was opened, as keys of a recipe; None: an array.
    _source: Optional[Mapping[str, Any]] = None
    _memory: int = 0                         # the most bytes; 0: no limit
    _planes: Any = None                      # that have cut it
    _frozen: bool = True
    _mixed: Optional[_channels.Channels] = None  # that its pictures mix
    #: What the file says of its channel of emitted light; None: it is none.
    _one: Optional[Mapping[str, Any]] = None

    @classmethod
    def _open(cls, path: Path, memory: int, progress: Progress,
              options: Mapping[str, Any]) -> "Volume":
        _checks.names(options.keys() - {"each_time"}, (*_recipes.DATA, "memory", "progress"), {
            name: "counts for arrays only: give numpy.asarray(volume) of the file "
                  "to Volume, with it" for name in _arrays.OPTIONS})
        memory = _whole("memory", memory, "the most bytes, or 0: no limit")
        fields = dict(options)
        clip = fields.pop("clip", None)
        spacing = fields.get("spacing")
        if spacing is not None and not hasattr(spacing, "__len__"):
            fields["spacing"] = (spacing,) * 3
        if fields.get("z_scale") == "auto":
            del fields["z_scale"]
        if isinstance(fields.get("component"), (tuple, list)):
            fields["component"] = ",".join(map(str, fields["component"]))
        for name in ("mask", "label_table", "dataset", "series", "labels",
                     "component", "suv", "vertical"):
            if fields.get(name) is not None:
                fields[name] = os.fsencode(fields[name]) \
                    if name in ("mask", "label_table") else str(fields[name])
        if "type" in fields and fields["type"] is not None:
            fields["type"] = str(fields["type"])
        if fields.get("time") is not None:
            fields["time"] = _times.step(fields["time"], os.fspath(path), fields)
        picks, numbers = _channels.picked(path, fields)
        if fields.get("channel") is None:  # told when a picture is made
            fields["each_channel"] = True
        made = _snowglass.open(cls, os.fsencode(path), fields, clip, memory,
                               progress_of(progress))
        made._memory, made._planes = memory, clip
        made._mixed = _channels.of_volume(made, path, fields, clip, picks,
                                          numbers)
        made._one = _channels.light_of(made._info, fields)
        given = {**options, **fields, "mask": options.get("mask")}
        if picks:
            given["channel"] = _channels.text(picks, numbers)
        made._source = {"input": os.fspath(path), **{
            name: value for name, value in given.items()
            if value is not None and name not in ("each_time", "each_channel")}}
        return made

    def _is_as(self, path: str) -> bool:
        """Whether a file says the same of itself: an image of nibabel may have been
        given another place since it was loaded."""
        try:
            file, own = _snowglass.inspect(os.fsencode(path), {}), self.info
        except (RuntimeError, ValueError):
            return False
        return all(file[name] == own[name] for name in file
                   if name not in ("format", "time_value"))

    @classmethod
    def channels(cls, arrays: Sequence[Any], *,
                 colors: Optional[Sequence[str]] = None,
                 names: Optional[Sequence[str]] = None,
                 windows: Optional[Sequence[tuple[float, float]]] = None,
                 **options: Any) -> "Volume":
        """Arrays of one shape as channels that pictures mix: a list of them, or an
        array of four dimensions, the channel first.  For each a colour ("green",
        "#ff8000", or a colour map), a name for the legend, and a window (the data
        values from dark to bright).  Options are those of Volume."""
        if not len(arrays):
            raise ValueError("there is no channel: give at least one array")
        if any(isinstance(each, (str, os.PathLike)) for each in arrays):
            raise TypeError("channels of files: Volume(path, channel=...) opens "
                            "those of one file")
        made = cls(arrays[0], **options)
        voxels = [None if n == 0 else
                  _arrays.like(each, made.shape, made._order, "a channel")
                  for n, each in enumerate(arrays)]
        made._mixed = _channels.of_arrays(made, voxels, colors, names, windows)
        return made

    def close(self) -> None:
        """Gives the memory back now, not when the last name of the volume goes.
        Pictures stay.  BufferError: arrays of the voxels are in use."""
        self._close()
        if self._mixed is not None:
            self._mixed.close()

    def __enter__(self: V) -> V:
        return self

    def __exit__(self, kind: Any, error: Any, trace: Any) -> None:
        """Closes it; of arrays in use nothing is said behind another exception."""
        try:
            self.close()
        except BufferError:
            if kind is None:
                raise

    def __reduce__(self) -> Any:
        raise TypeError("a Volume cannot be pickled or copied: open the file or wrap the "
                        "array where it is used")

    # --- what it is ---

    @property
    def info(self) -> Mapping[str, Any]:
        """dims (x, y, z), type, spacing, matrix, slope, intercept, medical,
        unit, format, times, time, storage, modality, hounsfield; quantity,
        value_unit and description of the values, time_value (or NaN), time_unit
        and calendar of the step, as far as the file names them; channel_count,
        and channels (the first eight): name, color, window (or None), whether it
        is shown, and whether it is a part of the voxels' own colours."""
        info = dict(self._info)
        if self._mixed is not None and not self._mixed.directions:
            info["channel_count"] = self._mixed.count
            info["channels"] = [dict(each) for each in self._mixed.said]
        columns = _arrays.columns_of(self._order, self._axes)
        if columns != [0, 1, 2]:  # x, y, z lie in another order in memory
            x, y, z = (columns.index(axis) for axis in range(3))
            for name in ("dims", "spacing"):
                info[name] = tuple(info[name][n] for n in (x, y, z))
            info["matrix"] = tuple(tuple(row[n] for n in (x, y, z, 3))
                                   for row in info["matrix"])
        return info

    @property
    def axes(self) -> str:
        """What the dimensions of `numpy.asarray(volume)` are: "zyx", "xyz"."""
        return self._axes

    @property
    def dims(self) -> tuple[int, int, int]:
        """Voxels along x, y, z."""
        return self.info["dims"]

    @property
    def shape(self) -> tuple[int, int, int]:
        """Of `numpy.asarray(volume)`: that of the array that was given; of a
        file voxels along z, y, x."""
        z, y, x = reversed(self._info["dims"])
        slowest = (z, y, x)
        return slowest[self._order[0]], slowest[self._order[1]], \
            slowest[self._order[2]]

    @property
    def spacing(self) -> tuple[float, float, float]:
        """Lengths of a voxel along x, y, z, in axis_units."""
        info, scales = self.info, [scale for _, scale in self.info["axes"]]
        if all(abs(scale) == 1 for scale in scales):
            return info["spacing"]
        rows = list(zip(info["matrix"], scales))
        x, y, z = (math.hypot(*(row[n] / scale for row, scale in rows))
                   for n in range(3))
        return x, y, z

    @property
    def axis_units(self) -> tuple[str, str, str]:
        """The unit of each axis of the world, as ("degrees", "degrees", "hPa");
        affine has them in lengths that can be drawn beside each other: those of
        one unit are info["axes"][n][1], below 0 where it grows downward."""
        x, y, z = (unit for unit, _ in self.info["axes"])
        return x, y, z

    @property
    def affine(self) -> "numpy.typing.NDArray[Any]":
        """4x4 matrix from indices x, y, z to the world."""
        import numpy
        return numpy.array(self.info["matrix"])

    @property
    def statistics(self) -> Mapping[str, Any]:
        """voxels, finite, min, max, sum of the data values; hounsfield: whether
        they are those of a CT."""
        return self._statistics(None)

    def histogram(self, bins: int = 256,
                  range: Optional[tuple[float, float]] = None, *,
                  progress: Progress = None
                  ) -> tuple["numpy.typing.NDArray[Any]", "numpy.typing.NDArray[Any]"]:
        """Counts and edges of bins of the finite data values, as
        numpy.histogram gives them."""
        import numpy
        if range is None:
            known = self._statistics(None)
            range = (known["min"], known["max"])
            if not range[0] < range[1]:
                range = (range[0] - 0.5, range[1] + 0.5)
        try:
            low, high = (float(end) for end in range)
        except (TypeError, ValueError) as error:
            raise _checks.fault("range", "(low, high)", range, type(error)) from None
        counts = self._histogram(low, high, _whole(
            "bins", bins, "a whole number from 1"), progress_of(progress))
        return numpy.array(counts, numpy.int64), \
            numpy.linspace(low, high, bins + 1)

    def __array__(self, dtype: Any = None, copy: Any = None) -> "numpy.typing.NDArray[Any]":
        """The stored values, in the shape that was given; of files (z, y, x).
        Not writeable."""
        import numpy
        array: Any = numpy.asarray(memoryview(self))  # type: ignore[arg-type]
        return _arrays.converted(array, dtype, copy)

    def __dlpack__(self, **options: Any) -> Any:
        """The same for other libraries, which must know of read-only memory."""
        import numpy
        try:
            return numpy.asarray(self).__dlpack__(**options)
        except BufferError as error:
            raise BufferError(f"the voxels cannot be given by DLPack ({error}): give a "
                              f"copy, numpy.array(volume)") from None

    def __dlpack_device__(self) -> tuple[int, int]:
        return _arrays.PROCESSOR

    def __str__(self) -> str:
        info, known = self.info, self._statistics(None)
        dims = "x".join(str(each) for each in info["dims"])
        spacing = "x".join(f"{each:g}" for each in self.spacing)
        units = dict.fromkeys(self.axis_units)
        unit = " " + ", ".join(self.axis_units if len(units) > 1 else units) \
            if any(units) else ""
        return f"{dims} {info['type']}, {spacing}{unit}, " \
               f"{known['min']:g}..{known['max']:g}"

    def __repr__(self) -> str:
        try:
            self._info
        except ValueError:
            return "<snowglass.Volume, closed>"
        dims = "x".join(str(each) for each in self.dims)
        return f"<snowglass.Volume {dims} {self._info['type']}>"

    # --- what is made of it ---

    def save(self, path: Path, *, overwrite: bool = True,
             progress: Progress = None) -> "Volume":
        """Writes .nrrd, .nii, .nii.gz, .mha, .npy or .raw, x fastest, over a file
        of that name unless overwrite=False."""
        import numpy
        volume, info = self, self.info
        if info["dims"] != self._info["dims"] or \
                info["matrix"] != self._info["matrix"]:
            order = [self._axes.index(axis) for axis in "zyx"]
            volume = Volume(numpy.asarray(self).transpose(order).copy(),
                            **{name: info[name] for name in
                               ("slope", "intercept", "medical", "unit")},
                            affine=info["matrix"])
        volume._save(os.fsencode(path), overwrite, progress_of(progress))
        return self

    def masked(self, mask: Any, labels: Union[str, int, Sequence[int], None] = None,
               *, progress: Progress = None) -> "Volume":
        """A volume without the voxels where the mask, an array of the same
        shape, has none of the labels: a number, several, or "1,4-7" (by default:
        where it is 0)."""
        voxels = _arrays.like(mask, self.shape, self._order)
        picked = _labels(labels)
        info = self._info
        matrix = [part for row in info["matrix"] for part in row]
        other = _snowglass.wrap(Volume, voxels, (0, 1, 2), matrix, 1.0, 0.0,
                                info["medical"], info["unit"], self)
        made = _snowglass.masked(Volume, self, other, picked, progress_of(progress))
        if self._mixed is not None:
            made._mixed = self._mixed.mapped(
                self, lambda each: _snowglass.masked(_snowglass.Volume, each,
                                                     other, picked))
        made._axes, made._order = self._axes, self._order
        made._one = self._one
        return made

    def look(self, look: Union[Look, str, None] = None, *,
             progress: Progress = None) -> str:
        """What a look becomes for this volume, in one line."""
        mode = _first.mode(self, look, {})
        mixture = self._mixture(look, mode, {})
        return mixture.describe() if mixture else \
            self._transfer(look, mode, progress).description

    def _mixture(self, look: Any, mode: str, settings: Mapping[str, Any]
                 ) -> Optional[_channels.Mixture]:
        """The channels that a picture mixes; None: it shows the volume."""
        if isinstance(look, _channels.Mixture):  # of the frames of a movie
            return look
        mixed = self._mixed
        if mixed is None or isinstance(look, _snowglass.Transfer):
            return None
        return mixed.mixture(self, look_of(look), mode, settings)

    def _transfer(self, look: Union[Look, str, None], mode: str = "over",
                  progress: Progress = None) -> Any:
        if isinstance(look, _snowglass.Transfer):
            return look
        known = _colormaps.resolved(self, look, _chosen(look, mode))
        chosen = _chosen(known, mode)
        if mode == "mip" and self._one and not is_ranged(look_of(known)) and \
                chosen.range == "robust":
            chosen = dataclasses.replace(chosen, range=self._one["window"] or
                                         "signal")
        colors = self._info["first_colormap"]
        if mode == "mip" and colors and look_of(known).preset is None and \
                chosen.colors is None:
            chosen = dataclasses.replace(
                chosen, colormap=chosen.colormap or colors,
                range="signal" if chosen.range == "robust" else chosen.range)
        arguments = (*chosen._arguments(), progress_of(progress))
        return self._look(*arguments)

    @takes(Picture)
    def render(self, look: Union[Look, str, None] = None,
               **options: Unpack[Picture]) -> Image:
        """A picture.

        look          a Look, the name of a preset or a colour map, or None: chosen,
                      but for the options of Look that are given here:
                      cmap="viridis", ...; window is the width and the centre of a
                      range
        view          a side: "anterior", "left", "+z", "iso", "xy" (as "+z"), ...
                      of snowglass.views(); None: chosen
        size          (width, height) in pixels, or one number for both
        azimuth, elevation, roll   degrees that the camera moves to its right
                      and up, and turns clockwise
        perspective   True (30 degrees) or degrees over the shorter side
        position, target, up   a camera by points of the world instead
        fit           "visible": what the look shows fills the picture;
                      "volume": the whole box does; zoom multiplies either
        light         "key", "head" or (azimuth, elevation) in degrees
        overlay       a segmentation, or a second volume of values, that is
                      drawn in this one: a path, a Volume with its place in the
                      world, or an array of this one's shape
        overlay_look  its look; None: labels, else hot colours
        legend, letters   what is drawn when the picture is saved as PNG, WebP or
                      TIFF of 8 bits; a legend may be its title, "T (K)", or
                      "scale" for the scale bar alone
        measure       as of Volume.measure, drawn when the picture is saved; its stats
                      have what is measured
        progress      called as progress(stage, fraction), or True: printed,
                      by tqdm where that is installed

        quality       "draft", "normal" or "high"
        mode          "over", "mip", "minip", "mean", "sum", or "iso": the surface
                      at the data value `iso`
        shade         True or "phong", False or "none"; None: chosen
        material      (ambient, diffuse, specular, shininess)
        kernel        "gauss", or "gauss:5" with its support in voxels
        depth         True: the picture has depths, in modes over and iso
        opacity_length   the length, in the unit of the world, that an opacity
                      is of; None: the smallest spacing

        threshold, method, encoding, occlusion, depth_darkening, threads,
        deterministic and isa are those of the command line, as `snowglass help`
        describes them; what is not given has its default.

        A picture in which nothing is seen comes with a warning.  Raises TypeError (an
        argument of a wrong kind, or none), ValueError (a value out of its range, an
        unknown name), MemoryError, snowglass.Error, KeyboardInterrupt within 0.1 s.
        """
        return self._picture(look, **_given(options))

    def _picture(self, look: Any, *, view: Optional[str] = None,
                 size: Any = DEFAULTS["size"], azimuth: float = 0,
                 elevation: float = 0, roll: float = 0,
                 zoom: float = DEFAULTS["zoom"],
                 perspective: Any = False, position: Any = None, target: Any = None,
                 up: Any = None, fit: str = DEFAULTS["fit"], light: Any = None,
                 overlay: Any = None, overlay_look: Any = None,
                 legend: Union[bool, str] = False,
                 letters: bool = DEFAULTS["letters"], measure: Optional[str] = None,
                 progress: Progress = None, azimuths: Optional[Sequence[float]] = None,
                 quiet: bool = False, **settings: Any) -> Image:
        """One of a movie, whose frame suits all `azimuths`; `quiet`: the caller
        says where nothing is seen."""
        if fit not in ("visible", "volume"):
            raise ValueError(f"fit '{fit}': give visible or volume")
        if "background" in settings:
            raise TypeError("background is an option of save: pictures are "
                            "transparent until then")
        look = _given_look(look, settings)
        _check_render(settings, view, legend)
        view = SIDES.get(view, view) if view else view
        shade: Any = settings.get("shade")
        if hasattr(shade, "tolist"):  # a truth of NumPy
            shade = shade.tolist()
        if isinstance(shade, bool):
            settings["shade"] = "phong" if shade else "none"
        mode = _first.mode(self, look, {**settings, "overlay": overlay,
                                        "light": light})
        if mode != "over":
            settings["mode"] = mode
        if not isinstance(look, (_snowglass.Transfer, _channels.Mixture)):
            look = _colormaps.resolved(self, look, _chosen(look, mode))
        mixture = self._mixture(look, mode, settings)
        first: _snowglass.Volume = mixture.volumes[0] if mixture else self
        transfer = mixture.transfers[0] if mixture else \
            self._transfer(look, mode, progress)
        width, height = _sides(size)
        asked = {"view": view, "size": (width, height), "azimuth": azimuth,
                 "elevation": elevation, "roll": roll, "zoom": zoom,
                 "perspective": perspective, "position": position,
                 "target": target, "up": up, "fit": fit, "light": light,
                 "overlay": overlay, "overlay_look": overlay_look,
                 "legend": legend, "letters": letters, "measure": measure,
                 **settings}
        fields = {"width": width, "height": height, "azimuth": azimuth,
                  "elevation": elevation, "roll": roll, "zoom": zoom,
                  "fov": 30.0 if perspective is True else _checks.number(
                      "perspective", perspective, "True or degrees"),
                  "position": position, "target": target, "up": up}
        _set_light(light, settings)
        _set_material(settings)
        _set_kernel(settings)
        layer = _overlays.overlaid(self, overlay, overlay_look,
                                   progress_of(progress))
        if mixture and settings.get("shade") is None:
            settings["shade"] = "none"
        if transfer.unshaded and (layer is None or layer.transfer.unshaded) \
                and settings.get("shade") is None and \
                settings.get("mode") != "iso":
            settings["shade"] = "none"
        layers = mixture.layers() if mixture else ()
        if layer is not None:
            layers += ((layer.volume, layer.transfer, False, 1.0),)
        annotations = self._annotations(mode, letters, legend, mixture)
        listed = self._measured(measure, annotations)
        image, depth, target, zoom, stats = first._render(
            Image, transfer, view, fields, settings, fit == "visible", azimuths,
            progress_of(progress), layers, mixture is not None,
            mixture.shares[0] if mixture else 1.0,
            _marks_of(annotations, mode, transfer))
        image.stats, image.depth, image._view = stats, depth, (target, zoom)
        if measure is not None:
            image.stats = {**stats, "measures": listed}
        if stats["empty"] and not quiet:
            warn(_emptiness(mode, settings, stats))
        if azimuths is None and not isinstance(
                look, (_snowglass.Transfer, _channels.Mixture)):
            image._made = (self._source, self._info["unit"],
                           look_of(look), asked)
        self._annotate(image, mode, transfer, look, annotations)
        if mixture and mixture.white:
            image._background = (1.0,) * 3
        return image

    def _annotations(self, mode: str, letters: bool, legend: Union[bool, str],
                     mixture: Optional[_channels.Mixture]) -> dict[str, Any]:
        """What a saved picture will show, as the command line has it."""
        annotations: dict[str, Any] = {
            "letters": letters, "unit": None, "scale_bar": legend == "scale",
            "legend": bool(legend) and legend != "scale"}
        if annotations["legend"]:
            annotations["unit"] = self._caption(
                legend if isinstance(legend, str) else "")
        if mixture:
            annotations["bars"] = mixture.bars(mode)
        return annotations

    def measure(self, text: str) -> list[dict[str, Any]]:
        """Lengths, angles, and the values of voxels in ellipses, as the command line's
        `--measure` lists them: "line 0,0,0 30,40,0; angle P P P; ellipse axial 12.5 0,20 15
        10", where a point P is x,y,z, in the units of the world."""
        return self._measured(text, {})

    def _measured(self, text: Optional[str], annotations: dict[str, Any], along: int = 0,
                  index: int = -1) -> list[dict[str, Any]]:
        """What is measured; annotations get what lies in that slice, or all."""
        if _checks.text("measure", text, "such as 'line 0,0,0 10,0,0'") is None:
            return []
        unit = "HU" if self._info["hounsfield"] else self._info["value_unit"]
        columns = _arrays.columns_of(self._order, self._axes)  # as of slices
        inner = re.sub(r"(?<=ellipse )(\s*)([xyz])(?=\s)", lambda found: found[1] + "xyz"[
            columns.index("xyz".index(found[2]))], str(text))
        listed, drawn = [], []
        for n, (record, kind, points, result, count, mean, deviation, least, most, length,
                axis, at, outside, lies) in enumerate(self._measure(inner, along, index)):
            if outside and not (self._source or {}).get("crop"):
                raise ValueError(f"measure: measure {n + 1} is outside the volume")
            name = ("", "line", "angle", "ellipse")[kind]
            each: dict[str, Any] = {"kind": name, "points": points[:2 if kind == 1 else 3],
                                    ("", "length", "degrees", "area")[kind]: result}
            if kind == 3:
                each.update(mean=mean, deviation=deviation, min=least, max=most,
                            count=max(count, 0), value_unit=unit, axis="xyz"[columns[axis]], index=at)
            listed.append(each if kind == 2 else {**each, "unit": length})
            if lies:
                drawn.append(record)
        annotations.update(measures=tuple(drawn), value_unit=unit)
        return listed

    @staticmethod
    def _annotate(image: Image, mode: str, transfer: Any, look: Any,
                  annotations: dict[str, Any]) -> None:
        image._annotations = annotations
        image._values = mode in ("mean", "sum")
        image._domain = None if mode == "over" else transfer.domain
        image._ranged = is_ranged(look) or shows_window(mode, transfer)
        image._background = (20 / 255,) * 3 if mode in ("over", "iso") \
            else (0.0,) * 3 if "bars" in annotations or mode == "slice" \
            else transfer.evaluate(transfer.domain[0])[:3]

    def _caption(self, title: str = "") -> Optional[str]:
        """Quantity and unit, as a title "quantity (unit)" has them, else of the
        data.  The unit of a CT is known by its values where no modality is
        named."""
        info = self._info
        quantity, unit = info["quantity"], ""
        if title.endswith(")") and "(" in title:
            title, _, unit = title[:-1].rpartition("(")
        quantity = title.rstrip(" ") or quantity
        if unit:
            return f"{quantity} ({unit})" if quantity else unit
        unit = info["value_unit"]
        if not unit and (info["hounsfield"] or info["medical"] and
                         not info["modality"] and
                         self._statistics(None)["hounsfield"]):
            unit = "HU"
        if quantity and unit:
            return f"{quantity} ({unit})"
        return quantity or unit or None

    @takes(Shot, fit="volume")
    def project(self, mode: Literal["mip", "minip", "mean", "sum"] = "mip",
                **given: Unpack[Shot]) -> "numpy.typing.NDArray[Any]":
        """Largest ("mip"), smallest ("minip") or mean values along the rays, or
        their sum times length ("sum"), in data units: float32 of shape (height,
        width), NaN where a ray meets no voxel.  Options are those of render, but
        that the whole volume is in the picture."""
        import numpy
        options = _given(given)
        for name in ("look", *_recipes.LOOKS):
            if options.get(name) is not None:
                raise TypeError(f"{name}: project gives data values, which have no "
                                f"look; remove it, or render with mode={mode!r}")
        options.setdefault("fit", "volume")
        if mode in ("mean", "sum"):
            return numpy.asarray(self._picture(self._transfer(None, mode), mode=mode,
                                               **options))
        if mode not in ("mip", "minip"):
            raise ValueError(f"mode '{mode}': give mip, minip, mean or sum")
        known = self._statistics(None)
        low, high = known["min"], known["max"]
        if not low < high:
            high = low + 1
        ramp = Look(colors=[(low, (0, 0, 0)), (high, (1, 1, 1))],
                    opacity=[(low, 1), (high, 1)])
        pixels = numpy.asarray(self._picture(self._transfer(ramp, mode), mode=mode,
                                             **options))
        with numpy.errstate(divide="ignore", invalid="ignore"):
            values = pixels[..., 0] / pixels[..., -1]
        return (low + (high - low) * values).astype(numpy.float32)

    def slice(self, axis: Union[str, int] = "axial", at: Union[int, str, None] = None,
              look: Union[Look, str, None] = None, *,
              size: Union[int, Sequence[int], None] = None,
              kernel: Optional[str] = None, legend: Union[bool, str] = False,
              overlay: Any = None, overlay_look: Union[Look, str, None] = None,
              outline: bool = False, letters: bool = True,
              measure: Optional[str] = None, threads: int = 0) -> Image:
        """A picture of one slice, in the colours of a look, opaque.

        axis    "axial", "coronal" or "sagittal": the axis of the grid that is
                nearest to that of the patient; "x", "y", "z": of the grid; a
                number: that dimension of `numpy.asarray(volume)`
        at      the slice's number, or a position in the world with its unit,
                "12.5mm"; None: the middle one
        look    what it leaves open is chosen from the slice's values; None: grey
                over the file's window or the slice's values but a few far off.
                Give a Look with a range to have the same greys in several slices
        size    (width, height), or one number for both: the slice fits; None: a
                pixel is a voxel, or its smaller side
        kernel  "tent": linear between voxels; "box": the nearest
        overlay, overlay_look  as of render, but half as opaque at most, unless
                the look has opacities
        outline  True: the borders of the overlay's labels or values alone
        measure  as of Volume.measure: what lies in the slice is drawn when the picture is
                saved, and all is in its stats

        The patient's left is at the right of axial and coronal pictures, the
        front at the top of axial ones and at the left of sagittal ones.
        Without a patient, y or z is up.  `stats` of the picture has axis, index
        and position.
        """
        axis = self._axis_name(axis)
        _check_legend(legend)
        along, index, position = self._find_slice(axis, at)
        alone = self._slice_alone(along, index)
        mixed = self._mixed
        if self._info["lengths"] and not (mixed and mixed.directions) and \
                not isinstance(look, _snowglass.Transfer):
            given = look_of(look)  # of lengths, which the slice alone is not
            if not (given.preset or given.colormap or given.colors):
                look = dataclasses.replace(given, colormap="viridis")
        if not isinstance(look, _snowglass.Transfer):
            look = _colormaps.resolved(alone, look, _chosen(look, "slice"))
        mixture = None
        if mixed is not None and not isinstance(look, _snowglass.Transfer):
            mixture = mixed.mixture(
                self, look_of(look), "slice", {}, lambda each: alone if each is
                self else self._slice_alone(along, index, each))
        transfer = mixture.transfers[0] if mixture else \
            alone._slice_transfer(look)
        annotations = alone._annotations("slice", letters, legend, mixture)
        listed = self._measured(measure, annotations, along, index)
        lines = _overlays.over_slices(self, overlay, overlay_look, outline)
        lines.layers = tuple(
            (self._slice_alone(along, index, volume), transfer, mixes, share)
            for volume, transfer, mixes, share in lines.layers)
        image = alone._draw_slice(along, 0, transfer, size,
                                  {"kernel": kernel, "threads": threads}, mixture,
                                  _marks_of(annotations, "slice", transfer), lines)
        image.stats = {"axis": axis, "index": index, "position": position}
        if measure is not None:
            image.stats["measures"] = listed
        if not isinstance(look, _snowglass.Transfer) and not lines.layers:
            image._made = (self._source, self._info["unit"], look_of(look), {
                "verb": "slice", "axis": axis.lower(),
                "at": at if isinstance(at, str) else str(index), "size":
                None if size is None else _sides(size), "kernel": kernel,
                "legend": legend, "letters": letters, "measure": measure,
                "threads": threads})
        alone._annotate(image, "slice", transfer, look, annotations)
        return image

    def slice_grid(self, columns: int, rows: int, axis: Union[str, int] = "axial",
                   at: Optional[Sequence[int]] = None,
                   look: Union[Look, str, None] = None, *,
                   size: Union[int, Sequence[int], None] = None,
                   kernel: Optional[str] = None, overlay: Any = None,
                   overlay_look: Union[Look, str, None] = None,
                   outline: bool = False, letters: bool = True,
                   threads: int = 0, progress: Progress = None) -> Image:
        """A picture of columns times rows slices, with their numbers and one look,
        that of the whole volume; spread evenly over those that show something,
        or over the numbers `at`.  The rest is as in Volume.slice.  `stats` has
        axis and indices."""
        axis = self._axis_name(axis)
        along = self._find_slice(axis, None)[0]
        count = _whole("columns", columns, "a number from 1") * \
            _whole("rows", rows, "a number from 1")
        transfer, mixture = self._sheet_look(look)
        if at is None:
            first, last = self._slice_shown(transfer, along)
            at = range(first, last + 1)
        shown = [self._find_slice(axis, n)[1] for n in at]
        indices = [shown[int((n + 0.5) * len(shown) / min(count, len(shown)))]
                   for n in range(min(count, len(shown)))]
        image = self._draw_sheet("xyz"[along], columns, rows, (0.0,) * 3, indices,
                                 transfer, mixture, look, size, letters,
                                 {"kernel": kernel, "threads": threads},
                                 _overlays.over_slices(self, overlay, overlay_look,
                                                       outline), progress)
        image.stats = {"axis": axis, "indices": indices}
        return image

    def slice_ortho(self, at: Optional[Sequence[float]] = None,
                    look: Union[Look, str, None] = None, *,
                    size: Union[int, Sequence[int], None] = None,
                    kernel: Optional[str] = None, overlay: Any = None,
                    overlay_look: Union[Look, str, None] = None,
                    outline: bool = False, letters: bool = True,
                    threads: int = 0, progress: Progress = None) -> Image:
        """The axial, coronal and sagittal slice through a point of the world, or
        the middle, beside one another at one scale, with lines through the
        point; else as slice_grid.  `stats` has point and indices."""
        import numpy
        matrix = numpy.array(self._info["matrix"])[:3]
        middle = matrix[:, :3] @ (numpy.array(self._info["dims"]) // 2) + matrix[:, 3]
        x, y, z = map(float, middle if at is None else at)
        transfer, mixture = self._sheet_look(look)
        image = self._draw_sheet(None, 0, 0, (x, y, z), [0] * 3, transfer, mixture,
                                 look, size, letters,
                                 {"kernel": kernel, "threads": threads},
                                 _overlays.over_slices(self, overlay, overlay_look,
                                                       outline), progress)
        image.stats = {"point": (x, y, z), "indices": image.stats["indices"]}
        return image

    def slice_movie(self, path: Path, axis: Union[str, int] = "axial",
                    at: Optional[Sequence[int]] = None,
                    look: Union[Look, str, None] = None, *,
                    frames: Optional[int] = None, fps: float = 30,
                    size: Union[int, Sequence[int], None] = None,
                    kernel: Optional[str] = None, legend: Union[bool, str] = False,
                    overlay: Any = None,
                    overlay_look: Union[Look, str, None] = None,
                    outline: bool = False, letters: bool = True,
                    background: Color = "auto", overwrite: bool = False,
                    threads: int = 0, progress: Progress = None) -> None:
        """Pictures of all slices, or of the numbers `at`, or of `frames` of them, in
        one look, that of the whole volume: files by a pattern such as "s_%03d.png",
        or a movie, as of Volume.turntable.  The rest is as in Volume.slice."""
        axis = self._axis_name(axis)
        along = self._find_slice(axis, None)[0]
        numbers = range(self._info["dims"][along]) if at is None else at
        shown = [self._find_slice(axis, n)[1] for n in numbers]
        if frames is not None:
            most = _whole("frames", frames, "a number from 1") - 1
            shown = [shown[round(n * (len(shown) - 1) / most)] for n in
                     range(frames)] if most else [shown[(len(shown) - 1) // 2]]
        _check_legend(legend)
        transfer, mixture = self._sheet_look(look)
        lines = _overlays.over_slices(self, overlay, overlay_look, outline)
        annotations = self._annotations("slice", letters, legend, mixture)
        marks = _marks_of(annotations, "slice", transfer)

        def draw(n: int) -> Image:
            image = self._draw_slice(along, shown[n], transfer, size,
                                     {"kernel": kernel, "threads": threads},
                                     mixture, marks, lines)
            self._annotate(image, "slice", transfer, look, dict(annotations))
            image._ranged = True  # the same colours in all frames
            return image

        _movies.write(os.fspath(path), len(shown), draw, "slices", fps,
                      overwrite, background, progress_of(progress))

    def _sheet_look(self, look: Union[Look, str, None]
                    ) -> tuple[Any, Optional[_channels.Mixture]]:
        """The look of all slices, in the colours of one."""
        if self._mixed is not None and not isinstance(look, _snowglass.Transfer):
            mixture = self._mixed.mixture(self, look_of(look), "slice", {},
                                          lambda each: each)
            if mixture:
                return mixture.transfers[0], mixture
        return self._slice_transfer(look), None

    def _draw_sheet(self, axis: Optional[str], columns: int, rows: int,
                    at: tuple[float, ...], indices: Sequence[int], transfer: Any,
                    mixture: Optional[_channels.Mixture], look: Any,
                    size: Union[int, Sequence[int], None], letters: bool,
                    settings: Mapping[str, Any], lines: _overlays.Lines,
                    progress: Progress) -> Image:
        width, height = _sides(0 if size is None else size)
        first: _snowglass.Volume = mixture.volumes[0] if mixture else self
        image, places = first._slices(
            Image, transfer, axis, columns, rows, (at[0], at[1], at[2]), indices,
            width, height, settings,
            (mixture.layers() if mixture else ()) + lines.layers,
            mixture is not None, mixture.shares[0] if mixture else 1.0,
            lines.outline, progress_of(progress))
        annotations: dict[str, Any] = {"letters": False, "legend": False}
        if letters:
            annotations["texts"] = _sheet_texts(places, axis is not None)
        self._annotate(image, "slice", transfer, look, annotations)
        image.stats = {"indices": [place[0] for place in places]}
        return image

    def slice_values(self, axis: Union[str, int] = "axial",
                     at: Union[int, str, None] = None, *,
                     size: Union[int, Sequence[int], None] = None,
                     kernel: Optional[str] = None, threads: int = 0
                     ) -> "numpy.typing.NDArray[Any]":
        """The same in data units: float32 of shape (height, width), NaN where
        there is no value.  Row 0 is on top, so that of an array without a patient
        `volume.slice_values("z", n)[::-1]` is array[n]."""
        import numpy
        along, index, _ = self._find_slice(self._axis_name(axis), at)
        return numpy.asarray(self._draw_slice(
            along, index, None, size, {"kernel": kernel, "threads": threads}))

    def _slice_transfer(self, look: Union[Look, str, None]) -> Any:
        """Labels are drawn as such where nothing else is asked, as in a
        picture."""
        if not isinstance(look, _snowglass.Transfer) and \
                colors_are_open(look_of(look)):
            chosen = self._transfer(look)
            if chosen.labelled:
                return chosen
        return self._transfer(look, "slice")

    def _draw_slice(self, along: int, index: int, transfer: Any,
                    size: Union[int, Sequence[int], None],
                    settings: Mapping[str, Any],
                    mixture: Optional[_channels.Mixture] = None,
                    marks: Optional[tuple[Any, ...]] = None,
                    lines: _overlays.Lines = _overlays.Lines((), False)) -> Image:
        width, height = _sides(0 if size is None else size)
        first = mixture.volumes[0] if mixture else self
        return first._slice(Image, "xyz"[along], index, transfer, width, height,
                            settings,
                            (mixture.layers() if mixture else ()) + lines.layers,
                            mixture is not None,
                            mixture.shares[0] if mixture else 1.0, marks,
                            lines.outline)

    def _slice_alone(self, along: int, index: int,
                     channel: Optional[_snowglass.Volume] = None) -> "Volume":
        """A slice, or one of another channel, as a volume of its own, as the
        command line reads it: looks are chosen from its values."""
        import numpy
        info = (channel or self)._info
        array: Any = numpy.asarray(memoryview(channel or self))  # type: ignore[arg-type]
        turned = array if channel else array.transpose(
            [self._order.index(n) for n in range(3)])
        voxels = numpy.take(turned, [index], axis=2 - along)
        matrix = numpy.array(info["matrix"])
        matrix[:, 3] += matrix[:, along] * index
        made = _snowglass.wrap(
            Volume, numpy.ascontiguousarray(voxels), (0, 1, 2),
            matrix.ravel().tolist(), info["slope"], info["intercept"],
            info["medical"], info["unit"], self)
        return made

    def _axis_name(self, axis: Union[str, int]) -> str:
        if isinstance(axis, str):
            return axis
        try:
            return self._axes[operator.index(axis)]
        except (TypeError, IndexError) as error:
            raise _checks.fault(
                "axis", "'axial', 'coronal', 'sagittal', 'x', 'y', 'z', or 0 to 2 for "
                "a dimension of the array (at= is the slice's number)", axis,
                TypeError if isinstance(error, TypeError) else ValueError) from None

    def _find_slice(self, axis: str, at: Union[int, str, None]
                    ) -> tuple[int, int, float]:
        """The grid's axis, the slice's number, and where its middle lies along
        the nearest axis of the world."""
        inner = axis.lower()
        if inner in ("x", "y", "z"):  # which may lie otherwise in memory
            columns = _arrays.columns_of(self._order, self._axes)
            inner = "xyz"[columns.index("xyz".index(inner))]
        along, world = self._slice_axis(inner)
        dims, row = self._info["dims"], self._info["matrix"][world]
        unit = self._info["unit"] or "mm"
        first = row[3] + sum(row[n] * (dims[n] - 1) / 2
                             for n in range(3) if n != along)
        index: float = dims[along] // 2
        if isinstance(at, str):
            number = at.strip().rstrip("abcdefghijklmnopqrstuvwxyz\N{MICRO SIGN}")
            own = at.strip()[len(number):]
            ratio = _arrays.unit_ratio(own, unit) if own else 0
            try:
                index = float(number) if ratio or not own else float("nan")
            except ValueError:
                index = float("nan")
            if ratio and index == index:
                index = round((ratio * index - first) / row[along]) \
                    if row[along] else -1
        elif at is not None:
            index = _whole("at", at, f"a slice's number, 0 to {dims[along] - 1}, or a "
                                     f"position with its unit, such as '12.5{unit}'")
        if not 0 <= index < dims[along] or index != int(index):
            last = first + row[along] * (dims[along] - 1)
            raise ValueError(
                f"there is no slice {at!r} across {axis}: give 0 to "
                f"{dims[along] - 1}, or a position from '{first:g}{unit}' to "
                f"'{last:g}{unit}'")
        return along, int(index), first + row[along] * index

    @takes(Movie)
    def turntable(self, path: Path, look: Union[Look, str, None] = None, *,
                  frames: int = DEFAULTS["frames"], fps: float = DEFAULTS["fps"],
                  overwrite: bool = False, **options: Unpack[Movie]) -> None:
        """Pictures of a whole turn, with one frame for all of them: files by a
        pattern such as "turn_%04d.png", or a movie: .webp, or .mp4, .webm and .gif,
        for which ffmpeg must be installed.  Files that are there stay, and
        snowglass.Error says so, unless they are to be overwritten.  Other options
        are those of render, and `background` that of Image.save."""
        given = _given(options)
        if options.get("background", "") is None:  # transparent
            given["background"] = None
        progress = progress_of(given.pop("progress", None))
        _movies.turntable(self, os.fspath(path), _given_look(look, given), frames,
                          fps, overwrite, progress, given)

    @takes(Picture)
    def view(self, look: Union[Look, str, None] = None, *, height: int = 540,
             **options: Unpack[Picture]) -> Any:
        """A snowglass.Viewer: the volume to turn, cut and colour in a notebook; a
        picture where the package anywidget is not installed, and a warning that
        names it.  `height` is that of the cell in pixels."""
        from .viewer import Viewer
        return Viewer(self, look, height=height, **options)


CANNOT_READ = 3  # of the statuses of the library
#: Strengths of the lights, and the exponent of the last: the parts of `material`.
MATERIAL = ("ambient", "diffuse", "specular", "shininess")
#: Views by the axes of the picture, as of PyVista.
SIDES = {"xy": "+z", "xz": "-y", "yz": "+x"}
#: What else to give.
VIEW = "a name of snowglass.views(), such as 'anterior', or a camera by position, " \
       "target and up"


def _sheet_texts(places: Sequence[Any], numbered: bool
                 ) -> tuple[tuple[float, float, float, float, float, str], ...]:
    """Numbers of slices, and the letters of their edges, where the command line
    draws them."""
    texts = []
    for n, (index, x, y, width, height, edges) in enumerate(places):
        side = min(width, height)
        tall = float(max(9, round(0.06 * side)))
        margin = 0.02 * min(places[0][3:5])
        for letter, across, down in zip(edges, (0, 1, .5, .5), (.5, .5, 0, 1)):
            if letter and (n == 0 or not numbered):
                texts.append((x + margin + across * (width - 2 * margin),
                              y + margin + down * (height - 2 * margin),
                              across, down, tall, letter))
        tall = float(max(9, round(0.05 * side)))
        if numbered:
            texts.append((x + 0.6 * tall, y + 0.6 * tall, 0, 0, tall, str(index)))
    return tuple(texts)


def _whole(name: str, value: Any, give: str) -> int:
    try:
        return operator.index(value)
    except TypeError:
        raise _checks.fault(name, give, value) from None


def _labels(given: Any) -> Optional[str]:
    """Labels as the command line has them."""
    if given is None or isinstance(given, str):
        return given
    each = list(given) if hasattr(given, "__iter__") else [given]
    try:
        if all(int(label) == label for label in each):
            return ",".join(str(int(label)) for label in each)
    except (TypeError, ValueError):
        pass
    raise _checks.fault("labels", "a whole number, several, or a text such as '1,4-7'",
                        given)


def _check_render(settings: Mapping[str, Any], view: Any, legend: Any) -> None:
    """What the core of a picture would refuse without a name."""
    settable = {"material", *_snowglass.names("settings")} - {*MATERIAL, "footprint"}
    if not settings.keys() <= settable:
        _checks.names(settings, ("look", *Picture.__annotations__), {
            **{name: "is an option of Volume: give it when the volume is opened"
               for name in (*_recipes.DATA, *_arrays.OPTIONS, "memory")},
            **{name: "is not drawn by Python: 'snowglass render' draws it"
               for name in ("annotate", "box")},
            **{name: "is an option of Image.save" for name in ("title", "background")}})
    _checks.text("view", view, VIEW)
    _check_legend(legend)


def _marks_of(annotations: Mapping[str, Any], mode: str, transfer: Any
              ) -> Optional[tuple[Any, ...]]:
    """Of the annotations what needs a strip of the picture, for the core."""
    if not annotations["legend"] and not annotations["scale_bar"]:
        return None
    none = (math.nan, math.nan)
    # Sums are not known yet: room for numbers of such a magnitude.
    range = (-1e4, 1e4) if mode in ("mean", "sum") else \
        none if mode == "over" else transfer.domain or none
    return (annotations["legend"], annotations["unit"], range,
            annotations.get("bars"))


def _given(options: Mapping[str, Any]) -> dict[str, Any]:
    """Those that are."""
    return {name: value for name, value in options.items() if value is not None}


def _emptiness(mode: str, settings: Mapping[str, Any], stats: Mapping[str, Any]
               ) -> str:
    """Why nothing is seen, as the command line says it
    (programs/picture/warnings.c)."""
    if mode == "iso":
        return f"the picture is empty: no surface of value " \
               f"{settings.get('iso', 0):g} is in view; volume.statistics has the " \
               f"range of values"
    if mode == "over" and stats["interesting"] == 0:
        threshold = settings.get("threshold") or 0
        least = f"threshold={threshold:g}" if threshold else "0"
        return f"the picture is empty: no voxel has an opacity above {least}; " \
               f"volume.statistics has the range of values, opacity= sets which " \
               f"are visible"
    return "the picture is empty: no visible voxel is in view; check target=, " \
           "position=, zoom= and clip="


def _check_legend(legend: Any) -> None:
    if legend not in (None, False, True):
        _checks.text("legend", legend, "True, a title such as 'T (K)', or 'scale'")


def _given_look(look: Union[Look, str, None], options: dict[str, Any]
                ) -> Union[Look, str, None]:
    """A look, or one of the keys of looks that are taken out of the options."""
    colors = _recipes.take_look(options)
    if look is not None and colors:
        raise TypeError("give a look, or keys of one, not both")
    return Look(**colors) if colors else look


def _chosen(look: Union[Look, str, None], mode: str) -> Look:
    """Projections and slices are grey unless a look says otherwise."""
    chosen = look_of(look)
    if mode not in ("over", "iso") and \
            chosen.preset is None and chosen.colors is None:
        chosen = dataclasses.replace(chosen, preset="linear")
        # Over the file's window, or all values but a few far off.
        if not is_ranged(chosen):
            chosen = dataclasses.replace(
                chosen, range={"slice": "slices", "minip": "least"}.get(mode, "robust"))
    return chosen


def _sides(size: Any) -> tuple[int, int]:
    """Width and height; one number, of NumPy too, is both."""
    try:  # arrays have __index__ too, which fails
        return operator.index(size), operator.index(size)
    except TypeError:
        pass
    try:
        width, height = size
        return operator.index(width), operator.index(height)
    except (TypeError, ValueError):
        raise ValueError(f"size {size!r}: give (width, height) in pixels, or one "
                         f"number for both") from None


def _set_light(light: Union[str, Sequence[float], None],
               settings: dict[str, Any]) -> None:
    if light is None:
        return
    if isinstance(light, str):
        settings["light"] = light
        return
    give = "'key', 'head' or (azimuth, elevation) in degrees"
    try:
        azimuth, elevation = light
    except (TypeError, ValueError) as error:
        raise _checks.fault("light", give, light, type(error)) from None
    settings["light"] = "direction"
    settings["light_azimuth"] = _checks.number("light", azimuth, give)
    settings["light_elevation"] = _checks.number("light", elevation, give)


def _set_material(settings: dict[str, Any]) -> None:
    material = settings.pop("material", None)
    if material is None:
        return
    give = f"four numbers ({', '.join(MATERIAL)})"
    try:
        given = tuple(material)
    except TypeError:
        raise _checks.fault("material", give, material) from None
    if isinstance(material, str) or len(given) != len(MATERIAL):
        raise _checks.fault("material", give, material, ValueError)
    for name, value in zip(MATERIAL, given):
        settings[name] = _checks.number("material", value, give)


def _set_kernel(settings: dict[str, Any]) -> None:
    """A name, which the core checks, and its support."""
    kernel = settings.get("kernel")
    if not isinstance(kernel, str) or ":" not in kernel:
        return
    settings["kernel"], _, support = kernel.partition(":")
    if support not in tuple("23456789"):
        raise _checks.fault("kernel", "NAME:N with a support N of 2 to 9 voxels",
                            kernel, ValueError)
    settings["footprint"] = int(support)


@takes(Source)
def open(source: Path, **options: Unpack[Source]) -> Volume:
    """A volume of a file: `Volume(source, ...)`."""
    return Volume(source, **options)


@takes(Whole)
def render(source: Any = None, look: Union[Look, str, None] = None, *,
           input: Any = None, **given: Unpack[Whole]) -> Image:
    """A picture of a file, an array or a Volume; `open` holds options of Volume,
    which may be given beside it, but for `unit`; the others are those of Volume.render, or keys of a recipe: what
    `Image.recipe` gives and the command line saves, `render(**recipe)` draws,
    with the same bits.  A title is drawn when the picture is saved, on its
    background if one is given.  What such a file says else of its output is left out,
    annotate and box with a warning.  Of a
    Volume clip, crop, time, channel, component and labels are taken, as its
    viewer has them: a crop counts the Volume's voxels, and a file is read again.
    With an axis it is a recipe of a slice, which Volume.slice draws."""
    keys = dict(given)
    opened: Any = keys.pop("open", None) or {}
    for name in ("annotate", "box"):
        if keys.get(name):
            warn(f"{name} is not drawn by Python: 'snowglass render' draws it")
    title = _checks.text("title", keys.get("title"), "a line of text")
    ground: Any = keys.get("background", "auto")
    chosen = not isinstance(ground, str) or ground != "auto"
    color = color_of(ground) if chosen else None
    data, colors, options = _recipes.split(keys)
    sliced = "axis" in options or "at" in options
    if sliced:
        _recipes.check_slice(options)
    if (source is None) == (input is None):
        raise TypeError("give a volume, as in snowglass.render(volume, **recipe) of an "
                        "array's recipe, or input: the path of one")
    if look is not None and colors is not None:
        raise TypeError("give a look, or keys of one, not both")
    volume = source if source is not None else input
    if not isinstance(volume, Volume):
        volume = Volume(volume, progress=options.get("progress"),
                        **{**data, **opened})
    else:
        from . import _drawing
        volume = _drawing.part(volume, {**data, **opened})
    if look is None:
        look = colors
    if sliced:
        image = volume.slice(look=look, **options)
    else:  # a key that no picture has is refused there
        image = volume.render(
            look, **_recipes.with_lengths(options, volume.info["unit"]))
    if title:
        image._annotations = {**image._annotations, "title": title}
    if chosen:
        image._background = color
    return image


class Step(Volume):
    """A volume of a series; `index` is its number.  It is closed when the next
    one is asked for."""
    index: int = 0
    path: str = ""
    _times: int = 1


@takes(Source)
def series(pattern: Union[Path, Sequence[Path]], **given: Unpack[Source]
           ) -> Iterator[Step]:
    """The volumes of a series, one after the other: files by a pattern such as
    "run_%04d.h5" or "run_*.h5", a list of files, or the time steps of one file.
    Options are those of Volume.  `index` of a step is the number in its name, or
    its place among the files.  A step is closed when the next one is asked for, so that no
    more than one is in memory, unless arrays of its voxels are in use."""
    options: dict[str, Any] = dict(given)
    if not isinstance(pattern, (str, os.PathLike)):
        paths = [(n, os.fspath(each)) for n, each in enumerate(pattern)]
    else:
        paths = _files_of(os.fspath(pattern))
    if not paths:
        return
    index, path = paths[0]
    if len(paths) == 1 and options.get("time") is None:
        options["each_time"] = True
    step = _step(index, path, options)
    yield step
    times = step._times if "each_time" in options else 1
    later = [(time, path, {**options, "time": time})
             for time in range(1, times)] or \
        [(index, path, options) for index, path in paths[1:]]
    for each in later:
        try:
            step.close()
        except BufferError:
            pass
        step = _step(*each)
        yield step


def _step(index: int, path: str, options: Mapping[str, Any]) -> Step:
    step = Step(path, **options)
    step.index, step.path, step._times = index, path, step._info["times"]
    return step


def _files_of(pattern: str) -> list[tuple[int, str]]:
    number = re.search(r"%(0?)(\d*)d", pattern)
    if not number and re.search(r"[*?[]", pattern) and not os.path.exists(pattern):
        return _files_like(pattern)
    if not number:
        return [(0, pattern)]
    folder = os.path.dirname(pattern) or "."
    if number.start() < len(pattern) - len(os.path.basename(pattern)):
        raise ValueError(f"{pattern}: the number must be in the file's name")
    before, after = pattern[:number.start()], pattern[number.end():]
    name = re.compile(re.escape(os.path.basename(before)) + r"(\d+)" +
                      re.escape(after) + "$")
    found = []
    for each in os.listdir(folder) if os.path.isdir(folder) else ():
        match = name.match(each)
        if match:
            index = int(match.group(1))
            path = before + number.group(0) % index + after
            if os.path.basename(path) == each:
                found.append((index, path))
    if not found:
        _snowglass.fail(CANNOT_READ, f"{pattern}: there is no such file")
    return sorted(found)


def _files_like(pattern: str) -> list[tuple[int, str]]:
    """Those of a pattern with *, ? or [...], by the numbers in their names."""
    import fnmatch
    import glob

    def order(path: str) -> list[Any]:
        parts = re.split(r"(\d+)", path)  # each second one is digits
        return [(int(part), part) if n % 2 else part
                for n, part in enumerate(parts)]
    folder, name = os.path.split(pattern)
    if glob.has_magic(folder):
        paths = glob.glob(pattern)
    else:  # glob passes over a folder that cannot be listed to its end
        paths = [os.path.join(folder, each)
                 for each in (os.listdir(folder or ".")
                              if os.path.isdir(folder or ".") else ())
                 if fnmatch.fnmatch(each, name) and
                 (each[0] != "." or name[0] == ".")]
    found = sorted(paths, key=order)
    if not found:
        _snowglass.fail(CANNOT_READ, f"{pattern}: there is no such file")
    return list(enumerate(found))
