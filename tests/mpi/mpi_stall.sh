#!/bin/bash
# mpi_stall.sh - one rank of four is stopped: the job ends when its timeout is
# over, with one message that names the rank, and leaves nothing unfinished. A
# rank that goes on in time is waited for.  One that is killed, or told to end,
# ends the job at once.  Most of that is waiting, so that four jobs run at a time.
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

# Longer than any signal takes to come; each frame is prepared before the first.
movie="turntable phantom:head --dims 40x40x40 -s 64x64 --frames 5000 -q -y"
a_rank_of_a_movie() { # 0 writes
    NAME="rank $RANK of a movie"
    # shellcheck disable=SC2086
    stalled '[ -e f_000003.png ]' "$MPI_TOOL" $movie -o f_%06d.png
}

# line_comes SECONDS: waits for the line that says how long the others wait. It comes
# after half of the timeout, later where the machine itself stands still.
line_comes() {
    local tries=0
    while [ $tries -lt $(($1 * 10)) ]; do
        grep -q "waits for rank $RANK .*ends after 24 s (--timeout)" "$ERR" &&
            return
        sleep 0.1
        tries=$((tries + 1))
    done
    return 1
}

# In time, and with all the time there is.
goes_on() {
    local timeout=$1
    NAME="rank $RANK goes on, timeout $timeout"
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
}

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

# Whether the rank has computed for so long, in hundredths of a second, which MPI's
# own beginning does not.
computes() {
    local process
    process=$(process_of_rank "$RANK")
    [ -n "$process" ] &&
        [ "$(awk '{ print $14 + $15 }' "/proc/$process/stat")" -ge "$1" ]
}

ended_at_once() {
    local frame signal
    for signal in KILL TERM; do
        RANK=2 ended $signal 'computes 70' "$MPI_TOOL" phantom:head \
            --dims 600x600x600 -o out.png -q
    done
    # shellcheck disable=SC2086
    RANK=0 ended TERM '[ -e g_000003.png ]' "$MPI_TOOL" $movie -o g_%06d.png
    # shellcheck disable=SC2086
    RANK=2 ended KILL '[ -e f_000003.png ]' "$MPI_TOOL" $movie -o f_%06d.png
    for frame in f_*.png g_*.png; do
        "$TOOL" compare "$frame" "$frame" >/dev/null 2>&1 ||
            fail "$frame is whole"
    done
}

# aside NAME COMMAND...: in a folder of its own, beside what follows.
asides=()
aside() {
    local name=$1
    shift
    mkdir "$name"
    (
        WORK=$WORK/$name
        OUT=$WORK/.stdout ERR=$WORK/.stderr
        cd "$WORK" || exit 1
        "$@"
        exit "$FAILED"
    ) >"$name/said" 2>&1 &
    asides+=("$! $name")
}
RANK=2 aside stopped a_rank_of_a_movie
RANK=0 aside stopped-0 a_rank_of_a_movie
# Rank 0 waits for rank 2 itself, and for rank 3 by way of others.
RANK=3 aside timeout goes_on 24
RANK=2 aside no-timeout goes_on 0
for each in "${asides[@]}"; do
    wait "${each% *}"
    FAILED=$((FAILED + $?))
    cat "${each#* }/said"
done
ended_at_once

run 2 "a timeout below 0" launch 2 "$MPI_TOOL" phantom:head --timeout -1 \
    -o out.png
says '^snowglass: --timeout'
finish
