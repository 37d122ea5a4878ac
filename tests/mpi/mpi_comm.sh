#!/bin/bash
# mpi_comm.sh - messages and collective calls over MPI, with messages as they
# are, and with a thousand bytes as the limit for large ones; who is named when
# one rank is stopped and another is silent.
. "$(dirname "$0")/../support/mpi.sh"

for ranks in $COUNTS; do
    run 0 "messages between $ranks ranks" launch "$ranks" "$TESTS/mpi_comm"
    run 0 "large messages between $ranks ranks" \
        launch "$ranks" "$TESTS/mpi_comm_chunks"
done

[ -r /proc/self/environ ] || {
    skipped "a silent rank" "there is no /proc"
    finish
}
NAME="a silent rank beside one that is stopped"
launch 3 "$TESTS/mpi_comm" stopped >"$OUT" 2>"$ERR" </dev/null
check "$NAME: the job fails" [ $? -ne 0 ]
says '^mpi_comm: rank 2 \(process .*rank 0 has waited 4 s.* it is stopped'
finish
