#!/bin/bash
# What pictures lie on: dark by default where a file shows it, transparent where
# that is asked for; the same in every verb and in configurations.
. "$(dirname "$0")/../../support/shell.sh"

head_of() { "$TOOL" "$1" -q phantom:head --dims 40x40x40 -s 90x80 "${@:2}"; }
# kind FILE: the colour type of a PNG: 0 grey, 2 colours, 4 and 6 with alpha.
kind() { od -An -tu1 -j25 -N1 "$1" | tr -d ' '; }

for mode in over mip minip mean "iso --iso 40"; do
    dark='#141414'
    case $mode in m*) dark='black' ;; esac
    pairs png render phantom:head --dims 40x40x40 -s 90x80 -m $mode <<END
$mode lies on auto by default | | = | --background auto
which is $dark | " | = | --background '$dark'
and not nothing | " | != | --background none
END
    check "opaque, and grey as it is" [ "$(kind .one.png)" = 0 ]
    check "none has alpha" [ "$(kind .two.png)" = 4 ]
done
run 0 "colours" head_of render -c hot -o e.png
check "are opaque" [ "$(kind e.png)" = 2 ]
run 0 "with alpha" head_of render -c hot -o f.png --background none
check "they are not" [ "$(kind f.png)" = 6 ]
run 0 "16 bits" head_of render -o g.png --bits 16
check "are opaque" [ "$(kind g.png)" = 0 ]
run 0 "floats" head_of render -o a.npy
pairs npy render phantom:head --dims 40x40x40 -s 90x80 <<'END'
floats by default | | = | --background auto
and on nothing | " | = | --background none
END
run 0 "a picture without a background" head_of render -o h.png --no-labels \
    --background none
run 0 "is that of the floats" "$TOOL" compare a.npy h.png --tolerance 1/255
refused 2 "floats on a colour" "work only for PNG" head_of render -o x.npy \
    --background white

for verb in turntable movie; do
    rm -f t_*
    run 0 "$verb" head_of $verb -o 't_%d.png'
    check "has opaque frames" [ "$(kind t_0.png)" = 0 ]
    run 0 "$verb without a background" head_of $verb -y -o 't_%d.png' \
        --background none
    check "has transparent ones" [ "$(kind t_0.png)" = 4 ]
done

head="phantom:head --dims 40x40x40 -s 90x80"
again "nothing asked" render i.png $head
run 0 "which is kept for a format of floats too" "$TOOL" render -q --config first.json -o i.npy
again "none" render k.png $head --background none

# --- the unit of values --------------------------------------------------------
# A block of 200 in air, and once more with a corner that no CT has.
ct() {
    printf 'NRRD0004\ntype: int16\ndimension: 3\nsizes: 8 8 8\n'
    printf 'space: right-anterior-superior\nspace directions: %s\n' \
        '(1,0,0) (0,1,0) (0,0,1)'
    printf 'endian: little\nencoding: ascii\n\n%s\n' "$1"
    for n in $(seq 511); do
        [ $((n % 8)) -gt 3 ] && echo 200 || echo -900
    done
}
ct -1000 >ct.nrrd
ct -800 >mr.nrrd
sed -i 's/^-900$/-700/' mr.nrrd
look="-s 200x180 --opacity 0:0,100:1 -c grey --no-labels"
for preset in "" "--preset ct-bone"; do
    pairs png render $look $preset --shade none --range 0,200 <<'END'
one picture | ct.nrrd | 0 | mr.nrrd
but one is in HU | ct.nrrd --legend | != | mr.nrrd --legend
END
done
# The background of a projection is the colour of its lowest value.
pairs png render phantom:head --dims 40x40x40 -s 90x80 <<'END'
a map that begins with white | -m mip -c grey_r | = | -m mip -c grey_r --background '#ffffff'
of values | -m mean -c viridis | = | -m mean -c viridis --background '#440154'
END
finish
