#!/bin/bash
# Inputs that cannot be read give exit code 3, outputs that cannot be written
# 4, always with the file's name; what was there before stays byte for byte.
. "$(dirname "$0")/../../support/shell.sh"

mkdir folder folder.png
: >empty.nrrd
: >empty.raw
head -c 1000 /dev/zero >short.raw
printf 'NRRD0004\ntype: uint8\ndimension: 3\nsizes: 8 8\n' >bad.nrrd

raw_cube eight.raw 8
printf 'NRRD0004\ntype: uint8\ndimension: 3\nsizes: 8 8 8\nencoding: raw
data file: eight.raw\n\n' >eight.nhdr
given() { cat "$1" | "$TOOL" "${@:2}"; }
for verb in info "render -o z.png"; do
    refusals 3 "$TOOL" $verb <<'END'
missing.nrrd|missing.nrrd
folder|folder
empty.nrrd|empty.nrrd
empty.raw|empty.raw
bad.nrrd|bad.nrrd
short.raw --dims 16x16x16 --type uint8|short.raw
short.raw --dims 4000000000x4000000000x8 --type uint8|short.raw
END
done
flat="--dims 8x8x8 --type uint8 --spacing 1e-30x1e30x1e30 --view +z -o z.png"
refusals 3 <<'END'
"$TOOL" eight.raw $flat|^snowglass: eight.raw: voxels of .* cannot be shown at zoom
given eight.raw - $flat|^snowglass: standard input: voxels of
given eight.nhdr info -|^snowglass: standard input: .*eight.raw
"$TOOL" info ""|^snowglass: [^:]
"$TOOL" compare "" eight.raw|^snowglass: [^:]
given empty.raw info -|^snowglass: standard input: [^:]*empty
"$TOOL" compare - -|^snowglass: standard input: is a dev
"$TOOL" compare missing.png missing.png|missing.png
"$TOOL" compare short.raw short.raw|short.raw
"$TOOL" -q missing.nrrd -o z.png|^snowglass: missing.nrrd: 
END
run 0 "a header and its data" "$TOOL" info eight.nhdr
# shellcheck disable=SC2086
run 0 "voxels 2^31 times as wide as high" "$TOOL" eight.raw --dims 8x8x8 \
    --type uint8 --view +z --spacing 1x2147483648x1 --quality high -o flat.png
odd=$(printf 'odd\nname\033[2J.nrrd')
echo >"$odd"
run 3 "a name with line ends and escapes" "$TOOL" info "$odd"
plain_error
check "no escape reaches the terminal" bash -c '! grep -q $'"'\\033'"' "$1"' - "$ERR"
check "no picture is left of any of these" absent z.png

small="phantom:cube --dims 16x16x16 -s 16x16"
render() { "$TOOL" $small "$@"; }

echo precious >there.png
cp there.png kept
refused 4 "an existing output" "there.png" render -o there.png
check "it is kept byte for byte" cmp -s there.png kept
run 0 "with -y it is replaced" render -o there.png -y
check "by a picture" is_png there.png

echo precious >stats.json
cp stats.json kept
refused 4 "existing figures" "stats.json" render -o a.png --stats stats.json
check "they are kept byte for byte" cmp -s stats.json kept
check "and no picture is written" absent a.png
run 0 "with -y they are replaced" render -o a.png --stats stats.json -y
check "by JSON" grep -q '^{"version"' stats.json

mkdir figures
echo old >figures/target.json
chmod 640 figures/target.json
ln -s figures/target.json link.json
refused 4 "a link to figures" "link.json" render -o l.png --stats link.json
run 0 "with -y figures follow a link" render -o l.png --stats link.json -y
check "the link is still one" [ -L link.json ]
check "its target keeps its permissions" \
    [ "$(stat -c %a figures/target.json)" = 640 ]
check "and is new" grep -q '^{"version"' figures/target.json
ln -s nowhere.json dangling.json
refused 4 "figures at a link to nowhere" "dangling.json: exists" \
    render -o d.png --stats dangling.json
check "no picture is made" absent d.png
long=$(printf 'n%.0s' $(seq 255))
run 0 "figures of the longest name" render -o n.png --stats "$long"
check "are figures" grep -q '^{"version"' "$long"
check "nothing is left aside" [ -z "$(find . -name '*.snow-*')" ]

# What comes into being while the picture is made is kept: the picture goes to
# a pipe, and the figures' place is taken before the pipe is read.
mkfifo slow.png
render --progress always -o slow.png --stats raced.json 2>"$ERR" &
job=$!
await writing "$ERR" || fail "a picture waits for its pipe"
echo precious >raced.json
timeout 60 cat slow.png >"$OUT"
check "a picture through a pipe is whole" is_png "$OUT"
wait $job
check "figures whose place was taken meanwhile are refused" [ $? -eq 4 ]
NAME="they"
says "raced.json: exists"
check "what took it is kept" [ "$(cat raced.json)" = precious ]

echo precious >there.nrrd
cp there.nrrd kept
refused 4 "an existing phantom" "there.nrrd" \
    "$TOOL" phantom cube --dims 8x8x8 -o there.nrrd
check "is kept byte for byte" cmp -s there.nrrd kept

refused 4 "a folder as output" "folder" render -o folder.png -y
tiny="phantom:cube --dims 8x8x8"
for output in folder folder/ nowhere/ /; do
    for verb in "render $tiny" "turntable $tiny" "convert $tiny" "tf convert ct-bone"; do
        refused 4 "$verb to the folder $output" \
            "^snowglass: $output: is a folder; give the name of a file in it$" \
            "$TOOL" $verb -o $output
    done
done
# What is wrong with the input comes first: it is mended first.
echo precious >t_0000.png
refusals 3 "$TOOL" <<'END'
bad.nrrd -o there.png|^snowglass: bad.nrrd: 
short.raw --dims 8x8x8 --type int32 -o folder|short.raw: has 1000 bytes
bad.nrrd -o a.png --stats stats.json|^snowglass: bad.nrrd: 
bad.nrrd -o a.png --save-config stats.json|^snowglass: bad.nrrd: 
turntable bad.nrrd -o t_%04d.png|^snowglass: bad.nrrd: 
END
refused 2 "raw data without dims and an existing output" "give --dims" \
    "$TOOL" short.raw -o there.png
refusals 4 "$TOOL" <<'END'
eight.raw --dims 8x8x8 --type uint8 -o there.png|there.png: 
$small -o nowhere/a.png|nowhere
$small -o b.png --stats nowhere/s.json|nowhere
$small -o b.png --stats folder -y|folder
$small -o kept/a.png|kept
$small -o a.npy --depth folder|^snowglass: folder: is a folder
END
check "and no picture is written" absent b.png
if [ "$(id -u)" -ne 0 ]; then
    mkdir locked && chmod 555 locked
    refused 4 "a folder without permission" "locked" render -o locked/a.png
fi

# Under a limit of address space; sanitizers do not start there.
limited() { (ulimit -v 1500000 && "$@"); }
if limited "$TOOL" --version >/dev/null 2>&1; then
    refused 5 "a volume beyond the memory" "memory" \
        limited "$TOOL" phantom:cube --dims 1500x1500x1500 -o huge.png
    refused 5 "a picture beyond the memory" "memory" \
        limited "$TOOL" phantom:cube --dims 8x8x8 -s 32768x32768 -o huge.png
    check "leaves no picture" absent huge.png
fi

if [ -c /dev/full ]; then
    full() { "$@" >/dev/full; }
    tool() { "$TOOL" "$@"; }
    while IFS='|' read -r command pattern; do
        run 4 "$command to a full device" $command
        says "$pattern"
    done <<'END'
full render -q -o -|standard output
full tool --help|standard output
full tool info -q phantom:cube|snowglass: 
render -q -o c.png --stats /dev/full|/dev/full
END
    check "the device is still a device" [ -c /dev/full ]
fi
closed() { "$@" >&-; }
run 4 "a closed standard output" closed "$TOOL" doctor
run 4 "a picture to a closed standard output" closed render -q -o -

gone() {
    "$@" 2>err.txt | true
    return "${PIPESTATUS[0]}"
}
run 4 "a reader that went away" gone \
    "$TOOL" -q phantom:cube --dims 16x16x16 -s 2048x2048 --background white \
    --bits 16 -o -
check "nothing is left aside" [ -z "$(ls -A | grep -E 'snow-|XXXX')" ]
# Sizes that a file cannot hold are its fault, whatever memory there is.
printf 'NRRD0004\ntype: uint8\ndimension: 3\nsizes: 90000 90000 90000\nencoding: raw\n\n12345678' \
    >large.nrrd
printf 'ObjectType = Image\nNDims = 3\nDimSize = 90000 90000 90000\nElementType = MET_UCHAR\nElementDataFile = LOCAL\n12345678' \
    >large.mha
refusals 3 "$TOOL" render -o large.png <<'END'
large.nrrd|large.nrrd: has 8 bytes left where the voxels need 729000000000000
large.mha|large.mha: has 8 bytes left where the voxels need 729000000000000
END

# A raw file of the wrong size: its bytes, and what fits.
zeros() { head -c "$1" /dev/zero >"$2"; }
zeros 1000000 head_100x100x113_uint8.raw
zeros 327680 half_u16.raw
zeros 1009 prime.raw
zeros 640000 slices.raw
refusals 3 "$TOOL" -o z.png <<'END'
head_100x100x113_uint8.raw|has 1000000 bytes .* need 1130000 .100x100x113 uint8.*fits: 100x100x100 uint8$
slices.raw --dims 80x80x50 --type float32|fits: 80x80x50 uint16 or int16, 80x80x25 float32$
END
refusals 2 "$TOOL" -o z.png <<'END'
half_u16.raw --type float32|; what fits: 64x64x20 float32$
prime.raw --type uint8|is raw data of 1009 bytes; give --dims XxYxZ and --type .uint8, int16, float32, \.\.\..$
half_u16.raw|^snowglass: half_u16.raw: is raw data of 327680 bytes; give --dims.*; what fits: 64x64x40 uint16$
END
check "no dims are made up" [ "$(grep -c . "$ERR")" = 1 ]
zeros 64352 plain.raw
run 7 "a picture of a raw file with a header" "$TOOL" plain.raw --dims 40x40x40 --type uint8 -s 9x9 \
    -o long.png
check "one note on its size" [ "$(grep -c 'plain.raw: has\|plain.raw: .* ignored' "$ERR")" = 1 ]
zeros 64007 odd.raw
told "a raw file with some bytes more" "odd.raw: 7 bytes after the data ignored" \
    "$TOOL" info odd.raw --dims 40x40x40 --type uint8
check "once" [ "$(wc -l <"$ERR")" = 1 ]

# Libraries underneath print by themselves: a damaged file has our line alone.
cp "$HERE/../fuzz/corpus/dicom/jpeg_little" jpeg.dcm
printf '\0\0\0' | dd of=jpeg.dcm bs=1 seek=967 conv=notrunc 2>/dev/null
for way in info "render -o jpeg.png"; do
    refused 3 "$way of damaged JPEG" "^snowglass: jpeg.dcm: " "$TOOL" $way jpeg.dcm
    check "no library says more" [ "$(grep -vc '^snowglass: note: ' "$ERR")" = 1 ]
done

cp "$HERE/../fuzz/corpus/hdf5/latest" groups.h5
printf '\0\0\0\0' | dd of=groups.h5 bs=1 seek=459 conv=notrunc 2>/dev/null
if [ -n "${SNOW_SANITIZED-}" ]; then
    skipped "damaged groups of HDF5" "libhdf5 leaks them where it may end"
else
    refused 3 "damaged groups of HDF5" "^snowglass: groups.h5: " "$TOOL" info groups.h5
fi
if "$TOOL" info "$HERE/../fuzz/corpus/dicom/jpeg_of_12_bits" >"$OUT" 2>"$ERR"; then
    check "12 bits need no word of a library" \
        [ "$(grep -vc '^snowglass: note: ' "$ERR")" = 0 ]
fi

# --- what the system lacks ----------------------------------------------------

faulty=$(dirname "$TOOL")/tests/libfaulty_calls.so
if [ -e "$faulty" ]; then
    mkdir bin calm
    printf '#!/bin/sh\n' >bin/ffmpeg
    chmod +x bin/ffmpeg
    run 0 "a volume" "$TOOL" phantom shells --dims 8x8x8 -o p.nrrd
    fault() {
        local fault=$1 out=$2
        shift 2
        PATH=$PWD/bin:$PATH SNOW_FAULT=$fault LD_PRELOAD=$faulty "$TOOL" \
            turntable p.nrrd -o "$out" --frames 3 -s 16x16 -q "$@"
    }
    run 0 "a movie" fault none calm/m.webp --save-config calm/c.json
    run 0 "a movie into whose writes signals come" fault interrupt m.webp \
        --save-config c.json --stats s.json
    check "it is the same" cmp m.webp calm/m.webp
    check "so is its recipe" cmp <(sed 's|"../p|"p|' calm/c.json) c.json
    check "its figures are whole" grep -q '"kept": 0}}$' s.json
    refused 4 "a movie that cannot be joined" 'with --resume' \
        fault join calm/r.webp
    run 0 "it is resumed" fault none calm/r.webp --resume
    check "it is the same" cmp calm/r.webp calm/m.webp
    refused 1 "no thread" 'no thread .* \(ulimit -u\)' fault threads t.webp
    refused 4 "no process" 'ffmpeg: .*allow more \(ulimit -u\)' \
        fault spawn t.mp4
    cp "$HERE/../fuzz/corpus/hdf5/plain" p.h5
    if ls "$(dirname "$TOOL")"/snowglass-*/libsnowglass-hdf5.so >/dev/null 2>&1
    then
        refused 3 "no more files" 'needs .*; close other files' \
            env SNOW_FAULT=files LD_PRELOAD="$faulty" "$TOOL" info p.h5
        # From too little memory to start on, up to enough to read the file.
        limited() {
            local kib=24000 done=1 signals=0
            until [ "$done" = 0 ] || [ "$kib" -gt 200000 ]; do
                (ulimit -v $kib && exec "$TOOL" info -q p.h5) >/dev/null 2>&1
                done=$?
                signals=$((signals + (done > 127 && done != 127)))
                kib=$((kib + 128))
            done
            [ "$done" = 0 ] && [ "$signals" = 0 ]
        }
        check "libhdf5 has memory, or is not used" limited
    fi

    # Each look-up fails once: the command is refused, or does what it does
    # without a fault; what it does is the last state.
    look() { # WHAT STATUS COMMAND...
        local what=$1 status=$2 number=0 odd=0 met=1
        shift 2
        run 0 "slices" "$TOOL" phantom shells --dims 8x8x8 -o p.nrrd -y
        while [ "$met" = 1 ] && [ "$number" -lt 99 ]; do
            rm -rf looked
            mkdir -p looked/d.a1
            cp bright.png looked/d.a1/1.png
            cp bright.png looked/d.a1/2.png
            cp p.nrrd many.json looked
            ln -s p.nrrd looked/link.nrrd
            number=$((number + 1))
            (cd looked && SNOW_FAULT=look SNOW_LOOK=$number LD_PRELOAD=$faulty \
                "$TOOL" "$@" -q) 2>"$ERR"
            done=$?
            met=$([ -e looked/met ]; echo $((1 - $?)))
            rm -f looked/met
            echo "$done $(cd looked && find . ! -name '.*.frames' -printf '%y%p ' |
                sort)" >>"states_$what"
        done
        check "$what: status" [ "$done" = "$status" ]
        check "$what: look-ups" [ "$number" -gt 2 ]
        check "$what: nothing else" [ "$(sort -u "states_$what" |
            grep -c '^0 ')" -le $((status == 0)) ]
    }
    run 0 "a slice" "$TOOL" slice p.nrrd -o bright.png -s 8x8
    run 0 "a recipe" "$TOOL" turntable p.nrrd -o f_%d.png --frames 2 -s 16x16 \
        --save-config many.json
    look recipe 0 --config many.json
    look link 0 convert p.nrrd -o link.nrrd -y
    look same 2 p.nrrd -o q.png --stats ./q.png -s 16x16
    look name 0 d.a1 -s 16x16
else
    skipped "faults of the system" "their library is not built"
fi

finish
