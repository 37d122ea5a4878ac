# mpi_bench.sh - benchmarks whose ranks are those of MPI: combine and frame.
. "$(dirname "$0")/../support/mpi.sh"
bench() { launch 3 "$MPI_TOOL" bench "$@"; }
head="phantom:head --dims 40x36x44 --size 96 --runs 1 --azimuth 30"

run 0 "combine" bench combine --size 64 --runs 1 --check
check "the line is printed once" [ "$(wc -l <"$OUT")" -eq 1 ]
prints "^ranks=3 nodes=1 rank_per_node=3 .* check=ok "
run 2 "combine with a wrong option" bench combine --foo
check "it is told once" [ "$(grep -c "there is no option '--foo'" "$ERR")" = 1 ]

# shellcheck disable=SC2086
run 0 "frame" bench frame $head --json
check "the line is printed once" [ "$(wc -l <"$OUT")" -eq 1 ]
prints '"ranks": 3, "nodes": 1, .*"check": "ok"'
# shellcheck disable=SC2086
"$TOOL" bench frame $head --json --ranks 3 >threads.json
for key in bytes_sent_max bytes_sent_sum msgs_max voxels_max voxels_sum \
    slices_min; do
    check "$key is as between threads" [ "$(number $key)" = \
        "$(sed -n 's/.*"'$key'": \([0-9]*\).*/\1/p' threads.json)" ]
done
# shellcheck disable=SC2086
run 0 "frame by one rank of MPI" launch 1 "$MPI_TOOL" bench frame $head
prints "^ranks=1 .* check=ok "
# Single pictures are sent while they are drawn, overlapping ones are not.
for way in auto tree swap direct; do
    # shellcheck disable=SC2086
    run 0 "frames of a turning volume, $way" bench frame $head --turn 4 \
        --combine $way
    prints " turn_check=ok$"
done
# shellcheck disable=SC2086
run 2 "frame with a number of ranks" bench frame $head --ranks 4
says "mpirun tells how many ranks"
# shellcheck disable=SC2086
run 2 "frame on a simulated network" bench frame $head --network 1,1,1
says "is not simulated"
run 3 "frame of a file that is missing" bench frame missing.nrrd
check "it is told once" [ "$(grep -c '^snowglass: bench frame: ' "$ERR")" = 1 ]
says "missing.nrrd"

# What is measured on one rank still is.
run 0 "balance" bench balance
check "its table is printed once" [ "$(grep -c '^Head *10 ' "$OUT")" -gt 0 ]
finish
