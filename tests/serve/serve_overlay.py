"""Overlays in the viewer: pictures and slices are those of their commands."""
import os
import struct
import subprocess
import sys
import tempfile

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from viewer_client import (TOOL, Page, Server, check, finish, is_of_command,
                           slice_is_of_command)

FOLDER = tempfile.TemporaryDirectory()
os.chdir(FOLDER.name)
DIMS = 48, 40, 44
PLACE = ("space: right-anterior-superior\nspace directions: %s\n"
         "space origin: %s\n")


def ball(at, middle, radius):
    return sum((a - m) ** 2 for a, m in zip(at, middle)) < radius ** 2


def write_nrrd(name, dims, place, value, kind=("uint8", "B")):
    with open(name, "wb") as out:
        out.write(("NRRD0004\ntype: %s\nendian: little\ndimension: 3\n"
                   "sizes: %d %d %d\nencoding: raw\n%s\n" %
                   (kind[0], *dims, place)).encode("latin-1"))
        out.write(b"".join(struct.pack("<" + kind[1], value(x, y, z))
                           for z in range(dims[2]) for y in range(dims[1])
                           for x in range(dims[0])))


def write_npy(name, dims, value):
    text = "{'descr': '|u1', 'fortran_order': False, 'shape': (%d, %d, %d)}" % (
        dims[2], dims[1], dims[0])
    text = text.ljust(117) + "\n"
    with open(name, "wb") as out:
        out.write(b"\x93NUMPY\x01\x00" + struct.pack("<H", len(text)) +
                  text.encode())
        out.write(bytes(value(x, y, z) for z in range(dims[2])
                        for y in range(dims[1]) for x in range(dims[0])))


def density(x, y, z):
    return min(255, max(0, 260 - ((x - 24) ** 2 + (y - 20) ** 2 +
                                  (z - 22) ** 2) // 2))


def label(x, y, z):
    return ball((x, y, z), (18, 20, 22), 7) + 2 * ball((x, y, z), (32, 20, 22), 6)


HERE = PLACE % ("(1,0,0) (0,1,0) (0,0,1)", "(0,0,0)")
write_nrrd("ct.nrrd", DIMS, HERE, density)
write_nrrd("turned.nrrd", (22, 22, 22),
           PLACE % ("(2,0.2,0) (0,2,0.1) (0,0,2)", "(1,-2,0.5)") +
           "Segment0_LabelValue:=1\nSegment1_LabelValue:=2\n",
           lambda x, y, z: label(2 * x, 2 * y - 2, 2 * z))
write_npy("v.npy", DIMS, density)
write_npy("l.npy", DIMS, label)


def small_memory(limit):
    """The volume is in memory, then leaves it for its file; what drafts leave in
    memory gives way to the picture at rest."""
    server = Server("ct.nrrd", "--overlay", "turned.nrrd", "-q", "-j", "2",
                    "--memory", limit)
    page = Page(server)
    first = is_of_command(page, f"a picture in {limit}", 1, size=[120, 100])
    none = is_of_command(page, "without its overlay", 2, overlay=None)
    check("is another", none != first)
    again = is_of_command(page, "with it again", 3, overlay=True)
    check("is the first", again == first)
    page.close()
    server.stop()


def least_memory():
    """What the command needs, to 100 KiB."""
    return next(limit for limit in (f"{n}00K" for n in range(30, 200))
                if not subprocess.run(
                    [TOOL, "render", "ct.nrrd", "--overlay", "turned.nrrd", "-y",
                     "-q", "-j", "2", "--size", "120x100", "--quality", "high",
                     "--memory", limit, "-o", "least.png"],
                    capture_output=True).returncode)


def without_a_place():
    """Overlays that are known by their dims alone, in parts of the volume."""
    for base, *memory in ("v.npy",), ("ct.nrrd", "--memory", "8M"):
        server = Server(base, "--overlay", "l.npy", "-q", "-j", "2", *memory)
        page = Page(server)
        name = " ".join([base, *memory])
        is_of_command(page, name, 1, size=[64, 64])
        slice_is_of_command(page, "its slice", axis="z", index=20)
        is_of_command(page, f"{name} clipped", 2, clip=[[1, 0, 0, 30]])
        slice_is_of_command(page, "its slice", axis="z", index=20)
        slice_is_of_command(page, "and another", axis="x", index=17)
        is_of_command(page, f"{name} cropped", 3, clip=None,
                      crop=[[3, 30], [2, 40], [5, 44]])
        with_it = slice_is_of_command(page, "its slice", axis="y", index=18)
        is_of_command(page, f"{name} whole", 4, crop=None, overlay=None)
        without = slice_is_of_command(page, "its slice", axis="y", index=20)
        check("is another", with_it != without)
        page.close()
        server.stop()


def names():
    """Labels that the page lists: each by a name, or by its number alone."""
    def listed(name, place, value):
        write_nrrd(name, DIMS, HERE + place, value, ("uint16", "H"))
        server = Server("ct.nrrd", "--overlay", name, "-q")
        page = Page(server)
        labels = page.receive_text("look")["overlay"]["labels"]
        page.close()
        server.stop()
        return [[value, text] for value, text, _, _ in labels]

    found = listed("latin.nrrd", "Segment0_LabelValue:=1\nSegment0_Name:=l\xe9ver\n"
                   "Segment1_LabelValue:=2\nSegment1_Name:=lung\n", label)
    check("a name that is not UTF-8 is left out, its label is not",
          found == [[1, ""], [2, "lung"]], found)
    for count, most in (255, 255), (300, 0):
        found = listed("many.nrrd", "".join(
            f"Segment{n}_LabelValue:={n + 1}\n" for n in range(count)),
            lambda x, y, z: (x + 48 * y) % (count + 1))
        check(f"of {count} labels all are listed, or none",
              len(found) == most, len(found))


def only_values():
    """A factor is for pictures: as on the command line, it is refused."""
    server = Server("ct.nrrd", "--overlay", "turned.nrrd", "-q", "-j", "2")
    page = Page(server)
    is_of_command(page, "a picture", 1, size=[64, 60])
    page.say({"t": "set", "n": 2, "recipe": {"overlay-look": "0.5"}})
    said = page.receive_text("said")["text"]
    check("a factor is refused", '"overlay-look"' in said, said)
    is_of_command(page, "and not kept", 3, azimuth=20)
    is_of_command(page, "opacities at labels are taken", 4,
                  **{"overlay-look": "1:0.5,2:0"})
    page.close()
    server.stop()


names()
only_values()
small_memory("8M")
small_memory(least_memory())
without_a_place()
finish()
