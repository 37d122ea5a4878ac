# tests/cli/tool/cli_documents.sh - every command that README and guides show works as
# it stands: `script TOOL DATA`.  Stand-ins of the files that they name are made
# from phantoms; the bench is left out, since it takes long, the viewer, since it
# does not end (tests/serve), and what is shown in a terminal.
set -uo pipefail
tool=$(realpath "$1")
root=$(realpath "$(dirname "$0")/../../..")
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT
mkdir "$place/files"
cd "$place/files" || exit 1

for name in head.nii.gz ct.nii.gz mra.nii.gz brain.nii.gz organs.nii.gz ct.nrrd \
    sim.nrrd volume.mha scan.mha; do
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
    "$tool" phantom shells --dims 16x16x16 --seed $step -q \
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

cp -r slices dicom_folder

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
    {"path": "2"}]}]}' >cells.ome.zarr/.zattrs
cp "$root"/fuzz/corpus/tf/$(cd "$root/fuzz/corpus/tf" && ls | grep -m1 '\.vp$') slicer.vp

# Movies need a program of its own.
without='^$'
command -v ffmpeg >/dev/null || without='-o [^ ]*\.(mp4|webm|gif)'

# The indented lines that begin with the tool's name, continued lines joined.
commands() {
    sed -e ':a' -e '/\\$/N; s/\\\n *//; ta' "$root/README.md" \
        "$root"/docs/*.md "$root"/docs/measurements/*.md |
        sed -n 's/^    \(snowglass .*\)/\1/p' |
        grep -Ev 'snowglass (bench|serve)|--show' | grep -Ev -e "$without" | sort -u
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
