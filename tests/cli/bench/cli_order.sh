#!/bin/bash
# bench order: parts that are cut by planes are put in order at once, and any
# others in little more than the time of a sort, never that of all pairs.
. "$(dirname "$0")/../../support/shell.sh"

command -v python3 >/dev/null || {
    skipped all "there is no python3"
    exit 77
}

run 0 "a table" "$TOOL" bench order --runs 5
prints "^slabs +128 +[0-9.]+$"
run 0 "as JSON" "$TOOL" bench order --runs 5 --json
cp "$OUT" all.json
check "times grow about as the parts do" python3 - all.json <<'END'
import json, sys

told = json.load(open(sys.argv[1]))
assert told["bench"] == "order"
assert len(told["rows"]) == 16
took = {(row["cut"], row["parts"]): row["cpu_ms"] for row in told["rows"]}
for cut in ("slabs", "grid", "bricks"):
    # 10 and 0.3 on an idle machine; all pairs take 144 for 4,096
    assert took[cut, 100000] < 30, took
    assert took[cut, 4096] < 1, took
assert took["irregular", 90000] < 1000, took
END
run 2 "an option of others" "$TOOL" bench order --kernel tent
finish
