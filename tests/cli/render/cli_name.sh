#!/bin/bash
# A picture without -o is NAME.png in the working folder, and replaces no file.
. "$(dirname "$0")/../../support/shell.sh"

mkdir -p in/folder.1 out
"$TOOL" convert -q phantom:cube --dims 12x11x10 -o in/a.nrrd
"$TOOL" convert -q phantom:cube --dims 12x11x10 -o in/b.nii.gz
cp in/a.nrrd in/1.2.840.113
cp in/a.nrrd in/c.d.nrrd
cd out || exit 1
named() {
    told "$1" "; to $2\$" "$TOOL" "$1" -s 20x20
    check "$2 is written" [ -s "$2" ]
    run 4 "$1 again" "$TOOL" "$1" -s 20x20
    says "^snowglass: $2: exists, and is replaced only where it is named; give"
    run 4 "$1 even with -y" "$TOOL" "$1" -s 20x20 -y
    run 0 "$1 where it is named" "$TOOL" "$1" -s 20x20 -y -o "$2"
}
named ../in/a.nrrd a.png
named ../in/b.nii.gz b.png
named ../in/c.d.nrrd c.d.png
named ../in/1.2.840.113 1.2.840.113.png
named phantom:head head.png
ln -s nowhere a.b.png
cp ../in/a.nrrd ../in/a.b.nrrd
run 4 "a link counts as a file" "$TOOL" ../in/a.b.nrrd -s 20x20
run 0 "render does the same" "$TOOL" render phantom:shells --dims 9x9x9 -s 20x20
check "shells.png is written" [ -s shells.png ]
: >missing.png
run 3 "the input's fault comes first" "$TOOL" ../in/missing.nrrd
says 'missing.nrrd'
refused 2 "a turntable needs a name" 'no output given' "$TOOL" turntable \
    phantom:cube
if mkdir folder.1 && cp ../in/a.nrrd folder.1 && [ -d folder.1 ]; then
    (cd folder.1 && run 0 "in its own folder" "$TOOL" a.nrrd -s 20x20 &&
        check "a.png is written" [ -s a.png ])
fi
finish
