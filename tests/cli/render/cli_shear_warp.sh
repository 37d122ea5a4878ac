#!/bin/bash
# --method shear-warp: pictures, figures and what is left to others.  What the
# pictures must be is known by tests/render/test_shear_warp.c, and that threads and
# encodings change no bit by tests/shear_warp/test_same_bits.c.
. "$(dirname "$0")/../../support/shell.sh"

scene="phantom:engine --dims 60x60x40 -s 110x90 --azimuth 30 --elevation 20 -y"
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
run 0 "the truth" "$TOOL" render -q $scene --method raycast --quality high \
    -o truth.npy
for quality in draft normal high; do
    run 0 "quality $quality" render -q --quality $quality -o $quality.npy \
        --stats made.json
    check "is by shear-warp" grep -q '"method": "shear-warp"' made.json
    check "with the tent" grep -q '"kernel": "tent", "footprint": 2' made.json
    run 0 "by footprint" "$TOOL" render -q $scene --quality $quality \
        --method footprint -o footprint.npy
    check "is farther from the truth" nearer $quality footprint
done
check "high is nearer to it than draft" nearer high draft
pairs npy render $scene --method shear-warp <<'END'
depths do not change the picture | | = | --depth depth.npy
a deterministic picture is nearly the same | " | 1/255 | --deterministic
a crop is another | " | != | --crop 0:20,:,:
END

# What is left out by a mask, bands of colours: nearer to the truth of it.  Planes,
# logarithms, gradient opacity and splines have their decibels in test_truth.
"$TOOL" phantom -q head --dims 60x60x40 -o head.nrrd
for options in "--mask head.nrrd" "-c tab10"; do
    run 0 "the truth with $options" "$TOOL" render -q $scene $options \
        --method raycast --quality high -o truth.npy
    run 0 "by shear-warp" render -q $options -o values.npy
    run 0 "by footprint" "$TOOL" render -q $scene $options \
        --method footprint -o footprint.npy
    check "is farther from the truth" nearer values footprint
done

# In slabs: cli_stream.sh.
"$TOOL" phantom engine --dims 160x160x160 -o large.npy -q
run 5 "deterministic in slabs" "$TOOL" render large.npy -s 40x40 -q --memory 4M \
    --deterministic -o no.npy
says 'a deterministic picture by method shear-warp needs all voxels in memory'

# --- what footprints draw ----------------------------------------------------------------
for options in "--kernel gauss" "--kernel box" "--kernel auto:3" \
    "--kernel bspline:3"; do
    told "$options" 'note: method footprint is used in place of shear-warp' \
        render $options -o one.npy
    pairs npy render $scene $options <<'END'
is the same picture | --method shear-warp | = | --method footprint
END
done
told "an eye near the slices" 'note: method footprint is used in place of shear-warp' \
    "$TOOL" render phantom:engine --dims 60x60x40 --perspective 60 --position 0,0,-62 \
    --target 0,0,0 -y --method shear-warp -s 40x40 -o one.npy
finish
