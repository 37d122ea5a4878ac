# mpi_python.sh - a simulation in Python, over mpi4py, makes a movie of itself: the
# frames are the pictures that the tool makes of the same field.
. "$(dirname "$0")/../support/mpi.sh"
PYTHON=${SNOW_PYTHON:-/usr/bin/python3}
PACKAGE=$TESTS/../python
[ -e "$PACKAGE/snowglass/_insitu.abi3.so" ] ||
    skip "the Python package is not built, or without MPI"
"$PYTHON" -c 'import numpy, mpi4py' 2>/dev/null || skip "mpi4py is not installed"
export PYTHONPATH=$PACKAGE PYTHONDONTWRITEBYTECODE=1
launch 1 "$PYTHON" -c 'from mpi4py import MPI; from snowglass import insitu
insitu.Movie(MPI.COMM_WORLD, (2, 2, 2))' 2>/dev/null ||
    skip "mpi4py is of another MPI"

for way in "1 plain" "2 fortran" "3 halo" "2 sides"; do
    read -r ranks form <<<"$way"
    rm -f f_*.png c_*.png
    run 0 "$form on $ranks ranks" \
        launch "$ranks" "$PYTHON" "$HERE/python/insitu_movie.py" "$form"
    check "two frames" test -s f_00.png -a -s f_01.png
    run 0 "the tool draws the last field" "$TOOL" render last.npy -q -y \
        --spacing 1x1x1.5 -o tool.png -s 80x60 --view left --preset linear \
        --range 0,15 -c viridis --fit volume --background none --bits 16 \
        --no-labels
    run 0 "which is the last frame" "$TOOL" compare f_01.png tool.png \
        --tolerance 1.001/255
    run 6 "and not the first" "$TOOL" compare f_00.png tool.png \
        --tolerance 1.001/255
    run 0 "cells of two voxels are these" "$TOOL" compare c_00.png c_01.png \
        --tolerance 1.001/255
done

# The lines of the documents, as they stand.
sed -n '/^# needs files of a run: mpiexec/,/^```/p' "$HERE/../docs/python.md" |
    sed '$d' >movie.py
check "the documents have a movie" grep -q "movie.step" movie.py
run 0 "which runs" launch 2 "$PYTHON" movie.py
check "and writes its frames" test -s heat_0000.png -a -s heat_0009.png
finish
