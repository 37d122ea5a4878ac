#!/bin/bash
# mpi_render.sh - the tool as many ranks makes the pictures of one process: one
# of each kind, since test_ranks has them all with ranks that are threads.
. "$(dirname "$0")/../support/mpi.sh"
head=(phantom:head --dims 40x36x44 -s 160x120)
oblique=(--azimuth 33 --elevation 21)
step=1/255

as_one "along an axis" 2 $step "${head[@]}" --view +x
WAY="--cut bricks" as_one "footprints" "$MOST" 1e-6 "${head[@]}" \
    "${oblique[@]}" --method footprint --perspective 60
as_one "deterministic values" 3 bits "${head[@]}" "${oblique[@]}" \
    --deterministic --method shear-warp
WAY="--cut equal --combine radix:3" as_one "a way to combine" "$MOST" $step \
    "${head[@]}" --azimuth 70

# Ranks without voxels of their own know the planes too.
run 0 "a thin volume" "$TOOL" phantom head --dims 12x10x3 -o thin.nrrd -y
as_one "a plane" 5 $step thin.nrrd --clip=1,0,0,1 -s 64
WAY="--cut bricks" as_one "a draft of few pixels" "$MOST" $step phantom:engine \
    --dims 131x144x127 --quality draft -s 40x50 "${oblique[@]}"

# shellcheck disable=SC2086
run 0 "figures" launch 2 "$MPI_TOOL" "${head[@]}" -q -y --encoding bitmap \
    -o many.png --stats -
prints '"ranks": 2'
prints '"interesting": |"load": 1'
"$TOOL" "${head[@]}" -q -y --encoding bitmap -o one.png --stats one.json
check "bytes of EA are those of one process" [ "$(number ea)" = \
    "$(sed -n 's/.*"ea": \([0-9]*\).*/\1/p' one.json)" ]

# --- modes and depths ---------------------------------------------------------

as_one "a maximum" 3 bits "${head[@]}" "${oblique[@]}" -m mip --perspective
as_one "a deterministic mean" 3 bits "${head[@]}" -m mean --deterministic
# depths NAME TOLERANCE OPTION...: a picture's depths are those of one as well.
depths() {
    local name=$1 tolerance=$2
    shift 2
    as_one "$name" 3 $step "${head[@]}" "${oblique[@]}" "$@"
    run 0 "$name, depths alone" "$TOOL" "${head[@]}" "${oblique[@]}" "$@" -q -y \
        -o one.npy --depth one.depth.npy
    run 0 "$name, depths" launch 3 "$MPI_TOOL" "${head[@]}" "${oblique[@]}" "$@" \
        -q -y -o many.npy --depth many.depth.npy
    run 0 "$name, depths are as by one" "$TOOL" compare one.depth.npy \
        many.depth.npy --tolerance "$tolerance"
}
depths "a surface" 0 -m iso --iso 60
depths "over" $step --opacity 0.3:0,0.31:1 --occlusion --depth-darkening
run 0 "maxima as colours alone" "$TOOL" "${head[@]}" -q -m mip -o one.png -y
run 0 "maxima as colours" launch 3 "$MPI_TOOL" "${head[@]}" -q -m mip \
    -o many.png -y
run 0 "are those of one" "$TOOL" compare one.png many.png --tolerance 0
run 2 "a mip has no depth" launch 3 "$MPI_TOOL" "${head[@]}" -q -m mip \
    -o deep.png --depth deep.npy
says "mode mip has no depth; use mode over or iso"

# --- files --------------------------------------------------------------------

# Each rank reads its part, for which it unpacks all of a packed file.
run 0 "a file" "$TOOL" phantom engine --dims 40x40x40 -o v.nrrd
run 0 "a packed file" "$TOOL" phantom engine --dims 40x40x40 -o v.nii.gz
as_one "a packed file" 3 $step v.nii.gz
# All ranks have read the end of it; one line says what lies behind.
cp v.nii.gz tail.nii.gz
echo more >>tail.nii.gz
run 0 "more behind the data" launch 3 "$MPI_TOOL" tail.nii.gz -y -o x.png
check "is said once" [ "$(grep -c 'compressed data are ignored' "$ERR")" = 1 ]

# --- movies -------------------------------------------------------------------

frames_as_one "a turntable" 3 turntable v.nrrd --frames 4
if ! long_tier; then
    skipped "movies, looks and masks by ranks" "left to the long tier"
    finish
fi
rm many_2.png
run 0 "a turntable is resumed" launch 3 "$MPI_TOOL" turntable v.nrrd \
    --frames 4 -s 64x64 -q --background black --resume -o many_%d.png \
    --stats stats.json
check "one frame was missing" grep -q '"rendered": 1, "kept": 3' stats.json
run 0 "its frame is the same" "$TOOL" compare one_2.png many_2.png \
    --tolerance 1.001/255
number=0 # of files that say nothing of their grid, so that it is one
for name in head engine shells; do
    "$TOOL" phantom $name --dims 32x32x32 -q -o step$((number++)).npy
done
frames_as_one "a movie" 2 movie step%d.npy

# Ranks share the reading for the look of all steps where there are more of them
# than steps, or a step is too large for one: the look is that of one process.
"$TOOL" phantom engine --dims 160x160x171 -q -o large0.npy
"$TOOL" phantom head --dims 160x160x171 -q -o large1.npy
for way in "step0.npy step1.npy --crop :,3:30,5:31" "large0.npy large1.npy"; do
    # shellcheck disable=SC2086
    run 0 "a movie alone, $way" "$TOOL" movie $way -s 64x64 -y -o step_%d.npy
    look=$(grep -o 'grey .*histogram)' "$ERR")
    [ "${way%%0*}" = large ] && way+=" --memory 4000K"
    # shellcheck disable=SC2086
    run 0 "by 12" launch 12 "$MPI_TOOL" movie $way -s 64x64 -y \
        -o steps_%d.npy
    check "one look: $look" grep -qF "${look:-none}" "$ERR"
    for frame in 0 1; do
        run 0 "step $frame" "$TOOL" compare step_$frame.npy steps_$frame.npy \
            --tolerance $step
    done
done
refused 5 "a step too large for one" 'the range of all steps needs' \
    "$TOOL" movie large0.npy large1.npy --memory 4000K -o x_%d.png

# --- masks --------------------------------------------------------------------

# Each rank reads its box of a mask.
"$TOOL" phantom shells --dims 40x36x44 -q -o mask.nrrd
mask=(--mask mask.nrrd --labels 1-120 --clip 1,0.5,0,30 --azimuth 33)
WAY="--cut counted" as_one "a mask" "$MOST" $step "${head[@]}" "${mask[@]}"
WAY="--cut bricks" as_one "a mask and a crop" "$MOST" $step "${head[@]}" \
    "${mask[@]}" --crop 4:,:30,9:40
refused 3 "a mask of another grid" 'the mask has 40x36x44 voxels' \
    "$MPI_TOOL" phantom:head --dims 40x36x40 --mask mask.nrrd -o x.png

# --- memory -------------------------------------------------------------------

# What a limit has no room for stays in the file: the pictures have the same
# bits, and no rank takes more.
peak() { grep -o '"peak": [0-9]*' "$1" | grep -o '[0-9]*'; }
"$TOOL" phantom engine --dims 160x150x170 -q -o slab.nrrd
"$TOOL" convert slab.nrrd -o packed.nii.gz -q
for way in "packed.nii.gz --shade phong" \
    "slab.nrrd --cut equal --mode iso --iso 90 --perspective"; do
    # shellcheck disable=SC2086
    run 0 "$way in memory" launch 3 "$MPI_TOOL" $way --azimuth 70 -s 64x64 -q -y \
        -o one.npy
    # shellcheck disable=SC2086
    run 0 "$way in its file" launch 3 "$MPI_TOOL" $way --azimuth 70 -s 64x64 \
        -q -y -o many.npy --memory 5M --stats many.json
    check "it has the same bits" cmp -s one.npy many.npy
    check "no rank takes more" [ "$(peak many.json)" -le 5242880 ]
done
# Without a limit the memory of a rank shrinks with their number: 1.3 times its
# part of what one takes, and 4 MiB.
"$TOOL" phantom head --dims 256x256x256 -q -o large.nrrd
run 0 "one process" "$TOOL" large.nrrd --view +z -s 64x64 -j 1 -q -y -o one.npy \
    --stats one.json
run 0 "4 ranks" launch 4 "$MPI_TOOL" large.nrrd --view +z -s 64x64 -j 1 -q -y \
    -o many.npy --stats many.json
check "4 ranks take less each" [ "$(peak many.json)" -le \
    $(($(peak one.json) * 13 / 10 / 4 + 4194304)) ]
rm large.nrrd

# shellcheck disable=SC2054
turn=(turntable slab.nrrd --frames 2 -s 64x64 -y -q --background black)
run 0 "a turn in memory" launch 3 "$MPI_TOOL" "${turn[@]}" -o one_%d.png
run 0 "a turn in its file" launch 3 "$MPI_TOOL" "${turn[@]}" -o many_%d.png \
    --memory 6M
for frame in 0 1; do
    check "frame $frame" cmp -s one_$frame.png many_$frame.png
done

# --- what is told -------------------------------------------------------------

# That nothing is left is told once, whoever has read what.
for way in "render mask.nrrd -o x.png" \
    "turntable mask.nrrd -o x_%d.png --frames 2" \
    "movie step0.npy step1.npy step2.npy -o x_%d.png"; do
    # shellcheck disable=SC2086
    run 7 "$way by $MOST" launch "$MOST" "$MPI_TOOL" $way -y -s 32x32 \
        --clip 0,0,1,-1000
    check "is said once" test "$(grep -c 'no voxel is left' "$ERR")" = 1
done
run 7 "a mask of nothing" launch 3 "$MPI_TOOL" phantom:head --dims 40x36x44 \
    -s 32x32 --mask mask.nrrd --labels 300 -y -o x.png
says 'mask.nrrd: no voxel is left inside this mask, whose values are 0 to 220'
run 0 "a mask of something" launch 3 "$MPI_TOOL" mask.nrrd -y -o x.png \
    --clip 0,0,1,-20
check "of which nothing is told" test "$(grep -c 'no voxel' "$ERR")" = 0

# What is said of the look is said of the one that all steps share: each of
# these alone has one value only.
for value in 000 100 200; do
    printf '%s\n' NRRD0004 "type: uint8" "dimension: 3" "sizes: 16 16 16" \
        "encoding: raw" "" >flat$value.nrrd
    head -c 4096 /dev/zero | tr '\0' "\\$value" >>flat$value.nrrd
done
run 0 "one value a step by 3" launch 3 "$MPI_TOOL" movie flat000.nrrd \
    flat100.nrrd flat200.nrrd --range p10,p50 -y -s 32x32 -o x_%d.png
check "of which nothing is told" test "$(grep -c 'note: ' "$ERR")" = 0

# What is for one process, one rank does.
run 0 "info" launch 2 "$MPI_TOOL" info v.nrrd --json
check "info is told once" [ "$(wc -l <"$OUT")" -eq 1 ]
run 6 "compare" launch 2 "$MPI_TOOL" compare one_0.png one_1.png
run 0 "doctor" launch 2 "$MPI_TOOL" doctor
prints '^mpi  *[A-Z].*, 2 ranks$'
run 0 "help" launch 2 "$MPI_TOOL" help ranks
prints '^      --cut auto.equal.counted.bricks$'
refused 2 "--cut alone" 'snowglass-mpi' "$TOOL" v.nrrd -o x.png --cut equal
run 2 "help ranks alone" "$TOOL" help ranks
finish
