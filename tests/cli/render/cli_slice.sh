#!/bin/bash
# The verb slice beyond its values, which oracle_slice.py holds against another
# reference: what is refused and how, notes, marks, files, memory, and the
# command and the configuration that give the same picture again.
. "$(dirname "$0")/../../support/shell.sh"

head="phantom:head --dims 40x36x30"

run 0 "a slice without options" "$TOOL" slice $head -o a.png
says 'axial slice 15 of 0 to 29, at 3\.76667mm; grey 1\.\.172 '
check "is a PNG" is_png a.png
run 0 "by number" "$TOOL" slice $head -o b.png --axis axial --at 15 -q
check "is the middle one" cmp -s a.png b.png
refused 4 "a file is not replaced" 'exists' "$TOOL" slice $head -o a.png
run 0 "unless told" "$TOOL" slice $head -o a.png -y -q
for cut in 12:13,:,:=sagittal :,7:8,:=coronal :,:,3:4=axial 1:2,2:3,:=axial; do
    run 0 "of the box ${cut%=*}" "$TOOL" slice $head --crop "${cut%=*}" -o face.png -y
    says "${cut#*=} slice "
done
run 0 "a position in micrometres" "$TOOL" slice $head -o um.png -q --at 3600um
run 0 "in millimetres" "$TOOL" slice $head -o mm.png -q --at 3.6mm
check "is the same" cmp -s um.png mm.png
run 0 "names of axes may be capital" "$TOOL" slice $head -o c.png -q --axis AXIAL
check "of the same bytes" cmp -s a.png c.png
told "a name after the input" '; to head.png$' "$TOOL" slice $head
check "is written" is_png head.png

for at in -1 36 1e9 2.5 nan middle 3s 5mm5; do
    refused 2 "slice '$at'" \
        "--at: '$at' is no slice across coronal: must be 0 to 35, or a position from" \
        "$TOOL" slice $head -o x.png --axis coronal --at "$at"
done
refusals 2 "$TOOL" slice $head <<'END'
-o x.png --at 9999mm|must be 0 to 29, or a position from -?[0-9.]+mm
-o x.png --axis w|choose from: x, y, z, axial, coronal, sagittal
-o x.png --kernel gauss|gauss cannot draw a slice; use tent
-o x.png --azimuth 30|is not an option of slice but of render
-o x.png --opacity 0:0,100:1|is not an option of slice but of render
-o x.npy --legend|remove it or name a .png
END
refused 3 "no such file" 'absent.nii' "$TOOL" slice absent.nii -o x.png
check "nothing is written then" absent x.png

told "numbers" 'data values' "$TOOL" slice $head -o a.npy
check "are an array of rows" grep -aq "'shape': (40, 40)" a.npy
for suffix in pfm exr tif webp jpg; do
    run 0 "a .$suffix" "$TOOL" slice $head -o "a.$suffix" -q
done
run 0 "in 16 bits" "$TOOL" slice $head -o deep.png -q --bits 16
run 0 "by standard output" "$TOOL" slice $head -o - -q
check "are the bytes of the file" cmp -s "$OUT" a.png

pairs png slice $head -s 300x200 <<'END'
without letters | | != | --no-labels
with bars | | != | --legend
on white | --no-labels | != | --no-labels --background white
END
pairs npy slice $head <<'END'
any number of threads | -j 1 | = | -j 3
END

printf 'NRRD0004\ntype: float\ndimension: 3\nsizes: 4 4 4\nencoding: ascii\n\n' >none.nrrd
for i in $(seq 64); do echo nan; done >>none.nrrd
run 7 "a slice without a value" "$TOOL" slice none.nrrd -o none.png
says 'the picture is empty: the slice has no finite value'
run 7 "nor one in numbers" "$TOOL" slice none.nrrd -o none.npy -q

"$TOOL" convert $head -o m.nrrd -q
for axis in axial y sagittal; do
    "$TOOL" slice m.nrrd --axis $axis -o file.png -q
    "$TOOL" slice - --axis $axis -o pipe.png -q -y <m.nrrd
    check "$axis through a pipe is the same" cmp -s file.png pipe.png
    rm file.png
done

# A slice of labels is drawn as such, without being asked.
{
    printf 'NRRD0004\ntype: uint8\ndimension: 3\nsizes: 4 4 2\nencoding: ascii\n'
    printf 'Segment0_LabelValue:=7\nSegment0_Name:=liver\nSegment0_Color:=1 0 0\n\n'
    printf '0 0 7 7 0 0 7 7 0 3 3 7 0 3 3 7 %.0s' 1 2
} >seg.nrrd
again "labels, as such" slice again.png seg.nrrd -s 160x160 --legend
again "a slice" slice again.png $head
again "by position" slice again.png $head --axis sagittal --at 2.5mm -c viridis --legend
again "of a usual size" slice again.png $head -s 512 --at 3 --kernel box
again "with a window" slice again.png $head -w 80,100 --background white --bits 16 --no-labels
again "with a preset" slice again.png $head --preset ct-soft --crop 5:30,:,2:20
pairs png slice <<'END'
the configuration of another slice | --config first.json -y | != | --config first.json -y --at 0
END

# Several slices: in one picture, and in files that are kept as a movie's are.
again "a grid" slice again.png m.nrrd --grid 3x2 --legend
again "a grid of a range" slice again.png m.nrrd --grid 2x2 --at 5:20 -s 300 --title t
again "three of them" slice again.png m.nrrd --ortho --at 10,12.5,9mm -s 400x200
run 0 "a series" "$TOOL" slice m.nrrd -o s_%02d.png --at 4:16:5
says 'axial slices 4 to 14 of 0 to 29; grey [0-9.]+ \(.*; 3 frames of 40x40 to s_%02d.png'
check "has three pictures" [ -e s_00.png ] && [ -e s_02.png ] && [ ! -e s_03.png ]
range=$(grep -oE 'grey [0-9.]+' "$ERR" | cut -d' ' -f2)
"$TOOL" slice m.nrrd -o nine.png --at 9 --range "${range/../,}" -q
check "of which each is that of its slice" cmp -s nine.png s_01.png
refused 4 "they are not replaced" 'use --resume to continue, --overwrite' \
    "$TOOL" slice m.nrrd -o s_%02d.png --at 4:16:5
cp s_01.png kept.png
rm s_02.png
touch -d 2001-01-01 s_01.png
run 0 "but continued" "$TOOL" slice m.nrrd -o s_%02d.png --at 4:16:5 --resume -q
check "with those that are there" [ s_01.png -ot nine.png ]
check "and the one that is not" is_png s_02.png
refused 4 "not as others" 'made with other settings' \
    "$TOOL" slice m.nrrd -o s_%02d.png --at 4:16:4 --resume
run 0 "a movie of five slices" "$TOOL" slice m.nrrd -o s.webp --frames 5 --stats movie.json
check "says so" [ "$(grep -c . movie.json)" -gt 0 ]
says 'axial slices 0 to 29 of 0 to 29; .*5 frames'
refusals 2 "$TOOL" slice m.nrrd <<'END'
-o x.png --at 3:9|holds one slice; number the files
-o x.png --frames 3|holds one slice; number the files
-o x.png --fps 3|--fps: is of many pictures
-o x.png --grid 3|'3' is no grid; give COLUMNSxROWS
-o x.png --grid 3x3 --at 4|'4' is one slice; with --grid give a range
-o x.png --grid 3x3 --ortho|conflicts with --ortho
-o x.png --ortho --axis x|--ortho has all three
-o x.png --ortho --at 3|'3' is no point; with --ortho give X,Y,Z in mm
END

# A volume of 8 GiB, of which a slice is read.
truncate -s 8G large.raw
raw="--dims 2048x2048x2048 --type uint8"
for axis in z y; do
    run 0 "$axis of a volume larger than memory" "$TOOL" slice large.raw $raw \
        --axis $axis --at 1500 -o large.npy -y -q --memory 64M --stats -
    check "little of it is read" [ "$(number file)" -lt 20000000 ]
    check "and little memory taken" [ "$(number peak)" -lt 64000000 ]
done
# Several slices of what has no room are read one by one, and are the same.
"$TOOL" phantom head -o big.nrrd --dims 200x180x160 -q
while read -r how; do
    run 0 "in memory: $how" "$TOOL" slice big.nrrd -o whole.png -y -q $how
    run 0 "in the file: $how" "$TOOL" slice big.nrrd -o parts.png -y -q --memory 5M --stats - $how
    check "in less memory" [ "$(number peak)" -lt 5000000 ]
    same_file "is the same: $how" whole.png parts.png
done <<'END'
--grid 3x2 --at 0:160 -s 300x200
--ortho --at 10,12.5,9mm -s 400x200
--grid 2x2 --axis x --at 20:90 --legend -c viridis -s 300
END
told "a grid of all" 'big.nrrd stays in its file' "$TOOL" slice big.nrrd -o g.png --grid 2x2 -s 200 --memory 5M
run 0 "a series in memory" "$TOOL" slice big.nrrd -o w_%d.png -q --axis y --at 0:180:80
run 0 "and in the file" "$TOOL" slice big.nrrd -o p_%d.png -q --axis y --at 0:180:80 --memory 5M
same_file "is the same" w_2.png p_2.png
refused 5 "what does not fit is refused" 'memory' "$TOOL" slice large.raw $raw \
    -o large.png --memory 1M
told "a slice of labels" 'labels 0\.\.7' "$TOOL" slice seg.nrrd -o seg.png -s 160x160 --legend
pairs png slice seg.nrrd -s 160x160 --legend <<'END'
is as asked | | = | --preset labels
with a clear background | " | != | --background white
END
run 0 "in grey" "$TOOL" slice seg.nrrd -o seg4.png --preset linear '--legend=(K)'
finish
