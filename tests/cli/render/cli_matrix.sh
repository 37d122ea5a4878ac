#!/bin/bash
# Every mode in both projections by every method and encoding: each picture is
# there, made by the method that was asked for, as near to the original
# method's as that method is, and the same in every encoding.
. "$(dirname "$0")/../../support/shell.sh"

# A scene whose voxels end within the volume, and whose pixels are a voxel wide.
scene="phantom:shells --dims 40x36x44 -s 70x60 --azimuth 30 --elevation 20 -y"
# shellcheck disable=SC2086
render() { "$TOOL" render $scene --preset linear "$@"; }

# near NAME METHOD BOUND: the mean difference of its picture, of colours 0 to 1,
# from the original method's.  Tests in C have the sharper bounds; here a
# picture must not be of another mode, projection or range.
near() {
    "$TOOL" compare "$2.png" original.png >mean.txt 2>/dev/null
    check "$1" awk -v most="$3" '$1 == "mean" { good = $2 <= most }
        END { exit !good }' mean.txt
}

# row MODE PROJECTION OPTION...: one mode and projection, by all methods.
row() {
    local name="$1 $2" mode=$1 method made encoding
    shift 2
    for method in original footprint shear-warp; do
        run 0 "$name by $method as colours" render -q "$@" --method $method \
            -o $method.png
    done
    near "$name: footprint is exact" footprint 1e-5
    near "$name: shear-warp is near" shear-warp 0.007
    run 0 "$name by original" render -q "$@" --method original -o original.npy \
        --stats original.json
    check "is by original" grep -q '"method": "original"' original.json
    for method in footprint shear-warp auto; do
        made=$method
        [ $method = auto ] && made=shear-warp
        [ "$mode" = iso ] && made=footprint
        run 0 "$name by $method" render -q "$@" --method $method \
            -o $method.npy --stats made.json
        check "$name by $method is by $made" \
            grep -q "\"method\": \"$made\"" made.json
        for encoding in crs bitmap rle; do
            run 0 "$name by $method in $encoding" render -q "$@" \
                --method $method --encoding $encoding -o coded.npy \
                --stats made.json
            check "is in $encoding" \
                grep -q "\"encoding\": \"$encoding\"" made.json
            check "with the same bits" cmp -s $method.npy coded.npy
        done
    done
    check "$name: auto is shear-warp" cmp -s auto.npy shear-warp.npy
}

for projection in parallel perspective; do
    eye=()
    [ $projection = perspective ] && eye=(--perspective)
    for mode in over mip minip; do
        row $mode $projection -m $mode "${eye[@]}"
    done
    row mean $projection -m mean --range 0,255 "${eye[@]}"
    row sum $projection -m sum --range 0,6000 "${eye[@]}"
    row iso $projection -m iso --iso 60 "${eye[@]}"
    # Depths are made by footprints, and are those of every method's picture.
    first=
    for method in original footprint shear-warp auto; do
        for mode in over iso; do
            iso=()
            [ $mode = iso ] && iso=(--iso 60)
            run 0 "depth of $mode $projection by $method" render -q -m $mode \
                "${iso[@]}" "${eye[@]}" --method $method -o d.npy \
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

# --- what shear-warp does not make is told of ------------------------------------
run 0 "shear-warp of wide pixels" render -m mip --method shear-warp -o w.npy -s 2x2 \
    --zoom 0.3
says 'note: method footprint is used in place of shear-warp: pixels are too many'
run 0 "auto of wide pixels" render -m mip -o w.npy -s 2x2 --zoom 0.3
check "is not remarked on" bash -c "! grep -q 'note: method' '$ERR'"
run 0 "shear-warp and iso" render -m iso --iso 60 --method shear-warp -o w.npy
says 'note: --method shear-warp has no effect in mode iso'
finish
