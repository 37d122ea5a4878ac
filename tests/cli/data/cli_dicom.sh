#!/bin/bash
# DICOM folders in which slices are missing or cut: refused, listed by info, and
# opened with --allow-gaps, when what is not known is NaN and nothing is made up.
. "$(dirname "$0")/../../support/shell.sh"

need_python
cat >tools.py <<'END'
import math
import os
import struct
import sys

from dicom import dicom_slice

SIDE, COUNT = 5, 9


def voxel(z, i):
    return 100 * (z + 1) + i


def slice_file(z, intercept=None):
    voxels = [voxel(z, i) for i in range(SIDE * SIDE)]
    return dicom_slice(z, voxels, 2 * z - 6, spacing=2, intercept=intercept)


def folder(name, left_out=(), cut=(), intercept=None):
    """Slices but some; of others all but some last bytes."""
    os.mkdir(name)
    for z in range(COUNT):
        data = slice_file(z, intercept)
        if z in cut:
            data = data[:len(data) - cut[z]]
        if z not in left_out:
            with open(f"{name}/s_{z}.dcm", "wb") as file:
                file.write(data)


def same(path, lost):
    """A .npy holds all voxels, and NaN where slices are lost."""
    with open(path, "rb") as file:
        data = file.read()
    begin = 10 + struct.unpack("<H", data[8:10])[0]
    assert b"'<f4'" in data[:begin], data[:begin]
    values = struct.unpack(f"<{(len(data) - begin) // 4}f", data[begin:])
    assert len(values) == COUNT * SIDE * SIDE, len(values)
    for at, value in enumerate(values):
        z, i = divmod(at, SIDE * SIDE)
        right = math.isnan(value) if z in lost else value == voxel(z, i)
        assert right, (z, i, value)


if __name__ == "__main__":
    same(sys.argv[1], [int(z) for z in sys.argv[2:]])
else:
    folder("whole")
    folder("gap", [4])
    folder("two", [3, 4])
    folder("gaps", [2, 6])
    folder("cut", cut={4: 10})
    folder("torn", cut={4: 140})
    folder("none", cut=dict.fromkeys(range(COUNT), 4))
    folder("hu", intercept="-1000")
END
python3 -c "import tools"

run 0 "info of a whole folder" "$TOOL" info whole
cp "$OUT" whole.txt
run 0 "with gaps allowed" "$TOOL" info whole --allow-gaps
check "is the same" cmp -s "$OUT" whole.txt
silent

# opens NAME PATTERN LOST...: refused, listed, and opened with gaps.
opens() {
    local name=$1 fault=$2 note=$3
    shift 3
    refused 3 "$name is not opened" "$fault" "$TOOL" $name -o z.png
    printed "$name is listed" "^dims  *5 x 5 x 9 " "$TOOL" info $name
    prints "^type  *float32$"
    prints "^spacing  *2 x 2 x 2 mm"
    prints "^finite  *$((25 * (9 - $#))) of 225 "
    says "$note"
    says "note: $name: other verbs need --allow-gaps to open it"
    run 0 "$name is listed as JSON, quiet" "$TOOL" info -q --json $name
    silent
    told "$name with gaps" "$note" "$TOOL" convert $name --allow-gaps -o $name.npy
    check "has its voxels and no others" python3 tools.py $name.npy "$@"
    told "$name as a picture" "$note" \
        "$TOOL" $name --allow-gaps -o $name.png -s 40x40 --save-config $name.json
    run 0 "$name by its configuration" "$TOOL" --config $name.json -q \
        -o again.png -y
    check "is the same picture" cmp -s $name.png again.png
}
opens gap "1 of its slices is missing between s_3.dcm and s_5.dcm .*; add it, or give --allow-gaps" \
    "1 slice is missing between s_3.dcm .frame 0, at 0 mm. and s_5.dcm .frame 0, at 4 mm.; the gap is left transparent" 4
opens two "2 of its slices are missing between s_2.dcm and s_5.dcm" \
    "2 slices are missing between s_2.dcm .frame 0, at -2 mm. and s_5.dcm .frame 0, at 4 mm." 3 4
opens gaps "1 of its slices is missing between s_1.dcm and s_3.dcm" \
    "1 slice is missing between s_5.dcm .frame 0, at 4 mm. and s_7.dcm .frame 0, at 8 mm." 2 6
opens cut "s_4.dcm: is truncated or damaged" \
    "s_4.dcm is cut: its slice .frame 0, at 2 mm. is left transparent" 4
opens torn "s_4.dcm: is truncated or damaged" \
    "s_4.dcm: is truncated or damaged: .*; it is left out" 4


refused 3 "a folder of cut slices" "all of its slices are cut" \
    "$TOOL" none --allow-gaps -o z.png
refused 3 "even to info" "s_0.dcm: is truncated or damaged" "$TOOL" info none
# --- lists ---------------------------------------------------------------------
"$TOOL" convert -q phantom:cube --dims 4x4x4 -o cube.nrrd
printed "a list" '^gap: dicom 5x5x9 float32, spacing 2x2x2 mm$' "$TOOL" info cube.nrrd gap
says "1 slice is missing between s_3.dcm"
says "note: gap: other verbs need --allow-gaps to open it"
run 0 "a list, quiet" "$TOOL" info -q cube.nrrd gap
silent
run 0 "gaps allowed" "$TOOL" info cube.nrrd gap --allow-gaps
not_said 'other verbs'
run 3 "a folder of cut slices in a list" "$TOOL" info cube.nrrd none
says "s_0.dcm: is truncated or damaged"
printed "one patient" '^patient  *Doe.Jane$' "$TOOL" info whole --patient
run 0 "a list of patients" "$TOOL" info cube.nrrd whole gap --patient
prints "^cube.nrrd: nrrd 4x4x4 uint8, spacing 64x64x64$"
check "names stand behind those that have one" \
    [ "$(grep -c ', patient Doe.Jane$' "$OUT")" = 2 ]
run 0 "as JSON" "$TOOL" info cube.nrrd whole --patient --json
prints '"path": "whole".*"patient": "Doe.Jane"'
run 0 "a list without that" "$TOOL" info cube.nrrd whole
check "has no name" bash -c "! grep -q Doe '$OUT' '$ERR'"
refused 2 "a window without its centre" "\-\-window: '5' is not a window" \
    "$TOOL" info cube.nrrd whole --window 5

# Slices beside volumes of their own are listed once, as their folder.
cp -r whole mixed
cp cube.nrrd mixed/a.nrrd
cp cube.nrrd mixed/s_5.nrrd
printed "a mixed folder" '^mixed: dicom 5x5x9 uint16, ' "$TOOL" info mixed
prints '^mixed/a.nrrd: nrrd 4x4x4'
prints '^mixed/s_5.nrrd: nrrd 4x4x4'
check "has three lines" [ "$(wc -l <"$OUT")" = 3 ]
check "no slice is mentioned" bash -c "! grep -q 's_[0-9].dcm' '$ERR'"
if command -v strace >/dev/null; then
    strace -f -e trace=openat -o trace "$TOOL" info mixed >/dev/null 2>&1
    opened=$(grep -c 's_[0-9].dcm' trace)
    check "each slice is opened a few times ($opened in all)" [ "$opened" -le 90 ]
    strace -f -e trace=openat -o trace "$TOOL" render whole -o p.png -s 20 \
        >/dev/null 2>&1
    opened=$(grep -c 's_[0-9].dcm' trace)
    check "a first picture lists them once ($opened)" [ "$opened" -le 30 ]
else
    skipped "how often slices are opened" "there is no strace"
fi
run 0 "info of a CT" "$TOOL" info hu
prints '^values  *-900 \.\. -76, mean -488 \(Hounsfield units\)$'
printed "as JSON" '"value_unit": "HU"' "$TOOL" info hu --json
printed "info of other values" '^values  *100 \.\. 924, mean 512$' "$TOOL" info whole
told "a slice beside a gap" "is used alone" "$TOOL" info gap/s_1.dcm
printed "and with gaps" "^dims  *5 x 5 x 9 " "$TOOL" info gap/s_1.dcm --allow-gaps
refused 2 "a data set of slices" "whole: --dataset x: .* slices have a single" \
    "$TOOL" info whole --dataset x
refused 2 "levels of slices" "slices have no levels" "$TOOL" info whole --levels 2
refused 2 "what reads no volume" "allow-gaps: is not an option of" \
    "$TOOL" compare a.png b.png --allow-gaps
finish
