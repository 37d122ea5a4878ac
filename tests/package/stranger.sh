#!/bin/bash
# tests/package/stranger.sh - sourced by package_*.sh after a line of `. shell.sh`:
# the library is installed aside and moved, and the folders of its sources and its
# build are hidden, so that the rest of the script is a stranger to both.
#
#   script TOOL BUILD SOURCE
#
# After `hide_project` $PREFIX is the moved tree, $LIB its folder of libraries.
# Where a name space of its own is refused, the folders stay visible.
export BUILD=$2 SOURCE=$3
unset PKG_CONFIG_PATH PKG_CONFIG_LIBDIR LD_LIBRARY_PATH LIBRARY_PATH CPATH CPLUS_INCLUDE_PATH \
    C_INCLUDE_PATH CMAKE_PREFIX_PATH DESTDIR LDFLAGS CFLAGS
CC=${CC:-cc}

# Mounts can be made by root, and by whoever may have a user name space.
if [ -z "${SNOW_HIDES-}" ]; then
    for way in -m -rm; do
        if unshare $way sh -c "mount -t tmpfs none '$WORK'" 2>/dev/null; then
            rm -rf "$WORK"
            cd "$HERE/package" || exit 1
            SNOW_HIDES=yes exec unshare $way bash "${0##*/}" "$TOOL" "$BUILD" \
                "$SOURCE"
        fi
    done
    SNOW_HIDES=no
    echo "note: no name space: the source tree stays visible"
fi

install_project() {
    cmake --install "$BUILD" --prefix "$WORK/first" >"$WORK/log" 2>&1 ||
        { cat "$WORK/log" && exit 1; }
}

# hide_project FILE...: of the project these alone are seen, in $WORK.
hide_project() {
    local file
    install_project
    mv first second
    PREFIX=$WORK/second
    LIB=$(dirname "$(dirname "$(find "$PREFIX" -name snowglass.pc)")")
    for file; do cp -r "$SOURCE/$file" .; done
    if [ "$SNOW_HIDES" = yes ]; then
        mount -t tmpfs none "$SOURCE"
        case $BUILD in
        "$SOURCE"/*) ;;
        *) mount -t tmpfs none "$BUILD" ;;
        esac
        [ ! -e "$SOURCE/include" ] || { echo "the sources show" && exit 1; }
    fi
}

# The programs' pictures are one and the same.
same_picture() {
    [ -e picture.png ] || cp "$1" picture.png
    cmp picture.png "$1"
}

# Runs a program, which finds the shared library in $1 ("": nowhere).
draws() { LD_LIBRARY_PATH=$1 "$2" "$3.png" && same_picture "$3.png"; }

needs_no_snowglass() {
    readelf -d "$1" >needed && ! grep -q 'NEEDED.*libsnowglass' needed
}
