#!/bin/bash
# bench figure11 and figure12: speed-ups hang together, pictures of many nodes
# are that of one, and the chart is well-formed.
. "$(dirname "$0")/../../support/shell.sh"

need_python

# hang_together FILE CHART: speed-ups are those of the seconds; of a file of
# `bench all`, too.
hang_together() {
    python3 - "$@" <<'END'
import json, math, sys
from xml.dom import minidom

told = json.load(open(sys.argv[1]))
for told in [told] if "figure" in told else [told["figure11"], told["figure12"]]:
    assert told["nodes"] == [1, 2, 4, 8, 16, 32]
    assert [row["dataset"] for row in told["rows"]] == ["Head", "Engine"]
    for row in told["rows"]:
        assert row["largest_difference"] <= 0.5 / 255, row["largest_difference"]
        assert set(row["clusters"]) == {"sp2-paper", "sp2", "today"}
        for ways in row["clusters"].values():
            assert ways["slowness"] > 0
            first = ways["original"]["seconds"][0]
            for name in ("original", "crs", "bitmap", "rle"):
                way = ways[name]
                one = first if told["figure"] == 11 else way["seconds"][0]
                for seconds, speedup in zip(way["seconds"], way["speedup"]):
                    assert seconds > 0
                    assert math.isclose(speedup, one / seconds), (name, way)
lines = minidom.parse(sys.argv[2]).getElementsByTagName("polyline")
assert len(lines) == (3 + 1) * 8, len(lines)  # with the legend
END
}
told_of() {
    says "^snowglass: bench $1: Head, original, 1 node: [0-9]+ %, [0-9]+ s, about [0-9]+ (s|min) left$"
}
if long_tier; then
    printed "figure 11 as a table" "nodes: 32 take, efficiency" "$TOOL" bench figure11 \
        --quick --chart chart.svg
    told_of figure11
    told "all" "^snowglass: bench all: speed, 6 of 6$" "$TOOL" bench all --quick --json
    check "figures of all hang together" hang_together "$OUT" chart.svg
    check "has an object of each" python3 - "$OUT" <<'END'
import json, sys

told = json.load(open(sys.argv[1]))
names = "table1 table2 table3 figure11 figure12 speed".split()
assert list(told) == names, list(told)
assert told["table1"]["rows"] and told["figure12"]["figure"] == 12
END
else
    run 0 "figure 12" "$TOOL" bench figure12 --quick --json --chart chart.svg
    told_of figure12
    check "figure 12 hangs together" hang_together "$OUT" chart.svg
    skipped "figure 11 and bench all" "left to the long tier"
fi

for name in figure13 All; do
    refused 2 "a benchmark that there is not: $name" \
        "there is no benchmark '$name'; choose one of: all table1 table2 table3 figure11 figure12 speed ranks$" \
        "$TOOL" bench $name
done
refused 2 "none" "give one thing to measure; choose one of: all table1" \
    "$TOOL" bench
refused 2 "an option that not all have" "bench all: there is no option '--kernel'" \
    "$TOOL" bench all --kernel tent
refused 3 "all of no data" "nowhere" "$TOOL" bench all --data nowhere
run 2 "options of others" "$TOOL" bench figure11 --threads 2
finish
