"""The viewer of notebooks by its widget's protocol: what a page says, and what the
kernel answers.  anywidget itself is not needed."""
import json
import os
import shlex
import struct
import subprocess
import sys
import threading
import time

import numpy

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(HERE, "stand_ins"))
import snowglass as sg  # noqa: E402
from beside import InFolder  # noqa: E402
from snowglass import _viewing, viewer  # noqa: E402
from snowglass._drawing import Drawing  # noqa: E402


class Frame:
    def __init__(self, data):
        (magic, self.n, self.level, self.kind, self.pane, _, _, self.width,
         self.height, self.render, _) = struct.unpack_from("<4sIBBBBIIIII", data)
        assert magic == b"SNW1"
        self.bytes = data[32:]


class Page:
    """A page of a widget: sends, and waits for what comes."""

    def __init__(self, widget, name="a"):
        self.widget, self.name, self.said, self.frames = widget, name, [], []
        self.n, self.acknowledges = 0, True
        before = widget.listener

        def hear(sent):
            before(sent)
            self.hear(*sent)
        widget.listener = hear

    def hear(self, content, buffers):
        if content["to"] != self.name:
            return
        json.dumps(content)  # as the notebook does
        if content["t"] != "frame":
            self.said.append(content)
            return
        frame = Frame(buffers[0])
        self.frames.append(frame)
        if self.acknowledges and not frame.pane:
            self.say(t="ack", n=frame.n)

    def say(self, **message):
        self.widget.receive({**message, "page": self.name})

    def set(self, **keys):
        self.n += 1
        self.say(t="set", step=self.n, keys={
            name.replace("_", "-"): value for name, value in keys.items()})
        return self.n

    def wait(self, found, seconds=60):
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            result = found()
            if result:
                return result
            time.sleep(0.005)
        raise AssertionError(f"waited in vain: {self.said[-3:]}")

    def last(self, kind):
        return next((each for each in reversed(self.said)
                     if each["t"] == kind), None)

    def text(self, kind, since=0):
        return self.wait(lambda: next((each for each in self.said[since:]
                                       if each["t"] == kind), None))

    def question(self, what, **asked):
        self.say(t="ask", what=what, **asked)

    def ask(self, what):
        """What is answered by a text of the kind, or as a remark (said)."""
        self.question(what)
        return self.text(what)["text"]

    def rest(self, n=None):
        """The picture at rest of the newest state."""
        n = self.n if n is None else n
        return self.wait(lambda: self.frames and self.frames[-1].level == 2 and
                         self.frames[-1].n >= n and self.frames[-1])


def block():
    array = numpy.zeros((24, 28, 32), numpy.int16)
    array[6:18, 8:20, 10:22] = 700
    return array


class Viewers(InFolder):
    strict = False

    def open(self, volume, *words, **options):
        widget = viewer.Viewer(volume, *words, **{"size": (96, 80), **options})
        self.addCleanup(widget.close)
        page = Page(widget)
        page.say(t="hello")
        page.rest()
        return widget, page

    def saved(self, **options):
        """The head in a file."""
        self.head().save("head.nrrd")
        return sg.Volume("head.nrrd", **options)

    def head(self):
        return sg.Volume("phantom:head", dims=(48, 48, 40))

    def test_it_begins_with_what_a_page_needs(self):
        widget, page = self.open(self.head(), "mr-default", azimuth=20)
        info, look, state = (page.text(kind) for kind in
                             ("info", "look", "state"))
        self.assertEqual(info["dims"], (48, 48, 40))
        self.assertEqual(len(info["presets"][0]), 2)
        self.assertIn(info["view"], info["views"])
        self.assertEqual(len(look["strip"]), 64)
        self.assertGreater(look["count"], 1)
        self.assertEqual(state["keys"]["azimuth"], 20)
        self.assertEqual(state["keys"]["fit"], "volume")
        page.rest()
        levels = [frame.level for frame in page.frames]
        self.assertEqual(levels, [0, 1, 2])
        self.assertEqual(widget.traits["height"], 540)

    def test_the_picture_at_rest_is_that_of_its_command(self):
        _, page = self.open(self.saved())
        page.set(azimuth=-33.5, preset="ct-bone", legend=True,
                 clip=[[1, 0, 0, 30]], size=[120, 100])
        frame = page.rest()
        self.assertEqual((frame.kind, frame.width, frame.height), (2, 120, 100))
        words = shlex.split(page.ask("command"))
        self.assertEqual(words[:2], ["snowglass", "render"])
        self.tool(*words[1:], "-o", "b.png")
        self.assertEqual(self.bytes_of("b.png"), frame.bytes)

    def test_drafts_while_it_moves(self):
        _, page = self.open(self.head(), size=(64, 64))
        count = len(page.frames)
        page.say(t="moving", on=True)
        n = page.set(azimuth=45)
        page.wait(lambda: page.frames[-1].n == n)
        time.sleep(0.5)
        self.assertEqual({frame.level for frame in page.frames[count:]}, {0})
        begin = time.monotonic()
        page.say(t="moving", on=False)
        page.rest()
        self.assertGreaterEqual(time.monotonic() - begin, 0.29)
        self.assertEqual([frame.level for frame in page.frames[-2:]], [1, 2])

    def test_a_page_gets_no_more_than_it_acknowledges(self):
        _, page = self.open(self.head(), size=(64, 64))
        page.acknowledges = False
        n = page.set(azimuth=1)
        page.wait(lambda: page.frames[-1].n == n)
        count = len(page.frames)
        for azimuth in range(2, 12):
            page.set(azimuth=azimuth)
            time.sleep(0.03)
        time.sleep(1)
        self.assertEqual(len(page.frames), count)
        page.acknowledges = True
        page.say(t="ack", n=n)
        page.wait(lambda: page.frames[-1].n == page.n)
        self.assertLess(len(page.frames) - count, 4)  # those between are left out

    def test_pages_see_each_other(self):
        widget, page = self.open(self.head(), size=(64, 64))
        other = Page(widget, "b")
        other.say(t="hello")
        other.rest()
        n = other.set(mode="mip")
        state = page.wait(lambda: page.last("state")["keys"].get("mode") and
                          page.last("state"))
        self.assertEqual((state["keys"]["mode"], state["step"]), ("mip", 0))
        other.rest(n)
        page.wait(lambda: page.frames[-1].bytes == other.frames[-1].bytes)
        self.assertEqual(widget.recipe["mode"], "mip")
        self.assertEqual(widget.image.png(), other.frames[-1].bytes)
        count = len(page.frames)
        page.say(t="bye")
        other.set(azimuth=9)
        other.rest()
        self.assertEqual(len(page.frames), count)

    def test_what_is_asked(self):
        volume = self.head()
        _, page = self.open(volume)
        page.question("histogram")
        histogram = page.text("histogram")
        self.assertEqual(sum(histogram["counts"]),
                         volume.statistics["finite"])
        page.question("thumbnail", preset="ct-bone", pane=7)
        thumbnail = page.wait(lambda: next(
            (each for each in page.frames if each.pane == 7), None))
        self.assertEqual((thumbnail.width, thumbnail.height), (96, 96))
        for pane, asked in ((8, {"colormap": "hot"}), (9, {"colormap": "grey_r", "mode": "mip"})):
            page.question("thumbnail", preset="", pane=pane, **asked)
            other = page.wait(lambda: next(
                (each for each in page.frames if each.pane == pane), None))
            self.assertNotEqual(other.bytes, thumbnail.bytes)
        page.set(zoom=0.3)
        page.question("fit")
        page.wait(lambda: page.last("state")["keys"]["zoom"] > 0.6)
        recipe = json.loads(page.ask("recipe"))
        self.assertEqual(recipe["input"], "phantom:head")
        frame = page.rest()
        same = sg.render(**recipe)
        self.assertEqual(same.png(), frame.bytes)

    def test_arrays(self):
        array = block()
        for given, axes in ((array, "zyx"), (array.T, "xyz")):
            volume = sg.Volume(given, axes=axes, spacing=(1, 1, 2))
            _, page = self.open(volume, sg.Look(colors=[
                (0, (1, 0, 0)), (700, (1, 1, 0))], opacity=[(100, 0), (700, 1)]))
            whole = page.rest()
            n = page.set(crop=[[0, 16], [0, 0], [0, 0]])
            self.assertNotEqual(page.rest(n).bytes, whole.bytes)
            self.assertEqual(page.last("info")["dims"], (16, 28, 24))
            n = page.set(crop=None, clip=[[0, 0, 1, 20]])
            clipped = page.rest(n)
            self.assertNotEqual(clipped.bytes, whole.bytes)
            page.question("command")
            self.assertIn("no recipe", page.text("said")["text"])
            page.set(preset="ct-bone", clip=None)
            page.rest()
            page.question("command")
            self.assertIn("snowglass.render(volume, **",
                          page.text("command")["text"])
            n = page.set(time=3)
            page.wait(lambda: "array" in page.last("said")["text"])

    def test_what_is_wrong_is_said(self):
        widget, page = self.open(self.head(), size=(64, 64))
        for keys, line in (({"mask": "/etc/passwd"}, "cannot set mask"),
                           ({"size": [0, 5]}, "1 to 4096"),
                           ({"preset": "nope"}, "no preset 'nope'"),
                           ({"opacity": 3}, ""), ({"azimuth": "left"}, "")):
            with self.subTest(keys):
                count = len(page.said)
                page.set(**keys)
                self.assertIn(line, page.text("said", count)["text"])
        page.set(mask="/etc/passwd", azimuth=33)
        page.wait(lambda: page.last("state")["keys"].get("azimuth") == 33)
        self.assertNotIn("mask", page.last("state")["keys"])
        count = len(page.said)
        page.question("depth", x=0.5, y=0.5)
        self.assertIn("has no depth", page.text("said", count)["text"])
        for message in ({"t": "set", "page": "a"}, {"t": "what", "page": "a"},
                        {"t": "set", "step": 1, "keys": {}, "page": "z"}, 7,
                        {"t": "ask", "page": "a"}):
            widget.receive(message)
        page.set(azimuth=5, opacity=None, preset=None)
        page.set(azimuth=6)
        page.rest()

    def test_a_preset_takes_the_shape_of_the_look_away(self):
        _, page = self.open(self.head(), size=(64, 64))
        shape = dict.fromkeys(("colormap", "opacity", "gradient_opacity",
                               "range", "scale"))  # as panel.js does
        for preset in ("ct-bone", None):
            n = page.set(**shape, preset=preset)
            page.rest(n)
            self.assertIsNone(page.last("said"))
            self.assertEqual(page.widget.recipe.get("preset"), preset)

    def test_more_pages_than_are_kept(self):
        widget, page = self.open(self.head(), size=(64, 64))
        second = Page(widget, "second")
        second.say(t="hello")
        second.rest()
        others = [Page(widget, f"page {n}") for n in range(31)]
        for each in others[:30]:  # 32 with the first two
            each.say(t="hello")
        page.rest(page.set(azimuth=3))  # it lives; the second one is silent
        second.acknowledges = False
        for each in others[:30]:
            each.rest()
            each.say(t="moving", on=False)
        page.say(t="moving", on=False)
        others[30].say(t="hello")
        others[30].rest()
        self.assertIn("other page", second.text("said")["text"])
        self.assertIsNone(page.last("said"))
        page.rest(page.set(azimuth=4))

    def test_a_page_that_is_gone_while_it_moves(self):
        widget, page = self.open(self.head(), size=(64, 64))
        other = Page(widget, "b")
        other.say(t="hello")
        other.rest()
        other.acknowledges = False
        before = _viewing.MOVING_SECONDS
        self.addCleanup(setattr, _viewing, "MOVING_SECONDS", before)
        _viewing.MOVING_SECONDS = 1
        other.say(t="moving", on=True)
        begin = time.monotonic()
        frame = page.rest(page.set(azimuth=3))
        self.assertEqual(frame.level, 2)
        self.assertGreaterEqual(time.monotonic() - begin, 0.9)

    def test_a_clipped_volume_is_as_the_array_lies(self):
        array = block()
        given = {"spacing": (1, 1.5, 2)}
        plain = sg.Volume(array, **given)
        turned = sg.Volume(numpy.asfortranarray(array), axes="zyx", **given)
        recipe = {"clip": [[0, 0, 1, 20]], "size": [64, 64]}
        images = []
        for volume in (plain, turned):
            drawing = Drawing(volume, None)
            drawing.apply(recipe)
            self.assertEqual(drawing.volume.info["dims"], (32, 28, 24))
            self.assertEqual(drawing.volume.shape, array.shape)
            images.append(drawing.thumbnail(recipe, "ct-bone", 64,
                                            lambda stage, part: None))
        self.assertLess(sg.compare(*images).largest, 1e-3)

    def test_outside_of_a_notebook_it_says_what_to_run(self):
        array = numpy.zeros((8, 8, 8), numpy.int16)
        for volume, words in ((sg.Volume("phantom:head", dims=(32, 32, 32)),
                               "snowglass serve phantom:head>"),
                              (sg.Volume(array), "snowglass serve FILE, as volume.save")):
            widget = volume.view("linear")
            self.addCleanup(widget.close)
            self.assertIn("notebook", repr(widget))
            self.assertIn(words, repr(widget))

    def test_a_look_of_its_own_is_edited(self):
        colors = [(0, (1, 0, 0)), (700, (1, 1, 0))]
        array = block()
        volume = sg.Volume(array)
        for look in (sg.Look(colors=colors, opacity=[(100, 0), (700, 1)]),
                     sg.Look(range="robust")):
            with self.subTest(look):
                widget, page = self.open(volume, look)
                whole = page.rest()
                points = [[100, 0], [300, 0.02], [700, 0.05]]
                frame = page.rest(page.set(opacity=points))
                self.assertNotEqual(frame.bytes, whole.bytes)
                self.assertEqual(page.last("look")["count"], 3)
                again = page.rest(page.set(opacity=None))
                self.assertEqual(again.bytes, whole.bytes)
        page.rest(page.set(range=[0, 700]))  # is a recipe now
        self.assertIn("'range': [0, 700]", page.ask("command"))

    def test_a_crop_of_a_part_of_a_file(self):
        part = self.saved(crop=((8, 44), (4, 0), (10, 30)), memory=1 << 30)
        voxels = numpy.asarray(part)
        self.assertEqual(voxels.shape, (20, 44, 36))
        drawing = Drawing(part, None)
        recipe = {"crop": [[2, 30], [6, 0], [0, 12]], "size": [64, 64]}
        drawing.apply(recipe)
        self.assertTrue(numpy.array_equal(
            numpy.asarray(drawing.volume), voxels[:12, 6:, 2:30]))
        self.assertEqual(drawing.recipe(recipe)["crop"],
                         [[10, 38], [10, 48], [10, 22]])
        with self.assertRaisesRegex(ValueError, "along z: .* 0:20"):
            drawing.apply({"crop": [[0, 0], [0, 0], [0, 25]]})
        small = sg.Volume("head.nrrd", crop=((0, 8), (0, 8), (0, 8)), memory=1 << 20)
        self.assertEqual(Drawing(small, None)._open(
            {"crop": [[0, 4], [0, 0], [0, 0]]})._memory, 1 << 20)

    def test_a_recipe_with_parts_of_the_data(self):
        file, array = self.saved(), sg.Volume(numpy.asarray(self.head()))
        for volume in (file, array):
            widget, page = self.open(volume, "mr-default", size=(64, 64))
            for keys in ({"clip": [[1, 0, 0, 0]]},
                         {"crop": [[0, 24], [0, 0], [0, 0]]}):
                frame = page.rest(page.set(**keys))
                image = sg.render(volume, **widget.recipe)
                self.assertEqual(image.png(), frame.bytes)
        with self.assertRaisesRegex(ValueError, "time: .* array"):
            sg.render(array, time=2)
        with self.assertRaisesRegex(ValueError, "dims, mask: "):
            sg.render(file, mask="a.nii", dims=(1, 2, 3))
        phantom = self.head()  # what its recipe has of it is its own
        same = phantom.render("mr-default", size=64)
        again = {**same.recipe}
        self.assertEqual(again.pop("input"), "phantom:head")
        self.same_picture(sg.render(phantom, **again), same)

    def test_a_part_of_a_clipped_file_is_known(self):
        volume = self.saved(clip=[(1, 0, 0, 10)], crop=((4, 0),) * 3)
        _, page = self.open(volume, "mr-default", size=(64, 64))
        frame = page.rest(page.set(crop=[[0, 0], [0, 30], [0, 0]],
                                   clip=[[0, 1, 0, 12]]))
        recipe = json.loads(page.ask("recipe"))
        self.assertEqual(recipe["crop"], [[4, 48], [4, 34], [4, 40]])
        self.assertEqual(recipe["clip"], [[1, 0, 0, 10], [0, 1, 0, 12]])
        self.assertEqual(sg.render(**recipe).png(), frame.bytes)
        for given in (volume, sg.Volume(numpy.asarray(self.head()))):
            image = sg.render(given, "mr-default", size=64, clip=[[0, 1, 0, 12]])
            again = () if given is volume else (given,)
            self.same_picture(sg.render(*again, **image.recipe), image)
            self.assertIn([0, 1, 0, 12], image.recipe["clip"])

    def test_the_thread_ends(self):
        widget, page = self.open(self.head(), size=(64, 64))
        thread = widget._viewing.thread

        def gone(*_):
            raise OSError("the connection is closed")
        widget.send = gone
        page.question("histogram")
        time.sleep(0.3)
        self.assertTrue(thread.is_alive())  # and goes on
        del widget.send
        page.rest(page.set(azimuth=7))
        widget.close()
        thread.join(5)
        self.assertFalse(thread.is_alive())

        ended = _viewing.Viewing.__new__(_viewing.Viewing)
        ended.pages, ended.questions, ended.ended = {}, [], True
        ended.changed, ended.level, ended.drawn = threading.Condition(), 2, 1
        ended.recipe, ended.revision, ended.changed_at = {}, 1, 0.0
        thread = threading.Thread(target=ended._run, daemon=True)
        thread.start()
        thread.join(5)
        self.assertFalse(thread.is_alive())

    def test_where_anywidget_is_not(self):
        code = ("import sys; sys.modules['anywidget'] = None\n"
                "import snowglass as sg\n"
                "v = sg.Volume('phantom:head', dims=(32, 32, 32)).view(size=64)\n"
                "sys.stdout.buffer.write(v._repr_png_())")
        done = subprocess.run([sys.executable, "-c", code], check=True,
                              capture_output=True)
        picture = sg.Volume("phantom:head", dims=(32, 32, 32)).render(
            size=64, quality="high")
        self.assertEqual(done.stdout, picture.png())

    def test_the_module_of_the_page_is_one(self):
        text = viewer.bundle()
        self.assertNotRegex(text, r"(?m)^(import|export (?!default))")
        self.assertEqual(text.count("export default {render};"), 1)
        self.assertNotRegex(text, "innerHTML|https?://")
