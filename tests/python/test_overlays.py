"""Overlays: pictures are those of the command line, whatever the overlay is.

    SNOWGLASS=build/snowglass PYTHONPATH=build/python python3 -m unittest -v
"""
import os
import shlex
import subprocess
import tempfile
import unittest
import warnings

import numpy

import snowglass as sg

TOOL = os.environ.get("SNOWGLASS", "snowglass")
SIDE = 24
AFFINE = numpy.array([[1, 0, 0, 5], [0, 1, 0, 6], [0, 0, 1.5, 7],
                      [0, 0, 0, 1.0]])
Z, Y, X = numpy.mgrid[0:SIDE, 0:SIDE, 0:SIDE]
VALUES = (4 * X + 3 * Y + 2 * Z).astype(numpy.uint8)
LABELS = ((X < 9) & (Y > 8)).astype(numpy.uint8) + 3 * ((X > 13) & (Z > 9))
LABELS = LABELS.astype(numpy.uint8)
LOOK = sg.Look(colormap="grey", range=(40, 200),
               opacity=[(40, 0), (200, 0.3)])


def volume(array, affine=AFFINE):
    return sg.Volume(array, affine=affine, medical=True)


class Overlays(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.values, self.labels = (os.path.join(self.folder.name, name)
                                    for name in ("values.nrrd", "labels.nrrd"))
        volume(VALUES).save(self.values)
        volume(LABELS).save(self.labels)

    def by_tool(self, *words):
        path = os.path.join(self.folder.name, "tool.npy")
        subprocess.run([TOOL, *words, "-o", path, "-q", "-y"], check=True)
        return numpy.load(path)

    def test_the_picture_is_that_of_the_command_line(self):
        base = sg.Volume(self.values)
        drawn = numpy.asarray(base.render(LOOK, size=64, overlay=self.labels))
        words = ["render", self.values, "-s", "64", "--overlay", self.labels,
                 "--colormap", "grey", "--range", "40,200", "--opacity",
                 "40:0,200:0.3"]
        numpy.testing.assert_array_equal(drawn, self.by_tool(*words))
        without = numpy.asarray(base.render(LOOK, size=64))
        self.assertNotEqual(drawn.shape, without.shape)  # labels have colours

    def test_arrays_and_volumes_are_as_their_files(self):
        base = sg.Volume(self.values)
        first = base.render(LOOK, size=64, overlay=self.labels).checksum
        for each in (LABELS, volume(LABELS), sg.Volume(self.labels),
                     numpy.asfortranarray(LABELS)):
            again = base.render(LOOK, size=64, overlay=each)
            self.assertEqual(again.checksum, first)
        turned = AFFINE.copy()
        turned[:3, 3] += AFFINE[:3, 0] * (SIDE - 1)
        turned[:3, 0] *= -1
        flipped = volume(LABELS[:, :, ::-1].copy(), turned)
        again = base.render(LOOK, size=64, overlay=flipped)
        self.assertEqual(again.checksum, first)
        self.assertNotEqual(base.render(LOOK, size=64).checksum, first)

    def test_a_volume_keeps_the_colours_of_its_labels(self):
        base = sg.Volume(self.values)
        plain = base.render(LOOK, size=64, overlay=self.labels).checksum
        table = os.path.join(self.folder.name, "names.txt")
        with open(table, "w", encoding="utf-8") as file:
            file.write('1 255 255 0 1 1 1 "one"\n3 0 255 255 1 1 1 "three"\n')
        with open(self.labels, "rb") as file:
            data = file.read()
        named = os.path.join(self.folder.name, "named.nrrd")
        with open(named, "wb") as file:
            file.write(data.replace(
                b"\n\n", b"\nSegment0_LabelValue:=1\nSegment0_Color:=1 1 0\n"
                b"Segment1_LabelValue:=3\nSegment1_Color:=0 1 1\n\n", 1))
        first = base.render(LOOK, size=64, overlay=named)
        self.assertNotEqual(first.checksum, plain)
        for each in (sg.Volume(named), sg.Volume(self.labels, label_table=table)):
            again = base.render(LOOK, size=64, overlay=each)
            self.assertEqual(again.checksum, first.checksum)
        spots = numpy.asarray(first)[..., :3] > 0.2
        self.assertTrue((spots[..., 0] & spots[..., 1] & ~spots[..., 2]).any())
        self.assertTrue((~spots[..., 0] & spots[..., 1] & spots[..., 2]).any())

    def test_values_have_a_look(self):
        base = sg.Volume(self.values)
        look = sg.Look(colormap="viridis", range=(10, 90),
                       opacity=[(10, 0), (90, 0.5)])
        array = (X * Y).astype(numpy.float32)
        drawn = base.render(LOOK, size=64, overlay=array, overlay_look=look)
        hot = base.render(LOOK, size=64, overlay=array)
        self.assertNotEqual(drawn.checksum, hot.checksum)
        with self.assertRaises(TypeError):
            base.render(LOOK, overlay_look=look)
        with self.assertRaises(ValueError):  # of another shape
            base.render(LOOK, overlay=array[1:])

    def test_a_recipe_draws_the_same(self):
        base = sg.Volume(self.values)
        look = sg.Look(colormap="viridis", range=(0, 3),
                       opacity=[(0, 0), (3, 0.5)])
        for given in (None, look):
            image = base.render(LOOK, size=64, overlay=self.labels,
                                overlay_look=given)
            again = sg.render(**image.recipe)
            self.assertEqual(again.checksum, image.checksum)
            words = shlex.split(image.command)[1:]
            numpy.testing.assert_array_equal(numpy.asarray(image),
                                             self.by_tool(*words))
        with self.assertRaises(ValueError):
            base.render(LOOK, size=64, overlay=LABELS).recipe

    def test_planes_cut_both(self):
        plane = (1, 0.5, 0, 20)
        base = sg.Volume(self.values, clip=[plane])
        drawn = numpy.asarray(base.render(LOOK, size=64, overlay=self.labels))
        words = ["render", self.values, "-s", "64", "--overlay", self.labels,
                 "--colormap", "grey", "--range", "40,200", "--opacity",
                 "40:0,200:0.3", "--clip", "1,0.5,0,20"]
        numpy.testing.assert_array_equal(drawn, self.by_tool(*words))

    def test_a_turntable_turns_both(self):
        base = sg.Volume(self.values)
        pattern = os.path.join(self.folder.name, "turn_%d.png")
        base.turntable(pattern, LOOK, frames=2, size=64, overlay=self.labels)
        tool = os.path.join(self.folder.name, "tool_%d.png")
        subprocess.run([TOOL, "turntable", self.values, "--overlay",
                        self.labels, "--frames", "2", "-s", "64", "--colormap",
                        "grey", "--range", "40,200", "--opacity",
                        "40:0,200:0.3", "-o", tool, "-q"], check=True)
        for n in range(2):
            with open(pattern % n, "rb") as one, open(tool % n, "rb") as other:
                self.assertEqual(one.read(), other.read())

    def test_another_grid_is_resampled_and_told(self):
        coarse = AFFINE.copy()
        coarse[:3, :3] *= 2
        base = sg.Volume(self.values)
        with warnings.catch_warnings(record=True) as told:
            warnings.simplefilter("always")
            other = volume(LABELS[::2, ::2, ::2].copy(), coarse)
            drawn = base.render(LOOK, size=64, overlay=other)
        self.assertIn("another grid", str(told[0].message))
        other.save(self.labels)
        words = ["render", self.values, "-s", "64", "--overlay", self.labels,
                 "--colormap", "grey", "--range", "40,200", "--opacity",
                 "40:0,200:0.3"]
        numpy.testing.assert_array_equal(numpy.asarray(drawn),
                                         self.by_tool(*words))


if __name__ == "__main__":
    unittest.main()
