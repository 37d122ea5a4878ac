"""What a new user types: the fifteen lines that the package was designed by, as
they stand, and the first picture of five kinds of data in three lines."""
import importlib.util
import os
import shutil
import tempfile
import unittest
import warnings

import numpy

import snowglass as sg

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


def has(*names):
    return all(importlib.util.find_spec(name) for name in names)


def ball(shape=(30, 40, 50)):
    """A CT by its values."""
    z, y, x = numpy.indices(shape)
    far = sum(((place - side / 2) / side) ** 2 for place, side in
              zip((z, y, x), shape))
    return numpy.where(far < 0.06, 900, -1000).astype(numpy.int16)


class InFolder(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.addCleanup(os.chdir, os.getcwd())
        os.chdir(folder.name)


@unittest.skipUnless(has("nibabel", "h5py") and shutil.which("ffmpeg"),
                     "nibabel, h5py or ffmpeg is missing")
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
            if "recipe = fig.recipe" in line:
                # Of an array a recipe has no input; that of a file has.
                known["fig"] = sg.Volume("head.nii.gz").render(known["look"])
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
        self.assertGreater(sg.compare(known["fig"], "baseline.png").psnr, 45)

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

    def test_numpy_in_fortran_order(self):
        array = numpy.asfortranarray(ball())
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            volume = sg.Volume(array, spacing=(0.7, 0.7, 1.25))
            self.shows_a_ball(volume.render())
        self.assertTrue(numpy.shares_memory(array, numpy.asarray(volume)))
        same = sg.Volume(ball(), spacing=(0.7, 0.7, 1.25)).render()
        self.assertLess(sg.compare(volume.render(), same).mean, 1e-3)

    @unittest.skipUnless(has("nibabel"), "nibabel is missing")
    def test_an_oblique_image_of_nibabel(self):
        import nibabel
        turn = numpy.deg2rad(25)
        affine = numpy.diag([0.8, 0.9, 1.6, 1.0])
        affine[:2, :2] = [[-0.8 * numpy.cos(turn), 0.9 * numpy.sin(turn)],
                          [0.8 * numpy.sin(turn), 0.9 * numpy.cos(turn)]]
        nibabel.save(nibabel.Nifti1Image(ball().T, affine), "a.nii.gz")
        image = nibabel.load("a.nii.gz")
        volume = sg.Volume(image)
        self.shows_a_ball(volume.render())
        numpy.testing.assert_allclose(volume.affine, affine, atol=1e-6)
        self.assertEqual(sg.compare(volume.render(),
                                    sg.render("a.nii.gz")).largest, 0)

    @unittest.skipUnless(has("xarray"), "xarray is missing")
    def test_xarray_with_units(self):
        import xarray
        array = xarray.DataArray(
            ball().astype(numpy.float32), dims=("z", "y", "x"), attrs={
                "units": "K"}, coords={
                    "z": ("z", numpy.arange(30) * 2.5, {"units": "um"}),
                    "y": ("y", numpy.arange(40) * 1.5, {"units": "micrometer"}),
                    "x": ("x", numpy.arange(50) * 1.5, {"units": "um"})})
        volume = sg.Volume(array)
        self.shows_a_ball(volume.render(legend=True))
        self.assertEqual(volume.spacing, (1.5, 1.5, 2.5))
        self.assertEqual(volume.info["unit"], "um")

    @unittest.skipUnless(has("xarray", "netCDF4"), "xarray or netCDF4 is missing")
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
        self.assertEqual(volume.spacing, (0.5, 0.5, 0.5))
        self.shows_a_ball(volume.render())
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            array.to_netcdf("t.nc")
            file = sg.Volume("t.nc")
            numpy.testing.assert_allclose(volume.affine, file.affine)
            array.coords["level"].attrs["positive"] = "down"
            self.assertEqual(sg.Volume(array).affine[2, 2], -0.5)

    @unittest.skipUnless(has("xarray", "netCDF4"), "xarray or netCDF4 is missing")
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
            ((10, "Mm"), (1, "mm"), (1, "mm"), {}, (1, 1, 1)),
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

    @unittest.skipUnless(has("tifffile"), "tifffile is missing")
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

    @unittest.skipUnless(has("h5py"), "h5py is missing")
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
            self.assertEqual(sg.compare(made, wanted).largest, 0)
            self.assertEqual(made.recipe, wanted.recipe)
        with self.assertRaisesRegex(TypeError, "not both"):
            volume.render("viridis", clim=(0, 900))
        self.assertEqual(sg.compare(volume.render(cmap=None, preset=None),
                                    volume.render()).largest, 0)
        frames = [f"{name}_%d.png" for name in "ab"]
        volume.turntable(frames[0], cmap="viridis", frames=2, size=40)
        volume.turntable(frames[1], sg.Look(colormap="viridis"), frames=2,
                         size=40)
        for n in range(2):
            first, second = (sg.Image.load(name % n) for name in frames)
            self.assertEqual(sg.compare(first, second).largest, 0)

    def test_a_wrong_name_is_answered_by_the_right_ones(self):
        volume = sg.Volume(ball())
        for call, answer in (
                (lambda: sg.Volume(ball(), voxel_size=1), "take one of spacing"),
                (lambda: sg.Volume(ball(), dims=(1, 2, 3)), "for files only"),
                (lambda: volume.render(color="red"), "take one of threshold"),
                (lambda: volume.render(background="white"), "option of save"),
                (lambda: volume.render(zoom="2"), "^zoom: must be"),
                (lambda: volume.render(mode=3), "^mode: there is no 3; take one of"),
                (lambda: volume.render(opacity="sigmoid"), r"'sigmoid': give points"),
                (lambda: volume.render(opacity=[0, 0.5, 1]), "opacity .*give points"),
                (lambda: sg.Look(opacity=0.5), "^opacity 0.5: give points"),
                (lambda: sg.Look(symlog="a"), "^symlog 'a': must be a magnitude"),
                (lambda: volume.render(threads="2"),
                 "^threads: must be a whole number, not '2'"),
                (lambda: sg.Volume(ball().astype([("red", "i2")])), "its fields")):
            with self.assertRaisesRegex(TypeError, answer):
                call()

    def test_a_wrong_value_is_answered_by_the_right_ones(self):
        volume = sg.Volume(ball())
        for call, answer in (
                (lambda: volume.render(quality="ultra"),
                 "'ultra'; take one of normal, draft, high$"),
                (lambda: volume.render(shade="flat"), "take one of phong, none$"),
                (lambda: volume.render(threads=2 ** 40), "^threads: 1099511627776"),
                (lambda: sg.Look(symlog=-1), "^symlog -1: must be a magnitude"),
                (lambda: sg.render(ball(), time="2:4"),
                 r"\(time 2:4\) cannot be drawn here; use the command line"),
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
                (lambda: sg.Volume("a_3x2x5_16bit.bin"), r"dims=\(3, 2, 5\) "
                 r"type='uint16' or 'int16', which fits$"),
                (lambda: sg.Volume("a_3x1x5_32bit.bin"),
                 "type='float32', 'int32' or 'uint32', which fits$"),
                (lambda: sg.Volume("a.npy", crop=((0, 9), (0, 99), (0, 9))),
                 r"crop=\(\(0, 9\), \(0, 99\), \(0, 9\)\) is not inside")):
            with self.assertRaisesRegex((ValueError, sg.Error), answer) as caught:
                call()
            self.assertNotIn("--", str(caught.exception))

    def test_points_may_be_what_is_read_once(self):
        volume = sg.Volume(ball())
        listed = sg.Look(opacity=[(10, 0), (90, .8)],
                         gradient_opacity=[(0, 0), (20, 1)])
        once = sg.Look(opacity=zip([10, 90], [0, .8]),
                       gradient_opacity=iter([(0, 0), (20, 1)]))
        for _ in range(2):
            self.assertEqual(sg.compare(volume.render(listed, size=40),
                                        volume.render(once, size=40)).largest, 0)

    def test_truths_of_numpy_are_truths(self):
        self.assertIs(sg.Look(symlog=numpy.bool_(True)).symlog, True)
        self.assertIs(sg.Look(symlog=numpy.bool_(False)).symlog, False)

    def test_shade_is_a_name_or_a_truth(self):
        volume = sg.Volume(ball().astype(float))
        for shade, name in ((True, "phong"), (False, "none"),
                            (numpy.bool_(True), "phong"), (numpy.bool_(False), "none")):
            made, named = (volume.render("ct-bone", shade=each)
                           for each in (shade, name))
            self.assertEqual(sg.compare(made, named).largest, 0)
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

    @unittest.skipUnless(has("nibabel"), "nibabel is missing")
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

    @unittest.skipUnless(has("xarray"), "xarray is missing")
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

    @unittest.skipUnless(has("h5py"), "h5py is missing")
    def test_the_unit_of_a_data_set_stands_over_the_legend(self):
        import h5py
        with h5py.File("a.h5", "w") as file:
            for unit in ("K", numpy.bytes_("K")):
                data = file.create_dataset(repr(unit), data=ball())
                data.attrs["units"] = unit
                self.assertEqual(sg.Volume(data)._caption(), "K")


if __name__ == "__main__":
    unittest.main()
