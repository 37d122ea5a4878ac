/* options.c - the parser: getopt_long over the one table.
 *
 * Options may follow operands, "--" ends them, a repeated one counts as told
 * last.  What is unknown, of another verb, or not built yet is refused. */
#include "options.h"
#include "config.h"
#include "launch.h"
#include "report.h"

#include <getopt.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#define ROWS_MAX OPTION_ROWS_MOST

/* Beyond all characters, so that long options do not collide with letters. */
#define FIRST_LONG 256

/* The numbers of the shading come from the library, so that the tool cannot
 * disagree with it. */
void options_init(options *out) {
    snow_settings settings;
    snow_settings_init(&settings);
    *out = (options){
        .size = {512, 512},
        .threshold = -1,
        .encoding = snow_encoding_name(settings.encoding),
        .method = snow_method_name(settings.method),
        .kernel = snow_kernel_name(settings.kernel),
        .mode = "over",
        .iso = NAN,
        .window = NAN,
        .level = NAN,
        .opacity_unit = "voxel",
        .shade = "phong",
        .ambient = settings.ambient,
        .diffuse = settings.diffuse,
        .specular = settings.specular,
        .shininess = settings.shininess,
        .zoom = 1,
        .progress = "auto",
        .isa = "auto",
        .quality = "normal",
        .cut = "auto",
        .combine = "auto",
        .timeout = 300,
        .frames = 120,
        .fps = 25,
    };
}

bool topic_is_here(topic which) {
    return which != TOPIC_RANKS || launch_mpi() != NULL;
}

/* The words before it in the row, of which it is one. */
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

/* Verbs count in full only, as options do. */
const verb_row *verb_named(const char *name) {
    for (const verb_row *row = verb_table; row->name; row++) {
        if (strcmp(row->name, name) == 0)
            return row;
    }
    return NULL;
}

/* The row of a verb that is built; the rows of others have no bit. */
const verb_row *verb_of(unsigned bit) {
    const verb_row *row = verb_table;
    while (row->name && row->bit != bit)
        row++;
    return row;
}

/* An argument that may be left out: a number. */
static bool takes_number(const option_row *row) {
    return row->read && row->argument && row->argument[0] == '[';
}

/* The table in getopt's form. */
static void fill_getopt(struct option longs[ROWS_MAX + 1],
                        char letters[2 * ROWS_MAX + 2]) {
    size_t used = 0;
    int count = 0;
    letters[used++] = ':'; /* tells a missing argument from an unknown name */
    for (const option_row *row = option_table; row->name && count < ROWS_MAX;
         row++, count++) {
        bool optional = row->argument &&
                        (row->read == NULL || strcmp(row->name, "help") == 0 ||
                         takes_number(row));
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

/* From what getopt answers, a letter or a number of ours, back to the row. */
static const option_row *row_of(int code) {
    if (code >= FIRST_LONG)
        return &option_table[code - FIRST_LONG];
    const option_row *row = option_table;
    while (row->name && row->letter != code)
        row++;
    return row->name ? row : NULL;
}

/* The option whose name is nearest to the given one, when it is near: a third
 * of the letters may be wrong, and one more in short names. */
static const char *nearest_option(const char *name, unsigned verb) {
    const char *best = NULL;
    int least = (int)strlen(name) / 3 + 2;
    for (const option_row *row = option_table; row->name; row++) {
        int distance = value_distance(name, row->name);
        if ((row->verbs & verb) && row->read && distance < least &&
            topic_is_here(row->topic)) {
            least = distance;
            best = row->name;
        }
    }
    return best;
}

/* getopt answers an unknown and an ambiguous abbreviation alike; people need
 * different advice. */
static bool is_ambiguous(const char *name, size_t length) {
    int hits = 0;
    for (const option_row *row = option_table; row->name; row++)
        hits += strncmp(row->name, name, length) == 0;
    return hits > 1;
}

/* getopt met a word that it does not know: `word` as it was written, `code`
 * the row of an option that was given an argument which it does not take. */
static int refuse_unknown(const verb_row *verb, const char *word, int code) {
    if (code >= FIRST_LONG)
        return fail_usage("%s: --%s takes no value; leave out what follows =",
                          word, row_of(code)->name);
    if (code)
        return fail_usage("-%c: unknown option; see snowglass help %s", code,
                          verb->name);
    char name[64];
    snprintf(name, sizeof name, "%.*s", (int)strcspn(word + 2, "="), word + 2);
    if (is_ambiguous(name, strlen(name)))
        return fail_usage("--%s: begins several options; write it in full, "
                          "see snowglass help %s",
                          name, verb->name);
    const char *near = nearest_option(name, verb->bit);
    if (near)
        return fail_usage("--%s: unknown option; did you mean --%s?", name,
                          near);
    return fail_usage("--%s: unknown option; see snowglass help %s", name,
                      verb->name);
}

/* An option that exists, but for other verbs. */
static int refuse_foreign(const option_row *row, const verb_row *verb) {
    for (const verb_row *other = verb_table; other->name; other++) {
        if (other->bit & row->verbs)
            return fail_usage("--%s: no option of %s; it belongs to %s",
                              row->name, verb->name, other->name);
    }
    return fail_usage("--%s: no option of %s", row->name, verb->name);
}

/* Not built comes before foreign: what no verb can do belongs to none. */
static int take(options *out, const option_row *row, const verb_row *verb,
                const char *text) {
    if (!row->read)
        return fail_usage("--%s is not built yet; %s", row->name, row->text);
    if (!topic_is_here(row->topic))
        return fail_usage("--%s: is for many ranks; give it to snowglass-mpi, "
                          "under mpirun",
                          row->name);
    if (!(row->verbs & verb->bit))
        return refuse_foreign(row, verb);
    char wrong[WRONG_BYTES];
    out->told[row - option_table] = text ? text : "";
    if (row->read(row, text ? text : "", (char *)out + row->field, wrong))
        return GO_ON;
    return fail_usage("--%s: '%s' %s", row->name, text, wrong);
}

static const option_row *row_named(const char *name) {
    const option_row *row = option_table;
    while (row->name && strcmp(row->name, name) != 0)
        row++;
    return row;
}

bool options_told(const options *asked, const char *name) {
    return asked->told[row_named(name) - option_table] != NULL;
}

bool options_typed(const options *asked, const char *name) {
    return options_told(asked, name) &&
           !asked->configured[row_named(name) - option_table];
}

int options_take(options *out, const verb_row *verb, const char *name,
                 const char *text) {
    const option_row *row = row_named(name);
    if (!row->name || !(row->verbs & verb->bit) || options_told(out, name))
        return GO_ON;
    out->configured[row - option_table] = true;
    return take(out, row, verb, text);
}

/* An argument that may be left out is the word behind the option only where all
 * of that is a number: any other is an operand, as in --perspective in.nrrd. */
static const char *take_number(int argc, char **argv) {
    double number;
    if (optind >= argc || !value_real(argv[optind], &number))
        return NULL;
    return argv[optind++];
}

/* --help ends the reading; the word after it is its topic. */
static int take_help(options *out, int argc, char **argv, const char *text) {
    bool follows = !text && optind < argc && argv[optind][0] != '-';
    out->help = true;
    out->help_word = follows ? argv[optind] : text;
    return GO_ON;
}

/* A word too many may be a verb that was misspelt, or that stands behind the
 * options. */
static int refuse_words(const options *out, const verb_row *verb) {
    const char *first = out->operands[0];
    for (const verb_row *other = verb_table; other->name; other++) {
        int distance = value_distance(first, other->name);
        if (verb->bit != VERB_RENDER || access(first, F_OK) == 0)
            continue;
        if (distance == 0)
            return fail_usage("%s: the verb comes first; give snowglass %s %s",
                              first, other->name, other->usage);
        if (distance <= (int)strlen(first) / 3)
            return fail_usage("%s: no verb; did you mean %s?", first,
                              other->name);
    }
    return fail_usage("%s: one word too many for %s; give snowglass %s %s",
                      out->operands[verb->operands], verb->name, verb->name,
                      verb->usage);
}

/* Too few or too many operands: a file that is forgotten, or an unquoted
 * name with blanks. */
static int check_count(const options *out, const verb_row *verb) {
    if (verb->operands < 0 || out->operand_count == verb->operands)
        return GO_ON;
    if (out->operand_count > verb->operands)
        return refuse_words(out, verb);
    return fail_usage("%s: something is missing; give snowglass %s %s",
                      verb->name, verb->name, verb->usage);
}

/* The long option just read as it was written, NULL for a letter.  A value in a
 * word of its own stands between it and getopt's place. */
static const char *long_word(char **argv) {
    const char *word = argv[optind - 1];
    if (optarg && optarg == word)
        word = argv[optind - 2];
    return strncmp(word, "--", 2) == 0 ? word + 2 : NULL;
}

/* getopt_long takes any beginning of a name for the name: --foo would be
 * --footprint, and something else once another option begins so. */
static bool in_full(const char *word, const option_row *row) {
    return !word || strcspn(word, "=") == strlen(row->name);
}

int options_parse(options *out, const verb_row *verb, int argc, char **argv) {
    struct option longs[ROWS_MAX + 1];
    char letters[2 * ROWS_MAX + 2];
    fill_getopt(longs, letters);
    opterr = 0; /* faults are told here, in our own words */
    optind = 1;
    int code;
    while ((code = getopt_long(argc, argv, letters, longs, NULL)) != -1) {
        if (code == '?')
            return refuse_unknown(verb, argv[optind - 1], optopt);
        const option_row *row = row_of(code == ':' ? optopt : code);
        const char *word = long_word(argv);
        if (!in_full(word, row))
            return fail_usage("--%s: unknown option; did you mean --%s?", word,
                              row->name);
        if (code == ':')
            return fail_usage("--%s: its value is missing; give --%s %s",
                              row->name, row->name, row->argument);
        if (strcmp(row->name, "help") == 0)
            return take_help(out, argc, argv, optarg);
        const char *text = optarg;
        if (takes_number(row) && text && !*text)
            return fail_usage("--%s: its value is missing; give --%s=30, or "
                              "leave out the =",
                              row->name, row->name);
        if (takes_number(row) && !text)
            text = take_number(argc, argv);
        int done = take(out, row, verb, text);
        if (done != GO_ON || out->version)
            return done;
    }
    out->operands = argv + optind;
    out->operand_count = argc - optind;
    int done = config_take(out, verb);
    return done == GO_ON ? check_count(out, verb) : done;
}
