/* text.c - the lines of the help, at most 80 characters wide. */
#include "help/help.h"

#include <stdio.h>
#include <string.h>

#define WIDTH 80
#define COLUMN 29 /* column of the options' texts */
#define NAMES 20  /* column of the texts in a list of names */

/* Prints words, beginning at column `at` and wrapped to `indent`. */
void help_wrapped(const char *text, int at, int indent) {
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

/* Names on the left, text on the right, or on the next line if the names are
 * long. */
void help_option(const option_row *row, const char *text) {
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
    help_wrapped(text, COLUMN, COLUMN);
}

/* Prints names one after the other. */
static void print_plain_names(const char *title, const char *(*name)(size_t)) {
    char line[1024];
    size_t used = (size_t)snprintf(line, sizeof line, "%s:", title);
    for (size_t i = 0; name(i) && used < sizeof line; i++)
        used +=
            (size_t)snprintf(line + used, sizeof line - used, " %s", name(i));
    help_wrapped(line, 0, 2);
}

void help_names(const char *title, const char *(*name)(size_t),
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
        help_wrapped(text(i), NAMES, NAMES);
    }
}
