"""The Python package: pictures are those of the command line, arrays are used in
place, errors are the library's own lines, threads take turns."""
import contextlib
import gc
import itertools
import os
import signal
import subprocess
import sys
import threading
import time
import warnings

import numpy

import snowglass as sg
from beside import PICTURES, InFolder, needs, plain, quick, resident
from dicom import dicom_slice


def head(**options):
    return sg.Volume("phantom:head", dims=(64, 64, 48), **options)


def save_plotfile(path):
    """A plotfile of AMReX: level 0 has 4 x 4 x 4 cells of value 1, level 1 has
    4 x 4 x 4 of value 2 in the middle."""
    boxes = ["((0,0,0) (3,3,3) (0,0,0))", "((2,2,2) (5,5,5) (0,0,0))"]
    sides = [["0 1"] * 3, ["0.25 0.75"] * 3]
    head = ["HyperCLaw-V1.1", 1, "rho", 3, 0.0, 1, "0 0 0", "1 1 1", 2,
            boxes[0] + " ((0,0,0) (7,7,7) (0,0,0))", "0 0", "0.25 " * 3,
            "0.125 " * 3, 0, 0]
    for level, box in enumerate(boxes):
        os.makedirs(f"{path}/Level_{level}")
        with open(f"{path}/Level_{level}/Cell_D_00000", "wb") as file:
            file.write(b"FAB ((8, (64 11 52 0 1 12 0 1023)),(8, (8 7 6 5 4 3 2"
                       b" 1)))" + box.encode() + b" 1\n" +
                       numpy.full(64, 1.0 + level, "<f8").tobytes())
        cell = [1, 1, 1, 0, "(1 0", box, ")", 1, "FabOnDisk: Cell_D_00000 0",
                "", "1,1", "1,", "", "1,1", "2,"]
        with open(f"{path}/Level_{level}/Cell_H", "w", encoding="ascii") as file:
            file.write("\n".join(map(str, cell)) + "\n")
        head += [f"{level} 1 0.0", 0, *sides[level], f"Level_{level}/Cell"]
    with open(f"{path}/Header", "w", encoding="ascii") as file:
        file.write("\n".join(map(str, head)) + "\n")


class Pictures(InFolder):
    def test_they_are_those_of_the_command_line(self):
        file = "head.nrrd"
        head().save(file)
        cases = [
            ([], {}),
            (["--view", "left", "--azimuth", "30", "--quality", "high"],
             {"view": "left", "azimuth": 30, "quality": "high"}),
            (["--colormap", "viridis", "--range", "50,200", "--perspective"],
             {"look": sg.Look(cmap="viridis", clim=(50, 200)),
              "perspective": True}),
            (["-m", "mip", "--fit", "volume", "--zoom", "2"],
             {"mode": "mip", "fit": "volume", "zoom": 2}),
            (["-m", "iso", "--iso", "120", "--light", "head"],
             {"mode": "iso", "iso": 120, "light": "head"}),
            (["--opacity", "80:0,200:0.7", "--shade", "none"],
             {"look": sg.Look(opacity=[(80, 0), (200, .7)]), "shade": "none"}),
        ]
        for words, options in cases:
            with self.subTest(words):
                image = sg.Volume(file).render(size=(120, 90), **options)
                self.same_floats(image, "render", file, "-s", "120x90", *words)

    def test_sizes(self):
        for size in (24, numpy.int64(24), (24, 24), [24, numpy.int32(24)],
                     numpy.array([24, 24]), numpy.array(24)):
            self.assertEqual(head().render(size=size).shape[:2], (24, 24))
        for size in (24.5, (24,), numpy.array([24.5, 24])):
            with self.assertRaises((TypeError, ValueError)):
                head().render(size=size)

    def test_saved_pictures_have_letters_and_bars(self):
        image = head().render(size=256)
        plain = head().render(size=256, letters=False)
        legend = head().render(size=256, legend=True, letters=False)
        for n, picture in enumerate((image, plain, legend)):
            picture.save(f"{n}.png")
        for n in (0, 2):
            self.assertGreater(sg.compare(f"{n}.png", "1.png").largest, 0.5)
        self.same_picture(image, plain)
        # An eighth of the width is left to the legend.
        self.assertEqual(numpy.asarray(legend)[:, -31:, -1].max(), 0)
        self.assertGreater(numpy.asarray(plain)[:, -31:, -1].max(), 0)
        self.assertTrue(image._repr_png_().startswith(b"\x89PNG"))

    def test_arrays_of_them_are_not_copies_and_outlive_them(self):
        image = head().render(size=64)
        array = numpy.asarray(image)
        kept = array.copy()
        self.assertTrue(numpy.shares_memory(array, numpy.asarray(image)))
        del image
        gc.collect()
        head().render(size=64, azimuth=40)
        numpy.testing.assert_array_equal(array, kept)

    def test_depths(self):
        image = head().render(size=64, mode="iso", iso=120, depth=True)
        self.assertEqual(image.depth.shape, (64, 64))
        self.assertTrue(numpy.isfinite(numpy.asarray(image.depth)).any())
        self.assertIsNone(head().render(size=16).depth)

    def test_projections_are_in_data_units(self):
        array = numpy.zeros((6, 6, 6), numpy.int16)
        array[3:5, 1:3, 4:6] = 700
        volume = sg.Volume(array)
        largest = volume.project("mip", view="+z", size=60)
        self.assertEqual(largest.dtype, numpy.float32)
        self.assertAlmostEqual(float(numpy.nanmax(largest)), 700, delta=1)
        self.assertAlmostEqual(float(numpy.nanmin(largest)), 0, delta=1e-3)
        self.assertTrue(numpy.isnan(largest[0, 0]))
        row, column = numpy.unravel_index(numpy.nanargmax(largest), (60, 60))
        self.assertGreater(row, 30)  # y 1.5 of 0..5: row 0 is on top
        self.assertGreater(column, 30)
        mean = volume.project("mean", view="+z", size=60)
        self.assertAlmostEqual(float(numpy.nanmax(mean)), 700 * 2 / 5, delta=1)

    def test_turntables(self):
        head().turntable("t_%02d.png", frames=3, size=48)
        self.assertEqual(sorted(os.listdir(".")),
                         ["t_00.png", "t_01.png", "t_02.png"])
        with self.assertRaisesRegex(ValueError, "pattern such as"):
            head().turntable("t.txt", frames=3)

    def test_options(self):
        volume = head()
        for options, error, text in [
                ({"quality": "ultra"}, ValueError, "there is no 'ultra'"),
                ({"colour": 1}, TypeError, "no option 'colour'"),
                ({"size": 0}, ValueError, "0"),
                ({"look": "nope"}, ValueError, "preset 'nope' is unknown"),
                ({"view": "nope"}, ValueError, "nope"),
                ({"fit": "nope"}, ValueError, "visible or volume"),
                ({"zoom": "x"}, TypeError, "number|float"),
                ({"target": (1, 2)}, TypeError, "target must be 3 numbers"),
                ({"threads": 2 ** 40}, ValueError, "out of range")]:
            with self.subTest(options):
                with self.assertRaisesRegex(error, text):
                    volume.render(**options)
        with self.assertRaisesRegex(ValueError, "give rising|below|values"):
            volume.render(sg.Look(opacity=[(9, 0), (1, 1)]))
        for scale in ("symlog:-3", "symlog:nan", "log:3", "symlog:", "ln"):
            with self.assertRaisesRegex(ValueError, "scale: .*above 0"):
                sg.Look(scale=scale)
        with self.assertRaisesRegex(TypeError, "save\\(\\) the array"):
            sg.Volume(numpy.zeros((2, 2, 2), "u1"), label_table="a.txt")
        self.assertEqual(volume.look("rdbu_r"), volume.look("RdBu_r"))

    def test_existing_files(self):
        image = head().render(size=16)
        image.save("a.png")
        with self.assertRaisesRegex(sg.Error, "exists"):
            image.save("a.png", overwrite=False)
        with self.assertRaisesRegex(ValueError, "suffix|format|txt"):
            image.save("a.txt")


class Arrays(InFolder):
    def setUp(self):
        super().setUp()
        self.array = numpy.asarray(head()).copy()  # [z, y, x]
        self.spacing = head().spacing
        self.picture = head().render(view="left", azimuth=25, size=80)

    def as_before(self, volume, psnr=float("inf")):
        image = volume.render(view="left", azimuth=25, size=80)
        self.assertGreaterEqual(sg.compare(image, self.picture).psnr, psnr)

    def test_zyx(self):
        self.as_before(sg.Volume(self.array, spacing=self.spacing, copy=False))

    def test_any_order_of_memory_is_used_in_place(self):
        # Axes of the lattice change places: the same scene within its bound.
        turned = numpy.asfortranarray(self.array)
        self.as_before(sg.Volume(turned, axes="zyx", spacing=self.spacing,
                                 copy=False), 45)
        self.as_before(sg.Volume(numpy.ascontiguousarray(self.array.T), axes="xyz",
                            spacing=self.spacing, copy=False), 45)
        self.as_before(sg.Volume(self.array.T, axes="xyz", spacing=self.spacing,
                            copy=False))

    def test_gaps_are_copied_with_a_warning(self):
        wide = numpy.repeat(self.array, 2, axis=2)[:, :, ::2]
        with self.assertRaisesRegex(ValueError, "in place"):
            sg.Volume(wide, copy=False)
        with self.assertWarnsRegex(sg.SnowglassWarning, "copied"):
            volume = sg.Volume(wide, spacing=self.spacing)
        self.as_before(volume)
        self.as_before(sg.Volume(wide, spacing=self.spacing, copy=True))

    def test_types(self):
        for dtype in "bool int8 uint16 int32 uint64 float16 float64 >i2".split():
            with self.subTest(dtype):
                array = (self.array // 4).astype(dtype)
                volume = sg.Volume(array, copy=True)
                numpy.testing.assert_array_equal(
                    numpy.asarray(volume).astype(float), array.astype(float))
        for bad, error in [(numpy.zeros((2, 2, 2), complex), "complex"),
                           (numpy.zeros((2, 2)), "three dimensions"),
                           (numpy.zeros((2, 0, 2)), "no voxels"),
                           (7, "not int"),
                           ({"rho": 1, "p": 2}, r"such as dict\['rho'\]"),
                           (["a.tif", "b.tif"], "pattern such as"),
                           ([], "three dimensions")]:
            with self.assertRaisesRegex((TypeError, ValueError), error):
                sg.Volume(bad)
        self.assertEqual(sg.Volume(list(self.array)).shape, self.array.shape)

    def test_slope_and_intercept(self):
        volume = sg.Volume(self.array, slope=2, intercept=-1024)
        self.assertEqual(volume.statistics["min"],
                         2 * float(self.array.min()) - 1024)

    def test_the_array_outlives_its_name(self):
        volume = sg.Volume(self.array.copy(), spacing=self.spacing)
        gc.collect()
        self.as_before(volume)

    def test_masks(self):
        mask = numpy.zeros(self.array.shape, bool)
        mask[:, :, :32] = True
        volume = sg.Volume(self.array, spacing=self.spacing)
        half = volume.masked(mask)
        self.assertEqual(half.statistics["finite"], mask.sum())
        self.assertEqual(volume.masked(mask.astype(int) * 5, [4, 5])
                         .statistics["finite"], mask.sum())
        with self.assertRaisesRegex(ValueError, "must be the same"):
            volume.masked(mask[:-1])

    def each_order(self):
        """A cube of three different sides, as arrays of any order of memory
        and of axes, and what they are called."""
        cube = numpy.arange(4 * 5 * 6, dtype=numpy.int16).reshape(4, 5, 6)
        for slowest in itertools.permutations(range(3)):
            back = [slowest.index(n) for n in range(3)]
            array = cube.transpose(slowest).copy().transpose(back)
            for axes in itertools.permutations("zyx"):
                yield array, "".join(axes)

    def test_shape_and_values_are_as_given(self):
        for array, axes in self.each_order():
            with self.subTest(strides=array.strides, axes=axes):
                volume = sg.Volume(array, axes=axes, copy=False,
                                   spacing=(0.5, 1, 2), unit="mm")
                self.assertEqual(volume.shape, array.shape)
                self.assertEqual(volume.axes, axes)
                seen = numpy.asarray(volume)
                numpy.testing.assert_array_equal(seen, array)
                self.assertTrue(numpy.shares_memory(seen, array))
                self.assertEqual(volume.dims, tuple(
                    array.shape[axes.index(axis)] for axis in "xyz"))
                self.assertEqual(volume.spacing, (0.5, 1, 2))
                numpy.testing.assert_array_equal(
                    volume.affine, numpy.diag([0.5, 1, 2, 1]))
                self.assertIn("x".join(map(str, volume.dims)), str(volume))
                self.assertEqual(bytes(memoryview(volume)), array.tobytes())

    def test_masks_lie_as_the_volume_does(self):
        for array, axes in self.each_order():
            with self.subTest(strides=array.strides, axes=axes):
                volume = sg.Volume(array, axes=axes, spacing=(0.5, 1, 2))
                mask = numpy.zeros(array.shape, bool)
                mask[1:, :2, 3] = True
                for given in (mask, numpy.asfortranarray(mask),
                              sg.Volume(mask)):
                    half = volume.masked(given)
                    self.assertEqual(half.shape, array.shape)
                    self.assertEqual(half.axes, axes)
                    numpy.testing.assert_array_equal(
                        numpy.asarray(half), numpy.where(mask, array, numpy.nan))
                    self.assertEqual(half.spacing, (0.5, 1, 2))

    def test_saved_files_have_x_first(self):
        for array, axes in self.each_order():
            with self.subTest(strides=array.strides, axes=axes):
                affine = [[0, 2, 0, 5], [3, 0, 0, 6], [0, 0, 4, 7],
                          [0, 0, 0, 1]]
                volume = sg.Volume(array, axes=axes, affine=affine, slope=2)
                volume.save("a.mha")
                file = sg.Volume("a.mha")
                self.assertEqual(file.dims, volume.dims)
                numpy.testing.assert_allclose(file.affine, affine)
                numpy.testing.assert_array_equal(
                    numpy.asarray(file), array.transpose(
                        [axes.index(axis) for axis in "zyx"]))
                self.assertEqual(file.info["slope"], 2)
                sg.Volume(array, axes=axes).save("a.npy")
                numpy.testing.assert_array_equal(
                    numpy.load("a.npy"),
                    array.transpose([axes.index(axis) for axis in "zyx"]))

    def test_slices_of_any_order_are_the_same(self):
        for array, axes in self.each_order():
            plain = sg.Volume(array.transpose([axes.index(a) for a in "zyx"])
                              .copy(), spacing=(0.5, 1, 2))
            volume = sg.Volume(array, axes=axes, spacing=(0.5, 1, 2))
            for axis in ("x", "y", "z", "axial", "sagittal"):
                with self.subTest(axis, strides=array.strides, axes=axes):
                    for at in (1, None):
                        numpy.testing.assert_array_equal(
                            volume.slice_values(axis, at),
                            plain.slice_values(axis, at))

    def test_closed_volumes(self):
        volume = sg.Volume(self.array.copy())
        view = numpy.asarray(volume)
        image = volume.render(size=32)
        with self.assertRaisesRegex(BufferError, "in use"):
            volume.close()
        self.assertEqual(view[20, 30, 30], self.array[20, 30, 30])
        del view
        volume.close()
        volume.close()
        for use in (lambda: volume.render(), lambda: volume.info,
                    lambda: volume.shape, lambda: memoryview(volume),
                    lambda: volume.statistics, lambda: volume.histogram(),
                    lambda: volume.save("a.npy"),
                    lambda: volume.slice(), lambda: volume.slice_values("x"),
                    lambda: volume.look(), lambda: print(volume)):
            with self.assertRaisesRegex(ValueError, "closed"):
                use()
        image.save("a.png")

    def test_memory_grows_by_no_copy(self):
        array = numpy.zeros((256, 256, 400), numpy.uint8)  # 26 MB
        array[100:150, 100:150, 100:150] = 200
        before = resident()
        volume = sg.Volume(array, copy=False)
        numpy.asarray(volume)
        self.assertLess(resident() - before, 4 << 20)

    def test_histogram(self):
        counts, edges = sg.Volume(self.array).histogram(64, (0, 255))
        expected, places = numpy.histogram(self.array, 64, (0, 255))
        numpy.testing.assert_array_equal(counts, expected)
        numpy.testing.assert_allclose(edges, places)

    @needs("nibabel")
    def test_nibabel(self):
        import nibabel
        affine = numpy.array([[0, -1.5, 0, 9], [2, 0, 0, 8], [0, 0, 3, 7],
                              [0, 0, 0, 1.0]])
        image = nibabel.Nifti1Image(self.array.T.astype(numpy.int16), affine)
        image.to_filename("a.nii")
        by_file = sg.Volume("a.nii")
        by_image = sg.Volume(image)
        numpy.testing.assert_allclose(by_image.affine, affine)
        self.assertTrue(by_image.info["medical"])
        self.assertEqual(by_image.info["unit"], "mm")
        self.same_picture(by_file.render(size=80), by_image.render(size=80))
        self.same_picture(by_file.render(size=80),
                          sg.Volume(nibabel.load("a.nii")).render(size=80))
        image.header.set_xyzt_units("meter")
        image.header.set_slope_inter(2, -1000)
        image.to_filename("b.nii")
        by_file = sg.Volume("b.nii")
        by_image = sg.Volume(nibabel.load("b.nii"))
        # By their texts, since no NaN equals another.
        self.assertEqual(repr({**by_file.info, "format": ""}),
                         repr({**by_image.info, "format": ""}))
        self.assertEqual(by_image.info["type"], "int16")  # as it is stored
        self.same_picture(by_file.render(size=80), by_image.render(size=80))

    def test_images_whose_slices_have_slopes_of_their_own(self):
        array = self.array

        class Proxy:  # as nibabel's PARRECArrayProxy
            shape = array.T.shape

            def get_unscaled(self):
                return array.T

            def __array__(self, dtype=None):
                return array.T * numpy.float32(0.5)

        class Header:
            def get_xyzt_units(self):
                return "mm", "sec"

        class Image:
            dataobj, affine, header = Proxy(), numpy.eye(4), Header()

        numpy.testing.assert_array_equal(numpy.asarray(sg.Volume(Image())),
                                         array.T * numpy.float32(0.5))

    @needs("xarray")
    def test_xarray(self):
        import xarray
        data = xarray.DataArray(
            self.array, dims=("z", "y", "x"),
            coords={"x": ("x", numpy.arange(64) * 0.5, {"units": "um"}),
                    "y": ("y", 3 - numpy.arange(64) * 0.5, {"units": "um"}),
                    "z": ("z", numpy.arange(48) * 2.0, {"units": "um"})})
        volume = sg.Volume(data)
        self.assertEqual(volume.spacing, (0.5, 0.5, 2.0))
        self.assertEqual(volume.info["unit"], "um")
        self.assertEqual(volume.affine[1, 1], -0.5)
        data.attrs["units"] = "K"
        for options in ({"legend": True}, {"legend": "(K)", "azimuth": 0}):
            sg.Volume(data).render(size=256, **options).save(
                f"{len(options)}.png")
        self.same_picture("1.png", "2.png")
        volume.render(size=256, legend=True).save("0.png")
        self.assertGreater(sg.compare("0.png",
                                      "2.png").largest, 0.5)
        self.assertEqual(sg.Volume(data.transpose("x", "z", "y"))
                         .info["unit"], "um")

    def test_components(self):
        vectors = numpy.random.default_rng(3).normal(
            size=(6, 5, 4, 3)).astype(numpy.float32)
        numpy.save("v.npy", vectors)
        length = numpy.sqrt((vectors.astype(float) ** 2).sum(axis=3))
        for options, expected in [({"component": "y"}, vectors[..., 1]),
                                  ({"component": 2}, vectors[..., 2]),
                                  ({"channel": 0}, vectors[..., 0]),
                                  ({"channel": 1}, vectors[..., 1]),
                                  ({"component": "magnitude"}, length)]:
            with self.subTest(options):
                volume = sg.Volume("v.npy", **options)
                numpy.testing.assert_allclose(numpy.asarray(volume), expected,
                                              rtol=1e-6)
        with self.assertWarnsRegex(sg.SnowglassWarning, "magnitude of the 3"):
            sg.Volume("v.npy", channel=None)
        with self.assertRaisesRegex(ValueError, "not a component"):
            sg.Volume("v.npy", component="radius")
        with self.assertRaisesRegex(ValueError, "there is no channel 'y'"):
            sg.Volume("v.npy", channel="0:red,y:green")

    def test_gaps(self):
        os.mkdir("gap")
        for z in (0, 1, 2, 4, 5):
            with open(f"gap/{z}.dcm", "wb") as file:
                file.write(dicom_slice(z, [z] * 9, height=z))
        with self.assertRaisesRegex(sg.Error, "slices is missing"):
            sg.Volume("gap")
        with self.assertRaisesRegex(sg.Error, "slices is missing"):
            sg.Volume("gap", allow_gaps=False)
        with self.assertWarnsRegex(sg.SnowglassWarning, "1 slice is missing"):
            volume = sg.Volume("gap", allow_gaps=True)
        voxels = numpy.asarray(volume)
        self.assertEqual(voxels.shape, (6, 3, 3))
        self.assertTrue(numpy.isnan(voxels[3]).all())
        self.assertEqual(float(numpy.nansum(voxels)), 9 * (0 + 1 + 2 + 4 + 5))

    def test_suv(self):
        about = {(8, 0x60): ("CS", "PT"), (0x54, 0x1001): ("CS", "CNTS"),
                 (0x28, 0x51): ("CS", "DECY\\ATTN"),
                 (0x7053, 0x10): ("LO", "Philips PET Private Group"),
                 (0x7053, 0x1000): ("DS", "0.125")}
        with open("pet.dcm", "wb") as file:
            file.write(dicom_slice(0, range(9), height=0, about=about))
        for options, most, unit in (({}, 1, "SUVbw"), ({"suv": "bw"}, 1, "SUVbw"),
                                    ({"suv": "none"}, 8, "counts")):
            volume = sg.Volume("pet.dcm", **options)
            self.assertEqual(volume.statistics["max"], most)
            self.assertEqual(volume.info["value_unit"], unit)
            self.assertEqual(int(numpy.asarray(volume).max()), 8)
        with self.assertRaises(ValueError):
            sg.Volume("pet.dcm", suv="lean")

    def test_series(self):
        for n in (3, 5, 12):
            sg.Volume(self.array // n).save(f"r_{n:03d}.nrrd")
        steps = [(step.index, step.statistics["max"])
                 for step in sg.series("r_%03d.nrrd")]
        self.assertEqual(steps, [(n, float(self.array.max() // n))
                                 for n in (3, 5, 12)])
        with self.assertRaises(FileNotFoundError):
            next(sg.series("none_%d.nrrd"))
        self.assertEqual(list(sg.series([])), [])

    def test_a_series_holds_one_step(self):
        for n in range(4):
            sg.Volume(self.array + n).save(f"r_{n}.nrrd")
        seen, kept = [], []
        for step in sg.series("r_%d.nrrd"):
            kept.append(numpy.asarray(step)[0, 0, :4] if step.index == 1
                        else None)
            seen.append(step)
        self.assertEqual(kept[1].tolist(), (self.array[0, 0, :4] + 1).tolist())
        self.assertEqual(seen[3].shape, self.array.shape)
        self.assertEqual(seen[1].shape, self.array.shape)  # kept by the array
        for n in (0, 2):
            with self.assertRaisesRegex(ValueError, "closed"):
                seen[n].shape

    @plain
    def test_memory_of_a_series(self):
        voxels = numpy.zeros(32 << 20, numpy.uint8)
        for n in range(3):
            voxels.tofile(f"v_{n}.raw")
        code = f"""if True:
            import re, snowglass as sg
            most = lambda: int(re.search(r"VmHWM:\\s*(\\d+)", open(
                "/proc/self/status").read()).group(1))
            before = most()
            for step in sg.series({"v_%d.raw"!r}, dims=(256, 256, 512),
                                  type="uint8"):
                assert step.statistics["max"] == 0
            print((most() - before) / 1024)"""
        said = subprocess.run([sys.executable, "-c", code], check=True,
                              capture_output=True, text=True).stdout
        self.assertLess(float(said), 48)  # MB; two steps are 64

    @needs("nibabel")
    def test_time_steps_of_one_file(self):
        import nibabel
        array = numpy.arange(3 * 4 * 5 * 3, dtype=numpy.int16)
        image = nibabel.Nifti1Image(array.reshape(5, 4, 3, 3), numpy.eye(4))
        image.to_filename("t.nii")
        self.assertEqual([step.index for step in sg.series("t.nii")],
                         [0, 1, 2])  # and warns of no other steps
        steps = list(sg.series("t.nii", time=2))
        numpy.testing.assert_array_equal(
            numpy.asarray(steps[0]).T, array.reshape(5, 4, 3, 3)[..., 2])
        with self.assertWarnsRegex(sg.SnowglassWarning, "time"):
            sg.Volume("t.nii")


class Calls(InFolder):
    def test_levels(self):
        path = "plt"
        save_plotfile(path)
        warnings.simplefilter("ignore")  # several levels on one grid
        for levels, side, highest in ((0, 8, 2), (1, 4, 1), (2, 8, 2)):
            volume = sg.Volume(path, levels=levels)
            self.assertEqual(volume.shape, (side,) * 3)
            self.assertEqual(numpy.asarray(volume).max(), highest)
        for levels in (-1, -40, -2 ** 63):
            with self.assertRaisesRegex(ValueError, "number of levels; give"):
                sg.Volume(path, levels=levels)

    def test_threads_take_turns(self):
        volume = head()
        expected = {n: numpy.asarray(volume.render(size=64, azimuth=n)).copy()
                    for n in range(0, 40, 10)}
        failed = []

        def work():
            try:
                for n, pixels in expected.items():
                    image = volume.render(size=64, azimuth=n)
                    if not numpy.array_equal(numpy.asarray(image), pixels):
                        failed.append(n)
            except BaseException as error:  # whatever it is, the test fails
                failed.append(error)

        threads = [threading.Thread(target=work) for _ in range(4)]
        for each in threads:
            each.start()
        for each in threads:
            each.join()
        self.assertEqual(failed, [])

    def test_progress_is_reported_and_may_end_the_call(self):
        class Enough(Exception):
            pass

        def enough(stage, fraction):
            raise Enough(stage)

        volume = head()
        with self.assertRaises(Enough):
            volume.render(size=2048, method="raycast", progress=enough)
        seen = []
        volume.render(size=100, method="raycast", progress=lambda *each:
                      seen.append(each))
        self.assertEqual(seen[-1], ("render", 1.0))
        self.assertEqual(sorted(each[1] for each in seen if
                                each[0] == "render"),
                         [each[1] for each in seen if each[0] == "render"])
        with self.assertRaisesRegex(RuntimeError, "in use"):
            volume.render(size=100, method="raycast",
                          progress=lambda *_: volume.render())
        volume.render(size=16)

    @quick
    def test_interrupt(self):
        volume = sg.Volume("phantom:head")
        timer = threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT))
        timer.start()
        with self.assertRaises(KeyboardInterrupt):
            volume.render(size=4096, method="raycast", quality="high")
        took = time.perf_counter()
        timer.join()
        self.assertLess(time.perf_counter() - took, 0.5)
        volume.render(size=16)

    @quick
    def test_interrupt_of_a_thread_that_waits(self):
        volume = head()
        busy = threading.Event()

        def stay(stage, fraction):
            busy.set()
            if enough.wait(0.1):
                raise TimeoutError

        def work():
            with contextlib.suppress(TimeoutError):
                volume.render(size=2000, method="raycast", progress=stay)

        enough = threading.Event()
        worker = threading.Thread(target=work)
        worker.start()
        self.assertTrue(busy.wait(20))
        timer = threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT))
        timer.start()
        with self.assertRaises(KeyboardInterrupt):
            volume.render(size=16)
        alive = worker.is_alive()
        enough.set()
        worker.join()
        self.assertTrue(alive)  # it was interrupted, and not served
        volume.render(size=16)

    def test_text_that_is_not_utf8(self):
        with self.assertRaisesRegex(sg.Error, "caf.*cannot be opened"):
            sg.Volume(os.fsdecode(b"caf\xe9.nrrd"))
        with self.assertRaisesRegex(sg.Error, "caf"):
            sg.Image.load(os.fsdecode(b"caf\xe9.png"))
        name = os.fsdecode(os.fsencode("") + b"caf\xe9.")
        head().save(name + "nrrd").render(size=16).save(name + "png")
        self.assertEqual(sg.Volume(name + "nrrd").dims, (64, 64, 48))
        self.assertEqual(sg.Image.load(name + "png").width, 16)
        with open("u.nrrd", "wb") as file:
            file.write(b"NRRD0004\ntype: uint8\ndimension: 3\nsizes: 2 2 2\n"
                       b"space dimension: 3\nspace units: \"\xb5m\" \"\xb5m\" "
                       b"\"\xb5m\"\nspace directions: (1,0,0) (0,1,0) (0,0,1)\n"
                       b"encoding: raw\n\n" + bytes(range(8)))
        self.assertTrue(sg.Volume("u.nrrd").info["unit"])
        array = numpy.zeros((2, 2, 2), numpy.uint8)
        self.assertEqual(sg.Volume(array, unit="µ" * 9).info["unit"], "µ" * 7)

    @plain
    def test_a_picture_that_warns_is_not_kept(self):
        head().render(size=1024, letters=False).save("a.png")
        with open("a.png", "ab") as file:
            file.write(b"more")
        with self.assertRaisesRegex(sg.SnowglassWarning, "after"):
            sg.Image.load("a.png")
        held = []
        for _ in range(2):  # malloc keeps what the first eight leave, of 16 MB each
            for _ in range(8):
                with self.assertRaises(sg.SnowglassWarning):
                    sg.Image.load("a.png")
            held.append(resident())
        self.assertLess(held[1] - held[0], 32 << 20)

    def test_errors(self):
        with self.assertRaisesRegex(sg.Error, "nope.nrrd: cannot be opened"):
            sg.Volume("nope.nrrd")
        try:
            sg.Volume("nope.nrrd")
        except sg.Error as error:
            self.assertEqual(error.status, 3)
        with self.assertRaisesRegex(ValueError, "phantom"):
            sg.Volume("phantom:nope")
        with self.assertRaises(MemoryError):
            sg.Volume("phantom:head", memory=1 << 20)
        with self.assertRaises(TypeError):
            sg.Image()

    def test_warnings(self):
        with self.assertWarnsRegex(sg.SnowglassWarning, "Hounsfield"):
            head().render("ct-bone", size=16)
        warnings.simplefilter("error")
        with self.assertRaisesRegex(sg.SnowglassWarning, "Hounsfield"):
            head().render("ct-bone", size=16)

    @plain
    def test_memory_stays_flat(self):
        volume = head()

        def draw(n):
            volume.render("mr-default", size=96, azimuth=n, depth=True)
            volume.slice("xyz"[n % 3], n % 40)
            sg.Volume(numpy.zeros((20, 20, 20), numpy.int16)).info

        for n in range(0, 360, 8):  # all that is kept for each side
            draw(n)
        before = resident()
        for n in range(PICTURES):
            draw(n)
        self.assertLess(resident() - before, 1 << 20)

    def test_import_is_quick_and_leaves_numpy_out(self):
        code = "import snowglass, sys; assert 'numpy' not in sys.modules"
        subprocess.run([sys.executable, "-c", code], check=True)

    @plain
    def test_a_call_adds_little(self):
        volume = head()  # with a look that counts no voxels
        look = sg.Look(range=(0, 200), cmap="grey", opacity=[(0, 0), (200, 1)])
        times = []
        for n in range(40):
            begin = time.perf_counter()
            image = volume.render(look, size=64, azimuth=10, fit="volume")
            times.append(time.perf_counter() - begin - image.stats["seconds"])
        self.assertLess(min(times), 0.002)  # 0.2 ms on a quiet machine
