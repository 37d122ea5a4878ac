"""Overlays in the viewer: pictures and slices are those of their commands."""
import os
import subprocess
import sys
import tempfile

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from viewer_client import (TOOL, check, finish, is_of_command, slice_is_of_command,
                           viewer)
from volumes import each, labels, npy, nrrd

FOLDER = tempfile.TemporaryDirectory()
os.chdir(FOLDER.name)
DIMS = 48, 40, 44
RAS = "space: right-anterior-superior"
HERE = RAS, "space directions: (1,0,0) (0,1,0) (0,0,1)", "space origin: (0,0,0)"


def ball(at, middle, radius):
    return sum((a - m) ** 2 for a, m in zip(at, middle)) < radius ** 2


def density(x, y, z):
    return min(255, max(0, 260 - ((x - 24) ** 2 + (y - 20) ** 2 +
                                  (z - 22) ** 2) // 2))


def label(x, y, z):
    return ball((x, y, z), (18, 20, 22), 7) + 2 * ball((x, y, z), (32, 20, 22), 6)


nrrd("ct.nrrd", DIMS, each(DIMS, density), *HERE)
nrrd("turned.nrrd", (22, 22, 22), each(
    (22, 22, 22), lambda x, y, z: label(2 * x, 2 * y - 2, 2 * z)),
     RAS, "space directions: (2,0.2,0) (0,2,0.1) (0,0,2)", "space origin: (1,-2,0.5)",
     *labels(1, 2))
for name, value in ("v.npy", density), ("l.npy", label):
    npy(name, "|u1", DIMS[::-1], each(DIMS, value))


def small_memory(limit):
    """The volume is in memory, then leaves it for its file; what drafts leave in
    memory gives way to the picture at rest."""
    with viewer("ct.nrrd", "--overlay", "turned.nrrd", "-q", "-j", "2", "--memory",
                limit) as page:
        first = is_of_command(page, f"a picture in {limit}", 1, size=[120, 100])
        none = is_of_command(page, "without its overlay", 2, overlay=None)
        check("is another", none != first)
        again = is_of_command(page, "with it again", 3, overlay=True)
        check("is the first", again == first)


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
        with viewer(base, "--overlay", "l.npy", "-q", "-j", "2", *memory) as page:
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


def names():
    """Labels that the page lists: each by a name, or by its number alone."""
    def listed(names, value):
        nrrd("named.nrrd", DIMS, each(DIMS, value, "H"), *HERE, *labels(*names),
             kind="uint16")
        with viewer("ct.nrrd", "--overlay", "named.nrrd", "-q") as page:
            found = page.receive_text("look")["overlay"]["labels"]
        return [[value, text] for value, text, _, _ in found]

    found = listed([(1, "l\udce9ver"), (2, "lung")], label)
    check("a name that is not UTF-8 is left out, its label is not",
          found == [[1, ""], [2, "lung"]], found)
    for count, most in (255, 255), (300, 0):
        found = listed(range(1, count + 1), lambda x, y, z: (x + 48 * y) % (count + 1))
        check(f"of {count} labels all are listed, or none",
              len(found) == most, len(found))


def only_values():
    """A factor is for pictures: as on the command line, it is refused."""
    with viewer("ct.nrrd", "--overlay", "turned.nrrd", "-q", "-j", "2") as page:
        is_of_command(page, "a picture", 1, size=[64, 60])
        page.set(2, overlay_look="0.5")
        said = page.receive_text("said")["text"]
        check("a factor is refused", '"overlay-look"' in said, said)
        is_of_command(page, "and not kept", 3, azimuth=20)
        is_of_command(page, "opacities at labels are taken", 4,
                      overlay_look="1:0.5,2:0")


names()
only_values()
small_memory("8M")
small_memory(least_memory())
without_a_place()
finish()
