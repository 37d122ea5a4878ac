/* manual.h - what snowglass-manual writes: manual pages, completions of shells
 * and the JSON schema of recipes from the table of options; the pages of the
 * library from its headers, those of file formats and the model from docs/.
 *
 * It is a program of the build and is not installed (cmake/manual.cmake). */
#ifndef MANUAL_H
#define MANUAL_H

#include "options/parse.h"

#include <stdbool.h>
#include <stddef.h>

#define WORD_BYTES 64

/* The words that an option's argument can be, or that begin it: its choices, or
 * names of the library's lists.  NULL from the end on; may lie in `room`. */
const char *option_word(const option_row *row, size_t index,
                        char room[WORD_BYTES]);

/* What an option's text says of one of its words, as "fast" of "low" in
 * "quality. low: fast; high: slow".  NULL: nothing. */
const char *word_text(const char *text, const char *word);

/* The same of the first operand of a verb, taken from its usage. */
const char *verb_word(const verb_row *verb, size_t index,
                      char room[WORD_BYTES]);

/* Whether the next word is the option's argument; one in brackets follows an
 * equals sign. */
bool option_takes_word(const option_row *row);
bool option_takes_file(const option_row *row);

/* Whether an option is built, and taken by the verb; that it is of the program
 * with MPI alone. */
bool verb_takes(const verb_row *verb, const option_row *row);
bool option_is_of_ranks(const option_row *row);

/* The first clause of a help text. */
#define BRIEF_BYTES 96
const char *brief(const char *text, char room[BRIEF_BYTES]);

/* Print to standard output.  `name` of a page is a verb, "mpi", or NULL for the
 * overview; false: there is no such page. */
bool print_page(const char *name);
void print_bash(void);
void print_zsh(void);
void print_fish(bool mpi);
void print_options(void); /* a table for each topic, as Markdown */
int print_schema(void);   /* an exit code */

/* The page of a public header, or of sections of documents: a number of the
 * manual, a summary, then FILE, HEADING and TITLE of each.  False: there is no
 * such file or section. */
bool print_header(const char *path);
bool print_document(int count, char **words);

#endif
