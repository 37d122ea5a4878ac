#!/bin/bash
# mpi_comm.sh - messages and collective calls over MPI, with messages as they
# are, and with a thousand bytes as the limit for large ones.
. "$(dirname "$0")/support_mpi.sh"

for ranks in $COUNTS; do
    run 0 "messages between $ranks ranks" launch "$ranks" "$TESTS/mpi_comm"
    run 0 "large messages between $ranks ranks" \
        launch "$ranks" "$TESTS/mpi_comm_chunks"
done
finish
