/* option_table.c - every option, verb and topic of the command line, as data.
 *
 * A row is one option: name, letter, argument, topic, verbs, reader, field,
 * range, help.  The order of the rows is the order of the help. */
#include "options/parse.h"

#include <stddef.h>

#define FIELD(name) offsetof(options, name)

/* Short names for sets of verbs, since the rows are dense. */
enum {
    TURNTABLE = VERB_TURNTABLE,
    MOVIE = VERB_MOVIE,
    MOVIES = VERB_TURNTABLE | VERB_MOVIE,
    WRITTEN = VERB_RENDER | MOVIES,
    SERVE = VERB_SERVE,
    EXPORT = VERB_EXPORT,
    RENDER = WRITTEN | SERVE | EXPORT, /* all verbs that render */
    INFO = VERB_INFO,
    PHANTOM = VERB_PHANTOM,
    COMPARE = VERB_COMPARE,
    DOCTOR = VERB_DOCTOR,
    CONVERT = VERB_CONVERT,
    TF = VERB_TF,
    SLICE = VERB_SLICE,
    FILED = WRITTEN | SLICE,  /* all verbs whose pictures are files */
    OVERLAID = FILED | SERVE, /* all verbs that draw overlays */
    MEASURED = WRITTEN | SLICE | SERVE | EXPORT,
    PICTURE = RENDER | SLICE,     /* all verbs that make pictures */
    LOOKED = PICTURE | VERB_INFO, /* all verbs that use a look */
    REPORT = VERB_REPORT,
    INPUT = LOOKED | CONVERT | REPORT, /* all verbs that read a volume */
    EVERY = INPUT | VERB_PHANTOM | VERB_COMPARE | VERB_DOCTOR | VERB_HELP | TF
};

/* clang-format off */
const option_row option_table[] = {
    {"output", 'o', "FILE", TOPIC_OUTPUT, FILED | PHANTOM | CONVERT | TF | REPORT,
     read_text,
     FIELD(output), 0, 0, "output file. Picture: .png, .jpg or .webp; .npy, .exr, .tif or .pfm for "
     "float pixels; - writes PNG to stdout. Movie: .mp4, .webm, .gif or .webp, or a "
     "pattern such as f_%04d.png for single frames; - with --as rgb24 writes raw "
     "frames. Volume: .nrrd, .nii, "
     ".nii.gz, .mha, .npy, .raw or .raw.gz. A picture without -o is NAME.png in "
     "the working folder, after the input, and replaces no file"},
    {"size", 's', "WxH|N", TOPIC_OUTPUT, FILED, read_size, FIELD(size), 0, 0, "picture size in pixels; N is NxN (default 512x512; of a slice its own, a "
     "pixel for each voxel or, where they are not square, for its shorter side); of slices in one "
     "picture that of the whole sheet"},
    {"background", 0, "COLOR|auto|none", TOPIC_OUTPUT, PICTURE, read_color,
     FIELD(background), 0, 0, "background colour of a PNG, WebP, JPEG or movie: a name, #rgb, #rrggbb, "
     "or r,g,b from 0 to 1; auto: #141414 in modes over and iso, black around "
     "slices, in the others the colour of the lowest value; or none, transparent, but black in JPEG and movies by ffmpeg "
     "(default auto)"},
    {"bits", 0, "8|16", TOPIC_OUTPUT, FILED, read_choice, FIELD(bits), 0, 0,
     "bits per channel of a PNG (default 8)"},
    {"overwrite", 'y', NULL, TOPIC_OUTPUT, FILED | PHANTOM | CONVERT | TF | EXPORT |
     REPORT,
     read_flag,
     FIELD(overwrite), 0, 0, "replace existing files of --output, --depth and --stats (default: "
     "refuse)"},
    {"show", 0, NULL, TOPIC_OUTPUT, VERB_RENDER | SLICE, read_flag, FIELD(show), 0, 0, "show the picture in the terminal, and write a file only if --output is "
     "given: by kitty's graphics protocol (kitty, Ghostty, WezTerm), elsewhere "
     "by half blocks in 24-bit colour"},
    {"depth", 0, "FILE", TOPIC_OUTPUT, WRITTEN, read_text, FIELD(depth), 0,
     0, "file for the depth of modes over and iso: .npy, .pfm, .exr or .tif. "
     "Depth is the distance in world units along the line of sight, from the "
     "target's plane to where opacity passes 1/2, or to the surface; NaN "
     "elsewhere. The same .exr as --output adds it as channel Z; frames of a "
     "movie need this"},

    {"mode", 'm', "over|mip|minip|mean|sum|iso", TOPIC_MODE, RENDER,
     read_choice, FIELD(mode), 0, 0, "how samples along a ray make a pixel: over composites them, mip and "
     "minip take the largest and smallest value, mean and sum average and add "
     "them, iso shows the surface of --iso. All modes but over use every "
     "voxel. In float files (.npy, .pfm, .exr, .tif) mean and sum keep data "
     "units (default over)"},
    {"iso", 0, "VALUE", TOPIC_MODE, RENDER, read_real, FIELD(iso), 0, 0, "data value of the surface in mode iso"},

    {"threshold", 0, "T", TOPIC_SPARSE, RENDER | INFO, read_real, FIELD(threshold), 0,
     255, "skip voxels with an opacity of T or less, from 0 to 255; the others are "
     "interesting (default 0; info lists 0, 10 and 30)"},
    {"encoding", 0, "auto|crs|bitmap|rle", TOPIC_SPARSE, RENDER, read_choice,
     FIELD(encoding), 0, 0, "how the positions of interesting voxels are stored (default auto)"},
    {"method", 0, "auto|original|footprint|shear-warp|raycast", TOPIC_SPARSE, RENDER,
     read_choice, FIELD(method), 0, 0, "rendering method. shear-warp: interpolates values slice by slice, then "
     "colours them; the fastest; raycast: the same "
     "along each ray; slow, the reference for the others; footprint: splats "
     "interesting voxels straight onto the picture, as the paper does; "
     "original: the same with every voxel (default auto: shear-warp)"},

    {"kernel", 0, "auto|tent|gauss|bspline|box|NAME:N", TOPIC_KERNEL, PICTURE, read_kernel,
     FIELD(kernel), 2, 9, "reconstruction kernel; N is its support in voxels, 2 to 9, "
     "such as gauss:5 or auto:3 (default 2 for tent and box, otherwise 4). shear-warp "
     "and raycast support tent and bspline; with gauss and box, and another N, "
     "footprint makes the picture (default auto: tent; bspline with footprint and "
     "original). Slices are linear between their voxels (tent), or show the nearest "
     "one (box)"},

    {"preset", 0, "NAME", TOPIC_LOOK, LOOKED, read_preset, FIELD(preset), 0, 0,
     "a built-in transfer function (default: made from the histogram)"},
    {"colormap", 'c', "NAME|LIST", TOPIC_LOOK, LOOKED, read_colormap,
     FIELD(colormap), 0, 0, "colours along the range, or at data values, such as 60:#000000,255:#ff8800; "
     "NAME_r is a map reversed, and reversed the colours of the look; "
     "with --preset labels those of single labels (default grey, or the "
     "preset's)"},
    {"opacity", 0, "V:O,V:O", TOPIC_LOOK, LOOKED & ~SLICE, read_points,
     FIELD(opacities), 0, 0, "opacity from 0 to 1 at data values, linear in between"},
    {"gradient-opacity", 0, "G:O,G:O", TOPIC_LOOK, LOOKED & ~SLICE, read_gradient_points,
     FIELD(gradient_opacities), 0, 0, "scale the opacity by gradient magnitude (data units per mm): factors "
     "from 0 to 1, linear in between; 0:0,20:1 shows boundaries and hides "
     "uniform regions (default: none)"},
    {"window", 'w', "W,L", TOPIC_LOOK, LOOKED, read_window, FIELD(window), 1e-300,
     1e300, "width of the range of data values, and its centre"},
    {"range", 0, "LO,HI|pLO,pHI|full", TOPIC_LOOK, INPUT, read_range,
     FIELD(range), 0, 0, "range that the look is spread over: data values, percentiles of the "
     "finite voxels, or all values (default: from the histogram, or the "
     "preset's or file's own). With convert: two values or full, spread over "
     "the type of --as"},
    {"shade", 0, "phong|none", TOPIC_LOOK, RENDER, read_choice, FIELD(shade), 0,
     0, "shading of the voxels (default phong)"},
    {"light", 0, "key|head|AZ,EL", TOPIC_LOOK, RENDER, read_light, FIELD(light),
     0, 0, "where the light comes from. key: most of it from the upper left of the "
     "camera, the rest from the camera; head: all from the camera; or a "
     "direction: degrees to the right of the camera and up (default key)"},
    {"material", 0, "A,D,S,N", TOPIC_LOOK, RENDER, read_material, FIELD(material), 0, 1, "strength of the ambient, diffuse and specular light, each from 0 to 1, and "
     "the exponent of the latter, 0 to 1000 (default 0.2,0.7,0.2,20)"},
    {"depth-darkening", 0, "[S]", TOPIC_LOOK, RENDER, read_strength,
     FIELD(depth_darkening), 0, 1, "darken what lies deeper than its surroundings, in modes over and iso, "
     "with strength S, 0 to 1 (default 0; 1 without S)"},
    {"occlusion", 0, "[S]", TOPIC_LOOK, RENDER, read_strength, FIELD(occlusion),
     0, 1, "darken surfaces that have much around them, as in holes and folds, in "
     "modes over and iso, with strength S, 0 to 1 (default 0; 1 without S)"},
    {"tf", 0, "FILE", TOPIC_LOOK, LOOKED, read_text, FIELD(tf), 0, 0, "transfer function from a file, in place of a preset: Snowglass .json or "
     ".csv, 3D Slicer .vp or .xml, ParaView or niivue .json, Amrvis .pal; "
     "FILE#NAME selects one of several"},
    {"scale", 0, "linear|log|symlog|symlog:X", TOPIC_LOOK, LOOKED, read_scale, FIELD(scale),
     1e-300, 1e300, "scale of the values. log: logarithmic; values of 0 and below are "
     "transparent, and a note says how many these are; symlog: for both signs, "
     "linear from -X to X and logarithmic beyond; without X from about a "
     "thousandth of the largest magnitude, which is printed (default linear)"},

    {"quality", 0, "draft|normal|high", TOPIC_QUALITY, WRITTEN, read_choice,
     FIELD(quality), 0, 0, "speed or quality. draft: one intermediate pixel per voxel and linear "
     "filters; normal: two pixels and cubic filters; high: also interpolates "
     "between slices. With method raycast: steps of 1/2, 1/4 or 1/16 voxel. The "
     "other methods have one quality (default normal)"},

    {"view", 0, "NAME", TOPIC_CAMERA, RENDER, read_view, FIELD(view), 0, 0, "side that the camera is on (default anterior for a file with a medical "
     "orientation, oblique for floats without, otherwise +z; a volume thinner than a "
     "quarter of its shorter side is shown from its face)"},
    {"azimuth", 0, "DEGREES", TOPIC_CAMERA, RENDER, read_real, FIELD(azimuth),
     0, 0, "move the camera to its right around the up axis (default 0)"},
    {"elevation", 0, "DEGREES", TOPIC_CAMERA, RENDER, read_real,
     FIELD(elevation), 0, 0, "then move the camera up (default 0)"},
    {"roll", 0, "DEGREES", TOPIC_CAMERA, RENDER, read_real, FIELD(roll), 0, 0,
     "then turn the camera clockwise (default 0)"},
    {"zoom", 0, "Z", TOPIC_CAMERA, RENDER, read_real, FIELD(zoom), 1e-6, 1e6,
     "magnification of what --fit frames, 1e-6 to 1e6 (default 1)"},
    {"fit", 0, "visible|volume", TOPIC_CAMERA, RENDER, read_choice, FIELD(fit),
     0, 0, "what the picture frames. visible: what the look shows, once for all "
     "frames of a turntable; projections and movies of time steps show the whole "
     "box; volume: the sphere around the box, at one scale from every side. With "
     "--position or --target as volume (default visible)"},
    {"perspective", 0, "[FOV]", TOPIC_CAMERA, RENDER, read_fov, FIELD(fov),
     SNOW_FOV_MIN, SNOW_FOV_MAX, "perspective projection with a field of view over the shorter side, in "
     "degrees up to 120; 30 if FOV is left out (default: parallel projection)"},
    {"position", 0, "X,Y,Z", TOPIC_CAMERA, RENDER, read_place, FIELD(position),
     0, 0, "camera position in world coordinates, in place of --view; a "
     "parallel projection uses only the direction (default: from --view)"},
    {"target", 0, "X,Y,Z", TOPIC_CAMERA, RENDER, read_place, FIELD(target), 0,
     0, "point that the camera looks at and turns around (default: the centre of "
     "the volume)"},
    {"up", 0, "X,Y,Z", TOPIC_CAMERA, RENDER, read_place, FIELD(up), 0, 0, "direction that is up in the picture (default: the view's; for a "
     "--position 0,0,1, or 0,1,0 when looking along z)"},

    {"no-labels", 0, NULL, TOPIC_LABELS, PICTURE, read_flag, FIELD(no_labels), 0,
     0, "omit the orientation letters R L A P S I at the edges (default: drawn if "
     "the file has a medical orientation, but never into float files)"},
    {"legend", 0, "[TITLE|scale]", TOPIC_LABELS, PICTURE, read_legend, FIELD(legend), 0, 0,
     "draw a colour bar with values and the opacity curve, and in a parallel "
     "projection a scale bar; over the bar stands TITLE, such as --legend=\"T (K)\", "
     "whose unit may be left out or stand alone (default: the file's quantity and "
     "unit, or HU). --legend scale draws the scale bar alone"},
    {"title", 0, "TEXT", TOPIC_LABELS, PICTURE, read_text, FIELD(title), 0, 0, "draw a line of text in the upper left"},
    {"annotate", 0, "step|time|time=FORMAT", TOPIC_LABELS, PICTURE, read_annotate,
     FIELD(annotate), 0, 0, "draw which step it is. step: its number, from the file's name or in the file; "
     "time: its physical time, or its number where the file has no time; FORMAT is "
     "one number as in printf (\"time=t = %.2f s\"), or a date (%Y-%m-%d %H:%M:%S) "
     "where the unit counts from one"},
    {"box", 0, "outline|axes", TOPIC_LABELS, RENDER, read_choice, FIELD(box), 0, 0, "draw the volume's box, which is framed then. outline: its edges; axes: with "
     "ticks: coordinates in the unit of the file"},
    {"measure", 0, "LIST", TOPIC_LABELS, MEASURED, read_measure, FIELD(measure), 0, 0,
     "draw and print measures, between semicolons, in units of the world: line P P, its "
     "length; angle P P P, at the second point; ellipse AXIS POS C A B, the values of its "
     "voxels: on the slice at POS along AXIS, as of --axis, around C, with half-axes of "
     "lengths A across the slice's picture and B up, or to points A and B. A point is X,Y,Z; C "
     "may lack its coordinate along AXIS, such as \"line 0,0,0 10,0,0; ellipse axial 12.5 0,20 15 10\""},

    {"dims", 0, "XxYxZ", TOPIC_DATA, INPUT | PHANTOM, read_dims, FIELD(dims), 0,
     0, "voxels of raw data or of a phantom, x fastest"},
    {"type", 0, "TYPE", TOPIC_DATA, INPUT, read_type, FIELD(type), 0, 0, "voxel type of raw data: int8 to int64, uint8 to uint64, float32 or "
     "float64"},
    {"as", 0, "TYPE", TOPIC_DATA, CONVERT | MOVIES, read_type, FIELD(as), 0, 0, "voxel type to convert to, by rounding; with --range, that range is "
     "spread over the whole type (default: the input's, or the smallest that "
     "holds the values). Of frames on standard output (-o -): rgb24, raw bytes"},
    {"spacing", 0, "XxYxZ", TOPIC_DATA, INPUT, read_spacing, FIELD(spacing), 0,
     0, "voxel size, in place of the file's (default for raw data 1x1x1)"},
    {"endian", 0, "little|big", TOPIC_DATA, INPUT, read_choice, FIELD(endian),
     0, 0, "byte order of raw data (default little)"},
    {"offset", 0, "BYTES", TOPIC_DATA, INPUT, read_count, FIELD(offset), 0, 0,
     "bytes to skip before the voxels of raw data (default 0)"},
    {"time", 0, "N|last|A:B|TIME", TOPIC_DATA, INPUT, read_time, FIELD(time), 0,
     0, "time step of a file or series with several: from 0, or from -1, which is "
     "last, at the end; a movie takes A up to, not including, B; a number with "
     "a point or a unit, such as 0.3s, or a date, such as 2005-08-28, takes the "
     "step nearest to that time (default 0; movie: all)"},
    {"dataset", 0, "PATH", TOPIC_DATA, INPUT, read_text, FIELD(dataset), 0, 0,
     "array to read from a file with several: path or name, the level of an "
     "OME-Zarr image, or an image of an OME-TIFF by name or number (default: the "
     "only one; of VTK, XDMF and AMReX the file's scalars, else the first)"},
    {"channel", 0, "N|NAME|LIST", TOPIC_DATA,
     INPUT, read_channels, FIELD(channels), 0, 0, "channel of voxels with several values, by number from 0 or by name; or "
     "those that a picture mixes, each with colour, range and opacity, such as "
     "0:magenta,GFP:#00ff00:100..2000:0.5 (default: what the file shows, else "
     "0)"},
    {"component", 0, "x|N|NAME|U,V,W|magnitude", TOPIC_DATA, INPUT, read_component,
     FIELD(component), 0, 0, "component of voxels that are vectors: x, y, z, w, a number from 0, or "
     "magnitude (default: magnitude of 2 or 3 floats, else the first); of "
     "AMReX a number or a name; U,V,W: the magnitude of several, which may be data "
     "sets of one size"},
    {"crop", 0, "X0:X1,Y0:Y1,Z0:Z1", TOPIC_DATA, INPUT, read_crop, FIELD(crop),
     0, 0, "read only this box of the volume: first voxel and one past the last; an "
     "omitted number means the end of the volume"},
    {"series", 0, "UID|N", TOPIC_DATA, INPUT, read_text, FIELD(series), 0, 0,
     "DICOM series to read, by UID or by its number in the list (default: the "
     "largest)"},
    {"allow-gaps", 0, NULL, TOPIC_DATA, INPUT, read_flag, FIELD(allow_gaps), 0,
     0, "open a DICOM folder, an OME-TIFF or a stack of ImageJ in which slices are "
     "missing or cut: a note names each, and its place stays transparent (default: "
     "refuse, except for info)"},
    {"suv", 0, "bw|lbm|bsa|none", TOPIC_DATA, INPUT, read_choice, FIELD(suv), 0,
     0, "unit of PET in DICOM: standardized uptake by body weight, lean mass or "
     "surface, or as stored (default: bw in pictures; none for data values: info, "
     "convert, and float files of slices, mean and sum)"},
    {"levels", 0, "N", TOPIC_DATA, INPUT, read_integer, FIELD(levels), 1, 24,
     "levels of refinement to read, the coarsest first, as if the file had no "
     "finer ones: of AMReX and .vth (default: all)"},
    {"vertical", 0, "levels|height", TOPIC_DATA, INPUT, read_choice,
     FIELD(vertical), 0, 0,
     "how levels of WRF that follow the ground are shown: flat, at their mean "
     "heights, or each column at its own (default: levels)"},
    {"z-scale", 0, "F|auto", TOPIC_DATA, INPUT, read_z_scale, FIELD(z_scale),
     1e-9, 1e9, "factor on the height of the world; auto, the default, makes that of "
     "a grid of the earth, whose x and y are degrees and whose z is not, a third "
     "of its shorter side"},
    {"mask", 0, "FILE", TOPIC_DATA, INPUT, read_text, FIELD(mask), 0, 0, "volume in the same place; where it is 0 or NaN, voxels of the input are "
     "removed: neither shown nor counted (default: none)"},
    {"labels", 0, "LIST", TOPIC_DATA, INPUT, read_labels, FIELD(labels), 0, 0,
     "labels that are kept, of the overlay, else of the mask, else of the input: "
     "numbers and ranges such as 1,4:7 (default: all but 0)"},
    {"label-table", 0, "FILE", TOPIC_DATA, INPUT, read_text, FIELD(label_table),
     0, 0, "names and colours of labels: a table of ITK-SNAP, FreeSurfer or 3D Slicer "
     "(default: the file's own, or chosen by number)"},
    {"overlay", 0, "FILE", TOPIC_DATA, OVERLAID, read_text, FIELD(overlay), 0, 0,
     "draw a second volume in the first, at its place in the world: a "
     "segmentation, in colours by label, or values, as of a PET over a CT; in "
     "mode over (default: none)"},
    {"overlay-look", 0, "COLOURS[,RANGE[,OPACITY]]", TOPIC_DATA, OVERLAID, read_overlay_look,
     FIELD(overlay_look), 0, 0, "look of the overlay, of which any part may be left out: a preset, a colour map or "
     "list as of --colormap, or both; a range as of --range; opacities as of --opacity, "
     "or one factor from 0 to 1 for all, in a slice the most that it covers, such as "
     "hot,2,12,0.6 or labels,3:#ff8800; or outline among them, for lines around what a "
     "slice shows of it (default: labels, or hot by its histogram)"},
    {"clip", 0, "A,B,C,D", TOPIC_DATA, INPUT, read_clip, FIELD(clip), 0, 0, "remove the voxels beyond a plane in world coordinates, where A x + B y + "
     "C z > D; up to six planes, in one list (default: none)"},

    {"threads", 'j', "N", TOPIC_RUN, PICTURE, read_integer, FIELD(threads), 1,
     4096, "number of threads; the picture does not depend on it (default: all "
     "processors available to the process)"},
    {"deterministic", 0, NULL, TOPIC_RUN, RENDER, read_flag,
     FIELD(deterministic), 0, 0, "compute as scalar code does, which gives the same bits on every machine "
     "(the number of threads never changes the bits)"},
    {"isa", 0, "auto|scalar|avx2|avx512|sse4|neon|wasm", TOPIC_RUN, RENDER, read_choice,
     FIELD(isa), 0, 0, "instruction set to use (default auto: the best of this machine)"},
    {"progress", 0, "auto|always|never", TOPIC_RUN, FILED, read_choice,
     FIELD(progress), 0, 0, "progress on stderr. auto: a status line or bar on a terminal, otherwise "
     "a line every 10 s; always: without a terminal also a line for each "
     "stage, and each second of a movie; never: none (default auto)"},
    {"stats", 0, "FILE", TOPIC_RUN, FILED, read_text, FIELD(stats), 0, 0, "write timings and other figures as JSON; - is stdout; replacing a file "
     "needs --overwrite"},
    {"verbose", 'v', NULL, TOPIC_RUN, EVERY, read_constant, FIELD(verbosity), 1,
     0, "print timings; render also prints bytes and the time of each stage"},
    {"quiet", 'q', NULL, TOPIC_RUN, EVERY, read_constant, FIELD(verbosity), -1,
     0, "print errors only"},
    {"memory", 0, "SIZE", TOPIC_RUN, PICTURE, read_bytes, FIELD(memory), 0, 0,
     "memory limit of a process for voxels, encodings and pictures, such as "
     "800M or 4G. A larger volume stays in its file and is read in slabs; if "
     "that does not fit either, the exit code is 5 (default: the free memory; "
     "-v prints the need)"},
    {"config", 0, "FILE", TOPIC_RUN, LOOKED, read_text, FIELD(config), 0, 0, "read options from a JSON file, or a text in {}, whose keys are long option "
     "names, and input; options on the command line have priority"},
    {"save-config", 0, "FILE", TOPIC_RUN, FILED, read_text,
     FIELD(save_config), 0, 0, "write the options to a JSON file that gives the same picture with "
     "--config; --depth is included, --stats and other reports are not; - is "
     "stdout; replacing a file needs --overwrite"},

    {"axis", 0, "x|y|z|axial|coronal|sagittal", TOPIC_MORE, SLICE, read_choice,
     FIELD(axis), 0, 0, "axis that the slice lies across: x, y or z of the grid; or axial, coronal "
     "or sagittal, the axis of the grid that is nearest to that of the patient "
     "(default axial; of a single slice, its face)"},
    {"at", 0, "INDEX|POSITION|A:B:STEP|X,Y,Z", TOPIC_MORE, SLICE, read_text, FIELD(at), 0, 0,
     "slice: its number from 0, or a position in the world with its unit, such "
     "as 12.5mm, for the slice nearest to it; of a series, a movie or a grid those from "
     "A up to, not including, B; the point of --ortho in the world (default: "
     "the middle; of several all)"},
    {"slab", 0, "THICKNESS[:max|mean|min]", TOPIC_MORE, SLICE, read_text, FIELD(thickness), 0, 0,
     "show the maximum (default), mean or minimum of the slices within half a "
     "thickness: 10mm:mean, or a number of slices"},
    {"grid", 0, "CxR", TOPIC_MORE, SLICE, read_text, FIELD(grid), 0, 0,
     "draw CxR numbered slices in one picture, spread evenly over what there is to see, or over "
     "--at A:B"},
    {"ortho", 0, NULL, TOPIC_MORE, SLICE, read_flag, FIELD(ortho), 0, 0, "draw the axial, coronal and sagittal slice through the point of --at "
     "beside one another, at one scale, with lines through it"},
    {"frames", 0, "N", TOPIC_MORE, TURNTABLE | SLICE, read_integer, FIELD(frames), 1,
     1000000, "number of frames in one turn (default 120); of slices, so many of them, "
     "spread evenly"},
    {"fps", 0, "N", TOPIC_MORE, MOVIES | SLICE, read_real, FIELD(fps), 0.01, 1000, "frames per second of the movie (default 25; fewer, at least 2, for a "
     "movie of less than 100 time steps or slices)"},
    {"resume", 0, NULL, TOPIC_MORE, MOVIES | SLICE, read_flag, FIELD(resume), 0, 0, "continue an interrupted run and keep its finished frames; all other "
     "options must be the same"},
    {"cut", 0, "auto|equal|counted|bricks", TOPIC_RANKS, WRITTEN | SERVE,
     read_choice, FIELD(cut), 0, 0, "how the volume is partitioned: equal slabs as in the paper; counted or "
     "bricks: slabs or bricks with equal numbers of interesting voxels "
     "(default auto: counted, or bricks where slabs would be thin)"},
    {"combine", 0, "auto|tree|swap|direct|radix|radix:K", TOPIC_RANKS, WRITTEN | SERVE,
     read_combine, FIELD(combine), 2, 64, "how the pictures of the ranks are combined: binary tree as in the paper, "
     "binary swap, direct send, or radix-k in groups of K ranks, 2 to 64, chosen "
     "without K (default auto: by ranks and size)"},
    {"timeout", 0, "SECONDS", TOPIC_RANKS, WRITTEN | SERVE, read_real, FIELD(timeout), 0,
     1e9, "end the job if a rank neither sends nor waits for this long, and name "
     "the rank; 0 waits forever (default 300)"},

    {"listen", 0, ":PORT|ADDRESS:PORT|unix:PATH", TOPIC_MORE, SERVE, read_listen,
     FIELD(listen), 0, 65535, "where the viewer listens: on a TCP port of this machine alone (:8000); on one of "
     "its addresses, without encryption (10.0.0.17:8000, or 10.0.0.17 for a free port); "
     "or on a Unix socket that only its owner can open, for ssh -L 8000:PATH (default "
     ":0, a free port of 127.0.0.1 and ::1, which is printed)"},
    {"allow-host", 0, "NAME,...", TOPIC_MORE, SERVE, read_text,
     FIELD(allow_host), 0, 0, "names, with their ports, under which a proxy or a tunnel shows the "
     "viewer; pages under other names are refused"},
    {"embed", 0, "ORIGIN,...", TOPIC_MORE, SERVE, read_text, FIELD(embed), 0, 0,
     "origins, such as https://hub.example.org, whose pages may show the viewer "
     "in a frame; of frames in frames, those of all that are around it "
     "(default: none)"},
    {"token-file", 0, "FILE", TOPIC_MORE, SERVE, read_text, FIELD(token_file),
     0, 0, "take the secret of the URL from a file that only its owner can read; "
     "without such a file, write one (default: a new secret)"},
    {"live", 0, "RECIPE", TOPIC_MORE, SERVE, read_text, FIELD(live), 0, 0, "in place of a volume show the newest picture of the running simulation "
     "that draws by this recipe, and change the recipe"},

    {"json", 0, NULL, TOPIC_MORE, INFO | COMPARE | DOCTOR | TF, read_flag,
     FIELD(json), 0, 0, "print one JSON object; of several inputs of info a list of them"},
    {"patient", 0, NULL, TOPIC_MORE, INFO, read_flag, FIELD(patient), 0, 0, "also print the patient's name, if the file has one"},
    {"tolerance", 0, "X", TOPIC_MORE, COMPARE, read_tolerance, FIELD(tolerance),
     0, 1, "largest difference that counts as equal, from 0 to 1; quotients such as "
     "1/255 are allowed (default 0)"},
    {"help", 'h', "NAME", TOPIC_MORE, EVERY, read_flag, FIELD(help), 0, 0, "print this help, or that of a verb, topic, option or preset"},
    {"version", 0, NULL, TOPIC_MORE, EVERY, read_flag, FIELD(version), 0, 0, "print the version"},
    {.name = NULL},
};

const verb_row verb_table[] = {
    {"render", VERB_RENDER, 1, "INPUT [-o OUT]",
     "make one picture; the default verb"},
    {"turntable", VERB_TURNTABLE, 1, "INPUT -o OUT [--frames N]",
     "make a movie around the volume"},
    {"movie", VERB_MOVIE, -1, "INPUT...|run_%04d.nrrd -o OUT",
     "make a movie over time steps"},
    {"slice", VERB_SLICE, 1, "INPUT [--axis A] [--at N] [-o OUT]",
     "make a picture of one slice or several, or a movie"},
    {"info", VERB_INFO, -1, "INPUT... [--json]",
     "print geometry, type, range, histogram and sparse ratio"},
    {"phantom", VERB_PHANTOM, 1, "NAME -o OUT", "write a built-in test volume"},
    {"convert", VERB_CONVERT, 1, "IN -o OUT [--as TYPE] [--crop ...]",
     "convert a volume to another format"},
    {"compare", VERB_COMPARE, 2, "A B [--tolerance X]",
     "print largest difference, PSNR and SSIM of two pictures"},
    {"bench", VERB_BENCH, -1, "table1|table2|table3|speed",
     "run the benchmarks of the paper and of speed"},
    {"doctor", VERB_DOCTOR, 0, "[--json]",
     "print what this build and this machine can do"},
    {"report", VERB_REPORT, 1, "INPUT [-o FILE]",
     "print what a report of a fault needs, without names"},
    {"help", VERB_HELP, -1, "[NAME]",
     "print help on a verb, topic, option or preset"},
    {"tf", VERB_TF, -1,
     "list | show NAME|FILE [-o OUT.png] | convert IN -o OUT",
     "list, show and convert transfer functions"},
    {"serve", VERB_SERVE, -1, "[INPUT|FOLDER] [--listen :PORT]",
     "show a volume, or those of a folder, in a browser"},
    {"export", VERB_EXPORT, 2, "OUT.html INPUT",
     "make a page that shows a volume without a server"},
    {.name = NULL},
};

/* The topics of `snowglass help TOPIC`. */
const topic_row topic_table[] = {
    {"output", "picture file: size, background, depth"},
    {"mode", "how the samples along a ray make a pixel"},
    {"sparse", "interesting voxels, encodings, methods"},
    {"kernel", "reconstruction kernel and its support"},
    {"look", "transfer function, colours, shading"},
    {"quality", "draft, normal or high: speed or quality"},
    {"camera", "view, angles, zoom, perspective"},
    {"labels", "orientation letters, colour bar, time step"},
    {"data", "which data to read: raw files, masks, crops"},
    {"run", "threads, memory, progress, verbosity"},
    {"ranks", "rendering on several machines with MPI"},
    {"more", "options of single verbs"},
    {NULL, NULL},
};
/* clang-format on */
