#!/bin/bash
# Picture formats that need a library, through the tool: equal values where this
# build has it, and else a refusal in words.  Animated WebP of turntables.
. "$(dirname "$0")/../../support/shell.sh"

render() {
    "$TOOL" render -q phantom:head --dims 32x32x32 -s 90x80 --no-labels "$@"
}
has() { "$TOOL" doctor --json | grep -q "\"$1\""; }

run 0 "floats" render -o a.npy
run 0 "levels" render -o a.png
for suffix in .exr .tif .tiff .webp; do
    case $suffix in
    .tif*) [ -r /proc/self/maps ] || {
        skipped "$suffix" "there is no /proc, and modules are not loaded without"
        continue
    } ;;
    esac
    like=a.npy
    [ $suffix = .webp ] && like=a.png
    if has "${suffix/.tiff/.tif}"; then
        run 0 "$suffix is written" render -o "a$suffix"
        run 0 "and holds the same" "$TOOL" compare $like "a$suffix"
        silent
        refused 4 "$suffix is kept" 'exists' render -o "a$suffix"
        head -c 200 "a$suffix" >cut
        refused 3 "$suffix that is cut" 'cut: ' "$TOOL" compare cut a.png
    else
        refused 2 "$suffix is not in this build" 'install lib' \
            render -o "a$suffix"
        check "and not written" absent "a$suffix"
    fi
done
refused 2 "an unknown suffix" 'has no suffix of a picture' render -o a.bmp
if has .jpg; then
    for name in a.jpg a.jpeg A.JPG; do
        run 0 "$name is written" render -o "$name"
        refused 4 "$name is kept" 'exists' render -o "$name"
        check "$name is a JPEG" [ "$(od -An -tx1 -N3 "$name")" = " ff d8 ff" ]
    done
    check "by both suffixes the same" cmp -s a.jpg a.jpeg
    run 0 "on a background" render -o white.jpg --background white
    run 0 "as a PNG" render -o white.png --background white
    run 6 "which is near" "$TOOL" compare white.jpg white.png --tolerance 0.004
    prints 'mean +0\.00[0-9]'
    refused 2 "16 bits in JPEG" 'JPEG has 8 bits' render -o b.jpg --bits 16
    refused 2 "no depth in it" 'cannot hold depths' \
        render -o b.png --depth b.jpg
    run 0 "frames" "$TOOL" turntable -q phantom:head --dims 32x32x32 -s 90x80 \
        --frames 2 -o 'j_%d.jpg'
    check "two of them" [ -s j_1.jpg ]
    printed "which a pattern makes slices" '^dims +90 x 80 x 2 ' "$TOOL" info 'j_%d.jpg'
    mkdir volumes
    "$TOOL" convert -q phantom:cube --dims 9x8x7 -o volumes/b.nrrd
    cp a.jpg volumes
    printed "a preview does not hide volumes" '^volumes/b.nrrd: nrrd 9x8x7' "$TOOL" info volumes
else
    refused 2 "JPEG is not in this build" 'install libjpeg62-turbo-dev' \
        render -o a.jpg
fi
if has .exr; then
    refused 2 "a background of EXR" '\-\-background and --bits' \
        render -o b.exr --background white
    run 0 "a picture and its depth in one EXR" render -o z.exr --depth z.exr -c hot
    run 0 "and in two files" render -o z.npy --depth zz.npy -c hot
    run 0 "are the same picture" "$TOOL" compare z.npy z.exr
    check "and there is more in it" [ "$(stat -c %s z.exr)" -gt "$(stat -c %s a.exr)" ]
    refused 4 "which is kept" 'exists' render -o z.exr --depth z.exr
    run 0 "unless it may be replaced" render -o z.exr --depth ./z.exr -y \
        -c hot
    turned="phantom:head --dims 32x32x32 -s 90x80"
    film() { "$TOOL" turntable -q --frames 3 "$@"; }
    run 0 "frames with depths" film $turned -c hot -o 'z_%d.exr' --depth 'z_%d.exr'
    check "the first is the picture with its depth" cmp -s z.exr z_0.exr
    rm z_1.exr
    run 0 "frames of a configuration" film $turned -c hot -o 'y_%d.exr' \
        --depth 'y_%d.exr' --save-config frames.json
    run 0 "go along with another pattern" film --config frames.json -o 'x_%d.exr'
    check "depths and all" cmp -s x_2.exr z_2.exr
    run 0 "and stay out of pictures that take none" film --config frames.json -o 'x_%d.png'
    run 0 "a depth of a picture" render -o p.npy --depth q.npy --save-config one.json
    run 0 "is none of a movie's" film --config one.json -o 'w_%d.exr'
    run 0 "frames of EXR" film $turned -o 'e_%d.exr'
    run 0 "and of floats" film $turned -o 'e_%d.npy'
    run 0 "are the same" "$TOOL" compare e_1.exr e_1.npy
fi
if ! has .webp; then
    refused 2 "an animated WebP" 'this build cannot write WebP' \
        "$TOOL" turntable phantom:cube -o t.webp --frames 2
    finish
fi
refused 2 "16 bits in WebP" 'has 8 bits' render -o b.webp --bits 16
refused 2 "a WebP too wide" 'at most 16383' render -o b.webp -s 16384x1
refused 2 "an animation too wide" 'at most 16383' "$TOOL" turntable \
    phantom:cube -o b.webp -s 16384x1
refused 2 "a number in a movie's place" 'has no suffix|number' \
    "$TOOL" turntable phantom:cube -o 'b_%d.bmp' --frames 2

turn() {
    "$TOOL" turntable -q phantom:head --dims 24x24x24 -s 70x60 --frames 5 "$@"
}
run 0 "an animation" turn -o t.webp
check "leaves nothing beside it" absent t.webp.frames
run 0 "its frames as pictures" turn -o 't_%d.webp'
check "five of them" [ "$(ls t_?.webp | wc -l)" = 5 ]
refused 4 "an animation is kept" 'exists' turn -o t.webp
run 0 "with any number of threads" turn -o u.webp -j 1
check "it is the same" cmp -s t.webp u.webp
refused 3 "an animation is no picture" 'is an animated WebP' \
    "$TOOL" compare t.webp a.png
# A run that was ended leaves its frames, and the next goes on with them.
"$TOOL" turntable -q phantom:head --dims 24x24x24 -s 70x60 --frames 400 \
    -o v.webp >/dev/null 2>&1 &
pid=$!
while [ ! -e v.webp.frames/000002.webp ] && kill -0 $pid 2>/dev/null; do :; done
kill -9 $pid 2>/dev/null
wait $pid 2>/dev/null
check "frames are left" [ -e v.webp.frames/000002.webp ]
run 0 "and gone on with" turn -v -o v.webp --frames 400 --resume
run 0 "in one go" turn -o w.webp --frames 400
check "it is the same" cmp -s v.webp w.webp
finish
