#!/bin/bash
# --channel: several channels of a file in one picture.
. "$(dirname "$0")/../../support/shell.sh"
need_python

# OME-TIFFs of three channels, of two and of three steps, whose values rise, and
# larger ones of four; two NIfTI files, of colours and of a vector for each voxel.
python3 - <<'END'
import struct
from volumes import channel_words, each, nifti, ome_tiff

DIMS = 20, 16, 6

def inside(c, x, y, z):
    return (x - 5 - 4 * c) ** 2 + (y - 8) ** 2 + 4 * (z - 3) ** 2 < 30

def value(c, x, y, z):
    return 20 + 4 * c + 200 * inside(c, x, y, z) + (x + 3 * y + z) % 7

def page(of):
    return each(DIMS[:2], of)

pages = [page(lambda x, y, c=c, z=z: value(c, x, y, z))
         for z in range(DIMS[2]) for c in range(3)]
two = [p for n, p in enumerate(pages) if n % 3 < 2]
named = channel_words(("DAPI", 65535), ("GFP", 16711935), ("far red", -16776961))
ome_tiff("ome.tif", DIMS, pages, named)
ome_tiff("plain.tif", DIMS, pages)
ome_tiff("two.tif", DIMS, two)
ome_tiff("long.tif", DIMS, pages, channel_words(
    ("\u00e9" * 30,), ("bell\a\x1b\u009b[31m",), ("\u20ac\ud7ff" * 9,)))
with open("ome.tif", "rb") as file, open("latin.tif", "wb") as out:
    out.write(file.read().replace(b"GFP", b"\xe9\xfc\xc3", 1))
ome_tiff("flat.tif", DIMS, [p for n in range(0, 18, 3)
                            for p in (pages[n], b"\x4d" * 320)])
ome_tiff("ten.tif", DIMS, (pages * 4)[:60])
ome_tiff("steps.tif", DIMS, [page(
    lambda x, y, c=c, z=z, t=t: 20 + (60 + 60 * t) * inside(c, x, y, z) + (x + y) % 7)
    for t in range(3) for z in range(DIMS[2]) for c in range(2)], times=3)
row = b"\12" * 20 + bytes(range(160, 220)) + b"\12" * 20
ome_tiff("big.tif", (100,) * 3, [b"\12" * 2000 + row * 60 + b"\12" * 2000] * 400)
row = bytes(min(255, 10 + 2 * abs(x - 60)) for x in range(120))
ome_tiff("large.tif", (120, 120, 150),
         [b"\12" * 2400 + row * 80 + b"\12" * 2400] * 600)

ball = [(x - 8) ** 2 + (y - 8) ** 2 + (z - 8) ** 2 < 40
        for z in range(16) for y in range(16) for x in range(16)]
nifti("rgb.nii", (16, 16, 16), (128, 24),
      b"".join(bytes((210, 120, 60) if b else (0, 0, 0)) for b in ball))
nifti("vector.nii", (16, 16, 16, 1, 3), (16, 32), struct.pack(
    "<12288f", *[3.0 * b for b in ball], *[4.0 * b for b in ball], *[0.0] * 4096),
    intent=1007)
END
cat >npy.py <<'END'
import struct
def pixels(name):
    return struct.unpack("<12000f", open(name, "rb").read()[-60 * 50 * 16:])
def sums(name):
    return [sum(pixels(name)[c::4]) for c in range(4)]
END
export PYTHONPATH=$PYTHONPATH:$WORK

picture() { "$TOOL" render -s 60x50 -y "$@"; }
render() { picture -q "$@"; }
notes() { check "$NAME: $1 notes" [ "$(grep -c note "$ERR")" = "$1" ]; }

# --- what info says -------------------------------------------------------------
printed "info" 'channels +3 \(these values: channel 0\)' "$TOOL" info ome.tif
prints ' 0  DAPI  #0000ff'
prints ' 2  far red  #ff0000'
printed "of a name" 'these values: channel 2' "$TOOL" info ome.tif --channel "FAR RED"
printed "of a component" 'these values: channel 1' "$TOOL" info ome.tif --component 1
run 0 "as JSON" "$TOOL" info --json ome.tif
check "lists them" python3 -c 'import json, sys
c = json.load(open(sys.argv[1]))
assert c["channel_count"] == 3 and [n["name"] for n in c["channels"]] == [
    "DAPI", "GFP", "far red"] and c["channels"][1]["color"] == [0, 1, 0]' "$OUT"
run 0 "long names" "$TOOL" info --json long.tif
check "are cut between letters" python3 -c 'import json, sys
names = [c["name"] for c in json.load(open(sys.argv[1]))["channels"]]
assert names[0] == chr(0xe9) * 19 and names[2] == (chr(0x20ac) + chr(0xd7ff)) * 6 + chr(0x20ac)
' "$OUT"
printed "and found" 'these values: channel 0' \
    "$TOOL" info long.tif --channel ééééééééééééééééééééééééééééé
printed "in text" ' 1  bell\?{3}\[31m' "$TOOL" info long.tif
printed "names in Latin-1" '"name": "éüÃ"' "$TOOL" info --json latin.tif
printed "a vector" 'components +3 \(these values: the magnitude\)' "$TOOL" info vector.nii
prints 'values +0 .. 5,'
printed "its y" 'values +0 .. 4,' "$TOOL" info vector.nii --component y

# --- ways to draw them ----------------------------------------------------------
printf '%s\n' NRRD0004 'type: uint8' 'dimension: 3' 'sizes: 20 16 6' 'encoding: raw' \
    Segment0_LabelValue:=1 Segment0_Name:=liver '' >liver.nrrd
{ head -c 960 /dev/zero | tr '\0' '\1'; head -c 960 /dev/zero; } >>liver.nrrd
sed 's/=liver/=spleen/' liver.nrrd >spleen.nrrd
"$TOOL" convert ome.tif --channel 2 -q -o third.nrrd
symlog="ome.tif --scale symlog:5 --channel" edges="ome.tif --gradient-opacity 0:0,200:1 --channel"
pairs npy render -s 60x50 <<END
listed | ome.tif | = | ome.tif --channel 0:#4d4dff,gfp:green,2:red
composited | ome.tif -m over | = | ome.tif --channel 0:blue,gfp:green,2:red -m over
with other threads | ome.tif | = | ome.tif -j 5
in another order | " | 1e-5 | ome.tif --channel 2:red,0:#4d4dff,1:green
in plain C | " | 1e-4 | ome.tif --isa scalar
beside an overlay | " | != | ome.tif --overlay third.nrrd --overlay-look 100:0,200:1
one, by its number | ome.tif --channel GFP | = | ome.tif --channel 1
fainter | ome.tif --channel 1:green:40..200 | != | ome.tif --channel 1:green:40..200:0.2
linear | $symlog 0:blue:2..250,1:green:2..250 | != | ome.tif --channel 0:blue:2..250,1:green:2..250
nearly opaque | " | 1e-4 | $symlog 0:blue:2..250:0.999999,1:green:2..250:0.999999
nearly opaque edges | $edges 0:blue:2..250 | 1e-4 | $edges 0:blue:2..250:0.999999
END
run 0 "a list of one" render ome.tif -o lone.npy --channel 1:green:40..200
run 0 "and one" render ome.tif -o one.npy --channel GFP
run 0 "a file of one" render third.nrrd -o red.npy --channel 0:red
check "have colours, or none" python3 -c 'from npy import sums
grey, green, red = map(sums, ("one.npy", "lone.npy", "red.npy"))
assert grey[0] == grey[1] == grey[2] > 10, grey
assert green[0] == green[2] == 0 and green[1] > 10, green
assert red[1] == red[2] == 0 and red[0] > 10, red'
told "all" 'channels 0 DAPI blue [0-9.]+, 1 GFP green [0-9.]+, 2 far red red [0-9.]+; .*not shaded' \
    picture ome.tif -o all.png -m over
run 0 "rays" render ome.tif -o rays.png --method raycast -m over
run 0 "are near" "$TOOL" compare all.png rays.png --tolerance 0.8
check "within 28 dB" python3 -c 'import sys
assert float([l.split()[1] for l in open(sys.argv[1]) if "psnr" in l][0]) > 28' "$OUT"
for verb in "render -s 60x50" "render -s 60x50 -m mip" slice; do
    run 0 "$verb" "$TOOL" $verb ome.tif -q -y -o all.png --save-config all.json
    run 0 "by what was saved" "$TOOL" ${verb%% *} -q --config all.json -y -o again.png
    same_file "is the same" all.png again.png
    rm all.json
done
while IFS='|' read -r words pattern; do
    told "$words" "channels $pattern" picture -o told.png -y $words
done <<'END'
two.tif|0 magenta .*, 1 green .*; mode mip 
two.tif -m over|0 magenta .*, 1 green .*; opacity per voxel
two.tif --shade phong|0 magenta .*, 1 green .*; opacity per voxel
plain.tif|0 red .*, 1 green .*, 2 #4d4dff 
plain.tif -m over|0 red .*, 1 green .*, 2 blue 
plain.tif --range 30,180|0 red 30..180, 1 green 30..180, 2 #4d4dff 30..180
ten.tif --channel 9:red,8:green|9 red [0-9.]+, 8 green [0-9.]+; 
rgb.nii|0 red 0..255, 1 green 0..255, 2 blue 0..255
END
told "a slice" 'channels 0 DAPI #4d4dff .*, 1 GFP green ' "$TOOL" slice ome.tif -o slice.png
run 0 "a turntable" "$TOOL" turntable ome.tif -o t_%d.png -q --frames 2 -s 60x50
other_file "turns them" t_0.png t_1.png

# --- legends: labels of an overlay are named beside the bars --------------------
pairs png <<END
titles | render ome.tif -s 300 --legend --channel 0:blue,2:red | != | \
    render plain.tif -s 300 --legend --channel 0:blue,2:red
END
for verb in render "slice --axis z"; do
    pairs png $verb ome.tif --channel 0:blue,2:red -s 300 <<END
$verb without names | --overlay liver.nrrd | = | --overlay spleen.nrrd
$verb with names | --legend --overlay liver.nrrd | != | --legend --overlay spleen.nrrd
END
done
many="-s 128 --legend --channel 0,1,2,0:grey,1:cyan"
told "one of many" 'note: the picture has no room for the colour bar of channel 2$' \
    "$TOOL" render plain.tif -o legend.png $many
notes 3
run 0 "frames of many" "$TOOL" turntable plain.tif -o n_%d.png --frames 3 $many,2:hot
notes 3

# --- opacities in a projection --------------------------------------------------
run 0 "half" render ome.tif -m mip -o half.npy --channel 0:blue:20..230:0.5
run 0 "most of another" render ome.tif -m mip -o most.npy --channel 1:#00ffff:20..230:0.8
told "both" 'channels 0 blue 20..230 opacity 0.5, 1 #00ffff 20..230 opacity 0.8;' \
    picture ome.tif -m mip -o both.npy --channel 0:blue:20..230:0.5,1:#00ffff:20..230:0.8
run 0 "and whole" render ome.tif -m mip -o whole.npy --channel 0:blue:20..230
check "are factors on light, which adds up" python3 -c 'from npy import pixels
half, most, both, whole = map(pixels, ("half.npy", "most.npy", "both.npy", "whole.npy"))
assert max(whole) > 0.9
for n in range(12000):
    alpha = n % 4 == 3
    assert abs(half[n] - (1 if alpha else 0.5) * whole[n]) < 1e-5, n
    light = max(half[n], most[n]) if alpha else half[n] + most[n]
    assert abs(both[n] - min(light, both[n // 4 * 4 + 3])) < 1e-5, n'
pairs png slice <<END
half the light, over twice the range | ome.tif --channel 0:blue:20..230:0.5,1:green:20..230:0.5 \
    | 0.005 | ome.tif --channel 0:blue:20..440,1:green:20..440
END

# --- movies ---------------------------------------------------------------------
told "a movie" 'tif: .* channels 0 magenta [0-9.]*206, 1 green [0-9.]*206; ' \
    "$TOOL" movie steps.tif -o m_%d.npy -s 60x50
notes 0
check "has colours that rise with the values" python3 -c 'from npy import pixels
light = []
for n in range(3):
    p = pixels("m_%d.npy" % n)
    assert abs(sum(p[0::4]) - sum(p[2::4])) < 1e-2
    assert sum(map(min, p[0::4], p[1::4])) < 0.9 * sum(p[0::4]), n
    light.append(sum(p[0::4]))
assert light[0] < light[1] < light[2], light'
run 0 "a movie of many" "$TOOL" movie steps.tif -o o_%d.png -s 128x128 --legend --channel 0,1,0:blue,0:grey,1:hot
check "says what its legend lacks" [ "$(grep -c 'note: .*no room .* of channel 1$' "$ERR")" = 1 ]
run 0 "a movie of a list" "$TOOL" movie steps.tif -o l_%d.npy -q -s 60x50 --channel 1:green,0:magenta
run 0 "in another order" "$TOOL" compare m_0.npy l_0.npy --tolerance 1e-5
told "a movie of maxima" 'channels 0 magenta 28.9162..206, 1 green 29.4058..206' \
    "$TOOL" movie steps.tif -o p_%d.npy -s 60x50 -m mip
cp p_1.npy kept.npy && rm p_1.npy
run 0 "that is resumed" "$TOOL" movie steps.tif -o p_%d.npy -q -s 60x50 -m mip --resume
same_file "is the same" p_1.npy kept.npy

# --- more than the memory -------------------------------------------------------
told "more than the memory" \
    'note: channel 0 of 4 .*several need 3.9 MiB of memory, over the 3.0 MiB of --memory$' \
    picture big.tif -o big.npy --memory 3M -m over
told "beside what is made of them" 'note: channel 0 of 4 .*several need more memory$' \
    picture big.tif -o big2.npy -j 2 --memory 5M -m over
run 0 "the first" render big.tif -o big3.npy --channel 0 -m over
same_file "is drawn as ever" big.npy big3.npy
same_file "beside others, too" big2.npy big3.npy
refused 5 "a list of more" 'channel: several need 1.9 MiB of memory, over the 1.5 MiB of --memory; give one' \
    "$TOOL" render big.tif -o z.png -s 40x40 --memory 1500K --channel 1,2
ways=("-m over --azimuth 40 --channel 0:red:0.3,2:green:p1..p99" "-m over" "-m mip")
[ -z "${SNOW_SANITIZED-}" ] || ways=("${ways[0]}") # each takes them ten seconds
for way in "${ways[@]}"; do
    run 0 "several in memory $way" render large.tif -o whole.npy -j 2 $way
    told "in slabs" 'large.tif: stays in its file' \
        picture large.tif -o slabs.npy -v -j 2 --memory 7M $way
    notes 0
    same_file "the same bits" whole.npy slabs.npy
done
told "a list of one in slabs" 'stays in its file' \
    picture big.tif -v -o slabs.npy -j 1 --memory 3M --channel 1:green -m over
run 0 "and in memory" render big.tif -o whole.npy --channel 1:green -m over
same_file "is the same" slabs.npy whole.npy
told "a slice of more" 'channels 0 cyan .*, 3 red ' "$TOOL" slice big.tif -o big4.png --memory 3M

# --- a channel of one value, and more than eight --------------------------------
for way in "" "-m mip" "--memory 200M -j 1"; do
    told "a channel of one value $way" 'channels 0 magenta [0-9.]+, 1 green 77..154; ' \
        picture flat.tif -o flat.npy --fit volume $way
    run 0 "without it" render flat.tif -o rest.npy --fit volume --channel 0:magenta $way
    run 0 "is the same" "$TOOL" compare flat.npy rest.npy --tolerance 0.001
done
pairs png <<END
its slice is black | slice flat.tif | 0.001 | slice flat.tif --channel 0:magenta
asked for, it is seen | render flat.tif -s 60x50 --fit volume --channel 0:magenta,1:green:0..77 \
    | != | render flat.tif -s 60x50 --fit volume --channel 0:magenta
END
told "more than eight" \
    'note: the file has 10 channels, of which the first 8 are taken; --channel 0,9 shows others$' \
    picture ten.tif -o ten.png
says ' 7 hot [0-9.]+; '
run 0 "colours of voxels as numbers" render rgb.nii -o rgb.npy
check "keep their hue" python3 -c 'from npy import pixels
r, g, b, a = pixels("rgb.npy")[(25 * 60 + 30) * 4:][:4]
assert a > 0.98 and 0.7 < r < 0.83, (r, a)
assert abs(g / r - 12 / 21) < 0.05 and abs(b / r - 6 / 21) < 0.05, (r, g, b)'

# --- refused --------------------------------------------------------------------
told "a mode of one" 'note: channel 0 of 3 .*several need mode over, mip or minip' \
    picture ome.tif -m mean -o mean.png
refusals 2 "$TOOL" render ome.tif -o z.png <<'END'
-m sum --channel 1,2|channel: several need mode over, mip or minip; give one channel, such as --channel 1$
--method footprint --channel 1,2|several need method shear-warp or raycast
--depth z.npy --channel 1,2|depths .* are of one volume
--preset linear --channel 1,2|a list has colours of its own
--channel 0,YFP|there is no channel 'YFP'; the file has 0 DAPI, 1 GFP, 2 far red$
--channel 0,3|channel 3 does not exist; the voxels have 3
--channel 0:puce|'puce' is no colour: give red
--channel 0:5..x|'5..x' is no range
--channel 0:1.5|'1.5' is no opacity from 0 to 1
--channel 0,1,2,0,1,2,0,1,2|up to 8 are shown together
END
refusals 2 "$TOOL" <<'END'
render third.nrrd -o z.png --channel 0:red,1:blue|channel 1 does not exist; the voxels have 1
convert ome.tif -o z.nrrd --channel 0,1|only pictures mix channels
END
told "a pipe" 'note: channel 0 of 3 .*this input can be read once' \
    bash -c '"$1" render - -o pipe.png -s 60x50 <ome.tif' - "$TOOL"
refused 2 "a list of a pipe" 'this input can be read once; give one channel' \
    bash -c '"$1" slice - -o z.png --channel 0,1 <ome.tif' - "$TOOL"
finish
