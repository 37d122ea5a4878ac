#!/bin/bash
# Every mode in both projections by every method and encoding: each picture is
# there, made by the method that was asked for, or by the one that draws in its
# place, as near to its model as that method is, and the same in
# an encoding, of which they take turns.
. "$(dirname "$0")/../../support/shell.sh"

# A scene whose voxels end within the volume, and whose pixels are a voxel wide.
scene="phantom:shells --dims 40x36x44 -s 70x60 --azimuth 30 --elevation 20
    --fit volume -y"
render() { "$TOOL" render $scene --preset linear "$@"; }

# near NAME METHOD MODEL BOUND: the mean difference of its picture, of colours 0
# to 1, from that of MODEL.  Tests in C have the sharper bounds; here a picture
# must not be of another mode, projection or range.
near() {
    "$TOOL" compare "$2.png" "$3.png" >mean.txt 2>/dev/null
    check "$1" awk -v most="$4" '$1 == "mean" { good = $2 <= most }
        END { exit !good }' mean.txt
}

# row MODE PROJECTION BOUND OPTION...: one mode and projection, by all methods.
# BOUND is that of shear-warp and raycast in high quality: values come before
# colours in both, and after them in original and footprint.
encodings=(crs bitmap rle)
row() {
    local name="$1 $2" mode=$1 bound=$3 method made encoding
    shift 3
    for method in original footprint shear-warp raycast; do
        run 0 "$name by $method as colours" render -q "$@" --method $method \
            --quality high -o $method.png
    done
    near "$name: footprint is exact" footprint original 1e-5
    near "$name: shear-warp is near" shear-warp raycast "$bound"
    made=original
    [ "$mode" = iso ] && made=shear-warp # footprints have no surfaces
    run 0 "$name by original" render -q "$@" --method original -o original.npy \
        --stats original.json
    check "is by $made" grep -q "\"method\": \"$made\"" original.json
    for method in footprint shear-warp auto; do
        made=$method
        [ $method = auto ] && made=shear-warp
        [ "$mode" = iso ] && made=shear-warp
        run 0 "$name by $method" render -q "$@" --method $method \
            -o $method.npy --stats made.json
        check "$name by $method is by $made" \
            grep -q "\"method\": \"$made\"" made.json
        encoding=${encodings[0]}
        encodings=("${encodings[@]:1}" "$encoding")
        run 0 "$name by $method in $encoding" render -q "$@" \
            --method $method --encoding "$encoding" -o coded.npy \
            --stats made.json
        check "is in $encoding" \
            grep -q "\"encoding\": \"$encoding\"" made.json
        check "with the same bits" cmp -s $method.npy coded.npy
    done
    encodings=("${encodings[@]:1}" "${encodings[0]}") # each method meets all
    check "$name: auto is shear-warp" cmp -s auto.npy shear-warp.npy
}

for projection in parallel perspective; do
    eye=()
    [ $projection = perspective ] && eye=(--perspective)
    row over $projection 0.0018 -m over "${eye[@]}"
    row mip $projection 0.0057 -m mip "${eye[@]}"
    row minip $projection 0.0019 -m minip "${eye[@]}"
    row mean $projection 0.0022 -m mean --range 0,255 "${eye[@]}"
    row sum $projection 0.0024 -m sum --range 0,6000 "${eye[@]}"
    row iso $projection 0.01 -m iso --iso 60 "${eye[@]}"
    # Depths of over are made by footprints of the kernel that is in use, and
    # those of iso by rays, whatever the method.
    first=
    for method in original footprint shear-warp auto; do
        for mode in over iso; do
            more=()
            [ $mode = iso ] && more=(--iso 60)
            case $method in original | footprint) more+=(--kernel tent) ;; esac
            run 0 "depth of $mode $projection by $method" render -q -m $mode \
                "${more[@]}" "${eye[@]}" --method $method -o d.npy \
                --depth depth.$mode.$method.npy
            [ -n "$first" ] && check "is as by original" cmp -s \
                depth.$mode.original.npy depth.$mode.$method.npy
        done
        first=1
    done
    for mode in mip minip mean sum; do
        refused 2 "depth of $mode $projection" "mode $mode has no depth" \
            render -m $mode "${eye[@]}" -o d.npy --depth none.npy
    done
done

# --- what shear-warp does not draw is told of ------------------------------------
near=(render phantom:shells --dims 40x36x44 -s 70x60 -y -o w.npy --perspective
    --position 220,0,0 --azimuth 45)
run 0 "shear-warp from near by" "$TOOL" "${near[@]}" -m mip --method shear-warp
says 'note: method footprint is used in place of shear-warp, .* no eye beside the slices or near'
run 0 "auto from near by" "$TOOL" "${near[@]}" -m mip
check "is not remarked on" bash -c "! grep -q 'note: method' '$ERR'"
run 0 "a surface from near by" "$TOOL" "${near[@]}" -m iso --iso 60 \
    --method shear-warp
says 'note: method raycast is used in place of shear-warp, .* no eye beside the slices or near'
run 0 "pixels of many voxels" render -m mip --method shear-warp -o w.npy -s 9x9 \
    --zoom 0.3 --stats made.json
check "are drawn by shear-warp" grep -q '"method": "shear-warp"' made.json
finish
