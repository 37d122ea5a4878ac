#!/bin/bash
# Real volumes: known figures, pairs that must hold the same voxels, pictures.
. "$(dirname "$0")/../../support/shell.sh"
[ -d "$DATA/classic" ] || {
    skipped all "the real volumes are absent"
    exit 77
}

engine="$DATA/classic/engine_256x256x110_u8.raw.gz"
head="$DATA/classic/CThead_256x256x113_u16be.raw.gz"
engine_form="--dims 256x256x110 --type uint8"
head_form="--dims 256x256x113 --type uint16 --endian big --spacing 1x1x2"

# Sums of engine and head were counted by another program over the same bytes.
run 0 "info of the engine" "$TOOL" info "$engine" $engine_form --json \
    --preset linear --range 0,255
prints '"voxels": 7208960, "finite": 7208960, "min": 0.0, "max": 255.0, "sum": 187475047.0, "wsum": 94688151341.0'
# Table 1 of the paper: 27, 77, 81 %.
prints '"threshold": 0.0, "ratio": 0.27[0-9]*\}, \{"threshold": 10.0, "ratio": 0.77[0-9]*\}, \{"threshold": 30.0, "ratio": 0.81'
printed "info of the head" '"spacing": \[1.0, 1.0, 2.0\]' "$TOOL" info "$head" $head_form --json
prints '"min": 0.0, "max": 3272.0, "sum": 2810724494.0, "wsum": 1419355380335.0'

figures() {
    "$TOOL" info "$1" --json 2>"$ERR" |
        sed -n 's/.*\("dims": \[[^]]*\]\).*\("voxels".*"wsum": [^,]*\).*/\1 \2/p'
}
pair() {
    figures "$DATA/$1" >a
    figures "$DATA/$2" >b
    check "$1 has figures" [ -s a ]
    check "$1 = $2" cmp -s a b
}
pair formats/nifti/big.nii.gz formats/nifti/little.nii.gz
pair formats/nifti/avg152T1_LR_nifti.nii formats/nifti/avg152T1_LR_nifti.nii.gz
pair formats/nifti/avf_float_32.nii.gz formats/nrrd/avf_float_32.nrrd
for form in .nhdr _gz.nrrd _byteskip_minus_one.nhdr _gz_lineskip.nrrd \
    _gz_byteskip_minus_one.nrrd .nii.gz; do
    pair formats/nrrd/pynrrd/BallBinary30x30x30.nrrd \
        formats/nrrd/pynrrd/BallBinary30x30x30$form
done
refused 3 "what is no NIfTI file" "not-nifti.nii" \
    "$TOOL" info "$DATA/formats/nifti/not-nifti.nii"

# picture NAME FILE OPTIONS...: it exists and shows something.
picture() {
    local name=$1 file=$2
    shift 2
    run 0 "a picture of $name" "$TOOL" render "$file" "$@" -s 128x128 -o $name.png
    check "$name is a PNG" is_png $name.png
    run 7 "an empty one" "$TOOL" render -q "$file" "$@" -s 128x128 \
        --opacity 0:0 -o empty.png -y
    run 6 "$name shows something" \
        "$TOOL" compare $name.png empty.png --tolerance 0.1
}
picture engine "$engine" $engine_form --threshold 10 --azimuth 30 --elevation 20
picture head "$head" $head_form --threshold 10 --azimuth 30 --elevation 20
picture nrrd "$DATA/formats/nrrd/avf_float_32.nrrd"
picture nifti "$DATA/medical/CT_AVM.nii.gz" --preset ct-bone
picture metaimage "$DATA/formats/metaimage/HeadMRVolume.mhd"
picture simulation "$DATA/sim/heptane.nii.gz"

# Every encoding and the original method: the same bits (test_same_bits: shear-warp).
sum() { sed -n 's/.*"checksum": "\([0-9a-f]*\)".*/\1/p' "$1"; }
exact="--isa scalar --method footprint --encoding"
for how in "$exact crs" "$exact bitmap" "$exact rle" "--method original"; do
    run 0 "the engine by $how" "$TOOL" -q "$engine" $engine_form $how \
        --azimuth 30 -s 128x128 -o e.npy -y --stats -
    sum "$OUT" >>sums
done
check "all four are equal" [ "$(sort -u sums | wc -l)" -eq 1 ]
finish
