/* formats/amr/words.c - lines of text as AMReX writes them, and their numbers:
 * "((0,0,0) (31,31,31) (0,0,0))". */
#include "formats/amr/amr.h"

#include <string.h>

#define BETWEEN " \t\r,()"

/* Splits off the next word; 0 at the end, -1 for one that is too long. */
static int next_word(const char **at, char word[64]) {
    *at += strspn(*at, BETWEEN);
    size_t length = strcspn(*at, BETWEEN);
    if (length >= 64)
        return -1;
    memcpy(word, *at, length);
    word[length] = 0;
    *at += length;
    return length > 0;
}

int snow_amr_numbers(const char *text, double *out, int most) {
    char word[64];
    int count = 0, found;
    while ((found = next_word(&text, word)) > 0)
        if (count == most || !snow_parse_double(word, &out[count++]))
            return -1;
    return found < 0 ? -1 : count;
}

int snow_amr_integers(const char *text, int64_t *out, int most) {
    char word[64];
    int count = 0, found;
    while ((found = next_word(&text, word)) > 0)
        if (count == most || !snow_parse_int64(word, &out[count++]))
            return -1;
    return found < 0 ? -1 : count;
}

/* --- lines ---------------------------------------------------------------- */

snow_status snow_amr_refuse(snow_context *context, const char *line,
                            const char *what) {
    return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                     "its line \"%.80s\" should be %s; it is damaged, copy it "
                     "again",
                     line, what);
}

snow_status snow_amr_line(snow_source *source, char *line, size_t bytes,
                          const char *what) {
    bool got;
    SNOW_TRY(snow_source_read_line(source, line, bytes, &got));
    return got ? SNOW_STATUS_OK
               : snow_fail(snow_source_context(source), SNOW_STATUS_BAD_INPUT,
                           "ends before %s; it is cut off, copy it again",
                           what);
}
