"""Measures: lengths, angles and ellipses beside NumPy's, drawn, and in recipes."""
import numpy

import snowglass as sg
from beside import InFolder

STEPS, FIRST = numpy.diag([0.7, 1.3, 2.9]), numpy.array([10.0, -20, 30])


def affine(degrees):
    c, s = numpy.cos(numpy.radians(degrees)), numpy.sin(numpy.radians(degrees))
    made = numpy.eye(4)
    made[:3, :3], made[:3, 3] = numpy.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]) @ STEPS, FIRST
    return made


def word(point):
    return ",".join(f"{x:.9g}" for x in point)


class Measures(InFolder):
    def setUp(self):
        super().setUp()
        self.voxels = numpy.random.default_rng(3).normal(50, 20, (20, 24, 16)).astype("f4")

    def volume(self, degrees):
        return sg.Volume(self.voxels, axes="xyz", affine=affine(degrees), unit="mm",
                         medical=True)

    def test_lengths_angles_and_ellipses_are_those_of_numpy(self):
        matrix = affine(20)
        a, b, c, middle, u, v = (
            matrix[:3, :3] @ at + FIRST for at in (
                [2, 3, 4], [15, 9, 11], [7, 20, 5], [9, 11, 6], [14.3, 13, 6], [7, 17.2, 6]))
        line, angle, ellipse = self.volume(20).measure(
            f"line {word(a)} {word(b)}; angle {word(a)} {word(b)} {word(c)};"
            f"ellipse z {middle[2]} {word(middle)} {word(u)} {word(v)}")
        self.assertAlmostEqual(line["length"], numpy.linalg.norm(a - b), 5)
        self.assertEqual((line["kind"], line["unit"], len(line["points"])), ("line", "mm", 2))
        cosine = (a - b) @ (c - b) / numpy.linalg.norm(a - b) / numpy.linalg.norm(c - b)
        self.assertAlmostEqual(angle["degrees"], numpy.degrees(numpy.arccos(cosine)), 4)
        i, j = numpy.meshgrid(range(20), range(24), indexing="ij")
        shares = numpy.linalg.solve(numpy.array([[5.3, 2], [-2, 6.2]]).T,
                                    numpy.stack([i - 9, j - 11]).reshape(2, -1))
        inside = self.voxels[..., 6].reshape(-1)[(shares**2).sum(0) <= 1 + 1e-9].astype("f8")
        self.assertEqual((ellipse["count"], ellipse["index"]), (inside.size, 6))
        self.assertAlmostEqual(ellipse["mean"], inside.mean(), 6)
        self.assertAlmostEqual(ellipse["deviation"], inside.std(ddof=1), 6)
        self.assertEqual((ellipse["min"], ellipse["max"]), (inside.min(), inside.max()))

    def test_they_are_drawn_when_a_picture_is_saved(self):
        volume = self.volume(0)
        text = f"line {word(FIRST + STEPS @ [2, 2, 8])} {word(FIRST + STEPS @ [17, 20, 8])}"
        for draw in (lambda **more: volume.render(size=200, **more),
                     lambda **more: volume.slice("z", 8, size=200, **more)):
            plain, drawn = draw(), draw(measure=text)
            self.assertEqual(plain.checksum, drawn.checksum)
            self.assertNotEqual(plain.png(), drawn.png())
            self.assertEqual(drawn.stats["measures"], volume.measure(text))
        off = volume.slice("z", 7, size=200, measure=text)
        self.assertEqual(off.png(), volume.slice("z", 7, size=200).png())
        self.assertEqual(len(off.stats["measures"]), 1)

    def test_recipes_have_them(self):
        self.volume(20).save("v.nrrd")
        volume = sg.Volume("v.nrrd")
        text = f"line {word(FIRST)} {word(affine(20)[:3, :3] @ [18, 22, 14] + FIRST)}"
        for image in volume.render(size=200, measure=text), volume.slice("z", 8, measure=text):
            self.assertEqual(image.recipe["measure"], text)
            self.assertIn("--measure 'line ", image.command)
        image = volume.render(size=200, measure=text)
        again = sg.render(**image.recipe)
        self.assertEqual(again.png(), image.png())
        self.assertEqual(again.stats["measures"], image.stats["measures"])

    def test_what_is_wrong_is_refused(self):
        volume = self.volume(0)
        for text in "line 1,2", "lin 0,0,0 1,1,1", "line 10,0,40 11,0,41; ellipse q 1 1,1 1 1":
            with self.assertRaisesRegex(ValueError, "such as"):
                volume.measure(text)
        with self.assertRaisesRegex(ValueError, "outside the volume"):
            volume.render(measure="line 10,0,40 500,1,1")
        with self.assertRaisesRegex(TypeError, "measure"):
            volume.slice(measure=7)
