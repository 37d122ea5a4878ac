#!/usr/bin/env bash
# tests/package/package_pkgconfig.sh - `script TOOL BUILD SOURCE`: a program is
# built by pkg-config against the installed, moved library, shared and static.
. "$(dirname "$0")/../support/shell.sh"
. "$HERE/package/stranger.sh"
hide_project examples tests/package/snippets/frames/picture.c
program=examples/minimal.c

# What pkg-config says of ours, where it finds no package but ours.
alone() { PKG_CONFIG_LIBDIR=$LIB/pkgconfig pkg-config "$@"; }
# The words of pkg-config are separate arguments.
compile() { # SOURCE PROGRAM PKG-CONFIG...
    local source=$1 out=$2
    shift 2
    "$CC" -std=c11 "$source" -o "$out" $("$@")
}
names_one_folder() {
    local line
    line=$(alone --cflags "$1" | sed "s/ *$//") &&
        [ "$(realpath "${line#-I}")" = "$PREFIX/include" ]
}
no_path_of() { ! grep -rIlE "$1" "$LIB/pkgconfig" "$LIB/cmake"; }

check "no file tells where it was made or put" \
    no_path_of "$SOURCE|$BUILD|$WORK|/usr/local"
check "libraries are words for the linker" \
    no_path_of '^Libs.*/[^ ]*[.]so( |$)'
for name in snowglass snowglass-static snowglass-recipe snowglass-recipe-static; do
    check "$name: one folder of headers" names_one_folder $name
done

check "shared: builds" compile $program shared alone --cflags --libs snowglass
check "shared: draws" draws "$LIB" ./shared shared
check "shared: links ours alone" grep -Eqx -- '-L[^ ]* -lsnowglass *' \
    <(alone --libs snowglass)

# The program in the comment of snowglass.h, in the frame that has its main.
commented() {
    sed -n '/^ \*\//q;s/^ \*   //p' "$PREFIX/include/snowglass/snowglass.h" >text
    sed -e '/SNIPPET/{r text' -e 'd;}' picture.c >commented.c
    compile commented.c commented alone --cflags --libs snowglass
}
check "the program in snowglass.h: builds" commented
check "the program in snowglass.h: draws" draws "$LIB" ./commented commented

# Headers without a warning: $1 is the compiler, of the lines that are read.
strictly() {
    $1 -Wall -Wextra -Wpedantic -Wconversion -Werror -fsyntax-only \
        -I"$PREFIX/include" -
}
mapfile -t headers < <(cd "$PREFIX/include" && find snowglass -name '*.h' \
    ! -name mpi.h | sort)
included() { printf '#include <%s>\n' "$@"; }
alone_and_twice() {
    local header
    for header in "${headers[@]}"; do
        included "$header" "$header" | strictly "$1" || return 1
    done
}
in_both_orders() { # of each two headers
    included "${headers[@]}" | strictly "$1" &&
        included "${headers[@]}" | tac | strictly "$1"
}
check "there are headers" [ ${#headers[@]} -gt 12 ]
CXX=${CXX:-c++}
for compiler in "$CC -xc -std=c11" "$CC -xc -std=c17" "$CXX -xc++ -std=c++17"; do
    if ! command -v ${compiler%% *} >/dev/null; then
        skipped "headers by $compiler" "there is no such compiler"
        continue
    fi
    check "${compiler##*=}: each header alone" alone_and_twice "$compiler"
    check "${compiler##*=}: headers in any order" in_both_orders "$compiler"
done

check "static: builds" compile $program static \
    alone --cflags --libs snowglass-static
check "static: draws" draws "" ./static static
check "static: needs no library of ours" needs_no_snowglass ./static

cat >recipe.c <<'END'
#include <snowglass/recipe.h>
#include <snowglass/snowglass.h>
#if SNOWGLASS_VERSION_NUMBER < 1000 || SNOWGLASS_VERSION_NUMBER >= 1000000000
#error "no version"
#endif
int main(void) {
    snow_context *context = NULL;
    snow_recipe recipe = {.size = sizeof recipe};
    return snow_context_new(NULL, &context) ||
           !snow_recipe_load(context, "nowhere.json", &recipe);
}
END
check "recipe: builds" compile recipe.c recipe \
    alone --cflags --libs snowglass-recipe
check "recipe: runs" env LD_LIBRARY_PATH="$LIB" ./recipe
check "recipe: the archives build" compile recipe.c recipe-static \
    alone --cflags --libs snowglass-recipe-static
check "recipe: the archives run" ./recipe-static
check "recipe: need no library of ours" needs_no_snowglass ./recipe-static

if [ -e "$LIB/pkgconfig/snowglass-mpi.pc" ]; then
    cat >ranks.c <<'END'
#include <snowglass/mpi.h>
#include <snowglass/snowglass.h>
int main(int argc, char **argv) {
    snow_context *context = NULL;
    snow_comm *comm = NULL;
    MPI_Init(&argc, &argv);
    int wrong = snow_context_new(NULL, &context) ||
                snow_comm_new_mpi(context, MPI_COMM_WORLD, &comm) ||
                snow_comm_size(comm) != 1;
    snow_comm_free(comm);
    snow_context_free(context);
    MPI_Finalize();
    return wrong;
}
END
    # The compiler that the package names.
    CC=$(sed -n 's/^Description:.*compile with //p' "$LIB/pkgconfig/snowglass-mpi.pc")
    export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
    check "mpi: builds with $CC" compile ranks.c ranks \
        alone --cflags --libs snowglass-mpi
    check "mpi: runs" env LD_LIBRARY_PATH="$LIB" ./ranks
    check "mpi: the archives build" compile ranks.c ranks-static \
        alone --cflags --libs snowglass-mpi-static
    check "mpi: the archives run" ./ranks-static
    check "mpi: need no library of ours" needs_no_snowglass ./ranks-static
fi
finish
