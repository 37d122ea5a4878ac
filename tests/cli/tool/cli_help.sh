#!/bin/bash
# The help is exact, goes to standard output, and fits 80 columns.  After a
# change that is meant, the pages of tests/cli/help are written anew by
#   for p in tests/cli/help/*/*.txt; do
#       build/snowglass help "$(basename "$p" .txt)" >"$p"; done
#   for w in window view ct-bone ct-soft-tissue mr-angio; do
#       build/snowglass help $w; done >tests/cli/help/words.txt
#   build/snowglass --help >tests/cli/help/overview.txt
. "$(dirname "$0")/../../support/shell.sh"

same_page() {
    check "$NAME: word by word" diff -u "$HERE/cli/help/$1" "$OUT"
    silent
    check "$NAME: at most 80 columns" [ -z "$(grep -E '^.{81}' "$OUT")" ]
    check "$NAME: no blank ends" [ -z "$(grep -E ' $' "$OUT")" ]
}

for way in "--help" "-h" "help" "help --help" "render x.nrrd --help=more"; do
    run 0 "snowglass $way" "$TOOL" $way
done

run 0 "the overview" "$TOOL" --help
same_page overview.txt
for word in output mode sparse kernel look quality camera labels data run \
    more render turntable movie slice info phantom convert \
    compare doctor report help bench tf serve export; do
    run 0 "help $word" "$TOOL" help $word
    same_page "$(cd "$HERE/cli/help" && echo */"$word.txt")"
    cp "$OUT" page
    run 0 "--help $word" "$TOOL" --help $word
    check "--help $word is the same page" cmp -s page "$OUT"
done
run 0 "info --help" "$TOOL" info --help
check "info --help is help info" cmp -s "$HERE/cli/help/verbs/info.txt" "$OUT"
run 0 "info INPUT --help" "$TOOL" info missing.nrrd --help
check "--help counts after an operand" cmp -s "$HERE/cli/help/verbs/info.txt" "$OUT"

words() {
    for word in window view ct-bone ct-soft-tissue mr-angio; do
        "$TOOL" help $word || return
    done
}
run 0 "pages of options and presets" words
same_page words.txt

# Verbs that render have one page; every option is found from there.
for verb in render turntable movie slice; do
    run 0 "$verb --help" "$TOOL" $verb --help
    check "one page" [ "$(wc -l <"$OUT")" -le 60 ]
    cp "$OUT" page
    check "three examples" [ "$(grep -c '^  snowglass ' page)" -eq 3 ]
    grep '^  snowglass ' page | sed 's/ |$//' >examples
    while read -r _ arguments; do
        run 3 "only the file is missing in: $arguments" "$TOOL" $arguments
    done <examples
done
for verb in turntable movie slice; do
    "$TOOL" help $verb >page
    check "$verb shows what is its own first" bash -c \
        "grep -m 1 -oE -- '--[a-z-]+ ' page | grep -qE 'as|frames|fps|axis'"
done
topics=$("$TOOL" help render | sed -n '/^all options/,/^$/s/^  \([a-z]*\) .*/\1/p')
check "topics are listed" [ "$(wc -w <<<"$topics")" -ge 10 ]
for topic in $topics; do "$TOOL" help "$topic"; done >all
sed -nE 's/^  (-.,|   ) --([a-z-]+).*/\2/p' all | sort -u >options
check "topics list all options" [ "$(wc -l <options)" -ge 70 ]
"$TOOL" help render | sed -nE 's/^  (-.,|   ) --([a-z-]+).*/\2/p' | sort -u >common
check "a dozen common ones" [ "$(wc -l <common)" -eq 12 ]
check "which are among them" [ -z "$(comm -23 common options)" ]
# The short tier looks at one of six.
sampled() { if long_tier; then cat; else sed -n '1~6p'; fi; }
grep -vx help options | sampled >others # --help of help is the overview
while read -r option; do
    "$TOOL" help "--$option" >page 2>&1 || fail "help --$option"
    sed -n 1p page | grep -q -- "--$option" || fail "help --$option tells it"
    grep -q '^verbs: ' page || fail "help --$option names its verbs"
    "$TOOL" help "$option" >plain 2>&1 || fail "help $option"
    grep -Eq "^  (-.,|   ) --$option( |\$)" plain || fail "help $option tells it"
    grep -E '^.{81}| $' page plain && fail "help $option fits 80 columns"
done <others
pass "options have pages"
run 0 "presets" "$TOOL" tf list --json
python3 -c 'import json, sys
print("\n".join(json.load(open(sys.argv[1]))["presets"]))' "$OUT" >names
check "there are many" [ "$(wc -l <names)" -ge 25 ]
sampled <names >presets
while read -r preset; do
    "$TOOL" help "$preset" >page 2>&1 || fail "help $preset"
    words=("^--preset $preset: " "^range: +[-0-9]" "^opacity of a "
        "^colours: +#")
    # Its colours and opacities are those of the volume's labels.
    [ "$preset" != labels ] ||
        words=("^--preset labels: " "^colours: +those " "^opacity: +1 ")
    for word in "${words[@]}"; do
        grep -Eq -- "$word" page || fail "help $preset: $word"
    done
    grep -E '^.{81}| $' page && fail "help $preset fits 80 columns"
done <presets
pass "presets have pages"
printed "a preset of any spelling" '^--preset ct-bone: ' "$TOOL" help CT_Bone
printed "a letter" '^  -w, --window ' "$TOOL" help -w
printed "an option of ranks" "^only in snowglass-mpi$" "$TOOL" help cut
printed "an option whose name is a topic's too" '^      --no-labels ' "$TOOL" help labels
prints '^      --labels LIST '

refused 2 "a name that is none" "is not a verb, topic, option or preset; topics: output" \
    "$TOOL" help weather
refused 2 "a name that is near" "windw: is not .*; did you mean window\?" \
    "$TOOL" help windw
refused 2 "an option that is near" "did you mean help\?" "$TOOL" help --hlep
refused 2 "no name" "is not a verb" "$TOOL" help --
refused 2 "help on two topics" "one word too many" "$TOOL" help look camera
run 2 "snowglass alone" "$TOOL"
says "usage: snowglass INPUT -o OUT.png"
check "snowglass alone prints nothing" [ ! -s "$OUT" ]

printed "--version" '^snowglass [0-9]+\.[0-9]+\.[0-9]+$' "$TOOL" --version

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
    printed "doctor on one processor" "^threads +1$" taskset -c "$first" "$TOOL" doctor
fi
printed "doctor --json" '"encodings": \["crs", "bitmap", "rle"\]' "$TOOL" doctor --json
prints '"formats": \[.*"nrrd".*\]'
prints '"volume_outputs": \["\.nrrd"'
finish
