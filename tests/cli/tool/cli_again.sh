#!/bin/bash
# What is printed or saved gives the same picture, byte for byte, when it is
# used: the command of -v, the configuration, and the line of what was chosen.
. "$(dirname "$0")/../../support/shell.sh"

need_python

small="--dims 40x36x30 -s 64x60"
for phantom in cube head engine shells marschner-lobb turbulence; do
    again "$phantom" render a.png phantom:$phantom $small
done
python3 - <<'END'
import random
import struct
from volumes import nrrd
random.seed(5)
PLACE = ("space: left-posterior-superior",
         "space directions: (1.1,0,0) (0,0.9,0.1) (0,0,2)")

def volume(name, kind, code, values, sizes=(16, 14, 12)):
    nrrd(name + ".nrrd", sizes, struct.pack("<%d%s" % (len(values), code), *values),
         *PLACE, kind=kind)

grid = [(x, y, z) for z in range(12) for y in range(14) for x in range(16)]
ball = [(x - 8) ** 2 + (y - 7) ** 2 + (2 * z - 12) ** 2 for x, y, z in grid]
volume("ct", "int16", "h", [-1000 if r > 40 else 40 + r * 20 for r in ball])
volume("float", "float", "f", [1e5 + 0.01 * random.random() + 0.02 * (r < 30)
                               for r in ball])
volume("tiny", "double", "d", [1e-7 / (3.3 + r) for r in ball])
volume("constant", "uint8", "B", [7] * len(grid))
volume("noise", "uint16", "H", [random.randrange(65536) for _ in grid])
volume("spot", "uint16", "H", [65535 if n == 5432 else 100 + random.randrange(900)
                               for n in range(30 * 28 * 26)], (30, 28, 26))
volume("negative", "int8", "b", [max(-128, 100 - r) for r in ball])
END
for name in ct float tiny constant noise negative; do
    again "$name" render a.png $name.nrrd -s 60x64
done
again "a name with blanks" render "it's a.png" ct.nrrd -s 30x20
cp ct.nrrd ./-ct.nrrd
again "a name that begins with a dash" render a.png -s 30x20 ./-ct.nrrd
run 0 "after two dashes" "$TOOL" render -v -o dash.png -s 30x20 -- -ct.nrrd
says 'again: snowglass render ./-ct.nrrd --output'
again "a logarithm" render a.png tiny.nrrd --scale log
for mode in mean sum mip; do
    again "logarithms of $mode" render a.png float.nrrd -m $mode --scale log -c turbo \
        -s 200 --legend
    again "$mode, symmetric" render a.png float.nrrd -m $mode --scale symlog -c RdBu
done
again "a logarithm of a sum of zeros" render a.png negative.nrrd -m sum --scale log
again "a colour map" render a.png phantom:head $small -c viridis
again "opacities" render a.png phantom:head $small --opacity 10:0,200:0.7
again "opacities of a millimetre" render a.png phantom:head $small --spacing 3x3x3 \
    --config '{"opacity-unit": "mm"}'
again "a range" render a.png phantom:head $small --range p2,p98
again "a window" render a.png ct.nrrd -w 400,40
again "a look in a window" render a.png float.nrrd -w 0.017,100000.01
again "a look over percentiles" render a.png float.nrrd --range p7,p91.5
again "a preset" render a.png ct.nrrd --preset ct-bone
again "a preset in a window" render a.png ct.nrrd --preset ct-soft -w 900,100
again "a preset moved" render a.png ct.nrrd --preset ct-bone --range 89.5,1439.5
again "a preset of the object" render a.png phantom:head $small --preset mr-default
again "a surface" render a.png phantom:head $small -m iso --iso 60
# A voxel far brighter than all others; the command alone, and for another file.
for mode in mip minip mean sum; do
    again "mode $mode beside a hot voxel" render a.png spot.nrrd -m $mode -s 60x64
    check "$mode: its range is saved" grep -q '"range": \[[0-9]' first.json
done
again "mip in colours" render a.png spot.nrrd -m mip -s 60x64 -c viridis
again "mip of percentiles" render a.png spot.nrrd -m mip -s 60x64 --range p1,p99
again "means as floats" render a.npy spot.nrrd -m mean -s 60x64
again "mean of one value" render a.png constant.nrrd -m mean -s 60x64
again "a turntable of a mip" turntable 'f_%d.png' spot.nrrd -m mip -s 60x64 \
    --frames 2
again "mip" render a.png spot.nrrd -m mip -s 60x64
told "the range of a mip is saved for the next volume" '; grey 1[0-9][0-9]\.\.[0-9][0-9][0-9];' \
    "$TOOL" render -y noise.nrrd --config first.json -o n.png
again "floats" render a.npy phantom:shells $small --crop 2:30,:,: --clip 0,0,1,300
again "a camera" render a.png phantom:shells $small --position 500,-300.5,400 \
    --target 10,8,12 --up 0,1,0.25 --perspective 20 --background '#123' --legend
again "a turntable" turntable 'f_%d.png' phantom:head $small --frames 3
again "a turntable of its own speed" turntable 'f_%d.png' phantom:cube $small \
    --frames 2 --fps 12
cp ct.nrrd step_1.nrrd
cp negative.nrrd step_2.nrrd
again "a movie" movie 'f_%d.png' step_1.nrrd step_2.nrrd -s 40x40
if command -v ffmpeg >/dev/null; then
    again "a movie of few steps" movie a.mp4 step_1.nrrd step_2.nrrd -s 40x40
else
    skipped "a movie of few steps" "there is no ffmpeg"
fi
for steps in 1: -2:-1; do
    again "steps $steps" movie 'f_%d.png' step_1.nrrd step_2.nrrd step_2.nrrd -s 40x40 \
        --time=$steps
done

# --- the line of what was chosen ----------------------------------------------
# "light-grey 38.9..204; opacity 0 at 38.9, 0.25 at 64.4 (from the histogram)"
for name in phantom:head phantom:shells phantom:turbulence float.nrrd noise.nrrd; do
    run 0 "$name by itself" "$TOOL" render $name -o a.png -s 60x60 -y
    look=$(sed -n 's/.*; \([a-z-]* [^;]*; opacity [^(]*\) (.*/\1/p' "$ERR")
    opacity=$(sed 's/.*; opacity //;s/ *\([^ ,]*\) at \([^ ,]*\)/\2:\1/g' <<<"$look")
    range=$(sed 's/^[^ ]* \([^;]*\);.*/\1/;s/\.\./,/' <<<"$look")
    shade=phong
    grep -q 'not shaded' "$ERR" && shade=none
    run 0 "$name as it was reported" "$TOOL" render $name -o b.png -s 60x60 -y \
        -c "${look%% *}" --range "$range" --opacity "$opacity" --shade $shade
    check "$name: the same picture" cmp -s a.png b.png
done
told "CT by itself" '(ct-bone, for Hounsfield units)' "$TOOL" render ct.nrrd -o a.png -s 60x60 -y
for look in light-grey grey; do
    told "the look of the histogram is light, and not grey" "; $look [0-9.]*; opacity" \
        "$TOOL" render phantom:head -o a.png $small -y $([ $look = grey ] && echo -c grey)
done

# --- a preset that is squeezed, and one that is moved ---------------------------
told "a window" "the range squeezes or stretches the preset's own 150..1500 and its opacities" \
    "$TOOL" render ct.nrrd --preset ct-bone -w 400,40 -o a.png -y
says 'and its opacities; one of the same width moves them; opacity per voxel'
for range in "--range 150,1500" "-w 1350,825" "--range 150,1500 -c hot"; do
    run 0 "the preset's own, $range" "$TOOL" render ct.nrrd --preset ct-bone \
        $range -o b.png -y
    not_said squeezes
done
run 0 "a range that begins below the colours" "$TOOL" render ct.nrrd \
    --preset ct-cropped-volume-bone --range 90,1400 -o b.png -y
not_said squeezes
pairs png render -s 60x60 <<END
the preset over its own range | ct.nrrd --preset ct-bone | = | \
    ct.nrrd --preset ct-bone --range 150,1500
CT by itself is drawn by that preset | " | = | ct.nrrd
END
for range in "--range 150,1501" "--range 149,1500" "--range full" \
    "--range 150,1400 -c hot"; do
    told "another, $range" "squeezes or stretches the preset's own 150..1500" \
        "$TOOL" render ct.nrrd --preset ct-bone $range -o b.png -y
done
told "a range of the same width" 'bone 50\.\.1400; opacity 0 at 50, 0\.1 at 120, .*\(ct-bone\)' \
    "$TOOL" render ct.nrrd --preset ct-bone --range 50,1400 -o a.png -y
not_said squeezes

# --- what stands in the file ----------------------------------------------------
run 0 "a turntable is saved" "$TOOL" turntable -q phantom:cube $small \
    --frames 2 -o 'g_%d.png' --save-config turn.json
check "with its frames" grep -q '"frames": 2' turn.json
check "its verb" grep -q '"verb": "turntable"' turn.json
check "its version" grep -q '"version": "[0-9]' turn.json
check "and its look" grep -q '"colormap": "light-grey", "range": \[' turn.json
run 0 "the verb on the command line counts more" "$TOOL" render -q \
    --config turn.json -o one.png
check "one picture is made" [ -s one.png ]

# --- paths are those of the file's folder --------------------------------------
mkdir -p place/inner other
"$TOOL" convert -q phantom:cube --dims 20x18x16 -o place/in.nrrd
"$TOOL" convert -q phantom:cube --dims 20x18x16 -o place/mask.nrrd
echo '{"snowglass-tf": 1, "opacities": [[0, 0], [255, 0.5]]}' >place/tf.json
run 0 "saved elsewhere" "$TOOL" render -q place/in.nrrd --mask place/mask.nrrd \
    --tf place/tf.json -o place/out.png -s 40x40 --save-config place/inner/c.json
for key in input:in.nrrd mask:mask.nrrd tf:tf.json output:out.png; do
    check "${key%:*}" grep -q "\"${key%:*}\": \"../${key#*:}\"" place/inner/c.json
done
mv place/out.png place/first.png
(cd other && "$TOOL" -q --config ../place/inner/c.json)
check "taken from a third folder" cmp -s place/first.png place/out.png
mv place moved
rm moved/out.png
(cd moved && "$TOOL" -q --config inner/c.json)
check "and moved as a whole" cmp -s moved/first.png moved/out.png
run 0 "an output on the command line" "$TOOL" -q --config moved/inner/c.json \
    -o here.png
check "is in the working folder" cmp -s moved/first.png here.png
run 0 "a whole path stays" "$TOOL" render -q "$PWD/moved/in.nrrd" -o w.png \
    -s 9x9 --save-config moved/w.json
check "as it is" grep -q "\"input\": \"$PWD/moved/in.nrrd\"" moved/w.json
finish
