#!/usr/bin/env bash
# tests/package/package_layout.sh - `script TOOL BUILD SOURCE`: what is
# installed, by which component, and how installed files find one another.
. "$(dirname "$0")/../support/shell.sh"
. "$HERE/package/stranger.sh"
driver=$(find "$BUILD/tests/catalyst" -name catalyst_driver)
conduit=$(find "$BUILD/tests/catalyst" -name 'libconduit_stub.so')
cp "$driver" driver
cp "$conduit" .

# --- components ---------------------------------------------------------------

component() {
    cmake --install "$BUILD" --prefix "$WORK/$1" --component "snowglass_$1" \
        >"$WORK/log" 2>&1 || cat "$WORK/log"
    mkdir -p "$WORK/$1" # not everything is built
    (cd "$WORK/$1" && find . ! -type d | sort) >"$1.files"
}
install_project
(cd first && find . ! -type d | sort) >all.files
for name in runtime dev mpi python doc; do component $name; done
has() { grep -Eq "$2" "$1.files"; }
lacks() { ! has "$@"; }
check "runtime has the tool" has runtime '/bin/snowglass$'
check "runtime has the library" has runtime '/libsnowglass[.]so[.][0-9.]+$'
check "runtime has the licence" has runtime '/LICENSE$'
check "runtime has no headers" lacks runtime '[.](h|a|pc|cmake)$|libsnowglass[.]so$'
check "dev has headers" has dev '/snowglass/snowglass[.]h$'
check "dev has the module for Fortran" has dev '/snowglass/snowglass[.]f90$'
check "dev has packages" has dev '/snowglass-config[.]cmake$'
check "dev has no programs" lacks dev '/bin/|[.]so[.]|/mpi[.]h$|-mpi'
check "doc has the README" has doc '/README[.]md$'
check "doc has the guide" has doc '/docs/usage[.]md$'
check "doc has an example" has doc '/examples/minimal[.]c$'
check "mpi has all that is of MPI" \
    [ "$(grep -E -- '/mpi[.]h$|-mpi|/_insitu[.].*so$' all.files)" = "$(cat mpi.files)" ]
check "each file belongs to one component" \
    [ "$(cat {runtime,dev,mpi,python,doc}.files | sort)" = \
    "$(cat all.files)" ]

# --- hardening: files of programs and libraries, as SECURITY.md promises ------

programs=$(find runtime mpi python -type f -exec sh -c \
    'head -c 4 "$1" | grep -q ELF' sh {} \; -print)
# What readelf prints of each program or library fits the pattern.
all_have() {
    local file bad=0
    for file in $programs; do
        readelf -W -h -l -d -s "$file" >elf
        grep -Eq "$1" elf || { echo "       $file has no $1"; bad=1; }
    done
    return $bad
}
hardened() {
    check "programs and libraries may lie at any address" \
        all_have 'Type: +DYN'
    check "their tables are read-only" all_have GNU_RELRO
    check "all of them, before main" all_have 'BIND_NOW|FLAGS.* NOW'
    check "no stack of theirs is for code" all_have 'GNU_STACK .* RW '
    check "the tool checks its stack" grep -q __stack_chk_fail elf.tool
    check "the tool checks its copies" grep -Eq '__[a-z]+_chk' elf.tool
}
readelf -W -s "$(find runtime -path "*/bin/snowglass")" >elf.tool
if grep -q 'SNOW_HARDEN:BOOL=ON' "$BUILD/CMakeCache.txt" &&
    grep -q 'CMAKE_BUILD_TYPE:STRING=Release' "$BUILD/CMakeCache.txt"; then
    hardened
fi
rm -rf first runtime dev mpi python doc

# --- where they find one another ----------------------------------------------

cmake --install "$BUILD" --prefix "$WORK/first" --component snowglass_test \
    >"$WORK/log" 2>&1 || cat "$WORK/log"
hide_project examples/minimal.c
finds_ours() { # FILE LIBRARY: the loader takes it from the moved tree
    ldd "$1" | grep -q "$2.*=> $PREFIX/"
}
check "the library of recipes finds the library" \
    finds_ours "$LIB/libsnowglass-recipe.so" libsnowglass.so
if [ -e "$LIB/libsnowglass-mpi.so" ]; then
    check "that of MPI does" finds_ours "$LIB/libsnowglass-mpi.so" libsnowglass.so
fi
plugin=$LIB/catalyst/libcatalyst-snowglass.so
check "the Catalyst implementation does" finds_ours "$plugin" libsnowglass.so
"$PREFIX/bin/snowglass" phantom shells -q -o field.npy
echo '{"input": "grid/v", "output": "f_%02d.png"}' >look.json
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
run 0 "and makes pictures of a simulation" env LD_LIBRARY_PATH="$WORK" \
    ./driver "$plugin" look.json vertex field.raw
check "which are there" is_png f_00.png

versioned() {
    nm -D --defined-only "$1" >symbols && grep ' T ' symbols >functions &&
        ! grep -v '@@SNOWGLASS_[0-9.]*$' functions
}
for library in "$LIB"/libsnowglass*.so; do
    check "${library##*/}: each function has a version" versioned "$library"
done

if command -v gfortran >/dev/null; then
    run 0 "the module for Fortran compiles" gfortran -c -o module.o \
        "$PREFIX/include/snowglass/snowglass.f90"
else
    skipped "the module for Fortran" "there is no gfortran"
fi

# Libraries that are loaded when needed: the shared library finds its modules,
# also when it is named relative to the current folder, and the tool does too.
module=$(find "$LIB" -name libsnowglass-tiff.so)
[ -n "$module" ] || finish
"$CC" minimal.c -I"$PREFIX/include" -L"$LIB" -lsnowglass -o program
draw_with() { LD_LIBRARY_PATH=$1 ./program "$2"; }
run 0 "a module is loaded" draw_with "$LIB" first.tif
run 0 "by a relative name too" draw_with "$(realpath --relative-to=. "$LIB")" \
    second.tif
check "and gives the same" cmp first.tif second.tif
run 0 "the tool loads it" "$PREFIX/bin/snowglass" phantom:head -q -s 32x32 -o t.tif
rm "$module"
run 2 "one that is missing is named" draw_with "$LIB" third.tif
says "is not in $(realpath "$(dirname "$module")"); reinstall"
check "and no picture is left" [ ! -e third.tif ]
finish
