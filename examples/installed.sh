#!/usr/bin/env bash
# Installs the library aside and builds an example against it as a stranger
# would: installed.sh BUILD-FOLDER EXAMPLE.c
set -euo pipefail
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT

cmake --install "$1" --prefix "$place/first" >"$place/log"
mkdir "$place/out"
out=$place/out
find_in() { (cd "$place/$1" && find . -name "$2" | head -1); }
libraries=$(dirname "$(dirname "$(find_in first snowglass.pc)")")
export PKG_CONFIG_PATH LD_LIBRARY_PATH
PKG_CONFIG_PATH=$place/first/$libraries/pkgconfig
LD_LIBRARY_PATH=$place/first/$libraries
# The words of pkg-config are separate arguments.
# shellcheck disable=SC2046
"${CC:-cc}" -std=c11 "$2" -o "$out/program" \
    $(pkg-config --define-variable=prefix="$place/first" --cflags --libs \
        snowglass)
"$out/program" "$out/picture.png"
[ -s "$out/picture.png" ]

# The archive, with all that it needs.
archive=$(find "$place" -name libsnowglass.a)
# shellcheck disable=SC2046
"${CC:-cc}" -std=c11 "$2" -o "$out/static" \
    $(pkg-config --define-variable=prefix="$place/first" --static --cflags \
        --libs snowglass | sed "s|-lsnowglass|$archive|")
LD_LIBRARY_PATH='' "$out/static" "$out/again.png"
cmp "$out/picture.png" "$out/again.png"

# Libraries that are loaded when needed: the shared library finds its modules,
# also when it has been moved, and the archive needs none.
module=$(find_in first libsnowglass-tiff.so)
[ -n "$module" ] || exit 0
"$out/program" "$out/first.tif"
mv "$place/first" "$place/second"
LD_LIBRARY_PATH=$place/second/$libraries
"$out/program" "$out/second.tif"
cmp "$out/first.tif" "$out/second.tif"
cd "$place/second"
LD_LIBRARY_PATH=$libraries "$out/program" "$out/relative.tif"
cmp "$out/first.tif" "$out/relative.tif"
rm "$module"
if "$out/program" "$out/third.tif" 2>"$out/said"; then
    echo "there is no module, and it is loaded"
    exit 1
fi
grep -q "is not in $(realpath "$(dirname "$module")"); reinstall" "$out/said"
[ ! -e "$out/third.tif" ]
LD_LIBRARY_PATH='' "$out/static" "$out/third.tif"
cmp "$out/first.tif" "$out/third.tif"
