#!/bin/bash
# mpi_hosts.sh - three hosts with two ranks each, over TCP: network namespaces
# of this machine, joined by a bridge, and started through an agent as others
# are through ssh.  Skipped where namespaces cannot be made.
. "$(dirname "$0")/../support/mpi.sh"
is_open_mpi || skip "for Open MPI's mpirun, which takes another agent than ssh"
for needed in ip unshare; do
    command -v $needed >/dev/null || skip "there is no $needed"
done

[ -e /sys/class/net ] || skip "there is no /sys"

name=snow$$
clear_up() {
    for host in 0 1 2 3; do
        ip netns del $name-$host 2>/dev/null
    done
    rm -rf "$WORK"
}
trap clear_up EXIT
ip netns add $name-0 2>/dev/null || skip "namespaces are not allowed here"
inside() {
    local host=$1
    shift
    ip netns exec $name-"$host" "$@"
}

# Host 0 has the bridge, and mpirun.
inside 0 ip link add bridge type bridge 2>/dev/null ||
    skip "bridges are not allowed here"
inside 0 ip address add 10.77.0.10/24 dev bridge
inside 0 ip link set bridge up
inside 0 ip link set lo up
for host in 1 2 3; do
    ip netns add $name-$host
    inside 0 ip link add port$host type veth peer name wire netns $name-$host
    inside 0 ip link set port$host master bridge
    inside 0 ip link set port$host up
    inside $host ip address add 10.77.0.$host/24 dev wire
    inside $host ip link set wire up
    inside $host ip link set lo up
    echo "10.77.0.$host slots=2" >>hosts
done

# agent HOST COMMAND...: each host has a name of its own, by which Open MPI
# tells machines apart.
cat >agent <<END
#!/bin/sh
host=\${1##*.}
shift
exec ip netns exec $name-\$host unshare --uts \
    sh -c "hostname $name-\$host; cd '$WORK'; \$*"
END
chmod +x agent

# launch_hosts COMMAND...: idle ranks give the processor away, though they do
# not see that it is shared.
launch_hosts() {
    inside 0 timeout -k 5 "${LIMIT:-360}" "$MPIEXEC" --hostfile hosts -n 6 \
        --mca plm_rsh_agent "$WORK/agent" --mca mpi_yield_when_idle 1 \
        --mca oob_tcp_if_include 10.77.0.0/24 \
        --mca btl_tcp_if_include 10.77.0.0/24 "$@"
}

run 0 "six ranks on three hosts" launch_hosts sh -c hostname
check "there are three hosts" [ "$(sort -u "$OUT" | wc -l)" -eq 3 ]
run 0 "messages between hosts" launch_hosts "$TESTS/mpi_comm"

# Ranks of a host read each other's pixels in place, and combine them first;
# those of different hosts send them.
for method in radix direct tree; do
    run 0 "$method by three hosts" launch_hosts "$MPI_TOOL" bench ranks \
        phantom:head --dims 64x60x56 --size 128 --runs 2 --combine $method --json
    check "$method: some bytes are read in place, some sent" python3 -c '
import json, sys
row, = json.load(open(sys.argv[1]))["rows"]
assert row["ranks"] == 6 and row["radices"], row
assert 0 < row["bytes_in_place"] < 0.8 * row["bytes_sent"], row
assert sys.argv[2] != "radix" or row["radices"] == [2, 3], row
' "$OUT" $method
done

before=$(inside 2 cat /sys/class/net/wire/statistics/tx_bytes)
for view in "--view +x" "--azimuth 33 --elevation 21"; do
    # shellcheck disable=SC2086
    run 0 "$view alone" "$TOOL" phantom:head --dims 64x60x56 $view -y -q \
        -o one.npy
    # shellcheck disable=SC2086
    run 0 "$view on three hosts" launch_hosts "$MPI_TOOL" phantom:head \
        --dims 64x60x56 $view -y -q -o "$WORK/many.npy"
    run 0 "$view is as by one process" "$TOOL" compare one.npy many.npy \
        --tolerance 1/255
done
after=$(inside 2 cat /sys/class/net/wire/statistics/tx_bytes)
check "host 2 has sent pixels" [ $((after - before)) -gt 20000 ]
finish
