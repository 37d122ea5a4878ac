#!/bin/bash
# --position, --target and --up: the same place by another name is the same
# picture, and places where no camera can be are refused in words.
. "$(dirname "$0")/../../support/shell.sh"

# The head phantom is a patient: RAS, millimetres.
render() {
    "$TOOL" render -q phantom:head --dims 40x40x40 -s 64x48 --fit volume "$@"
}

run 0 "a view by name" render --view left -o a.npy
run 0 "its direction as a position, near or far" render \
    --position -1000,0,0 --target 0,0,0 -o b.npy
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
run 0 "is the usual target" render --view left --target "$middle" -o c.npy
run 0 "to rounding" "$TOOL" compare a.npy c.npy --tolerance 1e-5
run 0 "+z is up from a position" render --position -1000,0,0 --up 0,0,5 \
    --target 0,0,0 -o d.npy
run 0 "in the same picture" "$TOOL" compare b.npy d.npy --tolerance 1e-6
run 6 "and not where up is another" bash -c \
    "'$TOOL' render -q phantom:head --dims 40x40x40 -s 64x48 -o e.npy \
     --position -1000,0,0 --up 0,1,0 && '$TOOL' compare b.npy e.npy"
run 0 "an eye" render --position 400,300,100 --perspective 25 -o f.npy
run 0 "twice as far, half the field: about as large" render \
    --position 800,600,200 --perspective 12.6 -o g.npy
run 0 "and alike" "$TOOL" compare f.npy g.npy --tolerance 0.6
run 0 "it says where from" "$TOOL" render phantom:head --dims 20x20x20 \
    -s 20x20 -o h.npy --position 400,300,100
says 'view from 400,300,100;'
run 0 "a turntable turns about the target" "$TOOL" turntable -q phantom:head \
    --dims 24x24x24 -s 24x24 --frames 2 --target 10,0,0 -o 't_%d.npy' \
    --perspective
run 0 "its second picture" "$TOOL" render -q phantom:head --dims 24x24x24 \
    -s 24x24 --target 10,0,0 -o u.npy --perspective --azimuth 180
check "is that of render" cmp -s t_1.npy u.npy

# Planes and sides by their names: the head is a patient, raw data are none.
for pair in axial=inferior Coronal=anterior sagittal=left front=anterior \
    back=posterior top=superior bottom=inferior; do
    run 0 "view ${pair%=*} of a patient" render --view "${pair%=*}" -y -o p.png
    run 0 "is ${pair#*=}" render --view "${pair#*=}" -y -o q.png
    check "$pair: the same picture, letters too" cmp -s p.png q.png
done
head -c 27000 /dev/urandom >noise.raw
for pair in axial=+z coronal=-y sagittal=+x front=-y back=+y top=+z bottom=-z; do
    for side in "${pair%=*}" "${pair#*=}"; do
        run 0 "view $side of raw data" "$TOOL" render -q noise.raw \
            --dims 30x30x30 --type uint8 -s 20x20 --view "$side" -y -o "./$side.npy"
    done
    check "$pair: the same picture" \
        cmp -s "./${pair%=*}.npy" "./${pair#*=}.npy"
done
check "and front is not back" bash -c '! cmp -s front.npy back.npy'

refused 2 "an eye within" 'beside or behind the camera' \
    "$TOOL" render phantom:head --dims 20x20x20 -o x.png --position 0,5,0 \
    --target 0,0,0 --perspective
refused 2 "a position and a view" 'conflicts with --view' \
    "$TOOL" render phantom:head -o x.png --position 1,2,3 --view left
refused 2 "an up along the line of sight" 'invalid up vector 0,3,0' \
    "$TOOL" render phantom:head --dims 20x20x20 -o x.png --up 0,3,0
refused 2 "a position on the target" 'is its target: they must differ' \
    "$TOOL" render phantom:head --dims 20x20x20 -o x.png --position 1,2,3 \
    --target 1,2,3
check "nothing is written then" absent x.png
finish
