#!/bin/bash
# run.sh PYTHON TOOL FOLDER: the tests of the package in FOLDER, and in the
# long tier those of its slices, documents and types, and those that hold it
# against the tool.  There those of the short tier run as short, with
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
patterns=('test_[!nsv]*.py' 'test_sl*.py')
[ "$SNOW_TIER" != release ] || patterns+=(test_snowglass.py) # many pictures
for tests in "${patterns[@]}"; do
    "$python" -m unittest discover -s "$here" -p "$tests" || failed=1
done
# A sanitizer checks memory itself.
[ -n "${SNOW_PRELOAD-}" ] || export PYTHONMALLOC=debug
SNOW_TIER=short "$python" -m unittest discover -s "$here" -p test_snowglass.py || failed=1
wait $aside || failed=1
cat "$said"
exit $failed
