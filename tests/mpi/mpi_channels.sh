#!/bin/bash
# mpi_channels.sh - several channels in one picture by many ranks, each of which
# reads what its part needs, and in slabs: the pictures of one process.
. "$(dirname "$0")/../support/mpi.sh"
long_tier || COUNTS="2 3"
command -v python3 >/dev/null || {
    skipped all "there is no python3"
    exit 77
}

# Two steps of three channels, balls that overlap; and a larger one of one step.
python3 - <<'END_PYTHON'
import struct

def write(name, steps, nx, ny, nz, row):
    text = ("{'descr': '|u1', 'fortran_order': False, 'shape': (%d, 3, %d, %d, %d), }" %
            (steps, nz, ny, nx)).ljust(117) + "\n"
    voxels = b"".join(row(t, c, y, z) for t in range(steps) for c in range(3)
                      for z in range(nz) for y in range(ny))
    open(name, "wb").write(b"\x93NUMPY\x01\x00" + struct.pack("<H", len(text)) +
                           text.encode() + voxels)

def ball(t, c, x, y, z):
    far = (x - 11 - 5 * c) ** 2 + (y - 17) ** 2 + (z - 12 - 8 * c) ** 2
    return max(0, 220 - far) + (x + 2 * y + 3 * z + c + t) % 9 + 20 * t

write("c.npy", 2, 36, 32, 40, lambda t, c, y, z:
      bytes(ball(t, c, x, y, z) for x in range(36)))
rows = [bytes(min(255, 40 * c + 3 * abs(x - 64)) for x in range(128))
        for c in range(3)]
write("big.npy", 1, 128, 120, 160, lambda t, c, y, z:
      rows[c] if (y + z) // 32 % 2 else b"\x09" * 128)
END_PYTHON

list="--channel 0:red:20..200,1:#20ff40:0.7,2:blue:p1..p99.9"
for look in "--azimuth 33" "--perspective --azimuth 100" "-m mip --elevation 20" \
    "--clip 1,0.5,0,30 --shade phong"; do
    way="c.npy $list -s 80x70 -q $look"
    # shellcheck disable=SC2086
    run 0 "$look alone" "$TOOL" render $way -y -o one.npy
    # shellcheck disable=SC2086
    run 0 "one channel" "$TOOL" render c.npy -s 80x70 -q $look --channel 1:green -y -o lone.npy
    check "is another picture" [ -n "$(cmp one.npy lone.npy)" ]
    for ranks in $COUNTS; do
        # shellcheck disable=SC2086
        run 0 "by $ranks" launch "$ranks" "$MPI_TOOL" render $way -y -o many.npy
        run 0 "is as by one" "$TOOL" compare one.npy many.npy --tolerance 1/255
    done
done
for ranks in $COUNTS; do
    for look in "" "-m mip"; do
        way="render c.npy $list -s 80x70 -q $look --deterministic"
        # shellcheck disable=SC2086
        run 0 "the same for ever $look" "$TOOL" $way -y -o one.npy
        # shellcheck disable=SC2086
        run 0 "by $ranks" launch "$ranks" "$MPI_TOOL" $way -y -o many.npy
        check "has the same bits" cmp -s one.npy many.npy
    done
done
# A mask cuts all channels.
"$TOOL" convert c.npy --channel 1 -o seg.nrrd -q
"$TOOL" convert c.npy --channel 1 --time 1 -o other.npy -q
for mask in "--mask other.npy --labels 20:200" "--mask seg.nrrd --labels 9:30 --deterministic"; do
    way="render c.npy $list -s 80x70 -q --azimuth 33 $mask"
    # shellcheck disable=SC2086
    run 0 "$mask alone" "$TOOL" $way -y -o one.npy
    # shellcheck disable=SC2086
    run 0 "without it" "$TOOL" render c.npy $list -s 80x70 -q --azimuth 33 -y -o whole.npy
    check "is another picture" [ -n "$(cmp one.npy whole.npy)" ]
    for ranks in $COUNTS; do
        # shellcheck disable=SC2086
        run 0 "by $ranks" launch "$ranks" "$MPI_TOOL" $way -y -o many.npy
        run 0 "is as by one" "$TOOL" compare one.npy many.npy --tolerance 1/255
    done
done
check "the bits too" cmp -s one.npy many.npy
run 0 "without a word" launch 3 "$MPI_TOOL" render c.npy $list -s 80x70 -y -o many.npy
check "no channel is left out" [ "$(grep -c 'note: channel' "$ERR")" = 0 ]
says 'channels 0 red 20..200, 1 #20ff40 [0-9.]+ opacity 0.7, 2 blue; '
run 0 "ranges alone" "$TOOL" render c.npy $list -s 80x70 -y -o one.npy
says "$(grep -o 'channels 0 red 20..200, 1 #20ff40 [^;]*' "$ERR" | head -1)"

# Ranks that have no room for their parts leave them in the file.
way="render big.npy $list -s 60x50 -q --azimuth 20"
# shellcheck disable=SC2086
run 0 "a large one alone" "$TOOL" $way -y -o one.npy
# shellcheck disable=SC2086
run 0 "by 2 with little memory" launch 2 "$MPI_TOOL" $way --memory 7M -y -o many.npy
run 0 "is as by one" "$TOOL" compare one.npy many.npy --tolerance 1/255

for verb in "turntable c.npy --frames 4" "movie c.npy" "movie c.npy -m mip" \
    "turntable c.npy --frames 3 -m mip"; do
    way="$verb $list -s 64x64 -q --background black"
    rm -f one_*.png many_*.png
    # shellcheck disable=SC2086
    run 0 "$verb alone" "$TOOL" $way -y -o one_%d.png
    # shellcheck disable=SC2086
    run 0 "by 3" launch 3 "$MPI_TOOL" $way -y -o many_%d.png
    for frame in one_*.png; do
        run 0 "$frame" "$TOOL" compare "$frame" "many_${frame#one_}" \
            --tolerance 1.001/255
    done
done
check "of all frames" [ -e many_2.png ]
finish
