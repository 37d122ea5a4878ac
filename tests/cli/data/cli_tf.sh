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
printed "tf list --json" '"presets": \["linear", .*"colormaps": \["grey"' "$TOOL" tf list --json
printed "tf show of a preset" '^kind +preset' "$TOOL" tf show CT_Cardiac
prints '^gradient +60 +1\.0000'
run 0 "tf show of both signs" "$TOOL" tf show signed
prints '^values +shares of a range that is symmetric around 0$'
printed "tf show of a colour map" '^kind +colour map' "$TOOL" tf show magma
printed "tf show of a reversed map" '^name +magma_r' "$TOOL" tf show magma_r
printed "tf show of a file" '^name +CT-Bone' "$TOOL" tf show "$SEEDS/presets.xml#ct-bone"
run 0 "tf show as a picture" "$TOOL" tf show ct-bone -o show.png
check "is a PNG" is_png show.png
refused 4 "which is not written over" 'show.png' "$TOOL" tf show ct-bone \
    -o show.png
for file in ct.vp diverging.json niivue.json own.json points.csv rgba.pal; do
    run 0 "$file to JSON" "$TOOL" tf convert "$SEEDS/$file" -o "$file.json"
    run 0 "and that again" "$TOOL" tf convert "$file.json" -o again.json -y
    check "is the same" cmp -s "$file.json" again.json
    pairs png render phantom:shells --dims 24x24x24 -s 40x40 <<END
$file and what is made of it | --tf $SEEDS/$file | = | --tf $file.json
END
done
run 0 "a preset to a table" "$TOOL" tf convert ct-bone -o bone.csv
pairs png render phantom:shells --dims 24x24x24 -s 40x40 --range 150,1500 <<'END'
a preset and its table | --preset ct-bone | = | --tf bone.csv
END
run 0 "a table loses gradients" "$TOOL" tf convert ct-cardiac -o heart.csv
says 'heart.csv: a table cannot hold the gradient opacity'
printed "to standard output" '"snowglass-tf": 1' "$TOOL" tf convert ct-bone -o -

refusals 2 "$TOOL" tf <<'END'
-q|tf list, tf show
paint x|tf list, tf show
convert ct-bone|no output file given
convert ct-bone -o x.vp|x.vp: transfer functions are written as
END
refusals 3 "$TOOL" tf show <<'END'
nothing|nothing: is not a file, a preset or a colour map
none.vp|none.vp: cannot be opened
$SEEDS/presets.xml#x|no preset 'x'
END

# --- --tf ---------------------------------------------------------------------
run 0 "a file's points are told" small --tf "$SEEDS/niivue.json" -o n.png
says 'niivue 100\.\.1000; opacity 0 at 100.*\(from the file\); opacity per voxel'
run 0 "its unit too" small --tf "$SEEDS/own.json" -o o.png
says 'mine .*gradient opacity 0 at .*; opacity per mm'
told "a recipe counts more" 'opacity per voxel' \
    small --tf "$SEEDS/own.json" --config '{"opacity-unit": "voxel"}' -o o.png -y
told "spread over a range" 'niivue 10\.\.200' \
    small --tf "$SEEDS/niivue.json" --range 10,200 -o r.png
again "kept" render c.png phantom:shells --dims 24x24x24 -s 40x40 --tf "$SEEDS/points.csv" \
    --scale log --range 1,200
told "info reads it too" 'light is ignored' "$TOOL" info phantom:shells --tf "$SEEDS/ct.vp"
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
told "from the histogram" 'logarithmic' small --scale log -o m.png
run 0 "every method" small -q --scale log --preset linear --method footprint \
    --shade none -o f.png
refusals 2 small <<'END'
--scale log --opacity 0:0,9:1 -o x.png|the opacity at 0 has no logarithm; give values above 0, or symlog
--scale log -c "-2:#000000,9:#ff0000" -o x.png|the colour at -2 has no logarithm
--scale log --preset ct-soft -o x.png|give a range too
END

# --- names --------------------------------------------------------------------
for name in CT-AAA CT-Chest-Contrast-Enhanced ctcoronaryarteries2 MR_T2_Brain \
    DTI-FA-Brain; do
    run 0 "the preset $name" small -q --preset "$name" -o p.png -y
done
finish
