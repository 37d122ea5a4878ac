"""Pictures and movies of the package are those of the command line, byte for
byte: the same defaults, letters, bars, background, colours of values."""
import ctypes
import json
import os
import shlex
import shutil
import subprocess

import numpy

import snowglass as sg
from beside import TIER, TOOL, InFolder, plain
from volumes import channel_words, nifti, ome_tiff


def some(cases, count):
    """The first ones; all in the long tier."""
    return cases if TIER != "short" else cases[:count]


def patient():
    """A CT by its values: air at -1000, tissue, bone; and its place."""
    z, y, x = numpy.ogrid[:30, :40, :50]
    far = ((x - 25) / 20) ** 2 + ((y - 18) / 15) ** 2 + ((z - 15) / 12) ** 2
    array = numpy.where(far < 1, 40, -1000).astype(numpy.int16)
    array[far < 0.3] = 700
    array[20:24, 5:9, 22:30] = 1200
    turn = numpy.deg2rad(12)
    matrix = numpy.diag([0.8, 0.9, 1.6, 1])
    matrix[:2, :2] = [[-0.8 * numpy.cos(turn), 0.9 * numpy.sin(turn)],
                      [0.8 * numpy.sin(turn), 0.9 * numpy.cos(turn)]]
    return sg.Volume(array, affine=matrix, unit="mm", medical=True)


def spots():
    """Values near 100, and one that is far brighter than all others."""
    array = numpy.zeros((24, 28, 32), numpy.uint16)
    array[6:18, 8:20, 10:22] = 100 + numpy.arange(12)
    array[12, 14, 16] = 60000
    return sg.Volume(array, spacing=(1, 1, 2), unit="um")


def cloud():
    """Values that rise everywhere: no surface to be shaded."""
    z, y, x = numpy.ogrid[:24, :24, :24]
    return sg.Volume((x + 2 * y + 3 * z).astype(numpy.float32))


def plate():
    array = numpy.zeros((40, 4, 36), numpy.uint8)
    array[8:30, 1:3, 6:20] = 200
    return sg.Volume(array)


def files_of_channels():
    """Stains that emit light, of which one is everywhere alike; colours on black and
    on white, in a body and in a picture."""
    z, y, x = numpy.ogrid[:12, :24, :32]
    parts = [100 + 40 * n for n in range(8)] * (
        ((x - 16) ** 2 + (y - 12) ** 2 + 4 * (z - 6) ** 2)[..., None] <
        numpy.arange(60, 140, 10)).astype(int) + (x + 3 * y + z)[..., None] % 7
    parts[..., 3] = 77
    words = channel_words(("DAPI", 65535), ("GFP", 16711935), ("far", -8388353))
    for name, count, said in (("stains", 3, words), ("two", 2, ""), ("three", 3, ""),
                              ("eight", 8, ""), ("lit", 2, (
                                  '<Channel ID="C:0" ContrastMethod="Brightfield"/>'
                                  '<Channel ID="C:1" ContrastMethod="Fluorescence"/>'))):
        ome_tiff(name + ".tif", (32, 24, 12), [
            part[..., n].astype(numpy.uint8).tobytes()
            for part in numpy.minimum(parts, 255) for n in range(count)], said)
        yield name + ".tif"
    inside = parts[..., :1] > 50
    for name, ground, rows in ("black", 0, 12), ("white", 245, 12), ("slice", 245, 1):
        colors = numpy.where(inside, (150, 40, 120), ground).astype(numpy.uint8)
        nifti(name + ".nii", (32, 24, rows), (128, 24), colors[6:6 + rows].tobytes()
              if rows == 1 else colors.tobytes())
        yield name + ".nii"


class Same(InFolder):
    def file_of(self, make):
        path = make.__name__ + ".nrrd"
        if path not in self.files:
            make().save(path)
            self.files.add(path)
        return path

    def setUp(self):
        super().setUp()
        self.files = set()

    def same_as_file(self, make, words, options, saving=None, suffix=".png"):
        """A picture of a file by both, and of the array itself."""
        self.same([volume.render(size=(180, 150), **options)
                   for volume in (sg.Volume(self.file_of(make)), make())],
                  "render", self.file_of(make), "-s", "180x150", *words, suffix=suffix,
                  **(saving or {}))


class Pictures(Same):
    def test_defaults(self):
        for make in (patient, spots, cloud, plate):
            with self.subTest(make.__name__):
                self.same_as_file(make, [], {})

    def test_names_of_views_mean_the_same_side(self):
        for view in some(["axial", "back", "coronal", "sagittal", "front",
                          "top", "-x"], 2):
            for make in some([patient, spots], 1):
                with self.subTest(view, make=make.__name__):
                    self.same_as_file(make, ["--view", view], {"view": view})

    def test_letters_legend_and_scale_bar(self):
        for mode in some(["over", "mip", "mean", "minip", "sum", "iso"], 3):
            words = ["-m", mode] + ["--iso", "60"] * (mode == "iso")
            options = {"mode": mode, **({"iso": 60} if mode == "iso" else {})}
            for make in some([patient, spots], 1):
                with self.subTest(mode, make=make.__name__):
                    self.same_as_file(make, words, options)
                    self.same_as_file(make, [*words, "--legend"],
                              {**options, "legend": True})
                    self.same_as_file(make, [*words, "--legend", "scale", "--no-labels"],
                              {**options, "legend": "scale", "letters": False})

    def test_looks(self):
        for words, look in some([
                (["-c", "viridis"], "viridis"),
                (["--preset", "ct-bone"], "ct-bone"),
                (["--range", "0,300"], sg.Look(clim=(0, 300))),
                (["--range", "full"], sg.Look(range="full")),
                (["--range", "p2,p98", "-c", "inferno"],
                 sg.Look(range="2%,98%", colormap="inferno")),
                (["--opacity", "-500:0,700:0.8"],
                 sg.Look(opacity=[(-500, 0), (700, 0.8)]))], 2):
            for mode in some(["over", "mip", "mean"], 1):
                with self.subTest(words, mode=mode):
                    self.same_as_file(patient, [*words, "-m", mode, "--legend"],
                              {"look": look, "mode": mode, "legend": True})

    def test_cameras_and_lights(self):
        for words, options in some([
                (["--azimuth", "30", "--elevation", "-20", "--roll", "5"],
                 {"azimuth": 30, "elevation": -20, "roll": 5}),
                (["--perspective", "--legend"],
                 {"perspective": True, "legend": True}),
                (["--fit", "volume", "--zoom", "1.5"],
                 {"fit": "volume", "zoom": 1.5}),
                (["--position", "0,-200,0", "--target", "0,0,0"],
                 {"position": (0, -200, 0), "target": (0, 0, 0)}),
                (["--light", "head", "--quality", "high"],
                 {"light": "head", "quality": "high"}),
                (["--light", "40,10", "--shade", "phong"],
                 {"light": (40, 10), "shade": "phong"}),
                (["--occlusion", "0.5", "--depth-darkening", "0.4"],
                 {"occlusion": 0.5, "depth_darkening": 0.4})], 2):
            for make in some([patient, cloud], 1):
                with self.subTest(words, make=make.__name__):
                    self.same_as_file(make, words, options)
        if TIER != "short":
            self.same_as_file(cloud, ["--method", "raycast"], {"method": "raycast"})

    def test_backgrounds_bits_and_formats(self):
        for words, saving, suffix in [
                (["--background", "none"], {"background": None}, ".png"),
                (["--background", "white"], {"background": "white"}, ".png"),
                (["--background", "#18f"], {"background": "#18f"}, ".png"),
                (["--background", "0.2,0.4,0.6", "--bits", "16"],
                 {"background": (0.2, 0.4, 0.6), "bits": 16}, ".png"),
                ([], {}, ".webp"), ([], {}, ".jpg"), ([], {}, ".npy"),
                ([], {}, ".pfm"), ([], {}, ".exr"), ([], {}, ".tif")]:
            with self.subTest(words, suffix=suffix):
                self.same_as_file(patient, words, {}, saving, suffix)
        self.same_as_file(patient, ["-m", "mean"], {"mode": "mean"}, {}, ".npy")

    def test_what_is_shown_is_what_is_saved(self):
        image = patient().render(size=200, legend=True)
        image.save("a.png")
        self.assertEqual(image.png(), self.bytes_of("a.png"))
        self.assertEqual(image._repr_png_(), self.bytes_of("a.png"))
        plain = patient().render(size=200, letters=False)
        plain.save("b.png")
        levels = numpy.asarray(sg.Image.load("b.png"))[..., :3]
        numpy.testing.assert_array_equal(plain.to_rgb(),
                                         numpy.rint(levels * 255))
        self.assertEqual(plain.to_rgb()[0, 0].tolist(), [20, 20, 20])
        mean = patient().render(size=64, mode="mean")
        self.assertEqual(mean.to_rgb().shape, (64, 64, 3))


class Commands(Same):
    def test_the_tool_takes_them(self):
        spots().save("a.nrrd")
        spots().save("-dash.nrrd")
        for path, opening, options in [
                ("a.nrrd", {"spacing": 2}, {}),
                ("a.nrrd", {"spacing": numpy.float32(1.5)}, {}),
                ("a.nrrd", {"allow_gaps": False, "labels": None}, {}),
                ("a.nrrd", {}, {"threads": 0, "iso": 0,
                                "opacity_length": 0}),
                ("-dash.nrrd", {}, {"azimuth": -20})]:
            with self.subTest(path, opening=opening, options=options):
                image = sg.Volume(path, **opening).render(size=(64, 48), **options)
                self.same(image, *shlex.split(image.command)[1:])
                self.same_picture(sg.render(**image.recipe), image)

    def test_slices(self):
        patient().save("a.nrrd")
        volume = sg.Volume("a.nrrd")
        for axis, at, look, options in [
                ("axial", None, None, {}),
                ("Coronal", 18, "ct-bone", {"legend": True}),
                ("x", "-3mm", sg.Look(range=(-200, 900)), {"size": (90, 80)}),
                ("sagittal", 15, sg.Look(cmap="viridis", range=(0, 90), opacity=[
                    (0, 0), (90, 0.4)]), {"kernel": "box", "size": 120,
                                          "letters": False, "threads": 1})]:
            with self.subTest(axis, at=at, options=options):
                image = volume.slice(axis, at, look, **options)
                words = shlex.split(image.command)
                self.assertEqual(words[:3], ["snowglass", "slice", "a.nrrd"])
                self.same(image, *words[1:])
                with open("r.json", "w", encoding="utf-8") as file:
                    json.dump({**image.recipe, "output": "c.png"}, file)
                self.tool("slice", "--config", "r.json")
                self.same_bytes("c.png", "ours.png")
                again = sg.render(**image.recipe)
                self.assertEqual(again.stats, image.stats | {
                    "axis": axis.lower()})
                self.same_picture(again, image)
        recipe = patient().slice("y", 5, size=40).recipe  # of an array
        self.assertNotIn("input", recipe)
        self.same_picture(sg.render(patient(), **recipe), patient().slice("y", 5, size=40))


class FromC(Same):
    @plain
    def test_the_first_picture_in_one_call(self):
        """snow_render_file, which a program calls: frame, background, letters."""
        folder = os.path.dirname(TOOL)
        path = os.path.join(folder, "libsnowglass.so")
        if not os.path.exists(path):
            self.skipTest("the library lies elsewhere")
        library, pointer = ctypes.CDLL(path), ctypes.c_void_p
        context, image = pointer(), pointer()
        self.assertEqual(library.snow_context_new(None, ctypes.byref(context)), 0)
        mixed = list(files_of_channels())
        names = [self.file_of(make) for make in (patient, spots, cloud, plate)]
        for name in names + mixed:
            with self.subTest(name):
                self.assertEqual(library.snow_render_file(
                    context, name.encode(), None, None, ctypes.byref(image)), 0)
                for suffix in [".png", ".npy"][:2 if name in names else 1]:
                    self.assertEqual(library.snow_image_save(
                        image, ("c" + suffix).encode(), None), 0)
                    self.tool(name, "-o", "tool" + suffix)
                    self.same_bytes("c" + suffix, "tool" + suffix)
                    os.remove("c" + suffix)
                library.snow_image_free(image)
        library.snow_context_free(context)


class Movies(Same):
    def test_frames(self):
        for words, options in some([
                (["--legend"], {"legend": True}),
                (["-m", "mean"], {"mode": "mean"}),
                (["-m", "sum", "--range", "0,9000"],
                 {"mode": "sum", "look": sg.Look(range=(0, 9000))}),
                (["--fit", "volume", "--azimuth", "20", "--view", "left"],
                 {"fit": "volume", "azimuth": 20, "view": "left"})], 1):
            with self.subTest(words):
                self.same_frames(
                    lambda *to, **more: sg.Volume(self.file_of(patient)).turntable(
                        *to, size=(120, 90), **options, **more),
                    "turntable", self.file_of(patient), "-s", "120x90", *words, frames=3)
        with self.assertRaisesRegex(ValueError, "same range"):
            patient().turntable("p_%d.png", frames=2, mode="sum")

    def test_odd_sides(self):
        if not shutil.which("ffmpeg"):
            self.skipTest("ffmpeg is not installed")
        for suffix in some([".mp4", ".webm", ".gif"], 1):
            with self.subTest(suffix):
                self.tool("turntable", self.file_of(patient), "-s", "101x75", "--frames",
                          "3", "--fps", "10", "-o", "t" + suffix)
                patient().turntable("p" + suffix, frames=3, fps=10, size=(101, 75))
                self.assertEqual(self.frames_of("t" + suffix),
                                 self.frames_of("p" + suffix))
                self.assertEqual(len(set(self.frames_of("p" + suffix))), 3)

    def frames_of(self, name):
        listed = subprocess.run(
            ["ffmpeg", "-v", "error", "-i", name, "-f", "framemd5",
             "-"], check=True, capture_output=True, text=True).stdout
        return [line.split()[-1] for line in listed.splitlines()
                if not line.startswith("#")]
