#!/usr/bin/env bash
# tests/package/package_wheel.sh - `script TOOL BUILD SOURCE`: the wheel of
# pyproject.toml is made, installed by pip into an environment of its own, and
# draws what the tool draws, also of a file that needs a module; its command is
# the tool.
. "$(dirname "$0")/../support/shell.sh"
BUILD=$(realpath "$2")
SOURCE=$(realpath "$3")
PYTHON=/usr/bin/python3
"$PYTHON" -c 'import numpy, tomllib, ensurepip' 2>/dev/null ||
    { echo "skip   $PYTHON lacks numpy, tomllib or ensurepip" && exit 77; }
ls /usr/include/python3.*/Python.h >/dev/null 2>&1 ||
    { echo "skip   Python's headers are missing" && exit 77; }

export CCACHE_BASEDIR=$WORK CFLAGS="-O0 -w" CXXFLAGS="-O0 -w"
run 0 "a wheel is made" "$PYTHON" -B "$HERE/package/wheel.py" "$SOURCE" "$WORK"
wheel=$(tail -1 "$OUT")
check "it serves all later versions of Python" \
    [ "${wheel#*-cp311-abi3-linux}" != "$wheel" ]
run 0 "it is listed" "$PYTHON" -m zipfile -l "$wheel"
check "all of it is in the package, but its description" \
    [ -z "$(sed 1d "$OUT" | grep -Ev '^snowglass(/|-[^/]*[.]dist-info/)')" ]
check "the library is in it once" [ "$(grep -c '/libsnowglass[.]so' "$OUT")" = 1 ]
rm -rf built stage

# What is compiled fastest is large.  So the size is that of a package with the
# library, modules and extension of the build, if that is one to be released; the
# tool remains, which is smaller when it is optimised.
if grep -q '^CMAKE_BUILD_TYPE:STRING=Release$' "$BUILD/CMakeCache.txt"; then
    run 0 "it is unpacked" "$PYTHON" -m zipfile -e "$wheel" whole
    for file in $(cd whole && find snowglass -name '*.so*'); do
        name=${file#snowglass/}
        for from in "$BUILD/$name" "$BUILD/python/snowglass/$name"; do
            [ ! -e "$from" ] || strip -o "whole/$file" "$from"
        done
    done
    strip whole/snowglass/bin/snowglass
    run 0 "it is packed" "$PYTHON" -m zipfile -c released.zip whole/*
    size=$(stat -c %s released.zip)
    echo "a wheel of this build has $size bytes"
    check "that is at most 3,000,000" [ "$size" -le 3000000 ]
else
    skipped "the size of the wheel" "the build is not Release"
fi

run 0 "an environment is made" "$PYTHON" -m venv --system-site-packages there
find there | sort >before
run 0 "pip installs it" there/bin/pip install --no-index --no-deps "$wheel"

"$TOOL" phantom head --dims 48x48x40 -q -o head.nrrd
"$TOOL" head.nrrd -o tool.png -s 96x64 -q
cat >draw.py <<'END'
import numpy
import snowglass as sg

print(sg.__file__, sg.__version__)
sg.render("head.nrrd", size=(96, 64)).save("wheel.png")
try:
    import h5py
    with h5py.File("head.h5", "w") as file:
        file["head"] = numpy.asarray(sg.Volume("head.nrrd"))
    assert sg.Volume("head.h5").dims == (48, 48, 40)
except ImportError:
    print("no h5py")
END
unset PYTHONPATH LD_LIBRARY_PATH
run 0 "its command is the tool" there/bin/snowglass --version
check "of the same version" [ "$(cat "$OUT")" = "$("$TOOL" --version)" ]
run 0 "which draws" there/bin/snowglass head.nrrd -o command.png -s 96x64 -q
check "the same picture" cmp tool.png command.png
run 2 "which refuses what the tool refuses" there/bin/snowglass head.nrrd --nonsense
plain_error
chmod a-x "$(find there -path '*/bin/snowglass' -path '*/site-packages/*')"
run 1 "a damaged package is reported" there/bin/snowglass --version
says "^snowglass: .*cannot be started .*; install the package again$"
run 0 "it draws" there/bin/python draw.py
prints "there/.*/snowglass/__init__.py"
check "the same picture as the tool" cmp tool.png wheel.png
for file in $(find there -path '*/snowglass/*' \( -name '*.so*' -o -path '*/bin/*' \)); do
    check "${file##*/} is found beside its own alone" \
        [ -z "$(readelf -d "$file" | sed -n 's/.*R[UN]*PATH.*\[\(.*\)\]/\1/p' |
            grep -vx '\$ORIGIN\(/[.][.]\)\{0,1\}/*:*')" ]
done
run 0 "pip removes it" there/bin/pip uninstall -y snowglass
check "nothing is left" [ -z "$(find there | sort | comm -13 before - |
    grep snowglass)" ]
finish
