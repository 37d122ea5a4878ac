#!/usr/bin/env bash
# tests/package/package_uninstall.sh - `script TOOL BUILD SOURCE`: what is removed
# after cmake --install, and what is not.
. "$(dirname "$0")/../support/shell.sh"
BUILD=$2 SOURCE=$3
place=prefix/lib/python3/site-packages
mkdir -p $place/snowglass/web $place/snowglass/__pycache__ prefix/share/doc/snowglass \
    prefix/bin build

# As an installed package is after it was used, beside another one.
for file in bin/snowglass share/doc/snowglass/LICENSE ${place#prefix/}/snowglass/__init__.py \
    ${place#prefix/}/snowglass/_arrays.py "${place#prefix/}/snowglass/web/a page.js"; do
    echo "x = 1" >"prefix/$file"
    echo "$WORK/prefix/$file"
done >build/install_manifest.txt
printf '<>\n%s\n' "$WORK/prefix" >build/install_manifest.txt.root
cp -r build again
echo "x = 2" >$place/other.py
PYTHONDONTWRITEBYTECODE='' python3 -m compileall -q $place || exit 1
check "bytecode lies beside the modules" [ -n "$(find $place/snowglass -name '*.pyc')" ]
cp -r prefix old

remove() { cmake -DBUILD="$WORK/$1" -P "$SOURCE/cmake/uninstall.cmake"; }
run 0 "it is uninstalled" remove build
check "nothing of it is left" [ -z "$(find prefix -name '*snowglass*')" ]
(cd $place && python3 -B -c 'import snowglass') 2>said
check "Python does not find it" grep -q "ModuleNotFoundError" said
(cd $place && python3 -B -c 'import other')
check "another package stays" [ $? = 0 ]
check "folders of others stay, though they are empty" [ -d prefix/bin ]
check "bytecode of others stays" [ -n "$(find $place/__pycache__ -name 'other.*.pyc')" ]

# With a file of somebody else in its folder, below another root; the same names
# without that root are another copy's, which stays.
cp -r old prefix.live
mkdir root && mkdir -p "root$WORK" && mv old "root$WORK/prefix" && mv prefix prefix.rest
mv prefix.live prefix
touch "root$WORK/$place/snowglass/notes.txt"
mkdir -p "root$WORK/prefix/share/snowglass/web" # CMake makes it of an optional file
printf '<%s>\n%s\n' "$WORK/root" "$WORK/prefix" >again/install_manifest.txt.root
DESTDIR=$WORK/elsewhere run 1 "another root is refused" remove again
check "and named" grep -qF "'$WORK/root/'" "$ERR"
run 0 "it is uninstalled below its root" remove again
check "what was not installed stays" [ -e "root$WORK/$place/snowglass/notes.txt" ]
check "and nothing else of it" [ "$(find root -path '*/snowglass/*')" = \
    "root$WORK/$place/snowglass/notes.txt" ]
check "nor an empty folder" [ ! -e "root$WORK/prefix/share/snowglass" ]
check "what lies elsewhere stays" [ -e prefix/bin/snowglass ]
run 1 "a list is used once" remove again

mkdir old_list && echo /nowhere/file >old_list/install_manifest.txt
run 1 "a list without a root is refused" remove old_list
check "with the reason" grep -q "install once more" "$ERR"

# As CMake writes it.
DESTDIR=$WORK/stage cmake --install "$BUILD" --prefix /y --component snowglass_runtime \
    >log 2>&1 || cat log
mkdir taken && mv "$BUILD"/install_manifest_snowglass_runtime.txt* taken
check "files are staged" [ -x stage/y/bin/snowglass ]
run 0 "they are uninstalled without DESTDIR" remove taken
check "none is left" [ -z "$(find stage ! -type d)" ]
check "nor a folder of ours" [ -z "$(find stage -name 'snowglass*')" ]

mkdir empty
run 1 "a folder that installed nothing is refused" remove empty
check "with the reason" grep -q "nothing was" "$ERR"
cmake --build "$BUILD" --target help >targets
check "the build has it as a target" grep -q "uninstall" targets
finish
