# tests/support/mpi.sh - launching several processes; sourced by mpi_*.sh, which are
# run as `script TOOL MPIEXEC TOOL_UNDER_MPI TESTS`.
#
# Test machines have fewer processors than ranks, and run as root in containers:
# Open MPI must be told that both are meant.
. "$(dirname "${BASH_SOURCE[0]}")/shell.sh"
MPIEXEC=$2 MPI_TOOL=$3 TESTS=$4
export OMP_NUM_THREADS=1
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
export OMPI_MCA_rmaps_base_oversubscribe=1
export OMPI_MCA_hwloc_base_binding_policy=none
# Where two have one folder, mpirun fails now and then as the other one makes it.
export OMPI_MCA_orte_tmpdir_base=$WORK

skip() {
    echo "skip   $*"
    exit 77
}

[ -x "$(command -v "$MPIEXEC")" ] || skip "there is no $MPIEXEC"

is_open_mpi() {
    "$MPIEXEC" --version 2>&1 | grep -qi 'open.mpi\|openrte'
}

# launch N COMMAND...: with a limit, so that a hang is a failure.
launch() {
    local ranks=$1
    shift
    timeout -k 5 "${LIMIT:-360}" "$MPIEXEC" -n "$ranks" "$@"
}

# Processes of a job are found in /proc, and its messages name them by it.
need_proc() {
    [ -r /proc/self/environ ] || skip "there is no /proc"
}

# process_of_rank N: of the tool, in a job that this test has started; nothing
# where there is none yet.
process_of_rank() {
    local process name
    for process in /proc/[0-9]*; do
        read -r name 2>/dev/null <"$process/comm" &&
            [ "$name" = snowglass-mpi ] &&
            tr '\0' '\n' 2>/dev/null <"$process/environ" |
            grep -qx "PWD=$WORK" &&
            tr '\0' '\n' 2>/dev/null <"$process/environ" |
            grep -Eqx "(OMPI_COMM_WORLD_RANK|PMI_RANK)=$1" &&
            echo "${process#/proc/}" && return
    done
}

# How many ranks are tried: MPICH waits busily, and many ranks on few
# processors take long.
if is_open_mpi; then
    COUNTS="1 2 3 5" MOST=5
else
    COUNTS="1 2 4" MOST=4
fi

# as_one NAME RANKS TOLERANCE OPTION...: a picture by so many ranks is that of one
# process; with tolerance "bits" its file is.  $WAY holds what only ranks know.
as_one() {
    local name=$1 ranks=$2 tolerance=$3
    shift 3
    run 0 "$name alone" "$TOOL" "$@" -q -y -o one.npy
    run 0 "$name by $ranks" launch "$ranks" "$MPI_TOOL" "$@" -q -y \
        -o many.npy ${WAY-}
    if [ "$tolerance" = bits ]; then
        check "$name by $ranks has the same bits" cmp -s one.npy many.npy
    else
        run 0 "$name by $ranks is as by one" "$TOOL" compare one.npy many.npy \
            --tolerance "$tolerance"
    fi
}

# frames_as_one NAME RANKS VERB OPTION...: the same for a turntable or a movie.
# Frames lie on a background, since a transparent pixel is rounded twice: its
# colour, and its alpha; they differ by a step of 8 bits, and by the rounding of
# floats.
frames_as_one() {
    local name=$1 ranks=$2 frame
    shift 2
    rm -f one_*.png many_*.png
    run 0 "$name alone" "$TOOL" "$@" -s 64x64 -q -y --background black \
        -o one_%d.png
    run 0 "$name by $ranks" launch "$ranks" "$MPI_TOOL" "$@" -s 64x64 -q -y \
        --background black -o many_%d.png ${WAY-}
    check "$name has frames" [ -e one_1.png ]
    for frame in one_*.png; do
        run 0 "$name, $frame" "$TOOL" compare "$frame" "many_${frame#one_}" \
            --tolerance 1.001/255
    done
}
