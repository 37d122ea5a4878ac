"""Arrays as people have them: masks of NumPy, dask, xarray and netCDF4, images of
nibabel and Pillow, tables, paths; and a program whose locale has a decimal comma.
numpy.ma.asarray(x[...]) says the right values; what it masks is missing (NaN)."""
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest
import warnings

import numpy

import snowglass as sg

#: Run in each locale; prints what must not depend on it.
IN_A_LOCALE = """
import locale, pathlib, sys
import numpy
import snowglass as sg
if sys.argv[1]:
    locale.setlocale(locale.LC_ALL, sys.argv[1])
    assert locale.localeconv()["decimal_point"] == ",", "not this locale"
folder = pathlib.Path(sys.argv[2])
volume = sg.Volume(folder / "a.nrrd", label_table=folder / "names.txt")
print(volume.spacing, volume.affine.tolist(), volume.info["channels"])
volume = sg.Volume(folder / "a.nrrd")
print(volume.look(), volume.look(sg.Look(scale="symlog:0.5")))
image = volume.render(size=64, zoom=1.5, range="0.5%,99.5%", legend=True)
print(image.command, image.recipe, image.checksum)
try:
    volume.render(zoom=-1.5)
except ValueError as error:
    print(error)
volume.save(folder / "b.nrrd")
print((folder / "b.nrrd").read_bytes())
"""


def block(kind=numpy.int16):
    return (numpy.arange(5 * 6 * 7) * 3 + 1).astype(kind).reshape(5, 6, 7)


def values(volume):
    return numpy.asarray(volume).astype(float) * volume.info["slope"] + \
        volume.info["intercept"]


class Arrays(unittest.TestCase):
    def right(self, source, wanted, **options):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            volume = sg.Volume(source, **options)
        numpy.testing.assert_array_equal(
            values(volume), numpy.ma.asarray(wanted, float).filled(numpy.nan))
        return volume

    def refused(self, source, says, **options):
        with self.assertRaisesRegex((TypeError, ValueError, RuntimeError), says):
            sg.Volume(source, **options)

    def test_masks_of_arrays_are_kept(self):
        masked = numpy.ma.masked_less(block(), 50)
        wide = numpy.ma.masked_less(block(numpy.float32), 50)
        cases = [masked, wide, list(masked), tuple(wide)]
        try:
            import dask.array
            parts = dask.array.from_array(block(numpy.float32), chunks=2)
            cases += [dask.array.ma.masked_less(parts, 50)]
            import xarray
            cases += [xarray.DataArray(case, dims=("z", "y", "x"))
                      for case in (masked, cases[-1])]
        except ImportError:
            pass
        for n, case in enumerate(cases):
            with self.subTest(n):
                self.right(case, masked)
                self.assertTrue(numpy.isnan(numpy.asarray(sg.Volume.channels(
                    [case, block()]).masked(block() > 0))).any())
        kept = sg.Volume(numpy.ma.masked_array(block()))
        self.assertEqual(kept.info["type"], "int16")  # nothing is masked

    def test_variables_of_netcdf_mask_and_scale_themselves(self):
        try:
            from netCDF4 import Dataset
        except ImportError:
            self.skipTest("no netCDF4")
        with tempfile.TemporaryDirectory() as folder, \
                Dataset(folder + "/a.nc", "w") as data:
            for name, size in zip("zyx", block().shape):
                data.createDimension(name, size)
            one = data.createVariable("v", "i2", ("z", "y", "x"), fill_value=1)
            one.scale_factor = 0.5
            one.set_auto_maskandscale(False)
            one[:] = block()
            one.set_auto_maskandscale(True)
            self.right(one, one[...])
            self.refused(data, r"dataset\['v'\]")

    def test_order_of_nibabel(self):
        values = numpy.asfortranarray(block())
        for part in values, values[1:4], values[..., ::2]:
            with self.assertWarnsRegex(UserWarning, "affine=image.affine"):
                sg.Volume(part)
            with warnings.catch_warnings():
                warnings.simplefilter("error")
                sg.Volume(part, axes="zyx", copy=True)
            with self.assertWarnsRegex(UserWarning, "taken for .x, y, z"):
                volume = sg.Volume(part, affine=numpy.eye(4), copy=True)
            self.assertEqual(volume.dims, part.shape)
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            sg.Volume(block(), affine=numpy.eye(4))
            sg.Volume(numpy.broadcast_to(block()[0], (5, 6, 7)), copy=True)

    def test_images_of_nibabel_without_a_matrix(self):
        try:
            import nibabel
        except ImportError:
            self.skipTest("no nibabel")
        image = nibabel.Nifti1Image(block(), None)
        image.header.set_zooms((2, 3, 4))
        self.assertEqual(sg.Volume(image).spacing, (2, 3, 4))

    def test_images_of_pillow(self):
        try:
            from PIL import Image
        except ImportError:
            self.skipTest("no Pillow")
        pages = [Image.fromarray(each) for each in block(numpy.uint8)]
        self.right(pages, block(numpy.uint8))
        with tempfile.TemporaryDirectory() as folder:
            path = folder + "/a.tif"
            pages[0].save(path, save_all=True, append_images=pages[1:])
            with Image.open(path) as image:
                self.refused(image, "of 5 frames.*path of its file")
            self.right(os.fsencode(path), block(numpy.uint8))

    def test_what_is_no_volume_is_told_what_to_do(self):
        self.refused(numpy.stack([block()] * 2), r"axes='zyx'", axes="tzyx")
        self.refused([block()[0], block()[0, :3]], "differ in shape")
        self.refused(b"no such file", "no such file")
        try:
            import pandas
            self.refused(pandas.DataFrame(block()[0]), "is a table")
        except ImportError:
            pass
        try:
            import xarray
        except ImportError:
            return
        with self.assertWarnsRegex(UserWarning, r"isel\(time=0\)"):
            sg.Volume(xarray.DataArray(block(), dims=("time", "y", "x")))

    def test_maps_of_xarray_are_one_slice_and_values_keep_their_names(self):
        try:
            import xarray
        except ImportError:
            self.skipTest("no xarray")
        times = xarray.DataArray(
            block(numpy.float32), name="tos", dims=("time", "lat", "lon"), attrs={
                "units": "K", "long_name": "sea surface temperature"}, coords={
                "lat": ("lat", numpy.arange(block().shape[1]) * 2.0 - 5, {
                    "units": "degrees_north"}),
                "lon": ("lon", numpy.arange(block().shape[2]) * 2.0, {
                    "units": "degrees_east"})})
        for part in times.isel(time=1), times.isel(time=[1]):
            with warnings.catch_warnings():
                warnings.simplefilter("error")
                volume = sg.Volume(part)
            numpy.testing.assert_array_equal(numpy.asarray(volume), block()[1:2])
            numpy.testing.assert_allclose(volume.affine[:2, 3], (0, -5))
            self.assertEqual(volume.info["quantity"], "tos")
            self.assertEqual(volume.info["value_unit"], "K")
            self.assertEqual(volume.info["description"], "sea surface temperature")
            self.assertEqual(volume._caption(), "tos (K)")
        long = sg.Volume(times.isel(time=1).rename("\u00e4" * 99))
        self.assertEqual(set(long.info["quantity"]), {"\u00e4"})
        self.assertEqual(sg.Volume(block()).info["quantity"], "")
        turned = times.rename(lat="y", lon="x").transpose("time", "x", "y")
        for part in turned.isel(time=1), turned.isel(time=[1]):
            volume = sg.Volume(part)
            numpy.testing.assert_array_equal(numpy.asarray(volume)[0], block()[1].T)
            numpy.testing.assert_allclose(volume.affine[:2, 3], (0, -5))

    @unittest.skipUnless(shutil.which("localedef") and
                         os.path.exists("/usr/share/i18n/locales/de_DE"),
                         "no locales")
    def test_a_decimal_comma_changes_nothing(self):
        with tempfile.TemporaryDirectory() as folder:
            subprocess.run(["localedef", "-i", "de_DE", "-f", "UTF-8",
                            folder + "/de_DE.UTF-8"], stderr=subprocess.DEVNULL)
            pathlib.Path(folder, "a.nrrd").write_bytes(
                b"NRRD0005\ntype: short\ndimension: 3\nsizes: 7 6 5\nendian: little\n"
                b"encoding: raw\nspace directions: (0.25,0,0) (0,1.5,0) (0,0,2.75)\n"
                b"space dimension: 3\nSegment0_LabelValue:=4\nSegment0_Name:=bone\n"
                b"Segment0_Color:=0.25 0.5 0.75\n\n" + block().tobytes())
            pathlib.Path(folder, "names.txt").write_text(
                '7 10.5 20 30 0.5 1 1 "skin"\n')
            said = [subprocess.run(
                [sys.executable, "-c", IN_A_LOCALE, name, folder], check=True,
                env={**os.environ, "LOCPATH": folder}, capture_output=True).stdout
                for name in ("", "de_DE.UTF-8")]
        self.assertIn(b"0.25", said[0])
        self.assertEqual(*said)


if __name__ == "__main__":
    unittest.main()
