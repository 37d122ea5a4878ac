"""Arguments, before the core sees them: of a wrong one a line says its name and
what to give."""
from __future__ import annotations

import math
from typing import Any, Iterable, Mapping, Optional, Type

SHOWN_MOST = 60  # characters of a value


def shown(value: Any) -> str:
    """A value in a short line; an array by its shape."""
    if getattr(value, "ndim", 0):
        return f"an array of shape {tuple(value.shape)}"
    text = " ".join(repr(value).split())
    return text if len(text) <= SHOWN_MOST else text[:SHOWN_MOST - 3] + "..."


def fault(name: str, give: str, value: Any,
          kind: Type[Exception] = TypeError) -> Exception:
    """NAME: give ..., not VALUE"""
    return kind(f"{name}: give {give}, not {shown(value)}")


def text(name: str, value: Any, give: str) -> Optional[str]:
    if value is None or isinstance(value, str):
        return value
    raise fault(name, give, value)


def number(name: str, value: Any, give: str = "a number") -> float:
    """A finite one."""
    try:
        if isinstance(value, (str, bytes)):
            raise TypeError
        found = float(value)
    except (TypeError, ValueError, OverflowError):
        raise fault(name, give, value) from None
    if not math.isfinite(found):
        raise fault(name, give, value, ValueError)
    return found


def names(given: Iterable[str], known: Iterable[str],
          elsewhere: Mapping[str, str]) -> None:
    """That options are known here; of others a line says where they belong."""
    allowed = list(dict.fromkeys(known))
    for name in given:
        if name in elsewhere and name not in allowed:
            raise TypeError(f"{name} {elsewhere[name]}")
        if name not in allowed:
            raise TypeError(f"there is no option '{name}'; take one of "
                            f"{', '.join(allowed)}")
