"""Pictures of image stacks beside NumPy's own maximum projection of them: with
no view given, rows go down, columns to the right, and slice 0 is in front."""
import json
import os

import oracle
from oracle import np

tifffile, _ = oracle.need("tifffile", "PIL")
from PIL import Image
oracle.need_modules()

# The box's diagonal is 50 voxels, so that a pixel of 50 x 50 is one voxel.
SHAPE, SIDE = (18, 24, 40), 50
RENDER = ("render", "-q", "-s", f"{SIDE}x{SIDE}", "-y", "--fit", "volume", "-c",
          "grey", "--range", "0,255", "--no-labels", "-o", "a.npy")


def picture(path, *options):
    """Grey of the pixels that the volume covers, 0 to 255."""
    done = oracle.tool(*RENDER, path, *options)
    if done.returncode:
        oracle.fail(path, done.stderr.strip())
        return np.zeros(SHAPE[1:])
    down, right = ((SIDE - size) // 2 for size in SHAPE[1:])
    grey = np.load("a.npy")[..., 0] * 255
    return grey[down:SIDE - down, right:SIDE - right]


def letter():
    """An F of bright voxels in noise, nearer at its left: no symmetry."""
    voxels = np.random.default_rng(3).integers(1, 90, SHAPE).astype("u1")
    voxels[2:5, 3:21, 6:10] = 250
    voxels[6:9, 3:7, 10:30] = 220
    voxels[9:12, 11:14, 10:22] = 190
    return voxels


def check(path, voxels):
    oracle.checked += 1
    seen, wanted = picture(path, "--mode", "mip"), voxels.max(axis=0)
    worst = np.abs(seen - wanted).max()
    if worst > 0.01:
        oracle.fail(path, f"a pixel differs by {worst:.3g} of 255; correlation"
                    f" {np.corrcoef(seen.ravel(), wanted.ravel())[0, 1]:.3f}")
    # Opaque voxels hide those behind them: slice 0 is what is seen.
    front = picture(path, "--mode", "over", "--opacity", "0:1,255:1",
                    "--shade", "none")
    nearer = np.abs(front - voxels[0]).mean(), np.abs(front - voxels[-1]).mean()
    if not nearer[0] < nearer[1]:
        oracle.fail(path, "slice 0 is not in front")


def zarr(path, voxels):
    """An OME-Zarr image of one chunk, not packed."""
    os.makedirs(f"{path}/0/0/0")
    axes = [{"name": name, "type": "space"} for name in "zyx"]
    scale = [{"type": "scale", "scale": [1, 1, 1]}]
    files = {".zgroup": {"zarr_format": 2}, ".zattrs": {"multiscales": [{
        "version": "0.4", "axes": axes, "datasets": [
            {"path": "0", "coordinateTransformations": scale}]}]},
        "0/.zarray": {"zarr_format": 2, "shape": SHAPE, "chunks": SHAPE,
                      "dtype": "|u1", "order": "C", "compressor": None,
                      "filters": None, "fill_value": 0,
                      "dimension_separator": "/"}}
    for name, text in files.items():
        oracle.put(f"{path}/{name}", json.dumps(text))
    voxels.tofile(f"{path}/0/0/0/0")


voxels = letter()
tifffile.imwrite("pages.tif", voxels, photometric="minisblack")
tifffile.imwrite("imagej.tif", voxels, imagej=True,
                 metadata={"axes": "ZYX", "spacing": 1, "unit": "um"})
tifffile.imwrite("x.ome.tif", voxels, photometric="minisblack",
                 metadata={"axes": "ZYX"})
for kind in ("tif", "png"):
    os.mkdir(kind)
    for z, page in enumerate(voxels):
        Image.fromarray(page).save(f"{kind}/{z:03}.{kind}")
zarr("x.ome.zarr", voxels)
for path in ("pages.tif", "imagej.tif", "x.ome.tif", "tif", "png",
             "x.ome.zarr"):
    check(path, voxels)
if oracle.library("libjpeg"):
    os.mkdir("jpg")
    for z, page in enumerate(voxels):
        Image.fromarray(page).save(f"jpg/{z:03}.jpg")
    # What was written is not what is read, but close to it.
    check("jpg", np.stack([np.asarray(Image.open(f"jpg/{z:03}.jpg"))
                           for z in range(len(voxels))]))
# An image is the mask of a grid with a place and the other way round.
oracle.put("placed.nrrd", oracle.nrrd(
           "uint8", (40, 24, 18), "space dimension: 3\nspace origin: (5,6,7)\n"
           "space directions: (1,0,0) (0,1,0) (0,0,1)\n", voxels.tobytes()))
for pair in (("placed.nrrd", "pages.tif"), ("pages.tif", "placed.nrrd")):
    for box in ((), ("--crop", "1:9,2:9,3:9")):
        oracle.told(pair[0], "--mask", pair[1], *box)
oracle.finish()
