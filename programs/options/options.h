/* options.h - the command line: the table of options, the record that they are
 * read into, and the help.
 *
 * The parser, --help and the suggestion of the nearest name all use the one
 * table. */
#ifndef OPTIONS_H
#define OPTIONS_H

#include "options/channels.h"
#include "options/option_values.h"
#include "series/moment.h"

#include <snowglass/look_file.h>
#include <snowglass/snowglass.h>

/* Exit codes of an interrupted run, and of one whose picture is written but
 * empty; all others are a snow_status. */
#define EXIT_INTERRUPTED 130
#define EXIT_EMPTY 7

/* Returned by a parser if the command should run. */
#define CONTINUE (-1)

enum {
    VERB_RENDER = 1 << 0,
    VERB_INFO = 1 << 1,
    VERB_PHANTOM = 1 << 2,
    VERB_COMPARE = 1 << 3,
    VERB_BENCH = 1 << 4,
    VERB_DOCTOR = 1 << 5,
    VERB_HELP = 1 << 6,
    VERB_TURNTABLE = 1 << 7,
    VERB_MOVIE = 1 << 8,
    VERB_CONVERT = 1 << 9,
    VERB_TF = 1 << 10,
    VERB_SLICE = 1 << 11,
    VERB_SERVE = 1 << 12,
    VERB_EXPORT = 1 << 13,
    VERB_REPORT = 1 << 14
};

typedef enum topic {
    TOPIC_OUTPUT,
    TOPIC_MODE,
    TOPIC_SPARSE,
    TOPIC_KERNEL,
    TOPIC_LOOK,
    TOPIC_QUALITY,
    TOPIC_CAMERA,
    TOPIC_LABELS,
    TOPIC_DATA,
    TOPIC_RUN,
    TOPIC_RANKS, /* only in the program with MPI */
    TOPIC_MORE   /* of single verbs */
} topic;

/* Must exceed the number of rows in option_table: more would be lost. */
#define OPTION_ROWS_MOST 128

/* --as of frames on standard output; no voxels have it. */
#define AS_RGB24 ((snow_type)64)

/* Size of the texts of a configuration. */
#define CONFIG_TEXTS_BYTES 32768

/* All options.  Texts point into argv or, for a configuration, into `texts`. */
typedef struct options {
    const char *output; /* NULL: not given */
    bool named;         /* the output after the input, as none was given */
    int64_t size[2];    /* width, height */
    color_value background;
    const char *bits; /* NULL: not given */
    bool show;        /* in the terminal */
    bool overwrite;

    double threshold; /* below 0: not given */
    const char *encoding, *method, *kernel;
    int64_t footprint; /* 0: the kernel's default */

    const char *mode;
    double iso;                    /* NaN: not given */
    const char *depth;             /* NULL: none */
    const char *colormap, *preset; /* NULL: automatic */
    const char *tf;                /* a file; NULL: none */
    snow_look_file *loaded;     /* the content of that file, set by look_load */
    snow_context *tf_context;   /* that owns it */
    struct first_volume *first; /* what was opened already; NULL: nothing */
    scale_value scale;
    point_list opacities, gradient_opacities;
    double window[2];         /* width, centre; NaN: not given */
    range_value range, usual; /* the latter of projections, where that is open;
                                 SNOW_RANGE_AUTO: without far outliers */
    bool slab; /* a projection was chosen, since the volume is a thin slab */
    const char *opacity_unit; /* of a recipe; NULL: not given */
    const char *shade;
    light_value light;
    double material[4]; /* ambient, diffuse, specular, shininess */
    double depth_darkening, occlusion;

    const char *view; /* NULL: the volume's own */
    double azimuth, elevation, roll, zoom;
    double fov;      /* 0: parallel */
    const char *fit; /* what the picture frames */
    place_value position, target, up;

    int64_t dims[3];    /* 0: not given */
    snow_type type, as; /* of frames: AS_RGB24 */
    double spacing[3];  /* 0: not given */
    const char *endian; /* NULL: not given */
    uint64_t offset;
    int64_t time;          /* -1: the last */
    int64_t time_end;      /* of a range: one past its last; INT64_MAX: all */
    bool time_range;       /* `time` is the first of several */
    moment moment;         /* physical time of the step */
    char *input[1];        /* the operand, where it was a pattern of files */
    int64_t channel;       /* the first of the list, or the only one */
    channel_list channels; /* none: all that the file shows, or the first */
    bool mixes;            /* the channels of the file are drawn together */
    bool one_channel;      /* never: no picture is made */
    const char *component; /* NULL: not given */
    const char *dataset;   /* NULL: not given */
    const char *series;    /* NULL: not given */
    bool allow_gaps;
    const char *suv;                         /* NULL: not given */
    int64_t levels;                          /* 0: all */
    const char *vertical;                    /* NULL: not given */
    double z_scale;                          /* 0: auto */
    int64_t crop[3][2];                      /* 0: the end */
    double clip[SNOW_CLIPS_MAX][4];          /* zeros: none */
    const char *mask, *labels, *label_table; /* NULL: not given */
    const char *overlay;
    overlay_look_value overlay_look;
    const char *overlay_hidden; /* of a recipe; verbs that do not show it */
    bool overlay_picks;         /* `labels` are its, not the input's */

    bool each_time; /* `time` is one of all steps, which are opened in turn */

    const char *axis, *at;  /* of a slice; NULL: not given */
    const char *grid;       /* of slices; NULL: not given */
    const char *thickness;  /* of slices (--slab); NULL: not given */
    bool ortho;             /* slices across all three axes */
    listen_value listen;    /* of the viewer */
    const char *allow_host; /* names, separated by commas; NULL: none */
    const char *embed;      /* origins, separated by commas; NULL: none */
    const char *token_file; /* NULL: none */
    const char *live;       /* a simulation's recipe; NULL: none */

    int64_t frames; /* in a turn */
    double fps;
    bool resume;

    double tolerance;
    bool json;
    bool patient;
    const char *stats; /* NULL: none */
    const char *progress, *isa, *quality;
    int64_t threads; /* 0: not given */
    uint64_t memory; /* bytes; 0: no limit */
    const char *cut, *combine;
    int64_t radix;  /* 0: automatic */
    double timeout; /* seconds; 0: none */
    bool deterministic;
    bool no_labels;
    legend_value legend;
    const char *title; /* NULL: none */
    annotate_value annotate;
    const char *box;     /* "outline", "axes"; NULL: none */
    const char *measure; /* NULL: nothing */
    int verbosity;       /* -1 quiet, 0, 1 verbose; the last one counts */

    bool version, help;
    const char *help_word;            /* the requested name, or NULL */
    const char *config, *save_config; /* NULL: none */
    char texts[CONFIG_TEXTS_BYTES];
    size_t text_bytes;
    char *config_input; /* the operand, if none is given */

    char **operands;
    int operand_count;
    const char *given[OPTION_ROWS_MOST]; /* the text of each row of the table as
                                            it was given, NULL: not given */
    bool configured[OPTION_ROWS_MOST];   /* set by --config */
} options;

typedef struct option_row option_row;

/* Parses an option's argument into its field.  Returns false if it is invalid:
 * `wrong` is then the rest of the sentence that begins with the option and its
 * argument. */
typedef bool option_read(const option_row *row, const char *text, void *field,
                         char wrong[WRONG_BYTES]);

/* One option. */
struct option_row {
    const char *name;     /* long name */
    char letter;          /* short name, or 0 */
    const char *argument; /* its name in the help, or its choices a|b; in
                             brackets if it is optional; NULL: none */
    topic topic;
    unsigned verbs; /* the verbs that take it */
    option_read *read;
    size_t field;     /* offset in options */
    double low, high; /* for numbers; both 0: any finite number */
    const char *text; /* help, with the default */
};

/* Ends with a row without a name. */
extern const option_row option_table[];

/* One verb.  `operands` below 0 means that it reads its own arguments. */
typedef struct verb_row {
    const char *name;
    unsigned bit;
    int operands;
    const char *usage; /* the operands, for the help */
    const char *text;
} verb_row;

/* Ends with a row without a name. */
extern const verb_row verb_table[];

/* Topics of the help, in the order of the enum; ends with a NULL name. */
typedef struct topic_row {
    const char *name;
    const char *text;
} topic_row;
extern const topic_row topic_table[];

/* Whether this program has a topic. */
bool topic_is_here(topic which);

/* The index of the choice that `text` names. */
int option_choice(const char *name, const char *text);

const verb_row *verb_named(const char *name);
const verb_row *verb_of(unsigned bit);

/* Sets the defaults. */
void options_init(options *out);

/* Parses the arguments of a verb; argv[0] is the verb's own name.  Returns
 * CONTINUE, or an exit code after the error was printed. */
int options_parse(options *out, const verb_row *verb, int argc, char **argv);

/* Sets an option by its long name as if it stood on the command line, unless it
 * stands there, or the verb does not take it.  `text` NULL: without a value.
 * Returns CONTINUE or an exit code. */
int options_take(options *out, const verb_row *verb, const char *name,
                 const char *text);

/* Whether an option was given, on the command line or in the file of
 * --config. */
bool options_given(const options *opts, const char *name);

/* Whether it was given on the command line. */
bool options_typed(const options *opts, const char *name);

/* Whether a mode projects values; the others, over and iso, have surfaces and
 * depths. */
bool mode_is_projection(const char *mode);

/* Bits per channel of a picture; 0: not given. */
int options_bits(const options *opts);

/* The range of --range, or of --window. */
range_value options_range(const options *opts);

/* Whether the box has ticks. */
bool options_has_axes(const options *opts);

/* Whether --colormap is a list of colours, which lie at values of the data. */
bool options_place_colors(const options *opts);

/* Prints help to standard output: `word` names a verb, a topic, an option with
 * or without dashes, or a preset; NULL means the page of `verb`, or the
 * overview if that is NULL too.  Returns an exit code. */
int help_print(const char *word, const verb_row *verb);

/* Prints the few lines of `snowglass` without arguments to standard error. */
void help_hint(void);

#endif
