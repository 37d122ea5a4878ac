/* bench/words.h - options of a benchmark from a table of them.
 *
 * For benchmarks whose options have nothing in common with those of others;
 * only a name in full is an option. */
#ifndef SNOW_BENCH_WORDS_H
#define SNOW_BENCH_WORDS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

typedef enum bench_kind {
    BENCH_WORD,   /* bool: it is there */
    BENCH_WHOLE,  /* int, low to high */
    BENCH_NUMBER, /* double, low to high */
    BENCH_CHOICE, /* int: the number of a name */
    BENCH_TEXT    /* const char *: what it says, somebody else reads */
} bench_kind;

/* An option: where its value goes, and what values there are. */
typedef struct bench_word {
    const char *name;
    bench_kind kind;
    void *value;
    double low, high;
    const char *const *choices; /* of a CHOICE, NULL at the end */
} bench_word;

typedef struct bench_words {
    const char *verb; /* for messages: "combine" */
    const bench_word *words;
    size_t count;
    const char **operand; /* the one word that is no option; NULL: none may
                             be */
} bench_words;

/* Reads the words after argv[0]; an exit code, or -1 to go on.  `said` may be
 * NULL: ranks but the first say nothing. */
int bench_words_read(const bench_words *table, int argc, char **argv,
                     FILE *said);

/* Says what is wrong with a word; the exit code. */
int bench_words_fail(const bench_words *table, FILE *said, const char *what,
                     const char *word);

#endif
