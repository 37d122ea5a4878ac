/* help_brief.c - the short page of a verb that makes pictures: its own options
 * first, then those that are used most, examples, and the topics of all the
 * others. */
#include "options/help.h"

#include <stdio.h>
#include <string.h>

enum {
    RENDER = VERB_RENDER,
    STILL = VERB_RENDER | VERB_SLICE,
    MOVIES = VERB_TURNTABLE | VERB_MOVIE,
    TURNED = RENDER | MOVIES,
    SEEN = TURNED | VERB_SERVE | VERB_EXPORT,
    WRITTEN = STILL | MOVIES,
    ANY = WRITTEN | VERB_SERVE | VERB_EXPORT
};

/* The common options, with shorter texts than in the table. */
static const struct {
    unsigned verbs;
    const char *name, *text;
} common[] = {
    {STILL, "output", "file of the picture; its ending is the format"},
    {MOVIES, "output",
     "the movie, such as turn.mp4, or single frames: f_%04d.png"},
    {WRITTEN | VERB_EXPORT, "overwrite", "replace the file if it exists"},
    {TURNED, "size", "size in pixels (default 512x512)"},
    {VERB_SLICE, "size", "size in pixels (default: that of the slice)"},
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
      "snowglass slice cells.tif --axis z --at 30 -s 1024 -o z30.png"}},
    {VERB_TURNTABLE,
     {"snowglass turntable head.nii.gz -o head.mp4",
      "snowglass turntable ct.nrrd -o bone.gif --preset ct-bone --frames 60",
      "snowglass turntable cells.tif -o f_%04d.png --elevation 20 --resume"}},
    {VERB_MOVIE,
     {"snowglass movie run_%04d.nrrd -o run.mp4",
      "snowglass movie a.vti b.vti c.vti -o abc.webm -c viridis --range 0,1",
      "snowglass movie heart.nii.gz -o heart.gif --fps 10 --annotate step"}},
    {VERB_SERVE,
     {"snowglass serve head.nii.gz",
      "snowglass serve ct.nrrd --preset ct-bone --listen :8000",
      "snowglass serve run.nrrd --listen "
      "unix:$XDG_RUNTIME_DIR/snowglass.sock"}},
    {VERB_EXPORT,
     {"snowglass export head.html head.nii.gz",
      "snowglass export knee.html dicom/ --preset ct-bone",
      "snowglass export part.html run.h5 --crop 0:256,0:256,0:256"}},
};

/* The options that `render` does not have. */
static void print_own(const verb_row *verb) {
    printf("\noptions of %s:\n", verb->name);
    for (const option_row *row = option_table; row->name; row++)
        if (row->read && (row->verbs & verb->bit) &&
            !(row->verbs & VERB_RENDER))
            help_option(row, row->text);
}

static void print_examples(const verb_row *verb) {
    printf("\nexamples:\n");
    for (size_t i = 0; i < sizeof examples / sizeof *examples; i++)
        for (int n = 0; n < 3 && examples[i].verb == verb->bit; n++)
            printf("  %s\n", examples[i].lines[n]);
}

void help_brief(const verb_row *verb) {
    if (verb->bit != VERB_RENDER && verb->bit != VERB_EXPORT) /* have none */
        print_own(verb);
    printf("\ncommon options:\n");
    for (size_t i = 0; i < sizeof common / sizeof *common; i++)
        if (common[i].verbs & verb->bit)
            help_option(help_option_named(common[i].name), common[i].text);
    print_examples(verb);
    printf("\nall options, by topic (snowglass help TOPIC):\n");
    help_topics(verb->bit);
    printf("\nsnowglass help NAME explains an option (help window) or a preset "
           "(help ct-bone).\n");
}
