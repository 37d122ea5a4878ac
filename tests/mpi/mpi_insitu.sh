# mpi_insitu.sh - simulations over MPI that make movies of themselves: the
# frames are the pictures that the tool makes of the same fields.
. "$(dirname "$0")/../support/mpi.sh"
EXAMPLES=$TESTS/../examples/insitu
SOURCES=$HERE/../examples/insitu
# One step of 8 bits, and the rounding of its premultiplied floats.
STEP=1.001/255
# Parts are within a step of the whole; a file's colours and alpha are rounded,
# each to a step of its own.
STEPS=2/255

# --- Gray and Scott, in C -----------------------------------------------------
for ranks in 1 3; do
    rm -f v_*.png v.raw
    run 0 "gray_scott on $ranks ranks" \
        launch "$ranks" "$EXAMPLES/gray_scott" 40 600 300 v_%04d.png v.raw
    check "two frames" test -s v_0300.png -a -s v_0600.png
    run 0 "the tool draws its field" "$TOOL" render v.raw --dims 40x40x40 \
        --type float64 -o tool.png -y -q --preset linear -c viridis \
        --range 0.05,0.35 --opacity 0.08:0,0.15:0.15,0.3:0.6 --view iso --fit volume --background none
    check "something is seen" test "$(wc -c <v_0600.png)" -gt 8000
    run 0 "$ranks ranks: frame and picture differ by rounding" \
        "$TOOL" compare v_0600.png tool.png --tolerance $STEPS
    [ "$ranks" -eq 1 ] && cp v_0600.png one.png
    run 0 "$ranks ranks: and from that of one rank" \
        "$TOOL" compare v_0600.png one.png --tolerance $STEPS
done
run 1 "frames of an earlier run are kept" \
    launch 2 "$EXAMPLES/gray_scott" 16 10 10 v_0600.png%d /dev/null
touch v_0010.png
run 1 "and the message names the file" \
    launch 2 "$EXAMPLES/gray_scott" 16 10 10 v_%04d.png
says 'v_0010.png'

# --- heat, in Fortran ---------------------------------------------------------
if [ -x "$EXAMPLES/heat" ]; then
    cp "$SOURCES/heat.json" .
    run 0 "heat on 3 ranks" launch 3 "$EXAMPLES/heat" heat.json heat.raw
    prints 'pictures took'
    run 0 "the tool draws its field" "$TOOL" render heat.raw \
        --dims 48x40x56 --type float64 -o tool.png -y -q \
        -s 400x400 --background '#101018' -c magma --range 0,1 \
        --opacity 0.05:0,0.3:0.05,0.6:0.1,0.95:0.3,1:0.9 --view iso --fit volume
    run 0 "frame and picture differ by rounding" \
        "$TOOL" compare heat_0240.png tool.png --tolerance $STEP
    printf '{"colormap": "plasma", "range": [0, 1], "size": [400, 300],
        "opacity": [[0.05, 0], [0.5, 0.1], [1, 0.9]], "azimuth": 30,
        "elevation": 20, "title": "Heat", "legend": true, "annotate": "time",
        "output": "said_%%04d.png"}' >said.json
    run 0 "heat described by calls" launch 2 "$EXAMPLES/heat" -
    run 0 "heat described by a recipe" launch 2 "$EXAMPLES/heat" said.json
    run 0 "both are one picture" \
        "$TOOL" compare told_0120.png said_0120.png
else
    echo "       no Fortran: heat is not tried"
fi

# --- by way of Catalyst -------------------------------------------------------
PLUGIN=$TESTS/catalyst/libcatalyst-snowglass.so
cat >look.json <<'END'
{"input": "grid/v", "output": "f_%02d.png", "size": [200, 160],
 "colormap": "viridis", "range": [0, 100], "opacity": [[20, 0], [90, 0.8]],
 "view": "iso", "overwrite": true}
END
# catalyst WAY RECIPE OPTION...: its second frame is the tool's picture.
catalyst() {
    local way=$1 recipe=$2
    shift 2
    rm -f f_*.png
    run 0 "Catalyst, $way, on 3 ranks" launch 3 \
        "$TESTS/catalyst/catalyst_driver" "$PLUGIN" "$recipe" "$way" field.raw
    run 0 "the tool draws its field" "$TOOL" render field.raw \
        --dims 30x26x22 --type float64 --spacing 0.2x0.2x0.25 -o tool.png -y \
        -q -s 200x160 -c viridis --range 0,100 --view iso --fit volume "$@"
    run 0 "$way, $recipe: picture and picture differ by rounding" \
        "$TOOL" compare f_01.png tool.png --tolerance $STEP
}
for way in vertex ghosts multi empty; do
    catalyst $way look.json --opacity 20:0,90:0.8 --background none
done
sed 's/"opacity": .*]],/"mode": "mean", "background": "#000000",/' look.json \
    >mean.json
catalyst element mean.json --mode mean --background black
rm -f f_*.png
run 0 "a mesh on one rank that cannot be shown" launch 3 \
    "$TESTS/catalyst/catalyst_driver" "$PLUGIN" look.json mixed field.raw
says "rank 2: channel 'grid' has a coordset of type 'explicit'"
check "leaves no picture" absent f_00.png
finish
