"""The transfer function of the page: counts of a part of the values and the range of each
channel against numpy, maps the other way round, and looks that are saved to a file and
opened again, by a page and by the tool."""
import array
import json
import os
import shlex
import sys
import tempfile

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from viewer_client import Page, Server, check, finish, run_command, skip, viewer
from volumes import nrrd

try:
    import numpy
except ImportError:
    skip("there is no numpy")

FOLDER = tempfile.TemporaryDirectory()
os.chdir(FOLDER.name)
SIZE = 20, 18, 16
OF_LOOK = ("preset", "colormap", "opacity", "range", "scale", "shade", "gradient-opacity", "material", "channel")
FORM = (*SIZE[::-1],)


def volume(name, seed):
    """A bright ball on a quiet ground, whole numbers."""
    z, y, x = numpy.indices(FORM)
    far = numpy.sqrt((x - 10) ** 2 + (y - 9) ** 2 + (z - 8) ** 2)
    noise = numpy.random.default_rng(seed).integers(0, 40, FORM)
    voxels = (numpy.maximum(0, 7 - far) * 300 + noise - 100).astype("<i2")
    nrrd(name, SIZE, array.array("h", voxels.ravel().tolist()).tobytes(), kind="int16")
    return voxels


def look_of(page, n, **recipe):
    """The look of the picture at rest after a change."""
    page.set(n, **recipe)
    look = None
    while True:
        what, message = page.hear()
        if what == "closed":
            return None
        if what == "picture":
            page.say({"t": "ack", "n": int.from_bytes(message[4:8], "little")})
            if look and message[8] == 2 and int.from_bytes(message[4:8], "little") == n:
                return look
        elif message["t"] == "look":
            look = message


# --- counts -----------------------------------------------------------------------


def counts_agree(name, answer, voxels, low, high):
    wanted, _ = numpy.histogram(voxels[(voxels >= low) & (voxels <= high)], 256, (low, high))
    check(name, answer["lo"] == low and answer["hi"] == high and
          sum(answer["counts"]) == wanted.sum() and
          numpy.abs(numpy.cumsum(answer["counts"]) - numpy.cumsum(wanted)).max() <=
          numpy.unique(voxels, return_counts=True)[1].max(), [answer, wanted.tolist()])


def parts_are_counted():
    """Also where two pages look at two parts by turns."""
    voxels = volume("counted.nrrd", 1)
    server = Server("counted.nrrd")
    pages = [Page(server), Page(server)]
    for page in pages:
        page.rest(1, size=[64, 64])
    whole = pages[0].ask("histogram")
    counts_agree("all values are counted", whole, voxels, int(voxels.min()), int(voxels.max()))
    for page, low, high in (pages[0], -80.5, 20.25), (pages[1], 300, 301):
        page.question("histogram", lo=low, hi=high)
    for page, low, high in (pages[0], -80.5, 20.25), (pages[1], 300, 301):
        part = page.receive_text("histogram")
        check(f"of {low} to {high} as many as numpy finds", sum(part["counts"]) ==
              int(((voxels >= low) & (voxels <= high)).sum()), part)
    counts_agree("all are still known", pages[0].ask("histogram"), voxels, whole["lo"], whole["hi"])
    for wrong in {"lo": 5, "hi": 5}, {"lo": 7, "hi": 3}, {"lo": -1e308, "hi": 1e308}:
        pages[0].question("histogram", **wrong)
    check("an empty part is not answered", pages[0].ask("value", at=[1, 2, 3])["value"] ==
          int(voxels[3, 2, 1]))
    for page in pages:
        page.close()
    server.stop()


# --- channels ---------------------------------------------------------------------


def write_zarr(name, voxels):
    """Channels without ranges, whose names say that they are of emitted light."""
    os.makedirs(f"{name}/0")
    axes = [{"name": "c", "type": "channel"}] + [
        {"name": axis, "type": "space", "unit": "micrometer"} for axis in "zyx"]
    scale = [{"type": "scale", "scale": [1, 1, 1, 1]}]
    channels = [{"label": label, "color": color, "active": True}
                for label, color in (("DAPI", "0000ff"), ("GFP", "00ff00"))]
    for path, tree in ((".zgroup", {"zarr_format": 2}), (".zattrs", {
            "multiscales": [{"version": "0.4", "axes": axes, "datasets": [
                {"path": "0", "coordinateTransformations": scale}]}],
            "omero": {"channels": channels}}), ("0/.zarray", {
                "zarr_format": 2, "shape": voxels.shape, "chunks": voxels.shape,
                "dtype": "<u2", "compressor": None, "fill_value": 0, "order": "C",
                "filters": None})):
        with open(f"{name}/{path}", "w") as out:
            json.dump(tree, out)
    voxels.astype("<u2").tofile(f"{name}/0/0.0.0.0")


def channels_have_their_own():
    """The ground is a normal distribution: the range begins three deviations above its
    mean, and ends at percentile 99.9 of what is above that."""
    rng = numpy.random.default_rng(5)
    grounds = (100, 10, 500), (240, 20, 900)
    voxels = numpy.stack([numpy.rint(numpy.where(rng.random(FORM) < 0.1, rng.uniform(
        mean + 100, top, FORM), rng.normal(mean, wide, FORM))) for mean, wide, top in grounds])
    write_zarr("light.zarr", voxels)
    with viewer("light.zarr") as page:
        first = look_of(page, 1, size=[64, 64])["channels"]
        for one, each, (mean, wide, top) in zip(first, voxels, grounds):
            high = numpy.percentile(each[each > one[4]], 99.9)
            check(f"the range of {one[1]} is numpy's", abs(one[4] - mean - 3 * wide) <=
                  0.03 * top and abs(one[5] - high) <= 2, [one, mean + 3 * wide, high])
        told = look_of(page, 2, channel="0:blue:300..400:1,1:green:10..20:0.5")["channels"]
        check("one is chosen", told[0][4:] == [300, 400, 1], told)
        told = look_of(page, 3, channel="0:blue:1,1:green:10..20:0.5")["channels"]
        check("it has its own again, alone", told[0][4:6] == first[0][4:6] and
              told[1][4:] == [10, 20, 0.5], [told, first])
        own_look("of channels", page, 4, "light.zarr", {"mode": "mip"})


# --- the other way round ----------------------------------------------------------


def far_apart(looks):
    """How far colours of the second are from those of the first the other way round."""
    a, b = (each["strip"] for each in looks)
    return max(abs(int(one[k:k + 2], 16) - int(other[k:k + 2], 16))
               for one, other in zip(a, b[::-1]) for k in (1, 3, 5)) if a != b else 256


def colors_turn():
    """The colour at t is that of 1 - t."""
    volume("plain.nrrd", 2)
    with viewer("plain.nrrd") as page:
        look_of(page, 1, size=[64, 64], range=[0, 1000])
        for n, name in enumerate(("viridis", "cividis", "tab10", "RdBu"), 1):
            strips = [look_of(page, 10 * n + i, colormap=name + end)
                      for i, end in enumerate(("", "_r"))]
            check(f"{name} turns, and is named", far_apart(strips) <= 1 and
                  [each["map"] for each in strips] == [name, f"{name}_r"], strips)
        for n, preset in enumerate(("ct-bone", "ct-chest-contrast-enhanced", "signed"), 500):
            strips = [look_of(page, 2 * n + i, preset=preset, range=None, opacity=None,
                              colormap=map)
                      for i, map in enumerate((None, "reversed"))]
            check(f"the colours of {preset} turn", far_apart(strips) <= 1, strips)


# --- looks in files -----------------------------------------------------------------


def bare(command, look):
    """The picture of a command with a file in the place of what it says of the look."""
    words = shlex.split(command)
    for key in OF_LOOK:
        while f"--{key}" in words:
            at = words.index(f"--{key}")
            del words[at:at + 2]
    return run_command(shlex.join([*words, "--config", "look.json"]))


def own_look(name, page, n, path, camera):
    """Its file brings back the bytes of the picture: to the page after another look, to
    another viewer, and to the tool."""
    camera = {"size": [120, 100], "zoom": 1, "fit": "volume", "target": None, **camera}
    shown = page.rest(n, **camera)
    text = page.ask("look-file")["text"]
    look = json.loads(text)
    keys = {key: value for key, value in look.items() if key != "version"}
    check(f"{name}: a look and nothing else", not {"input", "verb", "zoom", "azimuth",
          "size", "mode"} & set(look) and keys, look)
    with open("look.json", "w") as out:
        out.write(text)
    nothing = dict.fromkeys(OF_LOOK[:-1])
    other = page.rest(n + 1, **{**nothing, **({"colormap": "plasma"} if "channel" not in keys else
                                              {"channel": "1"})})
    check("another look is another picture", other != shown)
    again = page.rest(n + 2, **{**nothing, **keys})
    check(f"{name}: opened again it is the same picture", again == shown, look)
    with viewer(path, "--config", "look.json") as fresh:
        check(f"{name}: a viewer that begins with it too",
              fresh.rest(1, **camera) == shown, look)
    check(f"{name}: and the tool", bare(page.ask("command")["text"], look) == shown, look)
    return keys


def looks_are_files():
    volume("head.nrrd", 3)
    with viewer("head.nrrd") as page:
        keys = own_look("automatic", page, 1, "head.nrrd", {})
        check("what was chosen is in numbers", {"range", "opacity"} <= set(keys), keys)
        page.set(10, **{**dict.fromkeys(OF_LOOK), "preset": "ct-bone"})
        keys = own_look("a preset", page, 11, "head.nrrd", {})
        check("a preset stays one", keys.get("preset") == "ct-bone" and "range" not in keys, keys)
        page.set(20, material=None, preset=None, colormap="inferno", opacity=[[0, 0], [900, 0.7]],
                 range=[50, 1100], shade="none", **{"gradient-opacity": [[0, 0.2], [90, 1]]})
        own_look("one of one's own", page, 21, "head.nrrd", {})
        page.set(31, colormap="reversed", preset="ct-soft", opacity=None, range=None,
                 shade=None, **{"gradient-opacity": None})
        own_look("turned", page, 32, "head.nrrd", {})
        page.set(40, **dict.fromkeys(OF_LOOK))
        own_look("a projection", page, 41, "head.nrrd", {"mode": "mip"})


# --- thumbnails, and what a file is -------------------------------------------------


def thumbnails_have_colors():
    volume("small.nrrd", 4)
    with viewer("small.nrrd") as page:
        page.rest(1, size=[64, 64])
        made = []
        for asked in ({}, {"colormap": "hot"}, {"colormap": "hot", "mode": "mip"}):
            page.question("thumbnail", preset="", pane=9, **asked)
            made.append(page.receive_small(9)[32:])
        check("thumbnails differ by colours and mode", len(set(made)) == 3)
        for wrong in {"colormap": "hotter"}, {"colormap": 7}, {"colormap": ["hot"]}:
            page.question("thumbnail", preset="", pane=9, **wrong)
        page.question("thumbnail", preset="", pane=9, mode=[1])
        check("wrong ones are not made", page.receive_small(9)[32:] == made[0])


def pet_is_in_suv():
    try:
        import pydicom
        from pydicom.uid import ExplicitVRLittleEndian, generate_uid
    except ImportError:
        print("skip   PET: there is no pydicom")
        return
    os.mkdir("pet")
    series = generate_uid()
    rising = numpy.linspace(0, 4000, 12 * 10 * 8).reshape(8, 10, 12).astype("<u2")
    for k, plane in enumerate(rising):
        each = pydicom.Dataset()
        each.file_meta = pydicom.dataset.FileMetaDataset()
        each.file_meta.TransferSyntaxUID = ExplicitVRLittleEndian
        each.file_meta.MediaStorageSOPClassUID = each.SOPClassUID = "1.2.840.10008.5.1.4.1.1.128"
        each.file_meta.MediaStorageSOPInstanceUID = each.SOPInstanceUID = generate_uid()
        each.Modality, each.Units, each.SUVType = "PT", "GML", "BW"
        each.CorrectedImage = ["ATTN", "DECY"]
        each.SeriesInstanceUID = each.StudyInstanceUID = series
        each.Rows, each.Columns = plane.shape
        each.PixelSpacing, each.SliceThickness = [4, 4], 4
        each.ImageOrientationPatient = [1, 0, 0, 0, 1, 0]
        each.ImagePositionPatient, each.InstanceNumber = [0, 0, 4 * k], k + 1
        each.SamplesPerPixel, each.PhotometricInterpretation = 1, "MONOCHROME2"
        each.BitsAllocated = each.BitsStored = 16
        each.HighBit, each.PixelRepresentation = 15, 0
        each.RescaleSlope, each.RescaleIntercept = "0.005", "0"
        each.PixelData = plane.tobytes()
        each.is_little_endian, each.is_implicit_VR = True, False
        each.save_as(f"pet/{k}.dcm", write_like_original=False)
    with viewer("pet") as page:
        info = page.receive_text("info")
        check("the file says what its values are", info["modality"] == "PT" and
              info["value_unit"] == "SUVbw", info)
        look = look_of(page, 1, size=[64, 64])
        check("dark on white, to 7", look["map"] == "grey_r" and
              [look["low"], look["high"]] == [0, 7], look)
        counts = page.ask("histogram")
        check("its values are SUV", counts["lo"] == 0 and abs(counts["hi"] - 20) < 1e-9, counts)
        own_look("PET", page, 2, "pet", {})


for test in (parts_are_counted, channels_have_their_own, colors_turn, looks_are_files,
             thumbnails_have_colors, pet_is_in_suv):
    test()
finish()
