#!/bin/bash
# mpi_fail.sh - what fails on one rank fails on all: one message that names the
# rank, an exit code, no picture, and nobody waits.
. "$(dirname "$0")/../support/mpi.sh"
LIMIT=180

# job OPTION...: one rank in the folder a, and two more in b, whose files have
# the same names.
job() {
    (cd a && timeout -k 5 "$LIMIT" "$MPIEXEC" -n 1 "$MPI_TOOL" "$@" : \
        -n 2 bash -c "cd ../b && exec \"\$0\" \"\$@\"" "$MPI_TOOL" "$@")
}

# fails CODE NAME PATTERN COMMAND...: says so once, whatever the launcher adds.  Four
# at a time, since a launcher sleeps for seconds before it ends what goes on.
begun=()
fails() {
    local at=.job${#begun[@]}
    mkdir -p "$at.mpi"
    OMPI_MCA_orte_tmpdir_base=$PWD/$at.mpi "${@:4}" >"$at.out" 2>"$at.err" </dev/null &
    begun+=("$!|$1|$2|$3")
    [ ${#begun[@]} -lt 4 ] || all_fail
}

all_fail() {
    local n job code pattern
    for n in "${!begun[@]}"; do
        IFS='|' read -r job code NAME pattern <<<"${begun[n]}"
        OUT=.job$n.out ERR=.job$n.err
        wait "$job"
        check "$NAME: exit code $code" [ $? -eq "$code" ]
        says "$pattern"
        check "$NAME: one message" [ "$(grep -c '^snowglass: ' "$ERR")" -eq 1 ]
    done
    check "no picture" [ -z "$(find . -name '*.png*' -o -name '.*snow-*')" ]
    begun=() OUT=$WORK/.stdout ERR=$WORK/.stderr
}

mkdir a b
run 0 "a volume" "$TOOL" phantom head --dims 40x40x30 -q -o a/v.nrrd
fails 3 "a file that is missing on one machine" \
    '^snowglass: rank 1: v.nrrd: cannot be opened' job v.nrrd -o out.png -q
cp a/v.nrrd a/cut.nrrd
head -c 30000 a/v.nrrd >b/cut.nrrd
fails 3 "a file that is cut on one machine" '^snowglass: rank [12]: cut.nrrd: ' \
    job cut.nrrd -o out.png -q
cp a/v.nrrd a/other.nrrd
run 0 "another volume" "$TOOL" phantom head --dims 40x40x31 -q -y -o b/other.nrrd
fails 3 "machines with different files" '^snowglass: .*other.nrrd' \
    job other.nrrd -o out.png -q

# poke FILE FROM_END: another byte there.
poke() {
    local size
    size=$(stat -c %s "$1")
    printf '\252' | dd of="$1" bs=1 seek=$((size - $2)) conv=notrunc 2>/dev/null
}
run 0 "large" "$TOOL" phantom head --dims 256x200x150 -q -o a/large.nrrd
cp a/large.nrrd b/large.nrrd
cp a/large.nrrd a/copy.nrrd
cp a/large.nrrd b/copy.nrrd
"$TOOL" convert a/v.nrrd -q -y -o a/raw.raw
cp a/raw.raw b/raw.raw
printf 'NDims = 3\nDimSize = 40 40 30\nElementType = MET_UCHAR\nElementDataFile = raw.raw\n' |
    tee a/v.mhd >b/v.mhd
poke b/large.nrrd 1
fails 3 "the last voxel is another" '^snowglass: large.nrrd: is not the same' \
    job large.nrrd -o out.png -q
all_fail
touch -d '2020-01-01' b/copy.nrrd b/v.mhd b/raw.raw
run 0 "a copy" job copy.nrrd -o ../out.png
says "was changed at another time on some ranks"
rm -f out.png
poke b/raw.raw 1
fails 3 "voxels beside a header, clipped" \
    '^snowglass: v.mhd: is not the same' job v.mhd -o out.png -q --clip=1,0,0,20
cp a/v.nrrd b/v.nrrd
"$TOOL" convert a/v.nrrd -q -y -o a/mask.nrrd
cp a/mask.nrrd b/mask.nrrd
poke b/mask.nrrd 5000
fails 3 "another mask" '^snowglass: mask.nrrd: is not the same' \
    job v.nrrd --mask mask.nrrd -o out.png -q

fails 2 "another overlay" '^snowglass: .*overlays differ between ranks' \
    job v.nrrd --overlay mask.nrrd -o out.png -q

fails 3 "a file that is missing" '^snowglass: .*none.nrrd: ' \
    launch 3 "$MPI_TOOL" none.nrrd -o out.png
fails 2 "a wrong option" '^snowglass: --cut: ' \
    launch 3 "$MPI_TOOL" a/v.nrrd -o out.png --cut wide
fails 2 "standard input" '^snowglass: -: ' \
    launch 2 "$MPI_TOOL" - -o out.png
fails 4 "a folder that is missing" '^snowglass: none/out.png: ' \
    launch 2 "$MPI_TOOL" a/v.nrrd -o none/out.png -q

# Another command on one rank ends the job before the others wait for it.
differ() {
    timeout -k 5 "$LIMIT" "$MPIEXEC" -n 2 "$MPI_TOOL" render a/v.nrrd -o out.png \
        -q : -n 1 "$MPI_TOOL" "$@"
}
for word in --wrong render\ a/v.nrrd\ --cut\ wide; do
    # shellcheck disable=SC2086
    fails 2 "rank 2 with '$word'" '^snowglass: rank 2: ' differ $word
done
for word in "turntable a/v.nrrd -o x_%d.png" "render --help" "bench ranks"; do
    # The other MPI's benchmarks are not built.
    [ "$word" != "bench ranks" ] || [ -e "$(dirname "$MPI_TOOL")/snowglass-bench-mpi" ] ||
        continue
    # shellcheck disable=SC2086
    fails 2 "rank 2 with '$word'" 'rank 2: .*same command' differ $word
done
for word in "--mode mip" "--size 64x64"; do
    # shellcheck disable=SC2086
    fails 2 "rank 2 with '$word' too" 'rank 2: .*other options' \
        differ a/v.nrrd -o out.png -q $word
done
fails 2 "rank 2 with another file" 'rank 2: .*other options or files' \
    differ b/v.nrrd -o out.png -q
all_fail
run 0 "rank 2 with other threads" differ render a/v.nrrd -o out.png --threads 2
rm out.png
fails 2 "rank 0 with another verb" 'another verb' \
    timeout -k 5 "$LIMIT" "$MPIEXEC" -n 1 "$MPI_TOOL" info a/v.nrrd : \
    -n 2 "$MPI_TOOL" render a/v.nrrd -o out.png -q

# A sparse file of zeros: much memory, little time.
truncate -s 1000000000 zeros.raw
zeros="zeros.raw --dims 1000x1000x1000 --type uint8 -o out.png -q"
little() {
    # shellcheck disable=SC2086
    timeout -k 5 "$LIMIT" "$MPIEXEC" -n 1 "$MPI_TOOL" $zeros : -n 1 \
        bash -c "ulimit -v 500000 && exec \"\$0\" $zeros" "$MPI_TOOL"
}
if [ -z "${ASAN_OPTIONS:-}" ] && is_open_mpi; then # whose own needs are known
    fails 5 "little memory on one machine" '^snowglass: rank 1: .*out of memory' \
        little
fi
all_fail
finish
