#!/bin/bash
# A turn is what render makes of each azimuth, bit for bit; it is whole or
# absent, frame by frame, whatever ends it, and goes on from there.
. "$(dirname "$0")/../../support/shell.sh"

# One frame for all pictures (oracle_fit.py) is not that of each alone.
small="phantom:engine --dims 32x32x24 -s 60x44 --fit volume"
turn() { "$TOOL" turntable $small -q "$@"; }
render() { "$TOOL" $small -q "$@"; }
left() { find . -name '.*unfinished*' -o -name '*.snow-*' | head -3; }
clean() { [ -z "$(left)" ]; }
same_frames() { # same_frames A B: the numbered PNG files of two folders
    (cd "$1" && sha256sum ./*.png) >.sums_one &&
        (cd "$2" && sha256sum ./*.png) >.sums_other &&
        diff .sums_one .sums_other
}
started() { # started COUNT FILES...: waits until so many of them are there
    local count=$1 i
    shift
    for i in $(seq 6000); do
        [ "$(ls $* 2>/dev/null | wc -l)" -ge "$count" ] && return 0
        sleep 0.02
    done
    return 1
}
if command -v ffmpeg >/dev/null; then has_ffmpeg=1; else has_ffmpeg=; fi

# Stands for ffmpeg: keeps the bytes, or fails as FAKE says.
mkdir bin
cat >bin/ffmpeg <<'END'
#!/bin/bash
for last; do :; done
case ${FAKE-} in
start) echo "the codec is not there" >&2; exit 1 ;;
middle) head -c 20000 >/dev/null; echo "no more, thanks" >&2; exit 3 ;;
die) head -c 20000 >/dev/null; kill -9 $$ ;;
end) cat >"${last#file:}"; echo "cannot finish" >&2; exit 1 ;;
*) cat >"${last#file:}" ;;
esac
END
chmod +x bin/ffmpeg
fake() { env PATH="$WORK/bin:$PATH" FAKE="$1" "${@:2}"; }

# Raw frames go to a pipe as ffmpeg gets them.
run 0 "bytes for ffmpeg" fake good "$TOOL" turntable $small -q --frames 3 -o raw.mp4
"$TOOL" turntable $small -q --frames 3 -o - --as rgb24 | cat >raw.bytes
check "are those on standard output" cmp raw.mp4 raw.bytes
check "three times 60x44 pixels" [ "$(wc -c <raw.bytes)" -eq $((3 * 60 * 44 * 3)) ]
"$TOOL" turntable $small -q --frames 200 -o - --as rgb24 2>.err | head -c 9 >/dev/null
check "a reader that ends is told of" grep -q "standard output: Broken pipe" .err
for words in "-o -" "-o - --as uint8" "-o f_%d.png --as rgb24" "-o - --as rgb24 --resume"; do
    run 2 "refused: $words" turn $words
    check "says what works" grep -q -e "-o - --as rgb24" "$ERR"
done

# Every frame is the picture of its azimuth.
for kind in png npy pfm; do
    run 0 "a turn of .$kind" turn --frames 5 --azimuth 10 -o "f_%03d.$kind"
    for i in 1 4; do
        azimuth=$(awk "BEGIN { printf \"%.17g\", 10 + 360 * $i / 5 }")
        run 0 "render $azimuth" render --azimuth "$azimuth" -o "one.$kind" -y
        check "frame $i is that, byte for byte" cmp "f_00$i.$kind" "one.$kind"
    done
    check "five frames" [ "$(ls f_*.$kind | wc -l)" -eq 5 ]
done
options="--background navy --bits 16 --elevation 20 --zoom 1.5 -c viridis"
run 0 "other options are those of render" turn --frames 2 -o 'o%d.png' $options
run 0 "render with them" render -o o.png --azimuth 180 $options
same_file "they give one picture" o1.png o.png
run 0 "one frame" turn --frames 1 -o 'single_%d.png'
check "is one file" [ "$(echo single_*)" = single_0.png ]
run 0 "percent signs" turn --frames 1 -o '100%%_%02d.png'
check "are written as one" [ -f '100%_00.png' ]
run 0 "any number of threads" turn --frames 5 --azimuth 10 -j 8 -o 'j_%03d.png'
check "makes the same frames" same_bytes "$(echo f_*.png)" "$(echo j_*.png)"
mkdir folder
run 0 "a folder" turn --frames 2 -o 'folder/f%d.png'
check "has its frames" [ -f folder/f1.png ]

# Names that are no pattern.
refusals 2 "$TOOL" turntable phantom:cube <<'END'
-o x.png|cannot hold many frames
-o %s.png|a % without a number
-o %n.png|a % without a number
-o %4d.png|a % without a number
-o %-4d.png|a % without a number
-o %04ld.png|a % without a number
-o %0d.png|a % without a number
-o %04d%04d.png|two numbers
-o %.png|a % without a number
-o %%.png|has no number
-o %d/f.png|a folder's name
-o f_%04d.bmp|f_0000.bmp
-o f_%04d.mp4|a movie is one file
-o x.avi|cannot hold many frames
-o -|need -o - --as rgb24
-q|no output given
--frames 0 -o x%d.png|whole number
-o x%d.npy --background red|work only for PNG
-o x.mp4 --bits 16|bits works only for PNG
-o x.mp4 --stats x.mp4|two files
END
refused 2 "standard input cannot be resumed" "standard input" \
    "$TOOL" turntable - -o 'x%d.png' --resume
refused 4 "a folder that is missing" "nowhere" turn -o 'nowhere/x%d.png'
refused 4 "a movie in a folder that is missing" "nowhere" turn -o nowhere/x.mp4
for out in x%d.png x.mp4; do
    refused 3 "$out of an input that is missing" "none.nrrd" \
        "$TOOL" turntable none.nrrd -o $out
    check "leaves nothing" [ -z "$(ls -A | grep '^\.*x')" ]
done

# What is there stays, unless told; what is resumed must fit.
mkdir a
run 0 "a turn" turn --frames 6 -o 'a/%d.png'
sum=$(cat a/*.png | sha256sum)
refused 4 "the same once more" "a/0.png: exists; use --resume" \
    turn --frames 6 -o 'a/%d.png'
printed "the same with --resume" '"frames": \{"rendered": 0, "kept": 6\}' \
    turn --frames 6 -o 'a/%d.png' --resume --stats -
refusals 4 turn <<'END'
--frames 6 -o 'a/%d.png' --zoom 2 --resume|'--zoom 2' now
--frames 5 -o 'a/%d.png' --resume|frame 1 of 6 .* azimuth 60 .* then
--frames 6 --elevation 3 -o 'a/%d.png' --resume|--elevation 3
END
check "all of that changed nothing" [ "$(cat a/*.png | sha256sum)" = "$sum" ]
rm a/2.png
head -c 100 a/4.png >short && mv short a/4.png
printed "--resume with a frame gone and one cut" '"rendered": 2, "kept": 4' \
    turn --frames 6 -o 'a/%d.png' --resume --stats -
check "makes them again" [ "$(cat a/*.png | sha256sum)" = "$sum" ]
run 0 "-y makes another turn" turn --frames 4 --zoom 2 -o 'a/%d.png' -y
check "and takes the frames beyond it away" [ "$(ls a | wc -l)" -eq 4 ]
check "its frames are new" [ "$(cat a/*.png | sha256sum)" != "$sum" ]
mkdir b && cp f_000.png b/7.png
refused 4 "a frame of a stranger" "b/7.png: exists" turn -o 'b/%d.png'
refused 4 "is not resumed" "without a record" turn -o 'b/%d.png' --resume
check "and stays" cmp b/7.png f_000.png
run 7 "a turn of nothing" "$TOOL" turntable $small --frames 2 -o 'void%d.png' \
    --opacity 900:0,901:1
says 'note: the picture is empty: no voxel has an opacity'
check "is written" is_png void1.png
# Killed before its first frame, a run leaves a record that tells nothing.
: >b/.%d.png.frames
refused 4 "nor beside an empty record" "without a record" \
    turn -o 'b/%d.png' --resume
refused 4 "nor without --resume" "b/7.png: exists; use --overwrite" \
    turn -o 'b/%d.png'
check "and stays still" cmp b/7.png f_000.png
mkdir meanwhile && : >meanwhile/.%d.png.frames
run 0 "an empty record alone" turn --frames 3 -o 'meanwhile/%d.png' --resume
ln -s nowhere .g%d.png.frames
refused 4 "a record that cannot be made" ".g%d.png.frames: No such file" \
    turn --frames 3 -o 'g%d.png'
run 0 "--resume where nothing is" turn --frames 3 -o 'c%d.png' --resume
# The input is known by its path, size and time.
"$TOOL" phantom engine --dims 16x16x16 -o v.nrrd -q
v="$TOOL turntable v.nrrd -q -s 30x30 --frames 3 -o v%d.png"
run 0 "a turn of a file" $v
touch -d '2001-01-01' v.nrrd
refused 4 "a file that has changed is not resumed" "other settings" $v --resume

# Killed half-way, then resumed: the same bytes.
big="turntable phantom:engine --dims 64x64x64 -q -s 700x700 --frames 24"
as_whole() { # each frame of killed/, which slow machines may have none of
    for f in killed/*.png; do
        [ ! -e "$f" ] || cmp -s "$f" "whole/${f#killed/}" || fail "frame $f $1"
    done
}
mkdir whole killed
run 0 "a longer turn" "$TOOL" $big -o 'whole/%02d.png'
"$TOOL" $big -o 'killed/%02d.png' &
job=$!
started 5 'killed/*.png'
kill -9 $job
wait $job 2>/dev/null
as_whole "of a killed turn"
printed "resumed after kill -9" '"kept": [1-9]' \
    "$TOOL" $big -o 'killed/%02d.png' --resume --stats -
check "the frames are the same bytes" same_frames whole killed
check "nothing else is left" clean

# Killed again and again, at any moment.
rm -rf killed && mkdir killed
kills=0
for _ in $(seq 25); do
    "$TOOL" $big -o 'killed/%02d.png' --resume 2>/dev/null &
    job=$!
    sleep 0.$((RANDOM % 20 + 3))
    kill -9 $job 2>/dev/null
    wait $job 2>/dev/null && break # it had ended
    kills=$((kills + 1))
done
as_whole "after $kills kills"
run 0 "resumed after $kills kills" "$TOOL" $big -o 'killed/%02d.png' --resume
check "the frames are the same bytes" same_frames whole killed
check "nothing else is left" clean

# Killed between a frame's line in the record and its name, at any frame: it is
# made again; killed behind its name, it is kept.
rm -rf killed && mkdir killed
run 0 "a short turn" turn --frames 3 -o 'killed/%d.png'
cp -r killed named
for lines in 0 1 2; do
    rm -rf killed && mkdir killed && cp named/?.png killed
    head -n -$((2 - lines)) named/.%d.png.frames >killed/.%d.png.frames
    rm -f killed/$((lines + 1)).png killed/$((lines + 2)).png
    printed "after line $lines" "\"rendered\": $((2 - lines)), \"kept\": $((lines + 1))" \
        turn --frames 3 -o 'killed/%d.png' --resume --stats -
    rm killed/$lines.png
    printed "before the name of $lines" '"rendered": 1, "kept": 2' \
        turn --frames 3 -o 'killed/%d.png' --resume --stats -
    check "the frames are the same bytes" same_frames named killed
done

# Two runs at one place.
rm -rf killed && mkdir killed
"$TOOL" $big --frames 2000 -o 'killed/%04d.png' &
job=$!
started 2 'killed/*.png'
refused 4 "a second run at the same place" "another run" \
    "$TOOL" $big --frames 2000 -o 'killed/%04d.png' --resume
kill -9 $job
wait $job 2>/dev/null
rm -rf killed

# Two that begin together: one is whole, the other takes nothing from it.
lost=0
for _ in 1 2 3; do
    rm -rf both && mkdir both
    turn --frames 6 -o 'both/%d.png' 2>/dev/null &
    turn --frames 6 -o 'both/%d.png' --azimuth 5 2>/dev/null
    first=$?
    wait $!
    [ "$((first + $?)) $(ls both | wc -l)" = "4 6" ] || lost=1
done
check "of two runs that begin together one makes all frames" [ $lost -eq 0 ]
rm -rf both

# Frames that come while a run begins are somebody's, and stay.
# Where this script comes too late, there are two frames: then once more.
for _ in $(seq 20); do
    rm -rf late && mkdir late
    turn --frames 2 -s 1500x1500 --quality high -o 'late/%d.png' 2>log &
    job=$!
    started 1 'late/.*.frames'
    echo mine >late/1.png
    wait $job
    code=$?
    [ $code -eq 0 ] || break
done
check "a frame that came meanwhile ends the run" [ $code -eq 4 ]
check "and is kept" grep -qx mine late/1.png
rm -rf late

# A record that is damaged.
mkdir odd
printf 'snowglass frames 2\nframe 400000000000 of 9 bytes 5 x\n%s\n' \
    'frame 9223372036854775807 of 9 bytes 5 x' >'odd/.%d.png.frames'
run 0 "beside a record that tells of too many frames" timeout 60 \
    "$TOOL" turntable phantom:cube --dims 8x8x8 -s 9x9 --frames 2 -q -y \
    -o 'odd/%d.png'
rm -rf odd

# A disk that is full.
mkdir disk
if mount -t tmpfs -o size=200k none disk 2>/dev/null; then
    run 4 "a full disk" turn -s 200x200 --frames 40 -o 'disk/%02d.png' \
        --bits 16
    plain_error
    says "disk/.*--resume|disk/.*[Ss]pace"
    broken=0
    for f in disk/*.png; do
        "$TOOL" compare "$f" "$f" >"$OUT" 2>&1 || broken=1
    done
    check "every frame on it is whole" [ $broken -eq 0 ]
    check "some frames got there" [ "$(ls disk/*.png | wc -l)" -gt 1 ]
    check "nothing half is on it" clean
    head -c 300k /dev/zero >disk/filler 2>/dev/null
    rm disk/0*.png disk/1*.png disk/.*frames 2>/dev/null
    head -c 300k /dev/zero >>disk/filler 2>/dev/null
    before=$(ls -A disk)
    run 4 "a disk without any room" turn -s 200x200 -o 'disk/z%d.png'
    check "gets nothing" [ "$(ls -A disk)" = "$before" ]
    run 4 "nor the movie's folder" turn -s 200x200 -o disk/z.mp4
    check "is left there" [ "$(ls -A disk)" = "$before" ]
    rm -f disk/* disk/.*frames
    run 4 "a disk that fills while a movie is made" env \
        PATH="$WORK/bin:$PATH" "$TOOL" turntable phantom:engine -q \
        -s 200x200 --frames 40 -o disk/m.mp4
    check "has no movie" absent disk/m.mp4
    check "nor anything half" [ -z "$(find disk ! -name '[0-9]*.png' \
        ! -name record -type f)" ]
    umount disk
else
    echo "skip   a full disk: no tmpfs can be mounted"
fi
if command -v prlimit >/dev/null; then
    run 4 "files that may not grow" prlimit --fsize=2000 \
        "$TOOL" turntable phantom:engine -q -s 99x99 -o 'limit%d.png'
    check "leave nothing" [ -z "$(ls -A | grep limit)" ]
fi

# Figures and talk.
run 0 "figures" turn --frames 7 -o 's%d.png' --stats -
prints '"frame": [0-9.e-]+, "total": [0-9.e-]+, "frames": \[([0-9.e-]+, ){6}[0-9.e-]+\]'
prints '"checksum": "[0-9a-f]{16}"'
prints '"ranks": 1'
list=$(sed 's/.*"frames": \[\([^]]*\)\].*/\1/' "$OUT" | tr -d , |
    tr ' ' '\n' | sort -g | sed -n 4p)
check "seconds.frame is their median" awk "BEGIN { exit !($list == $(number frame)) }"
told "the line of choices" "2 frames of 9x9 to t%d.png" "$TOOL" turntable \
    phantom:engine --dims 16x16x16 -s 9x9 --frames 2 -o 't%d.png'
check "is one" [ "$(wc -l <"$ERR")" -eq 1 ]

# Movies.
film="$TOOL turntable $small -q --frames 9"
{
    run 0 "a movie" fake "" $film -o m.mp4
    check "is the frames' bytes, in order" [ "$(wc -c <m.mp4)" -eq \
        $((60 * 44 * 3 * 9)) ]
    check "and leaves no folder" absent m.mp4.frames
    refused 4 "it is not replaced" "m.mp4: exists" fake "" $film -o m.mp4
    run 0 "but with -y" fake "" $film -o m.mp4 -y
    run 0 "of one frame" fake "" $film --frames 1 -o one.mp4
    for how in start middle die end; do
        refused 4 "an ffmpeg that fails at the $how" \
            "n.mp4: ffmpeg failed: (the codec is not|no more, th|ended by signal 9|cannot fin)" \
            fake $how $film -o n.mp4
        check "leaves no movie" absent n.mp4
        refused 4 "what it left is not thrown away" "n.mp4" fake "" $film \
            -o n.mp4
        refused 4 "nor taken for other settings" "other settings" fake "" \
            $film --zoom 3 -o n.mp4 --resume
        run 0 "but resumed" fake "" $film -o n.mp4 --resume
        check "to the same movie" cmp m.mp4 n.mp4
        check "the folder is gone" absent n.mp4.frames
        rm n.mp4
    done
    env PATH="$WORK/bin:$PATH" "$TOOL" $big --frames 3000 -o i.mp4 2>"$ERR" &
    job=$!
    started 3 'i.mp4.frames/0*.png'
    kill -TERM $job
    wait $job
    check "an interrupted movie ends with 130" [ $? -eq 130 ]
    check "is not there" absent i.mp4
    check "and nothing half in its folder" [ -z "$(find i.mp4.frames \
        ! -name '[0-9]*.png' ! -name record -type f)" ]
    refused 4 "without ffmpeg" "ffmpeg was not found on the PATH" \
        env PATH=/nonexistent $film -o p.webm
    check "there are frames" [ "$(ls p.webm.frames/*.png | wc -l)" -eq 9 ]
    printed "from which the movie is made" '"rendered": 0, "kept": 9' \
        fake "" $film -o p.webm --resume --stats -
    check "and is the same" cmp m.mp4 p.webm
    run 0 "a movie with a background" fake "" $film -o g.gif --background white
    run 1 "has it" cmp -s g.gif m.mp4
}

# The real one.
if [ "$has_ffmpeg" ]; then
    for kind in mp4 webm gif; do
        run 0 "a .$kind" turn -s 61x45 --frames 5 -o real.$kind --fps 10
        check "nothing is beside it" absent real.$kind.frames
        run 0 "ffmpeg reads it" ffmpeg -v error -i real.$kind \
            -f rawvideo -pix_fmt rgb24 frames.raw -y
        check "five frames of even sides, or as they are" \
            [ "$(wc -c <frames.raw)" -eq $((5 * 3 * $([ $kind = gif ] &&
                echo 61*45 || echo 62*46))) ]
    done
else
    echo "skip   real movies: no ffmpeg"
fi
finish
