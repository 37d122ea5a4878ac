#!/bin/bash
# --overlay: a segmentation, or a second volume of values, in the first.
. "$(dirname "$0")/../../support/shell.sh"
need_python

render() { "$TOOL" render -q -y -s 60x50 "$@"; }

# A grey volume; labels on its grid, the same with x the other way; on a coarser
# grid; values; and the same without a place, of voxels that are no cubes.
"$TOOL" phantom head --dims 32x28x30 -o v.npy -q
python3 - <<'END'
from volumes import each, labels, nifti, npy, nrrd, placed

dims, coarse = (32, 28, 30), (16, 14, 15)
fine, wide = placed((1, 1, 1), (5, 6, 7)), placed((2, 2, 2), (5.5, 6.5, 7.5))
flat = ("spacings: 0.5 0.5 0.9",)

def label(x, y, z):
    return (3 <= x < 12 and 4 <= y < 14) + 3 * (18 <= x < 30 and 10 <= z < 20)

head, parts = open("v.npy", "rb").read()[-32 * 28 * 30:], each(dims, label)
nrrd("w.nrrd", dims, head, *fine)
nrrd("w-half.nrrd", dims, head, *flat)
nrrd("seg.nrrd", dims, parts, *fine, *labels(1, 3))
nrrd("same.nrrd", dims, parts, *fine)
nrrd("same-half.nrrd", dims, parts, *flat)
for name, voxels in ("w.npy", head), ("same.npy", parts):
    npy(name, "|u1", dims[::-1], voxels)
nrrd("flip.nrrd", dims, each(dims, lambda x, y, z: label(31 - x, y, z)),
     *placed((-1, 1, 1), (36, 6, 7)), *labels(1, 3))
nrrd("one.nrrd", dims, each(dims, lambda x, y, z: 3 * (label(x, y, z) == 3)),
     *fine, *labels(1, 3))
nrrd("coarse.nrrd", coarse, each(coarse, lambda x, y, z: label(2 * x, 2 * y, 2 * z)),
     *wide, *labels(1, 3))
nrrd("pet.nrrd", coarse, each(coarse, lambda x, y, z: min(255, x * y + z * x)), *wide)

# Three time steps of values and their inverse, of labels over a ball.
steps, many = (12, 12, 12, 3), (20, 20, 20, 3)
for name, value in (
        ("base.nii", lambda x, y, z, t: 40 + 9 * x + 3 * y + z + 20 * t),
        ("over.nii", lambda x, y, z, t: 200 * (4 * t <= x < 4 * t + 4))):
    nifti(name, steps, (2, 8), each(steps, value),
          sform=(1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0))
for name, value in (
        ("ball.nrrd", lambda x, y, z, t: max(0, 250 - 3 * ((x - 10) ** 2 + (y - 10) ** 2))),
        ("named.nrrd", lambda x, y, z, t: (t + 1) * (5 * t <= x < 5 * t + 8))):
    nrrd(name, many, each(many, value), "kinds: domain domain domain time")

# Two that are larger than the memory.
n = 160
place = placed((1, 1, 1), (0, 0, 0))
nrrd("parts.nrrd", (n,) * 3, b"".join(
    bytes([y > 50]) * 60 + bytes(30) + bytes([3 * (40 <= z < 110)]) * 70
    for z in range(n) for y in range(n)), *place, *labels(1, 3))
ramp = [bytes(min(255, abs(x - 80) + d) for x in range(n)) for d in range(256)]
nrrd("large.nrrd", (n,) * 3, b"".join(
    ramp[abs(y - 80) + abs(z - 80)] for z in range(n) for y in range(n)), *place)
END

# A factor on all opacities.
for over in seg.nrrd pet.nrrd; do
    run 0 "$over" "$TOOL" render w.nrrd --overlay $over -o a.npy -s 60x50 -y
    points=$(sed -n 's/.*overlay .*; opacity \(.*\) (from.*/\1/p' "$ERR" |
        awk -F ', ' '{for (n = 1; n <= NF; n++) {split($n, p, " at ")
            printf "%s%s:%.9g", (n > 1) ? "," : "", p[2], 0.5 * p[1]}}')
    pairs npy render w.nrrd -s 60x50 --overlay $over <<END
$over times 1 | | = | --overlay-look 1
$over times 0.5 | --overlay-look 0.5 | != |
$over, half at each point | " | = | --overlay-look ${points:-1:0.5,3:0.5}
END
    pairs png slice w.nrrd --overlay $over <<END
a slice, where half of $over is what it is by itself | | = | --overlay-look 0.5
less of it | " | != | --overlay-look 0.25
END
done
run 0 "half" render w.nrrd --overlay pet.nrrd --overlay-look 0.5 -o half.npy --save-config half.json
check "is kept" grep -q '"overlay-look": "0.5"' half.json
cp half.npy kept.npy
run 0 "its configuration" "$TOOL" --config half.json -q -y
same_file "gives it again" kept.npy half.npy
refused 2 "a factor of more than 1" 'is not a look; give COLOURS,RANGE,OPACITY' \
    "$TOOL" render w.nrrd --overlay seg.nrrd -o z.png --overlay-look 1.5
echo '{"input": "w.nrrd", "opacity": 0.5}' >f.json
refused 3 "one of the volume itself" '"opacity" must be \[\[value' \
    "$TOOL" render --config f.json -o z.png

# Pictures of both.
pairs npy render w.nrrd -s 60x50 <<END
labels are seen | --overlay seg.nrrd | != |
flipped | " | = | --overlay flip.nrrd
with other threads | " | = | --overlay seg.nrrd -j 5
the same for ever | --overlay seg.nrrd --isa scalar | 1/255 | --overlay seg.nrrd --deterministic
one label | --overlay seg.nrrd --labels 3 | = | --overlay one.nrrd
of two | " | != | --overlay seg.nrrd
labels are the mask's | --mask seg.nrrd --labels 3 --overlay pet.nrrd | = | --mask one.nrrd --overlay pet.nrrd
END
told "a coarse one" "another grid .*nearest" \
    "$TOOL" render w.nrrd --overlay coarse.nrrd -o e.npy -s 60x50
told "values" "another grid .*linear" "$TOOL" render w.nrrd --overlay pet.nrrd -o f.png \
    -s 60x50 --overlay-look viridis,50,200,50:0,200:0.3 --save-config c.json
says "overlay pet.nrrd: viridis 50..200; opacity 0 at 50"
run 0 "from a file" "$TOOL" render --config c.json -o g.png -q
same_file "the same" f.png g.png
run 0 "depth" render w.nrrd --method raycast -o x.npy --depth x_depth.npy
run 0 "with an overlay" render w.nrrd --overlay seg.nrrd --method raycast \
    -o y.npy --depth y_depth.npy
same_file "is the volume's" x_depth.npy y_depth.npy
run 0 "a turntable" "$TOOL" turntable w.nrrd --overlay seg.nrrd -o t_%d.png -q \
    --frames 2 -s 60x50
other_file "turns both" t_0.png t_1.png

# What a legend explains: labels of the overlay, or a bar for each volume.
for over in seg.nrrd pet.nrrd; do
    clear="--overlay $over --overlay-look 0"
    pairs png render w.nrrd -s 200 <<END
$over, clear, is not seen in the picture | $clear | 1/255 |
but in the legend | $clear --legend | >1/255 | --legend
END
    run 0 "and of a turn" "$TOOL" turntable w.nrrd $clear -s 200 --legend -q -y \
        --frames 2 -o turn_%d.png
    same_file "which begins so" .one.png turn_0.png
done

# Steps.
steps="--colormap grey --range 40,250 --opacity 40:0.1,250:0.4 --overlay-look 20,200,20:0,200:0.5"
run 0 "a movie" "$TOOL" movie base.nii --overlay over.nii $steps -o m_%d.png -q -s 60x50
for t in 0 2; do
    run 0 "step $t" render base.nii --overlay over.nii $steps --time $t -o s_$t.png
    same_file "is of both" m_$t.png s_$t.png
done
other_file "moves" s_0.png s_2.png
"$TOOL" convert over.nii -o still.nrrd -q
run 0 "one step" "$TOOL" movie base.nii --overlay still.nrrd $steps -o n_%d.png -s 60x50
check "is told once" [ "$(grep -c "overlay still" "$ERR")" = 1 ]
run 0 "by itself" render base.nii --overlay still.nrrd $steps --time 2 -o p.png
same_file "is in all steps" n_2.png p.png
# A picture of one step names its labels.
"$TOOL" convert named.nrrd --time 1 -o still.nrrd -q -y
for way in render "slice --axis y"; do
    pairs png $way ball.nrrd --time 1 -s 200 <<END
$way names the labels of a step | --overlay named.nrrd --legend | = | --overlay still.nrrd --legend
$way shows the names | " | != | --overlay still.nrrd
END
done
for name in named still; do
    run 0 "a movie of a step, $name" "$TOOL" movie ball.nrrd --overlay $name.nrrd --time 1 \
        -s 200 --legend -q -o ${name}_%d.png
done
same_file "names its labels" named_0.png still_0.png
# The name of an overlay's file, which may be a patient's, is in no picture.
for name in doe_jane other; do
    cp ball.nrrd $name.nrrd
done
for way in render "slice --axis y"; do
    pairs png $way ball.nrrd --overlay-look hot --legend -s 300 <<END
$way names no file | --overlay doe_jane.nrrd | = | --overlay other.nrrd
END
done
refused 3 "other steps" 'over.nii: holds 3 time steps, and the volume 1' \
    "$TOOL" render w.nrrd -o z.png --overlay over.nii

# Both are larger than the memory: slabs of both files.
fog="large.nrrd --overlay parts.nrrd --range 20,250 --opacity 20:0,250:0.05"
run 0 "both in memory" render $fog -o in.npy
told "both in their files" "large.nrrd: stays in its file" \
    "$TOOL" render $fog -o out.npy -s 60x50 --memory 7000K -v --stats out.json
same_file "are the same" in.npy out.npy
check "take no more" [ "$(grep -o '"peak": [0-9]*' out.json |
    grep -o '[0-9]*')" -le 7168000 ]

# Recipes and slices.
told "a label that is not there" "seg.nrrd: no voxel has a label of --labels 7; there are 1, 3" \
    "$TOOL" render w.nrrd --overlay seg.nrrd --labels 7 -o u.npy
echo '{"overlay": "seg.nrrd", "labels": "3"}' >o.json
pairs png slice w.nrrd <<END
a slice by its recipe | --config o.json | = | --overlay one.nrrd
END
told "figures by its recipe" "note: the overlay .*seg.nrrd is not shown" \
    "$TOOL" info w.nrrd --config o.json
for axis in axial x; do
    run 0 "a slice across $axis" "$TOOL" slice w.nrrd -o by.png -y --axis $axis \
        --overlay pet.nrrd --save-config by.json -v
    command=$(sed -n 's/^snowglass: again: //p' "$ERR")
    mv by.png first.png
    eval "\"\$TOOL\" ${command#snowglass } -q"
    same_file "its command gives it again" first.png by.png
    run 0 "by its configuration" "$TOOL" --config by.json -q -y
    same_file "the same" first.png by.png
    "$TOOL" slice - --axis $axis --overlay pet.nrrd -o by.png -y -q <w.nrrd
    same_file "through a pipe" first.png by.png
    rm first.png by.json
done

# The same voxels without a place, of parts of the volume, and of other sides, whose
# crops have offsets, which are no places.
for way in "slice --axis axial" "slice --axis x --at 20" \
    "slice --axis coronal --crop 3:30,2:20,5:29" "render -s 60x50" \
    "render -s 60x50 --crop 3:30,2:20,5:29"; do
    pairs png $way <<END
$way, without a place | w.nrrd --overlay same.nrrd | = | w.nrrd --overlay same.npy
$way, of flat voxels | w-half.nrrd --overlay same-half.nrrd | = | w-half.nrrd --overlay same.npy
END
    run 0 "$way, aloud" "$TOOL" $way w-half.nrrd --overlay same.npy -o cubes.png -y
    not_said 'another grid'
    case $way in *--crop*)
        run 0 "with a place" "$TOOL" $way w.nrrd --overlay same.nrrd -o placed.png -q -y
        "$TOOL" ${way/ / - } --overlay same.npy -o placeless.png -y <w.nrrd 2>"$ERR"
        same_file "through a pipe too" placed.png placeless.png
        check "with a note" grep -q "same.npy: has no place, and is taken" "$ERR"
        ;;
    esac
done
"$TOOL" render - --crop 3:30,2:20,5:29 --overlay pet.nrrd -o z.png <w.npy 2>"$ERR"
check "one of other voxels is refused there" grep -q "the overlay has 16x14x15 voxels" "$ERR"

mkfifo pipe
refusals 2 "$TOOL" <<'END'
render w.nrrd -o z.png --overlay-look 1,2|is of an overlay; give --overlay FILE too
render w.nrrd -o z.png --overlay pipe --labels 1|pipe: an overlay is read from a file; write it to one
slice w.nrrd -o z.png --overlay -|an overlay is read from a file
render w.nrrd -o z.png --overlay seg.nrrd -m mip|overlay: needs mode over
render w.nrrd -o z.png --overlay seg.nrrd --method footprint|needs method shear-warp or raycast; remove --
render w.nrrd -o z.png --overlay seg.nrrd --kernel box|overlay: needs kernel tent or bspline; remove --kernel box
END
refusals 3 "$TOOL" <<'END'
slice w.npy -o z.png --overlay pet.nrrd|the overlay has 16x14x15 voxels
render seg.nrrd -o z.png --overlay phantom:marschner-lobb|the overlay has .* resample
END
finish
