#!/bin/bash
# convert: voxels and geometry go from format to format; types change by
# rounding, over a range, or not at all.
. "$(dirname "$0")/../../support/shell.sh"

# sums FILE [OPTIONS]: type, sums and matrix, without what formats round.
sums() {
    "$TOOL" info -q --json "$@" | python3 -c '
import json, sys
o = json.load(sys.stdin)
print(o["type"], o["dims"], o["sum"], o["wsum"],
      [round(x, 4) for row in o["matrix"] for x in row])'
}

same() {
    local a b
    a=$(sums "$1") b=$(sums "$2")
    [ -n "$a" ] && [ "$a" = "$b" ] || { echo "$a / $b"; false; }
}

"$TOOL" phantom head --dims 33x21x17 -q -o a.nrrd
for end in nii nii.gz mha nrrd; do
    told "to $end" "b.$end: 33x21x17" "$TOOL" convert a.nrrd -o "b.$end"
    check "voxels and matrix are the same in $end" same a.nrrd "b.$end"
done
run 0 "to npy" "$TOOL" convert b.nii.gz -o c.npy
run 0 "to raw" "$TOOL" convert -q c.npy -o c.raw.gz
run 0 "and back from raw" "$TOOL" convert -q c.raw.gz --dims 33x21x17 \
    --type uint8 -o d.npy
check "byte for byte" cmp c.npy d.npy

run 0 "a box" "$TOOL" convert -q a.nrrd --crop 3:20,2:,:9 -o e.nii
check "lies where it was" test "$(sums e.nii)" = \
    "$(sums a.nrrd --crop 3:20,2:,:9)"

run 0 "to another type" "$TOOL" convert -q a.nrrd --as float32 -o f.nrrd
run 0 "by --type, of a file that tells its own" "$TOOL" convert -q a.nrrd \
    --type float32 -o g.nrrd
check "the same" cmp f.nrrd g.nrrd
run 0 "raw data to another type" "$TOOL" convert -q c.raw.gz --dims 33x21x17 \
    --type uint8 --as int16 -o h.npy
run 0 "a type that holds less" "$TOOL" convert -q h.npy --as uint8 -o i.npy
check "holds these" cmp i.npy c.npy
run 0 "over a range" "$TOOL" convert a.nrrd --as uint16 --range full -o j.nrrd
says 'values 1 to 200 became 0 to 65535 of uint16'

# A CT's slope and intercept, which NRRD cannot say.
python3 - <<'EOF'
import struct
header = bytearray(352)
struct.pack_into("<i", header, 0, 348)
struct.pack_into("<8h", header, 40, 3, 2, 1, 1, 1, 1, 1, 1)
struct.pack_into("<hh", header, 70, 4, 16)
struct.pack_into("<8f", header, 76, 1, 1, 1, 1, 1, 1, 1, 1)
struct.pack_into("<fff", header, 108, 352, 1, -1024)
header[344:348] = b"n+1\0"
open("ct.nii", "wb").write(header + struct.pack("<hh", 24, 3000))
EOF
run 0 "an intercept to NRRD" "$TOOL" convert -q ct.nii -o ct.nrrd
check "is in the values" test "$(sums ct.nrrd | cut -d' ' -f1-6)" = \
    "int16 [2, 1, 1] 976.0 2952.0"
run 0 "an intercept to MetaImage" "$TOOL" convert -q ct.nii -o ct.mha
check "stays one" grep -aq "ElementToIntensityFunctionOffset = -1024" ct.mha

# Names, colours and units stay, in a volume and in the volume of a page.
{
    printf 'NRRD0004\ntype: uint8\ndimension: 3\nsizes: 2 2 2\nencoding: ascii\n'
    printf 'sample units: mSv\nSegment0_LabelValue:=7\nSegment0_Name:=liver\n'
    printf 'Segment0_Color:=1 0.5 0\n\n0 7 0 7 0 7 0 7\n'
} >seg.nrrd
run 0 "a segmentation" "$TOOL" convert -q seg.nrrd -o seg2.nrrd --as uint16
printed "as it is" '7 .*liver' "$TOOL" info seg2.nrrd
check "the unit stays" grep -aq '^sample units: mSv$' seg2.nrrd
printf '7 10 20 30 0.5 1 1 "spleen"\n' >labels.txt
mkdir -p page/bin page/share/snowglass/web
cp "$TOOL" page/bin
echo '<html><head>' >page/share/snowglass/web/viewer.html
run 0 "a page" page/bin/snowglass export page.html seg.nrrd --legend \
    --label-table labels.txt
check "opens no other file" test "$(grep -c labels.txt page.html)" = 0
sed -n 's/.*data-recipe="[^>]*>\(.*\)<.script>/\1/p' page.html | base64 -d |
    gunzip >paged.nrrd
printed "its volume" '7 .*spleen' "$TOOL" info paged.nrrd
check "has opacities" grep -aq '^Segment0_Opacity:=0.5$' paged.nrrd

refusals 2 "$TOOL" convert <<'END'
a.nrrd|no output file given
a.nrrd -o a.xyz|volumes are written as
j.nrrd -o k.nrrd --as int8|nrrd: .* do not fit int8; convert to float32
a.nrrd -o k.nrrd --range 0,5|add --as uint8
a.nrrd -o k.nrrd --as uint8 --range p1,p99|two data values or full
END
refused 4 "a file that exists" "exists" "$TOOL" convert a.nrrd -o b.nii
refused 3 "no such file" "none.nrrd" "$TOOL" convert none.nrrd -o k.nrrd
refused 2 "a look" "is not an option of convert" "$TOOL" convert a.nrrd -o k.nrrd --preset linear
check "nothing was left" test ! -e k.nrrd
finish
