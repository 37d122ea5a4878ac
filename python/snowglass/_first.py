"""The mode of a first picture, as the command line takes it
(programs/picture/first.c)."""
from __future__ import annotations

from typing import Any, Mapping

from . import _channels, _snowglass
from ._looks import look_of

#: Settings of opacities, surfaces and light.
OF_OVER = ("depth", "depth_darkening", "occlusion", "threshold", "overlay")


def _is_decided(volume: Any, look: Any, settings: Mapping[str, Any]) -> bool:
    """Whether all is of a mode, or of opacities and surfaces."""
    if isinstance(look, (_snowglass.Transfer, _channels.Mixture)):
        return True
    chosen, source = look_of(look), volume._source or {}
    words = (str(settings.get("method")), str(settings.get("kernel")).split(":")[0])
    number = [settings.get(name) for name in OF_OVER]
    return any((chosen.preset, chosen.colors, chosen.opacity,
                chosen.gradient_opacity, source.get("labels"),
                settings.get("shade") is not None,
                settings.get("light") is not None,
                *(each is not None and each is not False and
                  not (isinstance(each, (int, float)) and each == 0)
                  for each in number),
                *(word in ("original", "footprint", "gauss", "box")
                  for word in words)))


def mode(volume: Any, look: Any, settings: Mapping[str, Any]) -> str:
    """The one that is asked for, or of a first picture."""
    if settings.get("mode") or _is_decided(volume, look, settings):
        return settings.get("mode") or "over"
    mixed, info = volume._mixed, volume._info
    if mixed is not None and mixed.listed:
        return "mip" if mixed.light else "over"
    if mixed is None and info["channel_count"] > 1 and volume._one is None:
        return "over"
    made: str = info["first_mode"]
    return made
