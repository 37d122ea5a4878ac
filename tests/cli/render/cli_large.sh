#!/bin/bash
# A volume of more than 2^31 voxels, raw and NRRD, in memory and in slabs of its
# file: the last block of a sparse file of 2.2 GB lies where a box of it lies, no
# voxel is counted twice, and slabs need 300 MB.
. "$(dirname "$0")/../../support/shell.sh"

skip() {
    skipped all "$1"
    exit 77
}
[ "$(free_gigabytes)" -ge 6 ] ||
    skip "less than 6 GB of free memory"
grep -aq __asan_init "$TOOL" && skip "the sanitizer needs more memory"

# slabs NAME COMMAND...: within the limit of memory, whatever else the process
# holds.
cat >peak.py <<'END'
import resource, subprocess, sys
code = subprocess.call(sys.argv[2:])
with open(sys.argv[1], "w") as file:
    file.write(str(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss))
sys.exit(code)
END
slabs() {
    local name=$1
    shift
    run 0 "$name" python3 peak.py kilobytes "$@" --memory 300M
    check "$name: within the limit, $(cat kilobytes) KB of the process" \
        test "$(cat kilobytes)" -lt $((300 * 1024))
}

n=1300 from=1200 side=60
truncate -s $((n * n * n)) big.raw || skip "no sparse files"
python3 - <<EOF
with open("big.raw", "r+b") as file:
    for z in range($from, $from + $side):
        for y in range($from, $from + $side):
            file.seek((z * $n + y) * $n + $from)
            file.write(bytes(range(100, 100 + $side)))
EOF
[ "$(du -m big.raw | cut -f1)" -lt 100 ] || skip "no sparse files"
printf 'NRRD0004\ntype: uint8\ndimension: 3\nsizes: %d %d %d\n' $n $n $n >big.nhdr
printf 'space directions: (1,0,0) (0,1,0) (0,0,1)\nspace origin: (0,0,0)\n' >>big.nhdr
printf 'space dimension: 3\nencoding: raw\ndata file: big.raw\n' >>big.nhdr

# The same camera of both, whatever they hold: pixels are as wide as the
# volume's radius over the zoom, and 1300 / 5.2 = 150 / 0.6.
seen=(-s 96x96 --position 1500,1650,1800 --target 1230,1230,1230
    --range 0,255 --preset linear --threshold 10 --no-labels)
box=--crop=1150:1300,1150:1300,1150:1300
raw=(--dims ${n}x${n}x${n} --type uint8)

run 0 "the whole, raw" "$TOOL" render -q big.raw "${raw[@]}" "${seen[@]}" \
    --zoom 5.2 -o whole.png --stats whole.json
slabs "in slabs" "$TOOL" render -q big.nhdr "${seen[@]}" --zoom 5.2 \
    -o slabs.png --stats slabs.json
check "they make the same bits" cmp whole.png slabs.png
# Where addresses are limited it stays in its file by itself.
run 0 "footprints in slabs" bash -c "ulimit -v 1000000 && exec '$TOOL' render \
    big.nhdr ${seen[*]} --zoom 5.2 --method footprint -v -o exact.png --stats exact.json"
says 'big.nhdr: stays in its file'

run 0 "a box of it" "$TOOL" render -q big.raw "${raw[@]}" "${seen[@]}" "$box" \
    --zoom 0.6 -o box.png
run 0 "a box of it, exact" "$TOOL" render -q big.nhdr "${seen[@]}" "$box" \
    --zoom 0.6 --method footprint -o exact_box.png
run 0 "the exact pictures are the same" "$TOOL" compare exact.png \
    exact_box.png --tolerance 1/255
# The intermediate image lies elsewhere under the block.
run 0 "the fast ones look the same" "$TOOL" compare whole.png box.png \
    --tolerance 20/255
check "every voxel is counted once" python3 - <<EOF
import json
for name in ("whole.json", "slabs.json", "exact.json"):
    told = json.load(open(name))
    voxels, kept = $n**3, $side**3
    assert abs(told["sparse_ratio"] - (1 - kept / voxels)) < 1e-12, told
EOF
check "there is something to be seen" test "$(wc -c <exact_box.png)" -gt 300
finish
