/* bench/option_table.c - options of a benchmark from a table of them. */
#include "option_table.h"

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

static bool choose(const bench_option *option, const char *text) {
    for (int i = 0; option->choices[i]; i++)
        if (strcmp(text, option->choices[i]) == 0) {
            *(int *)option->value = i;
            return true;
        }
    return false;
}

/* Takes a value; false when it is none. */
static bool take(const bench_option *option, const char *text) {
    double number;
    if (option->kind == BENCH_CHOICE)
        return choose(option, text);
    if (option->kind == BENCH_TEXT) {
        *(const char **)option->value = text;
        return true;
    }
    if (!parse_number(text, option->low, option->high, &number))
        return false;
    if (option->kind == BENCH_NUMBER) {
        *(double *)option->value = number;
        return true;
    }
    *(int *)option->value = (int)number;
    return (double)(int)number == number;
}

int bench_option_table_fail(const bench_option_table *table, FILE *said,
                            const char *what, const char *word) {
    if (said)
        fprintf(said,
                "snowglass: bench %s: %s '%s'; see snowglass bench %s "
                "--help\n",
                table->verb, what, word, table->verb);
    return SNOW_STATUS_BAD_USAGE;
}

static const bench_option *find(const bench_option_table *table,
                                const char *name) {
    for (size_t i = 0; i < table->count; i++)
        if (strcmp(name, table->options[i].name) == 0)
            return &table->options[i];
    return NULL;
}

int bench_option_table_read(const bench_option_table *table, int argc,
                            char **argv, FILE *said) {
    for (int i = 1; i < argc; i++) {
        const bench_option *option = find(table, argv[i]);
        bool operand = !option && argv[i][0] != '-' && table->operand;
        if (operand && *table->operand)
            return bench_option_table_fail(table, said,
                                           "one word too many:", argv[i]);
        if (operand)
            *table->operand = argv[i];
        else if (!option)
            return bench_option_table_fail(table, said, "there is no option",
                                           argv[i]);
        else if (option->kind == BENCH_FLAG)
            *(bool *)option->value = true;
        else if (i + 1 == argc)
            return bench_option_table_fail(table, said,
                                           "a value is missing after", argv[i]);
        else if (!take(option, argv[++i]))
            return bench_option_table_fail(
                table, said, "this value is not possible:", argv[i]);
    }
    return -1;
}
