"""What --fit frames: the pixels that a look shows fill the picture but for 4 %
at each edge, in one view, in perspective, and in all frames of a turntable;
what is fainter than 0.02 and specks count not; pictures of files that are read
in slabs are the same."""
import glob

import oracle
from oracle import np

oracle.need("PIL")
from PIL import Image

SIDE = 200
MARGIN = 0.04 * SIDE
# A voxel's look reaches up to half a voxel beyond its box, half a pixel here.
SLACK = 2.5


def scene():
    """Two blocks off the middle of an uneven grid, one of them brighter."""
    voxels = np.zeros((70, 90, 80), np.uint8)
    voxels[10:30, 20:32, 50:72] = 200
    voxels[40:44, 60:84, 12:20] = 120
    np.save("a.npy", voxels)


def draw(*options, out="b.npy", verb="render", status=0):
    done = oracle.tool(verb, "-q", "a.npy", "-y", "-o", out, "-s",
                       f"{SIDE}x{SIDE}", "--no-labels", "--opacity",
                       "0:0,99:0,100:1", "--spacing", "1x1.2x0.9", *options)
    if done.returncode != status:
        oracle.fail(" ".join(options), f"exit {done.returncode}: {done.stderr.strip()}")
        return np.zeros((SIDE, SIDE, 4))
    return np.load(out) if out == "b.npy" else None


def edges(picture):
    """Free pixels at the left, right, top and bottom; alpha above 1/2."""
    rows, columns = np.nonzero(picture[..., -1] > 0.5)
    if not rows.size:
        return [SIDE] * 4
    height, width = picture.shape[:2]
    return [columns.min(), width - 1 - columns.max(), rows.min(),
            height - 1 - rows.max()]


def expect(name, free, tight=True):
    """All of it is in the frame, and some of it reaches the margin."""
    oracle.checked += 1
    if min(free) < MARGIN - SLACK:
        oracle.fail(name, f"leaves {free}, not {MARGIN} pixels")
    if tight and min(free) > MARGIN + SLACK:
        oracle.fail(name, f"leaves {free}: it could be larger")


def same(name, a, b):
    oracle.checked += 1
    if not np.array_equal(a, b):
        oracle.fail(name, "is another picture")


scene()
for view in ("+z", "-x", "iso"):
    for turn in ((), ("--azimuth", "33", "--elevation", "-20", "--roll", "10")):
        free = edges(draw("--view", view, *turn))
        expect(f"{view} {turn}", free)
        if abs(free[0] - free[1]) > SLACK or abs(free[2] - free[3]) > SLACK:
            oracle.fail(f"{view} {turn}", f"{free} is not in the middle")
        free = edges(draw("--view", view, *turn, "--perspective", "50"))
        expect(f"{view} {turn} in perspective", free)
expect("a surface", edges(draw("--mode", "iso", "--iso", "60")))
expect("a surface of less",
       edges(draw("--mode", "iso", "--iso", "150")))
# Projections show the box.
expect("a projection", edges(draw("--mode", "mip", "--view", "iso")))
# Nothing to be seen: the box, too.
draw("--opacity", "0:0,250:0,251:1", status=7)
# Zoom multiplies.
near, far = edges(draw()), edges(draw("--zoom", "0.5"))
oracle.checked += 1
if abs(SIDE / 2 - min(far) - (SIDE / 2 - min(near)) / 2) > 1:
    oracle.fail("--zoom 0.5", f"{near} became {far}")
# A camera placed by the user frames by itself.
same("--target", draw("--target", "40,40,40"),
     draw("--target", "40,40,40", "--fit", "volume"))
# One scale for all frames of a turn.
for way in ((), ("--perspective",)):
    draw("--frames", "8", *way, out="f_%02d.npy", verb="turntable")
    free = [edges(np.load(name)) for name in sorted(glob.glob("f_*.npy"))]
    expect(f"a turn {way}", np.min(free, axis=0).tolist())

def scattered(specks, veil):
    """A block, so many voxels apart from it, and a veil in all of the grid."""
    voxels = np.full((70, 90, 80), veil, np.uint8)
    voxels[12:50, 20:60, 30:70] = 200
    for n in range(specks):
        voxels[58 + 5 * (n % 3), 2 + 6 * (n % 14), 3 + n * 11 % 76] = 200
    np.save("a.npy", voxels)


def block_edges(*options):
    """Of the lines that a block fills."""
    picture = draw(*VEIL, "--spacing", "1x1x1", *options)
    for axis in (0, 1):
        few = (picture[..., -1] > 0.5).sum(1 - axis) < 25
        picture = np.where(few[:, None, None] if axis == 0 else
                           few[None, :, None], 0, picture)
    return edges(picture)


# The block has an edge of opacity 1; 90 voxels of veil are 0.009.  What frames
# it is known to a block of two voxels, of 5 pixels each.
VEIL = ("--opacity", "0:0,9:0,10:0.0001,99:0.0001,100:1")
for way in (("--view", "+x"), ("--view", "-y", "--perspective", "5")):
    scattered(0, 0)
    alone = block_edges(*way)
    for specks, veil in ((12, 0), (0, 10), (12, 10)):
        scattered(specks, veil)
        free = block_edges(*way)
        oracle.checked += 1
        if np.abs(np.subtract(free, alone)).max() > 11:
            oracle.fail(f"{specks} specks, veil {veil}, {way}",
                        f"leaves {free}, not {alone}")
# A thousandth of the object is no speck.
scattered(0, 0)
voxels = np.load("a.npy")
voxels[66:70, 80:84, 2:6] = 200
np.save("a.npy", voxels)
expect("a small part", edges(draw("--view", "-y")))
# Nor are points, if there is nothing else.
voxels[:] = 0
voxels[::23, ::29, ::26] = 200
np.save("a.npy", voxels)
expect("points", edges(draw("--view", "-y", "--kernel", "bspline")))
scattered(40, 10)
# A larger volume stays in its file.
np.save("a.npy", np.load("a.npy").repeat(3, 0).repeat(3, 1).repeat(3, 2))
for way in ((), ("--perspective",)):
    whole = draw("--view", "iso", *way)
    same(f"in slabs {way}", whole,
         draw("--view", "iso", *way, "--memory", "8M"))
    same(f"by one thread {way}", whole, draw("--view", "iso", *way, "-j", "1"))
# A box is clear of the lines of text above it.
def written(*options):
    draw("--background", "none", *options, out="b.png")
    with Image.open("b.png") as picture:
        return np.asarray(picture.convert("RGBA"))


SIDE = 300
np.save("a.npy", np.full((40, 40, 40), 200, np.uint8))
for box in ("outline", "axes"):
    for lines in (("--title",), ("--annotate", "step", "--title")):
        one, other = (written("--spacing", "1x1x1", "--box", box, *lines, title)
                      for title in ("Run", "Gq."))
        text = np.nonzero((one != other).any(axis=(1, 2)))[0]
        top = np.nonzero(one[:, int(0.7 * SIDE), 3])[0][0]
        oracle.checked += 1
        if not text.size or text.max() >= top:
            oracle.fail(f"{box} {lines}", f"text in rows {text}, box at {top}")
oracle.finish()
