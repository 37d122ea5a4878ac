#!/bin/bash
# emulated.sh neon|wasm FOLDER: builds same_bits.c with the core for another
# machine, in FOLDER, and runs it: NEON under QEMU, WebAssembly in Node.  What
# reads and writes files is left out, since its libraries are not there.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
root=$here/../..
level=$1
out=$2/$level

skip() {
    echo "skipped: $1 is not installed"
    exit 77
}

flags=(-std=gnu11 -O2 "-DSNOW_VERSION=\"0\"" -ffp-contract=off
       -fno-math-errno -fno-trapping-math "-I$root/include" "-I$root/src")
case $level in
neon)
    compiler=(aarch64-linux-gnu-gcc) archiver=aarch64-linux-gnu-ar
    link=(-static -Wl,--unresolved-symbols=ignore-all -lm -lpthread)
    program=$out/same_bits run=(qemu-aarch64)
    ;;
wasm)
    compiler=(emcc -msimd128) archiver=emar
    link=(-O1 -s ERROR_ON_UNDEFINED_SYMBOLS=0 -s ALLOW_MEMORY_GROWTH=1)
    # Node's fetch takes a path for a wrong address.
    program=$out/same_bits.js run=(node --no-experimental-fetch)
    ;;
esac
for tool in "${compiler[0]}" "$archiver" "${run[0]}"; do
    command -v "$tool" >/dev/null || skip "$tool"
done

# What was compiled before need not be compiled again.
if [ "$level" = neon ] && command -v ccache >/dev/null; then
    compiler=(ccache "${compiler[@]}")
fi

rm -rf "$out"
mkdir -p "$out"
cd "$root"
find src -name '*.c' ! -path 'src/formats/*' ! -path 'src/files/*' \
    ! -path 'src/mpi/*' ! -path 'src/modules/*' ! -path 'src/recipe/*' \
    ! -path 'src/insitu/*' ! -path 'src/io/*' \
    ! -path 'src/transfer/formats/*' ! -name png.c ! -name webp.c \
    ! -name exr.c ! -name jpeg.c ! -name tiff.c -print0 |
    xargs -0 -P "$(nproc)" -I{} bash -c \
        'source=$1 out=$2 && shift 2 && "$@" -c "$source" -o "$out/${source//\//_}.o"' \
        _ {} "$out" "${compiler[@]}" "${flags[@]}" || exit 1
"${compiler[@]}" "${flags[@]}" -c "$here/same_bits.c" -o "$out/main.o"
"$archiver" rcs "$out/core.a" "$out"/src_*.o
"${compiler[@]}" -o "$program" "$out/main.o" "$out/core.a" "${link[@]}" \
    2>"$out/link.log" || { cat "$out/link.log" && exit 1; }
"${run[@]}" "$program" | tee "$out/said"
grep -q "scalar $level: 0 failed" "$out/said"
