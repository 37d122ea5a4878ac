"""How far a call is: what progress=True shows."""
from __future__ import annotations

import sys
from typing import Any, Callable, Optional, Union

Progress = Union[Callable[[str, float], Any], bool, None]


def _print(stage: str, fraction: float) -> None:
    end = "\n" if fraction >= 1 else "\r"
    print(f"{stage} {100 * fraction:3.0f} %", end=end, file=sys.stderr)


class _Bars:
    """A bar of tqdm for each stage."""

    def __init__(self, make: Callable[..., Any]) -> None:
        self.make, self.stage = make, ""
        self.bar: Any = None

    def __call__(self, stage: str, fraction: float) -> None:
        if self.bar is None or stage != self.stage:
            self.close()
            self.stage, self.bar = stage, self.make(desc=stage, total=100, unit="%")
        self.bar.update(round(100 * fraction) - self.bar.n)
        if fraction >= 1:
            self.close()

    def close(self) -> None:
        if self.bar is not None:
            self.bar.close()
        self.bar = None


def progress_of(given: Progress) -> Optional[Callable[[str, float], Any]]:
    """What is called with stage and fraction, for an argument `progress`."""
    if given is not True:
        return given or None
    try:
        from tqdm.auto import tqdm  # type: ignore[import]
    except ImportError:
        return _print
    return _Bars(tqdm)
