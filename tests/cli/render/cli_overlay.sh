#!/bin/bash
# --overlay: a segmentation, or a second volume of values, in the first.
. "$(dirname "$0")/../../support/shell.sh"
command -v python3 >/dev/null || {
    skipped all "there is no python3"
    exit 77
}

render() { "$TOOL" render -q -s 60x50 "$@"; }

# A grey volume; labels on its grid, the same with x the other way; on a coarser
# grid; values.
"$TOOL" phantom head --dims 32x28x30 -o v.nrrd -q
python3 - <<'END'
nx, ny, nz = 32, 28, 30

def write(name, dims, steps, origin, voxels):
    text = ("NRRD0004\ntype: uint8\ndimension: 3\nsizes: %d %d %d\n" % dims +
            "space: RAS\nspace directions: (%g,0,0) (0,%g,0) (0,0,%g)\n" % steps +
            "space origin: (%g,%g,%g)\nencoding: raw\n" % origin)
    if name not in ("w.nrrd", "pet.nrrd", "same.nrrd"):  # labels, says the file
        text += "Segment0_LabelValue:=1\nSegment1_LabelValue:=3\n"
    text += "\n"
    open(name, "wb").write(text.encode() + bytes(voxels))

def label(x, y, z):
    return (3 <= x < 12 and 4 <= y < 14) + 3 * (18 <= x < 30 and 10 <= z < 20)

header, voxels = open("v.nrrd", "rb").read().split(b"\n\n", 1)
write("w.nrrd", (nx, ny, nz), (1, 1, 1), (5, 6, 7), voxels[:nx * ny * nz])
grid = [(x, y, z) for z in range(nz) for y in range(ny) for x in range(nx)]
write("seg.nrrd", (nx, ny, nz), (1, 1, 1), (5, 6, 7), [label(*p) for p in grid])
write("same.nrrd", (nx, ny, nz), (1, 1, 1), (5, 6, 7), [label(*p) for p in grid])
write("flip.nrrd", (nx, ny, nz), (-1, 1, 1), (5 + nx - 1, 6, 7),
      [label(nx - 1 - x, y, z) for x, y, z in grid])
write("one.nrrd", (nx, ny, nz), (1, 1, 1), (5, 6, 7),
      [3 * (label(*p) == 3) for p in grid])
write("coarse.nrrd", (16, 14, 15), (2, 2, 2), (5.5, 6.5, 7.5),
      [label(2 * x, 2 * y, 2 * z) for z in range(15) for y in range(14)
       for x in range(16)])
write("pet.nrrd", (16, 14, 15), (2, 2, 2), (5.5, 6.5, 7.5),
      [min(255, x * y + z * x) for z in range(15) for y in range(14)
       for x in range(16)])
END
"$TOOL" convert w.nrrd -o w.npy -q && rm v.nrrd

# A factor on all opacities.
for over in seg.nrrd pet.nrrd; do
    run 0 "$over" "$TOOL" render w.nrrd --overlay $over -o a.npy -s 60x50
    points=$(sed -n 's/.*overlay .*; opacity \(.*\) (from.*/\1/p' "$ERR" |
        awk -F ', ' '{for (n = 1; n <= NF; n++) {split($n, p, " at ")
            printf "%s%s:%.9g", (n > 1) ? "," : "", p[2], 0.5 * p[1]}}')
    run 0 "times 1" render w.nrrd --overlay $over --overlay-look 1 -o b.npy
    check "is the same" cmp -s a.npy b.npy
    run 0 "times 0.5" render w.nrrd --overlay $over --overlay-look 0.5 -o c.npy \
        --save-config half.json
    check "is another" [ -n "$(cmp a.npy c.npy)" ]
    run 0 "half at each point" render w.nrrd --overlay $over -o d.npy \
        --overlay-look "${points:-1:0.5,3:0.5}"
    check "is the same too" cmp -s c.npy d.npy
    check "is kept" grep -q '"overlay-look": "0.5"' half.json
    cp c.npy half.npy
    run 0 "its configuration" "$TOOL" --config half.json -q -y
    check "gives it again" cmp -s c.npy half.npy
    run 0 "a slice" "$TOOL" slice w.nrrd --overlay $over -q -o full.png
    run 0 "half of it" "$TOOL" slice w.nrrd --overlay $over -q -o half.png \
        --overlay-look 0.5
    check "is what it is by itself" cmp -s full.png half.png
    run 0 "less of it" "$TOOL" slice w.nrrd --overlay $over -q -o less.png \
        --overlay-look 0.25
    check "is fainter" [ -n "$(cmp full.png less.png)" ]
    rm ./*.npy full.png half.png less.png half.json
done
"$TOOL" convert w.nrrd -o w.npy -q
refused 2 "a factor of more than 1" 'is not a look; give COLOURS,RANGE,OPACITY' \
    "$TOOL" render w.nrrd --overlay seg.nrrd -o z.png --overlay-look 1.5
echo '{"input": "w.nrrd", "opacity": 0.5}' >f.json
refused 3 "one of the volume itself" '"opacity" must be \[\[value' \
    "$TOOL" render --config f.json -o z.png

# Three time steps of values, and their inverse.
python3 - <<'END'
import struct

def write(name, value):
    head = bytearray(352)
    struct.pack_into("<i", head, 0, 348)
    struct.pack_into("<8h", head, 40, 4, 12, 12, 12, 3, 1, 1, 1)
    struct.pack_into("<2h", head, 70, 2, 8)
    struct.pack_into("<8f", head, 76, 1, 1, 1, 1, 1, 1, 1, 1)
    struct.pack_into("<f", head, 108, 352)
    struct.pack_into("<h", head, 254, 1)  # an sform
    struct.pack_into("<12f", head, 280, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0)
    head[344:348] = b"n+1\0"
    open(name, "wb").write(bytes(head) + bytes(
        value(x, y, z, t) for t in range(3) for z in range(12)
        for y in range(12) for x in range(12)))

write("base.nii", lambda x, y, z, t: 40 + 9 * x + 3 * y + z + 20 * t)
write("over.nii", lambda x, y, z, t: 200 * (4 * t <= x < 4 * t + 4))
END
steps="--colormap grey --range 40,250 --opacity 40:0.1,250:0.4 --overlay-look 20,200,20:0,200:0.5"

run 0 "without" render w.nrrd -o none.npy
run 0 "labels" render w.nrrd --overlay seg.nrrd -o a.npy
check "are seen" [ -n "$(cmp none.npy a.npy)" ]
run 0 "labels that are flipped" render w.nrrd --overlay flip.nrrd -o b.npy
check "are the same" cmp -s a.npy b.npy
run 0 "with other threads" render w.nrrd --overlay seg.nrrd -o b.npy -y -j 5
check "too" cmp -s a.npy b.npy
run 0 "in plain C" render w.nrrd --overlay seg.nrrd -o b.npy -y --isa scalar
run 0 "the same for ever" render w.nrrd --overlay seg.nrrd -o c.npy --deterministic
run 0 "has both" "$TOOL" compare b.npy c.npy --tolerance 1/255
run 0 "one label" render w.nrrd --overlay seg.nrrd --labels 3 -o c.npy -y
run 0 "by itself" render w.nrrd --overlay one.nrrd -o d.npy
check "is picked" cmp -s c.npy d.npy
check "of two" [ -n "$(cmp a.npy c.npy)" ]
run 0 "a coarse one" "$TOOL" render w.nrrd --overlay coarse.nrrd -o e.npy -s 60x50
check "is resampled" grep -q "another grid .*nearest" "$ERR"
run 0 "depth" render w.nrrd --method raycast -o x.npy --depth x_depth.npy
run 0 "with an overlay" render w.nrrd --overlay seg.nrrd --method raycast \
    -o y.npy --depth y_depth.npy
check "is the volume's" cmp -s x_depth.npy y_depth.npy
run 0 "values" "$TOOL" render w.nrrd --overlay pet.nrrd -o f.png -s 60x50 \
    --overlay-look viridis,50,200,50:0,200:0.3 --save-config c.json
check "are resampled" grep -q "another grid .*linear" "$ERR"
check "have their look" grep -q "overlay pet.nrrd: viridis 50..200; opacity 0 at 50" "$ERR"
run 0 "from a file" "$TOOL" render --config c.json -o g.png -q
check "the same" cmp -s f.png g.png
run 0 "a turntable" "$TOOL" turntable w.nrrd --overlay seg.nrrd -o t_%d.png -q \
    --frames 2 -s 60x50
check "turns both" [ -n "$(cmp t_0.png t_1.png)" ]

# What a legend explains: labels of the overlay, or a bar for each volume.
for over in seg.nrrd pet.nrrd; do
    clear="--overlay $over --overlay-look 0 -s 200"
    # shellcheck disable=SC2086
    run 0 "$over, clear" render w.nrrd $clear -o clear.png
    run 0 "is not seen" render w.nrrd -s 200 -o plain.png
    run 0 "in the picture" "$TOOL" compare clear.png plain.png --tolerance 1/255
    # shellcheck disable=SC2086
    run 0 "but it is" render w.nrrd $clear --legend -o clear.png -y
    run 0 "in the legend" render w.nrrd -s 200 --legend -o plain.png -y
    run 6 "of the picture" "$TOOL" compare clear.png plain.png --tolerance 1/255
    # shellcheck disable=SC2086
    run 0 "and of a turn" "$TOOL" turntable w.nrrd $clear --legend -q \
        --frames 2 -o turn_%d.png
    check "which begins so" cmp -s clear.png turn_0.png
    rm clear.png plain.png turn_?.png
done

run 0 "a movie" "$TOOL" movie base.nii --overlay over.nii $steps -o m_%d.png -q -s 60x50
for t in 0 2; do
    run 0 "step $t" render base.nii --overlay over.nii $steps --time $t -o s_$t.png
    check "is of both" cmp -s m_$t.png s_$t.png
done
check "moves" [ -n "$(cmp s_0.png s_2.png)" ]
"$TOOL" convert over.nii -o still.nrrd -q
run 0 "one step" "$TOOL" movie base.nii --overlay still.nrrd $steps -o n_%d.png -s 60x50
check "is told once" [ "$(grep -c "overlay still" "$ERR")" = 1 ]
run 0 "by itself" render base.nii --overlay still.nrrd $steps --time 2 -o p.png
check "is in all steps" cmp -s n_2.png p.png
# Labels of three steps: a picture of one names its labels.
python3 - <<'END'
def write(name, value):
    text = ("NRRD0004\ntype: uint8\ndimension: 4\nsizes: 20 20 20 3\n"
            "kinds: domain domain domain time\nencoding: raw\n\n")
    open(name, "wb").write(text.encode() + bytes(
        value(x, y, z, t) for t in range(3) for z in range(20)
        for y in range(20) for x in range(20)))

write("ball.nrrd", lambda x, y, z, t: max(0, 250 - 3 * ((x - 10) ** 2 + (y - 10) ** 2)))
write("named.nrrd", lambda x, y, z, t: (t + 1) * (5 * t <= x < 5 * t + 8))
END
"$TOOL" convert named.nrrd --time 1 -o still.nrrd -q -y
for way in render "slice --axis y"; do
    # shellcheck disable=SC2086
    run 0 "$way of a step" "$TOOL" $way ball.nrrd --overlay named.nrrd --time 1 -s 200 \
        --legend -q -y -o a.png
    # shellcheck disable=SC2086
    run 0 "with its labels" "$TOOL" $way ball.nrrd --overlay still.nrrd --time 1 -s 200 \
        --legend -q -y -o b.png
    check "names them" cmp -s a.png b.png
    # shellcheck disable=SC2086
    run 0 "without names" "$TOOL" $way ball.nrrd --overlay still.nrrd --time 1 -s 200 \
        -q -y -o b.png
    check "shows the names" [ -n "$(cmp a.png b.png)" ]
done
run 0 "a movie of a step" "$TOOL" movie ball.nrrd --overlay named.nrrd --time 1 -s 200 \
    --legend -q -o one_%d.png
run 0 "with its labels" "$TOOL" movie ball.nrrd --overlay still.nrrd --time 1 -s 200 \
    --legend -q -o two_%d.png
check "names them" cmp -s one_0.png two_0.png
refused 3 "other steps" 'over.nii: holds 3 time steps, and the volume 1' \
    "$TOOL" render w.nrrd -o z.png --overlay over.nii

# Both are larger than the memory: slabs of both files.
python3 - <<'END'
n = 160
head = ("NRRD0004\ntype: uint8\ndimension: 3\nsizes: %d %d %d\nspace: RAS\n"
        "space directions: (1,0,0) (0,1,0) (0,0,1)\nencoding: raw\n" % (n, n, n))

def row(y, z):
    low, high = 1 if y > 50 else 0, 3 if 40 <= z < 110 else 0
    return bytes([low]) * 60 + bytes(30) + bytes([high]) * 70

open("parts.nrrd", "wb").write(
    (head + "Segment0_LabelValue:=1\nSegment1_LabelValue:=3\n\n").encode() +
    b"".join(row(y, z) for z in range(n) for y in range(n)))
ramp = [bytes(min(255, abs(x - 80) + d) for x in range(n)) for d in range(256)]
open("large.nrrd", "wb").write(head.encode() + b"\n" + b"".join(
    ramp[(abs(y - 80) + abs(z - 80))] for z in range(n) for y in range(n)))
END
fog="large.nrrd --overlay parts.nrrd --range 20,250 --opacity 20:0,250:0.05"
# shellcheck disable=SC2086
run 0 "both in memory" render $fog -o in.npy -y
# shellcheck disable=SC2086
run 0 "both in their files" "$TOOL" render $fog -o out.npy -y -s 60x50 \
    --memory 7000K -v --stats out.json
check "in slabs" grep -q "large.nrrd: stays in its file" "$ERR"
check "are the same" cmp -s in.npy out.npy
check "take no more" [ "$(grep -o '"peak": [0-9]*' out.json |
    grep -o '[0-9]*')" -le 7168000 ]
check "of two of 8000K" [ "$(cat large.nrrd parts.nrrd | wc -c)" -gt 8190000 ]

run 0 "labels of values" render w.nrrd --mask seg.nrrd --labels 3 --overlay pet.nrrd -o q.npy
run 0 "picked before" render w.nrrd --mask one.nrrd --overlay pet.nrrd -o r.npy
check "are the mask's" cmp -s q.npy r.npy
run 0 "a label that is not there" "$TOOL" render w.nrrd --overlay seg.nrrd --labels 7 -o u.npy
check "is told" grep -q "seg.nrrd: no voxel has a label of --labels 7; there are 1, 3" "$ERR"
echo '{"overlay": "seg.nrrd", "labels": "3"}' >o.json
run 0 "a slice by its recipe" "$TOOL" slice w.nrrd --config o.json -o slice.png
run 0 "by its options" "$TOOL" slice w.nrrd -o plain.png -q --overlay one.nrrd
check "shows the label" cmp -s slice.png plain.png
run 0 "figures by its recipe" "$TOOL" info w.nrrd --config o.json
check "have no overlay" grep -q "note: the overlay .*seg.nrrd is not shown" "$ERR"
for axis in axial x; do
    run 0 "a slice across $axis" "$TOOL" slice w.nrrd -o by.png -y --axis $axis \
        --overlay pet.nrrd --save-config by.json -v
    command=$(sed -n 's/^snowglass: again: //p' "$ERR")
    cp by.png first.png
    rm by.png
    eval "\"\$TOOL\" ${command#snowglass } -q"
    check "its command gives it again" cmp -s first.png by.png
    run 0 "by its configuration" "$TOOL" --config by.json -q -y
    check "the same" cmp -s first.png by.png
    "$TOOL" slice - --axis $axis --overlay pet.nrrd -o by.png -y -q <w.nrrd
    check "through a pipe" cmp -s first.png by.png
    rm first.png by.png by.json
done

# The same voxels without a place, of parts of the volume.
"$TOOL" convert same.nrrd -o same.npy -q
for way in "slice --axis axial" "slice --axis x --at 20" \
    "slice --axis coronal --crop 3:30,2:20,5:29" "render -s 60x50 --crop 3:30,2:20,5:29"; do
    # shellcheck disable=SC2086
    run 0 "$way, with a place" "$TOOL" $way w.nrrd --overlay same.nrrd -o placed.png -q -y
    # shellcheck disable=SC2086
    run 0 "without one" "$TOOL" $way w.nrrd --overlay same.npy -o placeless.png -q -y
    check "is the same" cmp -s placed.png placeless.png
    case $way in *--crop*)
        # shellcheck disable=SC2086
        "$TOOL" ${way/ / - } --overlay same.npy -o placeless.png -y <w.nrrd 2>"$ERR"
        check "through a pipe too" cmp -s placed.png placeless.png
        check "with a note" grep -q "same.npy: has no place, and is taken" "$ERR"
        ;;
    esac
done

# Neither has a place, and the voxels have other sides: their crops have offsets, which are
# no places.
for name in w same; do
    printf '%s\n' NRRD0004 'type: uint8' 'dimension: 3' 'sizes: 32 28 30' \
        'spacings: 0.5 0.5 0.9' 'encoding: raw' '' >$name-half.nrrd
    tail -c $((32 * 28 * 30)) $name.npy >>$name-half.nrrd
done
for way in "slice --axis y" "slice --axis x --at 20 --crop 3:30,2:20,5:29" \
    "render -s 60x50" "render -s 60x50 --crop 3:30,2:20,5:29"; do
    # shellcheck disable=SC2086
    run 0 "$way of flat voxels" "$TOOL" $way w-half.nrrd --overlay same-half.nrrd \
        -o flat.png -q -y
    # shellcheck disable=SC2086
    run 0 "with cubes" "$TOOL" $way w-half.nrrd --overlay same.npy -o cubes.png -y
    check "is the same" cmp -s flat.png cubes.png
    check "nothing is resampled" bash -c "! grep -q 'another grid' '$ERR'"
done
"$TOOL" render - --crop 3:30,2:20,5:29 --overlay pet.nrrd -o z.png <w.npy 2>"$ERR"
check "one of other voxels is refused there" grep -q "the overlay has 16x14x15 voxels" "$ERR"
run 0 "a slice with a place" "$TOOL" slice w.nrrd --axis x --overlay same.nrrd -o placed.png -q -y
"$TOOL" slice - --axis x --overlay same.npy -o placeless.png -y -q <w.nrrd
check "is that without one, through a pipe" cmp -s placed.png placeless.png
refused 3 "one of other voxels" 'the overlay has 16x14x15 voxels' \
    "$TOOL" slice w.npy -o z.png --overlay pet.nrrd

refused 2 "a look of none" 'is of an overlay; give --overlay FILE too' \
    "$TOOL" render w.nrrd -o z.png --overlay-look 1,2
mkfifo pipe
refused 2 "a pipe" 'pipe: an overlay is read from a file; write it to one' \
    "$TOOL" render w.nrrd -o z.png --overlay pipe --labels 1
refused 2 "standard input" 'an overlay is read from a file' \
    "$TOOL" slice w.nrrd -o z.png --overlay -
refused 2 "another mode" 'overlay: needs mode over' \
    "$TOOL" render w.nrrd -o z.png --overlay seg.nrrd -m mip
refused 2 "another method" 'needs method shear-warp or raycast; remove --method footprint' \
    "$TOOL" render w.nrrd -o z.png --overlay seg.nrrd --method footprint
refused 2 "another kernel" 'overlay: needs kernel tent or bspline; remove --kernel box' \
    "$TOOL" render w.nrrd -o z.png --overlay seg.nrrd --kernel box
refused 3 "another size without a place" 'the overlay has .* resample' \
    "$TOOL" render seg.nrrd -o z.png --overlay phantom:marschner-lobb
finish
