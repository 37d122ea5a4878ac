#!/bin/bash
# compare: 0 within the tolerance, 6 beyond it or with other sizes, 3 when a
# picture cannot be read.
. "$(dirname "$0")/../../support/shell.sh"

# PFM pictures by hand: 1x1, little endian; 0 and 0.5 grey.
printf 'PF\n1 1\n-1.0\n\0\0\0\0\0\0\0\0\0\0\0\0' >black.pfm
printf 'PF\n1 1\n-1.0\n\0\0\0\77\0\0\0\77\0\0\0\77' >half.pfm
printf 'PF\n2 1\n-1.0\n\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0' \
    >wide.pfm
printf 'PF\n1 1\n-1.0\n\0\0\300\177\0\0\300\177\0\0\300\177' >nan.pfm

printed "a picture and itself" '^largest +0 ' "$TOOL" compare half.pfm half.pfm
prints '^ssim +1.000000$'
run 6 "two pictures 0.5 apart" "$TOOL" compare black.pfm half.pfm
prints '^largest +0.5 at pixel 0,0$'
prints '^beyond the tolerance of 0$'
printed "at a tolerance of 0.5" '^within the tolerance of 0.5$' \
    "$TOOL" compare black.pfm half.pfm --tolerance 0.5
run 6 "at a tolerance of 0.49" \
    "$TOOL" compare --tolerance 0.49 black.pfm half.pfm
run 6 "at 127/255" "$TOOL" compare black.pfm half.pfm --tolerance 127/255
run 0 "at 128/255" "$TOOL" compare black.pfm half.pfm --tolerance 128/255
run 6 "as JSON" "$TOOL" compare black.pfm half.pfm --json
prints '^\{"within": false, "tolerance": 0.0, "largest": 0.5, "x": 0, "y": 0, "mean": [0-9.]+, "psnr": [0-9.]+, "ssim": [-0-9.e]+\}$'
run 0 "equal pictures as JSON" "$TOOL" compare half.pfm half.pfm --json
prints '"largest": 0.0, .*"psnr": null, "ssim": 1.0'
run 6 "pictures of two sizes" "$TOOL" compare black.pfm wide.pfm
says 'black.pfm and wide.pfm: 1 x 1 and 2 x 1 pixels'
plain_error
run 6 "which are told as JSON, too" "$TOOL" compare black.pfm wide.pfm --json
prints '^\{"within": false, "tolerance": 0.0, "sizes": \[\[1, 1\], \[2, 1\]\]\}$'
run 6 "NaN and a number" "$TOOL" compare nan.pfm half.pfm --tolerance 1
run 0 "NaN and NaN" "$TOOL" compare nan.pfm nan.pfm
# A PFM has no alpha, whatever the picture had.
for type in png pfm npy; do
    run 0 "a picture with transparent pixels as $type" "$TOOL" phantom:cube \
        --dims 9x9x9 -s 20x20 -q -o "cube.$type" --background none
done
run 0 "PNG and PFM" "$TOOL" compare cube.png cube.pfm --tolerance 0.005
run 0 "PFM and NPY" "$TOOL" compare cube.pfm cube.npy
mkfifo black
"$TOOL" phantom:cube --dims 9x9x9 -s 20x20 -q -o - --background '#000000' \
    >black &
run 6 "black, of different alpha" "$TOOL" compare --json cube.npy black
check "standard input" bash -c \
    "'$TOOL' compare - half.pfm <half.pfm | grep -q '^within'"
head -c 15 half.pfm >cut.pfm
run 3 "a cut picture" "$TOOL" compare cut.pfm half.pfm
says 'cut.pfm'
finish
