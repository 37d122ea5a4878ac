"""Arrays of other libraries as volumes."""
from __future__ import annotations

import math
import os
from typing import Any, Mapping, NamedTuple, Optional, Sequence

from . import _checks, _recipes, _snowglass
from ._warnings import warn


class Wrapped(NamedTuple):
    """What the core's `wrap` takes; the array is C contiguous."""
    array: Any
    order: tuple[int, ...]   #: that the given dimensions have in memory
    axes: str                #: what the given dimensions are
    matrix: list[float]
    slope: float
    intercept: float
    medical: bool
    unit: str
    frozen: bool
    window: Optional[tuple[float, float]]  #: that the image asks for
    meaning: tuple[str, str, str]  #: the values' name, unit and description


#: What `wrap` takes beside the array.
OPTIONS = ("spacing", "affine", "axes", "unit", "medical", "slope", "intercept",
           "copy", "frozen")

#: The least determinant of the three directions, as in src/volume/matrix.c.
FLATTEST = 1e-6

#: Where arrays are, in words of DLPack.
PROCESSOR = (1, 0)

#: What else to give.
SLOPE = "a finite number other than 0; 1 leaves the values as they are"
UNIT = "the name of a length, such as 'mm'"
AXES = "the order of the dimensions, such as 'zyx' or 'xyz'"
AFFINE = "a 4x4 matrix of finite numbers whose last row is 0, 0, 0, 1"

#: Units of coordinates that grow downward, as in src/formats/cf.c.
PRESSURES = ("pa", "hpa", "kpa", "bar", "mbar", "mb", "millibar", "millibars",
             "decibar", "dbar", "atm")


def check_options(options: Mapping[str, Any]) -> None:
    for name in options:
        if name in OPTIONS:
            continue
        if name == "time":
            raise TypeError("time counts for files only: choose the step of the array, as "
                            "array[0], or array.sel(time=...) of xarray")
        if name in _recipes.DATA:
            raise TypeError(f"{name} counts for files only: save() the array as "
                            f".nrrd and open that with it")
        raise TypeError(f"an array has no option '{name}'; take one of "
                        f"{', '.join(OPTIONS)}")


def wrap(source: Any, *, spacing: Any = None, affine: Any = None,
         axes: Optional[str] = None, unit: Optional[str] = None,
         medical: Optional[bool] = None, slope: float = 1, intercept: float = 0,
         copy: Optional[bool] = None, frozen: bool = True) -> Wrapped:
    """Any source as an array, and its place in the world."""
    import numpy
    meaning = _meaning_of(source)
    window = _window_of(source) if _is_nibabel(source) else None
    given_place = affine is not None
    if _is_nibabel(source):
        if affine is None and spacing is None:
            affine = _affine_in_mm(source)
        axes = axes or "xyz"
        unit, medical = unit or "mm", True if medical is None else medical
        if slope == 1 and intercept == 0:
            source, slope, intercept = _stored_values(source.dataobj)
        else:
            source = numpy.asanyarray(source.dataobj)
    elif _is_xarray(source):
        source, spacing, axes, unit, affine = _of_xarray(source, spacing, axes,
                                                         unit, affine)
    array = _to_array(source)
    if given_place and axes in (None, "xyz") and _is_fortran(array):
        if axes is None:
            warn("affine= with an array in Fortran order: its dimensions are taken "
                 "for [x, y, z], and its world for a patient's, as nibabel has them; "
                 "axes= says so, or 'zyx'")
        axes, unit = "xyz", "mm" if unit is None else unit
        medical = True if medical is None else medical
    elif axes is None and _is_fortran(array):
        warn("an array in Fortran order is taken for [z, y, x]: of an image of "
             "nibabel, whose order is [x, y, z], give the image itself, or "
             "affine=image.affine; axes='xyz' or 'zyx' says which it is")
    axes = axes or "zyx"
    if isinstance(axes, str) and len(axes) > 3:
        raise ValueError(f"axes={axes!r}: a volume has x, y and z; choose one of the "
                         f"others first, such as array[0], and give axes='zyx'")
    if sorted(_checks.text("axes", axes, AXES) or "") != ["x", "y", "z"]:
        raise _checks.fault("axes", AXES, axes, ValueError)
    array = _without_ones(array, axes)
    if array.ndim != 3:
        part = "make it one slice, such as array[None]" if array.ndim < 3 else \
            "choose one of the others, such as " + (
                "image.slicer[..., 0]" if axes == "xyz" else
                "array[..., 0]" if array.shape[-1] <= 4 else "array[0]") + (
                ", or draw all as Volume.channels" if array.ndim == 4 and
                array.shape[0] <= 8 and array.shape[-1] > 4 else "")
        raise TypeError(f"an array of shape {array.shape}: a volume has three "
                        f"dimensions [{', '.join(axes)}]; {part}")
    if 0 in array.shape:
        raise ValueError(f"an array of shape {array.shape} has no voxels")
    given = array
    array, order = _contiguous(_plain_type(array, copy), copy)
    if copy and numpy.may_share_memory(array, given):
        array = array.copy()
    matrix = _matrix(spacing, affine, "affine" if given_place else
                     "affine of the image")
    slope = _checks.number("slope", slope, SLOPE)
    if slope == 0:
        raise _checks.fault("slope", SLOPE, slope, ValueError)
    # Column n of the matrix belongs to dimension n of the voxels, x first.
    placed = matrix[:, columns_of(order, axes) + [3]]
    return Wrapped(array, order, axes, [float(each) for each in placed.ravel()],
                   slope, _checks.number("intercept", intercept, "a finite number"),
                   bool(medical), _cut(_checks.text("unit", unit, UNIT) or ""),
                   frozen, window, meaning)


def _is_fortran(array: Any) -> bool:
    """Whether the first dimension is the fastest, as of nibabel's data and of
    parts of them."""
    steps = [abs(step) for step, size in zip(array.strides, array.shape)
             if size > 1]
    return array.ndim >= 3 and len(steps) > 1 and steps == sorted(steps) and \
        steps[0] < steps[-1]


def _without_ones(array: Any, axes: str) -> Any:
    """Without time and components of which there is one: first dimensions, or
    last ones."""
    if array.ndim > 4 and array.shape[-1] == 1:  # of (t, z, y, x, channel)
        array = array[..., 0]
    while array.ndim > 3 and axes != "xyz" and array.shape[0] == 1:
        array = array[0]
    while array.ndim > 3 and array.shape[-1] == 1:
        array = array[..., 0]
    return array


def _meaning_of(source: Any) -> tuple[str, str, str]:
    """Name, unit and description that an array of xarray, HDF5, Zarr or netCDF4 has
    of its values, as snow_cf_name takes them from files."""
    said: Any = getattr(source, "attrs", None)
    if hasattr(source, "ncattrs"):
        said = {name: source.getncattr(name) for name in source.ncattrs()}
    if said is None or not hasattr(said, "get"):
        return "", "", ""

    def text(value: Any) -> str:
        if getattr(value, "shape", None) == (1,):  # as some write a text
            value = value[0]
        if isinstance(value, bytes):
            value = value.decode(errors="surrogateescape")
        if not isinstance(value, str):
            return ""
        # So h5py keeps bytes that are no UTF-8, too; as in files each is "?".
        return value.replace("\0", "").encode(errors="replace").decode()
    name = text(getattr(source, "name", None)).rpartition("/")[2]
    return name, text(said.get("units")), \
        text(said.get("long_name")) or text(said.get("standard_name"))


def columns_of(order: Sequence[int], axes: str) -> list[int]:
    """Which of x, y, z each dimension in memory is, fastest first."""
    return ["xyz".index(axes[list(order).index(n)]) for n in (2, 1, 0)]


def like(source: Any, shape: Sequence[int], order: Sequence[int],
         what: str = "a mask") -> Any:
    """An array of a shape as its dimensions lie in memory, C contiguous."""
    import numpy
    if _is_nibabel(source):
        source = source.dataobj
    array = _to_array(source)
    if array.shape != tuple(shape):
        raise ValueError(f"{what} of shape {array.shape} for a volume of shape "
                         f"{tuple(shape)}: they must be the same")
    turned = array.transpose([list(order).index(n) for n in range(3)])
    return numpy.ascontiguousarray(_plain_type(turned, True))


def _cut(unit: str) -> str:
    """At most the 15 bytes that the library keeps, no half characters."""
    return unit.encode()[:15].decode(errors="ignore")


def _affine_in_mm(image: Any) -> Any:
    """As the library reads files: NIfTI may be in metres or micrometres."""
    import numpy
    units = getattr(image.header, "get_xyzt_units", lambda: ("mm",))()
    factor = {"meter": 1000.0, "micron": 0.001}.get(str(units[0]), 1.0)
    matrix = numpy.diag([*image.header.get_zooms()[:3], 1.0]) \
        if image.affine is None else image.affine
    return numpy.diag([factor, factor, factor, 1]) @ matrix


def _window_of(image: Any) -> Optional[tuple[float, float]]:
    """cal_min and cal_max of NIfTI, as the library takes those of files."""
    try:
        head = image.header
        low, high = float(head["cal_min"]), float(head["cal_max"])
        labels = int(head["intent_code"]) == 1002
    except (AttributeError, IndexError, KeyError, TypeError, ValueError):
        return None
    return (low, high) if -math.inf < low < high < math.inf and not labels \
        else None


def _stored_values(data: Any) -> tuple[Any, float, float]:
    """Those of a file, which nibabel would multiply out to float64."""
    import numpy
    for name in ("get_unscaled", "slope", "inter"):  # PAR/REC has a slope a slice
        if not hasattr(data, name):
            return numpy.asanyarray(data), 1, 0
    return data.get_unscaled(), float(data.slope), float(data.inter)


def _is_nibabel(source: Any) -> bool:
    return hasattr(source, "dataobj") and hasattr(source, "affine")


def file_of(image: Any) -> Optional[str]:
    """The path of an image of nibabel that was loaded and has the voxels of its file
    still."""
    if not _is_nibabel(image) or not getattr(image.dataobj, "is_proxy", False):
        return None
    path = getattr(image, "get_filename", lambda: None)()
    return None if path is None else os.fspath(path)


def _is_xarray(source: Any) -> bool:
    return hasattr(source, "dims") and hasattr(source, "coords") and \
        hasattr(source, "values") and not hasattr(source, "data_vars")


def _of_xarray(source: Any, spacing: Any, axes: Optional[str],
               unit: Optional[str], affine: Any) -> tuple[Any, ...]:
    # Times and the like, of which there is one.
    source = source.squeeze([name for name in source.dims if source.sizes[
        name] == 1][:max(source.ndim - 3, 0)])
    if source.ndim == 2:  # a map: one slice
        source = source.expand_dims("one slice")
    names = [str(name) for name in source.dims]
    if axes is None:
        named = {"x", "y"} <= set(names) and len(names) == 3
        axes = "".join(name if name in ("x", "y") else "z" for name in names) \
            if named else "zyx"
    if spacing is None and affine is None and len(names) == 3:
        affine, found = _place_of(source, dict(zip(axes, names)))
        unit = unit or found
    for name in names[:-2] if len(names) == 3 else ():
        if source.sizes[name] > 1 and (
                name == "time" or source[name].dtype.kind in "mM"):
            warn(f"dimension '{name}' is drawn as a direction of space: "
                 f".isel({name}=0) chooses one step")
    return source, spacing, axes, unit, affine


def _place_of(source: Any, names: Mapping[str, str]) -> tuple[Any, str]:
    """The matrix of its coordinates, and the unit of x, as snow_cf_place has them
    of files.  Other lengths become that unit.  An axis with another unit, or with
    none beside one, cannot be compared with x: a metre is not longer than a
    degree.  It has the spacing of x; z beside degrees a height of a third of the
    shorter side."""
    import numpy
    found = {axis: _coordinate(source, names[axis]) for axis in "xyz"}
    x = found["x"]
    affine = numpy.eye(4)
    same = {axis: at.given and unit_ratio(at.unit, x.unit) for axis, at in found.items()}
    for n, axis in enumerate("xyz"):
        step, first, unit, given = found[axis]
        metres = unit_ratio(unit, "m")
        ratio = same[axis] or (metres / DEGREE if metres and x.unit == "degrees"
                               else abs(x.step / step))
        if given and not same[axis]:
            warn(f"coordinate '{names[axis]}' has another unit ({unit!r}) than x "
                 f"({x.unit!r}): it has a height of its own; spacing= gives another")
        affine[n, n] = step * ratio if given else abs(x.step)
        affine[n, 3] = first * ratio if given and unit not in TIMES else 0
    sides = [abs(affine[n, n]) * (source.sizes[names[axis]] - 1)
             for n, axis in enumerate("xyz")]
    if x.given and same["y"] == 1 and not same["z"] and x.unit == "degrees" and \
            min(sides) > 0:
        affine[2] *= min(sides[:2]) / 3 / sides[2]
    return affine, x.unit if x.given else ""


#: Units of steps in time, which a file begins at 0 of space.
TIMES = ("s", "ms", "us", "ns", "min", "minutes", "h", "hours", "days", "years")
#: Metres in a degree of a sphere as large as the earth.
DEGREE = 111195.0


class _Coordinate(NamedTuple):
    step: float = 1.0
    first: float = 0.0
    unit: str = ""
    given: bool = False


def unit_ratio(unit: str, other: str) -> float:
    """How many of the other unit one is; 0 if they cannot be compared."""
    if unit == other:
        return 1.0
    one, another = (_snowglass.length_unit(each)[0] for each in (unit, other))
    return one / another if another else 0.0


def _coordinate(source: Any, name: str) -> _Coordinate:
    import numpy
    if name not in source.coords:
        return _Coordinate()
    attributes = source.coords[name].attrs
    unit = str(attributes.get("units", ""))
    positive = str(attributes.get("positive", "")).lower()
    up = -1 if (positive == "down" if positive else unit.lower() in PRESSURES) else 1
    unit = "degrees" if unit.startswith("degree") else \
        _snowglass.length_unit(unit)[1] or unit
    places = numpy.asarray(source.coords[name].values)
    if places.dtype.kind not in "iuf" or len(places) < 2:
        return _Coordinate(unit=unit)
    each = numpy.diff(places.astype(float))
    step, first = float(each.mean()), float(places[0])
    if not (math.isfinite(step) and math.isfinite(first) and step):
        return _Coordinate(unit=unit)
    if abs(each.max() - each.min()) > 1e-3 * abs(step):
        warn(f"coordinate '{name}' is not evenly spaced: its mean step is taken; of "
             f"a file of it, as to_netcdf() writes, the slices would be resampled")
    return _Coordinate(up * step, up * first, unit, True)


def _volumes_first(group: Any) -> list[str]:
    names = [str(name) for name in group.keys()]
    if hasattr(group, "attrs"):  # an .npz would read them
        names.sort(key=lambda name: getattr(group[name], "ndim", 0) != 3)
    return names


def _first_path(group: Any, deep: int = 4) -> str:
    """The path of the first array, through groups in the group."""
    first = (_volumes_first(group) or ["name"])[0]
    inner = group[first] if hasattr(group, "attrs") and first in group else None
    if deep and hasattr(inner, "keys"):
        return f"{first}/{_first_path(inner, deep - 1)}"
    return first


def _to_array(source: Any) -> Any:
    import numpy
    array = _computed(source)
    if isinstance(array, numpy.ma.MaskedArray):
        if not array.mask.any():
            return array.data
        wide = array.dtype if array.dtype.kind == "f" else \
            numpy.float32 if array.dtype.itemsize < 4 else numpy.float64
        kept: Any = array.astype(wide)
        return kept.filled(numpy.nan)
    if isinstance(array, numpy.ndarray):
        return array
    kind = type(source).__name__
    _refuse_others(source, kind)
    if hasattr(source, "__dlpack__") and not hasattr(source, "__array__"):
        try:
            return numpy.from_dlpack(source)
        except (BufferError, RuntimeError) as error:
            raise TypeError(f"a {kind} cannot be read by DLPack ({error}): give a copy "
                            f"that may be written to, in memory of this machine"
                            ) from None
    if hasattr(source, "__array__") or hasattr(source, "__array_interface__") \
            or hasattr(source, "__dlpack__"):
        return numpy.asarray(source)
    if isinstance(source, (list, tuple)):
        try:
            return numpy.asarray(source)
        except ValueError:
            raise ValueError(f"a {kind} whose parts differ in shape is no volume: "
                             f"give slices of one shape") from None
    try:
        return numpy.asarray(memoryview(source))
    except (TypeError, ValueError, BufferError):
        raise TypeError(f"a volume must be a path, an array, or an image of "
                        f"nibabel or xarray, not {kind}") from None


def _computed(source: Any) -> Any:
    """The array of numpy, perhaps masked, that an array of dask or xarray, a
    variable of netCDF4, or a list of any arrays stands for; others as they are.
    numpy.asarray() would drop the masks."""
    import numpy
    masked: Any = numpy.ma
    if _is_xarray(source):
        return _computed(source.data) if hasattr(source.data, "dask") else \
            source.values
    if hasattr(source, "compute") and hasattr(source, "dask"):
        return source.compute()
    if hasattr(type(source), "set_auto_mask") and hasattr(type(source), "dtype"):
        return source[...]  # masks and scales itself
    if isinstance(source, (list, tuple)) and source and all(
            hasattr(each, "__array__") or hasattr(each, "__array_interface__")
            for each in source):
        parts = [masked.asanyarray(_computed(each)) for each in source]
        if len({part.shape for part in parts}) == 1:
            return masked.stack(parts)
    return source


def _refuse_others(source: Any, kind: str) -> None:
    """Refuses what holds arrays, or resembles one."""
    group = source if hasattr(type(source), "keys") or \
        not hasattr(type(source), "variables") \
        else source.variables
    if hasattr(source, "iloc"):
        raise TypeError(f"a {kind} is a table: give an array of three dimensions, such "
                        f"as table.to_numpy().reshape(z, y, x)")
    if hasattr(group, "keys"):  # a group of HDF5 or Zarr, a Dataset, an .npz
        names = _volumes_first(group)
        raise TypeError(f"a {kind} holds several arrays: choose one of them, "
                        f"such as {kind.lower()}[{_first_path(group)!r}] "
                        f"(there are {', '.join(names[:9]) or 'none'})")
    if getattr(source, "n_frames", 1) > 1:
        raise TypeError(f"a {kind} of {source.n_frames} frames shows one of them at a "
                        f"time: give the path of its file")
    if isinstance(source, (list, tuple)) and source and \
            all(isinstance(each, (str, os.PathLike)) for each in source):
        raise TypeError("a list of files is no volume: name their folder, or a "
                        "pattern such as 'slices/ct_*.tif'")


def _plain_type(array: Any, copy: Optional[bool]) -> Any:
    """One of the ten types that volumes have, in the machine's byte order."""
    import numpy
    if array.dtype == bool:
        return array.view(numpy.uint8)
    if array.dtype.kind not in "iuf" or array.dtype.itemsize > 8:
        way = "give the path of its file, or one of its fields" \
            if array.dtype.names else "convert it"
        raise TypeError(f"an array of {array.dtype}: volumes have integers or "
                        f"floats of up to 64 bits; {way}")
    wanted = array.dtype.newbyteorder("=")
    if wanted == numpy.float16:
        wanted = numpy.dtype(numpy.float32)
    if array.dtype == wanted:
        return array
    _refuse_copy(copy, f"{array.dtype} is not {wanted}")
    return array.astype(wanted)


def _contiguous(array: Any, copy: Optional[bool]
                ) -> tuple[Any, tuple[int, ...]]:
    """Its dimensions in the order of memory, and where each of them went."""
    import numpy
    if array.flags.c_contiguous:
        return array, (0, 1, 2)
    slowest = sorted(range(3), key=lambda n: -abs(array.strides[n]))
    turned = array.transpose(slowest)
    if turned.flags.c_contiguous:
        return turned, tuple(slowest.index(n) for n in range(3))
    _refuse_copy(copy, "its memory has gaps or runs backwards")
    return numpy.ascontiguousarray(array), (0, 1, 2)


def _refuse_copy(copy: Optional[bool], why: str) -> None:
    if copy is False:
        raise ValueError(f"the array cannot be used in place: {why}; allow a "
                         f"copy")
    if copy is None:
        warn(f"the array is copied: {why}")


def _affine(affine: Any, name: str) -> Any:
    import numpy
    try:
        matrix = numpy.array(affine, float)
    except (TypeError, ValueError):
        raise _checks.fault(name, AFFINE, affine) from None
    if matrix.shape != (4, 4):
        raise ValueError(f"affine of shape {matrix.shape}: it must be 4x4")
    if not numpy.isfinite(matrix).all() or matrix[3].tolist() != [0, 0, 0, 1]:
        raise _checks.fault(name, AFFINE, matrix.tolist(), ValueError)
    lengths = numpy.linalg.norm(matrix[:3, :3], axis=0)
    if not lengths.all() or \
            abs(numpy.linalg.det(matrix[:3, :3] / lengths)) < FLATTEST:
        raise ValueError(f"{name}: it is singular: each of its first three columns is "
                         f"the step of an axis, not zero, and the three are not in "
                         f"one plane; correct it, or give spacing")
    return matrix


def _matrix(spacing: Any, affine: Any, name: str) -> Any:
    import numpy
    if affine is not None:
        if spacing is not None:
            raise TypeError("give spacing or affine, not both")
        return _affine(affine, name)
    try:
        steps = numpy.broadcast_to(
            numpy.asarray(1 if spacing is None else spacing, float), 3)
    except (TypeError, ValueError):
        steps = numpy.zeros(3)
    if not (steps > 0).all() or not numpy.isfinite(steps).all():
        raise ValueError(f"spacing {spacing!r}: give three lengths above 0, "
                         f"along x, y, z")
    return numpy.diag([*steps, 1.0])


def converted(array: Any, dtype: Any, copy: Optional[bool]) -> Any:
    """What `__array__` returns of its own array."""
    if dtype is None or array.dtype == dtype:
        return array.copy() if copy else array
    if copy is False:
        import numpy
        raise ValueError(f"dtype {numpy.dtype(dtype)}: it needs a copy of the "
                         f"{array.dtype} that is there; leave out copy=False")
    return array.astype(dtype)
