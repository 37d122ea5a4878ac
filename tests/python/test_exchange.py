"""Arrays of other libraries as volumes, volumes and pictures as theirs, copies that
are made and refused, and how progress is shown."""
import contextlib
import io
import os
import pathlib
import sys
import tempfile
import unittest
import unittest.mock
import warnings

import numpy

import snowglass as sg
from snowglass import _progress


def block(kind=numpy.int16):
    array = numpy.zeros((8, 10, 12), kind)
    array[2:6, 3:8, 3:9] = 90
    return array


class Exchange(unittest.TestCase):
    def test_copies(self):
        for kind in numpy.int16, numpy.bool_, numpy.float16, ">i4":
            for order in "CF":
                for copy in True, None:
                    array = numpy.array(block(kind), order=order)
                    before = array.copy()
                    with self.subTest(kind=kind, order=order, copy=copy), \
                            warnings.catch_warnings():
                        warnings.simplefilter("error" if copy else "ignore")
                        volume = sg.Volume(array, copy=copy, axes="zyx")
                        own = copy or array.dtype in (numpy.float16, ">i4")
                        array[...] = 0
                        numpy.testing.assert_array_equal(
                            numpy.asarray(volume), before if own else array)
                        self.assertEqual(volume.shape, array.shape)

    def test_types_that_need_a_copy_are_refused_without(self):
        volume = sg.Volume(block())
        for each in volume, volume.render(size=16):
            own = numpy.asarray(each)
            self.assertIs(each.__array__(copy=False).dtype, own.dtype)
            self.assertTrue(numpy.shares_memory(each.__array__(own.dtype, copy=False),
                                                own))
            self.assertFalse(numpy.shares_memory(each.__array__(copy=True), own))
            self.assertEqual(each.__array__("f8").dtype, "f8")
            with self.assertRaisesRegex(ValueError, "^dtype float64: .*leave out copy"):
                each.__array__("f8", copy=False)

    def test_arrays_by_one_way_only(self):
        wanted = numpy.asarray(block())
        for ways in (["__array__"], ["__array_interface__"],
                     ["__dlpack__", "__dlpack_device__"]):
            given = type("Given", (), {
                way: property(lambda self: wanted.__array_interface__)
                if way == "__array_interface__" else
                lambda self, *given, way=way, **more: getattr(wanted, way)(
                    *given, **more) for way in ways})()
            with self.subTest(ways):
                volume = sg.Volume(given)
                numpy.testing.assert_array_equal(numpy.asarray(volume), wanted)
                self.assertTrue(numpy.shares_memory(numpy.asarray(volume), wanted))

    def test_masked_values_are_not_drawn(self):
        for kind, wide in (("u1", "f4"), ("i2", "f4"), ("i4", "f8"), ("f4", "f4")):
            masked = numpy.ma.masked_less(block(kind), 90)
            with self.subTest(kind):
                volume = sg.Volume(masked)
                self.assertEqual(numpy.asarray(volume).dtype, wide)
                self.assertEqual(volume.statistics["finite"], masked.count())
                self.assertEqual(volume.statistics["min"], 90)

    def test_dlpack_of_pictures_and_volumes(self):
        array = block()
        volume = sg.Volume(array)
        image = volume.render(size=16)
        pixels = numpy.from_dlpack(image)
        numpy.testing.assert_array_equal(pixels, numpy.asarray(image))
        self.assertTrue(numpy.shares_memory(pixels, numpy.asarray(image)))
        self.assertEqual(image.__dlpack_device__(), pixels.__dlpack_device__())
        del image
        self.assertGreater(pixels.max(), 0)  # the memory is still there
        try:
            numpy.testing.assert_array_equal(numpy.from_dlpack(volume), array)
        except BufferError as error:  # read-only: not before NumPy 2.1
            self.assertRegex(str(error), r"^the voxels .*numpy\.array\(volume\)$")
        self.assertEqual(volume.__dlpack_device__(), (1, 0))

    def test_dlpack_that_cannot_be_read(self):
        def refuse(self, **_):
            raise BufferError("it is read-only")
        given = type("Frozen", (), {"__dlpack__": refuse, "__dlpack_device__":
                                    lambda self: (1, 0)})()
        with self.assertRaisesRegex(TypeError, "^a Frozen cannot be read by DLPack "
                                    r"\(it is read-only\): give a copy"):
            sg.Volume(given)

    def test_a_closed_volume_says_so(self):
        volume = sg.Volume(block())
        self.assertEqual(repr(volume), "<snowglass.Volume 12x10x8 int16>")
        volume.close()
        self.assertEqual(repr(volume), "<snowglass.Volume, closed>")

    def test_pictures_of_pillow(self):
        try:
            import PIL.Image
        except ImportError:
            self.skipTest("Pillow is missing")
        image = sg.Volume(block()).render(size=(20, 16))
        picture = image.to_pil()
        self.assertIsInstance(picture, PIL.Image.Image)
        self.assertEqual(picture.size, (20, 16))
        numpy.testing.assert_array_equal(numpy.asarray(picture.convert("RGB")),
                                         image.to_rgb())
        self.assertEqual(image.to_pil(background=None).convert("RGBA").getpixel(
            (0, 0))[3], 0)

    def test_series_by_a_pattern(self):
        with tempfile.TemporaryDirectory() as folder:
            place = pathlib.Path(folder)
            for n in 9, 10, 100:
                sg.Volume(block() + n).save(place / f"r_{n}.nrrd")
            steps = [(step.index, os.path.basename(step.path), step.statistics["min"])
                     for step in sg.series(place / "r_*.nrrd")]
            self.assertEqual(steps, [(0, "r_9.nrrd", 9), (1, "r_10.nrrd", 10),
                                     (2, "r_100.nrrd", 100)])
            self.assertEqual(len(list(sg.series(f"{folder}/r_1[0-9]*.nrrd"))), 2)
            sg.Volume(block()).save(place / "a[1].nrrd")  # a name, and no pattern
            self.assertEqual([step.path for step in sg.series(place / "a[1].nrrd")],
                             [str(place / "a[1].nrrd")])
            with self.assertRaisesRegex(FileNotFoundError, "no such file"):
                next(sg.series(place / "x_*.nrrd"))


class Bar:
    """What of tqdm is used."""
    all = []

    def __init__(self, desc, total, unit):
        self.desc, self.n, self.closed = desc, 0, False
        assert total == 100 and all(bar.closed for bar in self.all)
        self.all.append(self)

    def update(self, more):
        assert more >= 0 and not self.closed
        self.n += more

    def close(self):
        self.closed = True


class Progress(unittest.TestCase):
    def turn(self, modules):
        with tempfile.TemporaryDirectory() as folder, \
                unittest.mock.patch.dict(sys.modules, modules), \
                contextlib.redirect_stderr(io.StringIO()) as said:
            sg.Volume(block()).turntable(f"{folder}/t_%d.png", frames=4, size=16,
                                         progress=True)
        return said.getvalue()

    def test_a_line_is_printed(self):
        self.assertEqual(self.turn({"tqdm": None, "tqdm.auto": None}),
                         "turntable  25 %\rturntable  50 %\rturntable  75 %\r"
                         "turntable 100 %\n")

    def test_a_bar_of_tqdm(self):
        Bar.all = []
        auto = type(sys)("tqdm.auto")
        auto.tqdm = Bar
        self.assertEqual(self.turn({"tqdm": type(sys)("tqdm"), "tqdm.auto": auto}), "")
        self.assertEqual([(bar.desc, bar.n, bar.closed) for bar in Bar.all],
                         [("turntable", 100, True)])

    def test_each_stage_has_a_bar(self):
        Bar.all = []
        bars = _progress._Bars(Bar)
        for stage, fraction in (("read", 0.3), ("read", 0.6), ("draw", 0.5),
                                ("draw", 1), ("draw", 0.2)):
            bars(stage, fraction)
        self.assertEqual([(bar.desc, bar.n, bar.closed) for bar in Bar.all],
                         [("read", 60, True), ("draw", 100, True), ("draw", 20, False)])
