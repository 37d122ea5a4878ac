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

static bool parse_list(const char *text, double low, double high,
                       bench_list *out) {
    bench_list list = {0};
    if (text[strspn(text, "0123456789,")])
        return false;
    for (const char *at = text;; at++) {
        char *end;
        long value = strtol(at, &end, 10);
        if (end == at || (double)value < low || (double)value > high ||
            list.count == BENCH_LIST_MOST)
            return false;
        list.values[list.count++] = (int)value;
        at = end;
        if (!*at)
            break;
    }
    *out = list;
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

/* Reads a value; false when it is none. */
static bool read_value(const bench_option *option, const char *text) {
    double number;
    if (option->kind == BENCH_CHOICE)
        return choose(option, text);
    if (option->kind == BENCH_LIST)
        return parse_list(text, option->low, option->high, option->value);
    if (option->kind == BENCH_TEXT) {
        *(const char **)option->value = text;
        return *text;
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
    const size_t length = strcspn(name, "=");
    for (size_t i = 0; i < table->count; i++)
        if (strlen(table->options[i].name) == length &&
            strncmp(name, table->options[i].name, length) == 0)
            return &table->options[i];
    return NULL;
}

/* Reads one option, whose value may be the next word; what is wrong, or NULL.
 * *last becomes the word that was looked at last. */
static const char *read_option(const bench_option *option, char **argv,
                               char ***last) {
    char *value = strchr(argv[0], '=');
    if (option->kind == BENCH_FLAG) {
        *(bool *)option->value = true;
        return value ? "this option has no value:" : NULL;
    }
    if (!value && !argv[1])
        return "a value is missing after";
    *last = value ? argv : argv + 1;
    if (read_value(option, value ? value + 1 : argv[1]))
        return NULL;
    return "this value is not possible:";
}

int bench_option_table_read(const bench_option_table *table, int argc,
                            char **argv, FILE *said) {
    for (char **at = argv + 1; at < argv + argc; at++) {
        const bench_option *option = find(table, *at);
        const char *wrong = NULL;
        bool operand = !option && **at != '-' && table->operand;
        if (option)
            wrong = read_option(option, at, &at);
        else if (!operand)
            wrong = "there is no option";
        else if (*table->operand)
            wrong = "one word too many:";
        else
            *table->operand = *at;
        if (wrong)
            return bench_option_table_fail(table, said, wrong, *at);
    }
    return -1;
}
