#!/bin/bash
# tf, --tf, --scale log and presets through the tool: what files of other programs say
# becomes a picture, is shown, and is converted.
. "$(dirname "$0")/../../support/shell.sh"
SEEDS=$HERE/../fuzz/corpus/tf

small() { "$TOOL" render phantom:shells --dims 24x24x24 -s 40x40 "$@"; }

# --- list, show, convert ------------------------------------------------------
run 0 "tf list" "$TOOL" tf list
for word in ct-aaa ct-coronary-arteries-3 mr-t2-brain dti-fa-brain viridis \
    tab10; do
    prints "^  $word( |$)"
done
run 0 "tf list --json" "$TOOL" tf list --json
prints '"presets": \["linear", .*"colormaps": \["grey"'
run 0 "tf show of a preset" "$TOOL" tf show CT_Cardiac
prints '^kind +preset'
prints '^gradient +60 +1\.0000'
run 0 "tf show of both signs" "$TOOL" tf show signed
prints '^values +shares of a range that is symmetric around 0$'
run 0 "tf show of a colour map" "$TOOL" tf show magma
prints '^kind +colour map'
run 0 "tf show of a reversed map" "$TOOL" tf show magma_r
prints '^name +magma_r'
run 0 "tf show of a file" "$TOOL" tf show "$SEEDS/presets.xml#ct-bone"
prints '^name +CT-Bone'
run 0 "tf show as a picture" "$TOOL" tf show ct-bone -o show.png
check "is a PNG" is_png show.png
refused 4 "which is not written over" 'show.png' "$TOOL" tf show ct-bone \
    -o show.png
for file in ct.vp diverging.json niivue.json own.json points.csv rgba.pal; do
    run 0 "$file to JSON" "$TOOL" tf convert "$SEEDS/$file" -o "$file.json"
    run 0 "and that again" "$TOOL" tf convert "$file.json" -o again.json -y
    check "is the same" cmp -s "$file.json" again.json
    run 0 "$file shown" small -q --tf "$SEEDS/$file" -o a.png -y
    run 0 "and the converted one" small -q --tf "$file.json" -o b.png -y
    check "$file: one picture" cmp -s a.png b.png
done
run 0 "a preset to a table" "$TOOL" tf convert ct-bone -o bone.csv
run 0 "as a preset" small -q --preset ct-bone --range 150,1500 -o a.png -y
run 0 "and as a table" small -q --tf bone.csv --range 150,1500 -o b.png -y
check "one picture" cmp -s a.png b.png
run 0 "a table loses gradients" "$TOOL" tf convert ct-cardiac -o heart.csv
says 'heart.csv: a table cannot hold the gradient opacity'
run 0 "to standard output" "$TOOL" tf convert ct-bone -o -
prints '"snowglass-tf": 1'

refused 2 "tf alone" 'tf list, tf show' "$TOOL" tf
refused 2 "tf of an unknown word" 'tf list, tf show' "$TOOL" tf paint x
refused 2 "no output" 'no output file given' "$TOOL" tf convert ct-bone
refused 2 "another suffix" 'x.vp: transfer functions are written as' "$TOOL" tf convert ct-bone \
    -o x.vp
refused 3 "no such name" 'nothing: is not a file, a preset or a colour map' "$TOOL" tf show \
    nothing
refused 3 "no such file" 'none.vp: cannot be opened' "$TOOL" tf show none.vp
refused 3 "no such preset in a file" "no preset 'x'" "$TOOL" tf show \
    "$SEEDS/presets.xml#x"

# --- --tf ---------------------------------------------------------------------
run 0 "a file's points are told" small --tf "$SEEDS/niivue.json" -o n.png
says 'niivue 100\.\.1000; opacity 0 at 100.*\(from the file\); opacity per voxel'
run 0 "its unit too" small --tf "$SEEDS/own.json" -o o.png
says 'mine .*gradient opacity 0 at .*; opacity per mm'
run 0 "a recipe counts more" small --tf "$SEEDS/own.json" \
    --config '{"opacity-unit": "voxel"}' -o o.png -y
says 'opacity per voxel'
run 0 "spread over a range" small --tf "$SEEDS/niivue.json" --range 10,200 \
    -o r.png
says 'niivue 10\.\.200'
run 0 "kept in a configuration" small -q --tf "$SEEDS/points.csv" --scale log \
    --range 1,200 -o c.png --save-config c.json
run 0 "and taken from it" "$TOOL" render -q --config c.json -o d.png
check "the same picture" cmp -s c.png d.png
run 0 "info reads it too" "$TOOL" info phantom:shells --tf "$SEEDS/ct.vp"
says 'light is ignored'
refused 3 "a cut file" 'cut.vp: the list of opacities ends early' \
    small --tf "$SEEDS/cut.vp" -o x.png
refused 3 "a file that is none" 'none.json: cannot be opened' \
    small --tf none.json -o x.png
refused 3 "a folder" 'cannot be opened' small --tf . -o x.png
refused 2 "with a preset" 'conflicts with --preset' \
    small --tf "$SEEDS/ct.vp" --preset linear -o x.png
check "nothing is written then" absent x.png

# --- --scale log --------------------------------------------------------------
run 0 "by logarithms" small --scale log --preset linear --range 1,255 -o l.png
says 'grey 1\.\.255 logarithmic; opacity 0 at 1, 1 at 255'
run 0 "from the histogram" small --scale log -o m.png
says 'logarithmic'
run 0 "every method" small -q --scale log --preset linear --method footprint \
    --shade none -o f.png
refused 2 "a point at 0" 'the opacity at 0 has no logarithm; give values above 0, or symlog' \
    small --scale log --opacity 0:0,9:1 -o x.png
refused 2 "a colour below 0" 'the colour at -2 has no logarithm' \
    small --scale log -c "-2:#000000,9:#ff0000" -o x.png
refused 2 "Hounsfield units" 'give a range too' small --scale log --preset ct-soft \
    -o x.png

# --- names --------------------------------------------------------------------
for name in CT-AAA CT-Chest-Contrast-Enhanced ctcoronaryarteries2 MR_T2_Brain \
    DTI-FA-Brain; do
    run 0 "the preset $name" small -q --preset "$name" -o p.png -y
done
finish
