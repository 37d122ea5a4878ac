#!/bin/bash
# --memory: what is too large for certain is refused before it is allocated,
# what turns out to be too large where it would go over; both with code 5.
. "$(dirname "$0")/../../support/shell.sh"

"$TOOL" phantom head --dims 160x160x160 -q -o a.nrrd
small=(-s 64x64 --preset linear --fit volume)
for size in 30M 30000K 0.03G 30MB 30MiB 30000000; do
    run 0 "a picture within $size" "$TOOL" render -q a.nrrd "${small[@]}" \
        -o "a$size.png" --memory $size --stats "a$size.json"
done
check "holds to it" python3 -c '
import json
assert json.load(open("a30M.json"))["bytes"]["peak"] <= 30 << 20'
run 0 "a picture without limit" "$TOOL" render a.nrrd "${small[@]}" -v -o b.png
says 'memory: at least 4.0 MiB, about [0-9.]+ MiB if all voxels are interest'
check "is the same" cmp a30M.png b.png
# Where voxels, encoding and picture just fit, the file is still to be packed.
for ((kib = 5100; kib <= 8400; kib += 300)); do
    run 0 "a picture within $kib KiB" "$TOOL" render a.nrrd "${small[@]}" -q \
        -y -o e.png --memory ${kib}K
    check "is the same" cmp e.png b.png
done

# What can be read in slabs is cli_stream.sh's.
refused 5 "voxels over the limit" \
    'a.nrrd: slabs of .* neighbours, and their encoding do not fit under the limit of 3.3 MiB' \
    "$TOOL" render a.nrrd "${small[@]}" --method footprint -o c.png --memory 3400K
refused 5 "a picture over the limit" 'need 17.1 MiB' \
    "$TOOL" render a.nrrd -s 1024x1024 -o c.png --memory 6M
refused 5 "encodings over the limit" 'their encoding do not fit under the limit' \
    "$TOOL" render a.nrrd "${small[@]}" -q -o c.png --memory 3500K
refused 5 "standard input" 'under a limit' bash -c \
    "'$TOOL' render - -o c.png --memory 3000K <a.nrrd"
refused 5 "a turntable" 'do not fit' "$TOOL" turntable a.nrrd \
    "${small[@]}" --method footprint --frames 3 -o 'f_%d.png' --memory 3400K
refused 5 "a movie" 'need 4.0 MiB' "$TOOL" movie a.nrrd a.nrrd \
    "${small[@]}" --range p1,p99 -o 'f_%d.png' --memory 3900K
check "nothing is left" test ! -e c.png -a ! -e f_0.png
run 0 "a box of it fits" "$TOOL" render -q a.nrrd "${small[@]}" -o d.png \
    --memory 3900K --crop 40:70,40:70,40:70
# What a huge volume needs is told though no machine has it.
refused 5 "a volume beyond all machines" 'need 116.4 TiB' \
    "$TOOL" render phantom:cube --dims 40000x40000x80000 -o c.png --memory 8G
finish
