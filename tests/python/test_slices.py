"""Slices and recipes of the Python package, beside NumPy and the command line."""
import itertools
import json

import numpy

import snowglass as sg
from beside import InFolder


class Slices(InFolder):
    def setUp(self):
        super().setUp()
        random = numpy.random.default_rng(2)
        self.array = random.integers(0, 900, (5, 6, 7)).astype(numpy.int16)
        self.volume = sg.Volume(self.array, spacing=(1.5, 1.5, 1.5))

    def test_several_slices_in_one_picture(self):
        low, high = self.array.min(), self.array.max()
        grey = (self.array[:, ::-1].astype(float) - low) / (high - low)
        image = self.volume.slice_grid(2, 1, at=range(1, 5))
        self.assertEqual(image.stats["indices"], [2, 4])
        pixels = numpy.asarray(image)
        self.assertEqual(pixels.shape, (6, 16, 4))
        numpy.testing.assert_allclose(pixels[:, :7, 0], grey[2], atol=1e-5)
        numpy.testing.assert_allclose(pixels[:, 9:, 0], grey[4], atol=1e-5)
        image = self.volume.slice_ortho((1.5 * 2, 1.5 * 4, 1.5 * 3))
        self.assertEqual(image.stats["indices"], [3, 4, 2])
        values = numpy.asarray(image)[..., 0]
        self.assertEqual(values.shape, (6, 7 + 2 + 7 + 2 + 6))
        free = numpy.asarray(image)[..., 1] == values  # of the lines
        numpy.testing.assert_allclose((values - grey[3].max())[0, :2],
                                      (grey[3] - grey[3].max())[0, :2], atol=1e-5)
        self.assertTrue(free.any() and not free.all())
        self.volume.save("grid.nrrd")
        volume = sg.Volume("grid.nrrd")
        self.same(volume.slice_grid(3, 2, size=(300, 200)),
                  "slice", "grid.nrrd", "--grid", "3x2", "-s", "300x200")
        self.same(volume.slice_ortho(size=(300, 200)),
                  "slice", "grid.nrrd", "--ortho", "-s", "300x200")

    def test_letters_of_36_grids(self):
        """Whatever lies where in memory, the patient and the letters are alike."""
        expected = None
        for order in itertools.permutations(range(3)):
            for flips in list(itertools.product((False, True), repeat=3))[1:7]:
                affine = numpy.diag([0.0, 0, 0, 1])
                for axis, of in enumerate(order):
                    back = flips[axis]
                    affine[2 - of, 2 - axis] = -1.5 if back else 1.5
                    affine[2 - of, 3] = 1.5 * (self.array.shape[of] - 1) * back
                array = self.array.transpose(order)[
                    tuple(slice(None, None, -1 if back else 1) for back in flips)]
                volume = sg.Volume(numpy.ascontiguousarray(array), affine=affine,
                                   medical=True)
                image = volume.slice_ortho((3, 4.5, 3), size=(300, 120))
                letters = [text[-1] for text in image._annotations["texts"]]
                self.assertEqual(letters, list("RLAPRLSIAPSI"), (order, flips))
                expected = numpy.asarray(image) if expected is None else expected
                numpy.testing.assert_allclose(numpy.asarray(image), expected, atol=1e-4)

    def test_overlays_and_movies(self):
        labels = (self.array > 500).astype(numpy.uint8)
        self.volume.save("a.nrrd")
        sg.Volume(labels, spacing=(1.5, 1.5, 1.5)).save("l.nrrd")
        volume, over = sg.Volume("a.nrrd"), ["--overlay", "l.nrrd"]
        for outline in (False, True):
            words = [*over, *(["--overlay-look", "outline"] * outline)]
            laid = {"overlay": "l.nrrd", "outline": outline, "size": (160, 120)}
            with self.subTest(outline=outline):
                self.same(volume.slice("axial", 3, **laid), "slice", "a.nrrd", "--at",
                          "3", "-s", "160x120", *words)
                self.same(volume.slice_grid(2, 2, "coronal", **laid), "slice", "a.nrrd",
                          "--axis", "coronal", "--grid", "2x2", "-s", "160x120", *words)
                self.same(volume.slice_ortho(**laid), "slice", "a.nrrd", "--ortho",
                          "-s", "160x120", *words)
                self.same_frames(
                    lambda path, **options: volume.slice_movie(
                        path, "sagittal", range(1, 6), **laid, **options),
                    "slice", "a.nrrd", "--axis", "sagittal", "--at", "1:6", "-s",
                    "160x120", *words)
        self.same(volume.slice("axial", 3, overlay=labels, size=(160, 120)), "slice",
                  "a.nrrd", "--at", "3", "-s", "160x120", *over)
        self.same_frames(lambda path, **options: volume.slice_movie(
            path, legend=True, size=200, look="viridis", **options),
                         "slice", "a.nrrd", "-c", "viridis", "-s", "200", "--legend")
        with self.assertRaisesRegex(TypeError, "outline is of an overlay"):
            volume.slice(outline=True)
        with self.assertRaisesRegex(ValueError, "across x: give 0 to 6"):
            volume.slice_movie("s_%d.png", "x", range(9))

    def test_values_are_those_of_the_array(self):
        for axis, expected in [
                ("z", self.array[3, ::-1]), ("axial", self.array[3, ::-1]),
                ("y", self.array[::-1, 3]), ("coronal", self.array[::-1, 3]),
                ("x", self.array[::-1, :, 3]),
                ("sagittal", self.array[::-1, :, 3])]:
            with self.subTest(axis):
                got = self.volume.slice_values(axis, 3)
                self.assertEqual(got.dtype, numpy.float32)
                numpy.testing.assert_array_equal(got, expected)
        patient = sg.Volume(self.array, spacing=(1.5, 1.5, 1.5), medical=True)
        numpy.testing.assert_array_equal(patient.slice_values("axial", 3),
                                         self.array[3, ::-1, ::-1])

    def test_slices_that_are_shifted_against_each_other(self):
        affine = numpy.eye(4)
        affine[:2, 2] = 0.6, -0.3
        volume = sg.Volume(self.array, affine=affine, medical=False)
        for index in (0, 4):
            numpy.testing.assert_array_equal(volume.slice_values("z", index),
                                             self.array[index, ::-1])

    def test_places(self):
        image = self.volume.slice("y", "4.4mm")
        self.assertEqual(image.stats, {"axis": "y", "index": 3,
                                       "position": 4.5})
        self.assertEqual(self.volume.slice("y").stats["index"], 3)
        self.assertEqual(self.volume.slice("z", numpy.int64(4)).stats["index"],
                         4)
        for bad in (-1, 6, "6", "9mm", "-1mm", "4s", "here", "2.5"):
            with self.assertRaisesRegex(ValueError, "across y: give 0 to 5, or "
                                        "a position from '0mm' to '7.5mm'"):
                self.volume.slice("y", bad)
        with self.assertRaises(TypeError):
            self.volume.slice("y", 2.5)
        with self.assertRaisesRegex(ValueError, "axial, coronal or sagittal"):
            self.volume.slice("w")

    def test_colors_and_files(self):
        image = self.volume.slice("z", 2, sg.Look(range=(0, 900)), size=(70, 60))
        pixels = numpy.asarray(image)
        self.assertEqual(pixels.shape, (60, 70, 2))
        self.assertTrue((pixels[..., 1] == 1).all())
        values = self.volume.slice_values("z", 2, size=(70, 60))
        numpy.testing.assert_allclose(pixels[..., 0], values / 900, atol=1e-6)
        colored = self.volume.slice("z", 2, "viridis", legend=True, size=200)
        self.assertEqual(colored.shape, (200, 200, 4))
        plain = self.volume.slice("z", 2, "viridis", size=200)
        self.check_strip(colored)
        colored.save("with.png")
        plain.save("without.png")
        self.assertGreater(sg.compare("with.png", "without.png").largest, 0.5)

    def check_strip(self, picture):
        """An eighth of the width is left to the legend, and nothing else."""
        alpha = numpy.asarray(picture)[..., -1]
        self.assertEqual(alpha[:, -25:].max(), 0)
        self.assertEqual(alpha[:, :100].max(), 1)

    def test_defaults_are_those_of_the_slice(self):
        rising = numpy.linspace(0, 5e-3, self.array.size, dtype=numpy.float32)
        for array, options in (
                (self.array, {"medical": True}),
                (rising.reshape(self.array.shape), {}),
                (numpy.asfortranarray(self.array), {"axes": "zyx"}),
                (self.array.astype(numpy.uint8), {"slope": 2, "intercept": 1})):
            volume = sg.Volume(array, spacing=(1, 2, 3), **options)
            volume.save("a.mha")
            for axis in ("axial", "y", "sagittal"):
                for words, look in (([], None), (["-c", "viridis"], "viridis")):
                    with self.subTest(axis, type=array.dtype, look=look):
                        self.same([each.slice(axis, 3, look, legend=True)
                                   for each in (volume, sg.Volume("a.mha"))],
                                  "slice", "a.mha", "--axis", axis, "--at", "3",
                                  "--legend", *words)

    def test_lengths_of_vectors_are_in_colours(self):
        array = numpy.random.default_rng(1).normal(size=(5, 6, 7, 3)).astype("f4")
        numpy.save("v.npy", array)
        with self.assertWarnsRegex(sg.SnowglassWarning, "magnitude of the 3"):
            volume = sg.Volume("v.npy")
        image = volume.slice("z", 2)
        rgb = numpy.asarray(image)[::-1, :, :3]
        self.assertEqual(rgb.shape, (6, 7, 3))
        length = numpy.linalg.norm(array[2], axis=-1)
        low, high = rgb.reshape(-1, 3)[[length.argmin(), length.argmax()]]
        numpy.testing.assert_allclose(low, (0.267, 0.005, 0.329), atol=0.01)
        numpy.testing.assert_allclose(high, (0.993, 0.906, 0.144), atol=0.01)
        self.same(image, "slice", "v.npy", "--axis", "z", "--at", "2")
        self.same(volume.slice_grid(2, 2, "z"), "slice", "v.npy", "--axis", "z", "--grid",
                  "2x2")

    def test_directions_of_vectors_are_in_colours(self):
        arrows = numpy.random.default_rng(4).normal(0, 1, (5, 6, 7, 3)).astype("<f4")
        with open("arrows.nrrd", "wb") as file:
            file.write(b"NRRD0004\ntype: float\ndimension: 4\nsizes: 3 7 6 5\nkinds: "
                       b"vector domain domain domain\nendian: little\nencoding: raw\n"
                       b"\n" + arrows.tobytes())
        with self.assertWarnsRegex(sg.SnowglassWarning, "magnitude of the 3"):
            volume = sg.Volume("arrows.nrrd")
        length = numpy.linalg.norm(arrows, axis=-1)
        numpy.testing.assert_allclose(volume, length, rtol=1e-6)
        pixels = numpy.asarray(volume.slice("z", 2))[::-1, :, :3]
        numpy.testing.assert_allclose(pixels, numpy.abs(arrows[2]) / length[2].max(),
                                      atol=1e-5)
        self.same(volume.slice("z", 2), "slice", "arrows.nrrd", "--axis", "z", "--at",
                  "2")
        self.same(volume.slice_grid(2, 2), "slice", "arrows.nrrd", "--grid", "2x2")
        self.same(volume.slice("z", 2, look="grey"), "slice", "arrows.nrrd", "--axis",
                  "z", "--at", "2", "-c", "grey")

    def test_masks_hold_for_the_default_of_a_slice(self):
        mask = (self.array > 300).astype(numpy.uint8)
        sg.Volume(mask, spacing=(1.5, 1.5, 1.5)).save("m.nrrd")
        self.volume.save("a.nrrd")
        self.same([each.slice("axial", 3) for each in (
            self.volume.masked(mask), sg.Volume("a.nrrd", mask="m.nrrd"))],
                  "slice", "a.nrrd", "--mask", "m.nrrd", "--at", "3")

    def test_masked_bytes_are_no_hounsfield_units_in_a_slice_either(self):
        small = (self.array // 4).astype(numpy.uint8)
        sg.Volume(small).save("a.nrrd")
        sg.Volume((small > 60).astype(numpy.uint8)).save("m.nrrd")
        with self.assertWarnsRegex(sg.SnowglassWarning, "of 8 bits"):
            image = sg.Volume("a.nrrd", mask="m.nrrd").slice(look="ct-bone")
        self.same(image, "slice", "a.nrrd", "--mask", "m.nrrd", "--preset", "ct-bone")

    def test_they_are_those_of_the_command_line(self):
        self.volume.save("a.nrrd")
        for axis, at, size in (("axial", 1, None), ("x", "4.5mm", (33, 44))):
            words = ["-s", f"{size[0]}x{size[1]}"] if size else []
            self.same_floats(self.volume.slice_values(axis, at, size=size), "slice",
                             "a.nrrd", "--axis", axis, "--at", str(at), *words)
        self.same(self.volume.slice(look=sg.Look(range=(100, 600))), "slice", "a.nrrd",
                  "--range", "100,600", "--bits", "16", bits=16)


class Recipes(InFolder):
    CASES = [
        {},
        {"view": "left", "azimuth": 30, "quality": "high", "size": (90, 70)},
        {"look": sg.Look(cmap="viridis", clim=(50, 200)), "perspective": True},
        {"look": sg.Look(range="5%,95%"), "zoom": 1.5, "light": (20, 40)},
        {"look": sg.Look(opacity=[(80, 0), (200, .7)],
                         gradient_opacity=[(0, 0), (20, 1)]), "shade": "none"},
        {"mode": "mip", "fit": "volume", "threads": 2},
        {"mode": "iso", "iso": 120.5, "light": "head", "letters": False},
        {"look": "mr-default", "target": (30, 31, 20), "up": [1, 0, 1],
         "roll": -5.25, "opacity_length": 1.0, "depth_darkening": 0.5},
    ]

    def draw(self, options):
        volume = sg.Volume("head.nrrd", crop=((2, 60), (0, 0), (3, 0)),
                           clip=[(1, 0, 0, 45.5)])
        return volume.render(options.get("look"), **{
            "size": 64, **{name: value for name, value in options.items()
                           if name != "look"}})

    def setUp(self):
        super().setUp()
        sg.Volume("phantom:head", dims=(64, 64, 48)).save("head.nrrd")

    def test_a_recipe_and_a_command_give_the_same_bits(self):
        for options in self.CASES:
            with self.subTest(options):
                image = self.draw(options)
                self.round_trip(image)
                self.assertIn(" render head.nrrd ", image.command)

    def test_a_file_of_the_command_line(self):
        self.tool("render", "head.nrrd", "-s", "80x60", "--view", "left", "-c",
                  "viridis", "--range", "p10,p90", "-o", "a.npy", "--save-config", "a.json")
        with open("a.json", encoding="ascii") as file:
            recipe = json.load(file)
        with open("b.json", "w", encoding="ascii") as file:
            json.dump(self.draw(self.CASES[1]).recipe, file)
        self.same_floats(sg.render(**recipe), "render", "--config", "a.json")
        self.same_floats(self.draw(self.CASES[1]), "render", "--config", "b.json")

    def test_a_file_of_a_slice(self):
        for words in (["--axis", "coronal", "--at", "20"],
                      ["--axis", "x", "--at", "30", "-s", "90x80", "-c",
                       "viridis", "--legend", "--no-labels", "--kernel", "box",
                       "--crop", "2:50,0:64,3:48", "--threads", "1"], []):
            with self.subTest(words):
                self.tool("slice", "head.nrrd", *words, "-o", "a.png", "--save-config",
                          "a.json")
                with open("a.json", encoding="ascii") as file:
                    recipe = json.load(file)
                sg.render(**recipe).save("b.png")
                self.same_bytes("a.png", "b.png")
        with self.assertRaisesRegex(ValueError, "azimuth.*Volume.slice"):
            sg.render(**recipe, azimuth=3)
        with self.assertRaisesRegex(ValueError, "azimuth.*Volume.slice"):
            sg.render("head.nrrd", at=3, azimuth=3)

    def test_arrays_as_options(self):
        for name, value in (("position", [0, -600, 0]), ("target", [3, 4, 5]),
                            ("up", [1, 0, 1]), ("light", [20, 40])):
            with self.subTest(name):
                image, same = (
                    self.draw({name: given, "zoom": numpy.float32(1.5)})
                    for given in (numpy.array(value), value))
                self.assertEqual(image.recipe, same.recipe)
                self.assertEqual(image.recipe[name], value)
                self.assertEqual(image.command, same.command)

    def test_what_has_none(self):
        array = numpy.asarray(sg.Volume("head.nrrd"))
        volume = sg.Volume(array)
        image = volume.render("mr-default", size=32, azimuth=10)
        self.assertNotIn("input", image.recipe)
        self.same_picture(sg.render(volume, **image.recipe), image)
        self.assertTrue(image.command.startswith("snowglass render VOLUME.nrrd --"))
        with self.assertRaisesRegex(ValueError, "colors of its own"):
            volume.render(sg.Look(colors=[(0, (0, 0, 0)), (9, (1, 1, 1))]),
                          size=16).recipe
        image.save("a.npy")
        with self.assertRaisesRegex(ValueError, "Volume.render"):
            sg.Image.load("a.npy").recipe
        with self.assertRaises(TypeError):
            sg.render()
        with self.assertRaises(TypeError):
            sg.render("head.nrrd", "mr-default", preset="linear")
        with self.assertRaisesRegex(TypeError, "colour"):
            sg.render("head.nrrd", colour=3)
