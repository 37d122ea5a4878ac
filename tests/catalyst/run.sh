#!/bin/bash
# tests/catalyst/run.sh - `run.sh TOOL DATA DRIVER PLUGIN`: pictures by way of
# Catalyst are those that the tool makes of the same field.
. "$(dirname "$0")/../support/shell.sh"
DRIVER=$3 PLUGIN=$4
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1

cat >look.json <<'END'
{"input": "grid/v", "output": "f_%02d.png", "size": [200, 160],
 "colormap": "viridis", "range": [0, 100], "opacity": [[20, 0], [90, 0.8]],
 "view": "iso", "overwrite": true}
END

tool_picture() {
    "$TOOL" render field.raw --fit volume --background none --dims 30x26x22 --type float64 \
        --spacing 0.2x0.2x0.25 -o "$1" -y -q -s 200x160 -c viridis \
        --range 0,100 --opacity 20:0,90:0.8 --view iso
}

for way in vertex element ghosts multi strided; do
    rm -f f_*.png
    run 0 "$way: a simulation runs" "$DRIVER" "$PLUGIN" look.json $way field.raw
    check "$way: the tool draws its field" tool_picture tool.png
    run 0 "$way: the pictures are equal" "$TOOL" compare f_00.png tool.png
    run 0 "$way: the second too" "$TOOL" compare f_01.png tool.png
done

rm -f f_*.png
run 0 "a mesh that cannot be shown does not end the simulation" \
    "$DRIVER" "$PLUGIN" look.json wrong field.raw
says "channel 'grid' has a coordset of type 'explicit'"
check "nor does it leave a picture" absent f_00.png

echo '{"input": "nowhere/v"}' >look.json
run 0 "a channel that is not there" "$DRIVER" "$PLUGIN" look.json vertex f.raw
says 'no rank has a brick'
echo '{"input": "grid/w"}' >look.json
run 0 "a field that is not there" "$DRIVER" "$PLUGIN" look.json vertex f.raw
says "channel 'grid' has no field 'w'"
echo '{"colourmap": "hot"}' >look.json
run 0 "a wrong recipe" "$DRIVER" "$PLUGIN" look.json vertex f.raw
says '"colourmap" is not a key of a recipe'
check "says so once" [ "$(grep -c colourmap "$ERR")" -eq 1 ]
check "and makes no picture of another look" absent snowglass_000000.png
for said in step time; do
    echo '{"input": "v", "size": 150, "output": "'$said'_%d.png",
        "annotate": "'${said/time/time=%.3f}'"}' >look.json
    run 0 "a picture with its $said" "$DRIVER" "$PLUGIN" look.json vertex f.raw
done
run 6 "time and step are two words" "$TOOL" compare step_1.png time_1.png
echo '{"input": "v"}' >look.json
run 0 "a recipe that names the environment's way" env SNOWGLASS_VERBOSE=1 \
    SNOWGLASS_RECIPE="$WORK/look.json" "$DRIVER" "$PLUGIN" no.json vertex f.raw
says 'step 1: .* s \(update'
check "and its pictures by their usual name" is_png snowglass_000001.png
finish
