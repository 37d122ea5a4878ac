#!/bin/bash
# mpi_modes.sh - the tool as many ranks makes the pictures of one process in
# modes other than over, and depths.
. "$(dirname "$0")/../support/mpi.sh"
head="phantom:head --dims 40x36x44 -s 160x120 -q -y"

# both NAME TOLERANCE OPTION...: a picture by one process, and by many.
both() {
    local name=$1 tolerance=$2
    shift 2
    # shellcheck disable=SC2086
    run 0 "$name alone" "$TOOL" $head "$@" -o one.npy
    for ranks in 3 "$MOST"; do
        # shellcheck disable=SC2086
        run 0 "$name by $ranks ranks" \
            launch "$ranks" "$MPI_TOOL" $head "$@" -o many.npy
        run 0 "$name by $ranks ranks is as by one" "$TOOL" compare one.npy \
            many.npy --tolerance "$tolerance"
    done
}

oblique="--azimuth 33 --elevation 21"
for mode in mip minip; do
    # shellcheck disable=SC2086
    both "$mode" 0 -m $mode $oblique
    check "$mode has the same bits" cmp -s one.npy many.npy
    both "$mode along an axis" 0 -m $mode --view +x
    # shellcheck disable=SC2086
    both "$mode in perspective" 0 -m $mode $oblique --perspective
done
# In data units: means of 255, sums of 18,000.
# shellcheck disable=SC2086
both "mean" 1e-3 -m mean $oblique
# shellcheck disable=SC2086
both "sum" 0.1 -m sum $oblique

# depths NAME TOLERANCE OPTION...: the same to 1/255, and its depths.
depths() {
    local name=$1 tolerance=$2
    shift 2
    # shellcheck disable=SC2086
    run 0 "$name alone" "$TOOL" $head "$@" -o one.npy --depth one.depth.npy
    # shellcheck disable=SC2086
    run 0 "$name by 3" launch 3 "$MPI_TOOL" $head "$@" -o many.npy \
        --depth many.depth.npy
    run 0 "$name is as by one" "$TOOL" compare one.npy many.npy \
        --tolerance 1/255
    run 0 "so are its depths" "$TOOL" compare one.depth.npy many.depth.npy \
        --tolerance "$tolerance"
}
# shellcheck disable=SC2086
depths "iso" 0 -m iso --iso 60 $oblique
# shellcheck disable=SC2086
depths "iso in perspective" 0 -m iso --iso 60 $oblique --perspective
# shellcheck disable=SC2086
depths "over" 1/255 --opacity 0.3:0,0.31:1 $oblique
# shellcheck disable=SC2086
depths "darkened" 1/255 --opacity 0.3:0,0.31:1 --depth-darkening $oblique
# shellcheck disable=SC2086
depths "occluded" 1/255 --opacity 0.3:0,0.31:1 --occlusion $oblique
# shellcheck disable=SC2086
depths "an iso occluded" 1/255 -m iso --iso 60 --occlusion $oblique
# shellcheck disable=SC2086
depths "an iso darkened" 1/255 -m iso --iso 60 --depth-darkening $oblique

# shellcheck disable=SC2086
run 0 "sums as colours" launch 3 "$MPI_TOOL" $head -m sum -o sum.png
# shellcheck disable=SC2086
run 0 "maxima as colours alone" "$TOOL" $head -m mip -o one.png
# shellcheck disable=SC2086
run 0 "maxima as colours" launch 3 "$MPI_TOOL" $head -m mip -o many.png
run 0 "are those of one" "$TOOL" compare one.png many.png --tolerance 0
# shellcheck disable=SC2086
run 2 "a mip has no depth" launch 3 "$MPI_TOOL" $head -m mip -o deep.png \
    --depth deep.npy
says "mode mip has no depth; use mode over or iso"
for mode in mean sum; do
    # shellcheck disable=SC2086
    run 0 "a deterministic $mode of one" "$TOOL" $head -m $mode -o one.npy -y \
        --deterministic
    # shellcheck disable=SC2086
    run 0 "a deterministic $mode of three" launch 3 "$MPI_TOOL" $head \
        -m $mode -o many.npy -y --deterministic
    run 0 "are the same" cmp one.npy many.npy
done
finish
