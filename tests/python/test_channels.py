"""Channels: pictures are those of the command line, however channels are chosen."""
import os
import subprocess

import numpy

import snowglass as sg
from beside import PICTURES, InFolder, plain, resident
from volumes import channel_words, nifti
import volumes

NZ, NY, NX = 6, 16, 20
Z, Y, X = numpy.mgrid[0:NZ, 0:NY, 0:NX]
ARRAYS = [(20 + 4 * c + 200 * ((X - 5 - 4 * c) ** 2 + (Y - 8) ** 2 +
                               4 * (Z - 3) ** 2 < 30) + (X + 3 * Y + Z) % 7)
          .astype(numpy.uint8) for c in range(3)]
NAMED = channel_words(("DAPI", 65535), ("GFP", 16711935), ("far red", -16776961))


def ome_tiff(path, channels, words=""):
    volumes.ome_tiff(path, (NX, NY, NZ), [
        channel[z].tobytes() for z in range(NZ) for channel in channels], words)


def rgb_nifti(path, ground=0):
    ball = (numpy.indices((16, 16, 16)) - 8) ** 2
    voxels = numpy.where(ball.sum(axis=0)[..., None] < 40, (210, 120, 60), ground)
    nifti(path, (16, 16, 16), (128, 24), voxels.astype(numpy.uint8).tobytes())


class Channels(InFolder):
    file = "ome.tif"

    def setUp(self):
        super().setUp()
        ome_tiff("ome.tif", ARRAYS, NAMED)
        ome_tiff("plain.tif", ARRAYS)
        ome_tiff("two.tif", ARRAYS[:2])
        rgb_nifti("rgb.nii")
        rgb_nifti("white.nii", 245)

    def test_what_a_file_says(self):
        info = sg.Volume(self.file).info
        self.assertEqual(info["channel_count"], 3)
        self.assertEqual([each["name"] for each in info["channels"]],
                         ["DAPI", "GFP", "far red"])
        self.assertEqual([each["color"] for each in info["channels"]],
                         [(0, 0, 1), (0, 1, 0), (1, 0, 0)])
        self.assertTrue(all(each["shown"] for each in info["channels"]))
        own = sg.Volume("rgb.nii").info["channels"]
        self.assertEqual([each["window"] for each in own][:3], [(0, 255)] * 3)
        alone = sg.Volume("phantom:head", dims=(8, 8, 8)).info
        self.assertEqual((alone["channel_count"], alone["channels"]), (1, []))
        ome_tiff("lone.tif", ARRAYS[1:2],
                 '<Channel ID="Channel:0:0" Name="GFP"/>')
        lone = sg.Volume("lone.tif", channel="gfp")
        self.assertEqual(lone.info["channels"][0]["name"], "GFP")
        with self.assertRaisesRegex(ValueError, "the file has no channels"):
            sg.Volume("lone.tif", channel="DAPI")

    def test_all_that_a_file_shows(self):
        labels, crop, plane = "labels.nrrd", ((2, 18), (0, 16), (0, 6)), (1, 0, 0, 4)
        self.tool("convert", self.file, "--channel", "2", "-o", labels)
        for name, words, opening, options in (
                ("plain.tif", [], {}, {}),
                ("two.tif", ["--legend"], {}, {"legend": True}),
                ("rgb.nii", ["-m", "mip"], {}, {"mode": "mip"}),
                ("white.nii", [], {}, {}),
                ("ome.tif", ["--range", "30,180", "--legend"], {},
                 {"look": sg.Look(range=(30, 180)), "legend": True}),
                ("ome.tif", ["--opacity", "40:0,200:0.4"], {},
                 {"look": sg.Look(opacity=[(40, 0), (200, 0.4)])}),
                ("ome.tif", ["--gradient-opacity", "0:0,60:1", "--scale", "symlog:5"], {},
                 {"look": sg.Look(gradient_opacity=[(0, 0), (60, 1)], scale="symlog:5")}),
                ("ome.tif", ["--crop", "2:18,0:16,0:6"], {"crop": crop}, {}),
                ("ome.tif", ["--clip", "1,0,0,4"], {"clip": [plane]}, {}),
                ("ome.tif", ["--overlay", labels, "--overlay-look", "100:0,200:1"], {},
                 {"overlay": labels,
                  "overlay_look": sg.Look(opacity=[(100, 0), (200, 1)])})):
            with self.subTest(name, words=words):
                image = sg.Volume(name, **opening).render(size=240, **options)
                self.same(image, "render", name, "-s", "240", *words)
                self.round_trip(image)
        for words, options in ((["--crop", "2:18,0:16,0:6"], {"crop": crop}),
                               (["--clip", "1,0,0,4"], {"clip": [plane]})):
            self.same(sg.render(sg.Volume(self.file), size=80, **options),
                      "render", self.file, "-s", "80", *words)

    def test_lists(self):
        for words, given in (
                ("0:magenta,GFP:green", {0: "magenta", "GFP": "green"}),
                ("0,gfp", [0, "gfp"]),
                ("FAR RED:20..200:0.5,0:#8040ff:p5..p99.5",
                 {"FAR RED": "20..200:0.5", 0: "#8040ff:p5..p99.5"}),
                ("1:viridis", ["1:viridis"]), ("2:red:0.25", {2: "red:0.25"})):
            for mode in ("over", "mip"):
                with self.subTest(words, mode=mode):
                    images = [sg.Volume(self.file, channel=each).render(
                        size=240, mode=mode, legend=True) for each in
                        (words, given)]
                    self.assertEqual(*(image.checksum for image in images))
                    self.same(images[1], "render", self.file, "-s", "240", "-m",
                              mode, "--legend", "--channel", words)
                    self.round_trip(images[1])

    def test_one_is_grey(self):
        for given in ("GFP", ["gfp"], "1", {"GFP": None}, 1):
            volume = sg.Volume(self.file, channel=given)
            numpy.testing.assert_array_equal(
                numpy.asarray(volume), ARRAYS[1])
            image = volume.render(size=80)
            self.assertEqual(image.shape[2], 2)
            self.round_trip(image)
        self.same(image, "render", self.file, "-s", "80", "--channel", "GFP")

    def test_slices(self):
        for name, axis in (("ome.tif", "z"), ("rgb.nii", "x")):
            image = sg.Volume(name).slice(axis, legend=True, size=240)
            self.same(image, "slice", name, "--axis", axis, "--legend", "-s", "240")
            self.round_trip(image)
        image = sg.Volume(self.file, channel="0:red:30..90").slice("z", 3)
        self.same(image, "slice", self.file, "--axis", "z", "--at", "3",
                  "--channel", "0:red:30..90")

    def test_turntables(self):
        for mode in ("over", "mip"):
            self.same_frames(
                lambda *to, **more: sg.Volume(self.file).turntable(
                    *to, size=60, mode=mode, **more),
                "turntable", self.file, "-s", "60", "-m", mode)
        self.assertNotEqual(self.bytes_of("ours_0.png"), self.bytes_of("ours_1.png"))

    def test_pipes_draw_one(self):
        pipe = "pipe"
        os.mkfifo(pipe)
        with self.assertRaisesRegex(ValueError, "can be read once"):
            sg.Volume(pipe, channel="0,1")
        with subprocess.Popen(["cp", self.file, pipe]):
            volume = sg.Volume(pipe)
        with self.assertWarnsRegex(sg.SnowglassWarning, "can be read once"):
            image = volume.render(size=80)
        self.assertEqual(image.checksum, sg.Volume(
            self.file, channel=0).render(size=80).checksum)

    def test_masks_cut_all(self):
        mask = numpy.zeros(ARRAYS[0].shape, numpy.uint8)
        mask[:, :8] = 1
        path = "mask.nrrd"
        volume = sg.Volume(self.file)
        sg.Volume(mask, affine=volume.affine, unit=volume.info["unit"]).save(path)
        expected = sg.Volume(self.file, mask=path).render(size=60)
        self.assertEqual(volume.masked(mask).render(size=60).checksum,
                         expected.checksum)

    def test_looks_of_one_draw_one(self):
        volume = sg.Volume(self.file)
        for words, options in ((["--preset", "linear"], {"look": "linear"}),
                               (["-c", "viridis"], {"look": "viridis"}),
                               (["-m", "mean"], {"mode": "mean"})):
            with self.subTest(words):
                with self.assertWarnsRegex(sg.SnowglassWarning,
                                           r"channel 0 of 3 .* is used"):
                    image = volume.render(size=80, **options)
                self.same(image, "render", self.file, "-s", "80", *words)
        listed = sg.Volume(self.file, channel="0:red,1:green")
        for options in ({"look": "linear"}, {"mode": "mean"},
                        {"method": "footprint"}, {"depth": True},
                        {"kernel": "gauss"}):
            with self.subTest(options):
                with self.assertRaisesRegex(ValueError, "^channel: .*; give "):
                    listed.render(size=80, **options)

    def test_numbers_are_those_of_the_first(self):
        listed = sg.Volume(self.file, channel="2:red,GFP:green")
        alone = sg.Volume(self.file, channel=2)
        numpy.testing.assert_array_equal(numpy.asarray(listed),
                                         numpy.asarray(alone))
        for mode in ("mip", "mean"):
            numpy.testing.assert_array_equal(
                listed.project(mode, size=40), alone.project(mode, size=40))
        numpy.testing.assert_array_equal(listed.slice_values("z"),
                                         alone.slice_values("z"))

    def test_what_is_wrong_is_said(self):
        for given, why in (
                ("0,YFP", "no channel 'YFP'; the file has 0 DAPI, 1 GFP, 2 far"),
                ("0:5..x", "'5..x' is no range"), ("0,,1", "names no channel"),
                ({}, "names no channel"), ([-1], "'-1' is below 0"),
                ([0] * 9, "up to 8 are shown together")):
            with self.subTest(given):
                with self.assertRaisesRegex(ValueError, why):
                    sg.Volume(self.file, channel=given)
        with self.assertRaisesRegex(TypeError, "channel or component"):
            sg.Volume(self.file, channel="0,1", component="x")

    def test_a_viewer_shows_one(self):
        volume = sg.Volume(self.file, channel="1:green,0:blue")
        with self.assertWarnsRegex(sg.SnowglassWarning, "a viewer shows one"):
            viewer = volume.view(size=(80, 60))
        self.addCleanup(viewer.close)
        self.assertEqual(viewer.recipe["channel"], 1)
        self.assertEqual(sg.render(volume, **viewer.recipe).checksum,
                         viewer.image.checksum)

    def test_close_gives_all_back(self):
        volume = sg.Volume(self.file)
        checksum = volume.render(size=40).checksum
        volume.close()
        with self.assertRaisesRegex(ValueError, "is closed"):
            volume.render(size=40)
        self.assertEqual(sg.Volume(self.file).render(size=40).checksum, checksum)

    @plain
    def test_memory_stays_flat(self):
        volume = sg.Volume(self.file)

        def draw(n):
            volume.render(size=64, mode="mip" if n % 2 else "over")
            volume.slice("xyz"[n % 3])
            if n % 8 == 0:
                listed = sg.Volume(self.file, channel="GFP:red:0.5,0")
                listed.render(size=32, legend=True).to_rgb()

        for n in range(40):
            draw(n)
        before = resident()
        for n in range(PICTURES // 2):
            draw(n)
        self.assertLess(resident() - before, 1 << 20)


class Arrays(InFolder):
    COLORS = ["blue", "#00ff00", "red"]

    def test_the_picture_is_that_of_their_file(self):
        names = ["DAPI", "GFP", "far red"]
        ome_tiff("ome.tif", ARRAYS, NAMED)
        file = sg.Volume("ome.tif", channel="0:blue,1:#00ff00,2:red")
        drawn = [file.render(size=80).checksum,
                 file.render(size=80, mode="mip").checksum,
                 file.slice("z").checksum]
        for arrays in (ARRAYS, numpy.array(ARRAYS)):
            volume = sg.Volume.channels(arrays, colors=self.COLORS, names=names,
                                        affine=file.affine,
                                        unit=file.info["unit"])
            self.assertEqual([each["name"] for each in volume.info["channels"]],
                             names)
            self.assertEqual([volume.render(size=80).checksum,
                              volume.render(size=80, mode="mip").checksum,
                              volume.slice("z").checksum], drawn)
            image = volume.render(size=80, azimuth=20)
            self.round_trip(image, volume)

    def test_a_channel_of_one_value_is_not_seen(self):
        flat = numpy.full_like(ARRAYS[0], 77)
        volume = sg.Volume.channels([ARRAYS[0], flat], colors=["magenta", "green"])
        for mode in ("over", "mip"):
            drawn = numpy.asarray(volume.render(size=60, mode=mode))
            self.assertGreater(drawn[..., 0].max(), 0.3)
            self.assertLess(drawn[..., 1].max(), 1e-6)
        listed = sg.Volume.channels([ARRAYS[0], flat], colors=["magenta", "green"],
                                    windows=[None, (0, 77)])
        self.assertGreater(numpy.asarray(listed.render(size=60))[..., 1].max(), 0.3)

    def test_axes_may_lie_in_any_order(self):
        usual = sg.Volume.channels(ARRAYS, colors=self.COLORS)
        turned = sg.Volume.channels([each.T for each in ARRAYS], axes="xyz",
                                    colors=self.COLORS)
        self.assertEqual(turned.render(size=60).checksum,
                         usual.render(size=60).checksum)
        self.assertEqual(turned.slice("z").checksum, usual.slice("z").checksum)

    def test_what_is_wrong_is_said(self):
        for arrays, options, why in (
                ([], {}, "at least one"),
                (ARRAYS, {"colors": ["red"]}, "1 colors for 3 channels"),
                (ARRAYS, {"colors": ["red", "puce", "blue"]}, "is no colour"),
                ([ARRAYS[0], ARRAYS[1][1:]], {}, "a channel of shape"),
                ([ARRAYS[0]] * 9, {}, "up to 8 are shown")):
            with self.subTest(why):
                with self.assertRaisesRegex(ValueError, why):
                    sg.Volume.channels(arrays, **options)
        with self.assertRaisesRegex(TypeError, "channels of files"):
            sg.Volume.channels(["a.tif", "b.tif"])
        with self.assertRaisesRegex(ValueError, "a viewer shows one"):
            sg.Volume.channels(ARRAYS).view()
