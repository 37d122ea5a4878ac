#!/bin/bash
# --method raycast: pictures, kernels, figures and what is refused.  What the
# pictures must be is known by tests/render/test_raycast.c.
. "$(dirname "$0")/../../support/shell.sh"

scene="phantom:engine --dims 40x40x36 -s 70x60 --azimuth 30 --elevation 20 -y"
# shellcheck disable=SC2086
render() { "$TOOL" render $scene --method raycast "$@"; }

# nearer A B: A is nearer to fine.npy than B is.
nearer() {
    local file
    for file in "$1" "$2"; do
        "$TOOL" compare "$file.npy" fine.npy 2>/dev/null |
            awk '$1 == "psnr" { print $2 }'
    done | paste -s | awk '{ exit !($1 > $2) }'
}

# --- pictures ----------------------------------------------------------------
run 0 "quality high" render -q --quality high -o fine.npy --depth fine-depth.npy \
    --stats fine.json
check "is by raycast" grep -q '"method": "raycast"' fine.json
check "with the tent" grep -q '"kernel": "tent", "footprint": 2' fine.json
check "in quality high" grep -q '"quality": "high"' fine.json
check "without an encoding" grep -q '"encoding": "none"' fine.json
run 0 "quality normal" render -o normal.npy
says "method raycast$"
run 0 "quality draft" render -q --quality draft -o draft.npy
check "normal is nearer to high than draft" nearer normal draft
# shellcheck disable=SC2086
run 0 "by shear-warp" "$TOOL" render -q $scene -o other.npy
check "and draft than shear-warp" nearer draft other
run 0 "one thread" render -q -j 1 -o one.npy
check "gives the same bits" cmp -s normal.npy one.npy
run 0 "deterministic" render -q --deterministic -o one.npy
check "gives the same bits" cmp -s normal.npy one.npy
for mode in mip minip mean sum; do
    run 0 "mode $mode" render -q -m $mode -o $mode.npy --stats made.json
    check "$mode is by raycast" grep -q '"method": "raycast"' made.json
done
run 0 "mode iso" render -q -m iso --iso 90 -o iso.npy --depth depth.npy
run 0 "in perspective" render -q --perspective -o eye.png

# --- kernels -----------------------------------------------------------------
run 0 "the cubic B-spline" render -q --kernel bspline -o cubic.npy \
    --stats made.json
check "is used" grep -q '"kernel": "bspline", "footprint": 4' made.json
check "and makes another picture" test "$(cmp -s cubic.npy normal.npy; echo $?)" = 1
for kernel in gauss box; do
    run 2 "kernel $kernel" render --kernel $kernel -o no.png
    says "^snowglass: invalid kernel $kernel of footprint [24] for method raycast"
done
run 2 "a wider tent" render --kernel tent:4 -o no.png
says 'method footprint$'

# --- what is cut -------------------------------------------------------------
run 0 "a clip plane" render -q --clip 0.3,0.5,-0.8,4 -o clipped.npy
check "changes the picture" test "$(cmp -s clipped.npy normal.npy; echo $?)" = 1
run 0 "a crop" render -q --crop 0:20,:,: -o cropped.npy

# --- refusals ----------------------------------------------------------------
"$TOOL" phantom engine --dims 160x160x160 -o large.npy -q
run 5 "a volume that stays in its file" "$TOOL" render large.npy -y -s 40x40 \
    --memory 2M --method raycast -o no.png
says '^snowglass: large.npy: method raycast needs all voxels in memory'
check "no picture is left" test ! -e no.png

run 0 "doctor" "$TOOL" doctor
prints '^methods .* raycast'
run 0 "help" "$TOOL" help sparse
prints 'auto\|original\|footprint\|shear-warp\|raycast'
finish
