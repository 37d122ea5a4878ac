# tests/cli/data/cli_codes.sh - the table "my code writes" of docs/simulations.md:
# each command is run on a file that codes.py lays out as that code does, and what the
# tool tells of it is what was written.  `script TOOL DATA`.
set -uo pipefail
tool=$(realpath "$1")
here=$(realpath "$(dirname "$0")")
python=${PYTHON:-/usr/bin/python3}
"$python" -c 'import h5py, netCDF4, numpy, zarr' 2>/dev/null || {
    echo "skip   Python's h5py, netCDF4, numpy and zarr are not installed"
    exit 77
}
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT
cd "$place" || exit 1
"$python" "$here/codes.py" "$tool" "$here/../../../docs/simulations.md"
