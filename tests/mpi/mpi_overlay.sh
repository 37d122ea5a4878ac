#!/bin/bash
# mpi_overlay.sh - --overlay by many ranks, each of which reads what its part
# needs: the pictures of one process.
. "$(dirname "$0")/../support/mpi.sh"
long_tier || COUNTS=3 MOST=3
command -v python3 >/dev/null || {
    skipped all "there is no python3"
    exit 77
}

# A volume; labels on its grid, and along x the other way; values on a coarser
# grid.
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
half = [(x, y, z) for z in range(22) for y in range(18) for x in range(20)]
write("v.nrrd", (nx, ny, nz), (1, 1, 1), (5, 6, 7), [value(*p) for p in grid], 0)
write("seg.nrrd", (nx, ny, nz), (1, 1, 1), (5, 6, 7), [label(*p) for p in grid], 1)
write("flip.nrrd", (nx, ny, nz), (-1, 1, 1), (5 + nx - 1, 6, 7),
      [label(nx - 1 - x, y, z) for x, y, z in grid], 1)
write("pet.nrrd", (20, 18, 22), (2, 2, 2), (5.5, 6.5, 7.5),
      [min(255, x * y + z * x) for x, y, z in half], 0)
END

look="-s 80x70 -q --range 20,120 --opacity 20:0,60:0.05,120:0.2 --azimuth 33"
for overlay in seg flip pet; do
    way="v.nrrd --overlay $overlay.nrrd $look"
    # shellcheck disable=SC2086
    run 0 "$overlay alone" "$TOOL" render $way -y -o one.npy
    # shellcheck disable=SC2086
    run 0 "without" "$TOOL" render v.nrrd $look -y -o none.npy
    check "is seen" [ -n "$(cmp one.npy none.npy)" ]
    for ranks in $COUNTS; do
        for cut in counted $(long_tier && echo equal bricks); do
            # shellcheck disable=SC2086
            run 0 "$overlay by $ranks, --cut $cut" launch "$ranks" "$MPI_TOOL" \
                render $way --cut $cut -y -o many.npy
            run 0 "is as by one" "$TOOL" compare one.npy many.npy --tolerance 1/255
        done
    done
    # shellcheck disable=SC2086
    run 0 "$overlay, the same for ever" "$TOOL" render $way --deterministic -y -o one.npy
    # shellcheck disable=SC2086
    run 0 "by $MOST" launch "$MOST" "$MPI_TOOL" render $way --deterministic -y -o many.npy
    check "has the same bits" cmp -s one.npy many.npy
done

way="v.nrrd --overlay seg.nrrd $look --labels 3 --clip 1,0.5,0,30 --perspective"
# shellcheck disable=SC2086
run 0 "a plane alone" "$TOOL" render $way -y -o one.npy
# shellcheck disable=SC2086
run 0 "by $MOST" launch "$MOST" "$MPI_TOOL" render $way -y -o many.npy
run 0 "cuts both" "$TOOL" compare one.npy many.npy --tolerance 1/255

turn="turntable v.nrrd --overlay seg.nrrd --frames 4 -s 64x64 -q --background black"
# shellcheck disable=SC2086
run 0 "a turntable alone" "$TOOL" $turn -y -o one_%d.png
# shellcheck disable=SC2086
run 0 "by 3" launch 3 "$MPI_TOOL" $turn -y -o many_%d.png
for frame in 0 1 2 3; do
    run 0 "frame $frame" "$TOOL" compare one_$frame.png many_$frame.png \
        --tolerance 1.001/255
done

"$TOOL" convert seg.nrrd -o bare.npy -q
"$TOOL" convert v.nrrd -o v.npy -q
for volume in v.nrrd "v.npy --spacing 0.5x0.5x0.9"; do
    way="render $volume --overlay bare.npy $look --crop 3:36,0:30,4:40"
    # shellcheck disable=SC2086
    run 0 "a crop of $volume and one without a place, alone" "$TOOL" $way -y -o one.npy
    # shellcheck disable=SC2086
    run 0 "by $MOST" launch "$MOST" "$MPI_TOOL" $way -y -o many.npy
    run 0 "is of both" "$TOOL" compare one.npy many.npy --tolerance 1/255
done
way="render v.npy --spacing 0.5x0.5x0.9 --mask bare.npy --labels 1 $look"
# shellcheck disable=SC2086
run 0 "its mask, alone" "$TOOL" $way -y -o one.npy
# shellcheck disable=SC2086
run 0 "by $MOST" launch "$MOST" "$MPI_TOOL" $way -y -o many.npy
run 0 "is of all" "$TOOL" compare one.npy many.npy --tolerance 1/255

for overlay in seg.nrrd bare.npy; do
    run 0 "a slice with $overlay, alone" "$TOOL" slice v.nrrd --overlay $overlay -q -y -o one.png
    run 0 "by 2" launch 2 "$MPI_TOOL" slice v.nrrd --overlay $overlay -q -y -o many.png
    check "is the same" cmp -s one.png many.png
done

run 3 "an overlay that is not there" launch 3 "$MPI_TOOL" render v.nrrd \
    --overlay absent.nrrd -y -o x.png
check "is told once" [ "$(grep -c absent "$ERR")" -eq 1 ]
finish
