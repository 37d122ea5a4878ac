#!/bin/bash
# --mask, --labels and --clip: what is left out is as if it had never had a value, in
# pictures, figures, movies and conversions; what does not fit is refused.
. "$(dirname "$0")/../../support/shell.sh"
command -v python3 >/dev/null || {
    skipped all "there is no python3"
    exit 77
}

render() { "$TOOL" render -q --no-labels -s 90x80 "$@"; }

# figure FILE: of info.
figure() { "$TOOL" info --json "${@:2}" | python3 -c "
import json, sys
print(json.load(sys.stdin)['$1'])"; }

"$TOOL" phantom head --dims 32x28x30 -o v.npy -q
"$TOOL" convert v.npy -o v.nrrd -q

# Labels 0 to 3 in blocks; the volume masked here by hand, labels 2 and 3, and
# all but 0; a mask of all, with which the border of what is masked by hand is lit;
# a mask of another size.
python3 - <<'END'
import array

def head(kind, shape):
    text = "{'descr': '%s', 'fortran_order': False, 'shape': %s, }" % (kind, shape)
    text += " " * (-(len(text) + 11) % 64) + "\n"
    return b"\x93NUMPY\x01\x00" + len(text).to_bytes(2, "little") + text.encode()

nx, ny, nz = 32, 28, 30
data = open("v.npy", "rb").read()[-nx * ny * nz:]
labels = bytes((x >= 16) + 2 * (z >= 14)
               for z in range(nz) for y in range(ny) for x in range(nx))
nan = float("nan")

def write(name, inside):
    values = array.array("f", (v if inside(m) else nan
                               for v, m in zip(data, labels)))
    open(name, "wb").write(head("<f4", (nz, ny, nx)) + values.tobytes())

write("two.npy", lambda m: m in (2, 3))
write("any.npy", lambda m: m != 0)
open("m.npy", "wb").write(head("|u1", (nz, ny, nx)) + labels)
open("all.npy", "wb").write(head("|u1", (nz, ny, nx)) + b"\1" * len(labels))
open("m.raw", "wb").write(labels)
floats = array.array("d", (m if m else nan for m in labels))
open("nan.npy", "wb").write(head("<f8", (nz, ny, nx)) + floats.tobytes())
open("small.npy", "wb").write(head("|u1", (nz, ny, nx - 1)) +
                              labels[:nz * ny * (nx - 1)])
# The volume's file with its header's geometry, and flipped.
for name, x, origin in ("place", 1, 5), ("flip", -1, 36):
    text = ("NRRD0004\ntype: uint8\ndimension: 3\nsizes: 32 28 30\n"
            "space: RAS\nspace directions: (%d,0,0) (0,1,0) (0,0,1)\n"
            "space origin: (%d,0,0)\nencoding: raw\n\n" % (x, origin))
    open(name + ".nrrd", "wb").write(text.encode() + labels)
END

# --- pictures -----------------------------------------------------------------
for way in "" "--method footprint" "--method original" "--mode mip" \
    "--mode iso --iso 90" "--quality high --encoding rle" \
    "--gradient-opacity 0:0,20:1"; do
    # shellcheck disable=SC2086
    run 0 "labels 2 and 3 ${way:-as usual}" render v.npy $way -o a.npy -y \
        --mask m.npy --labels 2-3
    # shellcheck disable=SC2086
    run 0 "masked by hand" render two.npy --mask all.npy $way -o b.npy -y
    check "is the same picture" cmp -s a.npy b.npy
done
run 0 "the whole volume" render v.npy -o whole.npy
check "is another" bash -c '! cmp -s whole.npy a.npy'
run 0 "all but 0" render v.npy -o c.npy --mask m.npy --stats c.json
run 0 "by hand" render any.npy --mask all.npy -o d.npy --stats d.json
check "is the same picture" cmp -s c.npy d.npy
run 0 "NaN in the mask is outside" render v.npy -o e.npy --mask nan.npy
check "as 0 is" cmp -s c.npy e.npy
# shellcheck disable=SC2016
check "as many interesting voxels" python3 -c '
import json
a, b = (json.load(open(n)) for n in ("c.json", "d.json"))
assert a["sparse_ratio"] == b["sparse_ratio"] > 0.25, a
assert a["volume"]["type"] == "float32", a'
run 0 "a box of both" render v.npy --shade none -o f.npy --mask m.npy --labels 1,3 \
    --crop 10:30,2:,:20
run 0 "a converted mask" "$TOOL" convert v.npy -o box.npy -q --mask m.npy \
    --labels 1,3 --crop 10:30,2:,:20
run 0 "is the same box" render box.npy --shade none -o g.npy
check "and picture, but for its place" cmp -s f.npy g.npy
# Of voxels that are no cubes, neither of which has a place.
for name in v m; do
    printf '%s\n' NRRD0004 'type: uint8' 'dimension: 3' 'sizes: 32 28 30' \
        'spacings: 0.5 0.5 0.9' 'encoding: raw' '' >$name-half.nrrd
    tail -c $((32 * 28 * 30)) $name.npy >>$name-half.nrrd
done
run 0 "a box of both, of flat voxels" render v-half.nrrd -o flat.npy \
    --mask m-half.nrrd --labels 1,3 --crop 10:30,2:,:20
run 0 "with a mask of cubes" "$TOOL" render v-half.nrrd --no-labels -s 90x80 \
    -o cubes.npy --mask m.npy --labels 1,3 --crop 10:30,2:,:20
check "is the same" cmp -s flat.npy cubes.npy
check "nothing is resampled" bash -c "! grep -q 'another grid' '$ERR'"
run 0 "from standard input" bash -c \
    "'$TOOL' render - -q --no-labels -s 90x80 -o h.npy --mask m.npy <v.npy"
check "is the same" cmp -s c.npy h.npy
run 7 "a mask of no voxel" "$TOOL" render v.npy -o i.png --mask m.npy --labels 9
says 'm.npy: no voxel is left inside this mask, whose values are 0 to 3'

# --- planes: x up to 15 of 0 to 31, a sixth plane beyond all ------------------
python3 - <<'END'
import array
data = open("two.npy", "rb").read()
head, values = data[:-4 * 32 * 28 * 30], array.array("f", data[-4 * 32 * 28 * 30:])
for i in range(len(values)):
    if i % 32 > 15 or i // 896 < 4:
        values[i] = float("nan")
open("clip.npy", "wb").write(head + values.tobytes())
END
# Footprints leave out voxels, as by hand; of values planes cut slabs exactly.
run 0 "a mask and planes" render v.npy --method footprint -o n.npy --mask m.npy --labels 2-3 \
    --clip 2,0,0,30,0,0,-1,-4,1,0,0,99,1,0,0,99,1,0,0,99,1,1,1,999 \
    --save-config n.json
run 0 "masked and clipped by hand" \
    render clip.npy --method footprint -o o.npy
check "is the same picture" cmp -s n.npy o.npy
run 0 "taken from a recipe" render --config n.json -o q.npy
check "they are the same" cmp -s n.npy q.npy
run 0 "planes alone" "$TOOL" info v.npy --clip 1,0,0,15
prints '^finite  *13440 of 26880'
run 0 "of a box lie where they were" "$TOOL" info v.npy --clip 1,0,0,15 \
    --crop 10:,0:7,0:5
prints '^finite  *210 of'
# A plane cuts the object and the background alike, as a crop does.
for cut in "--clip 0,0,1,0" "--crop :,:,:57"; do
    # shellcheck disable=SC2086
    run 0 "a look with $cut" "$TOOL" info phantom:head $cut
    grep '^look' "$OUT" >>looks
done
check "is the same" test "$(sort -u looks | wc -l)" = 1
run 7 "planes that leave nothing" "$TOOL" render v.npy -o p.png --clip 1,0,0,-1
says 'clip: no voxel is left'

# --- figures and movies -------------------------------------------------------
check "info counts what is inside" test \
    "$(figure finite v.npy --mask m.npy --labels 3)" = $((16 * 28 * 16))
check "with the values that are left" test \
    "$(figure sum v.npy --mask m.npy --labels 2,3)" = "$(figure sum two.npy)"
check "and the look is chosen of them alone" test \
    "$(figure look v.npy --mask m.npy --labels 2,3)" = "$(figure look two.npy)"
run 0 "a turntable" "$TOOL" turntable v.npy -q --no-labels -s 60x50 \
    --frames 2 -o 't_%d.png' --mask m.npy --labels 2-3
run 0 "of the volume masked by hand" "$TOOL" turntable two.npy --mask all.npy -q --no-labels \
    -s 60x50 --frames 2 -o 'u_%d.png'
check "is the same" cmp -s t_1.png u_1.png
run 0 "a movie of files" "$TOOL" movie v.npy v.nrrd -q --no-labels -s 60x50 \
    -o 'w_%d.png' --mask m.npy --labels 2-3
run 0 "of files masked by hand" "$TOOL" movie two.npy two.npy -q --no-labels --mask all.npy \
    -s 60x50 -o 'x_%d.png'
check "is the same" cmp -s w_1.png x_1.png

# --- light --------------------------------------------------------------------
# Matter of one value, and a ball of it: its middle faces a light at the eye, its
# rim does not.
python3 - <<'END'
import array
head = ("NRRD0004\ntype: uint8\ndimension: 3\nsizes: 28 28 28\nencoding: raw\n\n")
n = 28
even = bytearray(b"\x64" * n ** 3)
even[0], even[1] = 0, 200
ball = bytes((x - 13) ** 2 + (y - 14) ** 2 + (z - 13) ** 2 < 120
             for z in range(n) for y in range(n) for x in range(n))
open("even.nrrd", "wb").write(head.encode() + even)
open("ball.nrrd", "wb").write(head.encode() + ball)
nan = float("nan")
by_hand = array.array("f", (v if b else nan for v, b in zip(even, ball)))
open("hand.nrrd", "wb").write(head.replace("uint8", "float").replace(
    "encoding", "endian: little\nencoding").encode() + by_hand.tobytes())
grad = bytes(102 + 3 * (i % n) + i % 7 for i in range(n ** 3))
open("grad.nrrd", "wb").write(head.encode() + grad)
slope = bytes(60 + 2 * (i % n + i // n % n + i // n ** 2) for i in range(n ** 3))
open("slope.nrrd", "wb").write(head.encode() + slope)
# CT numbers, and the same with an offset, all outside the ball air.
for name, kind, offset in ("hu", "short", 0), ("offset", "ushort", 1024):
    ct = array.array("h", (offset + (40 + i % 9 if b else -1000)
                           for i, b in enumerate(ball)))
    open(name + ".nrrd", "wb").write(head.replace("uint8", kind).replace(
        "encoding", "endian: little\nencoding").encode() + ct.tobytes())
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
a = array.array("f", open("hand.npy", "rb").read()[-90 * 80 * 4 * 4:])
inside = [a[n] / a[n + 3] for n in range(4 * 90 * 40, 4 * 90 * 41, 4)
          if a[n + 3] > 0.95]
assert len(inside) > 20 and max(inside) < 1.1 * min(inside), inside'
done
for cut in "--mask ball.nrrd" "--clip 0,0,1,12"; do
    # shellcheck disable=SC2086
    run 0 "CT numbers with $cut" "$TOOL" render hu.nrrd $cut --preset ct-soft \
        -s 40x40 -o hu.png -y
    check "have no offset" bash -c "! grep -q 'have an offset' '$ERR'"
    # shellcheck disable=SC2086
    run 0 "those with an offset, with $cut" "$TOOL" render offset.nrrd $cut \
        --preset ct-soft -s 40x40 -o hu.png -y
    says 'if the values have an offset of 1024, give --range [0-9-]*,[0-9]*$'
done
run 0 "the look of what fills a mask" "$TOOL" render grad.nrrd --mask ball.nrrd \
    -s 40x40 -o grad.png -y
says 'light-grey'
run 0 "and of what planes cut, whose faces are not lit" "$TOOL" render slope.nrrd \
    --clip 1,0,0,14 -s 40x40 -o grad.png -y
says 'not shaded'
run 0 "the automatic look" "$TOOL" render even.nrrd --mask ball.nrrd -o auto.png
run 0 "a preset of Hounsfield units" "$TOOL" render even.nrrd --mask ball.nrrd \
    --preset ct-soft --range -200,300 -o preset.png

# --- recipes ------------------------------------------------------------------
run 0 "a recipe is saved" render v.npy -o j.npy --mask m.npy --labels 1,2-3 \
    --save-config j.json
check "with both keys" grep -q '"labels": "1,2-3"' j.json
run 0 "and taken" render --config j.json -o k.npy
check "gives the same" cmp -s j.npy k.npy
run 0 "other labels count more" render --config j.json -o l.npy --labels 2-3
run 0 "than those of the file" render --config j.json two.npy -o b.npy -y
check "and are heeded" cmp -s l.npy b.npy

# --- refused ------------------------------------------------------------------
refused 3 "another size" \
    'small.npy: the mask has 31x28x30 voxels, the volume 32x28x30' \
    "$TOOL" render v.npy -o z.png --mask small.npy
refused 3 "another size, where the boxes are alike" 'the mask has 31x28x30' \
    "$TOOL" render v.npy -o z.png --mask small.npy --crop 0:9,0:9,0:9
run 0 "a mask that is flipped is used as it is" \
    render place.nrrd -o f.png --mask flip.nrrd
run 0 "a mask in its place" render place.nrrd -o y.png --mask place.nrrd
run 0 "a mask without a place" render place.nrrd -o y2.png --mask m.npy
check "is believed" cmp -s y.png y2.png
refused 3 "no mask" 'none.nrrd: cannot be opened' \
    "$TOOL" info v.npy --mask none.nrrd
refused 2 "a raw mask" 'm.raw: .* snowglass convert makes' \
    "$TOOL" info v.npy --mask m.raw
mkfifo pipe
refused 2 "a pipe as a mask" '^snowglass: pipe: a mask is read from a file' \
    timeout 10 "$TOOL" info v.npy --mask pipe
refused 3 "a device as a mask" '/dev/zero: is a device' \
    "$TOOL" info v.npy --mask /dev/zero
mkdir empty
refused 3 "a folder without slices as a mask" 'empty: names no slices' \
    "$TOOL" info v.npy --mask empty
refused 2 "a mask from standard input" '^snowglass: -: a mask is read from' \
    "$TOOL" info v.npy --mask -
refused 2 "a box of standard input" 'with a mask both must be files' bash -c \
    "'$TOOL' info - --mask m.npy --crop 0:9,0:9,0:9 <v.npy"
refused 2 "NaN in integers" 'convert to float32, which has NaN' \
    "$TOOL" convert v.npy -o z.nrrd --as uint8 --mask m.npy
# 26880 voxels: of one byte, of the mask's and of floats.
refused 5 "both volumes count" 'need 157.5 KiB, over the --memory' \
    "$TOOL" render v.npy -o z.png -s 9x9 --mask m.npy --memory 100K
finish
