#!/bin/bash
# --config and --save-config: what was saved gives the same picture, and what
# stands on the command line counts more than what stands in a file.
. "$(dirname "$0")/../../support/shell.sh"

render() { "$TOOL" render -q "$@"; }

# --- saved and taken ----------------------------------------------------------
run 0 "a picture with many wishes is saved" "$TOOL" render \
    phantom:marschner-lobb --dims 40x36x44 --spacing 1x1.5x0.7 -o a.png \
    -s 130x110 --background '#102030' --bits 16 --threshold 2.5 \
    --kernel gauss:5 --preset linear -c inferno \
    --opacity 0.1:0,0.5:0.05,0.5:0.2,1:1 --range 0.1,0.9 --config '{"opacity-unit": "mm"}' \
    --gradient-opacity 0:0.1,0.2:0.7,0.2:0.8,1.25:1 \
    --light 20,-10 --material 0.31,0.6,0.1,7 \
    --depth-darkening 0.4 --occlusion 0.3 \
    --view iso --azimuth 33.3 --elevation -12 --roll 5 --zoom 1.1 \
    --perspective 25 --quality high --isa scalar -j 1 --crop 3:39,2:,:40 \
    --save-config all.json
run 0 "it gives the same picture" render --config all.json -o b.png
same_file "byte for byte" a.png b.png
run 0 "saved again, it is the same" render --config all.json -o c.png \
    --save-config again.json
check "but for the output" bash -c 'sed s/a.png/X/ all.json >one &&
    sed s/c.png/X/ again.json >other && diff one other'
run 4 "its own output is kept" render --config all.json
says 'a.png'
run 0 "and replaced where that is asked" render --config all.json -y

# What is meant for one mode may stand beside another.
run 0 "another mode" "$TOOL" render --config all.json -m mip -y -o mip.png
not_said 'no part'
told "but what is told" '^snowglass: note: --light has no effect in mode mip$' \
    "$TOOL" render --config all.json -m mip -y --light 3,4 -o mip.png

# The permission to replace files is for one run.
run 0 "saved with -y" render phantom:cube -s 9x9 -o once.png -y \
    --save-config once.json
run 4 "nothing is replaced without it" render --config once.json

# A unit that is told beside a transfer function of another one.
echo '{"snowglass-tf": 1, "opacity-unit": "mm",
    "opacities": [[0, 0], [255, 0.5]]}' >mm.json
run 0 "opacities of a voxel" render phantom:cube --dims 20x20x20 \
    --spacing 4x4x4 --tf mm.json --config '{"opacity-unit": "voxel"}' -o voxel.png \
    --save-config voxel.json
run 0 "and again" render --config voxel.json -o again.png
same_file "are the same" voxel.png again.png
run 0 "and not those of a millimetre" render phantom:cube --dims 20x20x20 \
    --spacing 4x4x4 --tf mm.json -o mm.png
other_file "which differ" voxel.png mm.png

small="phantom:shells --dims 24x20x22 -s 60x50"
again "what nobody asked for" render d.png phantom:cube
again "percentiles" render f.png $small --range p5,p95
again "a window as a range" render h.png $small --window 100,120
again "spelt in any case" render sa.png $small -m MIP -s 40 --window 300,120 --view Front \
    --quality HIGH
again "places of the camera" render pa.png $small --position 500,-300.5,400 \
    --target 10,8,12 --up 0,1,0.25 --perspective 20
"$TOOL" phantom cube --dims 16x16x16 -q -o step_0.nrrd && cp step_0.nrrd step_1.nrrd
run 0 "step 0" "$TOOL" render step_%d.nrrd --time 0 -s 20x20 -o step.png \
    --save-config step.json
check "is kept" grep -q '"time": 0' step.json
run 0 "and taken" "$TOOL" render --config step.json -o step_again.png
not_said 'takes another'
run 0 "no step" render step_%d.nrrd -s 20x20 -o no_step.png --save-config no_step.json
check "is not kept" bash -c "! grep -q '\"time\"' no_step.json"
run 0 "to standard output" render phantom:cube -o j.png --save-config -
prints '^\{"input": "phantom:cube", "output": "j.png", "size": \[512, 512\]'

# --- depths -------------------------------------------------------------------
run 0 "a depth" render phantom:shells --dims 24x20x22 -s 60x50 -o da.npy \
    --depth dd.npy --stats ds.json --save-config depth.json
refused 4 "is kept as the output is" 'dd.npy: ' \
    "$TOOL" render --config depth.json -o db.npy
check "before anything is made" absent db.npy
cp dd.npy before.npy
run 0 "and made again" render --config depth.json -y
check "as it was" cmp -s dd.npy before.npy
check "without its figures" bash -c '! grep -q stats depth.json'
run 0 "another place on the command line" render --config depth.json \
    -o db.npy --depth de.npy
check "counts more" cmp -s de.npy before.npy
run 0 "a mode without depth" render --config depth.json -m mip -o dm.npy
run 2 "beside a depth on the command line" \
    "$TOOL" render --config depth.json -m mip -o dn.npy --depth dn2.npy
if "$TOOL" doctor --json | grep -q '".exr"'; then
    run 0 "a picture with its depth" render phantom:shells --dims 24x20x22 \
        -s 60x50 -o z.exr --depth z.exr --save-config z.json
    cp z.exr before.exr
    run 0 "another picture" render --config z.json -o y.exr -y
    check "gets the depth too" cmp -s y.exr before.exr
    check "and the first is as it was" cmp -s z.exr before.exr
    run 0 "a picture that takes none" render --config z.json -o y.png -y
    check "has none, and the first is as it was" cmp -s z.exr before.exr
fi

# --- the command line counts more ---------------------------------------------
echo '{"input": "phantom:cube", "size": [50, 40], "range": [10, 20],
       "azimuth": 10, "deterministic": true, "overwrite": false,
       "perspective": 0}' >base.json
echo '{"window": [50, 100]}' >w.json
shells="phantom:shells --dims 20x20x20"
pairs png render <<END
a size and a window on the command line | --config base.json -s 60x30 --window 50,100 | = | \
    phantom:cube -s 60x30 --window 50,100 --azimuth 10 --deterministic
an input | $shells --config base.json --range 1,200 | = | \
    $shells -s 50x40 --range 1,200 --azimuth 10 --deterministic
a range over a window | phantom:cube --config w.json | = | \
    phantom:cube --config w.json --range 75,125
a window over another | phantom:cube --config w.json --window 60,90 | = | \
    phantom:cube --window 60,90
END
printed "info takes what is its own" 'phantom' "$TOOL" info --config base.json

# --- other spellings ----------------------------------------------------------
echo '{"input": "phantom:shells", "dims": [20, 20, 20], "mode": "MIP",
       "size": 40, "window": [300, 120], "view": "Front",
       "quality": "HIGH"}' >spelt.json
pairs png render <<END
in any case, with one number for both sides | \
    $shells -m MIP -s 40 --window 300,120 --view Front --quality HIGH | = | \
    $shells -m mip -s 40x40 --window 300,120 --view -y --quality high
a file takes these spellings too | " | = | --config spelt.json
sizes, percentiles and types in capitals | phantom:shells --dims 20X20X20 --spacing 1X1X2 \
    -s 40X30 --range P2,P98 --memory 1GIB --background BLACK --light HEAD | = | \
    $shells --spacing 1x1x2 -s 40x30 --range p2,p98 --memory 1gib --background black --light head
END
printf '\1\2\3\4\5\6\7\10' >eight.raw
printed "a raw file's" '"min": 258.0, "max": 1800.0' \
    "$TOOL" info eight.raw --dims 2X2X1 --type UINT16 --endian BIG --range FULL --json
if command -v python3 >/dev/null; then
    need_python
    python3 -c 'import struct, volumes
volumes.npy("vectors.npy", "<f4", (4, 4, 4, 3), struct.pack("<192f", *range(192)))'
    printed "a component" '"min": 1.0, "max": 190.0' "$TOOL" info vectors.npy --component Y --json
    run 0 "all of them" "$TOOL" info vectors.npy --component Magnitude
    run 0 "a picture of one" render vectors.npy --component Y -o va.png \
        -s 9x9 --save-config v.json
    check "which is saved" grep -q '"component": "y"' v.json
    run 2 "one that is none" "$TOOL" info vectors.npy --component Radius
    says 'component Radius: not a component'
else
    skipped "components in capitals" "there is no python3"
fi

# --- places of the camera -----------------------------------------------------
run 0 "a place" render $small -o pa.png --position 500,-300.5,400 --target 10,8,12 \
    --up 0,1,0.25 --perspective 20 --save-config p.json
pairs png render <<END
a view takes the place's place, with target and up | --config p.json --view left | = | \
    $small --view left --target 10,8,12 --up 0,1,0.25 --perspective 20
END

# --- refused ------------------------------------------------------------------
refused 3 "a file that is not there" 'none.json: cannot be opened' \
    "$TOOL" render --config none.json phantom:cube -o x.png
mkfifo pipe
for file in pipe . /dev/zero; do
    refused 3 "--config $file" "^snowglass: $file: cannot be opened" \
        timeout 10 "$TOOL" render --config $file phantom:cube -o x.png
done
while IFS='|' read -r json pattern; do
    printf "$json" >bad.json
    refused 3 "$json" "$pattern" "$TOOL" render --config bad.json phantom:cube -o x.png
done <<'END'
{"colour": "red"}|"colour" is not a key of a recipe
{"size": "big"}|"size" must be \[width, height\]
{"size": [1, 2],\n"azimuth": }|bad.json: line 2 is not valid JSON
END
refusals 2 "$TOOL" render -o x.png <<'END'
--config w.json|an operand is missing
phantom:cube --save-config x.png|name two files
phantom:cube --depth w.npy --save-config w.npy|same file as --depth; name two
phantom:cube --stats q.json --save-config q.json|same file as --stats; name two
END
refused 4 "a configuration that exists" 'depth.json: exists' \
    "$TOOL" render phantom:cube -o x.png --save-config depth.json
check "nothing is written then" absent x.png

# --- movies -------------------------------------------------------------------
echo '{"size": [40, 30], "azimuth": 15, "colormap": "hot"}' >turn.json
run 0 "a turntable from a file" "$TOOL" turntable -q phantom:cube \
    --dims 20x20x20 --frames 2 --config turn.json -o 't_%d.png'
run 0 "and without" "$TOOL" turntable -q phantom:cube --dims 20x20x20 \
    --frames 2 -s 40x30 --azimuth 15 -c hot -o 'u_%d.png'
check "are the same" cmp -s t_1.png u_1.png
finish
