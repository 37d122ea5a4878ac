#!/bin/bash
# bench combine: pictures are verified, counts are exact, and times printed.
. "$(dirname "$0")/../../support/shell.sh"

for way in auto tree swap direct "radix --radix 3"; do
    # shellcheck disable=SC2086
    run 0 "$way of 7 ranks" "$TOOL" bench combine --ranks 7 --size 97 \
        --runs 1 --check --method $way
    prints '^ranks=7 nodes=1 rank_per_node=7 threads=1 .* check=ok max_abs_diff=0\.00'
done
run 0 "grey floats, interlaced" "$TOOL" bench combine --ranks 4 --size 64 \
    --runs 1 --check --grey --floats --pieces interlaced
prints 'pixel_bytes=8 gather_bytes=8 .*pieces=interlaced check=ok'
# What each of 4 ranks must send: 3/4 of 64 x 64 pixels of 16 bytes.
run 0 "whole pictures" "$TOOL" bench combine --ranks 4 --size 64 --runs 1 \
    --whole --method swap --check
prints 'exchange_bytes_max=49152 exchange_msgs_max=2 '
run 0 "sizes only" "$TOOL" bench combine --ranks 4 --size 64 --runs 1 \
    --whole --method swap --sizes-only --json
prints '"check": "none", .*"exchange_bytes_max": 49152, "exchange_msgs_max": 2,'
# What a processor takes, on the region of one of so many ranks.
run 0 "rates" "$TOOL" bench combine --rates --ranks 3 --size 64 --runs 1 \
    --threads 2
prints '^ranks=3 image=64 .*threads=2 scan_ns=[0-9.]+ .*move_ns=[0-9.]+ .*over_copy='
# A region of less than a row is where the local images have pixels.
run 0 "rates of many" "$TOOL" bench combine --rates --ranks 2048 --size 512 \
    --runs 1
prints ' blend_ns=[0-9.]*[1-9][0-9.e-]* message_ns=[0-9.]*[1-9].* move_ns=[0-9.]*[1-9]'
run 0 "threads of ranks" "$TOOL" bench combine --ranks 3 --size 192 --runs 1 \
    --threads 3 --check
prints '^ranks=3 .*threads=3 .* check=ok'
run 2 "no such method" "$TOOL" bench combine --method shell
says "this value is not possible: 'shell'"
run 2 "no such option" "$TOOL" bench combine --rank 3
run 2 "a check without pixels" "$TOOL" bench combine --check --sizes-only
# Pictures as local images.
for slab in 0 1 2; do
    run 0 "the picture of slab $slab" "$TOOL" render phantom:engine \
        --dims 24x24x24 --crop ":,:,$((8 * slab)):$((8 * slab + 8))" \
        --background none --size 40x30 --threshold 10 --azimuth 20 -o "slab_0$slab.png"
done
run 0 "slabs in files" "$TOOL" bench combine --ranks 3 --runs 1 --check \
    --pattern slab_%02d.png
prints 'image=40x30 pattern=slab_%02d.png .* check=ok max_abs_diff=0\.00'
counts=$(grep -o 'bytes_sent_max.* imbalance' "$OUT")
run 0 "slabs in files, sizes only" "$TOOL" bench combine --ranks 3 --runs 1 \
    --sizes-only --pattern slab_%02d.png
prints "check=none $counts"
run 0 "a picture for all ranks, grey" "$TOOL" bench combine --ranks 5 --runs 1 \
    --check --floats --grey --pattern slab_01.png --method swap --json
prints '"image": "40x30", "pattern": "slab_01.png", .*"check": "ok"'
run 3 "a file for each rank" "$TOOL" bench combine --ranks 4 --pattern slab_%02d.png
says "rank 3: slab_03.png: cannot be opened"
run 0 "a picture of another size" "$TOOL" render phantom:engine \
    --dims 8x8x8 --size 40x31 -o slab_03.png
run 3 "pictures of two sizes" "$TOOL" bench combine --ranks 4 \
    --pattern slab_%02d.png
says "slab_%02d.png: local images are of different sizes, 40 to 40 columns and 30 to 31 lines"
echo "no picture" >words.png
run 3 "a file that is no picture" "$TOOL" bench combine --pattern words.png
says "words.png: is not a picture of a known format"
head -c 100 slab_00.png >cut.png
run 3 "a picture that is cut off" "$TOOL" bench combine --pattern cut.png
says "cut.png: "
for name in slab_%x.png slab_%d_%d.png slab_%s.png slab_% slab_%999999d.png; do
    run 2 "the name $name" "$TOOL" bench combine --pattern "$name"
    says "a number's place as in slab_%02d.png, is not what this names: '$name'"
done
for word in "--fill 0.2" "--size 64" "--rates"; do
    # shellcheck disable=SC2086
    run 2 "pictures and $word" "$TOOL" bench combine --pattern slab_00.png $word
    says "pictures in files make no use of '${word%% *}'"
done
run 2 "no name" "$TOOL" bench combine --pattern
says "a value is missing after '--pattern'"
run 0 "the cube by name" "$TOOL" bench combine --ranks 2 --size 32 --runs 1 \
    --pattern box --check
prints 'image=32 pattern=box .*check=ok'
run 0 "help" "$TOOL" bench combine --help
finish
