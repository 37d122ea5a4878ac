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
        # shellcheck disable=SC2059
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
# shellcheck disable=SC2086
run 0 "a movie of a pattern" movie run/s_%04d.nrrd -o 'f_%02d.png' $look
check "six frames" [ "$(ls f_*.png | wc -l)" -eq 6 ]
for i in 0 1 2 3 4 5; do
    # shellcheck disable=SC2086
    run 0 "render of step $i" render run/s_00${i}0.nrrd -s 40x30 $look \
        -o one.png -y
    check "is frame $i, byte for byte" cmp one.png f_0$i.png
done
run 1 "steps differ" cmp -s f_00.png f_05.png
# shellcheck disable=SC2086
run 0 "the same by their names" movie run/*.nrrd -o 'g_%02d.png' $look
check "gives the same frames" same_bytes "$(echo f_*.png)" "$(echo g_*.png)"
# shellcheck disable=SC2086
run 0 "in another order" movie run/s_0050.nrrd run/s_0000.nrrd -o 'h%d.png' $look
check "are frames in that order" same_bytes "$(echo h*.png)" "$(echo f_05.png f_00.png)"
# shellcheck disable=SC2086
run 0 "one step" movie run/s_0020.nrrd -o 'i%d.png' $look
check "is one frame" cmp i0.png f_02.png

# One look for all of them, whichever comes first.
run 0 "the look of the histogram" "$TOOL" movie -s 40x30 run/s_%04d.nrrd \
    -o 'auto%d.png' --range full
says "grey 0\.\.23[0-9]"
run 0 "and backwards" "$TOOL" movie -s 40x30 run/s_00{5,4,3,2,1,0}0.nrrd \
    -o 'back%d.png' --range full
says "grey 0\.\.23[0-9]"
for i in 0 1 2 3 4 5; do
    check "gives frame $i" cmp auto$i.png back$((5 - i)).png
done
run 0 "the first step alone" render run/s_0000.nrrd -s 40x30 --range full -o a.png
run 1 "looks otherwise" cmp -s a.png auto0.png
run 0 "a look by percentiles" movie run/s_%04d.nrrd -o 'p%d.png' --range p5,p95

# One file with several steps.
{
    printf 'NRRD0004\ntype: uint8\ndimension: 4\nsizes: 8 8 8 3\n'
    printf 'kinds: domain domain domain time\nencoding: raw\n\n'
    for i in 0 2 4; do tail -c 512 run/s_00${i}0.nrrd; done
} >times.nrrd
# shellcheck disable=SC2086
run 0 "the steps in one file, aloud" "$TOOL" movie -s 40x30 times.nrrd \
    -o 'aloud%d.png' $look
check "no word on which of them is taken" bash -c "! grep -q 'is taken' '$ERR'"
# shellcheck disable=SC2086
run 0 "one of the steps" "$TOOL" movie -s 40x30 times.nrrd --time 1 \
    -o 'single%d.png' $look
check "no word on another" bash -c "! grep -q 'is taken' '$ERR'"
for time in "" "--time 0" "--time 2" "--time last"; do
    # shellcheck disable=SC2086
    run 0 "a still ${time:-without a step}" "$TOOL" render -s 9x9 times.nrrd $time \
        -o still.png -y
    [ -z "$time" ] || check "no word" bash -c "! grep -q 'is taken' '$ERR'"
    [ -n "$time" ] || says 'note: time step 0 of 3 .* --time N takes another'
done
# shellcheck disable=SC2086
run 0 "the steps in one file" movie times.nrrd -o 't%d.png' $look
check "are frames" same_bytes "$(echo t*.png)" "$(echo f_00.png f_02.png f_04.png)"
# shellcheck disable=SC2086
run 0 "one of them" movie times.nrrd --time 1 -o 'u%d.png' $look
check "is that frame" same_bytes "$(echo u*.png)" "f_02.png"
# shellcheck disable=SC2086
run 0 "one of them as a picture" "$TOOL" render times.nrrd --time 1 -s 99x99 -o plain.png
run 0 "with its number" "$TOOL" render times.nrrd --time 1 -s 99x99 -o numbered.png \
    --annotate step
run 6 "is another picture" "$TOOL" compare plain.png numbered.png
run 0 "by its time, which it lacks" "$TOOL" render times.nrrd --time 1 -s 99x99 \
    -o timed.png --annotate time
check "is the same" cmp -s timed.png numbered.png
run 0 "a file of one step" "$TOOL" render run/s_0000.nrrd -s 99x99 -o lone.png --annotate step
says 'note: --annotate draws nothing: the file has neither a time nor several steps'
run 0 "one of them, aloud" "$TOOL" movie times.nrrd --time 1 -o 'alone%d.png' -s 9x9
says 'note: this is one time step, so the movie is a still; .* turntable'
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
check "are none" bash -c "! grep -q still '$ERR'"
run 0 "several volumes of one step, quietly" "$TOOL" movie -q run/s_0000.nrrd \
    -o 'quiet%d.png' -s 9x9
check "no word" [ ! -s "$ERR" ]
refused 3 "several files of several steps" "times.nrrd: holds 3 time steps" \
    movie times.nrrd times.nrrd -o 'x%d.png'
run 0 "are possible with --time" movie times.nrrd times.nrrd --time 2 -o 'w%d.png'
check "two frames" [ "$(ls w*.png | wc -l)" -eq 2 ]

# What is missing is named.
mv run/s_0030.nrrd away
refused 3 "a step that is missing" "run/s_0030.nrrd: this step" \
    movie run/s_%04d.nrrd -o 'x%d.png'
refused 3 "a file that is missing" "run/s_0030.nrrd: No such file" \
    movie run/s_00{0,3}0.nrrd -o 'x%d.png'
refused 3 "a pattern without files" "no file matches" movie run/z_%d.nrrd -o 'x%d.png'
refused 3 "a pattern without a folder" "No such file" movie no/z_%d.nrrd -o 'x%d.png'
refused 2 "a pattern that is none" "a % without a number" \
    movie run/s_%s.nrrd -o 'x%d.png'
head -c 300 away >run/s_0030.nrrd
refused 3 "a step that is cut" "run/s_0030.nrrd" movie run/s_%04d.nrrd -o 'x%d.png'
refused 3 "a step of another size" "all steps of a movie need the same grid" \
    movie run/s_0000.nrrd phantom:engine -o 'x%d.png'
refused 2 "standard input" "name files" movie - -o 'x%d.png'
refused 2 "no input" "no input given" movie -o 'x%d.png'
refused 2 "no output" "no output given" movie run/s_0000.nrrd
check "none of these left anything" [ -z "$(ls -A | grep '^\.*x')" ]
# shellcheck disable=SC2086
run 3 "a step that is cut, found late" movie run/s_%04d.nrrd -o 'y%d.png' $look
plain_error
check "the frames before are whole" same_bytes "$(echo y*.png)" "$(echo f_00.png f_01.png f_02.png)"
mv away run/s_0030.nrrd
# shellcheck disable=SC2086
run 0 "with the step put right" movie run/s_%04d.nrrd -o 'y%d.png' $look \
    --resume --stats -
prints '"rendered": 3, "kept": 3'
check "the movie goes on" same_bytes "$(echo y*.png)" "$(echo f_*.png)"

# A simulation that goes on: frames may be added, and the look stays.
auto=(-s 40x30 --range full)
run 0 "a look chosen from all steps" "$TOOL" movie run/s_%04d.nrrd -o 'auto%d.png' \
    "${auto[@]}" -y
chosen=$(grep -o 'grey .*(from' "$ERR")
step run/s_0060.nrrd 3
# shellcheck disable=SC2086
run 0 "one step more" movie run/s_%04d.nrrd -o 'y%d.png' $look --resume \
    --stats -
prints '"rendered": 1, "kept": 6'
cat auto*.png >before
run 0 "with the look chosen before" "$TOOL" movie run/s_%04d.nrrd -o 'auto%d.png' \
    "${auto[@]}" --resume --stats -
prints '"rendered": 1, "kept": 6'
says 'the look is that of the first 6 steps, as of the frames that are there'
check "which is the same" grep -qF "$chosen" "$ERR"
check "as are its frames" cmp before <(cat auto[0-5].png)
run 0 "and once more" "$TOOL" movie run/s_%04d.nrrd -o 'auto%d.png' \
    "${auto[@]}" --resume --stats -
prints '"rendered": 0, "kept": 7'
cp auto6.png before.png
rm auto6.png
touch -d '2001-01-01' run/s_0060.nrrd
run 0 "also of a step that has changed" "$TOOL" movie run/s_%04d.nrrd \
    -o 'auto%d.png' "${auto[@]}" --resume
check "whose frame is the same" cmp before.png auto6.png
rm auto1.png
touch -d '2001-01-01' run/s_0020.nrrd
refused 4 "but not where it depends on that step" "frame 2 of .*s_0020" \
    "$TOOL" movie run/s_%04d.nrrd -o 'auto%d.png' "${auto[@]}" --resume
run 0 "unless it starts again" "$TOOL" movie run/s_%04d.nrrd -o 'auto%d.png' \
    "${auto[@]}" --resume -y --stats -
prints '"rendered": 7, "kept": 0'
check "from all steps" bash -c "! grep -q 'the first 6' '$ERR'"
touch -d '2001-01-01' run/s_0010.nrrd
# shellcheck disable=SC2086
refused 4 "nor where a step has changed" "frame 1 of .*s_0010" \
    movie run/s_%04d.nrrd -o 'y%d.png' $look --resume
# The look of several steps is that of one where they are alike, shaded or not.
for name in block slice; do
    crop=$([ $name = slice ] && echo :,:,30:31 || echo :,:,:)
    run 0 "a $name" "$TOOL" convert phantom:head --dims 60x60x50 --crop "$crop" \
        -o ${name}_0.nrrd
    cp ${name}_0.nrrd ${name}_1.nrrd
    run 0 "a movie of two" "$TOOL" movie "${name}_%d.nrrd" -q -s 64x64 \
        --view superior --fit volume -o "${name}_%d.png"
    run 0 "the picture of one" "$TOOL" render ${name}_0.nrrd -q -s 64x64 \
        --view superior --fit volume -o $name.png
    run 0 "is the same" "$TOOL" compare ${name}_0.png $name.png
done

# Labels are those of all steps: each is drawn as alone.
label_step() { # label_step FILE LABEL: a block of 1 and one of the label
    {
        # shellcheck disable=SC2059
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
run 0 "a step with another" "$TOOL" movie l_%d.nrrd -s 40x30 -o 'more%d.png' --resume
says 'labels 0\.\.9'
run 0 "of all three" "$TOOL" movie l_%d.nrrd -s 40x30 -o 'three%d.png' -q
check "has its colour" same_bytes "$(echo more*.png)" "$(echo three*.png)"
rm l_2.nrrd
for look in "" "--preset labels"; do
    # shellcheck disable=SC2086
    run 0 "a movie of labels" "$TOOL" movie l_%d.nrrd -s 40x30 -o 'l%d.png' \
        --fit volume -y $look
    says 'labels 0\.\.9'
    for i in 0 1; do
        run 0 "step $i alone" render l_$i.nrrd -s 40x30 --fit volume -o one.png -y
        check "is frame $i" cmp one.png l$i.png
    done
done

finish
