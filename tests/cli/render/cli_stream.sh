#!/bin/bash
# Volumes larger than the memory that is allowed: pictures are those of the volume
# in memory, bit for bit; packed files, slices in files of their own, turntables,
# movies; and what cannot be done so, or does not fit even then, ends with one
# line.  cli_large.sh has a large one.
. "$(dirname "$0")/../../support/shell.sh"

same() { # NAME A B
    check "$1: bit for bit" cmp "$2" "$3"
}

# --- small ones --------------------------------------------------------------

"$TOOL" phantom head --dims 256x256x200 -q -o a.nrrd
"$TOOL" convert a.nrrd -q --type float32 -o a_f32.nrrd
look=(-s 96x96 --preset linear --opacity 120:0,250:1 --colormap viridis --shade phong)
views=("-z" "left --azimuth 30 --perspective")
for view in "${views[@]}"; do
    # shellcheck disable=SC2086
    run 0 "$view, whole" "$TOOL" render a.nrrd "${look[@]}" --view $view -q \
        -o whole.png -y --threads 2
    # shellcheck disable=SC2086
    run 0 "$view, in slabs" "$TOOL" render a.nrrd "${look[@]}" --view $view -v \
        -o slabs.png -y --memory 11M --stats slabs.json
    says 'a.nrrd: stays in its file and is read in slabs of at least [12].[0-9] MiB'
    says 'memory: at least 12.6 MiB'
    same "$view" whole.png slabs.png
    check "holds to its limit" python3 -c '
import json
told = json.load(open("slabs.json"))
assert told["bytes"]["peak"] <= 11 << 20, told
assert told["bytes"]["volume"] == 256 * 256 * 200, told
assert told["seconds"]["read"] > 0 and told["encoding"] == "bitmap", told'
    rm slabs.json
done

run 0 "floats, whole" "$TOOL" render a_f32.nrrd "${look[@]}" --view -z \
    --range 0,255 -q -o whole.png -y
run 0 "floats in slabs" "$TOOL" render a_f32.nrrd "${look[@]}" --view -z \
    --range 0,255 -q -o slabs.png -y --memory 46M
same "floats" whole.png slabs.png

# What lies around is found slab by slab.
run 0 "occlusion, whole" "$TOOL" render a.nrrd "${look[@]}" --view -z -q \
    --occlusion -o whole.png -y
run 0 "occlusion, in slabs" "$TOOL" render a.nrrd "${look[@]}" --view -z -v \
    --occlusion -o slabs.png -y --memory 16M
says 'a.nrrd: stays in its file'
same "occlusion" whole.png slabs.png

# Other modes; of the surface slabs that hold nothing of it too.
# Each from one of the eyes; test_stream has all.
for mode in mip sum iso; do
    value=()
    [ "$mode" = iso ] && value=(--iso 120)
    case $mode in
    mip | iso) eye="--view left --azimuth 30 --perspective" ;;
    *) eye="--view -z" ;;
    esac
    # shellcheck disable=SC2086
    run 0 "$mode $eye, whole" "$TOOL" render a_f32.nrrd -s 96x96 $eye -q \
        -m $mode "${value[@]}" -o whole.npy -y
    # shellcheck disable=SC2086
    run 0 "$mode $eye, in slabs" "$TOOL" render a_f32.nrrd -s 96x96 $eye \
        -v -m $mode "${value[@]}" -o slabs.npy -y --memory 46M
    says 'a_f32.nrrd: stays in its file'
    near=()
    [ "$mode" = sum ] && near=(--tolerance 0.05) # another order of adding
    run 0 "$mode $eye is the same" "$TOOL" compare whole.npy slabs.npy \
        "${near[@]}"
done
run 0 "bytes of a surface, whole" "$TOOL" render a.nrrd -s 96x96 -q -m iso \
    --iso 120 -o whole.npy -y --depth whole.depth.npy
run 0 "bytes of a surface in slabs" "$TOOL" render a.nrrd -s 96x96 -q -m iso \
    --iso 120 -o slabs.npy -y --memory 11M --depth slabs.depth.npy
same "bytes of a surface" whole.npy slabs.npy
same "its depths" whole.depth.npy slabs.depth.npy
mv slabs.npy slabs_iso.npy
run 0 "depths, whole" "$TOOL" render a.nrrd "${look[@]}" --view -z -q \
    -o whole.npy -y --depth whole.depth.npy
run 0 "depths in slabs" "$TOOL" render a.nrrd "${look[@]}" --view -z -q \
    -o slabs.npy -y --memory 11M --depth slabs.depth.npy
same "the picture of depths" whole.npy slabs.npy
run 0 "depths but for rounding" "$TOOL" compare whole.depth.npy \
    slabs.depth.npy --tolerance 4e-6
run 0 "a turntable of a surface in slabs" "$TOOL" turntable a.nrrd -s 96x96 \
    -q -m iso --iso 120 --frames 2 -o 'i_%d.npy' --memory 11M
same "its first frame" i_0.npy slabs_iso.npy

"$TOOL" convert a.nrrd -q -o a.nii.gz
run 0 "a packed file, whole" "$TOOL" render a.nii.gz "${look[@]}" -q \
    -o whole.png -y
run 0 "a packed file in slabs" "$TOOL" render a.nii.gz "${look[@]}" \
    -o slabs.png -y --memory 11M
says 'note: a.nii.gz is smaller than its voxels and is unpacked again for each'
same "a packed file" whole.png slabs.png

run 0 "a turntable, whole" "$TOOL" turntable a.nrrd "${look[@]}" -q \
    --frames 2 -o 'w_%d.png'
run 0 "a turntable in slabs" "$TOOL" turntable a.nrrd "${look[@]}" -q \
    --frames 2 -o 's_%d.png' --memory 11M
for i in 0 1; do
    same "frame $i" "w_$i.png" "s_$i.png"
done
run 0 "a movie in slabs" "$TOOL" movie a.nrrd a.nrrd "${look[@]}" -q \
    --range 0,255 -o 'm_%d.png' --memory 11M --fit volume
run 0 "its first step alone" "$TOOL" render a.nrrd "${look[@]}" -q \
    --range 0,255 -o whole.png -y --fit volume
same "a movie" m_0.png whole.png
same "its second step" m_1.png whole.png

# --- nothing is left ----------------------------------------------------------

"$TOOL" phantom cube --dims 256x256x200 -q -o mask.nrrd
for limit in $(long_tier && echo 200M) 11M; do # in memory, and in slabs
    run 7 "a mask of no voxel under $limit" "$TOOL" render a.nrrd -s 64x64 \
        --view -z -o none.png -y --mask mask.nrrd --labels 300 --memory $limit
    says 'mask.nrrd: no voxel is left inside this mask, whose values are [0-9]* to 255; correct'
    check "is told once" test "$(grep -c 'no voxel is left' "$ERR")" = 1
    run 7 "planes that leave nothing under $limit" "$TOOL" render a.nrrd \
        -s 64x64 --view -z -o none.png -y --clip 1,0,0,-9999 --memory $limit
    says 'clip: no voxel is left'
    run 0 "planes that leave some under $limit" "$TOOL" render a.nrrd \
        -s 64x64 --view -z -o none.png -y --clip 1,0,0,-50 --memory $limit
    check "are not remarked on" bash -c "! grep -q 'no voxel\|compressed' '$ERR'"
done
rm none.png

# --- what is refused ---------------------------------------------------------

small=(-s 64x64 -o none.png)
run 0 "all voxels under 11M" "$TOOL" render a.nrrd "${small[@]}" \
    --preset linear --memory 11M -q
rm none.png
refused 5 "the smallest slab" \
    'a.nrrd: one slab, tables and the picture need 17.2 MiB, over the --memory of 3.0 MiB; raise it' \
    "$TOOL" render a.nrrd -s 1024x1024 -o none.png --memory 3M
refused 5 "a deterministic picture by shear-warp" \
    'a deterministic picture by method shear-warp needs all voxels' \
    "$TOOL" render a.nrrd "${small[@]}" --deterministic --memory 11M -q
refused 5 "a deterministic picture by a footprint method" \
    'a deterministic picture by method footprint needs all voxels' \
    "$TOOL" render a.nrrd "${small[@]}" --method footprint --deterministic \
    --memory 11M -q
refused 5 "the range of all steps" 'and the range of all steps needs all' \
    "$TOOL" movie a.nrrd a.nrrd -s 64x64 -o 'n_%d.png' --memory 11M
check "nothing is left" test ! -e none.png -a ! -e n_0.png
run 0 "footprints" "$TOOL" render a.nrrd "${small[@]}" -q --method footprint \
    -o exact.npy -y
run 0 "footprints under a limit" "$TOOL" render a.nrrd "${small[@]}" -q \
    --method footprint --memory 11M -o slabs.npy -y
run 0 "are nearly the same" "$TOOL" compare exact.npy slabs.npy --tolerance 4e-6

# --- slices in files of their own --------------------------------------------

if [ -f "$DATA/dicom/ct_abdomen_20of275.tar.gz" ]; then
    tar xzf "$DATA/dicom/ct_abdomen_20of275.tar.gz"
    bone=(-s 2048x2048 --preset linear --range -1000,2000
        --opacity 150:0,400:1 --view superior)
    run 0 "DICOM, whole" "$TOOL" render ct_abdomen "${bone[@]}" -q \
        -o whole.png -y
    run 0 "DICOM in slabs" "$TOOL" render ct_abdomen "${bone[@]}" -v \
        -o slabs.png -y --memory 73M
    says 'ct_abdomen: stays in its file'
    same "DICOM" whole.png slabs.png
fi
if [ -f "$DATA/classic/cthead-8bit_99tif.tar.gz" ]; then
    mkdir tiff
    tar xzf "$DATA/classic/cthead-8bit_99tif.tar.gz" -C tiff
    stack=$(dirname "$(find tiff -name '*.tif' | head -n 1)")
    run 0 "TIFF files, whole" "$TOOL" render "$stack" -s 96x96 \
        --opacity 150:0,250:1 -q -o whole.png -y
    run 0 "TIFF files in slabs" "$TOOL" render "$stack" -s 96x96 \
        --opacity 150:0,250:1 -v -o slabs.png -y --memory 6M
    says 'stays in its file'
    same "TIFF files" whole.png slabs.png
fi

# --- pipes, and few pixels ---------------------------------------------------

# Pipes can be read once only: they are not looked at beforehand.
run 0 "a volume of a file" "$TOOL" phantom head --dims 48x48x48 -o pipe.nrrd
run 0 "its picture" "$TOOL" render -q pipe.nrrd -o file.npy
mkfifo pipe
cat pipe.nrrd >pipe &
run 0 "the same through a pipe" "$TOOL" render -q pipe -o pipe.npy
run 0 "is the same" "$TOOL" compare file.npy pipe.npy

# What is made of all voxels at once does not fit beside them.
run 0 "a larger volume" "$TOOL" phantom head --dims 256x256x256 -o wide.nrrd
run 0 "few pixels" "$TOOL" render wide.nrrd -s 16x16 --opacity 150:0,250:1 \
    -q -o wide.npy
run 0 "few pixels under a limit" "$TOOL" render wide.nrrd -s 16x16 \
    --opacity 150:0,250:1 --memory 18M -q -o thin.npy
run 0 "are nearly the same" "$TOOL" compare wide.npy thin.npy --tolerance 4e-6

finish
