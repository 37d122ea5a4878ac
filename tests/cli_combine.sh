#!/bin/bash
# bench combine: pictures are verified, counts are exact, and times printed.
. "$(dirname "$0")/support_shell.sh"

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
run 2 "no such method" "$TOOL" bench combine --method shell
says "this value is not possible: 'shell'"
run 2 "no such option" "$TOOL" bench combine --rank 3
run 2 "a check without pixels" "$TOOL" bench combine --check --sizes-only
run 0 "help" "$TOOL" bench combine --help
finish
