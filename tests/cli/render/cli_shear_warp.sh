#!/bin/bash
# --method shear-warp: pictures, figures and what is left to others.  What the
# pictures must be is known by tests/render/test_shear_warp.c.
. "$(dirname "$0")/../../support/shell.sh"

scene="phantom:engine --dims 60x60x40 -s 110x90 --azimuth 30 --elevation 20 -y"
# shellcheck disable=SC2086
render() { "$TOOL" render $scene --method shear-warp "$@"; }

# nearer A B: A is nearer to truth.npy than B is.
nearer() {
    local file
    for file in "$1" "$2"; do
        "$TOOL" compare "$file.npy" truth.npy 2>/dev/null |
            awk '$1 == "psnr" { print $2 }'
    done | paste -s | awk '{ exit !($1 > $2) }'
}

# --- pictures ----------------------------------------------------------------
# shellcheck disable=SC2086
run 0 "the truth" "$TOOL" render -q $scene --method raycast --quality high \
    -o truth.npy
for quality in draft normal high; do
    run 0 "quality $quality" render -q --quality $quality -o $quality.npy \
        --stats made.json
    check "is by shear-warp" grep -q '"method": "shear-warp"' made.json
    check "with the tent" grep -q '"kernel": "tent", "footprint": 2' made.json
    # shellcheck disable=SC2086
    run 0 "by footprint" "$TOOL" render -q $scene --quality $quality \
        --method footprint -o footprint.npy
    check "is farther from the truth" nearer $quality footprint
done
check "high is nearer to it than draft" nearer high draft
run 0 "one thread" render -q -j 1 -o one.npy
check "gives the same bits" cmp -s normal.npy one.npy
for encoding in crs bitmap rle; do
    run 0 "encoding $encoding" render -q --encoding $encoding -o one.npy \
        --stats made.json
    check "gives the same bits" cmp -s normal.npy one.npy
    check "is used" grep -q "\"encoding\": \"$encoding\"" made.json
done
run 0 "a crop" render -q --crop 0:20,:,: -o cropped.npy
run 0 "depths" render -q -o one.npy --depth depth.npy
check "do not change the picture" cmp -s normal.npy one.npy

# What is left out, logarithms, gradient opacity: nearer to the truth of it.
"$TOOL" phantom -q head --dims 60x60x40 -o head.nrrd
for options in "--clip 0.3,0.5,-0.8,4" "--scale log" "--mask head.nrrd" \
    "--gradient-opacity 0:0,20:1" "-c tab10" \
    "--kernel bspline"; do
    # shellcheck disable=SC2086
    run 0 "the truth with $options" "$TOOL" render -q $scene $options \
        --method raycast --quality high -o truth.npy
    # shellcheck disable=SC2086
    run 0 "by shear-warp" render -q $options -o values.npy
    # shellcheck disable=SC2086
    run 0 "by footprint" "$TOOL" render -q $scene $options \
        --method footprint -o footprint.npy
    check "is farther from the truth" nearer values footprint
done

# --- parts -------------------------------------------------------------------
run 0 "a deterministic picture" render -q --deterministic -o one.npy
run 0 "is nearly the same" "$TOOL" compare normal.npy one.npy --tolerance 1/255
"$TOOL" phantom engine --dims 160x160x160 -o large.npy -q
for view in +z +y; do
    large="large.npy -y -s 40x40 --method shear-warp --view $view"
    # shellcheck disable=SC2086
    run 0 "a volume in memory" "$TOOL" render $large -q -o one.npy
    # shellcheck disable=SC2086
    run 0 "that stays in its file" "$TOOL" render $large -v --memory 4M \
        -o slabs.npy --stats made.json
    says 'stays in its file and is read in slabs'
    check "gives the same bits" cmp -s one.npy slabs.npy
    check "within the limit" awk '/"peak"/ && match($0, /"peak": [0-9]+/) {
        exit substr($0, RSTART + 8, RLENGTH - 8) > 4194304 }' made.json
done

# shellcheck disable=SC2086
run 5 "deterministic in slabs" "$TOOL" render $large -q --memory 4M \
    --deterministic -o no.npy
says 'a deterministic picture by method shear-warp needs all voxels in memory'

# --- what footprints draw ----------------------------------------------------------------
for options in "--kernel gauss" "--kernel box" "--kernel auto:3" \
    "--kernel bspline:3"; do
    # shellcheck disable=SC2086
    run 0 "$options" render $options -o one.npy
    says 'note: method footprint is used in place of shear-warp'
    # shellcheck disable=SC2086
    run 0 "$options by footprint" "$TOOL" render -q $scene $options \
        --method footprint -o old.npy
    check "is the same picture" cmp -s one.npy old.npy
done
run 0 "an eye near the slices" "$TOOL" render phantom:engine --dims 60x60x40 \
    --perspective 60 --position 0,0,-62 --target 0,0,0 -y --method shear-warp \
    -s 40x40 -o one.npy
says 'note: method footprint is used in place of shear-warp'
finish
