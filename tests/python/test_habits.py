"""What users of matplotlib, PyVista and the command line are used to."""
import copy
import gc
import json
import os
import pickle
import subprocess
import sys
import unittest
import warnings

import numpy

import snowglass as sg
from beside import InFolder, needs, plain

try:
    import matplotlib
except ImportError:
    place = os.path.join(os.path.dirname(os.path.abspath(__file__)), "stand_ins")
    sys.path.insert(0, place)
    import matplotlib
    sys.path.remove(place)

RAMP = numpy.broadcast_to(numpy.arange(256, dtype=numpy.uint8), (3, 8, 256)).copy()


def head(n=24):
    return sg.Volume("phantom:head", dims=(n, n, n))


class Looks(InFolder):
    def test_a_map_of_matplotlib_has_its_colours(self):
        volume = sg.Volume(RAMP)
        shares = numpy.arange(256) / 255
        for given in "bone", matplotlib.colormaps["bone"]:
            expected = numpy.array([matplotlib.colormaps["bone"](n)[:3] for n in shares])
            shown = numpy.asarray(volume.slice(
                "z", 1, sg.Look(cmap=given, range=(0, 255)), kernel="box"))[4, :, :3]
            self.assertLess(abs(shown - expected).max(), 1.6 / 255)
        steps = [n * 0.1 for n in range(10)] if "steps" in matplotlib.colormaps else []
        look = sg.Look(cmap="steps", range=(0, 255)) if steps else None
        for n, share in enumerate(steps):
            color = volume._transfer(look).evaluate(255 * (share + 0.05))
            self.assertAlmostEqual(color[0], n / 9, delta=0.6 / 255)
        volume.render("bone", size=32)

    def test_maps_follow_the_scale_and_draw_again(self):
        volume = sg.Volume("phantom:turbulence", dims=(16, 16, 16))
        look = sg.Look(cmap="bone", scale="log", range=(1, 10000))
        middle = volume._transfer(look).evaluate(100)[:3]
        numpy.testing.assert_allclose(
            middle, matplotlib.colormaps["bone"](0.5)[:3], atol=2 / 255)
        for options in ({"cmap": "bone"}, {"opacity": "sigmoid", "cmap": "bone_"[:4]},
                        {"opacity": 0.5}, {"opacity": "linear_r", "clim": (20, 90)},
                        {"cmap": "bone", "mode": "mip"}):
            with self.subTest(options):
                self.round_trip(head().render(size=40, **options))
        self.round_trip(head().slice("z", 5, sg.Look(cmap="bone")))

    def test_opacities_by_name_are_those_formulas(self):
        volume, shares = sg.Volume(RAMP), numpy.linspace(0, 1, 21)
        for name, formula in (("linear", lambda t: t), ("linear_r", lambda t: 1 - t),
                              ("sigmoid", lambda t: 1 / (1 + numpy.exp(10 - 20 * t))),
                              ("sigmoid_r", lambda t: 1 / (1 + numpy.exp(20 * t - 10)))):
            made = volume._transfer(sg.Look(opacity=name, range=(0, 255)))
            found = [made.evaluate(255 * share)[3] for share in shares]
            numpy.testing.assert_allclose(found, formula(shares), atol=0.01)
        usual = head()._transfer(None)
        made = head()._transfer(sg.Look(opacity=0.25))
        for value in range(0, 256, 15):
            self.assertAlmostEqual(made.evaluate(value)[3],
                                   usual.evaluate(value)[3] / 4, places=6)
        for wrong in "geom", 1.5, -1:
            with self.assertRaisesRegex(ValueError, "^opacity: give .* factor 0 to 1"):
                sg.Look(opacity=wrong)

    def test_views_by_the_axes_of_the_picture(self):
        for name, side in ("xy", "+z"), ("xz", "-y"), ("yz", "+x"):
            image = head().render(view=name, size=24)
            self.same_picture(image, head().render(view=side, size=24))
            self.assertEqual(image.recipe["view"], side)

    def test_without_anywidget_a_viewer_says_what_to_install(self):
        code = "import sys, warnings; sys.modules['anywidget'] = None\n" \
               "warnings.simplefilter('error'); import snowglass as sg\n" \
               "sg.Volume('phantom:head', dims=(8, 8, 8)).view(cmap='viridis')"
        said = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
        self.assertRegex(said.stderr, "SnowglassWarning: .*pip install anywidget")

    def test_an_empty_picture_warns(self):
        volume = head()
        for answer, options in (
                ("no voxel has an opacity above 0;", {"opacity": [(0, 0), (255, 0)]}),
                ("an opacity above threshold=255;", {"threshold": 255}),
                ("no surface of value 999", {"mode": "iso", "iso": 999}),
                ("no visible voxel is in view", {"target": (900, 0, 0), "fit": "volume"})):
            with self.assertWarnsRegex(sg.SnowglassWarning, answer) as caught:
                volume.render(size=24, **options)
            self.assertEqual(caught.filename, __file__)
        with self.assertWarnsRegex(sg.SnowglassWarning, "all frames are empty"):
            volume.turntable("e_%d.png", frames=2, size=24, opacity=[(0, 0)])
        volume.turntable("f_%d.png", frames=2, size=24)  # warnings are errors

    def test_why_a_picture_is_empty_does_not_hang_on_those_before(self):
        values = numpy.arange(24 ** 3).reshape(24, 24, 24) % 200
        for look in ({"clim": (1000, 2000)}, {"opacity": [(300, 0), (400, 1)]},
                     {"opacity": [(199.2, 0), (199.8, 1)]}, {"threshold": 255}):
            for kind in "uint8", "int16", "float32":
                volume = sg.Volume(values.astype(kind))
                self.assertGreater(volume.render(size=24).stats["interesting"], 0)
                with self.assertWarnsRegex(sg.SnowglassWarning, "no voxel has an opacity"):
                    image = volume.render(size=24, **look)
                self.assertEqual(image.stats["interesting"], 0)
                self.assertEqual(image.stats["sparse_ratio"], 1)
                # Seen from afar the same voxels are there, out of view.
                away = {"target": (900, 0, 0), "fit": "volume"}
                with self.assertWarnsRegex(sg.SnowglassWarning, "no visible voxel is in"):
                    there = volume.render(size=24, opacity=[(100.5, 0), (101, 1)], **away)
                self.assertEqual(there.stats["interesting"], int((values > 100).sum()))


class Movies(InFolder):
    def test_defaults_and_webp_are_those_of_the_tool(self):
        self.tool("turntable", "phantom:head", "--dims", "24x24x24", "-s", "24x20",
                  "-o", "tool.webp")
        head().turntable("ours.webp", size=(24, 20))
        self.same_bytes("tool.webp", "ours.webp")
        self.tool("turntable", "phantom:head", "--dims", "24x24x24", "-s", "24", "--fps",
                  "7", "--frames", "3", "--background", "none", "-o", "tool.webp")
        head().turntable("clear.webp", size=24, fps=7, frames=3, background=None)
        self.same_bytes("tool.webp", "clear.webp")
        with self.assertRaisesRegex(sg.Error, "^no/t.webp: .*make it first"):
            head().turntable("no/t.webp", size=24, frames=1)

    def test_what_is_there_stays_unless_it_is_told_otherwise(self):
        for path, name in ("t_%d.png", "t_2.png"), ("t.webp", "t.webp"), ("t.mp4", "t.mp4"):
            with open(name, "w", encoding="ascii") as file:
                file.write("mine")
            with self.assertRaisesRegex(sg.Error, f"^{name}: exists; give overwrite=True"
                                        ) as caught:
                head().turntable(path, frames=3, size=24)
            self.assertEqual(caught.exception.status, 4)
            self.assertEqual(self.bytes_of(name), b"mine")
        self.assertFalse(os.path.exists("t_0.png"))
        head().turntable("t_%d.png", frames=3, size=24, overwrite=True)
        head().turntable("t.webp", frames=3, size=24, overwrite=True)
        self.assertGreater(len(self.bytes_of("t_2.png")), 100)
        self.assertGreater(len(self.bytes_of("t.webp")), 100)
        self.assertEqual([each for each in os.listdir() if "part" in each], [])


class Faults(InFolder):
    def test_faults_of_files_are_those_of_python_too(self):
        head().save("there.nrrd")
        os.symlink("nowhere.nrrd", "link.nrrd")
        os.mkdir("folder.png")
        image = head().render(size=24).save("there.png")
        for kind, status, cause in (
                (FileNotFoundError, 3, lambda: sg.open("missing.nrrd")),
                (FileNotFoundError, 3, lambda: sg.open("link.nrrd")),
                (FileNotFoundError, 3, lambda: sg.open("there.nrrd", mask="missing.nii")),
                (FileNotFoundError, 3, lambda: sg.Image.load("missing.png")),
                (FileNotFoundError, 3, lambda: next(sg.series("missing_%d.nrrd"))),
                (FileNotFoundError, 3, lambda: next(sg.series("missing_*.nrrd"))),
                (FileNotFoundError, 4, lambda: image.save("missing/a.png")),
                (FileNotFoundError, 4, lambda: head().turntable("missing/a.webp")),
                (FileExistsError, 4, lambda: image.save("there.png", overwrite=False)),
                (FileExistsError, 4, lambda: head().save("there.nrrd", overwrite=False)),
                (FileExistsError, 4, lambda: head().turntable("there.png")),
                (OSError, 4, lambda: image.save("folder.png"))):
            with self.assertRaises(kind) as caught:
                cause()
            error = caught.exception
            self.assertIsInstance(error, sg.FileError)
            self.assertIsInstance(error, sg.Error)
            self.assertEqual(error.status, status)
            if kind is not OSError:
                with self.assertRaises(kind) as known:
                    os.link("there.png", "there.nrrd") if kind is FileExistsError \
                        else os.stat("missing.png")
                self.assertEqual(error.errno, known.exception.errno)
            again = pickle.loads(pickle.dumps(error))  # as a pool of processes does
            self.assertEqual((type(again), str(again)), (type(error), str(error)))
        with open("text.nrrd", "w", encoding="ascii") as file:
            file.write("nothing")
        for path in "text.nrrd", "there.png/there.nrrd":
            with self.assertRaises(sg.Error) as caught:
                sg.open(path)
            self.assertNotIsInstance(caught.exception, FileNotFoundError)
        with self.assertRaisesRegex(sg.Error, "give overwrite=True$"):
            image.save("there.png", overwrite=False)

    def test_what_may_not_be_read_is_a_matter_of_permissions(self):
        with self.assertRaises(PermissionError) as caught:  # root may read all files
            sg._snowglass.fail(3, f"a.nrrd: cannot be opened: {os.strerror(13)}; ask")
        self.assertIsInstance(caught.exception, sg.FileError)
        with self.assertRaises(ValueError):
            sg._snowglass.fail(2, f"a.nrrd: cannot be opened: {os.strerror(13)}; ask")

    def test_with_closes(self):
        with head() as volume:
            volume.render(size=24)
        with self.assertRaisesRegex(ValueError, "closed"):
            volume.render(size=24)
        with self.assertRaisesRegex(BufferError, "in use"):
            with head() as volume:
                voxels = numpy.asarray(volume)
        with self.assertRaises(ZeroDivisionError):
            with head() as volume:
                voxels = numpy.asarray(volume)
                raise ZeroDivisionError
        self.assertEqual(voxels.shape, (24, 24, 24))

    def test_what_is_in_memory_here_is_not_pickled(self):
        for each in head(), head().render(size=24):
            for copies in pickle.dumps, copy.copy, copy.deepcopy:
                with self.assertRaisesRegex(TypeError, "cannot be pickled or copied: "):
                    copies(each)
        self.assertEqual(pickle.loads(pickle.dumps(sg.Look(preset="mr-default"))),
                         sg.Look(preset="mr-default"))

    def test_slices_have_y_up(self):
        array = numpy.arange(3 * 5 * 7, dtype=numpy.int16).reshape(3, 5, 7)
        volume = sg.Volume(array)
        for given, expected in (
                (volume.slice_values("z", 1), array[1]),
                (volume.slice_values("y", 2), array[:, 2]),
                (volume.slice_values("x", 3), array[:, :, 3])):
            numpy.testing.assert_array_equal(given[::-1], expected)

    def test_pixels_can_be_written_and_outlive_their_picture(self):
        volume = head()
        pixels = numpy.asarray(volume.render(size=24))
        volume.close()
        expected = pixels.copy()
        gc.collect()
        numpy.testing.assert_array_equal(pixels, expected)
        image = head().render(size=24)
        numpy.asarray(image)[3, 5] = 1
        image.save("changed.npy")
        self.assertEqual(numpy.load("changed.npy")[3, 5].tolist(), [1] * 4)

    @plain
    def test_a_child_draws_the_volumes_of_its_parent(self):
        volume = head()
        expected = numpy.asarray(volume.render(size=48, threads=2))
        child = os.fork()
        if child == 0:
            status = 1
            try:
                drawn = numpy.asarray(volume.render(size=48, threads=2))
                status = int(not (drawn == expected).all())
            finally:
                os._exit(status)
        self.assertEqual(os.waitpid(child, 0)[1], 0)

    def test_a_plain_array_is_seen_from_its_last_slice_with_y_up(self):
        array = numpy.zeros((12, 12, 12), numpy.uint8)
        array[11, 9:, 9:], array[0, :3, :3] = 200, 100  # near, far
        seen = sg.Volume(array).render(size=24, mode="mip", clim=(0, 200), fit="volume")
        bright = numpy.argwhere(numpy.asarray(seen)[..., 0] > 0.8)
        self.assertTrue((bright[:, 0] < 12).all() and (bright[:, 1] >= 12).all())
        self.same_picture(seen, sg.Volume(array).render(
            size=24, mode="mip", clim=(0, 200), fit="volume", view="+z"))

    def test_memory_is_that_of_files(self):
        with self.assertRaisesRegex(TypeError, "memory counts for files only: .*memory="):
            sg.Volume(RAMP, memory=1 << 20)

    def test_what_the_command_line_writes_on_pictures_is_drawn_or_warned_of(self):
        volume = head()
        for name, value in (("box", "axes"), ("annotate", "time")):
            with self.assertWarnsRegex(sg.SnowglassWarning, f"^{name} is not drawn"):
                sg.render(volume, size=24, **{name: value})
            with warnings.catch_warnings():
                warnings.simplefilter("error")
                sg.render(volume, size=24, **{name: None})
            with self.assertRaisesRegex(TypeError, f"{name} is not drawn by Python"):
                volume.render(**{name: value})
        with self.assertRaisesRegex(TypeError, "title is an option of Image.save"):
            volume.render(title="WRF")
        for given in {}, {"axis": "axial"}:
            sg.render(volume, size=96, title="WRF", **given).save("here.png")
            sg.render(volume, size=96, **given).save("saved.png", title="WRF")
            sg.render(volume, size=96, **given).save("without.png")
            with open("here.png", "rb") as here, open("saved.png", "rb") as saved, \
                    open("without.png", "rb") as without:
                drawn = here.read()
                self.assertEqual(drawn, saved.read())
                self.assertNotEqual(drawn, without.read())

    def test_the_background_of_a_recipe_is_that_of_its_file(self):
        for ground in ("white", "none", "#102030"):
            self.tool("render", "phantom:head", "--dims", "32x32x32", "-s", "64",
                      "--background", ground, "--save-config", "ground.json", "-o", "tool.png")
            with open("ground.json", encoding="utf-8") as file:
                recipe = json.load(file)
            sg.render(**recipe).save("here.png")
            with open("here.png", "rb") as here, open("tool.png", "rb") as there:
                self.assertEqual(here.read(), there.read())
        dark = sg.render(head(), size=24, background="white").to_rgb()
        self.assertEqual(dark[0, 0].tolist(), [255] * 3)
        clear = sg.render(head(), size=24, background=None)
        self.assertEqual(clear.png(), sg.render(head(), size=24).png(None))
        with self.assertRaisesRegex(ValueError, "'x' is no colour"):
            sg.render(head(), size=24, background="x")

    def test_what_help_says_first(self):
        self.assertIn("wraps an array", sg.Volume.__init__.__doc__)
        self.assertIn("exit status", sg.Error.__doc__)
        self.assertEqual(sg.Volume(RAMP, spacing=2).spacing, (2, 2, 2))


class Progress(InFolder):
    def test_what_takes_long_reports_and_can_be_ended(self):
        noise = numpy.random.default_rng(1).random((140, 140, 140)).astype("f4")
        volume = sg.Volume(noise)
        picture = volume.render(size=3600, quality="draft", threads=1)

        def stop(stage, fraction):
            raise ZeroDivisionError
        for stage, work in (
                ("read", lambda told: sg.Volume(
                    "phantom:turbulence", dims=(180,) * 3, progress=told)),
                ("read", lambda told: sg.render(
                    "phantom:turbulence", dims=(180,) * 3, size=24, progress=told)),
                # Anew each time: what a volume keeps makes the next call quick.
                ("render", lambda told: sg.Volume(noise).render(
                    size=6000, quality="high", threads=1, progress=told)),
                ("render", lambda told: sg.Volume(noise).project(
                    "sum", size=8000, quality="high", threads=1,
                    progress=told)),
                ("write", lambda told: volume.save("v.nii.gz", progress=told)),
                ("write", lambda told: picture.save("p.png", progress=told)),
                ("turntable", lambda told: head().turntable(
                    "t_%d.png", frames=2, size=24, overwrite=True, progress=told))):
            said = []
            work(lambda *each: said.append(each))
            with self.subTest(stage=stage, line=work.__code__.co_firstlineno):
                self.assertIn((stage, 1.0), said)
                with self.assertRaises(ZeroDivisionError):
                    work(stop)

    def test_what_is_quick_here_takes_it_too(self):
        said = []
        for work in (head().look, head().histogram, head().slice_ortho,
                     lambda progress: head().slice_grid(2, 2, progress=progress),
                     lambda progress: head().masked(
                         numpy.ones((24, 24, 24)), progress=progress)):
            work(progress=lambda *each: said.append(each))
        self.assertTrue(all(0 <= part <= 1 for _, part in said))

    @needs("netCDF4")
    def test_a_step_is_found_by_its_time(self):
        """As people of xarray write one, and where no step is, beside cftime."""
        import datetime

        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of NumPy's versions
            import cftime
            import netCDF4
        since, stamp = "hours since 2005-08-28", numpy.datetime64
        with netCDF4.Dataset("a.nc", "w") as file:
            for name, count in (("time", 300), ("z", 5), ("y", 6), ("x", 7)):
                file.createDimension(name, count)
                file.createVariable(name, "f8", (name,))[:] = numpy.arange(count)
                file[name].units = since if name == "time" else "km"
            file.createVariable("q", "f4", ("time", "z", "y", "x"))[:] = \
                numpy.random.default_rng(1).normal(size=(300, 5, 6, 7))
        when = datetime.datetime(2005, 9, 1, 12)
        step = round(cftime.date2num(when, since))
        east = datetime.timezone(datetime.timedelta(hours=5, minutes=30))
        for time in (step, step - 300, str(step), f"{step}h", "2005-09-01T12:00",
                     "2005-09-01 12:00:00", when, stamp("2005-09-01T12"),
                     stamp("2005-09-01T12:00:00.000000000"), numpy.array(when, "M8[us]"),
                     when.replace(hour=17, minute=30, tzinfo=east), cftime.datetime(
                         2005, 9, 1, 12), numpy.int64(step)):
            with self.subTest(time=time), warnings.catch_warnings():
                warnings.simplefilter("error")
                volume = sg.Volume("a.nc", time=time)
                self.assertEqual(volume.info["time"], step)
                self.assertEqual(volume.render(size=9).recipe["time"] % 300, step)
        self.assertEqual(sg.Volume("a.nc", time="last").info["time"], 299)
        self.assertEqual([step.info["time"] for step in sg.series("a.nc", time="7h")], [7])
        with self.assertWarnsRegex(sg.SnowglassWarning, "step 14 is the nearest to "
                                   "time='2005-08-28T14:20:00', at 2005-08-28 14:00$"):
            sg.Volume("a.nc", time=datetime.datetime(2005, 8, 28, 14, 20))
        with self.assertWarnsRegex(sg.SnowglassWarning, "step 299 is the nearest"):
            sg.Volume("a.nc", time=stamp("2035"))
        wanted = sg.Volume("a.nc", time=36).render(size=24)
        for made in (sg.render(sg.Volume("a.nc", time=0), time=stamp("2005-08-29T12"), size=24),
                     sg.render("a.nc", time="36h", size=24),
                     sg.render(**{**wanted.recipe, "time": "2005-08-29 12:00"})):
            self.same_picture(made, wanted)
        for wrong, kind, answer in (
                ("2005-02-30", ValueError, "^time: 2005-02-30 is not a date of the input, .*"
                 "hours since 2005-08-28"), ("3kg", ValueError, "^time: the unit \"kg\" cannot"),
                (0.5, TypeError, "^time: give the number of a step, .*, not 0.5$"),
                (stamp("NaT"), TypeError, "^time: give "), (300, ValueError, "no time step 300")):
            with self.assertRaisesRegex(kind, answer):
                sg.Volume("a.nc", time=wrong)
        with self.assertRaisesRegex(ValueError, "^time: the input has no physical times; give"):
            sg.Volume("phantom:head", time=when)
        with self.assertRaisesRegex(TypeError, r"array.sel\(time=...\) of xarray"):
            sg.render(RAMP, time=when)


if __name__ == "__main__":
    unittest.main()
