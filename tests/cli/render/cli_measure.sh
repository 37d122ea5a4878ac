#!/bin/bash
# --measure: lengths, angles and ellipses beside those that NumPy finds with the matrix
# that nibabel reads; on oblique, sheared and uneven grids, scaled, cropped, masked and
# out of core; drawn where they are; kept in recipes; what is wrong is refused.
. "$(dirname "$0")/../../support/shell.sh"
need_python
python3 -c "import numpy, nibabel" 2>/dev/null || {
    echo "skip   NumPy or nibabel is missing"
    exit 77
}

cat >check.py <<'END'
import json
import subprocess
import sys

import nibabel
import numpy as np

TOOL = sys.argv[1]
wrong = 0


def check(name, good):
    global wrong
    wrong += not good
    print("ok    " if good else "FAILED", name)


def tool(*words):
    return subprocess.run([TOOL, *map(str, words)], capture_output=True, text=True)


def measured(verb, path, text, *options):
    """The list of --stats."""
    done = tool(verb, path, "-o", "out.png", "-y", "-q", "-s", 64, "--stats", "-", "--measure",
                text, *options)
    if done.returncode not in (0, 7):
        print(done.stderr)
        return [None] * 9
    return json.loads(done.stdout)["measures"]


def near(a, b, part=1e-6):
    return a is not None and abs(a - b) <= part * max(abs(b), 1e-6)


def word(point):
    return ",".join(f"{x:.9g}" for x in point)


def turn(degrees, axis):
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    made = np.eye(3)
    i, j = [k for k in range(3) if k != axis]
    made[i, i] = made[j, j] = c
    made[i, j], made[j, i] = -s, s
    return made


def volume(name, linear, origin, shape=(23, 31, 17)):
    """A file, and its voxels and matrix as nibabel reads them again."""
    voxels = chance.normal(100, 60, shape)
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = linear, origin
    made = nibabel.Nifti1Image(voxels.astype(np.int16), matrix)
    made.header.set_xyzt_units("mm")
    nibabel.save(made, name)
    back = nibabel.load(name)
    return name, np.asanyarray(back.dataobj).astype(float), back.affine


chance = np.random.default_rng(7)
steps = np.diag([0.7, 1.3, 2.9])
GRIDS = [
    volume("even.nii", np.diag([2.0, 2, 2]), (0, 0, 0)),
    volume("uneven.nii", steps * [[-1], [1], [1]], (10, -20, 30)),
    volume("oblique.nii", turn(25, 0) @ turn(-15, 2) @ steps, (-40, 12, 7)),
    volume("sheared.nii", np.array([[1, 0, 0], [0, 1, 0.3], [0, 0, 1]]) @ steps, (3, 4, 5)),
]


def place(matrix, index):
    return matrix[:3, :3] @ index + matrix[:3, 3]


# --- lines and angles ---------------------------------------------------------

for name, voxels, matrix in GRIDS:
    points = [place(matrix, chance.uniform(0, np.array(voxels.shape) - 1)) for _ in range(3)]
    a, b, c = points
    text = f"line {word(a)} {word(b)}; angle {word(a)} {word(b)} {word(c)};"
    line, angle = measured("render", name, text)[:2]
    cosine = np.dot(a - b, c - b) / np.linalg.norm(a - b) / np.linalg.norm(c - b)
    check(f"{name}: a line is as long as the norm", near(line["length"], np.linalg.norm(a - b)))
    check(f"{name}: an angle is that of its ways",
          near(angle["degrees"], np.degrees(np.arccos(cosine))))
    check(f"{name}: in millimetres", line["unit"] == "mm")
    for scale in 0.25, 3:
        again = measured("render", name, text, "--z-scale", scale)
        check(f"{name}: a z-scale of {scale} changes no length",
              again and near(again[0]["length"], line["length"]) and
              near(again[1]["degrees"], angle["degrees"]))

# --- ellipses -----------------------------------------------------------------


def inside(voxels, matrix, axis, index, ends):
    """The values whose centres are in the ellipse from its middle to two ends."""
    middle, a, b = ends
    grid = [np.arange(n) for n in voxels.shape]
    grid[axis] = np.array([index])
    at = np.stack(np.meshgrid(*grid, indexing="ij"), -1).reshape(-1, 3)
    world = at @ matrix[:3, :3].T + matrix[:3, 3]
    shares = np.linalg.lstsq(np.stack([a - middle, b - middle], 1), (world - middle).T,
                             rcond=None)[0]
    return voxels[tuple(at.T)][(shares**2).sum(0) <= 1 + 1e-9]


def same(found, values, area):
    values = values[np.isfinite(values)]
    return found and found["count"] == values.size > 3 and near(found["area"], area) and \
        near(found["mean"], values.mean()) and near(found["min"], values.min()) and \
        near(found["max"], values.max()) and near(found["deviation"], values.std(ddof=1))


def cases(name, voxels, matrix):
    """(words, axis of the grid, slice, middle and ends) of lengths, and of turned axes."""
    sides = matrix[:3, :3] / np.linalg.norm(matrix[:3, :3], axis=0)
    for axis in range(3):
        index = voxels.shape[axis] // 3
        at = (np.array(voxels.shape) - 1) / 2 + [1.3, -2.2, 0.6]
        at[axis] = index
        middle = place(matrix, at)
        others = [k for k in range(3) if k != axis]
        mid = (np.array(voxels.shape) - 1) / 2
        mid[axis] = index
        normal = np.cross(*(sides[:, k] for k in others))
        world = int(np.argmax(abs(normal)))
        position = place(matrix, mid)[world]
        # The picture's right is along the world's first axis that lies in the slice.
        across = max(others, key=lambda k: abs(sides[[w for w in range(3) if w != world][0], k]))
        up, = (k for k in others if k != across)
        if "sheared" not in name:
            yield (f"ellipse {'xyz'[axis]} {position:.9g} {word(middle)} 6 9", axis, index,
                   (middle, middle + 6 * sides[:, across], middle + 9 * sides[:, up]))
        step = np.zeros((2, 3))
        step[0, others[0]], step[0, others[1]] = 5, 3
        step[1, others[0]], step[1, others[1]] = -2, 4
        ends = [place(matrix, at + s) for s in step]
        yield (f"ellipse {'xyz'[axis]} {position:.9g} {word(middle)} {word(ends[0])} "
               f"{word(ends[1])}", axis, index, (middle, *ends))


for name, voxels, matrix in GRIDS:
    made = list(cases(name, voxels, matrix))
    found = measured("render", name, "; ".join(words for words, *_ in made))
    for n, (words, axis, index, ends) in enumerate(made):
        values = inside(voxels, matrix, axis, index, ends)
        area = np.pi * np.linalg.norm(np.cross(ends[1] - ends[0], ends[2] - ends[0]))
        check(f"{name}: {words}", same(found[n], values, area) and found[n]["index"] == index)
    words, axis, index, ends = made[0]
    one = inside(voxels, matrix, axis, index, ends)
    area = np.pi * np.linalg.norm(np.cross(ends[1] - ends[0], ends[2] - ends[0]))
    for verb, *options in (("slice", "--axis", "z"), ("slice", "--ortho"),
                           ("slice", "--grid", "2x2", "--axis", "y"),
                           ("slice", "--axis", "x", "--at", index), ("slice", "--at", 2),
                           ("render", "--clip", "1,0,0,0"),
                           ("render", "--z-scale", 2),
                           ("render", "--crop", f"{index - 1}:{index + 2},:,:")):
        check(f"{name}: the same by {verb} {options}",
              same(measured(verb, name, words, *options)[0], one, area))

# --- values as shown ----------------------------------------------------------

name, voxels, matrix = GRIDS[1]
words, axis, index, ends = list(cases(name, voxels, matrix))[4]
scaled = nibabel.load(name)
scaled.header.set_slope_inter(0.5, -1000)
stored = nibabel.Nifti1Image(np.asanyarray(scaled.dataobj.get_unscaled()), matrix, scaled.header)
stored.header.set_slope_inter(0.5, -1000)
nibabel.save(stored, "slope.nii")
shown = nibabel.load("slope.nii").get_fdata()
one = inside(shown, matrix, axis, index, ends)
area = np.pi * np.linalg.norm(np.cross(ends[1] - ends[0], ends[2] - ends[0]))
check("the header has the slope", abs(shown.min() + 1000) < 500)
check("slope and intercept count", same(measured("render", "slope.nii", words)[0], one, area))
holes = shown.astype(np.float32)
holes[chance.uniform(size=holes.shape) < 0.3] = np.nan
nibabel.save(nibabel.Nifti1Image(holes, matrix), "holes.nii")
check("voxels without a value do not count",
      same(measured("slice", "holes.nii", words)[0], inside(holes, matrix, axis, index, ends), area))
mask = (chance.uniform(size=holes.shape) < 0.5).astype(np.uint8)
nibabel.save(nibabel.Nifti1Image(mask, matrix), "mask.nii")
check("nor do those of a mask", same(
    measured("render", name, words, "--mask", "mask.nii")[0],
    inside(np.where(mask, voxels, np.nan), matrix, axis, index, ends), area))
big, voxels, matrix = volume("big.nii", steps, (0, 0, 0), shape=(200, 180, 150))
words, axis, index, ends = list(cases(big, voxels, matrix))[3]
area = np.pi * np.linalg.norm(np.cross(ends[1] - ends[0], ends[2] - ends[0]))
for verb in ("render", "slice"):
    check(f"a volume that stays in its file: {verb}", same(
        measured(verb, big, words, "--memory", "9M")[0],
        inside(voxels, matrix, axis, index, ends), area))
name, voxels, matrix = GRIDS[1]
single = measured("render", name, f"ellipse z {place(matrix, [4, 5, 6])[2]:.9g} "
                  f"{word(place(matrix, [4, 5, 6]))} 0.1 0.1")[0]
check("one voxel has no deviation", single["count"] == 1 and single["deviation"] is None and
      near(single["mean"], voxels[4, 5, 6]))

# Frames of steps, whose values differ, against pictures of each.
growing = np.stack([voxels, voxels / 2], axis=3).astype(np.float32)
nibabel.save(nibabel.Nifti1Image(growing, matrix), "steps.nii")
words = list(cases(name, voxels, matrix))[4][0]
look = ("-q", "-y", "-s", 128, "--preset", "linear", "--range", "0,400", "--fit", "volume",
        "--measure", words)
tool("movie", "steps.nii", "-o", "f_%d.png", *look)
for step in (0, 1):
    tool("render", "steps.nii", "--time", step, "-o", "one.png", *look)
    with open(f"f_{step}.png", "rb") as frame, open("one.png", "rb") as one:
        check(f"a frame has the measures of its step {step}", frame.read() == one.read())

# --- where they are drawn -----------------------------------------------------


def picture(*options):
    """Brightness, row 0 at the top."""
    done = tool("slice", name, "-y", "-q", "-o", "out.ppm.png", "--no-labels", "--axis", "z",
                "--at", 6, "--range", "-1000,1000", "-s", "322x806", *options)
    tool("convert", "out.ppm.png", "-o", "x.npy")
    if done.returncode:
        print(done.stderr)
    from PIL import Image
    return np.asarray(Image.open("out.ppm.png").convert("L")).astype(float)


try:
    import PIL.Image # noqa: F401
    a, b = np.array([4.0, 5, 6]), np.array([19.0, 26, 6])
    text = f"line {word(place(matrix, a))} {word(place(matrix, b))}"
    change = abs(picture("--measure", text) - picture()) > 20
    # The file's x runs to the patient's left, which is at the right of the picture; y up.
    pitch = 0.7 * 23 / 322

    def pixel(index):
        return ((index[0] + 0.5) * 0.7 / pitch, 403 + (15 - index[1]) * 1.3 / pitch)

    line = [pixel(a + (b - a) * t) for t in np.linspace(0, 1, 200)]
    check("a line is where its points are",
          all(change[int(y), int(x)] or change[int(y) - 1:int(y) + 2, int(x) - 1:int(x) + 2].any()
              for x, y in line))
    off = [pixel(a + (b - a) * t) for t in (-0.1, -0.05, 1.05, 1.1)]
    check("and not beyond them",
          not any(change[int(y) - 2:int(y) + 3, int(x) - 2:int(x) + 3].any() for x, y in off))
    far = f"line {word(place(matrix, a + [0, 0, 1]))} {word(place(matrix, b))}"
    check("nor on a slice that one point is not on",
          not (abs(picture("--measure", far) - picture()) > 0).any())
except ImportError:
    print("skip   PIL is missing")

sys.exit(wrong > 0)
END
run 0 "what is measured is what NumPy finds" python3 check.py "$TOOL"
cat "$OUT" "$ERR"

# --- recipes ------------------------------------------------------------------

measure='line 2,2,2 10,12,8; ellipse axial 6 20,20 8 5'
render() { "$TOOL" render even.nii -q -y -s 64 "$@"; }
render -o a.png --measure "$measure" --save-config r.json --stats a.json
run 0 "a recipe keeps measures" "$TOOL" --config r.json -q -y -o b.png --stats b.json
check "with their figures" python3 -c "
import json
a, b = (json.load(open(name))['measures'] for name in ('a.json', 'b.json'))
assert a == b and len(a) == 2"
check "and their picture" cmp a.png b.png
run 0 "measures change no pixel that a program reads" render -o c.png --measure "$measure" --stats c.json
render -o d.png --stats d.json
check "" python3 -c "
import json
c, d = (json.load(open(name))['image']['checksum'] for name in ('a.json', 'd.json'))
assert c == d"
run 0 "they are printed" "$TOOL" render even.nii -y -s 64 -o a.png --measure "$measure"
says "measure 1: line, 14.1421 mm"
says "measure 2: ellipse on slice 3 across z: mean .*, deviation .*, [0-9]+ voxels, area 125.664 mm2"

# --- what is wrong ------------------------------------------------------------

refused() {
    run 2 "$1" render -o e.png --measure "$1"
    says "$2"
}
refused "lin 0,0,0 1,1,1" "measure 1, 'lin 0,0,0 1,1,1': its kind must be line, angle or ellipse; .* such as line"
refused "line 0,0,0" "measure 1, 'line 0,0,0': a line has two points; .* such as line 0,0,0 10,0,0"
refused "line 0,0,0 1,1,1; line 0,0 1,1,1" "measure 2, .*: a point has three numbers"
refused "line 0,0,x 1,1,1" "a point has three numbers"
refused "line 0,0,nan 1,1,1" "a point has three numbers"
refused "angle 0,0,0 1,1,1" "an angle has three points"
refused "angle 0,0,0 0,0,0 1,1,1" "two points of the angle are one"
refused "line 0,0,0 500,1,1" "measure 1: 500,1,1 is outside the volume, which has x from -1 to 45, "
refused "ellipse w 0 1,1 1 1" "the axis must be x, y, z, axial, coronal or sagittal"
refused "ellipse z a 1,1 1 1" "the position along the axis is one number"
refused "ellipse z 900 1,1 1 1" "measure 1: no slice is at its position: .* z -1 to 33"
refused "ellipse z 6 99,1 1 1" "measure 1: 99,1,6 is outside the volume"
refused "ellipse z 6 1,1 0 1" "a half-axis is a length above 0, or the place where it ends"
refused "ellipse z 6 1,1 2,2 3,3" "the half-axes have one direction"
refused "" "it is none of|needs|empty"
many=$(printf 'line 0,0,0 1,1,1;%.0s' {1..65})
refused "$many" "there are more than 64 measures"
run 2 "a file of floats shows none" "$TOOL" slice even.nii -q -o e.exr --measure "$measure"
says "--measure cannot be drawn into a file of floats"
finish
