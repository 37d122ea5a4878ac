"""Steps of a file by their number or their time."""
from __future__ import annotations

import operator
import os
import re
from typing import Any, Mapping, Union

from . import _checks, _snowglass
from ._warnings import warn

GIVE = "the number of a step, 'last', a time such as '0.3s' or '2005-08-28T06:00', a " \
       "datetime or a numpy.datetime64"


def plain(time: Any) -> Union[int, str]:
    """A number, or a text as the command line has it."""
    if isinstance(time, str):
        text = time.strip()
        return -1 if text == "last" else int(text) if re.fullmatch(r"[+-]?\d+", text) \
            else text
    if getattr(getattr(time, "dtype", None), "kind", "") == "M":
        import numpy
        moment = numpy.asarray(time)
        if moment.size == 1 and not numpy.isnat(moment).any():
            return str(numpy.datetime_as_string(moment.reshape(())[()], unit="auto"))
    elif hasattr(time, "isoformat"):  # of datetime, pandas and cftime
        return str(time.isoformat())
    try:
        return operator.index(time)
    except TypeError:
        raise _checks.fault("time", GIVE, time) from None


def step(time: Any, path: str, fields: Mapping[str, Any]) -> int:
    """The number of the step of a file, opened with fields, that is nearest to a time;
    a warning says where it has another one."""
    wanted = plain(time)
    if isinstance(wanted, int):
        return wanted
    others = {name: value for name, value in fields.items() if name not in ("time", "channel")}
    found = _snowglass.find_step(os.fsencode(path), others, wanted)
    if found is None:
        more = "; snowglass.series has several steps" \
            if re.fullmatch(r"-?\d*:-?\d*", wanted) else ""
        raise ValueError(f"time: give {GIVE}, not {wanted!r}{more}")
    if found[1] is not None:
        warn(f"{path}: step {found[0]} is the nearest to time={wanted!r}, at {found[1]}")
    return found[0]
