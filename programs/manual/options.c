/* options.c - the table of options as Markdown, for the pages of the site. */
#include "manual/manual.h"

#include <stdio.h>

/* A bar would end the cell. */
static void print_cell(const char *text) {
    for (; *text; text++)
        printf(*text == '|' ? "\\|" : *text == '<' ? "&lt;" : "%c", *text);
}

static void print_row(const option_row *row) {
    const char *before = "";
    printf("| `");
    if (row->letter)
        printf("-%c`, `", row->letter);
    printf("--%s", row->name);
    if (row->argument) {
        printf(option_takes_word(row) ? " " : "");
        for (const char *at = row->argument; *at; at++)
            printf(*at == '|' ? "\\|" : "%c", *at);
    }
    printf("` | ");
    print_cell(row->text);
    printf(" | ");
    for (const verb_row *verb = verb_table; verb->name; verb++) {
        if (verb_takes(verb, row)) {
            printf("%s%s", before, verb->name);
            before = ", ";
        }
    }
    printf(" |\n");
}

static void print_verbs(void) {
    printf("## Verbs\n\n| verb | does |\n| --- | --- |\n");
    for (const verb_row *verb = verb_table; verb->name; verb++) {
        printf("| `%s` | ", verb->name);
        print_cell(verb->text);
        printf(" |\n");
    }
}

void print_options(void) {
    print_verbs();
    for (int i = 0; topic_table[i].name; i++) {
        printf("\n## %s: %s\n\n| option | meaning | verbs |\n"
               "| --- | --- | --- |\n",
               topic_table[i].name, topic_table[i].text);
        for (const option_row *row = option_table; row->name; row++)
            if (row->topic == (topic)i)
                print_row(row);
    }
}
