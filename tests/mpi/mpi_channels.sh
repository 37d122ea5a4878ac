#!/bin/bash
# mpi_channels.sh - several channels in one picture by many ranks, each of which
# reads what its part needs, and in slabs: the pictures of one process.
. "$(dirname "$0")/../support/mpi.sh"
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

list=(--channel 0:red:20..200,1:#20ff40:0.7,2:blue:p1..p99.9)
many=(render c.npy "${list[@]}" -s 80x70)
as_one "over" 3 1/255 "${many[@]}" -m over --azimuth 33
run 0 "one channel" "$TOOL" render c.npy -s 80x70 -q -m over --azimuth 33 \
    --channel 1:green -y -o lone.npy
check "is another picture" [ -n "$(cmp one.npy lone.npy)" ]
as_one "a plane, from an eye" 2 1/255 "${many[@]}" --clip 1,0.5,0,30 \
    --shade phong --perspective
as_one "maxima" "$MOST" bits "${many[@]}" -m mip --elevation 20 --deterministic
# A mask cuts all channels.
"$TOOL" convert c.npy --channel 1 -o seg.nrrd -q
as_one "a deterministic mask" 3 bits "${many[@]}" --mask seg.nrrd \
    --labels 9:30 --deterministic
run 0 "without it" "$TOOL" "${many[@]}" -q --deterministic -y -o whole.npy
check "is another picture" [ -n "$(cmp one.npy whole.npy)" ]
run 0 "without a word" launch 3 "$MPI_TOOL" "${many[@]}" -y -o many.npy
check "no channel is left out" [ "$(grep -c 'note: channel' "$ERR")" = 0 ]
says 'channels 0 red 20..200, 1 #20ff40 [0-9.]+ opacity 0.7, 2 blue; '
run 0 "ranges alone" "$TOOL" "${many[@]}" -y -o one.npy
says "$(grep -o 'channels 0 red 20..200, 1 #20ff40 [^;]*' "$ERR" | head -1)"

# Ranks that have no room for their parts leave them in the file.
WAY="--memory 7M" as_one "a large one with little memory" 2 1/255 \
    render big.npy "${list[@]}" -s 60x50 -m over --azimuth 20

frames_as_one "a movie" 3 movie c.npy -m mip "${list[@]}"
finish
