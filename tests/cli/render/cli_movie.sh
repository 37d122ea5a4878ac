#!/bin/bash
# Time steps of many files or of one become frames of one look; what is missing
# or does not fit is named.
. "$(dirname "$0")/../../support/shell.sh"

render() { "$TOOL" -q "$@"; }
movie() { "$TOOL" movie -q -s 40x30 "$@"; }

# Steps that differ in their values: step i has values up to 40 (i + 1).
header='NRRD0004\ntype: uint8\ndimension: 3\nsizes: 8 8 8\nencoding: raw\n\n'
step() { # step FILE I
    {
        printf "$header"
        head -c 512 one.raw | tr '\000-\372' "$(awk -v n="$2" 'BEGIN {
            for (i = 0; i < 251; i++)
                printf "\\%03o", int(i * (n + 1) / 6.3) }')"
    } >"$1"
}
raw_cube one.raw 8
mkdir run
for i in 0 1 2 3 4 5; do step "run/s_$(printf %04d $((10 * i))).nrrd" $i; done

look="--preset linear --range 0,240"
run 0 "a movie of a pattern" movie run/s_%04d.nrrd -o 'f_%02d.png' $look
check "six frames" [ "$(ls f_*.png | wc -l)" -eq 6 ]
for i in 0 1 2 3 4 5; do
    run 0 "render of step $i" render run/s_00${i}0.nrrd -s 40x30 $look \
        -o one.png -y
    same_file "is frame $i, byte for byte" one.png f_0$i.png
done
other_file "steps differ" f_00.png f_05.png

# frames NAME "WANTED..." OPTION...: a movie has the frames wanted.
frames() {
    rm -f g_*.png
    run 0 "$1" movie -o 'g_%02d.png' $look "${@:3}"
    check "$1: has these frames" same_bytes "$(echo g_*.png)" "$2"
}
frames "the same by their names" "$(echo f_*.png)" run/*.nrrd
frames "in another order" "f_05.png f_00.png" run/s_0050.nrrd run/s_0000.nrrd
frames "one step" f_02.png run/s_0020.nrrd

# One look for all of them, whichever comes first.
told "the look of the histogram" "grey 0\.\.23[0-9]" "$TOOL" movie -s 40x30 \
    run/s_%04d.nrrd -o 'auto%d.png' --range full
told "and backwards" "grey 0\.\.23[0-9]" "$TOOL" movie -s 40x30 \
    run/s_00{5,4,3,2,1,0}0.nrrd -o 'back%d.png' --range full
check "gives the same frames" same_bytes "$(echo auto?.png)" "$(echo back{5,4,3,2,1,0}.png)"
run 0 "the first step alone" render run/s_0000.nrrd -s 40x30 --range full -o a.png
other_file "looks otherwise" a.png auto0.png
run 0 "a look by percentiles" movie run/s_%04d.nrrd -o 'p%d.png' --range p5,p95

# One file with several steps.
{
    printf 'NRRD0004\ntype: uint8\ndimension: 4\nsizes: 8 8 8 3\n'
    printf 'kinds: domain domain domain time\nencoding: raw\n\n'
    for i in 0 2 4; do tail -c 512 run/s_00${i}0.nrrd; done
} >times.nrrd
frames "the steps in one file" "f_00.png f_02.png f_04.png" times.nrrd
frames "one of them" f_02.png times.nrrd --time 1
for time in "" "--time 1"; do
    run 0 "the steps in one file, aloud $time" "$TOOL" movie -s 40x30 times.nrrd \
        -o 'aloud%d.png' $time -y
    not_said 'is taken'
done
says 'note: this is one time step, so the movie is a still; .* turntable'
for time in "--time 0" "--time 2" "--time last" ""; do
    run 0 "a still ${time:-without a step}" "$TOOL" render -s 9x9 times.nrrd $time \
        -o still.png -y
    [ -z "$time" ] || not_said 'is taken'
done
says 'note: time step 0 of 3 .* --time N takes another'
pairs png render times.nrrd --time 1 -s 99x99 <<END
its number is seen | | != | --annotate step
in place of its time, which it lacks | --annotate time | = | --annotate step
END
told "a file of one step" \
    'note: --annotate draws nothing: the file has neither a time nor several steps' \
    "$TOOL" render run/s_0000.nrrd -s 99x99 -o lone.png --annotate step
# Each step has two notes, one after the other.
for i in 1 2 3; do
    {
        printf '# vtk DataFile Version 3.0\nt\nASCII\nDATASET RECTILINEAR_GRID\n'
        printf 'DIMENSIONS 3 2 3\nX_COORDINATES 3 float\n0 1 3\n'
        printf 'Y_COORDINATES 2 float\n0 1\nZ_COORDINATES 3 float\n0 1 4\n'
        printf 'POINT_DATA 18\nSCALARS v float\nLOOKUP_TABLE default\n'
        seq "$i" $((i + 17))
    } >"uneven$i.vtk"
done
run 0 "steps with several notes" "$TOOL" movie uneven%d.vtk -o 'uneven%d.png' -s 9x9
check "each is said once" test "$(grep -c 'not evenly spaced' "$ERR")" = 2
run 0 "two steps" "$TOOL" movie run/s_0000.nrrd run/s_0020.nrrd -o 'pair%d.png' -s 9x9
not_said still
run 0 "one step, quietly" movie run/s_0000.nrrd -o 'quiet%d.png'
silent
run 0 "several files of several steps" movie times.nrrd times.nrrd -o 'v%d.png'
check "are one series" [ "$(ls v*.png | wc -l)" -eq 6 ]
check "in their order" cmp v1.png v4.png
refused 3 "several steps between others" "times.nrrd: holds 3 time steps" \
    movie run/s_0000.nrrd times.nrrd run/s_0020.nrrd -o 'y%d.png'
run 0 "are possible with --time" movie times.nrrd times.nrrd --time 2 -o 'w%d.png'
check "two frames" [ "$(ls w*.png | wc -l)" -eq 2 ]

# What is missing is named.
mv run/s_0030.nrrd away
refusals 3 "$TOOL" movie -o x%d.png <<'END'
run/s_%04d.nrrd|run/s_0030.nrrd: this step
run/s_00{0,3}0.nrrd|run/s_0030.nrrd: No such file
run/z_%d.nrrd|no file matches
no/z_%d.nrrd|No such file
run/s_0000.nrrd phantom:engine|all steps of a movie need the same grid
END
head -c 300 away >run/s_0030.nrrd
refused 3 "a step that is cut" "run/s_0030.nrrd" movie run/s_%04d.nrrd -o 'x%d.png'
refusals 2 "$TOOL" movie <<'END'
run/s_%s.nrrd -o x%d.png|a % without a number
- -o x%d.png|name files
-o x%d.png|no input given
run/s_0000.nrrd|no output given
END
check "none of these left anything" [ -z "$(ls -A | grep '^\.*x')" ]
run 3 "a step that is cut, found late" movie run/s_%04d.nrrd -o 'y%d.png' $look
plain_error
check "the frames before are whole" same_bytes "$(echo y*.png)" "$(echo f_00.png f_01.png f_02.png)"
mv away run/s_0030.nrrd
printed "with the step put right" '"rendered": 3, "kept": 3' \
    movie run/s_%04d.nrrd -o 'y%d.png' $look --resume --stats -
check "the movie goes on" same_bytes "$(echo y*.png)" "$(echo f_*.png)"

# A simulation that goes on: frames may be added, and the look stays.
resume() { # resume NAME RENDERED KEPT OPTION...: the movie of auto%d.png
    printed "$1" "\"rendered\": $2, \"kept\": $3" "$TOOL" movie run/s_%04d.nrrd -s 40x30 \
        --range full -o 'auto%d.png' --stats - "${@:4}"
}
resume "a look chosen from all steps" 6 0 -y
chosen=$(grep -o 'grey .*(from' "$ERR")
step run/s_0060.nrrd 3
printed "one step more" '"rendered": 1, "kept": 6' \
    movie run/s_%04d.nrrd -o 'y%d.png' $look --resume --stats -
cat auto*.png >before
resume "with the look chosen before" 1 6 --resume
says 'the look is that of the first 6 steps, as of the frames that are there'
check "which is the same" grep -qF "$chosen" "$ERR"
check "as are its frames" cmp before <(cat auto[0-5].png)
resume "and once more" 0 7 --resume
mv auto6.png before.png
touch -d '2001-01-01' run/s_0060.nrrd
resume "also of a step that has changed" 1 6 --resume
same_file "whose frame is the same" before.png auto6.png
rm auto1.png
touch -d '2001-01-01' run/s_0020.nrrd
refused 4 "but not where it depends on that step" "frame 2 of .*s_0020" \
    "$TOOL" movie run/s_%04d.nrrd -o 'auto%d.png' -s 40x30 --range full --resume
resume "unless it starts again" 7 0 --resume -y
not_said 'the first 6'
touch -d '2001-01-01' run/s_0010.nrrd
refused 4 "nor where a step has changed" "frame 1 of .*s_0010" \
    movie run/s_%04d.nrrd -o 'y%d.png' $look --resume
# The look of several steps is that of one where they are alike, shaded or not.
for name in block slice; do
    crop=$([ $name = slice ] && echo :,:,30:31 || echo :,:,:)
    run 0 "a $name" "$TOOL" convert phantom:head --dims 60x60x50 --crop "$crop" \
        -o ${name}_0.nrrd
    cp ${name}_0.nrrd ${name}_1.nrrd
    view="-q -s 64x64 --view superior --fit volume"
    run 0 "a movie of two" "$TOOL" movie "${name}_%d.nrrd" $view -o "${name}_%d.png"
    run 0 "the picture of one" "$TOOL" render ${name}_0.nrrd $view -o $name.png
    same_file "is the same" ${name}_0.png $name.png
done

# Labels are those of all steps: each is drawn as alone.
label_step() { # label_step FILE LABEL: a block of 1 and one of the label
    {
        printf "$header" | sed "/^encoding/i Segment0_LabelValue:=$2"
        awk -v n="$2" 'BEGIN {
            for (i = 0; i < 512; i++) {
                x = i % 8; inside = int(i / 8) % 8 % 6 && i / 64 > 1
                print inside && x % 4 ? (x > 4 ? n : 1) : 0 } }' |
            while read -r value; do printf "\\x$value"; done
    } >"$1"
}
label_step l_0.nrrd 3
label_step l_1.nrrd 9
run 0 "labels" "$TOOL" movie l_%d.nrrd -s 40x30 -o 'more%d.png' -q
label_step l_2.nrrd 7
told "a step with another" 'labels 0\.\.9' \
    "$TOOL" movie l_%d.nrrd -s 40x30 -o 'more%d.png' --resume
run 0 "of all three" "$TOOL" movie l_%d.nrrd -s 40x30 -o 'three%d.png' -q
check "has its colour" same_bytes "$(echo more*.png)" "$(echo three*.png)"
rm l_2.nrrd
for look in "" "--preset labels"; do
    told "a movie of labels" 'labels 0\.\.9' \
        "$TOOL" movie l_%d.nrrd -s 40x30 -o 'l%d.png' --fit volume -y $look
    for i in 0 1; do
        run 0 "step $i alone" render l_$i.nrrd -s 40x30 --fit volume -o one.png -y
        check "is frame $i" cmp one.png l$i.png
    done
done

finish
