#!/bin/bash
# Volumes larger than the memory that is allowed: pictures are those of the volume
# in memory, bit for bit; packed files, slices in files of their own, turntables,
# movies; and what cannot be done so, or does not fit even then, ends with one
# line.  cli_large.sh has a large one.
. "$(dirname "$0")/../../support/shell.sh"

# --- small ones --------------------------------------------------------------

"$TOOL" phantom head --dims 256x256x200 -q -o a.nrrd
"$TOOL" convert a.nrrd -q --type float32 -o a_f32.nrrd
look="-s 96x96 --preset linear --opacity 120:0,250:1 --colormap viridis --shade phong"
left="--view left --azimuth 30 --perspective"

# slabs NAME MEMORY NEAR INPUT OPTION...: a picture in slabs of its file is that in
# memory, bit for bit; with NEAR, but for so much.
slabs() {
    run 0 "$1, whole" "$TOOL" render "${@:4}" -q -o whole.npy -y --threads 2
    told "$1, in slabs" "stays in its file" "$TOOL" render "${@:4}" -v -o slabs.npy -y \
        --memory "$2" --stats slabs.json
    if [ -z "$3" ]; then
        same_file "$1: bit for bit" whole.npy slabs.npy
    else
        run 0 "$1: within $3" "$TOOL" compare whole.npy slabs.npy --tolerance "$3"
    fi
}

for view in "--view -z" "$left"; do
    slabs "$view" 11M "" a.nrrd $look $view
    says 'a.nrrd: stays in its file and is read in slabs of at least [12].[0-9] MiB'
    says 'memory: at least 12.6 MiB'
    check "holds to its limit" python3 -c '
import json
told = json.load(open("slabs.json"))
assert told["bytes"]["peak"] <= 11 << 20, told
assert told["bytes"]["volume"] == 256 * 256 * 200, told
assert told["seconds"]["read"] > 0 and told["encoding"] == "bitmap", told'
done
slabs "floats" 46M "" a_f32.nrrd $look --view -z --range 0,255
# What lies around is found slab by slab.
slabs "occlusion" 16M "" a.nrrd $look --view -z --occlusion

# Other modes are in test_stream; depths, and a surface of which some slabs hold nothing.
for options in "-s 96x96 -m iso --iso 120" "$look --view -z"; do
    run 0 "depths, whole" "$TOOL" render a.nrrd $options -q -o whole.npy -y \
        --depth whole.depth.npy
    run 0 "depths in slabs" "$TOOL" render a.nrrd $options -q -o slabs.npy -y \
        --memory 11M --depth slabs.depth.npy
    same_file "the picture of depths" whole.npy slabs.npy
    run 0 "depths but for rounding" "$TOOL" compare whole.depth.npy \
        slabs.depth.npy --tolerance 4e-6
done
slabs "bytes of a surface" 11M "" a.nrrd -s 96x96 -m iso --iso 120
run 0 "a turntable of a surface in slabs" "$TOOL" turntable a.nrrd -s 96x96 \
    -q -m iso --iso 120 --frames 2 -o 'i_%d.npy' --memory 11M
same_file "its first frame" i_0.npy slabs.npy

"$TOOL" phantom head --dims 128x128x160 -q -o few.nii.gz
slabs "a packed file" 3500K "" few.nii.gz $look --view -z
says 'note: few.nii.gz is smaller than its voxels and is unpacked again for each'

run 0 "a turntable, whole" "$TOOL" turntable a.nrrd $look -q \
    --frames 2 -o 'w_%d.png'
run 0 "a turntable in slabs" "$TOOL" turntable a.nrrd $look -q \
    --frames 2 -o 's_%d.png' --memory 11M
check "has the same frames" same_bytes "w_0.png w_1.png" "s_0.png s_1.png"
run 0 "a movie in slabs" "$TOOL" movie a.nrrd a.nrrd $look -q \
    --range 0,255 -o 'm_%d.png' --memory 11M --fit volume
run 0 "its first step alone" "$TOOL" render a.nrrd $look -q \
    --range 0,255 -o whole.png -y --fit volume
check "is each of its frames" same_bytes "m_0.png m_1.png" "whole.png whole.png"

# --- nothing is left ----------------------------------------------------------

"$TOOL" phantom cube --dims 256x256x200 -q -o mask.nrrd
limited=(-s 64x64 --view -z -o none.png -y --memory 11M)
run 7 "a mask of no voxel" "$TOOL" render a.nrrd "${limited[@]}" --mask mask.nrrd \
    --labels 300
says 'mask.nrrd: no voxel is left inside this mask, whose values are [0-9]* to 255; correct'
check "is told once" test "$(grep -c 'no voxel is left' "$ERR")" = 1
run 7 "planes that leave nothing" "$TOOL" render a.nrrd "${limited[@]}" \
    --clip 1,0,0,-9999
says 'clip: no voxel is left'
run 0 "planes that leave some" "$TOOL" render a.nrrd "${limited[@]}" --clip 1,0,0,-50 \
    -m iso --iso 120
check "are not remarked on" bash -c "! grep -q 'no voxel\|compressed' '$ERR'"
rm none.png

# --- what is refused ---------------------------------------------------------

small="-s 64x64 -o none.png"
run 0 "all voxels under 11M" "$TOOL" render a.nrrd $small \
    --preset linear --memory 11M -q
rm none.png
refusals 5 "$TOOL" <<'END'
render a.nrrd -s 1024 -o none.png --memory 3M|one slab, tables and the picture need 17.2 MiB, over the --memory of
render a.nrrd $small --deterministic --memory 11M -q|a deterministic picture by method shear-warp needs all voxels
render a.nrrd $small --method footprint --deterministic --memory 11M -q|by method footprint needs all voxels
movie a.nrrd a.nrrd -s 64x64 -o n_%d.png --memory 11M|and the range of all steps needs all
END
check "nothing is left" test ! -e none.png -a ! -e n_0.png
"$TOOL" convert few.nii.gz -q -o few.nrrd
slabs "footprints" 2500K 4e-6 few.nrrd -s 64x64 --method footprint

# --- slices in files of their own --------------------------------------------

if [ -f "$DATA/dicom/ct_abdomen_20of275.tar.gz" ]; then
    tar xzf "$DATA/dicom/ct_abdomen_20of275.tar.gz"
    slabs "DICOM" 73M "" ct_abdomen -s 2048x2048 --preset linear --range -1000,2000 \
        --opacity 150:0,400:1 --view superior
fi
if [ -f "$DATA/classic/cthead-8bit_99tif.tar.gz" ]; then
    mkdir tiff
    tar xzf "$DATA/classic/cthead-8bit_99tif.tar.gz" -C tiff
    stack=$(dirname "$(find tiff -name '*.tif' | head -n 1)")
    slabs "TIFF files" 6M "" "$stack" -s 96x96 --opacity 150:0,250:1
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
slabs "few pixels" 18M 4e-6 wide.nrrd -s 16x16 --opacity 150:0,250:1

finish
