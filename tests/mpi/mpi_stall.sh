#!/bin/bash
# mpi_stall.sh - one rank of four is stopped: the job ends when its timeout is
# over, with one message that names the rank, and leaves nothing unfinished. A
# rank that goes on in time is waited for.  One that is killed, or told to end,
# ends the job at once.
. "$(dirname "$0")/../support/mpi.sh"
need_proc
LIMIT=540

# begin SIGNAL WHEN COMMAND...: starts four ranks, and sends rank $RANK a signal
# once WHEN is true.
begin() {
    local signal=$1 when=$2 tries=0
    shift 2
    victim=
    launch 4 "$@" >"$OUT" 2>"$ERR" </dev/null &
    job=$!
    while [ -z "$victim" ] && [ $tries -lt 900 ]; do
        sleep 0.1
        tries=$((tries + 1))
        eval "$when" && victim=$(process_of_rank "$RANK")
    done
    check "$NAME: there is a rank $RANK" [ -n "$victim" ]
    [ -n "$victim" ] && kill "-$signal" "$victim"
}

# stalled WHEN COMMAND...
stalled() {
    local started
    begin STOP "$@" --timeout 9
    started=$(date +%s)
    wait "$job"
    check "$NAME: the job fails" [ $? -ne 0 ]
    check "$NAME: within a minute" [ $(($(date +%s) - started)) -le 60 ]
    # A launcher that ends the job lets go of the stopped rank first, which
    # then says that it was interrupted.
    check "$NAME: one message" [ "$(grep '^snowglass: ' "$ERR" |
        grep -vc interrupted)" -eq 1 ]
    says "^snowglass: .*rank $RANK \\(process $victim on .* it is stopped"
    kill -CONT "$victim" 2>/dev/null
    # The writer itself may be killed between beginning a hidden file and its
    # new name; frames are whole all the same.
    check "$NAME: nothing half written" \
        [ "$(find . -name '*snow-*' | wc -l)" -le $((RANK == 0)) ]
    "$TOOL" compare f_000003.png f_000003.png >"$OUT" 2>&1 ||
        fail "$NAME: a frame is whole"
}

movie="turntable phantom:head --dims 40x40x40 -s 64x64 --frames 100000 -q -y"
for RANK in 2 0; do # 0 writes
    NAME="rank $RANK of a movie"
    rm -f f_*
    # shellcheck disable=SC2086
    stalled '[ -e f_000003.png ]' "$MPI_TOOL" $movie -o f_%06d.png
done

# line_comes SECONDS: waits for the line that says how long the others wait. It comes
# after half of the timeout, later where the machine itself stands still.
line_comes() {
    local tries=0
    while [ $tries -lt $(($1 * 10)) ]; do
        grep -q "waits for rank 2 .*ends after 24 s (--timeout)" "$ERR" &&
            return
        sleep 0.1
        tries=$((tries + 1))
    done
    return 1
}

# In time, and with all the time there is.
for timeout in 24 0; do
    NAME="a rank that goes on, timeout $timeout" RANK=2
    rm -f f_*
    begin STOP '[ -e f_000003.png ]' "$MPI_TOOL" turntable phantom:head \
        --dims 40x40x40 -s 64x64 --frames 400 -y -o f_%06d.png \
        --timeout $timeout
    if [ $timeout -eq 0 ]; then
        sleep 5
    else
        check "$NAME: a line says how long they do" line_comes 60
    fi
    check "$NAME: the others wait" [ ! -e f_000399.png ]
    [ -n "$victim" ] && kill -CONT "$victim"
    wait "$job"
    check "$NAME: the job succeeds" [ $? -eq 0 ]
    check "$NAME: its frames are there" [ -e f_000399.png ]
done
# ended SIGNAL WHEN COMMAND...: how long the others go on.
ended() {
    local signal=$1 started code
    NAME="rank $RANK, $signal, $2"
    begin "$@"
    started=$(date +%s)
    wait "$job"
    code=$?
    check "$NAME: the job fails" [ $code -ne 0 ]
    check "$NAME: within 30 s" [ $(($(date +%s) - started)) -le 30 ]
    if [ "$signal" = TERM ]; then
        is_open_mpi && check "$NAME: as when one process is" [ $code -eq 130 ]
    elif is_open_mpi; then
        check "$NAME: mpirun names the rank" grep -q 'rank 2 .*Killed' "$ERR"
    else # MPICH's names the process and the machine
        check "$NAME: mpirun tells of it" \
            grep -q 'BAD TERMINATION' "$OUT" "$ERR"
    fi
    check "$NAME: nothing half written" \
        [ -z "$(find . -name '*snow-*' -o -name out.png)" ]
}
rm -f f_*
for signal in KILL TERM; do
    RANK=2 ended $signal 'sleep 1' "$MPI_TOOL" phantom:head --dims 600x600x600 \
        -o out.png -q
done
# shellcheck disable=SC2086
RANK=0 ended TERM '[ -e g_000003.png ]' "$MPI_TOOL" $movie -o g_%06d.png
# shellcheck disable=SC2086
RANK=2 ended KILL '[ -e f_000003.png ]' "$MPI_TOOL" $movie -o f_%06d.png
for frame in f_*.png g_*.png; do
    "$TOOL" compare "$frame" "$frame" >/dev/null 2>&1 ||
        fail "$frame is whole"
done

run 2 "a timeout below 0" launch 2 "$MPI_TOOL" phantom:head --timeout -1 \
    -o out.png
says '^snowglass: --timeout'
finish
