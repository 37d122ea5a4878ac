#!/bin/bash
# mpi_clusters.sh - the commands of docs/clusters.md work as they stand: the lines
# with mpirun, and the batch scripts, whose srun is a stand-in that starts the
# ranks on this machine.
. "$(dirname "$0")/../support/mpi.sh"
PAGE=$HERE/../docs/clusters.md
mkdir bin files
ln -s "$TOOL" bin/snowglass
ln -s "$(realpath "$MPI_TOOL")" bin/snowglass-mpi
printf '#!/bin/sh\nexec timeout -k 5 360 "%s" "$@"\n' "$(command -v "$MPIEXEC")" \
    >bin/mpirun
# As many ranks as the script asks for; options of srun itself are none here.
printf '#!/bin/sh\nexec mpirun -n "$TASKS" "$@"\n' >bin/srun
chmod +x bin/mpirun bin/srun
export PATH=$WORK/bin:$PATH

cd files || exit 1
for name in big run_0000 run_0001 run_0002; do
    "$TOOL" phantom shells --dims 32x32x32 -q -o $name.nrrd || exit 1
done
"$TOOL" run_0000.nrrd -o look.png -s 64x64 -q --save-config look.json || exit 1
"$TOOL" big.nrrd -o ../want.png -q || exit 1
"$TOOL" big.nrrd -o ../large.png -s 1920x1080 -q || exit 1
cd "$WORK" || exit 1

# in_copy COMMAND...: in a folder with nothing but the files.
in_copy() (
    rm -rf "$WORK/run"
    cp -r "$WORK/files" "$WORK/run"
    cd "$WORK/run" && "$@"
)

# Lines with mpirun.  Binding is spelt in another way by each launcher.
count=0
while read -r line; do
    is_open_mpi || [[ $line != *--bind-to* ]] || continue
    count=$((count + 1))
    # Places that this machine has not.
    run 0 "$line" in_copy sh -c "$(sed 's/--map-by [^ ]* --bind-to core/-n 2/' <<<"$line")"
    case $line in
    *doctor*) prints '^mpi .*, 2 ranks' ;;
    *' -o big.png'*) run 0 "is the same picture" "$TOOL" compare run/big.png \
        want.png --tolerance 1/255 ;;
    *turn_%04d*) check "has all frames" [ -s run/turn_0003.png ] ;;
    *run_%04d*) check "has all steps" [ -s run/run_0002.png ] ;;
    *) fail "what becomes of this line is not tested" ;;
    esac
done < <(sed -nE 's/^ {4,6}(mpirun .*)/\1/p' "$PAGE")
check "there are lines" [ $count -ge 4 ]

# Batch scripts.
awk '/^```/ { out = "" } out { print > out }
    !out && /^#!\/bin\/sh/ { out = "job" ++n ".sh"; print > out }' "$PAGE"
wanted() { sed -nE "s/^#SBATCH --$1=([0-9]+).*/\1/p" "$2"; }
for job in job*.sh; do
    nodes=$(wanted nodes "$job")
    each=$(wanted ntasks-per-node "$job")
    tasks=$(wanted ntasks "$job")
    run 0 "$job" in_copy env TASKS="${tasks:-$((nodes * each))}" \
        SLURM_CPUS_PER_TASK="$(wanted cpus-per-task "$job")" \
        SLURM_ARRAY_TASK_ID=1 sh -eu "$WORK/$job"
    if grep -q big.json "$job"; then
        run 0 "is the same picture" "$TOOL" compare run/big.png large.png \
            --tolerance 1/255
        check "by all ranks" grep -q "\"ranks\": $((nodes * each))" run/big.json
    elif grep -q resume "$job"; then
        check "has all frames" [ -s run/turn_0007.png ]
    else
        check "has its frame" [ -s run/frame_0001.png ]
    fi
done
check "there are three scripts" [ -s job3.sh ]
finish
