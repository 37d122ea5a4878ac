#!/bin/bash
# mpi_combine.sh - bench combine over ranks of MPI: the same checks and the same
# counts as between threads.
. "$(dirname "$0")/support_mpi.sh"

for ranks in $COUNTS; do
    run 0 "$ranks threads" "$TOOL" bench combine --ranks "$ranks" --size 96 \
        --runs 1 --check
    counts=$(grep -o 'bytes_sent_max.* msgs_max=[0-9]*' "$OUT")
    run 0 "$ranks ranks" launch "$ranks" "$MPI_TOOL" bench combine --size 96 \
        --runs 1 --check
    prints "^ranks=$ranks .* check=ok .*$counts"
done
finish
