#!/bin/bash
# The help is exact, goes to standard output, and fits 80 columns.  After a
# change that is meant, the pages of tests/cli/help are written anew by
#   for p in tests/cli/help/help_*.txt; do
#       w=${p#*help_}; build/snowglass help ${w%.txt} >$p; done
#   build/snowglass --help >tests/cli/help/overview.txt
. "$(dirname "$0")/../../support/shell.sh"

same_page() {
    check "$NAME: word by word" diff -u "$HERE/cli/help/$1" "$OUT"
    check "$NAME: nothing on stderr" [ ! -s "$ERR" ]
    check "$NAME: at most 80 columns" [ -z "$(grep -E '^.{81}' "$OUT")" ]
    check "$NAME: no blank ends" [ -z "$(grep -E ' $' "$OUT")" ]
}

for way in "--help" "-h" "help" "help --help" "render x.nrrd --help=more"; do
    # shellcheck disable=SC2086
    run 0 "snowglass $way" "$TOOL" $way
done

run 0 "the overview" "$TOOL" --help
same_page overview.txt
for word in output mode sparse kernel look quality camera labels data run \
    more render turntable movie info phantom convert \
    compare doctor help bench tf; do
    run 0 "help $word" "$TOOL" help $word
    same_page "help_$word.txt"
    cp "$OUT" page
    run 0 "--help $word" "$TOOL" --help $word
    check "--help $word is the same page" cmp -s page "$OUT"
done
run 0 "info --help" "$TOOL" info --help
check "info --help is help info" cmp -s "$HERE/cli/help/help_info.txt" "$OUT"
run 0 "info INPUT --help" "$TOOL" info missing.nrrd --help
check "--help counts after an operand" cmp -s "$HERE/cli/help/help_info.txt" "$OUT"

refused 2 "a topic that is none" "is not a topic or a verb" "$TOOL" help weather
refused 2 "help on two topics" "one word too many" "$TOOL" help look camera
run 2 "snowglass alone" "$TOOL"
says "usage: snowglass INPUT -o OUT.png"
check "snowglass alone prints nothing" [ ! -s "$OUT" ]

run 0 "--version" "$TOOL" --version
prints '^snowglass [0-9]+\.[0-9]+\.[0-9]+$'

run 0 "doctor" "$TOOL" doctor
for key in version formats phantoms presets colormaps kernels encodings \
    methods modes isa threads mpi memory; do
    prints "^$key +[^ ]"
done
prints '^methods .* shear-warp'
prints '^volume outputs .*\.npy'
prints '^picture outputs +\.png'
# Processors that the process may not use are not counted.
if command -v taskset >/dev/null; then
    first=$(taskset -cp $$ | sed 's/.*: *\([0-9]*\).*/\1/')
    run 0 "doctor on one processor" taskset -c "$first" "$TOOL" doctor
    prints "^threads +1$"
fi
run 0 "doctor --json" "$TOOL" doctor --json
prints '"encodings": \["crs", "bitmap", "rle"\]'
prints '"formats": \[.*"nrrd".*\]'
prints '"volume_outputs": \["\.nrrd"'
finish
