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
other_file "which is another picture" a.png b.png
check "of the same check sum" [ "$(checksum a.json)" = "$(checksum b.json)" ]
head="phantom:head --dims 40x40x40"
pairs npy render $head -s 150x140 <<'END'
floats have none | | = | --no-labels
END
pairs png render <<END
what is no patient has none | phantom:cube | = | phantom:cube --no-labels
nor have tiny pictures | $head -s 60x60 | = | $head -s 60x60 --no-labels
END
run 0 "a legend" head_of render -q -o g.png --legend -c viridis
run 0 "without" head_of render -q -o h.png -c viridis
other_file "is drawn" g.png h.png
told "in perspective" 'the scale bar is left out' \
    head_of render -o i.png --legend --perspective
again "a scale bar" render sb.png $head -s 150x140 --legend scale -c viridis
other_file "is drawn" first/sb.png h.png
other_file "without the colour bar" first/sb.png g.png
told "a scale bar in perspective" '^snowglass: --legend: the scale bar is left out' \
    head_of render -o se.png --legend=scale --perspective
refusals 2 head_of <<'END'
render -o x.npy --legend scale|--legend cannot be drawn
render -o x.npy --legend|remove it or name a .png
turntable -o x_%d.pfm --legend|remove it or name a .png
END
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

again "wishes" render v.png $head -s 150x140 --legend --no-labels
run 0 "to standard output" bash -c \
    "'$TOOL' render -q phantom:head --dims 40x40x40 -s 150x140 -o - >y.png"
same_file "with letters" a.png y.png

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
    "--annotate time=%.3f" "--legend=(kg)"; do
    again "$said" render w1.png s_1.vti -s 160x150 $said
    other_file "$said is drawn" w0.png first/w1.png
done
pairs png render s_1.vti -s 160x150 <<'END'
the file's quantity, said as it is | --legend | = | --legend=rho
a unit alone makes another | --legend | != | '--legend=(kg)'
with the quantity it is the same | '--legend=(kg)' | = | '--legend=rho (kg)'
END
run 0 "a movie with times" "$TOOL" movie s_0.vti s_1.vti -q -s 160x150 \
    -o 'x_%d.png' --annotate time --range 0,255 --preset linear
run 0 "its second frame as a picture" of_time -o x.png --annotate time \
    --range 0,255 --preset linear --fit volume
run 0 "a frame of the other time" "$TOOL" render s_1.vti -q -s 160x150 -y \
    -o y.png --range 0,255 --preset linear --fit volume
run 6 "shows it" "$TOOL" compare x.png y.png
run 2 "formats are checked" of_time -o w1.png --annotate time=%s
says "neither one number"
told "letters that the font lacks, anywhere" '日: has letters that the font lacks' \
    "$TOOL" render s_1.vti -s 160x150 -y -o y.png --legend=日
run 0 "those that it has" "$TOOL" render s_1.vti -s 160x150 -y -o y.png '--legend=σ (Ω⁻¹)' --title "ΔT"
not_said 'lacks'
run 2 "titles have an end" of_time -o w1.png --title "$(printf '%01001d' 0)"
says "1001 bytes: at most 1000"
run 2 "floats have no title" of_time -o w.npy --title Run
says "cannot be drawn"

finish
