#!/bin/bash
# Letters, legend and time label: in pictures of levels only, the same in every
# verb, and never in what is computed from a picture.
. "$(dirname "$0")/../../support/shell.sh"

head_of() {
    "$TOOL" "$1" phantom:head --dims 40x40x40 -s 150x140 "${@:2}"
}

# checksum FILE: that of the picture, in the figures of a run.
checksum() { grep -o '"checksum": "[^"]*"' "$1"; }

run 0 "letters are drawn" head_of render -q -o a.png --stats a.json
run 0 "and left out" head_of render -q -o b.png --no-labels --stats b.json
run 6 "which is another picture" "$TOOL" compare a.png b.png
check "of the same check sum" [ "$(checksum a.json)" = "$(checksum b.json)" ]
run 0 "floats have none" head_of render -q -o a.npy
run 0 "with or without" head_of render -q -o b.npy --no-labels
check "of the same bytes" cmp -s a.npy b.npy
run 0 "what is no patient has none" "$TOOL" render -q phantom:cube -o c.png
run 0 "with or without them" "$TOOL" render -q phantom:cube -o d.png --no-labels
check "byte for byte" cmp -s c.png d.png
run 0 "nor have tiny pictures" head_of render -q -o e.png -s 60x60
run 0 "with or without them" head_of render -q -o f.png -s 60x60 --no-labels
check "byte for byte" cmp -s e.png f.png

run 0 "a legend" head_of render -q -o g.png --legend -c viridis --stats g.json
run 0 "without" head_of render -q -o h.png -c viridis --stats h.json
run 6 "is drawn" "$TOOL" compare g.png h.png
check "of the same check sum" [ "$(checksum g.json)" = "$(checksum h.json)" ]
run 0 "in perspective" head_of render -o i.png --legend --perspective
says 'the scale bar is left out'
run 0 "a scale bar" head_of render -q -o sb.png --legend scale -c viridis \
    --save-config sb.json
run 6 "is drawn" "$TOOL" compare sb.png h.png
run 6 "without the colour bar" "$TOOL" compare sb.png g.png
run 0 "it is kept" "$TOOL" render -q --config sb.json -o sc.png
check "in the same picture" cmp -s sb.png sc.png
run 0 "a scale bar in perspective" head_of render -o se.png --legend=scale \
    --perspective
says '^snowglass: --legend: the scale bar is left out'
refused 2 "a scale bar in floats" '--legend cannot be drawn' \
    head_of render -o x.npy --legend scale
refused 2 "a legend in floats" 'remove it or name a .png' \
    head_of render -o x.npy --legend
refused 2 "in frames of floats" 'remove it or name a .png' \
    head_of turntable -o 'x_%d.pfm' --legend
check "nothing is written then" absent x.npy

run 0 "letters turn in a turntable" head_of turntable -q -o 't_%d.png' \
    --frames 4 --legend --background navy --fit volume
for n in 0 1 2 3; do
    run 0 "frame $n as a picture" head_of render -q -o "u_$n.png" --legend \
        --background navy --azimuth $((90 * n)) --fit volume
    check "is that of the turntable" cmp -s "t_$n.png" "u_$n.png"
done
run 4 "frames with letters are not kept without" head_of turntable -q \
    -o 't_%d.png' --frames 4 --legend --background navy --resume --no-labels
says 'other settings'

run 0 "steps" "$TOOL" phantom head --dims 20x20x20 -o s_0010.nrrd
cp s_0010.nrrd s_0025.nrrd
run 0 "of a movie with their numbers" "$TOOL" movie -q s_%04d.nrrd -s 100x90 \
    --annotate step -o 'm_%d.png'
run 0 "and without" "$TOOL" movie -q s_%04d.nrrd -s 100x90 -o 'n_%d.png'
run 6 "differ" "$TOOL" compare m_0.png n_0.png
run 6 "from step to step" "$TOOL" compare m_0.png m_1.png
run 0 "that alone does" "$TOOL" compare n_0.png n_1.png

run 0 "wishes" head_of render -q -o v.png --legend --no-labels \
    --save-config v.json
run 0 "are kept" "$TOOL" render -q --config v.json -o w.png
check "in the same picture" cmp -s v.png w.png
run 0 "to standard output" bash -c \
    "'$TOOL' render -q phantom:head --dims 40x40x40 -s 150x140 -o - >y.png"
check "with letters" cmp -s a.png y.png

# --- titles, times, boxes -----------------------------------------------------
for step in 0 1; do
    "$TOOL" phantom shells --dims 12x12x12 -q -o s_$step.nrrd
    "$TOOL" convert s_$step.nrrd -q -o s_$step.raw
    cat >s_$step.vti <<END
<VTKFile type="ImageData"><ImageData WholeExtent="0 11 0 11 0 11">
<FieldData><DataArray type="Float64" Name="TimeValue" NumberOfTuples="1"
format="ascii">$step.25</DataArray></FieldData>
<Piece Extent="0 11 0 11 0 11"><PointData Scalars="rho"><DataArray
type="UInt8" Name="rho" format="ascii">$(od -An -v -tu1 s_$step.raw)</DataArray>
</PointData></Piece></ImageData></VTKFile>
END
done
of_time() { "$TOOL" render s_1.vti -q -s 160x150 -y "$@"; }
run 0 "a picture" of_time -o w0.png
for said in "--title Run" "--annotate time" "--box outline" "--box axes" \
    "--annotate time=%.3f"; do
    run 0 "$said" of_time -o w1.png $said
    run 6 "$said is drawn" "$TOOL" compare w0.png w1.png
    run 0 "$said by a recipe" of_time -o w2.png --save-config w.json $said
    run 0 "$said: the recipe" "$TOOL" render --config w.json -q -y -o w2.png
    check "$said: the same picture" cmp -s w1.png w2.png
done
run 0 "the file's quantity" of_time -o w1.png --legend
run 0 "said as it is" of_time -o w2.png --legend=rho
check "is the same" cmp -s w1.png w2.png
run 0 "a unit alone" of_time -o w2.png '--legend=(kg)' --save-config w.json
run 6 "makes another" "$TOOL" compare w1.png w2.png
run 0 "with the quantity" of_time -o w3.png '--legend=rho (kg)'
check "it is the same" cmp -s w2.png w3.png
run 0 "as by its recipe" "$TOOL" render --config w.json -q -y -o w3.png
check "which keeps it" cmp -s w2.png w3.png
run 0 "a movie with times" "$TOOL" movie s_0.vti s_1.vti -q -s 160x150 \
    -o 'x_%d.png' --annotate time --range 0,255 --preset linear
run 0 "its second frame as a picture" of_time -o x.png --annotate time \
    --range 0,255 --preset linear --fit volume
run 0 "a frame of the other time" "$TOOL" render s_1.vti -q -s 160x150 -y \
    -o y.png --range 0,255 --preset linear --fit volume
run 6 "shows it" "$TOOL" compare x.png y.png
run 2 "formats are checked" of_time -o w1.png --annotate time=%s
says "neither one number"
run 2 "floats have no title" of_time -o w.npy --title Run
says "cannot be drawn"

finish
