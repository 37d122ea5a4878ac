#!/bin/bash
# --mask, --labels and --clip: what is left out is as if it had never had a value, in
# pictures, figures, movies and conversions; what does not fit is refused.
. "$(dirname "$0")/../../support/shell.sh"
need_python

view="render -s 90x80 --no-labels"
render() { "$TOOL" $view -q "$@"; }

# figure KEY OPTION...: of info.
figure() { "$TOOL" info --json "${@:2}" | python3 -c "
import json, sys
print(json.load(sys.stdin)['$1'])"; }

"$TOOL" phantom head --dims 32x28x30 -o v.npy -q
"$TOOL" convert v.npy -o v.nrrd -q

# Labels 0 to 3 in blocks; the volume masked here by hand: labels 2 and 3, and all but
# 0, and the first also by planes, x up to 15 and z from 4; a mask of all, with which
# the border of what is masked by hand is lit; one of another size; one that has its
# place, and one that is flipped; of voxels that are no cubes.
python3 - <<'END'
import array
from volumes import each, npy, nrrd, placed

dims, shape = (32, 28, 30), (30, 28, 32)
data = open("v.npy", "rb").read()[-32 * 28 * 30:]
labels = each(dims, lambda x, y, z: (x >= 16) + 2 * (z >= 14))
nan = float("nan")

def write(name, inside):
    npy(name, "<f4", shape, array.array("f", (
        v if inside(m, n % 32, n // 896) else nan
        for n, (v, m) in enumerate(zip(data, labels)))).tobytes())

write("two.npy", lambda m, x, z: m in (2, 3))
write("clip.npy", lambda m, x, z: m in (2, 3) and x <= 15 and z >= 4)
write("any.npy", lambda m, x, z: m != 0)
npy("m.npy", "|u1", shape, labels)
npy("all.npy", "|u1", shape, b"\1" * len(labels))
npy("nan.npy", "<f8", shape, array.array("d", (m or nan for m in labels)).tobytes())
npy("small.npy", "|u1", (30, 28, 31), labels[:30 * 28 * 31])
open("m.raw", "wb").write(labels)
for name, x, origin in ("place", 1, 5), ("flip", -1, 36):
    nrrd(name + ".nrrd", dims, labels, *placed((x, 1, 1), (origin, 0, 0)))
for name, voxels in ("v", data), ("m", labels):
    nrrd(name + "-half.nrrd", dims, voxels, "spacings: 0.5 0.5 0.9")
END

# --- pictures -----------------------------------------------------------------
box="--labels 1,3 --crop 10:30,2:,:20"
run 0 "a converted mask" "$TOOL" convert v.npy -o box.npy -q --mask m.npy $box
pairs npy $view <<END
$(for way in "" "--method footprint" "--method original" "--mode mip" \
    "--mode iso --iso 90" "--quality high --encoding rle" \
    "--gradient-opacity 0:0,20:1"; do
    echo "labels 2 and 3 | v.npy --mask m.npy --labels 2-3 $way | = | two.npy --view +z --mask all.npy $way"
done)
the whole volume | v.npy --mask m.npy --labels 2-3 | != | v.npy
NaN in the mask | v.npy --mask m.npy | = | v.npy --mask nan.npy
all but 0 by hand | v.npy --mask m.npy --stats c.json -y | = | any.npy --view +z --mask all.npy --stats d.json -y
a box of both, but for its place | v.npy --shade none --mask m.npy $box | = | box.npy --view +z --shade none
a box of flat voxels, with a mask of cubes | v-half.nrrd --mask m-half.nrrd $box | = | \
    v-half.nrrd --mask m.npy $box
a mask without a place | place.nrrd --mask place.nrrd | = | place.nrrd --mask m.npy
END
check "as many interesting voxels" python3 -c '
import json
a, b = (json.load(open(n)) for n in ("c.json", "d.json"))
assert a["sparse_ratio"] == b["sparse_ratio"] > 0.25, a
assert a["volume"]["type"] == "float32", a'
run 0 "a box of flat voxels, aloud" "$TOOL" $view v-half.nrrd -o cubes.npy --mask m.npy $box
not_said 'another grid'
run 0 "all but 0" render v.npy -o c.npy --mask m.npy
run 0 "from standard input" bash -c \
    "'$TOOL' render - -q --no-labels -s 90x80 -o h.npy --mask m.npy <v.npy"
same_file "is the same" c.npy h.npy
run 7 "a mask of no voxel" "$TOOL" render v.npy -o i.png --mask m.npy --labels 9
says 'm.npy: no voxel is left inside this mask, whose values are 0 to 3'
check "is told once" test "$(grep -c 'no voxel is left' "$ERR")" = 1
run 0 "a mask that is flipped is used as it is" \
    render place.nrrd -o f.png --mask flip.nrrd

# --- planes: x up to 15 of 0 to 31, a sixth plane beyond all ------------------
# Footprints leave out voxels, as by hand; of values planes cut slabs exactly.
run 0 "a mask and planes" render v.npy --method footprint -o n.npy --mask m.npy --labels 2-3 \
    --clip 2,0,0,30,0,0,-1,-4,1,0,0,99,1,0,0,99,1,0,0,99,1,1,1,999 \
    --save-config n.json
run 0 "masked and clipped by hand" \
    render clip.npy --view +z --method footprint -o o.npy
same_file "is the same picture" n.npy o.npy
run 0 "taken from a recipe" render --config n.json -o q.npy
same_file "they are the same" n.npy q.npy
printed "planes alone" '^finite  *13440 of 26880' "$TOOL" info v.npy --clip 1,0,0,15
printed "of a box lie where they were" '^finite  *210 of' \
    "$TOOL" info v.npy --clip 1,0,0,15 --crop 10:,0:7,0:5
# A plane cuts the object and the background alike, as a crop does.
for cut in "--clip 0,0,1,0" "--crop :,:,:57"; do
    run 0 "a look with $cut" "$TOOL" info phantom:head $cut
    grep '^look' "$OUT" >>looks
done
check "is the same" test "$(sort -u looks | wc -l)" = 1
run 7 "planes that leave nothing" "$TOOL" render v.npy -o p.png --clip 1,0,0,-1
says 'clip: no voxel is left'
run 0 "planes that leave some" "$TOOL" render v.npy -y -o p.png --clip 1,0,0,15
not_said 'no voxel'

# --- figures and movies -------------------------------------------------------
check "info counts what is inside" test \
    "$(figure finite v.npy --mask m.npy --labels 3)" = $((16 * 28 * 16))
for key in sum look; do
    check "its $key is of the values that are left" test \
        "$(figure $key v.npy --mask m.npy --labels 2,3)" = "$(figure $key two.npy)"
done
both() { # both VERB INPUTS BY_HAND OPTION...: frames of what a mask leaves
    run 0 "a $1" "$TOOL" $1 $2 -q --no-labels -s 60x50 "${@:4}" -y -o 't_%d.png' \
        --mask m.npy --labels 2-3
    run 0 "of what is masked by hand" "$TOOL" $1 $3 -q --no-labels --view +z -s 60x50 "${@:4}" -y \
        -o 'u_%d.png' --mask all.npy
    same_file "is the same" t_1.png u_1.png
}
both turntable v.npy two.npy --frames 2
both movie "v.npy v.nrrd" "two.npy two.npy"

# --- light --------------------------------------------------------------------
# Matter of one value, and a ball of it: its middle faces a light at the eye, its
# rim does not.
python3 - <<'END'
import array
from volumes import each, nrrd
n = 28
dims = (n,) * 3
even = bytearray(b"\x64" * n ** 3)
even[0], even[1] = 0, 200
ball = each(dims, lambda x, y, z: (x - 13) ** 2 + (y - 14) ** 2 + (z - 13) ** 2 < 120)
nrrd("even.nrrd", dims, even)
nrrd("ball.nrrd", dims, ball)
nrrd("hand.nrrd", dims, array.array("f", (
    v if b else float("nan") for v, b in zip(even, ball))).tobytes(), kind="float")
nrrd("grad.nrrd", dims, bytes(102 + 3 * (i % n) + i % 7 for i in range(n ** 3)))
nrrd("slope.nrrd", dims, each(dims, lambda x, y, z: 60 + 2 * (x + y + z)))
# CT numbers, and the same with an offset, all outside the ball air.
for name, kind, offset in ("hu", "short", 0), ("offset", "ushort", 1024):
    nrrd(name + ".nrrd", dims, array.array("h", (
        offset + (40 + i % 9 if b else -1000) for i, b in enumerate(ball))).tobytes(),
         kind=kind)
END
lit="even.nrrd --mask ball.nrrd --light head --range 0,200 -c light-grey"
for method in shear-warp raycast; do
    run 0 "an organ of one value by $method" render $lit -o $method.npy \
        --opacity 0:0.9,200:0.9 --method $method
    check "is lit as a ball" python3 -c '
import array, sys
a = array.array("f", open(sys.argv[1], "rb").read()[-90 * 80 * 4 * 4:])
pixel = lambda x, y: a[4 * (90 * y + x):4 * (90 * y + x) + 4]
row = [pixel(x, 40) for x in range(90)]
inside = [p[0] / p[3] for p in row if p[3] > 0.95]
middle, rim = inside[len(inside) // 2], (inside[0] + inside[-1]) / 2
assert len(inside) > 20 and middle > 1.4 * rim, (len(inside), middle, rim)' \
        $method.npy
done
check "alike by both" python3 -c '
import sys
assert float([l.split()[1] for l in sys.argv[1].splitlines()
              if "psnr" in l][0]) > 20' \
    "$("$TOOL" compare shear-warp.npy raycast.npy)"
for method in shear-warp raycast; do
    run 0 "missing values by $method" render hand.nrrd -o hand.npy -y --light head \
        --range 0,200 -c light-grey --opacity 0:0.9,200:0.9 --method $method
    check "have no border that is lit" python3 -c '
import array
from volumes import each, nrrd
a = array.array("f", open("hand.npy", "rb").read()[-90 * 80 * 4 * 4:])
inside = [a[n] / a[n + 3] for n in range(4 * 90 * 40, 4 * 90 * 41, 4)
          if a[n + 3] > 0.95]
assert len(inside) > 20 and max(inside) < 1.1 * min(inside), inside'
done
# A cut face has the colours of the values in its plane, and no light: of a linear
# field, and of labels, whose gradient is 0.
while IFS="|" read -r options levels value; do
    run 0 "a cut face: $options" render $options --clip 0.3,0.2,1,20 -c grey \
        --range 0,200 --opacity 0:1,200:1 --view +z --fit volume -s 60x60 -o face.npy -y
    check "is flat" python3 -c '
import array, math, sys
a = array.array("f", open("face.npy", "rb").read()[-60 * 60 * 4 * 4:])
off = 0
for i in range(60 * 60):
    side = 28 * math.sqrt(3) / 60 # of a pixel; the middle is at 13.5
    x, y = ((n + 0.5 - 30) * side for n in (i % 60, 59 - i // 60))
    if abs(x) < 9 > abs(y):
        x, y = x + 13.5, y + 13.5
        z = 20 - 0.3 * x - 0.2 * y
        off = max(off, abs(a[4 * i] / a[4 * i + 3] - eval(sys.argv[2]) / 200))
assert off <= float(sys.argv[1]) / 255, off * 255' "$levels" "$value"
done <<'END'
slope.nrrd --method raycast|0.5|60 + 2 * (x + y + z)
slope.nrrd|1.5|60 + 2 * (x + y + z)
slope.nrrd --quality draft|1.5|60 + 2 * (x + y + z)
slope.nrrd --quality high|1.5|60 + 2 * (x + y + z)
slope.nrrd --method footprint|4|60 + 2 * (x + y + z)
slope.nrrd --method footprint --kernel tent|4|60 + 2 * (x + y + z)
slope.nrrd -m iso --iso 90|1|90
slope.nrrd -m iso --iso 90 --method raycast|1|90
even.nrrd|1|100
even.nrrd --method raycast|1|100
even.nrrd --method footprint|1|100
END
for cut in "--mask ball.nrrd" "--clip 0,0,1,12"; do
    run 0 "CT numbers with $cut" "$TOOL" render hu.nrrd $cut --preset ct-soft \
        -s 40x40 -o hu.png -y
    not_said 'have an offset'
    told "those with an offset, with $cut" \
        'if the values have an offset of 1024, give --range [0-9-]*,[0-9]*$' \
        "$TOOL" render offset.nrrd $cut --preset ct-soft -s 40x40 -o hu.png -y
done
told "the look of what fills a mask" 'light-grey' \
    "$TOOL" render grad.nrrd --mask ball.nrrd -s 40x40 -o grad.png
told "and of what planes cut, whose faces are not lit" 'not shaded' \
    "$TOOL" render slope.nrrd --clip 1,0,0,14 -s 40x40 -o slope.png
run 0 "the automatic look" "$TOOL" render even.nrrd --mask ball.nrrd -o auto.png
run 0 "a preset of Hounsfield units" "$TOOL" render even.nrrd --mask ball.nrrd \
    --preset ct-soft --range -200,300 -o preset.png

# --- recipes ------------------------------------------------------------------
run 0 "a recipe is saved" render v.npy -o j.npy --mask m.npy --labels 1,2-3 \
    --save-config j.json
check "with both keys" grep -q '"labels": "1,2-3"' j.json
pairs npy $view <<END
and taken | v.npy --mask m.npy --labels 1-3 | = | --config j.json
other labels count more than those of the file | --config j.json --labels 2-3 | = | \
    --config j.json two.npy
END

# --- refused ------------------------------------------------------------------
mkfifo pipe
mkdir empty
refusals 3 "$TOOL" <<'END'
render v.npy -o z.png --mask small.npy|small.npy: the mask has 31x28x30 voxels, the volume 32x28x30
render v.npy -o z.png --mask small.npy --crop 0:9,0:9,0:9|the mask has 31x28x30
info v.npy --mask none.nrrd|none.nrrd: cannot be opened
info v.npy --mask /dev/zero|/dev/zero: is a device
info v.npy --mask empty|empty: names no slices
END
refusals 2 "$TOOL" <<'END'
info v.npy --mask m.raw|m.raw: .* snowglass convert makes
info v.npy --mask pipe|^snowglass: pipe: a mask is read from a file
info v.npy --mask -|^snowglass: -: a mask is read from
convert v.npy -o z.nrrd --as uint8 --mask m.npy|convert to float32, which has NaN
END
refused 2 "a box of standard input" 'with a mask both must be files' bash -c \
    "'$TOOL' info - --mask m.npy --crop 0:9,0:9,0:9 <v.npy"
# 26880 voxels: of one byte, of the mask's and of floats.
refused 5 "both volumes count" 'need 157.5 KiB, over the --memory' \
    "$TOOL" render v.npy -o z.png -s 9x9 --mask m.npy --memory 100K
finish
