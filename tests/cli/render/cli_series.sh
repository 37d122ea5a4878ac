#!/bin/bash
# Series of files and steps of a file, by one naming scheme for all verbs; steps by
# number, from the end, in ranges and by time; a series that grows while a movie
# of it is made.
. "$(dirname "$0")/../../support/shell.sh"

for step in 0 10 30; do
    "$TOOL" phantom shells --dims 16x16x16 -q \
        -o "$(printf run_%04d.nrrd $step)" || exit 1
    printf 'run_%04d.nrrd\n!TIME 0.%d\n' $step $step >>list
done
grep '!' list >steps.visit
grep -v '!' list >>steps.visit
look=(--preset linear --range 0,255 -s 48x48)
render() { "$TOOL" render -q "${look[@]}" "$@"; }

# A picture of one step; numbers may be missing between others.
for pair in "0 0000" "1 0010" "2 0030" "last 0030" "-1 0030" "-3 0000"; do
    read -r time name <<<"$pair"
    pairs png render "${look[@]}" <<END
the pattern at $time is step $name | run_$name.nrrd | = | run_%04d.nrrd --time $time
the list at $time too | " | = | steps.visit --time $time
END
done
run 0 "without --time" "$TOOL" render "${look[@]}" run_%04d.nrrd -o first.png
says 'run_0000.nrrd: step 0 of 3 .counted from 0. is taken; --time N takes another'
run 0 "named after the file" render run_%04d.nrrd --time 1
check "which it is" [ -s run_0010.png ]
for verb in info "convert -o a.nrrd" "turntable --frames 1 -s 32x32 -o t_%d.png" \
    "slice -o s.png"; do
    read -ra words <<<"$verb"
    run 0 "${words[0]}" "$TOOL" "${words[0]}" run_%04d.nrrd "${words[@]:1}" --time last
    says 'run_0030.nrrd: step 2 of 3 .counted from 0. is taken$'
done
refused 2 "a step that is not there" 'no step 3; run_%04d.nrrd stands for 3' \
    "$TOOL" info run_%04d.nrrd --time 3
refused 2 "nor that far from the end" 'no step -4' "$TOOL" info run_%04d.nrrd --time -4
told "a number of any width" 'run_0030.nrrd: step 2 of 3' "$TOOL" info run_%T.nrrd --time last
refused 3 "another width" 'no file matches' "$TOOL" info run_%d.nrrd
for name in mixed_007 mixed_8 mixed_09 mixed_10 long_0000000100 long_0000000200; do
    cp run_0010.nrrd $name.nrrd
done
run 0 "files of several widths" "$TOOL" movie -q "${look[@]}" mixed_%T.nrrd -o w_%d.png
check "are all in the movie" [ "$(echo w_*.png)" = "w_0.png w_1.png w_2.png w_3.png" ]
told "each under its own name" 'mixed_09.nrrd: step 2 of 4' "$TOOL" info mixed_%T.nrrd --time 2
told "a long number" 'long_0000000200.nrrd: step 1 of 2' "$TOOL" info long_%T.nrrd --time last
rm mixed_09.nrrd
run 0 "iterations at any distance" "$TOOL" movie -q "${look[@]}" mixed_%T.nrrd -o x_%d.png
check "are all in the movie too" [ "$(echo x_*.png)" = "x_0.png x_1.png x_2.png" ]
run 0 "and of fixed width" "$TOOL" movie -q "${look[@]}" run_%04T.nrrd -o y_%d.png
check "are all in the movie as well" [ "$(echo y_*.png)" = "y_0.png y_1.png y_2.png" ]
mv mixed_10.nrrd mixed_08.nrrd
refused 3 "two of one number" 'another file of mixed_%T.nrrd has this number too' \
    "$TOOL" info mixed_%T.nrrd --time 0
refused 3 "a pattern without files" 'no file matches' "$TOOL" info no_%d.nrrd
refused 3 "or of stars" 'no_\*.nrrd: no file matches' "$TOOL" movie 'no_*.nrrd' -o p_%d.png

# Stars that no shell has taken, by the numbers in the names: 9 before 10.
mkdir 'a[1' stars
cp run_0000.nrrd stars/s9.nrrd
cp run_0010.nrrd stars/s10.nrrd
cp run_0030.nrrd 'a[1/x*.nrrd'
told "files by a star" 's10.nrrd: step 1 of 2' "$TOOL" info 'stars/s*.nrrd' --time 1
run 0 "a movie of them" "$TOOL" movie -q "${look[@]}" 'stars/s[0-9]*.nrrd' -o star_%d.png
run 0 "by names" "$TOOL" movie -q "${look[@]}" stars/s9.nrrd stars/s10.nrrd -o named_%d.png
check "has the same frames" cmp star_0.png named_0.png
check "in this order" cmp star_1.png named_1.png
check "and no others" [ "$(echo star_*.png)" = "star_0.png star_1.png" ]
run 0 "a file of such a name" "$TOOL" render "${look[@]}" 'a[1/x*.nrrd' -o star.png

# Physical time: the nearest step.
printed "by time" '^times +3 .these values: step 1' "$TOOL" info steps.visit --time 0.12
prints '^time +0.1$'
says 'step 1 of 3 is the nearest, at 0.1'
printed "with a unit, which the list lacks" 'step 2' "$TOOL" info steps.visit --time 9.9s
refused 2 "without times" 'has no physical times' "$TOOL" info run_0000.nrrd --time 0.5
refused 2 "a date of a list that has none" "2005-08-28 is not a date of the input" \
    "$TOOL" info steps.visit --time 2005-08-28
for time in x 1: 0.5q1 1:2:3 -; do
    [ $time = 1: ] || refused 2 "no time: $time" 'is not a time step' \
        "$TOOL" info steps.visit --time $time
done
refused 2 "a movie of a time of files" 'movie takes steps by their numbers' \
    "$TOOL" movie 'run_%04d.nrrd' --time 0.5 -o no_%d.png
refused 2 "a range" 'a range of them is for movie' "$TOOL" info steps.visit --time 0:2

# Movies of some steps; gaps in a pattern are errors.
movie() { "$TOOL" movie -q "${look[@]}" "$@"; }
run 0 "a range" movie steps.visit --time 1:3 -o m_%d.png
check "two frames" [ "$(echo m_*.png)" = "m_0.png m_1.png" ]
run 0 "the files" movie run_0010.nrrd run_0030.nrrd -o q_%d.png
check "from step 1 on" cmp -s m_0.png q_0.png
run 0 "the last two" movie steps.visit --time -2: -o n_%d.png
check "are the same" cmp -s m_1.png n_1.png
run 0 "the first" movie steps.visit --time :1 -o o_%d.png
check "one frame" [ "$(echo o_*.png)" = o_0.png ]
refused 2 "beyond the end" 'there are 3 steps' movie steps.visit --time 1:4 -o p_%d.png
refused 2 "nothing" 'there are 3 steps' movie steps.visit --time 2:2 -o p_%d.png
refused 3 "a gap" 'run_0020.nrrd: this step of' movie run_%04d.nrrd -o p_%d.png

# A list that grows: frames that are there stay.
run 0 "three steps" movie steps.visit -o g_%d.png
stat -c '%i %Y' g_0.png g_1.png g_2.png >before
sleep 1
echo run_0000.nrrd >>steps.visit
run 0 "a fourth" movie steps.visit -o g_%d.png --resume
check "is made" [ -s g_3.png ]
check "and no other anew" cmp -s before <(stat -c '%i %Y' g_0.png g_1.png g_2.png)
sed -i 's/run_0010/run_0000/' steps.visit
refused 4 "changed without growing" 'other settings' movie steps.visit -o g_%d.png --resume

# One step at first.
cp run_0010.nrrd st_0.nrrd
run 0 "one step" "$TOOL" movie st_%d.nrrd -s 48x48 -o st_%d.png
cp st_0.png before.png
cp run_0030.nrrd st_1.nrrd
run 0 "a second" "$TOOL" movie st_%d.nrrd -s 48x48 -o st_%d.png --resume
says 'the look is that of the first 1 step, as of'
check "is made" [ -s st_1.png ]
check "and the first stays" cmp -s before.png st_0.png

# Short movies take four seconds.
if command -v ffprobe >/dev/null; then
    run 0 "three frames" movie run_0000.nrrd run_0010.nrrd run_0030.nrrd -o a.mp4
    printed "their rate" '^2/1' \
        ffprobe -v error -select_streams v -show_entries stream=r_frame_rate -of csv=p=0 a.mp4
    run 0 "--fps" movie run_0000.nrrd run_0010.nrrd -o b.mp4 --fps 10
    printed "is kept" '^10/1' \
        ffprobe -v error -select_streams v -show_entries stream=r_frame_rate -of csv=p=0 b.mp4
fi

# A folder with such a Header is a plotfile (tests/oracles/oracle_amr.py).
mkdir plt00000
echo HyperCLaw-V1.1 >plt00000/Header
refused 3 "a plotfile that is cut off" 'ends before a number of components' "$TOOL" info plt00000
mkdir chk00000 run.bp
echo CheckPointVersion_1.0 >chk00000/Header
touch run.bp/md.idx run.bp/data.0
refused 3 "a checkpoint" 'is a checkpoint of AMReX' "$TOOL" info chk00000
refused 3 "a folder of ADIOS2" 'run.bp: is a file of ADIOS2 .* openpmd-pipe' "$TOOL" info run.bp
finish
