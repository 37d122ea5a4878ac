#!/bin/bash
# Zarr through the tool: folders that are written here byte by byte, and real
# ones where they are.
. "$(dirname "$0")/../../support/shell.sh"

info() { "$TOOL" info "$@"; }

# array FOLDER SHAPE CHUNKS: of bytes, not compressed.
array() {
    mkdir -p "$1"
    printf '{"zarr_format": 2, "shape": [%s], "chunks": [%s], "dtype": "|u1",
        "order": "C", "filters": null, "compressor": null, "fill_value": 9}' \
        "$2" "$3" >"$1/.zarray"
}
# level FOLDER STEP: one of an image of two, its axes t, z, y, x.
level() {
    printf '{"path": "%s", "coordinateTransformations":
        [{"type": "scale", "scale": [1, %s, %s, %s]}]}' "$1" "$2" "$2" "$2"
}
image() {
    mkdir -p "$1"
    printf '{"zarr_format": 2}' >"$1/.zgroup"
    printf '{"multiscales": [{"version": "0.4", "axes": [
        {"name": "t", "type": "time"},
        {"name": "z", "type": "space", "unit": "micrometer"},
        {"name": "y", "type": "space", "unit": "micrometer"},
        {"name": "x", "type": "space", "unit": "micrometer"}],
        "datasets": [%s, %s]}]}' "$(level 0 0.5)" "$(level 1 1)" >"$1/.zattrs"
}

array a.zarr 2,2,2 2,2,1
printf '\1\3\5\7' >a.zarr/0.0.0
printf '\2\4\6\10' >a.zarr/0.0.1
printed "a bare array" '^format +zarr$' info a.zarr
prints '^dims +2 x 2 x 2'
prints '^values +1 .. 8, mean 4.5$'
prints '^storage +version 2, axes z y x, chunks 2x2x1, not compressed$'
printed "as JSON" '"sum": 36.0, "wsum": 204.0' info a.zarr --json
prints '"storage": "version 2, axes z y x, chunks 2x2x1, not compressed"'
printed "a crop" '"dims": \[1, 2, 1\]' info a.zarr --crop 1:,:,1: --json
prints '"min": 6.0, "max": 8.0'
rm a.zarr/0.0.0
run 0 "a crop beside a chunk that is missing" info a.zarr --crop 1:,:,:
silent
run 0 "a chunk that is missing" info a.zarr --json
says 'note: 1 of 2 chunks are not stored; their voxels are the fill value, 9$'
prints '"max": 9.0, "sum": 56.0'
run 0 "converted" "$TOOL" convert a.zarr -o a.nrrd
printed "it stays what it was" '"sum": 56.0' info a.nrrd --json
check "and tells no storage" [ -z "$(grep storage "$OUT")" ]
run 0 "a mask" info a.nrrd --mask a.zarr --json
run 0 "a picture" "$TOOL" render -q a.zarr -s 40x40 -o a.png
printed "by what describes it" '"sum": 56.0' info a.zarr/.zarray --json

# An image: times, levels, places.
image b.zarr
array b.zarr/0 2,2,2,2 1,2,2,2
array b.zarr/1 2,1,1,1 2,1,1,1
printf '\1\1\1\1\1\1\1\1' >b.zarr/0/0.0.0.0
printf '\2\2\2\2\2\2\2\2' >b.zarr/0/1.0.0.0
printf '\3\4' >b.zarr/1/0.0.0.0
run 0 "an image" info b.zarr --json --time 1
says 'level 0 of 2 \(0\) is used.*of 0 \(2, 2, 2, 2\), 1 \(2, 1, 1, 1\)$'
prints '"spacing": \[0.5, 0.5, 0.5\], "unit": "um"'
prints '"times": 2, "time": 1, "components": 1, "magnitude": false, "storage": "version 2, level 0 of 2 \(0\), axes t z y x, chunks 1x2x2x2, not compressed"'
prints '"min": 2.0, "max": 2.0'
for way in "b.zarr --dataset 1" b.zarr/1 b.zarr:/1 b.zarr/1/; do
    run 0 "another level, by $way" info $way --json
    prints '"spacing": \[1.0, 1.0, 1.0\], "unit": "um"'
    prints '"min": 3.0, "max": 3.0'
done
refused 2 "named twice" 'give only one of them' info b.zarr:/1 --dataset 1
refused 2 "no such level" 'has no array or group "7"' info b.zarr --dataset 7
refused 2 "a path that climbs" 'not a path within' info b.zarr --dataset ../a.zarr
refused 2 "no such time" 'time step' info b.zarr --time 2
refused 2 "no such channel" 'channel' info b.zarr --channel 1
refused 2 "a series" '--series' info b.zarr --series 1
refused 2 "a size" '--dims' info b.zarr --dims 1x1x1 --type uint8
rm -r b.zarr/0
told "the finest that exists" 'level 1 of 2 \(1\) is used, the finest that exists' info b.zarr
refused 2 "one that is not" 'level 0 \(0\) is missing.*1 \(2, 1, 1, 1\)' \
    info b.zarr --dataset 0
rm -r b.zarr/1
refused 3 "none that is there" 'none of the 2 levels' info b.zarr

# What is damaged or hostile.
array c.zarr 2,2,2 2,2,2
printf '\1\2\3' >c.zarr/0.0.0
refused 3 "a chunk that is cut" '0.0.0: holds 3 bytes' info c.zarr
rm c.zarr/0.0.0
ln -s 0.0.0 c.zarr/0.0.0
refused 3 "a link to itself" '0.0.0: cannot be opened' info c.zarr
rm c.zarr/0.0.0
ln -s . c.zarr/loop
run 0 "links in a circle" info c.zarr/loop/loop
ln -s . b.zarr/loop
refused 3 "groups in a circle" 'none of the 2 levels' info b.zarr/loop
echo '{' >c.zarr/.zarray
refused 3 "no JSON" '.zarray: line' info c.zarr
array c.zarr 9999999,9999999,9999999 64,64,64
refused 3 "sizes without bytes" 'c.zarr: ' info c.zarr
mkdir d.zarr
refused 3 "an empty folder" 'contains none' info d.zarr
refused 3 "no folder" 'cannot be opened' info e.zarr
run 5 "a limit of memory" "$TOOL" render a.zarr -s 9x9 -o m.png --memory 100
printed "doctor" '^formats .* zarr' "$TOOL" doctor
prints 'blosc'

if [ -d "$DATA/formats/zarr" ]; then
    brain=$DATA/formats/zarr/mni152.ome.zarr
    if "$TOOL" doctor --json | grep -q '"blosc": null'; then
        refused 3 "without Blosc" 'install libblosc-dev' info "$brain"
    else
        run 0 "a real image" info "$brain" --json
        says 'level 3 of 5 \(scale3/.*the finest that exists'
        prints '"dims": \[25, 32, 26\]'
        prints 'axes x y z, chunks 25x32x26, blosc lz4"'
        run 0 "rendered" "$TOOL" render -q "$brain" -s 64x64 -o b.png
    fi
fi
finish
