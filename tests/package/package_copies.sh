#!/usr/bin/env bash
# tests/package/package_copies.sh - `script TOOL BUILD SOURCE`: two copies of the
# shared library in one process, of two versions, do not disturb each other.
. "$(dirname "$0")/../support/shell.sh"
BUILD=$(realpath "$2")
SOURCE=$(realpath "$3")
need_modules
"$TOOL" phantom head --dims 32x32x32 -q -o head.nrrd
mkdir one two
for folder in one two; do
    cp -r "$BUILD"/libsnowglass.so.*.*.* "$BUILD"/snowglass-?.? $folder
done
first=$(echo "$WORK"/one/libsnowglass.so.*) second=$(echo "$WORK"/two/libsnowglass.so.*)
# Another version is as long a text.
version=$("$TOOL" --version | sed 's/.* //')
other=${version%.*}.$(((${version##*.} + 1) % 10))
LC_ALL=C sed -i "s/${version//./[.]}\x00/$other\x00/g" "$second"
run 0 "a program loads both" cc -std=c11 -D_POSIX_C_SOURCE=200809L \
    -I"$SOURCE/include" "$HERE/package/two_copies.c" -pthread -ldl -o two_copies
for way in "" global; do
    run 0 "they draw in turns and at once${way:+, one $way}" \
        ./two_copies "$first" "$second" head.nrrd $way
    prints "^$version $other$"
done
run 1 "one alone is not two" ./two_copies "$first" "$first" head.nrrd
says "these are two copies"
# Of a file that modules read each copy takes those beside itself.
if [ -e "$(echo one/snowglass-*/libsnowglass-tiff.so)" ]; then
    run 0 "modules are loaded twice" ./two_copies "$first" "$second" \
        "$SOURCE/fuzz/corpus/tiff/tiles"
fi
finish
