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
    rm -f ./*.png
    # shellcheck disable=SC2086
    run 0 "$mode on what it lies on by default" head_of render -m $mode -o a.png
    # shellcheck disable=SC2086
    run 0 "by its name" head_of render -m $mode -o b.png --background auto
    # shellcheck disable=SC2086
    run 0 "in dark" head_of render -m $mode -o c.png --background "$dark"
    # shellcheck disable=SC2086
    run 0 "and transparent" head_of render -m $mode -o d.png --background none
    check "the default is auto" cmp -s a.png b.png
    check "and $dark" cmp -s a.png c.png
    check "opaque, and grey as it is" [ "$(kind a.png)" = 0 ]
    check "none has alpha" [ "$(kind d.png)" = 4 ]
done
run 6 "which is another picture" "$TOOL" compare a.png d.png
run 0 "colours" head_of render -c hot -o e.png
check "are opaque" [ "$(kind e.png)" = 2 ]
run 0 "with alpha" head_of render -c hot -o f.png --background none
check "they are not" [ "$(kind f.png)" = 6 ]
run 0 "16 bits" head_of render -o g.png --bits 16
check "are opaque" [ "$(kind g.png)" = 0 ]
run 0 "floats" head_of render -o a.npy
for back in auto none; do
    run 0 "floats with $back" head_of render -o $back.npy --background $back
    check "are the same" cmp -s a.npy $back.npy
done
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

run 0 "nothing asked" head_of render -o i.png --save-config i.json
run 0 "is kept" "$TOOL" render -q --config i.json -o j.png
check "in the same picture" cmp -s i.png j.png
run 0 "a format of floats too" "$TOOL" render -q --config i.json -o i.npy
run 0 "none" head_of render -o k.png --background none --save-config k.json
run 0 "is kept" "$TOOL" render -q --config k.json -o l.png
check "in the same picture" cmp -s k.png l.png

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
    rm -f ./*.png
    for name in ct mr; do
        # shellcheck disable=SC2086
        run 0 "$name $preset" "$TOOL" render -q $name.nrrd $look $preset \
            --shade none --range 0,200 -o $name.png
        # shellcheck disable=SC2086
        run 0 "with a legend" "$TOOL" render -q $name.nrrd $look $preset \
            --shade none --range 0,200 --legend -o $name.legend.png
    done
    run 0 "one picture" "$TOOL" compare ct.png mr.png
    run 6 "but one is in HU" "$TOOL" compare ct.legend.png mr.legend.png
done
finish
