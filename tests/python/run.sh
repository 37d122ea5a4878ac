#!/bin/bash
# run.sh PYTHON TOOL FOLDER: the tests of the package in FOLDER, and in the
# long tier those of its slices, documents and types, and those that hold it
# against the tool.  There those of the short tier run once more, as short, with
# Python's checks of its memory and of who may use it.
set -eu
python=$1 here=$(cd "$(dirname "$0")" && pwd)
export SNOWGLASS=$2 PYTHONPATH=$3
"$python" -c 'import numpy' 2>/dev/null || {
    echo "skipped: $python has no NumPy"
    exit 77
}
[ -z "${SNOW_PRELOAD-}" ] || export LD_PRELOAD=$SNOW_PRELOAD
if [ "${SNOW_TIER:-short}" = short ]; then
    "$python" -m unittest discover -s "$here" -p test_snowglass.py
    exit
fi
# The viewer waits more than it computes: aside.
said=$(mktemp)
trap 'rm -f "$said"' EXIT
"$python" -m unittest discover -s "$here" -p 'test_[nv]*.py' >"$said" 2>&1 &
aside=$! failed=0
"$python" -m unittest discover -s "$here" -p 'test_[!nv]*.py' || failed=1
wait $aside || failed=1
cat "$said"
[ $failed = 0 ] || exit 1
[ -n "${SNOW_PRELOAD-}" ] || # which checks memory itself
    SNOW_TIER=short PYTHONMALLOC=debug "$python" -m unittest discover -s "$here" -p test_snowglass.py
