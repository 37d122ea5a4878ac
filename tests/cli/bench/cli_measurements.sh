#!/bin/bash
# scripts/measurements: of what commands print it makes the very tables that
# stand in the documents, and leaves all else in them alone.
. "$(dirname "$0")/../../support/shell.sh"

command -v python3 >/dev/null || {
    echo "python3 is absent: skipped"
    exit 77
}
root=$(realpath "$HERE/..")
script=$root/scripts/measurements
cp -r "$root/docs" "$root/README.md" . || exit 1

run 0 "a quick run" "$TOOL" bench speed --quick --json --threads 1 \
    --only rgba,opaque,phong
cp "$OUT" speed.json
python3 - <<'END' || exit 1
import json
gain = {"gain_percent": 66.4, "paper_gain_percent": 55.0}
json.dump({"rows": [{"dataset": "Engine", "threshold": 10.0,
                     "sparse_percent": 77.45, "original": {"total_ms": 87.51},
                     "tested": {"gain_percent": 70.2}, "crs": gain,
                     "bitmap": gain, "rle": gain}]}, open("table2.json", "w"))
row = {"frame": 4.1, "change": 9.5, "first": 1234.4, "megabytes": 23.2,
       "psnr": 43.06, "psnr_scaled": 43.2}
both = [row | {"program": name, "threads": threads} for threads in (1, 2)
        for name in ("snowglass", "snowglass-draft", "vtk-cpu")]
json.dump({"rows": [{"ranks": 8, "splat_slowest_ms": 4.614, "splat_mean_ms": 4,
                     "exchange_slowest_ms": 1.5, "exchange_mean_ms": 0.757,
                     "picture_ms": 7.2, "bytes_sent": 12345678,
                     "imbalance": 1.1535, "efficiency": 0.294}]},
          open("scaling.json", "w"))
json.dump({"cases": [
    {"case": "engine:shaded:512", "rows": both + [
        row | {"program": "volpack", "threads": 1},
        {"program": "teem", "threads": 1, "failed": "of itself"}]},
    {"case": "of no column", "rows": []}]}, open("peers.json", "w"))
END
printf 'said before\n| ranks | 1 |\n| --- | ---: |\n| engine | 0 |\nafter\n' \
    >ranks.md
grep -A2 '^| volume | quality' docs/measurements/speed.md >light.md

write() {
    local name=$1 file=$2
    run 0 "$name is written" python3 "$script" --docs docs \
        --from "$name=$file" "$name"
}
write table2 table2.json
write peers peers.json
write readme peers.json
write speed speed.json
write accuracy speed.json
write ranks ranks.md
write scaling scaling.json
write files ranks.md
write light light.md

has() {
    local text=$1 page=$2
    check "$page has $text" grep -qFx "$text" "docs/$page"
}
has "| Engine | 10 | 77.5 % | 87.5 ms | 70 % | 66 % (55) | 66 % (55) | 66 % (55) |" paper.md
has "| VolPack | 4.10 |" measurements/peers.md
has "| to the first picture: ours / VolPack / VTK | 1,234 / 1,234 / 1,234 |" \
    measurements/peers.md
has "| two threads: draft / normal / VTK | 4.10 / 4.10 / 4.10 |" \
    measurements/peers.md
has "| VTK, CPU ray caster | 4.10 | – | 1,234 | 23 |" ../README.md
has "| engine | 0 |" measurements/ranks.md
has "| 8 | 4.61 | 4.00 | 1.50 | 0.76 | 7.20 | 12.35 | 1.15 | 29 % |" \
    measurements/ranks.md
has "| engine | 0 |" measurements/files.md
check "a cell of every way" grep -qE \
    '^\| Engine, opaque, Phong( \| [0-9.]+( / [0-9.]+)?){8} \|$' \
    docs/measurements/speed.md
# The tables' heads are those of the committed pages, so that what is written
# anew has the same columns, and nothing but tables has changed.
heads() { sed -nE '/<!-- table/,/^\| ---/p' "$@" | grep -v '^| ---'; }
for page in ../README.md paper.md measurements/speed.md; do
    check "$page: all else is as it was" diff \
        <(grep -v '^|' "$root/docs/$page") <(grep -v '^|' "docs/$page")
done
check "heads stay" diff <(heads "$root/docs/measurements/speed.md") \
    <(heads docs/measurements/speed.md)
check "the head of scaling stays" diff \
    <(grep -F '| ranks | slowest splat' "$root/docs/measurements/ranks.md") \
    <(grep -F '| ranks | slowest splat' docs/measurements/ranks.md)
check "heads of Table 2 and README stay" diff \
    <(heads "$root/docs/paper.md" "$root/README.md") \
    <(heads docs/paper.md README.md)

run 1 "a table without a place" python3 "$script" --docs "$root/src" \
    --from ranks=ranks.md ranks
run 2 "a table that nobody knows" python3 "$script" nothing
finish
