"""Overlays: pictures are those of the command line, whatever the overlay is."""
import numpy

import snowglass as sg
from beside import InFolder

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


class Overlays(InFolder):
    def setUp(self):
        super().setUp()
        volume(VALUES).save("values.nrrd")
        volume(LABELS).save("labels.nrrd")
        self.base = sg.Volume("values.nrrd")

    def draw(self, overlay="labels.nrrd", **options):
        return self.base.render(LOOK, size=64, overlay=overlay, **options)

    WORDS = ["values.nrrd", "-s", "64", "--overlay", "labels.nrrd", "--colormap", "grey",
             "--range", "40,200", "--opacity", "40:0,200:0.3"]

    def test_the_picture_is_that_of_the_command_line(self):
        drawn = self.draw()
        self.same_floats(drawn, "render", *self.WORDS)
        self.assertNotEqual(drawn.shape, self.draw(None).shape)  # labels have colours
        clipped = sg.Volume("values.nrrd", clip=[(1, 0.5, 0, 20)])
        self.same_floats(clipped.render(LOOK, size=64, overlay="labels.nrrd"),
                         "render", *self.WORDS, "--clip", "1,0.5,0,20")
        self.same_frames(lambda *to, **options: self.base.turntable(
            *to, LOOK, size=64, overlay="labels.nrrd", **options),
                         "turntable", *self.WORDS)

    def test_arrays_and_volumes_are_as_their_files(self):
        first = self.draw().checksum
        turned = AFFINE.copy()
        turned[:3, 3] += AFFINE[:3, 0] * (SIDE - 1)
        turned[:3, 0] *= -1
        for each in (LABELS, volume(LABELS), sg.Volume("labels.nrrd"),
                     numpy.asfortranarray(LABELS),
                     volume(LABELS[:, :, ::-1].copy(), turned)):
            self.assertEqual(self.draw(each).checksum, first)
        self.assertNotEqual(self.draw(None).checksum, first)

    def test_a_volume_keeps_the_colours_of_its_labels(self):
        with open("names.txt", "w", encoding="utf-8") as file:
            file.write('1 255 255 0 1 1 1 "one"\n3 0 255 255 1 1 1 "three"\n')
        with open("named.nrrd", "wb") as file:
            file.write(self.bytes_of("labels.nrrd").replace(
                b"\n\n", b"\nSegment0_LabelValue:=1\nSegment0_Color:=1 1 0\n"
                b"Segment1_LabelValue:=3\nSegment1_Color:=0 1 1\n\n", 1))
        first = self.draw("named.nrrd")
        self.assertNotEqual(first.checksum, self.draw().checksum)
        for each in (sg.Volume("named.nrrd"),
                     sg.Volume("labels.nrrd", label_table="names.txt")):
            self.assertEqual(self.draw(each).checksum, first.checksum)
        spots = numpy.asarray(first)[..., :3] > 0.2
        self.assertTrue((spots[..., 0] & spots[..., 1] & ~spots[..., 2]).any())
        self.assertTrue((~spots[..., 0] & spots[..., 1] & spots[..., 2]).any())

    def test_values_have_a_look(self):
        look = sg.Look(colormap="viridis", range=(10, 90),
                       opacity=[(10, 0), (90, 0.5)])
        array = (X * Y).astype(numpy.float32)
        self.assertNotEqual(self.draw(array, overlay_look=look).checksum,
                            self.draw(array).checksum)
        with self.assertRaises(TypeError):
            self.base.render(LOOK, overlay_look=look)
        with self.assertRaises(ValueError):  # of another shape
            self.draw(array[1:])

    def test_a_recipe_draws_the_same(self):
        for look in (None, sg.Look(colormap="viridis", range=(0, 3),
                                   opacity=[(0, 0), (3, 0.5)])):
            self.round_trip(self.draw(overlay_look=look))
        with self.assertRaises(ValueError):
            self.draw(LABELS).recipe

    def test_another_grid_is_resampled_and_told(self):
        coarse = AFFINE.copy()
        coarse[:3, :3] *= 2
        other = volume(LABELS[::2, ::2, ::2].copy(), coarse)
        with self.assertWarnsRegex(sg.SnowglassWarning, "another grid"):
            drawn = self.draw(other)
        other.save("labels.nrrd")
        self.same_floats(drawn, "render", *self.WORDS)

    def test_legends_cover_nothing(self):
        """50 pictures of 200 to 4000 pixels: boxes of what a legend has drawn, beside
        the opacity of the picture."""
        random = numpy.random.default_rng(3)
        head, labels = sg.Volume("phantom:head", dims=(20, 20, 20)), volume(LABELS)
        for n in range(50):
            size = (4000, 700) if n == 0 else (700, 4000) if n == 1 else \
                tuple(map(int, 200 * 4.5 ** random.random(2)))
            overlay = {"overlay": "labels.nrrd"} if n % 3 == 1 else {}
            drawn = (self.base if overlay else labels if n % 3 else head).render(
                "viridis" if n % 2 or overlay else None, size=size, legend=True,
                letters=False, quality="draft", azimuth=float(random.uniform(0, 360)),
                elevation=float(random.uniform(-60, 60)), **overlay)
            drawn.save("with.png")
            drawn._annotations = {"letters": False, "legend": False}
            drawn.save("without.png")
            shown, plain = (sg.Image.load(path).to_rgb() for path in
                            ("with.png", "without.png"))
            marks = (shown != plain).any(-1)
            rows, columns = numpy.nonzero(marks)
            self.assertGreater(len(rows), 100, size)
            box = numpy.asarray(drawn)[rows.min():rows.max() + 1,
                                       columns.min():columns.max() + 1, -1]
            self.assertLessEqual(box.max(), 0.02, size)
            self.assertLess(columns.max() - columns.min(), 0.14 * size[0] + 80, size)
