#!/bin/bash
# What is unknown, not built or malformed is refused with exit code 2 and the
# right words, before any file is looked at.
. "$(dirname "$0")/../../support/shell.sh"

refusals 2 "$TOOL" <<'END'
--azimoth 3 x|--azimoth: unknown option; did you mean --azimuth\?
--thresold=3 x|did you mean --threshold\?
--ambient 0.5 x|--ambient: unknown option
--flurb x|--flurb: unknown option; see snowglass help render
-Z x|-Z: unknown option
--s 3 x|matches several options
--overwrite=3 x|--overwrite takes no value
info --roll 3 x|--roll: is not an option of info but of render
x --json|--json: is not an option of render but of info
--scale ln x|is unknown; choose from: linear, log, symlog, symlog:X
--scale symlog:0 x|out of range
--box edges x|'edges' is unknown; choose from: outline, axes
--legend= x|--legend: needs a value after =
--annotate date x|'date' is unknown
--kernel gaus:5 x|did you mean gauss\?
--cmap bone x|--cmap: is here --colormap NAME$
slice --clim=0,9 x|--clim: is here --range LO,HI$
-q info x|info: the verb must come first; give snowglass info
rendr x -o y.png|rendr: is not a verb; did you mean render\?
x y -o z.png|x: is neither a verb nor a file; verbs: render turntable movie
view F|view: is neither a verb nor a file; verbs: render turntable movie slice info
-q view F -o z.png|view: is neither a verb nor a file
trun-table x -o y.mp4|trun-table: is not a verb; did you mean turntable\?
Inof x|Inof: is not a verb; did you mean info\?
render view F|F: is one word too many for render
x.nii y -o z.png|y: is one word too many for render
"$TOOL" "$TOOL" -o z.png|too many for render; give one file or, of slices, their folder
render -o z.png|give snowglass render INPUT \[-o OUT\]
compare a.png|give snowglass compare A B
phantom cube|no output file given
-|no output file given; add -o OUT.png
phantom:cube -o x.bmp|x.bmp
phantom snowman -o x.nrrd|snowman
phantom cube -o x.txt|x.txt
turntable -o y.mp4|give snowglass turntable INPUT -o OUT
turntable x y -o y.mp4|one word too many for turntable
convert a b|one word too many for convert
--perspective=wide x -o y.png|--perspective: 'wide' is out of range; give a decimal number from 0.001 to 120
--perspective=150 x -o y.png|--perspective: '150' is out of range
--perspective 0 x|--perspective: '0' is out of range
--perspective= x -o y.png|--perspective: needs a value
--perspective x.nii y -o y.png|one word too many
x.nii --legend 'v (K)' -o y.png|v \(K\): .* a legend follows a =: --legend="v \(K\)"
--persp x -o y.png|did you mean --perspective
info --perspective x|is not an option of info
--labels 1 phantom:marschner-lobb -o y.png|--labels: picks whole numbers, and these values are fractions
convert phantom:marschner-lobb -o y.nrrd --labels 1|--labels: picks whole numbers
info phantom:marschner-lobb --labels 1|--labels: picks whole numbers
--labels= x -o y.png|--labels
--mask= x -o y.png|--mask
phantom --mask m cube -o y.nrrd|--mask: is not an option of phantom
--azim 10 x|--azim: unknown option; did you mean --azimuth
--encod x|--encod: unknown option; did you mean --encoding
--crop 0:1,0:1 x|--crop: 
--series= x|--series
--patient x|--patient: is not an option of render but of info
--quality best x|'best' is unknown; choose
--quality hgih x|'hgih' is unknown \(did you mean high\?\); choose from: draft
--mode MPI x|'MPI' is unknown \(did you mean mip\?\); choose from: over
--method cast x|'cast' is unknown \(did you mean raycast\?\)
--type unit8 x|'unit8' is not a voxel type \(did you mean uint8\?\); choose from: int8
--preset bone x|--preset: 'bone' is unknown; did you mean ct-bone, ct-bones or ct-cropped-volume-bone\? snowglass help preset
--preset ct-bnoe x|did you mean ct-bone\?
--preset Angio x|did you mean mr-angio\?
-c 9:#ff0000,5:#00ff00 x|--colormap: '9:#ff0000,5:#00ff00' is no list of colours: must be at most 32 VALUE:#RRGGBB, values rising
-c 9:red x|--colormap: '9:red' is no list of colours
-c viridi x|--colormap: 'viridi' is unknown; did you mean viridis\? snowglass help colormap
--view axail x|--view: 'axail' is unknown; did you mean axial\?
--frames 3 x|--frames: is not an option of render but of turntable
movie --frames 3 x -o y.mp4|--frames: is not an option of movie
--resume x|--resume: is not an option of render but of turntable
turntable x -o y.mp4 --fps 0|--fps: '0' is out of range
--mode iso x|--mode iso: needs --iso VALUE too
--iso 3 x|--iso: needs --mode iso too
--iso high x|--iso: 'high' is not a finite number
--depth d.png x|--depth: d.png cannot hold depths
--depth d.npy -m mip x -o y.png|--depth: mode mip has no depth; use mode over or iso
--depth y.npy x -o y.npy|--depth: is the same file as --output; name two files, or use one .exr
turntable --depth d.npy x -o y.mp4|--depth: frames hold depths in their own files
turntable --depth y_%d.exr x -o z_%d.exr|--depth: frames hold depths in their own files
turntable --depth y_%d.png x -o y_%d.png|--depth: frames hold depths in their own files
movie --depth y_%d.exr x -o y_%d.exr -m mip|--depth: mode mip has no depth
--mode best x|'best' is unknown
--method ray x|'ray' is unknown
--method tested x|'tested' is unknown
--isa sse9 x|'sse9' is unknown
--hlep|--hlep: unknown option; did you mean --help\?
--darkening x|did you mean --depth-darkening\?
--size 0 x|--size: '0' is not a picture size; give WIDTHxHEIGHT
--size|--size: needs a value
-s|--size: needs a value
--bits 12 x|choose from: 8, 16
--background balck x|is not a colour \(did you mean black\?\);
--light kye x|is not a light \(did you mean key\?\);
--encoding zip x|choose from: auto, crs, bitmap, rle
--encoding '' x|choose from
--kernel cube x|choose from: auto, tent, gauss, bspline, box
--position 1,2 x|is not a position
--target 1,2,nan x|is not a position
--up up x|is not a position
--shade flat x|choose from: phong, none
--light 30 x|give key, head, or AZIMUTH,ELEVATION
--material 2,0,0,1 x|is not a material; give AMBIENT,DIFFUSE,SPECULAR from 0 to 1
--depth-darkening 2 x|from 0 to 1
--occlusion 1.5 x|from 0 to 1
--type int7 x|choose from: int8 uint8 int16
--endian middle x|choose from: little, big
--time soon x|'soon' is not a time step; give its number, last
--time 2:8 x|render shows one step, and a range of them is for movie
--preset toast x|--preset: 'toast' is unknown; choose from: linear, ct-aaa
--colormap beige x|--colormap: 'beige' is unknown; choose from: grey, viridis
--view upside x|--view: 'upside' is unknown; choose from: anterior, .*-z, .*axial
--view '' x|--view: '' is unknown
info nope.nii --preset foo|--preset: 'foo' is unknown
--progress some x|choose from: auto, always, never
--stats x.png phantom:cube -o x.png|name two files
compare --tolerance 2 a b|is not a difference
compare --tolerance 1/0 a b|is not a difference
x -o y.npy --background white|work only for PNG, WebP and JPEG
x -o y.pfm --bits 16|work only for PNG, WebP and JPEG
END

# Each of these values of an option.
while IFS='|' read -r option values pattern; do
    eval "set -- $values"
    for value in "$@"; do
        refused 2 "$option '$value'" "$pattern" "$TOOL" $option "$value" x
    done
done <<'END'
--memory|lots 0 1.5Q|is not an amount of memory
--labels|1,b 7-4|is not a list of labels
--clip|1,0,0 0,0,0,1 1,0,0,1,2 1,0,0,1,1,0,0,1,1,0,0,1,1,0,0,1,1,0,0,1,1,0,0,1,1,0,0,1 1,0,0,nan|are not planes
-j|5000 0 many|whole number
-s|512, 40000 0x10 40000x40000 8x8x8 ' 8x8' 8.5x8|is not a picture size
--background|brick '#12' 1,2,3|is not a colour
--threshold|256 -1 nan|from 0 to 255
--kernel|auto:1 gauss:10 box:3.5|from 2 to 9
--azimuth|nan inf 1e999 0x10 3deg ''|is not a finite number
--zoom|0 -2|out of range
--opacity|80 80:2 80:0.1,70:0.2 80:0.1,|VALUE:OPACITY
--gradient-opacity|80 0:0,20:2 9:0,8:1|MAGNITUDE:FACTOR
--range|3,2 3,nan p99,p1 p1,99 p1,p101|is not a range
--window|0,5 0,40|out of range
--window|400, 400,40,1 400,nan|is not a window
--material|1,0,0,-1 1,0,0|is not a material
--dims|8x8 8x8x0 8x8x-8 9999999999999999999x1x1|are not dimensions
--spacing|1x1x0 1x1xinf|is not a spacing
--offset|-1 99999999999999999999|whole number of 0 or more
END

# These need a volume to be found wrong.
refusals 2 "$TOOL" phantom:cube --dims 8x8x8 -o z.png <<'END'
--window 3|is not a window; give its width and its centre
--window 400,abc|is not a window
--window 3,3 --range 1,2|conflicts with --range
--type uint8|type
END
# The bench reads its own options.
refusals 2 "$TOOL" bench <<'END'
table1 --dat x|there is no option '--dat'
table1 --dat=x|there is no option '--dat=x'
table1 --he|there is no option '--he'
table1 --foo|there is no option '--foo'
table1 --runs|a value is missing after '--runs'
table1 --runs 4|this value is not possible: '4'
table1 --kernel cube|this value is not possible: 'cube'
table4|there is no benchmark 'table4'
table1 table2|there is no option 'table2'
--json|there is no benchmark '--json'
END
for table in table1 table2 table3; do
    refused 3 "bench $table without its files" \
        "nowhere/classic/CThead.*: No such file" \
        "$TOOL" bench $table --data nowhere
done
run 0 "bench -h" "$TOOL" bench -h

for name in "--preset CT_Bone" "-c gray" "-c CoolWarm" "--view Left" \
    "--view Axial" "--mode MIP" "--method Shear-Warp" "--quality HIGH" \
    "--type UINT8" "--light Head" "--range FULL" "--background White" \
    "--shade None" "--fit Volume" "--encoding CRS" "--size 16" \
    "--window 400,40"; do
    refused 3 "$name is a name" "nope.nii" \
        "$TOOL" render nope.nii -o z.png $name
done
refused 2 "two choices in one" "'crs.rle' is unknown" \
    "$TOOL" --encoding 'crs|rle' x
check "nothing was written" [ -z "$(ls)" ]

# Started as one of several processes: only the first says so, and works.
picture() {
    env "$@" "$TOOL" phantom:cube --dims 8x8x8 -s 8x8 -y -o z.npy
}
note='one of 2 processes that were started by .*snowglass-mpi shares'
while read -r first second; do
    told "$first $second" "^snowglass: this is $note" picture "$first" "$second"
done <<'END'
OMPI_COMM_WORLD_SIZE=2 OMPI_COMM_WORLD_RANK=0
PMI_SIZE=2 PMI_RANK=0
SLURM_STEP_NUM_TASKS=2 SLURM_PROCID=0
END
while read -r first second; do
    run 0 "$first $second" picture "$first" "$second"
    not_said 'one of'
done <<'END'
OMPI_COMM_WORLD_SIZE=2 OMPI_COMM_WORLD_RANK=1
OMPI_COMM_WORLD_SIZE=1 OMPI_COMM_WORLD_RANK=0
SLURM_NTASKS=2 SLURM_PROCID=0
END
run 0 "quietly one of two" env PMI_SIZE=2 "$TOOL" -q phantom:cube \
    --dims 8x8x8 -s 8x8 -y -o z.npy
silent
run 0 "another verb" env PMI_SIZE=2 "$TOOL" info phantom:cube --dims 8x8x8
silent
finish
