#!/usr/bin/env bash
# Installs the library aside and builds an example against it as a stranger
# would: installed.sh BUILD-FOLDER EXAMPLE.c
set -euo pipefail
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT

cmake --install "$1" --prefix "$place" >"$place/log"
export PKG_CONFIG_PATH LD_LIBRARY_PATH
PKG_CONFIG_PATH=$(dirname "$(find "$place" -name snowglass.pc)")
LD_LIBRARY_PATH=$(dirname "$PKG_CONFIG_PATH")
# The words of pkg-config are separate arguments.
# shellcheck disable=SC2046
"${CC:-cc}" -std=c11 "$2" -o "$place/program" \
    $(pkg-config --define-variable=prefix="$place" --cflags --libs snowglass)
"$place/program" "$place/picture.png"
[ -s "$place/picture.png" ]

# The archive, with all that it needs.
archive=$(find "$place" -name libsnowglass.a)
# shellcheck disable=SC2046
"${CC:-cc}" -std=c11 "$2" -o "$place/static" \
    $(pkg-config --define-variable=prefix="$place" --static --cflags --libs \
        snowglass | sed "s|-lsnowglass|$archive|")
LD_LIBRARY_PATH='' "$place/static" "$place/again.png"
cmp "$place/picture.png" "$place/again.png"
