/* options.h - the command line: one table of options, what they are read
 * into, and the help that is written from the same table.
 *
 * The table is the single source: the parser, --help, the refusal of what is
 * not built yet and the suggestion of the nearest name all read it. */
#ifndef OPTIONS_H
#define OPTIONS_H

#include "values.h"

#include <snowglass/snowglass.h>
#include <snowglass/tf.h>

/* Exit code of a run that was interrupted; all others are a snow_status. */
#define EXIT_INTERRUPTED 130

/* What a parser answers when the command shall run. */
#define GO_ON (-1)

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
    VERB_TF = 1 << 10
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
    TOPIC_RANKS, /* of the program under MPI only */
    TOPIC_MORE   /* of single verbs */
} topic;

/* More than option_table has: rows beyond would be lost. */
#define OPTION_ROWS_MOST 96

/* Room for the texts of a configuration. */
#define CONFIG_TEXTS_BYTES 32768

/* Everything that can be asked.  Texts point into argv or, of a configuration,
 * into `texts`. */
typedef struct options {
    const char *output; /* NULL: not told */
    int64_t size[2];    /* width, height */
    color_value background;
    const char *bits; /* NULL: not told */
    bool overwrite;

    double threshold; /* below 0: not told */
    const char *encoding, *method, *kernel;
    int64_t footprint; /* 0: the kernel's own */

    const char *mode;
    double iso;                    /* NaN: not told */
    const char *depth;             /* NULL: none */
    const char *colormap, *preset; /* NULL: automatic */
    const char *tf;                /* a file; NULL: none */
    snow_tf *loaded;               /* what it holds, from look_load on */
    snow_context *tf_context;      /* that it lies in */
    bool log;
    point_list opacities, gradient_opacities;
    double window, level; /* NaN: not told */
    range_value range;
    const char *opacity_unit, *shade;
    double light[2]; /* azimuth, elevation */
    double ambient, diffuse, specular, shininess;

    const char *view; /* NULL: the volume's own */
    double azimuth, elevation, roll, zoom;
    double fov; /* 0: parallel */
    place_value position, target, up;

    int64_t dims[3]; /* 0: not told */
    snow_type type, as;
    double spacing[3];  /* 0: not told */
    const char *endian; /* NULL: not told */
    uint64_t offset;
    int64_t time;
    int64_t channel;
    const char *dataset;             /* NULL: not told */
    const char *series;              /* NULL: not told */
    int64_t crop[3][2];              /* 0: the end */
    double clip[SNOW_CLIPS_MOST][4]; /* zeros: none */
    const char *mask, *labels;       /* NULL: not told */
    uint64_t seed;

    bool each_time; /* `time` is one of all, which are opened in turn */

    int64_t frames; /* of a turn */
    double fps;
    bool resume;

    double tolerance;
    bool json;
    bool patient;
    const char *stats; /* NULL: none */
    const char *progress, *isa, *quality;
    int64_t threads; /* 0: not told */
    uint64_t memory; /* bytes; 0: no limit */
    const char *cut, *combine;
    int64_t radix;  /* 0: chosen */
    double timeout; /* seconds; 0: none */
    bool deterministic;
    bool no_labels, legend, time_label;
    int verbosity; /* -1 quiet, 0, 1 verbose: the last one counts */

    bool version, help;
    const char *help_word;            /* the topic or verb asked for, or NULL */
    const char *config, *save_config; /* NULL: none */
    char texts[CONFIG_TEXTS_BYTES];
    size_t text_bytes;
    char *config_input; /* the operand where none is given */

    char **operands;
    int operand_count;
    const char *told[OPTION_ROWS_MOST]; /* the text of each row of the table as
                                           it was given, NULL: not told */
    bool configured[OPTION_ROWS_MOST];  /* told by --config */
} options;

typedef struct option_row option_row;

/* Reads an option's argument into its field.  False when it does not fit:
 * `wrong` then ends the sentence that the option and its argument begin. */
typedef bool option_read(const option_row *row, const char *text, void *field,
                         char wrong[WRONG_BYTES]);

/* One option.  A row without `read` is known but not built yet. */
struct option_row {
    const char *name;     /* long name */
    char letter;          /* short name, or 0 */
    const char *argument; /* its name in the help, or its choices a|b; in
                             brackets when it may be left out; NULL */
    topic topic;
    unsigned verbs; /* those that take it */
    option_read *read;
    size_t field;      /* offset in options */
    double low, high;  /* of numbers; both 0: any finite number */
    const char *later; /* choices that are not built yet, a|b */
    const char *text;  /* help, with the default; of a row that is not built,
                          what to do without it */
};

/* Ends with a row without name. */
extern const option_row option_table[];

/* One verb.  `operands` below 0 means that it reads its own arguments. */
typedef struct verb_row {
    const char *name;
    unsigned bit; /* 0: known but not built yet */
    int operands;
    const char *usage; /* what follows its name */
    const char *text;
} verb_row;

/* Ends with a row without name. */
extern const verb_row verb_table[];

/* Names of the topics and a line on each, in the order of the enum; ends with
 * a NULL name.  `built` says what there is where the options offer no choice
 * yet, NULL elsewhere. */
typedef struct topic_row {
    const char *name;
    const char *text;
    const char *built;
} topic_row;
extern const topic_row topic_table[];

/* Whether a topic is one of this program. */
bool topic_is_here(topic which);

/* Which of its choices an option has, from 0. */
int option_choice(const char *name, const char *text);

const verb_row *verb_named(const char *name);
const verb_row *verb_of(unsigned bit);

/* The defaults. */
void options_init(options *out);

/* Reads the arguments of a verb; argv[0] is the verb's own name.  Answers
 * GO_ON, or an exit code after the fault has been told on stderr. */
int options_parse(options *out, const verb_row *verb, int argc, char **argv);

/* Takes an option by its long name as if it stood on the command line, unless
 * that has it, or the verb takes none such.  `text` NULL: without a value.
 * Answers GO_ON or an exit code. */
int options_take(options *out, const verb_row *verb, const char *name,
                 const char *text);

/* Whether an option stands on the command line, or in the file of --config. */
bool options_told(const options *asked, const char *name);

/* Whether it stands on the command line itself. */
bool options_typed(const options *asked, const char *name);

/* Writes the help that was asked for to standard output: `word` names a topic
 * or a verb, NULL means that of `verb`, or the overview when that is NULL too.
 * Answers an exit code. */
int help_print(const char *word, const verb_row *verb);

/* The few lines of `snowglass` alone, to standard error. */
void help_hint(void);

#endif
