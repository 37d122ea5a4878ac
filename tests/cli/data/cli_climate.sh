# tests/cli/data/cli_climate.sh - what climate scientists see of their NetCDF files:
# looks of series and of maps, heights, units and dates.  `script TOOL DATA`.
set -uo pipefail
tool=$(realpath "$1")
here=$(realpath "$(dirname "$0")")
python=${PYTHON:-/usr/bin/python3}
"$python" -c 'import cftime, netCDF4, numpy' 2>/dev/null || {
    echo "skip   Python's cftime, netCDF4 and numpy are not installed"
    exit 77
}
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT
cd "$place" || exit 1
"$python" "$here/climate.py" "$tool"
