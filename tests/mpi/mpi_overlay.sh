#!/bin/bash
# mpi_overlay.sh - --overlay by many ranks, each of which reads what its part
# needs: the pictures of one process.
. "$(dirname "$0")/../support/mpi.sh"
command -v python3 >/dev/null || {
    skipped all "there is no python3"
    exit 77
}

# A volume; labels on its grid, and along x the other way.
python3 - <<'END'
nx, ny, nz = 40, 36, 44

def write(name, dims, steps, origin, voxels, labels):
    text = ("NRRD0004\ntype: uint8\ndimension: 3\nsizes: %d %d %d\n" % dims +
            "space: RAS\nspace directions: (%g,0,0) (0,%g,0) (0,0,%g)\n" % steps +
            "space origin: (%g,%g,%g)\nencoding: raw\n" % origin)
    if labels:
        text += "Segment0_LabelValue:=1\nSegment1_LabelValue:=3\n"
    open(name, "wb").write((text + "\n").encode() + bytes(voxels))

def value(x, y, z):
    return min(255, (x - 20) ** 2 + (y - 18) ** 2 + (z - 22) ** 2) // 2

def label(x, y, z):
    return (3 <= x < 16 and 4 <= y < 18) + 3 * (22 <= x < 36 and 10 <= z < 30)

grid = [(x, y, z) for z in range(nz) for y in range(ny) for x in range(nx)]
write("v.nrrd", (nx, ny, nz), (1, 1, 1), (5, 6, 7), [value(*p) for p in grid], 0)
write("seg.nrrd", (nx, ny, nz), (1, 1, 1), (5, 6, 7), [label(*p) for p in grid], 1)
write("flip.nrrd", (nx, ny, nz), (-1, 1, 1), (5 + nx - 1, 6, 7),
      [label(nx - 1 - x, y, z) for x, y, z in grid], 1)
END

look=(-s 80x70 --range 20,120 --opacity 20:0,60:0.05,120:0.2 --azimuth 33)
seg=(render v.nrrd --overlay seg.nrrd "${look[@]}")
as_one "labels on the grid" 3 bits "${seg[@]}" --deterministic
run 0 "without" "$TOOL" render v.nrrd "${look[@]}" -q --deterministic -o none.npy
check "are seen" [ -n "$(cmp one.npy none.npy)" ]
WAY="--cut bricks" as_one "labels the other way" "$MOST" 1/255 render v.nrrd \
    --overlay flip.nrrd "${look[@]}"
as_one "a plane cuts both" "$MOST" 1/255 "${seg[@]}" --labels 3 \
    --clip 1,0.5,0,30 --perspective
frames_as_one "a turntable" 3 turntable v.nrrd --overlay seg.nrrd --frames 3

"$TOOL" convert seg.nrrd -o bare.npy -q
"$TOOL" convert v.nrrd -o v.npy -q
as_one "a crop of both, one without a place" 3 1/255 render v.npy \
    --spacing 0.5x0.5x0.9 --overlay bare.npy "${look[@]}" --crop 3:36,0:30,4:40

run 0 "a slice alone" "$TOOL" slice v.nrrd --overlay bare.npy -q -y -o one.png
run 0 "a slice by 2" launch 2 "$MPI_TOOL" slice v.nrrd --overlay bare.npy -q -y \
    -o many.png
check "is the same" cmp -s one.png many.png

run 3 "an overlay that is not there" launch 3 "$MPI_TOOL" render v.nrrd \
    --overlay absent.nrrd -y -o x.png
check "is told once" [ "$(grep -c absent "$ERR")" -eq 1 ]
finish
