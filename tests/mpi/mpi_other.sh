#!/bin/bash
# mpi_other.sh - the mpirun of another MPI than the tool's: as many programs
# that believe to be alone are refused, and none writes.
. "$(dirname "$0")/../support/mpi.sh"

other=
for name in mpirun.openmpi mpirun.mpich; do
    path=$(command -v $name) || continue
    [ "$("$path" --version 2>&1 | head -1)" = \
        "$("$MPIEXEC" --version 2>&1 | head -1)" ] || other=$path
done
[ -n "$other" ] || skip "there is one MPI only"
run 2 "ranks of another MPI" timeout 180 "$other" -n 3 "$MPI_TOOL" phantom:head \
    --dims 32x32x32 -o out.png
says '^snowglass: 3 processes were started by'
check "one of them says so" [ "$(grep -c '^snowglass: ' "$ERR")" -eq 1 ]
check "none writes" absent out.png
finish
