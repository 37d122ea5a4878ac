#!/bin/bash
# mpi_kill.sh - one rank of four is killed, or told to end, while it draws and in
# the middle of a movie: the job ends at once, tells which, and leaves nothing
# unfinished.
. "$(dirname "$0")/../support/mpi.sh"
need_proc
LIMIT=180

# ended SIGNAL NAME WHEN COMMAND...: sends rank $RANK a signal once WHEN is true, and
# looks how long the others go on.
RANK=2
ended() {
    local signal=$1 name=$2 when=$3 job victim="" tries=0 begin code
    shift 3
    launch 4 "$@" >"$OUT" 2>"$ERR" </dev/null &
    job=$!
    while [ -z "$victim" ] && [ $tries -lt 900 ]; do
        sleep 0.1
        tries=$((tries + 1))
        eval "$when" || continue
        victim=$(process_of_rank $RANK)
    done
    check "$name: there is a rank $RANK" [ -n "$victim" ]
    [ -n "$victim" ] && kill "-$signal" "$victim"
    begin=$(date +%s)
    wait "$job"
    code=$?
    check "$name: the job fails" [ $code -ne 0 ]
    check "$name: within 30 s" [ $(($(date +%s) - begin)) -le 30 ]
    if [ "$signal" = TERM ]; then
        is_open_mpi && check "$name: as when one process is" [ $code -eq 130 ]
    elif is_open_mpi; then
        check "$name: mpirun names the rank" grep -q 'rank 2 .*Killed' "$ERR"
    else # MPICH's names the process and the machine
        check "$name: mpirun tells of it" \
            grep -q 'BAD TERMINATION' "$OUT" "$ERR"
    fi
    check "$name: nothing half written" \
        [ -z "$(find . -name '*snow-*' -o -name out.png)" ]
}

for signal in KILL TERM; do
    ended $signal "a picture, $signal" 'sleep 1' "$MPI_TOOL" phantom:head \
        --dims 600x600x600 -o out.png -q
done
RANK=0 # which writes
ended TERM "a movie that is to end" '[ -e g_000003.png ]' "$MPI_TOOL" turntable \
    phantom:head --dims 40x40x40 -s 64x64 --frames 100000 -q -o g_%06d.png
RANK=2
ended KILL "a movie" '[ -e f_000003.png ]' "$MPI_TOOL" turntable phantom:head \
    --dims 40x40x40 -s 64x64 --frames 100000 -q -o f_%06d.png
for frame in f_*.png g_*.png; do
    "$TOOL" compare "$frame" "$frame" >/dev/null 2>&1 ||
        fail "$frame is whole"
done
pass "the frames that are there are whole"
finish
