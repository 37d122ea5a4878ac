"""Measures: lengths, angles and ellipses beside NumPy's, drawn, and in recipes; points of
the world and pixels of pictures."""
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


MIDDLE, RADIUS = numpy.array([10.0, -20, 30]), 9.0


def oblique(order="F"):
    """The distance to a sphere, on a grid that is neither even nor upright."""
    shape = numpy.array([26, 30, 22])
    steps = numpy.array([[0.9, 0.2, 0], [-0.3, 1, 0.3], [0.1, -0.2, 1.2]])
    affine = numpy.eye(4)
    affine[:3, :3], affine[:3, 3] = steps, MIDDLE - steps @ ((shape - 1) / 2)
    index = numpy.indices(shape).reshape(3, -1)
    away = numpy.linalg.norm(steps @ index + affine[:3, 3:] - MIDDLE[:, None], axis=0)
    voxels = (RADIUS - away).reshape(shape).astype("f4")
    return sg.Volume(numpy.asarray(voxels, order=order), axes="xyz", affine=affine)


class Places(InFolder):
    def test_depths_are_points_of_the_surface(self):
        for order in "CF":
            for more in ({}, {"perspective": 40}, {"target": (12, -19, 31), "zoom": 1.3},
                         {"position": (60, -50, 80), "target": (11, -20, 30),
                          "perspective": 25}, {"legend": True}):
                image = oblique(order).render(mode="iso", iso=0, size=(120, 90), azimuth=25,
                                              elevation=-40, roll=9, depth=True, **more)
                y, x = numpy.mgrid[:90, :120] + 0.5
                pixels = numpy.stack([x, y, numpy.asarray(image.depth)], -1)
                points = image.pixel_to_world(pixels)
                self.assertEqual(points.shape, (90, 120, 3))
                seen = numpy.isfinite(pixels[..., 2])
                self.assertTrue((numpy.isfinite(points).all(-1) == seen).all())
                self.assertGreater(seen.sum(), 900)
                away = numpy.linalg.norm(points[seen] - MIDDLE, axis=-1)
                self.assertLess(abs(away - RADIUS).max(), 0.2)
                self.assertLess(abs(image.world_to_pixel(points[seen]) - pixels[seen]).max(), 1e-6)

    def test_the_target_is_in_the_middle(self):
        image = oblique().render(size=(120, 90), target=(12, -19, 31), view="iso",
                                 fit="volume")
        self.assertTrue(numpy.allclose(image.world_to_pixel((12, -19, 31)), (60, 45, 0)))

    def test_voxels_of_a_slice_are_its_pixels(self):
        volume = sg.Volume(numpy.zeros((5, 30, 40), "u1"), spacing=0.5)
        image = volume.slice("z", 2)
        self.assertTrue(numpy.allclose(image.world_to_pixel([[0, 0, 1], [6, 10, 1]]),
                                       [[0.5, 29.5, 0], [12.5, 9.5, 0]]))

    def test_what_knows_no_world_says_so(self):
        volume = oblique()
        image = volume.render(mode="iso", iso=0, depth=True, size=40)
        image.save("a.png")
        for each in (image.depth, sg.Image.load("a.png"), volume.slice_ortho()):
            with self.assertRaisesRegex(ValueError, "ask one of Volume.render"):
                each.world_to_pixel((1, 2, 3))
        for wrong in (3, (1, 2), "abc", [[1, 2, 3, 4]], [[1, 2], [3]]):
            with self.assertRaisesRegex(ValueError, "pixels: give three numbers"):
                image.pixel_to_world(wrong)
