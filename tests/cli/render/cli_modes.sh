#!/bin/bash
# Pictures in modes other than over: in every encoding and method, as colours
# and as values in data units.
. "$(dirname "$0")/../../support/shell.sh"

small="phantom:head --dims 24x24x20 -s 40x30 --azimuth 30 --elevation 20"
render() { "$TOOL" $small "$@"; }
# The shape that the header of a .npy tells.
shape() { head -c 128 "$1" | tr -d '\0' | grep -ao "'shape': ([0-9, ]*)"; }

for mode in mip minip mean sum; do
    told "mode $mode" "mode $mode of all voxels, method" render -m $mode -o $mode.npy
    check "it is told on one line" [ "$(wc -l <"$ERR")" -eq 1 ]
    says "grey .* \(linear\)"
    pairs npy $small <<END
$mode is another picture than over | -m $mode | != | -m over
$mode in crs | " | = | -m $mode --encoding crs
$mode in bitmap | " | = | -m $mode --encoding bitmap
$mode in rle | " | = | -m $mode --encoding rle
$mode with a threshold, which has no part in it | " | = | -m $mode --threshold 30
$mode in perspective | " | != | -m $mode --perspective
END
    run 0 "$mode as PNG" render -q -m $mode -o $mode.png
    run 0 "$mode on a background" render -q -m $mode -o $mode.back.png \
        --background white
    run 0 "$mode as PFM" render -q -m $mode -o $mode.pfm
done
told "a threshold" "of all voxels \(no threshold\)" render -m mip --threshold 30 -o t.npy
check "mip is colours" [ "$(shape mip.npy)" = "'shape': (30, 40, 4)" ]
check "a mean is values" [ "$(shape mean.npy)" = "'shape': (30, 40)" ]
check "a sum is values" [ "$(shape sum.npy)" = "'shape': (30, 40)" ]
check "a mean's PFM is grey" [ "$(head -c 2 mean.pfm)" = "Pf" ]
check "a mip's PFM is colour" [ "$(head -c 2 mip.pfm)" = "PF" ]
run 0 "a mean is the same in both formats" "$TOOL" compare mean.npy mean.pfm

for suffix in exr tif; do
    "$TOOL" doctor | grep -q "^picture outputs.* \.$suffix" || continue
    run 0 "a sum as .$suffix" render -q -m sum -o sum.$suffix
    run 0 "holds values too" "$TOOL" compare sum.npy sum.$suffix
    run 0 "depths as .$suffix" render -q -m iso --iso 40 -o any.$suffix.png \
        --depth depth.$suffix
    run 0 "and .npy" render -q -m iso --iso 40 -y -o any.$suffix.png \
        --depth depth.$suffix.npy
    run 0 "are the same" "$TOOL" compare depth.$suffix depth.$suffix.npy
done
run 2 "depths are no picture" render -q -m iso --iso 40 -o no.png --depth no.webp
says "--depth: no.webp cannot hold depths"

run 0 "a PNG of means tells its range" render -m mean -o told.png
says "means of [-0-9.e]+\.\.[-0-9.e]+ in the look's colours"
range=$(grep -o "means of [^ ]*" "$ERR")
run 0 "a range that is asked for" render -m sum --range 10,500 -o range.png
says "sums of 10\.\.500 in the look's colours"
run 0 "a colour map" render -q -m mean -c viridis -o viridis.png
run 6 "changes the colours" "$TOOL" compare told.png viridis.png
run 0 "a reversed map" render -m mean -c viridis_r -y -o viridis.png
check "is spread over the same range" grep -qF "${range:-no range}" "$ERR"

# Colours at values stay there, also where one is alone, and so do those of the
# printed command.
for mode in mean mip; do
    for colors in 60:#000000,255:#ff8800 1000:#000000,1255:#ff8800 90:#ff0000; do
        again "colours at values, $mode" render "$mode.at.png" $small -m $mode -c "$colors"
        cp "first/$mode.at.png" "$mode.${colors%%:*}.png"
    done
    other_file "colours at other values" $mode.60.png $mode.1000.png
done

run 0 "iso and its depth" render -m iso --iso 40 -o iso.npy --depth near.npy
says "mode iso of all voxels"
check "a depth is values" [ "$(shape near.npy)" = "'shape': (30, 40)" ]
run 0 "another value" render -q -m iso --iso 120 -o iso2.npy --depth near2.pfm
run 6 "is elsewhere" "$TOOL" compare near.npy near2.pfm
run 4 "a depth that exists is kept" render -q -m iso --iso 40 -o iso3.npy \
    --depth near.npy
says "near.npy: "
pairs npy $small -m iso --iso 40 <<'END'
iso unshaded is flat | | != | --shade none
of another value is another | " | != | --iso 120
in crs | " | = | --encoding crs
in bitmap | " | = | --encoding bitmap
in rle | " | = | --encoding rle
by the original method | " | = | --method original
END
again "iso" render keep.npy $small -m iso --iso 40
again "minip" render keep.npy $small -m minip
run 0 "iso in perspective" render -q -m iso --iso 40 --perspective -o eye.png
pairs npy $small --opacity 0.3:0,0.31:1 <<'END'
over and its depth | --depth solid.depth.npy | = |
END

run 2 "a movie of sums has one range" "$TOOL" turntable phantom:head \
    --dims 12x12x12 -m sum -o "sum_%02d.png" --frames 2
says "--mode sum: all frames of a movie need the same range"
run 0 "a movie of sums" "$TOOL" turntable phantom:head --dims 12x12x12 -m sum \
    --range 0,1000 -o "sum_%02d.png" --frames 2 -s 20x20
run 0 "a movie of maxima" "$TOOL" turntable phantom:head --dims 12x12x12 \
    -m mip -o "mip_%02d.png" --frames 2 -s 20x20
told "what mip makes no use of" '^snowglass: note: --opacity has no effect in mode mip$' \
    render -m mip --opacity 0:0,200:1 --light 10,10 -y -o unused.png
says '^snowglass: note: --light has no effect in mode mip$'
finish
