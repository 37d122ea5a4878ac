#!/bin/bash
# mpi_combine.sh - bench combine over ranks of MPI: the same checks and the same
# counts as between threads, of bytes that ranks read in place too.
. "$(dirname "$0")/../support/mpi.sh"

for ranks in $COUNTS; do
    run 0 "$ranks threads" "$TOOL" bench combine --ranks "$ranks" --size 96 \
        --runs 1 --check
    counts=$(grep -o 'bytes_sent_max.* msgs_max=[0-9]*' "$OUT")
    run 0 "$ranks ranks" launch "$ranks" "$MPI_TOOL" bench combine --size 96 \
        --runs 1 --check
    prints "^ranks=$ranks .* check=ok .*$counts"
done
lent=$(grep -o 'bytes_lent_sum=[0-9]*' "$OUT")
check "ranks of one node read pixels in place" [ "${lent#*=}" -gt 0 ]
run 0 "a local image" "$TOOL" render phantom:engine --dims 24x24x24 \
    --size 40x30 --threshold 10 -o local.png
run 0 "$MOST ranks with pictures" launch "$MOST" "$MPI_TOOL" bench combine \
    --runs 1 --check --pattern local.png
prints "^ranks=$MOST .* image=40x30 pattern=local.png .* check=ok "
run 3 "a rank without its picture" launch 2 "$MPI_TOOL" bench combine \
    --pattern local_%d.png
says "rank 0: local_0.png: cannot be opened"
finish
