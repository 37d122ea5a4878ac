"""Thick slices in the viewer: they are those of their commands, and hostile ones are refused."""
import os
import sys
import tempfile

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from viewer_client import Page, Server, check, finish, slice_is_of_command, write_channels
from volumes import each, nrrd, placed

FOLDER = tempfile.TemporaryDirectory()
os.chdir(FOLDER.name)


def plain():
    nrrd("a.nrrd", (20, 16, 24), each((20, 16, 24), lambda x, y, z: (x * 7 + y * 5 + z * z) % 251, "h"),
         *placed((1, 2, 3), (10, -20, 30)), kind="int16")
    server = Server("a.nrrd")
    page = Page(server)
    page.rest(1, size=[64, 64])
    one = slice_is_of_command(page, "a slice", axis="coronal", index=8)
    for slab in ("9mm", "9mm:mean", "8:min", "400mm:max", "1e300:max"):
        thick = slice_is_of_command(page, f"its slab of {slab}", axis="coronal", index=8, slab=slab)
        check(f"{slab} is another picture", thick != one)
    check("a thin slab is the slice", page.slice(
        axis="coronal", index=8, range=[0, 255], exact=True, slab="1mm")[32:] == one)
    for end in (0, 23):
        slice_is_of_command(page, f"a slab at an end, {end}", axis="axial", index=end, slab="20mm:mean")
    hostile(page)
    check("and after them there are slabs", page.slice(
        axis="axial", index=5, range=[0, 255], exact=True, slab="9mm"))
    page.close()
    server.stop()


def hostile(page):
    for slab in ("", "mm", "0mm", "-5mm", "nan", "inf", "5s", "10mm:sum", "10mm:max:max", ":max",
                 "1" * 300, "10mm" + "m" * 4000, "/etc/passwd", "5mm; rm -rf .", "\u00b5"):
        for what in ("slice", "slice-command"):
            page.question(what, axis="axial", index=5, range=[0, 255], pane=1, n=99, exact=True, slab=slab)
            said = page.receive_text("said")["text"]
            check(f"{what} of slab {slab[:20]!r} is refused in a line", said.startswith("--slab: ") or
                  "--slab" in said, said)
    for slab in (5, None, ["9mm"], {"a": 1}, True):
        shown = page.slice(axis="axial", index=5, range=[0, 255], exact=True, slab=slab)
        check(f"{slab!r} is no text, and no slab", shown is not None)


def others():
    """Channels are mixed, and a volume that has no room is read for each slab."""
    write_channels("told.zarr", True, 3)
    server = Server("told.zarr")
    page = Page(server)
    page.rest(1, size=[64, 64])
    for colored in (False, True):
        slice_is_of_command(page, f"a slab of channels, colored: {colored}", axis="z", index=11,
                            colored=colored, slab="5:max")
    page.close()
    server.stop()


plain()
others()
finish()
