/* help.c - the help, written from the tables of option_table.c and from the
 * library's lists of names.  Verbs that render have a short page
 * (help_brief.c); options and presets have one each (help_word.c). */
#include "options/help.h"
#include "options/guess.h"
#include "options/renamed.h"
#include "run/log.h"
#include "run/sibling.h"

#include <stdio.h>
#include <string.h>

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

/* A row belongs to one topic and may serve several verbs. */
static bool belongs(const option_row *row, topic which, unsigned verbs) {
    return row->topic == which && (row->verbs & verbs) != 0;
}

static void print_heading(topic which) {
    printf("%s: %s\n", topic_table[which].name, topic_table[which].text);
}

bool help_has_options(topic which, unsigned verbs) {
    const option_row *row = option_table;
    while (row->name && !(row->read && belongs(row, which, verbs)))
        row++;
    return row->name != NULL;
}

/* An option that is not built yet has no reader and is not listed. */
static void print_options(topic which, unsigned verbs) {
    for (const option_row *row = option_table; row->name; row++) {
        if (row->read && belongs(row, which, verbs))
            help_option(row, row->text);
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
        help_wrapped(line, 16, 4);
    }
}

/* The options of all verbs, then the names that they take. */
static int print_topic_page(topic which) {
    print_heading(which);
    print_options(which, ~0U);
    print_later(which);
    if (which == TOPIC_LOOK) {
        help_names("presets", snow_preset_name, snow_preset_description);
        help_names("colour maps", snow_colormap_name, NULL);
    } else if (which == TOPIC_CAMERA) {
        help_views();
    } else if (which == TOPIC_DATA) {
        help_names("formats", snow_format_name, snow_format_description);
        help_names("phantoms (as phantom:NAME)", snow_phantom_name,
                   snow_phantom_description);
    }
    return finish_stdout();
}

/* The page of a verb lists only the options that it takes. */
static int print_verb_page(const verb_row *row) {
    if (!row->bit)
        return fail_usage("%s is not built yet; %s", row->name, row->text);
    if (row->bit == VERB_BENCH) { /* it reads and describes its own options */
        char *words[] = {NULL, "--help", NULL};
        return sibling_run("snowglass-bench", words);
    }
    printf("snowglass %s %s\n%s\n", row->name, row->usage, row->text);
    if (row->bit & (VERB_RENDER | VERB_TURNTABLE | VERB_MOVIE | VERB_SLICE |
                    VERB_SERVE | VERB_EXPORT)) {
        help_brief(row);
        return finish_stdout();
    }
    for (int i = 0; topic_table[i].name; i++) {
        if (topic_is_here((topic)i) && help_has_options((topic)i, row->bit)) {
            printf("\n");
            print_heading((topic)i);
            print_options((topic)i, row->bit);
        }
    }
    if (row->bit == VERB_PHANTOM)
        help_names("phantoms", snow_phantom_name, snow_phantom_description);
    return finish_stdout();
}

void help_topics(unsigned verbs) {
    for (int i = 0; topic_table[i].name; i++)
        if (topic_is_here((topic)i) && help_has_options((topic)i, verbs))
            printf("  %-11s%s\n", topic_table[i].name, topic_table[i].text);
}

/* The overview omits verbs that are not built yet; help VERB names them. */
static int print_overview(void) {
    printf("%s\nverbs:\n", overview);
    for (const verb_row *row = verb_table; row->name; row++) {
        if (row->bit)
            printf("  %-11s%s\n", row->name, row->text);
    }
    printf("\ntopics (snowglass help NAME, also of a verb, an option or a "
           "preset):\n");
    help_topics(~0U);
    printf("%s", examples);
    return finish_stdout();
}

/* The topic of a name that this program has; -1: none. */
static int topic_named(const char *word) {
    for (int i = 0; topic_table[i].name; i++)
        if (strcmp(word, topic_table[i].name) == 0 && topic_is_here((topic)i))
            return i;
    return -1;
}

/* The names that are near, or the topics, since whoever mistypes one does not
 * know them. */
static int refuse_word(const char *word) {
    char names[256] = "";
    size_t used = 0;
    guess near;
    guess_begin(&near, word + strspn(word, "-"));
    for (const verb_row *row = verb_table; row->name; row++)
        if (row->bit)
            guess_offer(&near, row->name);
    for (int i = 0; topic_table[i].name; i++) {
        if (!topic_is_here((topic)i))
            continue;
        guess_offer(&near, topic_table[i].name);
        if (used < sizeof names)
            used += (size_t)snprintf(names + used, sizeof names - used, " %s",
                                     topic_table[i].name);
    }
    for (const option_row *row = option_table; row->name; row++)
        if (!verb_named(row->name) && topic_named(row->name) < 0)
            guess_offer(&near, row->name);
    guess_offer_all(&near, snow_preset_name);
    const char *now = renamed_option(word + strspn(word, "-"));
    if (now)
        return fail_usage("%s: is now %s", word, now);
    const char *what = "is not a verb, topic, option or preset";
    char meant[128];
    if (guess_write(&near, "", meant, sizeof meant))
        return fail_usage("%s: %s; did you mean %s?", word, what, meant);
    return fail_usage("%s: %s; topics:%s", word, what, names);
}

/* The page of a topic or a verb, and those of an option, which the page does
 * not list, and of a preset of the same name. */
static int print_page(int which, const verb_row *verb, const option_row *row,
                      int preset) {
    int done = verb ? print_verb_page(verb) : print_topic_page((topic)which);
    bool listed = !row || (verb ? (row->verbs & verb->bit) != 0
                                : (int)row->topic == which);
    if (done != SNOW_STATUS_OK)
        return done;
    if (!listed) {
        printf("\n");
        help_option_page(row);
    }
    if (preset >= 0) {
        printf("\n");
        help_preset_page((size_t)preset);
    }
    return finish_stdout();
}

/* No topic has the name of a verb. */
int help_print(const char *word, const verb_row *verb) {
    if (!word)
        return verb ? print_verb_page(verb) : print_overview();
    const option_row *row = help_option_named(word);
    int which = topic_named(word), preset = snow_preset_from_name(word);
    const verb_row *named = verb_named(word);
    if (which >= 0 || named)
        return print_page(which, named, row, preset);
    if (row)
        help_option_page(row);
    else if (preset >= 0)
        help_preset_page((size_t)preset);
    else
        return refuse_word(word);
    return finish_stdout();
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
