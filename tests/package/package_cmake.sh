#!/usr/bin/env bash
# tests/package/package_cmake.sh - `script TOOL BUILD SOURCE`: a project finds
# the installed, moved library by find_package, shared and static.
. "$(dirname "$0")/../support/shell.sh"
. "$HERE/package/stranger.sh"
hide_project tests/package/consumer examples

configure() { # FOLDER OPTION...
    local folder=$1
    shift
    cmake -S consumer -B "$folder" -DPROGRAM="$WORK/examples/minimal.c" \
        -DCMAKE_PREFIX_PATH="$PREFIX" "$@"
}
# With the package alone: whatever else it looks for is not there.
shared_alone() {
    configure shared -DPKG_CONFIG_EXECUTABLE=/bin/false \
        -DCMAKE_DISABLE_FIND_PACKAGE_{ZLIB,PNG,PkgConfig,Threads,MPI}=ON
}
build() { cmake --build "$1"; }

run 0 "shared: is found, and looks for nothing else" shared_alone
run 0 "shared: builds" build shared
check "shared: draws" draws "" shared/program shared
run 0 "the example: is found" cmake -S examples/cmake -B example \
    -DCMAKE_PREFIX_PATH="$PREFIX"
run 0 "the example: builds" build example
check "the example: draws" draws "" example/picture example
check "the example is installed" \
    [ -n "$(find "$PREFIX" -path '*/examples/cmake/CMakeLists.txt')" ]
check "CMake files of the others are not" \
    [ -z "$(find "$PREFIX" -path '*/examples/insitu/CMakeLists.txt')" ]
run 0 "static: is found" configure static -DPARTS=static
run 0 "static: builds" build static
check "static: draws" draws "" static/program static
check "static: needs no library of ours" needs_no_snowglass static/program
run 0 "recipe: is found" configure recipe -DPARTS='recipe;static'
run 0 "recipe: builds, shared and static" build recipe
if [ -e "$LIB/libsnowglass-mpi.so" ]; then
    run 0 "mpi: is found" configure mpi -DPARTS='mpi;static'
    run 0 "mpi: builds, shared and static" build mpi
fi
run 0 "its own series is taken" configure series -DVERSION=0.1
run 1 "another series is not" configure other -DVERSION=0.2
run 1 "a component that there is not" configure unknown -DPARTS=viewer
says "there is no component 'viewer'"
# As if the package of one library were not there.
run 1 "a library that is missing is named" env PKG_CONFIG_LIBDIR="$WORK" \
    cmake -S consumer -B missing -DPROGRAM="$WORK/examples/minimal.c" -DPARTS=static \
    -DCMAKE_PREFIX_PATH="$PREFIX" -DPKG_CONFIG_USE_CMAKE_PREFIX_PATH=OFF
says "archive needs"
finish
