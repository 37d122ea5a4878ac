#!/bin/bash
# scripts/paper: each table of the paper's page gets the numbers that the bench
# prints, and figures 9, 11 and 12 are made.  Quick runs on phantoms.
. "$(dirname "$0")/../../support/shell.sh"

need_python
run 0 "the whole paper" python3 -B "$HERE/../scripts/paper" "$TOOL" nowhere out --quick
for name in engine head cube; do
    prints "^figure 9, $name: largest .* dB"
done
check "charts are XML" python3 -c '
from xml.dom import minidom
for n in (11, 12):
    assert minidom.parse(f"out/figure{n}.svg").getElementsByTagName("polyline")'
check "tables have what was printed" python3 - <<'END'
import json, re

page = open("out/docs/paper.md").read()
def rows(name):
    table = page.split(f"<!-- table: {name} -->")[1].split("|\n\n")[0]
    return [[cell.strip() for cell in line.strip("| \n").split("|")]
            for line in table.strip().splitlines()[2:]]
told = json.load(open("out/table1.json"))["rows"]
for row, one in zip(rows("table1"), told, strict=True):
    assert row[0] == one["dataset"]
    for cell, ours, theirs in zip(row[1:], one["percent"], one["paper_percent"]):
        assert cell == f"{ours:.1f} % ({theirs:.0f})", cell
told = json.load(open("out/table3.json"))["rows"]
for row, one in zip(rows("table3"), told, strict=True):
    assert row[1] == "{0}x{0}".format(one["footprint"])
    assert row[3].split()[0] == f"{one['crs']['gain_percent']:.0f}", row
for name in ("figure11", "figure12"):
    told = json.load(open(f"out/{name}.json"))["rows"]
    assert len(rows(name)) == 8
    for row, (one, way) in zip(rows(name), [(one, way) for one in told for way in
                               ("original", "crs", "bitmap", "rle")], strict=True):
        assert row[0].startswith(one["dataset"] + ", ")
        speedup = one["clusters"]["sp2-paper"][way]["speedup"]
        assert row[1:] == [f"{value:.1f}" for value in speedup], row
END
finish
