#!/usr/bin/env bash
# tests/package/package_wheel.sh - `script TOOL BUILD SOURCE`: the wheel of
# pyproject.toml is made, installed by pip into an environment of its own, and
# draws what the tool draws, also of a file that needs a module; its command is
# the tool.
. "$(dirname "$0")/../support/shell.sh"
SOURCE=$(realpath "$3")
PYTHON=/usr/bin/python3
"$PYTHON" -c 'import numpy, tomllib, ensurepip' 2>/dev/null ||
    { echo "skip   $PYTHON lacks numpy, tomllib or ensurepip" && exit 77; }
ls /usr/include/python3.*/Python.h >/dev/null 2>&1 ||
    { echo "skip   Python's headers are missing" && exit 77; }

mkdir source
cp -r "$SOURCE"/{CMakeLists.txt,README.md,LICENSE,CHANGELOG.md,CONTRIBUTING.md,pyproject.toml} \
    "$SOURCE"/{bench,bindings,cmake,docs,examples,fuzz,include,programs,python,scripts,serve,src,web} \
    source
page=build-web/viewer.html # where ./dev web has made it
[ ! -e "$SOURCE/$page" ] || { mkdir source/build-web && cp "$SOURCE/$page" source/$page; }
. "$HERE/package/compiled.sh" source
run 0 "a wheel is made" "$PYTHON" -B "$HERE/package/wheel.py" source "$WORK"
wheel=$(tail -1 "$OUT")
check "it serves all later versions of Python" \
    [ "${wheel#*-cp311-abi3-linux}" != "$wheel" ]
run 0 "it is listed" "$PYTHON" -m zipfile -l "$wheel"
check "all of it is in the package, but its description" \
    [ -z "$(sed 1d "$OUT" | grep -Ev '^snowglass(/|-[^/]*[.]dist-info/)')" ]
check "the library is in it once" [ "$(grep -c '/libsnowglass[.]so' "$OUT")" = 1 ]
rm -rf source stage

run 0 "it is unpacked" "$PYTHON" -m zipfile -e "$wheel" whole
find whole/snowglass \( -name '*.so*' -o -path '*/bin/*' \) -exec strip {} +
run 0 "it is packed without names for a debugger" \
    "$PYTHON" -m zipfile -c released.zip whole/*
size=$(stat -c %s released.zip)
echo "that has $size bytes"
check "at most 3,000,000" [ "$size" -le 3000000 ]

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
