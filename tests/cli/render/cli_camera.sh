#!/bin/bash
# --position, --target and --up: the same place by another name is the same
# picture, and places where no camera can be are refused in words.
. "$(dirname "$0")/../../support/shell.sh"


at="--position -1000,0,0"
run 0 "the middle of the volume as target" "$TOOL" info --json \
    phantom:head --dims 40x40x40
middle=$(python3 - "$OUT" <<'PY'
import json, sys
info = json.load(open(sys.argv[1]))
m, d = info["matrix"], info["dims"]
print(",".join(repr(m[r][3] + sum(m[r][c] * (d[c] - 1) / 2 for c in range(3)))
               for r in range(3)))
PY
)
pairs npy render phantom:head --dims 40x40x40 -s 64x48 --fit volume <<END
the middle is the usual target | --view left | 1e-5 | --view left --target $middle
+z is up from a position | $at --target 0,0,0 | 1e-6 | $at --up 0,0,5 --target 0,0,0
another up is another picture | $at | != | $at --up 0,1,0
twice as far, half the field: alike | --position 400,300,100 --perspective 25 | 0.6 | \
    --position 800,600,200 --perspective 12.6
END
told "it says where from" 'view from 400,300,100;' \
    "$TOOL" render phantom:head --dims 20x20x20 -s 20x20 -o h.npy --position 400,300,100
run 0 "a turntable turns about the target" "$TOOL" turntable -q phantom:head \
    --dims 24x24x24 -s 24x24 --frames 2 --target 10,0,0 -o 't_%d.npy' \
    --perspective
run 0 "its second picture" "$TOOL" render -q phantom:head --dims 24x24x24 \
    -s 24x24 --target 10,0,0 -o u.npy --perspective --azimuth 180
check "is that of render" cmp -s t_1.npy u.npy

# Planes and sides by their names: the head is a patient, raw data are none.
for pair in axial=inferior Coronal=anterior sagittal=left front=anterior \
    back=posterior top=superior bottom=inferior; do
    pairs png render phantom:head --dims 40x40x40 -s 64x48 --fit volume <<END
$pair of a patient, letters too | --view ${pair%=*} | = | --view ${pair#*=}
END
done
head -c 27000 /dev/urandom >noise.raw
raw="noise.raw --dims 30x30x30 --type uint8 -s 20x20"
for pair in axial=+z coronal=-y sagittal=+x front=-y back=+y top=+z bottom=-z; do
    pairs npy render $raw <<END
$pair of raw data | --view ${pair%=*} | = | --view ${pair#*=}
END
done
pairs npy render $raw <<'END'
front is not back | --view front | != | --view back
END
refusals 2 "$TOOL" render phantom:head <<'END'
--dims 20x20x20 -o x.png --position 0,5,0 --target 0,0,0 --perspective|beside or behind the camera
-o x.png --position 1,2,3 --view left|conflicts with --view
--dims 20x20x20 -o x.png --up 0,3,0|invalid up vector 0,3,0
--dims 20x20x20 -o x.png --position 1,2,3 --target 1,2,3|is its target: they must differ
END
check "nothing is written then" absent x.png
finish
