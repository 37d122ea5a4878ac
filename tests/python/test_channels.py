"""Channels: pictures are those of the command line, however channels are chosen.

    SNOWGLASS=build/snowglass PYTHONPATH=build/python python3 -m unittest -v
"""
import json
import os
import shlex
import struct
import subprocess
import tempfile
import unittest
import warnings

import numpy

import snowglass as sg
from test_snowglass import PICTURES, plain, resident

TOOL = os.environ.get("SNOWGLASS", "snowglass")
NZ, NY, NX = 6, 16, 20
Z, Y, X = numpy.mgrid[0:NZ, 0:NY, 0:NX]
ARRAYS = [(20 + 4 * c + 200 * ((X - 5 - 4 * c) ** 2 + (Y - 8) ** 2 +
                               4 * (Z - 3) ** 2 < 30) + (X + 3 * Y + Z) % 7)
          .astype(numpy.uint8) for c in range(3)]
NAMED = "".join(f'<Channel ID="Channel:0:{n}" Name="{name}" Color="{color}"/>'
                for n, (name, color) in enumerate((
                    ("DAPI", 65535), ("GFP", 16711935), ("far red", -16776961))))


def ome_tiff(path, channels, words=""):
    """A stack whose pages are the channels of each slice."""
    text = ('<OME xmlns="http://www.openmicroscopy.org/Schemas/OME/2016-06">'
            f'<Image><Pixels DimensionOrder="XYCZT" SizeX="{NX}" SizeY="{NY}" '
            f'SizeC="{len(channels)}" SizeZ="{NZ}" SizeT="1" Type="uint8" '
            f'PhysicalSizeX="0.5" PhysicalSizeY="0.5" PhysicalSizeZ="1">{words}'
            '</Pixels></Image></OME>').encode() + b"\0"
    out = bytearray(b"II*\0" + struct.pack("<I", 0)) + text + b"\0" * (len(text) % 2)
    link = 4
    for n in range(NZ * len(channels)):
        data = len(out)
        out += channels[n % len(channels)][n // len(channels)].tobytes()
        struct.pack_into("<I", out, link, len(out))
        tags = [(256, 3, 1, NX), (257, 3, 1, NY), (258, 3, 1, 8), (259, 3, 1, 1),
                (262, 3, 1, 1), (270, 2, len(text), 8), (273, 4, 1, data),
                (277, 3, 1, 1), (278, 3, 1, NY), (279, 4, 1, NX * NY)]
        tags = [tag for tag in tags if n == 0 or tag[0] != 270]
        out += struct.pack("<H", len(tags))
        for tag in tags:
            out += struct.pack("<HHII", *tag)
        link = len(out)
        out += struct.pack("<I", 0)
    with open(path, "wb") as file:
        file.write(bytes(out))


def rgb_nifti(path):
    ball = (numpy.indices((16, 16, 16)) - 8) ** 2
    voxels = numpy.where(ball.sum(axis=0)[..., None] < 40, (210, 120, 60), 0)
    head = bytearray(352)
    struct.pack_into("<i", head, 0, 348)
    struct.pack_into("<8h", head, 40, 3, 16, 16, 16, 1, 1, 1, 1)
    struct.pack_into("<3h", head, 68, 0, 128, 24)
    struct.pack_into("<8f", head, 76, *[1] * 8)
    struct.pack_into("<f", head, 108, 352)
    head[344:348] = b"n+1\0"
    with open(path, "wb") as file:
        file.write(bytes(head) + voxels.astype(numpy.uint8).tobytes())


class Channels(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.folder.cleanup)
        ome_tiff(cls.path("ome.tif"), ARRAYS, NAMED)
        ome_tiff(cls.path("plain.tif"), ARRAYS)
        ome_tiff(cls.path("two.tif"), ARRAYS[:2])
        rgb_nifti(cls.path("rgb.nii"))

    @classmethod
    def path(cls, name):
        return os.path.join(cls.folder.name, name)

    def setUp(self):
        caught = warnings.catch_warnings()
        caught.__enter__()
        self.addCleanup(caught.__exit__, None, None, None)
        warnings.simplefilter("error")
        self.file = self.path("ome.tif")

    def bytes_of(self, name):
        with open(self.path(name), "rb") as file:
            return file.read()

    def same(self, image, *words):
        """The files of a picture and of the command line."""
        subprocess.run([TOOL, *words, "-o", self.path("tool.png"), "-q", "-y"],
                       check=True)
        image.save(self.path("ours.png"))
        self.assertEqual(self.bytes_of("tool.png"), self.bytes_of("ours.png"))

    def round_trip(self, image, volume=None):
        recipe = json.loads(json.dumps(image.recipe))
        again = sg.render(**recipe) if volume is None else \
            sg.render(volume, **recipe)
        self.assertEqual(again.checksum, image.checksum)

    def test_what_a_file_says(self):
        info = sg.Volume(self.file).info
        self.assertEqual(info["channel_count"], 3)
        self.assertEqual([each["name"] for each in info["channels"]],
                         ["DAPI", "GFP", "far red"])
        self.assertEqual([each["color"] for each in info["channels"]],
                         [(0, 0, 1), (0, 1, 0), (1, 0, 0)])
        self.assertTrue(all(each["shown"] for each in info["channels"]))
        own = sg.Volume(self.path("rgb.nii")).info["channels"]
        self.assertEqual([each["window"] for each in own][:3], [(0, 255)] * 3)
        alone = sg.Volume("phantom:head", dims=(8, 8, 8)).info
        self.assertEqual((alone["channel_count"], alone["channels"]), (1, []))
        ome_tiff(self.path("lone.tif"), ARRAYS[1:2],
                 '<Channel ID="Channel:0:0" Name="GFP"/>')
        lone = sg.Volume(self.path("lone.tif"), channel="gfp")
        self.assertEqual(lone.info["channels"][0]["name"], "GFP")
        with self.assertRaisesRegex(ValueError, "the file has no channels"):
            sg.Volume(self.path("lone.tif"), channel="DAPI")

    def test_all_that_a_file_shows(self):
        for name in ("ome.tif", "plain.tif", "two.tif", "rgb.nii"):
            path = self.path(name)
            for words, options in (([], {}), (["-m", "mip"], {"mode": "mip"}),
                                   (["--legend"], {"legend": True})):
                with self.subTest(name, words=words):
                    image = sg.Volume(path).render(size=240, **options)
                    self.same(image, "render", path, "-s", "240", *words)
                    self.round_trip(image)
                    if options:
                        self.same(image, *shlex.split(image.command)[1:])

    def test_looks_of_all(self):
        volume = sg.Volume(self.file)
        for words, look in (
                (["--range", "30,180"], sg.Look(range=(30, 180))),
                (["--opacity", "40:0,200:0.4"],
                 sg.Look(opacity=[(40, 0), (200, 0.4)])),
                (["--gradient-opacity", "0:0,60:1"],
                 sg.Look(gradient_opacity=[(0, 0), (60, 1)])),
                (["--scale", "log"], sg.Look(scale="log")),
                (["--scale", "symlog:5"], sg.Look(scale="symlog:5"))):
            with self.subTest(words):
                image = volume.render(look, size=80)
                self.same(image, "render", self.file, "-s", "80", *words)
                self.round_trip(image)

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
                    if mode == "over":
                        self.same(images[0], *shlex.split(images[1].command)[1:])

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
        for name in ("ome.tif", "rgb.nii"):
            for axis in ("z", "x"):
                with self.subTest(name, axis=axis):
                    image = sg.Volume(self.path(name)).slice(axis, legend=True,
                                                             size=240)
                    self.same(image, "slice", self.path(name), "--axis", axis,
                              "--legend", "-s", "240")
                    self.round_trip(image)
        image = sg.Volume(self.file, channel="0:red:30..90").slice("z", 3)
        self.same(image, "slice", self.file, "--axis", "z", "--at", "3",
                  "--channel", "0:red:30..90")

    def test_turntables(self):
        for mode in ("over", "mip"):
            subprocess.run([TOOL, "turntable", self.file, "--frames", "2", "-s",
                            "60", "-m", mode, "-o", self.path("tool_%d.png"),
                            "-q", "-y"], check=True)
            sg.Volume(self.file).turntable(self.path("turn_%d.png"), frames=2,
                                           size=60, mode=mode)
            for n in range(2):
                self.assertEqual(self.bytes_of(f"turn_{n}.png"),
                                 self.bytes_of(f"tool_{n}.png"))
        self.assertNotEqual(self.bytes_of("turn_0.png"),
                            self.bytes_of("turn_1.png"))

    def test_crops_cut_all(self):
        crop = ((2, 18), (0, 16), (0, 6))
        for image in (sg.Volume(self.file, crop=crop).render(size=80),
                      sg.render(sg.Volume(self.file), size=80, crop=crop)):
            self.same(image, "render", self.file, "-s", "80", "--crop",
                      "2:18,0:16,0:6")

    def test_pipes_draw_one(self):
        pipe = self.path("pipe")
        os.mkfifo(pipe)
        with self.assertRaisesRegex(ValueError, "can be read once"):
            sg.Volume(pipe, channel="0,1")
        with subprocess.Popen(["cp", self.file, pipe]):
            volume = sg.Volume(pipe)
        with self.assertWarnsRegex(sg.SnowglassWarning, "can be read once"):
            image = volume.render(size=80)
        self.assertEqual(image.checksum, sg.Volume(
            self.file, channel=0).render(size=80).checksum)

    def test_overlays_lie_in_front_and_planes_cut_all(self):
        labels = self.path("labels.nrrd")
        subprocess.run([TOOL, "convert", self.file, "--channel", "2", "-q", "-y",
                        "-o", labels], check=True)
        volume = sg.Volume(self.file)
        look = sg.Look(opacity=[(100, 0), (200, 1)])
        self.same(volume.render(size=80, overlay=labels, overlay_look=look),
                  "render", self.file, "-s", "80", "--overlay", labels,
                  "--overlay-look", "100:0,200:1")
        words = ["render", self.file, "-s", "80", "--clip", "1,0,0,4"]
        clipped = sg.Volume(self.file, clip=[(1, 0, 0, 4)])
        self.same(clipped.render(size=80), *words)
        self.same(sg.render(volume, size=80, clip=[(1, 0, 0, 4)]), *words)

    def test_masks_cut_all(self):
        mask = numpy.zeros(ARRAYS[0].shape, numpy.uint8)
        mask[:, :8] = 1
        path = self.path("mask.nrrd")
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
                ("0,3", "channel 3 does not exist; the voxels have 3"),
                ("0:puce", "'puce' is no colour: give red"),
                ("0:5..x", "'5..x' is no range"), ("0:9..3", "is no range"),
                ("0:1.5", "'1.5' is no opacity"), ("0,,1", "names no channel"),
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
        again = sg.render(volume, **viewer.recipe)
        self.assertEqual(again.checksum, viewer.image.checksum)

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


class Arrays(unittest.TestCase):
    COLORS = ["blue", "#00ff00", "red"]

    def test_the_picture_is_that_of_their_file(self):
        names = ["DAPI", "GFP", "far red"]
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "ome.tif")
            ome_tiff(path, ARRAYS, NAMED)
            file = sg.Volume(path)
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
            again = sg.render(volume, **image.recipe)
            self.assertEqual(again.checksum, image.checksum)

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


if __name__ == "__main__":
    unittest.main()
