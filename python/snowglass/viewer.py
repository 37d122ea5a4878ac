"""The viewer in a notebook: the page of `snowglass serve`, with the kernel as its
renderer.

    viewer = volume.view("ct-bone")      # or snowglass.Viewer(volume, "ct-bone")
    viewer                               # shows itself
    viewer.recipe, viewer.image          # what it has become

It is a widget by the package anywidget, over whatever connection the notebook
has: no port is opened.  Without anywidget it shows itself as a picture."""
from __future__ import annotations

import json
import pathlib
import re
import shlex
from typing import Any, Mapping, Optional, Union, Unpack

from . import _recipes
from ._drawing import Drawing, begin
from ._images import Image
from ._looks import Look
from ._viewing import Viewing
from ._options import Picture
from ._signatures import takes
from ._volumes import Volume, _given_look
from ._warnings import warn

INSTALL = "pip install anywidget"
_WEB = pathlib.Path(__file__).parent / "web"
_IMPORT = re.compile(r"(?ms)^import \{([^}]*)\}\s+from '\.[./]*/(?:panel/)?(\w+)\.js';\n")


def _imports(text: str) -> list[tuple[str, list[str]]]:
    return [(name, [each.strip() for each in names.split(",")])
            for names, name in _IMPORT.findall(text)]


def _modules(name: str, stands_for: Mapping[str, str], found: dict[str, str]
             ) -> None:
    """A module and, before it, what it imports."""
    text = (_WEB / f"{name}.js").read_text(encoding="utf-8")
    for other, _ in _imports(text):
        other = stands_for.get(other, other)
        if other != name and other not in found:
            _modules(other, {} if other in stands_for.values() else stands_for,
                     found)
    found[name] = _IMPORT.sub(
        lambda m: "const {%s} = $%s;\n" % (
            re.sub(r"\s+as\s+", ": ", m.group(1)),
            stands_for.get(m.group(2), m.group(2))), text)


def bundle() -> str:
    """The page's modules as one, for anywidget: each is a function that returns
    what others import."""
    stands_for = {"engine_server": "engine_kernel"}
    found: dict[str, str] = {}
    _modules("viewer", stands_for, found)
    wanted: dict[str, set[str]] = {name: set() for name in found}
    for name in found:
        text = (_WEB / f"{name}.js").read_text(encoding="utf-8")
        for other, names in _imports(text):
            if name not in stands_for.values():
                other = stands_for.get(other, other)
            wanted[other] |= {each.split(" as ")[0] for each in names}
    parts = ["const $%s = (() => {\n%s\nreturn {%s};\n})();" % (
        name, re.sub(r"(?m)^export ", "", text), ", ".join(sorted(wanted[name])))
        for name, text in found.items()]
    style = (_WEB / "viewer.css").read_text(encoding="utf-8")
    style = re.sub(r"(?m)^(\s*)(:root|html, body|body) \{", r"\1:host {", style)
    return "\n".join([
        "function begin(host) {",
        "const {document, window, location} = host;", *parts,
        "return window.snowglass;\n}",
        f"const STYLE = {json.dumps(style + ':host { display: block; }')};",
        (_WEB / "notebook.js").read_text(encoding="utf-8")])


class _Still:
    """In the place of anywidget's class, where that is not installed."""

    def __init__(self, **_: Any) -> None:
        pass

    def _repr_png_(self) -> bytes:
        return self.image.png()  # type: ignore[attr-defined]

    def close(self) -> None:
        pass


_Base: Any
try:
    import anywidget  # type: ignore[import]
    import traitlets  # type: ignore[import]

    class _Base(anywidget.AnyWidget):  # type: ignore[misc,no-redef]
        _esm = bundle()
        height = traitlets.Int(540).tag(sync=True)
except ImportError:
    _Base = _Still


class Viewer(_Base):  # type: ignore[misc]
    """A volume that is turned, cut and coloured in a notebook.

    look      as for Volume.render
    height    of the cell in pixels
    options   of Volume.render, that the viewer begins with: view, azimuth,
              mode, legend, ...

    While something moves, pictures are drafts; 0.12 s after the last change comes
    one of quality normal, after 0.3 s one of quality high.
    """

    @takes(Picture)
    def __init__(self, volume: Volume, look: Union[Look, str, None] = None, *,
                 height: int = 540, **given: Unpack[Picture]) -> None:
        options = dict(given)
        drawing, recipe = begin(volume, _given_look(look, options), options)
        super().__init__(height=height)
        self.volume = volume
        self._look = drawing.look
        self._viewing: Optional[Viewing] = None
        if _Base is _Still:
            warn(f"the viewer needs the package anywidget: {INSTALL}; a picture "
                 f"stands in its place")
            self._recipe = recipe
            return
        self._viewing = Viewing(drawing, recipe, self._answer)
        self.on_msg(lambda _, message, __: self._viewing.take(message)
                    if self._viewing else None)

    def _answer(self, message: dict[str, Any], data: Optional[bytes]) -> None:
        self.send(message, None if data is None else [data])

    @property
    def recipe(self) -> dict[str, Any]:
        """What it shows at rest, as `snowglass.render(volume, **recipe)` takes
        it."""
        state = self._viewing.recipe if self._viewing else self._recipe
        return _recipes._plain_tree({**state, "quality": "high"})

    @property
    def image(self) -> Image:
        """What it shows now, in quality high."""
        drawing, recipe = Drawing(self.volume, self._look), self.recipe
        drawing.apply(recipe)
        recipe.pop("quality")
        return drawing.render(recipe, "high")

    def __repr__(self) -> str:
        source = self.volume._source
        file = shlex.quote(source["input"]) if source else \
            "FILE, as volume.save() writes it"
        needs = f", after {INSTALL}" if _Base is _Still else ""
        return f"<snowglass.Viewer: it shows itself in a notebook{needs}; elsewhere " \
               f"run snowglass serve {file}>"

    def close(self) -> None:
        """Ends the widget and its thread."""
        if self._viewing:
            self._viewing.end()
        super().close()
