#!/bin/bash
# What is printed or saved gives the same picture, byte for byte, when it is
# used: the command of -v, the configuration, and the line of what was chosen.
. "$(dirname "$0")/../../support/shell.sh"

# The files of an output, which may be a pattern of frames.
outputs() { compgen -G "${1/\%d/?}"; }

# Renders with -v and a saved configuration, and repeats both.
again() {
    local name=$1 verb=$2 out=$3
    shift 3
    rm -rf first && mkdir first
    run 0 "$name" "$TOOL" "$verb" -v "$@" -o "$out" --save-config first.json -y
    local command
    command=$(sed -n 's/^snowglass: again: //p' "$ERR")
    check "$name: a command is printed" [ -n "$command" ]
    outputs "$out" | xargs -d '\n' mv -t first
    eval "\"\$TOOL\" ${command#snowglass } -q" || true
    local file
    for file in first/*; do
        check "$name: the command gives ${file##*/} again" \
            cmp -s "$file" "${file##*/}"
    done
    outputs "$out" | xargs -d '\n' rm -f .*.frames
    run 0 "$name: the configuration" "$TOOL" --config first.json -q
    for file in first/*; do
        check "$name: it gives ${file##*/} again" cmp -s "$file" "${file##*/}"
    done
    outputs "$out" | xargs -d '\n' rm -f .*.frames
}

small="--dims 40x36x30 -s 64x60"
for phantom in cube head engine shells marschner-lobb turbulence; do
    again "$phantom" render a.png phantom:$phantom $small
done
python3 - <<'END' || exit 77
import struct
import random
random.seed(5)
def volume(name, kind, code, values, sizes="16 14 12"):
    with open(name + ".raw", "wb") as out:
        out.write(struct.pack("<%d%s" % (len(values), code), *values))
    with open(name + ".nhdr", "w") as out:
        out.write("NRRD0004\ntype: %s\ndimension: 3\nsizes: %s\n"
                  "space: left-posterior-superior\n"
                  "space directions: (1.1,0,0) (0,0.9,0.1) (0,0,2)\n"
                  "encoding: raw\nendian: little\ndata file: %s.raw\n"
                  % (kind, sizes, name))
grid = [(x, y, z) for z in range(12) for y in range(14) for x in range(16)]
ball = [(x - 8) ** 2 + (y - 7) ** 2 + (2 * z - 12) ** 2 for x, y, z in grid]
volume("ct", "int16", "h", [-1000 if r > 40 else 40 + r * 20 for r in ball])
volume("float", "float", "f", [1e5 + 0.01 * random.random() + 0.02 * (r < 30)
                               for r in ball])
volume("tiny", "double", "d", [1e-7 / (3.3 + r) for r in ball])
volume("constant", "uint8", "B", [7] * len(grid))
volume("noise", "uint16", "H", [random.randrange(65536) for _ in grid])
volume("spot", "uint16", "H", [65535 if n == 5432 else 100 + random.randrange(900)
                               for n in range(30 * 28 * 26)], "30 28 26")
volume("negative", "int8", "b", [max(-128, 100 - r) for r in ball])
END
for name in ct float tiny constant noise negative; do
    again "$name" render a.png $name.nhdr -s 60x64
done
again "a name with blanks" render "it's a.png" ct.nhdr -s 30x20
cp ct.nhdr ./-ct.nhdr
again "a name that begins with a dash" render a.png -s 30x20 ./-ct.nhdr
run 0 "after two dashes" "$TOOL" render -v -o dash.png -s 30x20 -- -ct.nhdr
says 'again: snowglass render ./-ct.nhdr --output'
again "a logarithm" render a.png tiny.nhdr --scale log
for mode in mean sum mip; do
    again "logarithms of $mode" render a.png float.nhdr -m $mode --scale log -c turbo \
        -s 200 --legend
    again "$mode, symmetric" render a.png float.nhdr -m $mode --scale symlog -c RdBu
done
again "a logarithm of a sum of zeros" render a.png negative.nhdr -m sum --scale log
again "a colour map" render a.png phantom:head $small -c viridis
again "opacities" render a.png phantom:head $small --opacity 10:0,200:0.7
again "opacities of a millimetre" render a.png phantom:head $small --spacing 3x3x3 \
    --config '{"opacity-unit": "mm"}'
again "a range" render a.png phantom:head $small --range p2,p98
again "a window" render a.png ct.nhdr -w 400,40
again "a look in a window" render a.png float.nhdr -w 0.017,100000.01
again "a look over percentiles" render a.png float.nhdr --range p7,p91.5
again "a preset" render a.png ct.nhdr --preset ct-bone
again "a preset in a window" render a.png ct.nhdr --preset ct-soft -w 900,100
again "a preset moved" render a.png ct.nhdr --preset ct-bone --range 89.5,1439.5
again "a preset of the object" render a.png phantom:head $small --preset mr-default
for mode in mip minip mean sum "iso --iso 60"; do
    again "mode $mode" render a.png phantom:head $small -m $mode
done
# A voxel far brighter than all others; the command alone, and for another file.
for mode in mip minip mean sum; do
    again "mode $mode beside a hot voxel" render a.png spot.nhdr -m $mode -s 60x64
    check "$mode: its range is saved" grep -q '"range": \[[0-9]' first.json
done
again "mip in colours" render a.png spot.nhdr -m mip -s 60x64 -c viridis
again "mip of percentiles" render a.png spot.nhdr -m mip -s 60x64 --range p1,p99
again "means as floats" render a.npy spot.nhdr -m mean -s 60x64
again "mean of one value" render a.png constant.nhdr -m mean -s 60x64
again "a turntable of a mip" turntable 'f_%d.png' spot.nhdr -m mip -s 60x64 \
    --frames 2
run 0 "the range of a mip is saved" "$TOOL" render -q spot.nhdr -m mip -o m.png \
    --save-config mip.json -s 60x64
run 0 "for the next volume" "$TOOL" render -y noise.nhdr --config mip.json -o n.png
says '; grey 1[0-9][0-9]\.\.[0-9][0-9][0-9];'
again "floats" render a.npy phantom:shells $small --crop 2:30,:,: --clip 0,0,1,300
again "a camera" render a.png phantom:shells $small --position 500,-300.5,400 \
    --target 10,8,12 --up 0,1,0.25 --perspective 20 --background '#123' --legend
again "a turntable" turntable 'f_%d.png' phantom:head $small --frames 3
again "a turntable of its own speed" turntable 'f_%d.png' phantom:cube $small \
    --frames 2 --fps 12
cp ct.nhdr step_1.nhdr
cp negative.nhdr step_2.nhdr
again "a movie" movie 'f_%d.png' step_1.nhdr step_2.nhdr -s 40x40
if command -v ffmpeg >/dev/null; then
    again "a movie of few steps" movie a.mp4 step_1.nhdr step_2.nhdr -s 40x40
else
    skipped "a movie of few steps" "there is no ffmpeg"
fi
for steps in 1: -2:-1; do
    again "steps $steps" movie 'f_%d.png' step_1.nhdr step_2.nhdr step_2.nhdr -s 40x40 \
        --time=$steps
done

# --- the line of what was chosen ----------------------------------------------
# "light-grey 38.9..204; opacity 0 at 38.9, 0.25 at 64.4 (from the histogram)"
for name in phantom:head phantom:shells phantom:turbulence float.nhdr noise.nhdr; do
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
run 0 "CT by itself" "$TOOL" render ct.nhdr -o a.png -s 60x60 -y
says '(ct-bone, for Hounsfield units)'
run 0 "CT by that preset" "$TOOL" render ct.nhdr -o b.png -s 60x60 -y --preset ct-bone
check "the same picture" cmp -s a.png b.png
run 0 "the look of the histogram" "$TOOL" render phantom:head -o a.png $small -y
says '; light-grey [0-9.]*; opacity'
run 0 "is not grey" "$TOOL" render phantom:head -o b.png $small -y -c grey
says '; grey [0-9.]*; opacity'

# --- a preset that is squeezed, and one that is moved ---------------------------
run 0 "a window" "$TOOL" render ct.nhdr --preset ct-bone -w 400,40 \
    -o a.png -y
says "the range squeezes or stretches the preset's own 150..1500 and its opacities"
says 'and its opacities; one of the same width moves them; opacity per voxel'
for range in "--range 150,1500" "-w 1350,825" "--range 150,1500 -c hot"; do
    # shellcheck disable=SC2086
    run 0 "the preset's own, $range" "$TOOL" render ct.nhdr --preset ct-bone \
        $range -o b.png -y
    check "$range: no word on squeezing" bash -c "! grep -q squeezes '$ERR'"
done
run 0 "a range that begins below the colours" "$TOOL" render ct.nhdr \
    --preset ct-cropped-volume-bone --range 90,1400 -o b.png -y
check "no word on squeezing" bash -c "! grep -q squeezes '$ERR'"
run 0 "the preset alone" "$TOOL" render ct.nhdr --preset ct-bone -o a.png -y
run 0 "and over its own range" "$TOOL" render ct.nhdr --preset ct-bone \
    --range 150,1500 -o b.png -y
check "is the same picture" cmp -s a.png b.png
for range in "--range 150,1501" "--range 149,1500" "--range full" \
    "--range 150,1400 -c hot"; do
    # shellcheck disable=SC2086
    run 0 "another, $range" "$TOOL" render ct.nhdr --preset ct-bone $range \
        -o b.png -y
    says "squeezes or stretches the preset's own 150..1500"
done
run 0 "a range of the same width" "$TOOL" render ct.nhdr --preset ct-bone \
    --range 50,1400 -o a.png -y
says 'bone 50\.\.1400; opacity 0 at 50, 0\.1 at 120, .*\(ct-bone\)'
check "no word on squeezing" bash -c "! grep -q squeezes '$ERR'"

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
check "input" grep -q '"input": "../in.nrrd"' place/inner/c.json
check "mask" grep -q '"mask": "../mask.nrrd"' place/inner/c.json
check "tf" grep -q '"tf": "../tf.json"' place/inner/c.json
check "output" grep -q '"output": "../out.png"' place/inner/c.json
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
