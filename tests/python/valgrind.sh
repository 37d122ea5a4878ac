#!/bin/bash
# valgrind.sh PYTHON TOOL FOLDER [FILE...]: the tests of the package in FOLDER,
# those in test_*.py or in the files named, under valgrind, which no build has to
# know of.  It finds reads of what was freed or never written, also in what the
# sanitizers do not see, as libpng and zlib, and blocks of the library that nobody
# frees.  What Python itself keeps, its objects among it, valgrind.supp leaves out:
# test_snowglass.py counts those.
set -eu
python=$1 here=$(cd "$(dirname "$0")" && pwd)
export SNOWGLASS=$2
python_path=$3
shift 3
[ $# -gt 0 ] || set -- "$here"/test_*.py
hidden=$(mktemp -d)
trap 'rm -rf "$hidden"' EXIT
# Valgrind computes long doubles in 64 bits, which these do not bear.
echo 'import sys; sys.modules.update(h5py=None, nibabel=None, xarray=None)' \
    >"$hidden/sitecustomize.py"
export PYTHONPATH=$hidden:$python_path
# What measures time and memory is left out; each block is one of malloc, and no
# thread of NumPy's waits for work.
export SNOW_SANITIZED=valgrind PYTHONMALLOC=malloc OPENBLAS_NUM_THREADS=1
# One option: a second would replace the first.
programs='*/snowglass,*/ffmpeg,*/node*,/usr/sbin/*,*/cp,*/sh,*/bash,*/dash'
failed=0
for file in "$@"; do
    echo "== $(basename "$file")"
    # Other Pythons that a test starts are looked at too, other programs are not.
    valgrind --quiet --fair-sched=try --error-exitcode=9 --leak-check=full \
        --show-leak-kinds=definite --errors-for-leak-kinds=definite \
        --trace-children=yes \
        --trace-children-skip="$programs" \
        --suppressions="$here/valgrind.supp" \
        "$python" -B -m unittest discover -v -s "$here" \
        -p "$(basename "$file")" || failed=1
done
exit $failed
