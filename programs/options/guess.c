/* guess.c - guesses which of some names a misspelt word was meant to be.
 *
 * A name that contains the word is nearest: bone is meant to be ct-bone.  Else
 * the number of single-character edits counts, where two neighbours that
 * changed places are one edit (Damerau's distance, optimal string alignment).
 * A third of the letters may be wrong, and one more.  Case does not matter. */
#include "options/guess.h"

#include <ctype.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

/* Longer words are not misspelt names. */
#define WORD_BYTES 64

/* Shorter words are in too many names. */
#define PART_LEAST 3

static bool same_letter(char a, char b) {
    return tolower((unsigned char)a) == tolower((unsigned char)b);
}

static int smaller(int a, int b) {
    return a < b ? a : b;
}

/* One cell of the table of distances, whose last three rows are kept: between
 * the first i letters of `a` and the first j of `b`. */
static int cell(const char *a, const char *b, size_t i, size_t j,
                int rows[3][WORD_BYTES]) {
    const int *before = rows[(i + 1) % 3], *last = rows[(i + 2) % 3];
    int best = last[j - 1] + !same_letter(a[i - 1], b[j - 1]);
    best = smaller(best, smaller(last[j], rows[i % 3][j - 1]) + 1);
    bool swapped = i > 1 && j > 1 && same_letter(a[i - 1], b[j - 2]) &&
                   same_letter(a[i - 2], b[j - 1]);
    return swapped ? smaller(best, before[j - 2] + 1) : best;
}

static int distance_of(const char *a, const char *b) {
    int rows[3][WORD_BYTES];
    size_t m = strlen(a), n = strlen(b);
    if (m >= WORD_BYTES || n >= WORD_BYTES)
        return WORD_BYTES;
    for (size_t j = 0; j <= n; j++)
        rows[0][j] = (int)j;
    for (size_t i = 1; i <= m; i++) {
        rows[i % 3][0] = (int)i;
        for (size_t j = 1; j <= n; j++)
            rows[i % 3][j] = cell(a, b, i, j, rows);
    }
    return rows[m % 3][n];
}

static bool contains(const char *name, const char *word) {
    size_t length = strlen(word);
    for (; length >= PART_LEAST && *name; name++)
        if (strncasecmp(name, word, length) == 0)
            return true;
    return false;
}

void guess_begin(guess *out, const char *word) {
    size_t length = strlen(word);
    int most = length <= PART_LEAST ? 1 : (int)length / 3 + 1;
    *out = (guess){.word = word, .distance = length ? most : -1};
}

void guess_offer(guess *out, const char *name) {
    int distance = contains(name, out->word) ? 0 : distance_of(name, out->word);
    if (distance > out->distance)
        return;
    if (distance < out->distance)
        out->count = 0;
    out->distance = distance;
    if (out->count < GUESSES_MOST)
        out->names[out->count++] = name;
}

void guess_offer_all(guess *out, const char *(*name)(size_t)) {
    for (size_t i = 0; name(i); i++)
        guess_offer(out, name(i));
}

bool guess_write(const guess *g, const char *before, char *out, size_t size) {
    size_t used = 0;
    out[0] = '\0';
    for (size_t i = 0; i < g->count && used < size; i++) {
        const char *between = i == 0 ? "" : i + 1 == g->count ? " or " : ", ";
        used += (size_t)snprintf(out + used, size - used, "%s%s%s", between,
                                 before, g->names[i]);
    }
    return g->count > 0;
}
