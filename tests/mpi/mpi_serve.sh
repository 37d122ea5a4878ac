#!/bin/bash
# mpi_serve.sh - the viewer over several processes: see tests/serve/many_ranks.py;
# and a simulation in it: tests/serve/live.py.  They mostly wait, hence together.
. "$(dirname "$0")/../support/mpi.sh"

need_proc
[ -x "$MPI_TOOL" ] && [ -x "$(dirname "$MPI_TOOL")/snowglass-serve-mpi" ] ||
    skip "the viewer of many ranks is not built"
is_open_mpi || skip "only the jobs of Open MPI are looked into"
LIVE=$TESTS/live_simulation
{ [ ! -x "$LIVE" ] || timeout -k 5 600 python3 -B "$HERE/serve/live.py" "$TOOL" \
    "$MPIEXEC" "$LIVE"; } >"$WORK/live.txt" 2>&1 &
timeout -k 5 1140 python3 -B "$HERE/serve/many_ranks.py" "$TOOL" "$MPIEXEC" \
    "$MPI_TOOL" || FAILED=1
wait $! || FAILED=1
cat "$WORK/live.txt"
finish
