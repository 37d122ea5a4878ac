/* page.c - manual pages of the tool and its verbs. */
#include "manual/manual.h"
#include "manual/roff.h"

#include <ctype.h>
#include <stdio.h>
#include <string.h>

/* --- parts of pages ------------------------------------------------------- */

static void print_head(const char *title, const char *name, const char *text) {
    roff_head(title, 1, "the table of options");
    roff_chars(name, strlen(name), true);
    fputs(" \\- ", stdout);
    roff_text(text);
}

static void print_option(const option_row *row) {
    printf(".TP\n\\fB");
    if (row->letter)
        printf("\\-%c\\fR, \\fB", row->letter);
    printf("\\-\\-");
    roff_chars(row->name, strlen(row->name), true);
    printf("\\fR");
    if (row->argument) {
        printf(option_takes_word(row) ? " \\fI" : "\\fI");
        roff_chars(row->argument, strlen(row->argument), true);
        printf("\\fR");
    }
    putchar('\n');
    roff_text(row->text);
}

/* The options of a topic that a verb takes, NULL: any. */
static void print_topic(const verb_row *verb, topic which) {
    bool first = true;
    for (const option_row *row = option_table; row->name; row++) {
        if (row->topic != which || (verb && !verb_takes(verb, row)))
            continue;
        if (first) {
            char title[128];
            snprintf(title, sizeof title, "%s: %s%s", topic_table[which].name,
                     topic_table[which].text,
                     option_is_of_ranks(row) ? " (snowglass-mpi)" : "");
            roff_macro(".SS", title);
        }
        first = false;
        print_option(row);
    }
}

static void print_names(const char *title, const char *(*name)(size_t),
                        const char *(*text)(size_t)) {
    roff_macro(".SS", title);
    if (!text) {
        for (size_t i = 0; name(i); i++) {
            roff_chars(name(i), strlen(name(i)), true);
            puts(name(i + 1) ? "," : ".");
        }
    }
    for (size_t i = 0; text && name(i); i++)
        roff_item(name(i), text(i));
}

static void print_documents(void) {
    puts(".BR snowglass (3),\n.BR snowglass (5),\n.BR snowglass (7)");
    roff_text("and the documents in the folder share/doc/snowglass.");
}

static void print_see_also(void) {
    puts(".SH SEE ALSO\n.BR snowglass (1),");
    print_documents();
}

/* The page of the tool itself names those of its verbs. */
static void print_verb_pages(void) {
    puts(".SH SEE ALSO");
    for (const verb_row *verb = verb_table; verb->name; verb++)
        printf(".BR snowglass\\-%s (1),\n", verb->name);
    print_documents();
}

/* --- pages ---------------------------------------------------------------- */

static void print_verb(const verb_row *verb) {
    char name[WORD_BYTES];
    snprintf(name, sizeof name, "snowglass-%s", verb->name);
    print_head(name, name, verb->text);
    printf(".SH SYNOPSIS\n.B snowglass %s\n", verb->name);
    roff_text(verb->usage);
    puts(".SH DESCRIPTION");
    if (verb->bit == VERB_BENCH) {
        roff_text("It has options of its own, which "
                  "\"snowglass bench --help\" prints.");
    } else {
        char text[160];
        snprintf(text, sizeof text, "Verb of the tool: %s.", verb->text);
        roff_text(text);
        puts(".SH OPTIONS");
        for (int i = 0; topic_table[i].name; i++)
            print_topic(verb, (topic)i);
    }
    if (verb->bit == VERB_PHANTOM)
        print_names("Phantoms", snow_phantom_name, snow_phantom_description);
    print_see_also();
}

static void print_mpi(void) {
    print_head("snowglass-mpi", "snowglass-mpi",
               "volume rendering on many processes of MPI");
    puts(".SH SYNOPSIS\n.B mpirun \\-n\n.I N\n.B snowglass\\-mpi\nVERB ...");
    puts(".SH DESCRIPTION");
    roff_text("The tool snowglass under MPI: N processes make the same "
              "picture, each of its part of the volume. Verbs and options are "
              "those of snowglass, and those below. Start it with the "
              "launcher of the MPI that it was built with.");
    puts(".SH OPTIONS");
    print_topic(NULL, TOPIC_RANKS);
    print_see_also();
}

/* What a status means for the tool, where the library's words are about a
 * call. */
static const char *status_text(snow_status status) {
    if (status == SNOW_STATUS_BAD_USAGE)
        return "the command line is wrong: an unknown option or verb, a value "
               "out of its range, or options that exclude one another";
    if (status == SNOW_STATUS_STOPPED)
        return "interrupted by SIGINT (Ctrl-C), SIGTERM or SIGHUP; no file is "
               "left unfinished, and a movie keeps its finished frames for "
               "--resume";
    return snow_status_description(status);
}

static void print_statuses(void) {
    static const snow_status all[] = {
#define STATUS(name, value, text) SNOW_STATUS_##name,
        SNOW_STATUS_MAP(STATUS)
#undef STATUS
    };
    puts(".SH EXIT STATUS");
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) {
        char number[16], text[160];
        snprintf(number, sizeof number, "%d", (int)all[i]);
        snprintf(text, sizeof text, "%s.", status_text(all[i]));
        text[0] = (char)toupper((unsigned char)text[0]);
        roff_item(number, text);
        if (all[i] == SNOW_STATUS_DIFFERENT) /* the tool's own is the next */
            roff_item("7", "The picture is written, but it is empty.");
    }
}

static void print_environment(void) {
    puts(".SH ENVIRONMENT");
    roff_item("SLURM_CPUS_PER_TASK, SLURM_CPUS_ON_NODE",
              "processors that Slurm assigned; no more threads are started.");
    roff_item("PATH", "where ffmpeg, which encodes movies, is searched.");
    roff_item("TERM", "whether progress is a status line.");
    puts(".SH FILES");
    roff_item("share/snowglass/recipe.schema.json",
              "JSON schema of the files of --config and --save-config.");
    roff_item("lib/snowglass-*/",
              "modules for formats, beside the library or the tool's folder.");
}

static void print_examples(void) {
    static const char *const lines[] = {
        "snowglass phantom:engine -o engine.png --azimuth 30 --elevation 20",
        "snowglass head.nii.gz -o head.png --preset ct-bone -s 1024x1024",
        "snowglass turntable head.nii.gz -o head.webp --frames 60",
        "snowglass info volume.nrrd --json"};
    puts(".SH EXAMPLES\n.EX");
    for (size_t i = 0; i < sizeof lines / sizeof *lines; i++) {
        roff_chars(lines[i], strlen(lines[i]), true);
        putchar('\n');
    }
    puts(".EE");
}

static void print_overview(void) {
    print_head("snowglass", "snowglass",
               "volume rendering by sparse splatting");
    puts(".SH SYNOPSIS\n.B snowglass\n.I INPUT\n.B \\-o\n.I OUT.png\n[OPTIONS]"
         "\n.br\n.B snowglass\n.I VERB\n\\&... [OPTIONS]\n.SH DESCRIPTION");
    roff_text("INPUT is a volume file, phantom:NAME, or - for standard input. "
              "Each verb has a manual page, such as snowglass-render(1), with "
              "its options. \"snowglass help TOPIC\" prints the options of a "
              "topic.");
    puts(".SH VERBS");
    for (const verb_row *verb = verb_table; verb->name; verb++)
        roff_item(verb->name, verb->text);
    puts(".SH TOPICS");
    for (const topic_row *row = topic_table; row->name; row++)
        roff_item(row->name, row->text);
    puts(".SH NAMES");
    print_names("Presets", snow_preset_name, snow_preset_description);
    print_names("Colour maps", snow_colormap_name, NULL);
    print_names("Views", snow_view_name, NULL);
    print_names("Formats", snow_format_name, snow_format_description);
    print_names("Phantoms", snow_phantom_name, snow_phantom_description);
    print_statuses();
    print_environment();
    print_examples();
    print_verb_pages();
}

bool print_page(const char *name) {
    const verb_row *verb = name ? verb_named(name) : NULL;
    if (!name)
        print_overview();
    else if (verb)
        print_verb(verb);
    else if (strcmp(name, "mpi") == 0)
        print_mpi();
    else
        return false;
    return true;
}
