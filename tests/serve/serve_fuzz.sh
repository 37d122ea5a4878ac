#!/usr/bin/env bash
# tests/serve/serve_fuzz.sh - `script TOOL DATA`: ten seconds of libFuzzer over
# what comes through the viewer's sockets; its corpus is replayed by fuzz_viewer.
. "$(dirname "$0")/../support/shell.sh"
SOURCE=$HERE/..
flags="-fsanitize=fuzzer,address,undefined -fno-sanitize-recover=all -g1 -O1"
clang $flags -D_POSIX_C_SOURCE=200809L -I "$SOURCE/serve" \
    $(pkg-config --cflags jansson) "$SOURCE/fuzz/fuzz_viewer.c" -o fuzzer \
    $(pkg-config --libs jansson) 2>said || {
    skipped all "clang makes no libFuzzer program here: $(head -n 1 said)"
    exit 77
}
cp -r "$SOURCE/fuzz/corpus/viewer" corpus
run 0 "ten seconds of fuzzing find nothing" ./fuzzer corpus -max_total_time=10 \
    -max_len=4096 -timeout=5 -rss_limit_mb=1024 -artifact_prefix=found-
grep -E "^Done" "$ERR"
check "they were not idle" grep -qE "^Done [0-9]{4,}" "$ERR"
for found in found-*; do
    [ ! -e "$found" ] || od -c "$found" | head -20
done
finish
