/* help.c - the help, written from the tables of option_table.c and from the
 * library's lists of names; lines are at most 80 characters wide. */
#include "options/options.h"
#include "run/log.h"
#include "run/sibling.h"

#include <stdio.h>
#include <string.h>

#define WIDTH 80
#define COLUMN 29 /* column of the options' texts */
#define NAMES 20  /* column of the texts in a list of names */

static const char overview[] =
    "snowglass - volume rendering by sparse splatting\n"
    "\n"
    "usage: snowglass INPUT -o OUT.png [OPTIONS]\n"
    "       snowglass VERB ... [OPTIONS]\n"
    "INPUT is a volume file, phantom:NAME, or - for standard input.\n";

static const char examples[] =
    "\n"
    "examples:\n"
    "  snowglass phantom:engine -o engine.png --azimuth 30 --elevation 20\n"
    "  snowglass head.nii.gz -o head.png --preset ct-bone -s 1024x1024\n"
    "  snowglass v.raw.gz --dims 256x256x110 --type uint8 -o v.png\n"
    "  snowglass info v.nrrd --json\n"
    "\n"
    "exit codes: 0 done; 1 rendering failed; 2 bad usage; 3 input missing,\n"
    "unreadable or unsupported; 4 output not writable; 5 not enough memory;\n"
    "6 the comparison differs; 7 the picture is empty; 130 interrupted.\n";

/* Prints words, beginning at column `at` and wrapped to `indent`. */
static void print_wrapped(const char *text, int at, int indent) {
    for (bool first = true; *text; first = false) {
        int length = (int)strcspn(text, " ");
        if (!first && at + 1 + length > WIDTH) {
            printf("\n%*s", indent, "");
            at = indent;
        } else if (!first) {
            printf(" ");
            at++;
        }
        printf("%.*s", length, text);
        at += length;
        text += length + (text[length] == ' ');
    }
    printf("\n");
}

/* Prints one option: names on the left, text on the right, or on the next line
 * if the names are long. */
static void print_option(const option_row *row) {
    char left[WIDTH];
    char letter[5] = "    ";
    if (row->letter)
        snprintf(letter, sizeof letter, "-%c, ", row->letter);
    int used =
        snprintf(left, sizeof left, "  %s--%s%s%s", letter, row->name,
                 row->argument ? " " : "", row->argument ? row->argument : "");
    printf("%s", left);
    if (used > COLUMN - 2) {
        printf("\n");
        used = 0;
    }
    printf("%*s", COLUMN - used, "");
    print_wrapped(row->text, COLUMN, COLUMN);
}

/* A row belongs to one topic and may serve several verbs. */
static bool belongs(const option_row *row, topic which, unsigned verbs) {
    return row->topic == which && (row->verbs & verbs) != 0;
}

static void print_heading(topic which) {
    printf("%s: %s\n", topic_table[which].name, topic_table[which].text);
}

/* Whether a verb has options of a topic: its page omits the others. */
static bool has_options(topic which, unsigned verbs) {
    const option_row *row = option_table;
    while (row->name && !(row->read && belongs(row, which, verbs)))
        row++;
    return row->name != NULL;
}

/* An option that is not built yet has no reader and is not listed. */
static void print_options(topic which, unsigned verbs) {
    for (const option_row *row = option_table; row->name; row++) {
        if (row->read && belongs(row, which, verbs))
            print_option(row);
    }
}

/* Names the options that are planned, so that nobody searches for them. */
static void print_later(topic which) {
    char line[512] = "";
    size_t used = 0;
    for (const option_row *row = option_table; row->name; row++) {
        if (!row->read && row->topic == which && used < sizeof line)
            used += (size_t)snprintf(line + used, sizeof line - used, " --%s",
                                     row->name);
    }
    if (used) {
        printf("  not built yet:");
        print_wrapped(line, 16, 4);
    }
}

/* Prints names one after the other. */
static void print_plain_names(const char *title, const char *(*name)(size_t)) {
    char line[1024];
    size_t used = (size_t)snprintf(line, sizeof line, "%s:", title);
    for (size_t i = 0; name(i) && used < sizeof line; i++)
        used +=
            (size_t)snprintf(line + used, sizeof line - used, " %s", name(i));
    print_wrapped(line, 0, 2);
}

/* Prints one of the library's lists of names. */
static void print_names(const char *title, const char *(*name)(size_t),
                        const char *(*text)(size_t)) {
    printf("\n");
    if (!text) {
        print_plain_names(title, name);
        return;
    }
    printf("%s:\n", title);
    for (size_t i = 0; name(i); i++) {
        int used = printf("  %-18s", name(i));
        if (used > NAMES)
            printf("\n%*s", NAMES, "");
        print_wrapped(text(i), NAMES, NAMES);
    }
}

/* The options of all verbs, then the names that they take. */
static int print_topic_page(topic which) {
    print_heading(which);
    print_options(which, ~0U);
    print_later(which);
    if (which == TOPIC_LOOK) {
        print_names("presets", snow_preset_name, snow_preset_description);
        print_names("colour maps", snow_colormap_name, NULL);
    } else if (which == TOPIC_CAMERA) {
        print_names("views", snow_view_name, NULL);
    } else if (which == TOPIC_DATA) {
        print_names("formats", snow_format_name, snow_format_description);
        print_names("phantoms (as phantom:NAME)", snow_phantom_name,
                    snow_phantom_description);
    }
    return finish_stdout();
}

/* The page of a verb lists only the options that it takes. */
static int print_verb_page(const verb_row *row) {
    if (!row->bit)
        return fail_usage("%s is not built yet; %s", row->name, row->text);
    if (row->bit == VERB_BENCH) { /* it reads and tells its own options */
        char *words[] = {NULL, "--help", NULL};
        return sibling_run("snowglass-bench", words);
    }
    printf("snowglass %s %s\n%s\n", row->name, row->usage, row->text);
    for (int i = 0; topic_table[i].name; i++) {
        if (topic_is_here((topic)i) && has_options((topic)i, row->bit)) {
            printf("\n");
            print_heading((topic)i);
            print_options((topic)i, row->bit);
        }
    }
    if (row->bit == VERB_PHANTOM)
        print_names("phantoms", snow_phantom_name, snow_phantom_description);
    return finish_stdout();
}

/* The overview omits verbs that are not built yet; help VERB names them. */
static int print_overview(void) {
    printf("%s\nverbs:\n", overview);
    for (const verb_row *row = verb_table; row->name; row++) {
        if (row->bit)
            printf("  %-11s%s\n", row->name, row->text);
    }
    printf("\ntopics (snowglass help TOPIC, or a verb's name):\n");
    for (int i = 0; topic_table[i].name; i++)
        if (topic_is_here((topic)i))
            printf("  %-11s%s\n", topic_table[i].name, topic_table[i].text);
    printf("%s", examples);
    return finish_stdout();
}

/* Lists the topics, since whoever mistypes one does not know them. */
static int refuse_word(const char *word) {
    char names[256] = "";
    size_t used = 0;
    for (int i = 0; topic_table[i].name && used < sizeof names; i++)
        if (topic_is_here((topic)i))
            used += (size_t)snprintf(names + used, sizeof names - used, " %s",
                                     topic_table[i].name);
    return fail_usage("%s: is not a topic or a verb; topics:%s", word, names);
}

/* No topic has the name of a verb, so the order of the searches does not
 * matter. */
int help_print(const char *word, const verb_row *verb) {
    if (!word)
        return verb ? print_verb_page(verb) : print_overview();
    for (int i = 0; topic_table[i].name; i++) {
        if (strcmp(word, topic_table[i].name) == 0 && topic_is_here((topic)i))
            return print_topic_page((topic)i);
    }
    const verb_row *named = verb_named(word);
    return named ? print_verb_page(named) : refuse_word(word);
}

/* Prints to standard error: a call without arguments is a mistake, and its
 * output must not be taken for data. */
void help_hint(void) {
    fputs("usage: snowglass INPUT -o OUT.png [OPTIONS]\n"
          "       snowglass VERB ... [OPTIONS]\n"
          "try snowglass --help, or "
          "snowglass phantom:engine -o engine.png\n",
          stderr);
}
