# core.sh - the library without formats/: `core.sh LIBRARY PROGRAM`.
#
# It links zlib and libpng and the system's own, and the program, which makes a
# picture of an array in memory, needs no more.
set -u
library=$1
program=$2
command -v readelf >/dev/null || { echo "no readelf: skipped" && exit 77; }
needed=$(readelf -d "$library" | sed -n 's/.*NEEDED.*\[\(.*\)\]/\1/p')
echo "$library needs:" $needed
for name in $needed; do
    case $name in
    libz.so.* | libpng16.so.* | libc.so.* | libm.so.* | libpthread.so.*) ;;
    ld-linux* | ld-musl* | libc.musl* | libgcc_s.so.*) ;;
    *)
        echo "the core needs $name: only zlib and libpng are its own"
        exit 1
        ;;
    esac
done
for name in libz libpng16; do
    case $needed in
    *$name.so*) ;;
    *)
        echo "the core does not need $name: is this the library?"
        exit 1
        ;;
    esac
done
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
"$program" "$folder/array.png" || exit 1
[ "$(head -c 4 "$folder/array.png" | tail -c 3)" = PNG ] ||
    { echo "no PNG was written" && exit 1; }
