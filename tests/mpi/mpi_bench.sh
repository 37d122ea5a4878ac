#!/bin/bash
# mpi_bench.sh - bench ranks over MPI: the pictures and the counts of threads,
# and pixels that ranks of one node read in place.
. "$(dirname "$0")/../support/mpi.sh"
head="phantom:head --dims 40x36x44 --size 96 --runs 2 --azimuth 30"
bench() { launch 3 "$MPI_TOOL" bench "$@"; }

# shellcheck disable=SC2086
run 0 "three ranks" bench ranks $head --json
prints '"bench": "ranks"'
prints '"ranks_are": "mpi"'
check "one object is printed" [ "$(grep -c '"bench"' "$OUT")" = 1 ]
sent=$(number bytes_sent)
check "ranks of one node read pixels in place" [ "$(number bytes_in_place)" -gt 0 ]
# shellcheck disable=SC2086
run 0 "three threads" "$TOOL" bench ranks $head --json --ranks 3
check "as many bytes are sent" [ "$(number bytes_sent)" = "$sent" ]
# shellcheck disable=SC2086
run 0 "one rank" launch 1 "$MPI_TOOL" bench ranks $head
prints '^    1 .* 1\.00 +[0-9]+ %$'
# shellcheck disable=SC2086
run 2 "a number of ranks" bench ranks $head --ranks 4
says "mpirun sets the number of ranks"
# shellcheck disable=SC2086
run 2 "a simulated network" bench ranks $head --network 1,1,1
says "is not simulated"
run 2 "a wrong option" bench ranks --foo
check "it is told once" [ "$(grep -c "there is no option '--foo'" "$ERR")" = 1 ]
run 3 "a file that is missing" bench ranks missing.nrrd
check "it is told once" [ "$(grep -c '^snowglass: bench ranks: ' "$ERR")" = 1 ]

# What is measured on one rank still is.
run 0 "table 1" bench table1
check "its table is printed once" [ "$(grep -c '^Head' "$OUT")" -eq 1 ]
finish
