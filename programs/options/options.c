/* options.c - the parser: getopt_long with the option table.
 *
 * Options may follow operands, "--" ends them, and the last of a repeated
 * option counts.  Options that are unknown or of another verb are refused. */
#include "options/options.h"
#include "options/config.h"
#include "options/elsewhere.h"
#include "options/guess.h"
#include "options/parse.h"
#include "run/log.h"
#include "run/start.h"

#include <ctype.h>
#include <getopt.h>
#include <math.h>
#include <snowglass/recipe.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

#define ROWS_MAX OPTION_ROWS_MOST

/* Above all characters, so that long options do not collide with letters. */
#define FIRST_LONG 256

/* What recipes have comes from the library, so that the tool, the viewer and
 * simulations cannot disagree; Python has it from here (programs/manual/). */
void options_init(options *out) {
    snow_recipe recipe;
    snow_recipe_init(&recipe);
    const snow_settings settings = recipe.settings;
    *out = (options){
        .size = {recipe.width, recipe.height},
        .background = {.automatic = true},
        .threshold = -1,
        .encoding = snow_encoding_name(settings.encoding),
        .method = snow_method_name(settings.method),
        .kernel = snow_kernel_name(settings.kernel),
        .mode = snow_mode_name(settings.mode),
        .iso = NAN,
        .window = {NAN, NAN},
        .shade = "phong",
        .light = {settings.light},
        .material = {settings.ambient, settings.diffuse, settings.specular,
                     settings.shininess},
        .zoom = recipe.zoom,
        .fit = "visible",
        .progress = "auto",
        .isa = snow_isa_name(settings.isa),
        .quality = snow_quality_name(settings.quality),
        .cut = "auto",
        .combine = "auto",
        .timeout = 300,
        .frames = 120,
        .fps = recipe.fps,
        .moment = {.value = NAN},
    };
}

bool topic_is_here(topic which) {
    return which != TOPIC_RANKS || process_mpi() != NULL;
}

/* The index is the number of choices before the word in the row. */
int option_choice(const char *name, const char *text) {
    const option_row *row = option_table;
    size_t length = strlen(text);
    int index = 0;
    while (strcmp(row->name, name) != 0)
        row++;
    for (const char *at = row->argument; *at; index++) {
        size_t word = strcspn(at, "|");
        if (word == length && strncmp(at, text, word) == 0)
            break;
        at += word + (at[word] == '|');
    }
    return index;
}

/* Names of verbs cannot be abbreviated, as those of options. */
const verb_row *verb_named(const char *name) {
    for (const verb_row *row = verb_table; row->name; row++) {
        if (strcmp(row->name, name) == 0)
            return row;
    }
    return NULL;
}

const verb_row *verb_of(unsigned bit) {
    const verb_row *row = verb_table;
    while (row->name && row->bit != bit)
        row++;
    return row;
}

/* Whether an option has an optional argument, a number. */
static bool takes_number(const option_row *row) {
    return row->argument && row->argument[0] == '[';
}

/* Converts the table to getopt's form. */
static void fill_getopt(struct option longs[ROWS_MAX + 1],
                        char letters[2 * ROWS_MAX + 2]) {
    size_t used = 0;
    int count = 0;
    letters[used++] =
        ':'; /* distinguishes a missing argument from an unknown name */
    for (const option_row *row = option_table; row->name && count < ROWS_MAX;
         row++, count++) {
        bool optional = row->argument &&
                        (strcmp(row->name, "help") == 0 || takes_number(row));
        int argument = optional        ? optional_argument
                       : row->argument ? required_argument
                                       : no_argument;
        longs[count] =
            (struct option){row->name, argument, NULL, FIRST_LONG + count};
        if (row->letter) {
            letters[used++] = row->letter;
            if (argument == required_argument)
                letters[used++] = ':';
        }
    }
    longs[count] = (struct option){NULL, 0, NULL, 0};
    letters[used] = '\0';
}

/* Converts getopt's result, a letter or one of our numbers, to a row. */
static const option_row *row_of(int code) {
    if (code >= FIRST_LONG)
        return &option_table[code - FIRST_LONG];
    const option_row *row = option_table;
    while (row->name && row->letter != code)
        row++;
    return row->name ? row : NULL;
}

/* Writes the options of a verb that a name may have been meant to be. */
static bool guess_option(const char *name, unsigned verb, char *out,
                         size_t size) {
    guess near;
    guess_begin(&near, name);
    for (const option_row *row = option_table; row->name; row++)
        if ((row->verbs & verb) && topic_is_here(row->topic))
            guess_offer(&near, row->name);
    return guess_write(&near, "--", out, size);
}

/* Reports a word that getopt does not know: `word` as written; `code` is the
 * row of an option that was given an argument but takes none. */
static int refuse_unknown(const verb_row *verb, const char *word, int code) {
    if (code >= FIRST_LONG)
        return fail_usage("%s: --%s takes no value; remove what follows =",
                          word, row_of(code)->name);
    if (code)
        return fail_usage("-%c: unknown option; see snowglass help %s", code,
                          verb->name);
    char name[64], near[128];
    snprintf(name, sizeof name, "%.*s", (int)strcspn(word + 2, "="), word + 2);
    if (option_elsewhere(name))
        return fail_usage("--%s: %s", name, option_elsewhere(name));
    /* getopt reports unknown and ambiguous abbreviations in the same way, but
     * they need different advice. */
    int hits = 0;
    for (const option_row *row = option_table; row->name; row++)
        hits += strncmp(row->name, name, strlen(name)) == 0;
    if (hits > 1)
        return fail_usage("--%s: matches several options; write the full name, "
                          "see snowglass help %s",
                          name, verb->name);
    if (guess_option(name, verb->bit, near, sizeof near))
        return fail_usage("--%s: unknown option; did you mean %s?", name, near);
    return fail_usage("--%s: unknown option; see snowglass help %s", name,
                      verb->name);
}

/* Refuses an option of other verbs. */
static int refuse_foreign(const option_row *row, const verb_row *verb) {
    for (const verb_row *other = verb_table; other->name; other++) {
        if (other->bit & row->verbs)
            return fail_usage(
                "--%s: is not an option of %s but of %s; remove it", row->name,
                verb->name, other->name);
    }
    return fail_usage("--%s: is not an option of %s; remove it", row->name,
                      verb->name);
}

/* Whether an option's letters have a meaning in one case only; other readers
 * compare without regard to case, or take names of files and of what is in
 * them. */
static bool has_small_letters(const option_row *row, const char *text) {
    static option_read *const readers[] = {
        read_choice, read_size,  read_dims,   read_spacing,
        read_range,  read_scale, read_kernel, read_combine};
    if (row->read == read_component)
        return strcasecmp(text, "magnitude") == 0 ||
               (strlen(text) == 1 && strchr("WXYZ", *text)); /* not names: U */
    for (size_t i = 0; i < sizeof readers / sizeof *readers; i++)
        if (row->read == readers[i])
            return true;
    return false;
}

/* Such letters are kept small, as in the table: -m MIP is mip, P1,P99 is
 * p1,p99.  If there is no room, the text stays, and is refused where it is
 * used. */
static const char *keep_small(options *out, const option_row *row,
                              const char *text) {
    size_t length = text ? strlen(text) + 1 : 0;
    if (!text || !has_small_letters(row, text) ||
        length > CONFIG_TEXTS_BYTES - out->text_bytes)
        return text;
    char *kept = out->texts + out->text_bytes;
    for (size_t i = 0; i < length; i++)
        kept[i] = (char)tolower((unsigned char)text[i]);
    out->text_bytes += length;
    return kept;
}

static int take_option(options *out, const option_row *row,
                       const verb_row *verb, const char *text) {
    if (!topic_is_here(row->topic))
        return fail_usage(
            "--%s: is only for several ranks; use snowglass-mpi with mpirun",
            row->name);
    if (!(row->verbs & verb->bit))
        return refuse_foreign(row, verb);
    char wrong[WRONG_BYTES];
    const char *kept = keep_small(out, row, text);
    out->given[row - option_table] = kept ? kept : "";
    if (row->read(row, kept ? kept : "", (char *)out + row->field, wrong))
        return CONTINUE;
    return fail_usage("--%s: '%s' %s", row->name, text, wrong);
}

static const option_row *row_named(const char *name) {
    const option_row *row = option_table;
    while (row->name && strcmp(row->name, name) != 0)
        row++;
    return row;
}

bool options_given(const options *opts, const char *name) {
    return opts->given[row_named(name) - option_table] != NULL;
}

bool options_typed(const options *opts, const char *name) {
    return options_given(opts, name) &&
           !opts->configured[row_named(name) - option_table];
}

int options_take(options *out, const verb_row *verb, const char *name,
                 const char *text) {
    const option_row *row = row_named(name);
    if (!row->name || !(row->verbs & verb->bit) || options_given(out, name))
        return CONTINUE;
    out->configured[row - option_table] = true;
    return take_option(out, row, verb, text);
}

/* The next word is the optional argument only if all of it is a number, or the
 * word of --legend; otherwise it is an operand, as in --perspective in.nrrd. */
static const char *take_number(const option_row *row, int argc, char **argv) {
    double number;
    if (optind >= argc ||
        (row->read == read_legend ? strcmp(argv[optind], "scale") != 0
                                  : !value_real(argv[optind], &number)))
        return NULL;
    return argv[optind++];
}

/* The long option just read as it was written, NULL for a letter.  If its value
 * is a word of its own, it stands one word before that. */
static const char *long_word(char **argv) {
    const char *word = argv[optind - 1];
    if (optarg && optarg == word)
        word = argv[optind - 2];
    return strncmp(word, "--", 2) == 0 ? word + 2 : NULL;
}

int options_parse(options *out, const verb_row *verb, int argc, char **argv) {
    struct option longs[ROWS_MAX + 1];
    char letters[2 * ROWS_MAX + 2];
    fill_getopt(longs, letters);
    opterr = 0; /* errors are printed here, in our own words */
    optind = 1;
    int code;
    while ((code = getopt_long(argc, argv, letters, longs, NULL)) != -1) {
        if (code == '?')
            return refuse_unknown(verb, argv[optind - 1], optopt);
        const option_row *row = row_of(code == ':' ? optopt : code);
        const char *word = long_word(argv);
        /* getopt_long accepts abbreviations: --azim would be --azimuth, until
         * another option begins so. */
        const bool whole = !word || strcspn(word, "=") == strlen(row->name);
        if (!whole && option_elsewhere(word))
            return fail_usage("--%.*s: %s", (int)strcspn(word, "="), word,
                              option_elsewhere(word));
        if (!whole)
            return fail_usage("--%s: unknown option; did you mean --%s?", word,
                              row->name);
        if (code == ':')
            return fail_usage("--%s: needs a value; give --%s %s", row->name,
                              row->name, row->argument);
        if (strcmp(row->name, "help") == 0) {
            bool follows = !optarg && optind < argc && argv[optind][0] != '-';
            out->help = true;
            out->help_word = follows ? argv[optind] : optarg;
            return CONTINUE;
        }
        const char *text = optarg;
        if (takes_number(row) && text && !*text)
            return fail_usage(
                "--%s: needs a value after =; give one, or remove the =",
                row->name);
        if (takes_number(row) && !text)
            text = take_number(row, argc, argv);
        int done = take_option(out, row, verb, text);
        if (done != CONTINUE || out->version)
            return done;
    }
    out->operands = argv + optind;
    out->operand_count = argc - optind;
    int done = config_take(out, verb);
    bool named = strcmp(argv[0], verb->name) == 0;
    return done == CONTINUE ? operands_check(out, verb, named) : done;
}
