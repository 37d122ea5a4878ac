#!/usr/bin/env bash
# Run by conda-build in the sources.
set -euo pipefail
# shellcheck disable=SC2086,SC2154  # CMAKE_ARGS is a list of words, of conda
cmake -G Ninja -S . -B build ${CMAKE_ARGS-} \
    -DCMAKE_BUILD_TYPE=Release -DBUILD_TESTING=OFF \
    -DSNOW_MPI=OFF -DSNOW_CATALYST=OFF -DSNOW_SERVE=OFF -DSNOW_PYTHON=ON \
    -DPython3_EXECUTABLE="$PYTHON" -DSNOW_PYTHON_DIR="${SP_DIR#"$PREFIX"/}"
cmake --build build
cmake --install build --prefix "$PREFIX"
