"""Arrays of other libraries as volumes."""
from __future__ import annotations

import warnings
from typing import Any, NamedTuple, Optional, Sequence

from . import _snowglass


class Wrapped(NamedTuple):
    """What the core's `wrap` takes; the array is C contiguous."""
    array: Any
    matrix: list[float]
    slope: float
    intercept: float
    medical: bool
    unit: str
    frozen: bool


def wrap(source: Any, *, spacing: Any = None, affine: Any = None,
         axes: Optional[str] = None, unit: Optional[str] = None,
         medical: Optional[bool] = None, slope: float = 1, intercept: float = 0,
         copy: Optional[bool] = None, frozen: bool = True) -> Wrapped:
    """Any source as an array, and its place in the world."""
    import numpy
    if _is_nibabel(source):
        affine = source.affine if affine is None and spacing is None else affine
        axes = axes or "xyz"
        unit, medical = unit or "mm", True if medical is None else medical
        source = numpy.asanyarray(source.dataobj)
    elif _is_xarray(source):
        source, spacing, axes, unit, affine = _of_xarray(source, spacing, axes,
                                                         unit, affine)
    array = _to_array(source)
    axes = axes or "zyx"
    if sorted(axes) != ["x", "y", "z"]:
        raise ValueError(f"axes '{axes}': give the order of the dimensions, "
                         f"such as 'zyx' or 'xyz'")
    if array.ndim != 3:
        raise TypeError(f"an array of shape {array.shape}: a volume has three "
                        f"dimensions [{', '.join(axes)}]; choose one of the "
                        f"others, such as array[0]")
    if 0 in array.shape:
        raise ValueError(f"an array of shape {array.shape} has no voxels")
    array, axes = _contiguous(_plain_type(array, copy), axes, copy)
    matrix = _matrix(spacing, affine)
    # Column n of the matrix belongs to dimension n of the voxels, x first.
    columns = ["xyz".index(name) for name in reversed(axes)]
    placed = matrix[:, columns + [3]]
    return Wrapped(array, [float(each) for each in placed.ravel()],
                   float(slope), float(intercept), bool(medical), unit or "",
                   frozen)


def _is_nibabel(source: Any) -> bool:
    return hasattr(source, "dataobj") and hasattr(source, "affine")


def _is_xarray(source: Any) -> bool:
    return hasattr(source, "dims") and hasattr(source, "coords") and \
        hasattr(source, "values")


def _of_xarray(source: Any, spacing: Any, axes: Optional[str],
               unit: Optional[str], affine: Any) -> tuple[Any, ...]:
    import numpy
    names = [str(name) for name in source.dims]
    if axes is None:
        axes = "".join(names) if sorted(names) == ["x", "y", "z"] else "zyx"
    if spacing is None and affine is None and len(names) == 3:
        steps, origins = {}, {}
        for axis, name in zip(axes, names):
            steps[axis], origins[axis] = 1.0, 0.0
            if name not in source.coords or source.sizes[name] < 2:
                continue
            places = numpy.asarray(source.coords[name].values)
            if places.dtype.kind not in "iuf":
                continue
            each = numpy.diff(places.astype(float))
            if abs(each.max() - each.min()) > 1e-3 * abs(each.mean()):
                warnings.warn(f"coordinate '{name}' is not evenly spaced: its "
                              f"mean step is taken",
                              _snowglass.SnowglassWarning, stacklevel=4)
            steps[axis], origins[axis] = float(each.mean()), float(places[0])
            unit = unit or str(source.coords[name].attrs.get("units", "")) \
                or None
        affine = numpy.eye(4)
        for n, axis in enumerate("xyz"):
            affine[n, n], affine[n, 3] = steps[axis], origins[axis]
    return source.values, spacing, axes, (unit or "")[:15], affine


def _to_array(source: Any) -> Any:
    import numpy
    given: Any = source
    if isinstance(source, numpy.ma.MaskedArray):
        wide = numpy.float32 if source.dtype.itemsize < 4 else numpy.float64
        filled: Any = given.astype(wide).filled(numpy.nan)
        return filled
    if isinstance(source, numpy.ndarray):
        return source
    if hasattr(source, "__dlpack__") and not hasattr(source, "__array__"):
        return numpy.from_dlpack(source)
    if hasattr(source, "__array__") or hasattr(source, "__array_interface__") \
            or hasattr(source, "__dlpack__"):
        return numpy.asarray(source)
    try:
        return numpy.asarray(memoryview(source))
    except TypeError:
        raise TypeError(f"a volume must be a path, an array, or an image of "
                        f"nibabel or xarray, not {type(source).__name__}"
                        ) from None


def _plain_type(array: Any, copy: Optional[bool]) -> Any:
    """One of the ten types that volumes have, in the machine's byte order."""
    import numpy
    if array.dtype == bool:
        return array.view(numpy.uint8)
    if array.dtype.kind not in "iuf" or array.dtype.itemsize > 8:
        raise TypeError(f"an array of {array.dtype}: volumes have integers or "
                        f"floats of up to 64 bits; convert it")
    wanted = array.dtype.newbyteorder("=")
    if wanted == numpy.float16:
        wanted = numpy.dtype(numpy.float32)
    if array.dtype == wanted:
        return array
    _refuse_copy(copy, f"{array.dtype} is not {wanted}")
    return array.astype(wanted)


def _contiguous(array: Any, axes: str, copy: Optional[bool]) -> tuple[Any, str]:
    """Its axes in the order of memory: the matrix turns with them."""
    import numpy
    order = sorted(range(3), key=lambda n: -abs(array.strides[n]))
    # Dimensions of one element may have any stride; they stay where they are.
    turned = array.transpose(order)
    if turned.flags.c_contiguous:
        return turned, "".join(axes[n] for n in order)
    if array.flags.c_contiguous:
        return array, axes
    _refuse_copy(copy, "its memory has gaps or runs backwards")
    return numpy.ascontiguousarray(array), axes


def _refuse_copy(copy: Optional[bool], why: str) -> None:
    if copy is False:
        raise ValueError(f"the array cannot be used in place: {why}; allow a "
                         f"copy")
    if copy is None:
        warnings.warn(f"the array is copied: {why}",
                      _snowglass.SnowglassWarning, stacklevel=5)


def _matrix(spacing: Any, affine: Any) -> Any:
    import numpy
    if affine is not None:
        if spacing is not None:
            raise TypeError("give spacing or affine, not both")
        matrix = numpy.array(affine, float)
        if matrix.shape != (4, 4):
            raise ValueError(f"affine of shape {matrix.shape}: it must be 4x4")
        return matrix
    steps: Sequence[float] = (1, 1, 1) if spacing is None else \
        (spacing,) * 3 if numpy.ndim(spacing) == 0 else spacing
    if len(steps) != 3 or not all(float(step) > 0 for step in steps):
        raise ValueError(f"spacing {spacing!r}: give three lengths above 0, "
                         f"along x, y, z")
    return numpy.diag([float(step) for step in steps] + [1.0])
