#!/bin/bash
# bench ranks: pictures of many ranks are those of one, figures hang together and
# counts do not depend on chance, and what cannot be done is refused.
. "$(dirname "$0")/../../support/shell.sh"

# Python is a tool of the tests, not of Snowglass.
need_python

ranks() {
    "$TOOL" bench ranks phantom:head --dims 40x36x44 --size 96 --runs 2 \
        --azimuth 30 "$@"
}

printed "a table" '^phantom:head, 96x96: one rank takes [0-9.]+ ms$' ranks --ranks 1,3
prints '^ranks are threads, on [0-9]+ processors$'
prints '^    1 +[0-9.]+ +[0-9.]+ +0\.00 +0\.00 +[0-9.]+ +0 +1\.00 +[0-9]+ %$'
prints '^    3 +([0-9.]+ +){5}[1-9][0-9]+ +1\.[0-9]+ +[0-9]+ %$'
run 0 "as JSON" ranks --json
cp "$OUT" threads.json
run 0 "on a simulated network" ranks --json --network 2e-6,1e10,1e-6
cp "$OUT" simulated.json
# A slow network takes its time, which is not waited for.
run 0 "a slow network" ranks --ranks=3 --json --network 0.5,1e10,0
cp "$OUT" slow.json
check "figures hang together" python3 - <<'END'
import json
from math import isclose

def read(name):
    return json.load(open(name + ".json"))

threads, simulated, slow = map(read, ("threads", "simulated", "slow"))
assert threads["ranks_are"] == "threads"
assert simulated["ranks_are"] == slow["ranks_are"] == "simulated"
for told in (threads, simulated, slow):
    assert told["bench"] == "ranks" and told["alone_ms"] > 0
    for row in told["rows"]:
        assert 0 <= row["largest_difference"] <= 1 / 255 + 1e-6, row
        assert 0 < row["splat_mean_ms"] <= row["splat_slowest_ms"], row
        assert row["exchange_mean_ms"] <= row["exchange_slowest_ms"], row
        assert isclose(row["imbalance"],
                       row["splat_slowest_ms"] / row["splat_mean_ms"]), row
        assert isclose(row["efficiency"], told["alone_ms"] / row["ranks"] /
                       row["picture_ms"]), row
for told in (threads, simulated):
    assert [row["ranks"] for row in told["rows"]] == [1, 2, 4, 8]
    assert told["rows"][0]["bytes_sent"] == 0
    assert told["rows"][3]["radices"], told["rows"][3]
# One machine a rank: nobody waits for a processor, and the counts are the same.
for one, other in zip(threads["rows"], simulated["rows"]):
    assert one["bytes_sent"] == other["bytes_sent"], (one, other)
    assert other["picture_ms"] >= other["splat_mean_ms"], other
assert slow["rows"][0]["picture_ms"] > 1000, slow
assert slow["rows"][0]["efficiency"] < 0.1, slow
END

run 0 "a cut, and the paper's tree" ranks --ranks 5 --cut bricks --combine tree
raw_cube v.raw 16
run 0 "a raw file" "$TOOL" bench ranks v.raw --dims 16x16x16 --type uint8 \
    --size 64 --runs 1 --ranks 3
printed "help" "^usage: snowglass bench ranks FILE" "$TOOL" bench ranks --help

refused 3 "no such file" "missing.nrrd" "$TOOL" bench ranks missing.nrrd
refused 2 "a file without its size" "--dims XxYxZ" "$TOOL" bench ranks v.raw
refusals 2 "$TOOL" bench ranks <<'END'
--json|there is no FILE
a b|one word too many: 'b'
a --foo|there is no option '--foo'
a --rank 3|there is no option '--rank'
a --ranks|a value is missing after '--ranks'
a --ranks 0|this value is not possible: '0'
a --ranks 2,|this value is not possible: '2,'
a --json=1|this option has no value: '--json=1'
a --dims 4x4|this value is not possible: '4x4'
a --dims 4x4x0|this value is not possible: '4x4x0'
a --type byte7|this value is not possible: 'byte7'
a --cut thin|this value is not possible: 'thin'
a --network 1,2|this value is not possible: '1,2'
a --network 1,0,0|this value is not possible: '1,0,0'
END
finish
