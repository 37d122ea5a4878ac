/* guess.h - guesses which of some names a misspelt word was meant to be. */
#ifndef GUESS_H
#define GUESS_H

#include <stdbool.h>
#include <stddef.h>

/* The most names that a guess lists. */
#define GUESSES_MOST 3

/* Names must live as long as the guess. */
typedef struct guess {
    const char *word;
    int distance; /* of the names so far; 0: they contain the word */
    const char *names[GUESSES_MOST];
    size_t count;
} guess;

/* Begins with no names, for a word as it was written. */
void guess_begin(guess *out, const char *word);

/* Takes a name if it is as near as those so far, or alone if it is nearer. */
void guess_offer(guess *out, const char *name);

/* Offers all of a list that ends with NULL. */
void guess_offer_all(guess *out, const char *(*name)(size_t));

/* Writes "a", "a or b" or "a, b or c", each after `before`; "" if no name is
 * near.  Returns whether there is one. */
bool guess_write(const guess *g, const char *before, char *out, size_t size);

#endif
