#!/bin/bash
# mpi_fail.sh - what fails on one rank fails on all: one message that names the
# rank, an exit code, no picture, and nobody waits.
. "$(dirname "$0")/../support/mpi.sh"
LIMIT=60

# job OPTION...: one rank in the folder a, and two more in b, whose files have
# the same names.
job() {
    (cd a && timeout -k 5 "$LIMIT" "$MPIEXEC" -n 1 "$MPI_TOOL" "$@" : \
        -n 2 bash -c "cd ../b && exec \"\$0\" \"\$@\"" "$MPI_TOOL" "$@")
}

# fails CODE NAME PATTERN COMMAND...: says so once, whatever the launcher adds.
fails() {
    local code=$1 name=$2 pattern=$3
    shift 3
    run "$code" "$name" "$@"
    says "$pattern"
    check "$name: one message" [ "$(grep -c '^snowglass: ' "$ERR")" -eq 1 ]
    check "$name: no picture" [ -z "$(find . -name '*.png*' -o -name '.*snow-*')" ]
}

mkdir a b
run 0 "a volume" "$TOOL" phantom head --dims 40x40x30 -q -o a/v.nrrd
fails 3 "a file that is missing on one machine" \
    '^snowglass: rank 1: v.nrrd: cannot be opened' job v.nrrd -o out.png -q
head -c 30000 a/v.nrrd >b/v.nrrd
fails 3 "a file that is cut on one machine" '^snowglass: rank [12]: v.nrrd: ' \
    job v.nrrd -o out.png -q
fails 3 "a movie of it" '^snowglass: rank [12]: v.nrrd: ' \
    job turntable v.nrrd --frames 3 -o out_%d.png -q
run 0 "another volume" "$TOOL" phantom head --dims 40x40x31 -q -y -o b/v.nrrd
fails 3 "machines with different files" '^snowglass: .*v.nrrd' \
    job v.nrrd -o out.png -q

fails 3 "a file that is missing" '^snowglass: .*none.nrrd: ' \
    launch 3 "$MPI_TOOL" none.nrrd -o out.png
fails 2 "a wrong option" '^snowglass: --cut: ' \
    launch 3 "$MPI_TOOL" a/v.nrrd -o out.png --cut wide
fails 2 "standard input" '^snowglass: -: ' \
    launch 2 "$MPI_TOOL" - -o out.png
fails 4 "a folder that is missing" '^snowglass: none/out.png: ' \
    launch 2 "$MPI_TOOL" a/v.nrrd -o none/out.png -q

# A sparse file of zeros: much memory, little time.
truncate -s 300000000 zeros.raw
zeros="zeros.raw --dims 1000x1000x300 --type uint8 -o out.png -q"
little() {
    # shellcheck disable=SC2086
    timeout -k 5 "$LIMIT" "$MPIEXEC" -n 1 "$MPI_TOOL" $zeros : -n 1 \
        bash -c "ulimit -v 500000 && exec \"\$0\" $zeros" "$MPI_TOOL"
}
if [ -z "${ASAN_OPTIONS:-}" ] && is_open_mpi; then # whose own needs are known
    fails 5 "little memory on one machine" '^snowglass: rank 1: .*out of memory' \
        little
fi
finish
