/* option_table.c - every option, verb and topic of the command line, as data.
 *
 * A row is one option: name, letter, argument, topic, verbs, reader, field,
 * range, choices that are not built yet, help.  A row made with LATER is known
 * but not built: it is refused by name, with its text as the advice, so that a
 * script for a later version fails here at once and says why.
 *
 * Names of rows are the user's; a row's place decides where its help stands.
 * Verbs and topics that are not built are rows as well. */
#include "readers.h"

#include <stddef.h>

#define FIELD(name) offsetof(options, name)
#define LATER(name, letter, argument, topic, advice) \
    { name, letter, argument, topic, RENDER, NULL, 0, 0, 0, "", advice }

/* Shorter names for sets of verbs: the rows are dense enough. */
enum {
    TURNTABLE = VERB_TURNTABLE,
    MOVIE = VERB_MOVIE,
    MOVIES = VERB_TURNTABLE | VERB_MOVIE,
    RENDER = VERB_RENDER | MOVIES, /* all that render */
    INFO = VERB_INFO,
    PHANTOM = VERB_PHANTOM,
    COMPARE = VERB_COMPARE,
    DOCTOR = VERB_DOCTOR,
    CONVERT = VERB_CONVERT,
    TF = VERB_TF,
    LOOKED = RENDER | VERB_INFO, /* a volume with a look */
    INPUT = LOOKED | CONVERT,    /* all that read one */
    EVERY = INPUT | VERB_PHANTOM | VERB_COMPARE | VERB_DOCTOR | VERB_HELP | TF
};

/* clang-format off */
const option_row option_table[] = {
    {"output", 'o', "FILE", TOPIC_OUTPUT, RENDER | PHANTOM | CONVERT | TF,
     read_text,
     FIELD(output), 0, 0, "",
     "where to write: .png .webp, of floats .npy .exr .tif .pfm, or - for a PNG "
     "on standard output; a movie: .mp4 .webm .gif .webp, or frames by a pattern "
     "such as f_%04d.png; a volume: .nrrd .nii .nii.gz .mha .npy .raw .raw.gz"},
    {"size", 's', "WxH", TOPIC_OUTPUT, RENDER, read_size, FIELD(size), 0, 0, "",
     "pixels of the picture (512x512)"},
    {"background", 0, "COLOR|none", TOPIC_OUTPUT, RENDER, read_color,
     FIELD(background), 0, 0, "",
     "lay a PNG or WebP on a colour: a name, #rgb, #rrggbb or r,g,b of 0 to 1 "
     "(none: it stays transparent, a movie by ffmpeg black)"},
    {"bits", 0, "8|16", TOPIC_OUTPUT, RENDER, read_choice, FIELD(bits), 0, 0,
     "", "bits a channel of the PNG (8)"},
    {"overwrite", 'y', NULL, TOPIC_OUTPUT, RENDER | PHANTOM | CONVERT | TF,
     read_flag,
     FIELD(overwrite), 0, 0, "",
     "replace files that exist, of --output, --depth and --stats (they are "
     "kept)"},
    {"depth", 0, "FILE", TOPIC_OUTPUT, VERB_RENDER, read_text, FIELD(depth), 0,
     0, "", "of modes over and iso: a file of numbers (.npy, .pfm, .exr, .tif), world "
     "distances from the target's plane along the line of sight to where opacity passes 1/2, or to "
     "the surface; NaN elsewhere; the .exr of --output itself gets them as channel Z"},

    {"mode", 'm', "over|mip|minip|mean|sum|iso", TOPIC_MODE, RENDER, read_choice,
     FIELD(mode), 0, 0, "",
     "how the voxels that a ray meets make a pixel: laid over one another, the "
     "largest or smallest value, its mean or its sum along the ray, or the "
     "surface of --iso; all but over take every voxel, and files of numbers "
     "(.npy, .pfm, .exr, .tif) hold mean and sum in data units (over)"},
    {"iso", 0, "VALUE", TOPIC_MODE, RENDER, read_real, FIELD(iso), 0, 0, "",
     "data value of the surface of mode iso: where rays first meet it, shaded"},

    {"threshold", 0, "T", TOPIC_SPARSE, LOOKED, read_real, FIELD(threshold), 0,
     255, "", "a voxel with opacity greater than T of 255 is interesting; info "
     "lists 0, 10 and 30 (0)"},
    {"encoding", 0, "auto|crs|bitmap|rle", TOPIC_SPARSE, RENDER, read_choice,
     FIELD(encoding), 0, 0, "",
     "how the places of interesting voxels are kept (auto)"},
    {"method", 0, "auto|original|footprint|sheared", TOPIC_SPARSE, RENDER,
     read_choice, FIELD(method), 0, 0, "",
     "original splats every voxel, footprint the interesting ones, sheared "
     "those in sheared slices with one warp at the end: the fast one (auto: "
     "sheared)"},

    {"kernel", 0, "tent|gauss|bspline|box", TOPIC_KERNEL, RENDER, read_choice,
     FIELD(kernel), 0, 0, "", "the reconstruction kernel (bspline)"},
    {"footprint", 0, "K", TOPIC_KERNEL, RENDER, read_integer, FIELD(footprint),
     2, 9, "", "its support in voxels, 2 to 9 (2 for tent and box, else 4)"},

    {"preset", 0, "NAME", TOPIC_LOOK, LOOKED, read_preset, FIELD(preset), 0, 0,
     "",
     "a transfer function by name (chosen from the histogram)"},
    {"colormap", 'c', "NAME", TOPIC_LOOK, LOOKED, read_colormap, FIELD(colormap),
     0, 0, "", "colours along the range (grey, or the preset's)"},
    {"opacity", 0, "V:O,V:O", TOPIC_LOOK, LOOKED, read_points, FIELD(opacities),
     0, 0, "", "opacities 0 to 1 at data values, linear between them"},
    {"gradient-opacity", 0, "G:O,G:O", TOPIC_LOOK, LOOKED, read_gradient_points,
     FIELD(gradient_opacities), 0, 0, "",
     "factors 0 to 1 of the opacity at gradient magnitudes, in data units per "
     "mm: 0:0,20:1 shows boundaries and lets what is even fade (none)"},
    {"window", 'w', "W", TOPIC_LOOK, LOOKED, read_real, FIELD(window), 1e-300,
     1e300, "", "width of the range of data values, with --level"},
    {"level", 0, "L", TOPIC_LOOK, LOOKED, read_real, FIELD(level), 0, 0, "",
     "middle of the range of data values, with --window"},
    {"range", 0, "LO,HI|pLO,pHI|full", TOPIC_LOOK, INPUT, read_range,
     FIELD(range), 0, 0, "",
     "data values, percentiles of the finite voxels, or all that the look "
     "spreads over (chosen from the histogram, or the preset's and file's "
     "own); convert: two values or full, spread over all of --as"},
    {"opacity-unit", 0, "voxel|mm", TOPIC_LOOK, RENDER, read_choice,
     FIELD(opacity_unit), 0, 0, "",
     "the length that an opacity is for: the smallest voxel spacing or a "
     "millimetre (voxel)"},
    {"shade", 0, "phong|none", TOPIC_LOOK, RENDER, read_choice, FIELD(shade), 0,
     0, "", "shading of the voxels (phong)"},
    {"light", 0, "AZ,EL", TOPIC_LOOK, RENDER, read_directions, FIELD(light), 0,
     0, "", "degrees of the light to the camera's right and up (0,0)"},
    {"ambient", 0, "A", TOPIC_LOOK, RENDER, read_real, FIELD(ambient), 0, 1, "",
     "share of ambient light (0.2)"},
    {"diffuse", 0, "D", TOPIC_LOOK, RENDER, read_real, FIELD(diffuse), 0, 1, "",
     "share of diffuse light (0.7)"},
    {"specular", 0, "S", TOPIC_LOOK, RENDER, read_real, FIELD(specular), 0, 1,
     "", "share of specular light (0.2)"},
    {"shininess", 0, "N", TOPIC_LOOK, RENDER, read_real, FIELD(shininess), 0,
     1000, "", "exponent of the specular light (20)"},
    {"tf", 0, "FILE", TOPIC_LOOK, LOOKED, read_text, FIELD(tf), 0, 0, "",
     "a transfer function from a file, in the place of a preset: ours (.json), "
     "3D Slicer's .vp or .xml, ParaView's or niivue's .json, Amrvis' .pal, "
     ".csv; FILE#NAME is one of several"},
    {"log", 0, NULL, TOPIC_LOOK, LOOKED, read_flag, FIELD(log), 0, 0, "",
     "spread values and join points by their logarithms; values of 0 and below "
     "are transparent"},

    {"quality", 0, "draft|normal|high", TOPIC_QUALITY, RENDER, read_choice,
     FIELD(quality), 0, 0, "", "of the sheared method: one intermediate pixel "
     "a voxel and the tent kernel, two and cubic ones, or that with "
     "interpolated slices between (normal)"},

    {"view", 0, "NAME", TOPIC_CAMERA, RENDER, read_view, FIELD(view), 0, 0, "",
     "the side the camera is on (anterior when the file has a medical "
     "orientation, else +z)"},
    {"azimuth", 0, "DEGREES", TOPIC_CAMERA, RENDER, read_real, FIELD(azimuth),
     0, 0, "", "then moves it to its right around the up axis (0)"},
    {"elevation", 0, "DEGREES", TOPIC_CAMERA, RENDER, read_real,
     FIELD(elevation), 0, 0, "", "then moves it up (0)"},
    {"roll", 0, "DEGREES", TOPIC_CAMERA, RENDER, read_real, FIELD(roll), 0, 0,
     "", "then turns it clockwise (0)"},
    {"zoom", 0, "Z", TOPIC_CAMERA, RENDER, read_real, FIELD(zoom), 1e-6, 1e6,
     "", "magnifies, 1e-6 to 1e6; at 1 the whole volume is in view (1)"},
    {"perspective", 0, "[FOV]", TOPIC_CAMERA, RENDER, read_fov, FIELD(fov),
     SNOW_FOV_LEAST, SNOW_FOV_MOST, "",
     "from an eye whose field of view is so many degrees over the shorter side, "
     "up to 120; 30 where no number follows (without it: a parallel "
     "projection)"},
    {"position", 0, "X,Y,Z", TOPIC_CAMERA, RENDER, read_place, FIELD(position),
     0, 0, "", "where the camera stands, in the world (mm), in place of --view; "
     "a parallel projection takes the direction alone (by --view)"},
    {"target", 0, "X,Y,Z", TOPIC_CAMERA, RENDER, read_place, FIELD(target), 0,
     0, "", "what it looks at and turns about, the middle of the picture (the "
     "middle of the volume)"},
    {"up", 0, "X,Y,Z", TOPIC_CAMERA, RENDER, read_place, FIELD(up), 0, 0, "",
     "the direction that is up in the picture (the view's; of a --position "
     "0,0,1, or 0,1,0 along z)"},

    {"no-labels", 0, NULL, TOPIC_LABELS, RENDER, read_flag, FIELD(no_labels), 0,
     0, "", "without the letters R L A P S I at the edges, which tell the sides "
     "of a patient (drawn where the file gives a medical orientation; never "
     "into files of floats)"},
    {"legend", 0, NULL, TOPIC_LABELS, RENDER, read_flag, FIELD(legend), 0, 0,
     "", "draw a colour bar with the values, and the opacity as a line, and in a "
     "parallel projection a scale bar (without)"},
    {"time-label", 0, NULL, TOPIC_LABELS, MOVIE, read_flag, FIELD(time_label),
     0, 0, "", "draw the number of the time step: that in the file's name, or "
     "in the file (without)"},

    {"dims", 0, "XxYxZ", TOPIC_DATA, INPUT | PHANTOM, read_dims, FIELD(dims), 0,
     0, "", "voxels of raw data or of a phantom, x fastest"},
    {"type", 0, "TYPE", TOPIC_DATA, INPUT, read_type, FIELD(type), 0, 0, "",
     "of raw data: int8 to int64, uint8 to uint64, float32, float64"},
    {"as", 0, "TYPE", TOPIC_DATA, CONVERT, read_type, FIELD(as), 0, 0, "",
     "type to convert to, by rounding; with --range spread over all of it (the "
     "input's, or the least one that holds the values)"},
    {"spacing", 0, "XxYxZ", TOPIC_DATA, INPUT, read_spacing, FIELD(spacing), 0,
     0, "", "voxel size; replaces the file's (raw data: 1x1x1)"},
    {"endian", 0, "little|big", TOPIC_DATA, INPUT, read_choice, FIELD(endian),
     0, 0, "", "byte order of raw data (little)"},
    {"offset", 0, "BYTES", TOPIC_DATA, INPUT, read_count, FIELD(offset), 0, 0,
     "", "bytes before the voxels of raw data (0)"},
    {"time", 0, "N", TOPIC_DATA, INPUT, read_integer, FIELD(time), 0, 9e15, "",
     "time step of a file with several, from 0 (0; movie: all of them)"},
    {"dataset", 0, "PATH", TOPIC_DATA, INPUT, read_text, FIELD(dataset), 0, 0,
     "", "array of a file with several: its path or name (the only or first)"},
    {"channel", 0, "N", TOPIC_DATA, INPUT, read_integer, FIELD(channel), 0,
     9e15, "", "of voxels with several values, from 0 (0)"},
    {"crop", 0, "X0:X1,Y0:Y1,Z0:Z1", TOPIC_DATA, INPUT, read_crop, FIELD(crop),
     0, 0, "", "a box of the volume, all that is read: first voxel and one past "
     "the last; one left out is the volume's end"},
    {"series", 0, "UID|N", TOPIC_DATA, INPUT, read_text, FIELD(series), 0, 0,
     "", "of DICOM images of several series, by UID or number as listed (the "
     "largest)"},
    {"mask", 0, "FILE", TOPIC_DATA, INPUT, read_text, FIELD(mask), 0, 0, "",
     "a volume on the same grid: where it is 0 or NaN, the input has no value, "
     "and so is neither seen nor counted (none)"},
    {"labels", 0, "LIST", TOPIC_DATA, INPUT, read_labels, FIELD(labels), 0, 0,
     "", "of the mask, the values that are inside: whole numbers and ranges "
     "such as 1,4-7 (all but 0)"},
    {"clip", 0, "A,B,C,D", TOPIC_DATA, INPUT, read_clip, FIELD(clip), 0, 0, "",
     "leave out the voxels beyond a plane of the world, where A x + B y + C z "
     "> D; up to six planes, one behind the other (none)"},

    {"threads", 'j', "N", TOPIC_RUN, RENDER, read_integer, FIELD(threads), 1,
     4096, "", "threads that render; the picture is the same for any number "
     "(all processors that the process may use)"},
    {"deterministic", 0, NULL, TOPIC_RUN, RENDER, read_flag,
     FIELD(deterministic), 0, 0, "",
     "the same bits on every machine, by the scalar kernels (the same for any "
     "number of threads always)"},
    {"isa", 0, "auto|scalar|avx2|avx512|neon", TOPIC_RUN, RENDER, read_choice,
     FIELD(isa), 0, 0, "", "instruction set of the kernels (auto: the best of "
     "this machine)"},
    {"progress", 0, "auto|always|never", TOPIC_RUN, RENDER, read_choice,
     FIELD(progress), 0, 0, "",
     "on stderr; a terminal shows the stage and its seconds, or a bar with frames "
     "a second and the time left; without one a line comes every 10 s (auto), "
     "and one for each stage too (always)"},
    {"stats", 0, "FILE", TOPIC_RUN, RENDER, read_text, FIELD(stats), 0, 0, "",
     "write figures of the run as JSON; - is standard output; a file that "
     "exists needs --overwrite"},
    {"verbose", 'v', NULL, TOPIC_RUN, EVERY, read_constant, FIELD(verbosity), 1,
     0, "", "tell seconds, of render also those of every stage and bytes"},
    {"quiet", 'q', NULL, TOPIC_RUN, EVERY, read_constant, FIELD(verbosity), -1,
     0, "", "tell nothing but errors"},
    {"memory", 0, "SIZE", TOPIC_RUN, RENDER, read_bytes, FIELD(memory), 0, 0,
     "", "the most that a process may take for voxels, encodings and pictures, "
     "such as 800M or 4G; a volume that needs more stays in its file, of which "
     "slabs are read at a time, and what does not fit even so ends with exit "
     "code 5 (what is free; -v tells the need)"},
    {"config", 0, "FILE", TOPIC_RUN, LOOKED, read_text, FIELD(config), 0, 0, "",
     "take options from a JSON object: long names for keys, and input; what "
     "stands on the command line counts more"},
    {"save-config", 0, "FILE", TOPIC_RUN, RENDER, read_text,
     FIELD(save_config), 0, 0, "", "write such an object, which gives the same "
     "picture again, and its --depth (figures of a run, as --stats, are none of "
     "it); - is standard output; a file that exists needs --overwrite"},

    {"frames", 0, "N", TOPIC_MORE, TURNTABLE, read_integer, FIELD(frames), 1,
     1000000, "", "pictures of one turn (120)"},
    {"fps", 0, "N", TOPIC_MORE, MOVIES, read_real, FIELD(fps), 0.01, 1000, "",
     "frames a second of a movie (25)"},
    {"resume", 0, NULL, TOPIC_MORE, MOVIES, read_flag, FIELD(resume), 0, 0, "",
     "go on where an earlier run was ended, with the frames that it left whole; "
     "the other options must be the same"},
    {"cut", 0, "auto|equal|counted|bricks", TOPIC_RANKS, RENDER, read_choice,
     FIELD(cut), 0, 0, "", "the parts of the volume: equal slabs as in the "
     "paper, slabs or bricks of equally many interesting voxels (auto: counted, "
     "and bricks where slabs would be thin)"},
    {"combine", 0, "auto|tree|swap|direct|radix", TOPIC_RANKS, RENDER,
     read_choice, FIELD(combine), 0, 0, "", "how the ranks' pictures become "
     "one: the paper's tree, binary swap, direct send or radix-k (auto: by "
     "ranks and size)"},
    {"radix", 0, "K", TOPIC_RANKS, RENDER, read_integer, FIELD(radix), 2, 64,
     "", "ranks that exchange at once, of --combine radix (chosen)"},
    {"timeout", 0, "SECONDS", TOPIC_RANKS, RENDER, read_real, FIELD(timeout), 0,
     1e9, "", "the longest that ranks wait for one that neither sends nor waits "
     "itself; then the job ends and names it; 0: for ever (300)"},

    {"json", 0, NULL, TOPIC_MORE, INFO | COMPARE | DOCTOR | TF, read_flag,
     FIELD(json), 0, 0, "", "write one JSON object"},
    {"patient", 0, NULL, TOPIC_MORE, INFO, read_flag, FIELD(patient), 0, 0, "",
     "tell the patient's name too, where the file has one"},
    {"seed", 0, "N", TOPIC_MORE, PHANTOM, read_count, FIELD(seed), 0, 0, "",
     "moves what is random in a phantom (0)"},
    {"tolerance", 0, "X", TOPIC_MORE, COMPARE, read_tolerance, FIELD(tolerance),
     0, 1, "", "the largest difference that counts as equal, 0 to 1, or as "
     "1/255 (0)"},
    {"help", 'h', "TOPIC", TOPIC_MORE, EVERY, read_flag, FIELD(help), 0, 0, "",
     "this help, or that of a topic or a verb"},
    {"version", 0, NULL, TOPIC_MORE, EVERY, read_flag, FIELD(version), 0, 0, "",
     "the version"},
    {.name = NULL},
};

/* A verb without a bit is not built; its last text is then the advice. */
const verb_row verb_table[] = {
    {"render", VERB_RENDER, 1, "INPUT -o OUT", "one picture; the default verb"},
    {"turntable", VERB_TURNTABLE, 1, "INPUT -o OUT [--frames N]",
     "a movie around the volume"},
    {"movie", VERB_MOVIE, -1, "INPUT...|run_%04d.nrrd -o OUT",
     "a movie over time steps"},
    {"info", VERB_INFO, 1, "INPUT [--json]",
     "geometry, type, range, histogram, sparse ratio"},
    {"phantom", VERB_PHANTOM, 1, "NAME -o OUT", "write a built-in test volume"},
    {"convert", VERB_CONVERT, 1, "IN -o OUT [--as TYPE] [--crop ...]",
     "a volume into another format"},
    {"compare", VERB_COMPARE, 2, "A B [--tolerance X]",
     "largest difference, PSNR and SSIM of two pictures"},
    {"bench", VERB_BENCH, -1, "table1|table2|table3|speed",
     "the paper's tables, measured; how fast pictures are made"},
    {"doctor", VERB_DOCTOR, 0, "[--json]", "what this build and machine can do"},
    {"help", VERB_HELP, -1, "[TOPIC|VERB]", "help on a topic or a verb"},
    {"tf", VERB_TF, -1, "list | show NAME|FILE [-o OUT.png] | convert IN -o OUT",
     "transfer functions: presets, colour maps, files of other programs"},
    {"serve", 0, 0, "", "render writes pictures"},
    {.name = NULL},
};

/* The words of `snowglass help TOPIC`. */
const topic_row topic_table[] = {
    {"output", "the picture file: size, background, bits", NULL},
    {"mode", "how samples make a pixel",
     NULL},
    {"sparse", "interesting voxels, encodings, methods", NULL},
    {"kernel", "the reconstruction kernel and its footprint", NULL},
    {"look", "transfer function, colours, shading", NULL},
    {"quality", "one word for speed or beauty",
     "one quality, set by --kernel and --footprint"},
    {"camera", "where the picture is taken from", NULL},
    {"labels", "letters and bars in the picture", NULL},
    {"data", "raw files, time steps", NULL},
    {"run", "threads, figures, talk", NULL},
    {"ranks", "many processors: parts of the volume, one picture", NULL},
    {"more", "options of single verbs", NULL},
    {NULL, NULL, NULL},
};
/* clang-format on */
