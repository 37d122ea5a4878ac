#!/bin/bash
# --channel: several channels of a file in one picture.
. "$(dirname "$0")/../../support/shell.sh"
command -v python3 >/dev/null || {
    skipped all "there is no python3"
    exit 77
}

# An OME-TIFF of three channels, one of two and of three steps, whose values rise,
# and a larger one of four; two RGB NIfTI files, of one time step and of a vector
# for each voxel.
python3 - <<'END'
import struct

NX, NY, NZ = 20, 16, 6

def tiff(name, pages, text):
    text = text.encode() + b"\0"
    out, size = bytearray(b"II*\0" + struct.pack("<I", 0)), NX * NY
    at_text = len(out)
    out += text + b"\0" * (len(text) % 2)
    link = 4
    for n, page in enumerate(pages):
        data = len(out)
        out += bytes(page)
        here = len(out)
        struct.pack_into("<I", out, link, here)
        tags = [(256, 3, 1, NX), (257, 3, 1, NY), (258, 3, 1, 8),
                (259, 3, 1, 1), (262, 3, 1, 1), (270, 2, len(text), at_text),
                (273, 4, 1, data), (277, 3, 1, 1), (278, 3, 1, NY),
                (279, 4, 1, size)]
        if n:
            tags = [t for t in tags if t[0] != 270]
        out += struct.pack("<H", len(tags))
        for t in tags:
            out += struct.pack("<HHII", *t)
        link = len(out)
        out += struct.pack("<I", 0)
    open(name, "wb").write(bytes(out))

def inside(c, x, y, z):
    return (x - 5 - 4 * c) ** 2 + (y - 8) ** 2 + 4 * (z - 3) ** 2 < 30

def value(c, x, y, z):
    return 20 + 4 * c + 200 * inside(c, x, y, z) + (x + 3 * y + z) % 7

pages = [[value(c, x, y, z) for y in range(NY) for x in range(NX)]
         for z in range(NZ) for c in range(3)]
ome = ('<OME xmlns="http://www.openmicroscopy.org/Schemas/OME/2016-06"><Image>'
       '<Pixels DimensionOrder="XYCZT" SizeX="20" SizeY="16" SizeC="3" '
       'SizeZ="6" SizeT="1" Type="uint8" PhysicalSizeX="0.5" '
       'PhysicalSizeY="0.5" PhysicalSizeZ="1">%s</Pixels></Image></OME>')
named = "".join('<Channel ID="Channel:0:%d" Name="%s" Color="%d"/>' % row
                for row in ((0, "DAPI", 65535), (1, "GFP", 16711935),
                            (2, "far red", -16776961)))
tiff("ome.tif", pages, ome % named)
tiff("plain.tif", pages, ome % "")
tiff("long.tif", pages, ome % "".join(
    '<Channel ID="Channel:0:%d" Name="%s"/>' % row for row in (
        (0, "\u00e9" * 30), (1, "bell\a\x1b[31m"), (2, "\u20ac\ud7ff" * 9))))
data = bytearray(open("ome.tif", "rb").read())
at = data.index(b"GFP")
data[at:at + 3] = b"\xe9\xfc\xc3"
open("latin.tif", "wb").write(data)
tiff("two.tif", [p for n, p in enumerate(pages) if n % 3 < 2],
     (ome % "").replace('SizeC="3"', 'SizeC="2"'))

tiff("flat.tif", [p for z in range(NZ)
                  for p in (pages[3 * z], b"\x4d" * NX * NY)],
     (ome % "").replace('SizeC="3"', 'SizeC="2"'))
tiff("ten.tif", (pages * 4)[:60],
     (ome % "").replace('SizeC="3"', 'SizeC="10"'))

tiff("steps.tif", [[20 + (60 + 60 * t) * inside(c, x, y, z) + (x + y) % 7
                    for y in range(NY) for x in range(NX)]
                   for t in range(3) for z in range(NZ) for c in range(2)],
     (ome % "").replace('SizeC="3"', 'SizeC="2"').replace('SizeT="1"',
                                                          'SizeT="3"'))
NX = NY = 100
row = b"\12" * 20 + bytes(range(160, 220)) + b"\12" * 20
tiff("big.tif", [b"\12" * 2000 + row * 60 + b"\12" * 2000] * 400,
     (ome % "").replace('SizeC="3"', 'SizeC="4"').replace(
         'SizeZ="6"', 'SizeZ="100"').replace('"20"', '"100"').replace(
         '"16"', '"100"'))

NX = NY = 120
row = bytes(min(255, 10 + 2 * abs(x - 60)) for x in range(120))
tiff("large.tif", [b"\12" * 2400 + row * 80 + b"\12" * 2400] * 600,
     (ome % "").replace('SizeC="3"', 'SizeC="4"').replace(
         'SizeZ="6"', 'SizeZ="150"').replace('"20"', '"120"').replace(
         '"16"', '"120"'))

def nifti(name, dim, code, bits, intent, data):
    head = bytearray(352)
    struct.pack_into("<i", head, 0, 348)
    struct.pack_into("<8h", head, 40, *dim)
    struct.pack_into("<3h", head, 68, intent, code, bits)
    struct.pack_into("<8f", head, 76, 1, 1, 1, 1, 1, 1, 1, 1)
    struct.pack_into("<f", head, 108, 352)
    head[344:348] = b"n+1\0"
    open(name, "wb").write(bytes(head) + data)

ball = [(x - 8) ** 2 + (y - 8) ** 2 + (z - 8) ** 2 < 40
        for z in range(16) for y in range(16) for x in range(16)]
nifti("rgb.nii", (3, 16, 16, 16, 1, 1, 1, 1), 128, 24, 0,
      b"".join(bytes((210, 120, 60) if b else (0, 0, 0)) for b in ball))
nifti("vector.nii", (5, 16, 16, 16, 1, 3, 1, 1), 16, 32, 1007,
      struct.pack("<12288f", *[3.0 * b for b in ball], *[4.0 * b for b in ball],
                  *[0.0] * 4096))
END

render() { "$TOOL" render -q -s 60x50 "$@"; }

run 0 "info" "$TOOL" info ome.tif
prints 'channels +3 \(these values: channel 0\)'
prints ' 0  DAPI  #0000ff'
prints ' 2  far red  #ff0000'
run 0 "of a name" "$TOOL" info ome.tif --channel "FAR RED"
prints 'these values: channel 2'
run 0 "as JSON" "$TOOL" info --json ome.tif
check "lists them" python3 -c 'import json, sys
c = json.load(open(sys.argv[1]))
assert c["channel_count"] == 3 and [n["name"] for n in c["channels"]] == [
    "DAPI", "GFP", "far red"] and c["channels"][1]["color"] == [0, 1, 0]' "$OUT"

run 0 "of a component" "$TOOL" info ome.tif --component 1
prints 'these values: channel 1'
run 0 "long names" "$TOOL" info --json long.tif
check "are cut between letters" python3 -c 'import json, sys
names = [c["name"] for c in json.load(open(sys.argv[1]))["channels"]]
assert names[0] == chr(0xe9) * 19 and names[2] == (chr(0x20ac) + chr(0xd7ff)) * 6 + chr(0x20ac)
' "$OUT"
run 0 "and found" "$TOOL" info long.tif --channel ééééééééééééééééééééééééééééé
prints 'these values: channel 0'
run 0 "in text" "$TOOL" info long.tif
prints ' 1  bell\?\?\[31m'
run 0 "names that are no UTF-8" "$TOOL" info --json latin.tif
prints '"name": "\?\?\?"'

run 0 "all" "$TOOL" render ome.tif -o all.png -s 60x50 --save-config all.json
says 'channels 0 DAPI blue [0-9.]+, 1 GFP green [0-9.]+, 2 far red red [0-9.]+; .*not shaded'
run 0 "what was printed" render --config all.json -o again.png
check "is the same" cmp -s all.png again.png
run 0 "listed" render ome.tif -o list.png --channel 0:blue,gfp:green,2:red
check "is, too" cmp -s all.png list.png
run 0 "in another order" render ome.tif -o order.npy --channel 2:red,0:blue,1:green
run 0 "as numbers" render ome.tif -o all.npy
run 0 "to a float's last bit" "$TOOL" compare all.npy order.npy --tolerance 1e-5
run 0 "with other threads" render ome.tif -o threads.npy -j 5
check "the same bits" cmp -s all.npy threads.npy
run 0 "in plain C" render ome.tif -o plain.npy --isa scalar
run 0 "nearly" "$TOOL" compare all.npy plain.npy --tolerance 1e-4
run 0 "one" render ome.tif -o one.npy --channel GFP
run 0 "by its number" render ome.tif -o number.npy --channel 1
check "is the same" cmp -s one.npy number.npy
run 0 "a list of one" render ome.tif -o lone.npy --channel 1:green:40..200
run 0 "is green" python3 -c 'import struct
def sums(name):
    data = open(name, "rb").read()[-60 * 50 * 16:]
    pixels = struct.unpack("<12000f", data)
    return [sum(pixels[c::4]) for c in range(4)]
grey, green = sums("one.npy"), sums("lone.npy")
assert grey[0] == grey[1] == grey[2] > 10, grey
assert green[0] == green[2] == 0 and green[1] > 10, green'
run 0 "fainter" render ome.tif -o faint.npy --channel 1:green:40..200:0.2
check "is another" [ -n "$(cmp lone.npy faint.npy)" ]
run 0 "rays" render ome.tif -o rays.png --method raycast
run 0 "are near" "$TOOL" compare all.png rays.png --tolerance 0.8 
check "within 28 dB" python3 -c 'import sys
assert float([l.split()[1] for l in open(sys.argv[1]) if "psnr" in l][0]) > 28' "$OUT"

run 0 "two without colours" "$TOOL" render two.tif -o two.png -s 60x50
says 'channels 0 magenta .*, 1 green '
run 0 "three" "$TOOL" render plain.tif -o three.png -s 60x50
says 'channels 0 red .*, 1 green .*, 2 blue '
run 0 "one range" "$TOOL" render plain.tif -o ranged.png -s 60x50 --range 30,180
says 'channels 0 red 30..180, 1 green 30..180, 2 blue 30..180'

run 0 "a projection" render ome.tif -m mip -o mip.png --save-config mip.json
run 0 "what was printed of it" render --config mip.json -o mip2.png
check "is the same too" cmp -s mip.png mip2.png
run 0 "a slice" "$TOOL" slice ome.tif -o slice.png --save-config slice.json
says 'channels 0 DAPI blue .*, 1 GFP green '
run 0 "what was printed of that" "$TOOL" slice --config slice.json -o slice2.png
check "as well" cmp -s slice.png slice2.png
run 0 "a turntable" "$TOOL" turntable ome.tif -o t_%d.png -q --frames 2 -s 60x50
check "turns them" [ -n "$(cmp t_0.png t_1.png)" ]
run 0 "a legend" render ome.tif -o legend.png -s 300x300 --legend --channel 0:blue,2:red
run 0 "of channels without names" "$TOOL" render plain.tif -o legend2.png -s 300x300 --legend --channel 0:blue,2:red
check "has other titles" [ -n "$(cmp legend.png legend2.png)" ]
check "and no note" [ "$(grep -c note "$ERR")" = 0 ]
# Labels of an overlay are named beside the bars.
for name in liver spleen; do
    printf '%s\n' NRRD0004 'type: uint8' 'dimension: 3' 'sizes: 20 16 6' 'encoding: raw' \
        Segment0_LabelValue:=1 Segment0_Name:=$name '' >$name.nrrd
    { head -c 960 /dev/zero | tr '\0' '\1'; head -c 960 /dev/zero; } >>$name.nrrd
    for verb in render "slice --axis z"; do
        # shellcheck disable=SC2086
        run 0 "$verb with $name" "$TOOL" $verb ome.tif --channel 0:blue,2:red \
            --overlay $name.nrrd -s 300x300 -q -o "$name-${verb%% *}.png"
        # shellcheck disable=SC2086
        run 0 "and a legend" "$TOOL" $verb ome.tif --channel 0:blue,2:red --legend \
            --overlay $name.nrrd -s 300x300 -q -o "$name-${verb%% *}-legend.png"
    done
done
for verb in render slice; do
    check "$verb draws the same" cmp -s liver-$verb.png spleen-$verb.png
    check "and names each" [ -n "$(cmp liver-$verb-legend.png spleen-$verb-legend.png)" ]
done
run 0 "in a small picture" "$TOOL" render ome.tif --channel 0,1,2,0:grey --legend \
    --overlay liver.nrrd -s 128x128 -o small.png
check "says that it does not" grep -q 'has no room for the names of the labels' "$ERR"
run 0 "one of many" "$TOOL" render plain.tif -o legend3.png -s 300x300 --legend --channel 0,1,2,0:grey,1:cyan
says 'note: the picture has no room for the colour bar of channel 1$'
says 'note: the picture has no room for the scale bar$'
check "and says each once" [ "$(grep -c note "$ERR")" = 2 ]
run 0 "frames of many" "$TOOL" turntable plain.tif -o n_%d.png -s 300x300 --frames 3 --legend --channel 0,1,2,0:grey,1:cyan,2:hot
check "say each once" [ "$(grep -c note "$ERR")" = 3 ]
"$TOOL" convert ome.tif --channel 2 -q -o third.nrrd
cat >npy.py <<'END'
import struct
def pixels(name):
    return struct.unpack("<12000f", open(name, "rb").read()[-60 * 50 * 16:])
END
run 0 "opacities in a projection" render ome.tif -m mip -o half.npy --channel 0:blue:20..230:0.5
run 0 "of another" render ome.tif -m mip -o most.npy --channel 1:#00ffff:20..230:0.8
run 0 "and of both" "$TOOL" render ome.tif -s 60x50 -m mip -o both.npy --channel 0:blue:20..230:0.5,1:#00ffff:20..230:0.8
says 'channels 0 blue 20..230 opacity 0.5, 1 #00ffff 20..230 opacity 0.8;'
run 0 "and of none" render ome.tif -m mip -o whole.npy --channel 0:blue:20..230
check "are factors on light, which adds up" python3 -c 'from npy import pixels
half, most, both, whole = map(pixels, ("half.npy", "most.npy", "both.npy", "whole.npy"))
assert max(whole) > 0.9
for n in range(12000):
    alpha = n % 4 == 3
    assert abs(half[n] - (1 if alpha else 0.5) * whole[n]) < 1e-5, n
    light = max(half[n], most[n]) if alpha else half[n] + most[n]
    assert abs(both[n] - min(light, both[n // 4 * 4 + 3])) < 1e-5, n'
run 0 "half the light of a slice" "$TOOL" slice ome.tif -q -o half.png --channel 0:blue:20..230:0.5,1:green:20..230:0.5
run 0 "over twice the range" "$TOOL" slice ome.tif -q -o twice.png --channel 0:blue:20..440,1:green:20..440
run 0 "is the same" "$TOOL" compare half.png twice.png --tolerance 0.005
run 0 "a scale that is linear near 0" render ome.tif -o symlog.npy --scale symlog:5 --channel 0:blue:2..250,1:green:2..250
run 0 "and nearly opaque" render ome.tif -o symlog2.npy --scale symlog:5 --channel 0:blue:2..250:0.999999,1:green:2..250:0.999999
run 0 "is nearly the same" "$TOOL" compare symlog.npy symlog2.npy --tolerance 1e-4
run 0 "a linear one" render ome.tif -o linear.npy --channel 0:blue:2..250,1:green:2..250
check "is another" [ -n "$(cmp symlog.npy linear.npy)" ]
run 0 "faint insides" render ome.tif -o edges.npy --gradient-opacity 0:0,200:1 --channel 0:blue:2..250
run 0 "nearly opaque too" render ome.tif -o edges2.npy --gradient-opacity 0:0,200:1 --channel 0:blue:2..250:0.999999
run 0 "are nearly the same" "$TOOL" compare edges.npy edges2.npy --tolerance 1e-4
run 0 "a file of one" render third.nrrd -o red.npy --channel 0:red
check "is red" python3 -c 'from npy import pixels
p = pixels("red.npy")
assert sum(p[0::4]) > 10 and sum(p[1::4]) == sum(p[2::4]) == 0'
refused 2 "its second" 'channel 1 does not exist; the voxels have 1' \
    "$TOOL" render third.nrrd -o z.png --channel 0:red,1:blue

run 0 "a movie" "$TOOL" movie steps.tif -o m_%d.npy -s 60x50
says 'tif: .* channels 0 magenta [0-9.]*206, 1 green [0-9.]*206; '
check "without a note" [ "$(grep -c note "$ERR")" = 0 ]
check "has colours that rise with the values" python3 -c 'from npy import pixels
light = []
for n in range(3):
    p = pixels("m_%d.npy" % n)
    assert abs(sum(p[0::4]) - sum(p[2::4])) < 1e-2
    assert sum(map(min, p[0::4], p[1::4])) < 0.9 * sum(p[0::4]), n
    light.append(sum(p[0::4]))
assert light[0] < light[1] < light[2], light'
run 0 "a movie of many" "$TOOL" movie steps.tif -o o_%d.png -s 300x300 --legend --channel 0,1,0:blue,0:grey,1:hot
check "says what its legend lacks" [ "$(grep -c 'note: .*no room .* of channel 1$' "$ERR")" = 1 ]
run 0 "a movie of a list" "$TOOL" movie steps.tif -o l_%d.npy -q -s 60x50 --channel 1:green,0:magenta
run 0 "in another order" "$TOOL" compare m_0.npy l_0.npy --tolerance 1e-5
run 0 "a movie of maxima" "$TOOL" movie steps.tif -o p_%d.npy -s 60x50 -m mip
says 'channels 0 magenta 20..206, 1 green 20..206'
run 0 "pictures" "$TOOL" movie steps.tif -o r_%d.png -q -s 60x50
cp r_1.png kept.png && rm r_1.png
run 0 "that are resumed" "$TOOL" movie steps.tif -o r_%d.png -q -s 60x50 --resume
check "are the same" cmp -s r_1.png kept.png

run 0 "more than the memory" "$TOOL" render big.tif -o big.png -s 40x40 --memory 3M
says 'note: channel 0 of 4 .*several need 3.8 MiB of memory, over the 3.0 MiB of --memory$'
run 0 "beside what is made of them" "$TOOL" render big.tif -o big2.png -s 40x40 -j 2 --memory 5M
says 'note: channel 0 of 4 .*several need more memory$'
run 0 "the first" render big.tif -o big3.png -s 40x40 --channel 0
check "is drawn as ever" cmp -s big.png big3.png
check "beside others, too" cmp -s big2.png big3.png
refused 5 "a list of more" 'channel: several need 1.9 MiB of memory, over the 1.5 MiB of --memory; give one' \
    "$TOOL" render big.tif -o z.png -s 40x40 --memory 1500K --channel 1,2
for way in "" "-m mip" "--azimuth 40 --channel 0:red:0.3,2:green:p1..p99"; do
    # shellcheck disable=SC2086
    run 0 "several in memory $way" render large.tif -y -o whole.npy -j 2 $way
    # shellcheck disable=SC2086
    run 0 "in slabs" "$TOOL" render large.tif -y -o slabs.npy -s 60x50 -v -j 2 --memory 7M $way
    says 'large.tif: stays in its file'
    check "all of them" [ "$(grep -c note "$ERR")" = 0 ]
    check "the same bits" cmp -s whole.npy slabs.npy
done
run 0 "a list of one in slabs" "$TOOL" render big.tif -y -v -o slabs.npy -s 40x40 -j 1 --memory 3M --channel 1:green
says 'stays in its file'
run 0 "and in memory" render big.tif -o slabs2.npy -s 40x40 --channel 1:green
check "is the same" cmp -s slabs.npy slabs2.npy
run 0 "a slice of more" "$TOOL" slice big.tif -o big4.png --memory 3M
says 'channels 0 cyan .*, 3 red '

for way in "" "-m mip" "--memory 200M -j 1"; do
    # shellcheck disable=SC2086
    run 0 "a channel of one value $way" "$TOOL" render flat.tif -y -o flat.npy -s 60x50 --fit volume $way
    says 'channels 0 magenta [0-9.]+, 1 green 77..154; '
    # shellcheck disable=SC2086
    run 0 "without it" render flat.tif -y -o rest.npy --fit volume --channel 0:magenta $way
    run 0 "is the same" "$TOOL" compare flat.npy rest.npy --tolerance 0.001
done
run 0 "its slice" "$TOOL" slice flat.tif -q -o flat.png
run 0 "alone" "$TOOL" slice flat.tif -q -o rest.png --channel 0:magenta
run 0 "is black" "$TOOL" compare flat.png rest.png --tolerance 0.001
run 0 "asked for" render flat.tif -y -o flat.npy --fit volume --channel 0:magenta,1:green:0..77
check "is seen" [ -n "$(cmp flat.npy rest.npy)" ]
run 0 "more than eight" "$TOOL" render ten.tif -o ten.png -s 60x50
says 'note: the file has 10 channels, of which the first 8 are taken; --channel 0,9 shows others$'
says ' 7 hot [0-9.]+; '
run 0 "the last ones" "$TOOL" render ten.tif -o last.png -s 60x50 --channel 9:red,8:green
says 'channels 9 red [0-9.]+, 8 green [0-9.]+; '
check "without a note" [ "$(grep -c note "$ERR")" = 0 ]

run 0 "an overlay" render ome.tif --overlay third.nrrd --overlay-look 100:0,200:1 -o over.png
check "is seen too" [ -n "$(cmp over.png all.png)" ]

run 0 "colours of voxels" "$TOOL" render rgb.nii -o rgb.png -s 40x40 --background '#000' --no-labels
says 'channels 0 red 0..255, 1 green 0..255, 2 blue 0..255'
run 0 "as numbers" render rgb.nii -o rgb.npy
check "keep their hue" python3 -c 'import struct
data = open("rgb.npy", "rb").read()
pixels = struct.unpack("<%df" % (60 * 50 * 4), data[-60 * 50 * 16:])
r, g, b, a = pixels[(25 * 60 + 30) * 4:(25 * 60 + 30) * 4 + 4]
assert a > 0.98 and 0.7 < r < 0.83, (r, a)
assert abs(g / r - 12 / 21) < 0.05 and abs(b / r - 6 / 21) < 0.05, (r, g, b)'
run 0 "a vector" "$TOOL" info vector.nii
prints 'components +3 \(these values: the magnitude\)'
prints 'values +0 .. 5,'
run 0 "its y" "$TOOL" info vector.nii --component y
prints 'values +0 .. 4,'

run 0 "a mode of one" "$TOOL" render ome.tif -m mean -o mean.png -s 60x50
says 'note: channel 0 of 3 .*several need mode over, mip or minip'
refused 2 "a list in it" 'channel: several need mode over, mip or minip; give one channel, such as --channel 1$' \
    "$TOOL" render ome.tif -m sum -o z.png --channel 1,2
refused 2 "a list of another method" 'several need method shear-warp or raycast' \
    "$TOOL" render ome.tif --method footprint -o z.png --channel 1,2
refused 2 "a list with depths" 'depths .* are of one volume' \
    "$TOOL" render ome.tif --depth z.npy -o z.png --channel 1,2
refused 2 "a list with a preset" 'a list has colours of its own' \
    "$TOOL" render ome.tif --preset linear -o z.png --channel 1,2
refused 2 "no such name" "there is no channel 'YFP'; the file has 0 DAPI, 1 GFP, 2 far red$" \
    "$TOOL" render ome.tif -o z.png --channel 0,YFP
refused 2 "no such number" 'channel 3 does not exist; the voxels have 3' \
    "$TOOL" render ome.tif -o z.png --channel 0,3
refused 2 "no colour" "'puce' is no colour: give red" \
    "$TOOL" render ome.tif -o z.png --channel 0:puce
refused 2 "no range" "'5..x' is no range" \
    "$TOOL" render ome.tif -o z.png --channel 0:5..x
refused 2 "no opacity" "'1.5' is no opacity from 0 to 1" \
    "$TOOL" render ome.tif -o z.png --channel 0:1.5
refused 2 "too many" 'up to 8 are shown together' \
    "$TOOL" render ome.tif -o z.png --channel 0,1,2,0,1,2,0,1,2
run 0 "a pipe" bash -c '"$1" render - -o pipe.png -s 60x50 <ome.tif' - "$TOOL"
says 'note: channel 0 of 3 .*this input can be read once'
refused 2 "a list of a pipe" 'this input can be read once; give one channel' \
    bash -c '"$1" slice - -o z.png --channel 0,1 <ome.tif' - "$TOOL"
refused 2 "a list for another verb" 'only pictures mix channels' \
    "$TOOL" convert ome.tif -o z.nrrd --channel 0,1
finish
