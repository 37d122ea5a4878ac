/* base/text.c - parses numbers and names in untrusted text. */
#include "base/base.h"

#include <ctype.h>
#include <errno.h>
#include <langinfo.h>
#include <stdlib.h>
#include <string.h>

/* True if only blanks follow. */
static bool at_end(const char *text) {
    while (isspace((unsigned char)*text))
        text++;
    return !*text;
}

bool snow_parse_int64(const char *text, int64_t *out) {
    char *end;
    errno = 0;
    long long value = strtoll(text, &end, 10);
    if (end == text || errno || !at_end(end))
        return false;
    *out = value;
    return true;
}

/* Longer than any double's exact decimal form, which is longest for the
 * smallest number: 1077 characters. */
#define NUMBER_BYTES 1200

/* Hexadecimal numbers are rejected here: no format has them, but strtod accepts
 * them. */
bool snow_localize_number(const char *text, const char *point, char *out,
                          size_t capacity) {
    size_t length = strlen(point), used = 0;
    for (; *text; text++) {
        bool is_point = *text == '.';
        /* "1,5" is not a number in a file, whatever the locale. */
        if (*text == 'x' || *text == 'X' ||
            (!is_point && length && !strncmp(text, point, length)))
            return false;
        size_t wanted = is_point ? length : 1;
        if (wanted >= capacity - used)
            return false;
        memcpy(out + used, is_point ? point : text, wanted);
        used += wanted;
    }
    out[used] = 0;
    return true;
}

/* strtod uses the locale of the calling program, which the library must neither
 * trust nor change: files have a point, which is replaced here by that of the
 * locale. nl_langinfo is used because localeconv's result is shared by all
 * threads. */
bool snow_parse_double(const char *text, double *out) {
    char *end, number[NUMBER_BYTES];
    if (!snow_localize_number(text, nl_langinfo(RADIXCHAR), number,
                              sizeof number))
        return false;
    errno = 0;
    double value = strtod(number, &end);
    /* 1e999 is not taken for infinity; a number too small for a double is 0. */
    bool overflow = errno == ERANGE && (value > 1 || value < -1);
    if (end == number || overflow || !at_end(end))
        return false;
    *out = value;
    return true;
}

bool snow_has_suffix(const char *text, const char *suffix) {
    size_t n = strlen(text), m = strlen(suffix);
    if (m > n)
        return false;
    for (size_t i = 0; i < m; i++)
        if (tolower((unsigned char)text[n - m + i]) !=
            tolower((unsigned char)suffix[i]))
            return false;
    return true;
}

/* The significant characters of a name: the leading sign, then all except
 * dashes and underscores. ASCII only, so that no locale changes the meaning of
 * a name. */
static int next_letter(const char *name, size_t *at) {
    while (*at > 0 && (name[*at] == '-' || name[*at] == '_'))
        ++*at;
    char letter = name[*at];
    *at += letter != '\0';
    return letter >= 'A' && letter <= 'Z' ? letter - 'A' + 'a' : letter;
}

bool snow_same_name(const char *a, const char *b) {
    size_t i = 0, j = 0;
    int left, right;
    do {
        left = next_letter(a, &i);
        right = next_letter(b, &j);
    } while (left == right && left);
    return left == right;
}
