#!/bin/bash
# info tells the truth about small volumes whose figures are known by hand, and
# phantom writes files that info and render read back.
. "$(dirname "$0")/../../support/shell.sh"

# 2 x 2 x 2 voxels of 1 .. 8: sum 36, wsum 1*1 + 2*2 + ... + 8*8 = 204.
printf '\1\2\3\4\5\6\7\10' >eight.raw
raw="--dims 2x2x2 --type uint8"
run 0 "info of eight voxels" "$TOOL" info eight.raw $raw --spacing 1x2x3 --json
check "is one line" [ "$(wc -l <"$OUT")" -eq 1 ]
prints '"format": "raw"'
prints '"dims": \[2, 2, 2\]'
prints '"type": "uint8"'
prints '"spacing": \[1.0, 2.0, 3.0\]'
prints '"unit": ""'
prints '"matrix": \[\[1.0, 0.0, 0.0, [^]]*\], \[0.0, 2.0, 0.0, [^]]*\], \[0.0, 0.0, 3.0, [^]]*\], \[0.0, 0.0, 0.0, 1.0\]\]'
prints '"medical": false'
prints '"slope": 1.0, "intercept": 0.0, "times": 1, "time": 0'
prints '"voxels": 8, "finite": 8, "min": 1.0, "max": 8.0, "sum": 36.0, "wsum": 204.0'
prints '"histogram": \{"low": 1.0, "high": 8.0, "counts": \[1, 0'
prints '"sparse_ratio": \[\{"threshold": 0.0, .*"threshold": 10.0, .*"threshold": 30.0'
prints '"look": "..*"'

run 0 "the same as text" "$TOOL" info eight.raw $raw --spacing 1x2x3
for line in 'dims +2 x 2 x 2 \(8 voxels\)$' 'type +uint8$' 'spacing +1 x 2 x 3$' \
    'values +1 .. 8, mean 4.5$' 'finite +8 of 8 voxels$' histogram; do
    prints "^$line"
done
check "the histogram counts every voxel" \
    [ "$(sed '1,/^histogram/d' "$OUT" | awk '{s += $2} END {print s}')" -eq 8 ]

# Opacity is value / 8; above 100/255 are 4 .. 8, so 3 of 8 are uninteresting.
printed "the sparse ratio of one threshold" '"sparse_ratio": \[\{"threshold": 100.0, "ratio": 0.375\}\]' \
    "$TOOL" info eight.raw $raw --json --opacity 0:0,8:1 --threshold 100

# Along x the values step by 1, along y by 2, along z by 4: all gradients are of
# sqrt(21).  Half of each opacity is left, so that 100/255 is passed by 7 and 8.
run 0 "the sparse ratio with a gradient opacity" "$TOOL" info eight.raw $raw \
    --json --opacity 0:0,8:1 --threshold 100 --gradient-opacity 0:0,9.165151:1
prints '"sparse_ratio": \[\{"threshold": 100.0, "ratio": 0.75\}\]'
prints 'gradient opacity 0 at 0, 1 at 9.1652'

# The same bytes as big endian 16 bit: 0x0102, 0x0304, 0x0506, 0x0708.
printed "big endian" '"min": 258.0, "max": 1800.0' \
    "$TOOL" info eight.raw --dims 2x2x1 --type uint16 --endian big --json
printed "an offset" '"min": 5.0, "max": 8.0' \
    "$TOOL" info eight.raw --dims 2x2x1 --type uint8 --offset 4 --json

printf '\0\0\300\177' >nan.raw
printed "a volume of NaN alone" '"finite": 0, "min": null, "max": null' \
    "$TOOL" info nan.raw --dims 1x1x1 --type float32 --json
prints '"histogram": null'
printed "a volume of NaN alone as text" '^finite +0 of 1 voxels$' \
    "$TOOL" info nan.raw --dims 1x1x1 --type float32

check "standard input" bash -c "'$TOOL' info - $raw --json <eight.raw |
    grep -q '\"sum\": 36.0'"

# The engine's default size is that of the paper.
run 0 "info of a phantom" "$TOOL" info phantom:cube --json
prints '"format": "phantom", "dims": \[256, 256, 110\], "type": "uint8"'
ratio=$(sed -n 's/.*"threshold": 0.0, "ratio": 0.\([0-9][0-9]\).*/\1/p' "$OUT")
check "the cube is sparse as in Table 1" [ "${ratio:-0}" -ge 97 ]

figures() { sed -n 's/.*\("dims": \[[^]]*\]\).*\("voxels".*"wsum": [^,]*\).*/\1 \2/p' "$1"; }
run 0 "info of phantom:engine" \
    "$TOOL" info phantom:engine --dims 20x18x16 --json
figures "$OUT" >direct
check "it has figures" [ -s direct ]
for suffix in nrrd nii nii.gz mha raw raw.gz; do
    run 0 "phantom engine to .$suffix" \
        "$TOOL" phantom engine --dims 20x18x16 -o engine.$suffix
    options=
    case $suffix in raw*) options="--dims 20x18x16 --type uint8" ;; esac
    run 0 "info of .$suffix" "$TOOL" info engine.$suffix $options --json
    figures "$OUT" >read_back
    check ".$suffix holds the same voxels" cmp -s direct read_back
done
run 0 "the same phantom again" \
    "$TOOL" phantom engine --dims 20x18x16 -o again.raw
check "has the same bytes" cmp -s engine.raw again.raw

# --- no note offers what was given -------------------------------------------

quiet_note() { check "$NAME: no note" bash -c "! grep -q note: '$ERR'"; }
"$TOOL" phantom:cube --dims 8x8x8 -q -s 8x8 -c viridis --background none \
    -o colours.png
run 0 "colours" "$TOOL" info colours.png
says "note: channel 0 of 4 .counted from 0. is used; --channel N selects another"
for channel in 0 2; do
    run 0 "channel $channel" "$TOOL" info colours.png --channel $channel
    quiet_note
done

if command -v python3 >/dev/null; then
    need_python
    python3 - <<'END'
import os
from volumes import tiff

def stack(path, pages, text):
    """Pages of 4x3 bytes, 4 pixels a unit, with a description."""
    tiff(path, 4, 3, [bytes(range(12 * n, 12 * n + 12)) for n in range(pages)],
         text.encode(), resolution=4)

head = "ImageJ=1.53t\nimages=3\nslices=3\nunit=um\n"
stack("flat.tif", 3, head)
stack("deep.tif", 3, head + "spacing=2\n")
os.mkdir("flat")
for z in range(3):
    stack(f"flat/{z}.tif", 1, "ImageJ=1.53t\nunit=um\n")
END
fi
if [ -d flat ] && "$TOOL" info -q flat.tif >/dev/null 2>&1; then
    for input in flat.tif flat; do
        run 0 "slices of $input without a distance" "$TOOL" info $input
        prints "^spacing  *0.25 x 0.25 x 0.25 um"
        says "note: .*the distance of the slices is taken to be the width of a pixel, 0.25; --spacing sets another"
        printed "and with one that is given" "^spacing  *0.25 x 0.25 x 1 " \
            "$TOOL" info $input --spacing 0.25x0.25x1
        quiet_note
    done
    printed "slices with a distance" "^spacing  *0.25 x 0.25 x 2 um" "$TOOL" info deep.tif
    quiet_note
else
    skipped "distances of TIFF slices" "there is no python3 or no libtiff"
fi
# --- components ----------------------------------------------------------------
if command -v python3 >/dev/null; then
    python3 - <<'END'
import struct
from volumes import npy
npy("v.npy", "<f4", (4, 4, 4, 3), struct.pack("<192f", *range(192)))
npy("c.npy", "|i1", (5, 5, 5, 4), bytes(n % 256 for n in range(500)))
npy("b.npy", "|u1", (5, 5, 5, 4), bytes(n % 256 for n in range(500)))
END
    components() { # FILE TEXT COUNT MAGNITUDE OPTION...
        local file=$1 text=$2 count=$3 magnitude=$4
        shift 4
        printed "components of $file $*" "^components  *$text$" "$TOOL" info -q "$file" "$@"
        printed "as JSON" "\"components\": $count, \"magnitude\": $magnitude" \
            "$TOOL" info -q "$file" --json "$@"
    }
    components v.npy "3 .these values: the magnitude." 3 true
    components v.npy "3 .these values: component y." 3 false --component Y
    components v.npy "3 .these values: component 0." 3 false --channel 0
    components v.npy "3 .these values: component 2." 3 false --component 2
    components c.npy "4 .these values: component 0." 4 false
    components c.npy "4 .these values: component 3." 4 false --channel 3
    printed "bytes in fours" '^channels  *4 .these values: channel 0.$' "$TOOL" info -q b.npy
    components b.npy "4 .these values: component 3." 4 false --component 3
    run 0 "a list of vectors" "$TOOL" info -q v.npy c.npy
    prints '^v.npy: npy 4x4x4 float32, .*, 3 components$'
else
    skipped "components" "there is no python3"
fi
run 0 "one value a voxel" "$TOOL" info phantom:cube --dims 8x8x8
check "no word on components" bash -c "! grep -q '^components' '$OUT'"
run 0 "as JSON" "$TOOL" info phantom:cube --dims 8x8x8 --json
prints '"components": 1, "magnitude": false'

# --- several inputs and folders -------------------------------------------------
mkdir -p many/deep
"$TOOL" convert -q phantom:cube --dims 9x8x7 -o many/b.nrrd
"$TOOL" convert -q phantom:cube --dims 6x5x4 -o many/a.nii.gz
"$TOOL" convert -q phantom:cube --dims 3x3x3 -o many/deep/c.nrrd
echo "no volume" >many/read.me
run 0 "two inputs" "$TOOL" info many/b.nrrd many/a.nii.gz
prints '^many/b.nrrd: nrrd 9x8x7 uint8, spacing '
prints '^many/a.nii.gz: nifti 6x5x4 uint8, spacing '
check "in their order" [ "$(cut -d: -f1 "$OUT" | tr '\n' ' ')" = \
    "many/b.nrrd many/a.nii.gz " ]
run 3 "one that is missing does not end the list" "$TOOL" info many/b.nrrd \
    many/none.nrrd phantom:head
prints '^many/b.nrrd: nrrd'
prints '^phantom:head: phantom 256'
says '^snowglass: many/none.nrrd: '
check "one line of an error" [ "$(wc -l <"$ERR")" = 1 ]
run 3 "as JSON" "$TOOL" info --json many/b.nrrd many/read.me many/a.nii.gz
prints '^\[\{"path": "many/b.nrrd", "format": "nrrd", "dims": \[9, 8, 7\]'
check "is a list of what can be read" python3 -c '
import json, sys
rows = json.load(open(sys.argv[1]))
assert [r["path"] for r in rows] == ["many/b.nrrd", "many/a.nii.gz"]' "$OUT"
run 0 "a folder" "$TOOL" info many
check "is listed by name" [ "$(cut -d: -f1 "$OUT" | tr '\n' ' ')" = \
    "many/a.nii.gz many/b.nrrd " ]
says '^snowglass: many/read.me: has an unknown format'
mkfifo many/pipe many/pipe.nrrd
ln -s nowhere many/gone.nrrd
run 0 "pipes in a folder are not waited for" timeout 60 "$TOOL" info many
check "nor listed" [ "$(cut -d: -f1 "$OUT" | tr '\n' ' ')" = \
    "many/a.nii.gz many/b.nrrd " ]
says 'many/gone.nrrd: cannot be opened: it is a link to a file that is not'
cat >pipe.xmf <<END
<Xdmf><Domain><Grid><Topology TopologyType="3DCoRectMesh" Dimensions="8 8 8"/>
<Geometry GeometryType="ORIGIN_DXDYDZ"><DataItem Dimensions="3">0 0 0</DataItem>
<DataItem Dimensions="3">1 1 1</DataItem></Geometry><Attribute Center="Node">
<DataItem Dimensions="8 8 8" Format="HDF">many/pipe:/a</DataItem></Attribute>
</Grid></Domain></Xdmf>
END
run 3 "nor is a pipe that an XDMF file names" timeout 60 "$TOOL" info pipe.xmf
says "pipe.xmf: .*many/pipe: is a pipe; give a regular file"
printed "a folder and a file" '^many/deep/c.nrrd: ' "$TOOL" info many/deep/ phantom:cube
prints '^phantom:cube: '
mkdir empty
run 3 "a folder without volumes is refused as it was" "$TOOL" info empty
run 2 "no input" "$TOOL" info
says 'info: an operand is missing; give snowglass info INPUT'
# A note about a raw file's name says what came from it.
head -c 48 /dev/zero >raw_4x3x2_u16be.raw
run 0 "a raw file by its name" "$TOOL" info raw_4x3x2_u16be.raw
says '4x3x2 uint16, big endian; its name gives the sizes and the type$'
run 0 "with other sizes" "$TOOL" info raw_4x3x2_u16be.raw --dims 4x2x3
says '4x2x3 uint16, big endian; its name gives the type$'
finish
