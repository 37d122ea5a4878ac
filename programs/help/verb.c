/* verb.c - the page of a verb, at most 60 lines: its own options first,
 * then those that are used most, examples, and the topics of all the others. */
#include "help/help.h"
#include "run/log.h"
#include "run/sibling.h"

#include <stdio.h>

enum {
    RENDER = VERB_RENDER,
    STILL = VERB_RENDER | VERB_SLICE,
    MOVIES = VERB_TURNTABLE | VERB_MOVIE,
    TURNED = RENDER | MOVIES,
    SEEN = TURNED | VERB_SERVE | VERB_EXPORT,
    WRITTEN = STILL | MOVIES,
    ANY = WRITTEN | VERB_SERVE | VERB_EXPORT,
    FILED = VERB_INFO | VERB_CONVERT,
    PHANTOM = VERB_PHANTOM
};

/* The common options, with shorter texts than in the table. */
static const struct {
    unsigned verbs;
    const char *name, *text;
} common[] = {
    {STILL, "output", "file of the picture; its ending is the format"},
    {MOVIES, "output",
     "the movie, such as turn.mp4, or single frames: f_%04d.png"},
    {VERB_CONVERT | PHANTOM | VERB_TF, "output",
     "file to write; its ending is the format"},
    {WRITTEN | VERB_EXPORT | VERB_CONVERT | PHANTOM | VERB_TF, "overwrite",
     "replace the file if it exists"},
    {TURNED, "size", "size in pixels (default 512x512)"},
    {VERB_SLICE, "size", "size in pixels, with --grid of the whole sheet (default: a pixel for "
     "each voxel)"},
    {ANY, "preset", "look for a kind of data: ct-bone; help preset lists all"},
    {ANY, "colormap", "colours: viridis; help colormap lists all"},
    {ANY, "window", "show W data values around L: -w 400,40"},
    {SEEN, "mode",
     "over: matter with its opacity; mip: the largest value of each ray; help "
     "mode lists all"},
    {SEEN, "view", "side or plane: left, axial, +z; help view lists all"},
    {SEEN, "azimuth", "move the camera to its right around the volume"},
    {SEEN, "elevation", "then move it up"},
    {SEEN, "zoom", "magnify"},
    {ANY, "legend", "draw a colour bar and a scale bar"},
    {FILED | PHANTOM, "dims",
     "voxels along x, y and z: of raw data, or wanted"},
    {FILED, "type", "voxel type of raw data: uint8, int16, float32, ..."},
    {FILED, "spacing", "voxel size, in place of the file's"},
    {FILED, "time", "time step of a file with several"},
    {FILED, "dataset", "array of a file with several"},
    {FILED, "channel", "channel of voxels with several values"},
    {FILED, "crop", "read only this box: 0:64,16:48,5:6"},
    {VERB_CONVERT, "range", "values that are spread over the type of --as"},
    {VERB_INFO, "threshold", "share of voxels with a larger opacity"},
};

static const struct {
    unsigned verb;
    const char *lines[3];
} examples[] = {
    {VERB_RENDER,
     {"snowglass head.nii.gz -o head.png",
      "snowglass render ct.nrrd -o bone.png --preset ct-bone --view left -s "
      "1024",
      "snowglass render mra.nii.gz -o mip.png --mode mip --legend"}},
    {VERB_SLICE,
     {"snowglass slice head.nii.gz -o middle.png",
      "snowglass slice ct.nrrd --axis coronal --at -12.5mm -w 400,40 -o c.png",
      "snowglass slice head.nii.gz --grid 5x4 -o grid.png"}},
    {VERB_TURNTABLE,
     {"snowglass turntable head.nii.gz -o head.mp4",
      "snowglass turntable ct.nrrd -o bone.gif --preset ct-bone --frames 60",
      "snowglass turntable cells.tif -o - --as rgb24 |\n"
      "    ffmpeg -f rawvideo -pix_fmt rgb24 -s 512x512 -r 25 -i - cells.mkv"}},
    {VERB_MOVIE,
     {"snowglass movie run_%04d.nrrd -o run.mp4",
      "snowglass movie run_%04d.nrrd -o - --as rgb24 |\n"
      "    ffmpeg -f rawvideo -pix_fmt rgb24 -s 512x512 -r 25 -i - run.mkv",
      "snowglass movie heart.nii.gz -o heart.gif --fps 10 --annotate step"}},
    {VERB_SERVE,
     {"snowglass serve study/",
      "snowglass serve ct.nrrd --preset ct-bone --listen :8000",
      "snowglass serve run.nrrd --listen "
      "unix:$XDG_RUNTIME_DIR/snowglass.sock"}},
    {VERB_INFO,
     {"snowglass info head.nii.gz",
      "snowglass info v.raw --dims 256x256x110 "
      "--type uint8",
      "snowglass info dicom/ --json"}},
    {VERB_CONVERT,
     {"snowglass convert dicom/ -o head.nii.gz",
      "snowglass convert ct.nrrd -o bone.nrrd --as uint8 --range 200,1500",
      "snowglass convert run.h5 -o part.npy --crop 0:64,0:64,0:64"}},
    {VERB_EXPORT,
     {"snowglass export head.html head.nii.gz",
      "snowglass export knee.html dicom/ --preset ct-bone",
      "snowglass export part.html run.h5 --crop 0:256,0:256,0:256"}},
};

/* The options that `render` does not have. */
static void print_own(const verb_row *verb) {
    bool any = false;
    for (const option_row *row = option_table; row->name; row++)
        if ((row->verbs & verb->bit) && !(row->verbs & VERB_RENDER)) {
            if (!any)
                printf("\noptions of %s:\n", verb->name);
            any = true;
            help_option(row, row->text);
        }
}

static void print_common(const verb_row *verb) {
    bool any = false;
    for (size_t i = 0; i < sizeof common / sizeof *common; i++)
        if (common[i].verbs & verb->bit) {
            if (!any)
                printf("\ncommon options:\n");
            any = true;
            help_option(help_option_named(common[i].name), common[i].text);
        }
}

int help_verb_page(const verb_row *verb) {
    if (verb->bit == VERB_BENCH) { /* it reads and describes its own options */
        char *words[] = {NULL, "--help", NULL};
        return sibling_run("snowglass-bench", words);
    }
    printf("snowglass %s %s\n%s\n", verb->name, verb->usage, verb->text);
    print_own(verb);
    print_common(verb);
    if (verb->bit == VERB_PHANTOM)
        help_names("phantoms", snow_phantom_name, snow_phantom_description);
    for (size_t i = 0; i < sizeof examples / sizeof *examples; i++)
        for (int n = 0; n < 3 && examples[i].verb == verb->bit; n++)
            printf("%s  %s\n", n ? "" : "\nexamples:\n", examples[i].lines[n]);
    printf("\nall options, by topic (snowglass help TOPIC):\n");
    help_topics(verb->bit);
    printf("\nsnowglass help NAME explains an option (help window) or a preset "
           "(help ct-bone).\n");
    return finish_stdout();
}
