"""What a new user types: the fifteen lines that the package was designed by, and the first picture of five kinds of data in three lines."""
import os
import shlex
import shutil
import subprocess
import unittest
import warnings

import numpy

import snowglass as sg
from beside import InFolder as Strict, needs

#: As they were written before the package was.
LINES = '''
import snowglass as sg, numpy as np, nibabel as nib
img = sg.render("head.nii.gz")                          # an Image; shows itself in Jupyter (_repr_png_)
img.save("head.png"); a = np.asarray(img)               # float32 (h, w, 4), premultiplied, no copy
vol = sg.Volume(ct, spacing=(0.7, 0.7, 1.25))           # NumPy, zero copy; or sg.Volume(nib.load(p)), xarray
print(vol)                                              # 512x512x300 int16, 0.7x0.7x1.25 mm, -1024..3071
look = sg.Look(preset="ct-bone", range=(150, 1200))     # or sg.Look(colormap="viridis", opacity=[(0, 0), (1, .8)])
fig = vol.render(look, view="anterior", azimuth=30, size=(800, 600), quality="high", legend=True)
mip = vol.project("mip", view="left")                   # ndarray in data units: DRR, MIP, mean, sum
rgba, depth = vol.render(look, depth=True)
vol.turntable("turn.mp4", look, frames=120, progress=True)
for step in sg.series("run_%04d.h5", dataset="rho"):    # never more than one step in memory
    step.render(look).save(f"rho_{step.index:04d}.png")
vol.view(look)                                          # the viewer, in the notebook or the browser
recipe = fig.recipe; sg.render(**recipe)                # the same JSON as the command line and in situ
fig.command                                             # 'snowglass render ... --preset ct-bone ...'
sg.compare(fig, "baseline.png").psnr                    # image tests: pytest plug-in `snowglass_compare`
'''


def ball(shape=(30, 40, 50)):
    """A CT by its values."""
    z, y, x = numpy.indices(shape)
    far = sum(((place - side / 2) / side) ** 2 for place, side in
              zip((z, y, x), shape))
    return numpy.where(far < 0.06, 900, -1000).astype(numpy.int16)


class InFolder(Strict):
    strict = False


@needs("nibabel", "h5py")
@unittest.skipUnless(shutil.which("ffmpeg"), "ffmpeg is missing")
class Lines(InFolder):
    def test_they_run(self):
        import h5py
        import nibabel
        ct = ball()
        affine = numpy.diag([0.7, 0.7, 1.25, 1])
        nibabel.save(nibabel.Nifti1Image(ct.T, affine), "head.nii.gz")
        for step in range(3):
            with h5py.File(f"run_{step:04d}.h5", "w") as file:
                file["rho"] = ct.astype(numpy.float32) + step
        lines = LINES.replace("frames=120", "frames=4")
        known = {"ct": ct}
        for number, line in enumerate(self.statements(lines)):
            if "sg.render(**recipe)" in line:
                # Of an array a recipe has no input, and says so.
                with self.assertRaisesRegex(TypeError, r"render\(volume, \*\*recipe\)"):
                    exec(line, known)
                line = line.replace("(**recipe)", "(vol, **recipe)")
            if "baseline.png" in line:
                known["fig"].save("baseline.png")
            with self.subTest(line), warnings.catch_warnings():
                warnings.simplefilter("ignore")
                exec(compile(line, f"line {number}", "exec"), known)
        self.assertEqual(known["a"].dtype, numpy.float32)
        self.assertEqual(numpy.nanmax(known["mip"]), 900)
        self.assertEqual(known["depth"].shape, known["rgba"].shape[:2])
        self.assertTrue(numpy.isfinite(numpy.asarray(known["depth"])).any())
        self.assertTrue(os.path.exists("rho_0002.png"))
        self.assertGreater(os.path.getsize("turn.mp4"), 500)
        self.assertIn("--preset ct-bone", known["fig"].command)
        self.runs_as_a_command(known["vol"], known["fig"])
        self.assertGreater(sg.compare(known["fig"], "baseline.png").psnr, 45)

    def runs_as_a_command(self, volume, picture):
        volume.save("VOLUME.nrrd")
        words = shlex.split(picture.command)
        self.assertEqual(words[:3], ["snowglass", "render", "VOLUME.nrrd"])
        if "SNOWGLASS" in os.environ:
            subprocess.run([os.environ["SNOWGLASS"], *words[1:], "-q", "-o", "c.png"],
                           check=True)
            self.same_picture("c.png", picture)

    def test_an_image_of_nibabel_is_its_file(self):
        import nibabel
        nibabel.save(nibabel.Nifti1Image(ball().T, numpy.diag([1, 2, 3, 1])), "a.nii")
        load = lambda: nibabel.load("a.nii")
        picture = sg.Volume(load()).render("ct-bone", size=40)
        self.assertEqual(picture.recipe["input"], "a.nii")
        self.same_picture(sg.render(**picture.recipe), picture)
        moved, other = load(), nibabel.Nifti1Image(ball().T, numpy.eye(4))
        moved.affine[0, 3] = 5
        for each in (sg.Volume(moved), sg.Volume(other),
                     sg.Volume(load(), spacing=(1, 1, 2)),
                     sg.Volume(load(), intercept=5),
                     sg.Volume(load().slicer[:, :, 5:])):
            self.assertNotIn("input", each.render("ct-bone", size=40).recipe)

    def test_an_image_of_nibabel_has_its_window(self):
        import nibabel
        slab = numpy.arange(2000, dtype=numpy.int16).reshape(40, 50, 1)
        image = nibabel.Nifti1Image(slab, numpy.eye(4))
        image.header["cal_min"], image.header["cal_max"] = 100, 1500
        nibabel.save(image, "window.nii")
        for source in (image, nibabel.load("window.nii"), "window.nii"):
            self.assertIn("100..1500", sg.Volume(source).look())
        image.header["intent_code"] = 1002
        self.assertNotIn("100..1500", sg.Volume(image).look())

    def statements(self, text):
        import ast
        lines = text.split("\n")
        for each in ast.parse(text).body:
            yield "\n".join(lines[each.lineno - 1:each.end_lineno])


class FirstPictures(InFolder):
    """Each in three lines: the object, the volume, the picture."""

    def shows_a_ball(self, image):
        image.save("first.png")
        alpha = numpy.asarray(image)[..., -1]
        self.assertGreater((alpha > 0.3).mean(), 0.1)
        self.assertEqual(alpha[0, 0], 0)
        self.assertTrue(image._repr_png_().startswith(b"\x89PNG"))

    @needs("xarray", "netCDF4")
    def test_heights_beside_degrees_lie_as_those_of_files(self):
        import xarray
        array = xarray.DataArray(ball().astype(numpy.float32), name="t", dims=(
            "level", "lat", "lon"), coords={
                "level": ("level", numpy.arange(30) * 500.0, {
                    "units": "m", "positive": "up"}),
                "lat": ("lat", 60 - numpy.arange(40) * 0.5, {
                    "units": "degrees_north"}),
                "lon": ("lon", numpy.arange(50) * 0.5, {"units": "degrees_east"})})
        with self.assertWarnsRegex(sg.SnowglassWarning, "'level' has another unit"):
            volume = sg.Volume(array)
        numpy.testing.assert_allclose(volume.spacing, (0.5, 0.5, 19.5 / 3 / 29))
        self.shows_a_ball(volume.render())
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            array.to_netcdf("t.nc")
            file = sg.Volume("t.nc")
            numpy.testing.assert_allclose(volume.affine, file.affine)
            array.coords["level"].attrs["positive"] = "down"
            self.assertAlmostEqual(sg.Volume(array).affine[2, 2], -19.5 / 3 / 29)
            numpy.testing.assert_allclose(file.spacing, (0.5, 0.5, 500))
            self.assertEqual(file.axis_units, ("degrees", "degrees", "m"))
            higher = sg.Volume("t.nc", z_scale=2)
            self.assertAlmostEqual(higher.affine[2, 2], 2 * 500 / 111195)
            numpy.testing.assert_allclose(higher.spacing, file.spacing)

    @needs("netCDF4")
    def test_levels_of_wrf_are_flat_or_columns(self):
        import netCDF4
        ground = numpy.array([[0.0, 90.0, 0.0]] * 2)
        levels = 9.81 * (ground + numpy.arange(0, 700, 100.0)[:, None, None])
        with netCDF4.Dataset("wrf.nc", "w") as file:
            file.DX = file.DY = 500.0
            for name, size in (("west_east", 3), ("south_north", 2),
                               ("bottom_top", 6), ("bottom_top_stag", 7)):
                file.createDimension(name, size)
            for name, values, axis in (("PHB", levels, "bottom_top_stag"),
                                       ("PH", 0 * levels, "bottom_top_stag"),
                                       ("T", levels[1:], "bottom_top")):
                file.createVariable(name, "f4", (axis, "south_north", "west_east"))[:] = values
        flat = sg.Volume("wrf.nc", dataset="T")
        columns = sg.Volume("wrf.nc", dataset="T", vertical="height")
        self.assertFalse(numpy.isnan(numpy.asarray(flat)).any())
        self.assertTrue(numpy.isnan(numpy.asarray(columns)).any())
        with self.assertRaisesRegex(ValueError, "vertical='depth': is no way"):
            sg.Volume("wrf.nc", dataset="T", vertical="depth")

    @needs("xarray", "netCDF4")
    def test_coordinates_count_as_those_of_files(self):
        import xarray

        def of(n, step, unit=None, **more):
            return numpy.arange(float(n)) * step + 3, {
                **({} if unit is None else {"units": unit}), **more}

        def placed(z, y, x, more):
            array = xarray.DataArray(ball().astype(numpy.float32), name="t", dims=(
                "z", "y", "x"), coords={"z": ("z", *of(30, *z)), "y": (
                    "y", *of(40, *y)), "x": ("x", *of(50, *x))})
            array.coords["z"].attrs.update(more)
            array.to_netcdf("u.nc")
            volume, file = sg.Volume(array), sg.Volume("u.nc")
            numpy.testing.assert_allclose(volume.affine, file.affine, rtol=1e-12)
            self.assertEqual(volume.info["unit"], file.info["unit"])
            return volume.affine.diagonal()[2::-1]

        cases = [  # z, y, x; attributes of z; what z, y, x are
            ((10, "meters"), (1, "m"), (1, "m"), {}, (10, 1, 1)),
            ((10, "m"), (1, "metre"), (1, "meters"), {}, (10, 1, 1)),
            ((3, "micrometer"), (1, "\u00b5m"), (2, "um"), {}, (3, 1, 2)),
            ((500, "m"), (1, "kilometres"), (1, "km"), {}, (0.5, 1, 1)),
            ((1, "km"), (500, "m"), (500, "m"), {}, (1000, 500, 500)),
            ((2, "ms"), (1, "m"), (1, "m"), {}, (1, 1, 1)),
            ((2,), (1, "m"), (1, "m"), {}, (1, 1, 1)),
            ((2, "m"), (1, "m"), (3,), {}, (3, 3, 3)),
            ((2,), (1,), (3,), {}, (2, 1, 3)),
            ((2, "m"), (1, "m"), (1, "m"), {"positive": "DOWN"}, (-2, 1, 1)),
            ((2, "hPa"), (1, "m"), (1, "m"), {"positive": "up"}, (1, 1, 1)),
            ((2, "HPA"), (1, "m"), (1, "m"), {}, (-1, 1, 1))]
        for z, y, x, more, expected in cases:
            with self.subTest((z, y, x, more)), warnings.catch_warnings():
                warnings.simplefilter("ignore")
                numpy.testing.assert_allclose(placed(z, y, x, more), expected)
        uneven = xarray.DataArray(ball(), dims=("z", "y", "x"), coords={
            "z": numpy.arange(30.0) ** 2})
        with self.assertWarnsRegex(sg.SnowglassWarning, "'z' is not evenly .*file"):
            self.assertEqual(sg.Volume(uneven).spacing[2], 29)

    @needs("tifffile")
    def test_a_stack_of_tiffs(self):
        import tifffile
        os.mkdir("stack")
        for n, part in enumerate((ball() + 1000).astype(numpy.uint16)):
            tifffile.imwrite(f"stack/slice_{n:03d}.tif", part)
        volume = sg.Volume("stack", spacing=(0.5, 0.5, 1))
        self.shows_a_ball(volume.render())
        self.assertEqual(volume.dims, (50, 40, 30))
        tifffile.imwrite("all.tif", (ball() + 1000).astype(numpy.uint16))
        numpy.testing.assert_array_equal(numpy.asarray(sg.Volume("all.tif")),
                                         numpy.asarray(volume))
        with self.assertRaisesRegex(TypeError, "name their folder"):
            sg.Volume(["stack/slice_000.tif", "stack/slice_001.tif"])

    @needs("h5py")
    def test_a_group_of_hdf5(self):
        import h5py
        with h5py.File("a.h5", "w") as file:
            file["run/density"] = ball()
            file["run/other"] = numpy.zeros(3)
            with self.assertRaisesRegex(TypeError, r"group\['density'\]"):
                sg.Volume(file["run"])
            with self.assertRaisesRegex(TypeError, r"file\['run/density'\]"):
                sg.Volume(file)
            self.shows_a_ball(sg.Volume(file["run"]["density"]).render())
        volume = sg.Volume("a.h5", dataset="run/density")
        self.shows_a_ball(volume.render())
        self.shows_a_ball(sg.render("a.h5", open={"dataset": "run/density"}))


class Stumbles(InFolder):
    """What new users tried, and what they are told."""

    def test_a_look_is_given_to_render_as_elsewhere(self):
        volume = sg.Volume(ball())
        wanted = volume.render(sg.Look(colormap="viridis", range=(0, 900)))
        for made in (volume.render(cmap="viridis", clim=(0, 900)),
                     sg.render(ball(), cmap="viridis", clim=(0, 900)),
                     volume.render(colormap="viridis", range=(0, 900))):
            self.same_picture(made, wanted)
            self.assertEqual(made.recipe, wanted.recipe)
        with self.assertRaisesRegex(TypeError, "not both"):
            volume.render("viridis", clim=(0, 900))
        self.same_picture(volume.render(cmap=None, preset=None), volume.render())
        for name, look in (("a", {"cmap": "viridis"}),
                           ("b", {"look": sg.Look(colormap="viridis")})):
            volume.turntable(f"{name}_%d.png", **look, frames=2, size=40)
        for n in range(2):
            self.same_bytes(f"a_{n}.png", f"b_{n}.png")

    def test_a_wrong_name_is_answered_by_the_right_ones(self):
        volume = sg.Volume(ball())
        for call, answer in (
                (lambda: sg.Volume(ball(), voxel_size=1), "take one of spacing"),
                (lambda: sg.Volume(ball(), dims=(1, 2, 3)), "for files only"),
                (lambda: volume.render(color="red"),
                 "take one of look, preset, .*, cmap, .*, threshold, .*, view"),
                (lambda: volume.render(background="white"), "option of save"),
                (lambda: volume.render(zoom="2"), "^zoom: must be"),
                (lambda: volume.render(mode=3), "^mode: there is no 3; take one of"),
                (lambda: volume.render(opacity=[0, 0.5, 1]), "^opacity: give points"),
                (lambda: sg.Look(opacity=sum), "^opacity: give points .*, a name or"),
                (lambda: sg.Look(scale=5), "^scale: give 'linear', 'log', .*, not 5$"),
                (lambda: volume.render(threads="2"),
                 "^threads: must be a whole number, not '2'"),
                (lambda: sg.Volume(ball().astype([("red", "i2")])), "its fields")):
            with self.assertRaisesRegex(TypeError, answer):
                call()

    def test_a_wrong_value_is_answered_by_the_right_ones(self):
        volume = sg.Volume(ball())
        for call, answer in (
                (lambda: volume.render(shade="flat"), "take one of phong, none$"),
                (lambda: sg.Look(scale="symlog:-1"), "^scale: give 'linear', 'log', .*above 0"),
                (lambda: sg.Volume("a.nc", time="2:4"),
                 "^time: give the number of a step, .* not '2:4'; snowglass.series has"),
                (lambda: sg.Volume("a.nc", time="x"), "^time: give .* not 'x'$"),
                (lambda: sg.Volume("a.raw", type="int9"),
                 "type: .*take one of int8, .*, float64$"),
                (lambda: sg.Volume("a.raw", endian="x"), "take one of little, big$"),
                (lambda: volume.render(size="10x10"), r"'10x10': give \(width"),
                (lambda: volume.render(size=(10,)), r"\(10,\): give \(width"),
                (lambda: sg.Volume(ball(), spacing="1,1,2"), "three lengths"),
                (lambda: sg.Volume(ball(), spacing=(1, 2)), "three lengths"),
                (lambda: sg.Volume(ball(), spacing=(1, 1, -1)), "three lengths")):
            with self.assertRaisesRegex(ValueError, answer):
                call()

    def test_each_argument_says_what_to_give(self):
        ct, volume = ball(), sg.Volume(ball())
        image = volume.render(size=16)
        axis, label, light = "'axial', .*, or 0 to 2", "whole number", "'key', 'head'"
        number, color = "must be 3 numbers$", r"points \(value, \(red, green, blue\)\)"
        for name, give, wrong, call in (
                ("axis", axis, (50, -4, 1.5, None), volume.slice),
                ("at", "a slice's number, 0 to 29, .*'12.5mm'", (0.5, (1,)),
                 lambda at: volume.slice("axial", at)),
                ("labels", label, (3.5, [1, "a"], 1j),
                 lambda labels: volume.masked(ct, labels=labels)),
                ("light", light, ((30,), (30, 40, 50), 5, (1, "a")), None),
                ("window", r"\(width, centre\), the width above 0", (400, "ab", (0, 40)), None),
                ("view", "a name of snowglass.views", ((1, 0, 0), 5), None),
                ("perspective", "True or degrees", ("yes", float("nan")), None),
                ("legend", "True, a title", (5,), None),
                ("range", r"\(low, high\), 'full'", (
                    5, "foo", "5%-95%", ("a", "b"), (1, 2, 3), ct), None),
                ("colors", color, (["red", "blue"], [(0, "red")], 5, [(0, (1, 0))],
                                   "red", [0, 1]), None),
                ("opacity", "points .value, opacity", ([(0, "a")], [1, 2]), None),
                ("colormap", "a name of snowglass.colormaps", (["red"], 5), None),
                ("preset", "a name of snowglass.presets", (5,), None),
                ("unit", "the name of a length", (5,), lambda x: sg.Volume(ct, unit=x)),
                ("axes", "the order", (5, "zy"), lambda x: sg.Volume(ct, axes=x)),
                ("slope", "a finite number other than 0", (0, float("nan"), "a"),
                 lambda x: sg.Volume(ct, slope=x)),
                ("intercept", "a finite number", (float("inf"), "a"),
                 lambda x: sg.Volume(ct, intercept=x)),
                ("affine", "a 4x4 matrix", (numpy.zeros((4, 4)), "a"),
                 lambda x: sg.Volume(ct, affine=x)),
                ("memory", "the most bytes", ("a",), lambda x: sg.Volume(
                    "phantom:head", memory=x)),
                ("title", "a line of text", (5,), lambda x: image.save(
                    "a.png", title=x)),
                ("background", "a colour's name", (5, (1, 2, "a")), lambda x:
                 image.save("a.png", background=x)),
                ("fps", "frames a second above 0", (0, -1, "a", float("inf")),
                 lambda x: volume.turntable("t.mp4", fps=x, frames=2)),
                ("frames", "a whole number from 1", (0, "a", 1.5),
                 lambda x: volume.turntable("t_%d.png", frames=x)),
                ("b", "an Image or the path", (numpy.asarray(image), 5),
                 lambda x: sg.compare(image, x)),
                ("bins", "a whole number", ("a",), volume.histogram),
                ("range", r"\(low, high\)", (5, (1,)), lambda x: volume.histogram(
                    9, x))):
            for each in wrong:
                line = f"^{name}: give [^\n]*{give}[^\n]*, not [^\n]*$"
                with self.subTest(name=name, value=each), \
                        self.assertRaisesRegex((TypeError, ValueError), line):
                    call(each) if call else volume.render(size=16, **{name: each})

    def test_other_lines_of_arguments(self):
        ct, volume = ball(), sg.Volume(ball())
        flat = numpy.diag([1.0, 0, 1, 1])
        turn = lambda path: lambda: volume.turntable(path, frames=2, size=16)
        for kind, answer, call in (
                (TypeError, "^up must be 3 numbers$", lambda: volume.render(up="z")),
                (TypeError, "^give range or window", lambda: volume.render(
                    clim=(0, 1), window=(4, 4))),
                (TypeError, "^clim: project gives data values", lambda: volume.project(
                    "mip", clim=(0, 1))),
                (ValueError, "^affine: it is singular: .*, or give spacing$",
                 lambda: sg.Volume(ct, affine=flat)),
                (ValueError, "^spacing .*three lengths", lambda: sg.Volume(
                    ct, spacing=(1, 1, float("inf")))),
                (sg.Error, "^no/t.mp4: .*make it first", turn("no/t.mp4")),
                (ValueError, "a pattern with one number", turn("a_%d_%d.png")),
                (ValueError, "a pattern with one number", turn("a_100%_%d.png")),
                (TypeError, "^affine counts for arrays only", lambda: sg.render(
                    "phantom:head", affine=numpy.eye(4))),
                (TypeError, "^affine is an option of Volume", lambda: volume.render(
                    affine=numpy.eye(4))),
                (ValueError, "^affine: the volume is open", lambda: sg.render(
                    volume, affine=numpy.eye(4))),
                (TypeError, "take one of dims, .*, clip, memory, progress$",
                 lambda: sg.Volume("phantom:head", nope=1)),
                (FileNotFoundError, "there is no such file", lambda: next(
                    sg.series("no*/run_*.h5")))):
            with self.subTest(answer):
                with self.assertRaisesRegex(kind, answer) as caught:
                    call()
                self.assertNotRegex(str(caught.exception), "each_|header")

    @needs("nibabel")
    def test_a_singular_image_of_nibabel(self):
        import nibabel
        image = nibabel.Nifti1Image(ball().T, numpy.eye(4))
        image.affine[1, 1] = 0
        with self.assertRaisesRegex(ValueError, "^affine of the image: .*give spacing"):
            sg.Volume(image)
        self.assertEqual(sg.Volume(image, spacing=(1, 2, 3)).spacing, (1, 2, 3))

    def test_what_may_be_given_otherwise(self):
        ct, volume = ball(), sg.Volume(ball(), spacing=(1, 2, 3))
        colors = [(0, (0, 0, 1)), (900, (1, 0, 0))]
        affine = numpy.diag([1.0, 2, 3, 1])
        same = self.same_picture
        for n, axis in enumerate("zyx"):
            same(volume.slice(n), volume.slice(axis))
            self.assertEqual(volume.slice(n - 3).recipe, volume.slice(axis).recipe)
            numpy.testing.assert_array_equal(volume.slice_values(n),
                                             volume.slice_values(axis))
        for label in 900, numpy.int16(900), [900], numpy.array([900.0]), "900":
            same(volume.masked(ct, label).render(), volume.masked(ct, "900").render())
        for one, other in (
                ({"window": (400, 40)}, {"range": (-160, 240)}),
                ({"colors": colors}, {"look": sg.Look(colors=iter(colors))})):
            same(volume.render(size=32, **one), volume.render(size=32, **other))
            same(sg.render(volume, size=32, **one), volume.render(size=32, **other))
        same(sg.render(ct, affine=affine, medical=True, slope=2, memory=None),
             sg.Volume(ct, affine=affine, medical=True, slope=2).render())
        same(sg.render(ct, axes="xyz"), sg.Volume(ct, axes="xyz").render())
        same(sg.render("phantom:head", dims=(32, 32, 32), memory=2 ** 30, box="axes"),
             sg.render("phantom:head", dims=(32, 32, 32)))
        with self.assertRaises(MemoryError):
            sg.render("phantom:head", memory=1000)

    def test_an_offset_is_a_range_or_an_intercept(self):
        ct = numpy.maximum(ball() + 1024, 0).astype(numpy.uint16)
        with self.assertWarnsRegex(sg.SnowglassWarning,
                                   "offset of 1024, give range=.1174, 2524.$"):
            sg.Volume(ct).render("ct-bone", size=16)
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            sg.Volume(ct, intercept=-1024).render("ct-bone", size=16)
            sg.Volume(ct).render(preset="ct-bone", range=(1174, 2524), size=16)

    def test_messages_name_arguments_and_not_options(self):
        numpy.save("a.npy", ball())
        for name in "a.bin", "a_3x2x5_16bit.bin", "a_3x1x5_32bit.bin":
            with open(name, "wb") as file:
                file.write(bytes(3 * 4 * 5))
        with self.assertWarnsRegex(sg.SnowglassWarning, r"dims=\(50, 40, 30\) "
                                   r"type='int16' spacing=\(1, 1, 2\)$"):
            sg.Volume(ball(), spacing=(1, 1, 2)).save("b.raw")
        for call, answer in (
                (lambda: sg.Volume("a.npy", dataset="rho"), "^(.*: )?dataset=rho: "),
                (lambda: sg.Volume("a.npy", dims=(1, 2, 3)),
                 "remove dims=, type=, endian= and offset="),
                (lambda: sg.Volume("a.bin"), r"give dims=\(x, y, z\) and type "
                 r"\(uint8, int16, float32, \.\.\.\)"),
                (lambda: sg.Volume("a_3x2x5_16bit.bin"), "what fits: 3x2x5 uint16 "
                 "or int16$"),
                (lambda: sg.Volume("a_3x1x5_32bit.bin"),
                 "what fits: 3x1x5 float32, int32 or uint32$"),
                (lambda: sg.Volume("a.npy", crop=((0, 9), (0, 99), (0, 9))),
                 r"crop=\(\(0, 9\), \(0, 99\), \(0, 9\)\) is not inside")):
            with self.assertRaisesRegex((ValueError, sg.Error), answer) as caught:
                call()
            self.assertNotIn("--", str(caught.exception))
        for said, answer in (
                ("0 and one value; --preset linear shows values", "; preset='linear' shows values"),
                ("hot (--overlay-look) shows", r"hot \(overlay_look=\) shows"),
                ("--vertical height shows each", "^vertical='height' shows each"),
                ("open it with --allow-gaps", "with allow_gaps=True$"),
                ("open a part by --crop, or", "by crop=, or"),
                ("--suv: the volume is", "^suv: the volume is")):
            self.assertRegex(sg._snowglass.text(said), answer)

    def test_points_may_be_what_is_read_once(self):
        volume = sg.Volume(ball())
        listed = sg.Look(opacity=[(10, 0), (90, .8)],
                         gradient_opacity=[(0, 0), (20, 1)])
        once = sg.Look(opacity=zip([10, 90], [0, .8]),
                       gradient_opacity=iter([(0, 0), (20, 1)]))
        for _ in range(2):
            self.same_picture(volume.render(listed, size=40),
                              volume.render(once, size=40))

    def test_shade_is_a_name_or_a_truth(self):
        volume = sg.Volume(ball().astype(float))
        for shade, name in ((True, "phong"), (False, "none"),
                            (numpy.bool_(True), "phong"), (numpy.bool_(False), "none")):
            made, named = (volume.render("ct-bone", shade=each)
                           for each in (shade, name))
            self.same_picture(made, named)
            self.assertEqual(made.recipe, named.recipe)
        self.assertGreater(sg.compare(volume.render("ct-bone", shade=True),
                                      made).largest, 0.01)

    def test_dimensions_of_one_are_left_out(self):
        for array in (ball()[None], ball()[None, None], ball()[..., None]):
            self.assertEqual(sg.Volume(array).shape, ball().shape)
        slice_ = ball()[None, :1, :, :, None]  # (t, z, y, x, channel)
        self.assertEqual(sg.Volume(slice_).shape, (1, *ball().shape[1:]))
        for array, way in ((ball()[0], r"array\[None\]"),
                           (numpy.stack([ball()] * 2), r"array\[0\]"),
                           (numpy.stack([ball()] * 3, -1), r"\.\.\., 0")):
            with self.assertRaisesRegex(TypeError, way):
                sg.Volume(array)

    def test_an_affine_is_that_of_nibabel_in_fortran_order(self):
        affine = numpy.diag([1, 2, 3, 1])
        array = ball()[:, :30, :20]
        with self.assertWarnsRegex(sg.SnowglassWarning, "taken for .x, y, z."):
            volume = sg.Volume(numpy.asfortranarray(array), affine=affine)
        self.assertEqual(volume.dims, array.shape)
        self.assertEqual(sg.Volume(array, affine=affine).dims, array.shape[::-1])
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            self.assertEqual(sg.Volume(numpy.asfortranarray(array), affine=affine,
                                       axes="zyx").dims, array.shape[::-1])

    @needs("nibabel")
    def test_data_and_affine_of_nibabel_are_its_image(self):
        import nibabel
        image = nibabel.Nifti1Image(ball().T, numpy.diag([0.7, 0.7, 1.25, 1]))
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            apart = sg.Volume(image.get_fdata(), affine=image.affine, axes="xyz")
        whole = sg.Volume(image)
        for name in ("dims", "matrix", "medical", "unit"):
            self.assertEqual(apart.info[name], whole.info[name], name)
        plain = sg.Volume(image.get_fdata(), affine=image.affine, axes="xyz",
                          medical=False, unit="um")
        self.assertEqual((plain.info["medical"], plain.info["unit"]), (False, "um"))

    @needs("xarray")
    def test_xarray_with_time_and_units_of_all_kinds(self):
        import xarray
        array = xarray.DataArray(ball(), dims=("z", "y", "x"), coords={
            "z": ("z", numpy.arange(30) * 10.0, {"units": "hPa"}),
            "y": ("y", numpy.arange(40.0), {"units": "degrees"})})
        with self.assertWarnsRegex(sg.SnowglassWarning, "'hPa'.* than x"):
            volume = sg.Volume(array.expand_dims(time=[0]))
        self.assertEqual(volume.dims, (50, 40, 30))
        self.assertEqual(volume.spacing, (1, 1, 1))
        self.assertEqual(volume.affine[2, 2], -1)
        array.coords["x"] = ("x", numpy.arange(50.0), {"units": "degrees_east"})
        with self.assertWarnsRegex(sg.SnowglassWarning, "'hPa'.* than x .'degrees'"):
            volume = sg.Volume(array)
        self.assertEqual(volume.info["unit"], "degrees")
        data = array.to_dataset(name="t")
        data["mean"] = array.mean()
        with self.assertRaisesRegex(TypeError, r"choose .* dataset\['t'\]"):
            sg.Volume(data)

    def test_warnings_name_the_line_that_called(self):
        array = numpy.zeros((8, 8, 16), numpy.int16)
        array[2:6, 2:6, 4:12] = 700
        for call in (lambda: sg.Volume(array[..., ::2]),       # of the package
                     lambda: sg.render(array[..., ::2], size=16),
                     lambda: sg.render("phantom:head", look="ct-bone", size=16)):
            with warnings.catch_warnings(record=True) as caught:
                warnings.simplefilter("always")
                call()                                         # the last of the core
            self.assertEqual([each.filename for each in caught], [__file__])

    @needs("h5py")
    def test_name_and_unit_of_a_data_set_stand_over_the_legend(self):
        import h5py
        with h5py.File("a.h5", "w") as file:
            for unit in ("K", numpy.bytes_("K")):
                data = file.create_dataset(repr(unit), data=ball())
                data.attrs["units"] = unit
                self.assertEqual(sg.Volume(data)._caption(), f"{unit!r} (K)")
            data = file.create_dataset("listed", data=ball())
            data.attrs["units"] = numpy.array([b"K"])
            self.assertEqual(sg.Volume(data)._caption(), "listed (K)")
            for unit in (b"\xb0C", numpy.bytes_(b"\xb0C")):  # of Latin-1
                data.attrs["units"] = unit
                self.assertEqual(sg.Volume(data)._caption(), "listed (?C)")
