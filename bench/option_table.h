/* bench/option_table.h - options of a benchmark from a table of them.  Only a
 * name in full is an option, so that a later one cannot change what a script
 * means; its value is the next word, or stands behind "=". */
#ifndef SNOW_BENCH_OPTION_TABLE_H
#define SNOW_BENCH_OPTION_TABLE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

#define BENCH_LIST_MOST 8

/* Numbers of a list such as 256,512. */
typedef struct bench_list {
    int count;
    int values[BENCH_LIST_MOST];
} bench_list;

typedef enum bench_option_kind {
    BENCH_FLAG,   /* bool: it is there */
    BENCH_WHOLE,  /* int, low to high */
    BENCH_NUMBER, /* double, low to high */
    BENCH_CHOICE, /* int: the number of a name */
    BENCH_TEXT,   /* const char *, not empty: somebody else reads it */
    BENCH_LIST    /* bench_list, each low to high */
} bench_option_kind;

/* An option: where its value goes, and what values there are. */
typedef struct bench_option {
    const char *name;
    bench_option_kind kind;
    void *value;
    double low, high;
    const char *const *choices; /* of a CHOICE, NULL at the end */
} bench_option;

typedef struct bench_option_table {
    const char *verb; /* for messages: "combine" */
    const bench_option *options;
    size_t count;
    const char **operand; /* the one word that is no option; NULL: none may
                             be */
} bench_option_table;

/* Reads the options after argv[0]; an exit code, or -1 to go on.  `said` may be
 * NULL: ranks but the first say nothing. */
int bench_option_table_read(const bench_option_table *table, int argc,
                            char **argv, FILE *said);

/* Says what is wrong with a word; the exit code. */
int bench_option_table_fail(const bench_option_table *table, FILE *said,
                            const char *what, const char *word);

#endif
