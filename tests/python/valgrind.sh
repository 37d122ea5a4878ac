#!/bin/bash
# valgrind.sh PYTHON TOOL FOLDER [-k NAME...]: the first tests of the package in
# FOLDER, or those named, under valgrind, which no build has to know of.  It finds
# reads of what was freed or never written, also in what the sanitizers do not see,
# as libpng and zlib, and blocks of the library that nobody frees.  What Python
# itself keeps, its objects among it, valgrind.supp leaves out: test_snowglass.py
# counts those.
set -eu
python=$1 here=$(cd "$(dirname "$0")" && pwd)
export SNOWGLASS=$2
python_path=$3
shift 3
hidden=$(mktemp -d)
trap 'rm -rf "$hidden"' EXIT
# Valgrind computes long doubles in 64 bits, which these do not bear.
for module in nibabel xarray; do
    echo 'raise ImportError("hidden from valgrind")' >"$hidden/$module.py"
done
export PYTHONPATH=$hidden:$python_path
# What measures time and memory is left out; each block is one of malloc, and no
# thread of NumPy's waits for work.
export SNOW_SANITIZED=valgrind PYTHONMALLOC=malloc OPENBLAS_NUM_THREADS=1
valgrind --quiet --fair-sched=try --error-exitcode=9 --leak-check=full \
    --show-leak-kinds=definite --errors-for-leak-kinds=definite \
    --suppressions="$here/valgrind.supp" \
    "$python" -B -m unittest discover -v -s "$here" -p test_snowglass.py "$@"
