#!/bin/bash
# Pictures of every phantom, in every format; figures; streams; the promises of
# equality between encodings and methods.
. "$(dirname "$0")/../../support/shell.sh"

# Every phantom gives a picture that differs from an empty one.
for name in cube head engine shells marschner-lobb turbulence; do
    small="phantom:$name --dims 24x24x20 -s 40x30"
    run 0 "phantom:$name" "$TOOL" $small -o $name.png
    check "phantom:$name is a PNG" is_png $name.png
    says "phantom:$name: phantom 24x24x20"
    run 7 "phantom:$name made transparent" "$TOOL" $small -o empty_$name.png \
        --opacity 0:0
    run 6 "phantom:$name shows something" \
        "$TOOL" compare $name.png empty_$name.png
done
run 0 "two transparent pictures" \
    "$TOOL" compare empty_cube.png empty_head.png

small="phantom:shells --dims 24x24x20 -s 40x30"
render() { "$TOOL" $small "$@"; }

run 0 "-q is silent" render -q -o quiet.png
silent
told "one line without -q" "view \+z; method shear-warp, encoding (crs|bitmap|rle)" \
    render -o said.png
check "it is one line" [ "$(wc -l <"$ERR")" -eq 1 ]
while IFS='|' read -r words pattern; do
    run 7 "nothing is visible: $words" render -y -o void.png $words
    says "^snowglass: note: the picture is empty: $pattern"
done <<'END'
--opacity 900:0,901:1|no voxel has an opacity
--target 5000,0,0|no visible voxel is in view
-m iso --iso 900|no surface of value 900 
END
check "it is written" is_png void.png
run 7 "quietly, with its figures and configuration" render -q -y -o void.png \
    --opacity 900:0,901:1 --stats void.json --save-config void.config
silent
check "which are written" [ -s void.json -a -s void.config ]
run 0 "a mean of nothing is a picture of values" render -q -y -o void.npy \
    -m mean --opacity 900:0,901:1
"$TOOL" phantom cube --dims 1x9x9 -q -o slice.nrrd
for view in "" +z; do
    told "a slice from its face, or ${view:-as it is}" "^snowglass: .*view \\${view:-+x}; " \
        "$TOOL" render slice.nrrd -s 20x20 -y -o void.png ${view:+--view $view}
done
told "-v tells more" "^snowglass: seconds: read" render -v -o more.png
says "^snowglass: bytes: volume"
told "--progress always" "^snowglass: rendering$" render --progress always -o p.png
run 0 "the last of -v -q counts" render -v -q -o r.png
silent

# The options of every topic are taken, and those that must change the picture
# do.
small="$small --fit volume" # one place of the object for all looks
run 0 "a picture to begin with" render -q -o base.npy
changes() {
    rm -f changed.npy
    run 0 "render $*" render -q -o changed.npy "$@"
    run 6 "$* changes the picture" "$TOOL" compare base.npy changed.npy
}
same() {
    rm -f same.npy
    run 0 "render $*" render -q -o same.npy "$@"
    run 0 "$* does not change the picture" "$TOOL" compare base.npy same.npy
}
near() {
    tolerance=$1
    shift
    rm -f near.npy
    run 0 "render $*" render -q -o near.npy "$@"
    run 0 "$* is within $tolerance of the picture" \
        "$TOOL" compare base.npy near.npy --tolerance "$tolerance"
}
changes --azimuth -30
changes --elevation 20
changes --roll 15
changes --zoom 2
changes --fit visible
changes --perspective
changes --perspective 60
changes --view left
changes --view -z
changes --threshold 60
changes --kernel bspline
same --kernel tent
changes --kernel gauss
changes --kernel box
changes --kernel auto:3
changes --colormap viridis
changes --preset linear
changes --opacity 0:0,1:0.1
changes --gradient-opacity 0:0,0.5:1
same --gradient-opacity 0:1,255:1
changes --range p20,p60
changes --range full --opacity 0:0.1
changes --window 1,0.5
changes --config '{"opacity-unit": "mm"}' --spacing 2x2x2
changes --shade none
changes --light 60,30
changes --light head
same --light key
changes --material 0.6,0.7,0.2,20
changes --material 0.2,0.1,0.2,20
changes --material 0.2,0.7,0.9,20
changes --material 0.2,0.7,0.2,3
same --material 0.2,0.7,0.2,20
for way in depth-darkening occlusion; do
    for strength in 0 0.5 1; do
        run 0 "an engine, $way $strength" "$TOOL" phantom:engine -y \
            --dims 128x128x56 -s 96x96 -o "dark$strength.npy" \
            --$way "$strength"
    done
    run 6 "$way shows" "$TOOL" compare dark0.npy dark0.5.npy
    run 6 "by as much as is asked" "$TOOL" compare dark0.5.npy dark1.npy
    run 0 "wholly without a number" "$TOOL" phantom:engine -y \
        --dims 128x128x56 -s 96x96 -o dark.npy --$way
    run 0 "as by 1" "$TOOL" compare dark1.npy dark.npy
    same --$way 0
done
changes --spacing 1x1x3
same -m over
same -j 1
near 0.004 --deterministic
near 1e-5 --isa scalar
same -j 2
same -j 7
near 0.1 --quality draft
near 0.5 --quality high
same --no-labels
same --progress never
same --encoding crs
same --encoding bitmap
same --encoding rle
near 0.5 --method raycast
changes --method footprint
run 0 "the exact picture" render -q -o exact.npy --method footprint \
    --isa scalar
run 0 "the original one" render -q -o original.npy --method original
run 0 "they are one" "$TOOL" compare exact.npy original.npy
same --azimuth 50 --azimuth 0
same --size 9x9 -s 40x30

# The number behind --perspective may be left out, and is only a number.
pairs npy $small <<END
an eye of 30 degrees | --perspective | = | --perspective 30
with = | " | = | --perspective=30
the last counts | " | = | --perspective=60 --perspective
near a ray caster | " | 0.5 | --perspective --method raycast
exact and original | --perspective --method footprint | = | --perspective --method original
END
size="--dims 24x24x20 -s 40x30 --fit volume"
pairs npy <<END
an input behind it is no number | render --perspective phantom:shells $size | = | \
    render phantom:shells --perspective $size
a number and an input are told apart | " | = | render --perspective 30 phantom:shells $size
END

# The smallest volumes there are; the sanitizers look on.
for dims in 1x1x1 1x1x100 1x100x1 100x1x1; do
    run 0 "a volume of $dims" \
        "$TOOL" -q phantom:engine --dims $dims -s 32x32 -o tiny.npy -y
done

# Streams and formats.
run 0 "the picture to standard output" render -q -o - --background none
check "is a PNG" is_png "$OUT"
cp "$OUT" stream.png
run 0 "the same to a file" render -q -o stream_file.png --background none
same_file "is the same, byte for byte" stream.png stream_file.png
run 0 "16 bits" render -q -o deep.png --bits 16 --background none
run 0 "16 bits are near the floats" \
    "$TOOL" compare base.npy deep.png --tolerance 0.001
run 0 "8 bits are near the floats" \
    "$TOOL" compare base.npy stream.png --tolerance 1/255
pairs png $small <<'END'
a background shows | --background '#ff8000' | != | --background none
another differs from it | " | != | --background navy
the same in words of numbers | " | = | --background 1,0.50196,0
END
run 0 "PFM" render -q -o base.pfm
check "PFM begins with PF" [ "$(head -c 2 base.pfm)" = PF ]
check "NPY has its floats" \
    [ "$(wc -c <base.npy)" -eq $((128 + 40 * 30 * 16)) ]
run 0 "options after the operand, -- before it" \
    "$TOOL" -q -s 9x9 --dims 8x8x8 -o dash.png -- phantom:cube
raw_cube cube.raw 8
raw="--dims 8x8x8 --type uint8"
gzip -k cube.raw
run 0 "a raw file" "$TOOL" -q cube.raw $raw -s 20x20 -o raw.npy
check "standard input" bash -c \
    "'$TOOL' -q - $raw -s 20x20 -o stdin.npy <cube.raw"
same_file "gives the same picture" raw.npy stdin.npy
run 0 "a raw file in gzip" "$TOOL" -q cube.raw.gz $raw -s 20x20 -o gz.npy
same_file "gives the same picture" raw.npy gz.npy

# The figures.
run 0 "figures to standard output" render -q -o f.png --threshold 10 \
    --encoding rle --stats -
check "are one line" [ "$(wc -l <"$OUT")" -eq 1 ]
prints '^\{"version": "[0-9.]+", "volume": \{"dims": \[24, 24, 20\], "type": "[a-z0-9]+", "spacing": \[[-0-9.e]+, [-0-9.e]+, [-0-9.e]+\]\}, "threshold": 10.0, "sparse_ratio": [0-9.e-]+, "encoding": "rle", "method": "shear-warp", "kernel": "tent", "footprint": 2, "threads": [0-9]+, "ranks": 1, "load": 1.0, "isa": "[a-z0-9]+", "quality": "normal", "bytes": \{"volume": [0-9]+, "ea": [0-9]+, "ia": [0-9]+, "pa": [0-9]+, "peak": [0-9]+\}, "seconds": \{"read": [-0-9.e]+, "classify": [-0-9.e]+, "shade": [-0-9.e]+, "encode": [-0-9.e]+, "splat": [-0-9.e]+, "composite": [-0-9.e]+, "warp": [-0-9.e]+, "combine": 0.0, "gather": 0.0, "write": [-0-9.e]+, "frame": [-0-9.e]+, "total": [-0-9.e]+\}, "image": \{"width": 40, "height": 30, "checksum": "[0-9a-f]{16}"\}\}$'
check "interesting voxels take bytes" [ "$(number ia)" -gt 0 ]
printed "shear-warp by its name" '"method": "shear-warp"' \
    render -q -o name.npy --method shear-warp --stats -

# Noise at a side that goes on beyond it, below the lowest value, is not seen.
for i in 0 1 2 3 4 5 6 7; do printf '\0\7\3\11\1\10\2\5'; done >noise.raw
for i in 0 1 2 3 4 5 6 7; do cat noise.raw; done >cube.raw
run 7 "invisible noise" "$TOOL" render -q cube.raw --dims 8x8x8 --type uint8 \
    --range 30,255 --encoding crs -o noise.png --stats -
check "has no interesting voxels" [ "$(number ia)" -eq 0 ]
run 0 "figures in words and as JSON" "$TOOL" -v phantom:shells \
    --dims 96x96x96 -s 40x30 -o w.png --stats -
look=$(sed -n 's/.*(look \([0-9.]*\)).*/\1/p' "$ERR")
check "classify counts the choice of the look" awk -v look="${look:-none}" \
    -v both="$(number classify)" \
    'BEGIN { exit !(look + 0 > 0 && both + 0.0005 >= look) }'
printed "figures of the original method" '"encoding": "none", "method": "original"' \
    render -q -o g.png --method original --stats -
run 0 "the picture to standard output, figures to a file" \
    render -q -o - --stats figures.json
check "PNG and JSON keep apart" grep -q '"checksum"' figures.json

# While the file is written a signal is let go: the picture becomes whole.
# (cli_interrupt: while it is drawn.)
"$TOOL" phantom:cube --dims 8x8x8 -s 2000x2000 --bits 16 --progress always \
    -o large.png 2>stages &
job=$!
await writing stages
kill -TERM $job
wait $job
check "SIGTERM while writing ends as usual" [ $? -eq 0 ]
check "with a whole picture" is_png large.png
# Where this script comes too late, the picture is whole: then once more.
for _ in $(seq 20); do
    rm -f stages # or its last one is taken for the new one
    "$TOOL" phantom:cube --dims 8x8x8 -s 2000x2000 --bits 16 -y \
        --progress always -o second.png 2>stages &
    job=$!
    await writing stages
    kill -TERM $job
    kill -HUP $job
    wait $job
    code=$?
    [ $code -eq 0 ] && is_png second.png || break
    rm second.png
done
check "a second signal ends the writing at once" [ $code -eq 130 ]
check "and leaves no picture" absent second.png
rm -f .second.png.snow-*
mkfifo pipe.png
rm stages
"$TOOL" phantom:cube --dims 8x8x8 -s 9x9 --progress always -o pipe.png 2>stages &
job=$!
await writing stages
sleep 0.2 # for the pipe to be opened; a signal before ends the tool as well
kill -TERM $job
wait $job
check "SIGTERM while a pipe waits for its reader" [ $? -eq 130 ]

# At any moment: 130 and no picture, or 0 and a whole one.  In the foreground
# timeout sends one signal; else a second one to the group, which ends writing.
broken=0 early=0
delays="0.01 0.04 0.1 0.2"
long_tier && delays="$delays 0.02 0.06 0.08 0.13 0.16 0.3 0.5"
for delay in $delays; do
    rm -f late.png
    timeout --foreground --preserve-status -s TERM $delay "$TOOL" -q phantom:engine \
        --dims 64x64x64 -s 700x700 --bits 16 -o late.png 2>/dev/null
    case $? in
    130 | 143) early=$((early + 1)) && [ ! -e late.png ] || broken=1 ;;
    0) is_png late.png && "$TOOL" compare late.png late.png >"$OUT" ||
        broken=1 ;;
    *) broken=1 ;;
    esac
done
check "interrupted at $delays s, $early times early: whole or absent" \
    [ "$broken" -eq 0 ]
check "and nothing is left aside" [ -z "$(ls -A | grep snow-)" ]
# What Slurm has given, where it binds no processes.
for given in SLURM_CPUS_PER_TASK=1 SLURM_CPUS_ON_NODE=1; do
    printed "$given" '"threads": 1,' env "$given" "$TOOL" phantom:cube --dims 8x8x8 \
        -s 9x9 -q -y -o slurm.png --stats -
done

finish
