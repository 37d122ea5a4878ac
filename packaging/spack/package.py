# A recipe for Spack.  In a repository of recipes it lies at
# packages/snowglass/package.py, beside repo.yaml; docs/install.md has the steps.
from spack.package import *


class Snowglass(CMakePackage):
    """Volume renderer for CPUs: CT, MR, microscopy and simulations become
    pictures and movies by sparse splatting, without a GPU or a display."""

    homepage = "https://snowglass.invalid"
    # The sources of a release; a checkout is built by `spack dev-build`.
    # url = "https://snowglass.invalid/snowglass-0.1.0.tar.gz"

    license("BSD-3-Clause")

    version("0.1.0")

    variant("mpi", default=True, description="The tool and library for MPI")
    variant("python", default=False, description="The Python package")
    variant("serve", default=False, description="The viewer in the browser")
    variant("hdf5", default=True, description="Read HDF5 and NetCDF-4")
    variant("tiff", default=True, description="Read and write TIFF")
    variant("gdcm", default=False, description="Unpack DICOM")
    variant("exr", default=False, description="Write OpenEXR")
    variant("webp", default=True, description="Write WebP")
    variant("jpeg", default=True, description="JPEG slices and pictures")
    variant("blosc", default=True, description="Read Zarr packed by Blosc")
    variant("zstd", default=True, description="Read Zarr packed by Zstandard")
    variant("lz4", default=True, description="Read Zarr packed by LZ4")
    variant("bzip2", default=True, description="Read NRRD packed by bzip2")
    variant("expat", default=True, description="Read VTI, presets of Slicer")

    depends_on("c", type="build")
    depends_on("cxx", type="build", when="+gdcm")
    depends_on("cmake@3.20:", type="build")
    depends_on("pkgconfig", type="build")
    depends_on("python@3.9:", type="build")  # manual pages, completions
    depends_on("zlib-api")
    depends_on("libpng")
    depends_on("jansson")
    depends_on("mpi", when="+mpi")
    # So that `spack load` and environments let Python find it.
    extends("python", when="+python")
    depends_on("python@3.11:", type=("build", "link", "run"), when="+python")
    depends_on("py-numpy", type="run", when="+python")
    depends_on("libwebsockets@4.1:", when="+serve")
    depends_on("libjpeg-turbo@2:", when="+serve")
    depends_on("gzip", type="build", when="+serve")
    depends_on("hdf5@1.10.3: ~mpi", when="+hdf5")
    depends_on("libtiff@4.5:", when="+tiff")
    depends_on("gdcm@3:", when="+gdcm")
    depends_on("openexr@3.1:", when="+exr")
    depends_on("libwebp@1:", when="+webp")
    depends_on("jpeg", when="+jpeg")
    depends_on("c-blosc@1.16:", when="+blosc")
    depends_on("zstd@1.3:", when="+zstd")
    depends_on("lz4@1.8:", when="+lz4")
    depends_on("bzip2", when="+bzip2")
    depends_on("expat", when="+expat")

    def cmake_args(self):
        # All parts are named: one that is not is built where the system, and
        # not Spack, has its libraries.
        args = [self.define("BUILD_TESTING", self.run_tests),
                self.define("SNOW_CATALYST", False)]
        for name in ("mpi", "python", "serve", "hdf5", "tiff", "gdcm", "exr",
                     "webp", "jpeg", "blosc", "zstd", "lz4", "bzip2",
                     "expat"):
            args.append(self.define_from_variant("SNOW_" + name.upper(), name))
        return args
