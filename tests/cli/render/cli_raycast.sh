#!/bin/bash
# --method raycast: pictures, kernels, figures and what is refused.  What the
# pictures must be is known by tests/render/test_raycast.c, also that no number of
# threads changes them; cli_matrix.sh has all modes.
. "$(dirname "$0")/../../support/shell.sh"

scene="phantom:engine --dims 40x40x36 -s 70x60 --azimuth 30 --elevation 20 -y"
render() { "$TOOL" render $scene --method raycast "$@"; }

# nearer A B: A is nearer to fine.npy than B is.
nearer() {
    local file
    for file in "$1" "$2"; do
        "$TOOL" compare "$file.npy" fine.npy 2>/dev/null |
            awk '$1 == "psnr" { print $2 }'
    done | paste -s | awk '{ exit !($1 > $2) }'
}

run 0 "quality high" render -q --quality high -o fine.npy --stats fine.json
for word in '"method": "raycast"' '"kernel": "tent", "footprint": 2' \
    '"quality": "high"' '"encoding": "none"'; do
    check "has $word" grep -q "$word" fine.json
done
told "quality normal" "method raycast$" render -o normal.npy
run 0 "quality draft" render -q --quality draft -o draft.npy
check "normal is nearer to high than draft" nearer normal draft
run 0 "by shear-warp" "$TOOL" render -q $scene -o other.npy
check "and draft than shear-warp" nearer draft other
run 0 "in perspective" render -q --perspective -o eye.png
pairs npy render $scene --method raycast <<'END'
the cubic B-spline is another picture | | != | --kernel bspline --stats made.json
a clip plane too | " | != | --clip 0.3,0.5,-0.8,4
and a crop | " | != | --crop 0:20,:,:
END
check "the B-spline is used" grep -q '"kernel": "bspline", "footprint": 4' made.json

# --- refusals ----------------------------------------------------------------
refusals 2 render -o no.png <<'END'
--kernel gauss|^snowglass: invalid kernel gauss of footprint [24] for method raycast
--kernel box|^snowglass: invalid kernel box of footprint [24] for method raycast
--kernel tent:4|method footprint$
END
"$TOOL" phantom engine --dims 160x160x160 -o large.npy -q
refused 5 "a volume that stays in its file" \
    '^snowglass: large.npy: method raycast needs all voxels in memory' \
    "$TOOL" render large.npy -s 40x40 --memory 2M --method raycast -o no.png
check "no picture is left" absent no.png
printed "doctor" '^methods .* raycast' "$TOOL" doctor
printed "help" 'auto\|original\|footprint\|shear-warp\|raycast' "$TOOL" help sparse
finish
