#!/bin/bash
# mpi_render.sh - the tool as many ranks makes the pictures of one process, from
# all sides, however the volume is cut and the pictures are combined.
. "$(dirname "$0")/../support/mpi.sh"
long_tier || COUNTS=3 MOST=3
head="phantom:head --dims 40x36x44 -s 160x120 -q"

# render N NAME OPTION...: a picture by N ranks, and as alone.
render() {
    local ranks=$1 name=$2
    shift 2
    # shellcheck disable=SC2086
    run 0 "$name by $ranks ranks" \
        launch "$ranks" "$MPI_TOOL" $head -y -o many.npy "$@"
    run 0 "$name by $ranks ranks is as by one" "$TOOL" compare one.npy \
        many.npy --tolerance "${TOLERANCE:-1/255}"
}

others=("--view +x" "--view -y" "--view +z" "--view iso --perspective")
long_tier || others=()
for view in "${others[@]}" "--azimuth 33 --elevation 21 --roll 10 --zoom 1.3"; do
    # shellcheck disable=SC2086
    run 0 "$view alone" "$TOOL" $head $view -y -o one.npy
    for ranks in $COUNTS; do
        # shellcheck disable=SC2086
        render "$ranks" "$view" $view
    done
done

# What falls on the picture itself is shared in any boxes as well.
for method in footprint $(long_tier && echo original); do
    way="--method $method --azimuth 33 --elevation 21 --perspective 60"
    # shellcheck disable=SC2086
    run 0 "$way alone" "$TOOL" $head $way -y -o one.npy
    # shellcheck disable=SC2086
    TOLERANCE=1e-6 render "$MOST" "$way in bricks" $way --cut bricks
done

# The last view is oblique enough for bricks.
ways=("--cut equal" "--combine tree" "--combine swap" "--combine direct"
    "--cut bricks")
long_tier || ways=()
for way in "${ways[@]}" "--combine radix:3"; do
    # shellcheck disable=SC2086
    run 0 "a picture alone" "$TOOL" $head --azimuth 70 -y -o one.npy
    # shellcheck disable=SC2086
    render "$MOST" "$way" --azimuth 70 $way
done

# shellcheck disable=SC2086
run 0 "a deterministic picture" "$TOOL" $head --deterministic -y -o one.npy
TOLERANCE=0 render 3 "a deterministic picture" --deterministic
check "it has the same bits" cmp -s one.npy many.npy

# Shear-warp: ranks agree on the range of values, and share a lattice.
value="--method shear-warp --azimuth 33 --elevation 21"
ways=("" "--quality high")
long_tier || ways=()
for way in "${ways[@]}" "--perspective"; do
    # shellcheck disable=SC2086
    run 0 "by value $way alone" "$TOOL" $head $value $way -y -o one.npy
    # shellcheck disable=SC2086
    render "$MOST" "by value in bricks $way" $value $way --cut bricks
done
clip="--clip 1,0.5,0,30"
# shellcheck disable=SC2086
run 0 "a plane by value alone" "$TOOL" $head $value $clip -y -o one.npy
cuts="equal counted bricks"
long_tier || cuts=bricks
for cut in $cuts; do
    # shellcheck disable=SC2086
    render "$MOST" "a plane, --cut $cut" $value $clip --cut $cut
done
# Ranks without voxels of their own know the planes too.
run 0 "a thin volume" "$TOOL" phantom head --dims 12x10x3 -o thin.nrrd -y
run 0 "cut" "$TOOL" thin.nrrd --clip=1,0,0,1 -s 64 -y -o one.npy
run 0 "cut by ranks with nothing" launch 5 "$MPI_TOOL" thin.nrrd \
    --clip=1,0,0,1 -s 64 -y -o many.npy
run 0 "are the same" "$TOOL" compare one.npy many.npy --tolerance 1/255

# shellcheck disable=SC2086
run 0 "deterministic by value" "$TOOL" $head $value --deterministic -y \
    -o one.npy
# shellcheck disable=SC2086
TOLERANCE=0 render 3 "deterministic by value" $value --deterministic
check "it has the same bits" cmp -s one.npy many.npy

# shellcheck disable=SC2086
run 0 "figures" launch 2 "$MPI_TOOL" $head -y --encoding bitmap -o many.png \
    --stats -
prints '"ranks": 2'
prints '"interesting": |"load": 1'
# shellcheck disable=SC2086
"$TOOL" $head -y --encoding bitmap -o one.png --stats one.json
check "bytes of EA are those of one process" [ "$(number ea)" = \
    "$(sed -n 's/.*"ea": \([0-9]*\).*/\1/p' one.json)" ]

# Drafts of few pixels, which are means of many samples.
drafts=("40x50 --azimuth 33 --cut bricks" "64x64 --view +x --cut counted"
    "64x64 --azimuth 70 --roll 20 --perspective --cut equal")
long_tier || drafts=()
for draft in "${drafts[@]}"; do
    # shellcheck disable=SC2086
    set -- phantom:engine --dims 131x144x127 --quality draft -q -s $draft
    run 0 "a draft alone, $draft" "$TOOL" "${@:1:$(($# - 2))}" -y -o one.npy
    for ranks in $COUNTS; do
        run 0 "a draft by $ranks ranks" \
            launch "$ranks" "$MPI_TOOL" "$@" -y -o many.npy
        run 0 "it is as by one" "$TOOL" compare one.npy many.npy \
            --tolerance 1/255
    done
done

# Files of which each rank reads its part, and unpacks it in turn.
run 0 "a file" "$TOOL" phantom engine --dims 40x40x40 -o v.nrrd
run 0 "a packed file" "$TOOL" phantom engine --dims 40x40x40 -o v.nii.gz
for file in $(long_tier && echo v.nrrd) v.nii.gz; do
    run 0 "$file alone" "$TOOL" $file -q -y -o one.npy
    run 0 "$file by 3" launch 3 "$MPI_TOOL" $file -q -y -o many.npy
    run 0 "$file by 3 is as by one" "$TOOL" compare one.npy many.npy \
        --tolerance 1/255
done

# Whoever has read the end of it, one line says what lies behind.
for size in 40 90; do
    run 0 "another packed file" "$TOOL" phantom engine \
        --dims ${size}x${size}x$size -q -y -o tail.nii.gz
    echo more >>tail.nii.gz
    run 0 "more behind the data" launch 3 "$MPI_TOOL" tail.nii.gz -y -o x.png
    check "is said once" [ "$(grep -c 'compressed data are ignored' "$ERR")" = 1 ]
done

# Movies.  On a background, since a transparent pixel is rounded twice: its
# colour, and its alpha.
turn="turntable v.nrrd --frames 4 -s 64x64 -q --background black"
# shellcheck disable=SC2086
run 0 "a turntable alone" "$TOOL" $turn -o one_%02d.png
# shellcheck disable=SC2086
run 0 "a turntable by 3" launch 3 "$MPI_TOOL" $turn -o many_%02d.png
# A step of 8 bits, and the rounding of its floats.
for frame in 0 1 2 3; do
    run 0 "frame $frame" "$TOOL" compare one_0$frame.png many_0$frame.png \
        --tolerance 1.001/255
done
if ! long_tier; then
    skipped "movies, looks and masks by ranks" "left to the long tier"
    finish
fi
rm many_02.png
# shellcheck disable=SC2086
run 0 "a turntable is resumed" launch 3 "$MPI_TOOL" $turn --resume \
    -o many_%02d.png --stats stats.json
check "one frame was missing" grep -q '"rendered": 1, "kept": 3' stats.json
run 0 "its frame is the same" "$TOOL" compare one_02.png many_02.png \
    --tolerance 1.001/255
step=0
for name in head engine shells; do
    "$TOOL" phantom $name --dims 32x32x32 -q -o step$((step++)).nrrd
done
movie="movie step%d.nrrd -s 64x64 -q --background black"
# shellcheck disable=SC2086
run 0 "a movie alone" "$TOOL" $movie -o step_%d.png
# shellcheck disable=SC2086
run 0 "a movie by 2" launch 2 "$MPI_TOOL" $movie -o steps_%d.png
for frame in 0 1 2; do
    run 0 "step $frame" "$TOOL" compare step_$frame.png steps_$frame.png \
        --tolerance 1.001/255
done

# Ranks share the reading for the look of all steps where there are more of them
# than steps, or a step is too large for one: the look is that of one process.
"$TOOL" phantom engine --dims 240x240x251 -q -o large0.nrrd
"$TOOL" phantom head --dims 240x240x251 -q -o large1.nrrd
for way in "step0.nrrd step1.nrrd" "step0.nrrd step1.nrrd --crop :,3:30,5:31" \
    "large0.nrrd large1.nrrd"; do
    # shellcheck disable=SC2086
    run 0 "a movie alone, $way" "$TOOL" movie $way -s 64x64 -y -o step_%d.npy
    look=$(grep -o 'grey .*histogram)' "$ERR")
    [ "${way%%0*}" = large ] && way+=" --memory 13600K"
    # shellcheck disable=SC2086
    run 0 "by 12" launch 12 "$MPI_TOOL" movie $way -s 64x64 -y \
        -o steps_%d.npy
    check "one look: $look" grep -qF "${look:-none}" "$ERR"
    for frame in 0 1; do
        run 0 "step $frame" "$TOOL" compare step_$frame.npy steps_$frame.npy \
            --tolerance 1/255
    done
done
refused 5 "a step too large for one" 'the range of all steps needs' \
    "$TOOL" movie large0.nrrd large1.nrrd --memory 13600K -o x_%d.png

# Each rank reads its box of a mask.
"$TOOL" phantom shells --dims 40x36x44 -q -o mask.nrrd
mask="--mask mask.nrrd --labels 1-120 --clip 1,0.5,0,30 --azimuth 33"
for box in "" "--crop 4:,:30,9:40"; do
    # shellcheck disable=SC2086
    run 0 "a mask alone $box" "$TOOL" $head $mask $box -y -o one.npy
    for cut in equal counted bricks; do
        # shellcheck disable=SC2086
        render "$MOST" "a mask, --cut $cut $box" $mask $box --cut $cut
    done
done
refused 3 "a mask of another grid" 'the mask has 40x36x44 voxels' \
    "$MPI_TOOL" phantom:head --dims 40x36x40 --mask mask.nrrd -o x.png

# What a limit has no room for stays in the file: the pictures have the same
# bits, with every view, mode, cut and turn, and no rank takes more.
"$TOOL" phantom engine --dims 160x150x170 -q -o slab.nrrd
"$TOOL" convert slab.nrrd -o packed.nii.gz -q
ways=("" "--azimuth 70 --shade phong" "--cut equal --mode mip"
    "--mode iso --iso 90 --perspective" "--view +x --mode mean")
long_tier || ways=("--azimuth 70 --shade phong")
for way in "${ways[@]}"; do
    for file in slab.nrrd packed.nii.gz; do
        # shellcheck disable=SC2086
        run 0 "$file in memory, $way" launch 3 "$MPI_TOOL" $file $way \
            -s 64x64 -q -y -o one.npy
        # shellcheck disable=SC2086
        run 0 "$file in its file, $way" launch 3 "$MPI_TOOL" $file $way \
            -s 64x64 -q -y -o many.npy --memory 5M --stats many.json
        check "it has the same bits" cmp -s one.npy many.npy
        check "no rank takes more" \
            [ "$(grep -o '"peak": [0-9]*' many.json | grep -o '[0-9]*')" -le 5242880 ]
    done
done
if long_tier; then
    # Without a limit the memory of a rank shrinks with their number: 1.3 times
    # its part of what one takes, and 4 MiB.
    peak() { grep -o '"peak": [0-9]*' "$1" | grep -o '[0-9]*'; }
    "$TOOL" phantom head --dims 256x256x256 -q -o large.nrrd
    run 0 "one process" "$TOOL" large.nrrd --view +z -s 64x64 -j 1 -q -y -o one.npy \
        --stats one.json
    for ranks in 2 4; do
        run 0 "$ranks ranks" launch $ranks "$MPI_TOOL" large.nrrd --view +z -s 64x64 -j 1 \
            -q -y -o many.npy --stats many.json
        check "$ranks ranks take less each" [ "$(peak many.json)" -le \
            $(($(peak one.json) * 13 / 10 / ranks + 4194304)) ]
    done
    rm large.nrrd

    turn="turntable slab.nrrd --frames 5 -s 64x64 -y -q --background black"
    # shellcheck disable=SC2086
    run 0 "a turn in memory" launch 3 "$MPI_TOOL" $turn -o one_%d.png
    # shellcheck disable=SC2086
    run 0 "a turn in its file" launch 3 "$MPI_TOOL" $turn -o many_%d.png \
        --memory 6M
    for frame in 0 1 2 3 4; do
        check "frame $frame" cmp -s one_$frame.png many_$frame.png
    done
fi

# That it leaves nothing is told once, whoever has read what.
for way in "render mask.nrrd -o x.png" "render mask.nrrd -o x.png --cut equal" \
    "turntable mask.nrrd -o x_%d.png --frames 2" \
    "movie step0.nrrd step1.nrrd -o x_%d.png" \
    "movie step0.nrrd step1.nrrd step2.nrrd -o x_%d.png"; do
    for ranks in 2 "$MOST"; do
        # shellcheck disable=SC2086
        run 7 "$way by $ranks" launch "$ranks" "$MPI_TOOL" $way -y -s 32x32 \
            --clip 0,0,1,-1000
        check "is said once" test "$(grep -c 'no voxel is left' "$ERR")" = 1
    done
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
flat="movie flat000.nrrd flat100.nrrd flat200.nrrd --range p10,p50 -y -s 32x32"
# shellcheck disable=SC2086
run 0 "one value a step" "$TOOL" $flat -o x_%d.png
check "of which nothing is told" test "$(grep -c 'note: ' "$ERR")" = 0
# shellcheck disable=SC2086
run 0 "the same by 3" launch 3 "$MPI_TOOL" $flat -o x_%d.png
check "nor by ranks" test "$(grep -c 'note: ' "$ERR")" = 0

# What is for one process, one rank does.
run 0 "info" launch 2 "$MPI_TOOL" info v.nrrd --json
check "info is told once" [ "$(wc -l <"$OUT")" -eq 1 ]
run 6 "compare" launch 2 "$MPI_TOOL" compare one_00.png one_01.png
run 0 "doctor" launch 2 "$MPI_TOOL" doctor
prints '^mpi  *[A-Z].*, 2 ranks$'
run 0 "help" launch 2 "$MPI_TOOL" help ranks
prints '^      --cut auto.equal.counted.bricks$'
refused 2 "--cut alone" 'snowglass-mpi' "$TOOL" v.nrrd -o x.png --cut equal
run 2 "help ranks alone" "$TOOL" help ranks
finish
