#!/usr/bin/env bash
# tests/package/package_within.sh - `script TOOL BUILD SOURCE`: the sources are
# part of another project (add_subdirectory), whose settings they leave alone;
# and a program without any shared library is built over the core.
. "$(dirname "$0")/../support/shell.sh"
. "$HERE/package/stranger.sh"
mkdir snowglass
cp -r "$SOURCE"/{CMakeLists.txt,README.md,LICENSE,CHANGELOG.md,CONTRIBUTING.md} \
    "$SOURCE"/{bench,bindings,cmake,docs,examples,fuzz,include,programs,python,scripts,src} \
    snowglass
. "$HERE/package/compiled.sh" snowglass
hide_project tests/package/within examples/minimal.c examples/array.c

built=snowglass/built
configure() {
    cmake -S within -B "$1" -DSNOWGLASS="$WORK/snowglass" \
        -DPROGRAM="$WORK/minimal.c" -DCMAKE_BUILD_TYPE="$2"
}
run 0 "it is added" configure $built Release
run 0 "it is built" cmake --build $built -j 2
grep -E 'error|undefined' "$ERR"
check "shared: draws" draws "" $built/out/shared shared
check "static: draws" draws "" $built/out/static static
check "static: needs no library of ours" needs_no_snowglass $built/out/static
run 0 "it is added to one without a build type" configure plain ""
check "the build type is the project's own" \
    grep -q '^CMAKE_BUILD_TYPE:STRING=$' plain/CMakeCache.txt
check "its tests are not the project's" \
    [ -z "$(grep BUILD_TESTING $built/CMakeCache.txt)" ]
run 0 "the project is installed" cmake --install $built --prefix "$WORK/third"
check "of the library nothing is" [ -z "$(find third -type f 2>/dev/null)" ]

# The core needs zlib and libpng, whose archives are in every system.
archives() { for name in "$@"; do "$CC" -print-file-name="lib$name.a"; done; }
if archives png z m c | grep -qv /; then
    skipped "a program without shared libraries" "an archive is missing"
else
    run 0 "the core is configured" cmake -S snowglass -B snowglass/core \
        -DSNOW_FORMATS=OFF -DBUILD_TESTING=OFF -DSNOW_MPI=OFF \
        -DSNOW_PYTHON=OFF -DCMAKE_BUILD_TYPE=Release
    run 0 "the core is built" cmake --build snowglass/core -j 2
    run 0 "the core is installed" cmake --install snowglass/core --prefix "$WORK/fourth"
    export PKG_CONFIG_PATH
    PKG_CONFIG_PATH=$(dirname "$(find fourth -name snowglass.pc)")
    run 0 "pkg-config --static is for cc -static" "$CC" -std=c11 -static \
        array.c -o alone $(pkg-config --static --cflags --libs snowglass)
    run 0 "so is the archive's package" "$CC" -std=c11 -static array.c \
        -o alone $(pkg-config --static --cflags --libs snowglass-static)
    run 0 "the program runs" ./alone array.png
    check "and makes a picture" is_png array.png
    check "it needs no shared library" [ -z "$(readelf -d alone |
        grep NEEDED)" ]
fi
finish
