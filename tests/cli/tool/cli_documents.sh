# tests/cli/tool/cli_documents.sh - every command that README and guides show works as
# it stands: `script TOOL DATA`.  Stand-ins of the files that they name are made
# from phantoms; the bench is left out, since it takes long, the viewer, since it
# does not end (tests/serve), and what is shown in a terminal.  Turntables get three
# frames, and written phantoms few voxels, by options behind those that are shown.
set -uo pipefail
tool=$(realpath "$1")
root=$(realpath "$(dirname "$0")/../../..")
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT
mkdir "$place/files"
cd "$place/files" || exit 1

for name in head.nii.gz ct.nii.gz mra.nii.gz brain.nii.gz organs.nii.gz \
    seg.nii.gz pet.nii.gz ct.nrrd sim.nrrd seg.nrrd head512.nrrd volume.mha \
    scan.mha; do
    "$tool" phantom head --dims 32x32x32 -q -o "$name" || exit 1
done
# With values of Hounsfield units, and more.
"$tool" convert head.nii.gz -q -y --type int16 --range 0,255 -o ct.nii.gz || exit 1
mkdir scans
cp head.nii.gz ct.nrrd scans
"$tool" phantom engine -q -o engine.raw.gz || exit 1
echo '{"input": "sim.nrrd", "output": "sim.png"}' >look.json
"$tool" tf convert ct-bone -q -o bone.json || exit 1
for step in 0 1 2; do
    "$tool" phantom shells --dims 16x16x16 -q \
        -o run_000$step.nrrd || exit 1
done
head -c $((2 * 256 * 256 * 113)) /dev/zero | gzip -1 >CThead.raw.gz
"$tool" phantom:shells -q -s 64x64 --dims 32x32x32 -o a.png || exit 1
for suffix in png npy; do
    for name in a b fig again; do
        [ -e "$name.$suffix" ] || "$tool" phantom:shells --dims 32x32x32 -q \
            -s 64x64 -o "$name.$suffix" || exit 1
    done
done

# Vectors of three bytes.
{
    printf '\223NUMPY\1\0\166\0%-117s\n' \
        "{'descr': '|u1', 'fortran_order': False, 'shape': (16, 16, 16, 3), }"
    gzip -dc engine.raw.gz | tail -c +3000000 | head -c $((3 * 16 * 16 * 16))
} >flow.npy

mkdir slices
head -c 4096 /dev/zero >slices/notes.txt
for i in 0001 0002 0003; do
    "$tool" render phantom:shells --dims 16x16x16 -q -s 16x16 -o slices/ct_$i.png || exit 1
done

cp -r slices dicom_folder && cp -r slices pet_folder
"$tool" convert slices -q -o mask.nrrd && mv mask.nrrd seg.dcm || exit 1

# What simulations write (docs/simulations.md): a series of three steps in each
# format.  HDF5 and NetCDF need Python's writers.
printf 'TIME: 0.5\nDATA_FILE: rho.raw\nDATA_SIZE: 32 24 16\nDATA_FORMAT: DOUBLE
VARIABLE: rho\nDATA_ENDIAN: LITTLE\nBRICK_SIZE: 32 24 32\n' >rho.bov
"$tool" phantom shells --dims 32x24x16 -q -o s.nrrd || exit 1
"$tool" convert s.nrrd -q --as float64 -o rho.raw || exit 1
for step in 0 1 2; do
    {
        printf '<VTKFile type="ImageData"><ImageData WholeExtent="0 3 0 3 0 3">
            <Piece Extent="0 3 0 3 0 3"><PointData Scalars="rho">
            <DataArray type="Float32" Name="rho" format="ascii">'
        seq $step $((step + 63))
        printf '</DataArray></PointData></Piece></ImageData></VTKFile>'
    } >run_000$step.vti
    echo run_000$step.vti >>run.visit
    echo "<DataSet timestep=\"0.$step\" file=\"run_000$step.vti\"/>" >>run.list
done
{
    echo '<VTKFile type="Collection"><Collection>'
    cat run.list
    echo '</Collection></VTKFile>'
} >run.pvd
{
    printf '<VTKFile type="RectilinearGrid"><RectilinearGrid WholeExtent="0 3 0 3
        0 3"><Piece Extent="0 3 0 3 0 3"><PointData Scalars="u"><DataArray
        type="Float32" Name="u" format="ascii">'
    seq 64
    printf '</DataArray></PointData><Coordinates>'
    for axis in 1 2 3; do
        echo '<DataArray type="Float32" format="ascii">0 1 3 7</DataArray>'
    done
    printf '</Coordinates></Piece></RectilinearGrid></VTKFile>'
} >channel.vtr
for step in 0 1; do
    plt=plt0000$step
    mkdir $plt $plt/Level_0 $plt/Level_1
    printf '%s\n' HyperCLaw-V1.1 2 density temperature 3 0.$step 1 '0 0 0' '2 1.5 1' 2 \
        '((0,0,0) (31,23,15) (0,0,0)) ((0,0,0) (63,47,31) (0,0,0))' '0 0' \
        '0.0625 0.0625 0.0625' '0.03125 0.03125 0.03125' 0 0 \
        '0 1 0' 0 '0 2' '0 1.5' '0 1' Level_0/Cell \
        '1 1 0' 0 '0.5 1' '0.5 1' '0.25 0.75' Level_1/Cell >$plt/Header
    for level in 0 1; do
        box='((0,0,0) (31,23,15) (0,0,0))'
        [ $level = 0 ] || box='((16,16,8) (31,31,23) (0,0,0))'
        printf '%s\n' 1 1 2 0 '(1 0' "$box" ')' 1 'FabOnDisk: Cell_D_00000 0' \
            >$plt/Level_$level/Cell_H
        {
            echo "FAB ((8, (64 11 52 0 1 12 0 1023)),(8, (8 7 6 5 4 3 2 1)))$box 2"
            cat rho.raw rho.raw
        } >$plt/Level_$level/Cell_D_00000
    done
done
printf '<VTKFile type="vtkOverlappingAMR"><vtkOverlappingAMR><Block level="0">
    <DataSet file="cells.vti"/></Block></vtkOverlappingAMR></VTKFile>' >run.vth
sed 's/PointData/CellData/g; s/"0 3 0 3 0 3"/"0 4 0 4 0 4"/g' run_0000.vti >cells.vti
lacks='^$'
"${PYTHON:-/usr/bin/python3}" - <<'END' 2>/dev/null || lacks='([.](h5|nc|xmf|athdf)|_plt_cnt_[0-9]+)( |:|$)'
import h5py
import netCDF4
import numpy as np

a = np.add.outer(np.add.outer(np.arange(8.), np.arange(9.)), np.arange(10.))
item = '<DataItem Format="%s">%s</DataItem>'
with h5py.File("run.h5", "w") as run, open("run.xmf", "w") as text:
    text.write('<Xdmf><Domain><Grid GridType="Collection" '
               'CollectionType="Temporal">')
    for step in range(3):
        name = f"step_{step:04d}/rho"
        run[name] = a + step
        run[name].attrs["units"] = "kg/m3"
        run[f"step_{step:04d}"].attrs["time"] = step / 4
        text.write('<Grid><Time Value="%g"/><Topology TopologyType='
                   '"3DCoRectMesh" Dimensions="8 9 10"/><Geometry '
                   'GeometryType="ORIGIN_DXDYDZ">%s%s</Geometry><Attribute '
                   'Name="rho">%s</Attribute></Grid>' %
                   (step / 4, item % ("XML", "0 0 0"), item % ("XML", "1 1 1"),
                    item % ("HDF", "run.h5:/" + name)))
        with h5py.File(f"data_{step * 100}.h5", "w") as one:
            one[f"data/{step * 100}/fields/rho"] = a + step
    text.write("</Grid></Domain></Xdmf>")
# Modes around an axis, of a vector.
for step in 0, 100:
    with h5py.File(f"wake_{step}.h5", "w") as one:
        for name in "rtz":
            one[f"data/{step}/fields/E/{name}"] = np.ones((3, 8, 9))
        one[f"data/{step}/fields/E"].attrs.update(
            geometry=np.bytes_("thetaMode"), gridSpacing=[1., 1.],
            axisLabels=np.array(["r", "z"], "S1"))
# Eight blocks of one level, as FLASH and Athena++ write them.
places = np.array(list(np.ndindex(2, 2, 2)))
ends = np.stack([places, places + 1], -1) / 2
blocks = np.add.outer(places.sum(1), np.add.outer(np.add.outer(
    np.arange(4.), np.arange(4.)), np.arange(4.)))
with h5py.File("run_hdf5_plt_cnt_0000", "w") as run:
    run["bounding box"], run["dens"] = ends, blocks
    run["refine level"] = run["node type"] = np.ones(8, "i4")
with h5py.File("blast.prim.00000.athdf", "w") as run:
    run.attrs.update(RootGridSize=[8] * 3, MeshBlockSize=[4] * 3, NumVariables=[2],
                     DatasetNames=np.array(["prim"], "S5"),
                     VariableNames=np.array(["rho", "press"], "S5"))
    run["prim"], run["Levels"] = np.stack([blocks, blocks]), np.zeros(8, "i4")
    run["LogicalLocations"] = places
    for i in range(3):
        run[f"x{i + 1}f"] = np.linspace(*ends[:, i].T, 5).T
with netCDF4.Dataset("ocean.nc", "w") as ocean:
    for name, at, unit in (("time", [0, 1, 2], "days since 2000-01-01"),
                           ("z", [0, 1, 3, 7, 15, 31, 63, 127], "m"),
                           ("y", range(9), "m"), ("x", range(10), "m")):
        ocean.createDimension(name, len(at))
        v = ocean.createVariable(name, "f8", (name,))
        v[:], v.units = at, unit
    v = ocean.createVariable("temp", "f4", ("time", "z", "y", "x"))
    v[:], v.units = np.stack([a, a + 1, a + 2]), "K"
for hour in (0, 2):  # as WRF writes them, two steps in each
    with netCDF4.Dataset(f"wrfout_d01_2005-08-28_{hour:02d}:00:00", "w") as wrf:
        wrf.DX = wrf.DY = 3000.
        for axis, size in (("Time", None), ("DateStrLen", 19), ("west_east", 9),
                           ("south_north", 8), ("bottom_top", 6),
                           ("bottom_top_stag", 7)):
            wrf.createDimension(axis, size)
        wrf.createVariable("Times", "S1", ("Time", "DateStrLen"))[:] = np.array(
            [list(f"2005-08-28_{hour + i:02d}:00:00") for i in (0, 1)], "S1")
        levels = 981. * np.arange(7.)[:, None, None] + np.zeros((2, 7, 8, 9))
        for name, values, axis in (("T", levels[:, 1:] / 100, "bottom_top"),
                                   ("W", levels / 1000 + hour, "bottom_top_stag"),
                                   ("PHB", levels, "bottom_top_stag"),
                                   ("PH", 0 * levels, "bottom_top_stag")):
            v = wrf.createVariable(name, "f4", ("Time", axis, "south_north", "west_east"))
            v[:] = values
END

# Five times of two channels, at three levels.
for level in 0 1 2; do
    mkdir -p cells.ome.zarr/$level
    printf '{"zarr_format": 2, "shape": [5, 2, 4, 64, 64], "order": "C",
        "chunks": [5, 2, 4, 64, 64], "dtype": "|u1", "filters": null,
        "compressor": null, "fill_value": 0}' >cells.ome.zarr/$level/.zarray
    gzip -dc engine.raw.gz | tail -c +2000000 | head -c $((10 * 4 * 64 * 64)) \
        >cells.ome.zarr/$level/0.0.0.0.0
done
printf '{"multiscales": [{"datasets": [{"path": "0"}, {"path": "1"},
    {"path": "2"}]}], "omero": {"channels": [{"label": "DAPI"},
    {"label": "GFP"}]}}' >cells.ome.zarr/.zattrs
cp "$root"/fuzz/corpus/tf/$(cd "$root/fuzz/corpus/tf" && ls | grep -m1 '\.vp$') slicer.vp

# The files alone, for other lines than those of the tool (tests/package/snippets).
[ -z "${STAND_INS-}" ] || { cp -r . "$STAND_INS" && exit; }

# Movies need a program of its own.
without='^$'
command -v ffmpeg >/dev/null || without='-o [^ ]*\.(mp4|webm|gif)'

# The indented lines that begin with the tool's name, continued lines joined.
commands() {
    sed -e ':a' -e '/\\$/N; s/\\\n *//; ta' "$root/README.md" \
        "$root"/docs/*.md "$root"/docs/measurements/*.md |
        sed -n 's/^    \(snowglass .*\)/\1/p' |
        grep -Ev 'snowglass (bench|serve|export)|--show' | grep -Ev -e "$without" |
        grep -Ev -e "$lacks" | sort -u
}

# The short tier takes one in six.
step=1
[ "${SNOW_TIER:-short}" != short ] || step=6
commands | sed -n "1~${step}p" >"$place/commands"
ran=0 failed=0 words=()
while read -r line; do
    rm -rf "$place/run"
    cp -rl "$place/files" "$place/run"
    cd "$place/run" || exit 1
    eval "words=(${line#snowglass})"
    # What a command writes must not be there yet.
    for i in "${!words[@]}"; do
        [ "${words[i]}" != -o ] || rm -f "${words[i + 1]}"
    done
    case $line in
    'snowglass turntable '*) words+=(--frames 3) ;;
    'snowglass phantom head '*) words+=(--dims 64x64x64) ;;
    esac
    "$tool" "${words[@]}" >out 2>err </dev/null
    status=$?
    ran=$((ran + 1))
    if [ $status -ne 0 ]; then
        failed=$((failed + 1))
        echo "FAILED $line: exit status $status: $(tail -1 err)"
    fi
done <"$place/commands"
echo "$ran commands, $failed failed"
[ "$ran" -gt 10 ] && [ "$failed" -eq 0 ]
