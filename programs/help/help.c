/* help.c - finds what is asked: the page of a verb (verb.c), of a topic
 * (topic.c), of an option or preset (word.c), or the overview. */
#include "help/help.h"
#include "options/elsewhere.h"
#include "options/guess.h"
#include "run/log.h"

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

static int print_overview(void) {
    printf("%s\nverbs:\n", overview);
    for (const verb_row *row = verb_table; row->name; row++) {
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
    const char *now = option_elsewhere(word + strspn(word, "-"));
    if (now)
        return fail_usage("%s: %s", word, now);
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
    int done = verb ? help_verb_page(verb) : SNOW_STATUS_OK;
    bool listed = !row || (verb ? (row->verbs & verb->bit) != 0
                                : (int)row->topic == which);
    if (done != SNOW_STATUS_OK)
        return done;
    if (!verb)
        help_topic_page((topic)which);
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
        return verb ? help_verb_page(verb) : print_overview();
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
