#!/bin/bash
# bench frame: pictures of many ranks are those of one, the counters do not
# depend on chance, and what cannot be done is refused.
. "$(dirname "$0")/../../support/shell.sh"

# Python is a tool of the tests, not of Snowglass.
command -v python3 >/dev/null || {
    skipped all "there is no python3"
    exit 77
}

frame() {
    "$TOOL" bench frame phantom:head --dims 40x36x44 --size 96x80 --runs 1 "$@"
}

for ranks in 1 3 5; do
    run 0 "a picture by $ranks ranks" frame --ranks $ranks --azimuth 30
    prints "^ranks=$ranks nodes=1 rank_per_node=$ranks threads=1 .* k=[0-9x]+ image=96x80 pixel_bytes=[0-9]+ gather_bytes=[0-9]+ check=ok max_abs_diff="
    check "it is one line" [ "$(wc -l <"$OUT")" -eq 1 ]
    run 0 "as JSON" frame --ranks $ranks --azimuth 30 --json
    cp "$OUT" "r$ranks.json"
done
run 0 "once more" frame --ranks 5 --azimuth 30 --json
cp "$OUT" again.json
run 0 "equal slabs" frame --ranks 3 --azimuth 30 --json --cut equal
cp "$OUT" equal.json
run 0 "on a simulated network" frame --ranks 3 --azimuth 30 --json \
    --network 2e-6,1e10,1e-6
cp "$OUT" simulated.json

check "all figures are there and hang together" python3 - <<'END'
import json, math

def read(name):
    return json.load(open(name + ".json"))

stages = """read encode splat exchange warp gather total first read_cpu
    encode_cpu splat_cpu exchange_cpu warp_cpu gather_cpu total_cpu
    first_cpu work_cpu""".split()
counters = """bytes_sent_max bytes_sent_sum msgs_max active_px_max voxels_max voxels_sum
    slices_min""".split()
told = {name: read(name) for name in ("r1", "r3", "r5", "again", "equal",
                                      "simulated")}
for name, t in told.items():
    ranks = t["ranks"]
    assert t["check"] == "ok" and 0 <= t["max_abs_diff"] <= 1 / 255 + 1e-6, t
    for stage in stages:
        assert 0 <= t[stage + "_mean_ms"] <= t[stage + "_ms"] * 1.0001 + 1e-6, \
            (name, stage, t)
    assert math.isclose(t["voxels_mean"], t["voxels_sum"] / ranks,
                        rel_tol=1e-4), t
    assert math.isclose(t["imbalance"], t["voxels_max"] / t["voxels_mean"],
                        rel_tol=1e-4), t
    # Slabs share every voxel out; bricks have some twice.
    assert t["voxels_whole"] == told["r1"]["voxels_sum"] > 0, name
    assert t["voxels_sum"] == t["voxels_whole"], name
    assert t["t1_ms"] > 0 and t["total_ms"] > 0 and t["first_ms"] > 0, t
    assert t["splat_cpu_ms"] > 0, t
    # What a rank works is some of its processor time, waits being the rest.
    assert 0 < t["work_cpu_mean_ms"] <= t["total_cpu_mean_ms"] + 1e-3, t
    assert 0 < t["work_least_mean_ms"] <= t["work_cpu_mean_ms"] + 1e-3, t
    assert t["work_least_mean_ms"] <= t["work_least_ms"] + 1e-6, t
    if ranks > 1:
        parts = sum(t[key + "_cpu_mean_ms"] for key in
                    ("splat", "exchange", "warp", "gather"))
        assert 0.3 * t["total_cpu_mean_ms"] < parts, (name, parts, t)
        assert parts <= 1.001 * t["total_cpu_mean_ms"], (name, parts, t)
        k = [int(x) for x in str(t["k"]).split("x")]
        assert len(k) == t["rounds"] and math.prod(k) >= ranks, t
        most = max(t["active_px_max"] * t["pixel_bytes"], 1)
        assert t["bound_ms"] > most * (ranks - 1) / ranks * 1e3 * \
            (1 / 12.125e9 if name != "simulated" else 1e-10), t
        took = t["exchange_ms"] + t["gather_ms"]
        assert math.isclose(t["ratio"], took / t["bound_ms"], rel_tol=1e-3), t
    assert t["bytes_sent_sum"] <= ranks * t["bytes_sent_max"], t
assert told["r1"]["bytes_sent_sum"] == 0, told["r1"]
assert told["r1"]["imbalance"] == 1
assert told["r5"]["bytes_sent_max"] > 0 and told["r5"]["msgs_max"] > 0
for key in counters:
    assert told["r5"][key] == told["again"][key], key
    assert told["r3"][key] == told["simulated"][key], key
assert told["equal"]["slices_min"] == 36 / 3, told["equal"]
assert told["equal"]["imbalance"] > told["r3"]["imbalance"], told["equal"]
simulated = told["simulated"]
assert simulated["nodes"] == 3 and simulated["rank_per_node"] == 1 and simulated["simulated"] == 1, simulated
assert simulated["projected_ms"] == simulated["total_ms"], simulated
assert math.isclose(simulated["efficiency"], simulated["t1_ms"] / 3 /
                    simulated["projected_ms"], rel_tol=1e-4), simulated
assert "projected_ms" not in told["r3"]
END

# A rank that waits for nobody sends before it has drawn all.
run 0 "a larger picture" "$TOOL" bench frame phantom:head --dims 96x96x96 \
    --size 160 --ranks 3 --json --runs 1 --network 0,1e10,0
check "it is sent while it is drawn" python3 -c '
import json, sys
t = json.load(open(sys.argv[1]))
assert 0 < t["bytes_early_sum"] < t["bytes_sent_sum"], t' "$OUT"

# Pictures of a turning volume are the same with and without overlap.
run 0 "a turning volume" frame --ranks 3 --turn 4 --json --network 0.05,1e9,0
check "overlap hides splatting" python3 -c '
import json, sys
t = json.load(open(sys.argv[1]))
assert t["turn_check"] == "ok" and t["hidden_ms"] > 0, t
assert t["turn_ms"] > 50 and t["turn_overlap_ms"] > 50, t' "$OUT"
run 0 "no turning volume" frame --ranks 2 --no-check
check "nothing is told of one" [ -z "$(grep turn_ "$OUT")" ]

# A slow network takes its time, simulated or not waited for.
run 0 "a slow network" frame --ranks 3 --json --network 0.5,1e10,0
check "messages of half a second are told" python3 -c '
import json, sys
t = json.load(open(sys.argv[1]))
assert t["total_ms"] > 1000 and t["efficiency"] < 0.1, t' "$OUT"

for way in "--cut bricks" "--cut counted --combine tree" "--combine swap" \
    "--combine direct" "--combine radix --radix 3" "--elevation 80 --threshold 20"; do
    # shellcheck disable=SC2086
    run 0 "$way" frame --ranks 5 --azimuth 40 $way
    prints " check=ok "
done
run 0 "no check" frame --ranks 2 --no-check
prints " check=none bytes_sent_max="
check "no picture of one rank is timed" [ -z "$(grep t1_ms "$OUT")" ]
raw_cube v.raw 16
run 0 "a raw file" "$TOOL" bench frame v.raw --dims 16x16x16 --type uint8 \
    --size 64 --runs 1 --ranks 3
prints " image=64x64 .* check=ok "
run 0 "help" "$TOOL" bench frame --help
prints "^usage: snowglass bench frame INPUT"

refused 3 "no such file" "missing.nrrd" "$TOOL" bench frame missing.nrrd
refused 2 "a file without its size" "--dims XxYxZ" "$TOOL" bench frame v.raw
echo "no picture" >text.nrrd
refused 3 "a damaged file" "text.nrrd" "$TOOL" bench frame text.nrrd
while IFS='|' read -r arguments pattern; do
    [ -n "$arguments" ] || continue
    eval "set -- $arguments"
    refused 2 "bench frame $arguments" "$pattern" "$TOOL" bench frame "$@"
done <<'END'
--json|there is no INPUT
a b|one word too many: 'b'
a --foo|there is no option '--foo'
a --rank 3|there is no option '--rank'
a --ranks|a value is missing after '--ranks'
a --ranks 0|this value is not possible: '0'
a --ranks 2.5|this value is not possible: '2.5'
a --turn 1|this value is not possible: '1'
a --dims 4x4|this value is not possible: '4x4'
a --dims 4x4x4x4|this value is not possible: '4x4x4x4'
a --type byte7|this value is not possible: 'byte7'
a --size 0x4|this value is not possible: '0x4'
a --size 4x4x4|this value is not possible: '4x4x4'
a --cut thin|this value is not possible: 'thin'
a --network 1,2|this value is not possible: '1,2'
a --network 1,0,0|this value is not possible: '1,0,0'
a --alpha -1|this value is not possible: '-1'
a --beta x|this value is not possible: 'x'
a --radix 4|only --combine radix has a radix
a --check --no-check|leave out --check or '--no-check'
END
# What ranks work goes into bench combine, a line for each.
run 0 "a profile" frame --ranks 3 --network 2e-6,1e10,1e-6 --profile work.txt
check "of three ranks" [ "$(grep -cE '^([0-9.]+ ){2}[0-9.]+$' work.txt)" = 3 ]
run 0 "with a profile" "$TOOL" bench combine --ranks 3 --size 64 --runs 1 \
    --profile work.txt --check
prints ' check=ok '
run 3 "with too short a profile" "$TOOL" bench combine --ranks 4 --size 64 \
    --profile work.txt
says "rank 3: work.txt: has no line of three numbers for rank 3"
run 1 "a profile in no folder" frame --ranks 2 --profile absent/work.txt
says "rank 0: absent/work.txt: cannot be written"
finish
