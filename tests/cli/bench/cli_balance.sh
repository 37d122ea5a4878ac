#!/bin/bash
# bench balance: its figures have their keys, and counted cuts are no worse than
# equal ones.
. "$(dirname "$0")/../../support/shell.sh"

# Python is a tool of the tests, not of Snowglass.
command -v python3 >/dev/null || {
    skipped all "there is no python3"
    exit 77
}

run 0 "a table" "$TOOL" bench balance
prints "^Head +10 +[0-9]+ +8 +1[.]"
run 0 "as JSON" "$TOOL" bench balance --json
cp "$OUT" all.json
check "loads are as a cut by count makes them" python3 - all.json <<'END'
import json, sys

told = json.load(open(sys.argv[1]))
assert told["bench"] == "balance"
assert len(told["rows"]) == 16
for row in told["rows"]:
    assert row["interesting_voxels"] > 0, row
    for cut in ("equal", "counted", "bricks"):
        assert 1 <= row[cut] <= row["ranks"], row
    assert row["counted"] <= row["equal"] * 1.0001, row
    if row["ranks"] <= 32:
        assert row["bricks"] < 1.06, row
    assert row["bricks"] < (1.12 if row["ranks"] <= 128 else 1.3), row
END
run 2 "an option of others" "$TOOL" bench balance --kernel tent
finish
