#!/bin/bash
# bench speed: its figures have their keys and hang together, its charts are
# well-formed, and what it cannot do it refuses before it measures anything.
. "$(dirname "$0")/../../support/shell.sh"

# Python is a tool of the tests, not of Snowglass.
need_python

speed() { "$TOOL" bench speed --quick "$@"; }

run 0 "one quick run" speed --json --threads 1,2 --only rgba
cp "$OUT" all.json
check "all figures are there and hang together" python3 - all.json <<'END'
import json, math, sys

told = json.load(open(sys.argv[1]))
assert told["bench"] == "speed"
machine = told["machine"]
for key in ("cpu", "version", "compiler", "flags", "isa", "isa_found",
            "processors", "load_average", "vectors"):
    assert key in machine, key
assert [p["threads"] for p in machine["power"]] == [1, 2], machine["power"]
assert all(p["read_gb_per_s"] > 0 and p["gflop_per_s"] > 0
           for p in machine["power"])
rows = told["rows"]
numbers = """side threshold sparse_ratio interesting_voxels footprint threads
    median_ms min_ms cpu_ms frames_per_second interesting_voxels_per_second
    read_share flop_share largest_difference frames frames_encoded""".split()
for row in rows:
    for key in numbers:
        assert isinstance(row[key], (int, float)), (key, row)
    for key in ("volume", "source", "dims", "look", "colors", "shade", "way",
                "method", "kernel", "isa", "psnr", "encode_ms", "times_tested",
                "encode_gb_per_s", "new_threshold_ms", "times_original",
                "cpu_times_original", "bytes_per_interesting_voxel"):
        assert key in row, (key, row)
    assert row["verified"] is True
    # Work that n threads divide takes at least an n-th of the time.
    for n in (8, 16, 64):
        times = row["predicted_%d_threads" % n]
        assert times is None or (row["threads"] == 1 and 0 < times <= n), row
        # On a busy machine one item may wait for most of a short picture.
        assert (times or row["threads"] > 1 or row["method"] != "shear-warp" or
                2 * row["longest_items_ms"] > row["min_ms"] - row["serial_ms"]
                ), row
    assert row["threads"] > 1 or row["times_one_thread"] == 1, row
    assert row["threads"] > 1 or 0 <= row["serial_ms"] <= row["min_ms"], row
    assert 0 < row["min_ms"] <= row["median_ms"], row
    assert math.isclose(row["frames_per_second"], 1000 / row["median_ms"])

def pick(**wanted):
    return [r for r in rows if all(r.get(k) == v for k, v in wanted.items())]

for look in ("translucent", "opaque"):
    for shade in ("unshaded", "phong"):
        case = pick(look=look, colors="rgba", shade=shade)
        ways = {(r["way"], r["threads"]) for r in case}
        for way in ("footprint crs", "footprint bitmap", "footprint rle",
                    "shear-warp draft", "shear-warp normal", "shear-warp high",
                    "shear-warp normal crs", "shear-warp normal bitmap",
                    "shear-warp normal rle"):
            assert {(way, 1), (way, 2)} <= ways, (way, ways)
        for way in ("original", "tested"):
            # one for each kernel, on one thread
            assert [r["threads"] for r in case
                    if r["way"] == way] == [1, 1], way

# A ratio is against the baseline with the same kernel.
case = pick(look="opaque", colors="rgba", shade="phong")
for row in case:
    for name in ("original", "original-table", "tested"):
        base, = [r for r in case
                 if r["way"] == name and r["kernel"] == row["kernel"]]
        assert math.isclose(row["times_" + name.replace("-", "_")],
                            base["median_ms"] / row["median_ms"]), row

# A footprint table is coarse, but not as coarse as another picture.
for row in pick(way="original-table"):
    assert 48 <= row["psnr"] < 90 and 0 < row["largest_difference"] < 0.05, row

# What is drawn while the view turns keeps its encoding; a new threshold does
# not, and its time is told.
for row in pick(method="shear-warp"):
    assert row["frames_encoded"] == 0, row
    assert row["encode_ms"] > 0 and row["encode_gb_per_s"] > 0, row
    assert row["new_threshold_ms"] > row["encode_ms"], row
    assert row["bytes_per_interesting_voxel"] > 1, row
END

run 0 "a table of text" speed --only rgba,unshaded,translucent,normal,shear-warp
prints '^machine: .*processors; (gcc|.*[Cc]lang)'
prints '^flags: .* isa .* load average [0-9.]+$'
prints '^1 thread: reads [0-9.]+ GB/s, [0-9]+ GFLOP/s'
prints '^Engine 40x40x32 \(phantom:engine\), translucent rgba unshaded, 64x64, threshold 10: sparse'
prints '^shear-warp normal  *tent  *2   1 '
prints '^threads  *serial% '
check "only what was asked for" \
    [ -z "$(grep -E 'original|tested|footprint|draft|opaque|phong' "$OUT" |
        grep -v '^tested:\|^rates;\|^way ')" ]

printed "raycast where it is named" '^raycast draft  *tent  *2   1 ' \
    speed --only raycast,rgba,unshaded,translucent --threads 1
prints '^raycast normal  *tent  *2   1 '

run 0 "two sizes" speed --sizes 48,32 --only grey,unshaded,opaque,crs,footprint \
    --threads 1 --json
check "two rows" [ "$(grep -c '"way"' "$OUT")" -eq 2 ]

# well_formed FILE: XML, with as many panels, and lines with points, as told.
well_formed() {
    python3 - "$@" <<'END'
import sys, xml.etree.ElementTree as tree

root = tree.parse(sys.argv[1]).getroot()
name = "{http://www.w3.org/2000/svg}"
assert root.tag == name + "svg"
words = {text.text for text in root.iter(name + "text")}
for word in sys.argv[3:]:
    assert word in words, (word, words)
# Marks: a point of the panel is a circle or a path of the line's colour.
lines = [line.get("points").split() for line in root.iter(name + "polyline")]
assert sum(len(line) > 1 for line in lines) >= int(sys.argv[2]), lines
width, height = float(root.get("width")), float(root.get("height"))
for line in lines:
    for point in line:
        x, y = map(float, point.split(","))
        assert 0 < x < width and 0 < y < height, point
END
}
run 0 "a chart against size" speed --sweep size --chart size.svg --threads 1
check "it is whole" well_formed size.svg 14 phantom:engine phantom:head 24 40 \
    "shear-warp, draft" "shear-warp, normal" original "original, by a table" \
    tested "footprint, RLE" \
    "milliseconds per frame (median)"
run 0 "a chart, of sparse ratios unless told" speed --chart sparse.svg \
    --threads 1 --json
check "it is whole" well_formed sparse.svg 7 "phantom:head 40x40x32" \
    "phantom:cube 40x40x32" 30 100
check "its figures were printed" grep -q '"sparse_ratio"' "$OUT"
check "nothing is left beside them" \
    [ "$(echo *.svg*)" = "size.svg sparse.svg" ]

refused 4 "a chart that exists" "size.svg: exists" speed --chart size.svg
refused 4 "a chart in no folder" "No such file" speed --chart no/where.svg
refused 3 "a folder without volumes" "nowhere/classic/CThead.*: No such file|nowhere/classic/engine.*: No such file" \
    "$TOOL" bench speed --data nowhere
refusals 2 "$TOOL" bench <<'END'
speed --quik|there is no option '--quik'
speed --qui|there is no option '--qui'
speed --sizes 0|this value is not possible: '0'
speed --sizes 64,|this value is not possible: '64,'
speed --sizes 64,x|this value is not possible: '64,x'
speed --sizes ' 64'|this value is not possible: ' 64'
speed --sizes 1,2,3,4,5,6,7,8,9|this value is not possible
speed --threads 0|this value is not possible: '0'
speed --threads two|this value is not possible: 'two'
speed --runs 4|this value is not possible: '4'
speed --sweep time|this value is not possible: 'time'
speed --chart ''|this value is not possible: ''
speed --only shiny|knows no 'shiny'; choose from: translucent
speed --only rgba,|knows no ''
speed --volumes engin|there is no volume 'engin'; choose from: engine
speed --volumes bonsai|bonsai is a file; give --data
speed --quick --volumes engine|leave out '--volumes'
speed --quick --large|leave out '--large'
speed --sweep size --volumes engine|leave out '--volumes'
speed --sweep sparse --large|leave out '--large'
speed --sweep size --sizes 64,32|all but one of '--sizes'
speed --quick --data x|leave out '--data'
speed --chart x.svg --data x|leave out '--data'
speed --kernel tent|bench speed: there is no option '--kernel'
speed --azimuth=3|there is no option '--azimuth=3'
figure11 --threads 2|bench figure11: there is no option '--threads'
table2 --threads 2|bench table2: there is no option '--threads'
speed table1|there is no option 'table1'
END

# VTK's files, as far as the bench reads them: right, and damaged.
python3 - <<'END'
import os, struct, zlib

def write(folder, voxels, cut=0, size=None, head="UInt8"):
    os.makedirs(folder + "/classic")
    blocks = [voxels[i:i + 1000] for i in range(0, len(voxels), 1000)]
    packed = [zlib.compress(block) for block in blocks]
    last = len(blocks[-1]) % 1000
    header = struct.pack(f"<{3 + len(packed)}Q", size or len(packed), 1000,
                         last, *map(len, packed))
    xml = ('<VTKFile type="ImageData" version="1.0" byte_order="LittleEndian" '
           'header_type="UInt64" compressor="vtkZLibDataCompressor">\n'
           '<ImageData WholeExtent="0 15 0 15 0 11" Origin="0 0 0" '
           'Spacing="1 1 1"><Piece Extent="0 15 0 15 0 11"><PointData>\n'
           f'<DataArray type="{head}" Name="v" format="appended" offset="0"/>\n'
           '</PointData></Piece></ImageData>\n'
           '<AppendedData encoding="raw">\n _')
    data = xml.encode() + header + b"".join(packed)
    with open(folder + "/classic/bonsai.vti", "wb") as file:
        file.write(data[:len(data) - cut] if cut else data + b"</AppendedData>")

voxels = bytes(x * y % 256 for y in range(16) for x in range(16)) * 12
write("good", voxels)
write("cut", voxels, cut=40)
write("many", voxels, size=2**62)
write("short", voxels[:-1])
write("long", voxels + b"x")
write("float", voxels, head="Float32")
END
vti() { "$TOOL" bench speed --volumes bonsai --sizes 32 --threads 1 --data "$1" \
    --only tested,original,rgba,unshaded,translucent,tent; }
printed "a volume of VTK's" '^Bonsai 16x16x12 \(classic/bonsai.vti\)' vti good
check "it has its voxels" grep -q "sparse $(python3 -c '
v = [x * y % 256 for y in range(16) for x in range(16)]
print("%.1f" % (100 * sum(0.2 * x <= 10.0001 for x in v) / len(v)))') %" "$OUT"
for how in cut float $(long_tier && echo many short long); do
    run 3 "a volume of VTK's: $how" vti $how
    says "bonsai.vti: .*; the bench reads 8-bit .vti files"
done
finish
