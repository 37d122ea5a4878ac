#!/bin/bash
# Libraries that few files need lie in modules, which are loaded for these files
# alone, found beside the tool wherever it is moved to, and refused when they
# are not what they should be.
. "$(dirname "$0")/../../support/shell.sh"

need_modules
BUILD=$(dirname "$TOOL")
CORPUS=$HERE/../fuzz/corpus
FOLDER=$(basename "$(find "$BUILD" -maxdepth 1 -name "snowglass-[0-9]*")")
if [ ! -e "$BUILD/$FOLDER/libsnowglass-tiff.so" ]; then
    skipped all "this build has no modules"
    exit 77
fi
export LC_ALL=C

# The heavy libraries and modules that a command loads, into $LOADED.
loaded() {
    rm -f ld.*
    LD_DEBUG=files LD_DEBUG_OUTPUT=ld "$@" >"$OUT" 2>"$ERR"
    LOADED=$(cat ld.* | grep 'calling init' | tr -c 'a-zA-Z0-9\n-' '\n' |
        grep -E '^lib(snowglass-.*|hdf5.*|tiff|gdcm.*|curl|blosc|snappy)$' |
        sort -u | tr '\n' ' ')
}
loads_none() {
    loaded "$@"
    [ "$(cat ld.* | wc -l)" -gt 0 ] && [ -z "$LOADED" ]
}
# loads LIBRARY COMMAND...: of the heavy ones that, and its module.
loads() {
    local library=$1
    shift
    loaded "$@"
    [ "$LOADED" = "libsnowglass-${library#lib} $library " ]
}

render() {
    "$1" render -q phantom:head --dims 24x24x24 -s 60x50 --no-labels -y -o "$2"
}

"$TOOL" phantom head --dims 24x24x24 -q -o a.nrrd
gzip -dc <"$CORPUS/hdf5/gzip" >a.h5 2>/dev/null || cp "$CORPUS/hdf5/gzip" a.h5
cp "$CORPUS/dicom/jpegls_little" a.dcm
run 0 "a TIFF picture is written" render "$TOOL" a.tif

check "a start loads no module" loads_none "$TOOL" --version
check "a picture of a phantom neither" loads_none render "$TOOL" a.png
check "nor does that of a file" \
    loads_none "$TOOL" render -q a.nrrd -s 60x50 -y -o b.png
check "it is there" is_png b.png
check "nor does DICOM that is not packed" \
    loads_none "$TOOL" info -q "$CORPUS/dicom/little"
check "nor what tells of the build" loads_none "$TOOL" doctor
check "nor help on data" loads_none "$TOOL" help data
ZARR=$DATA/formats/zarr/mni152.ome.zarr
if [ -d "$ZARR" ] && [ -e "$BUILD/$FOLDER/libsnowglass-blosc.so" ]; then
    # What libblosc brings with it is no business of ours.
    loaded "$TOOL" info -q "$ZARR"
    check "Zarr packed by Blosc loads libblosc alone" [ "${LOADED/libsnappy /}" \
        = "libblosc libsnowglass-blosc " ]
fi
check "a TIFF loads libtiff alone" loads libtiff "$TOOL" info -q a.tif
check "and so does writing one" loads libtiff render "$TOOL" a.tif

# A module of each kind, by the tool in $1.
reads_all() {
    local tool=$1 name
    for name in tif h5 dcm; do
        [ -e "$2/libsnowglass-$(module_of $name).so" ] || continue
        "$tool" info -q "a.$name" >"$OUT" 2>"$ERR" || return 1
    done
    render "$tool" b.tif && "$TOOL" compare -q a.tif b.tif >/dev/null
}
module_of() {
    case $1 in
    tif) echo tiff ;;
    h5) echo hdf5 ;;
    dcm) echo gdcm ;;
    esac
}
check "modules of the build folder are found" \
    reads_all "$TOOL" "$BUILD/$FOLDER"

# --- installed, and moved ----------------------------------------------------

run 0 "the project is installed" cmake --install "$BUILD" --prefix "$WORK/one"
MODULES=$(dirname "$(find one -name libsnowglass-tiff.so)")
check "its modules in a folder of their own" [ "$(basename "$MODULES")" = \
    "$FOLDER" ]
mv one two
MODULES=$WORK/two${MODULES#one}
MOVED=$WORK/two/bin/snowglass
check "a tool that was moved finds its modules" reads_all "$MOVED" "$MODULES"
ln -s "$MOVED" link
check "and so does a symbolic link to it" reads_all ./link "$MODULES"
PATH=$WORK/two/bin:$PATH
check "and its bare name" reads_all snowglass "$MODULES"
as_another() { (exec -a /nowhere/else "$MOVED" info -q a.tif) >"$OUT"; }
check "whatever its first argument is" as_another
# Of the two, the one that was moved was used, not the build folder's.
loaded "$MOVED" info -q a.tif
check "they are its own" grep -q "$MODULES/libsnowglass-tiff.so" ld.*

# --- what is refused ----------------------------------------------------------

TIFF=$MODULES/libsnowglass-tiff.so
cp "$TIFF" good.so
mkdir -p "$FOLDER"
cp good.so "$FOLDER/libsnowglass-tiff.so"
cp good.so libsnowglass-tiff.so

rm "$TIFF"
refused 3 "a module that is missing" \
    "^snowglass: a.tif: needs libsnowglass-tiff.so, which is not in .*two.*; reinstall" \
    "$MOVED" info a.tif
refused 2 "and is needed to write" 'b2.tif: needs libsnowglass-tiff.so' \
    render "$MOVED" b2.tif
check "nothing is written" absent b2.tif
printed "doctor has not got it" 'libtiff is missing' "$MOVED" doctor
check "nor among pictures" \
    sh -c "! grep -q 'picture outputs.* .tif' '$OUT'"
printed "nor as JSON" '"libtiff": null' "$MOVED" doctor --json
run 0 "all else goes on" render "$MOVED" c.png

head -c 3000 good.so >"$TIFF"
refused 3 "a module that is cut" 'is truncated or damaged; reinstall Snowglass' \
    "$MOVED" info a.tif
head -c $(($(wc -c <good.so) - 1)) good.so >"$TIFF"
refused 3 "and one that lacks a byte" 'is truncated or damaged' "$MOVED" info a.tif
: >"$TIFF"
refused 3 "and one that is empty" 'is truncated or damaged' "$MOVED" info a.tif
echo 'This is not a shared object, but some text of more than 64 bytes.' >"$TIFF"
refused 3 "and a text" 'is truncated or damaged' "$MOVED" info a.tif
rm "$TIFF" && mkdir "$TIFF"
refused 3 "and a folder" 'is truncated or damaged|cannot be loaded' \
    "$MOVED" info a.tif
rmdir "$TIFF"

# Its library is not there: the name in the module is changed.
sed 's/libtiff\.so\./libtifX.so./g' good.so >"$TIFF"
refused 3 "a module whose library is missing" \
    'cannot be loaded \(libtifX.so.*\); install the missing library' \
    "$MOVED" info a.tif
sed 's/snow_module_parts/snow_module_PARTS/g' good.so >"$TIFF"
refused 3 "another program's module" 'cannot be loaded' "$MOVED" info a.tif
STAMP=$(grep -aoE '[0-9.]+-[0-9a-f]{16}' good.so | head -1)
sed "s/$STAMP/$(echo "$STAMP" | tr 0-9a-f 1-9a-f0)/g" good.so >"$TIFF"
refused 3 "one of another build" "is of another build, .* instead of" \
    "$MOVED" info a.tif

cp good.so "$TIFF"
chmod o+w "$TIFF"
refused 3 "one that anyone may change" 'other users could change' \
    "$MOVED" info a.tif
chmod o-w "$TIFF"
chmod o+w "$MODULES"
refused 3 "and one that anyone may replace" 'other users could change' \
    "$MOVED" info a.tif
chmod o-w "$MODULES"
if [ "$(id -u)" -eq 0 ] && chown 12345 "$TIFF" 2>/dev/null; then
    refused 3 "and one of a stranger's" 'other users could change' \
        "$MOVED" info a.tif
    chown 0 "$TIFF"
fi
# A group that is neither root's nor one that may change the program.
if [ "$(id -u)" -ne 0 ] || chgrp 12345 "$TIFF" 2>/dev/null; then
    chmod g+w "$TIFF"
    chmod g-w "$MOVED"
    refused 3 "and one that a group may change" 'other users could change' \
        "$MOVED" info a.tif
    chgrp "$(stat -c %g "$TIFF")" "$MOVED"
    chmod g+w "$MOVED"
    check "but not where it may change the program too" \
        reads_all "$MOVED" "$MODULES"
    chmod g-w "$MOVED"
    chgrp "$(id -g)" "$MOVED"
    if [ "$(id -u)" -eq 0 ]; then
        chgrp 0 "$TIFF"
        check "or is root's" reads_all "$MOVED" "$MODULES"
    fi
    chmod g-w "$TIFF"
fi
check "once all is well again it is loaded" reads_all "$MOVED" "$MODULES"

# --- threads -------------------------------------------------------------------

if [ -x "$BUILD/tests/modules_threads" ]; then
    files=(a.tif)
    [ -e "$BUILD/$FOLDER/libsnowglass-gdcm.so" ] && files+=(a.dcm)
    run 0 "many threads load modules at once" \
        "$BUILD/tests/modules_threads" "${files[@]}"
    run 1 "and are told of what fails" "$BUILD/tests/modules_threads" \
        "${files[@]}" "$CORPUS/tiff/cut"
fi
finish
