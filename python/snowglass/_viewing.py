"""What a viewer shows, and when: a recipe, which pages change and one thread
draws.  The newest state wins.  The messages are those of `snowglass serve`, whose
page it is: texts as dictionaries, pictures as bytes behind a head of 32 bytes.

    {"t": "hello", "page": "a"}       from pages; answered by info, look, state
    {"t": "set", "step": 17, "keys": {"azimuth": 30, "preset": None}}
    {"t": "moving", "on": True}       drafts suffice
    {"t": "ack", "n": 17}             of a picture: the next one may come
    {"t": "ask", "what": "histogram"}
    {"t": "bye"}                      the page is gone

Each has the page that it comes from, and each answer the page that it is for."""
from __future__ import annotations

import contextlib
import json
import math
import os
import shlex
import struct
import tempfile
import threading
import time
from typing import Any, Callable, Mapping, Optional

from . import _recipes, _snowglass
from ._drawing import SETTABLE, Drawing
from ._images import Image

Send = Callable[[dict[str, Any], Optional[bytes]], None]

#: A page that moves and has been silent for longer moves no more.
MOVING_SECONDS = 5.0
#: Seconds of rest before a picture of quality normal, and before one of high.
NORMAL_SECONDS, HIGH_SECONDS = 0.12, 0.3
#: A draft that takes longer gets half the side; one that takes less gets it back.
SECONDS_MOST, SECONDS_LEAST, SHRINK_MOST = 0.040, 0.009, 3
QUALITIES = ("draft", "normal", "high")
JPEG, PNG = 1, 2
SIDE_MOST, THUMBNAIL_SIDE, QUESTIONS_MOST, PAGES_MOST = 4096, 96, 128, 32


class Stale(Exception):
    """The picture under way is no longer wanted."""


def pack(image: Image, level: int, pane: int, seconds: float) -> bytes:
    """A picture with its head, whose n is 0.  The one at rest is the PNG that the
    command line writes; the others are JPEG, where the library has it."""
    begin = time.monotonic()
    kind = JPEG if level < 2 and _snowglass.format_bits(b"a.jpg") > 0 else PNG
    place = "/dev/shm" if os.path.isdir("/dev/shm") else None
    with tempfile.TemporaryDirectory(dir=place) as folder:
        path = os.path.join(folder, "a.jpg" if kind == JPEG else "a.png")
        image.save(path)
        with open(path, "rb") as file:
            data = file.read()
    packed = time.monotonic() - begin
    return struct.pack("<4sIBBBBIIIII", b"SNW1", 0, level, kind, pane, 0, 0,
                       image.width, image.height, int(seconds * 1e6),
                       int(packed * 1e6)) + data


def check(recipe: Mapping[str, Any], changes: Mapping[str, Any]) -> None:
    """ValueError or TypeError: a recipe that cannot be drawn, as far as that is
    known without the volume."""
    _, look, options = _recipes.split(recipe)
    if look is not None:
        look._arguments()
    for name in ("preset", "colormap", "view"):
        known = _snowglass.names(name + "s")
        if changes.get(name) is not None and changes[name] not in known:
            raise ValueError(f"there is no {name} '{changes[name]}'; choose one "
                             f"of {', '.join(known)}")
    for name in ("azimuth", "elevation", "roll", "zoom", "perspective", "iso",
                 "threshold"):
        if name in options and not isinstance(options[name], (int, float)):
            raise ValueError(f"{name}: give a number")


class Page:
    """A page that looks: what it has sent, and the picture that it waits for."""

    def __init__(self, name: str) -> None:
        self.name, self.moving, self.heard = name, False, time.monotonic()
        self.sets: list[tuple[int, int]] = []  # step, and the revision that has it
        self.under_way = False                 # a picture that is not acknowledged
        self.waiting: Optional[tuple[int, bytes]] = None

    def step_of(self, revision: int) -> int:
        """Its newest set that a revision has in it."""
        return max((step for step, of in self.sets if of <= revision), default=0)


class Viewing:
    """The monitor of a viewer.  `take` is called with the messages of pages, by
    any thread; `send` is called with answers, by this one's or by that."""

    def __init__(self, drawing: Drawing, recipe: Mapping[str, Any],
                 send: Send) -> None:
        self.drawing, self.recipe, self.send = drawing, dict(recipe), send
        self.pages: dict[str, Page] = {}
        self.questions: list[tuple[str, dict[str, Any]]] = []
        self.changed = threading.Condition()
        self.revision, self.changed_at, self.ended = 1, 0.0, False
        self.drawn, self.level, self.shrink = 0, -1, 0
        self.newest: Optional[tuple[int, bytes]] = None
        self.radius, self.crop_is_alone, self.is_empty = 0.0, False, False
        self.first_recipe = dict(recipe)
        self.thread = threading.Thread(target=self._run, daemon=True,
                                       name="snowglass viewer")
        self.thread.start()

    def end(self) -> None:
        with self.changed:
            self.ended = True
            self.changed.notify()

    # --- what pages say ---

    def take(self, message: Any) -> None:
        """Takes a message of a page; what is not one is answered by a line."""
        page = message.get("page") if isinstance(message, dict) else None
        kind = message.get("t") if page is not None else None
        take = {"hello": self._greet, "set": self._set, "ask": self._ask,
                "moving": self._move, "ack": self._acknowledge,
                "bye": self._forget}.get(str(kind))
        if take is None or kind != "hello" and page not in self.pages:
            return
        with self.changed:
            try:
                if page in self.pages:
                    self.pages[page].heard = time.monotonic()
                take(str(page), message)
            except (KeyError, TypeError, ValueError) as error:
                self._say(str(page), f"{kind}: {error}")
            self.changed.notify()

    def _tell(self, message: dict[str, Any], to: Optional[str] = None,
              but: Optional[str] = None) -> None:
        for name in list(self.pages):
            if name == to or to is None and name != but:
                self.send({**message, "to": name}, None)

    def _say(self, to: Optional[str], text: str) -> None:
        self._tell({"t": "said", "text": text}, to)

    def _state(self, to: Optional[str] = None, but: Optional[str] = None) -> None:
        for name, page in self.pages.items():
            if name == to or to is None and name != but:
                self._tell({"t": "state", "step": page.step_of(self.revision),
                            "keys": self.recipe}, name)

    def _greet(self, name: str, message: dict[str, Any]) -> None:
        if name not in self.pages and len(self.pages) >= PAGES_MOST:
            silent = min(self.pages.values(), key=lambda page: page.heard)
            self._say(silent.name, "Another page takes the place of this one, "
                                   f"as a viewer has {PAGES_MOST}: run the cell "
                                   f"again to see it here.")
            del self.pages[silent.name]
        self.pages[name] = Page(name)
        self.questions.append((name, {"what": ""}))

    def _forget(self, name: str, message: dict[str, Any]) -> None:
        del self.pages[name]

    def _set(self, name: str, message: dict[str, Any]) -> None:
        changes, page = dict(message["keys"]), self.pages[name]
        page.sets = page.sets[-63:] + [(int(message["step"]), self.revision + 1)]
        try:
            self._merge(changes)
        except (TypeError, ValueError) as error:
            self._say(name, str(error))
            self._merge_one_by_one(changes)
            page.sets[-1] = (page.sets[-1][0], self.revision)
            self._state()
            return
        self._state(but=name)

    def _merge_one_by_one(self, changes: dict[str, Any]) -> None:
        """What is wrong is left out."""
        for key, value in changes.items():
            with contextlib.suppress(TypeError, ValueError):
                self._merge({key: value})

    def _merge(self, changes: dict[str, Any]) -> None:
        strange = [key for key in changes if key not in SETTABLE]
        if strange:
            raise ValueError(f"a page cannot set {strange[0]}")
        if "size" in changes:
            size = [int(side) for side in changes["size"] or ()]
            if len(size) != 2 or not all(1 <= side <= SIDE_MOST for side in size):
                raise ValueError("a picture has 1 to 4096 pixels a side")
        recipe = {key: value for key, value in
                  {**self.recipe, **changes}.items() if value is not None}
        check(recipe, changes)
        if "crop" in changes:
            self.crop_is_alone = "zoom" not in changes and \
                "target" not in changes
        self.recipe = recipe
        self.revision += 1
        self.changed_at = time.monotonic()

    def _move(self, name: str, message: dict[str, Any]) -> None:
        self.pages[name].moving = bool(message["on"])
        self.changed_at = time.monotonic()

    def _acknowledge(self, name: str, message: dict[str, Any]) -> None:
        page = self.pages[name]
        page.under_way = False
        if page.waiting:
            self._hand(page, *page.waiting)

    def _ask(self, name: str, message: dict[str, Any]) -> None:
        if len(self.questions) >= QUESTIONS_MOST:
            raise ValueError("too many questions wait")
        self.questions.append((name, {**message, "what": str(message["what"])}))

    def _hand(self, page: Page, revision: int, frame: bytes) -> None:
        """A picture, or where one is under way, in the place of one that waits."""
        if page.under_way:
            page.waiting = revision, frame
            return
        page.waiting, page.under_way = None, True
        head = struct.pack("<I", page.step_of(revision))
        self.send({"t": "frame", "to": page.name},
                  frame[:4] + head + frame[8:])

    # --- the thread that draws ---

    def _run(self) -> None:
        while True:
            with self.changed:
                work = None
                while work is None and not self.ended:
                    work = self._next()
                recipe, revision = self.recipe, self.revision
            if self.ended:
                return
            try:
                if isinstance(work, tuple):
                    self._answer(*work)
                elif work is not None:
                    self._draw(recipe, revision, work)
            except Stale:
                pass
            except Exception as error:  # the pages get a line
                with self.changed:
                    with contextlib.suppress(Exception):  # none may hear it
                        self._say(None, str(error) or type(error).__name__)
                    if not isinstance(work, tuple):
                        self.drawn, self.level = revision, 2

    def _next(self) -> Any:
        """Under the lock: a question, the level of a picture, or None after a
        wait."""
        now, due, level = time.monotonic(), math.inf, None
        rests = max((page.heard + MOVING_SECONDS for page in
                     self.pages.values() if page.moving), default=now)
        moving = rests > now
        if self.pages and (self.drawn != self.revision or self.level < 0):
            level, due = 0, now
        elif self.pages and self.level < 2 and not moving:
            level = self.level + 1
            due = self.changed_at + (HIGH_SECONDS if level == 2
                                     else NORMAL_SECONDS)
        elif moving:
            due = rests
        for at, (_, question) in enumerate(self.questions):
            waits = question["what"] == "thumbnail"
            if not waits or level is None and not moving:
                return self.questions.pop(at)
        if due <= now:
            return level
        self.changed.wait(None if due == math.inf else due - now)
        return None

    def _draw(self, recipe: dict[str, Any], revision: int, level: int) -> None:
        drawing = self.drawing
        if level == 0:
            drawing.apply(recipe)
            if self._keep_scale():
                return
            if drawing.look_is_new:
                drawing.look_is_new = False
                self._tell(drawing.look_message(recipe))

        def go_on(stage: str, part: float) -> None:
            if self.ended or level > 0 and self.revision != revision:
                raise Stale
        begin = time.monotonic()
        image = drawing.render(recipe, QUALITIES[level],
                               0 if level else self.shrink, go_on)
        took = time.monotonic() - begin
        self._adapt(level, took)
        frame = pack(image, level, 0, took)
        with self.changed:
            self.drawn, self.level, self.newest = revision, level, \
                (revision, frame)
            for page in self.pages.values():
                self._hand(page, revision, frame)
            if level:
                self._tell({"t": "figures", "method": image.stats["method"],
                            "sparse": image.stats["sparse_ratio"],
                            "interesting": image.stats["interesting"]})
                self._tell_empty(image)

    def _adapt(self, level: int, took: float) -> None:
        if level == 1 and took <= SECONDS_MOST:
            self.shrink = 0
        elif level == 0 and took > SECONDS_MOST:
            self.shrink = min(SHRINK_MOST, self.shrink + 1)
        elif level == 0 and took < SECONDS_LEAST:
            self.shrink = max(0, self.shrink - 1)

    def _tell_empty(self, image: Image) -> None:
        import numpy
        empty = not numpy.asarray(image)[..., -1].any()
        if empty and not self.is_empty:
            self._say(None, "Nothing is visible: change the range, the opacity "
                            "or the clip planes.")
        self.is_empty = empty

    def _keep_scale(self) -> bool:
        """Another crop has another size, which zoom goes by: it is changed so
        that the object stays as large.  Whether the state is a new one."""
        drawing, before = self.drawing, self.radius
        if not drawing.volume_is_new:
            return False
        drawing.volume_is_new = False
        self.radius = drawing.middle()[1]
        if not before or abs(self.radius - before) <= 1e-9 * before:
            return False
        with self.changed:
            self._tell(drawing.info())
            if "target" not in self.recipe or not self.crop_is_alone:
                return False
            self._merge({"zoom": self.recipe.get("zoom", 1) *
                         self.radius / before})
            self._state()
        return True

    # --- answers ---

    def _answer(self, name: str, question: dict[str, Any]) -> None:
        answer = {"": self._answer_hello, "fit": self._answer_fit,
                  "histogram": self._answer_histogram,
                  "command": self._answer_command,
                  "recipe": self._answer_recipe,
                  "thumbnail": self._answer_thumbnail}.get(question["what"])
        if answer is None:
            self._say(name, f"A viewer in a notebook has no "
                            f"{question['what'][:40]}: snowglass serve has.")
            return
        try:
            answer(name, question)
        except Stale:
            self.questions.append((name, question))
        except ValueError as error:
            self._say(name, str(error))

    def _answer_hello(self, name: str, question: dict[str, Any]) -> None:
        drawing = self.drawing
        begins = self.level < 0
        drawing.apply(self.recipe)
        if begins:
            self.radius = drawing.middle()[1]
            drawing.volume_is_new = drawing.look_is_new = False
            if "target" not in self.recipe:
                with self.changed:
                    self._merge(drawing.fit(self.recipe))
        self._tell(drawing.info(), name)
        self._tell(drawing.look_message(self.recipe), name)
        with self.changed:
            self._state(to=name)
            page = self.pages.get(name)
            if page and self.newest:
                self._hand(page, *self.newest)

    def _answer_histogram(self, name: str, question: dict[str, Any]) -> None:
        self._tell(self.drawing.histogram(), name)

    def _answer_fit(self, name: str, question: dict[str, Any]) -> None:
        self.drawing.apply(self.recipe)
        keys = self.drawing.fit(self.recipe)
        with self.changed:
            if keys:
                self._merge(keys)
            else:
                self._say(name, "The camera stands at a position that was given: "
                                "choose a view to frame all.")
            self._state()

    def _answer_command(self, name: str, question: dict[str, Any]) -> None:
        recipe = self.drawing.recipe(self.recipe)
        if "input" in recipe:
            out = os.path.basename(recipe["input"]).split(":")[-1].split(".")[0]
            text = _recipes.command(recipe) + \
                f" --output {shlex.quote(out or 'picture')}.png"
        else:
            text = f"snowglass.render(volume, **{recipe!r})"
        self._tell({"t": "command", "text": text}, name)

    def _answer_recipe(self, name: str, question: dict[str, Any]) -> None:
        text = json.dumps(self.drawing.recipe(self.recipe), indent=2)
        self._tell({"t": "recipe", "text": text}, name)

    def _answer_thumbnail(self, name: str, question: dict[str, Any]) -> None:
        preset, pane = str(question["preset"]), int(question["pane"])
        colormap = question.get("colormap")
        revision = self.revision
        maps = [name + end for name in _snowglass.names("colormaps") for end in ("", "_r")]
        if not 4 <= pane <= 255 or colormap not in (None, *maps) or \
                preset and preset not in _snowglass.names("presets"):
            return

        def go_on(stage: str, part: float) -> None:
            if self.ended or self.revision != revision:
                raise Stale
        image = self.drawing.thumbnail(
            self.recipe, preset, THUMBNAIL_SIDE, go_on, colormap,
            "mip" if question.get("mode") == "mip" else "over")
        self.send({"t": "frame", "to": name}, pack(image, 1, pane, 0))
