/* bench/words.c - options of a benchmark from a table of them. */
#include "words.h"

#include <snowglass/context.h>

#include <stdlib.h>
#include <string.h>

/* NaN is in no range. */
static bool parse_number(const char *text, double low, double high,
                         double *out) {
    char *end;
    double value = strtod(text, &end);
    if (end == text || *end || !(value >= low && value <= high))
        return false;
    *out = value;
    return true;
}

static bool choose(const bench_word *word, const char *text) {
    for (int i = 0; word->choices[i]; i++)
        if (strcmp(text, word->choices[i]) == 0) {
            *(int *)word->value = i;
            return true;
        }
    return false;
}

/* Takes a value; false when it is none. */
static bool take(const bench_word *word, const char *text) {
    double number;
    if (word->kind == BENCH_CHOICE)
        return choose(word, text);
    if (word->kind == BENCH_TEXT) {
        *(const char **)word->value = text;
        return true;
    }
    if (!parse_number(text, word->low, word->high, &number))
        return false;
    if (word->kind == BENCH_NUMBER) {
        *(double *)word->value = number;
        return true;
    }
    *(int *)word->value = (int)number;
    return (double)(int)number == number;
}

int bench_words_fail(const bench_words *table, FILE *said, const char *what,
                     const char *word) {
    if (said)
        fprintf(said,
                "snowglass: bench %s: %s '%s'; see snowglass bench %s "
                "--help\n",
                table->verb, what, word, table->verb);
    return SNOW_STATUS_BAD_USAGE;
}

static const bench_word *find(const bench_words *table, const char *name) {
    for (size_t i = 0; i < table->count; i++)
        if (strcmp(name, table->words[i].name) == 0)
            return &table->words[i];
    return NULL;
}

int bench_words_read(const bench_words *table, int argc, char **argv,
                     FILE *said) {
    for (int i = 1; i < argc; i++) {
        const bench_word *word = find(table, argv[i]);
        bool operand = !word && argv[i][0] != '-' && table->operand;
        if (operand && *table->operand)
            return bench_words_fail(table, said, "one word too many:", argv[i]);
        if (operand)
            *table->operand = argv[i];
        else if (!word)
            return bench_words_fail(table, said, "there is no option", argv[i]);
        else if (word->kind == BENCH_WORD)
            *(bool *)word->value = true;
        else if (i + 1 == argc)
            return bench_words_fail(table, said, "a value is missing after",
                                    argv[i]);
        else if (!take(word, argv[++i]))
            return bench_words_fail(table, said,
                                    "this value is not possible:", argv[i]);
    }
    return -1;
}
