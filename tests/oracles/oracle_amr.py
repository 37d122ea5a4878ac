"""Levels of refinement, each with an analytic field at the centres of its cells:
plotfiles of AMReX, written here by the published format and read by VTK too, and
.vth as VTK writes them; FLASH, Athena++ and VTKHDF by h5py.  Cells below finer ones hold 1e30, which must not be
seen."""
import functools
import os
import re
import shutil

import oracle
from oracle import np

vtk, h5py = oracle.need("vtk", "h5py")
oracle.need_modules()
from vtk.util.numpy_support import numpy_to_vtk, vtk_to_numpy

COVERED = 1e30
BITS = {4: "(8, (32 8 23 0 1 9 0 127)),(4, ", 8: "(8, (64 11 52 0 1 12 0 1023)),(8, "}


def hill(x, y, z):
    """A hill on waves, in a world of 0 to 1."""
    return (np.exp(-((x - .55)**2 + (y - .45)**2 + (z - .6)**2) / .02) +
            0.2 * np.sin(5 * x + 3 * y - 4 * z))


def plane(x, y, z):
    return 9 + 2 * x - y + 0.5 * z


class Grid:
    """Boxes of cells, (first, last), on levels; `ratios` from each to the
    next."""

    def __init__(self, cells, ratios, boxes, low=(0, 0, 0), high=(1, 1, 1)):
        self.cells, self.boxes = np.array(cells), boxes
        self.low, self.high = np.array(low, float), np.array(high, float)
        self.ratios = [np.array(r) * np.ones(len(cells), int) for r in ratios]
        self.all = [self.cells]
        for ratio in self.ratios:
            self.all.append(self.all[-1] * ratio)
        self.steps = [(self.high - self.low) / cells for cells in self.all]

    def centres(self, level, first, last):
        axes = [self.low[i] + (np.arange(first[i], last[i] + 1) + 0.5) *
                self.steps[level][i] for i in range(len(first))]
        return np.meshgrid(*axes[::-1], indexing="ij")[::-1]

    def values(self, field, level, first, last, covered=COVERED):
        v = np.array(field(*self.centres(level, first, last)), float)
        if level + 1 < len(self.boxes):
            ratio = self.ratios[level]
            for low, high in self.boxes[level + 1]:
                low = -(-np.array(low) // ratio) - np.array(first)
                high = (np.array(high) + 1) // ratio - np.array(first)
                v[tuple(slice(max(a, 0), max(b, 0))
                        for a, b in zip(low[::-1], high[::-1]))] = covered
        return v

    @functools.lru_cache(4)
    def finest(self, field):
        return field(*self.centres(len(self.boxes) - 1, 0 * self.cells,
                                   self.all[-1] - 1))


def box_text(first, last):
    return "(({}) ({}) ({}))".format(*(",".join(map(str, v)) for v in
                                       (first, last, [0] * len(first))))


def rows(values):
    """Extremes as Cell_H has them: boxes and components, then a row each."""
    return ["", f"{len(values)},{len(values[0])}",
            *("".join(f"{v:.17e}," for v in row) for row in values)]


def plotfile(path, grid, fields, kind="<f8", time=0.25, ghosts=0, shift=0,
             version=1):
    """Writes a plotfile, whose domain begins at cell `shift` of level 0."""
    dim, levels = len(grid.cells), len(grid.boxes)
    bytes_each = np.dtype(kind).itemsize
    order = range(1, bytes_each + 1)
    order = order if kind[0] == ">" else reversed(order)
    bits = f"({BITS[bytes_each]}({' '.join(map(str, order))})))"
    move = [shift * (cells // grid.cells) for cells in grid.all]
    shutil.rmtree(path, ignore_errors=True)
    head = ["HyperCLaw-V1.1", len(fields), *fields, dim, time, levels - 1,
            " ".join(map(repr, map(float, grid.low))),
            " ".join(map(repr, map(float, grid.high))),
            " ".join(str(r.max()) for r in grid.ratios),
            " ".join(box_text(m, m + n - 1)
                     for m, n in zip(move, grid.all)),
            "0 " * levels,
            *(" ".join(map(repr, map(float, h))) for h in grid.steps), 0, 0]
    for level, boxes in enumerate(grid.boxes):
        os.makedirs(f"{path}/Level_{level}")
        head += [f"{level} {len(boxes)} {time}", 0]
        cell = [version, 1, len(fields), ghosts, f"({len(boxes)} 0"]
        places, extremes = [], []
        for number, (first, last) in enumerate(boxes):
            name = f"Cell_D_{number % 2:05d}"
            first, last = np.array(first), np.array(last)
            head += [f"{grid.low[i] + first[i] * grid.steps[level][i]} "
                     f"{grid.low[i] + (last[i] + 1) * grid.steps[level][i]}"
                     for i in range(dim)]
            cell.append(box_text(first + move[level], last + move[level]))
            with open(f"{path}/Level_{level}/{name}", "ab") as file:
                places.append(f"FabOnDisk: {name} {file.tell()}")
                around = box_text(first + move[level] - ghosts,
                                  last + move[level] + ghosts)
                if version == 1:
                    file.write(f"FAB {bits}{around} {len(fields)}\n".encode())
                extremes.append([])
                for field in fields.values():
                    v = grid.values(field, level, first, last)
                    extremes[-1].append((np.nanmin(v), np.nanmax(v)))
                    v = np.pad(v, ghosts, constant_values=COVERED)
                    file.write(v.astype(kind).tobytes())
        cell += [")", len(boxes), *places]
        extremes = np.array(extremes)
        if version in (1, 3):
            cell += [*rows(extremes[..., 0]), *rows(extremes[..., 1]), ""]
        if version == 4:
            cell += ["", *("".join(f"{v}," for v in row) for row in
                           (extremes[..., 0].min(0), extremes[..., 1].max(0)))]
        if version > 1:
            cell += ["", bits]
        oracle.put(f"{path}/Level_{level}/Cell_H",
                   "\n".join(map(str, cell)) + "\n")
        head.append(f"Level_{level}/Cell")
    oracle.put(f"{path}/Header", "\n".join(map(str, head)) + "\n")


def vth(path, grid, field, kind="f4", old=False):
    """Writes a .vth by VTK, with cells blanked as it does."""
    amr = vtk.vtkOverlappingAMR()
    amr.Initialize(len(grid.boxes), [len(boxes) for boxes in grid.boxes])
    amr.SetOrigin(grid.low)
    amr.SetGridDescription(8) # XYZ
    for level, boxes in enumerate(grid.boxes):
        amr.SetSpacing(level, grid.steps[level])
        for number, (first, last) in enumerate(boxes):
            block = vtk.vtkUniformGrid()
            block.SetOrigin(grid.low + np.array(first) * grid.steps[level])
            block.SetSpacing(grid.steps[level])
            block.SetDimensions(*(b - a + 2 for a, b in zip(first, last)))
            v = grid.values(field, level, first, last)
            array = numpy_to_vtk(v.astype(kind).ravel(), deep=1)
            array.SetName("rho")
            block.GetCellData().AddArray(array)
            amr.SetAMRBox(level, number, vtk.vtkAMRBox(first, last))
            amr.SetDataSet(level, number, block)
        if level < len(grid.ratios):
            amr.SetRefinementRatio(level, int(grid.ratios[level][0]))
    vtk.vtkAMRUtilities.BlankCells(amr)
    writer = vtk.vtkXMLUniformGridAMRWriter()
    writer.SetFileName(path)
    writer.SetInputData(amr)
    assert writer.Write()
    if old:
        oracle.put(path, oracle.got(path).replace(b"vtkOverlappingAMR",
                                                  b"vtkHierarchicalBoxDataSet"))


def check(path, grid, field, most, mean, options=(), name=None):
    """Voxels differ from the field by no more; a box is the same as in the
    whole, to the bit, and so is its place."""
    if not oracle.by_chance():
        return None
    name = name or path
    voxels, matrix = oracle.converted(path, options)
    if voxels is None:
        return None
    shape = tuple(grid.all[-1][::-1])
    if voxels.shape != shape:
        oracle.fail(name, f"shape {voxels.shape}, not {shape}")
        return None
    if not np.allclose(matrix[:, 3], grid.low + grid.steps[-1] / 2) or \
            not np.allclose(matrix[:, :3], np.diag(grid.steps[-1])):
        oracle.fail(name, f"matrix {matrix}")
    wrong = np.abs(voxels - grid.finest(field))
    if not (wrong.max() <= most and wrong.mean() <= mean):
        oracle.fail(name, f"differs by {wrong.max()}, {wrong.mean()} on "
                    "average")
    first = [n // 3 for n in grid.all[-1]]
    last = [min(n // 3 + 7, n) for n in grid.all[-1]]
    box = ",".join(f"{a}:{b}" for a, b in zip(first, last))
    part, _ = oracle.converted(path, [*options, "--crop", box])
    if not np.array_equal(part, voxels[tuple(slice(a, b) for a, b in zip(
            first[::-1], last[::-1]))], equal_nan=True):
        oracle.fail(name, "a box has other values than the whole")
    return voxels


def picture(name, *options):
    done = oracle.tool(name, "-q", "-y", "-o", "p.npy", "--size", "300x300",
                       "--fit", "volume", *options)
    if done.returncode:
        oracle.fail(name, done.stderr.strip())
        return np.zeros((1, 1, 4))
    return np.load("p.npy")


@functools.lru_cache(None)
def even(grid, field):
    """The field on the finest even grid, by VTK."""
    path = f"even_{even.cache_info().currsize}.vti"
    header = vtk.vtkImageData()
    header.SetDimensions(*map(int, grid.all[-1]))
    header.SetSpacing(grid.steps[-1])
    header.SetOrigin(grid.low + grid.steps[-1] / 2)
    array = numpy_to_vtk(grid.finest(field).astype("f4").ravel(), deep=1)
    array.SetName("rho")
    header.GetPointData().SetScalars(array)
    writer = vtk.vtkXMLImageDataWriter()
    writer.SetFileName(path)
    writer.SetInputData(header)
    assert writer.Write()
    return path


@functools.lru_cache(None)
def even_picture(grid, field, *options):
    return picture(even(grid, field), *options)


OBLIQUE = ("--azimuth", "30", "--elevation", "20")


def compare(path, grid, field, *options, views=(OBLIQUE,)):
    """At most one pixel in a hundred differs by more than 2 of 255 from the
    field on the finest even grid.  Sanitizers see how these are drawn in other
    tests."""
    if oracle.SANITIZED:
        return
    oracle.checked += 1
    for view in views:
        a = picture(path, *options, *view)
        b = even_picture(grid, field, *options, *view)
        share = (np.abs(a - b).max(axis=-1) > 2 / 255).mean()
        seen = (b[..., 3] > 0.1).mean()
        if not share <= 0.01 or not seen > 0.05:
            oracle.fail(path, f"{share:.2%} of pixels differ, {seen:.0%} are "
                        f"seen, {options} {view}")


def split(first, last, cut, axis=0):
    middle, after = list(last), list(first)
    middle[axis], after[axis] = cut - 1, cut
    return [(tuple(first), tuple(middle)), (tuple(after), tuple(last))]


LOOK = ("--colormap", "inferno", "--range", "0.2,1.2")
# Three levels, 2 and 2; boxes split oddly; fine ones at the side of the grid.
TWO = Grid((32, 32, 32), (2, 2),
           [split((0, 0, 0), (31, 31, 31), 13),
            split((18, 14, 20), (51, 43, 55), 31, 2) + [((0, 0, 0), (11, 9, 7))],
            split((48, 38, 56), (91, 75, 99), 57, 1)])
# 4 to 1, on cells that are not cubes, in another place of the world.
FOUR = Grid((24, 20, 28), (4,),
            [[((0, 0, 0), (23, 19, 27))], split((36, 20, 44), (75, 51, 91), 50)],
            (0, 0, 0), (1, 1, 1))
FLAT = Grid((24, 20, 28), ((2, 1, 4),),
            [[((0, 0, 0), (23, 19, 27))], [((8, 5, 20), (29, 14, 79))]],
            (-1, 2, 5), (2, 4, 6))

for kind in ("<f4", ">f4", "<f8", ">f8"):
    plotfile("plt", FLAT, {"hill": hill, "rho": plane}, kind)
    check("plt", FLAT, plane, 1e-5, 2e-6, ["--component", "rho"], kind)
plotfile("plt", TWO, {"plane": plane, "rho": hill})
check("plt", TWO, hill, 0.03, 2e-4, ["--component", "1"])
check("plt/Header", TWO, hill, 0.03, 2e-4, ["--dataset", "rho"])
check("plt", TWO, plane, 1e-12, 1e-12)
oracle.tells("plt", ["--channel", 1], format="amrex", time_value=0.25,
             quantity="rho", storage="3 levels, ratios 2, 2, boxes 2, 3, 2",
             components=2, component_names=["plane", "rho"], channels=None)
oracle.refuse("plt", "the plotfile has plane, rho", ["--component", "p"], 2)
oracle.refuse("plt", "component 2 does not exist", ["--channel", 2], 2)
oracle.refuse("plt", "component -1 does not exist", ["--component", -1], 2)
oracle.refuse("plt", "name the same", ["--component", "rho", "--channel", 1], 2)
done = oracle.tool("info", "plt", "--component", "rho")
if not re.search(r"components +2 \(these values: component rho\)\n +0  plane\n"
                 r" +1  rho\n", done.stdout):
    oracle.fail("plt", f"info prints {done.stdout}")
done = oracle.tool("plt", "-y", "-o", "p.png", "-s", "9x9")
if "is taken, the first of plane, rho" not in done.stderr or \
        "channel" in done.stderr:
    oracle.fail("plt", f"render says {done.stderr}")
plotfile("plt", TWO, {"rho": hill}, ghosts=2, shift=-5)
check("plt", TWO, hill, 0.03, 2e-4, name="ghosts")
check("plt", TWO, hill, 0.03, 2e-4, ["--component", "RHO"], "letters")
oracle.refuse("plt", "there is no component RHO", ["--dataset", "RHO"], 2)
compare("plt", TWO, hill, *LOOK, views=(OBLIQUE, ()))
compare("plt", TWO, hill, "--mode", "mip", *LOOK)
# In slabs, in less memory than the grid has bytes, the pixels are the same.
WHOLE = ("--colormap", "inferno")
for path, options in oracle.few((("plt", ()), ("a.vth", ("--mode", "mip"))), 1):
    if path == "a.vth":
        vth(path, TWO, hill)
    oracle.checked += 1
    whole = picture(path, *WHOLE, *options)
    slabs = picture(path, *WHOLE, *options, "--memory", "15M")
    if not np.array_equal(whole, slabs) or whole[..., 3].max() < 0.5:
        oracle.fail(path, "in slabs it is another picture")
vth("a.vth", TWO, hill)
check("a.vth", TWO, hill, 0.03, 2e-4)
compare("a.vth", TWO, hill, *LOOK)
vth("b.vth", TWO, plane, "f8", True)
check("b.vth", TWO, plane, 1e-12, 1e-12)

plotfile("plt", FOUR, {"rho": hill}, "<f4")
check("plt", FOUR, hill, 0.05, 5e-4, name="4:1")
compare("plt", FOUR, hill, *LOOK)
vth("a.vth", FOUR, hill, "f8")
check("a.vth", FOUR, hill, 0.05, 5e-4, name="4:1 vth")
plotfile("plt", FLAT, {"rho": plane})
check("plt", FLAT, plane, 1e-12, 1e-12, name="flat")
compare("plt", FLAT, plane, "--range", "4,14")

# Without the finest levels: as if the file had none.
UPPER = Grid((32, 32, 32), (2,), TWO.boxes[:2])
BASE = Grid((32, 32, 32), (), TWO.boxes[:1])
for name, write in (("plt", lambda grid: plotfile("plt", grid, {"rho": plane})),
                    ("l.vth", lambda grid: vth("l.vth", grid, plane, "f8"))):
    for levels, grid in ((1, BASE), (2, UPPER)):
        write(grid)
        wanted, _ = oracle.converted(name)
        # All cells of what finer ones would cover have values here.
        whole = Grid(TWO.cells, (2, 2), TWO.boxes)
        whole.values = lambda field, level, first, last, covered=0: np.array(
            field(*whole.centres(level, first, last)), float)
        write(whole)
        found = check(name, grid, plane, 1e-12, 1e-12, ["--levels", levels])
        if found is not None and not np.array_equal(found, wanted):
            oracle.fail(name, f"has other voxels with --levels {levels}")
    oracle.tells(name, ["--levels", 9], dims=[128, 128, 128])
oracle.put("l.pvd", '<VTKFile type="Collection"><Collection><DataSet '
           'timestep="0" file="l.vth"/></Collection></VTKFile>')
oracle.tells("l.pvd", ["--levels", 1], dims=[32, 32, 32])
oracle.refuse(even(TWO, hill), "have no levels of refinement", ["--levels", 1], 2)

# VTK reads what is written here as it was meant.
plotfile("plt", TWO, {"plane": plane, "rho": hill})
reader = vtk.vtkAMReXGridReader()
reader.SetFileName("plt")
reader.UpdateInformation()
reader.SetMaxLevel(2)
reader.SetCellArrayStatus("rho", 1)
reader.Update()
amr = reader.GetOutput()
for level, boxes in enumerate(TWO.boxes):
    for number, (first, last) in enumerate(boxes):
        oracle.checked += 1
        block = amr.GetDataSet(level, number)
        v = vtk_to_numpy(block.GetCellData().GetArray("rho"))
        if not np.array_equal(v, TWO.values(hill, level, first, last).ravel()):
            oracle.fail("plt", f"VTK reads box {number} of level {level} "
                        "differently")

# Places without cells, missing values, and axes that are not there.
GAP = Grid((16, 16, 16), (2,), [[((0, 0, 0), (15, 15, 7))],
                                [((8, 8, 4), (15, 15, 11))]])
plotfile("plt", GAP, {"rho": plane})
voxels, _ = oracle.converted("plt")
if not (np.isnan(voxels[16:]).all() and np.isfinite(voxels[:16]).all()):
    oracle.fail("gap", "is not missing, or more than it is")
HOLES = lambda x, y, z: np.where(np.hypot(x - .5, y - .5) < .2, np.nan,
                                 plane(x, y, z))
plotfile("plt", TWO, {"rho": HOLES})
voxels, _ = oracle.converted("plt")
wanted = TWO.finest(plane)
if not np.abs(voxels - wanted)[np.isfinite(voxels)].max() < 0.05 or not \
        0.1 < np.isnan(voxels).mean() < 0.14:
    oracle.fail("holes", f"are {np.isnan(voxels).mean():.0%} of the voxels")
STEP = lambda x, y, z: np.where(x + 0.3 * y + 0.2 * z < .7, 1e-6, 1.)
plotfile("plt", TWO, {"rho": STEP})
voxels, _ = oracle.converted("plt")
if not (voxels.min() >= 1e-6 and voxels.max() <= 1):
    oracle.fail("step", f"reaches from {voxels.min()} to {voxels.max()}")
SHEET = Grid((32, 24), (2,), [[((0, 0), (31, 23))], [((16, 8), (39, 31))]],
             (0, 0), (4, 3))
plotfile("plt", SHEET, {"rho": lambda x, y: 2 * x - y + 5})
voxels, _ = oracle.converted("plt")
if voxels.shape != (1, 48, 64) or not np.allclose(
        voxels[0], SHEET.finest(lambda x, y: 2 * x - y + 5)):
    oracle.fail("sheet", "is not the field")

# Steps in folders.
for step in range(3):
    plotfile(f"plt{step:05d}", GAP,
             {"rho": lambda x, y, z: plane(x, y, z) + step}, time=step / 4)
oracle.tells("plt%05d", ["--time", "0.5"], time_value=0.5)
done = oracle.tool("movie", "-q", "-y", "plt%05d", "-o",
                       "f_%d.png", "--size", "64x64")
if done.returncode or not os.path.exists("f_2.png"):
    oracle.fail("movie", done.stderr.strip())

# Steps at any distance are taken where each has its time (amr.plot_per).
for step in (37, 71):
    plotfile(f"per{step:05d}", GAP, {"rho": plane}, time=step / 8)
plotfile("per00000", GAP, {"rho": plane}, time=0)
for name, prefix in (("per%05d", "i"), ("per*", "j")):
    done = oracle.tool("movie", "-q", "-y", name, "-o", prefix + "_%d.png",
                       "--size", "64x64")
    if done.returncode or not os.path.exists(prefix + "_2.png"):
        oracle.fail(name, done.stderr.strip())
plotfile("per00071", GAP, {"rho": plane}, time=37 / 8)
done = oracle.tool("movie", "per%05d", "-o", "k_%d.png")
if "per00034: this step of per%05d is missing" not in done.stderr:
    oracle.fail("per%05d", done.stderr.strip())

# FABs without headers: of versions 2 to 4 of Cell_H.
for version, kind in ((2, ">f4"), (3, "<f8"), (4, "<f4")):
    plotfile("plt", FLAT, {"hill": hill, "rho": plane}, kind, ghosts=1,
             version=version)
    check("plt", FLAT, plane, 1e-5, 2e-6, ["--component", "rho"],
          f"version {version}")

# A block that lost bytes, where the offsets are those of what is left, and so
# reads the next one; one with other values than its extremes, which mean nothing
# beside NaN; one that ends with its file.
LINE = Grid((16, 8, 8), (), [split((0, 0, 0), (15, 7, 7), 8)])
DATA = "plt/Level_0/Cell_D_00000"
for version, kind in ((1, "<f8"), (3, ">f4")):
    plotfile("plt", LINE, {"rho": plane, "one": plane}, kind, version=version)
    cells = [oracle.got(f"{DATA[:-1]}{i}") for i in (0, 1)]
    text = oracle.got("plt/Level_0/Cell_H")
    both = text.replace(b"Cell_D_00001 0", b"Cell_D_00000 %d")
    for lost in (0, 1, 512):
        left = len(cells[0]) - lost
        oracle.put("plt/Level_0/Cell_H", both % left)
        oracle.put(DATA, cells[0][:left] + cells[1])
        for component in ("0", "1"):
            if lost:
                oracle.refuse("plt", "the next box begins before",
                              ["--component", component])
            else:
                check("plt", LINE, plane, 2e-6, 1e-6,
                      ["--component", component], "one file")
    oracle.put("plt/Level_0/Cell_H", text)
    width = np.dtype(kind).itemsize
    half = len(cells[0]) - 512 * width
    for value, fits in ((7, False), (9.5, True)):
        value = np.array([value], kind).tobytes()
        broken = cells[0][:half - width] + value + cells[0][half:]
        oracle.put(DATA, broken)
        if fits:
            oracle.tells("plt", format="amrex")
            continue
        for crop in (":,:,:", "7:8,7:8,7:8"):
            oracle.refuse("plt", "where its Cell_H has", ["--crop", crop])
        for crop in ("8:,:,:", ":,:,0:7"):
            oracle.tells("plt", ["--crop", crop], format="amrex")
        oracle.tells("plt", ["--component", "one"], quantity="one")
        nan = np.array([np.nan], kind).tobytes()
        at = half - 512 * width
        oracle.put(DATA, broken[:at] + nan + broken[at + width:])
        oracle.tells("plt", ["--crop", "7:8,7:8,7:8"], dims=[1, 1, 1])
    oracle.put(DATA, cells[0][:-1])
    oracle.refuse("plt", "truncated")
    oracle.put(DATA, cells[0])
    oracle.put("plt/Level_0/Cell_H", text[:text.rindex(b"2,2")])
    if version == 1:
        oracle.tells("plt", format="amrex")
    oracle.put("plt/Level_0/Cell_H", text[:text.rindex(b"2,2") + 9])
    oracle.refuse("plt", "ends before the extremes of boxes")

# Blocks of FLASH and Athena++, which halve each other's cells, in any order.
class Tree:
    """Leaves and their parents, (level, (i, j, k)), refined around a place."""

    def __init__(self, base, cells, levels, low, high, seed=1):
        self.cells = np.array(cells)
        base = np.array(base)
        halves = [2 if n > 1 else 1 for n in base * cells]
        self.grid = Grid(base * cells, (halves,) * (levels - 1), [[]] * levels,
                         low, high)
        self.leaves, self.parents = [], []
        todo = [(0, at) for at in np.ndindex(*base)]
        for level, at in todo:
            middle = (np.array(at) + .5) / (base * np.array(halves)**level)
            near = np.abs(middle - (.4, .55, .6))[:sum(h > 1 for h in halves)]
            if level + 1 < levels and near.max() < .35 / 2**level:
                self.parents.append((level, at))
                todo += [(level + 1, tuple(np.array(at) * halves + half))
                         for half in np.ndindex(*halves)]
            else:
                self.leaves.append((level, at))
        np.random.default_rng(seed).shuffle(self.leaves)

    def values(self, field, level, at, ghosts=0):
        first = np.array(at) * self.cells
        v = np.array(field(*self.grid.centres(
            level, first, first + self.cells - 1)), float)
        wide = [ghosts if n > 1 else 0 for n in self.grid.cells[::-1]]
        return np.pad(v, [(g, g) for g in wide], constant_values=COVERED)

    def faces(self, level, at, axis, ghosts=0):
        g = ghosts if self.grid.cells[axis] > 1 else 0
        step = self.grid.steps[level][axis]
        first = at[axis] * self.cells[axis]
        return self.grid.low[axis] + step * np.arange(
            first - g, first + self.cells[axis] + g + 1)


def pairs(file, name, kind, values):
    kind = np.dtype([("name", "S80"), ("value", kind)])
    file[name] = np.array([(k.ljust(80).encode(), v) for k, v in values], kind)


def flash(path, tree, fields, geometry="cartesian", kind="f8", axes=3,
          leaves=None):
    """Parents have values that must not be seen."""
    leaves = tree.leaves if leaves is None else leaves
    blocks = tree.parents[:1] + leaves + tree.parents[1:]
    leaf = [False] * bool(tree.parents) + [True] * len(leaves)
    leaf += [False] * (len(blocks) - len(leaf))
    with h5py.File(path, "w") as file:
        box = np.array([[tree.faces(level, at, i)[[0, -1]] for i in range(axes)]
                        for level, at in blocks])
        file["bounding box"], file["block size"] = box, box[..., 1] - box[..., 0]
        file["coordinates"] = box.mean(2)
        file["refine level"] = np.array([n + 1 for n, _ in blocks], "i4")
        file["node type"] = np.where(leaf, 1, 2).astype("i4")
        file["gid"] = np.zeros((len(blocks), 15), "i4")
        file["unknown names"] = np.array([[name] for name in fields], "S4")
        for name, field in fields.items():
            file[name] = np.array([
                tree.values(field, *block) if is_leaf else
                np.full(tree.cells[::-1], COVERED)
                for block, is_leaf in zip(blocks, leaf)]).astype(kind)
        pairs(file, "real scalars", "f8", [("dt", 0.1), ("time", 2.5)])
        pairs(file, "real runtime parameters", "f8",
              [(axis + end, side[i]) for i, axis in enumerate("xyz")
               for end, side in (("min", tree.grid.low), ("max", tree.grid.high))
               if i < len(side)])
        pairs(file, "string runtime parameters", "S80",
              [("basenm", b"run_"), ("geometry", geometry.ljust(80).encode())])


def athena(path, tree, fields, ghosts=0, kind="f4", coordinates="cartesian",
           leaves=None, bend=0):
    leaves = tree.leaves if leaves is None else leaves
    with h5py.File(path, "w") as file:
        file.attrs.update(
            Coordinates=np.bytes_(coordinates), Time=0.75, NumCycles=3,
            MaxLevel=np.int32(2), NumMeshBlocks=np.int32(len(leaves)),
            RootGridSize=tree.grid.cells.astype("i4"),
            MeshBlockSize=(tree.cells + 2 * ghosts).astype("i4"),
            DatasetNames=np.array(["prim", "B"], "S21"),
            NumVariables=np.array([len(fields), 1], "i4"),
            VariableNames=np.array([*fields, "Bcc1"], "S21"))
        prim = [[tree.values(f, *block, ghosts) for block in leaves]
                for f in fields.values()]
        file["prim"] = np.array(prim).astype(kind)
        file["B"] = -np.array(prim[:1]).astype(kind)
        file["Levels"] = np.array([n for n, _ in leaves], "i4")
        file["LogicalLocations"] = np.array([at for _, at in leaves], "i8")
        for i in range(3):
            x = np.array([tree.faces(*block, i, ghosts) for block in leaves])
            file[f"x{i + 1}f"] = (x + bend * (x - tree.grid.low[i])**2).astype(kind)


DEEP = Tree((2, 3, 2), (4, 6, 8), 3, (-1, 2, 5), (2, 4, 6))
PLANE = Tree((3, 2, 1), (6, 4, 1), 3, (-1, 2, 0), (2, 4, 1))
UNIFORM = Tree((3, 2, 2), (4, 6, 8), 1, (-1, 2, 5), (2, 4, 6))
for tree in (DEEP, UNIFORM):
    flash("f_0001", tree, {"dens": plane, "temp": hill})
    check("f_0001", tree.grid, plane, 1e-12, 1e-12, name="FLASH")
    check("f_0001:/dens", tree.grid, plane, 1e-12, 1e-12, name="FLASH /dens")
    athena("a.athdf", tree, {"rho": hill, "press": plane}, 2, "f8")
    check("a.athdf", tree.grid, plane, 1e-12, 1e-12, ["--dataset", "press"])
    check("a.athdf", tree.grid, lambda x, y, z: -hill(x, y, z), .3, .05,
          ["--dataset", "Bcc1"])
    athena("a.athdf", tree, {"rho": hill, "press": plane})
    for options in (["--dataset", "prim", "--channel", 1], ["--channel", 1]):
        check("a.athdf", tree.grid, plane, 1e-5, 1e-6, options, "Athena++")
oracle.tells("a.athdf", time_value=0.75, quantity="rho", storage="1 level, boxes 12")
UNIT = Tree((4, 4, 4), (8, 8, 8), 3, (0, 0, 0), (1, 1, 1))
flash("f_0001", UNIT, {"dens": hill}, kind="f4")
oracle.tells("f_0001", time_value=2.5, quantity="dens", type="float32")
compare("f_0001", UNIT.grid, hill, *LOOK)
# Fewer levels: their cells are means of the leaves in them.
flash("f_0001", DEEP, {"dens": plane})
athena("a.athdf", DEEP, {"rho": plane}, 1, "f8")
for levels in (1, 2):
    few = Grid(DEEP.grid.cells, DEEP.grid.ratios[:levels - 1], [[]] * levels,
               DEEP.grid.low, DEEP.grid.high)
    if levels == 1:
        oracle.says("FLASH", "f_0001", "too few cells", "--levels", "1")
    else:
        check("f_0001", few, plane, 1e-12, 1e-12, ["--levels", levels])
        check("a.athdf", few, plane, 1e-12, 1e-12, ["--levels", levels])
sheet = lambda x, y, z: plane(x, y, 0 * z)
for write, options in ((flash, {}), (flash, {"axes": 2}),
                       (athena, {"ghosts": 2, "kind": "f8"})):
    write("sheet.h5", PLANE, {"rho": sheet}, **options)
    voxels, matrix = oracle.converted("sheet.h5")
    if voxels is None or voxels.shape != tuple(PLANE.grid.all[-1][::-1]) or \
            np.abs(voxels - PLANE.grid.finest(sheet)).max() > 1e-12 or \
            not np.allclose(matrix[:2, 3], (PLANE.grid.low + PLANE.grid.steps[-1] / 2)[:2]):
        oracle.fail(f"sheet {options}", "is not the field")
for write, path in ((flash, "f_0001"), (athena, "a.athdf")):
    some = DEEP.leaves
    write(path, DEEP, {"rho": plane}, leaves=some[1:])
    oracle.refuse(path, "lacks blocks")
    write(path, DEEP, {"rho": plane}, leaves=some[:1] + some[1:-1] + some[:1])
    oracle.refuse(path, "two blocks in one place")
    last = [(n, at) for n, at in some if at[0] < 2**n]
    write(path, DEEP, {"rho": plane}, leaves=last)
    oracle.refuse(path, "damaged" if write is athena else "lacks blocks")
flash("f_0001", DEEP, {"dens": plane}, "cylindrical")
oracle.refuse("f_0001", "FLASH in cylindrical coordinates")
athena("a.athdf", DEEP, {"rho": plane}, coordinates="spherical_polar")
oracle.refuse("a.athdf", "Athena++ in spherical_polar coordinates")
athena("a.athdf", DEEP, {"rho": plane}, bend=.1, kind="f8")
oracle.refuse("a.athdf", "uneven sizes along x1")
athena("a.athdf", DEEP, {"rho": plane})
oracle.tells("a.athdf", ["--dataset", "/x2f"], quantity="x2f")
oracle.refuse("a.athdf", "no such data set", ["--dataset", "temp"], 2)
oracle.refuse("a.athdf", "there are 2 variables", ["--channel", 2], 2)
oracle.refuse("a.athdf", "have one value", ["--component", "x"], 2)


def vtkhdf(path, grid, fields, kind="f8", steps=None, more="s", version=(2, 3)):
    """Boxes of the levels; of `steps`, each with its own number and values."""
    with h5py.File(path, "w") as file:
        root = file.create_group("VTKHDF")
        root.attrs.update(Version=np.array(version), Type=np.bytes_("OverlappingAMR"),
                          GridDescription=np.bytes_("XYZ"), Origin=grid.low)
        for level, boxes in enumerate(grid.boxes):
            group = root.create_group(f"Level{level}")
            group.attrs["Spacing"] = grid.steps[level]
            group["AMRBox"] = np.array([[end for pair in zip(a, b) for end in pair]
                                        for a, b in boxes] * (steps or 1), "i4")
            for name, field in fields.items():
                group[f"CellData/{name}"] = np.concatenate([
                    np.stack([grid.values(lambda x, y, z: f(x, y, z) + step,
                                          level, *box).ravel()
                              for f in np.atleast_1d(field)], -1).squeeze()
                    for step in range(steps or 1) for box in boxes]).astype(kind)
                cells = len(group[f"CellData/{name}"]) // (steps or 1)
                if steps:
                    root[f"Steps/Level{level}/CellDataOffset{more}/{name}"] = \
                        np.arange(steps) * cells
            if steps:
                of = root[f"Steps/Level{level}"]
                of["AMRBoxOffset" + more] = np.arange(steps) * len(boxes)
                of["NumberOfAMRBox" + ("es" if more else "")] = \
                    np.full(steps, len(boxes))
        if steps:
            root["Steps"].attrs["NSteps"] = steps
            root["Steps/Values"] = np.arange(steps) / 8


for grid, kind in ((TWO, "f8"), (FOUR, "f4"), (FLAT, "f8")):
    vtkhdf("a.vtkhdf", grid, {"rho": plane, "v": [plane, hill, hill]}, kind)
    check("a.vtkhdf", grid, plane, 1e-5, 1e-6, name="VTKHDF")
check("a.vtkhdf", FLAT, plane, 1e-12, 1e-12,
      ["--dataset", "/VTKHDF/Level0/CellData/v", "--component", "x"])
oracle.tells("a.vtkhdf", ["--dataset", "v"], components=3, magnitude=True)
oracle.refuse("a.vtkhdf", "the cells have rho, v", ["--dataset", "w"], 2)
for more in ("", "s"):
    vtkhdf("a.vtkhdf", FLAT, {"rho": plane}, steps=3, more=more)
    check("a.vtkhdf", FLAT, lambda x, y, z: plane(x, y, z) + 2, 1e-12, 1e-12,
          ["--time", "2"], "VTKHDF steps")
    oracle.tells("a.vtkhdf", ["--time", "2"], times=3, time_value=0.25)
with h5py.File("a.vtkhdf", "a") as file:
    was = file["VTKHDF/Level1/CellData/rho"][:-1]
    del file["VTKHDF/Level1/CellData/rho"]
    file["VTKHDF/Level1/CellData/rho"] = was
oracle.refuse("a.vtkhdf", "fewer values than its boxes", ["--time", "2"])
with h5py.File("a.vtkhdf", "a") as file:
    file.move("VTKHDF/Level0/CellData", "VTKHDF/Level0/PointData")
oracle.refuse("a.vtkhdf", "write CellData")

# Other codes are named, and what makes a volume of their files.
for names, part in ((["Parameters and Global Attributes/All Parameters",
                      "ADMBASE::lapse it=0 tl=0 rl=0 c=0"], "kuibit"),
                    (["Chombo_global/x", "level_0/data:datatype=0"], "Chombo"),
                    (["Grid00000001/Density"], "Enzo"),
                    (["PartType0/Coordinates", "Header/x"], "particles"),
                    (["CGNSLibraryVersion"], "CGNS"), ([".silo/x"], "Silo"),
                    (["coordx", "eb_status", "connect1"], "Exodus")):
    with h5py.File("other.h5", "w") as file:
        for name in names:
            file[name] = np.zeros((4, 5, 6))
    oracle.refuse("other.h5", part)
with h5py.File("other.h5", "w") as file:
    file.create_group("VTKHDF").attrs["Type"] = np.bytes_("UnstructuredGrid")
oracle.refuse("other.h5", "of type UnstructuredGrid")

# What is damaged is refused.
plotfile("good", TWO, {"rho": hill})


def spoil(name, part, old, new):
    """Refuses the plotfile with a text replaced."""
    was = oracle.got(f"good/{name}")
    assert old in was, (name, old)
    oracle.put(f"good/{name}", was.replace(old, new, 1))
    oracle.refuse("good", part)
    oracle.put(f"good/{name}", was)


HEAD, CELL, DATA = "Header", "Level_1/Cell_H", "Level_1/Cell_D_00000"
spoil(HEAD, "the number of its finest level", b"\n2\n0.0 0.0", b"\n99\n0.0 0.0")
spoil(HEAD, "domains of its levels", b"(31,31,31)", b"(31,31)")
spoil(HEAD, "no multiple", b"(63,63,63)", b"(62,63,63)")
spoil(HEAD, "domain reaches from 0 to -1", b"1.0 1.0 1.0", b"-1 1 1")
spoil(HEAD, "cannot be opened", b"Level_1/Cell", b"Level_7/Cell")
spoil(HEAD, "more than any file", b"(127,127,127)", b"(4294967295,127,127)")
spoil(CELL, "box 2 has cells", b"(51,43,30)", b"(51,143,30)")
spoil(CELL, "should be a box", b"(51,43,30)", b"(51,43)")
spoil(CELL, "headerversion", b"1\n1\n1\n", b"5\n1\n1\n")
spoil(CELL, "the type of its values", b"1\n1\n1\n", b"2\n1\n1\n")
spoil(CELL, "number of boxes and components", b"\n3,1\n", b"\n3,2\n")
spoil(CELL, "should be the number of boxes", b"(3 0", b"(4000001 0")
spoil(CELL, "not the header of values", b"Cell_D_00000 0", b"Cell_D_00000 8")
spoil(CELL, "values of a box", b"Cell_D_00000 0", b"Cell_D_00000 99999999")
spoil(DATA, "not the header of values", b"(8, (64 11", b"(8, (64 12")
spoil(DATA, "not the header of values", b"(51,43,30)", b"(51,43,31)")
os.truncate(f"good/{DATA}", 90000)
oracle.refuse("good", "values of a box")
os.truncate(f"good/{CELL}", 100)
oracle.refuse("good", "it is damaged")
oracle.put("c.vth", '<VTKFile type="vtkOverlappingAMR">'
           '<vtkOverlappingAMR>{}</V>')
oracle.refuse("c.vth", "XML is damaged")
text = oracle.got("a.vth")
for old, new, part in ((b'level="1"', b'level="2"', "no files of level 1"),
                       (b'level="1"', b'level="x"', "must be 0 to"),
                       (b"a/a_1.vti", b"a/a_0.vti", "another size"),
                       (b"a/a_2.vti", b"a/a_9.vti", "cannot be opened")):
    assert old in text, old
    oracle.refuse(oracle.put("c.vth", text.replace(old, new)), part)
oracle.finish()
